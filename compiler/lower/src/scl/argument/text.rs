//! Calls from SCL of functions of texts, see [`crate::call::text_call`].

use plcc_abi::RuntimeFn;
use plcc_ir::{Address, Block, Region, Type, Value};
use plcc_model::scl::walk::{self, Role, Visitor};
use plcc_model::scl::{Access, Actual, Base, Call, Complex, Expr, ExprKind};
use plcc_model::{CodeBlock, Passing, Place, Width};

use super::{Back, Given, Source, Supply};
use crate::block::BlockLowering;
use crate::call::{FormalText, TextCall, TextInput, TextOperand, TextResult, text_call};
use crate::place::Direction;
use crate::scl::located::Located;
use crate::scl::text::TEXT_MAX;

/// The calls of a function that joins two texts, the innermost first, if each but the outermost is the first text of the next one: what they get can
/// be evaluated twice.
pub fn chain<'m>(text: &TextCall, call: &'m Call) -> Vec<&'m Call> {
    let mut calls = vec![call];
    while let Some(inner) = calls.last().and_then(|call| joined_call(text, call)) {
        calls.push(inner);
    }
    calls.reverse();
    let is_plain = |(at, call): (usize, &&Call)| {
        call.arguments.iter().all(|argument| match &argument.actual {
            Actual::Complex(Complex::Variable(access)) | Actual::Reference(access) => {
                access.indices.iter().all(|index| is_plain_index(&index.value))
            }
            Actual::Complex(Complex::Const(_)) => true,
            // The call before it.
            Actual::Complex(Complex::Call(_)) => at > 0,
            _ => false,
        })
    };
    if calls.iter().enumerate().all(is_plain) { calls } else { Vec::new() }
}

fn is_plain_index(index: &Expr) -> bool {
    match &index.kind {
        ExprKind::Const(_) => true,
        ExprKind::Load(access) => access.indices.is_empty(),
        ExprKind::Convert { operand, .. } => {
            matches!(&operand.kind, ExprKind::Load(access) if access.indices.is_empty())
        }
        _ => false,
    }
}

/// The arguments of a function of texts.
pub struct TextArguments {
    function: RuntimeFn,
    texts: Vec<TextOperand>,
    /// For each input, the value if it is not a text.
    values: Vec<Option<Value>>,
}

/// How texts are found.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// By their pointers, as the runtime wants to know them.
    Pointers,
    /// Those that exist as a whole, since this block was given them so, as they are. Only for functions that are done without a call.
    Heads,
}

