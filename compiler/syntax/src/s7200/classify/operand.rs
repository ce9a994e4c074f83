//! Operands: what a word means depends on where it is.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic};

use super::Classifier;
use crate::ast::Width;
use crate::front::{self, foreign_address};
use crate::s7200::address::{self, AddressError};
use crate::s7200::ast::{Area, BlockKind, SymbolForm};
use crate::s7200::constant::{self, ConstantError};
use crate::s7200::raw::{RawKind, RawToken};
use crate::s7200::token::Tok;
use crate::s7200::{Insn, OperandClass};

/// Where operands are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Where {
    Statement,
    /// Every word is a name, whatever it looks like.
    Declaration,
    /// The address of a line of a data block: `V40` has no size.
    DataAddress,
    /// Quoted texts are strings.
    DataValue,
    Assertion,
}

/// `SBR3`, `INT0`, `OB1` (upper case).
pub fn block(word: &str) -> Option<(BlockKind, u32)> {
    let (kind, number) = [("SBR", BlockKind::Subroutine), ("INT", BlockKind::Interrupt), ("OB", BlockKind::Main)]
        .into_iter()
        .find_map(|(letters, kind)| Some((kind, word.strip_prefix(letters)?)))?;
    let digits = !number.is_empty() && number.len() <= 5 && number.bytes().all(|byte| byte.is_ascii_digit());
    digits.then(|| number.parse().ok()).flatten().map(|number| (kind, number))
}

/// A constant of BOOL (upper case).
pub fn is_bool(word: &str) -> bool {
    matches!(word, "TRUE" | "FALSE" | "ON" | "OFF")
}

