//! Floats of statement lists, which keep a REAL as bits.
//!
//! The lesser or the greater of two is chosen among floats, which is one instruction of the machine, and what a loop carries as bits
//! only to make a float of it is carried as a float:
//!
//! ```text
//! v3 = bitcast.f32 v1
//! v4 = bitcast.f32 v2
//! v5 = flt v3, v4
//! v6 = select v5, v1, v2     ; v7 = select v5, v3, v4
//!                            ; v6 = bitcast.i32 v7
//! ```

use plcc_ir::{ConvertOp, FloatCc, Function, Inst, InstData, Loc, Type, Value, Values};
use rustc_hash::{FxHashMap, FxHashSet};

use super::drop_replaced;
use crate::unused::remove_unused;

/// Where the canonical form is chosen among bits, it is chosen among floats: operations want floats, and a statement list works on
/// bits.
pub(super) fn choose_as_floats(function: &mut Function) -> bool {
    let mut changed = false;
    for index in 0..function.layout.len() {
        let block = function.layout[index];
        let mut before: Vec<(Inst, Option<Inst>, Inst)> = Vec::new();
        for position in 0..function.blocks[block].insts.len() {
            let inst = function.blocks[block].insts[position];
            if let Some((bits, cond, float)) = canonical_bits(function, inst) {
                let (ty, loc) = (function.ty(float), function.locs[inst]);
                let form = function.make_inst(InstData::Const { bits }, &[ty], Loc(0));
                let if_true = function.result(form);
                let select = function.make_inst(InstData::Select { cond, if_true, if_false: float }, &[ty], loc);
                function.insts[inst] = InstData::Convert { op: ConvertOp::Bitcast, arg: function.result(select) };
                before.push((inst, Some(form), select));
                changed = true;
            } else if let Some((cond, [if_true, if_false])) = lesser_or_greater(function, inst) {
                let (ty, loc) = (function.ty(if_true), function.locs[inst]);
                let select = function.make_inst(InstData::Select { cond, if_true, if_false }, &[ty], loc);
                function.insts[inst] = InstData::Convert { op: ConvertOp::Bitcast, arg: function.result(select) };
                before.push((inst, None, select));
                changed = true;
            } else if let InstData::Convert { op: ConvertOp::Bitcast, arg } = function.insts[inst]
                && let Some(InstData::Convert { op: ConvertOp::Bitcast, arg: float }) = function.defining(arg)
                && function.ty(*float) == function.ty(function.result(inst))
            {
                let (result, float) = (function.result(inst), *float);
                function.replace_value(result, float);
                changed = true;
            }
        }
        if before.is_empty() {
            continue;
        }
        let mut before = before.into_iter().peekable();
        let insts = std::mem::take(&mut function.blocks[block].insts);
        let mut out = Vec::with_capacity(insts.len());
        for inst in insts {
            if let Some((_, form, select)) = before.next_if(|&(other, ..)| other == inst) {
                out.extend(form);
                out.push(select);
            }
            out.push(inst);
        }
        function.blocks[block].insts = out;
    }
    if changed {
        function.resolve_aliases();
        drop_replaced(function);
        // The bits that were chosen before are still made, and would show the form of each result.
        remove_unused(function);
    }
    changed
}

/// The bits of the form, the condition and the float, if `inst` chooses between the form and the bits of the float.
fn canonical_bits(function: &Function, inst: Inst) -> Option<(u64, Value, Value)> {
    let InstData::Select { cond, if_true, if_false } = function.insts[inst] else { return None };
    let bits = function.constant(if_true)?;
    let Some(&InstData::Convert { op: ConvertOp::Bitcast, arg: float }) = function.defining(if_false) else {
        return None;
    };
    let Some(InstData::FloatCompare { cc: FloatCc::Uno, args }) = function.defining(cond) else { return None };
    let float = function.resolve(float);
    (args.map(|arg| function.resolve(arg)) == [float; 2]).then_some((bits, cond, float))
}

