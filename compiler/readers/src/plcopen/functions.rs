//! Standard functions of IEC 61131-3 in the words of SCL, and standard function blocks of the editors.
//!
//! | IEC | SCL |
//! | --- | --- |
//! | `ADD(a, b, c)`, `MULTIME(t, n)`, `SUB_TOD_TOD(a, b)` | operators |
//! | `GE(a, b, c)` | `a >= b AND b >= c` |
//! | `INT_TO_BOOL(i)` | `i <> 0`: SCL uses the lowest bit |
//! | `INT_TO_STRING(i)`, `WORD_TO_STRING(w)` | without sign and blanks, with a function of the library |
//! | `BCD_TO_INT(w)`, `WORD_BCD_TO_UINT(w)` | all digits count, with a function of the library |
//! | `TIME_TO_INT(t)` | milliseconds; in editors that compile with MATIEC seconds |
//! | `WORD_TO_REAL(w)`, `REAL_TO_WORD(r)` | a bit string is a number without sign; SCL keeps the bits of a DWORD or LWORD, and has no others |
//! | `DATE_TO_DINT(d)`, `SUB_DT_DT(a, b)` | seconds since 1970, differences as TIME: see `dates` |
//!
//! Functions with the same name and meaning in SCL are not changed. Source: IEC 61131-3, standard functions and function blocks.

mod dates;
pub mod floats;
pub mod texts;

use plcc_diag::{Code, Diagnostic, Span};

use super::editor::Editor;
use super::types::Ty;
use plcc_syntax::Elementary;
use plcc_syntax::scl::ast::{Argument, BinaryOp, Expr, ExprKind, Literal, Name, NameForm, UnaryOp};

/// Integers by name.
pub const INTEGERS: &[&str] = &["SINT", "INT", "DINT", "LINT", "USINT", "UINT", "UDINT", "ULINT"];
const BIT_STRINGS: &[&str] = &["BYTE", "WORD", "DWORD", "LWORD"];
const FLOATS: &[&str] = &["REAL", "LREAL"];

/// Function blocks of the editors: names, and the block of the library; for MATIEC a different one where needed.
const BLOCKS: &[(&str, &str, &str)] = &[
    ("CTU", "IEC_CTU", "IEC_CTU_INT"),
    ("CTD", "IEC_CTD_INT", "IEC_CTD_INT"),
    ("CTUD", "IEC_CTUD", "IEC_CTUD_INT"),
    ("CTU_INT", "IEC_CTU", "IEC_CTU_INT"),
    ("CTD_INT", "IEC_CTD_INT", "IEC_CTD_INT"),
    ("CTUD_INT", "IEC_CTUD", "IEC_CTUD_INT"),
    ("CTU_DINT", "IEC_CTU_DINT", "IEC_CTU_DINT"),
    ("CTD_DINT", "IEC_CTD_DINT", "IEC_CTD_DINT"),
    ("CTUD_DINT", "IEC_CTUD_DINT", "IEC_CTUD_DINT"),
    ("CTU_UDINT", "IEC_CTU_UDINT", "IEC_CTU_UDINT"),
    ("CTD_UDINT", "IEC_CTD_UDINT", "IEC_CTD_UDINT"),
    ("CTUD_UDINT", "IEC_CTUD_UDINT", "IEC_CTUD_UDINT"),
    ("CTU_LINT", "IEC_CTU_LINT", "IEC_CTU_LINT"),
    ("CTD_LINT", "IEC_CTD_LINT", "IEC_CTD_LINT"),
    ("CTUD_LINT", "IEC_CTUD_LINT", "IEC_CTUD_LINT"),
    ("CTU_ULINT", "IEC_CTU_ULINT", "IEC_CTU_ULINT"),
    ("CTD_ULINT", "IEC_CTD_ULINT", "IEC_CTD_ULINT"),
    ("CTUD_ULINT", "IEC_CTUD_ULINT", "IEC_CTUD_ULINT"),
    ("SEMA", "IEC_SEMA", "IEC_SEMA_MATIEC"),
    ("RTC", "IEC_RTC", "IEC_RTC"),
    ("INTEGRAL", "IEC_INTEGRAL", "IEC_INTEGRAL"),
    ("DERIVATIVE", "IEC_DERIVATIVE", "IEC_DERIVATIVE"),
    ("PID", "IEC_PID", "IEC_PID"),
    ("RAMP", "IEC_RAMP", "IEC_RAMP"),
    ("HYSTERESIS", "IEC_HYSTERESIS", "IEC_HYSTERESIS"),
];

