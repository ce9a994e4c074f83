//! The outline of a file, what folds, and the colour of words.

use std::ops::Range;

use lsp_types::{DocumentSymbol, FoldingRange, FoldingRangeKind, SemanticToken, SemanticTokenType, SymbolKind};
use plcc_diag::FileId;
use plcc_syntax::Language;
use plcc_syntax::ast::{Block, Code, CodeBlock};
use plcc_syntax::s7200::ast::Block as S7200Block;

use crate::chart;
use crate::constants::{self, Constant};
use crate::index::{Entry, Index};
use crate::s7200;
use crate::text::Lines;
use crate::words::Words;

/// The blocks of a file with their variables and networks.
pub fn symbols(index: &Index, lines: &Lines, file: FileId) -> Vec<DocumentSymbol> {
    let unit = index.checked.units.iter().find(|(own, _)| *own == file);
    if let Some(source) = unit.and_then(|(_, unit)| unit.s7200.as_ref()) {
        return source.blocks.iter().map(|block| s7200_block(lines, block)).collect();
    }
    let blocks = index.blocks.iter().filter(|entry| entry.file == file);
    blocks.map(|entry| block(index, lines, *entry)).collect()
}

fn block(index: &Index, lines: &Lines, entry: Entry) -> DocumentSymbol {
    let mut children: Vec<DocumentSymbol> = entry
        .variables()
        .into_iter()
        .map(|(direction, variable)| {
            let detail = format!("{} {direction}", index.type_text(&variable.ty));
            let range = variable.name_span.range();
            symbol(lines, variable.name.clone(), detail, SymbolKind::VARIABLE, range.clone(), range)
        })
        .collect();
    children.extend(constants::of(entry).iter().map(|constant| {
        let (detail, range) = (Constant::Local(entry, constant).value(index), constant.name_span.range());
        symbol(lines, constant.name.clone(), detail, SymbolKind::CONSTANT, range.clone(), range)
    }));
    children.extend(chart::of(entry).iter().map(|part| {
        let kind = if matches!(part, chart::Part::Step(_)) { SymbolKind::OBJECT } else { SymbolKind::EVENT };
        let whole = part.whole().range();
        let name = within(part.span().range(), &whole);
        symbol(lines, part.name().to_owned(), part.kind(), kind, whole, name)
    }));
    if let Block::Code(code) = entry.block {
        children.extend(networks(lines, code));
    }
    let kind = match entry.block {
        Block::Code(_) => SymbolKind::FUNCTION,
        Block::Data(_) => SymbolKind::OBJECT,
        Block::Type(_) => SymbolKind::STRUCT,
    };
    let whole = entry.block.span().range();
    let name = within(entry.name().span().range(), &whole);
    let title = entry.title().unwrap_or(entry.keyword()).to_owned();
    let mut made = symbol(lines, entry.text(), title, kind, whole, name);
    made.children = Some(children);
    made
}

/// The networks of a block that has some.
fn networks(lines: &Lines, block: &CodeBlock) -> Vec<DocumentSymbol> {
    let made = |number: usize, title: Option<&String>, range: Range<usize>| {
        let title = title.cloned().unwrap_or_default();
        symbol(lines, format!("Network {number}"), title, SymbolKind::NAMESPACE, range.clone(), range)
    };
    match &block.code {
        Code::Stl(networks) => {
            let numbered = (1..).zip(networks);
            let network = numbered.filter_map(|(number, network)| {
                let (first, last) = (network.statements.first()?, network.statements.last()?);
                let start = first.span.range().start;
                Some(made(number, network.title.as_ref(), start..last.span.range().end.max(start)))
            });
            network.collect()
        }
        Code::Graphic(body) => {
            let numbered = (1..).zip(&body.networks);
            numbered.map(|(number, network)| made(number, network.title.as_ref(), network.span.range())).collect()
        }
        Code::Scl(_) | Code::Chart(_) => Vec::new(),
    }
}

