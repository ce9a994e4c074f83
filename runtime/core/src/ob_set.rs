//! A set of organization blocks by number.

use std::cell::Cell;

use plcc_abi::ob::OB_NUMBER_MAX;

/// Numbers, 64 in a word.
const WORDS: usize = (OB_NUMBER_MAX as usize + 1) / 64;

/// Numbers from 0 to [`OB_NUMBER_MAX`]; others are never in it.
pub struct ObSet(Box<[Cell<u64>; WORDS]>);

impl Default for ObSet {
    fn default() -> ObSet {
        ObSet(Box::new([const { Cell::new(0) }; WORDS]))
    }
}

impl ObSet {
    pub fn contains(&self, ob: u16) -> bool {
        self.0.get(usize::from(ob / 64)).is_some_and(|word| word.get() >> (ob % 64) & 1 != 0)
    }

    /// Puts `ob` in or takes it out. Result: whether it was in.
    pub fn set(&self, ob: u16, inside: bool) -> bool {
        let before = self.contains(ob);
        if let Some(word) = self.0.get(usize::from(ob / 64)) {
            let bit = 1u64 << (ob % 64);
            word.set(if inside { word.get() | bit } else { word.get() & !bit });
        }
        before
    }

    pub fn clear(&self) {
        self.0.iter().for_each(|word| word.set(0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_beyond_the_largest_are_never_inside() {
        let set = ObSet::default();
        assert!(!set.set(123, true));
        assert!(set.set(123, true) && !set.contains(124));
        set.set(OB_NUMBER_MAX, true);
        set.set(u16::MAX, true);
        assert!(set.contains(OB_NUMBER_MAX) && !set.contains(u16::MAX));
        assert!(set.set(123, false) && !set.contains(123));
        set.clear();
        assert!(!set.contains(OB_NUMBER_MAX));
    }
}
