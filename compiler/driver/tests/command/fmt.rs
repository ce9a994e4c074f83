//! `plcc fmt` on files: what it writes, what it leaves alone, and that the program stays the same.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::{PLCC, plcc};

#[test]
fn encoding_and_line_ends_stay() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let ugly = b"FUNCTION FC 1 : VOID\r\nBEGIN\r\n  U E 0.0 ;// gro\xDFe St\xF6rung\r\n\t= A 4.0;\r\nEND_FUNCTION\r\n";
    let tidy =
        b"FUNCTION FC 1 : VOID\r\nBEGIN\r\n      U     E 0.0;      // gro\xDFe St\xF6rung\r\n      =     A 4.0;\r\nEND_FUNCTION\r\n";
    fs::write(folder.join("a.awl"), ugly).expect("the folder can be written");
    let check = plcc(folder, &["fmt", "--check", "."]);
    assert_eq!((check.status.code(), String::from_utf8_lossy(&check.stdout).trim()), (Some(1), "./a.awl"));
    assert_eq!(fs::read(folder.join("a.awl")).expect("it is there"), ugly);
    assert_eq!(plcc(folder, &["fmt", "a.awl"]).status.code(), Some(0));
    let made = fs::read(folder.join("a.awl")).expect("it is there");
    assert_eq!(String::from_utf8_lossy(&made), String::from_utf8_lossy(tidy));
    assert_eq!(made, tidy);
    assert_eq!(plcc(folder, &["fmt", "--check", "a.awl"]).status.code(), Some(0));
}

#[test]
fn a_source_stays_when_the_disk_is_full() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    // 2,000 bytes become 4,500. No file may have more than eight blocks of 512 bytes.
    let ugly = "A I 0.0\n".repeat(250);
    fs::write(folder.join("a.stl"), &ugly).expect("the folder can be written");
    let limited = format!("trap '' XFSZ; ulimit -f 8; exec '{PLCC}' fmt a.stl");
    let output = Command::new("sh").current_dir(folder).args(["-c", &limited]).output().expect("there is a shell");
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(fs::read_to_string(folder.join("a.stl")).expect("it is there"), ugly);
    assert_eq!(plcc(folder, &["fmt", "a.stl"]).status.code(), Some(0));
    assert_eq!(fs::read(folder.join("a.stl")).expect("it is there").len(), 4500);
}

#[test]
fn words_of_scl_have_blanks_around_them() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let ugly = "FUNCTION \"F\" : VOID\nVAR_INPUT a:BOOL;x:INT; END_VAR\nVAR_TEMP y:ARRAY[0..3]OF INT;q:BOOL; END_VAR\nBEGIN\n\
                again:\nIF(#a)AND(NOT#q)OR#q THEN#q:=TRUE;END_IF;\n#q:=#x>3AND#x<5;\n#y[0]:=(#x)MOD(3);\n\
                CASE #x OF 1:#q:=TRUE;ELSE:#q:=FALSE;END_CASE;\nGOTO again;\nEND_FUNCTION\n";
    let tidy = "FUNCTION \"F\" : VOID\nVAR_INPUT\n  a : BOOL;\n  x : INT;\nEND_VAR\nVAR_TEMP\n  y : ARRAY[0..3] OF INT;\n  \
                q : BOOL;\nEND_VAR\nBEGIN\n  again:\n  IF (#a) AND (NOT #q) OR #q THEN\n    #q := TRUE;\n  END_IF;\n  \
                #q := #x > 3 AND #x < 5;\n  #y[0] := (#x) MOD (3);\n  CASE #x OF\n    1: #q := TRUE;\n    ELSE: #q := FALSE;\n  \
                END_CASE;\n  GOTO again;\nEND_FUNCTION\n";
    fs::write(folder.join("a.scl"), ugly).expect("the folder can be written");
    assert_eq!(plcc(folder, &["fmt", "a.scl"]).status.code(), Some(0));
    assert_eq!(fs::read_to_string(folder.join("a.scl")).expect("it is there"), tidy);
    assert_eq!(plcc(folder, &["fmt", "--check", "a.scl"]).status.code(), Some(0));
}

#[test]
fn statements_begin_lines_after_comments_too() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let ugly = "FUNCTION \"F\" : VOID\nVAR_TEMP (* a *) x : INT; (* b *) y : INT;\nEND_VAR\nBEGIN\n\
                WHILE(#x<3)DO (* c *) #x:=#x+1; (* d *) #y:=1;END_WHILE;\n\
                IF NOT(#x=1) THEN (* e *) #x:=1; ELSE (* f *) #x:=2;END_IF;\nREPEAT (* h *) #x:=1;\nUNTIL(#x=1)END_REPEAT;\nEND_FUNCTION\n";
    let tidy = "FUNCTION \"F\" : VOID\nVAR_TEMP (* a *)\n  x : INT; (* b *)\n  y : INT;\nEND_VAR\nBEGIN\n  \
                WHILE (#x < 3) DO (* c *)\n    #x := #x + 1; (* d *)\n    #y := 1;\n  END_WHILE;\n  \
                IF NOT (#x = 1) THEN (* e *)\n    #x := 1;\n  ELSE (* f *)\n    #x := 2;\n  END_IF;\n  \
                REPEAT (* h *)\n    #x := 1;\n  UNTIL (#x = 1) END_REPEAT;\nEND_FUNCTION\n";
    fs::write(folder.join("a.scl"), ugly).expect("the folder can be written");
    assert_eq!(plcc(folder, &["fmt", "a.scl"]).status.code(), Some(0));
    assert_eq!(fs::read_to_string(folder.join("a.scl")).expect("it is there"), tidy);
    assert_eq!(plcc(folder, &["fmt", "--check", "a.scl"]).status.code(), Some(0));
}

