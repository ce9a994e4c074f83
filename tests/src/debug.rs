//! Sessions with the debugger that are files.
//!
//! ```text
//! plcc debug tests/debug/calls.stl {"stopOnEntry": true}
//! > break {"line": 12}            breakpoints of the program's first file
//! > start                         ends the configuration; waits for a stop, as continue, next, stepIn ... do
//! > where                         the call stack
//! > show Registers RLO ACCU1      values of a scope; without names all of it
//! > evaluate {"expression": "MW10"}
//! ```
//!
//! Anything else is a request with its arguments. What comes back stands below it.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::rc::Rc;

use plcc_debug::Host;
use plcc_driver::cli::{Cli, Command};
use plcc_driver::command::debug::Files;
use serde_json::{Value, json};

use crate::root;

/// Requests after which the program runs.
const RUNS: [&str; 10] = [
    "start",
    "continue",
    "next",
    "stepIn",
    "stepOut",
    "stepBack",
    "reverseContinue",
    "plcc/cycle",
    "plcc/gotoCycle",
    "restart",
];

/// The session of a file, with what comes back now. `Err`: the file is not a session.
pub fn transcript(path: &Path) -> Result<String, String> {
    let text = std::fs::read_to_string(path).map_err(|error| error.to_string())?;
    let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with("  ")).collect();
    let (first, requests) = lines.split_first().ok_or("the file is empty")?;
    let (command, launch) = first.split_once('{').map_or((*first, String::new()), |(c, l)| (c, format!("{{{l}")));
    let launch = if launch.is_empty() { json!({}) } else { arguments(&launch)? };
    let words = command.split_whitespace().map(|word| match word.contains('/') {
        true => root().join(word).into_os_string(),
        false => word.into(),
    });
    let words: Vec<std::ffi::OsString> = words.collect();
    let source = words.last().cloned().unwrap_or_default();
    let cli = <Cli as clap::Parser>::try_parse_from(words).map_err(|error| error.to_string())?;
    let Command::Debug(args) = cli.command else { return Err("it is not `plcc debug`".into()) };
    let (server_in, client_out) = std::io::pipe().map_err(|error| error.to_string())?;
    let (client_in, server_out) = std::io::pipe().map_err(|error| error.to_string())?;
    let serve = move || {
        let host: Rc<dyn Host> = Rc::new(Files(*args));
        plcc_debug::serve(server_in, server_out, host)
    };
    let server = std::thread::Builder::new()
        .stack_size(plcc_driver::COMPILE_STACK_BYTES)
        .spawn(serve)
        .map_err(|error| error.to_string())?;
    let mut client = Client {
        input: BufReader::new(client_in),
        output: client_out,
        seq: 0,
        source: source.to_string_lossy().into_owned(),
        text: format!("{first}\n"),
    };
    client.request("initialize", &json!({ "adapterID": "plcc" }))?;
    client.request("launch", &launch)?;
    for line in requests {
        client.text.push_str(line);
        client.text.push('\n');
        if let Some(request) = line.strip_prefix('>') {
            client.act(request.trim())?;
        }
    }
    client.request("disconnect", &json!({}))?;
    let text = client.text.clone();
    drop(client);
    server.join().map_err(|_| "the debugger panicked".to_string())??;
    let text = text.split_once("> disconnect").map_or(text.clone(), |(text, _)| text.to_string());
    Ok(text)
}

fn arguments(text: &str) -> Result<Value, String> {
    serde_json::from_str(text).map_err(|error| format!("{text}: {error}"))
}

struct Client {
    input: BufReader<std::io::PipeReader>,
    output: std::io::PipeWriter,
    seq: i64,
    /// The first file of the program.
    source: String,
    text: String,
}

impl Client {
    fn line(&mut self, text: &str) {
        let root = format!("{}/", root().display());
        for line in text.lines() {
            self.text.push_str(&format!("  {}\n", line.replace(&root, "")));
        }
    }

    /// Does a line of a session.
    fn act(&mut self, line: &str) -> Result<(), String> {
        let (name, rest) = line.split_once(' ').unwrap_or((line, ""));
        let rest = rest.trim();
        match name {
            "break" => {
                let list = arguments(&format!("[{rest}]"))?;
                let arguments = json!({ "source": { "path": self.source }, "breakpoints": list });
                let body = self.request("setBreakpoints", &arguments)?;
                self.tell_breakpoints(&body);
            }
            "where" => self.stack()?,
            "show" => self.show(rest)?,
            _ => {
                let mut arguments = if rest.is_empty() { json!({}) } else { arguments(rest)? };
                if let Some(Value::String(path)) = arguments.pointer_mut("/source/path") {
                    *path = root().join(&*path).display().to_string();
                }
                let command = if name == "start" { "configurationDone" } else { name };
                let body = self.request(command, &arguments)?;
                if let Some(breakpoints) = body.as_ref().filter(|body| body.get("breakpoints").is_some()) {
                    let body = Some(breakpoints.clone());
                    self.tell_breakpoints(&body);
                } else if RUNS.contains(&name) && body.is_some() {
                    self.wait()?;
                } else if let Some(body) = body.filter(|body| body != &json!({})) {
                    let shown = match (body.get("result").or(body.get("value")), body.get("type")) {
                        (Some(value), Some(ty)) => format!("{} ({})", plain(value), plain(ty)),
                        (Some(value), None) => plain(value),
                        (None, _) => body.to_string(),
                    };
                    self.line(&shown);
                }
            }
        }
        Ok(())
    }

