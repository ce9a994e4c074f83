//! Calls of functions of texts: done in place where the texts are as declared, and several joined texts at once.

use plcc_ir::{Address, Block, FuncId, Value, Var};
use plcc_model::CodeBlock;
use plcc_model::scl::{Actual, Call, Complex};
use plcc_model::types::{DataType, Elementary};

use super::{Returned, result};
use crate::block::BlockLowering;
use crate::call::is_length;
use crate::scl::argument::{self, Given, Look, TextArguments, TextSite, joined_call};
use crate::scl::own_texts::OwnText;
use crate::scl::text::TEXT_MAX;
use crate::scl::value_type;

/// A function of texts that was done without a call where that is possible.
pub(super) struct BegunText {
    end: Block,
    value: Option<Var>,
}

impl BlockLowering<'_, '_> {
    /// LEN of a text whose length is a value.
    pub(super) fn own_length_asked(&mut self, call: &Call, callee: &CodeBlock) -> Option<Value> {
        let ty = value_of(callee).filter(|_| is_length(self.plan, callee))?;
        let [argument] = &call.arguments[..] else { return None };
        let (Actual::Complex(Complex::Variable(access)) | Actual::Reference(access)) = &argument.actual else {
            return None;
        };
        let (_, own) = self.own_text_of(access)?;
        let length = self.own_length(own);
        let yes = self.b.bool_const(true);
        self.set(self.regs.br, yes);
        Some(self.typed(length, ty))
    }

    /// Calls the block of a function of texts, which looks at its texts in memory.
    fn call_text_block(&mut self, site: TextSite, function: FuncId, given: Vec<Given>) -> Returned {
        let TextSite { call, callee, room, .. } = site;
        let mut own: Vec<(Address, OwnText)> = Vec::new();
        for given in &given {
            let access = match (&given.supply, &given.back) {
                (argument::Supply::Complex(argument::Source::Variable { access, .. }), _)
                | (_, Some(argument::Back { access, .. })) => *access,
                (argument::Supply::Complex(argument::Source::Frame(addr)), _) => {
                    let actual = call.arguments.iter().find(|argument| argument.parameter == given.parameter);
                    if let Some(Actual::Complex(Complex::Const(bytes))) = actual.map(|argument| &argument.actual) {
                        self.store_bytes(*addr, bytes);
                    }
                    own.extend(self.own_text(*addr, TEXT_MAX as u8).map(|text| (*addr, text)));
                    continue;
                }
                _ => continue,
            };
            own.extend(self.own_text_of(access));
        }
        own.extend(room.and_then(|room| Some((room, self.own_text(room, TEXT_MAX as u8)?))));
        for &(addr, text) in &own {
            self.store_own_length(addr, text);
        }
        let returned = self.call_given(call, callee, function, given, room);
        for &(addr, text) in &own {
            self.load_own_length(addr, text);
        }
        returned
    }

    /// Calls a function of texts; one that joins two texts with the result of another call joins three.
    pub(super) fn call_joined(&mut self, site: TextSite, function: FuncId) -> Returned {
        let TextSite { text, call, callee, room } = site;
        let Some(inner) = joined_call(text, call) else {
            let given = self.given(call, callee);
            return self.call_text(site, function, given);
        };
        let inner_given = self.given(inner, callee);
        let first = call.arguments.iter().position(|one| matches!(&one.actual, Actual::Complex(Complex::Call(_))));
        let first = first.expect("the inner call is an argument");
        let mut given = self.given_but(call, callee, first);
        let calls: [(&Call, &[Given]); 2] = [(inner, &inner_given), (call, &given)];
        if let Some((arguments, known)) = self.joined_arguments(site, &calls, Look::Pointers)
            && self.b.constant_bits(known) == Some(1)
        {
            let br = self.run_joined_call(callee, &arguments);
            self.note_eno(inner, br, None);
            return Returned { value: None, place: room };
        }
        let joined = self.joined_arguments(site, &calls, Look::Heads);
        let begun = self.begin_text(site, joined, &given, &[inner]);
        let inner_room = self.text_room();
        self.call_text(TextSite { call: inner, room: Some(inner_room), ..site }, function, inner_given);
        let br = self.get(self.regs.br);
        self.note_eno(inner, br, None);
        let supply = argument::Supply::Complex(argument::Source::Frame(inner_room));
        given.push(Given { parameter: call.arguments[first].parameter, supply, back: None });
        let returned = self.call_text(site, function, given);
        self.end_text(begun, returned)
    }

