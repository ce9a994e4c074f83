//! Round trips of `plcc convert`: what is written reads back to the same tree, with its comments.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use plcc_convert::to_graph;
use plcc_convert::to_stl::{self, types::Types};
use plcc_convert::trivia::Trivia;
use plcc_diag::{Diagnostic, FileId, SourceFile};
use plcc_driver::cli::Level;
use plcc_driver::inputs::TestInput;
use plcc_driver::testing::{self, Form, Variant};
use plcc_readers::ReadOptions;
use plcc_readers::sd::Texts;
use plcc_syntax::ast::{Block, BlockName, Code, CodeKind, SourceUnit};
use plcc_syntax::network::ast::Language;
use plcc_syntax::stl::Mnemonics;
use plcc_syntax::symbols::SymbolTable;
use plcc_syntax::{ParseOptions, ast_text, scl, stl};
use plcc_tests::{files, plan, root, tests_folder};

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
    // A comment after `a, b : INT` belongs to both.
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
    let texts = written.texts.map(|texts| Texts::parse(FileId::default(), &texts).0);
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
fn scl_reads_back_as_it_was() {
    let mut paths = sources("scl");
    // Sources that also have blocks in other languages.
    let has_networks =
        |path: &PathBuf| fs::read(path).is_ok_and(|bytes| String::from_utf8_lossy(&bytes).contains("NETWORK"));
    paths.retain(|path| !has_networks(path) && !path.ends_with("variants_from_stl.scl"));
    all_come_back(paths, 180, scl::comments, |unit, text| {
        let trivia = Trivia::new(text, scl::comments(text), false);
        let (text, messages) = plcc_convert::scl::write(unit, trivia, Some(text));
        Written { text, texts: None, messages }
    });
}

#[test]
fn simatic_sd_reads_back_as_it_was() {
    all_come_back(sources("s7dcl"), 60, scl::comments, |unit, text| {
        let trivia = Trivia::new(text, scl::comments(text), false);
        let document = plcc_convert::sd::write(unit, trivia, Some(text));
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

/// Runs a project with its charts of SimaticML or PLCopen XML as sources of GRAPH: how many blocks these are.
fn run_as_graph(path: &Path) -> Result<usize, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut count, mut shown) = (0, String::new());
    for from in everything(path) {
        let to = folder.path().join(from.strip_prefix(path).expect("a file of the project"));
        fs::create_dir_all(to.parent().expect("a folder")).expect("a folder");
        let is_xml = from.extension().is_some_and(|ending| ending == "xml");
        let text = plcc_syntax::decode_as(&fs::read(&from).expect("a file"), None);
        let (unit, _) = plcc_readers::parse(FileId::default(), &text, &ReadOptions::default());
        let is_chart = |block: &Block| matches!(block, Block::Code(code) if matches!(code.code, Code::Chart(_)));
        if !is_xml || !unit.blocks.iter().any(is_chart) {
            match from.extension().is_some_and(|ending| ending == "scl") {
                // A chart of S7-GRAPH has its data without a structure around them.
                true => fs::write(&to, text.replace(".RT_DATA.", ".")).expect("a file"),
                false => drop(fs::copy(&from, &to).expect("a copy")),
            }
            continue;
        }
        let (written, messages) = plcc_convert::gr7::write(&unit, Trivia::none(), unit.overlay.as_deref());
        if has_errors(&messages) {
            return Err(format!("{messages:#?}"));
        }
        count += unit.blocks.iter().filter(|block| is_chart(block)).count();
        fs::write(to.with_extension("gr7"), &written).expect("a file");
        shown.push_str(&written);
        // Numbers of blocks are in symbol tables.
        for block in &unit.blocks {
            if let Block::Code(block) = block
                && let (BlockName::Symbol { name, .. }, Some(number)) = (&block.name, block.header.number)
            {
                let line = format!("\"{name}\",\"FB {number}\",\"FB {number}\",\"\"\n");
                fs::write(to.with_extension("sym.txt"), line).expect("a file");
            }
        }
    }
    let variant = Variant { form: Form::Jit, optimization: Level::O0.into() };
    let outcomes = testing::run(&[TestInput::Project(folder.path().to_path_buf())], &plan(vec![variant]));
    match outcomes.iter().find(|one| one.failed > 0 || one.rejected || one.unreadable) {
        Some(one) => Err(format!("{}{}\n{shown}", one.messages, one.failures)),
        None if outcomes.iter().all(|one| one.passed == 0) => Err("nothing was tested".to_string()),
        None => Ok(count),
    }
}

#[test]
fn charts_of_xml_as_sources_do_the_same() {
    for project in ["star-delta-1500", "two-doses-1500"] {
        let result = run_as_graph(&tests_folder().join("run/graph").join(project));
        assert_eq!(result, Ok(1), "{project}: {}", result.as_ref().err().map_or("", String::as_str));
    }
}

/// A document without the blocks at these places, with their attributes.
fn without(text: &str, blocks: &[std::ops::Range<usize>]) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for block in blocks {
        let before = text[..block.start].trim_end();
        let start = match before.ends_with('}') {
            true => before.rfind('{').unwrap_or(block.start),
            false => block.start,
        };
        bytes[start..block.end].iter_mut().filter(|byte| **byte != b'\n').for_each(|byte| *byte = b' ');
    }
    String::from_utf8(bytes).expect("whole characters were replaced")
}

