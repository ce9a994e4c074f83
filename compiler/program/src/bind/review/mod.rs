//! Warnings about bound code that is valid, but does nothing, or hardly what its author means.
//!
//! A statement has no effect only where no path through the program makes it useful.
//!
//! - [`stl`]: labels, unreachable statements, timers and assignments in STL; [`tree`]: labels and unreachable statements in the other
//!   languages.
//! - [`endless`]: loops that nothing leaves.
//! - [`branches`]: branches of IF in SCL whose condition an earlier branch has.
//! - [`indices`]: loops that go beyond the bounds of an array.
//! - [`division`]: divisions of whole numbers in SCL that become a REAL.
//! - [`instances`]: IEC timers and counters in SCL that two calls share.
//! - [`itself`]: variables in SCL that are compared or combined with themselves, or assigned to themselves.
//! - [`joined`]: comparisons of one value in SCL that are joined the wrong way.
//! - [`negation`]: NOT before a comparison of bit strings in SCL.
//! - [`numbers`]: whole numbers and REALs in one calculation in STL; [`bcd`]: whole numbers and BCD.
//! - [`opened`]: accesses in STL to another data block than the one that was opened.
//! - [`product`]: products of short whole numbers in SCL that become longer ones.
//! - [`repeated`]: conditions in SCL with a part that is there twice, or with its opposite.
//! - [`same`]: whether what is written twice is the same.
//! - [`temporary`]: temporary data that is read before it is written.
//! - [`assigned`]: variables in SCL that are assigned again before anything reads them.
//! - [`outputs`]: outputs that two blocks assign in one cycle.
//! - [`overlaps`]: addresses that share a part of their bytes.
//! - [`recursion`]: blocks that call each other in each of their calls.
//! - [`timers`]: IEC timers without a time.
//! - [`unchanged`]: loops in SCL that change nothing in their condition.

mod assigned;
mod bcd;
mod branches;
mod division;
mod endless;
mod indices;
mod instances;
mod itself;
mod joined;
mod negation;
mod numbers;
mod opened;
mod outputs;
mod overlaps;
mod product;
mod recursion;
mod region;
mod repeated;
mod same;
mod stl;
mod temporary;
mod timers;
mod tree;
mod unchanged;

use std::borrow::Cow;

use plcc_binding::BindInput;
use plcc_diag::{Code, Diagnostic, FileId, SourceFile, SourceMap, Span};
use plcc_model::{BlockKey, Body, CodeBlock};
use plcc_syntax::ast;
use rustc_hash::FxHashMap;

use crate::bind::declarations::Declarations;

/// The language of a block, as far as it decides what is checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Language {
    Stl,
    Scl,
    Networks,
    Chart,
}

/// The messages about the statements of `blocks`, which are those of the user. `mains`: the blocks that the CPU calls in each cycle.
pub fn review(program: &mut Declarations, blocks: &[CodeBlock], mains: &[BlockKey]) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let read = as_read(program.globals.input);
    let sources = read.as_ref();
    let blocks: Vec<(&CodeBlock, Language)> =
        blocks.iter().filter_map(|block| Some((block, language(program, block)?))).collect();
    for (block, language) in &blocks {
        match &block.body {
            Body::Stl(statements) => {
                stl::labels(statements, sources, &mut found);
                stl::unreachable(statements, &mut found);
                stl::values(statements, &program.numbers, sources, &mut found);
                stl::set_and_reset(statements, sources, &mut found);
                stl::edges(statements, sources, &mut found);
                let unit = program.globals.input.units.iter().find(|(file, _)| *file == block.span.file);
                let set = unit.map(|(_, unit)| unit.mnemonics).unwrap_or_default();
                endless::jumps(statements, set, &mut found);
                numbers::review(statements, &program.numbers, sources, &mut found);
                bcd::review(statements, &program.numbers, sources, &mut found);
                opened::review(program, statements, sources, &mut found);
            }
            Body::Scl(body) if *language != Language::Chart => {
                tree::labels(body, sources, &mut found);
                tree::unreachable(body, block.span, *language == Language::Scl, sources, &mut found);
                if *language == Language::Scl {
                    endless::loops(&body.statements, &mut found);
                    let text = |span| program.globals.text(span);
                    unchanged::review(&body.statements, &text, &mut found);
                    branches::review(&body.statements, &text, &mut found);
                    division::review(&body.statements, &text, &mut found);
                    instances::review(program, &body.statements, &mut found);
                    itself::review(&body.statements, &text, &mut found);
                    joined::review(&body.statements, &text, &mut found);
                    repeated::review(&body.statements, &text, &mut found);
                    negation::review(&body.statements, &text, &mut found);
                    product::review(&body.statements, &text, &mut found);
                    indices::review(&body.statements, &text, &mut found);
                    assigned::review(&body.statements, &text, &mut found);
                }
            }
            Body::Scl(_) | Body::S7200(_) | Body::Runtime => {}
        }
        if *language != Language::Chart {
            temporary::review(program, block, &mut found);
        }
    }
    // An edge memory bit in temporary data has a message of its own.
    let reported = &program.globals.report.diagnostics;
    let edges: Vec<Span> =
        reported.iter().filter(|one| one.code == Code::EdgeBit).map(|one| one.primary.span).collect();
    found.retain(|one| one.code != Code::NeverWritten || !edges.contains(&one.primary.span));
    // A comparison with one outcome says why nothing leaves the loop.
    let reported = program.globals.report.diagnostics.iter().chain(&found);
    let outcomes: Vec<Span> = reported.filter(|one| one.code == Code::AlwaysSame).map(|one| one.primary.span).collect();
    found
        .retain(|one| one.code != Code::NothingLeaves || !outcomes.iter().any(|inner| is_in(*inner, one.primary.span)));
    let reported = program.globals.report.diagnostics.iter().chain(&found);
    let told: Vec<Span> = reported.filter(|one| one.code == Code::DoubleCoil).map(|one| one.primary.span).collect();
    outputs::review(&blocks, mains, &told, &mut found);
    overlaps::review(&blocks, &|span| program.globals.text(span), &mut found);
    recursion::review(&blocks, &|key| program.globals.shown(key), &mut found);
    timers::review(program, &blocks, sources, &mut found);
    found
}

/// The sources as the parsers read them: in place of an export its overlay, in which the statements are.
fn as_read<'i>(input: &BindInput<'i>) -> Cow<'i, SourceMap> {
    let overlay = |(file, unit): &'i (FileId, ast::SourceUnit)| Some((*file, unit.overlay.as_deref()?));
    let overlays: FxHashMap<FileId, &str> = input.units.iter().filter_map(overlay).collect();
    if overlays.is_empty() {
        return Cow::Borrowed(input.sources);
    }
    let mut read = SourceMap::default();
    for (id, file) in input.sources.files() {
        let text = overlays.get(&id).copied().unwrap_or(&file.text);
        read.add(SourceFile::new(file.name.as_str(), text));
    }
    Cow::Owned(read)
}

fn is_in(inner: Span, outer: Span) -> bool {
    inner.file == outer.file && outer.start <= inner.start && inner.end <= outer.end
}

fn language(program: &Declarations, block: &CodeBlock) -> Option<Language> {
    Some(match &program.globals.sources.code.get(&block.key())?.block().code {
        ast::Code::Stl(_) => Language::Stl,
        ast::Code::Scl(_) => Language::Scl,
        ast::Code::Graphic(_) => Language::Networks,
        ast::Code::Chart(_) => Language::Chart,
    })
}