impl<'a> Classifier<'a, '_> {
    /// The rest of a line.
    pub fn operands(&mut self, tokens: &[RawToken]) {
        let mut at = 0;
        while let Some(token) = tokens.get(at).copied() {
            at += 1;
            if let Some(count) = self.curved_quotes(&tokens[at - 1..]) {
                at += count - 1;
                continue;
            }
            if self.shown_symbol(&tokens[at - 1..]) {
                at += 2;
                continue;
            }
            if token.kind == RawKind::Word
                && tokens.get(at).is_some_and(|next| next.kind == RawKind::Colon)
                && let Some(end) = self.foreign_address(token)
            {
                at += tokens[at..].iter().take_while(|token| token.range().start < end).count();
                continue;
            }
            if token.kind == RawKind::Word
                && let Some(next) = tokens.get(at)
                && self.parted_address(token, *next)
            {
                at += 1;
                continue;
            }
            if let Some(count) = self.indexed(&tokens[at - 1..]) {
                at += count - 1;
                continue;
            }
            if token.kind == RawKind::Stray
                && let Some(next) = tokens.get(at)
                && self.hexadecimal(token, *next)
            {
                at += 1;
                continue;
            }
            if self.bare_point(&tokens[at - 1..]) {
                at += 1;
                continue;
            }
            let token_of = self.operand(token);
            self.push(token.range(), token_of);
        }
    }

    /// `Start:I0.0`, `#Raw:LW0`, `Init:SBR0`: a symbol with its address, as the editor shows both; false: the tokens do not begin with one.
    fn shown_symbol(&mut self, tokens: &[RawToken]) -> bool {
        let [name, colon, place, ..] = tokens else { return false };
        let joined = name.range().end == colon.range().start && colon.range().end == place.range().start;
        if self.place != Where::Statement || (colon.kind, place.kind) != (RawKind::Colon, RawKind::Word) || !joined {
            return false;
        }
        let text = self.slice(name.range());
        let is_address = |text: &str| address::parse(&text.to_ascii_uppercase()).is_some();
        let (symbol, form) = match name.kind {
            RawKind::Word if !is_address(text) => (text, SymbolForm::Bare),
            RawKind::Local => (text.trim_start_matches('#'), SymbolForm::Local),
            RawKind::Quoted => (text.trim_matches('"'), SymbolForm::Quoted),
            _ => return false,
        };
        let after = self.slice(place.range());
        if symbol.is_empty() || !is_address(after) && block(&after.to_ascii_uppercase()).is_none() {
            return false;
        }
        let token = self.word(*place, after);
        // `V1` may be a symbol.
        if matches!(token, Tok::Bare(_)) {
            return false;
        }
        if matches!(token, Tok::Direct(_) | Tok::Block(..)) {
            self.push(name.range().start..colon.range().end, Tok::Shown(symbol, form));
        }
        self.push(place.range(), token);
        true
    }

    /// `“Start”`, whose quotes belong to the word: how many tokens it has.
    fn curved_quotes(&mut self, tokens: &[RawToken]) -> Option<usize> {
        let start = tokens.first().filter(|token| token.kind == RawKind::Word)?.range().start;
        let (name, length) = front::in_curved_quotes(self.text.get(start..)?)?;
        let range = start..start + length;
        self.report(
            Diagnostic::new(Code::ForeignForm, self.span(range.clone()), "a symbol is written in straight quotes")
                .label("curved quotes")
                .help(format!("write `\"{name}\"`")),
        );
        self.push(range.clone(), Tok::BadOperand);
        Some(tokens.iter().take_while(|token| token.range().start < range.end).count())
    }

    /// `VB[VW0]`, `VB(10)`: an address with an index, which is reported; returns how many tokens it has.
    fn indexed(&mut self, tokens: &[RawToken]) -> Option<usize> {
        const LOOK_MAX: usize = 40;
        let [letters, open, rest @ ..] = tokens else { return None };
        let word = letters.text(self.text).to_ascii_uppercase();
        let closing = match open.text(self.text) {
            "[" => "]",
            "(" => ")",
            _ => return None,
        };
        let of_area = letters.kind == RawKind::Word && self.place != Where::Declaration && address::are_letters(&word);
        let mut inside = rest.iter().take(if of_area { LOOK_MAX } else { 0 });
        let end = inside.position(|token| token.text(self.text) == closing).filter(|end| *end > 0)?;
        let index = self.slice(rest[0].range().start..rest[end - 1].range().end);
        let help = match index.bytes().all(|digit| digit.is_ascii_digit()) {
            true => format!("write `{word}{index}`"),
            false => {
                let first = if word == "V" { "VB" } else { word.as_str() };
                format!("write `MOVD &{first}0, AC1`, add the index to AC1 with `+D`, and use `*AC1`")
            }
        };
        let range = letters.range().start..rest[end].range().end;
        let span = self.span(range.clone());
        self.report(
            Diagnostic::new(Code::ForeignForm, span, "an address of the S7-200 has no index")
                .label("a form of other languages")
                .help(help),
        );
        self.push(range, Tok::BadOperand);
        Some(end + 3)
    }

    /// `$FF`, as other assemblers write a hexadecimal number.
    fn hexadecimal(&mut self, sign: RawToken, digits: RawToken) -> bool {
        let number = digits.text(self.text);
        let is_number = sign.text(self.text) == "$"
            && sign.range().end == digits.range().start
            && number.bytes().all(|digit| digit.is_ascii_hexdigit());
        if is_number {
            let range = sign.range().start..digits.range().end;
            let (span, text) = (self.span(range.clone()), self.slice(range.clone()));
            self.report(
                Diagnostic::new(Code::BadLiteral, span, format!("`{text}` is not a constant of the S7-200"))
                    .label("a hexadecimal number of another language")
                    .help(format!("write `16#{number}`")),
            );
            self.push(range, Tok::BadOperand);
        }
        is_number
    }

    /// `N7:0`, `B3:0/1` of other controllers; returns their end.
    fn foreign_address(&mut self, token: RawToken) -> Option<usize> {
        let start = token.range().start;
        let address = self.text.get(start..).and_then(foreign_address::at)?;
        let range = start..start + address.length;
        let span = self.span(range.clone());
        self.report(
            Diagnostic::new(Code::ForeignForm, span, address.title)
                .label("not an address of the S7-200")
                .help(address.help),
        );
        self.push(range.clone(), Tok::BadOperand);
        Some(range.end)
    }

    /// The operands of a statement; a decimal comma in an address, `LD I0,0`, is taken as a point.
    pub fn statement_operands(&mut self, insn: Insn, tokens: &[RawToken]) {
        if insn == Insn::Call && self.foreign_call(tokens) {
            return;
        }
        let commas = tokens.iter().filter(|token| token.kind == RawKind::Comma).count();
        let mut rest = tokens;
        if commas == insn.operands().len()
            && let Some((count, joined)) = self.decimal_comma(tokens)
            && let Some(Ok(direct)) = address::parse(&joined.to_ascii_uppercase())
        {
            let range = tokens[0].range().start..tokens[count - 1].range().end;
            let (span, text) = (self.span(range.clone()), self.slice(range.clone()));
            self.report(
                Diagnostic::new(Code::AddressRange, span, format!("`{text}` has a comma before the number of its bit"))
                    .label("a comma separates operands")
                    .help(format!("write `{joined}`")),
            );
            self.push(range, Tok::Direct(direct));
            rest = &tokens[count..];
        }
        self.operands(rest);
    }

    /// `I0,0` or `I 0,0` at the beginning: how many tokens it has, and the address with a point.
    fn decimal_comma(&self, tokens: &[RawToken]) -> Option<(usize, String)> {
        let text = |token: &RawToken| token.text(self.text);
        let (count, byte, bit, before) = match tokens {
            [letters, byte, comma, bit, ..]
                if (byte.kind, comma.kind) == (RawKind::Integer, RawKind::Comma)
                    && address::are_letters(&text(letters).to_ascii_uppercase()) =>
            {
                (4, *byte, *bit, format!("{}{}", text(letters), text(byte)))
            }
            [word, comma, bit, ..] if comma.kind == RawKind::Comma => (3, *word, *bit, text(word).to_owned()),
            _ => return None,
        };
        let comma = tokens[count - 2];
        let words = tokens[0].kind == RawKind::Word && bit.kind == RawKind::Integer;
        let adjacent = byte.range().end == comma.range().start && comma.range().end == bit.range().start;
        (words && adjacent).then(|| (count, format!("{before}.{}", text(&bit))))
    }

    /// `LD NOT I0.0`, `LD /I0.0`, `LD !I0.0` without the negation, after a message.
    pub fn without_not<'t>(&mut self, insn: Insn, mnemonic: &Range<usize>, rest: &'t [RawToken]) -> &'t [RawToken] {
        let [not, operand, after @ ..] = rest else { return rest };
        let sign = self.slice(not.range());
        let is_word = not.kind == RawKind::Word && sign.eq_ignore_ascii_case("NOT");
        let bits = [OperandClass::Bit, OperandClass::BitWrite, OperandClass::InputBit, OperandClass::OutputBit];
        let is_of_bit = matches!(insn.operands(), [class] if bits.contains(class));
        let is_negation = is_word || is_of_bit && matches!(sign, "/" | "!" | "~");
        if !is_negation || !matches!(operand.kind, RawKind::Word | RawKind::Quoted | RawKind::Local) {
            return rest;
        }
        let end = after.last().unwrap_or(operand).range().end;
        let operands = self.slice(operand.range().start..end);
        let word = self.slice(mnemonic.clone());
        let help = match insn {
            Insn::Load | Insn::And | Insn::Or => format!("write `{word}N {operands}`"),
            Insn::LoadNow | Insn::AndNow | Insn::OrNow => {
                let (first, last) = word.split_at(word.len() - 1);
                format!("write `{first}N{last} {operands}`")
            }
            Insn::LoadNot | Insn::AndNot | Insn::OrNot => {
                format!("two negations cancel each other: write `{} {operands}`", &word[..word.len() - 1])
            }
            _ => format!("write `NOT` on a line of its own before `{word} {operands}`"),
        };
        let label = if is_word { "an instruction without operand" } else { "a form of other languages" };
        let title = format!("`{}` is not allowed before an operand", if is_word { "NOT" } else { sign });
        let message = Diagnostic::new(Code::ForeignForm, self.span(not.range()), title).label(label).help(help);
        self.report(message);
        &rest[1..]
    }

    /// `I 0.0`: an address with a blank inside.
    fn parted_address(&mut self, letters: RawToken, number: RawToken) -> bool {
        if self.place == Where::Declaration || !matches!(number.kind, RawKind::Integer | RawKind::Real) {
            return false;
        }
        let word = letters.text(self.text).to_ascii_uppercase();
        if !address::are_letters(&word) {
            return false;
        }
        let joined = format!("{word}{}", number.text(self.text));
        let Some(Ok(direct)) = address::parse(&joined) else { return false };
        if direct.area == Area::V && direct.width.is_none() && self.place != Where::DataAddress {
            return false;
        }
        let range = letters.range().start..number.range().end;
        let span = self.span(range.clone());
        self.report(
            Diagnostic::new(Code::Tolerated, span, format!("the address `{joined}` contains a blank"))
                .label(format!("read as `{}`", address::text(&direct)))
                .help("write addresses of the S7-200 without blanks"),
        );
        self.push(range, Tok::Direct(direct));
        true
    }

    fn operand(&mut self, token: RawToken) -> Tok<'a> {
        let text = self.slice(token.range());
        match token.kind {
            RawKind::Word => self.word(token, text),
            RawKind::Local => match text.strip_prefix('#') {
                Some(name) if !name.is_empty() => Tok::Local(name),
                _ => self.bad_character(token, text),
            },
            RawKind::Integer => {
                let value = constant::integer(text);
                self.constant(token, value, Tok::Integer)
            }
            RawKind::Real => {
                let value = constant::real(text);
                self.constant(token, value, Tok::Real)
            }
            RawKind::Based => {
                let value = constant::based(text, self.timer_before());
                self.constant(token, value, |(value, width)| Tok::Bits(value, width))
            }
            RawKind::BadNumber => {
                let span = self.span(token.range());
                let lower = text.to_ascii_lowercase();
                let message = Diagnostic::new(Code::BadLiteral, span, format!("`{text}` is not a constant"));
                let message = message.label("begins like a number");
                let digits = |prefix: &str, radix: u32| {
                    lower.strip_prefix(prefix).filter(|rest| rest.chars().all(|digit| digit.is_digit(radix)))
                };
                self.report(if let Some(digits) = digits("0x", 16) {
                    message.help(format!("write `16#{}`", digits.to_ascii_uppercase()))
                } else if let Some(digits) = digits("0b", 2) {
                    message.help(format!("write `2#{digits}`"))
                } else if let Some(help) = constant::steps(text, self.timer_before()) {
                    message.help(help)
                } else if lower.ends_with("ms") || lower.ends_with('s') {
                    message.help(
                        "a time of the S7-200 is a whole number of steps of its timer, of 1, 10 or 100 ms: write the number",
                    )
                } else {
                    message.help("constants are whole numbers, `16#` or `2#` with digits, and numbers with a point; names do not begin with a digit")
                });
                Tok::BadOperand
            }
            RawKind::Quoted => {
                let inner = text.trim_matches('"');
                if self.place != Where::DataValue && constant::is_symbol(inner) {
                    return Tok::Quoted(inner);
                }
                let inner = text.strip_prefix('"').and_then(|text| text.strip_suffix('"')).unwrap_or_default();
                let value = constant::text(inner);
                self.constant(token, value, Tok::Text)
            }
            RawKind::Characters => {
                let inner = text.strip_prefix('\'').and_then(|text| text.strip_suffix('\'')).unwrap_or_default();
                let value = constant::text(inner);
                self.constant(token, value, Tok::Characters)
            }
            RawKind::Unterminated => {
                let span = self.span(token.range().start..token.range().start + 1);
                self.report(
                    Diagnostic::new(Code::UnterminatedText, span, "the text is not closed on its line")
                        .label("begins here")
                        .help("close it with the same quote; write a quote inside as `$'` or `$\"`"),
                );
                Tok::BadOperand
            }
            RawKind::Percent => {
                let span = self.span(token.range());
                let plain = text.trim_start_matches('%');
                self.report(
                    Diagnostic::new(Code::ForeignLanguage, span, format!("`{text}` is an address of the IEC mode"))
                        .label("addresses of STL have no `%`")
                        .help(format!("write `{}`", if plain.is_empty() { "I0.0" } else { plain })),
                );
                Tok::BadOperand
            }
            RawKind::Colon => Tok::Colon,
            RawKind::Assign => Tok::Assign,
            RawKind::Semicolon => Tok::Semicolon,
            RawKind::Comma => Tok::Comma,
            RawKind::Plus => Tok::Plus,
            RawKind::Minus => Tok::Minus,
            RawKind::Star => Tok::Star,
            RawKind::Ampersand => Tok::Ampersand,
            RawKind::Relation | RawKind::Slash => Tok::Stray,
            RawKind::Stray => self.bad_character(token, text),
            RawKind::Newline | RawKind::Comment => Tok::Stray,
        }
    }

    /// The number of the timer whose value comes next: `TON T37,`.
    fn timer_before(&self) -> Option<u8> {
        let [.., (_, Tok::Direct(cell), _), (_, Tok::Comma, _)] = self.classified.tokens.as_slice() else {
            return None;
        };
        u8::try_from(cell.number).ok().filter(|_| cell.area == Area::T)
    }

    fn constant<T>(
        &mut self,
        token: RawToken,
        value: Result<T, ConstantError>,
        made: impl FnOnce(T) -> Tok<'a>,
    ) -> Tok<'a> {
        match value {
            Ok(value) => made(value),
            Err(error) => {
                let code = if error.range { Code::LiteralRange } else { Code::BadLiteral };
                let text = self.slice(token.range());
                let title = match error.range {
                    true => format!("the constant `{text}` is too large"),
                    false => format!("`{text}` is not a constant of the S7-200"),
                };
                let span = self.span(token.range());
                self.report(Diagnostic::new(code, span, title).label(error.label).help(error.help));
                Tok::BadOperand
            }
        }
    }

    fn bad_character(&mut self, token: RawToken, text: &str) -> Tok<'a> {
        match text {
            "(" => self.parentheses += 1,
            ")" if self.parentheses > 0 => {
                self.parentheses -= 1;
                return Tok::BadOperand;
            }
            _ => {}
        }
        let (title, help) = match text {
            "(" | ")" => (
                format!("a statement cannot contain `{text}`"),
                "STL of the S7-200 has no parentheses: begin the inner part with `LD` and join it with `ALD` or `OLD`",
            ),
            "#" => (
                "a statement cannot contain `#` alone".to_owned(),
                "a comment begins with `//`; a local name is `#name`",
            ),
            _ => (
                format!("a statement cannot contain `{}`", text.escape_debug()),
                "a statement contains names, addresses, constants and the characters `,` `*` `&` `#`",
            ),
        };
        let span = self.span(token.range());
        self.report(Diagnostic::new(Code::UnexpectedCharacter, span, title).label("not expected here").help(help));
        Tok::BadOperand
    }

    fn word(&mut self, token: RawToken, text: &'a str) -> Tok<'a> {
        let upper = text.to_ascii_uppercase();
        if self.place == Where::Declaration {
            let value = matches!(self.classified.tokens.last(), Some((_, Tok::Assign, _)));
            return match value && is_bool(&upper) {
                true => Tok::Bool(matches!(upper.as_str(), "TRUE" | "ON")),
                false => Tok::Bare(text),
            };
        }
        if self.place == Where::Assertion {
            match upper.as_bytes() {
                [b'S', level @ b'0'..=b'8'] => return Tok::Stack(level - b'0'),
                b"ENO" => return Tok::Eno,
                _ => {}
            }
        }
        if is_bool(&upper) {
            return Tok::Bool(matches!(upper.as_str(), "TRUE" | "ON"));
        }
        if let Some((kind, number)) = block(&upper) {
            return Tok::Block(kind, number);
        }
        match address::parse(&upper) {
            Some(Ok(direct)) => {
                // `V1` may be a symbol.
                if direct.area == Area::V && direct.width.is_none() && self.place != Where::DataAddress {
                    return Tok::Bare(text);
                }
                let current = matches!(direct.area, Area::T | Area::C) && direct.width == Some(Width::Word);
                if current && self.place != Where::Assertion {
                    let plain = address::text(&address::without_width(direct));
                    let span = self.span(token.range());
                    self.report(
                        Diagnostic::new(Code::Tolerated, span, format!("the S7-200 does not use the form `{text}`"))
                            .label("read as the current value")
                            .help(format!(
                                "write `{plain}`; the instruction decides whether its bit or its value is meant"
                            )),
                    );
                }
                Tok::Direct(direct)
            }
            Some(Err(error)) => self.bad_address(token, text, &error),
            None if text.contains('.') => self.bad_address(token, text, &AddressError::Number),
            None => Tok::Bare(text),
        }
    }

    fn bad_address(&mut self, token: RawToken, text: &str, error: &AddressError) -> Tok<'a> {
        let (label, help) = match error {
            AddressError::Bit => ("its bit is not 0 to 7", "a byte has the bits 0 to 7: `I0.7`, then `I1.0`"),
            AddressError::Number => ("no area has this address", "addresses are `I0.0`, `VB10`, `VW100`, `T37`, `AC0`"),
            AddressError::BitOfWord => {
                ("a byte, word, double word or number does not have a bit here", "name the bit by its byte: `V10.3`")
            }
            AddressError::DataBlock => ("not data block 1", "the S7-200 has one data block: `DB1.DBW100` is `VW100`"),
        };
        let own = match error {
            AddressError::Bit => next_bit(text),
            AddressError::BitOfWord => bit_of_cell(text)
                .map(|cell| format!("write `{cell}`: the bit of a timer or counter has no number"))
                .or_else(|| bit_of_byte(text).map(|bit| format!("name the bit by its byte: `{bit}`"))),
            AddressError::Number => address::with_zeros(text)
                .map(|address| format!("write the digit 0 in place of the letter O: `{address}`"))
                .or_else(|| {
                    let cell = bit_of_cell(text)?;
                    Some(format!("write `{cell}`; the instruction decides whether its bit or its value is meant"))
                }),
            AddressError::DataBlock => None,
        };
        let help = own.unwrap_or_else(|| help.to_owned());
        let span = self.span(token.range());
        let title = format!("`{text}` is not an address of the S7-200");
        self.report(Diagnostic::new(Code::AddressRange, span, title).label(label).help(help));
        Tok::BadOperand
    }
}

