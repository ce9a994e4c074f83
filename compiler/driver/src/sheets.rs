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
use std::io::{Cursor, Read as _};
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

/// Why a workbook cannot be read, and what to do.
#[derive(Debug, PartialEq, Eq)]
pub struct Fault {
    pub why: String,
    pub help: &'static str,
}

const EXPORT_AGAIN: &str = "export the tag table again";

impl Fault {
    fn new(why: impl Into<String>) -> Fault {
        Fault { why: why.into(), help: EXPORT_AGAIN }
    }
}

/// The sheets as text; `None`: none is a table of tags or constants. `Err`: why the workbook cannot be read.
pub fn text(bytes: Vec<u8>) -> Result<Option<String>, Fault> {
    let text = all(bytes)?;
    if !symbols::is_workbook_of_tags(&text) && has_addresses(&text) {
        return Err(Fault {
            why: "no row names the columns of its tags".to_string(),
            help: "write `Name`, `Data Type` and `Logical Address` into the first row, above the columns that they name",
        });
    }
    Ok(Some(text).filter(|text| symbols::is_workbook_of_tags(text)))
}

/// Whether a cell is an address as the TIA Portal writes it, `%I0.0`.
fn has_addresses(text: &str) -> bool {
    let is_address = |cell: &str| cell.starts_with('%') && plcc_syntax::symbols::parse_address(cell).is_some();
    text.split(['\t', '\n']).any(is_address)
}

/// All sheets as text.
fn all(bytes: Vec<u8>) -> Result<String, Fault> {
    foreign(&bytes)?;
    well_formed(&bytes)?;
    let mut workbook: Xlsx<_> = Xlsx::new(Cursor::new(bytes)).map_err(|error| Fault::new(reason(error)))?;
    let mut text = String::new();
    for name in workbook.sheet_names() {
        text.push_str(&format!("Sheet\t{}\n", cell(&name)));
        let sheet = rows(&mut workbook, &name).map_err(|why| Fault::new(format!("sheet `{name}`: {why}")))?;
        for (number, cells) in sheet {
            let last = cells.keys().last().copied().unwrap_or(0);
            let cells: Vec<&str> = (0..=last).map(|column| cells.get(&column).map_or("", String::as_str)).collect();
            text.push_str(&format!("{}\t{}\n", number + 1, cells.join("\t")));
        }
    }
    Ok(text)
}

/// A file with the name of a workbook that is something else.
fn foreign(bytes: &[u8]) -> Result<(), Fault> {
    const XLS: &[u8] = &[0xd0, 0xcf, 0x11, 0xe0];
    let (why, help) = match bytes {
        [] => ("the file is empty", EXPORT_AGAIN),
        [b'P', b'K', ..] => return Ok(()),
        _ if bytes.starts_with(XLS) => {
            ("it is a workbook of Excel 97-2003, or has a password", "save it as `.xlsx` without a password")
        }
        _ if bytes.iter().take(4096).all(|byte| byte.is_ascii_graphic() || byte.is_ascii_whitespace()) => (
            "it is a text file",
            "give it a name that ends in `.csv` or `.sdf`, or save it from a spreadsheet as `.xlsx`",
        ),
        _ => ("it is not a workbook", EXPORT_AGAIN),
    };
    Err(Fault { why: why.to_string(), help })
}

/// Bytes of sheets that are looked at twice; in the rest the reader finds most faults.
const LOOKED_AT_MAX: u64 = 16 << 20;

/// Whether all sheets are well-formed: the reader of workbooks skips a cell whose tags are damaged.
fn well_formed(bytes: &[u8]) -> Result<(), Fault> {
    let broken = |_| Fault::new("the file is not complete, or damaged");
    let mut left = LOOKED_AT_MAX;
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(broken)?;
    for at in 0..archive.len() {
        let mut part = archive.by_index(at).map_err(broken)?;
        let name = part.name().to_string();
        if !name.starts_with("xl/worksheets/") || !name.ends_with(".xml") || part.size() > left {
            continue;
        }
        let mut text = String::new();
        std::io::Read::take(&mut part, left)
            .read_to_string(&mut text)
            .map_err(|_| Fault::new(format!("the part `{name}` is damaged")))?;
        left -= text.len() as u64;
        if let Err(fault) = plcc_readers::xml::parse(&text) {
            let line = text[..fault.at.min(text.len())].matches('\n').count() + 1;
            let row = row_before(&text, fault.at);
            let place = row.map_or_else(|| format!("line {line}"), |row| format!("row {row}"));
            return Err(Fault::new(format!("the part `{name}` is damaged near {place}: {}", fault.text)));
        }
    }
    Ok(())
}

/// The row of a sheet in which a byte of its XML is.
fn row_before(text: &str, at: usize) -> Option<&str> {
    let before = text.get(..at)?;
    let row = before.rfind("<row ")?;
    let number = before[row..].split_once(" r=\"")?.1;
    number.split('"').next().filter(|number| !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit()))
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
        let why = |bytes: &[u8]| text(bytes.to_vec()).err().map(|fault| fault.why);
        assert_eq!(why(b"Name;Address\n").as_deref(), Some("it is a text file"));
        assert_eq!(why(b"").as_deref(), Some("the file is empty"));
        assert_eq!(
            why(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1").as_deref(),
            Some("it is a workbook of Excel 97-2003, or has a password")
        );
        assert_eq!(why(b"PK\x03\x04 and no more").as_deref(), Some("the file is not complete, or damaged"));
        assert!(is_workbook(Path::new("PLCTags.XLSX")) && !is_workbook(Path::new("tags.xml")));
    }
}
