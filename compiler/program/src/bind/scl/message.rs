//! Messages that several steps report.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::Elementary;
use plcc_syntax::ast::CellKind;

use super::scope::Scope;
use super::value::Value;
use super::{Rules, convert};
use crate::bind::scl::SclBinder;
use plcc_binding::constant::Constant;
use plcc_binding::rewrite;
use plcc_model::layout;
use plcc_model::types::Class;

/// Nesting of expressions and statements beyond what anyone can read.
pub const DEPTH_MAX: u32 = 200;

impl SclBinder<'_, '_> {
    pub(super) fn too_deep(&mut self, span: Span) {
        self.program.report(
            Diagnostic::new(Code::Syntax, span, "this is nested too deep")
                .label(format!("more than {} levels", DEPTH_MAX))
                .help("store parts of it in variables, or split the block"),
        );
    }

    /// A value whose type does not convert to `wanted` implicitly.
    pub(in crate::bind) fn wrong_type(&mut self, span: Span, is: &str, wanted: &str, help: Option<String>) {
        let text = self.program.globals.text(span);
        let message = Diagnostic::new(Code::TypeMismatch, span, format!("`{text}` is {is}, but {wanted} is expected"))
            .label(is.to_string());
        self.program.report(match help.or_else(|| part_of(&text, is, wanted)) {
            Some(help) => message.help(help),
            None => message,
        });
    }

    pub(super) fn no_conversion(&mut self, scope: &Scope, span: Span, from: Elementary, to: Elementary) {
        let text = self.program.globals.text(span);
        if let Some((pin, variable)) = connected_output(&text).filter(|_| scope.is_network()) {
            let (from, to) = (from.name(), to.name());
            let title = format!("the output `{pin}` is of type {from}, but `{variable}` is of type {to}");
            let message = Diagnostic::new(Code::TypeMismatch, span, title).label(format!("not of type {from}"));
            return self.program.report(message.help(format!("name a variable of type {from}")));
        }
        let help = match (from, to) {
            _ if let Some(help) = rewrite::of_constant(to, &text, rewrite::Form::Scl) => Some(help),
            _ if scope.is_network() => in_element(scope.rules, from, to, &text),
            (Elementary::Time, _) if to.is_float() => {
                Some(format!("as a number of milliseconds it is `DINT_TO_{}(TIME_TO_DINT({text}))`", to.name()))
            }
            (_, Elementary::Bool) => Some(compared_with_zero(from, &text)),
            _ if convert::explicit(scope.rules, from, to).is_some() => {
                Some(format!("convert it: {}", conversion(from, to, &text)))
            }
            _ => in_two_steps(scope.rules, from, to, &text),
        };
        self.wrong_type(span, &format!("of type {}", from.name()), to.name(), help);
    }

    /// A value that may not fit where it goes.
    pub(super) fn may_lose(&mut self, scope: &Scope, span: Span, from: Elementary, to: Elementary) {
        let mut text = self.program.globals.text(span);
        let element = || in_element(scope.rules, from, to, &text).filter(|_| scope.is_network());
        let mut help = rewrite::of_constant(to, &text, rewrite::Form::Scl)
            .or_else(|| element().map(|help| format!("if that is intended, {help}")))
            .unwrap_or_else(|| format!("if that is intended, write {}", conversion(from, to, &text)));
        if let Some((target, value)) = combined(&text).filter(|_| !scope.is_network()) {
            let converted = conversion(from, to, &value);
            help = format!("if that is intended, write `{target} := {};`", converted.trim_matches('`'));
            text = value;
        }
        let mut title = format!("`{text}` is of type {} and may not fit {}", from.name(), to.name());
        if let Some((pin, variable)) = connected_output(&text).filter(|_| scope.is_network()) {
            let (from, to) = (from.name(), to.name());
            title = format!("the output `{pin}` is of type {from} and may not fit `{variable}`, which is of type {to}");
            help = format!("name a variable of type {from}");
        }
        self.program.report(
            Diagnostic::new(Code::Narrowing, span, title)
                .label(format!("converts to {} without a check", to.name()))
                .help(help),
        );
    }

    /// Something that is not possible here, and what to do about it.
    pub(in crate::bind) fn refuse(&mut self, code: Code, span: Span, title: &str, label: &str, help: &str) {
        let message = Diagnostic::new(code, span, title).label(label);
        self.program.report(if help.is_empty() { message } else { message.help(help) });
    }
}

