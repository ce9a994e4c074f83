//! Probes: calls that tell a watcher of the program what its statements see. They are in the code only if
//! [`lower_with_probes`](crate::lower_with_probes), [`lower_for_debugger`](crate::lower_for_debugger) or
//! [`lower_for_coverage`](crate::lower_for_coverage) makes it.
//!
//! For coverage there is one before each statement, also before those that no path leads to, and one for each bit that decides: see
//! [`Probe::Reached`], [`Probe::Contact`], [`Probe::Condition`] and [`Probe::Enable`].
//!
//! For a debugger there is one before each statement of STL, SCL and S7-200, each network of LAD and FBD, each action, step and transition of
//! GRAPH, and no other but those where blocks begin and end. It has the registers of the statement in memory, where they can be changed.
//! Variables are in memory as well. For the status of a block:
//!
//! A probe has a place, its index in the list that comes with the code. STL has a probe of the registers after each statement; SCL, LAD,
//! FBD and GRAPH have one for each value that is read, computed or written at a place of the source; the STL of an S7-200 has one of the
//! logic stack after each statement. Each block tells when it begins and ends. Blocks of the library have no other probes.

use plcc_abi::image::Site;
use plcc_abi::layout::state;
use plcc_abi::{RuntimeFn, Type};
use plcc_diag::Span;
use plcc_ir::{Address, BinaryOp, FunctionBuilder, Region, Value};
use plcc_model::scl::{Access, Actual, Call, Expr, ExprKind, Statement, StatementKind};
use plcc_model::types::Elementary;
use plcc_model::{
    BlockKey, Body, CellKind, CodeBlock, Direction, Number, Operand, Passing, StlStatement, StlStatementKind, layout,
};

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
    /// A statement of SCL is about to run that may have no value to tell: a call, a text, a structure, a jump. The value is 1.
    Ran,
    /// The logic stack of an S7-200 after a statement: S0 is bit 0, ENO bit 9. The operands of the statement that have addresses,
    /// with the type of numbers: `VW100 as INT`.
    Stack(Vec<String>),
    /// A statement or network is about to run.
    Statement(Kept),
    /// For coverage: a statement is about to run. The value is 1, or on an S7-200 S0 if the statement acts only with S0 = 1.
    Reached,
    /// For coverage: a bit that is read, or the result of a comparison: `A`, `LD`, a contact, an input of a gate, a BOOL in an
    /// expression; for a conditional jump or block end whether it is taken. The value is the bit, not its negation.
    Contact,
    /// For coverage: the condition of IF, WHILE or REPEAT, unless it is a single bit or comparison.
    Condition,
    /// For coverage: whether a part of a network acts that acts under a condition, such as a box with EN. Its place is the element.
    Enable,
    /// What an FC has got for its formal with this index, where it begins: for a BOOL eight times the offset from the memory base plus the
    /// bit, for another value or a structure the offset, for a timer, counter or block the number.
    Formal(usize),
}

/// What a statement has in registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    Nothing,
    /// The registers of an S7-300/400.
    Registers,
    /// The logic stack and ENO of an S7-200.
    Stack,
}

/// Which probes are asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Asked {
    #[default]
    Nothing,
    /// What statements have seen.
    Values,
    /// That statements are about to run.
    Statements,
    /// Which statements run, and which values the bits have that decide.
    Coverage,
}

/// The list of places, while code is made.
#[derive(Default)]
pub(crate) struct Probes {
    pub asked: Asked,
    /// `None`: no probes.
    pub places: Option<Vec<Place>>,
    /// Sites of other code of the same program.
    pub sites: Vec<Site>,
}

