//! ATT, FIFO, LIFO, FND in place, for tables in V memory with room for all entries that a table may have. The runtime does the others.
//! Source: S7-200 system manual, table instructions.
//!
//! A table is its length in entries, the count of entries, then the entries, one word each.

use plcc_abi::s7200::{TABLE_ENTRIES_MAX, V_DB, error, fatal};
use plcc_ir::{Address, BinaryOp, IntCc, Region, Type, Value};
use plcc_model::s7200::{Area, Insn, Operand, Width};

use super::block::S7200Lowering;
use super::math::{TABLE_EMPTY, TABLE_FULL};
use super::operand::Place;

/// Words that FIFO moves at once.
const MOVED_WORDS: u32 = 4;

/// A table in V memory, with room for all entries.
#[derive(Clone, Copy)]
struct Table {
    /// What a pointer adds.
    base: Option<Value>,
    /// Where its count is.
    count_at: u32,
}

impl Table {
    /// The word at byte `offset` from the count on.
    fn word(self, offset: u32) -> Address {
        Address { region: Region::Db(V_DB), base: self.base, offset: self.count_at + offset }
    }

    fn count(self) -> Address {
        self.word(0)
    }

    fn length(self) -> Address {
        Address { offset: self.count_at - 2, ..self.count() }
    }
}

impl S7200Lowering<'_, '_> {
    /// An instruction of tables whose table is in V memory with room for all entries; `elsewhere` does all else.
    pub fn table_in_place(&mut self, insn: Insn, operands: &[Operand], elsewhere: impl FnOnce(&mut Self)) {
        let (operand, count_at) = match insn {
            Insn::Att => (&operands[1], 2),
            Insn::Fifo | Insn::Lifo => (&operands[0], 2),
            Insn::FindEqual | Insn::FindNotEqual | Insn::FindLess | Insn::FindGreater => (&operands[0], 0),
            _ => return elsewhere(self),
        };
        let bytes = count_at + 2 + 2 * TABLE_ENTRIES_MAX;
        match operand {
            Operand::Memory { area: Area::V, byte, .. } if self.is_v(*byte, bytes) => {
                self.with_table(insn, Table { base: None, count_at: byte + count_at }, operands);
            }
            Operand::Indirect { pointer, .. } => {
                let pointer = self.load(Place::Direct(pointer), Width::Dword);
                let Some((in_v, offset)) = self.is_in_v(pointer, bytes) else { return elsewhere(self) };
                let (here, there, after) = (self.b.create_block(), self.b.create_cold_block(), self.b.create_block());
                self.b.branch(in_v, here, there);
                self.b.seal_block(here);
                self.b.seal_block(there);
                self.b.switch_to(here);
                self.with_table(insn, Table { base: Some(offset), count_at }, operands);
                self.b.jump(after, &[]);
                self.b.switch_to(there);
                elsewhere(self);
                self.b.jump(after, &[]);
                self.b.seal_block(after);
                self.b.switch_to(after);
            }
            _ => elsewhere(self),
        }
    }

    /// Whether `bytes` bytes from byte `byte` on are in V memory.
    fn is_v(&self, byte: u32, bytes: u32) -> bool {
        let v = self.plan.dbs.iter().find(|db| db.number == V_DB);
        v.is_some_and(|db| byte.checked_add(bytes).is_some_and(|end| end <= db.length))
    }

    fn with_table(&mut self, insn: Insn, table: Table, operands: &[Operand]) {
        match insn {
            Insn::Att => self.add_to_table(table, &operands[0]),
            Insn::Fifo => self.take_from_table(table, &operands[1], true),
            Insn::Lifo => self.take_from_table(table, &operands[1], false),
            Insn::FindNotEqual => self.find_in_table(table, operands, IntCc::Ne),
            Insn::FindLess => self.find_in_table(table, operands, IntCc::Slt),
            Insn::FindGreater => self.find_in_table(table, operands, IntCc::Sgt),
            _ => self.find_in_table(table, operands, IntCc::Eq),
        }
    }

    /// A full table sets SM1.4 and does not change.
    fn add_to_table(&mut self, table: Table, entry: &Operand) {
        let entry = self.read(entry, Width::Word);
        let (length, count) = (self.b.load(Type::I16, table.length()), self.b.load(Type::I16, table.count()));
        let has_room = self.b.icmp(IntCc::Ult, count, length);
        let possible = self.b.icmp_imm(IntCc::Ult, count, i64::from(TABLE_ENTRIES_MAX));
        let free = self.b.and(has_room, possible);
        self.unless_refused(free, TABLE_FULL, |lowering| {
            let at = lowering.entry(table, count);
            lowering.b.store(at, entry);
            let count = lowering.b.binary_imm(BinaryOp::Iadd, count, 1);
            lowering.b.store(table.count(), count);
        });
    }

