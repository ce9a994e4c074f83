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
            // `E0203`, `P0203.`
            let number: String = code.chars().filter(char::is_ascii_digit).collect();
            let meant = match Code::from_name(&format!("P{number:0>4}")) {
                Some(meant) => format!("is {} meant?", meant.name()),
                None => format!(
                    "codes go from {} to {}",
                    Code::ALL.first().map_or("", |code| code.name()),
                    Code::ALL.last().map_or("", |code| code.name())
                ),
            };
            report::say(&format!("unknown code `{code}`; {meant}"));
            exit::USAGE
        }
    }
}
