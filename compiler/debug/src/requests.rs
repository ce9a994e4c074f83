//! What a client asks for while there is a program.

use plcc_runtime::cpu::Cpu;
use serde_json::{Value, json};

use crate::breakpoint::{At, Breakpoint, When};
use crate::course::{Course, Origin, Wanted};
use crate::data::{Looked, Watched};
use crate::debugger::{Change, Debugger, Outcome, State};
use crate::lookup::{Found, Here};
use crate::places::Named;
use crate::stack::Frame;
use crate::variables::{self, Group};
use crate::wire::Request;

/// An answer. `Err`: the error as a sentence.
type Answer = Result<Value, String>;

/// What the debugger can do. It does not offer to restart: `restart` runs the program as it was compiled, while a client that has no such
/// request starts the debugger again, which compiles the sources as they are then.
pub fn capabilities() -> Value {
    json!({
        "supportsConfigurationDoneRequest": true,
        "supportsFunctionBreakpoints": true,
        "supportsConditionalBreakpoints": true,
        "supportsHitConditionalBreakpoints": true,
        "supportsLogPoints": true,
        "supportsDataBreakpoints": true,
        "supportsBreakpointLocationsRequest": true,
        "supportsEvaluateForHovers": true,
        "supportsSetVariable": true,
        "supportsSetExpression": true,
        "supportsStepBack": true,
        "supportsSteppingGranularity": true,
        "supportsTerminateRequest": true,
        "supportsExceptionInfoRequest": true,
        "supportsLoadedSourcesRequest": true,
        "exceptionBreakpointFilters": [
            { "filter": "fault", "label": "Faults", "default": true,
              "description": "Errors of the program, such as those of OB 121 and OB 122, and time errors" },
            { "filter": "stop", "label": "STOP", "default": true, "description": "The CPU goes to STOP because of a fault" },
        ],
    })
}

const NOT_RUNNING: &str = "the program does not run";

impl Debugger {
    /// Answers a request. True: the program runs on.
    pub fn request(&self, cpu: Option<&Cpu>, request: &Request) -> bool {
        let state = &mut *self.state.borrow_mut();
        let stays = |answer: Answer| (answer, false);
        let runs = |answer: Answer| {
            let is_good = answer.is_ok();
            (answer, is_good)
        };
        let (answer, goes_on) = match request.command.as_str() {
            "setBreakpoints" => stays(self.set_breakpoints(state, request)),
            "setFunctionBreakpoints" => stays(Ok(self.set_function_breakpoints(state, request))),
            "setExceptionBreakpoints" => {
                let has = |name: &str| request.list("filters").iter().any(|filter| filter.as_str() == Some(name));
                (state.on_fault, state.on_stop) = (has("fault"), has("stop"));
                stays(Ok(json!({})))
            }
            "dataBreakpointInfo" => stays(with(cpu, |cpu| self.data_breakpoint_info(state, cpu, request))),
            "setDataBreakpoints" => stays(Ok(Self::set_data_breakpoints(state, cpu, request))),
            "breakpointLocations" => stays(self.breakpoint_locations(state, request)),
            "threads" => stays(Ok(json!({ "threads": [{ "id": 1, "name": "CPU" }] }))),
            "stackTrace" => stays(Ok(self.stack_trace(state, request))),
            "scopes" => stays(with(cpu, |cpu| self.scopes(state, cpu, request))),
            "variables" => stays(with(cpu, |cpu| self.variables(state, cpu, request))),
            "setVariable" => stays(with(cpu, |cpu| self.set_variable(state, cpu, request))),
            "setExpression" => stays(with(cpu, |cpu| self.set_expression(state, cpu, request))),
            "evaluate" => stays(with(cpu, |cpu| self.evaluate(state, cpu, request))),
            "exceptionInfo" => stays(match &state.fault {
                Some(text) => Ok(json!({ "exceptionId": "fault", "description": text, "breakMode": "always" })),
                None => Err("no fault has occurred".to_string()),
            }),
            "loadedSources" => {
                let sources: Vec<Value> = (0..self.places.paths.len()).map(|index| self.source(index)).collect();
                stays(Ok(json!({ "sources": sources })))
            }
            "continue" => {
                runs(with(cpu, |cpu| go(state, cpu, Course::Run)).map(|_| json!({ "allThreadsContinued": true })))
            }
            "next" | "stepIn" | "stepOut" => runs(with(cpu, |cpu| {
                let fine = request.text("granularity") == Some("instruction");
                let origin = Origin { depth: state.stack.frames.len(), cycle: cpu.cycle_number() };
                let course = match request.command.as_str() {
                    "next" => Course::Over { origin, fine },
                    "stepIn" => Course::Into { fine },
                    _ => Course::Out { origin },
                };
                go(state, cpu, course)
            })),
            "plcc/cycle" => runs(with(cpu, |cpu| go(state, cpu, Course::Cycle(cpu.cycle_number() + 1)))),
            "plcc/gotoCycle" => match (cpu, request.number("cycle")) {
                (Some(cpu), Some(cycle)) => runs(go_to_cycle(state, cpu, cycle)),
                (None, _) => stays(Err(NOT_RUNNING.to_string())),
                (_, None) => stays(Err("`cycle` is the number of a cycle, 0 for startup".to_string())),
            },
            "stepBack" => runs(with(cpu, |_| {
                let fine = request.text("granularity") == Some("instruction");
                Ok(back(state, Wanted::Line { depth: state.stack.frames.len().max(1), fine }))
            })),
            "reverseContinue" => runs(with(cpu, |_| Ok(back(state, Wanted::Breakpoint)))),
            "pause" => {
                state.pause = true;
                stays(Ok(json!({})))
            }
            "restart" => {
                state.changes.clear();
                let course = self.launch.stop_on_entry.then_some(Course::Entry);
                state.outcome = Some(Outcome::Again { course, silent: false });
                runs(Ok(json!({})))
            }
            "terminate" | "disconnect" => {
                state.outcome = Some(Outcome::Quit);
                runs(Ok(json!({})))
            }
            "configurationDone" => runs(Ok(json!({}))),
            "initialize" | "launch" => stays(Err("the program is loaded already".to_string())),
            other => stays(Err(format!("the debugger does not know the request `{other}`"))),
        };
        self.wire.answer(request, answer);
        goes_on
    }

