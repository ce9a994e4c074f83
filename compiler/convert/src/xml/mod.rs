//! SimaticML: the XML of the TIA Portal (Openness).
//!
//! - `interface`: declarations with their start values; `elements`: those of arrays of structures.
//! - `access`: operands.
//! - `flgnet`, `wires`: networks of LAD and FBD; `order`: the order in which a reader finds their elements.
//! - `scl`, `stl`: statements as tokens.
//! - `chart`: charts of GRAPH.
//! - `library`: what the sources declare; `header`: the attributes of objects.
//! - `system`: components of timers and counters.
//!
//! Source: LAD/FBD reference A2.

mod access;
mod chart;
mod elements;
mod flgnet;
mod header;
mod interface;
mod library;
mod order;
mod scl;
mod stl;
pub(crate) mod system;
mod wires;

pub(crate) use interface::cased;
pub use library::Library;

use plcc_diag::Diagnostic;
use plcc_syntax::ast::{
    Block, Bound, Code, CodeBlock, CodeKind, DataBlock, DataContent, Header, SourceUnit, TypeBlock, TypeKind, TypeRef,
};
use plcc_syntax::network::ast::{Content, Language, Network};
use plcc_syntax::scl::ast::Dialect;
use plcc_syntax::stl::Mnemonics;

use crate::frames::bare;
use crate::node::{self, Node};
use crate::own_types::is_written_out;
use crate::trivia::{Remark, Trivia};
use crate::writer::{Notation, Writer};
use header::{attribute, attributes, check_header, of_instruction, standard_remanence};
use library::{name_of, referred};

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
    // A document has no place for comments after the last block but in it.
    let end = u32::try_from(writer.trivia.source().len()).unwrap_or(u32::MAX);
    let last = unit.blocks.last().map(|block| up_to(block, end));
    let others = unit.blocks.len().saturating_sub(1);
    for block in unit.blocks.iter().take(others).chain(&last) {
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

/// A block with what follows it up to a byte.
fn up_to(block: &Block, end: u32) -> Block {
    let mut block = block.clone();
    let span = match &mut block {
        Block::Code(code) => &mut code.span,
        Block::Data(data) => &mut data.span,
        Block::Type(ty) => &mut ty.span,
    };
    span.end = span.end.max(end);
    block
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
    pub(crate) fn header_lines(&mut self, header: &Header, from: u32, words: &[&str], first: u32) -> Vec<String> {
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
    check_header(&block.name, &block.header, false, writer);
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
            block_language(&block.header, &body.networks)
        }
        Code::Chart(chart) => {
            units.push(chart::compile_unit(chart, block, library, ids, writer)?);
            "GRAPH"
        }
    };
    after.extend(writer.lines_before(block.span.end));
    let mut list = Node::new("ObjectList").children(units);
    list.children.extend(texts(&block.header, before, after, ids));
    let mut attributes = attributes(&block.name, &block.header, Some(interface), language, library);
    if let Code::Chart(chart) = &block.code {
        chart::settings(chart, &mut attributes, writer);
    }
    Some(Node::new(kind).with("ID", ids.next()).child(attributes).child(list))
}

