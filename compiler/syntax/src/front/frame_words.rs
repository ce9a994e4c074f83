//! Misspelt keywords of the frames of blocks: what is meant by `VAR_INPUTS`, `ORGANISATION_BLOCK`, `ENDVAR`, `END FUNCTION`.
//!
//! Each is found where only a keyword of a frame is possible, so no name of a program is taken for one. It counts as the keyword from
//! then on, and one mistake remains one message.

use plcc_diag::{Code, Diagnostic, Span};

use crate::distance;

/// What decides whether a raw token belongs to the frame of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    Word,
    /// `"name"`, `#name`
    Name,
    Colon,
    Comma,
    LeftBrace,
    Semicolon,
    Number,
    /// A sign after which an operand must follow, or a keyword that does not end a statement.
    Operator,
    Other,
}

/// A raw token as this module sees it.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    pub shape: Shape,
    pub text: &'a str,
    pub first_on_line: bool,
}

/// Tokens from `first` on that stand for a keyword.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Meant {
    pub first: usize,
    pub count: usize,
    pub keyword: &'static str,
}

const BLOCKS: [&str; 5] = ["ORGANIZATION_BLOCK", "FUNCTION_BLOCK", "FUNCTION", "DATA_BLOCK", "TYPE"];
const BLOCK_ENDS: [&str; 5] =
    ["END_ORGANIZATION_BLOCK", "END_FUNCTION_BLOCK", "END_FUNCTION", "END_DATA_BLOCK", "END_TYPE"];
/// What ends a block for those who do not think of its kind.
pub const ANY_BLOCK_END: &str = "END_BLOCK";
const SECTIONS: [&str; 5] = ["VAR_INPUT", "VAR_OUTPUT", "VAR_IN_OUT", "VAR_TEMP", "VAR"];
const SECTION_ENDS: [&str; 2] = ["END_VAR", "END_STRUCT"];
/// Words that end something else, so that they are not taken for the end of a block.
const STATEMENT_ENDS: [&str; 6] = ["END_IF", "END_CASE", "END_FOR", "END_WHILE", "END_REPEAT", "END_REGION"];
/// Other words of frames.
const OTHERS: [&str; 10] =
    ["BEGIN", "CONST", "END_CONST", "LABEL", "END_LABEL", "STRUCT", "PROGRAM", "END_PROGRAM", "NETWORK", "END_NETWORK"];

/// Words of other languages and tools for a keyword.
const ALIASES: [(&str, &str); 26] = [
    ("VAR_IN", "VAR_INPUT"),
    ("VAR_OUT", "VAR_OUTPUT"),
    ("VAR_STAT", "VAR"),
    ("VAR_STATIC", "VAR"),
    ("VAR_RETAIN", "VAR"),
    ("VAR_PERSISTENT", "VAR"),
    ("VARIABLES", "VAR"),
    ("VAR_TEMPORARY", "VAR_TEMP"),
    ("VAR_LOCAL", "VAR_TEMP"),
    ("FUNKTION", "FUNCTION"),
    ("FUNKTIONSBAUSTEIN", "FUNCTION_BLOCK"),
    ("DATENBAUSTEIN", "DATA_BLOCK"),
    ("ORGANISATIONSBAUSTEIN", "ORGANIZATION_BLOCK"),
    ("END_FUNKTION", "END_FUNCTION"),
    ("END_FUNKTIONSBAUSTEIN", "END_FUNCTION_BLOCK"),
    ("END_DATENBAUSTEIN", "END_DATA_BLOCK"),
    ("END_ORGANISATIONSBAUSTEIN", "END_ORGANIZATION_BLOCK"),
    ("STRUCTURE", "STRUCT"),
    ("INSTANCE_DB", "DATA_BLOCK"),
    ("INSTANCE_DATA_BLOCK", "DATA_BLOCK"),
    ("END_UDT", "END_TYPE"),
    ("END_OB", "END_ORGANIZATION_BLOCK"),
    ("END_ORGANIZATION", "END_ORGANIZATION_BLOCK"),
    ("END_FB", "END_FUNCTION_BLOCK"),
    ("END_FC", "END_FUNCTION"),
    ("END_DB", "END_DATA_BLOCK"),
];

