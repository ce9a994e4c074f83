//! The command line, as `clap` reads it.

use std::path::PathBuf;

use clap::{Arg, Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use plcc_opt::Without;
use plcc_runtime::RunOptions;
use plcc_services::ServiceOptions;
use plcc_syntax::CodePage;
use plcc_syntax::stl::Mnemonics;

use crate::package::fmu::Version;
use crate::pipeline::Optimization;
use crate::report::MessageFormat;

/// Compiler from Siemens PLC programs to native code.
#[derive(Parser, Debug)]
#[command(name = "plcc", version, arg_required_else_help = true)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Subcommand, Debug)]
pub enum Command {
    /// Compile sources to an executable.
    Build(BuildArgs),
    /// Compile a program in memory and run it.
    Run(Box<RunArgs>),
    /// Change the program of a running process.
    Load(LoadArgs),
    /// Show a running process in the terminal: state, blocks with their status, values, watch table, diagnostic buffer.
    Monitor(MonitorArgs),
    /// Run tests: assertion pragmas and scenarios.
    Test(TestArgs),
    /// Check sources and report problems, without compiling.
    Check(CheckArgs),
    /// List what uses what: cross references, assignment of memory, call structure, symbols without use.
    Xref(XrefArgs),
    /// Show what the statements of a block see in one cycle.
    Status(Box<StatusArgs>),
    /// Repeat a run that was recorded with `plcc run --record`, and compare memory after each cycle.
    Replay(Box<ReplayArgs>),
    /// Serve a debugger: the debug adapter protocol over standard input and output.
    Debug(Box<DebugArgs>),
    /// Lay out sources in one style.
    Fmt(FmtArgs),
    /// List the modules of a project's station and their addresses.
    Station {
        /// The folder of the project.
        #[arg(default_value = ".", value_name = "DIR")]
        folder: PathBuf,
    },
    /// Write sources in another notation.
    Convert(ConvertArgs),
    /// Draw a trace as an SVG picture or an HTML page.
    Plot(PlotArgs),
    /// Draw a program: networks, charts and code.
    View(ViewArgs),
    /// Make the hash of a password for plc.toml: reads the password, one line, from standard input.
    Password {
        /// The password is that of a user of the page, not of the CPU.
        #[arg(long)]
        user: bool,
    },
    /// Serve an editor: the language server protocol over standard input and output.
    Lsp,
    /// Make a project with a small program and its test.
    New(NewArgs),
    /// Print the script that completes the command line of plcc in a shell.
    Completions { shell: Shell },
    /// Write the manual pages of plcc.
    Man {
        /// The folder for the pages.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
    /// Explain a diagnostic code.
    Explain {
        /// The code that a message shows, such as `P0203`.
        code: String,
    },
}

/// How sources are read and compiled.
#[derive(Args, Clone, Debug)]
pub struct CompileArgs {
    /// CPU, such as `315-2DP`, or family, such as `s7-300`. A line `//@ cpu` of a source counts in tests only.
    #[arg(long, value_name = "NAME")]
    pub cpu: Option<String>,
    /// Mnemonics of the statement lists [default: detected for each file].
    #[arg(long, value_name = "SET")]
    pub mnemonics: Option<MnemonicsArg>,
    /// Code page of sources that are not UTF-8, such as `936` or `gbk` [default: detected for each file].
    #[arg(long, value_name = "PAGE")]
    pub code_page: Option<CodePage>,
    /// Compile blocks of safety programs (F_LAD, F_FBD) as standard blocks, to test their logic.
    #[arg(long)]
    pub safety_as_standard: bool,
    /// Fail if there are messages of this kind.
    #[arg(long, value_name = "KIND")]
    pub deny: Option<Deny>,
    /// Accept a program with missing parts: each one gets a warning, and a stub or a separate variable replaces it.
    #[arg(long)]
    pub partial: bool,
}

/// Messages that make a command fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Deny {
    Warnings,
}

/// How to optimise.
#[derive(Args, Clone, Debug)]
pub struct OptimizationArgs {
    /// Optimisation level: -O0 none, -O2 full.
    #[arg(short = 'O', value_name = "LEVEL", default_value = "2")]
    pub level: Level,
    /// Leave out a pass of -O2, such as `fold`; may be repeated. Results are the same.
    #[arg(long, value_name = "PASS")]
    pub without_pass: Vec<Without>,
    /// Instructions of the processor that the code may use. Results are the same.
    #[arg(long, value_name = "SET", default_value = "baseline")]
    pub cpu_features: CpuFeatures,
}

impl OptimizationArgs {
    pub fn optimization(&self) -> Optimization {
        let without = self.without_pass.iter().fold(Without::NOTHING, |all, one| all.and(*one));
        Optimization { level: self.level, without, cpu_features: self.cpu_features }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, ValueEnum)]
pub enum CpuFeatures {
    /// Only instructions that every processor of the architecture has.
    Baseline,
    /// All instructions of the processor in this computer; the executable may not run on another one.
    Native,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, ValueEnum)]
