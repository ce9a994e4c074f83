//! The way from servers to the CPU and back.
//!
//! Servers run on a thread of their own and never touch PLC memory. They send work, which the CPU does at its cycle
//! control point, between two cycles. So each piece of work sees one completed cycle. The queue is bounded: a client
//! that sends more than the CPU can do waits.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use plcc_runtime::cpu::Cpu;
use plcc_runtime::online::Service;
use plcc_runtime::partners::Board;
use tokio::sync::{mpsc, oneshot};

use crate::limits::QUEUE_MAX;
use crate::metrics::CycleTimes;

type Work = Box<dyn FnOnce(&Cpu) + Send>;

/// The end of the servers.
#[derive(Clone)]
pub struct Link {
    queue: mpsc::Sender<Work>,
    waiting: Arc<AtomicUsize>,
    times: Arc<OnceLock<Arc<CycleTimes>>>,
}

/// The end of the CPU.
pub struct Desk {
    queue: mpsc::Receiver<Work>,
    /// Work in the queue: the cycle looks at it each time, which must cost next to nothing.
    waiting: Arc<AtomicUsize>,
    /// Where the times of cycles are counted, if someone wants to know them.
    times: Option<Arc<CycleTimes>>,
    /// Where blocks of the program leave jobs for partners.
    board: Option<Arc<Board>>,
    /// The same for the servers, one of which may want to know them later.
    wanted_times: Arc<OnceLock<Arc<CycleTimes>>>,
}

/// Both ends of a new way.
pub fn link(times: Option<Arc<CycleTimes>>, board: Option<Arc<Board>>) -> (Link, Desk) {
    let (send, receive) = mpsc::channel(QUEUE_MAX);
    let waiting = Arc::<AtomicUsize>::default();
    let wanted_times = Arc::new(times.iter().cloned().map(OnceLock::from).next().unwrap_or_default());
    let link = Link { queue: send, waiting: waiting.clone(), times: wanted_times.clone() };
    (link, Desk { queue: receive, waiting, times, board, wanted_times })
}

impl Link {
    /// Has the CPU do `work` at its next cycle control point. `None`: the CPU has ended.
    pub async fn ask<T: Send + 'static>(&self, work: impl FnOnce(&Cpu) -> T + Send + 'static) -> Option<T> {
        let (send, receive) = oneshot::channel();
        let boxed: Work = Box::new(move |cpu| {
            // Who asked may have gone.
            let _ = send.send(work(cpu));
        });
        let place = self.queue.reserve().await.ok()?;
        self.waiting.fetch_add(1, Ordering::Relaxed);
        place.send(boxed);
        receive.await.ok()
    }
}

impl Link {
    /// From now on the times of cycles are counted.
    pub fn time_cycles(&self) -> Arc<CycleTimes> {
        self.times.get_or_init(Arc::default).clone()
    }

    /// From now on the desk is asked to serve in every cycle, once more for each call; `false` takes one back.
    pub fn keep_awake(&self, is_awake: bool) {
        match is_awake {
            true => self.waiting.fetch_add(1, Ordering::Relaxed),
            false => self.waiting.fetch_sub(1, Ordering::Relaxed),
        };
    }
}

impl Service for Desk {
    fn look(&self, cpu: &Cpu, start: u64, period: Option<u64>) -> bool {
        if let Some(times) = &self.times {
            times.add(period, cpu.clock.now().saturating_sub(start));
        }
        self.waiting.load(Ordering::Relaxed) != 0
    }

    fn serve(&mut self, cpu: &Cpu, share: Duration) {
        cpu.record();
        if self.times.is_none()
            && let Some(times) = self.wanted_times.get()
        {
            times.begin(cpu.cycle_number().saturating_add(1));
            self.times = Some(Arc::clone(times));
        }
        let mut until = None;
        while let Ok(work) = self.queue.try_recv() {
            self.waiting.fetch_sub(1, Ordering::Relaxed);
            work(cpu);
            let until = *until.get_or_insert_with(|| Instant::now() + share);
            if Instant::now() >= until {
                return;
            }
        }
    }

    fn board(&self) -> Option<Arc<Board>> {
        self.board.clone()
    }
}
