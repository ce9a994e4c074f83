//! What is retentive on a CPU, as bytes: one item for each data block and each part of an area.
//!
//! A content is a head and items. The head: bit 0 is 1 if everything was kept for a hot restart, the other bits of the byte are the number
//! of the [family], 0 is any; the milliseconds that the timers of the CPU have counted (`u64`); the name of the program (length `u16`). An
//! item: kind, number (`u16`), signature (`u64`), length (`u32`), and so many bytes. Numbers are little-endian. An item comes back only into
//! one with the same signature. Data blocks with symbolic names are found by them: their bytes begin with the name (length `u16`), and the
//! number is only for messages.

use plcc_abi::image::{DbEntry, Family, Kept};
use plcc_abi::layout::{self, COUNTER_CELL_BYTES};
use plcc_abi::names::{NamedType, TypeNumber};
use plcc_abi::s7200::{COUNTERS, V_DB};

use super::references::{self, Reference};
use super::{family, numbers};
use crate::cpu::{Area, Cpu};
use crate::timers;

/// Bytes of the head before the name.
const HEAD_BYTES: usize = 1 + 8 + 2;
/// Where the head has what changes with time alone.
pub(super) const TIME: std::ops::Range<usize> = 1..9;

/// Which memory an item is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub(super) enum Kind {
    BitMemory = 1,
    Timers = 2,
    Counters = 3,
    Db = 4,
    Outputs = 5,
    Meters = 6,
    /// Timers and counters of an S7-200.
    S7200Cells = 7,
    /// V bytes in the permanent memory of an S7-200.
    Permanent = 8,
    /// A data block of an S7-1200/1500 with a name: the number is that of the compiler, and another one after a change of the program.
    NamedDb = 9,
    /// Which data blocks the program has, if references into them are retentive.
    Blocks = 10,
    /// Without bytes: the signature is that of the sources, for a hot restart.
    Program = 11,
}

/// A part of memory that is kept, in bits from the memory base.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Bits {
    first: u64,
    count: u64,
}

impl Bits {
    fn bytes(first: u32, count: u32) -> Bits {
        Bits { first: 8 * u64::from(first), count: 8 * u64::from(count) }
    }

    /// The bytes that have some of them: offset and length.
    fn cover(self) -> (u32, u32) {
        let (start, end) = (self.first / 8, (self.first + self.count).div_ceil(8));
        (start as u32, (end - start) as u32)
    }

    /// Of byte `offset` the bits that belong here.
    fn mask(self, offset: u32) -> u8 {
        let start = 8 * u64::from(offset);
        (0..8)
            .filter(|bit| (self.first..self.first + self.count).contains(&(start + bit)))
            .fold(0, |mask, bit| mask | 1 << bit)
    }
}

/// Where the bytes of an item are.
#[derive(Clone, Debug)]
enum Place {
    Memory(Vec<Bits>),
    /// So many S5 timers from T0.
    Timers(u32),
    Meters,
    Permanent,
    /// Numbers of data blocks, and what tells each from another one with its number.
    Blocks(Vec<(u16, u64)>),
}

/// An item of this CPU.
#[derive(Clone, Debug)]
struct Item {
    kind: Kind,
    number: u16,
    /// Of a [`Kind::NamedDb`], in small letters.
    name: String,
    signature: u64,
    place: Place,
}

/// The retentive memory of a CPU.
#[derive(Debug)]
pub(crate) struct Items {
    /// For a hot restart: all memory, not only what is retentive.
    everything: bool,
    items: Vec<Item>,
    references: Vec<Reference>,
}

/// What came back.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Loaded {
    /// Data blocks that begin with their start values, because they differ from those that were kept.
    pub changed: Vec<u16>,
    /// Data blocks that were kept and are not in the program, as messages name them.
    pub gone: Vec<String>,
    /// How many references begin with their initial values, because their data blocks are others.
    pub references: usize,
    /// All that is kept came back.
    pub complete: bool,
}

/// Why nothing came back.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Refused {
    Damaged,
    /// Another program has written it, or this one for another family: what a message says of the file.
    Program(String),
}

