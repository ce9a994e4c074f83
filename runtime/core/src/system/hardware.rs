//! Hardware of a CPU of the TIA Portal: RD_ADDR, LOG2GEO, GEO2LOG, IO2MOD, LED, DeviceStates, ModuleStates, GET_DIAG, and the runtime part of GETIO and
//! SETIO.
//!
//! The hardware identifier of a module is the one that plc.toml gives it, otherwise the first address of its inputs, or that of its outputs with
//! bit 15; each address that the module covers is accepted. There are no PROFINET or PROFIBUS devices.
//!
//! Source: TIA Portal help, distributed I/O, diagnostics, addressing of modules; System and standard functions, GETIO and SETIO.

use plcc_abi::image::Module;

use super::any::{self, Access, Range};
use super::parameters::Call;
use super::{OK, Outcome, error, station};
use crate::io::PERIPHERAL_BYTES;

/// Hardware identifiers of the CPU itself.
const CPU: std::ops::RangeInclusive<u16> = 49..=52;
/// Bit of an identifier of outputs.
const OUTPUTS: u16 = Module::OF_OUTPUTS;

/// No such hardware identifier.
const NO_ADDRESS: u16 = 0x8090;
const NO_HARDWARE: u16 = 0x8091;
const NO_LED: u16 = 0x8092;
const OTHER_KIND: u16 = 0x8092;
const LED_NUMBER: u16 = 0x8093;
const GEO_TYPE: u16 = 0x8154;
const GEO_KIND: u16 = 0x8091;
const GEO_SYSTEM: u16 = 0x8094;
const GEO_STATION: u16 = 0x8095;
const GEO_SLOT: u16 = 0x8096;
const GEO_SUBSLOT: u16 = 0x8097;
const DIAG_MODE: u16 = 0x8080;
const DIAG_TYPE: u16 = 0x8081;
const LENGTH: u16 = 0x80B1;

/// Bytes of a GEOADDR.
const GEO_BYTES: u32 = 12;
/// Bytes of a DIS.
const DIS_BYTES: u32 = 14;
/// HWTYPE of a GEOADDR.
const KIND_MODULE: u16 = 4;
const KIND_SUBMODULE: u16 = 5;

/// The module that a hardware identifier means.
fn module<'a>(call: &Call<'a>, id: u16) -> Option<&'a Module> {
    module_at(call, by_address(call, id))
}

/// A hardware identifier as an address: one that plc.toml gives to a module becomes the first address of that module.
pub(super) fn by_address(call: &Call, id: u16) -> u16 {
    let ids = &call.cpu.image.config.hardware_ids;
    ids.iter().find(|(given, _)| *given == id).map_or(id, |(_, address)| *address)
}

/// The module that has an address; addresses of outputs have bit 15.
fn module_at<'a>(call: &Call<'a>, id: u16) -> Option<&'a Module> {
    let address = u32::from(id & !OUTPUTS);
    let covers = |start: u32, bytes: u32| address >= start && address - start < bytes;
    call.cpu.image.config.modules.iter().flatten().find(|module| match id & OUTPUTS {
        0 => covers(module.input_start, module.input_bytes),
        _ => covers(module.output_start, module.output_bytes),
    })
}

/// First byte of the inputs that DPRD_DAT reads with the hardware identifier `id`. If no module has it, it is an address. `None`: the
/// module has no inputs.
pub(super) fn first_input(call: &Call, id: u16) -> Option<u32> {
    let id = by_address(call, id);
    match module_at(call, id) {
        Some(module) if id & OUTPUTS != 0 => (module.input_bytes != 0).then_some(module.input_start),
        _ => Some(u32::from(id & !OUTPUTS)),
    }
}

/// First byte of the outputs that DPWR_DAT writes with the hardware identifier `id`: those of the module, even if `id` is that of its inputs. If
/// no module has it, it is an address. `None`: the module has no outputs.
pub(super) fn first_output(call: &Call, id: u16) -> Option<u32> {
    let own = by_address(call, id);
    let address = u32::from(own & !OUTPUTS);
    let Some(module) = module_at(call, own) else { return Some(address) };
    // The identifier of the module may be one of the addresses of its outputs, too.
    let is_identifier = own & OUTPUTS == 0 && address == module.input_start;
    let is_own =
        !is_identifier && address >= module.output_start && address - module.output_start < module.output_bytes;
    match module.output_bytes {
        // Unlike an identifier, an address of inputs may be one of outputs of another module.
        0 => (own == id).then_some(address),
        _ if is_own => Some(address),
        _ => Some(module.output_start),
    }
}

