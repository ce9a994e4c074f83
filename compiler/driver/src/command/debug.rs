//! `plcc debug`.

use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use plcc_debug::{Host, Target};
use plcc_diag::Diagnostic;

use super::exit;
use crate::cli::DebugArgs;
use crate::pipeline::{self, Bound, Settings};
use crate::{code, inputs, report};

/// Serves a client.
pub fn debug(args: &DebugArgs) -> u8 {
    let host: Rc<dyn Host> = Rc::new(Files(args.clone()));
    let served = match args.listen {
        None => plcc_debug::serve(std::io::stdin(), std::io::stdout(), host),
        Some(address) => over_tcp(address, host),
    };
    match served {
        Ok(()) => exit::OK,
        Err(error) => {
            report::say(&error);
            exit::USAGE
        }
    }
}

/// Serves the first client that comes.
fn over_tcp(address: std::net::SocketAddr, host: Rc<dyn Host>) -> Result<(), String> {
    let failed = |error: std::io::Error| format!("--listen {address}: {error}");
    let listener = TcpListener::bind(address).map_err(failed)?;
    report::say(&format!("the debugger listens on {}", listener.local_addr().map_err(failed)?));
    let (client, _) = listener.accept().map_err(failed)?;
    plcc_debug::serve(client.try_clone().map_err(failed)?, client, host)
}

/// Programs on the disk.
pub struct Files(pub DebugArgs);

/// Messages that a client shows.
const MESSAGES_MAX: usize = 5;

impl Host for Files {
    fn compile(&self, program: Option<&Path>) -> Result<Target, String> {
        let paths = match program {
            Some(program) => vec![program.to_path_buf()],
            None => {
                inputs::or_here(&self.0.inputs).map_err(|_| "there is no program: name one in `program`".to_string())?
            }
        };
        let read = inputs::read_as(&paths, self.0.compile.code_page);
        let settings = Settings { require_main: true, ..Settings::new(&self.0.compile) };
        let bound = pipeline::front(read, &settings);
        if bound.has_errors() || bound.is_denied(&settings) {
            return Err(messages(&bound));
        }
        let (compiled, places) = pipeline::lower_for_debugger(&bound);
        let compiled = pipeline::optimize(compiled);
        let code = code::jit(&compiled).map_err(|error| format!("internal fault, please report it: {error}"))?;
        let Bound { program, sources, .. } = bound;
        Ok(Target { program, sources, places, image: compiled.image, code })
    }

    fn replay(&self) -> Option<PathBuf> {
        self.0.replay.clone()
    }

    fn absolute(&self, path: &str) -> String {
        let found = std::fs::canonicalize(path).or_else(|_| std::path::absolute(path));
        found.map_or_else(|_| path.to_string(), |path| path.display().to_string())
    }
}

/// The first errors, a line each, and how many there are.
fn messages(bound: &Bound) -> String {
    let line = |diagnostic: &&Diagnostic| {
        let span = diagnostic.primary.span;
        let file = bound.sources.file(span.file);
        format!("{}:{}: {}", file.name, file.line(span.start), diagnostic.title)
    };
    let shown = bound.diagnostics.iter().filter(|diagnostic| diagnostic.is_error() || !bound.has_errors());
    let mut lines: Vec<String> = shown.take(MESSAGES_MAX).map(|diagnostic| line(&diagnostic)).collect();
    lines.push(report::summary(&bound.diagnostics));
    lines.join("\n")
}
