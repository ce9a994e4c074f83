//! Round trips of `plcc convert`: what is written reads back to the same tree, with its comments.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use plcc_convert::trivia::Trivia;
use plcc_diag::{Diagnostic, FileId};
use plcc_readers::ReadOptions;
use plcc_syntax::ast::SourceUnit;
use plcc_syntax::stl::Mnemonics;
use plcc_syntax::{ParseOptions, ast_text, stl};
use plcc_tests::{files, root, tests_folder};

/// Sources with that extension, of tests that compile and of the samples.
fn sources(extension: &str) -> Vec<PathBuf> {
    let mut found = files(&tests_folder().join("run"), extension);
    found.extend(files(&tests_folder().join("parse"), extension));
    found.extend(files(&root().join("samples"), extension));
    found
}

/// The tree as text, without its set of mnemonics.
fn tree(unit: &SourceUnit) -> String {
    ast_text(unit).lines().skip(1).collect::<Vec<_>>().join("\n")
}

/// How often each comment is there.
fn comments(text: &str, of: &[plcc_syntax::front::Comment]) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for comment in of {
        for line in text[comment.range()].lines() {
            let words: Vec<&str> = line.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
            *counts.entry(words.join(" ")).or_default() += usize::from(!words.is_empty());
        }
    }
    counts.retain(|_, count| *count > 0);
    counts
}

fn has_errors(messages: &[Diagnostic]) -> bool {
    messages.iter().any(Diagnostic::is_error)
}

fn parsed(text: &str, mnemonics: Option<Mnemonics>) -> (SourceUnit, Vec<Diagnostic>) {
    stl::parse(FileId::default(), text, &ParseOptions { mnemonics, pragmas: false })
}

/// What is different, or nothing; `None`: the source is not one that can be converted.
fn stl_round_trip(path: &Path, set: Mnemonics) -> Option<Result<(), String>> {
    let text = plcc_syntax::decode_as(&fs::read(path).expect("a test file"), None);
    let options =
        ReadOptions { language: plcc_driver::pipeline::language_of(&path.to_string_lossy()), ..Default::default() };
    let (unit, messages) = plcc_readers::parse(FileId::default(), &text, &options);
    let is_stl = unit.blocks.iter().all(|block| match block {
        plcc_syntax::ast::Block::Code(block) => matches!(block.code, plcc_syntax::ast::Code::Stl(_)),
        _ => true,
    });
    if has_errors(&messages) || !is_stl || unit.s7200.is_some() || unit.blocks.is_empty() {
        return None;
    }
    let (direct, messages) = parsed(&text, None);
    if has_errors(&messages) || tree(&direct) != tree(&unit) {
        return None;
    }
    let all = stl::comments(&text);
    let trivia = Trivia::new(&text, all.clone(), true);
    let (written, messages) = plcc_convert::stl::write(&unit, set, trivia, Some(&text));
    if has_errors(&messages) {
        return Some(Err(format!("{messages:#?}")));
    }
    let (again, messages) = parsed(&written, Some(set));
    if has_errors(&messages) {
        return Some(Err(format!("{:?}\n{written}", messages.iter().find(|message| message.is_error()))));
    }
    let (before, after) = (tree(&unit), tree(&again));
    if before != after {
        return Some(Err(format!("{}\n{written}", plcc_tests::difference(&before, &after))));
    }
    let (before, after) = (comments(&text, &all), comments(&written, &stl::comments(&written)));
    // A comment behind `a, b : INT` belongs to both.
    let lost: Vec<_> = before.iter().filter(|(key, count)| after.get(*key) < Some(count)).collect();
    let new: Vec<_> = after.keys().filter(|key| !before.contains_key(*key)).collect();
    if !lost.is_empty() || !new.is_empty() {
        return Some(Err(format!("comments: {lost:?} became {new:?}")));
    }
    Some(Ok(()))
}

/// All STL of the project, in both sets of mnemonics.
#[test]
fn stl_reads_back_as_it_was() {
    let mut count = 0;
    let mut failed = Vec::new();
    for path in sources("stl").into_iter().chain(sources("awl")) {
        for set in [Mnemonics::En, Mnemonics::De] {
            match stl_round_trip(&path, set) {
                None => {}
                Some(Ok(())) => count += 1,
                Some(Err(text)) => failed.push(format!("{} {set:?}: {text}", path.display())),
            }
        }
    }
    assert!(failed.is_empty(), "{} of {}:\n{}", failed.len(), count + failed.len(), failed.join("\n\n"));
    assert!(count > 1000, "only {count} sources");
}
