//! Writes texts: parts of others one after the other, and copies.

use plcc_abi::Type;
use plcc_abi::text::ROOM_MAX;
use plcc_ir::{Address, BinaryOp, Block, IntCc, Value};

use super::HEAD_BYTES;
use super::texts::{Places, Text, apart};
use crate::block::BlockLowering;
use crate::call::text_copies::{BLOCK, Copied};
use crate::call::text_words::WORD;
use crate::pointer::moved;
use crate::scl::OwnText;
use crate::scl::text::TextPlace;

/// Characters that become part of a result.
pub(super) struct Part<'t> {
    pub text: &'t Text<'t>,
    /// Characters before it, an i32.
    pub skipped: Value,
    /// An i32.
    pub count: Value,
}

impl BlockLowering<'_, '_> {
    /// Writes `parts` one after the other to `out`. Of those that are there already, one at most moves: what is before the others it moves
    /// past is at its place, so it goes first.
    pub(super) fn put(&mut self, parts: &[Part], out: &Text, call: Block) {
        let mut total = self.b.i32_const(0);
        for part in parts {
            total = self.b.iadd(total, part.count);
        }
        // Pieces of a text are together not longer than it; a whole text counts each time.
        let (mut most, mut cut) = (0, Vec::new());
        for part in parts {
            let is_whole = part.count == part.text.length;
            if is_whole || !cut.contains(&part.text.start) {
                most += part.text.most;
            }
            if !is_whole {
                cut.push(part.text.start);
            }
        }
        let is_declared = self.b.constant_bits(out.maximum).is_some();
        if !is_declared || most > out.most {
            let fits = self.b.icmp(IntCc::Ule, total, out.maximum);
            self.require(fits, call);
        }
        let own = out.own.filter(OwnText::has_word);
        let joined = own.and_then(|_| self.joined_word(parts));
        if let (Some(own), Some(word)) = (own, joined)
            && most.min(out.most) <= WORD
        {
            self.store_word(out.start, word);
            self.set_own_word(own, word);
            self.set_own_length(own, total);
            return;
        }
        let mut written = self.b.i32_const(0);
        let mut moves = Vec::new();
        let in_place = |part: &Part| part.text.start == out.start;
        for (at, part) in parts.iter().enumerate() {
            let to = self.indexed(out.start, written);
            let from = self.indexed(part.text.start, part.skipped);
            if to != from {
                // What comes after it is not there yet.
                let is_free = out.own.is_some_and(|own| own.is_room) && !parts[at + 1..].iter().any(in_place);
                moves.push((part, to, from, written, is_free));
            }
            written = self.b.iadd(written, part.count);
        }
        let room = |lowering: &mut Self, part: &Part, written: Value, copied: Copied| {
            let skipped = lowering.b.constant_bits(part.skipped).unwrap_or(0);
            let before = lowering.b.constant_bits(written);
            let reads = copied.word.is_some() || u64::from(part.text.most) >= skipped + u64::from(WORD);
            let writes = u64::from(out.most) >= before.unwrap_or(0) + u64::from(WORD);
            // After another part a word would be read of which the beginning has just been written.
            if !reads || !writes || !copied.is_free && before != Some(0) {
                return None;
            }
            let write = if before == Some(0) { out.maximum } else { lowering.b.isub(out.maximum, written) };
            if copied.word.is_some() {
                return Some(write);
            }
            let read = lowering.b.isub(part.text.maximum, part.skipped);
            Some(lowering.smaller(read, write))
        };
        for &(part, to, from, written, is_free) in moves.iter().filter(|(part, ..)| in_place(part)) {
            // Characters that are kept move on where others come before them, and back where some go; REPLACE may do either.
            let kept_before = parts.iter().find(|other| in_place(other)).map(|first| first.count);
            let nothing_goes = self.b.constant_bits(part.skipped) == Some(0) || kept_before == Some(part.skipped);
            let only_moves = parts.iter().all(in_place);
            let copied = Copied { is_free: is_free && only_moves, ..Copied::default() };
            let room = room(self, part, written, copied);
            match (only_moves, nothing_goes) {
                (true, _) => self.copy_characters(to, from, part.count, out.most, room, copied),
                (false, true) => self.copy_from_end(to, from, part.count, out.most, room),
                (false, false) => {
                    let back = self.b.icmp(IntCc::Ule, written, part.skipped);
                    self.move_characters(to, from, part.count, out.most, room, back);
                }
            }
        }
        // The first characters of a single part are known when it is copied.
        let is_single = matches!(parts, [part] if !in_place(part) && part.text.is_out.is_none());
        let first = (own.is_some() && joined.is_none() && is_single).then(|| self.b.declare_var(Type::I64));
        for &(part, to, from, written, is_free) in moves.iter().filter(|(part, ..)| !in_place(part)) {
            match self.known_characters(part).filter(|characters| characters.len() <= out.most as usize) {
                Some(characters) => self.store_bytes(to, characters),
                None => {
                    // A long text may not need them.
                    let word =
                        if part.text.own.is_some() || part.text.most < BLOCK { self.part_word(part) } else { None };
                    let copied = Copied { word, is_free, first };
                    let room = room(self, part, written, copied);
                    let end = part.text.is_out.filter(|_| part.text.start == from).map(|is_there| {
                        let (copy, end) = (self.b.create_block(), self.b.create_block());
                        self.b.branch(is_there, end, copy);
                        self.b.seal_block(copy);
                        self.b.switch_to(copy);
                        end
                    });
                    self.copy_apart(to, from, part.count, part.text.most.min(out.most), room, copied);
                    if let Some(end) = end {
                        self.b.jump(end, &[]);
                        self.b.seal_block(end);
                        self.b.switch_to(end);
                    }
                }
            }
        }
        if let Some(own) = own {
            let word = match (joined, first) {
                (Some(word), _) => word,
                (None, Some(first)) => self.b.use_var(first),
                (None, None) => self.load_word(out.start),
            };
            self.set_own_word(own, word);
        }
        self.set_length(out, total);
    }

