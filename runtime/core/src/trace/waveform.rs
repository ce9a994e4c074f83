//! VCD: value changes, in microseconds, for waveform viewers.

use std::io::{Result, Write};

use vcd::{IdCode, TimescaleUnit, VarType};

use super::{Signal, Sink};
use crate::address::Width;
use crate::signal::{Shape, Value};

pub(super) struct Waveform<W: Write> {
    writer: vcd::Writer<W>,
    codes: Vec<IdCode>,
    /// Signals that are whole numbers of 64 bits, which are written bit by bit.
    is_long: Vec<bool>,
    last: Vec<Option<Value>>,
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
            // Names in VCD have no blanks.
            let name: String = signal.name.chars().map(|c| if c.is_whitespace() { '_' } else { c }).collect();
            codes.push(match signal.source.shape() {
                Shape::Bits(width) => writer.add_wire(width.bits(), &name)?,
                // In Verilog an `integer` has a sign.
                Shape::Long { signed: true } => writer.add_var(VarType::Integer, 64, &name, None)?,
                Shape::Long { signed: false } => writer.add_wire(64, &name)?,
                Shape::Number => writer.add_var(VarType::Real, 64, &name, None)?,
                Shape::Text => writer.add_var(VarType::String, 1, &name, None)?,
            });
        }
        writer.upscope()?;
        writer.enddefinitions()?;
        let is_long = signals.iter().map(|signal| matches!(signal.source.shape(), Shape::Long { .. })).collect();
        Ok(Waveform { writer, last: vec![None; codes.len()], codes, is_long, stamp: None })
    }
}

impl<W: Write> Waveform<W> {
    /// The following entries have this time, in nanoseconds.
    fn stamp(&mut self, time: u64) -> Result<()> {
        let time = time / 1000;
        if self.stamp != Some(time) {
            self.writer.timestamp(time)?;
            self.stamp = Some(time);
        }
        Ok(())
    }
}

impl<W: Write> Sink for Waveform<W> {
    fn edge(&mut self, index: usize, time: u64, level: bool) -> Result<()> {
        let (Some(&code), Some(last)) = (self.codes.get(index), self.last.get_mut(index)) else { return Ok(()) };
        match last {
            Some(Value::Bits(bits, _)) if *bits == u64::from(level) => return Ok(()),
            Some(Value::Bits(bits, _)) => *bits = level.into(),
            Some(Value::Whole(_) | Value::Number(_) | Value::Typed(..)) | None => {
                *last = Some(Value::Bits(level.into(), Width::Bit(0)))
            }
        }
        self.stamp(time)?;
        self.writer.change_scalar(code, if level { vcd::Value::V1 } else { vcd::Value::V0 })
    }

    fn remark(&mut self, text: &str) -> Result<()> {
        self.writer.comment(text)
    }

    fn sample(&mut self, _cycle: u64, time: u64, values: &[Value]) -> Result<()> {
        for (index, value) in values.iter().enumerate() {
            let (Some(&code), Some(last)) = (self.codes.get(index), self.last.get_mut(index)) else { continue };
            if last.as_ref() == Some(value) {
                continue;
            }
            *last = Some(value.clone());
            self.stamp(time)?;
            let bit = |bits: u64, index: u32| if bits >> index & 1 != 0 { vcd::Value::V1 } else { vcd::Value::V0 };
            match *value {
                Value::Bits(bits, Width::Bit(_)) => self.writer.change_scalar(code, bit(bits, 0))?,
                Value::Bits(bits, width) => {
                    self.writer.change_vector(code, (0..width.bits()).rev().map(|index| bit(bits, index)))?;
                }
                Value::Whole(whole) if self.is_long.get(index) == Some(&true) => {
                    self.writer.change_vector(code, (0..64).rev().map(|index| bit(whole as u64, index)))?;
                }
                Value::Whole(_) | Value::Number(_) | Value::Typed(..) => match value.number() {
                    Some(number) => self.writer.change_real(code, number)?,
                    // Texts in VCD have no blanks.
                    None => self.writer.change_string(code, &value.text().replace(char::is_whitespace, "_"))?,
                },
            }
        }
        Ok(())
    }

    fn finish(&mut self) -> Result<()> {
        self.writer.flush()
    }
}
