//! `plcc station`.

use std::path::{Path, PathBuf};

use super::exit;
use crate::project::FILE_NAME;
use crate::{inputs, report, station};

/// Prints the station of the project in `folder`.
pub fn station(folder: &Path) -> u8 {
    if !folder.join(FILE_NAME).is_file() {
        report::say(&format!("{} is not a project: it contains no {FILE_NAME}", folder.display()));
        return exit::USAGE;
    }
    let read = inputs::read(&[PathBuf::from(folder)]);
    // Only what is wrong with plc.toml matters here.
    let mut diagnostics: Vec<_> = read
        .diagnostics
        .iter()
        .filter(|d| read.sources.file(d.primary.span.file).name.ends_with(FILE_NAME))
        .cloned()
        .collect();
    report::messages(&mut diagnostics, &read.sources);
    if diagnostics.iter().any(plcc_diag::Diagnostic::is_error) {
        return exit::COMPILE;
    }
    match read.project.and_then(|project| project.station) {
        Some(found) => report::print(&station::table(&found)).err().unwrap_or(exit::OK),
        None => {
            report::say(&format!(
                "{} does not describe a station; docs/plc-toml.md shows how",
                folder.join(FILE_NAME).display()
            ));
            exit::USAGE
        }
    }
}
