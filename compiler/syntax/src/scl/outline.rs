//! The blocks of a source, and which language the statements of each are in. A guess: it does not parse, and does not check correctness.

use std::ops::Range;

use super::keyword::Keyword;
use super::raw::{self, RawKind, RawToken};
use crate::elementary::Elementary;
use crate::language::Language;
use crate::stl::is_mnemonic;

/// A block of a source, or the statements outside blocks.
pub struct OutlinedBlock {
    pub range: Range<usize>,
    /// None: nothing decides.
    pub language: Option<Language>,
}

/// What a source consists of.
pub struct Outline {
    pub blocks: Vec<OutlinedBlock>,
    /// A declaration has a form that only the TIA Portal writes.
    pub modern: bool,
}

/// Finds the blocks of `text`.
pub fn outline(text: &str) -> Outline {
    let tokens = raw::scan(text).tokens;
    let scan = Scan { text, tokens: &tokens };
    let mut blocks = Vec::new();
    let mut modern = false;
    let mut at = 0;
    while at < tokens.len() {
        let framed = scan.begins_block(at);
        let mut end = at + 1;
        while end < tokens.len() && !scan.begins_block(end) {
            let ends = tokens[end].keyword.is_some_and(Keyword::ends_block);
            end += 1;
            if ends {
                break;
            }
        }
        let block = at..end;
        let code = if framed { scan.code(block.clone()) } else { block.clone() };
        modern |= scan.modern(at..code.start);
        // STL has no array data blocks, but a source of the TIA Portal may hold one next to its blocks in STL.
        let language = if scan.is_array(block) { Some(Language::Scl) } else { scan.language(code) };
        blocks.push(OutlinedBlock { range: tokens[at].start as usize..tokens[end - 1].end as usize, language });
        at = end;
    }
    Outline { blocks, modern }
}

struct Scan<'a> {
    text: &'a str,
    tokens: &'a [RawToken],
}

