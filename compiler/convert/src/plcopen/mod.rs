//! Projects in PLCopen XML (TC6 2.01): a whole program in one document.
//!
//! - `program`: what the sources declare, and `identifier`: the names of the file.
//! - `declare`: types, variables and start values; `globals`: tags, constants and data blocks.
//! - `pou`: blocks with code.
//! - `body`: statements and expressions as ST, with the functions of `system`.
//! - `chart`: charts of GRAPH as SFC.
//! - `network`: networks as the objects of LD and FBD, which `layout` places and `objects` writes.
//! - `tasks`: organization blocks as tasks.
//! - `document`: the document of a complete project.
//!
//! Source: PLCopen TC6, XML schema 2.01; LAD/FBD reference, chapter A3.

mod body;
mod chart;
mod declare;
mod document;
mod globals;
mod identifier;
mod layout;
mod network;
mod objects;
mod pou;
mod program;
mod system;
mod tasks;

use std::collections::BTreeSet;

use plcc_abi::ob::ObClass;
use plcc_diag::{Diagnostic, Span};
use plcc_syntax::ast::{Area, Block, CodeKind, DataBlock, Header, TypeBlock, Width};
use plcc_syntax::stl::Mnemonics;
use plcc_syntax::symbols::SymbolTable;

use crate::node::Node;
use crate::trivia::Trivia;
use crate::writer::{Notation, Writer};
use declare::Declarer;
pub use program::Unit;
use program::{Learned, Program, is_globals};
pub use system::has_type;
use tasks::Task;

/// The bodies are written again until their names are settled, but not more often than this.
const ROUNDS_MAX: usize = 8;

/// The number and the class of an organization block, as far as its source tells them.
pub type ToldOb = (Option<u32>, Option<ObClass>);

/// What is written of a program besides its sources.
pub struct Settings<'s> {
    pub name: &'s str,
    /// What the source tells of an OB, by its name.
    pub told_ob: &'s dyn Fn(&str) -> ToldOb,
    /// The period of a cyclic OB, by its number and whether it has a name of its own.
    pub period_ms: &'s dyn Fn(u16, bool) -> u32,
}

/// Writes a program as one project.
pub fn write(units: Vec<Unit>, tables: &[SymbolTable], settings: &Settings) -> (String, Vec<Diagnostic>) {
    let mut program = Program::new(units, tables);
    for (data, fb) in program
        .code_blocks()
        .filter(|block| block.kind == CodeKind::Ob)
        .filter_map(|block| tasks::instances(&program, block))
        .flatten()
        .collect::<Vec<_>>()
    {
        program.tasks.insert(data, fb);
    }
    let mut rounds = 0;
    loop {
        let mut project = Project::new(&program, settings);
        project.units();
        rounds += 1;
        let learned = std::mem::take(&mut project.learned);
        if learned == program.learned || rounds == ROUNDS_MAX {
            let messages = project.names_that_change();
            return project.document(messages);
        }
        program.learned = learned;
        program.name_all();
    }
}

/// A text for people.
fn documentation(text: &str) -> Node {
    Node::new("documentation").child(Node::of("xhtml:p", text))
}

/// A project that is being written.
struct Project<'p, 'a, 's> {
    program: &'p Program<'a>,
    settings: &'s Settings<'s>,
    declarer: Declarer<'p, 'a>,
    learned: Learned,
    used: BTreeSet<String>,
    types: Vec<Node>,
    pous: Vec<Node>,
    /// Variables of data blocks, by their keys.
    data: Vec<(String, bool, Node)>,
    tasks: Vec<Task>,
    messages: Vec<Diagnostic>,
    /// A block with a version or an author.
    described: Option<Span>,
}

