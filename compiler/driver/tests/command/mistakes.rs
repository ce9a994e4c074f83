//! Mistakes in what is beside the sources: plc.toml, symbol tables, scenarios. A folder of `mistakes` is a project; the text file with its
//! name is a command, and what it says. `UPDATE_EXPECT=1` renews it.

use std::fs;
use std::path::Path;

use crate::plcc;

#[test]
fn each_mistake_has_its_message() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/command/mistakes");
    let mut projects: Vec<_> = fs::read_dir(&folder)
        .expect("the folder is there")
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_dir())
        .collect();
    projects.sort();
    assert!(projects.len() > 10, "{} projects", projects.len());
    let mut differences = String::new();
    for project in projects {
        let name = project.file_name().unwrap().to_string_lossy().into_owned();
        let file = project.with_extension("txt");
        let expected = fs::read_to_string(&file).unwrap_or_default();
        let command = match expected.lines().next() {
            Some(line) => line.to_owned(),
            None => format!("plcc check {name}"),
        };
        let words: Vec<&str> = command.split_whitespace().skip(1).collect();
        let output = plcc(&folder, &words);
        let found = format!(
            "{command}\n{}{}",
            String::from_utf8_lossy(&output.stdout),
            String::from_utf8_lossy(&output.stderr)
        );
        if found == expected {
            continue;
        }
        if std::env::var_os("UPDATE_EXPECT").is_some() {
            fs::write(&file, found).expect("the folder can be written");
        } else {
            differences += &format!("{}:\n{found}\n", file.display());
        }
    }
    assert!(differences.is_empty(), "{differences}");
}