/// LADDR -> RET_VAL, PIADDR, PICOUNT, PQADDR, PQCOUNT.
pub(super) fn rd_addr(call: &Call) -> Outcome {
    let found = module(call, call.word(0));
    let sides = found
        .map_or([0; 4], |module| [module.input_start, module.input_bytes, module.output_start, module.output_bytes]);
    for (address, count, start, bytes) in [(2, 3, sides[0], sides[1]), (4, 5, sides[2], sides[3])] {
        call.set_dword(address, if bytes == 0 { 0 } else { start });
        call.set_word(count, bytes as u16);
    }
    if found.is_some() { OK } else { error(NO_ADDRESS) }
}

/// The structure of `bytes` bytes that parameter `index` points to.
fn structure(call: &Call, index: usize, access: Access, bytes: u32) -> Option<Range> {
    let range = any::decode(call, index, access).ok().flatten()?;
    (range.bytes == bytes && range.existing == bytes).then_some(range)
}

/// LADDR -> RET_VAL, GEOADDR.
pub(super) fn log2geo(call: &Call) -> Outcome {
    let Some(found) = module(call, call.word(0)) else { return error(NO_HARDWARE) };
    let Some(target) = structure(call, 2, Access::Write, GEO_BYTES) else { return error(GEO_TYPE) };
    let place = found.station.as_ref().map_or((0, 0), |place| (place.rack, place.slot));
    let fields = [KIND_MODULE, 0, 0, place.0.into(), place.1.into(), 0];
    for (at, value) in (target.offset..).step_by(2).zip(fields) {
        call.cpu.memory.set_word(at, value);
    }
    OK
}

/// GEOADDR -> RET_VAL, LADDR.
pub(super) fn geo2log(call: &Call) -> Outcome {
    const LADDR: usize = 2;
    let Some(source) = structure(call, 0, Access::Read, GEO_BYTES) else { return error(GEO_TYPE) };
    let field = |index: u32| call.cpu.memory.word(source.offset + 2 * index);
    if !matches!(field(0), KIND_MODULE | KIND_SUBMODULE) {
        return error(GEO_KIND);
    }
    if field(1) != 0 || field(2) != 0 {
        return error(GEO_SYSTEM);
    }
    let mut modules = station::modules(call.cpu).filter(|(_, place)| u16::from(place.rack) == field(3)).peekable();
    if modules.peek().is_none() {
        return error(GEO_STATION);
    }
    let Some((found, _)) = modules.find(|(_, place)| u16::from(place.slot) == field(4)) else { return error(GEO_SLOT) };
    if field(5) > 1 {
        return error(GEO_SUBSLOT);
    }
    call.set_word(LADDR, call.cpu.image.config.hardware_id(found));
    OK
}

/// ADDR (a pointer to an input or an output) -> RET_VAL, LADDR.
pub(super) fn io2mod(call: &Call) -> Outcome {
    use plcc_abi::layout::area;
    const LADDR: usize = 2;
    let any = call.any(0);
    let (side, byte) = ((any.pointer >> 24) as u8, any.pointer >> 3 & 0xFFFF);
    let outputs = match side {
        area::I => 0,
        area::Q => OUTPUTS,
        _ => return error(NO_HARDWARE),
    };
    let Some(found) =
        u16::try_from(byte).ok().filter(|byte| byte & OUTPUTS == 0).and_then(|byte| module_at(call, byte | outputs))
    else {
        return error(NO_ADDRESS);
    };
    call.set_word(LADDR, call.cpu.image.config.hardware_id(found));
    OK
}

/// LADDR, LED -> RET_VAL: how a light of the CPU is on. 2: color 1 (green, red, yellow), 1: off.
pub(super) fn led(call: &Call) -> Outcome {
    const OFF: u16 = 1;
    const FIRST_COLOR: u16 = 2;
    let (hardware, light) = (call.word(0), call.word(1));
    if !CPU.contains(&hardware) {
        return error(if module(call, hardware).is_some() { NO_LED } else { NO_HARDWARE });
    }
    match light {
        // RUN/STOP: who asks is in RUN.
        1 => Outcome::RetVal(FIRST_COLOR),
        // MAINT.
        3 if call.cpu.is_forcing() => Outcome::RetVal(FIRST_COLOR),
        // ERROR, MAINT.
        2 | 3 => Outcome::RetVal(OFF),
        _ => error(LED_NUMBER),
    }
}

