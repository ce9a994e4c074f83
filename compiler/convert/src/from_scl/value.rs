//! Numbers, bit strings and times in ACCU1.
//!
//! Between statements, the high bits of ACCU1 are 0 for all types of 8 or 16 bits but INT, also for a SINT below 0; for an INT they are
//! anything.

use plcc_model::scl::{BinaryOp, CompareOp, Expr, ExprKind, Function, UnaryOp};
use plcc_model::types::{Class, Elementary};
use plcc_syntax::ast::{Operand, OperandKind, SpecialRegister};
use plcc_syntax::literal::Literal;
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::character::is_character;
use super::choice::INVALID;

/// It makes unsigned numbers of 32 bits signed ones in the same order.
const SIGN: u32 = 0x8000_0000;

impl Maker<'_> {
    /// Loads the value of an expression that is not a BOOL.
    pub fn number(&mut self, value: &Expr) {
        if !self.has_type(value) {
            return;
        }
        match &value.kind {
            ExprKind::Const(bits) => {
                let operand = self.constant(value.ty, *bits);
                self.push(StlInsn::Load, Some(operand));
            }
            ExprKind::Load(access) if is_character(access) => self.load_character(access, value.ty),
            ExprKind::Load(access) if let Some(block) = self.block_in(access) => {
                let number = OperandKind::Special(SpecialRegister::DbNumber);
                self.push(StlInsn::OpenDb, Some(block));
                self.push(StlInsn::Load, Some(Operand { kind: number, span: self.span }));
            }
            ExprKind::Load(access) => {
                if let Some(target) = self.target(access, true) {
                    let operand = self.reach(&target, value.ty);
                    self.push(StlInsn::Load, Some(operand));
                }
            }
            ExprKind::Unary { op, operand } => self.unary(*op, operand, value),
            ExprKind::Binary { op, left, right } => self.binary(*op, left, right, value),
            ExprKind::Convert { conversion, operand } => self.convert(*conversion, operand, value),
            ExprKind::Function { function, arguments } => self.function(*function, arguments, value),
            ExprKind::Call(call) => {
                if let Some(result) = self.call(call) {
                    self.push(StlInsn::Load, Some(result));
                }
            }
            ExprKind::Timer(call) => self.timer(call),
            ExprKind::Counter(call) => self.counter(call),
            ExprKind::Bound { .. } => self.refuse(value.span, "bounds of ARRAY[*]", "declare the bounds of the array"),
            ExprKind::Compare { .. } | ExprKind::Cell { .. } | ExprKind::Flag | ExprKind::LastEno => {
                unreachable!("only a BOOL is of this kind")
            }
        }
    }

    /// ACCU1 holds values of the type.
    pub fn has_type(&mut self, value: &Expr) -> bool {
        let fits = value.ty.bits() <= 32;
        if !fits {
            let what = format!("values of type {}", value.ty.name());
            self.refuse(
                value.span,
                what,
                "the accumulators have 32 bits: use a type of at most 32 bits, or leave the block in SCL",
            );
        }
        fits
    }

    /// A constant as an operand that L loads.
    pub fn constant(&self, ty: Elementary, bits: u64) -> Operand {
        use Elementary::{Real, Sint, Udint, Uint, Usint};
        let is_number = f32::from_bits(bits as u32).is_finite();
        let literal = match ty {
            Real if !is_number => Literal::Dword(bits as u32),
            Usint | Sint | Uint if bits <= (i16::MAX as u64) && (ty != Sint || bits <= 0x7F) => {
                Literal::Int(bits as i64)
            }
            Sint => Literal::Byte(bits as u8),
            Uint => Literal::Word(bits as u16),
            Udint if bits <= (i32::MAX as u64) => Literal::Dint(bits as i32),
            _ => crate::operand::typed(ty, bits).unwrap_or(Literal::Dword(bits as u32)),
        };
        Operand { kind: OperandKind::Literal(literal), span: self.span }
    }

    /// One `L` loads it.
    fn is_simple(&self, value: &Expr) -> bool {
        match &value.kind {
            ExprKind::Const(_) => true,
            ExprKind::Load(access) => self.is_direct(access),
            _ => false,
        }
    }

    /// Loads `left` to ACCU2 and `right` to ACCU1; `swapped`: the other way round will do. A SINT becomes a DINT; `ordered`: unsigned
    /// values of 32 bits become DINT in the same order.
    pub fn pair(&mut self, left: &Expr, right: &Expr, swapped: bool, ordered: bool) {
        let side = |maker: &mut Self, value: &Expr| {
            maker.number(value);
            maker.as_side(value.ty, ordered);
        };
        if self.is_simple(right) {
            side(self, left);
            return side(self, right);
        }
        if self.is_simple(left) && is_plain(right) {
            side(self, right);
            side(self, left);
        } else {
            self.number(left);
            let stored = self.keep(left.ty);
            side(self, right);
            self.push(StlInsn::Load, Some(stored));
            self.as_side(left.ty, ordered);
        }
        if !swapped {
            self.push(StlInsn::SwapAccu, None);
        }
    }

    /// One of two values to be compared or computed: see [`Self::pair`].
    pub fn as_side(&mut self, ty: Elementary, ordered: bool) {
        match ty {
            Elementary::Sint => {
                self.sign_of_byte();
                self.push(StlInsn::IToD, None);
            }
            Elementary::Dword | Elementary::Udint if ordered => self.dword_constant(StlInsn::XorD, SIGN),
            _ => {}
        }
    }

    /// A SINT in ACCU1 becomes an INT.
    pub fn sign_of_byte(&mut self) {
        for insn in [StlInsn::ShiftLeftW, StlInsn::ShiftSignedI] {
            self.push(insn, Some(super::code::number(8, self.span)));
        }
    }

    // Operators.

    fn unary(&mut self, op: UnaryOp, operand: &Expr, value: &Expr) {
        use Elementary::{Byte, Dint, Dword, Int, Real, Sint, Time, Udint, Uint, Usint, Word};
        match (op, value.ty) {
            (UnaryOp::Abs, Int | Dint | Time) => return self.magnitude(operand),
            (UnaryOp::Abs, ty) if matches!(ty.class(), Class::Bits | Class::Unsigned) => return self.number(operand),
            (UnaryOp::Negate, Sint) => {
                self.number(operand);
                self.push(StlInsn::NegI, None);
                return self.mask(8);
            }
            _ => {}
        }
        let insn = match (op, value.ty) {
            (UnaryOp::Negate, Int) => StlInsn::NegI,
            (UnaryOp::Negate, Dint | Time) => StlInsn::NegD,
            (UnaryOp::Negate, Real) => StlInsn::NegR,
            (UnaryOp::Not, Word | Int | Uint) => StlInsn::InvertI,
            (UnaryOp::Not, Dword | Dint | Udint) => StlInsn::InvertD,
            (UnaryOp::Not, Byte | Sint | Usint) => {
                self.number(operand);
                return self.word_constant(StlInsn::XorW, 0xFF);
            }
            (UnaryOp::Abs, Real) => StlInsn::AbsR,
            _ => return self.no_operator(value),
        };
        self.number(operand);
        self.push(insn, None);
    }

    /// ABS of an integer.
    fn magnitude(&mut self, operand: &Expr) {
        let is_int = operand.ty == Elementary::Int;
        let (compare, negate) = match is_int {
            true => (StlInsn::CompareGeI, StlInsn::NegI),
            false => (StlInsn::CompareGeD, StlInsn::NegD),
        };
        self.number(operand);
        let stored = self.keep(operand.ty);
        let zero = self.constant(operand.ty, 0);
        let label = self.new_label();
        self.push(StlInsn::Load, Some(zero));
        self.push(compare, None);
        self.jump(StlInsn::JumpIf, &label);
        self.push(StlInsn::Load, Some(stored.clone()));
        self.push(negate, None);
        self.push(StlInsn::Transfer, Some(stored.clone()));
        self.label(&label, self.span.start);
        self.push(StlInsn::Load, Some(stored));
    }

    pub fn no_operator(&mut self, value: &Expr) {
        let what = format!("this operation with {}", value.ty.name());
        self.refuse(value.span, what, "compute it in steps, or with another type");
    }

    fn word_constant(&mut self, insn: StlInsn, bits: u16) {
        let operand = Operand { kind: OperandKind::Literal(Literal::Word(bits)), span: self.span };
        self.push(insn, Some(operand));
    }

    pub fn dword_constant(&mut self, insn: StlInsn, bits: u32) {
        let operand = Operand { kind: OperandKind::Literal(Literal::Dword(bits)), span: self.span };
        self.push(insn, Some(operand));
    }

    /// The high bits of ACCU1 become 0.
    pub fn mask(&mut self, bits: u32) {
        match bits {
            8 => self.dword_constant(StlInsn::AndD, 0xFF),
            16 => self.dword_constant(StlInsn::AndD, 0xFFFF),
            _ => {}
        }
    }

    fn binary(&mut self, op: BinaryOp, left: &Expr, right: &Expr, value: &Expr) {
        use Elementary::{Byte, Dint, Dword, Int, Real, Sint, Time, Udint, Uint, Usint, Word};
        let ty = value.ty;
        let is_small = matches!(ty, Sint | Usint | Uint);
        let (insn, commutes) = match (op, ty) {
            (BinaryOp::Add, Int) => (StlInsn::AddI, true),
            (BinaryOp::Add, Dint | Time | Sint | Usint | Uint | Udint) => (StlInsn::AddD, true),
            (BinaryOp::Add, Real) => (StlInsn::AddR, true),
            (BinaryOp::Subtract, Int) => (StlInsn::SubI, false),
            (BinaryOp::Subtract, Dint | Time | Sint | Usint | Uint | Udint) => (StlInsn::SubD, false),
            (BinaryOp::Subtract, Real) => (StlInsn::SubR, false),
            (BinaryOp::Multiply, Int) => (StlInsn::MulI, true),
            (BinaryOp::Multiply, Dint | Time | Sint | Usint | Uint | Udint) => (StlInsn::MulD, true),
            (BinaryOp::Multiply, Real) => (StlInsn::MulR, true),
            (BinaryOp::Divide | BinaryOp::Modulo, Int) => (StlInsn::DivI, false),
            (BinaryOp::Divide, Dint | Time | Sint | Usint | Uint) => (StlInsn::DivD, false),
            (BinaryOp::Divide, Real) => (StlInsn::DivR, false),
            (BinaryOp::Modulo, Dint | Time | Sint | Usint | Uint) => (StlInsn::ModD, false),
            (BinaryOp::And, Byte | Word | Int | Sint | Usint | Uint) => (StlInsn::AndW, true),
            (BinaryOp::Or, Byte | Word | Int | Sint | Usint | Uint) => (StlInsn::OrW, true),
            (BinaryOp::Xor, Byte | Word | Int | Sint | Usint | Uint) => (StlInsn::XorW, true),
            (BinaryOp::And, Dword | Dint | Udint) => (StlInsn::AndD, true),
            (BinaryOp::Or, Dword | Dint | Udint) => (StlInsn::OrD, true),
            (BinaryOp::Xor, Dword | Dint | Udint) => (StlInsn::XorD, true),
            (BinaryOp::ShiftLeft | BinaryOp::ShiftRight, _) => return self.shift(op, left, right, value),
            (BinaryOp::RotateLeft | BinaryOp::RotateRight, _) => return self.rotate(op, left, right, value),
            (BinaryOp::Min | BinaryOp::Max, _) => return self.least_or_most(op, left, right, value),
            (BinaryOp::AddDay | BinaryOp::SubtractDay, Elementary::TimeOfDay) => return self.day_time(op, left, right),
            (BinaryOp::Power, Real) if matches!(right.kind, ExprKind::Const(bits) if bits as u32 == 2.0_f32.to_bits()) =>
            {
                self.number(left);
                return self.push(StlInsn::SqrR, None);
            }
            _ => return self.no_operator(value),
        };
        self.pair(left, right, commutes, false);
        self.push(insn, None);
        if is_small && (ty == Sint || matches!(op, BinaryOp::Add | BinaryOp::Subtract | BinaryOp::Multiply)) {
            self.mask(ty.bits());
        }
        if (op, ty) == (BinaryOp::Modulo, Int) {
            // `/I` leaves the remainder in the high word.
            self.push(StlInsn::ShiftRightD, Some(super::code::number(16, self.span)));
        }
    }

    // Functions.

    fn least_or_most(&mut self, op: BinaryOp, left: &Expr, right: &Expr, value: &Expr) {
        let order = if op == BinaryOp::Min { CompareOp::LessEqual } else { CompareOp::GreaterEqual };
        let insn = match super::logic::comparison(order, value.ty) {
            Some(insn) if has_order(value.ty) => insn,
            of_real => {
                let name = if op == BinaryOp::Min { "MIN" } else { "MAX" };
                let inputs = [("IN1", left), ("IN2", right)];
                if self.instruction(name, &[("value", value.ty)], &inputs, value) {
                    return;
                }
                return match of_real {
                    Some(_) => self.least_or_most_real(op, left, right),
                    None => self.no_operator(value),
                };
            }
        };
        self.number(left);
        let chosen = self.keep(value.ty);
        self.number(right);
        let other = self.keep(value.ty);
        let label = self.new_label();
        self.push(StlInsn::Load, Some(chosen.clone()));
        self.push(StlInsn::Load, Some(other.clone()));
        self.push(insn, None);
        self.jump(StlInsn::JumpIf, &label);
        self.push(StlInsn::Load, Some(other));
        self.push(StlInsn::Transfer, Some(chosen.clone()));
        self.label(&label, self.span.start);
        self.push(StlInsn::Load, Some(chosen));
    }

    fn function(&mut self, function: Function, arguments: &[Expr], value: &Expr) {
        let simple = match function {
            Function::Sqr => StlInsn::SqrR,
            Function::Sqrt => StlInsn::SqrtR,
            Function::Exp => StlInsn::ExpR,
            Function::Ln => StlInsn::LnR,
            Function::Sin => StlInsn::SinR,
            Function::Cos => StlInsn::CosR,
            Function::Tan => StlInsn::TanR,
            Function::Asin => StlInsn::AsinR,
            Function::Acos => StlInsn::AcosR,
            Function::Atan => StlInsn::AtanR,
            Function::Limit => return self.limit(arguments, value),
            Function::Select => return self.select(arguments, value),
            Function::Mux { has_else } => return self.multiplex(has_else, arguments, value),
            Function::Swap if value.ty == Elementary::Word => StlInsn::SwapBytesWord,
            Function::Swap if value.ty == Elementary::Dword => StlInsn::SwapBytesDword,
            Function::Expd
            | Function::Log
            | Function::Frac
            | Function::Swap
            | Function::NormX
            | Function::ScaleX
            | Function::Encode
            | Function::Decode
            | Function::BitSum
            | Function::IsValid => {
                if self.function_as_instruction(function, arguments, value) {
                    return;
                }
                let name = self.positions.text(value.span).split('(').next().unwrap_or_default().trim().to_string();
                return self.refuse(value.span, format!("the function `{name}`"), "compute it in steps");
            }
        };
        self.number(&arguments[0]);
        self.push(simple, None);
    }

    /// All arguments, each in a variable.
    pub fn all_kept(&mut self, arguments: &[Expr]) -> Vec<Operand> {
        let keep_one = |maker: &mut Self, argument: &Expr| {
            match argument.ty {
                Elementary::Bool => maker.condition(argument),
                _ => maker.number(argument),
            }
            maker.keep(argument.ty)
        };
        arguments.iter().map(|argument| keep_one(self, argument)).collect()
    }

    /// `(MN, IN, MX)`: without order of the limits, IN.
    fn limit(&mut self, arguments: &[Expr], value: &Expr) {
        if !has_order(value.ty) && self.function_as_instruction(Function::Limit, arguments, value) {
            return;
        }
        let at_most = super::logic::comparison(CompareOp::LessEqual, value.ty);
        let Some(at_most) = at_most else { return self.no_operator(value) };
        let kept = self.all_kept(arguments);
        let [least, input, most] = &kept[..] else { return self.no_operator(value) };
        let end = self.new_label();
        let invalid = (value.ty == Elementary::Real).then(|| self.jump_if_invalid(&kept));
        let mut choose = |first: &Operand, second: &Operand, choice: &Operand| {
            let next = self.new_label();
            self.push(StlInsn::Load, Some(first.clone()));
            self.push(StlInsn::Load, Some(second.clone()));
            self.push(at_most, None);
            self.jump(StlInsn::JumpIf, &next);
            if choice != input {
                self.push(StlInsn::Load, Some(choice.clone()));
                self.push(StlInsn::Transfer, Some(input.clone()));
            }
            self.jump(StlInsn::Jump, &end);
            self.label(&next, self.span.start);
        };
        choose(least, most, input);
        choose(least, input, least);
        choose(input, most, most);
        if let Some(invalid) = invalid {
            self.jump(StlInsn::Jump, &end);
            self.label(&invalid, self.span.start);
            self.dword_constant(StlInsn::Load, INVALID);
            self.push(StlInsn::Transfer, Some(input.clone()));
        }
        self.label(&end, self.span.start);
        self.push(StlInsn::Load, Some(input.clone()));
    }
}

