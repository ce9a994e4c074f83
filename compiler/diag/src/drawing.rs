//! Messages as text for people, drawn by `codespan-reporting`.
//!
//! The first line of each message begins with `error[CODE]:` or `warning[CODE]:`; no other line begins with `error`.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::ops::Range;

use codespan_reporting::diagnostic as drawn;
use codespan_reporting::files::{Error, Files};
use codespan_reporting::term::{self, Chars, Config, DisplayStyle, Styles, StylesWriter, termcolor};

use crate::codes::{Code, Severity};
use crate::diagnostic::{Diagnostic, Label};
use crate::source::{FileId, SourceMap};

/// A source line with more bytes than this is not drawn; the message then names the place.
const DRAWN_LINE_MAX: usize = 400;

/// Draws `diagnostics` one after the other. If several symbols are missing, a list of them follows.
pub fn draw(diagnostics: &[Diagnostic], sources: &SourceMap, color: bool) -> String {
    let mut text = String::new();
    let (shown, omitted) = crate::shown(diagnostics);
    for diagnostic in shown {
        text.push_str(&draw_one(diagnostic, sources, color));
    }
    if omitted > 0 {
        text.push_str(&format!("{}\n\n", crate::omitted_text(omitted)));
    }
    text.push_str(&missing_symbols(diagnostics, sources));
    text
}

fn draw_one(diagnostic: &Diagnostic, sources: &SourceMap, color: bool) -> String {
    let adapter = Adapter(sources);
    let message = translate(diagnostic, sources);
    let mut config = Config { tab_width: 8, chars: Chars::box_drawing(), ..Config::default() };
    if !is_drawable(diagnostic, sources) {
        return draw_short(diagnostic, sources);
    }
    config.display_style = DisplayStyle::Rich;
    if !color {
        return term::emit_into_string(&config, &adapter, &message).unwrap_or_else(|_| draw_short(diagnostic, sources));
    }
    let mut writer = termcolor::Ansi::new(Vec::new());
    let styles = Styles::default();
    match term::emit_to_write_style(&mut StylesWriter::new(&mut writer, &styles), &config, &adapter, &message) {
        Ok(()) => String::from_utf8_lossy(&writer.into_inner()).into_owned(),
        Err(_) => draw_short(diagnostic, sources),
    }
}

/// Title, place and help without the source line.
fn draw_short(diagnostic: &Diagnostic, sources: &SourceMap) -> String {
    let file = sources.file(diagnostic.primary.span.file);
    let place = match file.text.is_empty() {
        // A folder, a file that is not there, or a workbook.
        true => file.name.clone(),
        false => {
            let (line, column) = file.line_column(diagnostic.primary.span.start);
            format!("{}:{line}:{column}", file.name)
        }
    };
    let mut text = format!(
        "{}[{}]: {}\n  ┌─ {place}\n",
        severity_word(diagnostic.severity),
        diagnostic.code.name(),
        one_line(&diagnostic.title),
    );
    if !diagnostic.primary.text.is_empty() {
        text.push_str(&format!("  = {}\n", one_line(&diagnostic.primary.text)));
    }
    if let Some(help) = &diagnostic.help {
        text.push_str(&format!("  = help: {}\n", one_line(help)));
    }
    for line in diagnostic.note.iter().flat_map(|note| note.lines()) {
        text.push_str(format!("    {}", one_line(line)).trim_end());
        text.push('\n');
    }
    text.push('\n');
    text
}

/// `error` or `warning`.
pub(crate) fn severity_word(severity: Severity) -> &'static str {
    match severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    }
}

/// An empty file has no line to draw; a very long line would drown the message.
fn is_drawable(diagnostic: &Diagnostic, sources: &SourceMap) -> bool {
    let labels = || std::iter::once(&diagnostic.primary).chain(&diagnostic.secondary);
    !sources.file(diagnostic.primary.span.file).text.is_empty()
        && labels().all(|label| {
            let file = sources.file(label.span.file);
            [label.span.start, label.span.end]
                .iter()
                .all(|&at| file.line_text(file.line(at.min(file.text.len() as u32))).len() <= DRAWN_LINE_MAX)
        })
}

fn translate(diagnostic: &Diagnostic, sources: &SourceMap) -> drawn::Diagnostic<FileId> {
    let severity = match diagnostic.severity {
        Severity::Error => drawn::Severity::Error,
        Severity::Warning => drawn::Severity::Warning,
    };
    let secondary =
        diagnostic.secondary.iter().map(|label| translate_label(drawn::LabelStyle::Secondary, label, sources));
    drawn::Diagnostic::new(severity)
        .with_code(diagnostic.code.name())
        .with_message(one_line(&diagnostic.title))
        .with_label(translate_label(drawn::LabelStyle::Primary, &diagnostic.primary, sources))
        .with_labels_iter(secondary)
        .with_notes_iter(diagnostic.help.iter().map(|help| format!("help: {}", one_line(help))))
        .with_notes_iter(diagnostic.note.iter().map(|note| verbatim(note)))
}

/// The lines of a note, below its heading.
fn verbatim(note: &str) -> String {
    let lines: Vec<String> = note.lines().map(|line| one_line(line).trim_end().to_string()).collect();
    format!("drawn:\n{}", lines.join("\n"))
}

fn translate_label(style: drawn::LabelStyle, label: &Label, sources: &SourceMap) -> drawn::Label<FileId> {
    let range = drawable_range(label.span.range(), &sources.file(label.span.file).text);
    drawn::Label::new(style, label.span.file, range).with_message(one_line(&label.text))
}

