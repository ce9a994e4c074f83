//! Remote inputs and outputs: devices on a field bus, `[io.NAME]` of plc.toml.
//!
//! - [`frame`]: requests and answers; [`data`]: bytes of the CPU; [`line`]: the way to a device.
//! - [`station`]: the thread of a device.
//!
//! The driver has a copy of everything, so the cycle never waits for the network: at the cycle control point it takes over what has come,
//! and after the cycle it leaves what is to be sent. A device that does not answer is a station that has failed: OB 86, and access errors at
//! its addresses. One that refuses a request has a faulty module: OB 82.

mod data;
mod frame;
mod line;
mod station;
#[cfg(test)]
mod tests;

use std::cell::Cell;
use std::time::{Duration, Instant};

use plcc_abi::image::{Family, Module};
use plcc_abi::remote::{RemoteChannel, RemoteLine, RemoteStation, RemoteTable};

use crate::cpu::Cpu;
use crate::diagnostics::NO_SITE;
use crate::events::{Event, StartInfo};
use crate::io::{Change, Driver, Simulated};
use station::{Shared, Station};

/// How long the startup waits for devices, shorter than a CPU. Source: CPU manuals, monitoring time for the ready message.
const STARTUP_WAIT: Duration = Duration::from_secs(2);
/// How long the end of the process waits for devices that get their last outputs.
const END_WAIT: Duration = Duration::from_secs(2);

/// A driver with devices.
pub struct Remote {
    own: Simulated,
    devices: Vec<Device>,
}

struct Device {
    config: RemoteStation,
    /// For [`Change`].
    number: u8,
    station: Station,
    /// As the CPU knows it.
    online: Cell<bool>,
    /// Channels that the device refuses, as the CPU knows them.
    refused: Vec<Cell<bool>>,
    /// The exchange that was taken over last.
    taken: Cell<u64>,
    /// In STOP outputs have their substitute values.
    stopped: Cell<bool>,
}

/// What the program opens, one line each, for who starts it.
pub fn opened(stations: &[RemoteStation]) -> impl Iterator<Item = String> {
    stations.iter().map(|station| {
        let (name, unit) = (&station.name, station.unit);
        match &station.line {
            RemoteLine::Tcp(address) => format!("io {name}: Modbus TCP, {address}, unit {unit}"),
            RemoteLine::Serial { path, baud, .. } => format!("io {name}: Modbus RTU, {path}, {baud} baud, unit {unit}"),
        }
    })
}

impl Remote {
    /// Starts the threads, and waits a moment for the devices. `Err`: the error.
    pub fn new(modules: Option<Vec<Module>>, stations: &[RemoteStation]) -> Result<Remote, String> {
        let own = Simulated::new(modules);
        let mut devices = Vec::new();
        for (number, config) in (1u8..).zip(stations) {
            for channel in config.channels.iter().filter(|channel| !channel.output) {
                own.name_input(channel.byte, channel.bytes());
            }
            let station = Station::start(config).map_err(|error| format!("io {}: {error}", config.name))?;
            let refused = config.channels.iter().map(|_| Cell::new(false)).collect();
            let (online, taken, stopped) = (Cell::new(false), Cell::new(0), Cell::new(true));
            devices.push(Device { config: config.clone(), number, station, online, refused, taken, stopped });
        }
        let remote = Remote { own, devices };
        let deadline = Instant::now() + STARTUP_WAIT;
        for device in &remote.devices {
            device.station.wait_for_attempt(deadline);
        }
        // What has answered until now was never away; the others come later.
        for device in &remote.devices {
            remote.take(device, &mut |_| {});
            if !device.online.get() {
                let shared = device.station.shared();
                let why = if shared.error.is_empty() { "no answer yet" } else { &shared.error };
                crate::run::say!("io {}: {why}", device.config.name);
                drop(shared);
                remote.substitute_inputs(device);
            }
        }
        Ok(remote)
    }

    /// Takes over what has come from a device.
    fn take(&self, device: &Device, changed: &mut dyn FnMut(Change)) {
        // If the thread is at work, then next time.
        let Some(shared) = device.station.try_shared() else { return };
        if shared.online != device.online.get() {
            device.online.set(shared.online);
            changed(device.change(None, !shared.online, &shared.error));
            if !shared.online {
                self.substitute_inputs(device);
            }
        }
        if !shared.online || shared.exchanges == device.taken.replace(shared.exchanges) {
            return;
        }
        for ((channel, exchanged), refused) in device.config.channels.iter().zip(&shared.channels).zip(&device.refused)
        {
            if exchanged.refused.is_some() != refused.get() {
                refused.set(exchanged.refused.is_some());
                let why = exchanged.refused.map_or_else(String::new, refusal);
                changed(device.change(Some(channel), refused.get(), &why));
                if refused.get() && !channel.output && !device.config.keep {
                    self.substitute(channel);
                }
            }
            if !channel.output && !refused.get() {
                self.set_inputs(channel, &exchanged.bytes);
            }
        }
    }

