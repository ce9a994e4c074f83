//! How far the program runs on.

/// Where the run was when the user sent it on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Origin {
    /// Number of blocks that ran.
    pub depth: usize,
    pub cycle: u64,
}

/// When to stop, besides breakpoints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Course {
    /// Nowhere.
    Run,
    /// At the first statement of all.
    Entry,
    /// At the next line; with `fine` at the next statement.
    Into { fine: bool },
    /// At the next line that is not in a block that is called from here.
    Over { origin: Origin, fine: bool },
    /// After the block.
    Out { origin: Origin },
    /// At the first statement of the cycle, or a later one.
    Cycle(u64),
    /// At the statement with this number since the start. Breakpoints do not count on the way.
    Statement(u64),
    /// As far as the statement with number `before`, to find the last one that fits.
    Search { before: u64, wanted: Wanted },
}

/// What is looked for on the way back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// A breakpoint.
    Breakpoint,
    /// A line in a block that is no deeper than this.
    Line { depth: usize, fine: bool },
}

/// A statement that is about to run.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    pub count: u64,
    pub cycle: u64,
    pub depth: usize,
    pub new_line: bool,
}

impl Course {
    /// Whether the run stops at a statement.
    pub fn ends_at(self, step: Step) -> bool {
        match self {
            Course::Run | Course::Search { .. } => false,
            Course::Entry => true,
            Course::Into { fine } => fine || step.new_line,
            Course::Over { origin, fine } => {
                // After the end of an organization block the next one is not deeper, whatever called it.
                step.depth <= origin.depth && (fine || step.new_line)
            }
            Course::Out { origin } => {
                step.depth < origin.depth || (origin.depth <= 1 && step.cycle > origin.cycle && step.new_line)
            }
            Course::Cycle(cycle) => step.cycle >= cycle,
            Course::Statement(count) => step.count >= count,
        }
    }

    /// What the client gets to know of a stop.
    pub fn reason(self) -> &'static str {
        match self {
            Course::Entry => "entry",
            Course::Cycle(_) | Course::Statement(_) => "goto",
            Course::Run | Course::Into { .. } | Course::Over { .. } | Course::Out { .. } | Course::Search { .. } => {
                "step"
            }
        }
    }
}
