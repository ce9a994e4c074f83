//! Tests by chance and by all combinations. One program for all, since each costs as much to link.

mod charts;
mod exports;
mod matrix;
mod mutations;
mod partial;
mod random;
mod s7200;