/// A block of an S7-200 with its variables and networks.
fn s7200_block(lines: &Lines, block: &S7200Block) -> DocumentSymbol {
    let variables = block.declarations.iter().map(|one| {
        let (detail, range) = (format!("{} {}", one.ty, s7200::section(one.section)), one.name_span.range());
        symbol(lines, one.name.clone(), detail, SymbolKind::VARIABLE, range.clone(), range)
    });
    let networks = (1..).zip(&block.networks).map(|(number, network)| {
        let name = format!("Network {}", network.number.unwrap_or(number));
        let head = network.span.range();
        let end = network.statements.last().map_or(head.end, |last| last.span.range().end.max(head.end));
        symbol(lines, name, network.title.clone(), SymbolKind::NAMESPACE, head.start..end, head)
    });
    let keyword = block.kind.keyword().to_owned();
    let label = s7200::label(block);
    let label = if label.is_empty() { keyword.clone() } else { label };
    let title = if block.title.is_empty() { keyword } else { block.title.clone() };
    let whole = block.span.range();
    let name = block.name.as_ref().map(|(_, span)| *span).or(block.number.map(|(_, span)| span));
    let name = name.map_or(whole.start..whole.start, |name| within(name.range(), &whole));
    let mut made = symbol(lines, label, title, SymbolKind::FUNCTION, whole, name);
    made.children = Some(variables.chain(networks).collect());
    made
}

/// The place of a name: an editor takes only one that is in the place of the whole.
fn within(name: Range<usize>, whole: &Range<usize>) -> Range<usize> {
    if whole.start <= name.start && name.end <= whole.end { name } else { whole.start..whole.start }
}

fn symbol(
    lines: &Lines,
    name: String,
    detail: String,
    kind: SymbolKind,
    range: Range<usize>,
    selection: Range<usize>,
) -> DocumentSymbol {
    #[allow(deprecated, reason = "the type has no other constructor")]
    DocumentSymbol {
        name: if name.trim().is_empty() { "?".to_owned() } else { name },
        detail: Some(detail),
        kind,
        tags: None,
        deprecated: None,
        range: lines.range(range),
        selection_range: lines.range(selection),
        children: None,
    }
}

/// Words that open what `END_…` closes.
const OPENING: [&str; 25] = [
    "ORGANIZATION_BLOCK",
    "FUNCTION_BLOCK",
    "FUNCTION",
    "DATA_BLOCK",
    "TYPE",
    "SUBROUTINE_BLOCK",
    "INTERRUPT_BLOCK",
    "VAR",
    "VAR_INPUT",
    "VAR_OUTPUT",
    "VAR_IN_OUT",
    "VAR_TEMP",
    "STRUCT",
    "IF",
    "CASE",
    "FOR",
    "WHILE",
    "REPEAT",
    "REGION",
    "NETWORK",
    "STEP",
    "INITIAL_STEP",
    "TRANSITION",
    "INTERLOCK",
    "SUPERVISION",
];

/// What folds: blocks, sections, statements with an end, and comments of several lines.
pub fn folding(words: &Words, lines: &Lines) -> Vec<FoldingRange> {
    let mut folds = Vec::new();
    let mut open: Vec<(String, usize)> = Vec::new();
    for at in 0..words.pieces.len() {
        let (word, range) = (words.word(at), words.range(at));
        if word.starts_with("(*") || word.starts_with("/*") {
            folds.extend(fold(lines, range.start, range.end, Some(FoldingRangeKind::Comment)));
            continue;
        }
        let upper = word.to_ascii_uppercase();
        if let Some(what) = upper.strip_prefix("END_") {
            let closes = |own: &str| {
                own == what || what == "VAR" && own.starts_with("VAR_") || what == "STEP" && own == "INITIAL_STEP"
            };
            if let Some(found) = open.iter().rposition(|(own, _)| closes(own)) {
                // The last network of a block has no end of its own.
                let network = open[found + 1..].iter().rfind(|(own, _)| own == "NETWORK");
                folds.extend(network.and_then(|(_, start)| fold(lines, *start, words.range(at - 1).end, None)));
                folds.extend(fold(lines, open[found].1, range.start, None));
                open.truncate(found);
            }
        } else if OPENING.contains(&upper.as_str()) && !(at > 0 && matches!(words.word(at - 1), "." | "#")) {
            if upper == "NETWORK"
                && let Some(found) = open.iter().rposition(|(own, _)| own == "NETWORK")
            {
                folds.extend(fold(lines, open[found].1, words.range(at - 1).end, None));
                open.truncate(found);
            }
            open.push((upper, range.start));
        }
    }
    folds
}

