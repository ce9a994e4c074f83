//! Data breakpoints: who writes a value.

use plcc_runtime::cpu::Cpu;

use crate::breakpoint::When;

/// Bytes of memory that are looked at.
pub struct Watched {
    pub id: u64,
    /// As the client names it.
    pub name: String,
    pub at: Range,
    pub when: When,
    last: Vec<u8>,
}

/// A value in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Range {
    pub offset: u32,
    pub bytes: u32,
    /// Only this bit of the byte.
    pub bit: Option<u8>,
}

impl Range {
    /// As the client keeps it from one session to the next.
    pub fn text(self) -> String {
        let bit = self.bit.map_or(-1, i32::from);
        format!("{}:{}:{bit}", self.offset, self.bytes)
    }

    pub fn parse(text: &str) -> Option<Range> {
        let mut parts = text.splitn(3, ':');
        let (offset, bytes) = (parts.next()?.parse().ok()?, parts.next()?.parse().ok()?);
        let bit: i32 = parts.next()?.parse().ok()?;
        let bit = match bit {
            -1 => None,
            bit => Some(u8::try_from(bit).ok().filter(|bit| *bit < 8)?),
        };
        (1..=BYTES_MAX).contains(&bytes).then_some(Range { offset, bytes, bit })
    }

    fn read(self, cpu: &Cpu) -> Vec<u8> {
        let mut bytes = cpu.memory.view(self.offset, self.bytes, <[u8]>::to_vec);
        if let (Some(bit), Some(byte)) = (self.bit, bytes.first_mut()) {
            *byte = *byte >> bit & 1;
        }
        bytes
    }
}

/// A larger value is compared in part only.
pub const BYTES_MAX: u32 = 4096;

impl Watched {
    pub fn new(id: u64, name: String, at: Range, when: When) -> Watched {
        Watched { id, name, at, when, last: Vec::new() }
    }

    /// From now on changes count.
    pub fn take(&mut self, cpu: &Cpu) {
        self.last = self.at.read(cpu);
    }

    /// The program starts once more.
    pub fn forget(&mut self) {
        self.last.clear();
    }

    /// The bytes before and now, if they differ.
    pub fn changed(&mut self, cpu: &Cpu) -> Option<(Vec<u8>, Vec<u8>)> {
        let now = self.at.read(cpu);
        if now == self.last {
            return None;
        }
        let before = std::mem::replace(&mut self.last, now.clone());
        (!before.is_empty()).then_some((before, now))
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