pub enum Level {
    #[value(name = "0")]
    O0,
    #[value(name = "2")]
    O2,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MnemonicsArg {
    /// International: A, JC, I 0.0.
    En,
    /// German: U, SPB, E 0.0.
    De,
}

impl From<MnemonicsArg> for Mnemonics {
    fn from(arg: MnemonicsArg) -> Mnemonics {
        match arg {
            MnemonicsArg::En => Mnemonics::En,
            MnemonicsArg::De => Mnemonics::De,
        }
    }
}

#[derive(Args, Debug)]
pub struct BuildArgs {
    /// Sources, symbol tables, folders of these, or a project. Together they are one program [default: the project in this
    /// folder].
    #[arg(value_name = "FILE|DIR")]
    pub inputs: Vec<PathBuf>,
    /// Output file [default: named after the project or the first source].
    #[arg(short, value_name = "OUT")]
    pub output: Option<PathBuf>,
    /// Write an intermediate form instead of an executable, a unit of a co-simulation (`fmu`) or a container image (`oci`).
    #[arg(long, value_name = "KIND")]
    pub emit: Option<Emit>,
    /// With `--emit fmu`: version of the Functional Mock-up Interface [default: 2].
    #[arg(long, value_name = "VERSION")]
    pub fmi: Option<Version>,
    /// Make an executable that needs no dynamic library.
    #[arg(long = "static", conflicts_with_all = ["emit", "print_after", "stats"])]
    pub is_static: bool,
    /// Print the IR after this pass instead of writing an executable.
    #[arg(long, value_name = "PASS", conflicts_with = "emit")]
    pub print_after: Option<String>,
    /// Print what each network costs, in instructions and bytes of machine code and as an estimated time, instead of writing an
    /// executable.
    #[arg(long, conflicts_with_all = ["emit", "print_after"])]
    pub stats: bool,
    /// With `--stats`: as JSON.
    #[arg(long, requires = "stats")]
    pub json: bool,
    #[command(flatten)]
    pub optimization: OptimizationArgs,
    #[command(flatten)]
    pub compile: CompileArgs,
    /// Compile everything, and keep no code for the next build.
    #[arg(long)]
    pub no_cache: bool,
    /// Link with a C compiler, such as `cc` [default: plcc links].
    #[arg(long, value_name = "CC")]
    pub linker: Option<String>,
    /// Give the executable servers for clients, and their flags [default: if plc.toml has `[services]`].
    #[arg(long)]
    pub services: bool,
    /// Give the executable its code a second time, with probes, so that the page can show what statements see while the program runs.
    /// It gets services, too [default: if it has services anyway].
    #[arg(long, conflicts_with = "no_monitor")]
    pub monitor: bool,
    /// Leave the code with probes out.
    #[arg(long)]
    pub no_monitor: bool,
    /// Do not print what was written.
    #[arg(long)]
    pub quiet: bool,
}

/// What is written instead of an executable: intermediate forms, and packages of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Emit {
    Tokens,
    Ast,
    Ir,
    Clif,
    Asm,
    Obj,
    /// A unit for simulators with the Functional Mock-up Interface.
    Fmu,
    /// A container image with the static executable, a tar file in the OCI layout.
    Oci,
}

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
    #[arg(value_name = "ADDR:PORT", value_parser = plcc_services::options::address)]
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
    #[arg(long, value_name = "ADDR:PORT", value_parser = plcc_services::options::address)]
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

