//! Devices of `[io]` in a recording: what came from them with each cycle, and the driver that repeats it.

use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::rc::Rc;

use plcc_abi::image::Module;
use plcc_abi::remote::RemoteStation;
use serde::{Deserialize, Serialize};

use super::Recording;
use crate::io::{Change, Driver, PERIPHERAL_BYTES, Simulated};

/// What came from devices at a cycle control point.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Devices {
    /// Inputs with another value than before: address and value.
    pub inputs: Vec<(u32, u8)>,
    pub changes: Vec<Change>,
}

/// The inputs that a driver copies into the process image, with their values.
pub(super) fn inputs(driver: &dyn Driver) -> Vec<(u32, u8)> {
    let mut list = Vec::new();
    driver.named(PERIPHERAL_BYTES, &mut |address, value| list.push((address, value)));
    list
}

impl Devices {
    /// What a driver begins with.
    pub fn at_start(driver: &dyn Driver) -> Devices {
        Devices { inputs: inputs(driver), changes: driver.away() }
    }

    /// What has come between two looks at the inputs.
    pub(super) fn between(before: &[(u32, u8)], after: Vec<(u32, u8)>, changes: Vec<Change>) -> Devices {
        let is_new = |(address, value): &(u32, u8)| {
            let at = before.binary_search_by_key(address, |(address, _)| *address);
            !at.is_ok_and(|at| before[at].1 == *value)
        };
        Devices { inputs: after.into_iter().filter(is_new).collect(), changes }
    }
}

/// A device as a whole, or the one of its modules that begins at this address; `true`: of outputs.
type Part = (u8, Option<(u16, bool)>);

/// Repeats what devices did.
pub(super) struct Repeated {
    own: Simulated,
    stations: Vec<RemoteStation>,
    recording: Rc<Recording>,
    /// Number of the next cycle in the recording.
    next: Cell<usize>,
    /// How many faults of a part have come and not gone.
    away: RefCell<HashMap<Part, i64>>,
}

impl Repeated {
    pub fn new(modules: Option<Vec<Module>>, stations: &[RemoteStation], recording: Rc<Recording>) -> Repeated {
        let repeated = Repeated {
            own: Simulated::new(modules),
            stations: stations.to_vec(),
            recording: Rc::clone(&recording),
            next: Cell::new(0),
            away: RefCell::default(),
        };
        for channel in stations.iter().flat_map(|station| &station.channels).filter(|channel| !channel.output) {
            repeated.own.name_input(channel.byte, channel.bytes());
        }
        repeated.take(&recording.head.devices);
        repeated
    }

    fn take(&self, devices: &Devices) {
        for &(address, value) in &devices.inputs {
            self.own.set_input(address, 1, value.into());
        }
        let mut away = self.away.borrow_mut();
        for change in &devices.changes {
            let part = (!change.whole).then_some((change.address, change.output));
            *away.entry((change.station, part)).or_default() += if change.fault { 1 } else { -1 };
        }
    }

    /// True if a device has one of the bytes and could not be reached.
    fn is_away(&self, address: u32, bytes: u32, output: bool) -> bool {
        let away = self.away.borrow();
        let has_fault = |part: Part| away.get(&part).is_some_and(|count| *count > 0);
        let end = address.saturating_add(bytes);
        (1u8..).zip(&self.stations).any(|(number, station)| {
            station.channels.iter().any(|channel| {
                channel.output == output
                    && address < channel.byte + channel.bytes()
                    && channel.byte < end
                    && (has_fault((number, None)) || has_fault((number, Some((channel.byte as u16, output)))))
            })
        })
    }
}

impl Driver for Repeated {
    fn read(&self, address: u32, bytes: u32) -> Option<u32> {
        if self.is_away(address, bytes, false) { None } else { self.own.read(address, bytes) }
    }

    fn write(&self, address: u32, bytes: u32, value: u32) -> bool {
        !self.is_away(address, bytes, true) && self.own.write(address, bytes, value)
    }

    fn write_image(&self, image: &[u8]) {
        self.own.write_image(image);
    }

    fn stop(&self) {
        self.own.stop();
    }

    fn enable(&self) {
        self.own.enable();
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
        let Some(frame) = self.recording.frames.get(self.next.get()) else { return };
        self.next.set(self.next.get() + 1);
        self.take(&frame.devices);
        frame.devices.changes.iter().cloned().for_each(changed);
    }
}
