//! `plcc view`.

use std::collections::HashMap;
use std::path::Path;

use plcc_literal::count::counted;
use plcc_literal::duration;
use plcc_runtime::files::{regular, writable};
use plcc_view::book::{self, Body, Book};
use plcc_view::names::Names;
use plcc_view::svg::{self, Shown};
use plcc_view::trace::Trace;
use plcc_view::{logic, page};

use crate::cli::ViewArgs;
use crate::command::exit;
use crate::inputs::Read;
use crate::pipeline::{Bound, Settings};
use crate::report;
use crate::{drawings, inputs, pipeline};

/// Draws a program, as far as it could be read. Returns 3 if it has errors.
pub fn view(args: &ViewArgs) -> u8 {
    let inputs = match inputs::or_here(&args.inputs) {
        Ok(inputs) => inputs,
        Err(code) => return code,
    };
    if let Some(told) = args.output.as_deref().and_then(not_a_folder) {
        report::say(&told);
        return exit::USAGE;
    }
    let read = inputs::read_as(&inputs, args.compile.code_page);
    let unreadable = read.is_unreadable();
    let mut drawn = match draw(read, &Settings::new(&args.compile), args.state.as_deref()) {
        Ok(drawn) => drawn,
        Err(message) => {
            report::say(&message);
            return exit::USAGE;
        }
    };
    report::messages(&mut drawn.bound.diagnostics, &drawn.bound.sources);
    let Drawn { book, names, bound, state, values } = drawn;
    let code = match (unreadable, bound.has_errors()) {
        (true, _) => exit::USAGE,
        (false, true) => exit::COMPILE,
        (false, false) => exit::OK,
    };
    // A page without a block would only hide what is wrong.
    if book.pages.is_empty() && code != exit::OK {
        return code;
    }
    let folder = args.output.as_ref().map_or(Ok(0), |folder| write_folder(&book, folder, values.as_ref()));
    let html = args.html.as_ref().map_or(Ok(()), |path| {
        let reference = (!bound.has_errors()).then(|| drawings::reference(&bound));
        let state = state.as_ref().map(|(trace, time)| (trace, *time));
        write(path, &page::document(&book, &names, state, reference.as_ref()))
    });
    match folder.and_then(|pictures| html.map(|()| pictures)) {
        Ok(pictures) => {
            if let Err(code) = tell(args, pictures) {
                return code;
            }
        }
        Err(message) => {
            report::say(&message);
            return exit::USAGE;
        }
    }
    code
}

/// A program with its pictures.
pub struct Drawn {
    pub book: Book,
    pub names: Names,
    pub bound: Bound,
    /// The trace, and the time in milliseconds.
    pub state: Option<(Trace, Option<f64>)>,
    /// The values at that time.
    pub values: Option<HashMap<String, String>>,
}

/// Draws what was read; `state`: `TRACE[@TIME]`. `Err`: what is wrong with the state.
pub fn draw(read: Read, settings: &Settings, shown: Option<&str>) -> Result<Drawn, String> {
    let parsed = pipeline::parse(read, settings);
    let units = parsed.units.clone();
    let name = parsed.name.clone();
    let bound = pipeline::bind(parsed, settings);
    let names = Names::of(&bound.program);
    let state = shown.map(|text| state(text, &names)).transpose()?;
    let values = state.as_ref().map(|(trace, time)| trace.at(*time));
    let texts: Vec<_> = units.iter().map(|(file, unit)| (bound.sources.file(*file).text.as_str(), unit)).collect();
    let options = book::Options { values: values.as_ref(), ..book::Options::default() };
    let book = book::book(&name, &texts, &bound.program, options);
    Ok(Drawn { book, names, bound, state, values })
}

/// Reads `TRACE[@TIME]`: the trace, and the time in milliseconds.
fn state(text: &str, names: &Names) -> Result<(Trace, Option<f64>), String> {
    let (path, time) = match text.rsplit_once('@') {
        Some((path, time)) if !Path::new(text).exists() => (path, Some(time)),
        _ => (text, None),
    };
    let time = match time {
        Some(time) => {
            Some(duration::span(time).ok_or_else(|| format!("`{time}` is not a time such as 1.5s"))? as f64 / 1e6)
        }
        None => None,
    };
    let path = Path::new(path);
    let text = regular(path)
        .and_then(|()| std::fs::read_to_string(path))
        .map_err(|error| format!("cannot read `{}`: {error}", path.display()))?;
    Ok((Trace::parse(&text, names).map_err(|error| format!("{}: {error}", path.display()))?, time))
}

/// The message for `-o plant.svg`, which would become the name of a folder.
fn not_a_folder(output: &Path) -> Option<String> {
    let ends_in = |ending: &str| output.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending));
    let help = match (ends_in("svg"), ends_in("html")) {
        _ if output.is_dir() => return None,
        (true, _) => "name a folder, which gets a picture for each network and chart".to_string(),
        (false, true) => format!("write `--html {}` for one page", output.display()),
        (false, false) if ["png", "jpg", "jpeg", "pdf"].into_iter().any(ends_in) => {
            let page = output.with_extension("html");
            format!("pictures are SVG: name a folder for them, or write `--html {}` for one page", page.display())
        }
        (false, false) => return None,
    };
    Some(format!("-o {}: this is a file; {help}", output.display()))
}

/// Says what was written, or why a folder has no pictures. `Err`: the exit code, where standard output cannot be written.
fn tell(args: &ViewArgs, pictures: usize) -> Result<(), u8> {
    // `--html /dev/stdout > plant.html`: the page is what standard output gets.
    let is_output = args.html.as_ref().is_some_and(|page| page.starts_with("/dev"));
    match (&args.output, pictures) {
        (Some(_), 0) => {
            report::say("there are no networks and no charts to draw; `--html FILE.html` shows code as well");
        }
        (Some(folder), _) if !is_output => {
            report::print(&format!("wrote {} to {}\n", counted(pictures, "picture"), folder.display()))?;
        }
        (Some(_) | None, _) => {}
    }
    match &args.html {
        Some(page) if !is_output => report::print(&format!("wrote {}\n", page.display())),
        Some(_) | None => Ok(()),
    }
}

/// One file for each drawing: `FC_1_network_2.svg`. Returns how many there are.
fn write_folder(book: &Book, folder: &Path, values: Option<&HashMap<String, String>>) -> Result<usize, String> {
    std::fs::create_dir_all(folder).map_err(|error| format!("cannot write `{}`: {error}", folder.display()))?;
    let mut used: HashMap<String, usize> = HashMap::new();
    for page in &book.pages {
        for section in &page.sections {
            let (Body::Drawing { sheet, .. }, Some(picture)) = (&section.content, section.picture()) else { continue };
            let safe: String = page.id.chars().map(|c| if c.is_alphanumeric() || c == '-' { c } else { '_' }).collect();
            let stem = match section.number {
                0 => safe,
                number => format!("{safe}_network_{number}"),
            };
            let count = used.entry(stem.to_lowercase()).or_insert(0);
            *count += 1;
            let stem = if *count == 1 { stem } else { format!("{stem}_{count}") };
            let shown = values.map(|values| Shown {
                nets: logic::logic(sheet).values(&|key| values.get(key).cloned()),
                active: values.iter().filter(|(_, value)| *value == "1").map(|(key, _)| key.clone()).collect(),
            });
            write(&folder.join(format!("{stem}.svg")), &svg::file(&picture, shown.as_ref()))?;
        }
    }
    Ok(used.values().sum())
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    writable(path)
        .and_then(|()| std::fs::write(path, text))
        .map_err(|error| format!("cannot write `{}`: {error}", path.display()))
}