/// What becomes of a change by which values of the running program go.
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
pub struct TestArgs {
    /// Sources, tables, projects, or folders of these [default: the project in this folder]. Each project is a test; other sources are
    /// one program, or a test each if more than one has a main program.
    #[arg(value_name = "FILE|DIR")]
    pub inputs: Vec<PathBuf>,
    /// How to run the program.
    #[arg(long, value_name = "FORM", default_value = "jit")]
    pub form: FormArg,
    #[command(flatten)]
    pub optimization: OptimizationArgs,
    #[command(flatten)]
    pub compile: CompileArgs,
    /// Link with a C compiler, such as `cc`, for `--form exe` [default: plcc links].
    #[arg(long, value_name = "CC")]
    pub linker: Option<String>,
    /// Print the results as JSON.
    #[arg(long)]
    pub json: bool,
    /// Run only the tests whose paths contain this text.
    #[arg(long, value_name = "TEXT")]
    pub filter: Option<String>,
    /// Write the results to a file in the form of JUnit, for CI services.
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Count what the tests run of the programs, and write it to a folder: pages with the networks, and lcov.info.
    #[arg(long, value_name = "DIR")]
    pub coverage: Option<PathBuf>,
    /// Run the tests again whenever a file changes.
    #[arg(long)]
    pub watch: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FormArg {
    /// In the interpreter of the IR.
    Interp,
    /// As machine code in memory.
    Jit,
    /// As an executable.
    Exe,
    /// In all three ways; the results must agree.
    All,
}

#[derive(Args, Debug)]
pub struct CheckArgs {
    /// Sources, symbol tables, folders of these, or a project. Together they are one program [default: the project in this
    /// folder].
    #[arg(value_name = "FILE|DIR")]
    pub inputs: Vec<PathBuf>,
    /// Format of the messages.
    #[arg(long, value_name = "FORMAT", default_value = "human")]
    pub message_format: MessageFormat,
    #[command(flatten)]
    pub compile: CompileArgs,
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

#[derive(Args, Debug)]
pub struct XrefArgs {
    /// Sources, symbol tables, folders of these, or a project. Together they are one program [default: the project in this
    /// folder].
    #[arg(value_name = "FILE|DIR")]
    pub inputs: Vec<PathBuf>,
    /// Print all lists as one JSON document.
    #[arg(long)]
    pub json: bool,
    /// Print the cross references as CSV, a row for each use.
    #[arg(long, conflicts_with = "json")]
    pub csv: bool,
    #[command(flatten)]
    pub compile: CompileArgs,
}

#[derive(Args, Debug)]
pub struct NewArgs {
    /// The folder of the project, which has its name.
    #[arg(value_name = "NAME")]
    pub folder: PathBuf,
    /// CPU, such as `1214C`, `315-2DP` or `224`.
    #[arg(long, value_name = "NAME", default_value = "1214C")]
    pub cpu: String,
}

#[derive(Args, Debug)]
pub struct FmtArgs {
    /// Sources, or folders of these [default: the project in this folder].
    #[arg(value_name = "FILE|DIR")]
    pub inputs: Vec<PathBuf>,
    /// Change nothing; print the files that would change, and fail if there are any.
    #[arg(long)]
    pub check: bool,
    /// Code page of sources that are not UTF-8, such as `936` or `gbk` [default: detected for each file].
    #[arg(long, value_name = "PAGE")]
    pub code_page: Option<CodePage>,
}

#[derive(Args, Debug)]
#[command(group = clap::ArgGroup::new("what").required(true))]
pub struct ConvertArgs {
    /// Sources and exports, or folders of these; symbol tables among them give types to names.
    #[arg(value_name = "FILE|DIR", required = true)]
    pub inputs: Vec<PathBuf>,
    /// The notation to write.
    #[arg(long, value_name = "NOTATION", group = "what")]
    pub to: Option<ConvertTo>,
    /// Write symbols as addresses, in sources that otherwise stay as they are.
    #[arg(long, group = "what")]
    pub absolute: bool,
    /// Write addresses as symbols, in sources that otherwise stay as they are.
    #[arg(long, group = "what")]
    pub symbolic: bool,
    /// Report what carries over to another family of CPUs: `s7-1200` for a program of an S7-200, `s7-1500` for one of an S7-300/400.
    #[arg(long, value_name = "FAMILY", group = "what")]
    pub report: Option<String>,
    /// Output file; for several sources, or with `/` at the end, a folder [default: standard output].
    #[arg(short, value_name = "OUT")]
    pub output: Option<PathBuf>,
    /// Mnemonics of the statement lists that are written [default: those of the source].
    #[arg(long, value_name = "SET")]
    pub mnemonics: Option<MnemonicsArg>,
    /// CPU of the program, such as `315-2DP`, or family [default: that of the project; for SCL as STL `s7-300`].
    #[arg(long, value_name = "NAME")]
    pub cpu: Option<String>,
    /// Code page of sources that are not UTF-8, such as `936` or `gbk` [default: detected for each file].
    #[arg(long, value_name = "PAGE")]
    pub code_page: Option<CodePage>,
}

/// What `plcc convert` writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ConvertTo {
    /// Statement list, as source text for S7-300/400: of STL, LAD, FBD and SCL.
    Stl,
    /// Ladder diagram, as SIMATIC SD.
    Lad,
    /// Function block diagram, as SIMATIC SD.
    Fbd,
    /// SIMATIC SD, with each network in its language.
    Sd,
    /// SCL, as source text.
    Scl,
    /// GRAPH, as source text of S7-GRAPH.
    Gr7,
    /// XML of the TIA Portal (SimaticML).
    Xml,
    /// A whole program as one project in PLCopen XML, for editors of IEC 61131-3.
    Plcopen,
    /// Source text of Micro/WIN, for programs of the S7-200.
    Awl,
}

impl ConvertTo {
    /// Extension of its files.
    pub const fn extension(self) -> &'static str {
        match self {
            ConvertTo::Stl => "stl",
            ConvertTo::Lad | ConvertTo::Fbd | ConvertTo::Sd => "s7dcl",
            ConvertTo::Scl => "scl",
            ConvertTo::Gr7 => "gr7",
            ConvertTo::Xml | ConvertTo::Plcopen => "xml",
            ConvertTo::Awl => "awl",
        }
    }
}

