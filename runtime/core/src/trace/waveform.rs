//! VCD: value changes, in microseconds, for waveform viewers.

use std::io::{Result, Write};

use vcd::{IdCode, TimescaleUnit, Value};

use super::{Signal, Sink};
use crate::address::Bits;

pub(super) struct Waveform<W: Write> {
    writer: vcd::Writer<W>,
    codes: Vec<(IdCode, u32)>,
    last: Vec<Option<Bits>>,
    /// Time of the last sample that had changes.
    stamp: Option<u64>,
}

impl<W: Write> Waveform<W> {
    pub fn new(out: W, signals: &[Signal]) -> Result<Waveform<W>> {
        let mut writer = vcd::Writer::new(out);
        writer.timescale(1, TimescaleUnit::US)?;
        writer.add_module("plc")?;
        let mut codes = Vec::new();
        for signal in signals {
            let bits = signal.address.width.bits();
            // Names in VCD have no blanks.
            let name: String = signal.name.chars().map(|c| if c.is_whitespace() { '_' } else { c }).collect();
            codes.push((writer.add_wire(bits, &name)?, bits));
        }
        writer.upscope()?;
        writer.enddefinitions()?;
        Ok(Waveform { writer, last: vec![None; codes.len()], codes, stamp: None })
    }
}

impl<W: Write> Sink for Waveform<W> {
    fn sample(&mut self, _cycle: u64, time: u64, values: &[Bits]) -> Result<()> {
        let time = time / 1000;
        for ((&(code, bits), last), &value) in self.codes.iter().zip(&mut self.last).zip(values) {
            if last.replace(value) == Some(value) {
                continue;
            }
            if self.stamp != Some(time) {
                self.writer.timestamp(time)?;
                self.stamp = Some(time);
            }
            let bit = |index: u32| if value >> index & 1 != 0 { Value::V1 } else { Value::V0 };
            if bits == 1 {
                self.writer.change_scalar(code, bit(0))?;
            } else {
                self.writer.change_vector(code, (0..bits).rev().map(bit))?;
            }
        }
        Ok(())
    }

    fn finish(&mut self) -> Result<()> {
        self.writer.flush()
    }
}
