//! Probes: calls that tell who looks at the program what its statements see. They are in the code only if
//! [`lower_with_probes`](crate::lower_with_probes) makes it.
//!
//! A probe has a place, its index in the list that comes with the code. STL has a probe of the registers after each statement; SCL, LAD,
//! FBD and GRAPH have one for each value that is read, computed or written at a place of the source; the STL of an S7-200 has one of the
//! logic stack after each statement. Each block tells when it begins and ends. Blocks of the library have no other probes.

use plcc_abi::image::Site;
use plcc_abi::{RuntimeFn, Type};
use plcc_diag::Span;
use plcc_ir::{BinaryOp, FunctionBuilder, Value};
use plcc_model::scl::{Access, Actual, Call, Expr, ExprKind};
use plcc_model::types::Elementary;
use plcc_model::{BlockKey, Body, CellKind, CodeBlock, Direction, Number, Operand, StlStatement, StlStatementKind};

use crate::block::BlockLowering;

/// Where a probe is, and what it tells.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    pub block: BlockKey,
    pub span: Span,
    /// 0: none.
    pub network: u16,
    pub probe: Probe,
}

/// What a probe tells.
#[derive(Clone, Debug, PartialEq)]
pub enum Probe {
    /// A block begins or ends.
    Block,
    /// The registers after a statement of STL. The timer or counter that it names, if it is known.
    Registers(Option<(CellKind, u16)>),
    /// The value of a variable that is read.
    Variable(Elementary),
    /// A value that is computed.
    Value(Elementary),
    /// A value that is written.
    Written(Elementary),
    /// The logic stack of an S7-200 after a statement: S0 is bit 0, ENO bit 9. The operands of the statement that have addresses.
    Stack(Vec<String>),
}

/// The list of places, while code is made.
#[derive(Default)]
pub(crate) struct Probes {
    /// `None`: no probes.
    pub places: Option<Vec<Place>>,
    /// Sites of other code of the same program.
    pub sites: Vec<Site>,
}

impl Probes {
    /// A new place; `None` without probes.
    pub fn add(&mut self, place: impl FnOnce() -> Place) -> Option<u32> {
        let places = self.places.as_mut()?;
        places.push(place());
        Some(places.len() as u32 - 1)
    }
}

/// The call of a probe of a value with up to 64 bits.
pub(crate) fn value(b: &mut FunctionBuilder, place: u32, value: Value) {
    let long = if b.ty(value) == Type::I64 { value } else { b.zext(Type::I64, value) };
    let place = b.i32_const(place);
    b.call_runtime(RuntimeFn::ProbeValue, &[place, long]);
}

/// The call of a probe where a block begins.
pub(crate) fn enter(b: &mut FunctionBuilder, place: u32, instance: Value) {
    let place = b.i32_const(place);
    b.call_runtime(RuntimeFn::ProbeEnter, &[place, instance]);
}

/// The call of a probe where a block ends.
pub(crate) fn leave(b: &mut FunctionBuilder, place: u32) {
    let place = b.i32_const(place);
    b.call_runtime(RuntimeFn::ProbeLeave, &[place]);
}

impl BlockLowering<'_, '_> {
    fn probe_place(&mut self, span: Span, probe: Probe) -> Option<u32> {
        let block: &CodeBlock = self.block;
        let network = match &block.body {
            Body::Scl(body) => body.network_at(span.start),
            Body::Stl(_) | Body::S7200(_) | Body::Runtime => self.network,
        };
        self.output.probes.add(|| Place { block: block.key(), span, network, probe })
    }

    /// Whether code at `span` is looked at.
    fn is_probed(&self, span: Span) -> bool {
        self.output.probes.places.is_some()
            && !self.block.library
            && span.file == self.block.span.file
            && self.b.is_reachable()
    }

    /// The block begins.
    pub fn probe_enter(&mut self) {
        let Some(place) = self.probe_place(self.block.span, Probe::Block) else { return };
        self.block_place = Some(place);
        let instance = self.instance.unwrap_or_else(|| self.b.i32_const(0));
        enter(&mut self.b, place, instance);
    }

    /// The block ends here.
    pub fn probe_leave(&mut self) {
        if let Some(place) = self.block_place {
            leave(&mut self.b, place);
        }
    }

