//! Classifies the words of expressions: operands, operators, balanced brackets.

use plcc_diag::{Code, Diagnostic, Span};

use super::{Classifier, unquoted};
use crate::ast::Width;
use crate::front::{self, NESTING_MAX};
use crate::scl::address;
use crate::scl::ast::{AssignOp, BinaryOp, Literal};
use crate::scl::keyword::Keyword;
use crate::scl::literal;
use crate::scl::raw::{RawKind, RawToken};
use crate::scl::token::Tok;

/// Where a run of operands and operators is, which decides where it ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Run {
    /// A statement, up to `;`.
    Statement,
    /// Up to THEN.
    If,
    /// Up to DO.
    While,
    /// `i := 1 TO 10 BY 2`, up to DO.
    For,
    /// Up to OF.
    Case,
    /// Values of CASE, up to `:`.
    Arm,
    /// Up to `;` or END_REPEAT.
    Until,
    /// A value of a declaration, up to `;`.
    Value,
    /// A bound or length, up to `]`.
    Bound,
}

impl Run {
    fn ends_with(self, keyword: Keyword) -> bool {
        match self {
            Run::If => keyword == Keyword::Then,
            Run::While | Run::For => matches!(keyword, Keyword::Do),
            Run::Case => keyword == Keyword::Of,
            _ => false,
        }
    }

    /// Two operands without an operator between them: the run ends after the first one.
    fn ends_at_second_operand(self, first_on_line: bool) -> bool {
        match self {
            Run::If | Run::While | Run::For | Run::Case | Run::Until => true,
            Run::Statement | Run::Value => first_on_line,
            Run::Arm | Run::Bound => false,
        }
    }
}

