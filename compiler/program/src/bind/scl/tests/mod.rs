//! Statements as they are bound: types, conversions, places. Expectations are those of the SCL reference.

pub(in crate::bind) mod show;

use plcc_abi::image::{BlockKind, Family};
use plcc_diag::{Diagnostic, SourceFile, SourceMap};
use plcc_syntax::scl::ast::Dialect;
use plcc_syntax::{ParseOptions, ast};

use crate::bind::bind;
use crate::bind::declarations::shipped::empty;
use plcc_binding::BindInput;
use plcc_model::profile;
use plcc_model::{BlockKey, Body, Program};

/// Dialect of the source, family of the CPU, and whether it is named.
type Setting = (Dialect, Family, bool);

const UNNAMED: Setting = (Dialect::Tia, Family::S7300, false);
const CLASSIC: Setting = (Dialect::Classic, Family::S7300, false);
const NAMED_300: Setting = (Dialect::Tia, Family::S7300, true);
const NAMED_1200: Setting = (Dialect::Tia, Family::S71200, true);

fn bind_text(source: &str, (dialect, family, named): Setting) -> (Program, Vec<Diagnostic>) {
    let mut sources = SourceMap::default();
    let file = sources.add(SourceFile::new("test.scl", source));
    let (mut unit, mut diagnostics) =
        plcc_syntax::scl::parse(file, source, &ParseOptions { pragmas: true, ..ParseOptions::default() });
    for block in &mut unit.blocks {
        if let ast::Block::Code(ast::CodeBlock { code: ast::Code::Scl(body), .. }) = block {
            body.dialect = dialect;
        }
    }
    let (program, bound) = bind(&BindInput {
        name: "test".to_string(),
        units: &[(file, unit)],
        profile: plcc_abi::image::Profile { limits_checked: named, ..profile::generic(family) },
        pragmas: true,
        ..empty(&sources)
    });
    diagnostics.extend(bound);
    (program, diagnostics)
}

/// Static data of the FB that most tests bind, from byte 0 on.
const TEMPS: &str = "i : INT; j : INT; n : INT; d : DINT; r : REAL; b : BOOL; c : BOOL; by : BYTE; w : WORD; dw : DWORD; \
    t : TIME; s : STRING[4]; ui : UINT; a : ARRAY[1..3] OF INT; mm : ARRAY[0..1, 1..3] OF INT; bits : ARRAY[0..9] OF BOOL; \
    lr : LREAL; tod : TOD; da : DATE; ch : CHAR; st : STRUCT x : INT; y : BOOL; END_STRUCT; dt1 : DATE_AND_TIME;";

fn block(statements: &str) -> String {
    format!("FUNCTION_BLOCK FB 1\nVAR\n{TEMPS}\nEND_VAR\nBEGIN\n{statements}\nEND_FUNCTION_BLOCK\n")
}

fn show(program: &Program) -> String {
    let body = &program.block(BlockKey { kind: BlockKind::Fb, number: 1 }).expect("the test defines it").body;
    match body {
        Body::Scl(body) => show::statements(&body.statements),
        Body::Stl(_) | Body::S7200(_) | Body::Runtime => panic!("no SCL"),
    }
}

#[track_caller]
fn check(statements: &str, expected: &str) {
    check_on(UNNAMED, statements, expected);
}

#[track_caller]
fn check_on(cpu: Setting, statements: &str, expected: &str) {
    let (program, diagnostics) = bind_text(&block(statements), cpu);
    assert!(diagnostics.is_empty(), "{diagnostics:#?}");
    assert_eq!(show(&program), expected);
}