    /// Takes out the first or last entry. An empty table sets SM1.5. The place that becomes free keeps its word.
    fn take_from_table(&mut self, table: Table, target: &Operand, first: bool) {
        let target = self.target(target, Width::Word);
        let count = self.count_of_table(table);
        let filled = self.b.icmp_imm(IntCc::Ne, count, 0);
        self.unless_refused(filled, TABLE_EMPTY, |lowering| {
            let left = lowering.b.binary_imm(BinaryOp::Iadd, count, -1);
            let entry = if first { table.word(2) } else { lowering.entry(table, left) };
            let entry = lowering.b.load(Type::I16, entry);
            if first {
                let left = lowering.b.zext(Type::I32, left);
                let start = lowering.b.i32_const(0);
                let moved = lowering.move_up(table, start, left, MOVED_WORDS);
                lowering.move_up(table, moved, left, 1);
            }
            lowering.b.store(table.count(), left);
            lowering.store(target, Width::Word, entry);
        });
    }

    /// Moves `words` entries a pass to the place before theirs, from place `from` on up to place `left`, which becomes free, as long as there
    /// are so many. Result: the place where that ends.
    fn move_up(&mut self, table: Table, from: Value, left: Value, words: u32) -> Value {
        let (pass, step, after) = (self.b.create_block(), self.b.create_block(), self.b.create_block());
        let place = self.b.append_param(pass, Type::I32);
        self.b.jump(pass, &[from]);
        self.b.switch_to(pass);
        let next = self.b.binary_imm(BinaryOp::Iadd, place, i64::from(words));
        let enough = self.b.icmp(IntCc::Ule, next, left);
        self.b.branch(enough, step, after);
        self.b.seal_block(step);
        self.b.seal_block(after);
        self.b.switch_to(step);
        let to = self.entry(table, place);
        let from = Address { offset: to.offset + 2, ..to };
        let value = self.b.load(if words == MOVED_WORDS { Type::I64 } else { Type::I16 }, from);
        self.b.store(to, value);
        self.b.jump(pass, &[next]);
        self.b.seal_block(pass);
        self.b.switch_to(after);
        place
    }

    /// The first entry from the index on that compares so with the pattern; without one the index becomes the count of entries.
    fn find_in_table(&mut self, table: Table, operands: &[Operand], relation: IntCc) {
        let [_, pattern, index] = operands else { return };
        let (pattern, first) = (self.read(pattern, Width::Word), self.read(index, Width::Word));
        let target = self.target(index, Width::Word);
        let count = self.count_of_table(table);
        let (first, count) = (self.b.zext(Type::I32, first), self.b.zext(Type::I32, count));
        let (pass, look, next) = (self.b.create_block(), self.b.create_block(), self.b.create_block());
        let (found, none, after) = (self.b.create_block(), self.b.create_block(), self.b.create_block());
        let place = self.b.append_param(pass, Type::I32);
        let result = self.b.append_param(after, Type::I32);
        self.b.jump(pass, &[first]);
        self.b.switch_to(pass);
        let is_left = self.b.icmp(IntCc::Ult, place, count);
        self.b.branch(is_left, look, none);
        self.b.seal_block(look);
        self.b.seal_block(none);
        self.b.switch_to(look);
        let at = self.entry(table, place);
        let entry = self.b.load(Type::I16, at);
        let matches = self.b.icmp(relation, entry, pattern);
        self.b.branch(matches, found, next);
        self.b.seal_block(found);
        self.b.seal_block(next);
        self.b.switch_to(next);
        let following = self.b.binary_imm(BinaryOp::Iadd, place, 1);
        self.b.jump(pass, &[following]);
        self.b.seal_block(pass);
        self.b.switch_to(found);
        self.b.jump(after, &[place]);
        self.b.switch_to(none);
        self.b.jump(after, &[count]);
        self.b.seal_block(after);
        self.b.switch_to(after);
        let result = self.b.trunc(Type::I16, result);
        self.store(target, Width::Word, result);
    }

    /// The count of entries. More than a table may have is an error.
    fn count_of_table(&mut self, table: Table) -> Value {
        let count = self.b.load(Type::I16, table.count());
        let possible = self.b.icmp_imm(IntCc::Ule, count, i64::from(TABLE_ENTRIES_MAX));
        self.error_unless(possible, error::RANGE, fatal::INTERNAL);
        count
    }

    /// The address of the entry at this place, which counts from 0.
    fn entry(&mut self, table: Table, place: Value) -> Address {
        let place = self.b.zext(Type::I32, place);
        let mut bytes = self.b.binary_imm(BinaryOp::Shl, place, 1);
        if let Some(base) = table.base {
            bytes = self.b.iadd(base, bytes);
        }
        Address { base: Some(bytes), ..table.word(2) }
    }

    /// Clears bit `flag` of SM1 and does `body`. Unless that is possible, sets the bit, and ENO is 0.
    fn unless_refused(&mut self, possible: Value, flag: u8, body: impl FnOnce(&mut Self)) {
        let (run, refused, after) = (self.b.create_block(), self.b.create_block(), self.b.create_block());
        self.b.branch(possible, run, refused);
        self.b.seal_block(run);
        self.b.seal_block(refused);
        self.b.switch_to(refused);
        let (yes, no) = (self.b.bool_const(true), self.b.bool_const(false));
        self.set_flag(flag, yes);
        self.set(self.eno, no);
        self.b.jump(after, &[]);
        self.b.switch_to(run);
        let no = self.b.bool_const(false);
        self.set_flag(flag, no);
        body(self);
        self.b.jump(after, &[]);
        self.b.seal_block(after);
        self.b.switch_to(after);
    }
}
