//! Pictures of charts: branches, joins and arrows.

use std::fs;

use crate::plcc;

/// The picture of a chart with these transitions: the steps before and after each.
fn chart(steps: usize, transitions: &[(&str, &str)]) -> String {
    let mut source = "FUNCTION_BLOCK FB1\nVAR_INPUT\n  go : BOOL;\nEND_VAR\n".to_string();
    for number in 1..=steps {
        let word = if number == 1 { "INITIAL_STEP" } else { "STEP" };
        source.push_str(&format!("{word} At{number} (*$_NUM {number}*):\nEND_STEP\n"));
    }
    for (at, (from, to)) in transitions.iter().enumerate() {
        let number = at + 1;
        let frame = format!("TRANSITION T{number} (*$_NUM {number}*)\n  FROM {from}\n  TO {to}\n");
        source.push_str(&frame);
        source.push_str("CONDITION := #go\nEND_TRANSITION\n");
    }
    source.push_str("END_FUNCTION_BLOCK\n");
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("chart.gr7"), source).expect("the folder can be written");
    let output = plcc(&folder, &["view", "chart.gr7", "-o", "pictures"]);
    let messages = String::from_utf8_lossy(&output.stderr);
    fs::read_to_string(folder.path().join("pictures/FB_1.svg")).unwrap_or_else(|_| panic!("{messages}"))
}

/// The texts at the arrows of a chart.
fn arrows(steps: usize, transitions: &[(&str, &str)]) -> Vec<String> {
    let picture = chart(steps, transitions);
    let texts = picture.lines().filter(|line| line.starts_with("<text class=\"m\""));
    texts.filter_map(|line| Some(line.split_once('>')?.1.trim_end_matches("</text>").to_string())).collect()
}

/// The leftmost way ends at an arrow, and the others come together on the right of it.
#[test]
fn what_follows_a_join_is_below_it() {
    let transitions = [
        ("At1", "At2"),
        ("At1", "At3"),
        ("At1", "At1 (*$_JUMP*)"),
        ("At2", "At4"),
        ("At3", "At4"),
        ("At4", "(At5, At6)"),
        ("(At5, At6)", "At1 (*$_JUMP*)"),
    ];
    let picture = chart(6, &transitions);
    let place = |step: &str| {
        let line = picture.lines().find(|line| line.contains(&format!(">{step}</text>")));
        let line = line.unwrap_or_else(|| panic!("{step} in {picture}"));
        let x = line.split(" x=\"").nth(1).and_then(|rest| rest.split('"').next());
        x.and_then(|x| x.parse::<i32>().ok()).expect("a text has a place")
    };
    assert!(place("At4") > place("At1"), "{picture}");
    assert_eq!(place("At4"), place("At5"), "{picture}");
}

/// A step whose name is its number is named once.
#[test]
fn an_arrow_names_a_step_once() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION_BLOCK FB1\nINITIAL_STEP S1 (*$_NUM 1*):\nEND_STEP\nSTEP S2 (*$_NUM 2*):\nEND_STEP\nTRANSITION T1 (*$_NUM 1*)\n  \
                  FROM S1\n  TO S2\nCONDITION := I0.0\nEND_TRANSITION\nTRANSITION T2 (*$_NUM 2*)\n  FROM S2\n  TO S1 (*$_JUMP*)\n\
                  CONDITION := I0.1\nEND_TRANSITION\nEND_FUNCTION_BLOCK\n";
    fs::write(folder.join("chart.gr7"), source).expect("the folder can be written");
    let output = plcc(folder, &["view", "chart.gr7", "-o", "pictures"]);
    let picture = fs::read_to_string(folder.join("pictures/FB_1.svg"));
    let picture = picture.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    assert_eq!(picture.matches(">S1<").count(), 2, "{picture}");
}

/// Two transitions join the same paths, and their ways come together again.
#[test]
fn alternatives_after_a_join_need_no_arrows() {
    let transitions = [
        ("At1", "(At2, At3)"),
        ("(At2, At3)", "At4"),
        ("(At3, At2)", "At5"),
        ("At4", "At5"),
        ("At5", "At1 (*$_JUMP*)"),
    ];
    assert_eq!(arrows(5, &transitions), ["S1 At1"]);
}

/// Both ways to At5 are lines, so the one from At4 to At6 would cross them and is an arrow; the one from At5 to At6 is a line.
#[test]
fn a_way_that_crosses_is_one_arrow() {
    let transitions = [
        ("At1", "At2"),
        ("At1", "At3"),
        ("At2", "At4"),
        ("At2", "At5"),
        ("At3", "At5"),
        ("At4", "At6"),
        ("At5", "At6"),
        ("At6", "At1 (*$_JUMP*)"),
    ];
    assert_eq!(arrows(6, &transitions), ["S6 At6", "S1 At1"]);
}