impl Cpu {
    /// How many bytes of bit memory, timers and counters are retentive.
    pub fn retentive_amounts(&self) -> [u32; 3] {
        let (profile, config) = (&self.image.profile, &self.image.config.retain);
        let (_, m_bytes) = self.area(Area::BitMemory);
        if profile.family == Family::S7200 {
            let cells: u32 = self.s7200_retentive_cells().map(|(_, bytes)| bytes / 2).sum();
            return [m_bytes.saturating_sub(S7200_M_FIRST), cells - COUNTERS, COUNTERS];
        }
        let defaults = Defaults::of(profile.family);
        let count = |given: Option<u32>, default: u32, all: u32| given.unwrap_or(default).min(all);
        [
            count(config.bit_memory, defaults.bit_memory, m_bytes),
            count(config.timers, defaults.timers, profile.timers.min(layout::TIMERS_MAX)),
            count(config.counters, defaults.counters, profile.counters.min(layout::TIMERS_MAX)),
        ]
    }
}

impl Items {
    /// What is retentive on this CPU; with `everything`, all of its memory.
    pub(crate) fn of(cpu: &Cpu, everything: bool) -> Items {
        let mut items = Vec::new();
        let mut add = |kind, number, signature, place| {
            items.push(Item { kind, number, name: String::new(), signature, place });
        };
        let (m, m_bytes) = cpu.area(Area::BitMemory);
        let profile = &cpu.image.profile;
        if profile.family == Family::S7200 {
            let first = S7200_M_FIRST.min(m_bytes);
            add(Kind::BitMemory, 0, 0, Place::Memory(vec![Bits::bytes(m + first, m_bytes - first)]));
            add(
                Kind::S7200Cells,
                0,
                0,
                Place::Memory(cpu.s7200_retentive_cells().map(|(at, n)| Bits::bytes(at, n)).collect()),
            );
            let v = cpu.image.dbs.iter().find(|db| db.number == V_DB);
            let signature = v.map_or(0, |db| Signature::default().bytes(&db.data).0);
            let (at, bytes) = cpu.memory.db(V_DB);
            // Before V, whose values are newer.
            add(Kind::Permanent, 0, signature, Place::Permanent);
            add(Kind::Db, V_DB, signature, Place::Memory(vec![Bits::bytes(at, bytes)]));
            return Items { everything: false, items, references: Vec::new() };
        }
        let [m_kept, timers, counters] = match everything {
            true => [m_bytes, profile.timers.min(layout::TIMERS_MAX), profile.counters.min(layout::TIMERS_MAX)],
            false => cpu.retentive_amounts(),
        };
        add(Kind::BitMemory, 0, 0, Place::Memory(vec![Bits::bytes(m, m_kept)]));
        add(Kind::Timers, 0, 0, Place::Timers(timers));
        add(Kind::Counters, 0, 0, Place::Memory(vec![Bits::bytes(layout::C, counters * COUNTER_CELL_BYTES)]));
        add(Kind::Meters, 0, 0, Place::Meters);
        if everything {
            let (q, q_bytes) = cpu.area(Area::Outputs);
            add(Kind::Outputs, 0, 0, Place::Memory(vec![Bits::bytes(q, q_bytes)]));
            add(Kind::Program, 0, cpu.image.sources_sum, Place::Memory(Vec::new()));
        }
        let (mut references, types) = (Vec::new(), &cpu.image.types);
        for db in cpu.image.dbs.iter().filter(|db| !db.unlinked && !db.read_only) {
            let start = 8 * u64::from(db.address);
            let whole = vec![Bits::bytes(db.address, db.data.len() as u32)];
            let bits = match &db.kept {
                _ if everything => whole,
                Kept::Nothing => continue,
                Kept::Everything => whole,
                Kept::Bits(bits) => bits
                    .iter()
                    .map(|&(first, count)| Bits { first: start + u64::from(first), count: count.into() })
                    .collect(),
            };
            let by_name = profile.family.is_portal() && !db.name.is_empty();
            let kind = if by_name { Kind::NamedDb } else { Kind::Db };
            let name = if by_name { db.name.to_lowercase() } else { String::new() };
            let (signature, place) = (signature_of(db, types), Place::Memory(bits));
            items.push(Item { kind, number: db.number, name, signature, place });
            if profile.family.is_portal() {
                references.extend(references::references(db, types));
            }
        }
        if !references.is_empty() {
            let block = |db: &DbEntry| {
                let layout = signature_of(db, types).to_le_bytes();
                (db.number, Signature::default().text(&db.name).bytes(&layout).0)
            };
            let place = Place::Blocks(cpu.image.dbs.iter().map(block).collect());
            items.push(Item { kind: Kind::Blocks, number: 0, name: String::new(), signature: 0, place });
        }
        Items { everything, items, references }
    }

