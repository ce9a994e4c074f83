//! Symbol tables: `.asc`, `.sdf`, `.seq`, `.dif`, `;`-separated, tag tables in XML and sheets of a workbook, distinguished by their content.
//!
//! Each row has a symbol, its address, its data type and a comment. Addresses are accepted in both mnemonic sets (`E 0.0` is
//! `I 0.0`). Tables for the S7-200 have different columns (`s7200`). A row that cannot be read is one message; the others are still read.
//! Source: STL reference, symbol tables; exports of the TIA Portal have more columns after the first three.

mod columns;
mod loose;
mod s7200;
mod sheets;
mod tag_table;

pub use sheets::is_of_tags as is_workbook_of_tags;

use columns::Columns;
use plcc_diag::{Code, Diagnostic, FileId, Severity, SourceFile, Span};
use plcc_syntax::symbols::{
    GlobalConstant, QUOTE_MISSING, S7200Symbol, Symbol, SymbolTable, SymbolTarget, UnreadableRow, address_fault,
    meant_address, parse_address,
};

/// The formats of tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Asc,
    Sdf,
    Seq,
    Dif,
    Semicolon,
    /// Columns that the first line names, with their separator.
    Columns(u8),
    /// Name, address and comment of the S7-200, with the separator between them.
    Plain(char),
}

/// True if `text` is a symbol table rather than a program.
pub fn is_symbol_table(text: &str) -> bool {
    format(text).is_some()
}

/// Whether some line has a name and an address, in whatever form.
pub fn has_rows(text: &str) -> bool {
    text.lines().any(|line| loose::row(line).is_some())
}

/// The variables of a project in PLCopen XML that have an address.
fn plcopen(file: FileId, text: &str) -> (SymbolTable, Vec<Diagnostic>) {
    let (tags, diagnostics) = crate::plcopen::tags(file, text);
    let symbol = |tag: crate::plcopen::Tag| {
        let target = SymbolTarget::Memory { area: tag.area, width: tag.width, byte: tag.byte, bit: tag.bit };
        Symbol { name: tag.name, target, ty: tag.ty, comment: String::new(), span: tag.span }
    };
    (SymbolTable { symbols: tags.into_iter().map(symbol).collect(), ..SymbolTable::default() }, diagnostics)
}

/// Reads the table in `source`, which is file `file`.
pub fn parse(file: FileId, source: &SourceFile) -> (SymbolTable, Vec<Diagnostic>) {
    match crate::xml::kind(&source.text) {
        Some(crate::xml::XmlKind::PlcOpen) => return plcopen(file, &source.text),
        Some(_) => return tag_table::parse(file, &source.text),
        None => {}
    }
    if sheets::is_workbook(&source.text) {
        return sheets::parse(file, &source.text);
    }
    let mut reader = Reader {
        file,
        text: &source.text,
        table: SymbolTable::default(),
        only_s7200: Vec::new(),
        only_s7300: false,
        diagnostics: Vec::new(),
    };
    match format(&source.text) {
        Some(Format::Asc) => reader.asc(),
        Some(Format::Sdf) => reader.delimited(b',', None),
        Some(Format::Semicolon) => reader.delimited(b';', None),
        Some(Format::Columns(separator)) => reader.delimited(separator, header(&source.text, separator)),
        Some(Format::Seq) => reader.seq(),
        Some(Format::Dif) => reader.dif(),
        Some(Format::Plain(separator)) => reader.plain(separator),
        None => reader.loose(),
    }
    // Rows of the S7-200 in a table of S7-300/400 are mistakes.
    if reader.only_s7300 {
        reader.diagnostics.append(&mut reader.only_s7200);
        reader.diagnostics.sort_by_key(|diagnostic| diagnostic.primary.span.start);
    }
    (reader.table, reader.diagnostics)
}

