//! The same network gives the same graph in each form that SIMATIC SD allows.

use plcc_diag::FileId;
use plcc_readers::{ReadOptions, parse};
use plcc_syntax::ast::{Block, Code};
use plcc_syntax::network::ast::Content;
use plcc_syntax::{Language, network};

/// The graph of a network with these rungs, as text.
fn graph(language: &str, rungs: &str) -> String {
    let text = format!(
        "FUNCTION F : Void\n{{ S7_Language := \"{language}\" }}\nNETWORK\n{rungs}\nEND_NETWORK\nEND_FUNCTION\n"
    );
    let options = ReadOptions { language: Some(Language::Sd), ..ReadOptions::default() };
    let (unit, diagnostics) = parse(FileId(0), &text, &options);
    let errors: Vec<_> = diagnostics.iter().filter(|diagnostic| diagnostic.is_error()).collect();
    assert!(errors.is_empty(), "{rungs}: {errors:?}");
    let [Block::Code(block)] = unit.blocks.as_slice() else { panic!("{:?} is not a single block", unit.blocks) };
    let Code::Graphic(body) = &block.code else { panic!("{:?} is not a list of networks", block.code) };
    match &body.networks[0].content {
        Content::Graphic(graph) => network::text::graph(graph).join("\n"),
        other => panic!("{other:?} is not a graph"),
    }
}

#[track_caller]
fn same(language: &str, first: &str, second: &str) {
    let (first, second) = (graph(language, first), graph(language, second));
    assert!(!first.is_empty());
    assert_eq!(first, second);
}

#[test]
fn blanks_comments_and_letter_case_do_not_matter() {
    same(
        "LAD",
        "RUNG wire#powerrail\n    Contact( #Start )\n    wire#w1\n    I_Contact( #Stop )\n    Coil( #Motor )\nEND_RUNG\n\
         RUNG wire#powerrail\n    Contact( #Motor )\nEND_RUNG wire#w1",
        "rung wire#PowerRail contact(#Start)// a comment\nWIRE#other(* and\nanother *)i_contact(#Stop)coil(#Motor)end_rung \
         RUNG wire#powerrail Contact(#Motor) END_RUNG wire#Other",
    );
}

#[test]
fn the_dialects_of_v20_and_v21_give_equal_graphs() {
    same(
        "LAD",
        "RUNG wire#powerrail Contact( #on ) Move{ Card := 1; DisableENO := TRUE }( IN := 1, OUT1 => #n ) \
         Gt{ SrcType := Real }( IN1 := #x, IN2 := 2.0 ) Coil( #high ) END_RUNG",
        "RUNG wire#powerrail Contact( #on ) Move( in := 1, out1 => #n ) \
         { S7_Templates := \"SrcType := Real\" } GT_Contact( in1 := #x, in2 := 2.0 ) Coil( #high ) END_RUNG",
    );
    same(
        "LAD",
        "RUNG wire#powerrail #t.TON{ timeType := Time }( PT := T#2s, ET => ) \
         Add{ Card := 3; SrcType := Int; DisableENO := FALSE }( IN1 := #n, IN2 := 1, IN3 := 2, OUT => #n ) END_RUNG",
        "RUNG wire#powerrail { S7_Templates := \"time_type := Time\" } #t.TON( et => , pt := T#2s ) \
         { S7_Templates := \"SrcType := Int\"; S7_GenerateENO := \"TRUE\" } Add( out => #n, in3 := 2, in1 := #n, in2 := 1 ) END_RUNG",
    );
    same(
        "LAD",
        "RUNG wire#powerrail Convert{ inType := Int; outType := Real; DisableENO := TRUE }( IN := #n, OUT => #x ) END_RUNG",
        "RUNG wire#powerrail { S7_Templates := \"[SrcType := Int, DestType := Real]\" } Convert( in := #n, out => #x ) END_RUNG",
    );
}

#[test]
fn all_forms_of_a_flip_flop_are_one() {
    let long = "RUNG #a S_SR( operand := #state, r1 := #b ) Coil( #q ) END_RUNG";
    same("FBD", long, "RUNG #a #state.S_SR( #b ) Coil( #q ) END_RUNG");
    same("FBD", long, "RUNG SR( #state, #a, #b ) Coil( #q ) END_RUNG");
    same("FBD", long, "RUNG #a SR( operand := #state, r := #b ) Coil( #q ) END_RUNG");
    same("FBD", "RUNG #a S_RS( operand := #x, s1 := #b ) END_RUNG", "RUNG RS( #x, #a, #b ) END_RUNG");
}

#[test]
fn a_gate_without_pins_adds_nothing() {
    same("FBD", "RUNG #a A() P_Trig( #m ) Coil( #q ) END_RUNG", "RUNG #a P_Trig( #m ) Coil( #q ) END_RUNG");
    same("FBD", "RUNG #a NOT A() Coil( #q ) END_RUNG", "RUNG #a NOT Coil( #q ) END_RUNG");
    same(
        "LAD",
        "RUNG wire#powerrail Coil( #q ) END_RUNG",
        "RUNG wire#powerrail Coil( #q ) END_RUNG\nRUNG wire#powerrail END_RUNG",
    );
}

#[test]
fn switch_has_its_comparisons_in_both_forms() {
    same(
        "FBD",
        "RUNG #a A() { CASE0 := \"==\"; CASE1 := \">=\" } Switch( k := #k, case0 := 1, case1 := #m, dst0 => L1, dst1 => L2, else => IF ) END_RUNG",
        "RUNG #a A() Switch( k := #k, EQ 1 => L1, GE #m => L2, else => IF ) END_RUNG",
    );
}

#[test]
fn what_feeds_a_wire_inside_a_rung_comes_before_rungs_that_end_in_it() {
    let text = graph(
        "LAD",
        "RUNG wire#powerrail Contact( #a ) END_RUNG wire#w1\nRUNG wire#powerrail Contact( #b ) wire#w1 Coil( #q ) END_RUNG\n\
         RUNG wire#powerrail Contact( #c ) END_RUNG wire#w1",
    );
    assert!(text.contains("n1 = 1.out OR 0.out OR 3.out"), "{text}");
}

#[test]
fn not_inverts_the_pin_that_the_flow_enters() {
    assert_eq!(
        graph("FBD", "RUNG #a NOT O( in2 := #b ) NOT Coil( #q ) END_RUNG"),
        "O (in1 := NOT #a, in2 := #b, out => n0)\nCoil (in := NOT n0, operand => #q)\nn0 = 0.out"
    );
}

#[test]
fn the_end_of_a_network_tells_the_language_of_a_file() {
    let text = "FUNCTION F : Void\n{ S7_Language := \"LAD\" }\nNETWORK\nEND_NETWORK\nEND_FUNCTION\n";
    let (unit, diagnostics) = parse(FileId(0), text, &ReadOptions::default());
    assert!(diagnostics.is_empty(), "{diagnostics:?}");
    assert!(matches!(unit.blocks.as_slice(), [Block::Code(block)] if matches!(block.code, Code::Graphic(_))));
}
