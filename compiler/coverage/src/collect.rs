//! From counts to blocks: what a source has that can run, and how often it has.

use std::collections::{BTreeMap, HashMap, HashSet};

use plcc_abi::image::BlockKind;
use plcc_diag::{FileId, SourceMap, Span};
use plcc_lower::probe::{Place, Probe};
use plcc_model::{BlockKey, Program};
use plcc_syntax::ast::{self, Code, SourceUnit};
use plcc_syntax::chart::ast::{ActionBody, Body as Chart, Condition, PermanentKind};
use plcc_syntax::s7200::ast as s7200;
use plcc_view::book::{self, Body, Options, Page};
use plcc_view::names::Names;
use plcc_view::sheet::{self, Link, Look, Sheet, Source};

use crate::chart::{self, ChartCounts};
use crate::counter::Counter;
use crate::data::{Block, Contact, Coverage, File, Named, Network, Range, Statement};

/// What has run of a program, by its sources.
pub fn collect(program: &Program, sources: &SourceMap, units: &[(FileId, SourceUnit)], counter: &Counter) -> Coverage {
    let (counts, charts) = counter.counted();
    let mut places: HashMap<BlockKey, Vec<(&Place, [u64; 2])>> = HashMap::new();
    for (place, count) in counter.places().iter().zip(&counts) {
        places.entry(place.block).or_default().push((place, *count));
    }
    let names = Names::of(program);
    let mut coverage = Coverage::default();
    for (file, unit) in units {
        let source = sources.file(*file);
        let text = source.text.as_str();
        let book = book::book_with("", &[(text, unit)], &names, Some(program), Options::default());
        let found = code_blocks(program, unit);
        let blocks = found.into_iter().zip(book.pages).filter_map(|(found, page)| {
            let (key, code) = found?;
            let bound = program.block(key)?;
            let own = places.get(&key).map(Vec::as_slice).unwrap_or_default();
            let own: Vec<(&Place, [u64; 2])> =
                own.iter().filter(|(place, _)| place.span.file == *file).copied().collect();
            let chart = charts.iter().find(|chart| chart.block == key);
            Some(block((bound.span.start, bound.span.end), page, code, &own, chart))
        });
        let blocks: Vec<Block> = blocks.collect();
        if !blocks.is_empty() {
            coverage.files.insert(source.name.clone(), File { source: source.clone(), blocks });
        }
    }
    coverage
}

/// The blocks of a source as a book has its pages; `None`: no code, or not in the program.
fn code_blocks<'a>(program: &Program, unit: &'a SourceUnit) -> Vec<Option<(BlockKey, Text<'a>)>> {
    let blocks = unit.blocks.iter().map(|block| match block {
        ast::Block::Code(block) => {
            let key = chart::key(program, block)?;
            Some(match &block.code {
                Code::Graphic(_) => (key, Text::Networks),
                Code::Chart(chart) => (key, Text::Chart(chart)),
                Code::Stl(_) | Code::Scl(_) => (key, Text::Statements),
            })
        }
        ast::Block::Data(_) | ast::Block::Type(_) => None,
    });
    let own = unit.s7200.iter().flat_map(|source| &source.blocks);
    blocks.chain(own.map(|block| Some((s7200_key(program, block)?, Text::Statements)))).collect()
}

fn s7200_key(program: &Program, block: &s7200::Block) -> Option<BlockKey> {
    let kind = match block.kind {
        s7200::BlockKind::Main => BlockKind::Ob,
        s7200::BlockKind::Subroutine => BlockKind::Sbr,
        s7200::BlockKind::Interrupt => BlockKind::Int,
    };
    let number = block.number.map(|(number, _)| number);
    let name = block.name.as_ref().map(|(name, _)| name.as_str());
    let is_it = |known: &&plcc_model::CodeBlock| {
        known.kind == kind
            && match (kind, number) {
                (BlockKind::Ob, _) => true,
                (_, Some(number)) => u32::from(known.number) == number,
                (_, None) => name.is_some_and(|name| known.name.eq_ignore_ascii_case(name)),
            }
    };
    program.blocks.iter().find(is_it).map(plcc_model::CodeBlock::key)
}

/// What the source of a block consists of.
enum Text<'a> {
    /// STL and SCL.
    Statements,
    /// Networks of LAD and FBD, and some of STL and SCL between them.
    Networks,
    Chart(&'a Chart),
}

/// What of the places of a block counts: the binder makes more statements of networks and charts than their sources have.
struct Rules {
    /// Where contacts of drawn networks begin; by network, 0 in a chart.
    contacts: HashMap<u16, HashSet<u32>>,
    /// Networks that are text.
    text: HashSet<u16>,
    is_text: bool,
    /// Parts of a chart that are statements; parts that are text.
    actions: Vec<Span>,
    lines: Vec<Span>,
}

impl Rules {
    fn new(text: &Text<'_>, page: &Page) -> Rules {
        let mut rules = Rules {
            contacts: HashMap::new(),
            text: HashSet::new(),
            is_text: matches!(text, Text::Statements),
            actions: Vec::new(),
            lines: Vec::new(),
        };
        for section in &page.sections {
            let number = section.number as u16;
            match &section.content {
                Body::Drawing { sheet, .. } => add_contacts(sheet, rules.contacts.entry(number).or_default()),
                Body::Text(_) => {
                    rules.text.insert(number);
                }
            }
        }
        if let Text::Chart(chart) = text {
            rules.chart(chart);
        }
        rules
    }

