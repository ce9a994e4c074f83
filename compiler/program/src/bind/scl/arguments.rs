//! The list of arguments of a block call: which parameter each supplies, and what is missing.
//!
//! Source: SCL reference, parameters. Named in any order, or all by position; EN and ENO belong to every block.

use std::rc::Rc;

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_syntax::Elementary;
use plcc_syntax::count::counted;
use plcc_syntax::scl::ast::{Argument as Given, Expr as Node, Name};
use rustc_hash::FxHashMap;

use super::call::is_result;
use super::{Intent, Rules};
use crate::bind::declarations::typed::BoundInterface;
use crate::bind::scl::{SclBinder, SclBlock};
use crate::bind::trees::SYSTEM_FILE;
use plcc_binding::fold;
use plcc_model::scl::{Access, Actual, Argument, Expr, ExprKind};
use plcc_model::types::DataType;
use plcc_model::{BlockKey, Direction, Parameter};

/// The bound arguments of a call.
#[derive(Default)]
pub struct Arguments {
    /// In source order.
    pub arguments: Vec<Argument>,
    pub enable: Option<Expr>,
    pub eno: Option<Access>,
}

impl SclBinder<'_, '_> {
    /// Binds the arguments of a call of `key`; `name` is the callee in the text.
    pub fn arguments(
        &mut self,
        ctx: &mut SclBlock,
        key: BlockKey,
        bound: &Rc<BoundInterface>,
        given: &[Given],
        name: Span,
    ) -> Option<Arguments> {
        let parameters = &bound.interface.parameters;
        let mut list = Arguments::default();
        let mut seen: FxHashMap<usize, Span> = FxHashMap::default();
        // Parameters given under a misspelt name: that they are missing is already reported.
        let mut misspelt: Vec<String> = Vec::new();
        let mut good = true;
        let positions = match given.iter().all(|argument| argument.name.is_none()) {
            true => Some(self.positions(ctx, key, parameters, given, name)?),
            false => None,
        };
        for (at, argument) in given.iter().enumerate() {
            let index = match (&positions, &argument.name) {
                (Some(positions), _) => positions[at],
                (None, Some(formal)) => match self.formal(key, bound, formal, argument.output, given) {
                    Formal::Parameter(index) => index,
                    Formal::Enable => {
                        good &= self.enable(ctx, &mut list, argument).is_some();
                        continue;
                    }
                    Formal::Eno => {
                        good &= self.eno(ctx, &mut list, argument).is_some();
                        continue;
                    }
                    Formal::Unknown(meant) => {
                        good = false;
                        misspelt.push(meant.unwrap_or_default());
                        self.note_arguments(ctx, std::slice::from_ref(argument));
                        continue;
                    }
                },
                (None, None) => {
                    good = false;
                    misspelt.push(String::new());
                    let open = self.open_input(key, parameters, given, at);
                    self.mixed_arguments(argument.span, open);
                    continue;
                }
            };
            let formal = &parameters[index];
            let span = argument.name.as_ref().map_or(argument.span, |name| name.span);
            if let Some(first) = seen.get(&index) {
                good = false;
                self.program.report(
                    Diagnostic::new(
                        Code::DuplicateParameter,
                        span,
                        format!("the parameter `{}` is given twice", formal.name),
                    )
                    .label("the second time")
                    .also(*first, "the first time"),
                );
                continue;
            }
            if argument.output && formal.direction == Direction::Input {
                good = false;
                self.wrong_arrow(key, formal, argument);
            }

            let Some(value) = &argument.value else {
                if argument.output || formal.direction == Direction::Output {
                    seen.insert(index, span);
                    if is_function(key) {
                        list.arguments.push(Argument { parameter: index, actual: Actual::Dropped, span });
                    }
                }
                continue;
            };
            seen.insert(index, span);
            match self.actual(ctx, key, formal, value) {
                Some(actual) => {
                    let named = argument.name.is_some() && ctx.scope.rules != Rules::Classic;
                    // A pointer is handed over with either sign.
                    let is_value = matches!(formal.ty, DataType::Elementary(_));
                    if named && !argument.output && is_value && formal.direction == Direction::Output {
                        self.output_with_assign(key, formal, argument);
                    }
                    if argument.output && formal.direction == Direction::InOut && argument.span.file != SYSTEM_FILE {
                        self.in_out_with_arrow(key, formal, argument);
                    }
                    list.arguments.push(Argument { parameter: index, actual, span: value.span });
                }
                None => good = false,
            }
        }
        if is_function(key) {
            good &= self.check_missing(ctx, key, parameters, &seen, &misspelt, name, &mut list);
        }
        good.then_some(list)
    }

