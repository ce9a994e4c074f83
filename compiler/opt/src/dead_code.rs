//! Removal of unused code and values, across functions.
//!
//! Starting from instructions with an effect, the pass marks everything that they need: through instructions, block parameters, and the
//! parameters and returned values of the functions of the module. The rest goes: status bits that are not read, loads,
//! parameters that only hand something on, CPU registers that no caller looks at.
//!
//! Functions that no other calls may be called from outside; their parameters and returned values stay.

use plcc_ir::analysis::ControlFlow;
use plcc_ir::entities::{Entity, EntityVec};
use plcc_ir::function::ValueDef;
use plcc_ir::{Block, FuncId, Function, Inst, InstData, Module, Value};

use crate::control_flow::remove_params;

/// Removes dead code from a module.
pub fn eliminate_dead_code(module: &mut Module) {
    crate::surroundings::for_each(&mut module.functions, &|function| {
        function.remove_unreachable_blocks();
    });
    let live = Marker::new(module).run();
    let kept: EntityVec<FuncId, Kept> = kept_interfaces(module, &live);
    for id in module.functions.keys() {
        sweep(&mut module.functions[id], &live[id], id, &kept);
    }
}

/// The used parts of a function.
struct Live {
    values: Vec<bool>,
    returns: Vec<bool>,
}

/// Which parameters and returned values of a function stay.
struct Kept {
    params: Vec<bool>,
    returns: Vec<bool>,
}

struct Marker<'a> {
    module: &'a Module,
    live: EntityVec<FuncId, Live>,
    /// Calls of each function, and its `ret` instructions.
    callers: EntityVec<FuncId, Vec<(FuncId, Inst)>>,
    returns: EntityVec<FuncId, Vec<Inst>>,
    /// Who jumps to which block.
    flows: EntityVec<FuncId, ControlFlow>,
    work: Vec<(FuncId, Value)>,
}

impl<'a> Marker<'a> {
    fn new(module: &'a Module) -> Self {
        let mut marker = Marker {
            module,
            live: EntityVec::new(),
            callers: EntityVec::new(),
            returns: EntityVec::new(),
            flows: EntityVec::new(),
            work: Vec::new(),
        };
        for function in module.functions.values() {
            let (values, returns) = (vec![false; function.values.len()], vec![false; function.returns.len()]);
            marker.live.push(Live { values, returns });
            marker.callers.push(Vec::new());
            marker.returns.push(Vec::new());
            marker.flows.push(ControlFlow::new(function));
        }
        for (id, function) in module.functions.iter() {
            for &block in &function.layout {
                for &inst in &function.blocks[block].insts {
                    marker.note(id, inst, &function.insts[inst]);
                }
            }
        }
        marker
    }

    fn note(&mut self, id: FuncId, inst: Inst, data: &InstData) {
        match data {
            InstData::Call { callee, .. } => self.callers[*callee].push((id, inst)),
            InstData::Return { .. } => self.returns[id].push(inst),
            _ => {}
        }
    }

    fn run(mut self) -> EntityVec<FuncId, Live> {
        for (id, function) in self.module.functions.iter() {
            for &block in &function.layout {
                for &inst in &function.blocks[block].insts {
                    self.mark_effect(id, &function.insts[inst]);
                }
            }
            if self.callers[id].iter().all(|&(caller, _)| caller == id) {
                for &param in &function.blocks[function.entry()].params {
                    self.mark(id, param);
                }
                for index in 0..function.returns.len() {
                    self.mark_return(id, index);
                }
            }
        }
        while let Some((id, value)) = self.work.pop() {
            let function = &self.module.functions[id];
            match function.values[value].def {
                ValueDef::Alias(other) => self.mark(id, other),
                ValueDef::Result(inst, index) => match &function.insts[inst] {
                    InstData::Call { callee, .. } => self.mark_return(*callee, index as usize),
                    data => data.for_each_use(|used| self.mark(id, used)),
                },
                ValueDef::Param(block, index) if block == function.entry() => self.mark_arguments(id, index as usize),
                ValueDef::Param(block, index) => self.mark_incoming(id, block, index as usize),
            }
        }
        self.live
    }

    /// Marks the values that an instruction needs for its effect.
    fn mark_effect(&mut self, id: FuncId, data: &InstData) {
        match data {
            InstData::Call { .. } | InstData::Return { .. } | InstData::Jump { .. } => {}
            InstData::Branch { cond: value, .. } | InstData::Switch { value, .. } => self.mark(id, *value),
            _ if data.has_side_effect() => data.for_each_use(|value| self.mark(id, value)),
            _ => {}
        }
    }

    fn mark(&mut self, id: FuncId, value: Value) {
        if !std::mem::replace(&mut self.live[id].values[value.index()], true) {
            self.work.push((id, value));
        }
    }

