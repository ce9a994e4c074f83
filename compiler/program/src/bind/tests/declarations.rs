//! Declarations of SCL and the TIA Portal: layouts, initial values, constants, views, numbers of blocks.

use plcc_abi::image::{BlockKind, Family};
use plcc_abi::names::External;
use plcc_diag::{Diagnostic, FileId, Severity, SourceFile, SourceMap};
use plcc_syntax::ast::SourceUnit;
use plcc_syntax::{Language, ParseOptions};

use crate::bind::bind;
use crate::bind::declarations::shipped::empty;
use plcc_binding::BindInput;
use plcc_model::profile;
use plcc_model::types::DataType;
use plcc_model::{BlockKey, CodeBlock, Passing, Program};
use plcc_readers::ReadOptions;

fn bind_scl(source: &str) -> (Program, Vec<Diagnostic>) {
    bind_parsed(source, |file| plcc_syntax::scl::parse(file, source, &ParseOptions::default()))
}

fn bind_parsed(source: &str, parse: impl Fn(FileId) -> (SourceUnit, Vec<Diagnostic>)) -> (Program, Vec<Diagnostic>) {
    let mut sources = SourceMap::default();
    let file: FileId = sources.add(SourceFile::new("test.scl", source));
    let (unit, mut diagnostics) = parse(file);
    let (program, bound) = bind(&BindInput {
        name: "test".to_string(),
        units: &[(file, unit)],
        profile: profile::generic(Family::S71500),
        pragmas: true,
        ..empty(&sources)
    });
    diagnostics.extend(bound);
    (program, diagnostics)
}

fn good(source: &str) -> Program {
    let (program, diagnostics) = bind_scl(source);
    assert!(diagnostics.is_empty(), "{diagnostics:#?}");
    program
}

fn messages(source: &str) -> Vec<(&'static str, Severity)> {
    bind_scl(source).1.iter().map(|diagnostic| (diagnostic.code.name(), diagnostic.severity)).collect()
}

fn errors(source: &str) -> Vec<&'static str> {
    messages(source).into_iter().filter(|message| message.1 == Severity::Error).map(|message| message.0).collect()
}

/// The bytes of the only data block.
fn data(source: &str) -> Vec<u8> {
    let program = good(source);
    assert_eq!(program.dbs.len(), 1);
    program.dbs[0].data.clone()
}

fn db(members: &str) -> Vec<u8> {
    data(&format!("DATA_BLOCK \"d\"\nSTRUCT\n{members}\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n"))
}

fn block(program: &Program, kind: BlockKind, number: u16) -> &CodeBlock {
    program.block(BlockKey { kind, number }).expect("the test defines the block")
}

/// Places in the instance of FB 1, which has these sections.
fn places(sections: &str) -> Vec<(String, u32, u8)> {
    let program = good(&format!("FUNCTION_BLOCK FB 1\n{sections}\nBEGIN\n;\nEND_FUNCTION_BLOCK\n"));
    let members = &block(&program, BlockKind::Fb, 1).interface.instance;
    members.iter().map(|member| (member.name.clone(), member.byte, member.bit)).collect()
}

/// Source: STL reference, layout rules: types of 8 bits take the next byte, wider ones the next even one.
#[test]
fn layout_of_all_widths() {
    let bytes = db(
        "a : SINT := -1; b : USINT := 200; c : UINT := 60000; d : BYTE := 16#11; e : LWORD := 16#0102030405060708;\n\
        f : WCHAR := 'x'; g : CHAR; h : ULINT := 1; i : LREAL := 1.0; j : UDINT := 4000000000; k : LTIME := LT#1us; l : BOOL := 1;",
    );
    let wanted = [
        &[0xFF, 200, 0xEA, 0x60, 0x11, 0][..],
        &[1, 2, 3, 4, 5, 6, 7, 8, 0, b'x', b' ', 0],
        &[0, 0, 0, 0, 0, 0, 0, 1, 0x3F, 0xF0, 0, 0, 0, 0, 0, 0],
        &[0xEE, 0x6B, 0x28, 0x00, 0, 0, 0, 0, 0, 0, 0x03, 0xE8, 1, 0],
    ];
    assert_eq!(bytes, wanted.concat());
}

/// Source: LAD/FBD reference for S7-1200, date and time: 1970-01-01 was a Thursday.
#[test]
fn predefined_structures() {
    assert_eq!(db("t : DTL;"), [0x07, 0xB2, 1, 1, 5, 0, 0, 0, 0, 0, 0, 0]);
    assert_eq!(db("e : ErrorStruct;").len(), 28);
    assert_eq!(db("h : HW_IO := 260; o : OB_CYCLIC := 30;"), [1, 4, 0, 30]);
    assert_eq!(
        data("DATA_BLOCK \"d\"\nVAR\n t : DTL;\nEND_VAR\nBEGIN\n t.MONTH := 7;\nEND_DATA_BLOCK\n")[..4],
        [0x07, 0xB2, 7, 1]
    );
}

