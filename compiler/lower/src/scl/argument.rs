//! Actual parameters of calls from SCL: evaluated first, from left to right, then passed. Source: SCL reference, parameters.

use plcc_ir::{Address, BinaryOp, IntCc, Type, Value};
use plcc_model::layout;
use plcc_model::scl::{Access, Actual, Argument, Base, Complex, Conversion, ExprKind};
use plcc_model::types::DataType;
use plcc_model::{Direction, Parameter, Passing, Place, Pointed, Width};

use super::access::Located;
use super::text::{Text, text_limit};
use crate::block::BlockLowering;
use crate::call::has_area_pointer;
use crate::fault::Substitute;
use crate::place::{self, BitNumber, Target};
use crate::pointer::{ANY_HEAD_BYTES, PointerFields, moved};

/// An argument with evaluated expressions.
pub struct Given<'m> {
    pub parameter: usize,
    pub supply: Supply<'m>,
    /// Where the formal's value goes after the call.
    pub back: Option<Back<'m>>,
}

/// The input.
pub enum Supply<'m> {
    Nothing,
    /// Elementary, in the form for memory.
    Value(Value),
    Complex(Source<'m>),
    /// A number of a timer, counter or block, an i32.
    Number(Value),
    Pointer(PointerSource<'m>),
}

/// A complex value in memory.
pub enum Source<'m> {
    Variable {
        access: &'m Access,
        located: Located<'m>,
    },
    /// In the frame.
    Frame(Address),
}

