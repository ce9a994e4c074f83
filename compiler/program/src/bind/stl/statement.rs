//! Statements of a block: labels, jump lists, and the instructions themselves. The parser has checked that parentheses match.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{self, OperandKind, Statement, StatementKind};
use plcc_syntax::stl::StlInsn;
use rustc_hash::FxHashMap;

use crate::bind::declarations::block::CurrentBlock;
use crate::bind::stl::StlBinder;
use plcc_binding::fold;
use plcc_model::{LabelId, Operand, StlStatement, StlStatementKind};

/// Entries of a jump list.
const JUMP_LIST_MAX: usize = 255;

/// A jump label of the block.
struct LabelInfo {
    id: LabelId,
    span: Span,
    /// The innermost parenthesis around it, 0 for none.
    region: u32,
}

/// The block's statements in one row, with the results of the first walk over them.
struct Flow<'b> {
    statements: Vec<(u16, &'b Statement)>,
    labels: FxHashMap<&'b str, LabelInfo>,
    /// The innermost parenthesis around each statement.
    regions: Vec<u32>,
    /// MCR zones around each statement.
    zones: Vec<u32>,
    /// Labels of the other networks of a block in LAD or FBD, by folded name.
    elsewhere: FxHashMap<String, LabelId>,
}

impl StlBinder<'_, '_> {
    /// Binds the statements of a block.
    pub fn bind_block(&mut self, ctx: &mut CurrentBlock, block: &ast::CodeBlock) -> Vec<StlStatement> {
        let mut statements = Vec::new();
        for (network, content) in block.networks().iter().enumerate() {
            let number = u16::try_from(network + 1).unwrap_or(u16::MAX);
            statements.extend(content.statements.iter().map(|statement| (number, statement)));
        }
        let flow = self.statement_flow(statements);
        self.bind_flow(ctx, &flow)
    }

    /// Binds a network in STL of a block in LAD or FBD: `labels` are those of the block, by folded name.
    pub fn bind_statements(
        &mut self,
        ctx: &mut CurrentBlock,
        list: &[Statement],
        number: u16,
        labels: FxHashMap<String, LabelId>,
    ) -> Vec<StlStatement> {
        let mut flow = self.statement_flow(list.iter().map(|statement| (number, statement)).collect());
        let own: Vec<&str> = flow.labels.keys().copied().collect();
        for name in own {
            if let (Some(known), Some(info)) = (labels.get(&fold(name)), flow.labels.get_mut(name)) {
                info.id = *known;
            }
        }
        flow.elsewhere = labels;
        self.bind_flow(ctx, &flow)
    }

    fn bind_flow(&mut self, ctx: &mut CurrentBlock, flow: &Flow) -> Vec<StlStatement> {
        let mut bound = Vec::with_capacity(flow.statements.len());
        let mut at = 0;
        while at < flow.statements.len() {
            let (network, statement) = flow.statements[at];
            let span = ctx.fixed_span.unwrap_or(statement.span);
            if let Some(label) = &statement.label
                && let Some(info) = flow.labels.get(label.name.as_str())
                && info.span == label.span
            {
                bound.push(StlStatement { span, network, kind: StlStatementKind::Label(info.id) });
            }
            at += 1;
            let kind = match &statement.kind {
                StatementKind::Empty | StatementKind::Error => None,
                StatementKind::Instruction { insn: StlInsn::JumpList, mnemonic_span, operand } => {
                    let (list, kind) = self.jump_list(flow, at, *mnemonic_span, operand.as_ref());
                    at += list;
                    kind
                }
                StatementKind::Instruction { insn, mnemonic_span, operand } => {
                    self.check_instruction(*insn, *mnemonic_span);
                    self.instruction(ctx, flow, at - 1, *insn, *mnemonic_span, operand.as_ref())
                }
                StatementKind::Call(call) if self.is_move(call) => {
                    let kinds = self.bind_move(ctx, call).into_iter().flatten();
                    bound.extend(kinds.map(|kind| StlStatement { span, network, kind }));
                    None
                }
                StatementKind::Call(call) => {
                    if flow.zones[at - 1] > 0 && call.parameters.iter().any(|parameter| parameter.actual.is_some()) {
                        self.program.report(
                            Diagnostic::new(
                                Code::CallInMcrZone,
                                call.target.span,
                                "parameters are passed even if the MCR zone is off",
                            )
                            .label("a call with parameters inside an MCR zone")
                            .help("the CPU passes zeros in a zone that is off; call the block outside of the zone"),
                        );
                    }
                    self.bind_call(ctx, call, statement.span).map(StlStatementKind::Call)
                }
                StatementKind::Pragma(pragma) => self.statement_pragma(ctx, pragma),
            };
            if let Some(kind) = kind {
                bound.push(StlStatement { span, network, kind });
            }
        }
        bound
    }

