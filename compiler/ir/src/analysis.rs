//! Control flow and dominance of a function, for the verifier and the optimiser.
//!
//! Both are computed in near-linear time, without recursion: a PLC block can have tens
//! of thousands of basic blocks in a row.

use crate::entities::{Block, Entity, EntityVec};
use crate::function::Function;

/// Predecessors, successors and reverse postorder.
#[derive(Clone, Debug)]
pub struct ControlFlow {
    /// Reachable blocks; each is before the blocks that it dominates.
    pub rpo: Vec<Block>,
    /// Place in `rpo`, or `UNREACHABLE`.
    position: EntityVec<Block, u32>,
    successors: Lists,
    predecessors: Lists,
}

const UNREACHABLE: u32 = u32::MAX;

/// One list of blocks for each block, stored end to end.
#[derive(Clone, Debug)]
struct Lists {
    start: Vec<u32>,
    items: Vec<Block>,
}

impl Lists {
    #[inline]
    fn of(&self, block: Block) -> &[Block] {
        let index = block.index();
        &self.items[self.start[index] as usize..self.start[index + 1] as usize]
    }
}

impl ControlFlow {
    /// The control flow of `function` as it is at this moment.
    pub fn new(function: &Function) -> ControlFlow {
        let successors = successor_lists(function);
        let rpo = postorder_reversed(function, &successors);
        let mut position = EntityVec::filled(UNREACHABLE, function.blocks.len());
        for (index, &block) in (0u32..).zip(&rpo) {
            position[block] = index;
        }
        let predecessors = predecessor_lists(function, &successors, &rpo);
        ControlFlow { rpo, position, successors, predecessors }
    }

    /// True if a path leads from the entry to `block`.
    #[inline]
    pub fn is_reachable(&self, block: Block) -> bool {
        self.position[block] != UNREACHABLE
    }

    /// Place of a reachable block in `rpo`.
    #[inline]
    pub fn rpo_index(&self, block: Block) -> Option<usize> {
        self.is_reachable(block).then(|| self.position[block] as usize)
    }

    /// Jump targets of `block`, in order, with repeats.
    #[inline]
    pub fn successors(&self, block: Block) -> &[Block] {
        self.successors.of(block)
    }

    /// Reachable blocks that jump to `block`, once for each jump.
    #[inline]
    pub fn predecessors(&self, block: Block) -> &[Block] {
        self.predecessors.of(block)
    }
}

/// True if a jump leads back.
pub fn has_loops(function: &Function) -> bool {
    let rpo = reverse_postorder(function);
    let mut position = vec![UNREACHABLE; function.blocks.len()];
    for (index, &block) in (0u32..).zip(&rpo) {
        position[block.index()] = index;
    }
    let mut leads_back = false;
    for &block in &rpo {
        if let Some(inst) = function.terminator(block) {
            let place = position[block.index()];
            function.insts[inst].for_each_target(|call| leads_back |= position[call.block.index()] <= place);
        }
    }
    leads_back
}

/// The blocks that a path leads to from the entry: what [`ControlFlow::is_reachable`] says, in a third of the time.
pub fn reachable(function: &Function) -> EntityVec<Block, bool> {
    let mut seen = EntityVec::filled(false, function.blocks.len());
    let mut waiting = Vec::new();
    if let Some(&entry) = function.layout.first() {
        seen[entry] = true;
        waiting.push(entry);
    }
    while let Some(block) = waiting.pop() {
        let Some(inst) = function.terminator(block) else { continue };
        function.insts[inst].for_each_target(|call| {
            if !std::mem::replace(&mut seen[call.block], true) {
                waiting.push(call.block);
            }
        });
    }
    seen
}

fn successor_lists(function: &Function) -> Lists {
    let blocks = function.blocks.len();
    let mut lists = Lists { start: Vec::with_capacity(blocks + 1), items: Vec::with_capacity(2 * blocks) };
    lists.start.push(0);
    for block in function.blocks.keys() {
        if let Some(inst) = function.terminator(block) {
            function.insts[inst].for_each_target(|call| lists.items.push(call.block));
        }
        lists.start.push(lists.items.len() as u32);
    }
    lists
}

/// Reachable blocks; each is before the blocks that it dominates. The same as [`ControlFlow::rpo`], in half the time.
pub fn reverse_postorder(function: &Function) -> Vec<Block> {
    postorder_reversed(function, &successor_lists(function))
}

fn postorder_reversed(function: &Function, successors: &Lists) -> Vec<Block> {
    let mut order = Vec::with_capacity(function.layout.len());
    let Some(&entry) = function.layout.first() else { return order };
    let mut seen = vec![false; function.blocks.len()];
    seen[entry.index()] = true;
    let mut stack = vec![(entry, 0usize)];
    while let Some((block, next)) = stack.last_mut() {
        // Last target first, so that the first one comes next in reverse postorder.
        let targets = successors.of(*block);
        if *next == targets.len() {
            order.push(*block);
            stack.pop();
            continue;
        }
        let target = targets[targets.len() - 1 - *next];
        *next += 1;
        if !std::mem::replace(&mut seen[target.index()], true) {
            stack.push((target, 0));
        }
    }
    order.reverse();
    order
}