impl Probes {
    pub fn new(asked: Asked) -> Probes {
        Probes { asked, places: (asked != Asked::Nothing).then(Vec::new), sites: Vec::new() }
    }

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

/// The call of a probe before a statement whose frame is at `local`.
pub(crate) fn statement(b: &mut FunctionBuilder, place: u32, local: Value) {
    let place = b.i32_const(place);
    b.call_runtime(RuntimeFn::ProbeStatement, &[place, local]);
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

    /// Whether the values of code at `span` are looked at.
    fn is_probed(&self, span: Span) -> bool {
        self.output.probes.asked == Asked::Values && self.is_here(span)
    }

    /// Whether statements at `span` are looked at.
    fn is_stepped(&self, span: Span) -> bool {
        self.output.probes.asked == Asked::Statements && self.is_here(span)
    }

    /// Whether code at `span` is source of this block, and is reached.
    fn is_here(&self, span: Span) -> bool {
        !self.block.library && span.file == self.block.span.file && self.b.is_reachable()
    }

    /// Whether code at `span` is counted for coverage.
    fn is_counted(&self, span: Span) -> bool {
        self.output.probes.asked == Asked::Coverage && !self.block.library && span.file == self.block.span.file
    }

    /// For coverage: a statement at `span` is about to run. It has a place also if no path leads to it.
    fn count_statement(&mut self, span: Span) {
        if !self.is_counted(span) {
            return;
        }
        let Some(place) = self.probe_place(span, Probe::Reached) else { return };
        if self.b.is_reachable() {
            let one = self.b.i32_const(1);
            value(&mut self.b, place, one);
        }
    }

    /// For coverage: a bit that decides has this value, an i1.
    fn count_bit(&mut self, span: Span, probe: Probe, bit: Value) {
        if !self.is_counted(span) || !self.b.is_reachable() {
            return;
        }
        if let Some(place) = self.probe_place(span, probe) {
            value(&mut self.b, place, bit);
        }
    }

    /// For coverage: a bit that the current statement of STL reads, or whether it jumps.
    pub fn count_contact(&mut self, bit: Value) {
        if let Some(span) = self.counted {
            self.count_bit(span, Probe::Contact, bit);
        }
    }

    /// For coverage: the condition of IF, WHILE or REPEAT. `statement`: what acts under it, if it is the only condition.
    pub fn count_condition(&mut self, condition: &Expr, statement: Option<Span>, bit: Value) {
        if self.output.probes.asked != Asked::Coverage || matches!(condition.kind, ExprKind::Const(_)) {
            return;
        }
        if let Some(span) = statement {
            self.count_bit(span, Probe::Enable, bit);
        }
        if !self.is_contact(condition) {
            self.count_bit(condition.span, Probe::Condition, bit);
        }
    }

    /// Whether an expression is a bit of the program that is read, or a comparison.
    fn is_contact(&self, expr: &Expr) -> bool {
        expr.ty == Elementary::Bool
            && match &expr.kind {
                ExprKind::Load(access) => !self.is_of_binder(access),
                ExprKind::Cell { .. } | ExprKind::Compare { .. } => true,
                ExprKind::Const(_)
                | ExprKind::Unary { .. }
                | ExprKind::Binary { .. }
                | ExprKind::Convert { .. }
                | ExprKind::Call(_)
                | ExprKind::Function { .. }
                | ExprKind::Timer(_)
                | ExprKind::Counter(_)
                | ExprKind::Bound { .. }
                | ExprKind::Flag
                | ExprKind::LastEno => false,
            }
    }

    /// Whether a variable is in the frame after all that the source declares, where the binder keeps the values of wires.
    fn is_of_binder(&self, access: &Access) -> bool {
        use plcc_model::scl::Base;
        let interface = &self.block.interface;
        let end = |member: &plcc_model::types::Member| member.byte + layout::bytes(&member.ty);
        let declared = interface.temporaries.iter().map(end).max().unwrap_or(0).max(interface.start_bytes);
        matches!(&access.base, Base::Place(plcc_model::Place::L { byte, .. }) if *byte >= declared)
    }

    /// The block begins.
    pub fn probe_enter(&mut self) {
        let Some(place) = self.probe_place(self.block.span, Probe::Block) else { return };
        self.block_place = Some(place);
        let instance = self.instance.unwrap_or_else(|| self.b.i32_const(0));
        enter(&mut self.b, place, instance);
        if self.output.probes.asked == Asked::Statements && !self.block.library {
            self.probe_formals();
        }
    }

    /// What an FC has got for its formals.
    fn probe_formals(&mut self) {
        for index in 0..self.parameters.len() {
            let got = match self.passing(index) {
                Passing::Elementary(_) | Passing::Number => self.parameters[index].first(),
                Passing::Complex { .. } | Passing::OpenArray { .. } => self.parameters[index].get(1),
                Passing::Pointer | Passing::Any | Passing::Variant => None,
            };
            let Some(&got) = got else { continue };
            if let Some(place) = self.probe_place(self.block.span, Probe::Formal(index)) {
                value(&mut self.b, place, got);
            }
        }
    }

    /// A statement of SCL, or a network, is about to run.
    pub fn step_before(&mut self, statement: &Statement) {
        match self.output.probes.asked {
            Asked::Statements => {}
            Asked::Coverage => return self.count_before(statement),
            Asked::Values => return self.tell_before(statement),
            Asked::Nothing => return,
        }
        let Body::Scl(body) = &self.block.body else { return };
        if let StatementKind::Label(_) = statement.kind {
            // Code goes on here from elsewhere.
            self.scl.told_network = 0;
            return;
        }
        if body.networks.is_empty() {
            return self.step_at(statement.span);
        }
        let network = body.network_at(statement.span.start);
        if network != self.scl.told_network && self.is_stepped(statement.span) {
            self.scl.told_network = network;
            self.step_at(statement.span);
        }
    }

    /// For the status: a line whose statement has no values must not look as if it had not run.
    fn tell_before(&mut self, statement: &Statement) {
        let is_silent = match statement.kind {
            StatementKind::AssignText { .. }
            | StatementKind::Copy { .. }
            | StatementKind::Call(_)
            | StatementKind::Evaluate(_)
            | StatementKind::Exit
            | StatementKind::Continue
            | StatementKind::Return(_)
            | StatementKind::Goto(_) => true,
            StatementKind::Assign { .. }
            | StatementKind::SetFlag(_)
            | StatementKind::Failed
            | StatementKind::Watch(_)
            | StatementKind::If { .. }
            | StatementKind::Case { .. }
            | StatementKind::For { .. }
            | StatementKind::While { .. }
            | StatementKind::Repeat { .. }
            | StatementKind::Stl(_)
            | StatementKind::Label(_)
            | StatementKind::Assert(_)
            | StatementKind::Sleep(_)
            | StatementKind::Apart => false,
        };
        let is_text = matches!(&self.block.body, Body::Scl(body) if body.networks.is_empty());
        if !is_silent || !is_text || statement.span == self.block.span || !self.is_probed(statement.span) {
            return;
        }
        if let Some(place) = self.probe_place(statement.span, Probe::Ran) {
            let one = self.b.i32_const(1);
            value(&mut self.b, place, one);
        }
    }

    fn count_before(&mut self, statement: &Statement) {
        match statement.kind {
            // Statements of STL are counted one by one.
            StatementKind::Stl(_)
            | StatementKind::Failed
            | StatementKind::Watch(_)
            | StatementKind::Label(_)
            | StatementKind::Assert(_)
            | StatementKind::Sleep(_)
            | StatementKind::Apart => {}
            StatementKind::Assign { .. }
            | StatementKind::AssignText { .. }
            | StatementKind::Copy { .. }
            | StatementKind::SetFlag(_)
            | StatementKind::Call(_)
            | StatementKind::Evaluate(_)
            | StatementKind::If { .. }
            | StatementKind::Case { .. }
            | StatementKind::For { .. }
            | StatementKind::While { .. }
            | StatementKind::Repeat { .. }
            | StatementKind::Exit
            | StatementKind::Continue
            | StatementKind::Return(_)
            | StatementKind::Goto(_) => self.count_statement(statement.span),
        }
    }

    /// A condition of SCL after the first, or the next pass of a loop.
    pub fn step_between(&mut self, span: Span) {
        if matches!(&self.block.body, Body::Scl(body) if body.networks.is_empty()) {
            self.step_at(span);
        }
    }

    /// Code at `span` is about to run. What has no place in the source of its own has that of the block.
    fn step_at(&mut self, span: Span) {
        if self.is_stepped(span) && span != self.block.span {
            self.probe_step(span, Kept::Nothing);
        }
    }

    fn probe_step(&mut self, span: Span, kept: Kept) {
        let Some(place) = self.probe_place(span, Probe::Statement(kept)) else { return };
        let local = match self.local_bytes {
            0 => self.b.i32_const(0),
            _ => self.b.address_of(Address::direct(Region::L, 0)),
        };
        statement(&mut self.b, place, local);
    }

    /// Before a statement of STL: its registers go to memory, and those that can be changed come back.
    fn probe_registers_before(&mut self, span: Span) {
        let status = self.status_word(true);
        let regs = &self.regs;
        let [a1, a2, a3, a4] = regs.accu;
        let vars = [a1, a2, a3, a4, regs.ar[0], regs.ar[1], regs.db, regs.di];
        let [accu1, accu2, accu3, accu4, ar1, ar2, db, di] = vars.map(|var| self.get(var));
        let db = self.b.binary_imm(BinaryOp::And, db, 0xFFFF);
        let di = self.b.binary_imm(BinaryOp::Shl, di, 16);
        let dbs = self.b.or(db, di);
        for (number, value) in (0..).zip([accu1, accu2, accu3, accu4, ar1, ar2, status, dbs]) {
            self.b.store_state(state::PROBED + 4 * number, value);
        }
        self.probe_step(span, Kept::Registers);
        for (number, var) in (0..).zip([a1, a2, a3, a4, vars[4]]) {
            let value = self.b.load_state(state::PROBED + 4 * number);
            self.set(var, value);
        }
        let status = self.b.load_state(state::PROBED + 4 * 6);
        self.set_status_word(status, true);
    }

    /// The block ends here.
    pub fn probe_leave(&mut self) {
        if let Some(place) = self.block_place {
            leave(&mut self.b, place);
        }
    }

    /// Lowers a statement of STL with the probe after it. One that leaves, or may leave, also has a probe before it.
    pub fn probed_statement(&mut self, statement: &StlStatement, lower: impl FnOnce(&mut Self)) {
        let is_code = matches!(
            statement.kind,
            StlStatementKind::Instruction { .. } | StlStatementKind::Call(_) | StlStatementKind::JumpList { .. }
        );
        if is_code && self.is_stepped(statement.span) {
            self.network = statement.network;
            self.probe_registers_before(statement.span);
            return lower(self);
        }
        if is_code && self.output.probes.asked == Asked::Coverage {
            self.network = statement.network;
            self.count_statement(statement.span);
            self.counted = Some(statement.span);
            lower(self);
            self.counted = None;
            return;
        }
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
        if self.output.probes.asked == Asked::Coverage {
            if self.is_contact(expr) {
                self.count_bit(expr.span, Probe::Contact, value);
            }
            return;
        }
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
        if call.instance.is_some() || self.output.probes.asked != Asked::Values {
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