/// A source whose blocks of LAD and FBD are STL where that is possible; the others stay in their language.
struct AsStl {
    /// What is left of the source.
    rest: String,
    stl: String,
    symbols: String,
    blocks: usize,
    refused: Vec<String>,
}

fn as_stl(text: &str, others: &[SourceUnit], tables: &[SymbolTable], keeps_br: bool) -> AsStl {
    let (unit, _) = plcc_readers::parse(FileId::default(), text, &ReadOptions::default());
    let types = Types::new(std::iter::once(&unit).chain(others), tables);
    let mut made = SourceUnit { blocks: Vec::new(), ..unit.clone() };
    let mut spans = Vec::new();
    let mut symbols = String::new();
    let mut refused = Vec::new();
    for block in &unit.blocks {
        let Block::Code(code) = block else { continue };
        let Code::Graphic(body) = &code.code else { continue };
        match to_stl::block(code, body, &types, keeps_br) {
            Ok(done) => {
                if let (BlockName::Symbol { name, .. }, Some(number)) = (&done.name, done.header.number) {
                    let letters = match done.kind {
                        CodeKind::Fb | CodeKind::Sfb => "FB",
                        CodeKind::Fc | CodeKind::Sfc => "FC",
                        CodeKind::Ob => "OB",
                    };
                    symbols.push_str(&format!("\"{name}\",\"{letters} {number}\",\"{letters} {number}\",\"\"\n"));
                }
                spans.push(code.span.range());
                made.blocks.push(Block::Code(done));
            }
            Err(messages) => refused.extend(messages.into_iter().map(|message| message.title)),
        }
    }
    let mut kept = scl::comments(text);
    kept.retain(|comment| spans.iter().any(|span| span.contains(&comment.range().start)));
    let trivia = Trivia::new(text, kept, true);
    let (written, messages) = plcc_convert::stl::write(&made, Mnemonics::En, trivia, None);
    assert!(!has_errors(&messages), "{messages:#?}");
    let cpu = text.lines().find(|line| line.starts_with("//@ cpu")).unwrap_or_default();
    let stl = format!("{cpu}\n{written}");
    AsStl { rest: without(text, &spans), stl, symbols, blocks: made.blocks.len(), refused }
}

/// All files below a folder.
fn everything(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).into_iter().flatten().flatten().map(|one| one.path()).collect();
    entries.sort();
    entries.into_iter().flat_map(|path| if path.is_dir() { everything(&path) } else { vec![path] }).collect()
}

