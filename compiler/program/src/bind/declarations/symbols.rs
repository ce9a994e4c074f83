//! The named addresses of the program, for the flags of its executable.

use plcc_binding::report::known_type;
use plcc_diag::{Code, Diagnostic};
use plcc_model::Symbol;
use plcc_model::layout;
use plcc_model::types::{DataType, Elementary};
use plcc_syntax::ast::{Area, BlockPrefix, CellKind, Width};
use plcc_syntax::symbols::SymbolTarget;

use crate::bind::declarations::{Declarations, State};
use crate::bind::globals::names::Global;

/// Words of data types that are neither elementary nor names; also with a length or bounds after them.
const OTHER_TYPES: [&str; 10] =
    ["STRING", "WSTRING", "DATE_AND_TIME", "DT", "ARRAY", "STRUCT", "TIMER", "COUNTER", "POINTER", "ANY"];

impl Declarations<'_> {
    /// Warns about tags in memory whose data type nothing defines. In a part of a program, only of names that resemble a type of the CPU.
    pub fn check_tag_types(&mut self) {
        let input = self.globals.input;
        for symbol in input.tables.iter().flat_map(|table| &table.symbols) {
            let name = symbol.ty.trim().trim_matches('"');
            let word = name.split(['[', ' ']).next().unwrap_or_default().to_ascii_uppercase();
            let in_memory = matches!(symbol.target, SymbolTarget::Memory { .. });
            if !in_memory
                || word.is_empty()
                || Some(symbol.span.file) == input.stand_ins
                || Elementary::from_word(&name.to_ascii_uppercase()).is_some()
                || OTHER_TYPES.contains(&word.as_str())
                || self.type_block(name).is_some()
                || self.predefined(name, symbol.span).is_some()
            {
                continue;
            }
            let meant = known_type(name);
            if input.partial && meant.is_none() {
                continue;
            }
            let title = format!("the data type `{name}` of the tag `{}` is not defined", symbol.name);
            let help = match meant {
                Some(ty) => format!("is `{ty}` meant?"),
                None => "correct the type, or add the source that defines it".to_owned(),
            };
            self.globals.report.push(
                Diagnostic::new(Code::SymbolTable, symbol.span, title)
                    .label("only the width of the address counts")
                    .help(help),
            );
        }
    }

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
        Some(Symbol { name: global.name.clone(), address, ty, external: global.external })
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
