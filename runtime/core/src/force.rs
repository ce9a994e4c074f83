//! Forcing: inputs, outputs and memory that have a fixed value, whatever modules and program say.
//!
//! | Family | Inputs | Outputs |
//! | --- | --- | --- |
//! | S7-200 | in the process image, after it was read; analog ones whenever they are read | at the module: image, immediate and analog outputs; the image keeps the value of the program |
//! | S7-300 | in the process image, after it was read | in the process image, before it is written; `T PQW` goes to the module |
//! | S7-400 | also direct reading | also direct writing, which changes nothing |
//! | S7-1200/1500 | at the module: image and `:P` | at the module: image and `:P`; the image keeps the value of the program |
//!
//! Bit memory of an S7-400, and M and V of an S7-200, have their forced values before and after the program runs; what the program writes there
//! counts until it has ended.
//!
//! Forced values stay until they are ended: through STOP, restarts and changes of the program, and with a file also through the end of the
//! process, see [`file`].
//!
//! Source: CPU manuals, test functions; Programming with STEP 7, 20.8; S7-200 system manual, forcing values.

mod file;

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::path::PathBuf;

use plcc_abi::image::Family;
use plcc_abi::layout;
use plcc_abi::s7200::ANALOG_ADDRESS;

use crate::address::{Address, Place, Width};
use crate::cpu::Cpu;
use crate::diagnostics::{self, NO_SITE};
use crate::s7200::Part;
use crate::watch::format::Format;
use crate::watch::{self, Settled};
pub(crate) use file::Table;

/// A forced value as a user sees it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Forced {
    pub name: String,
    /// As the user wrote it.
    pub value: String,
    pub comment: String,
    format: Option<Format>,
    address: Address,
    bits: u64,
}

/// Which bits of a byte are forced, and their values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Mask {
    bits: u8,
    value: u8,
}

impl Mask {
    fn over(self, byte: u8) -> u8 {
        byte & !self.bits | self.value
    }
}

/// Values are forced.
const FORCING: u8 = 1;
/// Clients modify values in the cycle, see [`crate::modify`].
const MODIFYING: u8 = 2;

/// All forced values of a CPU.
#[derive(Default)]
pub(crate) struct Force {
    /// [`FORCING`] and [`MODIFYING`]: the cycle looks at nothing else.
    active: Cell<u8>,
    table: RefCell<Vec<Forced>>,
    inputs: RefCell<BTreeMap<u32, Mask>>,
    outputs: RefCell<BTreeMap<u32, Mask>>,
    /// By offset from the memory base.
    memory: RefCell<BTreeMap<u32, Mask>>,
    /// Where the table is kept.
    file: RefCell<Option<PathBuf>>,
}

/// Values that can be forced; of an S7-200 those in M, V, AI and AQ. Source: technical data of the CPUs.
pub const fn count_max(family: Family) -> usize {
    match family {
        Family::S7300 => 10,
        Family::S7400 => 256,
        Family::S71500 => 200,
        Family::S71200 => 1024,
        Family::S7200 => 16,
    }
}

impl Forced {
    /// The format in which the value was given.
    pub fn format(&self) -> Option<Format> {
        self.format
    }

    /// The value in its format, or as the user wrote it.
    pub fn text(&self) -> String {
        self.format.map_or_else(|| self.value.clone(), |format| format.show(self.bits, self.address.width))
    }

