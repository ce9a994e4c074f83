//! Operands that rows of actions write: those of steps that are active together, and those that are set and never reset.

use plcc_diag::{Code, Diagnostic};
use plcc_syntax::ast::{Area, BlockName, BlockPrefix, OperandKind, Width};
use plcc_syntax::chart::ast::{Action, ActionBody, Body as Chart, Coil, Dialect, PermanentKind, Qualifier};
use plcc_syntax::network::draw::operand;
use plcc_syntax::scl::ast::{Expr, ExprKind, NameForm};
use plcc_syntax::scl::text::expr;
use rustc_hash::{FxHashMap, FxHashSet};

use super::net::StepSet;
use super::{Facts, step_title};
use crate::bind::trees::mentions::{action_expressions, permanent_expressions};
use plcc_syntax::symbols::{SymbolTarget, parse_address};

/// The operand that a row writes, in a form that is the same for all its names.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Place {
    /// Bits of an area; for a DB with its number.
    Memory { area: Area, db: u16, start: u64, bits: u32 },
    /// Folded.
    Named(String),
}

/// How a row writes its operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Write {
    /// N, D and L: in each call, and 0 when the step is left.
    Drive,
    Set,
    Reset,
}

/// Operands written by two steps that may be active together.
pub fn check_shared(chart: &Chart, together: &[StepSet], facts: &Facts, messages: &mut Vec<Diagnostic>) {
    let mut rows: FxHashMap<Place, Vec<(usize, Write, &Expr)>> = FxHashMap::default();
    let mut seen: FxHashSet<(usize, Write, Place)> = FxHashSet::default();
    let mut order: Vec<Place> = Vec::new();
    for (step, action) in steps_and_actions(chart) {
        let Some((write, value)) = written(action) else { continue };
        let Some(place) = place(value, facts) else { continue };
        if seen.insert((step, write, place.clone())) {
            let list = rows.entry(place.clone()).or_default();
            if list.is_empty() {
                order.push(place);
            }
            list.push((step, write, value));
        }
    }
    for place in order {
        let list = &rows[&place];
        let pairs = list.iter().enumerate().flat_map(|(at, a)| list[at + 1..].iter().map(move |b| (a, b)));
        let conflict = pairs.into_iter().find(|((a, first, _), (b, second, _))| {
            let fight = match (first, second) {
                (Write::Drive, Write::Drive) | (Write::Set, Write::Reset) | (Write::Reset, Write::Set) => true,
                (Write::Drive, Write::Set | Write::Reset) | (Write::Set | Write::Reset, Write::Drive) => false,
                (Write::Set, Write::Set) | (Write::Reset, Write::Reset) => false,
            };
            fight && a != b && together.get(*a).is_some_and(|steps| steps.has(*b))
        });
        let Some(((a, write, first), (b, _, second))) = conflict else { continue };
        let (a, b) = (&chart.steps[*a], &chart.steps[*b]);
        let name = shown(chart, second);
        let (text, label) = match write {
            Write::Drive => (
                format!("{} and {} both write `{name}`, and may be active together", step_title(a), step_title(b)),
                "the step that was entered later wins in each call; the first one that is left writes 0",
            ),
            Write::Set | Write::Reset => (
                format!("{} and {} set and reset `{name}`, and may be active together", step_title(a), step_title(b)),
                "the step that was entered later wins in each call",
            ),
        };
        messages.push(
            Diagnostic::new(Code::SharedOperand, second.span, text)
                .label(label)
                .also(first.span, format!("also written by {}", step_title(a)))
                .help("write it in one of these paths only, or give each path its own bit and join the bits after the sequencers"),
        );
    }
}

/// Operands that rows of S set and nothing in the block resets.
pub fn check_reset(chart: &Chart, facts: &Facts, messages: &mut Vec<Diagnostic>) {
    let resets = resets(chart, facts);
    let mut told: FxHashSet<Place> = FxHashSet::default();
    for (step, action) in steps_and_actions(chart) {
        let Some((Write::Set, value)) = written(action) else { continue };
        let Some(place) = place(value, facts) else { continue };
        // A row of S writes a bit; anything else is reported as such.
        if matches!(place, Place::Memory { bits, .. } if bits != 1) {
            continue;
        }
        if place.with_wholes().any(|whole| resets.contains(&whole)) || !told.insert(place) {
            continue;
        }
        let (name, step) = (shown(chart, value), step_title(&chart.steps[step]));
        messages.push(
            Diagnostic::new(
                Code::NeverReset,
                value.span,
                format!("`{name}` is set in {step} and reset nowhere in the block"),
            )
            .label("stays 1 once this step was active")
            .help(
                "add a row with R to the step in which it goes off, or write it with N in the steps in which it is on",
            ),
        );
    }
}

/// Operands that something but a row of S may write.
fn resets(chart: &Chart, facts: &Facts) -> FxHashSet<Place> {
    let mut resets: FxHashSet<Place> = FxHashSet::default();
    for permanent in chart.before.iter().chain(&chart.after) {
        match &permanent.kind {
            PermanentKind::Coil { coil: Coil::Set, .. } => {}
            PermanentKind::Coil { operand, coil: Coil::Assign | Coil::Reset, .. } => {
                resets.extend(place(operand, facts));
            }
            // They may write any operand that they name.
            PermanentKind::Call(_) | PermanentKind::Network(_) => {
                permanent_expressions(permanent, &mut |value| resets.extend(place(value, facts)));
            }
        }
    }
    for (_, action) in steps_and_actions(chart) {
        match &action.body {
            ActionBody::Operand(_) if action.qualifier == Qualifier::S => {}
            ActionBody::Operand(value) | ActionBody::Value { operand: value, .. } => {
                resets.extend(place(value, facts));
            }
            ActionBody::Call(_) | ActionBody::Statements(_) | ActionBody::Network(_) => {
                action_expressions(action, &mut |value| resets.extend(place(value, facts)));
            }
            ActionBody::All { .. } | ActionBody::Error => {}
        }
    }
    resets
}

