//! Statements as they are bound: types, conversions, places. Expectations are those of the SCL reference.

mod show;

use plcc_abi::image::{BlockKind, Config, Family};
use plcc_diag::{Diagnostic, SourceFile, SourceMap};
use plcc_syntax::ParseOptions;

use crate::bind::{BindInput, bind};
use crate::model::{BlockKey, Body, Program};
use crate::profile;

/// The CPU that nobody named.
const UNNAMED: (Family, bool) = (Family::S7300, false);
const NAMED_300: (Family, bool) = (Family::S7300, true);
const NAMED_1200: (Family, bool) = (Family::S71200, true);

fn bind_text(source: &str, (family, named): (Family, bool)) -> (Program, Vec<Diagnostic>) {
    let mut sources = SourceMap::default();
    let file = sources.add(SourceFile::new("test.scl", source));
    let (unit, mut diagnostics) =
        plcc_syntax::scl::parse(file, source, &ParseOptions { mnemonics: None, pragmas: true });
    let (program, bound) = bind(&BindInput {
        name: "test".to_string(),
        sources: &sources,
        units: &[(file, unit)],
        tables: &[],
        profile: plcc_abi::image::Profile { limits_checked: named, ..profile::generic(family) },
        config: Config::default(),
        partial: false,
        pragmas: true,
        require_main: false,
    });
    diagnostics.extend(bound);
    (program, diagnostics)
}

/// Variables of the FC that most tests bind: TEMP at L0 on, all of them written by an IN_OUT-like start.
const TEMPS: &str = "i : INT; j : INT; n : INT; d : DINT; r : REAL; b : BOOL; c : BOOL; by : BYTE; w : WORD; dw : DWORD; \
    t : TIME; s : STRING[4]; ui : UINT; a : ARRAY[1..3] OF INT; m : ARRAY[0..1, 1..3] OF INT; bits : ARRAY[0..9] OF BOOL; \
    lr : LREAL; tod : TOD; da : DATE; ch : CHAR; st : STRUCT x : INT; y : BOOL; END_STRUCT; dt1 : DATE_AND_TIME;";

fn block(statements: &str) -> String {
    format!("FUNCTION_BLOCK FB 1\nVAR\n{TEMPS}\nEND_VAR\nBEGIN\n{statements}\nEND_FUNCTION_BLOCK\n")
}

fn show(program: &Program) -> String {
    let body = &program.block(BlockKey { kind: BlockKind::Fb, number: 1 }).expect("the test defines it").body;
    match body {
        Body::Scl(body) => show::statements(&body.statements),
        Body::Stl(_) | Body::Runtime => panic!("no SCL"),
    }
}

#[track_caller]
fn check(statements: &str, expected: &str) {
    check_on(UNNAMED, statements, expected);
}

#[track_caller]
fn check_on(cpu: (Family, bool), statements: &str, expected: &str) {
    let (program, diagnostics) = bind_text(&block(statements), cpu);
    assert!(diagnostics.is_empty(), "{diagnostics:#?}");
    assert_eq!(show(&program), expected);
}

#[track_caller]
fn codes(cpu: (Family, bool), statements: &str, expected: &[&str]) {
    let (_, diagnostics) = bind_text(&block(statements), cpu);
    let found: Vec<&str> = diagnostics.iter().map(|diagnostic| diagnostic.code.name()).collect();
    assert_eq!(found, expected, "{diagnostics:#?}");
}

#[test]
fn places() {
    let (program, diagnostics) = bind_text(&block("#i := 1;"), UNNAMED);
    assert!(diagnostics.is_empty(), "{diagnostics:#?}");
    assert_eq!(show(&program), "S0.0 := INT#1");
}
