//! Values of assertions: compared by their types, and printed.

use std::cell::RefCell;
use std::cmp::Ordering;

use plcc_abi::image::{
    AssertComparison, AssertCondition, AssertConstant, AssertEntry, AssertKind, AssertOp, AssertSide, AssertType,
};
use plcc_literal::duration::s5time_milliseconds;

use crate::cpu::Cpu;
use crate::datetime::{self, NS_PER_S};
use crate::memory::Memory;
use crate::signal;

/// What happened to each assertion; made before the first cycle.
pub(crate) struct Assertions {
    states: RefCell<Vec<AssertState>>,
}

#[derive(Clone, Default)]
struct AssertState {
    executed: bool,
    /// Whether each comparison held.
    held: Vec<bool>,
    /// Its values, ready to print, of those that did not hold.
    values: Vec<Option<(String, String)>>,
    failed: Option<Failed>,
}

/// The first failure of an assertion.
#[derive(Clone, Debug)]
pub(crate) struct Failed {
    /// Both sides, of several comparisons with `; ` between them.
    pub left: String,
    pub right: String,
    /// Cycle and time in nanoseconds.
    pub when: (u64, u64),
}

impl Assertions {
    pub(crate) fn new(entries: &[AssertEntry]) -> Assertions {
        let state = |entry: &AssertEntry| AssertState {
            held: vec![false; entry.comparisons.len()],
            values: vec![None; entry.comparisons.len()],
            ..AssertState::default()
        };
        Assertions { states: RefCell::new(entries.iter().map(state).collect()) }
    }

    /// Takes the values of a comparison, and judges the assertion after the last one.
    pub(crate) fn check(&self, cpu: &Cpu, id: usize, index: usize, left: u64, right: u64) {
        let Some(entry) = cpu.image.asserts.get(id) else { return };
        let Some(comparison) = entry.comparisons.get(index) else { return };
        let (left, right) =
            (Value::of(&comparison.left, left, &cpu.memory), Value::of(&comparison.right, right, &cpu.memory));
        let holds = holds(comparison, &left, &right);
        let mut states = self.states.borrow_mut();
        let Some(state) = states.get_mut(id) else { return };
        let last = index + 1 == entry.comparisons.len();
        if entry.trap || state.failed.is_none() {
            let text =
                || (left.text(&comparison.left, comparison.kind), right.text(&comparison.right, comparison.kind));
            state.held[index] = holds;
            // Only a failure is printed; under NOT it may be one that held.
            let single = matches!(entry.condition, AssertCondition::Compare(_));
            state.values[index] = (!single || !holds || entry.trap).then(text);
        }
        if !last {
            return;
        }
        state.executed = true;
        if state.failed.is_none() && (entry.trap || !is_met(&entry.condition, &state.held)) {
            let all: Vec<&(String, String)> = state.values.iter().flatten().collect();
            let join = |texts: Vec<&str>| texts.join("; ");
            state.failed = Some(Failed {
                left: join(all.iter().map(|(left, _)| left.as_str()).collect()),
                right: join(all.iter().map(|(_, right)| right.as_str()).collect()),
                when: (cpu.cycle.get(), cpu.clock.now()),
            });
        }
    }

    pub(crate) fn is_executed(&self, id: usize) -> bool {
        self.states.borrow().get(id).is_some_and(|state| state.executed)
    }

    pub(crate) fn failure(&self, id: usize) -> Option<Failed> {
        self.states.borrow().get(id).and_then(|state| state.failed.clone())
    }
}

fn is_met(condition: &AssertCondition, held: &[bool]) -> bool {
    match condition {
        AssertCondition::Compare(index) => held.get(*index as usize).copied().unwrap_or(false),
        AssertCondition::Not(inner) => !is_met(inner, held),
        AssertCondition::All(list) => list.iter().all(|one| is_met(one, held)),
        AssertCondition::Any(list) => list.iter().any(|one| is_met(one, held)),
    }
}

/// A value that was brought.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// As a variable of the type has it, zero-extended.
    Bits(u64),
    /// A DTL.
    Bytes([u8; 12]),
    Text(Vec<u16>),
}

impl Value {
    fn of(side: &AssertSide, given: u64, memory: &Memory) -> Value {
        match (&side.constant, side.ty) {
            (Some(AssertConstant::Bits(bits)), _) => Value::Bits(*bits),
            (Some(AssertConstant::Bytes(bytes)), _) => Value::Bytes(first(bytes)),
            (Some(AssertConstant::Text(text)), _) => Value::Text(text.clone()),
            (None, _) => Value::read(side.ty, given, memory),
        }
    }

