//! A connection: tells values as they change, and takes orders.

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use axum::extract::ws::{Message, WebSocket};
use plcc_abi::ProgramImage;
use plcc_abi::services::Role;
use plcc_runtime::cpu::Cpu;
use plcc_runtime::datetime::NS_PER_S;
use plcc_runtime::diagnostics;
use plcc_runtime::monitor::Looked;
use plcc_runtime::monitor::recording::Progress;
use plcc_runtime::options::Restart;
use plcc_runtime::signal::{Source, Value};
use tokio::time::{MissedTickBehavior, interval, timeout};

use super::messages::{Entry, Hello, News, Order, Shown, State};
use super::status::Known;
use super::trace::{PART_MAX, Recorder};
use crate::limits::{ANSWER_TIME, NAME_MAX, WATCHED_MAX};
use crate::link::Link;

/// From one look at the values to the next.
const PERIOD: Duration = Duration::from_millis(100);

/// What a page watches.
#[derive(Clone, Default)]
struct Watched {
    names: Arc<[String]>,
    /// How often the program had changed when the names were looked up.
    generation: u64,
    /// Number in the list of names, and where the value is.
    found: Arc<[(usize, Source)]>,
}

/// What the CPU said at one cycle control point.
struct Seen {
    state: State,
    /// Number in the list of names, value and type. What is shown of them is found out elsewhere: the cycle waits for it.
    values: Vec<(usize, Value, &'static str)>,
    renewed: Option<Renewed>,
    /// The diagnostic buffer, if its newest entry is another one.
    buffer: Option<Vec<diagnostics::Entry>>,
    forced: Vec<(String, String)>,
    /// Number of events so far, as far as the buffer tells.
    newest: Newest,
    /// What the watched block has seen.
    looked: Option<Looked>,
    recording: Option<Progress>,
}

/// What is another since the program has changed.
struct Renewed {
    /// The names have other places.
    watched: Watched,
    /// Why some mean nothing any more.
    wrong: Vec<(usize, String)>,
    image: Arc<ProgramImage>,
}

/// What of the running program a page watches: a block and a call of it.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Target {
    Nothing,
    Block(String, Option<String>),
    /// The runs of organization blocks.
    Obs,
}

/// Tells whether the buffer has changed: number of entries and the newest one.
type Newest = Option<(usize, diagnostics::Entry)>;

/// Serves one page until it goes or the CPU ends.
pub async fn serve(socket: WebSocket, link: Link, user: String, role: Role) {
    static CLIENTS: AtomicU64 = AtomicU64::new(0);
    let client = CLIENTS.fetch_add(1, Ordering::Relaxed);
    let mut recorder = Recorder::new(link.clone(), client);
    tell_all(socket, &link, user, role, client, &mut recorder).await;
    recorder.stop().await;
    // From now on the code without probes runs, if nobody else watches.
    link.ask(move |cpu| cpu.unwatch_block(client)).await;
}