    /// All memory is kept, for a hot restart.
    pub(crate) fn is_everything(&self) -> bool {
        self.everything
    }

    /// Puts the content of this moment into `content`.
    pub(crate) fn collect(&self, cpu: &Cpu, content: &mut Vec<u8>) {
        content.clear();
        content.push(family::number(cpu.image.profile.family) << 1 | u8::from(self.everything));
        content.extend(cpu.clock.counted().to_le_bytes());
        let name = cpu.image.name.as_bytes();
        let name = &name[..name.len().min(usize::from(u16::MAX))];
        content.extend((name.len() as u16).to_le_bytes());
        content.extend(name);
        for item in &self.items {
            content.push(item.kind as u8);
            content.extend(item.number.to_le_bytes());
            content.extend(item.signature.to_le_bytes());
            let length = content.len();
            content.extend([0; 4]);
            if item.kind == Kind::NamedDb {
                content.extend((item.name.len() as u16).to_le_bytes());
                content.extend(item.name.as_bytes());
            }
            item.collect(cpu, content);
            let bytes = (content.len() - length - 4) as u32;
            content[length..length + 4].copy_from_slice(&bytes.to_le_bytes());
        }
    }

    /// Brings a content back. For a hot restart it must have everything, see [`Loaded::complete`].
    pub(crate) fn load(&self, cpu: &Cpu, content: &[u8]) -> Result<Loaded, Refused> {
        let (head, rest) = content.split_at_checked(HEAD_BYTES).ok_or(Refused::Damaged)?;
        let name_bytes = usize::from(u16::from_le_bytes([head[9], head[10]]));
        let (name, rest) = rest.split_at_checked(name_bytes).ok_or(Refused::Damaged)?;
        if name != cpu.image.name.as_bytes() {
            return Err(Refused::Program(format!("is of the program `{}`", String::from_utf8_lossy(name))));
        }
        if let Some(why) = family::difference(head[0] >> 1, cpu.image.profile.family) {
            return Err(Refused::Program(why));
        }
        let kept = parts(rest).ok_or(Refused::Damaged)?;
        let is_alike = head[0] & 1 == u8::from(self.everything);
        let mut loaded = Loaded { complete: is_alike, ..Loaded::default() };
        let find = |item: &Item| kept.iter().find(|part| part.is_of(item));
        if self.everything
            && !(loaded.complete && self.items.iter().all(|item| find(item).is_some_and(|part| part.fits(item))))
        {
            loaded.complete = false;
            return Ok(loaded);
        }
        for item in &self.items {
            match find(item) {
                Some(part) if part.fits(item) => item.load(cpu, part.bytes),
                Some(_) => loaded.changed.extend(matches!(item.kind, Kind::Db | Kind::NamedDb).then_some(item.number)),
                None => {}
            }
        }
        if !self.references.is_empty() {
            let blocks = kept.iter().find(|part| part.kind == Kind::Blocks as u8).map_or(&[][..], |part| part.bytes);
            loaded.references = self.reset_references(cpu, blocks);
        }
        // What was kept for a hot restart is not retentive, as far as it is more.
        if is_alike {
            loaded.gone = kept.iter().filter_map(|part| part.gone(&cpu.image.dbs)).collect();
        }
        let counted = head[TIME].try_into().map_or(0, u64::from_le_bytes);
        cpu.clock.count_from(counted);
        Ok(loaded)
    }
}

impl Items {
    /// Gives references into data blocks that are not among the kept ones their initial values. Result: how many.
    fn reset_references(&self, cpu: &Cpu, kept: &[u8]) -> usize {
        let own = self.items.iter().filter_map(|item| match &item.place {
            Place::Blocks(blocks) => Some(blocks),
            Place::Memory(_) | Place::Timers(_) | Place::Meters | Place::Permanent => None,
        });
        let own: Vec<&(u16, u64)> = own.flatten().collect();
        let is_kept = |block: &(u16, u64)| kept.chunks_exact(BLOCK_BYTES).any(|one| one == block_bytes(block));
        let is_same = |number: u16| own.iter().any(|&block| block.0 == number && is_kept(block));
        let lost = self.references.iter().filter(|reference| {
            let number = cpu.memory.word(reference.at);
            let is_lost = number != 0 && !is_same(number);
            if is_lost {
                cpu.memory.load(reference.at, &reference.initial);
            }
            is_lost
        });
        lost.count()
    }
}