/// The condition and the floats, if `inst` chooses the bits of the lesser or of the greater one of the two that are compared.
fn lesser_or_greater(function: &Function, inst: Inst) -> Option<(Value, [Value; 2])> {
    let InstData::Select { cond, if_true, if_false } = function.insts[inst] else { return None };
    let &InstData::FloatCompare { cc: FloatCc::Lt | FloatCc::Gt, args: [a, b] } = function.defining(cond)? else {
        return None;
    };
    if !matches!(function.ty(if_true), Type::I32 | Type::I64) {
        return None;
    }
    if has_bits(function, a, if_true) && has_bits(function, b, if_false) {
        Some((cond, [a, b]))
    } else if has_bits(function, b, if_true) && has_bits(function, a, if_false) {
        Some((cond, [b, a]))
    } else {
        None
    }
}

/// True if `bits` are the bits of `float`.
fn has_bits(function: &Function, float: Value, bits: Value) -> bool {
    let (float, bits) = (function.resolve(float), function.resolve(bits));
    let is_cast = |of: Value, value: Value| match function.defining(of) {
        Some(&InstData::Convert { op: ConvertOp::Bitcast, arg }) => function.resolve(arg) == value,
        _ => false,
    };
    is_cast(float, bits)
        || is_cast(bits, float)
        || function.constant(float).is_some_and(|constant| function.constant(bits) == Some(constant))
}

fn is_float(ty: Type) -> bool {
    matches!(ty, Type::F32 | Type::F64)
}

/// The float whose bits a value is.
fn float_of(function: &Function, value: Value) -> Option<Value> {
    match function.defining(value)? {
        &InstData::Convert { op: ConvertOp::Bitcast, arg } => is_float(function.ty(arg)).then(|| function.resolve(arg)),
        _ => None,
    }
}

/// Parameters of blocks to which some jumps bring the bits of floats, and all others constants or the parameter itself.
fn brought_floats(function: &Function) -> FxHashSet<Value> {
    let mut found = FxHashSet::default();
    let for_each_argument = |f: &mut dyn FnMut(Value, Value)| {
        for inst in function.layout.iter().filter_map(|&block| function.terminator(block)) {
            function.insts[inst].for_each_target(|call| {
                for (&param, &arg) in function.blocks[call.block].params.iter().zip(&call.args) {
                    if matches!(function.ty(param), Type::I32 | Type::I64) {
                        f(param, function.resolve(arg));
                    }
                }
            });
        }
    };
    for_each_argument(&mut |param, arg| {
        if float_of(function, arg).is_some() {
            found.insert(param);
        }
    });
    if found.is_empty() {
        return found;
    }
    for_each_argument(&mut |param, arg| {
        if arg != param && float_of(function, arg).is_none() && function.constant(arg).is_none() {
            found.remove(&param);
        }
    });
    for param in &function.blocks[function.entry()].params {
        found.remove(param);
    }
    found
}