    /// Lowers a statement of STL with the probe after it. One that leaves, or may leave, is also told before.
    pub fn probed_statement(&mut self, statement: &StlStatement, lower: impl FnOnce(&mut Self)) {
        let is_code = matches!(
            statement.kind,
            StlStatementKind::Instruction { .. } | StlStatementKind::Call(_) | StlStatementKind::JumpList { .. }
        );
        if !is_code || !self.is_probed(statement.span) {
            return lower(self);
        }
        self.network = statement.network;
        let cell = match &statement.kind {
            StlStatementKind::Instruction {
                operand: Operand::Cell { kind, number: Number::Known(number) }, ..
            } => Some((*kind, *number)),
            _ => None,
        };
        let Some(place) = self.probe_place(statement.span, Probe::Registers(cell)) else { return lower(self) };
        if leaves(statement) {
            self.probe_registers(place);
        }
        lower(self);
        if self.b.is_reachable() {
            self.probe_registers(place);
        }
    }

    fn probe_registers(&mut self, place: u32) {
        let status = self.status_word(true);
        let regs = &self.regs;
        let vars = [regs.accu[0], regs.accu[1], regs.ar[0], regs.ar[1], regs.db, regs.di];
        let [accu1, accu2, ar1, ar2, db, di] = vars.map(|var| self.get(var));
        let db = self.b.binary_imm(BinaryOp::And, db, 0xFFFF);
        let di = self.b.binary_imm(BinaryOp::Shl, di, 16);
        let dbs = self.b.or(db, di);
        let place = self.b.i32_const(place);
        self.b.call_runtime(RuntimeFn::ProbeRegisters, &[place, status, accu1, accu2, ar1, ar2, dbs]);
    }

    /// An expression has this value.
    pub fn probe_expr(&mut self, expr: &Expr, value: Value) {
        if !matches!(expr.kind, ExprKind::Const(_)) && self.is_probed(expr.span) {
            let probe = match expr.kind {
                ExprKind::Load(_) | ExprKind::Cell { .. } => Probe::Variable(expr.ty),
                _ => Probe::Value(expr.ty),
            };
            self.probe_value(expr.span, probe, expr.ty, value);
        }
    }

    /// A variable gets this value.
    pub fn probe_write(&mut self, access: &Access, value: Value) {
        if let (Some(ty), true) = (access.elementary(), self.is_probed(access.span)) {
            self.probe_value(access.span, Probe::Written(ty), ty, value);
        }
    }

    fn probe_value(&mut self, span: Span, probe: Probe, ty: Elementary, seen: Value) {
        let Some(place) = self.probe_place(span, probe) else { return };
        let bits = self.untyped(seen, ty);
        value(&mut self.b, place, bits);
    }

    /// The outputs that a function has written into variables of this block.
    pub fn probe_outputs(&mut self, call: &Call, callee: &CodeBlock) {
        if call.instance.is_some() || self.output.probes.places.is_none() {
            return;
        }
        for argument in &call.arguments {
            let direction = callee.interface.parameters[argument.parameter].direction;
            let Actual::Variable { access, .. } = &argument.actual else { continue };
            if direction != Direction::Input && is_plain(access) && self.is_probed(access.span) {
                let value = self.read_access(access);
                self.probe_write(access, value);
            }
        }
    }
}

/// Whether a variable can be read once more without an effect.
fn is_plain(access: &Access) -> bool {
    use plcc_model::Place as P;
    use plcc_model::scl::Base;
    access.indices.is_empty()
        && match &access.base {
            Base::Place(place) => matches!(
                place,
                P::I { .. } | P::Q { .. } | P::M { .. } | P::L { .. } | P::Db { .. } | P::Instance { .. }
            ),
            Base::Indexed { .. } => false,
        }
}

/// Whether a statement does not, or not always, go on to the next one.
fn leaves(statement: &StlStatement) -> bool {
    use plcc_syntax::stl::StlInsn as I;
    match &statement.kind {
        StlStatementKind::JumpList { .. } => true,
        StlStatementKind::Instruction { insn, operand } => {
            matches!(operand, Operand::Label(_))
                || matches!(insn, I::BlockEnd | I::BlockEndUnconditional | I::BlockEndConditional)
        }
        StlStatementKind::Label(_)
        | StlStatementKind::Call(_)
        | StlStatementKind::Assert(_)
        | StlStatementKind::Sleep(_) => false,
    }
}
