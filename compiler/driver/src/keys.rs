//! What the readers of the tables of plc.toml share: wrong keys are reported and ignored.

use plcc_binding::similar;
use plcc_diag::{Code, Diagnostic, FileId, Span};
use toml::Spanned;

/// What to write in place of a word: the known one that it resembles or is a part of, or all of them.
pub(crate) fn one_of(word: &str, known: &[&str]) -> String {
    // `4-20mA` is `4..20 mA`.
    let plain = |text: &str| text.replace("..", "-").replace('±', "+-").replace([' ', '_'], "").to_lowercase();
    let digits = |text: &str| text.chars().filter(char::is_ascii_digit).collect::<String>();
    let own = plain(word);
    let only = |fits: fn(&str, &str) -> bool| {
        let mut fitting = known.iter().copied().filter(|known| !own.is_empty() && fits(&plain(known), &own));
        let first = fitting.next()?;
        fitting.next().is_none().then_some(first)
    };
    let alike = || similar(word, known.iter().copied().filter(|known| digits(known) == digits(word)));
    let near = only(|known, own| known == own)
        .or_else(alike)
        .or_else(|| only(|known, own| known.starts_with(own)))
        .or_else(|| only(|known, own| known.contains(own)));
    // Words with commas of their own are not a list between commas.
    let separator = if known.iter().any(|known| known.contains(',')) { "; " } else { ", " };
    match near {
        Some(near) => format!("write `{near}`"),
        None => format!("one of {}", known.join(separator)),
    }
}

/// Reads a table.
pub(crate) struct Reader {
    pub file: FileId,
    pub diagnostics: Vec<Diagnostic>,
}

impl Reader {
    pub fn new(file: FileId) -> Reader {
        Reader { file, diagnostics: Vec::new() }
    }

    pub fn report<T>(&mut self, key: &Spanned<T>, title: String, help: &str) {
        self.diagnostics.push(Diagnostic::new(Code::Project, Span::new(self.file, key.span()), title).help(help));
    }

    /// The name of a file or device, `what`, such as `example`.
    pub fn file_name(&mut self, key: &Spanned<String>, what: &str, example: &str) -> Option<String> {
        if key.get_ref().is_empty() || key.get_ref().contains('\0') {
            self.report(key, format!("this is not the name of a {what}"), &format!("write `\"{example}\"`"));
            return None;
        }
        Some(key.get_ref().clone())
    }
}

#[cfg(test)]
mod tests {
    use super::one_of;

    #[test]
    fn words_name_what_is_meant() {
        let modes = ["single phase", "single phase, external direction", "quadrature", "quadrature 4x"];
        assert_eq!(one_of("quadrature 4", &modes), "write `quadrature 4x`");
        assert_eq!(one_of("single  phase", &modes), "write `single phase`");
        assert_eq!(one_of("external", &modes), "write `single phase, external direction`");
        assert_eq!(one_of("phase", &modes), format!("one of {}", modes.join("; ")));
        let ranges = ["0..10 V", "0..20 mA", "4..20 mA", "+-10 V"];
        assert_eq!(one_of("4-20mA", &ranges), "write `4..20 mA`");
        assert_eq!(one_of("4..20 V", &ranges), "write `4..20 mA`");
        assert_eq!(one_of("±10V", &ranges), "write `+-10 V`");
        assert_eq!(one_of("2..10 V", &ranges), "one of 0..10 V, 0..20 mA, 4..20 mA, +-10 V");
        assert_eq!(one_of("E", &["even", "odd", "none"]), "write `even`");
        let axes = ["TO_PositioningAxis", "TO_SynchronousAxis", "TO_SpeedAxis"];
        assert_eq!(one_of("PositioningAxis", &axes), "write `TO_PositioningAxis`");
        assert_eq!(one_of("axis", &axes), "one of TO_PositioningAxis, TO_SynchronousAxis, TO_SpeedAxis");
        assert_eq!(one_of("", &axes), "one of TO_PositioningAxis, TO_SynchronousAxis, TO_SpeedAxis");
    }
}
