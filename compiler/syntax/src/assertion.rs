//! The form of assertions, the same for every language: comparisons joined by AND, OR, NOT and parentheses. A side of a
//! comparison is an operand of the language, and the grammar of the language reads it.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, FileId, Span};

use crate::ast::{AssertOp, Assertion, Comparison, Condition, Side};

/// How deep parentheses and NOTs may be nested.
const DEPTH_MAX: usize = 50;

/// What is wrong with the form.
pub const HELP: &str = "write e.g. `assert MW 10 == 5`, `assert #speed >= 100`, `assert MW 10 as INT < -5`; AND, OR and NOT join comparisons";

/// A part of an assertion.
#[derive(Clone, Debug)]
enum Part {
    Side,
    Compare(AssertOp),
    And,
    Or,
    Not,
    Open,
    Close,
    /// A sign of other languages, and what an assertion has in its place.
    Foreign(&'static str),
}

/// Signs of other languages, and what an assertion has in their place.
const SIGNS: &[(&str, &str)] = &[("!=", "<>"), (":=", "=="), ("&&", "AND"), ("||", "OR"), (";", "AND"), ("!", "NOT")];

/// Reads an operand from its range, and reports what is wrong with it.
type SideReader<'s, S> = dyn FnMut(Range<usize>, &mut Vec<Diagnostic>) -> Option<S> + 's;

/// Reads the assertion in `range` of `source`. `side` reads an operand.
///
/// `None`: a message was reported.
pub fn parse<S>(
    file: FileId,
    source: &str,
    range: Range<usize>,
    diagnostics: &mut Vec<Diagnostic>,
    side: &mut SideReader<'_, S>,
) -> Option<Assertion<S>> {
    let parts = parts(source, range.clone());
    if let Some((Part::Foreign(meant), place)) = parts.iter().find(|(part, _)| matches!(part, Part::Foreign(_))) {
        diagnostics.push(foreign_sign(Span::new(file, place.clone()), &source[place.clone()], meant));
        return None;
    }
    let mut reader = Reader {
        file,
        source,
        parts: &parts,
        at: 0,
        end: range.end,
        depth: 0,
        comparisons: Vec::new(),
        diagnostics,
        side,
    };
    let condition = reader.any()?;
    if reader.at < parts.len() {
        let place = parts[reader.at].1.clone();
        return reader.refuse(place);
    }
    let comparisons = reader.comparisons;
    Some(Assertion { condition, comparisons })
}

/// The parts of an assertion with their places. Characters and words in quotes or after `.` and `#`, and the parentheses of `B#(1,8)`, belong to sides.
fn parts(source: &str, range: Range<usize>) -> Vec<(Part, Range<usize>)> {
    let bytes = source.as_bytes();
    let mut parts: Vec<(Part, Range<usize>)> = Vec::new();
    let mut at = range.start;
    let is_word = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_' || byte >= 0x80;
    while at < range.end {
        let start = at;
        let before = if start > range.start { bytes[start - 1] } else { b' ' };
        let next = bytes.get(at + 1).copied().filter(|_| at + 1 < range.end).unwrap_or(b' ');
        let part = match bytes[at] {
            byte if byte.is_ascii_whitespace() => {
                at += 1;
                continue;
            }
            quote @ (b'\'' | b'"') => {
                at += 1;
                while at < range.end && bytes[at] != quote {
                    // `$'` is a quote in a text.
                    at += if quote == b'\'' && bytes[at] == b'$' { 2 } else { 1 };
                }
                at = (at + 1).min(range.end);
                Part::Side
            }
            b'(' if before == b'#' => {
                while at < range.end && bytes[at] != b')' {
                    at += 1;
                }
                at = (at + 1).min(range.end);
                Part::Side
            }
            b'(' => {
                at += 1;
                Part::Open
            }
            b')' => {
                at += 1;
                Part::Close
            }
            first @ (b'=' | b'<' | b'>') => {
                let (op, length) = match (first, next) {
                    (b'=', b'=') => (AssertOp::Eq, 2),
                    (b'=', _) => (AssertOp::Eq, 1),
                    (b'<', b'>') => (AssertOp::Ne, 2),
                    (b'<', b'=') => (AssertOp::Le, 2),
                    (b'<', _) => (AssertOp::Lt, 1),
                    (_, b'=') => (AssertOp::Ge, 2),
                    (_, _) => (AssertOp::Gt, 1),
                };
                at += length;
                Part::Compare(op)
            }
            b';' if source[at + 1..range.end].trim().is_empty() => {
                at = range.end;
                Part::Foreign("")
            }
            _ if let Some((sign, meant)) = SIGNS.iter().find(|(sign, _)| source[at..range.end].starts_with(sign)) => {
                at += sign.len();
                Part::Foreign(meant)
            }
            byte if is_word(byte) => {
                while at < range.end && is_word(bytes[at]) {
                    at += 1;
                }
                let is = |word: &str| source[start..at].eq_ignore_ascii_case(word);
                match () {
                    () if matches!(before, b'.' | b'#') => Part::Side,
                    () if is("AND") => Part::And,
                    () if is("OR") => Part::Or,
                    () if is("NOT") => Part::Not,
                    () => Part::Side,
                }
            }
            _ => {
                at += 1;
                Part::Side
            }
        };
        match (&part, parts.last_mut()) {
            (Part::Side, Some((Part::Side, place))) => place.end = at,
            _ => parts.push((part, start..at)),
        }
    }
    parts
}

/// The message for a sign of other languages; an assertion has `meant` in its place, or nothing.
fn foreign_sign(span: Span, sign: &str, meant: &str) -> Diagnostic {
    let sign = sign.trim_end();
    let (title, help) = match meant {
        "" => ("an assertion has no `;` at its end".to_owned(), "remove it".to_owned()),
        "AND" | "OR" | "NOT" => (format!("an assertion has `{meant}`, not `{sign}`"), format!("write `{meant}`")),
        _ => (format!("an assertion compares with `{meant}`, not with `{sign}`"), format!("write `{meant}`")),
    };
    Diagnostic::new(Code::Pragma, span, title).label("a form of other languages").help(help)
}

struct Reader<'a, S> {
    file: FileId,
    source: &'a str,
    parts: &'a [(Part, Range<usize>)],
    at: usize,
    end: usize,
    depth: usize,
    comparisons: Vec<Comparison<S>>,
    diagnostics: &'a mut Vec<Diagnostic>,
    side: &'a mut SideReader<'a, S>,
}

