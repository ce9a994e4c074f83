//! Networks in SCL among those of LAD and FBD: each becomes a network in STL, which stays among the others.

use plcc_abi::image::{BlockKind, Family};
use plcc_diag::Span;
use plcc_model::scl::{Statement, StatementKind, walk};
use plcc_model::types::Elementary;
use plcc_syntax::ast::{self, Code, Operand, OperandKind, StatusOperand};
use plcc_syntax::network::ast::{Body, Content};
use plcc_syntax::scl::ast as syntax;
use plcc_syntax::stl::StlInsn;

use super::{Maker, Seen, Uses};

/// Whether the code of a block is a chart or has statements of SCL, whose meaning only the bound program tells.
pub fn has_statements(code: &Code) -> bool {
    matches!(code, Code::Chart(_)) || !lists(code).is_empty()
}

/// The lists of statements of SCL in the code of a block; networks with nothing but assertions are none.
pub(super) fn lists(code: &Code) -> Vec<&[syntax::Statement]> {
    match code {
        Code::Scl(body) => vec![body.statements.as_slice()],
        Code::Graphic(body) => body
            .networks
            .iter()
            .filter_map(|network| match &network.content {
                Content::Scl(list) if !does_nothing(list) => Some(list.as_slice()),
                Content::Scl(_) | Content::Graphic(_) | Content::Stl(_) => None,
            })
            .collect(),
        Code::Stl(_) | Code::Chart(_) => Vec::new(),
    }
}

/// There are assertions at most.
pub(crate) fn does_nothing(list: &[syntax::Statement]) -> bool {
    list.iter()
        .all(|statement| matches!(statement.kind, syntax::StatementKind::Empty | syntax::StatementKind::Pragma(_)))
}

impl Maker<'_> {
    /// The networks of a block of LAD and FBD, those in SCL in STL.
    pub(super) fn among_networks(&mut self, body: &Body) -> Body {
        self.check_cpu();
        let mut made = body.clone();
        for network in &body.networks {
            self.other_labels.extend(network.labels.iter().map(|label| label.text.to_lowercase()));
            if let Content::Stl(list) = &network.content {
                let labels = list.iter().filter_map(|statement| statement.label.as_ref());
                self.other_labels.extend(labels.map(|label| label.name.to_lowercase()));
            }
        }
        let typed = self.body;
        // A block ends with a value for its ENO, unless its errors set that.
        let is_scl = body.networks.iter().all(|network| matches!(network.content, Content::Scl(_)));
        let last = typed.statements.last().map(|last| &last.kind);
        if is_scl && last.is_some_and(|last| !matches!(last, StatementKind::SetFlag(_))) {
            self.refuse_flag();
        }
        // To those of an S7-1500, copies are added with the statements of all networks.
        let mut has_copies = !self.is_classic_cpu() || typed.inputs_in_place;
        let mut br = None;
        for network in &mut made.networks {
            let Content::Scl(list) = &network.content else { continue };
            if does_nothing(list) {
                continue;
            }
            let statements = bound(list, &typed.statements);
            self.refused = false;
            self.span = network.span;
            if !std::mem::replace(&mut has_copies, true) {
                let uses = Uses::of(self.block, typed);
                self.copy_inputs(&uses);
            }
            // Another network has others at the same places.
            self.hidden.clear();
            self.check_network(statements, network.span);
            if !self.refused {
                for statement in statements {
                    self.span = statement.span;
                    self.statement(statement);
                }
                self.close_labels();
                self.keep_br(&mut br);
            }
            network.content = Content::Stl(std::mem::take(&mut self.statements));
        }
        made
    }

    pub(super) fn is_classic_cpu(&self) -> bool {
        matches!(self.program.profile.family, Family::S7300 | Family::S7400)
    }

    /// On an S7-300, BR is ENO of the block, which a call in SCL leaves as it is: the statements of a network with calls restore it.
    fn keep_br(&mut self, kept: &mut Option<Operand>) {
        let calls = self.statements.iter().any(|statement| matches!(statement.kind, ast::StatementKind::Call(_)));
        if !calls || !self.is_classic_cpu() || self.block.kind == BlockKind::Ob {
            return;
        }
        let mut own = std::mem::take(&mut self.statements);
        let after = self.span;
        self.span = own.first().map_or(after, |first| first.span);
        let bit = kept.get_or_insert_with(|| self.kept(Elementary::Bool, "br")).clone();
        let br = Operand { kind: OperandKind::Status(StatusOperand::Br), span: self.span };
        self.push(StlInsn::And, Some(br));
        self.push(StlInsn::Assign, Some(bit.clone()));
        self.statements.append(&mut own);
        self.span = after;
        self.push(StlInsn::And, Some(bit));
        self.push(StlInsn::Save, None);
        self.push(StlInsn::ClearRlo, None);
    }

    /// What a network in STL cannot do for the others.
    fn check_network(&mut self, statements: &[Statement], span: Span) {
        if statements.is_empty() {
            return self.refuse(span, "a network in SCL without a meaning here", "repair the network first");
        }
        let jump = walk::find(statements, &|statement: &Statement| {
            let jumps =
                matches!(statement.kind, StatementKind::Goto(_) | StatementKind::Label(_) | StatementKind::Return(_));
            jumps.then_some(statement.span)
        });
        if let Some(span) = jump {
            let help = "write the jump or the RETURN as a network in LAD";
            return self.refuse(span, "a jump out of a network in SCL", help);
        }
        let mut seen = Seen::default();
        walk::statements(statements, &mut seen);
        if seen.flag || seen.last_eno {
            self.refuse(span, "ENO in a network in SCL", "set ENO of the block with RET in LAD");
        }
    }
}

/// The statements of the typed tree that a list means.
fn bound<'t>(list: &[syntax::Statement], typed: &'t [Statement]) -> &'t [Statement] {
    let (Some(first), Some(last)) = (list.first(), list.last()) else { return &[] };
    let range = first.span.start..last.span.end;
    let is_own = |statement: &Statement| range.contains(&statement.span.start);
    match (typed.iter().position(is_own), typed.iter().rposition(is_own)) {
        (Some(from), Some(to)) => &typed[from..=to],
        _ => &[],
    }
}
