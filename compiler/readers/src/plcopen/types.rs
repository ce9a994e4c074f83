//! Types of variables and expressions, as far as IEC 61131-3 needs them: `T#1s * r` is another formula where `r` is a REAL,
//! dates have their own arithmetic, and a constant must be in the range of a subrange type.
//!
//! The binder alone finds any other type.

use std::collections::HashMap;

use plcc_diag::{Code, Diagnostic};
use roxmltree::Node;

use super::interface::{child, elements};
use super::whole_number;
use plcc_syntax::Elementary;
use plcc_syntax::scl::ast::{BinaryOp, Expr, ExprKind, Literal, UnaryOp};

/// Names of types may refer to others up to this depth.
const DEPTH_MAX: usize = 16;

/// The type of a variable or an expression.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ty {
    Of(Elementary),
    /// DATE: at midnight, as LDT.
    Date,
    /// DATE_AND_TIME, as LDT.
    DateAndTime,
    Text,
    /// WSTRING.
    WideText,
    /// A subrange of an integer type.
    Range(Elementary, i64, i64),
    /// A type, function block or program of the file, in lower case, or a standard block.
    Named(String),
    Array(Box<Ty>),
}

impl Ty {
    /// The type in a `type` or `baseType` element.
    pub fn of(holder: Node) -> Option<Ty> {
        Ty::nested(holder, 0)
    }

    fn nested(holder: Node, depth: usize) -> Option<Ty> {
        let node = elements(holder).next().filter(|_| depth < DEPTH_MAX)?;
        let base = |node: Node| Ty::nested(child(node, "baseType")?, depth + 1);
        match node.tag_name().name() {
            "derived" => Some(Ty::Named(node.attribute("name")?.to_lowercase())),
            "array" => Some(Ty::Array(Box::new(base(node)?))),
            "subrangeSigned" | "subrangeUnsigned" => {
                let base = base(node)?;
                let range = child(node, "range");
                let bound = |name: &str| whole_number(range?.attribute(name)?);
                match (&base, bound("lower"), bound("upper")) {
                    (Ty::Of(ty), Some(low), Some(high)) => Some(Ty::Range(*ty, low, high)),
                    _ => Some(base),
                }
            }
            "enum" => Some(Ty::Of(Elementary::Int)),
            name => Ty::of_word(name),
        }
    }

    /// The type that a word of the language names.
    pub fn of_word(word: &str) -> Option<Ty> {
        match word.to_ascii_uppercase().as_str() {
            "DATE" => Some(Ty::Date),
            "DT" | "DATE_AND_TIME" => Some(Ty::DateAndTime),
            "STRING" => Some(Ty::Text),
            "WSTRING" => Some(Ty::WideText),
            "TOD" => Some(Ty::Of(Elementary::TimeOfDay)),
            upper => Elementary::from_word(upper).map(Ty::Of),
        }
    }

    /// The word of SCL for a type of one value.
    pub fn word(&self) -> Option<String> {
        match self {
            Ty::Of(ty) | Ty::Range(ty, ..) => Some(ty.name().to_string()),
            Ty::Date | Ty::DateAndTime => Some("LDT".to_string()),
            Ty::Text | Ty::WideText | Ty::Named(_) | Ty::Array(_) => None,
        }
    }

    pub fn elementary(&self) -> Option<Elementary> {
        match self {
            Ty::Of(ty) | Ty::Range(ty, ..) => Some(*ty),
            Ty::Date | Ty::DateAndTime | Ty::Text | Ty::WideText | Ty::Named(_) | Ty::Array(_) => None,
        }
    }

    pub fn is_float(&self) -> bool {
        matches!(self, Ty::Of(Elementary::Real | Elementary::Lreal))
    }

    pub fn is_date(&self) -> bool {
        matches!(self, Ty::Date | Ty::DateAndTime)
    }
}

