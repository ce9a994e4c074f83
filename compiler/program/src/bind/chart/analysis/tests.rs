//! Charts with one step or transition per line: `*Fill: N #q; S #lamp`, `Fill > Stir, Heat : #full`, `Stir + Heat >> Fill` (a jump).

use plcc_diag::{FileId, Severity, Span};
use plcc_syntax::chart::ast::{Action, ActionBody, Body as Chart, Condition, Event, Qualifier, Step, Transition};
use plcc_syntax::scl::ast::{Expr, Name, NameForm};
use plcc_syntax::scl::fragment;
use rustc_hash::FxHashSet;

use super::{Facts, check};
use crate::bind::chart::index::Index;

fn expr(text: &str) -> Expr {
    fragment::expression(FileId(0), text, 0..text.len()).0
}

fn name(text: &str) -> Name {
    Name { text: text.trim().to_string(), form: NameForm::Bare, span: Span::default() }
}

fn names(text: &str) -> Vec<Name> {
    text.split([',', '+']).filter(|text| !text.trim().is_empty()).map(name).collect()
}

fn action(text: &str) -> Action {
    let (qualifier, operand) = text.trim().split_once(' ').unwrap();
    let (event, qualifier) = match qualifier.split_once('_') {
        Some((event, qualifier)) => (Event::of(event), qualifier),
        None => (None, qualifier),
    };
    let body = match operand.split_once(":=") {
        _ if operand == "S_ALL" => ActionBody::All { span: Span::default() },
        Some((operand, value)) => ActionBody::Value { operand: expr(operand.trim()), value: expr(value.trim()) },
        None => ActionBody::Operand(expr(operand)),
    };
    Action {
        event,
        qualifier: Qualifier::of(qualifier).unwrap(),
        interlock: false,
        qualifier_span: Span::default(),
        body,
        comment: None,
        span: Span::default(),
    }
}

fn chart(lines: &[&str]) -> Chart {
    let mut chart = Chart::default();
    for line in lines {
        let (head, tail) = line.split_once(" : ").map_or((*line, None), |(head, tail)| (head, Some(tail)));
        let Some((from, to)) = head.split_once('>') else {
            let (head, actions) = head.split_once(": ").unwrap_or((head, ""));
            chart.steps.push(Step {
                name: name(head.trim_start_matches('*')),
                number: chart.steps.len() as u32 + 1,
                initial: head.starts_with('*'),
                actions: actions.split(';').filter(|text| !text.is_empty()).map(action).collect(),
                interlock: None,
                supervision: None,
                maximum: None,
                warning: None,
                comment: Vec::new(),
                span: Span::default(),
            });
            continue;
        };
        let number = chart.transitions.len() as u32 + 1;
        chart.transitions.push(Transition {
            name: name(&format!("T{number}")),
            number,
            from: names(from),
            to: names(to.trim_start_matches('>')),
            jump: to.starts_with('>'),
            path: Vec::new(),
            condition: tail.map(|text| Condition::Expression(expr(text.trim()))),
            missing: false,
            comment: Vec::new(),
            span: Span::default(),
        });
    }
    chart
}

/// Codes of a chart whose block has these parameters and temporary data; warnings in parentheses.
fn codes_of(chart: &Chart, parameters: &[&str], temporary: &[&str]) -> Vec<String> {
    let set = |names: &[&str]| names.iter().map(|name| name.to_string()).collect::<FxHashSet<String>>();
    let facts = Facts { parameters: set(parameters), temporary: set(temporary), symbol: &|_| None };
    let messages = check(chart, Span::default(), &Index::new(chart), &facts);
    let code = |message: &plcc_diag::Diagnostic| {
        assert!(message.help.is_some() && !message.primary.text.is_empty(), "{message:?}");
        match message.severity {
            Severity::Warning => format!("({})", message.code.name()),
            _ => message.code.name().to_string(),
        }
    };
    messages.iter().map(code).collect()
}

fn codes(lines: &[&str]) -> Vec<String> {
    codes_of(&chart(lines), &[], &[])
}

fn manual(lines: &[&str]) -> Vec<String> {
    codes_of(&chart(lines), &["sw_man"], &[])
}

const NONE: [&str; 0] = [];

