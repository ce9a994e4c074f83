//! A connection: tells values as they change, and takes orders.

use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use axum::extract::ws::{Message, WebSocket};
use plcc_abi::ProgramImage;
use plcc_abi::image::Family;
use plcc_abi::services::Role;
use plcc_runtime::address::Place;
use plcc_runtime::cpu::Cpu;
use plcc_runtime::datetime::NS_PER_S;
use plcc_runtime::monitor::Looked;
use plcc_runtime::monitor::recording::Progress;
use plcc_runtime::options::Restart;
use plcc_runtime::signal::{Source, Value};
use plcc_runtime::watch::Settled;
use plcc_runtime::watch::format::Format;
use plcc_runtime::{diagnostics, force, modify, typed};
use tokio::time::{MissedTickBehavior, interval, timeout};

use super::messages::{Change, Entry, Forced, Hello, JobRow, News, Order, Shown, State, exact};
use super::status::Known;
use super::trace::{PART_MAX, Recorder};
use super::users::May;
use crate::limits::{ANSWER_TIME, MODIFIED_LETTERS_MAX, MODIFIED_MAX, NAME_MAX, WATCHED_MAX};
use crate::link::Link;

/// From one look at the values to the next.
const PERIOD: Duration = Duration::from_millis(100);

/// What a page watches.
#[derive(Clone, Default)]
struct Watched {
    wanted: Wanted,
    /// How often the program had changed when the names were looked up.
    generation: u64,
    /// Number in the list of names, where the value is, and its format.
    found: Arc<[(usize, Source, Option<Format>)]>,
}

/// Names, and their formats if those are not the usual ones.
#[derive(Clone, Default)]
struct Wanted {
    names: Arc<[String]>,
    formats: Arc<[Option<Format>]>,
}

