//! Parameters and results of functions, seen from both sides.
//!
//! - A returned value that is always the same constant, or always the same parameter, is known to the caller without asking:
//!   most blocks leave the address registers and many status bits as they were.
//! - A parameter that all callers set to the same constant is that constant.
//! - A parameter that all callers set to constants has no other bits than these have together. The address of an instance is cut to 24 bits
//!   by the block; with the bits of all its instances in place of the 24, later passes see where it ends and that it is whole bytes.
//!
//! Values that are no longer needed are then dead code.

use plcc_ir::entities::{Entity, EntityVec};
use plcc_ir::function::ValueDef;
use plcc_ir::{BinaryOp, Block, FuncId, Function, Inst, InstData, Loc, Module, Type, Value, eval};
use rustc_hash::FxHashMap;

/// Rounds over the module: knowledge goes up one level of calls with each.
const ROUNDS_MAX: usize = 4;

/// Steps from constants to a value.
const STEPS_MAX: u32 = 4;

/// Propagates the facts about parameters and returned values.
pub fn simplify_interfaces(module: &mut Module) {
    let calls = calls(module);
    let mut before: EntityVec<FuncId, Vec<Known>> = EntityVec::new();
    let mut params = EntityVec::new();
    for _ in 0..ROUNDS_MAX {
        let returned = returned_values(module);
        let changed = use_returned_values(module, &calls, &before, &returned);
        before = returned;
        params = constant_params(module, &calls);
        if !use_constant_params(module, &params) && !changed {
            break;
        }
    }
    narrow_masks(module, &params);
}

/// The calls in each function, with the blocks that they are in. Rounds add instructions, but no calls.
fn calls(module: &Module) -> EntityVec<FuncId, Vec<(Block, Inst)>> {
    let mut all = EntityVec::new();
    for function in module.functions.values() {
        let insts = function
            .layout
            .iter()
            .flat_map(|&block| function.blocks[block].insts.iter().map(move |&inst| (block, inst)));
        all.push(insts.filter(|&(_, inst)| matches!(function.insts[inst], InstData::Call { .. })).collect());
    }
    all
}

/// The facts about a value that crosses the boundary of a function.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Known {
    /// Nothing has been seen yet.
    Nothing,
    Constant(u64),
    /// One of several constants, which have these bits together.
    Bits(u64),
    /// The parameter with this number.
    Param(usize),
    Unknown,
}

impl Known {
    fn is_some(self) -> bool {
        matches!(self, Known::Constant(_) | Known::Param(_))
    }

    fn join(self, other: Known) -> Known {
        match (self, other) {
            (Known::Nothing, known) | (known, Known::Nothing) => known,
            (a, b) if a == b => a,
            (Known::Constant(a) | Known::Bits(a), Known::Constant(b) | Known::Bits(b)) => Known::Bits(a | b),
            _ => Known::Unknown,
        }
    }
}

fn known_of(function: &Function, value: Value) -> Known {
    let value = function.resolve(value);
    if let Some(bits) = computed(function, value, STEPS_MAX) {
        return Known::Constant(bits);
    }
    match function.values[value].def {
        ValueDef::Param(block, index) if block == function.entry() => Known::Param(index as usize),
        ValueDef::Param(..) | ValueDef::Result(..) | ValueDef::Alias(_) => Known::Unknown,
    }
}

/// The value if it is a constant, or computed from constants in a few steps: what a round has found is not folded before the next one.
fn computed(function: &Function, value: Value, steps: u32) -> Option<u64> {
    if let Some(bits) = function.constant(value) {
        return Some(bits);
    }
    let ty = function.ty(value);
    match *function.defining(value)? {
        InstData::Binary { op, args: [a, b] } if steps > 0 && ty == Type::I32 => {
            eval::binary(op, ty, computed(function, a, steps - 1)?, computed(function, b, steps - 1)?)
        }
        _ => None,
    }
}

fn returned_values(module: &Module) -> EntityVec<FuncId, Vec<Known>> {
    let mut all = EntityVec::new();
    for function in module.functions.values() {
        let mut known = vec![Known::Nothing; function.returns.len()];
        for &block in &function.layout {
            if let Some(inst) = function.terminator(block)
                && let InstData::Return { values } = &function.insts[inst]
            {
                for (known, &value) in known.iter_mut().zip(values) {
                    *known = known.join(known_of(function, value));
                }
            }
        }
        all.push(known);
    }
    all
}

