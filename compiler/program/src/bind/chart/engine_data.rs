//! The data that the statements of a chart use: where it is, and the engine's own variables.
//!
//! `set`: sets of steps; `times`: times of steps.

mod set;
mod times;

use plcc_abi::names::External;
use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::chart::ast::{Body as Chart, Dialect, Event};
use rustc_hash::FxHashMap;

use super::alone::RawStep;
use super::build::{assign, load, number};
use super::index::Index;
use crate::bind::declarations::path::{Base, Variable};
use crate::bind::declarations::typed::BoundInterface;
use crate::bind::network::Page;
use crate::bind::scl::SclBlock;
use crate::bind::scl::expression::{binary_expr, constant_expr};
use crate::bind::trees::chart_data::{Members, TIA_DATA};
use plcc_binding::fold;
use plcc_model::layout;
use plcc_model::scl::{BinaryOp, CompareOp, Expr, ExprKind, Statement, UnaryOp};
use plcc_model::types::{ArrayType, DataType, Member, StructType};
use set::Set;
pub use times::SIGNS;

/// A chart while it is bound.
pub struct Engine<'c> {
    pub chart: &'c Chart,
    pub index: &'c Index,
    /// Hidden variables, and data that networks of the block share.
    pub page: Page,
    /// Variables, by their names in the templates.
    pub names: FxHashMap<&'static str, Variable>,
    /// Where the data of steps and transitions begins.
    steps: Vec<Variable>,
    transitions: Vec<Variable>,
    /// Sets of steps: active ones, in the instance; left, entered and skipped ones of this call.
    active: Set,
    pub left: Set,
    pub entered: Set,
    pub passed: Set,
    /// The position of code that the engine adds, in messages at run time.
    pub span: Span,
    /// The chart becomes another notation, which has the types of the S7-300 only, and no short ways.
    pub is_plain: bool,
}

/// Variables of the engine in the frame, as `engine.scl` declares them.
const BITS: &[&str] = &[
    "off",
    "init",
    "force",
    "acknowledge_shown",
    "register",
    "register_shown",
    "push",
    "switch_on",
    "switch_off",
    "next",
    "previous",
    "take",
    "t_next",
    "t_previous",
    "auto",
    "man",
    "tap",
    "top",
    "active",
    "faulty",
    "all",
    "runs",
    "forced",
    "may",
    "watched",
    "merging",
    "known",
    "skipped",
    "error",
    "fault",
    "was",
    "replaced",
    "satisfied",
    "faulty_now",
    "gone",
    "still_valid",
    "short",
    "done",
    "ended",
];
const NUMBERS: &[&str] =
    &["number", "wanted", "lowest", "lowest_at", "lowest_faulty", "lowest_faulty_at", "faults", "first_valid", "valid"];
/// Positions in lists and positions of steps: DINT, as an index is, so that nothing is extended.
const PLACES: &[&str] = &["i", "j", "k", "count", "left", "entered", "kept", "target", "alone"];
const TIMES: &[&str] = &["now", "passed", "elapsed"];
/// Times T and U of a step as one number, for `tick();`.
const PAIRS: &[&str] = &["both", "later", "step"];

/// Variables of the quick way, which has no use for the others: they are in the same place.
const QUICK: &[(&str, &str)] = &[
    ("single", "push"),
    ("empty", "off"),
    ("timed", "register"),
    ("swapped", "previous"),
    ("ready", "next"),
    ("forward", "t_next"),
    ("events", "take"),
    ("first", "j"),
    ("other", "elapsed"),
];

/// Data of the engine in the instance: the name in the templates, and their paths.
const KEPT: &[(&str, &[&str])] = &[
    ("SAX", &["SAX"]),
    ("S0X", &["S0X"]),
    ("S1X", &["S1X"]),
    ("MOPEDGE", &["MOPEDGE"]),
    ("MOP", &["MOP"]),
    ("SQ_FLAGS", &["SQ_FLAGS"]),
    ("OLD", &["G7_DATA", "OLD"]),
    ("LAST", &["G7_DATA", "LAST"]),
    ("STARTED", &["G7_DATA", "STARTED"]),
    ("REQUESTED", &["G7_DATA", "REQUESTED"]),
    ("PAGED", &["G7_DATA", "PAGED"]),
    ("SHOWN", &["G7_DATA", "SHOWN"]),
    ("SHOWN_AT", &["G7_DATA", "SHOWN_AT"]),
    ("SEL_OLD", &["G7_DATA", "SEL_OLD"]),
    ("T_SHOWN", &["G7_DATA", "T_SHOWN"]),
    ("ALL_WERE", &["G7_DATA", "ALL_WERE"]),
    ("EVENTFUL", &["G7_DATA", "EVENTFUL"]),
    ("ASKED_ON", &["G7_DATA", "ASKED_ON"]),
    ("ASKED_OFF", &["G7_DATA", "ASKED_OFF"]),
    ("ACTIVE", &["G7_DATA", "ACTIVE"]),
];