#[track_caller]
fn codes(cpu: Setting, statements: &str, expected: &[&str]) {
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

/// The operation does not widen to the type of its target. Source: SCL reference, vectors 3, 23.
#[test]
fn arithmetic_types() {
    check("#d := #i / #j;", "S6.0 := INT->DINT((Divide.INT S0.0 S2.0))");
    codes(UNNAMED, "#d := #i * #j;", &["P0520"]);
    check("#d := #i + 1;", "S6.0 := INT->DINT((Add.INT S0.0 INT#1))");
    check("#d := 1 + 50000;", "S6.0 := DINT#50001");
    check("#r := #i / 2.0;", "S10.0 := (Divide.REAL INT->REAL(S0.0) REAL#1073741824)");
    check("#d := #i + #ui;", "S6.0 := (Add.DINT INT->DINT(S0.0) UINT->DINT(S32.0))");
    check("#w := #w + 1;", "S16.0 := UINT->WORD((Add.UINT WORD->UINT(S16.0) UINT#1))");
    check("#i := -#i;", "S0.0 := (negate s0.0)");
    check("#r := #i ** 2;", "S10.0 := (Power.REAL INT->REAL(S0.0) REAL#1073741824)");
    check("#lr := #r + #lr;", "S54.0 := (Add.LREAL REAL->LREAL(S10.0) S54.0)");
    check("#i := #i MOD 3;", "S0.0 := (Modulo.INT S0.0 INT#3)");
    check("#i := -32768;", "S0.0 := INT#32768");
}

#[test]
fn classic_constants_widen() {
    // `LABEL` only occurs in the classic form.
    let source = "FUNCTION FC 1 : VOID\nVAR_TEMP\n i : INT; d : DINT;\nEND_VAR\nCONST\n k := 5;\nEND_CONST\nBEGIN\ni := k;\nd := i + 50000;\nEND_FUNCTION\n";
    let (program, diagnostics) = bind_text(source, CLASSIC);
    assert!(diagnostics.is_empty(), "{diagnostics:#?}");
    let Body::Scl(body) = &program.block(BlockKey { kind: BlockKind::Fc, number: 1 }).unwrap().body else { panic!() };
    assert_eq!(show::statements(&body.statements), "L0.0 := INT#5; L2.0 := (Add.DINT INT->DINT(L0.0) DINT#50000)");
    assert!(!body.calls_set_flag);
}

#[test]
fn bits() {
    check(
        "#b := #b AND NOT #c OR #b XOR #c;",
        "S14.0 := (Or.BOOL (And.BOOL S14.0 (not s14.1)) (Xor.BOOL S14.0 S14.1))",
    );
    check("#w := #by OR #w;", "S16.0 := (Or.WORD BYTE->WORD(S15.0) S16.0)");
    check("#w := #w AND 16#FF;", "S16.0 := (And.WORD S16.0 WORD#255)");
    check("#b := #b & #c;", "S14.0 := (And.BOOL S14.0 S14.1)");
    codes(UNNAMED, "#b := #b AND #i;", &["P0401"]);
    codes(UNNAMED, "#b := NOT #r;", &["P0401"]);
}

/// Source: SCL reference, vectors 4, 30.
#[test]
fn comparisons() {
    check("#b := #i < 5 = TRUE;", "S14.0 := (Equal.BOOL (Less.INT S0.0 INT#5) BOOL#1)");
    check("#b := #i = #d;", "S14.0 := (Equal.DINT INT->DINT(S0.0) S6.0)");
    check("#b := #w = 16#FF;", "S14.0 := (Equal.WORD S16.0 WORD#255)");
    check("#b := #r > 1;", "S14.0 := (Greater.REAL S10.0 REAL#1065353216)");
    check("#b := #t > T#1s;", "S14.0 := (Greater.TIME S22.0 TIME#1000)");
    check("#b := #ch = 'A';", "S14.0 := (Equal.CHAR S68.0 CHAR#65)");
    check("IF #b = 1 THEN #i := 1; END_IF;", "if (Equal.BOOL S14.0 BOOL#1) {S0.0 := INT#1} else {}");
    codes(UNNAMED, "#b := #b = #i;", &["P0401"]);
    codes(UNNAMED, "#b := #ui < 0;", &["P0521"]);
    codes(UNNAMED, "#i = 5;", &["P0208"]);
    check("#b := #st = #st;", "S14.0 := (And.BOOL (Equal.INT S70.0 S70.0) (Equal.BOOL S72.0 S72.0))");
}

#[test]
fn times() {
    check("#t := #t + T#1s;", "S22.0 := (Add.TIME S22.0 TIME#1000)");
    check("#t := #t * 2;", "S22.0 := (Multiply.TIME S22.0 DINT->TIME(DINT#2))");
    check("#t := #t / #i;", "S22.0 := (Divide.TIME S22.0 INT->TIME(S0.0))");
    check("#tod := #tod - #t;", "S62.0 := (SubtractDay.TIME_OF_DAY S62.0 TIME->TIME_OF_DAY(S22.0))");
    check("#t := #tod - #tod;", "S22.0 := (Subtract.TIME TIME_OF_DAY->TIME(S62.0) TIME_OF_DAY->TIME(S62.0))");
    check_on(
        NAMED_1200,
        "#t := #da - #da;",
        "S22.0 := (Multiply.TIME DINT->TIME((Subtract.DINT DATE->DINT(S66.0) DATE->DINT(S66.0))) TIME#86400000)",
    );
    codes(UNNAMED, "#t := #t + #r;", &["P0401"]);
    codes(UNNAMED, "#t := #tod;", &[]);
    codes(UNNAMED, "#tod := #tod + #tod;", &["P0401"]);
}

#[test]
fn arrays_and_slices() {
    check("#i := #a[2];", "S0.0 := S36.0");
    check("#a[#i] := 5;", "S34.0[INT->DINT(S0.0) in 1..3 by 16] := INT#5");
    check("#i := #mm[1, 2];", "S0.0 := S48.0");
    check("#i := #mm[#i, 2];", "S0.0 := S42.0[INT->DINT(S0.0) in 0..1 by 48]");
    check("#a := #mm[1];", "S34.0 :=6 S46.0");
    check("#b := #bits[9];", "S14.0 := S53.1");
    check("#b := #bits[#i];", "S14.0 := S52.0[INT->DINT(S0.0) in 0..9 by 1]");
    check("#b := #w.%X3;", "S14.0 := S16.0.Bit3");
    check("#dw.%B1 := #by;", "S18.0.Byte1 := S15.0");
    check("#ch := #s[2];", "S68.0 := S29.0");
    check("#ch := #s[#i];", "S68.0 := S28.0[INT->DINT(S0.0) in characters 1..4 by 8]");
    codes(UNNAMED, "#i := #a[4];", &["P0403"]);
    codes(UNNAMED, "#i := #a[1, 1];", &["P0403"]);
    codes(UNNAMED, "#b := #w.%X16;", &["P0403"]);
    codes(UNNAMED, "#ch := #s[5];", &["P0403"]);
    codes(UNNAMED, "#i := #a[#r];", &["P0401"]);
    codes(CLASSIC, "#w := #i;", &["P0520"]);
    codes(UNNAMED, "#i := #i[1];", &["P0307"]);
    codes(UNNAMED, "#i := #st.z;", &["P0307"]);
    codes(UNNAMED, "#i := #nothing;", &["P0306"]);
}

/// Source: SCL reference, vectors 26, 27.
#[test]
fn absolute_addresses() {
    check("#w := MW10;", "S16.0 := M10.0");
    check("#w := %MW10;", "S16.0 := M10.0");
    check("#b := M0.3;", "S14.0 := M0.3");
    check("#w := MW[#i];", "S16.0 := M[INT->DINT(S0.0)]");
    check("#b := M[#i + 1, 2];", "S14.0 := M[INT->DINT((Add.INT S0.0 INT#1)).DINT#2]");
    check("#w := WORD_TO_BLOCK_DB(#w).DW[0];", "S16.0 := DB(S16.0)[DINT#0]");
    check("#b := T5;", "S14.0 := Timer5");
    let db = "DATA_BLOCK DB 5\nSTRUCT\n a : INT; b : BOOL;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n";
    let source = block("#w := DB5.DW0; #b := DB5.DX2.0; #i := DB5.a; #w := DB5.DW[#i];") + db;
    let (program, diagnostics) = bind_text(&source, UNNAMED);
    assert!(diagnostics.is_empty(), "{diagnostics:#?}");
    assert_eq!(show(&program), "S16.0 := DB5.0.0; S14.0 := DB5.2.0; S0.0 := DB5.0.0; S16.0 := DB5[INT->DINT(S0.0)]");
    codes(UNNAMED, "#w := PQW4;", &["P0203"]);
    codes(UNNAMED, "PIW4 := #w;", &["P0411"]);
    codes(UNNAMED, "#w := LW2;", &["P0301"]);
    codes(UNNAMED, "#w := MW;", &["P0203"]);
}

#[test]
fn conversions_in_assignments() {
    check("#r := #i;", "S10.0 := INT->REAL(S0.0)");
    check("#w := #i;", "S16.0 := INT->WORD(S0.0)");
    check("#b := TRUE;", "S14.0 := BOOL#1");
    check("#b := 1;", "S14.0 := BOOL#1");
    check("#w := 16#FFFF;", "S16.0 := WORD#65535");
    check("#i := 16#FFFF;", "S0.0 := INT#65535");
    check("#lr := 0.5;", "S54.0 := LREAL#4602678819172646912");
    codes(UNNAMED, "#i := #d;", &["P0520"]);
    codes(UNNAMED, "#i := #r;", &["P0520"]);
    codes(UNNAMED, "#i := 70000;", &["P0520"]);
    codes(UNNAMED, "#b := 2;", &["P0401"]);
    codes(UNNAMED, "#i := #b;", &["P0401"]);
    codes(UNNAMED, "#t := #r;", &["P0401"]);
    codes(NAMED_300, "#i := #d;", &["P0401"]);
    codes(UNNAMED, "#i := 'ab';", &["P0401"]);
    codes(UNNAMED, "5 := #i;", &["P0201"]);
    codes(UNNAMED, "IF #w THEN ; END_IF;", &["P0401"]);
}

#[test]
fn texts_and_structures() {
    check("#s := 'ab';", "S26.0 :=text [2, 2, 97, 98]");
    check("#s := '';", "S26.0 :=text [1, 0, 0]");
    check("#s := #ch;", "S26.0 :=text char S68.0");
    check("#st := #st;", "S70.0 :=4 S70.0");
    check("#dt1 := DT#2024-02-03-04:05:06.7;", "S74.0 :=8 [36, 2, 3, 4, 5, 6, 112, 7]");
    codes(UNNAMED, "#s := #i;", &["P0401"]);
    codes(UNNAMED, "#st := #a;", &["P0401"]);
}

/// Source: SCL reference, vector 13.
#[test]
fn chains() {
    check("#i += #j *= 2;", "S2.0 := (Multiply.INT S2.0 INT#2); S0.0 := (Add.INT S0.0 S2.0)");
    check("#d := #n := 7;", "S4.0 := INT#7; S6.0 := INT->DINT(S4.0)");
    check("#i /= 2;", "S0.0 := (Divide.INT S0.0 INT#2)");
    check("ENO := FALSE; #b := ENO;", "flag := BOOL#0; S14.0 := flag");
}

#[test]
fn flags() {
    let sets = |statements: &str, header: &str| {
        let source = block(statements).replace("FB 1\n", &format!("FB 1\n{header}"));
        let (program, diagnostics) = bind_text(&source, UNNAMED);
        assert!(diagnostics.is_empty(), "{diagnostics:#?}");
        match &program.block(BlockKey { kind: BlockKind::Fb, number: 1 }).unwrap().body {
            Body::Scl(body) => body.sets_flag,
            _ => panic!("no SCL"),
        }
    };
    assert!(!sets("ENO := TRUE;", ""));
    assert!(sets("#b := ENO;", ""));
    // The ENO of one function is not that of the block.
    assert!(!sets("#i := LIMIT(MN := 1, IN := #j, MX := 3, ENO => #b);", ""));
    assert!(sets("#i := #i + 1;", "{ S7_SetENOAutomatically := 'TRUE' }\n"));
}

/// Source: SCL reference, vectors 12, 35.
#[test]
fn cases() {
    check(
        "CASE #i OF 1: #j := 1; 2, 5..7: #j := 2; -3: ; ELSE #j := 4; END_CASE;",
        "case S0.0 [(1, 1)] {S2.0 := INT#1} [(2, 2), (5, 7)] {S2.0 := INT#2} [(-3, -3)] {} else {S2.0 := INT#4}",
    );
    check("CASE #w OF 16#8000: #i := 1; END_CASE;", "case S16.0 [(32768, 32768)] {S0.0 := INT#1} else {}");
    check("CASE #ch OF 'a': #i := 1; END_CASE;", "case S68.0 [(97, 97)] {S0.0 := INT#1} else {}");
    codes(UNNAMED, "CASE #i OF 2, 5..7: ; 7: ; END_CASE;", &["P0522"]);
    codes(UNNAMED, "CASE #i OF 7..5: ; END_CASE;", &["P0522"]);
    codes(UNNAMED, "CASE #by OF 300: ; END_CASE;", &["P0522"]);
    codes(UNNAMED, "CASE #b OF 1: ; END_CASE;", &["P0401"]);
    codes(UNNAMED, "CASE #i OF #j: ; END_CASE;", &["P0402"]);
}

#[test]
fn loops() {
    check(
        "FOR #i := 1 TO 10 BY 3 DO #j := #j + #i; END_FOR;",
        "for S0.0 := INT#1 to INT#10 by INT#3 {S2.0 := (Add.INT S2.0 S0.0)}",
    );
    check("FOR #i := 10 TO 1 BY -4 DO ; END_FOR;", "for S0.0 := INT#10 to INT#1 by INT#65532 {}");
    check("WHILE #b DO EXIT; END_WHILE;", "while S14.0 {exit}");
    check("REPEAT #b := #c; CONTINUE; UNTIL #b END_REPEAT;", "repeat {S14.0 := S14.1; continue} until S14.0");
    codes(UNNAMED, "REPEAT CONTINUE; UNTIL #b END_REPEAT;", &["P0582"]);
    codes(UNNAMED, "EXIT;", &["P0524"]);
    codes(UNNAMED, "FOR #i := 0 TO 32767 DO ; END_FOR;", &["P0523"]);
    codes(UNNAMED, "FOR #i := 0 TO 32767 DO IF #b THEN EXIT; END_IF; END_FOR;", &[]);
    codes(UNNAMED, "FOR #i := 5 TO 1 DO ; END_FOR;", &[]);
    codes(UNNAMED, "FOR #i := 1 TO 5 BY 0 DO ; END_FOR;", &["P0523"]);
    codes(UNNAMED, "FOR #r := 1 TO 5 DO ; END_FOR;", &["P0401"]);
    codes(UNNAMED, "FOR #i := 1 TO 5 DO #i := 3; END_FOR;", &["P0525"]);
    codes(UNNAMED, "FOR #i := 1 TO 5 DO FOR #i := 1 TO 2 DO ; END_FOR; END_FOR;", &["P0525"]);
}

/// Source: SCL reference, vector 29.
#[test]
fn jumps() {
    check("WHILE TRUE DO GOTO fin; END_WHILE; fin: #j := #i;", "while BOOL#1 {goto 0}; label 0; S2.0 := S0.0");
    codes(UNNAMED, "GOTO nowhere;", &["P0308"]);
    codes(UNNAMED, "l: ; L: ;", &["P0309"]);
    codes(UNNAMED, "GOTO inside; IF #b THEN inside: ; END_IF;", &["P0526"]);
}

fn fc_codes(source: &str) -> Vec<&'static str> {
    bind_text(source, UNNAMED).1.iter().map(|diagnostic| diagnostic.code.name()).collect()
}

