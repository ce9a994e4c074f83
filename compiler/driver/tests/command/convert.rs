//! `plcc convert` as a command: what it is called with, symbols and addresses, reports of migrations, folders.
//!
//! - `comments`: comments and regions; `declarations`: start values and instances; `documents`: SIMATIC SD; `xml`: SimaticML; `projects`: PLCopen XML.
//! - `statements`: STL and SCL; `to_stl`: SCL, networks and charts as STL; `s7200`: the S7-200.
//!
//! `convert/` has the programs, and beside them what plcc writes: `plant.absolute`. `UPDATE_EXPECT=1` renews these.

mod comments;
mod declarations;
mod documents;
mod projects;
mod s7200;
mod statements;
mod to_stl;
mod xml;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use tempfile::TempDir;

use crate::plcc;

fn programs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/command/convert")
}

/// A temporary folder with files: their names, and what is in them.
fn folder_with(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, text) in files {
        write(&folder, name, text);
    }
    folder
}

/// Writes a file, and the folders that it is in.
fn write(folder: impl AsRef<Path>, name: &str, text: &str) {
    let path = folder.as_ref().join(name);
    fs::create_dir_all(path.parent().expect("a file is in a folder")).expect("the folder can be written");
    fs::write(path, text).expect("the folder can be written");
}

/// What is in a file that plcc has written.
fn read(folder: impl AsRef<Path>, name: &str) -> String {
    let path = folder.as_ref().join(name);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Runs a command that has to succeed.
fn done(folder: impl AsRef<Path>, arguments: &[&str]) -> Output {
    let output = plcc(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}{}", text(&output.stdout), text(&output.stderr));
    output
}

/// Runs `plcc test`, which has to find this many assertions, all of which hold.
fn expect_passed(folder: impl AsRef<Path>, arguments: &[&str], count: usize) {
    let output = plcc(folder, &[&["test"][..], arguments].concat());
    let said = format!("{}{}", text(&output.stdout), text(&output.stderr));
    assert!(said.contains(&format!("{count} passed, 0 failed")), "{arguments:?}: {said}");
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).replace("\r\n", "\n")
}

/// Compares what a command prints, and its messages, with a file.
fn expect(arguments: &[&str], file: &str) {
    let output = done(programs(), arguments);
    let found = format!("{}{}", text(&output.stdout), text(&output.stderr));
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
    let symbols = "\"Tag\",\"I 0.1\",\"BOOL\",\"\"\n\"In\",\"IW 4\",\"WORD\",\"\"\n\"Out\",\"QW 4\",\"WORD\",\"\"\n\"Main\",\"OB 1\",\"OB 1\",\"\"\n";
    let scl = "ORGANIZATION_BLOCK \"Main\"\nVERSION : 0.1\nVAR_TEMP\n  x : BOOL;\nEND_VAR\nBEGIN\n  #x := \"Tag\":P;\n  \
               \"Out\":P := \"In\":P;\n  \"Out\" := \"In\";\nEND_ORGANIZATION_BLOCK\n";
    let ladder = "FUNCTION G : Void\n    { S7_Language := \"LAD\" }\n    NETWORK\n        \
                  RUNG wire#powerrail  Contact( \"Tag\":P )  Coil( %M0.0 )  END_RUNG\n    END_NETWORK\nEND_FUNCTION\n";
    let folder = folder_with(&[("there/a.scl", scl), ("there/b.s7dcl", ladder), ("there/t.sdf", symbols)]);
    let convert = |from: &str, how: &str, to: &str| {
        done(&folder, &["convert", from, how, "--cpu", "s7-1500", "-o", to]);
    };
    convert("there", "--absolute", "absolute/");
    assert!(
        read(&folder, "absolute/a.scl").contains("#x := %I0.1:P;\n  %QW4:P := %IW4:P;\n  %QW4 := %IW4;"),
        "{}",
        read(&folder, "absolute/a.scl")
    );
    assert!(read(&folder, "absolute/b.s7dcl").contains("Contact( %I0.1:P )"), "{}", read(&folder, "absolute/b.s7dcl"));
    convert("absolute", "--symbolic", "back/");
    assert_eq!((read(&folder, "back/a.scl").as_str(), read(&folder, "back/b.s7dcl").as_str()), (scl, ladder));
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
        let output = plcc(programs(), &["convert", program, "--report", family]);
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output.stderr).contains(says), "{}", text(&output.stderr));
    }
}

/// The notation that is written belongs to a command line with one of them only.
#[test]
fn a_single_source_goes_into_a_folder_whose_name_ends_with_a_slash() {
    let folder = folder_with(&[("lamp.stl", "      A     I 0.0\n      =     Q 4.0\n")]);
    done(&folder, &["convert", "lamp.stl", "--to", "stl", "--mnemonics", "de", "-o", "german/"]);
    let written = read(&folder, "german/lamp.stl");
    assert!(written.contains("E 0.0"), "{written}");
}

