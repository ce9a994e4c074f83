//! Forced values in a file: a table of the user, or the one that the run before has left. It is TOML:
//!
//! ```toml
//! [[force]]
//! address = "I0.0"     # or a name
//! value = "1"          # in the format, or with a prefix
//! format = "bool"      # default: as in a watch table
//! comment = "gate"
//! ```

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use plcc_literal::toml_words;
use serde::{Deserialize, Serialize};

use super::Forced;
use crate::cpu::Cpu;
use crate::diagnostics::{self, NO_SITE};
use crate::files;
use crate::run::say;
use crate::watch::format::Format;

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct FileText {
    #[serde(default)]
    force: Vec<RowText>,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct RowText {
    address: toml::Spanned<String>,
    value: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    format: Option<Format>,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    comment: String,
}

/// Whose table a file has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Table {
    /// The user names it: it must exist and be right.
    Named,
    /// An earlier run has left it, maybe with another version of the program: what cannot be forced is reported and
    /// left out.
    Kept,
}

impl Cpu {
    /// Forces what a file says, and keeps there what is forced from now on. `Err`: the error with its place.
    pub(crate) fn force_from(&self, path: &Path, table: Table) -> Result<(), String> {
        if table == Table::Named || path.exists() {
            self.force_table(path, table)?;
            self.renew_force();
        }
        if self.is_forcing() {
            self.log(diagnostics::FORCE_ACTIVE, NO_SITE, self.force.table.borrow().len() as u32);
        }
        self.force.file.replace(Some(path.to_path_buf()));
        Ok(())
    }

    fn force_table(&self, path: &Path, table: Table) -> Result<(), String> {
        let shown = path.display();
        let text = files::regular(path)
            .and_then(|()| std::fs::read_to_string(path))
            .map_err(|error| format!("{shown}: {error}"))?;
        let placed = |offset: usize, message: &str| {
            let line = text.get(..offset).map_or(1, |before| before.matches('\n').count() + 1);
            format!("{shown}:{line}: {message}")
        };
        let file: FileText = toml::from_str(&text).map_err(|error| {
            let offset = error.span().map_or(0, |span| span.start);
            let wrong = value_at_top(error.message(), &text, offset)
                .unwrap_or_else(|| toml_words::plain_at(error.message(), &text, offset));
            placed(offset, &format!("{}; {}", wrong.title, wrong.help))
        })?;
        let mut left_out = 0;
        let mut names: HashSet<&str> = HashSet::new();
        for row in &file.force {
            let name = row.address.get_ref().trim();
            if !names.insert(name) && table == Table::Named {
                let message = format!("{name} has two rows: which value is it forced to? Keep one of them");
                return Err(placed(row.address.span().start, &message));
            }
            let Err(message) = self.force_row(row.address.get_ref(), &row.value, row.format, &row.comment) else {
                continue;
            };
            let message = placed(row.address.span().start, &message);
            if table == Table::Named {
                return Err(message);
            }
            say!("runtime: {message}; it is no longer forced");
            left_out += 1;
        }
        if left_out > 0 {
            self.log(diagnostics::FORCE_LEFT_OUT, NO_SITE, left_out);
        }
        Ok(())
    }

    /// Writes all forced values to a file.
    pub(super) fn write_force(&self, path: &Path) -> Result<(), String> {
        let row = |one: &Forced| RowText {
            address: toml::Spanned::new(0..0, one.name.clone()),
            value: one.value.clone(),
            format: one.format,
            comment: one.comment.clone(),
        };
        let all = FileText { force: self.force.table.borrow().iter().map(row).collect() };
        let text = toml::to_string(&all).map_err(|error| error.to_string())?;
        // Whole or not at all. `FILE.new` without `.force` is where retentive memory of `FILE` is written.
        let mut new = path.as_os_str().to_os_string();
        new.push(".new");
        let new = PathBuf::from(new);
        std::fs::write(&new, text).and_then(|()| std::fs::rename(&new, path)).map_err(|error| error.to_string())
    }
}

/// `"I0.0" = 1` or `force = { "I0.0" = 1 }`, where each value has a table of its own.
fn value_at_top(message: &str, text: &str, offset: usize) -> Option<toml_words::Wrong> {
    let start = text.get(..offset)?.rfind('\n').map_or(0, |at| at + 1);
    let line = text.get(start..)?.lines().next()?.split(" #").next()?.trim();
    let row = match line.strip_prefix("force").map(|rest| rest.trim_start_matches([' ', '=']).trim()) {
        Some(table) if message.starts_with("invalid type: map") => table.strip_prefix('{')?.split([',', '}']).next()?,
        None if message.starts_with("unknown field") && message.contains("expected `force`") => line,
        _ => return None,
    };
    let (name, value) = row.split_once('=')?;
    let plain = |text: &str| text.trim().trim_matches(['"', '\'']).to_owned();
    let (name, value) = (plain(name), plain(value));
    Some(toml_words::Wrong {
        title: "each forced value has a table `[[force]]`".to_owned(),
        help: format!("write `[[force]]`, and below it `address = \"{name}\"` and `value = \"{value}\"`"),
    })
}
