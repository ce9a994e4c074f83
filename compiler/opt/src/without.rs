//! Passes that are switched off, by name.
//!
//! No pass relies on another one for a correct result, so any of them may be left out: to find the pass that a wrong result comes from,
//! or what a pass is worth.

use std::fmt;
use std::str::FromStr;

use crate::passes;

/// A set of passes that do not run; each name stands for every run of the pass. By default it is empty.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Without {
    /// Bit n is the pass of this number in [`passes`].
    bits: u64,
}

impl Without {
    /// Every pass runs.
    pub const NOTHING: Without = Without { bits: 0 };

    /// Each pass alone, in the order of [`passes`].
    pub fn each() -> Vec<Without> {
        (0..passes().len()).map(|index| Without { bits: 1 << index }).collect()
    }

    /// Both sets together.
    pub fn and(self, other: Without) -> Without {
        Without { bits: self.bits | other.bits }
    }

    /// True if the pass called `name` does not run.
    pub fn contains(self, name: &str) -> bool {
        self.bits != 0 && self.names().any(|own| own == name)
    }

    /// The names, in the order of [`passes`].
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        passes().into_iter().enumerate().filter(move |(index, _)| self.bits >> index & 1 == 1).map(|(_, name)| name)
    }
}

/// `without fold, values`; nothing for the empty set.
impl fmt::Display for Without {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.names().collect::<Vec<_>>().as_slice() {
            [] => Ok(()),
            names => write!(f, "without {}", names.join(", ")),
        }
    }
}

/// There is no pass of this name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownPass(pub String);

impl fmt::Display for UnknownPass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "unknown pass `{}`; the passes are {}", self.0, passes().join(", "))
    }
}

impl std::error::Error for UnknownPass {}

/// The name of one pass.
impl FromStr for Without {
    type Err = UnknownPass;

    fn from_str(name: &str) -> Result<Without, UnknownPass> {
        let index = passes().iter().position(|pass| *pass == name);
        index.map(|index| Without { bits: 1 << index }).ok_or_else(|| UnknownPass(name.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pass_has_its_bit() {
        assert!(passes().len() <= 64, "the set has 64 bits");
        for (without, name) in Without::each().into_iter().zip(passes()) {
            assert_eq!(name.parse(), Ok(without));
            assert_eq!(without.names().collect::<Vec<_>>(), [name]);
            assert!(without.contains(name));
            assert!(!Without::NOTHING.contains(name));
        }
    }

    #[test]
    fn sets_print_their_names() {
        let [values, fold]: [Without; 2] = ["values", "fold"].map(|name| name.parse().expect("there is such a pass"));
        assert_eq!(values.and(fold).to_string(), "without fold, values");
        assert_eq!(Without::NOTHING.to_string(), "");
    }

    #[test]
    fn unknown_names_are_answered_with_the_list() {
        let error = "folds".parse::<Without>().expect_err("there is no such pass");
        assert!(error.to_string().starts_with("unknown pass `folds`; the passes are fold, control-flow, "), "{error}");
    }

    #[test]
    fn a_pass_that_is_off_does_not_run() {
        let without: Without = "fold".parse().expect("there is such a pass");
        let mut ran = Vec::new();
        crate::optimize_with(&mut plcc_ir::Module::default(), without, &mut |name, _| ran.push(name));
        let expected = crate::pipeline().map(|pass| pass.name).filter(|name| *name != "fold");
        assert_eq!(ran, expected.collect::<Vec<_>>());
    }
}
