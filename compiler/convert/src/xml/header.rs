//! What the header of a block says, as the attributes of an object.

use plcc_syntax::ast::{BlockName, Header};

use super::library::{Library, name_of};
use crate::node::Node;
use crate::writer::Writer;

/// The attributes that all objects have.
pub(super) fn attributes(
    name: &BlockName,
    header: &Header,
    interface: Option<Node>,
    language: &str,
    library: &Library,
) -> Node {
    let mut list = Node::new("AttributeList");
    let number = match name {
        BlockName::Numbered { number, .. } => Some(*number),
        BlockName::Symbol { .. } => number_in(header),
    };
    set(&mut list, "AutoNumber", if number.is_none() || header.auto_number { "true" } else { "false" });
    if attribute(header, &["DB_Accessible_From_OPC_UA"]).is_some_and(|value| value.eq_ignore_ascii_case("FALSE")) {
        set(&mut list, "DBAccessibleFromOPCUA", "false");
    }
    for (key, value) in
        [("HeaderAuthor", &header.author), ("HeaderFamily", &header.family), ("HeaderName", &header.name)]
    {
        if let Some(value) = value {
            set(&mut list, key, value.as_str());
        }
    }
    if let Some(version) = &header.version {
        set(&mut list, "HeaderVersion", version.as_str());
    }
    list.children.extend(interface);
    let is_strict = attribute(header, &["S7_IECCheck"]).is_some_and(|value| value.eq_ignore_ascii_case("TRUE"));
    for (key, is_set) in [
        ("IsIECCheckEnabled", is_strict),
        ("IsOnlyStoredInLoadMemory", header.unlinked),
        ("IsWriteProtectedInAS", header.read_only),
    ] {
        if is_set {
            set(&mut list, key, "true");
        }
    }
    let safety = attribute(header, &["ProgrammingLanguage", "S7_PreferredLanguage", "S7_Language"]);
    let safety = safety.filter(|language| language.starts_with("F_"));
    if let Some(optimized) = attribute(header, &["S7_Optimized_Access", "S7_Optimized"]) {
        set(&mut list, "MemoryLayout", if optimized.eq_ignore_ascii_case("TRUE") { "Optimized" } else { "Standard" });
    }
    set(&mut list, "Name", library.own_name(name));
    if let Some(number) = number {
        set(&mut list, "Number", number.to_string());
    }
    set(&mut list, "ProgrammingLanguage", safety.unwrap_or(language));
    if let Some(ty) = attribute(header, &["SecondaryType", "S7_EventClass"]) {
        set(&mut list, "SecondaryType", ty);
    }
    if attribute(header, &["S7_SetENOAutomatically", "SetENOAutomatically"])
        .is_some_and(|value| value.eq_ignore_ascii_case("TRUE"))
    {
        set(&mut list, "SetENOAutomatically", "true");
    }
    list
}

/// Attributes of the data of an instruction.
const INSTRUCTION: [&str; 2] = ["InstructionName", "LibVersion"];

/// The instruction whose data a block has, as sources write it: `{ InstructionName := 'IEC_TIMER' }`.
pub(super) fn instruction(header: &Header) -> Option<&str> {
    let name = attribute(header, &["InstructionName"])?.trim().trim_matches(['\'', '"']).trim();
    Some(name).filter(|name| !name.is_empty())
}

/// The instruction whose data a block has, and its version, as settings of an object.
pub(super) fn of_instruction(name: &str, header: &Header) -> Vec<Node> {
    let version = attribute(header, &["LibVersion"]).map(|version| Node::of("OfSystemLibVersion", version.trim()));
    std::iter::once(Node::of("OfSystemLibElement", name)).chain(version).collect()
}

/// Reports what a header says and the file does not. `is_instruction`: the file says whose data the block has.
pub(super) fn check_header(name: &BlockName, header: &Header, is_instruction: bool, writer: &mut Writer) {
    const KNOWN: [&str; 14] = [
        "DB_Accessible_From_OPC_UA",
        "S7_IECCheck",
        "S7_SetENOAutomatically",
        "SetENOAutomatically",
        "S7_Optimized_Access",
        "S7_Optimized",
        "S7_StandardRetain",
        "S7_BlockNumber",
        "S7_Version",
        "S7_PreferredLanguage",
        "S7_PreferredLang",
        "ProgrammingLanguage",
        "SecondaryType",
        "S7_EventClass",
    ];
    for (key, _) in &header.attributes {
        let is = |known: &&str| known.eq_ignore_ascii_case(key);
        let is_written = KNOWN.iter().any(is) || is_instruction && INSTRUCTION.iter().any(is);
        if !is_written {
            let title = format!("the attribute `{key}` of `{}` is not in the file", name_of(name));
            writer.warn(name.span(), title, "set it in the editor again");
        }
    }
    let is_optimized = attribute(header, &["S7_Optimized_Access", "S7_Optimized"])
        .is_some_and(|optimized| optimized.eq_ignore_ascii_case("TRUE"));
    if header.non_retain && !is_optimized {
        let title = format!("the word `NON_RETAIN` of `{}` is not in the file", name_of(name));
        writer.warn(name.span(), title, "set the retentivity in the editor again");
    }
    if header.know_how_protect {
        let title = "the protection of the block is not in the file";
        writer.warn(name.span(), title, "protect the block again in the editor");
    }
}

/// What members of a data block with standard access say about retentivity, if its header says it for all of them: in SIMATIC SD such data are
/// retentive only if it does.
pub(super) fn standard_remanence(header: &Header) -> Option<&'static str> {
    let is_standard =
        |names: &[&str]| attribute(header, names).is_some_and(|value| value.eq_ignore_ascii_case("FALSE"));
    if header.retain || !is_standard(&["S7_Optimized_Access", "S7_Optimized"]) {
        return None;
    }
    match attribute(header, &["S7_StandardRetain"]) {
        _ if header.non_retain => Some("NonRetain"),
        Some(retain) if retain.eq_ignore_ascii_case("TRUE") => Some("Retain"),
        Some(_) => Some("NonRetain"),
        None => is_standard(&["S7_Optimized"]).then_some("NonRetain"),
    }
}

/// The number that a header says.
pub(super) fn number_in(header: &Header) -> Option<u32> {
    header.number.or_else(|| attribute(header, &["S7_BlockNumber"]).and_then(|number| number.trim().parse().ok()))
}

/// A text of a header by one of the names that sources have for it.
pub(super) fn attribute<'h>(header: &'h Header, names: &[&str]) -> Option<&'h str> {
    let named = |(key, _): &&(String, String)| names.iter().any(|name| name.eq_ignore_ascii_case(key));
    header.attributes.iter().find(named).map(|(_, value)| value.as_str())
}

/// A setting of an object.
pub(super) fn set(list: &mut Node, name: &'static str, value: impl Into<String>) {
    list.push(Node::of(name, value));
}
