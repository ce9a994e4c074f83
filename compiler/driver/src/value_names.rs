//! Names of values in plc.toml, scenarios, watch tables and tables of forced values, and where they are written: an editor renames them.

use std::ops::Range;
use std::path::{Path, PathBuf};

use plcc_diag::{FileId, SourceFile, SourceMap, Span};
use plcc_lsp::{Open, StringForm, ValueName, ValuePart};
use plcc_runtime::names::path::{self, Part};
use plcc_syntax::symbols::SymbolTable;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::{inputs, project};

/// The names in the TOML files of the program at `root`. The files are added to `sources`.
pub fn read(root: &Path, open: &Open, tables: &[SymbolTable], sources: &mut SourceMap) -> Vec<ValueName> {
    let mut names = Vec::new();
    for path in files(root) {
        let name = path.display().to_string();
        let known = sources.files().find(|(_, source)| source.name == name).map(|(file, _)| file);
        let file = match known {
            Some(file) => file,
            None => match open.get(&path).cloned().map_or_else(|| inputs::read_text(&path), Ok) {
                Ok(text) => sources.add(SourceFile::new(name, text)),
                Err(_) => continue,
            },
        };
        names.extend(of(file, &sources.file(file).text, tables));
    }
    names
}

/// The TOML files of a project without those of projects inside it; of a source alone its scenario.
fn files(root: &Path) -> Vec<PathBuf> {
    if !root.is_dir() {
        return inputs::file_scenario(root).into_iter().collect();
    }
    let mut files = inputs::files_below(root);
    let is_project = |folder: &Path| folder.join(project::FILE_NAME).is_file();
    files.retain(|path| {
        path.extension().is_some_and(|suffix| suffix == "toml")
            && path.ancestors().skip(1).find(|folder| is_project(folder)).is_none_or(|folder| folder == root)
    });
    files
}

/// The names in a file. Empty if it is not TOML.
fn of(file: FileId, text: &str, tables: &[SymbolTable]) -> Vec<ValueName> {
    let Ok(table) = DeTable::parse(text) else { return Vec::new() };
    let mut reader = Reader { file, text, tables, names: Vec::new() };
    reader.table(&[], table.get_ref());
    reader.names
}

/// A key with the place where it is written.
type Key<'k> = (&'k str, Range<usize>);

struct Reader<'a> {
    file: FileId,
    text: &'a str,
    tables: &'a [SymbolTable],
    names: Vec<ValueName>,
}

impl Reader<'_> {
    fn table(&mut self, path: &[Key], table: &DeTable) {
        for (key, value) in table {
            let mut path = path.to_vec();
            path.push((key.get_ref().as_ref(), key.span()));
            self.value(&path, value);
        }
    }

    fn value(&mut self, path: &[Key], value: &Spanned<DeValue>) {
        let keys: Vec<&str> = path.iter().map(|(key, _)| *key).collect();
        match (keys.as_slice(), value.get_ref()) {
            (["axis", _], _) => {
                let axis = Token::read(self.text, path[1].1.clone());
                self.names.extend(axis.map(|axis| vec![axis.part(self.file, 0..axis.text.len())]));
            }
            (["at", "pulses", _] | ["plant", "write", _], _) => self.keys(&path[2..]),
            (_, DeValue::Array(items)) => items.iter().for_each(|item| self.value(path, item)),
            (_, DeValue::Table(inner)) => self.table(path, inner),
            (["at", "set" | "expect", _, ..], _) => self.keys(&path[2..]),
            (
                ["services", "values"]
                | ["services", "registers", _]
                | ["at", "print"]
                | ["plant", "read", _]
                | ["row" | "force", "address"]
                | ["trace", "signals" | "trigger"],
                DeValue::String(_),
            ) => {
                let name = Token::read(self.text, value.span()).and_then(|token| self.name(&token));
                self.names.extend(name);
            }
            _ => {}
        }
    }

    /// A name that is a key, or several: TOML takes `Station_DB.Starts = 1` for a table in a table.
    fn keys(&mut self, keys: &[Key]) {
        let mut places: Vec<Range<usize>> = keys.iter().map(|(_, place)| place.clone()).collect();
        // A table that several values have in common keeps the place of the first.
        for at in (1..places.len()).rev() {
            match before_point(self.text, places[at].start) {
                Some(place) => places[at - 1] = place,
                None => break,
            }
        }
        let mut name = Vec::new();
        for place in places {
            let Some(parts) = Token::read(self.text, place).and_then(|token| self.name(&token)) else { return };
            name.extend(parts);
        }
        self.names.push(name);
    }

    /// The parts of the name in a string.
    fn name(&self, token: &Token) -> Option<ValueName> {
        let text = token.text.as_str();
        let is_symbol = self.tables.iter().any(|table| {
            table.symbols.iter().any(|row| row.name == text) || table.s7200.iter().any(|row| row.name == text)
        });
        if is_symbol {
            return Some(vec![token.part(self.file, 0..text.len())]);
        }
        // `plant.level` and `pulse.1.duty` are not names of the program.
        if text.starts_with("plant.") || text.starts_with("pulse.") {
            return None;
        }
        // `MD20 as REAL`, `AO0 in %`.
        let lower = text.to_ascii_lowercase();
        let end = lower.rfind(" as ").or_else(|| lower.rfind(" in ")).unwrap_or(text.len());
        let parts = path::placed(&text[..end])?.into_iter();
        let names = parts.filter(|(part, _)| matches!(part, Part::Name(_)));
        Some(names.map(|(_, place)| token.part(self.file, place)).collect())
    }
}

