//! Recipes: an array of structures as a CSV file with the name of its data block, one element a line.
//!
//! Source: S7-1200 reference, recipes.

use super::fields::{self, Table};
use super::store::{FILE_BYTES_MAX, Fault, Store};
use crate::cpu::Cpu;

/// STATUS.
pub mod status {
    pub const NAME: u16 = 0x8090;
    pub const STRUCTURE: u16 = 0x8091;
    pub const MISSING: u16 = 0x8092;
    pub const COLUMNS: u16 = 0x8093;
    pub const VALUE: u16 = 0x8094;
    pub const TOO_LONG: u16 = 0x80B3;
    pub const DENIED: u16 = 0x80C0;
    pub const NO_BLOCK: u16 = 0x80C1;
}

/// Bytes of a data block.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    pub db: u16,
    pub start: u32,
    pub bytes: u32,
}

fn file(cpu: &Cpu, db: u16) -> String {
    let name = cpu.image.dbs.iter().find(|entry| entry.number == db).map_or("", |entry| entry.name.as_str());
    if name.is_empty() { format!("Recipes/DB{db}.csv") } else { format!("Recipes/{name}.csv") }
}

fn table(cpu: &Cpu, place: Place) -> Result<Table<'_>, u16> {
    fields::table(&cpu.image.shapes, place.db, place.start, place.bytes).map_err(|_| status::STRUCTURE)
}

fn heading(table: &Table) -> Vec<String> {
    std::iter::once("index".to_string()).chain(table.fields.iter().map(|field| field.name.clone())).collect()
}

/// The number of the first element.
fn low(table: &Table) -> i64 {
    table.array.dimensions.first().map_or(0, |(low, _)| i64::from(*low))
}

fn status_of(fault: Fault) -> u16 {
    match fault {
        Fault::Name => status::NAME,
        Fault::Missing => status::MISSING,
        Fault::Full => status::TOO_LONG,
        Fault::Denied => status::DENIED,
    }
}

/// Writes the recipes to their file.
pub fn export(store: &Store, cpu: &Cpu, place: Place) -> Result<(), u16> {
    let table = table(cpu, place)?;
    let data = cpu.contents(place.db).ok_or(status::NO_BLOCK)?;
    let mut text = super::line(&heading(&table)) + "\r\n";
    for index in 0..table.array.count() {
        let start = (table.bits + table.array.place(index)) as usize / 8;
        let element = data.get(start..).unwrap_or(&[]);
        let mut columns = vec![(low(&table) + i64::from(index)).to_string()];
        columns.extend(table.fields.iter().map(|field| field.text(element)));
        text.push_str(&super::line(&columns));
        text.push_str("\r\n");
        if text.len() as u64 > FILE_BYTES_MAX {
            return Err(status::TOO_LONG);
        }
    }
    store.write(&file(cpu, place.db), 0, text.as_bytes(), true).map_err(status_of)
}

/// Reads the recipes from their file: all lines, or nothing.
pub fn import(store: &Store, cpu: &Cpu, place: Place) -> Result<(), u16> {
    let table = table(cpu, place)?;
    let text = store.read(&file(cpu, place.db), 0, FILE_BYTES_MAX).map_err(status_of)?;
    let mut data = cpu.contents(place.db).ok_or(status::NO_BLOCK)?;
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(text.as_slice());
    let mut records = reader.records();
    let first = records.next().and_then(Result::ok).ok_or(status::COLUMNS)?;
    if !first.iter().map(str::trim).eq(heading(&table)) {
        return Err(status::COLUMNS);
    }
    for record in records {
        // A line with more or fewer columns is an error of the reader.
        let record = record.map_err(|_| status::COLUMNS)?;
        let index = record.get(0).and_then(|text| text.trim().parse::<i64>().ok()).ok_or(status::VALUE)?;
        let index = u32::try_from(index.saturating_sub(low(&table))).map_err(|_| status::VALUE)?;
        if index >= table.array.count() {
            return Err(status::VALUE);
        }
        let start = (table.bits + table.array.place(index)) as usize / 8;
        let element = data.get_mut(start..).ok_or(status::STRUCTURE)?;
        for (field, text) in table.fields.iter().zip(record.iter().skip(1)) {
            field.set(text, element).ok_or(status::VALUE)?;
        }
    }
    cpu.set_contents(place.db, &data).then_some(()).ok_or(status::NO_BLOCK)
}
