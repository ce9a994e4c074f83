//! What is retentive on an S7-200 alone, and its permanent memory. Source: S7-200 system manual, storing and restoring data.
//!
//! Retentive are V, T0-T31, T64-T95, all counters and M14.0 to M31.7.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;

use plcc_abi::layout;
use plcc_abi::s7200::{COUNTERS, V_DB, error, system};

use crate::cpu::Cpu;
use crate::diagnostics::NO_SITE;
use crate::retain::Restored;

/// Timers of the type TONR: first number, count.
const TONR: [(u32, u32); 2] = [(0, 32), (64, 32)];

/// See the module comment.
#[derive(Default)]
pub struct Retain {
    /// V bytes that SM31.7 has saved.
    permanent: RefCell<BTreeMap<u16, u8>>,
    /// Retentive memory was expected and is not there.
    lost: Cell<bool>,
}

impl Retain {
    /// Retentive memory was lost: SM0.2.
    pub(super) fn is_lost(&self) -> bool {
        self.lost.get()
    }

    /// What came back when the CPU was switched on.
    pub(super) fn found(&self, restored: Restored) {
        self.lost.set(restored == Restored::Lost);
    }
}

impl Cpu {
    /// Offset from the memory base and length of the retentive values of timers and counters.
    pub(crate) fn s7200_retentive_cells(&self) -> impl Iterator<Item = (u32, u32)> {
        let timers = TONR.map(|(first, count)| (layout::SYSTEM + system::TIMER_VALUES + 2 * first, 2 * count));
        timers.into_iter().chain([(layout::SYSTEM + system::COUNTER_VALUES, 2 * COUNTERS)])
    }

    /// Adds permanent memory to retentive memory: offset (`u16`) and value (1 byte) of each saved V byte.
    pub(crate) fn s7200_permanent(&self, content: &mut Vec<u8>) {
        let Some(own) = self.s7200() else { return };
        for (offset, value) in own.retain.permanent.borrow().iter() {
            content.extend(offset.to_le_bytes());
            content.push(*value);
        }
    }

    /// Permanent memory as it was saved. Its values are those of the data block.
    pub(crate) fn s7200_bring_back_permanent(&self, saved: &[u8]) {
        let Some(own) = self.s7200() else { return };
        let (v, v_bytes) = self.memory.db(V_DB);
        let mut permanent = own.retain.permanent.borrow_mut();
        for &[low, high, value] in saved.as_chunks::<3>().0 {
            let offset = u16::from_le_bytes([low, high]);
            if u32::from(offset) < v_bytes {
                permanent.insert(offset, value);
                self.memory.set_byte(v + u32::from(offset), value);
            }
        }
    }

    /// Copies V bytes to permanent memory. Outside of V: error 0094.
    pub(super) fn s7200_save_permanent(&self, offset: u16, bytes: u16) {
        let Some(own) = self.s7200() else { return };
        let (v, v_bytes) = self.memory.db(V_DB);
        if u32::from(offset) + u32::from(bytes) > v_bytes {
            self.s7200_error(NO_SITE, error::PERMANENT_RANGE);
            return;
        }
        let mut permanent = own.retain.permanent.borrow_mut();
        for at in offset..offset.saturating_add(bytes) {
            permanent.insert(at, self.memory.byte(v + u32::from(at)));
        }
    }
}
