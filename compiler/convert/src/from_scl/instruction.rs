//! Functions and conversions that STL of an S7-1500 calls as instructions with types: `CALL "LIMIT" {value_type := REAL} (…)`.
//!
//! Source: S7-1500 information system, basic instructions of STL.

use plcc_abi::image::Family;
use plcc_model::scl::{BinaryOp, Expr, ExprKind, Function};
use plcc_model::types::Elementary;
use plcc_syntax::ast::{self, CallType, Operand, OperandKind, Path, PathRoot};
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::value::{has_order, is_plain};

/// The types that a call names, by the words before `_type`.
type Types<'t> = &'t [(&'static str, Elementary)];

impl Maker<'_> {
    /// Whether STL of the CPU has instructions with types, and the name is that of no block or symbol of the program.
    pub fn has_instruction(&self, name: &str) -> bool {
        let is_own = |own: &str| own.eq_ignore_ascii_case(name);
        let is_taken = self.program.symbols.iter().any(|symbol| is_own(&symbol.name))
            || self.program.blocks.iter().any(|block| !block.library && is_own(&block.name));
        self.program.profile.family == Family::S71500 && !is_taken
    }

    /// Loads what an instruction makes of its inputs; false: the CPU does not have it in STL.
    pub fn instruction(&mut self, name: &str, types: Types, inputs: &[(&str, &Expr)], value: &Expr) -> bool {
        if !self.has_instruction(name) {
            return false;
        }
        if !inputs.iter().all(|(_, input)| self.has_type(input)) {
            return true;
        }
        let stay = inputs.iter().all(|(_, input)| is_plain(input));
        let inputs = inputs.iter().map(|(pin, input)| (*pin, self.passed(input, stay))).collect();
        self.call_instruction(name, types, inputs, value.ty);
        true
    }

    /// The same for a function of the language.
    pub fn function_as_instruction(&mut self, function: Function, arguments: &[Expr], value: &Expr) -> bool {
        let Some(last) = arguments.last() else { return false };
        let of_value = [("value", value.ty)];
        let of_source = [("src", last.ty)];
        let converting = |source: Elementary| [("src", source), ("dest", value.ty)];
        let middle = converting(arguments.get(1).unwrap_or(last).ty);
        let Some((name, pins)) = instruction_of(function) else { return false };
        let types: Types = match function {
            Function::NormX | Function::ScaleX | Function::Decode => &middle,
            Function::Limit | Function::Frac => &of_value,
            _ => &of_source,
        };
        let inputs: Vec<(&str, &Expr)> = pins.iter().copied().zip(arguments).collect();
        self.instruction(name, types, &inputs, value)
    }

    /// Converts the value in ACCU1; false: the CPU does not have the instruction in STL.
    pub fn convert_by_instruction(&mut self, name: &str, from: Elementary, to: Elementary) -> bool {
        let has = self.has_instruction(name);
        if has {
            let stored = self.keep(from);
            self.call_instruction(name, &[("src", from), ("dest", to)], vec![("IN", stored)], to);
        }
        has
    }

    /// An input: a constant, or a variable that no other input changes, itself.
    pub fn passed(&mut self, value: &Expr, stays: bool) -> Operand {
        use Elementary::{Dint, Int, Lint, Sint, Udint, Uint, Usint};
        match &value.kind {
            ExprKind::Const(bits) if matches!(value.ty, Sint | Int | Dint | Lint | Usint | Uint | Udint) => {
                return self.whole_number(value.ty, *bits);
            }
            ExprKind::Const(bits) if value.ty != Elementary::Real || f32::from_bits(*bits as u32).is_finite() => {
                return self.constant(value.ty, *bits);
            }
            ExprKind::Load(access) if stays && self.is_direct(access) => {
                if let Some(named) = self.named(access)
                    && named.exact
                {
                    return named.operand;
                }
            }
            _ => {}
        }
        self.number(value);
        self.keep(value.ty)
    }

    /// A block or an instruction as the target of a call.
    pub fn named_block(&self, name: &str) -> Operand {
        let root = PathRoot::Quoted { name: name.to_string(), span: self.span };
        Operand { kind: OperandKind::Path(Path { root, parts: Vec::new(), span: self.span }), span: self.span }
    }

    fn call_instruction(&mut self, name: &str, types: Types, inputs: Vec<(&str, Operand)>, ty: Elementary) {
        let result = self.temporary(ty);
        let named = types
            .iter()
            .map(|(word, ty)| CallType { name: format!("{word}_type"), ty: ty.name().to_string() })
            .collect();
        let parameter = |(pin, actual): (&str, Operand)| ast::Parameter {
            name: pin.to_string(),
            name_span: self.span,
            actual: Some(actual),
        };
        let parameters = inputs.into_iter().chain([("OUT", result.clone())]).map(parameter).collect();
        let call = ast::Call { target: self.named_block(name), types: named, instance: None, parameters };
        self.push_kind(ast::StatementKind::Call(Box::new(call)));
        self.push(StlInsn::Load, Some(result));
    }
}

/// The instruction with types that does what a function of the language does, and its inputs.
fn instruction_of(function: Function) -> Option<(&'static str, &'static [&'static str])> {
    Some(match function {
        Function::NormX => ("NORM_X", &["MIN", "VALUE", "MAX"]),
        Function::ScaleX => ("SCALE_X", &["MIN", "VALUE", "MAX"]),
        Function::Limit => ("LIMIT", &["MN", "IN", "MX"]),
        Function::Encode => ("ENCO", &["IN"]),
        Function::Decode => ("DECO", &["IN"]),
        Function::BitSum => ("BITSUM", &["IN"]),
        Function::Frac => ("FRAC", &["IN"]),
        Function::Sqr
        | Function::Sqrt
        | Function::Exp
        | Function::Expd
        | Function::Ln
        | Function::Log
        | Function::Sin
        | Function::Cos
        | Function::Tan
        | Function::Asin
        | Function::Acos
        | Function::Atan
        | Function::Select
        | Function::Mux { .. }
        | Function::Swap
        | Function::IsValid => return None,
    })
}

/// An instruction is called for it where the CPU has that.
pub fn is_called(value: &Expr) -> bool {
    match &value.kind {
        ExprKind::Binary { op: BinaryOp::Min | BinaryOp::Max, .. } => !has_order(value.ty),
        ExprKind::Convert { conversion, operand } => super::convert::is_called(*conversion, operand, value.ty),
        ExprKind::Function { function: Function::Limit, .. } => !has_order(value.ty),
        ExprKind::Function { function, .. } => instruction_of(*function).is_some(),
        ExprKind::Const(_)
        | ExprKind::Load(_)
        | ExprKind::Unary { .. }
        | ExprKind::Binary { .. }
        | ExprKind::Compare { .. }
        | ExprKind::Call(_)
        | ExprKind::Timer(_)
        | ExprKind::Counter(_)
        | ExprKind::Cell { .. }
        | ExprKind::Bound { .. }
        | ExprKind::Flag
        | ExprKind::LastEno => false,
    }
}
