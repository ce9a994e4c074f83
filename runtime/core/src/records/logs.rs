//! Data logs: CSV files with a record for each call of DataLogWrite, of which the newest are kept.
//!
//! A file `NAME.json` next to the CSV file says what a record consists of, so that a later run can open the log.
//!
//! Source: S7-1200 reference, data logging.

use plcc_abi::layout::AREA_BYTES;
use plcc_abi::shape::DbShape;
use serde::{Deserialize, Serialize};

use super::fields::{self, Field};
use super::store::{FILE_BYTES_MAX, Fault, Store, is_name};
use crate::datetime;

/// Open at a time.
const OPEN_MAX: usize = 64;
/// The line after the newest record of a log that is not full.
const END: &str = "//END\r\n";
/// Number, date and time.
const STAMP_BYTES: u64 = 40;

/// STATUS.
pub mod status {
    pub const FULL: u16 = 0x0001;
    pub const ALREADY_OPEN: u16 = 0x0002;
    pub const NOT_OPEN_ALREADY: u16 = 0x0001;
    pub const NAME: u16 = 0x8090;
    pub const INCONSISTENT: u16 = 0x8090;
    pub const MISSING: u16 = 0x8092;
    pub const EXISTS: u16 = 0x8093;
    pub const TOO_LONG: u16 = 0x8097;
    pub const WRITE: u16 = 0x80A2;
    pub const NOT_OPEN: u16 = 0x80B0;
    pub const TOO_MANY: u16 = 0x80B2;
    pub const DENIED: u16 = 0x80C0;
    pub const TOO_MANY_OPEN: u16 = 0x80C1;
    pub const RECORDS: u16 = 0x8253;
}

/// What the records of a log are.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Definition {
    /// Where the data is: DB, first byte, number of bytes.
    pub db: u16,
    pub start: u32,
    pub bytes: u32,
    /// Most records.
    pub records: u32,
    /// Each has date and time.
    pub stamped: bool,
    /// Names of the columns of the data; empty: the file has no heading.
    pub header: String,
}

impl Definition {
    /// False if a file says what no block of the program can have written.
    fn is_possible(&self) -> bool {
        self.records > 0 && self.start < AREA_BYTES && (1..=AREA_BYTES).contains(&self.bytes)
    }

    /// The first line.
    fn heading(&self) -> String {
        match (self.header.as_str(), self.stamped) {
            ("", _) => String::new(),
            (header, true) => format!("Record,Date,UTC Time,{header}\r\n"),
            (header, false) => format!("Record,{header}\r\n"),
        }
    }

    pub fn fields(&self, shapes: &[DbShape]) -> Result<Vec<Field>, fields::Unfit> {
        fields::within(shapes, self.db, self.start, self.bytes)
    }

    /// A record without its number.
    pub fn record(&self, shapes: &[DbShape], data: &[u8], wall: i64) -> String {
        let mut columns = Vec::new();
        if self.stamped {
            let at = datetime::civil(wall);
            columns.push(format!("{:02}/{:02}/{:04}", at.month(), at.day(), at.year()));
            let ms = at.subsec_nanosecond() / 1_000_000;
            columns.push(format!("{:02}:{:02}:{:02}.{ms:03}", at.hour(), at.minute(), at.second()));
        }
        let values = self.fields(shapes).unwrap_or_default();
        columns.extend(values.iter().map(|field| field.text(data)));
        super::line(&columns)
    }
}

/// A log that this run knows.
pub struct Log {
    pub id: u32,
    pub name: String,
    pub definition: Definition,
    open: bool,
    /// Lines of the records, in the order of the file.
    rows: Vec<String>,
    /// Number of the next record.
    next: u64,
    /// Bytes of the file before [`END`].
    end: u64,
}

/// The logs of a run.
#[derive(Default)]
pub struct Logs {
    logs: Vec<Log>,
    last_id: u32,
}

fn csv(name: &str) -> String {
    format!("DataLogs/{name}.csv")
}

fn description(name: &str) -> String {
    format!("DataLogs/{name}.json")
}

impl Logs {
    /// Numbers of the data blocks whose values the open logs take.
    pub(crate) fn used_dbs(&self) -> impl Iterator<Item = u16> {
        self.logs.iter().filter(|log| log.open).map(|log| log.definition.db)
    }

    pub fn find(&mut self, id: u32) -> Option<&mut Log> {
        self.logs.iter_mut().find(|log| log.id == id)
    }

    /// Makes an empty log and opens it. `Ok`: its id.
    pub fn create(&mut self, store: &Store, name: &str, definition: Definition, width: u64) -> Result<u32, u16> {
        if !is_name(&format!("{name}.json")) {
            return Err(status::NAME);
        }
        if definition.records == 0 {
            return Err(status::RECORDS);
        }
        if (width + STAMP_BYTES).saturating_mul(definition.records.into()) > FILE_BYTES_MAX / 2 {
            return Err(status::TOO_LONG);
        }
        if store.exists(&csv(name)) {
            return Err(status::EXISTS);
        }
        self.check_open()?;
        let told = serde_json::to_vec(&definition).unwrap_or_default();
        store.write(&description(name), 0, &told, true).map_err(made)?;
        self.logs.retain(|log| log.name != name);
        self.last_id += 1;
        let mut log =
            Log { id: self.last_id, name: name.to_string(), definition, open: true, rows: Vec::new(), next: 1, end: 0 };
        log.rewrite(store).map_err(made)?;
        self.logs.push(log);
        Ok(self.last_id)
    }

