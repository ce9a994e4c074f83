//! STL becomes LD, which does the same or is refused.

use std::path::{Path, PathBuf};

use super::project_document;
use super::same::{NUMBERS, around, converts_to_the_same, project_of};

/// A block of STL with a box of several statements, and edges.
const STATEMENTS: &str = r##"FUNCTION_BLOCK "Line"
VAR_INPUT
  start : BOOL;
  stop : BOOL;
  speed : INT;
END_VAR
VAR_OUTPUT
  run : BOOL;
  fast : BOOL;
  once : BOOL;
  out : INT;
END_VAR
VAR
  edge : BOOL;
END_VAR
BEGIN
NETWORK
TITLE = latch
// keeps itself
      A(;
      O     #start;
      O     #run;
      );
      AN    #stop;
      =     #run;
NETWORK
TITLE = limits
      A     #run;
      A(;
      L     #speed;
      L     100;
      >I;
      );
      =     #fast;
      A     #start;
      FP    #edge;
      =     #once;
NETWORK
      A     #stop;
      JNB   _001;
      L     #speed;
      L     7;
      +I;
      T     #out;
      AN    OV;
      SAVE;
      CLR;
_001: A     BR;
      S     #fast;
END_FUNCTION_BLOCK
"##;

/// A project of statements.
fn statements_project(folder: &Path, statements: &str) -> PathBuf {
    let inputs = r#"start := "Sum_DB".seed MOD 2 = 1, stop := ("Sum_DB".seed / 4) MOD 2 = 1,
    speed := DINT_TO_INT("Sum_DB".seed MOD 200)"#;
    let main = around(inputs, &["run", "fast", "once"], r#"INT_TO_DINT("Line_DB".out)"#);
    let numbers = NUMBERS.replace("\"Calls\",\"FC 7\",\"FC 7\",\"\"\n", "");
    project_of(folder, ("line.stl", statements), &main, &numbers)
}

/// STL becomes LD, which does the same.
#[test]
fn statements_as_projects_do_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let project = statements_project(folder.path(), STATEMENTS);
    converts_to_the_same(folder.path(), &project, &["<xhtml:p>latch\nkeeps itself</xhtml:p>"]);
}

/// What has no LAD is named once, with its statement.
#[test]
fn statements_without_networks_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let statements = STATEMENTS.replace("      T     #out;\n", "      SRW   3;\n      TAK;\n      T     #out;\n");
    let (written, messages) = project_document(&statements_project(folder.path(), &statements));
    let errors: Vec<_> = messages.iter().filter(|one| one.is_error()).collect();
    assert_eq!((errors.len(), written.as_str()), (1, ""), "{messages:#?}");
}
