//! A block with what its statements see, as lines.

use crate::document::{Code, Page, Section};
use crate::drawing::Drawing;
use crate::forcing::Forcing;
use crate::listing::{self, Listing};
use crate::messages::{Activation, Order, StatusNews, Step};
use crate::row::{Row, Tone, clock, piece};
use crate::status::{Place, Status};

/// The block that is shown.
pub struct Block {
    page: Page,
    /// Its networks; they are made when it is known what the program tells of them.
    contents: Vec<Content>,
    status: Status,
    forcing: Forcing,
    /// The call to be shown; `None`: the first one in a cycle.
    call: Option<String>,
    /// Statements that can be drawn are shown as networks.
    networks: bool,
    /// Number of the order whose answers are shown; 0: of none.
    turn: u64,
    /// What is known of its status.
    pub note: String,
    pub rows: Vec<Row>,
}

/// What a network shows.
enum Content {
    Lines(Listing),
    Drawing(Drawing),
}

impl Block {
    /// A block of which no status is known. `networks`: show statements that can be drawn as networks; `note`: why it has no status.
    pub fn new(page: Page, forcing: Forcing, networks: bool, note: &str) -> Block {
        let mut block = Block {
            page,
            contents: Vec::new(),
            status: Status::default(),
            forcing,
            call: None,
            networks,
            turn: 0,
            note: note.to_string(),
            rows: Vec::new(),
        };
        block.fill(Vec::new());
        block
    }

    /// `FB1`
    pub fn key(&self) -> String {
        self.page.key()
    }

    /// `FB 1 Counting, LAD`
    pub fn title(&self) -> String {
        let Page { language, title, .. } = &self.page;
        let title = if title.is_empty() { String::new() } else { format!(", {title}") };
        format!("{}, {language}{title}", self.page.label())
    }

    /// The places where the program tells something have come.
    pub fn fill(&mut self, places: Vec<Place>) {
        self.status = Status::new(places);
        self.compose();
    }

    /// It has statements that can be shown as networks.
    pub fn has_both(&self) -> bool {
        self.page.sections.iter().any(|section| section.code.is_some() && section.svg.is_some())
    }

    /// Shows statements that can be drawn as networks, or as statements.
    pub fn show_networks(&mut self, networks: bool) {
        self.networks = networks;
        self.compose();
    }

    /// Makes the networks.
    fn compose(&mut self) {
        let is_text = |section: &Section| !self.networks || section.svg.is_none();
        let lines = |section: &Section| section.lines().filter(|_| is_text(section));
        let codes: Vec<Option<Code>> = self.page.sections.iter().map(lines).collect();
        let width = listing::width(codes.iter().flatten());
        let content = |(section, code): (&Section, &Option<Code>)| match code {
            Some(code) => Content::Lines(Listing::new(code, &self.status, &self.page.symbols, width)),
            None => Content::Drawing(Drawing::new(section.svg.as_deref().unwrap_or_default(), section.logic.as_ref())),
        };
        self.contents = self.page.sections.iter().zip(&codes).map(content).collect();
        self.make();
    }

    /// The line with which a network begins.
    pub fn line_of(&self, network: usize) -> Option<usize> {
        let title = format!("Network {network}");
        let is_title =
            |text: &str| text.strip_prefix(&title).is_some_and(|rest| rest.is_empty() || rest.starts_with(':'));
        self.rows
            .iter()
            .position(|row| row.first().is_some_and(|piece| piece.tone == Tone::Title && is_title(&piece.text)))
    }

    /// What comes until the block is asked for again belongs to another program.
    pub fn wait(&mut self) {
        self.turn = 0;
    }

    /// Asks for the status of the call to be shown.
    pub fn ask(&mut self, turn: u64) -> Order {
        self.turn = turn;
        Order::Status { block: Some(self.key()), call: self.call.clone(), turn }
    }

    /// Chooses the next of the calls. False: there is only one.
    pub fn next_call(&mut self) -> bool {
        let calls = &self.status.calls;
        if calls.len() < 2 && self.call.is_none() {
            return false;
        }
        let at = calls.iter().position(|call| Some(call) == self.call.as_ref());
        // After the last one the first one in a cycle.
        self.call = calls.get(at.map_or(0, |at| at + 1)).cloned();
        self.status.forget();
        self.note = "not called since then".to_string();
        self.make();
        true
    }