/// Names of the engine's variables in the frame.
pub fn own_names() -> impl Iterator<Item = &'static str> {
    [BITS, NUMBERS, PLACES, TIMES, PAIRS].into_iter().flatten().copied()
}

impl<'c> Engine<'c> {
    /// None if the declarations could not be bound, which has been reported.
    pub fn new(
        ctx: &mut SclBlock,
        chart: &'c Chart,
        index: &'c Index,
        members: &Members,
        (span, is_plain): (Span, bool),
    ) -> Option<Engine<'c>> {
        let bound = std::rc::Rc::clone(&ctx.block.bound);
        let (steps, transitions) = if members.arrays {
            (
                elements(&variable(&bound, &["G7S"])?),
                variable(&bound, &["G7T"]).map_or_else(Vec::new, |list| elements(&list)),
            )
        } else {
            let all = |names: &[String]| -> Option<Vec<Variable>> {
                names.iter().map(|name| variable(&bound, &[name.as_str()])).collect()
            };
            (all(&members.steps)?, all(&members.transitions)?)
        };
        let mut page = Page::new(ctx);
        let mut names = FxHashMap::default();
        let kinds = [
            (BITS, Elementary::Bool),
            (NUMBERS, Elementary::Int),
            (PLACES, Elementary::Dint),
            (TIMES, Elementary::Dint),
            (PAIRS, Elementary::Ulint),
        ];
        for (list, ty) in kinds {
            names.extend(list.iter().map(|name| (*name, page.pool.lasting(ctx, ty).variable())));
        }
        let word_type = if is_plain { Elementary::Dword } else { Elementary::Ulint };
        let words = steps.len().div_ceil(word_type.bits() as usize).max(1);
        let mut set = || {
            let word = |_| Some(page.pool.lasting(ctx, word_type).variable());
            Set { words: (0..words).map(word).collect(), ty: word_type }
        };
        let (left, entered, passed) = (set(), set(), set());
        for &(name, other) in QUICK {
            let variable = names[other].clone();
            names.insert(name, variable);
        }
        for (name, set) in [("mask", &left), ("rest", &entered)] {
            names.extend(set.words[0].clone().map(|word| (name, word)));
        }
        for (name, path) in KEPT {
            let found = match chart.dialect {
                Dialect::Tia => variable(&bound, &[&[TIA_DATA], *path].concat())?,
                Dialect::Classic | Dialect::Sfc => variable(&bound, path)?,
            };
            names.insert(*name, found);
        }
        let double = |variable: &Variable| typed(variable, 0, DataType::Elementary(Elementary::Dword));
        names.insert("MOP_D", double(&names["MOP"]));
        names.insert("OLD_D", double(&names["OLD"]));
        for (name, list) in [("SAX_HEAD", "SAX"), ("S0X_HEAD", "S0X"), ("S1X_HEAD", "S1X")] {
            names.insert(name, typed(&names[list], 0, DataType::Elementary(Elementary::Word)));
        }
        names.insert("SQ_BYTE", typed(&names["SQ_FLAGS"], 0, DataType::Elementary(Elementary::Byte)));
        // STARTED and the other bits follow the last seen values.
        names.insert("NOTES", typed(&names["STARTED"], 0, DataType::Elementary(Elementary::Byte)));
        names.insert("MODES", typed(&names["OLD"], 0, DataType::Elementary(Elementary::Lword)));
        names.insert("MOPS", typed(&names["MOPEDGE"], 0, DataType::Elementary(Elementary::Lword)));
        // Each step has the same bit, whatever the words are: the first steps are in the last bytes of eight.
        let place = |word: u32| if is_plain { 4 * (word ^ 1) } else { 8 * word };
        let word = |word| Some(typed(&names["ACTIVE"], place(word), DataType::Elementary(word_type)));
        let active = Set { words: (0..words as u32).map(word).collect(), ty: word_type };
        names.insert("G7S", list(steps.first()?, steps.len(), steps[0].ty.clone()));
        names.insert("RAW", list(steps.first()?, steps.len(), raw_step(layout::bytes(&steps[0].ty))));
        if let Some(first) = transitions.first() {
            names.insert("G7T", list(first, transitions.len(), first.ty.clone()));
            names.insert("TRAW", list(first, transitions.len(), raw_transition(layout::bytes(&first.ty))));
        }
        Some(Engine { chart, index, page, names, steps, transitions, active, left, entered, passed, span, is_plain })
    }

    /// A component of a step.
    pub fn component(&self, step: usize, name: &str) -> Variable {
        member(&self.steps[step], name).expect("both kinds of steps have it")
    }

    /// A step as whole bytes and numbers.
    pub fn raw(&self, step: usize) -> RawStep {
        let part = |byte, ty| typed(&self.steps[step], byte, DataType::Elementary(ty));
        RawStep {
            heads: part(0, Elementary::Word),
            events: part(0, Elementary::Byte),
            states: part(1, Elementary::Byte),
            times: part(4, Elementary::Ulint),
        }
    }

    /// A part of a list of steps, or of other data in the instance.
    pub fn part(&self, name: &str, byte: u32, ty: Elementary) -> Variable {
        typed(&self.names[name], byte, DataType::Elementary(ty))
    }

    /// Where the data of a step is in the instance, and that of a variable.
    pub fn bytes_of_step(&self, step: usize) -> std::ops::Range<u32> {
        bytes_of(&self.steps[step])
    }

    pub fn bytes_of(&self, name: &str) -> std::ops::Range<u32> {
        bytes_of(&self.names[name])
    }

    /// The first word of the set of active steps.
    pub fn active_word(&self) -> &Variable {
        self.active.words[0].as_ref().expect("nothing leaves out a word of the active steps")
    }

    /// Where the data of the chart begins in the instance: parameters and variables of the block are before it.
    pub fn data_begin(&self) -> u32 {
        let kept = KEPT.iter().map(|(name, _)| &self.names[name]);
        let places = self.steps.iter().chain(&self.transitions).chain(kept).map(|variable| variable.byte);
        places.min().unwrap_or(0)
    }

    /// A variable of the engine.
    pub fn variable(&self, name: &str) -> &Variable {
        &self.names[name]
    }

    /// The value of a variable of the engine.
    pub fn value(&self, name: &str) -> Expr {
        load(self.variable(name), self.span)
    }

    /// A bit of MOP.
    pub fn operating(&self, bit: &str, span: Span) -> Expr {
        load(&member(self.variable("MOP"), bit).expect("MOP has all operating bits"), span)
    }

    /// Whether an event of a step occurs in this call, a BOOL.
    pub fn event(&self, step: usize, event: Event, span: Span) -> Expr {
        load(&self.component(step, event.name()), span)
    }

    /// Whether the interlock of a step is satisfied, a BOOL; none if it has no interlock.
    pub fn interlock(&self, step: usize, span: Span) -> Option<Expr> {
        self.chart.steps[step].interlock.as_ref()?;
        let lost = load(&self.component(step, "LA"), span);
        Some(not(lost))
    }

    /// Time since the activation of a step, a TIME.
    pub fn elapsed(&self, step: usize, span: Span) -> Expr {
        load(&self.component(step, "T"), span)
    }

    /// Whether operands of N, D and L must be 0 and calls are not executed (ZERO_OP), a BOOL; none if the chart does not use it.
    pub fn zeroed(&self, span: Span) -> Option<Expr> {
        Some(self.operating("OPS_ZERO", span))
    }

    /// Stores a request for the next call: activate or deactivate step `step`.
    pub fn request(&self, step: usize, on: bool, span: Span) -> Vec<Statement> {
        let list = self.variable(if on { "ASKED_ON" } else { "ASKED_OFF" });
        let bit = &elements(list)[step];
        let yes = || constant_expr(1, Elementary::Bool, span);
        vec![assign(bit, yes(), span), assign(self.variable("REQUESTED"), yes(), span)]
    }

    /// Stores a request for the next call: deactivate all steps but `except`.
    pub fn request_all_off(&self, except: Option<usize>, span: Span) -> Vec<Statement> {
        let steps = (0..self.steps.len()).filter(|step| Some(*step) != except);
        steps.flat_map(|step| self.request(step, false, span)).collect()
    }

    /// The flags TV, TT, TS of a transition, in one byte.
    pub fn flags(&self, transition: usize) -> Variable {
        typed(&self.transitions[transition], 0, DataType::Elementary(Elementary::Byte))
    }

    /// TT of a transition.
    pub fn satisfied(&self, transition: usize, span: Span) -> Expr {
        load(&member(&self.transitions[transition], "TT").expect("transitions have it"), span)
    }

    /// Whether a supervision fault of a step is pending.
    pub fn faulty(&self, step: usize, span: Span) -> Expr {
        load(&self.component(step, "VA"), span)
    }
}

