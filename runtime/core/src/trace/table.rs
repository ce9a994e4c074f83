//! CSV: one row a cycle, values as `--print` writes them.

use std::io::{Error, Result, Write};

use super::{Signal, Sink};
use crate::clock::NS_PER_MS;
use crate::signal::Value;

pub(super) struct Table<W: Write> {
    writer: csv::Writer<W>,
}

impl<W: Write> Table<W> {
    pub fn new(out: W, signals: &[Signal]) -> Result<Table<W>> {
        let mut writer = csv::Writer::from_writer(out);
        let names = ["cycle", "time_ms"].into_iter().chain(signals.iter().map(|signal| signal.name.as_str()));
        writer.write_record(names).map_err(Error::other)?;
        Ok(Table { writer })
    }
}

impl<W: Write> Sink for Table<W> {
    fn sample(&mut self, cycle: u64, time: u64, values: &[Value]) -> Result<()> {
        let time = time as f64 / NS_PER_MS as f64;
        let head = [cycle.to_string(), time.to_string()];
        let values = values.iter().map(|value| value.text());
        self.writer.write_record(head.into_iter().chain(values)).map_err(Error::other)
    }

    fn finish(&mut self) -> Result<()> {
        self.writer.flush()
    }
}
