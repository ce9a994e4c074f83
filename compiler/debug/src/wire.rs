//! Messages of the Debug Adapter Protocol: a head with the length, then JSON.

use std::cell::{Cell, RefCell};
use std::io::{BufRead, BufReader, Read, Write};
use std::sync::mpsc::{Receiver, Sender, channel};

use plcc_runtime::files::without_numbers;
use serde::Deserialize;
use serde_json::{Value, json};

/// Longer messages are a mistake.
const BYTES_MAX: usize = 16 << 20;
/// Longest line of a head.
const HEAD_MAX: u64 = 4096;

/// A request of the client.
#[derive(Clone, Debug, Deserialize)]
pub struct Request {
    pub seq: i64,
    pub command: String,
    #[serde(default)]
    pub arguments: Value,
}

impl Request {
    /// An argument that is a text.
    pub fn text(&self, name: &str) -> Option<&str> {
        self.arguments.get(name)?.as_str()
    }

    /// An argument that is a number, 0 or more.
    pub fn number(&self, name: &str) -> Option<u64> {
        self.arguments.get(name)?.as_u64()
    }

    /// An argument that is a list; one that is left out is empty.
    pub fn list(&self, name: &str) -> &[Value] {
        self.arguments.get(name).and_then(Value::as_array).map_or(&[], Vec::as_slice)
    }
}

/// What comes from the client.
#[derive(Debug)]
pub enum Incoming {
    Request(Request),
    /// Not a request; why.
    Wrong(String),
    /// There will be no more.
    Closed,
}

/// Reads messages in a thread of its own.
pub fn listen(input: impl Read + Send + 'static) -> Result<Receiver<Incoming>, String> {
    let (send, receive) = channel();
    let read = move || read_all(BufReader::new(input), &send);
    std::thread::Builder::new().name("client".to_string()).spawn(read).map_err(|error| error.to_string())?;
    Ok(receive)
}

fn read_all(mut input: impl BufRead, send: &Sender<Incoming>) {
    loop {
        let incoming = match message(&mut input) {
            Ok(Some(body)) => incoming(&body),
            Ok(None) => Some(Incoming::Closed),
            // After a wrong head it is unknown where the next message begins.
            Err(error) => {
                let _ = send.send(Incoming::Wrong(error));
                Some(Incoming::Closed)
            }
        };
        let Some(incoming) = incoming else { continue };
        let is_last = matches!(incoming, Incoming::Closed);
        if send.send(incoming).is_err() || is_last {
            return;
        }
    }
}

/// A message; `None` for one that needs no answer.
fn incoming(body: &[u8]) -> Option<Incoming> {
    let value: Value = match serde_json::from_slice(body) {
        Ok(value) => value,
        Err(error) => return Some(Incoming::Wrong(format!("a message is not JSON: {error}"))),
    };
    match value.get("type").and_then(Value::as_str) {
        Some("request") => Some(match serde_json::from_value(value) {
            Ok(request) => Incoming::Request(request),
            Err(error) => Incoming::Wrong(format!("a request is not complete: {error}")),
        }),
        // The debugger asks nothing of the client.
        Some("response" | "event") => None,
        _ => Some(Incoming::Wrong("a message has no type".to_string())),
    }
}

/// The body of the next message; `None` at the end.
fn message(input: &mut impl BufRead) -> Result<Option<Vec<u8>>, String> {
    let mut length = None;
    loop {
        let mut line = Vec::new();
        let read = input.by_ref().take(HEAD_MAX).read_until(b'\n', &mut line).map_err(|error| error.to_string())?;
        if read == 0 {
            return Ok(None);
        }
        let line = String::from_utf8_lossy(&line).trim().to_string();
        if line.is_empty() {
            if length.is_some() {
                break;
            }
            continue;
        }
        let (name, value) = line.split_once(':').ok_or_else(|| format!("`{line}` is not a line of a head"))?;
        if name.eq_ignore_ascii_case("Content-Length") {
            let value = value.trim().parse().ok().filter(|length| *length <= BYTES_MAX);
            length = Some(value.ok_or_else(|| format!("`{line}` is not a length up to {BYTES_MAX}"))?);
        }
    }
    let mut body = vec![0; length.unwrap_or(0)];
    match input.read_exact(&mut body) {
        Ok(()) => Ok(Some(body)),
        Err(_) => Ok(None),
    }
}

