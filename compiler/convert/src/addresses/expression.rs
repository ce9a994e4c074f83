//! Operands of SCL, networks and charts, where an address has the type of its width.

use plcc_diag::Span;
use plcc_syntax::ast::{Area, BlockName, BlockPrefix, Bound, CellKind, OperandKind, PathPart, Width};
use plcc_syntax::chart::ast::{Action, ActionBody, Body as Chart, Call, Condition, Permanent, PermanentKind};
use plcc_syntax::network::ast::{Content, Network, PinValue, Source, Target};
use plcc_syntax::scl::ast::{Expr, ExprKind, Literal, Name, NameForm, Statement, StatementKind};
use plcc_syntax::scl::{absolute, db_address};
use plcc_syntax::stl::Mnemonics;
use plcc_syntax::symbols::SymbolTarget;

use super::names::Component;
use super::{Editor, To};
use crate::names;
use crate::operand::{address, area_letters};

impl Editor<'_> {
    pub(super) fn scl_statements(&mut self, statements: &[Statement]) {
        statements.iter().for_each(|statement| self.scl_statement(statement));
    }

    fn scl_statement(&mut self, statement: &Statement) {
        match &statement.kind {
            StatementKind::Expression(value) => self.expression(value),
            StatementKind::Assign { targets, value } => {
                targets.iter().for_each(|(target, _)| self.expression(target));
                self.expression(value);
            }
            StatementKind::If { branches, otherwise } => {
                for (condition, body) in branches {
                    self.expression(condition);
                    self.scl_statements(body);
                }
                self.scl_statements(otherwise);
            }
            StatementKind::Case { selector, arms, otherwise } => {
                self.expression(selector);
                arms.iter().for_each(|arm| self.scl_statements(&arm.body));
                self.scl_statements(otherwise);
            }
            StatementKind::For { variable, start, end, step, body } => {
                [variable, start, end].into_iter().chain(step).for_each(|value| self.expression(value));
                self.scl_statements(body);
            }
            StatementKind::While { condition, body } | StatementKind::Repeat { body, until: condition } => {
                self.expression(condition);
                self.scl_statements(body);
            }
            StatementKind::Return(value) => value.iter().for_each(|value| self.expression(value)),
            StatementKind::Empty
            | StatementKind::Label(_)
            | StatementKind::Exit
            | StatementKind::Continue
            | StatementKind::Goto(_)
            | StatementKind::Pragma(_)
            | StatementKind::Error => {}
        }
    }

    pub(super) fn network(&mut self, network: &Network) {
        let graph = match &network.content {
            Content::Graphic(graph) => graph,
            Content::Scl(statements) => return self.scl_statements(statements),
            Content::Stl(statements) => return statements.iter().for_each(|statement| self.stl_statement(statement)),
        };
        for net in &graph.nets {
            for source in &net.sources {
                match source {
                    Source::Operand { value, .. } => self.expression(value),
                    Source::Rail | Source::Pin { .. } | Source::Net(_) => {}
                }
            }
        }
        for element in &graph.elements {
            match &element.target {
                // Blocks of networks go by their names.
                Target::Block { .. } | Target::Element { .. } => {}
            }
            for pin in &element.pins {
                match &pin.value {
                    PinValue::Operand(value) => self.expression(value),
                    PinValue::Net(_) | PinValue::Open => {}
                }
            }
        }
    }

    pub(super) fn chart(&mut self, chart: &Chart) {
        chart.before.iter().chain(&chart.after).for_each(|one| self.permanent(one));
        for step in &chart.steps {
            step.actions.iter().for_each(|action| self.action(action));
            step.interlock.iter().chain(&step.supervision).for_each(|condition| self.condition(condition));
        }
        chart
            .transitions
            .iter()
            .filter_map(|one| one.condition.as_ref())
            .for_each(|condition| self.condition(condition));
    }

    fn condition(&mut self, condition: &Condition) {
        match condition {
            Condition::Expression(value) => self.expression(value),
            Condition::Network(network) => self.network(network),
            Condition::Statements(statements) => self.scl_statements(statements),
        }
    }

    fn permanent(&mut self, permanent: &Permanent) {
        match &permanent.kind {
            PermanentKind::Coil { operand, value, .. } => {
                [operand, value].into_iter().for_each(|one| self.expression(one))
            }
            PermanentKind::Call(call) => self.chart_call(call),
            PermanentKind::Network(network) => self.network(network),
        }
    }

    fn action(&mut self, action: &Action) {
        match &action.body {
            ActionBody::Operand(value) => self.expression(value),
            ActionBody::Value { operand, value } => [operand, value].into_iter().for_each(|one| self.expression(one)),
            ActionBody::Call(call) => self.chart_call(call),
            ActionBody::Statements(statements) => self.scl_statements(statements),
            ActionBody::Network(network) => self.network(network),
            ActionBody::All { .. } | ActionBody::Error => {}
        }
    }

    fn chart_call(&mut self, call: &Call) {
        call.parameters.iter().filter_map(|one| one.value.as_ref()).for_each(|value| self.expression(value));
    }

    fn expression(&mut self, value: &Expr) {
        match &value.kind {
            ExprKind::Name(name) => self.name(name, value.span),
            ExprKind::Absolute(operand) => self.absolute(operand, value.span),
            ExprKind::Member { base, .. } | ExprKind::MemberAbsolute { base, .. } => {
                if !self.data_operand(value) {
                    self.inside(base);
                }
            }
            ExprKind::Index { base, indices } => {
                indices.iter().for_each(|index| self.expression(index));
                // The indices of an address are its numbers.
                if indices.iter().any(|index| number_of(index).is_none()) || !self.data_operand(value) {
                    self.inside(base);
                }
            }
            ExprKind::Slice { base, .. } => self.inside(base),
            ExprKind::Call { callee: _, arguments } => {
                arguments
                    .iter()
                    .filter_map(|argument| argument.value.as_ref())
                    .for_each(|value| self.expression(value));
            }
            ExprKind::Dereference(operand) | ExprKind::Unary { operand, .. } => self.expression(operand),
            ExprKind::Binary { left, right, .. } => {
                self.expression(left);
                self.expression(right);
            }
            // A reference is one to a name.
            ExprKind::Literal(_) | ExprKind::Reference(_) | ExprKind::Error => {}
        }
    }

    /// Operands within the base of a path, whose own name stays.
    fn inside(&mut self, base: &Expr) {
        match &base.kind {
            ExprKind::Member { base, .. } | ExprKind::MemberAbsolute { base, .. } | ExprKind::Slice { base, .. } => {
                self.inside(base);
            }
            ExprKind::Index { base, indices } => {
                indices.iter().for_each(|index| self.expression(index));
                self.inside(base);
            }
            _ => {}
        }
    }

    fn is_own(&self, name: &Name) -> bool {
        match name.form {
            NameForm::Local => true,
            NameForm::Bare => self.locals.contains(&name.text.to_lowercase()),
            NameForm::Quoted => !self.is_tia && self.locals.contains(&name.text.to_lowercase()),
        }
    }

    fn name(&mut self, name: &Name, span: Span) {
        if self.is_own(name) {
            return;
        }
        match self.to {
            To::Absolute => {
                // `"tag":P`
                let (text, direct) = match names::without_periphery(&name.text) {
                    Some(tag) if self.is_tia && name.form == NameForm::Quoted => (tag, ":P"),
                    _ => (name.text.as_str(), ""),
                };
                let Some(found) = self.names.target(text) else { return };
                match found.target {
                    SymbolTarget::Memory { area, width, byte, bit } => {
                        if !Self::is_natural(found.ty, width) {
                            return self.not_natural(span, &found.name);
                        }
                        self.edit(span, self.memory(area, width, byte, bit) + direct);
                    }
                    SymbolTarget::Cell { kind, number } => {
                        let letter = if kind == CellKind::Timer { "T" } else { "C" };
                        self.edit(span, format!("{}{letter}{number}", self.percent()));
                    }
                    // Blocks go by their names.
                    SymbolTarget::Block { .. } => {}
                }
            }
            To::Symbolic => {
                // `MW10` is a name to the parser, unless something is called so.
                if name.form == NameForm::Bare
                    && self.names.target(&name.text).is_none()
                    && let Some(operand) = absolute(&name.text)
                {
                    self.absolute(&operand, span);
                }
            }
        }
    }

    fn absolute(&mut self, operand: &OperandKind, span: Span) {
        if self.to == To::Absolute {
            return;
        }
        let memory = |area, width: &Width, byte: &u32, bit: &u8| SymbolTarget::Memory {
            area,
            width: *width,
            byte: *byte,
            bit: *bit,
        };
        let (target, direct) = match operand {
            OperandKind::Absolute { area: area @ (Area::I | Area::Q | Area::M), width, byte, bit } => {
                (memory(*area, width, byte, bit), "")
            }
            // `%IW4:P`
            OperandKind::Absolute { area: Area::Pi, width, byte, bit } if self.is_tia => {
                (memory(Area::I, width, byte, bit), ":P")
            }
            OperandKind::Absolute { area: Area::Pq, width, byte, bit } if self.is_tia => {
                (memory(Area::Q, width, byte, bit), ":P")
            }
            OperandKind::Cell { kind, number } => (SymbolTarget::Cell { kind: *kind, number: *number }, ""),
            OperandKind::DbAbsolute { db, width, byte, bit } => {
                let Some(number) = self.names.db_number(db) else { return };
                return self.component(number, (*width, *byte, *bit), span);
            }
            _ => return,
        };
        let Some(found) = self.the_symbol(target, span) else { return };
        if let SymbolTarget::Memory { width, .. } = target
            && !Self::is_natural(found.ty, width)
        {
            return self.not_natural(span, &found.name);
        }
        if self.is_hidden(&found.name, span) {
            return;
        }
        self.edit(span, names::symbol(&found.name) + direct);
    }

    /// Whether a variable of the block hides a symbol: then its address stays, with a warning.
    fn is_hidden(&mut self, name: &str, span: Span) -> bool {
        let is_hidden = self.locals.contains(&name.to_lowercase()) && !self.is_tia;
        if is_hidden {
            self.stays(span, name, "a variable of the block has the same name", "give the variable another name");
        }
        is_hidden
    }

    /// A component of a data block, or an address in one; false if it is neither.
    fn data_operand(&mut self, value: &Expr) -> bool {
        let mut parts = Vec::new();
        let mut at = value;
        let (root, place) = loop {
            match &at.kind {
                ExprKind::Member { base, name } => {
                    // Classic: `DB10.DW4`.
                    if parts.is_empty()
                        && name.form == NameForm::Bare
                        && let Some((width, byte)) = db_address(&name.text)
                        && let ExprKind::Name(root) = &base.kind
                    {
                        break (root, Some((width, byte, 0)));
                    }
                    parts.insert(0, PathPart::Member { name: name.text.clone(), span: name.span });
                    at = base;
                }
                ExprKind::MemberAbsolute { base, width, byte, bit } if parts.is_empty() => match &base.kind {
                    ExprKind::Name(root) => break (root, Some((*width, *byte, *bit))),
                    _ => return false,
                },
                ExprKind::Index { base, indices } => {
                    let numbers: Option<Vec<i64>> = indices.iter().map(number_of).collect();
                    let Some(numbers) = numbers else { return false };
                    let values = numbers.into_iter().map(|number| Bound::Number(number, at.span)).collect();
                    parts.insert(0, PathPart::Index { values, span: at.span });
                    at = base;
                }
                ExprKind::Name(root) => break (root, None),
                _ => return false,
            }
        };
        if self.is_own(root) {
            return false;
        }
        let name = match absolute(&root.text).filter(|_| root.form == NameForm::Bare) {
            Some(OperandKind::Block(name)) => name,
            _ => BlockName::Symbol { name: root.text.clone(), span: root.span },
        };
        let Some(number) = self.names.db_number(&name) else { return false };
        match (self.to, place) {
            (To::Absolute, None) => match self.names.component(number, &parts) {
                Some(found) if Self::is_natural(Some(found.ty), found.width) => {
                    self.edit(value.span, self.scl_component(&found));
                    true
                }
                Some(_) => {
                    self.not_natural(value.span, &root.text);
                    true
                }
                None => false,
            },
            (To::Symbolic, Some(place)) => {
                self.component(number, place, value.span);
                true
            }
            (To::Absolute, Some(_)) | (To::Symbolic, None) => true,
        }
    }

    /// An address in a data block that has a symbol.
    fn component(&mut self, db: u16, (width, byte, bit): (Width, u32, u8), span: Span) {
        let Some((path, ty)) = self.names.path(db, width, byte, bit) else { return };
        let target = SymbolTarget::Block { prefix: BlockPrefix::Db, number: u32::from(db) };
        let Some(found) = self.the_symbol(target, span) else { return };
        if !Self::is_natural(Some(ty), width) {
            return self.not_natural(span, &format!("{}.{path}", found.name));
        }
        if self.is_hidden(&found.name, span) {
            return;
        }
        self.edit(span, format!("{}.{path}", names::symbol(&found.name)));
    }

    /// `%MW10`, `MW10`
    fn memory(&self, area: Area, width: Width, byte: u32, bit: u8) -> String {
        // SCL has the letters of its editor; the international ones are read in every source.
        format!("{}{}{}", self.percent(), area_letters(area, width, Mnemonics::En), address(width, byte, bit))
    }

    /// `%DB10.DBW4`, `DB10.DW4`
    fn scl_component(&self, found: &Component) -> String {
        let letters = area_letters(Area::Db, found.width, Mnemonics::En);
        format!("{}DB{}.{letters}{}", self.percent(), found.db, address(found.width, found.byte, found.bit))
    }

    fn percent(&self) -> &'static str {
        if self.is_tia { "%" } else { "" }
    }
}

/// The value of an index that is a number.
fn number_of(value: &Expr) -> Option<i64> {
    match &value.kind {
        ExprKind::Literal(Literal::Integer { value, .. }) => i64::try_from(*value).ok(),
        _ => None,
    }
}
