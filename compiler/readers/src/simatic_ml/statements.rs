//! Networks in STL: the statements of a `StatementList`, written to their positions in the overlay and parsed there.

use roxmltree::Node;

use super::operand::{self, Notation};
use super::reader::{Reader, Refused};
use super::tokens;
use crate::xml::{attribute_range, child, children, elements, is, text_of};
use plcc_syntax::ast::Statement;
use plcc_syntax::stl::fragment;

/// The statements of a network.
pub fn read(reader: &mut Reader, source: Node, whose: &str) -> Result<Vec<Statement>, Refused> {
    for node in elements(source) {
        match node.tag_name().name() {
            "StlStatement" => statement(reader, node, whose)?,
            "LineComment" => tokens::pragma(reader, node),
            "Comment" | "BlankLine" | "NewLine" | "Blank" => {}
            other => return Err(reader.refuse(node, whose, &format!("`{other}`"))),
        }
    }
    let (statements, messages) =
        fragment::statements(reader.file, reader.overlay.text(), source.range(), reader.pragmas);
    reader.diagnostics.extend(messages);
    Ok(statements)
}

fn statement(reader: &mut Reader, statement: Node, whose: &str) -> Result<(), Refused> {
    for node in elements(statement) {
        match node.tag_name().name() {
            "LabelDeclaration" => {
                for label in children(node, "Label") {
                    let name = format!("{}:", label.attribute("Name").unwrap_or_default().trim());
                    tokens::put(reader, node, &name, attribute_range(label, "Name").start, whose)?;
                }
            }
            "StlToken" => {
                let word = mnemonic(node.attribute("Text").unwrap_or_default());
                tokens::put(reader, node, word, attribute_range(node, "Text").start, whose)?;
            }
            "Access" => access(reader, node, whose)?,
            "LineComment" => tokens::pragma(reader, node),
            // Only the colon of a label and the end of the statement remain, which the parser does not need.
            "Token" if matches!(node.attribute("Text").unwrap_or_default().trim(), "" | ":" | ";") => {}
            "Comment" | "BlankLine" | "NewLine" | "Blank" => {}
            other => return Err(reader.refuse(node, whose, &format!("a statement with `{other}`"))),
        }
    }
    let range = statement.range();
    reader.overlay.place("\n", range.end.saturating_sub(1), range);
    Ok(())
}

fn access(reader: &mut Reader, node: Node, whose: &str) -> Result<(), Refused> {
    match child(node, "CallInfo").or_else(|| child(node, "Instruction")) {
        Some(info) => call(reader, info, whose),
        None => {
            let text = operand::access(node, Notation::Stl);
            let text = text.map_err(|unreadable| reader.refuse_access(&unreadable, whose))?;
            tokens::put(reader, node, &text, operand::wanted_place(node), whose)
        }
    }
}

/// `"block", "instance" (a := 1, b := #x)`.
fn call(reader: &mut Reader, info: Node, whose: &str) -> Result<(), Refused> {
    let name = info.attribute("Name").unwrap_or_default();
    let instance = child(info, "Instance");
    let mut text = if is(info, "Instruction") && instance.is_none() {
        operand::plain_or_quoted(name)
    } else {
        operand::quoted(name)
    };
    if let Some(instance) = instance {
        let local = instance.attribute("Scope").is_some_and(|scope| scope.starts_with("Local"));
        let path = operand::path(instance, local, Notation::Stl, 0);
        let path = path.map_err(|unreadable| reader.refuse_access(&unreadable, whose))?;
        // A multi-instance is called by its own name, unless its data is that of several instructions.
        let needs_name = is(info, "Instruction") && SHARED_DATA.iter().any(|known| known.eq_ignore_ascii_case(name));
        text = match local {
            true if needs_name => format!("{name}, {path}"),
            true => path,
            false => format!("{text}, {path}"),
        };
    }
    let mut parameters = Vec::new();
    let mut types = Vec::new();
    for part in elements(info) {
        match part.tag_name().name() {
            "Parameter" => parameters.push(part),
            // The type of an instance is known from its declaration. Others have types, and T_COMP a relation.
            "TemplateValue" if instance.is_none() && part.attribute("Type") != Some("Cardinality") => {
                let name = operand::plain_or_quoted(part.attribute("Name").unwrap_or_default());
                types.push(format!("{name} := {}", operand::plain_or_quoted(&text_of(part))));
            }
            "Instance" | "Blank" | "NewLine" | "Comment" | "LineComment" | "IntegerAttribute" | "DateAttribute"
            | "StringAttribute" | "BooleanAttribute" | "TemplateValue" | "AutomaticTyped" => {}
            other => return Err(reader.refuse(part, whose, &format!("a call with `{other}`"))),
        }
    }
    if !types.is_empty() {
        text.push_str(&format!(" {{{}}}", types.join("; ")));
    }
    if parameters.is_empty() {
        return tokens::put(reader, info, &text, info.range().start, whose);
    }
    tokens::put(reader, info, &format!("{text} ("), info.range().start, whose)?;
    let mut is_first = true;
    for parameter in parameters {
        let mut actual = None;
        for part in elements(parameter) {
            match part.tag_name().name() {
                "Access" if actual.is_none() => {
                    let text = operand::access(part, Notation::Stl);
                    actual = Some(text.map_err(|unreadable| reader.refuse_access(&unreadable, whose))?);
                }
                "Blank" | "NewLine" | "Comment" | "LineComment" | "IntegerAttribute" | "DateAttribute"
                | "StringAttribute" | "BooleanAttribute" => {}
                "Token" if matches!(part.attribute("Text").unwrap_or_default().trim(), "" | ":=" | "," | "=>") => {}
                other => return Err(reader.refuse(part, whose, &format!("a parameter with `{other}`"))),
            }
        }
        // A parameter that nothing is assigned to.
        let Some(actual) = actual else { continue };
        let comma = if std::mem::take(&mut is_first) { "" } else { "," };
        let name = operand::plain_or_quoted(parameter.attribute("Name").unwrap_or_default());
        tokens::put(reader, parameter, &format!("{comma}{name} := {actual}"), parameter.range().start, whose)?;
    }
    tokens::put(reader, info, ")", info.range().end.saturating_sub(1), whose)
}