    /// What a call is given, but for one of its arguments.
    fn given_but<'m>(&mut self, call: &'m Call, callee: &CodeBlock, without: usize) -> Vec<Given<'m>> {
        let others = call.arguments.iter().enumerate().filter(|(at, _)| *at != without);
        others.map(|(_, argument)| self.give(&callee.interface.parameters[argument.parameter], argument)).collect()
    }

    /// Joins more than three texts at once, where nothing is out of the ordinary.
    pub(super) fn begin_chain(&mut self, site: TextSite) -> Option<BegunText> {
        let calls = argument::chain(site.text, site.call);
        if calls.len() < 3 || self.scl.by_runtime {
            return None;
        }
        let mut given = Vec::new();
        for call in &calls {
            let first = call.arguments.iter().position(|one| matches!(&one.actual, Actual::Complex(Complex::Call(_))));
            given.push(self.given_but(call, site.callee, first.unwrap_or(usize::MAX)));
        }
        let all: Vec<(&Call, &[Given])> = calls.iter().copied().zip(given.iter().map(Vec::as_slice)).collect();
        let joined = self.joined_arguments(site, &all, Look::Heads);
        let (outermost, inner) = calls.split_last()?;
        debug_assert!(std::ptr::eq(*outermost, site.call));
        self.begin_text(site, joined, given.last()?, inner)
    }

    /// Calls a function of texts, or the block in its place if the addresses are not right.
    fn call_text(&mut self, site: TextSite, function: FuncId, given: Vec<Given>) -> Returned {
        let by_heads = self.text_arguments(site, &given, Look::Heads);
        let begun = self.begin_text(site, by_heads, &given, &[]);
        let returned = self.call_text_by_pointers(site, function, given);
        self.end_text(begun, returned)
    }

    /// Does a function where its texts are as declared, without a look at the areas that they are in, if that is less. Then all goes on at its
    /// end, and what is lowered next does it in all other cases, by calls. `inner`: calls that the function also does.
    fn begin_text(
        &mut self,
        site: TextSite,
        arguments: Option<(TextArguments, Value)>,
        given: &[Given],
        inner: &[&Call],
    ) -> Option<BegunText> {
        let (arguments, known) = arguments?;
        let is_less = self.has_whole_text(&arguments) || inner.len() > 1;
        if !is_less || !self.does_text_call(&arguments) {
            return None;
        }
        let (leave, end) = (self.b.create_cold_block(), self.b.create_block());
        self.require(known, leave);
        let value = self.do_text_call(site, &arguments, given, leave);
        for inner in inner {
            let good = self.b.bool_const(true);
            self.note_eno(inner, good, None);
        }
        let ty = value_of(site.callee);
        let value = value.zip(ty).map(|(value, ty)| {
            let value = self.typed(value, ty);
            let var = self.b.declare_var(value_type(ty));
            self.b.def_var(var, value);
            var
        });
        self.b.jump(end, &[]);
        self.b.seal_block(leave);
        self.b.switch_to(leave);
        self.scl.by_runtime = true;
        Some(BegunText { end, value })
    }

    /// All ways of a function that [`begin_text`](Self::begin_text) began meet; on this one it `returned`.
    pub(super) fn end_text(&mut self, begun: Option<BegunText>, returned: Returned) -> Returned {
        let Some(BegunText { end, value }) = begun else { return returned };
        self.scl.by_runtime = false;
        if let (Some(var), Some(value)) = (value, returned.value) {
            self.b.def_var(var, value);
        }
        self.b.jump(end, &[]);
        self.b.seal_block(end);
        self.b.switch_to(end);
        Returned { value: value.map(|var| self.b.use_var(var)), place: returned.place }
    }

    fn call_text_by_pointers(&mut self, site: TextSite, function: FuncId, given: Vec<Given>) -> Returned {
        let TextSite { callee, room, .. } = site;
        let Some((arguments, known)) = self.text_arguments(site, &given, Look::Pointers) else {
            return self.call_text_block(site, function, given);
        };
        let ty = value_of(callee);
        if self.b.constant_bits(known) == Some(1) {
            let value = self.run_text_call(site, &arguments, &given);
            let value = value.zip(ty).map(|(value, ty)| self.typed(value, ty));
            return Returned { value, place: room.filter(|_| ty.is_none()) };
        }
        // The block itself decides what becomes of addresses that are wrong.
        let var = ty.map(|ty| self.b.declare_var(value_type(ty)));
        let (run, call_it, end) = (self.b.create_block(), self.b.create_cold_block(), self.b.create_block());
        self.b.branch(known, run, call_it);
        self.b.seal_block(run);
        self.b.seal_block(call_it);
        let mut has_value = false;
        self.b.switch_to(run);
        let value = self.run_text_call(site, &arguments, &given);
        if let (Some(var), Some(ty), Some(value)) = (var, ty, value) {
            let value = self.typed(value, ty);
            self.b.def_var(var, value);
            has_value = true;
        }
        self.b.jump(end, &[]);
        self.b.switch_to(call_it);
        let returned = self.call_text_block(site, function, given);
        if let (Some(var), Some(value), true) = (var, returned.value, has_value) {
            self.b.def_var(var, value);
        }
        self.b.jump(end, &[]);
        self.b.seal_block(end);
        self.b.switch_to(end);
        Returned { value: var.filter(|_| has_value).map(|var| self.b.use_var(var)), place: returned.place }
    }
}

/// The type of the elementary result of a function.
fn value_of(callee: &CodeBlock) -> Option<Elementary> {
    result(callee).and_then(|(_, parameter)| match parameter.ty {
        DataType::Elementary(ty) => Some(ty),
        _ => None,
    })
}
