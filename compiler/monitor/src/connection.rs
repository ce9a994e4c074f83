//! The thread that speaks with the CPU.

use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::time::Duration;

use crate::messages::{Listed, News, Order, Sheet};
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
    News(Box<News>),
    /// The connection is lost, or there is none; and why.
    Lost(String),
}

/// What the thread is to do.
enum Task {
    Send(Order),
    /// Fetch the watch table with this name.
    Table(String),
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

    /// Asks for a watch table of the project.
    pub fn fetch(&self, table: String) {
        let _ = self.tasks.send(Task::Table(table));
    }
}

/// Speaks until the connection is lost. Result: why; `None`: the terminal has ended.
fn speak(process: &Process, session: Option<&str>, tasks: &Receiver<Task>, send: &Sender<Incoming>) -> Option<String> {
    let (mut socket, names, tables) = match connect(process, session) {
        Ok(connected) => connected,
        Err(why) => return Some(why),
    };
    // What was asked of the connection before means nothing to this one.
    while tasks.try_recv().is_ok() {}
    send.send(Incoming::Connected(names, tables)).ok()?;
    // How many lists of names the CPU has got, and the number of the last one.
    let mut list = (0, 0);
    loop {
        loop {
            match tasks.try_recv() {
                Ok(Task::Table(name)) => {
                    let sheet = table(process, session, &name);
                    let tables = tables_of(process, session).unwrap_or_default();
                    send.send(Incoming::Table(name, tables, sheet)).ok()?;
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
    let encoded: String = name.bytes().map(|byte| format!("%{byte:02X}")).collect();
    let path = format!("/tables/{encoded}");
    let answer = process.get(&path, session)?;
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

/// A connection, the values of the program, and the names of its watch tables.
type Connected = (WebSocket<Line>, Vec<Listed>, Vec<String>);

fn connect(process: &Process, session: Option<&str>) -> Result<Connected, String> {
    let listed = process.get("/names", session)?;
    if !listed.is_ok() {
        return Err(match listed.status {
            401 => "sign in with --user".to_string(),
            status => format!("the process answers with {status}"),
        });
    }
    let names = serde_json::from_str(&listed.text).map_err(|error| format!("not understood: {error}"))?;
    let tables = tables_of(process, session)?;
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
    Ok((socket, names, tables))
}