/// The types of a project, by names in lower case.
#[derive(Debug, Default)]
pub struct Types {
    /// Data types that are not structures.
    named: HashMap<String, Ty>,
    /// Components of structures, and variables of function blocks and programs.
    members: HashMap<String, HashMap<String, Ty>>,
    /// Results of functions.
    returns: HashMap<String, Ty>,
    /// Names of the inputs of POUs, in their order.
    inputs: HashMap<String, Vec<String>>,
    globals: HashMap<String, Ty>,
}

impl Types {
    pub fn of(root: Node) -> Types {
        let mut types = Types::default();
        for node in root.descendants() {
            let Some(name) = node.attribute("name").map(str::to_lowercase) else { continue };
            match node.tag_name().name() {
                "dataType" => {
                    let Some(base) = child(node, "baseType") else { continue };
                    if let Some(structure) = child(base, "struct") {
                        types.members.insert(name, variables(structure).collect());
                    } else if let Some(ty) = Ty::of(base) {
                        types.named.insert(name, ty);
                    }
                }
                "pou" => {
                    let Some(interface) = child(node, "interface") else { continue };
                    if let Some(ty) = child(interface, "returnType").and_then(Ty::of) {
                        types.returns.insert(name.clone(), ty);
                    }
                    let lists = elements(interface).filter(|list| list.tag_name().name() == "inputVars");
                    let inputs = lists.flat_map(elements).filter_map(|input| input.attribute("name"));
                    types.inputs.insert(name.clone(), inputs.map(str::to_lowercase).collect());
                    types.members.insert(name, elements(interface).flat_map(variables).collect());
                }
                _ => {}
            }
        }
        for (name, ty) in super::globals::global_lists(root).flat_map(variables) {
            types.globals.entry(name).or_insert(ty);
        }
        types
    }

    pub fn global(&self, name: &str) -> Option<Ty> {
        self.globals.get(name).cloned().map(|ty| self.resolved(ty))
    }

    /// A type with all its names resolved.
    pub fn resolved(&self, mut ty: Ty) -> Ty {
        for _ in 0..DEPTH_MAX {
            match &ty {
                Ty::Named(name) => match self.named.get(name) {
                    Some(known) => ty = known.clone(),
                    None => return ty,
                },
                _ => return ty,
            }
        }
        ty
    }

    /// The type of a component; `name` in lower case.
    pub fn member(&self, base: &Ty, name: &str) -> Option<Ty> {
        let Ty::Named(of) = base else { return None };
        if let Some(known) = self.members.get(of) {
            return known.get(name).cloned().map(|ty| self.resolved(ty));
        }
        match (of.as_str(), name) {
            (_, "q" | "q1" | "qu" | "qd") => Some(Ty::Of(Elementary::Bool)),
            ("ton" | "tof" | "tp" | "tonr", "et" | "pt") => Some(Ty::Of(Elementary::Time)),
            ("ctu" | "ctd" | "ctud", "cv" | "pv") => Some(Ty::Of(Elementary::Int)),
            _ => None,
        }
    }

    /// The name of an input of a POU by its place, in lower case; `pou` in lower case.
    pub fn input(&self, pou: &str, at: usize) -> Option<String> {
        self.inputs.get(pou)?.get(at).cloned()
    }

