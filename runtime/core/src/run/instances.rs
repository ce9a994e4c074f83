//! Many CPUs with one program: `--instances`, `--instance-values`.
//!
//! They are independent, and each has a virtual clock, so what one does depends only on the program and its own
//! values. As many run at the same time as there are processors. Each takes the memory of its areas and data blocks;
//! they share the code. Results come in the order of the instances.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::path::Path;
use std::rc::Rc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, mpsc};

use plcc_abi::ProgramImage;
use plcc_literal::count::counted;

use super::session::{Session, prepare, settable, setting};
use super::{
    CodeMaker, EXIT_FAULT, EXIT_OK, EXIT_USAGE, end_requested, pace, say, tell_partial, verdict, watch_signals,
};
use crate::clock::Clock;
use crate::cpu::Cpu;
use crate::files;
use crate::io::Simulated;
use crate::options::{ClockKind, RunOptions};
use crate::report;

/// More are a mistake in the flag.
const INSTANCES_MAX: usize = 10_000_000;
/// Columns and length of a file with values.
const VALUES_BYTES_MAX: u64 = 256 << 20;

/// What an instance has printed and said.
struct Outcome {
    out: Vec<u8>,
    lines: Vec<String>,
    exit: u8,
}

/// Values that differ from instance to instance.
struct Table {
    /// The name of its file.
    file: String,
    names: Vec<String>,
    rows: Vec<Row>,
}

/// The values of an instance, and their line in the file.
struct Row {
    line: usize,
    values: Vec<String>,
}

/// The lines of a file, up to a record: the reader of CSV does not see the line break before it when it ends in `\r\n`, or empty lines.
struct Lines<'a> {
    text: &'a [u8],
    at: usize,
    line: usize,
}

impl Lines<'_> {
    /// The line of a record. Records must be asked for in their order.
    fn of(&mut self, record: Option<&csv::Position>) -> usize {
        let start = record.map_or(0, |record| record.byte() as usize);
        let rest = self.text.get(start..).unwrap_or_default();
        let begins = start + rest.iter().take_while(|byte| matches!(byte, b'\r' | b'\n')).count();
        let passed = self.text.get(self.at..begins).unwrap_or_default();
        self.line += passed.iter().filter(|byte| **byte == b'\n').count();
        self.at = self.at.max(begins);
        self.line
    }
}

impl Table {
    /// Reads a CSV file: names in the first line, then a line for each instance.
    fn read(path: &Path) -> Result<Table, String> {
        let shown = path.display();
        let text = files::read(path, VALUES_BYTES_MAX).map_err(|error| format!("{shown}: {error}"))?;
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_slice());
        let names: Vec<String> =
            reader.headers().map_err(|error| format!("{shown}: {error}"))?.iter().map(str::to_string).collect();
        if let [name] = names.as_slice()
            && name.contains(';')
        {
            return Err(format!("{shown}:1: columns are separated by `,`; write {}", name.replace(';', ",")));
        }
        let mut lines = Lines { text: &text, at: 0, line: 1 };
        let mut rows = Vec::new();
        for row in reader.records() {
            let row = row.map_err(|error| format!("{shown}{}", plain(&error, &mut lines)))?;
            rows.push(Row { line: lines.of(row.position()), values: row.iter().map(str::to_string).collect() });
        }
        let mut seen = BTreeSet::new();
        if let Some(name) = names.iter().find(|name| !seen.insert(name.to_ascii_lowercase())) {
            return Err(format!("{shown}:1: `{name}` has two columns; leave one of them out"));
        }
        if rows.is_empty() {
            return Err(format!("{shown}: no values; the first line has names, each further line is an instance"));
        }
        Ok(Table { file: shown.to_string(), names, rows })
    }
}

/// What is wrong with a line of the file, after its name.
fn plain(error: &csv::Error, lines: &mut Lines) -> String {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
            let line = lines.of(pos.as_ref());
            let names = counted(*expected_len as usize, "name");
            format!(":{line}: the first line has {names}, but this one has {}", counted(*len as usize, "value"))
        }
        _ => format!(": {error}"),
    }
}

/// Runs the instances. Result: the worst exit code of all.
pub(super) fn run(image: ProgramImage, code: CodeMaker, options: &RunOptions) -> u8 {
    let (count, table) = match check(options) {
        Ok(checked) => checked,
        Err(message) => {
            say!("runtime: {message}");
            return EXIT_USAGE;
        }
    };
    tell_partial(&image.partial, options.quiet);
    image.notices.iter().for_each(|notice| say!("{notice}"));
    watch_signals();
    let mut image = image;
    options.configure(&mut image.config);
    // Instances would write to one file.
    image.config.retain.file = None;
    let image = Arc::new(image);
    if let Err(message) = fits(&image, code, options, table.as_ref()) {
        say!("runtime: {message}");
        return EXIT_USAGE;
    }
    let next = AtomicUsize::new(0);
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(count);
    let (send, receive) = mpsc::sync_channel(4 * threads);
    let exit = std::thread::scope(|scope| {
        for _ in 0..threads {
            let (send, next, image, table) = (send.clone(), &next, &image, &table);
            // Generated code nests as deep as a CPU allows.
            let thread = std::thread::Builder::new().stack_size(64 << 20);
            let spawned = thread.spawn_scoped(scope, move || {
                loop {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    if number >= count
                        || end_requested()
                        || send.send((number, one(number, image, code, options, table))).is_err()
                    {
                        return;
                    }
                }
            });
            if let Err(error) = spawned {
                say!("runtime: not all processors are used: {error}");
            }
        }
        drop(send);
        report_in_order(&receive)
    });
    if let (EXIT_OK, false, false, Some(cycles)) = (exit, options.quiet, end_requested(), options.cycles) {
        say!("{} ended after {}", counted(count, "instance"), counted(cycles as usize, "cycle"));
    }
    exit
}