    /// First walk: labels, parentheses and MCR zones.
    fn statement_flow<'b>(&mut self, statements: Vec<(u16, &'b Statement)>) -> Flow<'b> {
        let mut flow = Flow {
            labels: FxHashMap::default(),
            regions: Vec::with_capacity(statements.len()),
            zones: Vec::with_capacity(statements.len()),
            statements: Vec::new(),
            elsewhere: FxHashMap::default(),
        };
        let mut open: Vec<u32> = Vec::new();
        let mut regions = 0;
        let mut zones = 0u32;
        for (_, statement) in &statements {
            let region = open.last().copied().unwrap_or(0);
            flow.regions.push(region);
            flow.zones.push(zones);
            if let Some(label) = &statement.label {
                self.define_label(&mut flow, label, region);
            }
            let StatementKind::Instruction { insn, .. } = &statement.kind else { continue };
            match insn {
                insn if insn.opens_nesting() => {
                    regions += 1;
                    open.push(regions);
                }
                StlInsn::CloseNest => {
                    open.pop();
                }
                StlInsn::McrOpen => zones += 1,
                StlInsn::McrClose => zones = zones.saturating_sub(1),
                _ => {}
            }
        }
        flow.statements = statements;
        flow
    }

    fn define_label<'b>(&mut self, flow: &mut Flow<'b>, label: &'b ast::Label, region: u32) {
        if let Some(first) = flow.labels.get(label.name.as_str()) {
            let first = first.span;
            self.program.report(
                Diagnostic::new(
                    Code::DuplicateLabel,
                    label.span,
                    format!("the label `{}` is defined twice", label.name),
                )
                .label("the second one")
                .also(first, "the first one")
                .help("labels are unique in their block; upper and lower case are different"),
            );
            return;
        }
        let id = LabelId(flow.labels.len() as u32);
        flow.labels.insert(&label.name, LabelInfo { id, span: label.span, region });
    }

    fn check_instruction(&mut self, insn: StlInsn, mnemonic: Span) {
        if matches!(insn, StlInsn::Enter | StlInsn::Leave) && self.program.globals.input.profile.accumulators < 4 {
            let profile = &self.program.globals.input.profile.name;
            let name = self.program.globals.text(mnemonic);
            self.program.report(
                Diagnostic::new(Code::CpuInstruction, mnemonic, format!("`{name}` needs a CPU with 4 accumulators"))
                    .label(format!("the profile {profile} has 2 accumulators"))
                    .help("name a CPU with 4 accumulators, e.g. --cpu s7-400, or store the value in a double word"),
            );
        }
    }

    fn instruction(
        &mut self,
        ctx: &mut CurrentBlock,
        flow: &Flow,
        at: usize,
        insn: StlInsn,
        mnemonic: Span,
        operand: Option<&ast::Operand>,
    ) -> Option<StlStatementKind> {
        if let Some(ast::Operand { kind: OperandKind::Label(name), span }) = operand
            && insn.operand() == plcc_syntax::stl::OperandClass::Label
        {
            let label = self.jump(flow, flow.regions[at], name, *span)?;
            return Some(StlStatementKind::Instruction { insn, operand: Operand::Label(label) });
        }
        let operand = self.bind_operand(ctx, insn, mnemonic, operand)?;
        Some(StlStatementKind::Instruction { insn, operand })
    }

    /// A jump from inside parenthesis `region` to the label `name`.
    fn jump(&mut self, flow: &Flow, region: u32, name: &str, span: Span) -> Option<LabelId> {
        if !flow.labels.contains_key(name)
            && let Some(id) = flow.elsewhere.get(&fold(name))
        {
            return Some(*id);
        }
        let Some(label) = flow.labels.get(name) else {
            let message = Diagnostic::new(Code::UnknownLabel, span, format!("this block has no label `{name}`"))
                .label("nowhere to jump to");
            let other = flow.labels.keys().copied().find(|other| other.eq_ignore_ascii_case(name));
            let other = other.or_else(|| plcc_binding::similar(name, flow.labels.keys().copied()));
            self.program.report(match other {
                Some(other) if other.eq_ignore_ascii_case(name) => {
                    message.help(format!("is `{other}` meant? Upper and lower case are different in labels"))
                }
                Some(other) => message.help(format!("is `{other}` meant?")),
                None => {
                    let label = name.replace(|c: char| !c.is_alphanumeric() && c != '_', "_");
                    message.help(match label == name {
                        true => format!("write `{name}:` before the statement to jump to"),
                        false => format!("write `{label}` here, and `{label}:` before the statement to jump to"),
                    })
                }
            });
            return None;
        };
        if label.region != region {
            self.program.report(
                Diagnostic::new(
                    Code::JumpIntoNesting,
                    span,
                    format!("the jump to `{name}` enters or leaves a parenthesis"),
                )
                .label("the jump and its label are not in the same parenthesis")
                .also(label.span, "the label")
                .help("put the label in the parenthesis of the jump, or both outside"),
            );
            return None;
        }
        Some(label.id)
    }

    /// `JL` at the statement before `at`; also returns the length of its list.
    fn jump_list(
        &mut self,
        flow: &Flow,
        at: usize,
        mnemonic: Span,
        operand: Option<&ast::Operand>,
    ) -> (usize, Option<StlStatementKind>) {
        let name = self.program.globals.text(mnemonic);
        let Some(ast::Operand { kind: OperandKind::Label(default), span }) = operand else {
            self.program.report(
                Diagnostic::new(Code::MissingOperand, mnemonic, format!("`{name}` needs the label after its list"))
                    .label("the label is missing"),
            );
            return (0, None);
        };
        let region = flow.regions[at - 1];
        let before = self.program.globals.report.diagnostics.len();
        let default_label = self.jump(flow, region, default, *span);
        let mut targets = Vec::new();
        let mut length = 0;
        for (_, statement) in &flow.statements[at..] {
            match (&statement.label, &statement.kind) {
                (None, StatementKind::Empty) => {}
                (
                    None,
                    StatementKind::Instruction {
                        insn: StlInsn::Jump,
                        operand: Some(ast::Operand { kind: OperandKind::Label(target), span }),
                        ..
                    },
                ) => targets.extend(self.jump(flow, region, target, *span)),
                _ => break,
            }
            length += 1;
        }
        let entries = flow.statements[at..at + length]
            .iter()
            .filter(|(_, statement)| !matches!(statement.kind, StatementKind::Empty))
            .count();
        let end = flow.statements.get(at + length).map(|(_, statement)| *statement);
        let ends_at_label = end.and_then(|end| end.label.as_ref()).is_some_and(|label| label.name == *default);
        let problem = if !ends_at_label {
            let end = end.map_or(mnemonic, |end| end.span);
            Some((end, format!("the list of `{name}` ends here, but not at the label `{default}`")))
        } else if entries > JUMP_LIST_MAX {
            Some((mnemonic, format!("the list of `{name}` has {entries} entries; {JUMP_LIST_MAX} are possible")))
        } else {
            None
        };
        // If the label does not exist at all, that is already reported.
        if let (Some((place, title)), Some(_)) = (problem, default_label) {
            self.program.report(
                Diagnostic::new(Code::JumpList, place, title)
                    .label("only unconditional jumps are possible between it and its label")
                    .also(mnemonic, "the jump distributor")
                    .help(format!("write the jumps directly after it, then `{default}:`")),
            );
        }
        let kind = match default_label {
            Some(default) if self.program.globals.report.diagnostics.len() == before => {
                Some(StlStatementKind::JumpList { targets, default })
            }
            _ => None,
        };
        (length, kind)
    }
}
