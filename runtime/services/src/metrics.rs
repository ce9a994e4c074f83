//! Metrics for Prometheus, and health.
//!
//! `GET /metrics` answers in the text format of Prometheus, `GET /health` with 200 in RUN, else with 503; HEAD is answered without the content.
//! Source: Prometheus, exposition formats; RFC 9110, methods.

use std::fmt::Write as _;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use plcc_runtime::cpu::Cpu;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::time::timeout;

use crate::limits::{ANSWER_TIME, FRAME_TIME, HTTP_BYTES_MAX, STATE_TIME};
use crate::link::Link;
use crate::listen::Open;
use crate::tls::Stream;

/// Upper ends of the parts of histograms, in microseconds.
const BOUNDS_US: [u64; 16] =
    [1, 10, 50, 100, 250, 500, 1_000, 2_500, 5_000, 10_000, 20_000, 50_000, 100_000, 250_000, 1_000_000, 5_000_000];

/// Times in nanoseconds, counted by their length. The thread of the CPU writes, others read.
#[derive(Default)]
struct Histogram {
    /// The last one is without an end.
    parts: [AtomicU64; BOUNDS_US.len() + 1],
    sum: AtomicU64,
}

impl Histogram {
    fn add(&self, ns: u64) {
        let part = BOUNDS_US.partition_point(|bound| bound * 1000 < ns);
        self.parts[part].fetch_add(1, Ordering::Relaxed);
        self.sum.fetch_add(ns, Ordering::Relaxed);
    }

    fn write(&self, out: &mut String, name: &str, help: &str) {
        let _ = writeln!(out, "# HELP {name} {help}\n# TYPE {name} histogram");
        let mut count = 0;
        for (part, bound) in self.parts.iter().zip(BOUNDS_US) {
            count += part.load(Ordering::Relaxed);
            let _ = writeln!(out, "{name}_bucket{{le=\"{}\"}} {count}", bound as f64 / 1e6);
        }
        count += self.parts[BOUNDS_US.len()].load(Ordering::Relaxed);
        let sum = self.sum.load(Ordering::Relaxed) as f64 / 1e9;
        let _ = writeln!(out, "{name}_bucket{{le=\"+Inf\"}} {count}\n{name}_sum {sum}\n{name}_count {count}");
    }
}

/// How long cycles take.
#[derive(Default)]
pub struct CycleTimes {
    /// From the start of one to the start of the next.
    period: Histogram,
    /// From its start to its end, without the pause.
    work: Histogram,
    /// The first cycle that is counted; 0: all are.
    first: AtomicU64,
}

impl CycleTimes {
    /// Upper ends of the parts in microseconds, and how many periods and cycles are in each; the last part has no end.
    pub fn parts(&self) -> ([u64; 16], Vec<u64>, Vec<u64>) {
        let counts = |times: &Histogram| times.parts.iter().map(|part| part.load(Ordering::Relaxed)).collect();
        (BOUNDS_US, counts(&self.period), counts(&self.work))
    }

    /// Cycles are counted from this one on.
    pub fn begin(&self, cycle: u64) {
        self.first.store(cycle, Ordering::Relaxed);
    }

    /// The first cycle that is counted; 0: all are.
    pub fn first(&self) -> u64 {
        self.first.load(Ordering::Relaxed)
    }

    /// A cycle has ended.
    pub fn add(&self, period: Option<u64>, work: u64) {
        if let Some(period) = period {
            self.period.add(period);
        }
        self.work.add(work);
    }
}

/// What the pages are made of.
#[derive(Clone)]
pub struct Pages {
    pub link: Link,
    pub times: Arc<CycleTimes>,
    /// Connections of each service.
    pub services: Vec<(&'static str, Open)>,
}

/// The state of a CPU.
struct State {
    program: String,
    cpu: String,
    running: bool,
    faults: u64,
}

impl State {
    fn of(cpu: &Cpu) -> State {
        State {
            program: cpu.image.name.clone(),
            cpu: cpu.image.profile.name.clone(),
            running: !cpu.is_stopped(),
            faults: cpu.diagnostics.faults(),
        }
    }
}

/// A text between quotes.
fn label(text: &str) -> String {
    text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n")
}

impl Pages {
    async fn state(&self) -> Option<State> {
        timeout(STATE_TIME, self.link.ask(State::of)).await.ok().flatten()
    }

    async fn metrics(&self) -> String {
        let mut out = String::new();
        let state = self.state().await;
        let mut value = |name: &str, kind: &str, help: &str, labels: &str, value: u64| {
            let _ = writeln!(out, "# HELP {name} {help}\n# TYPE {name} {kind}\n{name}{labels} {value}");
        };
        value("plc_up", "gauge", "1 if the CPU answers within a second", "", state.is_some().into());
        if let Some(state) = state {
            let labels = format!("{{program=\"{}\",cpu=\"{}\"}}", label(&state.program), label(&state.cpu));
            value("plc_info", "gauge", "Program and CPU", &labels, 1);
            value("plc_running", "gauge", "1 in RUN, 0 in STOP", "", state.running.into());
            value("plc_faults_total", "counter", "Faults in the diagnostic buffer", "", state.faults);
        }
        self.times.period.write(&mut out, "plc_cycle_seconds", "From the start of a cycle to the start of the next");
        self.times.work.write(&mut out, "plc_cycle_work_seconds", "Of a cycle without the pause after it");
        let mut rows = |name: &str, kind: &str, help: &str, of: fn((usize, u64, u64)) -> u64| {
            let _ = writeln!(out, "# HELP {name} {help}\n# TYPE {name} {kind}");
            for (service, open) in &self.services {
                let _ = writeln!(out, "{name}{{service=\"{service}\"}} {}", of(open.counts()));
            }
        };
        rows("plc_connections", "gauge", "Clients that are connected", |(now, _, _)| now as u64);
        rows("plc_connections_total", "counter", "Clients that have connected", |(_, accepted, _)| accepted);
        rows("plc_connections_refused_total", "counter", "Clients that were refused", |(_, _, refused)| refused);
        out
    }