/// Parameters of blocks that are bits, and only made floats of, are floats if what jumps bring are the bits of floats, or constants.
/// Result: whether there were any.
pub(super) fn carry_as_floats(function: &mut Function) -> bool {
    let mut candidates = brought_floats(function);
    if candidates.is_empty() {
        return false;
    }
    let mut casts: FxHashMap<Value, Vec<Value>> = FxHashMap::default();
    for &block in &function.layout {
        for &inst in &function.blocks[block].insts {
            let data = &function.insts[inst];
            if let InstData::Convert { op: ConvertOp::Bitcast, arg } = data
                && is_float(function.ty(function.result(inst)))
            {
                casts.entry(function.resolve(*arg)).or_default().push(function.result(inst));
                continue;
            }
            // A jump that brings a parameter to itself does not use its bits.
            let mut own: Vec<Value> = Vec::new();
            data.for_each_target(|call| {
                let pairs = function.blocks[call.block].params.iter().zip(&call.args);
                own.extend(pairs.filter(|&(&param, &arg)| function.resolve(arg) == param).map(|(&param, _)| param));
            });
            data.for_each_use(|value| {
                let value = function.resolve(value);
                if let Some(index) = own.iter().position(|&param| param == value) {
                    own.swap_remove(index);
                } else {
                    candidates.remove(&value);
                }
            });
        }
    }
    candidates.retain(|param| casts.contains_key(param));
    if candidates.is_empty() {
        return false;
    }
    for &block in &function.layout.clone() {
        let Some(inst) = function.terminator(block) else { continue };
        let mut data = std::mem::replace(&mut function.insts[inst], InstData::Return { values: Values::new() });
        let mut constants = Vec::new();
        data.for_each_target_mut(|call| {
            for (index, param) in function.blocks[call.block].params.clone().into_iter().enumerate() {
                let arg = function.resolve(call.args[index]);
                if !candidates.contains(&param) || arg == param {
                    continue;
                }
                call.args[index] = match float_of(function, arg) {
                    Some(float) => float,
                    None => {
                        let bits = function.constant(arg).unwrap_or_default();
                        let ty = if function.ty(arg) == Type::I64 { Type::F64 } else { Type::F32 };
                        let constant = function.make_inst(InstData::Const { bits }, &[ty], Loc(0));
                        constants.push(constant);
                        function.result(constant)
                    }
                };
            }
        });
        function.insts[inst] = data;
        let insts = &mut function.blocks[block].insts;
        let end = insts.len() - 1;
        insts.splice(end..end, constants);
    }
    for &param in &candidates {
        let is_long = function.ty(param) == Type::I64;
        function.values[param].ty = if is_long { Type::F64 } else { Type::F32 };
        for &cast in &casts[&param] {
            function.replace_value(cast, param);
        }
    }
    function.resolve_aliases();
    drop_replaced(function);
    remove_unused(function);
    true
}

#[cfg(test)]
mod tests {
    use crate::tests::check_pass;

    #[test]
    fn bits_that_nobody_looks_at_any_more_show_no_form() {
        check_pass(
            "floats",
            "func @F -> i32 {
            b0(v0: f32, v1: f32):
            v2 = fadd v0, v1
            v3 = funo v2, v2
            v4 = const.i32 0xffffffff
            v5 = bitcast.i32 v2
            v6 = select v3, v4, v5
            v7 = bitcast.f32 v6
            v8 = fmul v7, v1
            v9 = funo v8, v8
            v10 = bitcast.i32 v8
            v11 = select v9, v4, v10
            ret v11
            }",
            "func @F -> i32 {
            b0(v0: f32, v1: f32):
            v2 = fadd v0, v1
            v3 = funo v2, v2
            v4 = const.f32 0xffffffff
            v5 = select v3, v4, v2
            v6 = fmul v2, v1
            v7 = funo v6, v6
            v8 = const.f32 0xffffffff
            v9 = select v7, v8, v6
            v10 = bitcast.i32 v9
            ret v10
            }",
        );
    }

    #[test]
    fn the_least_one_is_chosen_and_carried_as_a_float() {
        check_pass(
            "floats",
            "func @F -> i32 {
            b0(v0: i32, v9: i1):
            v1 = const.i32 1900671690
            jump b1(v1)
            b1(v2: i32):
            v3 = bitcast.f32 v0
            v4 = bitcast.f32 v2
            v5 = flt v3, v4
            v6 = select v5, v0, v2
            branch v9, b1(v6), b2
            b2:
            ret v6
            }",
            "func @F -> i32 {
            b0(v0: i32, v1: i1):
            v2 = const.f32 0x7149f2ca
            jump b1(v2)
            b1(v3: f32):
            v4 = bitcast.f32 v0
            v5 = flt v4, v3
            v6 = select v5, v4, v3
            v7 = bitcast.i32 v6
            branch v1, b1(v6), b2
            b2:
            ret v7
            }",
        );
    }

    #[test]
    fn bits_that_are_chosen_by_another_comparison_stay_bits() {
        for body in ["v4 = fle v2, v3\nv5 = select v4, v0, v1", "v4 = flt v2, v3\nv5 = select v4, v0, v0"] {
            let text = format!(
                "func @F -> i32 {{\nb0(v0: i32, v1: i32):\nv2 = bitcast.f32 v0\nv3 = bitcast.f32 v1\n{body}\nret v5\n}}"
            );
            check_pass("floats", &text, &text);
        }
    }
}
