//! What `plcc monitor` shows of a program that is watched while it runs.

use std::net::{Ipv4Addr, SocketAddr};
use std::time::Duration;

use libtest_mimic::Failed;
use plcc_monitor::KeyCode;
use plcc_monitor::connection::Connection;
use plcc_monitor::model::Model;
use plcc_monitor::row::{Row, Tone};
use plcc_services::client::Process;

use crate::here;
use crate::process::{Plc, free_port, plcc};

/// A terminal without a screen.
struct Terminal {
    model: Model,
    connection: Connection,
}

impl Terminal {
    /// Waits for what the CPU tells.
    fn until(&mut self, what: &str, has: impl Fn(&Model) -> bool) -> Result<(), Failed> {
        for _ in 0..200 {
            plcc_monitor::exchange(&mut self.model, &self.connection);
            if has(&self.model) {
                return Ok(());
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        let lines: Vec<String> = rows(&self.model).map(text).collect();
        Err(format!("{what} did not come:\n{}\n{}", lines.join("\n"), self.model.refused).into())
    }

    fn keys(&mut self, keys: &[KeyCode]) {
        keys.iter().for_each(|key| self.model.key(*key));
    }

    /// Searches a block in the tree, and opens it. The first line that is found is the branch of the blocks.
    fn open(&mut self, block: &str) {
        self.keys(&[KeyCode::Char('/')]);
        // What was searched before.
        self.keys(&[KeyCode::Backspace; 10]);
        block.chars().for_each(|letter| self.model.key(KeyCode::Char(letter)));
        self.keys(&[KeyCode::Enter, KeyCode::PageUp, KeyCode::Down, KeyCode::Enter]);
    }
}

fn rows(model: &Model) -> impl Iterator<Item = &Row> {
    model.block.iter().flat_map(|block| &block.rows)
}

fn text(row: &Row) -> String {
    row.iter().map(|piece| piece.text.as_str()).collect()
}

/// A line of the block has all these parts.
fn has_line(model: &Model, parts: &[&str]) -> bool {
    rows(model).map(text).any(|line| parts.iter().all(|part| line.contains(part)))
}

/// Something of the block is shown as `tone` says.
fn has_part(model: &Model, tone: Tone, part: &str) -> bool {
    rows(model).flatten().any(|piece| piece.tone == tone && piece.text.contains(part))
}

/// Opens blocks of all languages.
pub fn status() -> Result<(), Failed> {
    let (folder, port) = (tempfile::tempdir()?, free_port());
    let out = folder.path().join("watched");
    plcc(&["build", "--quiet"], &[&here().join("status")], &out)?;
    let plc = Plc::run(&out, &["--web", &port.to_string(), "--set", "I0.0=1"])?;
    let address = SocketAddr::from((Ipv4Addr::LOCALHOST, port));
    let connection = Connection::open(Process::new(address, None)?, None);
    let mut terminal = Terminal { model: Model::new("", Vec::new()), connection };
    terminal.until("the blocks", |model| model.tree.first().is_some_and(|node| node.label == "Blocks"))?;

    // M0.0 is 1 between two networks only.
    terminal.open("OB1");
    terminal.until("power at the lamp", |model| has_part(model, Tone::On, "┤ ├─────┤/├───────"))?;
    terminal.keys(&[KeyCode::Esc]);

    // One of two instances.
    terminal.open("FB1");
    terminal.until("the sum of the first instance", |model| has_part(model, Tone::Value, "6"))?;
    terminal
        .until("both calls", |model| model.block.as_ref().is_some_and(|block| block.note.contains("of 2 calls")))?;
    terminal.keys(&[KeyCode::Char('c'), KeyCode::Char('c')]);
    terminal.until("the sum of the other one", |model| has_part(model, Tone::Value, "105"))?;
    terminal.until("its name", |model| {
        model.block.as_ref().is_some_and(|block| block.note.contains("DB 2 \"Second\" in cycle"))
    })?;
    terminal.keys(&[KeyCode::Esc]);

    terminal.open("FC2");
    terminal.until("ACCU1 after the first statement", |model| has_line(model, &["L     W#16#1234;", " 00001234 "]))?;
    terminal.until("the RLO of the input", |model| has_line(model, &["A     I 0.0;", " 1   1   "]))?;
    terminal.keys(&[KeyCode::Esc]);

    terminal.open("FC1");
    terminal
        .until("a value before it changes", |model| has_line(model, &["IF #level", "#level = 7", "result TRUE"]))?;
    terminal.until("a value that is written", |model| has_line(model, &["#level * 2", "#level := 14"]))?;
    terminal.keys(&[KeyCode::Esc]);

    terminal.open("FB2");
    terminal.until("the active step", |model| has_part(model, Tone::Active, "Filling"))?;
    terminal.until("its time", |model| has_line(model, &["Filling", " s "]))?;
    // Nothing flows to the coil of the last transition, before an hour is over.
    terminal.until("its condition", |model| has_part(model, Tone::Off, "─"))?;
    terminal.keys(&[KeyCode::Esc]);

    // A chart whose steps change.
    terminal.open("FB3");
    terminal.until("a step with its time", |model| has_line(model, &["Bright  ", ":", " 0.3"]))?;
    terminal.keys(&[KeyCode::Esc]);
    plc.end().map(drop)
}
