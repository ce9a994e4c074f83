//! The syntax tree of a file: its blocks with their declarations, as SCL reads them, and their charts.

use plcc_diag::{Code, Diagnostic, FileId, Span};

use super::frame::{Document, Frame};
use super::lexer::{RawKind, RawText};
use super::messages::comment_after;
use super::tree::Part;
use super::{classify, grammar, pragma, settings};
use crate::{ReadOptions, language};
use plcc_syntax::ast::{Block, Code as BlockCode, CodeBlock, CodeKind, SourceUnit, Width};
use plcc_syntax::chart::ast::Body;
use plcc_syntax::front::ParseState;
use plcc_syntax::scl::ast::StatementKind;
use plcc_syntax::scl::{address, fragment, raw};
use plcc_syntax::stl::{self, Mnemonics};

/// Builds the tree.
pub fn build(
    file: FileId,
    text: &str,
    raw: &RawText,
    document: &Document,
    options: &ReadOptions,
    diagnostics: &mut Vec<Diagnostic>,
) -> SourceUnit {
    // Lone carriage returns end lines here, but not in SCL.
    let declared = language::masked(text, &document.declarations, true).replace('\r', "\n");
    let (mut blocks, mut pragmas, messages) = fragment::blocks(file, text, &raw::scan(&declared), options.pragmas);
    diagnostics.extend(messages);
    for block in &mut blocks {
        let start = block.span().start;
        if let Block::Code(block) = block
            && let Ok(index) = document.blocks.binary_search_by_key(&start, |frame| frame.start)
        {
            // Assertions in the head of a block belong to the file.
            if let BlockCode::Scl(body) = &block.code {
                pragmas.extend(body.statements.iter().filter_map(|statement| match &statement.kind {
                    StatementKind::Pragma(pragma) => Some(pragma.clone()),
                    _ => None,
                }));
            }
            complete(file, text, raw, block, &document.blocks[index], diagnostics);
        }
    }
    pragmas.sort_by_key(|pragma| pragma.span.start);
    let mnemonics = options.mnemonics.unwrap_or_else(|| mnemonics(text, document));
    SourceUnit { mnemonics, blocks, pragmas, ..SourceUnit::default() }
}

/// The set that has most of the addresses which only one set has, `E0.0` or `IW4`; without any: international.
fn mnemonics(text: &str, document: &Document) -> Mnemonics {
    let mut counts = [0usize; 2];
    let tokens = document.blocks.iter().flat_map(|frame| &frame.chart);
    for token in tokens.filter(|token| matches!(token.kind, RawKind::Word | RawKind::Absolute)) {
        if let Some(set) = set_of(&text[token.range()]) {
            counts[set as usize] += 1;
        }
    }
    if counts[Mnemonics::De as usize] > counts[Mnemonics::En as usize] { Mnemonics::De } else { Mnemonics::En }
}

/// The only set that has an address; `None`: both have it, or it is a name.
fn set_of(word: &str) -> Option<Mnemonics> {
    let word = word.trim_start_matches('%').to_ascii_uppercase();
    let (letters, place) = word.split_at(word.find(|c: char| !c.is_ascii_alphabetic())?);
    let (area, width) = address::area_word(letters)?;
    // `A1` is a name.
    let is_place = place.bytes().all(|byte| byte.is_ascii_digit() || matches!(byte, b'.' | b' ' | b'\t'));
    if !is_place || (width == Width::Bit) != place.contains('.') {
        return None;
    }
    let has = |set: Mnemonics| stl::letters(area, width, set).is_some_and(|own| own == letters);
    match (has(Mnemonics::En), has(Mnemonics::De)) {
        (true, false) => Some(Mnemonics::En),
        (false, true) => Some(Mnemonics::De),
        (true, true) | (false, false) => None,
    }
}

