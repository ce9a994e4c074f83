//! SFC 5 GADR_LGC, 49 LGC_GADR, 50 RD_LGADR, 70 GEO_LOG, 71 LOG_GEO: slots and logical addresses of modules.
//!
//! Source: System and standard functions, chapters of these SFCs. Modules that plc.toml describes by addresses alone have no slot.

use plcc_abi::image::{Family, Module, StationModule};

use super::any::{self, Access};
use super::parameters::Call;
use super::{OK, Outcome, error};
use crate::cpu::Cpu;

/// IOID: the address is one of inputs.
pub(super) const INPUTS: u8 = 0x54;
/// IOID: the address is one of outputs.
pub(super) const OUTPUTS: u8 = 0x55;
/// Type codes of a field of WORD.
const WORD: u8 = 0x04;

/// Modules of the station with their places.
pub(super) fn modules(cpu: &Cpu) -> impl Iterator<Item = (&Module, &StationModule)> {
    let modules = cpu.image.config.modules.iter().flatten();
    modules.filter_map(|module| module.station.as_ref().map(|station| (module, station)))
}

/// First byte and number of bytes of a module's inputs or outputs.
fn bytes(module: &Module, ioid: u8) -> (u32, u32) {
    match ioid {
        OUTPUTS => (module.output_start, module.output_bytes),
        _ => (module.input_start, module.input_bytes),
    }
}

/// AREA: 0 for an S7-400, 1 for an S7-300.
fn area(cpu: &Cpu) -> u16 {
    u16::from(cpu.image.profile.family != Family::S7400)
}

/// The module that has an address.
fn at(cpu: &Cpu, ioid: u8, address: u32) -> Option<(&Module, &StationModule)> {
    if !matches!(ioid, INPUTS | OUTPUTS) {
        return None;
    }
    let covers = |module: &Module| {
        let (start, length) = bytes(module, ioid);
        address >= start && address - start < length
    };
    modules(cpu).find(|(module, _)| covers(module))
}

/// True of an address of a module: of the station, or any that a module covers.
pub(super) fn is_module(cpu: &Cpu, ioid: u8, address: u32) -> bool {
    let covers = |module: &Module| {
        let (start, length) = bytes(module, ioid);
        address >= start && address - start < length
    };
    matches!(ioid, INPUTS | OUTPUTS) && cpu.image.config.modules.iter().flatten().any(covers)
}

/// IOID and first address of the module in a slot, inputs first. `Err`: no module, or one without addresses, there.
fn in_slot(cpu: &Cpu, rack: u16, slot: u16) -> Result<(u8, u32, u32), ()> {
    let wanted = modules(cpu).filter(|(_, at)| (u16::from(at.rack), u16::from(at.slot)) == (rack, slot));
    let sides = wanted.flat_map(|(module, _)| [INPUTS, OUTPUTS].map(|ioid| (ioid, bytes(module, ioid))));
    let mut sides = sides.filter(|(_, (_, length))| *length > 0);
    sides.next().map(|(ioid, (start, length))| (ioid, start, length)).ok_or(())
}

/// Slot to address. 8094 subnet, 8095 rack, 8096 slot, 8097 subslot, 8098 offset, 8099 no module, 809A unknown byte.
pub(super) fn gadr_lgc(call: &Call) -> Outcome {
    let (subnet, rack, slot, subslot, offset) = (call.byte(0), call.word(1), call.word(2), call.byte(3), call.word(4));
    match (subnet, rack, slot, subslot) {
        (1.., ..) => return error(0x8094),
        (_, 4.., ..) => return error(0x8095),
        (_, _, 0 | 12.., _) => return error(0x8096),
        (.., 1..) => return error(0x8097),
        _ => {}
    }
    match in_slot(call.cpu, rack, slot) {
        Err(()) => error(0x8099),
        Ok((_, _, length)) if u32::from(offset) >= length => error(0x809A),
        Ok((ioid, start, _)) => {
            call.set_byte(6, ioid);
            call.set_word(7, (start + u32::from(offset)) as u16);
            OK
        }
    }
}

/// Address to slot. 8090: no module.
pub(super) fn lgc_gadr(call: &Call) -> Outcome {
    let (ioid, address) = (call.byte(0), u32::from(call.word(1)));
    let Some((module, place)) = at(call.cpu, ioid, address) else { return error(0x8090) };
    call.set_byte(3, area(call.cpu) as u8);
    call.set_word(4, place.rack.into());
    call.set_word(5, place.slot.into());
    call.set_word(6, (address - bytes(module, ioid).0) as u16);
    OK
}

/// All addresses of the module that has one. 8090 no module; 80A0, 80A1 no field of WORD, 80A2, 80A3 too short (inputs, outputs).
pub(super) fn rd_lgadr(call: &Call) -> Outcome {
    let (ioid, address) = (call.byte(0), u32::from(call.word(1)));
    let Some((module, _)) = at(call.cpu, ioid, address) else { return error(0x8090) };
    for (field, count, side, type_error) in [(3, 4, INPUTS, 0x80A0), (5, 6, OUTPUTS, 0x80A1)] {
        let (start, length) = bytes(module, side);
        let range = match any::decode(call, field, Access::Write) {
            Ok(Some(range)) if range.type_code == WORD => range,
            Ok(None) if length == 0 => {
                call.set_word(count, 0);
                continue;
            }
            _ => return error(type_error),
        };
        if range.existing / 2 < length {
            return error(type_error + 2);
        }
        for index in 0..length {
            call.cpu.memory.set_word(range.offset + 2 * index, (start + index) as u16);
        }
        call.set_word(count, length as u16);
    }
    OK
}

/// Slot to address. Of the central station MASTER is 0 and STATION the rack. 8094 to 8097 parameters, 8099 no module.
pub(super) fn geo_log(call: &Call) -> Outcome {
    let (master, station, slot, subslot) = (call.word(0), call.word(1), call.word(2), call.word(3));
    match (master, station, slot, subslot) {
        (1.., ..) => return error(0x8094),
        (_, 4.., ..) => return error(0x8095),
        (_, _, 0 | 12.., _) => return error(0x8096),
        (.., 1..) => return error(0x8097),
        _ => {}
    }
    match in_slot(call.cpu, station, slot) {
        Err(()) => error(0x8099),
        Ok((ioid, start, _)) => {
            call.set_word(5, start as u16 | if ioid == OUTPUTS { 0x8000 } else { 0 });
            OK
        }
    }
}

/// Address to slot; bit 15 of LADDR: outputs. 8090: no module.
pub(super) fn log_geo(call: &Call) -> Outcome {
    let address = call.word(0);
    let ioid = if address & 0x8000 != 0 { OUTPUTS } else { INPUTS };
    let address = u32::from(address & 0x7FFF);
    let Some((module, place)) = at(call.cpu, ioid, address) else { return error(0x8090) };
    let offset = (address - bytes(module, ioid).0) as u16;
    for (index, value) in (2..).zip([area(call.cpu), 0, place.rack.into(), place.slot.into(), 0, offset]) {
        call.set_word(index, value);
    }
    OK
}
