//! Classifies the words of expressions: operands, operators, balanced brackets.

use plcc_diag::{Code, Diagnostic};

use super::Classifier;
use crate::gr7::lexer::{RawKind, RawToken};
use crate::gr7::token::Tok;
use plcc_syntax::front::{self, NESTING_MAX};
use plcc_syntax::scl::ast::BinaryOp;

/// Where an expression is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    Condition,
    /// An action: nothing is required between operand and value.
    Action,
    Permanent,
    /// Block, instance and parameters of a call: a line end is enough between parameters.
    Call,
}

impl<'a> Classifier<'a, '_> {
    /// Takes the tokens before index `end` as operands and operators.
    pub(super) fn expression(&mut self, end: usize, place: Place) {
        let first = self.out.len();
        let mut open: Vec<RawToken> = Vec::new();
        let mut signs = 0;
        let start = self.at;
        while self.at < end {
            let token = self.raw[self.at];
            if self.at > start && self.comma_is_missing(place, open.len()) {
                self.push_here(Tok::Comma);
            }
            match token.kind {
                RawKind::LeftParen | RawKind::LeftBracket => {
                    if !self.open_bracket(token, &mut open) {
                        return self.too_deep(token, first, end);
                    }
                    signs = 0;
                }
                RawKind::RightParen | RawKind::RightBracket => self.close_bracket(token, &mut open),
                _ => {
                    self.element(token);
                    let sign = matches!(self.out.last(), Some((_, Tok::Plus | Tok::Minus | Tok::Not, _)));
                    signs = if sign { signs + 1 } else { 0 };
                    if signs > NESTING_MAX {
                        return self.too_deep(token, first, end);
                    }
                }
            }
        }
        while let Some(opening) = open.pop() {
            self.close_unclosed(opening);
        }
    }

    /// Whether the source omits a comma before the current token.
    fn comma_is_missing(&self, place: Place, depth: usize) -> bool {
        let token = self.raw[self.at];
        let operand = matches!(
            token.kind,
            RawKind::Word
                | RawKind::Number
                | RawKind::Literal
                | RawKind::Absolute
                | RawKind::Quoted
                | RawKind::Local
                | RawKind::Text
        ) && !is_operator(token, self.slice(token));
        let follows = operand && self.after_operand();
        match place {
            Place::Condition | Place::Permanent => false,
            Place::Action => depth == 0 && follows,
            Place::Call => depth == 1 && follows && token.first_on_line,
        }
    }

    /// Brackets that are nested too deeply for code that walks the tree: the expression becomes an error.
    fn too_deep(&mut self, token: RawToken, first: usize, end: usize) {
        let message = front::too_deep(self.span(token), "memory bit");
        self.report(message);
        self.out.truncate(first);
        self.out.push((token.start as usize, Tok::Bad, token.end as usize));
        self.at = end;
    }

    /// Takes an operand, operator or sign that is not a bracket.
    fn element(&mut self, token: RawToken) {
        let slice = self.slice(token);
        let tok = match token.kind {
            RawKind::Word if self.other_language(token, slice) => return,
            RawKind::Word => self.word(slice),
            RawKind::Number if self.after_point() => Tok::Word(slice),
            RawKind::Number | RawKind::Literal | RawKind::Text => Tok::Literal(slice),
            RawKind::Absolute => Tok::Absolute(slice),
            RawKind::Quoted => Tok::Quoted(slice.trim_matches('"').trim()),
            RawKind::Local => Tok::Local(slice[1..].trim_matches('"').trim()),
            RawKind::Assign | RawKind::Arrow => Tok::Assign,
            RawKind::Comma => Tok::Comma,
            RawKind::Dot => Tok::Dot,
            RawKind::Equal => Tok::Compare(BinaryOp::Equal),
            RawKind::NotEqual => Tok::Compare(BinaryOp::NotEqual),
            RawKind::Greater => Tok::Compare(BinaryOp::Greater),
            RawKind::Less => Tok::Compare(BinaryOp::Less),
            RawKind::GreaterEqual => Tok::Compare(BinaryOp::GreaterEqual),
            RawKind::LessEqual => Tok::Compare(BinaryOp::LessEqual),
            RawKind::Plus => Tok::Plus,
            RawKind::Minus => Tok::Minus,
            RawKind::Star => Tok::Star,
            RawKind::Slash => Tok::Factor(BinaryOp::Divide),
            RawKind::Ampersand if self.kind_at(self.at + 1) == Some(RawKind::Ampersand) => {
                self.foreign(token, "the operator is `AND`", "write `AND` for `&&`");
                let after = self.at + 2;
                return self.take_up_to(Tok::And, after);
            }
            RawKind::Ampersand => Tok::And,
            _ => return self.stray(token),
        };
        self.take(tok);
    }

    /// Whether an operand ends with the last token.
    fn after_operand(&self) -> bool {
        matches!(
            self.out.last(),
            Some((
                _,
                Tok::Word(_)
                    | Tok::Quoted(_)
                    | Tok::Local(_)
                    | Tok::Absolute(_)
                    | Tok::Literal(_)
                    | Tok::Bad
                    | Tok::RightParen
                    | Tok::RightBracket,
                _
            ))
        )
    }

    fn after_point(&self) -> bool {
        self.at > 0 && self.raw[self.at - 1].kind == RawKind::Dot
    }

    fn word(&self, slice: &'a str) -> Tok<'a> {
        let formal = matches!(self.kind_at(self.at + 1), Some(RawKind::Assign | RawKind::Arrow));
        if self.after_point() || formal {
            return Tok::Word(slice);
        }
        let is = |word: &str| word.eq_ignore_ascii_case(slice);
        match () {
            () if is("AND") => Tok::And,
            () if is("OR") => Tok::Or,
            () if is("XOR") => Tok::Xor,
            () if is("NOT") => Tok::Not,
            () if is("MOD") => Tok::Factor(BinaryOp::Modulo),
            () if is("DIV") => Tok::Factor(BinaryOp::DivideInteger),
            () if is_shift(slice) && self.after_operand() => Tok::Shift(slice),
            () => Tok::Word(slice),
        }
    }

    /// Takes a word of other languages: `UND`, `5s`.
    fn other_language(&mut self, token: RawToken, slice: &'a str) -> bool {
        let is = |word: &str| word.eq_ignore_ascii_case(slice);
        let operand_follows = matches!(
            self.kind_at(self.at + 1),
            Some(
                RawKind::Word
                    | RawKind::Absolute
                    | RawKind::Quoted
                    | RawKind::Local
                    | RawKind::Number
                    | RawKind::Literal
                    | RawKind::LeftParen
            )
        );
        let operator = match () {
            () if self.after_point() || !operand_follows => None,
            () if is("NICHT") && !self.after_operand() => Some(("NOT", Tok::Not)),
            () if !self.after_operand() => None,
            () if is("UND") => Some(("AND", Tok::And)),
            () if is("ODER") => Some(("OR", Tok::Or)),
            () if is("EXOR") => Some(("XOR", Tok::Xor)),
            () => None,
        };
        if let Some((word, tok)) = operator {
            self.report(front::frame_words::misspelt(self.span(token), slice, word));
            self.take(tok);
            return true;
        }
        let digits = slice.trim_start_matches(|c: char| c.is_ascii_digit());
        let unit = ["d", "h", "m", "s", "ms"].iter().any(|unit| unit.eq_ignore_ascii_case(digits));
        // In an action, times have no `T#`.
        let compared = matches!(self.out.last(), Some((_, Tok::Compare(_), _)));
        if digits.len() < slice.len() && unit && compared {
            let help = format!("write `T#{}`", slice.to_ascii_uppercase());
            self.foreign(token, "a time begins with `T#`", &help);
            self.take(Tok::Bad);
            return true;
        }
        false
    }

    /// Takes a sign of other languages: `||`, `!`, `!=`.
    fn other_sign(&mut self, token: RawToken, slice: &str) -> bool {
        let (word, tok) = match slice {
            "|" | "||" => ("OR", Tok::Or),
            "!" if self.kind_at(self.at + 1) == Some(RawKind::Equal) => {
                self.foreign(token, "not equal is `<>`", "write `<>` for `!=`");
                let after = self.at + 2;
                self.take_up_to(Tok::Compare(BinaryOp::NotEqual), after);
                return true;
            }
            "!" => ("NOT", Tok::Not),
            _ => return false,
        };
        self.foreign(token, &format!("the operator is `{word}`"), &format!("write `{word}` for `{slice}`"));
        self.take(tok);
        true
    }

    /// Reports the current raw token, which is allowed nowhere, and advances. A `Bad` takes its place.
    fn stray(&mut self, token: RawToken) {
        let (span, slice) = (self.span(token), self.slice(token));
        if token.kind == RawKind::Stray && self.other_sign(token, slice) {
            return;
        }
        let diagnostic = match token.kind {
            RawKind::UnterminatedText => front::unterminated_text(span),
            RawKind::UnterminatedQuoted => front::unterminated_name(span, "name"),
            RawKind::Stray => {
                let help = "remove it, or put it into a comment `(* … *)`";
                front::stray_characters(span, slice, "chart", "GRAPH outside comments", help)
            }
            _ => Diagnostic::new(Code::Syntax, span, format!("`{slice}` is not allowed here"))
                .label("not expected")
                .help("an operand is an address, a symbol, a step or transition with its member, or a constant"),
        };
        self.report(diagnostic);
        self.take(Tok::Bad);
    }
}

fn is_shift(word: &str) -> bool {
    ["SHL", "SHR", "ROL", "ROR"].iter().any(|known| known.eq_ignore_ascii_case(word))
}

/// Whether the token comes between two operands.
pub(super) fn is_operator(token: RawToken, text: &str) -> bool {
    match token.kind {
        RawKind::Word => {
            is_shift(text) || ["AND", "OR", "XOR", "MOD", "DIV"].iter().any(|known| known.eq_ignore_ascii_case(text))
        }
        RawKind::Equal
        | RawKind::NotEqual
        | RawKind::Greater
        | RawKind::Less
        | RawKind::GreaterEqual
        | RawKind::LessEqual
        | RawKind::Plus
        | RawKind::Minus
        | RawKind::Star
        | RawKind::Slash
        | RawKind::Ampersand => true,
        _ => false,
    }
}
