//! The functions of the language: one row each, found by name with or without the suffix of a type.
//!
//! Pins are a list of words: `?` before one that may be missing, `>` before an output, `|` between spellings, `+` after the first of
//! numbered ones (`IN1+` is IN1, IN2, …). `number`, `timer`, `memory` and `text` have what each function computes; what is neither a row
//! nor a conversion is a block of the standard library.
//! Source: SCL reference, functions.

use plcc_diag::{Code, Span};
use plcc_syntax::Elementary;
use plcc_syntax::scl::ast::Argument as Given;

use super::naming::Naming;
use super::value::Value;
use super::variant::Question;
use super::{convert, text};
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_model::scl::{BinaryOp, Function, TimerKind};

/// The computation of a function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// From a float, a float.
    Float(Function),
    /// From a number, a number of the same type.
    Absolute,
    /// The least or greatest of several values.
    Extreme(BinaryOp),
    Limit,
    Select,
    Mux,
    Demux,
    NormX,
    ScaleX,
    /// Float to integer, with the name that [`convert::rounding`] looks up.
    Round,
    /// Shift or rotate.
    Shift(BinaryOp),
    Swap,
    Encode,
    Decode,
    BitSum,
    IsValid,
    /// LOWER_BOUND, UPPER_BOUND.
    Bound {
        upper: bool,
    },
    CountOfElements,
    /// TypeOf, TypeOfElements, IS_ARRAY.
    Type(Question),
    /// GetBlockName, GetInstanceName, GetInstancePath.
    Naming(Naming),
    Timer(TimerKind),
    /// S_CU, S_CD, S_CUD.
    Counter,
    Peek {
        bit: bool,
    },
    Poke {
        bit: bool,
    },
    PokeBlock,
    MoveBlock,
    FillBlock,
    Scatter,
    Gather,
    /// SCATTER_BLK, else GATHER_BLK.
    ScatterBlock {
        to_bits: bool,
    },
    /// Text to text, without a value.
    MoveText,
    /// RESET_TIMER.
    ResetTimer,
    /// PRESET_TIMER.
    PresetTimer,
    Concat,
    /// S_CONV, STRG_VAL, VAL_STRG.
    TextNumber(TextNumber),
    /// An operator as a function: T_ADD, T_SUB.
    Operator(plcc_syntax::scl::ast::BinaryOp),
    /// T_CONV: the value itself, which then converts to the required type.
    Identity,
}

/// Instructions between numbers and texts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TextNumber {
    Convert,
    Read,
    Write,
}

/// A function.
#[derive(Debug)]
pub struct Row {
    pub name: &'static str,
    pub pins: &'static str,
    pub kind: Kind,
    /// The name may carry a type after `_`.
    pub suffix: bool,
}

const fn row(name: &'static str, pins: &'static str, kind: Kind) -> Row {
    Row { name, pins, kind, suffix: false }
}

const fn typed(name: &'static str, pins: &'static str, kind: Kind) -> Row {
    Row { name, pins, kind, suffix: true }
}

const TIMER: &str = "T_NO ?S ?TV ?R ?>Q ?>BI";