/// Number of characters of the longest word that may be a misspelt keyword.
const LENGTH_MAX: usize = 30;
/// Bytes of the shortest one.
const WORD_MIN: usize = 3;

/// The candidate that `word` is a slip of: the only nearest one, without letter case and `_`.
pub fn slip_of<'c>(word: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<&'c str> {
    if !(WORD_MIN..=LENGTH_MAX).contains(&word.len()) {
        return None;
    }
    let plain = |text: &str| text.chars().filter(|c| *c != '_').map(|c| c.to_ascii_uppercase()).collect::<String>();
    let letters = |text: &str| text.chars().filter(|c| *c != '_').count();
    let length_of_word = letters(word);
    let mut wanted = String::new();
    let mut best: Option<(usize, &str)> = None;
    let mut tied = false;
    for candidate in candidates {
        let length_of_candidate = letters(candidate);
        let length = length_of_candidate.min(length_of_word);
        let limit = match length {
            0..=2 => continue,
            3..=5 => 1,
            6..=10 => 2,
            _ => 3,
        };
        // Each letter more or less is a step.
        if length_of_candidate.abs_diff(length_of_word) > limit {
            continue;
        }
        if wanted.is_empty() {
            wanted = plain(word);
        }
        let distance = distance::between(&wanted, &plain(candidate));
        if distance > limit {
            continue;
        }
        match best {
            Some((least, _)) if distance > least => {}
            Some((least, _)) if distance == least => tied = true,
            _ => (best, tied) = (Some((distance, candidate)), false),
        }
    }
    best.filter(|_| !tied).map(|(_, candidate)| candidate)
}

/// The message for `text` that stands for `keyword`.
pub fn misspelt(span: Span, text: &str, keyword: &str) -> Diagnostic {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let written = match text.to_ascii_uppercase().as_str() {
        "VAR_RETAIN" | "VAR_PERSISTENT" => "VAR RETAIN",
        _ => keyword,
    };
    Diagnostic::new(Code::MisspeltKeyword, span, format!("the keyword is `{written}`, not `{text}`"))
        .label(format!("read as `{keyword}`"))
        .help(format!("write `{written}`"))
}

/// Where a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Area {
    Outside,
    /// After the name of a block, between its declarations.
    Head,
    /// Among declarations.
    Section,
    /// After BEGIN.
    Code,
}

/// Finds the misspelt keywords of frames among `count` tokens.
pub fn find<'a>(count: usize, seen: impl Fn(usize) -> Seen<'a>) -> Vec<Meant> {
    let mut scan = Scan { count, seen, area: Area::Outside, block_end: None, structures: 0, in_var: false };
    let mut found = Vec::new();
    let mut at = 0;
    while at < count {
        let token = (scan.seen)(at);
        // In statement lists most words have one letter.
        if token.shape != Shape::Word || token.text.len() < 2 || scan.is_operand(token) {
            at += 1;
            continue;
        }
        let meant = scan.meant(at);
        let keyword = match meant {
            Some(meant) => Some(meant.keyword),
            None => scan.exact(at),
        };
        if let Some(keyword) = keyword {
            scan.enter(keyword);
        }
        found.extend(meant);
        at += meant.map_or(1, |meant| meant.count);
    }
    found
}

struct Scan<F> {
    count: usize,
    seen: F,
    area: Area,
    /// What ends the block that is open.
    block_end: Option<&'static str>,
    /// Number of STRUCTs that are open.
    structures: usize,
    /// The declarations are those of a VAR section.
    in_var: bool,
}

