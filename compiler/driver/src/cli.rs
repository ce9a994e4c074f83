//! The command line, as `clap` reads it: the commands, and what those that build and test take.
//!
//! - `compile`: how sources are read and compiled, for several commands.
//! - `running`: commands that run a program; `sources`: commands that work with its sources.

mod compile;
mod running;
mod sources;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;

use crate::package::fmu::Version;
use crate::report::MessageFormat;

pub use compile::{CompileArgs, CpuFeatures, Deny, Level, MnemonicsArg, OptimizationArgs};
pub use running::{DebugArgs, LoadArgs, Lose, MonitorArgs, ReplayArgs, RunArgs, StatusArgs};
pub use sources::{ConvertArgs, ConvertTo, FmtArgs, NewArgs, PlotArgs, ViewArgs, XrefArgs};

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

#[cfg(test)]
mod tests {
    use plcc_opt::Without;

    use super::*;
    use crate::pipeline::Optimization;

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
