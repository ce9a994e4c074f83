//! Calls and functions as they are bound. Source: SCL reference, calls and functions.

use plcc_abi::image::BlockKind;
use plcc_diag::{Diagnostic, SourceFile, SourceMap};
use plcc_readers::ReadOptions;
use plcc_syntax::{Elementary, Language};

use crate::bind::bind;
use crate::bind::declarations::shipped::empty;
use plcc_binding::BindInput;
use plcc_model::scl::{Actual, BinaryOp, Call, Complex, Conversion, Expr, ExprKind, Function, Instance, StatementKind};
use plcc_model::{BlockKey, Body, Program};

/// Local data of the block under test, and blocks that it may call.
const BLOCKS: &str = r#"
FUNCTION "Add" : INT
VAR_INPUT a : INT; b : DINT; END_VAR
VAR_OUTPUT q : INT; END_VAR
BEGIN
  #Add := #a; #q := #a;
END_FUNCTION
FUNCTION "One" : REAL
VAR_INPUT x : REAL; END_VAR
BEGIN
  #One := #x;
END_FUNCTION
FUNCTION_BLOCK "Count"
VAR_INPUT up : BOOL; n : INT; END_VAR
VAR_OUTPUT q : BOOL; v : DINT; END_VAR
BEGIN
  #q := #up;
END_FUNCTION_BLOCK
FUNCTION_BLOCK "Other"
VAR_INPUT up : BOOL; END_VAR
BEGIN
  ;
END_FUNCTION_BLOCK
DATA_BLOCK "CountDb" "Count" BEGIN END_DATA_BLOCK
DATA_BLOCK "Shared" STRUCT t : TON_TIME; x : INT; END_STRUCT; BEGIN END_DATA_BLOCK
"#;

const LOCALS: &str = "i, j : INT; d, d2 : DINT; r : REAL; b, b2 : BOOL; w : WORD; dw : DWORD; t : TIME; \
    s5 : S5TIME; s, s2 : STRING[20]; by : BYTE; c : \"Count\"; cs : ARRAY[1..3] OF \"Count\"; \
    ai, ai2 : ARRAY[0..9] OF INT; bits : ARRAY[0..15] OF BOOL;";

fn bound(code: &str) -> (Program, Vec<Diagnostic>) {
    let text = format!(
        "{BLOCKS}FUNCTION_BLOCK \"Test\"\nVAR {LOCALS} END_VAR\nVAR_IN_OUT open : ARRAY[*] OF INT; END_VAR\nBEGIN\n{code}\nEND_FUNCTION_BLOCK\n"
    );
    let mut sources = SourceMap::default();
    let file = sources.add(SourceFile::new("test.scl", text.as_str()));
    let options = ReadOptions { language: Some(Language::Scl), ..ReadOptions::default() };
    let (unit, mut diagnostics) = plcc_readers::parse(file, &text, &options);
    let (program, messages) = bind(&BindInput { name: "test".to_string(), units: &[(file, unit)], ..empty(&sources) });
    diagnostics.extend(messages);
    (program, diagnostics)
}

/// The statements of the block under test, which binds without an error.
fn statements(code: &str) -> Vec<StatementKind> {
    let (program, diagnostics) = bound(code);
    assert!(diagnostics.iter().all(|message| !message.is_error()), "{code}: {diagnostics:#?}");
    let block = program.blocks.iter().find(|block| block.name == "Test").expect("the block is there");
    match &block.body {
        Body::Scl(body) => body.statements.iter().map(|statement| statement.kind.clone()).collect(),
        Body::Stl(_) | Body::S7200(_) | Body::Runtime => panic!("the block is in SCL"),
    }
}

/// Codes of the errors.
fn errors(code: &str) -> Vec<&'static str> {
    let (_, diagnostics) = bound(code);
    diagnostics.iter().filter(|message| message.is_error()).map(|message| message.code.name()).collect()
}

/// The call that the first statement is.
fn call(code: &str) -> Call {
    match statements(code).into_iter().next() {
        Some(StatementKind::Call(call)) => *call,
        other => panic!("{code}: no call: {other:?}"),
    }
}

/// The value that the first statement assigns.
fn value(code: &str) -> Expr {
    match statements(code).into_iter().next() {
        Some(StatementKind::Assign { value, .. }) => value,
        other => panic!("{code}: no assignment: {other:?}"),
    }
}

/// The name of the block that is called.
fn target(code: &str) -> String {
    let (program, _) = bound(code);
    let key: BlockKey = call(code).target;
    program.block(key).expect("the block is there").name.clone()
}