async fn tell_all(mut socket: WebSocket, link: &Link, user: String, role: Role, client: u64, recorder: &mut Recorder) {
    let Some(mut image) = link.ask(|cpu| cpu.image.clone()).await else { return };
    let mut target = Target::Nothing;
    let mut known_status = Known::default();
    let Some(hello) = link.ask(move |cpu| hello(cpu, user, role)).await else { return };
    if tell(&mut socket, &News { hello: Some(hello), ..News::default() }).await.is_none() {
        return;
    }
    let mut watched = Watched::default();
    let mut known = HashMap::new();
    let mut state = State::default();
    let mut forced = Vec::new();
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
                    Ok(Order::Watch { names }) => {
                        let program = Arc::clone(&image);
                        let found = tokio::task::spawn_blocking(move || find(&program, &names));
                        let Ok(found) = found.await else { return };
                        let program = Arc::clone(&image);
                        let Some((found, wrong)) = link.ask(move |cpu| found.of(cpu, &program)).await else { return };
                        watched = found;
                        known.clear();
                        News { wrong, ..News::default() }
                    }
                    Ok(order @ (Order::Status { .. } | Order::Obs)) => {
                        let wanted = match order {
                            Order::Status { block: Some(block), call } => Target::Block(block, call),
                            Order::Obs => Target::Obs,
                            _ => Target::Nothing,
                        };
                        known_status = Known::default();
                        target = wanted.clone();
                        let Some(done) = link.ask(move |cpu| watch_program(cpu, client, &wanted)).await else { return };
                        if done.is_err() {
                            target = Target::Nothing;
                        }
                        News { refused: done.err(), ..News::default() }
                    }
                    Ok(Order::Trace(wanted)) => News { refused: recorder.start(wanted).await.err(), ..News::default() },
                    Ok(order) => {
                        let Some(refused) = carry_out(link, order, role).await else { return };
                        News { refused, ..News::default() }
                    }
                    Err(error) => News { refused: Some(format!("not understood: {error}")), ..News::default() },
                };
                if (news.refused.is_some() || !news.wrong.is_empty()) && tell(&mut socket, &news).await.is_none() {
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
                    known_status = Known::default();
                }
                news.buffer = seen.buffer.map(|entries| entries.iter().map(|one| entry(&image, one)).collect());
                if let (Some(looked), Target::Block(block, _)) = (seen.looked, &target) {
                    news.status = known_status.news(&image, block, looked);
                }
                news.trace = recorder.news(seen.recording);
                for (number, value, ty) in seen.values {
                    let shown = Shown { value: value.json(), text: value.text(), ty };
                    if known.get(&number) != Some(&shown) {
                        known.insert(number, shown.clone());
                        news.values.push((number, shown));
                    }
                }
                if seen.forced != forced {
                    forced = seen.forced.clone();
                    news.forced = Some(seen.forced);
                }
                if seen.state != state {
                    state = seen.state.clone();
                    news.state = Some(seen.state);
                }
                let has_values = !(news.values.is_empty() && news.wrong.is_empty());
                let is_news = has_values || news.state.is_some() || news.buffer.is_some() || news.forced.is_some()
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

fn hello(cpu: &Cpu, user: String, role: Role) -> Hello {
    let watchable = cpu.probes().is_some();
    Hello { program: cpu.image.name.clone(), cpu: cpu.image.profile.name.clone(), user, role, watchable }
}

/// Names that were looked up in a program.
struct Found {
    names: Arc<[String]>,
    /// One for each name, up to as many as a page can watch.
    sources: Vec<Result<Source, String>>,
}

/// Looks names up, which takes its time when there are many.
fn find(image: &ProgramImage, names: &[String]) -> Found {
    let mut sources: Vec<_> = names.iter().take(WATCHED_MAX).map(|name| source_in(image, name)).collect();
    if names.len() > WATCHED_MAX {
        sources.push(Err(format!("a page can watch {WATCHED_MAX} values")));
    }
    Found { names: names.into(), sources }
}

impl Found {
    /// The values, and why others mean nothing. `image`: where the names were looked up.
    fn of(self, cpu: &Cpu, image: &Arc<ProgramImage>) -> (Watched, Vec<(usize, String)>) {
        if !Arc::ptr_eq(image, &cpu.image) {
            // The program has changed meanwhile.
            return find(&cpu.image, &self.names).of(cpu, &cpu.image);
        }
        let (mut found, mut wrong) = (Vec::new(), Vec::new());
        for (number, source) in self.sources.into_iter().enumerate() {
            match source.and_then(|source| source.check(cpu).map(|()| source)) {
                Ok(source) => found.push((number, source)),
                Err(error) => wrong.push((number, error)),
            }
        }
        (Watched { names: self.names, generation: cpu.generation(), found: found.into() }, wrong)
    }
}

fn source_in(image: &ProgramImage, name: &str) -> Result<Source, String> {
    if name.len() > NAME_MAX {
        return Err(format!("a name has at most {NAME_MAX} letters"));
    }
    Source::find(name, image, None)
}

pub fn source(cpu: &Cpu, name: &str) -> Result<Source, String> {
    let source = source_in(&cpu.image, name)?;
    source.check(cpu)?;
    Ok(source)
}