    /// A new log like log `id`.
    pub fn create_like(&mut self, store: &Store, id: u32, name: &str, records: u32, width: u64) -> Result<u32, u16> {
        let definition = self.find(id).map(|log| log.definition.clone()).ok_or(status::MISSING)?;
        self.create(store, name, Definition { records, ..definition }, width)
    }

    /// Opens a log of this or an earlier run; `clear` removes its records. `Ok`: id, and whether it was open.
    pub fn open(&mut self, store: &Store, shapes: &[DbShape], name: &str, clear: bool) -> Result<(u32, bool), u16> {
        if !is_name(&format!("{name}.json")) {
            return Err(status::NAME);
        }
        let known = self.logs.iter().position(|log| log.name == name);
        if let Some(at) = known.filter(|&at| self.logs[at].open) {
            return Ok((self.logs[at].id, true));
        }
        self.check_open()?;
        let read = |file: String| store.read(&file, 0, FILE_BYTES_MAX).map_err(missing_or);
        let definition = serde_json::from_slice::<Definition>(&read(description(name))?);
        let definition = definition.map_err(|_| status::INCONSISTENT)?;
        let text = String::from_utf8(read(csv(name))?).map_err(|_| status::INCONSISTENT)?;
        if !definition.is_possible() || definition.fields(shapes).is_err() {
            return Err(status::INCONSISTENT);
        }
        let id = match known {
            Some(at) => self.logs.remove(at).id,
            None => {
                self.last_id += 1;
                self.last_id
            }
        };
        let mut log = Log { id, name: name.to_string(), definition, open: true, rows: Vec::new(), next: 1, end: 0 };
        if clear {
            log.rewrite(store).map_err(written)?;
        } else {
            log.take(&text)?;
        }
        self.logs.push(log);
        Ok((id, false))
    }

    fn check_open(&self) -> Result<(), u16> {
        let open = self.logs.iter().filter(|log| log.open).count();
        if open < OPEN_MAX { Ok(()) } else { Err(status::TOO_MANY_OPEN) }
    }

    /// Closes log `id`. STATUS.
    pub fn close(&mut self, id: u32) -> u16 {
        match self.find(id) {
            None => status::MISSING,
            Some(log) => {
                log.rows = Vec::new();
                if std::mem::replace(&mut log.open, false) { 0 } else { status::NOT_OPEN_ALREADY }
            }
        }
    }

    /// Removes all records of log `id`.
    pub fn clear(&mut self, store: &Store, id: u32) -> Result<(), u16> {
        let log = self.find(id).ok_or(status::MISSING)?;
        if !log.open {
            return Err(status::NOT_OPEN);
        }
        log.rows.clear();
        log.next = 1;
        log.rewrite(store).map_err(written)
    }

    /// Forgets the log with this name, or with this id if the name is empty; `with_file` removes its file.
    pub fn delete(&mut self, store: &Store, name: &str, id: u32, with_file: bool) -> Result<(), u16> {
        let name = match self.logs.iter().find(|log| if name.is_empty() { log.id == id } else { log.name == name }) {
            Some(log) => log.name.clone(),
            None if store.exists(&csv(name)) => name.to_string(),
            None => return Err(status::MISSING),
        };
        if with_file {
            store.remove(&csv(&name)).map_err(missing_or)?;
        }
        let _ = store.remove(&description(&name));
        self.logs.retain(|log| log.name != name);
        Ok(())
    }

    /// Adds a record to log `id`. `Ok`: whether it is the last one before older ones are replaced.
    pub fn write(&mut self, store: &Store, id: u32, record: &str) -> Result<bool, u16> {
        let log = self.find(id).ok_or(status::MISSING)?;
        if !log.open {
            return Err(status::NOT_OPEN);
        }
        log.add(store, record).map_err(written)
    }
}

impl Log {
    fn add(&mut self, store: &Store, record: &str) -> Result<bool, Fault> {
        let row = format!("{},{record}\r\n", self.next);
        let records = u64::from(self.definition.records);
        if (self.rows.len() as u64) < records {
            let full = self.rows.len() as u64 + 1 == records;
            let text = format!("{row}{}", if full { "" } else { END });
            store.write(&csv(&self.name), self.end, text.as_bytes(), true)?;
            self.end += row.len() as u64;
            self.rows.push(row);
        } else {
            let place = ((self.next - 1) % records) as usize;
            self.rows[place] = row;
            self.rewrite(store)?;
        }
        self.next += 1;
        Ok((self.next - 1).is_multiple_of(records))
    }

