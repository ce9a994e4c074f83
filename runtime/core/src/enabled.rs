//! Outputs that a client enables while the CPU is in STOP, to test the wiring: what it writes there reaches the modules.
//!
//! | Family | Outputs |
//! | --- | --- |
//! | S7-300/400 | `PQ`; forced outputs have their values meanwhile |
//! | S7-1200/1500 | `PQ`; not possible while values are forced |
//! | S7-200 | `Q` and `AQ`; forced outputs have their values meanwhile |
//!
//! Outputs that are not written keep their values of STOP. It ends when the client ends it or goes, with a restart, a memory reset, a change
//! of the program, and when other values are forced: all outputs have their values of STOP again.
//!
//! Source: Programming with STEP 7, 20.4, enabling peripheral outputs; S7-200 system manual, writing and forcing outputs in STOP.

use std::cell::Cell;

use plcc_abi::image::Family;
use plcc_abi::layout;

use crate::address::{Place, Width};
use crate::cpu::Cpu;
use crate::diagnostics::{self, NO_SITE};
use crate::s7200::Part;

/// See the module comment.
#[derive(Default)]
pub(crate) struct Enabled {
    /// Who has enabled them.
    client: Cell<Option<u64>>,
    /// That client is at work.
    is_writing: Cell<bool>,
}

impl Cpu {
    /// A client has enabled the outputs of the CPU in STOP.
    pub fn has_enabled_outputs(&self) -> bool {
        self.enabled.client.get().is_some()
    }

    /// Enables the outputs for a client. `Err`: why not.
    pub fn enable_outputs(&self, client: u64) -> Result<(), String> {
        if !self.is_stopped() {
            return Err("the CPU is in RUN: outputs are enabled in STOP, to test the wiring".to_string());
        }
        if self.image.profile.family.is_portal() && self.is_forcing() {
            return Err("values are forced: end that before outputs are enabled".to_string());
        }
        match self.enabled.client.get() {
            Some(own) if own == client => return Ok(()),
            Some(_) => return Err("another client has enabled the outputs".to_string()),
            None => {}
        }
        self.enabled.client.set(Some(client));
        self.driver.enable();
        self.write_forced_outputs();
        self.driver.hand_over();
        self.log(diagnostics::OUTPUTS_ENABLED, NO_SITE, 0);
        Ok(())
    }

    /// The client ends it or has gone; nothing happens if it has not enabled the outputs.
    pub fn disable_outputs(&self, client: u64) {
        if self.enabled.client.get() == Some(client) {
            self.end_enabling();
        }
    }

    /// Outputs have their values of STOP again, if a client has enabled them.
    pub fn end_enabling(&self) {
        if self.enabled.client.take().is_some() {
            // Modules that keep their values in STOP would keep what was written.
            self.driver.enable();
            self.stop_outputs();
            self.log(diagnostics::OUTPUTS_DISABLED, NO_SITE, 0);
        }
    }

    /// Does the work of a client, which writes outputs also in STOP if it has enabled them.
    pub fn for_client<T>(&self, client: u64, work: impl FnOnce() -> T) -> T {
        let is_enabled = self.enabled.client.get() == Some(client);
        self.enabled.is_writing.set(is_enabled);
        let done = work();
        self.enabled.is_writing.set(false);
        if is_enabled {
            self.driver.hand_over();
        }
        done
    }

    /// Whether an output of a module may be written now; other places may. `Err`: why not.
    pub fn check_enabled(&self, place: Place) -> Result<(), String> {
        let is_output = matches!(place, Place::PeripheralOutput(_) | Place::S7200(Part::AnalogOutput, _));
        match is_output && self.is_stopped() && !self.enabled.is_writing.get() {
            true => Err("the CPU is in STOP, and its outputs are disabled: enable them first".to_string()),
            false => Ok(()),
        }
    }

    /// The image of outputs was written at this byte. It has no `PQ` on an S7-200, where the image reaches the modules of enabled outputs.
    pub(crate) fn show_enabled(&self, byte: u32, width: Width) {
        if !self.enabled.is_writing.get() || self.image.profile.family != Family::S7200 {
            return;
        }
        for address in byte..byte + width.bytes() {
            let image = self.memory.byte(layout::Q + address);
            let value = match width {
                // The other bits of the image are those of the last cycle.
                Width::Bit(bit) => self.driver.output(address, 1) as u8 & !(1 << bit) | image & (1 << bit),
                Width::Byte | Width::Word | Width::Dword | Width::Lword => image,
            };
            self.driver.write(address, 1, self.forced_output(address, 1, value.into()));
        }
    }
}
