//! How code is made of the IR: the level, the passes that are left out, and the processor.

use plcc_opt::Without;

use crate::cli::{CpuFeatures, Level};

/// How code is made of the IR.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Optimization {
    pub level: Level,
    /// Passes that do not run at -O2.
    pub without: Without,
    pub cpu_features: CpuFeatures,
}

/// All passes, for every processor.
impl From<Level> for Optimization {
    fn from(level: Level) -> Optimization {
        Optimization { level, without: Without::NOTHING, cpu_features: CpuFeatures::Baseline }
    }
}

/// `-O2 without fold --cpu-features native`.
impl std::fmt::Display for Optimization {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self.level {
            Level::O0 => "-O0",
            Level::O2 => "-O2",
        })?;
        if self.without != Without::NOTHING {
            write!(f, " {}", self.without)?;
        }
        match self.cpu_features {
            CpuFeatures::Baseline => Ok(()),
            CpuFeatures::Native => f.write_str(" --cpu-features native"),
        }
    }
}
