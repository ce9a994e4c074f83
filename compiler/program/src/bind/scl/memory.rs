//! Functions that read or write memory at computed addresses, and moves of parts of arrays. Source: SCL reference, moves and memory.
//!
//! A move of several elements becomes a loop over them, with variables in the block's local data.

use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_syntax::ast::BlockPrefix;
use plcc_syntax::scl::ast::Expr as Node;
use plcc_syntax::{Class, Elementary};

use super::Intent;
use super::compare::comparison;
use super::convert;
use super::function::{Kind, Row, TextNumber};
use super::message::described;
use super::numeric::Shape;
use super::pins::Pins;
use super::value::Value;
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::constant::Constant;
use plcc_model::layout;
use plcc_model::scl::{
    Access, Arm, Base, BinaryOp, CompareOp, Complex, Expr, ExprKind, IndexedArea, Statement, StatementKind,
};
use plcc_model::types::DataType;
use plcc_model::{Number, Place};

/// The area of PEEK and POKE for data blocks.
const DATA_BLOCKS: u64 = 0x84;

/// [`IndexedArea::Coded`] lists the memory areas that PEEK and POKE reach.
struct Coded {
    area: Box<Expr>,
    db: Box<Expr>,
    byte: Box<Expr>,
}

impl SclBinder<'_, '_> {
    /// Functions that are statements.
    pub fn statement_function(
        &mut self,
        ctx: &mut SclBlock,
        row: &Row,
        suffix: Option<Elementary>,
        pins: &Pins,
        span: Span,
    ) -> Option<Value> {
        let kinds = match row.kind {
            Kind::Poke { bit } => self.poke(ctx, suffix, bit, pins, span)?,
            Kind::PokeBlock => self.poke_block(ctx, pins, span)?,
            Kind::MoveBlock => self.move_block(ctx, pins, span)?,
            Kind::FillBlock => self.fill_block(ctx, pins, span)?,
            Kind::Scatter => self.scatter(ctx, pins, span)?,
            Kind::Gather => self.gather(ctx, pins, span)?,
            Kind::ScatterBlock { to_bits } => self.scatter_block(ctx, to_bits, pins, span)?,
            Kind::Demux => self.demux(ctx, pins, span)?,
            Kind::TextNumber(TextNumber::Convert) if self.is_text_to_text(ctx, pins) => {
                vec![self.move_text(ctx, pins)?]
            }
            Kind::TextNumber(TextNumber::Convert) if let Some(statement) = self.wide_conversion(ctx, pins, span) => {
                vec![statement?]
            }
            Kind::TextNumber(kind) => vec![StatementKind::Call(Box::new(self.text_number(ctx, kind, pins, span)?))],
            Kind::ResetTimer => self.reset_timer(ctx, pins, span)?,
            Kind::PresetTimer => self.preset_timer(ctx, pins)?,
            Kind::MoveText => vec![self.move_text(ctx, pins)?],
            _ => return None,
        };
        let statements = kinds.into_iter().map(|kind| Statement { kind, span }).collect();
        Some(Value::Statements(statements, span))
    }

    fn move_text(&mut self, ctx: &mut SclBlock, pins: &Pins) -> Option<StatementKind> {
        let target = self.access(ctx, pins.get("OUT")?, Intent::Write)?;
        if !matches!(target.ty, DataType::String(_) | DataType::WideString(_)) {
            let is = format!("of type {}", layout::type_name(&target.ty));
            self.wrong_type(target.span, &is, "STRING", None);
            return None;
        }
        let value = self.complex(ctx, pins.get("IN")?, &target.ty.clone())?;
        Some(StatementKind::AssignText { target, value })
    }

