//! Tables whose fields have a separator between them: `.sdf`, exports of the TIA Portal, and what a spreadsheet saves.

use plcc_syntax::symbols::{External, QUOTE_MISSING, UnreadableRow, parse_address};

use super::columns::Columns;
use super::format::names_addresses;
use super::{Reader, external, lines, misspelt};

impl Reader<'_> {
    /// Quoted or bare fields, in the order of STEP 7, or in `columns`, which the first line names. A line with a missing quote is removed
    /// first, so it does not affect other rows.
    pub(super) fn delimited(&mut self, delimiter: u8, columns: Option<Columns>) {
        let text = self.text;
        let mut rows = Vec::new();
        let mut clean = String::with_capacity(text.len());
        for (start, line) in lines(text) {
            let bare = line.trim_start_matches('\u{feff}');
            if bare.trim().is_empty() {
                continue;
            }
            if bare.bytes().filter(|&letter| letter == b'"').count() % 2 == 1 {
                self.bad(start, line, QUOTE_MISSING);
                // The message for a use of the symbol names this row.
                let name = bare.trim_start().trim_start_matches('"').split(['"', char::from(delimiter)]).next();
                if let Some(name) = name.map(str::trim).filter(|name| !name.is_empty()) {
                    let (reason, span) = (QUOTE_MISSING.to_string(), self.span(start, line));
                    self.table.unreadable.push(UnreadableRow { name: name.to_string(), reason, meant: None, span });
                }
                continue;
            }
            rows.push((start, line));
            clean.push_str(bare.trim_start());
            clean.push('\n');
        }
        let mut builder = csv::ReaderBuilder::new();
        builder.delimiter(delimiter).has_headers(false).flexible(true).trim(csv::Trim::All);
        let mut reader = builder.from_reader(clean.as_bytes());
        let mut record = csv::StringRecord::new();
        for (index, (start, line)) in rows.into_iter().enumerate() {
            if !reader.read_record(&mut record).unwrap_or(false) || record.len() < 2 {
                self.bad(start, line, "it has no field for the address");
                continue;
            }
            let field = |at: usize| record.get(at).unwrap_or("");
            if let Some(columns) = &columns {
                let field = |at: Option<usize>| at.map_or("", field);
                if index == 0 {
                    self.misspelt(columns, delimiter, start, line);
                } else {
                    let (address, comment) = (field(columns.address), field(columns.comment));
                    let name = field(Some(columns.name));
                    if address.is_empty() && !name.is_empty() {
                        let row = UnreadableRow::without_address(name.to_string(), self.span(start, line));
                        self.table.unreadable.push(row);
                    } else {
                        let before = self.table.symbols.len();
                        self.row(start, line, name, address, field(columns.ty), comment);
                        // The row may be wrong.
                        if let Some(symbol) = self.table.symbols.get_mut(before) {
                            let setting = |column: Option<usize>| column.and_then(|at| record.get(at));
                            symbol.external = external(setting(columns.accessible), setting(columns.writable));
                        }
                    }
                }
                continue;
            }
            if parse_address(field(1)).is_none()
                && field(0).contains('"')
                && self.as_meant(
                    start,
                    line,
                    &format!("a `{}` is missing between two texts", delimiter as char),
                    &format!("write `{}` between the texts in quotes", delimiter as char),
                )
            {
                continue;
            }
            // The header of a table that is kept by hand.
            let is_header = delimiter == b';' || names_addresses(field(1));
            if index == 0 && is_header && parse_address(field(1)).is_none() {
                continue;
            }
            // Exports of the TIA Portal have three flags between the type and the comment.
            let is_of_portal = record.len() > 6;
            let comment = if is_of_portal { field(6) } else { field(3) };
            let before = self.table.symbols.len();
            self.row(start, line, field(0), field(1), field(2), comment);
            // The first two are whether panels may access the tag and whether they list it. What they may not access, they do not list.
            let is_hidden = [field(3), field(4)].iter().all(|flag| flag.eq_ignore_ascii_case("false"));
            if let Some(symbol) = self.table.symbols.get_mut(before).filter(|_| is_of_portal && is_hidden) {
                symbol.external = External::Hidden;
            }
        }
    }

    /// Reports misspelt names of columns in the first line; their columns are read as what is meant.
    fn misspelt(&mut self, columns: &Columns, delimiter: u8, start: usize, line: &str) {
        for (column, meant) in &columns.misspelt {
            let Some(cell) = line.split(delimiter as char).nth(*column) else { continue };
            let at = start + (cell.as_ptr() as usize - line.as_ptr() as usize);
            let span = self.span(at, cell);
            let written = cell.trim().trim_matches('"');
            self.diagnostics.push(misspelt(span, written, meant));
        }
    }
}
