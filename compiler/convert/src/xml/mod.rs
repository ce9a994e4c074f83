//! SimaticML: the XML of the TIA Portal (Openness).
//!
//! - `interface`: declarations with their start values.
//! - `access`: operands.
//! - `flgnet`, `wires`: networks of LAD and FBD; `order`: the order in which a reader finds their elements.
//! - `scl`, `stl`: statements as tokens.
//! - `chart`: charts of GRAPH.
//! - `system`: components of timers and counters.
//!
//! Source: LAD/FBD reference A2.

mod access;
mod chart;
mod flgnet;
mod interface;
mod order;
mod scl;
mod stl;
mod system;
mod wires;

pub(crate) use interface::cased;

use std::collections::HashMap;

use plcc_diag::Diagnostic;
use plcc_stdlib::BlockClass;
use plcc_syntax::ast::{
    Block, BlockName, BlockPrefix, Bound, Code, CodeBlock, CodeKind, DataBlock, DataContent, Header, Section,
    SourceUnit, TypeBlock, TypeKind, TypeRef, Variable,
};
use plcc_syntax::network::ast::{Content, Language, Network};
use plcc_syntax::scl::ast::Dialect;
use plcc_syntax::stl::Mnemonics;
use plcc_syntax::symbols::{SymbolTable, SymbolTarget, parse_address};

use crate::frames::bare;
use crate::node::{self, Node};
use crate::trivia::{Remark, Trivia};
use crate::writer::{Notation, Writer};

/// What the sources of a program declare: blocks for calls, structures for start values.
#[derive(Default)]
pub struct Library {
    /// Declarations of function blocks and functions, by folded names.
    blocks: HashMap<String, (CodeKind, Vec<Section>, Option<TypeRef>)>,
    /// Members of data types and function blocks, also of timers and counters of the system.
    members: HashMap<String, Vec<Variable>>,
    /// Data types.
    types: Vec<String>,
    /// Data blocks.
    data: Vec<String>,
    /// Blocks of instance data blocks.
    instances: HashMap<String, BlockName>,
    /// Types of components of data blocks.
    data_types: Vec<TypeRef>,
    /// Names of numbered blocks, in the sources or the symbol tables.
    names: HashMap<(BlockPrefix, u32), String>,
    /// Members of blocks and data types of the system, by folded names.
    system: HashMap<String, Vec<Variable>>,
}

