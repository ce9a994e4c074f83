//! Statements: assignments, branches, loops and jumps.

use plcc_model::scl::{Access, Arm, CompareOp, Expr, ExprKind, Statement, StatementKind};
use plcc_model::types::{DataType, Elementary, Member};
use plcc_syntax::ast::{Operand, OperandKind, PathPart};
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::character::is_character;
use super::code::number;

/// A loop around the current statement.
pub struct Loop {
    exit: String,
    next: String,
    /// EXIT and CONTINUE jump there.
    exits: bool,
    continues: bool,
}

impl Loop {
    fn new(exit: &str, next: &str) -> Loop {
        Loop { exit: exit.to_string(), next: next.to_string(), exits: false, continues: false }
    }
}

impl Maker<'_> {
    fn statements(&mut self, list: &[Statement]) {
        for statement in list {
            self.go_to(statement.span);
            self.statement(statement);
        }
    }

    pub fn statement(&mut self, statement: &Statement) {
        let mark = self.mark();
        self.refused = false;
        match &statement.kind {
            StatementKind::Watch(on) => self.watches = *on,
            _ if self.watches => self.watched(statement),
            StatementKind::Assign { target, value } => self.assign(target, value),
            StatementKind::AssignText { target, value } => self.assign_text(target, value, statement),
            StatementKind::Copy { target, source, bytes } => self.copy(target, source, *bytes, statement),
            StatementKind::SetFlag(value) => {
                self.condition(value);
                let flag = self.flag.clone();
                self.push(StlInsn::Assign, flag);
            }
            StatementKind::Call(call) => {
                self.call(call);
            }
            StatementKind::Evaluate(value) => match value.ty {
                Elementary::Bool => self.condition(value),
                _ => self.number(value),
            },
            StatementKind::If { branches, otherwise } => self.branches(branches, otherwise, statement),
            StatementKind::Case { selector, arms, otherwise } => self.case(selector, arms, otherwise, statement),
            StatementKind::For { variable, start, end, step, body } => {
                self.count(variable, [start, end, step], body, statement);
            }
            StatementKind::While { condition, body } => self.while_true(condition, body, statement),
            StatementKind::Repeat { body, until } => self.repeat(body, until),
            StatementKind::Exit => {
                self.leave(|inner| {
                    inner.exits = true;
                    &inner.exit
                });
            }
            StatementKind::Continue => {
                self.leave(|inner| {
                    inner.continues = true;
                    &inner.next
                });
            }
            StatementKind::Return(value) => {
                if let Some(value) = value {
                    self.condition(value);
                    let flag = self.flag.clone();
                    self.push(StlInsn::Assign, flag);
                }
                let end = self.end.take().unwrap_or_else(|| self.new_label());
                self.jump(StlInsn::Jump, &end);
                self.end = Some(end);
            }
            StatementKind::Goto(label) => {
                let name = self.label_of(*label);
                self.jump(StlInsn::Jump, &name);
            }
            StatementKind::Label(label) => {
                let name = self.label_of(*label);
                self.label(&name, statement.span.start);
                // A network has statements of its own.
                self.push(StlInsn::Nop, Some(number(0, self.span)));
            }
            // A block whose errors clear the bit is refused as a whole.
            StatementKind::Failed => {}
            StatementKind::Assert(_) | StatementKind::Sleep(_) | StatementKind::Apart => {}
            StatementKind::Stl(_) => self.refuse(statement.span, "a statement that is STL already", "write it in STL"),
        }
        self.release(&mark);
    }

    fn label_of(&mut self, label: plcc_model::LabelId) -> String {
        match self.labels.get(&label) {
            Some(name) => name.clone(),
            None => {
                let name = self.new_label();
                self.labels.insert(label, name.clone());
                name
            }
        }
    }

    fn leave(&mut self, label: impl Fn(&mut Loop) -> &String) {
        let name = self.loops.last_mut().map(|inner| label(inner).clone());
        let name = name.expect("the binder only passes EXIT and CONTINUE in loops");
        self.jump(StlInsn::Jump, &name);
    }

    // Assignments.

    pub fn assign(&mut self, target: &Access, value: &Expr) {
        if !self.has_type(value) {
            return;
        }
        if is_character(target) {
            return self.store_character(target, value);
        }
        let Some(target) = self.target(target, self.keeps_ar1(value)) else { return };
        match value.ty {
            Elementary::Bool => self.condition(value),
            _ => self.number(value),
        }
        let operand = self.reach(&target, value.ty);
        let insn = if value.ty == Elementary::Bool { StlInsn::Assign } else { StlInsn::Transfer };
        self.push(insn, Some(operand));
    }

    /// A constant structure, such as a DTL, component by component; false: STL cannot do that.
    pub fn store_components(&mut self, target: &Access, bytes: &[u8]) -> bool {
        let DataType::Struct(structure) = &target.ty else { return false };
        let values: Option<Vec<_>> = structure.members.iter().map(|member| component(member, bytes)).collect();
        let Some(values) = values.filter(|_| self.is_direct(target)) else { return false };
        let Some(Operand { kind: OperandKind::Path(path), .. }) = self.operand(target) else { return false };
        for (name, ty, bits) in values {
            let mut path = path.clone();
            path.parts.push(PathPart::Member { name, span: self.span });
            let constant = self.constant(ty, bits);
            self.push(StlInsn::Load, Some(constant));
            self.push(StlInsn::Transfer, Some(Operand { kind: OperandKind::Path(path), span: self.span }));
        }
        true
    }

    // Branches.

    fn branches(&mut self, branches: &[(Expr, Vec<Statement>)], otherwise: &[Statement], statement: &Statement) {
        let parts = self.positions.compound(statement.span.start);
        let end = self.new_label();
        // What the comments of an ELSE say, such as assertions, does not hold for the branch before it.
        let has_comments = parts.bodies.last().is_some_and(|from| self.positions.has_comment(*from, parts.end));
        let has_otherwise = has_comments || !otherwise.is_empty();
        for (at, (condition, body)) in branches.iter().enumerate() {
            let is_last = at + 1 == branches.len() && !has_otherwise;
            let next = if is_last { end.clone() } else { self.new_label() };
            self.go_to(condition.span);
            self.condition(condition);
            self.jump(StlInsn::JumpIfNot, &next);
            self.statements(body);
            let body_end = parts.bodies.get(at).copied().unwrap_or(statement.span.end);
            if !is_last {
                self.at(body_end);
                self.jump(StlInsn::Jump, &end);
                self.label(&next, body_end);
            }
        }
        self.statements(otherwise);
        self.at(parts.end);
        self.label(&end, parts.end);
        self.close_labels();
    }

    fn case(&mut self, selector: &Expr, arms: &[Arm], otherwise: &[Statement], statement: &Statement) {
        let parts = self.positions.compound(statement.span.start);
        self.go_to(selector.span);
        // Types without an order in STL become DINT.
        let (ty, less) = match selector.ty {
            Elementary::Sint => (Elementary::Dint, 0),
            Elementary::Dword | Elementary::Udint => (Elementary::Dint, 1_i128 << 31),
            ty => (ty, 0),
        };
        if super::logic::comparison(CompareOp::LessEqual, ty).is_none() {
            let what = format!("CASE of {}", selector.ty.name());
            return self.refuse(selector.span, what, "convert the value to DINT");
        }
        self.number(selector);
        self.as_side(selector.ty, true);
        let value = self.keep(ty);
        let (end, default) = (self.new_label(), self.new_label());
        let labels: Vec<String> = arms.iter().map(|_| self.new_label()).collect();
        for (arm, label) in arms.iter().zip(&labels) {
            for &(low, high) in arm.ranges.iter().filter(|(low, high)| low <= high) {
                self.in_range(&value, ty, low - less, high - less);
                self.jump(StlInsn::JumpIf, label);
            }
        }
        self.jump(StlInsn::Jump, &default);
        let mut from = selector.span.end;
        for (at, (arm, label)) in arms.iter().zip(&labels).enumerate() {
            let body_end = parts.bodies.get(at).copied().unwrap_or(statement.span.end);
            self.label(label, from);
            self.statements(&arm.body);
            self.at(body_end);
            self.jump(StlInsn::Jump, &end);
            from = body_end;
        }
        self.label(&default, from);
        self.statements(otherwise);
        self.label(&end, parts.end);
        self.close_labels();
    }

    /// The RLO is 1 if the value is in the range.
    fn in_range(&mut self, value: &Operand, ty: Elementary, low: i128, high: i128) {
        if low == high {
            return self.compare_with(value, ty, CompareOp::Equal, low);
        }
        for (op, limit) in [(CompareOp::GreaterEqual, low), (CompareOp::LessEqual, high)] {
            self.push(StlInsn::AndNest, None);
            self.compare_with(value, ty, op, limit);
            self.push(StlInsn::CloseNest, None);
        }
    }

    fn compare_with(&mut self, value: &Operand, ty: Elementary, op: CompareOp, limit: i128) {
        let insn = super::logic::comparison(op, ty).expect("types without comparison are refused");
        let limit = self.constant(ty, limit as u64 & (u64::MAX >> (64 - ty.bits())));
        self.push(StlInsn::Load, Some(value.clone()));
        self.push(StlInsn::Load, Some(limit));
        self.push(insn, None);
    }

    // Loops.

    fn count(&mut self, variable: &Access, [start, end, step]: [&Expr; 3], body: &[Statement], statement: &Statement) {
        if !self.is_direct(variable) {
            let help = "count in a variable of its own";
            return self.refuse(variable.span, "a FOR variable with a variable index", help);
        }
        let parts = self.positions.compound(statement.span.start);
        let ty = start.ty;
        let (add, up, down, greater) = match ty {
            Elementary::Int => (StlInsn::AddI, StlInsn::CompareLeI, StlInsn::CompareGeI, StlInsn::CompareGtI),
            Elementary::Dint | Elementary::Usint | Elementary::Uint => {
                (StlInsn::AddD, StlInsn::CompareLeD, StlInsn::CompareGeD, StlInsn::CompareGtD)
            }
            _ => {
                return self.refuse(variable.span, format!("FOR with {}", ty.name()), "count in INT or DINT");
            }
        };
        let Some(counter) = self.operand(variable) else { return };
        // End and step may read the variable: it has its first value by then.
        self.number(start);
        self.push(StlInsn::Transfer, Some(counter.clone()));
        let (last, by) = (self.fixed(end), self.fixed(step));
        let (head, next, exit) = (self.new_label(), self.new_label(), self.new_label());
        self.label(&head, self.span.end);
        let compare = |maker: &mut Self, insn: StlInsn, left: &Operand, right: &Operand| {
            maker.push(StlInsn::Load, Some(left.clone()));
            maker.push(StlInsn::Load, Some(right.clone()));
            maker.push(insn, None);
        };
        match step.kind {
            ExprKind::Const(bits) => {
                let negative = ty.is_signed() && bits >> (ty.bits() - 1) & 1 == 1;
                compare(self, if negative { down } else { up }, &counter, &last);
            }
            _ => {
                // Up for a step of at least 0, otherwise down.
                let zero = self.constant(ty, 0);
                for (sign, goes_on, joins) in [(up, up, StlInsn::AndNest), (greater, down, StlInsn::OrNest)] {
                    self.push(joins, None);
                    compare(self, sign, &zero, &by);
                    self.push(StlInsn::AndNest, None);
                    compare(self, goes_on, &counter, &last);
                    self.push(StlInsn::CloseNest, None);
                    self.push(StlInsn::CloseNest, None);
                }
            }
        }
        self.jump(StlInsn::JumpIfNot, &exit);
        self.loops.push(Loop::new(&exit, &next));
        self.statements(body);
        let inner = self.loops.pop();
        self.at(parts.end);
        if inner.is_some_and(|inner| inner.continues) {
            self.label(&next, parts.end);
        }
        self.push(StlInsn::Load, Some(counter.clone()));
        self.push(StlInsn::Load, Some(by));
        self.push(add, None);
        self.push(StlInsn::Transfer, Some(counter));
        self.jump(StlInsn::Jump, &head);
        self.label(&exit, parts.end);
        self.close_labels();
    }

    /// A value that stays while a loop runs.
    fn fixed(&mut self, value: &Expr) -> Operand {
        match value.kind {
            ExprKind::Const(bits) => self.constant(value.ty, bits),
            _ => {
                self.number(value);
                self.keep(value.ty)
            }
        }
    }

    fn while_true(&mut self, condition: &Expr, body: &[Statement], statement: &Statement) {
        let parts = self.positions.compound(statement.span.start);
        let (head, exit) = (self.new_label(), self.new_label());
        self.label(&head, statement.span.start);
        self.condition(condition);
        self.jump(StlInsn::JumpIfNot, &exit);
        self.loops.push(Loop::new(&exit, &head));
        self.statements(body);
        self.loops.pop();
        self.at(parts.end);
        self.jump(StlInsn::Jump, &head);
        self.label(&exit, parts.end);
        self.close_labels();
    }

    fn repeat(&mut self, body: &[Statement], until: &Expr) {
        let (head, next, exit) = (self.new_label(), self.new_label(), self.new_label());
        self.label(&head, self.span.start);
        self.loops.push(Loop::new(&exit, &next));
        self.statements(body);
        let inner = self.loops.pop();
        self.go_to(until.span);
        if inner.as_ref().is_some_and(|inner| inner.continues) {
            self.label(&next, until.span.start);
        }
        self.condition(until);
        self.jump(StlInsn::JumpIfNot, &head);
        if inner.is_some_and(|inner| inner.exits) {
            self.label(&exit, until.span.end);
        }
        self.at(until.span.end);
        self.close_labels();
    }
}

/// The name, the type and the value of a component with 8 to 32 bits, out of the bytes of its structure.
fn component(member: &Member, bytes: &[u8]) -> Option<(String, Elementary, u64)> {
    let DataType::Elementary(ty) = member.ty else { return None };
    let (start, bits) = (member.byte as usize, ty.bits());
    let own = bytes.get(start..start + bits as usize / 8).filter(|_| (8..=32).contains(&bits))?;
    Some((member.name.clone(), ty, own.iter().fold(0, |value, byte| (value << 8) | u64::from(*byte))))
}
