//! Floats that are not numbers get the form of the CPU only where it can be seen.
//!
//! The CPU has one form of an invalid REAL, the host has millions and hands on the form of an operand. So lowering brings the
//! result of each operation into the form of the CPU, if it is not a number:
//!
//! ```text
//! v3 = fadd v1, v2
//! v4 = funo v3, v3
//! v5 = select v4, NaN, v3    ; canonical
//! v6 = fmul v5, v2           ; is as invalid with v3 as with v5
//! ```
//!
//! An operation whose own result is made canonical, or only used by such ones and by comparisons, takes the result as the host
//! made it; so does a block that only hands on what it gets. A value that a loop carries is made canonical after the loop instead of in each pass,
//! where only then its form is seen.
//!
//! - `bits`: floats that a statement list keeps as bits are chosen and carried as floats.
//! - `carried`: what a loop carries.
//! - `numbers`: floats that are surely numbers, and need no canonical form.

use plcc_ir::entities::Entity;
use plcc_ir::{BinaryOp, ConvertOp, FloatCc, Function, Inst, InstData, UnaryOp, Value};
use rustc_hash::FxHashMap;

use bits::{carry_as_floats, choose_as_floats};
use carried::carry_raw;

mod bits;
mod carried;
mod numbers;

pub use numbers::Numbers;

/// Moves the making of canonical forms in a function. Result: false if there are none.
pub fn relax_floats(function: &mut Function) -> bool {
    let chosen = choose_as_floats(function) | carry_as_floats(function);
    let mut made = canonical_values(function);
    if made.is_empty() {
        return chosen;
    }
    if keep_numbers(function, &made) {
        made = canonical_values(function);
    }
    if carry_raw(function, &made) {
        made = canonical_values(function);
    }
    let seen = seen_forms(function, &made);
    for index in 0..function.layout.len() {
        let block = function.layout[index];
        for position in 0..function.blocks[block].insts.len() {
            let inst = function.blocks[block].insts[position];
            let free = match &function.insts[inst] {
                InstData::FloatCompare { .. } => true,
                InstData::Convert { op: ConvertOp::ToSint | ConvertOp::ToUint, .. } => true,
                data if hands_on(data) => {
                    let result = function.result(inst);
                    !seen[result.index()] && !made.contains_key(&result)
                }
                _ => false,
            };
            if free {
                let mut data = std::mem::replace(&mut function.insts[inst], InstData::Const { bits: 0 });
                data.map_uses(|value| made.get(&function.resolve(value)).map_or(value, |canonical| canonical.raw));
                function.insts[inst] = data;
            } else if function.insts[inst].is_terminator() {
                bring_as_made(function, inst, &made, &seen);
            }
        }
    }
    true
}

/// Jumps bring what the host made to parameters whose form is not seen.
fn bring_as_made(function: &mut Function, jump: Inst, made: &FxHashMap<Value, Canonical>, seen: &[bool]) {
    let mut data = std::mem::replace(&mut function.insts[jump], InstData::Const { bits: 0 });
    data.for_each_target_mut(|call| {
        for (&param, arg) in function.blocks[call.block].params.iter().zip(call.args.iter_mut()) {
            if let (false, Some(canonical)) = (seen[param.index()], made.get(&function.resolve(*arg))) {
                *arg = canonical.raw;
            }
        }
    });
    function.insts[jump] = data;
}

/// Takes instructions out whose result another value has replaced.
fn drop_replaced(function: &mut Function) {
    for index in 0..function.layout.len() {
        let block = function.layout[index];
        let mut insts = std::mem::take(&mut function.blocks[block].insts);
        insts.retain(|&inst| function.results[inst].first().is_none_or(|&result| function.resolve(result) == result));
        function.blocks[block].insts = insts;
    }
}

/// Numbers need no canonical form. Result: whether something changed.
fn keep_numbers(function: &mut Function, made: &FxHashMap<Value, Canonical>) -> bool {
    let numbers = Numbers::of(function);
    let mut changed = false;
    for (&value, canonical) in made {
        if numbers.is_number(function, canonical.raw) && function.resolve(value) == value {
            function.replace_value(value, canonical.raw);
            changed = true;
        }
    }
    if changed {
        function.resolve_aliases();
        drop_replaced(function);
    }
    changed
}

/// How a canonical value was made.
#[derive(Clone, Copy)]
struct Canonical {
    /// The value as the host made it.
    raw: Value,
    /// Bits of the form.
    form: u64,
}

/// The values that are another one in canonical form.
fn canonical_values(function: &Function) -> FxHashMap<Value, Canonical> {
    let mut made = FxHashMap::default();
    for &block in &function.layout {
        for &inst in &function.blocks[block].insts {
            if let InstData::Select { cond, if_true, if_false } = function.insts[inst]
                && let Some(InstData::FloatCompare { cc: FloatCc::Uno, args: [a, b] }) = function.defining(cond)
                && [*a, *b].map(|arg| function.resolve(arg)) == [function.resolve(if_false); 2]
                && let Some(form) = function.constant(if_true)
            {
                made.insert(function.result(inst), Canonical { raw: function.resolve(if_false), form });
            }
        }
    }
    made
}

/// Operations whose result is invalid if an operand is, in whatever form.
fn is_arithmetic(data: &InstData) -> bool {
    match data {
        InstData::Binary { op, .. } => matches!(op, BinaryOp::Fadd | BinaryOp::Fsub | BinaryOp::Fmul | BinaryOp::Fdiv),
        InstData::Unary { op, .. } => matches!(
            op,
            UnaryOp::Fneg
                | UnaryOp::Fabs
                | UnaryOp::Fsqrt
                | UnaryOp::Fceil
                | UnaryOp::Ffloor
                | UnaryOp::Ftrunc
                | UnaryOp::Fnearest
        ),
        InstData::Convert { op, .. } => matches!(op, ConvertOp::Fpromote | ConvertOp::Fdemote),
        _ => false,
    }
}

