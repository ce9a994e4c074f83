//! A program and its document are compared by a sum, which both have in each cycle.

use std::fs;
use std::path::{Path, PathBuf};

use plcc_driver::inputs::TestInput;

use super::{outcomes, project_document};
use crate::has_errors;

/// A scenario that expects in each cycle what the sum never is.
fn each_cycle(sum: &str, cycles: u32) -> String {
    (1..=cycles).map(|cycle| format!("[[at]]\ncycle = {cycle}\nexpect = {{ '{sum}' = -1 }}\n")).collect()
}

/// The values of the sum in all cycles.
fn sums(input: TestInput) -> Result<Vec<String>, String> {
    let outcomes = outcomes(input);
    match outcomes.iter().find(|one| one.rejected || one.unreadable || one.details.is_empty()) {
        Some(one) => Err(format!("{}{}", one.messages, one.failures)),
        None => Ok(outcomes.iter().flat_map(|one| &one.details).map(|one| one.left.clone()).collect()),
    }
}

/// The same of a file.
pub fn sums_of_file(file: PathBuf, sum: &str, cycles: u32) -> Result<Vec<String>, String> {
    fs::write(file.with_extension("scenario.toml"), each_cycle(sum, cycles)).expect("a file");
    sums(TestInput::File(file))
}

/// A program that gives the instance of "Line" `inputs` by chance, and sums up its outputs: `bits`, and `numbers`.
pub fn around(inputs: &str, bits: &[&str], numbers: &str) -> String {
    let sum = |(at, bit): (usize, &&str)| {
        format!("  IF \"Line_DB\".{bit} THEN \"Sum_DB\".sum := (\"Sum_DB\".sum * 3 + {}) MOD 100003; END_IF;\n", at + 1)
    };
    let lines: Vec<String> = bits.iter().enumerate().map(sum).collect();
    let lines = lines.concat();
    format!(
        r##"//@ test cycles=300
DATA_BLOCK "Line_DB" "Line"
BEGIN
END_DATA_BLOCK

DATA_BLOCK "Sum_DB"
STRUCT
  seed : DINT := 1;
  sum : DINT;
END_STRUCT;
BEGIN
END_DATA_BLOCK

ORGANIZATION_BLOCK "Main"
BEGIN
  "Sum_DB".seed := ("Sum_DB".seed * 75 + 74) MOD 65537;
  "Line_DB"({inputs});
{lines}  "Sum_DB".sum := ("Sum_DB".sum + {numbers}) MOD 100003;
END_ORGANIZATION_BLOCK
"##
    )
}

/// The numbers of the blocks of a project.
pub const NUMBERS: &str = "\
\"Line\",\"FB 1\",\"FB 1\",\"\"\n\
\"Line_DB\",\"DB 1\",\"FB 1\",\"\"\n\
\"Calls\",\"FC 7\",\"FC 7\",\"\"\n\
\"Sum_DB\",\"DB 2\",\"DB 2\",\"\"\n";

/// A project of `source`, the program around it, and the numbers of all blocks.
pub fn project_of(folder: &Path, (name, source): (&str, &str), main: &str, numbers: &str) -> PathBuf {
    let project = folder.join("project");
    fs::create_dir_all(&project).expect("a folder");
    let toml = format!("cpu = \"s7-300\"\nsources = [\"{name}\", \"main.scl\"]\nsymbols = [\"tags.sdf\"]\n");
    for (name, text) in [("plc.toml", toml.as_str()), (name, source), ("main.scl", main), ("tags.sdf", numbers)] {
        fs::write(project.join(name), text).expect("a file");
    }
    project
}

/// Converts a project, whose program then does the same in each of its 300 cycles; the document contains `parts`.
pub fn converts_to_the_same(folder: &Path, project: &Path, parts: &[&str]) {
    fs::create_dir(project.join("tests")).expect("a folder");
    fs::write(project.join("tests/sum.toml"), each_cycle("\"Sum_DB\".sum", 300)).expect("a file");
    let before = sums(TestInput::Project(project.to_path_buf())).expect("a program");
    assert_eq!(before.len(), 300);
    let (written, messages) = project_document(project);
    assert!(!has_errors(&messages), "{messages:#?}");
    for &part in parts {
        assert!(written.contains(part), "{part} in\n{written}");
    }
    let file = folder.join("a.xml");
    let pragma = plcc_convert::with_pragmas(&written, &["cpu s7-300".to_string()]);
    fs::write(&file, &pragma).expect("a file");
    let after = sums_of_file(file, "\"GlobalVariables\".Sum_DB.sum", 300);
    let after = after.unwrap_or_else(|messages| panic!("{messages}\n{written}"));
    assert_eq!(before, after, "{written}");
}
