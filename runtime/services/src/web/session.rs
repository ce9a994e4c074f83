//! A connection: tells values as they change, and takes orders.
//!
//! - [`watched`]: the values that the page watches.
//! - [`look`]: what the CPU says at one cycle control point.
//! - [`orders`]: what the page orders.

mod look;
mod orders;
mod watched;

pub(super) use watched::source;

use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use axum::extract::ws::{Message, WebSocket};
use plcc_abi::image::Family;
use plcc_runtime::cpu::Cpu;
use plcc_runtime::force;
use tokio::time::{MissedTickBehavior, interval, timeout};

use look::{Target, entry, look, watch_program};
use orders::carry_out;
use watched::{Wanted, Watched, find, marks, shown};

use super::messages::{Forced, Hello, News, Order, State};
use super::status::Known;
use super::trace::Recorder;
use super::users::May;
use crate::limits::ANSWER_TIME;
use crate::link::Link;

/// From one look at the values to the next.
const PERIOD: Duration = Duration::from_millis(100);

/// Serves one page until it goes, its user signs out or the CPU ends.
pub async fn serve(socket: WebSocket, link: Link, user: String, may: May, is_signed_in: impl Fn() -> bool + Send) {
    static CLIENTS: AtomicU64 = AtomicU64::new(0);
    let client = CLIENTS.fetch_add(1, Ordering::Relaxed);
    let mut recorder = Recorder::new(link.clone(), client);
    tokio::select! {
        () = tell_all(socket, &link, user, may, client, &mut recorder) => {}
        () = signed_out(is_signed_in) => {}
    }
    recorder.stop().await;
    // The code without probes runs next, if no other client watches.
    let left = link.ask(move |cpu| {
        cpu.unwatch_block(client);
        cpu.disable_outputs(client);
        let _ = cpu.begin_job(client, Vec::new());
    });
    left.await;
}

/// Until the user has signed out, here or in another window.
async fn signed_out(is_signed_in: impl Fn() -> bool) {
    let mut tick = interval(PERIOD);
    while is_signed_in() {
        tick.tick().await;
    }
}