impl Scan<'_> {
    fn kind(&self, index: usize) -> Option<RawKind> {
        self.tokens.get(index).map(|token| token.kind)
    }

    fn slice(&self, index: usize) -> &str {
        &self.text[self.tokens[index].range()]
    }

    fn begins_block(&self, index: usize) -> bool {
        let token = self.tokens[index];
        let first = index == 0
            || token.first_on_line
            || self.tokens[index - 1].keyword.is_some_and(Keyword::ends_block)
            || self.kind(index - 1) == Some(RawKind::Semicolon);
        first
            && token.keyword.is_some_and(Keyword::begins_block)
            && matches!(self.kind(index + 1), Some(RawKind::Word | RawKind::Quoted))
    }

    /// The statements of a framed block.
    fn code(&self, block: Range<usize>) -> Range<usize> {
        if let Some(Keyword::DataBlock | Keyword::Type) = self.tokens[block.start].keyword {
            return block.end..block.end;
        }
        let keyword = |index: &usize| self.tokens[*index].keyword;
        let begin = block.clone().find(|index| keyword(index) == Some(Keyword::Begin));
        let begin = begin.or_else(|| block.clone().rfind(|index| keyword(index).is_some_and(Keyword::ends_section)));
        begin.map_or(block.end, |begin| begin + 1)..block.end
    }

    /// The language that has more statements in `code`.
    fn language(&self, code: Range<usize>) -> Option<Language> {
        let (mut scl, mut stl) = (0usize, 0usize);
        let mut depth = 0usize;
        for index in code.clone() {
            let token = self.tokens[index];
            let starts = index == code.start
                || token.first_on_line
                || matches!(self.kind(index - 1), Some(RawKind::Semicolon | RawKind::Colon))
                || self.tokens[index - 1].keyword.is_some_and(|word| {
                    matches!(word, Keyword::Then | Keyword::Do | Keyword::Else | Keyword::Repeat | Keyword::Begin)
                });
            match token.kind {
                RawKind::LeftParen => depth += 1,
                RawKind::RightParen => depth = depth.saturating_sub(1),
                RawKind::Semicolon => depth = 0,
                RawKind::Word if depth == 0 && starts => match token.keyword {
                    Some(word) if word.begins_statement() || word.closes_statement() => scl += 1,
                    _ if self.slice(index).eq_ignore_ascii_case("NETWORK") => return Some(Language::Stl),
                    _ if self.calls(index) => scl += 1,
                    // A mnemonic may be the name of a variable or function.
                    _ if matches!(
                        self.kind(index + 1),
                        Some(RawKind::Assign | RawKind::Dot | RawKind::LeftBracket)
                    ) =>
                    {
                        scl += usize::from(self.assigns(index));
                    }
                    // `o = n;`, meant as an assignment: in STL `=` begins a statement, or the text of a title follows it.
                    _ if !self.slice(index).eq_ignore_ascii_case("TITLE")
                        && self
                            .tokens
                            .get(index + 1)
                            .is_some_and(|next| next.kind == RawKind::Equal && !next.first_on_line) =>
                    {
                        scl += 1;
                    }
                    _ if self.kind(index + 1) != Some(RawKind::Colon) => {
                        let call = self.kind(index + 1) == Some(RawKind::LeftParen);
                        // `MCR(` is a mnemonic only with its parenthesis.
                        let word = self.slice(index);
                        let zone = call && word.eq_ignore_ascii_case("MCR");
                        // `SET(lamp)` is a call: of the other mnemonics, only those that open a nesting are before a parenthesis.
                        let mnemonic = zone || if call { is_mnemonic(&format!("{word}(")) } else { is_mnemonic(word) };
                        stl += usize::from(mnemonic);
                        scl += usize::from(call && !mnemonic);
                    }
                    _ => {}
                },
                RawKind::Local | RawKind::Quoted | RawKind::Absolute if depth == 0 && starts => scl += 1,
                _ => {}
            }
        }
        match scl.cmp(&stl) {
            std::cmp::Ordering::Greater => Some(Language::Scl),
            std::cmp::Ordering::Less => Some(Language::Stl),
            std::cmp::Ordering::Equal => None,
        }
    }

    /// Whether the statement at `index` is a call as only SCL has it: `A()`, `A(IN := 1)`, `FB1.DB1(...)`, also of an instance that is named
    /// like a mnemonic. In STL `A(` opens a nesting, whose statements have lines of their own.
    fn calls(&self, index: usize) -> bool {
        let mut open = index + 1;
        while self.kind(open) == Some(RawKind::Dot)
            && matches!(self.kind(open + 1), Some(RawKind::Word | RawKind::Quoted))
        {
            open += 2;
        }
        let inner = (self.kind(open + 1), self.kind(open + 2));
        let has_parameters = matches!(inner, (Some(RawKind::RightParen), _) | (_, Some(RawKind::Assign)));
        self.kind(open) == Some(RawKind::LeftParen) && (has_parameters || open > index + 1)
    }

    /// Whether the statement at `index` is an assignment that ends with `;`. Parameters of a CALL are lines without `;`.
    fn assigns(&self, index: usize) -> bool {
        let mut assign = false;
        for token in self.tokens[index..].iter().skip(1) {
            match token.kind {
                RawKind::Assign => assign = true,
                RawKind::Semicolon => return assign,
                RawKind::Comma if assign => return false,
                _ if token.first_on_line => return false,
                _ => {}
            }
        }
        false
    }

    /// Whether the declarations have forms of the TIA Portal.
    fn modern(&self, declarations: Range<usize>) -> bool {
        declarations.clone().any(|index| {
            let token = self.tokens[index];
            let next = self.kind(index + 1).filter(|_| index + 1 < declarations.end);
            match token.kind {
                RawKind::Assign => matches!(next, Some(RawKind::LeftBracket | RawKind::LeftParen)),
                RawKind::LeftBracket => next == Some(RawKind::Star),
                RawKind::Word => match token.keyword {
                    Some(Keyword::RefTo) => true,
                    Some(Keyword::Array) => self.is_content(index),
                    Some(word) if word.begins_section() => {
                        let data = self.tokens[declarations.start].keyword == Some(Keyword::DataBlock);
                        let next = if next == Some(RawKind::Word) { self.slice(index + 1) } else { "" };
                        data || ["RETAIN", "CONSTANT", "DB_SPECIFIC"].iter().any(|word| word.eq_ignore_ascii_case(next))
                    }
                    _ => self.kind(index.wrapping_sub(1)) == Some(RawKind::Colon) && modern_type(self.slice(index)),
                },
                RawKind::Literal => {
                    let prefix = self.slice(index).split('#').next().unwrap_or_default();
                    modern_type(prefix) || ["LT", "LW"].iter().any(|known| known.eq_ignore_ascii_case(prefix))
                }
                _ => false,
            }
        })
    }

    /// Whether a block is an array data block: `ARRAY [` without a name before BEGIN.
    fn is_array(&self, block: Range<usize>) -> bool {
        self.tokens[block.start].keyword == Some(Keyword::DataBlock)
            && block
                .take_while(|index| self.tokens[*index].keyword != Some(Keyword::Begin))
                .any(|index| self.is_content(index) && self.kind(index + 1) == Some(RawKind::LeftBracket))
    }

    /// `ARRAY` that no name and no `OF` is before.
    fn is_content(&self, index: usize) -> bool {
        let after = |before: usize| {
            self.kind(before) == Some(RawKind::Colon) || self.tokens[before].keyword == Some(Keyword::Of)
        };
        self.tokens[index].keyword == Some(Keyword::Array) && index > 0 && !after(index - 1)
    }
}

/// A type that S7-300 and S7-400 do not have.
pub fn modern_type(word: &str) -> bool {
    let upper = word.to_ascii_uppercase();
    match upper.as_str() {
        "DTL" | "WSTRING" | "VARIANT" => true,
        "TOD" | "S5TIME" => false,
        name => Elementary::from_word(name).is_some_and(|ty| !ty.is_of_s7300()),
    }
}