fn format(text: &str) -> Option<Format> {
    let text = text.trim_start_matches('\u{feff}');
    let mut rows = text.lines().filter(|line| !line.trim().is_empty());
    let first = rows.next()?;
    if first.starts_with("126,") && first.chars().count() > 20 {
        return Some(Format::Asc);
    }
    if first.trim() == "TABLE" && rows.next().is_some_and(|line| line.trim_start().starts_with("0,")) {
        return Some(Format::Dif);
    }
    if first.starts_with('\t') && first.split('\t').nth(1).is_some_and(|address| parse_address(address).is_some()) {
        return Some(Format::Seq);
    }
    if first.trim_start().starts_with('"') && first.matches("\",").count() >= 2 {
        return Some(Format::Sdf);
    }
    // Written by hand: names of the columns first, or without quotes. A table of the S7-200 has a comment in the third column.
    let mut fields = first.split(',').map(|field| field.trim().trim_matches('"'));
    let second = fields.nth(1).unwrap_or_default();
    let is_type =
        fields.next().is_some_and(|ty| plcc_syntax::Elementary::from_word(&ty.to_ascii_uppercase()).is_some());
    if names_addresses(second) && first.trim_start().starts_with('"') || is_type && parse_address(second).is_some() {
        return Some(Format::Sdf);
    }
    // The same with `;`, as a spreadsheet saves it.
    let address = first.split(';').nth(1).map(|field| field.trim().trim_matches('"'));
    if first.trim_start().starts_with('"')
        && first.contains("\";")
        && address.is_some_and(|address| parse_address(address).is_some() || names_addresses(address))
    {
        return Some(Format::Semicolon);
    }
    // A header line may come before the rows.
    let is_row = |line: &str| {
        let mut fields = line.split(';');
        let name = fields.next().unwrap_or("").trim();
        !name.is_empty() && fields.next().is_some_and(|address| parse_address(address).is_some())
    };
    let is_header = |line: &str| line.split(';').count() >= 3 && line.to_ascii_lowercase().contains("address");
    if is_row(first) || (is_header(first) && rows.next().is_none_or(is_row)) {
        return Some(Format::Semicolon);
    }
    let named = [b';', b',', b'\t'].into_iter().find(|separator| names_columns(text, *separator));
    let plain = || s7200::separator(text).map(Format::Plain);
    match named {
        // Without types it may be a table of the S7-200.
        Some(separator) if header(text, separator).is_some_and(|columns| columns.ty.is_none()) => {
            plain().or(Some(Format::Columns(separator)))
        }
        Some(separator) => Some(Format::Columns(separator)),
        None => plain(),
    }
}

/// Whether a cell of the first line is the title of the addresses, in English or German.
fn names_addresses(cell: &str) -> bool {
    ["address", "adresse"].iter().any(|title| cell.eq_ignore_ascii_case(title))
}

/// The columns that the first line names.
fn header(text: &str, separator: u8) -> Option<Columns> {
    let first = text.trim_start_matches('\u{feff}').lines().find(|line| !line.trim().is_empty())?;
    columns::read(first.split(separator as char).map(|cell| cell.trim().trim_matches('"')))
}

/// Whether the first line names columns, one of them of addresses, and another line has an address there.
fn names_columns(text: &str, separator: u8) -> bool {
    let Some(at) = header(text, separator).and_then(|columns| columns.address) else { return false };
    let cell = |line: &str| line.split(separator as char).nth(at).map(|cell| cell.trim().trim_matches('"').to_string());
    let mut cells = text.lines().skip(1).filter_map(cell);
    cells.any(|cell| parse_address(&cell).is_some() || s7200::is_address(&cell))
}

struct Reader<'a> {
    file: FileId,
    text: &'a str,
    table: SymbolTable,
    /// The messages for rows that only the S7-200 has, if the table is for S7-300/400.
    only_s7200: Vec<Diagnostic>,
    /// Whether some row has an address that the S7-200 does not have.
    only_s7300: bool,
    diagnostics: Vec<Diagnostic>,
}

