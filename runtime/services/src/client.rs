//! A client of the page of a running process: for `plcc load`.

use std::net::SocketAddr;
use std::time::Duration;

use axum::body::{Body, Bytes, to_bytes};
use axum::http::header::{CONTENT_TYPE, COOKIE, HOST, SET_COOKIE};
use axum::http::request::Builder;
use axum::http::{HeaderMap, Request};
use hyper_util::rt::TokioIo;
use tokio::net::TcpStream;
use tokio::time::timeout;

/// The status of an answer: values of the running program would go.
pub const CONFLICT: u16 = 409;
/// How long an answer may take.
const TIME: Duration = Duration::from_secs(60);
/// The longest answer.
const ANSWER_MAX: usize = 1 << 20;

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
}

/// Signs a user in. `Ok`: what later requests say. `Err`: why not.
pub fn sign_in(address: SocketAddr, user: &str, password: &str) -> Result<String, String> {
    let form = serde_json::json!({ "user": user, "password": password }).to_string();
    let answer = send(address, Request::post("/session"), None, Some("application/json"), form.into_bytes())?;
    let cookie = answer.headers.get(SET_COOKIE).and_then(|cookie| cookie.to_str().ok());
    match cookie.and_then(|cookie| cookie.split(';').next()).filter(|_| answer.is_ok()) {
        Some(cookie) => Ok(cookie.to_string()),
        None => Err("user or password is wrong".to_string()),
    }
}

/// Asks for a page; `session` is what [`sign_in`] gave. `Err`: there was no answer.
pub fn get(address: SocketAddr, path: &str, session: Option<&str>) -> Result<Answer, String> {
    send(address, Request::get(path), session, None, Vec::new())
}

/// Sends a request with a body; `session` is what [`sign_in`] gave. `Err`: there was no answer.
pub fn post(address: SocketAddr, path: &str, session: Option<&str>, body: &[u8]) -> Result<Answer, String> {
    send(address, Request::post(path), session, None, body.to_vec())
}

fn send(
    address: SocketAddr,
    request: Builder,
    session: Option<&str>,
    kind: Option<&str>,
    body: Vec<u8>,
) -> Result<Answer, String> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build();
    let runtime = runtime.map_err(|error| error.to_string())?;
    let mut request = request.header(HOST, address.to_string());
    if let Some(session) = session {
        request = request.header(COOKIE, session);
    }
    if let Some(kind) = kind {
        request = request.header(CONTENT_TYPE, kind);
    }
    let request = request.body(Body::from(body)).map_err(|error| error.to_string())?;
    runtime.block_on(async {
        match timeout(TIME, exchange(address, request)).await {
            Ok(answer) => answer,
            Err(_) => Err("no answer within a minute".to_string()),
        }
    })
}

async fn exchange(address: SocketAddr, request: Request<Body>) -> Result<Answer, String> {
    let stream = TcpStream::connect(address).await.map_err(|error| error.to_string())?;
    let wrong = |error: hyper::Error| match error.is_parse() {
        // The alert of a server that expects TLS is not HTTP either.
        true => {
            "what answers is not the page of a program, or it is encrypted by --tls, which plcc does not speak".into()
        }
        false => format!("what answers is not the page of a program: {error}"),
    };
    let (mut sender, connection) = hyper::client::conn::http1::handshake(TokioIo::new(stream)).await.map_err(wrong)?;
    tokio::spawn(connection);
    let response = sender.send_request(request).await.map_err(wrong)?;
    let (head, body) = response.into_parts();
    let body: Bytes = to_bytes(Body::new(body), ANSWER_MAX).await.map_err(|error| error.to_string())?;
    let text = String::from_utf8_lossy(&body).into_owned();
    Ok(Answer { status: head.status.as_u16(), text, headers: head.headers })
}
