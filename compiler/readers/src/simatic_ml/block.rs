//! Blocks and data types: attributes, interface and networks.

use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_literal::distance;
use roxmltree::Node;

use super::reader::{Reader, multilingual, setting, setting_text};
use super::{chart, data_type, interface, network};
use crate::xml::{child, elements, head, text_of};
use plcc_syntax::ast::{
    self, Block, BlockName, Code as BlockCode, CodeBlock, CodeKind, DataBlock, DataContent, Header, TypeBlock,
    TypeKind, TypeRef,
};
use plcc_syntax::network::ast::{Body, Content, Network};
use plcc_syntax::scl;

/// Prefixes of the languages of safety programs: F_LAD, F_FBD, F_DB.
pub const SAFETY: &str = "F_";

/// Reads one object of the file; `None` if it has no name.
pub fn read(reader: &mut Reader, object: Node) -> Option<Block> {
    let Some(name) = name(reader, object) else {
        let span = reader.span(head(object));
        let message = Diagnostic::new(Code::ForeignContent, span, "an object without a name cannot be read");
        reader.diagnostics.push(message.label("`AttributeList` has no `Name`").help("export it again"));
        return None;
    };
    let span = reader.span(head(object));
    let shown = format!("`{}`", text_of_name(&name));
    settings(reader, object, &shown);
    let kind = object.tag_name().name().trim_start_matches("SW.Blocks.");
    Some(match kind {
        "OB" => Block::Code(code(reader, object, name, CodeKind::Ob, span)),
        "FC" => Block::Code(code(reader, object, name, CodeKind::Fc, span)),
        "FB" => Block::Code(code(reader, object, name, CodeKind::Fb, span)),
        "SW.Types.PlcStruct" => {
            let members = interface::components(reader, interface::sections(object), false, &shown);
            Block::Type(TypeBlock { name, header: header(object), members, alias: None, span })
        }
        "InstanceDB" => Block::Data(instance(reader, object, name, span)),
        "ArrayDB" => Block::Data(array(reader, object, name, span)),
        "GlobalDB" => {
            let members = interface::components(reader, interface::sections(object), false, &shown);
            let content = if members.is_empty() { DataContent::Empty } else { DataContent::Struct(members) };
            let retained = interface::retained(object);
            let mut header = header(object);
            let layout = setting_text(object, "MemoryLayout");
            let is_standard = layout.is_some_and(|layout| layout.eq_ignore_ascii_case("Standard"));
            if is_standard && interface::says_not_retained(object) {
                header.attributes.push(("S7_StandardRetain".to_string(), "FALSE".to_string()));
            }
            Block::Data(DataBlock { name, header, content, values: Vec::new(), retained, span })
        }
        other => {
            let message =
                Diagnostic::new(Code::ForeignContent, span, format!("{shown} is a block of the kind `{other}`"));
            let help = "export the blocks that use it without it, or write it as an FC, FB or data block";
            reader.diagnostics.push(message.label("plcc does not read blocks of this kind").help(help));
            return None;
        }
    })
}

/// Settings of blocks that have no effect on the program, or that are read.
#[rustfmt::skip]
pub const SETTINGS: &[&str] = &[
    "AcknowledgeErrorsRequired", "ArrayDataType", "ArrayLimitUpperBound", "AssignedProDiagFB", "AutoNumber", "CodeModifiedDate",
    "CompileDate", "ConstantName", "CreateMinimizedDB", "CreationDate", "DBAccessibleFromOPCUA", "DBAccessibleFromWebserver",
    "DownloadWithoutReinit", "ExtensionBlockName", "ExtensionBlocks", "GraphVersion", "HandleErrorsWithinBlock", "HeaderAuthor",
    "HeaderFamily", "HeaderName", "HeaderVersion", "InstanceOfName", "InstanceOfNumber", "InitialValuesAcquisition", "InstanceOfType", "Interface",
    "InterfaceModifiedDate", "IsConsistent", "IsFailsafeCompliant", "IsIECCheckEnabled", "IsKnowHowProtected",
    "ISMultiInstanceCapable", "IsOnlyStoredInLoadMemory", "IsPLCDB", "IsRetainMemResEnabled", "IsWriteProtected", "IsWriteProtectedInAS",
    "LanguageInNetworks", "LibraryConformanceStatus", "LockOperatingMode", "MemoryLayout", "MemoryReserve", "ModifiedDate",
    "Name", "NetworkBridge", "Number", "OfSystemLibElement", "OfSystemLibVersion", "ParameterModified", "ParameterPassing",
    "PermanentILProcessingInMANMode", "PLCSimAdvancedSupport", "ProgrammingLanguage", "RetainMemoryReserve", "SecondaryType",
    "SetENOAutomatically", "SkipSteps", "StructureModified", "Supervisions", "UDABlockProperties", "UDAEnableTagReadback",
    "WithAlarmHandling",
];

