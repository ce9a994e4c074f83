//! Programs with missing parts on the command line: the compiler and the start of every run report the stand-ins.

use std::fs;
use std::process::{Command, Output};

use crate::plcc;

const SOURCE: &str =
    "FUNCTION FC 1 : VOID\nBEGIN\nNETWORK\n  A \"Start\";\n  = Q 4.0;\n  CALL FC 405 (x := MW 10);\nEND_FUNCTION\n";

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn what_stands_in_is_told_at_the_start_of_every_run() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("valve.stl"), SOURCE).expect("the folder can be written");
    let refused = plcc(folder.path(), &["build", "valve.stl"]);
    assert_eq!(refused.status.code(), Some(3), "{}", errors(&refused));

    let run = plcc(folder.path(), &["run", "--partial", "valve.stl", "--cycles", "2"]);
    assert_eq!(run.status.code(), Some(0), "{}", errors(&run));
    let lines = [
        "partial: OB 1 is missing: an empty one",
        "partial: FC 405 is missing: a stub that does nothing",
        "partial: `Start` is missing: a substitute variable of type BOOL",
    ];
    for line in lines {
        assert_eq!(errors(&run).matches(line).count(), 1, "{line} in {}", errors(&run));
    }
    assert!(errors(&run).contains("in its place: a stub that does nothing"), "{}", errors(&run));

    let built = plcc(folder.path(), &["build", "--partial", "valve.stl", "-o", "valve"]);
    assert_eq!(built.status.code(), Some(0), "{}", errors(&built));
    let start =
        |flags: &[&str]| Command::new(folder.path().join("valve")).args(flags).output().expect("the executable starts");
    let ended = start(&["--cycles", "2"]);
    for line in lines {
        assert_eq!(errors(&ended).matches(line).count(), 1, "{line} in {}", errors(&ended));
    }
    let quiet = start(&["--cycles", "2", "--quiet"]);
    assert_eq!(errors(&quiet), "partial: the program was built with 3 missing parts\n");
}

#[test]
fn what_stands_in_for_a_numbered_type_is_told() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let source = "FUNCTION_BLOCK FB 14\nVAR\n  recipe : UDT 5;\nEND_VAR\nBEGIN\n  L #recipe.volume;\n  T MD 10;\nEND_FUNCTION_BLOCK\n";
    fs::write(folder.path().join("valve.stl"), source).expect("the folder can be written");
    let check = plcc(folder.path(), &["check", "--partial", "valve.stl"]);
    let told = "in its place: a structure of the one component that is used";
    assert!(errors(&check).contains(told), "{}", errors(&check));
}

#[test]
fn a_project_can_say_that_it_is_partial() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("valve.stl"), SOURCE).expect("the folder can be written");
    fs::write(folder.path().join("plc.toml"), "name = \"valve\"\npartial = true\n").expect("the folder can be written");
    let run = plcc(folder.path(), &["run", ".", "--cycles", "2"]);
    assert_eq!(run.status.code(), Some(0), "{}", errors(&run));
    let check = plcc(folder.path(), &["check", "."]);
    assert_eq!(check.status.code(), Some(0), "{}", errors(&check));
}

/// Symbol tables of Micro/WIN also name subroutines of its libraries, which no source has.
#[test]
fn a_symbol_may_name_a_missing_subroutine_of_an_s7_200() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let networks =
        "NETWORK\nLD SM0.0\nCALL MBUS_SLAVE, M1.1, MB6\nMOVB 5, VB0\nNETWORK\nLD SM0.1\nATCH Tick, 10\nMOVB 6, VB1\n";
    let main = format!("ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\n{networks}END_ORGANIZATION_BLOCK\n");
    fs::write(folder.path().join("main.awl"), main).expect("the folder can be written");
    let table = "MBUS_SLAVE\tSBR1\tslave\nTick\tINT0\t\n";
    fs::write(folder.path().join("symbols.txt"), table).expect("the folder can be written");
    let arguments = ["run", ".", "--partial", "--cycles", "1", "--print", "VB0", "--print", "VB1"];
    let run = plcc(folder.path(), &arguments);
    assert_eq!(String::from_utf8_lossy(&run.stdout), "VB0 = 16#05\nVB1 = 16#06\n", "{}", errors(&run));
    for line in
        ["partial: SBR1 is missing: a stub that does nothing", "partial: INT0 is missing: a stub that does nothing"]
    {
        assert_eq!(errors(&run).matches(line).count(), 1, "{line} in {}", errors(&run));
    }
}

#[test]
fn which_version_of_a_block_counts_is_not_guessed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for version in ["a", "b"] {
        fs::create_dir(folder.path().join(version)).expect("the folder can be written");
        fs::write(folder.path().join(version).join("valve.stl"), SOURCE).expect("the folder can be written");
    }
    let run = plcc(folder.path(), &["run", "--partial", ".", "--cycles", "2"]);
    assert_eq!(run.status.code(), Some(3), "{}", errors(&run));
    assert!(errors(&run).contains("`./a/valve.stl` and `./b/valve.stl`"), "{}", errors(&run));
}
