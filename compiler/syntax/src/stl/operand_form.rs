//! What an operand of STL is by its form: whether an operand class has it, and how messages describe it.

use crate::ast::{AddressRegister, Area, BlockName, BlockPrefix, CellKind, OperandKind, SpecialRegister, Width};
use crate::literal::Literal;
use crate::stl::OperandClass;

/// What an operand is, as far as its form shows.
pub enum Form {
    /// A bit, byte, word or double word in memory.
    Memory(Option<Area>, Width),
    Cell(CellKind),
    Block(BlockPrefix),
    /// A name: what it is is known later.
    Any,
    Other,
}

/// The form of an operand.
pub fn form(kind: &OperandKind) -> Form {
    match kind {
        OperandKind::Absolute { area, width, .. } | OperandKind::MemoryIndirect { area, width, .. } => {
            Form::Memory(Some(*area), *width)
        }
        OperandKind::DbAbsolute { width, .. } => Form::Memory(Some(Area::Db), *width),
        OperandKind::RegisterIndirect { area, width, .. } => Form::Memory(*area, *width),
        OperandKind::Cell { kind, .. } | OperandKind::CellIndirect { kind, .. } => Form::Cell(*kind),
        OperandKind::BlockIndirect { prefix, .. } => Form::Block(*prefix),
        OperandKind::Block(BlockName::Numbered { prefix, .. }) => Form::Block(*prefix),
        OperandKind::Block(BlockName::Symbol { .. })
        | OperandKind::Path(_)
        | OperandKind::Peripheral(_)
        | OperandKind::Error => Form::Any,
        OperandKind::AddressOf(_)
        | OperandKind::Literal(_)
        | OperandKind::Status(_)
        | OperandKind::Special(_)
        | OperandKind::Register(_)
        | OperandKind::Label(_) => Form::Other,
    }
}

/// Whether an operand class has such an operand, as far as the form shows.
pub fn fits(class: OperandClass, kind: &OperandKind) -> bool {
    let form = form(kind);
    if matches!(form, Form::Any) {
        return class != OperandClass::Label && class != OperandClass::Byte || matches!(kind, OperandKind::Error);
    }
    let is_marked = matches!(kind, OperandKind::Absolute { .. });
    let bit = matches!(form, Form::Memory(area, Width::Bit) if is_marked || !matches!(area, Some(Area::Pi | Area::Pq)));
    let wide = matches!(form, Form::Memory(_, Width::Byte | Width::Word | Width::Dword));
    let double_word = matches!(form, Form::Memory(Some(Area::M | Area::L | Area::Db | Area::Di), Width::Dword));
    let cell = matches!(form, Form::Cell(_));
    match class {
        OperandClass::None => false,
        OperandClass::Bit | OperandClass::BitOrNone => bit || cell || matches!(kind, OperandKind::Status(_)),
        OperandClass::BitWrite => bit,
        OperandClass::BitWriteOrCounter => bit || matches!(form, Form::Cell(CellKind::Counter)),
        OperandClass::BitWriteOrCell => bit || cell,
        OperandClass::LoadSource => {
            wide && !matches!(form, Form::Memory(Some(Area::Pq), _))
                || cell
                || matches!(kind, OperandKind::Special(_) | OperandKind::AddressOf(_))
                || matches!(kind, OperandKind::Literal(value) if loadable(value))
        }
        OperandClass::TransferTarget => {
            wide && !matches!(form, Form::Memory(Some(Area::Pi), _))
                || matches!(kind, OperandKind::Special(SpecialRegister::Stw))
        }
        OperandClass::Timer => matches!(form, Form::Cell(CellKind::Timer)),
        OperandClass::Counter => matches!(form, Form::Cell(CellKind::Counter)),
        OperandClass::Cell => cell,
        OperandClass::LoadAr1 | OperandClass::LoadAr2 => {
            double_word
                || matches!(kind, OperandKind::AddressOf(_))
                || matches!(kind, OperandKind::Literal(Literal::Pointer(_) | Literal::AreaPointer { db: 0, .. }))
                || class == OperandClass::LoadAr1 && *kind == OperandKind::Register(AddressRegister::Ar2)
        }
        OperandClass::TransferAr1 => double_word || *kind == OperandKind::Register(AddressRegister::Ar2),
        OperandClass::TransferAr2 => double_word,
        OperandClass::PointerOrNone => matches!(kind, OperandKind::Literal(Literal::Pointer(bits)) if *bits < 4096 * 8),
        OperandClass::Byte => {
            matches!(kind, OperandKind::Literal(Literal::Int(_) | Literal::Bits { .. } | Literal::Byte(_)))
        }
        OperandClass::AddConstant => {
            matches!(kind, OperandKind::Literal(value) if matches!(value,
                Literal::Int(_) | Literal::Dint(_) | Literal::Byte(_) | Literal::Word(_) | Literal::Dword(_) | Literal::Bits { .. }))
        }
        OperandClass::WordConstOrNone => {
            matches!(kind, OperandKind::Literal(value) if match value {
                Literal::Word(_) | Literal::Bytes2(_) | Literal::Int(_) | Literal::Byte(_) | Literal::Counter(_) | Literal::S5Time(_)
                | Literal::Date(_) => true,
                Literal::Bits { value, .. } => *value <= 0xFFFF,
                Literal::Text(text) => text.len() <= 2,
                _ => false,
            })
        }
        OperandClass::DwordConstOrNone => {
            matches!(kind, OperandKind::Literal(value) if match value {
                Literal::Dword(_) | Literal::Bytes4(_) | Literal::Dint(_) | Literal::Bits { .. } | Literal::Pointer(_)
                | Literal::AreaPointer { db: 0, .. } | Literal::Time(_) | Literal::TimeOfDay(_) | Literal::Real(_) => true,
                Literal::Text(text) => text.len() <= 4,
                _ => false,
            })
        }
        OperandClass::ShiftCount16 | OperandClass::ShiftCount32 => {
            matches!(kind, OperandKind::Literal(Literal::Int(_)))
        }
        OperandClass::Label => matches!(kind, OperandKind::Label(_)),
        OperandClass::Block => {
            matches!(form, Form::Block(BlockPrefix::Fc | BlockPrefix::Fb | BlockPrefix::Sfc | BlockPrefix::Sfb))
        }
        OperandClass::DataBlock => matches!(form, Form::Block(BlockPrefix::Db | BlockPrefix::Di)),
    }
}

