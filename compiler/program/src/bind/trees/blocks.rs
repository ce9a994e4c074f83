//! What a block states about itself.

use plcc_abi::names::External;
use plcc_abi::ob::{OB_CLASSES, ObClass, START_VALUES, same_start_value};
use plcc_syntax::ast::{self, BlockName, CodeKind, SectionKind};
use plcc_syntax::chart::ast as chart;
use plcc_syntax::scl::ast::{self as scl, Dialect};

/// Attributes that state whether a block has optimised access: in sources, in SD documents.
const OPTIMIZED_ATTRIBUTES: [&str; 2] = ["S7_Optimized_Access", "S7_Optimized"];

/// The block has optimised access by its attributes.
pub fn is_optimized(header: &ast::Header) -> bool {
    access(header).any(|value| value.trim().trim_matches(['\'', '"']).eq_ignore_ascii_case("TRUE"))
}

/// Whether the attributes of a block say if its access is optimised.
pub fn states_access(header: &ast::Header) -> bool {
    access(header).next().is_some()
}

/// What the attributes of a block say about its access.
fn access(header: &ast::Header) -> impl Iterator<Item = &String> {
    let is_access = |name: &str| OPTIMIZED_ATTRIBUTES.iter().any(|known| known.eq_ignore_ascii_case(name));
    header.attributes.iter().filter(move |(name, _)| is_access(name)).map(|(_, value)| value)
}

/// Whether an attribute says FALSE.
fn is_denied(attributes: &[(String, String)], name: &str) -> bool {
    attributes.iter().any(|(known, value)| {
        known.eq_ignore_ascii_case(name) && value.trim().trim_matches(['\'', '"']).eq_ignore_ascii_case("FALSE")
    })
}

/// What clients may do with a variable. Whether a panel lists it (ExternalVisible) does not concern the CPU.
pub fn external(variable: &ast::Variable) -> External {
    match () {
        () if is_denied(&variable.attributes, "ExternalAccessible") => External::Hidden,
        () if is_denied(&variable.attributes, "ExternalWritable") => External::Read,
        () if is_only_read(&variable.attributes) => External::Read,
        () => External::Write,
    }
}

/// Whether a declaration in SIMATIC SD says that clients may only read: `S7_Access := "ReadOnly := External"`.
///
/// Source: LAD/FBD reference A.4.
fn is_only_read(attributes: &[(String, String)]) -> bool {
    attributes.iter().filter(|(name, _)| name.eq_ignore_ascii_case("S7_Access")).any(|(_, value)| {
        let letters: String = value.chars().filter(|letter| !letter.is_whitespace()).collect();
        letters.trim_matches(['\'', '"']).eq_ignore_ascii_case("ReadOnly:=External")
    })
}

/// Whether clients of OPC UA may not reach a data block.
pub fn is_hidden(header: &ast::Header) -> bool {
    is_denied(&header.attributes, "DB_Accessible_From_OPC_UA")
}

/// Whether a data block of the TIA Portal with standard access is retentive: SIMATIC SD says so, and sources say NON_RETAIN if it is not.
pub fn keeps_standard_data(header: &ast::Header) -> bool {
    let value = |name: &str| {
        let found = header.attributes.iter().find(|(known, _)| known.eq_ignore_ascii_case(name));
        found.map(|(_, value)| value.trim().trim_matches(['\'', '"']).to_ascii_uppercase())
    };
    match value("S7_StandardRetain") {
        Some(retain) => retain == "TRUE",
        None => value("S7_Optimized_Access").is_some_and(|optimized| optimized == "FALSE"),
    }
}

/// Whether a block is a list of statements without a header, which is OB 1 unless its file is named otherwise.
pub fn is_fragment(block: &ast::CodeBlock) -> bool {
    let span = block.name.span();
    matches!(block.name, BlockName::Numbered { .. })
        && span.start == span.end
        && matches!(block.code, ast::Code::Stl(_))
}

