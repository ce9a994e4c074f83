//! Texts of titles and comments in several languages: the `.s7res` beside a `.s7dcl`.

use std::collections::HashMap;

use plcc_diag::{Code, Diagnostic};

use super::pragma::Attribute;

/// Texts by their ids (`MLC_…`).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Texts {
    by_id: HashMap<String, String>,
}

/// Finds texts, and tells once of each that is missing.
pub struct Lookup<'a> {
    texts: Option<&'a Texts>,
}

impl<'a> Lookup<'a> {
    pub fn new(texts: Option<&'a Texts>) -> Lookup<'a> {
        Lookup { texts }
    }

    /// The text whose id the attribute holds; without a file of texts the id itself.
    pub fn find(&mut self, attribute: &Attribute, diagnostics: &mut Vec<Diagnostic>) -> Option<String> {
        if attribute.value.is_empty() {
            return None;
        }
        let Some(texts) = self.texts else { return Some(attribute.value.clone()) };
        let found = texts.by_id.get(&attribute.value);
        if found.is_none() {
            diagnostics.push(
                Diagnostic::new(
                    Code::TextResource,
                    attribute.value_span,
                    format!("the text `{}` is not in the .s7res file", attribute.value),
                )
                .label("names a text")
                .help("export the block again with its texts, or remove the attribute"),
            );
        }
        found.cloned()
    }
}
