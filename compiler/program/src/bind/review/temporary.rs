//! Temporary data that is read before it is written.
//!
//! A read counts only if nothing earlier in the text of the block writes any bit of it, and no loop or jump back leads to it from a
//! place after such a write. Whatever may write through a pointer counts as a write.

use std::collections::BTreeMap;

use plcc_abi::image::BlockKind;
use plcc_abi::layout::area;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::{Access, Complex, Expr, ExprKind, Statement, StatementKind, UnaryOp, walk};
use plcc_model::types::DataType;
use plcc_model::{
    Actual, Body, Call, CodeBlock, Direction, ElementIndex, LabelId, Number, Operand, Passing, Place, PlaceArea,
    StlStatement, StlStatementKind,
};
use plcc_syntax::stl::{OperandClass, StlInsn};
use rustc_hash::{FxHashMap, FxHashSet};

use super::region::{Bits, Region, may_be_in};
use crate::bind::declarations::Declarations;
use crate::bind::declarations::path::Base;
use crate::bind::declarations::typed::Local;

/// Reports the reads of a block that come before every write.
pub fn review(program: &mut Declarations, block: &CodeBlock, found: &mut Vec<Diagnostic>) {
    let Some(bound) = program.interface(block.key(), block.span) else { return };
    let mut flow = Flow::default();
    match &block.body {
        Body::Stl(statements) => flow.stl(statements, program),
        Body::Scl(body) => flow.tree(&body.statements, program),
        Body::S7200(_) | Body::Runtime => return,
    }
    let is_tree = matches!(block.body, Body::Scl(_));
    let supplied = u64::from(bound.interface.start_bytes) * 8;
    // Beyond what a graphic block declares are values of its networks.
    let declared = if is_tree { u64::from(bound.temp_bytes) * 8 } else { u64::MAX };
    flow.reads.retain(|read| read.first >= supplied && read.first < declared);
    let limits = flow.limits();
    let early = flow.unwritten(&limits);
    // In the typed tree what nothing writes is reported where it is bound.
    let never = flow.unwritten(&vec![u32::MAX; flow.reads.len()]);
    let mut told = FxHashSet::default();
    for ((read, early), never) in flow.reads.iter().zip(early).zip(never) {
        if !early || (is_tree && never) {
            continue;
        }
        let local = bound.locals.values().find(|local| holds(local, read.first));
        let name = local.map_or_else(|| address(read), |local| local.name.clone());
        if told.insert(name.clone()) {
            found.push(message(read, &name, block.kind));
        }
    }
}

fn holds(local: &Local, bit: u64) -> bool {
    let first = u64::from(local.byte) * 8 + u64::from(local.bit);
    let bits = match &local.ty {
        DataType::Elementary(ty) => u64::from(ty.bits()),
        ty => u64::from(plcc_model::layout::bytes(ty)) * 8,
    };
    local.base == Base::L && (first..first + bits).contains(&bit)
}

/// A read without a declared variable.
fn address(read: &Read) -> String {
    let (byte, bit) = (read.first / 8, read.first % 8);
    match read.end - read.first {
        1 => format!("L {byte}.{bit}"),
        8 => format!("LB {byte}"),
        16 => format!("LW {byte}"),
        _ => format!("LD {byte}"),
    }
}

fn message(read: &Read, name: &str, kind: BlockKind) -> Diagnostic {
    let kept = match kind {
        BlockKind::Fb | BlockKind::Sfb => "declare it as static data",
        _ => "keep it in a data block",
    };
    match read.is_text {
        true => Diagnostic::new(Code::NeverWritten, read.span, format!("the text `{name}` has no maximum length yet"))
            .label("the call writes no more characters than its first byte says, which is undefined on the CPU")
            .help(format!("write the maximum length to its first byte before, or {kept}")),
        false => Diagnostic::new(Code::NeverWritten, read.span, format!("`{name}` is read before it is written"))
            .label("temporary data is undefined on the CPU until it is written")
            .help(format!("assign a value to it first, or {kept}")),
    }
}

