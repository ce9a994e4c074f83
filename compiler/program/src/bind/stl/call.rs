//! `CALL`: target, instance and the list of parameters.

use std::rc::Rc;

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{self, BlockPrefix, OperandKind, Path, PathRoot};
use plcc_syntax::count::counted;
use rustc_hash::FxHashMap;

use crate::bind::declarations::block::CurrentBlock;
use crate::bind::declarations::calls::InstanceId;
use crate::bind::declarations::typed::BoundInterface;
use crate::bind::globals::names::code_kind;
use crate::bind::stl::StlBinder;
use crate::bind::stl::instance::{instance_key, is_passed, named_instance};
use crate::bind::stl::move_call::names_a_type;
use crate::bind::stl::settle::Settled;
use plcc_binding::fold;
use plcc_model::types::DataType;
use plcc_model::{Actual, Argument, BlockKey, Call, Direction, Instance, Number, Passing, Place};

impl StlBinder<'_, '_> {
    pub fn bind_call(&mut self, ctx: &mut CurrentBlock, call: &ast::Call, span: Span) -> Option<Call> {
        if let Some(form) = self.called_form(ctx, call) {
            return self.bind_form(ctx, call, form);
        }
        let Some((key, own, bound)) = self.call_target(ctx, call) else {
            self.note_names(ctx, call);
            return None;
        };
        let instance = self.instance(ctx, call, key, own);
        let mut arguments = self.call_arguments(ctx, call, key, &bound)?;
        arguments.sort_by_key(|argument| argument.parameter);
        self.check_overlaps(&bound, &arguments);
        let instance = instance?;
        if let Some(instance) = &instance
            && key.kind == BlockKind::Fb
        {
            let id = match instance {
                Instance::Db(number) => InstanceId::Db(*number),
                Instance::Multi { byte } => InstanceId::Multi(ctx.key, *byte),
                Instance::Inner { db, byte } => InstanceId::Inner(*db, *byte),
            };
            let supplied: Vec<usize> = arguments.iter().map(|argument| argument.parameter).collect();
            self.program.pointers.note(id, key, &bound, &supplied, span);
        }
        Some(Call { target: key, instance, arguments })
    }

    /// The block of a call, the instance that is called by its own name, and the interface; `None` after a message.
    fn call_target(
        &mut self,
        ctx: &mut CurrentBlock,
        call: &ast::Call,
    ) -> Option<(BlockKey, Option<Instance>, Rc<BoundInterface>)> {
        let span = call.target.span;
        if let Some(instruction) = self.called_instruction(call) {
            let key = self.instruction_function(ctx, call, instruction)?;
            return Some((key, None, self.program.interface(key, span)?));
        }
        if instruction_name(ctx, call).is_some_and(|name| self.program.globals.missing_in_stl(name, span)) {
            return None;
        }
        if let (OperandKind::Path(path), None) = (&call.target.kind, &call.instance)
            && let Some(name) = path.name()
            && ctx.bound.locals.contains_key(&fold(name))
        {
            let text = self.program.globals.text(span);
            let write = |instruction: &str| format!("CALL {instruction}, {text}");
            if self.program.has_common_data(ctx, name, span, write) {
                return None;
            }
        }
        let settled = match self.named_before_instance(ctx, call) {
            Some((prefix, number)) => Settled::Block { prefix, number: Number::Known(number) },
            None => self.settle(ctx, &call.target)?,
        };
        let (key, own) = match settled {
            Settled::Block { prefix, number: Number::Known(number) } if callable(prefix).is_some() => {
                (BlockKey { kind: callable(prefix)?, number }, None)
            }
            Settled::Complex { place, ty } => match (instance_key(&ty), named_instance(&place)) {
                (Some(key), Some(instance)) => (key, Some(instance)),
                (Some(_), None) if !place.indices().is_empty() => return self.computed_instance(span),
                (Some(_), None) if is_passed(&place) => return self.passed_instance(span),
                _ => return self.not_callable(span),
            },
            _ => return self.not_callable(span),
        };
        let bound = self.program.interface(key, span)?;
        let names = call.parameters.iter().map(|parameter| parameter.name.as_str());
        if self.program.globals.is_own_of_program(key, &bound.interface.parameters, names, span) {
            return None;
        }
        Some((key, own, bound))
    }

