//! How deep in loops the blocks of machine code are.
//!
//! Blocks that reach each other are a loop. Without the jumps back to its first block, those that still reach each other are a
//! loop inside it, and so on: one walk over the function for each depth.

use rustc_hash::FxHashMap;

/// The depth of each block, at most `max`, for blocks by their offsets and the jumps between them.
pub fn depths(blocks: &[u32], edges: &[(u32, u32)], max: u32) -> Vec<u32> {
    let index: FxHashMap<u32, usize> = blocks.iter().enumerate().map(|(index, &at)| (at, index)).collect();
    let mut targets: Vec<Vec<usize>> = vec![Vec::new(); blocks.len()];
    for (from, to) in edges {
        if let (Some(&from), Some(&to)) = (index.get(from), index.get(to)) {
            targets[from].push(to);
        }
    }
    let mut depths = vec![0; blocks.len()];
    for _ in 0..max {
        let component = components(&targets);
        // The first block of each loop.
        let mut heads: FxHashMap<usize, usize> = FxHashMap::default();
        for (from, list) in targets.iter().enumerate() {
            if list.iter().any(|&to| component[to] == component[from]) {
                let head = heads.entry(component[from]).or_insert(from);
                *head = from.min(*head);
            }
        }
        if heads.is_empty() {
            break;
        }
        for (block, list) in targets.iter_mut().enumerate() {
            if let Some(&head) = heads.get(&component[block]) {
                depths[block] += 1;
                list.retain(|to| *to != head);
            }
        }
    }
    depths
}

/// For each node the number of its strongly connected component, by Tarjan's algorithm without recursion.
fn components(targets: &[Vec<usize>]) -> Vec<usize> {
    const NONE: usize = usize::MAX;
    let count = targets.len();
    let (mut order, mut low, mut component) = (vec![NONE; count], vec![0; count], vec![NONE; count]);
    let (mut stack, mut next) = (Vec::new(), 0);
    for start in 0..count {
        if order[start] != NONE {
            continue;
        }
        let mut path = vec![(start, 0)];
        while let Some((node, edge)) = path.last_mut() {
            let node = *node;
            if *edge == 0 {
                (order[node], low[node]) = (next, next);
                next += 1;
                stack.push(node);
            }
            if let Some(&to) = targets[node].get(*edge) {
                *edge += 1;
                if order[to] == NONE {
                    path.push((to, 0));
                } else if component[to] == NONE {
                    low[node] = low[node].min(order[to]);
                }
                continue;
            }
            path.pop();
            if let Some(&(above, _)) = path.last() {
                low[above] = low[above].min(low[node]);
            }
            if low[node] == order[node] {
                while let Some(member) = stack.pop() {
                    component[member] = node;
                    if member == node {
                        break;
                    }
                }
            }
        }
    }
    component
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loops_nest() {
        // 10 to 40 is a loop with the loop 20, 30 inside, which jumps to itself from 30; 60 is a loop of its own.
        let blocks = [0, 10, 20, 30, 40, 50, 60, 70];
        let edges = [
            (0, 10),
            (10, 20),
            (20, 30),
            (30, 20),
            (30, 30),
            (30, 40),
            (40, 10),
            (40, 50),
            (50, 60),
            (60, 60),
            (60, 70),
        ];
        assert_eq!(depths(&blocks, &edges, 4), [0, 1, 2, 3, 1, 0, 1, 0]);
        assert_eq!(depths(&blocks, &edges, 1), [0, 1, 1, 1, 1, 0, 1, 0]);
    }

    #[test]
    fn a_loop_whose_end_is_far_away_has_only_its_own_blocks() {
        let blocks = [0, 10, 20, 30, 40];
        let edges = [(0, 10), (10, 40), (40, 10), (10, 20), (20, 30)];
        assert_eq!(depths(&blocks, &edges, 4), [0, 1, 0, 0, 1]);
    }
}