impl<'p, 'a, 's> Project<'p, 'a, 's> {
    fn new(program: &'p Program<'a>, settings: &'s Settings<'s>) -> Project<'p, 'a, 's> {
        let declarer = Declarer { program, structures: Vec::new(), attributes: Vec::new() };
        let learned = program.learned.clone();
        Project {
            program,
            settings,
            declarer,
            learned,
            used: BTreeSet::new(),
            types: Vec::new(),
            pous: Vec::new(),
            data: Vec::new(),
            tasks: Vec::new(),
            messages: Vec::new(),
            described: None,
        }
    }

    fn units(&mut self) {
        let program = self.program;
        for unit in &program.units {
            let trivia = Trivia::new(unit.text, unit.comments.clone(), false).without_regions();
            let mut writer = Writer::new(Notation::St, Mnemonics::En, trivia, None);
            for block in &unit.unit.blocks {
                match block {
                    Block::Code(block) => self.code(block, &mut writer),
                    Block::Data(block) => self.data_block(block, &mut writer),
                    Block::Type(block) => self.data_type(block, &mut writer),
                }
            }
            self.messages.append(&mut writer.messages);
        }
    }

    fn header(&mut self, header: &Header, span: Span, writer: &mut Writer) {
        // It is written with the block, and not again with its first variable.
        writer.written.clone_from(&header.comment);
        if header.know_how_protect {
            writer.warn(
                span,
                "the protection of the block is not in the file",
                "protect the block again in the editor",
            );
        }
        let sets_eno = header.attributes.iter().any(|(key, value)| {
            ["S7_SetENOAutomatically", "SetENOAutomatically"].iter().any(|known| known.eq_ignore_ascii_case(key))
                && value.eq_ignore_ascii_case("TRUE")
        });
        if sets_eno {
            let title = "errors in this block set its ENO to 0, which no block of PLCopen XML does by itself";
            writer.refuse(span, title, "test for the errors, and remove S7_SetENOAutomatically");
        }
        if header.version.is_some() || header.author.is_some() || header.family.is_some() || header.name.is_some() {
            self.described.get_or_insert(span);
        }
        // What the file says in its own way.
        const SAID: [&str; 6] = [
            "S7_EventClass",
            "SecondaryType",
            "S7_PreferredLanguage",
            "S7_PreferredLang",
            "S7_Language",
            "ProgrammingLanguage",
        ];
        for (key, _) in &header.attributes {
            let is_said = SAID.iter().any(|known| known.eq_ignore_ascii_case(key));
            if !is_said && !self.declarer.attributes.iter().any(|(known, _)| known.eq_ignore_ascii_case(key)) {
                self.declarer.attributes.push((key.clone(), span));
            }
        }
    }

    fn data_type(&mut self, block: &'a TypeBlock, writer: &mut Writer) {
        let mut before = writer.lines_before(block.span.start);
        self.header(&block.header, block.name.span(), writer);
        let first = block.members.first().map_or(block.span.end, |member| member.name_span.start);
        before.extend(writer.header_lines(&block.header, block.name.span().end, &["STRUCT"], first));
        let name = self.program.name(&self.program.key(&block.name));
        let ty = match &block.alias {
            Some(alias) => self.declarer.type_node(alias, "values", &name, writer),
            None => self.declarer.structure(&block.members, &name, writer),
        };
        let mut node = Node::new("dataType").with("name", name).child(Node::new("baseType").child(ty));
        node.children.extend(comment_of(before, &block.header));
        self.types.push(node);
    }

    fn data_block(&mut self, block: &'a DataBlock, writer: &mut Writer) {
        let key = self.program.key(&block.name);
        self.header(&block.header, block.name.span(), writer);
        if self.program.tasks.contains_key(&key) {
            return;
        }
        if is_globals(&block.name) {
            self.variables_of(block, writer);
            return;
        }
        let retained = globals::retained(block);
        if retained.is_none() {
            let title = format!(
                "only some components of `{}` are retentive, and PLCopen XML says it of a whole variable",
                self.program.shown(&key)
            );
            writer.refuse(block.name.span(), title, "put the retentive components into a data block of their own");
        }
        let node = globals::data(&mut self.declarer, &key, block, writer);
        self.data.push((key, retained.unwrap_or(false), node));
    }

    /// The components of the block of global variables are variables.
    fn variables_of(&mut self, block: &'a DataBlock, writer: &mut Writer) {
        let plcc_syntax::ast::DataContent::Struct(members) = &block.content else { return };
        for member in members {
            let key = member.name.to_lowercase();
            let mut node = self.declarer.variable(member, "", writer);
            if let Some((_, name)) = node.attributes.first_mut() {
                *name = self.program.name(&key);
            }
            let retained = block.retained.iter().any(|name| name.eq_ignore_ascii_case(&member.name));
            self.data.push((key, retained, node));
        }
    }
}

/// Title and comments of a block.
fn comment_of(before: Vec<String>, header: &Header) -> Option<Node> {
    let lines: Vec<String> =
        before.into_iter().chain(header.title.clone()).chain(header.comment.iter().cloned()).collect();
    let lines: Vec<String> = lines.into_iter().filter(|line| !line.trim().is_empty()).collect();
    (!lines.is_empty()).then(|| documentation(&lines.join("\n")))
}

/// The address of an operand; one that the format does not have was reported.
pub(crate) fn address(area: Area, width: Width, byte: u32, bit: u8) -> String {
    let letter = match area {
        Area::Q => 'Q',
        Area::M => 'M',
        _ => 'I',
    };
    system::address(letter, width, byte, bit).unwrap_or_default()
}
