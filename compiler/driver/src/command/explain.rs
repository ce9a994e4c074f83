//! `plcc explain`.

use plcc_diag::Code;

use crate::command::exit;
use crate::report;

/// Prints the page of `code`.
pub fn explain(code: &str) -> u8 {
    // `p203` and `203` for P0203.
    let digits = code.trim().trim_start_matches(['P', 'p']);
    let padded = format!("P{digits:0>4}");
    match Code::from_name(code.trim()).or_else(|| Code::from_name(&padded)) {
        Some(code) => report::print(code.page()).err().unwrap_or(exit::OK),
        None => {
            report::say(&format!(
                "unknown code `{code}`; codes go from {} to {}",
                Code::ALL.first().map_or("", |code| code.name()),
                Code::ALL.last().map_or("", |code| code.name())
            ));
            exit::USAGE
        }
    }
}