    /// The address in the words of the program, `I0.0`, `QW6`, `AIW4`; that of the module is the one of the input or output.
    pub fn address(&self) -> String {
        let (area, number) = match self.address.place {
            Place::Input(byte) | Place::PeripheralInput(byte) => ("I", byte),
            Place::Output(byte) | Place::PeripheralOutput(byte) => ("Q", byte),
            Place::BitMemory(byte) => ("M", byte),
            Place::Db(_, byte) => ("V", byte),
            Place::S7200(Part::AnalogInput, byte) => ("AI", byte),
            Place::S7200(Part::AnalogOutput, byte) => ("AQ", byte),
            // None of these is forced.
            Place::Timer(_) | Place::Counter(_) | Place::TimerValue(_) | Place::CounterValue(_) | Place::S7200(..) => {
                return self.name.clone();
            }
        };
        match self.address.width {
            Width::Bit(bit) => format!("{area}{number}.{bit}"),
            Width::Byte => format!("{area}B{number}"),
            Width::Word => format!("{area}W{number}"),
            Width::Dword => format!("{area}D{number}"),
            Width::Lword => format!("{area}L{number}"),
        }
    }

    /// Whether a value at an address has a forced bit. `modules`: forcing is at the module, so the addresses of the periphery count too.
    pub fn covers(&self, other: &Address, modules: bool) -> bool {
        let (Some((own, from)), Some((area, at))) = (covered(&self.address, true), covered(other, modules)) else {
            return false;
        };
        let bits = |first: u32, width: Width| match width {
            Width::Bit(bit) => (8 * u64::from(first) + u64::from(bit), 1),
            _ => (8 * u64::from(first), u64::from(width.bits())),
        };
        let ((start, length), (begin, count)) = (bits(from, self.address.width), bits(at, other.width));
        own == area && start < begin + count && begin < start + length
    }
}

/// Whether CPUs of the family force values of this area.
pub const fn is_forced_area(place: Place, family: Family) -> bool {
    match place {
        Place::Input(_) | Place::Output(_) => true,
        Place::PeripheralInput(_) | Place::PeripheralOutput(_) => !matches!(family, Family::S7200 | Family::S7300),
        Place::S7200(part, _) => matches!(part, Part::AnalogInput | Part::AnalogOutput),
        Place::BitMemory(_) => matches!(family, Family::S7400 | Family::S7200),
        Place::Db(..) => matches!(family, Family::S7200),
        Place::Timer(_) | Place::Counter(_) | Place::TimerValue(_) | Place::CounterValue(_) => false,
    }
}

/// A letter for the area, and the byte there.
fn covered(address: &Address, modules: bool) -> Option<(char, u32)> {
    match address.place {
        Place::Input(byte) => Some(('I', byte)),
        Place::Output(byte) => Some(('Q', byte)),
        Place::PeripheralInput(byte) if modules => Some(('I', byte)),
        Place::PeripheralOutput(byte) if modules => Some(('Q', byte)),
        Place::BitMemory(byte) => Some(('M', byte)),
        Place::Db(_, byte) => Some(('V', byte)),
        Place::S7200(Part::AnalogInput, byte) => Some(('A', byte)),
        Place::S7200(Part::AnalogOutput, byte) => Some(('B', byte)),
        Place::PeripheralInput(_)
        | Place::PeripheralOutput(_)
        | Place::Timer(_)
        | Place::Counter(_)
        | Place::TimerValue(_)
        | Place::CounterValue(_)
        | Place::S7200(..) => None,
    }
}

/// What a forced value is part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Target {
    Inputs,
    Outputs,
    Memory,
}

impl Force {
    fn masks(&self, target: Target) -> &RefCell<BTreeMap<u32, Mask>> {
        match target {
            Target::Inputs => &self.inputs,
            Target::Outputs => &self.outputs,
            Target::Memory => &self.memory,
        }
    }
}

/// The bytes of a value, the first one highest.
fn bytes(first: u32, width: Width, bits: u64) -> impl Iterator<Item = (u32, Mask)> {
    let count = width.bytes();
    (0..count).map(move |index| {
        let mask = match width {
            Width::Bit(bit) => Mask { bits: 1 << (bit & 7), value: ((bits & 1) as u8) << (bit & 7) },
            _ => Mask { bits: 0xFF, value: (bits >> (8 * (count - 1 - index))) as u8 },
        };
        (first + index, mask)
    })
}