    /// Of a device that is away, if it is to have substitute values.
    fn substitute_inputs(&self, device: &Device) {
        let inputs = device.config.channels.iter().filter(|channel| !channel.output && !device.config.keep);
        inputs.for_each(|channel| self.substitute(channel));
    }

    fn substitute(&self, channel: &RemoteChannel) {
        let mut bytes = vec![0; channel.bytes() as usize];
        data::substitute(channel, &mut bytes);
        self.set_inputs(channel, &bytes);
    }

    /// Sets the inputs of a channel. Bits beside them stay.
    fn set_inputs(&self, channel: &RemoteChannel, bytes: &[u8]) {
        for (index, (address, byte)) in (channel.byte..).zip(bytes).enumerate() {
            let value = match channel.table.has_bits() {
                false => u32::from(*byte),
                true => {
                    let mask = bits_of(channel, index as u32);
                    self.own.read(address, 1).unwrap_or(0) & !mask | u32::from(*byte) & mask
                }
            };
            self.own.set_input(address, 1, value);
        }
    }

    /// Leaves the outputs for a device.
    fn give(&self, device: &Device) {
        if device.stopped.get() || !device.config.channels.iter().any(|channel| channel.output) {
            return;
        }
        // If the thread is at work, then next time.
        if let Some(mut shared) = device.station.try_shared() {
            self.fill(device, &mut shared);
        }
    }

    fn fill(&self, device: &Device, shared: &mut Shared) {
        for (channel, exchanged) in device.config.channels.iter().zip(&mut shared.channels) {
            if channel.output {
                for (address, byte) in (channel.byte..).zip(&mut exchanged.bytes) {
                    *byte = self.own.output(address, 1) as u8;
                }
            }
        }
    }

    /// The outputs of a device get the substitute values that it shows in STOP.
    fn substitute_outputs(&self, device: &Device) {
        for channel in device.config.channels.iter().filter(|channel| channel.output) {
            let addresses = channel.byte..channel.byte + channel.bytes();
            let mut bytes: Vec<u8> = addresses.clone().map(|address| self.own.output(address, 1) as u8).collect();
            data::substitute(channel, &mut bytes);
            for (address, byte) in addresses.zip(bytes) {
                self.own.write(address, 1, byte.into());
            }
        }
    }

    /// Leaves the substitute values of outputs for a device.
    fn give_substitutes(&self, device: &Device) {
        device.stopped.set(true);
        let mut shared = device.station.shared();
        for (channel, exchanged) in device.config.channels.iter().zip(&mut shared.channels) {
            if channel.output {
                data::substitute(channel, &mut exchanged.bytes);
            }
        }
    }

    /// True if a device has one of the bytes and cannot be reached.
    fn is_away(&self, address: u32, bytes: u32, output: bool) -> bool {
        let end = address.saturating_add(bytes);
        self.devices.iter().any(|device| {
            device.config.channels.iter().zip(&device.refused).any(|(channel, refused)| {
                (refused.get() || !device.online.get())
                    && channel.output == output
                    && address < channel.byte + channel.bytes()
                    && channel.byte < end
            })
        })
    }
}

/// The bits of a channel in the byte with this number.
fn bits_of(channel: &RemoteChannel, index: u32) -> u32 {
    let (first, end) = (u32::from(channel.bit), u32::from(channel.bit) + u32::from(channel.count));
    (0..8).filter(|bit| (first..end).contains(&(8 * index + bit))).fold(0, |mask, bit| mask | 1 << bit)
}

impl Device {
    fn change(&self, channel: Option<&RemoteChannel>, fault: bool, why: &str) -> Change {
        let of = channel.or_else(|| self.config.channels.first());
        Change {
            station: self.number,
            whole: channel.is_none(),
            fault,
            address: of.map_or(0, |channel| channel.byte as u16),
            output: of.is_some_and(|channel| channel.output),
            text: match (channel, fault) {
                (None, true) => format!("io {}: {why}", self.config.name),
                (None, false) => format!("io {}: answers again", self.config.name),
                (Some(row), true) => format!("io {}: the device refuses {}: {why}", self.config.name, row_name(row)),
                (Some(row), false) => format!("io {}: the device accepts {} again", self.config.name, row_name(row)),
            },
        }
    }
}

/// A row of the data as plc.toml has it, and where it is.
fn row_name(channel: &RemoteChannel) -> String {
    let table = match channel.table {
        RemoteTable::Coils => "coils",
        RemoteTable::DiscreteInputs => "discrete",
        RemoteTable::HoldingRegisters => "holding",
        RemoteTable::InputRegisters => "input",
    };
    let direction = if channel.output { "outputs" } else { "inputs" };
    format!("`{table} = {}` ({direction} from byte {})", channel.first, channel.byte)
}

