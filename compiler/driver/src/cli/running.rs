//! Commands that run a program, or reach one that runs.

use std::path::PathBuf;

use clap::{Arg, Args, ValueEnum};
use plcc_runtime::RunOptions;
use plcc_services::ServiceOptions;

use super::{CompileArgs, OptimizationArgs};

#[derive(Args, Clone, Debug)]
pub struct RunArgs {
    /// Sources, symbol tables, folders of these, or a project. Together they are one program [default: the project in this
    /// folder].
    #[arg(value_name = "FILE|DIR")]
    pub inputs: Vec<PathBuf>,
    #[command(flatten)]
    pub optimization: OptimizationArgs,
    #[command(flatten)]
    pub compile: CompileArgs,
    #[command(flatten)]
    pub run: RunOptions,
    #[command(flatten)]
    pub services: ServiceOptions,
    /// Change the running program whenever a source is saved; `r` and Enter restores the previous program (see docs/changing-a-program.md).
    #[arg(long)]
    pub watch: bool,
    /// With `--watch`: what to do if values of the running program would be lost.
    #[arg(long, value_name = "ANSWER", default_value = "ask", requires = "watch")]
    pub lose: Lose,
}

#[derive(Args, Debug)]
pub struct MonitorArgs {
    /// Where the page of the process is, such as `127.0.0.1:8080`, or a port of this computer.
    #[arg(value_name = "ADDR:PORT", value_parser = plcc_services::client::address)]
    pub address: std::net::SocketAddr,
    /// Name of a user of the page; the password is read from the environment variable PLCC_PASSWORD, else one line from standard input.
    #[arg(long, value_name = "NAME")]
    pub user: Option<String>,
    /// The process has `--tls`: encrypt the connection. FILE has the certificate of the process (PEM), or that of the authority that has
    /// signed it for this address; in a folder it is `certificate.pem`.
    #[arg(long, value_name = "FILE")]
    pub tls: Option<PathBuf>,
    /// Values in the watch table at the start.
    #[arg(long, value_name = "ADDR,...")]
    pub watch: Vec<String>,
}

#[derive(Args, Debug)]
pub struct LoadArgs {
    /// Sources, symbol tables, folders of these, or a project. Together they are one program [default: the project in this
    /// folder].
    #[arg(value_name = "FILE|DIR")]
    pub inputs: Vec<PathBuf>,
    /// Where the page of the process is, such as `127.0.0.1:8080`, or a port of this computer. The process needs `--allow-load`.
    #[arg(long, value_name = "ADDR:PORT", value_parser = plcc_services::client::address)]
    pub to: std::net::SocketAddr,
    /// Name of a user of the page; the password is read from the environment variable PLCC_PASSWORD, else one line from standard input.
    #[arg(long, value_name = "NAME")]
    pub user: Option<String>,
    /// The process has `--tls`: encrypt the connection. FILE has the certificate of the process (PEM), or that of the authority that has
    /// signed it for this address; in a folder it is `certificate.pem`.
    #[arg(long, value_name = "FILE")]
    pub tls: Option<PathBuf>,
    /// Bring back the program from before the last change, instead of loading one.
    #[arg(long, conflicts_with = "inputs")]
    pub restore: bool,
    /// What to do if values of the running program would be lost.
    #[arg(long, value_name = "ANSWER", default_value = "ask")]
    pub lose: Lose,
    #[command(flatten)]
    pub optimization: OptimizationArgs,
    #[command(flatten)]
    pub compile: CompileArgs,
}

/// What to do with a change that would lose values of the running program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Lose {
    /// `y` or `n` and Enter on standard input.
    Ask,
    /// The program is changed.
    Allow,
    /// The old program goes on.
    Refuse,
}

#[derive(Args, Debug)]
pub struct StatusArgs {
    /// Sources, symbol tables, folders of these, or a project. Together they are one program [default: the project in this
    /// folder].
    #[arg(value_name = "FILE|DIR")]
    pub inputs: Vec<PathBuf>,
    /// The block, such as `FB1` or its name, and a network of it, such as `FB1:3`.
    #[arg(long, value_name = "BLOCK[:NETWORK]")]
    pub block: String,
    /// Number of the cycle; 0: startup.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub cycle: u64,
    /// The call whose instance is this data block.
    #[arg(long, value_name = "DB")]
    pub instance: Option<String>,
    /// The blocks that lead to the call, such as `OB1/FC2`; the last one calls the block.
    #[arg(long, value_name = "PATH")]
    pub path: Option<String>,
    /// Number of the call, if several calls in the cycle fit.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub call: u32,
    /// Print the status as JSON.
    #[arg(long)]
    pub json: bool,
    /// Set a value before the startup OB runs, e.g. I0.0=1; separate several by commas or repeat the flag.
    #[arg(long, value_name = "ADDR=VALUE")]
    pub set: Vec<String>,
    /// Play a scenario: a TOML file (see docs/testing.md).
    #[arg(long, value_name = "FILE")]
    pub scenario: Option<PathBuf>,
    /// Force values by a table, a TOML file (see docs/debugging.md).
    #[arg(long, value_name = "FILE")]
    pub force: Option<PathBuf>,
    /// Time from one cycle start to the next of the virtual clock [default: 10ms].
    #[arg(long, value_name = "TIME", value_parser = plcc_runtime::options::parse_duration)]
    pub cycle_time: Option<plcc_runtime::options::Duration>,
    #[command(flatten)]
    pub compile: CompileArgs,
}

#[derive(Args, Debug)]
#[command(mut_args(shown_for_replay))]
pub struct ReplayArgs {
    /// The recording.
    #[arg(value_name = "RECORDING")]
    pub recording: PathBuf,
    #[command(flatten)]
    pub run: RunArgs,
}

/// A flag as the help of `plcc replay` has it: without those of `plcc run` that are a matter of the recording, such as its clients.
fn shown_for_replay(flag: Arg) -> Arg {
    #[rustfmt::skip]
    const REFUSED: &[&str] = &[
        "clock", "cycle_time", "set", "scenario", "watch_table", "force", "restart", "retain", "realtime", "record", "replay",
        "instances", "instance_values", "watch", "lose", "allow_load", "s7", "modbus", "opcua", "metrics", "web", "tables", "tls",
        "mqtt", "mqtt_ca", "mqtt_certificate", "mqtt_key", "sparkplug", "publish", "access",
    ];
    let is_refused = REFUSED.contains(&flag.get_id().as_str());
    flag.hide(is_refused)
}

#[derive(Args, Clone, Debug)]
pub struct DebugArgs {
    /// Sources, symbol tables, folders of these, or a project. Together they are one program [default: what the client names in
    /// `program`, else the project in this folder].
    #[arg(value_name = "FILE|DIR")]
    pub inputs: Vec<PathBuf>,
    /// Serve one client over TCP instead, at an address such as 127.0.0.1:4711 or a port of this computer, and print the address on
    /// standard error.
    #[arg(long, value_name = "ADDR:PORT", value_parser = plcc_services::options::address)]
    pub listen: Option<std::net::SocketAddr>,
    /// Repeat a run that was recorded with `plcc run --record`.
    #[arg(long, value_name = "RECORDING")]
    pub replay: Option<PathBuf>,
    #[command(flatten)]
    pub compile: CompileArgs,
}
