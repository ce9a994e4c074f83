//! Projects that `plcc new` makes, the shell scripts and the manual pages, and reports of tests.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::{PLCC, plcc};

/// Runs plcc, which must succeed; returns standard output.
fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = plcc(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn a_new_project_builds_and_passes_its_test() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for cpu in ["1214C", "315-2DP", "224", "s7-1500", "s7-400"] {
        let name = format!("plant {cpu}");
        let said = done(folder.path(), &["new", &name, "--cpu", cpu]);
        assert_eq!(said, format!("made {name}; run its test with `plcc test '{name}'`\n"));
        let project = folder.path().join(&name);
        assert!(done(&project, &["test", "--deny", "warnings"]).ends_with("4 passed, 0 failed\n"));
        assert_eq!(done(&project, &["fmt", "--check"]), "");
        done(&project, &["build", "--deny", "warnings", "--quiet"]);
        assert!(project.join(&name).is_file());
    }
    let refused = String::from_utf8_lossy(&plcc(folder.path(), &["plant 224"]).stderr).into_owned();
    assert!(refused.starts_with("plcc: `plant 224` is not a command: write `plcc check plant 224`"), "{refused}");
    // What is there stays.
    fs::write(folder.path().join("plant 224/main.awl"), "LD I0.0\n").expect("the folder can be written");
    assert_eq!(plcc(folder.path(), &["new", "plant 224", "--cpu", "224"]).status.code(), Some(2));
    assert_eq!(fs::read_to_string(folder.path().join("plant 224/main.awl")).expect("it is there"), "LD I0.0\n");
    assert_eq!(plcc(folder.path(), &["new", "x", "--cpu", "no such"]).status.code(), Some(2));
    std::fs::write(folder.path().join("note"), "").unwrap();
    let refused = String::from_utf8_lossy(&plcc(folder.path(), &["new", "note"]).stderr).into_owned();
    assert_eq!(refused, "plcc: cannot make `note`: a file has this name; name another folder\n");
    assert!(!folder.path().join("x").exists());
}

#[test]
fn completions_and_pages_name_the_commands() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = done(folder.path(), &["completions", shell]);
        assert!(script.contains("fmt") && script.contains("junit"), "{shell}");
    }
    done(folder.path(), &["man", "man"]);
    for (page, text) in [("plcc.1", "plcc"), ("plcc-test.1", "junit"), ("plcc-fmt.1", "check")] {
        let page = fs::read_to_string(folder.path().join("man").join(page)).expect("the page is there");
        assert!(page.contains(text), "{page}");
    }
}

#[test]
fn tests_are_chosen_and_reported() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    fs::write(folder.join("good.stl"), "      L     1\n//@ assert ACCU1 == 1\n").expect("the folder can be written");
    fs::write(folder.join("bad.stl"), "      L     1\n//@ assert ACCU1 == 2\n").expect("the folder can be written");
    let output = plcc(folder, &["test", ".", "--junit", "r.xml"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(output.stderr.is_empty(), "a pipe gets no progress: {}", String::from_utf8_lossy(&output.stderr));
    let report = fs::read_to_string(folder.join("r.xml")).expect("it is written");
    assert!(report.contains("tests=\"2\" failures=\"1\" errors=\"0\""), "{report}");
    assert_eq!(done(folder, &["test", ".", "--filter", "good"]), "1 passed, 0 failed\n");
    let none = plcc(folder, &["test", ".", "--filter", "other"]);
    assert_eq!(none.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&none.stderr).contains("none of the 2 tests"));
    let only = plcc(folder, &["test", "good.stl", "--filter", "other"]);
    assert_eq!(String::from_utf8_lossy(&only.stderr), "plcc: the only test does not have `other` in its path\n");
}

#[test]
fn a_report_has_the_name_of_the_project_in_this_folder() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    done(folder.path(), &["new", "line"]);
    let project = folder.path().join("line");
    assert_eq!(done(&project, &["test", ".", "--junit", "r.xml"]), "4 passed, 0 failed\n");
    let report = fs::read_to_string(project.join("r.xml")).expect("it is written");
    assert!(report.contains("<testcase classname=\"plcc\" name=\"line\" assertions=\"4\"/>"), "{report}");
    // A second scenario expects that the motor does not stop.
    let scenario = fs::read_to_string(project.join("tests/motor.scenario.toml")).expect("it is there");
    let wrong = scenario.trim_end().strip_suffix("\"Q0.0\" = 0 }").expect("the motor stops at the end");
    fs::write(project.join("tests/other.toml"), format!("{wrong}\"Q0.0\" = 1 }}\n"))
        .expect("the folder can be written");
    assert_eq!(plcc(&project, &["test", ".", "--junit", "r.xml"]).status.code(), Some(1));
    let report = fs::read_to_string(project.join("r.xml")).expect("it is written");
    for text in [
        "tests=\"2\" failures=\"1\" errors=\"0\"",
        "<testcase classname=\"line\" name=\"tests/motor.scenario.toml\" assertions=\"4\"/>",
        "<testcase classname=\"line\" name=\"tests/other.toml\" assertions=\"4\">",
    ] {
        assert!(report.contains(text), "{text} in {report}");
    }
}

#[test]
fn a_watched_test_runs_again_after_a_change() {
    use std::io::{BufRead, BufReader};
    let folder = tempfile::tempdir().expect("a temporary folder");
    let source = folder.path().join("a.stl");
    fs::write(&source, "      L     1\n//@ assert ACCU1 == 2\n").expect("the folder can be written");
    let mut child = Command::new(PLCC)
        .args(["test", "--watch"])
        .arg(&source)
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::null())
        .spawn()
        .expect("plcc starts");
    let mut lines = BufReader::new(child.stdout.take().expect("it is a pipe")).lines().map_while(Result::ok);
    let first = lines.find(|line| line.ends_with("failed"));
    fs::write(&source, "      L     2\n//@ assert ACCU1 == 2\n//@ assert ACCU1 == 2\n").expect("it can be written");
    let second = lines.find(|line| line.ends_with("failed"));
    child.kill().expect("it runs until it is ended");
    child.wait().expect("it has ended");
    assert_eq!(first.as_deref(), Some("0 passed, 1 failed"));
    assert_eq!(second.as_deref(), Some("2 passed, 0 failed"));
}
