//! Executables that plcc links itself: without a linker, always the same bytes, and usable for debuggers.

use std::path::Path;
use std::process::{Command, Output};

use object::read::elf::ElfFile64;
use object::{LittleEndian, Object, ObjectSection, ObjectSymbol, SymbolKind};

use crate::PLCC;

/// Several blocks, so that code calls code; a clock that the runtime keeps; lines of a file.
const PROGRAM: &str = "FUNCTION FC 1 : VOID
VAR_INPUT
  x : INT;
END_VAR
BEGIN
      CALL  FC 2
      L     MW 0
      L     #x
      +I
      T     MW 0
      BEU
END_FUNCTION
FUNCTION FC 2 : VOID
BEGIN
      L     MW 2
      +     1
      T     MW 2
END_FUNCTION
ORGANIZATION_BLOCK OB 1
VAR_TEMP
  info : ARRAY [0..19] OF BYTE;
END_VAR
BEGIN
      CALL  FC 1 (x := 7);
END_ORGANIZATION_BLOCK
";

/// Builds the program in `folder` without the variables of this process; there is no `PATH` in which a linker could be.
fn build(folder: &Path, output: &str, flags: &[&str]) -> Vec<u8> {
    std::fs::write(folder.join("program.stl"), PROGRAM).expect("the folder can be written");
    let mut plcc = Command::new(PLCC);
    if !flags.contains(&"--linker") {
        plcc.env_clear();
    }
    let built = plcc.current_dir(folder).args(["build", "program.stl", "-o", output]).args(flags).output();
    let built = built.expect("it starts");
    assert_eq!(built.status.code(), Some(0), "{}", String::from_utf8_lossy(&built.stderr));
    std::fs::read(folder.join(output)).expect("it was built")
}

fn run(folder: &Path, program: &str) -> Output {
    let flags = ["--cycles", "3", "--clock", "virtual", "--print", "MW0,MW2"];
    Command::new(folder.join(program)).args(flags).output().expect("it starts")
}

fn section<'a>(file: &ElfFile64<'a, LittleEndian>, name: &str) -> &'a [u8] {
    file.section_by_name(name).unwrap_or_else(|| panic!("there is {name}")).data().expect("it is in the file")
}

/// Address of a function.
fn address(file: &ElfFile64<'_, LittleEndian>, name: &str) -> u64 {
    range(file, name)[0]
}

/// Where the runtime keeps the address of memory.
fn memory(file: &ElfFile64<'_, LittleEndian>) -> u64 {
    let symbol = file.symbols().find(|symbol| symbol.name() == Ok(plcc_abi::linked::MEMORY_SYMBOL));
    symbol.expect("debuggers need it").address()
}

/// Address of a function and of its end.
fn range(file: &ElfFile64<'_, LittleEndian>, name: &str) -> [u64; 2] {
    let symbol = file.symbols().find(|symbol| symbol.name() == Ok(name)).unwrap_or_else(|| panic!("there is {name}"));
    assert_eq!(symbol.kind(), SymbolKind::Text, "{name}");
    assert!(symbol.size() > 0, "{name}");
    [symbol.address(), symbol.address() + symbol.size()]
}

#[test]
fn no_linker_is_needed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    build(folder.path(), "program", &[]);
    let output = run(folder.path(), "program");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(String::from_utf8_lossy(&output.stdout), "MW0 = 16#0015\nMW2 = 16#0003\n", "{errors}");
    assert_eq!(output.status.code(), Some(0), "{errors}");
}

#[test]
fn the_same_program_gives_the_same_bytes() {
    let (first, second) = (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("another folder"));
    assert!(build(first.path(), "program", &[]) == build(second.path(), "other", &[]));
}