/// A call of a function of texts.
#[derive(Clone, Copy)]
pub struct TextSite<'a, 'm> {
    pub text: &'a TextCall,
    pub call: &'m Call,
    pub callee: &'a CodeBlock,
    /// Where the result goes if the call does not say it.
    pub room: Option<Address>,
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

/// Whether a value contains a call.
pub(super) fn value_calls_something(value: &Expr) -> bool {
    let mut calls = Calls::default();
    walk::expr(value, &mut calls);
    calls.0
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
    /// The arguments of a call, which was given `given`, and whether the addresses are right, an i1. `None`: the block is called.
    pub fn text_arguments(&mut self, site: TextSite, given: &[Given], look: Look) -> Option<(TextArguments, Value)> {
        let TextSite { text, call, callee, room } = site;
        let mut arguments = TextArguments { function: text.function, texts: Vec::new(), values: Vec::new() };
        for input in &text.inputs {
            let value = match input {
                TextInput::Text(parameter) => {
                    arguments.texts.push(self.text_given(call, given, *parameter, look)?);
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
            arguments.texts.push(self.text_written(given, parameter, room, look)?);
        }
        let known = self.texts_are_known(&arguments.texts);
        Some((arguments, known))
    }

    /// The arguments of the function that does `calls`, which join two texts each, the first one the innermost, with what each was given; the last
    /// one is that of `site`. With them, whether the addresses are right, an i1.
    pub fn joined_arguments(
        &mut self,
        site: TextSite,
        calls: &[(&Call, &[Given])],
        look: Look,
    ) -> Option<(TextArguments, Value)> {
        let [TextInput::Text(first), TextInput::Text(second)] = site.text.inputs[..] else { return None };
        let ((innermost, innermost_given), (_, given)) = (calls.first()?, calls.last()?);
        let mut texts = vec![self.text_given(innermost, innermost_given, first, look)?];
        for (call, given) in calls {
            texts.push(self.text_given(call, given, second, look)?);
        }
        texts.push(self.text_written(given, site.text.out?, site.room, look)?);
        let known = self.texts_are_known(&texts);
        let values = vec![None; texts.len() - 1];
        Some((TextArguments { function: RuntimeFn::TextConcatThree, texts, values }, known))
    }

    /// The text that parameter `parameter` was given.
    fn text_given(&mut self, call: &Call, given: &[Given], parameter: usize, look: Look) -> Option<TextOperand> {
        let Supply::Complex(source) = &find(given, parameter)?.supply else { return None };
        match source {
            Source::Variable { access, located } => self.located_text(access, located, Direction::Read, look),
            Source::Frame(addr) => {
                let actual = &call.arguments.iter().find(|argument| argument.parameter == parameter)?.actual;
                match actual {
                    Actual::Complex(Complex::Const(bytes)) => self.constant_text(*addr, bytes),
                    Actual::Complex(Complex::Character(_)) => Some(self.text_in_frame(*addr, 1)),
                    Actual::Complex(Complex::Call(call)) => {
                        let longest = self.longest_result(call);
                        Some(self.text_in_frame(*addr, TEXT_MAX as u8).with_longest(longest))
                    }
                    _ => Some(self.text_in_frame(*addr, TEXT_MAX as u8)),
                }
            }
        }
    }

    /// The most characters that the result of a call has, if that is known: a number as text.
    fn longest_result(&self, call: &Call) -> Option<u32> {
        let (callee, _) = self.plan.block(call.target)?;
        let text = text_call(self.plan, callee).filter(|text| text.function == RuntimeFn::TextOfDint)?;
        let Some(TextInput::Value(number)) = text.inputs.first() else { return None };
        let is_word = callee.interface.parameters[*number].passing == Passing::Elementary(Width::Word);
        Some(if is_word { "-32768".len() } else { "-2147483648".len() } as u32)
    }

    /// The text that is written: the variable of parameter `parameter`, or `room`.
    fn text_written(
        &mut self,
        given: &[Given],
        parameter: usize,
        room: Option<Address>,
        look: Look,
    ) -> Option<TextOperand> {
        match (find(given, parameter), room) {
            (Some(Given { back: Some(Back { access, located: Some(located), .. }), .. }), _) => {
                self.located_text(access, located, Direction::Write, look)
            }
            (None, Some(room)) => Some(self.text_in_frame(room, TEXT_MAX as u8)),
            _ => None,
        }
    }

    fn located_text(
        &mut self,
        access: &Access,
        located: &Located,
        direction: Direction,
        look: Look,
    ) -> Option<TextOperand> {
        let declared = self.text_limit(access);
        let declared = if declared <= TEXT_MAX { declared as u8 } else { 0 };
        if look == Look::Heads
            && declared != 0
            && let Some((addr, ok)) = self.whole_place(access, located, direction)
        {
            return Some(self.whole_text(addr, declared, ok));
        }
        let (addr, checks) = self.located_address(located, direction);
        if let Some(formal) = self.formal_text_of(access)
            && checks.is_empty()
            && (direction == Direction::Read || self.plan.protected_dbs.is_empty() || formal.is_room())
        {
            return Some(self.formal_text(addr, formal));
        }
        self.text_in_memory(addr, declared, &checks, direction, |lowering| lowering.located_pointer(located))
    }

    /// What is known of a text that is a formal parameter of this function.
    pub fn formal_text_of(&self, access: &Access) -> Option<FormalText> {
        match &access.base {
            Base::Place(Place::Parameter { parameter, byte: 0, bit: 0 }) if access.indices.is_empty() => {
                self.formal_texts.get(parameter).copied()
            }
            _ => None,
        }
    }

    /// Where a variable is if the i1 is true, in what this block was given by a caller who has seen that it exists as a whole.
    fn whole_place(&mut self, access: &Access, located: &Located, direction: Direction) -> Option<(Address, Value)> {
        match &access.base {
            Base::Place(place @ Place::ThroughPointer { .. }) if access.indices.is_empty() => {
                self.referenced(place, direction)
            }
            Base::Place(Place::Parameter { .. } | Place::Instance { .. })
                if direction == Direction::Read || self.plan.protected_dbs.is_empty() =>
            {
                let (addr, checks) = self.located_address(located, direction);
                if !matches!(addr.region, Region::Any | Region::AnyDb) {
                    return None;
                }
                let mut ok = self.b.bool_const(true);
                for check in checks {
                    ok = self.b.and(ok, check.ok);
                }
                Some((addr, ok))
            }
            _ => None,
        }
    }

    /// Whether a function is given a text by [`Look::Heads`] that is not known by its pointer alone.
    pub fn has_whole_text(&self, arguments: &TextArguments) -> bool {
        arguments.texts.iter().any(|text| text.is_whole)
    }

    /// Whether the code of the caller can do a function.
    pub fn does_text_call(&self, arguments: &TextArguments) -> bool {
        self.has_short_way(arguments.function, &arguments.texts, &arguments.values)
    }

    /// Does a function without a call, or goes to `leave`. Returns its value as [`run_text_call`](Self::run_text_call) does.
    pub fn do_text_call(
        &mut self,
        site: TextSite,
        arguments: &TextArguments,
        given: &[Given],
        leave: Block,
    ) -> Option<Value> {
        let result = self.run_text_or_leave(arguments.function, &arguments.texts, &arguments.values, leave);
        self.text_value(site, given, result)
    }

    /// The value of an integer formal as an i32.
    fn signed(&mut self, callee: &CodeBlock, parameter: usize, value: Value) -> Value {
        match callee.interface.parameters[parameter].passing {
            Passing::Elementary(Width::Word) => self.sign_extended(value),
            _ => value,
        }
    }

    /// Calls the function. Returns its value if the call does not say where that goes, as memory has it.
    pub fn run_text_call(&mut self, site: TextSite, arguments: &TextArguments, given: &[Given]) -> Option<Value> {
        let TextArguments { function, texts, values } = arguments;
        let result = self.run_text_shortly(*function, site.callee, texts, values);
        self.text_value(site, given, result)
    }

    /// Puts the value in the `result` of a function where the call says it goes, or returns it.
    fn text_value(&mut self, site: TextSite, given: &[Given], result: TextResult) -> Option<Value> {
        let (parameter, keeps) = site.text.value?;
        let formal = &site.callee.interface.parameters[parameter];
        let is_bit = formal.passing == Passing::Elementary(Width::Bit);
        let TextResult { value, written } = result;
        let value = if is_bit { self.b.trunc(Type::I1, value) } else { value };
        let Some(back) = find(given, parameter).and_then(|given| given.back.as_ref()) else { return Some(value) };
        if !keeps {
            self.write_formal(formal, back, value);
            return None;
        }
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
        self.run_text_shortly(arguments.function, callee, &arguments.texts, &arguments.values).written
    }
}

fn find<'g, 'm>(given: &'g [Given<'m>], parameter: usize) -> Option<&'g Given<'m>> {
    given.iter().find(|given| given.parameter == parameter)
}
