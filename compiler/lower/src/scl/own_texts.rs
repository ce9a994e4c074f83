//! Texts in local data whose lengths are values.
//!
//! A TEMP of type STRING that only functions of texts and assignments reach has the head that it was declared with, and nobody but this block
//! changes its length. So there is nothing to look at when it is used, and its length is a value, which memory has only while something is called.
//! The same is true of the rooms for results that only functions of texts read. Where nothing else looks at the characters either, the first
//! eight are a value, too, beside those in memory: what is read does not wait for pieces that have just been written.
//!
//! ```text
//! #field := LEFT(IN := #text, L := #at);     length of #field = at or length of #text, whichever is less
//! #text := CONCAT(IN1 := #text, IN2 := ';')  length of #text plus 1 <= maximum?  no: store both lengths, call the runtime, load the length
//! ```

use plcc_ir::{Address, Region, Type, Value, Var};
use plcc_model::scl::walk::{self, Role, Visitor};
use plcc_model::scl::{Access, Actual, Base, Call, Complex, SclBody, Statement, StatementKind};
use plcc_model::types::DataType;
use plcc_model::{Assert, AssertSide, CodeBlock, Number, Operand, Place};
use rustc_hash::FxHashMap;

use super::promote::{joined, reach};
use crate::block::BlockLowering;
use crate::call::{WORD, declared_of, is_length, text_call};
use crate::plan::Plan;
use crate::pointer::moved;
use crate::probe::Asked;
use crate::scl::text::{TEXT_MAX, TextPlace};

/// Statements times texts of a block up to which lengths are values: each may be a parameter where paths meet.
const SPANS_MAX: usize = 100_000;
/// Longest declared maximum of variables whose first characters are a value: longer texts are hardly compared and read as numbers.
const WORDS_MAX: u8 = 20;

/// A text whose length is a value.
#[derive(Clone, Copy)]
pub struct OwnText {
    pub declared: u8,
    length: Var,
    /// What is after its characters does not matter.
    pub is_room: bool,
    /// Its first eight characters, the first one lowest, and anything after the last one; an i64. `None`: something else looks at them.
    word: Option<Var>,
}

impl BlockLowering<'_, '_> {
    /// Finds the own texts among the TEMPs of a block; they are empty.
    pub fn begin_own_texts(&mut self, body: &SclBody) {
        // A debugger changes variables, and others look at them.
        if !matches!(self.output.probes.asked, Asked::Nothing | Asked::Coverage) {
            return;
        }
        for OwnPlace { byte, declared, is_room } in own_texts(self.plan, self.block, body) {
            self.add_own_text(byte, declared, is_room, declared <= WORDS_MAX);
        }
    }

    fn add_own_text(&mut self, byte: u32, declared: u8, is_room: bool, has_word: bool) {
        let text = self.empty_text(declared, is_room, has_word);
        self.scl.own_texts.insert(byte, text);
    }

    fn empty_text(&mut self, declared: u8, is_room: bool, has_word: bool) -> OwnText {
        let length = self.b.declare_var(Type::I32);
        let zero = self.b.i32_const(0);
        self.b.def_var(length, zero);
        let word = (is_room && has_word && u32::from(declared) >= WORD).then(|| {
            let word = self.b.declare_var(Type::I64);
            let none = self.b.iconst(Type::I64, 0);
            self.b.def_var(word, none);
            word
        });
        OwnText { declared, length, is_room, word }
    }

    /// The text that is parameter `index` of this function, its result, if only its own statements look at its length.
    pub fn own_result(&mut self, index: usize) -> Option<OwnText> {
        let is_result = crate::scl::result(self.block).is_some_and(|(result, _)| result == index);
        let is_watched = !matches!(self.output.probes.asked, Asked::Nothing | Asked::Coverage);
        if !is_result || is_watched || !self.plan.has_own_result(self.block.key()) {
            return None;
        }
        let given = self.plan.given_text(self.block.key(), index)?;
        Some(self.empty_text(given.declared, true, true))
    }

