//! Parts and calls of a network: their names, settings and parameters.

use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_literal::distance::nearest;
use roxmltree::Node;

use super::wire::unknown_pin;
use super::{Part, UId};
use crate::simatic_ml::reader::{Reader, Refused};
use crate::simatic_ml::{data_type, operand, step_time};
use crate::xml::{attribute_range, child, children, elements, head, text_of};
use plcc_syntax::network::absent;
use plcc_syntax::network::ast::{Comparison, Eno, Target, Template, TemplateKey};
use plcc_syntax::network::elements::{self, Kind, Row};
use plcc_syntax::scl::ast::{Expr, ExprKind, Name, NameForm};

/// Reads a part: an element, or a block of the system library.
pub fn part(reader: &mut Reader, node: Node, uid: UId, whose: &str) -> Result<Part, Refused> {
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
    let target = target(reader, node, row, span, whose)?;
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

/// The element or the block that a part is; a message if it is neither.
fn target(
    reader: &mut Reader,
    node: Node,
    row: Option<&'static Row>,
    span: Span,
    whose: &str,
) -> Result<Target, Refused> {
    let name = node.attribute("Name").unwrap_or_default();
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
    Ok(match row {
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
            let help = match elements::nearest_sd(name) {
                Some(known) => format!("is `{known}` meant? Otherwise call a block that does the same"),
                None => "call a block that does the same, or write the network in SCL".to_owned(),
            };
            reader.diagnostics.push(message.label("not known").help(help));
            return Err(Refused);
        }
    })
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

/// Reads a call of a block of the program.
pub fn call(reader: &mut Reader, node: Node, uid: UId, whose: &str) -> Result<Part, Refused> {
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