/// Runs a test, a source or a project, with STL in the place of its networks: how many blocks were STL.
fn run_as_stl(path: &Path) -> Result<usize, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let is_project = path.is_dir();
    let all = match is_project {
        true => everything(path),
        false => vec![path.to_path_buf()],
    };
    let text_of = |path: &Path| plcc_syntax::decode_as(&fs::read(path).expect("a test file"), None);
    let read = |path: &PathBuf| {
        let language = plcc_driver::pipeline::language_of(&path.to_string_lossy());
        plcc_readers::parse(FileId::default(), &text_of(path), &ReadOptions { language, ..Default::default() }).0
    };
    let is_source = |path: &&PathBuf| path.extension().is_some_and(|extension| extension == "s7dcl");
    let declares = |path: &&PathBuf| {
        path.extension().is_some_and(|ending| ["s7dcl", "scl", "db", "xml"].iter().any(|one| ending == *one))
    };
    let units: Vec<SourceUnit> = all.iter().filter(declares).map(read).collect();
    let mut tables = Vec::new();
    for table in
        all.iter().filter(|path| path.extension().is_some_and(|extension| extension == "txt" || extension == "xml"))
    {
        let source = SourceFile::new(table.display().to_string(), text_of(table));
        tables.push(plcc_readers::symbols::parse(FileId::default(), &source).0);
    }
    let texts: Vec<String> = all
        .iter()
        .filter(|path| path.extension().is_none_or(|extension| extension != "xlsx"))
        .map(|path| text_of(path))
        .collect();
    let keeps_br = texts
        .iter()
        .any(|text| ["cpu 31", "cpu s7-300", "cpu = \"31", "cpu = \"s7-300"].iter().any(|cpu| text.contains(cpu)));
    if texts.iter().any(|text| text.starts_with("cpu = ") && text.contains("[hardware_interrupt")) {
        // Only an S7-1200 names them.
        return Ok(0);
    }
    let (mut blocks, mut written, mut program) = (0, String::new(), Vec::new());
    for path_of in &all {
        let name = path_of.strip_prefix(path).ok().filter(|name| is_project && !name.as_os_str().is_empty());
        let name = name.map_or_else(|| PathBuf::from(path_of.file_name().expect("a file")), Path::to_path_buf);
        let to = folder.path().join(&name);
        fs::create_dir_all(to.parent().expect("a folder")).expect("a folder");
        if !is_source(&path_of) {
            fs::copy(path_of, &to).expect("a copy");
            if path_of.ends_with("plc.toml") {
                // An S7-1200 has no STL.
                let lines = text_of(path_of);
                let lines = lines
                    .lines()
                    .filter(|line| !line.starts_with("sources = ["))
                    .map(|line| if line.starts_with("cpu = \"12") { "cpu = \"s7-1500\"" } else { line });
                fs::write(&to, lines.collect::<Vec<_>>().join("\n")).expect("a file");
            }
            continue;
        }
        let made = as_stl(&text_of(path_of), &units, &tables, keeps_br);
        if std::env::var_os("PLCC_SHOW").is_some() {
            println!("{}: {}; {:?}", path_of.display(), made.blocks, made.refused);
        }
        blocks += made.blocks;
        let mut put = |extension: &str, text: &str| {
            let path = to.with_extension(extension);
            fs::write(&path, text).expect("a file");
            program.push(path);
        };
        put("s7dcl", &made.rest);
        if made.blocks > 0 {
            put("stl", &made.stl);
            written.push_str(&made.stl);
        }
        if !made.symbols.is_empty() {
            put("sym.txt", &made.symbols);
        }
    }
    if blocks == 0 {
        return Ok(0);
    }
    let variant = Variant { form: Form::Jit, optimization: Level::O0.into() };
    let input = match is_project {
        true => TestInput::Project(folder.path().to_path_buf()),
        false => TestInput::Program(program),
    };
    let outcomes = testing::run(&[input], &plan(vec![variant]));
    let failed = outcomes.iter().find(|one| one.failed > 0 || one.rejected || one.unreadable);
    match failed {
        Some(one) => Err(format!("{}{}\n{written}", one.messages, one.failures)),
        None if outcomes.iter().all(|one| one.passed == 0) => Ok(0),
        None => Ok(blocks),
    }
}

/// The assertions of the tests for LAD and FBD hold for the statements that are made of them.
#[test]
fn networks_as_statements_do_the_same() {
    let mut count = 0;
    let mut failed = Vec::new();
    let tests = tests_folder().join("run/lad-fbd");
    let projects: Vec<PathBuf> =
        plcc_tests::projects(&tests).into_iter().chain(plcc_tests::projects(&root().join("samples"))).collect();
    let alone =
        files(&tests, "s7dcl").into_iter().filter(|path| !projects.iter().any(|project| path.starts_with(project)));
    for path in alone.collect::<Vec<_>>().iter().chain(&projects) {
        match run_as_stl(path) {
            Ok(blocks) => count += blocks,
            Err(text) => failed.push(format!("{}: {text}", path.display())),
        }
    }
    assert!(failed.is_empty(), "{} files:\n{}", failed.len(), failed.join("\n\n"));
    assert!(count > 30, "only {count} blocks");
}

