//! Programs that are changed while they run, under the virtual clock.

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::mpsc::Receiver;
use std::time::Duration;

use plcc_abi::ProgramImage;
use plcc_diag::SourceFile;
use plcc_runtime::RunOptions;
use plcc_runtime::change::{self, CodeSource, Loader};
use plcc_runtime::cpu::Cpu;
use plcc_runtime::loaded;
use plcc_runtime::online::Service;
use plcc_runtime::options::ClockKind;
use plcc_runtime::run::start_changeable;
use plcc_runtime::signal::Source;

use crate::cli::Level;
use crate::inputs::{self, Read};
use crate::pipeline::Bound;
use crate::{code, link, pipeline};

/// Compiles a source in the language of its file name.
fn compiled(file: &str, text: &str) -> (ProgramImage, CodeSource) {
    compiled_all(&[(file, text)])
}

fn compiled_all(files: &[(&str, &str)]) -> (ProgramImage, CodeSource) {
    compiled_of(&bound(files))
}

fn compiled_of(bound: &Bound) -> (ProgramImage, CodeSource) {
    let compiled = pipeline::back(bound, Level::O2);
    let code = code::source(&compiled, None).expect("what is lowered becomes code");
    (compiled.image, code)
}

fn bound(files: &[(&str, &str)]) -> Bound {
    let mut read = Read { name: "line".to_string(), ..Read::default() };
    for (file, text) in files {
        let unit = read.sources.add(SourceFile::new(*file, *text));
        read.units.push(unit);
    }
    bound_of(read)
}

fn bound_of(read: Read) -> Bound {
    let settings = pipeline::Settings { require_main: true, ..pipeline::Settings::default() };
    let bound = pipeline::front(read, &settings);
    let errors: Vec<&str> = bound.diagnostics.iter().filter(|d| d.is_error()).map(|d| d.title.as_str()).collect();
    assert!(errors.is_empty(), "{errors:?}");
    bound
}

/// Looks at values at the end of each cycle, and changes the program there.
struct Hand {
    loader: Loader,
    names: Vec<&'static str>,
    /// Programs that are loaded after a cycle; `None`: the one before.
    loads: Vec<(u64, Option<(ProgramImage, CodeSource)>)>,
    /// Gets what the last change says when it is done.
    answer: Option<Receiver<Result<Vec<String>, String>>>,
    seen: Rc<RefCell<Seen>>,
}

#[derive(Default, Debug)]
struct Seen {
    /// The values of each cycle.
    values: Vec<String>,
    /// What the changes said before they were made, and why others were not.
    items: Vec<String>,
    refused: Vec<String>,
    /// What they said after they were made.
    lines: Vec<String>,
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
        if let Some(Ok(lines)) = self.answer.as_ref().and_then(|answer| answer.try_recv().ok()) {
            seen.lines.extend(lines);
        }
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
                self.answer = Some(self.loader.order(prepared).expect("no other order waits"));
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
    let options = RunOptions { clock: ClockKind::Virtual, cycles: Some(cycles), quiet: true, ..RunOptions::default() };
    let (loader, inbox) = change::loader(&options);
    let seen = Rc::<RefCell<Seen>>::default();
    let hand = Hand { loader, names: names.to_vec(), loads, answer: None, seen: Rc::clone(&seen) };
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
ORGANIZATION_BLOCK OB30
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
    let often = |(mut image, code): (ProgramImage, CodeSource)| {
        image.config.cyclic_period_ms = vec![(30, 70)];
        (image, code)
    };
    let plain = || often(compiled("line.scl", &chain("", "")));
    // Members that come, go and move all others.
    let extras = ["x : INT := 3;", "", "y : BOOL; z : LREAL;", "text : STRING[20]; x : INT;"];
    let programs: Vec<_> =
        extras.iter().map(|extra| often(compiled("line.scl", &chain(extra, "%MW20 := %MW20 + 1;")))).collect();
    let loads = (0..100).map(|number| (5 + 3 * number, Some(programs[number as usize % 4].clone()))).collect();
    let unchanged = run(plain(), Vec::new(), &CHAIN, 400);
    let changed = run(plain(), loads, &CHAIN, 400);
    assert_eq!(changed.refused, Vec::<String>::new());
    assert!(changed.items.len() > 100, "{:?}", changed.items.len());
    for (cycle, (one, other)) in unchanged.values.iter().zip(&changed.values).enumerate() {
        assert_eq!(one, other, "cycle {}", cycle + 1);
    }
    assert_eq!(unchanged.values.last().map(String::as_str), Some("16#0190 16#0039 0 200 4 T#30ms 198 66 'stage'"));
}

