//! Blocks in GRAPH: their network is a chart.
//!
//! - `nodes`: steps, transitions and branches by number, and the lines between them, which [`plcc_syntax::chart::connect`] turns into FROM and TO.
//! - `step`, `action`: the parts of a step.
//! - `condition`: networks of transitions, interlocks and supervisions.
//! - `permanent`: permanent instructions.
//!
//! Source: GRAPH reference, chapter B.

mod action;
mod condition;
mod nodes;
mod permanent;
mod step;

use plcc_diag::{Code, Diagnostic, Span};
use roxmltree::Node;

use super::network::compile_units;
use super::operand;
use super::reader::{Reader, setting, setting_text, texts};
use super::schema;
use crate::xml::{attribute_range, child, children, elements, head, is, text_of};
use nodes::Nodes;
use plcc_syntax::chart::ast::{Body, Call, Dialect, Interface, Permanent, PermanentKind, Settings, Transition};
use plcc_syntax::chart::connect::{self, Connection};
use plcc_syntax::scl::ast::{Name, NameForm};

/// Reads the chart of a block; `block` names it in messages.
pub fn read(reader: &mut Reader, object: Node, block: &str) -> Body {
    let told = reader.diagnostics.len();
    let mut chart = Body { dialect: Dialect::Tia, settings: settings(object), ..Body::default() };
    let languages = setting_text(object, "LanguageInNetworks").unwrap_or_else(|| "LAD".to_string());
    for unit in compile_units(object) {
        for source in setting(unit, "NetworkSource").into_iter().flat_map(elements) {
            if is(source, "Graph") {
                graph(reader, source, block, &languages, &mut chart);
            } else {
                reader.refuse(source, &format!("`{block}`"), &format!("`{}`", source.tag_name().name()));
            }
        }
    }
    chart.after.extend(extensions(reader, object, block));
    chart.broken = reader.diagnostics[told..].iter().any(Diagnostic::is_error);
    chart
}

/// Settings that name blocks which the chart calls in addition to its steps.
const EXTENSIONS: [&str; 2] = ["ExtensionBlockName", "ExtensionBlocks"];

/// Calls of the blocks that extend the chart, which run after the permanent instructions. See docs/decisions/0077.
fn extensions(reader: &mut Reader, object: Node, block: &str) -> Vec<Permanent> {
    let mut calls = Vec::new();
    for node in EXTENSIONS.iter().filter_map(|name| setting(object, name)) {
        for text in node.descendants().filter(|part| part.is_text()) {
            let names = text.text().unwrap_or_default().split([',', ';', '\n']);
            for name in names.map(|name| name.trim().trim_matches('"')).filter(|name| !name.is_empty()) {
                let callee = reader.expression(node, text.range().start, &operand::quoted(name));
                let span = callee.span;
                let title = format!("`{name}` is called at the end of each call of `{block}`");
                let message =
                    Diagnostic::new(Code::ExtensionBlock, span, title).label("plcc adds this call to the chart");
                let help = "if it must run earlier, call it in a permanent instruction and remove it here";
                reader.diagnostics.push(message.help(help));
                let call = Call { block: callee, instance: None, parameters: Vec::new(), span };
                calls.push(Permanent { kind: PermanentKind::Call(call), span });
            }
        }
    }
    calls
}

/// The settings in the list of attributes; `AckReq` may also be a start value of the sequencer's data.
fn settings(object: Node) -> Settings {
    let flag = |name: &str| setting_text(object, name).map(|value| is_true(&value));
    let is_flag = |member: &Node| {
        let parent = member.parent_element().and_then(|parent| parent.attribute("Name"));
        is(*member, "Member") && member.attribute("Name") == Some("ACK_REQ") && parent == Some("GC_FLAGS")
    };
    let start_value = || {
        let member = setting(object, "Interface")?.descendants().find(is_flag)?;
        child(member, "StartValue").map(|value| is_true(&text_of(value)))
    };
    Settings {
        interface: Some(Interface::UserDefined),
        skip_steps: flag("SkipSteps"),
        acknowledge: flag("AcknowledgeErrorsRequired").or_else(start_value),
        manual_interlocks: flag("PermanentILProcessingInMANMode"),
        locked_mode: flag("LockOperatingMode"),
        ..Settings::default()
    }
}