#[test]
fn lists_and_structures() {
    assert_eq!(db("a : ARRAY[0..5] OF USINT := [1, 2, 3(7), 9];"), [1, 2, 7, 7, 7, 9]);
    assert_eq!(db("a : ARRAY[1..2] OF ARRAY[1..2] OF USINT := [[1, 2], [3]];"), [1, 2, 3, 0]);
    assert_eq!(
        db("a : ARRAY[1..3] OF STRUCT x : INT := 5; y : INT; END_STRUCT := [(1, 2), (), (y := 3)];"),
        [0, 1, 0, 2, 0, 5, 0, 0, 0, 5, 0, 3]
    );
    assert_eq!(
        db("w : WSTRING[2] := 'ab'; s : STRING[3] := 'x';"),
        [0, 2, 0, 2, 0, b'a', 0, b'b', 3, 1, b'x', 0, 0, 0]
    );
    assert_eq!(
        errors("DATA_BLOCK \"d\"\nSTRUCT\n a : ARRAY[0..1] OF INT := [1, 2, 3];\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n"),
        ["P0404"]
    );
    assert_eq!(errors("DATA_BLOCK \"d\"\nSTRUCT\n a : SINT := 200;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n"), ["P0404"]);
}

#[test]
fn array_data_blocks_and_types() {
    assert_eq!(
        data("DATA_BLOCK \"d\"\nARRAY[0..2] OF INT;\nBEGIN\n THIS[1] := 7;\nEND_DATA_BLOCK\n"),
        [0, 0, 0, 7, 0, 0]
    );
    let source = "TYPE \"u\"\nSTRUCT\n a : INT := 3;\n b : BOOL;\nEND_STRUCT;\nEND_TYPE\n\
        DATA_BLOCK \"d\"\n\"u\"\nBEGIN\n b := TRUE;\nEND_DATA_BLOCK\n";
    assert_eq!(data(source), [0, 3, 1, 0]);
}

#[test]
fn constants_in_declarations() {
    let fb = "VAR CONSTANT\n N : INT := 3;\n M : INT := N * 2 - 1;\n TXT : STRING := 'ab';\nEND_VAR\n\
        VAR\n a : ARRAY[1..N] OF INT;\n s : STRING[#M];\n t : STRING[4] := TXT;\n x : DINT := M;\nEND_VAR\n";
    assert_eq!(
        places(fb),
        [("a".to_string(), 0, 0), ("s".to_string(), 6, 0), ("t".to_string(), 14, 0), ("x".to_string(), 20, 0)]
    );
    let classic =
        "CONST\n N := 4;\n M := N DIV 2;\nEND_CONST\nVAR\n a : ARRAY[M..N] OF BYTE := M(1), N;\n b : BOOL;\nEND_VAR\n";
    assert_eq!(places(classic), [("a".to_string(), 0, 0), ("b".to_string(), 4, 0)]);
    let block = |declarations: &str| format!("FUNCTION_BLOCK FB 1\n{declarations}\nBEGIN\n;\nEND_FUNCTION_BLOCK\n");
    assert_eq!(errors(&block("VAR CONSTANT\n N : SINT := 200;\nEND_VAR")), ["P0104"]);
    assert_eq!(errors(&block("VAR CONSTANT\n N : INT := 1 / 0;\nEND_VAR")), ["P0104"]);
    assert_eq!(errors(&block("VAR\n a : ARRAY[0..K] OF INT;\nEND_VAR")), ["P0402"]);
    assert_eq!(errors(&block("VAR CONSTANT\n N : INT := 1;\nEND_VAR\nVAR\n N : INT;\nEND_VAR")), ["P0305"]);
}

#[test]
fn parameters_of_open_arrays() {
    let program = good(
        "FUNCTION \"f\" : VOID\nVAR_INPUT\n a : ARRAY[*] OF INT;\nEND_VAR\nVAR_IN_OUT\n v : VARIANT;\nEND_VAR\nBEGIN\n;\nEND_FUNCTION\n\
        FUNCTION_BLOCK \"g\"\nVAR_IN_OUT\n a : ARRAY[*,*] OF INT;\nEND_VAR\nVAR\n x : INT;\nEND_VAR\nBEGIN\n;\nEND_FUNCTION_BLOCK\n",
    );
    let passing: Vec<Passing> =
        block(&program, BlockKind::Fc, 1).interface.parameters.iter().map(|parameter| parameter.passing).collect();
    assert_eq!(passing, [Passing::OpenArray { dimensions: 1 }, Passing::Variant]);
    // A POINTER of 6 bytes, then four bounds of 4 bytes.
    let instance = &block(&program, BlockKind::Fb, 1).interface.instance;
    assert_eq!(instance[1].byte, 22);
    assert!(matches!(instance[0].ty, DataType::OpenArray(_)));
    let block = "FUNCTION_BLOCK FB 1\nVAR_INPUT\n a : ARRAY[*] OF INT;\nEND_VAR\nBEGIN\n;\nEND_FUNCTION_BLOCK\n";
    assert_eq!(errors(block), ["P0410"]);
}