    /// S_CONV between two texts is S_MOVE. Whatever binds the pins reports mistakes in them.
    fn is_text_to_text(&mut self, ctx: &mut SclBlock, pins: &Pins) -> bool {
        let (Some(input), Some(output), None) = (pins.get("IN"), pins.get("OUT"), pins.eno) else { return false };
        self.quietly(ctx, |binder, ctx| {
            let target = binder.access(ctx, output, Intent::Write);
            let to_text = target.is_some_and(|access| matches!(access.ty, DataType::String(_)));
            to_text
                && matches!(
                    binder.value(ctx, input),
                    Some(Value::Complex { ty: DataType::String(_), .. } | Value::Constant(Constant::Text { .. }, _))
                )
        })
    }

    pub fn peek(
        &mut self,
        ctx: &mut SclBlock,
        suffix: Option<Elementary>,
        bit: bool,
        pins: &Pins,
        span: Span,
    ) -> Option<Value> {
        let ty = match bit {
            true => Elementary::Bool,
            false => suffix.unwrap_or(Elementary::Byte),
        };
        let access = self.coded_access(ctx, ty, bit, ("AREA", "DBNUMBER", "BYTEOFFSET"), pins, span)?;
        Some(Value::Elementary(Expr { kind: ExprKind::Load(Box::new(access)), ty, span }))
    }

    fn poke(
        &mut self,
        ctx: &mut SclBlock,
        suffix: Option<Elementary>,
        bit: bool,
        pins: &Pins,
        span: Span,
    ) -> Option<Vec<StatementKind>> {
        let value = self.value(ctx, pins.get("VALUE")?)?;
        let ty = match (bit, suffix, Shape::of(&value)) {
            (true, ..) => Elementary::Bool,
            (_, Some(ty), _) | (_, None, Shape::Of(ty)) if ty != Elementary::Bool => ty,
            // A constant without a type is a byte.
            (_, _, Shape::Integer(_)) => Elementary::Byte,
            _ => {
                let help = "to write a bit, call POKE_BOOL".to_string();
                self.wrong_type(value.span(), &described(&value), "a bit string or an integer", Some(help));
                return None;
            }
        };
        let value = self.convert(ctx, value, ty);
        let target = self.coded_access(ctx, ty, bit, ("AREA", "DBNUMBER", "BYTEOFFSET"), pins, span)?;
        Some(vec![StatementKind::Assign { target, value: value? }])
    }

    fn coded_access(
        &mut self,
        ctx: &mut SclBlock,
        ty: Elementary,
        bit: bool,
        names: (&str, &str, &str),
        pins: &Pins,
        span: Span,
    ) -> Option<Access> {
        let coded = self.coded(ctx, names, pins);
        let bit = match bit {
            true => Some(Box::new(self.of_type(ctx, pins.get("BITOFFSET")?, Elementary::Int)?)),
            false => None,
        };
        if let Some(Expr { kind: ExprKind::Const(8..), span, .. }) = bit.as_deref() {
            self.never_reached(*span, "a byte has no bit", "the bits of a byte are 0 to 7");
        }
        let Coded { area, db, byte } = coded?;
        let base = Base::Indexed { area: IndexedArea::Coded { area, db }, byte, bit };
        Some(Access { base, indices: Vec::new(), ty: DataType::Elementary(ty), part: None, span })
    }

    fn coded(&mut self, ctx: &mut SclBlock, names: (&str, &str, &str), pins: &Pins) -> Option<Coded> {
        let area = self.of_type(ctx, pins.get(names.0)?, Elementary::Byte);
        let number = pins.get(names.1)?;
        let db = self.db_number(ctx, number);
        let byte = self.of_type(ctx, pins.get(names.2)?, Elementary::Dint);
        let (area, db, byte) = (area?, db?, byte?);
        if let ExprKind::Const(code) = area.kind
            && !matches!(code, 1 | 2 | 0x81..=DATA_BLOCKS)
        {
            let codes =
                "16#81 are inputs, 16#82 outputs, 16#83 bit memory, 16#84 data blocks, 1 and 2 the modules themselves";
            self.never_reached(area.span, "no memory area has the code", codes);
        }
        if let (ExprKind::Const(DATA_BLOCKS), ExprKind::Const(known)) = (&area.kind, &db.kind) {
            self.program.globals.check_coded_access(*known as u16, number.span)?;
        }
        Some(Coded { area: Box::new(area), db: Box::new(db), byte: Box::new(byte) })
    }