/// Timers and counters of the CPU, edges in bit memory, and a data block with absolute addresses.
#[test]
fn areas_of_a_300_stay() {
    let program = |declared: &str, body: &str| {
        compiled(
            "line.stl",
            &format!(
                "DATA_BLOCK DB 5\nSTRUCT\n{declared} n : INT := 2;\n on : BOOL;\n off : BOOL;\nEND_STRUCT\nBEGIN\nEND_DATA_BLOCK\n\
                 ORGANIZATION_BLOCK OB 1\nBEGIN\n\
                 NETWORK\nAN M 0.0\n= M 0.0\nA M 0.0\nFP M 0.1\nCU C 1\n\
                 NETWORK\nAN T 1\nL S5T#70MS\nSD T 1\nA T 1\nCU C 2\n\
                 NETWORK\nL C 1\nT DB5.DBW 2\nAN M 0.0\n= DB5.DBX 4.1\n{body}\nEND_ORGANIZATION_BLOCK\n"
            ),
        )
    };
    let names = ["C1", "C2", "M0.1", "DB5.DBX4.1", "T1"];
    let plain = || program("a : WORD;", "");
    let unchanged = run(plain(), Vec::new(), &names, 60);
    let loads = vec![
        (7, Some(program("a : WORD;", "NETWORK\nL 1\nT MW 30\n"))),
        (20, None),
        (33, Some(program("a : WORD;", "NETWORK\nL 2\nT MW 30\n"))),
    ];
    let changed = run(plain(), loads, &names, 60);
    assert_eq!(changed.refused, Vec::<String>::new());
    assert_eq!(changed.items, Vec::<String>::new());
    assert_eq!(unchanged.values, changed.values);
}

#[test]
fn what_goes_and_comes_is_told() {
    let program = |members: &str| {
        compiled(
            "line.scl",
            &format!(
                "TYPE \"Part\"\nSTRUCT\n{members}\nEND_STRUCT\nEND_TYPE\nDATA_BLOCK \"Data\"\nVAR\nparts : ARRAY[1..3] OF \"Part\";\n\
                 END_VAR\nBEGIN\nEND_DATA_BLOCK\nORGANIZATION_BLOCK \"Main\"\nBEGIN\n\"Data\".parts[2].n := 7;\n\
                 \"Data\".parts[3].on := TRUE;\nEND_ORGANIZATION_BLOCK\n"
            ),
        )
    };
    let loads = vec![
        (2, Some(program("n : INT; on : BOOL; speed : REAL := 1.5;"))),
        (4, Some(program("speed : LREAL; on : BOOL; n : INT;"))),
        (6, None),
    ];
    let names = ["Data.parts[2].n", "Data.parts[3].on", "Data.parts[1].speed"];
    let seen = run(program("n : INT; on : BOOL;"), loads, &names, 7);
    assert_eq!(
        seen.items,
        [
            "DB 1 \"Data\".parts[].speed is new: it gets its initial value",
            "DB 1 \"Data\".parts[].speed is LREAL instead of REAL: it gets its initial value",
            "DB 1 \"Data\".parts[].speed is REAL instead of LREAL: it gets its initial value",
        ]
    );
    assert_eq!(seen.values[1], "7 1 -");
    assert_eq!(seen.values[2], "7 1 1.5");
    assert_eq!(seen.values[4], "7 1 0");
    assert_eq!(seen.values[6], "7 1 1.5");
}

