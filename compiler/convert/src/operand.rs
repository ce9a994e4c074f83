//! Operands of STL as text, in either set of mnemonics.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{
    AddressRegister, Area, BlockPrefix, CellKind, Operand, OperandKind, Path, PathPart, PathRoot, Width,
};
use plcc_syntax::literal::Literal;
use plcc_syntax::scl::ast::{Expr, ExprKind, Literal as SclLiteral, NameForm, UnaryOp};
use plcc_syntax::stl::Mnemonics;
use plcc_syntax::stl::letters;

use crate::names;
use crate::to_stl::slice_type;
use crate::writer::{Notation, Writer};

/// An operand; its constants as the author wrote them.
pub(crate) fn operand(operand: &Operand, writer: &mut Writer) -> String {
    text(&operand.kind, operand.span, writer)
}

pub(crate) fn text(kind: &OperandKind, span: Span, writer: &mut Writer) -> String {
    let set = writer.mnemonics;
    match kind {
        OperandKind::Absolute { area: area @ (Area::Pi | Area::Pq), width: Width::Bit, byte, bit } => {
            let area = if *area == Area::Pi { Area::I } else { Area::Q };
            format!("%{}{byte}.{bit}:P", area_letters(area, Width::Bit, set))
        }
        OperandKind::Absolute { area, width, byte, bit } => {
            format!("{} {}", area_letters(*area, *width, set), address(*width, *byte, *bit))
        }
        OperandKind::Cell { kind, number } => format!("{} {number}", cell_letter(*kind, set)),
        OperandKind::DbAbsolute { db, width, byte, bit } => {
            let letters = area_letters(Area::Db, *width, set);
            let db = writer.block_name(db).replace(' ', "");
            format!("{db}.{letters} {}", address(*width, *byte, *bit))
        }
        OperandKind::MemoryIndirect { area, width, pointer } => {
            let pointer = operand(pointer, writer);
            format!("{} [{pointer}]", area_letters(*area, *width, set))
        }
        OperandKind::CellIndirect { kind, pointer } => {
            let pointer = operand(pointer, writer);
            format!("{} [{pointer}]", cell_letter(*kind, set))
        }
        OperandKind::BlockIndirect { prefix, pointer } => {
            let pointer = operand(pointer, writer);
            format!("{} [{pointer}]", prefix.letters())
        }
        OperandKind::RegisterIndirect { area, width, register, offset } => {
            let letters = match area {
                Some(area) => format!("{} ", area_letters(*area, *width, set)),
                None => match width {
                    Width::Bit => String::new(),
                    Width::Byte => "B ".to_string(),
                    Width::Word => "W ".to_string(),
                    Width::Dword | Width::Lword => "D ".to_string(),
                },
            };
            format!("{letters}[{},P#{}.{}]", register_name(*register), offset >> 3, offset & 7)
        }
        OperandKind::Block(name) => writer.block_name(name),
        OperandKind::Path(path) => path_text(path, writer),
        OperandKind::Peripheral(path) => format!("{}:P", path_text(path, writer)),
        OperandKind::AddressOf(path) => format!("P#{}", path_text(path, writer)),
        OperandKind::Literal(value) => writer.slice(span, value),
        OperandKind::Status(status) => status.name(set).to_string(),
        OperandKind::Special(special) => special.name().to_string(),
        OperandKind::Register(register) => register_name(*register).to_string(),
        OperandKind::Label(name) => name.clone(),
        OperandKind::Error => {
            writer.refuse(span, "an operand that was not understood", "repair the source first");
            String::new()
        }
    }
}

