//! How sources are read and compiled: flags that several commands have.

use clap::{Args, ValueEnum};
use plcc_opt::Without;
use plcc_syntax::CodePage;
use plcc_syntax::stl::Mnemonics;

use crate::pipeline::Optimization;

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
