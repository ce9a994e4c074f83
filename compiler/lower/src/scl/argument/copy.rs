//! Parameters of instances and in structures of system functions: copies.

use plcc_ir::{Address, Type, Value};
use plcc_model::scl::{Actual, Call, Complex};
use plcc_model::types::DataType;
use plcc_model::{CodeBlock, Direction, Parameter, Passing, Width};

use super::text::value_calls_something;
use super::{Back, Given, Source, Supply};
use crate::block::BlockLowering;
use crate::fault::Substitute;
use crate::place::{self, BitNumber, Target};
use crate::pointer::moved;
use crate::scl::text::{OWN_MAXIMUM, Text, TextPlace};

impl BlockLowering<'_, '_> {
    /// Evaluates the arguments of a call of the instance at `base`; `None`: where it is, or whether it exists, is known when the program runs. A
    /// structure at an input before an argument that calls something, which may change the structure, is copied in its turn: to the instance, and
    /// then it is not among the results, or to the frame.
    pub fn given_to_instance<'m>(
        &mut self,
        base: Option<Address>,
        call: &'m Call,
        callee: &CodeBlock,
    ) -> Vec<Given<'m>> {
        let last_call = call.arguments.iter().rposition(|argument| calls_something(&argument.actual));
        let mut all = Vec::new();
        for (at, argument) in call.arguments.iter().enumerate() {
            let parameter = &callee.interface.parameters[argument.parameter];
            let given = self.give(parameter, argument);
            let is_copied = parameter.direction == Direction::Input
                && matches!(parameter.passing, Passing::Complex { .. })
                && matches!(given.supply, Supply::Complex(Source::Variable { .. }));
            if !is_copied || last_call.is_none_or(|last| at >= last) {
                all.push(given);
            } else if let Some(base) = base {
                self.fill(base, callee, &given, false);
            } else {
                all.push(self.copied_to_frame(parameter, given));
            }
        }
        all
    }

    /// The value that a structure at an input has now.
    fn copied_to_frame<'m>(&mut self, parameter: &Parameter, given: Given<'m>) -> Given<'m> {
        let (Supply::Complex(source), Passing::Complex { bytes }) = (&given.supply, parameter.passing) else {
            return given;
        };
        let copy = self.temporary(bytes);
        self.b.clear(copy, bytes);
        self.prepare_text(copy, &parameter.ty);
        self.copy_source(copy, &parameter.ty, source, bytes);
        Given { supply: Supply::Complex(Source::Frame(copy)), ..given }
    }

    /// Writes the input to the formal's place, relative to `base`. For a system function, all complex values are copies.
    pub fn fill(&mut self, base: Address, callee: &CodeBlock, given: &Given, system: bool) {
        let parameter = &callee.interface.parameters[given.parameter];
        let addr = moved(base, parameter.byte);
        match (&given.supply, parameter.passing) {
            (Supply::Nothing, Passing::Complex { bytes }) if system && given.back.is_some() => {
                self.b.clear(addr, bytes);
                self.prepare_text(addr, &parameter.ty);
            }
            (Supply::Nothing, _) => {}
            (Supply::Value(value), Passing::Elementary(width)) => {
                let bit = BitNumber::of(callee, parameter.byte, parameter.bit);
                self.write_target(Target::at(addr, bit), width, *value);
            }
            (Supply::Number(value), _) => self.store_low(addr, Width::Word, *value),
            (Supply::Pointer(source), passing) => self.store_pointer_source(addr, source, passing != Passing::Pointer),
            (Supply::Complex(source), Passing::Complex { .. })
                if parameter.direction == Direction::InOut && !system =>
            {
                let (fields, _) = self.complex_reference(source);
                self.store_pointer_fields(addr, fields);
            }
            (Supply::Complex(source), Passing::Complex { bytes }) => {
                self.prepare_text(addr, &parameter.ty);
                self.copy_source(addr, &parameter.ty, source, bytes);
            }
            (Supply::Complex(Source::Variable { access, located }), Passing::OpenArray { dimensions }) => {
                let fields = self.checked_pointer(located);
                self.store_pointer_fields(addr, fields);
                for dimension in 0..dimensions {
                    let (low, high) = self.bounds_of(access, dimension);
                    let at = 6 + 8 * u32::from(dimension);
                    self.store_low(moved(addr, at), Width::Dword, low);
                    self.store_low(moved(addr, at + 4), Width::Dword, high);
                }
            }
            (Supply::Value(_) | Supply::Complex(_), _) => {
                unreachable!("the binder gives each formal an actual of its kind")
            }
        }
    }

    fn prepare_text(&mut self, addr: Address, ty: &DataType) {
        match ty {
            DataType::String(maximum) => {
                let head = self.b.i32_const(u32::from(*maximum) << 8);
                self.store_low(addr, Width::Word, head);
            }
            DataType::WideString(maximum) => {
                let head = self.b.i32_const(u32::from(*maximum) << 16);
                self.store_low(addr, Width::Dword, head);
            }
            _ => {}
        }
    }

    fn copy_source(&mut self, addr: Address, ty: &DataType, source: &Source, bytes: u32) {
        let (from, checks) = match source {
            Source::Variable { access, located } => {
                let (from, checks) = self.located_address(located, place::Direction::Read);
                (self.text_place(access, from), checks)
            }
            Source::Frame(addr) => (TextPlace { addr: *addr, maximum: OWN_MAXIMUM, formal: None }, Vec::new()),
        };
        let guard = self.begin_guard(checks, Substitute::None);
        match (Text::of(ty), ty) {
            (Some(kind), DataType::String(maximum)) => {
                self.copy_text(TextPlace { addr, maximum: u32::from(*maximum), formal: None }, from, kind);
            }
            (Some(kind), DataType::WideString(maximum)) => {
                self.copy_text(TextPlace { addr, maximum: u32::from(*maximum), formal: None }, from, kind);
            }
            _ => self.b.copy(addr, from.addr, bytes),
        }
        self.end_guard(guard);
    }

    /// Copies the formal's value from its place, relative to `base`, to the actual.
    pub fn take(&mut self, base: Address, parameter: &Parameter, back: &Back) {
        let addr = moved(base, parameter.byte);
        match (parameter.passing, &parameter.ty) {
            (Passing::Elementary(width), _) => {
                let target = Target::at(addr, BitNumber::Known(parameter.bit));
                let value = self.read_target(target, width);
                self.write_formal(parameter, back, value);
            }
            (Passing::Complex { bytes }, ty) => {
                let Some(located) = &back.located else { return };
                let (to, checks) = self.located_address(located, place::Direction::Write);
                let guard = self.begin_guard(checks, Substitute::None);
                let declared = match ty {
                    DataType::String(maximum) => u32::from(*maximum),
                    _ => OWN_MAXIMUM,
                };
                match Text::of(ty) {
                    Some(kind) => {
                        let from = TextPlace { addr, maximum: declared, formal: None };
                        self.copy_text(self.text_place(back.access, to), from, kind);
                    }
                    None => self.b.copy(to, addr, bytes),
                }
                self.end_guard(guard);
            }
            _ => {}
        }
    }

    /// Copies back the value that an FC left in a temporary.
    pub fn take_temporary(&mut self, parameter: &Parameter, back: &Back, temporary: Address) {
        let Passing::Elementary(width) = parameter.passing else { return };
        let value = self.read_target(Target::at(temporary, BitNumber::Known(0)), width);
        self.write_formal(parameter, back, value);
    }

    /// Writes the value of an elementary formal, as memory has it, to its actual.
    pub(super) fn write_formal(&mut self, parameter: &Parameter, back: &Back, value: Value) {
        let DataType::Elementary(formal) = parameter.ty else { return };
        let Some(actual) = back.access.elementary() else { return };
        let value = self.typed(value, formal);
        let value = match back.conversion {
            Some(conversion) => self.convert(conversion, value, formal, actual),
            None => {
                // The widths are the same, so the bits are the value.
                let bits = self.as_bits(value);
                match crate::scl::value_type(actual) {
                    float @ (Type::F32 | Type::F64) => self.b.bitcast(float, bits),
                    _ => bits,
                }
            }
        };
        match &back.located {
            Some(located) => self.write_located(back.access, located, value),
            None => self.write_access(back.access, value),
        }
    }
}

/// Whether an argument that is a value contains a call.
fn calls_something(actual: &Actual) -> bool {
    actual.value().is_some_and(value_calls_something) || matches!(actual.complex(), Some(Complex::Call(_)))
}
