use plcc_diag::{Code, FileId, Span};
use plcc_syntax::network::ast::{Body, Language, Network};
use plcc_syntax::scl::ast::{Name, NameForm};

use super::{block_warnings, legality};
use crate::bind::notation::network;

fn codes(language: Language, lines: &[&str]) -> Vec<&'static str> {
    let mut messages = Vec::new();
    legality(&network(language, lines), &mut messages);
    for message in &messages {
        assert!(message.help.is_some() && !message.primary.text.is_empty() && message.note.is_some(), "{message:?}");
    }
    messages.iter().map(|message| message.code.name()).collect()
}

fn lad(lines: &[&str]) -> Vec<&'static str> {
    codes(Language::Lad, lines)
}

fn fbd(lines: &[&str]) -> Vec<&'static str> {
    codes(Language::Fbd, lines)
}

#[test]
fn what_editors_export_is_legal() {
    let none: [&str; 0] = [];
    assert_eq!(lad(&[]), none);
    assert_eq!(lad(&["rail < Coil #q"]), none, "a coil on the rail");
    assert_eq!(
        lad(&["rail < Contact #a > w1", "rail < Contact #q > w1", "w1 < I_Contact #b > w2", "w2 < Coil #q"]),
        none
    );
    assert_eq!(lad(&["rail < #t.TON pt=T#1s et="]), none, "outputs that nobody uses");
    assert_eq!(lad(&["rail < Contact #a > w1", "w1 < Add in1=1 in2=2 out=#x > w2"]), none);
    assert_eq!(lad(&["rail < Contact #a > w1", "w1 < S_SR operand=#m r1=w1"]), none);
    assert_eq!(lad(&["rail < EQ in1=1 in2=2 out=#x"]), none, "a comparison with an operand");
    assert_eq!(lad(&["rail < Contact #a > w1", "w1 < JumpCoil label=END"]), none);
    assert_eq!(fbd(&["#a < A > w1", "w1 < Coil #q"]), none, "an AND that passes on");
    assert_eq!(fbd(&["A in1=#a in2=#b > w1", "w1 < Coil #q"]), none);
    assert_eq!(fbd(&["Move in=1 out1=#x"]), none, "EN may be open in FBD");
}

#[test]
fn branches() {
    assert_eq!(lad(&["rail < Contact #a > w1", "rail < > w1", "w1 < Coil #q"]), ["P0531"]);
    assert_eq!(
        lad(&["rail < Contact #a > w1", "w1 < Contact #b > w2", "w1 < > w2", "w2 < Coil #q"]),
        ["P0531"],
        "a bridge over b"
    );
    assert_eq!(
        lad(&["rail < Contact #a > w1", "w1 < Contact #b > w2", "w2 < Contact #c > w1", "w2 < Coil #q"]),
        ["P0532"]
    );
    assert_eq!(lad(&["rail < Contact #a > w1", "w1 < Coil #q", "w1 < Contact #b > w2"]), ["P0533"]);
    assert_eq!(lad(&["w9 < Contact #a > w1", "w1 < Coil #q"]), ["P0534"]);
    assert_eq!(lad(&["Contact #a > w1", "w1 < Coil #q"]), ["P0534"]);
    assert_eq!(fbd(&["#a < > w1", "w1 < Coil #q"]), [""; 0], "FBD may name a wire twice");
}

#[test]
fn places() {
    assert_eq!(lad(&["rail < Contact #a > w1", "w1 < Contact #b"]), ["P0535"]);
    assert_eq!(lad(&["rail < Contact #a > w1", "w1 < EQ_Contact in1=1 in2=2"]), ["P0535"]);
    assert_eq!(lad(&["rail < Not > w1", "w1 < Coil #q"]), ["P0535"]);
    assert_eq!(lad(&["rail < Contact #a > w1", "w1 < JumpCoil label=END", "w1 < Coil #q"]), ["P0535"]);
    assert_eq!(lad(&["rail < Contact #a > w1", "w1 < JumpCoil label=A1", "w1 < JumpCoil label=A2"]), ["P0535"]);
}

