//! Which format a table has, by its first lines.

use plcc_syntax::symbols::parse_address;

use super::columns::{self, Columns};
use super::s7200;

/// The formats of tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
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

pub(super) fn format(text: &str) -> Option<Format> {
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
pub(super) fn names_addresses(cell: &str) -> bool {
    ["address", "adresse"].iter().any(|title| cell.eq_ignore_ascii_case(title))
}

/// The columns that the first line names.
pub(super) fn header(text: &str, separator: u8) -> Option<Columns> {
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
