//! The allowed contents of the elements of an export: attributes and children, one row per element, for all versions of the format.
//!
//! The readers read the parts of an element that they know. This table finds all other parts, so nothing is skipped silently: in code such a part
//! is an error, in a declaration a warning. Parts without a meaning for the program are in the table, too: numbers of objects, views, dates,
//! comments. Elements marked `Informative` are ignored with everything below them.
//! Source: LAD/FBD reference A2, GRAPH reference B.

use plcc_diag::{Code, Diagnostic, Severity};
use roxmltree::Node;

use super::block;
use super::reader::Reader;
use crate::spelling::{Grammar, Names, Parts};
use crate::xml::{self, elements, head};

/// An element, its attributes and its children, as words separated by blanks.
struct Row(&'static str, &'static str, &'static str);

/// The elements among the tokens of SCL, STL and actions.
const LAYOUT: [&str; 4] = ["Blank", "NewLine", "BlankLine", "Token"];
/// Texts for people; nothing below them has a meaning.
const TEXTS: [&str; 5] = ["Comment", "LineComment", "Title", "StepName", "TransitionName"];
/// Settings as elements, with their name in an attribute.
const SETTINGS: [&str; 6] =
    ["BooleanAttribute", "IntegerAttribute", "StringAttribute", "DateAttribute", "RealAttribute", "UnsignedAttribute"];
/// Names of such settings in code.
const SETTING_NAMES: [&str; 11] = [
    "BlockNumber",
    "Format",
    "FormatFlags",
    "HasQuotes",
    "Inserted",
    "InterfaceFlags",
    "NoClosingBracket",
    "Num",
    "NumBLs",
    "ParameterModifiedTS",
    "TE",
];
/// Attributes that any element may have.
const COMMON: [&str; 3] = ["UId", "Informative", "ID"];

#[rustfmt::skip]
const ROWS: &[Row] = &[
    // LAD and FBD.
    Row("FlgNet", "", "Labels Parts Wires"),
    Row("Labels", "", "LabelDeclaration"),
    Row("LabelDeclaration", "", "Label"),
    Row("Label", "Name", ""),
    Row("Parts", "", "Access Part Call"),
    Row("Part", "Name Version DisabledENO", "Instance Equation TemplateValue AutomaticTyped Invisible Negated"),
    Row("Call", "", "CallInfo Invisible Negated"),
    Row("Equation", "", ""),
    Row("TemplateValue", "Name Type", ""),
    Row("AutomaticTyped", "Name", ""),
    Row("Invisible", "Name", ""),
    Row("Negated", "Name", ""),
    Row("Wires", "", "Wire"),
    Row("Wire", "Name", "Powerrail NameCon IdentCon OpenCon Openbranch OpenBranch"),
    Row("NameCon", "Name", ""),
    Row("IdentCon", "", ""),
    Row("OpenCon", "Name", ""),
    Row("Openbranch", "", ""),
    Row("OpenBranch", "", ""),
    Row("Powerrail", "", ""),
    // Operands and calls, in all languages.
    Row("Access", "Scope Type",
        "Symbol Constant Address CallInfo Instruction Label Statusword StatusWord PredefinedVariable DataType Indirect AbsoluteOffset Expression"),
    Row("Symbol", "Scope", "Component Address Access"),
    Row("Component", "Name AccessModifier SliceAccessModifier SimpleAccessModifier", "Access"),
    Row("Constant", "Name", "ConstantType ConstantValue"),
    Row("ConstantType", "", ""),
    Row("ConstantValue", "", ""),
    Row("Address", "Area Type BlockNumber BitOffset", ""),
    Row("AbsoluteOffset", "BlockNumber BitOffset Type", ""),
    Row("Statusword", "Combination Name", ""),
    Row("StatusWord", "Combination Name", ""),
    Row("PredefinedVariable", "Name", ""),
    Row("DataType", "", ""),
    Row("Indirect", "Width Area Register BitOffset", "Access"),
    Row("CallInfo", "Name BlockType", "Instance Parameter NamelessParameter"),
    Row("Instruction", "Name Version", "Instance TemplateValue AutomaticTyped Parameter NamelessParameter"),
    Row("Instance", "Scope", "Component Address Access"),
    Row("Parameter", "Name Section Type TemplateReference", "Access Expression"),
    Row("NamelessParameter", "Section Type TemplateReference", "Access Expression"),
    Row("Expression", "", "Access Expression Text"),
    Row("Statement", "", "Access Statement Text"),
    // SCL and STL.
    Row("StructuredText", "", "Access Text Parameter NamelessParameter Expression Statement LabelDeclaration"),
    Row("Token", "Text TE", ""),
    Row("Text", "", ""),
    Row("Blank", "Num", ""),
    Row("NewLine", "Num", ""),
    Row("BlankLine", "Num", ""),
    Row("StatementList", "", "StlStatement"),
    Row("StlStatement", "", "LabelDeclaration StlToken Access"),
    Row("StlToken", "Text", ""),
    // GRAPH.
    Row("Graph", "", "PreOperations Sequence PostOperations"),
    Row("PreOperations", "", "PermanentOperation"),
    Row("PostOperations", "", "PermanentOperation"),
    Row("PermanentOperation", "ProgrammingLanguage Number Name", "FlgNet StructuredText StatementList"),
    Row("Sequence", "Number Name", "Steps Transitions Branches Connections"),
    Row("Steps", "", "Step"),
    Row("Step", "Number Init Name MaximumStepTime WarningTime IsMissing", "Actions Supervisions Interlocks"),
    Row("Actions", "", "Action"),
    Row("Action", "Qualifier Event Interlock", "Access Text Parameter NamelessParameter"),
    Row("Supervisions", "", "Supervision"),
    Row("Supervision", "ProgrammingLanguage Number Name", "FlgNet StructuredText StatementList"),
    Row("Interlocks", "", "Interlock"),
    Row("Interlock", "ProgrammingLanguage Number Name", "FlgNet StructuredText StatementList"),
    Row("Transitions", "", "Transition"),
    Row("Transition", "Number Name IsMissing ProgrammingLanguage", "FlgNet StructuredText StatementList"),
    Row("Branches", "", "Branch"),
    Row("Branch", "Number Type Cardinality", ""),
    Row("Connections", "", "Connection"),
    Row("Connection", "", "NodeFrom NodeTo LinkType"),
    Row("NodeFrom", "", "StepRef TransitionRef BranchRef EndConnection"),
    Row("NodeTo", "", "StepRef TransitionRef BranchRef EndConnection"),
    Row("StepRef", "Number", ""),
    Row("TransitionRef", "Number", ""),
    Row("BranchRef", "Number In Out", ""),
    Row("EndConnection", "", ""),
    Row("LinkType", "", ""),
    // Declarations.
    Row("Interface", "", "Sections"),
    Row("Sections", "Datatype Version", "Section"),
    Row("Section", "Name", "Member Sections"),
    Row("Member", "Name Datatype Version Remanence Accessibility",
        "AttributeList Member Sections StartValue Subelement AssignedProDiagFB"),
    Row("AssignedProDiagFB", "", ""),
    Row("StartValue", "ConstantName", ""),
    Row("Subelement", "Path", "StartValue"),
];

/// How the elements of an export are spelt. Tag tables are spelt as their reader says.
pub const GRAMMAR: Grammar = Grammar {
    format: "an export of the TIA Portal",
    parts,
    everywhere: Names::Words(
        "UId Informative ID Blank NewLine BlankLine Token Comment LineComment Title StepName TransitionName BooleanAttribute \
         IntegerAttribute StringAttribute DateAttribute RealAttribute UnsignedAttribute AttributeList",
    ),
};

/// The parts of an element.
fn parts(node: Node) -> Option<Parts> {
    let name = node.tag_name().name();
    let none = Names::Words("");
    let parent = node.parent_element().map_or("", |parent| parent.tag_name().name());
    let children = match name {
        _ if node.attribute("Informative").is_some_and(|value| value.eq_ignore_ascii_case("true")) => return None,
        _ if xml::is_exported_tags(name) => return None,
        _ if xml::is_block(name) || name == "SW.Blocks.CompileUnit" => {
            Names::Words("AttributeList LinkList ObjectList")
        }
        "AttributeList" if xml::is_block(parent) => Names::List(block::SETTINGS),
        "AttributeList" if parent == "SW.Blocks.CompileUnit" => Names::Words("NetworkSource ProgrammingLanguage"),
        "ObjectList" if xml::is_block(parent) => Names::Words("MultilingualText SW.Blocks.CompileUnit"),
        "NetworkSource" => Names::Words("FlgNet StructuredText StatementList Graph"),
        _ if TEXTS.contains(&name) || name.contains("Alarm") => return None,
        _ => match ROWS.iter().find(|row| row.0 == name) {
            Some(Row(_, attributes, children)) => {
                return Some(Parts { attributes: Names::Words(attributes), children: Names::Words(children) });
            }
            // The root, and elements that only hold others.
            None => none,
        },
    };
    Some(Parts { attributes: none, children })
}

/// Their meaning for the program is not known.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Place {
    Code,
    Declaration,
}