    /// The caller looks at the length of the result.
    pub fn leave_own_result(&mut self) {
        let Some((index, _)) = crate::scl::result(self.block) else { return };
        let own = self.formal_texts.get(&index).and_then(|formal| formal.own);
        if let Some(own) = own {
            let target = self.parameter_text(index);
            self.store_own_length(target, own);
        }
    }

    /// Where the text that is a parameter of this function begins.
    fn parameter_text(&self, index: usize) -> Address {
        Address::indexed(Region::Any, self.parameters[index][1], 0)
    }

    /// The room at `addr` is for an empty text that only functions of texts read and write.
    pub fn add_room(&mut self, addr: Address) {
        self.add_own_text(addr.offset, TEXT_MAX as u8, true, true);
    }

    /// Something else may be at `addr` from now on.
    pub fn drop_room(&mut self, addr: Address) {
        self.scl.own_texts.remove(&addr.offset);
    }

    /// The own text that is at `addr` with a `declared` maximum.
    pub fn own_text(&self, addr: Address, declared: u8) -> Option<OwnText> {
        let is_direct = addr.region == Region::L && addr.base.is_none();
        let own = self.scl.own_texts.get(&addr.offset).filter(|_| is_direct)?;
        (own.declared == declared).then_some(*own)
    }

    /// The own text that is at a place.
    pub fn own_text_at(&self, text: &TextPlace) -> Option<OwnText> {
        match text.formal {
            Some(formal) => formal.own,
            None => self.own_text(text.addr, declared_of(text)),
        }
    }

    /// The own text of an access, and where it is.
    pub fn own_text_of(&self, access: &Access) -> Option<(Address, OwnText)> {
        match access.base {
            Base::Place(Place::L { byte, bit: 0 }) if access.indices.is_empty() => {
                let addr = Address::direct(Region::L, byte);
                let declared = u8::try_from(self.text_limit(access)).ok()?;
                Some((addr, self.own_text(addr, declared)?))
            }
            Base::Place(Place::Parameter { parameter, .. }) => {
                let own = self.formal_text_of(access)?.own?;
                Some((self.parameter_text(parameter), own))
            }
            _ => None,
        }
    }

    /// A function of the program has written its result to the room at `addr`; see [`Plan::has_own_result`].
    pub fn take_own_result(&mut self, addr: Address) {
        self.add_room(addr);
        if let Some(own) = self.own_text(addr, TEXT_MAX as u8) {
            self.load_own_length(addr, own);
        }
    }

    /// Its length, an i32.
    pub fn own_length(&mut self, own: OwnText) -> Value {
        self.b.use_var(own.length)
    }

    pub fn set_own_length(&mut self, own: OwnText, length: Value) {
        self.b.def_var(own.length, length);
    }

    /// Its first eight characters, if they are a value: the first one lowest, and anything after the last one.
    pub fn own_word(&mut self, own: OwnText) -> Option<Value> {
        own.word.map(|word| self.b.use_var(word))
    }

    /// Notes its first eight characters, where they are a value.
    pub fn set_own_word(&mut self, own: OwnText, characters: Value) {
        if let Some(word) = own.word {
            self.b.def_var(word, characters);
        }
    }

    /// Stores the length of the text at `addr` for whoever is called now.
    pub fn store_own_length(&mut self, addr: Address, own: OwnText) {
        let length = self.b.use_var(own.length);
        let length = self.b.trunc(Type::I8, length);
        self.b.store(Address { offset: addr.offset + 1, ..addr }, length);
    }

    /// Loads the length of the text at `addr` that was written by whoever was called.
    pub fn load_own_length(&mut self, addr: Address, own: OwnText) {
        let length = self.b.load(Type::I8, Address { offset: addr.offset + 1, ..addr });
        let length = self.b.zext(Type::I32, length);
        self.b.def_var(own.length, length);
        if let Some(word) = own.word {
            let characters = self.load_word(moved(addr, 2));
            self.b.def_var(word, characters);
        }
    }
}

