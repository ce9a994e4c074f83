//! Lines of a block as they are shown, in pieces that look alike.

/// A line.
pub type Row = Vec<Piece>;

/// A part of a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Piece {
    pub text: String,
    pub tone: Tone,
}

/// What a piece is, which decides its look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    Plain,
    /// The title of a network, the heads of columns.
    Title,
    /// Labels, types and other notes.
    Note,
    /// What is 1 and what is 0, and what is not known.
    On,
    Off,
    Unknown,
    /// The value of an operand.
    Value,
    /// An active step.
    Active,
    /// A step whose supervision has found a fault.
    Faulty,
    /// An operand with forced bits.
    Forced,
}

pub fn piece(text: impl Into<String>, tone: Tone) -> Piece {
    Piece { text: text.into(), tone }
}

/// Time of day of milliseconds since 1970; the clock of a CPU has no time zone.
pub fn clock(ms: i64) -> String {
    let ms = ms.rem_euclid(86_400_000);
    format!("{:02}:{:02}:{:02}.{:03}", ms / 3_600_000, ms / 60_000 % 60, ms / 1000 % 60, ms % 1000)
}
