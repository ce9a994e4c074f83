//! Turns places in memory into SSA values: block parameters where different values meet, found by dominance frontiers.
//!
//! A pass says what instructions do with a *variable*, and [`promote`] rewrites them. Parameters are only made where the variable
//! is still needed. [`join_versions`] does the same for a value that is computed in several blocks after code was duplicated.

use plcc_ir::analysis::{ControlFlow, Dominators};
use plcc_ir::entities::Entity;
use plcc_ir::{Block, Function, Inst, InstData, Loc, Type, Value};
use rustc_hash::{FxHashMap, FxHashSet};

/// What an instruction does with variables, by number.
#[derive(Clone, Debug)]
pub enum Action {
    /// Its result is the variable; it goes.
    Read(usize),
    /// The variable becomes this value; the instruction goes.
    Write(usize, Value),
    /// The variables become 0; the instruction goes.
    Clear(Vec<usize>),
}

impl Action {
    /// Calls `f` with each variable and whether it is written; one that is read and written is not known here.
    fn for_each(&self, mut f: impl FnMut(usize, bool)) {
        match self {
            Action::Read(var) => f(*var, false),
            Action::Write(var, _) => f(*var, true),
            Action::Clear(vars) => vars.iter().for_each(|&var| f(var, true)),
        }
    }
}

/// Steps that finding the parameters may take; larger functions stay as they are.
const STEPS_MAX: usize = 2_000_000;

/// Values that are computed in several places after code was duplicated: each is a variable.
#[derive(Default)]
pub struct Versions {
    pub types: Vec<Type>,
    /// The variables of all values that are a version of one, the original among them.
    pub made: FxHashMap<Value, usize>,
    /// The variables of the originals, by which code names them.
    pub named: FxHashMap<Value, usize>,
}

impl Versions {
    /// `copy` is another version of `original`.
    pub fn add(&mut self, function: &Function, original: Value, copy: Value) {
        let var = match self.named.get(&original) {
            Some(&var) => var,
            None => {
                self.types.push(function.ty(original));
                let var = self.types.len() - 1;
                self.named.insert(original, var);
                self.made.insert(original, var);
                var
            }
        };
        self.made.insert(copy, var);
    }
}

/// Copies blocks; jumps among them lead to the copies. What the copies compute are versions of what the originals do: until
/// [`join_versions`] their operands have the names of the originals.
pub fn copy_blocks(function: &mut Function, blocks: &[Block], versions: &mut Versions) -> FxHashMap<Block, Block> {
    let mut copies: FxHashMap<Block, Block> = FxHashMap::default();
    for &block in blocks {
        let new = function.add_block();
        function.blocks[new].cold = function.blocks[block].cold;
        copies.insert(block, new);
        for param in function.blocks[block].params.clone() {
            let version = function.add_param(new, function.ty(param));
            versions.add(function, param, version);
        }
    }
    for &block in blocks {
        for inst in function.blocks[block].insts.clone() {
            let mut data = function.insts[inst].clone();
            data.for_each_target_mut(|call| call.block = copies.get(&call.block).copied().unwrap_or(call.block));
            let types: Vec<_> = function.results[inst].iter().map(|&result| function.ty(result)).collect();
            let new = function.make_inst(data, &types, function.locs[inst]);
            for (original, version) in function.results[inst].clone().into_iter().zip(function.results[new].clone()) {
                versions.add(function, original, version);
            }
            function.blocks[copies[&block]].insts.push(new);
        }
    }
    copies
}

/// Moves the constants in blocks to the end of another one before them, so that copies of the blocks have the same.
pub fn move_constants(function: &mut Function, blocks: &[Block], to: Block) {
    let mut moved = Vec::new();
    for &block in blocks {
        let insts = std::mem::take(&mut function.blocks[block].insts);
        let is_constant = |inst: &Inst| matches!(function.insts[*inst], InstData::Const { .. });
        let (constants, rest): (Vec<Inst>, Vec<Inst>) = insts.into_iter().partition(is_constant);
        moved.extend(constants);
        function.blocks[block].insts = rest;
    }
    let insts = &mut function.blocks[to].insts;
    let end = insts.len().saturating_sub(1);
    insts.splice(end..end, moved);
}

/// Makes every use of an original one of the version that was computed on the way there. It takes as long as it takes: whoever
/// duplicates code leaves large functions alone.
pub fn join_versions(function: &mut Function, versions: &Versions) {
    let none = &mut |_: &mut Function, _: usize| unreachable!("a version is computed on every way to a use");
    rewrite(function, &versions.types, &FxHashMap::default(), versions, none, usize::MAX);
}

