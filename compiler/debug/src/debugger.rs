//! The debugger while the program runs: it looks at each probe, and the program waits there while it is stopped for
//! the client.

use std::cell::RefCell;
use std::collections::HashMap;
use std::io::Write;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError};

use plcc_abi::ProgramImage;
use plcc_diag::SourceMap;
use plcc_model::Program;
use plcc_runtime::Code;
use plcc_runtime::cpu::Cpu;
use plcc_runtime::diagnostics::{self, Entry};
use plcc_runtime::probe::{Phase, Watcher};
use serde_json::json;

use crate::breakpoint::{At, Breakpoint, logged};
use crate::course::{Course, Step, Wanted};
use crate::data::Watched;
use crate::launch::Launch;
use crate::lookup::{Found, Here};
use crate::places::Places;
use crate::registers;
use crate::stack::{Arrival, Stack};
use crate::variables::{self, Groups};
use crate::wire::{Incoming, Wire};

/// Statements from one look at the client to the next.
const POLL_STEP: u64 = 64;

/// See the module comment.
pub struct Debugger {
    pub program: Program,
    pub sources: SourceMap,
    pub places: Places,
    pub image: Arc<ProgramImage>,
    pub code: Rc<dyn Code>,
    pub launch: Launch,
    pub wire: Rc<Wire>,
    pub incoming: Receiver<Incoming>,
    pub state: RefCell<State>,
    /// The path of a file from the root on.
    pub absolute: Box<dyn Fn(&str) -> String>,
}

/// What changes while the program runs.
#[derive(Default)]
pub struct State {
    pub stack: Stack,
    /// Statements since the start.
    pub count: u64,
    pub course: Option<Course>,
    /// The program runs once more to a point of the past, without messages to the client.
    pub silent: bool,
    /// By the file that the client named; the empty one has those that name blocks.
    pub breakpoints: HashMap<String, Vec<Breakpoint>>,
    pub watched: Vec<Watched>,
    /// Stop when a fault occurs, when the CPU goes to STOP.
    pub on_fault: bool,
    pub on_stop: bool,
    pub groups: Groups,
    /// What the user has changed, in order; those before `redone` are done in this run.
    pub changes: Vec<Change>,
    pub redone: usize,
    pub pause: bool,
    pub outcome: Option<Outcome>,
    /// The text of the last fault.
    pub fault: Option<String>,
    /// The statement at which it was.
    fault_at: Option<u64>,
    /// What a search has found so far.
    found: Option<u64>,
    /// The last statement of the program.
    last_place: Option<u32>,
    /// A statement came in this cycle.
    moved: bool,
    /// The program waits before a statement, whose registers can be changed.
    pub at_statement: bool,
    pub next_id: u64,
    /// Of the client: whether lines and columns count from 1.
    pub lines_from_zero: bool,
    pub columns_from_zero: bool,
}

/// A value that the user has changed, before the statement with this number.
#[derive(Clone, Debug)]
pub struct Change {
    pub count: u64,
    pub found: Found,
    pub text: String,
}

/// Why a run ends early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Quit,
    /// The program starts once more.
    Again {
        course: Option<Course>,
        silent: bool,
    },
}

/// Why the program waits.
#[derive(Clone, Debug, Default)]
pub struct Stop {
    pub reason: &'static str,
    pub description: String,
    pub ids: Vec<u64>,
}

impl State {
    /// Before a run.
    pub fn begin(&mut self, course: Option<Course>, silent: bool) {
        self.stack = Stack::default();
        (self.count, self.redone, self.course, self.silent) = (0, 0, course, silent);
        (self.found, self.fault_at, self.last_place, self.outcome) = (None, None, None, None);
        (self.pause, self.moved, self.at_statement) = (false, true, false);
        self.watched.iter_mut().for_each(Watched::forget);
        self.watched.iter().map(|watched| &watched.when).for_each(|when| when.reset());
        self.breakpoints.values().flatten().for_each(|breakpoint| breakpoint.when.reset());
    }

    fn is_over(&self) -> bool {
        self.outcome.is_some()
    }
}