impl Library {
    pub fn new<'a>(units: impl Iterator<Item = &'a SourceUnit>) -> Library {
        let mut library = Library { members: system::members().collect(), ..Library::default() };
        for block in units.flat_map(|unit| &unit.blocks) {
            match block {
                Block::Code(block) => {
                    let members = block.sections.iter().flat_map(|section| section.variables.clone()).collect();
                    let name = folded(&block.name);
                    library.members.insert(name.clone(), members);
                    library.blocks.insert(name, (block.kind, block.sections.clone(), block.return_type.clone()));
                    let prefix = match block.kind {
                        CodeKind::Ob => BlockPrefix::Ob,
                        CodeKind::Fc => BlockPrefix::Fc,
                        CodeKind::Fb => BlockPrefix::Fb,
                        CodeKind::Sfc => BlockPrefix::Sfc,
                        CodeKind::Sfb => BlockPrefix::Sfb,
                    };
                    if let BlockName::Symbol { name, .. } = &block.name
                        && let Some(number) = number_in(&block.header).or_else(|| number_of(name, prefix))
                    {
                        library.names.insert((prefix, number), name.clone());
                    }
                }
                Block::Type(block) => {
                    library.types.push(folded(&block.name));
                    library.members.insert(folded(&block.name), block.members.clone());
                }
                Block::Data(block) => {
                    library.data.push(folded(&block.name));
                    match &block.content {
                        DataContent::OfType(ty) => {
                            if let TypeKind::Block(of) = &ty.kind {
                                library.instances.insert(folded(&block.name), of.clone());
                            }
                            library.data_types.push(ty.clone());
                        }
                        DataContent::Struct(members) => {
                            library.data_types.extend(members.iter().map(|member| member.ty.clone()));
                        }
                        DataContent::Array(ty, _) => library.data_types.push(ty.clone()),
                        DataContent::Empty => {}
                    }
                }
            }
        }
        library
    }

    /// Adds the names that symbol tables give to numbered blocks.
    pub fn add_symbols(&mut self, tables: &[SymbolTable]) {
        for symbol in tables.iter().flat_map(|table| &table.symbols) {
            if let SymbolTarget::Block { prefix, number } = symbol.target {
                self.names.entry((prefix, number)).or_insert_with(|| symbol.name.clone());
            }
        }
    }

    /// Adds the members of the blocks and data types of the system that the sources name. `find`: those of one.
    pub fn add_system(&mut self, find: impl Fn(&str) -> Option<Vec<Variable>>) {
        let mut open = Vec::new();
        for variable in self.members.values().flatten() {
            self.mentioned(&variable.ty, &mut open);
        }
        for ty in &self.data_types {
            self.mentioned(ty, &mut open);
        }
        while let Some(name) = open.pop() {
            if self.members.contains_key(&name) || self.system.contains_key(&name) {
                continue;
            }
            if let Some(members) = find(&name) {
                for member in &members {
                    self.mentioned(&member.ty, &mut open);
                }
                self.system.insert(name, members);
            }
        }
    }

    /// The folded names of the types that a type consists of.
    fn mentioned(&self, ty: &TypeRef, found: &mut Vec<String>) {
        match &ty.kind {
            TypeKind::Named(name) => found.push(name.to_lowercase()),
            TypeKind::Block(name) => found.push(self.block_name(name).to_lowercase()),
            TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. } => self.mentioned(element, found),
            TypeKind::Struct(members) => {
                for member in members {
                    self.mentioned(&member.ty, found);
                }
            }
            TypeKind::String(_) | TypeKind::WideString(_) | TypeKind::Reference(_) | TypeKind::Error => {}
        }
    }

    /// The members of a data type or block.
    fn members<'s>(&'s self, ty: &'s TypeRef) -> Option<&'s [Variable]> {
        let name = match &ty.kind {
            TypeKind::Block(name) => self.block_name(name).to_lowercase(),
            TypeKind::Named(name) => name.to_lowercase(),
            TypeKind::Struct(members) => return Some(members),
            _ => return None,
        };
        self.members.get(&name).or_else(|| self.system.get(&name)).map(Vec::as_slice)
    }

    /// The block of an instance data block.
    fn instance(&self, name: &str) -> Option<String> {
        self.instances.get(&name.to_lowercase()).map(|of| self.block_name(of))
    }

    /// The name of a block in the file.
    fn block_name(&self, name: &BlockName) -> String {
        self.standard_name(name).map_or_else(|| name_of(name), str::to_string)
    }

    /// The name of a numbered block of the CPU or of a library, `TON` of SFB 4; `None`: the program may have another one.
    fn standard_name(&self, name: &BlockName) -> Option<&'static str> {
        let BlockName::Numbered { prefix, number, .. } = name else { return None };
        let class = match prefix {
            BlockPrefix::Fc => BlockClass::Fc,
            BlockPrefix::Fb => BlockClass::Fb,
            BlockPrefix::Sfc => BlockClass::Sfc,
            BlockPrefix::Sfb => BlockClass::Sfb,
            BlockPrefix::Ob | BlockPrefix::Db | BlockPrefix::Di | BlockPrefix::Udt | BlockPrefix::Vat => return None,
        };
        let block = plcc_stdlib::find(class, u16::try_from(*number).ok()?)?;
        if block.is_tia() || self.members.contains_key(&folded(name)) {
            return None;
        }
        // Blocks of the CPU cannot be replaced.
        let is_of_cpu = matches!(class, BlockClass::Sfc | BlockClass::Sfb);
        let is_same = |own: &String| plcc_stdlib::standard_name(own).eq_ignore_ascii_case(block.name);
        (is_of_cpu || self.names.get(&(*prefix, *number)).is_none_or(is_same)).then_some(block.name)
    }
}

fn folded(name: &BlockName) -> String {
    name_of(name).to_lowercase()
}

/// The name of a block; one with only a number gets a name of it.
pub(super) fn name_of(name: &BlockName) -> String {
    match name {
        BlockName::Symbol { name, .. } => name.clone(),
        BlockName::Numbered { prefix, number, .. } => format!("{}_{number}", prefix.letters()),
    }
}

/// The name of a block that is called or named as a type. One that only a number names must be in the sources, which give it its name.
pub(super) fn referred(name: &BlockName, library: &Library, writer: &mut Writer) -> String {
    if let Some(standard) = library.standard_name(name) {
        return standard.to_string();
    }
    let found = name_of(name);
    if let BlockName::Numbered { span, .. } = name
        && !library.members.contains_key(&found.to_lowercase())
        && !library.data.contains(&found.to_lowercase())
    {
        let title = format!("{} has no name, and SimaticML names blocks", writer.block_name(name));
        writer.refuse(*span, title, "give the source of the block, too, or name it by its symbol");
    }
    found
}

