//! URCV and BRCV: what partners sent, until the blocks take it.

use std::collections::BTreeMap;

use super::status;

/// Blocks that receive, at most.
const RECEIVERS_MAX: usize = 256;

/// What a block receives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// URCV: messages of USEND; a newer one takes the place of an older one.
    Message,
    /// BRCV: blocks of BSEND, which waits until they are taken.
    Block,
}

/// A block that receives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot {
    pub kind: Kind,
    pub r_id: u32,
    /// Tells instances with the same R_ID apart; 0 before the first call.
    pub handle: u32,
}

/// What a call of such a block wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Receive {
    /// EN_R.
    pub enabled: bool,
    /// Bytes that its area takes.
    pub room: usize,
}

/// What a call of such a block gets.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Arrived {
    Nothing,
    /// Data is arriving.
    Some,
    /// All areas. `overwritten`: older ones are lost.
    All {
        areas: Vec<Vec<u8>>,
        overwritten: bool,
    },
}

/// Why a block of BSEND is not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotTaken {
    /// No BRCV has this R_ID.
    Unknown,
    Disabled,
    /// The last one is still there.
    Full,
    TooLong,
}

#[derive(Default)]
struct Receiver {
    handle: u32,
    enabled: bool,
    room: usize,
    arriving: bool,
    /// What came after the last cycle control point.
    new: Option<Vec<Vec<u8>>>,
    /// What came before it.
    shown: Option<Vec<Vec<u8>>>,
    overwritten: bool,
}

/// By connection, kind and R_ID.
#[derive(Default)]
pub(super) struct Receivers(BTreeMap<(usize, Kind, u32), Receiver>);

impl Receivers {
    /// Somebody has this R_ID.
    pub fn is_known(&self, line: usize, slot: Slot) -> bool {
        self.0.contains_key(&(line, slot.kind, slot.r_id))
    }

    /// `new`: an unused handle, if the R_ID is not known. Result: the handle of the next call; what has come, or STATUS.
    pub fn receive(
        &mut self,
        line: usize,
        slot: Slot,
        ready: &Receive,
        new: u32,
        is_up: bool,
    ) -> (u32, Result<Arrived, u16>) {
        let key = (line, slot.kind, slot.r_id);
        // R_ID or ID of the instance is another one than before.
        self.0.retain(|other, receiver| *other == key || slot.handle == 0 || receiver.handle != slot.handle);
        if !self.0.contains_key(&key) && self.0.len() >= RECEIVERS_MAX {
            return (0, Err(status::RESOURCES));
        }
        let own = self.0.entry(key).or_insert_with(|| Receiver { handle: new, ..Receiver::default() });
        if own.handle != new && own.handle != slot.handle {
            return (slot.handle, Err(status::R_ID_USED));
        }
        (own.enabled, own.room) = (ready.enabled, ready.room);
        if !ready.enabled {
            return (own.handle, Ok(Arrived::Nothing));
        }
        if let Some(areas) = own.shown.take() {
            let overwritten = std::mem::take(&mut own.overwritten);
            return (own.handle, Ok(Arrived::All { areas, overwritten }));
        }
        if !is_up {
            return (own.handle, Err(status::NO_CONNECTION));
        }
        (own.handle, Ok(if own.arriving { Arrived::Some } else { Arrived::Nothing }))
    }

    pub fn exchange(&mut self) {
        for ((_, kind, _), receiver) in &mut self.0 {
            match (kind, receiver.new.is_some(), receiver.shown.is_some()) {
                (_, false, _) | (Kind::Block, true, true) => {}
                (Kind::Message, true, true) => {
                    receiver.overwritten = true;
                    receiver.shown = receiver.new.take();
                }
                (_, true, false) => receiver.shown = receiver.new.take(),
            }
        }
    }

    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// The connection is lost: what is complete stays.
    pub fn lost(&mut self, line: usize) {
        self.0.iter_mut().filter(|((own, ..), _)| *own == line).for_each(|(_, receiver)| receiver.arriving = false);
    }

    pub fn message(&mut self, line: usize, r_id: u32, areas: Vec<Vec<u8>>) {
        // A message without a receiver is lost: it is not acknowledged.
        if let Some(receiver) = self.0.get_mut(&(line, Kind::Message, r_id)).filter(|receiver| receiver.enabled) {
            receiver.overwritten |= receiver.new.is_some();
            receiver.new = Some(areas);
        }
    }

    fn block(&mut self, line: usize, r_id: u32) -> Result<&mut Receiver, NotTaken> {
        let receiver = self.0.get_mut(&(line, Kind::Block, r_id)).ok_or(NotTaken::Unknown)?;
        if !receiver.enabled {
            return Err(NotTaken::Disabled);
        }
        // The block that BRCV has not taken stays as it is.
        if receiver.new.is_some() || receiver.shown.is_some() {
            return Err(NotTaken::Full);
        }
        Ok(receiver)
    }

    pub fn begin_block(&mut self, line: usize, r_id: u32, bytes: usize) -> Result<(), NotTaken> {
        let receiver = self.block(line, r_id)?;
        if bytes > receiver.room {
            return Err(NotTaken::TooLong);
        }
        receiver.arriving = true;
        Ok(())
    }

    pub fn drop_block(&mut self, line: usize, r_id: u32) {
        if let Some(receiver) = self.0.get_mut(&(line, Kind::Block, r_id)) {
            receiver.arriving = false;
        }
    }

    pub fn end_block(&mut self, line: usize, r_id: u32, bytes: Vec<u8>) -> Result<(), NotTaken> {
        let receiver = self.block(line, r_id)?;
        receiver.arriving = false;
        if bytes.len() > receiver.room {
            return Err(NotTaken::TooLong);
        }
        receiver.new = Some(vec![bytes]);
        Ok(())
    }
}