impl OwnText {
    /// Its first eight characters are a value.
    pub const fn has_word(&self) -> bool {
        self.word.is_some()
    }
}

/// An own text in VAR_TEMP.
struct OwnPlace {
    /// In the frame.
    byte: u32,
    declared: u8,
    /// Nothing else reaches its characters.
    is_room: bool,
}

/// The texts in VAR_TEMP of a block of which only functions of texts and assignments reach the heads.
fn own_texts(plan: &Plan, block: &CodeBlock, body: &SclBody) -> Vec<OwnPlace> {
    let mut texts: Vec<(u32, u8)> = Vec::new();
    for text in body.temporary_texts.iter().filter(|text| !text.wide && text.byte >= block.interface.start_bytes) {
        texts
            .extend(u8::try_from(text.maximum).ok().filter(|&maximum| maximum > 0).map(|maximum| (text.byte, maximum)));
    }
    if texts.is_empty() {
        return Vec::new();
    }
    let uses = Uses::of(plan, body);
    if uses.everything || uses.statements * texts.len() > SPANS_MAX {
        return Vec::new();
    }
    // What is reached in other ways, or as two texts.
    let mut memory = uses.memory;
    for (&text, found) in &uses.by_name {
        if found.all != found.allowed || !texts.contains(&text) {
            memory.push(bits(text));
        }
    }
    let memory = joined(&memory);
    let is_reached = |(start, end): (u32, u32)| {
        let next = memory.partition_point(|&(_, to)| to <= start);
        memory.get(next).is_some_and(|&(from, _)| from < end)
    };
    texts.sort_unstable();
    let overlap = |one: (u32, u8), two: (u32, u8)| bits(one).1 > bits(two).0;
    let apart = |at: usize| {
        (at == 0 || !overlap(texts[at - 1], texts[at])) && (at + 1 >= texts.len() || !overlap(texts[at], texts[at + 1]))
    };
    let head = |(byte, _): (u32, u8)| (8 * byte, 8 * (byte + 2));
    let own = (0..texts.len()).filter(|&at| apart(at) && !is_reached(head(texts[at]))).map(|at| texts[at]);
    own.map(|(byte, declared)| OwnPlace { byte, declared, is_room: !is_reached(bits((byte, declared))) }).collect()
}

/// Whether only functions of texts and assignments reach the text that is parameter `result` of a function.
pub fn is_own_result(plan: &Plan, body: &SclBody, result: usize) -> bool {
    let uses = Uses::of(plan, body);
    let is_whole = uses.parameters.get(&result).is_none_or(|found| found.all == found.allowed);
    !uses.everything && is_whole && uses.statements <= SPANS_MAX
}

/// First bit of a text, and the first one after it.
fn bits((byte, maximum): (u32, u8)) -> (u32, u32) {
    (8 * byte, 8 * (byte + 2 + u32::from(maximum)))
}

/// How often a text is used by its name, and in how many of these places it may be.
#[derive(Default)]
struct Found {
    all: u32,
    allowed: u32,
}

/// Uses of local data.
struct Uses<'p> {
    plan: &'p Plan<'p>,
    by_name: FxHashMap<(u32, u8), Found>,
    /// Parameters, all accesses included.
    parameters: FxHashMap<usize, Found>,
    /// Bit ranges that something else reaches.
    memory: Vec<(u32, u32)>,
    /// All of it is reached.
    everything: bool,
    statements: usize,
}

