//! The rules of a block's source and CPU.

use plcc_abi::image::Family;
use plcc_binding::BindInput;
use plcc_syntax::scl::ast::Dialect;

/// The rules of a block, from its source and the CPU. Source: SCL reference, dialects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Rules {
    /// S7-SCL of STEP 7 V5.
    Classic,
    /// TIA Portal, S7-300/400.
    Tia300,
    /// TIA Portal, S7-1200.
    Tia1200,
    /// TIA Portal, S7-1500; also for a TIA source without a named CPU.
    #[default]
    Tia1500,
}

impl Rules {
    /// The rules of a source in this dialect. `named`: the CPU was chosen explicitly.
    pub const fn new(dialect: Dialect, family: Family, named: bool) -> Rules {
        match (dialect, family) {
            (Dialect::Classic, _) => Rules::Classic,
            (_, Family::S71200) => Rules::Tia1200,
            (Dialect::Tia, Family::S7300 | Family::S7400) if named => Rules::Tia300,
            (Dialect::Tia, _) | (Dialect::Either, Family::S71500) => Rules::Tia1500,
            (Dialect::Either, Family::S7300 | Family::S7400 | Family::S7200) => Rules::Classic,
        }
    }

    /// The rules of a source in this dialect in a program.
    pub fn of(input: &BindInput, dialect: Dialect) -> Rules {
        // If no CPU is named, limits are not checked.
        let generic = matches!(input.profile.name.as_str(), "s7-300" | "s7-400");
        Rules::new(dialect, input.profile.family, !generic || input.profile.limits_checked)
    }

    /// The CPU is an S7-300/400.
    pub const fn is_300(self) -> bool {
        matches!(self, Rules::Classic | Rules::Tia300)
    }
}