    /// The first eight characters of `parts` one after the other, if those of each are known: the first one lowest, and anything after the
    /// last one.
    fn joined_word(&mut self, parts: &[Part]) -> Option<Value> {
        let mut joined = None;
        for part in parts.iter().rev() {
            if self.b.constant_bits(part.count) == Some(0) {
                continue;
            }
            let word = self.part_word(part)?;
            joined = Some(match joined {
                Some(after) => self.word_before(word, part.count, part.text.most, after),
                None => word,
            });
        }
        joined
    }

    /// The first eight characters of a part, if they are a value or can be loaded.
    fn part_word(&mut self, part: &Part) -> Option<Value> {
        let skipped = self.b.constant_bits(part.skipped);
        let is_short = part.text.most <= WORD;
        if let Some(characters) = part.text.characters {
            let known = skipped.and_then(|skipped| characters.get(usize::try_from(skipped).ok()?..));
            return match known {
                Some(characters) => Some(self.constant_word(characters)),
                None if is_short => {
                    let word = self.constant_word(characters);
                    Some(self.word_after(word, part.skipped))
                }
                None => None,
            };
        }
        if let Some(word) = part.text.own.and_then(|own| self.own_word(own)) {
            return (is_short || skipped == Some(0)).then(|| self.word_after(word, part.skipped));
        }
        let declared = self.b.constant_bits(part.text.maximum)?;
        if skipped == Some(0) { self.first_characters(part.text.start, declared) } else { None }
    }

