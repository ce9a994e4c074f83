//! Calls from SCL of functions of texts, see [`crate::call::text_call`].

use plcc_abi::RuntimeFn;
use plcc_abi::text::WRITTEN;
use plcc_ir::{Address, Type, Value};
use plcc_model::scl::walk::{self, Role, Visitor};
use plcc_model::scl::{Access, Actual, Call, Complex};
use plcc_model::{CodeBlock, Passing, Width};

use super::{Back, Given, Source, Supply};
use crate::block::BlockLowering;
use crate::call::{TextCall, TextInput, TextOperand};
use crate::place::Direction;
use crate::scl::access::Located;
use crate::scl::text::TEXT_MAX;

/// The arguments of a function of texts.
pub struct TextArguments {
    function: RuntimeFn,
    texts: Vec<TextOperand>,
    /// For each input, the value if it is not a text.
    values: Vec<Option<Value>>,
}

/// Looks for calls.
#[derive(Default)]
struct Calls(bool);

impl Visitor for Calls {
    fn call(&mut self, _call: &Call) {
        self.0 = true;
    }
}

fn calls_nothing(access: &Access) -> bool {
    let mut calls = Calls::default();
    walk::access(access, Role::Memory, &mut calls);
    !calls.0
}

/// The inner call of one that joins two texts, if one function can join all three.
///
/// The outer call finds out where its other texts are after the inner call has run; nothing may change on the way.
pub fn joined_call<'m>(text: &TextCall, call: &'m Call) -> Option<&'m Call> {
    let [TextInput::Text(first), TextInput::Text(_)] = text.inputs[..] else { return None };
    if text.function != RuntimeFn::TextConcat {
        return None;
    }
    let mut inner = None;
    for argument in &call.arguments {
        match &argument.actual {
            Actual::Complex(Complex::Call(call)) if argument.parameter == first => inner = Some(call),
            Actual::Complex(Complex::Const(_)) => {}
            Actual::Complex(Complex::Variable(access)) | Actual::Reference(access) if calls_nothing(access) => {}
            _ => return None,
        }
    }
    inner
        .map(|inner| &**inner)
        .filter(|inner| inner.target == call.target && inner.enable.is_none() && inner.eno.is_none())
}

impl BlockLowering<'_, '_> {
    /// The arguments of `text` in `call`, which was given `given`, and whether the addresses are right, an i1; `room`: where the result goes if the
    /// call does not say it. `None`: the block is called.
    pub fn text_arguments(
        &mut self,
        text: &TextCall,
        call: &Call,
        callee: &CodeBlock,
        given: &[Given],
        room: Option<Address>,
    ) -> Option<(TextArguments, Value)> {
        let mut arguments = TextArguments { function: text.function, texts: Vec::new(), values: Vec::new() };
        for input in &text.inputs {
            let value = match input {
                TextInput::Text(parameter) => {
                    arguments.texts.push(self.text_given(call, given, *parameter)?);
                    None
                }
                TextInput::Value(parameter) => {
                    let Supply::Value(value) = find(given, *parameter)?.supply else { return None };
                    Some(self.signed(callee, *parameter, value))
                }
                TextInput::Const(value) => Some(self.b.i32_const(*value)),
            };
            arguments.values.push(value);
        }
        if let Some(parameter) = text.out {
            arguments.texts.push(self.text_written(given, parameter, room)?);
        }
        let known = self.texts_are_known(&arguments.texts);
        Some((arguments, known))
    }

    /// The arguments of the function that does `inner` and `call`, which join two texts each, if nothing about them is decided at run time.
    pub fn joined_arguments(
        &mut self,
        text: &TextCall,
        (inner, inner_given): (&Call, &[Given]),
        (call, given): (&Call, &[Given]),
        room: Option<Address>,
    ) -> Option<TextArguments> {
        let [TextInput::Text(first), TextInput::Text(second)] = text.inputs[..] else { return None };
        let texts = vec![
            self.text_given(inner, inner_given, first)?,
            self.text_given(inner, inner_given, second)?,
            self.text_given(call, given, second)?,
            self.text_written(given, text.out?, room)?,
        ];
        let known = self.texts_are_known(&texts);
        let arguments = TextArguments { function: RuntimeFn::TextConcatThree, texts, values: vec![None; 3] };
        (self.b.constant_bits(known) == Some(1)).then_some(arguments)
    }

    /// The text that parameter `parameter` was given.
    fn text_given(&mut self, call: &Call, given: &[Given], parameter: usize) -> Option<TextOperand> {
        let Supply::Complex(source) = &find(given, parameter)?.supply else { return None };
        match source {
            Source::Variable { access, located } => self.located_text(access, located, Direction::Read),
            Source::Frame(addr) => {
                let actual = &call.arguments.iter().find(|argument| argument.parameter == parameter)?.actual;
                match actual {
                    Actual::Complex(Complex::Const(bytes)) => self.constant_text(*addr, bytes),
                    Actual::Complex(Complex::Character(_)) => Some(self.text_in_frame(*addr, 1)),
                    _ => Some(self.text_in_frame(*addr, TEXT_MAX as u8)),
                }
            }
        }
    }

    /// The text that is written: the variable of parameter `parameter`, or `room`.
    fn text_written(&mut self, given: &[Given], parameter: usize, room: Option<Address>) -> Option<TextOperand> {
        match (find(given, parameter), room) {
            (Some(Given { back: Some(Back { access, located: Some(located), .. }), .. }), _) => {
                self.located_text(access, located, Direction::Write)
            }
            (None, Some(room)) => Some(self.text_in_frame(room, TEXT_MAX as u8)),
            _ => None,
        }
    }

    fn located_text(&mut self, access: &Access, located: &Located, direction: Direction) -> Option<TextOperand> {
        let (addr, checks) = self.located_address(located, direction);
        let declared = self.text_limit(access);
        let declared = if declared <= TEXT_MAX { declared as u8 } else { 0 };
        self.text_in_memory(addr, declared, &checks, direction, |lowering| lowering.located_pointer(located))
    }

    /// The value of an integer formal as an i32.
    fn signed(&mut self, callee: &CodeBlock, parameter: usize, value: Value) -> Value {
        match callee.interface.parameters[parameter].passing {
            Passing::Elementary(Width::Word) => self.sign_extended(value),
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
        let result = self.run_text_shortly(arguments.function, callee, &arguments.texts, &arguments.values);
        let (parameter, keeps) = text.value?;
        let formal = &callee.interface.parameters[parameter];
        let is_bit = formal.passing == Passing::Elementary(Width::Bit);
        let value = self.b.trunc(if is_bit { Type::I1 } else { Type::I32 }, result);
        let Some(back) = find(given, parameter).and_then(|given| given.back.as_ref()) else { return Some(value) };
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
    /// Calls the function that joins three texts. The result is BR of the inner call.
    pub fn run_joined_call(&mut self, callee: &CodeBlock, arguments: &TextArguments) -> Value {
        let result = self.run_text_shortly(arguments.function, callee, &arguments.texts, &arguments.values);
        self.bit_of(result, WRITTEN)
    }
}

fn find<'g, 'm>(given: &'g [Given<'m>], parameter: usize) -> Option<&'g Given<'m>> {
    given.iter().find(|given| given.parameter == parameter)
}
