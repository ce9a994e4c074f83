//! A client of the page of a running process: for `plcc load` and `plcc monitor`.

use std::io::{self, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use axum::body::{Body, Bytes, to_bytes};
use axum::http::header::{CONTENT_TYPE, COOKIE, HOST, SET_COOKIE};
use axum::http::request::Builder;
use axum::http::response::Parts;
use axum::http::{HeaderMap, Request};
use hyper_util::rt::TokioIo;
use tokio::time::timeout;
use tokio_rustls::TlsConnector;
use tokio_rustls::rustls::pki_types::ServerName;
use tokio_rustls::rustls::{ClientConfig, ClientConnection, StreamOwned};

use crate::{options, tls};

/// The status of an answer: values of the running program would be lost.
pub const CONFLICT: u16 = 409;
/// How long an answer may take.
const TIME: Duration = Duration::from_secs(60);
/// The longest answer: the names or the drawings of a large program.
const ANSWER_MAX: usize = 64 << 20;

/// Where a page is: an address as in flags, or as the process prints it: `http://127.0.0.1:8080`. `Err`: the error.
pub fn address(text: &str) -> Result<SocketAddr, String> {
    let place = ["http://", "https://"].iter().find_map(|scheme| text.strip_prefix(scheme));
    options::address(place.map_or(text, |place| place.trim_end_matches('/')))
}

/// What a process has answered.
#[derive(Clone, Debug)]
pub struct Answer {
    pub status: u16,
    pub text: String,
    headers: HeaderMap,
}

impl Answer {
    pub fn is_ok(&self) -> bool {
        (200..300).contains(&self.status)
    }

    /// Why it is not, in words.
    pub fn why(&self) -> String {
        match self.text.trim() {
            "" => format!("the process answers with {}; is its page there?", self.status),
            text => text.to_string(),
        }
    }
}

/// Where the page of a process is, and how it is reached.
#[derive(Clone, Debug)]
pub struct Process {
    address: SocketAddr,
    /// What its certificate must be, if the connection is encrypted.
    secured: Option<Arc<ClientConfig>>,
}

impl Process {
    /// `trusted`: the connection is encrypted; the file with the certificate of the process or of its authority, or a folder with
    /// `certificate.pem`. `Err`: what is wrong with it.
    pub fn new(address: SocketAddr, trusted: Option<&Path>) -> Result<Process, String> {
        let secured = trusted.map(tls::client).transpose()?;
        Ok(Process { address, secured })
    }

    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Signs a user in. `Ok`: what later requests say. `Err`: why not.
    pub fn sign_in(&self, user: &str, password: &str) -> Result<String, String> {
        let form = serde_json::json!({ "user": user, "password": password }).to_string();
        let answer = self.send(Request::post("/session"), None, Some("application/json"), form.into_bytes())?;
        let cookie = answer.headers.get(SET_COOKIE).and_then(|cookie| cookie.to_str().ok());
        match cookie.and_then(|cookie| cookie.split(';').next()).filter(|_| answer.is_ok()) {
            Some(cookie) => Ok(cookie.to_string()),
            None => Err("user or password is wrong".to_string()),
        }
    }

    /// Asks for a page; `session` is what [`Process::sign_in`] gave. `Err`: there was no answer.
    pub fn get(&self, path: &str, session: Option<&str>) -> Result<Answer, String> {
        self.send(Request::get(path), session, None, Vec::new())
    }

    /// As [`Process::get`], of what is not a text: its status and its bytes.
    pub fn get_bytes(&self, path: &str, session: Option<&str>) -> Result<(u16, Vec<u8>), String> {
        let (head, body) = self.ask(Request::get(path), session, None, Vec::new())?;
        Ok((head.status.as_u16(), body.to_vec()))
    }

    /// Sends a request with a body; `session` is what [`Process::sign_in`] gave. `Err`: there was no answer.
    pub fn post(&self, path: &str, session: Option<&str>, body: &[u8]) -> Result<Answer, String> {
        self.send(Request::post(path), session, None, body.to_vec())
    }

    /// A connection for other messages. `time`: how long connecting and each reading may take.
    pub fn connect(&self, time: Duration) -> Result<Line, String> {
        let text = |error: io::Error| error.to_string();
        let stream = TcpStream::connect_timeout(&self.address, time).map_err(text)?;
        stream.set_read_timeout(Some(time)).map_err(text)?;
        let Some(config) = &self.secured else { return Ok(Line::Plain(stream)) };
        let connection = ClientConnection::new(config.clone(), self.name()).map_err(|error| error.to_string())?;
        let mut stream = StreamOwned::new(connection, stream);
        while stream.conn.is_handshaking() {
            stream.conn.complete_io(&mut stream.sock).map_err(|error| tls::refused(&error))?;
        }
        Ok(Line::Secured(Box::new(stream)))
    }

    /// What a certificate must be for.
    fn name(&self) -> ServerName<'static> {
        ServerName::IpAddress(self.address.ip().into())
    }

    fn send(
        &self,
        request: Builder,
        session: Option<&str>,
        kind: Option<&str>,
        body: Vec<u8>,
    ) -> Result<Answer, String> {
        let (head, body) = self.ask(request, session, kind, body)?;
        let text = String::from_utf8_lossy(&body).into_owned();
        Ok(Answer { status: head.status.as_u16(), text, headers: head.headers })
    }

    fn ask(
        &self,
        request: Builder,
        session: Option<&str>,
        kind: Option<&str>,
        body: Vec<u8>,
    ) -> Result<(Parts, Bytes), String> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build();
        let runtime = runtime.map_err(|error| error.to_string())?;
        let mut request = request.header(HOST, self.address.to_string());
        if let Some(session) = session {
            request = request.header(COOKIE, session);
        }
        if let Some(kind) = kind {
            request = request.header(CONTENT_TYPE, kind);
        }
        let request = request.body(Body::from(body)).map_err(|error| error.to_string())?;
        runtime.block_on(async {
            match timeout(TIME, self.exchange(request)).await {
                Ok(answer) => answer,
                Err(_) => Err("no answer within a minute".to_string()),
            }
        })
    }

    async fn exchange(&self, request: Request<Body>) -> Result<(Parts, Bytes), String> {
        let stream = tokio::net::TcpStream::connect(self.address).await.map_err(|error| unreached(&error))?;
        let stream: Box<dyn tls::Stream> = match &self.secured {
            None => Box::new(stream),
            Some(config) => {
                let secured = TlsConnector::from(config.clone()).connect(self.name(), stream).await;
                Box::new(secured.map_err(|error| tls::refused(&error))?)
            }
        };
        let wrong = |error: hyper::Error| match error.is_parse() && self.secured.is_none() {
            // The alert of a server that expects TLS is not HTTP either.
            true => {
                "what answers is not the page of a program, or it is encrypted: name its certificate with --tls FILE"
                    .to_string()
            }
            false => format!("what answers is not the page of a program: {error}"),
        };
        let (mut sender, connection) =
            hyper::client::conn::http1::handshake(TokioIo::new(stream)).await.map_err(wrong)?;
        tokio::spawn(connection);
        let response = sender.send_request(request).await.map_err(wrong)?;
        let (head, body) = response.into_parts();
        let body: Bytes = to_bytes(Body::new(body), ANSWER_MAX).await.map_err(|error| error.to_string())?;
        Ok((head, body))
    }
}

