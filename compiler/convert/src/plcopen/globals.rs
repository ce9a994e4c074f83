//! Global variables: tags, constants, and data blocks.

use plcc_diag::Span;
use plcc_syntax::ast::{Area, DataBlock, DataContent, Width};
use plcc_syntax::scl::ast::Expr;
use plcc_syntax::symbols::{Symbol, SymbolTarget};

use super::body::tag_type;
use super::declare::Declarer;
use super::program::{Global, Program};
use super::{chart, documentation, system};
use crate::node::Node;
use crate::scl::expression;
use crate::writer::Writer;

/// Where a tag is.
pub enum Form {
    At(String),
    /// In memory of its own: its address has no form in PLCopen XML, and nothing else is at the place.
    Apart,
}

/// Where a tag is in the file; otherwise why it cannot be there.
pub fn tag_form(symbol: &Symbol) -> Result<Form, String> {
    let name = &symbol.name;
    let SymbolTarget::Memory { area, width, byte, bit } = symbol.target else {
        return Err(format!("`{name}` is a timer or counter of the CPU, which PLCopen XML does not have"));
    };
    if tag_type(symbol).and_then(system::type_element).is_none() {
        return Err(format!("plcc writes no tags of type {} in PLCopen XML, such as `{name}`", symbol.ty.trim()));
    }
    let letter = match area {
        Area::I => 'I',
        Area::Q => 'Q',
        Area::M => 'M',
        _ => return Err(format!("`{name}` is in the periphery, which PLCopen XML does not have")),
    };
    match system::address(letter, width, byte, bit) {
        Some(address) => Ok(Form::At(address)),
        None if letter == 'M' => Ok(Form::Apart),
        None => {
            let bytes = width.bytes();
            Err(format!(
                "PLCopen XML has no address for `{name}`, {bytes} bytes from {letter}B {byte}: its addresses count units of {bytes} bytes"
            ))
        }
    }
}

/// Whether a tag has an address in the file.
pub fn has_place(symbol: &Symbol) -> bool {
    matches!(tag_form(symbol), Ok(Form::At(_)))
}

/// The bytes of a tag in M.
fn bytes(symbol: &Symbol) -> Option<(u32, u32)> {
    match symbol.target {
        SymbolTarget::Memory { area: Area::M, width, byte, .. } => Some((byte, width.bytes())),
        _ => None,
    }
}

/// The variable of a tag without its type, `None` if the file cannot have it and nothing uses it.
pub fn tag(program: &Program, key: &str, symbol: &Symbol, is_used: bool, writer: &mut Writer) -> Option<Node> {
    let form = match tag_form(symbol) {
        Ok(form) => form,
        Err(reason) => {
            // A tag that is used is reported where it is used.
            if !is_used {
                writer.warn(symbol.span, reason, "nothing uses the tag, so it is left out");
            }
            return None;
        }
    };
    let ty = tag_type(symbol).and_then(system::type_element)?;
    let mut node = Node::new("variable").with("name", program.name(key));
    match form {
        Form::At(address) => node.attributes.push(("address", address)),
        Form::Apart => apart(program, symbol, writer),
    }
    let mut node = node.child(Node::new("type").child(Node::new(ty)));
    if !symbol.comment.trim().is_empty() {
        node.push(documentation(symbol.comment.trim()));
    }
    Some(node)
}