impl Reader<'_> {
    fn span(&self, start: usize, line: &str) -> Span {
        let trimmed = line.trim();
        let skipped = line.len() - line.trim_start().len();
        Span::new(self.file, start + skipped..start + skipped + trimmed.len())
    }

    fn bad(&mut self, start: usize, line: &str, why: &str) {
        let message = self.message(start, line, why);
        self.diagnostics.push(message);
    }

    fn message(&self, start: usize, line: &str, why: &str) -> Diagnostic {
        Diagnostic::new(Code::SymbolTable, self.span(start, line), "this line of the symbol table cannot be read")
            .label(why)
            .help("a row contains a symbol, its address such as `I 0.0` or `FC 105`, its data type and a comment")
    }

    fn row(&mut self, start: usize, line: &str, name: &str, address: &str, ty: &str, comment: &str) {
        let name = name.trim();
        let address = address.trim();
        if name.is_empty() && address.is_empty() {
            return;
        }
        if name.is_empty() {
            return self.bad(start, line, "the symbol is missing");
        }
        if address.is_empty() {
            let (reason, span) = (format!("`{name}` has no address"), self.span(start, line));
            self.bad(start, line, &reason);
            let row = UnreadableRow { name: name.to_string(), reason, meant: None, span };
            return self.table.unreadable.push(row);
        }
        let of_s7200 = self.keep_s7200(start, line, name, address, comment.trim());
        let Some(target) = parse_address(address) else {
            if parse_address(name).is_some() {
                return self.exchanged(start, line, address, name);
            }
            let why = address_fault(address);
            let span = self.span(start, line);
            self.table.unreadable.push(UnreadableRow {
                name: name.to_string(),
                reason: why.clone(),
                meant: meant_address(address),
                span,
            });
            if of_s7200 {
                let message = self.message(start, line, &why);
                return self.only_s7200.push(message);
            }
            return self.bad(start, line, &why);
        };
        self.only_s7300 |= !of_s7200;
        let symbol = Symbol {
            name: name.to_string(),
            target,
            ty: ty.trim().to_string(),
            comment: comment.trim().to_string(),
            span: self.span(start, line),
        };
        self.table.symbols.push(symbol);
    }

    /// A row whose symbol is in the column of the address.
    fn exchanged(&mut self, start: usize, line: &str, name: &str, address: &str) {
        let span = self.span(start, line);
        let reason = "symbol and address are exchanged".to_string();
        self.bad(start, line, &reason);
        self.table.unreadable.push(UnreadableRow {
            name: name.to_string(),
            reason,
            meant: Some(address.to_string()),
            span,
        });
    }

    /// Reports a row whose form is wrong, and reads it as it is meant; false: it is not clear what is meant.
    fn as_meant(&mut self, start: usize, line: &str, label: &str, help: &str) -> bool {
        let Some(row) = loose::row(line) else { return false };
        let mut message = self.message(start, line, label).help(help);
        message.severity = Severity::Error;
        message.title = "this line of the symbol table has another form than the table".to_string();
        self.diagnostics.push(message);
        self.row(start, line, row.name, row.address, row.ty, "");
        true
    }

    /// A table in none of the forms: rows are read as they are meant, and one message says that.
    fn loose(&mut self) {
        let text = self.text;
        let rows = || lines(text).filter(|(_, line)| !line.trim().is_empty());
        let first = rows().find_map(|(start, line)| Some((start, line, loose::row(line)?)));
        let Some((start, line, row)) = first else {
            let (start, line) = rows().next().unwrap_or((0, ""));
            return self.bad(
                start,
                line,
                "this is not one of the formats .asc, .sdf, .seq, .dif or `;`-separated text",
            );
        };
        let mut message =
            self.message(start, line, "neither a row of .asc, .sdf, .seq, .dif nor of `;`-separated text");
        message.title = "the columns of this symbol table are in none of the known forms".to_string();
        message.severity = Severity::Error;
        let ty = if row.ty.is_empty() { "BOOL" } else { row.ty };
        self.diagnostics.push(message.help(format!(
            "write each row as a `.sdf` file has it: `\"{}\",\"{}\",\"{ty}\",\"\"`",
            row.name, row.address
        )));
        for (start, line) in rows() {
            if let Some(row) = loose::row(line) {
                self.row(start, line, row.name, row.address, row.ty, "");
            }
        }
    }

    /// `126,` then 24 + 12 + 10 + 80 characters; the record may lack trailing blanks and its line end.
    fn asc(&mut self) {
        let text = self.text;
        for (start, line) in lines(text) {
            let mut at = start;
            let mut rest = line.trim_start_matches('\u{feff}');
            at += line.len() - rest.len();
            while !rest.trim().is_empty() {
                let Some(payload) = rest.strip_prefix("126,") else {
                    if !self.as_meant(at, rest, "a record begins with `126,`", "write `126,` before the symbol") {
                        self.bad(at, rest, "a record begins with `126,`");
                    }
                    break;
                };
                let end = payload.char_indices().nth(126).map_or(payload.len(), |(end, _)| end);
                let record = &payload[..end];
                let mut fields = [24, 12, 10, 80].into_iter().scan(record, |left, width| {
                    let cut = left.char_indices().nth(width).map_or(left.len(), |(cut, _)| cut);
                    let (field, right) = left.split_at(cut);
                    *left = right;
                    Some(field)
                });
                let mut field = || fields.next().unwrap_or("");
                let (name, address, ty, comment) = (field(), field(), field(), field());
                if parse_address(address).is_none()
                    && loose::row(rest).is_some_and(|row| row.address != address.trim())
                    && self.as_meant(
                        at,
                        rest,
                        "its columns are shifted",
                        "the symbol has 24 characters, filled with blanks, the address 12, the data type 10, the comment 80",
                    )
                {
                    break;
                }
                self.row(at, &rest[..4 + end], name, address, ty, comment);
                at += 4 + end;
                rest = &payload[end..];
            }
        }
    }

    /// Quoted or bare fields, in the order of STEP 7, or in `columns`, which the first line names. A line with a missing quote is removed
    /// first, so it does not affect other rows.
    fn delimited(&mut self, delimiter: u8, columns: Option<Columns>) {
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
                    // A tag whose address was not entered.
                    if !address.is_empty() || field(Some(columns.name)).is_empty() {
                        self.row(start, line, field(Some(columns.name)), address, field(columns.ty), comment);
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
            let comment = if record.len() > 6 { field(6) } else { field(3) };
            self.row(start, line, field(0), field(1), field(2), comment);
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

    /// TAB address TAB symbol TAB comment.
    fn seq(&mut self) {
        let text = self.text;
        for (start, line) in lines(text) {
            let bare = line.trim_start_matches('\u{feff}');
            if bare.trim().is_empty() {
                continue;
            }
            let mut fields = bare.strip_prefix('\t').unwrap_or(bare).split('\t');
            let address = fields.next().unwrap_or("");
            let Some(name) = fields.next() else {
                self.bad(start, line, "address, symbol and comment are separated by tabs");
                continue;
            };
            let comment = fields.next().unwrap_or("");
            self.row(start, line, name, address, "", comment);
        }
    }

    /// Data interchange format: `BOT`, then the strings of a row, until the next `BOT` or `EOD`.
    fn dif(&mut self) {
        let text = self.text;
        let mut in_data = false;
        let mut row: Vec<String> = Vec::new();
        let mut row_start: Option<(usize, usize)> = None;
        let mut lines = lines(text).map(|(start, line)| (start, line.trim())).peekable();
        while let Some((start, line)) = lines.next() {
            if !in_data {
                in_data = line == "DATA";
                if in_data {
                    // `0,0` and the empty title of the section.
                    lines.next();
                    lines.next();
                }
                continue;
            }
            if line.starts_with("-1,") {
                let Some((_, word)) = lines.next() else { break };
                self.finish_dif_row(&mut row, &mut row_start);
                let word = match word {
                    "BOT" | "EOD" => word,
                    other => {
                        self.bad(start, line, "`BOT` or `EOD` must follow");
                        plcc_literal::distance::nearest(other, ["BOT", "EOD"].into_iter()).unwrap_or_default()
                    }
                };
                match word {
                    "BOT" => row_start = Some((start, start + line.len())),
                    "EOD" => return,
                    _ => {}
                }
            } else if line.starts_with("1,") || line.starts_with("0,") {
                if let Some((start, value)) = lines.next() {
                    row.push(unquoted(value));
                    if let Some(row) = &mut row_start {
                        row.1 = start + value.len();
                    }
                }
            } else if !line.is_empty() {
                self.bad(start, line, "a value begins with `1,0`");
            }
        }
        self.finish_dif_row(&mut row, &mut row_start);
    }

    fn finish_dif_row(&mut self, row: &mut Vec<String>, place: &mut Option<(usize, usize)>) {
        if let Some((start, end)) = place.take() {
            let fields: Vec<String> = std::mem::take(row);
            let field = |at: usize| fields.get(at).map_or("", String::as_str);
            let text = self.text.get(start..end).unwrap_or("");
            if !fields.is_empty() {
                self.row(start, text, field(0), field(1), field(2), field(3));
            }
        }
        row.clear();
    }
}

/// The message for a misspelt name of a column.
fn misspelt(span: Span, written: &str, meant: &str) -> Diagnostic {
    let title = format!("`{written}` is not the name of a column of tags");
    let mut message = Diagnostic::new(Code::SymbolTable, span, title).label(format!("read as `{meant}`"));
    message.severity = Severity::Error;
    message.help(format!("write `{meant}`"))
}

fn unquoted(text: &str) -> String {
    let text = text.trim();
    match text.strip_prefix('"').and_then(|text| text.strip_suffix('"')) {
        Some(inner) => inner.replace("\"\"", "\""),
        None => text.to_string(),
    }
}

/// Lines with the byte at which each begins, without their ends.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut at = 0;
    text.split_inclusive('\n').map(move |line| {
        let start = at;
        at += line.len();
        (start, line.trim_end_matches(['\n', '\r']))
    })
}

