//! `plcc status` looks, and leaves the files of a program alone.

use std::fs;

use crate::plcc;

const PROGRAM: &str = "\
FUNCTION_BLOCK \"Log\"
VAR_OUTPUT
  status : WORD;
END_VAR
VAR
  name : STRING := 'level';
  header : STRING := 'Level';
  id : DWORD;
  create : DataLogCreate;
END_VAR
BEGIN
  #create(REQ := TRUE, RECORDS := 10, NAME := #name, ID := #id, HEADER := #header, DATA := \"Store\".level);
  IF #create.ERROR THEN
    #status := #create.STATUS;
  END_IF;
  \"Store\".level := \"Store\".level + 1;
END_FUNCTION_BLOCK

DATA_BLOCK \"Store\"
  VAR
    level : INT;
  END_VAR
BEGIN
END_DATA_BLOCK

DATA_BLOCK \"Log_DB\" \"Log\"
BEGIN
END_DATA_BLOCK

ORGANIZATION_BLOCK \"Main\"
BEGIN
  \"Log_DB\"();
END_ORGANIZATION_BLOCK
";

#[test]
fn files_of_the_program_stay_as_they_were() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("the folder can be written");
    write("main.scl", PROGRAM);
    write("plc.toml", "cpu = \"s7-1500\"\nsources = [\"main.scl\"]\n\n[retain]\nfile = \"plant.retain\"\n");
    write(
        "late.toml",
        "[[at]]\ncycle = 2\nexpect = { \"Store.level\" = 3 }\n\n[[at]]\ncycle = 9\nexpect = { \"Store.level\" = 3 }\n",
    );
    let words = ["status", ".", "--block", "Log", "--cycle", "2", "--scenario", "late.toml"];
    // The second run sees the same as the first: the log is not there yet.
    for _ in 0..2 {
        let output = plcc(&folder, &words);
        let (shown, said) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert!(shown.contains("FB1 (Log), cycle 2, 10 ms, instance "), "{shown}{said}");
        assert!(shown.contains("#create.ERROR = 0"), "{shown}{said}");
        // Only what was not met up to the cycle is told.
        assert!(said.contains("late.toml:3: expected Store.level = 3, but it is 2"), "{said}");
        assert!(!said.contains("not reached"), "{said}");
        assert_eq!(output.status.code(), Some(1), "{said}");
    }
    assert!(!folder.path().join("plc-data").exists());
    assert!(!folder.path().join("plant.retain").exists());
}
