//! A whole program as pages: one for each block, with its drawings and its text.

use std::collections::HashMap;

use plcc_abi::image::BlockKind;
use plcc_convert::to_graph;
use plcc_convert::to_stl::types::Types;
use plcc_diag::Span;
use plcc_model::{BlockKey, Direction, Program};
use plcc_syntax::ast::{
    self, BlockName, Code, CodeBlock, CodeKind, DataContent, SectionKind, SourceUnit, TypeKind, Variable,
};
use plcc_syntax::chart::ast::{Permanent, PermanentKind};
use plcc_syntax::network::ast::{Content, Language, Network, Target};
use plcc_syntax::network::draw;
use plcc_syntax::s7200::ast as s7200;
use plcc_syntax::scl::ast::Expr;
use plcc_syntax::stl::Mnemonics;

use crate::chart::{self, Tiles};
use crate::data;
use crate::listing::{self, Listing};
use crate::logic;
use crate::metrics;
use crate::names::{Names, Scope};
use crate::scene::{Anchor, Ink, Scene};
use crate::sheet::Sheet;
use crate::svg::{self, Shown};
use crate::{diagram, ladder, sheet};

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
    /// 0: the section is no network.
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
    for (text, unit) in units {
        let text = unit.overlay.as_deref().unwrap_or(text);
        let maker = Maker { text, unit, names, program, types: &types, options };
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

impl Book {
    /// All drawings below each other, each with the name of its block and its network. `values`: the state that is shown.
    pub fn poster(&self, values: Option<&HashMap<String, String>>) -> String {
        let mut all = Scene { width: 0, height: 6, items: Vec::new() };
        let mut shown = Shown::default();
        let mut nets = 0;
        for page in &self.pages {
            for section in &page.sections {
                let Body::Drawing { scene, sheet } = &section.content else { continue };
                let mut scene = scene.clone();
                let network = if section.number > 0 { format!(", network {}", section.number) } else { String::new() };
                let title = if section.title.is_empty() { String::new() } else { format!(": {}", section.title) };
                let caption = format!("{}{network}{title}", page.id);
                all.text((10, all.height + 12), Anchor::Start, Ink::Note, &caption, "");
                all.width = all.width.max(scene.width).max(20 + metrics::width(&caption, Ink::Note.height()));
                scene.renumber(nets);
                if let Some(values) = values {
                    let known = logic::logic(sheet).values(&|key| values.get(key).cloned());
                    shown.nets.extend(known.into_iter().map(|(net, value)| (net + nets, value)));
                }
                nets += sheet.nets.len() + 1;
                let (top, height) = (all.height + 14, scene.height);
                all.add(scene, (0, top));
                all.height = top + height + 6;
            }
        }
        let active = values.iter().flat_map(|values| values.iter()).filter(|(_, value)| *value == "1");
        shown.active = active.map(|(key, _)| key.clone()).collect();
        svg::file(&all, values.map(|_| &shown))
    }
}

struct Maker<'a> {
    text: &'a str,
    unit: &'a SourceUnit,
    names: &'a Names,
    program: Option<&'a Program>,
    types: &'a Types<'a>,
    options: Options<'a>,
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
        let mut page = self.page(kind, &block.name, &block.header);
        for section in &block.sections {
            let name = match section.kind {
                SectionKind::Input => "Input",
                SectionKind::Output => "Output",
                SectionKind::InOut => "InOut",
                SectionKind::Static => "Static",
                SectionKind::Temp => "Temp",
            };
            self.declare(&section.variables, name, 0, &mut page.declarations);
        }
        if let Some(of) = &block.return_type {
            let ty = self.words(of.span);
            page.declarations.push(Declaration {
                section: "Return",
                name: "RET_VAL".to_string(),
                ty,
                ..Declaration::default()
            });
        }
        for row in &mut page.declarations {
            if row.depth == 0 && matches!(row.section, "Input" | "Output" | "InOut" | "Static") {
                let address = self.names.key(&format!("#\"{}\"", row.name), scope).unwrap_or_default();
                row.address = if address.starts_with('#') { String::new() } else { address };
            }
        }
        page.scope = scope;
        match &block.code {
            Code::Graphic(body) => {
                let has = |language: Language| body.networks.iter().any(|network| network.language == language);
                page.language = match (has(Language::Lad), has(Language::Fbd)) {
                    (true, true) => "LAD, FBD",
                    (false, true) => "FBD",
                    (_, false) => "LAD",
                };
                page.sections = body
                    .networks
                    .iter()
                    .enumerate()
                    .map(|(at, network)| self.network(at + 1, network, scope))
                    .collect();
            }
            Code::Stl(networks) => {
                page.language = "STL";
                let pictures = to_graph::pictures(block, self.types);
                let networks = networks.iter().zip(pictures).enumerate();
                page.sections =
                    networks.map(|(at, (network, picture))| self.stl(at + 1, network, picture.ok(), scope)).collect();
            }
            Code::Scl(body) => {
                page.language = "SCL";
                let spans = body.statements.iter().map(|statement| statement.span);
                let text = self.listing(spans, listing::Kind::Scl);
                page.sections = vec![Section { content: Body::Text(text), ..Section::default() }];
            }
            Code::Chart(body) => {
                page.language = "GRAPH";
                let tiles = Tiles {
                    text: self.text,
                    names: self.names,
                    scope,
                    values: self.options.values,
                    is_live: self.options.is_live,
                    steps: &body.steps,
                    all: Default::default(),
                };
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
                        Body::Text(self.listing(spans, listing::Kind::Scl))
                    }
                };
                Section { title: title.to_string(), content, ..Section::default() }
            });
            sections.collect()
        };
        let scene = chart::draw(body, tiles);
        let mut sections = permanent(&body.before, "Permanent instructions before the sequence");
        let sheet = tiles.all.take();
        sections.push(Section { content: Body::Drawing { scene, sheet }, ..Section::default() });
        sections.extend(permanent(&body.after, "Permanent instructions after the sequence"));
        sections
    }

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

    fn data(&self, block: &ast::DataBlock) -> Page {
        let mut page = self.page(BlockKind::Db, &block.name, &block.header);
        let same = |db: &&plcc_model::DataBlock| match &block.name {
            BlockName::Numbered { number, .. } => u32::from(db.number) == *number,
            BlockName::Symbol { name, .. } => db.name.eq_ignore_ascii_case(name),
        };
        if let Some(db) = self.program.and_then(|program| program.dbs.iter().find(same)) {
            page.id = format!("DB {}", db.number);
            page.name = db.name.clone();
            let mut rows = Vec::new();
            data::members(db.number, &db.members, 0, 0, &mut rows);
            page.declarations = rows;
        } else if let DataContent::Struct(variables) = &block.content {
            self.declare(variables, "", 0, &mut page.declarations);
        }
        if let DataContent::OfType(ty) = &block.content {
            page.comment.insert(0, format!("Type: {}", self.words(ty.span)));
        }
        for value in &block.values {
            let text = self.words(value.span);
            page.comment.push(text);
        }
        page
    }

    fn declare(&self, list: &[Variable], section: &'static str, depth: usize, rows: &mut Vec<Declaration>) {
        for variable in list {
            let members = match &variable.ty.kind {
                TypeKind::Struct(members) if depth < 40 => Some(members),
                _ => None,
            };
            rows.push(Declaration {
                section,
                name: variable.name.clone(),
                ty: if members.is_some() { "STRUCT".to_string() } else { self.words(variable.ty.span) },
                initial: variable.initial.as_ref().map_or(String::new(), |value| self.words(value.span)),
                comment: variable.comment.clone().unwrap_or_default(),
                address: String::new(),
                depth,
            });
            if let Some(members) = members {
                self.declare(members, section, depth + 1, rows);
            }
        }
    }

    /// The text of a place, in one line.
    fn words(&self, span: Span) -> String {
        let text = self.text.get(span.start as usize..span.end as usize).unwrap_or_default();
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    /// `picture`: the network as LAD, with boxes of several statements.
    fn stl(&self, number: usize, network: &ast::Network, picture: Option<Network>, scope: Scope) -> Section {
        let label = |operand: &ast::Operand| self.names.label(&self.words(operand.span), scope);
        let rungs = sheet::stl::sheet(&network.statements, &label, &|block, formal| self.is_output(block, formal));
        let drawn = match picture {
            Some(picture) if rungs.is_err() || sheet::network::has_cells(&picture) => {
                self.boxes(&network.statements, picture, scope).ok_or(String::new()).or(rungs)
            }
            _ => rungs,
        };
        let spans = network.statements.iter().map(|statement| statement.span);
        Section {
            number,
            title: network.title.clone().unwrap_or_default(),
            comment: network.comment.clone(),
            ..self.rungs(drawn, spans)
        }
    }

    /// The sheet of a network that is made of statements, if it has elements.
    fn boxes(&self, statements: &[ast::Statement], picture: Network, scope: Scope) -> Option<Sheet> {
        let Content::Graphic(mut graph) = picture.content else { return None };
        let spans: HashMap<u32, Span> = statements
            .iter()
            .flat_map(sheet::stl::operands)
            .map(|operand| (operand.span.start, operand.span))
            .collect();
        let words = |value: &Expr| spans.get(&value.span.start).map_or(draw::whole(value), |span| self.words(*span));
        for element in &mut graph.elements {
            if let Target::Block { callee, .. } = &element.target {
                let block = words(callee);
                for pin in &mut element.pins {
                    pin.output |= pin.name != "en" && self.is_output(&block, &pin.name);
                }
            }
        }
        let label = |value: &Expr| self.names.label(&words(value), scope);
        let is_empty = graph.elements.is_empty();
        (!is_empty).then(|| sheet::network::sheet_of_statements(&graph, self.names, scope, &label))
    }

    /// The ladder of a network in STL, or its text and why it is no ladder.
    fn rungs(&self, drawn: Result<Sheet, String>, spans: impl Iterator<Item = Span>) -> Section {
        match drawn {
            Ok(mut sheet) => {
                if let Some(values) = self.options.values {
                    sheet.show(&|key| values.get(key).cloned());
                }
                let scene = ladder::draw(&mut sheet, self.options.width);
                let code = self.options.is_live.then(|| self.listing(spans, listing::Kind::Stl));
                Section { content: Body::Drawing { scene, sheet }, code, ..Section::default() }
            }
            Err(reason) => {
                let text = self.listing(spans, listing::Kind::Stl);
                let reason = if reason.is_empty() { reason } else { format!("Not shown as LAD: {reason}.") };
                Section { reason, content: Body::Text(text), ..Section::default() }
            }
        }
    }

    /// Whether the parameter of a block is an output.
    fn is_output(&self, block: &str, formal: &str) -> bool {
        let name = block.trim_matches('"');
        let same = |known: &&plcc_model::CodeBlock| {
            known.name.eq_ignore_ascii_case(name)
                || known.key().to_string().replace(' ', "").eq_ignore_ascii_case(&name.replace(' ', ""))
        };
        let found = self.program.and_then(|program| program.blocks.iter().find(same));
        found.is_some_and(|block| {
            let mut parameters = block.interface.parameters.iter();
            parameters.any(|known| known.direction == Direction::Output && known.name.eq_ignore_ascii_case(formal))
        })
    }

    /// The parameters of a subroutine of the S7-200, and whether they are outputs.
    fn parameters(&self, name: &str) -> Option<Vec<(String, bool)>> {
        let name = name.trim_matches('"');
        let mut blocks = self.unit.s7200.iter().flat_map(|source| &source.blocks);
        let block = blocks.find(|block| {
            let number = block
                .number
                .is_some_and(|(number, _)| name.replace(' ', "").eq_ignore_ascii_case(&format!("SBR{number}")));
            let named = block.name.as_ref().is_some_and(|(own, _)| own.eq_ignore_ascii_case(name));
            block.kind == s7200::BlockKind::Subroutine && (number || named)
        })?;
        let formals = block.declarations.iter().filter(|row| row.section != s7200::Section::Temp);
        Some(formals.map(|row| (row.name.clone(), row.section == s7200::Section::Output)).collect())
    }

    fn s7200(&self, block: &s7200::Block) -> Page {
        let prefix = match block.kind {
            s7200::BlockKind::Main => "OB",
            s7200::BlockKind::Subroutine => "SBR",
            s7200::BlockKind::Interrupt => "INT",
        };
        let number = block.number.map(|(number, _)| number).or((prefix == "OB").then_some(1));
        let name = block.name.as_ref().map_or(String::new(), |(name, _)| name.clone());
        let id =
            number.map_or(if name.is_empty() { prefix.to_string() } else { name.clone() }, |n| format!("{prefix} {n}"));
        let mut page = Page {
            id,
            name,
            language: "STL",
            title: block.title.clone(),
            comment: block.comment.clone(),
            ..Page::default()
        };
        for row in &block.declarations {
            page.declarations.push(Declaration {
                section: match row.section {
                    s7200::Section::Input => "Input",
                    s7200::Section::InOut => "InOut",
                    s7200::Section::Output => "Output",
                    s7200::Section::Temp => "Temp",
                },
                name: row.name.clone(),
                ty: row.ty.clone(),
                comment: row.comment.clone().unwrap_or_default(),
                ..Declaration::default()
            });
        }
        let scope = Scope { german: self.unit.mnemonics == Mnemonics::De, ..Scope::default() };
        page.scope = scope;
        for (at, network) in block.networks.iter().enumerate() {
            // Micro/WIN writes symbols without quotes.
            let label = |operand: &s7200::Operand| {
                let label = self.names.label(&self.words(operand.span), scope);
                match label.text.strip_prefix('"').and_then(|text| text.strip_suffix('"')) {
                    Some(bare) if !label.key.is_empty() => sheet::Label { text: bare.to_string(), ..label },
                    _ => label,
                }
            };
            let drawn = sheet::s7200::sheet(&network.statements, &label, &|name| self.parameters(name));
            let spans = network.statements.iter().map(|statement| statement.span);
            page.sections.push(Section {
                number: network.number.map_or(at + 1, |number| number as usize),
                title: network.title.clone(),
                comment: network.comment.clone(),
                ..self.rungs(drawn, spans)
            });
        }
        page
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
                let mut sheet = sheet::network::sheet(graph, network.language, self.names, scope);
                if let Some(values) = self.options.values {
                    sheet.show(&|key| values.get(key).cloned());
                }
                if self.options.is_live {
                    sheet.leave_room();
                }
                let scene = match network.language {
                    Language::Fbd => diagram::draw(&sheet, self.options.width),
                    Language::Lad | Language::Scl | Language::Stl => ladder::draw(&mut sheet, self.options.width),
                };
                Body::Drawing { scene, sheet }
            }
            Content::Scl(statements) => {
                let spans = statements.iter().map(|statement| statement.span);
                Body::Text(self.listing(spans, listing::Kind::Scl))
            }
            Content::Stl(statements) => {
                let spans = statements.iter().map(|statement| statement.span);
                Body::Text(self.listing(spans, listing::Kind::Stl))
            }
        };
        Section {
            number,
            title: network.title.clone().unwrap_or_default(),
            comment: network.comment.clone(),
            labels: network.labels.iter().map(|label| label.text.clone()).collect(),
            reason: String::new(),
            content,
            code: None,
        }
    }
}
