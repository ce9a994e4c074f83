//! Operands: `Access` with its symbol, constant or address.

use plcc_syntax::ast::{Area, BlockName, BlockPrefix, CellKind, CodeBlock, OperandKind, Width};
use plcc_syntax::scl::ast::{Expr, ExprKind, Literal, Name, NameForm, UnaryOp};

use super::{Library, Uids};
use crate::names;
use crate::node::Node;
use crate::scl::expression;
use crate::writer::Writer;

/// Whether a name is one of the block's own, a constant, or of the whole program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Whose {
    Local,
    LocalConstant,
    Global,
}

/// What a name in that form means in a block.
pub fn whose(name: &str, form: NameForm, block: &CodeBlock) -> Whose {
    let is = |own: &str| own.eq_ignore_ascii_case(name);
    let is_constant = block.constants.iter().any(|constant| is(&constant.name));
    let is_variable =
        || block.sections.iter().flat_map(|section| &section.variables).any(|variable| is(&variable.name));
    match form {
        NameForm::Local if is_constant => Whose::LocalConstant,
        NameForm::Local => Whose::Local,
        NameForm::Quoted => Whose::Global,
        NameForm::Bare if is_constant => Whose::LocalConstant,
        NameForm::Bare if is_variable() || is("RET_VAL") && block.return_type.is_some() => Whose::Local,
        NameForm::Bare => Whose::Global,
    }
}

/// An operand of a network; `None`: it has no form.
pub fn access(value: &Expr, block: &CodeBlock, uids: &mut Uids, writer: &mut Writer) -> Option<Node> {
    let uid = uids.next();
    let node = |scope: &str| Node::new("Access").with("Scope", scope).with("UId", uid);
    let signed = match &value.kind {
        ExprKind::Unary { op: UnaryOp::Minus | UnaryOp::Plus, operand } => operand,
        _ => value,
    };
    if let ExprKind::Literal(literal) = &signed.kind {
        let text = expression::text(value, writer);
        let text = text.trim_start_matches('(').trim_end_matches(')').to_string();
        return Some(node("LiteralConstant").child(constant(literal, text)));
    }
    if let ExprKind::Absolute(kind) = &value.kind {
        return Some(node("Address").child(address(kind)?));
    }
    if let ExprKind::MemberAbsolute { base, width, byte, bit } = &value.kind
        && let ExprKind::Absolute(OperandKind::Block(BlockName::Numbered { number, .. })) = &base.kind
    {
        return Some(node("Address").child(place("DB", *width, *byte, *bit).with("BlockNumber", number)));
    }
    let (root, symbol) = path(value, "Symbol", block, uids, writer)?;
    Some(match root {
        Whose::LocalConstant => {
            let ExprKind::Name(name) = &value.kind else { return None };
            node("LocalConstant").child(Node::new("Constant").with("Name", &name.text))
        }
        Whose::Local => node("LocalVariable").child(symbol),
        Whose::Global => node("GlobalVariable").child(symbol),
    })
}

/// A constant with its text.
pub fn constant(literal: &Literal, text: String) -> Node {
    let ty = match literal {
        Literal::Typed { ty, .. } => Some(super::interface::cased(ty.name())),
        Literal::Real(_) => Some("Real".to_string()),
        _ => None,
    };
    let mut constant = Node::new("Constant");
    constant.children.extend(ty.map(|ty| Node::of("ConstantType", ty)));
    constant.child(Node::of("ConstantValue", text))
}

/// `element` with the components of a path, and whose it is.
pub fn path(
    value: &Expr,
    element: &'static str,
    block: &CodeBlock,
    uids: &mut Uids,
    writer: &mut Writer,
) -> Option<(Whose, Node)> {
    let mut node = Node::new(element);
    let root = components(value, &mut node, block, uids, writer)?;
    Some((root, node))
}

fn components(value: &Expr, node: &mut Node, block: &CodeBlock, uids: &mut Uids, writer: &mut Writer) -> Option<Whose> {
    match &value.kind {
        ExprKind::Name(name) => {
            node.push(component(name));
            Some(whose(&name.text, name.form, block))
        }
        ExprKind::Member { base, name } => {
            let root = components(base, node, block, uids, writer)?;
            node.push(component(name));
            Some(root)
        }
        ExprKind::Index { base, indices } => {
            let root = components(base, node, block, uids, writer)?;
            let mut list = Vec::new();
            for index in indices {
                list.push(access(index, block, uids, writer)?);
            }
            let last = node.children.last_mut()?;
            match last.attributes.iter_mut().find(|(key, _)| *key == "AccessModifier") {
                Some((_, modifier)) if modifier == "Reference" => *modifier = "ReferenceToArray".to_string(),
                // `a[1][2]` has no form.
                Some(_) => return None,
                None => last.attributes.push(("AccessModifier", "Array".to_string())),
            }
            last.children.extend(list);
            Some(root)
        }
        ExprKind::Slice { base, width, index } => {
            let root = components(base, node, block, uids, writer)?;
            let letter = match width {
                Width::Bit => "x",
                Width::Byte => "b",
                Width::Word => "w",
                Width::Dword => "d",
                Width::Lword => "l",
            };
            push_slice(node.children.last_mut()?, format!("{letter}{index}"));
            Some(root)
        }
        ExprKind::Dereference(base) => {
            let root = components(base, node, block, uids, writer)?;
            let last = node.children.last_mut()?;
            // `a[1]^` has no form.
            if last.attributes.iter().any(|(key, _)| *key == "AccessModifier") {
                return None;
            }
            last.attributes.push(("AccessModifier", "Reference".to_string()));
            Some(root)
        }
        ExprKind::MemberAbsolute { base, width, byte, bit } => {
            let root = components(base, node, block, uids, writer)?;
            node.push(place("None", *width, *byte, *bit));
            (node.children.len() == 2).then_some(root)
        }
        _ => None,
    }
}