/// A POINTER or ANY.
pub enum PointerSource<'m> {
    Bytes(&'m [u8]),
    Fields {
        head: u32,
        fields: PointerFields,
    },
    /// An ARRAY[*]: its number of elements, an i32, and how many units of the ANY's type each of them is.
    Counted {
        type_code: u8,
        elements: Value,
        each: u16,
        fields: PointerFields,
    },
    Copy(Located<'m>),
    Variant(Box<PointerSource<'m>>, Pointed),
}

/// A variable that a result goes to.
pub struct Back<'m> {
    pub access: &'m Access,
    /// None: the variable is not in memory.
    pub located: Option<Located<'m>>,
    pub conversion: Option<Conversion>,
}

/// The place of the variable of an elementary actual, if it is known before the program runs.
pub fn place_of(actual: &Actual) -> Option<&Place> {
    let access = match actual {
        Actual::Value(value) => match &value.kind {
            ExprKind::Load(access) => access,
            _ => return None,
        },
        Actual::Variable { access, .. } => access,
        _ => return None,
    };
    match &access.base {
        Base::Place(place) if access.indices.is_empty() && access.part.is_none() => Some(place),
        Base::Place(_) | Base::Indexed { .. } => None,
    }
}

impl BlockLowering<'_, '_> {
    /// Evaluates an argument.
    pub fn give<'m>(&mut self, parameter: &Parameter, argument: &'m Argument) -> Given<'m> {
        let given = |supply, back| Given { parameter: argument.parameter, supply, back };
        match &argument.actual {
            Actual::Value(value) => {
                let ty = value.ty;
                let value = self.value(value);
                let value = self.untyped(value, ty);
                given(Supply::Value(value), None)
            }
            Actual::Variable { access, back } => {
                let located = (!self.is_promoted(access)).then(|| self.locate(access));
                let back = Back { access, located, conversion: *back };
                let supply = if parameter.direction == Direction::InOut {
                    let value = self.read_back(&back);
                    let ty = access.elementary().expect("the binder gives elementary formals elementary variables");
                    Supply::Value(self.untyped(value, ty))
                } else {
                    Supply::Nothing
                };
                given(supply, Some(back))
            }
            Actual::Complex(value) => given(Supply::Complex(self.source(value)), None),
            Actual::Reference(access) => {
                let located = self.locate(access);
                if parameter.direction == Direction::Output {
                    let back = Back { access, located: Some(located), conversion: None };
                    return given(Supply::Nothing, Some(back));
                }
                given(Supply::Complex(Source::Variable { access, located }), None)
            }
            Actual::Number(number) => given(Supply::Number(self.number(number)), None),
            Actual::Dropped => given(Supply::Nothing, None),
            Actual::PointerBytes(_)
            | Actual::PointerTo { .. }
            | Actual::PointerCopy(_)
            | Actual::PointerToValue { .. }
            | Actual::PointerToComplex { .. }
            | Actual::Variant(..) => given(Supply::Pointer(self.pointer_source(&argument.actual)), None),
        }
    }

    fn source<'m>(&mut self, value: &'m Complex) -> Source<'m> {
        match value {
            Complex::Variable(access) => Source::Variable { access, located: self.locate(access) },
            _ => Source::Frame(self.complex_value(value)),
        }
    }

    fn pointer_source<'m>(&mut self, actual: &'m Actual) -> PointerSource<'m> {
        let head = |type_code: u8, count: u16| 0x10 << 24 | u32::from(type_code) << 16 | u32::from(count);
        match actual {
            Actual::PointerBytes(bytes) => PointerSource::Bytes(bytes),
            Actual::PointerTo { access, type_code, count } if matches!(access.ty, DataType::OpenArray(_)) => {
                let located = self.locate(access);
                let fields = self.located_pointer(&located);
                let elements = self.elements_of(access);
                PointerSource::Counted { type_code: *type_code, elements, each: *count, fields }
            }
            Actual::PointerTo { access, type_code, count } => {
                let fields = match self.elementary_formal(access) {
                    Some(width) => self.pointer_to_copy(access, width),
                    None => {
                        let located = self.locate(access);
                        self.located_pointer(&located)
                    }
                };
                PointerSource::Fields { head: head(*type_code, *count), fields }
            }
            Actual::PointerCopy(access) => PointerSource::Copy(self.locate(access)),
            Actual::PointerToValue { value, type_code } => {
                let ty = value.ty;
                let value = self.value(value);
                let value = self.untyped(value, ty);
                let width = layout::width(ty);
                let temporary = self.temporary(width.bytes());
                self.write_target(Target::at(temporary, BitNumber::Known(0)), width, value);
                let fields = self.pointer_fields(&Place::L { byte: temporary.offset, bit: 0 });
                PointerSource::Fields { head: head(*type_code, 1), fields }
            }
            Actual::PointerToComplex { value, type_code, count } => {
                let fields = match self.source(value) {
                    Source::Variable { located, .. } => self.located_pointer(&located),
                    Source::Frame(addr) => self.pointer_fields(&Place::L { byte: addr.offset, bit: 0 }),
                };
                PointerSource::Fields { head: head(*type_code, *count), fields }
            }
            Actual::Variant(any, pointed) => PointerSource::Variant(Box::new(self.pointer_source(any)), *pointed),
            _ => unreachable!("only used for pointers"),
        }
    }

    /// The width of the access if it is one of a whole elementary formal of this FC. The FC knows the address of the actual in
    /// memory, but has no POINTER to it.
    fn elementary_formal(&self, access: &Access) -> Option<Width> {
        match access.base {
            Base::Place(Place::Parameter { parameter, .. }) => match self.passing(parameter) {
                Passing::Elementary(width) => Some(width),
                Passing::Complex { .. }
                | Passing::Number
                | Passing::Pointer
                | Passing::Any
                | Passing::Variant
                | Passing::OpenArray { .. } => None,
            },
            _ => None,
        }
    }

    /// A pointer to a copy in this frame, which is copied back after the call.
    fn pointer_to_copy(&mut self, access: &Access, width: Width) -> PointerFields {
        let ty = access.elementary().expect("an elementary formal has an elementary type");
        let value = self.read_access(access);
        let value = self.untyped(value, ty);
        let copy = self.temporary(width.bytes());
        self.write_target(Target::at(copy, BitNumber::Known(0)), width, value);
        self.scl.pointed_copies.push((access.clone(), copy));
        self.pointer_fields(&Place::L { byte: copy.offset, bit: 0 })
    }

    /// Copies back the copies that pointers of a call pointed at: those that were made after the first `before`.
    pub fn take_pointed_copies(&mut self, before: usize) {
        for (access, copy) in self.scl.pointed_copies.split_off(before) {
            let ty = access.elementary().expect("an elementary formal has an elementary type");
            let value = self.read_target(Target::at(copy, BitNumber::Known(0)), layout::width(ty));
            let value = self.typed(value, ty);
            self.write_access(&access, value);
        }
    }

    fn store_pointer_source(&mut self, addr: Address, source: &PointerSource, any: bool) {
        match source {
            PointerSource::Bytes(bytes) => self.store_bytes(addr, bytes),
            PointerSource::Fields { head, fields } if any => {
                let head = self.b.i32_const(*head);
                self.store_low(addr, Width::Dword, head);
                self.store_pointer_fields(moved(addr, ANY_HEAD_BYTES), *fields);
            }
            PointerSource::Fields { fields, .. } => self.store_pointer_fields(addr, *fields),
            PointerSource::Counted { type_code, elements, each, fields } => {
                let count = self.b.binary_imm(BinaryOp::Imul, *elements, i64::from(*each));
                let most = self.b.i32_const(0xFFFF);
                let fits = self.b.icmp(IntCc::Ult, count, most);
                let count = self.b.select(fits, count, most);
                let head = self.b.binary_imm(BinaryOp::Or, count, 0x10 << 24 | i64::from(*type_code) << 16);
                self.store_low(addr, Width::Dword, head);
                self.store_pointer_fields(moved(addr, ANY_HEAD_BYTES), *fields);
            }
            PointerSource::Copy(located) => {
                let (from, checks) = self.located_address(located, place::Direction::Read);
                let guard = self.begin_guard(checks, Substitute::None);
                self.copy_pointer(addr, from, any);
                self.end_guard(guard);
            }
            PointerSource::Variant(pointer, pointed) => {
                self.store_pointer_source(addr, pointer, any);
                match (pointed, &**pointer) {
                    (Pointed::Known { elements, ty }, _) => {
                        let elements = self.b.i32_const(*elements);
                        self.store_pointed(addr, elements, *ty);
                    }
                    (Pointed::Counted { ty }, PointerSource::Counted { elements, .. }) => {
                        self.store_pointed(addr, *elements, *ty);
                    }
                    (Pointed::Counted { .. }, _) => unreachable!("the binder only counts elements of ARRAY[*]"),
                    (Pointed::Copied, PointerSource::Copy(located)) => {
                        let (from, checks) = self.located_address(located, place::Direction::Read);
                        let guard = self.begin_guard(checks, Substitute::None);
                        self.copy_pointed(addr, from);
                        self.end_guard(guard);
                    }
                    (Pointed::Copied, _) => unreachable!("the binder only copies pointers"),
                }
            }
        }
    }

    // Functions: references.

    /// The values that an FC gets for a formal; see [`crate::plan::parameter_types`]. Adds to `temporaries` what is copied back after the call.
    pub fn references<'m>(
        &mut self,
        parameter: &Parameter,
        given: Option<Given<'m>>,
        temporaries: &mut Vec<(Back<'m>, Address)>,
    ) -> Vec<Value> {
        let (supply, back) = given.map_or((Supply::Nothing, None), |given| (given.supply, given.back));
        match parameter.passing {
            Passing::Elementary(width) => {
                if let Some(reference) = self.direct_reference(width, back.as_ref()) {
                    return vec![reference];
                }
                let temporary = self.elementary_copy(width, supply, back, temporaries);
                vec![self.reference(Target::at(temporary, BitNumber::Known(0)), width, place::Direction::Write)]
            }
            Passing::Complex { .. } => {
                let pointer = self.temporary(6);
                let source = match (supply, back) {
                    (Supply::Complex(source), _) => source,
                    (_, Some(Back { access, located: Some(located), .. })) => Source::Variable { access, located },
                    _ => Source::Frame(self.result_room(&parameter.ty)),
                };
                let (fields, reference) = self.complex_reference(&source);
                self.store_pointer_fields(pointer, fields);
                vec![self.b.i32_const(pointer.offset), reference]
            }
            Passing::Number => match supply {
                Supply::Number(number) => vec![number],
                _ => vec![self.b.i32_const(0)],
            },
            Passing::Pointer | Passing::Any | Passing::Variant => {
                let any = parameter.passing != Passing::Pointer;
                let bytes = parameter.passing.pointer_bytes();
                let pointer = self.temporary(bytes.max(layout::ANY_BYTES));
                match &supply {
                    Supply::Pointer(source) => self.store_pointer_source(pointer, source, any),
                    _ => self.b.clear(pointer, bytes),
                }
                vec![self.b.i32_const(pointer.offset)]
            }
            Passing::OpenArray { dimensions } => self.open_reference(dimensions, supply, back),
        }
    }

    /// The values that an FC gets for an elementary formal whose area pointer it loads: the reference and that pointer. `place`: the actual is the
    /// variable there.
    pub fn pointed_reference<'m>(
        &mut self,
        width: Width,
        given: Option<Given<'m>>,
        place: Option<&Place>,
        temporaries: &mut Vec<(Back<'m>, Address)>,
    ) -> (Value, Value) {
        let (supply, back) = given.map_or((Supply::Nothing, None), |given| (given.supply, given.back));
        // Local data of SCL may have no address.
        let place = place.filter(|place| has_area_pointer(place) && !matches!(place, Place::L { .. }));
        if let Some(place) = place
            && let Some(reference) = self.direct_reference(width, back.as_ref())
        {
            return (reference, self.area_pointer_of(place));
        }
        let temporary = self.elementary_copy(width, supply, back, temporaries);
        let reference = self.reference(Target::at(temporary, BitNumber::Known(0)), width, place::Direction::Write);
        let copy = Place::L { byte: temporary.offset, bit: 0 };
        (reference, self.area_pointer_of(place.unwrap_or(&copy)))
    }

    fn area_pointer_of(&mut self, place: &Place) -> Value {
        let db = self.get(self.regs.db);
        let pointer = self.pointer_fields(place).pointer;
        self.set(self.regs.db, db);
        pointer
    }

    /// A reference to the variable that receives the value, if it can be used directly.
    fn direct_reference(&mut self, width: Width, back: Option<&Back>) -> Option<Value> {
        let Some(Back { access, located: Some(located), conversion: None }) = back else { return None };
        let fits = access.part.is_none()
            && access.elementary().is_some_and(|ty| layout::width(ty) == width)
            && located.is_memory();
        if !fits {
            return None;
        }
        let target = self.located_target(located, width, place::Direction::Write);
        Some(self.reference(target, width, place::Direction::Write))
    }

    /// Puts the value of an elementary formal into the frame.
    fn elementary_copy<'m>(
        &mut self,
        width: Width,
        supply: Supply<'m>,
        back: Option<Back<'m>>,
        temporaries: &mut Vec<(Back<'m>, Address)>,
    ) -> Address {
        let temporary = self.temporary(width.bytes());
        match supply {
            Supply::Value(value) => self.write_target(Target::at(temporary, BitNumber::Known(0)), width, value),
            _ => self.b.clear(temporary, width.bytes()),
        }
        if let Some(back) = back {
            temporaries.push((back, temporary));
        }
        temporary
    }

    fn complex_reference(&mut self, source: &Source) -> (PointerFields, Value) {
        match source {
            Source::Variable { located, .. } => {
                let fields = self.located_pointer(located);
                let target = self.located_target(located, Width::Byte, place::Direction::Read);
                (fields, self.reference(target, Width::Byte, place::Direction::Read))
            }
            Source::Frame(addr) => {
                let fields = self.pointer_fields(&Place::L { byte: addr.offset, bit: 0 });
                (fields, self.b.address_of(*addr))
            }
        }
    }

    /// The array and its bounds.
    fn open_reference<'m>(&mut self, dimensions: u8, supply: Supply<'m>, back: Option<Back<'m>>) -> Vec<Value> {
        let (access, located) = match (supply, back) {
            (Supply::Complex(Source::Variable { access, located }), _)
            | (_, Some(Back { access, located: Some(located), .. })) => (access, located),
            _ => {
                let pointer = self.temporary(6);
                self.b.clear(pointer, 6);
                let scratch = self.b.i32_const(plcc_abi::layout::SCRATCH);
                let mut values = vec![self.b.i32_const(pointer.offset), scratch];
                for _ in 0..dimensions {
                    values.extend([self.b.i32_const(1), self.b.i32_const(0)]);
                }
                return values;
            }
        };
        let pointer = self.temporary(6);
        let fields = self.located_pointer(&located);
        self.store_pointer_fields(pointer, fields);
        let target = self.located_target(&located, Width::Byte, place::Direction::Write);
        let reference = self.reference(target, Width::Byte, place::Direction::Write);
        let mut values = vec![self.b.i32_const(pointer.offset), reference];
        for dimension in 0..dimensions {
            let (low, high) = self.bounds_of(access, dimension);
            values.extend([low, high]);
        }
        values
    }

    /// Bounds of an array that is passed: declared bounds, or those that this block was given.
    fn bounds_of(&mut self, access: &Access, dimension: u8) -> (Value, Value) {
        match (&access.ty, &access.base) {
            (DataType::Array(array), _) => {
                let (low, high) = array.bounds[usize::from(dimension)];
                (self.b.i32_const(low as u32), self.b.i32_const(high as u32))
            }
            (_, plcc_model::scl::Base::Place(Place::Parameter { parameter, .. })) => {
                self.open_bounds(*parameter, dimension)
            }
            (_, plcc_model::scl::Base::Place(Place::ThroughPointer { pointer, .. })) => {
                let byte = pointer + 6 + 8 * u32::from(dimension);
                let low = self.read(&Place::Instance { byte, bit: 0 }, Width::Dword);
                let high = self.read(&Place::Instance { byte: byte + 4, bit: 0 }, Width::Dword);
                (low, high)
            }
            _ => unreachable!("the binder gives ARRAY[*] arrays"),
        }
    }

    /// Number of elements of an ARRAY[*], an i32; none if it was not supplied.
    fn elements_of(&mut self, access: &Access) -> Value {
        let DataType::OpenArray(array) = &access.ty else { unreachable!("only used for ARRAY[*]") };
        let mut elements = self.b.i32_const(1);
        for dimension in 0..array.dimensions {
            let (low, high) = self.bounds_of(access, dimension);
            let length = self.b.binary(BinaryOp::Isub, high, low);
            let length = self.b.binary_imm(BinaryOp::Iadd, length, 1);
            elements = self.b.binary(BinaryOp::Imul, elements, length);
        }
        elements
    }

    // Instances and structures of parameters: copies.

    /// Writes the input to the formal's place, relative to `base`. For a system function, all complex values are copies.
    pub fn fill(&mut self, base: Address, parameter: &Parameter, given: &Given, system: bool) {
        let addr = moved(base, parameter.byte);
        match (&given.supply, parameter.passing) {
            (Supply::Nothing, Passing::Complex { bytes }) if system && given.back.is_some() => {
                self.b.clear(addr, bytes);
                self.prepare_text(addr, &parameter.ty);
            }
            (Supply::Nothing, _) => {}
            (Supply::Value(value), Passing::Elementary(width)) => {
                self.write_target(Target::at(addr, BitNumber::Known(parameter.bit)), width, *value);
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
                let fields = self.located_pointer(located);
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
            Source::Variable { located, .. } => self.located_address(located, place::Direction::Read),
            Source::Frame(from) => (*from, Vec::new()),
        };
        let guard = self.begin_guard(checks, Substitute::None);
        match (Text::of(ty), ty) {
            (Some(kind), DataType::String(maximum)) => self.copy_text(addr, from, u32::from(*maximum), kind),
            (Some(kind), DataType::WideString(maximum)) => self.copy_text(addr, from, u32::from(*maximum), kind),
            _ => self.b.copy(addr, from, bytes),
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
                match Text::of(ty) {
                    Some(kind) => self.copy_text(to, addr, text_limit(back.access), kind),
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
    fn write_formal(&mut self, parameter: &Parameter, back: &Back, value: Value) {
        let DataType::Elementary(formal) = parameter.ty else { return };
        let Some(actual) = back.access.elementary() else { return };
        let value = self.typed(value, formal);
        let value = match back.conversion {
            Some(conversion) => self.convert(conversion, value, formal, actual),
            None => {
                // The widths are the same, so the bits are the value.
                let bits = self.as_bits(value);
                match super::value_type(actual) {
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

    fn read_back(&mut self, back: &Back) -> Value {
        match &back.located {
            Some(located) => self.read_located(back.access, located),
            None => self.read_access(back.access),
        }
    }
}
