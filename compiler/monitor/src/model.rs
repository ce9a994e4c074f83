//! What is known about the CPU, which part of it is shown, and what keys do.
//!
//! - [`blocks`]: the block that is open.

mod blocks;

use std::collections::BTreeMap;

use crate::block::Block;
use crate::document::Page;
use crate::messages::{Change, Entry, Forced, Hello, News, Order, Shown, State};
use crate::tree::{Node, tree};
use plcc_abi::services::Role;
use ratatui::crossterm::event::KeyCode;

use crate::connection::Incoming;

/// The parts of the screen that take keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The blocks of the program and its values.
    Program,
    /// The watch table.
    Watch,
    Diagnostics,
    /// The block that is open, in the place of all others.
    Block,
}

/// What is to be fetched.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// A watch table of the project.
    Table(String),
    /// The places where a block tells what it sees.
    Places(String),
    /// Names and blocks of the program, which has changed.
    Program,
}

/// What the line at the bottom asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asks {
    /// Part of a name.
    Search,
    /// A name for the watch table.
    Name,
    /// A new value of the row.
    Modify,
    /// A value that the row has from now on.
    Force,
    /// Whether the CPU is to go to STOP, to RUN: `y`; to RUN by a cold restart: `c`.
    Stop,
    Run,
    /// Whether the outputs are to be enabled in STOP, the memory to be reset: `y`.
    Outputs,
    Reset,
}

/// See the module comment.
pub struct Model {
    pub address: String,
    pub hello: Option<Hello>,
    pub state: State,
    /// Why there is no connection; `None`: there is one.
    pub lost: Option<String>,
    /// Names with their types.
    names: Vec<(String, String)>,
    /// The blocks.
    pages: Vec<Page>,
    /// The block that is open.
    pub block: Option<Block>,
    /// Number of the last order for the status of a block.
    turn: u64,
    /// Columns at the left of the block that are not shown.
    pub aside: usize,
    /// Statements of blocks are shown as networks where they can be drawn.
    pub networks: bool,
    /// The network with which it is to begin, until its status comes.
    network: Option<usize>,
    open: Vec<String>,
    pub search: String,
    pub tree: Vec<Node>,
    pub watched: Vec<String>,
    /// Number of this list: what comes for an earlier one is not shown.
    list: u64,
    /// How often the program had changed when its names and blocks were fetched.
    generation: Option<u64>,
    /// Formats of watched names, where a table has them.
    formats: BTreeMap<String, String>,
    /// Modify values of watched names, of a table or as they were entered.
    pub entered: BTreeMap<String, String>,
    /// The watch tables of the project.
    tables: Vec<String>,
    /// The one that is shown.
    pub table: Option<String>,
    /// The last one that was asked for.
    asked: Option<String>,
    wanted: Vec<Wanted>,
    pub values: BTreeMap<String, Result<Shown, String>>,
    pub forced: Vec<Forced>,
    pub buffer: Vec<Entry>,
    pub part: Part,
    /// The row with the cursor, of each part.
    at: [usize; 4],
    pub asks: Option<(Asks, String)>,
    /// Why an order was not carried out.
    pub refused: String,
    orders: Vec<Order>,
    over: bool,
}

impl Model {
    pub fn new(address: &str, watched: Vec<String>) -> Model {
        Model {
            address: address.to_string(),
            hello: None,
            state: State::default(),
            lost: Some("connecting".to_string()),
            names: Vec::new(),
            pages: Vec::new(),
            block: None,
            turn: 0,
            aside: 0,
            networks: false,
            network: None,
            open: Vec::new(),
            search: String::new(),
            tree: Vec::new(),
            part: if watched.is_empty() { Part::Program } else { Part::Watch },
            watched,
            list: 0,
            generation: None,
            formats: BTreeMap::new(),
            entered: BTreeMap::new(),
            tables: Vec::new(),
            table: None,
            asked: None,
            wanted: Vec::new(),
            values: BTreeMap::new(),
            forced: Vec::new(),
            buffer: Vec::new(),
            at: [0; 4],
            asks: None,
            refused: String::new(),
            orders: Vec::new(),
            over: false,
        }
    }

    /// The user leaves.
    pub fn is_over(&self) -> bool {
        self.over
    }