#[test]
fn pins() {
    assert_eq!(lad(&["rail < Contact > w1", "w1 < Coil #q"]), ["P0204"]);
    assert_eq!(lad(&["rail < Contact operand= > w1", "w1 < Coil #q"]), ["P0204"]);
    assert_eq!(lad(&["rail < Contact #a > w1", "w1 < JumpCoil"]), ["P0204"]);
    assert_eq!(lad(&["rail < P_Contact operand=#a > w1", "w1 < Coil #q"]), ["P0204"]);
    assert_eq!(lad(&["rail < Sub in1=1 out=#x"]), ["P0312"]);
    assert_eq!(lad(&["rail < #t.TON et="]), ["P0312"]);
    assert_eq!(lad(&["rail < Sub in1=1 in2=2 in2=3 out=#x"]), ["P0313"]);
    assert_eq!(fbd(&["#t.TON pt=T#1s"]), ["P0540"]);
    assert_eq!(fbd(&["Coil #q"]), ["P0540"]);
}

#[test]
fn gates() {
    assert_eq!(fbd(&["#a < O > w1", "w1 < Coil #q"]), ["P0540"]);
    assert_eq!(fbd(&["#a < A in2= > w1", "w1 < Coil #q"]), ["P0540"]);
    assert_eq!(fbd(&["#a < A in2=#b"]), ["P0540"]);
    assert_eq!(fbd(&["#a < A in2=w1 > w1", "w1 < Coil #q"]), ["P0532"]);
    assert_eq!(fbd(&["w1 < > w1"]), ["P0532"]);
    assert_eq!(fbd(&["Neg in=#a out=w1", "Neg in=#b out=w1", "Move in=w1 out1=#c"]), ["P0538"]);
}

#[test]
fn long_networks_are_checked_without_recursion() {
    let mut lines: Vec<String> = (0..3000).map(|at| format!("w{at} < Contact #x > w{}", at + 1)).collect();
    lines.push("w3000 < Contact #y > w0".to_string());
    let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    assert_eq!(lad(&lines), ["P0532"]);
}

fn body(networks: &[&[&str]]) -> Body {
    let networks = networks.iter().enumerate().map(|(at, lines)| {
        let (label, lines) = match lines.split_first() {
            Some((first, rest)) if first.ends_with(':') => (Some(first.trim_end_matches(':')), rest),
            _ => (None, *lines),
        };
        let name = |text: &str| Name { text: text.to_string(), form: NameForm::Bare, span: place(at) };
        Network { labels: label.map(name).into_iter().collect(), ..network(Language::Lad, lines) }
    });
    Body { networks: networks.collect() }
}

fn place(at: usize) -> Span {
    Span::new(FileId(0), at..at + 1)
}

fn warnings(networks: &[&[&str]]) -> Vec<Code> {
    block_warnings(&body(networks)).iter().map(|message| message.code).collect()
}

#[test]
fn two_coils_on_an_operand() {
    let first: &[&str] = &["rail < Contact #a > w1", "w1 < Coil \"Lamp\""];
    assert_eq!(warnings(&[first, &["rail < Contact #b > w1", "w1 < Coil \"LAMP\""]]), [Code::DoubleCoil]);
    assert_eq!(warnings(&[first, &["rail < Contact #b > w1", "w1 < S_Coil \"Lamp\""]]), []);
    assert_eq!(warnings(&[first, &["rail < Contact #b > w1", "w1 < JumpCoil label=X"], first]), [], "one or the other");
    assert_eq!(warnings(&[first, &["X:", "rail < Coil \"Lamp\""]]), []);
    let local: &[&str] = &["rail < Contact \"a\" > w1", "w1 < Coil #t"];
    assert_eq!(warnings(&[local, local]), [Code::DoubleCoil]);
    assert_eq!(warnings(&[local, &["rail < Contact #t > w1", "w1 < Coil \"b\""], local]), [], "used in between");
    let indexed: &[&str] = &["rail < Contact #a > w1", "w1 < Coil #x[#i]"];
    assert_eq!(warnings(&[indexed, indexed]), []);
    let element: &[&str] = &["rail < Contact #a > w1", "w1 < Coil #x[3]"];
    assert_eq!(warnings(&[element, element]), [Code::DoubleCoil]);
}

#[test]
fn shared_edge_bits_and_instances() {
    let edge: &[&str] = &["rail < P_Contact operand=#a bit=#m > w1", "w1 < S_Coil #q"];
    let other: &[&str] = &["rail < P_Contact operand=#a bit=#n > w1", "w1 < S_Coil #q"];
    assert_eq!(warnings(&[edge, edge]), [Code::EdgeBit]);
    assert_eq!(warnings(&[edge, other]), []);
    let timer: &[&str] = &["rail < #t.TON pt=T#1s"];
    assert_eq!(warnings(&[timer, timer]), [Code::InstanceUse]);
    assert_eq!(warnings(&[timer, &["rail < #u.TON pt=T#1s"]]), []);
}
