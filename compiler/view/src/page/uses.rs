//! Where operands and blocks are used.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use crate::book::{Body, Book};
use crate::listing::Kind;
use crate::names::{Names, Scope, canonical, is_cell};
use crate::sheet::{Label, Link, Look, Sheet, Source};

/// For each key its uses: the numbers of page and section, and `w` for one that writes, `r` for one that reads, `c` for a call.
/// `local_only`: those of local names, which no reference data have.
pub fn uses(book: &Book, names: &Names, local_only: bool) -> Value {
    let mut uses: BTreeMap<String, Vec<(usize, usize, char)>> = BTreeMap::new();
    for (number, page) in book.pages.iter().enumerate() {
        for (at, section) in page.sections.iter().enumerate() {
            let mut add = |key: &str, text: &str, how: char| {
                // A local name of a block with one instance has the address of that as its key.
                if local_only && !key.starts_with('#') && !text.trim_start().starts_with('#') {
                    return;
                }
                // Local names are those of their page.
                let key = if key.starts_with('#') { format!("{}{key}", page.id) } else { key.to_string() };
                let list = uses.entry(key).or_default();
                if list.last() != Some(&(number, at, how)) {
                    list.push((number, at, how));
                }
            };
            match &section.content {
                Body::Drawing { sheet, .. } => of_sheet(sheet, names, page.scope, &mut add),
                Body::Text(listing) => of_text(&listing.lines, listing.kind, names, page.scope, &mut add),
            }
        }
    }
    let uses = uses.into_iter().map(|(key, list)| {
        let list: Vec<Value> =
            list.into_iter().map(|(page, section, how)| json!([page, section, how.to_string()])).collect();
        (key, Value::Array(list))
    });
    Value::Object(uses.collect())
}

fn of_sheet(sheet: &Sheet, names: &Names, scope: Scope, add: &mut dyn FnMut(&str, &str, char)) {
    let mut known = |label: &Label, how: char| {
        if label.key.is_empty() {
            // The value of a slice is not that of its variable.
            if let Some(key) = without_slice(&label.text).and_then(|whole| names.key(whole, scope)) {
                add(&key, &label.text, how);
            }
        } else {
            let cell = label.key.strip_suffix(".VALUE").filter(|key| is_cell(key));
            add(cell.unwrap_or(&label.key), &label.text, how);
        }
    };
    for part in &sheet.parts {
        for pin in &part.pins {
            if let Link::Operand(label) = &pin.link {
                known(label, if pin.output { 'w' } else { 'r' });
            }
        }
        if let Look::Box { instance: Some(label), .. } = &part.look {
            known(label, 'c');
        }
    }
    for source in sheet.nets.iter().flat_map(|net| &net.sources) {
        if let Source::Operand { label, .. } = source {
            known(label, 'r');
        }
    }
}

/// Instructions of STL that write their operand, in both sets of mnemonics.
const WRITES: &[&str] = &["=", "S", "R", "T", "=I", "SI", "RI", "FP", "FN"];

fn of_text(lines: &[String], kind: Kind, names: &Names, scope: Scope, add: &mut dyn FnMut(&str, &str, char)) {
    for line in lines {
        let code = line.split("//").next().unwrap_or_default();
        match kind {
            Kind::Stl => {
                let code = code
                    .split_once(':')
                    .filter(|(label, _)| !label.contains(['"', '#', ' ']))
                    .map_or(code, |(_, rest)| rest);
                let mut words = code.trim().trim_end_matches(';').splitn(2, char::is_whitespace);
                let (mnemonic, operands) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
                let how = if WRITES.contains(&mnemonic) { 'w' } else { 'r' };
                for operand in operands.split([',', ';', '(', ')', '=']).filter(|operand| !operand.trim().is_empty()) {
                    let whole = without_slice(operand).unwrap_or(operand);
                    if let Some(key) = names.key(whole, scope) {
                        add(&key, operand, how);
                    }
                }
            }
            Kind::Scl => {
                let (left, right) = code.split_once(":=").map_or(("", code), |(left, right)| (left, right));
                for (part, how) in [(left, 'w'), (right, 'r')] {
                    for word in words(part) {
                        let is_name = word.starts_with(['"', '#', '%']) || canonical(word, scope.german).is_some();
                        let whole = without_slice(word).unwrap_or(word);
                        if let Some(key) = names.key(whole, scope).filter(|_| is_name || word.contains('.')) {
                            add(&key, word, how);
                        }
                    }
                }
            }
        }
    }
}

/// The variable of which `text` is a slice: `#w` of `#w.%B1`. `None`: it is not a slice, as `DB1.%DBX0.0` is not.
fn without_slice(text: &str) -> Option<&str> {
    let (whole, slice) = text.trim().rsplit_once(".%")?;
    let number = slice.strip_prefix(['X', 'B', 'W', 'D', 'x', 'b', 'w', 'd'])?;
    (!number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit())).then_some(whole)
}

/// Names and addresses of a line of SCL.
fn words(text: &str) -> impl Iterator<Item = &str> {
    let mut quoted = false;
    text.split(move |c: char| {
        if c == '"' {
            quoted = !quoted;
        }
        !(quoted || c.is_alphanumeric() || matches!(c, '"' | '#' | '%' | '.' | '_'))
    })
    .filter(|word| !word.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_are_uses_of_their_variables() {
        assert_eq!(without_slice("#w.%B1"), Some("#w"));
        assert_eq!(without_slice("\"D\".w.%x15 "), Some("\"D\".w"));
        assert_eq!(without_slice("%MW10.%X0"), Some("%MW10"));
        assert_eq!([without_slice("#w"), without_slice("DB1.%DBX0.0"), without_slice("DB1.%DBW2")], [None; 3]);

        let mut found = Vec::new();
        let mut add = |key: &str, _: &str, how: char| found.push((key.to_string(), how));
        let lines = ["#y := #w.%B1;".to_string()];
        of_text(&lines, Kind::Scl, &Names::default(), Scope::default(), &mut add);
        assert_eq!(found, [("#y".to_string(), 'w'), ("#w".to_string(), 'r')]);
    }
}
