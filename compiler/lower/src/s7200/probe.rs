//! Probes of a block of an S7-200.

use plcc_abi::layout::state;
use plcc_ir::{Address, BinaryOp, Region, Type, Value, Var};
use plcc_model::s7200::{Area, Insn, Operand, Statement, StatementKind, Width};
use plcc_syntax::s7200::{Acts, OperandClass};

use super::block::S7200Lowering;
use crate::probe::{self, Asked, Kept, Place, Probe};

/// Bit of ENO beside the levels of the logic stack.
const ENO_BIT: i64 = 9;

impl S7200Lowering<'_, '_> {
    /// The block begins.
    pub fn probe_enter(&mut self) {
        let block = self.block;
        let place = || Place { block: block.key(), span: block.span, network: 0, probe: Probe::Block };
        self.block_place = self.output.probes.add(place);
        if let Some(place) = self.block_place {
            let none = self.b.i32_const(0);
            probe::enter(&mut self.b, place, none);
        }
    }

    /// The block ends here.
    pub fn probe_leave(&mut self) {
        if let Some(place) = self.block_place {
            probe::leave(&mut self.b, place);
        }
    }

    /// The logic stack after a statement.
    pub fn probe_statement(&mut self, statement: &Statement) {
        let (operands, insn) = match &statement.kind {
            StatementKind::Instruction { insn, operands } => (operands.as_slice(), Some(*insn)),
            StatementKind::Call { arguments, .. } => (arguments.as_slice(), None),
            StatementKind::Assert(_) | StatementKind::Sleep(_) => return,
        };
        if !self.b.is_reachable() || self.output.probes.asked != Asked::Values {
            return;
        }
        let named = |(at, operand): (usize, &Operand)| names(insn, at, operand);
        let (block, names) = (self.block.key(), operands.iter().enumerate().flat_map(named));
        let (span, network) = (statement.span, statement.network);
        let place = || Place { block, span, network, probe: Probe::Stack(names.collect()) };
        let Some(place) = self.output.probes.add(place) else { return };
        let bits = self.stack_bits();
        probe::value(&mut self.b, place, bits);
    }

    /// For a debugger: a statement is about to run. The logic stack is in memory and can be changed.
    pub fn step_before(&mut self, statement: &Statement) {
        let is_code = matches!(statement.kind, StatementKind::Instruction { .. } | StatementKind::Call { .. });
        if !is_code || !self.b.is_reachable() || self.output.probes.asked != Asked::Statements {
            return;
        }
        let (block, span, network) = (self.block.key(), statement.span, statement.network);
        let place = || Place { block, span, network, probe: Probe::Statement(Kept::Stack) };
        let Some(place) = self.output.probes.add(place) else { return };
        let bits = self.stack_bits();
        self.b.store_state(state::PROBED, bits);
        let local = self.b.address_of(Address::direct(Region::L, 0));
        probe::statement(&mut self.b, place, local);
        let bits = self.b.load_state(state::PROBED);
        for (var, bit) in self.levels() {
            let value = self.b.binary_imm(BinaryOp::Lshr, bits, bit);
            let value = self.b.trunc(Type::I1, value);
            self.b.def_var(var, value);
        }
    }

    /// For coverage: a statement is about to run. One that acts only with S0 = 1 has run when it acts. A statement that no path leads to has
    /// a place too.
    pub fn count_before(&mut self, statement: &Statement) {
        if self.output.probes.asked != Asked::Coverage {
            return;
        }
        let needs_power = match &statement.kind {
            StatementKind::Instruction { insn: Insn::Jmp | Insn::End | Insn::Cret | Insn::Creti, .. } => false,
            StatementKind::Instruction { insn, .. } => insn.acts() == Acts::Enabled,
            StatementKind::Call { .. } => true,
            StatementKind::Assert(_) | StatementKind::Sleep(_) => return,
        };
        let (block, span, network) = (self.block.key(), statement.span, statement.network);
        let place = || Place { block, span, network, probe: Probe::Reached };
        let Some(place) = self.output.probes.add(place) else { return };
        if self.b.is_reachable() {
            let acts = if needs_power { self.top() } else { self.b.bool_const(true) };
            probe::value(&mut self.b, place, acts);
        }
    }