impl Debugger {
    /// Where names are looked up for the call with this index on the stack.
    pub fn here<'a>(&'a self, cpu: &'a Cpu, stack: &'a Stack, frame: Option<usize>) -> Here<'a> {
        let frame = frame.and_then(|index| stack.frames.get(index));
        Here { program: &self.program, places: &self.places, cpu, frame }
    }

    /// Where names are looked up for the block that runs.
    fn here_at_top<'a>(&'a self, cpu: &'a Cpu, stack: &'a Stack) -> Here<'a> {
        self.here(cpu, stack, stack.frames.len().checked_sub(1))
    }

    /// `FC 3, line 17`.
    pub fn place_text(&self, place: Option<u32>) -> String {
        let Some(place) = place else { return "nothing of the program".to_string() };
        let (Some(at), Some(spot)) = (self.places.place(place), self.places.spot(place)) else { return String::new() };
        let network = if at.network > 0 { format!(", network {}", at.network) } else { String::new() };
        format!("{}{network}, line {}", at.block, spot.line)
    }

    /// A statement is about to run: whether the program waits.
    fn arrive(&self, state: &mut State, cpu: &Cpu, place: u32, local: u32) -> Option<Stop> {
        state.count += 1;
        state.moved = true;
        let changed = self.changed(state, cpu, None);
        let arrival = state.stack.statement(&self.places, place, local, registers::read(cpu));
        state.last_place = Some(place);
        while let Some(change) = state.changes.get(state.redone).filter(|change| change.count == state.count) {
            state.redone += 1;
            // It could be done then, and the program is where it was.
            let (found, text) = (change.found.clone(), change.text.clone());
            let _ = self.put(state, cpu, &found, &text);
        }
        let reached = self.reached(state, cpu, place, arrival);
        let stop = changed.or(reached);
        let step = Step {
            count: state.count,
            cycle: cpu.cycle_number(),
            depth: state.stack.frames.len(),
            new_line: arrival.new_line,
        };
        if let Some(Course::Search { before, wanted }) = state.course {
            let fits = match wanted {
                Wanted::Breakpoint => stop.is_some(),
                Wanted::Line { depth, fine } => step.depth <= depth && (fine || step.new_line),
            };
            if fits && step.count < before {
                state.found = Some(step.count);
            }
            if step.count >= before {
                let course = Some(Course::Statement(state.found.unwrap_or(1)));
                state.outcome = Some(Outcome::Again { course, silent: true });
            }
            return None;
        }
        let ends = state.course.is_some_and(|course| course.ends_at(step));
        if ends {
            let reason = state.course.map_or("step", Course::reason);
            return Some(Stop { reason, ..stop.unwrap_or_default() });
        }
        if state.pause && !state.silent {
            return Some(Stop { reason: "pause", ..Stop::default() });
        }
        stop.filter(|_| !state.silent)
    }

    /// The breakpoints that are met.
    fn reached(&self, state: &State, cpu: &Cpu, place: u32, arrival: Arrival) -> Option<Stop> {
        if !arrival.new_line || state.breakpoints.is_empty() {
            return None;
        }
        let here = self.here_at_top(cpu, &state.stack);
        let block = self.places.place(place).map(|place| place.block);
        let is_here = |breakpoint: &&Breakpoint| match &breakpoint.at {
            At::Places(places) => {
                places.contains(&place) && arrival.before.is_none_or(|before| !places.contains(&before))
            }
            At::Block(key) => arrival.first && block == Some(*key),
        };
        let mut stop: Option<Stop> = None;
        for breakpoint in state.breakpoints.values().flatten().filter(is_here) {
            let description = match breakpoint.when.holds(&|name| here.operand(name)) {
                Ok(false) => continue,
                Ok(true) => String::new(),
                Err(error) => error,
            };
            if let Some(log) = &breakpoint.when.log {
                if !state.silent {
                    self.wire.say("console", &logged(log, &|name| self.shown(&here, name)));
                }
                continue;
            }
            let stop = stop.get_or_insert_with(|| Stop { reason: "breakpoint", ..Stop::default() });
            stop.ids.push(breakpoint.id);
            if !description.is_empty() {
                stop.description = description;
            }
        }
        stop
    }

    /// An expression as text.
    pub fn shown(&self, here: &Here<'_>, text: &str) -> Result<String, String> {
        match here.find(text) {
            Ok(found) => Ok(variables::text(here, &found)),
            Err(error) => {
                // A text that compares or combines values is not a misspelt name.
                let words = || text.split_whitespace().map(str::to_ascii_uppercase);
                let compares = text.contains(['=', '<', '>', '&'])
                    || words().any(|word| matches!(&*word, "AND" | "OR" | "XOR" | "NOT"));
                let condition = crate::condition::Condition::parse(text)
                    .map_err(|wrong| if compares { wrong } else { error.clone() })?;
                if condition.is_name() {
                    return Err(error);
                }
                condition.value(&|name| here.operand(name)).map(plcc_runtime::signal::number_text)
            }
        }
    }

    /// Data breakpoints whose values have changed since the last look. `who`: if it was not the statement before.
    fn changed(&self, state: &mut State, cpu: &Cpu, who: Option<&str>) -> Option<Stop> {
        if state.watched.is_empty() {
            return None;
        }
        let mut watched = std::mem::take(&mut state.watched);
        let mut stop: Option<Stop> = None;
        for one in &mut watched {
            let Some((before, now)) = one.changed(cpu) else { continue };
            let here = self.here_at_top(cpu, &state.stack);
            if let Ok(false) = one.when.holds(&|name| here.operand(name)) {
                continue;
            }
            let by = who.map_or_else(|| self.place_text(state.last_place), str::to_string);
            let name = &one.name;
            let stop = stop.get_or_insert_with(|| Stop { reason: "data breakpoint", ..Stop::default() });
            stop.ids.push(one.id);
            stop.description = format!("{name} was {before} and is {now}, written by {by}");
        }
        state.watched = watched;
        stop
    }

    /// Changes a value. `Err`: the error as a sentence.
    pub fn put(&self, state: &mut State, cpu: &Cpu, found: &Found, text: &str) -> Result<(), String> {
        if let Some(tape) = cpu.tape() {
            tape.set_free();
        }
        match found {
            Found::Register(register) => {
                let frame = state.stack.frames.last_mut().ok_or("no block runs")?;
                register.write(cpu, &mut frame.probed, text)
            }
            Found::Data(data) => {
                let ty = data.value_type().ok_or("only single values can be changed")?;
                plcc_runtime::signal::Value::put(&cpu.memory, data.offset, data.bit, ty, text)?;
                cpu.note_outputs(u32::MAX);
                Ok(())
            }
            Found::Value(source) => {
                let value = source.parse(text, &cpu.image)?;
                source.check_settable()?;
                match (source.address(), source.bits(&value)) {
                    (Some(address), Some(bits)) => cpu.modify(address, bits),
                    _ => source.write(cpu, &value),
                }
            }
            Found::Number(..) => Err("the caller has passed this number; it cannot be changed".to_string()),
            Found::Constant(..) => Err("a constant cannot be changed".to_string()),
            Found::Values(_) => Err("only single values can be changed".to_string()),
        }
    }

    /// The program waits until the client sends it on.
    fn wait(&self, cpu: &Cpu, stop: &Stop, at_statement: bool) {
        {
            let state = &mut *self.state.borrow_mut();
            // What the user did after this point of the past does not happen again.
            state.changes.truncate(state.redone);
            (state.silent, state.pause, state.at_statement) = (false, false, at_statement);
            state.groups.clear();
        }
        self.tell_stop(stop);
        loop {
            let goes_on = match self.incoming.recv() {
                Ok(incoming) => self.take(Some(cpu), incoming),
                Err(_) => self.take(Some(cpu), Incoming::Closed),
            };
            if self.state.borrow().is_over() {
                return cpu.stop_by_request();
            }
            if goes_on {
                let state = &mut *self.state.borrow_mut();
                state.at_statement = false;
                for watched in &mut state.watched {
                    watched.take(cpu);
                }
                return;
            }
        }
    }

    fn tell_stop(&self, stop: &Stop) {
        let mut body = json!({ "reason": stop.reason, "threadId": 1, "allThreadsStopped": true });
        if !stop.ids.is_empty() {
            body["hitBreakpointIds"] = stop.ids.clone().into();
        }
        if !stop.description.is_empty() {
            body["text"] = stop.description.clone().into();
            body["description"] = stop.description.clone().into();
        }
        self.wire.event("stopped", body);
    }

    /// Does what the client says. True: the program runs on.
    pub fn take(&self, cpu: Option<&Cpu>, incoming: Incoming) -> bool {
        match incoming {
            Incoming::Request(request) => self.request(cpu, &request),
            Incoming::Wrong(error) => {
                self.wire.say("important", &error);
                false
            }
            Incoming::Closed => {
                self.state.borrow_mut().outcome = Some(Outcome::Quit);
                true
            }
        }
    }

    /// Looks at the client while the program runs.
    fn poll(&self, cpu: &Cpu) {
        loop {
            match self.incoming.try_recv() {
                Ok(incoming) => {
                    self.take(Some(cpu), incoming);
                }
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => {
                    self.take(Some(cpu), Incoming::Closed);
                    break;
                }
            }
        }
        if self.state.borrow().is_over() {
            cpu.stop_by_request();
        }
    }
}