/// `value` of so many bytes with the forced bits.
fn over(masks: &BTreeMap<u32, Mask>, address: u32, bytes: u32, value: u32) -> u32 {
    (0..bytes).fold(value, |value, index| {
        let shift = 8 * (bytes - 1 - index);
        match masks.get(&address.saturating_add(index)) {
            Some(mask) => value & !(0xFF << shift) | u32::from(mask.over((value >> shift) as u8)) << shift,
            None => value,
        }
    })
}

impl Cpu {
    /// Values are forced.
    #[inline(always)]
    pub fn is_forcing(&self) -> bool {
        self.force.active.get() & FORCING != 0
    }

    /// Values are forced, or modified by clients: the cycle has more to do when inputs were read and before outputs are written.
    #[inline(always)]
    pub(crate) fn is_interfered(&self) -> bool {
        self.force.active.get() != 0
    }

    /// Clients modify values in the cycle.
    pub(crate) fn is_modifying(&self) -> bool {
        self.force.active.get() & MODIFYING != 0
    }

    pub(crate) fn set_modifying(&self, is_modifying: bool) {
        let others = self.force.active.get() & !MODIFYING;
        self.force.active.set(others | if is_modifying { MODIFYING } else { 0 });
    }

    /// The forced values.
    pub fn forced(&self) -> Vec<Forced> {
        self.force.table.borrow().clone()
    }

    /// Forces a value, or changes a forced one. `Err`: why not.
    pub fn force(&self, name: &str, value: &str) -> Result<(), String> {
        self.force_as(name, value, None)
    }

    /// As [`Cpu::force`], with a value in a format.
    pub fn force_as(&self, name: &str, value: &str, format: Option<Format>) -> Result<(), String> {
        self.force_row(name, value, format, "")?;
        self.force_changed();
        Ok(())
    }

    /// Where a value is forced, with its first byte there, in memory its offset; `None`: this CPU cannot force it.
    fn forced_place(&self, address: &Address) -> Option<(Target, u32)> {
        let place = address.place;
        if !is_forced_area(place, self.image.profile.family) {
            return None;
        }
        Some(match place {
            Place::Input(byte) | Place::PeripheralInput(byte) => (Target::Inputs, byte),
            Place::Output(byte) | Place::PeripheralOutput(byte) => (Target::Outputs, byte),
            Place::S7200(Part::AnalogInput, byte) => (Target::Inputs, ANALOG_ADDRESS + byte),
            Place::S7200(Part::AnalogOutput, byte) => (Target::Outputs, ANALOG_ADDRESS + byte),
            _ => (Target::Memory, self.offset_of(place)?),
        })
    }

    fn renew_force(&self) {
        let table = self.force.table.borrow();
        for target in [Target::Inputs, Target::Outputs, Target::Memory] {
            let mut masks = BTreeMap::<u32, Mask>::new();
            for one in table.iter() {
                let Some((_, first)) = self.forced_place(&one.address).filter(|(of, _)| *of == target) else {
                    continue;
                };
                for (byte, mask) in bytes(first, one.address.width, one.bits) {
                    let known = masks.entry(byte).or_default();
                    known.bits |= mask.bits;
                    known.value |= mask.value;
                }
            }
            self.force.masks(target).replace(masks);
        }
        let others = self.force.active.get() & !FORCING;
        self.force.active.set(others | if table.is_empty() { 0 } else { FORCING });
        self.s7200_show_forced();
    }