/// The folders of a plant often contain files of the same name. On Windows, names that differ only in case are the same, too.
#[test]
fn sources_with_one_name_become_files_of_their_own() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (line, name, block) in [("first", "pump", "FC 1"), ("second", "pump", "FC 2"), ("third", "Pump", "FC 3")] {
        let there = folder.path().join("plant").join(line);
        fs::create_dir_all(&there).expect("the folder can be written");
        let source = format!("FUNCTION {block} : VOID\nBEGIN\nNETWORK\n      A     I 0.0;\nEND_FUNCTION\n");
        fs::write(there.join(name).with_extension("awl"), source).expect("the folder can be written");
    }
    let output = plcc(folder.path(), &["convert", "plant", "--to", "stl", "--mnemonics", "de", "-o", "german"]);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("pump-2.stl`: another source has its name"), "{said}");
    for (name, block) in [("pump.stl", "FC 1"), ("pump-2.stl", "FC 2"), ("Pump-3.stl", "FC 3")] {
        let written = fs::read_to_string(folder.path().join("german").join(name)).expect("it is written");
        assert!(written.contains(block), "{name}: {written}");
    }
}

#[test]
fn one_conversion_at_a_time() {
    for arguments in [&["convert", "plant"][..], &["convert", "plant", "--to", "stl", "--absolute"]] {
        assert_eq!(plcc(programs(), arguments).status.code(), Some(2), "{arguments:?}");
    }
}

/// A converted folder is a project of its own: with its tables, its settings, and the CPU that the sources implied.
#[test]
fn converted_folders_are_projects() {
    let main =
        "ORGANIZATION_BLOCK OB 1\nBEGIN\nNETWORK\n      A     \"start\";\n      CC    FC 1;\nEND_ORGANIZATION_BLOCK\n";
    let lamp = "FUNCTION FC 1 : VOID\nBEGIN\nNETWORK\n      A     \"start\";\n      =     Q 4.0;\nEND_FUNCTION\n";
    let symbols = "\"start\",\"I 0.0\",\"BOOL\",\"a button\"\n";
    let settings = "name = \"lamps\"\nsources = [\n  \"src\",\n]\nsymbols = [\"names.sdf\"]\ncpu = \"315-2DP\"\nmnemonics = \"en\"\n";
    let folder = folder_with(&[
        ("plant/src/main.stl", main),
        ("plant/src/lamp.stl", lamp),
        ("plant/names.sdf", symbols),
        ("plant/plc.toml", settings),
    ]);
    done(&folder, &["convert", "plant", "--to", "lad", "-o", "lad/"]);
    assert_eq!(read(&folder, "lad/plc.toml"), "name = \"lamps\"\ncpu = \"315-2DP\"\n");
    assert_eq!(read(&folder, "lad/names.sdf"), symbols);
    done(&folder, &["check", "lad", "--deny", "warnings"]);
    done(&folder, &["convert", "plant", "--to", "stl", "--mnemonics", "de", "-o", "german/"]);
    assert_eq!(read(&folder, "german/plc.toml"), "mnemonics = \"de\"\nname = \"lamps\"\ncpu = \"315-2DP\"\n");
    done(&folder, &["check", "german", "--deny", "warnings"]);
    // A second time, settings that are there stay.
    write(&folder, "lad/plc.toml", "cpu = \"317-2DP\"\n");
    done(&folder, &["convert", "plant", "--to", "lad", "-o", "lad/"]);
    assert_eq!(read(&folder, "lad/plc.toml"), "cpu = \"317-2DP\"\n");
    // Without a project, statement lists are those of an S7-300, and SIMATIC SD is of the TIA Portal.
    fs::remove_file(folder.path().join("plant/plc.toml")).expect("it is there");
    done(&folder, &["convert", "plant", "--to", "lad", "-o", "other/"]);
    assert_eq!(read(&folder, "other/plc.toml"), "cpu = \"s7-300\"\n");
    done(&folder, &["check", "other", "--deny", "warnings"]);
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
        let folder = folder_with(&[]);
        let there = folder.path().join("there");
        fs::create_dir(&there).expect("the folder can be written");
        let project = root.join(project);
        let shown = project.to_string_lossy().into_owned();
        done(&folder, &["convert", &shown, "--absolute", "-o", "there"]);
        let is_source = |path: &PathBuf| !is_table(path) && !path.ends_with("plc.toml");
        let sources: Vec<PathBuf> = files(&there).into_iter().filter(is_source).collect();
        for source in &sources {
            let name = source.file_name().expect("a file has a name");
            let own = files(&project).into_iter().find(|path| path.file_name() == Some(name));
            changed += usize::from(own.is_some_and(|own| fs::read(own).ok() != fs::read(source).ok()));
        }
        // The folder is a project with its symbols.
        done(&folder, &["convert", "there", "--symbolic", "-o", "back/"]);
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
