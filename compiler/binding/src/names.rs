//! How names compare.

/// A name in the form in which names are compared: without letter case and outer blanks.
pub fn fold(name: &str) -> String {
    let name = name.trim();
    if name.is_ascii() { name.to_ascii_lowercase() } else { name.to_lowercase() }
}

/// The name that differs least from `name`, if it only differs by a slip.
pub use plcc_syntax::distance::nearest as similar;