fn is_true(value: &str) -> bool {
    value.eq_ignore_ascii_case("true") || value == "1"
}

fn graph(reader: &mut Reader, source: Node, block: &str, language: &str, chart: &mut Body) {
    schema::check(reader, source, schema::Place::Code, &format!("`{block}`"));
    let sequences: Vec<Node> = children(source, "Sequence").collect();
    let nodes = Nodes::read(reader, &sequences, block);
    let connections = connect::connect(&nodes.drawing, &mut reader.diagnostics);
    for node in elements(source) {
        match node.tag_name().name() {
            "PreOperations" => {
                chart.before.extend(permanent::read(reader, node, "before the sequencers", block, language))
            }
            "PostOperations" => {
                chart.after.extend(permanent::read(reader, node, "after the sequencers", block, language))
            }
            // Their nodes exist.
            "Sequence" => {}
            other if is_text(other) => {}
            other => {
                reader.refuse(node, &format!("`{block}`"), &format!("`{other}`"));
            }
        }
    }
    for (node, name) in nodes.steps.iter().zip(&nodes.step_names) {
        chart.steps.push(step::read(reader, *node, name, block, language));
    }
    for (at, connection) in connections.iter().enumerate() {
        chart.transitions.push(transition(reader, &nodes, at, connection, block, language));
    }
}

fn transition(
    reader: &mut Reader,
    nodes: &Nodes,
    at: usize,
    connection: &Connection,
    block: &str,
    language: &str,
) -> Transition {
    let node = nodes.transitions[at];
    let name = nodes.transition_names[at].clone();
    let whose = format!("transition `{}` of `{block}`", name.text);
    // A message about a step that it leaves or enters is at the transition.
    let steps = |places: &[usize]| -> Vec<Name> {
        places.iter().map(|step| Name { text: nodes.step_names[*step].text.clone(), ..name.clone() }).collect()
    };
    let (from, to) = (steps(&connection.from), steps(&connection.to));
    reader.own_step = match from.as_slice() {
        [step] => Some(step.text.clone()),
        _ => None,
    };
    let mut missing = node.attribute("IsMissing").is_some_and(is_true);
    let condition = match condition::read(reader, node, language, &whose) {
        condition::Found::Network(condition) => Some(condition),
        condition::Found::Nothing => {
            missing = true;
            None
        }
        condition::Found::Rail | condition::Found::Refused => None,
    };
    for part in elements(node) {
        let name = part.tag_name().name();
        if !condition::is_source(part) && !is_text(name) {
            reader.refuse(part, &whose, &format!("`{name}`"));
        }
    }
    reader.own_step = None;
    Transition {
        number: nodes::number(node, "Number").unwrap_or_default(),
        from,
        to,
        jump: connection.jump,
        path: connection.path.clone(),
        condition,
        missing,
        comment: texts(node, &["Title", "Comment"]),
        span: reader.span(head(node)),
        name,
    }
}

/// The name of a step or transition; its span is its position.
fn name(reader: &mut Reader, node: Node) -> Name {
    let text = node.attribute("Name").unwrap_or_default().trim().to_string();
    let span = reader.name_span(node, "Name");
    Name { text, form: NameForm::Bare, span }
}

/// Whether an element of that name contains texts for people: titles, translated names, alarms.
fn is_text(element: &str) -> bool {
    matches!(element, "Title" | "Comment") || element.ends_with("Name") || element.contains("Alarm")
}

/// The position of an attribute's value.
fn attribute_span(reader: &Reader, node: Node, name: &str) -> Span {
    reader.span(attribute_range(node, name))
}
