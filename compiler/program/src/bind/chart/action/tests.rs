//! Rows as they are bound, in a chart that has no data: event and interlock are inputs.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::chart::ast::{Action, ActionBody, Call, Parameter, Qualifier};
use plcc_syntax::scl::ast::{Expr as Node, ExprKind as NodeKind, StatementKind as TreeKind};

use super::{Moment, Rows};
use crate::bind::chart::testing::in_block;
use crate::bind::declarations::path::{Base, Variable};
use crate::bind::network::Page;
use crate::bind::scl::place::Spot;
use crate::bind::scl::tests::show;
use plcc_model::scl::{Expr, ExprKind};
use plcc_model::types::DataType;

/// The result of binding a row.
struct Bound {
    active: String,
    leave: String,
    after: String,
    codes: Vec<&'static str>,
}

/// A bit of the inputs.
fn input(bit: u8) -> Expr {
    let variable = Variable { base: Base::I, byte: 0, bit, ty: DataType::Elementary(Elementary::Bool), untyped: false };
    let access = Spot::fixed(variable).access(Span::default());
    Expr { kind: ExprKind::Load(Box::new(access)), ty: Elementary::Bool, span: Span::default() }
}

/// Statements of SCL represent the texts of rows: `Q0.0;` for an operand, `FB7.DB7(…);` for a call.
fn body(statement: &plcc_syntax::scl::ast::Statement) -> ActionBody {
    match &statement.kind {
        TreeKind::Expression(Node { kind: NodeKind::Call { callee, arguments }, span }) => {
            let (block, instance) = match &callee.kind {
                NodeKind::Member { base, name } => {
                    let instance = Node { kind: NodeKind::Name(name.clone()), span: name.span };
                    ((**base).clone(), Some(instance))
                }
                _ => ((**callee).clone(), None),
            };
            let parameters = arguments
                .iter()
                .filter_map(|argument| {
                    let name = argument.name.clone()?;
                    Some(Parameter { name, value: argument.value.clone(), span: argument.span })
                })
                .collect();
            ActionBody::Call(Call { block, instance, parameters, span: *span })
        }
        TreeKind::Expression(node) => ActionBody::Operand(node.clone()),
        TreeKind::Assign { targets, value } => {
            ActionBody::Value { operand: targets[0].0.clone(), value: value.clone() }
        }
        other => {
            ActionBody::Statements(vec![plcc_syntax::scl::ast::Statement { kind: other.clone(), span: statement.span }])
        }
    }
}

/// Binds rows for one moment.
fn bind_rows(rows: &[(Qualifier, &str)], moment: &Moment) -> Bound {
    let texts: Vec<&str> = rows.iter().map(|(_, text)| *text).collect();
    let (code, codes) = in_block(&texts.join("\n"), |binder, ctx, statements| {
        let mut page = Page::new(ctx);
        let mut bound = Rows::default();
        for ((qualifier, _), statement) in rows.iter().zip(statements) {
            let action = Action {
                event: None,
                qualifier: *qualifier,
                interlock: false,
                qualifier_span: statement.span,
                body: body(statement),
                comment: None,
                span: statement.span,
            };
            match (qualifier, &action.body) {
                (Qualifier::D | Qualifier::L, ActionBody::Value { operand, value }) => {
                    let elapsed = Expr { kind: ExprKind::Const(7), ty: Elementary::Time, span: statement.span };
                    let late = *qualifier == Qualifier::D;
                    binder.timed_row(ctx, &mut bound, moment, operand, value, (elapsed, late), statement.span);
                }
                _ => binder.row(ctx, &mut page, &mut bound, moment, &action),
            }
        }
        bound.finish()
    });
    Bound {
        active: show::statements(&code.active),
        leave: show::statements(&code.leave),
        after: show::statements(&code.expire),
        codes,
    }
}

/// In every call.
fn always() -> Moment {
    Moment::default()
}

/// At an event or with an interlock: I0.0.
fn conditional() -> Moment {
    Moment { condition: Some(input(0)), ..Moment::default() }
}

/// While I0.1 is not 1.
fn zeroed() -> Moment {
    Moment { zeroed: Some(input(1)), ..Moment::default() }
}

fn leaving() -> Moment {
    Moment { leaving: true, pulse: Some(input(2)), ..Moment::default() }
}

#[track_caller]
fn check(moment: &Moment, qualifier: Qualifier, text: &str, expected: [&str; 3]) {
    let bound = bind_rows(&[(qualifier, text)], moment);
    assert!(bound.codes.is_empty(), "{text}: {:?}", bound.codes);
    assert_eq!([&*bound.active, &*bound.leave, &*bound.after], expected, "{text}");
}

#[track_caller]
fn refused(qualifier: Qualifier, text: &str, code: &str) {
    assert_eq!(bind_rows(&[(qualifier, text)], &always()).codes, [code], "{text}");
}

