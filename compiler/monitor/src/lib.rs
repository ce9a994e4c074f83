//! A running CPU in a terminal: state, values, watch table, diagnostic buffer, over the page's connection.
//!
//! - [`model`]: what is known and shown, and what keys do.
//! - [`draw`]: the picture of it.
//! - [`messages`]: what the connection tells, as JSON.
//! - [`connection`]: the thread that speaks with the CPU, and starts again when the connection is lost.
//!
//! **Invariant**: the model knows neither terminal nor network.

pub mod connection;
pub mod draw;
pub mod messages;
pub mod model;

#[cfg(test)]
mod tests;

use std::time::Duration;

use connection::Connection;
use model::Model;
use plcc_services::client::Process;
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

fn show(terminal: &mut ratatui::DefaultTerminal, model: &mut Model, connection: &Connection) -> std::io::Result<()> {
    while !model.is_over() {
        connection.take().for_each(|message| model.take(message));
        model.orders().for_each(|order| connection.send(order));
        if let Some(table) = model.wanted() {
            connection.fetch(table);
        }
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