/// Promotes variables with these types in the whole function. `initial` makes the value of a variable that is read before it is
/// written: an instruction for the begin of the function. Result: false if it would take too long, then nothing is changed.
pub fn promote(
    function: &mut Function,
    types: &[Type],
    actions: &FxHashMap<Inst, Action>,
    initial: &mut dyn FnMut(&mut Function, usize) -> Inst,
) -> bool {
    rewrite(function, types, actions, &Versions::default(), initial, STEPS_MAX)
}

fn rewrite(
    function: &mut Function,
    types: &[Type],
    actions: &FxHashMap<Inst, Action>,
    versions: &Versions,
    initial: &mut dyn FnMut(&mut Function, usize) -> Inst,
    steps_max: usize,
) -> bool {
    // Jumps from blocks that nothing reaches would not bring values for new parameters.
    function.remove_unreachable_blocks();
    let cfg = ControlFlow::new(function);
    let dominators = Dominators::new(function, &cfg);
    let Some(mut meets) = Meets::find(function, &cfg, &dominators, types.len(), actions, versions, steps_max) else {
        return false;
    };
    let mut rename = Rename {
        current: vec![None; types.len()],
        undo: Vec::new(),
        path: Vec::new(),
        params: FxHashMap::default(),
        zeros: FxHashMap::default(),
    };
    let entry = function.entry();
    let mut first = Vec::new();
    for &var in &meets.needed_at_entry {
        let inst = initial(function, var);
        first.push(inst);
        rename.current[var] = Some(function.result(inst));
    }
    for (&block, vars) in &mut meets.params {
        vars.sort_unstable();
        let params = vars.iter().map(|&var| (var, function.add_param(block, types[var]))).collect();
        rename.params.insert(block, params);
    }
    for &block in &dominators.preorder {
        rename.enter(&dominators, block);
        if !versions.made.is_empty() {
            for &param in &function.blocks[block].params {
                rename.note(versions, param);
            }
        }
        let insts = std::mem::take(&mut function.blocks[block].insts);
        let mut out = if block == entry { std::mem::take(&mut first) } else { Vec::with_capacity(insts.len()) };
        for inst in insts {
            if !versions.named.is_empty() {
                let mut data = std::mem::replace(&mut function.insts[inst], InstData::Const { bits: 0 });
                data.map_uses(|value| match versions.named.get(&function.resolve(value)) {
                    Some(&var) => rename.get(var),
                    None => value,
                });
                function.insts[inst] = data;
                for &result in &function.results[inst] {
                    rename.note(versions, result);
                }
            }
            if rename.visit(function, types, actions.get(&inst), inst, &mut out) {
                out.push(inst);
            }
        }
        function.blocks[block].insts = out;
        rename.leave(function, block);
    }
    function.resolve_aliases();
    true
}

/// Where parameters are needed.
struct Meets {
    params: FxHashMap<Block, Vec<usize>>,
    needed_at_entry: Vec<usize>,
}

impl Meets {
    fn find(
        function: &Function,
        cfg: &ControlFlow,
        dominators: &Dominators,
        count: usize,
        actions: &FxHashMap<Inst, Action>,
        versions: &Versions,
        steps_max: usize,
    ) -> Option<Meets> {
        let mut steps = 0usize;
        let mut written: Vec<Vec<Block>> = vec![Vec::new(); count];
        let mut needed: Vec<Vec<Block>> = vec![Vec::new(); count];
        let mut note = |block: Block, var: usize, writes: bool| {
            let before = written[var].last() == Some(&block);
            if writes && !before {
                written[var].push(block);
            } else if !writes && !before && needed[var].last() != Some(&block) {
                needed[var].push(block);
            }
        };
        for &block in &cfg.rpo {
            for param in &function.blocks[block].params {
                if let Some(&var) = versions.made.get(param) {
                    note(block, var, true);
                }
            }
            for &inst in &function.blocks[block].insts {
                if let Some(action) = actions.get(&inst) {
                    action.for_each(|var, writes| note(block, var, writes));
                }
                if versions.named.is_empty() {
                    continue;
                }
                function.insts[inst].for_each_use(|value| {
                    if let Some(&var) = versions.named.get(&function.resolve(value)) {
                        note(block, var, false);
                    }
                });
                for result in &function.results[inst] {
                    if let Some(&var) = versions.made.get(result) {
                        note(block, var, true);
                    }
                }
            }
        }
        let frontier = frontiers(function, cfg, dominators, &mut steps, steps_max)?;
        let mut meets = Meets { params: FxHashMap::default(), needed_at_entry: Vec::new() };
        for var in 0..count {
            let live = live_blocks(cfg, &written[var], &needed[var], &mut steps);
            if live.contains(&function.entry()) {
                meets.needed_at_entry.push(var);
            }
            let mut work = written[var].clone();
            let mut has: FxHashSet<Block> = FxHashSet::default();
            while let Some(block) = work.pop() {
                for &meet in &frontier[block.index()] {
                    steps += 1;
                    if live.contains(&meet) && has.insert(meet) {
                        meets.params.entry(meet).or_default().push(var);
                        work.push(meet);
                    }
                }
            }
            if steps > steps_max {
                return None;
            }
        }
        Some(meets)
    }
}

