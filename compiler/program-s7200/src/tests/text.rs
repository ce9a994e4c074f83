//! Programs as text.

use plcc_abi::image::{BlockKind, Config};
use plcc_diag::{Diagnostic, SourceFile, SourceMap};
use plcc_syntax::ParseOptions;
use plcc_syntax::ast::Width;

use plcc_abi::image::{AssertConstant, AssertKind};
use plcc_binding::BindInput;
use plcc_model::Program;

use plcc_model::ComparedValue;
use plcc_model::profile;
use plcc_model::s7200::{Assert, AssertSide, Operand, StatementKind};

/// Binds a source with a symbol table, if it is not empty.
fn bind_text(name: &str, text: &str, table: &str) -> (SourceMap, Program, Vec<Diagnostic>) {
    let mut sources = SourceMap::default();
    let file = sources.add(SourceFile::new(name, text));
    let options = ParseOptions { pragmas: true, ..ParseOptions::default() };
    let (unit, mut diagnostics) = plcc_syntax::s7200::parse(file, text, &options);
    let named = unit.pragmas.iter().find_map(|pragma| profile::lookup(pragma.text.strip_prefix("cpu")?));
    let mut tables = Vec::new();
    if !table.is_empty() {
        let file = sources.add(SourceFile::new("symbols.txt", table));
        let (table, bad) = plcc_readers::symbols::parse(file, sources.file(file));
        diagnostics.extend(bad);
        tables.push(table);
    }
    let (program, found) = crate::bind(&BindInput {
        name: "test".to_string(),
        sources: &sources,
        units: &[(file, unit)],
        tables: &tables,
        profile: named.unwrap_or_else(|| profile::lookup("s7-200").unwrap()),
        config: Config::default(),
        partial: false,
        stand_ins: None,
        pragmas: true,
        require_main: false,
        safety_as_standard: false,
        plain_charts: false,
    });
    diagnostics.extend(found);
    plcc_diag::sort(&mut diagnostics);
    (sources, program, diagnostics)
}

/// Codes of the messages about a text, with their lines.
fn messages(text: &str) -> Vec<(u32, &'static str)> {
    let (sources, _, diagnostics) = bind_text("test.awl", text, "");
    let line = |diagnostic: &Diagnostic| {
        let span = diagnostic.primary.span;
        sources.file(span.file).line(span.start)
    };
    diagnostics.iter().map(|diagnostic| (line(diagnostic), diagnostic.code.name())).collect()
}

#[test]
fn a_flat_list() {
    let text =
        "LD I0.0\nCALL 1\nLD SM0.1\nATCH 0, 10\nENI\nMEND\nSBR 1\n= Q0.0\nCRET\nRET\nINT 0\nLD SM0.0\nCRETI\nRETI\n";
    assert_eq!(messages(text), []);
}

#[test]
fn symbols_of_a_table() {
    let table = "Motor\tQ0.0\tthe motor\nSpeed\tVW10\t\nLimit\t1500\t\nRun_up\tT37\t\nPump\tSBR0\t\n";
    let text = "LD Run_up\n= Motor\nAW> Speed, Limit\nTON Run_up, 10\nCALL Pump\nMEND\nSBR 0\nRET\n";
    let (_, program, diagnostics) = bind_text("test.awl", text, table);
    assert!(diagnostics.is_empty(), "{diagnostics:#?}");
    let symbols: Vec<_> =
        program.symbols.iter().map(|symbol| (symbol.name.as_str(), symbol.address.as_str())).collect();
    assert_eq!(symbols, [("Motor", "Q0.0"), ("Run_up", "T37"), ("Speed", "VW10")]);
    let names: Vec<&str> = program.blocks.iter().map(|block| block.name.as_str()).collect();
    assert_eq!(names, ["", "Pump"]);
    let (_, _, diagnostics) = bind_text("test.awl", "LD Run_up\n= Motr\n", table);
    assert_eq!(diagnostics[0].help.as_deref(), Some("names like it: Motor"));
}

#[test]
fn assertions() {
    let text = "LD SM0.0\nMOVW -5, VW0\n//@ assert VW0 == -5\n//@ assert T37 == 0\n//@ assert TW37 == 0\n//@ assert S0 == 1\n\
                //@ assert ENO == 1\n//@ assert VD4 <= 1.5\n//@ assert 1 == 2\n//@ sleep 100\n";
    let (_, program, diagnostics) = bind_text("test.awl", text, "");
    assert!(diagnostics.is_empty(), "{diagnostics:#?}");
    let statements = &super::build::body(&program, BlockKind::Ob, 1).statements;
    let asserts: Vec<&Assert> = statements
        .iter()
        .filter_map(|statement| match &statement.kind {
            StatementKind::Assert(assert) => Some(assert),
            _ => None,
        })
        .collect();
    let constant = |index: usize| match asserts[index].comparisons[0].right.value {
        ComparedValue::Constant(AssertConstant::Bits(value)) => value,
        _ => panic!("no constant"),
    };
    // The bits of a word with this value.
    assert_eq!(constant(0), 0xFFFB);
    let left = |index: usize| asserts[index].sides().next().unwrap();
    assert!(matches!(left(1), AssertSide::Operand(Operand::Timer { number: 37, width: Width::Bit })));
    assert!(matches!(left(2), AssertSide::Operand(Operand::Timer { number: 37, width: Width::Word })));
    assert!(matches!((left(3), left(4)), (AssertSide::Stack(0), AssertSide::Eno)));
    let kind = asserts[5].comparisons[0].kind;
    assert_eq!((kind, constant(5)), (AssertKind::Float, u64::from(1.5f32.to_bits())));
    assert!(asserts[6].trap && !asserts[0].trap);
    assert!(matches!(statements.last().map(|statement| &statement.kind), Some(StatementKind::Sleep(100))));
}

#[test]
fn all_faults_are_told_in_one_run() {
    let text = "Network 1\nA I0.0\nMOVW VB0, VW0\nNetwork 2\nLD I0.0\nTONR T37, 5\nJMP 3\n";
    assert_eq!(messages(text), [(2, "P0801"), (3, "P0203"), (6, "P0810"), (7, "P0308")]);
}