/// What `I0.8` may mean.
fn next_bit(text: &str) -> Option<String> {
    let (place, bit) = text.rsplit_once('.')?;
    let letters = place.trim_end_matches(|c: char| c.is_ascii_digit());
    let (byte, bit) = (place[letters.len()..].parse::<u32>().ok()?, bit.parse::<u32>().ok()?);
    let next = format!("{letters}{}.{}", byte.checked_add(bit / 8)?, bit % 8);
    Some(format!("is `{next}` meant, the bit after those of the byte, or another bit from 0 to 7?"))
}

/// `T37` for `T37.0`.
fn bit_of_cell(text: &str) -> Option<&str> {
    let (cell, _) = text.rsplit_once('.')?;
    let direct = address::parse(&cell.to_ascii_uppercase())?.ok()?;
    matches!(direct.area, Area::T | Area::C).then_some(cell)
}

/// `V10.3` for `VB10.3`.
fn bit_of_byte(text: &str) -> Option<String> {
    let (letters, number) = text.split_at(text.find(|c: char| c.is_ascii_digit())?);
    let address = format!("{}{number}", letters.strip_suffix(['B', 'W', 'D', 'b', 'w', 'd'])?);
    matches!(address::parse(&address.to_ascii_uppercase()), Some(Ok(_))).then_some(address)
}
