//! Rows for the S7-200: names for addresses such as `VW100`, for constants and for blocks. The binding reads the address.
//!
//! Micro/WIN copies rows as `symbol TAB address TAB comment`, with empty cells before them for the columns of its marks; tables kept by
//! hand also use `,` and `;`.
//! Source: S7-200 system manual, symbol table.

use plcc_diag::Span;
use plcc_syntax::{s7200, stl};

use super::format::names_addresses;
use super::{Reader, S7200Symbol, lines, parse_address};

/// Separators of the columns.
const SEPARATORS: [char; 3] = ['\t', ';', ','];

/// Whether `text` can be in the address column: an address, a constant or a block.
pub fn is_address(text: &str) -> bool {
    let text = text.trim();
    s7200::parse_address(text).is_some() || s7200::parse_block(text).is_some() || is_constant(text)
}

fn is_constant(text: &str) -> bool {
    let digits = text.strip_prefix(['+', '-']).unwrap_or(text);
    let number = digits.starts_with(|c: char| c.is_ascii_digit())
        && digits.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '#' | '.' | '_' | '+' | '-'))
        && (digits.contains('#') || digits.parse::<f64>().is_ok());
    let quoted = |quote: char| text.len() > 2 && text.starts_with(quote) && text.ends_with(quote);
    number || quoted('\'') || quoted('"') && !is_quoted_cell(text)
}

/// Whether a text in double quotes is an address or a number in the quotes of a cell, and not a string constant.
fn is_quoted_cell(text: &str) -> bool {
    let inner = text.trim_matches('"').trim();
    inner.is_empty() || parse_address(inner).is_some() || is_address(inner)
}

/// The separator of the table `text`; none: it is not a table.
///
/// A row begins with a name that is not a mnemonic, and an address follows. A header may come first, and some rows may be wrong.
pub fn separator(text: &str) -> Option<char> {
    SEPARATORS.into_iter().find(|separator| {
        let rows = || text.lines().map(|line| cells(line).trim_end_matches(' ')).filter(|line| is_row_of_table(line));
        let is_row = |line: &&str| row(line, *separator).is_some();
        // What most sources fail comes first, and looks at two lines.
        if !rows().take(2).any(|line| is_row(&line)) {
            return false;
        }
        let (good, all) = (rows().filter(is_row).count(), rows().count());
        // An address without a number does not make a table: `Speed, 5` is a line of a data block.
        let addressed = rows()
            .filter_map(|line| row(line, *separator))
            .any(|(_, address)| s7200::parse_address(address).is_some() || s7200::parse_block(address).is_some());
        addressed && good * 2 > all && !rows().any(begins_statement)
    })
}

/// The line without the empty cells before the first one that has a text.
fn cells(line: &str) -> &str {
    line.trim_start_matches(['\u{feff}', ' ', '\t'])
}

fn is_row_of_table(line: &str) -> bool {
    !line.is_empty() && !line.starts_with("//")
}

/// The first word is a mnemonic or a keyword: a source, whose operands may look like a column.
fn begins_statement(line: &str) -> bool {
    let word = line.split(|c: char| c.is_whitespace() || matches!(c, ',' | ';')).next().unwrap_or_default();
    // `Stop` and `End` may be symbols: their instructions have no operand that could look like a column.
    s7200::has_operands(word)
        || word.len() <= 2 && stl::is_mnemonic(word)
        || s7200::parse_address(word).is_some()
        || word.starts_with('=')
        || word.to_ascii_uppercase().ends_with("_BLOCK")
        || word.eq_ignore_ascii_case("NETWORK")
}

/// Name and address of a line.
fn row(line: &str, separator: char) -> Option<(&str, &str)> {
    let mut fields = line.split(separator).map(str::trim);
    let (name, address) = (fields.next()?, fields.next()?);
    (is_name(name) && is_address(address)).then_some((name, address))
}

/// Names of Micro/WIN have no blanks and do not begin with a digit; quotes are removed.
fn is_name(name: &str) -> bool {
    let name = name.trim_matches('"');
    !name.is_empty()
        && !name.starts_with(|c: char| c.is_ascii_digit())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || !c.is_ascii())
}

impl Reader<'_> {
    /// A table with columns separated by `separator`: name, address, comment.
    pub(super) fn plain(&mut self, separator: char) {
        let text = self.text;
        let mut first = true;
        for (start, line) in lines(text) {
            let cells = cells(line);
            if !is_row_of_table(cells.trim_end_matches([' ', '\t'])) {
                continue;
            }
            let header = std::mem::take(&mut first);
            let mut fields = cells.splitn(3, separator);
            let (name, address) = (fields.next().unwrap_or_default(), fields.next().unwrap_or_default());
            let comment = fields.next().unwrap_or_default().trim().trim_matches('"').to_string();
            let is_title = names_addresses(address.trim().trim_matches('"'));
            if header && (is_title || !is_address(address) && parse_address(address).is_none()) {
                continue;
            }
            // `row` reports addresses that only S7-300 has.
            self.row(start, line, name.trim().trim_matches('"'), address, "", &comment);
        }
    }

    /// Keeps the row for programs of the S7-200, if the S7-200 has its address. The texts are parts of `line`, which begins at `start`.
    pub(super) fn keep_s7200(&mut self, start: usize, line: &str, name: &str, address: &str, comment: &str) -> bool {
        let compact: String = address.split_whitespace().collect();
        let of_s7200 =
            s7200::parse_address(&compact).is_some() || s7200::parse_block(&compact).is_some() || is_constant(address);
        if !of_s7200 {
            return false;
        }
        let place = |part: &str, from: usize| {
            let at = line.get(from..).and_then(|rest| rest.find(part)).map(|at| from + at);
            at.map(|at| (Span::new(self.file, start + at..start + at + part.len()), at + part.len()))
        };
        let row = self.span(start, line);
        let (name_span, after) = place(name, 0).unwrap_or((row, 0));
        // The address may come before the name.
        let address_span = place(address, after).or_else(|| place(address, 0)).map_or(row, |(span, _)| span);
        self.table.s7200.push(S7200Symbol {
            name: name.to_string(),
            address: if is_constant(address) { address.to_string() } else { compact },
            name_span,
            address_span,
            comment: comment.to_string(),
        });
        true
    }
}