    /// The file with this number.
    fn source(&self, index: usize) -> Value {
        let path = &self.places.paths[index];
        let name = path.rsplit(['/', '\\']).next().unwrap_or(path);
        json!({ "name": name, "path": path })
    }

    fn set_breakpoints(&self, state: &mut State, request: &Request) -> Answer {
        let path = request.arguments.pointer("/source/path").and_then(Value::as_str);
        let path = path.ok_or("a breakpoint needs the path of its file")?;
        let file = self.places.file(path).or_else(|| self.places.file(&(self.absolute)(path)));
        let mut kept = Vec::new();
        let mut answers = Vec::new();
        let from = u64::from(state.lines_from_zero);
        for given in request.list("breakpoints") {
            state.next_id += 1;
            let id = state.next_id;
            let line = given.get("line").and_then(Value::as_u64).map(|line| line + from);
            let place = || -> Result<(u32, Vec<u32>), String> {
                let file = file.ok_or("the file is not part of the program")?;
                let line = line.and_then(|line| u32::try_from(line).ok()).ok_or("a breakpoint needs its line")?;
                self.places
                    .at_line(file, line, &self.program, &self.sources)
                    .ok_or_else(|| "no statement is here or further down".to_string())
            };
            match place().and_then(|place| Ok((place, When::read(given)?))) {
                Ok(((line, places), when)) => {
                    answers.push(json!({ "id": id, "verified": true, "line": u64::from(line) - from }));
                    kept.push(Breakpoint { id, at: At::Places(places), when });
                }
                Err(error) => answers.push(json!({ "id": id, "verified": false, "message": error })),
            }
        }
        state.breakpoints.insert(path.to_string(), kept);
        Ok(json!({ "breakpoints": answers }))
    }

    fn set_function_breakpoints(&self, state: &mut State, request: &Request) -> Value {
        let mut kept = Vec::new();
        let mut answers = Vec::new();
        for given in request.list("breakpoints") {
            state.next_id += 1;
            let id = state.next_id;
            let name = given.get("name").and_then(Value::as_str).unwrap_or("");
            let named = self.places.named(name, &self.program, &self.sources);
            match named.and_then(|named| Ok((named, When::read(given)?))) {
                Ok((named, when)) => {
                    let at = match named {
                        Named::Block(key) => At::Block(key),
                        Named::Places(places) => At::Places(places),
                    };
                    answers.push(json!({ "id": id, "verified": true }));
                    kept.push(Breakpoint { id, at, when });
                }
                Err(error) => answers.push(json!({ "id": id, "verified": false, "message": error })),
            }
        }
        state.breakpoints.insert(String::new(), kept);
        json!({ "breakpoints": answers })
    }

