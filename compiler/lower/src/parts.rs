//! Parts of a block that are functions of their own: what rarely runs, and would cost the rest of the block registers.
//!
//! A part begins at a block of the function, and is all that can run after it; what other ways lead to as well is there twice. It
//! gets the values that it needs, and returns what the block returns.
//!
//! ```text
//! b3: jump b4                  ; b3: jump b4
//! b4: store.i32 M 0, v1        ; b4: v9 = call @FB1.1(v1)
//!     ret v2                   ;     ret v9
//! ```
//!
//! It has a frame of its own for what a statement needs. So only functions that keep no variables in theirs are divided, and the room of the
//! variables goes: both frames together are not longer than the one.

use plcc_abi::layout;
use plcc_ir::entities::{Entity, EntityVec, FuncId};
use plcc_ir::function::ValueDef;
use plcc_ir::{Address, Block, BlockCall, Class, Function, Inst, InstData, Loc, Region, Value, Values};
use rustc_hash::{FxHashMap, FxHashSet};

/// Where the variables of a frame begin.
const VARIABLES: Address = Address::direct(Region::L, 0);

/// Cuts the parts that begin at `starts` off a function, whose variables are in the first `variables` bytes of its frame. Result: their
/// functions, whose numbers begin with `first`.
pub fn cut(function: &mut Function, starts: &[Block], variables: u32, first: usize) -> Vec<Function> {
    let room = variables - variables % layout::FRAME_ALIGN;
    let can_begin = |start: &&Block| function.layout.contains(start) && function.blocks[**start].params.is_empty();
    let starts: Vec<Block> = starts.iter().filter(can_begin).copied().collect();
    let can_be_shorter = (room..=2 * room).contains(&function.frame_bytes);
    if starts.is_empty() || !can_be_shorter || uses_variables(function, variables) {
        return Vec::new();
    }
    leave_out_variables(function, room);
    let plans = Plan::of_all(function, &starts);
    let callees: FxHashMap<Block, FuncId> =
        starts.iter().enumerate().map(|(number, &start)| (start, FuncId::new(first + number))).collect();
    let mut parts = Vec::with_capacity(plans.len());
    for (number, plan) in plans.iter().enumerate() {
        let name = format!("{}.{}", function.name, number + 1);
        parts.push(Part::new(function, &plans, name).build(plan, &callees));
    }
    for plan in plans {
        let start = plan.order[0];
        let insts = call(function, callees[&start], plan.params.into(), place_of(function, start));
        function.blocks[start].insts = insts;
    }
    function.remove_unreachable_blocks();
    parts
}

/// A call of a part, whose results are those of the function.
fn call(function: &mut Function, callee: FuncId, args: Values, loc: Loc) -> Vec<Inst> {
    let returns = function.returns.clone();
    let call = function.make_inst(InstData::Call { callee, args }, &returns, loc);
    let values = function.results[call].as_slice().into();
    let end = function.make_inst(InstData::Return { values }, &[], loc);
    vec![call, end]
}

fn place_of(function: &Function, block: Block) -> Loc {
    function.blocks[block].insts.first().map_or(Loc(0), |&inst| function.locs[inst])
}

/// True if the function does more with local data than clear variables, and use what is after them at known places.
fn uses_variables(function: &Function, variables: u32) -> bool {
    let insts = function.layout.iter().flat_map(|&block| &function.blocks[block].insts);
    insts.map(|&inst| &function.insts[inst]).any(|data| match data {
        InstData::Clear { addr, .. } if *addr == VARIABLES => false,
        InstData::FrameBase { .. } => true,
        data => {
            let mut found = false;
            data.for_each_address(|addr| {
                found |= match addr.region {
                    Region::L => addr.base.is_some() || addr.offset < variables,
                    region => region == Region::V,
                };
            });
            found
        }
    })
}

