//! `[retain]` of plc.toml: what is retentive, and where it is kept.

use std::ops::Range;

use plcc_abi::image::{RetainConfig, RetainInterval};
use plcc_diag::{Diagnostic, FileId};
use serde::Deserialize;
use toml::Spanned;

use crate::cpu_settings::Retained;
use crate::keys::Reader;
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

impl RetainKeys {
    /// How much is to be retentive, and where it is written. [`read`] reports numbers that are out of range.
    pub fn counts(&self) -> Vec<(Retained, u32, Range<usize>)> {
        let keys = [
            (Retained::BitMemory, &self.bit_memory),
            (Retained::Timers, &self.timers),
            (Retained::Counters, &self.counters),
        ];
        let counts = keys.into_iter().filter_map(|(retained, key)| {
            let key = key.as_ref()?;
            let count = u32::try_from(*key.get_ref()).ok().filter(|count| *count <= COUNT_MAX)?;
            Some((retained, count, key.span()))
        });
        counts.collect()
    }
}

/// More than any CPU has.
const COUNT_MAX: u32 = 65_536;
/// Longest time between two copies.
const EVERY_MS_MAX: u32 = 3_600_000;

/// Reads the table. Reports wrong keys and ignores them.
pub fn read(keys: &RetainKeys, file: FileId) -> (RetainConfig, Vec<Diagnostic>) {
    let mut reader = Reader::new(file);
    let mut number = |key: &Option<Spanned<i64>>, what: &str| {
        let key = key.as_ref()?;
        let help = format!("write a number from 0 to {COUNT_MAX}");
        number_within::<u32>(key, 0..=COUNT_MAX.into(), what).map_err(|title| reader.report(key, title, &help)).ok()
    };
    let (bit_memory, timers, counters) = (
        number(&keys.bit_memory, "a number of bytes"),
        number(&keys.timers, "a number of timers"),
        number(&keys.counters, "a number of counters"),
    );
    let config = RetainConfig {
        file: keys.file.as_ref().and_then(|key| reader.file_name(key, "file", "plant.retain")),
        interval: keys.every.as_ref().and_then(|key| reader.retain_interval(key)).unwrap_or_default(),
        bit_memory,
        timers,
        counters,
        reset: false,
        for_hot: false,
    };
    (config, reader.diagnostics)
}

impl Reader {
    fn retain_interval(&mut self, key: &Spanned<String>) -> Option<RetainInterval> {
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
