//! Inputs and outputs: the driver that represents the modules.
//!
//! A driver answers at once, from memory. Exchange with real devices happens on its own threads.

use std::cell::RefCell;

use plcc_abi::image::Module;
use serde::{Deserialize, Serialize};

/// Peripheral bytes in each direction.
pub const PERIPHERAL_BYTES: u32 = 0x1_0000;

/// Represents the I/O modules. Addresses are peripheral byte addresses, values are big-endian numbers of 1, 2 or 4 bytes.
pub trait Driver {
    /// `None`: no module answers for all of the bytes.
    fn read(&self, address: u32, bytes: u32) -> Option<u32>;
    /// False: no module answers for all of the bytes.
    fn write(&self, address: u32, bytes: u32, value: u32) -> bool;
    /// Takes over the process image of outputs. Bytes that no module covers are not an error: an S7-300 makes no entry.
    fn write_image(&self, image: &[u8]);
    /// The CPU is in STOP: outputs of modules in a station show 0 or their substitute values.
    fn stop(&self);
    /// In STOP: outputs have their values of STOP, and what is written from now on reaches the modules, until [`Driver::stop`].
    fn enable(&self);
    /// In STOP: what was written since the outputs were enabled goes to the devices.
    fn hand_over(&self) {}
    /// The value last written to an output, for `--print PQW 256`.
    fn output(&self, address: u32, bytes: u32) -> u32;
    /// Sets the value of an input module; from then on the byte is [named](Driver::named).
    fn set_input(&self, address: u32, bytes: u32, value: u32);
    /// Makes the bytes named without changing them.
    fn name_input(&self, address: u32, bytes: u32);
    /// Calls `each` with every input byte below `limit` that is copied into the process image, in order, and its value.
    fn named(&self, limit: u32, each: &mut dyn FnMut(u32, u8));
    /// True if no input is copied into the process image, and none changes by itself.
    fn is_still(&self) -> bool {
        false
    }
    /// Takes over what devices have sent. `changed` gets each that went away or came back.
    fn exchange(&self, _changed: &mut dyn FnMut(Change)) {}
    /// What is away, as the changes that reported it.
    fn away(&self) -> Vec<Change> {
        Vec::new()
    }
}

/// A device or a part of it went away or came back.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Change {
    /// Its number, from 1.
    pub station: u8,
    /// The whole device, else a module.
    pub whole: bool,
    /// It went away; else it came back.
    pub fault: bool,
    /// The first address of the device or the module.
    pub address: u16,
    /// It is one of outputs.
    pub output: bool,
    /// For who looks at the process.
    pub text: String,
}

/// Inputs from a scenario or `--set`; outputs are kept.
pub struct Simulated {
    modules: Option<Vec<Module>>,
    bytes: RefCell<SimulatedBytes>,
}

struct SimulatedBytes {
    inputs: Box<[u8]>,
    outputs: Box<[u8]>,
    /// Addresses of the named inputs, sorted.
    named: Vec<u32>,
}

impl Simulated {
    /// Without `modules` every address exists. The inputs of modules are named from the start.
    pub fn new(modules: Option<Vec<Module>>) -> Simulated {
        let memory = || vec![0; PERIPHERAL_BYTES as usize].into_boxed_slice();
        let bytes = SimulatedBytes { inputs: memory(), outputs: memory(), named: Vec::new() };
        let driver = Simulated { modules, bytes: RefCell::new(bytes) };
        for module in driver.modules.iter().flatten() {
            driver.name_input(module.input_start, module.input_bytes);
        }
        driver
    }

    fn exists(&self, address: u32, bytes: u32, range: fn(&Module) -> (u32, u32)) -> bool {
        let inside = address.checked_add(bytes).is_some_and(|end| end <= PERIPHERAL_BYTES);
        let covered = |byte: u32, modules: &[Module]| {
            modules.iter().map(range).any(|(start, length)| byte >= start && byte - start < length)
        };
        inside
            && match &self.modules {
                None => true,
                Some(modules) => (address..address + bytes).all(|byte| covered(byte, modules)),
            }
    }

