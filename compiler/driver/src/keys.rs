//! What the readers of the tables of plc.toml share: wrong keys are reported and ignored.

use plcc_diag::{Code, Diagnostic, FileId, Span};
use toml::Spanned;

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