    /// The value at an offset from the memory base, or `given` itself.
    pub fn read(ty: AssertType, given: u64, memory: &Memory) -> Value {
        let at = given as u32;
        let byte = |offset: u32| memory.byte(at.saturating_add(offset));
        let word = |offset: u32| u16::from(byte(offset)) << 8 | u16::from(byte(offset + 1));
        match ty {
            AssertType::Dtl => Value::Bytes(std::array::from_fn(|index| byte(index as u32))),
            AssertType::Text => {
                let length = byte(1).min(byte(0)).min(254);
                Value::Text((0..u32::from(length)).map(|index| u16::from(byte(2 + index))).collect())
            }
            AssertType::WideText => {
                let length = word(2).min(word(0)).min(16_382);
                Value::Text((0..u32::from(length)).map(|index| word(4 + 2 * index)).collect())
            }
            _ => Value::Bits(given & mask(ty)),
        }
    }

    /// The value whose bytes these are; missing ones are 0.
    pub fn of_bytes(ty: AssertType, bytes: &[u8]) -> Value {
        let text = |bytes: &[u8], width: usize| match width {
            1 => bytes.iter().map(|&byte| u16::from(byte)).collect(),
            _ => bytes.chunks_exact(2).map(|pair| u16::from(pair[0]) << 8 | u16::from(pair[1])).collect(),
        };
        match ty {
            AssertType::Text => Value::Text(text(bytes.get(2..).unwrap_or_default(), 1)),
            AssertType::WideText => Value::Text(text(bytes.get(4..).unwrap_or_default(), 2)),
            _ => Value::Bytes(first(bytes)),
        }
    }

    /// Seconds of a duration; `None`: the type is another one.
    pub fn seconds(&self, ty: AssertType) -> Option<f64> {
        match ty {
            AssertType::S5Time | AssertType::Time | AssertType::Ltime => {
                self.nanoseconds(ty).map(|ns| ns as f64 / NS_PER_S as f64)
            }
            _ => None,
        }
    }

    /// The characters of a text.
    pub fn plain_text(&self, ty: AssertType) -> String {
        String::from_utf16_lossy(&self.characters(ty))
    }

    fn bits(&self) -> u64 {
        if let Value::Bits(bits) = self { *bits } else { 0 }
    }

    fn whole(&self, ty: AssertType) -> i128 {
        let bits = self.bits();
        match ty {
            AssertType::Signed(width) => signed(bits, width),
            AssertType::Time => signed(bits, 32),
            AssertType::Ltime => signed(bits, 64),
            _ => i128::from(bits),
        }
    }

    fn float(&self, ty: AssertType) -> f64 {
        match ty {
            AssertType::Real => f64::from(f32::from_bits(self.bits() as u32)),
            AssertType::Lreal => f64::from_bits(self.bits()),
            _ => self.whole(ty) as f64,
        }
    }

    /// Nanoseconds; for a moment, since 1970. `None`: the bits are not a valid value.
    fn nanoseconds(&self, ty: AssertType) -> Option<i128> {
        const NS_PER_MS: i128 = 1_000_000;
        match (ty, self) {
            (AssertType::S5Time, _) => s5time_milliseconds(self.bits() as u16).map(|ms| i128::from(ms) * NS_PER_MS),
            (AssertType::Time | AssertType::TimeOfDay, _) => Some(self.whole(ty) * NS_PER_MS),
            (AssertType::Date, _) => Some((i128::from(self.bits()) + 7305) * 86_400 * i128::from(NS_PER_S)),
            (AssertType::DateAndTime, _) => datetime::decode(self.bits().to_be_bytes()).ok().map(i128::from),
            (AssertType::Dtl, Value::Bytes(bytes)) => dtl(bytes),
            _ => Some(self.whole(ty)),
        }
    }

    fn characters(&self, ty: AssertType) -> Vec<u16> {
        match (self, ty) {
            (Value::Text(text), AssertType::Text) => text.iter().map(|&byte| windows_1252(byte)).collect(),
            (Value::Text(text), _) => text.clone(),
            (_, AssertType::Char) => vec![windows_1252(self.bits() as u16)],
            _ => vec![self.bits() as u16],
        }
    }

    /// As in messages.
    fn text(&self, side: &AssertSide, kind: AssertKind) -> String {
        let ty = match (side.ty, kind) {
            (AssertType::Bits(_), _) | (_, AssertKind::Bits) => return hex(self.bits()),
            (ty, _) => ty,
        };
        self.typed_text(ty)
    }

