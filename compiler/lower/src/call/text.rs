//! Functions of texts as calls of the runtime with addresses.
//!
//! Most functions of texts in the library only hand their parameters on to a system function, which gets each STRING as an ANY pointer. Where
//! the compiler knows where the STRINGs are, the call of such a block becomes a call of the runtime function that does the same with
//! addresses.

use plcc_abi::image::BlockKind;
use plcc_abi::layout::{AREA_BYTES, area};
use plcc_abi::text::{BR, LOCAL, OPERAND_BITS, ROOM_MAX, WRITTEN};
use plcc_abi::{RuntimeFn, Type};
use plcc_ir::{Address, BinaryOp, IntCc, Region, Value};
use plcc_model::types::DataType;
use plcc_model::{Actual, Argument, Body, CodeBlock, Direction, Passing, Place, StlStatementKind, Width};

use super::big_endian;
use super::text_short::writes_text;
use crate::block::BlockLowering;
use crate::fault::Check;
use crate::place;
use crate::plan::{GivenText, Plan, takes_references};
use crate::pointer::PointerFields;
use crate::scl::OwnText;

/// The runtime functions of system functions, by number. Their arguments are what is known of the texts, the inputs in the order of the system function,
/// then the text that is written.
const FUNCTIONS: &[(u16, RuntimeFn)] = &[
    (2000, RuntimeFn::TextConcat),
    (2001, RuntimeFn::TextCompare),
    (2002, RuntimeFn::TextFind),
    (2003, RuntimeFn::TextLength),
    (2004, RuntimeFn::TextReplace),
    (2005, RuntimeFn::TextLeft),
    (2006, RuntimeFn::TextRight),
    (2007, RuntimeFn::TextMid),
    (2008, RuntimeFn::TextDelete),
    (2009, RuntimeFn::TextInsert),
    (2010, RuntimeFn::TextOfDint),
    (2012, RuntimeFn::TextOfReal),
    (2014, RuntimeFn::TextFixedOfReal),
    (2020, RuntimeFn::TextToDint),
    (2021, RuntimeFn::TextToReal),
    (2026, RuntimeFn::TextScan),
    (2027, RuntimeFn::TextScan),
    (2028, RuntimeFn::TextToDint),
    (2029, RuntimeFn::TextOfDint),
    (2035, RuntimeFn::TextScanReal),
];

/// LEN of STEP 7 V5.
const LENGTH: u16 = 21;
/// Bytes before the characters of a STRING.
const HEAD_BYTES: i64 = 2;

/// What a block of the library hands on, by the indices of its own parameters.
pub struct TextCall {
    pub function: RuntimeFn,
    pub inputs: Vec<TextInput>,
    /// The text that is written.
    pub out: Option<usize>,
    /// The elementary parameter that gets the value, and whether it stays as it is if the function has none.
    pub value: Option<(usize, bool)>,
}

/// An argument of a runtime function.
pub enum TextInput {
    /// The text of a parameter.
    Text(usize),
    /// The elementary value of a parameter.
    Value(usize),
    Const(u32),
}

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
    formal: Option<usize>,
    /// It is the result of this function, which has no other name.
    pub(super) is_result: bool,
    /// It exists as a whole, but `room` is not what the runtime wants to know.
    pub is_whole: bool,
    /// i1: address and room are right.
    ok: Value,
}

impl TextOperand {
    /// The same text, of which it is known what it has at most.
    pub fn with_longest(self, longest: Option<u32>) -> TextOperand {
        TextOperand { longest, ..self }
    }
}

/// The result of a function of texts.
#[derive(Clone, Copy)]
pub struct TextResult {
    /// An i32.
    pub value: Value,
    /// There is a value, an i1; without it the variable for the value stays as it is.
    pub written: Value,
}