/// The block of the library for a standard function block of the editor.
pub fn block(editor: Editor, name: &str) -> Option<&'static str> {
    // In all other projects, also those that plcc writes, it is that of the TIA Portal.
    if editor != Editor::Other && name.eq_ignore_ascii_case("F_TRIG") {
        return Some("IEC_F_TRIG");
    }
    let (_, other, matiec) = BLOCKS.iter().find(|(known, ..)| known.eq_ignore_ascii_case(name))?;
    Some(if editor == Editor::Matiec { matiec } else { other })
}

/// The name of IEC 61131-3 for an input of SR or RS, which CODESYS calls `SET1`, `RESET`, `SET` and `RESET1`.
pub fn flip_flop_pin(written: &str) -> &str {
    const PINS: [(&str, &str); 4] = [("SET", "S"), ("SET1", "S1"), ("RESET", "R"), ("RESET1", "R1")];
    PINS.iter().find(|(name, _)| name.eq_ignore_ascii_case(written)).map_or(written, |(_, pin)| pin)
}

/// The call of a standard function in the words of SCL; `None`: SCL has it by this name, or it is not a standard function.
pub fn rewritten(
    editor: Editor,
    name: &Name,
    arguments: &[Argument],
    kinds: &[Option<Ty>],
    span: Span,
    tell: &mut dyn FnMut(Diagnostic),
) -> Option<ExprKind> {
    let upper = name.text.to_ascii_uppercase();
    let (values, kinds): (Vec<Expr>, Vec<Option<Ty>>) = inputs(arguments, kinds)?.into_iter().unzip();
    let make = Make { name: name.span, span };
    // CODESYS: the time since the start.
    if upper == "TIME" && values.is_empty() && editor != Editor::Matiec {
        let callee = Name { text: "TIME_TCK".to_string(), form: NameForm::Bare, span: name.span };
        let callee = Box::new(Expr { kind: ExprKind::Name(callee), span: name.span });
        return Some(ExprKind::Call { callee, arguments: Vec::new() });
    }
    if let Some(kind) = scaled(&make, &upper, &values, &kinds).or_else(|| dates::function(&make, &upper, &values, tell))
    {
        return Some(kind);
    }
    if let Some(kind) = operator(&make, &upper, &values) {
        return Some(kind);
    }
    let [value] = values.as_slice() else { return None };
    let value = value.clone();
    conversion(editor, &make, &upper, value, tell)
}

/// The values of IN1, IN2 … or IN, in this order; `None`: there are other formals.
fn inputs(arguments: &[Argument], kinds: &[Option<Ty>]) -> Option<Vec<(Expr, Option<Ty>)>> {
    let mut numbered: Vec<(u32, (Expr, Option<Ty>))> = Vec::with_capacity(arguments.len());
    for (at, argument) in arguments.iter().enumerate() {
        let number = match &argument.name {
            None => at as u32,
            Some(_) if argument.output => return None,
            Some(name) => {
                let digits = name.text.to_ascii_uppercase();
                let digits = digits.strip_prefix("IN")?;
                if digits.is_empty() { 1 } else { digits.parse().ok()? }
            }
        };
        numbered.push((number, (argument.value.clone()?, kinds.get(at).cloned().flatten())));
    }
    numbered.sort_by_key(|(number, _)| *number);
    Some(numbered.into_iter().map(|(_, value)| value).collect())
}

struct Make {
    name: Span,
    span: Span,
}

impl Make {
    fn expr(&self, kind: ExprKind) -> Expr {
        Expr { kind, span: self.span }
    }

    fn binary(&self, op: BinaryOp, left: Expr, right: Expr) -> Expr {
        self.expr(ExprKind::Binary { op, op_span: self.name, left: Box::new(left), right: Box::new(right) })
    }

    fn call(&self, name: &str, value: Expr) -> Expr {
        self.call_with(name, vec![value])
    }

    fn call_with(&self, name: &str, values: Vec<Expr>) -> Expr {
        let callee = Name { text: name.to_string(), form: NameForm::Bare, span: self.name };
        let callee = Box::new(Expr { kind: ExprKind::Name(callee), span: self.name });
        let argument = |value: Expr| Argument { name: None, output: false, span: value.span, value: Some(value) };
        self.expr(ExprKind::Call { callee, arguments: values.into_iter().map(argument).collect() })
    }