    /// What the CPU is to do, each once.
    pub fn orders(&mut self) -> impl Iterator<Item = Order> {
        std::mem::take(&mut self.orders).into_iter()
    }

    pub fn role(&self) -> Role {
        self.hello.as_ref().map_or(Role::Look, |hello| hello.role)
    }

    /// The CPU has a cold restart besides the warm one.
    pub fn has_cold_restart(&self) -> bool {
        self.hello.as_ref().is_some_and(|hello| hello.has_cold)
    }

    /// What is to be fetched, each once.
    pub fn wanted(&mut self) -> impl Iterator<Item = Wanted> {
        std::mem::take(&mut self.wanted).into_iter()
    }

    /// The project has watch tables.
    pub fn has_tables(&self) -> bool {
        !self.tables.is_empty()
    }

    /// The row with the cursor.
    pub fn row(&self, part: Part) -> usize {
        self.at[part as usize]
    }

    /// Takes what has come.
    pub fn take(&mut self, incoming: Incoming) {
        match incoming {
            Incoming::Connected(names, tables) => {
                // The state that is known is from the earlier connection, if there is one.
                if let Some(why) = &mut self.lost {
                    *why = "waiting for the CPU".to_string();
                }
                self.tables = tables;
                self.generation = None;
                self.wanted.clear();
                self.names = names.into_iter().map(|one| (one.name, one.ty)).collect();
                self.grow();
                self.watch();
            }
            Incoming::Names(names) => {
                self.names = names.into_iter().map(|one| (one.name, one.ty)).collect();
                self.grow();
            }
            Incoming::Program(Ok(pages)) => {
                self.pages = pages;
                self.grow();
                self.open_again();
            }
            Incoming::Program(Err(why)) => self.refused = why,
            Incoming::Places(key, places) => self.places(&key, places),
            Incoming::Table(name, tables, Ok(sheet)) => {
                self.close_block();
                self.tables = tables;
                self.formats.clear();
                self.entered.clear();
                self.watched.clear();
                for row in sheet.row {
                    // The values of a name come once.
                    if self.watched.contains(&row.address) {
                        continue;
                    }
                    self.formats.extend(row.format.map(|format| (row.address.clone(), format)));
                    self.entered.extend(row.modify.map(|value| (row.address.clone(), value)));
                    self.watched.push(row.address);
                }
                self.table = Some(name);
                self.part = Part::Watch;
                self.go(0);
                self.watch();
            }
            Incoming::Table(_, tables, Err(why)) => (self.tables, self.refused) = (tables, why),
            Incoming::Lost(why) => self.lost = Some(why),
            Incoming::News(news) => self.news(*news),
        }
    }

    fn news(&mut self, news: News) {
        let News { hello, state, list, values, wrong, buffer, forced, status, refused } = news;
        self.hello = hello.or(self.hello.take());
        if let Some(state) = state {
            // Another program has other names and blocks.
            if self.generation.replace(state.generation).is_some_and(|before| before != state.generation) {
                self.wanted.push(Wanted::Program);
                self.block.iter_mut().for_each(Block::wait);
            }
            self.state = state;
            self.lost = None;
        }
        if let (Some(block), Some(status)) = (&mut self.block, status) {
            block.take(status);
        }
        if list == Some(self.list) {
            let values = values.into_iter().map(|(number, shown)| (number, Ok(shown)));
            let wrong = wrong.into_iter().map(|(number, why)| (number, Err(why)));
            for (number, shown) in values.chain(wrong) {
                if let Some(name) = self.watched.get(number) {
                    self.values.insert(name.clone(), shown);
                }
            }
        }
        if let Some(buffer) = buffer {
            self.buffer = buffer;
        }
        if let Some(forced) = forced {
            self.forced = forced;
            let forcing = self.forcing();
            self.block.iter_mut().for_each(|block| block.force(forcing.clone()));
        }
        if let Some(refused) = refused {
            self.refused = refused;
        }
    }

    /// The CPU tells the values of the watch table from now on.
    fn watch(&mut self) {
        self.values.clear();
        let formats = match self.formats.is_empty() {
            true => Vec::new(),
            false => self.watched.iter().map(|name| self.formats.get(name).cloned()).collect(),
        };
        self.list += 1;
        self.orders.push(Order::Watch { names: self.watched.clone(), formats, number: self.list });
    }