#[test]
fn debuggers_see_what_a_linker_would_show_them() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (own, other) =
        (build(folder.path(), "own", &["-O0"]), build(folder.path(), "other", &["-O0", "--linker", "cc"]));
    assert_eq!(run(folder.path(), "own").stdout, run(folder.path(), "other").stdout);
    let own = ElfFile64::<LittleEndian>::parse(&*own).expect("an executable");
    let other = ElfFile64::<LittleEndian>::parse(&*other).expect("an executable");
    let names: Vec<&str> = other.symbols().filter_map(|symbol| symbol.name().ok()).collect();
    let functions: Vec<&str> =
        names.into_iter().filter(|name| name.starts_with("plcc_FC") || name.starts_with("plcc_OB")).collect();
    assert!(["plcc_OB1", "plcc_FC1", "plcc_FC2"].iter().all(|name| functions.contains(name)), "{functions:?}");
    // The sections differ in the addresses of functions only.
    let moved = address(&own, "plcc_OB1").wrapping_sub(address(&other, "plcc_OB1"));
    for function in &functions {
        assert_eq!(address(&own, function), address(&other, function).wrapping_add(moved), "{function}");
    }
    for name in [".debug_line", ".debug_info", ".debug_ranges", ".debug_abbrev"] {
        let (own_bytes, mut expected) = (section(&own, name), section(&other, name).to_vec());
        let mut moved_addresses = 0;
        let edges: std::collections::BTreeSet<u64> =
            functions.iter().flat_map(|function| range(&other, function)).collect();
        let edges = edges.into_iter().map(|before| (before, before.wrapping_add(moved)));
        // Variables count from the memory of the runtime.
        for (before, after) in edges.chain([(memory(&other), memory(&own))]) {
            let after = after.to_le_bytes();
            let mut from = 0;
            while let Some(at) = expected[from..].windows(8).position(|bytes| bytes == before.to_le_bytes()) {
                expected[from + at..from + at + 8].copy_from_slice(&after);
                from += at + 8;
                moved_addresses += 1;
            }
        }
        assert!(own_bytes == expected, "{name}");
        assert!(moved_addresses > 0 || name == ".debug_abbrev", "{name}");
    }
    // The runtime is there for profilers.
    address(&own, "main");
    address(&own, plcc_abi::RuntimeFn::Safepoint.symbol());
}

#[test]
fn a_running_executable_can_be_built_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    build(folder.path(), "program", &[]);
    let mut running = Command::new(folder.path().join("program")).args(["--quiet"]).spawn().expect("it starts");
    build(folder.path(), "program", &[]);
    assert_eq!(run(folder.path(), "program").status.code(), Some(0));
    assert_eq!(running.try_wait().expect("it is a child"), None, "it goes on");
    running.kill().expect("it is a child");
    running.wait().expect("it is a child");
}

#[test]
fn an_output_that_cannot_be_written_is_named_by_its_folder() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("program.stl"), PROGRAM).expect("the folder can be written");
    let told = |output: &str| {
        let plcc = Command::new(PLCC).current_dir(&folder).args(["build", "program.stl", "-o", output]).output();
        let plcc = plcc.expect("it starts");
        assert_eq!(plcc.status.code(), Some(2));
        String::from_utf8_lossy(&plcc.stderr).into_owned()
    };
    let missing = told("none/program");
    assert!(missing.contains("there is no folder `none`; create it first"), "{missing}");
    let file = told("program.stl/program");
    assert!(file.contains("`program.stl` is a file, not a folder"), "{file}");
    for text in [missing, file] {
        assert!(!text.contains(".plcc-") && !text.contains("os error"), "{text}");
    }
}

#[test]
fn an_output_stays_a_link() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let real = folder.path().join("real");
    std::fs::write(&real, "old").expect("the folder can be written");
    let link = folder.path().join("program");
    std::os::unix::fs::symlink("real", &link).expect("the folder can be written");
    build(folder.path(), "program", &[]);
    assert!(link.is_symlink());
    assert_eq!(run(folder.path(), "real").status.code(), Some(0));
    assert_eq!(std::fs::read(&real).expect("it was built"), build(folder.path(), "program", &[]));
    // Also if nothing is at its end yet.
    std::fs::remove_file(&real).expect("it was built");
    build(folder.path(), "program", &[]);
    assert!(link.is_symlink() && real.is_file());
}

#[test]
fn an_output_stays_when_the_disk_is_full() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("program.stl"), PROGRAM).expect("the folder can be written");
    std::fs::write(folder.path().join("program.o"), "old").expect("the folder can be written");
    // No file may have more than a block of 512 bytes.
    let limited = format!("trap '' XFSZ; ulimit -f 1; exec '{PLCC}' build --emit obj program.stl");
    let plcc = Command::new("sh").current_dir(&folder).args(["-c", &limited]).output().expect("there is a shell");
    let told = String::from_utf8_lossy(&plcc.stderr);
    assert_eq!(plcc.status.code(), Some(2), "{told}");
    assert!(told.contains("cannot write `program.o`: file too large"), "{told}");
    assert_eq!(std::fs::read_to_string(folder.path().join("program.o")).expect("it is there"), "old");
}
