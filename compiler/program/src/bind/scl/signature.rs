//! The functions that SCL calls without an instance, with their parameters, as an editor shows them.

use plcc_diag::Span;
use plcc_model::scl::{Expr, ExprKind};
use plcc_model::{Direction, Parameter as Formal, layout};
use plcc_stdlib::{BlockClass, Form, SystemBlock};
use plcc_syntax::Elementary;

use super::function::{FUNCTIONS, NAMING, Named};
use super::message::short_name;
use super::pins::Pin;
use super::{Rules, convert, text};
use crate::bind::declarations::shipped::library_interface;
use crate::bind::trees::SYSTEM_FILE;

/// A function.
#[derive(Clone, Debug)]
pub struct Signature {
    pub name: String,
    pub parameters: Vec<Parameter>,
    /// The name may carry a type: `LIMIT_INT`.
    pub is_typed: bool,
    /// What it does, if the library says so.
    pub description: String,
}

/// A parameter of a function.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Its spellings, the usual one first.
    pub names: Vec<String>,
    /// Empty: each type that fits.
    pub ty: String,
    pub direction: Direction,
    pub is_optional: bool,
    /// Others with the next numbers may follow: IN1, IN2, …
    pub is_numbered: bool,
}

/// The functions of the language, its conversions, and the functions of the library; for an S7-300/400 those of its types and of STEP 7 V5.
pub fn signatures(rules: Rules) -> Vec<Signature> {
    let parameter = |pin: Pin| Parameter {
        names: pin.names.split('|').map(str::to_string).collect(),
        ty: String::new(),
        direction: if pin.output { Direction::Output } else { Direction::Input },
        is_optional: pin.optional,
        is_numbered: pin.numbered,
    };
    let rows = FUNCTIONS.iter().chain(NAMING).map(|row| Signature {
        name: row.name.to_string(),
        parameters: Pin::list(row).into_iter().map(parameter).collect(),
        is_typed: row.suffix,
        description: String::new(),
    });
    let texts = text::conversions(rules).into_iter().map(|(name, from)| conversion(name, from));
    // What the language has under the same name goes before the library.
    let is_callable = |block: &&SystemBlock| {
        let is_function = matches!(block.class, BlockClass::Fc | BlockClass::Sfc) && !block.is_part();
        let is_here = block.form != Form::NotShipped && block.is_tia() != rules.is_300();
        is_function && is_here && Named::find(block.name).is_none()
    };
    let library = plcc_stdlib::blocks().iter().filter(is_callable).filter_map(of_library);
    rows.chain(conversions(rules)).chain(texts).chain(library).collect()
}

fn of_library(block: &SystemBlock) -> Option<Signature> {
    let parameter = |formal: &Formal| Parameter {
        names: vec![formal.name.clone()],
        ty: layout::type_name(&formal.ty),
        direction: formal.direction,
        is_optional: false,
        is_numbered: false,
    };
    let interface = library_interface(block)?;
    let formals = interface.parameters.iter().filter(|formal| formal.name != "RET_VAL");
    let parameters = formals.map(parameter).collect();
    Some(Signature { name: block.name.to_string(), parameters, is_typed: false, description: block.description() })
}

fn conversions(rules: Rules) -> Vec<Signature> {
    let types: Vec<Elementary> =
        Elementary::ALL.into_iter().filter(|ty| !rules.is_300() || convert::on_300(*ty)).collect();
    let mut found: Vec<Signature> =
        convert::BCD.iter().map(|(name, from, _)| conversion((*name).to_string(), from.name())).collect();
    for &to in &types {
        found.push(conversion(format!("TO_{}", short_name(to)), ""));
        for &from in types.iter().filter(|from| **from != to) {
            let value = Expr { kind: ExprKind::Const(0), ty: from, span: Span::new(SYSTEM_FILE, 0..0) };
            if convert::explicit_expr(rules, value, to).is_some() {
                found.push(conversion(format!("{}_TO_{}", short_name(from), short_name(to)), from.name()));
            }
        }
    }
    found
}

/// A conversion has one input.
fn conversion(name: String, ty: &str) -> Signature {
    let input = Parameter {
        names: vec!["IN".to_string()],
        ty: ty.to_string(),
        direction: Direction::Input,
        is_optional: false,
        is_numbered: false,
    };
    Signature { name, parameters: vec![input], is_typed: false, description: String::new() }
}