    fn force_row(&self, name: &str, value: &str, format: Option<Format>, comment: &str) -> Result<(), String> {
        let family = self.image.profile.family;
        // As STEP 7 writes the module of an address.
        let plain = name.trim().strip_suffix(":P").or_else(|| name.trim().strip_suffix(":p")).unwrap_or(name.trim());
        let Settled { address, bits } = watch::settle(plain, value, format, self)?;
        let is_module = matches!(address.place, Place::PeripheralInput(_) | Place::PeripheralOutput(_));
        if family == Family::S7300 && is_module {
            return Err(format!("an S7-300 forces I and Q of the process image, not {name}"));
        }
        let Some((target, first)) = self.forced_place(&address) else {
            return Err(match family {
                Family::S7200 => format!("an S7-200 forces I, Q, M, V, AI and AQ, not {name}"),
                Family::S7400 => {
                    format!("{name} is neither an input nor an output nor bit memory: only these are forced")
                }
                Family::S7300 | Family::S71200 | Family::S71500 => {
                    format!("{name} is neither an input nor an output: only these are forced")
                }
            });
        };
        let mut table = self.force.table.borrow_mut();
        let known = table.iter().position(|one| one.name == name);
        let is_same_bit = |other: &Forced| {
            self.forced_place(&other.address).is_some_and(|(of, from)| {
                of == target
                    && bytes(first, address.width, bits).any(|(byte, mask)| {
                        bytes(from, other.address.width, other.bits)
                            .any(|(also, theirs)| also == byte && theirs.bits & mask.bits != 0)
                    })
            })
        };
        let mut others = table.iter().enumerate().filter(|(index, _)| Some(*index) != known).map(|(_, other)| other);
        if let Some(other) = others.find(|other| is_same_bit(other)) {
            return Err(format!("{name} overlaps {}, which is forced too: only one of them can be", other.name));
        }
        // An S7-200 forces any number of inputs and outputs that are not analog.
        let counts =
            |(of, first): (Target, u32)| family != Family::S7200 || of == Target::Memory || first >= ANALOG_ADDRESS;
        let is_counted = |one: &&Forced| self.forced_place(&one.address).is_some_and(counts);
        if known.is_none() && counts((target, first)) && table.iter().filter(is_counted).count() >= count_max(family) {
            let what = if family == Family::S7200 { "values of M, V, AI and AQ" } else { "values" };
            return Err(format!("this CPU forces {} {what} at most", count_max(family)));
        }
        // When it is no longer forced, the value of the module comes back.
        self.name_input(&address);
        let row = Forced {
            name: name.to_string(),
            value: value.to_string(),
            comment: comment.to_string(),
            format,
            address,
            bits,
        };
        match known {
            Some(index) => table[index] = row,
            None => table.push(row),
        }
        Ok(())
    }

    /// Ends the forcing of a value, or of all. `Err`: it is not forced.
    pub fn unforce(&self, name: Option<&str>) -> Result<(), String> {
        if name.is_some_and(|name| name.trim().is_empty()) {
            return Err("the name is empty: write that of a forced value, or none to end all forcing".to_string());
        }
        let ended: Vec<Forced> = {
            let mut table = self.force.table.borrow_mut();
            match name {
                None => table.drain(..).collect(),
                Some(name) => {
                    let at = table.iter().position(|one| one.name == name);
                    vec![table.remove(at.ok_or_else(|| format!("{name} is not forced"))?)]
                }
            }
        };
        self.force_changed();
        // No image of them is written in each scan.
        for one in ended {
            if let (Place::S7200(Part::AnalogOutput, byte), false) = (one.address.place, self.is_stopped()) {
                self.s7200_analog_out(byte, 2);
            }
        }
        Ok(())
    }

    fn force_changed(&self) {
        self.end_enabling();
        self.renew_force();
        // Outputs fall to what the image says, also those that no code writes.
        self.note_outputs(u32::MAX);
        let count = self.force.table.borrow().len() as u32;
        self.log(if count > 0 { diagnostics::FORCE_ACTIVE } else { diagnostics::FORCE_ENDED }, NO_SITE, count);
        if let Some(path) = &*self.force.file.borrow()
            && let Err(error) = self.write_force(path)
        {
            crate::run::say!("runtime: cannot write forced values to {}: {error}", path.display());
        }
    }

