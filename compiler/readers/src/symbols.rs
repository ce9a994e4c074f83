//! Symbol tables: `.asc`, `.sdf`, `.seq`, `.dif`, `;`-separated, tag tables in XML and sheets of a workbook, distinguished by their content.
//!
//! Each row has a symbol, its address, its data type and a comment. Addresses are accepted in both mnemonic sets (`E 0.0` is
//! `I 0.0`). Tables for the S7-200 have different columns (`s7200`). A row that cannot be read is one message; the others are still read.
//! Source: STL reference, symbol tables; exports of the TIA Portal have more columns after the first three.

mod columns;
mod delimited;
mod format;
mod loose;
mod s7200;
mod sheets;
mod step7;
mod tag_table;

pub use format::is_symbol_table;
pub use sheets::is_of_tags as is_workbook_of_tags;

use format::{Format, format, header};
use plcc_diag::{Code, Diagnostic, FileId, Severity, SourceFile, Span};
use plcc_syntax::symbols::{
    External, GlobalConstant, S7200Symbol, Symbol, SymbolTable, SymbolTarget, UnreadableRow, address_fault,
    meant_address, parse_address,
};

/// What clients may do with a tag by two settings, which are true unless a table says that they are not.
fn external(accessible: Option<&str>, writable: Option<&str>) -> External {
    let is_denied = |setting: Option<&str>| setting.is_some_and(|text| text.trim().eq_ignore_ascii_case("false"));
    match (is_denied(accessible), is_denied(writable)) {
        (true, _) => External::Hidden,
        (false, true) => External::Read,
        (false, false) => External::Write,
    }
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
        let external = External::default();
        Symbol { name: tag.name, target, ty: tag.ty, comment: String::new(), external, span: tag.span }
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
            external: External::default(),
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
        message.title = "this line of the symbol table has a different form from the others".to_string();
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
        message.title = match line.contains(loose::is_curved_quote) {
            true => "a symbol table has straight quotes".to_string(),
            false => "the columns of this symbol table have none of the known forms".to_string(),
        };
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
}

/// The message for a misspelt name of a column.
fn misspelt(span: Span, written: &str, meant: &str) -> Diagnostic {
    let title = format!("`{written}` is not the name of a column of tags");
    let mut message = Diagnostic::new(Code::SymbolTable, span, title).label(format!("read as `{meant}`"));
    message.severity = Severity::Error;
    message.help(format!("write `{meant}`"))
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
mod tests;
