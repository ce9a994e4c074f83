//! Symbol tables: names, addresses and types.

use std::collections::hash_map::Entry;

use plcc_diag::{Code, Diagnostic};
use plcc_syntax::article::with_article;
use plcc_syntax::ast::Width;

use crate::bind::globals::Globals;
use crate::bind::globals::names::Global;
use plcc_binding::fold;
use plcc_model::types::Elementary;
use plcc_syntax::symbols::{Symbol, SymbolTarget};

impl Globals<'_> {
    /// Reads the symbol tables; of two addresses of one name the first counts.
    pub(super) fn collect_tables(&mut self) {
        let rows: usize = self.input.tables.iter().map(|table| table.symbols.len()).sum();
        self.names.symbols.reserve(rows);
        for symbol in self.input.tables.iter().flat_map(|table| &table.symbols) {
            let ty = Elementary::from_word(&symbol.ty.to_ascii_uppercase());
            if let Some(fault) = ty.and_then(|ty| type_fault(symbol, ty)) {
                self.report.push(fault);
            }
            let structure = ty.is_none().then(|| symbol.ty.trim().trim_matches('"').to_string());
            let structure = structure.filter(|name| !name.is_empty());
            let target = target_of(symbol, ty);
            let (name, external) = (symbol.name.clone(), symbol.external);
            let global = Global { name, target, ty, structure, external, span: symbol.span };
            match self.names.symbols.entry(fold(&symbol.name)) {
                Entry::Vacant(entry) => {
                    entry.insert(global);
                }
                Entry::Occupied(entry) => {
                    if entry.get().target != target {
                        let first = entry.get().span;
                        self.report.push(
                            Diagnostic::new(
                                Code::DuplicateName,
                                symbol.span,
                                format!("the symbol `{}` has two addresses", symbol.name),
                            )
                            .label("the second address")
                            .also(first, "the first address, which is used")
                            .help("remove one of the two rows"),
                        );
                    }
                }
            }
        }
    }
}

/// The message about a row whose address has another width than its data type. Types of more than 32 bits are at the address of their first bit.
fn type_fault(symbol: &Symbol, ty: Elementary) -> Option<Diagnostic> {
    let SymbolTarget::Memory { area, width, byte, bit } = symbol.target else { return None };
    // Bytes and words that are too narrow are reported for tags of all kinds.
    let is_narrow = width != Width::Bit && ty.bits() > width.bits();
    let is_long = ty.bits() > 32;
    if is_long && bit == 0 || ty.bits() == width.bits() || is_narrow {
        return None;
    }
    let bits = |count: u32| if count == 1 { "one bit".to_owned() } else { format!("{count} bits") };
    let title = format!(
        "`{}` is {} of {} at an address of {}",
        symbol.name,
        with_article(ty.name()),
        bits(ty.bits()),
        bits(width.bits())
    );
    let help = if is_long {
        format!("write the address of its first bit, such as `{} {byte}.0`", area.letters())
    } else {
        let letters = area.letters();
        let address = match ty.bits() {
            1 => format!("{letters} {byte}.{bit}"),
            8 => format!("{letters}B {byte}"),
            16 => format!("{letters}W {byte}"),
            _ => format!("{letters}D {byte}"),
        };
        let own = match width {
            Width::Bit => "BOOL",
            Width::Byte => "BYTE",
            Width::Word => "WORD",
            Width::Dword => "DWORD",
            Width::Lword => "LWORD",
        };
        format!("write the address `{address}`, or the data type {own}")
    };
    Some(Diagnostic::new(Code::SymbolTable, symbol.span, title).label("the address counts").help(help))
}

/// What a symbol with this data type means: one of 64 bits has the address of its first bit.
fn target_of(symbol: &Symbol, ty: Option<Elementary>) -> SymbolTarget {
    match (symbol.target, ty) {
        (SymbolTarget::Memory { area, width: Width::Bit, byte, bit: 0 }, Some(ty)) if ty.bits() > 32 => {
            SymbolTarget::Memory { area, width: Width::Lword, byte, bit: 0 }
        }
        (target, _) => target,
    }
}
