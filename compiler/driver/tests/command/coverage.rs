//! `plcc test --coverage`: each source of tests/coverage with the LCOV file that its test makes, `x.info` beside `x.stl`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/coverage")
}

fn plcc(arguments: &[&str]) -> Output {
    crate::plcc(folder(), arguments)
}

/// The LCOV file of a test, and what it prints.
fn covered(sources: &[&str], more: &[&str]) -> (String, String) {
    let out = tempfile::tempdir().expect("a temporary folder");
    let out_text = out.path().display().to_string();
    let output = plcc(&[&["test"], sources, &["--coverage", &out_text], more].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout).replace(&out_text, "DIR");
    (fs::read_to_string(out.path().join("lcov.info")).expect("it is there"), text)
}

#[test]
fn what_runs_is_counted_in_each_language() {
    let updating = std::env::var_os("UPDATE_EXPECT").is_some_and(|value| value != "0");
    let sources = ["statements.stl", "conditions.scl", "networks.s7dcl", "door.gr7", "pump.awl"];
    for source in sources {
        let (lcov, text) = covered(&[source], &[]);
        let golden = folder().join(source).with_extension("info");
        let found = format!("{lcov}{text}");
        if updating {
            fs::write(&golden, &found).expect("the folder can be written");
        }
        let expected = fs::read_to_string(&golden).unwrap_or_default();
        assert_eq!(found, expected, "{source}: UPDATE_EXPECT=1 renews it; read the diff");
        for form in [&["--form", "interp"][..], &["-O0"], &["--form", "all"]] {
            assert_eq!(covered(&[source], form).0, lcov, "{source} {form:?}");
        }
    }
}

/// Two scenarios of one program, and two programs of one command, count together.
#[test]
fn tests_add_up() {
    let (alone, _) = covered(&["statements.stl"], &[]);
    let (both, text) = covered(&["statements.stl", "conditions.scl"], &["--json"]);
    assert!(both.contains(&alone), "{both}");
    let sums: serde_json::Value = serde_json::from_str(&text).expect("it is JSON");
    assert_eq!(sums["coverage"]["blocks"], serde_json::json!({ "covered": 4, "all": 5 }));
    let room = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, text: &str| fs::write(room.path().join(name), text).expect("the folder can be written");
    write("plc.toml", "name = \"two\"\ncpu = \"315-2DP\"\nsources = [\"main.stl\"]\n");
    write(
        "main.stl",
        "ORGANIZATION_BLOCK OB 1\nBEGIN\nNETWORK\n      A     I     0.0;\n      =     Q     0.0;\nEND_ORGANIZATION_BLOCK\n",
    );
    fs::create_dir(room.path().join("tests")).expect("the folder can be written");
    let scenario =
        |value: u8| format!("[[at]]\ncycle = 1\nset = {{ \"I0.0\" = {value} }}\nexpect = {{ \"Q0.0\" = {value} }}\n");
    let contacts = || {
        let output = crate::plcc(&room, &["test", ".", "--coverage", "out", "--json"]);
        let sums: serde_json::Value = serde_json::from_slice(&output.stdout).expect("it is JSON");
        sums["coverage"]["contacts"]["covered"].as_u64()
    };
    write("tests/off.toml", &scenario(0));
    assert_eq!(contacts(), Some(0));
    write("tests/on.toml", &scenario(1));
    assert_eq!(contacts(), Some(1));
}

#[test]
fn pages_show_the_networks() {
    let out = tempfile::tempdir().expect("a temporary folder");
    let out_text = out.path().display().to_string();
    assert!(plcc(&["test", "networks.s7dcl", "--coverage", &out_text]).status.success());
    let index = fs::read_to_string(out.path().join("index.html")).expect("it is there");
    assert!(index.contains("<a href=\"networks_s7dcl.html\">"), "{index}");
    let page = fs::read_to_string(out.path().join("networks_s7dcl.html")).expect("it is there");
    // The contact `#on` has been both, the first `#stop` only 0, the network after the jump did not run.
    assert!(page.contains("<title>has never been 1</title>"));
    assert!(page.contains("Network 4 Left out <span class=\"no\">not run</span>"));
    assert!(page.contains("Network 5 Gate <span class=\"ok\">run</span>"));
    let no = page.matches("class=\"no\"").count();
    assert!(no > 4, "{no}");
}

/// The name of a file would become that of a folder.
#[test]
fn coverage_goes_into_a_folder() {
    for name in ["nowhere.info", "nowhere.html"] {
        let output = plcc(&["test", "statements.stl", "--coverage", name]);
        assert_eq!(output.status.code(), Some(2));
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(said.contains(&format!("--coverage {name}: this is a file; name a folder")), "{said}");
        assert!(!folder().join(name).exists());
    }
}

#[test]
fn executables_do_not_count() {
    let output = plcc(&["test", "statements.stl", "--coverage", "nowhere", "--form", "exe"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("--form jit"));
    assert!(!folder().join("nowhere").exists());
}