#[test]
fn usual_charts_are_right() {
    assert_eq!(codes(&["*A", "B", "A > B", "B >> A"]), NONE);
    // Two doses, then mixing. Source: GRAPH reference H.2.
    let doses = [
        "*S1",
        "S2: N %Q1.0",
        "S3: N %Q1.1",
        "S4",
        "S5",
        "S6: N %Q1.2",
        "S1 > S2, S3 : %I1.0",
        "S2 > S4 : %I1.1",
        "S3 > S5 : %I1.2",
        "S4 + S5 > S6 : TRUE",
        "S6 >> S1 : S006.T >= T#2S",
    ];
    assert_eq!(codes(&doses), NONE);
    // Source: GRAPH reference H.1.
    let starter = [
        "*Off",
        "StarCW: N %Q0.1",
        "DeltaCW: N %Q0.1",
        "StarCCW: N %Q0.2",
        "DeltaCCW: N %Q0.2",
        "Off > StarCW : %I0.1 AND NOT %I0.2 AND %I0.0",
        "StarCW >> Off : NOT %I0.0 OR NOT %I0.5",
        "StarCW > DeltaCW : %M0.0",
        "DeltaCW >> Off : NOT %I0.0 OR NOT %I0.5",
        "Off > StarCCW : %I0.2 AND NOT %I0.1 AND %I0.0",
        "StarCCW >> Off : NOT %I0.0 OR NOT %I0.5",
        "StarCCW > DeltaCCW : %M0.0",
        "DeltaCCW >> Off : NOT %I0.0 OR NOT %I0.5",
    ];
    assert_eq!(codes(&starter), NONE);
    assert_eq!(manual(&starter), NONE);
    assert_eq!(codes(&["*A", "*B", "A > ", "B > "]), NONE, "two sequencers");
}

#[test]
fn names_numbers_and_limits() {
    assert_eq!(codes(&["*A", "a", "A > A : #x", "A > "]), ["P0550"]);
    let mut twice = chart(&["*A", "B", "A > B", "B >> A"]);
    twice.steps[1].number = 1;
    assert_eq!(codes_of(&twice, &[], &[]), ["P0550"]);
    twice.steps[1].number = 0;
    assert_eq!(codes_of(&twice, &[], &[]), ["P0551"]);
    assert_eq!(
        codes(&[
            "*A",
            "TheNameOfThisStepIsTooLong",
            "A > TheNameOfThisStepIsTooLong",
            "TheNameOfThisStepIsTooLong >> A"
        ]),
        ["P0551"]
    );
    assert_eq!(codes(&["*A", "Fill", "A > Fil", "Fill >> A"]), ["P0552"]);
    let many: Vec<String> = (0..300).flat_map(|n| [format!("*S_{n}"), format!("S_{n} > ")]).collect();
    let many: Vec<&str> = many.iter().map(String::as_str).collect();
    assert_eq!(codes(&many), ["P0551", "P0551", "P0551"], "steps, transitions and sequencers");
}

#[test]
fn beginnings_and_ends() {
    assert_eq!(codes(&["A", "B", "A > B", "B >> A"]), ["P0553"]);
    assert_eq!(manual(&["A", "B", "A > B", "B >> A"]), ["P0553"]);
    let second = ["*A: S1_ON C", "B", "C", "D", "A > B", "B >> A", "C > D", "D >> C"];
    assert_eq!(codes(&second), NONE, "started by ON");
    let second = ["*A", "B", "C", "D", "A > B", "B >> A", "C > D", "D >> C"];
    assert_eq!(codes(&second), ["P0553"]);
    assert_eq!(codes(&["*A", "B", "A >> A", "B > A"]), ["(P0562)", "P0554"]);
    assert_eq!(manual(&["*A", "B", "A >> A", "B > A"]), ["(P0562)", "(P0554)"]);
    assert_eq!(codes(&["*A", "B", "C", "A >> A", "B > C", "C >> B : #x", "C > A"]), ["(P0562)", "(P0554)"]);
    assert_eq!(codes(&["*A", "B", "A > "]), ["P0554"]);
    assert_eq!(codes(&["*A", "*B", "A > B", "B >> A"]), ["P0555"]);
    assert_eq!(codes(&["*A", "B", "A > B"]), ["(P0556)"]);
    assert_eq!(codes(&["*A", "B: S1_OFF B", "A > B"]), NONE, "switched off by a row");
}

