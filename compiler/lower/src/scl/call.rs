//! Calls from SCL; `text` has those of functions of texts. Source: SCL reference, calls; STL reference, block call model.

mod text;

use plcc_abi::layout::area;
use plcc_ir::{Address, FuncId, Value};
use plcc_model::layout;
use plcc_model::scl::{Base, Call, Instance};
use plcc_model::types::DataType;
use plcc_model::{CodeBlock, Direction, Parameter, Passing, Place, Width};

use super::argument::{self, Given, TextSite};
use super::located::Located;
use super::value_type;
use crate::block::BlockLowering;
use crate::call::{is_block_move, text_call};
use crate::fault::{Check, Substitute};
use crate::place::{self, BitNumber, Target};

/// Result of a call.
#[derive(Clone, Copy, Default)]
pub struct Returned {
    /// Of an elementary type.
    pub value: Option<Value>,
    /// Where a complex result is in the frame.
    pub place: Option<Address>,
}

/// Instance memory of a call: its address, and the registers that contain it.
struct InstanceAt {
    addr: Address,
    checks: Vec<Check>,
    di: Value,
    ar2: Value,
}

impl BlockLowering<'_, '_> {
    pub fn scl_call(&mut self, call: &Call) -> Returned {
        let plan = self.plan;
        let (callee, function) = plan.block(call.target).expect("the binder only passes calls of known blocks");
        let result = result(callee);
        let result = result.filter(|&(index, _)| !supplies(call, index));
        let text = text_call(plan, callee);
        let is_own = plan.has_own_result(call.target);
        let room = result.map(|(_, parameter)| match (&text, &parameter.ty) {
            (Some(_), DataType::String(_)) if self.scl.only_text => self.text_room(),
            (None, DataType::String(_)) if self.scl.only_text && is_own => self.own_result_room(),
            (_, ty) => self.result_room(ty),
        });
        let only_text = std::mem::replace(&mut self.scl.only_text, text.is_some());
        let returned = self.call_in_room(call, callee, function, room);
        self.scl.only_text = only_text;
        if let Some(room) = room.filter(|_| is_own) {
            self.take_own_result(room);
        }
        returned
    }

    /// As [`scl_call`](Self::scl_call), with room for the result if the call does not say where that goes.
    fn call_in_room(
        &mut self,
        call: &Call,
        callee: &CodeBlock,
        function: Option<FuncId>,
        room: Option<Address>,
    ) -> Returned {
        let result = result(callee).filter(|&(index, _)| !supplies(call, index));
        let place = self.eno_place(call);
        let place = place.as_ref();
        let Some(enable) = &call.enable else { return self.enabled_call(call, callee, function, room, place) };
        let enable = self.value(enable);
        let ty = result.and_then(|(_, parameter)| match parameter.ty {
            DataType::Elementary(ty) => Some(ty),
            _ => None,
        });
        let var = ty.map(|ty| {
            let var = self.b.declare_var(value_type(ty));
            let zero = self.zero(ty);
            self.b.def_var(var, zero);
            var
        });
        let eno = self.last_eno();
        let no = self.b.bool_const(false);
        self.b.def_var(eno, no);
        let (run, skip, end) = (self.b.create_block(), self.b.create_block(), self.b.create_block());
        self.b.branch(enable, run, skip);
        self.b.seal_block(run);
        self.b.seal_block(skip);
        self.b.switch_to(skip);
        self.note_eno(call, no, place);
        self.b.jump(end, &[]);
        self.b.switch_to(run);
        let returned = self.enabled_call(call, callee, function, room, place);
        if let (Some(var), Some(value)) = (var, returned.value) {
            self.b.def_var(var, value);
        }
        self.b.jump(end, &[]);
        self.b.seal_block(end);
        self.b.switch_to(end);
        Returned { value: var.map(|var| self.b.use_var(var)), place: returned.place }
    }

    fn enabled_call(
        &mut self,
        call: &Call,
        callee: &CodeBlock,
        function: Option<FuncId>,
        room: Option<Address>,
        eno: Option<&Located>,
    ) -> Returned {
        let copies_before = self.scl.pointed_copies.len();
        let returned = match (function, &call.instance) {
            (Some(function), Some(instance)) => {
                self.call_block_instance(call, callee, function, instance);
                Returned::default()
            }
            (Some(function), None) => self.call_block_function(call, callee, function, room),
            (None, _) => self.call_runtime_function(call, callee, room),
        };
        self.take_pointed_copies(copies_before);
        self.probe_outputs(call, callee);
        self.after_block();
        let br = self.get(self.regs.br);
        self.note_eno(call, br, eno);
        if let (Some((index, parameter)), false) = (result(callee), self.scl.calls_set_flag)
            && matches!(parameter.ty, DataType::String(_))
            && supplies(call, index)
        {
            // A truncated text clears the bit, even if other calls do not change it.
            let failed = self.b.not(br);
            self.fail_if(failed);
        }
        returned
    }