    /// The meaning of an argument's name.
    fn formal(&mut self, key: BlockKey, bound: &BoundInterface, name: &Name, output: bool, given: &[Given]) -> Formal {
        let folded = fold(&name.text);
        let instance = matches!(key.kind, BlockKind::Sfb).then_some((true, key.number));
        let own = plcc_stdlib::own_member(instance, &name.text).map_or_else(|| folded.clone(), fold);
        // `RET_VAL => x`, as the TIA Portal writes some instructions whose value it shows as an output.
        let result = bound.interface.parameters.iter().position(|parameter| is_result(key, parameter));
        if let (true, "ret_val", Some(result)) = (output, folded.as_str(), result) {
            return Formal::Parameter(result);
        }
        let is_own = |name: &str| !self.program.globals.is_shared_input(key, name);
        let found = bound.interface.parameters.iter().position(|parameter| {
            fold(&parameter.name) == own && !is_result(key, parameter) && is_own(&parameter.name)
        });
        match (found, folded.as_str()) {
            (Some(index), _) => Formal::Parameter(index),
            (None, "en") => Formal::Enable,
            (None, "eno") => Formal::Eno,
            (None, "ret_val") if bound.interface.parameters.iter().any(|parameter| is_result(key, parameter)) => {
                self.program.report(
                    Diagnostic::new(Code::UnknownParameter, name.span, "RET_VAL is the value of the call")
                        .label("no parameter in SCL")
                        .help("write `result := Name(...);`"),
                );
                Formal::Unknown(None)
            }
            _ => {
                let supplied: Vec<&str> =
                    given.iter().filter_map(|other| other.name.as_ref()).map(|other| other.text.as_str()).collect();
                Formal::Unknown(self.program.unknown_parameter(key, bound, (&name.text, name.span), &supplied))
            }
        }
    }

    /// The parameters that arguments without names supply.
    fn positions(
        &mut self,
        ctx: &mut SclBlock,
        key: BlockKey,
        parameters: &[Parameter],
        given: &[Given],
        name: Span,
    ) -> Option<Vec<usize>> {
        let all: Vec<usize> = (0..parameters.len())
            .filter(|&index| {
                let parameter = &parameters[index];
                !is_result(key, parameter) && !self.program.globals.is_shared_input(key, &parameter.name)
            })
            .collect();
        let inputs: Vec<usize> =
            all.iter().copied().filter(|&index| parameters[index].direction == Direction::Input).collect();
        if given.is_empty() || given.len() == inputs.len() {
            return Some(inputs);
        }
        if given.len() == all.len() {
            return Some(all);
        }
        let names: Vec<&str> = all.iter().map(|&index| parameters[index].name.as_str()).collect();
        let code = if given.len() > all.len() { Code::SurplusOperand } else { Code::MissingParameter };
        let help = match names.is_empty() {
            true => "the block has no parameters".to_string(),
            false => format!("name them: its parameters are {}", names.join(", ")),
        };
        let message = Diagnostic::new(
            code,
            name,
            format!(
                "{} {} {}",
                counted(given.len(), "argument"),
                if given.len() == 1 { "does not fit" } else { "do not fit" },
                self.program.globals.shown(key)
            ),
        )
        .label(format!("it has {}, {} of them inputs", counted(all.len(), "parameter"), inputs.len()))
        .help(self.program.globals.with_library_note(key, help));
        self.program.report(message);
        self.note_arguments(ctx, given);
        None
    }

