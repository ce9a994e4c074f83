//! From a word to its declaration, to all its uses, and to another name.

use std::path::Path;

use plcc_diag::{FileId, Span};
use plcc_readers::gr7;
use plcc_syntax::Language;
use plcc_syntax::ast::Block;
use plcc_syntax::scl::keyword::Keyword;
use plcc_syntax::symbols::{Symbol, SymbolTarget};

use crate::address;
use crate::chart;
use crate::constants::{self, Constant};
use crate::facts::same;
use crate::hover::target_text;
use crate::index::{Declared, Entry, Index};
use crate::labels;
use crate::names::{Meaning, along, meaning, open_bracket};
use crate::role::{self, Role};
use crate::values;
use crate::words::{Words, bare};

/// A text of each file of the program, which editors show; then their assertions.
pub type Texts<'t> = Vec<(FileId, Words<'t>)>;

/// What the row of a symbol table at a byte of a file names, the name, and where that is.
pub fn in_row<'c>(index: &Index<'c>, file: FileId, byte: usize) -> Option<(Meaning<'c>, String, Span)> {
    let is_it = |span: Span| span.file == file && (span.start as usize..=span.end as usize).contains(&byte);
    let mut symbols = index.checked.tables.iter().flat_map(|table| &table.symbols);
    let mut constants = index.checked.tables.iter().flat_map(|table| &table.constants);
    let row = symbols.find(|symbol| is_it(symbol.span)).map(|symbol| (symbol.span, &symbol.name));
    let (row, name) = row.or_else(|| constants.find(|one| is_it(one.span)).map(|one| (one.span, &one.name)))?;
    let quoted = format!("\"{name}\"");
    let found = along(index, None, &[quoted.as_str()], false)?;
    Some((found, name.clone(), name_in_row(index, row, name).unwrap_or(row)))
}

/// What a byte of a file means, and its name there; also in the row of a symbol table.
pub fn asked<'c>(index: &Index<'c>, words: &Words, file: FileId, byte: usize) -> Option<(Meaning<'c>, String)> {
    if let Some((found, name, _)) = in_row(index, file, byte) {
        return Some((found, name));
    }
    index.checked.units.iter().find(|(own, _)| *own == file)?;
    let at = words.at(byte)?;
    meaning(index, words, file, at).map(|found| (found, bare(words.word(at)).to_owned()))
}

/// Every place that means the same, the declaration included, also in a symbol table. Absolute addresses: every one that has a bit in
/// common, and symbols of such addresses.
pub fn references(index: &Index, texts: &Texts, (wanted, name): &(Meaning, String)) -> Vec<Span> {
    let address = match wanted {
        Meaning::Address(address) => Some(address.clone()),
        Meaning::Symbol(symbol) => match symbol.target {
            SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. } => {
                address::plain(&target_text(symbol.target).replace(' ', ""))
            }
            SymbolTarget::Block { .. } => None,
        },
        Meaning::Variable { .. }
        | Meaning::Block(_)
        | Meaning::Library(_)
        | Meaning::Function(_)
        | Meaning::Constant(_)
        | Meaning::Label(_)
        | Meaning::Chart(_)
        | Meaning::Word(_) => None,
    };
    let mut found = match address {
        Some(address) => overlapping(index, texts, &address),
        None => same_definition(index, texts, wanted, name),
    };
    let symbol = index.symbol(name).filter(|_| matches!(wanted, Meaning::Symbol(_) | Meaning::Block(_)));
    found.extend(symbol.and_then(|symbol| name_in_row(index, symbol.span, &symbol.name)));
    if let Meaning::Constant(Constant::Global(constant)) = wanted {
        found.extend(name_in_row(index, constant.span, &constant.name));
    }
    found.sort_by_key(|span| (span.file, span.start));
    found.dedup();
    found
}

/// The name in a row of a symbol table. XML has `&amp;` in place of `&`, and may have `&gt;` in place of `>`.
fn name_in_row(index: &Index, row: Span, name: &str) -> Option<Span> {
    let text = index.checked.sources.text(row);
    let short = escaped(name);
    let long = short.replace('>', "&gt;").replace('\'', "&apos;");
    let mut written = [name, &short, &long].into_iter();
    let range = written.find_map(|name| text.find(name).map(|start| start..start + name.len()))?;
    let first = row.start as usize;
    Some(Span::new(row.file, first + range.start..first + range.end))
}

/// A name as XML writes it.
fn escaped(name: &str) -> String {
    name.replace('&', "&amp;").replace('<', "&lt;")
}

