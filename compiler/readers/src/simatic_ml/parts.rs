//! Networks of LAD and FBD, first half: the parts, accesses and wires of a `FlgNet`, with directions of pins settled.

use std::collections::HashMap;

use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_literal::distance::nearest;
use roxmltree::Node;

use super::data_type;
use super::operand;
use super::reader::{Reader, Refused};
use super::step_time;
use crate::xml::{attribute_range, child, children, elements, head, text_of};
use plcc_syntax::network::absent;
use plcc_syntax::network::ast::{Comparison, Eno, Target, Template, TemplateKey};
use plcc_syntax::network::elements::{self, Gate, Kind, PinDirection, Row};
use plcc_syntax::scl::ast::{Expr, ExprKind, Name, NameForm};

/// Number of a part, access or wire in its network.
pub type UId = u64;

/// A part or call.
pub struct Part {
    pub uid: UId,
    pub target: Target,
    pub templates: Vec<Template>,
    pub eno: Eno,
    pub equation: Option<Expr>,
    pub cases: Vec<Comparison>,
    /// Inverted pins, by their names in the syntax tree.
    pub negated: Vec<String>,
    /// Number of pins that repeat.
    pub card: Option<u32>,
    /// For a call: its parameters in order, and whether the block writes them.
    parameters: Vec<(String, bool)>,
    /// The file does not list the parameters: the wires show them.
    open_parameters: bool,
    /// It compares the time of a step.
    step_time: bool,
    pub span: Span,
}

impl Part {
    pub fn row(&self) -> Option<&'static Row> {
        match &self.target {
            Target::Element { row, .. } => Some(row),
            Target::Block { .. } => None,
        }
    }

    /// Pins that the flow enters and leaves.
    pub fn flow(&self) -> (&'static str, &'static str) {
        self.row().map_or(("en", "eno"), |row| row.flow)
    }

    /// The name in the syntax tree of a pin, and whether the part writes it.
    fn pin(&self, given: &str) -> Option<(String, bool)> {
        match self.row() {
            Some(row) => row.pin(given).map(|(pin, name)| (name, pin.direction == PinDirection::Output)),
            None if given.eq_ignore_ascii_case("en") => Some(("en".to_string(), false)),
            None if given.eq_ignore_ascii_case("eno") => Some(("eno".to_string(), true)),
            None => self.parameters.iter().find(|(name, _)| name.eq_ignore_ascii_case(given)).cloned(),
        }
    }

    /// A parameter of a block whose file does not list them.
    fn parameter(&mut self, name: &str, output: bool) -> Option<(String, bool)> {
        if !self.open_parameters {
            return None;
        }
        self.parameters.push((name.to_string(), output));
        self.parameters.last().cloned()
    }

    /// The position of a pin among the others: flow in, the pins of the table or the parameters, flow out.
    pub fn place(&self, name: &str) -> (usize, u32) {
        let (flow_in, flow_out) = self.flow();
        if name == flow_in {
            return (0, 0);
        }
        if name == flow_out {
            return (usize::MAX, 0);
        }
        let number = name.trim_start_matches(|c: char| !c.is_ascii_digit()).parse().unwrap_or(0);
        let place = match self.row() {
            Some(row) => row.pins().position(|pin| pin.matches(name).is_some()),
            None => self.parameters.iter().position(|(known, _)| known == name),
        };
        (place.unwrap_or(usize::MAX - 2) + 1, number)
    }

    /// Whether it is the gate that joins branches of LAD.
    pub fn is_or(&self) -> bool {
        self.row().is_some_and(|row| row.kind == Kind::Gate(Gate::Or))
    }
}

/// An end of a wire.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    Rail,
    /// A pin of the part at an index; `output`: the part writes it.
    Pin {
        part: usize,
        name: String,
        output: bool,
        span: Span,
    },
    Operand(UId),
    Open,
}

/// A wire, with its ends in the order of the file.
pub struct Wire {
    pub ends: Vec<End>,
    pub span: Span,
}

/// A network as it is in the file.
pub struct Parts {
    pub parts: Vec<Part>,
    /// The operands, by number.
    pub operands: HashMap<UId, Expr>,
    pub wires: Vec<Wire>,
    pub labels: Vec<Name>,
}

fn uid(node: Node) -> Option<UId> {
    node.attribute("UId")?.trim().parse().ok()
}

