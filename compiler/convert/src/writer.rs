//! What all writers share: the text so far, the comments still to come, messages.

use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_syntax::literal::Literal;
use plcc_syntax::stl::Mnemonics;

use crate::literal;
use crate::out::Out;
use crate::sd::attributes::Braces;
use crate::trivia::Trivia;

/// The notation of text that is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notation {
    Stl,
    Scl,
    /// SIMATIC SD.
    Sd,
    /// GRAPH as source text.
    Gr7,
    /// ST of IEC 61131-3.
    St,
}

/// A source that grows.
pub(crate) struct Writer<'a> {
    pub out: Out,
    pub trivia: Trivia<'a>,
    pub notation: Notation,
    pub mnemonics: Mnemonics,
    /// The text that spans mean, if its constants are written as in the new notation.
    pub source: Option<&'a str>,
    /// The source is an export in XML, which has names without quotes: those that are words of the language get some.
    pub quotes_words: bool,
    /// In SIMATIC SD a block in SCL is a network in SCL.
    pub scl_as_networks: bool,
    /// The attributes of the document of SIMATIC SD that another one is made of.
    pub braces: Option<Braces<'a>>,
    /// Comments that are written before their place in the source is reached.
    pub written: Vec<String>,
    pub messages: Vec<Diagnostic>,
}

impl<'a> Writer<'a> {
    pub fn new(notation: Notation, mnemonics: Mnemonics, trivia: Trivia<'a>, source: Option<&'a str>) -> Writer<'a> {
        let (written, messages) = (Vec::new(), Vec::new());
        Writer {
            out: Out::default(),
            trivia,
            notation,
            mnemonics,
            source,
            quotes_words: false,
            scl_as_networks: false,
            braces: None,
            written,
            messages,
        }
    }

    /// A constant as the author wrote it, if the notation has it so; otherwise in its usual form.
    pub fn slice(&self, span: Span, value: &Literal) -> String {
        let same = |text: &&str| plcc_syntax::literal::parse(text).as_ref() == Ok(value);
        let has_area = matches!(value, Literal::AreaPointer { .. } | Literal::Any(_));
        let text = self.source.filter(|_| !has_area).and_then(|source| source.get(span.range()));
        text.filter(same).map_or_else(|| self.usual(span, value), str::to_string)
    }

    fn usual(&self, span: Span, value: &Literal) -> String {
        match value {
            Literal::Real(number) if self.notation != Notation::Stl => self.number(span, *number),
            _ => literal::stl(value, self.mnemonics),
        }
    }

    /// A number of a statement list with the digits of its author, all of which an LREAL has. `nearest`: its value as a REAL.
    pub fn number(&self, span: Span, nearest: f32) -> String {
        let text = self.trivia.source().get(span.range()).unwrap_or_default();
        let digits: String = text.rsplit('#').next().unwrap_or_default().replace(['_', ' '], "");
        match digits.parse::<f64>() {
            Ok(value) if value as f32 == nearest => literal::real(value, &format!("{value:?}")),
            _ => literal::real(f64::from(nearest), &format!("{nearest:?}")),
        }
    }

    /// Something that the notation cannot say.
    pub fn refuse(&mut self, span: Span, title: impl Into<String>, help: &str) {
        let message = Diagnostic::new(Code::NotConverted, span, title);
        self.messages.push(message.label("cannot be converted").help(help));
    }

    /// Something that is not in the new source, though it compiles.
    pub fn warn(&mut self, span: Span, title: impl Into<String>, help: &str) {
        let mut message = Diagnostic::new(Code::NotConverted, span, title);
        message.severity = Severity::Warning;
        self.messages.push(message.label("is lost").help(help));
    }
}
