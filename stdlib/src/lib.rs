//! System functions and function blocks, as PLC source where possible.
//!
//! The sources under `stl/` are the declarations of all system blocks; the attribute `plcc` says where the code is. They are
//! told apart by block once, without parsing them: a program pays only for what it names.

mod library;

use std::sync::OnceLock;

pub use library::{LIBRARY, LibraryBlock};

/// Sources of the system blocks.
const SOURCES: [&str; 2] = [include_str!("../stl/sfc.stl"), include_str!("../stl/sfb.stl")];

/// Where the code of a system block is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// In the source itself.
    Source,
    /// In the runtime, under the block's number.
    Runtime,
    /// Nowhere: a program that uses it is told so.
    NotShipped,
}

/// A system function (SFC) or system function block (SFB).
#[derive(Clone, Copy, Debug)]
pub struct SystemBlock {
    pub sfb: bool,
    pub number: u16,
    /// Standard name, `BLKMOV`.
    pub name: &'static str,
    /// The block's own source.
    pub source: &'static str,
    pub form: Form,
}

/// All system blocks.
pub fn blocks() -> &'static [SystemBlock] {
    static BLOCKS: OnceLock<Vec<SystemBlock>> = OnceLock::new();
    BLOCKS.get_or_init(|| SOURCES.iter().flat_map(|source| index(source)).collect())
}

/// SFC or SFB by number.
pub fn find(sfb: bool, number: u16) -> Option<&'static SystemBlock> {
    blocks().iter().find(|block| block.sfb == sfb && block.number == number)
}

/// SFC or SFB by standard name, in any letter case.
pub fn find_name(name: &str) -> Option<&'static SystemBlock> {
    blocks().iter().find(|block| block.name.eq_ignore_ascii_case(name))
}

/// Cuts a source at its block frames.
fn index(source: &'static str) -> Vec<SystemBlock> {
    let mut found = Vec::new();
    let mut rest = source;
    while let Some(start) = rest.find("FUNCTION") {
        let block = &rest[start..];
        let Some(end_word) = block.find("\nEND_FUNCTION") else { break };
        let end = block[end_word + 1..].find('\n').map_or(block.len(), |line| end_word + 1 + line + 1);
        found.extend(described(&block[..end]));
        rest = &block[end..];
    }
    found
}

/// Reads number, name and form of the block `source`.
fn described(source: &'static str) -> Option<SystemBlock> {
    let mut words = source.split_whitespace();
    let sfb = words.next()? == "FUNCTION_BLOCK";
    let number = words.nth(1)?.parse().ok()?;
    let name = source.lines().find_map(|line| line.strip_prefix("NAME : "))?.trim();
    let form = match source.lines().find_map(|line| line.strip_prefix("{ plcc := '"))?.split('\'').next()? {
        "source" => Form::Source,
        "runtime" => Form::Runtime,
        _ => Form::NotShipped,
    };
    Some(SystemBlock { sfb, number, name, source, form })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_block_is_indexed() {
        let frames: usize = SOURCES.iter().map(|source| source.matches("\nEND_FUNCTION").count()).sum();
        assert_eq!(blocks().len(), frames);
    }

    #[test]
    fn by_name_and_number() {
        assert_eq!(find_name("blkmov").map(|block| (block.sfb, block.number)), Some((false, 20)));
        assert_eq!(find(true, 4).map(|block| (block.name, block.form)), Some(("TON", Form::Source)));
        assert_eq!(find(false, 64).map(|block| block.form), Some(Form::Runtime));
        assert_eq!(find(false, 51).map(|block| block.form), Some(Form::NotShipped));
        assert!(find(false, 9999).is_none());
    }

    #[test]
    fn names_and_numbers_are_unique() {
        for (at, block) in blocks().iter().enumerate() {
            for other in &blocks()[at + 1..] {
                assert!((block.sfb, block.number) != (other.sfb, other.number) && block.name != other.name);
            }
        }
    }
}