/// Makes a component a part of itself, `x3`. A part of a part is one, too: the file has only one for each component.
pub fn push_slice(component: &mut Node, slice: String) {
    match component.attributes.iter_mut().find(|(key, _)| *key == "SliceAccessModifier") {
        Some((_, outer)) => *outer = inside(outer, &slice).unwrap_or(slice),
        None => component.attributes.push(("SliceAccessModifier", slice)),
    }
}

/// `x56` of `b7` and `x0`.
fn inside(outer: &str, inner: &str) -> Option<String> {
    let parts = |slice: &str| {
        let (letter, index) = slice.split_at_checked(1)?;
        let bits = match letter {
            "x" => 1_u64,
            "b" => 8,
            "w" => 16,
            "d" => 32,
            "l" => 64,
            _ => return None,
        };
        Some((bits, index.parse::<u64>().ok()?))
    };
    let ((outer_bits, outer), (bits, index)) = (parts(outer)?, parts(inner)?);
    let first = outer.checked_mul(outer_bits)? / bits;
    Some(format!("{}{}", &inner[..1], first.checked_add(index)?))
}

fn component(name: &Name) -> Node {
    named(&name.text)
}

/// A component of a symbol; `:P` at its end means an input or output itself.
pub fn named(name: &str) -> Node {
    match names::without_periphery(name) {
        Some(name) => Node::new("Component").with("Name", name).with("SimpleAccessModifier", "Periphery"),
        None => Node::new("Component").with("Name", name),
    }
}

/// The address of an absolute operand.
pub fn address(kind: &OperandKind) -> Option<Node> {
    Some(match kind {
        OperandKind::Absolute { area, width, byte, bit } => place(area_name(*area), *width, *byte, *bit),
        OperandKind::DbAbsolute { db: BlockName::Numbered { number, .. }, width, byte, bit } => {
            place("DB", *width, *byte, *bit).with("BlockNumber", number)
        }
        OperandKind::Cell { kind, number } => {
            let name = match kind {
                CellKind::Timer => "Timer",
                CellKind::Counter => "Counter",
            };
            Node::new("Address").with("Area", name).with("Type", name).with("BitOffset", number)
        }
        OperandKind::Block(BlockName::Numbered { prefix, number, .. }) => {
            let (area, ty) = match prefix {
                BlockPrefix::Db => ("DB", "Block_DB"),
                BlockPrefix::Di => ("DI", "Block_DB"),
                BlockPrefix::Fc => ("FC", "Block_FC"),
                BlockPrefix::Fb => ("FB", "Block_FB"),
                _ => return None,
            };
            Node::new("Address").with("Area", area).with("Type", ty).with("BlockNumber", number)
        }
        _ => return None,
    })
}

/// The name of an area.
pub fn area_name(area: Area) -> &'static str {
    match area {
        Area::I => "Input",
        Area::Q => "Output",
        Area::M => "Memory",
        Area::Pi => "PeripheryInput",
        Area::Pq => "PeripheryOutput",
        Area::L => "Local",
        Area::Db => "DB",
        Area::Di => "DI",
    }
}

fn place(area: &str, width: Width, byte: u32, bit: u8) -> Node {
    let ty = match width {
        Width::Bit => "Bool",
        Width::Byte => "Byte",
        Width::Word => "Word",
        Width::Dword => "DWord",
        Width::Lword => "LWord",
    };
    let offset = u64::from(byte) * 8 + u64::from(bit);
    Node::new("Address").with("Area", area).with("Type", ty).with("BitOffset", offset)
}

/// The name of a block in a call, if it is one.
pub fn block_name(value: &Expr, library: &Library) -> Option<String> {
    match &value.kind {
        ExprKind::Name(name) => Some(name.text.clone()),
        ExprKind::Absolute(OperandKind::Block(name)) => Some(library.own_name(name)),
        _ => None,
    }
}
