//! Operands in parentheses, as other languages have them: `A (I 0.0 OR I 0.1)`, `FP(M 0.1)`, `L ABS(MW 0)`, `L MW(MD 10)`.

use plcc_diag::{Code, Diagnostic};

use super::Classifier;
use crate::stl::raw::{RawKind, RawToken};
use crate::stl::token::Tok;
use crate::stl::{OperandClass, StlInsn, form_help, mnemonics};

impl Classifier<'_, '_> {
    /// `A (I 0.0 OR I 0.1)` and `A( O I 0.0 )`, read up to the `)`, after `A (` that begins at byte `start`; false: something else follows.
    pub(super) fn nested_operands(&mut self, insn: StlInsn, start: usize) -> bool {
        if !insn.opens_nesting() {
            return false;
        }
        let Some(close) = self.closing(self.at).filter(|close| *close > self.at) else { return false };
        let opening = self.raw[self.at - 1];
        if self.begins_statement(self.at) {
            self.statements_on_line(opening, start, close);
            return true;
        }
        let mnemonic = self.text[start..opening.start as usize].trim();
        let inner = self.text[opening.end as usize..self.raw[close].start as usize].trim();
        let is_operator = |index: usize| {
            matches!(self.kind_at(index), Some(RawKind::Word))
                && matches!(self.upper(index).as_str(), "AND" | "OR" | "XOR" | "NOT" | "UND" | "ODER")
        };
        let help = match (self.at..close).any(is_operator) {
            true => format!("write a statement for each operand on lines of their own between `{mnemonic}(` and `)`"),
            false => format!("write `{mnemonic} {inner}`"),
        };
        self.report_parentheses(opening, close, "a statement has one operand, without parentheses", help);
        self.skip_parentheses(self.out.len() - 1, close);
        true
    }

    /// Reports statements between parentheses on one line, without `;`.
    fn statements_on_line(&mut self, opening: RawToken, start: usize, close: usize) {
        let mut first = self.at;
        let mut lines = vec![format!("`{}(`", self.text[start..opening.start as usize].trim())];
        while first < close {
            let after_operand = |(insn, count): (StlInsn, usize)| match insn.operand() {
                OperandClass::None => count,
                _ => count + 1,
            };
            let from = first + self.mnemonic_at(first).map_or(1, after_operand);
            let next = (from..close).find(|index| self.mnemonic_at(*index).is_some()).unwrap_or(close);
            let statement = &self.text[self.raw[first].start as usize..self.raw[next - 1].end as usize];
            lines.push(format!("`{statement}`"));
            first = next;
        }
        let span = self.span_of(opening.start as usize, self.raw[close].end as usize);
        self.report(
            Diagnostic::new(Code::Syntax, span, "a statement ends with `;` or with its line")
                .label("several statements")
                .help(format!("write {} and `)` on lines of their own", lines.join(", "))),
        );
        self.skip_parentheses(self.out.len() - 1, close);
    }

    /// `FP(M 0.1)`, `L ABS(MW 0)`, read up to its `)`. `first`: index of the first token of the operand.
    pub(super) fn operand_in_parentheses(&mut self, opening: RawToken, first: usize) -> bool {
        let Some(close) = self.closing(self.at + 1).filter(|close| *close > self.at + 1) else { return false };
        let Some((start, insn, end)) = first.checked_sub(1).map(|insn| &self.out[insn]) else { return false };
        let takes_operand = match insn {
            Tok::Insn(insn) => insn.operand() != OperandClass::None,
            Tok::Jump(_) => true,
            _ => return false,
        };
        let takes_block =
            matches!(insn, Tok::Insn(insn) if matches!(insn.operand(), OperandClass::Block | OperandClass::DataBlock));
        let mnemonic = &self.text[*start..*end];
        let inner = self.text[opening.end as usize..self.raw[close].start as usize].trim();
        match &self.out[first..] {
            [] if takes_operand => {
                let help = format!("write `{mnemonic} {inner}`");
                self.report_parentheses(opening, close, "an operand of STL has no parentheses", help);
            }
            [(from, Tok::Area(..), end)] if takes_operand => {
                let letters = &self.text[*from..*end];
                let is_number = inner.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
                let (title, help) = match is_number {
                    true => ("an address of STL has no parentheses", format!("write `{mnemonic} {letters} {inner}`")),
                    false => {
                        let meant = form_help::register_and_offset(inner).unwrap_or_else(|| format!("[{inner}]"));
                        ("what holds an address is in brackets", format!("write `{mnemonic} {letters}{meant}`"))
                    }
                };
                self.report_parentheses(opening, close, title, help);
            }
            [(from, Tok::Name(_) | Tok::Quoted(_), end)] if *end == opening.start as usize => {
                let name = &self.text[*from..*end];
                let upper = name.to_ascii_uppercase();
                let own = self.lookup(&upper).filter(|insn| insn.operand() == OperandClass::None);
                let (title, help) = match own {
                    Some(_) => (
                        format!("`{upper}` is an instruction of its own"),
                        format!("write `{mnemonic} {inner}`, and `{upper}` on the next line"),
                    ),
                    // `OPN DB(MW 10)`
                    None if takes_block && mnemonics::block_prefix(&upper).is_some() => (
                        "what holds the number of a block is in brackets".to_owned(),
                        format!("write `{mnemonic} {name}[{inner}]`"),
                    ),
                    None => (
                        format!("an operand of STL cannot call `{name}`"),
                        format!("write `CALL {name} (…)` before this, and here the variable that has the result"),
                    ),
                };
                self.report_parentheses(opening, close, &title, help);
            }
            _ => return false,
        }
        self.skip_parentheses(first - 1, close);
        true
    }

    /// Index of the `)` on this line that closes a parenthesis before `index`.
    fn closing(&self, index: usize) -> Option<usize> {
        const TOKENS_MAX: usize = 200;
        let mut depth = 0usize;
        for at in index..index + TOKENS_MAX {
            let token = self.raw_at(at).filter(|token| !token.first_on_line)?;
            match token.kind {
                RawKind::Semicolon => return None,
                RawKind::LeftParen => depth += 1,
                RawKind::RightParen if depth == 0 => return Some(at),
                RawKind::RightParen => depth -= 1,
                _ => {}
            }
        }
        None
    }

    fn report_parentheses(&mut self, opening: RawToken, close: usize, title: &str, help: String) {
        let span = self.span_of(opening.start as usize, self.raw[close].end as usize);
        let message = Diagnostic::new(Code::ForeignForm, span, title);
        self.report(message.label("a form of other languages").help(help));
    }

    /// The statement whose instruction is token `insn` is over after `close`, and means nothing.
    fn skip_parentheses(&mut self, insn: usize, close: usize) {
        let start = self.out[insn].0;
        self.out.truncate(insn);
        self.at = close + 1;
        while self.peek().is_some_and(|token| !token.first_on_line && token.kind != RawKind::Semicolon) {
            self.at += 1;
        }
        let end = self.last_end();
        self.push(start, Tok::BadStatement, end);
    }
}