/// The places whose word is declared where this one is.
fn same_definition(index: &Index, texts: &Texts, wanted: &Meaning, name: &str) -> Vec<Span> {
    let Some(definition) = wanted.definition() else { return Vec::new() };
    let is_block = matches!(wanted, Meaning::Block(_));
    let mut found = Vec::new();
    for (file, words) in texts {
        for at in 0..words.pieces.len() {
            let word = words.word(at);
            let is_number = || matches!(wanted, Meaning::Chart(part) if part.is_number(bare(word)));
            let may_be = same(bare(word), name) || is_block && may_be_number(words, at) || is_number();
            if may_be
                && let Some(other) = meaning(index, words, *file, at)
                && other.definition() == Some(definition)
            {
                found.push(Span::new(*file, words.range(at)));
            }
        }
    }
    found
}

/// Whether a piece may be part of `FC 1` or `FC1`.
fn may_be_number(words: &Words, at: usize) -> bool {
    let word = words.word(at);
    let letters = word.trim_end_matches(|c: char| c.is_ascii_digit());
    let letters = if letters.is_empty() && at > 0 { words.word(at - 1) } else { letters };
    ["OB", "FC", "FB", "SFC", "SFB", "DB", "DI", "UDT"].iter().any(|prefix| prefix.eq_ignore_ascii_case(letters))
}

/// The places of addresses that overlap, and of their symbols, also in their tables.
fn overlapping(index: &Index, texts: &Texts, wanted: &address::Address) -> Vec<Span> {
    let symbols: Vec<&Symbol> = index
        .checked
        .tables
        .iter()
        .flat_map(|table| &table.symbols)
        .filter(|symbol| {
            let own = target_text(symbol.target).replace(' ', "");
            address::plain(&own).is_some_and(|own| own.overlaps(wanted))
        })
        .collect();
    let rows = symbols.iter().filter_map(|symbol| name_in_row(index, symbol.span, &symbol.name));
    let mut found: Vec<Span> = rows.collect();
    for (file, words) in texts {
        let mut at = 0;
        while at < words.pieces.len() {
            if let Some(address) = address::at(words, at) {
                if address.overlaps(wanted) {
                    let end = words.range(at + address.pieces - 1).end;
                    found.push(Span::new(*file, words.range(at).start..end));
                }
                at += address.pieces;
                continue;
            }
            let word = words.word(at);
            if word.starts_with('"') && symbols.iter().any(|symbol| same(&symbol.name, bare(word))) {
                found.push(Span::new(*file, words.range(at)));
            }
            at += 1;
        }
    }
    found
}