    /// These operands are forced.
    pub fn force(&mut self, forcing: Forcing) {
        self.forcing = forcing;
        self.make();
    }

    /// What the program tells.
    pub fn take(&mut self, news: StatusNews) {
        if news.turn != self.turn {
            return;
        }
        self.status.take(news);
        if let Some((call, cycle)) = self.status.call {
            let call = self.status.calls.get(call).map_or("", String::as_str);
            self.note = format!("{call} in cycle {cycle}");
            if self.status.calls.len() > 1 && self.call.is_none() {
                self.note.push_str(&format!(", the first of {} calls", self.status.calls.len()));
            }
        }
        self.make();
    }

    /// The lines as they are now.
    fn make(&mut self) {
        let mut rows = steps(&self.status.steps);
        rows.extend(history(&self.status.history));
        for (section, content) in self.page.sections.iter().zip(&self.contents) {
            let title = match (section.number, section.title.as_str()) {
                (0, title) => title.to_string(),
                (number, "") => format!("Network {number}"),
                (number, title) => format!("Network {number}: {title}"),
            };
            if !title.is_empty() {
                rows.push(vec![piece(title, Tone::Title)]);
            }
            if !section.labels.is_empty() {
                rows.push(vec![piece(format!("{}:", section.labels.join(", ")), Tone::Note)]);
            }
            rows.extend(match content {
                Content::Lines(listing) => listing.rows(&self.status, &self.forcing),
                Content::Drawing(drawing) => drawing.rows(&self.status, &self.forcing),
            });
            rows.push(Row::new());
        }
        if rows.last().is_some_and(Vec::is_empty) {
            rows.pop();
        }
        self.rows = rows;
    }
}

/// The active steps of a chart with their times, and those that were left with a fault.
fn steps(all: &[Step]) -> Vec<Row> {
    let shown: Vec<&Step> = all.iter().filter(|step| step.active || step.faulty).collect();
    if shown.is_empty() {
        return Vec::new();
    }
    let width = shown.iter().map(|step| step.step.chars().count()).max().unwrap_or(0).clamp(4, 40);
    let seconds = |ms: Option<i32>| ms.map_or_else(String::new, |ms| format!("{:.1} s", f64::from(ms) / 1000.0));
    let row = |step: &&Step| {
        let left = if step.active { "" } else { "left  " };
        let interlock = if step.interlocked { "interlock not satisfied  " } else { "" };
        let fault = if step.faulty { "supervision fault" } else { "" };
        let line = format!("{:width$}  {:>10}  {:>10}  ", step.step, seconds(step.t_ms), seconds(step.u_ms));
        let text = format!("{line}{left}{interlock}{fault}");
        let tone = match (step.faulty, step.active) {
            (true, _) => Tone::Faulty,
            (false, true) => Tone::On,
            (false, false) => Tone::Plain,
        };
        vec![piece(text.trim_end(), tone)]
    };
    let head = format!("{:width$}  {:>10}  {:>10}", "Step", "T", "U");
    let mut rows = vec![vec![piece(head, Tone::Title)]];
    rows.extend(shown.iter().map(row));
    rows.push(Row::new());
    rows
}

/// Steps of the history that are shown: the page has more of them.
const HISTORY_MAX: usize = 5;

/// The steps that became active last.
fn history(all: &[Activation]) -> Vec<Row> {
    if all.is_empty() {
        return Vec::new();
    }
    let shown = &all[..all.len().min(HISTORY_MAX)];
    let width = shown.iter().map(|one| one.step.chars().count()).max().unwrap_or(0).clamp(7, 40);
    let row = |one: &Activation| {
        let time = one.active_ms.map_or("active".to_string(), |ms| format!("{:.3} s", ms as f64 / 1000.0));
        let line = format!("{:width$}  {}  {time:>12}", one.step, clock(one.clock_ms));
        vec![piece(line, Tone::Plain)]
    };
    let head = format!("{:width$}  {:12}  {:>12}", "History", "Active from", "For");
    let mut rows = vec![vec![piece(head, Tone::Title)]];
    rows.extend(shown.iter().map(row));
    rows.push(Row::new());
    rows
}
