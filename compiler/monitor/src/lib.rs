//! A running CPU in a terminal: state, blocks with their status, values, watch table, diagnostic buffer, over the page's connection.
//!
//! - [`model`]: what is known and shown, and what keys do; [`tree`](mod@tree): the lines of its tree.
//! - [`block`]: an open block as lines. [`status`]: what its statements see; [`listing`]: that beside its text; [`drawing`]: that in its
//!   networks and charts, whose [`picture`] has the [`flow`](mod@flow) of power; [`forcing`]: which operands are forced.
//! - [`draw`]: the picture of the model; [`row`]: lines in pieces that look alike.
//! - [`messages`]: what the connection tells, as JSON; [`document`]: the blocks of the program.
//! - [`connection`]: the thread that speaks with the CPU, and starts again when the connection is lost.
//!
//! **Invariant**: the model knows neither terminal nor network.

pub mod block;
pub mod connection;
pub mod document;
pub mod draw;
pub mod drawing;
pub mod flow;
pub mod forcing;
pub mod listing;
pub mod messages;
pub mod model;
pub mod picture;
pub mod row;
pub mod status;
pub mod tree;

#[cfg(test)]
mod tests;

use std::time::Duration;

use connection::Connection;
use model::Model;
use plcc_services::client::Process;
pub use ratatui::crossterm::event::KeyCode;
use ratatui::crossterm::event::{self, Event, KeyEventKind, KeyModifiers};

/// How long the terminal waits for a key before it looks for news.
const PAUSE: Duration = Duration::from_millis(50);

/// Shows the CPU until the user leaves. `watched`: names in the watch table at first. `Err`: the terminal does not work.
pub fn run(process: Process, session: Option<String>, watched: Vec<String>) -> std::io::Result<()> {
    let mut model = Model::new(&process.address().to_string(), watched);
    let connection = Connection::open(process, session);
    let mut terminal = ratatui::try_init()?;
    let outcome = show(&mut terminal, &mut model, &connection);
    ratatui::restore();
    outcome
}

/// Gives the model what has come, and the CPU what the model orders.
pub fn exchange(model: &mut Model, connection: &Connection) {
    connection.take().for_each(|message| model.take(message));
    model.orders().for_each(|order| connection.send(order));
    model.wanted().for_each(|wanted| connection.fetch(wanted));
}

fn show(terminal: &mut ratatui::DefaultTerminal, model: &mut Model, connection: &Connection) -> std::io::Result<()> {
    while !model.is_over() {
        exchange(model, connection);
        terminal.draw(|frame| draw::draw(model, frame))?;
        if event::poll(PAUSE)?
            && let Event::Key(key) = event::read()?
            && key.kind == KeyEventKind::Press
        {
            match key.modifiers.contains(KeyModifiers::CONTROL) {
                true => model.control(key.code),
                false => model.key(key.code),
            }
        }
    }
    Ok(())
}
