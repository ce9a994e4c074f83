//! Sheets of a workbook, as the TIA Portal exports tag tables: `PLC Tags` and `Constants`, each with column names in the first line.
//!
//! In the text each sheet begins with `Sheet TAB name`; the other lines contain the number of their row and the cells. A fault in a sheet is
//! an error that names sheet and row. Source: LAD/FBD reference A.10; columns as the tool writes them.

use plcc_diag::{Code, Diagnostic, FileId, Severity, Span};
use plcc_syntax::scl::fragment;

use super::columns::{self, Columns};
use super::{
    GlobalConstant, Symbol, SymbolTable, UnreadableRow, address_fault, external, lines, meant_address, parse_address,
};

/// The text that the tool writes into an empty cell.
const NO_VALUE: &str = "<No Value>";

/// A cell: the byte where it begins, and its text.
type Cell<'a> = (usize, &'a str);

/// A sheet with the number of its first line.
struct Sheet<'a> {
    name: &'a str,
    /// Byte, number and cells of each row.
    rows: Vec<(usize, &'a str, Vec<Cell<'a>>)>,
}

/// Whether a text is that of a workbook.
pub fn is_workbook(text: &str) -> bool {
    text.starts_with("Sheet\t")
}

/// Whether some sheet has the columns of tags or constants.
pub fn is_of_tags(text: &str) -> bool {
    is_workbook(text) && sheets(text).iter().any(|sheet| columns(sheet).is_some())
}

fn sheets(text: &str) -> Vec<Sheet<'_>> {
    let mut found: Vec<Sheet> = Vec::new();
    for (start, line) in lines(text) {
        if let Some(name) = line.strip_prefix("Sheet\t") {
            found.push(Sheet { name, rows: Vec::new() });
        } else if let Some(sheet) = found.last_mut() {
            let mut at = start;
            let mut cells = line.split('\t').map(|cell| {
                let place = at;
                at += cell.len() + 1;
                (place, cell)
            });
            let number = cells.next().map_or("", |(_, number)| number);
            let cells = cells.map(|(at, cell)| (at, if cell.trim() == NO_VALUE { "" } else { cell })).collect();
            sheet.rows.push((start, number, cells));
        }
    }
    found
}

/// The columns that the first row names; `None`: the sheet has neither tags nor constants.
fn columns(sheet: &Sheet) -> Option<Columns> {
    let (_, _, head) = sheet.rows.first()?;
    columns::read(head.iter().map(|(_, cell)| *cell)).filter(|columns| columns.ty.is_some())
}

/// Reads the sheets.
pub fn parse(file: FileId, text: &str) -> (SymbolTable, Vec<Diagnostic>) {
    let mut table = SymbolTable::default();
    let mut diagnostics = Vec::new();
    for sheet in sheets(text) {
        let head = sheet.rows.first().map_or(&[][..], |(_, _, head)| head.as_slice());
        for (column, meant) in columns(&sheet).into_iter().flat_map(|columns| columns.misspelt) {
            if let Some((at, cell)) = head.get(column) {
                diagnostics.push(super::misspelt(Span::new(file, *at..at + cell.len()), cell, meant));
            }
        }
        let mut bad = |start: usize, number: &str, why: String| {
            let end = text[start..].find('\n').map_or(text.len(), |end| start + end);
            let title = format!("row {number} of the sheet `{}` cannot be read", sheet.name);
            let mut message = Diagnostic::new(Code::SymbolTable, Span::new(file, start..end), title).label(why);
            message.severity = Severity::Error;
            diagnostics
                .push(message.help("a row contains a name, a data type, and an address such as `%I0.0` or a value"));
        };
        let Some(columns) = columns(&sheet) else {
            // Paths of the tables, and sheets without anything.
            if let Some((start, number, _)) = sheet.rows.first()
                && !sheet.name.to_ascii_lowercase().contains("propert")
            {
                bad(
                    *start,
                    number,
                    "the columns Name, Data Type, and Logical Address or Value are missing".to_string(),
                );
            }
            continue;
        };
        let constants = columns.address.is_none();
        let Some((ty, value)) = columns.ty.zip(columns.address.or(columns.value)) else { continue };
        for (start, number, cells) in sheet.rows.iter().skip(1) {
            let cell = |at: usize| cells.get(at).map_or((*start, ""), |(at, cell)| (*at, *cell));
            let (name, (at, value)) = (cell(columns.name).1.trim(), cell(value));
            let ty = cell(ty).1.trim().trim_matches('"').to_string();
            match (name.is_empty(), value.trim().is_empty()) {
                (true, true) => continue,
                (false, true) if !constants => {
                    let place = cell(columns.name).0;
                    let span = Span::new(file, place..place + cell(columns.name).1.len());
                    table.unreadable.push(UnreadableRow::without_address(name.to_string(), span));
                }
                (true, false) => bad(*start, number, "the name is missing".to_string()),
                (false, true) => bad(*start, number, format!("the constant `{name}` has no value")),
                (false, false) => {
                    let place = cell(columns.name).0;
                    let span = Span::new(file, place..place + cell(columns.name).1.len());
                    let name = name.to_string();
                    if constants {
                        let (value, messages) = fragment::expression(file, text, at..at + value.len());
                        if messages.is_empty() {
                            table.constants.push(GlobalConstant { name, ty, value, span });
                        } else {
                            bad(*start, number, "the value is not a constant".to_string());
                        }
                    } else if let Some(target) = parse_address(value.trim().trim_end_matches(":P")) {
                        let comment = columns.comment.map_or("", |at| cell(at).1).trim().to_string();
                        let [accessible, writable] =
                            [columns.accessible, columns.writable].map(|column| column.map(|at| cell(at).1));
                        let external = external(accessible, writable);
                        table.symbols.push(Symbol { name, target, ty, comment, external, span });
                    } else {
                        let reason = address_fault(value.trim());
                        let end = text[*start..].find('\n').map_or(text.len(), |end| start + end);
                        table.unreadable.push(UnreadableRow {
                            name,
                            reason: reason.clone(),
                            meant: meant_address(value.trim()),
                            span: Span::new(file, *start..end),
                        });
                        bad(*start, number, reason);
                    }
                }
            }
        }
    }
    (table, diagnostics)
}