impl Watcher for Debugger {
    fn enter(&self, _cpu: &Cpu, place: u32, instance: u32) {
        self.state.borrow_mut().stack.enter(place, instance);
    }

    fn leave(&self, cpu: &Cpu, _place: u32) {
        let stop = {
            let state = &mut *self.state.borrow_mut();
            let is_searching = matches!(state.course, Some(Course::Search { .. }));
            match state.is_over() || state.silent && !is_searching {
                true => None,
                false => self.changed(state, cpu, None).filter(|_| !is_searching),
            }
        };
        if let Some(stop) = stop {
            self.wait(cpu, &stop, false);
        }
        self.state.borrow_mut().stack.leave();
    }

    fn value(&self, _cpu: &Cpu, place: u32, value: u64) {
        let Some(plcc_lower::probe::Probe::Formal(index)) = self.places.place(place).map(|place| &place.probe) else {
            return;
        };
        if let Some(frame) = self.state.borrow_mut().stack.frames.last_mut() {
            frame.formals.push((*index, value));
        }
    }

    fn statement(&self, cpu: &Cpu, place: u32, local: u32) {
        let (stop, is_over, looks) = {
            let state = &mut *self.state.borrow_mut();
            if state.is_over() {
                return;
            }
            let stop = self.arrive(state, cpu, place, local);
            (stop, state.is_over(), state.count.is_multiple_of(POLL_STEP))
        };
        match stop {
            _ if is_over => cpu.stop_by_request(),
            Some(stop) => self.wait(cpu, &stop, true),
            None if looks => self.poll(cpu),
            None => {}
        }
    }

