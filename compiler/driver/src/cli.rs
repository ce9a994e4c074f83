//! The command line: what can be written, as `clap` reads it.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use plcc_runtime::RunOptions;
use plcc_syntax::CodePage;
use plcc_syntax::stl::Mnemonics;

use crate::report::MessageFormat;

/// Compiler from Siemens PLC programs to native code.
#[derive(Parser, Debug)]
#[command(name = "plcc", version, arg_required_else_help = true, disable_help_subcommand = true)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Subcommand, Debug)]
pub enum Command {
    /// Compile sources to an executable.
    Build(BuildArgs),
    /// Compile in memory and run.
    Run(RunArgs),
    /// Run assertion pragmas and scenarios.
    Test(TestArgs),
    /// Report what is wrong and compile nothing.
    Check(CheckArgs),
    /// List the modules of a project's station with their addresses.
    Station {
        /// The folder of the project.
        #[arg(default_value = ".", value_name = "DIR")]
        folder: PathBuf,
    },
    /// Draw a trace as an SVG picture.
    Plot(PlotArgs),
    /// Print the page of a diagnostic code.
    Explain {
        /// A code as it stands in a message, `P0203`.
        code: String,
    },
}

/// How sources are read and compiled.
#[derive(Args, Clone, Debug)]
pub struct CompileArgs {
    /// CPU, `315-2DP`, or family, `s7-300`.
    #[arg(long, value_name = "NAME")]
    pub cpu: Option<String>,
    /// Mnemonics of the statement lists; found in each file if left out.
    #[arg(long, value_name = "SET")]
    pub mnemonics: Option<MnemonicsArg>,
    /// Code page of sources that are not UTF-8, `936` or `gbk`; found in each file if left out.
    #[arg(long, value_name = "PAGE")]
    pub code_page: Option<CodePage>,
    /// Compile blocks of safety programs (F_LAD, F_FBD) as standard blocks, to test their logic.
    #[arg(long)]
    pub safety_as_standard: bool,
}

/// How much is optimised.
#[derive(Args, Clone, Copy, Debug)]
pub struct LevelArgs {
    /// Optimisation: -O0 none, -O2 all.
    #[arg(short = 'O', value_name = "LEVEL", default_value = "2")]
    pub level: Level,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
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
    /// Sources, symbol tables, folders of them, or a project; together one program.
    #[arg(required = true, value_name = "FILE|DIR")]
    pub inputs: Vec<PathBuf>,
    /// Where the output goes; the name of the first source or project if left out.
    #[arg(short, value_name = "OUT")]
    pub output: Option<PathBuf>,
    /// Write an intermediate form instead of an executable.
    #[arg(long, value_name = "KIND")]
    pub emit: Option<Emit>,
    /// Print the IR behind this pass instead of making an executable.
    #[arg(long, value_name = "PASS", conflicts_with = "emit")]
    pub print_after: Option<String>,
    #[command(flatten)]
    pub level: LevelArgs,
    #[command(flatten)]
    pub compile: CompileArgs,
    /// The program that links.
    #[arg(long, value_name = "CC")]
    pub linker: Option<String>,
}

/// An intermediate form.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Emit {
    Tokens,
    Ast,
    Ir,
    Clif,
    Asm,
    Obj,
}

#[derive(Args, Debug)]
pub struct RunArgs {
    /// Sources, symbol tables, folders of them, or a project; together one program.
    #[arg(required = true, value_name = "FILE|DIR")]
    pub inputs: Vec<PathBuf>,
    #[command(flatten)]
    pub level: LevelArgs,
    #[command(flatten)]
    pub compile: CompileArgs,
    #[command(flatten)]
    pub run: RunOptions,
}

#[derive(Args, Debug)]
pub struct TestArgs {
    /// Sources, each a test of its own, projects, or folders of both.
    #[arg(required = true, value_name = "FILE|DIR")]
    pub inputs: Vec<PathBuf>,
    /// In which form the program runs.
    #[arg(long, value_name = "FORM", default_value = "jit")]
    pub form: FormArg,
    #[command(flatten)]
    pub level: LevelArgs,
    #[command(flatten)]
    pub compile: CompileArgs,
    /// The program that links, for `--form exe`.
    #[arg(long, value_name = "CC")]
    pub linker: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FormArg {
    /// The interpreter of the IR.
    Interp,
    /// Machine code in memory.
    Jit,
    /// An executable.
    Exe,
    /// All three, which must agree.
    All,
}

#[derive(Args, Debug)]
pub struct CheckArgs {
    /// Sources, symbol tables, folders of them, or a project; together one program.
    #[arg(required = true, value_name = "FILE|DIR")]
    pub inputs: Vec<PathBuf>,
    /// Check blocks without the rest of their project: what is defined nowhere is a warning.
    #[arg(long)]
    pub partial: bool,
    /// How messages are written.
    #[arg(long, value_name = "FORMAT", default_value = "human")]
    pub message_format: MessageFormat,
    #[command(flatten)]
    pub compile: CompileArgs,
}

#[derive(Args, Debug)]
pub struct PlotArgs {
    /// A trace that `--trace FILE.csv` wrote.
    #[arg(value_name = "TRACE.csv")]
    pub trace: PathBuf,
    /// The picture; that of the trace with the suffix svg if left out.
    #[arg(short, value_name = "OUT.svg")]
    pub output: Option<PathBuf>,
    /// Text above the picture.
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
}
