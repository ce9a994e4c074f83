//! Recording of values, one sample after the outputs of each cycle.
//!
//! Recorded signals: the list of `--trace-signals`; without it the values of `--print` and those that the program uses;
//! without any of these the outputs Q0.0 to Q3.7. A sample has the time at which its cycle started, cycle 0 is the one
//! after the startup OB. In a VCD the edges of an S7-200 pulse output between two samples have their own times.

pub mod page;
mod table;
pub mod triggered;
mod waveform;

use std::collections::HashSet;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::time::{Duration, Instant};

use crate::address::{Address, Place, Width};
use crate::cpu::Cpu;
use crate::names;
use crate::plant::Plant;
use crate::s7200::{Edge, PULSE_OUTPUTS};
use crate::signal::{Signal, Source, Value};

/// A file format.
trait Sink {
    /// Signal `index`, a bit, changes between two samples.
    fn edge(&mut self, _index: usize, _time: u64, _level: bool) -> std::io::Result<()> {
        Ok(())
    }
    /// A remark for who looks at the file.
    fn remark(&mut self, _text: &str) -> std::io::Result<()> {
        Ok(())
    }
    fn sample(&mut self, cycle: u64, time: u64, values: &[Value]) -> std::io::Result<()>;
    /// Writes all samples until now to the file.
    fn finish(&mut self) -> std::io::Result<()>;
}

/// Host time after which a trace that grows is brought up to date.
const FLUSH_PERIOD: Duration = Duration::from_millis(500);

/// Writes a trace file.
pub struct Recorder {
    signals: Vec<Signal>,
    sink: Box<dyn Sink>,
    values: Vec<Value>,
    /// Signals that are pulse outputs of an S7-200: place, and number of the output.
    outputs: Vec<(usize, u8)>,
    /// Edges in their order, of one step.
    edges: Vec<(u64, usize, bool)>,
    /// A comment reports that edges are missing.
    cut: bool,
    /// Minimum nanoseconds between two samples, and when the next one is due.
    step: u64,
    due: u64,
    /// When the file was last brought up to date.
    flushed: Instant,
    /// The first error; nothing is written after it.
    error: Option<std::io::Error>,
}

impl Recorder {
    /// Creates the file; its extension determines the format. `step`: nanoseconds between samples, 0: each cycle. `Err`: the error.
    pub fn create(path: &Path, signals: Vec<Signal>, step: u64) -> Result<Recorder, String> {
        let sink = sink(path, &signals).map_err(|error| format!("--trace {error}"))?;
        let outputs = (0..).zip(&signals).filter_map(|(index, signal)| Some((index, pulse_output(&signal.source)?)));
        Ok(Recorder {
            values: Vec::with_capacity(signals.len()),
            outputs: outputs.collect(),
            edges: Vec::new(),
            cut: false,
            signals,
            sink,
            step,
            flushed: Instant::now(),
            due: 0,
            error: None,
        })
    }

    /// Takes a sample.
    pub fn sample(&mut self, cpu: &Cpu, plant: Option<&Plant>, cycle: u64, time: u64) {
        if self.error.is_some() {
            return;
        }
        let levels = self.pulses(cpu, time);
        if self.error.is_none() && time >= self.due {
            // Samples are at multiples of the step. Without one each cycle is a sample, the startup next to the first.
            self.due = time.checked_div(self.step).map_or(0, |steps| (steps + 1).saturating_mul(self.step));
            self.values.clear();
            self.values.extend(self.signals.iter().map(|signal| signal.source.read(cpu, plant)));
            for (index, level) in levels {
                if let Some(Value::Bits(bits, _)) = self.values.get_mut(index) {
                    *bits = level.into();
                }
            }
            self.error = self.sink.sample(cycle, time, &self.values).err();
            // A process that is ended from outside leaves all but the last moment.
            if self.error.is_none() && self.flushed.elapsed() >= FLUSH_PERIOD {
                self.error = self.sink.finish().err();
                self.flushed = Instant::now();
            }
        }
    }

    /// Edges of pulse outputs since the last sample. Result: levels at `time` of those that a generator owns.
    fn pulses(&mut self, cpu: &Cpu, time: u64) -> Vec<(usize, bool)> {
        let mut levels = Vec::new();
        let mut taken: Vec<(u8, Taken)> = Vec::new();
        self.edges.clear();
        for &(index, number) in &self.outputs {
            // Two signals may be the same output.
            if !taken.iter().any(|(other, _)| *other == number) {
                cpu.s7200_record_pulses(number);
                taken.push((number, cpu.s7200_pulse_edges(number, time)));
            }
            let Some((_, (edges, cut, level))) = taken.iter().find(|(other, _)| *other == number) else { continue };
            self.edges.extend(edges.iter().map(|edge| (edge.time, index, edge.level)));
            levels.extend(level.map(|level| (index, level)));
            if *cut && !std::mem::replace(&mut self.cut, true) {
                let text = format!("edges of Q0.{number} are missing: there were too many between two samples");
                self.error = self.error.take().or(self.sink.remark(&text).err());
            }
        }
        self.edges.sort_by_key(|&(time, ..)| time);
        for &(time, index, level) in &self.edges {
            if self.error.is_none() {
                self.error = self.sink.edge(index, time, level).err();
            }
        }
        levels
    }

    /// Ends the file. `Err`: the first error.
    pub fn finish(mut self) -> std::io::Result<()> {
        match self.error.take() {
            Some(error) => Err(error),
            None => self.sink.finish(),
        }
    }
}