impl<S> Reader<'_, S> {
    fn peek(&self) -> Option<&Part> {
        self.parts.get(self.at).map(|(part, _)| part)
    }

    fn place(&self) -> Range<usize> {
        self.parts.get(self.at).map_or(self.end..self.end, |(_, place)| place.clone())
    }

    fn refuse<T>(&mut self, place: Range<usize>) -> Option<T> {
        let help = self.missing().unwrap_or_else(|| HELP.to_owned());
        let place = if place.is_empty() { self.parts.last().map_or(place, |(_, last)| last.clone()) } else { place };
        self.diagnostics.push(
            Diagnostic::new(Code::Pragma, Span::new(self.file, place), "plcc cannot read this assertion")
                .label("an assertion is: operand, comparison, operand")
                .help(help),
        );
        None
    }

    /// What to write where a part is missing.
    fn missing(&self) -> Option<String> {
        match (self.peek(), self.parts.last()?) {
            (None, (part @ (Part::And | Part::Or | Part::Not | Part::Compare(_)), place)) => {
                let wanted = if matches!(part, Part::Compare(_)) { "a value" } else { "a comparison" };
                Some(format!("write {wanted} after `{}`", &self.source[place.clone()]))
            }
            (Some(Part::Close), _) => Some("remove `)`, or write the `(` that it closes".to_owned()),
            (None, _) => Some("write `)` for each `(`".to_owned()),
            (Some(_), _) => None,
        }
    }

    /// A side without a comparison after it.
    fn not_compared(&mut self, side: Span) -> Option<Condition> {
        let place = self.place();
        let place = if place.is_empty() { side.range() } else { place };
        let text = self.source.get(side.range()).unwrap_or_default();
        let help = match self.peek() {
            Some(Part::Open) => {
                format!("an assertion calls no function: assign `{text}(…)` to a variable, and compare that")
            }
            _ => format!("compare `{text}` with a value, a bit as in `{text} == 1`"),
        };
        self.diagnostics.push(
            Diagnostic::new(Code::Pragma, Span::new(self.file, place), "plcc cannot read this assertion")
                .label("an assertion is: operand, comparison, operand")
                .help(help),
        );
        None
    }

    fn any(&mut self) -> Option<Condition> {
        let mut conditions = vec![self.all()?];
        while matches!(self.peek(), Some(Part::Or)) {
            self.at += 1;
            conditions.push(self.all()?);
        }
        Some(if conditions.len() == 1 { conditions.remove(0) } else { Condition::Any(conditions) })
    }

    fn all(&mut self) -> Option<Condition> {
        let mut conditions = vec![self.one()?];
        while matches!(self.peek(), Some(Part::And)) {
            self.at += 1;
            conditions.push(self.one()?);
        }
        Some(if conditions.len() == 1 { conditions.remove(0) } else { Condition::All(conditions) })
    }

    fn one(&mut self) -> Option<Condition> {
        self.depth += 1;
        let place = self.place();
        if self.depth > DEPTH_MAX {
            return self.refuse(place);
        }
        let condition = match self.peek() {
            Some(Part::Not) => {
                self.at += 1;
                Condition::Not(Box::new(self.one()?))
            }
            Some(Part::Open) => {
                self.at += 1;
                let inner = self.any()?;
                if !matches!(self.peek(), Some(Part::Close)) {
                    let place = self.place();
                    return self.refuse(place);
                }
                self.at += 1;
                inner
            }
            Some(Part::Side) => self.comparison()?,
            _ => return self.refuse(place),
        };
        self.depth -= 1;
        Some(condition)
    }

    fn comparison(&mut self) -> Option<Condition> {
        let left = self.operand()?;
        let Some((Part::Compare(op), place)) = self.parts.get(self.at).cloned() else {
            return self.not_compared(left.span);
        };
        if &self.source[place.clone()] == "=" {
            self.diagnostics.push(
                Diagnostic::new(
                    Code::Pragma,
                    Span::new(self.file, place),
                    "an assertion compares with `==`, not with `=`",
                )
                .label("not a comparison")
                .help("write `==`"),
            );
            return None;
        }
        self.at += 1;
        let right = self.operand()?;
        let span = left.span.to(right.span);
        self.comparisons.push(Comparison { left, op, right, span });
        Some(Condition::Compare(self.comparisons.len() as u32 - 1))
    }

    /// A side, with `as TYPE` after it if there is one.
    fn operand(&mut self) -> Option<Side<S>> {
        let Some((Part::Side, place)) = self.parts.get(self.at).cloned() else {
            let place = self.place();
            return self.refuse(place);
        };
        self.at += 1;
        let text = &self.source[place.clone()];
        let span = Span::new(self.file, place.clone());
        let (operand, ty) = match typed(text) {
            Some((length, word)) => {
                let start = place.end - word.len();
                (place.start..place.start + length, Some((word.to_owned(), Span::new(self.file, start..place.end))))
            }
            None => (place, None),
        };
        let value = (self.side)(operand, self.diagnostics)?;
        Some(Side { value, ty, span })
    }
}

