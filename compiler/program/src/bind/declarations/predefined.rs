//! Data types of the language or the CPU: DTL, ErrorStruct, connection descriptions, numbers of hardware objects and OBs, and the instance
//! types of IEC timers and counters, which are blocks of the standard library. `structures` is the table of those with components.

mod structures;

use std::rc::Rc;

use plcc_abi::image::BlockKind;
use plcc_syntax::ast::{BlockName, BlockPrefix, Bound, SectionKind, TypeKind, TypeRef, Variable};

use crate::bind::declarations::Declarations;
use crate::bind::declarations::block::CurrentBlock;
use crate::bind::declarations::typed::{StructBuilder, Typed, TypedStruct, Use, elementary_typed};
use crate::bind::globals::{library, names};
use plcc_binding::fold;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::types::{ArrayType, DataType, Elementary};
use plcc_stdlib::BlockClass;
use plcc_syntax::symbols::{SymbolTarget, parse_address};
use structures::Part::{self, Bytes, Chars, One, Text, Uints};
use structures::{STRUCTURES, Structure};

/// Names of the CPU's objects, with the type of each.
#[rustfmt::skip]
const NUMBERS: &[(Elementary, &[&str])] = &[
    (Elementary::Word, &[
        "HW_ANY", "HW_IO", "HW_DEVICE", "HW_INTERFACE", "HW_SUBMODULE", "HW_MODULE", "HW_HSC", "HW_PWM", "HW_PTO",
        "HW_DPMASTER", "HW_DPSLAVE", "HW_IOSYSTEM", "HW_IEPORT", "CONN_ANY", "CONN_OUC", "CONN_PRG",
    ]),
    (Elementary::Uint, &["DB_ANY", "DB_DYN", "DB_WWW", "PORT", "RTM", "PIP"]),
    (Elementary::Int, &[
        "OB_ANY", "OB_ATT", "OB_CYCLIC", "OB_DELAY", "OB_TOD", "OB_PCYCLE", "OB_HWINT", "OB_DIAG", "OB_TIMEERROR",
        "OB_STARTUP",
    ]),
    (Elementary::Dword, &["EVENT_ANY", "EVENT_ATT", "EVENT_HWINT", "AOM_IDENT", "CONN_R_ID"]),
];

/// The block of all axes, whose data types have several names.
pub(super) const AXIS: &str = "TO_PositioningAxis";

/// Data types of timers, counters and axes: the blocks whose instances they are; the first available one counts.
///
/// The four timers have one layout, and that of TONR names all components; CTUD does so for the counters.
#[rustfmt::skip]
const INSTANCES: &[(&str, &[&str])] = &[
    ("IEC_TIMER",      &["IEC_TIMER", "TONR", "TON"]),
    ("TP_TIME",        &["TP_TIME", "TP"]),
    ("TON_TIME",       &["TON_TIME", "TON"]),
    ("TOF_TIME",       &["TOF_TIME", "TOF"]),
    ("TONR_TIME",      &["TONR_TIME", "TONR"]),
    ("IEC_LTIMER",     &["IEC_LTIMER", "TONR_LTIME"]),
    ("IEC_COUNTER",    &["IEC_COUNTER", "CTUD_INT", "CTUD"]),
    ("IEC_SCOUNTER",   &["IEC_SCOUNTER", "CTUD_SINT"]),
    ("IEC_USCOUNTER",  &["IEC_USCOUNTER", "CTUD_USINT"]),
    ("IEC_UCOUNTER",   &["IEC_UCOUNTER", "CTUD_UINT"]),
    ("IEC_DCOUNTER",   &["IEC_DCOUNTER", "CTUD_DINT"]),
    ("IEC_UDCOUNTER",  &["IEC_UDCOUNTER", "CTUD_UDINT"]),
    ("IEC_LCOUNTER",   &["IEC_LCOUNTER", "CTUD_LINT"]),
    ("IEC_ULCOUNTER",  &["IEC_ULCOUNTER", "CTUD_ULINT"]),
    ("TO_CommandTable_PTO", &["TO_CommandTable"]),
    ("TO_Axis",        &[AXIS]),
    ("TO_SpeedAxis",   &[AXIS]),
    ("TO_SynchronousAxis", &[AXIS]),
    ("CTU",            &["CTU_INT", "CTU"]),
    ("CTD",            &["CTD_INT", "CTD"]),
    ("CTUD",           &["CTUD_INT", "CTUD"]),
    ("CTU_INT",        &["CTU_INT", "CTU"]),
    ("CTD_INT",        &["CTD_INT", "CTD"]),
    ("CTUD_INT",       &["CTUD_INT", "CTUD"]),
];