/// The functions that are computed in place.
pub const FUNCTIONS: &[Row] = &[
    typed("ABS", "IN", Kind::Absolute),
    typed("SQR", "IN", Kind::Float(Function::Sqr)),
    typed("SQRT", "IN", Kind::Float(Function::Sqrt)),
    typed("EXP", "IN", Kind::Float(Function::Exp)),
    typed("EXPD", "IN", Kind::Float(Function::Expd)),
    typed("LN", "IN", Kind::Float(Function::Ln)),
    typed("LOG", "IN", Kind::Float(Function::Log)),
    typed("SIN", "IN", Kind::Float(Function::Sin)),
    typed("COS", "IN", Kind::Float(Function::Cos)),
    typed("TAN", "IN", Kind::Float(Function::Tan)),
    typed("ASIN", "IN", Kind::Float(Function::Asin)),
    typed("ACOS", "IN", Kind::Float(Function::Acos)),
    typed("ATAN", "IN", Kind::Float(Function::Atan)),
    typed("FRAC", "IN", Kind::Float(Function::Frac)),
    typed("ROUND", "IN", Kind::Round),
    typed("TRUNC", "IN", Kind::Round),
    typed("CEIL", "IN", Kind::Round),
    typed("FLOOR", "IN", Kind::Round),
    typed("MIN", "IN1+", Kind::Extreme(BinaryOp::Min)),
    typed("MAX", "IN1+", Kind::Extreme(BinaryOp::Max)),
    typed("LIMIT", "MN|MIN IN MX|MAX", Kind::Limit),
    typed("SEL", "G IN0 IN1", Kind::Select),
    typed("MUX", "K IN0+ ?INELSE|ELSE", Kind::Mux),
    row("DEMUX", "K IN >OUT0+ ?>OUTELSE|ELSE", Kind::Demux),
    typed("NORM_X", "MIN VALUE MAX", Kind::NormX),
    typed("SCALE_X", "MIN VALUE MAX", Kind::ScaleX),
    typed("SHL", "IN N", Kind::Shift(BinaryOp::ShiftLeft)),
    typed("SHR", "IN N", Kind::Shift(BinaryOp::ShiftRight)),
    typed("ROL", "IN N", Kind::Shift(BinaryOp::RotateLeft)),
    typed("ROR", "IN N", Kind::Shift(BinaryOp::RotateRight)),
    typed("SWAP", "IN", Kind::Swap),
    row("ENCO", "IN", Kind::Encode),
    typed("DECO", "IN", Kind::Decode),
    row("BITSUM", "IN", Kind::BitSum),
    row("IS_VALID", "IN", Kind::IsValid),
    row("LOWER_BOUND", "ARR DIM", Kind::Bound { upper: false }),
    row("UPPER_BOUND", "ARR DIM", Kind::Bound { upper: true }),
    row("CountOfElements", "IN", Kind::CountOfElements),
    row("TypeOf", "IN", Kind::Type(Question::Type)),
    row("TypeOfElements", "IN", Kind::Type(Question::ElementType)),
    row("IS_ARRAY", "IN", Kind::Type(Question::IsArray)),
    row("RESET_TIMER", "TIMER", Kind::ResetTimer),
    row("PRESET_TIMER", "PT TIMER", Kind::PresetTimer),
    row("S_PULSE", TIMER, Kind::Timer(TimerKind::Pulse)),
    row("S_PEXT", TIMER, Kind::Timer(TimerKind::ExtendedPulse)),
    row("S_ODT", TIMER, Kind::Timer(TimerKind::OnDelay)),
    row("S_ODTS", TIMER, Kind::Timer(TimerKind::RetentiveOnDelay)),
    row("S_OFFDT", TIMER, Kind::Timer(TimerKind::OffDelay)),
    row("S_CU", "C_NO ?CU ?S ?PV ?R ?>Q ?>CV", Kind::Counter),
    row("S_CD", "C_NO ?CD ?S ?PV ?R ?>Q ?>CV", Kind::Counter),
    row("S_CUD", "C_NO ?CU ?CD ?S ?PV ?R ?>Q ?>CV", Kind::Counter),
    row("PEEK_BOOL", "AREA DBNUMBER BYTEOFFSET BITOFFSET", Kind::Peek { bit: true }),
    typed("PEEK", "AREA DBNUMBER BYTEOFFSET", Kind::Peek { bit: false }),
    row("POKE_BOOL", "AREA DBNUMBER BYTEOFFSET BITOFFSET VALUE", Kind::Poke { bit: true }),
    row(
        "POKE_BLK",
        "AREA_SRC DBNUMBER_SRC BYTEOFFSET_SRC AREA_DEST DBNUMBER_DEST BYTEOFFSET_DEST COUNT",
        Kind::PokeBlock,
    ),
    typed("POKE", "AREA DBNUMBER BYTEOFFSET VALUE", Kind::Poke { bit: false }),
    row("MOVE_BLK", "IN COUNT >OUT", Kind::MoveBlock),
    row("UMOVE_BLK", "IN COUNT >OUT", Kind::MoveBlock),
    row("FILL_BLK", "IN COUNT >OUT", Kind::FillBlock),
    row("UFILL_BLK", "IN COUNT >OUT", Kind::FillBlock),
    row("SCATTER", "IN >OUT", Kind::Scatter),
    row("GATHER", "IN >OUT", Kind::Gather),
    row("SCATTER_BLK", "IN COUNT_IN >OUT", Kind::ScatterBlock { to_bits: true }),
    row("GATHER_BLK", "IN COUNT_OUT >OUT", Kind::ScatterBlock { to_bits: false }),
    row("S_MOVE", "IN >OUT", Kind::MoveText),
    row("CONCAT", "IN1+", Kind::Concat),
    row("CONCAT_STRING", "IN1+", Kind::Concat),
    row("CONCAT_WSTRING", "IN1+", Kind::Concat),
    row("S_CONV", "IN >OUT", Kind::TextNumber(TextNumber::Convert)),
    row("STRG_VAL", "IN FORMAT P >OUT", Kind::TextNumber(TextNumber::Read)),
    row("VAL_STRG", "IN SIZE PREC FORMAT P >OUT", Kind::TextNumber(TextNumber::Write)),
    row("T_ADD", "IN1 IN2", Kind::Operator(plcc_syntax::scl::ast::BinaryOp::Add)),
    row("T_SUB", "IN1 IN2", Kind::Operator(plcc_syntax::scl::ast::BinaryOp::Subtract)),
    row("T_DIFF", "IN1 IN2", Kind::Operator(plcc_syntax::scl::ast::BinaryOp::Subtract)),
    row("T_CONV", "IN", Kind::Identity),
];