/// The text of a comment. Only `//@` is an assertion; another comment that begins with `@` keeps its brackets.
pub(super) fn comment_text(comment: &str) -> String {
    let text = bare(comment);
    if text.starts_with('@') && !comment.starts_with("//@") { format!("* {comment}") } else { text }
}

/// Numbers of the elements of a network.
pub(super) struct Uids(u32);

impl Uids {
    fn new() -> Uids {
        Uids(20)
    }

    fn next(&mut self) -> u32 {
        self.0 += 1;
        self.0
    }
}

/// Writes a document. `source`: the text that spans mean, if its constants are those of SCL.
pub fn write(
    unit: &SourceUnit,
    library: &Library,
    mut trivia: Trivia,
    source: Option<&str>,
) -> (String, Vec<Diagnostic>) {
    // Those of a document are in its tree.
    let mut pragmas: Vec<String> = unit.pragmas.iter().map(|one| one.text.trim().to_string()).collect();
    for text in trivia.take_pragmas_of_file() {
        if !pragmas.contains(&text) {
            pragmas.push(text);
        }
    }
    let mut writer = Writer::new(Notation::Scl, Mnemonics::En, trivia, source);
    let mut root = Node::new("Document").child(Node::new("Engineering").with("version", "V17"));
    let mut ids = Ids(0);
    for block in &unit.blocks {
        let before = writer.lines_before(block.span().start);
        let object = match block {
            Block::Code(block) => code(block, before, library, &mut ids, &mut writer),
            Block::Data(block) => data(block, before, library, &mut ids, &mut writer),
            Block::Type(block) => data_type(block, before, library, &mut ids, &mut writer),
        };
        root.children.extend(object);
    }
    (node::with_pragmas(&node::document(&root), &pragmas), writer.messages)
}

/// Numbers of objects.
struct Ids(u32);

impl Ids {
    fn next(&mut self) -> String {
        self.0 += 1;
        format!("{:X}", self.0 - 1)
    }
}

impl Writer<'_> {
    /// The comments of a header, which ends where one of the words begins that open declarations. What the header holds as its comment is
    /// not among them, and not met again.
    fn header_lines(&mut self, header: &Header, from: u32, words: &[&str], first: u32) -> Vec<String> {
        self.written.clone_from(&header.comment);
        let opening = words.iter().find_map(|word| self.trivia.word(word, from, first));
        let mut lines = opening.map_or_else(Vec::new, |at| self.lines_before(at));
        lines.retain(|line| !self.is_written(line));
        lines
    }

    /// The comments before byte `at`, without their brackets.
    pub(crate) fn lines_before(&mut self, at: u32) -> Vec<String> {
        let remarks = self.trivia.before(at);
        remarks.iter().flat_map(|remark| remark.text.lines().map(bare).collect::<Vec<_>>()).collect()
    }
}

// Objects.

/// A setting of an object.
fn set(list: &mut Node, name: &'static str, value: impl Into<String>) {
    list.push(Node::of(name, value));
}

/// A text of a header by one of the names that sources have for it.
fn attribute<'h>(header: &'h Header, names: &[&str]) -> Option<&'h str> {
    let named = |(key, _): &&(String, String)| names.iter().any(|name| name.eq_ignore_ascii_case(key));
    header.attributes.iter().find(named).map(|(_, value)| value.as_str())
}

/// The number that a header says.
fn number_in(header: &Header) -> Option<u32> {
    header.number.or_else(|| attribute(header, &["S7_BlockNumber"]).and_then(|number| number.trim().parse().ok()))
}

/// The number in a name such as `FC10`.
fn number_of(name: &str, prefix: BlockPrefix) -> Option<u32> {
    match parse_address(name)? {
        SymbolTarget::Block { prefix: named, number } if named == prefix => Some(number),
        SymbolTarget::Block { .. } | SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. } => None,
    }
}