/// The members of a data type of the CPU, or of an instance of a block of the library, as a source would declare them; `None`: there is
/// none with this name.
pub fn system_members(name: &str) -> Option<Vec<Variable>> {
    let name = name.trim();
    if let Some(structure) = STRUCTURES.iter().find(|structure| structure.name.eq_ignore_ascii_case(name)) {
        return Some(structure.members.iter().map(|(name, part)| declared(name, *part)).collect());
    }
    let own = [name];
    let candidates = INSTANCES.iter().find(|(ty, _)| ty.eq_ignore_ascii_case(name)).map_or(&own[..], |row| row.1);
    let is_type = |block: &&plcc_stdlib::SystemBlock| matches!(block.class, BlockClass::Fb | BlockClass::Sfb);
    let tia = || candidates.iter().find_map(|name| plcc_stdlib::find_tia(name).filter(is_type));
    let classic = || candidates.iter().find_map(|name| plcc_stdlib::find_name(name).filter(is_type));
    let block = tia().or_else(classic)?;
    let sections = library::parsed(block.language, block.source).sections.into_iter();
    let kept = sections.filter(|section| section.kind != SectionKind::Temp);
    Some(kept.flat_map(|section| section.variables).collect())
}

/// The declaration of a component.
fn declared(name: &str, part: Part) -> Variable {
    let span = Span::default();
    let named = |name: &str| TypeRef { kind: TypeKind::Named(name.to_string()), span };
    let array = |element: TypeRef, count: u16| {
        let bounds = vec![(Bound::Number(1, span), Bound::Number(i64::from(count), span))];
        TypeRef { kind: TypeKind::Array { bounds, element: Box::new(element) }, span }
    };
    let ty = match part {
        One(ty) => named(ty.name()),
        Bytes(count) => array(named(Elementary::Byte.name()), count),
        Uints(count) => array(named(Elementary::Uint.name()), count),
        Chars(count) => array(named(Elementary::Char.name()), count),
        Text(length) => TypeRef { kind: TypeKind::String(Some(Bound::Number(i64::from(length), span))), span },
        Part::Structure(name) => named(name),
        Part::Structures(name, count) => array(named(name), count),
    };
    Variable::new(name, ty, span)
}

