//! What an executable reports about its flags and about an endless loop; `plcc run` reports the same.

use std::path::Path;
use std::process::{Command, Output};

use crate::PLCC;

/// Writes the source into a folder and builds `program` there.
fn build(folder: &Path, source: &str) {
    std::fs::write(folder.join("program.stl"), source).expect("the folder can be written");
    let output = command(PLCC, folder, &["build", "program.stl", "-o", "program"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}

fn command(program: &str, folder: &Path, arguments: &[&str]) -> Output {
    Command::new(program).current_dir(folder).args(arguments).output().expect("it starts")
}

/// Runs the executable and `plcc run`; both exit with `code` and write the same. Returns standard error.
fn both(folder: &Path, flags: &[&str], code: i32) -> String {
    let executable = folder.join("program").display().to_string();
    let built = command(&executable, folder, flags);
    let run = command(PLCC, folder, &[&["run", "program.stl"], flags].concat());
    let errors = String::from_utf8_lossy(&built.stderr).into_owned();
    assert_eq!(built.status.code(), Some(code), "{errors}");
    assert_eq!(run.status.code(), Some(code), "{errors}");
    assert_eq!(built.stdout, run.stdout);
    assert!(!errors.lines().any(|line| line.starts_with("error")), "{errors}");
    assert!(!errors.contains("os error"), "{errors}");
    errors
}

#[test]
fn a_retentive_file_without_its_folder_is_told_once() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    build(folder, "      L     MW 0\n      T     MW 2\n");
    let errors = both(folder, &["--clock", "virtual", "--cycles", "1", "--retain", "none/kept"], 0);
    let told: Vec<&str> = errors.lines().filter(|line| line.starts_with("runtime:")).collect();
    assert_eq!(
        told,
        [
            "runtime: none/kept can neither be read nor written: No such file or directory; all data begins with its start \
          values, and nothing is kept until it can be written"
        ]
    );
}

#[test]
fn one_cycle_is_not_cycles() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    build(folder, "      L     MW 0\n      T     MW 2\n");
    assert_eq!(both(folder, &["--clock", "virtual", "--cycles", "1"], 0), "ended after 1 cycle\n");
    assert_eq!(both(folder, &["--clock", "virtual", "--cycles", "2"], 0), "ended after 2 cycles\n");
}

/// A bad pointer leaves an S7-200 in RUN: the statement does nothing.
#[test]
fn errors_that_leave_an_s7_200_in_run_are_told_at_the_end() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nNETWORK 1\nLD SM0.0\nMOVW 5, *VD100\nEND_ORGANIZATION_BLOCK\n";
    std::fs::write(folder.join("main.awl"), source).expect("the folder can be written");
    let run = |flags: &[&str]| {
        let fixed = ["run", "main.awl", "--clock", "virtual", "--cycles", "3"];
        let output = command(PLCC, folder, &[&fixed[..], flags].concat());
        assert_eq!(output.status.code(), Some(0));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let said = run(&[]);
    assert!(said.starts_with("ended after 3 cycles\nfirst of 3 non-fatal errors: "), "{said}");
    assert_eq!(
        said.matches("0006: indirect addressing error; MAIN (OB 1), network 1, main.awl:5\n").count(),
        2,
        "{said}"
    );
    assert_eq!(run(&["--quiet"]), "");
}

#[test]
fn a_repeated_run_is_not_recorded() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    std::fs::write(folder.join("program.stl"), "      L     MW 0\n").expect("the folder can be written");
    for flag in ["--record", "--replay"] {
        let output = command(PLCC, folder, &["replay", "plant.rec", "program.stl", flag, "other.rec"]);
        assert_eq!(output.status.code(), Some(2));
        let says = String::from_utf8_lossy(&output.stderr);
        assert_eq!(says, format!("plcc: `plcc replay` repeats one recording; leave out {flag}\n"));
    }
}

/// `MW20.5` may mean a bit of a byte; a symbol of a word, even one of letters like those of an address, means only its value.
#[test]
fn bits_of_symbols_are_slices() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    std::fs::write(folder.join("program.stl"), "      L     MW 20\n").expect("the folder can be written");
    let names = "\"ä5\",\"MW 20\",\"WORD\",\"\"\r\n\"Ab5\",\"MW 22\",\"WORD\",\"\"\r\n";
    std::fs::write(folder.join("names.sdf"), names).expect("the folder can be written");
    for name in ["ä5", "Ab5"] {
        let bit = format!("{name}.3");
        let output = command(PLCC, folder, &["run", "program.stl", "names.sdf", "--cycles", "1", "--print", &bit]);
        let says = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{says}");
        assert!(says.contains(&format!("`{name}` names no bit; write `{name}.%X3` for bit 3 of the value")), "{says}");
    }
}

