//! Charts: GRAPH becomes SFC, which does the same or is refused.

use std::fs;
use std::path::{Path, PathBuf};

use plcc_driver::inputs::TestInput;
use plcc_tests::tests_folder;

use super::same::{NUMBERS, around, converts_to_the_same, project_of};
use super::{passes, project_document};
use crate::{everything, has_errors};

/// Simultaneous and alternative paths that begin and end together, jumps, each kind of action.
const CHART: &str = r##"FUNCTION_BLOCK "Line"
(*$_CMPSET
   FBInterface: Minimum
*)
VAR_INPUT
  start : BOOL;
  full_a : BOOL;
  full_b : BOOL;
  ready : BOOL;
  skip : BOOL;
END_VAR
VAR_OUTPUT
  valve_a : BOOL;
  valve_b : BOOL;
  mixer : BOOL;
  lamp : BOOL;
  late : BOOL;
  pulse : BOOL;
  kept : BOOL;
  begun : BOOL;
  count : INT;
  calls : INT;
  idle_time : TIME;
END_VAR
VAR
  pause : TIME := T#300ms;
END_VAR
INITIAL_STEP Idle (*$_NUM 1*):
(*$_COM waits for start*)
#idle_time := Idle.T   (N)
#begun   (S0_S)
END_STEP
STEP "Fill A" (*$_NUM 2*):
#valve_a   (N)
#count := #count + 1   (S1_N)
END_STEP
STEP FillB (*$_NUM 3*):
#valve_b   (N)
END_STEP
STEP WaitA (*$_NUM 4*):
END_STEP
STEP WaitB (*$_NUM 5*):
#begun   (S1_R)
END_STEP
STEP Mix (*$_NUM 6*):
#mixer   (N)
#late := T#100MS   (D)
#kept   (S)
CALL "Calls" (IN := #calls, RET_VAL := #calls)   (N)
END_STEP
STEP Empty (*$_NUM 7*):
#lamp := #pause   (L)
#pulse   (S0_N)
END_STEP
STEP Clean (*$_NUM 8*):
#kept   (R)
#valve_a   (N)
END_STEP
TRANSITION Again (*$_NUM 10*)
  FROM Clean
  TO Idle (*$_JUMP*)
CONDITION := NOT #start
END_TRANSITION
TRANSITION Back (*$_NUM 9*)
  FROM Empty
  TO Idle (*$_JUMP*)
CONDITION := Empty.U >= #pause
END_TRANSITION
TRANSITION Cleaning (*$_NUM 8*)
  FROM Empty
  TO Clean
CONDITION := #skip AND NOT #ready
END_TRANSITION
TRANSITION Mixed (*$_NUM 7*)
  FROM Mix
  TO Empty
CONDITION := S006.T >= T#200MS OR #skip
END_TRANSITION
TRANSITION Skipped (*$_NUM 6*)
  FROM (WaitA, WaitB)
  TO Empty
CONDITION := #skip
END_TRANSITION
TRANSITION Both (*$_NUM 5*)
  FROM (WaitA, WaitB)
  TO Mix
CONDITION := #ready
END_TRANSITION
TRANSITION Full_B (*$_NUM 4*)
  FROM FillB
  TO WaitB
CONDITION := #full_b
END_TRANSITION
TRANSITION Full_A (*$_NUM 3*)
  FROM "Fill A"
  TO WaitA
CONDITION := #full_a AND "Fill A".T >= T#50MS
END_TRANSITION
TRANSITION Stop (*$_NUM 2*)
  FROM Idle
  TO Clean
CONDITION := NOT #start AND #skip
END_TRANSITION
TRANSITION Go (*$_NUM 1*)
  FROM Idle
  TO ("Fill A", FillB)
CONDITION := #start
END_TRANSITION
END_FUNCTION_BLOCK
"##;

/// A function that the chart calls.
const CALLS: &str = r##"
FUNCTION "Calls" : INT
VAR_INPUT
  IN : INT;
END_VAR
BEGIN
  #Calls := #IN + 1;
END_FUNCTION
"##;

/// A project of a chart.
fn chart_project(folder: &Path, chart: &str) -> PathBuf {
    let inputs = r#"start := "Sum_DB".seed MOD 2 = 1, full_a := ("Sum_DB".seed / 4) MOD 2 = 1,
    full_b := ("Sum_DB".seed / 16) MOD 2 = 1, ready := ("Sum_DB".seed / 64) MOD 2 = 1,
    skip := ("Sum_DB".seed / 256) MOD 4 = 1"#;
    let bits = ["valve_a", "valve_b", "mixer", "lamp", "late", "pulse", "kept", "begun"];
    let numbers = r#"INT_TO_DINT("Line_DB".count) + INT_TO_DINT("Line_DB".calls) + TIME_TO_DINT("Line_DB".idle_time)"#;
    let main = around(inputs, &bits, numbers) + CALLS;
    project_of(folder, ("chart.gr7", chart), &main, NUMBERS)
}

#[test]
fn charts_as_projects_do_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let project = chart_project(folder.path(), CHART);
    let parts = [
        "targetName=\"Idle\"",
        "<selectionConvergence",
        "<simultaneousConvergence",
        "<simultaneousDivergence",
        "<selectionDivergence",
        "qualifier=\"D\" duration=\"T#100MS\"",
        "<xhtml:p>waits for start</xhtml:p>",
    ];
    converts_to_the_same(folder.path(), &project, &parts);
}