    fn tell_breakpoints(&mut self, body: &Option<Value>) {
        let list = body.as_ref().and_then(|body| body["breakpoints"].as_array()).cloned().unwrap_or_default();
        for breakpoint in list {
            let line = breakpoint.get("line").map_or(String::new(), |line| format!(" line {line}"));
            let message = breakpoint.get("message").map_or(String::new(), |message| format!(": {}", plain(message)));
            let verified = if breakpoint["verified"] == json!(true) { "set" } else { "not set" };
            self.line(&format!("breakpoint {}{line} {verified}{message}", breakpoint["id"]));
        }
    }

    /// Where the program is.
    fn stack(&mut self) -> Result<(), String> {
        let body = self.request("stackTrace", &json!({ "threadId": 1 }))?.unwrap_or_default();
        for frame in body["stackFrames"].as_array().cloned().unwrap_or_default() {
            let file = plain(&frame["source"]["name"]);
            self.line(&format!("{}, {file}:{}", plain(&frame["name"]), frame["line"]));
        }
        Ok(())
    }

    fn show(&mut self, rest: &str) -> Result<(), String> {
        let mut words = rest.split_whitespace();
        let scope = words.next().ok_or("show: name a scope")?.replace('_', " ");
        let names: Vec<&str> = words.collect();
        let body = self.request("scopes", &json!({}))?.unwrap_or_default();
        let scopes = body["scopes"].as_array().cloned().unwrap_or_default();
        let Some(found) = scopes.iter().find(|own| own["name"] == json!(scope)) else {
            let all: Vec<String> = scopes.iter().map(|scope| plain(&scope["name"])).collect();
            self.line(&format!("no scope {scope}, only {}", all.join(", ")));
            return Ok(());
        };
        self.rows(&found["variablesReference"], &names, "")
    }

    fn rows(&mut self, reference: &Value, names: &[&str], indent: &str) -> Result<(), String> {
        let body = self.request("variables", &json!({ "variablesReference": reference }))?.unwrap_or_default();
        for row in body["variables"].as_array().cloned().unwrap_or_default() {
            let name = plain(&row["name"]);
            if !names.is_empty() && !names.contains(&name.as_str()) {
                continue;
            }
            self.line(&format!("{indent}{name} = {}", plain(&row["value"])));
            if row["variablesReference"] != json!(0) && !names.is_empty() {
                self.rows(&row["variablesReference"], &[], &format!("{indent}  "))?;
            }
        }
        Ok(())
    }

    /// Sends a request and reads up to its answer; `None`: it failed.
    fn request(&mut self, command: &str, arguments: &Value) -> Result<Option<Value>, String> {
        self.seq += 1;
        let request = json!({ "seq": self.seq, "type": "request", "command": command, "arguments": arguments });
        let body = request.to_string();
        write!(self.output, "Content-Length: {}\r\n\r\n{body}", body.len()).map_err(|error| error.to_string())?;
        loop {
            let message = self.message()?;
            if message["type"] == json!("response") {
                if message["success"] == json!(true) {
                    return Ok(Some(message["body"].clone()));
                }
                self.line(&format!("error: {}", plain(&message["message"])));
                return Ok(None);
            }
            self.event(&message);
        }
    }

    /// Reads up to a stop or the end.
    fn wait(&mut self) -> Result<(), String> {
        loop {
            let message = self.message()?;
            self.event(&message);
            match message["event"].as_str() {
                Some("terminated") => return Ok(()),
                Some("stopped") => return self.stack(),
                _ => {}
            }
        }
    }

    fn event(&mut self, message: &Value) {
        let body = &message["body"];
        match message["event"].as_str() {
            Some("output") => self.line(&format!("output: {}", plain(&body["output"]).trim_end())),
            Some("stopped") => {
                let ids = body.get("hitBreakpointIds").map_or(String::new(), |ids| format!(" {ids}"));
                let text = body.get("text").map_or(String::new(), |text| format!(": {}", plain(text)));
                self.line(&format!("stopped, {}{ids}{text}", plain(&body["reason"])));
            }
            Some("exited") => self.line(&format!("exit code {}", body["exitCode"])),
            Some("terminated") => self.line("terminated"),
            _ => {}
        }
    }

    fn message(&mut self) -> Result<Value, String> {
        let mut head = String::new();
        let mut length = 0;
        loop {
            head.clear();
            if self.input.read_line(&mut head).map_err(|error| error.to_string())? == 0 {
                return Err(format!("the debugger has gone\n{}", self.text));
            }
            match head.trim().split_once(':') {
                Some((_, value)) => length = value.trim().parse().map_err(|_| head.clone())?,
                None => break,
            }
        }
        let mut body = vec![0; length];
        self.input.read_exact(&mut body).map_err(|error| error.to_string())?;
        serde_json::from_slice(&body).map_err(|error| error.to_string())
    }
}

fn plain(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_string)
}
