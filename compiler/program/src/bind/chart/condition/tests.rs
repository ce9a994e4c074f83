use plcc_syntax::scl::ast::StatementKind as TreeKind;

use plcc_syntax::network::ast::Language;

use crate::bind::chart::testing::in_block;
use crate::bind::network::Page;
use crate::bind::notation::network;
use crate::bind::scl::tests::show;

/// Statements and condition of an ST condition.
#[track_caller]
fn check(text: &str, expected: &str) {
    let (code, codes) = in_block(text, |binder, ctx, list| binder.condition_statements(ctx, list, "the transition"));
    let (statements, value) = code.unwrap_or_else(|| panic!("{text}: {codes:?}"));
    assert!(codes.is_empty(), "{text}: {codes:?}");
    assert_eq!(format!("{}|{}", show::statements(&statements), show::expr(&value)), expected, "{text}");
}

#[track_caller]
fn refused(text: &str, code: &str) {
    let (_, codes) = in_block(text, |binder, ctx, list| binder.condition_statements(ctx, list, "the transition"));
    assert_eq!(codes, [code], "{text}");
}

#[test]
fn statements() {
    check("#b AND #c;", "|(And.BOOL S0.0 S0.1)");
    check("#i = 3;", "|(Equal.INT S2.0 INT#3)");
    check("#i := #i + 1; #i > 5;", "S2.0 := (Add.INT S2.0 INT#1)|(Greater.INT S2.0 INT#5)");
    check("Opened := #b;", "|S0.0");
    check("T5;", "|Timer5");
    check("TRUE;", "|BOOL#1");
    refused("#b := #c;", "P0559");
    refused("#i + 1;", "P0559");
    refused("IF #b THEN RETURN; END_IF; #b;", "P0535");
    refused("IF #b THEN #i := 1; END_IF;", "P0559");
}

#[test]
fn networks() {
    let bind = |lines: &[&str]| {
        in_block("", |binder, ctx, _| {
            let mut page = Page::new(ctx);
            let network = network(Language::Lad, lines);
            binder
                .condition_network(ctx, &mut page, &network, "the transition")
                .map(|(statements, value)| format!("{}|{}", show::statements(&statements), show::expr(&value)))
        })
    };
    let series = ["rail < Contact #b > w1", "w1 < Contact #c > w2", "w2 < ConditionCoil"];
    assert_eq!(bind(&series), (Some("L0.0 := S0.0; L2.0 := (And.BOOL L0.0 S0.1)|L2.0".to_string()), vec![]));
    assert_eq!(bind(&["rail < Contact #b > w1", "w1 < Coil #c"]), (None, vec!["P0558"]));
    assert_eq!(bind(&[]), (None, vec!["P0558"]));
    let two = ["rail < Contact #b > w1", "w1 < ConditionCoil", "w1 < ConditionCoil"];
    assert_eq!(bind(&two), (None, vec!["P0535"]));
}

#[test]
fn types() {
    let bind = |text: &str| {
        in_block(text, |binder, ctx, list| {
            let TreeKind::Expression(node) = &list[0].kind else { panic!("the test is an expression") };
            binder.condition_value(ctx, node, "the transition").map(|value| show::expr(&value))
        })
    };
    assert_eq!(bind("NOT I0.0;"), (Some("(not i0.0)".to_string()), vec![]));
    for text in ["MW2;", "5;", "T#5s;", "#a;"] {
        assert_eq!(bind(text), (None, vec!["P0559"]), "{text}");
    }
}
