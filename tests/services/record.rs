//! Runs that are recorded, with clients, timers and interrupts, and repeated.

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use libtest_mimic::Failed;

use crate::here;
use crate::process::{self, Plc, free_port, write_register};

/// A program whose memory depends on the time of each cycle: timers, the clock, and a cyclic interrupt.
const TIMED: &str = "
DATA_BLOCK DB 1
STRUCT
  Register : WORD ;
  Seen : INT ;
END_STRUCT ;
BEGIN
END_DATA_BLOCK
ORGANIZATION_BLOCK OB 1
VAR_TEMP
  Info : ARRAY [0..11] OF BYTE ;
  At : DATE_AND_TIME ;
END_VAR
BEGIN
NETWORK
      L     MW    0;
      +     1;
      T     MW    0;
      AN    T     1;
      L     S5T#40MS;
      SD    T     1;
      A     T     1;
      FP    M     4.0;
      JNB   over;
      L     MW    6;
      +     1;
      T     MW    6;
over: L     T     1;
      T     MW    8;
      L     LD    16;
      T     MD    12;
      L     DB1.DBW 0;
      T     DB1.DBW 2;
END_ORGANIZATION_BLOCK
ORGANIZATION_BLOCK OB 35
BEGIN
NETWORK
      L     MW    20;
      +     1;
      T     MW    20;
      L     MW    0;
      T     MW    22;
END_ORGANIZATION_BLOCK
";

fn run(program: &Path, flags: &[&str]) -> Result<Output, Failed> {
    Ok(Command::new(program).args(flags).stdin(Stdio::null()).output()?)
}

/// Holds if the process ended with the code and said the text.
fn said(output: &Output, code: i32, text: &str) -> Result<String, Failed> {
    let out = String::from_utf8_lossy(&output.stdout).into_owned();
    let error = String::from_utf8_lossy(&output.stderr);
    match output.status.code() == Some(code) && (error.contains(text) || out.contains(text)) {
        true => Ok(out),
        false => Err(format!("expected {code} and `{text}`: {:?}\n{out}\n{error}", output.status).into()),
    }
}

/// The same memory after each cycle, in the executable and in memory; differences are reported.
pub fn timers_and_interrupts() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let at = |name: &str| folder.path().join(name);
    let (source, program, file) = (at("timed.stl"), at("timed"), at("run.rec"));
    std::fs::write(&source, TIMED)?;
    process::plcc(&["build", "--quiet"], &[&source], &program)?;
    let file_name = file.to_string_lossy().into_owned();
    let print = "--print=MW0,MW6,MW8,MD12,MW20,MW22";
    let recorded =
        run(&program, &["--record", &file_name, "--cycle-time=3ms", "--cycles=150", "--set=M50.0=1", print])?;
    let recorded = said(&recorded, 0, "recorded 150 cycles")?;
    let repeated = said(&run(&program, &["--replay", &file_name, print])?, 0, "as recorded after each of 150 cycles")?;
    if recorded != repeated || recorded.contains("MW6 16#0000") || recorded.contains("MW20 16#0000") {
        return Err(format!("recorded:\n{recorded}\nrepeated:\n{repeated}").into());
    }
    let replay = |flags: &[&str]| {
        let inputs = [file_name.clone(), source.to_string_lossy().into_owned()];
        let flags = flags.iter().map(ToString::to_string);
        plcc_driver::main_with(["plcc".into(), "replay".into()].into_iter().chain(inputs).chain(flags).map(Into::into))
    };
    for flags in [&["-O0"][..], &["-O2", "--quiet"]] {
        if replay(flags) != 0 {
            return Err(format!("replay {flags:?}").into());
        }
    }
    if replay(&["--set=M0.0=1"]) != 2 {
        return Err("a flag of the recording is taken".into());
    }
    // Another program, and one whose code alone is another.
    std::fs::write(&source, TIMED.replace("+     1", "+     2"))?;
    if replay(&[]) != 1 {
        return Err("another program has the same memory".into());
    }
    std::fs::write(&source, TIMED.replace("OB 35", "OB 34"))?;
    if replay(&[]) != 2 {
        return Err("a program with other blocks is taken".into());
    }
    let whole = std::fs::read(&file)?;
    if whole.len() > 150 * 24 {
        return Err(format!("{} bytes for 150 cycles", whole.len()).into());
    }
    for (bytes, code, text) in [
        // As a process that was killed leaves it.
        (whole[..whole.len() / 2].to_vec(), 0, "cycles before are repeated"),
        ([&whole[..400], &[0x55], &whole[401..]].concat(), 2, "damaged at byte"),
        (b"PLC".to_vec(), 2, "not a recording"),
    ] {
        std::fs::write(&file, bytes)?;
        said(&run(&program, &["--replay", &file_name])?, code, text)?;
    }
    let refused = run(&program, &["--record", &file_name, "--clock=virtual", "--cycles=1"])?;
    said(&refused, 2, "can be repeated without a recording")?;
    let folder_name = folder.path().to_string_lossy().into_owned();
    said(&run(&program, &["--record", &folder_name, "--cycles=1"])?, 2, "--record")?;
    Ok(())
}

/// What clients write is in the recording.
pub fn client_writes() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("run.rec").to_string_lossy().into_owned();
    let port = free_port().to_string();
    let plc = Plc::start(&["--modbus", &port, "--record", &file, "--print=DB1.DBW0"])?;
    for value in [0x1111, 0x2222, 0x3333] {
        std::thread::sleep(Duration::from_millis(30));
        write_register(&port, value)?;
    }
    std::thread::sleep(Duration::from_millis(30));
    plc.end()?;
    let repeated = run(process::Program::Line.path()?, &["--replay", &file, "--print=DB1.DBW0"])?;
    let printed = said(&repeated, 0, "memory was as recorded")?;
    if !printed.contains("3333") {
        return Err(format!("the last value is not there: {printed}").into());
    }
    said(&run(process::Program::Line.path()?, &["--replay", &file, "--modbus", &port])?, 2, "those of the recording")?;
    // The same in memory, of the project, whose services stay closed.
    let arguments = ["plcc", "replay", &file].map(std::ffi::OsString::from);
    match plcc_driver::main_with(arguments.into_iter().chain([here().join("line").into_os_string()])) {
        0 => Ok(()),
        code => Err(format!("plcc replay ended with {code}").into()),
    }
}