/// The key before a point that is before a byte: `Station_DB` in `Station_DB.Starts`.
fn before_point(text: &str, byte: usize) -> Option<Range<usize>> {
    let before = text[..byte].trim_end().strip_suffix('.')?.trim_end();
    let start = match before.chars().next_back()? {
        quote @ ('"' | '\'') => before[..before.len() - 1].rfind(quote)?,
        _ => before.trim_end_matches(|c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-')).len(),
    };
    Some(start..before.len())
}

/// A string of TOML.
struct Token {
    form: StringForm,
    text: String,
    /// Where each byte of the text is in the file, and its end.
    places: Vec<usize>,
}

impl Token {
    /// The string at a place. `None`: it has several lines, or characters that no name has.
    fn read(file: &str, place: Range<usize>) -> Option<Token> {
        let raw = &file[place.clone()];
        let form = match raw.as_bytes().first()? {
            b'"' => StringForm::Basic,
            b'\'' => StringForm::Literal,
            _ => StringForm::Bare,
        };
        if raw.starts_with("\"\"\"") || raw.starts_with("'''") {
            return None;
        }
        let quote = usize::from(form != StringForm::Bare);
        let inner = raw.get(quote..raw.len() - quote)?;
        let first = place.start + quote;
        let mut token = Token { form, text: String::new(), places: Vec::new() };
        let mut chars = inner.char_indices();
        while let Some((at, c)) = chars.next() {
            let c = match c {
                '\\' if form == StringForm::Basic => unescaped(&mut chars)?,
                c => c,
            };
            token.text.push(c);
            token.places.resize(token.text.len(), first + at);
        }
        token.places.push(first + inner.len());
        Some(token)
    }

    /// The part of a name at bytes of the text.
    fn part(&self, file: FileId, bytes: Range<usize>) -> ValuePart {
        ValuePart {
            text: self.text[bytes.clone()].to_owned(),
            span: Span::new(file, self.places[bytes.start]..self.places[bytes.end]),
            string: self.form,
            is_quoted: self.text[..bytes.start].ends_with('"'),
        }
    }
}

/// The character that an escape means, after its `\`.
fn unescaped(chars: &mut std::str::CharIndices) -> Option<char> {
    let digits = match chars.next()?.1 {
        c @ ('"' | '\\') => return Some(c),
        'x' => 2,
        'u' => 4,
        'U' => 8,
        _ => return None,
    };
    let hex: String = chars.take(digits).map(|(_, c)| c).collect();
    char::from_u32(u32::from_str_radix(&hex, 16).ok()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The parts of all names, as they are written, without quotes.
    fn written(text: &str) -> Vec<String> {
        let parts = |name: &ValueName| name.iter().map(|part| text[part.span.range()].to_owned()).collect::<Vec<_>>();
        of(FileId::default(), text, &[]).iter().map(|name| parts(name).join("|")).collect()
    }

    #[test]
    fn names_are_found_where_they_are_written() {
        let text = r#"
name = "Lamp"
[services]
values = ["Motor.Speed", "\"a b\".c[1].%X3"]
[services.registers]
coils = "Q0.0"
[axis."Axis.1"]
type = "TO_SpeedAxis"
[[at]]
cycle = 1
set = { Lamp = "Lamp", Line.a = 1, Line.b = 2, '"Set point".x' = 3 }
expect = { "MD20 as REAL" = 1, "plant.level" = 2, "F\u00f6n" = true }
print = ["Speed in %"]
[[row]]
address = "Pump"
comment = "Pump"
[trace]
signals = ["Belt"]
"#;
        let mut found = written(text);
        found.sort();
        let mut expected = [
            "Motor|Speed",
            "a b|c",
            "Q0|0",
            "Axis.1",
            "Lamp",
            "Line|a",
            "Line|b",
            "Set point|x",
            "MD20",
            "F\\u00f6n",
            "Speed",
            "Pump",
            "Belt",
        ];
        expected.sort_unstable();
        assert_eq!(found, expected);
        // Each value has the place of its own table.
        let lines: Vec<u32> = of(FileId::default(), text, &[])
            .iter()
            .filter(|name| name[0].text == "Line")
            .map(|name| name[0].span.start)
            .collect();
        assert_eq!(lines.len(), 2);
        assert_ne!(lines[0], lines[1]);
        assert!(of(FileId::default(), "a = [", &[]).is_empty());
    }
}