    /// Names in a call that cannot be checked are still looked up, so that all undefined ones are reported.
    pub fn note_names(&mut self, ctx: &mut CurrentBlock, call: &ast::Call) {
        let values = call.parameters.iter().filter(|parameter| !names_a_type(parameter));
        let actuals = values.filter_map(|parameter| parameter.actual.as_ref());
        for operand in call.instance.iter().chain(actuals) {
            if !matches!(operand.kind, OperandKind::Block(_)) {
                self.settle(ctx, operand);
            }
        }
    }

    fn not_callable<T>(&mut self, span: Span) -> Option<T> {
        let text = self.program.globals.text(span);
        self.program.report(
            Diagnostic::new(Code::OperandKind, span, format!("`CALL` calls a block, but `{text}` is not a block"))
                .label("an FC, FB, SFC, SFB or an instance is expected here")
                .help("to call a block whose number is only known at run time, use `UC FC [MW 10]`"),
        );
        None
    }

    pub fn call_arguments(
        &mut self,
        ctx: &mut CurrentBlock,
        call: &ast::Call,
        key: BlockKey,
        bound: &Rc<BoundInterface>,
    ) -> Option<Vec<Argument>> {
        let parameters = &bound.interface.parameters;
        let mut seen: FxHashMap<usize, Span> = FxHashMap::default();
        let mut empty: Vec<usize> = Vec::new();
        let mut arguments = Vec::with_capacity(call.parameters.len());
        let mut good = true;
        // Parameters given under a misspelt name: that they are missing is already reported.
        let mut misspelt: Vec<String> = Vec::new();
        let mut unread = false;
        for (at, given) in call.parameters.iter().enumerate() {
            // It could not be read, which is reported.
            if given.name.is_empty() && matches!(&given.actual, Some(ast::Operand { kind: OperandKind::Error, .. })) {
                good = false;
                unread = true;
                continue;
            }
            let folded = fold(&given.name);
            let index = match given.name.is_empty() {
                // Pointers in the order of the interface.
                true if at < parameters.len() => Some(at),
                true => {
                    good = false;
                    self.surplus_pointer(key, parameters.len(), given.name_span);
                    continue;
                }
                false => {
                    let is_own = |name: &str| !self.program.globals.is_shared_input(key, name);
                    parameters.iter().position(|parameter| fold(&parameter.name) == folded && is_own(&parameter.name))
                }
            };
            let Some(index) = index else {
                // `time_type := Time` names the type of an instruction of the TIA Portal; all instructions here have one.
                if names_a_type(given) {
                    continue;
                }
                good = false;
                let supplied: Vec<&str> = call.parameters.iter().map(|other| other.name.as_str()).collect();
                let name = (given.name.as_str(), given.name_span);
                misspelt.push(self.program.unknown_parameter(key, bound, name, &supplied).unwrap_or_default());
                continue;
            };
            if let Some(first) = seen.insert(index, given.name_span) {
                good = false;
                self.program.report(
                    Diagnostic::new(
                        Code::DuplicateParameter,
                        given.name_span,
                        format!("the parameter `{}` is given twice", parameters[index].name),
                    )
                    .label("the second time")
                    .also(first, "the first time"),
                );
                continue;
            }
            let Some(actual) = &given.actual else {
                empty.push(index);
                continue;
            };
            let bound = match given.name.is_empty() {
                true => self.bind_positional(ctx, key, &parameters[index], actual),
                false => self.bind_actual(ctx, key, &parameters[index], actual),
            };
            match bound {
                Some(bound) => arguments.push(Argument { parameter: index, actual: bound, span: actual.span }),
                None => good = false,
            }
        }
        if matches!(key.kind, BlockKind::Fc | BlockKind::Sfc) {
            let missing: Vec<&str> = parameters
                .iter()
                .enumerate()
                .filter(|(index, _)| !seen.contains_key(index) || empty.contains(index))
                // The type of the result is not known, which is reported.
                .filter(|(_, parameter)| parameter.name != "RET_VAL" || parameter.ty != DataType::Void)
                .map(|(_, parameter)| parameter.name.as_str())
                .filter(|name| !misspelt.iter().any(|other| other == name))
                .collect();
            // A parameter that the block does not have may be meant as one that is missing.
            let unknown = misspelt.iter().filter(|name| name.is_empty()).count();
            if missing.len() > unknown && !unread {
                good = false;
                let message = Diagnostic::new(
                    Code::MissingParameter,
                    call.target.span,
                    format!("the call of {} omits {}", self.program.globals.shown(key), missing.join(", ")),
                )
                .label("a function needs all its parameters");
                let help = format!("add `{} := …`", missing.join(" := …, "));
                self.program.report(message.help(self.program.globals.with_library_note(key, help)));
            }
        }
        good.then_some(arguments)
    }

