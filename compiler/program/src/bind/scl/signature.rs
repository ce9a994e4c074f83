//! The functions of the language with their parameters, as an editor shows them.

use plcc_diag::Span;
use plcc_model::scl::{Expr, ExprKind};
use plcc_syntax::Elementary;

use super::function::{FUNCTIONS, NAMING};
use super::message::short_name;
use super::pins::Pin;
use super::{Rules, convert};
use crate::bind::trees::SYSTEM_FILE;

/// A function.
#[derive(Clone, Debug)]
pub struct Signature {
    pub name: String,
    pub parameters: Vec<Parameter>,
    /// The name may carry a type: `LIMIT_INT`.
    pub is_typed: bool,
}

/// A parameter of a function.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Its spellings, the usual one first.
    pub names: Vec<&'static str>,
    /// `None`: each type that fits.
    pub ty: Option<Elementary>,
    pub is_output: bool,
    pub is_optional: bool,
    /// Others with the next numbers may follow: IN1, IN2, …
    pub is_numbered: bool,
}

/// The functions of the language, and its conversions between elementary types; for an S7-300/400 those between types that it has.
pub fn signatures(rules: Rules) -> Vec<Signature> {
    let parameter = |pin: Pin| Parameter {
        names: pin.names.split('|').collect(),
        ty: None,
        is_output: pin.output,
        is_optional: pin.optional,
        is_numbered: pin.numbered,
    };
    let rows = FUNCTIONS.iter().chain(NAMING).map(|row| Signature {
        name: row.name.to_string(),
        parameters: Pin::list(row).into_iter().map(parameter).collect(),
        is_typed: row.suffix,
    });
    rows.chain(conversions(rules)).collect()
}

fn conversions(rules: Rules) -> Vec<Signature> {
    let types: Vec<Elementary> =
        Elementary::ALL.into_iter().filter(|ty| !rules.is_300() || convert::on_300(*ty)).collect();
    let mut found: Vec<Signature> =
        convert::BCD.iter().map(|(name, from, _)| conversion((*name).to_string(), Some(*from))).collect();
    for &to in &types {
        found.push(conversion(format!("TO_{}", short_name(to)), None));
        for &from in types.iter().filter(|from| **from != to) {
            let value = Expr { kind: ExprKind::Const(0), ty: from, span: Span::new(SYSTEM_FILE, 0..0) };
            if convert::explicit_expr(rules, value, to).is_some() {
                found.push(conversion(format!("{}_TO_{}", short_name(from), short_name(to)), Some(from)));
            }
        }
    }
    found
}

/// A conversion has one input.
fn conversion(name: String, ty: Option<Elementary>) -> Signature {
    let input = Parameter { names: vec!["IN"], ty, is_output: false, is_optional: false, is_numbered: false };
    Signature { name, parameters: vec![input], is_typed: false }
}