/// All that a page wants to know, of one cycle.
fn look(cpu: &Cpu, watched: &Watched, before: Newest, client: u64, target: &Target, asked: Option<usize>) -> Seen {
    let looked = if *target == Target::Nothing { None } else { cpu.look_at_block(client) };
    if looked.is_none() && *target != Target::Nothing {
        // The CPU was restarted, or its program changed.
        let _ = watch_program(cpu, client, target);
    }
    let recording = asked.and_then(|told| cpu.recorded(client, told, PART_MAX));
    let renewed = (cpu.generation() != watched.generation).then(|| {
        let (watched, wrong) = find(&cpu.image, &watched.names).of(cpu, &cpu.image);
        Renewed { watched, wrong, image: cpu.image.clone() }
    });
    let watched = renewed.as_ref().map_or(watched, |renewed| &renewed.watched);
    let values = watched.found.iter().map(|(number, source)| (*number, source.read(cpu, None), source.ty())).collect();
    let entries = cpu.diagnostics.newest_first();
    let newest = entries.first().map(|entry| (entries.len(), *entry));
    let buffer = (newest != before).then_some(entries);
    let forced = match cpu.is_forcing() {
        true => cpu.forced().into_iter().map(|one| (one.name, one.value)).collect(),
        false => Vec::new(),
    };
    Seen { state: state(cpu), values, renewed, buffer, forced, newest, looked, recording }
}

/// Begins or ends to watch the running program.
fn watch_program(cpu: &Cpu, client: u64, target: &Target) -> Result<(), String> {
    match target {
        Target::Block(block, call) => return cpu.watch_block(client, block, call.as_deref()),
        Target::Obs => cpu.watch_obs(client),
        Target::Nothing => cpu.unwatch_block(client),
    }
    Ok(())
}

fn state(cpu: &Cpu) -> State {
    let reason = cpu.stopped().map(|stop| diagnostics::event_text(&cpu.image, &stop.entry));
    State {
        running: !cpu.is_stopped(),
        reason: reason.unwrap_or_default(),
        cycle: cpu.cycle_number(),
        generation: cpu.generation(),
        clock: milliseconds(cpu.clock.wall()),
    }
}

fn entry(image: &ProgramImage, entry: &diagnostics::Entry) -> Entry {
    Entry {
        clock: milliseconds(entry.wall),
        event: entry.event,
        text: diagnostics::event_text(image, entry),
        place: diagnostics::place_text(image, entry),
    }
}

/// A moment of the CPU's clock in milliseconds, as a page computes with it.
fn milliseconds(wall: i64) -> f64 {
    wall as f64 / (NS_PER_S / 1000) as f64
}

/// Result: why an order was refused, if it was. `None`: the CPU has ended.
async fn carry_out(link: &Link, order: Order, role: Role) -> Option<Option<String>> {
    let needed = match order {
        Order::Watch { .. } | Order::Status { .. } | Order::Obs | Order::Trace(_) => Role::Look,
        Order::Modify { .. } => Role::Operate,
        // It outlasts the connection: a right to write programs, not values. Source: CPU manuals, protection levels.
        Order::Force { .. } | Order::Unforce { .. } | Order::Stop | Order::Run { .. } => Role::Change,
    };
    if role < needed {
        return Some(Some(match needed {
            Role::Change => "only a user with the role `change` may do this".to_string(),
            Role::Operate | Role::Look => "only a user with the role `operate` or `change` may do this".to_string(),
        }));
    }
    let done = link.ask(move |cpu| match order {
        Order::Watch { .. } | Order::Status { .. } | Order::Obs | Order::Trace(_) => Ok(()),
        Order::Modify { name, value } => modify(cpu, &name, &value),
        Order::Force { name, value } if name.len() > NAME_MAX || value.len() > NAME_MAX => {
            Err(format!("a name and a value have at most {NAME_MAX} letters"))
        }
        Order::Force { name, value } => cpu.force(&name, &value),
        Order::Unforce { name } => cpu.unforce(name.as_deref()),
        Order::Stop => {
            cpu.stop_by_request();
            Ok(())
        }
        Order::Run { restart } => run(cpu, &restart),
    });
    Some(done.await?.err())
}

fn modify(cpu: &Cpu, name: &str, value: &str) -> Result<(), String> {
    let source = source(cpu, name)?;
    if let Some(address) = source.address()
        && let plcc_runtime::address::Place::Db(number, _) = address.place
        && cpu.is_read_only(number)
    {
        return Err(format!("DB {number} is write-protected"));
    }
    let value = source.parse(value, &cpu.image)?;
    source.write(cpu, &value)
}

fn run(cpu: &Cpu, restart: &str) -> Result<(), String> {
    let kind = match restart {
        "warm" => Restart::Warm,
        "cold" => Restart::Cold,
        _ => return Err(format!("`{restart}` is not a restart: warm or cold")),
    };
    if !cpu.is_stopped() {
        return Err("the CPU is in RUN".to_string());
    }
    match cpu.request_restart(kind) {
        true => Ok(()),
        false => Err(format!("a {restart} restart is not possible")),
    }
}