/// Whether `L` accepts the constant: 32 bits at most, and not a BOOL.
fn loadable(value: &Literal) -> bool {
    match value {
        Literal::Bool(_) | Literal::DateAndTime(_) | Literal::Any(_) => false,
        Literal::AreaPointer { db, .. } => *db == 0,
        Literal::Text(text) => (1..=4).contains(&text.len()),
        Literal::Int(_)
        | Literal::Dint(_)
        | Literal::Byte(_)
        | Literal::Word(_)
        | Literal::Dword(_)
        | Literal::Bits { .. }
        | Literal::Bytes2(_)
        | Literal::Bytes4(_)
        | Literal::Real(_)
        | Literal::S5Time(_)
        | Literal::Time(_)
        | Literal::Date(_)
        | Literal::TimeOfDay(_)
        | Literal::Counter(_)
        | Literal::Pointer(_) => true,
    }
}

/// The name of a width, in messages.
pub fn width_name(width: Width) -> &'static str {
    match width {
        Width::Bit => "bit",
        Width::Byte => "byte",
        Width::Word => "word",
        Width::Dword => "double word",
        Width::Lword => "long word",
    }
}

/// What the source has at a position, for labels.
pub fn describe(kind: &OperandKind) -> String {
    let area = |area: Option<Area>| match area {
        Some(Area::I) => "input",
        Some(Area::Q) => "output",
        Some(Area::M) => "memory",
        Some(Area::Pi) => "peripheral input",
        Some(Area::Pq) => "peripheral output",
        Some(Area::L) => "local data",
        Some(Area::Db) => "data",
        Some(Area::Di) => "instance data",
        None => "indirect",
    };
    match kind {
        OperandKind::Absolute { area: own, width, byte, .. } if *width != Width::Bit && *byte < u32::MAX - 4 => {
            match width {
                Width::Byte => format!("{} byte {byte}", area(Some(*own))),
                Width::Bit | Width::Word | Width::Dword | Width::Lword => {
                    let last = byte + width.bytes() - 1;
                    format!("{} {} of bytes {byte} to {last}", area(Some(*own)), width_name(*width))
                }
            }
        }
        _ => match form(kind) {
            Form::Memory(own, width) => format!("{} {}", area(own), width_name(width)),
            Form::Cell(CellKind::Timer) => "a timer".to_owned(),
            Form::Cell(CellKind::Counter) => "a counter".to_owned(),
            Form::Block(_) => "a block".to_owned(),
            Form::Any => "a name".to_owned(),
            Form::Other => match kind {
                OperandKind::Literal(_) => "a constant",
                OperandKind::AddressOf(_) => "a pointer",
                OperandKind::Status(_) => "a status bit",
                OperandKind::Special(_) | OperandKind::Register(_) => "a register",
                OperandKind::Label(_) => "a label",
                _ => "an operand",
            }
            .to_owned(),
        },
    }
}
