//! The thread of a device: it asks and writes in turn, for as long as the process runs, and shares nothing with the CPU but [`Shared`].

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use plcc_abi::remote::{RemoteChannel, RemoteStation};

use super::data;
use super::frame::{self, Answer};
use super::line::Line;

/// From one attempt to reach a device to the next, at least.
const AGAIN_MIN: Duration = Duration::from_millis(250);

/// A channel between the thread and the CPU.
pub struct Exchanged {
    /// As the CPU has them: of inputs what came last, of outputs what is to be sent.
    pub bytes: Vec<u8>,
    /// The device refuses the request, with this code.
    pub refused: Option<u8>,
}

/// What the thread and the CPU share.
pub struct Shared {
    pub channels: Vec<Exchanged>,
    /// The last exchange was complete.
    pub online: bool,
    /// Complete exchanges, and attempts.
    pub exchanges: u64,
    pub attempts: u64,
    /// Why the device is away.
    pub error: String,
    /// The thread is to end, and has ended.
    end: bool,
    ended: bool,
}

/// The thread with what it shares.
pub struct Station {
    pub shared: Arc<(Mutex<Shared>, Condvar)>,
    thread: Option<JoinHandle<()>>,
}

/// After a panic in the thread, its last state serves as well as any.
fn lock(shared: &Mutex<Shared>) -> MutexGuard<'_, Shared> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Station {
    /// Starts the thread. Outputs have their substitute values first.
    pub fn start(config: &RemoteStation) -> std::io::Result<Station> {
        let channels = config.channels.iter().map(|channel| {
            let mut bytes = vec![0; channel.bytes() as usize];
            data::substitute(channel, &mut bytes);
            Exchanged { bytes, refused: None }
        });
        let shared = Shared {
            channels: channels.collect(),
            online: false,
            exchanges: 0,
            attempts: 0,
            error: String::new(),
            end: false,
            ended: false,
        };
        let shared = Arc::new((Mutex::new(shared), Condvar::new()));
        let (of_thread, config) = (shared.clone(), config.clone());
        let name = format!("io {}", config.name);
        let work = move || {
            run(&config, &of_thread);
            lock(&of_thread.0).ended = true;
            of_thread.1.notify_all();
        };
        let thread = std::thread::Builder::new().name(name).spawn(work)?;
        Ok(Station { shared, thread: Some(thread) })
    }

    /// What is shared, unless the thread works with it at this moment.
    pub fn try_shared(&self) -> Option<MutexGuard<'_, Shared>> {
        self.shared.0.try_lock().ok()
    }

    /// What is shared. The thread holds it only to copy.
    pub fn shared(&self) -> MutexGuard<'_, Shared> {
        lock(&self.shared.0)
    }

    /// Waits until the device was asked once, at most until `deadline`.
    pub fn wait_for_attempt(&self, deadline: Instant) {
        self.wait(deadline, |state| state.attempts > 0);
    }

    /// The thread is to write the last outputs and to end.
    pub fn end(&self) {
        self.shared().end = true;
        self.shared.1.notify_all();
    }

    /// Waits until the thread has ended, at most until `deadline`.
    pub fn wait_for_end(&self, deadline: Instant) {
        self.wait(deadline, |state| state.ended);
    }

    fn wait(&self, deadline: Instant, done: impl Fn(&Shared) -> bool) {
        let (shared, changed) = &*self.shared;
        let mut state = lock(shared);
        while !done(&state) {
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return;
            }
            state =
                changed.wait_timeout(state, left).map_or_else(|poisoned| poisoned.into_inner().0, |(state, _)| state);
        }
    }
}

impl Drop for Station {
    fn drop(&mut self) {
        self.end();
        // A device that does not answer may hold its thread for longer, which then ends with the process.
        let ended = self.shared().ended;
        if let Some(thread) = self.thread.take().filter(|_| ended) {
            // It has nothing to say.
            let _ = thread.join();
        }
    }
}

fn run(config: &RemoteStation, shared: &(Mutex<Shared>, Condvar)) {
    let timeout = Duration::from_millis(config.timeout_ms.into());
    let poll = Duration::from_millis(config.poll_ms.into());
    let mut line = None;
    loop {
        let begin = Instant::now();
        let result = exchange(config, timeout, &mut line, &shared.0);
        let mut state = lock(&shared.0);
        state.attempts += 1;
        state.online = result.is_ok();
        let pause = match result {
            Ok(()) => {
                state.exchanges += 1;
                poll
            }
            Err(error) => {
                state.error = error;
                line = None;
                poll.max(AGAIN_MIN)
            }
        };
        shared.1.notify_all();
        while !state.end {
            let left = (begin + pause).saturating_duration_since(Instant::now());
            if left.is_zero() {
                break;
            }
            let waited = shared.1.wait_timeout(state, left);
            state = waited.map_or_else(|poisoned| poisoned.into_inner().0, |(state, _)| state);
        }
        if state.end {
            drop(state);
            // The last outputs.
            if line.is_some() {
                let _ = write(config, timeout, &mut line, &shared.0);
            }
            return;
        }
    }
}

/// Writes all outputs and reads all inputs. `Err`: the device is away.
fn exchange(
    config: &RemoteStation,
    timeout: Duration,
    line: &mut Option<Line>,
    shared: &Mutex<Shared>,
) -> Result<(), String> {
    if line.is_none() {
        *line = Some(Line::open(&config.line, timeout)?);
    }
    write(config, timeout, line, shared)?;
    for (index, channel) in config.channels.iter().enumerate().filter(|(_, channel)| !channel.output) {
        let request = frame::read_request(channel);
        let sent = ask(config, timeout, line, channel, &request)?;
        let mut state = lock(shared);
        let place = &mut state.channels[index];
        match sent {
            Ok(sent) => {
                data::to_cpu(channel, &sent, &mut place.bytes);
                place.refused = None;
            }
            Err(code) => place.refused = Some(code),
        }
    }
    Ok(())
}

fn write(
    config: &RemoteStation,
    timeout: Duration,
    line: &mut Option<Line>,
    shared: &Mutex<Shared>,
) -> Result<(), String> {
    for (index, channel) in config.channels.iter().enumerate().filter(|(_, channel)| channel.output) {
        let bytes = lock(shared).channels[index].bytes.clone();
        let request = frame::write_request(channel, &data::to_device(channel, &bytes));
        let written = ask(config, timeout, line, channel, &request)?;
        lock(shared).channels[index].refused = written.err();
    }
    Ok(())
}

/// The data of the answer, or the code with which the device refuses. `Err`: the device is away.
fn ask(
    config: &RemoteStation,
    timeout: Duration,
    line: &mut Option<Line>,
    channel: &RemoteChannel,
    request: &[u8],
) -> Result<Result<Vec<u8>, u8>, String> {
    let open = line.as_mut().ok_or("the line is closed")?;
    let came = open.exchange(config.unit, request, timeout)?;
    match frame::answer(request, channel, &came) {
        Answer::Data(sent) => Ok(Ok(sent.to_vec())),
        Answer::Written => Ok(Ok(Vec::new())),
        Answer::Refused(code) => Ok(Err(code)),
        Answer::Wrong => Err("the answer does not belong to the request".to_string()),
    }
}