/// Uses what calls return. `before` is what was known in the round before and is used already; empty in the first.
fn use_returned_values(
    module: &mut Module,
    calls: &EntityVec<FuncId, Vec<(Block, Inst)>>,
    before: &EntityVec<FuncId, Vec<Known>>,
    returned: &EntityVec<FuncId, Vec<Known>>,
) -> bool {
    let is_news = |callee: FuncId| before.is_empty() || before[callee] != returned[callee];
    let mut changed = false;
    for (id, function) in module.functions.iter_mut() {
        let callees = calls[id].iter().filter_map(|&(_, inst)| callee_of(function, inst));
        if !callees.clone().any(|callee| is_news(callee) && returned[callee].iter().any(|known| known.is_some())) {
            continue;
        }
        let used = used_values(function);
        let mut replaced = false;
        // Constants are put after the calls at the end, block by block.
        let mut added: FxHashMap<Inst, Vec<Inst>> = FxHashMap::default();
        for &(_, inst) in &calls[id] {
            let InstData::Call { callee, args } = &function.insts[inst] else { continue };
            let (callee, args) = (*callee, args.clone());
            for (number, known) in returned[callee].iter().enumerate() {
                let result = function.results[inst][number];
                if !used[result.index()] {
                    continue;
                }
                match *known {
                    Known::Constant(bits) => {
                        let ty = function.ty(result);
                        let new = function.make_inst(InstData::Const { bits }, &[ty], function.locs[inst]);
                        added.entry(inst).or_default().push(new);
                        let value = function.result(new);
                        replace_uses_of_result(function, result, value);
                    }
                    Known::Param(param) => replace_uses_of_result(function, result, args[param]),
                    Known::Nothing | Known::Bits(_) | Known::Unknown => continue,
                }
                replaced = true;
            }
        }
        let mut blocks: Vec<Block> = Vec::new();
        blocks.extend(calls[id].iter().filter(|(_, inst)| added.contains_key(inst)).map(|&(block, _)| block));
        blocks.dedup();
        for block in blocks {
            let with_constants = |&inst: &Inst| std::iter::once(inst).chain(added.remove(&inst).unwrap_or_default());
            function.blocks[block].insts = function.blocks[block].insts.iter().flat_map(with_constants).collect();
        }
        if replaced {
            settle_results(function);
            changed = true;
        }
    }
    changed
}

fn callee_of(function: &Function, inst: Inst) -> Option<FuncId> {
    match &function.insts[inst] {
        InstData::Call { callee, .. } => Some(*callee),
        _ => None,
    }
}

fn used_values(function: &Function) -> Vec<bool> {
    let mut used = vec![false; function.values.len()];
    for &block in &function.layout {
        for &inst in &function.blocks[block].insts {
            function.insts[inst].for_each_use(|value| used[function.resolve(value).index()] = true);
        }
    }
    used
}

/// Makes `result` a name of `value`. The call keeps its result until [`settle_results`].
fn replace_uses_of_result(function: &mut Function, result: Value, value: Value) {
    if function.resolve(value) != result {
        function.replace_value(result, value);
    }
}

/// Restores separate results of calls where these have become aliases of other values.
fn settle_results(function: &mut Function) {
    function.resolve_aliases();
    for index in 0..function.layout.len() {
        for &inst in &function.blocks[function.layout[index]].insts {
            for (number, &result) in (0u32..).zip(&function.results[inst]) {
                function.values[result].def = ValueDef::Result(inst, number);
            }
        }
    }
}

fn constant_params(module: &Module, calls: &EntityVec<FuncId, Vec<(Block, Inst)>>) -> EntityVec<FuncId, Vec<Known>> {
    let mut all = EntityVec::new();
    let mut called = vec![false; module.functions.len()];
    for function in module.functions.values() {
        all.push(vec![Known::Nothing; function.params().count()]);
    }
    for (id, function) in module.functions.iter() {
        for &(_, inst) in &calls[id] {
            let InstData::Call { callee, args } = &function.insts[inst] else { continue };
            called[callee.index()] |= *callee != id;
            for (index, &arg) in args.iter().enumerate() {
                let known = match known_of(function, arg) {
                    // A recursive call passes on the arguments of the first one.
                    Known::Param(param) if *callee == id && param == index => Known::Nothing,
                    Known::Param(_) => Known::Unknown,
                    known => known,
                };
                all[*callee][index] = all[*callee][index].join(known);
            }
        }
    }
    // A function that no other calls may be called from outside.
    for (known, called) in all.values_mut().zip(called) {
        if !called {
            known.clear();
        }
    }
    all
}

fn use_constant_params(module: &mut Module, constants: &EntityVec<FuncId, Vec<Known>>) -> bool {
    let mut changed = false;
    for id in module.functions.keys() {
        let function = &mut module.functions[id];
        let known = &constants[id];
        if !known.iter().any(|known| matches!(known, Known::Constant(_))) {
            continue;
        }
        let used = used_values(function);
        let entry = function.entry();
        let mut constants = Vec::new();
        let params = function.blocks[entry].params.clone();
        for (&param, known) in params.iter().zip(known) {
            let Known::Constant(bits) = *known else { continue };
            if !used[param.index()] {
                continue;
            }
            let ty = function.ty(param);
            let inst = function.make_inst(InstData::Const { bits }, &[ty], Loc(0));
            constants.push(inst);
            let value = function.result(inst);
            function.replace_value(param, value);
        }
        if constants.is_empty() {
            continue;
        }
        changed = true;
        function.blocks[entry].insts.splice(0..0, constants);
        function.resolve_aliases();
        for (index, &param) in (0u32..).zip(&params) {
            function.values[param].def = ValueDef::Param(entry, index);
        }
    }
    changed
}

