//! The rules of a block's source and CPU, and what is known while its statements are bound.

use plcc_abi::image::Family;
use plcc_diag::Span;
use plcc_syntax::ast::Header;
use plcc_syntax::scl::ast::Dialect;
use rustc_hash::FxHashMap;

use super::place::Spot;
use crate::bind::BindInput;
use crate::bind::path::Variable;
use plcc_model::LabelId;
use plcc_model::scl::{Expr, Statement};

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

/// A jump label of the block.
#[derive(Clone, Copy, Debug)]
pub struct Label {
    pub id: LabelId,
    pub span: Span,
    /// Identifies the list of statements that contains it.
    pub list: usize,
}

/// TEMP bytes that statements touch.
#[derive(Clone, Debug)]
pub struct TempUse {
    pub name: String,
    pub first: u32,
    pub end: u32,
    pub span: Span,
}

/// State while the statements of a block are bound.
#[derive(Default)]
pub struct Scope {
    pub rules: Rules,
    /// Only the IEC conversions are implicit (`S7_IECCheck`).
    pub strict: bool,
    /// The block writes its locals with `#`.
    pub marks_locals: bool,
    /// The code sets OK/ENO by itself.
    pub sets_flag: bool,
    /// A bit string is also the number of its width: in charts of S7-GRAPH V5.
    pub address_numbers: bool,
    /// Folded names.
    pub labels: FxHashMap<String, Label>,
    /// The lists of statements around the current one, outermost first.
    pub lists: Vec<usize>,
    /// Loops around the current statement.
    pub loops: u32,
    /// FOR variables of these loops, with the position of their FOR.
    pub loop_variables: Vec<(Spot, Span)>,
    /// Nesting of the current expression.
    pub depth: u32,
    pub temp_reads: Vec<TempUse>,
    pub temp_writes: Vec<(u32, u32)>,
    /// The function's own value is assigned somewhere.
    pub value_set: bool,
    /// Variables that no source declares, under names that no source can use: values of nets in LAD and FBD.
    pub hidden: FxHashMap<String, Variable>,
    /// Statements that represent calls of these names: placeholders of a template.
    pub holes: FxHashMap<&'static str, Vec<Statement>>,
    /// Numbers of the DBs in the DB and the DI register, WORDs: of blocks in LAD or FBD that open data blocks.
    pub open_db: Option<Expr>,
    pub open_di: Option<Expr>,
}

/// Attributes that make the code set OK/ENO, with their value. Source: SCL reference, OK and ENO.
const FLAG_ATTRIBUTES: [(&str, &str); 4] = [
    ("SetENOAutomatically", "TRUE"),
    ("S7_SetENOAutomatically", "TRUE"),
    ("SCL_SetOKFlag", "y"),
    ("SCL_SetOKFlag", "yes"),
];

impl Scope {
    pub fn new(input: &BindInput, header: &Header, dialect: Dialect) -> Scope {
        let has = |name: &str, value: &str| {
            header.attributes.iter().any(|(key, given)| {
                key.eq_ignore_ascii_case(name) && given.trim_matches('\'').eq_ignore_ascii_case(value)
            })
        };
        Scope {
            rules: Rules::of(input, dialect),
            strict: has("S7_IECCheck", "TRUE"),
            sets_flag: FLAG_ATTRIBUTES.iter().any(|(name, value)| has(name, value)),
            value_set: false,
            ..Scope::default()
        }
    }
}
