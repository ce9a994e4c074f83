//! The server before, between and after runs of the program.

use std::cell::RefCell;
use std::io::{Read, Write};
use std::rc::Rc;
use std::sync::Arc;
use std::sync::mpsc::Receiver;

use plcc_abi::ProgramImage;
use plcc_runtime::probe::Watcher;
use plcc_runtime::run::{self, Ended};
use plcc_runtime::tape::Recording;
use serde_json::json;

use crate::course::Course;
use crate::debugger::{Debugger, Outcome, Printed, State};
use crate::launch::Launch;
use crate::places::Places;
use crate::requests::capabilities;
use crate::wire::{Incoming, Request, Wire, listen};
use crate::{Host, Target};

/// Serves a client until it goes. `Err`: there is no thread for it.
pub fn serve(
    input: impl Read + Send + 'static,
    output: impl Write + 'static,
    host: Rc<dyn Host>,
) -> Result<(), String> {
    let incoming = listen(input)?;
    let wire = Rc::new(Wire::new(Box::new(output)));
    let mut state = State::default();
    (state.on_fault, state.on_stop) = (true, true);
    loop {
        match incoming.recv() {
            Ok(Incoming::Request(request)) => match request.command.as_str() {
                "initialize" => {
                    let is_zero = |name: &str| request.arguments.get(name) == Some(&json!(false));
                    (state.lines_from_zero, state.columns_from_zero) =
                        (is_zero("linesStartAt1"), is_zero("columnsStartAt1"));
                    wire.answer(&request, Ok(capabilities()));
                }
                "launch" => match loaded(&request, &host) {
                    Ok((launch, target, image)) => {
                        wire.answer(&request, Ok(json!({})));
                        return work(debugger(launch, target, image, wire, incoming, state, host));
                    }
                    Err(error) => wire.answer(&request, Err(error)),
                },
                "disconnect" | "terminate" => {
                    wire.answer(&request, Ok(json!({})));
                    return Ok(());
                }
                "attach" => {
                    wire.answer(&request, Err("the debugger starts the program itself: use `launch`".to_string()))
                }
                other => wire.answer(&request, Err(format!("`{other}` comes after `launch`"))),
            },
            Ok(Incoming::Wrong(error)) => wire.say("important", &error),
            Ok(Incoming::Closed) | Err(_) => return Ok(()),
        }
    }
}

/// The program with what the launch asks for. `Err`: the error.
fn loaded(request: &Request, host: &Rc<dyn Host>) -> Result<(Launch, Target, Arc<ProgramImage>), String> {
    let mut launch = Launch::read(&request.arguments)?;
    let target = host.compile(launch.program.as_deref())?;
    let replay = launch.replay.clone().or_else(|| host.replay());
    launch.recording = replay.map(|path| Recording::read(&path)).transpose()?.map(Rc::new);
    let (image, options) = run::for_debugger(target.image.clone(), &launch.options, launch.recording.as_ref())?;
    launch.options = options;
    Ok((launch, target, image))
}

fn debugger(
    launch: Launch,
    target: Target,
    image: Arc<ProgramImage>,
    wire: Rc<Wire>,
    incoming: Receiver<Incoming>,
    state: State,
    host: Rc<dyn Host>,
) -> Rc<Debugger> {
    let Target { program, sources, places, code, .. } = target;
    let places = Places::new(places, &sources, &|path| host.absolute(path));
    let absolute = Box::new(move |path: &str| host.absolute(path));
    Rc::new(Debugger {
        program,
        sources,
        places,
        image,
        code,
        launch,
        wire,
        incoming,
        state: RefCell::new(state),
        absolute,
    })
}

/// From the launch to the end.
fn work(debugger: Rc<Debugger>) -> Result<(), String> {
    debugger.wire.event("initialized", json!({}));
    if !between(&debugger) {
        return Ok(());
    }
    let first = debugger.launch.stop_on_entry.then_some(Course::Entry);
    let (mut course, mut silent) = (first, false);
    loop {
        debugger.state.borrow_mut().begin(course, silent);
        let watcher: Rc<dyn Watcher> = Rc::<Debugger>::clone(&debugger);
        let out = Box::new(Printed(Rc::clone(&debugger)));
        let (image, code) = (&debugger.image, Rc::clone(&debugger.code));
        let launch = &debugger.launch;
        let ended = run::run_debugged(image, code, &launch.options, &watcher, out, launch.recording.as_ref());
        let outcome = debugger.state.borrow_mut().outcome.take();
        match outcome {
            Some(Outcome::Again { course: next, silent: is_silent }) => (course, silent) = (next, is_silent),
            Some(Outcome::Quit) => {
                debugger.wire.event("terminated", json!({}));
                return Ok(());
            }
            None => {
                tell_end(&debugger, ended);
                if !between(&debugger) {
                    return Ok(());
                }
                (course, silent) = match debugger.state.borrow_mut().outcome.take() {
                    Some(Outcome::Again { course, silent }) => (course, silent),
                    Some(Outcome::Quit) | None => (first, false),
                };
            }
        }
    }
}

/// Answers requests while no program runs. False: the client is gone.
fn between(debugger: &Debugger) -> bool {
    loop {
        let incoming = debugger.incoming.recv().unwrap_or(Incoming::Closed);
        let goes_on = debugger.take(None, incoming);
        if debugger.state.borrow().outcome == Some(Outcome::Quit) {
            return false;
        }
        if goes_on {
            return true;
        }
    }
}

fn tell_end(debugger: &Debugger, ended: Result<Ended, String>) {
    debugger.state.borrow_mut().stack.frames.clear();
    let code = match ended {
        Ok(ended) => {
            ended.lines.iter().for_each(|line| debugger.wire.say("console", line));
            i32::from(ended.fault)
        }
        Err(error) => {
            debugger.wire.say("important", &error);
            2
        }
    };
    debugger.wire.event("exited", json!({ "exitCode": code }));
    debugger.wire.event("terminated", json!({}));
}
