//! The runtime: process images, organization blocks, timers, counters, system functions.
