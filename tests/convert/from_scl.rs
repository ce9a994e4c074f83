//! Statements of SCL and charts of GRAPH as statement lists: the assertions of their tests hold for them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use plcc_convert::from_scl;
use plcc_convert::trivia::Trivia;
use plcc_driver::cli::Level;
use plcc_driver::inputs::{self, TestInput};
use plcc_driver::pipeline::{self, Settings};
use plcc_driver::testing::{self, Form, Outcome, Variant};
use plcc_syntax::ast::{Block, Code, SourceUnit};
use plcc_syntax::scl;
use plcc_syntax::stl::Mnemonics;
use plcc_tests::{files, plan, tests_folder};

use crate::{has_errors, without};

/// What became of the blocks of a source.
#[derive(Default)]
struct Made {
    blocks: usize,
    /// Why others stayed in their language.
    refused: Vec<String>,
}

/// Runs a program: assertions that passed, or what failed.
fn run(files: Vec<PathBuf>) -> Result<u64, String> {
    let variant = Variant { form: Form::Jit, optimization: Level::O0.into() };
    let outcomes = testing::run(&[TestInput::Program(files)], &plan(vec![variant]));
    let is_bad = |one: &&Outcome| one.failed > 0 || one.rejected || one.unreadable;
    match outcomes.iter().find(is_bad) {
        Some(one) => Err(format!("{}{}", one.messages, one.failures)),
        None => Ok(outcomes.iter().map(|one| one.passed).sum()),
    }
}

/// Runs a source with its blocks as STL where that is possible.
fn run_as_stl(path: &Path, cpu: &str) -> Option<Result<Made, String>> {
    let text = plcc_syntax::decode_as(&fs::read(path).expect("a test file"), None);
    // Indices outside of their bounds are not a fault in STL.
    const ABOUT_BOUNDS: [&str; 5] = [
        "array_limits_tia.scl",
        "index_outside.scl",
        "indexed_classic.scl",
        "references_classic.scl",
        "slice_outside.scl",
    ];
    let is_about_bounds = ABOUT_BOUNDS.iter().any(|name| path.ends_with(name));
    if text.contains("expect=fail") || is_about_bounds {
        return None;
    }
    let own = text.lines().any(|line| line.starts_with("//@ cpu"));
    let head = if own { String::new() } else { format!("//@ cpu {cpu}\n") };
    let text = format!("{head}{text}");
    let folder = tempfile::tempdir().expect("a folder");
    let is_graph = path.extension().is_some_and(|extension| extension == "gr7");
    let extension = if is_graph { "gr7" } else { "scl" };
    let source = folder.path().join("a").with_extension(extension);
    fs::write(&source, &text).expect("a file");
    let Ok(before) = run(vec![source.clone()]) else { return None };
    let cpu = text.lines().find_map(|line| line.strip_prefix("//@ cpu ")).unwrap_or(cpu).trim().to_string();
    let settings = Settings { cpu: Some(cpu.clone()), plain_charts: true, ..Settings::default() };
    let parsed = pipeline::parse(inputs::read(std::slice::from_ref(&source)), &settings);
    let unit = parsed.units.first()?.1.clone();
    let bound = pipeline::bind(parsed, &settings);
    if bound.has_errors() {
        return None;
    }
    let all = if is_graph { plcc_readers::gr7::comments(&text) } else { scl::comments(&text) };
    let meaning = (text.as_str(), all.as_slice());
    let (made, messages) = from_scl::unit(&unit, &bound.program, meaning, plcc_program::with_chart_data);
    let is_scl =
        |block: &Block| matches!(block, Block::Code(code) if matches!(code.code, Code::Scl(_) | Code::Chart(_)));
    let pairs = unit.blocks.iter().zip(made.blocks);
    let converted: Vec<(&Block, Block)> = pairs.filter(|(own, made)| is_scl(own) && !is_scl(made)).collect();
    let refused = messages.iter().filter(|message| message.is_error()).map(|message| message.title.clone()).collect();
    let spans: Vec<_> = converted.iter().map(|(own, _)| own.span().range()).collect();
    let blocks = spans.len();
    if blocks == 0 {
        return Some(Ok(Made { blocks, refused }));
    }
    let mut kept = all;
    kept.retain(|comment| spans.iter().any(|span| span.contains(&comment.range().start)));
    let only = SourceUnit { blocks: converted.into_iter().map(|(_, made)| made).collect(), ..unit.clone() };
    let (written, messages) = plcc_convert::stl::write(&only, Mnemonics::En, Trivia::new(&text, kept, true), None);
    if has_errors(&messages) {
        // Declarations that STL does not have.
        let titles = messages.into_iter().filter(|message| message.is_error()).map(|message| message.title);
        return Some(Ok(Made { blocks: 0, refused: titles.collect() }));
    }
    // Only blocks in STL may be left.
    let is_stl = |block: &Block| matches!(block, Block::Code(code) if matches!(code.code, Code::Stl(_)));
    let is_converted = unit.blocks.iter().filter(|block| is_scl(block)).count() == spans.len();
    let extension = if is_converted && unit.blocks.iter().any(is_stl) { "stl" } else { extension };
    let (rest, list) = (folder.path().join("rest").with_extension(extension), folder.path().join("list.stl"));
    fs::write(&rest, without(&text, &spans)).expect("a file");
    fs::write(&list, format!("//@ cpu {cpu}\n{written}")).expect("a file");
    if std::env::var_os("PLCC_SHOW").is_some() {
        println!("{}: {blocks}; {refused:?}\n{written}", path.display());
    }
    Some(match run(vec![rest, list]) {
        Err(failures) => Err(format!("{failures}\n{written}")),
        Ok(after) if after != before => Err(format!("{before} assertions before, {after} after\n{written}")),
        Ok(_) => Ok(Made { blocks, refused }),
    })
}