    /// The inputs were read.
    #[cold]
    pub(crate) fn force_inputs(&self) {
        for (&byte, mask) in &*self.force.inputs.borrow() {
            if byte < self.area(crate::cpu::Area::Inputs).1 {
                self.memory.set_byte(layout::I + byte, mask.over(self.memory.byte(layout::I + byte)));
            }
        }
    }

    /// Before the program runs, and after it.
    #[cold]
    pub(crate) fn force_memory(&self) {
        for (&offset, mask) in &*self.force.memory.borrow() {
            self.memory.set_byte(offset, mask.over(self.memory.byte(offset)));
        }
    }

    /// The process image of outputs of an S7-200 as it goes to the modules.
    #[cold]
    pub(crate) fn force_image(&self, image: &mut [u8]) {
        for (&byte, mask) in &*self.force.outputs.borrow() {
            if let Some(value) = image.get_mut(byte as usize) {
                *value = mask.over(*value);
            }
        }
    }

    /// Forced outputs go to their modules; the bits beside them stay.
    pub(crate) fn write_forced_outputs(&self) {
        for (&byte, mask) in &*self.force.outputs.borrow() {
            self.driver.write(byte, 1, u32::from(mask.over(self.driver.output(byte, 1) as u8)));
        }
    }

    /// Forced analog outputs of an S7-200 go to their modules, whether the program writes them or not.
    #[cold]
    pub(crate) fn write_forced_analog(&self) {
        let outputs = self.force.outputs.borrow();
        for &byte in outputs.range(ANALOG_ADDRESS..).map(|(byte, _)| byte).filter(|byte| *byte % 2 == 0) {
            self.driver.write(byte, 2, over(&outputs, byte, 2, 0));
        }
    }

    /// Copies the process image of outputs with the forced ones to the modules.
    #[cold]
    pub(crate) fn write_forced_image(&self, base: u32, length: u32) {
        let outputs = self.force.outputs.borrow();
        let (_, all) = self.area(crate::cpu::Area::Outputs);
        let end = outputs.last_key_value().map_or(0, |(byte, _)| byte + 1).min(all);
        let mut image = self.memory.view(base, length.max(end), <[u8]>::to_vec);
        for (&byte, mask) in outputs.range(..all) {
            if let Some(value) = image.get_mut(byte as usize) {
                *value = mask.over(*value);
            }
        }
        if !self.image.profile.family.is_portal() {
            self.memory.load(base, &image);
        }
        self.driver.write_image(&image);
        for (&byte, mask) in outputs.range(all..) {
            self.driver.write(byte, 1, u32::from(mask.over(self.driver.output(byte, 1) as u8)));
        }
    }

    /// What the program reads from a module.
    pub(crate) fn forced_input(&self, address: u32, bytes: u32, value: u32) -> u32 {
        match self.forces_modules() {
            true => over(&self.force.inputs.borrow(), address, bytes, value),
            false => value,
        }
    }

    /// What goes to a module when the program writes it directly.
    pub(crate) fn forced_output(&self, address: u32, bytes: u32, value: u32) -> u32 {
        match self.forces_modules() {
            true => over(&self.force.outputs.borrow(), address, bytes, value),
            false => value,
        }
    }

    fn forces_modules(&self) -> bool {
        self.is_forcing() && self.image.profile.family != Family::S7300
    }

    /// A memory reset ends forcing, except on an S7-1200/1500. Source: CPU manuals, memory reset.
    pub(crate) fn reset_force(&self) {
        if self.is_forcing() && !self.image.profile.family.is_portal() {
            let _ = self.unforce(None);
        }
    }

    /// An input byte as programs and clients read it from its module; `None`: there is no module.
    pub fn module_input(&self, address: u32) -> Option<u32> {
        let value = self.driver.read(address, 1)?;
        Some(self.forced_input(address, 1, value))
    }
}
