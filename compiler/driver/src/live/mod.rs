//! `plcc run --watch`: the running program is changed whenever a source is saved. `plcc run --allow-load`: only by `plcc load`.
//!
//! The program runs on the thread of the command. Another one waits for files and for lines of standard input, compiles, compares, and has the CPU
//! exchange the program at its next cycle control point.

#[cfg(test)]
mod tests;

use std::io::BufRead;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};

use plcc_runtime::change::{self, Loader, Prepared};
use plcc_runtime::run::EXIT_USAGE;

use crate::cli::{Lose, RunArgs};
use crate::command::run::compile;
use crate::testing::watch;
use crate::{inputs, on_large_stack, report};

/// What the watching thread waits for.
enum Event {
    /// A file was saved.
    Saved,
    /// A line of standard input.
    Line(String),
    /// There will be no more lines.
    NoLines,
}

/// Runs the program and watches its sources; the exit code is that of the program.
pub fn run(args: &RunArgs) -> u8 {
    if let Some(flag) = unfit(args) {
        report::say(&format!("{flag} belongs to one program: leave out {flag}, or --watch and --allow-load"));
        return EXIT_USAGE;
    }
    let paths = match inputs::or_here(&args.inputs) {
        Ok(paths) => paths,
        Err(exit) => return exit,
    };
    // What is saved while the program is compiled counts.
    let seen = watch::look(&paths);
    let (image, code) = match compile(args) {
        Ok(compiled) => compiled,
        Err(exit) => return exit,
    };
    let (loader, inbox) = change::loader(&args.run);
    let (service, opened) = match args.services.open(&image, false, Some(loader.clone())) {
        Ok(opened) => opened,
        Err(message) => {
            report::tell(&format!("runtime: {message}"));
            return EXIT_USAGE;
        }
    };
    opened.iter().for_each(|line| report::say(line));
    if args.watch {
        let (send, events) = channel();
        watch_files(paths, seen, send.clone());
        read_lines(send);
        let own = args.clone();
        // It ends with the process.
        std::thread::spawn(move || Watch { args: own, loader, pending: None, can_ask: true }.work(&events));
    }
    plcc_runtime::run::start_changeable(image, code, &args.run, service, inbox)
}

/// A flag that does not go together with changes.
fn unfit(args: &RunArgs) -> Option<&'static str> {
    let run = &args.run;
    let flags =
        [("--scenario", run.scenario.is_some()), ("--trace", run.trace.is_some()), ("--instances", run.is_many())];
    flags.into_iter().find(|(_, given)| *given).map(|(flag, _)| flag)
}

fn watch_files(paths: Vec<PathBuf>, mut seen: watch::Seen, send: Sender<Event>) {
    std::thread::spawn(move || {
        loop {
            watch::wait(&paths, seen);
            seen = watch::look(&paths);
            if send.send(Event::Saved).is_err() {
                return;
            }
        }
    });
}

fn read_lines(send: Sender<Event>) {
    std::thread::spawn(move || {
        for line in std::io::stdin().lock().lines().map_while(Result::ok) {
            if send.send(Event::Line(line)).is_err() {
                return;
            }
        }
        let _ = send.send(Event::NoLines);
    });
}

/// The thread that changes the program.
struct Watch {
    args: RunArgs,
    loader: Loader,
    /// A change that waits for an answer.
    pending: Option<Prepared>,
    can_ask: bool,
}

impl Watch {
    fn work(mut self, events: &Receiver<Event>) {
        report::say("a saved source changes the program; r and Enter restores the previous program");
        for event in events {
            match event {
                Event::Saved => self.saved(),
                Event::Line(line) => self.line(line.trim()),
                Event::NoLines => {
                    self.can_ask = false;
                    if self.pending.take().is_some() {
                        report::say("not changed: no answer on standard input; add --lose allow");
                    }
                }
            }
        }
    }

    fn saved(&mut self) {
        // What waits for an answer is out of date.
        self.pending = None;
        let args = self.args.clone();
        match on_large_stack(move || compile(&args)) {
            Ok(Ok((image, code))) => {
                let prepared = self.loader.prepare(image, code);
                self.decide(prepared);
            }
            Ok(Err(_)) => report::say("not changed: the program that runs goes on"),
            Err(fault) => report::say(&format!("not changed: internal fault, please report it: {fault}")),
        }
    }

    fn line(&mut self, line: &str) {
        match (line, self.pending.take()) {
            ("y", Some(prepared)) => self.change(prepared),
            ("n", Some(_)) => report::say("not changed"),
            ("r", _) => {
                let prepared = self.loader.previous();
                self.decide(prepared);
            }
            ("", pending) => self.pending = pending,
            (_, pending) => {
                let words =
                    if pending.is_some() { "y, n or r" } else { "r to restore the program from before a change" };
                report::say(&format!("`{line}` means nothing here: write {words}"));
                self.pending = pending;
            }
        }
    }

    /// Lists what a change does, and makes it unless values would be lost.
    fn decide(&mut self, prepared: Result<Prepared, String>) {
        let prepared = match prepared {
            Ok(prepared) => prepared,
            Err(why) => return report::say(&format!("not changed: {why}")),
        };
        prepared.items().iter().for_each(|item| report::say(&format!("  {}", item.text)));
        match (prepared.loses(), self.args.lose) {
            (false, _) | (true, Lose::Allow) => self.change(prepared),
            (true, Lose::Refuse) => report::say("not changed: values would be lost, and --lose is refuse"),
            (true, Lose::Ask) if !self.can_ask => {
                report::say("not changed: values would be lost, and standard input has no answer; add --lose allow");
            }
            (true, Lose::Ask) => {
                report::say(
                    "values of the running program would be lost: type y and Enter to change it anyway, n to keep it",
                );
                self.pending = Some(prepared);
            }
        }
    }

    fn change(&self, prepared: Prepared) {
        match self.loader.apply(prepared) {
            Ok(lines) => {
                lines.iter().for_each(|line| report::say(&format!("  {line}")));
                report::say("changed");
            }
            Err(why) => report::say(&format!("not changed: {why}")),
        }
    }
}