    /// A value of a type, as a user writes it.
    pub fn typed_text(&self, ty: AssertType) -> String {
        let bits = self.bits();
        match ty {
            AssertType::Bits(_) => hex(bits),
            AssertType::Bool => if bits == 0 { "FALSE" } else { "TRUE" }.to_string(),
            AssertType::Signed(_) | AssertType::Unsigned(_) => self.whole(ty).to_string(),
            AssertType::Real => format!("{:?} (16#{:08X})", f32::from_bits(bits as u32), bits),
            AssertType::Lreal => format!("{:?} (16#{bits:016X})", f64::from_bits(bits)),
            AssertType::Char | AssertType::Text => quoted(&self.characters(ty), 2),
            AssertType::Wchar | AssertType::WideText => quoted(&self.characters(ty), 4),
            AssertType::S5Time => match s5time_milliseconds(bits as u16) {
                Some(ms) => format!("S5T#{}", duration(i128::from(ms) * 1_000_000)),
                None => format!("W#16#{bits:04X} (no S5TIME)"),
            },
            AssertType::Time => format!("T#{}", duration(self.whole(ty) * 1_000_000)),
            AssertType::Ltime => format!("LT#{}", duration(self.whole(ty))),
            AssertType::TimeOfDay => format!("TOD#{}", clock(i128::from(bits) * 1_000_000)),
            AssertType::Ltod => format!("LTOD#{}", clock(i128::from(bits))),
            AssertType::Date | AssertType::Ldt | AssertType::DateAndTime | AssertType::Dtl => {
                let (prefix, with_time) = match ty {
                    AssertType::Date => ("D", false),
                    AssertType::Ldt => ("LDT", true),
                    AssertType::Dtl => ("DTL", true),
                    _ => ("DT", true),
                };
                match self.nanoseconds(ty) {
                    Some(ns) => format!("{prefix}#{}", moment(ns, with_time)),
                    None => match self {
                        Value::Bytes(bytes) => format!("{bytes:02X?} (no date and time)"),
                        _ => format!("16#{bits:016X} (no date and time)"),
                    },
                }
            }
        }
    }
}

/// Whether a comparison holds. NaN and bits that are not a value of their type are different from everything.
fn holds(comparison: &AssertComparison, left: &Value, right: &Value) -> bool {
    let (own, other) = (comparison.left.ty, comparison.right.ty);
    compare(comparison.kind, (left, own), (right, other)).map_or(
        comparison.op == AssertOp::Ne,
        |order| match comparison.op {
            AssertOp::Eq => order == Ordering::Equal,
            AssertOp::Ne => order != Ordering::Equal,
            AssertOp::Lt => order == Ordering::Less,
            AssertOp::Le => order != Ordering::Greater,
            AssertOp::Gt => order == Ordering::Greater,
            AssertOp::Ge => order != Ordering::Less,
        },
    )
}

pub(crate) fn compare(
    kind: AssertKind,
    (left, own): (&Value, AssertType),
    (right, other): (&Value, AssertType),
) -> Option<Ordering> {
    match kind {
        AssertKind::Bits => Some(left.bits().cmp(&right.bits())),
        AssertKind::Whole => Some(left.whole(own).cmp(&right.whole(other))),
        AssertKind::Float => left.float(own).partial_cmp(&right.float(other)),
        AssertKind::Duration | AssertKind::TimeOfDay | AssertKind::Moment => {
            Some(left.nanoseconds(own)?.cmp(&right.nanoseconds(other)?))
        }
        AssertKind::Text => Some(left.characters(own).cmp(&right.characters(other))),
    }
}

fn mask(ty: AssertType) -> u64 {
    let width = match ty {
        AssertType::Bits(width) | AssertType::Signed(width) | AssertType::Unsigned(width) => u32::from(width),
        AssertType::Bool => 1,
        AssertType::Char => 8,
        AssertType::Wchar | AssertType::S5Time | AssertType::Date => 16,
        AssertType::Real | AssertType::Time | AssertType::TimeOfDay => 32,
        _ => 64,
    };
    u64::MAX >> (64 - width.clamp(1, 64))
}

pub(crate) fn signed(bits: u64, width: u8) -> i128 {
    let unused = 64 - u32::from(width.clamp(1, 64));
    i128::from((bits << unused) as i64 >> unused)
}

fn first(bytes: &[u8]) -> [u8; 12] {
    std::array::from_fn(|index| bytes.get(index).copied().unwrap_or(0))
}

