//! `[retain]` of plc.toml: what is retentive, and where it is kept.

use plcc_abi::image::{RetainConfig, RetainInterval};
use plcc_diag::{Code, Diagnostic, FileId, Span};
use serde::Deserialize;
use toml::Spanned;

use crate::project::{duration_ms, number_within};

/// `[retain]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RetainKeys {
    file: Option<Spanned<String>>,
    every: Option<Spanned<String>>,
    #[serde(alias = "bit-memory")]
    bit_memory: Option<Spanned<i64>>,
    timers: Option<Spanned<i64>>,
    counters: Option<Spanned<i64>>,
}

/// Longest time between two copies.
const EVERY_MS_MAX: u32 = 3_600_000;

/// Reads the table. Reports wrong keys and ignores them.
pub fn read(keys: &RetainKeys, file: FileId) -> (RetainConfig, Vec<Diagnostic>) {
    let mut reader = Reader { file, diagnostics: Vec::new() };
    let mut number = |key: &Option<Spanned<i64>>, what: &str| {
        let key = key.as_ref()?;
        number_within::<u32>(key, 0..=65536, what).map_err(|title| reader.report(key, title, "")).ok()
    };
    let (bit_memory, timers, counters) = (
        number(&keys.bit_memory, "a number of bytes"),
        number(&keys.timers, "a number of timers"),
        number(&keys.counters, "a number of counters"),
    );
    let config = RetainConfig {
        file: keys.file.as_ref().and_then(|key| reader.file_name(key)),
        interval: keys.every.as_ref().and_then(|key| reader.interval(key)).unwrap_or_default(),
        bit_memory,
        timers,
        counters,
        reset: false,
    };
    (config, reader.diagnostics)
}

struct Reader {
    file: FileId,
    diagnostics: Vec<Diagnostic>,
}

impl Reader {
    fn report<T>(&mut self, key: &Spanned<T>, title: String, help: &str) {
        let help = if help.is_empty() { "docs/plc-toml.md lists the keys and their values" } else { help };
        self.diagnostics.push(Diagnostic::new(Code::Project, Span::new(self.file, key.span()), title).help(help));
    }

    fn file_name(&mut self, key: &Spanned<String>) -> Option<String> {
        if key.get_ref().is_empty() || key.get_ref().contains('\0') {
            self.report(key, "no name of a file".to_string(), "write `\"plant.retain\"`");
            return None;
        }
        Some(key.get_ref().clone())
    }

    fn interval(&mut self, key: &Spanned<String>) -> Option<RetainInterval> {
        if key.get_ref() == "cycle" {
            return Some(RetainInterval::Cycle);
        }
        match duration_ms(key.get_ref()) {
            Some(ms @ 1..=EVERY_MS_MAX) => Some(RetainInterval::Milliseconds(ms)),
            _ => {
                let title = format!("`{}` is neither a time from 1 ms to 1 h nor `cycle`", key.get_ref());
                self.report(key, title, "write `100ms`, or `cycle` if no completed cycle may be lost");
                None
            }
        }
    }
}