/// What the pointer of a formal parameter says about the text there.
#[derive(Clone, Copy)]
pub struct FormalText {
    /// As in [`TextOperand`].
    room: Value,
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

/// What `callee` hands on, if it does nothing else and the runtime has a function for it.
pub fn text_call(plan: &Plan, callee: &CodeBlock) -> Option<TextCall> {
    let Body::Stl(statements) = &callee.body else { return None };
    let [statement] = &statements[..] else { return None };
    let StlStatementKind::Call(call) = &statement.kind else { return None };
    if call.target.kind != BlockKind::Sfc {
        return None;
    }
    let &(_, function) = FUNCTIONS.iter().find(|(number, _)| *number == call.target.number)?;
    let (system, _) = plan.block(call.target)?;
    let mut text = TextCall { function, inputs: Vec::new(), out: None, value: None };
    for (index, parameter) in system.interface.parameters.iter().enumerate() {
        let argument = call.arguments.iter().find(|argument| argument.parameter == index)?;
        let own = match &argument.actual {
            Actual::PointerTo { place: Place::Parameter { parameter, byte: 0, bit: 0 }, .. }
            | Actual::Place(Place::Parameter { parameter, byte: 0, bit: 0 }) => Some(*parameter),
            _ => None,
        };
        match (parameter.direction, parameter.passing, &argument.actual) {
            (Direction::Input, Passing::Any, _) => text.inputs.push(TextInput::Text(own?)),
            (Direction::Input, Passing::Elementary(_), Actual::Const(bytes)) => {
                text.inputs.push(TextInput::Const(big_endian(bytes)));
            }
            (Direction::Input, Passing::Elementary(_), _) => text.inputs.push(TextInput::Value(own?)),
            (Direction::Output, Passing::Any, _) => text.out = Some(own?),
            (direction, Passing::Elementary(_), _) => text.value = Some((own?, direction == Direction::InOut)),
            _ => return None,
        }
    }
    Some(text)
}

/// True of LEN of STEP 7 V5, which only reads the second byte of a text.
pub fn is_length(plan: &Plan, callee: &CodeBlock) -> bool {
    callee.library && callee.kind == BlockKind::Fc && callee.number == LENGTH && !plan.checks_depth
}

impl BlockLowering<'_, '_> {
    /// A text in this block's frame.
    pub fn text_in_frame(&mut self, addr: Address, declared: u8) -> TextOperand {
        let (address, room) = (self.b.address_of(addr), self.b.i32_const(LOCAL.into()));
        let limit = self.b.i32_const(ROOM_MAX);
        TextOperand {
            addr,
            address,
            room,
            limit,
            declared,
            characters: None,
            constant: Vec::new(),
            own: self.own_text(addr, declared),
            longest: None,
            formal: None,
            is_result: false,
            is_whole: false,
            ok: self.b.bool_const(true),
        }
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
        Some(TextOperand {
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
        })
    }

    /// A text with a `declared` maximum at `addr`, all of which exists if `ok`: where it is need not be known. Only for functions that are done
    /// without a call.
    pub fn whole_text(&mut self, addr: Address, declared: u8, ok: Value) -> TextOperand {
        let (address, room) = (self.b.address_of(addr), self.b.i32_const(declared.into()));
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
            is_whole: true,
            ok,
        }
    }

