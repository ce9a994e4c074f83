//! Jumps, labels, RET. Source: LAD/FBD reference C.12.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::Elementary;
use plcc_syntax::network::ast::{Comparison, Content, Network, PinValue};
use plcc_syntax::network::elements::ReturnValue;
use plcc_syntax::scl::ast::{BinaryOp as Operator, Expr as Node, ExprKind as NodeKind, Name};

use super::TOP;
use super::pins::{connected, inverted, no, yes};
use super::sheet::Sheet;
use crate::bind::network::NetworkBinder;
use crate::bind::scl::SclBlock;
use crate::bind::scl::scope::Label;
use crate::bind::scl::value::Value;
use plcc_binding::fold;
use plcc_model::LabelId;
use plcc_model::scl::{Arm, Statement, StatementKind};

impl NetworkBinder<'_, '_> {
    /// Labels of all networks, including those of SCL networks.
    pub fn collect_network_labels(&mut self, ctx: &mut SclBlock, networks: &[Network]) {
        for network in networks {
            match &network.content {
                Content::Graphic(_) => {}
                Content::Scl(list) => {
                    self.scl().collect_labels(ctx, list);
                    // The networks of a block are one list of statements.
                    let inside = list.as_ptr() as usize;
                    for label in ctx.scope.labels.values_mut().filter(|label| label.list == inside && !list.is_empty())
                    {
                        label.list = TOP;
                    }
                }
                Content::Stl(list) => {
                    for label in list.iter().filter_map(|statement| statement.label.as_ref()) {
                        self.block_label(ctx, &label.name, label.span);
                    }
                }
            }
            for label in &network.labels {
                self.block_label(ctx, &label.text, label.span);
            }
        }
    }

    fn block_label(&mut self, ctx: &mut SclBlock, name: &str, span: Span) {
        if let Some(first) = ctx.scope.labels.get(&fold(name)).map(|label| label.span) {
            self.program.report(
                Diagnostic::new(Code::DuplicateLabel, span, format!("the label `{name}` is defined twice"))
                    .label("the second one")
                    .also(first, "the first one")
                    .help("labels are unique in their block; upper and lower case are the same"),
            );
            return;
        }
        let id = LabelId(ctx.scope.labels.len() as u32);
        ctx.scope.labels.insert(fold(name), Label { id, span, list: TOP });
    }

    /// The jump to the label that a pin names.
    fn jump_to(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<StatementKind> {
        let name = label_name(node)?;
        let told = self.program.globals.report.diagnostics.len();
        let found = self.scl().goto(ctx, name);
        for message in
            self.program.globals.report.diagnostics[told..].iter_mut().filter(|one| one.code == Code::UnknownLabel)
        {
            message.help = Some(format!("give the label `{}` to the network to jump to", name.text));
        }
        found.map(StatementKind::Goto)
    }

    pub fn jump_coil(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, negated: bool) -> Option<()> {
        let element = sheet.element(at);
        let flow = self.flow(ctx, sheet, at, "in")?;
        let condition = if negated { inverted(flow) } else { flow };
        let node = self.operand_node(element, "label")?;
        let kind = self.jump_to(ctx, &node)?;
        self.conditional(sheet, condition, kind, element.span);
        Some(())
    }

    /// JMP_LIST: jumps to the label with number K; other numbers continue.
    pub fn jump_list_box(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let flow = self.flow(ctx, sheet, at, "en")?;
        let selector = self.input(ctx, sheet, at, "k")?;
        let selector = self.scl().own_type(ctx, selector)?;
        let mut arms = Vec::new();
        for pin in &element.pins {
            let Some(number) = pin.name.strip_prefix("dest").and_then(|digits| digits.parse::<i128>().ok()) else {
                continue;
            };
            let PinValue::Operand(node) = &pin.value else { continue };
            let body = vec![Statement { kind: self.jump_to(ctx, node)?, span: pin.span }];
            arms.push(Arm { ranges: vec![(number, number)], body });
        }
        self.conditional(sheet, flow, StatementKind::Case { selector, arms, otherwise: Vec::new() }, span);
        Some(())
    }

    /// SWITCH: jumps to the label of the first comparison that is true.
    pub fn switch_box(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let flow = self.flow(ctx, sheet, at, "en")?;
        let selector = self.input(ctx, sheet, at, "k")?;
        let selector = self.scl().own_type(ctx, selector)?;
        let selector = sheet.keep(ctx, selector);
        let mut branches = Vec::new();
        for (number, comparison) in element.cases.iter().enumerate() {
            let value = self.input(ctx, sheet, at, &format!("case{number}"))?;
            let left = Value::Elementary(selector.clone());
            let condition = self.box_compare(ctx, operator(*comparison), left, value, span)?;
            let Some(node) = self.operand_node(element, &format!("dest{number}")) else { continue };
            branches.push((condition, vec![Statement { kind: self.jump_to(ctx, &node)?, span }]));
        }
        let otherwise = match connected(element, "else").map(|pin| &pin.value) {
            Some(PinValue::Operand(node)) => vec![Statement { kind: self.jump_to(ctx, node)?, span }],
            _ => Vec::new(),
        };
        if branches.is_empty() {
            for statement in otherwise {
                self.conditional(sheet, flow.clone(), statement.kind, span);
            }
            return Some(());
        }
        self.conditional(sheet, flow, StatementKind::If { branches, otherwise }, span);
        Some(())
    }

    /// RET: leaves the block with its ENO.
    pub fn return_coil(&mut self, ctx: &mut SclBlock, sheet: &mut Sheet, at: usize, value: ReturnValue) -> Option<()> {
        let element = sheet.element(at);
        let span = element.span;
        let flow = self.flow(ctx, sheet, at, "in")?;
        let eno = match value {
            ReturnValue::True => yes(span),
            ReturnValue::False => no(span),
            ReturnValue::Operand => match connected(element, "operand") {
                Some(_) => self.input_of(ctx, sheet, at, "operand", Elementary::Bool)?,
                None => flow.clone(),
            },
        };
        self.conditional(sheet, flow, StatementKind::Return(Some(eno)), span);
        Some(())
    }
}

/// The name of a label at a pin.
fn label_name(node: &Node) -> Option<&Name> {
    match &node.kind {
        NodeKind::Name(name) => Some(name),
        _ => None,
    }
}

const fn operator(comparison: Comparison) -> Operator {
    match comparison {
        Comparison::Equal => Operator::Equal,
        Comparison::NotEqual => Operator::NotEqual,
        Comparison::Less => Operator::Less,
        Comparison::LessEqual => Operator::LessEqual,
        Comparison::Greater => Operator::Greater,
        Comparison::GreaterEqual => Operator::GreaterEqual,
    }
}
