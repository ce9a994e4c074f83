//! How the elements of PLCopen XML are spelt, and which values their attributes have. Source: PLCopen TC6, schema 1.0 to 2.01.

use std::collections::HashMap;

use plcc_diag::{Code, Diagnostic, FileId, Span};
use plcc_literal::distance::nearest;
use roxmltree::{Document, Node};

use super::interface::elements;
use crate::spelling::{self, Grammar, Names, Parts};
use crate::xml::attribute_range;

/// An element, its attributes and its children, as words separated by blanks.
struct Row(&'static str, &'static str, &'static str);

const POSITIONED: &str = "localId width height executionOrderId negated edge storage name label typeName instanceName initialStep priority \
                          targetName negatedIn edgeIn storageIn negatedOut edgeOut storageOut";
const OBJECT: &str = "position connectionPointIn connectionPointOut connectionPointOutAction variable expression inputVariables inOutVariables \
                      outputVariables condition body action content";
const VARIABLES: &str = "name constant retain nonretain persistent nonpersistent";
const NETWORK: &str = "comment error connector continuation actionBlock vendorElement block inVariable outVariable inOutVariable label jump \
                       return leftPowerRail rightPowerRail coil contact step macroStep jumpStep transition selectionDivergence \
                       selectionConvergence simultaneousDivergence simultaneousConvergence";
const LANGUAGES: &str = "IL ST FBD LD SFC";

#[rustfmt::skip]
const ROWS: &[Row] = &[
    Row("project", "", "fileHeader contentHeader types instances"),
    Row("types", "", "dataTypes pous"),
    Row("dataTypes", "", "dataType"),
    Row("dataType", "name", "baseType initialValue"),
    Row("pous", "", "pou"),
    Row("pou", "name pouType", "interface actions transitions body"),
    Row("interface", "", "returnType localVars tempVars inputVars outputVars inOutVars externalVars globalVars accessVars"),
    Row("localVars", VARIABLES, "variable"),
    Row("tempVars", VARIABLES, "variable"),
    Row("inputVars", VARIABLES, "variable"),
    Row("outputVars", VARIABLES, "variable"),
    Row("inOutVars", VARIABLES, "variable"),
    Row("externalVars", VARIABLES, "variable"),
    Row("globalVars", VARIABLES, "variable"),
    Row("inputVariables", "", "variable"),
    Row("inOutVariables", "", "variable"),
    Row("outputVariables", "", "variable"),
    Row("variable", "name address formalParameter negated edge storage hidden", "type initialValue connectionPointIn connectionPointOut"),
    Row("array", "", "dimension baseType"),
    Row("dimension", "lower upper", ""),
    Row("range", "lower upper", ""),
    Row("derived", "name", ""),
    Row("struct", "", "variable"),
    Row("enum", "", "values baseType"),
    Row("values", "", "value"),
    Row("value", "name value repetitionValue member", "simpleValue arrayValue structValue"),
    Row("initialValue", "", "simpleValue arrayValue structValue"),
    Row("simpleValue", "value", ""),
    Row("arrayValue", "", "value"),
    Row("structValue", "", "value"),
    Row("body", "WorksheetName", LANGUAGES),
    Row("inline", "name", LANGUAGES),
    Row("actions", "", "action"),
    Row("transitions", "", "transition"),
    Row("action", "localId width height name qualifier duration indicator", "relPosition reference inline connectionPointOut body"),
    Row("condition", "negated", "reference connectionPointIn connection inline"),
    Row("reference", "name", ""),
    Row("FBD", "", NETWORK),
    Row("LD", "", NETWORK),
    Row("SFC", "", NETWORK),
    Row("block", POSITIONED, OBJECT),
    Row("inVariable", POSITIONED, OBJECT),
    Row("outVariable", POSITIONED, OBJECT),
    Row("inOutVariable", POSITIONED, OBJECT),
    Row("contact", POSITIONED, OBJECT),
    Row("coil", POSITIONED, OBJECT),
    Row("leftPowerRail", POSITIONED, OBJECT),
    Row("rightPowerRail", POSITIONED, OBJECT),
    Row("label", POSITIONED, OBJECT),
    Row("jump", POSITIONED, OBJECT),
    Row("return", POSITIONED, OBJECT),
    Row("connector", POSITIONED, OBJECT),
    Row("continuation", POSITIONED, OBJECT),
    Row("step", POSITIONED, OBJECT),
    Row("jumpStep", POSITIONED, OBJECT),
    Row("transition", POSITIONED, OBJECT),
    Row("actionBlock", POSITIONED, OBJECT),
    Row("connectionPointIn", "", "relPosition connection expression"),
    Row("connectionPointOut", "formalParameter", "relPosition expression"),
    Row("connection", "refLocalId formalParameter", "position"),
    Row("instances", "", "configurations"),
    Row("configurations", "", "configuration"),
    Row("configuration", "name", "resource globalVars accessVars configVars"),
    Row("resource", "name", "task globalVars pouInstance"),
    Row("task", "name single interval priority", "pouInstance"),
    Row("pouInstance", "name typeName type", ""),
];

const GRAMMAR: Grammar =
    Grammar { format: "PLCopen XML", parts, everywhere: Names::Words("addData documentation globalId") };

fn parts(node: Node) -> Option<Parts> {
    let row = ROWS.iter().find(|row| row.0 == node.tag_name().name())?;
    Some(Parts { attributes: Names::Words(row.1), children: Names::Words(row.2) })
}

const TRUTH: &[&str] = &["false", "true", "0", "1"];
const EDGES: &[&str] = &["none", "rising", "falling"];
const STORES: &[&str] = &["none", "set", "reset"];

/// The values of an attribute, if they are words.
fn values(name: &str) -> Option<&'static [&'static str]> {
    Some(match name {
        "negated" | "negatedIn" | "negatedOut" | "initialStep" | "constant" | "retain" | "nonretain" | "persistent" => {
            TRUTH
        }
        "edge" | "edgeIn" | "edgeOut" => EDGES,
        "storage" | "storageIn" | "storageOut" => STORES,
        "pouType" => &["function", "functionBlock", "program"],
        _ => return None,
    })
}

