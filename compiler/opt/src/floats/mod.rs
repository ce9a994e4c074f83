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
//! A statement list keeps a REAL as bits. The lesser or the greater of two is chosen among floats, which is one instruction of the
//! machine, and what a loop carries as bits only to make a float of it is carried as a float:
//!
//! ```text
//! v3 = bitcast.f32 v1
//! v4 = bitcast.f32 v2
//! v5 = flt v3, v4
//! v6 = select v5, v1, v2     ; v7 = select v5, v3, v4
//!                            ; v6 = bitcast.i32 v7
//! ```

use plcc_ir::analysis::{ControlFlow, Dominators};
use plcc_ir::entities::Entity;
use plcc_ir::function::ValueDef;
use plcc_ir::{BinaryOp, Block, ConvertOp, FloatCc, Function, Inst, InstData, Loc, Type, UnaryOp, Value, Values};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::loops::Loops;
use crate::unused::remove_unused;

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

/// Where the canonical form is chosen among bits, it is chosen among floats: operations want floats, and a statement list works on
/// bits.
fn choose_as_floats(function: &mut Function) -> bool {
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

/// Takes instructions out whose result another value has replaced.
fn drop_replaced(function: &mut Function) {
    for index in 0..function.layout.len() {
        let block = function.layout[index];
        let mut insts = std::mem::take(&mut function.blocks[block].insts);
        insts.retain(|&inst| function.results[inst].first().is_none_or(|&result| function.resolve(result) == result));
        function.blocks[block].insts = insts;
    }
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
fn carry_as_floats(function: &mut Function) -> bool {
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

/// Parameters of loops that get canonical values from within take them as they are, and are made canonical where their form is
/// seen outside. Result: whether something changed.
fn carry_raw(function: &mut Function, made: &FxHashMap<Value, Canonical>) -> bool {
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