/// Reads a `FlgNet`; `whose` names the network in messages.
pub fn read(reader: &mut Reader, net: Node, whose: &str) -> Result<Parts, Refused> {
    let mut found = Parts { parts: Vec::new(), operands: HashMap::new(), wires: Vec::new(), labels: Vec::new() };
    let mut wires = Vec::new();
    for node in elements(net) {
        match node.tag_name().name() {
            "Labels" => {
                for declaration in children(node, "LabelDeclaration") {
                    let text =
                        child(declaration, "Label").and_then(|label| label.attribute("Name")).unwrap_or_default();
                    if text.trim().is_empty() {
                        return Err(reader.refuse(declaration, whose, "a label without a name"));
                    }
                    let label = reader.label(declaration, text.trim().to_string());
                    found.labels.push(label);
                }
            }
            "Parts" => parts(reader, node, whose, &mut found)?,
            "Wires" => wires.extend(elements(node)),
            "Comment" | "LineComment" => {}
            other => return Err(reader.refuse(node, whose, &format!("`{other}`"))),
        }
    }
    let index: HashMap<UId, usize> = found.parts.iter().enumerate().map(|(at, part)| (part.uid, at)).collect();
    for node in wires {
        let wire = wire(reader, node, whose, &mut found, &index)?;
        found.wires.push(wire);
    }
    Ok(found)
}

fn parts(reader: &mut Reader, list: Node, whose: &str, found: &mut Parts) -> Result<(), Refused> {
    numbers(reader, list, whose)?;
    for node in elements(list) {
        match (node.tag_name().name(), uid(node)) {
            ("Access", Some(uid)) => {
                let operand = reader.operand(node, whose)?;
                found.operands.insert(uid, operand);
            }
            ("Part", Some(uid)) => {
                let part = part(reader, node, uid, whose)?;
                found.parts.push(part);
                if let Some(compared) = step_time::of(node.attribute("Name").unwrap_or_default()) {
                    step_time::wire(reader, node, compared, whose, found)?;
                }
            }
            ("Call", Some(uid)) => {
                let part = call(reader, node, uid, whose)?;
                found.parts.push(part);
            }
            ("Comment" | "LineComment", _) => {}
            (other, _) => return Err(reader.refuse(node, whose, &format!("`{other}`"))),
        }
    }
    Ok(())
}

/// Wires name parts by their numbers, so each part has its own.
fn numbers(reader: &mut Reader, list: Node, whose: &str) -> Result<(), Refused> {
    let mut known: HashMap<UId, Node> = HashMap::new();
    for node in elements(list).filter(|node| matches!(node.tag_name().name(), "Access" | "Part" | "Call")) {
        let range = attribute_range(node, "UId");
        let Some(uid) = uid(node) else {
            let label = match node.attribute("UId") {
                Some(written) => format!("`{written}` is not a number"),
                None => "`UId` is missing".to_string(),
            };
            let title = format!("{whose} has a part without a number, which no wire can name");
            return Err(reader.fault(range, title, label, "give it a `UId` that no other part of the network has"));
        };
        if let Some(first) = known.insert(uid, node) {
            let free = elements(list).filter_map(self::uid).max().unwrap_or(0).saturating_add(1);
            let title = format!("{whose} has the UId {uid} twice");
            let help = format!("give one of them another number, such as {free}, and correct the wires that name it");
            let refused = reader.fault(range, title, "the second part with this number", help);
            let first = reader.span(attribute_range(first, "UId"));
            if let Some(message) = reader.diagnostics.pop() {
                reader.diagnostics.push(message.also(first, "the first one"));
            }
            return Err(refused);
        }
    }
    Ok(())
}

