//! Statements as networks, and networks of one language in another.

use std::fs;
use std::path::Path;

use plcc_convert::to_graph;
use plcc_convert::to_stl::{self, types::Types};
use plcc_convert::trivia::Trivia;
use plcc_diag::{Diagnostic, FileId};
use plcc_driver::cli::Level;
use plcc_driver::inputs::TestInput;
use plcc_driver::testing::{self, Form, Variant};
use plcc_readers::ReadOptions;
use plcc_syntax::ast::{Block, Code};
use plcc_syntax::network::ast::Language;
use plcc_syntax::stl::Mnemonics;
use plcc_syntax::{scl, stl};
use plcc_tests::{files, plan, tests_folder};

use crate::{has_errors, parsed};

/// Turns STL into networks where it can be drawn, and these into STL again: the assertions still hold. How many blocks were drawn.
fn run_through_networks(path: &Path, language: Language) -> Result<usize, String> {
    let text = plcc_syntax::decode_as(&fs::read(path).expect("a test file"), None);
    let (unit, messages) = parsed(&text, None);
    // Networks do not keep what is left in the registers of the CPU.
    if has_errors(&messages) || ["//@ test", "STW", "ACCU"].iter().any(|word| text.contains(word)) {
        return Ok(0);
    }
    // Parts of variables are of the TIA Portal.
    let types = Types::new(std::iter::once(&unit), &[]).for_portal(text.contains(".%"));
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
        if let Ok(network) = to_graph::block(code, &types, language, &mut Vec::new()) {
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
    const SHAPES: [&str; 32] = [
        "A I 0.0; A I 0.1; O; X I 0.2; = Q 0.0; A I 0.3; O; X( ; O I 0.1; A I 0.4; ) ; = Q 0.1;",
        "A I 0.0; A I 0.1; O; AN I 0.2; NOT; = Q 0.0; S Q 0.1; A I 0.3; = Q 0.2;",
        "A I 0.0; O; A I 0.1; NOT; O I 0.2; A I 0.3; = Q 0.0;",
        "A I 0.0; = L 20.0; A L 20.0; BLD 102; A I 0.1; = Q 0.0; A L 20.0; AN I 0.1; S Q 0.1; A L 20.0; O I 0.2; = Q 0.2;",
        "A I 0.0; A I 0.1; = Q 0.0;",
        "A I 0.0; AN I 0.1; O; AN I 0.2; A I 0.3; = Q 0.0;",
        "A( ; O I 0.0; O I 0.1; ) ; A I 0.2; = Q 0.0;",
        "A I 0.0; O I 0.1; A I 0.2; ON I 0.3; = Q 0.0; = Q 0.1;",
        "A I 0.0; = Q 0.0; = Q 0.1; NOT; = Q 0.2; S Q 0.3;",
        "A I 0.0; A( ; A I 0.1; O; A I 0.2; A I 0.3; ) ; AN I 0.4; S Q 0.0; A I 0.3; R Q 0.0;",
        "X I 0.0; X I 0.1; = Q 0.0;",
        "A I 0.0; O; A I 0.1; X I 0.2; = Q 0.0;",
        "X I 0.0; XN I 0.1; X I 0.2; X I 0.3; = Q 0.0;",
        "A I 0.0; X( ; AN I 0.1; A( ; O I 0.2; X I 0.3; ) ; ) ; = Q 0.0; A I 0.4; = Q 0.1;",
        "O I 0.0; O( ; A I 0.1; A( ; O I 0.2; O I 0.3; ) ; ) ; = Q 0.0;",
        "AN( ; A I 0.0; A I 0.1; ) ; A I 0.2; = Q 0.0;",
        "A I 0.0; R I 0.0; = Q 0.0; A I 0.0; = Q 0.1;",
        "A I 0.0; FP M 5.0; = Q 0.0; S Q 0.1; A I 0.1; R Q 0.1;",
        "A( ; L IW 0; L 768; >I; ) ; A I 0.0; = Q 0.0;",
        "A I 0.0; JNB _001; L 5; L MW 10; +I; T MW 10; AN OV; SAVE; CLR; _001: A BR; A I 0.1; = Q 0.0;",
        "A I 0.0; JNB _001; L IW 0; L 128; *I; T MW 10; AN OV; SAVE; CLR; _001: A BR; JNB _002; L MW 10; L 3; /I; T MW 12; _002: NOP 0;",
        "A I 0.0; JNB _001; L IW 0; L 128; *I; T MW 10; AN OV; SAVE; CLR; _001: A BR; JNB _002; L MW 10; T MW 12; SET; SAVE; CLR; _002: A BR; = Q 0.1;",
        "A( ; A I 0.0; A I 0.1; JNB _001; L IW 0; L W#16#F00; AW; T MW 10; SET; SAVE; CLR; _001: A BR; ) ; AN I 0.2; = Q 0.0; A( ; L MW 10; L 256; ==I; ) ; = Q 0.1;",
        "A I 0.0; AN I 0.1; JCN _001; L IW 0; T MW 10; _001: NOP 0; A( ; L MW 10; L 1000; >I; ) ; = Q 0.1;",
        "L IW 0; SLW 3; T MW 10; L IW 0; ITD; T MD 12; A( ; L MW 10; L 8; <I; ) ; = Q 0.1;",
        "A I 0.0; L S5T#1S; SD T 1; A I 0.1; R T 1; L T 1; T MW 10; NOP 0; A T 1; A I 0.2; = Q 0.0;",
        "A I 0.0; L S5T#1S; SF T 1; NOP 0; NOP 0; NOP 0; A T 1; = Q 0.0;",
        "A I 0.0; S M 6.0; A I 0.1; R M 6.0; A M 6.0; A I 0.2; = Q 0.0; A M 6.0; = Q 0.1;",
        "A I 0.0; A I 0.2; R M 6.0; A I 0.1; S M 6.0; NOP 0; A M 6.0; = Q 0.0;",
        "A I 0.0; S M 6.0; A I 0.1; A M 6.0; R M 6.0; A M 6.0; = Q 0.0;",
        "A I 0.0; CU C 1; A I 0.1; CD C 1; A I 0.2; L C#3; S C 1; A I 0.3; R C 1; L C 1; T MW 12; LC C 1; T MW 14; A C 1; = Q 0.0; A( ; L MW 12; L 4; >I; ) ; = Q 0.1;",
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
            assert!(!has_errors(&messages), "{shape}: {messages:#?}");
            let document = plcc_convert::sd::write(&drawn, Trivia::none(), None);
            assert!(!has_errors(&document.messages), "{shape}: {:#?}", document.messages);
            let results = [("a.stl", &source), ("a.s7dcl", &document.text)].map(|(name, text)| truth_table(name, text));
            assert_eq!(results[0], results[1], "{shape} in {language:?}:\n{}", document.text);
        }
    }
}

