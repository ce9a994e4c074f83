//! What stands around blocks and statements in other languages and in software units: `NAMESPACE`, `USING`, `#region`. And blocks without
//! their first word.

use plcc_diag::{Code, Diagnostic};

use super::{Area, Edit, Repair};
use crate::ast::BlockPrefix;
use crate::front::frame;
use crate::scl::address;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};

/// Tokens of a type after the name of a block, and the one after it.
const TYPE_TOKENS_MAX: usize = 8;

impl Repair<'_> {
    /// What stands around a block, or in its place.
    pub(super) fn around_blocks(&mut self, token: RawToken) -> bool {
        let outside = !self.statements_begun && token.first_on_line && self.brackets.is_empty();
        outside && (self.name_space(token) || self.enumeration(token) || self.structure_alone(token))
    }

    /// `NAMESPACE Plant.Line … END_NAMESPACE`, `USING Plant.Line;`
    fn name_space(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let word = self.slice(token).to_ascii_uppercase();
        let begins = match word.as_str() {
            "NAMESPACE" | "USING" => true,
            "END_NAMESPACE" if self.name_spaces > 0 => false,
            _ => return false,
        };
        if self.is_declared(&word) {
            return false;
        }
        let mut after = at + 1;
        if begins {
            let is_name =
                |next: RawToken| matches!(next.kind, RawKind::Word | RawKind::Quoted) && next.keyword.is_none();
            if !self.beside(after).is_some_and(is_name) {
                return false;
            }
            while self.beside(after).is_some_and(|next| is_name(next) || next.kind == RawKind::Dot) {
                after += 1;
            }
            let name = self.words(at + 1, after - 1).to_owned();
            let help = match word.as_str() {
                "USING" => "remove it: each block is called by its own name".to_owned(),
                _ => format!("remove it and END_NAMESPACE; a call has the name of the block alone, without `{name}.`"),
            };
            self.report(at, after, "plcc has no namespaces".to_owned(), "all blocks are in one program", help);
        }
        match word.as_str() {
            "NAMESPACE" => self.name_spaces += 1,
            "USING" => {}
            _ => self.name_spaces -= 1,
        }
        let ends = self.beside(after).is_some_and(|next| next.kind == RawKind::Semicolon);
        self.drop_tokens(at, if ends { after + 1 } else { after });
        self.statement = self.at;
        true
    }

    /// `#region Start values` and `#endregion`, each in a line of its own.
    pub(super) fn region_with_sign(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let is = |token: RawToken, word: &str| {
            token.first_on_line
                && at == self.statement
                && token.kind == RawKind::Local
                && self.slice(token).eq_ignore_ascii_case(word)
        };
        let (begins, ends) = (is(token, "#region"), is(token, "#endregion"));
        let is_statement = self.beside(at + 1).is_some_and(|next| next.kind != RawKind::Word);
        if !(begins || ends) || is_statement || self.is_declared(self.slice(token).trim_start_matches('#')) {
            return false;
        }
        let mut after = at + 1;
        while self.beside(after).is_some() {
            after += 1;
        }
        // The message about the beginning has the word for its end.
        if begins || !self.signed_regions {
            let name = if after > at + 1 { self.words(at + 1, after - 1) } else { "" };
            let help = match begins {
                true => format!("write `{}`, and `END_REGION` for `#endregion`", format!("REGION {name}").trim_end()),
                false => "write `END_REGION`".to_owned(),
            };
            self.report(at, after, "a region has no `#`".to_owned(), "a form of other languages", help);
        }
        self.signed_regions |= begins;
        self.drop_tokens(at, after);
        self.statement = self.at;
        true
    }

    /// `STRUCT "Motor" … END_STRUCT` for a data type, in place of a block.
    fn structure_alone(&mut self, token: RawToken) -> bool {
        let at = self.at;
        if token.keyword != Some(Keyword::Struct) || !self.ends_line(at + 2) {
            return false;
        }
        let is_name = |name: &RawToken| matches!(name.kind, RawKind::Word | RawKind::Quoted) && name.keyword.is_none();
        let Some(name) = self.beside(at + 1).filter(is_name) else { return false };
        let Some(end) = self.end_of_structure(at) else { return false };
        let after = if self.kind(end + 1) == Some(RawKind::Semicolon) { end + 2 } else { end + 1 };
        let text = self.slice(name);
        let help = format!("write `TYPE {text} STRUCT … END_STRUCT; END_TYPE`");
        let message = Diagnostic::new(Code::BlockFrame, self.span(at, at + 2), "a structure with a name is a TYPE");
        self.messages.push(message.label("read as a data type").help(help));
        let begins = no_width(name.end, Keyword::Struct);
        let with = vec![RawToken { keyword: Some(Keyword::Type), ..token }, name, begins];
        self.edits.push(Edit { first: at, after: at + 2, with });
        self.at = at + 2;
        self.area = Area::Declarations;
        self.begin_statement();
        while self.at < after {
            let (before, token) = (self.at, self.tokens[self.at]);
            self.declaration_token(token);
            self.at = self.at.max(before + 1);
        }
        self.area = Area::Statements;
        self.begin_statement();
        let at = self.at - 1;
        if self.keyword(at + 1) != Some(Keyword::EndType) && self.edits.last().is_none_or(|edit| edit.after <= at) {
            let last = self.tokens[at];
            let end = no_width(last.end, Keyword::EndType);
            self.edits.push(Edit { first: at, after: at + 1, with: vec![last, end] });
        }
        true
    }

    /// Index of the END_STRUCT that belongs to the STRUCT at `at`.
    fn end_of_structure(&self, at: usize) -> Option<usize> {
        let mut depth = 0usize;
        for (index, token) in self.tokens.iter().enumerate().skip(at) {
            match token.keyword {
                Some(Keyword::Struct) => depth += 1,
                Some(Keyword::EndStruct) if depth == 1 => return Some(index),
                Some(Keyword::EndStruct) => depth -= 1,
                Some(word) if word.ends_block() || word.begins_section() || word == Keyword::Begin => return None,
                _ => {}
            }
        }
        None
    }

    /// `FB 10`, `"Motor"` or `"Data" "Motor"` in a line of its own, before declarations: the first word of a block is missing.
    pub(super) fn head_alone(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let outside = !self.statements_begun && token.first_on_line && self.brackets.is_empty();
        if !outside || token.keyword.is_some() {
            return false;
        }
        let word = self.slice(token);
        let is_number = |number: RawToken| number.kind == RawKind::Number;
        let (prefix, after) = match (token.kind, address::numbered_block(word), address::block_prefix(word)) {
            (RawKind::Quoted, ..) => (None, at + 1),
            (RawKind::Word, Some((prefix, _)), _) => (Some(prefix), at + 1),
            (RawKind::Word, None, Some(prefix)) if self.beside(at + 1).is_some_and(is_number) => (Some(prefix), at + 2),
            _ => return false,
        };
        // The type of a function or of a data block.
        let next = (after..after + TYPE_TOKENS_MAX).find(|index| self.ends_line(*index));
        let Some(next) = next.filter(|next| self.header_goes_on(*next)) else { return false };
        let frames = |word: &Keyword| word.ends_block() || word.begins_block();
        let end = self.tokens[at..].iter().find_map(|token| token.keyword.filter(frames));
        let (keyword, number) = match end {
            Some(Keyword::EndOrganizationBlock) => (Keyword::OrganizationBlock, BlockPrefix::Ob),
            Some(Keyword::EndFunction) => (Keyword::Function, BlockPrefix::Fc),
            Some(Keyword::EndFunctionBlock) => (Keyword::FunctionBlock, BlockPrefix::Fb),
            Some(Keyword::EndDataBlock) => (Keyword::DataBlock, BlockPrefix::Db),
            Some(Keyword::EndType) => (Keyword::Type, BlockPrefix::Udt),
            _ => return false,
        };
        let has_type = match keyword {
            Keyword::Function => next == after || self.kind(after) == Some(RawKind::Colon),
            Keyword::DataBlock => next == after || matches!(self.kind(after), Some(RawKind::Quoted | RawKind::Word)),
            _ => next == after,
        };
        if prefix.is_some_and(|prefix| prefix != number) || !has_type {
            return false;
        }
        let name = self.words(at, after - 1);
        self.messages.push(frame::no_keyword_before_name(self.span(at, after), keyword.word(), name));
        let opening = RawToken { first_on_line: true, ..no_width(token.start, keyword) };
        self.edits.push(Edit {
            first: at,
            after: at + 1,
            with: vec![opening, RawToken { first_on_line: false, ..token }],
        });
        self.note(opening);
        self.at = at + 1;
        self.last = Some(token);
        true
    }

    /// Whether a line of a header or of declarations begins at `at`.
    fn header_goes_on(&self, at: usize) -> bool {
        let begins = |word: Keyword| word.begins_section() || matches!(word, Keyword::Begin | Keyword::Struct);
        matches!(self.kind(at), Some(RawKind::LeftBrace | RawKind::Title)) || self.keyword(at).is_some_and(begins)
    }

    /// Whether no token of the line before is at `at`.
    fn ends_line(&self, at: usize) -> bool {
        self.beside(at).is_none()
    }
}

/// A keyword that the text does not have, at byte `at`.
fn no_width(at: u32, keyword: Keyword) -> RawToken {
    RawToken { kind: RawKind::Word, start: at, end: at, first_on_line: false, keyword: Some(keyword) }
}