impl<'p> Uses<'p> {
    fn of(plan: &'p Plan<'p>, body: &SclBody) -> Uses<'p> {
        let mut uses = Uses {
            plan,
            by_name: FxHashMap::default(),
            parameters: FxHashMap::default(),
            memory: Vec::new(),
            everything: false,
            statements: 0,
        };
        walk::statements(&body.statements, &mut uses);
        uses
    }

    fn allow(&mut self, access: &Access) {
        if let Some(text) = whole_text(access) {
            self.by_name.entry(text).or_default().allowed += 1;
        } else if let Some((parameter, true)) = parameter_of(access) {
            self.parameters.entry(parameter).or_default().allowed += 1;
        }
    }

    fn allow_complex(&mut self, value: &Complex) {
        if let Complex::Variable(access) = value {
            self.allow(access);
        }
    }

    fn memory(&mut self, place: &Place, bits: u32) {
        match place {
            Place::L { byte, bit } => {
                let start = 8 * byte + u32::from(*bit);
                self.memory.push((start, start.saturating_add(bits)));
            }
            Place::Parameter { parameter, .. } => self.parameters.entry(*parameter).or_default().all += 1,
            Place::Indirect { pointer, .. } => self.memory(pointer, 32),
            Place::Element { base, indices } => {
                let reach: u32 = indices.iter().map(|index| index.reach()).fold(0, u32::saturating_add);
                self.memory(base, bits.saturating_add(reach));
                indices.iter().for_each(|index| self.memory(&index.place, 32));
            }
            _ => {}
        }
    }
}

/// A text in local data that an access is of as a whole: its byte and its maximum.
fn whole_text(access: &Access) -> Option<(u32, u8)> {
    match (&access.base, &access.ty) {
        (Base::Place(Place::L { byte, bit: 0 }), DataType::String(maximum))
            if access.indices.is_empty() && access.part.is_none() =>
        {
            Some((*byte, *maximum))
        }
        _ => None,
    }
}

/// The parameter that an access is of, and whether as a whole.
fn parameter_of(access: &Access) -> Option<(usize, bool)> {
    let Base::Place(Place::Parameter { parameter, byte, bit }) = &access.base else { return None };
    let is_whole = access.indices.is_empty() && access.part.is_none() && (*byte, *bit) == (0, 0);
    Some((*parameter, is_whole && matches!(access.ty, DataType::String(_))))
}

impl Visitor for Uses<'_> {
    /// STL reaches local data by address, even a computed one.
    fn statement(&mut self, statement: &Statement) {
        self.statements += 1;
        match &statement.kind {
            StatementKind::Stl(_) => self.everything = true,
            StatementKind::AssignText { target, value } => {
                self.allow(target);
                self.allow_complex(value);
            }
            _ => {}
        }
    }

    fn access(&mut self, access: &Access, _role: Role) {
        if let Some((parameter, _)) = parameter_of(access) {
            self.parameters.entry(parameter).or_default().all += 1;
        }
        match (whole_text(access), &access.base) {
            (Some(text), _) => self.by_name.entry(text).or_default().all += 1,
            (None, Base::Place(Place::Parameter { .. }) | Base::Indexed { .. }) => {}
            (None, Base::Place(place)) => self.memory(place, reach(access)),
        }
    }

    fn place(&mut self, place: &Place) {
        self.memory(place, 32);
    }

    fn call(&mut self, call: &Call) {
        let is_of_texts = self
            .plan
            .block(call.target)
            .is_some_and(|(callee, _)| text_call(self.plan, callee).is_some() || is_length(self.plan, callee));
        if !is_of_texts {
            return;
        }
        for argument in &call.arguments {
            match &argument.actual {
                Actual::Reference(access) => self.allow(access),
                Actual::Complex(value) => self.allow_complex(value),
                _ => {}
            }
        }
    }

    fn assert(&mut self, assert: &Assert) {
        for side in assert.sides() {
            match side {
                AssertSide::Memory(place) => self.memory(place, 8 * plcc_abi::layout::L_CLASS_BYTES),
                AssertSide::Operand(Operand::Memory { place, .. }) => self.memory(place, 64),
                AssertSide::Operand(Operand::Cell { number: Number::Word(place), .. })
                | AssertSide::CellValue { number: Number::Word(place), .. } => self.memory(place, 32),
                AssertSide::Operand(_) | AssertSide::CellValue { .. } | AssertSide::Register(_) => {}
            }
        }
    }
}