/// Values of `MemoryLayout`.
const LAYOUTS: [&str; 2] = ["Optimized", "Standard"];

/// Reports unknown settings of a block, and unknown objects below it.
fn settings(reader: &mut Reader, object: Node, shown: &str) {
    let list = child(object, "AttributeList");
    let told = |name: &str| !SETTINGS.contains(&name) && !name.ends_with("Date") && !name.ends_with("Modified");
    // A setting without a value is not reported.
    let is_set = |node: &Node| {
        let text = text_of(*node);
        elements(*node).next().is_some() || !matches!(text.as_str(), "" | "false" | "0")
    };
    let unknown: Vec<Node> = list.into_iter().flat_map(elements).filter(|node| told(node.tag_name().name())).collect();
    for node in unknown.into_iter().filter(is_set) {
        let name = node.tag_name().name();
        let title = format!("plcc does not read the setting `{name}` of {shown}");
        let help = "set priorities and times of organization blocks in plc.toml; other settings need no action";
        warn(reader, node, title, "plcc does not know it", help);
    }
    let settings: Vec<Node> = list.into_iter().flat_map(elements).collect();
    for (at, node) in settings.iter().enumerate() {
        let name = node.tag_name().name();
        if let Some(first) = settings[..at].iter().find(|first| first.tag_name().name() == name) {
            let span = reader.span(head(*node));
            let message =
                Diagnostic::new(Code::ForeignContent, span, format!("{shown} has the setting `{name}` twice"));
            let message = message.label("the second one is not read").also(reader.span(head(*first)), "the first one");
            reader.diagnostics.push(message.help("remove one of them"));
        }
    }
    for node in child(object, "ObjectList").into_iter().flat_map(elements) {
        let name = node.tag_name().name();
        if !matches!(name, "SW.Blocks.CompileUnit" | "MultilingualText") {
            warn(
                reader,
                node,
                format!("plcc skips `{name}` of {shown}"),
                "not a network",
                "no action is needed, unless the program depends on it",
            );
        }
    }
    if let Some(node) = setting(object, "MemoryLayout")
        && !text_of(node).is_empty()
        && !LAYOUTS.iter().any(|known| known.eq_ignore_ascii_case(&text_of(node)))
    {
        let text = text_of(node);
        let span = place(reader, node, &text);
        let help = match distance::nearest(&text, LAYOUTS.into_iter()) {
            Some(meant) => format!("is `{meant}` meant?"),
            None => "write `Optimized` or `Standard`".to_string(),
        };
        let message = Diagnostic::new(Code::ForeignContent, span, format!("`{text}` is not a memory layout"));
        reader.diagnostics.push(message.label(format!("of {shown}")).help(help));
    }
    if let Some(node) = setting(object, "Number")
        && text_of(node).parse::<u32>().is_err()
        && !text_of(node).is_empty()
    {
        let span = place(reader, node, &text_of(node));
        let title = format!("`{}` is not the number of a block", text_of(node));
        let message = Diagnostic::new(Code::ForeignContent, span, title).label(format!("the number of {shown}"));
        reader.diagnostics.push(message.help("write a number from 1 to 65535, or export the block again"));
    }
}

fn warn(reader: &mut Reader, node: Node, title: String, label: &str, help: &str) {
    let mut message = Diagnostic::new(Code::ForeignContent, reader.span(head(node)), title).label(label).help(help);
    message.severity = Severity::Warning;
    reader.diagnostics.push(message);
}

/// The name of an object; its span is its position.
fn name(reader: &mut Reader, object: Node) -> Option<BlockName> {
    let node = setting(object, "Name")?;
    let name = text_of(node);
    let span = place(reader, node, &name);
    (!name.is_empty()).then_some(BlockName::Symbol { name, span })
}

