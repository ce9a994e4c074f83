//! Sets of steps, and what statements do with them.

use plcc_diag::Span;
use plcc_syntax::Elementary;

use super::{Engine, all, compared, not};
use crate::bind::chart::assemble::{Features, Parts};
use crate::bind::chart::build::{assign, element, if_then, load, number};
use crate::bind::declarations::path::Variable;
use crate::bind::scl::expression::binary_expr;
use plcc_model::scl::{BinaryOp, CompareOp, Expr, Statement, StatementKind};

/// A set of steps.
#[derive(Clone)]
pub struct Set {
    /// A word is omitted if nothing uses its steps.
    pub(super) words: Vec<Option<Variable>>,
    /// Their type.
    pub(super) ty: Elementary,
}

impl Engine<'_> {
    /// Whether a step is active, from the set.
    pub fn is_active(&self, steps: &[usize], span: Span) -> Expr {
        self.active.holds_all(steps, span)
    }

    /// Adds a step to the active steps or removes it.
    pub fn set_active(&self, step: usize, add: bool, span: Span) -> Option<Statement> {
        if add { self.active.add(step, span) } else { self.active.remove(step, span) }
    }

    /// Removes from the sets what nothing uses: whether a step is left matters for competing joins and for OFF, whether it is
    /// entered matters where several transitions enter it.
    pub fn restrict_sets(&mut self, features: &Features, parts: &Parts, competing: &[usize]) {
        let steps = 0..self.steps.len();
        let left = competing.iter().flat_map(|at| &parts.from[*at]).copied();
        let mut ways = vec![0; self.steps.len()];
        parts.to.iter().flatten().for_each(|step| ways[*step] += 1);
        self.left.restrict(steps.clone().filter(|_| features.requests).chain(left));
        self.entered.restrict(steps.clone().filter(|step| features.skipping || ways[*step] > 1));
        self.passed.restrict(steps.filter(|_| features.skipping));
    }

    /// Empties the sets of the call.
    pub fn begin_sets(&self) -> Vec<Statement> {
        let zero = |variable: &Variable| assign(variable, number(0, self.active.ty, self.span), self.span);
        [&self.left, &self.entered, &self.passed].iter().flat_map(|set| set.words.iter().flatten()).map(zero).collect()
    }

    /// Adds step `k`, known at run time, to the active steps or removes it.
    pub fn change_active(&self, add: bool) -> Vec<Statement> {
        self.by_word(&|word, bit| {
            let Some(variable) = &self.active.words[word] else { return Vec::new() };
            let before = load(variable, self.span);
            let after = match add {
                true => binary_expr(BinaryOp::Or, before, bit, self.active.ty, self.span),
                false => binary_expr(BinaryOp::And, before, not(bit), self.active.ty, self.span),
            };
            vec![assign(variable, after, self.span)]
        })
    }

    /// Adds step `k`, known at run time, to a set.
    pub fn mark(&self, set: &Set) -> Vec<Statement> {
        self.by_word(&|word, bit| {
            let Some(variable) = &set.words[word] else { return Vec::new() };
            let after = binary_expr(BinaryOp::Or, load(variable, self.span), bit, set.ty, self.span);
            vec![assign(variable, after, self.span)]
        })
    }

    /// Sets `known` to whether step `k`, known at run time, is in a set; FALSE for steps without a word in the set.
    pub fn look_up(&self, set: &Set) -> Vec<Statement> {
        self.by_word(&|word, bit| {
            let known = match &set.words[word] {
                Some(variable) => {
                    let both = binary_expr(BinaryOp::And, load(variable, self.span), bit, set.ty, self.span);
                    compared(CompareOp::NotEqual, both, 0)
                }
                None => number(0, Elementary::Bool, self.span),
            };
            vec![assign(self.variable("known"), known, self.span)]
        })
    }

    /// Statements for the word that contains step `k`, and its bit there.
    fn by_word(&self, make: &dyn Fn(usize, Expr) -> Vec<Statement>) -> Vec<Statement> {
        let step = || self.value("k");
        let (words, ty) = (self.active.words.len(), self.active.ty);
        let bits = u64::from(ty.bits());
        let mut statements = Vec::new();
        for word in (0..words).rev() {
            let one = number(1, ty, self.span);
            let first = bits * word as u64 + 1;
            let place = binary_expr(
                BinaryOp::Subtract,
                step(),
                number(first, Elementary::Dint, self.span),
                Elementary::Dint,
                self.span,
            );
            let bit = binary_expr(BinaryOp::ShiftLeft, one, place, ty, self.span);
            let own = make(word, bit);
            statements = match word + 1 == words {
                true => own,
                false => vec![if_then(
                    compared(CompareOp::LessEqual, step(), bits * (word as u64 + 1)),
                    own,
                    statements,
                    self.span,
                )],
            };
        }
        statements
    }

    /// Puts a step into the next place of S1X, and into the set of entered steps.
    pub fn replace(&self, step: usize, span: Span) -> Vec<Statement> {
        let place = self.variable("i");
        let before = binary_expr(
            BinaryOp::Subtract,
            load(place, span),
            number(1, Elementary::Dint, span),
            Elementary::Dint,
            span,
        );
        let target = element(self.variable("S1X"), load(place, span), span);
        let value = number(step as u64 + 1, Elementary::Byte, span);
        let mut statements = vec![
            assign(self.variable("replaced"), number(1, Elementary::Bool, span), span),
            assign(place, before, span),
            Statement { kind: StatementKind::Assign { target, value }, span },
        ];
        statements.extend(self.entered.add(step, span));
        statements
    }

    /// Appends a step to S0X or S1X and to its set.
    pub fn append(&self, set: &Set, list: &str, count: &str, step: usize, span: Span) -> Vec<Statement> {
        let count = self.variable(count);
        let more =
            binary_expr(BinaryOp::Add, load(count, span), number(1, Elementary::Dint, span), Elementary::Dint, span);
        let place = element(self.variable(list), load(count, span), span);
        let value = number(step as u64 + 1, Elementary::Byte, span);
        let put = Statement { kind: StatementKind::Assign { target: place, value }, span };
        [assign(count, more, span), put].into_iter().chain(set.add(step, span)).collect()
    }
}