/// All sources; those with `PLCC_ONLY` in their path if it is set.
#[test]
fn statements_of_scl_as_lists_do_the_same() {
    let (mut blocks, mut failed, mut refused) = (0, Vec::new(), BTreeMap::<String, usize>::new());
    let only = std::env::var("PLCC_ONLY").unwrap_or_default();
    for path in files(&tests_folder().join("run/scl"), "scl") {
        if !path.to_string_lossy().contains(&only) || path.ancestors().any(|folder| folder.join("plc.toml").exists()) {
            continue;
        }
        for cpu in ["s7-300", "s7-1500"] {
            match run_as_stl(&path, cpu) {
                None => {}
                Some(Ok(made)) => {
                    blocks += made.blocks;
                    made.refused.into_iter().for_each(|title| *refused.entry(title).or_default() += 1);
                }
                Some(Err(text)) => failed.push(format!("{} on {cpu}: {text}", path.display())),
            }
        }
    }
    println!("{blocks} blocks; refused: {refused:#?}");
    assert!(failed.is_empty(), "{} files:\n{}", failed.len(), failed.join("\n\n"));
    assert!(blocks > 300 || !only.is_empty(), "only {blocks} blocks");
}

/// Sources of which every block becomes STL.
#[test]
fn whole_sources_become_lists() {
    const SOURCES: [&str; 17] = [
        "language/case_of_small_and_unsigned_tia",
        "language/characters_of_texts_tia",
        "language/choices_as_lists",
        "language/copied_elements",
        "language/dtl_constants_tia",
        "language/eno_of_functions_as_lists_tia",
        "language/instructions_as_lists_tia",
        "language/output_to_a_peripheral_tia",
        "language/parts_in_memory_tia",
        "language/parts_of_variables_tia",
        "language/small_and_unsigned_tia",
        "language/text_assignments_tia",
        "language/text_functions_tia",
        "library/instances_as_lists_tia",
        "library/instances_in_data_tia",
        "library/moments_in_lists_tia",
        "library/numbers_as_texts_in_lists_tia",
    ];
    const FOR_S7_300: [&str; 6] = [
        "language/block_parameters_as_numbers_classic",
        "language/choices_as_lists",
        "language/choices_of_reals_classic",
        "language/constant_texts_classic",
        "language/copied_elements",
        "language/parts_in_memory_tia",
    ];
    let all = SOURCES.map(|name| (name, "s7-1500")).into_iter().chain(FOR_S7_300.map(|name| (name, "s7-300")));
    for (name, cpu) in all {
        let path = tests_folder().join(format!("run/scl/{name}.scl"));
        let made = run_as_stl(&path, cpu).expect("a source that runs").unwrap_or_else(|text| panic!("{name}: {text}"));
        assert!(made.blocks > 0 && made.refused.is_empty(), "{name}: {:?}", made.refused);
    }
}

