//! `plcc convert` as a command: what it is called with, symbols and addresses, reports of migrations, folders.
//!
//! - `comments`: comments and regions; `declarations`: start values and instances; `documents`: SIMATIC SD; `xml`: SimaticML; `projects`: PLCopen XML.
//! - `statements`: STL, SCL as STL, and the S7-200.
//!
//! `convert/` has the programs, and beside them what plcc writes: `plant.absolute`. `UPDATE_EXPECT=1` renews these.

mod comments;
mod declarations;
mod documents;
mod projects;
mod statements;
mod xml;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const PLCC: &str = env!("CARGO_BIN_EXE_plcc");

fn programs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/command/convert")
}

fn plcc(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(PLCC).current_dir(folder).args(arguments).output().expect("plcc starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).replace("\r\n", "\n")
}

/// Compares what a command prints, and its messages, with a file.
fn expect(arguments: &[&str], file: &str) {
    let output = plcc(&programs(), arguments);
    let found = format!("{}{}", text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{arguments:?}:\n{found}");
    let path = programs().join(file);
    if std::env::var_os("UPDATE_EXPECT").is_some_and(|value| value != "0") {
        return fs::write(&path, found).expect("the tree can be written");
    }
    let expected = fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(found, expected, "{file}: UPDATE_EXPECT=1 renews it; read the diff");
}

#[test]
fn symbols_become_addresses_and_addresses_symbols() {
    expect(&["convert", "plant", "--absolute"], "plant.absolute");
    expect(&["convert", "plant", "--symbolic"], "plant.symbolic");
    expect(&["convert", "press", "--absolute"], "press.absolute");
    expect(&["convert", "press", "--symbolic"], "press.symbolic");
}

/// `"tag":P` is `%IW4:P`, in SCL and in networks.
#[test]
fn direct_accesses_become_addresses_and_symbols() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let symbols = "\"Tag\",\"I 0.1\",\"BOOL\",\"\"\n\"In\",\"IW 4\",\"WORD\",\"\"\n\"Out\",\"QW 4\",\"WORD\",\"\"\n\"Main\",\"OB 1\",\"OB 1\",\"\"\n";
    let scl = "ORGANIZATION_BLOCK \"Main\"\nVERSION : 0.1\nVAR_TEMP\n  x : BOOL;\nEND_VAR\nBEGIN\n  #x := \"Tag\":P;\n  \
               \"Out\":P := \"In\":P;\n  \"Out\" := \"In\";\nEND_ORGANIZATION_BLOCK\n";
    let ladder = "FUNCTION G : Void\n    { S7_Language := \"LAD\" }\n    NETWORK\n        \
                  RUNG wire#powerrail  Contact( \"Tag\":P )  Coil( %M0.0 )  END_RUNG\n    END_NETWORK\nEND_FUNCTION\n";
    let there = folder.join("there");
    fs::create_dir(&there).expect("the folder can be written");
    for (name, text) in [("a.scl", scl), ("b.s7dcl", ladder), ("t.sdf", symbols)] {
        fs::write(there.join(name), text).expect("the folder can be written");
    }
    let convert = |from: &str, how: &str, to: &str| {
        let output = plcc(folder, &["convert", from, how, "--cpu", "s7-1500", "-o", to]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    };
    let read = |name: &str| fs::read_to_string(folder.join(name)).expect("it is written");
    convert("there", "--absolute", "absolute/");
    assert!(
        read("absolute/a.scl").contains("#x := %I0.1:P;\n  %QW4:P := %IW4:P;\n  %QW4 := %IW4;"),
        "{}",
        read("absolute/a.scl")
    );
    assert!(read("absolute/b.s7dcl").contains("Contact( %I0.1:P )"), "{}", read("absolute/b.s7dcl"));
    convert("absolute", "--symbolic", "back/");
    assert_eq!((read("back/a.scl").as_str(), read("back/b.s7dcl").as_str()), (scl, ladder));
}

#[test]
fn reports_say_what_carries_over() {
    expect(&["convert", "press", "--report", "s7-1200"], "press.report");
    expect(&["convert", "packer", "--report", "s7-1500"], "packer.report");
}

#[test]
fn a_report_is_refused_where_there_is_none() {
    for (program, family, says) in [
        ("press", "s7-1500", "goes to an S7-1200"),
        ("packer", "s7-1200", "goes to an S7-1500"),
        ("packer", "s7-9000", "does not know the CPU"),
    ] {
        let output = plcc(&programs(), &["convert", program, "--report", family]);
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output.stderr).contains(says), "{}", text(&output.stderr));
    }
}