#[test]
fn initial_steps_in_simultaneous_paths() {
    assert_eq!(codes(&["*A", "*B", "C", "D", "A > C", "B > D", "C + D >> A, B"]), NONE);
    assert_eq!(codes(&["*A", "*B", "C", "A > B, C", "B + C >> A"]), ["P0555"]);
}

#[test]
fn single_transitions() {
    assert_eq!(codes(&["*A", "B", "A > B", "B >> A", " > B"]), ["P0557"]);
    let mut gap = chart(&["*A", "B", "A > B", "B >> A"]);
    gap.transitions[0].missing = true;
    assert_eq!(codes_of(&gap, &[], &[]), ["P0558"]);
    assert_eq!(codes(&["*A", "B", "A > B", "B > A"]), ["(P0563)"]);
    assert_eq!(codes(&["*A", "B", "A > B : #x", "B > B : #y", "B >> A : #z"]), ["(P0564)"]);
    let into_a_circle = ["*A", "B", "C", "D", "A >> C", "B > C", "C > D", "D >> B"];
    assert_eq!(codes(&into_a_circle), NONE, "each circle has its jump");
    let parallel = ["*A", "B", "C", "D", "E", "A > B, C", "B > D", "C > E", "D + E >> A"];
    assert_eq!(codes(&parallel), NONE);
}

#[test]
fn conditions() {
    assert_eq!(codes(&["*A", "B", "A > B : #x AND NOT #x", "B >> A"]), ["(P0560)"]);
    assert_eq!(codes(&["*A", "B", "A > B : #x OR TRUE", "B >> A : TRUE"]), ["(P0560)"]);
    assert_eq!(codes(&["*A", "B", "C", "A > B : #x", "A > C : #x", "B >> A", "C >> A"]), ["(P0561)"]);
    assert_eq!(codes(&["*A", "B", "C", "A > B : #x", "A > C : #x AND #y", "B >> A", "C >> A"]), ["(P0561)"]);
    assert_eq!(codes(&["*A", "B", "C", "A > B", "A > C : #y", "B >> A", "C >> A"]), ["(P0561)"]);
    assert_eq!(codes(&["*A", "B", "C", "A > B : #x AND #y", "A > C : #x", "B >> A", "C >> A"]), NONE, "by priority");
    assert_eq!(codes(&["*A", "B", "C", "A > B : #x", "A > C : #y", "B >> A", "C >> A"]), NONE);
    let other = chart(&["*A", "B", "A > B : #t AND #x", "B >> A"]);
    assert_eq!(codes_of(&other, &[], &["t"]), ["(P0578)"]);
}

/// Two paths, each of two steps, and the step after them.
const PATHS: [&str; 6] = ["*A", "B", "C", "D", "E", "F"];