/// Charts that become statements as a whole.
const CHARTS: [&str; 18] = [
    "delayed_limited",
    "first_call",
    "init_and_off",
    "interlock_c_mark",
    "join_ends_actions",
    "mode_manual",
    "mode_tap",
    "mode_top",
    "no_glitch",
    "numbers_of_addresses",
    "on_off",
    "plain_times",
    "self_loop",
    "sequence_end",
    "simultaneous_join",
    "skip_branches",
    "supervision_with_acknowledgement",
    "temporary_variable",
];

#[test]
fn charts_as_lists_do_the_same() {
    let (mut blocks, mut failed, mut refused) = (0, Vec::new(), BTreeMap::<String, usize>::new());
    let only = std::env::var("PLCC_ONLY").unwrap_or_default();
    for path in files(&tests_folder().join("run/graph"), "gr7") {
        if !path.to_string_lossy().contains(&only) || path.ancestors().any(|folder| folder.join("plc.toml").exists()) {
            continue;
        }
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let made = run_as_stl(&path, "s7-300").unwrap_or_else(|| Ok(Made::default()));
        let has_to = CHARTS.contains(&name.as_str());
        match made {
            Ok(made) if has_to && (made.blocks == 0 || !made.refused.is_empty()) => {
                failed.push(format!("{name}: {} blocks; {:?}", made.blocks, made.refused));
            }
            Ok(made) => {
                blocks += made.blocks;
                made.refused.into_iter().for_each(|title| *refused.entry(title).or_default() += 1);
            }
            Err(text) => failed.push(format!("{name}: {text}")),
        }
    }
    println!("{blocks} blocks; refused: {refused:#?}");
    assert!(failed.is_empty(), "{} files:\n{}", failed.len(), failed.join("\n\n"));
    assert!(blocks > 30 || !only.is_empty(), "only {blocks} blocks");
}

/// The messages, as titles and what the source has there, and the text.
fn converted(text: &str) -> (Vec<(String, String)>, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let source = folder.path().join("a.scl");
    fs::write(&source, text).expect("a file");
    let settings = Settings { cpu: Some("s7-300".to_string()), ..Settings::default() };
    let parsed = pipeline::parse(inputs::read(&[source]), &settings);
    let unit = parsed.units[0].1.clone();
    let bound = pipeline::bind(parsed, &settings);
    assert!(!bound.has_errors(), "{:#?}", bound.diagnostics);
    let comments = scl::comments(text);
    let meaning = (text, comments.as_slice());
    let (made, messages) = from_scl::unit(&unit, &bound.program, meaning, plcc_program::with_chart_data);
    let found = messages
        .iter()
        .map(|message| (message.title.clone(), text.get(message.primary.span.range()).unwrap_or_default().to_string()));
    let trivia = Trivia::new(text, comments, true);
    (found.collect(), plcc_convert::stl::write(&made, Mnemonics::En, trivia, None).0)
}

#[test]
fn a_refusal_names_the_operation() {
    let source = "FUNCTION FC 1 : REAL\nVAR_INPUT\n x : REAL;\nEND_VAR\nBEGIN\n FC1 := 1.0 + x ** 2.5;\nEND_FUNCTION\n";
    let (messages, _) = converted(source);
    let expected = ("STL has no form for this operation with REAL".to_string(), "x ** 2.5".to_string());
    assert_eq!(messages, [expected]);
}

