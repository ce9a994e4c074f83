//! Texts where they are: in the frame, in memory, at pointers of formal parameters, and how much of them exists.

use plcc_abi::layout::{AREA_BYTES, area};
use plcc_abi::text::{LOCAL, ROOM_MAX};
use plcc_ir::{Address, BinaryOp, IntCc, Region, Value};
use plcc_model::types::DataType;
use plcc_model::{Passing, Width};

use crate::block::BlockLowering;
use crate::fault::Check;
use crate::place;
use crate::plan::{GivenText, takes_references};
use crate::pointer::PointerFields;
use crate::scl::OwnText;

/// Bytes before the characters of a STRING.
pub(super) const HEAD_BYTES: i64 = 2;

/// A text in memory.
pub struct TextOperand {
    pub(super) addr: Address,
    /// The same as offset from the memory base, an i32.
    pub(super) address: Value,
    /// Characters that exist there, an i32 as [`plcc_abi::text`] describes it.
    pub(super) room: Value,
    /// The same with at most 254 characters in local data, too.
    pub(super) limit: Value,
    /// The declared maximum; 0 if it is not known.
    pub(super) declared: u8,
    /// The characters of a constant.
    pub(super) characters: Option<Vec<u8>>,
    /// The bytes of a constant, with its head: they are stored where something is called.
    pub(super) constant: Vec<u8>,
    /// Its length is a value.
    pub(super) own: Option<OwnText>,
    /// What it was made of has no more characters.
    pub(super) longest: Option<u32>,
    /// It is a parameter that this one is of; `room` is only found out where it is needed.
    pub(super) formal: Option<usize>,
    /// It is the result of this function, which has no other name.
    pub(super) is_result: bool,
    /// It exists as a whole, but `room` is not what the runtime wants to know.
    pub is_whole: bool,
    /// i1: address and room are right.
    ok: Value,
}

impl TextOperand {
    /// A text at `addr`, that is at `address`, of which nothing else is known.
    fn new(addr: Address, address: Value, room: Value, declared: u8, ok: Value) -> TextOperand {
        TextOperand {
            addr,
            address,
            room,
            limit: room,
            declared,
            characters: None,
            constant: Vec::new(),
            own: None,
            longest: None,
            formal: None,
            is_result: false,
            is_whole: false,
            ok,
        }
    }

    /// The same text, of which it is known what it has at most.
    pub fn with_longest(self, longest: Option<u32>) -> TextOperand {
        TextOperand { longest, ..self }
    }
}

/// What the pointer of a formal parameter says about the text there.
#[derive(Clone, Copy)]
pub struct FormalText {
    /// As in [`TextOperand`].
    pub(super) room: Value,
    limit: Value,
    ok: Value,
    /// What is known of all texts that the parameter gets.
    pub given: Option<GivenText>,
    parameter: usize,
    /// It is the result, and its length is a value.
    pub own: Option<OwnText>,
}

impl FormalText {
    /// The declared maximum of all texts that the parameter gets; 0 if it is not known.
    pub fn declared(&self) -> u8 {
        self.given.map_or(0, |given| given.declared)
    }

    /// It has no other name.
    pub fn is_room(&self) -> bool {
        self.given.is_some_and(|given| given.is_room)
    }
}

impl BlockLowering<'_, '_> {
    /// A text in this block's frame.
    pub fn text_in_frame(&mut self, addr: Address, declared: u8) -> TextOperand {
        let (address, room) = (self.b.address_of(addr), self.b.i32_const(LOCAL.into()));
        let limit = self.b.i32_const(ROOM_MAX);
        let own = self.own_text(addr, declared);
        let ok = self.b.bool_const(true);
        TextOperand { limit, own, ..TextOperand::new(addr, address, room, declared, ok) }
    }

    /// A constant with its head, for which there is room in this block's frame.
    pub fn constant_text(&mut self, addr: Address, bytes: &[u8]) -> Option<TextOperand> {
        let (&[maximum, length], characters) = bytes.split_first_chunk()?;
        let characters = characters.get(..usize::from(length))?.to_vec();
        if maximum == 0 {
            self.store_bytes(addr, bytes);
        }
        let (characters, constant) = match maximum {
            0 => (None, Vec::new()),
            _ => (Some(characters), bytes.to_vec()),
        };
        Some(TextOperand { characters, constant, own: None, ..self.text_in_frame(addr, maximum) })
    }

    /// A text at `addr` if all `checks` hold; with a `declared` maximum all of it exists then. `pointer` makes the pointer to it that a called block would get. `None`: only the system function
    /// decides whether it may be written.
    pub fn text_in_memory(
        &mut self,
        addr: Address,
        declared: u8,
        checks: &[Check],
        direction: place::Direction,
        pointer: impl FnOnce(&mut Self) -> PointerFields,
    ) -> Option<TextOperand> {
        let mut ok = self.b.bool_const(true);
        for check in checks {
            ok = self.b.and(ok, check.ok);
        }
        let profile = &self.plan.program.profile;
        let protected = &self.plan.protected_dbs;
        let writes = direction == place::Direction::Write;
        let length = match addr.region {
            Region::L => {
                let operand = self.text_in_frame(addr, declared);
                return Some(TextOperand { ok, ..operand });
            }
            Region::I => profile.inputs,
            Region::Q => profile.outputs,
            Region::M => profile.bit_memory,
            Region::Db(number) if !writes || !protected.contains(&number) => self.plan.static_db(number)?.length,
            Region::AnyDb | Region::Any if !writes || protected.is_empty() => {
                let fields = pointer(self);
                return Some(self.text_at_pointer(addr, declared, fields, ok));
            }
            _ => return None,
        };
        let address = self.b.address_of(addr);
        let length = self.b.i32_const(length.min(AREA_BYTES));
        let byte = self.b.i32_const(addr.offset);
        let byte = match addr.base {
            Some(base) => self.b.iadd(byte, base),
            None => byte,
        };
        let room = self.room(length, byte);
        Some(TextOperand::new(addr, address, room, declared, ok))
    }

