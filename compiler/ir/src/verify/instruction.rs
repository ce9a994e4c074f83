//! Types and regions: what one instruction takes, gives and reaches.

use plcc_abi::{Type, layout};

use super::Verifier;
use crate::entities::{Inst, Value};
use crate::instructions::{Address, BinaryOp, BlockCall, ConvertOp, InstData, IntCc, Region, UnaryOp};

impl Verifier<'_> {
    pub(super) fn check_inst(&mut self, inst: Inst) {
        let function = self.function;
        let ty = |value: Value| function.ty(value);
        let results: Vec<Type> = function.results[inst].iter().map(|&result| ty(result)).collect();
        match &function.insts[inst] {
            InstData::Const { bits } => {
                if let Some(result) = self.one_result(&results) {
                    let fits = crate::eval::mask(result, *bits) == *bits;
                    self.check(fits, "the constant does not fit its type");
                }
            }
            InstData::Unary { op, arg } => {
                let arg = ty(*arg);
                self.result_is(&results, arg);
                let fits = match op {
                    UnaryOp::Bswap => matches!(arg, Type::I16 | Type::I32 | Type::I64),
                    UnaryOp::Ctz => matches!(arg, Type::I32 | Type::I64),
                    UnaryOp::Fneg
                    | UnaryOp::Fabs
                    | UnaryOp::Fsqrt
                    | UnaryOp::Fceil
                    | UnaryOp::Ffloor
                    | UnaryOp::Ftrunc
                    | UnaryOp::Fnearest => !arg.is_int(),
                };
                self.operand_type(fits, op.name(), arg);
            }
            InstData::Binary { op, args } => {
                let arg = self.same_type(args);
                self.result_is(&results, arg);
                self.operand_type(binary_takes(*op, arg), op.name(), arg);
            }
            InstData::IntCompare { cc, args } => {
                let arg = self.same_type(args);
                self.result_is(&results, Type::I1);
                let equality = matches!(cc, IntCc::Eq | IntCc::Ne);
                self.operand_type(arg.is_int() && (arg != Type::I1 || equality), cc.name(), arg);
            }
            InstData::FloatCompare { cc, args } => {
                let arg = self.same_type(args);
                self.result_is(&results, Type::I1);
                self.operand_type(!arg.is_int(), cc.name(), arg);
            }
            InstData::Convert { op, arg } => {
                let from = ty(*arg);
                if let Some(to) = self.one_result(&results)
                    && !converts(*op, from, to)
                {
                    self.report(format!("`{}` does not go from {} to {}", op.name(), from.name(), to.name()));
                }
            }
            InstData::Select { cond, if_true, if_false } => {
                self.operand_is(*cond, Type::I1);
                let arg = self.same_type(&[*if_true, *if_false]);
                self.result_is(&results, arg);
            }
            InstData::Load { addr } => {
                if let Some(result) = self.one_result(&results) {
                    self.check(result != Type::I1, "an i1 is loaded as a bit");
                    self.check_address(addr, result.bytes());
                }
            }
            InstData::Store { addr, value } => {
                self.results_are(&results, &[]);
                self.check(ty(*value) != Type::I1, "an i1 is stored as a bit");
                self.check_address(addr, ty(*value).bytes());
            }
            InstData::LoadBit { addr, bit } => {
                self.result_is(&results, Type::I1);
                self.check(*bit < 8, "a byte has the bits 0 to 7");
                self.check_address(addr, 1);
            }
            InstData::StoreBit { addr, bit, value } => {
                self.results_are(&results, &[]);
                self.operand_is(*value, Type::I1);
                self.check(*bit < 8, "a byte has the bits 0 to 7");
                self.check_address(addr, 1);
            }
            InstData::AddressOf { addr } => {
                self.result_is(&results, Type::I32);
                self.check_address(addr, 0);
            }
            InstData::Clear { addr, len } => {
                self.results_are(&results, &[]);
                self.check_address(addr, *len);
            }
            InstData::Copy { to, from, len } => {
                self.results_are(&results, &[]);
                self.check_address(to, *len);
                self.check_address(from, *len);
            }
            InstData::DbBase { number } | InstData::DbLength { number } => {
                self.result_is(&results, Type::I32);
                self.operand_is(*number, Type::I32);
            }
            InstData::Call { callee, args } => match self.module.functions.get(*callee) {
                None => self.report(format!("{callee} does not exist")),
                Some(callee) => {
                    if let Some(&entry) = callee.layout.first() {
                        let params: Vec<Type> = callee.blocks[entry].params.iter().map(|&p| callee.ty(p)).collect();
                        self.values_are("arguments", args, &params);
                    }
                    self.results_are(&results, &callee.returns);
                }
            },
            InstData::CallRuntime { function, args } => {
                self.values_are("arguments", args, function.params());
                self.results_are(&results, function.result().as_slice());
            }
            InstData::FrameBase { .. } => self.result_is(&results, Type::I32),
            InstData::Jump { target } => {
                self.results_are(&results, &[]);
                self.check_target(target);
            }
            InstData::Branch { cond, then_to, else_to } => {
                self.results_are(&results, &[]);
                self.operand_is(*cond, Type::I1);
                self.check_target(then_to);
                self.check_target(else_to);
            }
            InstData::Switch { value, targets, default } => {
                self.results_are(&results, &[]);
                self.operand_is(*value, Type::I32);
                targets.iter().chain([default]).for_each(|target| self.check_target(target));
            }
            InstData::Return { values } => {
                self.results_are(&results, &[]);
                self.values_are("returned values", values, &function.returns);
            }
        }
    }

    fn one_result(&mut self, results: &[Type]) -> Option<Type> {
        self.check(results.len() == 1, "the instruction has one result");
        results.first().copied()
    }

    fn result_is(&mut self, results: &[Type], ty: Type) {
        self.results_are(results, &[ty]);
    }

    fn results_are(&mut self, results: &[Type], types: &[Type]) {
        if results != types {
            self.report(format!("the results are {}, not {}", type_names(types), type_names(results)));
        }
    }

    fn values_are(&mut self, what: &str, values: &[Value], types: &[Type]) {
        let actual: Vec<Type> = values.iter().map(|&value| self.function.ty(value)).collect();
        if actual != types {
            self.report(format!("the {what} are {}, not {}", type_names(types), type_names(&actual)));
        }
    }

    fn operand_is(&mut self, value: Value, ty: Type) {
        let actual = self.function.ty(value);
        if actual != ty {
            self.report(format!("{value} is {}, not {}", actual.name(), ty.name()));
        }
    }

    fn operand_type(&mut self, fits: bool, name: &str, ty: Type) {
        if !fits {
            self.report(format!("`{name}` does not take {}", ty.name()));
        }
    }

    fn same_type(&mut self, args: &[Value; 2]) -> Type {
        let ty = self.function.ty(args[0]);
        self.operand_is(args[1], ty);
        ty
    }

    fn check_target(&mut self, target: &BlockCall) {
        let function = self.function;
        let params: Vec<Type> = function.blocks[target.block].params.iter().map(|&param| function.ty(param)).collect();
        self.values_are(&format!("values for {}", target.block), &target.args, &params);
    }

    /// `len` is the size of the access in bytes.
    fn check_address(&mut self, addr: &Address, len: u32) {
        if let Some(base) = addr.base {
            self.operand_is(base, Type::I32);
        }
        let limit = match addr.region {
            Region::State | Region::I | Region::Q | Region::M | Region::System => layout::AREA_BYTES,
            Region::Cells => layout::CELLS_BYTES,
            Region::L => self.function.local_bytes(),
            Region::V => layout::L_CLASS_BYTES,
            Region::Db(number) => match self.module.db(number) {
                Some(db) => db.length,
                None => {
                    self.report(format!("the module has no DB{number}"));
                    return;
                }
            },
            Region::AnyDb | Region::Any => {
                self.check(addr.base.is_some(), "an access anywhere needs a base");
                return;
            }
        };
        let end = u64::from(addr.offset) + u64::from(len);
        if addr.base.is_none() && end > u64::from(limit) {
            let name = crate::print::region_name(addr.region);
            self.report(format!("the access ends at byte {end}, {name} has {limit}"));
        }
    }
}