#[test]
fn what_cannot_be_changed_is_refused_and_the_old_program_goes_on() {
    let text = "ORGANIZATION_BLOCK \"Main\"\nBEGIN\n%MW10 := %MW10 + 1;\nEND_ORGANIZATION_BLOCK\n";
    let with = |change: &dyn Fn(&mut ProgramImage)| {
        let (mut image, code) = compiled("line.scl", text);
        change(&mut image);
        Some((image, code))
    };
    let loads = vec![
        (1, with(&|image| image.name = "other".to_string())),
        (2, with(&|image| image.profile.bit_memory = 1024)),
        (3, with(&|image| image.config.clock_memory_byte = Some(9))),
        (4, None),
    ];
    let seen = run(compiled("line.scl", text), loads, &["MW10"], 6);
    let begins = [
        "the running program is `line`, this one is `other`; if it is another version of it, write `name = \"line\"` into",
        "the CPU is another one",
        "plc.toml sets",
        "there is no",
    ];
    assert_eq!(seen.refused.len(), begins.len());
    for (refused, begin) in seen.refused.iter().zip(begins) {
        assert!(refused.starts_with(begin), "{refused}");
    }
    assert_eq!(seen.values, ["16#0001", "16#0002", "16#0003", "16#0004", "16#0005", "16#0006"]);
}

/// A chart with two steps; `further` is one between them.
fn chart(further: &str) -> String {
    let (step, to) = match further {
        "" => (String::new(), "Fill"),
        name => (
            format!(
                "STEP {name} (*$_NUM 3*):\nEND_STEP\nTRANSITION On (*$_NUM 3*)\n  FROM {name}\n  TO Fill\nCONDITION := #Start\nEND_TRANSITION\n"
            ),
            name,
        ),
    };
    format!(
        "FUNCTION_BLOCK \"Filling\"\nVAR_INPUT\n  Start : BOOL;\n  Full : BOOL;\nEND_VAR\nVAR_OUTPUT\n  Valve : BOOL;\nEND_VAR\n\
         INITIAL_STEP Idle (*$_NUM 1*):\nEND_STEP\nSTEP Fill (*$_NUM 2*):\n#Valve   (N)\nEND_STEP\n{step}\
         TRANSITION Done (*$_NUM 2*)\n  FROM Fill\n  TO Idle (*$_JUMP*)\nCONDITION := #Full\nEND_TRANSITION\n\
         TRANSITION Go (*$_NUM 1*)\n  FROM Idle\n  TO {to}\nCONDITION := #Start\nEND_TRANSITION\nEND_FUNCTION_BLOCK\n"
    )
}

/// A chart goes on at its step.
#[test]
fn charts_go_on_at_their_step() {
    let program = |step: &str, body: &str| {
        let main = format!(
            "DATA_BLOCK \"F\"\n\"Filling\"\nBEGIN\nEND_DATA_BLOCK\nORGANIZATION_BLOCK OB 1\nVAR_TEMP\ninfo : ARRAY[0..19] OF BYTE;\n\
             END_VAR\nBEGIN\nMW20 := INT_TO_WORD(WORD_TO_INT(MW20) + 1);\n\"F\"(Start := WORD_TO_INT(MW20) MOD 7 = 0, \
             Full := WORD_TO_INT(MW20) MOD 5 = 0);\n{body}END_ORGANIZATION_BLOCK\n"
        );
        compiled_all(&[("filling.gr7", &chart(step)), ("main.scl", &main)])
    };
    let names = ["F.Idle.X", "F.Fill.X", "F.Fill.T", "F.Valve", "MW20"];
    let unchanged = run(program("", ""), Vec::new(), &names, 30);
    let loads = vec![(4, Some(program("", "MW30 := 1;\n"))), (17, Some(program("", "")))];
    let changed = run(program("", ""), loads, &names, 30);
    assert_eq!((changed.refused, changed.items), (Vec::new(), Vec::new()));
    assert_eq!(unchanged.values, changed.values);
}