    /// Makes the tree.
    fn grow(&mut self) {
        self.tree = tree(&self.pages, &self.names, &self.search, &self.open);
        self.at[Part::Program as usize] = self.row(Part::Program).min(self.tree.len().saturating_sub(1));
    }

    /// A key was pressed together with Ctrl. Terminals send Ctrl+H for the key that deletes to the left.
    pub fn control(&mut self, key: KeyCode) {
        match key {
            KeyCode::Char('c') => self.over = true,
            KeyCode::Char('h') => self.key(KeyCode::Backspace),
            _ => {}
        }
    }

    /// A key was pressed.
    pub fn key(&mut self, key: KeyCode) {
        if self.asks.is_some() {
            self.answer(key);
            return;
        }
        self.refused.clear();
        if self.part == Part::Block && self.key_in_block(key) {
            return;
        }
        match key {
            KeyCode::Esc if !self.search.is_empty() => {
                self.search.clear();
                self.grow();
            }
            KeyCode::Char('q') | KeyCode::Esc => self.over = true,
            KeyCode::Tab => {
                self.part = match self.part {
                    Part::Program => Part::Watch,
                    Part::Watch => Part::Diagnostics,
                    Part::Diagnostics | Part::Block => Part::Program,
                };
            }
            KeyCode::Up => self.go(-1),
            KeyCode::Down => self.go(1),
            KeyCode::PageUp => self.go(-10),
            KeyCode::PageDown => self.go(10),
            KeyCode::Char('S' | 'R' | 'O' | 'C') if !self.may(Role::Change) => {}
            KeyCode::Char('S') => self.asks = Some((Asks::Stop, String::new())),
            KeyCode::Char('R') => self.asks = Some((Asks::Run, String::new())),
            // It is the safe side, so nothing is asked.
            KeyCode::Char('O') if self.state.outputs => self.orders.push(Order::Outputs { enable: false }),
            KeyCode::Char('O') => self.asks = Some((Asks::Outputs, String::new())),
            KeyCode::Char('C') => self.asks = Some((Asks::Reset, String::new())),
            KeyCode::Char('t') => {
                let at = self.tables.iter().position(|table| Some(table) == self.asked.as_ref());
                let next = at.map_or(0, |at| (at + 1) % self.tables.len());
                self.asked = self.tables.get(next).cloned();
                self.wanted.extend(self.asked.clone().map(Wanted::Table));
            }
            KeyCode::Char('a') => self.asks = Some((Asks::Name, String::new())),
            _ => match self.part {
                Part::Program => self.key_in_program(key),
                Part::Watch => self.key_in_watch(key),
                Part::Diagnostics => self.key_in_diagnostics(key),
                Part::Block => {}
            },
        }
    }

    /// Whether the user has the role that a key needs; if not, the line at the bottom says so.
    fn may(&mut self, needed: Role) -> bool {
        let may = self.role() >= needed;
        if !may {
            let roles = if needed == Role::Change { "`change`" } else { "`operate` or `change`" };
            self.refused = format!("only a user with the role {roles} may do this: sign in with --user NAME");
        }
        may
    }

    fn key_in_program(&mut self, key: KeyCode) {
        match key {
            KeyCode::Char('/') => self.asks = Some((Asks::Search, self.search.clone())),
            KeyCode::Enter | KeyCode::Char(' ') => {
                let Some(node) = self.tree.get(self.row(Part::Program)).cloned() else { return };
                if let Some(page) = node.block.and_then(|number| self.pages.get(number)).cloned() {
                    (self.at[Part::Block as usize], self.aside, self.network) = (0, 0, None);
                    return self.open_block(page);
                }
                match node.open {
                    Some(true) => self.open.retain(|path| *path != node.path),
                    Some(false) => self.open.push(node.path),
                    None => return self.add(node.path),
                }
                self.grow();
            }
            _ => {}
        }
    }