fn steps_and_actions(chart: &Chart) -> impl Iterator<Item = (usize, &Action)> {
    chart.steps.iter().enumerate().flat_map(|(at, step)| step.actions.iter().map(move |action| (at, action)))
}

/// The operand of a row and how it is written; rows that write once, at an event, do not keep an operand at a value.
fn written(action: &Action) -> Option<(Write, &Expr)> {
    match (action.qualifier, &action.body) {
        (Qualifier::S, ActionBody::Operand(value)) => Some((Write::Set, value)),
        (Qualifier::R, ActionBody::Operand(value)) => Some((Write::Reset, value)),
        (
            Qualifier::N | Qualifier::D | Qualifier::L,
            ActionBody::Operand(value) | ActionBody::Value { operand: value, .. },
        ) if action.event.is_none() => Some((Write::Drive, value)),
        _ => None,
    }
}

/// The operand as the language of the chart writes it.
fn shown(chart: &Chart, value: &Expr) -> String {
    let text = operand(value);
    match chart.dialect {
        Dialect::Classic => text.trim_start_matches('%').to_string(),
        Dialect::Tia | Dialect::Sfc => text,
    }
}

impl Place {
    fn memory(area: Area, db: u16, width: Width, byte: u32, bit: u8) -> Place {
        Place::Memory { area, db, start: u64::from(byte) * 8 + u64::from(bit), bits: width.bits() }
    }

    /// The bit or component itself, and everything it may be part of.
    fn with_wholes(&self) -> Box<dyn Iterator<Item = Place> + '_> {
        match self {
            Place::Memory { area, db, start, .. } => {
                let byte = start / 8;
                let wholes = [Width::Byte, Width::Word, Width::Dword].into_iter().flat_map(move |width| {
                    let first = (byte + 1).saturating_sub(u64::from(width.bytes()));
                    (first..=byte).map(move |byte| Place::Memory {
                        area: *area,
                        db: *db,
                        start: byte * 8,
                        bits: width.bits(),
                    })
                });
                Box::new(std::iter::once(self.clone()).chain(wholes))
            }
            Place::Named(text) => {
                let ends = text.match_indices(['.', '[']).map(|(at, _)| at).chain([text.len()]);
                Box::new(ends.map(|end| Place::Named(text[..end].to_string())))
            }
        }
    }
}

/// The address of an operand; none if it is computed.
fn place(value: &Expr, facts: &Facts) -> Option<Place> {
    match &value.kind {
        ExprKind::Absolute(OperandKind::Absolute { area, width, byte, bit }) => {
            Some(Place::memory(*area, 0, *width, *byte, *bit))
        }
        ExprKind::Absolute(OperandKind::DbAbsolute { db, width, byte, bit }) => {
            let number = match db {
                BlockName::Numbered { number, .. } => u16::try_from(*number).ok()?,
                BlockName::Symbol { name, .. } => db_number(name, facts)?,
            };
            Some(Place::memory(Area::Db, number, *width, *byte, *bit))
        }
        ExprKind::MemberAbsolute { base, width, byte, bit } => match &base.kind {
            ExprKind::Name(name) => Some(Place::memory(Area::Db, db_number(&name.text, facts)?, *width, *byte, *bit)),
            _ => None,
        },
        ExprKind::Name(name) => {
            let target = match name.form {
                NameForm::Local => None,
                NameForm::Quoted => (facts.symbol)(&name.text),
                NameForm::Bare => (facts.symbol)(&name.text).or_else(|| parse_address(&name.text)),
            };
            Some(match target {
                Some(SymbolTarget::Memory { area, width, byte, bit }) => Place::memory(area, 0, width, byte, bit),
                Some(SymbolTarget::Cell { .. } | SymbolTarget::Block { .. }) | None => named(value),
            })
        }
        ExprKind::Member { .. } | ExprKind::Index { .. } => is_fixed(value).then(|| named(value)),
        _ => None,
    }
}

fn named(value: &Expr) -> Place {
    Place::Named(expr(value).to_lowercase().trim_start_matches('#').to_string())
}

fn db_number(name: &str, facts: &Facts) -> Option<u16> {
    match (facts.symbol)(name).or_else(|| parse_address(name))? {
        SymbolTarget::Block { prefix: BlockPrefix::Db, number } => u16::try_from(number).ok(),
        SymbolTarget::Block { .. } | SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. } => None,
    }
}

/// No part of its address is computed.
fn is_fixed(value: &Expr) -> bool {
    let mut value = value;
    loop {
        value = match &value.kind {
            ExprKind::Name(_) => return true,
            ExprKind::Member { base, .. } => base,
            ExprKind::Index { base, indices } if indices.iter().all(|i| matches!(i.kind, ExprKind::Literal(_))) => base,
            _ => return false,
        }
    }
}