    async fn health(&self) -> (&'static str, String) {
        match self.state().await {
            Some(State { running: true, .. }) => ("200 OK", "RUN\n".to_string()),
            Some(_) => ("503 Service Unavailable", "STOP\n".to_string()),
            None => ("503 Service Unavailable", "the CPU does not answer\n".to_string()),
        }
    }
}

/// Answers one request.
pub async fn serve(mut stream: impl Stream, pages: Pages) {
    let answered = async {
        let asked = timeout(FRAME_TIME, request(&mut stream)).await.ok()?;
        let (status, kind, body) = match asked.path() {
            Some("/metrics") => ("200 OK", "text/plain; version=0.0.4; charset=utf-8", pages.metrics().await),
            Some("/health") => {
                let (status, body) = pages.health().await;
                (status, "text/plain; charset=utf-8", body)
            }
            Some(_) => ("404 Not Found", "text/plain", "there are /metrics and /health\n".to_string()),
            None if asked == Parsed::Method => {
                ("405 Method Not Allowed\r\nAllow: GET, HEAD", "text/plain", String::new())
            }
            None => ("400 Bad Request", "text/plain", String::new()),
        };
        let length = body.len();
        let head = format!(
            "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n"
        );
        let body = if matches!(asked, Parsed::Head(_)) { "" } else { &body };
        timeout(ANSWER_TIME, stream.write_all(&[head.as_bytes(), body.as_bytes()].concat())).await.ok()?.ok()?;
        timeout(ANSWER_TIME, stream.shutdown()).await.ok()?.ok()
    };
    // A client that has gone needs no answer.
    let _ = answered.await;
}

/// What is asked for.
async fn request(stream: &mut impl Stream) -> Parsed {
    let mut head = Vec::new();
    let mut buffer = [0; 1024];
    loop {
        let Some(count) = stream.read(&mut buffer).await.ok().filter(|count| *count > 0) else { return Parsed::Wrong };
        head.extend_from_slice(&buffer[..count]);
        match path(&head) {
            Parsed::Partial if head.len() < HTTP_BYTES_MAX => {}
            Parsed::Partial => return Parsed::Wrong,
            parsed => return parsed,
        }
    }
}

#[derive(Debug, PartialEq, Eq)]
enum Parsed {
    Partial,
    Get(String),
    Head(String),
    /// Another method.
    Method,
    Wrong,
}

impl Parsed {
    fn path(&self) -> Option<&str> {
        match self {
            Parsed::Get(path) | Parsed::Head(path) => Some(path),
            Parsed::Partial | Parsed::Method | Parsed::Wrong => None,
        }
    }
}

fn path(head: &[u8]) -> Parsed {
    let mut headers = [httparse::EMPTY_HEADER; 64];
    let mut request = httparse::Request::new(&mut headers);
    match request.parse(head) {
        Ok(httparse::Status::Partial) => Parsed::Partial,
        Ok(httparse::Status::Complete(_)) => {
            let path = request.path.map(|target| path_of(target).to_string());
            match (request.method, path) {
                (Some("GET"), Some(path)) => Parsed::Get(path),
                (Some("HEAD"), Some(path)) => Parsed::Head(path),
                (Some(_), Some(_)) => Parsed::Method,
                _ => Parsed::Wrong,
            }
        }
        Err(_) => Parsed::Wrong,
    }
}

/// The path of what is asked for, which may be a whole URL. Source: RFC 9112, section 3.2.
fn path_of(target: &str) -> &str {
    let path = match target.split_once("://") {
        Some((_, rest)) if !target.starts_with('/') => rest.find('/').map_or("/", |at| &rest[at..]),
        Some(_) | None => target,
    };
    path.split('?').next().unwrap_or(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_histogram_counts_up() {
        let histogram = Histogram::default();
        [1, 1_000, 1_001, 4_000_000, 9_000_000_000].into_iter().for_each(|ns| histogram.add(ns));
        let mut out = String::new();
        histogram.write(&mut out, "x", "help");
        for line in ["x_bucket{le=\"0.000001\"} 2", "x_bucket{le=\"0.00001\"} 3", "x_bucket{le=\"0.005\"} 4"] {
            assert!(out.lines().any(|found| found == line), "{line}: {out}");
        }
        assert!(
            out.ends_with("x_bucket{le=\"5\"} 4\nx_bucket{le=\"+Inf\"} 5\nx_sum 9.004002002\nx_count 5\n"),
            "{out}"
        );
    }

    #[test]
    fn requests_are_read() {
        assert_eq!(path(b"GET /metrics?a=1 HTTP/1.1\r\nHost: x\r\n\r\n"), Parsed::Get("/metrics".to_string()));
        assert_eq!(path(b"HEAD /health HTTP/1.0\r\n\r\n"), Parsed::Head("/health".to_string()));
        let whole = b"GET http://127.0.0.1:9100/health?a=b://c HTTP/1.1\r\nHost: x\r\n\r\n";
        assert_eq!(path(whole), Parsed::Get("/health".to_string()));
        assert_eq!(path(b"GET http://plant HTTP/1.1\r\n\r\n"), Parsed::Get("/".to_string()));
        assert_eq!(path(b"GET /metrics HTT"), Parsed::Partial);
        assert_eq!(path(b"POST / HTTP/1.1\r\n\r\n"), Parsed::Method);
        assert_eq!(path(&[0xFF, 3, 0, 0]), Parsed::Wrong);
    }
}