    fn surplus_pointer(&mut self, key: BlockKey, count: usize, span: Span) {
        self.program.report(
            Diagnostic::new(
                Code::UnknownParameter,
                span,
                format!(
                    "{} has {}, but the call passes more",
                    self.program.globals.shown(key),
                    counted(count, "parameter")
                ),
            )
            .label("this pointer does not belong to any of them"),
        );
    }

    /// Outputs that overlap other actuals of the call have values that depend on the order of copying.
    pub fn check_overlaps(&mut self, bound: &BoundInterface, arguments: &[Argument]) {
        let ranges: Vec<(&Argument, Direction, Area, u32, u32)> = arguments
            .iter()
            .filter_map(|argument| {
                let parameter = &bound.interface.parameters[argument.parameter];
                let Passing::Elementary(width) = parameter.passing else { return None };
                let (area, bits) = match argument.actual.pointer() {
                    Actual::Place(place) => area_bits(place)?,
                    Actual::Const(_)
                    | Actual::Number(_)
                    | Actual::PointerBytes(_)
                    | Actual::PointerTo { .. }
                    | Actual::PointerCopy(_)
                    | Actual::Variant(..) => return None,
                };
                Some((argument, parameter.direction, area, bits, bits + width.bits()))
            })
            .collect();
        for (at, (first, first_direction, area, start, end)) in ranges.iter().enumerate() {
            for (second, second_direction, other_area, other_start, other_end) in &ranges[at + 1..] {
                let same = (start, end) == (other_start, other_end);
                let outputs =
                    (*first_direction != Direction::Input) as u8 + (*second_direction != Direction::Input) as u8;
                let clash = area == other_area && start < other_end && other_start < end;
                if clash && outputs > 0 && !(same && outputs == 1) {
                    let name = &bound.interface.parameters[first.parameter].name;
                    self.program.report(
                        Diagnostic::new(Code::OverlappingActuals, second.span, "two actual parameters overlap")
                            .label("these bytes are also part of another actual")
                            .also(first.span, format!("the actual of `{name}`"))
                            .help("give each output its own address"),
                    );
                }
            }
        }
    }
}

/// The name by which a call may mean an instruction: without quotes, and not that of an instance in the block itself.
fn instruction_name<'c>(ctx: &CurrentBlock, call: &'c ast::Call) -> Option<&'c str> {
    let OperandKind::Path(Path { root: PathRoot::Bare { name, .. }, parts, .. }) = &call.target.kind else {
        return None;
    };
    let own = call.instance.is_none() && ctx.bound.locals.contains_key(&fold(name));
    (parts.is_empty() && !own).then_some(name.as_str())
}

/// Memory that addresses name directly, to compare places.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Area {
    I,
    Q,
    M,
    L,
    Db(u16),
    Instance,
}

/// Area and first bit of a place with a known address.
fn area_bits(place: &Place) -> Option<(Area, u32)> {
    let (area, byte, bit) = match place {
        Place::I { byte, bit } => (Area::I, byte, bit),
        Place::Q { byte, bit } => (Area::Q, byte, bit),
        Place::M { byte, bit } => (Area::M, byte, bit),
        Place::L { byte, bit } => (Area::L, byte, bit),
        Place::Db { number, byte, bit } => (Area::Db(*number), byte, bit),
        Place::Instance { byte, bit } => (Area::Instance, byte, bit),
        Place::Pi { .. }
        | Place::Pq { .. }
        | Place::OpenDb { .. }
        | Place::OpenDi { .. }
        | Place::Parameter { .. }
        | Place::ThroughPointer { .. }
        | Place::Indirect { .. }
        | Place::Register { .. }
        | Place::Element { .. } => return None,
    };
    Some((area, byte * 8 + u32::from(*bit)))
}

fn callable(prefix: BlockPrefix) -> Option<BlockKind> {
    code_kind(prefix).filter(|kind| *kind != BlockKind::Ob)
}
