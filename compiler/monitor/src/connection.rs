//! The thread that speaks with the CPU.

use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::time::Duration;

use crate::document::{self, Page};
use crate::messages::{Listed, News, Order, Sheet};
use crate::model::Wanted;
use crate::status::Place;
use plcc_services::client::{Line, Process};
use tungstenite::client::IntoClientRequest;
use tungstenite::http::HeaderValue;
use tungstenite::http::header::COOKIE;
use tungstenite::{Error, Message, WebSocket};

/// How long it waits for news before it looks for orders.
const LOOK: Duration = Duration::from_millis(50);
/// How long the CPU may take to let it in.
const BEGIN: Duration = Duration::from_secs(5);
/// From one try to the next.
const RETRY: Duration = Duration::from_secs(1);

/// What comes from the thread.
pub enum Incoming {
    /// The connection is new: all values that the program uses, and the watch tables of its project.
    Connected(Vec<Listed>, Vec<String>),
    /// A watch table of the project, by its name, all that there are now, and its rows or why it cannot be shown.
    Table(String, Vec<String>, Result<Sheet, String>),
    /// All values that the program uses, after it has changed.
    Names(Vec<Listed>),
    /// The blocks of the program, at first and after it has changed, or why they cannot be shown.
    Program(Result<Vec<Page>, String>),
    /// The places of a block where it tells something, or why it has none.
    Places(String, Result<Vec<Place>, String>),
    News(Box<News>),
    /// The connection is lost, or there is none; and why.
    Lost(String),
}

/// What the thread is to do.
enum Task {
    Send(Order),
    Fetch(Wanted),
}

/// The end of the terminal.
pub struct Connection {
    tasks: Sender<Task>,
    incoming: Receiver<Incoming>,
}

impl Connection {
    /// Connects, again and again if it must. `session`: what [`Process::sign_in`] gave.
    pub fn open(process: Process, session: Option<String>) -> Connection {
        let (tasks, asked) = channel();
        let (send, incoming) = channel();
        std::thread::spawn(move || {
            // It ends with the terminal.
            while let Some(why) = speak(&process, session.as_deref(), &asked, &send) {
                if send.send(Incoming::Lost(why)).is_err() {
                    return;
                }
                std::thread::sleep(RETRY);
            }
        });
        Connection { tasks, incoming }
    }

    /// What has come since the last time.
    pub fn take(&self) -> impl Iterator<Item = Incoming> {
        self.incoming.try_iter()
    }

    pub fn send(&self, order: Order) {
        // The thread ends only with this value.
        let _ = self.tasks.send(Task::Send(order));
    }

    /// Asks for something that comes once.
    pub fn fetch(&self, wanted: Wanted) {
        let _ = self.tasks.send(Task::Fetch(wanted));
    }
}

/// Speaks until the connection is lost. Result: why; `None`: the terminal has ended.
fn speak(process: &Process, session: Option<&str>, tasks: &Receiver<Task>, send: &Sender<Incoming>) -> Option<String> {
    let Connected { mut socket, names, tables, pages } = match connect(process, session) {
        Ok(connected) => connected,
        Err(why) => return Some(why),
    };
    // What was asked of the connection before means nothing to this one.
    while tasks.try_recv().is_ok() {}
    send.send(Incoming::Connected(names, tables)).ok()?;
    send.send(Incoming::Program(pages)).ok()?;
    // How many lists of names the CPU has got, and the number of the last one.
    let mut list = (0, 0);
    loop {
        loop {
            match tasks.try_recv() {
                Ok(Task::Fetch(Wanted::Table(name))) => {
                    let sheet = table(process, session, &name);
                    let tables = tables_of(process, session).unwrap_or_default();
                    send.send(Incoming::Table(name, tables, sheet)).ok()?;
                }
                Ok(Task::Fetch(Wanted::Places(block))) => {
                    let places = places(process, session, &block);
                    send.send(Incoming::Places(block, places)).ok()?;
                }
                Ok(Task::Fetch(Wanted::Program)) => {
                    match names_of(process, session) {
                        Ok(names) => send.send(Incoming::Names(names)).ok()?,
                        Err(why) => return Some(why),
                    }
                    send.send(Incoming::Program(program(process, session))).ok()?;
                }
                Ok(Task::Send(order)) => {
                    if let Order::Watch { number, .. } = &order {
                        list = (list.0 + 1, *number);
                    }
                    let text = serde_json::to_string(&order).ok()?;
                    if let Err(error) = socket.send(Message::text(text)) {
                        return Some(error.to_string());
                    }
                }
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => return None,
            }
        }
        match socket.read() {
            Ok(Message::Text(text)) => match serde_json::from_str::<News>(&text) {
                Ok(mut news) => {
                    news.list = (news.list == Some(list.0)).then_some(list.1);
                    send.send(Incoming::News(Box::new(news))).ok()?;
                }
                Err(error) => return Some(format!("not understood: {error}")),
            },
            Ok(Message::Close(_)) => return Some("the process has ended the connection".to_string()),
            Ok(_) => {}
            Err(Error::Io(error))
                if matches!(error.kind(), std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut) => {}
            Err(error) => return Some(error.to_string()),
        }
    }
}

