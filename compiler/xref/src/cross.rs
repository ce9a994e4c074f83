//! Cross references: uses by operand.

use std::collections::BTreeMap;

use plcc_diag::SourceMap;
use plcc_model::Program;
use serde::Serialize;

use crate::Access;
use crate::collect::Found;
use crate::operand::{Area, Operand};
use crate::symbols::Names;

/// Overlaps that are listed for one operand at most.
pub const OVERLAPS_MAX: usize = 200;

/// An operand with all its uses.
#[derive(Clone, Debug, Serialize)]
pub struct OperandUses {
    /// `Q4.0`, `DB10.DBW4`, `FC2`.
    pub address: String,
    /// Its name, empty if it has none.
    pub symbol: String,
    pub uses: Vec<Use>,
    /// Other operands of the program with bits of this one, at most [`OVERLAPS_MAX`].
    pub overlaps: Vec<String>,
}

/// A use of an operand.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Use {
    /// `OB1`.
    pub block: String,
    /// The name of the block, empty if it has none.
    pub block_name: String,
    /// 0 if the block has no networks there.
    pub network: u16,
    pub file: String,
    /// From 1.
    pub line: u32,
    /// In characters, from 1.
    pub column: u32,
    pub access: Access,
    /// The statement as written, on one line; empty for what is drawn.
    pub statement: String,
}

pub(crate) fn operands(program: &Program, sources: &SourceMap, names: &Names, found: &[Found]) -> Vec<OperandUses> {
    let mut by_operand: BTreeMap<Operand, Vec<&Found>> = BTreeMap::new();
    for one in found {
        by_operand.entry(one.operand).or_default().push(one);
    }
    let keys: Vec<Operand> = by_operand.keys().copied().collect();
    let mut symbols: Vec<String> = keys.iter().map(|&operand| names.of(operand)).collect();
    let mut overlaps = overlaps(&keys);
    for (index, others) in overlaps.iter_mut().enumerate() {
        if matches!(keys[index], Operand::Memory { area: Area::Db(_), .. }) {
            others.retain(|&other| !are_apart(&symbols[index], &symbols[other]));
        }
    }
    let mut list = Vec::new();
    for (index, (operand, found)) in by_operand.into_iter().enumerate() {
        let mut found = found;
        // In the order of the text.
        found.sort_by_key(|one| (one.block, one.span.start));
        let uses = found.into_iter().map(|one| place(program, sources, one)).collect();
        list.push(OperandUses {
            address: operand.to_string(),
            symbol: std::mem::take(&mut symbols[index]),
            uses,
            overlaps: std::mem::take(&mut overlaps[index]).iter().map(|&other| keys[other].to_string()).collect(),
        });
    }
    list
}

/// Characters of a statement that are shown.
const STATEMENT_MAX: usize = 60;

pub(crate) fn place(program: &Program, sources: &SourceMap, found: &Found) -> Use {
    let block = &program.blocks[found.block];
    let file = sources.file(found.span.file);
    let (line, column) = file.line_column(found.span.start);
    let is_drawn = [".xml", ".s7dcl"].iter().any(|ending| file.name.to_ascii_lowercase().ends_with(ending));
    let text = if is_drawn { "" } else { file.line_text(line) };
    let statement = text.split(" //").next().unwrap_or_default().split_whitespace().collect::<Vec<_>>().join(" ");
    Use {
        block: format!("{}{}", block.kind.prefix(), block.number),
        block_name: block.name.clone(),
        network: found.network,
        file: file.name.clone(),
        line,
        column,
        access: found.access,
        statement: statement.chars().take(STATEMENT_MAX).collect(),
    }
}

/// True for two values of a data block that have no bit in common although the elements of their array lie between each other: `.a[*].x`
/// and `.a[*].y`, where `*` is any index.
fn are_apart(one: &str, other: &str) -> bool {
    if !one.contains('*') && !other.contains('*') {
        return false;
    }
    for (one, other) in one.split(['.', '[']).zip(other.split(['.', '['])) {
        match (one.strip_suffix(']'), other.strip_suffix(']')) {
            (Some(one), Some(other)) => {
                let mut pairs = one.split(',').zip(other.split(','));
                if pairs.any(|(one, other)| one != other && one != "*" && other != "*") {
                    return true;
                }
            }
            _ if one != other => return true,
            _ => {}
        }
    }
    false
}

/// For each operand the others that share bits with it. `operands` are sorted.
fn overlaps(operands: &[Operand]) -> Vec<Vec<usize>> {
    let mut overlaps = vec![Vec::new(); operands.len()];
    for (index, operand) in operands.iter().enumerate() {
        let &Operand::Memory { area, start, bits } = operand else { continue };
        let end = start.saturating_add(bits);
        for (other, candidate) in operands.iter().enumerate().skip(index + 1) {
            match candidate {
                Operand::Memory { area: same, start, .. } if *same == area && *start < end => {}
                _ => break,
            }
            if overlaps[index].len() == OVERLAPS_MAX {
                break;
            }
            overlaps[index].push(other);
            if overlaps[other].len() < OVERLAPS_MAX {
                overlaps[other].push(index);
            }
        }
    }
    overlaps.iter_mut().for_each(|list| list.sort_unstable());
    overlaps
}