/// Why nobody answers at an address.
fn unreached(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::ConnectionRefused => format!("{error}: no process has a page there; start it with `--web`"),
        _ => error.to_string(),
    }
}

/// A connection to a process.
pub enum Line {
    Plain(TcpStream),
    Secured(Box<StreamOwned<ClientConnection, TcpStream>>),
}

impl Line {
    /// How long a reading may take from here on.
    pub fn set_read_timeout(&self, time: Duration) -> io::Result<()> {
        let stream = match self {
            Line::Plain(stream) => stream,
            Line::Secured(stream) => &stream.sock,
        };
        stream.set_read_timeout(Some(time))
    }
}

impl Read for Line {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Line::Plain(stream) => stream.read(buffer),
            Line::Secured(stream) => stream.read(buffer),
        }
    }
}

impl Write for Line {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Line::Plain(stream) => stream.write(bytes),
            Line::Secured(stream) => stream.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Line::Plain(stream) => stream.flush(),
            Line::Secured(stream) => stream.flush(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::net::TcpListener;

    use super::*;

    #[test]
    fn a_page_is_named_as_it_is_printed() {
        let page: SocketAddr = "127.0.0.1:8080".parse().unwrap();
        for text in ["8080", "127.0.0.1:8080", "http://127.0.0.1:8080", "https://127.0.0.1:8080/"] {
            assert_eq!(address(text), Ok(page), "{text}");
        }
        let told = address("http://127.0.0.1").unwrap_err();
        assert!(told.starts_with("`127.0.0.1` is not an address with a port"), "{told}");
    }

    #[test]
    fn an_answer_without_words_has_its_status() {
        let answer = |text: &str| Answer { status: 405, text: text.to_string(), headers: HeaderMap::new() };
        assert_eq!(answer("").why(), "the process answers with 405; is its page there?");
        assert_eq!(answer("sign in first").why(), "sign in first");
    }

    #[test]
    fn the_names_of_a_large_program_are_taken() {
        const BYTES: usize = 3 << 20;
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let server = std::thread::spawn(move || {
            let (mut stream, _) = listener.accept().unwrap();
            let mut asked = Vec::new();
            let mut byte = [0];
            while !asked.ends_with(b"\r\n\r\n") && stream.read(&mut byte).unwrap() > 0 {
                asked.extend(byte);
            }
            write!(stream, "HTTP/1.1 200 OK\r\nContent-Length: {BYTES}\r\nConnection: close\r\n\r\n").unwrap();
            stream.write_all(&vec![b'x'; BYTES]).unwrap();
        });
        let answer = Process::new(address, None).unwrap().get("/names", None).unwrap();
        server.join().unwrap();
        assert_eq!((answer.status, answer.text.len()), (200, BYTES));
    }
}
