//! The thread that speaks with the CPU.

use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::time::Duration;

use crate::messages::{Listed, News, Order};
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
    /// The connection is new: all values that the program uses.
    Connected(Vec<Listed>),
    News(Box<News>),
    /// The connection is lost, or there is none; and why.
    Lost(String),
}

/// The end of the terminal.
pub struct Connection {
    orders: Sender<Order>,
    incoming: Receiver<Incoming>,
}

impl Connection {
    /// Connects, again and again if it must. `session`: what [`Process::sign_in`] gave.
    pub fn open(process: Process, session: Option<String>) -> Connection {
        let (orders, ordered) = channel();
        let (send, incoming) = channel();
        std::thread::spawn(move || {
            // It ends with the terminal.
            while let Some(why) = speak(&process, session.as_deref(), &ordered, &send) {
                if send.send(Incoming::Lost(why)).is_err() {
                    return;
                }
                std::thread::sleep(RETRY);
            }
        });
        Connection { orders, incoming }
    }

    /// What has come since the last time.
    pub fn take(&self) -> impl Iterator<Item = Incoming> {
        self.incoming.try_iter()
    }

    pub fn send(&self, order: Order) {
        // The thread ends only with this value.
        let _ = self.orders.send(order);
    }
}

/// Speaks until the connection is lost. Result: why; `None`: the terminal has ended.
fn speak(
    process: &Process,
    session: Option<&str>,
    orders: &Receiver<Order>,
    send: &Sender<Incoming>,
) -> Option<String> {
    let (mut socket, names) = match connect(process, session) {
        Ok(connected) => connected,
        Err(why) => return Some(why),
    };
    // What was asked of the connection before means nothing to this one.
    while orders.try_recv().is_ok() {}
    send.send(Incoming::Connected(names)).ok()?;
    loop {
        loop {
            match orders.try_recv() {
                Ok(order) => {
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
            Ok(Message::Text(text)) => match serde_json::from_str(&text) {
                Ok(news) => send.send(Incoming::News(Box::new(news))).ok()?,
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

fn connect(process: &Process, session: Option<&str>) -> Result<(WebSocket<Line>, Vec<Listed>), String> {
    let listed = process.get("/names", session)?;
    if !listed.is_ok() {
        return Err(match listed.status {
            401 => "sign in with --user".to_string(),
            status => format!("the process answers with {status}"),
        });
    }
    let names = serde_json::from_str(&listed.text).map_err(|error| format!("not understood: {error}"))?;
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
    Ok((socket, names))
}
