//! Programs that run the sequences of many rows, and their costs.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use plcc_diag::SourceFile;
use plcc_driver::cli::Level;
use plcc_driver::inputs::Read;
use plcc_driver::link;
use plcc_driver::pipeline::{self, Compiled, Settings};

use super::callgrind::{self, Counted};
use super::{Cost, Row, s7200, stl};
use crate::{kernels, provide_runtimes};

/// Rows that share a program, and so the room that inlining has.
const ROWS: usize = 40;

/// Scans that are counted.
const SCANS: u64 = 16;

/// Scans of a run for the time, each with so many calls.
const TIMED: [u64; 2] = [500, 1000];

/// Of so many runs the shortest counts.
const RUNS: usize = 3;

/// A program with the rows whose blocks have the numbers from 2 on; block 1 is empty.
struct Program {
    rows: Vec<Row>,
    compiled: Compiled,
    /// Letters of the functions of rows: `FC`, `SBR`.
    prefix: &'static str,
    executable: PathBuf,
}

/// Costs of all `rows`, with their times if `timed`. Errors: a row does not compile, or valgrind fails.
pub fn costs(rows: &[Row], timed: bool) -> Result<Vec<(Row, Cost)>, String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let mut costs = Vec::new();
    for (index, group) in groups(rows).into_iter().enumerate() {
        let program = Program::new(group, &folder.path().join(format!("p{index}")))?;
        costs.extend(program.costs(folder.path(), timed)?);
    }
    // In the order of the rows.
    let place: HashMap<String, usize> = rows.iter().enumerate().map(|(place, row)| (row.key(), place)).collect();
    costs.sort_by_key(|(row, _)| place[&row.key()]);
    Ok(costs)
}

/// Rows that may be in one program.
fn groups(rows: &[Row]) -> Vec<Vec<Row>> {
    let mut groups: Vec<Vec<Row>> = Vec::new();
    let mut kinds: Vec<(&str, bool)> = Vec::new();
    for row in rows {
        let kind = (row.set, row.set == "STL" && stl::needs_four(&row.name));
        match kinds.iter().rposition(|other| *other == kind).filter(|&at| groups[at].len() < ROWS) {
            Some(at) => groups[at].push(row.clone()),
            None => {
                kinds.push(kind);
                groups.push(vec![row.clone()]);
            }
        }
    }
    groups
}

impl Program {
    fn new(rows: Vec<Row>, path: &Path) -> Result<Program, String> {
        let (cpu, sources) = sources(&rows);
        let mut read = Read { name: "costs".to_string(), ..Read::default() };
        for (name, text) in sources {
            read.units.push(read.sources.add(SourceFile::new(name, text)));
        }
        let settings = Settings { require_main: true, cpu: Some(cpu.to_string()), ..Settings::default() };
        let bound = pipeline::front(read, &settings);
        if bound.has_errors() {
            return Err(plcc_diag::drawing::draw(&bound.diagnostics, &bound.sources, false));
        }
        let prefix = if rows[0].set == "S7-200" { "SBR" } else { "FC" };
        let mut optimization = pipeline::Optimization::from(Level::O2);
        if prefix == "SBR" {
            // Subroutines cannot be called by number.
            optimization.without = "inline".parse().expect("there is such a pass");
        }
        let compiled = pipeline::back(&bound, optimization);
        let options = compiled.codegen_options();
        let object = plcc_codegen::compile_object(&compiled.module, &compiled.image_bytes(), &options)
            .map_err(|error| error.to_string())?;
        provide_runtimes();
        link::link(&[object], path, None).map_err(|error| error.to_string())?;
        Ok(Program { rows, compiled, prefix, executable: path.to_path_buf() })
    }

    fn costs(&self, folder: &Path, timed: bool) -> Result<Vec<(Row, Cost)>, String> {
        let counted = callgrind::count(&kernels::program_run(&self.executable, SCANS), folder)?;
        let sizes: HashMap<String, u64> =
            plcc_codegen::function_sizes(&self.compiled.module, &self.compiled.codegen_options())
                .map_err(|error| error.to_string())?
                .into_iter()
                .collect();
        let cost = |number: usize| -> Result<Cost, String> {
            let chart = if self.rows[0].set == "GRAPH" { format!("FB{number}") } else { String::new() };
            let names = [format!("{}{number}_entry", self.prefix), format!("{}{number}", self.prefix), chart];
            let of = |name: &String| counted.get(&format!("plcc_{name}")).copied();
            // The entry calls the block, if it is not part of it.
            let outer = names.iter().find_map(of).unwrap_or_default();
            let own: u64 = names.iter().filter_map(of).map(|counted| counted.own).sum();
            let Counted { own: outer_own, called } = outer;
            let time = if timed { self.time(number)? } else { 0.0 };
            Ok(Cost {
                own: own as f64 / SCANS as f64,
                called: (outer_own + called - own) as f64 / SCANS as f64,
                bytes: names.iter().filter_map(|name| sizes.get(name)).sum(),
                time,
            })
        };
        let empty = cost(1)?;
        let row = |(index, row): (usize, &Row)| {
            let own = cost(index + 2)?;
            let cost = Cost {
                own: own.own - empty.own,
                called: own.called - empty.called,
                bytes: own.bytes.saturating_sub(empty.bytes),
                time: (own.time - empty.time).max(0.0),
            };
            Ok((row.clone(), cost))
        };
        self.rows.iter().enumerate().map(row).collect()
    }

