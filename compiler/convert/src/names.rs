//! Names as they are written, in quotes where they need them.

use plcc_syntax::scl::keyword::Keyword;

/// A name that is declared, or a component: `speed`, `"speed 1"`.
pub fn declared(name: &str) -> String {
    if is_plain(name) { name.to_string() } else { format!("\"{name}\"") }
}

/// `#speed`, `#"speed 1"`.
pub fn local(name: &str) -> String {
    format!("#{}", declared(name))
}

/// `"Start"`.
pub fn symbol(name: &str) -> String {
    format!("\"{name}\"")
}

/// Whether a name is a word of the language, so that it is a name in quotes only. `END` is none, but half of `END IF`.
pub fn is_word(name: &str) -> bool {
    Keyword::from_word(name).is_some() || name.eq_ignore_ascii_case("END")
}

/// The name in that of an input or output itself, of which `:P` is a part in the tree: `"tag":P`.
pub fn without_periphery(name: &str) -> Option<&str> {
    name.strip_suffix(":P").or_else(|| name.strip_suffix(":p")).filter(|name| !name.is_empty())
}

/// A name as it stands, in quotes only if it must have them.
pub fn bare(name: &str) -> String {
    declared(name)
}

/// Letters, digits and `_`, not first a digit.
fn is_plain(name: &str) -> bool {
    let mut characters = name.chars();
    characters.next().is_some_and(|c| c.is_alphabetic() || c == '_')
        && characters.all(|c| c.is_alphanumeric() || c == '_')
}