#[test]
fn wrong_flags_are_usage_errors() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    build(folder, "      L     MW 0\n      +     1\n      T     MW 0\n");
    for pipe in ["pipe.toml", "pipe.csv"] {
        assert!(command("mkfifo", folder, &[pipe]).status.success());
    }
    for (flags, says) in [
        (&["--no-such-flag"][..], "--no-such-flag"),
        (&["--cycles", "many"], "--cycles"),
        (&["--cycles", "-1"], "write a whole number of cycles"),
        (&["--cycle-time", "10"], "is not a time"),
        (&["--cycle-time", "-10ms"], "--cycle-time takes no negative value such as `-10ms`"),
        (&["--clock", "fast"], "--clock"),
        (&["--set", "I0.0=2"], "does not fit into a bit"),
        (&["--set", "MW0"], "write ADDR=VALUE, as MW0=1"),
        (&["--set", "MW0 := 5"], "write MW0=5"),
        (&["--set", "MW0=5 MW2=6"], "write MW0=5,MW2=6"),
        (&["--print", "MW0;MW2"], "write MW0,MW2"),
        (&["--print", "MW20.5"], "write `M20.5` for bit 5 of byte 20, `MW20.%X5` for bit 5 of the value"),
        (&["--print", "L0.0"], "`L0.0` is neither an address"),
        (&["--print", "\"\""], "the name is empty; write an address (such as Q4.0, MW20, DB10.DBD4)"),
        (&["--print", "M10"], "`M10` is not an address: write `M10.0` for a bit, `MB10` for a byte, `MW10` for a word"),
        (&["--print", "MW10 as DINT"], "`MW10` has 16 bits, but DINT has 32"),
        (&["--print", "MW10 as LREAL"], "`MW10` has 16 bits: name the byte where the LREAL begins, such as `MB10`"),
        (&["--print", "AI0"], "; plc.toml describes no station with analog inputs"),
        (&["--print", "Q0.0:P"], "`Q0.0:P` has no `:P` here: write `Q0.0`, the value in the process image"),
        (&["--print", "T1.VAL"], "`T1` is a value without member `VAL`; its current value is `T1.VALUE`"),
        (&["--trace", "trace.txt"], ".vcd, .csv or .html"),
        (&["--trace-signals", "MW0"], "--trace-signals is about a trace, and there is none: add --trace FILE.csv"),
        (&["--trace-step", "1s"], "add --trace FILE.csv"),
        (&["--scenario", "missing.toml"], "missing.toml"),
        (&["--scenario", "pips.toml"], "did you mean `pipe.toml`?"),
        (&["--scenario", "program.stl"], "program.stl is not a scenario, which is a file in TOML"),
        (&["--iso-port", "70000"], "`70000` is not a port: ports are 1 to 65535"),
        (&["--stop-on-error"], "--stop-on-error is about errors after which an S7-200 goes on"),
        (&["--restart", "hot"], "--restart hot: only a CPU of the S7-400 has hot restarts"),
        (&["--replay", "missing.rec"], "missing.rec: No such file or directory"),
        (&["--scenario", "pipe.toml"], "pipe.toml: a pipe, a socket or a device"),
        (&["--scenario", "/dev/zero"], "/dev/zero: a pipe, a socket or a device"),
        (&["--scenario", "."], "a folder or a link to one"),
        (&["--trace", "pipe.csv"], "pipe.csv: a pipe, a socket or a device"),
        (&["--watch-table", "pipe.toml"], "pipe.toml: a pipe, a socket or a device"),
        (
            &["--clock", "virtual", "--cycles", "2", "--instance-values", "pipe.csv"],
            "pipe.csv: a pipe, a socket or a device",
        ),
    ] {
        let errors = both(folder, flags, 2);
        assert!(errors.contains(says), "{flags:?}: {errors}");
    }
    both(folder, &["--cycles", "3", "--cycle-time", "0", "--print", "MW0", "--quiet"], 0);
    let scenario = |text: &str| std::fs::write(folder.join("s.toml"), text).expect("the folder can be written");
    for (text, says) in [
        ("[[at]]\ncycle = 1\nset = { \"T5\" = 1 }\n", "s.toml:3: T5: T5 is the state of a timer"),
        ("[[at]]\ncycle = 1\nprint = [\"MW9999\"]\n", "print MW9999: byte 9999 is outside"),
        ("[[at]]\ncycle = -1\n", "s.toml:2: "),
    ] {
        scenario(text);
        let errors = both(folder, &["--clock", "virtual", "--cycles", "2", "--scenario", "s.toml"], 2);
        assert!(errors.contains(says), "{errors}");
    }
    std::fs::write(folder.join("s.scenario"), "[[at]]\ncycle = -1\n").expect("the folder can be written");
    let errors = both(folder, &["--scenario", "s.scenario"], 2);
    assert!(errors.contains("s.scenario:2: "), "{errors}");
    for (text, says) in [
        ("MW0;MW2\n1;2\n", "i.csv:1: columns are separated by `,`; write MW0,MW2"),
        ("MW0;MW2\n1;2,5\n", "i.csv:1: columns are separated by `,`; write MW0,MW2"),
        ("MW0,MW2\n1\n", "i.csv:2: the first line has 2 names, but this one has 1 value"),
        ("MW0,MW2\r\n1,2\r\n3\r\n", "i.csv:3: the first line has 2 names, but this one has 1 value"),
        ("MW0,Speed\n1,2\n3,4\n", "runtime: i.csv:1: `Speed` is neither an address"),
        ("MW0,mw0\n1,2\n", "i.csv:1: `mw0` has two columns; leave one of them out"),
        ("MW0,MW2\n1,2\n3,many\n", "instance 1: runtime: i.csv:3: MW2: `many` is not a value"),
        ("MW0,MW2\r\n\r\n1,2\r\n\r\n3,many\r\n", "instance 1: runtime: i.csv:5: MW2: `many` is not a value"),
    ] {
        std::fs::write(folder.join("i.csv"), text).expect("the folder can be written");
        let errors = both(folder, &["--clock", "virtual", "--cycles", "2", "--instance-values", "i.csv"], 2);
        assert_eq!(errors.matches(says).count(), 1, "{errors}");
    }
    let said = both(folder, &["--clock", "virtual", "--cycles", "2", "--instances", "3"], 0);
    assert!(said.contains("3 instances ended after 2 cycles"), "{said}");
    // No client is told where many CPUs can be reached.
    let flags =
        ["run", "program.stl", "--clock", "virtual", "--cycles", "2", "--instances", "3", "--s7", "127.0.0.1:0"];
    let output = command(PLCC, folder, &flags);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{errors}");
    assert!(errors.contains("clients are answered by one CPU: leave out --instances"), "{errors}");
    assert!(!errors.contains("S7 clients at"), "{errors}");
    // What is wrong for each of many CPUs is said once.
    let errors = both(folder, &["--clock", "virtual", "--cycles", "2", "--instances", "3", "--print", "Speed"], 2);
    assert_eq!(errors.matches("Speed").count(), 1, "{errors}");
}

