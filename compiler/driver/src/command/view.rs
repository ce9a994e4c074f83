//! `plcc view`.

use std::path::Path;

use plcc_runtime::files::writable;
use plcc_view::book::{self, Body, Book};
use plcc_view::svg;

use crate::cli::ViewArgs;
use crate::command::exit;
use crate::report::{self, MessageFormat};
use crate::{inputs, pipeline};

/// Draws a program. Returns 3 if it has errors, and draws what could be read of it.
pub fn view(args: &ViewArgs) -> u8 {
    let inputs = match inputs::or_here(&args.inputs) {
        Ok(inputs) => inputs,
        Err(code) => return code,
    };
    let read = inputs::read_as(&inputs, args.compile.code_page);
    let unreadable = read.is_unreadable();
    let settings = pipeline::Settings::new(&args.compile);
    let parsed = pipeline::parse(read, &settings);
    let units = parsed.units.clone();
    let name = parsed.name.clone();
    let mut bound = pipeline::bind(parsed, &settings);
    report::messages(&mut bound.diagnostics, &bound.sources, MessageFormat::Human);
    let texts: Vec<_> = units.iter().map(|(file, unit)| (bound.sources.file(*file).text.as_str(), unit)).collect();
    let book = book::book(&name, &texts, &bound.program, book::Options::default());
    if let Some(folder) = &args.output {
        if let Err(message) = write_folder(&book, folder) {
            report::say(&message);
            return exit::USAGE;
        }
    }
    match (unreadable, bound.has_errors()) {
        (true, _) => exit::USAGE,
        (false, true) => exit::COMPILE,
        (false, false) => exit::OK,
    }
}

/// One file for each drawing: `FC 1 network 2.svg`.
fn write_folder(book: &Book, folder: &Path) -> Result<(), String> {
    let failed = |path: &Path, error: std::io::Error| format!("cannot write `{}`: {error}", path.display());
    std::fs::create_dir_all(folder).map_err(|error| failed(folder, error))?;
    for page in &book.pages {
        for section in &page.sections {
            let Body::Drawing { scene, .. } = &section.content else { continue };
            let safe: String = page.id.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect();
            let path = folder.join(format!("{safe}_{}.svg", section.number));
            writable(&path)
                .and_then(|()| std::fs::write(&path, svg::file(scene)))
                .map_err(|error| failed(&path, error))?;
        }
    }
    Ok(())
}