/// `#motor.speed[3]`, `"db".a`, `DB10.a`.
pub(crate) fn path_text(path: &Path, writer: &mut Writer) -> String {
    let root = match &path.root {
        PathRoot::Local { name, .. } => names::local(name),
        PathRoot::Quoted { name, .. } => names::symbol(name),
        // In the other mnemonics `I1` may be an address.
        PathRoot::Bare { name, .. } if writer.notation == Notation::Stl && is_like_address(name, writer.mnemonics) => {
            names::local(name)
        }
        PathRoot::Bare { name, .. } => name.clone(),
        PathRoot::Block(name) => writer.block_name(name).replace(' ', ""),
    };
    parts(root, &path.parts, writer)
}

/// Whether a name is an address of inputs, outputs or counters in these mnemonics and not in the other ones, but for a bit: `I1`, `QW4`, `C3`.
fn is_like_address(name: &str, set: Mnemonics) -> bool {
    let letters = name.trim_end_matches(|sign: char| sign.is_ascii_digit());
    let widths = |area: &str| ["", "B", "W", "D"].map(|width| format!("{area}{width}"));
    let (areas, counter) = match set {
        Mnemonics::En => (["I", "Q", "PI", "PQ"], "C"),
        Mnemonics::De => (["E", "A", "PE", "PA"], "Z"),
    };
    let is = |area: &String| letters.eq_ignore_ascii_case(area);
    letters.len() < name.len()
        && (letters.eq_ignore_ascii_case(counter) || areas.into_iter().flat_map(widths).any(|area| is(&area)))
}

/// A component of a data block, before its value.
pub(crate) fn value_path(path: &Path, writer: &mut Writer) -> String {
    let root = match &path.root {
        PathRoot::Local { name, span } | PathRoot::Bare { name, span } | PathRoot::Quoted { name, span } => {
            writer.declared(name, *span)
        }
        PathRoot::Block(name) => writer.block_name(name),
    };
    parts(root, &path.parts, writer)
}

fn parts(mut text: String, parts: &[PathPart], writer: &mut Writer) -> String {
    for part in parts {
        match part {
            // A part of a variable: `.%X3`.
            PathPart::Member { name, .. } if writer.notation == Notation::Stl && slice_type(name).is_some() => {
                text.push('.');
                text.push_str(name);
            }
            PathPart::Member { name, span } => {
                text.push('.');
                text.push_str(&writer.declared(name, *span));
            }
            PathPart::Index { values, .. } => {
                let values: Vec<String> = values.iter().map(|value| writer.bound(value)).collect();
                text.push_str(&format!("[{}]", values.join(",")));
            }
        }
    }
    text
}

/// `MW`, `DBX`, `E`.
pub(crate) fn area_letters(area: Area, width: Width, set: Mnemonics) -> String {
    letters(area, width, set).unwrap_or_else(|| format!("{}L", area.letters()))
}

/// `10.3`, `10`.
pub(crate) fn address(width: Width, byte: u32, bit: u8) -> String {
    if width == Width::Bit { format!("{byte}.{bit}") } else { byte.to_string() }
}

pub(crate) fn cell_letter(kind: CellKind, set: Mnemonics) -> &'static str {
    match (kind, set) {
        (CellKind::Timer, _) => "T",
        (CellKind::Counter, Mnemonics::En) => "C",
        (CellKind::Counter, Mnemonics::De) => "Z",
    }
}

fn register_name(register: AddressRegister) -> &'static str {
    match register {
        AddressRegister::Ar1 => "AR1",
        AddressRegister::Ar2 => "AR2",
    }
}

