//! Operators of CODESYS and TwinCAT in structured text that IEC 61131-3 does not have: `AND_THEN`, `OR_ELSE`, `S=`, `R=`, `REF=`.

use plcc_diag::{Code, Diagnostic, FileId, Span};

use super::keyword::Keyword;
use super::raw::{RawKind, RawText};

/// Operators that do not always read their right side: what they are read as, and the left side for which they read it.
const SHORT: [(&str, Keyword, &str); 2] = [("AND_THEN", Keyword::And, "TRUE"), ("OR_ELSE", Keyword::Or, "FALSE")];

/// Words before the `=` of an assignment, and what to write instead.
const ASSIGNING: [(&str, &str); 3] = [
    ("S", "write `IF condition THEN name := TRUE; END_IF;`"),
    ("R", "write `IF condition THEN name := FALSE; END_IF;`"),
    ("REF", "hand the variable itself to a parameter in VAR_IN_OUT"),
];

/// Reports these operators in `text` and reads them as the ones that resemble them. Positions in the file begin at `from`.
pub fn replace(file: FileId, text: &str, from: u32, raw: &mut RawText) -> Vec<Diagnostic> {
    let mut messages = Vec::new();
    let mut at = 1;
    while at + 1 < raw.tokens.len() {
        let (before, token, next) = (raw.tokens[at - 1], raw.tokens[at], raw.tokens[at + 1]);
        let word = token.text(text);
        let is = |known: &str| known.eq_ignore_ascii_case(word);
        let message = |end: u32, sign: &str, label: &str, help: String| {
            let span = Span { file, start: from + token.start, end: from + end };
            let title = format!("structured text of IEC 61131-3 has no `{sign}`");
            Diagnostic::new(Code::ForeignForm, span, title).label(label).help(help)
        };
        if token.kind != RawKind::Word || token.keyword.is_some() || before.kind == RawKind::Dot {
            at += 1;
            continue;
        }
        if let Some((sign, keyword, case)) = SHORT.iter().find(|(known, ..)| is(known)) {
            let plain = keyword.word();
            let help = format!(
                "write `{plain}`; if the right side must only be read when the left one is {case}, put it into an IF of its own"
            );
            messages.push(message(token.end, sign, &format!("read as `{plain}`"), help));
            raw.tokens[at].keyword = Some(*keyword);
        }
        let names = before.keyword.is_none() && matches!(before.kind, RawKind::Word | RawKind::RightBracket);
        if names
            && next.kind == RawKind::Equal
            && next.start == token.end
            && let Some((word, help)) = ASSIGNING.iter().find(|(known, _)| is(known))
        {
            messages.push(message(next.end, &format!("{word}="), "an operator of other tools", (*help).to_owned()));
            raw.tokens[at + 1].kind = RawKind::Assign;
            raw.tokens.remove(at);
            for region in raw.regions.iter_mut().filter(|region| region.token as usize > at) {
                region.token -= 1;
            }
        }
        at += 1;
    }
    messages
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scl::raw::{Iec, scan_iec};

    fn told(text: &str) -> (Vec<String>, usize) {
        let mut raw = scan_iec(text, Iec { nested_comments: true });
        let messages = replace(FileId::default(), text, 0, &mut raw);
        let words = messages.iter().map(|message| text[message.primary.span.range()].to_owned()).collect();
        (words, raw.tokens.len())
    }

    #[test]
    fn operators_are_found_and_replaced() {
        assert_eq!(told("x := a AND_THEN b OR_ELSE c;"), (vec!["AND_THEN".to_owned(), "OR_ELSE".to_owned()], 8));
        assert_eq!(told("a[1] S= b;"), (vec!["S=".to_owned()], 7));
        assert_eq!(told("IF S=b THEN x := R = 1; END_IF;").0, Vec::<String>::new());
        assert_eq!(told("x.S := 1; S := x.R=2;").0, Vec::<String>::new());
    }
}