/// Creates a file; its extension determines the format. `Err`: the error, with the name of the file.
fn sink(path: &Path, signals: &[Signal]) -> Result<Box<dyn Sink>, String> {
    let failed = |error: std::io::Error| format!("{}: {error}", path.display());
    let open = || crate::files::writable(path).and_then(|()| File::create(path)).map(BufWriter::new).map_err(failed);
    let suffix = path.extension().and_then(|suffix| suffix.to_str()).unwrap_or("").to_ascii_lowercase();
    Ok(match suffix.as_str() {
        "vcd" => Box::new(waveform::Waveform::new(open()?, signals).map_err(failed)?),
        "csv" => Box::new(table::Table::new(open()?, signals).map_err(failed)?),
        "html" => {
            let mut file = open()?;
            let title = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
            std::io::Write::write_all(&mut file, page::head(&title).as_bytes()).map_err(failed)?;
            Box::new(table::Table::new(page::Samples(file), signals).map_err(failed)?)
        }
        _ => return Err(format!("{}: the file must end in .vcd, .csv or .html", path.display())),
    })
}

/// The recorded part of a pulse output: its edges, whether some are missing, its level.
type Taken = (Vec<Edge>, bool, Option<bool>);

/// The number of the pulse output that a signal shows.
fn pulse_output(source: &Source) -> Option<u8> {
    match source {
        Source::Bits(Address { place: Place::Output(0), width: Width::Bit(bit) }) => {
            Some(*bit).filter(|&bit| bit < PULSE_OUTPUTS)
        }
        _ => None,
    }
}

/// Signals that are recorded if none are named.
const SIGNALS_MAX: usize = 1000;

/// The signals to record, see the module comment, and whether there are more.
pub fn signals(cpu: &Cpu, asked: &[Signal], printed: &[Signal]) -> (Vec<Signal>, bool) {
    if !asked.is_empty() {
        return (asked.to_vec(), false);
    }
    let mut signals = printed.to_vec();
    let mut names: HashSet<String> = printed.iter().map(|signal| signal.name.clone()).collect();
    for (name, named) in names::used(&cpu.image) {
        if cpu.check_address(&named.address).is_ok() && names.insert(name.clone()) {
            signals.push(Signal { name, source: Source::of(named) });
        }
    }
    let has_more = signals.len() > SIGNALS_MAX;
    signals.truncate(SIGNALS_MAX.max(printed.len()));
    if signals.is_empty() {
        signals.extend((0..32u32).map(|index| Signal {
            name: format!("Q{}.{}", index / 8, index % 8),
            source: Source::Bits(Address { place: Place::Output(index / 8), width: Width::Bit((index % 8) as u8) }),
        }));
    }
    (signals, has_more)
}

#[cfg(test)]
mod tests {
    use plcc_abi::image::AssertType;

    use super::*;
    use crate::address;
    use crate::typed::ValueType;

    fn signal(name: &str) -> Signal {
        Signal { name: name.to_string(), source: Source::Bits(address::parse(name).unwrap()) }
    }

    /// A bit and a word.
    fn values(bit: u64, word: u64) -> [Value; 2] {
        [Value::Bits(bit, Width::Bit(0)), Value::Bits(word, Width::Word)]
    }

    #[test]
    fn vcd_has_changes_only() {
        let mut bytes = Vec::new();
        let mut sink = waveform::Waveform::new(&mut bytes, &[signal("Q0.0"), signal("MW 2")]).unwrap();
        sink.sample(0, 0, &values(0, 5)).unwrap();
        sink.sample(1, 10_000_000, &values(0, 5)).unwrap();
        sink.sample(2, 20_000_000, &values(1, 6)).unwrap();
        sink.finish().unwrap();
        drop(sink);
        let expected = "$timescale 1 us $end\n$scope module plc $end\n$var wire 1 ! Q0.0 $end\n\
            $var wire 16 \" MW_2 $end\n$upscope $end\n$enddefinitions $end\n\
            #0\n0!\nb0000000000000101 \"\n#20000\n1!\nb0000000000000110 \"\n";
        assert_eq!(String::from_utf8(bytes).unwrap(), expected);
    }

    /// A `real` has 53 bits.
    #[test]
    fn vcd_has_all_digits_of_long_numbers() {
        let long = |name: &str, ty: AssertType| Signal {
            name: name.to_string(),
            source: Source::Typed(
                Address { place: Place::BitMemory(8), width: Width::Lword },
                ValueType { ty, length: 0 },
            ),
        };
        let mut bytes = Vec::new();
        let signals = [long("Sum", AssertType::Signed(64)), long("Total", AssertType::Unsigned(64))];
        let mut sink = waveform::Waveform::new(&mut bytes, &signals).unwrap();
        sink.sample(0, 0, &[Value::Whole(-2), Value::Whole((1 << 53) + 1)]).unwrap();
        sink.finish().unwrap();
        drop(sink);
        let (ones, zeros) = ("1".repeat(63), "0".repeat(52));
        let expected = format!(
            "$timescale 1 us $end\n$scope module plc $end\n$var integer 64 ! Sum $end\n\
             $var wire 64 \" Total $end\n$upscope $end\n$enddefinitions $end\n\
             #0\nb{ones}0 !\nb00000000001{zeros}1 \"\n",
        );
        assert_eq!(String::from_utf8(bytes).unwrap(), expected);
    }

    #[test]
    fn csv_has_every_cycle() {
        let mut bytes = Vec::new();
        let mut sink = table::Table::new(&mut bytes, &[signal("Q0.0"), signal("MW2")]).unwrap();
        sink.sample(0, 0, &values(0, 5)).unwrap();
        sink.sample(1, 10_500_000, &values(1, 5)).unwrap();
        sink.finish().unwrap();
        drop(sink);
        let expected = "cycle,time_ms,Q0.0,MW2\n0,0,0,16#0005\n1,10.5,1,16#0005\n";
        assert_eq!(String::from_utf8(bytes).unwrap(), expected);
    }
}
