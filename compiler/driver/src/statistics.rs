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

#[cfg(test)]
mod tests {
    use plcc_diag::SourceFile;

    use super::*;
    use crate::cli::Level;
    use crate::inputs::Read;
    use crate::pipeline::{self, Settings};

    const SOURCE: &str = "FUNCTION FC 7 : VOID
BEGIN
NETWORK
      L     MW 0
      SIN
      T     MD 4
END_FUNCTION
ORGANIZATION_BLOCK OB 1
BEGIN
NETWORK
      A     M 0.0
      =     Q 0.0
NETWORK
      CALL  FC 7
      L     MW 8
      L     MW 10
      /I
      T     MW 12
END_ORGANIZATION_BLOCK
";

    fn of(source: &str) -> Statistics {
        let mut read = Read { name: "a".to_string(), ..Read::default() };
        read.units.push(read.sources.add(SourceFile::new("a.stl", source)));
        let bound = pipeline::front(read, &Settings { require_main: true, ..Settings::default() });
        assert!(!bound.has_errors(), "{}", plcc_diag::drawing::draw(&bound.diagnostics, &bound.sources, false));
        statistics(&pipeline::back(&bound, Level::O2)).expect("it compiles")
    }

    #[test]
    fn each_network_has_its_row() {
        let document: Value = serde_json::from_str(&of(SOURCE).json()).expect("it is JSON");
        let rows: Vec<(&str, Vec<u64>)> = document["blocks"]
            .as_array()
            .expect("a list")
            .iter()
            .map(|block| {
                let networks = block["networks"].as_array().expect("a list").iter();
                let numbers = networks.map(|network| network["network"].as_u64().expect("a number")).collect();
                (block["block"].as_str().expect("a name"), numbers)
            })
            .collect();
        // FC 7 became part of OB 1, and counts for itself.
        assert!(rows.contains(&("FC7", vec![1])) && rows.contains(&("OB1", vec![1, 2])), "{rows:?}");
        let number = |value: &Value, name: &str| value[name].as_u64().expect("a number");
        let blocks = document["blocks"].as_array().expect("a list").iter();
        let sum: u64 = blocks.map(|block| number(block, "bytes")).sum();
        assert_eq!(sum + number(&document["no_statement"], "bytes"), number(&document["total"], "bytes"));
        assert!(document["total"]["estimated_ns"].as_f64().is_some_and(|time| time > 0.0));
    }

    #[test]
    fn the_table_says_that_times_are_estimates() {
        let table = of(SOURCE).table();
        assert!(table.contains("estimate, ns") && table.contains("not a measurement"), "{table}");
        assert!(table.lines().any(|line| line.starts_with("OB1") && line.contains(" all ")), "{table}");
        assert!(table.lines().any(|line| line.starts_with("total")), "{table}");
    }

    #[test]
    fn a_division_takes_longer_than_a_contact() {
        let statistics = of(SOURCE);
        let main = statistics.blocks.iter().find(|block| block.name.starts_with("OB1")).expect("there is OB 1");
        let [(1, contact), (2, division)] = main.networks.as_slice() else { panic!("OB 1 has two networks") };
        assert!(division.nanoseconds > contact.nanoseconds, "{contact:?} {division:?}");
    }
}