impl<'a> Classifier<'a, '_> {
    /// Takes operands and operators up to the end of `run`; the token there is not consumed.
    pub(super) fn run(&mut self, run: Run) {
        let first = self.out.len();
        let mut open: Vec<RawToken> = Vec::new();
        let mut signs = 0;
        while let Some(token) = self.peek() {
            if self.ends(run, token, open.is_empty()) {
                break;
            }
            if open.is_empty()
                && self.out.len() > first
                && run.ends_at_second_operand(token.first_on_line)
                && self.begins_operand(run, token)
                && self.out.last().is_some_and(|(_, token, _)| ends_operand(token))
            {
                break;
            }
            // The next statement begins before the brackets are closed.
            if !open.is_empty()
                && matches!(run, Run::Statement | Run::Value)
                && self.begins_assignment(token)
                && self.out.last().is_some_and(|(_, token, _)| ends_operand(token))
            {
                break;
            }
            match token.kind {
                RawKind::LeftParen | RawKind::LeftBracket => {
                    if !self.open_bracket(token, &mut open) {
                        self.too_deep(run, token, first);
                        return;
                    }
                }
                RawKind::RightParen | RawKind::RightBracket => {
                    if run == Run::Bound && open.is_empty() {
                        break;
                    }
                    self.close_bracket(token, &mut open);
                }
                _ => {
                    self.element(run);
                    let sign = matches!(self.out.last(), Some((_, Tok::Plus | Tok::Minus | Tok::Not, _)));
                    signs = if sign { signs + 1 } else { 0 };
                    if signs > NESTING_MAX {
                        self.too_deep(run, token, first);
                        return;
                    }
                }
            }
        }
        while let Some(opening) = open.pop() {
            self.close_unclosed(opening);
        }
    }

    fn ends(&self, run: Run, token: RawToken, outside: bool) -> bool {
        match token.kind {
            RawKind::Semicolon => return true,
            RawKind::Colon if outside && matches!(run, Run::Arm) => return true,
            _ => {}
        }
        let Some(keyword) = token.keyword else { return false };
        // A formal may have the name of a keyword.
        if !outside && matches!(self.kind_at(self.at + 1), Some(RawKind::Assign | RawKind::Arrow)) {
            return false;
        }
        run.ends_with(keyword)
            || match keyword {
                keyword if keyword.begins_block() => self.block_begins(self.at),
                keyword => keyword.ends_expression(),
            }
    }

    /// Whether a line begins with a variable and `:=`; a name without a sign may be that of a parameter.
    fn begins_assignment(&self, token: RawToken) -> bool {
        const LOOK_MAX: usize = 40;
        let is_variable = matches!(token.kind, RawKind::Local | RawKind::Quoted | RawKind::Absolute);
        let rest = self.raw.iter().skip(self.at + 1).take(LOOK_MAX);
        let mut line = rest.take_while(|next| !next.first_on_line && next.kind != RawKind::Semicolon);
        token.first_on_line && is_variable && line.any(|next| next.kind == RawKind::Assign)
    }

    fn begins_operand(&self, run: Run, token: RawToken) -> bool {
        match token.kind {
            RawKind::Word => match token.keyword {
                Some(Keyword::To | Keyword::By) if run == Run::For => false,
                Some(keyword) => !keyword.is_operator() || keyword == Keyword::Not,
                None => true,
            },
            RawKind::Local
            | RawKind::Quoted
            | RawKind::Number
            | RawKind::Real
            | RawKind::Literal
            | RawKind::Text
            | RawKind::Absolute => true,
            _ => false,
        }
    }

    /// Brackets that are nested too deeply for code that walks the tree: the run becomes an error.
    fn too_deep(&mut self, run: Run, token: RawToken, first: usize) {
        let message = front::too_deep(self.span(token), "variable");
        self.report(message);
        self.out.truncate(first);
        self.push(token.start as usize, Tok::Bad, token.end as usize);
        while let Some(token) = self.peek() {
            if self.ends(run, token, true) {
                return;
            }
            self.at += 1;
        }
    }

    /// Takes an operand, operator or sign that is not a bracket.
    pub(super) fn element(&mut self, run: Run) {
        let token = self.raw[self.at];
        let tok = match token.kind {
            RawKind::Word => return self.word(run, token),
            RawKind::Local => {
                let name = unquoted(self.slice(token));
                Tok::Local(name)
            }
            RawKind::Quoted if self.iec => return self.literal(token),
            RawKind::Quoted => Tok::Quoted(self.quoted_name(token)),
            // `status.3`, a bit of a variable.
            RawKind::Number if self.iec && matches!(self.out.last(), Some((_, Tok::Dot, _))) => {
                Tok::Slice(Width::Bit, self.slice(token).parse().unwrap_or(u32::MAX))
            }
            RawKind::Number | RawKind::Real | RawKind::Literal | RawKind::Text => return self.literal(token),
            RawKind::Absolute => return self.absolute(token),
            RawKind::Slice => match address::slice(self.slice(token)) {
                Some((width, index)) => Tok::Slice(width, index),
                None => Tok::Slice(Width::Bit, u32::MAX),
            },
            RawKind::Assign => Tok::Assign,
            RawKind::AddAssign => Tok::Combine(AssignOp::Add),
            RawKind::SubtractAssign => Tok::Combine(AssignOp::Subtract),
            RawKind::MultiplyAssign => Tok::Combine(AssignOp::Multiply),
            RawKind::DivideAssign => Tok::Combine(AssignOp::Divide),
            RawKind::AttemptAssign => Tok::Combine(AssignOp::Attempt),
            RawKind::Arrow => Tok::Arrow,
            RawKind::Power => Tok::Power,
            RawKind::Comma => Tok::Comma,
            RawKind::Dot => Tok::Dot,
            RawKind::DotDot => Tok::DotDot,
            RawKind::Ellipsis => {
                self.tolerate(
                    self.span(token),
                    "there are three points between the bounds",
                    "read as two",
                    "write `..`",
                );
                Tok::DotDot
            }
            RawKind::Equal => Tok::Equality(BinaryOp::Equal),
            RawKind::NotEqual => Tok::Equality(BinaryOp::NotEqual),
            RawKind::Greater => Tok::Relation(BinaryOp::Greater),
            RawKind::Less => Tok::Relation(BinaryOp::Less),
            RawKind::GreaterEqual => Tok::Relation(BinaryOp::GreaterEqual),
            RawKind::LessEqual => Tok::Relation(BinaryOp::LessEqual),
            RawKind::Plus => Tok::Plus,
            RawKind::Minus => Tok::Minus,
            RawKind::Star => Tok::Star,
            RawKind::Slash => Tok::Factor(BinaryOp::Divide),
            RawKind::Ampersand => Tok::And,
            RawKind::Caret => Tok::Caret,
            RawKind::Colon => Tok::Colon,
            RawKind::LeftBrace => return self.skip_braces(),
            RawKind::Reported => Tok::Bad,
            _ => return self.stray(token),
        };
        self.take(tok);
    }

    /// `"tag"`, and `"tag":P`, which keeps its `P`.
    fn quoted_name(&self, token: RawToken) -> &'a str {
        let text = self.slice(token);
        if text.ends_with('"') { unquoted(text) } else { text.trim_start_matches('"') }
    }

    fn word(&mut self, run: Run, token: RawToken) {
        let word = self.slice(token);
        let formal = matches!(self.kind_at(self.at + 1), Some(RawKind::Assign | RawKind::Arrow));
        // `AND(a, b)`: the operator as a function.
        let called = self.iec
            && self.kind_at(self.at + 1) == Some(RawKind::LeftParen)
            && token.keyword.is_some_and(|word| word.is_operator() && word != Keyword::Not)
            && !self.out.last().is_some_and(|(_, token, _)| ends_operand(token));
        if called {
            return self.take(Tok::Name(word));
        }
        let typed = |ty, bits| Tok::Literal(Literal::Typed { ty, bits });
        let tok = match token.keyword.filter(|_| !formal) {
            Some(Keyword::And) => Tok::And,
            Some(Keyword::Or) => Tok::Or,
            Some(Keyword::Xor) => Tok::Xor,
            Some(Keyword::Not) => Tok::Not,
            Some(Keyword::Mod) => Tok::Factor(BinaryOp::Modulo),
            Some(Keyword::Div) => Tok::Factor(BinaryOp::DivideInteger),
            Some(Keyword::True) => typed(crate::Elementary::Bool, 1),
            Some(Keyword::False) => typed(crate::Elementary::Bool, 0),
            Some(Keyword::Nil) => Tok::Literal(Literal::Nil),
            Some(Keyword::Null) => Tok::Literal(Literal::Null),
            Some(Keyword::Ref) if self.kind_at(self.at + 1) == Some(RawKind::LeftParen) => Tok::Ref,
            Some(Keyword::To) if run == Run::For => Tok::To,
            Some(Keyword::By) if run == Run::For => Tok::By,
            _ => match self.block_with_blank(token) {
                Some(()) => return,
                None => Tok::Name(word),
            },
        };
        self.take(tok);
    }

    /// `FB 10` in two tokens.
    fn block_with_blank(&mut self, token: RawToken) -> Option<()> {
        if self.iec {
            return None;
        }
        let prefix = address::block_prefix(self.slice(token))?;
        let number = self.raw.get(self.at + 1).copied()?;
        if number.kind != RawKind::Number || number.first_on_line {
            return None;
        }
        let value = self.slice(number).replace('_', "").parse().unwrap_or(u32::MAX);
        self.at += 2;
        self.push(token.start as usize, Tok::Block(prefix, value), number.end as usize);
        Some(())
    }

    fn literal(&mut self, token: RawToken) {
        let text = self.slice(token);
        // `TOD#12:30` and `DT#2024-01-31-12:30`: IEC 61131-3 editors omit seconds that are 0.
        let date = |text: &str| if self.iec { literal::iec_date(text) } else { None };
        let parse = |text: &str| date(text).unwrap_or_else(|| literal::parse(text));
        let read = parse(text).or_else(|error| match self.iec && text.contains(':') {
            true => parse(&format!("{text}:00")).map_err(|_| error),
            false => Err(error),
        });
        let tok = match read {
            Ok(read) => {
                if let Some(number) = read.wrapped {
                    self.tolerate(
                        self.span(token),
                        &format!("`{}` is outside the range of its type", self.slice(token)),
                        &format!("read as {number}"),
                        "write the negative number, or a bit string such as `16#FFFF`",
                    );
                }
                Tok::Literal(read.value)
            }
            Err(error) => {
                self.report(error.at(self.span(token)));
                Tok::Bad
            }
        };
        self.take(tok);
    }

    fn absolute(&mut self, token: RawToken) {
        let text = self.slice(token);
        let bare = text.strip_prefix('%').unwrap_or(text);
        let tok = match address::token(text, self.span(token)) {
            Some(operand) => Tok::Absolute(operand),
            // The file format knows what `%QX1.0.2` means, and has a tag of that name.
            None if self.iec => Tok::Quoted(text),
            // `%MW(#i)`, `%DB10.DBW(#i)`
            None if address::area_word(bare).is_some() || address::db_area_word(bare).is_some() => Tok::Name(bare),
            None => {
                let message =
                    Diagnostic::new(Code::AddressRange, self.span(token), format!("`{text}` is not an address"));
                self.report(match (address::numbered(text), address::with_carried_bit(text)) {
                    (Some(numbered), _) => bit_of_wider(self.span(token), text, &numbered),
                    (None, Some(meant)) => message.label("a byte has the bits 0 to 7").help(format!(
                        "is `{meant}` meant, the bit after those of the byte, or another bit from 0 to 7?"
                    )),
                    (None, None) if let Some(area) = area_of_number(bare) => message
                        .label("a bit has a number after a point")
                        .help(format!("write `{text}.0` for a bit, or `%{area}B{}` for the byte", &bare[area.len()..])),
                    (None, None) if let Some(byte) = byte_of_bit(bare) => message
                        .label("a bit has a number after a point")
                        .help(format!("write `{text}.0` for a bit, or `%{byte}` for the byte")),
                    (None, None) => message
                        .label("no area has this address")
                        .help("write e.g. `%MW10`, `%I0.7`, `%DB1.DBX2.0`; bits go from 0 to 7"),
                });
                Tok::Bad
            }
        };
        self.take(tok);
    }

    /// `{ … }` among statements.
    pub(super) fn skip_braces(&mut self) {
        let opening = self.raw[self.at];
        let span = self.span(opening);
        self.at += 1;
        if !self.attributes_end() {
            self.report(
                Diagnostic::new(Code::Syntax, span, "`{` is not closed")
                    .label("begins a list of attributes, which has no meaning among statements")
                    .help("remove it and the list"),
            );
            while self.peek().is_some_and(|token| !token.first_on_line) {
                self.at += 1;
            }
            return;
        }
        while let Some(token) = self.peek() {
            self.at += 1;
            if token.kind == RawKind::RightBrace {
                break;
            }
        }
        self.tolerate(
            span,
            "an attribute list is not allowed among statements",
            "skipped",
            "remove it; it has no meaning here",
        );
    }

    /// Reports the current raw token, which is allowed nowhere, and advances. A `Bad` takes its place.
    fn stray(&mut self, token: RawToken) {
        let span = self.span(token);
        let slice = self.slice(token);
        let diagnostic = match token.kind {
            RawKind::UnterminatedText => front::unterminated_text(span),
            RawKind::UnterminatedQuoted => front::unterminated_name(span, "name"),
            RawKind::Hash => Diagnostic::new(Code::Syntax, span, "no name follows `#`")
                .label("a name must follow immediately")
                .help("write `#name` without a blank, or `#\"name\"`"),
            RawKind::Stray => {
                let language = "SCL outside texts and comments";
                let help = front::stray_help(self.text.get(span.start as usize..).unwrap_or_default(), "name");
                front::stray_characters(span, slice, "statement", language, &help)
            }
            _ => Diagnostic::new(Code::Syntax, span, format!("`{slice}` is not allowed here"))
                .label("not expected")
                .help("an operand is a variable, a constant, an address or a call"),
        };
        self.report(diagnostic);
        self.take(Tok::Bad);
    }
}

