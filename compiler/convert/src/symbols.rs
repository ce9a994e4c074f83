//! Symbol tables in the format `.sdf`.

use std::fmt::Write;

use plcc_diag::{Code, Diagnostic, FileId, Severity};
use plcc_syntax::ast::Width;
use plcc_syntax::stl::Mnemonics;
use plcc_syntax::symbols::{Symbol, SymbolTable, SymbolTarget};

use crate::operand;

/// The variables with addresses that file `file` has, one in a line, and a warning for each that has no form there. `None`: no variable has an address.
pub fn write(file: FileId, tables: &[SymbolTable]) -> (Option<String>, Vec<Diagnostic>) {
    let (mut text, mut messages) = (String::new(), Vec::new());
    for symbol in tables.iter().flat_map(|table| &table.symbols).filter(|symbol| symbol.span.file == file) {
        let Some(address) = address(symbol) else {
            // The variable is there by its name and by its address.
            if messages.iter().any(|message: &Diagnostic| message.primary.span == symbol.span) {
                continue;
            }
            let title = format!("a symbol table has no address of 64 bits for `{}`", symbol.name);
            let mut message = Diagnostic::new(Code::NotConverted, symbol.span, title);
            message.severity = Severity::Warning;
            messages.push(message.label("is left out").help("declare it in a data block"));
            continue;
        };
        let _ = writeln!(text, "\"{}\",\"{address}\",\"{}\",\"{}\"", symbol.name, symbol.ty, symbol.comment);
    }
    (Some(text).filter(|text| !text.is_empty()), messages)
}

/// `MW 10`. `None`: an address of 64 bits.
fn address(symbol: &Symbol) -> Option<String> {
    match symbol.target {
        SymbolTarget::Memory { width: Width::Lword, .. } | SymbolTarget::Cell { .. } | SymbolTarget::Block { .. } => {
            None
        }
        SymbolTarget::Memory { area, width, byte, bit } => {
            let letters = operand::area_letters(area, width, Mnemonics::En);
            Some(format!("{letters} {}", operand::address(width, byte, bit)))
        }
    }
}
