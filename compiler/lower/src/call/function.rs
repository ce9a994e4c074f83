//! Calls of FCs: references to the actual parameters.

use plcc_abi::layout;
use plcc_ir::{Address, BinaryOp, FuncId, Value};
use plcc_model::{Actual, Argument, CodeBlock, Direction, Parameter, Passing, Place, Width};

use crate::block::BlockLowering;
use crate::fault::Substitute;
use crate::place::{self, BitNumber, Target};

impl BlockLowering<'_, '_> {
    /// Calls an FC of the program.
    pub(super) fn call_fc(&mut self, callee: &CodeBlock, function: FuncId, arguments: &[Argument]) {
        let mut copies_back = Vec::new();
        let mut references = Vec::new();
        let mut pointers = Vec::new();
        let plan = self.plan;
        let pointed = plan.pointed(callee.key());
        for (index, parameter) in callee.interface.parameters.iter().enumerate() {
            let argument = arguments.iter().find(|argument| argument.parameter == index);
            match argument {
                Some(argument) => {
                    // A fully qualified actual does not change the caller's DB register.
                    let db = self.get(self.regs.db);
                    let wanted = pointed.contains(&index).then_some(&mut pointers);
                    self.fc_argument(parameter, &argument.actual, &mut references, &mut copies_back, wanted);
                    self.set(self.regs.db, db);
                }
                None => {
                    self.no_argument(parameter, &mut references);
                    if pointed.contains(&index) {
                        pointers.push(self.b.i32_const(0));
                    }
                }
            }
        }
        references.extend(pointers);
        self.call_function(callee, function, references);
        for (place, width, temporary) in copies_back {
            let value = self.read_target(Target::at(temporary, BitNumber::Known(0)), width);
            self.write(&place, width, value);
        }
    }

    /// The values that an FC gets for one parameter; see [`plan::parameter_types`]. `pointers`: the FC also needs the area pointer of the
    /// actual. An actual without one in the FC is copied into the caller's frame and back, as STEP 7 does.
    fn fc_argument(
        &mut self,
        parameter: &Parameter,
        actual: &Actual,
        references: &mut Vec<Value>,
        copies_back: &mut Vec<(Place, Width, Address)>,
        pointers: Option<&mut Vec<Value>>,
    ) {
        match parameter.passing {
            Passing::Elementary(width) => {
                let mut copy = None;
                let reference = match actual {
                    Actual::Place(place)
                        if matches!(place, Place::Pi { .. } | Place::Pq { .. })
                            || pointers.is_some() && !has_area_pointer(place) =>
                    {
                        let temporary = self.temporary(4);
                        copy = Some(temporary);
                        if parameter.direction != Direction::Output {
                            let value = self.read(place, width);
                            self.write_target(Target::at(temporary, BitNumber::Known(0)), width, value);
                        }
                        if parameter.direction != Direction::Input {
                            copies_back.push((place.clone(), width, temporary));
                        }
                        self.reference(Target::at(temporary, BitNumber::Known(0)), width, place::Direction::Write)
                    }
                    Actual::Place(place) => {
                        let direction = access_direction(parameter.direction);
                        let target = self.target(place, width, direction);
                        self.reference(target, width, direction)
                    }
                    Actual::Const(bytes) => {
                        let temporary = self.temporary(bytes.len() as u32);
                        copy = Some(temporary);
                        self.store_bytes(temporary, bytes);
                        self.reference(Target::at(temporary, BitNumber::Known(0)), width, place::Direction::Write)
                    }
                    Actual::Number(_)
                    | Actual::PointerBytes(_)
                    | Actual::PointerTo { .. }
                    | Actual::PointerCopy(_)
                    | Actual::Variant(..) => {
                        unreachable!("the binder gives elementary formals values")
                    }
                };
                references.push(reference);
                if let Some(pointers) = pointers {
                    let copy = copy.map_or(0, |temporary| temporary.offset);
                    let pointer = match actual {
                        Actual::Place(place) if has_area_pointer(place) => self.pointer_fields(place).pointer,
                        _ => self.pointer_fields(&Place::L { byte: copy, bit: 0 }).pointer,
                    };
                    pointers.push(pointer);
                }
            }
            Passing::Complex { bytes } => self.complex_argument(actual, bytes, references),
            Passing::Number => {
                let Actual::Number(number) = actual else { unreachable!("the binder gives numbers") };
                references.push(self.number(number));
            }
            Passing::Pointer | Passing::Any | Passing::Variant => {
                let temporary = self.temporary(parameter.passing.pointer_bytes());
                self.store_pointer(temporary, actual, parameter.passing != Passing::Pointer);
                references.push(self.b.i32_const(temporary.offset));
            }
            Passing::OpenArray { .. } => unreachable!("the binder gives an ARRAY[*] to calls from SCL only"),
        }
    }

