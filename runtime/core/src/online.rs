//! What clients of the CPU may do, and when: at the cycle control point, between two cycles.

use std::sync::Arc;
use std::time::Duration;

use crate::cpu::Cpu;
use crate::cycle::Pace;
use crate::diagnostics::NO_SITE;
use crate::faults::STOP_BY_CLIENT;
use crate::options::Restart;
use crate::partners::Board;

/// Answers clients. It is called on the thread of the CPU and may read and change all of its memory.
pub trait Service {
    /// A cycle has ended that began at `start`, `period` nanoseconds after the one before. True: clients wait.
    fn look(&self, cpu: &Cpu, start: u64, period: Option<u64>) -> bool;

    /// Does what waits. After `share` of the time no further work is begun.
    fn serve(&mut self, cpu: &Cpu, share: Duration);

    /// Where blocks of the program leave jobs for partners.
    fn board(&self) -> Option<Arc<Board>> {
        None
    }
}

/// The part of a cycle that communication may take, in percent, if plc.toml says nothing. Source: CPU manuals, communication load.
const COMMUNICATION_LOAD: u8 = 20;
/// The share of a cycle without a pause.
const SHARE_MIN: Duration = Duration::from_micros(200);
/// From one look at clients to the next in STOP.
const STOP_PAUSE: Duration = Duration::from_millis(1);

impl Cpu {
    /// From now on clients are answered.
    pub fn attach(&self, service: Box<dyn Service>) {
        self.partners.attach(service.board());
        self.service.replace(Some(service));
        self.is_served.set(true);
    }

    /// Answers clients, if there can be any, after the cycle that began at `start`.
    #[inline]
    pub(crate) fn serve_clients(&self, pace: &Pace, start: u64, period: Option<u64>) {
        if self.is_served.get() {
            self.serve_in_run(pace, start, period);
        }
    }

    fn serve_in_run(&self, pace: &Pace, start: u64, period: Option<u64>) {
        if !self.service.borrow().as_ref().is_some_and(|service| service.look(self, start, period)) {
            return;
        }
        let was_stopped = self.is_stopped();
        let load = self.image.config.services.communication_load.unwrap_or(COMMUNICATION_LOAD);
        self.serve(Duration::from_nanos(pace.cycle_time / 100 * u64::from(load)).max(SHARE_MIN));
        if self.is_stopped() && !was_stopped {
            self.stop_outputs();
        }
    }

    fn serve(&self, share: Duration) {
        // The service is not there while it works: what it does cannot call it again.
        let taken = self.service.take();
        if let Some(mut service) = taken {
            service.serve(self, share);
            self.service.replace(Some(service));
        }
    }

    /// Answers clients of a CPU in STOP until one of them asks for RUN, or `is_wanted` says that there is something else to do. `None`: that,
    /// or the process is to end.
    pub(crate) fn serve_in_stop(&self, is_wanted: &dyn Fn() -> bool) -> Option<Restart> {
        while self.is_served.get() && !crate::run::end_requested() && !is_wanted() {
            self.serve(STOP_PAUSE);
            if let Some(kind) = self.restart_requested.take() {
                return Some(kind);
            }
            std::thread::sleep(STOP_PAUSE);
        }
        None
    }

    /// STOP, as by a programming device.
    pub fn stop_by_request(&self) {
        self.stop_by(STOP_BY_CLIENT, NO_SITE, 0);
    }

    /// Sets the clock, as by SFC 0.
    pub fn set_wall_clock(&self, moment: i64) {
        self.clock.set_wall(moment);
        self.wall_clock_was_set();
    }
}
