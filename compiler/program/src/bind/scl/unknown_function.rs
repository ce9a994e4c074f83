//! Calls of functions that neither the program nor the language has: what may be meant.

use plcc_binding::report::known_type;
use plcc_binding::{fold, similar};
use plcc_diag::Code;
use plcc_syntax::ast::{BlockPrefix, CellKind};
use plcc_syntax::scl::ast::{Name, NameForm};
use plcc_syntax::symbols::SymbolTarget;

use crate::bind::globals::names::Global;
use crate::bind::scl::SclBinder;
use crate::bind::scl::message::start_of_cell;

impl SclBinder<'_, '_> {
    /// Reports a function that neither the program nor the language has.
    pub(super) fn unknown_function(&mut self, name: &Name) {
        if self.program.globals.missing_instruction(&name.text, name.span) {
            return;
        }
        let (folded, span) = (fold(&name.text), name.span);
        let profile = &self.program.globals.input.profile;
        // A CPU with IEC timers only has no functions that start others.
        let exists = |kind: &CellKind| match kind {
            CellKind::Timer => profile.timers > 0,
            CellKind::Counter => profile.counters > 0,
        };
        if !self.program.globals.input.partial
            && let Some(kind) = cell(name).filter(exists)
        {
            let help = start_of_cell(kind, &name.text);
            let title = format!("`{}` cannot be called", name.text);
            let label = match kind {
                CellKind::Timer => "a timer",
                CellKind::Counter => "a counter",
            };
            self.refuse(Code::OperandKind, span, &title, label, &help);
            return;
        }
        if plcc_stdlib::LIBRARY.iter().any(|block| fold(block.name) == folded) {
            self.program.globals.unknown_name(&name.text, name.span, std::iter::empty());
            return;
        }
        let blocks = || self.program.globals.names.symbols.values();
        let is_fb = |global: &&Global| matches!(global.target, SymbolTarget::Block { prefix: BlockPrefix::Fb, .. });
        let begins =
            |global: &&Global| folded.strip_prefix(&fold(&global.name)).is_some_and(|rest| rest.starts_with('_'));
        if let Some(fb) = blocks().filter(is_fb).filter(begins).max_by_key(|global| global.name.len()) {
            let (name, fb) = (&name.text, &fb.name);
            let help = format!("define the instance: `DATA_BLOCK \"{name}\" \"{fb}\" BEGIN END_DATA_BLOCK`");
            self.program.globals.report.missing_instance(name, fb, span, help);
            return;
        }
        let is_fc = |global: &&Global| matches!(global.target, SymbolTarget::Block { prefix: BlockPrefix::Fc, .. });
        let has_db = |global: &&Global| {
            let rest = folded.strip_prefix(&fold(&global.name)).and_then(|rest| rest.strip_prefix("_db"));
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
        };
        if !self.program.globals.input.partial
            && let Some(function) = blocks().filter(is_fc).find(has_db)
        {
            let title = format!("`{}` is not defined, and a function has no instance", name.text);
            let help = format!("call the function itself: `\"{}\"(…)`", function.name);
            self.refuse(Code::UnknownBlock, span, &title, "a function keeps no data", &help);
            return;
        }
        if let Some(instruction) = instruction_of_instance(&name.text) {
            let name = &name.text;
            let help = format!(
                "define the instance: `DATA_BLOCK \"{name}\" {instruction} BEGIN END_DATA_BLOCK`; if it is a block of your own, add its source"
            );
            self.program.globals.report.missing_instance(name, instruction, span, help);
            return;
        }
        let own = blocks().filter(|global| matches!(global.target, SymbolTarget::Block { .. }));
        let own: Vec<&str> = own.map(|global| global.name.as_str()).collect();
        let shipped = plcc_stdlib::blocks().iter().filter(|block| !block.is_part()).map(|block| block.name);
        // A name in quotes is that of a block of the program.
        let meant = match (similar(&name.text, own.into_iter()), name.form) {
            (Some(own), _) => Some(own.to_owned()),
            (None, NameForm::Quoted) => None,
            (None, NameForm::Bare | NameForm::Local) => {
                let known = similar(&name.text, super::function::names()).or_else(|| similar(&name.text, shipped));
                known.map(str::to_owned).or_else(|| similar_conversion(&name.text))
            }
        };
        self.program.globals.report.missing_function(&name.text, name.span, meant, false);
    }
}

/// The timer or counter that a name without quotes is: `T1`, `C5`, `Z5`.
fn cell(name: &Name) -> Option<CellKind> {
    let number = name.text.get(1..).filter(|_| name.form == NameForm::Bare)?;
    let is_number = !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit());
    match name.text.as_bytes()[0] {
        b'T' | b't' if is_number => Some(CellKind::Timer),
        b'C' | b'c' | b'Z' | b'z' if is_number => Some(CellKind::Counter),
        _ => None,
    }
}

/// The instruction whose data block the TIA Portal names so: `TON_DB`, `R_TRIG_DB_1`, `CTU_2`.
fn instruction_of_instance(name: &str) -> Option<&'static str> {
    const INSTRUCTIONS: [&str; 9] = ["TON", "TOF", "TP", "TONR", "CTU", "CTD", "CTUD", "R_TRIG", "F_TRIG"];
    let rest = |instruction: &str| {
        let head = name.get(..instruction.len()).filter(|head| head.eq_ignore_ascii_case(instruction));
        head.and_then(|_| name[instruction.len()..].strip_prefix('_'))
    };
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    INSTRUCTIONS.into_iter().find(|instruction| {
        rest(instruction).is_some_and(|rest| {
            is_number(rest)
                || rest.get(..2).is_some_and(|db| db.eq_ignore_ascii_case("DB"))
                    && (rest.len() == 2 || rest[2..].strip_prefix('_').is_some_and(is_number))
        })
    })
}

/// `WORD_TO_INT` for `WORD_TO_ITN`.
fn similar_conversion(name: &str) -> Option<String> {
    let upper = name.to_ascii_uppercase();
    let (from, to) = upper.split_once("_TO_")?;
    let own = |word: &str| {
        let names = || plcc_syntax::Elementary::ALL.into_iter().map(|ty| ty.name());
        names().find(|name| *name == word).or_else(|| similar(word, names())).or_else(|| known_type(word))
    };
    Some(format!("{}_TO_{}", own(from)?, own(to)?))
}