fn fold(lines: &Lines, start: usize, end: usize, kind: Option<FoldingRangeKind>) -> Option<FoldingRange> {
    let (start, end) = (lines.position(start).line, lines.position(end).line);
    (start < end).then(|| FoldingRange { start_line: start, end_line: end, kind, ..FoldingRange::default() })
}

/// What words can be, in the order of the numbers of [`tokens`].
pub const LEGEND: [SemanticTokenType; 7] = [
    SemanticTokenType::COMMENT,
    SemanticTokenType::STRING,
    SemanticTokenType::NUMBER,
    SemanticTokenType::KEYWORD,
    SemanticTokenType::VARIABLE,
    SemanticTokenType::FUNCTION,
    SemanticTokenType::NAMESPACE,
];

/// The colours of all words, each seen from the one before.
pub fn tokens(index: &Index, words: &Words, lines: &Lines, file: FileId) -> Vec<SemanticToken> {
    let mnemonics: std::collections::BTreeSet<u32> = index
        .blocks
        .iter()
        .filter(|entry| entry.file == file)
        .flat_map(|entry| entry.statements())
        .filter_map(|statement| match &statement.kind {
            plcc_syntax::ast::StatementKind::Instruction { mnemonic_span, .. } => Some(mnemonic_span.start),
            _ => None,
        })
        .collect();
    let mut out = Vec::new();
    let (mut line, mut column) = (0, 0);
    for at in 0..words.pieces.len() {
        let range = words.range(at);
        let Some(kind) = kind(words, at, mnemonics.contains(&(range.start as u32))) else { continue };
        let mut start = range.start;
        for part in words.word(at).split('\n') {
            let (from, to) = (lines.position(start), lines.position(start + part.trim_end_matches('\r').len()));
            start += part.len() + 1;
            if to.character <= from.character {
                continue;
            }
            let delta_start = if from.line == line { from.character - column } else { from.character };
            out.push(SemanticToken {
                delta_line: from.line - line,
                delta_start,
                length: to.character - from.character,
                token_type: kind,
                token_modifiers_bitset: 0,
            });
            (line, column) = (from.line, from.character);
        }
    }
    out
}

fn kind(words: &Words, at: usize, mnemonic: bool) -> Option<u32> {
    let word = words.word(at);
    let upper = word.to_ascii_uppercase();
    let after_hash = at > 0 && words.word(at - 1) == "#" && words.glued(at);
    let first = word.chars().next()?;
    Some(match first {
        '/' if word.starts_with("//") || word.starts_with("/*") => 0,
        '(' if word.len() > 1 => 0,
        '\'' => 1,
        '"' => 6,
        '#' => 4,
        _ if mnemonic => 5,
        _ if after_hash => 4,
        '0'..='9' => 2,
        _ if word.contains('#') => 2,
        _ if OPENING.contains(&upper.as_str()) || upper.starts_with("END_") => 3,
        _ if ["BEGIN", "CALL", "THEN", "ELSE", "ELSIF", "OF", "DO", "TO", "BY", "UNTIL", "RUNG", "ARRAY"]
            .contains(&upper.as_str()) =>
        {
            3
        }
        _ if words.language(at) == Language::S7200 && words.first_on_line(at) => 5,
        _ => return None,
    })
}