/// Writes messages.
pub struct Wire {
    out: RefCell<Box<dyn Write>>,
    seq: Cell<i64>,
}

impl Wire {
    pub fn new(out: Box<dyn Write>) -> Wire {
        Wire { out: RefCell::new(out), seq: Cell::new(0) }
    }

    fn send(&self, mut message: Value) {
        self.seq.set(self.seq.get() + 1);
        message["seq"] = self.seq.get().into();
        let body = message.to_string();
        let mut out = self.out.borrow_mut();
        // A client that is gone is noticed where its requests are read.
        let _ = write!(out, "Content-Length: {}\r\n\r\n{body}", body.len()).and_then(|()| out.flush());
    }

    pub fn event(&self, name: &str, body: Value) {
        self.send(json!({ "type": "event", "event": name, "body": body }));
    }

    /// A line for the console of the client. `category`: `console`, `stdout`, `important`.
    pub fn say(&self, category: &str, text: &str) {
        self.event("output", json!({ "category": category, "output": format!("{}\n", without_numbers(text)) }));
    }

    /// The answer to a request. `Err`: why there is none, for the user.
    pub fn answer(&self, request: &Request, answer: Result<Value, String>) {
        let mut message = json!({ "type": "response", "request_seq": request.seq, "command": request.command });
        match answer {
            Ok(body) => {
                message["success"] = true.into();
                message["body"] = body;
            }
            Err(error) => {
                let error = without_numbers(&error);
                message["success"] = false.into();
                message["message"] = error.clone().into();
                message["body"] = json!({ "error": { "id": 1, "format": error, "showUser": true } });
            }
        }
        self.send(message);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(bytes: &[u8]) -> Vec<String> {
        let (send, receive) = channel();
        read_all(bytes, &send);
        drop(send);
        receive
            .iter()
            .map(|incoming| match incoming {
                Incoming::Request(request) => request.command,
                Incoming::Wrong(error) => format!("wrong: {}", error.split(':').next().unwrap_or("")),
                Incoming::Closed => "closed".to_string(),
            })
            .collect()
    }

    #[test]
    fn whatever_comes_has_an_end() {
        let body = |text: &str| format!("Content-Length: {}\r\n\r\n{text}", text.len());
        let next = body("{\"seq\":1,\"type\":\"request\",\"command\":\"next\"}");
        for (text, expected) in [
            (String::new(), vec!["closed"]),
            (next.clone() + &next, vec!["next", "next", "closed"]),
            (body("{}") + &next, vec!["wrong: a message has no type", "next", "closed"]),
            (body("{") + &next, vec!["wrong: a message is not JSON", "next", "closed"]),
            (
                body("{\"type\":\"request\",\"seq\":[]}") + &next,
                vec!["wrong: a request is not complete", "next", "closed"],
            ),
            (body("{\"type\":\"event\"}"), vec!["closed"]),
            ("Content-Length: 99\r\n\r\n{}".to_string(), vec!["closed"]),
            ("Content-Length: x\r\n\r\n".to_string(), vec!["wrong: `Content-Length", "closed"]),
            ("Content-Length: 99999999999\r\n\r\n".to_string(), vec!["wrong: `Content-Length", "closed"]),
            ("nonsense\r\n\r\n".to_string(), vec!["wrong: `nonsense` is not a line of a head", "closed"]),
        ] {
            assert_eq!(all(text.as_bytes()), expected, "{text}");
        }
        assert_eq!(all(&[0xFF; 5000]).len(), 2);
    }
}