/// Turns STL into networks where it can be drawn, and these into STL again: the assertions still hold. How many blocks were drawn.
fn run_through_networks(path: &Path, language: Language) -> Result<usize, String> {
    let text = plcc_syntax::decode_as(&fs::read(path).expect("a test file"), None);
    let (unit, messages) = parsed(&text, None);
    // Networks do not keep what is left in the registers of the CPU.
    if has_errors(&messages) || ["//@ test", "STW", "ACCU"].iter().any(|word| text.contains(word)) {
        return Ok(0);
    }
    let types = Types::new(std::iter::once(&unit), &[]);
    let mut drawn = 0;
    let mut blocks = unit.clone();
    for block in &mut blocks.blocks {
        let Block::Code(code) = block else { continue };
        let Code::Stl(networks) = &code.code else { continue };
        // Assertions stand between statements, which networks do not have.
        let asserts = |span: std::ops::Range<usize>| text.get(span).is_some_and(|text| text.contains("//@"));
        let is_tested =
            networks.iter().flat_map(|network| &network.statements).count() > 0 && asserts(code.span.range());
        if is_tested || networks.is_empty() {
            continue;
        }
        if let Ok(network) = to_graph::block(code, &types, language) {
            drawn += 1;
            *code = network;
        }
    }
    if drawn == 0 {
        return Ok(0);
    }
    let (again, messages) = to_stl::unit(&blocks, &types, true);
    if has_errors(&messages) {
        return Err(format!("{messages:#?}"));
    }
    let trivia = Trivia::new(&text, stl::comments(&text), true);
    let (written, messages) = plcc_convert::stl::write(&again, unit.mnemonics, trivia, Some(&text));
    if has_errors(&messages) {
        return Err(format!("{messages:#?}"));
    }
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.stl");
    fs::write(&file, &written).expect("a file");
    let variant = Variant { form: Form::Jit, optimization: Level::O0.into() };
    let outcomes = testing::run(&[TestInput::File(file)], &plan(vec![variant]));
    match outcomes.iter().find(|one| one.failed > 0 || one.rejected || one.unreadable) {
        Some(one) => Err(format!("{}{}\n{written}", one.messages, one.failures)),
        None => Ok(drawn),
    }
}

#[test]
fn statements_as_networks_do_the_same() {
    for language in [Language::Lad, Language::Fbd] {
        let (mut count, mut failed) = (0, Vec::new());
        for path in files(&tests_folder().join("run/stl"), "stl") {
            match run_through_networks(&path, language) {
                Ok(blocks) => count += blocks,
                Err(text) => failed.push(format!("{}: {text}", path.display())),
            }
        }
        assert!(failed.is_empty(), "{} files in {language:?}:\n{}", failed.len(), failed.join("\n\n"));
        assert!(count > 20, "only {count} blocks in {language:?}");
    }
}

/// All combinations of five inputs: the statements, and the networks that are drawn from them.
#[test]
fn ladder_shapes_keep_their_logic() {
    const SHAPES: [&str; 14] = [
        "A I 0.0; A I 0.1; = Q 0.0;",
        "A I 0.0; AN I 0.1; O; AN I 0.2; A I 0.3; = Q 0.0;",
        "A( ; O I 0.0; O I 0.1; ) ; A I 0.2; = Q 0.0;",
        "A I 0.0; O I 0.1; A I 0.2; ON I 0.3; = Q 0.0; = Q 0.1;",
        "A I 0.0; = Q 0.0; = Q 0.1; NOT; = Q 0.2; S Q 0.3;",
        "A I 0.0; A( ; A I 0.1; O; A I 0.2; A I 0.3; ) ; AN I 0.4; S Q 0.0; A I 0.3; R Q 0.0;",
        "X I 0.0; X I 0.1; = Q 0.0;",
        "A I 0.0; O; A I 0.1; X I 0.2; = Q 0.0;",
        "O I 0.0; O( ; A I 0.1; A( ; O I 0.2; O I 0.3; ) ; ) ; = Q 0.0;",
        "AN( ; A I 0.0; A I 0.1; ) ; A I 0.2; = Q 0.0;",
        "A I 0.0; R I 0.0; = Q 0.0; A I 0.0; = Q 0.1;",
        "A I 0.0; FP M 5.0; = Q 0.0; S Q 0.1; A I 0.1; R Q 0.1;",
        "A( ; L IW 0; L 768; >I; ) ; A I 0.0; = Q 0.0;",
        "SET; = Q 0.0; A I 0.0; JC next; A I 0.1; = Q 0.1; NETWORK next: A I 0.2; = Q 0.2;",
    ];
    for shape in SHAPES {
        // A jump ends its network.
        let shape = shape.replace("JC next;", "JC next; NETWORK");
        let body = shape.replace("; ", ";\n").replace("NETWORK ", "NETWORK\n");
        let source = format!("FUNCTION FC 1 : VOID\nBEGIN\nNETWORK\n{body}\nEND_FUNCTION\n");
        let (unit, messages) = parsed(&source, Some(Mnemonics::En));
        assert!(!has_errors(&messages), "{messages:#?}\n{source}");
        let types = Types::new(std::iter::once(&unit), &[]);
        for language in [Language::Lad, Language::Fbd] {
            let (drawn, messages) = to_graph::unit(&unit, &types, language);
            if language == Language::Lad && shape.contains("; X I 0.2") {
                // Contacts have no exclusive OR of branches.
                assert!(messages[0].title.contains("exclusive OR"), "{messages:#?}");
                continue;
            }
            assert!(!has_errors(&messages), "{shape}: {messages:#?}");
            let document = plcc_convert::sd::write(&drawn, Trivia::none(), None);
            assert!(!has_errors(&document.messages), "{shape}: {:#?}", document.messages);
            let results = [("a.stl", &source), ("a.s7dcl", &document.text)].map(|(name, text)| truth_table(name, text));
            assert_eq!(results[0], results[1], "{shape} in {language:?}:\n{}", document.text);
        }
    }
}

