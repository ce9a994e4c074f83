//! The places that the code of a program names: what a trace records if nobody says what.

use plcc_abi::names::{UsedArea, UsedPlace};
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

fn place(address: &Address, bit: u8, bits: u32) -> Option<UsedPlace> {
    let area = match address.region {
        Region::I => UsedArea::Input,
        Region::Q => UsedArea::Output,
        Region::M => UsedArea::BitMemory,
        Region::Db(number) => UsedArea::Db(number),
        Region::State | Region::System | Region::Cells | Region::L | Region::V | Region::AnyDb | Region::Any => {
            return None;
        }
    };
    let bits = u8::try_from(bits).ok()?;
    address.base.is_none().then_some(UsedPlace { area, byte: address.offset, bit, bits })
}
