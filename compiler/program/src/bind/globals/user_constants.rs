//! User constants of tag tables. They share one name space with tags and blocks, in which upper and lower case are the same.
//!
//! Source: TIA Portal help, rules for the names of PLC tags.

use std::collections::hash_map::Entry;

use plcc_binding::constant::{Constant, Constants};
use plcc_binding::fold;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::types::Elementary;
use plcc_syntax::article::with_article;
use plcc_syntax::ast::BlockPrefix;
use plcc_syntax::symbols::SymbolTarget;
use rustc_hash::FxHashMap;

use crate::bind::globals::Globals;

impl Globals<'_> {
    /// Reads the constants with their types. Several tables may have the same one.
    pub fn collect_constants(&mut self) {
        let input = self.input;
        let mut rows: FxHashMap<String, Span> = FxHashMap::default();
        for constant in input.tables.iter().flat_map(|table| &table.constants) {
            let Some(value) = self.constant(&Constants::default(), &constant.value) else { continue };
            let value = match Elementary::from_word(&constant.ty.to_ascii_uppercase()) {
                Some(ty) => match self.constant_bits(&value, ty, constant.value.span) {
                    Some(bits) => Constant::Typed { ty, bits },
                    None => continue,
                },
                None => value,
            };
            let folded = fold(&constant.name);
            let first = *rows.entry(folded.clone()).or_insert(constant.span);
            match self.names.constants.entry(folded) {
                Entry::Vacant(entry) => _ = entry.insert(value),
                Entry::Occupied(entry) if *entry.get() == value => {}
                Entry::Occupied(_) => self.report.push(
                    Diagnostic::new(
                        Code::DuplicateName,
                        constant.span,
                        format!("the constant `{}` has two values", constant.name),
                    )
                    .label("the second value")
                    .also(first, "the first value, which is used")
                    .help("remove one of the two rows"),
                ),
            }
        }
    }

    /// Reports constants that have the name of a tag or of a block. Those are what the name means, except where it is spelt as only the
    /// constant is.
    pub fn constants_named_as_others(&mut self) {
        let input = self.input;
        for constant in input.tables.iter().flat_map(|table| &table.constants) {
            let folded = fold(&constant.name);
            let Some(global) = self.names.symbols.get(&folded) else { continue };
            let kind = match global.target {
                SymbolTarget::Block { prefix: BlockPrefix::Udt, .. } => continue,
                SymbolTarget::Block { prefix, .. } => with_article(prefix.letters()),
                SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. } => "a tag".to_string(),
            };
            let title = format!("`{}` is the name of {kind} and of a constant", global.name);
            let is_same = constant.name == global.name;
            let spelling = if is_same { "" } else { "; upper and lower case are the same in names" };
            let message = Diagnostic::new(Code::DuplicateName, constant.span, title)
                .label(format!("a constant with this name{spelling}"))
                .also(global.span, kind)
                .help("give one of them another name, here and where it is used");
            if !is_same {
                self.names.confused.insert(folded, constant.name.clone());
            }
            self.report.push(message);
        }
    }
}