    fn phase(&self, cpu: &Cpu, phase: Phase) {
        if self.state.borrow().is_over() {
            return;
        }
        match phase {
            Phase::Before => {
                self.state.borrow_mut().stack.frames.clear();
                self.poll(cpu);
            }
            Phase::Begin => {
                let stop = {
                    let state = &mut *self.state.borrow_mut();
                    let changed = self.changed(state, cpu, Some("inputs, clock or scenario between two cycles"));
                    // A cycle in which nothing of the program runs also ends a step.
                    let is_idle = !std::mem::replace(&mut state.moved, false);
                    let wanted = match state.course {
                        Some(Course::Cycle(cycle)) => is_idle && cpu.cycle_number() > cycle,
                        _ => state.pause && is_idle,
                    };
                    let idle = wanted.then(|| Stop { reason: "pause", ..Stop::default() });
                    changed.or(idle).filter(|_| !state.silent || wanted)
                };
                if let Some(stop) = stop {
                    self.wait(cpu, &stop, false);
                }
            }
            Phase::After | Phase::Over => {}
        }
    }

    fn fault(&self, cpu: &Cpu, entry: &Entry) {
        let is_stop = entry.event >> 8 == 0x45;
        let stop = {
            let state = &mut *self.state.borrow_mut();
            let is_known = is_stop && state.fault_at == Some(state.count);
            let is_asked = if is_stop { state.on_stop } else { state.on_fault };
            if state.is_over() || state.silent || is_known || !is_asked {
                return;
            }
            let place = diagnostics::place_text(&cpu.image, entry);
            let text = format!("{}; {place}", diagnostics::event_text(&cpu.image, entry));
            state.fault_at = Some(state.count);
            state.fault = Some(text.clone());
            Stop { reason: "exception", description: text, ids: Vec::new() }
        };
        self.wait(cpu, &stop, false);
    }
}

/// What a scenario prints goes to the console of the client.
pub struct Printed(pub Rc<Debugger>);

impl Write for Printed {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if !self.0.state.borrow().silent {
            let output = String::from_utf8_lossy(bytes);
            self.0.wire.event("output", json!({ "category": "stdout", "output": output }));
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}