    /// The parameter that the argument at `at`, which has no name, may be meant for: those that the call does not name belong to the
    /// arguments without a name, in their order.
    fn open_input<'p>(
        &self,
        key: BlockKey,
        parameters: &'p [Parameter],
        given: &[Given],
        at: usize,
    ) -> Option<&'p str> {
        let before = given[..at].iter().filter(|argument| argument.name.is_none()).count();
        let named = |formal: &str| {
            given.iter().filter_map(|other| other.name.as_ref()).any(|name| fold(&name.text) == fold(formal))
        };
        let mut open = parameters.iter().filter(|formal| {
            formal.direction != Direction::Output
                && !named(&formal.name)
                && !self.program.globals.is_shared_input(key, &formal.name)
        });
        open.nth(before).map(|formal| formal.name.as_str())
    }

    /// An argument without a name in a call that names others; `pin`: the input that it may be meant for.
    pub(super) fn mixed_arguments(&mut self, span: Span, pin: Option<&str>) {
        let text = self.program.globals.text(span);
        let help = match (text.split_once('='), pin) {
            (Some((name, value)), _) if !name.contains([':', '<', '>']) => {
                format!("a parameter is supplied with `:=`: write `{} := {}`", name.trim(), value.trim())
            }
            (_, Some(pin)) => format!("write `{pin} := {text}`"),
            (_, None) => format!("remove `{text}`: all inputs have their values"),
        };
        self.program.report(
            Diagnostic::new(Code::MissingOperand, span, "this argument names no parameter")
                .label("others of this call are named")
                .help(help),
        );
    }

    fn wrong_arrow(&mut self, key: BlockKey, formal: &Parameter, argument: &Given) {
        let given = argument.value.as_ref().map_or("…".to_string(), |value| self.program.globals.text(value.span));
        self.program.report(
            Diagnostic::new(
                Code::AssignSign,
                argument.span,
                format!("`{}` of {} is an input", formal.name, self.program.globals.shown(key)),
            )
            .label("`=>` is for outputs of the block")
            .help(format!("write `{} := {given}`", formal.name)),
        );
    }

    /// `Q := x` for an output, which STEP 7 V5 writes like that for functions.
    fn output_with_assign(&mut self, key: BlockKey, formal: &Parameter, argument: &Given) {
        let given = argument.value.as_ref().map_or("…".to_string(), |value| self.program.globals.text(value.span));
        let title = format!("`{}` of {} is an output", formal.name, self.program.globals.shown(key));
        self.program.report(
            Diagnostic::new(Code::Tolerated, argument.span, title)
                .label("read as `=>`")
                .help(format!("write `{} => {given}`", formal.name)),
        );
    }

    /// `c => x` for an in/out parameter.
    fn in_out_with_arrow(&mut self, key: BlockKey, formal: &Parameter, argument: &Given) {
        let given = argument.value.as_ref().map_or("…".to_string(), |value| self.program.globals.text(value.span));
        let title = format!("`{}` of {} is an in/out parameter", formal.name, self.program.globals.shown(key));
        self.program.report(
            Diagnostic::new(Code::Tolerated, argument.span, title)
                .label("read as `:=`")
                .help(format!("write `{} := {given}`; `=>` is for outputs", formal.name)),
        );
    }

    /// `EN := condition`.
    fn enable(&mut self, ctx: &mut SclBlock, list: &mut Arguments, argument: &Given) -> Option<()> {
        let value = argument.value.as_ref()?;
        list.enable = Some(self.of_type(ctx, value, Elementary::Bool)?);
        Some(())
    }

    /// `ENO => variable`.
    fn eno(&mut self, ctx: &mut SclBlock, list: &mut Arguments, argument: &Given) -> Option<()> {
        // `ENO => ENO` changes nothing in a block that uses ENO.
        let Some(value) = argument.value.as_ref().filter(|value| !names_eno(ctx, value)) else { return Some(()) };
        list.eno = Some(self.variable_of_type(ctx, value, Elementary::Bool, Intent::Write)?);
        Some(())
    }

    /// Parameters of a function that the call omits.
    #[allow(clippy::too_many_arguments)]
    fn check_missing(
        &mut self,
        ctx: &SclBlock,
        key: BlockKey,
        parameters: &[Parameter],
        seen: &FxHashMap<usize, Span>,
        misspelt: &[String],
        name: Span,
        list: &mut Arguments,
    ) -> bool {
        let rules = ctx.scope.rules;
        let mut missing: Vec<&str> = Vec::new();
        let mut dropped: Vec<&str> = Vec::new();
        for (index, formal) in parameters.iter().enumerate() {
            if seen.contains_key(&index) || is_result(key, formal) || misspelt.contains(&formal.name) {
                continue;
            }
            match formal.direction {
                Direction::Output if rules != Rules::Classic => {
                    dropped.push(&formal.name);
                    list.arguments.push(Argument { parameter: index, actual: Actual::Dropped, span: name });
                }
                Direction::Input if is_optional(key, &formal.name) => {
                    // If omitted, it is 0.
                    if let DataType::Elementary(ty) = formal.ty {
                        let zero = Expr { kind: ExprKind::Const(0), ty, span: name };
                        list.arguments.push(Argument { parameter: index, actual: Actual::Value(zero), span: name });
                    }
                }
                Direction::Input | Direction::Output | Direction::InOut => missing.push(&formal.name),
            }
        }
        if !dropped.is_empty() && misspelt.is_empty() {
            let mut message = Diagnostic::new(
                Code::MissingParameter,
                name,
                format!("the call of {} does not use {}", self.program.globals.shown(key), dropped.join(", ")),
            )
            .label("the value of this output is lost")
            .help(format!("add `{} => ...`; leave `=>` empty if you do not need the value", dropped[0]));
            message.severity = Severity::Warning;
            self.program.report(message);
        }
        // A parameter that the block does not have may be meant as one that is missing.
        let unknown = misspelt.iter().filter(|name| name.is_empty()).count();
        if missing.len() <= unknown {
            return missing.is_empty();
        }
        let help = format!("add `{} := …`", missing.join(" := …, "));
        let title = format!("the call of {} omits {}", self.program.globals.shown(key), missing.join(", "));
        let message = Diagnostic::new(Code::MissingParameter, name, title)
            .label("a function needs all its parameters")
            .help(self.program.globals.with_library_note(key, help));
        self.program.report(message);
        false
    }

    /// A variable of an elementary type, or of the bit string with its width.
    pub fn variable_of_type(
        &mut self,
        ctx: &mut SclBlock,
        node: &Node,
        ty: Elementary,
        intent: Intent,
    ) -> Option<Access> {
        let access = self.access(ctx, node, intent)?;
        let found = access.elementary();
        let fits = found.is_some_and(|found| found.bits() == ty.bits());
        if !fits {
            let is = found.map_or_else(|| plcc_model::layout::type_name(&access.ty), |found| found.name().to_string());
            self.wrong_type(node.span, &format!("of type {is}"), ty.name(), None);
            return None;
        }
        Some(access)
    }
}

