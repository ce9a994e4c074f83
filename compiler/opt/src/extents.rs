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

    /// The ranges that overlap `start..end`.
    pub fn iter_in(&self, start: u64, end: u64) -> impl Iterator<Item = &Extent<T>> {
        self.items[self.overlapping(start, end)].iter()
    }

    /// The range that contains `start..end`.
    pub fn covering(&self, start: u64, end: u64) -> Option<Extent<T>> {
        let item = self.items.get(self.overlapping(start, end).start)?;
        (item.start <= start && end <= item.end).then_some(*item)
    }

    /// Forgets `start..end`. The rest of a range that is partly inside is kept.
    pub fn cut(&mut self, start: u64, end: u64) {
        let range = self.overlapping(start, end);
        if range.is_empty() {
            return;
        }
        let (first, last) = (self.items[range.start], self.items[range.end - 1]);
        let before = (first.start < start).then_some(Extent { end: start, ..first });
        let after = (last.end > end).then_some(Extent { start: end, ..last });
        self.items.splice(range, before.into_iter().chain(after));
    }

    /// Adds what is known about the parts of `start..end` that nothing is known about yet.
    pub fn fill(&mut self, start: u64, end: u64, known: T) {
        let range = self.overlapping(start, end);
        if range.is_empty() {
            self.insert(start, end, known);
            return;
        }
        let mut filled = Vec::with_capacity(2 * range.len() + 1);
        let mut at = start;
        for &item in &self.items[range.clone()] {
            if at < item.start {
                filled.push(Extent { start: at, end: item.start, known });
            }
            filled.push(item);
            at = item.end;
        }
        if at < end {
            filled.push(Extent { start: at, end, known });
        }
        self.items.splice(range, filled);
    }

    /// Keeps what both know.
    pub fn intersect(&mut self, other: &Extents<T>) {
        let mut others = other.items.iter().peekable();
        let mut both = Vec::with_capacity(self.items.len());
        for item in &self.items {
            while others.next_if(|other| other.end <= item.start).is_some() {}
            while let Some(&&other) = others.peek()
                && other.start < item.end
            {
                if other.known == item.known {
                    let (start, end) = (item.start.max(other.start), item.end.min(other.end));
                    both.push(Extent { start, end, known: item.known });
                }
                if other.end > item.end {
                    break;
                }
                others.next();
            }
        }
        self.items = both;
    }

    /// Keeps the ranges that `keep` accepts.
    pub fn retain(&mut self, keep: impl FnMut(&Extent<T>) -> bool) {
        self.items.retain(keep);
    }

    /// Adds a range that overlaps no other, and joins it with its neighbours if the same is known about them.
    pub fn insert(&mut self, start: u64, end: u64, known: T) {
        let mut new = Extent { start, end, known };
        let mut range = self.overlapping(start, end);
        debug_assert!(range.is_empty());
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
        self.items.splice(range, [new]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_cut_and_joined() {
        let mut extents = Extents::default();
        extents.insert(0, 8, ());
        extents.insert(16, 24, ());
        extents.insert(8, 16, ());
        assert_eq!(extents.len(), 1);
        extents.cut(4, 6);
        assert!(extents.covering(0, 4).is_some() && extents.covering(6, 24).is_some());
        assert!(extents.covering(3, 5).is_none() && !extents.overlaps(4, 6) && extents.overlaps(5, 7));
    }

    #[test]
    fn gaps_are_filled() {
        let mut extents = Extents::default();
        extents.insert(4, 6, 'a');
        extents.fill(0, 8, 'b');
        let items: Vec<_> = extents.iter().map(|item| (item.start, item.end, item.known)).collect();
        assert_eq!(items, [(0, 4, 'b'), (4, 6, 'a'), (6, 8, 'b')]);
    }

    #[test]
    fn what_both_know_is_left() {
        let of = |items: &[(u64, u64, char)]| {
            let mut extents = Extents::default();
            items.iter().for_each(|&(start, end, known)| extents.insert(start, end, known));
            extents
        };
        let mut a = of(&[(0, 8, 'a'), (8, 16, 'b'), (20, 24, 'c'), (30, 32, 'd')]);
        a.intersect(&of(&[(2, 4, 'a'), (5, 6, 'x'), (6, 12, 'a'), (12, 22, 'b'), (22, 40, 'd')]));
        let items: Vec<_> = a.iter().map(|item| (item.start, item.end, item.known)).collect();
        assert_eq!(items, [(2, 4, 'a'), (6, 8, 'a'), (12, 16, 'b'), (30, 32, 'd')]);
    }
}