/// AND of conditions; TRUE if there are none.
pub fn all(conditions: impl Iterator<Item = Expr>, span: Span) -> Expr {
    conditions
        .reduce(|left, right| binary_expr(BinaryOp::And, left, right, Elementary::Bool, span))
        .unwrap_or_else(|| constant_expr(1, Elementary::Bool, span))
}

/// NOT of a BOOL, or of all bits.
pub fn not(operand: Expr) -> Expr {
    let (ty, span) = (operand.ty, operand.span);
    Expr { kind: ExprKind::Unary { op: UnaryOp::Not, operand: Box::new(operand) }, ty, span }
}

/// Comparison with a number of the value's type.
pub fn compared(op: CompareOp, left: Expr, right: u64) -> Expr {
    let span = left.span;
    let right = Box::new(number(right, left.ty, span));
    Expr { kind: ExprKind::Compare { op, left: Box::new(left), right }, ty: Elementary::Bool, span }
}

/// A variable of the instance at its path.
fn variable(bound: &BoundInterface, path: &[&str]) -> Option<Variable> {
    let (first, rest) = path.split_first()?;
    let local = bound.locals.get(&fold(first)).filter(|local| local.base == Base::Instance)?;
    let root = Variable { base: local.base, byte: local.byte, bit: local.bit, ty: local.ty.clone(), untyped: false };
    rest.iter().try_fold(root, |variable, name| member(&variable, name))
}