fn text_of_name(name: &BlockName) -> String {
    match name {
        BlockName::Symbol { name, .. } => name.clone(),
        BlockName::Numbered { number, .. } => number.to_string(),
    }
}

/// Writes a text over the text of a node.
fn place(reader: &mut Reader, node: Node, text: &str) -> Span {
    let range = node.first_child().map_or_else(|| head(node), |text| text.range());
    let placed = reader.overlay.place(text, range.start, node.range());
    reader.span(placed.unwrap_or(range))
}

fn header(object: Node) -> Header {
    let text = |name| setting_text(object, name);
    let is = |name| text(name).is_some_and(|value| value == "true");
    let mut attributes = Vec::new();
    if let Some(layout) = text("MemoryLayout") {
        let optimized = if layout.eq_ignore_ascii_case("Optimized") { "TRUE" } else { "FALSE" };
        attributes.push(("S7_Optimized_Access".to_string(), optimized.to_string()));
    }
    let is_hidden = text("DBAccessibleFromOPCUA").is_some_and(|value| value == "false");
    attributes.extend(is_hidden.then(|| ("DB_Accessible_From_OPC_UA".to_string(), "FALSE".to_string())));
    attributes.extend(text("SecondaryType").map(|ty| ("SecondaryType".to_string(), ty)));
    let language = text("ProgrammingLanguage").filter(|language| language.starts_with(SAFETY));
    attributes.extend(language.map(|language| ("ProgrammingLanguage".to_string(), language)));
    let sets_eno = text("SetENOAutomatically").filter(|value| value == "true");
    attributes.extend(sets_eno.map(|_| ("S7_SetENOAutomatically".to_string(), "TRUE".to_string())));
    if is("IsIECCheckEnabled") {
        attributes.push(("S7_IECCheck".to_string(), "TRUE".to_string()));
    }
    // What a source says of the data of an instruction.
    if let (Some(name), Some(version)) = (text("OfSystemLibElement"), text("OfSystemLibVersion")) {
        attributes.push(("InstructionName".to_string(), name));
        attributes.push(("LibVersion".to_string(), version));
    }
    let comment = multilingual(object, "Comment").map(|text| text.lines().map(str::to_string).collect());
    Header {
        title: multilingual(object, "Title"),
        comment: comment.unwrap_or_default(),
        attributes,
        author: text("HeaderAuthor"),
        family: text("HeaderFamily"),
        name: text("HeaderName"),
        number: text("Number").and_then(|number| number.parse().ok()).filter(|number| *number > 0),
        auto_number: is("AutoNumber"),
        version: text("HeaderVersion"),
        know_how_protect: is("IsKnowHowProtected"),
        unlinked: is("IsOnlyStoredInLoadMemory"),
        read_only: is("IsWriteProtectedInAS"),
        ..Header::default()
    }
}

fn code(reader: &mut Reader, object: Node, name: BlockName, kind: CodeKind, span: Span) -> CodeBlock {
    let header = header(object);
    let language = network::named_language(reader, object).unwrap_or_default();
    let is_chart = language == "GRAPH" && kind == CodeKind::Fb;
    let shown = text_of_name(&name);
    let interface = interface::read(reader, interface::sections(object), is_chart, &format!("`{shown}`"));
    let code = match refused(&header, &language, is_chart) {
        Some((code, what, help)) => {
            let message = Diagnostic::new(code, name.span(), format!("`{shown}` {what}"));
            reader.diagnostics.push(message.label("plcc reads only its interface").help(help));
            BlockCode::Graphic(Body::default())
        }
        None if is_chart => BlockCode::Chart(chart::read(reader, object, &shown)),
        None => {
            let units = network::compile_units(object);
            let networks = units.into_iter().enumerate();
            let networks = networks.map(|(at, unit)| network::read(reader, unit, at + 1, &shown, &language)).collect();
            settle(networks, &language)
        }
    };
    let interface::Interface { sections, constants, return_type } = interface;
    CodeBlock { kind, name, return_type, header, sections, constants, code, span }
}

