//! `plcc lsp`.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use lsp_server::Connection;
use plcc_lsp::{Checked, Facts, FunctionFacts, Host, Open, ParameterFacts};
use plcc_model::{Direction, Program};
use plcc_program::tables::scl::{Parameter, Rules, Signature, signatures};

use crate::command::exit;
use crate::pipeline::{self, Settings};
use crate::{inputs, project, report, value_names};

/// Serves an editor over standard input and output.
pub fn lsp() -> u8 {
    let (connection, threads) = Connection::stdio();
    let served = plcc_lsp::serve(&connection, Arc::new(Files));
    drop(connection);
    match served.and_then(|()| threads.join().map_err(|error| error.to_string())) {
        Ok(()) => exit::OK,
        Err(error) => {
            report::say(&error);
            exit::USAGE
        }
    }
}

/// Programs on the disk.
pub struct Files;

impl Host for Files {
    /// The folder of the project around a file; a file without one is a program alone.
    fn root(&self, path: &Path) -> PathBuf {
        let folder = path.ancestors().skip(1).find(|folder| folder.join(project::FILE_NAME).is_file());
        folder.unwrap_or(path).to_path_buf()
    }

    fn check(&self, root: &Path, open: &Open) -> Checked {
        let read = inputs::read_open(&[root.to_path_buf()], open.clone());
        let is_project = read.project.is_some();
        let settings = Settings::default();
        let require_main = is_project && !settings.is_partial(read.project.as_ref());
        let settings = Settings { require_main, pragmas: true, ..settings };
        let parsed = pipeline::parse(read, &settings);
        let (units, tables) = (parsed.units.clone(), parsed.tables.clone());
        let bound = pipeline::bind(parsed, &settings);
        let facts = Facts { functions: functions(&bound.program), ..Facts::of(&bound.program) };
        let mut sources = bound.sources;
        let made = sources.files().filter(|(_, source)| source.name.ends_with(inputs::AXES_ENDING));
        let made = made.map(|(file, _)| file).collect();
        let values = value_names::read(root, open, &tables, &mut sources);
        Checked { sources, units, tables, facts, diagnostics: bound.diagnostics, values, made }
    }
}

/// The functions of SCL that the CPU of a program has. Finding them takes longer than checking a small program, so it is done once.
fn functions(program: &Program) -> Vec<FunctionFacts> {
    static CLASSIC: OnceLock<Vec<FunctionFacts>> = OnceLock::new();
    static PORTAL: OnceLock<Vec<FunctionFacts>> = OnceLock::new();
    let (found, rules) = match program.profile.family.is_portal() {
        true => (&PORTAL, Rules::Tia1500),
        false => (&CLASSIC, Rules::Classic),
    };
    let function = |one: Signature| FunctionFacts {
        name: one.name,
        parameters: one.parameters.into_iter().map(parameter).collect(),
        is_typed: one.is_typed,
        description: one.description,
    };
    found.get_or_init(|| signatures(rules).into_iter().map(function).collect()).clone()
}

fn parameter(one: Parameter) -> ParameterFacts {
    let mut names = one.names.into_iter();
    ParameterFacts {
        name: names.next().unwrap_or_default(),
        also: names.collect(),
        direction: match one.direction {
            Direction::Input => "IN",
            Direction::Output => "OUT",
            Direction::InOut => "IN_OUT",
        },
        ty: one.ty,
        is_numbered: one.is_numbered,
        is_optional: one.is_optional,
    }
}