    /// Nanoseconds of a call of block `number`.
    fn time(&self, number: usize) -> Result<f64, String> {
        let [scans, calls] = TIMED;
        let address = if self.prefix == "SBR" { "VW9002" } else { "MW502" };
        let mut best = f64::MAX;
        for _ in 0..RUNS {
            let mut command = kernels::program_run(&self.executable, scans);
            command.args(["--set", &format!("{address}=16#{number:04X}")]);
            best = best.min(kernels::processor_time(command)?);
        }
        Ok(best / (scans * calls) as f64)
    }
}

/// The CPU and the sources of a program.
fn sources(rows: &[Row]) -> (&'static str, Vec<(&'static str, String)>) {
    let filled = |index: usize, row: &Row| {
        row.sequence
            .replace("{p}", &(600 + 8 * index).to_string())
            .replace("{n}", &index.to_string())
            .replace("{s}", &format!("{}.{}", index / 8, index % 8))
            .replace("{helper}", &(rows.len() + 2).to_string())
    };
    let blocks = rows.iter().enumerate().map(|(index, row)| (index + 2, filled(index, row)));
    match rows[0].set {
        "S7-200" => ("226", vec![("costs.awl", s7200::source(blocks.collect()))]),
        "STL" => {
            let cpu = if stl::needs_four(&rows[0].name) { "s7-400" } else { "s7-300" };
            let mut text = main_program(rows.len(), "");
            for (number, sequence) in [(1, String::new())].into_iter().chain(blocks) {
                text.push_str(&function(number, &sequence));
            }
            text.push_str(&function(rows.len() + 2, "L MW 0; T MW 304; L MW 4; T MW 306"));
            (cpu, vec![("costs.stl", text)])
        }
        "SCL" => super::scl::sources(blocks.collect(), main_program(rows.len(), super::scl::FILL)),
        "GRAPH" => super::chart::sources(blocks.collect(), main_program(rows.len(), "")),
        _ => super::network::sources(blocks.collect(), main_program(rows.len(), super::scl::FILL)),
    }
}

/// A function of STL.
pub fn function(number: usize, sequence: &str) -> String {
    let mut text = format!("FUNCTION FC {number} : VOID\nBEGIN\n");
    for statement in sequence.split("; ").filter(|statement| !statement.is_empty()) {
        writeln!(text, "      {statement};").expect("a string takes all");
    }
    text.push_str("END_FUNCTION\n");
    text
}

/// OB 1 in STL. It fills MB 0 to 199 with other values in each scan, MD 200 to 208 with REALs (the first ones to 400, then to 1), MD 212 with
/// BCD digits, MW 216 and MB 218 with small numbers, MD 220 with a pointer, MW 222 with 1, and calls the blocks of all rows, or 1000
/// times that of MW 502.
fn main_program(rows: usize, fill: &str) -> String {
    let last = rows + 1;
    format!(
        "DATA_BLOCK DB 1
STRUCT
  r : ARRAY [0 .. 59] OF WORD;
END_STRUCT;
BEGIN
END_DATA_BLOCK
ORGANIZATION_BLOCK OB 1
BEGIN
      LAR1  P#M 0.0
      L     50
fill: T     MW 504
      L     MD 506
      L     L#1103515245
      *D
      L     L#12345
      +D
      T     MD 506
      T     D [AR1,P#0.0]
      +AR1  P#4.0
      L     MW 504
      LOOP  fill
      L     MW 0
      L     W#16#7FFF
      AW
      ITD
      DTR
      L     80.0
      /R
      T     MD 200
      L     MW 4
      L     W#16#7FFF
      AW
      ITD
      DTR
      L     80.0
      /R
      T     MD 204
      L     410.0
      /R
      T     MD 208
      L     DW#16#123456
      T     MD 212
      L     MW 8
      L     W#16#1FF
      AW
      T     MW 216
      L     MB 10
      L     3
      AW
      T     MB 218
      L     P#12.0
      T     MD 220
      L     1
      T     MW 222
{fill}      L     MW 502
      L     0
      <>I
      JC    time
      L     {last}
next: T     MW 500
      UC    FC [MW 500]
      L     MW 500
      LOOP  next
      BEU
time: L     1000
more: T     MW 500
      UC    FC [MW 502]
      L     MW 500
      LOOP  more
END_ORGANIZATION_BLOCK
"
    )
}
