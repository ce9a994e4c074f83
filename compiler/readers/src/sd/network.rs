//! A network of a document: its language, its texts, and its contents.

use plcc_diag::{Code, Diagnostic, FileId, Span};

use super::frame::{Frame, NetworkSource};
use super::{blocks, classify, grammar, graph, messages, pragma, settings, texts};
use plcc_syntax::front::{self, Comment, ParseState, Place};
use plcc_syntax::network::ast::{Content, Language, Network};
use plcc_syntax::scl::fragment;
use plcc_syntax::scl::raw::RawToken;

/// The input for reading networks.
pub struct Source<'a> {
    pub file: FileId,
    pub text: &'a str,
    /// All tokens of the text.
    pub tokens: &'a [RawToken],
    /// Comments inside networks.
    pub comments: &'a [Comment],
    /// Assertions are read.
    pub pragmas: bool,
}

/// Reads a network.
pub fn read(
    source: &Source,
    frame: &Frame,
    network: &NetworkSource,
    texts: &mut texts::Lookup,
    diagnostics: &mut Vec<Diagnostic>,
) -> Network {
    let language = language(source, frame, network);
    let mut find = |key: &str| {
        let attribute = pragma::find(&network.attributes, key)?;
        texts.find(attribute, diagnostics)
    };
    let title = find("S7_NetworkTitle");
    let comment = find("S7_NetworkComment").map(|text| blocks::lines(&text)).unwrap_or_default();
    let (labels, content) = match language {
        _ if let Some(message) = statement_list(network) => {
            diagnostics.push(message);
            (Vec::new(), Content::Scl(Vec::new()))
        }
        Language::Scl => {
            let (statements, messages) =
                fragment::statements(source.file, source.text, network.bytes.clone(), source.pragmas);
            diagnostics.extend(messages);
            (Vec::new(), Content::Scl(statements))
        }
        _ => {
            let (labels, graph) = graphic(source, network, language, diagnostics);
            (labels, Content::Graphic(graph))
        }
    };
    Network { language, title, comment, labels, content, span: network.span }
}

/// The message about a network whose language is STL. None of its statements are read.
fn statement_list(network: &NetworkSource) -> Option<Diagnostic> {
    let attribute = pragma::find(&network.attributes, "S7_Language").filter(|value| settings::is_stl(value))?;
    Some(
        Diagnostic::new(Code::ForeignContent, attribute.value_span, "plcc reads no networks of STL in SIMATIC SD")
            .label("this network is left out")
            .help("export the block as XML or as a source, which have its statements"),
    )
}

/// From the attributes of the network, otherwise of the block, otherwise from its contents.
fn language(source: &Source, frame: &Frame, network: &NetworkSource) -> Language {
    let named = |attributes: &[pragma::Attribute], key: &str| {
        let value = settings::meant(attributes, key)?;
        let value = value.strip_prefix("F_").unwrap_or(value);
        [("LAD", Language::Lad), ("FBD", Language::Fbd), ("SCL", Language::Scl)]
            .into_iter()
            .find_map(|(name, language)| name.eq_ignore_ascii_case(value).then_some(language))
    };
    let looks = || {
        let tokens = &source.tokens[network.tokens.clone()];
        let word = |word: &str| classify::is_word(source.text, tokens, 0, word);
        if tokens.is_empty() || word("RUNG") || word("Label") { Language::Lad } else { Language::Scl }
    };
    named(&network.attributes, "S7_Language")
        .or_else(|| named(&frame.attributes, "S7_PreferredLanguage"))
        .or_else(|| named(&frame.attributes, "S7_Language"))
        .or_else(|| named(&frame.attributes, "S7_EditorMode"))
        .unwrap_or_else(looks)
}

/// A network of rungs.
fn graphic(
    source: &Source,
    network: &NetworkSource,
    language: Language,
    diagnostics: &mut Vec<Diagnostic>,
) -> (Vec<plcc_syntax::scl::ast::Name>, plcc_syntax::network::ast::Graph) {
    report_assertions(source, network, diagnostics);
    let classified = classify::classify(source.file, source.text, &source.tokens[network.tokens.clone()]);
    let mut state = ParseState::new(source.file, source.text, &classified.tokens, ()).after(&classified.diagnostics);
    let parts = match grammar::NetworkParser::new().parse(&mut state, classified.stream()) {
        Ok(parts) => parts,
        Err(error) => {
            if state.diagnostics.is_empty() {
                let at = front::error_range(&error).map_or(network.bytes.end, |(start, _)| start);
                state.report(messages::Recovery::Network.message(&state, at));
            }
            Vec::new()
        }
    };
    diagnostics.extend_from_slice(&classified.diagnostics);
    diagnostics.append(&mut state.diagnostics);
    graph::build(source, language, parts, diagnostics)
}

/// Assertions belong between networks: inside a network it is undefined when they would be checked.
fn report_assertions(source: &Source, network: &NetworkSource, diagnostics: &mut Vec<Diagnostic>) {
    let mut next = source.comments.partition_point(|comment| (comment.start as usize) < network.bytes.start);
    while source.pragmas
        && let Some(found) = front::pragma::next(source.text, source.comments, &mut next, network.bytes.end as u32)
    {
        let span = Span { file: source.file, start: found.start, end: found.end };
        diagnostics.push(
            Diagnostic::new(Code::Pragma, span, "an assertion is not allowed inside a network of LAD or FBD")
                .label("between rungs")
                .help("write it after `END_NETWORK`; it is checked when the network has run"),
        );
        next += 1;
    }
}
