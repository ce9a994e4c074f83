//! Operands of networks as operands of STL.

use plcc_syntax::Elementary;
use plcc_syntax::ast::{BlockName, Bound, Operand, OperandKind, Path, PathPart, PathRoot, Width};
use plcc_syntax::literal::Literal;
use plcc_syntax::scl;
use plcc_syntax::scl::ast::{Expr, ExprKind, Name, NameForm};

use super::Maker;
use super::logic::Logic;
use crate::names;
use crate::operand::constant;

impl Maker<'_> {
    /// A Boolean operand: a bit, or TRUE and FALSE.
    pub fn bit(&mut self, value: &Expr) -> Logic {
        if let ExprKind::Literal(_) = &value.kind {
            return match constant(value) {
                Some(Literal::Bool(value)) => Logic::Constant(value),
                Some(Literal::Int(value @ (0 | 1))) => Logic::Constant(value == 1),
                _ => {
                    self.refuse(value.span, "this constant as a bit", "write TRUE or FALSE");
                    Logic::Constant(false)
                }
            };
        }
        match self.operand(value) {
            Some(operand) => Logic::Operand(operand),
            None => Logic::Constant(false),
        }
    }

    /// An operand, or a message.
    pub fn operand(&mut self, value: &Expr) -> Option<Operand> {
        let mut found = operand_of(value);
        if found.is_none() {
            self.refuse(value.span, "this operand", "copy it into a variable first");
        }
        if !self.types.is_portal && found.as_ref().is_some_and(is_of_portal) {
            let help = "name an S7-1500, for example with `--cpu s7-1500`, whose STL has it";
            self.refuse(value.span, "a variable index or a part of a variable on this CPU", help);
            return None;
        }
        // In STL the value of a function is RET_VAL.
        if let Some(Operand { kind: OperandKind::Path(Path { root, .. }), .. }) = &mut found
            && let PathRoot::Local { name, span } | PathRoot::Bare { name, span } = &*root
            && self.block.return_type.is_some()
            && matches!(&self.block.name, BlockName::Symbol { name: own, .. } if own.eq_ignore_ascii_case(name))
        {
            *root = PathRoot::Local { name: "RET_VAL".to_string(), span: *span };
        }
        found
    }

    /// A value to load as one of type `ty`: constants in the form of the type.
    pub fn value_of(&mut self, value: &Expr, ty: Elementary) -> Option<Operand> {
        let Some(literal) = constant(value) else { return self.operand(value) };
        let literal = match (literal, ty) {
            (Literal::Int(number), Elementary::Dint | Elementary::Time) => Literal::Dint(i32::try_from(number).ok()?),
            (Literal::Int(number), Elementary::Real) => Literal::Real(number as f32),
            (Literal::Int(number), Elementary::Word) if i16::try_from(number).is_err() => {
                Literal::Word(u16::try_from(number).ok()?)
            }
            (Literal::Int(number), Elementary::Byte) => Literal::Byte(u8::try_from(number).ok()?),
            (Literal::Int(number), Elementary::Dword) => Literal::Dword(u32::try_from(number).ok()?),
            (Literal::Bits { value, .. }, Elementary::Dword) => Literal::Dword(value),
            (Literal::Bits { value, .. }, Elementary::Word) => Literal::Word(u16::try_from(value).ok()?),
            (Literal::Bits { value, .. }, Elementary::Dint) => Literal::Dint(value as i32),
            (Literal::Bits { value, .. }, Elementary::Real) => Literal::Real(value as f32),
            (literal, _) => literal,
        };
        Some(Operand { kind: OperandKind::Literal(literal), span: value.span })
    }
}

/// The operand that an expression is, if STL has it.
pub(crate) fn operand_of(value: &Expr) -> Option<Operand> {
    let span = value.span;
    let kind = match &value.kind {
        ExprKind::Absolute(kind) => kind.clone(),
        ExprKind::Name(name) => match (name.form, scl::absolute(&name.text)) {
            (NameForm::Bare, Some(kind)) => kind,
            _ => whole(Path { root: root(name), parts: Vec::new(), span }),
        },
        ExprKind::Member { .. } | ExprKind::Index { .. } | ExprKind::Slice { .. } => {
            let (root, parts) = path(value)?;
            whole(Path { root, parts, span })
        }
        ExprKind::MemberAbsolute { base, width, byte, bit } => {
            let db = match &base.kind {
                ExprKind::Name(Name { text, form: NameForm::Quoted, span }) => {
                    BlockName::Symbol { name: text.clone(), span: *span }
                }
                ExprKind::Absolute(OperandKind::Block(name)) => name.clone(),
                ExprKind::Name(name) => match scl::absolute(&name.text)? {
                    OperandKind::Block(name) => name,
                    _ => return None,
                },
                _ => return None,
            };
            OperandKind::DbAbsolute { db, width: *width, byte: *byte, bit: *bit }
        }
        _ => OperandKind::Literal(constant(value)?),
    };
    Some(Operand { kind, span })
}

