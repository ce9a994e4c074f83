//! Wires of a network: their ends, which are pins, operands or the power rail.

use std::collections::HashMap;

use plcc_diag::{Code, Diagnostic, Span};
use plcc_literal::distance::nearest;
use roxmltree::Node;

use super::{End, Part, Parts, UId, Wire, uid};
use crate::simatic_ml::reader::{Reader, Refused};
use crate::simatic_ml::step_time;
use crate::xml::{attribute_range, elements, head};
use plcc_syntax::network::ast::Target;
use plcc_syntax::scl::ast::{Expr, ExprKind, Name, NameForm};

/// How many numbers a message lists.
const NUMBERS_MAX: usize = 8;

/// Reads a wire to the parts that were `found`; `index` has them by their numbers.
pub fn wire(
    reader: &mut Reader,
    node: Node,
    whose: &str,
    found: &mut Parts,
    index: &HashMap<UId, usize>,
) -> Result<Wire, Refused> {
    let mut ends: Vec<End> = Vec::new();
    if !crate::xml::is(node, "Wire") {
        return Err(reader.refuse(node, whose, &format!("`{}`", node.tag_name().name())));
    }
    for end in elements(node) {
        let end = match end.tag_name().name() {
            "Powerrail" => End::Rail,
            "OpenCon" | "Openbranch" | "OpenBranch" => End::Open,
            "Comment" | "LineComment" => continue,
            "IdentCon" => match uid(end).filter(|uid| found.operands.contains_key(uid)) {
                Some(uid) => End::Operand(uid),
                None => {
                    return Err(unknown_end(reader, end, "operand", found.operands.keys().copied().collect(), whose));
                }
            },
            "NameCon" => {
                let name = end.attribute("Name").unwrap_or_default();
                let Some(part) = uid(end).and_then(|uid| index.get(&uid)).copied() else {
                    return Err(unknown_end(reader, end, "element", index.keys().copied().collect(), whose));
                };
                // The first end of a wire feeds the others.
                let feeds = ends.is_empty();
                let from_operand = matches!(ends.first(), Some(End::Operand(_)));
                let known = match found.parts[part].step_time {
                    true => Some(step_time::pin(name, from_operand)),
                    false => found.parts[part].pin(name),
                };
                let Some((pin, output)) = known.or_else(|| found.parts[part].parameter(name, feeds)) else {
                    return Err(unknown_pin(reader, end, &found.parts[part], whose));
                };
                let span = reader.name_span(end, "Name");
                End::Pin { part, name: pin, output, span }
            }
            other => return Err(reader.refuse(end, whose, &format!("a wire with `{other}`"))),
        };
        ends.push(end);
    }
    if ends.len() < 2 {
        let title = format!("{whose} has a wire that ends nowhere");
        let label = if ends.is_empty() { "it has no end" } else { "it has only one end" };
        let help = "name the pins that it joins with `NameCon`; a pin that stays open has `OpenCon` at the other end";
        return Err(reader.fault(head(node), title, label, help));
    }
    let outputs: Vec<Span> = ends
        .iter()
        .filter_map(|end| match end {
            End::Pin { output: true, span, .. } => Some(*span),
            End::Pin { .. } | End::Rail | End::Operand(_) | End::Open => None,
        })
        .collect();
    if let [first, second, ..] = outputs.as_slice() {
        let title = format!("{whose} has a wire from two outputs");
        let message = Diagnostic::new(Code::ForeignContent, *second, title)
            .label("the second output")
            .also(*first, "the first one");
        reader.diagnostics.push(message.help("join branches with an element `O`, or correct the names of the pins"));
        return Err(Refused);
    }
    let operands = ends.iter().filter(|end| matches!(end, End::Operand(_))).count();
    if operands > 1 && !ends.iter().any(|end| matches!(end, End::Pin { output: true, .. })) {
        let title = format!("{whose} has a wire from {operands} operands to one pin");
        let help = "a pin has one operand: remove the other `IdentCon`, or give it a wire of its own";
        return Err(reader.fault(head(node), title, "only one of them can be read", help));
    }
    Ok(Wire { ends, span: reader.span(head(node)) })
}

/// A wire to a number that no operand or element has.
fn unknown_end(reader: &mut Reader, end: Node, kind: &str, mut known: Vec<UId>, whose: &str) -> Refused {
    known.sort_unstable();
    let numbers: Vec<String> = known.iter().take(NUMBERS_MAX).map(u64::to_string).collect();
    let more = if known.len() > NUMBERS_MAX { " and more" } else { "" };
    let help = match numbers.is_empty() {
        true => format!("add the {kind} to `Parts`, or remove the wire"),
        false => format!("the numbers of {kind}s are {}{more}", numbers.join(", ")),
    };
    let title = match end.attribute("UId") {
        Some(uid) => format!("{whose} has a wire to the UId {uid}, which no {kind} has"),
        None => format!("{whose} has a wire to an {kind} without saying to which"),
    };
    let label =
        if end.attribute("UId").is_some() { format!("no {kind} of this number") } else { "`UId` is missing".into() };
    reader.fault(attribute_range(end, "UId"), title, label, help)
}

pub fn unknown_pin(reader: &mut Reader, node: Node, part: &Part, whose: &str) -> Refused {
    let name = node.attribute("Name").unwrap_or_default();
    let element = match &part.target {
        Target::Element { row, .. } => row.name.to_string(),
        Target::Block {
            callee: Expr { kind: ExprKind::Name(Name { text, form: NameForm::Quoted, .. }), .. }, ..
        } => text.clone(),
        Target::Block { .. } => "call".to_string(),
    };
    let pins: Vec<String> = match part.row() {
        Some(row) => row.pins().map(|pin| pin.name().to_string()).collect(),
        None => ["en", "eno"]
            .map(str::to_string)
            .into_iter()
            .chain(part.parameters.iter().map(|(name, _)| name.clone()))
            .collect(),
    };
    let help = match nearest(name, pins.iter().map(String::as_str)) {
        Some(meant) => format!("is `{meant}` meant?"),
        None => format!("its pins are {}", pins.join(", ")),
    };
    let title = match name.is_empty() {
        true => format!("{whose} has a wire to `{element}` without the name of a pin"),
        false => format!("`{element}` has no pin `{name}`"),
    };
    let message = Diagnostic::new(Code::UnknownParameter, reader.span(attribute_range(node, "Name")), title);
    reader.diagnostics.push(message.label(format!("not a pin of this element, in {whose}")).help(help));
    Refused
}