#[test]
fn each_form_of_call_finds_its_block() {
    for (code, name) in [
        (r#""Add"(a := 1, b := 2, q => #i);"#, "Add"),
        ("\"CountDb\"(up := TRUE);", "Count"),
        ("\"Count\".\"CountDb\"(up := TRUE);", "Count"),
        ("#c(up := TRUE);", "Count"),
        ("#cs[2](up := TRUE);", "Count"),
        ("#cs[#i](up := TRUE);", "Count"),
        ("\"Shared\".t(IN := TRUE, PT := T#1s);", "TON"),
        ("\"Shared\".t.TON(IN := TRUE, PT := T#1s);", "TON"),
    ] {
        assert_eq!(target(code), name, "{code}");
    }
}

#[test]
fn instances() {
    assert!(matches!(call("\"CountDb\"();").instance, Some(Instance::Db(_))));
    assert!(matches!(call("#c();").instance, Some(Instance::Variable(access)) if access.indices.is_empty()));
    assert!(matches!(call("#cs[#i]();").instance, Some(Instance::Variable(access)) if access.indices.len() == 1));
    assert_eq!(errors("\"Count\"();"), ["P0204"]);
    assert_eq!(errors("\"Other\".\"CountDb\"();"), ["P0317"]);
    assert_eq!(errors("\"Shared\"();"), ["P0317"]);
    assert_eq!(errors("#i();"), ["P0203"]);
}

#[test]
fn arguments_stand_in_the_order_of_the_text() {
    let call = call("\"Add\"(q => #i, b := #i, a := #j);");
    let order: Vec<usize> = call.arguments.iter().map(|argument| argument.parameter).collect();
    assert_eq!(order, [2, 1, 0]);
    // INT to the expected DINT.
    let Actual::Value(value) = &call.arguments[1].actual else { panic!("an input is a value") };
    assert_eq!(value.ty, Elementary::Dint);
}

#[test]
fn outputs_convert_to_the_type_of_the_variable() {
    let call = call("#c(v => #r, q => #b, up := #b2);");
    let back: Vec<_> = call
        .arguments
        .iter()
        .map(|argument| match &argument.actual {
            Actual::Variable { back, .. } => *back,
            _ => None,
        })
        .collect();
    assert!(matches!(back[0], Some(Conversion::Value(_))), "{back:?}");
    assert_eq!(back[1], None);
    assert_eq!(errors("#c(v => #b);"), ["P0401"]);
    assert_eq!(errors("#c(q => TRUE);"), ["P0411"]);
}

#[test]
fn missing_and_surplus_arguments() {
    assert_eq!(errors("\"Add\"(a := 1, q => #i);"), ["P0312"]);
    assert_eq!(errors("\"Add\"(a := 1, b := 1, a := 2, q => #i);"), ["P0313"]);
    assert_eq!(errors("\"Add\"(a := 1, bb := 1, q => #i);"), ["P0311"]);
    assert_eq!(errors("\"Add\"(a => #i, b := 1, q => #i);"), ["P0208"]);
    assert!(matches!(call("\"Add\"(a := 1, b := 2, q => );").arguments[2].actual, Actual::Dropped));
    assert_eq!(call("#c(n := , up := TRUE);").arguments.len(), 1);
    assert_eq!(call("\"Add\"(1, 2, #i);").arguments.len(), 3);
    let enabled = call("#c(EN := #b, n := 1, ENO => #b2);");
    assert!(enabled.enable.is_some() && enabled.eno.is_some());
}

#[test]
fn values_of_calls() {
    assert!(matches!(value("#r := \"One\"(1.5);").kind, ExprKind::Call(_)));
    assert_eq!(errors("#b := #c(up := TRUE);"), ["P0401"]);
    assert_eq!(errors("#i := \"Nothing\"(1);"), ["P0302"]);
}

#[test]
fn unknown_functions_are_told_of_once() {
    assert_eq!(errors("#r := Sqroot(1.0); #r := Sqroot(2.0);"), ["P0302"]);
    let (_, diagnostics) = bound("#r := SQRTT(1.0);");
    assert!(diagnostics[0].help.iter().any(|help| help.contains("SQRT")), "{diagnostics:?}");
    assert_eq!(errors("#i := JOIN(#i);"), ["P0303"]);
}

#[test]
fn functions_of_numbers() {
    let function = |code: &str| match value(code).kind {
        ExprKind::Function { function, .. } => function,
        other => panic!("{code}: {other:?}"),
    };
    assert_eq!(function("#r := SQRT(#r);"), Function::Sqrt);
    assert_eq!(function("#i := LIMIT(MN := 0, IN := #i, MX := 10);"), Function::Limit);
    assert_eq!(function("#i := SEL(G := #b, IN0 := #i, IN1 := 5);"), Function::Select);
    assert_eq!(function("#w := SWAP(#w);"), Function::Swap);
    assert_eq!(function("#i := MUX(K := #i, IN0 := 1, IN1 := #j, INELSE := 3);"), Function::Mux { has_else: true });
    // The widest type of the arguments.
    assert_eq!(value("#d := MAX(IN1 := #i, IN2 := #d, IN3 := 7);").ty, Elementary::Dint);
    assert_eq!(value("#d := MIN_DINT(#i, #j);").ty, Elementary::Dint);
    assert!(matches!(value("#i := MAX(IN1 := #i, IN2 := #j);").kind, ExprKind::Binary { op: BinaryOp::Max, .. }));
    assert!(matches!(value("#w := SHL(IN := #w, N := 4);").kind, ExprKind::Binary { op: BinaryOp::ShiftLeft, .. }));
    assert_eq!(errors("#w := SHL(IN := #w, N := -4);"), ["P0504"]);
    assert_eq!(errors("#i := LIMIT(MN := 0, IN := #i);"), ["P0312"]);
    assert_eq!(errors("#i := MAX(IN1 := #i, IN2 := #b);"), ["P0401"]);
}

#[test]
fn explicit_conversions() {
    assert!(matches!(value("#r := INT_TO_REAL(#i);").kind, ExprKind::Convert { conversion: Conversion::Value(_), .. }));
    assert!(matches!(
        value("#i := BCD_TO_INT(#w);").kind,
        ExprKind::Convert { conversion: Conversion::FromBcd { .. }, .. }
    ));
    assert!(matches!(value("#d := TRUNC(#r);").kind, ExprKind::Convert { conversion: Conversion::Truncate(_), .. }));
    assert_eq!(errors("#t := REAL_TO_TIME(#r);"), ["P0401"]);
}

#[test]
fn timers_and_counters() {
    let code = "#s5 := S_ODT(T_NO := T5, S := #b, TV := T#5s, R := FALSE, Q => #b2, BI => #w);";
    let ExprKind::Timer(timer) = value(code).kind else { panic!("a timer") };
    assert!(timer.q.is_some() && timer.bi.is_some());
    assert_eq!(timer.value.map(|value| value.ty), Some(Elementary::S5Time));
    assert!(matches!(
        statements("S_CU(C_NO := C3, CU := #b, PV := 16#20, CV => #w);").remove(0),
        StatementKind::Evaluate(Expr { kind: ExprKind::Counter(_), .. })
    ));
    assert_eq!(errors("S_CU(C_NO := T3, CU := #b);"), ["P0401"]);
}

#[test]
fn memory_by_address() {
    assert!(matches!(
        value("#w := PEEK_WORD(AREA := 16#84, DBNUMBER := 5, BYTEOFFSET := #i);").kind,
        ExprKind::Load(_)
    ));
    assert!(matches!(
        statements("POKE(AREA := 16#83, DBNUMBER := 0, BYTEOFFSET := 4, VALUE := #by);").remove(0),
        StatementKind::Assign { .. }
    ));
    assert_eq!(errors("#b := POKE(AREA := 16#83, DBNUMBER := 0, BYTEOFFSET := 4, VALUE := #by);"), ["P0401"]);
}

#[test]
fn parts_of_arrays() {
    // All constant: one copy of five INTs.
    assert!(matches!(
        statements("MOVE_BLK(IN := #ai[0], COUNT := 5, OUT => #ai2[3]);").as_slice(),
        [StatementKind::Copy { bytes: 10, .. }]
    ));
    assert!(matches!(
        statements("MOVE_BLK(IN := #ai[#i], COUNT := #j, OUT => #ai2[3]);").last(),
        Some(StatementKind::For { .. })
    ));
    // Eight elements are assigned, and two more are a copy of the first.
    let filled = statements("FILL_BLK(IN := 7, COUNT := 10, OUT => #ai[0]);");
    assert!(matches!(filled.as_slice(), [StatementKind::Assign { .. }, .., StatementKind::Copy { bytes: 4, .. }]));
    assert_eq!(filled.len(), 9);
    assert!(matches!(
        statements("FILL_BLK(IN := 7, COUNT := #j, OUT => #ai[0]);").last(),
        Some(StatementKind::For { .. })
    ));
    assert_eq!(statements("SCATTER(IN := #w, OUT => #bits);").len(), 17);
    assert_eq!(errors("SCATTER(IN := #dw, OUT => #bits);"), ["P0401"]);
    assert_eq!(errors("MOVE_BLK(IN := #ai[0], COUNT := 5, OUT => #bits[0]);"), ["P0401"]);
    assert!(matches!(
        value("#d := UPPER_BOUND(ARR := #open, DIM := 1);").kind,
        ExprKind::Bound { parameter: 0, upper: true, .. }
    ));
}

#[test]
fn texts_are_calls_of_the_library() {
    let code = "#s := CONCAT(IN1 := #s, IN2 := 'b', IN3 := #s2);";
    let StatementKind::Call(outer) = statements(code).remove(0) else { panic!("a call that writes its target") };
    assert!(matches!(outer.arguments.last().map(|argument| &argument.actual), Some(Actual::Reference(_))));
    let Actual::Complex(Complex::Call(inner)) = &outer.arguments[0].actual else { panic!("a call inside a call") };
    assert_eq!(inner.target, outer.target);
    assert!(matches!(outer.target.kind, BlockKind::Fc | BlockKind::Sfc));
    assert!(matches!(value("#i := LEN(#s);").kind, ExprKind::Call(_)));
}