    /// Where ENO of a call goes, if indices say it: they count as they are before the call, as those of outputs do.
    fn eno_place<'m>(&mut self, call: &'m Call) -> Option<Located<'m>> {
        let target = call.eno.as_ref()?;
        let is_fixed = matches!(target.base, Base::Place(_)) && target.indices.is_empty();
        (!is_fixed && !self.is_promoted(target)).then(|| self.locate(target))
    }

    /// ENO of a callee, or of a skipped callee.
    fn note_eno(&mut self, call: &Call, eno: Value, place: Option<&Located>) {
        if self.scl.calls_set_flag || !call.is_operation {
            let last = self.last_eno();
            self.b.def_var(last, eno);
        }
        if self.scl.calls_set_flag || call.is_operation {
            let failed = self.b.not(eno);
            self.fail_if(failed);
        }
        match (&call.eno, place) {
            (Some(target), Some(place)) => self.write_located(target, place, eno),
            (Some(target), None) => self.write_access(target, eno),
            (None, _) => {}
        }
    }

    fn given<'m>(&mut self, call: &'m Call, callee: &CodeBlock) -> Vec<Given<'m>> {
        call.arguments
            .iter()
            .map(|argument| self.give(&callee.interface.parameters[argument.parameter], argument))
            .collect()
    }

    // Functions.

    fn call_block_function(
        &mut self,
        call: &Call,
        callee: &CodeBlock,
        function: FuncId,
        room: Option<Address>,
    ) -> Returned {
        if let Some(length) = self.own_length_asked(call, callee) {
            return Returned { value: Some(length), place: None };
        }
        let Some(text) = text_call(self.plan, callee) else {
            let given = self.given(call, callee);
            return self.call_given(call, callee, function, given, room);
        };
        let site = TextSite { text: &text, call, callee, room };
        let begun = self.begin_chain(site);
        let returned = self.call_joined(site, function);
        self.end_text(begun, returned)
    }

    /// Calls the block of a function with evaluated arguments.
    fn call_given(
        &mut self,
        call: &Call,
        callee: &CodeBlock,
        function: FuncId,
        mut given: Vec<Given>,
        room: Option<Address>,
    ) -> Returned {
        let result = result(callee).map(|(index, _)| index).filter(|&index| !supplies(call, index));
        let mut temporaries = Vec::new();
        let mut references = Vec::new();
        let mut pointers = Vec::new();
        let plan = self.plan;
        let pointed = plan.pointed(callee.key());
        for (index, parameter) in callee.interface.parameters.iter().enumerate() {
            let is_pointed = pointed.contains(&index);
            if let (true, Some(room)) = (result == Some(index), room) {
                references.extend(self.result_reference(parameter, room));
                if is_pointed {
                    pointers.push(self.pointer_fields(&Place::L { byte: room.offset, bit: 0 }).pointer);
                }
                continue;
            }
            let own = given.iter().position(|given| given.parameter == index).map(|at| given.swap_remove(at));
            let mut backs = Vec::new();
            let actual = call.arguments.iter().find(|argument| argument.parameter == index);
            if let (true, Passing::Elementary(width)) = (is_pointed, parameter.passing) {
                let place = actual.and_then(|argument| argument::place_of(&argument.actual));
                let (reference, pointer) = self.pointed_reference(width, own, place, &mut backs);
                references.push(reference);
                pointers.push(pointer);
            } else if let Some(reference) = actual.and_then(|actual| self.input_in_place(parameter, &actual.actual)) {
                references.push(reference);
            } else {
                references.extend(self.references(parameter, own, &mut backs));
            }
            temporaries.extend(backs.into_iter().map(|(back, temporary)| (index, back, temporary)));
        }
        references.extend(pointers);
        let ar2 = self.get(self.regs.ar[1]);
        let registers = [self.regs.db, self.regs.di].map(|register| (register, self.get(register)));
        self.call_function(callee, function, references);
        self.set(self.regs.ar[1], ar2);
        for (register, value) in registers {
            self.set(register, value);
        }
        for (index, back, temporary) in &temporaries {
            self.take_temporary(&callee.interface.parameters[*index], back, *temporary);
        }
        self.returned(callee, room)
    }

    /// The values that an FC gets for its result.
    fn result_reference(&mut self, parameter: &Parameter, room: Address) -> Vec<Value> {
        match &parameter.ty {
            DataType::Elementary(ty) => {
                let target = Target::at(room, BitNumber::Known(0));
                vec![self.reference(target, layout::width(*ty), place::Direction::Write)]
            }
            _ => {
                let pointer = self.temporary(6);
                let fields = self.pointer_fields(&Place::L { byte: room.offset, bit: 0 });
                self.store_pointer_fields(pointer, fields);
                let reference = self.b.address_of(room);
                vec![self.b.i32_const(pointer.offset), reference]
            }
        }
    }

    fn returned(&mut self, callee: &CodeBlock, room: Option<Address>) -> Returned {
        let (Some((_, parameter)), Some(room)) = (result(callee), room) else { return Returned::default() };
        match parameter.ty {
            DataType::Elementary(ty) => {
                let value = self.read_target(Target::at(room, BitNumber::Known(0)), layout::width(ty));
                Returned { value: Some(self.typed(value, ty)), place: None }
            }
            _ => Returned { value: None, place: Some(room) },
        }
    }

    // Function blocks.

    fn call_block_instance(&mut self, call: &Call, callee: &CodeBlock, function: FuncId, instance: &Instance) {
        let at = self.instance_at(instance);
        let exists = at.checks.iter().all(|check| self.b.constant_bits(check.ok) == Some(1));
        let given = self.given_to_instance(exists.then_some(at.addr), call, callee);
        let guard = self.begin_guard(at.checks, Substitute::None);
        for given in &given {
            self.fill(at.addr, callee, given, false);
        }
        let registers = [self.regs.db, self.regs.di, self.regs.ar[1]].map(|register| (register, self.get(register)));
        let di = self.get(self.regs.di);
        self.set(self.regs.db, di);
        self.set(self.regs.di, at.di);
        self.set(self.regs.ar[1], at.ar2);
        self.call_function(callee, function, Vec::new());
        for (register, value) in registers {
            self.set(register, value);
        }
        self.take_back(at.addr, callee, &given);
        self.end_guard(guard);
    }

    /// In order of declaration.
    fn take_back(&mut self, base: Address, callee: &CodeBlock, given: &[Given]) {
        for (index, parameter) in callee.interface.parameters.iter().enumerate() {
            let back = given.iter().find(|given| given.parameter == index).and_then(|given| given.back.as_ref());
            if let Some(back) = back {
                self.take(base, parameter, back);
            }
        }
    }

    fn instance_at(&mut self, instance: &Instance) -> InstanceAt {
        match instance {
            Instance::Db(number) => {
                let db = self.get(self.regs.db);
                let target =
                    self.target(&Place::Db { number: *number, byte: 0, bit: 0 }, Width::Byte, place::Direction::Write);
                self.set(self.regs.db, db);
                let (addr, _, checks) = self.in_memory(target, Width::Byte, place::Direction::Write);
                let di = self.b.i32_const(u32::from(*number));
                let ar2 = self.b.i32_const(u32::from(area::DB) << 24);
                InstanceAt { addr, checks, di, ar2 }
            }
            Instance::Variable(access) => {
                let located = self.locate(access);
                let (addr, checks) = self.located_address(&located, place::Direction::Write);
                let fields = self.located_pointer(&located);
                InstanceAt { addr, checks, di: fields.db, ar2: fields.pointer }
            }
        }
    }

    // System functions.

    fn call_runtime_function(&mut self, call: &Call, callee: &CodeBlock, room: Option<Address>) -> Returned {
        let given = self.given(call, callee);
        let bytes = callee.interface.bytes;
        let structure = self.temporary(bytes.max(2));
        let known = is_block_move(callee).then(|| self.given_block_move_pointers(&given)).flatten();
        if !known.is_some_and(|(source, to)| self.known_block_move(callee, structure, source, to)) {
            self.b.clear(structure, bytes);
            for given in &given {
                self.fill(structure, callee, given, true);
            }
            self.run_system_function(callee, structure);
        }
        self.take_back(structure, callee, &given);
        let (Some((_, parameter)), Some(room)) = (result(callee), room) else { return Returned::default() };
        let at = Address { offset: structure.offset + parameter.byte, ..structure };
        match parameter.ty {
            DataType::Elementary(ty) => {
                let target = Target::at(at, BitNumber::Known(parameter.bit));
                let value = self.read_target(target, layout::width(ty));
                Returned { value: Some(self.typed(value, ty)), place: None }
            }
            _ => {
                self.b.copy(room, at, layout::bytes(&parameter.ty));
                Returned { value: None, place: Some(room) }
            }
        }
    }
}

/// True if the call determines where parameter `index` is.
fn supplies(call: &Call, index: usize) -> bool {
    call.arguments.iter().any(|argument| argument.parameter == index)
}

/// The result of a function among its parameters.
pub fn result(callee: &CodeBlock) -> Option<(usize, &Parameter)> {
    callee
        .interface
        .parameters
        .iter()
        .enumerate()
        .find(|(_, parameter)| parameter.direction == Direction::Output && parameter.name == "RET_VAL")
}