/// In SCL the text is cut; STL of a function block passes only one of the same length.
#[test]
fn a_text_of_another_length_is_refused() {
    let source = "FUNCTION_BLOCK FB 1\nVAR_INPUT\n a : STRING[6];\nEND_VAR\nBEGIN\n;\nEND_FUNCTION_BLOCK\nDATA_BLOCK DB 1 FB 1\nBEGIN\n\
                  END_DATA_BLOCK\nDATA_BLOCK DB 2\nSTRUCT\n s : STRING[20];\nEND_STRUCT\nBEGIN\nEND_DATA_BLOCK\n\
                  FUNCTION FC 1 : VOID\nBEGIN\n FB1.DB1(a := DB2.s);\nEND_FUNCTION\n";
    let (messages, _) = converted(source);
    let expected = ("STL has no form for a text of another length than its parameter".to_string(), "DB2.s".to_string());
    assert_eq!(messages, [expected]);
}

/// SCL copies the array before it calls the function, STL after it.
#[test]
fn an_array_that_a_later_argument_may_change_is_refused() {
    let source = "FUNCTION_BLOCK FB 1\nVAR_INPUT\n a : ARRAY[0..1] OF INT;\n n : INT;\nEND_VAR\nBEGIN\n;\nEND_FUNCTION_BLOCK\n\
                  DATA_BLOCK DB 1 FB 1\nBEGIN\nEND_DATA_BLOCK\n\
                  DATA_BLOCK DB 2\nSTRUCT\n a : ARRAY[0..1] OF INT;\nEND_STRUCT\nBEGIN\nEND_DATA_BLOCK\n\
                  FUNCTION FC 2 : INT\nBEGIN\n DB2.a[0] := 1;\n FC2 := 2;\nEND_FUNCTION\n\
                  FUNCTION FC 1 : VOID\nBEGIN\n FB1.DB1(a := DB2.a, n := FC2());\nEND_FUNCTION\n";
    let (messages, _) = converted(source);
    let title =
        "STL has no form for an array, structure or text before an argument that calls a function which changes data";
    assert_eq!(messages, [(title.to_string(), "DB2.a".to_string())]);
    let (messages, _) = converted(&source.replace(" DB2.a[0] := 1;\n", ""));
    assert_eq!(messages, []);
}

/// SCL passes the element itself, STL a copy, which does not show what the function does to the array.
#[test]
fn an_element_of_an_array_that_the_function_uses_is_refused() {
    let source = |of_function: &str| {
        format!(
            "DATA_BLOCK DB 2\nSTRUCT\n i : INT;\n b : ARRAY[0..1] OF INT;\n a : ARRAY[0..1] OF INT;\n c : INT;\nEND_STRUCT\nBEGIN\n\
             END_DATA_BLOCK\nFUNCTION FC 3 : VOID\nBEGIN\n DB2.{of_function} := 1;\nEND_FUNCTION\n\
             FUNCTION FC 2 : VOID\nVAR_IN_OUT\n io : INT;\nEND_VAR\nBEGIN\n io := 5;\n FC3();\n io := io + 1;\nEND_FUNCTION\n\
             FUNCTION FC 1 : VOID\nBEGIN\n FC2(io := DB2.a[DB2.i]);\nEND_FUNCTION\n"
        )
    };
    let title = "STL has no form for an element of an array that the function uses by its name, too";
    for of_function in ["a[1]", "a[DB2.i]"] {
        let (messages, _) = converted(&source(of_function));
        let told = messages.iter().find(|(told, _)| told == title);
        assert!(told.is_some_and(|(_, place)| place.ends_with("DB2.a[DB2.i]")), "{of_function}: {messages:?}");
    }
    for of_function in ["b[1]", "b[DB2.i]", "c"] {
        let (messages, _) = converted(&source(of_function));
        assert!(messages.iter().all(|(told, _)| told != title), "{of_function}: {messages:?}");
    }
}

#[test]
fn comments_stay_in_their_branch() {
    let source = "FUNCTION FC 1 : INT\nVAR_INPUT\n x : INT;\nEND_VAR\nBEGIN\n// limits\nIF x > 5 THEN\n // high\n FC1 := 1;\n\
                  ELSE\n // low\n FC1 := 2;\nEND_IF;\nEND_FUNCTION\n";
    let (messages, text) = converted(source);
    assert_eq!(messages, []);
    let lines = [
        "TITLE = IF x > 5\n",
        "// limits",
        "JCN   _002",
        "// high",
        "JU    _001",
        "_002: NOP   0",
        "// low",
        "L     2",
        "_001: NOP   0",
    ];
    are_in_order(&text, &lines);
}