/// Pin and variable of `on => #lamp`, as networks connect an output.
fn connected_output(text: &str) -> Option<(&str, &str)> {
    let (pin, variable) = text.split_once("=>")?;
    let (pin, variable) = (pin.trim(), variable.trim());
    (!pin.is_empty() && is_operand(variable) && !pin.contains(char::is_whitespace)).then_some((pin, variable))
}

/// What to name in place of `text`, a whole array, a structure or a block, where one value is expected, and the other way round.
fn part_of(text: &str, is: &str, wanted: &str) -> Option<String> {
    let is_name = !text.is_empty() && !text.contains(|c: char| c.is_whitespace() || c == '(');
    let ty = is.strip_prefix("of type ").filter(|_| is_name);
    if let (Some(ty), Some(target)) = (ty, wanted.strip_prefix("REF_TO "))
        && ty == target
    {
        return Some(format!("a reference to it is `REF({text})`"));
    }
    if let Some(target) = ty.and_then(|ty| ty.strip_prefix("REF_TO "))
        && target == wanted
    {
        return Some(format!("what it points to is `{text}^`"));
    }
    if !is_name || wanted.contains("ARRAY") || wanted.contains("STRING") {
        return None;
    }
    match is {
        "a block (FC)" => Some(format!("call it with its parameters: `{text}(…)`")),
        "a block (DB)" => Some(format!("name a value in it, as in `{text}.name`")),
        "of type STRUCT" if wanted != "STRUCT" => Some(format!("name one of its components, as in `{text}.name`")),
        _ if wanted == "STRUCT" && is != "of type STRUCT" => {
            Some("assign its components one by one, or name a structure of the same type".to_string())
        }
        _ => {
            let bounds = is.strip_prefix("of type ARRAY[")?.split(']').next()?;
            let first: Vec<&str> =
                bounds.split(',').map(|range| range.split("..").next().unwrap_or(range).trim()).collect();
            Some(format!("name an element, as in `{text}[{}]`", first.join(", ")))
        }
    }
}

/// What a network has in place of a comparison or of a function that converts.
fn in_element(rules: Rules, from: Elementary, to: Elementary, text: &str) -> Option<String> {
    let is_number = matches!(from.class(), Class::Signed | Class::Unsigned | Class::Float | Class::Bits);
    if to == Elementary::Bool {
        let zero = if from.is_float() { "0.0" } else { "0" };
        return Some(match (is_number, is_operand(text)) {
            (true, true) => format!("compare it: `NE_Contact( in1 := {text}, in2 := {zero} )`, in FBD `Ne`"),
            (true, false) => format!("compare it with {zero} in an element of its own: `NE_Contact`, in FBD `Ne`"),
            (false, _) => "compare it with a value of its type".to_string(),
        });
    }
    convert::explicit(rules, from, to)?;
    Some(match from.is_float() && to.is_integer() {
        true => format!("convert it to {} in an element of its own: `Round` or `Trunc`", to.name()),
        false => format!("convert it from {} to {} in an element of its own: `Convert`", from.name(), to.name()),
    })
}

/// Bytes of an expression that a help repeats.
const OPERATORS_MAX: usize = 60;

/// Whether a value in a network has a name: that of another element has none.
fn is_operand(text: &str) -> bool {
    text.starts_with(['#', '"', '%']) && !text.contains(char::is_whitespace)
}

/// The element of networks that makes a text of a number, and a number of a text. `text`: the value as written.
pub(super) fn text_element(text: &str) -> String {
    match is_operand(text) {
        true => format!("convert it in an element of its own: `S_CONV( in := {text}, out => … )`"),
        false => "convert it in an element of its own: `S_CONV`".to_string(),
    }
}

/// How to write the condition that a number was meant as: `NOT #i` is `#i = 0`.
fn compared_with_zero(from: Elementary, text: &str) -> String {
    let zero = if from.is_float() { "0.0" } else { "0" };
    if !matches!(from.class(), Class::Signed | Class::Unsigned | Class::Float | Class::Bits) {
        return "compare it with a value of its type".to_string();
    }
    let negated = text.get(..3).is_some_and(|word| word.eq_ignore_ascii_case("NOT"));
    let rest = text.get(3..).map_or("", str::trim_start);
    let single = |text: &str| !text.is_empty() && !text.contains(char::is_whitespace);
    // A comparison comes before AND and OR.
    let operators = !negated && !text.starts_with('(') && text.len() <= OPERATORS_MAX;
    match negated && single(rest) {
        true => format!("compare it: `{rest} = {zero}`"),
        false if single(text) => format!("compare it: `{text} <> {zero}`"),
        false if operators && !text.is_empty() => format!("compare it: `({text}) <> {zero}`"),
        false => format!("compare it, for example with `<> {zero}`"),
    }
}

