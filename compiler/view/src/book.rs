//! A whole program as pages: one for each block, with its drawings and its text.

use plcc_abi::image::BlockKind;
use plcc_model::{BlockKey, Program};
use plcc_syntax::ast::{self, BlockName, Code, CodeBlock, CodeKind, SourceUnit};
use plcc_syntax::chart::ast::{Permanent, PermanentKind};
use plcc_syntax::network::ast::{Content, Language, Network};
use plcc_syntax::stl::Mnemonics;

use crate::listing::{self, Listing};
use crate::names::{Names, Scope};
use crate::scene::Scene;
use crate::sheet::Sheet;
use crate::chart::{self, Tiles};
use crate::{diagram, ladder, sheet};

/// A program as pages.
#[derive(Default)]
pub struct Book {
    pub title: String,
    pub pages: Vec<Page>,
}

/// A block.
#[derive(Clone, Debug, Default)]
pub struct Page {
    /// `FC 1`, `DB 5`; for a block without a number its name.
    pub id: String,
    /// The symbol; empty if it has none.
    pub name: String,
    /// `LAD`, `SCL`, …; empty for data.
    pub language: &'static str,
    pub title: String,
    pub comment: Vec<String>,
    /// Declarations, as rows of a table.
    pub declarations: Vec<Declaration>,
    pub sections: Vec<Section>,
}

/// A row of the interface of a block, or a component of a data block.
#[derive(Clone, Debug, Default)]
pub struct Declaration {
    /// `Input`, `Static`; empty for components of data blocks.
    pub section: &'static str,
    pub name: String,
    pub ty: String,
    pub initial: String,
    pub comment: String,
    pub address: String,
    /// Components inside components are indented.
    pub depth: usize,
}

/// A network, or a part of a page without networks.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// 0: the section is no network.
    pub number: usize,
    pub title: String,
    pub comment: Vec<String>,
    pub labels: Vec<String>,
    /// Why it is text, although the block is drawn.
    pub reason: String,
    pub content: Body,
}

/// What a section shows.
#[derive(Clone, Debug)]
pub enum Body {
    Drawing { scene: Scene, sheet: Option<Sheet> },
    Text(Listing),
}

impl Default for Body {
    fn default() -> Body {
        Body::Text(Listing::default())
    }
}

/// How a book is made.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Width of drawings in pixels, after which networks go on in a second line.
    pub width: i32,
}

impl Default for Options {
    fn default() -> Options {
        Options { width: 1100 }
    }
}

/// The book of a program: its sources with their texts, and what binding found out about names.
pub fn book(title: &str, units: &[(&str, &SourceUnit)], program: &Program, options: Options) -> Book {
    book_with(title, units, &Names::of(program), Some(program), options)
}

/// As [`book`], with names that are already known; without a program blocks have the numbers that their sources give them.
pub fn book_with(
    title: &str,
    units: &[(&str, &SourceUnit)],
    names: &Names,
    program: Option<&Program>,
    options: Options,
) -> Book {
    let mut book = Book { title: title.to_string(), pages: Vec::new() };
    for (text, unit) in units {
        let text = unit.overlay.as_deref().unwrap_or(text);
        let maker = Maker { text, unit, names, program, options };
        for block in &unit.blocks {
            match block {
                ast::Block::Code(block) => book.pages.push(maker.code(block)),
                ast::Block::Data(_) | ast::Block::Type(_) => {}
            }
        }
    }
    book
}

struct Maker<'a> {
    text: &'a str,
    unit: &'a SourceUnit,
    names: &'a Names,
    program: Option<&'a Program>,
    options: Options,
}