    /// `from_TO_to(value)`
    fn convert(&self, from: &str, to: &str, value: Expr) -> Expr {
        if from == to { value } else { self.call(&format!("{from}_TO_{to}"), value) }
    }

    fn number(&self, value: u64) -> Expr {
        self.expr(ExprKind::Literal(Literal::Integer { value, based: false }))
    }

    fn real(&self, value: f64) -> Expr {
        self.expr(ExprKind::Literal(Literal::Real(value)))
    }
}

/// An operator, from the first operand to the last.
fn operator(make: &Make, upper: &str, values: &[Expr]) -> Option<ExprKind> {
    let chain = |op| {
        let mut values = values.iter().cloned();
        let first = values.next()?;
        Some(values.fold(first, |left, right| make.binary(op, left, right)).kind)
    };
    let pair = |op| if values.len() == 2 { chain(op) } else { None };
    let compared = |op| {
        let pairs = values.windows(2).map(|pair| make.binary(op, pair[0].clone(), pair[1].clone()));
        pairs.reduce(|left, right| make.binary(BinaryOp::And, left, right)).map(|value| value.kind)
    };
    match upper {
        "ADD" if values.len() > 1 => chain(BinaryOp::Add),
        "MUL" if values.len() > 1 => chain(BinaryOp::Multiply),
        "AND" if values.len() > 1 => chain(BinaryOp::And),
        "OR" if values.len() > 1 => chain(BinaryOp::Or),
        "XOR" if values.len() > 1 => chain(BinaryOp::Xor),
        "SUB" => pair(BinaryOp::Subtract),
        "DIV" => pair(BinaryOp::Divide),
        "MOD" => pair(BinaryOp::Modulo),
        "EXPT" => pair(BinaryOp::Power),
        "NOT" | "MOVE" => {
            let [value] = values else { return None };
            let operand = Box::new(value.clone());
            Some(if upper == "MOVE" { operand.kind } else { ExprKind::Unary { op: UnaryOp::Not, operand } })
        }
        "GT" => compared(BinaryOp::Greater),
        "GE" => compared(BinaryOp::GreaterEqual),
        "EQ" => compared(BinaryOp::Equal),
        "LE" => compared(BinaryOp::LessEqual),
        "LT" => compared(BinaryOp::Less),
        "NE" => {
            if values.len() == 2 {
                compared(BinaryOp::NotEqual)
            } else {
                None
            }
        }
        "ADD_TIME" | "ADD_TOD_TIME" | "ADD_DT_TIME" => pair(BinaryOp::Add),
        "SUB_TIME" | "SUB_TOD_TIME" | "SUB_TOD_TOD" | "SUB_DT_TIME" => pair(BinaryOp::Subtract),
        "MULTIME" | "MUL_TIME" => pair(BinaryOp::Multiply),
        "DIVTIME" | "DIV_TIME" => pair(BinaryOp::Divide),
        _ => None,
    }
}

/// `MULTIME(t, 1.5)`, `DIVTIME(t, 2.5)`: a TIME and a number with a fraction, which SCL does not combine.
fn scaled(make: &Make, upper: &str, values: &[Expr], kinds: &[Option<Ty>]) -> Option<ExprKind> {
    let op = match upper {
        "MULTIME" | "MUL_TIME" => BinaryOp::Multiply,
        "DIVTIME" | "DIV_TIME" => BinaryOp::Divide,
        _ => return None,
    };
    let [time, factor] = values else { return None };
    let kind = kinds.get(1).cloned().flatten();
    let is_float =
        kind.as_ref().is_some_and(Ty::is_float) || matches!(factor.kind, ExprKind::Literal(Literal::Real(_)));
    is_float.then(|| scaled_time(make, op, time, factor, kind.as_ref()))
}

/// A TIME multiplied or divided by a number with a fraction, to whole milliseconds; in LREAL, which loses no millisecond.
fn scaled_time(make: &Make, op: BinaryOp, time: &Expr, factor: &Expr, kind: Option<&Ty>) -> ExprKind {
    let milliseconds = make.call("DINT_TO_LREAL", make.call("TIME_TO_DINT", time.clone()));
    let literal = matches!(factor.kind, ExprKind::Literal(_));
    let factor = match kind {
        Some(Ty::Of(Elementary::Real)) if !literal => make.call("REAL_TO_LREAL", factor.clone()),
        _ => factor.clone(),
    };
    let product = make.binary(op, milliseconds, factor);
    make.call("DINT_TO_TIME", make.call("LREAL_TO_DINT", product)).kind
}