fn type_names(types: &[Type]) -> String {
    let names: Vec<&str> = types.iter().map(|ty| ty.name()).collect();
    format!("({})", names.join(", "))
}

fn binary_takes(op: BinaryOp, ty: Type) -> bool {
    match op {
        BinaryOp::Iadd
        | BinaryOp::Isub
        | BinaryOp::Imul
        | BinaryOp::Sdiv
        | BinaryOp::Srem
        | BinaryOp::Udiv
        | BinaryOp::Urem
        | BinaryOp::Shl
        | BinaryOp::Lshr
        | BinaryOp::Ashr
        | BinaryOp::Rotl
        | BinaryOp::Rotr => ty.is_int() && ty != Type::I1,
        BinaryOp::And | BinaryOp::Or | BinaryOp::Xor => ty.is_int(),
        BinaryOp::Fadd | BinaryOp::Fsub | BinaryOp::Fmul | BinaryOp::Fdiv => !ty.is_int(),
    }
}

fn converts(op: ConvertOp, from: Type, to: Type) -> bool {
    let wide_int = |ty| matches!(ty, Type::I32 | Type::I64);
    match op {
        ConvertOp::Zext | ConvertOp::Sext => from.is_int() && to.is_int() && from.bits() < to.bits(),
        ConvertOp::Trunc => from.is_int() && to.is_int() && from.bits() > to.bits(),
        ConvertOp::Bitcast => from.bits() == to.bits() && from.is_int() != to.is_int(),
        ConvertOp::FromSint | ConvertOp::FromUint => wide_int(from) && !to.is_int(),
        ConvertOp::ToSint | ConvertOp::ToUint => !from.is_int() && wide_int(to),
        ConvertOp::Fpromote => (from, to) == (Type::F32, Type::F64),
        ConvertOp::Fdemote => (from, to) == (Type::F64, Type::F32),
    }
}
