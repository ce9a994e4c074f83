//! What gdb sees of a program besides its code: `I`, `Q` and `M` as bytes, data blocks by number and name, symbols by name.
//!
//! Timers, counters and special memory of an S7-200 are not among them: they have no big-endian value in memory.

use plcc_abi::ProgramImage;
use plcc_abi::image::{AssertType, DbEntry, SymbolEntry};
use plcc_abi::layout;
use plcc_abi::names::NamedType;
use plcc_abi::s7200::V_DB;
use plcc_codegen::{Form, Variable, Variables};
use plcc_runtime::address::{self, Address, Place, Width};
use rustc_hash::FxHashSet;

/// The variables of a program; of several with the same name the first.
pub fn of(image: &ProgramImage) -> Variables<'_> {
    let profile = &image.profile;
    let areas =
        [("I", layout::I, profile.inputs), ("Q", layout::Q, profile.outputs), ("M", layout::M, profile.bit_memory)];
    let areas = areas.into_iter().filter(|&(_, _, bytes)| bytes > 0).map(|(name, offset, bytes)| Variable {
        name: name.to_string(),
        offset,
        bit: 0,
        form: Form::Bytes(bytes),
    });
    let dbs = image.dbs.iter().filter(|db| !db.unlinked && !db.data.is_empty());
    let dbs = dbs.flat_map(|db| {
        let number =
            if image.s7200.is_some() && db.number == V_DB { "V".to_string() } else { format!("DB{}", db.number) };
        [number, db.name.clone()].map(|name| variable_of_db(name, db))
    });
    let symbols = image.symbols.iter().filter_map(|symbol| variable_of_symbol(symbol, image));
    let mut names = FxHashSet::default();
    let list = areas.chain(dbs).chain(symbols);
    let list = list.filter(|variable| !variable.name.is_empty() && names.insert(variable.name.clone())).collect();
    Variables { types: &image.types, list }
}

fn variable_of_db(name: String, db: &DbEntry) -> Variable {
    let form = db.ty.map_or(Form::Bytes(db.data.len() as u32), Form::Named);
    Variable { name, offset: db.address, bit: 0, form }
}

fn variable_of_symbol(symbol: &SymbolEntry, image: &ProgramImage) -> Option<Variable> {
    let Address { place, width } = address::parse_for(&symbol.address, image)?;
    let offset = match place {
        Place::Input(byte) => layout::I + byte,
        Place::Output(byte) => layout::Q + byte,
        Place::BitMemory(byte) => layout::M + byte,
        Place::Db(number, byte) => image.dbs.iter().find(|db| db.number == number && !db.unlinked)?.address + byte,
        Place::PeripheralInput(_)
        | Place::PeripheralOutput(_)
        | Place::Timer(_)
        | Place::Counter(_)
        | Place::TimerValue(_)
        | Place::CounterValue(_)
        | Place::S7200(..) => return None,
    };
    let bits = match width {
        Width::Bit(_) => AssertType::Bool,
        Width::Byte | Width::Word | Width::Dword | Width::Lword => AssertType::Bits(width.bits() as u8),
    };
    let declared = symbol.ty.and_then(|number| Some((number, image.types.get(number as usize)?)));
    let form = match (width, declared) {
        // The address says that it is a bit.
        (Width::Bit(_), Some((_, NamedType::Value(_))) | None) => Form::Value(bits),
        (_, Some((number, _))) => Form::Named(number),
        (_, None) => Form::Value(bits),
    };
    let bit = if let Width::Bit(bit) = width { bit } else { 0 };
    Some(Variable { name: symbol.name.clone(), offset, bit, form })
}