/// The letter of `M0`, the address of a bit without its number.
fn area_of_number(text: &str) -> Option<&str> {
    let (area, number) = text.split_at_checked(1)?;
    let is_number = !number.is_empty() && number.bytes().all(|digit| digit.is_ascii_digit());
    (is_number && "IQMEAiqmea".contains(area)).then_some(area)
}

/// `DB1.DBB0` for `DB1.DBX0`, the address of a bit without its number.
fn byte_of_bit(text: &str) -> Option<String> {
    let (block, place) = text.split_once('.')?;
    let (letters, number) = place.split_at_checked(3)?;
    let is_number = !number.is_empty() && number.bytes().all(|digit| digit.is_ascii_digit());
    (letters.eq_ignore_ascii_case("DBX") && is_number).then(|| format!("{block}.DBB{number}"))
}

/// `%MW10.3`, whose bit has two addresses.
fn bit_of_wider(span: Span, text: &str, found: &address::Numbered) -> Diagnostic {
    let address::Numbered { whole, width, byte, number, bit } = found;
    let name = match width {
        Width::Byte => "byte",
        Width::Word => "word",
        Width::Bit | Width::Dword | Width::Lword => "double word",
    };
    let of_whole = *width != Width::Byte && *number < width.bits();
    let help = match (of_whole, *number < 8) {
        (true, true) => format!(
            "write `{bit}` for bit {number} of byte {byte}, `{whole}.%X{number}` for bit {number} of the {name}, or remove `.{number}`"
        ),
        (true, false) => format!("write `{whole}.%X{number}` for bit {number} of the {name}, or remove `.{number}`"),
        (false, true) => format!("write `{bit}`, or remove `.{number}`"),
        (false, false) => format!("remove `.{number}`"),
    };
    Diagnostic::new(Code::AddressRange, span, format!("`{text}` has the number of a bit, but names a {name}"))
        .label("only the address of a bit has a number after the point")
        .help(help)
}

/// Whether an operand may end with the token.
pub fn ends_operand(token: &Tok) -> bool {
    matches!(
        token,
        Tok::Name(_)
            | Tok::Local(_)
            | Tok::Quoted(_)
            | Tok::Block(..)
            | Tok::Literal(_)
            | Tok::Absolute(_)
            | Tok::Slice(..)
            | Tok::Bad
            | Tok::Caret
            | Tok::RightParen
            | Tok::RightBracket
    )
}
