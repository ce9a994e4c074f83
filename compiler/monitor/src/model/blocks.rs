//! The block that is open: where its status comes from, and what keys do there.

use ratatui::crossterm::event::KeyCode;

use super::{Model, Part, Wanted};
use crate::block::Block;
use crate::document::Page;
use crate::forcing::Forcing;
use crate::messages::Order;
use crate::status::Place;

/// Columns of a block that can be passed at its left.
const ASIDE_MAX: usize = 1_000;

impl Model {
    /// Opens a block, and asks for its status.
    pub(super) fn open_block(&mut self, page: Page) {
        let is_watchable = self.hello.as_ref().is_none_or(|hello| hello.watchable);
        let note = match is_watchable {
            true => "not called so far",
            false => "without status: the program was built with --no-monitor",
        };
        if is_watchable {
            self.wanted.push(Wanted::Places(page.key()));
        }
        self.block = Some(Block::new(page, self.forcing(), self.networks, note));
        self.part = Part::Block;
    }

    pub(super) fn forcing(&self) -> Forcing {
        let modules = self.hello.as_ref().is_some_and(|hello| hello.force_modules);
        Forcing::new(self.forced.iter().map(|forced| forced.address.as_str()), modules)
    }

    /// The open block has changed, or the connection is a new one.
    pub(super) fn open_again(&mut self) {
        let Some(key) = self.block.as_ref().map(Block::key) else { return };
        match self.pages.iter().find(|page| page.key() == key).cloned() {
            Some(page) => self.open_block(page),
            None => {
                self.close_block();
                self.refused = format!("the program has no block {key} now");
            }
        }
    }

    pub(super) fn close_block(&mut self) {
        if self.block.take().is_some() {
            self.orders.push(Order::Status { block: None, call: None, turn: 0 });
            self.part = Part::Program;
        }
    }

    /// The places of a block have come, if it is still open.
    pub(super) fn places(&mut self, key: &str, places: Result<Vec<Place>, String>) {
        let Some(block) = self.block.as_mut().filter(|block| block.key() == key) else { return };
        match places {
            Ok(places) => {
                block.fill(places);
                self.turn += 1;
                self.orders.push(block.ask(self.turn));
                // There are other lines above it.
                if self.network.is_some() {
                    self.go_to_network();
                    self.network = None;
                }
            }
            Err(why) => block.note = why,
        }
    }

    /// The block in which the event with the cursor was, and its network.
    pub fn event(&self) -> Option<(&Page, Option<usize>)> {
        let place = self.buffer.get(self.row(Part::Diagnostics))?.place.as_str();
        let mut blocks = self.pages.iter().filter(|page| page.has_code());
        let (page, rest) = blocks.find_map(|page| Some((page, after_block(place, &page.id)?)))?;
        let word = rest.split(", ").next().unwrap_or_default();
        Some((page, word.strip_prefix("network ").and_then(|number| number.parse().ok())))
    }

    pub(super) fn key_in_diagnostics(&mut self, key: KeyCode) {
        let Some((page, network)) = self.event().filter(|_| key == KeyCode::Enter) else { return };
        let page = page.clone();
        (self.network, self.aside) = (network, 0);
        self.open_block(page);
        self.go_to_network();
    }

    /// Moves the block so that the network that was asked for is at the top.
    fn go_to_network(&mut self) {
        let line = self.block.as_ref().zip(self.network).and_then(|(block, network)| block.line_of(network));
        self.at[Part::Block as usize] = line.unwrap_or(0);
    }

    /// A key in an open block. False: it means the same as elsewhere.
    pub(super) fn key_in_block(&mut self, key: KeyCode) -> bool {
        match key {
            KeyCode::Esc | KeyCode::Enter | KeyCode::Backspace | KeyCode::Tab => self.close_block(),
            KeyCode::Left => self.aside = self.aside.saturating_sub(8),
            KeyCode::Right => self.aside = (self.aside + 8).min(ASIDE_MAX),
            KeyCode::Home => (self.at[Part::Block as usize], self.aside) = (0, 0),
            KeyCode::Char('c') => {
                if let Some(block) = &mut self.block
                    && block.next_call()
                {
                    self.turn += 1;
                    self.orders.push(block.ask(self.turn));
                }
            }
            KeyCode::Char('v') => {
                if let Some(block) = self.block.as_mut().filter(|block| block.has_both()) {
                    self.networks = !self.networks;
                    block.show_networks(self.networks);
                    (self.at[Part::Block as usize], self.aside) = (0, 0);
                }
            }
            KeyCode::Up | KeyCode::Down | KeyCode::PageUp | KeyCode::PageDown => return false,
            KeyCode::Char('q' | 'S' | 'R' | 'O' | 'C') => return false,
            _ => {}
        }
        true
    }
}

/// What follows the block in a place, if it is that with the `id`: `FC 2, network 2, words.stl:23`, `Fill (FC 2), network 2, words.scl:23`.
fn after_block<'a>(place: &'a str, id: &str) -> Option<&'a str> {
    let rest = match place.strip_prefix(id) {
        Some(rest) => rest,
        None => place.split_once(&format!(" ({id})"))?.1,
    };
    if rest.is_empty() { Some(rest) } else { rest.strip_prefix(", ") }
}
