//! `plcc view` as a command: the page of a program.

use std::fs;
use std::process::Command;

const PLCC: &str = env!("CARGO_BIN_EXE_plcc");

#[test]
fn a_page_names_all_languages_of_a_block() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let network = |language: &str, rung: &str| {
        format!("{{ S7_Language := \"{language}\" }}\nNETWORK\n  RUNG {rung} Coil( #q ) END_RUNG\nEND_NETWORK\n")
    };
    let head =
        "FUNCTION Both : Void\n  VAR_INPUT\n    a, b : Bool;\n  END_VAR\n  VAR_OUTPUT\n    q : Bool;\n  END_VAR\n";
    let lad = network("LAD", "wire#powerrail Contact( #a )");
    let fbd = network("FBD", "#a A( in2 := #b )");
    for (networks, language) in [(format!("{lad}{fbd}"), "LAD, FBD"), (lad.clone(), "LAD"), (fbd.clone(), "FBD")] {
        fs::write(folder.join("both.s7dcl"), format!("{head}{networks}END_FUNCTION\n"))
            .expect("the folder can be written");
        let arguments = ["view", "both.s7dcl", "--html", "both.html"];
        let output = Command::new(PLCC).current_dir(folder).args(arguments).output().expect("plcc starts");
        let page = fs::read_to_string(folder.join("both.html")).expect("it is written");
        let messages = String::from_utf8_lossy(&output.stderr);
        assert!(page.contains(&format!("\"lang\":\"{language}\"")), "{language}: {messages}");
    }
}

#[test]
fn a_view_without_an_output_names_both_kinds() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("lamp.stl"), "      A     I 0.0\n      =     Q 4.0\n")
        .expect("the folder can be written");
    let output =
        Command::new(PLCC).current_dir(folder.path()).args(["view", "lamp.stl"]).output().expect("plcc starts");
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(message.contains("--out <DIR>|--html <FILE.html>"), "{message}");
}

#[test]
fn a_folder_without_drawings_is_explained() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    fs::write(
        folder.join("main.scl"),
        "ORGANIZATION_BLOCK \"Main\"\nBEGIN\n  %Q0.0 := %I0.0;\nEND_ORGANIZATION_BLOCK\n",
    )
    .expect("the folder can be written");
    let output = Command::new(PLCC).current_dir(folder).args(["view", "main.scl", "-o", "drawings"]).output();
    let output = output.expect("plcc starts");
    let messages = String::from_utf8_lossy(&output.stderr);
    assert!(messages.contains("no networks and no charts"), "{messages}");
}
