//! Whatever a file contains, reading it ends soon, without a panic, and every message has a place in the text.

mod input;
mod reading;

mod gr7;
mod plcopen;
mod s7200;
mod scl;
mod sd;
mod simatic_ml;
mod stl;