/// Blocks at whose begin the variable is still needed.
fn live_blocks(cfg: &ControlFlow, written: &[Block], needed: &[Block], steps: &mut usize) -> FxHashSet<Block> {
    let written: FxHashSet<Block> = written.iter().copied().collect();
    let mut live: FxHashSet<Block> = needed.iter().copied().collect();
    let mut work: Vec<Block> = needed.to_vec();
    while let Some(block) = work.pop() {
        for &pred in cfg.predecessors(block) {
            *steps += 1;
            if !written.contains(&pred) && live.insert(pred) {
                work.push(pred);
            }
        }
    }
    live
}

/// For each block the blocks where values from it meet others.
fn frontiers(
    function: &Function,
    cfg: &ControlFlow,
    dominators: &Dominators,
    steps: &mut usize,
    steps_max: usize,
) -> Option<Vec<Vec<Block>>> {
    let mut frontier: Vec<Vec<Block>> = vec![Vec::new(); function.blocks.len()];
    for &block in &cfg.rpo {
        let preds = cfg.predecessors(block);
        // Jumps back to the first block meet the parameters of the function.
        if preds.len() < 2 && (block != function.entry() || preds.is_empty()) {
            continue;
        }
        let end = dominators.immediate(block);
        for &pred in preds {
            let mut at = Some(pred);
            while let Some(runner) = at.filter(|&runner| Some(runner) != end) {
                *steps += 1;
                if *steps > steps_max {
                    return None;
                }
                if frontier[runner.index()].last() != Some(&block) {
                    frontier[runner.index()].push(block);
                }
                at = dominators.immediate(runner);
            }
        }
    }
    Some(frontier)
}

struct Rename {
    current: Vec<Option<Value>>,
    /// Values before they were changed, for the way back up the dominator tree.
    undo: Vec<(usize, Option<Value>)>,
    path: Vec<(Block, usize)>,
    params: FxHashMap<Block, Vec<(usize, Value)>>,
    /// The constant 0 of each type, in the block that is being visited.
    zeros: FxHashMap<Type, Value>,
}

impl Rename {
    fn enter(&mut self, dominators: &Dominators, block: Block) {
        while let Some(&(above, length)) = self.path.last() {
            if dominators.dominates(above, block) {
                break;
            }
            self.path.pop();
            while self.undo.len() > length {
                if let Some((var, before)) = self.undo.pop() {
                    self.current[var] = before;
                }
            }
        }
        self.path.push((block, self.undo.len()));
        self.zeros.clear();
        for (var, param) in self.params.get(&block).cloned().unwrap_or_default() {
            self.set(var, param);
        }
    }

    fn set(&mut self, var: usize, value: Value) {
        self.undo.push((var, self.current[var]));
        self.current[var] = Some(value);
    }

    /// The variable becomes this value, if it is a version of one.
    fn note(&mut self, versions: &Versions, value: Value) {
        if let Some(&var) = versions.made.get(&value) {
            self.set(var, value);
        }
    }

    fn get(&self, var: usize) -> Value {
        self.current[var].expect("a variable has a value wherever it is needed")
    }

    /// Result: whether the instruction stays.
    fn visit(
        &mut self,
        function: &mut Function,
        types: &[Type],
        action: Option<&Action>,
        inst: Inst,
        out: &mut Vec<Inst>,
    ) -> bool {
        match action {
            None => return true,
            Some(Action::Read(var)) => {
                let value = self.get(*var);
                function.replace_value(function.result(inst), value);
            }
            Some(Action::Write(var, value)) => {
                let value = function.resolve(*value);
                self.set(*var, value);
            }
            Some(Action::Clear(vars)) => {
                for &var in vars {
                    let zero = *self.zeros.entry(types[var]).or_insert_with(|| {
                        let inst = function.make_inst(InstData::Const { bits: 0 }, &[types[var]], Loc(0));
                        out.push(inst);
                        function.result(inst)
                    });
                    self.set(var, zero);
                }
            }
        }
        false
    }

    /// The jumps of the block bring the variables that are parameters there.
    fn leave(&self, function: &mut Function, block: Block) {
        let Some(inst) = function.terminator(block) else { return };
        function.insts[inst].for_each_target_mut(|call| {
            for &(var, _) in self.params.get(&call.block).into_iter().flatten() {
                call.args.push(self.get(var));
            }
        });
    }
}
