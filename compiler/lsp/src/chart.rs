//! Steps and transitions of GRAPH.

use std::ops::Range;

use plcc_diag::Span;
use plcc_syntax::ast::{Block, Code};
use plcc_syntax::chart::ast::{Body, Step, Transition};

use crate::facts::same;
use crate::index::{Entry, Index};
use crate::words::{Words, bare};

/// A step or a transition.
#[derive(Clone, Copy)]
pub enum Part<'c> {
    Step(&'c Step),
    Transition(&'c Transition),
}

impl<'c> Part<'c> {
    pub fn name(&self) -> &'c str {
        match self {
            Part::Step(step) => &step.name.text,
            Part::Transition(transition) => &transition.name.text,
        }
    }

    /// The place of its name.
    pub fn span(&self) -> Span {
        match self {
            Part::Step(step) => step.name.span,
            Part::Transition(transition) => transition.name.span,
        }
    }

    /// `S002` is also the name of step 2, and `T002` that of transition 2.
    pub fn is_number(&self, text: &str) -> bool {
        let (letter, number) = match self {
            Part::Step(step) => ('S', step.number),
            Part::Transition(transition) => ('T', transition.number),
        };
        let digits = text.strip_prefix([letter, letter.to_ascii_lowercase()]);
        digits.is_some_and(|digits| {
            digits.bytes().all(|digit| digit.is_ascii_digit()) && digits.parse::<u32>() == Ok(number)
        })
    }

    pub fn whole(&self) -> Span {
        match self {
            Part::Step(step) => step.span,
            Part::Transition(transition) => transition.span,
        }
    }

    /// `step S2`
    pub fn kind(&self) -> String {
        match self {
            Part::Step(step) => format!("step S{}", step.number),
            Part::Transition(transition) => format!("transition T{}", transition.number),
        }
    }

    /// The components that programs read.
    pub fn components(&self) -> &'static [Component] {
        match self {
            Part::Step(_) => &STEP,
            Part::Transition(_) => &TRANSITION,
        }
    }

    pub fn comment(&self) -> String {
        match self {
            Part::Step(step) => step.comment.join("\n"),
            Part::Transition(transition) => transition.comment.join("\n"),
        }
    }
}

/// A component of a step or transition: its name, its type and what it says. Source: GRAPH reference D.5.
pub struct Component {
    pub name: &'static str,
    pub ty: &'static str,
    pub doc: &'static str,
}

const fn row(name: &'static str, ty: &'static str, doc: &'static str) -> Component {
    Component { name, ty, doc }
}

const STEP: [Component; 14] = [
    row("X", "BOOL", "the step is active"),
    row("T", "TIME", "time since the step was entered; it stays after the step is left"),
    row("U", "TIME", "as T, without the time of faults"),
    row("S1", "BOOL", "the step was entered in this call"),
    row("S0", "BOOL", "the step was left in this call"),
    row("LA", "BOOL", "the interlock is not satisfied"),
    row("LS", "BOOL", "the condition of the interlock is satisfied"),
    row("L1", "BOOL", "the interlock was lost in this call"),
    row("L0", "BOOL", "the interlock was satisfied again in this call"),
    row("VA", "BOOL", "a fault of the supervision is pending"),
    row("VS", "BOOL", "the condition of the supervision is satisfied, which is a fault"),
    row("V1", "BOOL", "a fault of the supervision came in this call"),
    row("V0", "BOOL", "a fault of the supervision went in this call"),
    row("SNO", "INT", "number of the step"),
];

const TRANSITION: [Component; 4] = [
    row("TV", "BOOL", "the transition is valid: the steps before it are active"),
    row("TT", "BOOL", "the condition is satisfied"),
    row("TS", "BOOL", "the transition switches in this call"),
    row("TNO", "INT", "number of the transition"),
];