/// The form of SCL that a block has; none for other languages.
pub fn dialect(block: &ast::CodeBlock) -> Option<Dialect> {
    match &block.code {
        ast::Code::Scl(body) => Some(body.dialect),
        // Files that contain networks are those of the TIA Portal, and of later tools.
        ast::Code::Graphic(_) => Some(Dialect::Tia),
        ast::Code::Chart(body) => Some(match body.dialect {
            chart::Dialect::Classic => Dialect::Classic,
            chart::Dialect::Tia | chart::Dialect::Sfc => Dialect::Tia,
        }),
        ast::Code::Stl(_) => None,
    }
}

pub fn header_of(block: &ast::Block) -> &ast::Header {
    match block {
        ast::Block::Code(code) => &code.header,
        ast::Block::Data(data) => &data.header,
        ast::Block::Type(ty) => &ty.header,
    }
}

/// Attributes with the language of a block in exports and SD documents.
const LANGUAGE_ATTRIBUTES: [&str; 3] = ["ProgrammingLanguage", "S7_PreferredLanguage", "S7_Language"];

/// The language is one for safety programs: F_LAD, F_FBD, F_DB.
pub fn is_safety(header: &ast::Header) -> bool {
    header.attributes.iter().any(|(name, value)| {
        let value = value.trim().trim_matches(['\'', '"']);
        let language = LANGUAGE_ATTRIBUTES.iter().any(|known| known.eq_ignore_ascii_case(name));
        language && value.starts_with("F_")
            || name.eq_ignore_ascii_case("S7_Safety") && value.eq_ignore_ascii_case("TRUE")
    })
}

/// A code block without content: a declaration before its definition, as generators of sources write it.
pub fn is_forward(block: &ast::Block) -> bool {
    let ast::Block::Code(code) = block else { return false };
    match &code.code {
        ast::Code::Scl(body) => body.statements.iter().all(|statement| statement.kind == scl::StatementKind::Empty),
        ast::Code::Stl(networks) => networks
            .iter()
            .all(|network| network.statements.iter().all(|statement| statement.kind == ast::StatementKind::Empty)),
        ast::Code::Graphic(_) | ast::Code::Chart(_) => false,
    }
}

/// Attributes that state what starts an OB: in sources, in SimaticML.
const CLASS_ATTRIBUTES: [&str; 2] = ["S7_EventClass", "SecondaryType"];

/// What the attributes of a block state about its start; also the value, for messages.
pub fn class_attribute(header: &ast::Header) -> Option<(Option<ObClass>, &str)> {
    let is_class = |name: &str| CLASS_ATTRIBUTES.iter().any(|known| known.eq_ignore_ascii_case(name));
    let (_, value) = header.attributes.iter().find(|(name, _)| is_class(name))?;
    let value = value.trim().trim_matches(['\'', '"']);
    Some((ObClass::of_name(value), value))
}

/// What starts an OB, if its attributes state it.
pub fn block_class(block: &ast::Block) -> Option<ObClass> {
    match block {
        ast::Block::Code(code) if code.kind == CodeKind::Ob => class_attribute(&code.header)?.0,
        ast::Block::Code(_) | ast::Block::Data(_) | ast::Block::Type(_) => None,
    }
}

/// What starts an OB, if its inputs show it: only one class has all of them, as cyclic interrupts have `Event_Count`, or they are exactly the
/// inputs of one class.
pub fn class_of_inputs(block: &ast::Block) -> Option<ObClass> {
    let ast::Block::Code(code) = block else { return None };
    let sections = code.sections.iter().filter(|section| section.kind == SectionKind::Input);
    let inputs: Vec<&str> =
        sections.flat_map(|section| &section.variables).map(|variable| variable.name.as_str()).collect();
    let passed = |class: ObClass| START_VALUES.iter().filter(move |(of, ..)| *of == class);
    let is_passed = |class: ObClass, input: &str| passed(class).any(|(_, name, ..)| same_start_value(name, input));
    let classes = OB_CLASSES.iter().map(|row| row.class);
    let classes: Vec<ObClass> =
        classes.filter(|class| !inputs.is_empty() && inputs.iter().all(|input| is_passed(*class, input))).collect();
    if let [only] = classes[..] {
        return Some(only);
    }
    let mut exact = classes.into_iter().filter(|class| passed(*class).count() == inputs.len());
    let class = exact.next()?;
    exact.next().is_none().then_some(class)
}