#[test]
fn function_values() {
    let own = |name: &str| format!("FUNCTION \"F\" : INT\nBEGIN\n{name} := 5;\nEND_FUNCTION\n");
    for name in ["#F", "\"F\"", "F", "RET_VAL", "#RET_VAL"] {
        assert_eq!(fc_codes(&own(name)), Vec::<&str>::new(), "{name}");
    }
    assert_eq!(fc_codes("FUNCTION FC 3 : INT\nBEGIN\nFC3 := 5;\nEND_FUNCTION\n"), Vec::<&str>::new());
    assert_eq!(fc_codes("FUNCTION \"F\" : INT\nBEGIN\nM0.0 := TRUE;\nEND_FUNCTION\n"), ["P0528"]);
}

#[test]
fn temporary_data() {
    let temp = |code: &str| {
        format!("FUNCTION FC 1 : VOID\nVAR_TEMP\n a : INT; b AT a : WORD;\nEND_VAR\nBEGIN\n{code}\nEND_FUNCTION\n")
    };
    assert_eq!(fc_codes(&temp("MW0 := #a;")), ["P0527"]);
    assert_eq!(fc_codes(&temp("#b := MW2; MW0 := #a;")), Vec::<&str>::new());
    assert_eq!(fc_codes(&temp("MW0 := #a; #a := 1;")), ["P0527"]);
}

/// Neither hangs nor overflows the stack.
#[test]
fn long_and_deep_expressions() {
    let long = format!("#i := {}1;", "#i + ".repeat(900));
    codes(UNNAMED, &long, &[]);
    let too_long = format!("#i := {}#i;", "#i + ".repeat(5000));
    let (_, diagnostics) = bind_text(&block(&too_long), UNNAMED);
    assert!(diagnostics.iter().all(|diagnostic| diagnostic.code.name() == "P0201") && !diagnostics.is_empty());
    let deep = format!("#i := {}#i{};", "(1 + ".repeat(190), ")".repeat(190));
    codes(UNNAMED, &deep, &[]);
}