    /// Warns of a constant with which PEEK and POKE reach nothing. `title`: half a sentence before the constant.
    fn never_reached(&mut self, span: Span, title: &str, help: &str) {
        let text = self.program.globals.text(span);
        let mut message = Diagnostic::new(Code::AddressRange, span, format!("{title} {text}"))
            .label("an error at run time")
            .help(help);
        message.severity = Severity::Warning;
        self.program.report(message);
    }

    /// The number of a data block: any integer, or the block itself.
    fn db_number(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Expr> {
        let value = self.value(ctx, node)?;
        match (Shape::of(&value), &value) {
            (_, Value::Block { prefix: BlockPrefix::Db, number: Number::Known(number), span }) => {
                let (number, span) = (*number, *span);
                self.program.use_db(number, span);
                Some(Expr { kind: ExprKind::Const(u64::from(number)), ty: Elementary::Word, span })
            }
            (Shape::Of(ty), _) if ty.is_integer() || ty.class() == Class::Bits => {
                let number = self.own_type(ctx, value)?;
                convert::explicit_expr(ctx.scope.rules, number, Elementary::Word)
            }
            _ => self.convert(ctx, value, Elementary::Word),
        }
    }

    fn poke_block(&mut self, ctx: &mut SclBlock, pins: &Pins, span: Span) -> Option<Vec<StatementKind>> {
        let source = self.coded(ctx, ("AREA_SRC", "DBNUMBER_SRC", "BYTEOFFSET_SRC"), pins);
        let target = self.coded(ctx, ("AREA_DEST", "DBNUMBER_DEST", "BYTEOFFSET_DEST"), pins);
        let count = self.dint(ctx, pins.get("COUNT")?);
        let (source, target, count) = (source?, target?, count?);
        let mut code = Vec::new();
        let last = minus_one(self.kept(ctx, &mut code, count));
        let at = self.temp(ctx, Elementary::Dint, span);
        let mut byte_at = |coded: Coded, code: &mut Vec<StatementKind>| {
            let area = self.kept(ctx, code, *coded.area);
            let db = self.kept(ctx, code, *coded.db);
            let start = self.kept(ctx, code, *coded.byte);
            let byte = Box::new(binary(BinaryOp::Add, start.clone(), load(&at, Elementary::Dint)));
            let area = IndexedArea::Coded { area: Box::new(area), db: Box::new(db) };
            let base = Base::Indexed { area, byte, bit: None };
            (Access { base, indices: Vec::new(), ty: DataType::Elementary(Elementary::Byte), part: None, span }, start)
        };
        let (source, from) = byte_at(source, &mut code);
        let (target, to) = byte_at(target, &mut code);
        let copy = StatementKind::Assign { target, value: load(&source, Elementary::Byte) };
        let repeated = |start: Expr, end: Expr, step: i32| StatementKind::For {
            variable: at.clone(),
            start,
            end,
            step: number(step, span),
            body: vec![Statement { kind: copy.clone(), span }],
        };
        let up = repeated(number(0, span), last.clone(), 1);
        let down = repeated(last, number(0, span), -1);
        // Where both areas overlap, no byte may be written before it is read: as through a buffer, like MOVE_BLK.
        match (&from.kind, &to.kind) {
            (ExprKind::Const(from), ExprKind::Const(to)) => {
                code.push(if *to as i32 > *from as i32 { down } else { up });
            }
            _ => {
                let is_later = comparison(CompareOp::Greater, to, from, span);
                code.push(StatementKind::If {
                    branches: vec![(is_later, vec![Statement { kind: down, span }])],
                    otherwise: vec![Statement { kind: up, span }],
                });
            }
        }
        Some(code)
    }

    /// SCATTER: bit i of IN to element i of OUT.
    fn scatter(&mut self, ctx: &mut SclBlock, pins: &Pins, span: Span) -> Option<Vec<StatementKind>> {
        let value = self.value(ctx, pins.get("IN")?)?;
        let value = self.own_type(ctx, value)?;
        let target = self.access(ctx, pins.get("OUT")?, Intent::Write)?;
        let bits = self.bits_of(&target, value.ty, pins.name)?;
        let mut code = Vec::new();
        let whole = self.temp(ctx, value.ty, span);
        code.push(StatementKind::Assign { target: whole.clone(), value });
        for (index, target) in bits.into_iter().enumerate() {
            let value = load(&bit_of(&whole, index), Elementary::Bool);
            code.push(StatementKind::Assign { target, value });
        }
        Some(code)
    }

    /// GATHER: element i of IN to bit i of OUT.
    fn gather(&mut self, ctx: &mut SclBlock, pins: &Pins, span: Span) -> Option<Vec<StatementKind>> {
        let source = self.access(ctx, pins.get("IN")?, Intent::Read)?;
        let target = self.access(ctx, pins.get("OUT")?, Intent::Write)?;
        let Some(ty) = target.elementary() else {
            let is = format!("of type {}", layout::type_name(&target.ty));
            self.wrong_type(target.span, &is, "a bit string", None);
            return None;
        };
        let bits = self.bits_of(&source, ty, pins.name)?;
        let whole = self.temp(ctx, ty, span);
        let mut code = Vec::new();
        for (index, bit) in bits.iter().enumerate() {
            let value = load(bit, Elementary::Bool);
            code.push(StatementKind::Assign { target: bit_of(&whole, index), value });
        }
        code.push(StatementKind::Assign { target, value: load(&whole, ty) });
        Some(code)
    }

    /// The BOOLs of an array or structure that hold the bits of a bit string of type `ty`.
    fn bits_of(&mut self, access: &Access, ty: Elementary, name: Span) -> Option<Vec<Access>> {
        let places: Option<Vec<(u32, u8)>> = match &access.ty {
            DataType::Array(array) if array.element == DataType::Elementary(Elementary::Bool) => {
                let count = layout::element_count(&array.bounds).min(65);
                Some((0..count).map(|index| layout::element_place(array, index)).collect())
            }
            DataType::Struct(structure) => structure
                .members
                .iter()
                .map(|member| {
                    (member.ty == DataType::Elementary(Elementary::Bool)).then_some((member.byte, member.bit))
                })
                .collect(),
            _ => None,
        };
        let Some(places) = places.filter(|places| places.len() == ty.bits() as usize && ty.bits() > 1) else {
            let text = self.program.globals.text(access.span);
            self.program.report(
                Diagnostic::new(
                    Code::TypeMismatch,
                    access.span,
                    format!("`{text}` does not have one BOOL for each bit of {}", ty.name()),
                )
                .label(format!("of type {}", layout::type_name(&access.ty)))
                .also(name, "the function")
                .help(format!("name an ARRAY[0..{}] OF BOOL, or a structure with a BOOL for each bit", ty.bits() - 1)),
            );
            return None;
        };
        places.into_iter().map(|(byte, bit)| moved(access, byte, bit)).collect()
    }

    /// DEMUX: IN to the output with number K.
    fn demux(&mut self, ctx: &mut SclBlock, pins: &Pins, span: Span) -> Option<Vec<StatementKind>> {
        let selector = self.dint(ctx, pins.get("K")?);
        if let Some(selector) = &selector {
            let otherwise = pins.get("OUTELSE").map(|node| node.span);
            self.check_selector(selector, "OUT", pins.numbered("OUT0").len(), otherwise);
        }
        let value = self.value(ctx, pins.get("IN")?)?;
        let value = self.own_type(ctx, value)?;
        let mut code = Vec::new();
        let kept = self.kept(ctx, &mut code, value);
        let mut assign = |node: &Node| {
            let target = self.access(ctx, node, Intent::Write)?;
            let Some(ty) = target.elementary() else {
                let is = format!("of type {}", layout::type_name(&target.ty));
                self.wrong_type(target.span, &is, kept.ty.name(), None);
                return None;
            };
            let value = self.implicit(ctx, kept.clone(), ty)?;
            Some(vec![Statement { kind: StatementKind::Assign { target, value }, span }])
        };
        let mut arms = Vec::new();
        for (index, node) in pins.numbered("OUT0").into_iter().enumerate() {
            arms.push(Arm { ranges: vec![(index as i128, index as i128)], body: assign(node)? });
        }
        let mut otherwise = match pins.get("OUTELSE") {
            Some(node) => assign(node)?,
            None => Vec::new(),
        };
        otherwise.push(Statement { kind: StatementKind::Failed, span });
        code.push(StatementKind::Case { selector: selector?, arms, otherwise });
        Some(code)
    }

    /// An integer of any type as DINT.
    pub fn dint(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Expr> {
        let value = self.value(ctx, node)?;
        match Shape::of(&value) {
            Shape::Of(ty) if ty.is_integer() || (ty.class() == Class::Bits && ty != Elementary::Bool) => {
                let value = self.own_type(ctx, value)?;
                convert::index(ctx.scope.rules, value)
            }
            _ => self.convert(ctx, value, Elementary::Dint),
        }
    }

    /// A variable in the block's local data, under a name that no program can use.
    pub fn temp(&mut self, ctx: &mut SclBlock, ty: Elementary, span: Span) -> Access {
        let byte = ctx.block.bound.temp_bytes.max(ctx.block.local_bytes).next_multiple_of(2);
        ctx.block.local_bytes = byte + ty.bits().div_ceil(8);
        let base = Base::Place(Place::L { byte, bit: 0 });
        Access { base, indices: Vec::new(), ty: DataType::Elementary(ty), part: None, span }
    }

    /// A value that is used more than once: a constant as it is, anything else through a variable.
    pub fn kept(&mut self, ctx: &mut SclBlock, code: &mut Vec<StatementKind>, value: Expr) -> Expr {
        if matches!(value.kind, ExprKind::Const(_)) {
            return value;
        }
        let ty = value.ty;
        let target = self.temp(ctx, ty, value.span);
        let again = load(&target, ty);
        code.push(StatementKind::Assign { target, value });
        again
    }
}

pub fn load(access: &Access, ty: Elementary) -> Expr {
    Expr { kind: ExprKind::Load(Box::new(access.clone())), ty, span: access.span }
}

/// A DINT.
pub fn number(value: i32, span: Span) -> Expr {
    Expr { kind: ExprKind::Const(u64::from(value as u32)), ty: Elementary::Dint, span }
}

/// `left op right`, both of one type.
pub fn binary(op: BinaryOp, left: Expr, right: Expr) -> Expr {
    let (ty, span) = (left.ty, left.span);
    Expr { kind: ExprKind::Binary { op, left: Box::new(left), right: Box::new(right) }, ty, span }
}

/// A DINT minus 1.
pub fn minus_one(value: Expr) -> Expr {
    let span = value.span;
    binary(BinaryOp::Subtract, value, number(1, span))
}

/// Bit `index` of a variable, 0 the lowest.
pub fn bit_of(access: &Access, index: usize) -> Access {
    let part = plcc_model::scl::Part { width: plcc_model::Width::Bit, index: index as u8 };
    Access { part: Some(part), ..access.clone() }
}

/// The BOOL at this distance in bytes and bits from the start of a variable.
fn moved(access: &Access, by: u32, at: u8) -> Option<Access> {
    elementary_at(access, by, at, Elementary::Bool)
}

/// The part of type `ty` at this distance in bytes and bits from the start of a variable.
pub fn elementary_at(access: &Access, by: u32, at: u8, ty: Elementary) -> Option<Access> {
    let mut moved = access.clone();
    moved.ty = DataType::Elementary(ty);
    let Base::Place(place) = &mut moved.base else { return None };
    let (byte, bit) = place.position_mut()?;
    *byte += by;
    *bit = at;
    Some(moved)
}

/// The whole of a complex variable as a value.
pub fn whole(access: &Access) -> Complex {
    Complex::Variable(access.clone())
}
