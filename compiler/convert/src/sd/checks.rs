//! What other notations have and a document of SIMATIC SD does not.

use plcc_syntax::ast::{Block, BlockName, Code, CodeBlock};
use plcc_syntax::network::ast::{Element, Pin, Target};
use plcc_syntax::network::elements::Kind;
use plcc_syntax::scl::ast::{Expr, ExprKind, NameForm, StatementKind};

use super::elements::out_pin;
use crate::names;
use crate::scl::expression;
use crate::writer::Writer;

impl Writer<'_> {
    /// An operand at a pin.
    pub(super) fn sd_operand(&mut self, value: &Expr) -> String {
        if matches!(value.kind, ExprKind::Call { .. } | ExprKind::Binary { .. }) {
            let title = "an input that converts its operand, which networks of SIMATIC SD do not have";
            self.refuse(value.span, title, "convert the value in ST, and connect a variable that has it");
        }
        expression::text(value, self)
    }

    /// The name of an FC that is called, as its author wrote it if the source is a document.
    pub(super) fn sd_callee(&mut self, callee: &Expr) -> String {
        match &callee.kind {
            ExprKind::Name(name) if name.form == NameForm::Bare && self.braces.is_none() => names::symbol(&name.text),
            _ => expression::text(callee, self),
        }
    }

    /// Refuses standard functions of PLCopen XML that are formulas, such as TIME times REAL, and outputs with several connections besides
    /// the flow.
    pub(super) fn sd_check_element(&mut self, element: &Element) {
        let flow = out_pin(element).map(|(index, _)| index);
        let written = element.pins.iter().enumerate().filter(|(index, pin)| pin.output && flow != Some(*index));
        let outputs: Vec<&Pin> = written.map(|(_, pin)| pin).collect();
        let is_again =
            |at: usize| outputs[..at].iter().any(|before| before.name.eq_ignore_ascii_case(&outputs[at].name));
        if let Some(at) = (0..outputs.len()).find(|at| is_again(*at)) {
            let title =
                format!("the output `{}` with several connections, of which a document has one", outputs[at].name);
            self.refuse(outputs[at].span, title, "connect the other inputs with the variable at the output");
        }
        if matches!(&element.target, Target::Element { row, .. } if matches!(row.kind, Kind::Formula)) {
            let title = "the TIA Portal has no element in LAD and FBD for this function";
            self.refuse(element.span, title, "program it in ST");
        }
    }
}

/// Whether a block in SCL has no statements and another one with its name has some: a declaration before the definition.
pub(super) fn is_forward(block: &Block, blocks: &[Block]) -> bool {
    let Block::Code(own) = block else { return false };
    is_empty(own)
        && blocks.iter().any(|other| match other {
            Block::Code(other) => other.kind == own.kind && !is_empty(other) && is_same(&other.name, &own.name),
            Block::Data(_) | Block::Type(_) => false,
        })
}

fn is_empty(block: &CodeBlock) -> bool {
    match &block.code {
        Code::Scl(body) => body.statements.iter().all(|statement| statement.kind == StatementKind::Empty),
        Code::Stl(_) | Code::Graphic(_) | Code::Chart(_) => false,
    }
}

fn is_same(one: &BlockName, other: &BlockName) -> bool {
    match (one, other) {
        (BlockName::Symbol { name: one, .. }, BlockName::Symbol { name: other, .. }) => {
            one.to_lowercase() == other.to_lowercase()
        }
        (BlockName::Numbered { number: one, .. }, BlockName::Numbered { number: other, .. }) => one == other,
        (BlockName::Symbol { .. }, BlockName::Numbered { .. })
        | (BlockName::Numbered { .. }, BlockName::Symbol { .. }) => false,
    }
}