/// An operator that SCL expresses in another way: `T#1s * r`, `r * T#1s`, `T#10s / r`, and the difference of dates.
pub fn operation(
    op: BinaryOp,
    op_span: Span,
    (left, a): (&Expr, &Option<Ty>),
    (right, b): (&Expr, &Option<Ty>),
    span: Span,
    tell: &mut dyn FnMut(Diagnostic),
) -> Option<ExprKind> {
    let make = Make { name: op_span, span };
    let is_time = |kind: &Option<Ty>| matches!(kind, Some(Ty::Of(Elementary::Time)));
    let is_float = |kind: &Option<Ty>| kind.as_ref().is_some_and(Ty::is_float);
    let is_date = |kind: &Option<Ty>| kind.as_ref().is_some_and(Ty::is_date);
    match op {
        BinaryOp::Multiply | BinaryOp::Divide if is_time(a) && is_float(b) => {
            Some(scaled_time(&make, op, left, right, b.as_ref()))
        }
        BinaryOp::Multiply if is_float(a) && is_time(b) => Some(scaled_time(&make, op, right, left, a.as_ref())),
        BinaryOp::Subtract if is_date(a) && is_date(b) => Some(dates::difference(&make, left, right, tell)),
        _ => None,
    }
}

/// Conversions that SCL lacks or defines differently.
fn conversion(
    editor: Editor,
    make: &Make,
    upper: &str,
    value: Expr,
    tell: &mut dyn FnMut(Diagnostic),
) -> Option<ExprKind> {
    let is = |list: &[&str], name: &str| list.contains(&name);
    if let Some((from, to)) = upper.split_once("_TRUNC_") {
        return (is(FLOATS, from) && is(INTEGERS, to)).then(|| make.call(&format!("TRUNC_{to}"), value).kind);
    }
    if let Some(kind) = bcd(make, upper, &value) {
        return Some(kind);
    }
    let (from, to) = upper.split_once("_TO_")?;
    if editor == Editor::Matiec && matches!(from, "TOD" | "TIME_OF_DAY") && (is(INTEGERS, to) || is(FLOATS, to)) {
        tell(seconds(make, upper));
        let seconds = make.binary(BinaryOp::Divide, make.call("TOD_TO_DINT", value), make.number(1000));
        return Some(make.convert("DINT", to, seconds).kind);
    }
    let time_literal = || make.expr(ExprKind::Literal(Literal::Typed { ty: Elementary::Time, bits: 0 }));
    let kind = match (from, to) {
        (from, "BOOL") if is(INTEGERS, from) || is(BIT_STRINGS, from) => {
            make.binary(BinaryOp::NotEqual, value, make.number(0)).kind
        }
        (from, "BOOL") if is(FLOATS, from) => make.binary(BinaryOp::NotEqual, value, make.real(0.0)).kind,
        ("TIME", "BOOL") => make.binary(BinaryOp::NotEqual, value, time_literal()).kind,
        (from, "STRING") if is(&["SINT", "INT", "DINT", "USINT", "UINT"], from) => {
            make.call("IEC_DINT_TO_STRING", make.convert(from, "DINT", value)).kind
        }
        (from, "STRING") if is(&["UDINT", "LINT"], from) => {
            make.call("IEC_LINT_TO_STRING", make.convert(from, "LINT", value)).kind
        }
        (from, "STRING") if is(BIT_STRINGS, from) && editor != Editor::Matiec => {
            let number = floats::unsigned(from);
            return conversion(
                editor,
                make,
                &format!("{number}_TO_STRING"),
                make.call(&format!("{from}_TO_{number}"), value),
                tell,
            );
        }
        // The sign that SCL writes is removed.
        ("ULINT", "STRING") => {
            make.call_with("DELETE", vec![make.call(upper, value), make.number(1), make.number(1)]).kind
        }
        (from, "STRING") if is(FLOATS, from) => {
            let text = format!("`{upper}` writes the number as the TIA Portal does: +1.500000E+000");
            let message =
                Diagnostic::new(Code::Tolerated, make.name, text).label("other editors write it in other forms");
            tell(message.help("convert the parts of the number as integers where the form matters"));
            return None;
        }
        ("BOOL", "STRING") => make.call("IEC_BOOL_TO_STRING", value).kind,
        ("BOOL", to) if is(FLOATS, to) => make.convert("INT", to, make.call("BOOL_TO_INT", value)).kind,
        (from, to) if is(BIT_STRINGS, from) && is(FLOATS, to) => {
            if let Some(warning) = keeps_bits(editor, make, (from, to), upper) {
                tell(warning);
            }
            let number = floats::unsigned(from);
            make.convert(number, to, make.call(&format!("{from}_TO_{number}"), value)).kind
        }
        (from, to) if is(FLOATS, from) && is(BIT_STRINGS, to) => {
            if let Some(warning) = keeps_bits(editor, make, (to, from), upper) {
                tell(warning);
            }
            let number = floats::unsigned(to);
            make.convert(number, to, make.call(&format!("{from}_TO_{number}"), value)).kind
        }
        ("TIME", to) if is(INTEGERS, to) || is(FLOATS, to) || is(BIT_STRINGS, to) => {
            let milliseconds = make.call("TIME_TO_DINT", value);
            if editor == Editor::Matiec && !is(BIT_STRINGS, to) {
                tell(seconds(make, upper));
                match is(FLOATS, to) {
                    true => {
                        let value = make.convert("DINT", to, milliseconds);
                        make.binary(BinaryOp::Divide, value, make.real(1000.0)).kind
                    }
                    false => {
                        let value = make.binary(BinaryOp::Divide, milliseconds, make.number(1000));
                        make.convert("DINT", to, value).kind
                    }
                }
            } else {
                make.convert("DINT", to, milliseconds).kind
            }
        }
        (from, "TIME") if is(INTEGERS, from) || is(FLOATS, from) || is(BIT_STRINGS, from) => {
            let (factor, is_float) = (editor == Editor::Matiec && !is(BIT_STRINGS, from), is(FLOATS, from));
            if factor {
                tell(seconds(make, upper));
            }
            let milliseconds = match (factor, is_float) {
                (true, true) => make.call("TRUNC_DINT", make.binary(BinaryOp::Multiply, value, make.real(1000.0))),
                (true, false) => make.binary(BinaryOp::Multiply, make.convert(from, "DINT", value), make.number(1000)),
                (false, _) => make.convert(from, "DINT", value),
            };
            make.call("DINT_TO_TIME", milliseconds).kind
        }
        _ => return None,
    };
    Some(kind)
}