/// What the CPU said at one cycle control point.
struct Seen {
    state: State,
    /// Place in the list of what was found, and value. What is shown of them is found out elsewhere: the cycle waits for it.
    values: Vec<(usize, Value)>,
    renewed: Option<Renewed>,
    /// The diagnostic buffer, if its newest entry is another one.
    buffer: Option<Vec<diagnostics::Entry>>,
    forced: Vec<force::Forced>,
    /// Values that the job of the page still writes.
    job: usize,
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
    // From now on the code without probes runs, if nobody else watches.
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

/// Numbers of the names that have forced bits.
fn marks(image: &ProgramImage, watched: &Watched, forced: Option<&[force::Forced]>) -> Vec<usize> {
    let Some(forced) = forced.filter(|forced| !forced.is_empty()) else { return Vec::new() };
    let modules = image.profile.family != Family::S7300;
    let is_forced =
        |source: &Source| source.address().is_some_and(|address| forced.iter().any(|one| one.covers(address, modules)));
    watched.found.iter().filter(|(_, source, _)| is_forced(source)).map(|(number, ..)| *number).collect()
}

/// A value in the format of its row.
fn shown(family: Family, source: &Source, format: Option<Format>, value: &Value) -> Shown {
    let bits = match source {
        Source::Bits(address) => address.width.bits(),
        Source::Typed(address, ty) if typed::bits(ty.ty).is_some() => address.width.bits(),
        Source::Typed(..)
        | Source::Channel(..)
        | Source::Plant(_)
        | Source::PulseDuty(_)
        | Source::PulsePeriod(_)
        | Source::PulseCount(_) => 0,
    };
    let (value, text) = match (format, value) {
        // The value stays what the type says: curves and drawings are of that.
        (Some(format), Value::Bits(raw, width)) => {
            let typed = match source {
                Source::Typed(_, ty) => Value::of_type(ty.ty, *raw),
                _ => value.clone(),
            };
            let text = match source.address() {
                Some(address) => format.show_at(*raw, address),
                None => format.show(*raw, *width),
            };
            (typed.json(), text)
        }
        _ => (value.json(), value.text()),
    };
    let forcible = source.address().is_some_and(|address| force::is_forced_area(address.place, family));
    Shown { value: exact(value), text, ty: source.ty(), bits, forcible }
}

/// Names that were looked up in a program.
struct Found {
    wanted: Wanted,
    /// One for each name, up to as many as a page can watch.
    sources: Vec<Result<(Source, Option<Format>), String>>,
}

/// Looks names up, which takes its time when there are many.
fn find(image: &ProgramImage, wanted: Wanted) -> Found {
    let formats = wanted.formats.iter().copied().chain(std::iter::repeat(None));
    let named = |(name, format): (&String, Option<Format>)| {
        let source = source_in(image, name)?;
        let format = format.map(|format| match source {
            Source::Bits(address) | Source::Typed(address, _) => format.check(name, &source, address.width),
            Source::Channel(..)
            | Source::Plant(_)
            | Source::PulseDuty(_)
            | Source::PulsePeriod(_)
            | Source::PulseCount(_) => Err(format!("{name} is a number with a unit: leave the format out")),
        });
        Ok((source, format.transpose()?))
    };
    let mut sources: Vec<_> = wanted.names.iter().take(WATCHED_MAX).zip(formats).map(named).collect();
    if wanted.names.len() > WATCHED_MAX {
        sources.push(Err(format!("a page can watch {WATCHED_MAX} values")));
    }
    Found { wanted, sources }
}

impl Found {
    /// The values, and why others mean nothing. `image`: where the names were looked up.
    fn of(self, cpu: &Cpu, image: &Arc<ProgramImage>) -> (Watched, Vec<(usize, String)>) {
        if !Arc::ptr_eq(image, &cpu.image) {
            // The program has changed meanwhile.
            return find(&cpu.image, self.wanted).of(cpu, &cpu.image);
        }
        let (mut found, mut wrong) = (Vec::new(), Vec::new());
        for (number, source) in self.sources.into_iter().enumerate() {
            match source.and_then(|found| found.0.check(cpu).map(|()| found)) {
                Ok((source, format)) => found.push((number, source, format)),
                Err(error) => wrong.push((number, error)),
            }
        }
        (Watched { wanted: self.wanted, generation: cpu.generation(), found: found.into() }, wrong)
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
        let (watched, wrong) = find(&cpu.image, watched.wanted.clone()).of(cpu, &cpu.image);
        Renewed { watched, wrong, image: cpu.image.clone() }
    });
    let watched = renewed.as_ref().map_or(watched, |renewed| &renewed.watched);
    let value = |(place, (_, source, format)): (usize, &(usize, Source, Option<Format>))| {
        let value = match (format, source.address()) {
            (Some(_), Some(address)) => Value::Bits(cpu.read(address), address.width),
            _ => source.read(cpu, None),
        };
        (place, value)
    };
    let values = watched.found.iter().enumerate().map(value).collect();
    let entries = cpu.diagnostics.newest_first();
    let newest = entries.first().map(|entry| (entries.len(), *entry));
    let buffer = (newest != before).then_some(entries);
    let forced = if cpu.is_forcing() { cpu.forced() } else { Vec::new() };
    let job = cpu.job_rows(client);
    Seen { state: state(cpu), values, renewed, buffer, forced, job, newest, looked, recording }
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
        outputs: cpu.has_enabled_outputs(),
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

/// What a value is to be, found and read, as far as that needs no CPU.
enum Changed {
    /// A place in memory and its bits.
    Settled(Settled),
    /// A text, a number with a unit.
    Value(Source, Value),
}

impl Changed {
    fn of(change: &Change, image: &ProgramImage) -> Result<Changed, String> {
        check_length(&change.name, &change.value)?;
        if change.format.is_some() {
            let settled = Settled::find(&change.name, &change.value, change.format, image);
            return settled.map(Changed::Settled).map_err(|why| named(&change.name, &why));
        }
        let source = source_in(image, &change.name)?;
        let value = source.parse(&change.value, image).map_err(|why| named(&change.name, &why))?;
        Ok(Changed::Value(source, value))
    }

    fn check(&self, cpu: &Cpu) -> Result<(), String> {
        match self {
            Changed::Settled(settled) => cpu.check_modifiable(settled),
            Changed::Value(source, _) => {
                source.check(cpu)?;
                source.check_settable()?;
                if let Some(address) = source.address() {
                    cpu.check_enabled(address.place)?;
                }
                match source.address().map(|address| address.place) {
                    Some(Place::Db(number, _)) if cpu.is_read_only(number) => {
                        Err(format!("DB {number} is write-protected"))
                    }
                    _ => Ok(()),
                }
            }
        }
    }

