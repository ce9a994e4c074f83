//! IEC timers and counters in SCL that two calls of one list of statements share, with different inputs.

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::{Actual, Call, ExprKind, Instance, Statement, StatementKind};
use plcc_syntax::Elementary;
use rustc_hash::FxHashMap;

use crate::bind::declarations::Declarations;
use plcc_binding::fold;

/// Reports the second call of an instance in `list`, and in the lists inside it.
pub fn review(program: &Declarations, list: &[Statement], found: &mut Vec<Diagnostic>) {
    let text = |span| program.globals.text(span);
    // By instance: the inputs of the call, and its place.
    let mut calls: FxHashMap<String, (String, Span)> = FxHashMap::default();
    for statement in list {
        match &statement.kind {
            StatementKind::Call(call) => {
                let Some(instance) = timed_instance(program, call) else { continue };
                let Some(inputs) = inputs(call, &text) else {
                    // A constant input resets the instance for the next call.
                    calls.remove(&instance);
                    continue;
                };
                let Some((other, first)) = calls.insert(instance, (inputs.clone(), call.span)) else { continue };
                if other != inputs {
                    let name = text(call.span).split('(').next().unwrap_or_default().trim().to_string();
                    found.push(
                        Diagnostic::new(
                            Code::InstanceUse,
                            call.span,
                            format!("the instance `{name}` runs twice in a cycle"),
                        )
                        .label("runs with other inputs here")
                        .also(first, "already runs here")
                        .help("declare an instance for each of the two; you can read its outputs as often as you like"),
                    );
                }
            }
            // A cycle of a test ends, or the program comes from elsewhere.
            StatementKind::Assert(_)
            | StatementKind::Sleep(_)
            | StatementKind::Label(_)
            | StatementKind::Goto(_)
            | StatementKind::Return(_) => calls.clear(),
            other => other.bodies().into_iter().for_each(|body| review(program, body, found)),
        }
    }
}

/// The instance of a call of an IEC timer or counter, if it is the same one in each call.
fn timed_instance(program: &Declarations, call: &Call) -> Option<String> {
    const TIMED: [&str; 7] = ["TP", "TON", "TOF", "TONR", "CTU", "CTD", "CTUD"];
    if call.target.kind != BlockKind::Sfb || call.enable.is_some() {
        return None;
    }
    let name = program.globals.library_block(call.target)?.name;
    if !TIMED.contains(&name.split('_').next().unwrap_or_default()) {
        return None;
    }
    match call.instance.as_ref()? {
        Instance::Db(number) => Some(format!("db {number}")),
        Instance::Variable(access) if access.indices.is_empty() => Some(fold(&program.globals.text(access.span))),
        Instance::Variable(_) => None,
    }
}

/// The BOOL inputs of a call as written; none if there are none, or if one of them is a constant.
fn inputs(call: &Call, text: &dyn Fn(Span) -> String) -> Option<String> {
    let mut written = String::new();
    for argument in &call.arguments {
        let Actual::Value(value) = &argument.actual else { continue };
        if value.ty != Elementary::Bool {
            continue;
        }
        if matches!(value.kind, ExprKind::Const(_)) {
            return None;
        }
        written.push_str(&text(argument.span));
        written.push(',');
    }
    (!written.is_empty()).then_some(written)
}