    /// For coverage: a bit that the current statement reads, or whether it jumps.
    pub fn count_contact(&mut self, bit: Value) {
        if self.output.probes.asked != Asked::Coverage {
            return;
        }
        let Some(statement) = self.body.statements.get(self.index) else { return };
        let (block, span, network) = (self.block.key(), statement.span, statement.network);
        let place = || Place { block, span, network, probe: Probe::Contact };
        if let Some(place) = self.output.probes.add(place) {
            probe::value(&mut self.b, place, bit);
        }
    }

    /// The logic stack and ENO, with their bits in what a probe tells.
    fn levels(&self) -> Vec<(Var, i64)> {
        self.stack.into_iter().zip(0..).chain([(self.eno, ENO_BIT)]).collect()
    }

    fn stack_bits(&mut self) -> Value {
        let mut bits = self.b.i32_const(0);
        for (var, bit) in self.levels() {
            let value = self.get(var);
            let value = self.b.zext(Type::I32, value);
            let value = self.b.binary_imm(BinaryOp::Shl, value, bit);
            bits = self.b.or(bits, value);
        }
        bits
    }
}

/// As which type of number an instruction uses operand `at`; `None`: as bits.
fn number_type(insn: Insn, at: usize) -> Option<&'static str> {
    use OperandClass as C;
    let classes = insn.operands();
    let calculates = classes.iter().any(|class| matches!(class, C::IntIn | C::DintIn | C::RealIn))
        || matches!(insn, Insn::IncW | Insn::DecW | Insn::IncD | Insn::DecD);
    match classes.get(at)? {
        C::RealIn | C::RealOut => Some("REAL"),
        C::IntIn => Some("INT"),
        C::DintIn => Some("DINT"),
        C::WordOut if calculates => Some("INT"),
        // The remainder and the quotient of DIV are two numbers.
        C::DwordOut if calculates && insn != Insn::Div => Some("DINT"),
        _ => None,
    }
}

/// The names of the values that are shown for operand `at` of an instruction; `None`: of a call.
fn names(insn: Option<Insn>, at: usize, operand: &Operand) -> Vec<String> {
    let Some(name) = name(operand) else { return Vec::new() };
    let class = insn.and_then(|insn| insn.operands().get(at));
    match operand {
        // The box of a timer or a counter has its bit and its value.
        Operand::Timer { .. } | Operand::Counter { .. }
            if matches!(class, Some(OperandClass::Timer | OperandClass::Counter)) =>
        {
            vec![name.clone(), format!("{name}.VALUE")]
        }
        Operand::Timer { width: Width::Word, .. } | Operand::Counter { width: Width::Word, .. } => {
            vec![format!("{name}.VALUE")]
        }
        Operand::Memory { width: Width::Word | Width::Dword, .. } => {
            match insn.and_then(|insn| number_type(insn, at)) {
                Some(ty) => vec![format!("{name} as {ty}")],
                None => vec![name],
            }
        }
        _ => vec![name],
    }
}

/// The address of an operand whose value can be read at any time.
fn name(operand: &Operand) -> Option<String> {
    let area = |area: Area| match area {
        Area::I => Some("I"),
        Area::Q => Some("Q"),
        Area::V => Some("V"),
        Area::M => Some("M"),
        Area::Sm => Some("SM"),
        Area::S => Some("S"),
        Area::L => None,
    };
    Some(match operand {
        Operand::Memory { area: of, byte, bit, width } => {
            let area = area(*of)?;
            match width {
                Width::Bit => format!("{area}{byte}.{bit}"),
                Width::Byte => format!("{area}B{byte}"),
                Width::Word => format!("{area}W{byte}"),
                Width::Dword | Width::Lword => format!("{area}D{byte}"),
            }
        }
        Operand::Timer { number, .. } => format!("T{number}"),
        Operand::Counter { number, .. } => format!("C{number}"),
        Operand::AnalogInput { byte } => format!("AIW{byte}"),
        Operand::AnalogOutput { byte } => format!("AQW{byte}"),
        Operand::Const(_)
        | Operand::Text(_)
        | Operand::HighSpeedCounter(_)
        | Operand::Accumulator { .. }
        | Operand::Indirect { .. } => return None,
    })
}