/// The attributes that all objects have.
fn attributes(name: &BlockName, header: &Header, interface: Option<Node>, language: &str) -> Node {
    let mut list = Node::new("AttributeList");
    let number = match name {
        BlockName::Numbered { number, .. } => Some(*number),
        BlockName::Symbol { .. } => number_in(header),
    };
    set(&mut list, "AutoNumber", if number.is_none() || header.auto_number { "true" } else { "false" });
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
    for (key, is_set) in [("IsOnlyStoredInLoadMemory", header.unlinked), ("IsWriteProtectedInAS", header.read_only)] {
        if is_set {
            set(&mut list, key, "true");
        }
    }
    let safety = attribute(header, &["ProgrammingLanguage", "S7_PreferredLanguage", "S7_Language"]);
    let safety = safety.filter(|language| language.starts_with("F_"));
    if let Some(optimized) = attribute(header, &["S7_Optimized_Access", "S7_Optimized"]) {
        set(&mut list, "MemoryLayout", if optimized.eq_ignore_ascii_case("TRUE") { "Optimized" } else { "Standard" });
    }
    set(&mut list, "Name", name_of(name));
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

/// Reports what a header says and the file does not.
fn check_header(name: &BlockName, header: &Header, writer: &mut Writer) {
    const KNOWN: [&str; 11] = [
        "S7_SetENOAutomatically",
        "SetENOAutomatically",
        "S7_Optimized_Access",
        "S7_Optimized",
        "S7_BlockNumber",
        "S7_Version",
        "S7_PreferredLanguage",
        "S7_PreferredLang",
        "ProgrammingLanguage",
        "SecondaryType",
        "S7_EventClass",
    ];
    for (key, _) in &header.attributes {
        if !KNOWN.iter().any(|known| known.eq_ignore_ascii_case(key)) {
            let title = format!("the attribute `{key}` of `{}` is not in the file", name_of(name));
            writer.warn(name.span(), title, "set it in the editor again");
        }
    }
    if header.know_how_protect {
        let title = "the protection of the block is not in the file";
        writer.warn(name.span(), title, "protect the block again in the editor");
    }
}

/// A title or comment of an object.
fn multilingual(name: &str, text: &str, ids: &mut Ids) -> Node {
    let item = Node::new("MultilingualTextItem")
        .with("ID", ids.next())
        .with("CompositionName", "Items")
        .child(Node::new("AttributeList").child(Node::of("Culture", "en-US")).child(Node::of("Text", text)));
    Node::new("MultilingualText")
        .with("ID", ids.next())
        .with("CompositionName", name)
        .child(Node::new("ObjectList").child(item))
}

/// A title, name or comment of a part of a chart.
fn multilingual_lines(name: &'static str, lines: &[String]) -> Node {
    let node = Node::new(name);
    match lines.is_empty() {
        true => node,
        false => node.child(Node::of("MultiLanguageText", lines.join("\n")).with("Lang", "en-US")),
    }
}

/// The title and the comment of a block: `before` its own comment and `after` it there may be others.
fn texts(header: &Header, before: Vec<String>, after: Vec<String>, ids: &mut Ids) -> Vec<Node> {
    let comment: Vec<String> = before.into_iter().chain(header.comment.iter().cloned()).chain(after).collect();
    let mut found = vec![multilingual("Comment", &comment.join("\n"), ids)];
    if let Some(title) = &header.title {
        found.push(multilingual("Title", title, ids));
    }
    found
}

fn code(block: &CodeBlock, before: Vec<String>, library: &Library, ids: &mut Ids, writer: &mut Writer) -> Option<Node> {
    check_header(&block.name, &block.header, writer);
    writer.written.clone_from(&block.header.comment);
    let kind = match block.kind {
        CodeKind::Ob => "SW.Blocks.OB",
        CodeKind::Fc | CodeKind::Sfc => "SW.Blocks.FC",
        CodeKind::Fb | CodeKind::Sfb => "SW.Blocks.FB",
    };
    let interface = interface::of_code(block, library, writer);
    let mut units = Vec::new();
    let mut after: Vec<String> = Vec::new();
    let language = match &block.code {
        Code::Scl(body) if body.dialect == Dialect::Classic => {
            let title = format!(
                "`{}` is SCL of STEP 7 V5, which has other rules than that of the TIA Portal",
                name_of(&block.name)
            );
            writer.refuse(
                block.name.span(),
                title,
                "write it as SCL of the TIA Portal first: names with `#` and quotes",
            );
            return None;
        }
        Code::Scl(body) => {
            let source = scl::statements(&body.statements, block, library, block.span.end, writer);
            units.push(unit("SCL", Some(source), None, &[], ids));
            "SCL"
        }
        Code::Stl(networks) => {
            for (at, network) in networks.iter().enumerate() {
                writer.written.extend_from_slice(&network.comment);
                // Assertions at the end of the block are still among statements.
                let end = (at + 1 == networks.len()).then_some(block.span.end);
                let source = stl::statements(&network.statements, block, library, end, writer);
                units.push(unit("STL", Some(source), network.title.as_deref(), &network.comment, ids));
            }
            // A block with nothing but assertions has them in a network.
            let mut remarks = Vec::new();
            if networks.is_empty() {
                remarks = writer.trivia.before(block.span.end);
                remarks.retain(|remark| !writer.is_written(&remark.text));
            }
            if remarks.iter().any(|remark| remark.text.starts_with("//@")) {
                let source = stl::remarks(&remarks, block, library, writer);
                units.push(unit("STL", Some(source), None, &[], ids));
            } else {
                after.extend(remarks.iter().flat_map(|remark| remark.text.lines().map(bare)));
            }
            "STL"
        }
        Code::Graphic(body) => {
            for (at, network) in body.networks.iter().enumerate() {
                let end = body.networks.get(at + 1).map_or(block.span.end, |next| next.span.start);
                units.extend(network_units(network, block, library, end, ids, writer));
            }
            body.networks.first().map_or("LAD", |network| language_name(network.language))
        }
        Code::Chart(chart) => {
            units.push(chart::compile_unit(chart, block, library, ids, writer)?);
            "GRAPH"
        }
    };
    after.extend(writer.lines_before(block.span.end));
    let mut list = Node::new("ObjectList").children(units);
    list.children.extend(texts(&block.header, before, after, ids));
    let mut attributes = attributes(&block.name, &block.header, Some(interface), language);
    if let Code::Chart(chart) = &block.code {
        chart::settings(chart, &mut attributes, writer);
    }
    Some(Node::new(kind).with("ID", ids.next()).child(attributes).child(list))
}

fn language_name(language: Language) -> &'static str {
    match language {
        Language::Lad => "LAD",
        Language::Fbd => "FBD",
        Language::Scl => "SCL",
        Language::Stl => "STL",
    }
}

