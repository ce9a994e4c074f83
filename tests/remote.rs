//! Remote inputs and outputs with a device by pymodbus: `python3 -m venv target/python && target/python/bin/pip install pymodbus pyserial`.
//! Without it these tests are ignored; those of the runtime have devices of their own.

use std::net::TcpListener;
use std::path::Path;
use std::process::{Command, ExitCode};

use libtest_mimic::{Arguments, Failed, Trial};
use plcc_tests::{kernels, tests_folder};

/// What both devices have. `LINE` is how they are reached.
const PROJECT: &str = r#"
cpu = "s7-300"
sources = ["main.stl"]

[io.tank]
LINE
unit = 17
poll = "5ms"
timeout = "300ms"

[[io.tank.data]]
discrete = 0
at = "IB4"

[[io.tank.data]]
input = 5
at = "PIW300"
raw = [0, 10000]
range = "4..20 mA"

[[io.tank.data]]
holding = 20
at = "ID8"
words = "low first"

[[io.tank.data]]
coils = 100
at = "QB4"

[[io.tank.data]]
holding = 30
at = "QW6"
substitute = 777

[[io.tank.data]]
holding = 31
at = "PQW310"
raw = [0, 4000]
range = "0..10 V"
"#;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let missing = !Command::new(kernels::python())
        .args(["-c", "import pymodbus, serial"])
        .output()
        .is_ok_and(|output| output.status.success());
    let trial = |name: &str, check: fn() -> Result<(), String>| {
        let run = move || plcc_driver::on_large_stack(check).and_then(|result| result).map_err(Failed::from);
        Trial::test(name, run).with_ignored_flag(missing)
    };
    libtest_mimic::run(&arguments, vec![trial("remote/tcp", tcp), trial("remote/serial", serial)]).exit_code()
}

fn tcp() -> Result<(), String> {
    // A port that is free now.
    let port = TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr()).map_err(text)?.port();
    let folder = tempfile::tempdir().map_err(text)?;
    check(folder.path(), "tcp", &port.to_string(), &format!("modbus = \"127.0.0.1:{port}\""))
}

fn serial() -> Result<(), String> {
    let folder = tempfile::tempdir().map_err(text)?;
    let link = folder.path().join("line").display().to_string();
    check(folder.path(), "serial", &link, &format!("serial = \"{link}\"\nbaud = 115200\nparity = \"none\""))
}

fn check(folder: &Path, what: &str, place: &str, line: &str) -> Result<(), String> {
    std::fs::copy(tests_folder().join("remote/main.stl"), folder.join("main.stl")).map_err(text)?;
    std::fs::write(folder.join("plc.toml"), PROJECT.replace("LINE", line)).map_err(text)?;
    let executable = folder.join("program");
    kernels::build_program(folder, &executable)?;
    let mut command = Command::new(kernels::python());
    command.arg(tests_folder().join("remote/check.py")).args([what, place]).arg(executable);
    kernels::finished(&mut command).map(drop)
}

fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}