/// `MW 10 as INT`: length of the operand, and the type.
fn typed(text: &str) -> Option<(usize, &str)> {
    let (rest, word) = text.rsplit_once(char::is_whitespace)?;
    let rest = rest.trim_end();
    let length = rest.len().checked_sub(2)?;
    let (operand, keyword) = rest.split_at_checked(length)?;
    let is_word = word.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_') && !word.is_empty();
    let operand = operand.strip_suffix(char::is_whitespace)?.trim_end();
    (is_word && keyword.eq_ignore_ascii_case("as") && !operand.is_empty()).then_some((operand.len(), word))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The condition, with the texts of sides.
    fn read(text: &str) -> Result<String, String> {
        let mut diagnostics = Vec::new();
        let mut side = |range: Range<usize>, _: &mut Vec<Diagnostic>| Some(text[range].to_string());
        let read = parse(FileId(0), text, 0..text.len(), &mut diagnostics, &mut side);
        read.map(|assertion| shown(&assertion.condition, &assertion))
            .ok_or_else(|| diagnostics.remove(0).primary.span.range().start.to_string())
    }

    fn shown(condition: &Condition, assertion: &Assertion<String>) -> String {
        let list = |conditions: &[Condition]| -> String {
            conditions.iter().map(|one| shown(one, assertion)).collect::<Vec<_>>().join(" ")
        };
        match condition {
            Condition::Compare(index) => {
                let Comparison { left, op, right, .. } = &assertion.comparisons[*index as usize];
                let side = |side: &Side<String>| match &side.ty {
                    Some((ty, _)) => format!("{}:{ty}", side.value),
                    None => side.value.clone(),
                };
                format!("{}{}{}", side(left), op.sign(), side(right))
            }
            Condition::Not(inner) => format!("!{}", shown(inner, assertion)),
            Condition::All(conditions) => format!("all({})", list(conditions)),
            Condition::Any(conditions) => format!("any({})", list(conditions)),
        }
    }

    #[test]
    fn conditions() {
        for (text, wanted) in [
            ("MW 10 == 5", "MW 10==5"),
            ("MW 10 as INT<-5", "MW 10:INT<-5"),
            ("#a.or == 1 and not #not <> 2", "all(#a.or==1 !#not<>2)"),
            ("a==1 OR b==2 AND c==3 OR d==4", "any(a==1 all(b==2 c==3) d==4)"),
            ("NOT (a == 1 OR b >= 2) AND c <= 3", "all(!any(a==1 b>=2) c<=3)"),
            ("\"a AND b\" == 'x OR $'(y'", "\"a AND b\"=='x OR $'(y'"),
            ("MD 4 == B#(1,2,3,4)", "MD 4==B#(1,2,3,4)"),
            ("STW.OR == 1", "STW.OR==1"),
            ("W [AR1, P#0.0] as INT > 1 as DINT", "W [AR1, P#0.0]:INT>1:DINT"),
            ("as as INT == as", "as:INT==as"),
        ] {
            assert_eq!(read(text).as_deref(), Ok(wanted), "{text}");
        }
    }

    #[test]
    fn what_is_wrong_has_its_help() {
        let help = |text: &str| {
            let mut diagnostics = Vec::new();
            let mut side = |range: Range<usize>, _: &mut Vec<Diagnostic>| Some(text[range].to_string());
            assert!(parse(FileId(0), text, 0..text.len(), &mut diagnostics, &mut side).is_none(), "{text}");
            diagnostics.remove(0).help.unwrap_or_default()
        };
        assert_eq!(help("#a == 1 AND"), "write a comparison after `AND`");
        assert_eq!(help("#a =="), "write a value after `==`");
        assert_eq!(help("(#a == 1"), "write `)` for each `(`");
        assert_eq!(help("#a == 1)"), "remove `)`, or write the `(` that it closes");
        assert_eq!(help("!#a == 1"), "write `NOT`");
        assert_eq!(help("#a == 1; #b == 2"), "write `AND`");
        assert_eq!(help("#a == 1;"), "remove it");
        assert_eq!(
            help("ABS(#a) == 1"),
            "an assertion calls no function: assign `ABS(…)` to a variable, and compare that"
        );
    }

    #[test]
    fn what_is_wrong_has_a_place() {
        for (text, place) in [
            ("", "0"),
            ("a", "0"),
            ("a == ", "2"),
            ("a = 1", "2"),
            ("a == 1 b", "0"),
            ("(a == 1", "6"),
            ("a == 1)", "6"),
            ("a == 1 AND", "7"),
            ("a == 1 == 2", "7"),
            ("NOT", "0"),
        ] {
            let found = read(text);
            if text == "a == 1 b" {
                // Whether `1 b` is an operand is up to the language.
                assert_eq!(found.as_deref(), Ok("a==1 b"));
            } else {
                assert_eq!(found, Err(place.to_string()), "{text}");
            }
        }
        assert!(read(&format!("{}a == 1", "NOT ".repeat(100_000))).is_err());
        assert!(read(&"(".repeat(100_000)).is_err());
    }
}