#[cfg(test)]
mod tests {
    use plcc_syntax::ast::{Area, BlockPrefix, CellKind, Width};

    use super::*;

    fn read(text: &str) -> (Vec<(String, SymbolTarget, String)>, usize) {
        assert!(is_symbol_table(text), "not taken for a table: {text:?}");
        let (table, diagnostics) = parse(FileId(0), &SourceFile::new("table", text));
        assert!(diagnostics.iter().all(|diagnostic| diagnostic.code == Code::SymbolTable));
        let rows = table.symbols.into_iter().map(|symbol| (symbol.name, symbol.target, symbol.ty)).collect();
        (rows, diagnostics.len())
    }

    const LAMP: SymbolTarget = SymbolTarget::Memory { area: Area::Q, width: Width::Bit, byte: 4, bit: 1 };
    const SCALE: SymbolTarget = SymbolTarget::Block { prefix: BlockPrefix::Fc, number: 105 };

    #[test]
    fn fixed_columns() {
        let text = format!(
            "126,{:<24}{:<12}{:<10}{:<80}\r\n126,{:<24}{:<12}{:<10}\n126,nonsense\n",
            "Lamp on", "A       4.1", "BOOL", "text", "SCALE", "FC    105", "FC    105"
        );
        let (rows, bad) = read(&text);
        assert_eq!(rows[0], ("Lamp on".to_string(), LAMP, "BOOL".to_string()));
        assert_eq!(rows[1].1, SCALE);
        assert_eq!((rows.len(), bad), (2, 1));
    }