/// A chart with a further step, or without one, goes on at its active step with its time and its static data, unless the program no longer has that step.
#[test]
fn charts_with_other_steps_go_on() {
    let array = "(*$_CMPSET\n   SSBLevel: Array\n*)\n";
    let cases = [("", "F.Fill.T", ["more", "On"]), (array, "F.G7S[2].T", ["step 3", "transition 3"])];
    for (settings, time, [step, transition]) in cases {
        let program = |step: &str| {
            let chart = chart(step).replacen("INITIAL_STEP", &format!("{settings}INITIAL_STEP"), 1);
            let chart = chart.replacen("INITIAL_STEP", "VAR\n  count : INT;\nEND_VAR\nINITIAL_STEP", 1);
            let main = "DATA_BLOCK \"F\"\n\"Filling\"\nBEGIN\nEND_DATA_BLOCK\nORGANIZATION_BLOCK OB 1\nBEGIN\n\
                        MW20 := INT_TO_WORD(WORD_TO_INT(MW20) + 1);\n\"F\".count := \"F\".count + 1;\n\
                        \"F\"(Start := WORD_TO_INT(MW20) MOD 7 = 0, Full := WORD_TO_INT(MW20) MOD 5 = 0);\nEND_ORGANIZATION_BLOCK\n";
            compiled_all(&[("filling.gr7", &chart), ("main.scl", main)])
        };
        let loads = vec![(8, Some(program("more"))), (15, Some(program("")))];
        let seen = run(program(""), loads, &["F.S_NO", time, "F.Valve", "F.count"], 20);
        let at = |cycle: usize| seen.values[cycle - 1].as_str();
        assert_eq!([at(7), at(8), at(9)], ["2 T#0ms 1 7", "2 T#10ms 1 8", "2 T#20ms 1 9"]);
        assert_eq!([at(10), at(14), at(15)], ["1 T#30ms 0 10", "3 T#30ms 0 14", "3 T#30ms 0 15"]);
        assert_eq!([at(16), at(20)], ["1 T#0ms 0 16", "1 T#0ms 0 20"]);
        let other = "DB 1 \"F\": the chart has other steps or transitions";
        let goes_on = "it goes on at its active steps";
        let items = [
            format!("{other}, new: {step}, {transition}; {goes_on}"),
            format!(
                "{other}, gone: {step}, {transition}; {goes_on}; if {step} is one of them, it begins at its initial step, and what \
                 its active steps have switched on stays on: switch the chart off before (OFF_SQ) if it must not"
            ),
        ];
        assert_eq!(seen.items, items);
        let begins = "was active and is gone; the chart begins at its initial step";
        assert_eq!(seen.lines, [format!("DB 1 \"F\": {step} {begins}")]);
    }
}

/// A chart of the TIA Portal with two active steps goes on at both, when a step is renamed and comes before all others.
#[test]
fn charts_of_the_portal_go_on() {
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/run/graph/two-doses-1500");
    let folder = tempfile::tempdir().expect("a folder");
    let write = |path: &str, change: &dyn Fn(String) -> String| {
        let text = std::fs::read_to_string(format!("{source}/{path}")).expect("it is a test");
        let to = folder.path().join(path);
        std::fs::create_dir_all(to.parent().expect("the folder")).expect("a folder");
        std::fs::write(to, change(text)).expect("a file");
    };
    let same = |text: String| text;
    let program = |change: &dyn Fn(String) -> String| {
        for path in ["PLC tags/Default tag table.xml", "Program blocks/Doses_DB.xml", "plc.toml"] {
            write(path, &same);
        }
        write("Program blocks/Doses.xml", change);
        let main = "ORGANIZATION_BLOCK \"Main\"\nBEGIN\n%MW100 := INT_TO_WORD(WORD_TO_INT(%MW100) + 1);\n\
                    %I1.0 := WORD_TO_INT(%MW100) = 2;\n\"Doses_DB\"();\nEND_ORGANIZATION_BLOCK\n";
        write("Program blocks/Main.scl", &|_| main.to_string());
        compiled_of(&bound_of(inputs::read(&[folder.path().to_path_buf()])))
    };
    let moved = |text: String| {
        let text = text.replace("\"Mix\"", "\"Stir\"");
        let (start, first) =
            (text.find("<Step Number=\"6\"").expect("a step"), text.find("<Step Number=\"1\"").expect("a step"));
        let end = start + text[start..].find("</Step>").expect("its end") + "</Step>".len();
        format!("{}{}{}{}", &text[..first], &text[start..end], &text[first..start], &text[end..])
    };
    let names = ["DoseA", "DoseB"].map(|step| [format!("Doses_DB.{step}.X"), format!("Doses_DB.{step}.T")]).concat();
    let names: Vec<&'static str> = names.into_iter().map(|name| &*Box::leak(name.into_boxed_str())).collect();
    let unchanged = run(program(&same), Vec::new(), &names, 10);
    let changed = run(program(&same), vec![(4, Some(program(&moved))), (6, Some(program(&same)))], &names, 10);
    assert_eq!((changed.refused, changed.lines), (Vec::new(), Vec::new()));
    assert_eq!(changed.items.len(), 2, "{:?}", changed.items);
    assert_eq!(unchanged.values, changed.values);
    assert_eq!(changed.values[9], "1 T#800ms 1 T#800ms");
}