/// Makes the frame shorter by the first `room` bytes.
fn leave_out_variables(function: &mut Function, room: u32) {
    function.frame_bytes -= room;
    for &block in &function.layout {
        let insts = &function.insts;
        let is_clear = |inst: &Inst| matches!(insts[*inst], InstData::Clear { addr, .. } if addr == VARIABLES);
        function.blocks[block].insts.retain(|inst| !is_clear(inst));
        for &inst in &function.blocks[block].insts {
            let (first, second) = match &mut function.insts[inst] {
                InstData::Load { addr }
                | InstData::Store { addr, .. }
                | InstData::LoadBit { addr, .. }
                | InstData::StoreBit { addr, .. }
                | InstData::AddressOf { addr }
                | InstData::Clear { addr, .. } => (addr, None),
                InstData::Copy { to, from, .. } => (to, Some(from)),
                _ => continue,
            };
            for addr in std::iter::once(first).chain(second).filter(|addr| addr.region == Region::L) {
                addr.offset -= room;
            }
        }
    }
}

/// What a part consists of.
struct Plan {
    /// Its blocks, the first one at the front; where another part begins it ends.
    order: Vec<Block>,
    /// The other parts that it goes on with.
    next: Vec<Block>,
    /// Values from before the part that it needs.
    needed: Vec<Value>,
    /// Those of them that are passed to it, and what computes the others of these and constants.
    params: Vec<Value>,
    computing: Vec<Inst>,
}

impl Plan {
    fn of_all(function: &Function, starts: &[Block]) -> Vec<Plan> {
        let mut plans: Vec<Plan> = starts.iter().map(|&start| Plan::new(function, start, starts)).collect();
        // What a part passes on it needs, too.
        loop {
            let mut changed = false;
            for index in 0..plans.len() {
                let next = plans[index].next.clone();
                let passed_on: Vec<Value> = (plans.iter().filter(|other| next.contains(&other.order[0])))
                    .flat_map(|other| other.params.iter().copied())
                    .collect();
                changed |= plans[index].need(function, &passed_on);
            }
            if !changed {
                return plans;
            }
        }
    }

    fn new(function: &Function, start: Block, starts: &[Block]) -> Plan {
        let (mut found, mut next) = (FxHashSet::default(), Vec::new());
        let mut work = vec![start];
        while let Some(block) = work.pop() {
            if block != start && starts.contains(&block) {
                if !next.contains(&block) {
                    next.push(block);
                }
            } else if found.insert(block)
                && let Some(end) = function.terminator(block)
            {
                function.insts[end].for_each_target(|call| work.push(call.block));
            }
        }
        found.remove(&start);
        let rest = function.layout.iter().copied().filter(|block| found.contains(block));
        let order: Vec<Block> = std::iter::once(start).chain(rest).collect();
        let mut used = Vec::new();
        for inst in order.iter().flat_map(|&block| &function.blocks[block].insts) {
            function.insts[*inst].for_each_use(|value| used.push(function.resolve(value)));
        }
        let mut plan = Plan { order, next, needed: Vec::new(), params: Vec::new(), computing: Vec::new() };
        plan.need(function, &used);
        plan
    }