/// Q 0.0 to 0.7 after each of two cycles, for all values of I 0.0 to 0.4.
fn truth_table(name: &str, text: &str) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    let block = folder.path().join(name);
    let main = folder.path().join("main.stl");
    fs::write(&block, text).expect("a file");
    let mut calls = String::new();
    for inputs in 0..32 {
        for _ in 0..2 {
            calls.push_str(&format!("L {inputs};\nT IB 0;\nUC FC 1;\nL QB 0;\nL MD 20;\nXOD;\nRLD 3;\nT MD 20;\n"));
        }
        calls.push_str("//@ assert MD 20 == DW#16#FFFF_FFFF\n");
    }
    fs::write(
        &main,
        format!("//@ cpu 315-2DP\nORGANIZATION_BLOCK OB 1\nBEGIN\nNETWORK\n{calls}\nEND_ORGANIZATION_BLOCK\n"),
    )
    .expect("a file");
    let variant = Variant { form: Form::Jit, optimization: Level::O0.into() };
    let outcomes = testing::run(&[TestInput::Program(vec![main, block])], &plan(vec![variant]));
    // Every assertion fails, and shows the value that both must have.
    let shown: Vec<String> = outcomes
        .iter()
        .flat_map(|one| one.failures.lines())
        .filter(|line| line.trim_start().starts_with("left"))
        .map(str::to_string)
        .collect();
    assert!(shown.len() >= 32, "{} {}\n{text}", outcomes[0].messages, outcomes[0].failures);
    shown
}

/// Networks of LAD are FBD: the assertions still hold. How many blocks were redrawn.
fn run_redrawn(path: &Path, language: Language) -> Result<usize, String> {
    let text = plcc_syntax::decode_as(&fs::read(path).expect("a test file"), None);
    let (mut unit, messages) = plcc_readers::parse(FileId::default(), &text, &ReadOptions::default());
    if has_errors(&messages) {
        return Ok(0);
    }
    let mut redrawn = 0;
    for block in &mut unit.blocks {
        let Block::Code(code) = block else { continue };
        match to_graph::redraw::block(code, language) {
            Ok(made) => {
                redrawn += usize::from(made != *code);
                *code = made;
            }
            Err(messages) if language == Language::Fbd => return Err(format!("{messages:#?}")),
            Err(_) => {}
        }
    }
    if redrawn == 0 {
        return Ok(0);
    }
    let document = plcc_convert::sd::write(&unit, Trivia::new(&text, scl::comments(&text), false), Some(&text));
    if has_errors(&document.messages) {
        return Err(format!("{:#?}", document.messages));
    }
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.s7dcl");
    fs::write(&file, &document.text).expect("a file");
    let variant = Variant { form: Form::Jit, optimization: Level::O0.into() };
    let outcomes = testing::run(&[TestInput::File(file)], &plan(vec![variant]));
    match outcomes.iter().find(|one| one.failed > 0 || one.rejected || one.unreadable) {
        Some(one) => Err(format!("{}{}\n{}", one.messages, one.failures, document.text)),
        None => Ok(redrawn),
    }
}

#[test]
fn redrawn_networks_do_the_same() {
    let tests = tests_folder().join("run/lad-fbd");
    for language in [Language::Fbd] {
        let (mut count, mut failed) = (0, Vec::new());
        for path in files(&tests, "s7dcl") {
            match run_redrawn(&path, language) {
                Ok(blocks) => count += blocks,
                Err(text) => failed.push(format!("{}: {text}", path.display())),
            }
        }
        assert!(failed.is_empty(), "{} files in {language:?}:\n{}", failed.len(), failed.join("\n\n"));
        assert!(count > 20, "only {count} blocks in {language:?}");
    }
}
