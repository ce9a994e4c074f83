//! Calls from SCL of functions of texts, see [`crate::call::text_call`].

use plcc_abi::text::WRITTEN;
use plcc_ir::{Address, Type, Value};
use plcc_model::{CodeBlock, Passing, Width};

use super::{Back, Given, Source, Supply};
use crate::block::BlockLowering;
use crate::call::{TextCall, TextInput, TextOperand};
use crate::place::Direction;
use crate::scl::access::Located;

/// The arguments of a function of texts.
pub struct TextArguments {
    texts: Vec<TextOperand>,
    /// For each input, the value if it is not a text.
    values: Vec<Option<Value>>,
}

impl BlockLowering<'_, '_> {
    /// The arguments of `text` in a call that was given `given`, and whether the addresses are right, an i1; `room`: where the result goes if the call does
    /// not say it. `None`: the block is called.
    pub fn text_arguments(
        &mut self,
        text: &TextCall,
        callee: &CodeBlock,
        given: &[Given],
        room: Option<Address>,
    ) -> Option<(TextArguments, Value)> {
        let find = |parameter: usize| given.iter().find(|given| given.parameter == parameter);
        let mut arguments = TextArguments { texts: Vec::new(), values: Vec::new() };
        for input in &text.inputs {
            let value = match input {
                TextInput::Text(parameter) => {
                    let Supply::Complex(source) = &find(*parameter)?.supply else { return None };
                    let operand = match source {
                        Source::Variable { located, .. } => self.located_text(located, Direction::Read)?,
                        Source::Frame(addr) => self.text_in_frame(*addr),
                    };
                    arguments.texts.push(operand);
                    None
                }
                TextInput::Value(parameter) => {
                    let Supply::Value(value) = find(*parameter)?.supply else { return None };
                    Some(self.signed(callee, *parameter, value))
                }
                TextInput::Const(value) => Some(self.b.i32_const(*value)),
            };
            arguments.values.push(value);
        }
        if let Some(parameter) = text.out {
            let operand = match (find(parameter), room) {
                (Some(Given { back: Some(Back { located: Some(located), .. }), .. }), _) => {
                    self.located_text(located, Direction::Write)?
                }
                (None, Some(room)) => self.text_in_frame(room),
                _ => return None,
            };
            arguments.texts.push(operand);
        }
        let known = self.texts_are_known(&arguments.texts);
        Some((arguments, known))
    }

    fn located_text(&mut self, located: &Located, direction: Direction) -> Option<TextOperand> {
        let (addr, checks) = self.located_address(located, direction);
        self.text_in_memory(addr, &checks, direction, |lowering| lowering.located_pointer(located))
    }

    /// The value of an integer formal as an i32.
    fn signed(&mut self, callee: &CodeBlock, parameter: usize, value: Value) -> Value {
        match callee.interface.parameters[parameter].passing {
            Passing::Elementary(Width::Word) => {
                let word = self.b.trunc(Type::I16, value);
                self.b.sext(Type::I32, word)
            }
            _ => value,
        }
    }

    /// Calls the function. Returns its value if the call does not say where that goes, as memory has it.
    pub fn run_text_call(
        &mut self,
        text: &TextCall,
        callee: &CodeBlock,
        arguments: &TextArguments,
        given: &[Given],
    ) -> Option<Value> {
        let result = self.run_text(text, callee, &arguments.texts, &arguments.values);
        let (parameter, keeps) = text.value?;
        let formal = &callee.interface.parameters[parameter];
        let is_bit = formal.passing == Passing::Elementary(Width::Bit);
        let value = self.b.trunc(if is_bit { Type::I1 } else { Type::I32 }, result);
        let Some(back) = given.iter().find(|given| given.parameter == parameter).and_then(|given| given.back.as_ref())
        else {
            return Some(value);
        };
        if !keeps {
            self.write_formal(formal, back, value);
            return None;
        }
        let written = self.bit_of(result, WRITTEN);
        let (write, after) = (self.b.create_block(), self.b.create_block());
        self.b.branch(written, write, after);
        self.b.seal_block(write);
        self.b.switch_to(write);
        self.write_formal(formal, back, value);
        self.b.jump(after, &[]);
        self.b.seal_block(after);
        self.b.switch_to(after);
        None
    }
}
