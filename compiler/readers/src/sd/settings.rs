//! The attributes of blocks and networks: their names, and the values that they can have.
//!
//! An attribute that plcc does not use may have any name. One that differs only by a slip from one that plcc uses, or
//! has a value that does not exist, would silently change the meaning of the block. Source: LAD/FBD reference,
//! chapter A.

use plcc_diag::{Code, Diagnostic};
use plcc_literal::distance;

use super::frame::Document;
use super::pragma::{self, Attribute};

const TRUTH: &[&str] = &["TRUE", "FALSE"];
const OF_NETWORK: &[&str] = &["LAD", "FBD", "SCL", "F_LAD", "F_FBD"];
const OF_BLOCK: &[&str] = &["LAD", "FBD", "SCL", "STL", "GRAPH", "DB", "F_LAD", "F_FBD", "F_STL", "F_DB"];

/// German names of languages.
const GERMAN: [(&str, &str); 3] = [("KOP", "LAD"), ("FUP", "FBD"), ("AWL", "STL")];

/// Names of attributes, each with its values; without values: any.
const ATTRIBUTES: &[(&str, &[&str])] = &[
    ("S7_Language", OF_NETWORK),
    ("S7_PreferredLanguage", OF_BLOCK),
    ("S7_EditorMode", &[]),
    ("S7_Optimized", TRUTH),
    ("S7_Optimized_Access", TRUTH),
    ("S7_Safety", TRUTH),
    ("S7_SetENOAutomatically", TRUTH),
    ("S7_IECCheck", TRUTH),
    ("S7_StandardRetain", TRUTH),
    ("S7_EventClass", &[]),
    ("S7_BlockNumber", &[]),
    ("S7_Version", &[]),
    ("S7_Author", &[]),
    ("S7_Family", &[]),
    ("S7_HeaderName", &[]),
    ("S7_BlockTitle", &[]),
    ("S7_BlockComment", &[]),
    ("S7_NetworkTitle", &[]),
    ("S7_NetworkComment", &[]),
];

/// The value of an attribute with a list of values, even if its name or value is misspelt, which [`check`] reports.
pub fn meant<'p>(attributes: &'p [Attribute], key: &str) -> Option<&'p str> {
    let names = || ATTRIBUTES.iter().map(|(name, _)| *name);
    let is_slip = |attribute: &&Attribute| {
        !names().any(|name| attribute.is(name)) && distance::nearest(&attribute.key, names()) == Some(key)
    };
    let value = pragma::find(attributes, key).or_else(|| attributes.iter().find(is_slip))?.value.trim();
    let values = ATTRIBUTES.iter().find(|(name, _)| *name == key).map_or(&[][..], |(_, values)| *values);
    let is_known = values.iter().any(|known| known.eq_ignore_ascii_case(value));
    let near = if is_known { None } else { nearest(value, values) };
    Some(near.unwrap_or(value))
}

/// The value of a list that a misspelt one means, or a German one.
fn nearest(value: &str, values: &[&'static str]) -> Option<&'static str> {
    let german = GERMAN.iter().find(|(german, _)| german.eq_ignore_ascii_case(value)).map(|(_, own)| *own);
    german.filter(|own| values.contains(own)).or_else(|| distance::nearest(value, values.iter().copied()))
}

/// What a slip in an attribute does.
fn effect(name: &str, meant: &str) -> String {
    match name {
        "S7_Language" | "S7_PreferredLanguage" => format!("read as `{meant}`"),
        _ => "has no effect".to_owned(),
    }
}

/// Warns about attributes of blocks and networks that are misspelt, or have a value that they cannot have.
pub fn check(document: &Document, diagnostics: &mut Vec<Diagnostic>) {
    for block in &document.blocks {
        let all = block.attributes.iter().chain(block.networks.iter().flat_map(|network| &network.attributes));
        diagnostics.extend(all.filter_map(fault));
    }
}

/// Whether a language is STL, in English or German.
pub fn is_stl(attribute: &Attribute) -> bool {
    ["STL", "AWL"].iter().any(|name| name.eq_ignore_ascii_case(attribute.value.trim()))
}

fn fault(attribute: &Attribute) -> Option<Diagnostic> {
    let key = &attribute.key;
    let Some((name, values)) = ATTRIBUTES.iter().find(|(name, _)| attribute.is(name)) else {
        let meant = distance::nearest(key, ATTRIBUTES.iter().map(|(name, _)| *name))?;
        return Some(
            Diagnostic::new(Code::AttributeValue, attribute.key_span, format!("the attribute `{key}` is not known"))
                .label(effect(meant, meant))
                .help(format!("is `{meant}` meant?")),
        );
    };
    let value = attribute.value.trim();
    // The network has an error.
    if *name == "S7_Language" && is_stl(attribute) {
        return None;
    }
    if values.is_empty() || value.is_empty() || values.iter().any(|known| known.eq_ignore_ascii_case(value)) {
        return None;
    }
    let (label, help) = match nearest(value, values) {
        Some(meant) => (effect(name, meant), format!("is `{name} := \"{meant}\"` meant?")),
        None => ("has no effect".to_owned(), format!("write one of {}", values.join(", "))),
    };
    Some(
        Diagnostic::new(Code::AttributeValue, attribute.value_span, format!("`{name}` cannot be `{value}`"))
            .label(label)
            .help(help),
    )
}