/// A program as `plcc load` sends it.
fn sent(text: &str) -> (ProgramImage, CodeSource) {
    let bound = bound(&[("line.scl", text)]);
    let mut plain = pipeline::lower(&bound, Level::O2);
    let probed = pipeline::lower_beside(&bound, &mut plain);
    let objects = pipeline::objects(plain, probed, [None, None]).expect("what is lowered becomes an object");
    let bytes = link::loadable(&objects).expect("plcc links its own objects");
    loaded::load(&bytes).expect("it is of this plcc")
}

/// A program that was sent to the process does the same as one that was compiled in it.
#[test]
fn a_loaded_program_goes_on() {
    let texts = "\"LineDb\".b.name := CONCAT(IN1 := 'n', IN2 := \"LineDb\".b.name);";
    let plain = || compiled("line.scl", &chain("", texts));
    let loads = vec![(7, Some(sent(&chain("x : INT;", texts)))), (20, None), (33, Some(sent(&chain("", texts))))];
    let (unchanged, changed) = (run(plain(), Vec::new(), &CHAIN, 60), run(plain(), loads, &CHAIN, 60));
    assert_eq!(changed.refused, Vec::<String>::new());
    assert_eq!(unchanged.values, changed.values);
}

/// Loads a program after cycle 3, and watches its OB 1.
struct Onlooker {
    loader: Loader,
    program: Option<(ProgramImage, CodeSource)>,
    /// What was seen by watching: that there is nothing to see, then the values that the probes have told.
    seen: Rc<RefCell<Vec<String>>>,
}

impl Service for Onlooker {
    fn look(&self, _: &Cpu, _: u64, _: Option<u64>) -> bool {
        true
    }

    fn serve(&mut self, cpu: &Cpu, _: Duration) {
        let mut seen = self.seen.borrow_mut();
        match cpu.cycle_number() {
            2 => seen.extend(cpu.watch_block(1, "OB1", None).err()),
            3 => {
                let (image, code) = self.program.take().expect("it is loaded once");
                let prepared = self.loader.prepare(image, code).expect("the change is possible");
                drop(self.loader.order(prepared).expect("no other order waits"));
            }
            6 => seen.extend(cpu.watch_block(1, "OB1", None).err()),
            8 => {
                let recorded = cpu.look_at_block(1).and_then(|looked| looked.recorded).expect("OB 1 has run");
                seen.push(format!("cycle {}", recorded.cycle));
                seen.extend(recorded.seen.iter().flatten().map(|seen| format!("{seen:?}")));
                cpu.unwatch_block(1);
            }
            _ => {}
        }
    }
}

#[test]
fn a_loaded_program_can_be_watched() {
    let counting =
        |step: u8| format!("ORGANIZATION_BLOCK \"Main\"\nBEGIN\n  %MW10 := %MW10 + {step};\nEND_ORGANIZATION_BLOCK\n");
    let options = RunOptions { clock: ClockKind::Virtual, cycles: Some(10), quiet: true, ..RunOptions::default() };
    let (loader, inbox) = change::loader(&options);
    let seen = Rc::<RefCell<Vec<String>>>::default();
    let onlooker = Onlooker { loader, program: Some(sent(&counting(100))), seen: Rc::clone(&seen) };
    let (image, code) = compiled("line.scl", &counting(1));
    assert_eq!(start_changeable(image, code, &options, Some(Box::new(onlooker)), inbox), 0);
    let seen = seen.take();
    assert!(seen.first().is_some_and(|told| told.contains("without the code that can be watched")), "{seen:?}");
    assert_eq!(seen.get(1).map(String::as_str), Some("cycle 7"));
    // Three cycles of the first program, then four of the other.
    assert!(seen.iter().any(|told| told == "Value(303)") && seen.iter().any(|told| told == "Value(403)"), "{seen:?}");
}