/// Functions about the block in which they are called.
pub const NAMING: &[Row] = &[
    row("GetBlockName", "SIZE", Kind::Naming(Naming::Block)),
    row("GetInstanceName", "SIZE", Kind::Naming(Naming::Instance)),
    row("GetInstancePath", "SIZE", Kind::Naming(Naming::Path)),
];

/// A function that a name means.
#[derive(Clone, Debug)]
pub enum Named {
    Row {
        row: &'static Row,
        suffix: Option<Elementary>,
    },
    /// `INT_TO_REAL`, `TO_REAL`.
    Convert {
        from: Option<Elementary>,
        to: Elementary,
    },
    /// Upper case.
    Bcd(String),
    /// `INT_TO_STRING`, `DTL_TO_DATE`: of types that are not single values. Upper case.
    Text(String),
}

impl Named {
    /// The function with this name, in any letter case.
    pub fn find(name: &str) -> Option<Named> {
        let upper = name.trim().to_ascii_uppercase();
        if let Some(row) = find_row(&upper) {
            return Some(Named::Row { row, suffix: None });
        }
        if convert::bcd(super::Rules::Classic, &upper).is_some() {
            return Some(Named::Bcd(upper));
        }
        if let Some((from, to)) = convert::pair(&upper) {
            return Some(Named::Convert { from: Some(from), to });
        }
        if let Some(to) = upper.strip_prefix("TO_").and_then(Elementary::from_word) {
            return Some(Named::Convert { from: None, to });
        }
        if text::is_conversion(&upper) {
            return Some(Named::Text(upper));
        }
        let of_any = format!("{}_{upper}", text::ANY_TYPE);
        if text::is_conversion(&of_any) {
            return Some(Named::Text(of_any));
        }
        let (base, suffix) = upper.rsplit_once('_')?;
        let suffix = Elementary::from_word(suffix)?;
        find_row(base).filter(|row| row.suffix).map(|row| Named::Row { row, suffix: Some(suffix) })
    }
}