struct Read {
    order: u32,
    first: u64,
    end: u64,
    span: Span,
    /// The maximum length of a text that a call writes.
    is_text: bool,
}

/// What a block does with its temporary data, in the order of its text.
#[derive(Default)]
struct Flow {
    order: u32,
    reads: Vec<Read>,
    /// Order, first bit, bit after the last one.
    writes: Vec<(u32, u64, u64)>,
    labels: FxHashMap<LabelId, u32>,
    jumps: Vec<(LabelId, u32)>,
    /// What runs again: from, to.
    loops: Vec<(u32, u32)>,
    /// The next access is read.
    is_load: bool,
    /// Scanned together with their negations in this statement.
    constant: Vec<Bits>,
    /// This statement touches no more than the variables that it names.
    is_exact: bool,
}

impl Flow {
    fn read(&mut self, bits: Bits, span: Span) {
        if bits.region == Region::L {
            self.order += 1;
            self.reads.push(Read { order: self.order, first: bits.first, end: bits.end, span, is_text: false });
        }
    }

    fn write(&mut self, bits: Bits) {
        if bits.region == Region::L {
            self.order += 1;
            self.writes.push((self.order, bits.first, bits.end));
        }
    }

    fn write_anything(&mut self) {
        self.write(Bits { region: Region::L, first: 0, end: u64::MAX });
    }

    /// For each read the position up to which writes may come before it.
    fn limits(&self) -> Vec<u32> {
        let back = self.jumps.iter().filter_map(|(label, at)| Some((*self.labels.get(label)?, *at)));
        let mut loops: Vec<(u32, u32)> =
            self.loops.iter().copied().chain(back).filter(|(from, to)| from <= to).collect();
        loops.sort_unstable();
        let mut joined: Vec<(u32, u32)> = Vec::new();
        for (from, to) in loops {
            match joined.last_mut() {
                Some(last) if from <= last.1 => last.1 = last.1.max(to),
                _ => joined.push((from, to)),
            }
        }
        let limit = |read: &Read| {
            let around = joined.partition_point(|(from, _)| *from <= read.order);
            let end = joined[..around].last().map_or(0, |(_, to)| *to);
            read.order.max(end)
        };
        self.reads.iter().map(limit).collect()
    }

    /// For each read whether no write up to its limit touches any of its bits.
    fn unwritten(&self, limits: &[u32]) -> Vec<bool> {
        let mut result = vec![false; self.reads.len()];
        let mut queries: Vec<usize> = (0..self.reads.len()).collect();
        queries.sort_by_key(|&index| limits[index]);
        let mut written: BTreeMap<u64, u64> = BTreeMap::new();
        let mut next = 0;
        for index in queries {
            while let Some(&(order, first, end)) = self.writes.get(next)
                && order <= limits[index]
            {
                next += 1;
                join(&mut written, first, end);
            }
            let read = &self.reads[index];
            result[index] = written.range(..read.end).next_back().is_none_or(|(_, end)| *end <= read.first);
        }
        result
    }

    fn stl(&mut self, statements: &[StlStatement], program: &mut Declarations) {
        for (index, statement) in statements.iter().enumerate() {
            let before = index.checked_sub(1).and_then(|index| statements.get(index));
            let is_constant =
                [before, statements.get(index + 1)].into_iter().flatten().any(|other| opposite(statement, other));
            self.stl_statement(statement, is_constant, program);
        }
    }

    /// `is_constant`: scanned together with its negation, so that its value does not matter.
    fn stl_statement(&mut self, statement: &StlStatement, is_constant: bool, program: &mut Declarations) {
        match &statement.kind {
            StlStatementKind::Label(label) => {
                self.order += 1;
                self.labels.insert(*label, self.order);
            }
            StlStatementKind::JumpList { targets, default } => {
                self.order += 1;
                self.jumps.extend(targets.iter().chain([default]).map(|label| (*label, self.order)));
            }
            StlStatementKind::Instruction { insn, operand } => {
                self.instruction(*insn, operand, is_constant, statement.span);
            }
            StlStatementKind::Call(call) => self.call(call, program, statement.span),
            StlStatementKind::Assert(_) | StlStatementKind::Sleep(_) => {}
        }
    }

