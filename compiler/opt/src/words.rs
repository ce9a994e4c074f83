//! Which bits of memory are read and written with the word around them.
//!
//! A PLC program reads and writes single bits, and those that belong together are neighbours: four bytes in a row hold what a
//! dozen networks work on. Reading them as one word costs one load, and their bits are shifts of a register; writing
//! them costs one store. Where a block uses few bits, or those of only one of the four bytes, the byte is better.
//!
//! All accesses of a block to bits of a word have the same width: a word that is read soon after one of its bytes was written
//! has to wait until the byte is in the cache.

use plcc_abi::layout;
use plcc_ir::{Address, Function, Inst, InstData, Region, StaticDb};
use rustc_hash::FxHashMap;

/// Bytes of a word.
const WORD_BYTES: u32 = 4;

/// A word is better than its bytes if a block uses its bits this often; a store counts twice.
const USES_MIN: u32 = 4;

/// The words whose bits a block uses, by region and offset.
pub struct Words<'m> {
    used: FxHashMap<(Region, u32), Used>,
    dbs: &'m [StaticDb],
    local_bytes: u32,
}

/// How a block uses the bits of a word.
#[derive(Default)]
struct Used {
    /// How often bits of each byte are used.
    bytes: [u32; WORD_BYTES as usize],
    uses: u32,
}

impl<'m> Words<'m> {
    pub fn of(function: &Function, insts: &[Inst], dbs: &'m [StaticDb]) -> Words<'m> {
        let mut used: FxHashMap<(Region, u32), Used> = FxHashMap::default();
        for &inst in insts {
            if let InstData::LoadBit { addr, .. } | InstData::StoreBit { addr, .. } = &function.insts[inst]
                && addr.base.is_none()
            {
                let (word, byte) = (addr.offset / WORD_BYTES, addr.offset % WORD_BYTES);
                let used = used.entry((addr.region, word)).or_default();
                used.bytes[byte as usize] += 1;
                used.uses += if matches!(function.insts[inst], InstData::StoreBit { .. }) { 2 } else { 1 };
            }
        }
        Words { used, dbs, local_bytes: function.frame_bytes }
    }

    /// The address of the word around a bit, if that is better than its bytes and all of it exists.
    pub fn around(&self, addr: &Address) -> Option<Address> {
        let word = addr.offset / WORD_BYTES;
        let used = self.used.get(&(addr.region, word))?;
        let (start, end) = (word * WORD_BYTES, u64::from(word + 1) * u64::from(WORD_BYTES));
        let bytes = used.bytes.iter().filter(|&&uses| uses > 0).count();
        let is_better = bytes > 1 && used.uses >= USES_MIN;
        (addr.base.is_none() && is_better && end <= self.length(addr.region))
            .then_some(Address { offset: start, ..*addr })
    }

    /// True if more than one bit of the byte is used, or one more than once.
    pub fn shares_byte(&self, addr: &Address) -> bool {
        let used = self.used.get(&(addr.region, addr.offset / WORD_BYTES));
        addr.base.is_some() || used.is_some_and(|used| used.bytes[(addr.offset % WORD_BYTES) as usize] > 1)
    }

    /// Bytes of the region that exist.
    fn length(&self, region: Region) -> u64 {
        match region {
            Region::I | Region::Q | Region::M => u64::from(layout::AREA_BYTES),
            Region::L => u64::from(self.local_bytes),
            Region::Db(number) => {
                let found = self.dbs.binary_search_by_key(&number, |db| db.number);
                found.map_or(0, |index| u64::from(self.dbs[index].length))
            }
            Region::State | Region::System | Region::Cells | Region::V | Region::AnyDb | Region::Any => 0,
        }
    }
}