/// The edits that give what is wanted another name. `Err`: why it cannot have it.
pub fn rename(index: &Index, texts: &Texts, wanted: &Meaning, to: &str) -> Result<Vec<(Span, String)>, String> {
    let to = bare(to.trim());
    if to.is_empty() || to.chars().any(|c| c == '"' || c.is_control()) {
        return Err("a name has neither quotes nor line ends".to_owned());
    }
    let is_word = |text: &str| {
        text.starts_with(|c: char| c.is_alphabetic() || c == '_')
            && text.chars().all(|c| c.is_alphanumeric() || c == '_')
    };
    let name = match wanted {
        Meaning::Variable { declared, .. } => declared.1.name.clone(),
        Meaning::Constant(constant) => constant.name().to_owned(),
        Meaning::Label(label) => label.name.to_owned(),
        // A block of the sources would be the meaning.
        Meaning::Symbol(symbol) if matches!(symbol.target, SymbolTarget::Block { .. }) => {
            return Err(format!("`{}` is a block of the library, which is found by this name", symbol.name));
        }
        Meaning::Symbol(symbol) => symbol.name.clone(),
        Meaning::Block(entry) => match entry.name() {
            plcc_syntax::ast::BlockName::Symbol { name, .. } => name.clone(),
            plcc_syntax::ast::BlockName::Numbered { .. } => return Err("a block number is not a name".to_owned()),
        },
        Meaning::Chart(part) if part.name().is_empty() => return Err("this has only a number".to_owned()),
        Meaning::Chart(part) => part.name().to_owned(),
        Meaning::Library(_) | Meaning::Function(_) | Meaning::Address(_) | Meaning::Word(_) => {
            let names = "blocks, variables, constants, labels, steps, transitions and symbols";
            return Err(format!("only names of {names} can change"));
        }
    };
    if matches!(wanted, Meaning::Label(_)) && !is_word(to) {
        return Err("a label is a word".to_owned());
    }
    if Keyword::from_word(to).is_some()
        || ["REGION", "END_REGION", "NETWORK", "END_NETWORK"].iter().any(|own| same(own, to))
        || matches!(wanted, Meaning::Chart(_)) && gr7::is_keyword(to)
    {
        return Err(format!("`{to}` is a word of the language"));
    }
    if let Meaning::Chart(part) = wanted
        && !part.is_number(to)
        && address::plain(&to.to_uppercase()).is_some()
    {
        return Err(format!("`{to}` is an address"));
    }
    if taken(index, wanted, to) && !same(&name, to) {
        return Err(format!("`{to}` is already the name of something else"));
    }
    if let Some(file) = xml_with(index, wanted, &name) {
        return Err(format!(
            "`{name}` is in {file}, too, and blocks in XML are not edited: rename it where they come from"
        ));
    }
    // `S002` stays step 2 in its block. In an instance it is a name, of a step whose own name something else has.
    let is_number = |word: &str| matches!(wanted, Meaning::Chart(part) if part.is_number(word));
    let mut edits = Vec::new();
    for span in same_definition(index, texts, wanted, &name) {
        let word = index_text(texts, span);
        let before = Span { start: 0, end: span.start, ..span };
        if !same(bare(word), &name) && is_number(bare(word)) && !index_text(texts, before).trim_end().ends_with('.') {
            continue;
        }
        let quoted = word.trim_start_matches('#').starts_with('"') || !is_word(to);
        // In quotes alone it would be a name of the whole program.
        let becomes_global = quoted && !word.starts_with(['#', '"']) && is_local(index, texts, wanted, span);
        let hash = if word.starts_with('#') || becomes_global { "#" } else { "" };
        edits.push((span, if quoted { format!("{hash}\"{to}\"") } else { format!("{hash}{to}") }));
    }
    if let Some(symbol) = index.symbol(&name)
        && matches!(wanted, Meaning::Symbol(_) | Meaning::Block(_))
    {
        edits.push(row_edit(index, symbol.span, &name, to)?);
    }
    if let Meaning::Constant(Constant::Global(constant)) = wanted {
        edits.push(row_edit(index, constant.span, &name, to)?);
    }
    let definition = wanted.definition();
    let is_it = |names: &[&str]| {
        names.last().is_some_and(|last| same(last, &name) || is_number(last))
            && along(index, None, names, false).and_then(|found| found.definition()) == definition
    };
    edits.extend(values::edits(index.checked, to, is_it)?);
    edits.retain(|(span, _)| !index.checked.made.contains(&span.file));
    Ok(edits)
}

fn index_text<'t>(texts: &Texts<'t>, span: Span) -> &'t str {
    let words = texts.iter().find(|(file, _)| *file == span.file).map(|(_, words)| words.text);
    words.and_then(|text| text.get(span.range())).unwrap_or_default()
}

/// Whether something else has a name where `wanted` is known.
fn taken(index: &Index, wanted: &Meaning, to: &str) -> bool {
    match wanted {
        Meaning::Variable { declared, .. } => {
            let own = declared.1.name_span;
            let entry = index.around(own.file, own.start as usize);
            let of_block = |entry: Entry| entry.variables().iter().any(|(_, variable)| variable.name_span == own);
            index.siblings(own).iter().any(|(_, other)| other.name_span != own && same(&other.name, to))
                || entry.is_some_and(|entry| of_block(entry) && constants::named(entry, to).is_some())
        }
        Meaning::Constant(Constant::Local(entry, _)) => {
            constants::named(*entry, to).is_some() || entry.variables().iter().any(|(_, other)| same(&other.name, to))
        }
        Meaning::Label(label) => {
            let entry = index.around(label.span.file, label.span.start as usize);
            entry.is_some_and(|entry| {
                let is_cased = labels::are_cased(entry);
                labels::of(entry).iter().any(|own| own.name == to || !is_cased && same(own.name, to))
            })
        }
        Meaning::Chart(part) => {
            let own = part.span();
            let entry = index.around(own.file, own.start as usize);
            entry.is_some_and(|entry| in_chart(index, entry, own, to)) || is_global(index, to)
        }
        // The result of a function is a name in it.
        Meaning::Block(entry) if entry.keyword() == "FUNCTION" => {
            is_global(index, to) || entry.variables().iter().any(|(_, variable)| same(&variable.name, to))
        }
        _ => is_global(index, to),
    }
}

