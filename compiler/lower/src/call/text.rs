//! Functions of texts as calls of the runtime with addresses.
//!
//! Most functions of texts in the library only hand their parameters on to a system function, which gets each STRING as an ANY pointer. Where
//! the compiler knows where the STRINGs are, the call of such a block becomes a call of the runtime function that does the same with
//! addresses.

use plcc_abi::image::BlockKind;
use plcc_abi::text::{BR, OPERAND_BITS, ROOM_MAX, WRITTEN};
use plcc_abi::{RuntimeFn, Type};
use plcc_ir::{BinaryOp, Value};
use plcc_model::{Actual, Argument, Body, CodeBlock, Direction, Passing, Place, StlStatementKind, Width};

use super::big_endian;
use super::text_operand::{HEAD_BYTES, TextOperand};
use super::text_short::writes_text;
use crate::block::BlockLowering;
use crate::place;
use crate::plan::Plan;

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

/// The result of a function of texts.
#[derive(Clone, Copy)]
pub struct TextResult {
    /// An i32.
    pub value: Value,
    /// There is a value, an i1; without it the variable for the value stays as it is.
    pub written: Value,
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

    /// The maximum of the text at `place` as the data block has it when it is loaded; 0 if it is not known. Short ways check that it is still
    /// so.
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
