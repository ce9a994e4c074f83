//! SimaticML that is written.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use plcc_convert::trivia::Trivia;
use plcc_diag::{Diagnostic, FileId};
use plcc_driver::cli::Level;
use plcc_driver::inputs::TestInput;
use plcc_driver::testing::{self, Form, Variant};
use plcc_readers::ReadOptions;
use plcc_syntax::ast::{Block, Code, SourceUnit};
use plcc_syntax::{scl, stl};
use plcc_tests::{is_chosen, plan, root, tests_folder};

use crate::{everything, has_errors, sources, tree};

/// Exports of the TIA Portal: what is written has the same tree.
#[test]
fn exports_read_back_as_they_were() {
    let (mut count, mut failed) = (0, Vec::new());
    let folders = [tests_folder().join("twins"), tests_folder().join("run"), root().join("samples")];
    let all = folders.iter().flat_map(|folder| everything(folder));
    for path in all.filter(|path| path.extension().is_some_and(|ending| ending == "xml")) {
        let text = plcc_syntax::decode_as(&fs::read(&path).expect("a test file"), None);
        let (unit, messages) = plcc_readers::parse(FileId::default(), &text, &ReadOptions::default());
        let is_tia = plcc_readers::xml::kind(&text).is_some_and(|kind| kind != plcc_readers::xml::XmlKind::PlcOpen);
        // Its values have no types without the function block.
        let is_without_block = path.ends_with("partial/instance_of_missing_block.xml");
        if has_errors(&messages) || unit.blocks.is_empty() || !is_tia || is_without_block {
            continue;
        }
        let project = path.ancestors().skip(1).find(|folder| folder.join("plc.toml").exists());
        let others: Vec<SourceUnit> = project.map_or_else(Vec::new, |project| {
            let all = everything(project).into_iter().filter(|file| file.extension() == path.extension());
            let read = |file: PathBuf| {
                let text = plcc_syntax::decode_as(&fs::read(file).expect("a file"), None);
                plcc_readers::parse(FileId::default(), &text, &ReadOptions::default()).0
            };
            all.map(read).collect()
        });
        let library = plcc_convert::xml::Library::new(std::iter::once(&unit).chain(&others));
        let (written, messages) = plcc_convert::xml::write(&unit, &library, Trivia::none(), unit.overlay.as_deref());
        if has_errors(&messages) {
            failed.push(format!("{}: {messages:#?}", path.display()));
            continue;
        }
        let (again, messages) = plcc_readers::parse(FileId::default(), &written, &ReadOptions::default());
        if let Some(first) = messages.iter().find(|message| message.is_error()) {
            failed.push(format!("{}: {first:?}\n{written}", path.display()));
            continue;
        }
        let (before, after) = (tree(&unit), tree(&again));
        if before != after {
            failed.push(format!("{}: {}", path.display(), plcc_tests::difference(&before, &after)));
        }
        count += 1;
    }
    assert!(failed.is_empty(), "{} of {}:\n{}", failed.len(), count + failed.len(), failed.join("\n\n"));
    assert!(count > 70, "only {count} exports");
}