async fn tell_all(mut socket: WebSocket, link: &Link, user: String, may: May, client: u64, recorder: &mut Recorder) {
    let Some(mut image) = link.ask(|cpu| cpu.image.clone()).await else { return };
    let mut target = Target::Nothing;
    let mut known_status = Known::default();
    let Some(hello) = link.ask(move |cpu| hello(cpu, user, may)).await else { return };
    if tell(&mut socket, &News { hello: Some(hello), ..News::default() }).await.is_none() {
        return;
    }
    let mut watched = Watched::default();
    let mut known = HashMap::new();
    let mut state = State::default();
    let mut forced: Option<Vec<force::Forced>> = None;
    let (mut marked, mut job, mut lists) = (Vec::new(), 0, 0);
    let mut newest = None;
    let mut tick = interval(PERIOD);
    // After a pause the page wants the newest values, not all that were missed.
    tick.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        tokio::select! {
            received = socket.recv() => {
                let text = match received {
                    Some(Ok(Message::Text(text))) => text,
                    Some(Ok(Message::Ping(_) | Message::Pong(_))) => continue,
                    Some(Ok(Message::Binary(_) | Message::Close(_)) | Err(_)) | None => return,
                };
                let news = match serde_json::from_str(&text) {
                    Ok(Order::Watch { names, formats }) => {
                        let program = Arc::clone(&image);
                        let wanted = Wanted { names: names.into(), formats: formats.into() };
                        let found = tokio::task::spawn_blocking(move || find(&program, wanted));
                        let Ok(found) = found.await else { return };
                        let program = Arc::clone(&image);
                        let Some((found, wrong)) = link.ask(move |cpu| found.of(cpu, &program)).await else { return };
                        watched = found;
                        lists += 1;
                        known.clear();
                        marked = marks(&image, &watched, forced.as_deref());
                        News { list: Some(lists), wrong, marked: Some(marked.clone()), ..News::default() }
                    }
                    Ok(order @ (Order::Status { .. } | Order::Obs)) => {
                        let turn = if let Order::Status { turn, .. } = order { turn } else { 0 };
                        let wanted = match order {
                            Order::Status { block: Some(block), call, .. } => Target::Block(block, call),
                            Order::Obs => Target::Obs,
                            _ => Target::Nothing,
                        };
                        known_status = Known::since(turn);
                        target = wanted.clone();
                        let Some(done) = link.ask(move |cpu| watch_program(cpu, client, &wanted)).await else { return };
                        if done.is_err() {
                            target = Target::Nothing;
                        }
                        News { refused: done.err(), ..News::default() }
                    }
                    Ok(Order::Trace(wanted)) => News { refused: recorder.start(wanted).await.err(), ..News::default() },
                    Ok(order) => {
                        let Some(refused) = carry_out(link, order, may, client, &image).await else { return };
                        News { refused, ..News::default() }
                    }
                    Err(error) => News { refused: Some(format!("not understood: {error}")), ..News::default() },
                };
                if (news.refused.is_some() || news.marked.is_some()) && tell(&mut socket, &news).await.is_none() {
                    return;
                }
            }
            _ = tick.tick() => {
                let (list, before, wanted) = (watched.clone(), newest, target.clone());
                let asked = recorder.asked();
                let looked = link.ask(move |cpu| look(cpu, &list, before, client, &wanted, asked));
                let Some(seen) = looked.await else { return };
                newest = seen.newest;
                let mut news = News::default();
                if let Some(renewed) = seen.renewed {
                    (watched, news.wrong, image) = (renewed.watched, renewed.wrong, renewed.image);
                    known.clear();
                    known_status.forget();
                }
                news.buffer = seen.buffer.map(|entries| entries.iter().map(|one| entry(&image, one)).collect());
                if let (Some(looked), Target::Block(block, _)) = (seen.looked, &target) {
                    news.status = known_status.news(&image, block, looked);
                }
                news.trace = recorder.news(seen.recording);
                for (place, value) in seen.values {
                    let Some((number, source, format)) = watched.found.get(place) else { continue };
                    let (number, shown) = (*number, shown(image.profile.family, source, *format, &value));
                    if known.get(&number) != Some(&shown) {
                        known.insert(number, shown.clone());
                        news.values.push((number, shown));
                    }
                }
                if forced.as_ref() != Some(&seen.forced) {
                    news.forced = Some(seen.forced.iter().map(forced_of).collect());
                    forced = Some(seen.forced);
                }
                if news.forced.is_some() || !news.wrong.is_empty() {
                    let now = marks(&image, &watched, forced.as_deref());
                    if now != marked {
                        news.marked = Some(now.clone());
                        marked = now;
                    }
                }
                if seen.job != job {
                    job = seen.job;
                    news.job = Some(job);
                }
                if seen.state != state {
                    state = seen.state.clone();
                    news.state = Some(seen.state);
                }
                let has_values = !(news.values.is_empty() && news.wrong.is_empty() && news.marked.is_none());
                news.list = has_values.then_some(lists);
                let is_news = has_values || news.state.is_some() || news.buffer.is_some() || news.forced.is_some() || news.job.is_some()
                    || news.status.is_some() || news.trace.is_some();
                if is_news && tell(&mut socket, &news).await.is_none() {
                    return;
                }
            }
        }
    }
}

/// `None`: the page is gone or too slow.
async fn tell(socket: &mut WebSocket, news: &News) -> Option<()> {
    let text = serde_json::to_string(news).ok()?;
    timeout(ANSWER_TIME, socket.send(Message::Text(text.into()))).await.ok()?.ok()
}

fn hello(cpu: &Cpu, user: String, may: May) -> Hello {
    static STARTED: OnceLock<String> = OnceLock::new();
    let now = || {
        SystemTime::now().duration_since(UNIX_EPOCH).map_or_else(|_| String::new(), |now| now.as_nanos().to_string())
    };
    let family = cpu.image.profile.family;
    Hello {
        started: STARTED.get_or_init(now).clone(),
        program: cpu.image.name.clone(),
        cpu: cpu.image.profile.name.clone(),
        user,
        role: may.role(),
        limited: may.is_limited(),
        watchable: cpu.probes().is_some(),
        force_max: force::count_max(family),
        force_modules: family != Family::S7300,
        force_areas: match family {
            Family::S7200 => "I and Q; of M, V, AI and AQ at most",
            Family::S7300 => "I and Q of the process image; at most",
            Family::S7400 => "I, Q, PI, PQ and M; at most",
            Family::S71200 | Family::S71500 => "inputs and outputs at their modules; at most",
        },
        has_cold: family.has_cold_restart(),
        has_reset: family != Family::S7200,
    }
}

fn forced_of(one: &force::Forced) -> Forced {
    Forced {
        name: one.name.clone(),
        value: one.text(),
        address: one.address(),
        format: one.format(),
        comment: one.comment.clone(),
    }
}