#[cfg(test)]
mod tests {
    use plcc_syntax::scl::text;

    use super::super::External;
    use super::*;

    #[test]
    fn sheets_of_tags_and_constants() {
        let book = "Sheet\tPLC Tags\n1\tName\tPath\tData Type\tLogical Address\tComment\tHmi Visible\n2\tLamp\tTags\tBool\t%Q4.1\tgreen\tTrue\n3\tLevel\tTags\tInt\t%IW64\t<No Value>\n4\tSpare\tTags\tInt\n7\tBad\tTags\tInt\t%X9\nSheet\tConstants\n1\tName\tPath\tData Type\tValue\tComment\n2\tMAX\tTags\tInt\t12\nSheet\tTagTable Properties\n1\tPath\tBelongsToUnit\nSheet\tNotes\n3\tsome words\n";
        assert!(is_of_tags(book) && !is_of_tags("Sheet\tBudget\n1\tName\tSum\n"));
        let (table, messages) = parse(FileId(0), book);
        let names: Vec<&str> = table.symbols.iter().map(|symbol| symbol.name.as_str()).collect();
        assert_eq!(names, ["Lamp", "Level"]);
        assert_eq!((table.symbols[0].comment.as_str(), table.symbols[1].comment.as_str()), ("green", ""));
        assert_eq!(&book[table.symbols[1].span.range()], "Level");
        assert_eq!(text::expr(&table.constants[0].value), "12");
        let titles: Vec<&str> = messages.iter().map(|message| message.title.as_str()).collect();
        assert_eq!(
            titles,
            ["row 7 of the sheet `PLC Tags` cannot be read", "row 3 of the sheet `Notes` cannot be read"]
        );
        assert!(messages.iter().all(Diagnostic::is_error));
    }

    #[test]
    fn sheets_say_what_clients_may_do() {
        let book = "Sheet\tPLC Tags\n1\tName\tData Type\tLogical Address\tHmi Visible\tHmi Accessible\tHmi Writeable\n2\tA\tInt\t%MW0\tFalse\tFalse\tFalse\n3\tB\tInt\t%MW2\tTrue\tTrue\tFalse\n4\tC\tInt\t%MW4\tFalse\tTrue\tTrue\n5\tD\tInt\t%MW6\n";
        let (table, messages) = parse(FileId(0), book);
        assert!(messages.is_empty(), "{messages:#?}");
        let found: Vec<External> = table.symbols.iter().map(|symbol| symbol.external).collect();
        assert_eq!(found, [External::Hidden, External::Read, External::Write, External::Write]);
    }
}