/// `range` cut to `text`, at character boundaries.
fn drawable_range(range: Range<usize>, text: &str) -> Range<usize> {
    let border = |at: usize| (0..=at.min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0);
    let start = border(range.start);
    start..border(range.end).max(start)
}

/// A message is one line, whatever it quotes from the source.
pub(crate) fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// All undefined symbols as one list: it helps to find the symbol table that is missing.
fn missing_symbols(diagnostics: &[Diagnostic], sources: &SourceMap) -> String {
    let mut symbols: Vec<(String, u32, String)> = Vec::new();
    let mut known: HashMap<String, usize> = HashMap::new();
    for diagnostic in diagnostics.iter().filter(|d| d.code == Code::UnknownSymbol) {
        let span = diagnostic.primary.span;
        let file = sources.file(span.file);
        let name = one_line(file.text.get(span.range()).unwrap_or_default());
        match known.entry(name.to_ascii_lowercase()) {
            Entry::Occupied(entry) => symbols[*entry.get()].1 += 1,
            Entry::Vacant(entry) => {
                entry.insert(symbols.len());
                symbols.push((name, 1, format!("{}:{}", file.name, file.line(span.start))));
            }
        }
    }
    if symbols.len() < 2 {
        return String::new();
    }
    let mut text = format!("{} symbols that no table and no block defines:\n", symbols.len());
    for (name, count, place) in symbols {
        let more = if count > 1 { format!(" and {} more", count - 1) } else { String::new() };
        text.push_str(&format!("    {name}    {place}{more}\n"));
    }
    text.push('\n');
    text
}

/// Our sources in the form that the drawing library needs.
struct Adapter<'a>(&'a SourceMap);

impl<'a> Files<'a> for Adapter<'_> {
    type FileId = FileId;
    type Name = &'a str;
    type Source = &'a str;

    fn name(&'a self, id: FileId) -> Result<&'a str, Error> {
        Ok(&self.0.file(id).name)
    }

    fn source(&'a self, id: FileId) -> Result<&'a str, Error> {
        Ok(&self.0.file(id).text)
    }

    fn line_index(&'a self, id: FileId, byte_index: usize) -> Result<usize, Error> {
        Ok(self.0.file(id).line(byte_index as u32) as usize - 1)
    }

    fn line_range(&'a self, id: FileId, line_index: usize) -> Result<Range<usize>, Error> {
        let file = self.0.file(id);
        let max = file.line_count() as usize;
        if line_index >= max {
            return Err(Error::LineTooLarge { given: line_index, max });
        }
        Ok(file.line_range(line_index as u32 + 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::{SourceFile, Span};

    fn sample(text: &str, range: Range<usize>) -> (SourceMap, Diagnostic) {
        let mut sources = SourceMap::default();
        let file = sources.add(SourceFile::new("FC12.stl", text));
        let message = Diagnostic::new(
            Code::OperandKind,
            Span::new(file, range),
            "`A` combines one bit, but `MW 10` is a 16-bit memory word",
        );
        (sources, message.label("memory word: MB 10 and MB 11").help("name one bit, e.g. `M 10.0`"))
    }

    #[test]
    fn draws_title_place_and_help() {
        let (sources, message) = sample("      A     MW 10\n", 12..17);
        assert_eq!(
            draw(&[message], &sources, false),
            "error[P0203]: `A` combines one bit, but `MW 10` is a 16-bit memory word
  ┌─ FC12.stl:1:13
  │
1 │       A     MW 10
  │             ^^^^^ memory word: MB 10 and MB 11
  │
  = help: name one bit, e.g. `M 10.0`

"
        );
    }

    #[test]
    fn odd_spans_and_sources_are_drawn_too() {
        for (text, range) in [("", 0..0), ("ä", 1..9), ("A\n", 2..2), ("A\nB\nC", 0..5)] {
            let (sources, message) = sample(text, range);
            assert!(draw(std::slice::from_ref(&message), &sources, false).starts_with("error[P0203]: "));
            assert!(draw(&[message], &sources, true).contains("P0203"));
        }
        let (sources, message) = sample(&"A ".repeat(500), 12..17);
        let text = draw(&[message], &sources, false);
        assert!(text.contains("  ┌─ FC12.stl:1:13\n") && text.len() < 300);
        let (sources, message) = sample("", 0..0);
        assert!(draw(&[message], &sources, false).contains("  ┌─ FC12.stl\n"), "nothing is at its line 1");
    }

    #[test]
    fn notes_keep_their_lines() {
        let (sources, message) = sample("      A     MW 10\n", 12..17);
        let text = draw(&[message.note("  #a\n--| |--\n  ^^^")], &sources, false);
        assert!(text.ends_with("  = drawn:\n      #a\n    --| |--\n      ^^^\n\n"), "{text}");
        let (sources, message) = sample(&"A ".repeat(500), 12..17);
        let text = draw(&[message.note("  #a\n--| |--\n")], &sources, false);
        assert!(text.ends_with("\n      #a\n    --| |--\n\n"), "{text}");
    }

    #[test]
    fn only_first_lines_begin_with_error() {
        let (sources, mut message) = sample("error one\nerror two\n", 0..19);
        message.title = "title\nerror inside".into();
        message.help = Some("first\nerror second".into());
        let text = draw(&[message], &sources, false);
        assert_eq!(text.lines().filter(|line| line.starts_with("error")).count(), 1);
    }
}