/// What an exception means. Source: Modbus application protocol V1.1b3, exception codes.
fn refusal(code: u8) -> String {
    let meaning = match code {
        1 => "it does not know the function",
        2 => "it does not have all of these elements",
        3 => "it does not take the values",
        4 => "it has failed",
        6 => "it is busy",
        10 | 11 => "the gateway does not reach it",
        _ => return format!("exception {code}"),
    };
    format!("exception {code}, {meaning}")
}

impl Driver for Remote {
    fn read(&self, address: u32, bytes: u32) -> Option<u32> {
        if self.is_away(address, bytes, false) { None } else { self.own.read(address, bytes) }
    }

    fn write(&self, address: u32, bytes: u32, value: u32) -> bool {
        !self.is_away(address, bytes, true) && self.own.write(address, bytes, value)
    }

    fn write_image(&self, image: &[u8]) {
        self.own.write_image(image);
        self.devices.iter().for_each(|device| self.give(device));
    }

    fn stop(&self) {
        self.own.stop();
        self.devices.iter().for_each(|device| self.give_substitutes(device));
    }

    fn enable(&self) {
        self.own.enable();
        for device in &self.devices {
            self.substitute_outputs(device);
            device.stopped.set(false);
        }
    }

    fn hand_over(&self) {
        for device in self.devices.iter().filter(|device| !device.stopped.get()) {
            self.fill(device, &mut device.station.shared());
        }
    }

    fn output(&self, address: u32, bytes: u32) -> u32 {
        self.own.output(address, bytes)
    }

    fn set_input(&self, address: u32, bytes: u32, value: u32) {
        self.own.set_input(address, bytes, value);
    }

    fn name_input(&self, address: u32, bytes: u32) {
        self.own.name_input(address, bytes);
    }

    fn named(&self, limit: u32, each: &mut dyn FnMut(u32, u8)) {
        self.own.named(limit, each);
    }

    fn exchange(&self, changed: &mut dyn FnMut(Change)) {
        for device in &self.devices {
            // A cycle begins.
            device.stopped.set(false);
            self.take(device, changed);
        }
    }

    fn away(&self) -> Vec<Change> {
        let mut list = Vec::new();
        for device in &self.devices {
            if !device.online.get() {
                list.push(device.change(None, true, ""));
            }
            let refused = device.config.channels.iter().zip(&device.refused).filter(|(_, refused)| refused.get());
            list.extend(refused.map(|(channel, _)| device.change(Some(channel), true, "")));
        }
        list
    }
}

impl Drop for Remote {
    /// The process ends: outputs have their substitute values.
    fn drop(&mut self) {
        self.devices.iter().for_each(|device| self.give_substitutes(device));
        self.devices.iter().for_each(|device| device.station.end());
        let deadline = Instant::now() + END_WAIT;
        self.devices.iter().for_each(|device| device.station.wait_for_end(deadline));
    }
}

/// Faults of a station and of a module; those that go have 16#38 for 16#39. Source: System and standard functions, OB 86 and OB 82.
const COMING: u8 = 0x39;
const GOING: u8 = 0x38;
const DP_STATION: u8 = 0xC4;
const PROFINET_DEVICE: u8 = 0xCB;
const MODULE: u8 = 0x42;
/// IO_FLAG.
const INPUT: u8 = 0x54;
const OUTPUT: u8 = 0x55;
/// Diagnostics of a module: it is faulty, the fault is outside.
const MODULE_FAULT: u32 = 0x0500_0000;

impl Cpu {
    /// The cycle control point: what has come from devices, and which of them are away or came back.
    pub(crate) fn exchange(&self) {
        self.driver.exchange(&mut |change| self.device_changed(&change));
    }

    #[cold]
    fn device_changed(&self, change: &Change) {
        let class = if change.fault { COMING } else { GOING };
        let Change { address, station, .. } = *change;
        let (ob, fault) = match (change.whole, self.image.profile.family) {
            (false, _) => (82, MODULE),
            (true, Family::S71200 | Family::S71500) => (86, PROFINET_DEVICE),
            (true, _) => (86, DP_STATION),
        };
        // RACKS_FLTD: station, number of the master system, address. The last bit says that it is one of inputs.
        let racks = u32::from(station) | 1 << 8 | u32::from(address & 0x7FFF) << 16 | u32::from(!change.output) << 31;
        let diagnostics = if change.fault { MODULE_FAULT } else { 0 };
        let info = StartInfo::new(class, fault, ob)
            .byte(5, if change.output { OUTPUT } else { INPUT })
            .word(6, address)
            .dword(8, if change.whole { racks } else { diagnostics });
        crate::run::say!("{}", change.text);
        self.log(u16::from_be_bytes([class, fault]), NO_SITE, u32::from(address));
        // Without the OB a fault that goes stops nothing.
        if change.fault || self.has_ob(ob) {
            self.request(Event { ob, info });
        }
    }
}