/// Instructions of which the form of an operand is seen only if that of the result is.
fn hands_on(data: &InstData) -> bool {
    is_arithmetic(data) || matches!(data, InstData::Select { .. })
}

/// Calls `f` with each operand whose form the instruction shows, by what is known to be seen so far.
fn for_each_shown(
    function: &Function,
    made: &FxHashMap<Value, Canonical>,
    seen: &[bool],
    inst: Inst,
    mut f: impl FnMut(Value),
) {
    let data = &function.insts[inst];
    match data {
        InstData::FloatCompare { .. } | InstData::Convert { op: ConvertOp::ToSint | ConvertOp::ToUint, .. } => {}
        InstData::Select { .. } if made.contains_key(&function.result(inst)) => {}
        InstData::Jump { .. } | InstData::Branch { .. } | InstData::Switch { .. } => {
            data.for_each_target(|call| {
                for (&param, &arg) in function.blocks[call.block].params.iter().zip(&call.args) {
                    if seen[param.index()] {
                        f(arg);
                    }
                }
            });
        }
        data if hands_on(data) && !seen[function.result(inst).index()] => {}
        data => data.for_each_use(f),
    }
}

/// For each value, whether its form as a not-a-number is seen: by stores, conversions to bits, calls, jumps.
fn seen_forms(function: &Function, made: &FxHashMap<Value, Canonical>) -> Vec<bool> {
    let mut seen = vec![false; function.values.len()];
    let insts = || function.layout.iter().flat_map(|&block| &function.blocks[block].insts).rev();
    // Arithmetic shows the forms of its operands only if its result is seen: from the end, until nothing is added.
    let mut shown = Vec::new();
    loop {
        let mut changed = false;
        for &inst in insts() {
            for_each_shown(function, made, &seen, inst, |value| shown.push(value));
            for value in shown.drain(..) {
                changed |= !std::mem::replace(&mut seen[function.resolve(value).index()], true);
            }
        }
        if !changed {
            return seen;
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::tests::check_pass;

    #[test]
    fn operations_take_results_as_the_host_made_them() {
        check_pass(
            "floats",
            "func @F -> f32 {
            b0(v0: f32, v1: f32):
            v2 = fadd v0, v1
            v3 = funo v2, v2
            v4 = const.f32 0xffffffff
            v5 = select v3, v4, v2
            v6 = fmul v5, v1
            v7 = funo v6, v6
            v8 = select v7, v4, v6
            ret v8
            }",
            "func @F -> f32 {
            b0(v0: f32, v1: f32):
            v2 = fadd v0, v1
            v3 = funo v2, v2
            v4 = const.f32 0xffffffff
            v5 = select v3, v4, v2
            v6 = fmul v2, v1
            v7 = funo v6, v6
            v8 = select v7, v4, v6
            ret v8
            }",
        );
    }

    #[test]
    fn a_block_that_only_compares_gets_results_as_the_host_made_them() {
        check_pass(
            "floats",
            "func @F -> i1 {
            b0(v0: f32, v1: f32, v2: i1):
            v3 = const.f32 0xffffffff
            branch v2, b1, b2(v1)
            b1:
            v4 = fdiv v0, v1
            v5 = funo v4, v4
            v6 = select v5, v3, v4
            jump b2(v6)
            b2(v7: f32):
            v8 = fmul v7, v7
            v9 = flt v8, v1
            ret v9
            }",
            "func @F -> i1 {
            b0(v0: f32, v1: f32, v2: i1):
            v3 = const.f32 0xffffffff
            branch v2, b1, b2(v1)
            b1:
            v4 = fdiv v0, v1
            v5 = funo v4, v4
            v6 = select v5, v3, v4
            jump b2(v4)
            b2(v7: f32):
            v8 = fmul v7, v7
            v9 = flt v8, v1
            ret v9
            }",
        );
    }

    #[test]
    fn a_result_whose_form_is_seen_keeps_its_operands() {
        let text = "func @F -> f32 {
            b0(v0: f32, v1: f32):
            v2 = fadd v0, v1
            v3 = funo v2, v2
            v4 = const.f32 0xffffffff
            v5 = select v3, v4, v2
            v6 = fabs v5
            ret v6
            }";
        check_pass("floats", text, text);
    }

    #[test]
    fn a_choice_whose_form_is_not_seen_chooses_among_results_as_the_host_made_them() {
        check_pass(
            "floats",
            "func @F -> f32 {
            b0(v0: f32, v1: f32):
            v2 = fadd v0, v1
            v3 = funo v2, v2
            v4 = const.f32 0xffffffff
            v5 = select v3, v4, v2
            v6 = const.f32 0x42c80000
            v7 = flt v6, v5
            v8 = select v7, v6, v5
            v9 = funo v8, v8
            v10 = select v9, v4, v8
            ret v10
            }",
            "func @F -> f32 {
            b0(v0: f32, v1: f32):
            v2 = fadd v0, v1
            v3 = funo v2, v2
            v4 = const.f32 0xffffffff
            v5 = select v3, v4, v2
            v6 = const.f32 0x42c80000
            v7 = flt v6, v2
            v8 = select v7, v6, v2
            v9 = funo v8, v8
            v10 = select v9, v4, v8
            ret v10
            }",
        );
    }
}
