//! Classifies the words of calls: the block, its template attributes, and parameters in parentheses or on lines of their own.

use plcc_diag::{Code, Diagnostic};

use super::{Classifier, unquoted};
use crate::stl::OperandClass;
use crate::stl::mnemonics::letters_and_digits;
use crate::stl::raw::{RawKind, RawToken};
use crate::stl::token::Tok;

impl Classifier<'_, '_> {
    pub(super) fn call(&mut self) {
        self.take(Tok::Call);
        while let Some(token) = self.peek() {
            let after_operand = !matches!(self.last(), Some(Tok::Call | Tok::Comma | Tok::Dot | Tok::LeftBracket));
            match token.kind {
                RawKind::Semicolon => break,
                RawKind::LeftParen => {
                    self.parameters();
                    self.after_call();
                    break;
                }
                RawKind::LeftBrace if after_operand => self.call_template(),
                RawKind::Comma => self.take(Tok::Comma),
                _ if self.ends_code(self.at) => break,
                _ if after_operand && self.is_parameter(self.at) => {
                    self.parameter_lines();
                    break;
                }
                _ if token.first_on_line && (after_operand || self.begins_statement(self.at)) => break,
                RawKind::Word if after_operand && self.begins_statement(self.at) => {
                    self.second_statement(token);
                    break;
                }
                _ => {
                    self.comma_before_instance(token);
                    self.operand_token();
                }
            }
        }
        self.end_statement();
    }

    /// `CALL FB 10 DB 10`, `CALL "Motor" "Motor_DB"`: adds the comma before the instance.
    fn comma_before_instance(&mut self, token: RawToken) {
        let after_block = matches!(self.last(), Some(Tok::Block(..) | Tok::Quoted(_)));
        let upper = self.upper(self.at);
        let is_block = token.kind == RawKind::Quoted || letters_and_digits(upper.as_str()).0 == "DB";
        if !after_block || !is_block || token.first_on_line {
            return;
        }
        let number = self.raw_at(self.at + 1).filter(|next| next.kind == RawKind::Number && !next.first_on_line);
        let end = number.filter(|_| upper.as_str() == "DB").map_or(token.end, |number| number.end);
        let span = self.span_of(token.start as usize, end as usize);
        let instance = &self.text[span.range()];
        self.report(
            Diagnostic::new(Code::Syntax, span, "`,` is missing before the instance data block")
                .label("the data block of the call")
                .help(format!("write `, {instance}`")),
        );
        let at = token.start as usize;
        self.push(at, Tok::Comma, at);
    }

    /// `{time_type := Time}` of newer tools: the data types for which an instruction or a block of the system is called.
    pub(super) fn call_template(&mut self) {
        let opening = self.raw[self.at];
        while let Some(token) = self.peek() {
            if token.kind == RawKind::Semicolon && !self.closes_brace() || self.ends_code(self.at) {
                break;
            }
            let value = self.kind_at(self.at + 2);
            if matches!(token.kind, RawKind::Word | RawKind::Quoted)
                && self.kind_at(self.at + 1) == Some(RawKind::Assign)
                && matches!(value, Some(RawKind::Word | RawKind::Quoted | RawKind::Text))
            {
                let (name, after) = (unquoted(self.slice(token)), self.at + 3);
                let ty = self.slice(self.raw[self.at + 2]).trim_matches(['\'', '"']);
                self.take_up_to(Tok::CallType(name, ty), after);
                continue;
            }
            self.at += 1;
            if token.kind == RawKind::RightBrace {
                return;
            }
        }
        self.report(
            Diagnostic::new(Code::Syntax, self.span(opening), "the attribute list is not closed")
                .label("begins here")
                .help("close it with `}`"),
        );
    }

    /// Whether a `}` follows on this line.
    pub(super) fn closes_brace(&self) -> bool {
        self.raw[self.at + 1..]
            .iter()
            .take_while(|token| !token.first_on_line)
            .any(|token| token.kind == RawKind::RightBrace)
    }

    /// The rest of the line after the `)` of a call.
    pub(super) fn after_call(&mut self) {
        if let Some(token) = self.peek()
            && !token.first_on_line
            && token.kind != RawKind::Semicolon
            && !self.ends_code(self.at)
        {
            self.second_statement(token);
        }
    }