    /// The result type of a function; `name` in upper case.
    pub fn result(&self, name: &str, arguments: &[Option<Ty>]) -> Option<Ty> {
        if let Some(own) = self.returns.get(&name.to_lowercase()) {
            return Some(self.resolved(own.clone()));
        }
        if let Some((_, to)) = name.split_once("_TO_").or_else(|| name.split_once("_TRUNC_")) {
            return Ty::of_word(to);
        }
        let known = || arguments.iter().flatten().next().cloned();
        match name {
            "GT" | "GE" | "EQ" | "NE" | "LT" | "LE" => Some(Ty::Of(Elementary::Bool)),
            "LEN" | "FIND" => Some(Ty::Of(Elementary::Int)),
            "CONCAT" | "LEFT" | "RIGHT" | "MID" | "INSERT" | "DELETE" | "REPLACE" => Some(Ty::Text),
            "SEL" | "MUX" => arguments.iter().skip(1).flatten().next().cloned(),
            "EXPT" | "SQRT" | "SIN" | "COS" | "TAN" | "ASIN" | "ACOS" | "ATAN" | "EXP" | "LN" | "LOG" => {
                known().filter(Ty::is_float).or(Some(Ty::Of(Elementary::Real)))
            }
            "ADD" | "SUB" | "MUL" | "DIV" | "MOD" | "MIN" | "MAX" | "LIMIT" | "ABS" | "MOVE" | "AND" | "OR" | "XOR"
            | "NOT" | "SHL" | "SHR" | "ROL" | "ROR" => known(),
            _ => None,
        }
    }
}

/// The result type of an operator.
pub fn operation(op: BinaryOp, left: Option<&Ty>, right: Option<&Ty>) -> Option<Ty> {
    use BinaryOp::{Equal, Greater, GreaterEqual, Less, LessEqual, NotEqual, Subtract};
    if matches!(op, Equal | NotEqual | Less | LessEqual | Greater | GreaterEqual) {
        return Some(Ty::Of(Elementary::Bool));
    }
    let duration = |ty: Option<&Ty>| matches!(ty, Some(Ty::Of(Elementary::Time | Elementary::Ltime)));
    match (left, right) {
        (Some(a), Some(b)) if op == Subtract && a.is_date() && b.is_date() => Some(Ty::Of(Elementary::Time)),
        (Some(Ty::Of(Elementary::TimeOfDay)), Some(Ty::Of(Elementary::TimeOfDay))) => Some(Ty::Of(Elementary::Time)),
        (Some(date), _) if date.is_date() => Some(date.clone()),
        (Some(day @ Ty::Of(Elementary::TimeOfDay)), _) => Some(day.clone()),
        _ if duration(left) => left.cloned(),
        _ if duration(right) => right.cloned(),
        (Some(a), Some(b)) => {
            let rank = |ty: &Ty| (ty.is_float(), ty.elementary().map_or(0, Elementary::bits));
            let wider = if rank(b) > rank(a) { b } else { a };
            Some(wider.elementary().map_or_else(|| wider.clone(), Ty::Of))
        }
        (Some(ty), None) | (None, Some(ty)) => Some(ty.elementary().map_or_else(|| ty.clone(), Ty::Of)),
        (None, None) => None,
    }
}

/// The message for a constant outside a subrange type.
pub fn out_of_range(ty: &Ty, value: &Expr) -> Option<Diagnostic> {
    let Ty::Range(_, low, high) = ty else { return None };
    let number = whole(value)?;
    if (i128::from(*low)..=i128::from(*high)).contains(&number) {
        return None;
    }
    let text = format!("{number} is outside the range of its type");
    let message = Diagnostic::new(Code::LiteralRange, value.span, text);
    Some(message.label(format!("the type has the range {low} to {high}")).help("write a number in the range"))
}

/// The number of a constant.
fn whole(value: &Expr) -> Option<i128> {
    match &value.kind {
        ExprKind::Literal(Literal::Integer { value, .. }) => Some(i128::from(*value)),
        ExprKind::Unary { op: UnaryOp::Minus, operand } => whole(operand).map(|number| -number),
        ExprKind::Unary { op: UnaryOp::Plus, operand } => whole(operand),
        _ => None,
    }
}

fn variables<'a, 'i>(list: Node<'a, 'i>) -> impl Iterator<Item = (String, Ty)> {
    elements(list)
        .filter(|node| node.tag_name().name() == "variable")
        .filter_map(|node| Some((node.attribute("name")?.to_lowercase(), Ty::of(child(node, "type")?)?)))
}