    fn write(&self, cpu: &Cpu) -> Result<(), String> {
        match self {
            Changed::Settled(settled) => cpu.write(&settled.address, settled.bits),
            Changed::Value(source, value) => source.write(cpu, value),
        }
    }
}

/// A message about a value says whose it is.
fn named(name: &str, why: &str) -> String {
    if why.contains(name) { why.to_string() } else { format!("{name}: {why}") }
}

fn check_length(name: &str, value: &str) -> Result<(), String> {
    match name.len() > NAME_MAX || value.len() > NAME_MAX {
        true => Err(format!("a name and a value have at most {NAME_MAX} letters")),
        false => Ok(()),
    }
}

/// What an order asks of the CPU at the cycle control point.
type Act = Box<dyn FnOnce(&Cpu) -> Result<(), String> + Send>;

/// Does what an order needs before the CPU is asked: names are looked up and values read here, not in the cycle.
fn prepare(order: Order, client: u64, image: &Arc<ProgramImage>) -> Result<Act, String> {
    let program = Arc::clone(image);
    // Places are those of the program in which they were looked up.
    let is_same = move |cpu: &Cpu| match Arc::ptr_eq(&program, &cpu.image) {
        true => Ok(()),
        false => Err("the program has changed meanwhile: try again".to_string()),
    };
    let all = |rows: Vec<Change>| -> Result<Act, String> {
        if rows.len() > MODIFIED_MAX || rows.iter().map(|row| row.value.len()).sum::<usize>() > MODIFIED_LETTERS_MAX {
            return Err(format!(
                "{MODIFIED_MAX} values of {MODIFIED_LETTERS_MAX} letters in all can be modified at once"
            ));
        }
        let changed = rows.iter().map(|row| Changed::of(row, image)).collect::<Result<Vec<_>, _>>()?;
        let is_same = is_same.clone();
        Ok(Box::new(move |cpu| {
            is_same(cpu)?;
            cpu.for_client(client, || {
                changed.iter().try_for_each(|one| one.check(cpu))?;
                changed.iter().try_for_each(|one| one.write(cpu))
            })
        }))
    };
    let act: Act = match order {
        Order::Watch { .. } | Order::Status { .. } | Order::Obs | Order::Trace(_) => Box::new(|_| Ok(())),
        Order::Modify(change) => all(vec![change])?,
        Order::All { rows } => all(rows)?,
        Order::Job { rows } => {
            // Before anything is looked up.
            if rows.len() > modify::ROWS_MAX {
                return Err(format!("{} values can be modified in the cycle", modify::ROWS_MAX));
            }
            let row = |row: &JobRow| {
                check_length(&row.name, &row.value)?;
                let settled = Settled::find(&row.name, &row.value, row.format, image);
                let settled = settled.map_err(|why| named(&row.name, &why))?;
                Ok::<_, String>(modify::Row { settled, trigger: row.trigger, every_cycle: row.every })
            };
            let rows = rows.iter().map(row).collect::<Result<Vec<_>, _>>()?;
            Box::new(move |cpu| {
                is_same(cpu)?;
                cpu.begin_job(client, rows)
            })
        }
        Order::Force(change) => {
            check_length(&change.name, &change.value)?;
            Box::new(move |cpu| cpu.force_as(&change.name, &change.value, change.format))
        }
        Order::Unforce { name } => Box::new(move |cpu| cpu.unforce(name.as_deref())),
        Order::Stop => Box::new(|cpu| {
            cpu.stop_by_request();
            Ok(())
        }),
        Order::Outputs { enable: true } => Box::new(move |cpu| cpu.enable_outputs(client)),
        // Whoever has enabled them: it is the safe side.
        Order::Outputs { enable: false } => Box::new(|cpu| {
            cpu.end_enabling();
            Ok(())
        }),
        Order::Reset => Box::new(Cpu::request_memory_reset),
        Order::Run { restart } => Box::new(move |cpu| run(cpu, &restart)),
    };
    Ok(act)
}

/// Result: why an order was refused, if it was. `None`: the CPU has ended.
async fn carry_out(
    link: &Link,
    order: Order,
    may: May,
    client: u64,
    image: &Arc<ProgramImage>,
) -> Option<Option<String>> {
    let needed = match order {
        Order::Watch { .. } | Order::Status { .. } | Order::Obs | Order::Trace(_) => Role::Look,
        Order::Modify(_) | Order::All { .. } | Order::Job { .. } => Role::Operate,
        // It outlasts the connection: a right to write programs, not values. Source: CPU manuals, protection levels.
        Order::Force(_)
        | Order::Unforce { .. }
        | Order::Stop
        | Order::Outputs { .. }
        | Order::Reset
        | Order::Run { .. } => Role::Change,
    };
    if let Err(why) = may.check(needed) {
        return Some(Some(why.to_string()));
    }
    let program = Arc::clone(image);
    let prepared = tokio::task::spawn_blocking(move || prepare(order, client, &program)).await.ok()?;
    match prepared {
        Ok(act) => Some(link.ask(act).await?.err()),
        Err(why) => Some(Some(why)),
    }
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
