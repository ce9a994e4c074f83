//! Uses in the typed tree: SCL, LAD, FBD and GRAPH.

use std::collections::HashMap;

use plcc_abi::image::BlockKind;
use plcc_diag::Span;
use plcc_model::scl::walk::{self, Role, Visitor};
use plcc_model::scl::{
    Access as Variable, Actual, Base, Call, Complex, Expr, ExprKind, Instance, SclBody, Statement, StatementKind,
};
use plcc_model::{BlockKey, CellKind, Number, Place, Program, layout};

use super::Collector;
use crate::Access;
use crate::operand::Operand;

impl Collector<'_> {
    pub(super) fn scl(&mut self, body: &SclBody) {
        let mut walk = Walk { collector: self, body, variables: Vec::new(), usage: HashMap::new() };
        walk::statements(&body.statements, &mut walk);
        let Walk { variables, usage, .. } = walk;
        for (variable, network) in variables {
            let access = usage.get(&variable.identity).copied().unwrap_or(Access::Read);
            self.network = network;
            self.place(&variable.place, variable.bits, access, variable.span);
        }
        for &(number, span) in &body.named_dbs {
            self.network = body.network_at(span.start);
            self.add_at(Operand::db(number), Access::Open, span);
        }
    }
}

/// A variable that the walk has met.
struct Met {
    /// Where it is in the tree.
    identity: *const Variable,
    place: Place,
    bits: u32,
    span: Span,
}

struct Walk<'c, 'a, 'b> {
    collector: &'c mut Collector<'a>,
    body: &'b SclBody,
    /// With their networks.
    variables: Vec<(Met, u16)>,
    /// What is done with those that are not only read: it is often known after they are met.
    usage: HashMap<*const Variable, Access>,
}

impl Walk<'_, '_, '_> {
    fn uses(&mut self, variable: &Variable, access: Access) {
        self.usage.insert(std::ptr::from_ref(variable), access);
    }

    fn number(&mut self, number: &Number, kind: CellKind, access: Access) {
        match kind {
            CellKind::Timer => self.collector.number(number, Operand::Timer, access),
            CellKind::Counter => self.collector.number(number, Operand::Counter, access),
        }
    }
}

impl Visitor for Walk<'_, '_, '_> {
    fn statement(&mut self, statement: &Statement) {
        self.collector.span = statement.span;
        if statement.span.file == self.collector.block.span.file {
            self.collector.network = self.body.network_at(statement.span.start);
        }
        match &statement.kind {
            StatementKind::Assign { target, .. }
            | StatementKind::AssignText { target, .. }
            | StatementKind::Copy { target, .. } => self.uses(target, Access::Write),
            StatementKind::For { variable, .. } => self.uses(variable, Access::ReadWrite),
            StatementKind::Stl(statement) => {
                self.collector.span = statement.span;
                self.collector.stl_statement(&statement.kind);
            }
            _ => {}
        }
    }

    fn expr(&mut self, value: &Expr) {
        match &value.kind {
            ExprKind::Timer(call) => {
                self.number(&call.timer, CellKind::Timer, Access::ReadWrite);
                call.q.iter().chain(&call.bi).for_each(|target| self.uses(target, Access::Write));
            }
            ExprKind::Counter(call) => {
                self.number(&call.counter, CellKind::Counter, Access::ReadWrite);
                call.q.iter().chain(&call.cv).for_each(|target| self.uses(target, Access::Write));
            }
            ExprKind::Cell { kind, number } => self.number(number, *kind, Access::Read),
            _ => {}
        }
    }

    fn access(&mut self, variable: &Variable, _role: Role) {
        let Base::Place(place) = &variable.base else { return };
        let own = variable.elementary().map_or_else(|| layout::used_bits(&variable.ty), |ty| ty.bits());
        // All elements that a computed index can choose.
        let bits = variable.indices.iter().fold(own, |bits, index| match index.bounds.known() {
            Some((low, high)) => {
                let others = u32::try_from(i64::from(high) - i64::from(low)).unwrap_or(0);
                bits.saturating_add(others.saturating_mul(index.stride))
            }
            None => bits,
        });
        let met = Met { identity: variable, place: place.clone(), bits, span: variable.span };
        self.variables.push((met, self.collector.network));
    }

    fn call(&mut self, call: &Call) {
        self.collector.span = call.span;
        self.collector.add(Operand::Block(call.target), Access::Call);
        match &call.instance {
            Some(Instance::Db(number)) => {
                self.collector.add(Operand::Block(BlockKey { kind: BlockKind::Db, number: *number }), Access::Call);
            }
            Some(Instance::Variable(instance)) => self.uses(instance, Access::Call),
            None => {}
        }
        if let Some(eno) = &call.eno {
            self.uses(eno, Access::Write);
        }
        let program: &Program = self.collector.program;
        let Some(callee) = program.block(call.target) else { return };
        for argument in &call.arguments {
            let Some(parameter) = callee.interface.parameters.get(argument.parameter) else { continue };
            let access = self.collector.access_by(call.target, parameter);
            match argument.actual.pointer() {
                Actual::Variable { access: variable, .. }
                | Actual::Reference(variable)
                | Actual::PointerTo { access: variable, .. } => self.uses(variable, access),
                Actual::Complex(Complex::Variable(variable)) => self.uses(variable, access),
                Actual::PointerToComplex { value: Complex::Variable(variable), .. } => self.uses(variable, access),
                Actual::Number(number) => self.collector.passed_number(number, parameter),
                Actual::PointerBytes(bytes) => self.collector.pointer(bytes, parameter.passing, access, argument.span),
                Actual::Value(_)
                | Actual::Complex(_)
                | Actual::PointerCopy(_)
                | Actual::PointerToValue { .. }
                | Actual::PointerToComplex { .. }
                | Actual::Variant(..)
                | Actual::Dropped => {}
            }
        }
    }
}
