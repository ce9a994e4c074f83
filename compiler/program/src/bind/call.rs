//! `CALL`: target, instance and the list of parameters.

use std::rc::Rc;

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{self, BlockPrefix, OperandKind};
use rustc_hash::FxHashMap;

use super::declare::BoundInterface;
use super::names::code_kind;
use super::path::Base;
use super::settle::Settled;
use super::{Binder, Ctx};
use plcc_binding::fold;
use plcc_binding::similar;
use plcc_model::types::DataType;
use plcc_model::{Actual, Argument, BlockKey, Call, Direction, Instance, Number, Passing, Place};

/// Instance memory, identified across the whole program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum InstanceId {
    Db(u16),
    /// In the instances of a block, at a byte.
    Multi(BlockKey, u32),
}

/// Calls of an instance and one of its pointer parameters.
pub struct PointerUse {
    supplied: bool,
    /// The first call.
    span: Span,
    block: BlockKey,
    parameter: String,
    /// Where the pointer or number is in the instance.
    byte: u32,
    bytes: u32,
}

impl Binder<'_> {
    pub fn bind_call(&mut self, ctx: &mut Ctx, call: &ast::Call, span: Span) -> Option<Call> {
        let Some((key, multi, bound)) = self.call_target(ctx, call) else {
            self.note_names(ctx, call);
            return None;
        };
        let instance = self.instance(ctx, call, key, multi);
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
            };
            let supplied: Vec<usize> = arguments.iter().map(|argument| argument.parameter).collect();
            self.note_pointers(id, key, &bound, &supplied, span);
        }
        Some(Call { target: key, instance, arguments })
    }

    /// The block of a call, the place of a multi-instance, and the interface; `None` after a message.
    fn call_target(&mut self, ctx: &mut Ctx, call: &ast::Call) -> Option<(BlockKey, Option<u32>, Rc<BoundInterface>)> {
        let span = call.target.span;
        let (key, multi) = match self.settle(ctx, &call.target)? {
            Settled::Block { prefix, number: Number::Known(number) } if callable(prefix).is_some() => {
                (BlockKey { kind: callable(prefix)?, number }, None)
            }
            Settled::Complex(variable) => match (&variable.ty, variable.base) {
                (DataType::Struct(structure), Base::Instance) if structure.instance_of.is_some() => {
                    let (sfb, number) = structure.instance_of?;
                    let kind = if sfb { BlockKind::Sfb } else { BlockKind::Fb };
                    (BlockKey { kind, number }, Some(variable.byte))
                }
                _ => return self.not_callable(span),
            },
            _ => return self.not_callable(span),
        };
        let bound = self.interface(key, span)?;
        let names = call.parameters.iter().map(|parameter| parameter.name.as_str());
        if self.is_own_of_program(key, &bound, names, span) {
            return None;
        }
        Some((key, multi, bound))
    }

    /// Names in a call that cannot be checked are still looked up, so that all undefined ones are reported.
    fn note_names(&mut self, ctx: &mut Ctx, call: &ast::Call) {
        let actuals = call.parameters.iter().filter_map(|parameter| parameter.actual.as_ref());
        for operand in call.instance.iter().chain(actuals) {
            if !matches!(operand.kind, OperandKind::Block(_)) {
                self.settle(ctx, operand);
            }
        }
    }

    fn not_callable<T>(&mut self, span: Span) -> Option<T> {
        let text = self.text(span);
        self.report.push(
            Diagnostic::new(Code::OperandKind, span, format!("`CALL` calls a block, but `{text}` is not a block"))
                .label("an FC, FB, SFC, SFB or a multi-instance is expected here")
                .help("to call a block whose number is only known at run time, use `UC FC [MW 10]`"),
        );
        None
    }

    /// The instance of a call; the outer `None` after a message.
    fn instance(
        &mut self,
        ctx: &mut Ctx,
        call: &ast::Call,
        key: BlockKey,
        multi: Option<u32>,
    ) -> Option<Option<Instance>> {
        let needs = matches!(key.kind, BlockKind::Fb | BlockKind::Sfb);
        let Some(operand) = &call.instance else {
            if let Some(byte) = multi {
                return Some(Some(Instance::Multi { byte }));
            }
            if needs {
                self.report.push(
                    Diagnostic::new(
                        Code::MissingOperand,
                        call.target.span,
                        format!("the call of {key} names no instance data block"),
                    )
                    .label("a function block keeps its data in a DB")
                    .help(format!("write `CALL {key} , DB 10`")),
                );
                return None;
            }
            return Some(None);
        };
        if multi.is_some() || !needs {
            self.report.push(
                Diagnostic::new(Code::SurplusOperand, operand.span, "this call cannot have an instance data block")
                    .label(if needs {
                        "a multi-instance is in the data of its block"
                    } else {
                        "a function has no instance"
                    })
                    .help("remove the data block"),
            );
            return None;
        }
        let number = match self.settle(ctx, operand)? {
            Settled::Block { prefix: BlockPrefix::Db, number: Number::Known(number) } if number != 0 => number,
            _ => {
                let text = self.text(operand.span);
                self.report.push(
                    Diagnostic::new(Code::OperandKind, operand.span, format!("`{text}` is not a data block"))
                        .label("the instance data block is expected here"),
                );
                return None;
            }
        };
        self.check_instance_db(key, number, operand.span)?;
        Some(Some(Instance::Db(number)))
    }

    /// Checks that a data block is an instance of a function block.
    pub fn check_instance_db(&mut self, key: BlockKey, number: u16, span: Span) -> Option<()> {
        let Some(db) = self.dbs.get(&number) else {
            // The DB has its own error.
            return None;
        };
        if db.block.instance_of != Some(key) {
            let (other, defined) = (db.block.instance_of, db.block.span);
            let what = match other {
                Some(other) => format!("DB {number} is an instance of {other}"),
                None => format!("DB {number} is a shared data block"),
            };
            self.report.push(
                Diagnostic::new(Code::NoBlockFits, span, format!("DB {number} is not an instance of {key}"))
                    .label(what)
                    .also(defined, "the data block")
                    .help(format!("name a data block of {key}; if it is not defined, plcc creates it for the call")),
            );
            return None;
        }
        Some(())
    }

    fn call_arguments(
        &mut self,
        ctx: &mut Ctx,
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
        for (at, given) in call.parameters.iter().enumerate() {
            let folded = fold(&given.name);
            let index = match given.name.is_empty() {
                // Pointers in the order of the interface.
                true if at < parameters.len() => Some(at),
                true => {
                    good = false;
                    self.surplus_pointer(key, parameters.len(), given.name_span);
                    continue;
                }
                false => parameters.iter().position(|parameter| fold(&parameter.name) == folded),
            };
            let Some(index) = index else {
                // `time_type := Time` names the type of an instruction of the TIA Portal; all instructions here have one.
                if super::move_call::names_a_type(given) {
                    continue;
                }
                good = false;
                misspelt.extend(self.unknown_parameter(key, bound, (&given.name, given.name_span)));
                continue;
            };
            if let Some(first) = seen.insert(index, given.name_span) {
                good = false;
                self.report.push(
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
                .map(|(_, parameter)| parameter.name.as_str())
                .filter(|name| !misspelt.iter().any(|other| other == name))
                .collect();
            if !missing.is_empty() {
                good = false;
                let message = Diagnostic::new(
                    Code::MissingParameter,
                    call.target.span,
                    format!("the call of {key} omits {}", missing.join(", ")),
                )
                .label("a function needs all its parameters");
                let help = format!("add `{} := ...`", missing[0]);
                self.report.push(message.help(self.with_library_note(key, help)));
            }
        }
        good.then_some(arguments)
    }

    fn surplus_pointer(&mut self, key: BlockKey, count: usize, span: Span) {
        self.report.push(
            Diagnostic::new(
                Code::UnknownParameter,
                span,
                format!("{key} has {count} parameters, but the call passes more"),
            )
            .label("this pointer does not belong to any of them"),
        );
    }

    /// Reports a parameter that the block does not have; returns the one that may be meant.
    pub fn unknown_parameter(
        &mut self,
        key: BlockKey,
        bound: &BoundInterface,
        (name, span): (&str, Span),
    ) -> Option<String> {
        let names = || bound.interface.parameters.iter().map(|parameter| parameter.name.as_str());
        let message = Diagnostic::new(Code::UnknownParameter, span, format!("{key} has no parameter `{name}`"))
            .label("no such parameter");
        let is_static = bound.locals.contains_key(&fold(name));
        let meant = similar(name, names()).filter(|_| !is_static);
        self.report.push(match meant {
            _ if is_static => message.help("it is static or temporary data of the block, which a call cannot supply"),
            Some(other) => message.help(format!("is `{other}` meant?")),
            None => {
                let all: Vec<&str> = names().take(12).collect();
                let help = match all.is_empty() {
                    true => "the block has no parameters".to_string(),
                    false => format!("its parameters are {}", all.join(", ")),
                };
                message.help(self.with_library_note(key, help))
            }
        });
        meant.map(str::to_owned)
    }

    /// Outputs that overlap other actuals of the call have values that depend on the order of copying.
    fn check_overlaps(&mut self, bound: &BoundInterface, arguments: &[Argument]) {
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
                    self.report.push(
                        Diagnostic::new(Code::OverlappingActuals, second.span, "two actual parameters overlap")
                            .label("these bytes are also part of another actual")
                            .also(first.span, format!("the actual of `{name}`"))
                            .help("give each output its own address"),
                    );
                }
            }
        }
    }

    /// Notes which pointer parameters the call of an instance supplies.
    pub fn note_pointers(
        &mut self,
        id: InstanceId,
        key: BlockKey,
        bound: &BoundInterface,
        supplied: &[usize],
        span: Span,
    ) {
        for (index, parameter) in bound.interface.parameters.iter().enumerate() {
            let points = match parameter.passing {
                Passing::Number | Passing::Pointer | Passing::Any | Passing::Variant => true,
                Passing::Complex { .. } => parameter.direction == Direction::InOut,
                Passing::Elementary(_) | Passing::OpenArray { .. } => false,
            };
            if !points {
                continue;
            }
            let supplied = supplied.contains(&index);
            let entry = self.pointers.entry((id, index)).or_insert_with(|| PointerUse {
                supplied,
                span,
                block: key,
                parameter: parameter.name.clone(),
                byte: parameter.byte,
                bytes: match parameter.passing {
                    Passing::Number => 2,
                    Passing::Any => 10,
                    _ => 6,
                },
            });
            entry.supplied |= supplied;
        }
    }

    /// Whether the data block gives the parameter a start value.
    fn has_start_value(&self, id: InstanceId, pointer: &PointerUse) -> bool {
        let InstanceId::Db(number) = id else { return false };
        let range = pointer.byte as usize..(pointer.byte + pointer.bytes) as usize;
        let data = self.dbs.get(&number).and_then(|db| db.block.data.get(range));
        // `P#P 0.0 VOID 0`, as STEP 7 writes it, points nowhere.
        data.is_some_and(|bytes| {
            !matches!(bytes, [0x10, 0, ..] | [0, 0, 0x80, 0, 0, 0]) && bytes.iter().any(|byte| *byte != 0)
        })
    }

    /// Warns of pointer parameters that no call of an instance supplies.
    pub fn check_pointers(&mut self) {
        let mut uses: Vec<PointerUse> = std::mem::take(&mut self.pointers)
            .into_iter()
            .filter(|((id, _), pointer)| !pointer.supplied && !self.has_start_value(*id, pointer))
            .map(|(_, pointer)| pointer)
            .collect();
        uses.sort_by_key(|pointer| (pointer.span.file, pointer.span.start));
        for PointerUse { span, block, parameter, .. } in uses {
            self.report.push(
                Diagnostic::new(
                    Code::MissingPointer,
                    span,
                    format!("no call supplies `{parameter}` of {block} for this instance"),
                )
                .label("the parameter points nowhere")
                .help(format!("add `{parameter} := ...` to a call that is executed first")),
            );
        }
    }
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
        | Place::Register { .. } => return None,
    };
    Some((area, byte * 8 + u32::from(*bit)))
}

fn callable(prefix: BlockPrefix) -> Option<BlockKind> {
    code_kind(prefix).filter(|kind| *kind != BlockKind::Ob)
}
