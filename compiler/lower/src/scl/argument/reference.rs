//! Parameters of FCs: references to the actual parameters.

use plcc_ir::{Address, Value};
use plcc_model::layout;
use plcc_model::scl::{Access, Actual, Conversion, ExprKind};
use plcc_model::types::DataType;
use plcc_model::{Direction, Parameter, Passing, Place, Width};

use super::{Back, Given, Source, Supply};
use crate::block::BlockLowering;
use crate::call::has_area_pointer;
use crate::place::{self, BitNumber, Target};
use crate::pointer::PointerFields;
use crate::scl::located::Located;

impl BlockLowering<'_, '_> {
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
        // The same bits as another type, such as an INT in MW 10, need no copy.
        let Some(Back { access, located: Some(located), conversion: None | Some(Conversion::Bits { .. }) }) = back
        else {
            return None;
        };
        // A character may not be there.
        let fits = access.part.is_none()
            && located.character().is_none()
            && access.elementary().is_some_and(|ty| layout::width(ty) == width)
            && located.is_memory();
        if !fits {
            return None;
        }
        let target = self.located_target(located, width, place::Direction::Write);
        Some(self.reference(target, width, place::Direction::Write))
    }

    /// A reference to the variable that an input is, in a block that passes inputs in place.
    pub fn input_in_place(&mut self, parameter: &Parameter, actual: &Actual) -> Option<Value> {
        let (true, Direction::Input, Passing::Elementary(width), Actual::Value(value)) =
            (self.scl.inputs_in_place, parameter.direction, parameter.passing, actual)
        else {
            return None;
        };
        // An address without a type has the bits of the formal.
        let load = match &value.kind {
            ExprKind::Convert { conversion: Conversion::Bits { .. }, operand } => &operand.kind,
            kind => kind,
        };
        let ExprKind::Load(access) = load else { return None };
        let has_width = access.part.is_none() && access.elementary().is_some_and(|ty| layout::width(ty) == width);
        if !has_width || !access.indices.is_empty() || self.is_promoted(access) {
            return None;
        }
        let located = self.locate(access);
        if !located.is_memory() {
            return None;
        }
        let target = self.located_target(&located, width, place::Direction::Read);
        Some(self.reference(target, width, place::Direction::Read))
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
        let supply = match (supply, &back) {
            // What the FC does not write stays: the copy begins with the slice.
            (Supply::Nothing, Some(back)) if keeps_slice(back, width) => {
                let ty = back.access.elementary().expect("a slice is elementary");
                let value = self.read_back(back);
                Supply::Value(self.untyped(value, ty))
            }
            (supply, _) => supply,
        };
        match supply {
            Supply::Value(value) => self.write_target(Target::at(temporary, BitNumber::Known(0)), width, value),
            _ => self.b.clear(temporary, width.bytes()),
        }
        if let Some(back) = back {
            temporaries.push((back, temporary));
        }
        temporary
    }

    pub(super) fn complex_reference(&mut self, source: &Source) -> (PointerFields, Value) {
        match source {
            Source::Variable { access, located } => {
                let fields = self.pointer_in_bounds(located);
                let target = self.located_target(located, Width::Byte, place::Direction::Read);
                let bytes = layout::bytes(&access.ty);
                (fields, self.reference_to(target, Width::Byte, bytes, place::Direction::Read))
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
        let fields = self.pointer_in_bounds(&located);
        self.store_pointer_fields(pointer, fields);
        let target = self.located_target(&located, Width::Byte, place::Direction::Write);
        let bytes = layout::bytes(&access.ty);
        let reference = self.reference_to(target, Width::Byte, bytes, place::Direction::Write);
        let mut values = vec![self.b.i32_const(pointer.offset), reference];
        for dimension in 0..dimensions {
            let (low, high) = self.bounds_of(access, dimension);
            values.extend([low, high]);
        }
        values
    }

    /// Bounds of an array that is passed: declared bounds, or those that this block was given.
    pub(super) fn bounds_of(&mut self, access: &Access, dimension: u8) -> (Value, Value) {
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
}

/// True for a slice of a variable that can be read, with the bits of the formal.
fn keeps_slice(back: &Back, width: Width) -> bool {
    let is_readable = back.located.as_ref().is_none_or(Located::is_memory);
    let same_bits = matches!(back.conversion, None | Some(Conversion::Bits { .. }));
    back.access.part.is_some_and(|part| part.width == width) && same_bits && is_readable
}