    /// Copies the process image to the modules.
    #[inline(never)]
    fn copy_image(&self, image: &[u8]) {
        let outputs = &mut self.bytes.borrow_mut().outputs;
        let mut take = |start: usize, length: usize| {
            let end = start.saturating_add(length).min(image.len()).min(outputs.len());
            if start < end {
                outputs[start..end].copy_from_slice(&image[start..end]);
            }
        };
        match &self.modules {
            None => take(0, image.len()),
            Some(modules) => {
                modules.iter().for_each(|module| take(module.output_start as usize, module.output_bytes as usize));
            }
        }
    }

    #[inline(never)]
    fn each_named(&self, limit: u32, each: &mut dyn FnMut(u32, u8)) {
        let bytes = self.bytes.borrow();
        for &address in bytes.named.iter().take_while(|&&address| address < limit) {
            each(address, bytes.inputs[address as usize]);
        }
    }
}

fn get(memory: &[u8], address: u32, bytes: u32) -> u32 {
    (0..bytes)
        .fold(0, |value, index| value << 8 | u32::from(memory.get((address + index) as usize).copied().unwrap_or(0)))
}

fn put(memory: &mut [u8], address: u32, bytes: u32, value: u32) {
    for index in 0..bytes {
        if let Some(byte) = memory.get_mut((address + index) as usize) {
            *byte = (u64::from(value) >> (8 * (bytes - 1 - index)).min(63)) as u8;
        }
    }
}

impl Driver for Simulated {
    fn read(&self, address: u32, bytes: u32) -> Option<u32> {
        self.exists(address, bytes, |module| (module.input_start, module.input_bytes))
            .then(|| get(&self.bytes.borrow().inputs, address, bytes))
    }

    fn write(&self, address: u32, bytes: u32, value: u32) -> bool {
        let exists = self.exists(address, bytes, |module| (module.output_start, module.output_bytes));
        if exists {
            put(&mut self.bytes.borrow_mut().outputs, address, bytes, value);
        }
        exists
    }

    #[inline]
    fn write_image(&self, image: &[u8]) {
        if image.is_empty() {
            return;
        }
        // Few outputs, as small programs have, are copied without a call.
        if self.modules.is_none() && image.len() <= 4 {
            let outputs = &mut self.bytes.borrow_mut().outputs;
            match (image, &mut **outputs) {
                (&[first], [to, ..]) => *to = first,
                (&[first, second], [to, next, ..]) => (*to, *next) = (first, second),
                (&[first, second, third], [to, next, last, ..]) => (*to, *next, *last) = (first, second, third),
                (&[first, second, third, fourth], [to, next, then, last, ..]) => {
                    (*to, *next, *then, *last) = (first, second, third, fourth);
                }
                _ => {}
            }
        } else {
            self.copy_image(image);
        }
    }

    fn stop(&self) {
        let outputs = &mut self.bytes.borrow_mut().outputs;
        for module in self.modules.iter().flatten() {
            let Some(station) = &module.station else { continue };
            let (start, length) = (module.output_start, module.output_bytes);
            if station.analog_outputs.is_empty() {
                // The substitute is the bits of all bytes, the last ones lowest.
                let of_bytes = length.min(4);
                put(outputs, start, length - of_bytes, 0);
                put(outputs, start + length - of_bytes, of_bytes, station.substitute);
            } else {
                (0..length / 2).for_each(|word| put(outputs, start + 2 * word, 2, station.substitute));
            }
        }
    }

    fn enable(&self) {
        self.bytes.borrow_mut().outputs.fill(0);
        self.stop();
    }

    fn output(&self, address: u32, bytes: u32) -> u32 {
        get(&self.bytes.borrow().outputs, address, bytes)
    }

    fn set_input(&self, address: u32, bytes: u32, value: u32) {
        put(&mut self.bytes.borrow_mut().inputs, address, bytes, value);
        self.name_input(address, bytes);
    }

    fn name_input(&self, address: u32, bytes: u32) {
        let named = &mut self.bytes.borrow_mut().named;
        for byte in address..address.saturating_add(bytes).min(PERIPHERAL_BYTES) {
            if let Err(index) = named.binary_search(&byte) {
                named.insert(index, byte);
            }
        }
    }

    #[inline]
    fn is_still(&self) -> bool {
        self.bytes.borrow().named.is_empty()
    }

    #[inline]
    fn named(&self, limit: u32, each: &mut dyn FnMut(u32, u8)) {
        if !self.bytes.borrow().named.is_empty() {
            self.each_named(limit, each);
        }
    }
}
