//! The places that the code of a program names; a trace records them by default.

use plcc_abi::layout;
use plcc_abi::names::{UsedArea, UsedPlace};
use plcc_abi::s7200::{COUNTERS, TIMERS, system};
use plcc_ir::{Address, Function, InstData, Region};
use rustc_hash::FxHashSet;

/// More places than a trace can show are left out.
const PLACES_MAX: usize = 10_000;

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
                _ => continue,
            };
            self.places.extend(place(address, bit, bits));
        }
    }

    /// In order.
    pub fn finish(self) -> Vec<UsedPlace> {
        let mut places: Vec<UsedPlace> = self.places.into_iter().collect();
        places.sort_unstable();
        places.truncate(PLACES_MAX);
        places
    }
}

/// Bits and values of the timers and counters of an S7-200: the first one, the bytes of each, how many there are.
const SYSTEM_CELLS: [(UsedArea, u32, u32, u32); 4] = [
    (UsedArea::Timer, system::TIMER_BITS, 1, TIMERS),
    (UsedArea::Timer, system::TIMER_VALUES, 2, TIMERS),
    (UsedArea::Counter, system::COUNTER_BITS, 1, COUNTERS),
    (UsedArea::Counter, system::COUNTER_VALUES, 2, COUNTERS),
];

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
            return SYSTEM_CELLS.iter().find_map(|&(area, start, bytes, count)| {
                let number = address.offset.checked_sub(start)? / bytes;
                if number < count { cell(area, number) } else { None }
            });
        }
        Region::State | Region::L | Region::V | Region::AnyDb | Region::Any => return None,
    };
    Some(UsedPlace { area, byte: address.offset, bit, bits: u8::try_from(bits).ok()? })
}
