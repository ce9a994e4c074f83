//! What is wrong in a TOML file, in the words of its author rather than those of a reader of TOML.
//!
//! ```text
//! unknown field `nmae`, expected one of `name`, `cpu`   ──►   `nmae` is not a key here; help: write `name`
//! ```
//!
//! - `keys`: names that are not known; `types`: values of another type; `headings`: tables and lists of tables.
//! - `syntax`: what is not TOML; `literals`: values that are written as in a PLC program.

mod headings;
mod keys;
mod literals;
mod syntax;
#[cfg(test)]
mod tests;
mod types;

use keys::unknown;
pub use literals::bare_literal;
use syntax::syntax;
use types::wrong_type;

/// A message and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wrong {
    pub title: String,
    pub help: String,
}

/// Rewrites `message` of the library, which it reports at `offset` of `text`.
pub fn plain_at(message: &str, text: &str, offset: usize) -> Wrong {
    let offset = (0..=offset.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or_default();
    let start = text[..offset].rfind('\n').map_or(0, |at| at + 1);
    let end = text[offset..].find('\n').map_or(text.len(), |at| offset + at);
    if let Some(wrong) = headings::of_equations(message, text, &text[start..end], end) {
        return wrong;
    }
    if let Some(wrong) = headings::list_of_a_table(message, &text[start..end]) {
        return wrong;
    }
    if let Some(wrong) = headings::list_after_a_table(message, &text[..start], &text[start..end]) {
        return wrong;
    }
    if let Some(wrong) = headings::open_list(message, &text[..start], &text[start..end]) {
        return wrong;
    }
    if let Some(wrong) = headings::open_table(message, &text[..start], &text[start..end]) {
        return wrong;
    }
    if let Some(wrong) = headings::of_a_text(message, text, &text[start..end], end) {
        return wrong;
    }
    if let Some(wrong) = headings::without_name(message, &text[..start], &text[start..end]) {
        return wrong;
    }
    plain(message, text[offset..end].trim_end(), &text[start..end])
}

/// Rewrites `message` of the library. `place`: the text at the place of the error, up to the end of its line. `line`: its whole line.
pub fn plain(message: &str, place: &str, line: &str) -> Wrong {
    let message = message.lines().next().unwrap_or_default();
    let wrong = |title: String, help: String| Wrong { title, help };
    if message.starts_with("unknown field") && line.trim() == "[project]" {
        return wrong(
            "the keys of a project have no heading".to_owned(),
            "remove `[project]`: write its keys at the top of the file".to_owned(),
        );
    }
    if let Some((name, rest)) = quoted_after(message, "unknown field ") {
        return unknown("key here", "keys", name, &all_quoted(rest));
    }
    if let Some((name, rest)) = quoted_after(message, "unknown variant ") {
        let known = all_quoted(rest);
        let Wrong { title, help } = unknown("value here", "values", name, &known);
        return wrong(title, if known.is_empty() { "write another value".to_owned() } else { help });
    }
    if let Some((name, _)) = quoted_after(message, "missing field ") {
        return wrong(format!("the key `{name}` is missing here"), format!("add `{name} = …`"));
    }
    if let Some(rest) = message.strip_prefix("invalid type: ").or_else(|| message.strip_prefix("invalid value: ")) {
        let (found, wanted) = rest.rsplit_once(", expected ").unwrap_or((rest, "another value"));
        return wrong_type(found, wanted, line.trim());
    }
    if let Some((name, _)) = quoted_after(message, "duplicate field ") {
        return wrong(
            format!("the key `{name}` appears twice, under two names"),
            "remove one of them: both mean the same".to_owned(),
        );
    }
    if message.starts_with("duplicate key") {
        let key = place.split(['=', ']']).next().unwrap_or_default().trim();
        return wrong(format!("`{key}` appears twice"), "remove one of them".to_owned());
    }
    if message.starts_with("wanted string or table") {
        return no_word(line.split('#').next().unwrap_or_default());
    }
    syntax(message, place, line.trim())
}

/// `startup = 5`, where one of a few words is expected, which the library does not tell.
fn no_word(line: &str) -> Wrong {
    let (key, value) = line.split_once('=').unwrap_or((line, "this"));
    let (key, value) = (key.trim(), value.trim());
    let help = match key {
        "startup" => "write `startup = \"warm\"`; the others are `\"cold\"` and `\"hot\"`".to_owned(),
        "cycle_time_exceeded" => "write `cycle_time_exceeded = \"run\"`, or `\"stop\"`".to_owned(),
        key => format!("write `{key} = \"…\"`"),
    };
    Wrong { title: format!("a text in quotation marks is expected here, not {value}"), help }
}

/// The word between back quotes after `start`, and the rest.
fn quoted_after<'m>(message: &'m str, start: &str) -> Option<(&'m str, &'m str)> {
    message.strip_prefix(start)?.strip_prefix('`')?.split_once('`')
}

fn all_quoted(text: &str) -> Vec<&str> {
    text.split('`').skip(1).step_by(2).collect()
}