    fn key_in_watch(&mut self, key: KeyCode) {
        let at = self.row(Part::Watch);
        let Some(name) = self.watched.get(at).cloned() else { return };
        match key {
            KeyCode::Char('m' | 'M') if !self.may(Role::Operate) => {}
            KeyCode::Char('f' | 'u') if !self.may(Role::Change) => {}
            KeyCode::Char('m') => {
                self.asks = Some((Asks::Modify, self.entered.get(&name).cloned().unwrap_or_default()));
            }
            KeyCode::Char('M') => self.modify_all(),
            KeyCode::Char('f') => self.asks = Some((Asks::Force, String::new())),
            KeyCode::Char('u') => self.orders.push(Order::Unforce { name: Some(name) }),
            KeyCode::Char('d') | KeyCode::Delete => {
                self.watched.remove(at);
                self.entered.remove(&name);
                self.go(0);
                self.watch();
            }
            _ => {}
        }
    }

    /// All rows get their modify values, once, as `modify all now` of the page does.
    fn modify_all(&mut self) {
        let change = |name: &String| Some(self.change(name.clone(), self.entered.get(name)?.clone()));
        let rows: Vec<Change> = self.watched.iter().filter_map(change).collect();
        match rows.is_empty() {
            true => self.refused = "no row has a modify value".to_string(),
            false => self.orders.push(Order::All { rows }),
        }
    }

    /// A value as it was entered: in the format of the row; an address without a declared type is written as it is shown, hexadecimal.
    fn change(&self, name: String, value: String) -> Change {
        let is_untyped =
            |shown: &Shown| shown.bits > 0 && matches!(shown.ty.as_str(), "BYTE" | "WORD" | "DWORD" | "LWORD");
        let shown = self.values.get(&name).and_then(|shown| shown.as_ref().ok());
        let usual = || shown.is_some_and(is_untyped).then(|| "hex".to_string());
        let format = self.formats.get(&name).cloned().or_else(usual);
        Change { name, value, format }
    }

    /// A value becomes a row of the watch table.
    fn add(&mut self, name: String) {
        if !self.watched.contains(&name) {
            self.watched.push(name);
            self.watch();
        }
    }

    fn go(&mut self, rows: isize) {
        let count = match self.part {
            Part::Program => self.tree.len(),
            Part::Watch => self.watched.len(),
            Part::Diagnostics => self.buffer.len(),
            Part::Block => self.block.as_ref().map_or(0, |block| block.rows.len()),
        };
        let at = &mut self.at[self.part as usize];
        *at = at.saturating_add_signed(rows).min(count.saturating_sub(1));
    }

    /// A key for the line at the bottom.
    fn answer(&mut self, key: KeyCode) {
        let Some((asks, mut text)) = self.asks.take() else { return };
        match key {
            KeyCode::Esc => return,
            KeyCode::Enter => return self.answered(asks, text.trim().to_string()),
            KeyCode::Backspace => drop(text.pop()),
            KeyCode::Char(letter) => text.push(letter),
            _ => {}
        }
        self.asks = Some((asks, text));
    }

    fn answered(&mut self, asks: Asks, text: String) {
        let name = self.watched.get(self.row(Part::Watch)).cloned();
        match (asks, name) {
            (Asks::Search, _) => {
                self.search = text;
                self.grow();
            }
            (Asks::Run, _) if self.has_cold_restart() && text.eq_ignore_ascii_case("c") => {
                self.orders.push(Order::Run { restart: "cold".to_string() });
            }
            (Asks::Stop | Asks::Run | Asks::Outputs | Asks::Reset, _) if !text.eq_ignore_ascii_case("y") => {}
            (Asks::Stop, _) => self.orders.push(Order::Stop),
            (Asks::Run, _) => self.orders.push(Order::Run { restart: "warm".to_string() }),
            (Asks::Outputs, _) => self.orders.push(Order::Outputs { enable: true }),
            (Asks::Reset, _) => self.orders.push(Order::Reset),
            (Asks::Modify, Some(name)) if text.is_empty() => {
                self.entered.remove(&name);
            }
            (_, _) if text.is_empty() => {}
            (Asks::Name, _) => self.add(text),
            (Asks::Modify, Some(name)) => {
                self.entered.insert(name.clone(), text.clone());
                let change = self.change(name, text);
                self.orders.push(Order::Modify(change));
            }
            (Asks::Force, Some(name)) => {
                let change = self.change(name, text);
                self.orders.push(Order::Force(change));
            }
            (Asks::Modify | Asks::Force, None) => {}
        }
    }
}
