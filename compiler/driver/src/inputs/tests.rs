//! Which files become part of a program, and the messages for those that do not.

use std::fs;

use super::*;

/// A folder with these files.
pub(crate) fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

#[test]
fn a_folder_gives_its_sources_and_tables() {
    let folder = folder(&[
        ("main.awl", "A I 0.0\n"),
        ("sub/valve", "FUNCTION FC 1 : VOID\nBEGIN\nEND_FUNCTION\n"),
        ("symbols.txt", "\"Start\",\"I 0.0\",\"BOOL\",\"\"\n"),
        ("notes.txt", "# Notes\n\nThis is prose that explains the program.\n"),
        ("README.md", "A tank\n"),
        ("LICENSE", "MIT\n"),
    ]);
    let read = read(&[folder.path().to_path_buf()]);
    assert_eq!((read.units.len(), read.tables.len(), read.diagnostics.len()), (2, 1, 1));
    assert_eq!(read.name, "main");
    // The message names what is not read.
    let message = &read.diagnostics[0];
    assert_eq!(message.code, Code::NotRead);
    assert!(message.help.iter().any(|help| help.contains("notes.txt (text that is not a source)")));
}

#[test]
fn the_list_of_unread_files_is_short() {
    let mut files: Vec<(String, &str)> = (0..20).map(|n| (format!("a{n:02}.py"), "x = 1\n")).collect();
    files.push(("main".to_string(), "A I 0.0\n= Q 4.0\n"));
    files.push(("z.s7p".to_string(), ""));
    let files: Vec<(&str, &str)> = files.iter().map(|(name, text)| (name.as_str(), *text)).collect();
    let read = read(&[folder(&files).path().to_path_buf()]);
    let help = read.diagnostics[0].help.clone().unwrap_or_default();
    assert_eq!((read.units.len(), help.matches("(a source in Python)").count()), (1, 7));
    assert!(help.contains("z.s7p (a project of STEP 7") && help.ends_with("... and 13 more"), "{help}");
}

#[test]
fn a_folder_of_projects_is_not_one_program() {
    let folder = folder(&[("lad/plc.toml", ""), ("lad/a.stl", "A I 0.0\n"), ("fbd/plc.toml", "")]);
    let read = read(&[folder.path().to_path_buf()]);
    let codes: Vec<Code> = read.diagnostics.iter().map(|diagnostic| diagnostic.code).collect();
    assert_eq!((codes, read.units.len()), (vec![Code::Project], 0));
}

#[test]
fn a_missing_file_is_told_with_the_one_that_is_meant() {
    let toml = "sources = [\"mian.stl\", \"valve.scl\", \"gone.stl\"]\n";
    let folder = folder(&[("plc.toml", toml), ("main.stl", "A I 0.0\n"), ("blocks/valve.scl", "%M0.0 := TRUE;\n")]);
    let helps = |path: &Path| -> Vec<String> {
        read(&[path.to_path_buf()]).diagnostics.into_iter().filter_map(|message| message.help).collect()
    };
    let project = helps(folder.path());
    assert_eq!(project[..2], ["is `main.stl` meant?", "is `blocks/valve.scl` meant?"]);
    assert!(project[2].contains("relative to the folder"), "{}", project[2]);
    assert!(helps(&folder.path().join("mian.stl"))[0].ends_with("main.stl` meant?"));
    assert!(helps(&folder.path().join("main.scl"))[0].ends_with("main.stl` meant?"));
    assert!(helps(&folder.path().join("gone.stl"))[0].contains("check the name"));
}

#[test]
fn a_project_of_a_tool_is_told_with_its_export() {
    let folder = folder(&[("a.s7p", "A I 0.0\n"), ("a.zap15", "x"), ("a.mwp", "x")]);
    for (name, words) in [("a.s7p", "Generate Source"), ("a.zap15", "Generate source from blocks"), ("a.mwp", ".awl")] {
        let read = read(&[folder.path().join(name)]);
        assert_eq!(read.diagnostics[0].code, Code::NotASource, "{name}");
        assert!(read.diagnostics[0].help.as_ref().is_some_and(|help| help.contains(words)), "{name}");
    }
}

#[test]
fn a_named_file_must_be_a_source() {
    let folder = folder(&[("notes.md", "# Notes\n\nThis is prose that explains the program.\n")]);
    fs::write(folder.path().join("other.xml"), "<?xml version=\"1.0\"?>\n<html/>\n").unwrap();
    let codes = |path: &str| -> Vec<Code> {
        read(&[folder.path().join(path)]).diagnostics.iter().map(|message| message.code).collect()
    };
    assert_eq!(codes("other.xml"), [Code::NotASource]);
    assert_eq!(codes("missing.stl"), [Code::Unreadable]);
    assert_eq!(codes("notes.md"), []);
}