    /// POINTER in the frame, and the variable itself.
    fn complex_argument(&mut self, actual: &Actual, bytes: u32, references: &mut Vec<Value>) {
        let pointer = self.temporary(6);
        match actual {
            Actual::Place(place) => {
                let fields = self.pointer_fields(place);
                self.store_pointer_fields(pointer, fields);
                let target = self.target(place, Width::Byte, place::Direction::Read);
                let reference = self.reference_to(target, Width::Byte, bytes, place::Direction::Read);
                references.push(self.b.i32_const(pointer.offset));
                references.push(reference);
            }
            Actual::Const(bytes) => {
                let temporary = self.temporary(bytes.len() as u32);
                self.store_bytes(temporary, bytes);
                let fields = self.pointer_fields(&Place::L { byte: temporary.offset, bit: 0 });
                self.store_pointer_fields(pointer, fields);
                references.push(self.b.i32_const(pointer.offset));
                let address = self.b.address_of(temporary);
                references.push(address);
            }
            Actual::Number(_)
            | Actual::PointerBytes(_)
            | Actual::PointerTo { .. }
            | Actual::PointerCopy(_)
            | Actual::Variant(..) => {
                unreachable!("the binder gives complex formals variables")
            }
        }
    }

    /// `UC` of an FC with parameters passes nothing: reads yield 0, writes have no effect.
    pub(super) fn no_argument(&mut self, parameter: &Parameter, references: &mut Vec<Value>) {
        let scratch = match parameter.passing {
            Passing::Elementary(width) => {
                self.clear_scratch(width.bytes());
                if width == Width::Bit { layout::SCRATCH * 8 } else { layout::SCRATCH }
            }
            Passing::Complex { bytes } => {
                self.clear_scratch(bytes);
                let pointer = self.temporary(6);
                self.b.clear(pointer, 6);
                references.push(self.b.i32_const(pointer.offset));
                layout::SCRATCH
            }
            Passing::Number => 0,
            Passing::Pointer | Passing::Any | Passing::Variant => {
                let bytes = parameter.passing.pointer_bytes();
                let pointer = self.temporary(bytes);
                self.b.clear(pointer, bytes);
                pointer.offset
            }
            Passing::OpenArray { dimensions } => {
                let pointer = self.temporary(6);
                self.b.clear(pointer, 6);
                references.push(self.b.i32_const(pointer.offset));
                references.push(self.b.i32_const(layout::SCRATCH));
                // No element exists between 1 and 0.
                for _ in 0..dimensions {
                    references.push(self.b.i32_const(1));
                    references.push(self.b.i32_const(0));
                }
                return;
            }
        };
        references.push(self.b.i32_const(scratch));
    }

    /// A reference to `target` for an FC. If the address is faulty, it refers to scratch memory, which begins with 0.
    pub fn reference(&mut self, target: Target, width: Width, direction: place::Direction) -> Value {
        self.reference_to(target, width, width.bytes(), direction)
    }

    /// As [`reference`](Self::reference), to a variable of `bytes` bytes.
    pub fn reference_to(&mut self, target: Target, width: Width, bytes: u32, direction: place::Direction) -> Value {
        let (addr, bit, mut checks) = self.in_memory(target, width, direction);
        checks.retain(|check| self.b.constant_bits(check.ok) != Some(1));
        let reference = |lowering: &mut Self| {
            let address = lowering.b.address_of(addr);
            if width != Width::Bit {
                return address;
            }
            let bits = lowering.b.binary_imm(BinaryOp::Shl, address, 3);
            match bit {
                BitNumber::Known(bit) => lowering.b.binary_imm(BinaryOp::Iadd, bits, i64::from(bit)),
                BitNumber::Alone => bits,
                BitNumber::Dynamic(bit) => lowering.b.iadd(bits, bit),
            }
        };
        if checks.is_empty() {
            return reference(self);
        }
        let scratch = if width == Width::Bit { layout::SCRATCH * 8 } else { layout::SCRATCH };
        let scratch = self.b.i32_const(scratch);
        self.set(self.reference, scratch);
        let guard = self.begin_guard(checks, Substitute::Scratch(bytes));
        let value = reference(self);
        self.set(self.reference, value);
        self.end_guard(guard);
        self.get(self.reference)
    }
}

fn access_direction(direction: Direction) -> place::Direction {
    match direction {
        Direction::Input => place::Direction::Read,
        Direction::Output | Direction::InOut => place::Direction::Write,
    }
}

/// True for actuals whose area pointer means the same in the block that is called: not for static data and formal parameters of the
/// caller.
pub fn has_area_pointer(place: &Place) -> bool {
    match place {
        Place::I { .. }
        | Place::Q { .. }
        | Place::M { .. }
        | Place::Pi { .. }
        | Place::Pq { .. }
        | Place::L { .. }
        | Place::OpenDb { .. }
        | Place::Db { .. } => true,
        Place::OpenDi { .. }
        | Place::Instance { .. }
        | Place::Parameter { .. }
        | Place::ThroughPointer { .. }
        | Place::Indirect { .. }
        | Place::Register { .. }
        | Place::Element { .. } => false,
    }
}
