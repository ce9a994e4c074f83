//! gdb shows and changes the values of a program by their names.
//!
//! Ignored where gdb is not installed.

use std::path::Path;
use std::process::{Command, ExitCode};

use libtest_mimic::{Arguments, Failed, Trial};
use plcc_driver::cli::Level;
use plcc_driver::pipeline::{self, Settings};
use plcc_driver::{inputs, link};
use plcc_tests::kernels;

fn main() -> ExitCode {
    plcc_tests::provide_runtimes();
    let missing = !kernels::has("gdb");
    let trial = |name: &str, check: fn() -> Result<(), String>| {
        let run = move || plcc_driver::on_large_stack(check).and_then(|result| result).map_err(Failed::from);
        Trial::test(name, run).with_ignored_flag(missing)
    };
    let trials = vec![trial("gdb/stl", stl), trial("gdb/scl", scl)];
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}

const STL: &str = "DATA_BLOCK DB 10
STRUCT
  Count : INT := -2;
  Level : REAL := 1.5;
  Flags : ARRAY [0..9] OF BOOL;
  Ready : BOOL;
  Table : ARRAY [1..2, 0..1] OF DINT;
  Name : STRING [6] := 'pump';
  Limit : STRUCT
    High : WORD := W#16#1234;
  END_STRUCT;
END_STRUCT
BEGIN
  Flags[9] := TRUE;
  Table[2, 0] := L#100000;
END_DATA_BLOCK

DATA_BLOCK DB 11
STRUCT
  Bytes : ARRAY [0..3] OF BYTE := B#16#7;
END_STRUCT
BEGIN
END_DATA_BLOCK

FUNCTION FC 1 : VOID
BEGIN
      L     MW 20
      T     MW 30
      A     M 4.2
      =     M 4.4
END_FUNCTION

ORGANIZATION_BLOCK OB 1
VAR_TEMP
  info : ARRAY [0..19] OF BYTE;
END_VAR
BEGIN
      L     MW 20
      +     300
      T     MW 20
      SET
      =     M 4.2
      =     Q 4.1
      CALL  FC 1
END_ORGANIZATION_BLOCK
";

const SYMBOLS: &str = "\
\"Speed                   \",\"MW     20 \",\"INT       \",\"\"
\"Motor on                \",\"M       4.2 \",\"BOOL      \",\"\"
\"Lamp                    \",\"Q       4.1 \",\"BOOL      \",\"\"
\"Values                  \",\"DB     10 \",\"DB     10 \",\"\"
";

/// Each command with what gdb says to it.
fn stl() -> Result<(), String> {
    let steps = [
        ("print Speed", "$1 = 600"),
        ("print 'Motor on'", "$2 = true"),
        ("print Lamp", "$3 = true"),
        ("print/x M[20]@2", "$4 = {0x2, 0x58}"),
        ("print Q[4]", "$5 = 2 '\\002'"),
        ("print Values.Count", "$6 = -2"),
        ("print DB10.Level", "$7 = 1.5"),
        ("print DB10.Flags._9", "$8 = true"),
        ("print DB10.Flags._8", "$9 = false"),
        ("print DB10.Ready", "$10 = false"),
        ("print DB10.Table", "$11 = {{0, 0}, {100000, 0}}"),
        ("print DB10.Table[2][0]", "$12 = 100000"),
        ("print DB10.Name", "$13 = {max = 6 '\\006', length = 4 '\\004', text = \"pump\\000\"}"),
        ("print/x DB10.Limit", "$14 = {High = 0x1234}"),
        ("print DB11.Bytes", "$15 = \"\\a\\000\\000\""),
        ("set var Speed = -5", ""),
        ("set var 'Motor on' = 0", ""),
        ("set var DB10.Level = -2.25", ""),
        ("set var DB10.Ready = 1", ""),
        ("set var DB10.Table[1][1] = 7", ""),
        ("print M[4]", "$16 = 16 '\\020'"),
        ("delete", ""),
    ];
    let printed =
        session(&[("main.stl", STL), ("symbols.sdf", SYMBOLS)], &steps, "MW30,M4.4,DB10.DBD2,DB10.DBX8.0,DB10.DBD14")?;
    // The bit was reset before FC 1 looked at it; the value of Speed was taken in the same cycle.
    let expected =
        ["MW30 = 16#FFFB", "M4.4 = 0", "DB10.DBD2 = 16#C0100000", "DB10.DBX8.0 = 1", "DB10.DBD14 = 16#00000007"];
    if printed == expected { Ok(()) } else { Err(format!("the program printed {printed:?}")) }
}

