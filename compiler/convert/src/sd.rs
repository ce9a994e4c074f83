//! Documents of SIMATIC SD, from trees of blocks whose networks are LAD and FBD.
//!
//! ```text
//! element ─ net ─ element    a rung as long as each element takes the flow of the one before it
//!            └─── element    another rung, which begins at the wire of the net
//! ```
//!
//! - Here: blocks, their headers and their networks.
//! - `rungs`: the elements of a network in their order, with `elements` one of them, and `wires` the names of nets.
//! - `attributes`: what stands in braces before blocks and networks, and texts; `written`: how the author wrote an element;
//!   `checks`: what a document does not have.

pub(crate) mod attributes;
mod checks;
mod elements;
mod rungs;
mod wires;
mod written;

use plcc_diag::Diagnostic;
use plcc_syntax::ast::{Block, BlockName, Code, CodeBlock, CodeKind, DataBlock, DataContent, SourceUnit, TypeBlock};
use plcc_syntax::network::ast::{Content, Network};
use plcc_syntax::scl::ast::{Dialect, Statement};
use plcc_syntax::stl::Mnemonics;

use crate::frames::{is_implied, is_standard, with_retention};
use crate::trivia::{Remark, Trivia};
use crate::writer::{Notation, Writer};

use attributes::{Braces, Texts};

/// A document, and the texts of its titles (`.s7res`), if it has some.
pub struct Document {
    pub text: String,
    pub texts: Option<String>,
    pub messages: Vec<Diagnostic>,
}

/// Writes a document. `source`: the text that spans mean, if its constants are those of SCL.
pub fn write(unit: &SourceUnit, trivia: Trivia, source: Option<&str>) -> Document {
    let mut writer = Writer::new(Notation::Sd, Mnemonics::En, trivia, source);
    writer.quotes_words = unit.overlay.is_some();
    units(writer, unit)
}

/// Like [`write`]; blocks in SCL of the TIA Portal are written, too, as a network in SCL each.
pub fn write_all(unit: &SourceUnit, trivia: Trivia, source: Option<&str>) -> Document {
    let mut writer = Writer::new(Notation::Sd, Mnemonics::En, trivia, source);
    writer.quotes_words = unit.overlay.is_some();
    writer.scl_as_networks = true;
    units(writer, unit)
}

/// Writes a document that is made of another one, with the attributes of its author: its texts are those of the other one.
///
/// `is_redrawn`: its networks may have another language now.
pub fn rewrite(unit: &SourceUnit, trivia: Trivia, source: &str, is_redrawn: bool) -> Document {
    let mut writer = Writer::new(Notation::Sd, Mnemonics::En, trivia, Some(source));
    writer.braces = Some(Braces::of(source, is_redrawn));
    units(writer, unit)
}

fn units(mut writer: Writer, unit: &SourceUnit) -> Document {
    let mut texts = Texts::default();
    for (at, block) in unit.blocks.iter().enumerate() {
        if writer.scl_as_networks && checks::is_forward(block, &unit.blocks) {
            continue;
        }
        let next = unit.blocks.get(at + 1);
        let (is_joined, is_followed) = (writer.is_joined(block), next.is_some_and(|next| writer.is_joined(next)));
        if !is_joined {
            writer.out.gap();
        }
        // What follows statements without a header is still in their block.
        let next = next.map_or(u32::MAX, |next| next.span().start);
        let end = if is_implied(block) { next } else { block.span().end };
        match block {
            Block::Code(code) => writer.sd_block(code, end, &mut texts),
            Block::Data(data) => writer.sd_data(data, &mut texts),
            Block::Type(ty) => writer.sd_type(ty, (is_joined, is_followed), &mut texts),
        }
    }
    writer.remarks_before(u32::MAX);
    Document { text: writer.out.into_text(), texts: texts.into_text(), messages: writer.messages }
}

/// A source for a CPU of the TIA Portal: its blocks in SCL without a feature of either dialect are in that of the TIA Portal.
pub fn of_portal(unit: &SourceUnit) -> SourceUnit {
    let mut unit = unit.clone();
    for block in &mut unit.blocks {
        if let Block::Code(code) = block
            && let Code::Scl(body) = &mut code.code
            && body.dialect == Dialect::Either
        {
            body.dialect = Dialect::Tia;
        }
    }
    unit
}

