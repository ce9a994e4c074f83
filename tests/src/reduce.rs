//! Makes a case smaller as long as it fails in the same way, so that a failure shows little more than its cause.

use std::ops::Range;

/// A case that fails.
pub trait Case: Clone {
    type Failure;

    /// Runs it.
    fn check(&self) -> Result<(), Self::Failure>;

    /// Whether two failures have the same cause.
    fn alike(new: &Self::Failure, old: &Self::Failure) -> bool;

    /// Leaves out what comes after the failure.
    fn cut(&mut self, failure: &Self::Failure);

    /// How large it is, in any unit.
    fn size(&self) -> usize;
}

/// The smallest case so far, with its failure.
pub struct Best<C: Case> {
    pub case: C,
    pub failure: C::Failure,
}

impl<C: Case> Best<C> {
    /// A small case that fails as `case` does. `round` attempts all changes once.
    pub fn of(case: C, failure: C::Failure, round: impl Fn(&mut Best<C>)) -> Best<C> {
        let mut best = Best { case, failure };
        best.case.cut(&best.failure);
        loop {
            let before = best.case.size();
            round(&mut best);
            if best.case.size() >= before {
                return best;
            }
        }
    }

    /// Takes the change if the case fails still. True: taken.
    pub fn attempt(&mut self, change: impl FnOnce(&mut C)) -> bool {
        let mut case = self.case.clone();
        change(&mut case);
        match case.check() {
            Err(failure) if C::alike(&failure, &self.failure) => {
                case.cut(&failure);
                (self.case, self.failure) = (case, failure);
                true
            }
            Err(_) | Ok(()) => false,
        }
    }

    /// Attempts to remove runs of a list, long ones first.
    pub fn runs(&mut self, length: impl Fn(&C) -> usize, remove: impl Fn(&mut C, Range<usize>)) {
        let mut size = length(&self.case);
        while size > 0 {
            let mut at = length(&self.case);
            while at > 0 {
                let first = at.saturating_sub(size);
                if length(&self.case) >= at {
                    self.attempt(|case| remove(case, first..at));
                }
                at = first;
            }
            size /= 2;
        }
    }

    /// Attempts to remove each entry of a list, the last one first.
    pub fn each(&mut self, length: impl Fn(&C) -> usize, remove: impl Fn(&mut C, usize)) {
        for index in (0..length(&self.case)).rev() {
            if index < length(&self.case) {
                self.attempt(|case| remove(case, index));
            }
        }
    }
}
