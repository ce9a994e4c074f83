//! Which call of which block is looked at.

use plcc_abi::image::BlockKind;
use plcc_model::{BlockKey, CodeBlock, DataBlock, Program};

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
    let named = |same: fn(&str, &str) -> bool| {
        program.blocks.iter().find(|block| !block.name.is_empty() && same(&block.name, text))
    };
    // The exact letters go first.
    let by_name = || named(|name, text| name == text).or_else(|| named(str::eq_ignore_ascii_case));
    let found = by_address.or_else(by_name);
    match found {
        Some(block) if block.library => Err(format!("{text} is a block of the library, which has no status")),
        Some(block) => Ok(block.key()),
        None if let Some(db) = data_block(program, text) => {
            Err(match db.instance_of.and_then(|key| program.block(key)) {
                Some(owner) if !owner.library => {
                    let owner = if owner.name.is_empty() { address(owner) } else { owner.name.clone() };
                    format!(
                        "{text} is an instance, and its block has the statements: write --block {owner} --instance {text}"
                    )
                }
                Some(_) | None => {
                    format!("{text} is a data block, which has no statements; `plcc run --print` shows its values")
                }
            })
        }
        None => {
            let own = || program.blocks.iter().filter(|block| !block.library);
            let rest = if own().count() > LISTED_MAX { " and others" } else { "" };
            let names: Vec<String> = own()
                .take(LISTED_MAX)
                .map(|block| {
                    let name = if block.name.is_empty() { String::new() } else { format!(" ({})", block.name) };
                    format!("{}{name}", address(block))
                })
                .collect();
            Err(format!("the program has no block {text}; its blocks are {}{rest}", names.join(", ")))
        }
    }
}

/// Blocks that a message lists.
const LISTED_MAX: usize = 30;

fn address(block: &CodeBlock) -> String {
    format!("{}{}", block.kind.prefix(), block.number)
}

/// The data block with an address or a name.
fn data_block<'p>(program: &'p Program, text: &str) -> Option<&'p DataBlock> {
    let text = text.trim().trim_matches('"');
    let compact: String = text.chars().filter(|c| !c.is_whitespace()).collect::<String>().to_ascii_uppercase();
    program.dbs.iter().find(|db| compact == format!("DB{}", db.number) || !db.name.is_empty() && db.name == text)
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
    data_block(program, text).map(|db| db.number).ok_or_else(|| {
        let text = text.trim().trim_matches('"');
        format!("the program has no data block {text}")
    })
}

/// Reads `OB1/FB2`. `Err`: the error.
pub fn path(program: &Program, text: &str) -> Result<Vec<BlockKey>, String> {
    text.split('/').map(|name| block(program, name)).collect()
}
