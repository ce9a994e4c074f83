//! HTTP: the page's files, signing in, and the way to a connection.

use std::net::IpAddr;
use std::sync::Arc;

use axum::body::{Bytes, to_bytes};
use axum::extract::ws::WebSocketUpgrade;
use axum::extract::{DefaultBodyLimit, Extension, Path, RawQuery, Request};
use axum::http::header::{
    CACHE_CONTROL, CONTENT_ENCODING, CONTENT_SECURITY_POLICY, CONTENT_TYPE, COOKIE, HOST, ORIGIN, SET_COOKIE,
};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use plcc_abi::services::{Right, Role};
use plcc_runtime::change::{Loader, Prepared};
use plcc_runtime::watch::sheet::Sheet;
use serde::Deserialize;
use tokio::sync::Semaphore;
use tokio::time::timeout;

use super::tables::{Tables, Wrong};
use super::users::{May, Users};
use super::{info, names, session, status};
use crate::limits::{
    FRAME_TIME, HTTP_BYTES_MAX, PAGE_MESSAGE_MAX, PAGES_MAX, PROGRAM_MAX, PROGRAM_TIME, SIGN_IN_MAX,
    WRONG_PASSWORD_PAUSE,
};
use crate::link::Link;
use crate::listen::Open;
use crate::password;
use crate::patience::Patience;
use crate::tls::Stream;

