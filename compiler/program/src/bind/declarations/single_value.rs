//! One value where an array has several elements: it is the value of the first one.
//!
//! Source: STL reference, declarations, initial values of arrays; data blocks, assignments after BEGIN.

use plcc_diag::{Code, Diagnostic, Severity};
use plcc_syntax::ast::{InitialKind, InitialValue, Path};
use plcc_syntax::count::counted;
use plcc_syntax::literal::Literal;

use crate::bind::declarations::Declarations;
use crate::bind::declarations::initial::{is_char, is_text, leaves, repetition};
use plcc_model::layout;
use plcc_model::types::DataType;

impl Declarations<'_> {
    /// Reports `f := 3;` after BEGIN, where `f` is an array of several elements; true: it is reported.
    pub fn refuses_one_value(&mut self, target: &Path, value: &InitialValue, ty: &DataType) -> bool {
        let count = leaves(ty);
        let Some(first) = first_of(value, ty) else { return false };
        let (name, text) = (self.globals.text(target.span), self.globals.text(value.span));
        let all = self.for_all(value, count);
        self.report(
            Diagnostic::new(
                Code::InitialValue,
                target.span,
                format!("`{name}` is an array, but `{text}` is one value"),
            )
            .label(layout::type_name(ty))
            .help(format!("write `{name}{first} := {text}` for one element, `:= {all}` in the declaration for all")),
        );
        true
    }

    /// Warns of `f : ARRAY[1..5] OF INT := 3`, unless all elements are the same anyway.
    pub(super) fn value_of_first(&mut self, value: &InitialValue, ty: &DataType) {
        let count = leaves(ty);
        let Some(first) = first_of(value, ty) else { return };
        let text = self.globals.text(value.span);
        let all = self.for_all(value, count);
        let title = format!("only element {first} of this array begins with `{text}`");
        let mut message = Diagnostic::new(Code::InitialValue, value.span, title)
            .label(format!("one value for {}", counted(usize::try_from(count).unwrap_or(usize::MAX), "element")))
            .help(format!("write `{all}` for all of them"));
        message.severity = Severity::Warning;
        self.report(message);
    }

    /// `5(3)`, in the TIA Portal `[5(3)]`.
    fn for_all(&self, value: &InitialValue, count: u64) -> String {
        let text = self.globals.text(value.span);
        match value.kind {
            InitialKind::Expr(_) if self.globals.input.profile.family.is_portal() => format!("[{count}({text})]"),
            _ => format!("{count}({text})"),
        }
    }
}

/// The indices of the first element, if `value` is one value and `ty` an array of several.
fn first_of(value: &InitialValue, ty: &DataType) -> Option<String> {
    let DataType::Array(array) = ty else { return None };
    let of_characters = is_char(&array.element);
    let single = match &value.kind {
        InitialKind::Literal(literal) => !(of_characters && matches!(literal, Literal::Text(_))),
        InitialKind::Expr(expr) => repetition(expr).is_none() && !(of_characters && is_text(expr)),
        InitialKind::List(_)
        | InitialKind::Elements(_)
        | InitialKind::Repeat { .. }
        | InitialKind::Fields(_)
        | InitialKind::Operand(_)
        | InitialKind::Default => false,
    };
    if !single || leaves(ty) < 2 {
        return None;
    }
    let mut first = String::new();
    let mut inner = ty;
    while let DataType::Array(array) = inner {
        let lows: Vec<String> = array.bounds.iter().map(|(low, _)| low.to_string()).collect();
        first += &format!("[{}]", lows.join(", "));
        inner = &array.element;
    }
    Some(first)
}