/// The messages about a statement list, which has no mistakes, that becomes LAD.
fn messages_in_lad(source: &str) -> Vec<Diagnostic> {
    let (unit, messages) = parsed(source, Some(Mnemonics::En));
    assert!(!has_errors(&messages), "{messages:#?}\n{source}");
    let types = Types::new(std::iter::once(&unit), &[]);
    to_graph::unit(&unit, &types, Language::Lad).1
}

/// SAVE does not end the string of logic, and NOT does not end the OR of branches: what follows is not what networks would show.
#[test]
fn logic_that_goes_on_is_refused() {
    const REFUSED: [(&str, &str); 6] = [
        ("A I 0.0; SAVE; A I 0.1; = Q 0.0;", "logic that goes on after `SAVE`"),
        ("A I 0.0; SAVE; NOT; O( ; A I 0.1; ) ; = Q 0.0;", "logic that goes on after `SAVE`"),
        ("A I 0.0; SAVE; NETWORK; L 1; T MW 2; A I 0.1; = Q 0.0;", "logic that goes on after `SAVE`"),
        ("A I 0.0; O; A I 0.1; NOT; A I 0.2; = Q 0.0;", "an AND after `NOT`"),
        ("A I 0.0; O; A I 0.1; NOT; AN( ; O I 0.2; ) ; = Q 0.0;", "an AND after `NOT`"),
        ("A I 0.0; O; NOT; O I 0.1; = Q 0.0;", "`NOT` after `O`"),
    ];
    const DRAWN: [&str; 4] = [
        "SET; SAVE; A I 0.1; = Q 0.0;",
        "A I 0.0; = Q 0.0; SAVE; A I 0.1; = Q 0.1;",
        "A I 0.0; SAVE; = Q 0.0; A I 0.1; = Q 0.1;",
        "A I 0.0; SAVE; NETWORK; SET; = Q 0.0;",
    ];
    let messages_of = |body: &str| {
        let body = body.replace("NETWORK; ", "NETWORK\n").replace("; ", ";\n");
        messages_in_lad(&format!("FUNCTION FC 1 : VOID\nBEGIN\nNETWORK\n{body}\nEND_FUNCTION\n"))
    };
    for (body, reason) in REFUSED {
        let messages = messages_of(body);
        assert!(messages.iter().any(|one| one.is_error() && one.title.contains(reason)), "{body}: {messages:#?}");
    }
    for body in DRAWN {
        let messages = messages_of(body);
        assert!(!has_errors(&messages), "{body}: {messages:#?}");
    }
}