/// Mistakes because of which a project is not read: misspelt words, and numbers that two objects have.
pub fn faults(file: FileId, document: &Document) -> Vec<Diagnostic> {
    let mut found = spelling::faults(file, document, &GRAMMAR);
    for node in document.descendants().filter(|node| node.is_element() && parts(*node).is_some()) {
        for attribute in node.attributes() {
            let value = attribute.value().trim();
            let Some(known) = values(attribute.name()).filter(|known| !value.is_empty() && !known.contains(&value))
            else {
                continue;
            };
            let span = Span::new(file, attribute.range_value());
            let title = format!("`{value}` is not a value of `{}`", attribute.name());
            let help = match nearest(value, known.iter().copied()) {
                Some(meant) => format!("is `{meant}` meant?"),
                None => format!("its values are {}", known.join(", ")),
            };
            let label = format!("of `{}`", node.tag_name().name());
            found.push(Diagnostic::new(Code::ForeignContent, span, title).label(label).help(help));
        }
        if let Some(id) = node.attribute("refLocalId").filter(|id| id.trim().parse::<u64>().is_err()) {
            let span = Span::new(file, attribute_range(node, "refLocalId"));
            let message = Diagnostic::new(Code::ForeignContent, span, format!("`{id}` is not the number of an object"));
            found.push(
                message
                    .label("a line comes from an object by its `localId`")
                    .help("write the `localId` of an object of this network"),
            );
        }
        match node.tag_name().name() {
            "LD" | "FBD" | "SFC" => found.extend(twice(file, node)),
            "interface" => found.extend(declared_twice(file, node)),
            "simpleValue" => found.extend(without_value(file, node)),
            _ => {}
        }
    }
    found.sort_by_key(|message| message.primary.span.start);
    found
}