/// An entry of [`Kind::Blocks`].
const BLOCK_BYTES: usize = 2 + 8;

fn block_bytes((number, signature): &(u16, u64)) -> [u8; BLOCK_BYTES] {
    let mut bytes = [0; BLOCK_BYTES];
    bytes[..2].copy_from_slice(&number.to_le_bytes());
    bytes[2..].copy_from_slice(&signature.to_le_bytes());
    bytes
}

/// An item in a content.
struct Part<'a> {
    kind: u8,
    number: u16,
    name: &'a [u8],
    signature: u64,
    bytes: &'a [u8],
}

impl Part<'_> {
    /// It is of the same memory.
    fn is_of(&self, item: &Item) -> bool {
        self.kind == item.kind as u8
            && match item.kind {
                Kind::NamedDb => self.name == item.name.as_bytes(),
                _ => self.number == item.number,
            }
    }

    fn fits(&self, item: &Item) -> bool {
        self.signature == item.signature
    }

    /// The data block that it is of, if that is not among those of the program.
    fn gone(&self, dbs: &[DbEntry]) -> Option<String> {
        if self.kind == Kind::NamedDb as u8 {
            let is_there = dbs.iter().any(|db| db.name.to_lowercase().as_bytes() == self.name);
            return (!is_there).then(|| format!("\"{}\"", String::from_utf8_lossy(self.name)));
        }
        let is_there = self.kind != Kind::Db as u8 || dbs.iter().any(|db| db.number == self.number);
        (!is_there).then(|| format!("DB {}", self.number))
    }
}

/// The items of a content; `None`: it is cut.
fn parts(mut rest: &[u8]) -> Option<Vec<Part<'_>>> {
    let mut parts = Vec::new();
    while let Some((&[kind, low, high], after)) = rest.split_first_chunk::<3>() {
        let (signature, after) = after.split_first_chunk::<8>()?;
        let (length, after) = after.split_first_chunk::<4>()?;
        let (bytes, after) = after.split_at_checked(u32::from_le_bytes(*length) as usize)?;
        let signature = u64::from_le_bytes(*signature);
        let (name, bytes) = if kind == Kind::NamedDb as u8 {
            let (length, bytes) = bytes.split_first_chunk::<2>()?;
            bytes.split_at_checked(u16::from_le_bytes(*length).into())?
        } else {
            bytes.split_at(0)
        };
        parts.push(Part { kind, number: u16::from_le_bytes([low, high]), name, signature, bytes });
        rest = after;
    }
    rest.is_empty().then_some(parts)
}

impl Item {
    fn collect(&self, cpu: &Cpu, content: &mut Vec<u8>) {
        match &self.place {
            Place::Memory(bits) => {
                for bits in bits {
                    let (start, bytes) = bits.cover();
                    let from = content.len();
                    cpu.memory.view(start, bytes, |values| content.extend(values));
                    // Bits beside it do not count as changes.
                    if bits.first % 8 != 0 || bits.count % 8 != 0 {
                        let ends = [(from, start), (content.len() - 1, start + bytes - 1)];
                        ends.into_iter().for_each(|(index, offset)| content[index] &= bits.mask(offset));
                    }
                }
            }
            Place::Timers(count) => {
                (0..*count).for_each(|number| content.extend(timers::kept(&cpu.memory, &cpu.clock, number)))
            }
            Place::Meters => cpu.meters.iter().for_each(|meter| content.extend(meter.kept(cpu.clock.now()))),
            Place::Permanent => cpu.s7200_permanent(content),
            Place::Blocks(blocks) => blocks.iter().for_each(|block| content.extend(block_bytes(block))),
        }
    }

