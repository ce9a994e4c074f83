//! Whether what is written twice in SCL is the same, and has the same value the second time.

use plcc_model::scl::walk::{self, Visitor};
use plcc_model::scl::{Call, Expr, ExprKind};

/// A text without the blanks and the letter case that make no difference. Blanks inside quotes do, and so does the letter case of texts.
pub fn comparable(text: String) -> String {
    if text.contains('\'') {
        return text;
    }
    if text.contains('"') {
        return text.to_uppercase();
    }
    let mut whole = String::with_capacity(text.len());
    for word in text.split_whitespace() {
        if whole.ends_with(is_word) && word.starts_with(is_word) {
            whole.push(' ');
        }
        whole.push_str(word);
    }
    whole.to_uppercase()
}

/// As [`comparable`], without the `#` before names, which may be left out. That inside of constants, as in `16#10` and `'#'`, stays.
pub fn comparable_names(text: String) -> String {
    let text = comparable(text);
    if text.contains('\'') {
        return text;
    }
    let mut whole = String::with_capacity(text.len());
    let mut in_quotes = false;
    for sign in text.chars() {
        if sign == '#' && !in_quotes && !whole.ends_with(is_word) {
            continue;
        }
        in_quotes ^= sign == '"';
        whole.push(sign);
    }
    whole
}

fn is_word(sign: char) -> bool {
    sign.is_alphanumeric() || sign == '_'
}

/// Whether a value depends on more than variables, or evaluating it changes something. What is inside it is not looked at.
pub fn is_more_than_variables(value: &Expr) -> bool {
    matches!(
        value.kind,
        ExprKind::Call(_)
            | ExprKind::Timer(_)
            | ExprKind::Counter(_)
            | ExprKind::Cell { .. }
            | ExprKind::Flag
            | ExprKind::LastEno
    )
}

/// Whether a block is called in a value: it may change variables.
pub fn calls_block(value: &Expr) -> bool {
    let mut calls = Calls(false);
    walk::expr(value, &mut calls);
    calls.0
}

struct Calls(bool);

impl Visitor for Calls {
    fn call(&mut self, _call: &Call) {
        self.0 = true;
    }
}
