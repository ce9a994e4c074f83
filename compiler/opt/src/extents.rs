//! Sorted ranges of bits in a memory region, with something known about each.
//!
//! Memory is counted in bits, since most of a PLC program works on single ones: bit `b` of byte `n` is bit `8 n + b`, so that
//! a byte is 8 bits in a row and a word 16.

use plcc_ir::{Address, Region, Type, Value};

/// The memory that an access touches.
#[derive(Clone, Copy, Debug)]
pub struct Access {
    pub region: Region,
    pub base: Option<Value>,
    /// First bit after region and base.
    pub start: u64,
    /// First bit that is not touched.
    pub end: u64,
}

impl Access {
    pub fn bytes(addr: &Address, len: u32) -> Access {
        let start = u64::from(addr.offset) * 8;
        Access { region: addr.region, base: addr.base, start, end: start + u64::from(len) * 8 }
    }

    pub fn of_type(addr: &Address, ty: Type) -> Access {
        Access::bytes(addr, ty.bytes())
    }

    pub fn bit(addr: &Address, bit: u8) -> Access {
        let start = u64::from(addr.offset) * 8 + u64::from(bit);
        Access { region: addr.region, base: addr.base, start, end: start + 1 }
    }
}

/// A range with the facts about it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent<T> {
    pub start: u64,
    pub end: u64,
    pub known: T,
}

/// Ranges that do not overlap, in ascending order.
#[derive(Clone, Debug)]
pub struct Extents<T> {
    items: Vec<Extent<T>>,
}

impl<T> Default for Extents<T> {
    fn default() -> Self {
        Extents { items: Vec::new() }
    }
}

impl<T: Copy + PartialEq> Extents<T> {
    pub fn len(&self) -> usize {
        self.items.len()
    }

    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    pub fn clear(&mut self) {
        self.items.clear();
    }

    pub fn iter(&self) -> impl Iterator<Item = &Extent<T>> {
        self.items.iter()
    }

    /// Places of the ranges that overlap `start..end`.
    fn overlapping(&self, start: u64, end: u64) -> std::ops::Range<usize> {
        let first = self.items.partition_point(|item| item.end <= start);
        let after = first + self.items[first..].partition_point(|item| item.start < end);
        first..after
    }

    pub fn overlaps(&self, start: u64, end: u64) -> bool {
        !self.overlapping(start, end).is_empty()
    }

    /// The range that contains `start..end`.
    pub fn covering(&self, start: u64, end: u64) -> Option<Extent<T>> {
        let item = self.items.get(self.overlapping(start, end).start)?;
        (item.start <= start && end <= item.end).then_some(*item)
    }

    /// Forgets `start..end`. The rest of a range that is partly inside is kept if `divisible` allows it.
    pub fn cut(&mut self, start: u64, end: u64, divisible: impl Fn(T) -> bool) {
        let range = self.overlapping(start, end);
        if range.is_empty() {
            return;
        }
        let (first, last) = (self.items[range.start], self.items[range.end - 1]);
        let before = (first.start < start && divisible(first.known)).then_some(Extent { end: start, ..first });
        let after = (last.end > end && divisible(last.known)).then_some(Extent { start: end, ..last });
        self.items.splice(range, before.into_iter().chain(after));
    }

    /// Adds a range that overlaps no other; joins it with its neighbours if `join` says that it may be.
    pub fn insert(&mut self, start: u64, end: u64, known: T, join: bool) {
        let mut new = Extent { start, end, known };
        let mut range = self.overlapping(start, end);
        debug_assert!(range.is_empty());
        if join {
            if let Some(before) = range.start.checked_sub(1).map(|index| self.items[index])
                && before.end == start
                && before.known == known
            {
                new.start = before.start;
                range.start -= 1;
            }
            if let Some(&after) = self.items.get(range.end)
                && after.start == end
                && after.known == known
            {
                new.end = after.end;
                range.end += 1;
            }
        }
        self.items.splice(range, [new]);
    }

    /// Keeps the ranges that `keep` accepts.
    pub fn retain(&mut self, keep: impl FnMut(&Extent<T>) -> bool) {
        self.items.retain(keep);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_cut_and_joined() {
        let mut extents = Extents::default();
        extents.insert(0, 8, (), true);
        extents.insert(16, 24, (), true);
        extents.insert(8, 16, (), true);
        assert_eq!(extents.len(), 1);
        extents.cut(4, 6, |()| true);
        assert!(extents.covering(0, 4).is_some() && extents.covering(6, 24).is_some());
        assert!(extents.covering(3, 5).is_none() && !extents.overlaps(4, 6) && extents.overlaps(5, 7));
        extents.cut(7, 8, |()| false);
        assert_eq!(extents.len(), 1);
    }
}