/// LADDR, MODE -> RET_VAL, STATE: no identifier is that of an IO system or of a device.
pub(super) fn states(call: &Call) -> Outcome {
    let hardware = call.word(0);
    error(if CPU.contains(&hardware) || module(call, hardware).is_some() { OTHER_KIND } else { NO_HARDWARE })
}

/// MODE, LADDR -> RET_VAL, CNT_DIAG, DIAG, DETAIL: a component without faults. MODE 0: which modes there are.
pub(super) fn get_diag(call: &Call) -> Outcome {
    const MODES: u32 = 0b11;
    const GOOD: u16 = 1;
    const RUN: u16 = 8;
    const DIAG: usize = 4;
    let (mode, hardware) = (call.word(0), call.word(1));
    call.set_word(3, 0);
    if mode > 1 {
        return error(DIAG_MODE);
    }
    let in_cpu = CPU.contains(&hardware);
    if !in_cpu && module(call, hardware).is_none() {
        return error(NO_ADDRESS);
    }
    let bytes = if mode == 0 { 4 } else { DIS_BYTES };
    let Some(target) = structure(call, DIAG, Access::Write, bytes) else { return error(DIAG_TYPE) };
    let memory = &call.cpu.memory;
    if mode == 0 {
        memory.set_dword(target.offset, MODES);
        return OK;
    }
    // MaintenanceState, ComponentStateDetail, OwnState: 0, all is good.
    memory.set_bytes(target.offset, [0; DIS_BYTES as usize]);
    memory.set_word(target.offset + 10, GOOD);
    memory.set_word(target.offset + 12, if in_cpu { RUN } else { 0 });
    OK
}

/// ID, OFFSET, LEN (below 0: all) and the area, parameter 5 -> the part of the module, and its first address. `Err`: code of DPRD_DAT.
fn part(call: &Call, access: Access) -> Result<(u32, Range), u16> {
    let (id, offset, length) = (call.dword(0) as u16, call.word(1) as i16, call.word(2) as i16);
    let range = any::decode(call, 5, access)?.ok_or(LENGTH)?;
    let start = u32::from(id & !OUTPUTS);
    let outputs = access == Access::Read;
    let (start, room) = match &call.cpu.image.config.modules {
        // Without modules every address exists.
        None => (start, PERIPHERAL_BYTES.saturating_sub(start)),
        Some(_) => {
            let found = module(call, id).or_else(|| module(call, id ^ OUTPUTS)).ok_or(NO_ADDRESS)?;
            let side = if outputs { found.output_start } else { found.input_start };
            let bytes = if outputs { found.output_bytes } else { found.input_bytes };
            if bytes == 0 {
                return Err(NO_ADDRESS);
            }
            (side, bytes)
        }
    };
    let offset = u32::try_from(offset).map_err(|_| LENGTH)?;
    let wanted = match u32::try_from(length) {
        Ok(length) => length,
        Err(_) if call.cpu.image.config.modules.is_none() => range.bytes,
        Err(_) => room,
    };
    if wanted == 0 || offset + wanted > room || wanted > range.existing {
        return Err(LENGTH);
    }
    Ok((start + offset, Range { bytes: wanted, ..range }))
}

/// ID, OFFSET, LEN -> RET_VAL, COUNT, INPUTS.
pub(super) fn read_io(call: &Call) -> Outcome {
    let (address, range) = match part(call, Access::Write) {
        Ok(found) => found,
        Err(code) => return error(code),
    };
    let driver = &call.cpu.driver;
    if (0..range.bytes).any(|index| driver.read(address + index, 1).is_none()) {
        return error(NO_ADDRESS);
    }
    for index in 0..range.bytes {
        call.cpu.memory.set_byte(range.offset + index, call.cpu.module_input(address + index).unwrap_or(0) as u8);
    }
    call.set_word(4, range.bytes as u16);
    OK
}

/// ID, OFFSET, LEN -> RET_VAL, COUNT, OUTPUTS.
pub(super) fn write_io(call: &Call) -> Outcome {
    let (address, range) = match part(call, Access::Read) {
        Ok(found) => found,
        Err(code) => return error(code),
    };
    for index in 0..range.bytes {
        let value = u32::from(call.cpu.memory.byte(range.offset + index));
        if call.cpu.peripheral_write(address + index, 1, value) {
            return error(NO_ADDRESS);
        }
    }
    call.set_word(4, range.bytes as u16);
    OK
}