/// Gives a block its chart, and the contents of its comments.
fn complete(
    file: FileId,
    text: &str,
    raw: &RawText,
    block: &mut CodeBlock,
    frame: &Frame,
    diagnostics: &mut Vec<Diagnostic>,
) {
    if block.kind != CodeKind::Fb {
        diagnostics.push(
            Diagnostic::new(Code::BlockFrame, block.name.span(), "only an FB can contain a chart")
                .label("not the name of an FB")
                .help("write `FUNCTION_BLOCK FB1` or `FUNCTION_BLOCK \"Name\"`"),
        );
    }
    for section in &mut block.sections {
        for variable in &mut section.variables {
            if variable.comment.is_none() {
                let end = variable.initial.as_ref().map_or(variable.ty.span.end, |value| value.span.end);
                variable.comment = comment_after(text, &raw.comments, end as usize);
            }
        }
    }
    let classified = classify::classify(file, text, &frame.chart);
    let mut state = ParseState::new(file, text, &classified.tokens, ())
        .storing_in("memory bit")
        .with_comments(&raw.comments)
        .after(&classified.diagnostics);
    let parts = grammar::ChartParser::new().parse(&mut state, classified.stream()).unwrap_or_default();
    let mut messages = classified.diagnostics.clone();
    messages.append(&mut state.diagnostics);
    let mut chart = Body::default();
    let mut numbers = Numbers::default();
    for part in parts {
        match part {
            Part::Settings(text) => settings::read(text, &mut chart.settings),
            Part::Comment(text) => block.header.comment.extend(pragma::lines(text)),
            Part::Permanents(false, rows) => chart.before.extend(rows),
            Part::Permanents(true, rows) => chart.after.extend(rows),
            Part::Step(mut step, number) => {
                step.number = number.unwrap_or_default();
                if step.number == 0 {
                    let told = number.is_none() && !step.name.text.is_empty();
                    numbers.steps.push((chart.steps.len(), step.name.span, told));
                }
                chart.steps.push(step);
            }
            Part::Transition(mut transition, number) => {
                transition.number = number.unwrap_or_default();
                if transition.number == 0 {
                    let told = number.is_none() && !transition.name.text.is_empty();
                    numbers.transitions.push((chart.transitions.len(), transition.name.span, told));
                }
                chart.transitions.push(transition);
            }
        }
    }
    numbers.give(&mut chart, &mut messages);
    // The last one listed is drawn leftmost.
    let count = chart.transitions.len() as u32;
    for (transition, before) in chart.transitions.iter_mut().zip(1..) {
        transition.path = vec![count - before];
    }
    chart.broken = messages.iter().any(Diagnostic::is_error);
    diagnostics.append(&mut messages);
    block.code = BlockCode::Chart(chart);
}

/// Steps and transitions without a number: indices in their lists, names, and whether to report it.
#[derive(Default)]
struct Numbers {
    steps: Vec<(usize, Span, bool)>,
    transitions: Vec<(usize, Span, bool)>,
}

impl Numbers {
    /// Gives each of them the next free number.
    fn give(self, chart: &mut Body, diagnostics: &mut Vec<Diagnostic>) {
        let mut report = |span, what: &str, number, told: bool| {
            if !told {
                return;
            }
            diagnostics.push(
                Diagnostic::new(Code::Tolerated, span, format!("the {what} has no number"))
                    .label(format!("read as number {number}"))
                    .help(format!("write `(*$_NUM {number}*)` after its name")),
            );
        };
        let mut last = chart.steps.iter().map(|step| step.number).max().unwrap_or(0);
        for (index, span, told) in self.steps {
            last = last.saturating_add(1);
            chart.steps[index].number = last;
            report(span, "step", last, told);
        }
        let mut last = chart.transitions.iter().map(|transition| transition.number).max().unwrap_or(0);
        for (index, span, told) in self.transitions {
            last = last.saturating_add(1);
            chart.transitions[index].number = last;
            report(span, "transition", last, told);
        }
    }
}
