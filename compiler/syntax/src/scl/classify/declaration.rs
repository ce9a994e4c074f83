//! Classifies the words of declarations, types and the values of a data block.

use plcc_diag::{Code, Diagnostic};
use plcc_literal::distance;

use super::expression::Run;
use super::{Classifier, unquoted};
use crate::ast::{Retain, SectionKind};
use crate::front::{NESTING_MAX, frame};
use crate::scl::keyword::Keyword;
use crate::scl::raw::{RawKind, RawToken};
use crate::scl::token::{CodeKeyword, Tok};

/// Tokens of a section without its first word.
const SECTION_MAX: usize = 10_000;

impl<'a> Classifier<'a, '_> {
    /// A section from its keyword to its end.
    pub(super) fn section(&mut self) {
        let opening = self.raw[self.at];
        match opening.keyword {
            Some(Keyword::Const) => self.constant_section(opening, Keyword::EndConst),
            Some(Keyword::Label) => self.label_section(opening),
            Some(keyword) => self.variable_section(opening, keyword),
            None => self.at += 1,
        }
        // A `;` after the end has no meaning.
        if self.is_at(RawKind::Semicolon) {
            self.at += 1;
        }
    }

    /// Whether declarations up to END_VAR follow, before which no section begins.
    pub(super) fn declarations_without_section(&self) -> bool {
        if !matches!(self.kind_at(self.at + 1), Some(RawKind::Colon | RawKind::Comma)) {
            return false;
        }
        let ends = |word: Keyword| {
            word.ends_section()
                || word.begins_section()
                || word.ends_block()
                || word.begins_statement()
                || word == Keyword::Begin
        };
        let rest = self.raw[self.at..].iter().take(SECTION_MAX);
        rest.filter_map(|token| token.keyword).find(|word| ends(*word)) == Some(Keyword::EndVar)
    }

    /// `speed : INT; … END_VAR` without its first word, which is reported.
    pub(super) fn section_without_keyword(&mut self, first: RawToken) {
        let blocks = self.out.iter().rev().find_map(|(_, token, _)| match token {
            Tok::Code(keyword) => Some(*keyword),
            _ => None,
        });
        let (kind, word) = match blocks {
            Some(CodeKeyword::FunctionBlock) => (SectionKind::Static, "VAR"),
            Some(CodeKeyword::Function | CodeKeyword::OrganizationBlock) | None => (SectionKind::Temp, "VAR_TEMP"),
        };
        self.report(frame::no_section(self.span(first), word));
        let start = first.start as usize;
        self.push(start, Tok::Section(kind, Retain::Unsaid), start);
        self.declarations(0);
        self.end_of_section(first, Keyword::EndVar);
        if self.is_at(RawKind::Semicolon) {
            self.at += 1;
        }
    }

    /// `END_VAR` once more.
    pub(super) fn ends_no_section(&mut self, end: RawToken) {
        self.report(frame::ends_no_section(self.span(end), self.slice(end)));
        self.at += 1;
        if self.is_at(RawKind::Semicolon) {
            self.at += 1;
        }
    }

    fn variable_section(&mut self, opening: RawToken, keyword: Keyword) {
        let kind = match keyword {
            Keyword::VarInput => SectionKind::Input,
            Keyword::VarOutput => SectionKind::Output,
            Keyword::VarInOut => SectionKind::InOut,
            Keyword::VarTemp => SectionKind::Temp,
            _ => SectionKind::Static,
        };
        let (mut retain, mut count) = (Retain::Unsaid, 0);
        while let Some(word) = self.raw.get(self.at + 1 + count)
            && word.kind == RawKind::Word
            && !matches!(self.kind_at(self.at + 2 + count), Some(RawKind::Colon | RawKind::Comma | RawKind::LeftBrace))
            && self.keyword_at(self.at + 2 + count) != Some(Keyword::At)
        {
            let (text, word) = (self.slice(*word), *word);
            if text.eq_ignore_ascii_case("CONSTANT") || self.short_constant(word) {
                self.at += count + 1;
                return self.constant_section(opening, Keyword::EndVar);
            }
            retain = match () {
                () if text.eq_ignore_ascii_case("RETAIN") => Retain::Retain,
                () if text.eq_ignore_ascii_case("NON_RETAIN") => Retain::NonRetain,
                () if text.eq_ignore_ascii_case("DB_SPECIFIC") => Retain::DbSpecific,
                () if text.eq_ignore_ascii_case("PERSISTENT") => {
                    let next = self.raw.get(self.at + 2 + count).map_or("", |next| self.slice(*next));
                    self.persistent(word, retain == Retain::Retain || next.eq_ignore_ascii_case("RETAIN"));
                    Retain::Retain
                }
                () => match self.misspelt_retain(word, self.at + 2 + count) {
                    Some(retain) => retain,
                    None => break,
                },
            };
            if kind == SectionKind::Temp && text.eq_ignore_ascii_case("RETAIN") {
                self.report(
                    Diagnostic::new(Code::Tolerated, self.span(word), "temporary data is not kept")
                        .label("has no effect")
                        .help("remove it, or declare the variables in `VAR RETAIN` of a function block"),
                );
            }
            count += 1;
        }
        self.at += count;
        let end = self.raw[self.at].end;
        self.push(opening.start as usize, Tok::Section(kind, retain), end as usize);
        self.at += 1;
        self.declarations(0);
        self.end_of_section(opening, Keyword::EndVar);
    }

    /// `VAR PERSISTENT`, which is reported. `retains`: the section has the word RETAIN, too.
    fn persistent(&mut self, word: RawToken, retains: bool) {
        let help = if retains { "remove it: RETAIN keeps the values" } else { "write `RETAIN`" };
        self.report(
            Diagnostic::new(Code::ForeignForm, self.span(word), "a section of SCL has no PERSISTENT")
                .label("read as `RETAIN`")
                .help(help),
        );
    }

    /// `VAR CONST`, which is reported.
    fn short_constant(&mut self, word: RawToken) -> bool {
        let is_short = word.keyword == Some(Keyword::Const) && !word.first_on_line;
        if is_short {
            let message = Diagnostic::new(
                Code::MisspeltKeyword,
                self.span(word),
                format!("the word is `CONSTANT`, not `{}`", self.slice(word)),
            );
            self.report(message.label("read as `CONSTANT`").help("write `VAR CONSTANT`"));
        }
        is_short
    }

    /// A word like `RETAN` after VAR, alone on its line, which is reported and read as meant.
    fn misspelt_retain(&mut self, word: RawToken, next: usize) -> Option<Retain> {
        let alone = !word.first_on_line && self.raw.get(next).is_none_or(|token| token.first_on_line);
        let text = self.slice(word);
        let meant = distance::nearest(text, ["RETAIN", "NON_RETAIN"].into_iter()).filter(|_| alone)?;
        self.report(
            Diagnostic::new(Code::MisspeltKeyword, self.span(word), format!("`{text}` is not a word of a section"))
                .label(format!("read as {meant}"))
                .help(format!("write `{meant}`")),
        );
        Some(if meant == "RETAIN" { Retain::Retain } else { Retain::NonRetain })
    }

    /// `VAR CONSTANT`, `CONST`; the last word of the head is the current token.
    pub(super) fn constant_section(&mut self, opening: RawToken, end: Keyword) {
        let last = self.raw[self.at];
        self.push(opening.start as usize, Tok::Constants, last.end as usize);
        self.at += 1;
        while let Some(token) = self.peek() {
            if self.section_ends(token) {
                break;
            }
            if token.kind == RawKind::Semicolon {
                self.at += 1;
                continue;
            }
            let before = self.at;
            if matches!(token.kind, RawKind::Word | RawKind::Local | RawKind::Quoted) {
                let name = unquoted(self.slice(token));
                self.constants.insert(name.to_uppercase());
                self.declared_name(token);
            }
            while self.is_at(RawKind::LeftBrace) {
                self.attributes();
            }
            if self.is_at(RawKind::Colon) {
                self.take(Tok::Colon);
                self.type_tokens();
            }
            self.run(Run::Value);
            self.end_of_declaration();
            if self.at == before {
                self.at += 1;
            }
        }
        self.end_of_section(opening, end);
    }

    fn label_section(&mut self, opening: RawToken) {
        self.take(Tok::Labels);
        while let Some(token) = self.peek() {
            if self.section_ends(token) {
                break;
            }
            if token.kind == RawKind::Semicolon {
                self.at += 1;
                continue;
            }
            let before = self.at;
            self.run(Run::Value);
            self.end_of_declaration();
            if self.at == before {
                self.at += 1;
            }
        }
        self.end_of_section(opening, Keyword::EndLabel);
    }

    fn end_of_section(&mut self, opening: RawToken, end: Keyword) {
        if let Some(token) = self.peek()
            && let Some(word) = token.keyword.filter(|word| word.ends_section())
        {
            if word != end {
                let (found, text) = (self.slice(token), self.slice(opening));
                self.report(
                    Diagnostic::new(Code::BlockFrame, self.span(token), format!("`{found}` cannot end `{text}`"))
                        .label("the section ends here")
                        .help(format!("write `{}`", end.word())),
                );
            }
            return self.take(Tok::EndVar);
        }
        let (text, end) = (self.slice(opening), end.word());
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(opening), format!("`{text}` is not closed with `{end}`"))
                .label("the section begins here")
                .help(format!("write `{end}` after its last declaration")),
        );
        self.push_here(Tok::EndVar);
    }

    /// Whether a section ends at the token, at its end or at a token that is not allowed in it.
    fn section_ends(&self, token: RawToken) -> bool {
        // A variable may have the name of a keyword.
        if matches!(self.kind_at(self.at + 1), Some(RawKind::Colon)) {
            return false;
        }
        token.keyword.is_some_and(|word| {
            word.ends_section()
                || word.ends_block()
                || word.begins_section()
                || word.begins_statement()
                || word == Keyword::Begin
                || word.begins_block() && self.block_begins(self.at)
        })
    }

    /// Declarations up to the end of their section or STRUCT.
    pub(super) fn declarations(&mut self, depth: usize) {
        while let Some(token) = self.peek() {
            if self.section_ends(token) {
                return;
            }
            match (token.kind, token.keyword) {
                (RawKind::Semicolon, _) => self.at += 1,
                (_, Some(Keyword::EndStruct)) => {
                    if depth > 0 {
                        return;
                    }
                    self.report(
                        Diagnostic::new(Code::BlockFrame, self.span(token), "`END_STRUCT` has no matching STRUCT")
                            .label("no structure is open here")
                            .help("remove it"),
                    );
                    self.at += 1;
                }
                _ => {
                    let before = self.at;
                    self.declaration(depth);
                    if self.at == before {
                        self.at += 1;
                    }
                }
            }
        }
    }

    /// `a, b {attributes} AT c : type := value;`
    fn declaration(&mut self, depth: usize) {
        while let Some(token) = self.peek() {
            match (token.kind, token.keyword) {
                (RawKind::Colon, _) => {
                    self.take(Tok::Colon);
                    self.type_at_depth(depth);
                    break;
                }
                (RawKind::Comma, _) => self.take(Tok::Comma),
                (RawKind::LeftBrace, _) => self.attributes(),
                (_, Some(Keyword::At))
                    if !matches!(self.kind_at(self.at + 1), Some(RawKind::Colon | RawKind::Comma)) =>
                {
                    self.take(Tok::At);
                }
                (RawKind::Word | RawKind::Local | RawKind::Quoted, _) if !self.section_ends(token) => {
                    self.declared_name(token);
                }
                _ => break,
            }
        }
        if self.is_at(RawKind::Assign) {
            self.take(Tok::Assign);
            self.run(Run::Value);
        } else if !self.is_at(RawKind::Semicolon) && !self.next_declaration() {
            self.run(Run::Value);
        }
        self.end_of_declaration();
    }

    fn declared_name(&mut self, token: RawToken) {
        let name = unquoted(self.slice(token));
        self.take(match token.kind {
            RawKind::Quoted => Tok::Quoted(name),
            RawKind::Local => Tok::Local(name),
            _ => Tok::Name(name),
        });
    }

    /// Whether the current token begins a line and looks like another declaration, or ends the section.
    fn next_declaration(&self) -> bool {
        let Some(token) = self.peek() else { return true };
        self.section_ends(token)
            || token.keyword == Some(Keyword::EndStruct)
            || token.first_on_line
                && matches!(token.kind, RawKind::Word | RawKind::Quoted)
                && matches!(self.kind_at(self.at + 1), Some(RawKind::Colon | RawKind::Comma | RawKind::LeftBrace))
    }

    /// The `;` of a declaration.
    fn end_of_declaration(&mut self) {
        if self.is_at(RawKind::Semicolon) {
            return self.take(Tok::End);
        }
        let after_struct = matches!(self.out.last(), Some((_, Tok::EndStruct, _)));
        if let Some(last) = self.last_token().filter(|_| !after_struct) {
            let reported =
                self.diagnostics.last().is_some_and(|diagnostic| diagnostic.primary.span.start >= last.start);
            if !reported {
                let text = self.slice(last);
                self.report(
                    Diagnostic::new(Code::DeclarationSyntax, self.span(last), format!("`;` is missing after `{text}`"))
                        .label("the declaration ends here")
                        .help("end each declaration with `;`"),
                );
            }
        }
        self.push_here(Tok::End);
    }

    /// A type, up to its end.
    pub(super) fn type_tokens(&mut self) {
        self.type_at_depth(0);
    }

    fn type_at_depth(&mut self, depth: usize) {
        let mut wrappers = 0;
        while let Some(token) = self.peek() {
            match (token.kind, token.keyword) {
                (_, Some(Keyword::Array)) => {
                    wrappers += 1;
                    if depth + wrappers > NESTING_MAX {
                        return self.too_deep_type(token);
                    }
                    self.take(Tok::Array);
                    if self.is_at(RawKind::LeftBracket) {
                        self.brackets();
                    }
                    if self.keyword_at(self.at) != Some(Keyword::Of) {
                        return;
                    }
                    self.take(Tok::Of);
                }
                (_, Some(Keyword::RefTo)) => {
                    wrappers += 1;
                    if depth + wrappers > NESTING_MAX {
                        return self.too_deep_type(token);
                    }
                    self.take(Tok::RefTo);
                }
                (_, Some(Keyword::String | Keyword::Wstring)) => {
                    let wide = token.keyword == Some(Keyword::Wstring);
                    self.take(if wide { Tok::WideStringType } else { Tok::StringType });
                    if self.is_at(RawKind::LeftBracket) {
                        self.brackets();
                    }
                    return;
                }
                (_, Some(Keyword::Struct)) => return self.structure(token, depth + wrappers + 1),
                (RawKind::Word | RawKind::Quoted | RawKind::Local, _) => return self.type_name(),
                _ => return,
            }
        }
    }

    /// The type of the result in a name that is not closed, `"Level : Int`, if it is one word.
    pub(super) fn result_in_name(&mut self, name: RawToken, ty: &'a str) {
        if ty.is_empty() || !ty.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_') {
            return;
        }
        let end = name.start as usize + self.slice(name).trim_end().len();
        let start = end - ty.len();
        let tok = match ty {
            _ if ty.eq_ignore_ascii_case("STRING") => Tok::StringType,
            _ if ty.eq_ignore_ascii_case("WSTRING") => Tok::WideStringType,
            _ => Tok::Name(ty),
        };
        self.push(start, Tok::Colon, start);
        self.push(start, tok, end);
    }

    /// `INT`, `"Motor"`, `FB 10`, `_.TankUdt`.
    fn type_name(&mut self) {
        let first = self.raw[self.at];
        if first.keyword.is_some_and(|word| word.ends_expression()) {
            return;
        }
        if first.kind == RawKind::Word && self.numbered_block() {
            return;
        }
        self.declared_name(first);
        while self.is_at(RawKind::Dot)
            && let Some(next) = self.raw.get(self.at + 1).copied()
            && matches!(next.kind, RawKind::Word | RawKind::Quoted)
        {
            self.take(Tok::Dot);
            self.declared_name(next);
        }
    }

    /// `[…]` of an array or text.
    fn brackets(&mut self) {
        let opening = self.raw[self.at];
        self.take(Tok::LeftBracket);
        self.run(Run::Bound);
        if self.is_at(RawKind::RightBracket) {
            return self.take(Tok::RightBracket);
        }
        if self.is_at(RawKind::RightParen) {
            self.at += 1;
        }
        self.report(
            Diagnostic::new(Code::DeclarationSyntax, self.span(opening), "`[` is not closed")
                .label("opened here")
                .help("write `]` after the bounds"),
        );
        self.push_here(Tok::RightBracket);
    }

    fn structure(&mut self, opening: RawToken, depth: usize) {
        if depth > NESTING_MAX {
            return self.too_deep_type(opening);
        }
        self.take(Tok::Struct);
        self.declarations(depth);
        if self.keyword_at(self.at) == Some(Keyword::EndStruct) {
            return self.take(Tok::EndStruct);
        }
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(opening), "`STRUCT` is not closed with `END_STRUCT`")
                .label("the structure begins here")
                .help("write `END_STRUCT;` after its last component"),
        );
        self.push_here(Tok::EndStruct);
    }

    /// Reading the rest of the section makes no sense.
    fn too_deep_type(&mut self, token: RawToken) {
        self.report(
            Diagnostic::new(Code::DeclarationSyntax, self.span(token), "types are nested too deeply")
                .label(format!("inside {NESTING_MAX} others"))
                .help("declare a separate data type (UDT) for a part of it"),
        );
        while let Some(token) = self.peek() {
            if token.keyword.is_some_and(|word| word.ends_section() || word.ends_block() || word == Keyword::Begin) {
                return;
            }
            self.at += 1;
        }
    }

    /// `a.b[3] := 5;` after BEGIN of a data block.
    pub(super) fn values(&mut self) {
        while let Some(token) = self.peek() {
            self.file_pragmas(token.start);
            if token.keyword.is_some_and(|word| word.ends_block()) || self.block_begins(self.at) {
                return;
            }
            if token.kind == RawKind::Semicolon {
                self.at += 1;
                continue;
            }
            let before = self.at;
            if token.kind == RawKind::Word {
                self.declared_name(token);
            }
            self.run(Run::Value);
            if self.at == before {
                self.at += 1;
                continue;
            }
            if self.is_at(RawKind::Semicolon) {
                self.take(Tok::End);
            } else {
                self.end_of_declaration();
            }
        }
    }
}