/// Fetches a watch table. `Err`: the error as a sentence.
fn table(process: &Process, session: Option<&str>, name: &str) -> Result<Sheet, String> {
    let answer = process.get(&format!("/tables/{}", encoded(name)), session)?;
    match answer.is_ok() {
        true => serde_json::from_str(&answer.text).map_err(|error| format!("not understood: {error}")),
        false => Err(answer.text),
    }
}

/// The names of all watch tables. `Err`: there was no answer.
fn tables_of(process: &Process, session: Option<&str>) -> Result<Vec<String>, String> {
    let answer = process.get("/tables", session)?;
    // Without a folder of tables the answer is another one.
    Ok(if answer.is_ok() { serde_json::from_str(&answer.text).unwrap_or_default() } else { Vec::new() })
}

/// The places of a block where it tells something. `Err`: it has none, as a sentence.
fn places(process: &Process, session: Option<&str>, block: &str) -> Result<Vec<Place>, String> {
    let answer = process.get(&format!("/places/{}", encoded(block)), session)?;
    match answer.is_ok() {
        true => serde_json::from_str(&answer.text).map_err(|error| format!("not understood: {error}")),
        false => Err("this block has no status".to_string()),
    }
}

/// The blocks of the program; none if it has no drawings. `Err`: they cannot be shown, as a sentence.
fn program(process: &Process, session: Option<&str>) -> Result<Vec<Page>, String> {
    match process.get_bytes("/program", session)? {
        (200, bytes) => document::pages(&bytes),
        _ => Ok(Vec::new()),
    }
}

/// The values of the program.
fn names_of(process: &Process, session: Option<&str>) -> Result<Vec<Listed>, String> {
    let listed = process.get("/names", session)?;
    match listed.status {
        200 => serde_json::from_str(&listed.text).map_err(|error| format!("not understood: {error}")),
        401 => Err("sign in with --user".to_string()),
        status => Err(format!("the process answers with {status}")),
    }
}

/// A part of a path.
fn encoded(name: &str) -> String {
    name.bytes().map(|byte| format!("%{byte:02X}")).collect()
}

/// A connection, the values of the program, the names of its watch tables, and its blocks.
struct Connected {
    socket: WebSocket<Line>,
    names: Vec<Listed>,
    tables: Vec<String>,
    pages: Result<Vec<Page>, String>,
}

fn connect(process: &Process, session: Option<&str>) -> Result<Connected, String> {
    let names = names_of(process, session)?;
    let tables = tables_of(process, session)?;
    let pages = program(process, session);
    let text = |error: &dyn std::fmt::Display| error.to_string();
    // Whether the connection is encrypted does not matter to the request.
    let request = format!("ws://{}/live", process.address()).into_client_request();
    let mut request = request.map_err(|error| text(&error))?;
    if let Some(session) = session {
        let cookie = HeaderValue::from_str(session).map_err(|error| text(&error))?;
        request.headers_mut().insert(COOKIE, cookie);
    }
    let (socket, _) = tungstenite::client(request, process.connect(BEGIN)?).map_err(|error| text(&error))?;
    socket.get_ref().set_read_timeout(LOOK).map_err(|error| text(&error))?;
    Ok(Connected { socket, names, tables, pages })
}