    fn mark_return(&mut self, id: FuncId, index: usize) {
        if std::mem::replace(&mut self.live[id].returns[index], true) {
            return;
        }
        for position in 0..self.returns[id].len() {
            let inst = self.returns[id][position];
            if let InstData::Return { values } = &self.module.functions[id].insts[inst] {
                self.mark(id, values[index]);
            }
        }
    }

    fn mark_arguments(&mut self, id: FuncId, index: usize) {
        for position in 0..self.callers[id].len() {
            let (caller, inst) = self.callers[id][position];
            if let InstData::Call { args, .. } = &self.module.functions[caller].insts[inst] {
                self.mark(caller, args[index]);
            }
        }
    }

    fn mark_incoming(&mut self, id: FuncId, block: Block, index: usize) {
        let function = &self.module.functions[id];
        for position in 0..self.flows[id].predecessors(block).len() {
            let from = self.flows[id].predecessors(block)[position];
            let Some(jump) = function.terminator(from) else { continue };
            function.insts[jump].for_each_target(|call| {
                if call.block == block {
                    self.mark(id, call.args[index]);
                }
            });
        }
    }
}

fn kept_interfaces(module: &Module, live: &EntityVec<FuncId, Live>) -> EntityVec<FuncId, Kept> {
    let mut kept = EntityVec::new();
    for (id, function) in module.functions.iter() {
        let params = &function.blocks[function.entry()].params;
        kept.push(Kept {
            params: params.iter().map(|param| live[id].values[param.index()]).collect(),
            returns: live[id].returns.clone(),
        });
    }
    kept
}

/// Removes everything that is not marked.
fn sweep(function: &mut Function, live: &Live, id: FuncId, kept: &EntityVec<FuncId, Kept>) {
    let removed: Vec<bool> = live.values.iter().map(|live| !live).collect();
    remove_params(function, &removed);
    retain_marked(&kept[id].returns, |is_marked| function.returns.retain(|_| is_marked()));
    for index in 0..function.layout.len() {
        let block = function.layout[index];
        let mut insts = std::mem::take(&mut function.blocks[block].insts);
        insts.retain(|&inst| {
            let used = |function: &Function| function.results[inst].iter().any(|result| live.values[result.index()]);
            match &mut function.insts[inst] {
                InstData::Call { callee, args } => {
                    retain_marked(&kept[*callee].params, |is_marked| args.retain(|_| is_marked()));
                    let callee = *callee;
                    let mut results = std::mem::take(&mut function.results[inst]);
                    retain_marked(&kept[callee].returns, |is_marked| results.retain(|_| is_marked()));
                    for (number, &result) in (0u32..).zip(results.as_slice()) {
                        function.values[result].def = ValueDef::Result(inst, number);
                    }
                    function.results[inst] = results;
                    true
                }
                InstData::Return { values } => {
                    retain_marked(&kept[id].returns, |is_marked| values.retain(|_| is_marked()));
                    true
                }
                data => data.has_side_effect() || used(function),
            }
        });
        function.blocks[block].insts = insts;
    }
}

fn retain_marked(marks: &[bool], retain: impl FnOnce(&mut dyn FnMut() -> bool)) {
    let mut marks = marks.iter();
    retain(&mut || marks.next().copied().unwrap_or(true));
}

#[cfg(test)]
mod tests {
    use crate::tests::check_pass;

    #[test]
    fn unread_results_loads_and_parameters_go() {
        check_pass(
            "dead-code",
            "func @F -> i32 {
            b0(v0: i32, v1: i1):
            v2 = load.i32 M 0
            v3 = iadd v2, v0
            v4 = rt @s7200_counter(v0)
            v6 = const.f32 0
            v5 = rt @sin(v6)
            jump b1(v3, v0)
            b1(v7: i32, v8: i32):
            v9 = const.i32 1
            v10 = isub v8, v9
            v11 = iadd v7, v9
            branch v1, b1(v11, v10), b2
            b2:
            ret v10
            }",
            "func @F -> i32 {
            b0(v0: i32, v1: i1):
            v2 = rt @s7200_counter(v0)
            jump b1(v0)
            b1(v3: i32):
            v4 = const.i32 1
            v5 = isub v3, v4
            branch v1, b1(v5), b2
            b2:
            ret v5
            }",
        );
    }

    #[test]
    fn what_only_goes_round_between_functions_goes() {
        check_pass(
            "dead-code",
            "entry @OB1
            func @OB1 {
            b0:
            v0 = const.i32 1
            v1, v2 = call @FC1(v0, v0)
            store.i32 M 0, v2
            ret
            }
            func @FC1 -> i32, i32 {
            b0(v0: i32, v1: i32):
            v2, v3 = call @FC1(v0, v1)
            ret v2, v1
            }",
            "entry @OB1
            func @OB1 {
            b0:
            v0 = const.i32 1
            v1 = call @FC1(v0)
            store.i32 M 0, v1
            ret
            }
            func @FC1 -> i32 {
            b0(v0: i32):
            v1 = call @FC1(v0)
            ret v0
            }",
        );
    }
}
