//! The start information with which each OB last began, for clients. Kept only while there can be clients.

use std::cell::RefCell;
use std::collections::BTreeMap;

use plcc_abi::image::Family;

use crate::cpu::Cpu;
use crate::events::{self, Missing, START_INFO_BYTES, StartInfo};

/// By number of the OB: the start information with the time.
#[derive(Default)]
pub(crate) struct ObStarts(RefCell<BTreeMap<u16, [u8; START_INFO_BYTES]>>);

/// Bits of the record: the OB is disabled by SFC 39, it is loaded.
const DISABLED: u16 = 1 << 1;
const LOADED: u16 = 1 << 4;
/// What happens without the OB: an error of the priority class, STOP, nothing.
const CLASS_ERROR: u16 = 1 << 1;
const STOP: u16 = 1 << 2;
const DISCARDED: u16 = 1 << 3;

impl Cpu {
    /// An OB begins.
    #[inline(never)]
    pub(crate) fn note_start(&self, ob: u16, info: &StartInfo) {
        let mut bytes = [0; START_INFO_BYTES];
        let (own, time) = bytes.split_at_mut(info.0.len());
        own.copy_from_slice(&info.0);
        time.copy_from_slice(&self.clock.wall_bytes());
        self.ob_starts.0.borrow_mut().insert(ob, bytes);
    }

    /// The record of list 0222: start information, which is 0 before the OB has run, two words of bits, and discarded events, which there
    /// are none of. `None`: the OB is not loaded. Source: System and standard functions, list xy22.
    pub fn ob_status(&self, ob: u16) -> Option<Vec<u8>> {
        let family = self.image.profile.family;
        if family == Family::S7200 || !self.has_ob(ob) {
            return None;
        }
        let start = self.ob_starts.0.borrow().get(&ob).copied().unwrap_or([0; START_INFO_BYTES]);
        let state = LOADED | if self.schedule.is_disabled(ob) { DISABLED } else { 0 };
        let without = match events::missing(ob, family) {
            Missing::ClassError => CLASS_ERROR,
            Missing::Stop(_) => STOP,
            Missing::Continue => DISCARDED,
        };
        Some([&start[..], &state.to_be_bytes(), &without.to_be_bytes(), &[0; 4]].concat())
    }
}
