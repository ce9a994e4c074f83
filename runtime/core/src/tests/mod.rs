//! Tests of the runtime with code made of closures.

mod communication;
mod cycle;
mod enabled;
mod faults;
mod force;
mod helpers;
mod interrupts;
mod modify;
mod plant;
mod playing;
mod retain;
mod run;
mod s7200_interrupts;
mod s7200_retain;
mod s7200_scan;
mod s7200_timers;
mod system;
mod timers;
mod watch;

pub(crate) use helpers::{Block, Closures, cpu_with, image};