#[test]
fn comments_stay_in_an_else_without_statements() {
    let source = "FUNCTION FC 1 : INT\nVAR_INPUT\n x : INT;\nEND_VAR\nBEGIN\nIF x > 5 THEN\n // high\n FC1 := 1;\n\
                  ELSE\n // low\n ;\nEND_IF;\nEND_FUNCTION\n";
    let (messages, text) = converted(source);
    assert_eq!(messages, []);
    let lines = ["JCN   _002", "// high", "L     1", "JU    _001", "_002: NOP   0", "// low", "_001: NOP   0"];
    are_in_order(&text, &lines);
}

/// No name has the width of the access.
#[test]
fn views_of_other_variables_are_reached_through_ar1() {
    let source = "FUNCTION_BLOCK FB 1\nVAR\n s : STRUCT\n p : BOOL;\n n : INT;\n END_STRUCT;\n sb AT s : BYTE;\n w : WORD;\n \
                  b AT w : ARRAY[0..15] OF BOOL;\nEND_VAR\nBEGIN\nsb := B#16#3;\nb[9] := TRUE;\nEND_FUNCTION_BLOCK\n";
    let (messages, text) = converted(source);
    assert_eq!(messages, []);
    let byte = ["L     P##s;", "TAR2;", "+D;", "LAR1;", "L     B#16#03;", "T     B [AR1,P#0.0];"];
    // In a word, bit 9 of the array is the second one of its second byte.
    let bit = ["L     P##w;", "+     L#9;", "TAR2;", "LAR1;", "SET", "=     [AR1,P#0.0];"];
    are_in_order(&text, &[byte, bit].concat());
}

/// Only EXIT and CONTINUE need some of the labels of loops.
#[test]
fn labels_of_loops_are_those_that_are_used() {
    let body = |inner: &str| {
        format!(
            "FUNCTION FC 1 : INT\nVAR_TEMP\n i : INT;\n n : INT;\nEND_VAR\nBEGIN\nn := 0;\nFOR i := 1 TO 5 DO\n \
             IF n > 9 THEN {inner} END_IF;\n n := n + i;\nEND_FOR;\nREPEAT\n IF n > 9 THEN {inner} END_IF;\n \
             n := n + 1;\nUNTIL n > 20 END_REPEAT;\nFC1 := n;\nEND_FUNCTION\n"
        )
    };
    for inner in [";", "EXIT;", "CONTINUE;"] {
        let (messages, text) = converted(&body(inner));
        assert_eq!(messages, []);
        let labels: Vec<&str> = text.lines().filter_map(|line| Some(line.split_once(": ")?.0)).collect();
        for label in labels.iter().filter(|label| label.starts_with('_')) {
            assert!(text.matches(label).count() > 1, "{label} with {inner}:\n{text}");
        }
    }
}

/// STEP 7 V5 has no longer ones.
#[test]
fn labels_have_four_characters() {
    let statements: String = (0..1100).map(|at| format!("IF x > {at} THEN FC1 := {at}; END_IF;\n")).collect();
    let source = format!("FUNCTION FC 1 : INT\nVAR_INPUT\n x : INT;\nEND_VAR\nBEGIN\n{statements}END_FUNCTION\n");
    let (messages, text) = converted(&source);
    assert_eq!(messages, []);
    let labels: Vec<&str> = text.lines().filter_map(|line| Some(line.split_once(": NOP")?.0)).collect();
    let known: BTreeSet<&str> = labels.iter().copied().collect();
    assert_eq!(known.len(), labels.len());
    assert!(known.len() >= 1100 && known.contains("_A00"), "{}", known.len());
    assert!(labels.iter().all(|label| label.trim().len() == 4), "{labels:?}");
}

fn are_in_order(text: &str, lines: &[&str]) {
    let mut rest = text;
    for line in lines {
        let at = rest.find(line);
        assert!(at.is_some(), "`{line}` is not where it belongs:\n{text}");
        rest = &rest[at.unwrap_or_default()..];
    }
}