    #[test]
    fn quoted_fields() {
        let text = "\"Lamp on   \",\"Q      4.1 \",\"BOOL      \",\"a \"\"text\"\", and more\"\n\"x\",\"broken\n\"SCALE\",\"FC 105\",\"FC 105\",\"\"\n";
        let (rows, bad) = read(text);
        assert_eq!(rows[0].1, LAMP);
        assert_eq!(rows[1].1, SCALE);
        assert_eq!((rows.len(), bad), (2, 1));
    }

    #[test]
    fn portal_columns() {
        let (rows, bad) = read("\"Lamp\",\"%Q4.1\",\"Bool\",\"True\",\"True\",\"False\",\"text\",\"\",\"True\"\n");
        assert_eq!((rows[0].1, bad), (LAMP, 0));
    }

    #[test]
    fn assignment_list() {
        let (rows, bad) = read("\tA 4.1\tLamp on\ttext\r\n\tFC 105\tSCALE\t\r\n\tFC\r\n");
        assert_eq!((rows[0].1, rows[1].1, bad), (LAMP, SCALE, 1));
    }

    #[test]
    fn interchange_format() {
        let text = "TABLE\n0,1\n\"t\"\nVECTORS\n0,2\n\"\"\nTUPLES\n0,4\n\"\"\nDATA\n0,0\n\"\"\n-1,0\nBOT\n1,0\n\"Lamp\"\n1,0\n\"Q 4.1\"\n1,0\n\"BOOL\"\n1,0\n\"\"\n-1,0\nBOT\n1,0\n\"SCALE\"\n1,0\n\"FC  105\"\n1,0\n\"FC  105\"\n1,0\n\"\"\n-1,0\nEOD\n";
        let (rows, bad) = read(text);
        assert_eq!((rows.len(), rows[0].1, rows[1].1, bad), (2, LAMP, SCALE, 0));
    }