const SCL: &str = "FUNCTION_BLOCK \"Tank\"
VAR_INPUT
  open : BOOL;
END_VAR
VAR
  level : LREAL := 0.5;
  count : ULINT := 5000000000;
  samples : ARRAY[-1..1] OF INT;
  flags : ARRAY[-1..1] OF BOOL;
  delay : TIME := T#1s500ms;
END_VAR
BEGIN
  #level := #level + 1.0;
  #samples[1] := -7;
  #flags[-1] := #open;
  \"Work\"();
END_FUNCTION_BLOCK

FUNCTION \"Work\" : VOID
BEGIN
  %MW2 := %MW2 + 1;
END_FUNCTION

DATA_BLOCK \"TankDb\"
\"Tank\"
BEGIN
END_DATA_BLOCK

ORGANIZATION_BLOCK \"Main\"
BEGIN
  \"TankDb\"(open := TRUE);
END_ORGANIZATION_BLOCK
";

fn scl() -> Result<(), String> {
    let steps = [
        ("print TankDb.level", "$1 = 2.5"),
        ("print TankDb.count", "$2 = 5000000000"),
        ("print TankDb.samples", "$3 = {0, 0, -7}"),
        ("print TankDb.samples[1]", "$4 = -7"),
        ("print TankDb.flags", "$5 = {_m1 = true, _0 = false, _1 = false}"),
        ("print TankDb.delay", "$6 = 1500"),
        ("print TankDb.open", "$7 = true"),
        ("set var TankDb.level = 10", ""),
        ("delete", ""),
    ];
    let printed = session(&[("main.scl", SCL)], &steps, "TankDb.level")?;
    if printed == ["TankDb.level = 10"] { Ok(()) } else { Err(format!("the program printed {printed:?}")) }
}

/// Builds a program, stops it in the second call of FC 1, carries out the steps, and lets it go on to the end of its second cycle. Result: what the
/// program prints of these values.
fn session(sources: &[(&str, &str)], steps: &[(&str, &str)], values: &str) -> Result<Vec<String>, String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let program = build(folder.path(), sources)?;
    let mut gdb = Command::new("gdb");
    gdb.args(["-quiet", "-batch", "-nx", "-ex", "set width 0", "-ex", "break FC1"]);
    let flags = format!("run --cycles 2 --clock virtual --quiet --print {values} > printed");
    gdb.args(["-ex", &flags, "-ex", "continue"]);
    for (step, _) in steps {
        gdb.args(["-ex", &format!("echo >{step}\\n"), "-ex", step]);
    }
    gdb.args(["-ex", "echo >continue\\n", "-ex", "continue"]);
    // A debugger that asks a server for symbols would wait for the network.
    let output = gdb.arg(&program).current_dir(&folder).env_remove("DEBUGINFOD_URLS").output();
    let output = output.map_err(|error| format!("gdb: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let mut wrong = Vec::new();
    for (step, expected) in steps {
        let said = text.split_once(&format!(">{step}\n")).map_or("nothing", |(_, rest)| rest);
        let said = said.split("\n>").next().unwrap_or_default();
        let said = if said.starts_with('>') { "" } else { said.trim_end() };
        if said != *expected {
            wrong.push(format!("{step}: `{said}`, not `{expected}`"));
        }
    }
    if !wrong.is_empty() {
        let errors = String::from_utf8_lossy(&output.stderr);
        return Err(format!("{}\n{text}\n{errors}", wrong.join("\n")));
    }
    let printed = std::fs::read_to_string(folder.path().join("printed")).map_err(|error| error.to_string())?;
    Ok(printed.lines().map(str::to_string).collect())
}

fn build(folder: &Path, sources: &[(&str, &str)]) -> Result<std::path::PathBuf, String> {
    for (name, text) in sources {
        std::fs::write(folder.join(name), text).map_err(|error| error.to_string())?;
    }
    let paths: Vec<_> = sources.iter().map(|(name, _)| folder.join(name)).collect();
    let settings = Settings { require_main: true, ..Settings::default() };
    let bound = pipeline::front(inputs::read(&paths), &settings);
    if bound.has_errors() {
        return Err(bound.diagnostics.iter().map(|message| message.title.as_str()).collect::<Vec<_>>().join("\n"));
    }
    let object = pipeline::object(pipeline::lower(&bound, Level::O0), None).map_err(|error| error.to_string())?;
    let program = folder.join("program");
    link::link(&[object], &program, None).map_err(|error| error.to_string())?;
    Ok(program)
}
