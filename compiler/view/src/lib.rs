//! Drawings of programs.

pub mod book;
pub mod chart;
pub mod covered;
mod data;
pub mod diagram;
pub mod faults;
pub mod ladder;
pub mod listing;
pub mod logic;
pub mod metrics;
pub mod names;
pub mod page;
pub mod scene;
pub mod shape;
pub mod sheet;
pub mod svg;
pub mod trace;