fn predecessor_lists(function: &Function, successors: &Lists, rpo: &[Block]) -> Lists {
    let mut start = vec![0u32; function.blocks.len() + 1];
    for &block in rpo {
        for target in successors.of(block) {
            start[target.index() + 1] += 1;
        }
    }
    for index in 1..start.len() {
        start[index] += start[index - 1];
    }
    let mut next = start.clone();
    let total = start.last().copied().unwrap_or(0) as usize;
    let mut items = vec![Block::new(0); total];
    for &block in rpo {
        for target in successors.of(block) {
            let slot = &mut next[target.index()];
            items[*slot as usize] = block;
            *slot += 1;
        }
    }
    Lists { start, items }
}

/// The dominator tree of the reachable blocks (Lengauer, Tarjan, "A fast algorithm for finding dominators in a flowgraph", the simple version).
#[derive(Clone, Debug)]
pub struct Dominators {
    idom: EntityVec<Block, Option<Block>>,
    /// Times of entering and leaving a block on a walk of the tree: one dominates another if it encloses it.
    enter: Vec<u32>,
    leave: Vec<u32>,
    /// Reachable blocks in the order of that walk.
    pub preorder: Vec<Block>,
}

impl Dominators {
    /// The dominators of `function`; `cfg` is its control flow.
    pub fn new(function: &Function, cfg: &ControlFlow) -> Dominators {
        let immediate = immediate_dominators(cfg);
        let mut idom = EntityVec::filled(None, function.blocks.len());
        for (index, &block) in cfg.rpo.iter().enumerate().skip(1) {
            idom[block] = Some(cfg.rpo[immediate[index] as usize]);
        }

        // The children of each block, as linked lists.
        let (mut child, mut sibling) = (vec![NONE; cfg.rpo.len()], vec![NONE; cfg.rpo.len()]);
        for index in (1..cfg.rpo.len()).rev() {
            sibling[index] = std::mem::replace(&mut child[immediate[index] as usize], index as u32);
        }
        let mut enter = vec![0; function.blocks.len()];
        let mut leave = vec![0; function.blocks.len()];
        let mut preorder = Vec::with_capacity(cfg.rpo.len());
        let mut clock = 0;
        let mut stack = Vec::new();
        if let Some(&entry) = cfg.rpo.first() {
            stack.push(0);
            enter[entry.index()] = clock;
            preorder.push(entry);
        }
        while let Some(&index) = stack.last() {
            clock += 1;
            match child[index as usize] {
                NONE => {
                    leave[cfg.rpo[index as usize].index()] = clock;
                    stack.pop();
                }
                next => {
                    child[index as usize] = sibling[next as usize];
                    let block = cfg.rpo[next as usize];
                    enter[block.index()] = clock;
                    preorder.push(block);
                    stack.push(next);
                }
            }
        }
        Dominators { idom, enter, leave, preorder }
    }

    /// The closest block that every path to `block` passes; none for the entry and for unreachable blocks.
    #[inline]
    pub fn immediate(&self, block: Block) -> Option<Block> {
        self.idom[block]
    }

    /// True if every path to `b` passes `a`; a block dominates itself. Both are reachable.
    #[inline]
    pub fn dominates(&self, a: Block, b: Block) -> bool {
        self.enter[a.index()] <= self.enter[b.index()] && self.leave[b.index()] <= self.leave[a.index()]
    }
}

/// Immediate dominators as places in the reverse postorder; the entry's is itself.
fn immediate_dominators(cfg: &ControlFlow) -> Vec<u32> {
    let walk = Walk::new(cfg);
    let count = walk.order.len();
    // All in the numbers of the walk. The semidominator of a block is the first block from which a path leads to it through later blocks alone.
    let mut semi: Vec<u32> = (0..count as u32).collect();
    let mut idom = vec![0u32; count];
    let mut forest = Forest { ancestor: vec![NONE; count], best: (0..count as u32).collect(), path: Vec::new() };
    // Blocks whose semidominator is the index, as linked lists.
    let (mut first, mut next) = (vec![NONE; count], vec![NONE; count]);
    for block in (1..count as u32).rev() {
        for &pred in cfg.predecessors(walk.order[block as usize]) {
            let best = forest.best(walk.number[pred], &semi);
            semi[block as usize] = semi[block as usize].min(semi[best as usize]);
        }
        let at = semi[block as usize] as usize;
        next[block as usize] = std::mem::replace(&mut first[at], block);
        let parent = walk.parent[block as usize];
        forest.ancestor[block as usize] = parent;
        let mut waiting = std::mem::replace(&mut first[parent as usize], NONE);
        while waiting != NONE {
            let best = forest.best(waiting, &semi);
            idom[waiting as usize] = if semi[best as usize] < semi[waiting as usize] { best } else { parent };
            waiting = next[waiting as usize];
        }
    }
    for block in 1..count {
        if idom[block] != semi[block] {
            idom[block] = idom[idom[block] as usize];
        }
    }
    let place = |number: u32| cfg.position[walk.order[number as usize]];
    cfg.rpo.iter().map(|&block| place(idom[walk.number[block] as usize])).collect()
}