/// Why the code of a block cannot be read, and what to do.
fn refused(header: &Header, language: &str, is_chart: bool) -> Option<(Code, String, &'static str)> {
    match language {
        _ if header.know_how_protect => Some((
            Code::ForeignContent,
            "is know-how protected: the file does not contain its code".to_string(),
            "remove the protection in the TIA Portal and export it again",
        )),
        "GRAPH" if is_chart => None,
        "GRAPH" => Some((
            Code::ForeignContent,
            "is written in GRAPH, but only function blocks can be written in GRAPH".to_string(),
            "write the block in LAD, FBD, STL or SCL",
        )),
        // Supervision reports what it finds; the program goes on as without it.
        "ProDiag" | "ProDiag_OB" => Some((
            Code::NotRead,
            format!("is written in {language}, which only supervises: it is left out"),
            "its supervisions report nothing; test their conditions with assertions or a scenario",
        )),
        "SFC" | "CEM" => Some((
            Code::ForeignContent,
            format!("is written in {language}, which plcc does not read"),
            "write the block in LAD, FBD, STL or SCL",
        )),
        _ => None,
    }
}

/// The code of a block: if all networks are in one textual language, the code is in that language.
fn settle(networks: Vec<Network>, language: &str) -> BlockCode {
    let all = |wanted: fn(&Content) -> bool| networks.iter().all(|network| wanted(&network.content));
    let textual = !networks.is_empty();
    if all(|content| matches!(content, Content::Scl(_))) && (textual || language == "SCL") {
        let mut statements = Vec::new();
        for network in networks {
            if let Content::Scl(own) = network.content {
                statements.extend(own);
            }
        }
        return BlockCode::Scl(scl::ast::Body { dialect: scl::ast::Dialect::Tia, labels: Vec::new(), statements });
    }
    if all(|content| matches!(content, Content::Stl(_))) && (textual || language == "STL") {
        let networks = networks.into_iter().filter_map(|network| match network.content {
            Content::Stl(statements) => {
                Some(ast::Network { title: network.title, comment: network.comment, statements })
            }
            _ => None,
        });
        return BlockCode::Stl(networks.collect());
    }
    BlockCode::Graphic(Body { networks })
}

/// The type that an attribute of an object names.
fn named_type(reader: &mut Reader, object: Node, name: &str, quoted: bool) -> Option<TypeRef> {
    let node = setting(object, name)?;
    let text = text_of(node).trim_matches('"').to_string();
    let span = place(reader, node, &text);
    let kind = match quoted {
        true => TypeKind::Block(BlockName::Symbol { name: text.clone(), span }),
        false => TypeKind::Named(text.to_uppercase()),
    };
    (!text.is_empty()).then_some(TypeRef { kind, span })
}

/// An instance data block: of an FB, of a data type, or of a block of the system.
fn instance(reader: &mut Reader, object: Node, name: BlockName, span: Span) -> DataBlock {
    let ty = setting_text(object, "InstanceOfType").unwrap_or_default();
    let system = setting_text(object, "OfSystemLibElement").is_some();
    let own = !system && matches!(ty.as_str(), "" | "FB" | "UDT");
    let of = named_type(reader, object, "InstanceOfName", own)
        .or_else(|| named_type(reader, object, "OfSystemLibElement", false));
    let members =
        interface::components(reader, interface::sections(object), true, &format!("`{}`", text_of_name(&name)));
    let values = super::initial::assignments(&members);
    let content = match of {
        Some(of) => DataContent::OfType(of),
        None if members.is_empty() => DataContent::Empty,
        None => DataContent::Struct(members),
    };
    DataBlock { name, header: header(object), content, values, retained: interface::retained(object), span }
}

/// A data block that is one array.
fn array(reader: &mut Reader, object: Node, name: BlockName, span: Span) -> DataBlock {
    let element = setting(object, "ArrayDataType");
    let limit = setting_text(object, "ArrayLimitUpperBound").and_then(|limit| limit.parse::<i64>().ok());
    let content = match (element, limit) {
        (Some(element), Some(limit)) => {
            let text = text_of(element);
            let span = place(reader, element, &text);
            let element = Box::new(data_type::read(reader, span.range()));
            let bounds = vec![(ast::Bound::Number(0, span), ast::Bound::Number(limit, span))];
            DataContent::Array(TypeRef { kind: TypeKind::Array { bounds, element }, span }, None)
        }
        _ => {
            let members = interface::components(
                reader,
                interface::sections(object),
                false,
                &format!("`{}`", text_of_name(&name)),
            );
            if members.is_empty() { DataContent::Empty } else { DataContent::Struct(members) }
        }
    };
    DataBlock { name, header: header(object), content, values: Vec::new(), retained: interface::retained(object), span }
}
