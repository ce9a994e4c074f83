//! Bits of local data with which STEP 7 writes branches: `= L 20.0; A L 20.0; …; A L 20.0; …`. In pictures they are lines.

use std::collections::{HashMap, HashSet};

use plcc_syntax::ast::{self, Area, Operand, OperandKind, Statement, StatementKind, Width};
use plcc_syntax::stl::StlInsn;

use super::drawing::{Reason, Signal};
use super::logic::Join;
use super::statements::Reader;

/// What such bits keep, by their addresses.
#[derive(Default)]
pub struct Branches(HashMap<(u32, u8), Kept>);

struct Kept {
    signal: Signal,
    /// The number of elements when the bit was written.
    elements: usize,
    is_used: bool,
}

impl Branches {
    /// Whether a branch begins but does not go on.
    pub fn has_unused(&self) -> bool {
        self.0.values().any(|kept| !kept.is_used)
    }

    /// The signal that an operand keeps, for an input of a box.
    pub fn side(&mut self, operand: &Operand) -> Option<Signal> {
        let kept = self.0.get_mut(&bit(operand)?)?;
        kept.is_used = true;
        Some(kept.signal.clone())
    }
}

/// For each network of a block, whether such bits are lines of its picture: it writes one, and no other network reads what it writes.
pub fn are_lines(networks: &[ast::Network]) -> Vec<bool> {
    let read: Vec<HashSet<(u32, u8)>> = networks.iter().map(read_before_written).collect();
    let mut readers: HashMap<(u32, u8), usize> = HashMap::new();
    for place in read.iter().flatten() {
        *readers.entry(*place).or_default() += 1;
    }
    let of_others = |place: &(u32, u8), own: &HashSet<(u32, u8)>| {
        readers.get(place).is_some_and(|count| *count > usize::from(own.contains(place)))
    };
    let is_line = |(network, own): (&ast::Network, &HashSet<(u32, u8)>)| {
        let mut places = network.statements.iter().filter_map(written).peekable();
        places.peek().is_some() && places.all(|place| !of_others(&place, own))
    };
    networks.iter().zip(&read).map(is_line).collect()
}

/// The bits of local data that a network reads and does not write before.
fn read_before_written(network: &ast::Network) -> HashSet<(u32, u8)> {
    let (mut read, mut is_written) = (HashSet::new(), HashSet::new());
    for statement in &network.statements {
        if let Some(place) = written(statement) {
            is_written.insert(place);
            continue;
        }
        let operands: Vec<&Operand> = match &statement.kind {
            StatementKind::Instruction { operand, .. } => operand.iter().collect(),
            StatementKind::Call(call) => {
                call.parameters.iter().filter_map(|parameter| parameter.actual.as_ref()).collect()
            }
            StatementKind::Empty | StatementKind::Pragma(_) | StatementKind::Error => Vec::new(),
        };
        read.extend(operands.into_iter().flat_map(bits).filter(|place| !is_written.contains(place)));
    }
    read
}

/// The bit that a statement `= L 20.0` writes.
fn written(statement: &Statement) -> Option<(u32, u8)> {
    match &statement.kind {
        StatementKind::Instruction { insn: StlInsn::Assign, operand: Some(operand), .. } => bit(operand),
        StatementKind::Instruction { .. }
        | StatementKind::Call(_)
        | StatementKind::Empty
        | StatementKind::Pragma(_)
        | StatementKind::Error => None,
    }
}

impl Reader<'_> {
    /// Reads a statement whose operand is such a bit; `None`: it is another one, or the bits are coils and contacts.
    pub fn branch(&mut self, insn: StlInsn, operand: Option<&Operand>) -> Option<Result<(), Reason>> {
        let place = bit(operand?)?;
        self.branches.is_some().then(|| self.branch_bit(insn, place))
    }

    fn branch_bit(&mut self, insn: StlInsn, place: (u32, u8)) -> Result<(), Reason> {
        match insn {
            StlInsn::Assign => {
                let signal = self.flow()?;
                let elements = self.drawing.graph.elements.len();
                let kept = Kept { signal, elements, is_used: false };
                match self.branches.get_or_insert_default().0.insert(place, kept) {
                    Some(before) if !before.is_used => Err("a branch that is not continued".to_string()),
                    Some(_) | None => Ok(()),
                }
            }
            StlInsn::And if self.fresh && !self.is_saved && self.nesting.is_empty() => {
                let kept = self.branches.as_mut().and_then(|branches| branches.0.get_mut(&place));
                let kept = kept.ok_or("a branch that begins in another network")?;
                // The CPU executes that rung before the rest of the branch.
                if self.drawing.has_rung_since(kept.elements) {
                    return Err("a branch that goes on after another rung".to_string());
                }
                kept.is_used = true;
                let signal = kept.signal.clone();
                self.join(Join::And, signal);
                Ok(())
            }
            _ => Err("a bit of local data that is not a branch".to_string()),
        }
    }
}

fn bit(operand: &Operand) -> Option<(u32, u8)> {
    match operand.kind {
        OperandKind::Absolute { area: Area::L, width: Width::Bit, byte, bit } => Some((byte, bit)),
        _ => None,
    }
}

/// All bits of an operand in the local data.
fn bits(operand: &Operand) -> Vec<(u32, u8)> {
    match operand.kind {
        OperandKind::Absolute { area: Area::L, width: Width::Bit, byte, bit } => vec![(byte, bit)],
        OperandKind::Absolute { area: Area::L, width, byte, .. } => {
            let bytes = byte..byte.saturating_add(width.bytes());
            bytes.flat_map(|byte| (0..8).map(move |bit| (byte, bit))).collect()
        }
        _ => Vec::new(),
    }
}