impl<'a, F: Fn(usize) -> Seen<'a>> Scan<F> {
    fn get(&self, at: usize) -> Option<Seen<'a>> {
        (at < self.count).then(|| (self.seen)(at))
    }

    fn shape(&self, at: usize) -> Option<Shape> {
        self.get(at).map(|token| token.shape)
    }

    /// The token if it is on the line of the one before.
    fn beside(&self, at: usize) -> Option<Seen<'a>> {
        self.get(at).filter(|token| !token.first_on_line)
    }

    fn ends_line(&self, after: usize) -> bool {
        self.get(after).is_none_or(|token| token.first_on_line)
    }

    /// True for a short word of the code that is neither the first on its line nor a keyword.
    fn is_operand(&self, token: Seen<'a>) -> bool {
        const LENGTH_MAX: usize = 5;
        let is = |word: &str| token.text.eq_ignore_ascii_case(word);
        self.area == Area::Code && !token.first_on_line && token.text.len() <= LENGTH_MAX && !is("END") && !is("TYPE")
    }

    /// The keyword of a frame that the word at `at` is.
    fn exact(&self, at: usize) -> Option<&'static str> {
        let text = (self.seen)(at).text;
        if !looks_like_keyword(text) {
            return None;
        }
        let known = keywords().find(|known| known.eq_ignore_ascii_case(text))?;
        let name = matches!(self.shape(at + 1), Some(Shape::Colon | Shape::Comma | Shape::Operator));
        (!name || known == "TYPE" && self.area == Area::Outside).then_some(known)
    }

    fn enter(&mut self, keyword: &'static str) {
        if let Some(block) = BLOCKS.iter().position(|block| *block == keyword) {
            self.block_end = Some(BLOCK_ENDS[block]);
        }
        self.area = match keyword {
            "BEGIN" if self.area != Area::Outside => Area::Code,
            "NETWORK" if self.area != Area::Section => Area::Code,
            "STRUCT" if matches!(self.area, Area::Head | Area::Section) => {
                self.in_var &= self.area == Area::Section;
                self.structures += 1;
                Area::Section
            }
            "END_STRUCT" => {
                self.structures = self.structures.saturating_sub(1);
                if self.structures == 0 && !self.in_var && self.area == Area::Section { Area::Head } else { self.area }
            }
            "END_VAR" | "END_CONST" | "END_LABEL" if self.area == Area::Section => Area::Head,
            "CONST" | "LABEL" if self.area == Area::Head => Area::Section,
            _ if SECTIONS.contains(&keyword) && self.area != Area::Code => {
                (self.in_var, self.structures) = (true, 0);
                Area::Section
            }
            _ if BLOCKS.contains(&keyword) || keyword == "PROGRAM" => {
                (self.in_var, self.structures) = (false, 0);
                Area::Head
            }
            _ if BLOCK_ENDS.contains(&keyword) || keyword == "END_PROGRAM" => Area::Outside,
            _ => self.area,
        };
    }

    /// The keyword that the word at `at` and those after it stand for.
    fn meant(&self, at: usize) -> Option<Meant> {
        let token = (self.seen)(at);
        let meant = |count, keyword| Some(Meant { first: at, count, keyword });
        if !token.text.is_ascii() {
            return None;
        }
        if let Some(found) = self.two_words(at, token) {
            return Some(found);
        }
        if token.text.len() < WORD_MIN {
            return None;
        }
        let starts = at == 0
            || token.first_on_line && self.shape(at - 1) != Some(Shape::Operator)
            || self.shape(at - 1) == Some(Shape::Semicolon);
        let typed =
            at > 0 && (self.shape(at - 1) == Some(Shape::Colon) || (self.seen)(at - 1).text.eq_ignore_ascii_case("OF"));
        if (!starts && !typed) || is_keyword(token.text) {
            return None;
        }
        let next = self.shape(at + 1);
        if matches!(next, Some(Shape::Colon | Shape::Comma | Shape::LeftBrace | Shape::Operator)) {
            return None;
        }
        let declares = |at: usize| {
            matches!(self.shape(at), Some(Shape::Word | Shape::Name))
                && matches!(self.shape(at + 1), Some(Shape::Colon | Shape::Comma | Shape::LeftBrace))
        };
        if typed || self.area == Area::Head && token.first_on_line && declares(at + 1) {
            if matches!(self.area, Area::Head | Area::Section)
                && declares(at + 1)
                && !self.ends_with_section(at + 1)
                && let Some(keyword) = known_or_slip(token.text, ["STRUCT"])
            {
                return meant(1, keyword);
            }
            if typed {
                return None;
            }
        }
        match self.area {
            Area::Outside | Area::Code if token.first_on_line || at == 0 => {
                let named = self.beside(at + 1).is_some_and(|next| matches!(next.shape, Shape::Word | Shape::Name));
                // `DATA_BLOCK "M1" "Motor"`
                let typed = self.beside(at + 2).is_some_and(|ty| ty.shape == Shape::Name) && self.ends_line(at + 3);
                let heads = self.heads(at + 2);
                // Slips are looked for last: that takes most time.
                if named
                    && (self.area == Area::Outside || token.text.len() > 6)
                    && (heads || typed)
                    && let Some(keyword) = known_or_slip(token.text, BLOCKS)
                    && (heads || keyword == "DATA_BLOCK")
                {
                    return meant(1, keyword);
                }
            }
            Area::Head => {
                let retained = self.beside(at + 1).is_some_and(|next| {
                    ["RETAIN", "NON_RETAIN", "CONSTANT"].iter().any(|word| word.eq_ignore_ascii_case(next.text))
                });
                if (declares(at + 1) || retained)
                    && let Some(keyword) = known_or_slip(token.text, SECTIONS)
                {
                    return meant(1, keyword);
                }
                if token.first_on_line && self.ends_line(at + 1) && slip_of(token.text, ["BEGIN"]).is_some() {
                    return meant(1, "BEGIN");
                }
            }
            Area::Section => {
                if token.text.eq_ignore_ascii_case("END") {
                    return meant(1, if self.structures > 0 { "END_STRUCT" } else { "END_VAR" });
                }
                // `END_VAR_INPUT`
                if token.text.get(..8).is_some_and(|begin| begin.eq_ignore_ascii_case("END_VAR_")) {
                    return meant(1, "END_VAR");
                }
                if let Some(keyword) = slip_of(token.text, SECTION_ENDS) {
                    return meant(1, keyword);
                }
            }
            _ => {}
        }
        let alone = self.ends_line(at + 1)
            || next == Some(Shape::Semicolon) && self.ends_line(at + 2)
            || self.get(at + 1).is_some_and(|next| BLOCKS.iter().any(|block| block.eq_ignore_ascii_case(next.text)));
        if self.area != Area::Outside && alone && token.text.len() > 5 && token.text.starts_with(['E', 'e', 'N', 'n']) {
            if token.text.eq_ignore_ascii_case(ANY_BLOCK_END) {
                return meant(1, self.block_end?);
            }
            let all = BLOCK_ENDS.iter().chain(&STATEMENT_ENDS).chain(&SECTION_ENDS).copied();
            let keyword = alias(token.text).filter(|keyword| keyword.starts_with("END_"));
            let keyword = keyword.or_else(|| slip_of(token.text, all))?;
            if BLOCK_ENDS.contains(&keyword) {
                return meant(1, keyword);
            }
        }
        None
    }

    /// What follows the name of a block: its type, a line end, or its head.
    fn heads(&self, at: usize) -> bool {
        let number = self.shape(at) == Some(Shape::Number);
        let at = if number { at + 1 } else { at };
        self.ends_line(at) || self.shape(at) == Some(Shape::Colon) || self.shape(at) == Some(Shape::LeftBrace)
    }

    /// Whether the declarations from `at` on end with END_VAR before an END_STRUCT.
    fn ends_with_section(&self, at: usize) -> bool {
        const LOOK_MAX: usize = 2000;
        let ends = (at..self.count.min(at + LOOK_MAX)).find_map(|at| {
            let text = (self.seen)(at).text;
            let is = |word: &str| slip_of(text, SECTION_ENDS) == Some(word);
            if text.len() < 5 {
                None
            } else {
                is("END_VAR").then_some(true).or_else(|| is("END_STRUCT").then_some(false))
            }
        });
        ends.unwrap_or(true)
    }

    /// `FUNCTION BLOCK FB 1`, `VAR INPUT`, `END VAR`, `END FUNCTION BLOCK`, `END BLOCK`.
    fn two_words(&self, at: usize, token: Seen<'a>) -> Option<Meant> {
        let next = self.beside(at + 1).filter(|next| next.shape == Shape::Word)?;
        if token.text.eq_ignore_ascii_case("END") {
            let third = self.beside(at + 2).filter(|third| third.text.eq_ignore_ascii_case("BLOCK"));
            let words = match third {
                Some(_) => format!("END_{}_BLOCK", next.text),
                None => format!("END_{}", next.text),
            };
            let ends = BLOCK_ENDS.iter().chain(&SECTION_ENDS).copied();
            let keyword = match words.eq_ignore_ascii_case(ANY_BLOCK_END) {
                true => self.block_end.filter(|_| self.area != Area::Outside)?,
                false => ends.into_iter().find(|keyword| keyword.eq_ignore_ascii_case(&words))?,
            };
            return Some(Meant { first: at, count: if third.is_some() { 3 } else { 2 }, keyword });
        }
        let starts = at == 0 || token.first_on_line;
        if starts && self.area != Area::Code && token.text.eq_ignore_ascii_case("VAR") && self.ends_line(at + 2) {
            let words = format!("VAR_{}", next.text);
            let keyword = SECTIONS.into_iter().find(|keyword| keyword.eq_ignore_ascii_case(&words))?;
            return Some(Meant { first: at, count: 2, keyword });
        }
        let named = || self.beside(at + 2).is_some_and(|third| matches!(third.shape, Shape::Word | Shape::Name));
        if !starts || !next.text.eq_ignore_ascii_case("BLOCK") || !named() {
            return None;
        }
        let keyword = slip_of(&format!("{}_BLOCK", token.text), BLOCKS)?;
        Some(Meant { first: at, count: 2, keyword })
    }
}

