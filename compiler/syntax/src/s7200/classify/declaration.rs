//! Declarations of variables, and lines of a data block.

use plcc_diag::{Code, Diagnostic};

use super::{Classifier, Where, operand};
use crate::Elementary;
use crate::s7200::raw::{RawKind, RawToken};
use crate::s7200::token::Tok;

impl Classifier<'_, '_> {
    pub(super) fn declaration(&mut self, code: &[RawToken]) {
        let start = code.first().map_or(self.end, |token| token.range().start);
        self.push(start..start, Tok::Declaration);
        self.place = Where::Declaration;
        self.without_semicolon(code);
        // `list:ARRAY[1..5] OF INT;`: the type is reported, and what follows it is a part of it.
        let is_array = |ty: &RawToken| ty.text(self.text).eq_ignore_ascii_case("ARRAY");
        let code = match code {
            [_, colon, ty, ..] if colon.kind == RawKind::Colon && is_array(ty) => &code[..3],
            _ => code,
        };
        if !self.without_colon(code) {
            self.operands(code);
        }
        self.place = Where::Statement;
    }

    /// Reports a declaration that is complete but for its `;`.
    fn without_semicolon(&mut self, code: &[RawToken]) {
        let [.., name, colon, ty] = code else { return };
        if (name.kind, colon.kind, ty.kind) != (RawKind::Word, RawKind::Colon, RawKind::Word) {
            return;
        }
        let declaration = self.slice(name.range().start..ty.range().end);
        self.report(
            Diagnostic::new(Code::DeclarationSyntax, self.span(ty.range()), "the declaration does not end with `;`")
                .label("`;` is missing after this")
                .help(format!("write `{declaration};`")),
        );
    }

    /// `speed INT;`, read as `speed:INT;`.
    fn without_colon(&mut self, code: &[RawToken]) -> bool {
        let [name, ty, ..] = code else { return false };
        let is_type = Elementary::from_word(&ty.text(self.text).to_ascii_uppercase()).is_some();
        if name.kind != RawKind::Word || ty.kind != RawKind::Word || !is_type {
            return false;
        }
        let (name_text, ty_text) = (name.text(self.text), ty.text(self.text));
        let title = format!("`:` is missing between `{name_text}` and its type");
        self.report(
            Diagnostic::new(Code::DeclarationSyntax, self.span(ty.range()), title)
                .label("the type")
                .help(format!("write `{name_text}:{ty_text};`")),
        );
        self.operands(&code[..1]);
        let end = name.range().end;
        self.push(end..end, Tok::Colon);
        self.operands(&code[1..]);
        true
    }

    pub(super) fn data(&mut self, code: &[RawToken]) {
        let Some(first) = code.first() else { return };
        let addressed = match (first.kind, code.get(1)) {
            (RawKind::Word, next) => {
                let constant = operand::is_bool(&first.text(self.text).to_ascii_uppercase());
                !constant || next.is_some_and(|next| !matches!(next.kind, RawKind::Comma | RawKind::Semicolon))
            }
            (RawKind::Quoted, Some(next)) => !matches!(next.kind, RawKind::Comma | RawKind::Semicolon),
            _ => false,
        };
        let start = first.range().start;
        self.push(start..start, Tok::Data(addressed));
        let (address, mut values) = code.split_at(usize::from(addressed));
        if addressed
            && let [sign, rest @ ..] = values
            && matches!(sign.text(self.text), ":=" | "=")
            && let Some(last) = rest.last()
        {
            let value = self.slice(rest[0].range().start..last.range().end);
            let title = format!("a line of a data block has no `{}`", sign.text(self.text));
            self.report(
                Diagnostic::new(Code::ForeignForm, self.span(sign.range()), title)
                    .label("a form of other languages")
                    .help(format!("write `{} {value}`", first.text(self.text))),
            );
            values = rest;
        }
        self.place = Where::DataAddress;
        self.operands(address);
        self.place = Where::DataValue;
        self.operands(values);
        self.place = Where::Statement;
    }
}
