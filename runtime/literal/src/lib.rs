//! Durations, dates, times of day and whole numbers as people write them in sources, project files, scenarios and flags; and their slips.
//!
//! - [`duration`]: `T#1D_2H_3M_4S_5MS` of the languages, `1.5s` of flags and files, `PT0.02S` of projects in XML.
//! - [`calendar`]: days of months and years, `2000-6-20`, `5:45:00.5`.
//! - [`number`]: `-5`, `1_000`, `16#FF`.
//! - [`distance`]: the name that was meant.
//! - [`article`]: `a` or `an`; [`count`]: `1 cycle`, `12 cycles`.
//! - [`written`]: durations, dates and times of day as text.
//! - [`toml_words`]: what is wrong in a TOML file, in plain words.
//!
//! Everything is computed in integers, so `1.001s` is 1001 ms. Ranges of types and messages are the caller's.
//!
//! **Invariant**: depends on nothing; independent of the language.

pub mod article;
pub mod calendar;
pub mod count;
pub mod distance;
pub mod duration;
pub mod number;
pub mod toml_words;
pub mod written;