/// A source as XML: `None` if it has errors of its own, or what SimaticML cannot say; otherwise what is different in its IR.
fn as_xml(path: &Path, refused: &mut BTreeMap<String, usize>) -> Option<Result<(), String>> {
    let settings = plcc_driver::pipeline::Settings::default();
    let bound = plcc_tests::bind_file(path, &settings).ok()?;
    let before = plcc_tests::twins::ir_text(&bound);
    let text = plcc_syntax::decode_as(&fs::read(path).expect("a test file"), None);
    let language = plcc_driver::pipeline::language_of(&path.to_string_lossy());
    let options = ReadOptions { language, ..Default::default() };
    let (unit, _) = plcc_readers::parse(FileId::default(), &text, &options);
    let library = plcc_convert::xml::Library::new(std::iter::once(&unit));
    let is_stl =
        unit.blocks.iter().any(|block| matches!(block, Block::Code(code) if matches!(code.code, Code::Stl(_))));
    let all = if is_stl { stl::comments(&text) } else { scl::comments(&text) };
    let trivia = Trivia::new(&text, all, false);
    let (written, messages) = plcc_convert::xml::write(&unit, &library, trivia, (!is_stl).then_some(text.as_str()));
    if let Some(first) = messages.iter().find(|message| message.is_error()) {
        *refused.entry(first.title.clone()).or_default() += 1;
        return None;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.xml");
    // A source of STL is one of the S7-300 if it names no CPU.
    let is_own = is_stl && !text.lines().any(|line| line.starts_with("//@ cpu"));
    let own = is_own.then(|| format!("cpu {}", bound.program.profile.name));
    fs::write(&file, plcc_convert::with_pragmas(&written, &Vec::from_iter(own))).expect("a file");
    let scenario = path.with_extension("scenario.toml");
    if scenario.is_file() {
        fs::copy(&scenario, file.with_extension("scenario.toml")).expect("a copy");
    }
    let after = match plcc_tests::bind_file(&file, &settings) {
        Ok(bound) => plcc_tests::twins::ir_text(&bound),
        Err(messages) => return Some(Err(messages)),
    };
    if before == after {
        return Some(Ok(()));
    }
    // Blocks without numbers may get others, and other addresses: then the assertions decide.
    let variant = Variant { form: Form::Jit, optimization: Level::O0.into() };
    let outcomes = testing::run(&[TestInput::File(file)], &plan(vec![variant]));
    match outcomes.iter().find(|one| one.failed > 0 || one.rejected || one.unreadable || one.passed == 0) {
        Some(one) => Some(Err(format!("{}{}{}", plcc_tests::difference(&before, &after), one.messages, one.failures))),
        None => Some(Ok(())),
    }
}

/// Fails unless a source does the same by way of XML.
fn stays_the_same(name: &str, source: &str) {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join(name);
    fs::write(&file, source).expect("a file");
    let mut refused = BTreeMap::new();
    let outcome = as_xml(&file, &mut refused);
    assert!(matches!(outcome, Some(Ok(()))), "{outcome:?} {refused:?}");
}

/// The tree of a text without errors.
fn read(text: &str) -> SourceUnit {
    let (unit, messages) = plcc_readers::parse(FileId::default(), text, &ReadOptions::default());
    assert!(!has_errors(&messages), "{messages:#?} in\n{text}");
    unit
}

/// A source in SCL as a document, and the warnings about it.
fn document_of(source: &str, trivia: Trivia) -> (String, Vec<Diagnostic>) {
    let unit = read(source);
    let library = plcc_convert::xml::Library::new(std::iter::once(&unit));
    let (document, messages) = plcc_convert::xml::write(&unit, &library, trivia, Some(source));
    assert!(!has_errors(&messages), "{messages:#?}");
    (document, messages)
}

/// A document as a source in SCL.
fn scl_of(document: &str) -> String {
    let unit = read(document);
    let others = plcc_convert::scl::Others::Refused;
    let (source, messages) = plcc_convert::scl::write(&unit, Trivia::none(), unit.overlay.as_deref(), others);
    assert!(!has_errors(&messages), "{messages:#?}");
    source
}

/// Values of elements of arrays, of components of structures, and of timers and counters.
#[test]
fn values_of_instances_stay() {
    let source = r#"
FUNCTION_BLOCK "Pump"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
VAR_INPUT
  start : Bool;
  speed : Int := 7;
END_VAR
BEGIN
END_FUNCTION_BLOCK

FUNCTION_BLOCK "Plant"
VAR
  pumps : Array[0..3] of "Pump";
  waits : Array[0..1] of TON_TIME;
  count : CTU_INT;
  one : Struct
    pump : "Pump";
    low : Int;
  END_STRUCT;
END_VAR
BEGIN
  //@ assert #pumps[1].speed == 9
  //@ assert #pumps[2].speed == 7
  //@ assert #waits[1].PT == T#3s
  //@ assert #count.PV == 5
  //@ assert #one.pump.start == TRUE
  //@ assert #one.low == 4
END_FUNCTION_BLOCK

DATA_BLOCK "Plant_DB" "Plant"
BEGIN
  pumps[1].speed := 9;
  waits[1].PT := T#3s;
  count.PV := 5;
  one.pump.start := TRUE;
  one.low := 4;
END_DATA_BLOCK

DATA_BLOCK "Pause" TON_TIME
BEGIN
  PT := T#2s;
END_DATA_BLOCK

ORGANIZATION_BLOCK "Main"
BEGIN
  "Plant_DB"();
  //@ assert "Pause".PT == T#2s
END_ORGANIZATION_BLOCK
"#;
    stays_the_same("plant.scl", source);
}

/// Start values of an array in a structure are those of each element of the array around it.
#[test]
fn values_of_arrays_in_arrays_stay() {
    let source = r#"DATA_BLOCK DB 1
STRUCT
  recipes : ARRAY [1..3] OF STRUCT
    name : CHAR := 'A';
    amounts : ARRAY [1..2] OF REAL := 1.0, 2.5;
  END_STRUCT;
END_STRUCT
BEGIN
  recipes[3].amounts[2] := 0.5;
END_DATA_BLOCK
ORGANIZATION_BLOCK OB 1
BEGIN
NETWORK
      SET;
//@ assert DB1.recipes[1].amounts[1] == 1.0
//@ assert DB1.recipes[1].amounts[2] == 2.5
//@ assert DB1.recipes[2].amounts[1] == 1.0
//@ assert DB1.recipes[2].amounts[2] == 2.5
//@ assert DB1.recipes[3].amounts[1] == 1.0
//@ assert DB1.recipes[3].amounts[2] == 0.5
//@ assert DB1.recipes[3].name == 'A'
END_ORGANIZATION_BLOCK
"#;
    stays_the_same("recipes.stl", source);
}

/// SCL has no values of single elements; those of XML become lists, with the values that elements without one have.
#[test]
fn values_of_elements_become_lists_of_scl() {
    let source = r#"DATA_BLOCK "Values"
VAR
  b : Array[1..2, 0..1] of Int := [1, 2, 3];
  c : Array[0..2] of Bool := [TRUE, FALSE];
  d : Array[0..9] of Real;
END_VAR
BEGIN
  b[2, 1] := 7;
  d[2] := 1.5;
END_DATA_BLOCK
"#;
    let (document, _) = document_of(source, Trivia::none());
    let written = scl_of(&document);
    for line in ["of Int := [1, 2, 3, 7];", "of Bool := [TRUE, FALSE];", "of Real := [2(0.0), 1.5];"] {
        assert!(written.contains(line), "{line} in\n{written}");
    }
    read(&written);
}

/// Load memory only, write-protected and retentive data blocks.
#[test]
fn flags_of_data_blocks_stay() {
    let source = r#"DATA_BLOCK "Kept"
RETAIN
VAR
  a, b : Int;
END_VAR
BEGIN
END_DATA_BLOCK

DATA_BLOCK "Loaded"
UNLINKED
VAR
  a : Int;
END_VAR
BEGIN
END_DATA_BLOCK

DATA_BLOCK "Fixed"
READ_ONLY
VAR
  a : Int;
END_VAR
BEGIN
END_DATA_BLOCK
"#;
    let (written, _) = document_of(source, Trivia::none());
    let again = read(&written);
    let flags = again.blocks.iter().filter_map(|block| match block {
        Block::Data(data) => Some((data.retained.join(" "), data.header.unlinked, data.header.read_only)),
        Block::Code(_) | Block::Type(_) => None,
    });
    let wanted = [("a b", false, false), ("", true, false), ("", false, true)];
    let wanted = wanted.map(|(retained, unlinked, read_only)| (retained.to_string(), unlinked, read_only));
    assert_eq!(flags.collect::<Vec<_>>(), wanted, "{written}");
}

/// A data block that clients of OPC UA may not reach.
#[test]
fn access_of_clients_to_data_blocks_stays() {
    let source = r#"DATA_BLOCK "Hidden"
{ DB_Accessible_From_OPC_UA := 'FALSE'; S7_Optimized_Access := 'TRUE' }
VAR
  a : Int;
END_VAR
BEGIN
END_DATA_BLOCK
"#;
    let (document, messages) = document_of(source, Trivia::none());
    assert!(messages.is_empty(), "{messages:#?}");
    assert!(document.contains("<DBAccessibleFromOPCUA>false</DBAccessibleFromOPCUA>"), "{document}");
    let written = scl_of(&document);
    assert!(written.contains("DB_Accessible_From_OPC_UA := 'FALSE'"), "{written}");
}

/// Versions of system blocks, and what panels may do with a variable.
#[test]
fn attributes_of_declarations_stay() {
    let source = r#"FUNCTION_BLOCK "F"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
VAR
  wait { InstructionName := 'TON_TIME'; LibVersion := '1.1' } : TON_TIME;
  limit { ExternalWritable := 'False'; S7_SetPoint := 'True' } : Real;
  shown { ExternalVisible := 'True' } : Real;
END_VAR
BEGIN
  #limit := #shown;
END_FUNCTION_BLOCK
"#;
    let (document, messages) = document_of(source, Trivia::none());
    assert!(messages.is_empty(), "{messages:#?}");
    assert!(document.contains(r#"<Member Name="wait" Datatype="TON_TIME" Version="1.1"/>"#), "{document}");
    let written = scl_of(&document);
    let lines = [
        "wait { LibVersion := '1.1' } : TON_TIME;",
        "limit { ExternalWritable := 'False'; S7_SetPoint := 'True' } : Real;",
        // A variable is visible unless an attribute says that it is not.
        "shown : Real;",
    ];
    for line in lines {
        assert!(written.contains(line), "{line} in\n{written}");
    }
}

/// Pragmas of the file are in comments of the document; assertions and pauses between networks are networks.
#[test]
fn pragmas_come_through() {
    let source = r#"//@ cpu s7-1200
//@ test cycles=3
DATA_BLOCK Counts
    VAR
        cycle : Int;
        since, seconds : LReal;
    END_VAR
END_DATA_BLOCK
ORGANIZATION_BLOCK Main
    VAR_TEMP
        before, after : Time;
    END_VAR
//@ assert "Counts".cycle >= 0
{ S7_Language := "LAD" }
NETWORK
    RUNG wire#powerrail
        { S7_Templates := "SrcType := Int" }
        Add( in1 := "Counts".cycle, in2 := 1, out => "Counts".cycle )
    END_RUNG
END_NETWORK
//@ assert "Counts".cycle > 0
//@ sleep 1000
{ S7_Language := "LAD" }
NETWORK
    RUNG wire#powerrail
        RUNTIME( MEM := "Counts".since, RET_VAL => "Counts".seconds )
    END_RUNG
END_NETWORK
//@ sleep 2000
{ S7_Language := "LAD" }
NETWORK
    RUNG wire#powerrail
        RUNTIME( MEM := "Counts".since, RET_VAL => "Counts".seconds )
    END_RUNG
END_NETWORK
//@ assert "Counts".seconds > 1.5
{ S7_Language := "SCL" }
NETWORK
    IF "Counts".cycle < 3 THEN
        //@ assert "Counts".cycle <> 3
    ELSE
        //@ assert "Counts".cycle == 3
    END_IF;
END_NETWORK
END_ORGANIZATION_BLOCK
"#;
    let language = plcc_driver::pipeline::language_of("a.s7dcl");
    let options = ReadOptions { language, ..Default::default() };
    let (unit, messages) = plcc_readers::parse(FileId::default(), source, &options);
    assert!(!has_errors(&messages), "{messages:#?}");
    let library = plcc_convert::xml::Library::new(std::iter::once(&unit));
    let trivia = Trivia::new(source, scl::comments(source), false);
    let (written, messages) = plcc_convert::xml::write(&unit, &library, trivia, Some(source));
    assert!(!has_errors(&messages), "{messages:#?}");
    let lines: Vec<&str> = written.lines().skip(1).take(2).collect();
    assert_eq!(lines, ["<!--@ cpu s7-1200 -->", "<!--@ test cycles=3 -->"]);
    for text in ["@ sleep 1000", "@ assert &quot;Counts&quot;.cycle &gt; 0"] {
        assert!(written.contains(&format!("\">{text}</Text>")), "{text} in\n{written}");
    }
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.xml");
    fs::write(&file, written).expect("a file");
    let variant = Variant { form: Form::Jit, optimization: Level::O0.into() };
    let outcomes = testing::run(&[TestInput::File(file)], &plan(vec![variant]));
    let results: Vec<_> = outcomes.iter().map(|one| (one.passed, one.failed)).collect();
    assert_eq!(results, [(5, 0)], "{:?}", outcomes.iter().map(|one| &one.failures).collect::<Vec<_>>());
}

/// The texts of comments in a document, in its order; those without text are left out.
fn comments_of(document: &str) -> Vec<String> {
    let tree = roxmltree::Document::parse(document).expect("it is XML");
    let mut found = Vec::new();
    for node in tree.descendants() {
        let name = node.tag_name().name();
        if matches!(name, "Comment" | "LineComment") || node.attribute("CompositionName") == Some("Comment") {
            let is_text = |name: &str| matches!(name, "Text" | "MultiLanguageText");
            let texts = node.descendants().filter(|part| is_text(part.tag_name().name()));
            found.push(texts.filter_map(|part| part.text()).map(str::trim).collect::<String>());
        }
    }
    found.retain(|text| !text.is_empty());
    found
}

/// Each comment is once in the document, with the block, component, network or statement that it is about.
#[test]
fn comments_belong_to_what_they_are_about() {
    let source = r#"TYPE "Motor"
VERSION : 0.1
//about the type
// in two lines
   STRUCT
      // above speed
      speed : Int := 1;   // of speed
      on : Bool;
   END_STRUCT;
END_TYPE

DATA_BLOCK "Store"
VERSION : 0.1
//about the block
   STRUCT
      level : Int;   // of level
      // after the last
   END_STRUCT;
BEGIN
   level := 3; // the start value
END_DATA_BLOCK

FUNCTION "Empty" : Void
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
//about the function
BEGIN
  // one statement
  RETURN;
END_FUNCTION
"#;
    let (document, _) = document_of(source, Trivia::new(source, scl::comments(source), false));
    let wanted = [
        "above speed\nof speed",
        "about the type\nin two lines",
        "of level",
        "about the block\nafter the last\nthe start value",
        "one statement",
        "about the function",
    ];
    assert_eq!(comments_of(&document), wanted, "{document}");
    // Lines of a comment stay comments.
    let written = scl_of(&document);
    assert!(written.contains("    // above speed\n    // of speed\n    speed : Int := 1;\n"), "{written}");
    read(&written);
}

/// The comment of a network of STL is not that of its first statement, too.
#[test]
fn comments_of_networks_of_stl_are_written_once() {
    let source = "FUNCTION \"F\" : VOID\n//about F\nVERSION : 0.1\nBEGIN\nNETWORK\nTITLE =Lamp\n//about the network\n      \
                  A     I 0.0; // of the row\n      //on its own\n      =     Q 4.0;\n//@ assert Q4.0 == 0\n//the end\n\
                  END_FUNCTION\n";
    let (unit, messages) = plcc_readers::parse(FileId::default(), source, &ReadOptions::default());
    assert!(!has_errors(&messages), "{messages:#?}");
    let library = plcc_convert::xml::Library::new(std::iter::once(&unit));
    let trivia = Trivia::new(source, stl::comments(source), false);
    let (document, messages) = plcc_convert::xml::write(&unit, &library, trivia, None);
    assert!(!has_errors(&messages), "{messages:#?}");
    // Those after the last statement follow it, where an assertion still is one.
    let wanted = ["of the row", "on its own", "@ assert Q4.0 == 0", "the end", "about the network", "about F"];
    assert_eq!(comments_of(&document), wanted, "{document}");
}

/// In SIMATIC SD the rungs that feed pins of a box come after it.
#[test]
fn gates_whose_inputs_come_after_them_stay() {
    let source = r#"
{ S7_PreferredLanguage := "FBD" }
ORGANIZATION_BLOCK Main
{ S7_Language := "FBD" }
NETWORK
    RUNG %I0.0 A( in2 := NOT %I0.1, in3 := wire#w1 ) O( in2 := wire#w2, in3 := NOT %I0.2 ) Coil( %Q0.0 ) END_RUNG
    RUNG %I0.3 O( in2 := %I0.4 ) NOT END_RUNG wire#w1
    RUNG %I0.5 X( in2 := %I0.6 ) END_RUNG wire#w2
END_NETWORK
//@ assert %Q0.0 == 1
END_ORGANIZATION_BLOCK
"#;
    stays_the_same("gates.s7dcl", source);
}

/// One in four sources; all of them with `PLCC_ALL_SOURCES=1`.
#[test]
fn sources_as_xml_mean_the_same() {
    let (mut count, mut failed, mut refused) = (0, Vec::new(), BTreeMap::new());
    let all = std::env::var_os("PLCC_ALL_SOURCES").is_some();
    let paths = ["s7dcl", "scl", "stl"].iter().flat_map(|extension| sources(extension));
    for path in paths.filter(|path| all || is_chosen(path, 4)) {
        match as_xml(&path, &mut refused) {
            None => {}
            Some(Ok(())) => count += 1,
            Some(Err(text)) => failed.push(format!("{}: {text}", path.display())),
        }
    }
    assert!(failed.is_empty(), "{} of {}, {refused:#?}:\n{}", failed.len(), count + failed.len(), failed.join("\n\n"));
    println!("{count} sources; refused: {refused:#?}");
    assert!(count > 100, "only {count} sources; {refused:#?}");
}
