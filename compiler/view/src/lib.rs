//! Drawings of programs.

pub mod book;
pub mod chart;
pub mod diagram;
pub mod ladder;
pub mod listing;
pub mod metrics;
pub mod names;
pub mod scene;
pub mod shape;
pub mod sheet;
pub mod svg;