    /// A text with a `declared` maximum at `addr`, all of which exists if `ok`: where it is need not be known. Only for functions that are done
    /// without a call.
    pub fn whole_text(&mut self, addr: Address, declared: u8, ok: Value) -> TextOperand {
        let (address, room) = (self.b.address_of(addr), self.b.i32_const(declared.into()));
        TextOperand { is_whole: true, ..TextOperand::new(addr, address, room, declared, ok) }
    }

    /// The text that a formal parameter of this function is, at `addr`; what its pointer says was found out where the function began.
    pub fn formal_text(&mut self, addr: Address, formal: FormalText) -> TextOperand {
        let FormalText { room, limit, ok, own, parameter, .. } = formal;
        let declared = formal.declared();
        let address = self.b.address_of(addr);
        TextOperand {
            limit,
            own,
            formal: (declared != 0).then_some(parameter),
            is_result: formal.is_room(),
            ..TextOperand::new(addr, address, room, declared, ok)
        }
    }

    /// Follows the pointers of the formal parameters of a function that are texts. They stay as they are while it runs.
    pub fn begin_formal_texts(&mut self) {
        if !takes_references(self.block) {
            return;
        }
        let block = self.block;
        for (parameter, formal) in block.interface.parameters.iter().enumerate() {
            if let (Passing::Complex { .. }, DataType::String(_)) = (formal.passing, &formal.ty) {
                let given = self.plan.given_text(block.key(), parameter);
                let yes = self.b.bool_const(true);
                let mut formal = match given {
                    Some(given) if given.declared != 0 => {
                        let none = self.b.i32_const(0);
                        FormalText { room: none, limit: none, ok: yes, given: None, parameter, own: None }
                    }
                    _ => self.room_of_formal(parameter),
                };
                if given.is_some() {
                    formal = FormalText { ok: yes, given, own: self.own_result(parameter), ..formal };
                }
                self.formal_texts.insert(parameter, formal);
            }
        }
    }

    /// What the pointer of a formal parameter says of the text there. Where it is in local data does not matter.
    pub(super) fn room_of_formal(&mut self, parameter: usize) -> FormalText {
        let db = self.read_parameter_structure(parameter, 0, Width::Word);
        let pointer = self.read_parameter_structure(parameter, 2, Width::Dword);
        let FormalText { room, limit, ok, .. } = self.room_at_pointer(PointerFields { db, pointer }, 0);
        FormalText { room, limit, ok, given: None, parameter, own: None }
    }

    /// A text at `addr`, to which `fields` point.
    fn text_at_pointer(&mut self, addr: Address, declared: u8, fields: PointerFields, ok: Value) -> TextOperand {
        let address = self.b.address_of(addr);
        let FormalText { room, limit, ok: known, .. } = self.room_at_pointer(fields, declared);
        let ok = self.b.and(ok, known);
        TextOperand { limit, ..TextOperand::new(addr, address, room, declared, ok) }
    }

    /// What `fields` say of the text to which they point: it is in a DB, with a `declared` maximum as a whole, or in local data.
    fn room_at_pointer(&mut self, fields: PointerFields, declared: u8) -> FormalText {
        let code = self.b.binary_imm(BinaryOp::Lshr, fields.pointer, 24);
        let in_db = self.b.icmp_imm(IntCc::Eq, code, i64::from(area::DB));
        let is_local = self.b.icmp_imm(IntCc::Eq, code, i64::from(area::V));
        let bits = self.b.binary_imm(BinaryOp::And, fields.pointer, 0x0007_FFFF);
        let byte = self.b.binary_imm(BinaryOp::Lshr, bits, 3);
        let length = self.b.db_length(fields.db);
        let room = self.room(length, byte);
        let end = self.b.binary_imm(BinaryOp::Iadd, byte, HEAD_BYTES + i64::from(declared));
        let inside = self.b.icmp(IntCc::Ule, end, length);
        let in_db = self.b.and(in_db, inside);
        let [local, most] = [LOCAL.into(), ROOM_MAX].map(|characters| self.b.i32_const(characters));
        let limit = self.b.select(is_local, most, room);
        let room = self.b.select(is_local, local, room);
        FormalText { room, limit, ok: self.b.or(in_db, is_local), given: None, parameter: usize::MAX, own: None }
    }

    /// Characters of a text at `byte` that exist, if `length` bytes exist from 0 on.
    fn room(&mut self, length: Value, byte: Value) -> Value {
        let rest = self.b.isub(length, byte);
        let rest = self.b.binary_imm(BinaryOp::Iadd, rest, -HEAD_BYTES);
        let most = self.b.i32_const(ROOM_MAX);
        let is_less = self.b.icmp(IntCc::Ult, rest, most);
        self.b.select(is_less, rest, most)
    }

    /// Address and room of all `texts` are right, an i1.
    pub fn texts_are_known(&mut self, texts: &[TextOperand]) -> Value {
        let mut known = self.b.bool_const(true);
        for operand in texts {
            known = self.b.and(known, operand.ok);
        }
        known
    }
}
