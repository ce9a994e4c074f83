//! Which parts of a program tests run: runs with probes, and the files of the report.

use std::path::Path;
use std::rc::Rc;

use plcc_coverage::{Counter, Coverage, chart, html, lcov};
use plcc_diag::FileId;
use plcc_lower::probe::Place;
use plcc_runtime::files::writable;
use plcc_runtime::probe::Watcher;
use plcc_runtime::{Code, TestOptions};
use plcc_syntax::ast::SourceUnit;

use super::prepare::VariantState;
use super::{Form, Variant};
use crate::pipeline::{Bound, Compiled};
use crate::{code, pipeline};

/// Counts what runs of a program.
pub struct Counting<'a> {
    bound: &'a Bound,
    units: &'a [(FileId, SourceUnit)],
    pub coverage: Coverage,
}

impl<'a> Counting<'a> {
    pub fn new(bound: &'a Bound, units: &'a [(FileId, SourceUnit)]) -> Counting<'a> {
        Counting { bound, units, coverage: Coverage::default() }
    }

    /// Runs the program once for each of the options.
    pub fn run(&mut self, variant: Variant, options: &[&TestOptions]) -> Vec<VariantState> {
        let (compiled, places) = pipeline::lower_for_coverage(self.bound, variant.optimization);
        let compiled = pipeline::optimize(compiled);
        let places: Rc<[Place]> = places.into();
        options.iter().map(|options| self.run_once(&compiled, &places, variant.form, options)).collect()
    }

    fn run_once(
        &mut self,
        compiled: &Compiled,
        places: &Rc<[Place]>,
        form: Form,
        options: &TestOptions,
    ) -> VariantState {
        let code: Rc<dyn Code> = match form {
            Form::Interp => code::interpreter(compiled),
            Form::Jit => match code::jit(compiled) {
                Ok(code) => code,
                Err(error) => return VariantState::Broken(error.to_string()),
            },
            Form::Exe => return VariantState::Broken("an executable has no probes".to_string()),
        };
        let program = &self.bound.program;
        let charts = chart::charts(program, self.units.iter().map(|(_, unit)| unit));
        let counter = Rc::new(Counter::new(Rc::clone(places), charts));
        let watcher: Rc<dyn Watcher> = Rc::<Counter>::clone(&counter);
        let report = plcc_runtime::testing::test_watched(compiled.image.clone(), code, options, Some(watcher));
        self.coverage.add(plcc_coverage::collect(program, &self.bound.sources, self.units, &counter));
        VariantState::Done(report)
    }
}

/// Writes the report to a folder: `lcov.info`, `index.html` and a page for each source. `Err`: what cannot be written.
pub fn write(coverage: &Coverage, folder: &Path) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|error| format!("cannot write `{}`: {error}", folder.display()))?;
    let pages = html::pages(coverage).into_iter();
    for (name, text) in pages.chain([("lcov.info".to_string(), lcov::lcov(coverage))]) {
        let path = folder.join(name);
        writable(&path)
            .and_then(|()| std::fs::write(&path, text))
            .map_err(|error| format!("cannot write `{}`: {error}", path.display()))?;
    }
    Ok(())
}
