//! Workbooks (`.xlsx`) with tag tables, as the TIA Portal exports them: each sheet becomes lines of text for the reader of symbol tables.
//!
//! ```text
//! Sheet TAB PLC Tags
//! 1 TAB Name TAB Path TAB Data Type TAB Logical Address …
//! 2 TAB Lamp TAB Default tag table TAB Bool TAB %Q4.1 …
//! ```
//!
//! A line has the number of its row first, so that messages can name it.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;

use calamine::{DataRef, Reader, Xlsx, XlsxError};
use plcc_readers::symbols;

/// Columns and rows beyond these hold no tags.
const COLUMNS_MAX: u32 = 64;
const ROWS_MAX: u32 = 200_000;

/// Whether a file is a workbook, from its name. Next to an open workbook there is a lock file, `~$name.xlsx`.
pub fn is_workbook(path: &Path) -> bool {
    let locks = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("~$"));
    let is = |known: &str| path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case(known));
    !locks && (is("xlsx") || is("xlsm"))
}

/// The sheets as text; `None`: none is a table of tags or constants. `Err`: why the workbook cannot be read.
pub fn text(bytes: Vec<u8>) -> Result<Option<String>, String> {
    let mut workbook: Xlsx<_> = Xlsx::new(Cursor::new(bytes)).map_err(reason)?;
    let mut text = String::new();
    for name in workbook.sheet_names() {
        text.push_str(&format!("Sheet\t{}\n", cell(&name)));
        let sheet = rows(&mut workbook, &name).map_err(|why| format!("sheet `{name}`: {why}"))?;
        for (number, cells) in sheet {
            let last = cells.keys().last().copied().unwrap_or(0);
            let cells: Vec<&str> = (0..=last).map(|column| cells.get(&column).map_or("", String::as_str)).collect();
            text.push_str(&format!("{}\t{}\n", number + 1, cells.join("\t")));
        }
    }
    Ok(Some(text).filter(|text| symbols::is_workbook_of_tags(text)))
}

/// The non-empty cells of a sheet, by row and column. They are read one by one, so a single cell in the last corner costs nothing.
fn rows(workbook: &mut Xlsx<Cursor<Vec<u8>>>, name: &str) -> Result<BTreeMap<u32, BTreeMap<u32, String>>, String> {
    let mut rows: BTreeMap<u32, BTreeMap<u32, String>> = BTreeMap::new();
    let mut reader = workbook.worksheet_cells_reader(name).map_err(reason)?;
    while let Some(found) = reader.next_cell().map_err(reason)? {
        let (row, column) = found.get_position();
        let text = match found.get_value() {
            DataRef::Empty => continue,
            DataRef::Error(error) => return Err(format!("row {}: a cell contains the error `{error}`", row + 1)),
            DataRef::Bool(value) => if *value { "True" } else { "False" }.to_string(),
            DataRef::Int(value) => value.to_string(),
            DataRef::Float(value) => value.to_string(),
            DataRef::String(value) => cell(value),
            DataRef::SharedString(value) => cell(value),
            DataRef::DateTimeIso(value) | DataRef::DurationIso(value) => cell(value),
            DataRef::DateTime(_) => return Err(format!("row {}: a cell contains a date", row + 1)),
        };
        if text.is_empty() || column >= COLUMNS_MAX {
            continue;
        }
        if row >= ROWS_MAX {
            return Err(format!("row {}: a tag table has at most {ROWS_MAX} rows", row + 1));
        }
        rows.entry(row).or_default().insert(column, text);
    }
    Ok(rows)
}

/// The text of a cell on one line.
fn cell(text: &str) -> String {
    text.replace(['\t', '\n', '\r'], " ").trim().to_string()
}

fn reason(error: XlsxError) -> String {
    error.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_workbook_is_told() {
        assert!(text(b"Name;Address\n".to_vec()).is_err());
        assert!(is_workbook(Path::new("PLCTags.XLSX")) && !is_workbook(Path::new("tags.xml")));
    }
}