/// The language of a block of networks, which may have some in SCL between those of LAD and FBD.
fn block_language(header: &Header, networks: &[Network]) -> &'static str {
    let drawn = networks.iter().find(|network| matches!(network.language, Language::Lad | Language::Fbd));
    let said = attribute(header, &["S7_PreferredLanguage"]);
    let said = ["LAD", "FBD"].into_iter().find(|name| said.is_some_and(|said| said.eq_ignore_ascii_case(name)));
    // A block in SCL is one text.
    let alone = networks.first().filter(|_| networks.len() == 1).map(|network| language_name(network.language));
    drawn.map(|network| language_name(network.language)).or(said).or(alone).unwrap_or("LAD")
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
    if let Some(alias) = block.alias.as_ref().filter(|alias| is_written_out(alias)) {
        let title = format!("`{}` is not a structure: its type is written where it is used", name_of(&block.name));
        writer.warn(alias.span, title, "SimaticML has data types only for structures");
        return None;
    }
    if let Some(alias) = &block.alias {
        let title =
            format!("`{}` is not a structure, and SimaticML has data types only for structures", name_of(&block.name));
        writer.refuse(alias.span, title, "write the type where it is used");
        return None;
    }
    let first = block.members.first().map_or(block.span.end, |member| member.name_span.start);
    before.extend(writer.header_lines(&block.header, block.name.span().end, &["STRUCT"], first));
    let interface = interface::of_members("None", &block.members, &[], library, writer);
    let after = writer.lines_before(block.span.end);
    check_header(&block.name, &block.header, false, writer);
    let mut list = attributes(&block.name, &block.header, Some(interface), "", library);
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
    let instruction = library.instruction(block);
    let is_instruction = match &block.content {
        DataContent::OfType(TypeRef { kind: TypeKind::Named(of), .. }) => {
            header::instruction(&block.header).is_none_or(|name| name.eq_ignore_ascii_case(of))
        }
        DataContent::OfType(_) | DataContent::Struct(_) | DataContent::Array(..) | DataContent::Empty => {
            instruction.is_some()
        }
    };
    check_header(&block.name, &block.header, is_instruction, writer);
    let first = match &block.content {
        DataContent::Struct(members) => members.first().map(|member| member.name_span.start),
        DataContent::OfType(_) | DataContent::Array(..) | DataContent::Empty => None,
    };
    let first = first.unwrap_or(block.span.end);
    before.extend(writer.header_lines(&block.header, block.name.span().end, &["STRUCT", "VAR", "BEGIN"], first));
    let (kind, mut interface, mut more) = match &block.content {
        DataContent::Struct(members) => {
            let all = || -> Vec<String> { members.iter().map(|member| member.name.clone()).collect() };
            let retained = if block.header.retain { all() } else { block.retained.clone() };
            let mut interface = interface::of_members("Static", members, &retained, library, writer);
            for value in &block.values {
                let section = interface.children.first_mut().and_then(|sections| sections.children.first_mut());
                let replaced =
                    section.is_some_and(|section| interface::replace_value(section, value, members, library, writer));
                if !replaced {
                    let help = "add the source of its data type, or write the value in its declaration";
                    writer.refuse(value.span, "SimaticML has no form for this value of a component", help);
                }
            }
            match &instruction {
                Some(name) => ("SW.Blocks.InstanceDB", interface, of_instruction(name, &block.header)),
                None => ("SW.Blocks.GlobalDB", interface, Vec::new()),
            }
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
                TypeKind::Block(of) if library.is_of_system(of) => of_instruction(&library.own_name(of), &block.header),
                TypeKind::Block(of) if library.standard_name(of).is_none() => {
                    let is_type = library.types.contains(&library.folded(of));
                    let kind = if is_type { "UDT" } else { "FB" };
                    vec![Node::of("InstanceOfName", referred(of, library, writer)), Node::of("InstanceOfType", kind)]
                }
                _ => of_instruction(&interface::type_text(ty, library, writer), &block.header),
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
    if let Some(remanence) = standard_remanence(&block.header) {
        if kind == "SW.Blocks.GlobalDB" {
            interface::set_remanence(&mut interface, remanence);
        } else if remanence == "NonRetain" && !block.header.non_retain {
            let title = format!("the file does not say that the data of `{}` are not retentive", name_of(&block.name));
            writer.warn(block.name.span(), title, "set the retentivity in the editor again");
        }
    }
    let after = writer.lines_before(block.span.end);
    let mut list = attributes(&block.name, &block.header, Some(interface), "DB", library);
    list.children.append(&mut more);
    let texts = Node::new("ObjectList").children(texts(&block.header, before, after, ids));
    Some(Node::new(kind).with("ID", ids.next()).child(list).child(texts))
}