/// The steps and transitions of a block.
pub fn of(entry: Entry<'_>) -> Vec<Part<'_>> {
    let Some(body) = body(entry) else { return Vec::new() };
    body.steps.iter().map(Part::Step).chain(body.transitions.iter().map(Part::Transition)).collect()
}

/// Components of transitions; all others are those of steps.
const OF_TRANSITIONS: [&str; 8] = ["TV", "TT", "TS", "CF_IV", "TNO", "CRIT", "CRIT_OLD", "CRIT_FLT"];

/// The step or transition that a piece of its block is for its place: a declaration, a step after FROM or TO, or what is before
/// the point of a component.
pub fn at<'c>(index: &Index<'c>, entry: Entry<'c>, words: &Words, at: usize) -> Option<Part<'c>> {
    let body = body(entry)?;
    let (word, range) = (words.word(at), words.range(at));
    let name = bare(word);
    let all = of(entry);
    if let Some(part) = all.iter().find(|part| part.span().range() == range) {
        return Some(*part);
    }
    let (steps, transitions): (Vec<_>, Vec<_>) = all.into_iter().partition(|part| matches!(part, Part::Step(_)));
    let mut ends = body.transitions.iter().flat_map(|one| one.from.iter().chain(&one.to));
    if ends.any(|end| end.span.range() == range) {
        return steps.iter().find(|step| same(step.name(), name)).copied();
    }
    let has_component = words.word(at + 1) == "." && !(at > 0 && words.word(at - 1) == ".");
    let is_global = || word.starts_with('"') && (index.block(name).is_some() || index.symbol(name).is_some());
    if !has_component || is_global() || entry.variables().iter().any(|(_, variable)| same(&variable.name, name)) {
        return None;
    }
    let of_transition = OF_TRANSITIONS.iter().any(|own| own.eq_ignore_ascii_case(words.word(at + 2)));
    of_transition.then(|| find(&transitions, name)).flatten().or_else(|| find(&steps, name))
}

/// The one with a name, or with the number of a name such as `S002`.
pub fn named<'c>(entry: Entry<'c>, name: &str) -> Option<Part<'c>> {
    find(&of(entry), name)
}

/// The one that a component of an instance holds. Transitions get their names first.
pub fn in_instance<'c>(entry: Entry<'c>, name: &str) -> Option<Part<'c>> {
    let mut all = of(entry);
    all.sort_by_key(|part| matches!(part, Part::Step(_)));
    find(&all, name)
}

/// Whether a piece is in the qualifier of an action: `N` in `(N)`.
pub fn is_qualifier(entry: Entry, range: &Range<usize>) -> bool {
    let actions = body(entry).into_iter().flat_map(|body| body.steps.iter().flat_map(|step| &step.actions));
    let mut marks = actions.map(|action| action.qualifier_span.range());
    marks.any(|mark| mark.start <= range.start && range.end <= mark.end)
}

/// Whether a piece is a step that a transition comes from or leads to: after FROM, or in `TO (A, B)`.
pub fn is_end(words: &Words, at: usize) -> bool {
    let is_keyword = |at: usize| ["FROM", "TO"].iter().any(|word| word.eq_ignore_ascii_case(words.word(at)));
    let mut at = at;
    while at >= 2 && words.word(at - 1) == "," {
        at -= 2;
    }
    let list = at >= 2 && words.word(at - 1) == "(" && is_keyword(at - 2);
    list || at >= 1 && is_keyword(at - 1)
}

/// The first with a name; if there is none, with its number.
fn find<'c>(parts: &[Part<'c>], name: &str) -> Option<Part<'c>> {
    let named = parts.iter().find(|part| same(part.name(), name));
    named.or_else(|| parts.iter().find(|part| part.is_number(name))).copied()
}

fn body(entry: Entry<'_>) -> Option<&Body> {
    match entry.block {
        Block::Code(block) => match &block.code {
            Code::Chart(body) => Some(body),
            Code::Stl(_) | Code::Scl(_) | Code::Graphic(_) => None,
        },
        Block::Data(_) | Block::Type(_) => None,
    }
}
