//! What is known of a block while its statements are bound.

use plcc_diag::Span;
use plcc_syntax::ast::Header;
use plcc_syntax::scl::ast::Dialect;
use rustc_hash::{FxHashMap, FxHashSet};

use super::place::Spot;
use crate::bind::declarations::path::Variable;
use crate::bind::globals::rules::Rules;
use plcc_binding::BindInput;
use plcc_model::LabelId;
use plcc_model::scl::{Expr, Statement};

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
    /// Absolute addresses with bits only, which take the type of their pin: in LAD and FBD.
    pub untyped: Option<FxHashSet<Span>>,
    /// The statements are those of a network in SCL, which computes as a block in SCL does.
    pub in_scl: bool,
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
    /// The current expression goes to a WSTRING with more than 254 characters.
    pub long_texts: bool,
    pub temp_reads: Vec<TempUse>,
    pub temp_writes: Vec<(u32, u32)>,
    /// The function's own value is assigned somewhere.
    pub value_set: bool,
    /// The parameters of a function that its statements name.
    pub named_parameters: FxHashSet<usize>,
    /// A statement could not be read, which is reported; what it assigns is unknown.
    pub unread: bool,
    /// Variables that no source declares, under names that no source can use: values of nets in LAD and FBD.
    pub hidden: FxHashMap<String, Variable>,
    /// Statements that represent calls of these names: placeholders of a template.
    pub holes: FxHashMap<&'static str, Vec<Statement>>,
    /// Numbers of the DBs in the DB and the DI register, WORDs: of blocks in LAD or FBD that open data blocks.
    pub open_db: Option<Expr>,
    pub open_di: Option<Expr>,
    /// See `SclBody`.
    pub named_dbs: Vec<(u16, Span)>,
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

    /// The network is in LAD or FBD.
    pub fn is_network(&self) -> bool {
        self.untyped.is_some() && !self.in_scl
    }
}
