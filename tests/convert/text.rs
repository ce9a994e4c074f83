//! Sources that are written in their own notation read back to the same tree.

use std::fs;
use std::path::{Path, PathBuf};

use plcc_convert::scl::Others;
use plcc_convert::trivia::Trivia;
use plcc_diag::{Diagnostic, FileId};
use plcc_readers::ReadOptions;
use plcc_readers::sd::Texts;
use plcc_syntax::ast::SourceUnit;
use plcc_syntax::stl::Mnemonics;
use plcc_syntax::{scl, stl};

use crate::{comments, has_errors, parsed, sources, tree};

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
    if !same_but_for_marks(&before, &after, set) {
        return Some(Err(format!("{}\n{written}", plcc_tests::difference(&before, &after))));
    }
    let (before, after) = (comments(&text, &all), comments(&written, &stl::comments(&written)));
    // A comment after `a, b : INT` belongs to both.
    let lost: Vec<_> = before.iter().filter(|(key, count)| after.get(*key) < Some(count)).collect();
    let new: Vec<_> = after.keys().filter(|key| !before.contains_key(*key)).collect();
    if !lost.is_empty() || !new.is_empty() {
        return Some(Err(format!("comments: {lost:?} became {new:?}")));
    }
    Some(Ok(()))
}

/// Whether two trees are the same, but for a `#` before names such as `I1`, which are addresses in the mnemonics that were written.
fn same_but_for_marks(before: &str, after: &str, set: Mnemonics) -> bool {
    let letters = match set {
        Mnemonics::En => ['I', 'Q', 'C'],
        Mnemonics::De => ['E', 'A', 'Z'],
    };
    let is_like_address = |name: &str| {
        let digits = name.strip_prefix(letters).unwrap_or_default();
        !digits.is_empty() && digits.bytes().all(|digit| digit.is_ascii_digit())
    };
    let is_same = |(before, after): (&str, &str)| {
        before == after || is_like_address(before) && after.strip_prefix('#') == Some(before)
    };
    let words = |text: &str| text.split([' ', '\n']).count();
    words(before) == words(after) && before.split([' ', '\n']).zip(after.split([' ', '\n'])).all(is_same)
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

/// The comments of a source in its language.
type CommentsOf = fn(&str) -> Vec<plcc_syntax::front::Comment>;

/// The texts of comments, the tree as it is read, and messages.
struct Written {
    text: String,
    texts: Option<String>,
    messages: Vec<Diagnostic>,
}

/// What is different after a round trip of a source in SCL or SIMATIC SD, or nothing; `None`: the source is not one that can be written.
fn round_trip(
    path: &Path,
    comments_of: CommentsOf,
    write: impl Fn(&SourceUnit, &str) -> Written,
) -> Option<Result<(), String>> {
    let text = plcc_syntax::decode_as(&fs::read(path).expect("a test file"), None);
    let language = plcc_driver::pipeline::language_of(&path.to_string_lossy());
    let texts_beside = fs::read_to_string(path.with_extension("s7res")).ok();
    let texts_beside = texts_beside.map(|texts| Texts::parse(FileId::default(), &texts).0);
    let options = ReadOptions { language, texts: texts_beside.as_ref(), ..Default::default() };
    let (unit, messages) = plcc_readers::parse(FileId::default(), &text, &options);
    if has_errors(&messages) || unit.blocks.is_empty() {
        return None;
    }
    let written = write(&unit, &text);
    if has_errors(&written.messages) {
        return Some(Err(format!("{:#?}", written.messages)));
    }
    let texts = written.texts.map(|texts| Texts::parse(FileId::default(), &texts).0).or(texts_beside);
    let options = ReadOptions { language, texts: texts.as_ref(), ..Default::default() };
    let (again, messages) = plcc_readers::parse(FileId::default(), &written.text, &options);
    if has_errors(&messages) {
        let first = messages.iter().find(|message| message.is_error());
        return Some(Err(format!("{first:?}\n{}", written.text)));
    }
    let (before, after) = (tree(&unit), tree(&again));
    if before != after {
        return Some(Err(format!("{}\n{}", plcc_tests::difference(&before, &after), written.text)));
    }
    let (before, after) = (comments(&text, &comments_of(&text)), comments(&written.text, &comments_of(&written.text)));
    let lost: Vec<_> = before.iter().filter(|(key, count)| after.get(*key) < Some(count)).collect();
    if !lost.is_empty() {
        return Some(Err(format!("comments: {lost:?} are lost")));
    }
    Some(Ok(()))
}

fn all_come_back(
    paths: Vec<PathBuf>,
    least: usize,
    comments_of: CommentsOf,
    write: impl Fn(&SourceUnit, &str) -> Written,
) {
    let (mut count, mut failed) = (0, Vec::new());
    for path in paths {
        match round_trip(&path, comments_of, &write) {
            None => {}
            Some(Ok(())) => count += 1,
            Some(Err(text)) => failed.push(format!("{}: {text}", path.display())),
        }
    }
    assert!(failed.is_empty(), "{} of {}:\n{}", failed.len(), count + failed.len(), failed.join("\n\n"));
    assert!(count >= least, "only {count} sources");
}

#[test]
fn comments_stay_in_their_branch() {
    let source = r#"FUNCTION "Branches" : VOID
VAR_TEMP
    n : INT;
END_VAR
BEGIN
    IF #n = 1 THEN
        // nothing to do
    ELSE
        #n := 2;                // two
        // after two
    END_IF;
    IF #n = 2 THEN
        #n := 3;
        // end of THEN
    ELSIF #n = 3 THEN
        ;
        (* end
           of ELSIF: no ELSE *)
    ELSE                        // else
        // only a remark: END_IF ELSE
    END_IF;
    CASE #n OF
        1:
            #n := 4;
        // end of 1
    ELSE
        // begin of ELSE
        #n := 5;
    END_CASE;
END_FUNCTION
"#;
    let (unit, messages) = plcc_readers::parse(FileId::default(), source, &ReadOptions::default());
    assert!(!has_errors(&messages), "{messages:#?}");
    let trivia = Trivia::new(source, scl::comments(source), false);
    let (written, messages) = plcc_convert::scl::write(&unit, trivia, Some(source), Others::Refused);
    assert!(!has_errors(&messages), "{messages:#?}");
    assert_eq!(written, source);
}

#[test]
fn scl_reads_back_as_it_was() {
    let mut paths = sources("scl");
    // Sources that also have blocks in other languages.
    let has_networks =
        |path: &PathBuf| fs::read(path).is_ok_and(|bytes| String::from_utf8_lossy(&bytes).contains("NETWORK"));
    paths.retain(|path| !has_networks(path) && !path.ends_with("variants_from_stl.scl"));
    all_come_back(paths, 180, scl::comments, |unit, text| {
        let trivia = Trivia::new(text, scl::comments(text), false);
        let (text, messages) = plcc_convert::scl::write(unit, trivia, Some(text), Others::Refused);
        Written { text, texts: None, messages }
    });
}

#[test]
fn simatic_sd_reads_back_as_it_was() {
    all_come_back(sources("s7dcl"), 60, scl::comments, |unit, text| {
        let trivia = Trivia::new(text, scl::comments(text), false);
        let document = plcc_convert::sd::rewrite(unit, trivia, text, false);
        Written { text: document.text, texts: document.texts, messages: document.messages }
    });
}

#[test]
fn graph_reads_back_as_it_was() {
    let mut paths = sources("gr7");
    // It also has blocks in other languages.
    paths.retain(|path| !path.ends_with("mixed.gr7"));
    all_come_back(paths, 60, plcc_readers::gr7::comments, |unit, text| {
        let trivia = Trivia::new(text, plcc_readers::gr7::comments(text), true);
        let (text, messages) = plcc_convert::gr7::write(unit, trivia, Some(text));
        Written { text, texts: None, messages }
    });
}