impl Writer<'_> {
    /// `end`: where its comments end.
    fn sd_block(&mut self, block: &CodeBlock, end: u32, texts: &mut Texts) {
        let is_written = match &block.code {
            Code::Graphic(_) => true,
            Code::Scl(body) => self.scl_as_networks && body.dialect == Dialect::Tia && body.labels.is_empty(),
            Code::Stl(_) | Code::Chart(_) => false,
        };
        if !is_written {
            let name = self.block_name(&block.name);
            let no_networks = format!("{name} has no networks");
            let as_stl = "if its CPU has STL, convert it with `--to stl`, and the result with `--to lad` or `--to fbd`";
            let (title, help) = match &block.code {
                Code::Stl(_) => (no_networks, "write it as networks first, with `--to lad` or `--to fbd`"),
                Code::Scl(body) if self.scl_as_networks && body.dialect == Dialect::Either => (
                    format!("{name} follows the rules of STEP 7 V5, as nothing in it shows the TIA Portal"),
                    "name its CPU with `--cpu` or in plc.toml if it is of the TIA Portal",
                ),
                Code::Scl(body) if self.scl_as_networks && body.dialect == Dialect::Classic => {
                    (format!("{name} is SCL of STEP 7 V5, which has other rules than that of the TIA Portal"), as_stl)
                }
                Code::Scl(_) => (no_networks, as_stl),
                Code::Chart(_) | Code::Graphic(_) => {
                    (no_networks, "leave it as it is: plcc builds charts and networks together")
                }
            };
            return self.refuse(block.name.span(), title, help);
        }
        let keyword = match block.kind {
            CodeKind::Ob => "ORGANIZATION_BLOCK",
            CodeKind::Fc | CodeKind::Sfc => "FUNCTION",
            CodeKind::Fb | CodeKind::Sfb => "FUNCTION_BLOCK",
        };
        let after_head =
            self.attributes_after_head(block.return_type.as_ref().map_or(block.name.span().end, |ty| ty.span.end));
        self.remarks_before(block.span.start);
        self.sd_header((&block.header, block.kind == CodeKind::Ob), block.span, &after_head, texts);
        let returns = match (&block.return_type, block.kind) {
            (Some(ty), _) => format!(" : {}", self.type_text(ty)),
            (None, CodeKind::Fc | CodeKind::Sfc) => " : Void".to_string(),
            (None, CodeKind::Ob | CodeKind::Fb | CodeKind::Sfb) => String::new(),
        };
        let name = self.document_name(&block.name);
        self.out.line(format!("{keyword} {name}{returns}"));
        self.attribute_line(&after_head);
        self.flags(&block.header);
        self.out.indent();
        self.declarations(block);
        match &block.code {
            Code::Graphic(body) => body.networks.iter().for_each(|network| self.sd_network(network, texts)),
            Code::Scl(body) => self.scl_network(&body.statements, end),
            Code::Stl(_) | Code::Chart(_) => {}
        }
        self.remarks_before(end);
        self.out.dedent();
        self.out.line(format!("END_{keyword}"));
    }

    /// The statements of a block in SCL. `end`: where their comments end.
    fn scl_network(&mut self, statements: &[Statement], end: u32) {
        self.out.line("{ S7_Language := \"SCL\" }");
        self.out.line("NETWORK");
        self.out.indent();
        self.statements(statements);
        self.remarks_before(end);
        self.out.dedent();
        self.out.line("END_NETWORK");
    }

    fn sd_data(&mut self, block: &DataBlock, texts: &mut Texts) {
        let (content, values) = self.declared_content(&block.content);
        let head_end = match &block.content {
            DataContent::OfType(ty) | DataContent::Array(ty, _) => ty.span.end,
            DataContent::Struct(_) | DataContent::Empty => block.name.span().end,
        };
        let after_head = self.attributes_after_head(head_end);
        self.remarks_before(block.span.start);
        let header =
            if self.braces.is_some() { block.header.clone() } else { with_retention(&block.header, Notation::Sd) };
        self.sd_header((&header, is_standard(&header)), block.span, &after_head, texts);
        let name = self.document_name(&block.name);
        if let DataContent::Array(_, Some(values)) = &content {
            let title = "SIMATIC SD has no start values of a data block that is an array";
            self.warn(values.span, title, "set them in the editor again");
        }
        match &content {
            DataContent::OfType(ty) | DataContent::Array(ty, _) => {
                let ty = self.type_text(ty);
                self.out.line(format!("DATA_BLOCK {name} : {ty}"));
                self.attribute_line(&after_head);
                self.flags(&block.header);
            }
            DataContent::Struct(members) => {
                self.out.line(format!("DATA_BLOCK {name}"));
                self.attribute_line(&after_head);
                self.flags(&block.header);
                self.retained(members, &block.retained);
            }
            DataContent::Empty => {
                self.out.line(format!("DATA_BLOCK {name}"));
                self.attribute_line(&after_head);
                self.flags(&block.header);
            }
        }
        // Documents need no BEGIN.
        let begins = match self.braces {
            Some(_) => self.trivia.word("BEGIN", head_end, block.span.end).is_some(),
            None => !block.values.is_empty() || !values.is_empty(),
        };
        if begins {
            self.out.line("BEGIN");
        }
        self.assignments(&values);
        block.values.iter().for_each(|value| self.value(value));
        self.remarks_before(block.span.end);
        self.out.line("END_DATA_BLOCK");
    }

    /// A name as it is declared; a block with a number only is named by it.
    fn document_name(&self, name: &BlockName) -> String {
        match name {
            BlockName::Numbered { prefix, number, .. } => format!("{}{number}", prefix.letters()),
            BlockName::Symbol { name, span } => self.declared(name, *span),
        }
    }

    /// Whether a type of a document follows another one between TYPE and its end: it begins with its name.
    fn is_joined(&self, block: &Block) -> bool {
        match block {
            Block::Type(block) => self.braces.is_some() && block.span.start == block.name.span().start,
            Block::Code(_) | Block::Data(_) => false,
        }
    }

    /// `is_joined`: it follows another one, `is_followed`: another one follows it, before the end of both.
    fn sd_type(&mut self, block: &TypeBlock, (is_joined, is_followed): (bool, bool), texts: &mut Texts) {
        let name_start = block.name.span().start;
        let inner = if is_joined { Vec::new() } else { self.attributes_before(name_start) };
        self.remarks_before(block.span.start);
        if is_joined {
            self.out.indent();
        }
        self.sd_header((&block.header, false), block.span, &inner, texts);
        let name = self.document_name(&block.name);
        if !is_joined {
            self.out.line("TYPE");
            self.out.indent();
            self.attribute_line(&inner);
        }
        match &block.alias {
            Some(alias) => {
                let ty = self.type_text(alias);
                self.out.line(format!("{name} : {ty};"));
            }
            None => {
                self.out.line(format!("{name} : STRUCT"));
                self.variables(&block.members);
                self.out.line("END_STRUCT;");
            }
        }
        self.out.dedent();
        self.remarks_before(block.span.end);
        if !is_followed {
            self.out.line("END_TYPE");
        }
    }

    fn sd_network(&mut self, network: &Network, texts: &mut Texts) {
        // An assertion after statements that do nothing stands before the network.
        let first = match &network.content {
            Content::Graphic(graph) if network.labels.is_empty() => graph.elements.first(),
            Content::Graphic(_) | Content::Scl(_) | Content::Stl(_) => None,
        };
        let first = first.map(|element| element.span.start).filter(|at| self.trivia.asserts_before(*at));
        self.remarks_before(first.unwrap_or(network.span.start));
        self.network_attributes(network, texts);
        self.out.line("NETWORK");
        if let Some(word) = self.trivia.word("NETWORK", network.span.start, network.span.end) {
            let remarks = self.trivia.on_line(word);
            self.new_remarks(remarks);
        }
        self.out.indent();
        for label in &network.labels {
            self.out.line(format!("Label( {} )", label.text));
        }
        match &network.content {
            Content::Graphic(graph) => self.rungs(graph, network.language),
            Content::Scl(list) => {
                self.statements(list);
                let from = list.last().map_or(network.span.end, |last| last.span.end);
                if let Some(end) = self.trivia.next_word("END_NETWORK", from) {
                    self.remarks_before(end);
                }
            }
            Content::Stl(_) => self.refuse(network.span, "a network in STL has no rungs", "write it in LAD or FBD"),
        }
        self.out.dedent();
        self.out.line("END_NETWORK");
    }

    /// Comments that are not written yet.
    fn new_remarks(&mut self, mut remarks: Vec<Remark>) {
        remarks.retain(|remark| !self.is_written(&remark.text));
        self.out.remarks(&remarks);
    }
}