    fn breakpoint_locations(&self, state: &State, request: &Request) -> Answer {
        let path = request.arguments.pointer("/source/path").and_then(Value::as_str).unwrap_or("");
        let Some(file) = self.places.file(path).or_else(|| self.places.file(&(self.absolute)(path))) else {
            return Ok(json!({ "breakpoints": [] }));
        };
        let from = u64::from(state.lines_from_zero);
        let line = |name: &str| request.number(name).map(|line| u32::try_from(line + from).unwrap_or(u32::MAX));
        let first = line("line").ok_or("`line` is the number of a line")?;
        let lines = self.places.lines_between(file, first, line("endLine").unwrap_or(first));
        let lines: Vec<Value> = lines.into_iter().map(|line| json!({ "line": u64::from(line) - from })).collect();
        Ok(json!({ "breakpoints": lines }))
    }

    fn data_breakpoint_info(&self, state: &State, cpu: &Cpu, request: &Request) -> Answer {
        let name = request.text("name").ok_or("`name` is the name of a value")?;
        let found = match request.number("variablesReference").filter(|number| *number != 0) {
            Some(number) => self.member(state, cpu, number, name),
            None => frame_of(state, request).and_then(|frame| self.here(cpu, &state.stack, frame).find(name)),
        };
        let top = self.here(cpu, &state.stack, None);
        let has_several = matches!(found, Ok(Found::Values(_)));
        let answer = match found.map(|found| top.looked(&found)) {
            Ok(Some(looked)) => json!({
                "dataId": format!("{}={name}", looked.text()),
                "description": name,
                "accessTypes": ["write"],
                "canPersist": looked.is_fixed(),
            }),
            Ok(None) if has_several => {
                let description = format!("{name} has several values; break on the change of one of them");
                json!({ "dataId": null, "description": description })
            }
            Ok(None) => {
                json!({ "dataId": null, "description": format!("{name} is not a value that lasts from call to call") })
            }
            Err(error) => json!({ "dataId": null, "description": error }),
        };
        Ok(answer)
    }

    fn set_data_breakpoints(state: &mut State, cpu: Option<&Cpu>, request: &Request) -> Value {
        state.watched.clear();
        let mut answers = Vec::new();
        for given in request.list("breakpoints") {
            state.next_id += 1;
            let id = state.next_id;
            let known = given.get("dataId").and_then(Value::as_str).and_then(|text| text.split_once('='));
            let looked = known.and_then(|(looked, name)| Some((Looked::parse(looked)?, name)));
            match looked
                .ok_or_else(|| "this is not a value of the program".to_string())
                .and_then(|looked| Ok((looked, When::read(given)?)))
            {
                Ok(((looked, name), when)) => {
                    let mut watched = Watched::new(id, name.to_string(), looked, when);
                    if let Some(cpu) = cpu {
                        watched.take(cpu);
                    }
                    state.watched.push(watched);
                    answers.push(json!({ "id": id, "verified": true }));
                }
                Err(error) => answers.push(json!({ "id": id, "verified": false, "message": error })),
            }
        }
        json!({ "breakpoints": answers })
    }

    fn stack_trace(&self, state: &State, request: &Request) -> Value {
        let frames = state.stack.frames.iter().enumerate().rev();
        let start = request.number("startFrame").unwrap_or(0) as usize;
        let levels = request.number("levels").filter(|levels| *levels > 0).map_or(usize::MAX, |levels| levels as usize);
        let shown: Vec<Value> =
            frames.skip(start).take(levels).map(|(index, frame)| self.frame(state, index, frame)).collect();
        json!({ "stackFrames": shown, "totalFrames": state.stack.frames.len() })
    }