    /// Whether `name :=` is at `index`, or `name =` where it cannot be an instruction.
    pub(super) fn is_parameter(&self, index: usize) -> bool {
        match (self.kind_at(index), self.kind_at(index + 1)) {
            (Some(RawKind::Word | RawKind::Quoted), Some(RawKind::Assign)) => true,
            (Some(RawKind::Word), Some(RawKind::Equal)) => {
                let operandless = self
                    .mnemonic_at(index)
                    .is_some_and(|(insn, _)| matches!(insn.operand(), OperandClass::None | OperandClass::BitOrNone));
                let arrow = self.kind_at(index + 2) == Some(RawKind::Greater) && self.adjacent(index + 1);
                (!operandless || arrow) && !self.raw[index + 1].first_on_line
            }
            _ => false,
        }
    }

    /// `name :=`.
    pub(super) fn parameter_name(&mut self) {
        let name = unquoted(self.slice(self.raw[self.at]));
        self.take(Tok::Name(name));
        match (self.kind_at(self.at), self.kind_at(self.at + 1)) {
            (Some(RawKind::Equal), Some(RawKind::Greater)) => self.arrow_for_assign(name),
            (Some(RawKind::Equal), _) => self.equal_for_assign(),
            _ => self.take(Tok::Assign),
        }
    }

    /// `name =>`, as SCL writes outputs.
    fn arrow_for_assign(&mut self, name: &str) {
        let (start, end) = (self.raw[self.at].start as usize, self.raw[self.at + 1].end as usize);
        let span = self.span_of(start, end);
        self.report(
            Diagnostic::new(Code::AssignSign, span, "a call of STL has `:=` for outputs too")
                .label("a form of SCL")
                .help(format!("write `{name} := …`")),
        );
        self.at += 2;
        self.push(start, Tok::Assign, end);
    }

    /// One `name := operand` per line, up to the first line that has another form.
    pub(super) fn parameter_lines(&mut self) {
        let mut is_reported = false;
        let list = self.peek();
        while let Some(first) = self.peek() {
            if !self.is_parameter(self.at) || self.next_pragma(first.start).is_some() {
                return;
            }
            self.push(first.start as usize, Tok::ParameterLine, first.start as usize);
            self.parameter_name();
            while let Some(token) = self.peek() {
                let continues = self.raw_at(self.at + 1).is_some_and(|next| next.kind == RawKind::Word)
                    && self.kind_at(self.at + 2) == Some(RawKind::Assign);
                if token.kind == RawKind::Semicolon && continues {
                    if !is_reported {
                        self.report(
                            Diagnostic::new(
                                Code::Syntax,
                                self.span(token),
                                "`;` ends a call, not each of its parameters",
                            )
                            .label("read as the end of a parameter")
                            .help("write `;` after the last parameter only"),
                        );
                    }
                    is_reported = true;
                    self.at += 1;
                    break;
                }
                if token.kind == RawKind::Semicolon || self.ends_code(self.at) {
                    return;
                }
                if token.first_on_line || self.is_parameter(self.at) {
                    break;
                }
                match token.kind {
                    RawKind::Comma if self.comma_ends_line() => self.at += 1,
                    RawKind::Comma if self.is_parameter(self.at + 1) => {
                        if let Some(list) = list.filter(|_| !is_reported) {
                            self.list_without_parentheses(list, token);
                        }
                        is_reported = true;
                        self.at += 1;
                        break;
                    }
                    _ => self.operand_token(),
                }
            }
        }
    }

    /// `CALL FC 1 a := 5, b := 6`: reports parameters on one line that begin at `list`; `comma` is the first one.
    fn list_without_parentheses(&mut self, list: RawToken, comma: RawToken) {
        let call = self.out.iter().rposition(|(_, token, _)| *token == Tok::Call);
        let start = call.map_or(list.start as usize, |call| self.out[call].0);
        let called = self.text[start..list.start as usize].trim();
        let parameter = self.text[list.start as usize..comma.start as usize].trim();
        self.report(
            Diagnostic::new(Code::Syntax, self.span(comma), "a list of parameters on one line has parentheses")
                .label("read as the end of a parameter")
                .help(format!("write `{called} ({parameter}, …)`, or each parameter on a separate line")),
        );
    }

    /// Whether the current comma is the last token of its line, outside brackets.
    pub(super) fn comma_ends_line(&self) -> bool {
        self.raw_at(self.at + 1).is_none_or(|next| next.first_on_line)
    }