#[test]
fn flags_of_clients_need_a_service() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("program.stl"), "      L     MW 0\n").expect("the folder can be written");
    for (flags, says) in [
        (&["--access", "control"][..], "runtime: --access: no client can connect: add --s7"),
        (&["--allow-load"], "runtime: --allow-load: programs are loaded through the page"),
        (&["--allow-load", "--scenario", "s.toml"], "plcc: --scenario belongs to one program"),
    ] {
        let all = [&["run", "program.stl", "--cycles", "1"], flags].concat();
        let output = command(PLCC, folder.path(), &all);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{errors}");
        assert!(errors.starts_with(says), "{errors}");
    }
}

#[test]
fn a_cold_restart_is_refused_where_the_cpu_has_none() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scl = "ORGANIZATION_BLOCK \"Main\"\nBEGIN\n  %Q0.0 := %I0.0;\nEND_ORGANIZATION_BLOCK\n";
    let awl = "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nNetwork 1\nLD I0.0\n= Q0.0\nEND_ORGANIZATION_BLOCK\n";
    for (file, text, cpu, family) in [("main.scl", scl, "1214C", "S7-1200/1500"), ("main.awl", awl, "224", "S7-200")] {
        std::fs::write(folder.path().join(file), text).expect("the folder can be written");
        let flags = ["run", file, "--cpu", cpu, "--cycles", "1", "--restart", "cold"];
        let output = command(PLCC, folder.path(), &flags);
        assert_eq!(output.status.code(), Some(2));
        let errors = String::from_utf8_lossy(&output.stderr);
        let expected = format!("--restart cold: an {family} has no cold restart; --restart reset");
        assert!(errors.contains(&expected), "{errors}");
    }
}