impl Maker<'_> {
    fn code(&self, block: &CodeBlock) -> Page {
        let kind = match block.kind {
            CodeKind::Ob => BlockKind::Ob,
            CodeKind::Fc => BlockKind::Fc,
            CodeKind::Fb => BlockKind::Fb,
            CodeKind::Sfc => BlockKind::Sfc,
            CodeKind::Sfb => BlockKind::Sfb,
        };
        let key = self.key(kind, &block.name);
        let german = self.unit.mnemonics == Mnemonics::De;
        let scope = key.map_or(Scope { german, ..Scope::default() }, |key| self.names.scope(key, german));
        let name = match &block.name {
            BlockName::Symbol { name, .. } => name.clone(),
            BlockName::Numbered { .. } => {
                key.and_then(|key| self.program?.block(key)).map_or(String::new(), |block| block.name.clone())
            }
        };
        let id = match (key, &block.name) {
            (Some(key), _) => key.to_string(),
            (None, BlockName::Numbered { prefix, number, .. }) => format!("{} {number}", prefix.letters()),
            (None, BlockName::Symbol { name, .. }) => name.clone(),
        };
        let mut page = Page {
            id,
            name,
            title: block.header.title.clone().unwrap_or_default(),
            comment: block.header.comment.clone(),
            ..Page::default()
        };
        match &block.code {
            Code::Graphic(body) => {
                let is_fbd = body.networks.iter().any(|network| network.language == Language::Fbd);
                page.language = if is_fbd { "FBD" } else { "LAD" };
                page.sections = body
                    .networks
                    .iter()
                    .enumerate()
                    .map(|(at, network)| self.network(at + 1, network, scope))
                    .collect();
            }
            Code::Stl(_) => page.language = "STL",
            Code::Scl(_) => page.language = "SCL",
            Code::Chart(body) => {
                page.language = "GRAPH";
                let tiles = Tiles { text: self.text, names: self.names, scope };
                page.sections = self.chart(body, &tiles);
            }
        }
        page
    }

    /// The permanent instructions and the chart.
    fn chart(&self, body: &plcc_syntax::chart::ast::Body, tiles: &Tiles) -> Vec<Section> {
        let permanent = |list: &[Permanent], title: &str| -> Vec<Section> {
            let sections = list.iter().map(|permanent| {
                let content = match &permanent.kind {
                    PermanentKind::Network(network) => return self.network(0, network, tiles.scope),
                    PermanentKind::Coil { .. } | PermanentKind::Call(_) => {
                        let spans = std::iter::once(permanent.span);
                        Body::Text(listing::of_spans(self.text, spans, self.unit.overlay.is_some(), listing::Kind::Scl))
                    }
                };
                Section { title: title.to_string(), content, ..Section::default() }
            });
            sections.collect()
        };
        let scene = chart::draw(body, tiles);
        let mut sections = permanent(&body.before, "Permanent instructions before the sequence");
        sections.push(Section { content: Body::Drawing { scene, sheet: None }, ..Section::default() });
        sections.extend(permanent(&body.after, "Permanent instructions after the sequence"));
        sections
    }

    fn key(&self, kind: BlockKind, name: &BlockName) -> Option<BlockKey> {
        match name {
            BlockName::Numbered { number, .. } => Some(BlockKey { kind, number: u16::try_from(*number).ok()? }),
            BlockName::Symbol { name, .. } => {
                let same = |block: &&plcc_model::CodeBlock| block.kind == kind && block.name.eq_ignore_ascii_case(name);
                self.program?.blocks.iter().find(same).map(plcc_model::CodeBlock::key)
            }
        }
    }

    fn network(&self, number: usize, network: &Network, scope: Scope) -> Section {
        let content = match &network.content {
            Content::Graphic(graph) => {
                let sheet = sheet::network::sheet(graph, network.language, self.names, scope);
                let scene = match network.language {
                    Language::Fbd => diagram::draw(&sheet, self.options.width),
                    Language::Lad | Language::Scl | Language::Stl => ladder::draw(&sheet, self.options.width),
                };
                Body::Drawing { scene, sheet: Some(sheet) }
            }
            Content::Scl(statements) => {
                let spans = statements.iter().map(|statement| statement.span);
                Body::Text(listing::of_spans(self.text, spans, self.unit.overlay.is_some(), listing::Kind::Scl))
            }
            Content::Stl(statements) => {
                let spans = statements.iter().map(|statement| statement.span);
                Body::Text(listing::of_spans(self.text, spans, self.unit.overlay.is_some(), listing::Kind::Stl))
            }
        };
        Section {
            number,
            title: network.title.clone().unwrap_or_default(),
            comment: network.comment.clone(),
            labels: network.labels.iter().map(|label| label.text.clone()).collect(),
            reason: String::new(),
            content,
        }
    }
}