/// Instructions whose instances may be of the type IEC_TIMER or IEC_COUNTER, which does not say which instruction is meant.
const SHARED_DATA: [&str; 7] = ["TP", "TON", "TOF", "TONR", "CTU", "CTD", "CTUD"];

/// Tokens of the export whose mnemonics have other letters.
#[rustfmt::skip]
const MNEMONICS: &[(&str, &str)] = &[
    ("Assign", "="), ("Rise", "FP"), ("Fall", "FN"),
    ("A_BRACK", "A("), ("AN_BRACK", "AN("), ("O_BRACK", "O("), ("ON_BRACK", "ON("), ("X_BRACK", "X("), ("XN_BRACK", "XN("),
    ("BRACKET", ")"), ("CLOSE_BRACKET", ")"), ("NOP_0", "NOP 0"), ("NOP_1", "NOP 1"), ("NOP0", "NOP 0"), ("NOP1", "NOP 1"),
    ("OPEN_DB", "OPN"), ("OPEN_DI", "OPN"), ("OPEN", "OPN"),
    ("L_STW", "L STW"), ("T_STW", "T STW"), ("LOAD", "L"), ("TRANSFER", "T"),
    ("LAR1_ACCU1", "LAR1"), ("LAR2_ACCU1", "LAR2"), ("LAR1_AR2", "LAR1 AR2"), ("TAR1_ACCU1", "TAR1"), ("TAR2_ACCU1", "TAR2"),
    ("TAR1_AR2", "TAR1 AR2"), ("CAR", "CAR"), ("ADD_AR1", "+AR1"), ("ADD_AR2", "+AR2"), ("PLUS_AR1", "+AR1"), ("PLUS_AR2", "+AR2"),
    ("ADD", "+"), ("ADD_I", "+I"), ("SUB_I", "-I"), ("MUL_I", "*I"), ("DIV_I", "/I"),
    ("ADD_D", "+D"), ("SUB_D", "-D"), ("MUL_D", "*D"), ("DIV_D", "/D"), ("ADD_R", "+R"), ("SUB_R", "-R"), ("MUL_R", "*R"), ("DIV_R", "/R"),
    ("ADDI", "+I"), ("SUBI", "-I"), ("MULI", "*I"), ("DIVI", "/I"), ("ADDD", "+D"), ("SUBD", "-D"), ("MULD", "*D"), ("DIVD", "/D"),
    ("ADDR", "+R"), ("SUBR", "-R"), ("MULR", "*R"), ("DIVR", "/R"),
    ("EQ_I", "==I"), ("NE_I", "<>I"), ("GT_I", ">I"), ("LT_I", "<I"), ("GE_I", ">=I"), ("LE_I", "<=I"),
    ("EQ_D", "==D"), ("NE_D", "<>D"), ("GT_D", ">D"), ("LT_D", "<D"), ("GE_D", ">=D"), ("LE_D", "<=D"),
    ("EQ_R", "==R"), ("NE_R", "<>R"), ("GT_R", ">R"), ("LT_R", "<R"), ("GE_R", ">=R"), ("LE_R", "<=R"),
    ("EQI", "==I"), ("NEI", "<>I"), ("GTI", ">I"), ("LTI", "<I"), ("GEI", ">=I"), ("LEI", "<=I"),
    ("EQD", "==D"), ("NED", "<>D"), ("GTD", ">D"), ("LTD", "<D"), ("GED", ">=D"), ("LED", "<=D"),
    ("EQR", "==R"), ("NER", "<>R"), ("GTR", ">R"), ("LTR", "<R"), ("GER", ">=R"), ("LER", "<=R"),
    ("RND_PLUS", "RND+"), ("RND_MINUS", "RND-"), ("RNDP", "RND+"), ("RNDM", "RND-"),
    ("MCR_BRACK", "MCR("), ("BRACK_MCR", ")MCR"), ("MCR_OPEN", "MCR("), ("MCR_CLOSE", ")MCR"),
    ("EMPTY_LINE", ""), ("COMMENT", ""), ("EMPTY", ""),
];

/// The mnemonic of a token, in international spelling.
fn mnemonic(token: &str) -> &str {
    MNEMONICS.iter().find(|(known, _)| known.eq_ignore_ascii_case(token)).map_or(token, |(_, mnemonic)| mnemonic)
}