#[derive(Args, Debug)]
pub struct PlotArgs {
    /// A trace, written by `--trace FILE.csv`.
    #[arg(value_name = "TRACE.csv")]
    pub trace: PathBuf,
    /// Output file; one that ends in .html is a page with zoom and cursors [default: the name of the trace with the extension svg].
    #[arg(short, value_name = "OUT.svg|OUT.html")]
    pub output: Option<PathBuf>,
    /// Title above the picture.
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
}

#[derive(Args, Debug)]
#[command(group = clap::ArgGroup::new("drawn").required(true).multiple(true))]
pub struct ViewArgs {
    /// Sources, symbol tables, folders of these, or a project [default: the project in this folder].
    #[arg(value_name = "FILE|DIR")]
    pub inputs: Vec<PathBuf>,
    /// Folder for SVG files, one for each network and chart.
    #[arg(short, long = "out", value_name = "DIR", group = "drawn")]
    pub output: Option<PathBuf>,
    /// One HTML document for the whole program.
    #[arg(long, value_name = "FILE.html", group = "drawn")]
    pub html: Option<PathBuf>,
    /// Show the state that a trace (`--trace FILE.csv` of a run) has at a time, by default at its end: power flow, active steps, values.
    #[arg(long, value_name = "TRACE.csv[@TIME]")]
    pub state: Option<String>,
    #[command(flatten)]
    pub compile: CompileArgs,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn optimization(arguments: &[&str]) -> Result<Optimization, String> {
        match Cli::try_parse_from([&["plcc"], arguments].concat()).map_err(|error| error.to_string())?.command {
            Command::Build(args) => Ok(args.optimization.optimization()),
            Command::Run(args) => Ok(args.optimization.optimization()),
            Command::Test(args) => Ok(args.optimization.optimization()),
            other => Err(format!("{other:?} makes no code")),
        }
    }

    #[test]
    fn passes_are_switched_off_by_name() {
        for command in ["build", "run", "test"] {
            let without = |list: &[&str]| optimization(&[&[command, "a.stl"], list].concat()).map(|made| made.without);
            assert_eq!(without(&[]), Ok(Without::NOTHING));
            let both = without(&["--without-pass", "values", "--without-pass", "fold"]).expect("there are such passes");
            assert_eq!(both.names().collect::<Vec<_>>(), ["fold", "values"]);
            let error = without(&["--without-pass", "folds"]).expect_err("there is no such pass");
            assert!(error.contains("unknown pass `folds`; the passes are fold, "), "{error}");
        }
    }

    #[test]
    fn code_is_for_every_processor_unless_asked() {
        let features =
            |list: &[&str]| optimization(&[&["build", "a.stl"], list].concat()).map(|made| made.cpu_features);
        assert_eq!(features(&[]), Ok(CpuFeatures::Baseline));
        assert_eq!(features(&["--cpu-features", "native"]), Ok(CpuFeatures::Native));
        assert!(features(&["--cpu-features", "avx9"]).is_err());
    }

    #[test]
    fn replay_shows_no_flag_that_it_refuses() {
        let mut command = <Cli as clap::CommandFactory>::command();
        let replay = command.find_subcommand_mut("replay").expect("there is such a command");
        let help = replay.render_long_help().to_string();
        for flag in ["--set", "--record", "--clock", "--web", "--mqtt-ca", "--instances"] {
            assert!(!help.contains(&format!("{flag} ")), "{flag} in {help}");
        }
        for flag in ["--cycles", "--print", "--trace", "--diag", "--data"] {
            assert!(help.contains(flag), "{flag} is not in {help}");
        }
    }

    #[test]
    fn statistics_replace_the_executable() {
        let parse = |list: &[&str]| Cli::try_parse_from([&["plcc", "build", "a.stl"], list].concat()).is_ok();
        assert!(parse(&["--stats"]) && parse(&["--stats", "--json"]));
        assert!(!parse(&["--json"]) && !parse(&["--stats", "--emit", "ir"]));
    }
}