    fn instruction(&mut self, insn: StlInsn, operand: &Operand, is_constant: bool, span: Span) {
        let is_read = matches!(
            insn.operand(),
            OperandClass::Bit
                | OperandClass::BitOrNone
                | OperandClass::LoadSource
                | OperandClass::LoadAr1
                | OperandClass::LoadAr2
        );
        match operand {
            Operand::Memory { place, width } => {
                if let Place::Indirect { pointer, .. } = place
                    && let Some(bits) = Bits::at(pointer, 32)
                {
                    self.read(bits, span);
                }
                self.indices(place.indices(), span);
                match Bits::at(place, width.bits().into()) {
                    Some(_) if is_read && is_constant => {}
                    Some(bits) if is_read => self.read(bits, span),
                    Some(bits) => self.write(bits),
                    None if !is_read && may_be_in(place, PlaceArea::L) => self.write_anything(),
                    None => {}
                }
            }
            Operand::Cell { number, .. } | Operand::Block { number, .. } | Operand::Db { number, .. } => {
                if let Number::Word(place) = number
                    && let Some(bits) = Bits::at(place, 16)
                {
                    self.read(bits, span);
                }
            }
            // Its address is known elsewhere from here on.
            Operand::Const { value, .. } if value >> 24 == u32::from(area::L) => self.write_anything(),
            Operand::Label(label) => {
                self.order += 1;
                self.jumps.push((*label, self.order));
            }
            Operand::Const { .. }
            | Operand::None
            | Operand::Status(_)
            | Operand::Special(_)
            | Operand::Register(_)
            | Operand::ParameterPointer { .. } => {}
        }
    }

    fn indices(&mut self, indices: &[ElementIndex], span: Span) {
        for index in indices {
            if let Some(bits) = Bits::at(&index.place, index.ty.bits().into()) {
                self.read(bits, span);
            }
        }
    }

    fn call(&mut self, call: &Call, program: &mut Declarations, span: Span) {
        let Some(bound) = program.interface(call.target, span) else { return self.write_anything() };
        let is_classic = !program.globals.input.profile.family.is_portal();
        let mut writes = Vec::new();
        for argument in &call.arguments {
            let parameter = bound.interface.parameters.get(argument.parameter);
            let at = argument.span;
            self.indices(argument.actual.indices(), at);
            match argument.actual.pointer() {
                Actual::Place(place) => {
                    let Some(bits) = Bits::at(place, 1) else { continue };
                    let sized = |bits: Bits, size: u64| Bits { end: bits.end - 1 + size, ..bits };
                    match parameter.map(|parameter| (parameter.direction, parameter.passing, &parameter.ty)) {
                        Some((Direction::Input, Passing::Elementary(width), _)) => {
                            self.read(sized(bits, width.bits().into()), at)
                        }
                        Some((Direction::Output, Passing::Complex { .. }, DataType::String(_))) if is_classic => {
                            self.read(sized(bits, 8), at);
                            if let Some(read) = self.reads.last_mut().filter(|_| bits.region == Region::L) {
                                read.is_text = true;
                            }
                            writes.push(bits.on());
                        }
                        Some((Direction::Output, Passing::Elementary(width), _)) => {
                            writes.push(sized(bits, width.bits().into()))
                        }
                        _ => writes.push(bits.on()),
                    }
                }
                Actual::Number(Number::Word(place)) => {
                    if let Some(bits) = Bits::at(place, 16) {
                        self.read(bits, at);
                    }
                }
                Actual::PointerTo { place, .. } | Actual::PointerCopy(place) => {
                    writes.extend(Bits::at(place, 1).map(Bits::on));
                }
                Actual::PointerBytes(bytes) if bytes.contains(&area::L) => self.write_anything(),
                Actual::Const(_) | Actual::Number(_) | Actual::PointerBytes(_) | Actual::Variant(..) => {}
            }
        }
        writes.into_iter().for_each(|bits| self.write(bits));
    }

