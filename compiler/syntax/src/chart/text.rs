//! A chart as text, for `--emit ast`.

use super::ast::Body;

/// Its lines, each with its depth.
pub fn lines(chart: &Body) -> Vec<(usize, String)> {
    vec![(0, format!("chart {:?}", chart.dialect))]
}
