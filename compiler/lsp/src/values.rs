//! Names of values in files that are not sources, such as plc.toml and scenarios, and how a rename changes them.

use plcc_diag::Span;

use crate::Checked;

/// A name of a value as it is written, by its parts: `Station_DB`, `First`, `Starts`. Indices and slices are left out.
pub type ValueName = Vec<ValuePart>;

/// A part of a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ValuePart {
    pub text: String,
    /// Without quotes of its own; of a key without quotes the whole key.
    pub span: Span,
    pub string: StringForm,
    /// The part is in quotes inside of the string: `'"Station DB".First'`.
    pub is_quoted: bool,
}

/// How TOML writes the string of a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StringForm {
    /// A key without quotes.
    Bare,
    /// `"…"`, with escapes.
    Basic,
    /// `'…'`, as it is.
    Literal,
}

impl ValuePart {
    /// Another name in the place of this one. `Err`: it is not possible there.
    fn renamed(&self, to: &str) -> Result<String, String> {
        let is_plain = to.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '-' | ' '))
            && ![" as ", " in "].iter().any(|word| to.to_ascii_lowercase().contains(word));
        let name = if self.is_quoted || is_plain { to.to_owned() } else { format!("\"{to}\"") };
        let escaped = || name.replace('\\', "\\\\").replace('"', "\\\"");
        match self.string {
            StringForm::Bare if name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-')) => Ok(name),
            StringForm::Bare => Ok(format!("\"{}\"", escaped())),
            StringForm::Basic => Ok(escaped()),
            StringForm::Literal if name.contains('\'') => {
                Err(format!("`{to}` has a `'`, and `{}` stands between such quotes in a TOML file", self.text))
            }
            StringForm::Literal => Ok(name),
        }
    }
}

/// The edits that give another name to each part at which a name means what is renamed. `is_it` gets the parts up to that one.
pub fn edits(checked: &Checked, to: &str, is_it: impl Fn(&[&str]) -> bool) -> Result<Vec<(Span, String)>, String> {
    let mut edits = Vec::new();
    for name in &checked.values {
        let texts: Vec<&str> = name.iter().map(|part| part.text.as_str()).collect();
        for (at, part) in name.iter().enumerate() {
            if is_it(&texts[..=at]) {
                edits.push((part.span, part.renamed(to)?));
            }
        }
    }
    // A table and its values have the name of the table in common.
    edits.sort_by_key(|(span, _)| (span.file, span.start));
    edits.dedup();
    Ok(edits)
}