impl Declarations<'_> {
    /// The block that a data type's name means: one of the sources, `FB10`, or one of the library; no message.
    pub fn type_block(&self, name: &str) -> Option<(BlockPrefix, u16)> {
        if let Some(number) = self.globals.names.types.get(&plcc_binding::fold(name)) {
            return Some((BlockPrefix::Udt, *number));
        }
        if self.globals.names.symbols.contains_key(&plcc_binding::fold(name)) {
            return match self.globals.global(name) {
                Some(SymbolTarget::Block { prefix, number }) => Some((prefix, u16::try_from(number).ok()?)),
                Some(SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. }) | None => None,
            };
        }
        if let Some(SymbolTarget::Block { prefix, number }) = parse_address(name) {
            return Some((prefix, u16::try_from(number).ok()?));
        }
        let trimmed = name.trim();
        let own = [trimmed];
        let candidates =
            INSTANCES.iter().find(|(ty, _)| ty.eq_ignore_ascii_case(trimmed)).map_or(&own[..], |row| row.1);
        // A function is not a type: where a type is expected, `RTM` is a hardware identifier.
        let is_type = |block: &&plcc_stdlib::SystemBlock| matches!(block.class, BlockClass::Fb | BlockClass::Sfb);
        let tia = || candidates.iter().find_map(|name| plcc_stdlib::find_tia(name).filter(is_type));
        let classic = || candidates.iter().find_map(|name| plcc_stdlib::find_name(name).filter(is_type));
        let block = if self.types.scope.tia { tia().or_else(classic) } else { classic().or_else(tia) }?;
        let key = self.globals.library.key_of(block);
        Some((names::kind_prefix(key.kind), key.number))
    }

    /// Whether the block declares `name` with the common data type of several instructions, so that a call of the variable alone
    /// does not say which of them it means. It is reported then. `write`: a call with the instruction.
    pub fn has_common_data(
        &mut self,
        ctx: &CurrentBlock,
        name: &str,
        span: Span,
        write: impl Fn(&str) -> String,
    ) -> bool {
        let Some(source) = self.globals.sources.code.get(&ctx.key) else { return false };
        let mut variables = source.block().sections.iter().flat_map(|section| &section.variables);
        let Some(TypeKind::Named(ty)) = variables.find(|own| fold(&own.name) == fold(name)).map(|own| &own.ty.kind)
        else {
            return false;
        };
        let (instruction, own, all) = match ty.as_str() {
            "IEC_TIMER" => ("TON", "TON_TIME", "TON, TOF, TP and TONR"),
            "IEC_LTIMER" => ("TON", "TON_LTIME", "TON, TOF, TP and TONR"),
            "IEC_COUNTER" => ("CTU", "CTU_INT", "CTU, CTD and CTUD"),
            _ => return false,
        };
        let names = &self.globals.names;
        if names.types.contains_key(&fold(ty)) || names.symbols.contains_key(&fold(ty)) {
            return false;
        }
        let (ty, text) = (ty.clone(), self.globals.text(span));
        let write = write(instruction);
        self.report(
            Diagnostic::new(Code::NoBlockFits, span, format!("`{text}` is of type {ty}, which is not an instruction"))
                .label(format!("{all} have this data"))
                .help(format!("write `{write}`, or declare the variable with a type such as {own}")),
        );
        true
    }

    /// A type of the language or the CPU that is not a block.
    pub fn predefined(&mut self, name: &str, span: Span) -> Option<Typed> {
        let name = name.trim();
        let numbers = NUMBERS.iter().find(|(_, names)| names.iter().any(|own| own.eq_ignore_ascii_case(name)));
        if let Some((ty, _)) = numbers {
            return Some(elementary_typed(*ty));
        }
        if let Some(kind) = crate::bind::trees::chart_data::type_named(name) {
            return self.resolve_type(&TypeRef { kind, span }, Use::Component);
        }
        let structure = STRUCTURES.iter().find(|structure| structure.name.eq_ignore_ascii_case(name))?;
        let typed = match self.types.predefined.get(structure.name) {
            Some(typed) => typed.clone(),
            None => {
                let typed = self.predefined_structure(structure, span)?;
                self.types.predefined.insert(structure.name, typed.clone());
                typed
            }
        };
        Some(Typed { ty: DataType::Struct(typed.ty), image: typed.image })
    }

    fn predefined_structure(&mut self, structure: &Structure, span: Span) -> Option<TypedStruct> {
        let mut builder = StructBuilder::default();
        for (name, part) in structure.members {
            let typed = match part {
                One(ty) => elementary_typed(*ty),
                Bytes(count) => array_typed(Elementary::Byte, *count, 1),
                Uints(count) => array_typed(Elementary::Uint, *count, 2),
                Text(length) => text_typed(*length),
                Chars(count) => array_typed(Elementary::Char, *count, 1),
                Part::Structure(other) => self.predefined(other, span)?,
                Part::Structures(other, count) => array_of(self.predefined(other, span)?, *count),
            };
            builder.add((*name).to_string(), &typed);
        }
        let mut typed = self.finish_structure(builder, structure.name.to_string(), None, span)?;
        if !structure.default.is_empty() {
            typed.image = structure.default.into();
        }
        Some(typed)
    }
}

/// STRING[length], empty.
fn text_typed(length: u8) -> Typed {
    let mut image = vec![0; usize::from(length) + 2];
    image[0] = length;
    Typed { ty: DataType::String(length), image: image.into() }
}

/// ARRAY[1..count] OF a type of so many bytes.
fn array_typed(element: Elementary, count: u16, bytes: u16) -> Typed {
    let bytes = usize::from(count * bytes).next_multiple_of(2);
    let bounds = vec![(1, i32::from(count))];
    let array = ArrayType { bounds, element: DataType::Elementary(element), bytes: bytes as u32 };
    Typed { ty: DataType::Array(Rc::new(array)), image: vec![0; bytes].into() }
}

/// ARRAY[1..count] of a structure.
fn array_of(element: Typed, count: u16) -> Typed {
    let bounds = vec![(1, i32::from(count))];
    let image = element.image.repeat(usize::from(count));
    let array = ArrayType { bounds, element: element.ty, bytes: image.len() as u32 };
    Typed { ty: DataType::Array(Rc::new(array)), image: image.into() }
}

/// True of blocks that can be components of data blocks and PLC data types: those of the system.
pub fn is_component(kind: BlockKind) -> bool {
    kind == BlockKind::Sfb
}

/// True of the name of an axis.
pub fn is_axis(ty: &TypeKind) -> bool {
    let name = match ty {
        TypeKind::Named(name) | TypeKind::Block(BlockName::Symbol { name, .. }) => name,
        TypeKind::String(_)
        | TypeKind::WideString(_)
        | TypeKind::Array { .. }
        | TypeKind::OpenArray { .. }
        | TypeKind::Reference(_)
        | TypeKind::Struct(_)
        | TypeKind::Block(BlockName::Numbered { .. })
        | TypeKind::Error => return false,
    };
    let is = |own: &str| own.eq_ignore_ascii_case(name.trim());
    is(AXIS) || INSTANCES.iter().any(|(own, blocks)| *blocks == [AXIS] && is(own))
}