    /// Writes the whole file.
    fn rewrite(&mut self, store: &Store) -> Result<(), Fault> {
        let mut text = self.definition.heading();
        self.rows.iter().for_each(|row| text.push_str(row));
        self.end = text.len() as u64;
        if (self.rows.len() as u64) < u64::from(self.definition.records) {
            text.push_str(END);
        }
        store.write(&csv(&self.name), 0, text.as_bytes(), true)
    }

    /// Takes over the records of a file.
    fn take(&mut self, text: &str) -> Result<(), u16> {
        let heading = self.definition.heading();
        let rows = text.strip_prefix(&heading).ok_or(status::INCONSISTENT)?;
        let rows = rows.strip_suffix(END).unwrap_or(rows);
        self.end = (heading.len() + rows.len()) as u64;
        self.rows = rows.split_inclusive("\r\n").map(str::to_string).collect();
        if self.rows.len() as u64 > u64::from(self.definition.records) {
            return Err(status::INCONSISTENT);
        }
        let number = |row: &String| row.split(',').next()?.parse::<u64>().ok().filter(|&number| number < u64::MAX / 2);
        let numbers: Option<Vec<u64>> = self.rows.iter().map(number).collect();
        self.next = numbers.ok_or(status::INCONSISTENT)?.into_iter().max().unwrap_or(0) + 1;
        Ok(())
    }
}

fn made(fault: Fault) -> u16 {
    match fault {
        Fault::Name => status::NAME,
        Fault::Full => status::TOO_MANY,
        Fault::Missing | Fault::Denied => status::DENIED,
    }
}

fn written(_: Fault) -> u16 {
    status::WRITE
}

fn missing_or(fault: Fault) -> u16 {
    match fault {
        Fault::Missing => status::MISSING,
        Fault::Name => status::NAME,
        Fault::Full | Fault::Denied => status::DENIED,
    }
}

#[cfg(test)]
mod tests {
    use plcc_abi::image::AssertType;
    use plcc_abi::shape::{Part, Shape};

    use super::*;

    fn shapes() -> [DbShape; 1] {
        let shape = Shape::Value { ty: AssertType::Signed(16), bytes: 2 };
        [DbShape { number: 1, parts: vec![Part { name: "a".into(), byte: 0, bit: 0, shape }] }]
    }

    fn definition(records: u32) -> Definition {
        Definition { db: 1, start: 0, bytes: 2, records, stamped: false, header: "a".into() }
    }

    fn text(store: &Store) -> String {
        String::from_utf8(store.read("DataLogs/L.csv", 0, FILE_BYTES_MAX).unwrap()).unwrap()
    }

    #[test]
    fn a_log_of_an_earlier_run_goes_on() {
        let store = Store::temporary();
        let mut first = Logs::default();
        let id = first.create(&store, "L", definition(2), 10).unwrap();
        assert_eq!(first.write(&store, id, "5"), Ok(false));
        assert_eq!(first.write(&store, id, "6"), Ok(true));
        assert_eq!(first.write(&store, id, "7"), Ok(false));
        assert_eq!(text(&store), "Record,a\r\n3,7\r\n2,6\r\n");
        let mut second = Logs::default();
        assert_eq!(second.create(&store, "L", definition(2), 10), Err(status::EXISTS));
        let (id, was_open) = second.open(&store, &shapes(), "L", false).unwrap();
        assert!(!was_open);
        assert_eq!(second.write(&store, id, "8"), Ok(true));
        assert_eq!(text(&store), "Record,a\r\n3,7\r\n4,8\r\n");
        assert_eq!(second.open(&store, &shapes(), "L", false), Ok((id, true)));
        second.clear(&store, id).unwrap();
        assert_eq!(text(&store), "Record,a\r\n//END\r\n");
    }

    #[test]
    fn files_that_no_log_can_have_are_refused() {
        let store = Store::temporary();
        let open = |json: &str, csv: &str| {
            store.write("DataLogs/L.json", 0, json.as_bytes(), true).unwrap();
            store.write("DataLogs/L.csv", 0, csv.as_bytes(), true).unwrap();
            Logs::default().open(&store, &shapes(), "L", false)
        };
        let json = |start: u32, bytes: u32, records: u32| {
            serde_json::to_string(&Definition { start, bytes, ..definition(records) }).unwrap()
        };
        assert_eq!(open(&json(0, 2, 2), "Record,a\r\n1,5\r\n//END\r\n"), Ok((1, false)));
        for (json, csv) in [
            (json(u32::MAX, 2, 2), "Record,a\r\n"),
            (json(0, u32::MAX, 2), "Record,a\r\n"),
            (json(0, 2, 0), "Record,a\r\n"),
            (json(2, 2, 2), "Record,a\r\n"),
            (json(0, 2, 2), "Record,b\r\n"),
            (json(0, 2, 2), "Record,a\r\n1,5\r\n2,5\r\n3,5\r\n"),
            (json(0, 2, 2), "Record,a\r\nx,5\r\n"),
            (json(0, 2, 2), "Record,a\r\n18446744073709551615,5\r\n"),
            ("{".to_string(), "Record,a\r\n"),
        ] {
            assert_eq!(open(&json, csv), Err(status::INCONSISTENT), "{json} {csv}");
        }
    }
}
