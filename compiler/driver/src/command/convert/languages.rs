//! Warnings of titles and comments in several languages, of which the new file has one.

use plcc_diag::{Code, Diagnostic, FileId, Severity, Span};
use plcc_readers::sd::Texts;
use plcc_readers::simatic_ml;
use plcc_readers::xml::XmlKind;

/// In an export of the TIA Portal; also of comments that no other file has.
pub fn of_export(file: FileId, source: &str) -> Vec<Diagnostic> {
    if !matches!(plcc_readers::xml::kind(source), Some(XmlKind::SimaticMl(_))) {
        return Vec::new();
    }
    let languages = simatic_ml::languages_left_out(file, source);
    languages.into_iter().chain(simatic_ml::comments_left_out(file, source)).collect()
}

/// In the texts (`.s7res`) of a document of SIMATIC SD.
pub fn of_document(file: FileId, text: &str) -> Option<Diagnostic> {
    let (texts, _) = Texts::parse(file, text);
    let language = texts.other_language()?;
    let title = format!("texts in other languages are not in the new file, such as those in `{language}`");
    let mut message = Diagnostic::new(Code::NotConverted, Span::new(file, 0..0), title);
    message.severity = Severity::Warning;
    let help = "keep the document, or translate the texts in the editor again";
    Some(message.label("only one language of a text is written").help(help))
}
