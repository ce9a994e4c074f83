//! SFC 13 DPNRM_DG, SFC 14 DPRD_DAT, SFC 15 DPWR_DAT: diagnostics and consistent data of a DP slave.
//!
//! Source: System and standard functions, SFC 13 to 15.
//!
//! LADDR is the first peripheral byte, RECORD an ANY of type BYTE. On an S7-1200/1500, LADDR is the hardware identifier of the module, and RECORD
//! has any type but BOOL and texts. 8090 no module, 8092 type, 80B1 length.

use super::any::{self, Access, Range};
use super::parameters::Call;
use super::{OK, Outcome, error, hardware};
use crate::io::PERIPHERAL_BYTES;

/// Type codes of BOOL and BYTE.
const BOOL: u8 = 0x01;
const BYTE: u8 = 0x02;

/// RECORD, parameter `index`, and the first byte of the module. `Err`: RET_VAL.
fn record(call: &Call, index: usize, access: Access) -> Result<(u32, Range), u16> {
    let range = any::decode(call, index, access)?.ok_or(0x80B1u16)?;
    let is_portal = call.cpu.image.profile.family.is_portal();
    let address = match (is_portal, access) {
        (true, Access::Read) => hardware::first_output(call, call.word(0)),
        (true, Access::Write) => hardware::first_input(call, call.word(0)),
        (false, _) => Some(u32::from(call.word(0))),
    };
    let address = address.ok_or(0x8090u16)?;
    let fits = match range.type_code {
        BYTE => true,
        BOOL | any::STRING | any::WIDE_STRING => false,
        _ => is_portal,
    };
    match range {
        _ if !fits => Err(0x8092),
        Range { existing, bytes, .. } if existing < bytes || address + bytes > PERIPHERAL_BYTES => Err(0x80B1),
        _ => Ok((address, range)),
    }
}

pub(super) fn dprd_dat(call: &Call) -> Outcome {
    let (address, range) = match record(call, 2, Access::Write) {
        Ok(found) => found,
        Err(code) => return error(code),
    };
    let (driver, memory) = (&call.cpu.driver, &call.cpu.memory);
    if driver.read(address, range.bytes.min(1)).is_none() {
        return error(0x8090);
    }
    // All or nothing.
    if (0..range.bytes).any(|index| driver.read(address + index, 1).is_none()) {
        return error(0x80B1);
    }
    for index in 0..range.bytes {
        memory.set_byte(range.offset + index, call.cpu.module_input(address + index).unwrap_or(0) as u8);
    }
    OK
}

pub(super) fn dpwr_dat(call: &Call) -> Outcome {
    let (address, range) = match record(call, 1, Access::Read) {
        Ok(found) => found,
        Err(code) => return error(code),
    };
    for index in 0..range.bytes {
        let value = u32::from(call.cpu.memory.byte(range.offset + index));
        if call.cpu.peripheral_write(address + index, 1, value) {
            return error(if index == 0 { 0x8090 } else { 0x80B1 });
        }
    }
    OK
}

/// REQ, LADDR -> RET_VAL, RECORD, BUSY: diagnostics of a slave. There is no DP network, so no address is that of a slave: 8090; 7000
/// without REQ.
pub(super) fn dpnrm_dg(call: &Call) -> Outcome {
    const BUSY: usize = 4;
    call.set_bool(BUSY, false);
    if call.byte(0) & 1 == 0 { Outcome::RetVal(0x7000) } else { error(0x8090) }
}