/// Number of instances, and their values.
fn check(options: &RunOptions) -> Result<(usize, Option<Table>), String> {
    let table = options.instance_values.as_deref().map(Table::read).transpose()?;
    let rows = table.as_ref().map(|table| table.rows.len());
    let count = match (options.instances.map(|count| count as usize), rows) {
        (Some(count), Some(rows)) if count != rows => {
            return Err(format!("--instances says {count}, but --instance-values has values for {rows}"));
        }
        (Some(count), _) | (None, Some(count)) => count,
        (None, None) => 0,
    };
    if !(1..=INSTANCES_MAX).contains(&count) {
        return Err(format!("--instances takes a number from 1 to {INSTANCES_MAX}"));
    }
    if options.clock != ClockKind::Virtual {
        return Err("instances run one after the other on each processor: add --clock virtual".to_string());
    }
    if options.cycles.is_none() {
        return Err("instances need an end: add --cycles N".to_string());
    }
    let single = [
        ("--trace", options.trace.is_some()),
        ("--alarm-log", options.alarm_log.is_some()),
        ("--retain", options.retain.is_some()),
        ("--data", options.data.is_some()),
        ("--diag", options.diag),
        ("--record", options.record.is_some()),
        ("--replay", options.replay.is_some()),
        ("--realtime", options.realtime),
    ];
    match single.iter().find(|(_, given)| *given) {
        Some((flag, _)) => Err(format!("{flag} is for one CPU: leave it out, or run the instance of interest alone")),
        None => Ok((count, table)),
    }
}

/// A place for what a scenario prints.
#[derive(Clone, Default)]
struct Buffer(Rc<RefCell<Vec<u8>>>);

impl Write for Buffer {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.borrow_mut().extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// An instance that has not begun.
fn begin(
    image: &Arc<ProgramImage>,
    code: CodeMaker,
    options: &RunOptions,
    out: Buffer,
) -> Result<(Rc<Cpu>, Session), String> {
    let driver = Box::new(Simulated::new(image.config.modules.clone()));
    let cpu = Cpu::new(Arc::clone(image), code(), Clock::simulated(), driver);
    let session = prepare(&cpu, options, Box::new(out))?;
    match session.triggered.is_some() {
        true => Err("the trace of a watch table is for one CPU: run the instance of interest alone".to_string()),
        false => Ok((cpu, session)),
    }
}

/// Whether all instances can begin: what is wrong in flags and names is so for each of them, and said once.
fn fits(image: &Arc<ProgramImage>, code: CodeMaker, options: &RunOptions, table: Option<&Table>) -> Result<(), String> {
    let (cpu, _) = begin(image, code, options, Buffer::default())?;
    let Some(Table { file, names, .. }) = table else { return Ok(()) };
    names.iter().try_for_each(|name| settable(&cpu, name).map(drop).map_err(|message| format!("{file}:1: {message}")))
}

/// Runs an instance to its end.
fn one(
    number: usize,
    image: &Arc<ProgramImage>,
    code: CodeMaker,
    options: &RunOptions,
    table: &Option<Table>,
) -> Outcome {
    let failed =
        |message: String| Outcome { out: Vec::new(), lines: vec![format!("runtime: {message}")], exit: EXIT_USAGE };
    let buffer = Buffer::default();
    let (cpu, mut session) = match begin(image, code, options, buffer.clone()) {
        Ok(begun) => begun,
        Err(message) => return failed(message),
    };
    if let Some(Table { file, names, rows }) = table {
        let (line, row) = rows.get(number).map_or((0, &[][..]), |row| (row.line, row.values.as_slice()));
        let value = |(name, text): (&String, &String)| {
            setting(&cpu, name, text).map_err(|message| format!("{file}:{line}: {name}: {message}"))
        };
        let values: Result<Vec<_>, String> = names.iter().zip(row).map(value).collect();
        match values {
            Ok(values) => session.set(values),
            Err(message) => return failed(message),
        }
    }
    let cycles = cpu.execute(&pace(&cpu, options), &mut session);
    let mut out = buffer.0.take();
    if !session.printed.is_empty() {
        let json = options.json.then_some((cycles, session.last));
        // A vector takes everything.
        let _ = report::write_values(&cpu, session.player.plant(), &session.printed, json, &mut out);
    }
    let (lines, fault) = verdict(&cpu, &RunOptions { quiet: true, ..options.clone() }, &session, cycles);
    Outcome { out, lines, exit: if fault { EXIT_FAULT } else { EXIT_OK } }
}

/// Prints what instances printed, each line with the number of its instance, in the order of their numbers.
fn report_in_order(receive: &mpsc::Receiver<(usize, Outcome)>) -> u8 {
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    let (mut waiting, mut next, mut exit) = (BTreeMap::new(), 0, EXIT_OK);
    let (mut failed, mut broken) = (0usize, None);
    for (number, outcome) in receive {
        waiting.insert(number, outcome);
        while let Some(outcome) = waiting.remove(&next) {
            for line in String::from_utf8_lossy(&outcome.out).lines() {
                let written = match line.strip_prefix('{') {
                    Some(rest) => writeln!(out, "{{\"instance\": {next}, {rest}"),
                    None => writeln!(out, "instance {next}: {line}"),
                };
                broken = broken.or(written.err());
            }
            outcome.lines.iter().for_each(|line| say!("instance {next}: {line}"));
            failed += usize::from(outcome.exit != EXIT_OK);
            exit = exit.max(outcome.exit);
            next += 1;
        }
    }
    broken = broken.or(out.flush().err());
    if let Some(error) = broken.filter(|error| !super::is_closed(error)) {
        say!("runtime: cannot write to standard output: {error}");
        exit = EXIT_USAGE;
    }
    if failed > 0 {
        say!("{failed} of {next} instances failed");
    }
    exit
}

#[cfg(test)]
mod tests {
    use plcc_abi::image::BlockKind;