/// Inputs of ATTACH and DETACH that a call may omit. Source: LAD/FBD reference for S7-1200, ATTACH and DETACH.
fn is_optional(key: BlockKey, name: &str) -> bool {
    const OPTIONAL: [(&str, &str); 2] = [("ATTACH", "ADD"), ("DETACH", "EVENT")];
    let of = |block: &str| plcc_stdlib::find_tia(block).is_some_and(|found| found.number == key.number);
    key.kind == BlockKind::Sfc && OPTIONAL.iter().any(|(block, parameter)| *parameter == name && of(block))
}

enum Formal {
    Parameter(usize),
    Enable,
    Eno,
    /// Reported; the name that is meant.
    Unknown(Option<String>),
}

/// True of blocks without memory: their parameters are all needed.
pub const fn is_function(key: BlockKey) -> bool {
    matches!(key.kind, BlockKind::Fc | BlockKind::Sfc)
}

/// True if a node is the predefined name ENO or OK.
pub fn names_eno(ctx: &SclBlock, node: &Node) -> bool {
    use plcc_syntax::scl::ast::{ExprKind, NameForm};
    match &node.kind {
        ExprKind::Name(name) => {
            let folded = fold(&name.text);
            name.form == NameForm::Bare
                && matches!(folded.as_str(), "eno" | "ok")
                && !ctx.block.bound.locals.contains_key(&folded)
        }
        _ => false,
    }
}
