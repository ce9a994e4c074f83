//! Text among the statements that is not STL: statements of SCL, prose, declarations after BEGIN.

use plcc_diag::{Code, Diagnostic, Span};

use super::{Classifier, is_end_of_block, is_section, unquoted};
use crate::ast::{Area, Width};
use crate::stl::raw::{RawKind, RawToken};
use crate::stl::token::Tok;
use crate::stl::{OperandClass, StlInsn, messages, mnemonics, suggest};

impl<'a> Classifier<'a, '_> {
    /// Whether `name.part[1] :=` follows.
    pub(super) fn assigns_path(&self) -> bool {
        let mut before = RawKind::Dot;
        for index in self.at.. {
            let Some(token) = self.raw_at(index) else { return false };
            let first = index == self.at;
            let fits = match token.kind {
                RawKind::Assign => return !first,
                RawKind::Hash => first,
                RawKind::Word | RawKind::Quoted => {
                    matches!(before, RawKind::Dot | RawKind::Hash | RawKind::LeftBracket | RawKind::Comma)
                }
                RawKind::Dot | RawKind::LeftBracket => {
                    matches!(before, RawKind::Word | RawKind::Quoted | RawKind::RightBracket) && !first
                }
                RawKind::Number => matches!(before, RawKind::LeftBracket | RawKind::Comma) && !first,
                RawKind::Comma | RawKind::RightBracket => matches!(before, RawKind::Number | RawKind::Word) && !first,
                _ => false,
            };
            if !fits || !first && token.first_on_line {
                return false;
            }
            before = token.kind;
        }
        false
    }

    /// SCL in a statement list: reported once, the rest of the block is skipped.
    pub(super) fn foreign(&mut self) {
        let token = self.raw[self.at];
        let assign = (self.at + 1..self.raw.len())
            .take_while(|index| !self.raw[*index].first_on_line)
            .find(|index| self.raw[*index].kind == RawKind::Assign);
        let end = assign.map_or(token, |assign| self.raw[assign]).end;
        let span = self.span_of(token.start as usize, end as usize);
        let word = &self.text[span.range()];
        let help =
            "write the block in one language: in STL, `A`, `JC` and labels replace IF, and `L` and `T` replace `:=`";
        self.report(
            Diagnostic::new(Code::ForeignLanguage, span, format!("`{word}` begins a statement of SCL, not of STL"))
                .label("the rest of this block is not checked")
                .help(suggest::in_set(help, self.set)),
        );
        let start = token.start as usize;
        self.end_of_label();
        while let Some(token) = self.peek() {
            let upper = self.upper(self.at);
            if is_end_of_block(upper.as_str()) || token.first_on_line && self.block_keyword(self.at).is_some() {
                break;
            }
            self.at += 1;
        }
        // Pragmas in what was skipped are not read.
        let before = self.peek().map_or(u32::MAX, |token| token.start);
        while self.next_pragma(before).is_some() {
            self.skip_pragma();
        }
        let end = self.last_end();
        self.push(start, Tok::BadStatement, end);
        self.push(end, Tok::End, end);
    }

    /// A statement that does not begin with an instruction.
    pub(super) fn no_instruction(&mut self, token: RawToken) {
        let span = self.span(token);
        let slice = self.slice(token);
        let index = self.at;
        let upper = self.upper(index);
        if self.call_without_word(token) {
            return;
        }
        match token.kind {
            RawKind::Word if is_section(upper.as_str()) || upper.as_str() == "END_VAR" => {
                self.report(
                    Diagnostic::new(Code::BlockFrame, span, "declarations must come before the statements")
                        .label("the code has begun already")
                        .help("move the declarations between the header and `BEGIN`"),
                );
                match upper.as_str() {
                    "END_VAR" => self.skip_section(),
                    _ => self.section_after_begin(),
                }
            }
            RawKind::Word if upper.as_str() == "BEGIN" => {
                self.report(
                    Diagnostic::new(Code::BlockFrame, span, "`BEGIN` must come before the code")
                        .label("no header before it")
                        .help("write `BEGIN` once in a block, after its declarations"),
                );
                self.at += 1;
            }
            RawKind::Word
                if let Some((label, after)) = self.label_with_sign(index)
                    && self.kind_at(after) == Some(RawKind::Colon) =>
            {
                let meant = suggest::label(label);
                self.wrong_label(token, label, "a label has letters, digits and `_`", &meant);
                self.take_up_to(Tok::Label(label), after + 1);
            }
            RawKind::Word | RawKind::Quoted if let Some((target, help)) = self.assignment(index) => {
                self.report(
                    Diagnostic::new(Code::ForeignForm, target, "a statement begins with an instruction")
                        .label("a form of other languages")
                        .help(help),
                );
                self.bad_statement();
            }
            RawKind::Quoted if self.kind_at(index + 1) == Some(RawKind::Colon) => {
                let label = unquoted(slice);
                self.report(
                    Diagnostic::new(Code::Syntax, span, format!("`{slice}` is not a label"))
                        .label("a label has no quotes")
                        .help(format!("write `{}:`", suggest::label(label))),
                );
                self.end_of_label();
                self.take_up_to(Tok::Label(label), index + 2);
            }
            RawKind::Word => {
                // `SDT T 1`: no statement transfers to a number, so `T` is the letter of a timer.
                let is_timer =
                    self.upper(index + 1).as_str() == "T" && self.kind_at(index + 2) == Some(RawKind::Number);
                let label = self.raw_at(index + 1).is_some_and(|next| !next.first_on_line)
                    && !is_timer
                    && self.kind_at(index + 1) == Some(RawKind::Word)
                    && self.begins_statement(index + 1)
                    && !suggest::is_known(upper.as_str());
                if label {
                    self.report(
                        Diagnostic::new(Code::Syntax, span, format!("`:` is missing after the label `{slice}`"))
                            .label("read as a label")
                            .help(format!("write `{slice}:`")),
                    );
                    self.end_of_label();
                    return self.take_up_to(Tok::Label(slice), index + 1);
                }
                // `m001; A I 0.0`
                let ends_wrong = self.kind_at(index + 1) == Some(RawKind::Semicolon)
                    && self.raw_at(index + 2).is_some_and(|next| !next.first_on_line && next.kind == RawKind::Word)
                    && self.begins_statement(index + 2)
                    && !suggest::is_known(upper.as_str());
                if ends_wrong && token.first_on_line {
                    self.report(
                        Diagnostic::new(Code::Syntax, span, format!("the label `{slice}` ends with `:`, not with `;`"))
                            .label("read as a label")
                            .help(format!("write `{slice}:`")),
                    );
                    self.end_of_label();
                    return self.take_up_to(Tok::Label(slice), index + 2);
                }
                // `; text`, as assemblers of other machines write a comment.
                let is_comment = !token.first_on_line
                    && !suggest::is_known(upper.as_str())
                    && self.kind_at(index + 1) != Some(RawKind::Semicolon)
                    && index.checked_sub(1).and_then(|before| self.kind_at(before)) == Some(RawKind::Semicolon);
                let follows = if self.ends_before(index + 1) { "" } else { self.rest_of_statement(index + 1) };
                let help = match is_comment {
                    true => format!("a comment begins with `//`: write `// {slice} …`"),
                    false => suggest::instruction(upper.as_str(), slice, follows, self.set),
                };
                self.report(
                    Diagnostic::new(Code::UnknownInstruction, span, format!("STL has no instruction `{slice}`"))
                        .label(format!("not a mnemonic of the {} set", messages::set_name(self.set)))
                        .help(help),
                );
                self.bad_statement();
            }
            RawKind::Stray | RawKind::UnterminatedText | RawKind::UnterminatedQuoted => {
                self.stray();
                self.out.pop();
                self.at = index;
                self.bad_statement();
            }
            _ if let Some((label, after)) = self.label_with_digit(index) => {
                self.wrong_label(token, label, "a label begins with a letter", &format!("m{label}"));
                self.take_up_to(Tok::Label(label), after);
            }
            _ => {
                let compares = matches!(slice, ">" | "<" | ">=" | "<=" | "==" | "<>");
                let message = Diagnostic::new(Code::Syntax, span, format!("`{slice}` cannot begin a statement"));
                self.report(match slice {
                    _ if compares => {
                        let load = StlInsn::Load.mnemonic(self.set);
                        let operand = if self.ends_before(index + 1) { "" } else { self.rest_of_statement(index + 1) };
                        let is_bit = operand.starts_with(|c: char| c.is_ascii_alphabetic())
                            && matches!(operand.as_bytes(), [.., b'0'..=b'9', b'.', b'0'..=b'7']);
                        let first =
                            if operand.is_empty() { String::new() } else { format!("`{load} {operand}`, then ") };
                        message.label("the type of the values is missing").help(match slice {
                            "==" if is_bit => format!("write `= {operand}` for a bit"),
                            _ => format!("write {first}`{slice}I` for INT, `{slice}D` for DINT or `{slice}R` for REAL"),
                        })
                    }
                    ":=" => {
                        let operand = self.rest_of_statement(index + 1);
                        message
                            .label("assigns in calls and declarations")
                            .help(format!("write `= {operand}` for a bit, `T {operand}` for a value"))
                    }
                    _ if let Some((title, label, help)) = self.sign_of_other_languages(index) => {
                        Diagnostic::new(Code::ForeignForm, span, title).label(label).help(help)
                    }
                    _ => message
                        .label("an instruction is expected here")
                        .help("a statement is a mnemonic and its operand, e.g. `L MW 10`"),
                });
                self.bad_statement();
            }
        }
    }

    /// `#timer (IN := #start)`, `"Motor" (…)`: a call without its word; its parameters are not read.
    fn call_without_word(&mut self, first: RawToken) -> bool {
        const TOKENS_MAX: usize = 400;
        let name = self.at + usize::from(first.kind == RawKind::Hash);
        let is_name = matches!(self.kind_at(name), Some(RawKind::Word | RawKind::Quoted));
        let is_call = first.kind != RawKind::Word
            && is_name
            && self.kind_at(name + 1) == Some(RawKind::LeftParen)
            && matches!(self.kind_at(name + 2), Some(RawKind::Word | RawKind::Quoted))
            && self.kind_at(name + 3) == Some(RawKind::Assign);
        let mut rest = self.raw.iter().enumerate().skip(name + 2).take(TOKENS_MAX);
        let Some((close, _)) = rest.find(|(_, token)| token.kind == RawKind::RightParen).filter(|_| is_call) else {
            return false;
        };
        let (start, end) = (first.start as usize, self.raw[name].end as usize);
        let block = &self.text[start..end];
        self.report(
            Diagnostic::new(Code::Syntax, self.span_of(start, end), format!("`CALL` is missing before `{block}`"))
                .label("a call of other languages")
                .help(format!("write `CALL {block} (…)`")),
        );
        self.at = close + 1;
        let end = self.last_end();
        self.push(start, Tok::BadStatement, end);
        self.end_statement();
        true
    }

    /// `MW 2 := 5`, `Q 0.0 = I 0.0`, `"lamp" = #on` at `index`: what is assigned to, and the statements that are meant.
    fn assignment(&self, index: usize) -> Option<(Span, String)> {
        const TOKENS_MAX: usize = 3;
        let first = self.raw_at(index)?;
        let sign = (index + 1..=index + TOKENS_MAX)
            .take_while(|at| self.raw_at(*at).is_some_and(|token| !token.first_on_line))
            .find(|at| matches!(self.kind_at(*at), Some(RawKind::Assign | RawKind::Equal)))
            .filter(|sign| !self.ends_before(sign + 1))?;
        // `MW 2 += 1` and `Q 0.0; = Q 0.1` are something else.
        let before = self.raw_at(sign - 1)?;
        if !matches!(before.kind, RawKind::Word | RawKind::Quoted | RawKind::Number | RawKind::Real) {
            return None;
        }
        let span = self.span_of(first.start as usize, before.end as usize);
        let target = &self.text[span.range()];
        if first.kind == RawKind::Quoted {
            let whole = sign == index + 1;
            return whole.then(|| (span, self.assigned(target, sign + 1, None)));
        }
        let upper = self.upper(index);
        let (letters, digits) = mnemonics::letters_and_digits(upper.as_str());
        let (area, width) = mnemonics::area(letters, Some(self.set))?;
        let has_number = !digits.is_empty() || matches!(self.kind_at(index + 1), Some(RawKind::Number | RawKind::Real));
        // `I 0.0 = Q 0.0`: only the first instruction is missing.
        if !has_number || matches!(area, Area::I | Area::Pi) {
            return None;
        }
        Some((span, self.assigned(target, sign + 1, Some(width == Width::Bit))))
    }

    /// What to write to assign the value from the token at `value` on to `target`; `is_bit`: none if it may be a bit or a number.
    fn assigned(&self, target: &str, value: usize, is_bit: Option<bool>) -> String {
        let name = |insn: StlInsn| insn.mnemonic(self.set);
        let is_calculated = (value..).take_while(|at| !self.ends_before(*at)).any(|at| {
            let is_word = matches!(self.upper(at).as_str(), "NOT" | "AND" | "OR" | "XOR" | "MOD" | "DIV");
            let sign = self.raw_at(at).map_or("", |token| self.slice(token));
            let is_sign = matches!(sign, "(" | "+" | "*" | "/" | "=" | "==" | "<>" | "<" | ">" | "<=" | ">=");
            is_word || is_sign || sign == "-" && at > value
        });
        let text = self.rest_of_statement(value);
        let upper = text.to_ascii_uppercase();
        let (condition, number) = match upper.as_str() {
            _ if is_calculated => {
                ("the statements of the condition".to_owned(), "the statements that calculate the value".to_owned())
            }
            "TRUE" | "1" => (format!("`{}`", name(StlInsn::SetRlo)), format!("`{} 1`", name(StlInsn::Load))),
            "FALSE" | "0" => (format!("`{}`", name(StlInsn::ClearRlo)), format!("`{} 0`", name(StlInsn::Load))),
            _ => (format!("`{} {text}`", name(StlInsn::And)), format!("`{} {text}`", name(StlInsn::Load))),
        };
        let bits = format!("{condition} and `{} {target}`", name(StlInsn::Assign));
        let numbers = format!("{number} and `{} {target}`", name(StlInsn::Transfer));
        let is_number = text.starts_with(|c: char| c.is_ascii_digit() || c == '-') && !matches!(text, "0" | "1");
        match is_bit {
            Some(true) => format!("write {bits}"),
            None if matches!(upper.as_str(), "TRUE" | "FALSE") => format!("write {bits}"),
            Some(false) => format!("write {numbers}"),
            None if is_number && !is_calculated => format!("write {numbers}"),
            None => format!("write {bits} for bits, {numbers} for numbers"),
        }
    }

    /// Reports a name before `:` that is not a label; `token`: where it begins.
    fn wrong_label(&mut self, token: RawToken, name: &str, rule: &str, meant: &str) {
        let start = token.start as usize;
        let span = self.span_of(start, start + name.len());
        self.report(
            Diagnostic::new(Code::Syntax, span, format!("`{name}` is not a label"))
                .label(rule)
                .help(format!("write another label, such as `{meant}:`, here and in the jumps to it")),
        );
        self.end_of_label();
    }

    /// `lab-1`, `lab.1`, `lab 1` at `index`, with the index after it.
    pub(super) fn label_with_sign(&self, index: usize) -> Option<(&'a str, usize)> {
        let first = self.raw_at(index).filter(|token| token.kind == RawKind::Word)?;
        let part = |at: usize| matches!(self.kind_at(at), Some(RawKind::Word | RawKind::Number));
        let mut after = index + 1;
        while matches!(self.kind_at(after), Some(RawKind::Minus | RawKind::Dot))
            && part(after + 1)
            && self.adjacent(after - 1)
            && self.adjacent(after)
        {
            after += 2;
        }
        let number = self.raw_at(after).filter(|token| token.kind == RawKind::Number && !token.first_on_line);
        if after == index + 1 && number.is_some() {
            after += 1;
        }
        let last = self.raw_at(after - 1).filter(|_| after > index + 1)?;
        Some((&self.text[first.start as usize..last.end as usize], after))
    }

    /// `1lab` of `1lab:` at `index`, and `1` of `1:` if a statement jumps there, with the index after the colon.
    fn label_with_digit(&self, index: usize) -> Option<(&'a str, usize)> {
        let (number, next) = (self.raw_at(index)?, self.raw_at(index + 1)?);
        if number.kind != RawKind::Number {
            return None;
        }
        if next.kind == RawKind::Colon {
            let label = self.slice(number);
            return self.jumps_to_number(label).then_some((label, index + 2));
        }
        let word = next.kind == RawKind::Word && number.end == next.start;
        let ends = self.kind_at(index + 2) == Some(RawKind::Colon);
        (word && ends).then(|| (&self.text[number.start as usize..next.end as usize], index + 3))
    }

    /// Whether a jump has the number as its operand.
    fn jumps_to_number(&self, number: &str) -> bool {
        self.near_here().any(|index| {
            let is_jump = |word: usize| {
                self.lookup(self.upper(word).as_str()).is_some_and(|insn| insn.operand() == OperandClass::Label)
            };
            self.is_number(index, number) && index.checked_sub(1).is_some_and(is_jump)
        })
    }

    /// Whether the number stands as a label before a statement.
    pub(super) fn is_number_label(&self, number: &str) -> bool {
        self.near_here().any(|index| {
            let first = self.raw_at(index).is_some_and(|token| token.first_on_line);
            first && self.kind_at(index + 1) == Some(RawKind::Colon) && self.is_number(index, number)
        })
    }

    fn is_number(&self, index: usize, number: &str) -> bool {
        self.raw_at(index).is_some_and(|token| token.kind == RawKind::Number && self.slice(token) == number)
    }

    /// The raw tokens around the next one among which a label is looked for.
    fn near_here(&self) -> std::ops::Range<usize> {
        const LOOK_MAX: usize = 2000;
        self.at.saturating_sub(LOOK_MAX)..self.raw.len().min(self.at + LOOK_MAX)
    }

    /// `DB10.values(3)` for an element, whose index is read as if it was in brackets. `start`: where the operand begins.
    pub(super) fn index_in_parentheses(&mut self, opening: RawToken, start: usize) -> bool {
        const INDEX_MAX: usize = 20;
        let named = matches!(self.last(), Some(Tok::Name(_) | Tok::Local(_) | Tok::Quoted(_)));
        let is_index = |index: &usize| {
            self.raw_at(*index).is_some_and(|token| {
                !token.first_on_line && matches!(token.kind, RawKind::Number | RawKind::Comma | RawKind::Minus)
            })
        };
        let count = (self.at + 1..).take(INDEX_MAX).take_while(is_index).count();
        let close = self.at + 1 + count;
        let Some(end) = self.raw_at(close).filter(|token| token.kind == RawKind::RightParen && count > 0) else {
            return false;
        };
        let open = opening.start as usize;
        if !named || self.last_end() != open {
            return false;
        }
        let (array, index) = (&self.text[start..open], &self.text[opening.end as usize..end.start as usize]);
        self.report(
            Diagnostic::new(
                Code::ForeignForm,
                self.span_of(open, end.end as usize),
                "the index of an element is in brackets",
            )
            .label("read as `[…]`")
            .help(format!("write `{array}[{}]`", index.trim())),
        );
        self.take(Tok::LeftBracket);
        while self.at < close {
            self.operand_token();
        }
        if self.at == close {
            self.take(Tok::RightBracket);
        }
        true
    }

    /// `- 5`, `*`, `#o = #a`, `# text`, `-- text`: title, label and help.
    fn sign_of_other_languages(&self, index: usize) -> Option<(String, &'static str, String)> {
        let token = *self.raw.get(index)?;
        let sign = self.slice(token);
        let next = self.raw.get(index + 1).filter(|next| !next.first_on_line);
        let adjacent = next.is_some_and(|next| next.start == token.end);
        let rest = self.rest_of_statement(index + 1);
        let comment = |text: &str| {
            let help = format!("write `// {}`", text.trim_start_matches(['#', '-']).trim());
            Some(("a comment begins with `//`".to_owned(), "a form of other languages", help))
        };
        match (sign, next) {
            ("#", Some(_)) if !adjacent => comment(rest),
            ("#", Some(name)) if let Some(help) = self.counted(*name, rest) => {
                Some(("a statement begins with an instruction".to_owned(), "a form of other languages", help))
            }
            ("#", Some(name)) => {
                let sign =
                    self.raw_at(index + 2).filter(|_| !self.ends_before(index + 2) && !self.ends_before(index + 3))?;
                matches!(self.slice(sign), "=" | "==").then(|| {
                    let target = format!("#{}", self.slice(*name));
                    (
                        "a statement begins with an instruction".to_owned(),
                        "a form of other languages",
                        self.assigned(&target, index + 3, None),
                    )
                })
            }
            ("-", Some(next)) if self.slice(*next) == "-" => comment(rest),
            ("-", Some(next)) if next.kind == RawKind::Number => Some((
                "a constant is subtracted by adding its negative".to_owned(),
                "the type of the values is missing",
                format!("write `+ -{rest}`"),
            )),
            ("-" | "*" | "/", _) => Some((
                format!("`{sign}` does not say of which type the values are"),
                "the type of the values is missing",
                format!("write `{sign}I` for INT, `{sign}D` for DINT or `{sign}R` for REAL"),
            )),
            _ => None,
        }
    }

    /// `#o += 1`, `#o =+ 1`, `#o++`: what to write for the statement that begins with `name`, whose text is `rest`.
    fn counted(&self, name: RawToken, rest: &str) -> Option<String> {
        let name = self.slice(name);
        let change = rest.strip_prefix(name)?.trim();
        let (sign, value) = match change {
            "++" => ("+", "1"),
            "--" => ("-", "1"),
            _ => {
                let signs = [("+=", "+"), ("=+", "+"), ("-=", "-"), ("*=", "*"), ("/=", "/")];
                signs.iter().find_map(|(sign, meant)| Some((*meant, change.strip_prefix(sign)?.trim())))?
            }
        };
        let (load, transfer) = (StlInsn::Load.mnemonic(self.set), StlInsn::Transfer.mnemonic(self.set));
        let calculation = format!("`{sign}I` for INT, `{sign}D` for DINT or `{sign}R` for REAL");
        (!value.is_empty())
            .then(|| format!("write `{load} #{name}`, `{load} {value}`, {calculation}, and `{transfer} #{name}`"))
    }

    /// `L #a + #b`: what to write for the sign at the current token, if an operand is before and after it.
    pub(super) fn operator_between(&self, sign: &str) -> Option<String> {
        let after_operand = matches!(
            self.last(),
            Some(
                Tok::Local(_) | Tok::Quoted(_) | Tok::Name(_) | Tok::Literal(_) | Tok::Address(_) | Tok::BitAddress(..)
            )
        );
        let rest = self.rest_of_statement(self.at + 1);
        let compares = matches!(sign, ">" | "<" | ">=" | "<=" | "==" | "<>");
        let in_list = rest == "..." || rest.contains([')', ',']);
        if !after_operand || in_list || !compares && !matches!(sign, "+" | "-" | "*" | "/") {
            return None;
        }
        // `A #i > 5`: a contact does not load a value.
        let first = match self.out.iter().rev().find(|(_, token, _)| matches!(token, Tok::Insn(_))) {
            Some((_, Tok::Insn(insn), end))
                if matches!(insn.operand(), OperandClass::Bit | OperandClass::BitOrNone) =>
            {
                let operand = self.text.get(*end..self.raw.get(self.at)?.start as usize)?.trim();
                if operand.contains('\n') { String::new() } else { format!("`L {operand}` and ") }
            }
            _ => String::new(),
        };
        Some(match rest.split_once(' ') {
            // `>I #b`
            Some((ty @ ("I" | "D" | "R"), operand)) => {
                format!("write {first}`L {}` and `{sign}{ty}` in lines of their own", operand.trim())
            }
            _ => format!("write {first}`L {rest}`, then `{sign}I` for INT, `{sign}D` for DINT or `{sign}R` for REAL"),
        })
    }

    /// The text from the token at `index` to the end of its statement or line.
    fn rest_of_statement(&self, index: usize) -> &str {
        let rest = self.raw.get(index..).unwrap_or_default();
        let tokens = rest.iter().take_while(|token| !token.first_on_line && token.kind != RawKind::Semicolon);
        let Some(last) = tokens.last() else { return "..." };
        self.text.get(rest[0].start as usize..last.end as usize).unwrap_or_default()
    }

    /// Whether a statement ends before the token at `index`.
    pub(super) fn ends_before(&self, index: usize) -> bool {
        self.raw_at(index).is_none_or(|token| token.first_on_line || token.kind == RawKind::Semicolon)
    }

    /// Skips declarations in code, up to END_VAR.
    pub(super) fn skip_section(&mut self) {
        self.end_of_label();
        while let Some(token) = self.peek() {
            let upper = self.upper(self.at);
            if upper.as_str() == "END_VAR" {
                self.at += 1;
                return;
            }
            if is_end_of_block(upper.as_str())
                || upper.as_str() == "NETWORK"
                || token.first_on_line && self.block_keyword(self.at).is_some()
            {
                return;
            }
            self.at += 1;
        }
    }
}