    fn load(&self, cpu: &Cpu, mut values: &[u8]) {
        match &self.place {
            Place::Memory(bits) => {
                for bits in bits {
                    let (start, bytes) = bits.cover();
                    for offset in start..start.saturating_add(bytes) {
                        let Some((&value, rest)) = values.split_first() else { return };
                        values = rest;
                        let mask = bits.mask(offset);
                        cpu.memory.set_byte(offset, cpu.memory.byte(offset) & !mask | value & mask);
                    }
                }
            }
            Place::Timers(count) => {
                let chunks = values.chunks_exact(timers::KEPT_BYTES);
                (0..*count)
                    .zip(chunks)
                    .for_each(|(number, kept)| timers::bring_back(&cpu.memory, &cpu.clock, number, kept));
            }
            Place::Meters => {
                let chunks = values.chunks_exact(crate::system::meters::KEPT_BYTES);
                cpu.meters.iter().zip(chunks).for_each(|(meter, kept)| meter.bring_back(kept));
            }
            Place::Permanent => cpu.s7200_bring_back_permanent(values),
            // It is only compared.
            Place::Blocks(_) => {}
        }
    }
}

/// First byte of M that is retentive on an S7-200. Source: S7-200 system manual, storing and restoring data.
const S7200_M_FIRST: u32 = 14;

/// What is retentive without configuration, from the first on.
struct Defaults {
    /// Bytes.
    bit_memory: u32,
    timers: u32,
    counters: u32,
}

impl Defaults {
    /// Source: CPU manuals, retentive memory: MB 0 to 15 and C 0 to 7 on an S7-300/400, nothing on an S7-1200/1500.
    fn of(family: Family) -> Defaults {
        match family {
            Family::S7300 | Family::S7400 => Defaults { bit_memory: 16, timers: 0, counters: 8 },
            Family::S7200 | Family::S71200 | Family::S71500 => Defaults { bit_memory: 0, timers: 0, counters: 0 },
        }
    }
}

/// FNV-1a of what makes two layouts the same.
struct Signature(u64);

impl Default for Signature {
    fn default() -> Signature {
        Signature(0xCBF2_9CE4_8422_2325)
    }
}

impl Signature {
    fn bytes(self, bytes: &[u8]) -> Signature {
        Signature(bytes.iter().fold(self.0, |sum, &byte| (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3)))
    }

    fn number(self, number: u32) -> Signature {
        self.bytes(&number.to_le_bytes())
    }

    fn text(self, text: &str) -> Signature {
        // Names of the CPU do not distinguish case.
        self.number(text.len() as u32).bytes(text.to_lowercase().as_bytes())
    }

    /// Names, types and places of all components.
    fn ty(self, ty: TypeNumber, types: &[NamedType]) -> Signature {
        match types.get(ty as usize) {
            None => self,
            Some(NamedType::Value(value)) => self.text(&format!("{value:?}")),
            Some(NamedType::Text { wide, length }) => {
                self.text(if *wide { "wide" } else { "text" }).number((*length).into())
            }
            Some(NamedType::Array { dimensions, element }) => {
                let all = dimensions.iter().fold(self.text("array"), |sum, one| {
                    sum.bytes(&one.low.to_le_bytes()).bytes(&one.high.to_le_bytes()).number(one.distance)
                });
                // A type has a larger number than those that it contains.
                if *element < ty { all.ty(*element, types) } else { all }
            }
            Some(NamedType::Struct(all)) => all.members.iter().fold(self.text("struct"), |sum, member| {
                let sum = sum.text(&member.name).number(member.byte).number(member.bit.into());
                if member.ty < ty { sum.ty(member.ty, types) } else { sum }
            }),
            Some(NamedType::Other { name }) => self.text(name),
        }
    }
}

/// The signature of a data block's layout, and of which parts of it are retentive.
fn signature_of(db: &DbEntry, types: &[NamedType]) -> u64 {
    let sum = Signature::default().number(db.data.len() as u32);
    let sum = db.ty.map_or(Signature(sum.0), |ty| Signature(sum.0).ty(ty, types));
    let sum = numbers::numbers(db, types).into_iter().fold(sum, |sum, number| sum.number(number.into()));
    match &db.kept {
        Kept::Nothing | Kept::Everything => sum.0,
        Kept::Bits(bits) => bits.iter().fold(sum, |sum, (first, count)| sum.number(*first).number(*count)).0,
    }
}
