//! What a change of the program means: what goes where, what is new and what is lost, or why it is not possible.

use std::sync::Arc;

use plcc_abi::ProgramImage;
use plcc_abi::image::{BlockKind, DbEntry};

use super::charts::Chart;
use super::edges::{self, Edges};
use super::fixed;
use super::pairs::{Move, Pairs, Pointer, Side, is_same};
use crate::cpu::Cpu;

/// What happens to data.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    pub text: String,
    /// A value of the running program goes.
    pub loses: bool,
}

/// See the module comment.
pub struct Plan {
    /// The program that it is for.
    pub(super) old: Arc<ProgramImage>,
    pub(super) items: Vec<Item>,
    pub(super) moves: Vec<Move>,
    pub(super) pointers: Vec<Pointer>,
    /// With other steps or transitions, but perhaps not at their initial step.
    pub(super) charts: Vec<Chart>,
    /// Data blocks of the old program whose layout or number is another one, or that are gone.
    pub(super) changed_dbs: Vec<u16>,
    /// Of an S7-200.
    pub(super) edges: Edges,
    /// Numbers of the data blocks of the new program.
    new_dbs: Vec<u16>,
}

impl Plan {
    /// Compares the running program with a new one. `Err`: why it cannot take its place.
    pub(super) fn new(old: Arc<ProgramImage>, new: &ProgramImage) -> Result<Plan, String> {
        possible(&old, new)?;
        let mut plan = Plan {
            items: Vec::new(),
            moves: Vec::new(),
            pointers: Vec::new(),
            charts: Vec::new(),
            changed_dbs: Vec::new(),
            edges: Edges::default(),
            new_dbs: new.dbs.iter().map(|db| db.number).collect(),
            old: Arc::clone(&old),
        };
        plan.obs(&old, new);
        if let (Some(was), Some(is)) = (&old.s7200, &new.s7200) {
            plan.edges = edges::compare(was, is);
            for place in std::mem::take(&mut plan.edges.new) {
                plan.item(format!("{place}: its edges begin as in the first scan"), false);
            }
        }
        let by_name = new.profile.family.is_portal();
        let partner = |db: &DbEntry, of: &[DbEntry]| {
            let found = |other: &&DbEntry| match by_name && !db.name.is_empty() {
                true => is_same(&other.name, &db.name),
                false => other.number == db.number,
            };
            of.iter().position(|other| found(&other))
        };
        for db in &new.dbs {
            match partner(db, &old.dbs) {
                Some(index) => plan.block(&old, &old.dbs[index], new, db),
                None if is_of_compiler(db) => {}
                None => plan.item(format!("{} is new", shown(db)), false),
            }
        }
        for db in old.dbs.iter().filter(|db| partner(db, &new.dbs).is_none()) {
            plan.changed_dbs.push(db.number);
            if !is_of_compiler(db) {
                plan.item(format!("{} is removed", shown(db)), !db.read_only && !db.unlinked);
            }
        }
        Ok(plan)
    }

    fn item(&mut self, text: String, loses: bool) {
        self.items.push(Item { text, loses });
    }

    /// Interrupts of OBs that come and go.
    fn obs(&mut self, old: &ProgramImage, new: &ProgramImage) {
        let has =
            |image: &ProgramImage, ob| image.blocks.iter().any(|one| one.kind == BlockKind::Ob && one.number == ob);
        for block in new.blocks.iter().filter(|block| block.kind == BlockKind::Ob && !has(old, block.number)) {
            self.item(format!("OB {} is new", block.number), false);
        }
        for block in old.blocks.iter().filter(|block| block.kind == BlockKind::Ob && !has(new, block.number)) {
            self.item(format!("OB {} is removed", block.number), false);
        }
    }

    /// A data block that both programs have.
    fn block(&mut self, old: &ProgramImage, from: &DbEntry, new: &ProgramImage, to: &DbEntry) {
        if from.number != to.number {
            self.changed_dbs.push(from.number);
        }
        // What the program cannot write is as the new program has it.
        if from.unlinked || to.unlinked || from.read_only && to.read_only {
            if from.data != to.data {
                self.changed_dbs.push(from.number);
            }
            return;
        }
        let name = shown(to);
        let (from_side, to_side) = (Side { types: &old.types, db: from }, Side { types: &new.types, db: to });
        let mut pairs = Pairs {
            old: from_side,
            new: to_side,
            moves: Vec::new(),
            pointers: Vec::new(),
            items: Vec::new(),
            charts: Vec::new(),
        };
        match (from.ty, to.ty) {
            (Some(a), Some(b)) => pairs.compare(a, b, &name),
            (None, None) if from.data.len() == to.data.len() => {}
            _ => pairs.items.push((format!("{name} has another structure: it gets its initial values"), true)),
        }
        let Pairs { moves, pointers, items, charts, .. } = pairs;
        let (a, b) = (8 * u64::from(from.address), 8 * u64::from(to.address));
        let in_place = moves.iter().all(|one| one.from - a == one.to - b)
            && pointers.iter().all(|one| one.from - from.address == one.to - to.address);
        if items.is_empty() && in_place && from.data.len() == to.data.len() {
            // Also what has no name.
            self.moves.push(Move { from: a, to: b, bits: 8 * to.data.len() as u64 });
        } else {
            self.changed_dbs.push(from.number);
            self.moves.extend(moves);
        }
        self.pointers.extend(pointers);
        self.charts.extend(charts);
        self.items.extend(items.into_iter().map(|(text, loses)| Item { text, loses }));
    }

    /// Whether the change is possible at this moment. `Err`: why not.
    pub(super) fn check(&self, cpu: &Cpu) -> Result<(), String> {
        let created = cpu.created_dbs.borrow();
        if let Some((number, ..)) = created.iter().find(|(number, ..)| self.new_dbs.contains(number)) {
            return Err(format!(
                "DB {number} was made by the running program, and the new one has a DB {number} of its own"
            ));
        }
        let records = cpu.records.borrow();
        let mut used = records.used_dbs();
        match used.find(|number| self.changed_dbs.contains(number)) {
            Some(number) => {
                Err(format!("a data log or recipe job uses DB {number}, whose layout changes: close the log first"))
            }
            None => Ok(()),
        }
    }
}

/// Data blocks that the compiler makes have no name that a user knows.
fn is_of_compiler(db: &DbEntry) -> bool {
    db.name.is_empty() && db.read_only
}

/// `DB 5 "Motor"`.
fn shown(db: &DbEntry) -> String {
    let DbEntry { number, name, .. } = db;
    if name.is_empty() { format!("DB {number}") } else { format!("DB {number} \"{name}\"") }
}

/// Whether one program can take the place of the other at all. `Err`: why not.
fn possible(old: &ProgramImage, new: &ProgramImage) -> Result<(), String> {
    if old.name != new.name {
        return Err(format!(
            "the running program is `{}`, this one is `{}`; if it is another version of it, write `name = \"{0}\"` into its plc.toml",
            old.name, new.name
        ));
    }
    if old.profile != new.profile {
        return Err(format!(
            "the CPU is another one, {} instead of {}: stop the program and start the new one",
            new.profile.name, old.profile.name
        ));
    }
    let (was, is) = (fixed(&old.config), fixed(&new.config));
    if was != is {
        return Err(
            "plc.toml sets the CPU, its modules or its services in another way: stop the program and start the new one"
                .to_string(),
        );
    }
    Ok(())
}