/// Cuts the masks of parameters that have known bits to these.
fn narrow_masks(module: &mut Module, params: &EntityVec<FuncId, Vec<Known>>) {
    for id in module.functions.keys() {
        let bits_of = |known: &Known| if let Known::Bits(bits) = known { Some(*bits) } else { None };
        if !params[id].iter().any(|known| bits_of(known).is_some()) || module.entries.contains(&id) {
            continue;
        }
        let function = &mut module.functions[id];
        let entry = function.entry();
        let bits: FxHashMap<Value, u64> = (function.blocks[entry].params.iter().copied())
            .zip(&params[id])
            .filter_map(|(param, known)| Some((param, bits_of(known)?)))
            .collect();
        for index in 0..function.layout.len() {
            let block = function.layout[index];
            let mut insts = Vec::with_capacity(function.blocks[block].insts.len());
            for inst in std::mem::take(&mut function.blocks[block].insts) {
                if let InstData::Binary { op: BinaryOp::And, args: [a, b] } = function.insts[inst]
                    && let Some(&of_param) = bits.get(&function.resolve(a))
                    && let Some(mask) = function.constant(b)
                    && mask & !of_param != 0
                {
                    let ty = function.ty(b);
                    let bits = InstData::Const { bits: mask & of_param };
                    let narrow = function.make_inst(bits, &[ty], function.locs[inst]);
                    let args = [a, function.result(narrow)];
                    function.insts[inst] = InstData::Binary { op: BinaryOp::And, args };
                    insts.push(narrow);
                }
                insts.push(inst);
            }
            function.blocks[block].insts = insts;
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::tests::check_pass;

    #[test]
    fn callers_know_constants_and_what_they_passed() {
        check_pass(
            "interfaces",
            "func @F -> i32, i32 {
            b0(v0: i32):
            v1, v2, v3 = call @G(v0)
            v4 = iadd v1, v2
            ret v4, v3
            }
            func @G -> i32, i32, i32 {
            b0(v0: i32):
            v1 = const.i32 5
            v2 = load.i32 M 0
            ret v0, v1, v2
            }",
            "func @F -> i32, i32 {
            b0(v0: i32):
            v1, v2, v3 = call @G(v0)
            v4 = const.i32 5
            v5 = iadd v0, v4
            ret v5, v3
            }
            func @G -> i32, i32, i32 {
            b0(v0: i32):
            v1 = const.i32 5
            v2 = load.i32 M 0
            ret v0, v1, v2
            }",
        );
    }

    #[test]
    fn callees_know_constants() {
        check_pass(
            "interfaces",
            "func @F {
            b0(v0: i32):
            v1 = const.i32 5
            call @G(v1, v0)
            v2 = const.i32 5
            call @G(v2, v1)
            ret
            }
            func @G {
            b0(v0: i32, v1: i32):
            v2 = iadd v0, v1
            store.i32 M 0, v2
            ret
            }",
            "func @F {
            b0(v0: i32):
            v1 = const.i32 5
            call @G(v1, v0)
            v2 = const.i32 5
            call @G(v2, v1)
            ret
            }
            func @G {
            b0(v0: i32, v1: i32):
            v4 = const.i32 5
            v2 = iadd v4, v1
            store.i32 M 0, v2
            ret
            }",
        );
    }

    #[test]
    fn an_address_has_the_bits_of_all_instances() {
        let text = |mask: u32| {
            format!(
                "func @F {{
                b0(v0: i32):
                v1 = const.i32 2214592528
                call @G(v1, v0)
                v2 = const.i32 2214592624
                call @G(v2, v1)
                ret
                }}
                func @G {{
                b0(v0: i32, v1: i32):
                v2 = const.i32 {mask}
                v3 = and v0, v2
                v4 = and v1, v2
                store.i32 M 0, v3
                store.i32 M 4, v4
                ret
                }}"
            )
        };
        let mut module = plcc_ir::parse::parse_module(&text(0x00FF_FFFF)).expect("text is well formed");
        crate::run_pass(&mut module, "interfaces").expect("there is such a pass");
        let result = plcc_ir::print::module_text(&module);
        // 16 and 112, of the one that gets constants only.
        assert!(result.contains("const.i32 112") && result.contains("const.i32 16777215"), "{result}");
    }
}