    /// `CALL FC 1 (5, 6)`: values without names, in the order of another language.
    fn values_without_names(&mut self) -> bool {
        const TOKENS_MAX: usize = 400;
        let opening = self.raw[self.at];
        let is_end = |index: &usize| match self.raw_at(*index) {
            Some(token) => match token.kind {
                RawKind::RightParen | RawKind::Semicolon | RawKind::Assign | RawKind::Equal => true,
                _ => token.first_on_line && self.begins_statement(*index),
            },
            None => true,
        };
        let Some(close) = (self.at + 1..).take(TOKENS_MAX).find(is_end) else { return false };
        let call = self.out.iter().rposition(|(_, token, _)| *token == Tok::Call);
        let is_list = close > self.at + 1 && self.kind_at(close) == Some(RawKind::RightParen);
        let Some(call) = call.filter(|_| is_list) else { return false };
        let (start, first) = (self.out[call].0, self.raw[self.at + 1].start as usize);
        let (called, end) = (self.text[start..opening.start as usize].trim(), self.raw[close].end as usize);
        let inner = &self.text[first..self.raw[close].start as usize];
        let value = inner.split(',').next().unwrap_or(inner).trim_end();
        self.report(
            Diagnostic::new(
                Code::ForeignForm,
                self.span_of(first, first + value.len()),
                "a call of STL names its parameters",
            )
            .label("a value without a name")
            .help(format!("write `{called} (… := {value}, …)` with the names that the block declares")),
        );
        self.out.truncate(call);
        self.push(start, Tok::BadStatement, end);
        self.at = close + 1;
        true
    }

    /// `( name := operand, … )`.
    pub(super) fn parameters(&mut self) {
        if self.values_without_names() {
            return;
        }
        let opening = self.raw[self.at];
        self.take(Tok::LeftParen);
        // `;` after each parameter is one mistake.
        let mut is_told = false;
        while let Some(token) = self.peek() {
            self.pragmas_in_call(token.start);
            let after_operand = !matches!(self.last(), Some(Tok::LeftParen | Tok::Comma | Tok::Assign));
            match token.kind {
                RawKind::RightParen => {
                    self.comma_at_end();
                    return self.take(Tok::RightParen);
                }
                RawKind::Semicolon if after_operand && self.is_parameter(self.at + 1) => {
                    let name = self.slice(self.raw[self.at + 1]);
                    let help = format!("write `, {name} := …`");
                    if !std::mem::replace(&mut is_told, true) {
                        self.report(
                            Diagnostic::new(
                                Code::ForeignForm,
                                self.span(token),
                                "the parameters of a call are separated by `,`",
                            )
                            .label("read as `,`")
                            .help(help),
                        );
                    }
                    self.take(Tok::Comma);
                }
                RawKind::Semicolon if after_operand && self.kind_at(self.at + 1) == Some(RawKind::RightParen) => {
                    if !std::mem::replace(&mut is_told, true) {
                        self.report(
                            Diagnostic::new(Code::Syntax, self.span(token), "a list of parameters cannot end with `;`")
                                .label("no parameter follows")
                                .help("remove the `;`"),
                        );
                    }
                    self.at += 1;
                }
                RawKind::Semicolon => break,
                _ if self.ends_code(self.at) => break,
                _ if self.is_parameter(self.at) => {
                    if after_operand {
                        let end = self.last_end();
                        if !token.first_on_line {
                            self.report(
                                Diagnostic::new(
                                    Code::Syntax,
                                    self.span(token),
                                    "`,` is missing between two parameters",
                                )
                                .label("another parameter begins here")
                                .help("separate parameters with `,`"),
                            );
                        }
                        self.push(end, Tok::Comma, end);
                    }
                    self.parameter_name();
                }
                RawKind::Word if after_operand && token.first_on_line && self.begins_statement(self.at) => break,
                _ => self.operand_token(),
            }
        }
        self.report(
            Diagnostic::new(Code::Syntax, self.span(opening), "the parameter list is not closed with `)`")
                .label("begins here")
                .help("write `)` after the last parameter"),
        );
        let end = self.last_end();
        self.push(end, Tok::RightParen, end);
    }

    /// Reports a `,` after the last parameter, before the `)` that comes next.
    fn comma_at_end(&mut self) {
        // After another comma, and after the opening parenthesis, it is reported elsewhere.
        if let [.., (_, before, _), (start, Tok::Comma, end)] = &self.out[..]
            && !matches!(before, Tok::Comma | Tok::LeftParen)
        {
            let span = self.span_of(*start, *end);
            self.report(
                Diagnostic::new(Code::Syntax, span, "a list of parameters cannot end with `,`")
                    .label("no parameter follows")
                    .help("remove the `,`"),
            );
        }
    }

    /// A pragma inside a statement cannot be executed.
    pub(super) fn pragmas_in_call(&mut self, before: u32) {
        while let Some(comment) = self.next_pragma(before) {
            self.skip_pragma();
            let span = self.span_of(comment.start as usize, comment.end as usize);
            self.report(
                Diagnostic::new(Code::Pragma, span, "a pragma is not allowed inside a statement")
                    .label("the call is not ended yet")
                    .help("write it after the call"),
            );
        }
    }
}