    fn tree(&mut self, list: &[Statement], program: &mut Declarations) {
        for statement in list {
            self.constant.clear();
            self.is_exact = matches!(
                statement.kind,
                StatementKind::AssignText { value: Complex::Variable(_) | Complex::Const(_), .. }
                    | StatementKind::Copy { source: Complex::Variable(_) | Complex::Const(_), .. }
            );
            match &statement.kind {
                StatementKind::Assign { target, value } => {
                    walk::expr(value, self);
                    walk::access(target, walk::Role::Value, self);
                }
                StatementKind::Stl(stl) => self.stl_statement(stl, false, program),
                StatementKind::Label(label) => {
                    self.order += 1;
                    self.labels.insert(*label, self.order);
                }
                StatementKind::Goto(label) => {
                    self.order += 1;
                    self.jumps.push((*label, self.order));
                }
                kind => {
                    let begin = self.order + 1;
                    walk::own_part(kind, self);
                    kind.bodies().into_iter().for_each(|body| self.tree(body, program));
                    if matches!(
                        kind,
                        StatementKind::For { .. } | StatementKind::While { .. } | StatementKind::Repeat { .. }
                    ) {
                        self.loops.push((begin, self.order));
                    }
                }
            }
        }
    }
}

impl walk::Visitor for Flow {
    fn expr(&mut self, value: &Expr) {
        self.is_load = matches!(value.kind, ExprKind::Load(_));
        if let ExprKind::Binary { left, right, .. } = &value.kind {
            self.constant.extend(with_negation(left, right).or_else(|| with_negation(right, left)));
        }
    }

    fn access(&mut self, access: &Access, role: walk::Role) {
        let is_load = std::mem::take(&mut self.is_load);
        match (Bits::of(access), role) {
            (Some(bits), walk::Role::Value) if is_load => {
                if !self.constant.contains(&bits) {
                    self.read(bits, access.span);
                }
            }
            (Some(bits), walk::Role::Value) => self.write(bits),
            (Some(bits), walk::Role::Memory) if self.is_exact => self.write(bits),
            (Some(bits), walk::Role::Memory) => self.write(bits.on()),
            (None, _) if !is_load => self.write_anything(),
            (None, _) => {}
        }
    }
}

/// `x` in `x OR NOT x`.
fn with_negation(plain: &Expr, negated: &Expr) -> Option<Bits> {
    let load = |value: &Expr| match &value.kind {
        ExprKind::Load(access) => Bits::of(access),
        _ => None,
    };
    let ExprKind::Unary { op: UnaryOp::Not, operand } = &negated.kind else { return None };
    load(plain).filter(|bits| load(operand) == Some(*bits))
}

/// Adds an interval to others that neither overlap nor touch.
fn join(written: &mut BTreeMap<u64, u64>, mut first: u64, mut end: u64) {
    if let Some((&before, &before_end)) = written.range(..=first).next_back()
        && before_end >= first
    {
        (first, end) = (before, end.max(before_end));
    }
    while let Some((&inner, &inner_end)) = written.range(first..=end).next() {
        written.remove(&inner);
        end = end.max(inner_end);
    }
    written.insert(first, end);
}

/// One scans a bit and the other one its negation: the usual way to make a constant.
fn opposite(one: &StlStatement, other: &StlStatement) -> bool {
    let scan = |statement: &StlStatement| match &statement.kind {
        StlStatementKind::Instruction { insn, operand } => {
            let is_negated = match insn {
                StlInsn::And | StlInsn::Or | StlInsn::Xor => false,
                StlInsn::AndNot | StlInsn::OrNot | StlInsn::XorNot => true,
                _ => return None,
            };
            Some((is_negated, operand.clone()))
        }
        _ => None,
    };
    match (scan(one), scan(other)) {
        (Some((first, operand)), Some((second, same))) => first != second && operand == same,
        _ => false,
    }
}