fn keywords() -> impl Iterator<Item = &'static str> {
    BLOCKS.into_iter().chain(BLOCK_ENDS).chain(SECTIONS).chain(SECTION_ENDS).chain(STATEMENT_ENDS).chain(OTHERS)
}

/// False for most words: keywords have few first letters, and only `VAR` and `TYPE` are shorter than five.
fn looks_like_keyword(word: &str) -> bool {
    let first_letters: &[u8] = match word.len() {
        ..WORD_MIN => b"",
        WORD_MIN => b"V",
        4 => b"T",
        _ => b"OFDTEVBCLSPN",
    };
    word.bytes().next().is_some_and(|first| first_letters.contains(&first.to_ascii_uppercase()))
}

fn is_keyword(word: &str) -> bool {
    looks_like_keyword(word) && keywords().any(|keyword| keyword.eq_ignore_ascii_case(word))
}

fn alias(word: &str) -> Option<&'static str> {
    ALIASES.iter().find(|(alias, _)| alias.eq_ignore_ascii_case(word)).map(|(_, keyword)| *keyword)
}

/// The keyword that `word` is another word for, or a slip of.
fn known_or_slip<const N: usize>(word: &str, keywords: [&'static str; N]) -> Option<&'static str> {
    alias(word).filter(|keyword| keywords.contains(keyword)).or_else(|| slip_of(word, keywords))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is found in words with blanks between them; the first one begins a line.
    fn found(text: &str) -> Vec<Meant> {
        let words: Vec<&str> = text.split(' ').collect();
        let seen = |at: usize| Seen { shape: Shape::Word, text: words[at], first_on_line: at == 0 };
        find(words.len(), seen)
    }

    #[test]
    fn short_words_are_no_keywords() {
        assert_eq!(found("TA BLOCK DB"), [Meant { first: 0, count: 2, keyword: "DATA_BLOCK" }]);
        for text in ["T BLOCK DB", "A BLOCK", "A I", "AN BLOCK"] {
            assert_eq!(found(text), [], "{text}");
        }
    }

    #[test]
    fn slips_have_one_meaning() {
        assert_eq!(slip_of("VAR_INPUTS", SECTIONS), Some("VAR_INPUT"));
        assert_eq!(slip_of("ORGANISATION_BLOCK", BLOCKS), Some("ORGANIZATION_BLOCK"));
        assert_eq!(slip_of("EndVar", SECTION_ENDS), Some("END_VAR"));
        assert_eq!(slip_of("speed", SECTION_ENDS), None);
        assert_eq!(slip_of("END_VRA", SECTION_ENDS), Some("END_VAR"));
        assert_eq!(slip_of("x", SECTIONS), None);
    }
}