    fn frame(&self, state: &State, index: usize, frame: &Frame) -> Value {
        let place = self.places.place(frame.place.unwrap_or(frame.block));
        let block = place.map(|place| place.block);
        let mut name = block.map_or_else(String::new, |block| block.to_string());
        if let Some(block) = block.and_then(|block| self.program.block(block)).filter(|block| !block.name.is_empty()) {
            name = format!("{name} \"{}\"", block.name);
        }
        if let Some(network) = place.map(|place| place.network).filter(|network| *network > 0) {
            name = format!("{name}, network {network}");
        }
        let is_library = block.and_then(|block| self.program.block(block)).is_none_or(|block| block.library);
        let spot = self.places.spot(frame.place.unwrap_or(frame.block)).filter(|_| !is_library);
        let mut shown = json!({ "id": index + 1, "name": name, "line": 0, "column": 0 });
        match spot {
            Some(spot) => {
                shown["source"] = self.source(spot.file.0 as usize);
                shown["line"] = (u64::from(spot.line) - u64::from(state.lines_from_zero)).into();
                shown["column"] = (u64::from(spot.column) - u64::from(state.columns_from_zero)).into();
            }
            None => shown["presentationHint"] = "subtle".into(),
        }
        shown
    }

    fn scopes(&self, state: &mut State, cpu: &Cpu, request: &Request) -> Answer {
        let frame = frame_of(state, request)?;
        let here = self.here(cpu, &state.stack, frame);
        let mut scopes: Vec<(&str, Group)> = Vec::new();
        if let Some(index) = frame {
            if here.kept() != plcc_lower::probe::Kept::Nothing {
                scopes.push(("Registers", Group::Registers(index)));
            }
            if !here.formals().is_empty() {
                scopes.push(("Parameters", Group::Formals(index)));
            }
            if !here.instance().is_empty() {
                scopes.push(("Instance", Group::Instance(index)));
            }
            if !here.temporaries().is_empty() {
                scopes.push(("Local data", Group::Temporaries(index)));
            }
        }
        let memory = if self.program.s7200.is_some() { "V memory" } else { "Data blocks" };
        scopes.extend([("Inputs", Group::Inputs), ("Outputs", Group::Outputs), ("Bit memory", Group::BitMemory)]);
        scopes.extend([(memory, Group::Dbs), ("CPU", Group::Cpu)]);
        let shown: Vec<Value> = scopes
            .into_iter()
            .map(|(name, group)| json!({ "name": name, "variablesReference": state.groups.add(group), "expensive": false }))
            .collect();
        Ok(json!({ "scopes": shown }))
    }

    fn variables(&self, state: &mut State, cpu: &Cpu, request: &Request) -> Answer {
        let number = request.number("variablesReference").unwrap_or(0);
        let group = state.groups.get(number).cloned().ok_or("the program has run on since this was shown")?;
        let start = request.number("start").unwrap_or(0) as usize;
        let count = request.number("count").filter(|count| *count > 0).map_or(usize::MAX, |count| count as usize);
        let here = self.here(cpu, &state.stack, group.frame());
        let rows = group.rows(&here, start, count);
        let shown: Vec<Value> = rows.into_iter().map(|row| state.groups.shown(&here, row)).collect();
        Ok(json!({ "variables": shown }))
    }

    /// A member of a group by its name. `Err`: the error.
    fn member(&self, state: &State, cpu: &Cpu, number: u64, name: &str) -> Result<Found, String> {
        let group = state.groups.get(number).ok_or("the program has run on since this was shown")?;
        let here = self.here(cpu, &state.stack, group.frame());
        let row = group.rows(&here, 0, usize::MAX).into_iter().find(|row| row.name == name);
        match row.map(|row| row.found) {
            Some(Some(found)) => Ok(found),
            Some(None) => Err(format!("{name} cannot be changed")),
            None => here.find(name),
        }
    }

    fn set_variable(&self, state: &mut State, cpu: &Cpu, request: &Request) -> Answer {
        let name = request.text("name").ok_or("`name` is the name of a value")?;
        let number = request.number("variablesReference").unwrap_or(0);
        let frame = state.groups.get(number).and_then(Group::frame);
        let found = self.member(state, cpu, number, name)?;
        self.change(state, cpu, frame, &found, request.text("value").unwrap_or(""))
    }

