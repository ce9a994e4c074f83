//! The tables that STEP 7 exports: `.asc`, `.seq` and `.dif`.

use plcc_syntax::symbols::parse_address;

use super::{Reader, lines, loose};

impl Reader<'_> {
    /// `126,` then 24 + 12 + 10 + 80 characters; the record may lack trailing blanks and its line end.
    pub(super) fn asc(&mut self) {
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

    /// TAB address TAB symbol TAB comment.
    pub(super) fn seq(&mut self) {
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
    pub(super) fn dif(&mut self) {
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

fn unquoted(text: &str) -> String {
    let text = text.trim();
    match text.strip_prefix('"').and_then(|text| text.strip_suffix('"')) {
        Some(inner) => inner.replace("\"\"", "\""),
        None => text.to_string(),
    }
}
