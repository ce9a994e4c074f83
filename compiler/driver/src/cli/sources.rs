//! Commands that list, lay out, convert and draw sources, make new ones, and draw traces.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use plcc_syntax::CodePage;

use super::{CompileArgs, MnemonicsArg};

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
    /// CPU of the program, such as `315-2DP`, or family [default: that of the project or of a line `//@ cpu`, else what the sources imply].
    #[arg(long, value_name = "NAME")]
    pub cpu: Option<String>,
    /// Report on a program with missing parts, each of which gets a warning.
    #[arg(long)]
    pub partial: bool,
    /// Code page of sources that are not UTF-8, such as `936` or `gbk` [default: detected for each file].
    #[arg(long, value_name = "PAGE")]
    pub code_page: Option<CodePage>,
}

/// What `plcc convert` writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ConvertTo {
    /// Statement list, as source text for S7-300/400/1500: of STL, LAD, FBD, SCL and GRAPH.
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
