//! Pages of blocks with code: their networks, charts and texts.

use plcc_abi::image::BlockKind;
use plcc_convert::to_graph;
use plcc_syntax::ast::{Code, CodeBlock, CodeKind, SectionKind};
use plcc_syntax::chart::ast::{Permanent, PermanentKind};
use plcc_syntax::network::ast::{Content, Language, Network};
use plcc_syntax::stl::Mnemonics;

use super::{Body, Declaration, Maker, Page, Section};
use crate::chart::{self, Tiles};
use crate::names::Scope;
use crate::{diagram, ladder, listing, sheet};

impl Maker<'_> {
    pub(super) fn code(&self, block: &CodeBlock) -> Page {
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
            let ty = self.type_words(of);
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
                    networks.map(|(at, (network, picture))| self.stl(at + 1, network, picture, scope)).collect();
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

    fn network(&self, number: usize, network: &Network, scope: Scope) -> Section {
        let content = match &network.content {
            Content::Graphic(graph) => {
                let mut sheet = sheet::network::sheet(graph, network.language, self.names, scope, self.text);
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
