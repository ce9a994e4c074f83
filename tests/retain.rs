//! Memory that outlives its process: executables that are killed at random moments, and started again.
//!
//! A program of each family adds 1 to two words of retentive memory in each cycle, one at the begin and one at the end of a long OB 1. What
//! comes back must be of one completed cycle: both are the same. With `every = "cycle"` it is not older than what was seen before.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use plcc_tests::kernels;

/// How often each program is killed: `PLCC_KILLS`, else as often as some seconds take.
fn kills() -> u32 {
    std::env::var("PLCC_KILLS").ok().and_then(|text| text.parse().ok()).unwrap_or(60)
}

struct Program {
    source: &'static str,
    ending: &'static str,
    cpu: &'static str,
    /// The two words, as `--print` has them.
    words: [&'static str; 2],
}

const PROGRAMS: &[Program] = &[
    Program {
        ending: "stl",
        cpu: "s7-300",
        words: ["DB1.DBD0", "MD4"],
        source: "DATA_BLOCK DB 1\nSTRUCT\n  a : DINT;\nEND_STRUCT\nBEGIN\nEND_DATA_BLOCK\n\
                 ORGANIZATION_BLOCK OB 1\nVAR_TEMP\n  info : ARRAY[0..19] OF BYTE;\n  n : INT;\nEND_VAR\nBEGIN\n\
                 L DB1.DBD 0; + L#1; T DB1.DBD 0;\n L 500;\nm: T #n;\n L MW 100; + 3; T MW 100; L #n; LOOP m;\n\
                 L DB1.DBD 0; T MD 4;\nEND_ORGANIZATION_BLOCK\n",
    },
    Program {
        ending: "scl",
        cpu: "s7-1500",
        words: ["\"Kept\".a", "\"Kept\".b"],
        source: "DATA_BLOCK \"Kept\" { S7_Optimized_Access := 'TRUE' }\nNON_RETAIN\nVAR RETAIN\n  a : DInt;\nEND_VAR\n\
                 VAR\n  other : DInt;\nEND_VAR\nVAR RETAIN\n  b : DInt;\nEND_VAR\nBEGIN\nEND_DATA_BLOCK\n\
                 ORGANIZATION_BLOCK \"Main\"\nVAR_TEMP\n  n : Int;\nEND_VAR\nBEGIN\n  \"Kept\".a := \"Kept\".a + 1;\n  \
                 FOR #n := 1 TO 500 DO\n    \"Kept\".other := \"Kept\".other + #n;\n  END_FOR;\n  \"Kept\".b := \"Kept\".a;\n\
                 END_ORGANIZATION_BLOCK\n",
    },
    Program {
        ending: "awl",
        cpu: "s7-200",
        words: ["VD100", "VD104"],
        source: "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nNetwork 1\nLD SM0.0\n+D +1, VD100\nNetwork 2\nLD SM0.0\n\
                 FOR VW200, +1, +500\nNetwork 3\nLD SM0.0\nINCW VW202\nNetwork 4\nNEXT\nNetwork 5\nLD SM0.0\n\
                 MOVD VD100, VD104\nEND_ORGANIZATION_BLOCK\n",
    },
];

fn built(program: &Program, every: &str, folder: &Path) -> PathBuf {
    let source = folder.join(format!("counting.{}", program.ending));
    std::fs::write(&source, program.source).unwrap();
    let cpu = program.cpu;
    let project = format!("cpu = \"{cpu}\"\n[retain]\nfile = \"kept\"\nevery = \"{every}\"\n");
    std::fs::write(folder.join("plc.toml"), project).unwrap();
    let out = folder.join("counting");
    kernels::build_program(folder, &out).unwrap_or_else(|messages| panic!("{}: {messages}", program.ending));
    out
}

fn start(executable: &Path, cycles: Option<u32>, words: &[&str]) -> Child {
    let mut command = Command::new(executable);
    command.current_dir(executable.parent().unwrap()).args(["--cycle-time", "0", "--quiet"]);
    command.args(cycles.iter().map(|cycles| format!("--cycles={cycles}")));
    command.args(words.iter().map(|word| format!("--print={word}")));
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    loop {
        match command.spawn() {
            // A process that another test starts at this moment still has the file open for writing.
            Err(error) if error.kind() == ErrorKind::ExecutableFileBusy => std::thread::sleep(Duration::from_millis(1)),
            started => return started.unwrap(),
        }
    }
}

/// The words of a run of one cycle, and what it said.
fn found(executable: &Path, words: &[&str]) -> (Vec<i64>, String) {
    let output = start(executable, Some(1), words).wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let value = |line: &str| {
        let (_, value) = line.split_once(" = ").unwrap_or_else(|| panic!("{line}: {said}"));
        let digits = value.trim_start_matches("16#").split_whitespace().next().unwrap();
        let radix = if value.starts_with("16#") { 16 } else { 10 };
        i64::from_str_radix(digits, radix).unwrap_or_else(|_| panic!("{line}"))
    };
    (text.lines().map(value).collect(), said)
}

fn kill_again_and_again(every: &str) {
    for program in PROGRAMS {
        let folder = tempfile::tempdir().unwrap();
        let executable = built(program, every, folder.path());
        let (mut before, said) = found(&executable, &program.words);
        assert_eq!((before.as_slice(), said.as_str()), (&[1, 1][..], ""), "{}", program.ending);
        let mut seed = 1u64;
        let mut grown = 0;
        for round in 0..kills() {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let mut child = start(&executable, None, &[]);
            std::thread::sleep(Duration::from_micros(3_000 + (seed >> 33) % 12_000));
            child.kill().unwrap();
            child.wait().unwrap();
            let (now, said) = found(&executable, &program.words);
            let place = format!("{} every {every}, round {round}: {before:?}, then {now:?}", program.ending);
            assert_eq!(said, "", "{place}");
            assert_eq!(now[0], now[1], "a mixture: {place}");
            assert!(now[0] > before[0], "it went back: {place}");
            grown += u32::from(now[0] > before[0] + 1);
            before = now;
        }
        assert!(every != "cycle" || grown > kills() / 4, "{}: only {grown} runs left something", program.ending);
    }
}

#[test]
fn each_cycle_comes_back() {
    kill_again_and_again("cycle");
}

#[test]
fn the_last_copy_comes_back() {
    kill_again_and_again("5ms");
}
