//! Data breakpoints: who writes a value.

use plcc_abi::layout;
use plcc_runtime::address::{Address, Place, Width};
use plcc_runtime::cpu::Cpu;
use plcc_runtime::signal::{Source, Value};
use plcc_runtime::typed::{self, ValueType};

use crate::breakpoint::When;

/// A value that is looked at.
pub struct Watched {
    pub id: u64,
    /// As the client names it.
    pub name: String,
    pub at: Looked,
    pub when: When,
    last: Vec<u8>,
    /// The last value as the user sees it.
    text: String,
}

/// Where a value is that lasts from call to call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Looked {
    Memory(Range),
    /// The status or the value of a timer or counter.
    Cell(Address),
}

impl Looked {
    /// Whether it is at the same place in every version of the program: data blocks move when one of them changes.
    pub fn is_fixed(self) -> bool {
        match self {
            Looked::Memory(range) => range.offset < layout::L,
            Looked::Cell(_) => true,
        }
    }

    /// As the client keeps it, from one session to the next if it is fixed.
    pub fn text(self) -> String {
        match self {
            Looked::Memory(range) => range.text(),
            Looked::Cell(Address { place, .. }) => match place {
                Place::Timer(number) => format!("T:{number}"),
                Place::TimerValue(number) => format!("TV:{number}"),
                Place::Counter(number) => format!("C:{number}"),
                Place::CounterValue(number) => format!("CV:{number}"),
                _ => String::new(),
            },
        }
    }

    pub fn parse(text: &str) -> Option<Looked> {
        let (kind, number) = text.split_once(':')?;
        let cell = |place: fn(u32) -> Place, width: Width| {
            Some(Looked::Cell(Address { place: place(number.parse().ok()?), width }))
        };
        match kind {
            "T" => cell(Place::Timer, Width::Bit(0)),
            "TV" => cell(Place::TimerValue, Width::Word),
            "C" => cell(Place::Counter, Width::Bit(0)),
            "CV" => cell(Place::CounterValue, Width::Word),
            _ => Range::parse(text).map(Looked::Memory),
        }
    }

    fn read(self, cpu: &Cpu) -> Vec<u8> {
        match self {
            Looked::Memory(range) => range.read(cpu),
            Looked::Cell(address) => match address.width {
                Width::Bit(_) => vec![cpu.read(&address) as u8],
                _ => (cpu.read(&address) as u16).to_be_bytes().to_vec(),
            },
        }
    }

    /// The value for a message, whose bytes these are.
    fn shown(self, cpu: &Cpu, bytes: &[u8]) -> String {
        match self {
            Looked::Memory(Range { offset, bit, ty: Some(ty), .. }) => {
                Value::at(&cpu.memory, offset, bit.unwrap_or(0), ty).text()
            }
            Looked::Memory(_) => shown(bytes),
            Looked::Cell(address) => {
                let source = cell_name(address.place).and_then(|name| Source::find(&name, &cpu.image, None).ok());
                source.map_or_else(|| shown(bytes), |source| source.read(cpu, None).text())
            }
        }
    }
}

/// The name of a timer or counter, or of its value; `None`: it is neither.
fn cell_name(place: Place) -> Option<String> {
    match place {
        Place::Timer(number) => Some(format!("T{number}")),
        Place::TimerValue(number) => Some(format!("T{number}.VALUE")),
        Place::Counter(number) => Some(format!("C{number}")),
        Place::CounterValue(number) => Some(format!("C{number}.VALUE")),
        _ => None,
    }
}

/// A value in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Range {
    pub offset: u32,
    pub bytes: u32,
    /// Only this bit of the byte.
    pub bit: Option<u8>,
    /// The declared type.
    pub ty: Option<ValueType>,
}

impl Range {
    fn text(self) -> String {
        let bit = self.bit.map_or(-1, i32::from);
        let ty = self.ty.map_or_else(String::new, |ty| format!(":{}", typed::name(ty.ty)));
        format!("{}:{}:{bit}{ty}", self.offset, self.bytes)
    }

    fn parse(text: &str) -> Option<Range> {
        let mut parts = text.splitn(4, ':');
        let (offset, bytes) = (parts.next()?.parse().ok()?, parts.next()?.parse().ok()?);
        let bit: i32 = parts.next()?.parse().ok()?;
        let bit = match bit {
            -1 => None,
            bit => Some(u8::try_from(bit).ok().filter(|bit| *bit < 8)?),
        };
        let ty = match parts.next() {
            Some(word) => Some(ValueType::of(typed::from_word(word).ok()?)),
            None => None,
        };
        (1..=BYTES_MAX).contains(&bytes).then_some(Range { offset, bytes, bit, ty })
    }

    fn read(self, cpu: &Cpu) -> Vec<u8> {
        let mut bytes = cpu.memory.view(self.offset, self.bytes, <[u8]>::to_vec);
        if let (Some(bit), Some(byte)) = (self.bit, bytes.first_mut()) {
            *byte = *byte >> bit & 1;
        }
        bytes
    }
}

/// Bytes of the largest value that a program can declare: a value is always compared as a whole.
pub const BYTES_MAX: u32 = plcc_model::layout::BYTES_MAX as u32;

impl Watched {
    pub fn new(id: u64, name: String, at: Looked, when: When) -> Watched {
        Watched { id, name, at, when, last: Vec::new(), text: String::new() }
    }

    /// From now on changes count.
    pub fn take(&mut self, cpu: &Cpu) {
        let now = self.at.read(cpu);
        if now != self.last {
            self.text = self.at.shown(cpu, &now);
            self.last = now;
        }
    }

    /// The program starts once more.
    pub fn forget(&mut self) {
        self.last.clear();
    }

    /// The values before and now as the user sees them, if they differ. Where both look the same, as structures do: the first byte that differs.
    pub fn changed(&mut self, cpu: &Cpu) -> Option<(String, String)> {
        let now = self.at.read(cpu);
        let differs = self.last.iter().zip(&now).position(|(last, now)| last != now);
        let last = std::mem::replace(&mut self.last, now);
        let Some(at) = differs else {
            // The first value is not a change.
            if last.is_empty() {
                self.text = self.at.shown(cpu, &self.last);
            }
            return None;
        };
        let text = self.at.shown(cpu, &self.last);
        let before = std::mem::replace(&mut self.text, text.clone());
        Some(if before == text {
            (format!("16#{:02X} in byte {at}", last[at]), format!("16#{:02X}", self.last[at]))
        } else {
            (before, text)
        })
    }
}

/// Bytes for a message: a number where they are one.
pub fn shown(bytes: &[u8]) -> String {
    match bytes {
        [byte] => byte.to_string(),
        _ if bytes.len() <= 16 => bytes.iter().fold("16#".to_string(), |text, byte| format!("{text}{byte:02X}")),
        _ => format!("{} bytes", bytes.len()),
    }
}
