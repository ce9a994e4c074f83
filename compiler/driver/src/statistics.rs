//! What the code of each network costs, for `plcc build --stats`.

use std::fmt::Write as _;

use plcc_codegen::{CodegenError, Cost, LOOP_PASSES, PlaceKey};
use serde_json::{Value, json};

use crate::pipeline::Compiled;

/// The blocks of a program with their networks, in the order of the code.
pub struct Statistics {
    blocks: Vec<Block>,
    /// Code that belongs to no statement.
    others: Cost,
}

struct Block {
    /// `FC12`, and its symbol in parentheses.
    name: String,
    networks: Vec<(u16, Cost)>,
}

/// Compiles the program and counts.
pub fn statistics(compiled: &Compiled) -> Result<Statistics, CodegenError> {
    let (rows, others) = plcc_codegen::statistics(&compiled.module, &compiled.codegen_options())?;
    let mut keys: Vec<PlaceKey> = Vec::new();
    let mut blocks: Vec<Block> = Vec::new();
    for (key, cost) in rows {
        let same = |other: &PlaceKey| (other.block, other.number) == (key.block, key.number);
        let at = keys.iter().position(same).unwrap_or_else(|| {
            keys.push(key);
            blocks.push(Block { name: name(compiled, key), networks: Vec::new() });
            blocks.len() - 1
        });
        blocks[at].networks.push((key.network, cost));
    }
    blocks.iter_mut().for_each(|block| block.networks.sort_by_key(|(network, _)| *network));
    Ok(Statistics { blocks, others })
}

fn name(compiled: &Compiled, key: PlaceKey) -> String {
    let number = format!("{}{}", key.block.prefix(), key.number);
    let entry = compiled.image.blocks.iter().find(|entry| (entry.kind, entry.number) == (key.block, key.number));
    match entry.map(|entry| entry.name.as_str()) {
        None | Some("") => number,
        Some(symbol) => format!("{number} ({symbol})"),
    }
}

fn sum<'a>(costs: impl Iterator<Item = &'a Cost>) -> Cost {
    costs.fold(Cost::default(), |mut all, one| {
        all.add(*one);
        all
    })
}

impl Statistics {
    fn total(&self) -> Cost {
        let networks = self.blocks.iter().flat_map(|block| &block.networks);
        sum(networks.map(|(_, cost)| cost).chain([&self.others]))
    }

    /// A table with one line for each network.
    pub fn table(&self) -> String {
        let width = self.blocks.iter().map(|block| block.name.chars().count()).max().unwrap_or(0).max(12);
        let mut text = format!(
            "{:<width$}{:>9}{:>14}{:>9}{:>10}{:>16}\n",
            "block", "network", "instructions", "cold", "bytes", "estimate, ns"
        );
        let mut line = |name: &str, network: &str, cost: &Cost| {
            writeln!(
                text,
                "{name:<width$}{network:>9}{:>14}{:>9}{:>10}{:>16.1}",
                cost.instructions, cost.cold, cost.bytes, cost.nanoseconds
            )
            .expect("a string takes all");
        };
        for block in &self.blocks {
            if let [(network, cost)] = block.networks.as_slice() {
                line(&block.name, &network.to_string(), cost);
                continue;
            }
            line(&block.name, "all", &sum(block.networks.iter().map(|(_, cost)| cost)));
            block.networks.iter().for_each(|(network, cost)| line("", &network.to_string(), cost));
        }
        line("no statement", "", &self.others);
        line("total", "", &self.total());
        text.push_str(&format!("{ABOUT}\n"));
        text
    }

    /// The same as a JSON document.
    pub fn json(&self) -> String {
        let cost = |cost: &Cost| {
            json!({
                "instructions": cost.instructions,
                "cold_instructions": cost.cold,
                "bytes": cost.bytes,
                "estimated_ns": (cost.nanoseconds * 1000.0).round() / 1000.0,
            })
        };
        let network = |(number, own): &(u16, Cost)| -> Value {
            let mut value = cost(own);
            value["network"] = json!(number);
            value
        };
        let block = |block: &Block| -> Value {
            let mut value = cost(&sum(block.networks.iter().map(|(_, cost)| cost)));
            value["block"] = json!(block.name);
            value["networks"] = block.networks.iter().map(network).collect();
            value
        };
        let document = json!({
            "blocks": self.blocks.iter().map(block).collect::<Vec<_>>(),
            "no_statement": cost(&self.others),
            "total": cost(&self.total()),
            "loop_passes": LOOP_PASSES,
        });
        format!("{document:#}\n")
    }
}

/// What the last column is.
const ABOUT: &str = "The time is an estimate, not a measurement: usual times of the instructions on a processor of 3 GHz, without cold sides \
                     and without what called functions do; a loop counts as 8 passes.";