/// Objects of one body with the same number, for which it would be open what a line means, and objects whose number is not one.
fn twice(file: FileId, body: Node) -> Vec<Diagnostic> {
    let mut known: HashMap<&str, Node> = HashMap::new();
    let mut found = Vec::new();
    for node in elements(body) {
        let Some(id) = node.attribute("localId").map(str::trim) else { continue };
        let span = Span::new(file, attribute_range(node, "localId"));
        if id.parse::<u64>().is_err() {
            let message = Diagnostic::new(Code::ForeignContent, span, format!("`{id}` is not the number of an object"));
            found.push(message.label("lines name the object by its `localId`").help(
                "write a whole number that no other object of this network has, and the same in each `refLocalId` \
                 that means the object",
            ));
            continue;
        }
        if let Some(first) = known.insert(id, node) {
            let first = Span::new(file, attribute_range(first, "localId"));
            let message =
                Diagnostic::new(Code::ForeignContent, span, format!("two objects of a network have the number {id}"));
            found.push(
                message
                    .label("the second one")
                    .also(first, "the first one")
                    .help("give one of them a `localId` of its own, and correct each `refLocalId` that names it"),
            );
        }
    }
    found
}

/// Variables of one interface with the same name, of which one has an address. Binding finds those without.
fn declared_twice(file: FileId, interface: Node) -> Vec<Diagnostic> {
    let mut known: HashMap<String, Node> = HashMap::new();
    let mut found = Vec::new();
    let variables = elements(interface).flat_map(elements).filter(|node| node.tag_name().name() == "variable");
    for node in variables {
        let Some(name) = node.attribute("name") else { continue };
        let Some(first) = known.insert(name.to_lowercase(), node) else { continue };
        if !(node.has_attribute("address") || first.has_attribute("address")) {
            continue;
        }
        let place = |node: Node| Span::new(file, attribute_range(node, "name"));
        found.push(
            Diagnostic::new(Code::DuplicateName, place(node), format!("`{name}` is declared twice"))
                .label("the second declaration")
                .also(place(first), "the first declaration")
                .help("give one of them another name"),
        );
    }
    found
}

/// `<simpleValue val="5"/>`; without any attribute there is no value.
fn without_value(file: FileId, node: Node) -> Option<Diagnostic> {
    let other = node.attributes().find(|attribute| attribute.name() != "value")?;
    if node.has_attribute("value") {
        return None;
    }
    let name = other.name();
    let title = format!("`simpleValue` has no attribute `{name}`");
    let help = format!("write `value` for `{name}`");
    Some(
        Diagnostic::new(Code::ForeignContent, Span::new(file, other.range_qname()), title)
            .label("the value is not read")
            .help(help),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_child_with_a_row_is_spelt_alike() {
        for (at, Row(name, ..)) in ROWS.iter().enumerate() {
            assert!(ROWS[at + 1..].iter().all(|row| row.0 != *name), "{name} appears twice");
        }
    }

    fn told(body: &str) -> Vec<String> {
        let text = format!(
            "<project><types><pous><pou name='p' pouType='program'><body><LD>{body}</LD></body></pou></pous></types></project>"
        );
        let document = Document::parse(&text).expect("well-formed");
        faults(FileId(0), &document)
            .into_iter()
            .map(|message| format!("{}; {}", message.title, message.help.unwrap_or_default()))
            .collect()
    }

    #[test]
    fn words_and_numbers() {
        let none: [&str; 0] = [];
        assert_eq!(told("<contact localId='1' negated='true' edge='rising' storage=''/><coil localId='2'/>"), none);
        assert_eq!(
            told("<contact localId='1' negated='ture'/><coil localId='2' storage='latch'/>"),
            [
                "`ture` is not a value of `negated`; is `true` meant?",
                "`latch` is not a value of `storage`; its values are none, set, reset"
            ]
        );
        assert_eq!(told("<contact localId='1'/><coil localId='1'/>").len(), 1);
        let number = told("<contact localId='x'/><coil localId='2'/>");
        assert_eq!(number.len(), 1);
        assert!(number[0].starts_with("`x` is not the number of an object; write a whole number"), "{number:?}");
        assert_eq!(told("<contcat localId='1'/><coil nagated='true'/>").len(), 2);
    }
}