    #[test]
    fn semicolons_with_and_without_header() {
        let (rows, bad) = read("Lamp;A 4.1;BOOL;text\nSCALE;FC105;FC 105;\n");
        assert_eq!((rows[0].1, rows[1].1, bad), (LAMP, SCALE, 0));
        let (rows, bad) = read("Symbol;Address;Type;Comment\nLamp;Q4.1;BOOL;\nx;y;z\n");
        assert_eq!((rows[0].1, rows.len(), bad), (LAMP, 1, 1));
    }

    fn rows_of_s7200(text: &str) -> Vec<(String, String, String)> {
        assert!(is_symbol_table(text), "not taken for a table: {text:?}");
        let (table, diagnostics) = parse(FileId(0), &SourceFile::new("table", text));
        assert_eq!(diagnostics, []);
        for row in &table.s7200 {
            assert!(
                text[row.name_span.range()].contains(&row.name)
                    && text[row.address_span.range()].contains(&row.address)
            );
        }
        table.s7200.into_iter().map(|row| (row.name, row.address, row.comment)).collect()
    }

    #[test]
    fn tables_for_the_s7_200() {
        let row =
            |name: &str, address: &str, comment: &str| (name.to_string(), address.to_string(), comment.to_string());
        assert_eq!(
            rows_of_s7200(
                "Motor\tQ0.0\tthe pump, large\r\nLevel\tVW100\t\r\nFirst\tSM0.1\r\nMixer\tSBR3\tblock\r\nMax\t16#FF\r\n"
            ),
            [
                row("Motor", "Q0.0", "the pump, large"),
                row("Level", "VW100", ""),
                row("First", "SM0.1", ""),
                row("Mixer", "SBR3", "block"),
                row("Max", "16#FF", "")
            ]
        );
        assert_eq!(
            rows_of_s7200("Symbol,Address,Comment\n水泵,Q0.0,\nTime,T37,5 s\n"),
            [row("水泵", "Q0.0", ""), row("Time", "T37", "5 s")]
        );
        assert_eq!(
            rows_of_s7200("Level;VW100;text\nStop;I0.1;\n"),
            [row("Level", "VW100", "text"), row("Stop", "I0.1", "")]
        );
        let german = "\"Symbol\",\"Adresse\",\"Kommentar\"\n\"Motor\",\"A0.0\",\"Pumpe\"\n\"Level\",\"VW100\",\"\"\n";
        assert_eq!(rows_of_s7200(german), [row("Motor", "A0.0", ""), row("Level", "VW100", "")]);
        // Both families can read these.
        let (table, _) = parse(FileId(0), &SourceFile::new("table", "Key\tI0.0\t\nLamp\tM1.5\t\n"));
        assert_eq!((table.symbols.len(), table.s7200.len()), (2, 2));
        let (table, _) = parse(FileId(0), &SourceFile::new("table", "\tE 0.0\tKey\t\n"));
        assert_eq!((table.s7200[0].address.as_str(), table.symbols.len()), ("E0.0", 1));
        // A table for S7-300 with a bad row.
        let (_, bad) = read("Lamp;A 4.1;BOOL;text\nSCALE;FC105;FC 105;\nx;VW 100;WORD;\n");
        assert_eq!(bad, 1);
    }

    #[test]
    fn programs_are_no_tables() {
        for text in [
            "A I 0.0; = Q 4.0;\n",
            "\tA I 0.0\n\t= Q 4.0\n",
            "FUNCTION FC 1 : VOID\n",
            "",
            "L 1; T MW 2; BE\n",
            "LD\tI0.0\nA\tI0.1\n",
            "VW0 1\nSpeed\t5, 6\n",
            "Speed, 5\n",
            "TON\tT37, 50\nMOVW\tVW0, VW2\n",
        ] {
            assert!(!is_symbol_table(text), "{text:?}");
        }
    }

    #[test]
    fn addresses() {
        assert_eq!(
            parse_address("MW  10"),
            Some(SymbolTarget::Memory { area: Area::M, width: Width::Word, byte: 10, bit: 0 })
        );
        assert_eq!(parse_address("Z 5"), Some(SymbolTarget::Cell { kind: CellKind::Counter, number: 5 }));
        for bad in ["M 10", "MW 10.1", "M 10.8", "DBX 1.0", "FC", "10", "", "MW 99999999"] {
            assert_eq!(parse_address(bad), None, "{bad}");
        }
    }
}
