//! No instruction costs more than `docs/benchmarks/instructions.csv` says: instructions of the host and bytes of machine code, for each row
//! of each instruction table.
//!
//!     PLCC_COSTS=write cargo test --release --test costs     renews the table; read the difference
//!
//! Ignored where valgrind is not installed.

use std::fs;
use std::process::ExitCode;

use libtest_mimic::{Arguments, Failed, Trial};
use plcc_tests::costs::{self, program, table};
use plcc_tests::kernels;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let missing = !kernels::has("valgrind");
    let name = if missing { "costs: valgrind is not installed, nothing is counted" } else { "costs" };
    let check = || plcc_driver::on_large_stack(check).and_then(|result| result).map_err(Failed::from);
    libtest_mimic::run(&arguments, vec![Trial::test(name, check).with_ignored_flag(missing)]).exit_code()
}

fn check() -> Result<(), String> {
    let writes = std::env::var_os("PLCC_COSTS").is_some_and(|value| value == "write");
    let counted = program::costs(&costs::rows(), writes)?;
    let path = table::path();
    if writes {
        fs::create_dir_all(path.parent().expect("it is in a folder")).map_err(|error| error.to_string())?;
        return fs::write(&path, table::text(&counted)).map_err(|error| error.to_string());
    }
    let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let worse = table::worse(&text, &counted);
    if worse.is_empty() {
        return Ok(());
    }
    Err(format!(
        "{}\nif this is meant: `PLCC_COSTS=write cargo test --release --test costs` renews the table",
        worse.join("\n")
    ))
}
