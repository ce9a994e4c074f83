//! Mistakes that only show in all networks of a block together: operands of two coils, shared edge memory bits and instances, labels.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::network::ast::{Body, Content, Element, Network, PinValue, Source, Target};
use plcc_syntax::network::draw::{draw, operand};
use plcc_syntax::network::elements::Kind;
use plcc_syntax::scl::ast::{Expr, ExprKind, NameForm};
use plcc_syntax::scl::text::expr;
use rustc_hash::FxHashMap;

use super::row;
use crate::bind::network::DRAWINGS_MAX;

/// Warnings about operands that several elements of a block use; operands are compared as written.
pub fn block_warnings(body: &Body) -> Vec<Diagnostic> {
    let mut block = Block::default();
    for network in &body.networks {
        // A jump may come from anywhere and skip the networks before.
        if !network.labels.is_empty() {
            block.forget();
        }
        match &network.content {
            Content::Graphic(graph) => {
                let operands = graph.nets.iter().flat_map(|net| &net.sources).filter_map(|source| match source {
                    Source::Operand { value, .. } => Some(value),
                    Source::Rail | Source::Pin { .. } | Source::Net(_) => None,
                });
                operands.for_each(|value| block.read(value));
                for (at, element) in graph.elements.iter().enumerate() {
                    block.element(network, at, element);
                }
            }
            Content::Scl(_) | Content::Stl(_) => block.forget(),
        }
    }
    block.messages
}

/// Uses so far, by the text of the operand.
#[derive(Default)]
struct Block {
    coils: FxHashMap<String, Span>,
    instances: FxHashMap<String, Span>,
    edges: FxHashMap<String, Span>,
    messages: Vec<Diagnostic>,
}

impl Block {
    fn report(&mut self, message: Diagnostic, network: &Network, at: usize) {
        let is_drawn = self.messages.len() < DRAWINGS_MAX;
        self.messages.push(if is_drawn { message.note(draw(network, Some(at))) } else { message });
    }

    /// The following elements may run without the preceding ones.
    fn forget(&mut self) {
        self.coils.clear();
        self.instances.clear();
    }

    /// A local variable that was read between two coils is used again, which is not a mistake.
    fn read(&mut self, value: &Expr) {
        if let Some(key) = key(value).filter(|_| is_local(value)) {
            self.coils.remove(&key);
        }
    }

    fn element(&mut self, network: &Network, at: usize, element: &Element) {
        for pin in element.pins.iter().filter(|pin| !pin.output) {
            if let PinValue::Operand(value) = &pin.value {
                self.read(value);
            }
        }
        let Some(row) = row(element) else { return };
        let pin = |name: &str| match element.pin(name).map(|pin| &pin.value) {
            Some(PinValue::Operand(value)) => Some(value),
            Some(PinValue::Net(_) | PinValue::Open) | None => None,
        };
        match row.kind {
            Kind::Coil => self.coil(network, at, pin("operand")),
            Kind::EdgeContact { .. } | Kind::EdgeTrigger { .. } | Kind::EdgeCoil { .. } => {
                self.edge(network, at, pin("bit"));
            }
            Kind::Instance(name) if is_timed(name) => {
                if let Target::Element { instance, .. } = &element.target {
                    self.instance(network, at, instance.as_ref());
                }
            }
            Kind::TimerCoil(_) => self.instance(network, at, pin("timer")),
            Kind::Jump { .. } | Kind::JumpList | Kind::Switch | Kind::Return(_) => self.forget(),
            _ => {}
        }
    }

    fn coil(&mut self, network: &Network, at: usize, value: Option<&Expr>) {
        let Some((value, key)) = value.and_then(|value| Some((value, key(value)?))) else { return };
        if let Some(first) = self.coils.insert(key, value.span) {
            let text = format!("`{}` is written by two coils; the last one wins", operand(value));
            let message = Diagnostic::new(Code::DoubleCoil, value.span, text)
                .label("overwrites what the first coil wrote")
                .also(first, "the first coil")
                .help("join both conditions into one coil, or use a set and a reset coil");
            self.report(message, network, at);
        }
    }

    fn edge(&mut self, network: &Network, at: usize, value: Option<&Expr>) {
        let Some((value, key)) = value.and_then(|value| Some((value, key(value)?))) else { return };
        if let Some(first) = self.edges.insert(key, value.span) {
            let text = format!("two edges share the edge memory bit `{}`", operand(value));
            let message = Diagnostic::new(Code::EdgeBit, value.span, text)
                .label("this edge reads what the other one wrote")
                .also(first, "the first edge")
                .help("give each edge its own BOOL, in bit memory or in static data");
            self.report(message, network, at);
        }
    }

    fn instance(&mut self, network: &Network, at: usize, value: Option<&Expr>) {
        let Some((value, key)) = value.and_then(|value| Some((value, key(value)?))) else { return };
        if let Some(first) = self.instances.insert(key, value.span) {
            let text = format!("the instance `{}` runs twice in a cycle", operand(value));
            let message = Diagnostic::new(Code::InstanceUse, value.span, text)
                .label("runs with other inputs here")
                .also(first, "already runs here")
                .help("declare an instance for each of the two; you can read its outputs as often as you like");
            self.report(message, network, at);
        }
    }
}

/// Blocks that count calls, time or edges.
fn is_timed(name: &str) -> bool {
    matches!(name, "TP" | "TON" | "TOF" | "TONR" | "CTU" | "CTD" | "CTUD" | "R_TRIG" | "F_TRIG")
}

/// The text of an operand that is the same variable everywhere.
fn key(value: &Expr) -> Option<String> {
    is_fixed(value).then(|| expr(value).to_lowercase())
}

fn is_fixed(value: &Expr) -> bool {
    match &value.kind {
        ExprKind::Name(_) | ExprKind::Absolute(_) => true,
        ExprKind::Member { base, .. } | ExprKind::MemberAbsolute { base, .. } | ExprKind::Slice { base, .. } => {
            is_fixed(base)
        }
        ExprKind::Index { base, indices } => {
            is_fixed(base) && indices.iter().all(|index| matches!(index.kind, ExprKind::Literal(_)))
        }
        ExprKind::Literal(_)
        | ExprKind::Call { .. }
        | ExprKind::Dereference(_)
        | ExprKind::Reference(_)
        | ExprKind::Unary { .. }
        | ExprKind::Binary { .. }
        | ExprKind::Error => false,
    }
}

fn is_local(value: &Expr) -> bool {
    match &value.kind {
        ExprKind::Name(name) => name.form != NameForm::Quoted,
        ExprKind::Member { base, .. } | ExprKind::Slice { base, .. } | ExprKind::Index { base, .. } => is_local(base),
        _ => false,
    }
}
