//! The runtime: process images, organization blocks, timers, counters, system functions.
//!
//! - [`cpu`]: the CPU with its memory; [`memory`]: the one allocation.
//! - [`functions`]: the functions that generated code calls, by symbol or by number; [`math`]: the pure ones.
//! - [`timers`], [`counters`], [`clock`], [`datetime`]: cells and time.
//! - [`cycle`], [`organization`], [`schedule`], [`faults`], [`diagnostics`]: cycle, OBs, interrupts, errors.
//! - [`system`]: system functions (SFC), one file per family.
//! - [`io`]: the driver; [`analog`]: words of analog channels; [`plant`]: the process at the I/O.
//! - [`address`], [`names`], [`value`], [`typed`], [`signal`], [`scenario`], [`trace`], [`options`]: what a user writes and sees.
//! - [`communication`]: TCP and ISO-on-TCP connections of the program; [`partners`]: its S7 connections.
//! - [`records`]: data logs, recipes and files of a program.
//! - [`alarms`]: alarms of the program.
//! - `family`: differences between the families of CPUs; [`s7200`]: functions of the S7-200 only.
//! - [`fmi`]: a CPU as a unit of a co-simulation.
//! - [`guest`]: code that runs in the process of the compiler.
//! - [`assertion`]: values of assertions, compared and printed by their types.
//! - [`watch`]: watch tables.
//! - [`probe`]: who looks at a program with probes.
//! - [`realtime`]: the scheduler for real time, locked memory; [`watchdog`]: what interrupts running code.
//! - [`remote`]: devices on a field bus.
//! - [`run`](mod@run), [`testing`]: the two ways to run a program. `executable` holds `main` of a compiled program.
//!
//! **Invariant**: the runtime is independent of the source language and never depends on the compiler.
//! **Invariant**: no `&mut Cpu` exists; generated code and runtime enter each other at will, so all state is in cells.

#![allow(unsafe_code, reason = "generated code and the runtime share the memory of the CPU")]

pub mod address;
pub mod alarms;
pub mod analog;
pub mod assertion;
pub mod bcd;
pub mod change;
pub mod clock;
pub mod code;
pub mod communication;
pub mod counters;
pub mod cpu;
pub mod cycle;
pub mod datetime;
pub mod diagnostics;
mod enabled;
pub mod events;
#[cfg(all(feature = "executable", not(test)))]
pub mod executable;
mod family;
pub mod faults;
pub mod files;
pub mod fmi;
pub mod force;
pub mod functions;
pub mod guest;
pub mod io;
#[cfg(all(feature = "executable", not(test)))]
mod linked;
pub mod loaded;
pub mod math;
pub mod memory;
pub mod modify;
pub mod monitor;
pub mod names;
pub mod ob_set;
mod ob_starts;
pub mod online;
pub mod options;
pub mod organization;
pub mod partners;
pub mod plant;
pub mod probe;
pub mod realtime;
pub mod records;
pub mod remote;
pub mod report;
mod restart;
mod retain;
pub mod run;
pub mod s7200;
pub mod scenario;
pub mod schedule;
pub mod signal;
mod start_values;
pub mod system;
pub mod tape;
pub mod technology;
pub mod testing;
pub mod text;
pub mod timers;
pub mod trace;
pub mod typed;
pub mod value;
pub mod watch;
pub mod watchdog;

#[cfg(test)]
mod tests;

pub use code::Code;
pub use options::RunOptions;
pub use run::run;
pub use testing::{AssertFailure, NOT_REACHED, TestOptions, TestReport, test};