/// Reports everything below `node` that is in no row; `whose` names the block or network.
pub fn check(reader: &mut Reader, node: Node, place: Place, whose: &str) {
    let root = node;
    let mut open = vec![node];
    while let Some(node) = open.pop() {
        // Networks inside a chart are checked when they are read.
        if node != root && matches!(node.tag_name().name(), "FlgNet" | "StructuredText" | "StatementList") {
            continue;
        }
        if let Some(Row(_, attributes, children)) = ROWS.iter().find(|row| row.0 == node.tag_name().name()) {
            for attribute in node.attributes().filter(|attribute| attribute.namespace().is_none()) {
                let is = |known: &str| known == attribute.name();
                if !COMMON.into_iter().any(is) && !attributes.split(' ').any(is) {
                    let what = format!("`{}` with the attribute `{}`", node.tag_name().name(), attribute.name());
                    report(reader, attribute.range(), place, whose, &what);
                }
            }
            for child in elements(node) {
                let name = child.tag_name().name();
                let informs = child.attribute("Informative").is_some_and(|value| value.eq_ignore_ascii_case("true"));
                if informs || TEXTS.contains(&name) || name.contains("Alarm") || name == "AttributeList" {
                    continue;
                }
                if SETTINGS.contains(&name) {
                    let setting = child.attribute("Name").unwrap_or_default();
                    if !SETTING_NAMES.contains(&setting) && place == Place::Code {
                        report(reader, head(child), place, whose, &format!("the setting `{setting}`"));
                    }
                    continue;
                }
                if !LAYOUT.contains(&name) && !children.split(' ').any(|known| known == name) {
                    let what = format!("`{}` with `{name}`", node.tag_name().name());
                    report(reader, head(child), place, whose, &what);
                } else {
                    open.push(child);
                }
            }
        }
    }
}

fn report(reader: &mut Reader, range: std::ops::Range<usize>, place: Place, whose: &str, what: &str) {
    let span = reader.span(range);
    let title = format!("{whose} contains {what}, which plcc does not read");
    let mut message = Diagnostic::new(Code::ForeignContent, span, title).label("not known");
    message = match place {
        Place::Code => message
            .help("write the network in another way, in SCL for example; no part of a network is left out silently"),
        Place::Declaration => {
            message.severity = Severity::Warning;
            message.help("the declaration is read without it; no action is needed, unless the program depends on it")
        }
    };
    reader.diagnostics.push(message);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_child_has_a_row_of_its_own() {
        for (at, Row(name, _, children)) in ROWS.iter().enumerate() {
            assert!(ROWS[at + 1..].iter().all(|row| row.0 != *name), "{name} appears twice");
            for child in children.split(' ').filter(|child| !child.is_empty() && *child != "AttributeList") {
                let has_row = ROWS.iter().any(|row| row.0 == child);
                assert!(has_row, "{name}: {child}");
            }
        }
    }
}