/// A network that ends at byte `end`, with the assertions before and after it.
fn network_units(
    network: &Network,
    block: &CodeBlock,
    library: &Library,
    end: u32,
    ids: &mut Ids,
    writer: &mut Writer,
) -> Vec<Node> {
    let mut comment = network.comment.clone();
    let mut units = Vec::from_iter(between_networks(network.span.start, &mut comment, ids, writer));
    let source = match &network.content {
        Content::Graphic(graph) if graph.elements.is_empty() && network.labels.is_empty() => None,
        Content::Graphic(graph) => flgnet::network(graph, network, block, library, writer),
        Content::Scl(list) => Some(scl::statements(list, block, library, end, writer)),
        Content::Stl(list) => Some(stl::statements(list, block, library, None, writer)),
    };
    // Networks have no place for comments between their elements.
    let after = between_networks(end, &mut comment, ids, writer);
    units.push(unit(language_name(network.language), source, network.title.as_deref(), &comment, ids));
    units.extend(after);
    units
}

/// The comments before byte `at` that are assertions, as a network: a reader finds them only among statements. The others become part of
/// the comment of a network.
fn between_networks(at: u32, comment: &mut Vec<String>, ids: &mut Ids, writer: &mut Writer) -> Option<Node> {
    let (assertions, remarks): (Vec<Remark>, Vec<Remark>) =
        writer.trivia.before(at).into_iter().partition(|remark| remark.text.starts_with("//@"));
    comment.extend(remarks.iter().flat_map(|remark| remark.text.lines().map(bare).collect::<Vec<_>>()));
    (!assertions.is_empty()).then(|| unit("SCL", Some(scl::remarks(&assertions)), None, &[], ids))
}

fn unit(language: &str, source: Option<Node>, title: Option<&str>, comment: &[String], ids: &mut Ids) -> Node {
    let list = Node::new("AttributeList")
        .child(Node::new("NetworkSource").children(source))
        .child(Node::of("ProgrammingLanguage", language));
    let mut texts = vec![multilingual("Comment", &comment.join("\n"), ids)];
    texts.push(multilingual("Title", title.unwrap_or_default(), ids));
    Node::new("SW.Blocks.CompileUnit")
        .with("ID", ids.next())
        .with("CompositionName", "CompileUnits")
        .child(list)
        .child(Node::new("ObjectList").children(texts))
}