/// Edges of EU, ED and counters, timers, V memory, a timed interrupt and an analog output of an S7-200. `first` and `within` are networks that
/// come to the others, `work` is in a network with an edge.
fn scans(first: &str, within: &str, work: &str) -> (ProgramImage, CodeSource) {
    compiled(
        "line.awl",
        &format!(
            "ORGANIZATION_BLOCK Main:OB1\nBEGIN\n{first}\
             Network 1\nLD SM0.1\nMOVB 30, SMB34\nATCH INT0, 10\nENI\n\
             Network 2\nLD SM0.0\nINCW VW0\n{within}\
             Network 3\nLD V1.1\nEU\nINCW VW2\n{work}\
             Network 4\nLD V1.2\nED\nINCW VW4\nLD V1.0\nLD M0.7\nCTU C5, 9\nLD C5\n= M0.7\n\
             Network 5\nLDN T37\nTON T37, 4\nLD T37\nINCW VW6\nMOVW VW6, AQW2\nEND_ORGANIZATION_BLOCK\n\
             INTERRUPT_BLOCK Beat:INT0\nBEGIN\nNetwork 1\nLD V1.0\nEU\nINCW VW8\nLD SM0.0\nINCB VB20\nEND_INTERRUPT_BLOCK\n"
        ),
    )
}

const SCANS: [&str; 9] = ["VW0", "VW2", "VW4", "C5.VALUE", "T37.VALUE", "VW6", "VW8", "VB20", "AQW2"];

#[test]
fn scans_of_an_s7200_miss_no_edge() {
    let plain = || scans("", "", "");
    let edge = "Network 9\nLD V1.0\nEU\nED\nINCW VW100\n";
    let programs = [scans(edge, "", ""), scans("", edge, "INCW VW102\n"), plain(), scans(edge, edge, "INCW VW102\n")];
    let loads = (0..100).map(|number| (5 + 3 * number, Some(programs[number as usize % 4].clone()))).collect();
    let (unchanged, changed) = (run(plain(), Vec::new(), &SCANS, 400), run(plain(), loads, &SCANS, 400));
    assert_eq!(changed.refused, Vec::<String>::new());
    let new = [
        "OB1, network 1: its edges begin as in the first scan",
        "OB1, network 4: its edges begin as in the first scan",
    ];
    assert!(changed.items.iter().any(|item| item == new[0]) && changed.items.iter().any(|item| item == new[1]));
    for (cycle, (one, other)) in unchanged.values.iter().zip(&changed.values).enumerate() {
        assert_eq!(one, other, "cycle {}", cycle + 1);
    }
    // All of them are at work.
    let of = |row: &String, column: usize| row.split(' ').nth(column).map(str::to_string);
    for (column, name) in SCANS.iter().enumerate() {
        let first = of(&unchanged.values[0], column);
        assert!(unchanged.values.iter().any(|row| of(row, column) != first), "{name}");
    }
}

/// A program without the routine that an event is attached to; then the first one again, which attaches it in the first scan only.
#[test]
fn a_routine_that_is_gone_is_detached() {
    let gone = "ORGANIZATION_BLOCK Main:OB1\nBEGIN\nNetwork 1\nLD SM0.0\nINCW VW0\nEND_ORGANIZATION_BLOCK\n";
    let loads = vec![(10, Some(compiled("line.awl", gone))), (20, None)];
    let seen = run(scans("", "", ""), loads, &["VB20", "VW0"], 30);
    assert_eq!(seen.refused, Vec::<String>::new());
    let after = |scan: &str| seen.values[9].replace(" 16#000A", scan);
    assert_eq!((&seen.values[10], &seen.values[29]), (&after(" 16#000B"), &after(" 16#001E")));
}
