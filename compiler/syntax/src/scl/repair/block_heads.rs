//! First lines of blocks of other languages: `FUNCTION "Sum" (a : Int) : Int`, `FUNCTION Int "Sum"`, `FUNCTION "Sum" RETURNS Int`,
//! `FUNCTION_BLOCK "Sum" : Int`, `FUNCTION_BLOCK "Sum";`.

use super::Repair;
use super::sections::plain;
use crate::Elementary;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};

/// Longer parameters are not repeated in a help.
const PARAMETERS_MAX: usize = 60;

impl Repair<'_> {
    /// A part of the first line of a block that belongs elsewhere.
    pub(super) fn foreign_head(&mut self, token: RawToken) -> bool {
        !token.first_on_line
            && (self.parameters_in_head(token)
                || self.type_before_name(token)
                || self.returns(token)
                || self.value_of_function_block(token)
                || self.semicolon_after_head(token))
    }

    /// Whether the token before `at` is the name of a block.
    fn follows_name(&self, at: usize) -> bool {
        let begins = |back: usize| {
            let keyword = at.checked_sub(back).and_then(|index| self.keyword(index));
            matches!(
                keyword,
                Some(Keyword::Function | Keyword::FunctionBlock | Keyword::OrganizationBlock | Keyword::Program)
            )
        };
        match at.checked_sub(1).and_then(|index| self.kind(index)) {
            Some(RawKind::Word | RawKind::Quoted) => begins(2),
            // `FC 1`
            Some(RawKind::Number) => begins(3),
            _ => false,
        }
    }

    /// `FUNCTION "Sum" (a : Int; b : Int) : Int`
    fn parameters_in_head(&mut self, token: RawToken) -> bool {
        let at = self.at;
        if token.kind != RawKind::LeftParen || !self.follows_name(at) {
            return false;
        }
        let Some(close) = self.closing(at) else { return false };
        let inner = if close > at + 1 { self.words(at + 1, close - 1).trim_end_matches(';') } else { "" };
        let (title, help) = match inner {
            "" => ("the first line of a block has no parentheses", "remove `()`".to_owned()),
            _ if inner.contains(':') && inner.len() <= PARAMETERS_MAX => (
                "the parameters of a block are declared in sections",
                format!("write `VAR_INPUT {inner}; END_VAR` after this line"),
            ),
            _ => (
                "the parameters of a block are declared in sections",
                "declare them between `VAR_INPUT` and `END_VAR` after this line".to_owned(),
            ),
        };
        self.report(at, close + 1, title.to_owned(), "a form of other languages", help);
        self.note_absent(at + 1, close, true);
        self.drop_tokens(at, close + 1);
        true
    }

    /// `FUNCTION Int "Sum"`
    fn type_before_name(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let is_function = at > 0 && self.keyword(at - 1) == Some(Keyword::Function);
        let upper = self.slice(token).to_ascii_uppercase();
        let is_type = upper == "VOID" || Elementary::from_word(&upper).is_some();
        let name = self
            .beside(at + 1)
            .filter(|next| matches!(next.kind, RawKind::Word | RawKind::Quoted) && next.keyword.is_none());
        let Some(name) = name.filter(|_| is_function && is_type && token.kind == RawKind::Word) else { return false };
        let (ty, name) = (self.slice(token), self.slice(name));
        let help = format!("write `FUNCTION {name} : {ty}`");
        self.report(
            at,
            at + 2,
            "the type of a function comes after its name".to_owned(),
            "a form of other languages",
            help,
        );
        // Its value, which is then unknown.
        self.absent.insert(plain(name), true);
        self.drop_tokens(at, at + 1);
        true
    }

    /// `FUNCTION_BLOCK "Sum" : Int`
    fn value_of_function_block(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let is_block = at >= 2 && self.keyword(at - 2) == Some(Keyword::FunctionBlock) && self.follows_name(at);
        let ty = self.beside(at + 1).filter(|next| matches!(next.kind, RawKind::Word | RawKind::Quoted));
        let Some(ty) = ty.filter(|_| is_block && token.kind == RawKind::Colon) else { return false };
        let ty = self.slice(ty);
        let help = match ty.eq_ignore_ascii_case("VOID") {
            true => format!("remove `: {ty}`"),
            false => format!("write `VAR_OUTPUT result : {ty}; END_VAR` after this line"),
        };
        let title = "only a function has a value of its own".to_owned();
        self.report(at, at + 2, title, "a function block has outputs", help);
        self.absent.insert(plain(self.words(at - 1, at - 1)), true);
        self.drop_tokens(at, at + 2);
        true
    }

    /// `FUNCTION_BLOCK "Sum";`, `FUNCTION "Sum" : Int;`
    fn semicolon_after_head(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let typed = at >= 2 && self.kind(at - 2) == Some(RawKind::Colon) && self.follows_name(at - 2);
        if token.kind != RawKind::Semicolon || !(typed || self.follows_name(at)) {
            return false;
        }
        // `FUNCTION FC 1 : VOID ; END_FUNCTION` has an empty statement.
        if self.keyword(at + 1).is_some_and(Keyword::ends_block) {
            return false;
        }
        let title = "the first line of a block has no `;`".to_owned();
        self.report(at, at + 1, title, "one sign too many", "remove the `;`".to_owned());
        self.drop_tokens(at, at + 1);
        true
    }

    /// `FUNCTION "Sum" RETURNS Int`
    fn returns(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let word = self.slice(token);
        let known = ["RETURNS", "RETURN", "AS"].iter().any(|known| known.eq_ignore_ascii_case(word));
        let Some(ty) = self.beside(at + 1).filter(|_| known && self.follows_name(at)) else { return false };
        let help = format!("write `: {}`", self.slice(ty));
        self.report(at, at + 1, "the type of a function follows a colon".to_owned(), "read as `:`", help);
        self.replace(at, at + 1, RawKind::Colon, None);
        true
    }
}
