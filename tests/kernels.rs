//! Each kernel of `tests/kernels` leaves the same bytes in memory as its twin in C, after 3 and after 1000 scans, and the twin does nothing
//! that C leaves undefined. The benchmark of the same name compares their speed.

use std::path::Path;
use std::process::ExitCode;

use libtest_mimic::{Arguments, Failed, Trial};
use plcc_tests::kernels::{self, Kernel};

/// So many scans are compared.
const SCANS: [u64; 2] = [3, 1000];

/// The twin that is compared is also the one that looks for faults of its own.
const CHECKED: [&str; 4] =
    ["-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-fno-sanitize=alignment"];

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let missing = !kernels::has("gcc");
    let trials = kernels::kernels().into_iter().map(|kernel| {
        let name = format!("kernels/{}", kernel.name);
        let check = move || plcc_driver::on_large_stack(move || check(&kernel)).and_then(|result| result);
        Trial::test(name, move || check().map_err(Failed::from)).with_ignored_flag(missing)
    });
    libtest_mimic::run(&arguments, trials.collect()).exit_code()
}

/// Builds both and compares them.
fn check(kernel: &Kernel) -> Result<(), String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let (program, twin) = (folder.path().join("program"), folder.path().join("twin"));
    kernels::build_program(&kernel.source, &program)?;
    kernels::build_twin("gcc", &CHECKED, &kernel.twin, &twin)?;
    SCANS.iter().try_for_each(|&scans| compare(&program, &twin, scans))
}

fn compare(program: &Path, twin: &Path, scans: u64) -> Result<(), String> {
    let expected = twin_memory(twin, scans)?;
    if expected.is_empty() {
        return Err("the twin names no areas\n".to_string());
    }
    let actual = program_memory(program, scans, &expected)?;
    let differences: String = expected
        .iter()
        .zip(&actual)
        .filter(|((_, expected), actual)| expected != *actual)
        .map(|((address, expected), actual)| format!("{address}: {actual:02X}, in C {expected:02X}\n"))
        .collect();
    if differences.is_empty() { Ok(()) } else { Err(format!("after {scans} scans:\n{differences}")) }
}

/// Addresses of bytes and what the twin has there.
fn twin_memory(twin: &Path, scans: u64) -> Result<Vec<(String, u8)>, String> {
    let text = text_of(kernels::finished(&mut kernels::twin_run(twin, scans, "dump"))?.stdout);
    let mut bytes = Vec::new();
    for line in text.lines() {
        let [area, length, digits] = line.split(' ').collect::<Vec<_>>()[..] else {
            return Err(format!("not an area: {line}\n"));
        };
        for at in 0..length.parse::<usize>().map_err(|error| error.to_string())? {
            let value = digits.get(2 * at..2 * at + 2).and_then(|pair| u8::from_str_radix(pair, 16).ok());
            bytes.push((format!("{area}B{at}"), value.ok_or_else(|| format!("not the bytes of an area: {line}\n"))?));
        }
    }
    Ok(bytes)
}

/// What the program has at the same addresses.
fn program_memory(program: &Path, scans: u64, addresses: &[(String, u8)]) -> Result<Vec<u8>, String> {
    let list: Vec<&str> = addresses.iter().map(|(address, _)| address.as_str()).collect();
    let mut command = kernels::program_run(program, scans);
    command.args(["--json", "--print", &list.join(",")]);
    let text = text_of(kernels::finished(&mut command)?.stdout);
    let values: serde_json::Value = serde_json::from_str(&text).map_err(|error| format!("{error}: {text}\n"))?;
    let byte = |address: &str| u8::try_from(values.get("values")?.get(address)?.get("value")?.as_u64()?).ok();
    list.iter().map(|address| byte(address).ok_or_else(|| format!("no byte at {address}\n"))).collect()
}

fn text_of(bytes: Vec<u8>) -> String {
    String::from_utf8_lossy(&bytes).into_owned()
}