/// `16#0000_0005 (5)`
fn hex(bits: u64) -> String {
    let (high, low) = (bits >> 32, bits & 0xFFFF_FFFF);
    let low = format!("{:04X}_{:04X}", low >> 16, low & 0xFFFF);
    match high {
        0 => format!("16#{low} ({bits})"),
        _ => format!("16#{:04X}_{:04X}_{low} ({bits})", high >> 16, high & 0xFFFF),
    }
}

/// A text as a literal: `'it$'s$R$L'`. `digits`: those of the code of a character.
fn quoted(text: &[u16], digits: usize) -> String {
    let mut quoted = String::from("'");
    for c in String::from_utf16_lossy(text).chars() {
        match c {
            '\'' | '$' => quoted.extend(['$', c]),
            '\n' => quoted.push_str("$L"),
            '\r' => quoted.push_str("$R"),
            '\t' => quoted.push_str("$T"),
            '\u{c}' => quoted.push_str("$P"),
            c if c.is_control() => quoted.push_str(&format!("${:0digits$X}", c as u32)),
            c => quoted.push(c),
        }
    }
    quoted + "'"
}

/// `-1h30m0.5s`
fn duration(ns: i128) -> String {
    let (sign, ns) = (if ns < 0 { "-" } else { "" }, ns.unsigned_abs());
    let mut text = sign.to_string();
    let mut rest = ns;
    for (unit, length) in [
        ("d", 86_400_000_000_000),
        ("h", 3_600_000_000_000),
        ("m", 60_000_000_000),
        ("s", 1_000_000_000),
        ("ms", 1_000_000),
        ("us", 1000),
        ("ns", 1),
    ] {
        if rest >= length {
            text.push_str(&format!("{}{unit}", rest / length));
            rest %= length;
        }
    }
    if ns == 0 { "0ms".to_string() } else { text }
}

/// `5:45:00.5`
fn clock(ns: i128) -> String {
    let seconds = ns / i128::from(NS_PER_S);
    let fraction = format!("{:09}", ns % i128::from(NS_PER_S));
    let fraction = fraction.trim_end_matches('0');
    let point = if fraction.is_empty() { "" } else { "." };
    format!("{:02}:{:02}:{:02}{point}{fraction}", seconds / 3600, seconds / 60 % 60, seconds % 60)
}

/// A moment, nanoseconds since 1970; the number has no meaning for a clock of the host.
fn moment(ns: i128, with_time: bool) -> String {
    let day = i128::from(NS_PER_S) * 86_400;
    match i64::try_from(ns) {
        Ok(moment) => {
            let date = datetime::civil(moment).date();
            if with_time { format!("{date}-{}", clock(ns.rem_euclid(day))) } else { date.to_string() }
        }
        Err(_) => format!("{} days after 1970-01-01", signal::number_text((ns / day) as f64)),
    }
}

/// Nanoseconds since 1970 of a DTL; `None`: no date. Source: TIA Portal help, format of DTL.
fn dtl(bytes: &[u8; 12]) -> Option<i128> {
    let year = i16::from_be_bytes([bytes[0], bytes[1]]);
    let part = |index: usize| i8::try_from(bytes[index]).ok();
    let date = jiff::civil::Date::new(year, part(2)?, part(3)?).ok()?;
    let ns = u32::from_be_bytes([bytes[8], bytes[9], bytes[10], bytes[11]]);
    if bytes[5] > 23 || bytes[6] > 59 || bytes[7] > 59 || i64::from(ns) >= NS_PER_S {
        return None;
    }
    let epoch = jiff::civil::Date::new(1970, 1, 1).ok()?;
    let days = i128::from(date.since(epoch).ok()?.get_days());
    let seconds = (i128::from(bytes[5]) * 60 + i128::from(bytes[6])) * 60 + i128::from(bytes[7]);
    Some((days * 86_400 + seconds) * i128::from(NS_PER_S) + i128::from(ns))
}

/// The byte of a character in Windows-1252.
pub fn byte_of(character: u16) -> Option<u8> {
    (0..=255u8).find(|&byte| windows_1252(byte.into()) == character)
}

/// The character of a byte of Windows-1252.
pub(crate) fn windows_1252(byte: u16) -> u16 {
    const HIGH: [u16; 32] = [
        0x20AC, 0x81, 0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021, 0x02C6, 0x2030, 0x0160, 0x2039, 0x0152, 0x8D,
        0x017D, 0x8F, 0x90, 0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014, 0x02DC, 0x2122, 0x0161, 0x203A,
        0x0153, 0x9D, 0x017E, 0x0178,
    ];
    byte.checked_sub(0x80).and_then(|index| HIGH.get(usize::from(index)).copied()).unwrap_or(byte)
}
