//! Classifies the words of declarations (`VAR … END_VAR`, `STRUCT … END_STRUCT`).

use plcc_diag::{Code, Diagnostic};

use super::{ARRAY_DEPTH_MAX, BRACKET_DEPTH_MAX, Classifier, STRUCT_DEPTH_MAX, is_end_of_block, is_section, unquoted};
use crate::ast::SectionKind;
use crate::elementary::Elementary;
use crate::front::frame;
use crate::stl::raw::{RawKind, RawToken};
use crate::stl::token::{CodeKeyword, Tok};

impl<'a> Classifier<'a, '_> {
    /// `VAR_INPUT … END_VAR`.
    pub(super) fn section(&mut self) {
        let opening = self.raw[self.at];
        let kind = match self.upper(self.at).as_str() {
            "VAR_INPUT" => SectionKind::Input,
            "VAR_OUTPUT" => SectionKind::Output,
            "VAR_IN_OUT" => SectionKind::InOut,
            "VAR_TEMP" => SectionKind::Temp,
            _ => SectionKind::Static,
        };
        // `VAR RETAIN`, `VAR NON_RETAIN`, `VAR DB_SPECIFIC` and `VAR CONSTANT` of newer tools, but not a variable of this name.
        let upper = self.upper(self.at + 1);
        let is_name = matches!(self.kind_at(self.at + 2), Some(RawKind::Colon | RawKind::Comma | RawKind::LeftBrace));
        let modifier = if is_name { "" } else { upper.as_str() };
        let constants = modifier == "CONSTANT" && kind == SectionKind::Static;
        self.take(if constants { Tok::Constants } else { Tok::Section(kind) });
        if constants || matches!(modifier, "RETAIN" | "NON_RETAIN" | "DB_SPECIFIC") {
            self.at += 1;
        }
        self.declarations(0);
        if self.upper(self.at).as_str() == "END_VAR" {
            self.take(Tok::EndVar);
            if self.kind_at(self.at) == Some(RawKind::Semicolon) {
                self.at += 1;
            }
            return;
        }
        let keyword = self.slice(opening);
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(opening), format!("`{keyword}` is not closed with `END_VAR`"))
                .label("the declarations begin here")
                .help("write `END_VAR` after the last declaration"),
        );
        let end = self.last_end();
        self.push(end, Tok::EndVar, end);
    }

    /// Whether declarations up to END_VAR follow, before which no section begins.
    pub(super) fn declarations_without_section(&self) -> bool {
        const SECTION_MAX: usize = 10_000;
        if !matches!(self.kind_at(self.at + 1), Some(RawKind::Colon | RawKind::Comma)) {
            return false;
        }
        let ends =
            |word: &str| is_section(word) || is_end_of_block(word) || matches!(word, "END_VAR" | "BEGIN" | "NETWORK");
        let mut words = (self.at..self.raw.len()).take(SECTION_MAX).map(|index| self.upper(index));
        words.find(|word| ends(word.as_str())).is_some_and(|word| word.as_str() == "END_VAR")
    }

    /// `speed : INT; … END_VAR` without its first word, which is reported.
    pub(super) fn section_without_keyword(&mut self, first: RawToken) {
        let block = self.out.iter().rev().find_map(|(_, token, _)| match token {
            Tok::Code(keyword) => Some(*keyword),
            _ => None,
        });
        let (kind, word) = match block {
            Some(CodeKeyword::FunctionBlock) => (SectionKind::Static, "VAR"),
            Some(CodeKeyword::Function | CodeKeyword::OrganizationBlock) | None => (SectionKind::Temp, "VAR_TEMP"),
        };
        self.report(frame::no_section(self.span(first), word));
        let start = first.start as usize;
        self.push(start, Tok::Section(kind), start);
        self.declarations(0);
        let end = self.last_end();
        if self.upper(self.at).as_str() == "END_VAR" {
            self.take(Tok::EndVar);
        } else {
            self.push(end, Tok::EndVar, end);
        }
        if self.kind_at(self.at) == Some(RawKind::Semicolon) {
            self.at += 1;
        }
    }

    /// `STRUCT … END_STRUCT` of a data block or data type.
    pub(super) fn top_struct(&mut self) {
        let opening = self.raw[self.at];
        self.take(Tok::Struct);
        self.declarations(1);
        if !matches!(self.last(), Some(Tok::EndStruct)) {
            self.struct_not_closed(opening);
        }
        if self.kind_at(self.at) == Some(RawKind::Semicolon) {
            self.at += 1;
        }
    }

    /// Components of a data block or data type without STRUCT before them; END_STRUCT may be missing too.
    pub(super) fn struct_not_opened(&mut self, first: RawToken) {
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(first), "`STRUCT` is missing before the components")
                .label("the first component")
                .help("write `STRUCT` on a line before it, and `END_STRUCT;` after the last component"),
        );
        let start = first.start as usize;
        self.push(start, Tok::Struct, start);
        self.declarations(1);
        if !matches!(self.last(), Some(Tok::EndStruct)) {
            let end = self.last_end();
            self.push(end, Tok::EndStruct, end);
        }
        if self.kind_at(self.at) == Some(RawKind::Semicolon) {
            self.at += 1;
        }
    }

    fn struct_not_closed(&mut self, opening: RawToken) {
        self.report(
            Diagnostic::new(Code::BlockFrame, self.span(opening), "`STRUCT` is not closed with `END_STRUCT`")
                .label("begins here")
                .help("write `END_STRUCT;` after its last component"),
        );
        let end = self.last_end();
        self.push(end, Tok::EndStruct, end);
    }

    /// Declarations up to `END_VAR`, or with `depth` 1 to the `END_STRUCT` that closes it, or to a token that is not allowed inside.
    ///
    /// The result has balanced STRUCTs and a `;` after each declaration.
    fn declarations(&mut self, depth: usize) {
        let base = depth;
        let mut open: Vec<RawToken> = Vec::new();
        let mut brackets = 0usize;
        let mut arrays = 0usize;
        while let Some(token) = self.peek() {
            self.file_pragmas(token.start);
            let upper = self.upper(self.at);
            let word = upper.as_str();
            let next = self.kind_at(self.at + 1);
            let at_start = matches!(self.last(), Some(Tok::Semicolon | Tok::Struct | Tok::Section(_) | Tok::Constants));
            match token.kind {
                RawKind::Word if self.ends_declarations(word) => break,
                RawKind::Word | RawKind::Number if at_start && token.first_on_line && self.name_of_parts() => {}
                RawKind::Word if word == "END_STRUCT" => {
                    self.close_declaration();
                    brackets = 0;
                    if open.pop().is_none() {
                        if base == 1 {
                            return self.take(Tok::EndStruct);
                        }
                        self.report(
                            Diagnostic::new(Code::BlockFrame, self.span(token), "`END_STRUCT` without `STRUCT`")
                                .label("no structure is open here")
                                .help("remove it"),
                        );
                        self.at += 1;
                        if next == Some(RawKind::Semicolon) {
                            self.at += 1;
                        }
                        continue;
                    }
                    self.take(Tok::EndStruct);
                    if next != Some(RawKind::Semicolon) {
                        let end = token.end as usize;
                        self.push(end, Tok::Semicolon, end);
                    }
                }
                RawKind::Word if word == "STRUCT" && matches!(self.last(), Some(Tok::Colon | Tok::Of)) => {
                    if open.len() + base >= STRUCT_DEPTH_MAX {
                        self.too_deep("structures");
                        break;
                    }
                    open.push(token);
                    brackets = 0;
                    self.take(Tok::Struct);
                }
                RawKind::Semicolon => {
                    brackets = 0;
                    arrays = 0;
                    if at_start {
                        self.at += 1;
                    } else {
                        self.take(Tok::Semicolon);
                    }
                }
                RawKind::Word if word == "OF" && arrays == ARRAY_DEPTH_MAX => {
                    self.too_deep("arrays");
                    break;
                }
                RawKind::Word | RawKind::Quoted
                    if token.first_on_line
                        && !at_start
                        && next == Some(RawKind::Colon)
                        && !matches!(self.last(), Some(Tok::Comma | Tok::At)) =>
                {
                    self.missing_semicolon("declaration");
                    brackets = 0;
                    self.declaration_word();
                }
                RawKind::LeftBrace => self.attributes(),
                _ => {
                    if !self.bracket_depth(token.kind, &mut brackets) {
                        break;
                    }
                    arrays += usize::from(word == "OF");
                    self.declaration_token();
                }
            }
        }
        self.close_declaration();
        while let Some(opening) = open.pop() {
            self.struct_not_closed(opening);
            let end = self.last_end();
            self.push(end, Tok::Semicolon, end);
        }
    }

    /// `x-y : INT`, `1x : INT`, `motor speed : INT`: takes a name that is not one word, and reports it; `false`: it is something else.
    fn name_of_parts(&mut self) -> bool {
        const PARTS_MAX: usize = 8;
        let mut rest = self.raw.iter().enumerate().skip(self.at).take(PARTS_MAX);
        let ends = |(at, token): &(usize, &RawToken)| {
            let is_part = matches!(token.kind, RawKind::Word | RawKind::Number | RawKind::Minus | RawKind::Dot);
            !is_part || token.first_on_line && *at > self.at
        };
        let Some((after, _)) =
            rest.find(ends).filter(|(_, token)| token.kind == RawKind::Colon && !token.first_on_line)
        else {
            return false;
        };
        let parts = &self.raw[self.at..after];
        if parts.len() < 2 || (self.at..after).any(|at| self.upper(at).as_str() == "AT") {
            return false;
        }
        let words = parts.iter().filter(|part| matches!(part.kind, RawKind::Word | RawKind::Number));
        let mut meant = String::new();
        let mut end = parts[0].start;
        for word in words {
            if !meant.is_empty() && word.start > end {
                meant.push('_');
            }
            meant.push_str(self.slice(*word));
            end = word.end;
        }
        if meant.starts_with(|c: char| c.is_ascii_digit()) {
            meant.insert(0, '_');
        }
        let (start, end) = (parts[0].start as usize, parts[parts.len() - 1].end as usize);
        let text = self.text;
        let name = &text[start..end];
        self.report(
            Diagnostic::new(Code::DeclarationSyntax, self.span_of(start, end), format!("`{name}` is not a name"))
                .label("a name is one word of letters, digits and `_` that begins with no digit")
                .help(format!("write `{meant}`")),
        );
        self.push(start, Tok::Name(name), end);
        self.at = after;
        true
    }

    /// Whether the current word (upper case) ends all declarations: `END_VAR`, or a keyword that no declaration contains.
    fn ends_declarations(&self, word: &str) -> bool {
        if word == "END_VAR" || is_end_of_block(word) {
            return true;
        }
        let next = self.kind_at(self.at + 1);
        let declared = matches!(next, Some(RawKind::Colon | RawKind::Comma | RawKind::LeftBrace));
        !declared && (is_section(word) || matches!(word, "BEGIN" | "NETWORK") || self.block_keyword(self.at).is_some())
    }

    /// Reports a missing `;` of the last declaration.
    fn close_declaration(&mut self) {
        let complete = matches!(
            self.last(),
            Some(Tok::Semicolon | Tok::Struct | Tok::Section(_) | Tok::Constants | Tok::EndStruct)
        );
        if !complete {
            self.missing_semicolon("declaration");
        }
    }

    pub(super) fn missing_semicolon(&mut self, what: &str) {
        let end = self.last_end();
        let start = self.at.checked_sub(1).map_or(0, |before| self.raw[before].start as usize);
        self.report(
            Diagnostic::new(
                if what == "declaration" { Code::DeclarationSyntax } else { Code::Syntax },
                self.span_of(start, end),
                format!("the {what} does not end with `;`"),
            )
            .label("`;` is missing after this")
            .help(format!("end each {what} with `;`")),
        );
        self.push(end, Tok::Semicolon, end);
    }

    fn too_deep(&mut self, what: &str) {
        let token = self.raw[self.at];
        self.report(
            Diagnostic::new(Code::DeclarationSyntax, self.span(token), format!("{what} are nested too deeply"))
                .label("too many levels")
                .help("STEP 7 allows 8 levels; put inner ones into separate data types"),
        );
        // The text that follows belongs to no known frame.
        while let Some(token) = self.peek() {
            let upper = self.upper(self.at);
            if is_end_of_block(upper.as_str()) || token.first_on_line && self.block_keyword(self.at).is_some() {
                return;
            }
            self.at += 1;
        }
    }

    /// Counts parentheses and brackets; `false`: too deep, reported.
    pub(super) fn bracket_depth(&mut self, kind: RawKind, depth: &mut usize) -> bool {
        match kind {
            RawKind::LeftParen | RawKind::LeftBracket => {
                *depth += 1;
                if *depth > BRACKET_DEPTH_MAX {
                    self.too_deep("parentheses");
                    return false;
                }
            }
            RawKind::RightParen | RawKind::RightBracket => *depth = depth.saturating_sub(1),
            _ => {}
        }
        true
    }

    /// One token of a declaration.
    pub(super) fn declaration_token(&mut self) {
        let token = self.raw[self.at];
        match token.kind {
            _ if self.is_literal(self.at) => self.declared_literal(),
            RawKind::Word => self.declaration_word(),
            RawKind::Quoted => {
                let name = unquoted(self.slice(token));
                // A component of an element may have 64 bits.
                self.may_be_long |= matches!(self.last(), Some(Tok::Of));
                self.take(Tok::Quoted(name));
            }
            RawKind::Hash if self.kind_at(self.at + 1) == Some(RawKind::Word) && self.begins_value() => {
                let after = self.at + 2;
                let name = self.slice(self.raw[after - 1]);
                self.take_up_to(Tok::Local(name), after);
            }
            RawKind::Hash => self.at += 1,
            RawKind::LeftParen if self.begins_structure() => self.take(Tok::Values),
            RawKind::Equal if self.equal_for_colon(token) => {}
            RawKind::Equal => self.equal_for_assign(),
            kind => match sign(kind) {
                Some(tok) => self.take(tok),
                None => {
                    self.stray();
                    if matches!(kind, RawKind::UnterminatedText | RawKind::UnterminatedQuoted) {
                        // The `;` is inside the part that was not closed.
                        let end = self.last_end();
                        self.push(end, Tok::Semicolon, end);
                    }
                }
            },
        }
    }

    /// The last tokens, from the end on: at least those of a type, and of the bounds of an array.
    fn before(&self) -> impl Iterator<Item = &Tok<'a>> {
        const BEFORE_MAX: usize = 64;
        self.out.iter().rev().take(BEFORE_MAX).map(|(_, token, _)| token)
    }

    /// Whether a start value is next, alone or in a list; not a bound of an array.
    fn begins_value(&self) -> bool {
        match self.last() {
            Some(Tok::Assign | Tok::Values | Tok::LeftParen) => true,
            Some(Tok::LeftBracket | Tok::Comma) => {
                let ends = |token: &&Tok<'_>| {
                    matches!(token, Tok::Assign | Tok::Array | Tok::Semicolon | Tok::Section(_) | Tok::Struct)
                };
                self.before().find(ends).is_none_or(|token| matches!(token, Tok::Assign))
            }
            _ => false,
        }
    }

    /// Whether `(` begins the values of a structure: it is the start value of a variable that is not an array, or inside such a value.
    fn begins_structure(&self) -> bool {
        match self.last() {
            // A parenthesis in a parenthesis is `2((5, TRUE))`.
            Some(Tok::Values | Tok::LeftBracket | Tok::LeftParen | Tok::Comma) => true,
            Some(Tok::Assign) => {
                let ends = |token: &&Tok<'_>| matches!(token, Tok::Colon | Tok::Semicolon | Tok::Array | Tok::Assign);
                self.before().skip(1).find(ends).is_some_and(|token| matches!(token, Tok::Colon))
            }
            _ => false,
        }
    }

    /// A word of a declaration: a type after `:` and `OF`, a value after `:=`, otherwise a name.
    fn declaration_word(&mut self) {
        let token = self.raw[self.at];
        if matches!(self.last(), Some(Tok::Colon | Tok::Of)) {
            return self.type_name();
        }
        let upper = self.upper(self.at);
        let name = self.slice(token);
        let in_value =
            matches!(self.last(), Some(Tok::Assign | Tok::Comma | Tok::LeftParen | Tok::LeftBracket | Tok::Values));
        match upper.as_str() {
            "OF" if matches!(self.last(), Some(Tok::RightBracket)) => self.take(Tok::Of),
            "AT" if matches!(self.last(), Some(Tok::Name(_) | Tok::RightBrace | Tok::Quoted(_)))
                && matches!(self.kind_at(self.at + 1), Some(RawKind::Word | RawKind::Quoted | RawKind::Hash)) =>
            {
                self.take(Tok::At);
            }
            "TRUE" | "FALSE" if in_value => {
                let tok = self.literal_token(name, self.span(token));
                self.take(tok);
            }
            _ => self.take(Tok::Name(name)),
        }
    }

    /// A data type: `INT`, `UDT 5`, `"Motor"`, `ARRAY`, `STRING`, `STRUCT`.
    pub(super) fn type_name(&mut self) {
        let Some(token) = self.peek() else { return };
        self.may_be_long = false;
        match token.kind {
            RawKind::Quoted => {
                let name = unquoted(self.slice(token));
                // A component may have 64 bits.
                self.may_be_long = true;
                self.take(Tok::Quoted(name));
            }
            RawKind::Word => match self.upper(self.at).as_str() {
                "ARRAY" => self.take(Tok::Array),
                "STRING" => self.take(Tok::StringType),
                "WSTRING" => self.take(Tok::WideStringType),
                "STRUCT" => self.take(Tok::Struct),
                _ => {
                    if !self.numbered_block() {
                        let name = self.slice(token);
                        let ty = Elementary::from_word(&name.to_ascii_uppercase());
                        self.may_be_long = ty.is_some_and(|ty| ty.bits() == 64);
                        self.take(Tok::Name(name));
                    }
                }
            },
            _ => {}
        }
    }

    /// Reports `=` between a name and its data type and reads it as `:`; false: it is something else.
    fn equal_for_colon(&mut self, token: RawToken) -> bool {
        let [.., (_, before, _), (start, Tok::Name(name), _)] = self.out.as_slice() else { return false };
        let is_first = !matches!(before, Tok::Colon | Tok::Of | Tok::Assign);
        let (ty, name, start) = (self.upper(self.at + 1), *name, *start);
        if !is_first || Elementary::from_word(ty.as_str()).is_none() {
            return false;
        }
        let ty = ty.as_str();
        self.report(
            Diagnostic::new(
                Code::DeclarationSyntax,
                self.span_of(start, token.end as usize),
                format!("`:` stands between `{name}` and its type, not `=`"),
            )
            .label("read as `:`")
            .help(format!("write `{name} : {ty}`")),
        );
        self.take(Tok::Colon);
        true
    }

    /// Reports `=` in place of `:=` and reads it as `:=`.
    pub(super) fn equal_for_assign(&mut self) {
        let token = self.raw[self.at];
        self.report(
            Diagnostic::new(Code::AssignSign, self.span(token), "a value is assigned with `:=`, not with `=`")
                .label("`=` is the instruction that writes the RLO")
                .help("write `:=`"),
        );
        self.take(Tok::Assign);
    }
}

/// The grammar's token for a character that means the same everywhere.
pub(super) fn sign(kind: RawKind) -> Option<Tok<'static>> {
    Some(match kind {
        RawKind::Colon => Tok::Colon,
        RawKind::Assign => Tok::Assign,
        RawKind::Comma => Tok::Comma,
        RawKind::Dot => Tok::Dot,
        RawKind::DotDot => Tok::DotDot,
        RawKind::LeftParen => Tok::LeftParen,
        RawKind::RightParen => Tok::RightParen,
        RawKind::LeftBracket => Tok::LeftBracket,
        RawKind::RightBracket => Tok::RightBracket,
        RawKind::LeftBrace => Tok::LeftBrace,
        RawKind::RightBrace => Tok::RightBrace,
        _ => return None,
    })
}
