//! The extent of a pointer constant: `P#M 10.0`, `P#DB11.DBX 20.0 INT 10`.

use super::extent::word;
use crate::literal::ANY_TYPES;

/// To what letters belong that follow a pointer without a blank.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tail {
    /// To the pointer, which is then wrong as a whole.
    Included,
    /// To the next token.
    Separate,
}

/// Bytes of the pointer after `P#`; `None` if it is not a pointer: `P##name`, `P#"name"`.
pub fn length(rest: &str, tail: Tail) -> Option<usize> {
    if rest.starts_with(['#', '"']) {
        return None;
    }
    let blanks = |at: usize| at + rest[at..].len() - rest[at..].trim_start_matches([' ', '\t']).len();
    let digits = |at: usize| at + rest[at..].bytes().take_while(u8::is_ascii_digit).count();
    let letters = |at: usize| at + rest[at..].bytes().take_while(u8::is_ascii_alphabetic).count();
    let after_tail = |at: usize| if tail == Tail::Included { at + word(&rest[at..]) } else { at };
    let mut at = letters(0);
    let area = &rest[..at];
    if area.eq_ignore_ascii_case("DB") || area.eq_ignore_ascii_case("DI") {
        let number = blanks(at);
        let end = digits(number);
        if end > number && rest[blanks(end)..].starts_with('.') {
            at = letters(blanks(blanks(end) + 1));
        }
    } else if at == 0 && !rest.starts_with(|c: char| c.is_ascii_digit()) {
        return (tail == Tail::Included).then(|| word(rest));
    }
    let number = blanks(at);
    if digits(number) == number {
        return Some(at + word(&rest[at..]));
    }
    at = digits(number);
    if rest[at..].starts_with('.') && digits(at + 1) > at + 1 {
        at = digits(at + 1);
    }
    at = after_tail(at);
    // Data type and number of elements of an ANY.
    let name = blanks(at);
    let name_end = name + word(&rest[name..]);
    let count = blanks(name_end);
    let count_end = digits(count);
    let known = |name: &str| ANY_TYPES.iter().any(|(known, _)| known.eq_ignore_ascii_case(name));
    if name > at && count > name_end && count_end > count && known(&rest[name..name_end]) {
        at = after_tail(count_end);
    }
    Some(at)
}
