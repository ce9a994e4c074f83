//! Classifies the words of code: where statements begin and end, labels, mnemonics, calls, networks.
//!
//! A line end ends a statement unless the statement is incomplete or the next line begins with `(`; `;` always ends it.
//! Source: decision 0001.

use plcc_diag::{Code, Diagnostic};

use super::{Classifier, is_end_of_block};
use crate::front::pragma::is_for_file;
use crate::scl::keyword::is_statement_word;
use crate::stl::mnemonics::{instruction, other};
use crate::stl::raw::{RawKind, RawToken};
use crate::stl::token::Tok;
use crate::stl::{OperandClass, StlInsn};

impl<'a> Classifier<'a, '_> {
    /// Statements up to the end of the block, another block, or the end of the file.
    pub(super) fn code(&mut self) {
        loop {
            self.code_pragmas();
            let Some(token) = self.peek() else { break };
            match token.kind {
                RawKind::Semicolon if matches!(self.last(), Some(Tok::Label(_))) => self.take(Tok::End),
                RawKind::Semicolon => self.at += 1,
                RawKind::Title => self.code_title(),
                RawKind::Word => {
                    let upper = self.upper(self.at);
                    let word = upper.as_str();
                    if word == "TITLE" && matches!(self.last(), Some(Tok::Network | Tok::Begin)) {
                        self.title();
                    } else if word == "TITLE"
                        && matches!(self.last(), Some(Tok::Title(_)))
                        && !self.begins_statement(self.at + 2)
                    {
                        self.code_title();
                    } else if self.kind_at(self.at + 1) == Some(RawKind::Colon) {
                        self.label();
                    } else if is_end_of_block(word) || self.block_keyword(self.at).is_some() {
                        break;
                    } else if word == "NETWORK" || word == "NETZWERK" {
                        self.network();
                    } else if word == "CALL" {
                        self.call();
                    } else if is_statement_word(word) && !matches!(word, "GOTO" | "RETURN") || self.assigns_path() {
                        self.foreign();
                    } else if let Some((insn, count)) = self.mnemonic() {
                        self.instruction(insn, count);
                    } else {
                        self.no_instruction(token);
                    }
                }
                _ if self.assigns_path() => self.foreign(),
                _ => match self.mnemonic() {
                    Some((insn, count)) => self.instruction(insn, count),
                    None => self.no_instruction(token),
                },
            }
        }
        self.end_of_label();
    }

    /// A label without an instruction is a separate statement.
    pub(super) fn end_of_label(&mut self) {
        if matches!(self.last(), Some(Tok::Label(_))) {
            let end = self.last_end();
            self.push(end, Tok::End, end);
        }
    }

    /// `//@` lines before the current raw token.
    pub(super) fn code_pragmas(&mut self) {
        let before = self.peek().map_or(u32::MAX, |token| token.start);
        while let Some(comment) = self.next_pragma(before) {
            let pragma = self.read_pragma(comment);
            if is_for_file(&pragma) {
                self.pragmas.push(pragma);
                continue;
            }
            self.end_of_label();
            self.push(comment.start as usize, Tok::Pragma(Box::new(pragma)), comment.end as usize);
        }
    }

    pub(super) fn label(&mut self) {
        self.end_of_label();
        let (name, after) = (self.slice(self.raw[self.at]), self.at + 2);
        self.take_up_to(Tok::Label(name), after);
    }

    /// `TITLE =` after NETWORK or BEGIN; elsewhere it is reported.
    pub(super) fn code_title(&mut self) {
        match self.out.last() {
            Some((_, Tok::Network | Tok::Begin | Tok::ImpliedOb, _)) => {
                self.title();
            }
            Some(&(start, Tok::Title(_), end)) => {
                let first = self.span_of(start, end);
                let message = self.second_title("network", first);
                self.report(message);
            }
            _ => {
                let token = self.raw[self.at];
                self.report(
                    Diagnostic::new(
                        Code::Syntax,
                        self.span(token),
                        "a title must follow `NETWORK`, before its statements",
                    )
                    .label("no network begins here")
                    .help("write `NETWORK` on a line before it"),
                );
                self.end_of_label();
                self.take(Tok::BadStatement);
                self.end_statement();
            }
        }
    }

    /// `NETWORK`; listings have a number and a title on the same line.
    pub(super) fn network(&mut self) {
        self.end_of_label();
        self.take(Tok::Network);
        if self.same_line(RawKind::Number) {
            self.at += 1;
            if self.same_line(RawKind::Colon) {
                let colon = self.raw[self.at];
                self.at += 1;
                let first = self.at;
                while self.peek().is_some_and(|token| !token.first_on_line) {
                    self.at += 1;
                }
                if self.at > first {
                    let (start, end) = (self.raw[first].start as usize, self.last_end());
                    let title = &self.text[start..end];
                    self.push(colon.start as usize, Tok::Title(title), end);
                }
            }
        }
    }

    pub(super) fn same_line(&self, kind: RawKind) -> bool {
        self.peek().is_some_and(|token| !token.first_on_line && token.kind == kind)
    }

    /// The instruction that begins at the current token, and the number of raw tokens in its mnemonic.
    pub(super) fn mnemonic(&self) -> Option<(StlInsn, usize)> {
        self.mnemonic_at(self.at)
    }

    pub(super) fn mnemonic_at(&self, index: usize) -> Option<(StlInsn, usize)> {
        let token = self.raw_at(index)?;
        let next = self.raw_at(index + 1).filter(|next| !next.first_on_line);
        let upper = self.upper(index);
        let word = upper.as_str();
        let next_word = self.upper(index + 1);
        let next_word = if next.is_some() { next_word.as_str() } else { "" };
        match token.kind {
            RawKind::Word => {
                let nest = next.is_some_and(|next| next.kind == RawKind::LeftParen);
                if nest && let Some(insn) = self.lookup(&format!("{word}(")) {
                    return Some((insn, 2));
                }
                if word == "RND"
                    && self.adjacent(index)
                    && let Some(kind @ (RawKind::Plus | RawKind::Minus)) = self.kind_at(index + 1)
                {
                    let insn = if kind == RawKind::Plus { StlInsn::RoundUp } else { StlInsn::RoundDown };
                    return Some((insn, 2));
                }
                self.lookup(word).map(|insn| (insn, 1))
            }
            RawKind::RightParen if next_word == "MCR" && self.adjacent(index) => Some((StlInsn::McrClose, 2)),
            RawKind::RightParen => Some((StlInsn::CloseNest, 1)),
            RawKind::Equal => Some((StlInsn::Assign, 1)),
            RawKind::Plus
            | RawKind::Minus
            | RawKind::Star
            | RawKind::Slash
            | RawKind::EqualEqual
            | RawKind::NotEqual
            | RawKind::Greater
            | RawKind::Less
            | RawKind::GreaterEqual
            | RawKind::LessEqual => {
                if matches!(next_word, "I" | "D" | "R" | "AR1" | "AR2")
                    && let Some(insn) = instruction(&format!("{}{next_word}", self.slice(token)), self.set)
                {
                    return Some((insn, 2));
                }
                (token.kind == RawKind::Plus).then_some((StlInsn::AddConst, 1))
            }
            _ => None,
        }
    }

    pub(super) fn lookup(&self, word: &str) -> Option<StlInsn> {
        instruction(word, self.set).or_else(|| if self.mixed { instruction(word, other(self.set)) } else { None })
    }

    /// A mnemonic of `count` raw tokens, and its operand.
    pub(super) fn instruction(&mut self, insn: StlInsn, count: usize) {
        let start = self.raw[self.at].start as usize;
        let end = self.raw[self.at + count - 1].end as usize;
        self.at += count;
        let class = insn.operand();
        if class == OperandClass::Label {
            self.push(start, Tok::Jump(insn), end);
            if let Some(token) = self.peek()
                && token.kind == RawKind::Word
                && (!token.first_on_line || !self.begins_statement(self.at))
                && !self.ends_code(self.at)
            {
                match self.label_with_sign(self.at).filter(|(_, after)| self.ends_before(*after)) {
                    Some((name, after)) => self.take_up_to(Tok::Target(name), after),
                    None => {
                        let name = self.slice(token);
                        self.take(Tok::Target(name));
                    }
                }
            } else if let Some((token, rest)) = self.peek().zip(self.raw_at(self.at + 1))
                && (token.kind, rest.kind) == (RawKind::Number, RawKind::Word)
                && !token.first_on_line
                && token.end == rest.start
            {
                // `JU 1end`: such a label is reported where it stands.
                let name = &self.text[token.start as usize..rest.end as usize];
                let after = self.at + 2;
                self.take_up_to(Tok::Target(name), after);
            } else if let Some(token) = self.peek()
                && token.kind == RawKind::Number
                && !token.first_on_line
                && self.is_number_label(self.slice(token))
            {
                let name = self.slice(token);
                self.take(Tok::Target(name));
            }
        } else {
            self.push(start, Tok::Insn(insn), end);
        }
        if self.nested_operands(insn, start) {
            return self.end_statement();
        }
        self.operands(class);
        self.end_statement();
    }

    /// Operand tokens up to the end of the statement.
    pub(super) fn operands(&mut self, class: OperandClass) {
        // The label has been consumed, so a line that begins with `+ 5` is a separate statement.
        let required = class != OperandClass::Label && !class.may_be_missing();
        let first = self.out.len();
        let mut open_brackets = 0usize;
        while let Some(token) = self.peek() {
            let after_operand =
                self.out.len() > first && !matches!(self.last(), Some(Tok::Dot | Tok::LeftBracket | Tok::Comma));
            let continues = open_brackets > 0 || required && self.out.len() == first;
            if token.kind == RawKind::Semicolon
                || self.ends_code(self.at)
                || token.first_on_line && (!continues || self.begins_statement(self.at))
            {
                return;
            }
            match token.kind {
                RawKind::LeftBrace
                    if after_operand && self.out[first - 1].1 == Tok::Insn(StlInsn::CallUnconditional) =>
                {
                    return self.pointer_list(first - 1);
                }
                RawKind::LeftParen
                    if after_operand
                        && matches!(
                            self.out[first - 1].1,
                            Tok::Insn(StlInsn::CallUnconditional | StlInsn::CallConditional)
                        ) =>
                {
                    return self.parameters_without_call(first - 1);
                }
                RawKind::LeftParen if after_operand && self.index_in_parentheses(token, self.out[first].0) => continue,
                RawKind::LeftParen if self.operand_in_parentheses(token, first) => return,
                RawKind::LeftBracket => open_brackets += 1,
                RawKind::RightBracket => open_brackets = open_brackets.saturating_sub(1),
                RawKind::Word | RawKind::Equal | RawKind::RightParen
                    if (after_operand || class == OperandClass::None) && self.begins_statement(self.at) =>
                {
                    return self.second_statement(token);
                }
                _ => {}
            }
            self.operand_token();
        }
    }

    /// `UC SFC 65097 { P#L 210.1, P#L 211.0 }`: how STEP 7 writes a call of a block with an unknown interface. It is a `CALL` with parameters that
    /// have no names, in the order of the interface. `insn`: the token of the instruction.
    pub(super) fn pointer_list(&mut self, insn: usize) {
        self.out[insn].1 = Tok::Call;
        let opening = self.raw[self.at];
        self.take(Tok::LeftParen);
        while let Some(token) = self.peek() {
            match token.kind {
                RawKind::RightBrace => return self.take(Tok::RightParen),
                RawKind::Comma => self.take(Tok::Comma),
                RawKind::Semicolon => break,
                _ if self.ends_code(self.at) || token.first_on_line && self.begins_statement(self.at) => break,
                _ => {
                    if matches!(self.last(), Some(Tok::LeftParen | Tok::Comma)) {
                        let start = token.start as usize;
                        self.push(start, Tok::Name(""), start);
                        self.push(start, Tok::Assign, start);
                    }
                    self.operand_token();
                }
            }
        }
        self.report(
            Diagnostic::new(Code::Syntax, self.span(opening), "the list of pointers is not closed with `}`")
                .label("begins here")
                .help("write `}` after the last pointer"),
        );
        let end = self.last_end();
        self.push(end, Tok::RightParen, end);
    }

    /// `UC FC 5 (a := 3)`, where only CALL passes parameters. `insn`: the token of the instruction.
    fn parameters_without_call(&mut self, insn: usize) {
        let (start, end) = (self.out[insn].0, self.last_end());
        let opening = self.raw[self.at];
        let word = &self.text[start..self.out[insn].2];
        let block = self.text[self.out[insn].2..end].trim();
        self.report(
            Diagnostic::new(Code::Syntax, self.span(opening), format!("`{word}` passes no parameters"))
                .label("begins here")
                .help(format!("write `CALL {block} (…)`; for a condition jump past it")),
        );
        // What the block makes of its parameters would be a second message.
        self.out.truncate(insn);
        self.push(start, Tok::BadStatement, end);
        let mut depth = 0usize;
        while let Some(token) = self.peek() {
            match token.kind {
                RawKind::LeftParen => depth += 1,
                RawKind::RightParen => depth = depth.saturating_sub(1),
                RawKind::Semicolon => return,
                _ if self.ends_code(self.at) || token.first_on_line && self.begins_statement(self.at) => return,
                _ => {}
            }
            self.at += 1;
            if depth == 0 {
                return;
            }
        }
    }

    /// Another statement begins on the line without `;` before it.
    pub(super) fn second_statement(&mut self, token: RawToken) {
        let word = self.slice(token);
        let before = self.at.checked_sub(1).and_then(|before| self.raw_at(before));
        if let Some(number) = before.filter(|number| number.kind == RawKind::Number && number.end == token.start)
            && word.eq_ignore_ascii_case("O")
        {
            let span = self.span_of(number.start as usize, token.end as usize);
            let digits = self.slice(number);
            self.report(
                Diagnostic::new(Code::Syntax, span, format!("`{digits}{word}` is not a number"))
                    .label("the letter O")
                    .help(format!("write the digit 0 in place of the letter O: `{digits}0`")),
            );
            return;
        }
        // `))` with one `)` too many is told when parentheses are counted.
        if word == ")" && before.is_some_and(|before| before.kind == RawKind::RightParen) && !self.is_nested() {
            return;
        }
        self.report(
            Diagnostic::new(Code::Syntax, self.span(token), format!("`;` is missing before `{word}`"))
                .label("another statement begins here")
                .help("end each statement with `;` or with its line"),
        );
    }

    /// Whether a parenthesis of the block is open, as far as the last tokens show.
    fn is_nested(&self) -> bool {
        const LOOK_MAX: usize = 2000;
        let last = self.out.iter().rev().take(LOOK_MAX);
        let block = last.take_while(|(_, token, _)| !matches!(token, Tok::Begin | Tok::ImpliedOb));
        let open = block.fold(0i64, |open, (_, token, _)| match token {
            Tok::Insn(StlInsn::CloseNest) => open - 1,
            Tok::Insn(insn) if insn.opens_nesting() => open + 1,
            _ => open,
        });
        open > 0
    }

    /// Whether a statement begins at `index`: a label, a mnemonic with what can follow it, or CALL.
    pub(super) fn begins_statement(&self, index: usize) -> bool {
        if matches!(self.last(), Some(Tok::Dot)) {
            return false;
        }
        match self.kind_at(index) {
            // `5s` is meant as a time, `0xFF` and `1F` as numbers.
            Some(RawKind::Word)
                if index > 0
                    && self.kind_at(index - 1) == Some(RawKind::Number)
                    && self.adjacent(index - 1)
                    && self.belongs_to_number(index) =>
            {
                false
            }
            Some(RawKind::Word) => {
                let next = self.kind_at(index + 1);
                if next == Some(RawKind::Colon) {
                    return true;
                }
                // No statement begins with `O.0`: a letter for the digit 0.
                if next == Some(RawKind::Assign) || next == Some(RawKind::Dot) && self.adjacent(index) {
                    return false;
                }
                self.upper(index).as_str() == "CALL" || self.mnemonic_at(index).is_some()
            }
            Some(RawKind::RightParen | RawKind::Equal) => true,
            Some(_) if !self.is_literal(index) => self.mnemonic_at(index).is_some(),
            _ => false,
        }
    }

    /// Whether the word at `index`, directly after a number, is meant as a part of it.
    fn belongs_to_number(&self, index: usize) -> bool {
        let upper = self.upper(index);
        let word = upper.as_str();
        let is_hexadecimal = |digits: &str| digits.bytes().all(|digit| digit.is_ascii_hexdigit());
        let is_binary = |digits: &str| digits.bytes().all(|digit| matches!(digit, b'0' | b'1'));
        let of_base = self.slice(self.raw[index - 1]) == "0"
            && (word.strip_prefix('X').is_some_and(is_hexadecimal) || word.strip_prefix('B').is_some_and(is_binary));
        let is_unit = ["MS", "S", "M", "H", "D"].contains(&word);
        of_base || is_unit || !word.is_empty() && is_hexadecimal(word) && self.ends_before(index + 1)
    }

    /// Whether the word at `index` ends the code or begins a network.
    pub(super) fn ends_code(&self, index: usize) -> bool {
        let upper = self.upper(index);
        let word = upper.as_str();
        let first_on_line = self.raw_at(index).is_some_and(|token| token.first_on_line);
        if word.is_empty() || matches!(self.last(), Some(Tok::Dot)) {
            return false;
        }
        is_end_of_block(word)
            || word == "NETWORK" && self.kind_at(index + 1) != Some(RawKind::Assign)
            || first_on_line && self.block_keyword(index).is_some()
    }

    pub(super) fn end_statement(&mut self) {
        if self.peek().is_some_and(|token| token.kind == RawKind::Semicolon) {
            return self.take(Tok::End);
        }
        let end = self.last_end();
        self.push(end, Tok::End, end);
    }

    /// Skips to the end of a statement that has been reported.
    pub(super) fn bad_statement(&mut self) {
        let start = self.raw[self.at].start as usize;
        self.at += 1;
        while let Some(token) = self.peek() {
            if token.kind == RawKind::Semicolon || token.first_on_line || self.ends_code(self.at) {
                break;
            }
            self.at += 1;
        }
        let end = self.last_end();
        self.push(start, Tok::BadStatement, end);
        self.end_statement();
    }
}