#[test]
fn messages_for_other_programs_are_on_standard_output() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("program.stl"), "      A     MW 0\n").expect("the folder can be written");
    for (format, begin) in [("json", "{"), ("sarif", "{\n  \"$schema\"")] {
        let output = command(PLCC, folder.path(), &["check", "program.stl", "--message-format", format]);
        assert_eq!(output.status.code(), Some(3));
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(text.starts_with(begin) && text.contains("P0203"), "{text}");
        assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

/// A log on a full disk is not a reason to stop.
#[test]
fn a_full_standard_error_stops_no_program() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("program.stl"), "      L     MW 0\n").expect("the folder can be written");
    let full = std::fs::File::options().write(true).open("/dev/full").expect("there is a full device");
    let flags = ["run", "program.stl", "--cycles", "1", "--s7", "127.0.0.1:0", "--print", "MW0"];
    let output = Command::new(PLCC).current_dir(folder.path()).args(flags).stderr(full).output().expect("plcc starts");
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(String::from_utf8_lossy(&output.stdout), "MW0 = 16#0000\n");
}

#[test]
fn an_executable_without_services_says_how_it_gets_them() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    build(folder.path(), "      NOP   0\n");
    let output = command(&folder.path().join("program").display().to_string(), folder.path(), &["--s7=10102"]);
    assert_eq!(output.status.code(), Some(2));
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(errors.contains("`--s7` needs the services"), "{errors}");
    assert!(errors.contains("with `[services]` in plc.toml"), "{errors}");
}

#[test]
fn a_trace_has_whole_texts_and_dates() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let source = "DATA_BLOCK \"D\"\nSTRUCT\n  s : STRING[8]; ws : WSTRING[6]; dt : DTL; c : ARRAY[0..1] OF STRING[4]; j : INT;\nEND_STRUCT;\n\
                  BEGIN\nEND_DATA_BLOCK\nORGANIZATION_BLOCK \"Main\"\nBEGIN\n  \"D\".s := 'abc'; \"D\".ws := WSTRING#'xy'; \"D\".dt.DAY := 3;\n  \
                  \"D\".c[1] := 'q'; \"D\".j := LEN(\"D\".s);\nEND_ORGANIZATION_BLOCK\n";
    std::fs::write(folder.path().join("texts.scl"), source).expect("the folder can be written");
    let flags = ["run", "texts.scl", "--cpu=s7-1500", "--clock=virtual", "--cycles=1", "--trace=t.csv"];
    let output = command(PLCC, folder.path(), &flags);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let trace = std::fs::read_to_string(folder.path().join("t.csv")).expect("there is a trace");
    let head = trace.lines().next().unwrap_or_default();
    assert!(!head.contains("DBB") && !head.contains("DBW"), "{head}");
    for name in ["D.s", "D.dt", "D.c[1]", "D.j"] {
        assert_eq!(head.split(',').filter(|found| *found == name).count(), 1, "{name}: {head}");
    }
}

#[test]
fn a_code_with_another_letter_is_recognized() {
    let output = Command::new(PLCC).args(["explain", "E0203"]).output().expect("plcc starts");
    assert_eq!(output.status.code(), Some(2));
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(errors.contains("is P0203 meant?"), "{errors}");
}

#[test]
fn an_endless_loop_is_named_by_its_line() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    build(folder.path(), "      NOP   0\nm:    L     MW 0\n      JU    m\n");
    for flags in [&["--clock", "virtual", "--hang-limit", "200ms"][..], &["--clock", "real"]] {
        let errors = both(folder.path(), flags, 1);
        assert!(errors.contains("OB 1, network 1, program.stl:3"), "{errors}");
    }
}

#[test]
fn a_signal_ends_an_endless_startup() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let startup = "ORGANIZATION_BLOCK OB 100\nBEGIN\nm:    JU    m\nEND_ORGANIZATION_BLOCK\n";
    build(folder.path(), &format!("{startup}ORGANIZATION_BLOCK OB 1\nBEGIN\nEND_ORGANIZATION_BLOCK\n"));
    let mut child = Command::new(folder.path().join("program")).spawn().expect("it starts");
    std::thread::sleep(std::time::Duration::from_millis(500));
    let kill = Command::new("kill").arg(child.id().to_string()).status().expect("there is a kill command");
    assert!(kill.success());
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
}

