//! HTTP: the page's files, signing in, and the way to a connection.

use std::time::Duration;

use axum::extract::ws::WebSocketUpgrade;
use axum::extract::{DefaultBodyLimit, State};
use axum::http::header::{CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, COOKIE, HOST, ORIGIN, SET_COOKIE};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use serde::Deserialize;
use tokio::net::TcpListener;

use super::users::{Role, Users};
use super::{names, session};
use crate::link::Link;

/// Letters of a message of the page at most.
const MESSAGE_MAX: usize = 256 * 1024;
/// Pause after a wrong password.
const WRONG_PASSWORD_PAUSE: Duration = Duration::from_secs(1);

#[derive(Clone)]
struct Page {
    link: Link,
    users: Users,
}

/// Serves pages until the CPU ends.
pub async fn serve(listener: TcpListener, link: Link, users: Users) {
    let page = Page { link, users };
    let app = Router::new()
        .route("/", get(|| file("text/html; charset=utf-8", include_str!("page/index.html"))))
        .route("/page.css", get(|| file("text/css; charset=utf-8", include_str!("page/page.css"))))
        .route("/page.js", get(|| file("text/javascript; charset=utf-8", include_str!("page/page.js"))))
        .route("/names", get(listed))
        .route("/session", post(sign_in).delete(sign_out))
        .route("/live", get(live))
        .layer(DefaultBodyLimit::max(MESSAGE_MAX))
        .with_state(page);
    if let Err(error) = axum::serve(listener, app).await {
        eprintln!("runtime: --web: {error}");
    }
}

/// A part of the page. It may load nothing from elsewhere, and no other page may frame it.
async fn file(kind: &'static str, text: &'static str) -> Response {
    let policy = "default-src 'self'; img-src 'self' data:; style-src 'self' 'unsafe-inline'; frame-ancestors 'none'";
    ([(CONTENT_TYPE, kind), (CACHE_CONTROL, "no-cache"), (CONTENT_SECURITY_POLICY, policy)], text).into_response()
}

/// The token in the cookie.
fn token(headers: &HeaderMap) -> Option<&str> {
    let cookies = headers.get(COOKIE)?.to_str().ok()?;
    cookies.split(';').find_map(|cookie| cookie.trim().strip_prefix("plcc="))
}

impl Page {
    fn user(&self, headers: &HeaderMap) -> Result<(String, Role), StatusCode> {
        self.users.of(token(headers)).ok_or(StatusCode::UNAUTHORIZED)
    }
}

/// Requests that change something come from this page only: a browser says from which one.
fn is_own(headers: &HeaderMap) -> bool {
    let Some(origin) = headers.get(ORIGIN) else { return true };
    let (Ok(origin), Some(Ok(host))) = (origin.to_str(), headers.get(HOST).map(|host| host.to_str())) else {
        return false;
    };
    origin.split_once("://").is_some_and(|(_, from)| from == host)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SignIn {
    user: String,
    password: String,
}

async fn sign_in(State(page): State<Page>, headers: HeaderMap, Json(form): Json<SignIn>) -> Response {
    if !is_own(&headers) {
        return StatusCode::FORBIDDEN.into_response();
    }
    let users = page.users.clone();
    // Not on the thread that serves everybody: it is made to be slow.
    let signed = tokio::task::spawn_blocking(move || users.sign_in(&form.user, &form.password)).await;
    match signed {
        Ok(Some(token)) => {
            let cookie = format!("plcc={token}; HttpOnly; SameSite=Strict; Path=/");
            ([(SET_COOKIE, cookie)], StatusCode::NO_CONTENT).into_response()
        }
        _ => {
            tokio::time::sleep(WRONG_PASSWORD_PAUSE).await;
            StatusCode::UNAUTHORIZED.into_response()
        }
    }
}

async fn sign_out(State(page): State<Page>, headers: HeaderMap) -> StatusCode {
    if !is_own(&headers) {
        return StatusCode::FORBIDDEN;
    }
    if let Some(token) = token(&headers) {
        page.users.sign_out(token);
    }
    StatusCode::NO_CONTENT
}

async fn listed(State(page): State<Page>, headers: HeaderMap) -> Result<Response, StatusCode> {
    page.user(&headers)?;
    let names = page.link.ask(|cpu| names::list(&cpu.image)).await.ok_or(StatusCode::SERVICE_UNAVAILABLE)?;
    Ok(Json(names).into_response())
}

async fn live(State(page): State<Page>, headers: HeaderMap, upgrade: WebSocketUpgrade) -> Result<Response, StatusCode> {
    if !is_own(&headers) {
        return Err(StatusCode::FORBIDDEN);
    }
    let (user, role) = page.user(&headers)?;
    Ok(upgrade.max_message_size(MESSAGE_MAX).on_upgrade(move |socket| session::serve(socket, page.link, user, role)))
}