fn find_row(upper: &str) -> Option<&'static Row> {
    FUNCTIONS.iter().chain(NAMING).find(|row| row.name.eq_ignore_ascii_case(upper))
}

/// Names of the functions, for messages.
pub fn names() -> impl Iterator<Item = &'static str> {
    FUNCTIONS.iter().chain(NAMING).map(|row| row.name)
}

impl SclBinder<'_, '_> {
    /// Reports a wrong name of the only input of a conversion; false: there is none.
    fn misnamed_input(&mut self, ctx: &mut SclBlock, given: &[Given], called: Span) -> bool {
        // `OUT` and others of conversions of texts have their own checks.
        let [Given { name: Some(name), output: false, value: Some(value), .. }] = given else { return false };
        if ["IN", "EN", "ENO"].iter().any(|known| known.eq_ignore_ascii_case(&name.text)) {
            return false;
        }
        let title = format!("{} has no parameter `{}`", self.program.globals.text(called), name.text);
        let help = format!("write `IN := {}`, or the value alone", self.program.globals.text(value.span));
        self.refuse(Code::UnknownParameter, name.span, &title, "a conversion has the input IN", &help);
        self.note_arguments(ctx, given);
        true
    }

    /// Binds the call of a function of the language.
    pub fn function(
        &mut self,
        ctx: &mut SclBlock,
        named: &Named,
        given: &[Given],
        name: Span,
        span: Span,
        statement: bool,
    ) -> Option<Value> {
        let (row, suffix) = match named {
            Named::Row { row, suffix } => (*row, *suffix),
            Named::Convert { .. } | Named::Bcd(_) | Named::Text(_) if self.misnamed_input(ctx, given, name) => {
                return None;
            }
            Named::Convert { from, to } => return self.conversion(ctx, *from, *to, given, name, span),
            Named::Bcd(name) => return self.bcd_conversion(ctx, name, given, span),
            Named::Text(function) => return self.text_conversion(ctx, function, given, name, span),
        };
        let pins = self.pins(ctx, row, given, name)?;
        match row.kind {
            Kind::Float(_)
            | Kind::Absolute
            | Kind::Extreme(_)
            | Kind::Limit
            | Kind::Select
            | Kind::Mux
            | Kind::NormX
            | Kind::ScaleX
            | Kind::Round
            | Kind::Shift(_)
            | Kind::Swap
            | Kind::Encode
            | Kind::Decode
            | Kind::BitSum
            | Kind::IsValid => self.number_function(ctx, row, suffix, &pins, span),
            Kind::Operator(op) => self.operator_function(ctx, op, &pins, span),
            Kind::Identity => self.value(ctx, pins.get("IN")?),
            Kind::Bound { upper } => self.bound_function(ctx, upper, &pins, span),
            Kind::CountOfElements => self.count_of_elements(ctx, &pins, span),
            Kind::Type(question) => self.type_question(ctx, question, &pins, span),
            Kind::Naming(naming) => self.naming_function(ctx, naming, &pins, span),
            Kind::Timer(kind) => self.timer_function(ctx, kind, &pins, span),
            Kind::Counter => self.counter_function(ctx, &pins, span),
            Kind::Peek { bit } => self.peek(ctx, suffix, bit, &pins, span),
            Kind::Concat => self.concat(ctx, &pins, name, span),
            Kind::Demux
            | Kind::Poke { .. }
            | Kind::PokeBlock
            | Kind::MoveBlock
            | Kind::FillBlock
            | Kind::Scatter
            | Kind::Gather
            | Kind::ScatterBlock { .. }
            | Kind::MoveText
            | Kind::ResetTimer
            | Kind::PresetTimer
            | Kind::TextNumber(_) => {
                if !statement {
                    self.no_value(name);
                    return None;
                }
                self.statement_function(ctx, row, suffix, &pins, span)
            }
        }
    }
}