/// A tag in memory of its own must share its bytes with nothing.
fn apart(program: &Program, symbol: &Symbol, writer: &mut Writer) {
    let Some((first, count)) = bytes(symbol) else { return };
    let overlaps = |(byte, length): (u32, u32)| byte < first + count && first < byte + length;
    let tags = program.tables.iter().flat_map(|table| &table.symbols);
    let mut others = tags.filter(|other| !std::ptr::eq(*other, symbol) && bytes(other).is_some_and(overlaps));
    let what = format!(
        "the {count} bytes from MB {first} have no address in PLCopen XML, which counts units of {count} bytes"
    );
    if let Some(other) = others.next() {
        let title = format!("{what}, and `{}` shares bytes with `{}`", symbol.name, other.name);
        writer.refuse(symbol.span, title, "give one of them another address");
    } else if program.learned.memory.iter().any(|place| overlaps(*place)) {
        let title = format!("{what}, and the program uses bytes of `{}` by their address", symbol.name);
        writer.refuse(symbol.span, title, "give it another address");
    } else {
        let title = format!("`{}` has no address in the file: {what}", symbol.name);
        writer.warn(symbol.span, title, "nothing else uses these bytes, so the program does the same");
    }
}

/// The bytes that an operand in M takes.
pub fn memory(width: Width, byte: u32) -> (u32, u32) {
    (byte, width.bytes())
}

/// A constant of a tag table.
pub fn constant(program: &Program, key: &str, ty: &str, value: &Expr, span: Span, writer: &mut Writer) -> Option<Node> {
    let Some(element) = crate::to_stl::types::elementary(ty).and_then(system::type_element) else {
        writer.warn(span, format!("plcc writes no constants of type {ty} in PLCopen XML"), "it is left out");
        return None;
    };
    let text = expression::text(value, writer);
    let value = Node::new("initialValue").child(Node::new("simpleValue").with("value", text));
    let ty = Node::new("type").child(Node::new(element));
    Some(Node::new("variable").with("name", program.name(key)).child(ty).child(value))
}

/// The variable of a data block.
pub fn data<'a>(declarer: &mut Declarer<'_, 'a>, key: &str, block: &'a DataBlock, writer: &mut Writer) -> Node {
    let name = declarer.program.name(key);
    let before = writer.lines_before(block.span.start);
    let mut node = Node::new("variable").with("name", &name);
    let values = match declarer.program.instance_of(block).and_then(|key| declarer.program.global(&key)) {
        Some(Global::Code(of)) => declarer.values(&chart::own_values(of, &block.values), writer),
        _ => declarer.values(&block.values, writer),
    };
    let (ty, initial) = match &block.content {
        DataContent::OfType(ty) => {
            let node = declarer.type_node(ty, key, &name, writer);
            (node, values.map(|values| declarer.initial(&values, ty, writer)))
        }
        DataContent::Array(ty, initial) => {
            let node = declarer.type_node(ty, "values", &name, writer);
            (node, initial.as_ref().or(values.as_ref()).map(|value| declarer.initial(value, ty, writer)))
        }
        DataContent::Struct(members) => {
            let wanted = format!("{name}_data");
            let structure = declarer.structure(members, &wanted, writer);
            let taken: Vec<String> = declarer.structures.iter().map(|(name, _)| name.clone()).collect();
            let ty = declarer.program.free_name(&wanted, &taken);
            declarer.structures.push((ty.clone(), structure));
            let initial = values.and_then(|values| declarer.of_members(&values, members, writer));
            (Node::new("derived").with("name", ty), initial)
        }
        DataContent::Empty => (Node::new("derived"), None),
    };
    node.push(Node::new("type").child(ty));
    node.children.extend(initial);
    let comments: Vec<String> =
        before.into_iter().chain(block.header.title.clone()).chain(block.header.comment.iter().cloned()).collect();
    if !comments.is_empty() {
        node.push(documentation(&comments.join("\n")));
    }
    node
}

/// Whether all of a data block is retentive; `None`: only a part of it.
pub fn retained(block: &DataBlock) -> Option<bool> {
    let DataContent::Struct(members) = &block.content else { return Some(block.header.retain) };
    let is = |name: &String| block.retained.iter().any(|known| known.eq_ignore_ascii_case(name));
    match (block.header.retain || members.iter().all(|member| is(&member.name)), block.retained.is_empty()) {
        (true, _) => Some(!members.is_empty()),
        (false, true) => Some(false),
        (false, false) => None,
    }
}
