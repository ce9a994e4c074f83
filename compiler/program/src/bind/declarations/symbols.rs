//! The named addresses of the program, for the flags of its executable.

use plcc_model::Symbol;
use plcc_model::layout;
use plcc_model::types::DataType;
use plcc_syntax::ast::{Area, BlockPrefix, CellKind, Width};
use plcc_syntax::symbols::SymbolTarget;

use crate::bind::declarations::{Declarations, State};
use crate::bind::globals::names::Global;

impl Declarations<'_> {
    /// Names of memory, timers, counters and DBs, sorted.
    pub fn symbols(&self) -> Vec<Symbol> {
        let mut symbols: Vec<Symbol> =
            self.globals.names.symbols.values().filter_map(|global| self.symbol(global)).collect();
        symbols.sort_by(|a, b| a.name.cmp(&b.name));
        symbols
    }

    fn symbol(&self, global: &Global) -> Option<Symbol> {
        let (address, ty) = match global.target {
            SymbolTarget::Memory { area, width, byte, bit } => {
                let own = global.ty.filter(|ty| layout::width(*ty) == width).map(DataType::Elementary);
                (address_text(area, width, byte, bit), self.structure_of(global).or(own))
            }
            SymbolTarget::Cell { kind: CellKind::Timer, number } => (format!("T{number}"), None),
            SymbolTarget::Cell { kind: CellKind::Counter, number } => (format!("C{number}"), None),
            SymbolTarget::Block { prefix: BlockPrefix::Db, number } => (format!("DB{number}"), None),
            SymbolTarget::Block { .. } => return None,
        };
        Some(Symbol { name: global.name.clone(), address, ty })
    }

    /// The structure of a tag whose type is one of the program.
    fn structure_of(&self, global: &Global) -> Option<DataType> {
        let (BlockPrefix::Udt, number) = self.type_block(global.structure.as_ref()?)? else { return None };
        match self.types.udts.get(&number)? {
            State::Done(typed) => typed.as_ref().map(|typed| typed.ty.clone()),
            State::Running => None,
        }
    }
}

/// An address as the runtime reads it: `Q4.0`, `MW20`.
fn address_text(area: Area, width: Width, byte: u32, bit: u8) -> String {
    let area = area.letters();
    match width {
        Width::Bit => format!("{area}{byte}.{bit}"),
        Width::Byte => format!("{area}B{byte}"),
        Width::Word => format!("{area}W{byte}"),
        Width::Dword => format!("{area}D{byte}"),
        Width::Lword => format!("{area}L{byte}"),
    }
}