/// Source: GRAPH reference D.6.
#[test]
fn standard_rows() {
    check(&always(), Qualifier::N, "M4.0;", ["M4.0 := BOOL#1", "M4.0 := BOOL#0", ""]);
    check(&conditional(), Qualifier::N, "M4.0;", ["M4.0 := I0.0", "M4.0 := BOOL#0", ""]);
    check(&always(), Qualifier::S, "#b;", ["S0.0 := BOOL#1", "", ""]);
    check(&conditional(), Qualifier::R, "#b;", ["if I0.0 {S0.0 := BOOL#0} else {}", "", ""]);
    check(
        &always(),
        Qualifier::D,
        "M4.0 := T#5s;",
        ["M4.0 := (GreaterEqual.TIME TIME#7 TIME#5000)", "M4.0 := BOOL#0", ""],
    );
    check(
        &conditional(),
        Qualifier::L,
        "M4.0 := #t;",
        ["M4.0 := (And.BOOL (Less.TIME TIME#7 S12.0) I0.0)", "M4.0 := BOOL#0", ""],
    );
}

#[test]
fn times() {
    let time = |text: &str| bind_rows(&[(Qualifier::D, text)], &always()).active;
    let compared = |time: &str| format!("M4.0 := (GreaterEqual.TIME TIME#7 {time})");
    assert_eq!(time("M4.0 := #d;"), compared("DINT->TIME(S4.0)"));
    assert_eq!(time("M4.0 := MD20;"), compared("DWORD->TIME(M20.0)"));
    assert_eq!(time("M4.0 := #s5;"), compared("S5TIME->TIME(S18.0)"));
    refused(Qualifier::D, "M4.0 := #i;", "P0575");
    refused(Qualifier::L, "M4.0 := 5;", "P0575");
    refused(Qualifier::L, "#i := T#5s;", "P0575");
}

/// While operands must be 0, N, D and L write 0, and nothing is called; S and R continue.
#[test]
fn zeroed_rows() {
    check(&zeroed(), Qualifier::N, "M4.0;", ["M4.0 := (not i0.1)", "M4.0 := BOOL#0", ""]);
    check(&zeroed(), Qualifier::S, "M4.0;", ["M4.0 := BOOL#1", "", ""]);
    check(&zeroed(), Qualifier::N, "FB7.DB7(x := 1);", ["if (not i0.1) {call FB 7} else {}", "", ""]);
    check(&zeroed(), Qualifier::N, "#i := 5;", ["S2.0 := INT#5", "", ""]);
}

/// S0: set in the call that leaves the step, 0 in the next.
#[test]
fn rows_of_the_end() {
    check(&leaving(), Qualifier::N, "M4.0;", ["", "M4.0 := BOOL#1", "if I0.2 {M4.0 := BOOL#0} else {}"]);
    check(&leaving(), Qualifier::S, "M4.0;", ["", "M4.0 := BOOL#1", ""]);
    check(&leaving(), Qualifier::N, "#i := 5;", ["", "S2.0 := INT#5", ""]);
}

#[test]
fn operands_are_cleared_once() {
    let rows = [(Qualifier::N, "M4.0;"), (Qualifier::D, "M4.1 := T#1s;"), (Qualifier::N, "M4.0;")];
    assert_eq!(bind_rows(&rows, &always()).leave, "M4.0 := BOOL#0; M4.1 := BOOL#0");
    let elements = [(Qualifier::N, "#a[#i];"), (Qualifier::N, "#a[2];"), (Qualifier::N, "#a[2];")];
    assert_eq!(bind_rows(&elements, &always()).leave, "S20.0[INT->DINT(S2.0) in 0..3 by 1] := BOOL#0; S20.2 := BOOL#0");
}

/// Source: GRAPH reference D.8: each event counts, also in consecutive calls.
#[test]
fn counters() {
    let pulse = |pins: &str| {
        format!("if I0.0 {{evaluate counter 5 {pins}=BOOL#0; evaluate counter 5 {pins}=BOOL#1}} else {{}}")
    };
    check(&conditional(), Qualifier::Cu, "C5;", [&pulse("CU"), "", ""]);
    check(&conditional(), Qualifier::Cd, "C5;", [&pulse("CD"), "", ""]);
    check(&conditional(), Qualifier::Cr, "C5;", ["if I0.0 {evaluate counter 5 R=BOOL#1} else {}", "", ""]);
    let set = |value: &str| {
        format!("if I0.0 {{evaluate counter 5 S=BOOL#0; evaluate counter 5 S=BOOL#1 PV={value}}} else {{}}")
    };
    for (text, value) in [("20", "WORD#32"), ("C#20", "WORD#32"), ("16#20", "WORD#32"), ("MW2", "M2.0")] {
        check(&conditional(), Qualifier::Cs, &format!("C5 := {text};"), [&set(value), "", ""]);
    }
    refused(Qualifier::Cs, "C5 := 1000;", "P0575");
    refused(Qualifier::Cs, "C5 := #i;", "P0575");
    refused(Qualifier::Cu, "T5;", "P0575");
    refused(Qualifier::Cu, "M4.0;", "P0575");
    refused(Qualifier::Cs, "C5;", "P0572");
    refused(Qualifier::Cu, "C5 := 3;", "P0572");
}