/// A byte of the local data, and a bit of a variable: networks have no form for these.
#[test]
fn addresses_in_the_local_data_are_refused() {
    for body in ["L LB 20; T MB 4;", "A L 0.3; = Q 0.0;"] {
        let head = "FUNCTION FC 1 : VOID\nVAR_TEMP\n  a : INT;\nEND_VAR\nBEGIN\nNETWORK";
        let source = format!("{head}\n{}\nEND_FUNCTION\n", body.replace("; ", ";\n"));
        let (unit, messages) = parsed(&source, Some(Mnemonics::En));
        assert!(!has_errors(&messages), "{messages:#?}\n{source}");
        let types = Types::new(std::iter::once(&unit), &[]);
        let (_, messages) = to_graph::unit(&unit, &types, Language::Lad);
        assert!(messages.iter().any(|one| one.is_error() && one.title.contains("local data")), "{messages:#?}");
    }
}

/// A BOOL of the block is not a timer, and one of an FB is not a bit in M.
#[test]
fn variables_of_a_block_feed_boxes() {
    let body = "A #go; L S5T#1S; SD T 1; A #stop; R T 1; L T 1; T MW 10; NOP 0; A T 1; = Q 0.0;
        A #go; S M 6.0; A #stop; R M 6.0; A M 6.0; = Q 0.1; A I 0.0; S #on; A I 0.1; R #on; A #on; = Q 0.2;";
    let head = "FUNCTION_BLOCK FB 1\nVAR_INPUT\n  go : BOOL;\n  stop : BOOL;\nEND_VAR\nVAR\n  on : BOOL;\nEND_VAR\nBEGIN\nNETWORK";
    let source = format!("{head}\n{}\nEND_FUNCTION_BLOCK\n", body.replace("; ", ";\n"));
    let (unit, messages) = parsed(&source, Some(Mnemonics::En));
    assert!(!has_errors(&messages), "{messages:#?}\n{source}");
    let types = Types::new(std::iter::once(&unit), &[]);
    let (drawn, messages) = to_graph::unit(&unit, &types, Language::Lad);
    assert!(!has_errors(&messages), "{messages:#?}");
    let text = plcc_convert::sd::write(&drawn, Trivia::none(), None).text;
    assert!(text.contains("S_ODT(") && text.matches("S_SR(").count() == 2, "{text}");
}

/// `L` does not extend or convert a constant as elements of networks do: no network is drawn where the bits would be others.
#[test]
fn constants_that_networks_would_change_are_refused() {
    const REFUSED: [(&str, &str); 5] = [
        ("L -5;\nT MD 20;", "a transfer of a constant to an operand of another type"),
        ("L -5;\nT MB 20;", "a transfer of a constant to an operand of another type"),
        ("L 5;\nT #speed;", "a transfer of a constant to an operand of another type"),
        ("A(;\nL MD 0;\nL -5;\n==D;\n);\n= Q 0.0;", "a comparison as DInt with a constant"),
        ("A(;\nL #speed;\nL 5;\n==R;\n);\n= Q 0.0;", "a comparison as Real with a constant"),
    ];
    const DRAWN: [&str; 5] = [
        "L -5;\nT MW 20;",
        "L 5;\nT MD 20;",
        "L L#-5;\nT MD 20;",
        "A(;\nL MD 0;\nL L#-5;\n==D;\n);\n= Q 0.0;",
        "A(;\nL #speed;\nL 5.0;\n==R;\n);\n= Q 0.0;",
    ];
    let messages_of = |body: &str| {
        let head = "FUNCTION FC 1 : VOID\nVAR_TEMP\nspeed : REAL;\nEND_VAR\nBEGIN\nNETWORK";
        messages_in_lad(&format!("{head}\n{body}\nEND_FUNCTION\n"))
    };
    for (body, reason) in REFUSED {
        let messages = messages_of(body);
        assert!(messages.iter().any(|message| message.title.contains(reason)), "{body}: {messages:#?}");
    }
    for body in DRAWN {
        let messages = messages_of(body);
        assert!(!has_errors(&messages), "{body}: {messages:#?}");
    }
}

/// What statements do with bits that a box does not do: no network is drawn of them.
#[test]
fn constants_that_networks_would_extend_are_refused() {
    const REFUSED: [(&str, &str); 10] = [
        ("L DIW 0; T MW 20;", "the open instance data block"),
        ("A I 0.0; S DIX 2.0;", "the open instance data block"),
        ("L -5; T MD 20;", "a constant to an operand of another type"),
        ("L 300; T MB 20;", "a constant to an operand of another type"),
        ("L L#70000; T MW 20;", "a constant to an operand of another type"),
        ("A( ; L MD 0; L -5; ==D; ) ; = Q 0.0;", "a comparison as DInt"),
        ("A( ; L MD 0; L 5; ==R; ) ; = Q 0.0;", "a comparison as Real"),
        ("L MW 0; L -5; +D; T MD 4;", "a box of DINT"),
        ("A I 0.0; JNB _001; L MW 0; L 1; +I; T MW 0; SET; SAVE; CLR; _001: A BR; = Q 0.0;", "whose ENO is not"),
        ("L MW 4; L MW 0; SLW; T MW 6;", "a shift by a variable"),
    ];
    for (body, reason) in REFUSED {
        let body = body.replace("; ", ";\n");
        let source = format!("FUNCTION FC 1 : VOID\nBEGIN\nNETWORK\n{body}\nEND_FUNCTION\n");
        let messages = messages_in_lad(&source);
        assert!(messages.iter().any(|one| one.is_error() && one.title.contains(reason)), "{source}: {messages:#?}");
    }
}