#[test]
fn a_trace_has_timers_counters_and_what_is_not_in_an_image() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let stl = "      A     I 0.0\n      L     S5T#2s\n      SD    T 5\n      A     I 0.1\n      CU    C 3\n";
    let awl = "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nNetwork 1\nLD I0.0\nTON T37, 10\nNetwork 2\nLD T37\n= Q0.0\n\
               Network 3\nLD I0.1\nLD I0.2\nCTU C5, 3\nEND_ORGANIZATION_BLOCK\n";
    let scl = "DATA_BLOCK \"G\"\nSTRUCT\n  t : TON_TIME;\n  c : CTU_INT;\nEND_STRUCT\nBEGIN\nEND_DATA_BLOCK\n\
               ORGANIZATION_BLOCK \"Main\"\nBEGIN\n  \"G\".t(IN := %I0.0, PT := T#1s);\n  \
               \"G\".c(CU := %I0.1, R := FALSE, PV := 3);\nEND_ORGANIZATION_BLOCK\n";
    let direct = "      L     PIW 256\n      T     PQW 256\n";
    let special = "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nNetwork 1\nLD SM0.5\nA S0.1\nMOVW AIW0, AQW0\nMOVB 4, SMB31\n\
                   MOVD HC1, VD0\nEND_ORGANIZATION_BLOCK\n";
    for (file, cpu, source, columns) in [
        ("t.stl", "315-2DP", stl, &["I0.0", "I0.1", "T5", "T5.VALUE", "C3", "C3.VALUE"][..]),
        ("t.awl", "CPU 224", awl, &["Q0.0", "T37", "T37.VALUE", "C5", "C5.VALUE"]),
        ("t.scl", "1214C", scl, &["I0.0", "G.t.IN", "G.t.ET", "G.t.PT", "G.c.CU", "G.c.CV", "G.c.PV"]),
        ("direct.stl", "315-2DP", direct, &["PIW256", "PQW256"]),
        ("special.awl", "CPU 224", special, &["SM0.5", "S0.1", "AIW0", "AQW0", "SMB31", "HC1", "VD0"]),
    ] {
        std::fs::write(folder.join(file), source).expect("the folder can be written");
        let flags = ["run", file, "--cpu", cpu, "--cycles", "2", "--clock", "virtual", "--quiet", "--trace", "t.csv"];
        let output = command(PLCC, folder, &flags);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        let trace = std::fs::read_to_string(folder.join("t.csv")).expect("there is a trace");
        let head: Vec<&str> = trace.lines().next().unwrap_or_default().split(',').collect();
        for column in columns {
            assert!(head.contains(column), "{file}: {column} is not in {head:?}");
        }
    }
}

#[test]
fn flags_that_would_do_nothing_are_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("program.stl"), "      L     MW 0\n").expect("the folder can be written");
    std::fs::write(folder.path().join("t.csv"), "cycle,time_ms,MW0\n1,0,16#0000\n").expect("the folder can be written");
    for (arguments, says) in [
        (&["plot", "t.csv", "-o", "t.png"][..], "plcc: `t.png` must end in .svg, for a picture, or in .html"),
        (&["build", "program.stl", "--fmi", "3"], "plcc: --fmi is for a unit of a co-simulation: add --emit fmu"),
    ] {
        let output = command(PLCC, folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&output.stderr).starts_with(says), "{arguments:?}");
    }
    assert!(!folder.path().join("t.png").exists() && !folder.path().join("program").exists());
}

#[test]
fn a_trace_that_is_a_pipe_is_not_drawn() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    assert!(command("mkfifo", folder.path(), &["pipe.csv"]).status.success());
    let drawn = command(PLCC, folder.path(), &["plot", "pipe.csv"]);
    assert_eq!(drawn.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&drawn.stderr).contains("a pipe, a socket or a device"));
}