/// A comment after a row is that of the row, and not also one of the next step.
#[test]
fn comments_of_rows_are_written_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let chart = CHART.replace("#valve_b   (N)", "#valve_b   (N)   // opens B");
    let chart = chart.replace("#mixer   (N)", "// turns slowly\n#mixer   (N)");
    let (written, messages) = project_document(&chart_project(folder.path(), &chart));
    assert!(!has_errors(&messages), "{messages:#?}");
    for text in ["opens B", "turns slowly"] {
        assert_eq!(written.matches(text).count(), 1, "{text} in\n{written}");
    }
}

#[test]
fn charts_of_projects_come_back() {
    for name in ["star-delta", "two-doses"] {
        let folder = tests_folder().join("run/plcopen").join(name);
        let (written, messages) = project_document(&folder);
        assert!(!has_errors(&messages), "{name}: {messages:#?}");
        let new = tempfile::tempdir().expect("a folder");
        for from in everything(&folder) {
            let to = new.path().join(from.strip_prefix(&folder).expect("below the folder"));
            fs::create_dir_all(to.parent().expect("a folder")).expect("a folder");
            fs::copy(&from, &to).expect("a copy");
        }
        fs::write(new.path().join("project.xml"), &written).expect("a file");
        let result = passes(TestInput::Project(new.path().to_path_buf()));
        assert!(result.is_ok(), "{name}: {result:?}\n{written}");
    }
}

/// Parts of the chart in other forms, and what the conversion says about each.
#[test]
fn what_sfc_does_not_have_is_refused() {
    let step = "STEP Mix (*$_NUM 6*):\n";
    let cases = [
        (
            step,
            "STEP Mix (*$_NUM 6*):\nSUPERVISION\nCONDITION := #skip\nEND_SUPERVISION\n",
            "SFC has no supervision, such as that of step `Mix`",
        ),
        (
            step,
            "STEP Mix (*$_NUM 6*):\nINTERLOCK\nCONDITION := #skip\nEND_INTERLOCK\n#valve_b   (NC)\n",
            "SFC has no interlocks, such as that of step `Mix`",
        ),
        ("#mixer   (N)", "#mixer   (V1_S)", "SFC has no actions at the event V1"),
        ("#mixer   (N)", "S_ALL   (S1_OFF)", "SFC has no actions that activate or deactivate steps"),
        ("#mixer   (N)", "C5   (S1_CU)", "PLCopen XML has no timers and counters of the CPU"),
        (
            "#mixer   (N)",
            "MW2 := MW4 + 1   (N)",
            "GRAPH computes here with the bits of an operand as a number, and ST does not",
        ),
        ("#late := T#100MS", "#late := MD20", "the time of an action is in an operand that is not of type TIME"),
        ("S006.T >=", "S006.LA AND S006.T >=", "SFC has no `LA` of a step, only X and T"),
        ("CONDITION := #ready\n", "CONDITION := #ready AND NOT Go.TT\n", "SFC has no `TT` of a transition"),
        (
            "INITIAL_STEP",
            "PERM_CONDITION_AT_BEGIN\nM9.0 (=) := #skip\nEND_PERM_CONDITION\nINITIAL_STEP",
            "SFC has no permanent instructions",
        ),
    ];
    for (old, new, wanted) in cases {
        assert!(CHART.contains(old), "{old}");
        let folder = tempfile::tempdir().expect("a folder");
        let project = chart_project(folder.path(), &CHART.replacen(old, new, 1));
        let (_, messages) = project_document(&project);
        let titles: Vec<&str> = messages.iter().filter(|one| one.is_error()).map(|one| one.title.as_str()).collect();
        assert_eq!(titles, [wanted], "{new}");
    }
}