/// A path as an operand. In SCL and networks `:P` is a part of its last name, in STL it follows the path.
fn whole(mut path: Path) -> OperandKind {
    let direct = match (path.parts.last(), &path.root) {
        (Some(PathPart::Member { name, .. }), _) | (None, PathRoot::Quoted { name, .. }) => {
            names::without_periphery(name).map(str::to_string)
        }
        _ => None,
    };
    let Some(direct) = direct else { return OperandKind::Path(path) };
    match (path.parts.last_mut(), &mut path.root) {
        (Some(PathPart::Member { name, .. }), _) | (None, PathRoot::Quoted { name, .. }) => *name = direct,
        _ => {}
    }
    OperandKind::Peripheral(path)
}

fn root(name: &Name) -> PathRoot {
    let (name, span, form) = (name.text.clone(), name.span, name.form);
    match form {
        NameForm::Bare => PathRoot::Bare { name, span },
        NameForm::Local => PathRoot::Local { name, span },
        NameForm::Quoted => PathRoot::Quoted { name, span },
    }
}

fn path(value: &Expr) -> Option<(PathRoot, Vec<PathPart>)> {
    match &value.kind {
        ExprKind::Name(name) => match (name.form, scl::absolute(&name.text)) {
            (NameForm::Bare, Some(OperandKind::Block(block))) => Some((PathRoot::Block(block), Vec::new())),
            _ => Some((root(name), Vec::new())),
        },
        ExprKind::Absolute(OperandKind::Block(block)) => Some((PathRoot::Block(block.clone()), Vec::new())),
        ExprKind::Member { base, name } => {
            let (root, mut parts) = path(base)?;
            parts.push(PathPart::Member { name: name.text.clone(), span: name.span });
            Some((root, parts))
        }
        ExprKind::Slice { base, width, index } => {
            let (root, mut parts) = path(base)?;
            let letter = match width {
                Width::Bit => 'X',
                Width::Byte => 'B',
                Width::Word => 'W',
                Width::Dword => 'D',
                Width::Lword => return None,
            };
            parts.push(PathPart::Member { name: format!("%{letter}{index}"), span: value.span });
            Some((root, parts))
        }
        ExprKind::Index { base, indices } => {
            let (root, mut parts) = path(base)?;
            let values = indices.iter().map(index).collect::<Option<Vec<Bound>>>()?;
            parts.push(PathPart::Index { values, span: value.span });
            Some((root, parts))
        }
        _ => None,
    }
}

/// An index is a number or a variable.
fn index(value: &Expr) -> Option<Bound> {
    match constant(value) {
        Some(Literal::Int(number)) => Some(Bound::Number(number, value.span)),
        Some(_) => None,
        None => {
            let (root, parts) = path(value)?;
            Some(Bound::Path(Box::new(Path { root, parts, span: value.span })))
        }
    }
}

/// Only STL of the S7-1500 has the operand: with an index that is a variable, or a part of a variable.
fn is_of_portal(operand: &Operand) -> bool {
    let OperandKind::Path(path) = &operand.kind else { return false };
    let is_part = |part: &PathPart| matches!(part, PathPart::Member { name, .. } if slice_type(name).is_some());
    has_variable_index(operand) || path.parts.iter().any(is_part)
}

pub(super) fn has_variable_index(operand: &Operand) -> bool {
    let OperandKind::Path(path) = &operand.kind else { return false };
    path.parts.iter().any(|part| match part {
        PathPart::Member { .. } => false,
        PathPart::Index { values, .. } => values.iter().any(|value| matches!(value, Bound::Path(_))),
    })
}

/// The type of a part of a variable, by its name: `%X3`.
pub(crate) fn slice_type(name: &str) -> Option<Elementary> {
    match name.strip_prefix('%')?.chars().next()?.to_ascii_uppercase() {
        'X' => Some(Elementary::Bool),
        'B' => Some(Elementary::Byte),
        'W' => Some(Elementary::Word),
        'D' => Some(Elementary::Dword),
        _ => None,
    }
}

/// A block that an element calls.
pub(super) fn block_name(value: &Expr) -> Option<BlockName> {
    match operand_of(value)?.kind {
        OperandKind::Block(name) => Some(name),
        OperandKind::Path(Path {
            root: PathRoot::Quoted { name, span } | PathRoot::Bare { name, span },
            parts,
            ..
        }) if parts.is_empty() => Some(BlockName::Symbol { name, span }),
        _ => None,
    }
}