#[test]
fn timers() {
    let start = |kind: &str, value: &str| {
        format!("if I0.0 {{evaluate {kind} 5 S=BOOL#0; evaluate {kind} 5 S=BOOL#1 TV={value}}} else {{}}")
    };
    let (pulse, delay) = ("ExtendedPulse", "RetentiveOnDelay");
    check(&conditional(), Qualifier::Tl, "T5 := S5T#5s;", [&start(pulse, "S5TIME#1280"), "", ""]);
    check(&conditional(), Qualifier::Tl, "T5 := T#5s;", [&start(pulse, "TIME->S5TIME(TIME#5000)"), "", ""]);
    check(&conditional(), Qualifier::Td, "T5 := MW2;", [&start(delay, "M2.0"), "", ""]);
    check(&conditional(), Qualifier::Td, "T5 := #t;", [&start(delay, "TIME->S5TIME(S12.0)"), "", ""]);
    check(&conditional(), Qualifier::Tr, "T5;", ["if I0.0 {evaluate ExtendedPulse 5 R=BOOL#1} else {}", "", ""]);
    check(
        &always(),
        Qualifier::Tf,
        "T5 := S5T#5s;",
        ["evaluate OffDelay 5 S=BOOL#1 TV=S5TIME#1280", "evaluate OffDelay 5 S=BOOL#0 TV=S5TIME#1280", ""],
    );
    refused(Qualifier::Tl, "T5 := T#3h;", "P0575");
    refused(Qualifier::Tl, "T5 := 5;", "P0575");
    refused(Qualifier::Tl, "C5 := T#5s;", "P0575");
    refused(Qualifier::Tf, "T5;", "P0572");
}

#[test]
fn calls() {
    check(&conditional(), Qualifier::N, "FB7.DB7(x := 1, y := MW2);", ["if I0.0 {call FB 7} else {}", "", ""]);
    check(&always(), Qualifier::N, "FC5(x := 1, y := MW2, RET_VAL := #i);", ["S2.0 := FC 5()", "", ""]);
    check(&always(), Qualifier::N, "FC5(x := 1, y := MW2);", ["call FC 5", "", ""]);
    refused(Qualifier::S, "FC5(x := 1, y := MW2);", "P0572");
    refused(Qualifier::D, "FB7.DB7(x := 1);", "P0572");
    refused(Qualifier::N, "FC5.DB7(x := 1);", "P0572");
}

/// Source: GRAPH reference D.8.
#[test]
fn assignments() {
    check(&conditional(), Qualifier::N, "#i := #i + 1;", ["if I0.0 {S2.0 := (Add.INT S2.0 INT#1)} else {}", "", ""]);
    check(&always(), Qualifier::N, "MD20 := #r;", ["M20.0 := REAL->DWORD(S8.0)", "", ""]);
    check(&always(), Qualifier::N, "#r := MD20;", ["S8.0 := DWORD->REAL(M20.0)", "", ""]);
    check(&always(), Qualifier::N, "MD20 := 1.5;", ["M20.0 := DWORD#1069547520", "", ""]);
    check(&always(), Qualifier::N, "#b := NOT #c;", ["S0.0 := (not s0.1)", "", ""]);
    check(&always(), Qualifier::N, "MW2 := NEG(#i);", ["L0.0 := (negate s2.0); M2.0 := INT->WORD(L0.0)", "", ""]);
    check(
        &always(),
        Qualifier::N,
        "MD20 := NEGR(MD24);",
        ["L0.0 := (negate dword->real(m24.0)); M20.0 := REAL->DWORD(L0.0)", "", ""],
    );
    check(&always(), Qualifier::N, "#i := BCD_TO_NUM(MW2);", ["L0.0 := WORD->INT(M2.0); S2.0 := L0.0", "", ""]);
    check(&always(), Qualifier::N, "MW2 := NUM_TO_BCD(#i);", ["L0.0 := INT->WORD(S2.0); M2.0 := L0.0", "", ""]);
    check(&always(), Qualifier::N, "MW2 := SHL(IN := MW4, N := 3);", ["M2.0 := (ShiftLeft.WORD M4.0 INT#3)", "", ""]);
    refused(Qualifier::S, "#b := #c;", "P0572");
}

#[test]
fn operands() {
    refused(Qualifier::N, "#i;", "P0575");
    refused(Qualifier::N, "T5;", "P0575");
    refused(Qualifier::S, "16#20;", "P0575");
    refused(Qualifier::R, "C5;", "P0575");
}