fn data_type(
    block: &TypeBlock,
    mut before: Vec<String>,
    library: &Library,
    ids: &mut Ids,
    writer: &mut Writer,
) -> Option<Node> {
    if let Some(alias) = &block.alias {
        let title = format!("`{}` is no structure, and SimaticML has only these", name_of(&block.name));
        writer.refuse(alias.span, title, "write the type where it is used");
        return None;
    }
    let first = block.members.first().map_or(block.span.end, |member| member.name_span.start);
    before.extend(writer.header_lines(&block.header, block.name.span().end, &["STRUCT"], first));
    let interface = interface::of_members("None", &block.members, &[], library, writer);
    let after = writer.lines_before(block.span.end);
    check_header(&block.name, &block.header, writer);
    let mut list = attributes(&block.name, &block.header, Some(interface), "");
    list.children.retain(|child| !matches!(child.name, "AutoNumber" | "ProgrammingLanguage"));
    let texts = Node::new("ObjectList").children(texts(&block.header, before, after, ids));
    Some(Node::new("SW.Types.PlcStruct").with("ID", ids.next()).child(list).child(texts))
}

fn data(
    block: &DataBlock,
    mut before: Vec<String>,
    library: &Library,
    ids: &mut Ids,
    writer: &mut Writer,
) -> Option<Node> {
    check_header(&block.name, &block.header, writer);
    let first = match &block.content {
        DataContent::Struct(members) => members.first().map(|member| member.name_span.start),
        DataContent::OfType(_) | DataContent::Array(..) | DataContent::Empty => None,
    };
    let first = first.unwrap_or(block.span.end);
    before.extend(writer.header_lines(&block.header, block.name.span().end, &["STRUCT", "VAR", "BEGIN"], first));
    let (kind, interface, mut more) = match &block.content {
        DataContent::Struct(members) => {
            let all = || -> Vec<String> { members.iter().map(|member| member.name.clone()).collect() };
            let retained = if block.header.retain { all() } else { block.retained.clone() };
            let mut interface = interface::of_members("Static", members, &retained, library, writer);
            for value in &block.values {
                let section = interface.children.first_mut().and_then(|sections| sections.children.first_mut());
                let replaced =
                    section.is_some_and(|section| interface::replace_value(section, value, members, library, writer));
                if !replaced {
                    let help = "give the source of its data type, too, or write the value in its declaration";
                    writer.refuse(value.span, "SimaticML has no form for this value of a component", help);
                }
            }
            ("SW.Blocks.GlobalDB", interface, Vec::new())
        }
        DataContent::Empty => {
            ("SW.Blocks.GlobalDB", interface::of_members("Static", &[], &[], library, writer), Vec::new())
        }
        DataContent::OfType(ty) => {
            if block.header.retain {
                let title = format!("RETAIN of `{}` is not in the file", name_of(&block.name));
                let help = "declare the variables of its type as retentive, or set it in the editor again";
                writer.warn(block.name.span(), title, help);
            }
            let more = match &ty.kind {
                TypeKind::Block(of) if library.standard_name(of).is_none() => {
                    let is_type = library.types.contains(&folded(of));
                    let kind = if is_type { "UDT" } else { "FB" };
                    vec![Node::of("InstanceOfName", referred(of, library, writer)), Node::of("InstanceOfType", kind)]
                }
                _ => vec![Node::of("OfSystemLibElement", interface::type_text(ty, library, writer))],
            };
            ("SW.Blocks.InstanceDB", interface::of_values(&block.values, ty, library, writer), more)
        }
        DataContent::Array(ty, initial) => {
            let TypeKind::Array { bounds, element } = &ty.kind else { return None };
            let (&[(Bound::Number(0, _), Bound::Number(high, _))], None, true) =
                (&bounds[..], initial, block.values.is_empty())
            else {
                let title = "SimaticML has data blocks that are arrays only from 0 to a number, without values";
                writer.refuse(ty.span, title, "declare the array in a data block");
                return None;
            };
            let element = interface::type_text(element, library, writer);
            let more = vec![Node::of("ArrayDataType", element), Node::of("ArrayLimitUpperBound", high.to_string())];
            ("SW.Blocks.ArrayDB", interface::of_members("Static", &[], &[], library, writer), more)
        }
    };
    let after = writer.lines_before(block.span.end);
    let mut list = attributes(&block.name, &block.header, Some(interface), "DB");
    list.children.append(&mut more);
    let texts = Node::new("ObjectList").children(texts(&block.header, before, after, ids));
    Some(Node::new(kind).with("ID", ids.next()).child(list).child(texts))
}
