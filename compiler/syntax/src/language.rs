//! The textual languages.

/// A textual language.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Language {
    Stl,
    Scl,
    /// SIMATIC SD: LAD, FBD and SCL networks.
    Sd,
    /// GRAPH source text.
    Graph,
    /// STL of the S7-200.
    S7200,
}

impl Language {
    /// The language that the extension of a file stands for, `"scl"`; none for `.txt` and others, whose content decides.
    /// The content of STL decides which family it is for.
    pub fn of_extension(extension: &str) -> Option<Language> {
        let is = |known: &[&str]| known.iter().any(|known| known.eq_ignore_ascii_case(extension));
        if is(&["scl"]) {
            Some(Language::Scl)
        } else if is(&["stl", "awl"]) {
            Some(Language::Stl)
        } else if is(&["s7dcl"]) {
            Some(Language::Sd)
        } else if is(&["gr7", "gr"]) {
            Some(Language::Graph)
        } else {
            None
        }
    }
}