#[test]
fn a_scenario_is_no_source() {
    let folder = folder(&[("a.stl", "A I 0.0\n"), ("a.scenario.toml", "[[at]]\ncycle = 1\nset = { \"I0.0\" = 1 }\n")]);
    let named = read(&[folder.path().join("a.stl"), folder.path().join("a.scenario.toml")]);
    let codes: Vec<Code> = named.diagnostics.iter().map(|message| message.code).collect();
    assert_eq!((named.units.len(), codes), (1, vec![Code::NotASource]));
    let all = read(&[folder.path().to_path_buf()]);
    assert_eq!((all.units.len(), all.diagnostics.len()), (1, 0));
}

/// Reading a pipe would wait forever.
#[cfg(unix)]
#[test]
fn what_is_no_file_is_not_read() {
    use std::os::unix::fs::symlink;
    let folder = folder(&[("a.stl", "A I 0.0\n")]);
    let pipe = folder.path().join("pipe.stl");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.is_ok_and(|status| status.success()));
    symlink(folder.path(), folder.path().join("again")).unwrap();
    symlink("loop.stl", folder.path().join("loop.stl")).unwrap();
    symlink("/dev/zero", folder.path().join("zero.stl")).unwrap();
    symlink("/proc/kmsg", folder.path().join("kernel.stl")).unwrap();
    for name in ["pipe.stl", "loop.stl", "zero.stl", "kernel.stl"] {
        let read = read(&[folder.path().join(name)]);
        let codes: Vec<Code> = read.diagnostics.iter().map(|message| message.code).collect();
        assert_eq!(codes, [Code::Unreadable], "{name}");
    }
    let all = read(&[folder.path().to_path_buf()]);
    let codes: Vec<Code> = all.diagnostics.iter().map(|message| message.code).collect();
    assert_eq!((all.units.len(), codes), (1, vec![Code::NotRead]));
    let help = all.diagnostics[0].help.clone().unwrap_or_default();
    for name in ["pipe.stl", "loop.stl", "zero.stl", "kernel.stl", "again"] {
        assert!(help.contains(name), "{name}: {help}");
    }
}

#[test]
fn what_a_run_has_written_is_no_part_of_the_program() {
    let log = "Record,Date,UTC Time,Level\r\n1,01/31/2026,06:00:00.010,2.5\r\n//END\r\n";
    let folder = folder(&[
        ("plc.toml", "name = \"tank\"\n"),
        ("a.stl", "A I 0.0\n"),
        ("plc-data/DataLogs/level.csv", log),
        ("plc-data/DataLogs/level.json", "{\"db\":1}\n"),
        ("plc-data/b.stl", "A I 0.0\n"),
    ]);
    let found = read(&[folder.path().to_path_buf()]);
    assert_eq!((found.units.len(), found.diagnostics.len()), (1, 0));
    fs::remove_file(folder.path().join("plc.toml")).unwrap();
    let found = read(&[folder.path().to_path_buf()]);
    assert_eq!((found.units.len(), found.diagnostics.len()), (1, 0));
    fs::rename(folder.path().join("plc-data"), folder.path().join("logs")).unwrap();
    fs::write(folder.path().join("plc.toml"), "data = \"logs\"\n").unwrap();
    let found = read(&[folder.path().to_path_buf()]);
    assert_eq!((found.units.len(), found.diagnostics.len()), (1, 0));
    // Retentive memory, the certificate and the key of the OPC UA server.
    fs::write(folder.path().join("tank.retain"), b"PLCRET2\n\x10\0\0\0\0\0\0\0").unwrap();
    fs::create_dir(folder.path().join("opcua")).unwrap();
    fs::write(folder.path().join("opcua/own.der"), b"0\x82\x03\x2C0\x82\x02\x14\xA0\x03\x02\x01").unwrap();
    fs::write(folder.path().join("opcua/own.pem"), "-----BEGIN PRIVATE KEY-----\nMIIEvgIBADAN\n").unwrap();
    let found = read(&[folder.path().to_path_buf()]);
    assert_eq!((found.units.len(), found.diagnostics.len()), (1, 0));
    // The folder of the program itself is not only a folder of data.
    fs::write(folder.path().join("plc.toml"), "data = \".\"\n").unwrap();
    assert_eq!(read(&[folder.path().to_path_buf()]).units.len(), 2);
}

#[test]
fn a_project_names_its_sources() {
    let folder = folder(&[
        ("plc.toml", "name = \"tank\"\nsources = [\"a.stl\", \"gone.stl\"]\n"),
        ("a.stl", "A I 0.0\n"),
        ("b.stl", "A I 0.0\n"),
    ]);
    let read = read(&[folder.path().to_path_buf()]);
    assert_eq!((read.name.as_str(), read.units.len()), ("tank", 1));
    assert_eq!(read.diagnostics[0].code, Code::Project);
}