    /// Adds those of some values that are not from the part itself. Result: whether there are any new ones.
    fn need(&mut self, function: &Function, values: &[Value]) -> bool {
        let mut own: FxHashSet<Value> = self.needed.iter().copied().collect();
        for &block in &self.order {
            own.extend(&function.blocks[block].params);
            own.extend(function.blocks[block].insts.iter().flat_map(|&inst| &function.results[inst]));
        }
        let before = self.needed.len();
        self.needed.extend(values.iter().filter(|&&value| own.insert(value)));
        if self.needed.len() == before {
            return false;
        }
        // Constants, and what is computed at the beginning of the function, as the address of the instance, are computed again.
        let mut asked: FxHashSet<Value> = self.needed.iter().copied().collect();
        self.computing.clear();
        let constants = self.needed.iter().filter(|&&value| function.constant(value).is_some());
        for &value in constants {
            if let ValueDef::Result(inst, _) = function.values[value].def {
                self.computing.push(inst);
                asked.remove(&value);
            }
        }
        let first = &function.blocks[function.entry()].insts;
        for &inst in first.iter().rev() {
            let data = &function.insts[inst];
            let computes = matches!(data.class(), Class::Value) || matches!(data, InstData::DbBase { .. });
            if computes && function.results[inst].iter().any(|result| asked.remove(result)) {
                self.computing.push(inst);
                data.for_each_use(|value| {
                    let value = function.resolve(value);
                    match (function.constant(value), function.values[value].def) {
                        (Some(_), ValueDef::Result(inst, _)) if !self.computing.contains(&inst) => {
                            self.computing.push(inst);
                        }
                        (Some(_), _) => {}
                        (None, _) => {
                            asked.insert(value);
                        }
                    }
                });
            }
        }
        // What is used comes first.
        self.computing.reverse();
        self.computing.sort_by_key(|&inst| function.constant(function.result(inst)).is_none());
        self.params = asked.into_iter().collect();
        self.params.sort_unstable();
        true
    }
}

/// A part while it is copied.
struct Part<'f> {
    whole: &'f Function,
    plans: &'f [Plan],
    function: Function,
    blocks: FxHashMap<Block, Block>,
    values: FxHashMap<Value, Value>,
}

impl<'f> Part<'f> {
    fn new(whole: &'f Function, plans: &'f [Plan], name: String) -> Part<'f> {
        let mut function = Function::new(name);
        function.returns = whole.returns.clone();
        function.frame_bytes = whole.frame_bytes;
        function.apart = true;
        Part { whole, plans, function, blocks: FxHashMap::default(), values: FxHashMap::default() }
    }

    fn build(mut self, plan: &Plan, callees: &FxHashMap<Block, FuncId>) -> Function {
        let whole = self.whole;
        let entry = self.function.add_block();
        for &value in &plan.params {
            let param = self.function.add_param(entry, whole.ty(value));
            self.values.insert(value, param);
        }
        for &inst in &plan.computing {
            self.copy(inst, entry);
        }
        for &block in plan.order.iter().chain(&plan.next) {
            let copy = self.function.add_block();
            self.function.blocks[copy].cold = whole.blocks[block].cold;
            self.blocks.insert(block, copy);
            for &param in &whole.blocks[block].params {
                let value = self.function.add_param(copy, whole.ty(param));
                self.values.insert(param, value);
            }
        }
        for &block in &plan.order {
            for &inst in &whole.blocks[block].insts {
                self.copy(inst, self.blocks[&block]);
            }
        }
        let mut insts = std::mem::replace(&mut self.function.insts, EntityVec::new());
        for data in insts.values_mut() {
            data.map_uses(|value| self.values.get(&whole.resolve(value)).copied().unwrap_or(value));
            data.for_each_target_mut(|call| call.block = self.blocks[&call.block]);
        }
        self.function.insts = insts;
        for other in self.plans.iter().filter(|other| plan.next.contains(&other.order[0])) {
            let start = other.order[0];
            let args = other.params.iter().map(|value| self.values[value]).collect();
            let insts = call(&mut self.function, callees[&start], args, place_of(whole, start));
            self.function.blocks[self.blocks[&start]].insts = insts;
        }
        let target = BlockCall::new(self.blocks[&plan.order[0]]);
        let jump = self.function.make_inst(InstData::Jump { target }, &[], Loc(0));
        self.function.blocks[entry].insts.push(jump);
        self.function
    }

    /// Copies an instruction to the end of a block; its operands keep their names.
    fn copy(&mut self, inst: Inst, block: Block) {
        let whole = self.whole;
        let types: Vec<_> = whole.results[inst].iter().map(|&result| whole.ty(result)).collect();
        let copy = self.function.make_inst(whole.insts[inst].clone(), &types, whole.locs[inst]);
        self.function.blocks[block].insts.push(copy);
        let results = self.function.results[copy].iter().copied();
        self.values.extend(whole.results[inst].iter().copied().zip(results));
    }
}