    fn chart(&mut self, chart: &Chart) {
        for permanent in chart.before.iter().chain(&chart.after) {
            match &permanent.kind {
                PermanentKind::Coil { value, .. } => {
                    self.actions.push(permanent.span);
                    self.lines.push(value.span);
                }
                PermanentKind::Call(call) => {
                    self.actions.push(permanent.span);
                    self.lines.push(call.span);
                }
                PermanentKind::Network(_) => {}
            }
        }
        let conditions = chart.transitions.iter().filter_map(|transition| transition.condition.as_ref());
        let watched = chart.steps.iter().flat_map(|step| [&step.interlock, &step.supervision]).flatten();
        for condition in conditions.chain(watched) {
            match condition {
                Condition::Expression(value) => self.lines.push(value.span),
                Condition::Statements(list) => self.lines.extend(list.iter().map(|statement| statement.span)),
                Condition::Network(_) => {}
            }
        }
        for action in chart.steps.iter().flat_map(|step| &step.actions) {
            match &action.body {
                ActionBody::Error => continue,
                ActionBody::Call(call) => self.lines.push(call.span),
                ActionBody::Statements(list) => self.lines.extend(list.iter().map(|statement| statement.span)),
                ActionBody::Value { value, .. } => self.lines.push(value.span),
                ActionBody::Operand(_) | ActionBody::All { .. } | ActionBody::Network(_) => {}
            }
            self.actions.push(action.span);
        }
    }

    /// Whether a place is in text of the user.
    fn is_text(&self, place: &Place) -> bool {
        let inside = |span: &Span| span.start <= place.span.start && place.span.end <= span.end;
        self.is_text || place.network > 0 && self.text.contains(&place.network) || self.lines.iter().any(inside)
    }

    fn is_contact(&self, place: &Place) -> bool {
        let drawn = self.contacts.get(&place.network).is_some_and(|starts| starts.contains(&place.span.start));
        match place.probe {
            Probe::Contact => drawn || self.is_text(place),
            Probe::Condition => self.is_text(place),
            Probe::Enable => drawn && !self.is_text,
            Probe::Block
            | Probe::Registers(_)
            | Probe::Variable(_)
            | Probe::Value(_)
            | Probe::Written(_)
            | Probe::Stack(_)
            | Probe::Ran
            | Probe::Statement(_)
            | Probe::Reached
            | Probe::Formal(_) => false,
        }
    }
}

/// Where the contacts of a drawing, the inputs of its boxes and its elements are in the source.
fn add_contacts(sheet: &Sheet, starts: &mut HashSet<u32>) {
    for part in &sheet.parts {
        starts.extend(part.place);
        let is_contact = matches!(part.look, Look::Contact { .. } | Look::Compare { .. });
        for pin in part.pins.iter().filter(|pin| !pin.output && (is_contact || pin.place == sheet::Place::Side)) {
            if let Link::Operand(label) = &pin.link {
                starts.extend(label.place);
            }
        }
    }
    for source in sheet.nets.iter().flat_map(|net| &net.sources) {
        if let Source::Operand { label, .. } = source {
            starts.extend(label.place);
        }
    }
}

fn block(span: Range, page: Page, text: Text<'_>, places: &[(&Place, [u64; 2])], chart: Option<&ChartCounts>) -> Block {
    let rules = Rules::new(&text, &page);
    let mut calls = 0;
    let mut networks: BTreeMap<u16, Network> = BTreeMap::new();
    let mut statements: BTreeMap<Range, Statement> = BTreeMap::new();
    let mut contacts: BTreeMap<Range, Contact> = BTreeMap::new();
    for action in &rules.actions {
        statements.insert((action.start, action.end), Statement::default());
    }
    for (place, count) in places {
        let (network, range) = (place.network, (place.span.start, place.span.end));
        match place.probe {
            Probe::Block => calls += count[1],
            Probe::Reached => {
                if network > 0 {
                    let known = networks.entry(network).or_insert(Network { start: range.0, runs: 0 });
                    known.start = known.start.min(range.0);
                    known.runs = known.runs.max(count[0] + count[1]);
                }
                let own = match &text {
                    Text::Statements => Some(range),
                    Text::Networks => rules.is_text(place).then_some(range),
                    Text::Chart(_) => {
                        let around = |action: &&Span| action.start <= range.0 && range.1 <= action.end;
                        rules.actions.iter().find(around).map(|action| (action.start, action.end))
                    }
                };
                if let Some(range) = own {
                    let known = statements.entry(range).or_default();
                    known.runs = known.runs.max(count[1]);
                }
            }
            Probe::Contact | Probe::Condition | Probe::Enable => {
                if rules.is_contact(place) {
                    let known = contacts.entry(range).or_default();
                    known.seen = [known.seen[0] + count[0], known.seen[1] + count[1]];
                }
            }
            Probe::Registers(_)
            | Probe::Variable(_)
            | Probe::Value(_)
            | Probe::Written(_)
            | Probe::Stack(_)
            | Probe::Ran
            | Probe::Statement(_)
            | Probe::Formal(_) => {}
        }
    }
    let (mut steps, mut transitions) = (Vec::new(), Vec::new());
    if let (Text::Chart(source), Some(counts)) = (&text, chart) {
        let named = |name: &str, number: u32, letter: char, start: u32, runs: u64| {
            let name = if name.is_empty() { format!("{letter}{number}") } else { name.to_string() };
            Named { name, start, runs }
        };
        let of_steps = source.steps.iter().zip(&counts.active);
        steps.extend(of_steps.map(|(s, runs)| named(&s.name.text, s.number, 'S', s.span.start, *runs)));
        let of_transitions = source.transitions.iter().zip(&counts.switched);
        transitions.extend(of_transitions.map(|(t, runs)| named(&t.name.text, t.number, 'T', t.span.start, *runs)));
    }
    let (id, name) = (page.id.clone(), page.name.clone());
    Block { id, name, span, calls, networks, statements, contacts, steps, transitions, page }
}