/// The name of a type in function names: `TOD_TO_DINT`.
pub(super) fn short_name(ty: Elementary) -> &'static str {
    match ty {
        Elementary::TimeOfDay => "TOD",
        other => other.name(),
    }
}

/// `a` and `a + b` of the statement `a += b;`.
fn combined(text: &str) -> Option<(String, String)> {
    let whole = text.trim_end_matches(';');
    let (at, sign) = ["+=", "-=", "*=", "/="].into_iter().find_map(|sign| Some((whole.find(sign)?, &sign[..1])))?;
    let (target, value) = (whole[..at].trim(), whole[at + 2..].trim());
    let is_single = value.bytes().all(|byte| !b" +-*/".contains(&byte));
    let value = if is_single { value.to_owned() } else { format!("({value})") };
    Some((target.to_owned(), format!("{target} {sign} {value}")))
}

/// `DINT_TO_INT(#d)`.
pub(super) fn conversion(from: Elementary, to: Elementary, text: &str) -> String {
    // What does not fit on a line is not repeated.
    const LENGTH_MAX: usize = 60;
    let text = if text.is_empty() || text.chars().count() > LENGTH_MAX { "…" } else { text };
    format!("`{}_TO_{}({text})`", short_name(from), short_name(to))
}

/// How to convert a number to a type for which there is no single function: `DINT_TO_REAL(WORD_TO_DINT(#w))`.
pub(super) fn in_two_steps(rules: Rules, from: Elementary, to: Elementary, text: &str) -> Option<String> {
    let is_number = |ty: Elementary| {
        ty == Elementary::Time || matches!(ty.class(), Class::Signed | Class::Unsigned | Class::Float | Class::Bits)
    };
    let joins = |middle: &Elementary| {
        *middle != from
            && *middle != to
            && convert::explicit(rules, from, *middle).is_some()
            && convert::explicit(rules, *middle, to).is_some()
    };
    let middle = [Elementary::Dint, Elementary::Int].into_iter().find(joins);
    let middle = middle.filter(|_| is_number(from) && is_number(to))?;
    let first = conversion(from, middle, text);
    Some(format!("convert it in two steps: {}", conversion(middle, to, first.trim_matches('`'))))
}

/// How a timer or counter is used, where it stands for a variable or a block.
pub(super) fn start_of_cell(kind: CellKind, text: &str) -> String {
    match kind {
        CellKind::Timer => format!("a timer is started by a function, as in `S_ODT(T_NO := {text}, S := …, TV := …)`"),
        CellKind::Counter => format!("a counter is counted by a function, as in `S_CU(C_NO := {text}, CU := …)`"),
    }
}

/// A description of a value, for messages: `of type INT`, `a block`.
pub fn described(value: &Value) -> String {
    match value {
        Value::Elementary(expr) => format!("of type {}", expr.ty.name()),
        Value::Constant(constant, _) => match constant {
            Constant::Integer { .. } => "an integer constant".to_string(),
            Constant::Real(_) => "a REAL constant".to_string(),
            Constant::Typed { ty, .. } => format!("a constant of type {}", ty.name()),
            Constant::Text { .. } | Constant::WideText(_) => "a text".to_string(),
            Constant::DateAndTime(_) => "a DATE_AND_TIME constant".to_string(),
            Constant::Dtl(_) => "a DTL constant".to_string(),
        },
        Value::Complex { ty, .. } => format!("of type {}", layout::type_name(ty)),
        Value::Parameter { access, .. } => format!("of type {}", layout::type_name(&access.ty)),
        Value::Cell { kind: CellKind::Timer, .. } => "a timer".to_string(),
        Value::Cell { kind: CellKind::Counter, .. } => "a counter".to_string(),
        Value::Block { prefix, .. } => format!("a block ({})", prefix.letters()),
        Value::Nothing(_) | Value::Statements(..) => "a call without a value".to_string(),
    }
}