#[test]
fn views_lie_within_their_variables() {
    let block = |view: &str| {
        format!(
            "FUNCTION FC 1 : VOID\nVAR_INPUT\n b : BYTE;\n w : WORD;\n t : BOOL;\n{view}\nEND_VAR\nBEGIN\n;\nEND_FUNCTION\n"
        )
    };
    assert_eq!(
        errors(&block("v AT b : ARRAY[0..7] OF BOOL; x AT w : STRUCT h : BYTE; l : BYTE; END_STRUCT; y AT x : INT;")),
        [""; 0]
    );
    assert_eq!(errors(&block("v AT b : ARRAY[0..8] OF BOOL;")), ["P0408"]);
    assert_eq!(errors(&block("v AT b : WORD;")), ["P0408"]);
    assert_eq!(errors(&block("v AT t : BYTE;")), ["P0408"]);
    assert_eq!(errors(&block("v AT unknown : BYTE;")), ["P0306"]);
}

#[test]
fn temporary_data_of_functions() {
    let tia = "FUNCTION \"f\" : VOID\nVAR\n a : INT;\nEND_VAR\nVAR_TEMP\n b : INT := 5;\nEND_VAR\nBEGIN\n #b := 1;\nEND_FUNCTION\n";
    let warnings: Vec<_> = messages(tia).into_iter().filter(|message| matches!(message.0, "P0211" | "P0404")).collect();
    assert_eq!(warnings, [("P0211", Severity::Warning), ("P0404", Severity::Warning)]);
}

#[test]
fn instances() {
    let program = good(
        "FUNCTION_BLOCK \"a\"\nVAR_INPUT\n x : INT;\nEND_VAR\nBEGIN\n;\nEND_FUNCTION_BLOCK\n\
        FUNCTION_BLOCK \"b\"\nVAR\n i : ARRAY[1..2] OF \"a\";\n t : TON_TIME;\nEND_VAR\nBEGIN\n;\nEND_FUNCTION_BLOCK\n\
        DATA_BLOCK \"d\"\n\"a\"\nBEGIN\n x := 3;\nEND_DATA_BLOCK\n\
        DATA_BLOCK \"t\"\nTON_TIME\nBEGIN\nEND_DATA_BLOCK\n\
        DATA_BLOCK \"g\"\nSTRUCT\n t : ARRAY[0..1] OF IEC_TIMER;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n",
    );
    assert_eq!(block(&program, BlockKind::Fb, 2).interface.instance[1].byte, 4);
    assert_eq!(program.dbs[0].data, [0, 3]);
    assert_eq!(program.dbs[1].instance_of.map(|key| key.kind), Some(BlockKind::Sfb));
}

#[test]
fn numbers_of_blocks() {
    let ob = |name: &str| format!("ORGANIZATION_BLOCK {name}\nBEGIN\n;\nEND_ORGANIZATION_BLOCK\n");
    let names = ["\"Main\"", "\"Startup\"", "\"Cyclic interrupt\"", "\"Cyclic interrupt_1\"", "\"OB82\"", "OB121"];
    let program = good(&names.map(ob).concat());
    let numbers: Vec<u16> = program.blocks.iter().map(|block| block.number).collect();
    assert_eq!(numbers, [1, 30, 31, 82, 100, 121]);
    assert_eq!(errors(&[ob("\"Main\""), ob("\"Fast\"")].concat()), ["P0206"]);
    assert_eq!(good(&ob("\"Fast\"")).blocks[0].number, 1);
}

#[test]
fn documents_of_simatic_sd_say_what_clients_may_only_read() {
    let text = "{ S7_Optimized := \"TRUE\" }\nDATA_BLOCK \"d\"\n    VAR\n        { S7_Access := \"ReadOnly := External\" } \"a\" : Int;\n        \
                { S7_Access := \"readonly:=external\" } \"b\" : Int;\n        { S7_Visibility := \"Hidden\" } \"c\" : Int;\n    END_VAR\nEND_DATA_BLOCK\n";
    let options = ReadOptions { language: Some(Language::Sd), ..ReadOptions::default() };
    let (program, messages) = bind_parsed(text, |file| plcc_readers::parse(file, text, &options));
    assert!(messages.is_empty(), "{messages:#?}");
    let found: Vec<External> = program.dbs[0].members.iter().map(|member| member.external).collect();
    assert_eq!(found, [External::Read, External::Read, External::Write]);
}