impl Set {
    /// The word of a step, and its bit there.
    fn word_of(&self, step: usize) -> (usize, u64) {
        let bits = self.ty.bits() as usize;
        (step / bits, 1 << (step % bits))
    }

    /// Omits words that contain none of these steps: nothing uses them.
    pub fn restrict(&mut self, steps: impl Iterator<Item = usize>) {
        let mut needed = vec![false; self.words.len()];
        steps.for_each(|step| needed[self.word_of(step).0] = true);
        self.words.iter_mut().zip(needed).filter(|(_, needed)| !needed).for_each(|(word, _)| *word = None);
    }

    /// Puts a step into the set.
    pub fn add(&self, step: usize, span: Span) -> Option<Statement> {
        let (word, bit) = self.word_of(step);
        let variable = self.words[word].as_ref()?;
        let bit = number(bit, self.ty, span);
        let after = binary_expr(BinaryOp::Or, load(variable, span), bit, self.ty, span);
        Some(assign(variable, after, span))
    }

    /// Takes a step out of the set.
    pub fn remove(&self, step: usize, span: Span) -> Option<Statement> {
        let (word, bit) = self.word_of(step);
        let variable = self.words[word].as_ref()?;
        let rest = number(!bit & (u64::MAX >> (64 - self.ty.bits())), self.ty, span);
        let after = binary_expr(BinaryOp::And, load(variable, span), rest, self.ty, span);
        Some(assign(variable, after, span))
    }

    /// All of these steps are in the set: one comparison per word.
    fn holds_all(&self, steps: &[usize], span: Span) -> Expr {
        let compared = self.masks(steps, span).map(|(masked, mask)| compared(CompareOp::Equal, masked, mask));
        all(compared, span)
    }

    /// None of these steps is in the set.
    pub fn holds_none(&self, steps: &[usize], span: Span) -> Expr {
        let compared = self.masks(steps, span).map(|(masked, _)| compared(CompareOp::Equal, masked, 0));
        all(compared, span)
    }

    fn masks(&self, steps: &[usize], span: Span) -> impl Iterator<Item = (Expr, u64)> {
        let mut masks = vec![0u64; self.words.len()];
        for &step in steps {
            let (word, bit) = self.word_of(step);
            masks[word] |= bit;
        }
        self.words.iter().zip(masks).filter(|(_, mask)| *mask != 0).filter_map(move |(word, mask)| {
            let mask_value = number(mask, self.ty, span);
            Some((binary_expr(BinaryOp::And, load(word.as_ref()?, span), mask_value, self.ty, span), mask))
        })
    }
}
