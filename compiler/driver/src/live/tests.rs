//! Programs that are changed while they run, under the virtual clock.

use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

use plcc_abi::ProgramImage;
use plcc_diag::SourceFile;
use plcc_runtime::RunOptions;
use plcc_runtime::change::{self, CodeSource, Loader};
use plcc_runtime::cpu::Cpu;
use plcc_runtime::online::Service;
use plcc_runtime::options::ClockKind;
use plcc_runtime::run::start_changeable;
use plcc_runtime::signal::Source;

use crate::cli::Level;
use crate::inputs::Read;
use crate::{code, pipeline};

/// Compiles a source in the language of its file name.
fn compiled(file: &str, text: &str) -> (ProgramImage, CodeSource) {
    let mut read = Read { name: "line".to_string(), ..Read::default() };
    let unit = read.sources.add(SourceFile::new(file, text));
    read.units.push(unit);
    let settings = pipeline::Settings { require_main: true, ..pipeline::Settings::default() };
    let bound = pipeline::front(read, &settings);
    let errors: Vec<&str> = bound.diagnostics.iter().filter(|d| d.is_error()).map(|d| d.title.as_str()).collect();
    assert!(errors.is_empty(), "{errors:?}");
    let compiled = pipeline::back(&bound, Level::O2);
    let code = code::source(&compiled).expect("what is lowered becomes code");
    (compiled.image, code)
}

/// Looks at values at the end of each cycle, and changes the program there.
struct Hand {
    loader: Loader,
    names: Vec<&'static str>,
    /// Programs that are loaded after a cycle; `None`: the one before.
    loads: Vec<(u64, Option<(ProgramImage, CodeSource)>)>,
    seen: Rc<RefCell<Seen>>,
}

#[derive(Default, Debug)]
struct Seen {
    /// The values of each cycle.
    values: Vec<String>,
    /// What the changes said before they were made, and why others were not.
    items: Vec<String>,
    refused: Vec<String>,
}

impl Service for Hand {
    fn look(&self, _: &Cpu, _: u64, _: Option<u64>) -> bool {
        true
    }

    fn serve(&mut self, cpu: &Cpu, _: Duration) {
        let value = |name: &&str| match Source::find(name, &cpu.image, None) {
            Ok(source) => source.read(cpu, None).text(),
            Err(_) => "-".to_string(),
        };
        let mut seen = self.seen.borrow_mut();
        seen.values.push(self.names.iter().map(value).collect::<Vec<_>>().join(" "));
        let Some(at) = self.loads.iter().position(|(cycle, _)| *cycle == cpu.cycle_number()) else { return };
        let (_, program) = self.loads.remove(at);
        let prepared = match program {
            Some((image, code)) => self.loader.prepare(image, code),
            None => self.loader.previous(),
        };
        match prepared {
            Ok(prepared) => {
                seen.items.extend(prepared.items().iter().map(|item| item.text.clone()));
                drop(self.loader.order(prepared).expect("no other order waits"));
            }
            Err(why) => seen.refused.push(why),
        }
    }
}

/// Runs a program for so many cycles of 10 ms.
fn run(
    first: (ProgramImage, CodeSource),
    loads: Vec<(u64, Option<(ProgramImage, CodeSource)>)>,
    names: &[&'static str],
    cycles: u64,
) -> Seen {
    let options =
        RunOptions { clock: ClockKind::Virtual, cycles: Some(cycles), quiet: true, ..RunOptions::default() };
    let (loader, inbox) = change::loader(&options);
    let seen = Rc::<RefCell<Seen>>::default();
    let hand = Hand { loader, names: names.to_vec(), loads, seen: Rc::clone(&seen) };
    let exit = start_changeable(first.0, first.1, &options, Some(Box::new(hand)), inbox);
    assert_eq!(exit, 0);
    Rc::into_inner(seen).expect("the run has ended").into_inner()
}

/// Counters, S5 timers, IEC timers, edges, instances in instances and a delay interrupt: all of them hold state from cycle to cycle. `extra`
/// goes into declarations, `body` into the program.
fn chain(extra: &str, body: &str) -> String {
    format!(
        r#"
FUNCTION_BLOCK "Stage"
VAR_INPUT
  pulse : BOOL;
END_VAR
VAR
  {extra}
  edge : R_TRIG;
  count : INT;
  up : CTU_INT;
  delay : TON_TIME;
  last : ARRAY[0..3] OF INT;
  name : STRING[8] := 'stage';
END_VAR
BEGIN
  #edge(CLK := #pulse);
  IF #edge.Q THEN
    #count := #count + 1;
    #last[#count MOD 4] := #count;
  END_IF;
  #up(CU := #pulse, R := #up.CV >= 7, PV := 7);
  #delay(IN := NOT #delay.Q, PT := T#35ms);
  {body}
END_FUNCTION_BLOCK
FUNCTION_BLOCK "Line"
VAR
  beat : BOOL;
  a : "Stage";
  {extra}
  b : "Stage";
END_VAR
BEGIN
  #beat := NOT #beat;
  #a(pulse := #beat);
  #b(pulse := #a.delay.Q);
END_FUNCTION_BLOCK
DATA_BLOCK "LineDb"
"Line"
BEGIN
END_DATA_BLOCK
ORGANIZATION_BLOCK "Main"
BEGIN
  "LineDb"();
  %MW10 := %MW10 + 1;
END_ORGANIZATION_BLOCK
ORGANIZATION_BLOCK "Cyclic" : OB30
BEGIN
  %MW12 := %MW12 + 1;
END_ORGANIZATION_BLOCK
"#
    )
}

const CHAIN: [&str; 9] = [
    "MW10",
    "MW12",
    "LineDb.beat",
    "LineDb.a.count",
    "LineDb.a.up.CV",
    "LineDb.a.delay.ET",
    "LineDb.a.last[2]",
    "LineDb.b.count",
    "LineDb.b.name",
];

#[test]
fn a_hundred_changes_miss_no_beat() {
    let plain = || compiled("line.scl", &chain("", ""));
    // Members that come, go and move all others.
    let extras = ["x : INT := 3;", "", "y : BOOL; z : LREAL;", "text : STRING[20]; x : INT;"];
    let programs: Vec<_> =
        extras.iter().map(|extra| compiled("line.scl", &chain(extra, "%MW20 := %MW20 + 1;"))).collect();
    let loads = (0..100).map(|number| (5 + 3 * number, Some(programs[number as usize % 4].clone()))).collect();
    let unchanged = run(plain(), Vec::new(), &CHAIN, 400);
    let changed = run(plain(), loads, &CHAIN, 400);
    assert_eq!(changed.refused, Vec::<String>::new());
    assert!(changed.items.len() > 100, "{:?}", changed.items.len());
    for (cycle, (one, other)) in unchanged.values.iter().zip(&changed.values).enumerate() {
        assert_eq!(one, other, "cycle {}", cycle + 1);
    }
    assert_eq!(unchanged.values.last().map(String::as_str), Some("400 40 false 200 4 T#10ms 198 40 'stage'"));
}
