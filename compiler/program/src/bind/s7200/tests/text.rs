//! Programs as text.

use plcc_abi::image::Config;
use plcc_diag::{Diagnostic, SourceFile, SourceMap};
use plcc_syntax::ParseOptions;

use crate::bind::BindInput;
use crate::model::Program;
use crate::profile;

fn bind_text(name: &str, text: &str) -> (SourceMap, Program, Vec<Diagnostic>) {
    let mut sources = SourceMap::default();
    let file = sources.add(SourceFile::new(name, text));
    let options = ParseOptions { pragmas: true, ..ParseOptions::default() };
    let (unit, mut diagnostics) = plcc_syntax::s7200::parse(file, text, &options);
    let named = unit.pragmas.iter().find_map(|pragma| profile::lookup(pragma.text.strip_prefix("cpu")?));
    let (program, found) = crate::bind::bind(&BindInput {
        name: "test".to_string(),
        sources: &sources,
        units: &[(file, unit)],
        tables: &[],
        profile: named.unwrap_or_else(|| profile::lookup("s7-200").unwrap()),
        config: Config::default(),
        partial: false,
        pragmas: true,
        require_main: false,
    });
    diagnostics.extend(found);
    plcc_diag::sort(&mut diagnostics);
    (sources, program, diagnostics)
}

#[test]
fn messages_of_the_check_files() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/check/awl");
    let mut wrong = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap().flatten() {
        let text = std::fs::read_to_string(entry.path()).unwrap();
        let (sources, _, diagnostics) = bind_text(&entry.path().display().to_string(), &text);
        let lines: Vec<&str> = text.lines().collect();
        let mut marks = Vec::new();
        let mut last = 0;
        for (index, line) in lines.iter().enumerate() {
            match line.strip_prefix("//@").map(str::trim).filter(|mark| mark.starts_with('^')) {
                Some(mark) => marks.push((last, mark.trim_start_matches('^').trim().to_string())),
                None => last = index + 1,
            }
        }
        let mut found: Vec<(usize, String)> = diagnostics
            .iter()
            .map(|d| {
                let file = sources.file(d.primary.span.file);
                (file.line(d.primary.span.start) as usize, d.code.name().to_string())
            })
            .collect();
        marks.sort();
        found.sort();
        for d in &diagnostics {
            let file = sources.file(d.primary.span.file);
            let (line, column) = file.line_column(d.primary.span.start);
            let name = entry.file_name().to_string_lossy().into_owned();
            let length = d.primary.span.end.saturating_sub(d.primary.span.start);
            println!("MARK {name} {line} {column} {length} {} {}", d.code.name(), d.title);
        }
        if marks != found {
            wrong.push(format!("{}: {found:?}", entry.path().display()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
