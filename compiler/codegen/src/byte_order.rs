//! Which values can stay in the byte order of PLC memory.
//!
//! A value that is only compared for equality, selected, combined bit by bit or stored stays in the byte order of PLC
//! memory: a bit operation on swapped bytes gives swapped bytes, and two values are equal if they are equal with
//! their bytes swapped. So copies, comparisons of words and masks need no byte swaps.

use plcc_ir::entities::Entity;
use plcc_ir::{BinaryOp, Function, Inst, InstData, IntCc, Type, Value};

/// The values of a function of whose number something depends.
pub struct Numbers {
    /// By index of the value.
    is_number: Vec<bool>,
}

impl Numbers {
    /// Looks at the code of a function twice: from its beginning for what comes from memory, from its end for how that is used. Where a loop
    /// makes a use come before its definition, a value may be swapped more often than it must; what it is stays the same.
    pub fn of(function: &Function) -> Numbers {
        let mut numbers = Numbers { is_number: vec![true; function.values.len()] };
        let insts = function.layout.iter().flat_map(|&block| &function.blocks[block].insts);
        let insts: Vec<Inst> = insts.copied().collect();
        for &inst in &insts {
            if let Some(&result) = function.results[inst].first()
                && matches!(function.ty(result), Type::I16 | Type::I32 | Type::I64)
            {
                numbers.is_number[result.index()] = !numbers.is_in_memory_order(function, &function.insts[inst]);
            }
        }
        for &inst in insts.iter().rev() {
            numbers.look_at_uses(function, inst);
        }
        numbers
    }

    /// Whether the result of an instruction can be had as it is in memory.
    fn is_in_memory_order(&self, function: &Function, data: &InstData) -> bool {
        match data {
            InstData::Load { addr } => !addr.region.is_host_order(),
            InstData::Binary { .. } | InstData::Select { .. } => {
                operands(data).is_some_and(|values| values.iter().all(|&value| self.stays(function, value)))
            }
            _ => false,
        }
    }

    /// Notes the operands of an instruction that must be numbers.
    fn look_at_uses(&mut self, function: &Function, inst: Inst) {
        let data = &function.insts[inst];
        if let InstData::Store { addr, .. } = data {
            addr.base.into_iter().for_each(|base| self.note(function, base));
            return;
        }
        let Some(values) = operands(data) else { return data.for_each_use(|value| self.note(function, value)) };
        if let InstData::Select { cond, .. } = data {
            self.note(function, *cond);
        }
        let is_compared = matches!(data, InstData::IntCompare { .. });
        let is_asked_for =
            !is_compared && function.results[inst].iter().any(|&result| self.is_number(function, result));
        if is_asked_for || !values.iter().all(|&value| self.stays(function, value)) {
            values.into_iter().for_each(|value| self.note(function, value));
        }
    }

    /// A constant, or a value that is there as it is in memory.
    fn stays(&self, function: &Function, value: Value) -> bool {
        function.constant(value).is_some() || !self.is_number(function, value)
    }

    fn note(&mut self, function: &Function, value: Value) {
        self.is_number[function.resolve(value).index()] = true;
    }

    /// Whether something depends on the number, or the value has no other form.
    pub fn is_number(&self, function: &Function, value: Value) -> bool {
        self.is_number[function.resolve(value).index()]
    }
}

/// The operands of an instruction that works on bytes in either order.
fn operands(data: &InstData) -> Option<[Value; 2]> {
    match data {
        InstData::IntCompare { cc: IntCc::Eq | IntCc::Ne, args }
        | InstData::Binary { op: BinaryOp::And | BinaryOp::Or | BinaryOp::Xor, args } => Some(*args),
        InstData::Select { if_true, if_false, .. } => Some([*if_true, *if_false]),
        _ => None,
    }
}