fn paths(transitions: &[&'static str]) -> Vec<&'static str> {
    PATHS.iter().chain(transitions).copied().collect()
}

#[test]
fn unsafe_branches() {
    let merged = ["*A", "B", "C", "D", "A > B, C", "B > D", "C > D", "D >> A"];
    assert_eq!(codes(&merged), ["P0567"]);
    assert_eq!(manual(&merged), ["(P0567)"]);
    assert_eq!(codes(&["*A: S1_OFF S_ALL", "B", "C", "D", "A > B, C", "B > D", "C > D", "D >> A"]), NONE);
    let guarded = ["*A", "B", "C", "D", "A > B, C", "B > D : NOT D.X AND NOT C.X", "C > D", "D >> A"];
    assert_eq!(codes(&guarded), ["(P0567)"], "the condition may keep them apart");
}

#[test]
fn jumps_out_of_branches() {
    let good = ["A > B, C", "B > D", "C > E", "D + E > F", "F >> A"];
    assert_eq!(codes(&paths(&good)), NONE);
    assert_eq!(codes(&paths(&["A > B, C", "B > D : #x", "C > E", "D + E > F", "F >> A", "B >> A : #y"])), ["(P0568)"]);
    assert_eq!(codes(&paths(&["A > B, C : #x", "B > D", "C > E", "D + E > F", "F >> A", "A >> D : #y"])), ["(P0568)"]);
    assert_eq!(codes(&paths(&["A > B, C", "B > D : #x", "C > E", "D + E > F", "F >> A", "B >> E : #y"])), ["(P0568)"]);
    let abandoned = [
        "*A",
        "B",
        "C",
        "D",
        "E",
        "F: S1_OFF S_ALL",
        "A > B, C",
        "B > D : #x",
        "C > E",
        "D + E > F",
        "F >> A",
        "B >> A : #y",
    ];
    assert_eq!(codes(&abandoned), ["(P0568)"]);
    let over_a_step = [
        "*A",
        "B",
        "C",
        "D",
        "E",
        "F: S1_OFF S_ALL",
        "A > B, C",
        "B > D : #x",
        "C > E",
        "D + E >> A",
        "B >> F : #y",
        "F >> A",
    ];
    assert_eq!(codes(&over_a_step), NONE, "the step on the way out switches off all paths");
}

#[test]
fn a_jump_into_another_sequencer() {
    let jump = ["*A", "B", "*M", "N", "A > B", "B >> A : #x", "B >> N : #y", "M > N", "N >> M"];
    assert_eq!(codes(&jump), ["(P0567)"], "the other one runs on");
}

#[test]
fn dead_joins() {
    let alternative = ["*A", "B", "C", "D", "A > B : #x", "A > C : #y", "B + C > D", "D >> A"];
    assert_eq!(codes(&alternative), ["P0569"]);
    assert_eq!(manual(&alternative), ["(P0569)"]);
    let ends = paths(&["A > B, C", "B > D : #x", "B > : #y", "C > E", "D + E > F", "F >> A"]);
    assert_eq!(codes(&ends), NONE, "one of two ways ends");
}

#[test]
fn a_chart_that_is_too_large_to_search() {
    let (paths, length) = (8, 30);
    let mut lines = vec!["*A".to_string(), "Z".to_string()];
    let step = |path: usize, at: usize| format!("P{path}_{at}");
    for path in 0..paths {
        lines.extend((0..length).map(|at| step(path, at)));
        lines.extend((1..length).map(|at| format!("{} > {}", step(path, at - 1), step(path, at))));
    }
    let all = |at: usize| (0..paths).map(|path| step(path, at)).collect::<Vec<_>>().join("+");
    lines.push(format!("A > {}", all(0)));
    let join = format!("{} > Z", all(length - 1));
    let with = |more: &[String]| {
        let lines: Vec<&str> = lines.iter().chain(more).map(String::as_str).collect();
        codes(&lines)
    };
    assert_eq!(with(&[join, "Z >> A".to_string()]), NONE);
    // The last steps are joined in two halves.
    let half = |from: usize| (from..from + 4).map(|path| step(path, length - 1)).collect::<Vec<_>>().join("+");
    let halves = [format!("{} > Z", half(0)), format!("{} > Z", half(4)), "Z >> A".to_string()];
    assert_eq!(with(&halves), ["(P0567)"]);
}

#[test]
fn operands() {
    let both = ["*A", "B: N #q", "C: N #Q", "D", "A > B, C", "B + C > D", "D >> A"];
    assert_eq!(codes(&both), ["(P0570)"]);
    let fight = ["*A: R #q", "B: S #q", "C: R #Q", "A > B, C", "B + C >> A"];
    assert_eq!(codes(&fight), ["(P0570)"]);
    let apart = ["*A: N #q", "B: N #q", "A > B", "B >> A"];
    assert_eq!(codes(&apart), NONE);
    assert_eq!(codes(&["*A", "B: S %Q0.1", "A > B", "B >> A"]), ["(P0577)"]);
    assert_eq!(codes(&["*A: R %Q0.1", "B: S %Q0.1", "A > B", "B >> A"]), NONE);
    assert_eq!(codes(&["*A: N %QB0 := 0", "B: S %Q0.1", "A > B", "B >> A"]), NONE, "written with its byte");
    assert_eq!(codes(&["*A: R #lamp.on", "B: S #lamp.on; S #lamp.red", "A > B", "B >> A"]), ["(P0577)"]);
}

#[test]
fn a_broken_chart_has_no_mistakes_that_follow() {
    let mut broken = chart(&["A", "B", "A > C", " > B"]);
    broken.broken = true;
    assert_eq!(codes_of(&broken, &[], &[]), NONE);
}

#[test]
fn no_chart_at_all() {
    assert_eq!(codes(&[]), ["P0553"]);
}
