//! SFC 13 DPNRM_DG, SFC 14 DPRD_DAT, SFC 15 DPWR_DAT: diagnostics and consistent data of a DP slave.
//!
//! Source: System and standard functions, SFC 13 to 15.
//!
//! LADDR is the first peripheral byte, RECORD an ANY of type BYTE. 8090 no module, 8092 type, 80B1 length.

use super::any::{self, Access, Range};
use super::parameters::Call;
use super::{OK, Outcome, error};
use crate::io::PERIPHERAL_BYTES;

/// Type code of BYTE.
const BYTE: u8 = 0x02;

fn record(call: &Call, index: usize, access: Access) -> Result<Range, u16> {
    let range = any::decode(call, index, access)?.ok_or(0x80B1u16)?;
    let address = u32::from(call.word(0));
    match range {
        Range { type_code, .. } if type_code != BYTE => Err(0x8092),
        Range { existing, bytes, .. } if existing < bytes || address + bytes > PERIPHERAL_BYTES => Err(0x80B1),
        _ => Ok(range),
    }
}

pub(super) fn dprd_dat(call: &Call) -> Outcome {
    let range = match record(call, 2, Access::Write) {
        Ok(range) => range,
        Err(code) => return error(code),
    };
    let address = u32::from(call.word(0));
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
    let range = match record(call, 1, Access::Read) {
        Ok(range) => range,
        Err(code) => return error(code),
    };
    let address = u32::from(call.word(0));
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