#[test]
fn comments_before_words_that_close_have_lines() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let ugly = "FUNCTION \"F\" : VOID\nVAR_TEMP\nx : INT;\nEND_VAR\nBEGIN\nIF #x=1 THEN\n#x:=2;\n(* c *) ELSE\n\
                #x:=#x (* d *) +1;\n(* e *) END_IF;\nEND_FUNCTION\n";
    let tidy = "FUNCTION \"F\" : VOID\nVAR_TEMP\n  x : INT;\nEND_VAR\nBEGIN\n  IF #x = 1 THEN\n    #x := 2;\n  (* c *)\n  \
                ELSE\n    #x := #x (* d *) + 1;\n    (* e *)\n  END_IF;\nEND_FUNCTION\n";
    fs::write(folder.join("a.scl"), ugly).expect("the folder can be written");
    assert_eq!(plcc(folder, &["fmt", "a.scl"]).status.code(), Some(0));
    assert_eq!(fs::read_to_string(folder.join("a.scl")).expect("it is there"), tidy);
    assert_eq!(plcc(folder, &["fmt", "--check", "a.scl"]).status.code(), Some(0));
}

#[test]
fn a_source_with_errors_is_left_alone() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let wrong = "FUNCTION FC 1 : VOID\nBEGIN\n A M 0.0 )) ;\nEND_FUNCTION\n";
    fs::write(folder.join("a.stl"), wrong).expect("the folder can be written");
    let output = plcc(folder, &["fmt", "a.stl"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&output.stderr).starts_with("error["));
    assert_eq!(fs::read_to_string(folder.join("a.stl")).expect("it is there"), wrong);
}

#[test]
fn the_end_of_a_region_may_have_its_name() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let tidy = "FUNCTION \"F\" : Void\nBEGIN\n  REGION a\n    REGION b\n      ;\n    END_REGION b\n    ;\n  END_REGION;\n  ;\nEND_FUNCTION\n";
    fs::write(folder.join("a.scl"), tidy.replace("  ", "")).expect("the folder can be written");
    assert_eq!(plcc(folder, &["fmt", "a.scl"]).status.code(), Some(0));
    assert_eq!(fs::read_to_string(folder.join("a.scl")).expect("it is there"), tidy);
}

/// Every so many files of tests/run are laid out and compiled.
const STRIDE: usize = 61;

#[test]
fn the_program_stays_the_same() {
    let mut files = Vec::new();
    files_below(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run"), &mut files);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (mut compared, mut same) = (0, 0);
    for (index, path) in files.iter().step_by(STRIDE).enumerate() {
        let name = format!("{index}.{}", path.extension().expect("sources have one").to_string_lossy());
        let copy = folder.path().join(&name);
        fs::copy(path, &copy).expect("the folder can be written");
        let Some((before, sites)) = ir(folder.path(), &name) else { continue };
        let tested = plcc(folder.path(), &["test", &name]).stdout;
        let output = plcc(folder.path(), &["fmt", &name]);
        assert_eq!(output.status.code(), Some(0), "{}: {}", path.display(), String::from_utf8_lossy(&output.stderr));
        let (after, new_sites) = ir(folder.path(), &name).expect("it compiles as before");
        // Statements that shared a line and do so no more have places of their own, which the code hands to the runtime.
        assert!(sites != new_sites || before == after, "{}", path.display());
        assert!(tested == plcc(folder.path(), &["test", &name]).stdout, "{}", path.display());
        compared += 1;
        same += usize::from(sites == new_sites);
    }
    assert!(compared > 10 && same > 5, "only {compared} programs were compared, {same} by their IR");
}

/// The IR of a program without its lines, and the number of places that its code names.
fn ir(folder: &Path, name: &str) -> Option<(String, usize)> {
    let output = plcc(folder, &["build", "--emit", "ir", "-O0", name]);
    let text = String::from_utf8_lossy(&output.stdout);
    let is_site = |line: &&str| line.starts_with("site ");
    let code: Vec<&str> = text.lines().filter(|line| !is_site(line)).collect();
    output.status.success().then(|| (code.join("\n"), text.lines().filter(is_site).count()))
}

fn files_below(folder: &Path, out: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).expect("the folder is there").flatten().map(|entry| entry.path()).collect();
    entries.sort();
    for path in entries {
        let extension = path.extension().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() {
            files_below(&path, out);
        } else if ["stl", "awl", "scl", "gr7", "s7dcl"].contains(&extension.as_str()) {
            out.push(path);
        }
    }
}
