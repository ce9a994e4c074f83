//! IEC timers in SCL whose time nothing sets, and in SCL, LAD and FBD those whose time is negative: both are T#0S, so that they have run
//! out at once.

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, SourceMap, Span};
use plcc_model::scl::{Access, Actual, Call, Expr, ExprKind, Instance, walk};
use plcc_model::types::{DataType, Elementary};
use plcc_model::{BlockKey, Body, CodeBlock};
use rustc_hash::{FxHashMap, FxHashSet};

use super::Language;
use crate::bind::declarations::{Declarations, State};
use plcc_binding::fold;

/// The input that has the time.
const TIME: &str = "PT";

/// Reports calls of timers with a negative time, and those without `PT` if no call of that instance has it and the program sets no
/// component PT. `sources`: as they were read.
pub fn review(
    program: &Declarations,
    blocks: &[(&CodeBlock, Language)],
    sources: &SourceMap,
    found: &mut Vec<Diagnostic>,
) {
    let mut timed: FxHashSet<(Option<BlockKey>, String)> = FxHashSet::default();
    let mut bare: Vec<(Option<BlockKey>, String, Span)> = Vec::new();
    for (block, language) in blocks {
        let Body::Scl(body) = &block.body else { continue };
        if !matches!(language, Language::Scl | Language::Networks) {
            continue;
        }
        let mut calls = Calls { program, found: Vec::new(), negative: Vec::new(), other_uses: FxHashMap::default() };
        walk::statements(&body.statements, &mut calls);
        found.extend(calls.negative.into_iter().map(|span| negative(program, span)));
        // An open pin of a box is drawn as such.
        if *language == Language::Networks {
            continue;
        }
        for (instance, has_time, span) in calls.found {
            // A block that gets the timer may give it a time.
            let has_time = has_time || calls.other_uses.get(&instance).is_some_and(|uses| *uses > 0);
            // `#t` is another variable in each block.
            let own = (!instance.starts_with('"') && !instance.starts_with("db")).then(|| block.key());
            match has_time {
                true => drop(timed.insert((own, instance))),
                false => bare.push((own, instance, span)),
            }
        }
    }
    bare.retain(|(own, instance, _)| !timed.contains(&(*own, instance.clone())));
    if bare.is_empty() || sets_a_time(sources) {
        return;
    }
    let mut told = FxHashSet::default();
    for (own, instance, span) in bare {
        let name = program.globals.text(span);
        let name = name.split('(').next().unwrap_or("").trim().to_string();
        if told.insert((own, instance)) {
            found.push(
                Diagnostic::new(Code::TimerWithoutTime, span, format!("the timer `{name}` has no time"))
                    .label("without `PT` the time is T#0S: it has run out at once")
                    .help("give `PT := …` in the call, with the time as `T#…`"),
            );
        }
    }
}

/// The warning about the negative time at `span`.
fn negative(program: &Declarations, span: Span) -> Diagnostic {
    let written = program.globals.text(span);
    let help = match written.contains("#-") {
        true => format!("write `{}`", written.replacen('-', "", 1).trim()),
        false => "write a time above zero".to_owned(),
    };
    Diagnostic::new(Code::TimerWithoutTime, span, format!("the time of a timer is not negative, as `{written}` is"))
        .label("as `T#0S`: the timer has run out at once")
        .help(help)
}

/// Whether a value is a constant below zero.
fn is_negative(value: &Expr) -> bool {
    match (&value.kind, value.ty) {
        (ExprKind::Const(bits), Elementary::Time) => (*bits as u32).cast_signed() < 0,
        (ExprKind::Const(bits), Elementary::Ltime) => bits.cast_signed() < 0,
        _ => false,
    }
}

/// Whether a source names a component PT, as in `#t.PT := #delay` and `t : TON := (PT := T#5S)`, gives it a start value in an export,
/// or has PRESET_TIMER.
fn sets_a_time(sources: &SourceMap) -> bool {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    sources.files().any(|(_, file)| {
        let upper = file.text.to_ascii_uppercase();
        let ends = |rest: &str| !rest.starts_with(is_word);
        upper.contains("PRESET_TIMER")
            || [".PT", ".\"PT", "(PT", "#PT", "( PT"]
                .iter()
                .any(|form| upper.match_indices(form).any(|(at, found)| ends(&upper[at + found.len()..])))
            || upper
                .match_indices(TIME)
                .any(|(at, found)| !upper[..at].ends_with(is_word) && is_start_value(&upper[at + found.len()..]))
    })
}

/// Whether a time above zero comes next, after blanks alone: the start value of a member in the overlay of an export.
fn is_start_value(rest: &str) -> bool {
    let value = rest.trim_start();
    let value = if value.len() < rest.len() { value.split_whitespace().next().unwrap_or_default() } else { "" };
    let is_time = ["T#", "TIME#", "LT#", "LTIME#"].iter().any(|prefix| value.starts_with(prefix));
    is_time && value.contains(|c: char| matches!(c, '1'..='9'))
}

/// Calls of timers: the instance as written, whether PT is given, the place.
struct Calls<'p, 'i> {
    program: &'p Declarations<'i>,
    found: Vec<(String, bool, Span)>,
    /// Negative times.
    negative: Vec<Span>,
    /// How often a structure is named as a whole, except as the instance of a call of a timer.
    other_uses: FxHashMap<String, i32>,
}

impl walk::Visitor for Calls<'_, '_> {
    fn access(&mut self, access: &Access, _role: walk::Role) {
        if matches!(access.ty, DataType::Struct(_)) {
            *self.other_uses.entry(fold(&self.program.globals.text(access.span))).or_default() += 1;
        }
    }

    fn call(&mut self, call: &Call) {
        if call.target.kind != BlockKind::Sfb {
            return;
        }
        let Some(block) = self.program.globals.library_block(call.target) else { return };
        let name = block.name.split('_').next().unwrap_or_default();
        if !["TP", "TON", "TOF", "TONR"].contains(&name) {
            return;
        }
        let Some(State::Done(Some(bound))) = self.program.interfaces.get(&call.target) else { return };
        let is_time = |parameter: usize| {
            let formal = bound.interface.parameters.get(parameter);
            formal.is_some_and(|formal| formal.name.eq_ignore_ascii_case(TIME))
        };
        let time = call.arguments.iter().find(|argument| is_time(argument.parameter));
        if let Some(Actual::Value(value)) = time.map(|argument| &argument.actual)
            && is_negative(value)
        {
            self.negative.push(value.span);
        }
        let instance = match &call.instance {
            Some(Instance::Db(number)) => format!("db {number}"),
            // An element of an array may be any of them.
            Some(Instance::Variable(access)) if access.indices.is_empty() => {
                let text = fold(&self.program.globals.text(access.span));
                *self.other_uses.entry(text.clone()).or_default() -= 1;
                text
            }
            Some(Instance::Variable(_)) | None => return,
        };
        self.found.push((instance, time.is_some(), call.span));
    }
}