fn part(reader: &mut Reader, node: Node, uid: UId, whose: &str) -> Result<Part, Refused> {
    let name = node.attribute("Name").unwrap_or_default();
    if name.is_empty() {
        let title = format!("{whose} has a part without a name");
        return Err(reader.fault(
            head(node),
            title,
            "`Name` is missing",
            "name the element, as in `<Part Name=\"Contact\" UId=\"21\" />`",
        ));
    }
    let span = reader.name_span(node, "Name");
    let step_time = step_time::of(name);
    let row = if step_time.is_some() { elements::find_xml("Gt") } else { elements::find_xml(name) };
    if let (None, Some((why, help))) = (row, absent::reason(name)) {
        let text = match plcc_stdlib::catalogued(name) {
            Some((group, own)) => {
                format!("{whose} contains `{own}`, an instruction of {} that plcc does not have", group.tool)
            }
            None => format!("{whose} contains the element `{name}`, which plcc does not have"),
        };
        reader.diagnostics.push(Diagnostic::new(Code::UnknownElement, span, text).label(why).help(help));
        return Err(Refused);
    }
    let target = match row {
        Some(row) => Target::Element { row, instance: None },
        // A block of the system library, by name.
        None if is_library_call(node) => {
            let name = Name { text: name.to_string(), form: NameForm::Bare, span };
            Target::Block { callee: Expr { kind: ExprKind::Name(name), span }, instance: None }
        }
        None if let Some((group, written)) = plcc_stdlib::catalogued(name) => {
            let text =
                format!("{whose} contains `{written}`, an instruction of {} that plcc does not have", group.tool);
            let help = format!("write a block `{written}` that does the same, and call it here");
            let label = format!("group: {}", group.name);
            reader.diagnostics.push(Diagnostic::new(Code::UnknownElement, span, text).label(label).help(help));
            return Err(Refused);
        }
        None => {
            let message = Diagnostic::new(
                Code::UnknownElement,
                span,
                format!("{whose} contains the element `{name}`, which plcc does not know"),
            );
            let help = match plcc_syntax::network::elements::nearest_sd(name) {
                Some(known) => format!("is `{known}` meant? Otherwise call a block that does the same"),
                None => "call a block that does the same, or write the network in SCL".to_owned(),
            };
            reader.diagnostics.push(message.label("not known").help(help));
            return Err(Refused);
        }
    };
    let mut part = Part {
        uid,
        target,
        templates: Vec::new(),
        eno: if row.is_none_or(Row::is_box) { eno(node) } else { Eno::Default },
        equation: None,
        cases: Vec::new(),
        negated: Vec::new(),
        card: None,
        parameters: Vec::new(),
        open_parameters: row.is_none(),
        step_time: step_time.is_some(),
        span,
    };
    for setting in elements(node) {
        match setting.tag_name().name() {
            "Instance" => {
                let found = reader.instance(setting, whose)?;
                match &mut part.target {
                    Target::Element { instance, .. } | Target::Block { instance, .. } => *instance = Some(found),
                }
            }
            "TemplateValue" => template(reader, setting, &mut part, whose)?,
            "AutomaticTyped" => {
                let key = TemplateKey::of(setting.attribute("Name").unwrap_or_default());
                part.templates.push(Template { key, value: String::new(), span: reader.span(head(setting)) });
            }
            "Equation" => {
                let text = text_of(setting);
                let wanted = setting.first_child().map_or(setting.range().start, |text| text.range().start);
                part.equation = Some(reader.expression(setting, wanted, &text));
            }
            "Negated" => negate(reader, setting, &mut part, whose)?,
            "Invisible" | "Comment" | "LineComment" | "StringAttribute" | "BooleanAttribute" | "IntegerAttribute" => {}
            other => return Err(reader.refuse(setting, whose, &format!("the element `{name}` with `{other}`"))),
        }
    }
    Ok(part)
}

/// Whether a part that is not in the table is a call of the system library: such a call has a version, an instance, or an optional ENO.
fn is_library_call(node: Node) -> bool {
    node.attribute("Version").is_some() || node.attribute("DisabledENO").is_some() || child(node, "Instance").is_some()
}

fn eno(node: Node) -> Eno {
    match node.attribute("DisabledENO") {
        Some(value) if value.eq_ignore_ascii_case("true") || value == "1" => Eno::Disabled,
        Some(_) => Eno::Generated,
        None => Eno::Default,
    }
}

/// Names of settings that the compiler does not need: types that follow from the operands. SIMATIC SD has them too.
pub const OTHER_TEMPLATES: &[&str] = &[
    "date_type",
    "in1_type",
    "in2_type",
    "in_out_type",
    "operand_type",
    "operation",
    "res_type",
    "result_type",
    "string_type",
    "type",
];

fn template(reader: &mut Reader, node: Node, part: &mut Part, whose: &str) -> Result<(), Refused> {
    let value = text_of(node);
    let name = node.attribute("Name").unwrap_or_default();
    let key = TemplateKey::of(name);
    if key == TemplateKey::Card {
        // The pins are only counted; only gates need pins that nothing is wired to.
        part.card = value.parse().ok();
        return match part.card {
            Some(_) => Ok(()),
            None => Err(reader.refuse(node, whose, &format!("`{value}` as a number of pins"))),
        };
    }
    let is_case = part.row().is_some_and(|row| row.kind == Kind::Switch);
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let is_known = TemplateKey::of(stem) != TemplateKey::Other
        || OTHER_TEMPLATES.iter().any(|known| known.eq_ignore_ascii_case(stem));
    if !is_known && !is_case {
        let span = reader.span(head(node));
        let title = format!("{whose} contains the setting `{name}` of an element, which plcc does not know");
        let mut message = Diagnostic::new(Code::ForeignContent, span, title).label("has no effect");
        message.severity = Severity::Warning;
        reader.diagnostics.push(message.help("check whether the element works as intended without it"));
    }
    if let Some(case) = Comparison::of(&value).filter(|_| is_case) {
        part.cases.push(case);
        return Ok(());
    }
    let range = node.first_child().map_or_else(|| attribute_range(node, "Name"), |text| text.range());
    if key != TemplateKey::Other
        && let Some(meant) = data_type::meant(&value)
    {
        let title = format!("{whose} sets `{name}` of an element to `{value}`, which is not a data type");
        return Err(reader.fault(range, title, "a data type is expected", format!("is `{meant}` meant?")));
    }
    let placed = reader.overlay.place(&value, range.start, range.clone());
    part.templates.push(Template { key, value, span: reader.span(placed.unwrap_or(range)) });
    Ok(())
}