/// What the page is made of.
#[derive(Clone)]
pub struct Page {
    link: Link,
    users: Users,
    /// A permit for each browser that gets values.
    places: Arc<Semaphore>,
    /// Loads programs, if that is allowed.
    loader: Option<Loader>,
    app: Router,
    /// Connections of each service.
    services: Arc<[(&'static str, Open)]>,
    /// Its connections are encrypted.
    is_secure: bool,
    /// The watch tables of the project, if it has a folder for them.
    tables: Option<Arc<Tables>>,
}

/// What a request asks of.
#[derive(Clone)]
struct Asked {
    page: Page,
    /// The most that this computer may do.
    most: Role,
}

impl Page {
    pub fn new(
        link: Link,
        users: Users,
        services: Vec<(&'static str, Open)>,
        loader: Option<Loader>,
        is_secure: bool,
        tables: Option<Tables>,
    ) -> Page {
        let files = [
            ("/", "text/html; charset=utf-8", include_str!("page/index.html")),
            ("/page.css", "text/css; charset=utf-8", include_str!("page/page.css")),
            ("/page.js", "text/javascript; charset=utf-8", include_str!("page/page.js")),
            ("/table.js", "text/javascript; charset=utf-8", include_str!("page/table.js")),
            ("/status.js", "text/javascript; charset=utf-8", include_str!("page/status.js")),
            ("/recording.js", "text/javascript; charset=utf-8", include_str!("page/recording.js")),
        ];
        let mut app = Router::new();
        for (path, kind, text) in files {
            app = app.route(path, get(move || file(kind, text)));
        }
        let app = app
            .route("/program", get(program))
            .route("/names", get(listed))
            .route("/places/{block}", get(places))
            .route("/info", get(about))
            .route("/table/rows", post(table_rows))
            .route("/table/file", post(table_file))
            .route("/tables", get(table_names))
            .route("/tables/{name}", get(table_read).put(table_written))
            .route("/session", post(sign_in).delete(sign_out))
            .route("/live", get(live))
            .route("/restore", post(restored))
            .route("/load", post(loaded))
            .layer(DefaultBodyLimit::max(PAGE_MESSAGE_MAX));
        let places = Arc::new(Semaphore::new(PAGES_MAX));
        Page { link, users, places, loader, app, services: services.into(), is_secure, tables: tables.map(Arc::new) }
    }

    fn user(&self, headers: &HeaderMap) -> Result<(String, Role), StatusCode> {
        if self.users.is_open() && !is_of_this_computer(headers) {
            return Err(StatusCode::FORBIDDEN);
        }
        self.users.of(token(headers)).ok_or(StatusCode::UNAUTHORIZED)
    }
}

/// Serves one connection.
pub async fn serve(stream: impl Stream + 'static, right: Right, page: Page) {
    let most = match right {
        Right::Read => Role::Look,
        Right::Write => Role::Operate,
        Right::Control => Role::Change,
    };
    let app = page.app.clone().layer(Extension(Asked { page, most }));
    // A client that is too slow, or speaks no HTTP, is gone.
    let _ = hyper::server::conn::http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(FRAME_TIME)
        .max_buf_size(HTTP_BYTES_MAX)
        .serve_connection(TokioIo::new(Patience::new(stream)), TowerToHyperService::new(app))
        .with_upgrades()
        .await;
}

/// A part of the page. It may load nothing from elsewhere, and no other page may frame it.
async fn file(kind: &'static str, text: &'static str) -> Response {
    let policy = "default-src 'self'; img-src 'self' data:; style-src 'self' 'unsafe-inline'; frame-ancestors 'none'";
    ([(CONTENT_TYPE, kind), (CACHE_CONTROL, "no-cache"), (CONTENT_SECURITY_POLICY, policy)], text).into_response()
}

/// The drawings of the program: one document, packed by plcc, that loads nothing else.
async fn program(Extension(Asked { page, .. }): Extension<Asked>, headers: HeaderMap) -> Result<Response, StatusCode> {
    page.user(&headers)?;
    // Of the program that runs now.
    let image = page.link.ask(|cpu| Arc::clone(&cpu.image)).await.ok_or(StatusCode::SERVICE_UNAVAILABLE)?;
    let drawings = &image.config.services.drawings;
    if drawings.is_empty() {
        return Err(StatusCode::NOT_FOUND);
    }
    let policy = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; frame-ancestors 'self'";
    let head = [
        (CONTENT_TYPE, "text/html; charset=utf-8"),
        (CONTENT_ENCODING, "gzip"),
        (CACHE_CONTROL, "no-cache"),
        (CONTENT_SECURITY_POLICY, policy),
    ];
    Ok((head, Bytes::copy_from_slice(drawings)).into_response())
}

/// The token in the cookie.
fn token(headers: &HeaderMap) -> Option<&str> {
    let cookies = headers.get(COOKIE)?.to_str().ok()?;
    cookies.split(';').find_map(|cookie| cookie.trim().strip_prefix("plcc="))
}

/// Whether the page was asked for by the address of this computer. Without users that must be so: else a page of another host, whose name
/// leads here once it has been loaded, could do all that this computer may.
fn is_of_this_computer(headers: &HeaderMap) -> bool {
    let Some(host) = headers.get(HOST).and_then(|host| host.to_str().ok()) else { return false };
    let name = match host.strip_prefix('[') {
        Some(rest) => rest.split(']').next(),
        None => host.split(':').next(),
    };
    name.is_some_and(|name| name.eq_ignore_ascii_case("localhost") || name.parse::<IpAddr>().is_ok())
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

async fn sign_in(Extension(Asked { page, .. }): Extension<Asked>, headers: HeaderMap, request: Request) -> Response {
    if !is_own(&headers) {
        return StatusCode::FORBIDDEN.into_response();
    }
    // No form of another page has this type.
    let kind = headers.get(CONTENT_TYPE).and_then(|kind| kind.to_str().ok());
    if !kind.is_some_and(|kind| kind.starts_with("application/json")) {
        return StatusCode::UNSUPPORTED_MEDIA_TYPE.into_response();
    }
    let body = match timeout(FRAME_TIME, to_bytes(request.into_body(), SIGN_IN_MAX)).await {
        Ok(Ok(body)) => body,
        Ok(Err(_)) => return StatusCode::PAYLOAD_TOO_LARGE.into_response(),
        Err(_) => return StatusCode::REQUEST_TIMEOUT.into_response(),
    };
    let Ok(form) = serde_json::from_slice::<SignIn>(&body) else { return StatusCode::BAD_REQUEST.into_response() };
    let users = page.users.clone();
    let Some(turn) = password::turn().await else { return StatusCode::SERVICE_UNAVAILABLE.into_response() };
    // Not on the thread that serves everybody: it is made to be slow.
    let signed = tokio::task::spawn_blocking(move || users.sign_in(&form.user, &form.password)).await;
    drop(turn);
    match signed {
        Ok(Some(token)) => {
            let secure = if page.is_secure { "; Secure" } else { "" };
            let cookie = format!("plcc={token}; HttpOnly; SameSite=Strict; Path=/{secure}");
            ([(SET_COOKIE, cookie)], StatusCode::NO_CONTENT).into_response()
        }
        _ => {
            tokio::time::sleep(WRONG_PASSWORD_PAUSE).await;
            StatusCode::UNAUTHORIZED.into_response()
        }
    }
}

async fn sign_out(Extension(Asked { page, .. }): Extension<Asked>, headers: HeaderMap) -> StatusCode {
    if !is_own(&headers) {
        return StatusCode::FORBIDDEN;
    }
    if let Some(token) = token(&headers) {
        page.users.sign_out(token);
    }
    StatusCode::NO_CONTENT
}

async fn listed(Extension(Asked { page, .. }): Extension<Asked>, headers: HeaderMap) -> Result<Response, StatusCode> {
    page.user(&headers)?;
    let image = page.link.ask(|cpu| Arc::clone(&cpu.image)).await.ok_or(StatusCode::SERVICE_UNAVAILABLE)?;
    // There may be many: neither the cycle nor other clients wait for the list.
    let names = tokio::task::spawn_blocking(move || names::list(&image)).await;
    Ok(Json(names.map_err(|_| StatusCode::INTERNAL_SERVER_ERROR)?).into_response())
}

/// Values of the running program may be lost if the query of the request is this word.
fn may_lose(query: &RawQuery) -> bool {
    query.0.as_deref() == Some("lose")
}

/// Changes the program to the one in the body, see [`plcc_runtime::loaded`].
async fn loaded(
    Extension(asked): Extension<Asked>,
    headers: HeaderMap,
    query: RawQuery,
    request: Request,
) -> Result<Response, Response> {
    let loader = loader(&asked, &headers)?;
    // No other client may send so much.
    let body = timeout(PROGRAM_TIME, to_bytes(request.into_body(), PROGRAM_MAX)).await;
    let body = body.map_err(|_| refused(StatusCode::REQUEST_TIMEOUT, "the program took too long to come"))?;
    let body = body.map_err(|_| refused(StatusCode::PAYLOAD_TOO_LARGE, "the program is too large, or was cut"))?;
    let load = move |loader: &Loader| {
        let (image, code) = plcc_runtime::loaded::load(&body)?;
        loader.prepare(image, code)
    };
    change(loader, may_lose(&query), load).await
}

/// Changes the program to the one from before the last change.
async fn restored(
    Extension(asked): Extension<Asked>,
    headers: HeaderMap,
    query: RawQuery,
) -> Result<Response, Response> {
    change(loader(&asked, &headers)?, may_lose(&query), Loader::previous).await
}

fn refused(status: StatusCode, why: &str) -> Response {
    (status, why.to_string()).into_response()
}

/// What loads programs, if this user may do that.
#[allow(clippy::result_large_err, reason = "it is the answer")]
fn loader(Asked { page, most }: &Asked, headers: &HeaderMap) -> Result<Loader, Response> {
    let Some(loader) = page.loader.clone() else {
        return Err(refused(StatusCode::FORBIDDEN, "the program was not started with --allow-load"));
    };
    let (_, role) = page.user(headers).map_err(|status| refused(status, "sign in first, with --user"))?;
    // Without users the page is for this computer only, and the user who started the program has allowed it.
    let may = page.users.is_open() || role.min(*most) >= Role::Change;
    match may && is_own(headers) {
        true => Ok(loader),
        false => {
            Err(refused(StatusCode::FORBIDDEN, "only a user with the role `change` may load, with --access control"))
        }
    }
}

/// 200: the program was changed, with what was new and lost as lines. 409: values would be lost, and which ones; nothing has changed. 422: why
/// it is not possible.
async fn change(
    loader: Loader,
    lose: bool,
    prepare: impl FnOnce(&Loader) -> Result<Prepared, String> + Send + 'static,
) -> Result<Response, Response> {
    // Not on the thread that serves everybody: comparing takes its time.
    let changed = tokio::task::spawn_blocking(move || {
        let impossible = |why| (StatusCode::UNPROCESSABLE_ENTITY, why);
        let prepared = prepare(&loader).map_err(impossible)?;
        let mut lines: Vec<String> = prepared.items().iter().map(|item| item.text.clone()).collect();
        if prepared.loses() && !lose {
            return Err((StatusCode::CONFLICT, lines.join("\n")));
        }
        lines.extend(loader.apply(prepared).map_err(impossible)?);
        Ok(lines.join("\n"))
    });
    match changed.await {
        Ok(Ok(lines)) => Ok(lines.into_response()),
        Ok(Err((status, why))) => Err(refused(status, &why)),
        Err(_) => Err(StatusCode::INTERNAL_SERVER_ERROR.into_response()),
    }
}

/// The places of the probes of a block: `FB1`.
async fn places(
    Extension(Asked { page, .. }): Extension<Asked>,
    headers: HeaderMap,
    Path(block): Path<String>,
) -> Result<Response, StatusCode> {
    page.user(&headers)?;
    let image = page.link.ask(|cpu| cpu.image.clone()).await.ok_or(StatusCode::SERVICE_UNAVAILABLE)?;
    let places = status::places(&image, &block).ok_or(StatusCode::NOT_FOUND)?;
    Ok(Json(places).into_response())
}

async fn about(Extension(Asked { page, .. }): Extension<Asked>, headers: HeaderMap) -> Result<Response, StatusCode> {
    page.user(&headers)?;
    let info = info::info(&page.link, &page.services).await.ok_or(StatusCode::SERVICE_UNAVAILABLE)?;
    Ok(Json(info).into_response())
}

/// The rows of a watch table whose file is in the body. 422: the error with its line.
async fn table_rows(
    Extension(Asked { page, .. }): Extension<Asked>,
    headers: HeaderMap,
    request: Request,
) -> Result<Response, Response> {
    let text = table(&page, &headers, request).await?;
    // The file may be large: not on the thread that serves everybody.
    let read = tokio::task::spawn_blocking(move || Sheet::read(&text)).await;
    match read {
        Ok(Ok(sheet)) => Ok(Json(sheet).into_response()),
        Ok(Err(why)) => Err(refused(StatusCode::UNPROCESSABLE_ENTITY, &why)),
        Err(_) => Err(StatusCode::INTERNAL_SERVER_ERROR.into_response()),
    }
}

/// The file of a watch table whose rows are in the body.
async fn table_file(
    Extension(Asked { page, .. }): Extension<Asked>,
    headers: HeaderMap,
    request: Request,
) -> Result<Response, Response> {
    let text = table(&page, &headers, request).await?;
    let written = tokio::task::spawn_blocking(move || {
        let sheet: Sheet = serde_json::from_str(&text).map_err(|error| error.to_string())?;
        sheet.write()
    });
    match written.await {
        Ok(Ok(text)) => Ok(([(CONTENT_TYPE, "application/toml")], text).into_response()),
        Ok(Err(why)) => Err(refused(StatusCode::UNPROCESSABLE_ENTITY, &why)),
        Err(_) => Err(StatusCode::INTERNAL_SERVER_ERROR.into_response()),
    }
}

/// The names of the watch tables of the project. 404: it has no folder for them.
async fn table_names(
    Extension(Asked { page, .. }): Extension<Asked>,
    headers: HeaderMap,
) -> Result<Response, StatusCode> {
    page.user(&headers)?;
    let tables = page.tables.ok_or(StatusCode::NOT_FOUND)?;
    let names = tokio::task::spawn_blocking(move || tables.names()).await;
    Ok(Json(names.map_err(|_| StatusCode::INTERNAL_SERVER_ERROR)?).into_response())
}

/// The rows of a watch table of the project. 404: there is none with this name; 422: why it cannot be read.
async fn table_read(
    Extension(Asked { page, .. }): Extension<Asked>,
    headers: HeaderMap,
    Path(name): Path<String>,
) -> Result<Response, Response> {
    page.user(&headers).map_err(|status| refused(status, "sign in first"))?;
    let sheet = in_project(page, move |tables| tables.read(&name)).await?;
    Ok(Json(sheet).into_response())
}

/// Writes a watch table of the project, whose rows are in the body.
async fn table_written(
    Extension(Asked { page, most }): Extension<Asked>,
    headers: HeaderMap,
    Path(name): Path<String>,
    request: Request,
) -> Result<Response, Response> {
    let (_, role) = page.user(&headers).map_err(|status| refused(status, "sign in first"))?;
    May { role, most }.check(Role::Operate).map_err(|why| refused(StatusCode::FORBIDDEN, why))?;
    let text = table(&page, &headers, request).await?;
    let write = move |tables: &Tables| {
        let sheet: Sheet = serde_json::from_str(&text).map_err(|error| Wrong::Other(error.to_string()))?;
        tables.write(&name, &sheet)
    };
    in_project(page, write).await?;
    Ok(StatusCode::NO_CONTENT.into_response())
}

/// Reads or writes a file of the project, on another thread than the one that serves all clients.
async fn in_project<T: Send + 'static>(
    page: Page,
    job: impl FnOnce(&Tables) -> Result<T, Wrong> + Send + 'static,
) -> Result<T, Response> {
    let tables = page.tables.ok_or_else(|| {
        refused(StatusCode::NOT_FOUND, "the program was started without --tables, the folder of its watch tables")
    })?;
    match tokio::task::spawn_blocking(move || job(&tables)).await {
        Ok(Ok(done)) => Ok(done),
        Ok(Err(Wrong::Missing(why))) => Err(refused(StatusCode::NOT_FOUND, &why)),
        Ok(Err(Wrong::Other(why))) => Err(refused(StatusCode::UNPROCESSABLE_ENTITY, &why)),
        Err(_) => Err(StatusCode::INTERNAL_SERVER_ERROR.into_response()),
    }
}

/// The body of a request about a watch table, from a user of this page.
async fn table(page: &Page, headers: &HeaderMap, request: Request) -> Result<String, Response> {
    if !is_own(headers) {
        return Err(StatusCode::FORBIDDEN.into_response());
    }
    page.user(headers).map_err(|status| refused(status, "sign in first"))?;
    let body = timeout(FRAME_TIME, to_bytes(request.into_body(), PAGE_MESSAGE_MAX)).await;
    let body = body.map_err(|_| refused(StatusCode::REQUEST_TIMEOUT, "the table took too long to come"))?;
    let most = format!("a table has at most {} KiB", PAGE_MESSAGE_MAX / 1024);
    let body = body.map_err(|_| refused(StatusCode::PAYLOAD_TOO_LARGE, &most))?;
    String::from_utf8(body.into())
        .map_err(|_| refused(StatusCode::UNPROCESSABLE_ENTITY, "the file is not a text in UTF-8"))
}

async fn live(
    Extension(Asked { page, most }): Extension<Asked>,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Result<Response, StatusCode> {
    if !is_own(&headers) {
        return Err(StatusCode::FORBIDDEN);
    }
    let (user, role) = page.user(&headers)?;
    let (users, token) = (page.users.clone(), token(&headers).map(str::to_string));
    let is_signed_in = move || users.of(token.as_deref()).is_some();
    let place = page.places.try_acquire_owned().map_err(|_| StatusCode::SERVICE_UNAVAILABLE)?;
    let serve = async move |socket| {
        session::serve(socket, page.link, user, May { role, most }, is_signed_in).await;
        drop(place);
    };
    Ok(upgrade.max_message_size(PAGE_MESSAGE_MAX).on_upgrade(serve))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_other_hosts_are_not_this_computer() {
        let asked = |host: &str| is_of_this_computer(&HeaderMap::from_iter([(HOST, host.parse().unwrap())]));
        assert!(
            ["localhost:8080", "LOCALHOST", "127.0.0.1:8080", "[::1]:8080", "[::1]"].map(asked).iter().all(|own| *own)
        );
        assert!(["plant.example:8080", "localhost.example", "", "[plant.example]"].map(asked).iter().all(|own| !*own));
        assert!(!is_of_this_computer(&HeaderMap::new()));
    }
}
