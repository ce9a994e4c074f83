//! Types in declarations.

use plcc_diag::Span;
use plcc_syntax::ast::{BlockName, Bound, TypeKind, TypeRef};

use crate::scl::expression;
use crate::writer::{Notation, Writer};
use crate::xml::cased;
use crate::{names, operand};

impl Writer<'_> {
    /// A type; of a structure only `STRUCT`, with the dimensions of an array of structures.
    pub(crate) fn type_text(&mut self, ty: &TypeRef) -> String {
        match &ty.kind {
            TypeKind::Named(name) => self.named_type(ty, name),
            TypeKind::String(None) => self.type_word(ty, "String"),
            TypeKind::String(Some(length)) => format!("{}[{}]", self.type_word(ty, "String"), self.bound(length)),
            TypeKind::WideString(None) => self.type_word(ty, "WString"),
            TypeKind::WideString(Some(length)) => format!("{}[{}]", self.type_word(ty, "WString"), self.bound(length)),
            TypeKind::Array { bounds, element } => {
                let list: Vec<String> =
                    bounds.iter().map(|(low, high)| format!("{}..{}", self.bound(low), self.bound(high))).collect();
                self.array_text(ty, &list.join(", "), element)
            }
            TypeKind::OpenArray { dimensions, element } => {
                self.needs_scl(ty.span, "an array without bounds");
                let stars = vec!["*"; usize::from(*dimensions)].join(", ");
                self.array_text(ty, &stars, element)
            }
            TypeKind::Reference(target) => {
                self.needs_scl(ty.span, "a reference");
                format!("REF_TO {}", self.type_text(target))
            }
            TypeKind::Struct(_) => match self.written_word(ty, "STRUCT") {
                Some(own) => own.to_string(),
                None => "STRUCT".to_string(),
            },
            TypeKind::Block(name) => {
                let text = self.source.and_then(|source| source.get(ty.span.range())).map(str::trim);
                let own = text.filter(|text| match (text.strip_prefix("_."), name) {
                    // `_.Valve`
                    (Some(own), BlockName::Symbol { name, .. }) => own.trim_matches('"') == name,
                    // `Unit.Namespace.Valve`
                    (None, BlockName::Symbol { name, .. }) => self.braces.is_some() && *text == name,
                    (_, BlockName::Numbered { .. }) => false,
                });
                let own = own.filter(|_| self.notation == Notation::Sd);
                own.map_or_else(|| self.block_name(name), str::to_string)
            }
            TypeKind::Error => {
                self.refuse(ty.span, "a type that was not understood", "repair the source first");
                String::new()
            }
        }
    }

    fn array_text(&mut self, ty: &TypeRef, bounds: &str, element: &TypeRef) -> String {
        let array = self.type_word(ty, "Array");
        let of = if array.starts_with("AR") { "OF" } else { "of" };
        format!("{array}[{bounds}] {of} {}", self.type_text(element))
    }

    /// The name of a type: as the author wrote it, otherwise in the letters of the TIA Portal where it is for that.
    fn named_type(&self, ty: &TypeRef, name: &str) -> String {
        let keeps = matches!(self.notation, Notation::Sd | Notation::Scl);
        let text = self.source.filter(|_| keeps).and_then(|source| source.get(ty.span.range())).map(str::trim);
        let own = text.filter(|text| text.eq_ignore_ascii_case(name)).map(str::to_string);
        own.unwrap_or_else(|| if self.is_of_portal() { cased(name) } else { name.to_string() })
    }

    /// A word with which a type begins, likewise.
    fn type_word(&self, ty: &TypeRef, word: &str) -> String {
        match self.written_word(ty, word) {
            Some(own) => own.to_string(),
            None if self.is_of_portal() => word.to_string(),
            None => word.to_ascii_uppercase(),
        }
    }

    /// The word with which a type begins in a source in SCL.
    fn written_word(&self, ty: &TypeRef, word: &str) -> Option<&str> {
        let own = self.scl_from(ty.span.start)?.get(..word.len())?;
        own.eq_ignore_ascii_case(word).then_some(own)
    }

    /// The source from a byte on, if it is a text in SCL.
    fn scl_from(&self, at: u32) -> Option<&str> {
        let source = self.source.filter(|_| self.notation == Notation::Scl && !self.quotes_words)?;
        source.get(at as usize..)
    }

    /// The type of a function without a value, whose name ends at a byte.
    pub(super) fn void(&self, at: u32) -> &str {
        let rest = self.scl_from(at).and_then(|rest| rest.trim_start().strip_prefix(':')).map(str::trim_start);
        let own = rest.and_then(|rest| rest.get(..4)).filter(|own| own.eq_ignore_ascii_case("VOID"));
        own.unwrap_or("VOID")
    }

    /// Whether types have the letters of the TIA Portal.
    fn is_of_portal(&self) -> bool {
        self.notation == Notation::Sd || self.notation == Notation::Scl && self.quotes_words
    }

    pub(crate) fn bound(&mut self, bound: &Bound) -> String {
        match bound {
            Bound::Number(number, _) => number.to_string(),
            Bound::Name(name, _) if self.notation == Notation::Stl => names::declared(name),
            Bound::Name(name, _) => names::bare(name),
            Bound::Expr(value) => {
                self.needs_scl(value.span, "an expression as a bound");
                expression::text(value, self)
            }
            Bound::Path(path) => operand::path_text(path, self),
        }
    }

    pub(super) fn needs_scl(&mut self, span: Span, what: &str) {
        if self.notation == Notation::Stl {
            self.refuse(
                span,
                format!("STL has no word for {what}"),
                "declare it in another way, or leave the block in its language",
            );
        }
    }
}