/// A block that is called by its symbol has its parameters.
#[test]
fn calls_by_symbol_are_drawn() {
    let source = "FUNCTION \"Fa\" : VOID\nVAR_INPUT\n  x : INT;\nEND_VAR\nBEGIN\nNETWORK\n      NOP 0\nEND_FUNCTION\n\
        FUNCTION FC 2 : VOID\nBEGIN\nNETWORK\n      CALL \"Fa\" (\n           x := MW 10);\nEND_FUNCTION\n";
    let (unit, messages) = parsed(source, None);
    assert!(!has_errors(&messages), "{messages:#?}");
    let types = Types::new(std::iter::once(&unit), &[]);
    let (_, messages) = to_graph::unit(&unit, &types, Language::Lad);
    assert!(!has_errors(&messages), "{messages:#?}");
}

/// Networks of LAD and FBD become statements, and these the same networks again, with all that STEP 7 makes of several statements.
#[test]
fn boxes_come_back_from_statements() {
    let tests = tests_folder().join("run/lad-fbd");
    let (mut boxes, mut drawn, mut failed) = (0, 0, Vec::new());
    for path in files(&tests, "s7dcl") {
        let text = plcc_syntax::decode_as(&fs::read(&path).expect("a test file"), None);
        let (unit, messages) = plcc_readers::parse(FileId::default(), &text, &ReadOptions::default());
        let is_classic = text.contains("S7-300") || text.contains("315");
        if has_errors(&messages) || !is_classic {
            continue;
        }
        let types = Types::new(std::iter::once(&unit), &[]);
        let mut again = unit.clone();
        let mut count = 0;
        for block in &mut again.blocks {
            let Block::Code(code) = block else { continue };
            let Code::Graphic(body) = &code.code else { continue };
            let Ok(listed) = to_stl::block(code, body, &types, true) else { continue };
            let listed_unit =
                plcc_syntax::ast::SourceUnit { blocks: vec![Block::Code(listed.clone())], ..unit.clone() };
            let types = Types::new([&unit, &listed_unit].into_iter(), &[]);
            boxes += 1;
            if let Ok(network) = to_graph::block(&listed, &types, Language::Lad, &mut Vec::new()) {
                *code = network;
                count += 1;
            }
        }
        if count == 0 {
            continue;
        }
        drawn += count;
        let document = plcc_convert::sd::write(&again, Trivia::new(&text, scl::comments(&text), false), Some(&text));
        assert!(!has_errors(&document.messages), "{}: {:#?}", path.display(), document.messages);
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("a.s7dcl");
        fs::write(&file, &document.text).expect("a file");
        let variant = Variant { form: Form::Jit, optimization: Level::O0.into() };
        let outcomes = testing::run(&[TestInput::File(file)], &plan(vec![variant]));
        if let Some(one) = outcomes.iter().find(|one| one.failed > 0 || one.rejected || one.unreadable) {
            failed.push(format!("{}: {}{}\n{}", path.display(), one.messages, one.failures, document.text));
        }
    }
    println!("{drawn} of {boxes} blocks");
    assert!(failed.is_empty(), "{} files:\n{}", failed.len(), failed.join("\n\n"));
    assert!(drawn > 5, "only {drawn} of {boxes} blocks");
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
        calls.push_str("//@ assert MD 20 == DW#16#5A5A_A5A5\n");
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

/// Networks of LAD are FBD, or the other way round: the assertions still hold. How many blocks were redrawn.
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
    let document = plcc_convert::sd::rewrite(&unit, Trivia::new(&text, scl::comments(&text), false), &text, true);
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
    for (language, least) in [(Language::Fbd, 20), (Language::Lad, 5)] {
        let (mut count, mut failed) = (0, Vec::new());
        for path in files(&tests, "s7dcl") {
            match run_redrawn(&path, language) {
                Ok(blocks) => count += blocks,
                Err(text) => failed.push(format!("{}: {text}", path.display())),
            }
        }
        println!("{count} blocks in {language:?}");
        assert!(failed.is_empty(), "{} files in {language:?}:\n{}", failed.len(), failed.join("\n\n"));
        assert!(count > least, "only {count} blocks in {language:?}");
    }
}
