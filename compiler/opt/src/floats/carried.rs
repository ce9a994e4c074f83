//! Floats that a loop carries: made canonical after it instead of in each pass.

use plcc_ir::analysis::{ControlFlow, Dominators};
use plcc_ir::function::ValueDef;
use plcc_ir::{Block, ConvertOp, FloatCc, Function, Inst, InstData, Loc, Type, Value, Values};
use rustc_hash::FxHashMap;

use super::{Canonical, for_each_shown, seen_forms};
use crate::loops::Loops;

/// Parameters of loops that get canonical values from within take them as they are, and are made canonical where their form is
/// seen outside. Result: whether something changed.
pub(super) fn carry_raw(function: &mut Function, made: &FxHashMap<Value, Canonical>) -> bool {
    let is_float = |&param: &Value| matches!(function.ty(param), Type::F32 | Type::F64);
    if !function.layout.iter().skip(1).any(|&block| function.blocks[block].params.iter().any(is_float)) {
        return false;
    }
    let cfg = ControlFlow::new(function);
    let dominators = Dominators::new(function, &cfg);
    let loops = Loops::new(function, &cfg, &dominators);
    // Where each value is used in a way that shows its form.
    let seen_at = uses_that_show(function, made, &cfg);
    let mut carried: FxHashMap<Value, u64> = FxHashMap::default();
    for &header in &cfg.rpo {
        let place = cfg.rpo_index(header);
        for (index, &param) in function.blocks[header].params.iter().enumerate() {
            if !matches!(function.ty(param), Type::F32 | Type::F64) {
                continue;
            }
            let mut form = None;
            let mut canonical = true;
            for &pred in cfg.predecessors(header) {
                let Some(inst) = function.terminator(pred) else { continue };
                for call in function.insts[inst].targets().into_iter().filter(|call| call.block == header) {
                    let arg = function.resolve(call.args[index]);
                    canonical &= arg == param || made.contains_key(&arg) || is_number(function, arg);
                    if cfg.rpo_index(pred) >= place {
                        form = form.or(made.get(&arg).map(|canonical| canonical.form));
                    }
                }
            }
            let outside = |&(block, _): &(Block, Inst)| loops.depth(block) < loops.depth(header);
            // What comes in another form would be seen in it if the loop makes no pass.
            if let Some(form) = form
                && canonical
                && seen_at.get(&param).is_none_or(|uses| uses.iter().all(outside))
            {
                carried.insert(param, form);
            }
        }
    }
    if carried.is_empty() {
        return false;
    }
    // Jumps bring what the host made.
    for &block in &cfg.rpo {
        let Some(inst) = function.terminator(block) else { continue };
        let mut data = std::mem::replace(&mut function.insts[inst], InstData::Return { values: Values::new() });
        data.for_each_target_mut(|call| {
            for (index, &param) in function.blocks[call.block].params.iter().enumerate() {
                if carried.contains_key(&param)
                    && let Some(canonical) = made.get(&function.resolve(call.args[index]))
                {
                    call.args[index] = canonical.raw;
                }
            }
        });
        function.insts[inst] = data;
    }
    let mut places: Vec<(Block, Inst, Value)> = Vec::new();
    for &param in carried.keys() {
        places.extend(seen_at.get(&param).into_iter().flatten().map(|&(block, inst)| (block, inst, param)));
    }
    places.sort_unstable_by_key(|&(block, inst, param)| (block, inst, param));
    for (block, inst, param) in places {
        let (ty, loc) = (function.ty(param), function.locs[inst]);
        let compare = InstData::FloatCompare { cc: FloatCc::Uno, args: [param, param] };
        let invalid = function.make_inst(compare, &[Type::I1], loc);
        let form = function.make_inst(InstData::Const { bits: carried[&param] }, &[ty], Loc(0));
        let (cond, if_true) = (function.result(invalid), function.result(form));
        let select = function.make_inst(InstData::Select { cond, if_true, if_false: param }, &[ty], loc);
        let canonical = function.result(select);
        let insts = &mut function.blocks[block].insts;
        let at = insts.iter().position(|&other| other == inst).unwrap_or(insts.len());
        insts.splice(at..at, [invalid, form, select]);
        let mut data = std::mem::replace(&mut function.insts[inst], InstData::Const { bits: 0 });
        data.map_uses(|value| if function.resolve(value) == param { canonical } else { value });
        function.insts[inst] = data;
    }
    true
}

/// True of values that are surely numbers.
fn is_number(function: &Function, value: Value) -> bool {
    match (function.defining(value), function.ty(value)) {
        (Some(InstData::Const { bits }), Type::F32) => !f32::from_bits(*bits as u32).is_nan(),
        (Some(InstData::Const { bits }), _) => !f64::from_bits(*bits).is_nan(),
        (Some(InstData::Convert { op, .. }), _) => matches!(op, ConvertOp::FromSint | ConvertOp::FromUint),
        _ => false,
    }
}

/// The instructions that show the form of each float.
fn uses_that_show(
    function: &Function,
    made: &FxHashMap<Value, Canonical>,
    cfg: &ControlFlow,
) -> FxHashMap<Value, Vec<(Block, Inst)>> {
    let seen = seen_forms(function, made);
    let mut uses: FxHashMap<Value, Vec<(Block, Inst)>> = FxHashMap::default();
    for &block in &cfg.rpo {
        for &inst in &function.blocks[block].insts {
            for_each_shown(function, made, &seen, inst, |value| {
                let value = function.resolve(value);
                if matches!(function.values[value].def, ValueDef::Param(..))
                    && matches!(function.ty(value), Type::F32 | Type::F64)
                {
                    let list = uses.entry(value).or_default();
                    if list.last() != Some(&(block, inst)) {
                        list.push((block, inst));
                    }
                }
            });
        }
    }
    uses
}

#[cfg(test)]
mod tests {
    use crate::tests::check_pass;

    #[test]
    fn a_sum_is_made_canonical_after_its_loop() {
        check_pass(
            "floats",
            "func @F -> f32 {
            b0(v1: f32, v9: i1):
            v0 = const.f32 0x0
            jump b1(v0)
            b1(v2: f32):
            v3 = fadd v2, v1
            v4 = funo v3, v3
            v5 = const.f32 0xffffffff
            v6 = select v4, v5, v3
            branch v9, b1(v6), b2
            b2:
            ret v2
            }",
            "func @F -> f32 {
            b0(v0: f32, v1: i1):
            v2 = const.f32 0x0
            jump b1(v2)
            b1(v3: f32):
            v4 = fadd v3, v0
            v5 = funo v4, v4
            v6 = const.f32 0xffffffff
            v7 = select v5, v6, v4
            branch v1, b1(v4), b2
            b2:
            v8 = funo v3, v3
            v9 = const.f32 0xffffffff
            v10 = select v8, v9, v3
            ret v10
            }",
        );
    }
}