    use super::*;
    use crate::code::Code;
    use crate::tests::image;

    /// OB 1 adds MW 2 to MW 4.
    struct Adding;

    impl Code for Adding {
        fn call(&self, _: u32, mem: *mut u8, _: u32, _: u32) {
            // SAFETY: the runtime passes the base of its own memory.
            let memory = unsafe { &Cpu::of(mem).memory };
            let at = plcc_abi::layout::M;
            memory.set_word(at + 4, memory.word(at + 4).wrapping_add(memory.word(at + 2)));
        }
    }

    fn adding() -> Rc<dyn Code> {
        Rc::new(Adding)
    }

    fn options() -> RunOptions {
        RunOptions {
            clock: ClockKind::Virtual,
            cycles: Some(10),
            print: vec!["MW4".to_string()],
            instances: Some(2),
            ..RunOptions::default()
        }
    }

    fn file(name: &str, text: &str) -> std::path::PathBuf {
        let path = std::env::temp_dir().join(format!("plcc-instances-{}-{name}.csv", std::process::id()));
        std::fs::write(&path, text).unwrap();
        path
    }

    #[test]
    fn instances_have_values_of_their_own() {
        let path = file("values", "MW2, MW4\n1, 0\n3, 100\n");
        let options = RunOptions { instance_values: Some(path.clone()), ..options() };
        let (count, table) = check(&options).unwrap();
        assert_eq!(count, 2);
        let image = Arc::new(image(&[(BlockKind::Ob, 1)]));
        let outcomes = [0, 1].map(|number| one(number, &image, &adding, &options, &table));
        let texts = outcomes.map(|outcome| (String::from_utf8(outcome.out).unwrap(), outcome.lines, outcome.exit));
        assert_eq!(texts[0], ("MW4 = 16#000A\n".to_string(), Vec::new(), EXIT_OK));
        assert_eq!(texts[1], ("MW4 = 16#0082\n".to_string(), Vec::new(), EXIT_OK));
        std::fs::remove_file(path).unwrap();
    }

    #[test]
    fn wrong_values_name_their_line() {
        let path = file("wrong", "MW2\n1\nmany\n");
        let options = RunOptions { instance_values: Some(path.clone()), ..options() };
        let (_, table) = check(&options).unwrap();
        let image = Arc::new(image(&[(BlockKind::Ob, 1)]));
        let outcome = one(1, &image, &adding, &options, &table);
        assert_eq!(outcome.exit, EXIT_USAGE);
        assert!(outcome.lines[0].contains("wrong.csv:3: MW2: `many` "), "{:?}", outcome.lines);
        std::fs::remove_file(path).unwrap();
    }

    #[test]
    fn what_is_for_one_cpu_is_refused() {
        let refused = |change: &dyn Fn(&mut RunOptions)| {
            let mut options = options();
            change(&mut options);
            check(&options).map(|(count, _)| count).unwrap_err()
        };
        assert!(refused(&|options| options.clock = ClockKind::Real).contains("--clock virtual"));
        assert!(refused(&|options| options.cycles = None).contains("--cycles"));
        assert!(refused(&|options| options.trace = Some("x.csv".into())).contains("--trace"));
        assert!(refused(&|options| options.instances = Some(0)).contains("from 1"));
        let path = file("rows", "MW2\n1\n");
        assert!(refused(&|options| options.instance_values = Some(path.clone())).contains("has values for 1"));
        std::fs::remove_file(path).unwrap();
    }
}
