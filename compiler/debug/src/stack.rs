//! The blocks that run, and where they are.

use crate::places::Places;

/// Registers that a probe shows: see `state::PROBED`.
pub type Probed = [u32; 8];

/// A call of a block.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The place of its beginning.
    pub block: u32,
    /// Where its instance is in memory, 0: it has none.
    pub instance: u32,
    /// Where its local data is, 0: not known yet.
    pub local: u32,
    /// The statement that runs; none before the first.
    pub place: Option<u32>,
    /// Its registers before that statement.
    pub probed: Probed,
    /// What an FC has got for its formals.
    pub formals: Vec<(usize, u64)>,
}

/// The organization block first.
#[derive(Debug, Default)]
pub struct Stack {
    pub frames: Vec<Frame>,
}

/// How a statement follows the one before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arrival {
    /// The first one of its call.
    pub first: bool,
    /// It is at another line than the one before it in the same call, or the line begins again.
    pub new_line: bool,
    /// The one before it in the same call, unless the code goes back.
    pub before: Option<u32>,
}

impl Stack {
    pub fn enter(&mut self, block: u32, instance: u32) {
        self.frames.push(Frame {
            block,
            instance,
            local: 0,
            place: None,
            probed: Probed::default(),
            formals: Vec::new(),
        });
    }

    pub fn leave(&mut self) {
        self.frames.pop();
    }

    /// A statement is about to run.
    pub fn statement(&mut self, places: &Places, place: u32, local: u32, probed: Probed) -> Arrival {
        let alone = Arrival { first: true, new_line: true, before: None };
        let Some(frame) = self.frames.last_mut() else { return alone };
        let line = |place: u32| places.spot(place).map(|spot| (spot.file, spot.line));
        let arrival = match frame.place {
            None => alone,
            Some(before) if place <= before => Arrival { first: false, ..alone },
            Some(before) => Arrival { first: false, new_line: line(place) != line(before), before: Some(before) },
        };
        (frame.place, frame.local, frame.probed) = (Some(place), local, probed);
        arrival
    }
}
