//! A whole program as pages: one for each block, with its drawings and its text.
//!
//! - [`code`]: blocks with code; [`statements`]: their networks in STL; [`s7200`]: blocks of the S7-200.
//! - [`declarations`]: interfaces and data blocks.
//! - [`poster`]: all drawings in one picture.

mod code;
mod declarations;
mod poster;
mod s7200;
mod statements;

use std::collections::HashMap;

use plcc_abi::image::BlockKind;
use plcc_convert::to_stl::types::Types;
use plcc_diag::Span;
use plcc_model::{BlockKey, Program};
use plcc_syntax::ast::{self, BlockName, SourceUnit};

use crate::listing::{self, Listing};
use crate::metrics::{self, LINE};
use crate::names::{Names, Scope};
use crate::scene::{Anchor, Ink, Scene};
use crate::sheet::Sheet;

/// A program as pages.
#[derive(Default)]
pub struct Book {
    pub title: String,
    pub pages: Vec<Page>,
    /// See [`Options::is_live`].
    pub is_live: bool,
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
    /// Whose local names its texts have.
    pub scope: Scope,
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
    /// 0: the section is not a network.
    pub number: usize,
    pub title: String,
    pub comment: Vec<String>,
    pub labels: Vec<String>,
    /// Why it is text, although the block is drawn.
    pub reason: String,
    pub content: Body,
    /// What is drawn, as text, if the drawing is live.
    pub code: Option<Listing>,
}

impl Section {
    /// Its drawing, below the labels that jumps lead to; `None`: it is text.
    pub fn picture(&self) -> Option<Scene> {
        let Body::Drawing { scene, .. } = &self.content else { return None };
        if self.labels.is_empty() {
            return Some(scene.clone());
        }
        let labels = format!("{}:", self.labels.join(", "));
        let width = scene.width.max(20 + metrics::width(&labels, Ink::Mark.height()));
        let mut picture = Scene { width, height: scene.height + LINE, items: Vec::new() };
        picture.text((10, 16), Anchor::Start, Ink::Mark, &labels, "");
        picture.add(scene.clone(), (0, LINE));
        Some(picture)
    }
}

/// What a section shows.
#[derive(Clone, Debug)]
pub enum Body {
    Drawing { scene: Scene, sheet: Sheet },
    Text(Listing),
}

impl Default for Body {
    fn default() -> Body {
        Body::Text(Listing::default())
    }
}

/// How a book is made.
#[derive(Clone, Copy, Debug)]
pub struct Options<'a> {
    /// Width of drawings in pixels, after which networks go on in a second line.
    pub width: i32,
    /// Values of operands by their keys, which are drawn beside them.
    pub values: Option<&'a HashMap<String, String>>,
    /// The drawings will show what the program does while it runs: they have room for values, and the code of all that they show.
    pub is_live: bool,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Options { width: 1100, values: None, is_live: false }
    }
}

/// The book of a program: its sources with their texts, and what binding found out about names.
pub fn book(title: &str, units: &[(&str, &SourceUnit)], program: &Program, options: Options<'_>) -> Book {
    book_with(title, units, &Names::of(program), Some(program), options)
}

/// As [`book`], with names that are already known; without a program blocks have the numbers that their sources give them.
pub fn book_with(
    title: &str,
    units: &[(&str, &SourceUnit)],
    names: &Names,
    program: Option<&Program>,
    options: Options<'_>,
) -> Book {
    let mut book = Book { title: title.to_string(), pages: Vec::new(), is_live: options.is_live };
    let types = Types::new(units.iter().map(|(_, unit)| *unit), &[]);
    let declared = declarations::declared(units);
    for (text, unit) in units {
        let text = unit.overlay.as_deref().unwrap_or(text);
        let maker = Maker { text, unit, units, names, program, types: &types, declared: &declared, options };
        for block in &unit.blocks {
            match block {
                ast::Block::Code(block) => book.pages.push(maker.code(block)),
                ast::Block::Data(block) => book.pages.push(maker.data(block)),
                ast::Block::Type(block) => {
                    let mut page = maker.page(BlockKind::Db, &block.name, &block.header);
                    if page.name.is_empty() || matches!(block.name, BlockName::Symbol { .. }) {
                        page.id = format!("UDT {}", page.id.trim_start_matches("UDT "));
                    }
                    maker.declare(&block.members, "", 0, &mut page.declarations);
                    book.pages.push(page);
                }
            }
        }
        for block in unit.s7200.iter().flat_map(|source| &source.blocks) {
            book.pages.push(maker.s7200(block));
        }
    }
    book
}

struct Maker<'a> {
    text: &'a str,
    unit: &'a SourceUnit,
    /// All sources of the program.
    units: &'a [(&'a str, &'a SourceUnit)],
    names: &'a Names,
    program: Option<&'a Program>,
    types: &'a Types<'a>,
    declared: &'a HashMap<String, declarations::Declared<'a>>,
    options: Options<'a>,
}

impl Maker<'_> {
    fn listing(&self, spans: impl Iterator<Item = Span>, kind: listing::Kind) -> Listing {
        listing::of_spans(self.text, spans, self.unit.overlay.is_some(), kind, self.options.is_live)
    }

    /// A page without contents.
    fn page(&self, kind: BlockKind, name: &BlockName, header: &ast::Header) -> Page {
        let key = self.key(kind, name);
        let (number, symbol) = match name {
            BlockName::Numbered { prefix, number, .. } => {
                let named = key.and_then(|key| self.program?.block(key)).map(|block| block.name.clone());
                let db = || self.program?.db(u16::try_from(*number).ok()?).map(|db| db.name.clone());
                let symbol = if kind == BlockKind::Db { db() } else { named };
                (format!("{} {number}", prefix.letters()), symbol.unwrap_or_default())
            }
            BlockName::Symbol { name, .. } => (key.map_or(name.clone(), |key| key.to_string()), name.clone()),
        };
        Page {
            id: number,
            name: symbol,
            title: header.title.clone().unwrap_or_default(),
            comment: header.comment.clone(),
            ..Page::default()
        }
    }

    /// The text of a place, in one line.
    fn words(&self, span: Span) -> String {
        let text = self.text.get(span.start as usize..span.end as usize).unwrap_or_default();
        text.split_whitespace().collect::<Vec<_>>().join(" ")
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
}
