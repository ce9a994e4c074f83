//! What the syntax trees of blocks show without names and types.

use plcc_diag::FileId;

pub mod blocks;
pub mod chart_data;
pub mod cpu;
pub mod mentions;
pub mod numbering;

/// File of the sources of the system blocks; no user file has this number.
pub const SYSTEM_FILE: FileId = FileId(u32::MAX);
