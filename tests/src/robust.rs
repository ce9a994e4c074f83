//! Requirements for any input, however damaged: it ends soon, without panic, messages have places, and a program without errors
//! compiles and runs.

use std::sync::mpsc::RecvTimeoutError;
use std::time::{Duration, Instant};

use plcc_diag::Diagnostic;
use plcc_driver::cli::Level;
use plcc_driver::code;
use plcc_driver::inputs::Read;
use plcc_driver::pipeline::{self, Settings};
use plcc_runtime::TestOptions;

/// Cycles that a program without errors is run for.
const CYCLES: u64 = 2;
/// Host time of a cycle of a program that does not come to its end, in nanoseconds.
const HANG_LIMIT: u64 = 300_000_000;

/// How far a program goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// Lowered, optimised, verified.
    Ir,
    /// And run as machine code at -O0 and -O2.
    Run,
}

/// Compiles, and checks the requirements at the head of this file. Returns true if the program had no errors.
pub fn endures(read: Read, settings: &Settings, reach: Reach) -> Result<bool, String> {
    let bound = pipeline::front(read, settings);
    for message in &bound.diagnostics {
        let span = message.primary.span;
        let text = &bound.sources.file(span.file).text;
        if text.get(span.range()).is_none() {
            return Err(format!("a message without a place: {}", message.title));
        }
    }
    plcc_diag::drawing::draw(&bound.diagnostics, &bound.sources, false);
    if bound.diagnostics.iter().any(Diagnostic::is_error) {
        return Ok(false);
    }
    let plain = pipeline::lower(&bound, Level::O0);
    plcc_ir::verify::verify(&plain.module).map_err(|errors| format!("after lowering: {}", errors[0]))?;
    let optimised = pipeline::back(&bound, Level::O2);
    plcc_ir::verify::verify(&optimised.module).map_err(|errors| format!("after the passes: {}", errors[0]))?;
    if reach == Reach::Run {
        for compiled in [&plain, &optimised] {
            let code = code::jit(compiled).map_err(|error| error.to_string())?;
            let options = TestOptions { cycles: Some(CYCLES), hang_limit: Some(HANG_LIMIT), ..TestOptions::default() };
            plcc_runtime::test(compiled.image.clone(), code, &options);
        }
    }
    Ok(true)
}

/// How often the processor time of a thread is checked.
const LOOK: Duration = Duration::from_millis(100);

/// Seconds of waiting per second of processor time: code that sleeps forever uses none.
const WAIT: Duration = Duration::from_secs(30);

/// Runs `work` in a separate thread. It must end before this process has used `limit` of processor time, however busy the computer is.
/// `Err`: a panic, or the work that took too long.
pub fn within<T: Send + 'static>(limit: Duration, work: impl FnOnce() -> T + Send + 'static) -> Result<T, String> {
    let (begin, start) = (processor_time(), Instant::now());
    let (sender, receiver) = std::sync::mpsc::channel();
    let thread = std::thread::spawn(move || {
        // After the limit there is no receiver.
        _ = sender.send(plcc_driver::on_large_stack(work));
    });
    loop {
        match receiver.recv_timeout(LOOK) {
            Ok(result) => {
                _ = thread.join();
                return result.map_err(|panic| format!("panic: {panic}"));
            }
            Err(RecvTimeoutError::Disconnected) => return Err("the thread ended without a result".to_string()),
            Err(RecvTimeoutError::Timeout) => {
                let used = processor_time() - begin;
                if used > limit || start.elapsed() > WAIT * limit.as_secs() as u32 {
                    return Err(format!("no end after {:.1} s of processor time", used.as_secs_f32()));
                }
            }
        }
    }
}

/// Processor time of this process.
#[allow(unsafe_code, reason = "the clock of the process")]
fn processor_time() -> Duration {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: `time` is a place for a result.
    unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &raw mut time) };
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}
