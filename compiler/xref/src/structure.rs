//! The call structure: who calls whom.

use std::collections::{BTreeMap, BTreeSet};

use plcc_abi::image::BlockKind;
use plcc_diag::SourceMap;
use plcc_model::{BlockKey, Program};
use serde::Serialize;

use crate::Access;
use crate::collect::Found;
use crate::cross;
use crate::operand::Operand;

/// The blocks with their calls.
#[derive(Clone, Debug, Serialize)]
pub struct Structure {
    /// By kind and number; also blocks of the library that are called.
    pub blocks: Vec<BlockCalls>,
    /// What the operating system calls by itself: organization blocks; on an S7-200 the main program and interrupt routines.
    pub roots: Vec<String>,
    /// Blocks with code that no path from these leads to. Calls whose number is known at run time only are not seen.
    pub not_called: Vec<String>,
}

/// A block and what it calls.
#[derive(Clone, Debug, Serialize)]
pub struct BlockCalls {
    /// `FB10`.
    pub block: String,
    pub name: String,
    /// Declared local data of the block itself, in bytes.
    pub local_bytes: u32,
    /// The most local data of a path from this block on, itself included; `None` where calls go round in a circle.
    pub path_bytes: Option<u32>,
    /// In the order of the text, each callee once for each instance.
    pub calls: Vec<Call>,
    /// Blocks that call this one.
    pub called_by: Vec<String>,
    /// It is part of a recursion.
    pub recursive: bool,
}

/// A call.
#[derive(Clone, Debug, Serialize)]
pub struct Call {
    pub block: String,
    /// `DB10`, where the call names it.
    pub instance: Option<String>,
    pub network: u16,
    pub file: String,
    pub line: u32,
}

/// What is known of a block while the structure is built.
#[derive(Default)]
struct Node {
    calls: Vec<(usize, Call)>,
    called_by: BTreeSet<usize>,
}

pub(crate) fn structure(program: &Program, sources: &SourceMap, found: &[Found]) -> Structure {
    let numbers: BTreeMap<BlockKey, usize> =
        program.blocks.iter().enumerate().map(|(index, block)| (block.key(), index)).collect();
    let text = |index: usize| Operand::Block(program.blocks[index].key()).to_string();
    let mut nodes: Vec<Node> = program.blocks.iter().map(|_| Node::default()).collect();
    let mut known = BTreeSet::new();
    let mut calls = found.iter().filter(|one| one.access == Access::Call).peekable();
    while let Some(one) = calls.next() {
        let Operand::Block(key) = one.operand else { continue };
        let Some(&callee) = numbers.get(&key) else { continue };
        // The instance of a call comes after it.
        let instance = calls.next_if(|next| {
            next.block == one.block && matches!(next.operand, Operand::Block(key) if key.kind == BlockKind::Db)
        });
        let place = cross::place(program, sources, one);
        let call = Call {
            block: text(callee),
            instance: instance.map(|one| one.operand.to_string()),
            network: place.network,
            file: place.file,
            line: place.line,
        };
        nodes[callee].called_by.insert(one.block);
        if known.insert((one.block, callee, instance.map(|one| one.operand))) {
            nodes[one.block].calls.push((callee, call));
        }
    }
    let order = callees_first(&nodes);
    let recursive = circles(&nodes, &order);
    let paths = path_bytes(program, &nodes, &order, &recursive);
    let is_root = |kind| matches!(kind, BlockKind::Ob | BlockKind::Int);
    let mut reached = vec![false; nodes.len()];
    let mut work: Vec<usize> = (0..nodes.len()).filter(|&index| is_root(program.blocks[index].kind)).collect();
    while let Some(index) = work.pop() {
        if !std::mem::replace(&mut reached[index], true) {
            work.extend(nodes[index].calls.iter().map(|(callee, _)| *callee));
        }
    }
    let blocks = nodes.iter().enumerate().map(|(index, node)| BlockCalls {
        block: text(index),
        name: program.blocks[index].name.clone(),
        local_bytes: program.blocks[index].temp_bytes,
        path_bytes: paths[index],
        calls: node.calls.iter().map(|(_, call)| call.clone()).collect(),
        called_by: node.called_by.iter().map(|&caller| text(caller)).collect(),
        recursive: recursive[index],
    });
    let of = |wanted: &dyn Fn(usize) -> bool| (0..nodes.len()).filter(|&index| wanted(index)).map(text).collect();
    Structure {
        blocks: blocks.collect(),
        roots: of(&|index| is_root(program.blocks[index].kind)),
        not_called: of(&|index| {
            let block = &program.blocks[index];
            !block.library && !reached[index]
        }),
    }
}

/// The nodes in an order in which callees come before their callers, where calls do not go round in a circle.
fn callees_first(nodes: &[Node]) -> Vec<usize> {
    let mut order = Vec::with_capacity(nodes.len());
    let mut seen = vec![false; nodes.len()];
    for root in 0..nodes.len() {
        // A node and the number of its calls that are done.
        let mut work = vec![(root, 0)];
        while let Some((index, done)) = work.pop() {
            if done == 0 && std::mem::replace(&mut seen[index], true) {
                continue;
            }
            match nodes[index].calls.get(done) {
                Some((callee, _)) => {
                    work.push((index, done + 1));
                    if !seen[*callee] {
                        work.push((*callee, 0));
                    }
                }
                None => order.push(index),
            }
        }
    }
    order
}

/// Which blocks can call themselves, directly or through others.
fn circles(nodes: &[Node], order: &[usize]) -> Vec<bool> {
    let mut recursive = vec![false; nodes.len()];
    let mut seen = vec![false; nodes.len()];
    // Callers of a node that are not yet in a group with others are in one circle with it.
    for &root in order.iter().rev() {
        let (mut group, mut work) = (Vec::new(), vec![root]);
        while let Some(index) = work.pop() {
            if !std::mem::replace(&mut seen[index], true) {
                group.push(index);
                work.extend(nodes[index].called_by.iter().filter(|&&caller| !seen[caller]));
            }
        }
        let calls_itself = |index: usize| nodes[index].called_by.contains(&index);
        if group.len() > 1 || group.first().is_some_and(|&index| calls_itself(index)) {
            group.iter().for_each(|&index| recursive[index] = true);
        }
    }
    recursive
}

/// The most local data of a path from each block on.
fn path_bytes(program: &Program, nodes: &[Node], order: &[usize], recursive: &[bool]) -> Vec<Option<u32>> {
    let mut bytes = vec![None; nodes.len()];
    for &index in order.iter().filter(|&&index| !recursive[index]) {
        let deepest =
            nodes[index].calls.iter().try_fold(0, |deepest: u32, (callee, _)| Some(deepest.max(bytes[*callee]?)));
        bytes[index] = deepest.map(|deepest| deepest.saturating_add(program.blocks[index].temp_bytes));
    }
    bytes
}