    fn set_expression(&self, state: &mut State, cpu: &Cpu, request: &Request) -> Answer {
        let frame = frame_of(state, request)?;
        let text = request.text("expression").ok_or("`expression` is the name of a value")?;
        let found = self.here(cpu, &state.stack, frame).find(text)?;
        self.change(state, cpu, frame, &found, request.text("value").unwrap_or(""))
    }

    /// Changes a value, and keeps the change for when the program runs once more.
    fn change(&self, state: &mut State, cpu: &Cpu, frame: Option<usize>, found: &Found, text: &str) -> Answer {
        if let Found::Register(_) = found {
            if !state.at_statement {
                return Err("registers can be changed only before a statement".to_string());
            }
            if frame.is_some_and(|frame| frame + 1 != state.stack.frames.len()) {
                return Err("registers can be changed only in the block that runs".to_string());
            }
        }
        self.put(state, cpu, found, text)?;
        let change = Change { count: state.count, found: found.clone(), text: text.to_string() };
        state.changes.push(change);
        state.redone = state.changes.len();
        let here = self.here(cpu, &state.stack, frame);
        Ok(json!({ "value": variables::text(&here, found), "type": variables::type_of(found) }))
    }

    fn evaluate(&self, state: &mut State, cpu: &Cpu, request: &Request) -> Answer {
        let frame = frame_of(state, request)?;
        let text = request.text("expression").ok_or("`expression` is the name of a value")?.trim();
        if let Some((name, value)) = assignment(text) {
            let found = self.here(cpu, &state.stack, frame).find(name)?;
            let changed = self.change(state, cpu, frame, &found, value)?;
            return Ok(json!({ "result": changed["value"], "type": changed["type"], "variablesReference": 0 }));
        }
        let here: Here<'_> = self.here(cpu, &state.stack, frame);
        match here.find(text) {
            Ok(found) => {
                let row = variables::row(text.to_string(), text.to_string(), found);
                let shown = state.groups.shown(&here, row);
                Ok(json!({
                    "result": shown["value"],
                    "type": shown["type"],
                    "variablesReference": shown["variablesReference"],
                }))
            }
            Err(_) => self.shown(&here, text).map(|text| json!({ "result": text, "variablesReference": 0 })),
        }
    }
}

/// `name := value`.
fn assignment(text: &str) -> Option<(&str, &str)> {
    let mut quoted = false;
    let at = text.char_indices().position(|(at, c)| {
        quoted ^= c == '"';
        !quoted && text[at..].starts_with(":=")
    })?;
    let at = text.char_indices().nth(at)?.0;
    Some((text[..at].trim(), text[at + 2..].trim()))
}

/// With the CPU, if there is one.
fn with(cpu: Option<&Cpu>, answer: impl FnOnce(&Cpu) -> Answer) -> Answer {
    cpu.map_or_else(|| Err(NOT_RUNNING.to_string()), answer)
}

/// The call that a request names by `frameId`; without one the block that runs. `Err`: the error.
fn frame_of(state: &State, request: &Request) -> Result<Option<usize>, String> {
    let frames = state.stack.frames.len();
    match request.number("frameId") {
        None => Ok(frames.checked_sub(1)),
        Some(id) => match usize::try_from(id).ok().and_then(|id| id.checked_sub(1)).filter(|index| *index < frames) {
            Some(index) => Ok(Some(index)),
            None => Err("the program has run on: this call is over".to_string()),
        },
    }
}

/// Sends the program on.
fn go(state: &mut State, _cpu: &Cpu, course: Course) -> Answer {
    state.course = Some(course);
    Ok(json!({}))
}

/// Sends the program to the first statement of a cycle, later or earlier.
fn go_to_cycle(state: &mut State, cpu: &Cpu, cycle: u64) -> Answer {
    let course = Some(Course::Cycle(cycle));
    if cycle > cpu.cycle_number() {
        (state.course, state.silent) = (course, true);
    } else {
        state.outcome = Some(Outcome::Again { course, silent: true });
    }
    Ok(json!({}))
}

/// Sends the program back to what is wanted before the statement where it is.
fn back(state: &mut State, wanted: Wanted) -> Value {
    let course = Some(Course::Search { before: state.count.max(1), wanted });
    state.outcome = Some(Outcome::Again { course, silent: true });
    json!({})
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_restart_compiles_changed_sources() {
        assert_eq!(capabilities().get("supportsRestartRequest"), None);
    }
}