    /// The characters of a part that are known here.
    fn known_characters<'t>(&self, part: &Part<'t>) -> Option<&'t [u8]> {
        let constant = |value| self.b.constant_bits(value).and_then(|bits| usize::try_from(bits).ok());
        let (skipped, count) = (constant(part.skipped)?, constant(part.count)?);
        part.text.characters?.get(skipped..skipped.checked_add(count)?)
    }

    /// Writes both bytes of the head, the first as it is: a processor waits when it reads a word of which it has just written a part, and the
    /// next function of the text reads the head.
    pub(super) fn set_length(&mut self, out: &Text, length: Value) {
        if let Some(own) = out.own {
            return self.set_own_length(own, length);
        }
        let maximum = self.b.binary_imm(BinaryOp::Shl, out.maximum, 8);
        let head = self.b.or(length, maximum);
        let head = self.b.trunc(Type::I16, head);
        self.b.store(Address { offset: out.start.offset - HEAD_BYTES, ..out.start }, head);
    }

    /// Copies a text as an assignment does, where heads are as declared and it fits. Then all goes on at the result, and what is lowered next does
    /// the rest. `None`: the compiler does not know enough, nothing is lowered.
    pub fn copy_text_shortly(&mut self, to: TextPlace, from: TextPlace) -> Option<Block> {
        if self.scl.by_runtime || [to, from].iter().any(|text| text.formal.is_none() && declared_of(text) == 0) {
            return None;
        }
        let [to_declared, from_declared] = [to, from].map(|text| declared_of(&text));
        let is_result = |text: TextPlace| text.formal.is_some_and(|formal| formal.is_room());
        let places = match is_result(to) == is_result(from) {
            true => apart((to.addr, to_declared), (from.addr, from_declared)),
            false => Places::Apart,
        };
        if places == Places::Same {
            return None;
        }
        let (call, end) = (self.b.create_cold_block(), self.b.create_block());
        let (length, from_maximum) = self.text_to_copy(from, true, call);
        let (_, to_maximum) = self.text_to_copy(to, false, call);
        let may_meet = from.formal.is_some() || to.formal.is_some();
        if places == Places::Unknown || may_meet && is_result(to) == is_result(from) {
            let addresses = [to.addr, from.addr].map(|addr| self.b.address_of(addr));
            let apart = self.are_apart(addresses, [to_maximum, from_maximum]);
            self.require(apart, call);
        }
        if to_declared == 0 || from_declared == 0 || to_declared < from_declared {
            let fits = self.b.icmp(IntCc::Ule, length, to_maximum);
            self.require(fits, call);
        }
        let most = [to_declared, from_declared].into_iter().filter(|&declared| declared != 0).min();
        let most = most.map_or(ROOM_MAX, u32::from);
        let [own, own_from] = [to, from].map(|text| self.own_text_at(&text));
        let word = match own_from.and_then(|own| self.own_word(own)) {
            None if u32::from(from_declared) < BLOCK => {
                self.first_characters(moved(from.addr, HEAD_BYTES), from_declared.into())
            }
            word => word,
        };
        let room = match word {
            Some(_) => to_declared == 0 || u32::from(to_declared) >= WORD,
            None => most >= WORD,
        };
        let room = room.then(|| if word.is_some() { to_maximum } else { self.smaller(to_maximum, from_maximum) });
        let [to_start, from_start] = [to, from].map(|text| moved(text.addr, HEAD_BYTES));
        match (word, own.filter(OwnText::has_word)) {
            (Some(word), Some(_)) if most <= WORD => self.store_word(to_start, word),
            (_, has_word) => {
                let first = has_word.filter(|_| word.is_none()).map(|_| self.b.declare_var(Type::I64));
                let copied = Copied { word, is_free: own.is_some_and(|own| own.is_room), first };
                self.copy_apart(to_start, from_start, length, most, room, copied);
                if let (Some(own), Some(first)) = (own, first) {
                    let word = self.b.use_var(first);
                    self.set_own_word(own, word);
                }
            }
        }
        if let (Some(own), Some(word)) = (own, word) {
            self.set_own_word(own, word);
        }
        if let Some(own) = own {
            self.set_own_length(own, length);
            self.b.jump(end, &[]);
            self.b.seal_block(call);
            self.b.switch_to(call);
            return Some(end);
        }
        // As in `set_length`; the maximum in memory stays.
        let most = self.b.load(Type::I8, to.addr);
        let most = self.b.zext(Type::I32, most);
        let most = self.b.binary_imm(BinaryOp::Shl, most, 8);
        let head = self.b.or(most, length);
        let head = self.b.trunc(Type::I16, head);
        self.b.store(to.addr, head);
        self.b.jump(end, &[]);
        self.b.seal_block(call);
        self.b.switch_to(call);
        Some(end)
    }

    /// Length and maximum of a text that is copied; `is_read`: its length counts.
    fn text_to_copy(&mut self, text: TextPlace, is_read: bool, call: Block) -> (Value, Value) {
        let declared = declared_of(&text);
        let maximum = self.b.i32_const(declared.into());
        if let Some(own) = self.own_text_at(&text) {
            return (self.own_length(own), maximum);
        }
        if text.formal.is_some() && declared != 0 {
            let (ok, length) = self.head_as_declared(text.addr, declared);
            self.require(ok, call);
            return (length, maximum);
        }
        if let Some(formal) = text.formal {
            let operand = self.formal_text(text.addr, formal);
            let known = self.texts_are_known(std::slice::from_ref(&operand));
            self.require(known, call);
            let (ok, length, maximum) = self.head_as_found(&operand);
            self.require(ok, call);
            return (length, maximum);
        }
        if !is_read {
            return (maximum, maximum);
        }
        let (ok, length) = self.head_as_declared(text.addr, declared);
        self.require(ok, call);
        (length, maximum)
    }
}

/// The declared maximum of a text that is copied; 0 if it is not known.
pub fn declared_of(text: &TextPlace) -> u8 {
    match text.formal {
        Some(formal) => formal.declared(),
        None => u8::try_from(text.maximum).unwrap_or(0),
    }
}
