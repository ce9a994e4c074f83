//! Addresses of which neither is part of the other, as MW 10 and MW 11: writing one of them changes a part of the
//! other.

use std::collections::BTreeMap;

use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::{Access, Statement, StatementKind, walk};
use plcc_model::types::DataType;
use plcc_model::{Body, CodeBlock, Operand, StlStatementKind};
use plcc_syntax::stl::StlInsn;

use super::Language;
use super::region::{Bits, Region};

/// A use of an address.
struct Use {
    bits: Bits,
    span: Span,
    written: bool,
}

/// `bytes 20 to 21`
fn bytes(one: &Use) -> String {
    format!("bytes {} to {}", one.bits.first / 8, (one.bits.end - 1) / 8)
}

/// Reports addresses in the process images and the bit memory that overlap in part, if one of them is written. `text`: of a span; tags
/// have a message of their own.
pub fn review(blocks: &[(&CodeBlock, Language)], text: &dyn Fn(Span) -> String, found: &mut Vec<Diagnostic>) {
    let mut uses = Uses::default();
    for (block, _) in blocks {
        match &block.body {
            Body::Stl(statements) => {
                for statement in statements {
                    if let StlStatementKind::Instruction { insn, operand: Operand::Memory { place, width } } =
                        &statement.kind
                    {
                        let bits = Bits::at(place, width.bits().into());
                        uses.add(bits, statement.span, *insn == StlInsn::Transfer);
                    }
                }
            }
            Body::Scl(body) => walk::statements(&body.statements, &mut uses),
            Body::S7200(_) | Body::Runtime => {}
        }
    }
    let named = |span: Span| text(span).contains(['"', '#']);
    let all: Vec<(&Bits, &Use)> = uses.seen.iter().collect();
    for (at, (bits, first)) in all.iter().enumerate() {
        let later = all[at + 1..].iter().take_while(|(other, _)| other.region == bits.region && other.first < bits.end);
        let crossing = later.filter(|(other, _)| other.first > bits.first && other.end > bits.end);
        let Some((_, other)) = crossing.into_iter().find(|(_, other)| first.written || other.written) else { continue };
        let (one, two) = match (first.span.file.0, first.span.start) <= (other.span.file.0, other.span.start) {
            true => (*first, *other),
            false => (*other, *first),
        };
        if named(one.span) && named(two.span) {
            continue;
        }
        found.push(
            Diagnostic::new(Code::OverlappingTags, two.span, "two addresses overlap, and neither is part of the other")
                .label(bytes(two))
                .also(one.span, bytes(one))
                .help("to write one of them changes the other: give one another address"),
        );
    }
}

/// Each address, in order, with the use to show: the first that writes it, otherwise the first.
#[derive(Default)]
struct Uses {
    seen: BTreeMap<Bits, Use>,
    /// The target of the assignment that the walk is in.
    target: Option<Span>,
}

impl Uses {
    fn add(&mut self, bits: Option<Bits>, span: Span, written: bool) {
        let Some(bits) = bits.filter(|bits| matches!(bits.region, Region::I | Region::Q | Region::M)) else { return };
        if bits.end - bits.first < 8 {
            return;
        }
        let known = self.seen.entry(bits).or_insert(Use { bits, span, written });
        if written && !known.written {
            *known = Use { bits, span, written };
        }
    }
}

impl walk::Visitor for Uses {
    fn statement(&mut self, statement: &Statement) {
        self.target = match &statement.kind {
            StatementKind::Assign { target, .. } => Some(target.span),
            _ => None,
        };
    }

    fn access(&mut self, access: &Access, _role: walk::Role) {
        if access.indices.is_empty() && access.part.is_none() && matches!(access.ty, DataType::Elementary(_)) {
            self.add(Bits::of(access), access.span, self.target == Some(access.span));
        }
    }
}