/// The warning that editors differ: whether a bit string and a float of the same length have the same value or the same bits.
fn keeps_bits(editor: Editor, make: &Make, lengths: (&str, &str), name: &str) -> Option<Diagnostic> {
    if editor == Editor::Codesys || !matches!(lengths, ("DWORD", "REAL") | ("LWORD", "LREAL")) {
        return None;
    }
    let text = format!("`{name}` converts the value in this editor, and keeps the bits in others");
    let message = Diagnostic::new(Code::Tolerated, make.name, text).label("read as a number without sign");
    Some(message.help("convert through UDINT or ULINT: that means the same everywhere"))
}

fn seconds(make: &Make, name: &str) -> Diagnostic {
    let text = format!("`{name}` counts seconds in this editor, and milliseconds in others");
    let message = Diagnostic::new(Code::Tolerated, make.name, text).label("read as seconds");
    message.help("divide the TIME by a TIME, or multiply a TIME by the number: that means the same everywhere")
}

/// `BCD_TO_INT`, `WORD_BCD_TO_UINT`, `INT_TO_BCD`, `UINT_TO_BCD_WORD`.
fn bcd(make: &Make, upper: &str, value: &Expr) -> Option<ExprKind> {
    if !upper.contains("BCD") {
        return None;
    }
    let (from, to) = upper.split_once("_TO_")?;
    if from == "BCD" || from.strip_suffix("_BCD").is_some_and(|bits| BIT_STRINGS.contains(&bits)) {
        let number = make.call("IEC_BCD_TO_DINT", value.clone());
        let known = INTEGERS.contains(&to) || BIT_STRINGS.contains(&to);
        return known.then(|| make.convert("DINT", to, number).kind);
    }
    let bits = if to == "BCD" { "WORD" } else { to.strip_prefix("BCD_")? };
    if !BIT_STRINGS.contains(&bits) || !INTEGERS.contains(&from) && !BIT_STRINGS.contains(&from) {
        return None;
    }
    let digits = make.call("IEC_DINT_TO_BCD", make.convert(from, "DINT", value.clone()));
    Some(make.convert("DWORD", bits, digits).kind)
}