/// A constant of SCL as one of STL, if STL has it.
pub(crate) fn constant(value: &Expr) -> Option<Literal> {
    let (kind, negative) = match &value.kind {
        ExprKind::Unary { op: UnaryOp::Minus, operand } => (&operand.kind, true),
        kind => (kind, false),
    };
    let ExprKind::Literal(literal) = kind else { return None };
    let literal = match literal {
        SclLiteral::Integer { value, based: false } => {
            let value = i64::try_from(*value).ok()?;
            return Some(Literal::Int(if negative { -value } else { value }));
        }
        SclLiteral::Integer { value, based: true } => {
            let digits = [8, 16, 32].into_iter().find(|digits| value >> digits == 0)?;
            Literal::Bits { value: *value as u32, digits }
        }
        SclLiteral::Real(value) => return Some(Literal::Real(if negative { -*value } else { *value } as f32)),
        SclLiteral::Typed { ty, bits } => typed(*ty, *bits)?,
        SclLiteral::Text { bytes, .. } => Literal::Text(bytes.clone()),
        SclLiteral::DateAndTime(bytes) => Literal::DateAndTime(*bytes),
        SclLiteral::Pointer { db, pointer } => Literal::AreaPointer { db: *db, pointer: *pointer },
        SclLiteral::Any(bytes) => Literal::Any(*bytes),
        SclLiteral::WideText(_) | SclLiteral::Dtl(_) | SclLiteral::Nil | SclLiteral::Null => return None,
    };
    (!negative).then_some(literal)
}

/// Whether a constant is one that STL only declares, and writes as SCL does: `LT#5us`, a number of 64 bits, `#MAX`.
pub(crate) fn only_declared(value: &Expr) -> bool {
    let kind = match &value.kind {
        ExprKind::Unary { op: UnaryOp::Minus, operand } => &operand.kind,
        kind => kind,
    };
    if let ExprKind::Name(name) = kind {
        return name.form == NameForm::Local;
    }
    let ExprKind::Literal(literal) = kind else { return false };
    match literal {
        SclLiteral::Integer { value, .. } => *value > u64::from(u32::MAX),
        SclLiteral::Real(value) => digits_of(*value).is_none(),
        SclLiteral::Typed { ty, bits } => typed(*ty, *bits).is_none(),
        SclLiteral::WideText(_) | SclLiteral::Dtl(_) => true,
        SclLiteral::Text { .. }
        | SclLiteral::DateAndTime(_)
        | SclLiteral::Pointer { .. }
        | SclLiteral::Any(_)
        | SclLiteral::Nil
        | SclLiteral::Null => false,
    }
}

/// The constant of STL with that type and these bits.
pub(crate) fn typed(ty: Elementary, bits: u64) -> Option<Literal> {
    Some(match ty {
        Elementary::Bool => Literal::Bool(bits != 0),
        Elementary::Byte => Literal::Byte(bits as u8),
        Elementary::Word => Literal::Word(bits as u16),
        Elementary::Dword => Literal::Dword(bits as u32),
        Elementary::Char => Literal::Text(vec![bits as u8]),
        Elementary::Int => Literal::Int(i64::from(bits as u16 as i16)),
        Elementary::Dint => Literal::Dint(bits as u32 as i32),
        Elementary::Real => Literal::Real(f32::from_bits(bits as u32)),
        Elementary::Lreal => Literal::Real(digits_of(f64::from_bits(bits))?),
        Elementary::S5Time => Literal::S5Time(bits as u16),
        Elementary::Time => Literal::Time(bits as u32 as i32),
        Elementary::Date => Literal::Date(bits as u16),
        Elementary::TimeOfDay => Literal::TimeOfDay(bits as u32),
        Elementary::Lword
        | Elementary::Wchar
        | Elementary::Sint
        | Elementary::Usint
        | Elementary::Uint
        | Elementary::Udint
        | Elementary::Lint
        | Elementary::Ulint
        | Elementary::Ltime
        | Elementary::Ltod
        | Elementary::Ldt => return None,
    })
}

/// The REAL with the same digits as a LREAL: STL has no constants of that type, but an actual of one has all digits of the number.
fn digits_of(value: f64) -> Option<f32> {
    let single = value as f32;
    (single.is_finite() && single.to_string().parse() == Ok(value)).then_some(single)
}

/// Letters of a block number, as in `DB`.
pub(crate) fn prefix_letters(prefix: BlockPrefix) -> &'static str {
    prefix.letters()
}