fn member(variable: &Variable, name: &str) -> Option<Variable> {
    let DataType::Struct(structure) = &variable.ty else { return None };
    let member = structure.members.iter().find(|member| member.name.eq_ignore_ascii_case(name))?;
    let (byte, bit, ty) = (variable.byte + member.byte, member.bit, member.ty.clone());
    Some(Variable { base: variable.base, byte, bit, ty, untyped: false })
}

/// Elements of an array, as separate variables.
pub fn elements(array: &Variable) -> Vec<Variable> {
    let DataType::Array(ty) = &array.ty else { return Vec::new() };
    let element = |index| {
        let (byte, bit) = layout::element_place(ty, index);
        Variable { base: array.base, byte: array.byte + byte, bit, ty: ty.element.clone(), untyped: false }
    };
    (0..layout::element_count(&ty.bounds)).map(element).collect()
}

fn bytes_of(variable: &Variable) -> std::ops::Range<u32> {
    variable.byte..variable.byte + layout::bytes(&variable.ty)
}

/// The data at this byte offset in a variable, as another type.
fn typed(variable: &Variable, byte: u32, ty: DataType) -> Variable {
    Variable { base: variable.base, byte: variable.byte + byte, bit: 0, ty, untyped: false }
}

/// Consecutive structures, beginning with the first, as an array from 1.
fn list(first: &Variable, count: usize, element: DataType) -> Variable {
    let bounds = vec![(1, count as i32)];
    let bytes = layout::array_bytes(&bounds, &element) as u32;
    typed(first, 0, DataType::Array(std::rc::Rc::new(ArrayType { bounds, element, bytes })))
}

/// A step as whole bytes and numbers.
fn raw_step(bytes: u32) -> DataType {
    raw(
        bytes,
        &[
            ("EVENTS", Elementary::Byte, 0),
            ("STATES", Elementary::Byte, 1),
            ("SNO", Elementary::Int, 2),
            ("T", Elementary::Dint, 4),
            ("U", Elementary::Dint, 8),
        ],
    )
}

/// A transition as whole bytes and numbers.
fn raw_transition(bytes: u32) -> DataType {
    raw(bytes, &[("FLAGS", Elementary::Byte, 0), ("TNO", Elementary::Int, 2)])
}

fn raw(bytes: u32, members: &[(&str, Elementary, u32)]) -> DataType {
    let member = |&(name, ty, byte): &(&str, Elementary, u32)| Member {
        name: name.to_string(),
        ty: DataType::Elementary(ty),
        byte,
        bit: 0,
        external: External::default(),
    };
    let members = members.iter().map(member).collect();
    DataType::Struct(std::rc::Rc::new(StructType {
        name: String::new(),
        instance_of: None,
        refers_to: None,
        members,
        bytes,
    }))
}