#[test]
fn each_run_of_safety_blocks_says_so() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION \"Guard\" : Void\n{ S7_Safety := \"TRUE\" }\nBEGIN\nEND_FUNCTION\n\
                  ORGANIZATION_BLOCK \"Main\"\nBEGIN\n  \"Guard\"();\n  //@ assert %MW0 == 0\nEND_ORGANIZATION_BLOCK\n";
    std::fs::write(folder.join("guard.scl"), source).expect("the folder can be written");
    let says = "not fail-safe: compiled as standard blocks: Guard";
    let safety = |rest: &[&str]| command(PLCC, folder, &[rest, &["--safety-as-standard", "guard.scl"]].concat());
    assert_eq!(safety(&["build", "-o", "program"]).status.code(), Some(0));
    let short = ["--cycles", "1", "--clock", "virtual", "--quiet"];
    for output in [
        safety(&[&["run"][..], &short].concat()),
        safety(&["test"]),
        command(&folder.join("program").display().to_string(), folder, &short),
    ] {
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(errors.matches(says).count(), 1, "{errors}");
        assert_eq!(output.status.code(), Some(0), "{errors}");
    }
}

/// What `/proc/PID/task/TID/stat` says of each thread: its real-time priority and its policy.
fn schedulers(pid: u32) -> Vec<(String, String)> {
    let Ok(threads) = std::fs::read_dir(format!("/proc/{pid}/task")) else { return Vec::new() };
    let stats = threads.flatten().filter_map(|thread| std::fs::read_to_string(thread.path().join("stat")).ok());
    let fields = |stat: String| {
        // The second field is the name, in parentheses; the third one comes first here.
        let fields: Vec<String> = stat.rsplit(") ").next()?.split(' ').map(str::to_string).collect();
        Some((fields.get(37)?.clone(), fields.get(38)?.clone()))
    };
    let mut found: Vec<_> = stats.filter_map(fields).collect();
    found.sort();
    found
}

#[test]
fn realtime_is_as_asked_or_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    build(folder, "      L     MW 0\n      +     1\n      T     MW 0\n");
    let errors = both(folder, &["--realtime", "--clock", "virtual", "--cycles", "1"], 2);
    assert!(errors.contains("--realtime: the virtual clock does not wait"), "{errors}");

    // Without rights. Root loses its capabilities; for everybody else limits are enough.
    let bare = "ulimit -r 0; ulimit -l 64; [ $(id -u) = 0 ] && exec setpriv --bounding-set=-all \"$@\"; exec \"$@\"";
    let refused = command("sh", folder, &["-c", bare, "sh", "./program", "--realtime", "--cycles", "1"]);
    let errors = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{errors}");
    for right in ["CAP_SYS_NICE", "ulimit -r", "CAP_IPC_LOCK", "ulimit -l"] {
        assert!(errors.contains(right), "{errors}");
    }

    // With rights, if the test has them: the cycle, and the watchdog above it.
    let mut child = Command::new(folder.join("program"))
        .args(["--realtime", "--cycle-time", "5ms"])
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("it starts");
    let fifo = |priority: &str| (priority.to_string(), "1".to_string());
    let mut seen = Vec::new();
    for _ in 0..500 {
        seen = schedulers(child.id());
        if seen == [fifo("40"), fifo("41")] || child.try_wait().expect("it was started").is_some() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
    let _ = child.kill();
    let output = child.wait_with_output().expect("it was started");
    if output.status.code() == Some(2) {
        assert!(String::from_utf8_lossy(&output.stderr).contains("CAP_"), "{output:?}");
        return;
    }
    assert_eq!(seen, [fifo("40"), fifo("41")]);
    let locked = status.lines().find_map(|line| line.strip_prefix("VmLck:")).expect("Linux says").trim();
    assert!(!locked.starts_with("0 "), "{status}");
}

/// Without a scenario the cycle copies the values of fast counters, too.
#[test]
fn fast_counters_reach_a_program_that_runs_alone() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let settings = "cpu = \"1214C\"\n[hsc.1]\nmode = \"single phase\"\ninitial = 77\n";
    let source = "ORGANIZATION_BLOCK \"Main\"\nBEGIN\n%MD20 := %ID1000;\nEND_ORGANIZATION_BLOCK\n";
    std::fs::write(folder.join("plc.toml"), settings).expect("the folder can be written");
    std::fs::write(folder.join("main.scl"), source).expect("the folder can be written");
    let flags = ["run", ".", "--clock", "virtual", "--cycles", "3", "--quiet", "--print", "MD20"];
    let output = command(PLCC, folder, &flags);
    assert_eq!(String::from_utf8_lossy(&output.stdout), "MD20 = 16#0000004D\n");
}