/// Two values of the type are always in an order, which an instruction of STL finds.
pub fn has_order(ty: Elementary) -> bool {
    ty != Elementary::Real && super::logic::comparison(CompareOp::LessEqual, ty).is_some()
}

/// It can be evaluated inside of nested logic, and before or after another value: without jumps, calls and bits of its own.
pub fn is_plain(value: &Expr) -> bool {
    match &value.kind {
        ExprKind::Const(_) | ExprKind::Load(_) => has_plain_indices(value),
        ExprKind::Unary { op, operand } => {
            let jumps = *op == UnaryOp::Abs && operand.ty != Elementary::Real;
            !jumps && is_plain(operand)
        }
        ExprKind::Binary { op, left, right } => {
            let jumps = match op {
                BinaryOp::Min | BinaryOp::Max | BinaryOp::AddDay | BinaryOp::SubtractDay => true,
                BinaryOp::ShiftLeft | BinaryOp::ShiftRight => {
                    super::shift::is_limited(right.ty) && !matches!(right.kind, ExprKind::Const(_))
                }
                BinaryOp::Add
                | BinaryOp::Subtract
                | BinaryOp::Multiply
                | BinaryOp::Divide
                | BinaryOp::Modulo
                | BinaryOp::Power
                | BinaryOp::And
                | BinaryOp::Or
                | BinaryOp::Xor
                | BinaryOp::RotateLeft
                | BinaryOp::RotateRight => false,
            };
            !jumps && is_plain(left) && is_plain(right)
        }
        ExprKind::Compare { left, right, .. } => is_plain(left) && is_plain(right),
        ExprKind::Convert { conversion, operand } => {
            is_plain(operand) && !super::convert::jumps(*conversion, operand, value.ty)
        }
        ExprKind::Function { function, arguments } => {
            let jumps = matches!(function, Function::Limit | Function::Select | Function::Mux { .. });
            !jumps && !super::instruction::is_called(value) && arguments.iter().all(is_plain)
        }
        ExprKind::Cell { .. } | ExprKind::Flag | ExprKind::LastEno => true,
        ExprKind::Call(_) | ExprKind::Timer(_) | ExprKind::Counter(_) | ExprKind::Bound { .. } => false,
    }
}

/// The indices of a variable are plain.
fn has_plain_indices(value: &Expr) -> bool {
    let ExprKind::Load(access) = &value.kind else { return true };
    let base = match &access.base {
        plcc_model::scl::Base::Place(_) => true,
        plcc_model::scl::Base::Indexed { byte, bit, area } => {
            let area = match area {
                plcc_model::scl::IndexedArea::DynamicDb(number) => is_plain(number),
                plcc_model::scl::IndexedArea::Memory(_)
                | plcc_model::scl::IndexedArea::Db(_)
                | plcc_model::scl::IndexedArea::Coded { .. } => true,
            };
            area && is_plain(byte) && bit.as_deref().is_none_or(is_plain)
        }
    };
    base && !is_character(access) && access.indices.iter().all(|index| is_plain(&index.value))
}
