//! Declarations of other languages: `POINTER TO INT`, `speed AT %MW10 : INT;`, `ARRAY[1..3] OF INT := (1, 2, 3)`. And `low, high INT;`,
//! `belt speed : INT;`, `speed RETAIN : INT;`.

use super::{Edit, Repair};
use crate::Elementary;
use crate::ast::OperandKind;
use crate::scl::address;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};

/// Tokens of a list of start values.
const LIST_MAX: usize = 300;

impl Repair<'_> {
    /// A part of a declaration that another language has.
    pub(super) fn foreign_declaration(&mut self, token: RawToken) -> bool {
        self.retain_of_variable(token)
            || self.pointer_to(token)
            || self.address_of_variable(token)
            || self.list_in_parentheses(token)
            || self.list_without_colon(token)
            || self.name_with_blank(token)
    }

    /// `speed RETAIN : INT;`, `speed : INT RETAIN;`
    fn retain_of_variable(&mut self, token: RawToken) -> bool {
        let (first, at) = (self.statement, self.at);
        let word = self.slice(token).to_ascii_uppercase();
        let is_retain = token.kind == RawKind::Word && matches!(word.as_str(), "RETAIN" | "NON_RETAIN");
        let name = self.words(first, first);
        if !is_retain || at <= first || self.kind(first) != Some(RawKind::Word) || is_option(name) {
            return false;
        }
        let next = self.kind(at + 1);
        let after_name = at == first + 1 && next == Some(RawKind::Colon);
        let after_type = at > first + 2
            && self.kind(first + 1) == Some(RawKind::Colon)
            && matches!(self.kind(at - 1), Some(RawKind::Word | RawKind::Quoted | RawKind::RightBracket))
            && matches!(next, Some(RawKind::Semicolon | RawKind::Assign));
        if !after_name && !after_type {
            return false;
        }
        let title = format!("{word} is for a section, not for one variable");
        let help = format!("declare `{name}` in a section `VAR {word}`");
        self.report(at, at + 1, title, "a form of other languages", help);
        self.drop_tokens(at, at + 1);
        true
    }

    /// `low, high INT;` without `:`.
    fn list_without_colon(&mut self, token: RawToken) -> bool {
        let (first, at) = (self.statement, self.at);
        // Two words in a row are rare in a declaration.
        let after_word = at >= first + 3 && self.kind(at - 1) == Some(RawKind::Word);
        let next = self.kind(at + 1);
        let ends = matches!(next, Some(RawKind::Semicolon | RawKind::Assign | RawKind::Equal | RawKind::LeftBracket));
        if token.kind != RawKind::Word || !after_word || !ends {
            return false;
        }
        let upper = self.slice(token).to_ascii_uppercase();
        let is_type = Elementary::from_word(&upper).is_some() || upper == "STRING";
        let is_list = (first..at).all(|index| {
            let is_name = (index - first).is_multiple_of(2);
            self.kind(index) == Some(if is_name { RawKind::Word } else { RawKind::Comma })
        });
        if !is_type || !is_list {
            return false;
        }
        let name = self.words(at - 1, at - 1);
        let title = format!("`:` is missing between `{name}` and its type");
        let length = self.closing(at + 1).filter(|_| next == Some(RawKind::LeftBracket));
        let help = format!("write `{} : {};`", self.words(first, at - 1), self.words(at, length.unwrap_or(at)));
        self.report(at - 1, at + 1, title, "not a declaration of SCL", help);
        self.declared.insert(name.to_uppercase(), at - 1);
        let colon = RawToken { kind: RawKind::Colon, end: token.start, first_on_line: false, keyword: None, ..token };
        self.edits.push(Edit { first: at, after: at + 1, with: vec![colon, token] });
        self.at = at + 1;
        self.last = Some(token);
        true
    }

    /// `belt speed : INT;`
    fn name_with_blank(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let is_name = |token: RawToken| token.kind == RawKind::Word && token.keyword.is_none();
        let Some(next) = self.beside(at + 1).filter(|next| is_name(*next)) else { return false };
        let (first, second) = (self.slice(token), self.slice(next));
        if !is_name(token)
            || !token.first_on_line
            || at != self.statement
            || self.kind(at + 2) != Some(RawKind::Colon)
            || is_option(first)
            || ["RETAIN", "NON_RETAIN"].iter().any(|word| word.eq_ignore_ascii_case(second))
            || Elementary::from_word(&first.to_ascii_uppercase()).is_some()
        {
            return false;
        }
        let title = format!("`{first} {second}` is not a name");
        let help = format!("a name has no blanks: write `{first}_{second}`");
        self.report(at, at + 2, title, "two words", help);
        let whole = RawToken { end: next.end, ..token };
        self.declared.insert(self.slice(whole).to_uppercase(), at);
        self.edits.push(Edit { first: at, after: at + 2, with: vec![whole] });
        self.at = at + 2;
        self.last = Some(whole);
        true
    }

    /// `p : POINTER TO INT;`
    fn pointer_to(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let is_type = self.last.is_some_and(|last| last.kind == RawKind::Colon || last.keyword == Some(Keyword::Of));
        if token.kind != RawKind::Word
            || !self.slice(token).eq_ignore_ascii_case("POINTER")
            || !is_type
            || self.keyword(at + 1) != Some(Keyword::To)
        {
            return false;
        }
        let ty = self.words(at + 2, at + 2);
        let help = format!("write `REF_TO {ty}`; its value is `REF(variable)`");
        self.report(at, at + 2, "SCL has no POINTER TO".to_owned(), "read as `REF_TO`", help);
        self.replace(at, at + 2, RawKind::Word, Some(Keyword::RefTo));
        true
    }

    /// `speed AT %MW10 : INT;`: AT of SCL names a variable.
    fn address_of_variable(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let Some(named) = at.checked_sub(1).and_then(|before| self.token(before)) else { return false };
        if token.keyword != Some(Keyword::At) || !matches!(named.kind, RawKind::Word | RawKind::Local | RawKind::Quoted)
        {
            return false;
        }
        let Some(place) = self.token(at + 1) else { return false };
        let word = self.slice(place);
        let is_address = place.kind == RawKind::Absolute
            || place.kind == RawKind::Word
                && !self.is_declared(word)
                && matches!(address::absolute(word), Some(OperandKind::Absolute { .. }));
        // `AT %I*`
        let open = self.kind(at + 2) == Some(RawKind::Star);
        let after = if open { at + 3 } else { at + 2 };
        if !is_address || self.kind(after) != Some(RawKind::Colon) {
            return false;
        }
        let name = self.slice(named);
        let help = match open {
            true => format!("remove the variable, and write the address, or its tag, where `{name}` is used"),
            false => format!("remove the variable, and write `{word}`, or its tag, where `{name}` is used"),
        };
        let title = "a variable of a block has no address".to_owned();
        self.report(at, after, title, "AT names another variable of the block", help);
        self.declared.insert(name.trim_start_matches('#').to_uppercase(), at - 1);
        self.drop_tokens(at, after);
        true
    }

    /// `:= (1, 2, 3)`, `:= {1, 2, 3}` for an array.
    fn list_in_parentheses(&mut self, token: RawToken) -> bool {
        let at = self.at;
        if !self.last.is_some_and(|last| last.kind == RawKind::Assign) {
            return false;
        }
        let close = match token.kind {
            RawKind::LeftParen => self.closing(at),
            RawKind::LeftBrace => self.closing_brace(at, LIST_MAX),
            _ => return false,
        };
        let Some(close) = close.filter(|close| *close > at + 1 && self.kind(*close + 1) == Some(RawKind::Semicolon))
        else {
            return false;
        };
        let elements =
            (self.statement..at).rev().take(LIST_MAX).find(|index| self.keyword(*index) == Some(Keyword::Of));
        let elementary = elements.and_then(|of| self.token(of + 1)).is_some_and(|ty| {
            let word = self.slice(ty).to_ascii_uppercase();
            Elementary::from_word(&word).is_some()
        });
        let nested =
            (at + 1..close).any(|index| matches!(self.kind(index), Some(RawKind::LeftParen | RawKind::LeftBrace)));
        if !elementary || nested {
            return false;
        }
        let values = self.words(at + 1, close - 1);
        let help = format!("write `[{values}]`, in a source of STEP 7 V5 `{values}`");
        let title = "the start values of an array are written in brackets".to_owned();
        self.report(at, close + 1, title, "read as a list", help);
        let mut with = self.tokens[at..=close].to_vec();
        with[0].kind = RawKind::LeftBracket;
        with[close - at].kind = RawKind::RightBracket;
        self.last = with.last().copied();
        self.edits.push(Edit { first: at, after: close + 1, with });
        self.at = close + 1;
        true
    }
}

/// A word after VAR that says something about the section.
fn is_option(word: &str) -> bool {
    ["RETAIN", "NON_RETAIN", "CONSTANT", "PERSISTENT"].iter().any(|option| option.eq_ignore_ascii_case(word))
}
