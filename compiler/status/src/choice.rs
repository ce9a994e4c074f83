//! Which call of which block is looked at.

use plcc_abi::image::BlockKind;
use plcc_model::{BlockKey, Program};

/// What to look at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choice {
    pub block: BlockKey,
    /// Only this network.
    pub network: Option<u16>,
    /// Number of the cycle, 0 for startup.
    pub cycle: u64,
    pub call: Call,
}

/// The call of a block that is called more than once in a cycle. Source: Programming with STEP 7, call environment of a block.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Call {
    /// The block runs with its instance in this DB.
    pub instance: Option<u16>,
    /// The blocks on the way to it, the outer ones first, as many as are named: the last one calls it.
    pub path: Vec<BlockKey>,
    /// Which of the calls that fit: 1 is the first.
    pub number: u32,
}

/// Finds a block by its address or its name: `FB1`, `FB 1`, `Conveyor`. `Err`: the error.
pub fn block(program: &Program, text: &str) -> Result<BlockKey, String> {
    let text = text.trim().trim_matches('"');
    let compact: String = text.chars().filter(|c| !c.is_whitespace()).collect::<String>().to_ascii_uppercase();
    let has_code = |kind: BlockKind| kind != BlockKind::Db;
    let by_address = program
        .blocks
        .iter()
        .find(|block| has_code(block.kind) && compact == format!("{}{}", block.kind.prefix(), block.number));
    let by_name = || program.blocks.iter().find(|block| !block.name.is_empty() && block.name == text);
    let found = by_address.or_else(by_name);
    match found {
        Some(block) if block.library => Err(format!("{text} is a block of the library, which has no status")),
        Some(block) => Ok(block.key()),
        None => {
            let names: Vec<String> = program
                .blocks
                .iter()
                .filter(|block| !block.library)
                .map(|block| {
                    let name = if block.name.is_empty() { String::new() } else { format!(" ({})", block.name) };
                    format!("{}{}{name}", block.kind.prefix(), block.number)
                })
                .collect();
            Err(format!("the program has no block {text}; its blocks are {}", names.join(", ")))
        }
    }
}

/// Reads `BLOCK` or `BLOCK:NETWORK`.
pub fn block_and_network(program: &Program, text: &str) -> Result<(BlockKey, Option<u16>), String> {
    match text.rsplit_once(':') {
        Some((name, network)) => match network.trim().parse() {
            Ok(network) => Ok((block(program, name)?, Some(network))),
            Err(_) => {
                Err(format!("`{network}` is not the number of a network; write {name}:1, with a number from 1 on"))
            }
        },
        None => Ok((block(program, text)?, None)),
    }
}

/// Reads the name or number of an instance DB. `Err`: the error.
pub fn instance(program: &Program, text: &str) -> Result<u16, String> {
    let text = text.trim().trim_matches('"');
    let compact: String = text.chars().filter(|c| !c.is_whitespace()).collect::<String>().to_ascii_uppercase();
    let found = program.dbs.iter().find(|db| compact == format!("DB{}", db.number) || db.name == text);
    found.map(|db| db.number).ok_or_else(|| format!("the program has no data block {text}"))
}

/// Reads `OB1/FB2`. `Err`: the error.
pub fn path(program: &Program, text: &str) -> Result<Vec<BlockKey>, String> {
    text.split('/').map(|name| block(program, name)).collect()
}