#[cfg(test)]
mod tests {
    use plcc_ir::parse::parse_module;
    use plcc_ir::print::module_text;

    use super::*;

    /// Cuts parts off `@F`, which begin at the blocks with these numbers, and whose variables are 16 bytes.
    #[track_caller]
    fn check(text: &str, starts: &[usize], expected: &str) {
        let mut module = parse_module(text).expect("text is well formed");
        let starts: Vec<Block> = starts.iter().map(|&start| Block::new(start)).collect();
        let whole = FuncId::new(0);
        let parts = cut(&mut module.functions[whole], &starts, 16, 1);
        parts.into_iter().for_each(|part| {
            module.functions.push(part);
        });
        let errors = plcc_ir::verify::verify(&module);
        assert!(errors.is_ok(), "{errors:?}");
        module.functions.values_mut().for_each(Function::compact);
        let expected = parse_module(expected).expect("expectation is well formed");
        assert_eq!(module_text(&module), module_text(&expected));
    }

    #[test]
    fn a_part_gets_what_it_needs_and_returns_what_the_function_returns() {
        check(
            "func @F -> i32 frame 24 {
            b0(v0: i32, v1: i1):
            clear L 0, 16
            v2 = db_base v0
            v3 = load.i32 M 0
            v4 = const.i32 7
            branch v1, b1, b2
            b1:
            store.i32 L 16, v3
            v5 = load.i32 L 16
            v6 = iadd v5, v4
            store.i32 any[v2]+0, v6
            jump b3(v6)
            b2:
            jump b3(v3)
            b3(v7: i32):
            ret v7
            }",
            &[1],
            "func @F -> i32 frame 8 {
            b0(v0: i32, v1: i1):
            v2 = db_base v0
            v3 = load.i32 M 0
            v4 = const.i32 7
            branch v1, b1, b2
            b1:
            v5 = call @F.1(v0, v3)
            ret v5
            b2:
            jump b3(v3)
            b3(v6: i32):
            ret v6
            }
            func @F.1 -> i32 frame 8 apart {
            b0(v0: i32, v1: i32):
            v2 = const.i32 7
            v3 = db_base v0
            jump b1
            b1:
            store.i32 L 0, v1
            v4 = load.i32 L 0
            v5 = iadd v4, v2
            store.i32 any[v3]+0, v5
            jump b2(v5)
            b2(v6: i32):
            ret v6
            }",
        );
    }

    #[test]
    fn a_part_ends_where_another_begins() {
        check(
            "func @F frame 16 {
            b0(v0: i32, v1: i1):
            branch v1, b1, b2
            b1:
            store.i32 M 0, v0
            jump b2
            b2:
            v2 = load.i32 M 4
            jump b3
            b3:
            store.i32 M 8, v2
            store.i32 M 12, v0
            ret
            }",
            &[1, 3],
            "func @F {
            b0(v0: i32, v1: i1):
            branch v1, b1, b2
            b1:
            call @F.1(v0)
            ret
            b2:
            v2 = load.i32 M 4
            jump b3
            b3:
            call @F.2(v0, v2)
            ret
            }
            func @F.1 apart {
            b0(v0: i32):
            jump b1
            b1:
            store.i32 M 0, v0
            jump b2
            b2:
            v1 = load.i32 M 4
            jump b3
            b3:
            call @F.2(v0, v1)
            ret
            }
            func @F.2 apart {
            b0(v0: i32, v1: i32):
            jump b1
            b1:
            store.i32 M 8, v1
            store.i32 M 12, v0
            ret
            }",
        );
    }

    #[test]
    fn a_function_with_variables_in_its_frame_stays_whole() {
        let text = "func @F frame 16 {
            b0(v0: i32):
            store.i32 L 4, v0
            jump b1
            b1:
            v1 = load.i32 L 4
            store.i32 M 0, v1
            ret
            }";
        check(text, &[1], text);
    }
}