fn negate(reader: &mut Reader, node: Node, part: &mut Part, whose: &str) -> Result<(), Refused> {
    let name = node.attribute("Name").unwrap_or_default();
    match part.pin(name).or_else(|| part.parameter(name, false)) {
        Some((name, _)) => part.negated.push(name),
        None => return Err(unknown_pin(reader, node, part, whose)),
    }
    Ok(())
}

/// Sections of the parameters of a call.
const SECTIONS: [&str; 8] = ["Input", "Output", "InOut", "Return", "Static", "Temp", "Constant", "None"];

/// Reports a value of an attribute that the attribute does not have.
fn value_of(reader: &mut Reader, node: Node, attribute: &str, known: &[&str], whose: &str) -> Result<(), Refused> {
    let Some(value) = node.attribute(attribute).filter(|value| !known.contains(value)) else { return Ok(()) };
    let title = format!("`{value}` is not a value of `{attribute}`, in {whose}");
    let help = match nearest(value, known.iter().copied()) {
        Some(meant) => format!("is `{meant}` meant?"),
        None => format!("its values are {}", known.join(", ")),
    };
    Err(reader.fault(attribute_range(node, attribute), title, format!("of `{}`", node.tag_name().name()), help))
}

fn call(reader: &mut Reader, node: Node, uid: UId, whose: &str) -> Result<Part, Refused> {
    let Some(info) = child(node, "CallInfo") else {
        return Err(reader.refuse(node, whose, "a call without `CallInfo`"));
    };
    value_of(reader, info, "BlockType", &["FB", "FC"], whose)?;
    for parameter in children(info, "Parameter") {
        value_of(reader, parameter, "Section", &SECTIONS, whose)?;
    }
    let name = info.attribute("Name").unwrap_or_default();
    if info.attribute("BlockType") == Some("FC") && child(info, "Instance").is_some() {
        let title = format!("{whose} calls `{name}` as an FC, but with an instance");
        let help = "remove `Instance`, or write `BlockType=\"FB\"`";
        return Err(reader.fault(attribute_range(info, "BlockType"), title, "a function has no instance", help));
    }
    if info.attribute("BlockType") == Some("FB") && child(info, "Instance").is_none() {
        let title = format!("{whose} calls `{name}` as an FB, but without an instance");
        let help = "add `Instance` with the data block or the variable, or write `BlockType=\"FC\"`";
        return Err(reader.fault(attribute_range(info, "BlockType"), title, "its data is in an instance", help));
    }
    let range = attribute_range(info, "Name");
    let callee = reader.expression(info, range.start.saturating_sub(1), &operand::quoted(name));
    let mut instance = None;
    let mut parameters = Vec::new();
    for setting in elements(info) {
        match setting.tag_name().name() {
            "Instance" => instance = Some(reader.instance(setting, whose)?),
            "Parameter" => {
                let output = matches!(setting.attribute("Section"), Some("Output" | "Return"));
                parameters.push((setting.attribute("Name").unwrap_or_default().to_string(), output));
            }
            "IntegerAttribute" | "DateAttribute" | "StringAttribute" | "BooleanAttribute" | "Comment" => {}
            other => return Err(reader.refuse(setting, whose, &format!("a call with `{other}`"))),
        }
    }
    let span = callee.span;
    let mut part = Part {
        uid,
        target: Target::Block { callee, instance },
        templates: Vec::new(),
        eno: eno(node),
        equation: None,
        cases: Vec::new(),
        negated: Vec::new(),
        card: None,
        parameters,
        open_parameters: false,
        step_time: false,
        span,
    };
    for setting in elements(node) {
        match setting.tag_name().name() {
            "CallInfo" | "Invisible" | "Comment" | "LineComment" => {}
            "Negated" => negate(reader, setting, &mut part, whose)?,
            other => return Err(reader.refuse(setting, whose, &format!("a call with `{other}`"))),
        }
    }
    Ok(part)
}

fn wire(
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

/// How many numbers a message lists.
const NUMBERS_MAX: usize = 8;

fn unknown_pin(reader: &mut Reader, node: Node, part: &Part, whose: &str) -> Refused {
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