fn is_global(index: &Index, name: &str) -> bool {
    index.block(name).is_some() || index.symbol(name).is_some() || index.constant(name).is_some()
}

/// Whether something else than the step or transition at `own` has a name in the block of a chart or in its instance.
fn in_chart(index: &Index, entry: Entry, own: Span, name: &str) -> bool {
    let is_other = |other: &chart::Part| other.span() != own && (same(other.name(), name) || other.is_number(name));
    let facts = index.checked.facts.block(&entry.text());
    chart::of(entry).iter().any(is_other)
        || entry.variables().iter().any(|(_, variable)| same(&variable.name, name))
        || facts.is_some_and(|facts| facts.instance.iter().any(|value| same(&value.name, name)))
}

/// Whether a name in a statement of SCL or STL is found in the block around it, as it has neither `#` nor quotes.
fn is_local(index: &Index, texts: &Texts, wanted: &Meaning, span: Span) -> bool {
    let around = |span: Span| index.around(span.file, span.start as usize);
    let (Some(entry), Some(definition)) = (around(span), wanted.definition()) else { return false };
    let is_own = around(definition).is_some_and(|own| own.name().span() == entry.name().span());
    let is_code = matches!(entry.block, Block::Code(_));
    if !is_own || !is_code || span == definition || !matches!(wanted, Meaning::Variable { .. } | Meaning::Constant(_)) {
        return false;
    }
    let place = texts.iter().filter(|(file, _)| *file == span.file).find_map(|(_, words)| {
        let at = words.before(span.start as usize);
        (words.range(at) == span.range()).then_some((words, at))
    });
    place.is_some_and(|(words, at)| {
        let is_statement = matches!(words.language(at), Language::Scl | Language::Sd | Language::Stl);
        is_statement
            && (at == 0 || !matches!(words.word(at - 1), "." | "#"))
            && role::of(index, Some(entry), words, at) == Role::Any
            && !role::is_argument(Some(entry), words, at, open_bracket(words, at))
    })
}

/// The file with blocks in XML that has a name, too: nothing can be renamed there.
fn xml_with(index: &Index, wanted: &Meaning, name: &str) -> Option<String> {
    // Only a block that calls it can have a parameter of a function.
    let caller = match wanted {
        Meaning::Variable { declared: ("TEMP", _), .. }
        | Meaning::Constant(Constant::Local(..))
        | Meaning::Label(_) => {
            return None;
        }
        Meaning::Variable { declared, owner: Some(owner), .. } if owner.keyword() == "FUNCTION" => {
            let is_own = |(_, own): &Declared| own.name_span == declared.1.name_span;
            owner.variables().iter().any(is_own).then(|| owner.text())
        }
        _ => None,
    };
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    let has = |text: &str, name: &str| {
        let name = name.to_lowercase();
        let ends = |at: usize| !text[..at].ends_with(is_part) && !text[at + name.len()..].starts_with(is_part);
        !name.is_empty() && text.match_indices(&name).any(|(at, _)| ends(at))
    };
    index.checked.units.iter().find_map(|(file, _)| {
        let source = index.checked.sources.file(*file);
        let path = Path::new(&source.name);
        path.extension().filter(|extension| extension.eq_ignore_ascii_case("xml"))?;
        let text = source.text.to_lowercase();
        let found = has(&text, name) && caller.as_ref().is_none_or(|caller| has(&text, caller));
        found.then(|| path.file_name().unwrap_or_default().to_string_lossy().into_owned())
    })
}

/// The edit of a row of a symbol table: columns stay where they are, if the name has room.
fn row_edit(index: &Index, row: Span, name: &str, to: &str) -> Result<(Span, String), String> {
    let table = Path::new(&index.checked.sources.file(row.file).name);
    let is = |wanted: &str| table.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted));
    if is("xlsx") {
        return Err(format!("`{name}` is in a workbook, which is not a text file: rename it there"));
    }
    let to = if is("xml") { escaped(to) } else { to.to_owned() };
    let place = name_in_row(index, row, name).ok_or("the symbol table writes the name in another way")?.range();
    let after = &index.checked.sources.text(row)[place.end - row.start as usize..];
    let blanks = after.chars().take_while(|c| *c == ' ').count();
    let room = name.chars().count() + blanks;
    let length = to.chars().count();
    if blanks > 0 && length > room {
        return Err("the column of the symbol table is too narrow for this name".to_owned());
    }
    let padded = if blanks > 0 { format!("{to}{}", " ".repeat(room - length)) } else { to };
    Ok((Span::new(row.file, place.start..place.end + blanks), padded))
}