const NONE: u32 = u32::MAX;

/// A walk of the reachable blocks, depth first.
struct Walk {
    order: Vec<Block>,
    number: EntityVec<Block, u32>,
    /// From which block, by number, the walk came to each.
    parent: Vec<u32>,
}

impl Walk {
    fn new(cfg: &ControlFlow) -> Walk {
        let number = EntityVec::filled(NONE, cfg.position.len());
        let blocks = cfg.rpo.len();
        let mut walk = Walk { order: Vec::with_capacity(blocks), number, parent: Vec::with_capacity(blocks) };
        let mut stack: Vec<(Block, u32)> = cfg.rpo.first().map(|&entry| (entry, 0)).into_iter().collect();
        while let Some((block, parent)) = stack.pop() {
            if walk.number[block] != NONE {
                continue;
            }
            let number = walk.order.len() as u32;
            walk.number[block] = number;
            walk.order.push(block);
            walk.parent.push(parent);
            stack.extend(cfg.successors(block).iter().map(|&target| (target, number)));
        }
        walk
    }
}

/// The part of the walk's tree that has been looked at, its paths to the roots shortened as they are used.
struct Forest {
    ancestor: Vec<u32>,
    /// The block with the least semidominator from here to before `ancestor`.
    best: Vec<u32>,
    path: Vec<u32>,
}

impl Forest {
    /// The block with the least semidominator on the path from `block` to its root, without the root.
    fn best(&mut self, block: u32, semi: &[u32]) -> u32 {
        if self.ancestor[block as usize] == NONE {
            return block;
        }
        let mut at = block;
        while self.ancestor[self.ancestor[at as usize] as usize] != NONE {
            self.path.push(at);
            at = self.ancestor[at as usize];
        }
        while let Some(at) = self.path.pop() {
            let above = self.ancestor[at as usize] as usize;
            if semi[self.best[above] as usize] < semi[self.best[at as usize] as usize] {
                self.best[at as usize] = self.best[above];
            }
            self.ancestor[at as usize] = self.ancestor[above];
        }
        self.best[block as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse::parse_module;

    #[test]
    fn dominators_of_a_loop_with_two_exits() {
        let text = "func @F {\nb0:\n v0 = const.i1 0\n jump b1\nb1:\n branch v0, b2, b3\nb2:\n branch v0, b1, b4\nb3:\n jump \
                    b4\nb4:\n ret\nb5:\n jump b4\n}\n";
        let module = parse_module(text).expect("text is well formed");
        let function = module.functions.values().next().expect("one function");
        let cfg = ControlFlow::new(function);
        let dominators = Dominators::new(function, &cfg);
        let b = |index: usize| function.layout[index];
        assert_eq!(dominators.immediate(b(4)), Some(b(1)));
        assert_eq!(dominators.immediate(b(0)), None);
        assert!(dominators.dominates(b(1), b(2)) && !dominators.dominates(b(2), b(4)));
        assert!(dominators.dominates(b(3), b(3)));
        assert!(!cfg.is_reachable(b(5)));
        assert_eq!(cfg.predecessors(b(4)), [b(2), b(3)]);
    }

    /// Random graphs: a block dominates another if that cannot be reached without it.
    #[test]
    fn dominators_are_what_paths_cannot_avoid() {
        let mut state = 1u64;
        let mut below = |limit: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % limit
        };
        for _ in 0..2000 {
            let count = 3 + below(10);
            let mut text = "func @F {\nb0:\n v0 = const.i1 0\n jump b1\n".to_string();
            for block in 1..count {
                text += &match below(4) {
                    0 => format!("b{block}:\n jump b{}\n", 1 + below(count - 1)),
                    1 => format!("b{block}:\n ret\n"),
                    _ => format!("b{block}:\n branch v0, b{}, b{}\n", 1 + below(count - 1), 1 + below(count - 1)),
                };
            }
            let module = parse_module(&(text + "}\n")).expect("text is well formed");
            let function = module.functions.values().next().expect("one function");
            let cfg = ControlFlow::new(function);
            let dominators = Dominators::new(function, &cfg);
            assert_eq!(reverse_postorder(function), cfg.rpo);
            let leads_back = |&block: &Block| {
                let to = cfg.successors(block).iter();
                to.copied().any(|target| cfg.rpo_index(target) <= cfg.rpo_index(block))
            };
            assert_eq!(has_loops(function), cfg.rpo.iter().any(leads_back));
            let reached_without = |avoided: Option<Block>| {
                let mut seen = vec![false; function.blocks.len()];
                let mut stack = vec![function.layout[0]];
                while let Some(block) = stack.pop() {
                    if Some(block) != avoided && !std::mem::replace(&mut seen[block.index()], true) {
                        stack.extend(cfg.successors(block));
                    }
                }
                seen
            };
            for &a in &cfg.rpo {
                let seen = reached_without(Some(a));
                for &b in &cfg.rpo {
                    assert_eq!(dominators.dominates(a, b), !seen[b.index()], "{a:?} {b:?}");
                }
            }
        }
    }
}