/// The notation that is written belongs to a command line with one of them only.
#[test]
fn a_single_source_goes_into_a_folder_whose_name_ends_with_a_slash() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("lamp.stl"), "      A     I 0.0\n      =     Q 4.0\n")
        .expect("the folder can be written");
    let output = plcc(folder.path(), &["convert", "lamp.stl", "--to", "stl", "--mnemonics", "de", "-o", "german/"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let written = fs::read_to_string(folder.path().join("german/lamp.stl")).expect("it is written");
    assert!(written.contains("E 0.0"), "{written}");
}

#[test]
fn one_conversion_at_a_time() {
    for arguments in [&["convert", "plant"][..], &["convert", "plant", "--to", "stl", "--absolute"]] {
        assert_eq!(plcc(&programs(), arguments).status.code(), Some(2), "{arguments:?}");
    }
}

/// A converted folder is a project of its own: with its tables, its settings, and the CPU that the sources implied.
#[test]
fn converted_folders_are_projects() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("the folder can be written");
        fs::write(path, text).expect("the folder can be written");
    };
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap_or_default();
    let run = |arguments: &[&str]| {
        let output = plcc(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
    };
    let main =
        "ORGANIZATION_BLOCK OB 1\nBEGIN\nNETWORK\n      A     \"start\";\n      CC    FC 1;\nEND_ORGANIZATION_BLOCK\n";
    let lamp = "FUNCTION FC 1 : VOID\nBEGIN\nNETWORK\n      A     \"start\";\n      =     Q 4.0;\nEND_FUNCTION\n";
    write("plant/src/main.stl", main);
    write("plant/src/lamp.stl", lamp);
    write("plant/names.sdf", "\"start\",\"I 0.0\",\"BOOL\",\"a button\"\n");
    let settings = "name = \"lamps\"\nsources = [\n  \"src\",\n]\nsymbols = [\"names.sdf\"]\ncpu = \"315-2DP\"\nmnemonics = \"en\"\n";
    write("plant/plc.toml", settings);
    run(&["convert", "plant", "--to", "lad", "-o", "lad/"]);
    assert_eq!(read("lad/plc.toml"), "name = \"lamps\"\ncpu = \"315-2DP\"\n");
    assert_eq!(read("lad/names.sdf"), read("plant/names.sdf"));
    run(&["check", "lad", "--deny", "warnings"]);
    run(&["convert", "plant", "--to", "stl", "--mnemonics", "de", "-o", "german/"]);
    assert_eq!(read("german/plc.toml"), "mnemonics = \"de\"\nname = \"lamps\"\ncpu = \"315-2DP\"\n");
    run(&["check", "german", "--deny", "warnings"]);
    // A second time, settings that are there stay.
    write("lad/plc.toml", "cpu = \"317-2DP\"\n");
    run(&["convert", "plant", "--to", "lad", "-o", "lad/"]);
    assert_eq!(read("lad/plc.toml"), "cpu = \"317-2DP\"\n");
    // Without a project, statement lists are those of an S7-300, and SIMATIC SD is of the TIA Portal.
    fs::remove_file(folder.path().join("plant/plc.toml")).expect("it is there");
    run(&["convert", "plant", "--to", "lad", "-o", "other/"]);
    assert_eq!(read("other/plc.toml"), "cpu = \"s7-300\"\n");
    run(&["check", "other", "--deny", "warnings"]);
}

/// Every program of the tests and samples that has symbols: with addresses and back, it stays the same program, which plcc itself
/// compares.
#[test]
fn programs_with_symbols_go_there_and_back() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut changed = 0;
    for project in [
        "samples/edge-equivalence",
        "samples/star-delta",
        "samples/traffic-light",
        "samples/water-tank",
        "tests/run/stl/names",
        "tests/run/scl/s7-1200/tags_beside_functions",
        "tests/xref/station",
        "tests/services/plant",
        "tests/services/line",
    ] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let there = folder.path().join("there");
        fs::create_dir(&there).expect("the folder can be written");
        let project = root.join(project);
        let shown = project.to_string_lossy().into_owned();
        let made = plcc(folder.path(), &["convert", &shown, "--absolute", "-o", "there"]);
        assert_eq!(made.status.code(), Some(0), "{shown}: {}", text(&made.stderr));
        let is_source = |path: &PathBuf| !is_table(path) && !path.ends_with("plc.toml");
        let sources: Vec<PathBuf> = files(&there).into_iter().filter(is_source).collect();
        for source in &sources {
            let name = source.file_name().expect("a file has a name");
            let own = files(&project).into_iter().find(|path| path.file_name() == Some(name));
            changed += usize::from(own.is_some_and(|own| fs::read(own).ok() != fs::read(source).ok()));
        }
        // The folder is a project with its symbols.
        let back = plcc(folder.path(), &["convert", "there", "--symbolic", "-o", "back/"]);
        assert_eq!(back.status.code(), Some(0), "{shown}: {}", text(&back.stderr));
    }
    assert!(changed >= 5, "only {changed} sources had symbols");
}

fn is_table(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "sdf")
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut found: Vec<PathBuf> = entries.filter(|path| path.is_file()).collect();
    found.sort();
    found
}
