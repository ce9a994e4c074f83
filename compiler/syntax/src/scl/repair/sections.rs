//! Sections that no block has, or not there: `VAR_GLOBAL`, and VAR among the statements. What uses their variables is not reported again.

use super::Repair;
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};

/// Sections of variables that belong to no block, and what is there instead; none: a data block.
const GLOBALS: [(&str, Option<&str>); 4] = [
    ("VAR_GLOBAL", None),
    ("VAR_EXTERNAL", Some("remove the section: data blocks and tags are known in each block by their names")),
    ("VAR_CONFIG", Some("give each variable its address in the tag table")),
    ("VAR_ACCESS", Some("remove the section")),
];

/// Words between the one that begins a section and its declarations.
const MODIFIERS: [&str; 5] = ["CONSTANT", "RETAIN", "NON_RETAIN", "PERSISTENT", "DB_SPECIFIC"];

/// A first declaration that is longer than this is not shown in a help.
const DECLARATION_MAX: usize = 60;

/// Tokens of a section in the wrong place.
const SECTION_MAX: usize = 10_000;

impl Repair<'_> {
    /// `VAR_GLOBAL … END_VAR`
    pub(super) fn global_section(&mut self, token: RawToken) -> bool {
        if self.iec || token.kind != RawKind::Word || !token.first_on_line || !self.brackets.is_empty() {
            return false;
        }
        let word = self.slice(token);
        let Some((name, help)) = GLOBALS.iter().find(|(known, _)| known.eq_ignore_ascii_case(word)) else {
            return false;
        };
        let at = self.at;
        let Some(end) = self.end_of_section(at) else { return false };
        let help = match help {
            Some(help) => (*help).to_owned(),
            None => self.as_data_block(at + 1, end),
        };
        self.report(at, at + 1, format!("a block has no {name}"), "a form of other languages", help);
        self.note_absent(at + 1, end, false);
        self.drop_tokens(at, end + 1);
        self.statement = self.at;
        true
    }

    /// The declarations between the tokens as those of a data block; constants have another place.
    fn as_data_block(&self, first: usize, end: usize) -> String {
        let begin = self.first_declaration(first, end);
        let has = |word: &str| (first..begin).any(|index| self.words(index, index).eq_ignore_ascii_case(word));
        if has("CONSTANT") {
            return "give the constants their values in the tag table, or in `VAR CONSTANT … END_VAR` of the blocks that use them"
                .to_owned();
        }
        let section = if has("RETAIN") || has("PERSISTENT") { "VAR RETAIN" } else { "VAR" };
        let semicolon = (begin..end).find(|index| self.kind(*index) == Some(RawKind::Semicolon));
        let declaration = semicolon.map_or("…", |semicolon| self.words(begin, semicolon));
        let declaration = if declaration.len() > DECLARATION_MAX { "…" } else { declaration };
        let more = if semicolon.is_some_and(|semicolon| semicolon + 1 < end) { " …" } else { "" };
        let name = self.words(begin, begin);
        let block = format!("DATA_BLOCK \"Globals\" {section} {declaration}{more} END_VAR BEGIN END_DATA_BLOCK");
        format!("write `{block}`, and `\"Globals\".{name}` for `{name}`")
    }

    /// Index of the first declaration between the tokens: after `CONSTANT` or `RETAIN`, which may also be the name of a variable.
    fn first_declaration(&self, first: usize, end: usize) -> usize {
        let is_modifier = |index: &usize| {
            let word = self.words(*index, *index);
            let names = matches!(self.kind(index + 1), Some(RawKind::Colon | RawKind::Comma));
            !names && MODIFIERS.iter().any(|known| known.eq_ignore_ascii_case(word))
        };
        (first..end).find(|index| !is_modifier(index)).unwrap_or(first)
    }

    /// `VAR … END_VAR` after BEGIN, which the classifier reports.
    pub(super) fn note_late_section(&mut self, token: RawToken) {
        let begins = token.keyword.is_some_and(|word| word.begins_section() && word != Keyword::Label);
        if begins
            && self.statements_begun
            && let Some(end) = self.end_of_section(self.at)
        {
            self.note_absent(self.at + 1, end, true);
        }
    }

    /// Index of the word that ends the section at `at`, within its block.
    fn end_of_section(&self, at: usize) -> Option<usize> {
        let ends = |index: &usize| self.keyword(*index).is_some_and(|word| word.ends_section() || word.ends_block());
        let end = (at + 1..self.tokens.len()).take(SECTION_MAX).find(ends)?;
        self.keyword(end).filter(|word| word.ends_section()).map(|_| end)
    }

    /// Notes the names that are declared between the tokens.
    pub(super) fn note_absent(&mut self, first: usize, end: usize, of_block: bool) {
        let first = self.first_declaration(first, end);
        for index in first..end {
            let begins = index == first || matches!(self.kind(index - 1), Some(RawKind::Semicolon | RawKind::Comma));
            let declares = matches!(self.kind(index + 1), Some(RawKind::Colon | RawKind::Comma | RawKind::LeftBrace));
            if begins && declares && matches!(self.kind(index), Some(RawKind::Word | RawKind::Local | RawKind::Quoted))
            {
                let name = plain(self.words(index, index));
                self.absent.insert(name, of_block);
            }
        }
    }

    /// The use of a variable whose section was reported.
    pub(super) fn absent_use(&mut self, token: RawToken) -> bool {
        let at = self.at;
        let formal = matches!(self.kind(at + 1), Some(RawKind::Assign | RawKind::Arrow)) && !self.brackets.is_empty();
        let member = self.last.is_some_and(|last| last.kind == RawKind::Dot);
        if self.absent.is_empty()
            || !matches!(token.kind, RawKind::Word | RawKind::Local | RawKind::Quoted)
            || token.keyword.is_some()
            || formal
            || member
            || !self.absent.contains_key(&plain(self.slice(token)))
        {
            return false;
        }
        self.replace(at, self.operand_end(at), RawKind::Reported, None);
        true
    }
}

/// A name without its signs, in upper case.
pub(super) fn plain(name: &str) -> String {
    name.trim_matches(['#', '"']).to_uppercase()
}
