//! The places that the code of a program names; a trace records them by default.

use plcc_abi::image::Family;
use plcc_abi::names::{UsedArea, UsedPlace};
use plcc_abi::s7200::{ANALOG_ADDRESS, COUNTERS, TIMERS, system};
use plcc_abi::{RuntimeFn, layout};
use plcc_ir::{Address, Function, InstData, Region, Value};
use rustc_hash::FxHashSet;

/// More places than a trace can show are left out.
const PLACES_MAX: usize = 10_000;

/// Results of operations of an S7-200: a look between two cycles shows those of the last operation only.
const RESULTS_BYTE: u32 = 1;

/// The places of all instructions with a known address.
#[derive(Default)]
pub struct Places {
    places: FxHashSet<UsedPlace>,
}

impl Places {
    pub fn add(&mut self, function: &Function) {
        let blocks = function.layout.iter().flat_map(|&block| &function.blocks[block].insts);
        for &inst in blocks {
            let (address, bit, bits) = match &function.insts[inst] {
                InstData::Load { addr } => (addr, 0, function.ty(function.result(inst)).bytes() * 8),
                InstData::Store { addr, value } => (addr, 0, function.ty(*value).bytes() * 8),
                InstData::LoadBit { addr, bit } | InstData::StoreBit { addr, bit, .. } => (addr, *bit, 1),
                InstData::CallRuntime { function: called, args } => {
                    self.places.extend(outside(*called, args, function));
                    continue;
                }
                _ => continue,
            };
            self.places.extend(place(address, bit, bits));
        }
    }

    /// In order, as a CPU of the family has them.
    pub fn finish(self, family: Family) -> Vec<UsedPlace> {
        let mut places: Vec<UsedPlace> = self.places.into_iter().map(|place| module(place, family)).collect();
        places.sort_unstable();
        places.dedup();
        places.truncate(PLACES_MAX);
        places
    }
}

/// What a function of the runtime reads or writes outside of memory, if the code names it.
fn outside(called: RuntimeFn, arguments: &[Value], function: &Function) -> Option<UsedPlace> {
    let constant = |index: usize| u32::try_from(function.constant(*arguments.get(index)?)?).ok();
    let small = |number: u32| u8::try_from(number).ok();
    let (area, bit, bits) = match called {
        RuntimeFn::PeripheralRead => (UsedArea::PeripheralInput, 0, small(8 * constant(1)?)?),
        RuntimeFn::PeripheralWrite => (UsedArea::PeripheralOutput, 0, small(8 * constant(1)?)?),
        RuntimeFn::PeripheralWriteBit => (UsedArea::PeripheralOutput, small(constant(1)?)?, 1),
        RuntimeFn::S7200Counter => (UsedArea::HighSpeedCounter, 0, 32),
        _ => return None,
    };
    Some(UsedPlace { area, byte: constant(0)?, bit, bits })
}

/// An access to a module: of an S7-200 to a place of the process image or to an analog word, else to whole bytes.
fn module(place: UsedPlace, family: Family) -> UsedPlace {
    let (image, analog) = match place.area {
        UsedArea::PeripheralInput => (UsedArea::Input, UsedArea::AnalogInput),
        UsedArea::PeripheralOutput => (UsedArea::Output, UsedArea::AnalogOutput),
        _ => return place,
    };
    match (family, place.byte.checked_sub(ANALOG_ADDRESS)) {
        (Family::S7200, Some(byte)) => UsedPlace { area: analog, byte, ..place },
        (Family::S7200, None) => UsedPlace { area: image, ..place },
        _ if place.bits == 1 => UsedPlace { bit: 0, bits: 8, ..place },
        _ => place,
    }
}

/// Bits and values of the timers and counters of an S7-200: the first one, the bytes of each, how many there are.
const SYSTEM_CELLS: [(UsedArea, u32, u32, u32); 4] = [
    (UsedArea::Timer, system::TIMER_BITS, 1, TIMERS),
    (UsedArea::Timer, system::TIMER_VALUES, 2, TIMERS),
    (UsedArea::Counter, system::COUNTER_BITS, 1, COUNTERS),
    (UsedArea::Counter, system::COUNTER_VALUES, 2, COUNTERS),
];
/// Special memory and sequence control relays: the first byte, and how many there are.
const SYSTEM_BYTES: [(UsedArea, u32, u32); 2] =
    [(UsedArea::SpecialMemory, system::SM, system::SM_BYTES), (UsedArea::Relays, system::S, system::S_BYTES)];

fn place(address: &Address, bit: u8, bits: u32) -> Option<UsedPlace> {
    if address.base.is_some() {
        return None;
    }
    let cell = |area: UsedArea, number: u32| Some(UsedPlace { area, byte: number, bit: 0, bits: 1 });
    let area = match address.region {
        Region::I => UsedArea::Input,
        Region::Q => UsedArea::Output,
        Region::M => UsedArea::BitMemory,
        Region::Db(number) => UsedArea::Db(number),
        Region::Cells => {
            return match address.offset.checked_sub(layout::C - layout::T) {
                Some(counters) => cell(UsedArea::Counter, counters / layout::COUNTER_CELL_BYTES),
                None => cell(UsedArea::Timer, address.offset / layout::TIMER_CELL_BYTES),
            };
        }
        Region::System => {
            let bits = u8::try_from(bits).ok()?;
            let byte = SYSTEM_BYTES.iter().find_map(|&(area, start, count)| {
                let byte = address.offset.checked_sub(start).filter(|byte| *byte < count)?;
                let is_result = area == UsedArea::SpecialMemory && byte == RESULTS_BYTE;
                (!is_result).then_some(UsedPlace { area, byte, bit, bits })
            });
            return byte.or_else(|| {
                SYSTEM_CELLS.iter().find_map(|&(area, start, bytes, count)| {
                    let number = address.offset.checked_sub(start)? / bytes;
                    if number < count { cell(area, number) } else { None }
                })
            });
        }
        Region::State | Region::L | Region::V | Region::AnyDb | Region::Any => return None,
    };
    Some(UsedPlace { area, byte: address.offset, bit, bits: u8::try_from(bits).ok()? })
}