    /// The text that a formal parameter of this function is, at `addr`; what its pointer says was found out where the function began.
    pub fn formal_text(&mut self, addr: Address, formal: FormalText) -> TextOperand {
        let FormalText { room, limit, ok, own, parameter, .. } = formal;
        let declared = formal.declared();
        TextOperand {
            addr,
            address: self.b.address_of(addr),
            room,
            limit,
            declared,
            characters: None,
            constant: Vec::new(),
            own,
            formal: (declared != 0).then_some(parameter),
            is_result: formal.is_room(),
            longest: None,
            is_whole: false,
            ok,
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
    fn room_of_formal(&mut self, parameter: usize) -> FormalText {
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
        TextOperand {
            addr,
            address,
            room,
            limit,
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

    /// Calls a runtime `function` in place of `callee`, with its texts and, for each input, the value if it is not a text.
    /// The result is described at [`plcc_abi::text`]; its BR is the block's.
    pub fn run_text(
        &mut self,
        function: RuntimeFn,
        callee: &CodeBlock,
        texts: &[TextOperand],
        values: &[Option<Value>],
    ) -> TextResult {
        for text in texts {
            if let Some(own) = text.own {
                self.store_own_length(text.addr, own);
            }
            self.store_bytes(text.addr, &text.constant);
        }
        let depth = self.enter_call(callee);
        let mut known = self.b.iconst(Type::I64, 0);
        for (index, operand) in texts.iter().enumerate() {
            let declared = i64::from(operand.declared) << (OPERAND_BITS / 2);
            let room = match operand.formal {
                Some(parameter) => self.room_of_formal(parameter).room,
                None => operand.room,
            };
            let operand = self.b.binary_imm(BinaryOp::Or, room, declared);
            let operand = self.b.zext(Type::I64, operand);
            let operand = self.b.binary_imm(BinaryOp::Shl, operand, i64::from(OPERAND_BITS) * index as i64);
            known = self.b.or(known, operand);
        }
        let mut addresses = texts.iter().map(|operand| operand.address);
        let mut arguments = vec![known];
        for value in values {
            arguments.push(value.or_else(|| addresses.next()).expect("an input is a value or a text"));
        }
        arguments.extend(addresses);
        let result = self.b.call_runtime(function, &arguments).expect("functions of texts have a result");
        self.leave_call(depth);
        if let (true, Some(text)) = (writes_text(function), texts.last())
            && let Some(own) = text.own
        {
            self.load_own_length(text.addr, own);
        }
        let br = self.bit_of(result, BR);
        self.set(self.regs.br, br);
        let value = self.b.trunc(Type::I32, result);
        TextResult { value, written: self.bit_of(result, WRITTEN) }
    }

    /// A bit of the result of a function of texts.
    fn bit_of(&mut self, result: Value, bit: u64) -> Value {
        let shifted = self.b.binary_imm(BinaryOp::Lshr, result, i64::from(bit.trailing_zeros()));
        self.b.trunc(Type::I1, shifted)
    }

    /// Address and room of all `texts` are right, an i1.
    pub fn texts_are_known(&mut self, texts: &[TextOperand]) -> Value {
        let mut known = self.b.bool_const(true);
        for operand in texts {
            known = self.b.and(known, operand.ok);
        }
        known
    }

    /// Does a call from STL by the runtime function of `text`. False: the block is called, since an address is only known at run time.
    pub(super) fn call_known_texts(&mut self, text: &TextCall, callee: &CodeBlock, arguments: &[Argument]) -> bool {
        let db = self.get(self.regs.db);
        let Some((texts, values)) = self.text_arguments_of(text, callee, arguments) else {
            self.set(self.regs.db, db);
            return false;
        };
        self.set(self.regs.db, db);
        let known = self.texts_are_known(&texts);
        if self.b.constant_bits(known) != Some(1) {
            return false;
        }
        let result = self.run_text_shortly(text.function, callee, &texts, &values);
        let Some((parameter, keeps)) = text.value else { return true };
        let Some(Actual::Place(place)) = actual(arguments, parameter) else {
            unreachable!("the arguments have been looked at")
        };
        let Passing::Elementary(width) = callee.interface.parameters[parameter].passing else {
            unreachable!("the value of a function of texts is elementary")
        };
        let TextResult { value, written } = result;
        let value = if width == Width::Bit { self.b.trunc(Type::I1, value) } else { value };
        if !keeps {
            self.write(place, width, value);
            self.set(self.regs.db, db);
            return true;
        }
        let (write, after) = (self.b.create_block(), self.b.create_block());
        self.b.branch(written, write, after);
        self.b.seal_block(write);
        self.b.switch_to(write);
        self.write(place, width, value);
        self.set(self.regs.db, db);
        self.b.jump(after, &[]);
        self.b.seal_block(after);
        self.b.switch_to(after);
        true
    }

    /// The texts and values of a call from STL; `None` if there is one that only the block can use.
    #[allow(clippy::type_complexity, reason = "used once")]
    fn text_arguments_of(
        &mut self,
        text: &TextCall,
        callee: &CodeBlock,
        arguments: &[Argument],
    ) -> Option<(Vec<TextOperand>, Vec<Option<Value>>)> {
        if let Some((parameter, _)) = text.value {
            self.plain_place(actual(arguments, parameter)?, callee, parameter)?;
        }
        let (mut texts, mut values) = (Vec::new(), Vec::new());
        for input in &text.inputs {
            let value = match *input {
                TextInput::Text(parameter) => {
                    texts.push(self.text_of(actual(arguments, parameter)?, place::Direction::Read)?);
                    None
                }
                TextInput::Value(parameter) => {
                    let own = actual(arguments, parameter)?;
                    let value = match own {
                        Actual::Const(bytes) if bytes.len() <= 4 => self.b.i32_const(big_endian(bytes)),
                        _ => {
                            let (place, width) = self.plain_place(own, callee, parameter)?;
                            self.read(place, width)
                        }
                    };
                    let is_word = callee.interface.parameters[parameter].passing == Passing::Elementary(Width::Word);
                    Some(if is_word { self.sign_extended(value) } else { value })
                }
                TextInput::Const(value) => Some(self.b.i32_const(value)),
            };
            values.push(value);
        }
        if let Some(parameter) = text.out {
            texts.push(self.text_of(actual(arguments, parameter)?, place::Direction::Write)?);
        }
        Some((texts, values))
    }

    /// The place of an elementary actual in memory, an access to which cannot fail.
    fn plain_place<'m>(
        &mut self,
        actual: &'m Actual,
        callee: &CodeBlock,
        parameter: usize,
    ) -> Option<(&'m Place, Width)> {
        let Actual::Place(place) = actual else { return None };
        let Passing::Elementary(width) = callee.interface.parameters[parameter].passing else { return None };
        let is_memory = matches!(
            place,
            Place::I { .. }
                | Place::Q { .. }
                | Place::M { .. }
                | Place::L { .. }
                | Place::Db { .. }
                | Place::Instance { .. }
        );
        if !is_memory {
            return None;
        }
        let target = self.target(place, width, place::Direction::Write);
        target.checks.is_empty().then_some((place, width))
    }

    fn text_of(&mut self, actual: &Actual, direction: place::Direction) -> Option<TextOperand> {
        let place = match actual {
            Actual::Place(place) => place,
            Actual::Const(bytes) => {
                let addr = self.temporary(bytes.len() as u32);
                return self.constant_text(addr, bytes);
            }
            Actual::Number(_)
            | Actual::PointerBytes(_)
            | Actual::PointerTo { .. }
            | Actual::PointerCopy(_)
            | Actual::Variant(..) => return None,
        };
        let target = self.target(place, Width::Byte, direction);
        let (addr, _, checks) = self.in_memory(target, Width::Byte, direction);
        let maximum = self.maximum_at_start(place);
        self.text_in_memory(addr, maximum, &checks, direction, |lowering| lowering.pointer_fields(place))
    }

    /// The maximum of the text at `place` as the data block has it when it is loaded; 0 if it is not known. Whoever is in a hurry looks whether it is
    /// still so.
    fn maximum_at_start(&self, place: &Place) -> u8 {
        let Place::Db { number, byte, bit: 0 } = place else { return 0 };
        let Some(db) = self.plan.db_at_start(*number) else { return 0 };
        let maximum = db.data.get(*byte as usize).copied().unwrap_or(0);
        let exists = *byte as usize + HEAD_BYTES as usize + usize::from(maximum) <= db.data.len();
        if exists && u32::from(maximum) <= ROOM_MAX { maximum } else { 0 }
    }

    /// The low word of an i32 with its sign, as an i32.
    pub fn sign_extended(&mut self, value: Value) -> Value {
        let word = self.b.trunc(Type::I16, value);
        self.b.sext(Type::I32, word)
    }
}

/// The actual of parameter `parameter`.
fn actual(arguments: &[Argument], parameter: usize) -> Option<&Actual> {
    arguments.iter().find(|argument| argument.parameter == parameter).map(|argument| &argument.actual)
}
