//! `plcc load`: compiles a program for a process that runs another one, and has it change over.

use std::io::BufRead;

use plcc_services::client::{self, Answer, Process};

use crate::cli::{LoadArgs, Lose};
use crate::command::build::{accepted, internal};
use crate::command::exit;
use crate::{drawings, inputs, link, pipeline, report};

/// Variable with the password of the user.
const PASSWORD: &str = "PLCC_PASSWORD";

/// Compiles and sends; the exit code.
pub fn load(args: &LoadArgs) -> u8 {
    let program = match args.restore {
        true => Vec::new(),
        false => match compile(args) {
            Ok(program) => program,
            Err(exit) => return exit,
        },
    };
    match send(args, &program) {
        Ok(exit) => exit,
        Err(message) => {
            report::say(&format!("{}: {message}", args.to));
            exit::USAGE
        }
    }
}

fn compile(args: &LoadArgs) -> Result<Vec<u8>, u8> {
    let read = inputs::read_as(&inputs::or_here(&args.inputs)?, args.compile.code_page);
    let unreadable = read.is_unreadable();
    let settings = pipeline::Settings { require_main: true, ..pipeline::Settings::new(&args.compile) };
    // The page shows the new program from then on.
    let bound = drawings::bind(pipeline::parse(read, &settings), &settings, |_| true);
    let bound = accepted(bound, unreadable, &settings)?;
    let mut plain = pipeline::lower_begun(&bound, args.optimization.optimization());
    let probed = pipeline::lower_beside(&bound, &mut plain);
    let objects = pipeline::objects(plain, probed, [None, None]).map_err(|error| internal(&error))?;
    link::loadable(&objects).map_err(|error| internal(&error))
}

/// `Err`: why the process does not answer, or does not know the user.
fn send(args: &LoadArgs, program: &[u8]) -> Result<u8, String> {
    let process = Process::new(args.to, args.tls.as_deref())?;
    let session = match &args.user {
        Some(user) => Some(process.sign_in(user, &password()?)?),
        None => None,
    };
    let path = if args.restore { "/restore" } else { "/load" };
    let post = |lose: bool| {
        let query = if lose { "?lose" } else { "" };
        process.post(&format!("{path}{query}"), session.as_deref(), program)
    };
    let mut answer = post(args.lose == Lose::Allow)?;
    if answer.status == client::CONFLICT {
        tell(&answer);
        let is_allowed = match args.lose {
            Lose::Allow => true,
            Lose::Refuse => false,
            Lose::Ask => is_answered(),
        };
        if !is_allowed {
            report::say("not changed: values of the running program would be lost");
            return Ok(exit::FAILED);
        }
        answer = post(true)?;
    } else if answer.is_ok() {
        tell(&answer);
    }
    match answer.is_ok() {
        true => report::say("changed"),
        false => report::say(&format!("not changed: {}", answer.why())),
    }
    Ok(if answer.is_ok() { exit::OK } else { exit::FAILED })
}

/// What is new and what goes, a line each.
fn tell(answer: &Answer) {
    answer.text.lines().for_each(|line| report::say(&format!("  {line}")));
}

fn is_answered() -> bool {
    report::say(
        "values of the running program would be lost: type y and Enter to change it anyway, anything else to keep it",
    );
    line().is_ok_and(|line| line.trim() == "y")
}

/// The password of a user.
pub fn password() -> Result<String, String> {
    std::env::var(PASSWORD).or_else(|_| line())
}

/// A line of standard input.
fn line() -> Result<String, String> {
    let mut line = String::new();
    std::io::stdin().lock().read_line(&mut line).map_err(|error| error.to_string())?;
    Ok(line.trim_end_matches(['\r', '\n']).to_string())
}
