//! Outputs that are assigned twice in one cycle, by two blocks or far apart in one.
//!
//! The blocks that the main program calls for certain, and each from one place only, are read as one list of statements. A second
//! assignment counts if it is certain too and nothing between the two may touch the output. A constant may be a value to begin with.

use std::collections::BTreeMap;

use plcc_abi::layout::area;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::{Access, Base, Call, ExprKind, IndexedArea, Statement, StatementKind, walk};
use plcc_model::{
    Actual, BlockKey, Body, CodeBlock, LabelId, Number, Operand, Place, PlaceArea, StlStatement, StlStatementKind,
};
use plcc_syntax::stl::StlInsn;
use rustc_hash::{FxHashMap, FxHashSet};

use super::Language;
use super::region::{Bits, Region, may_be_in};

/// Calls inside of each other that are followed.
const DEPTH_MAX: u32 = 64;
/// More outputs of a block are all outputs.
const OUTPUTS_MAX: usize = 4096;

/// Reports outputs that are assigned again. `mains`: the blocks that the CPU calls in each cycle; `told`: statements that already have a
/// message.
pub fn review(blocks: &[(&CodeBlock, Language)], mains: &[BlockKey], told: &[Span], found: &mut Vec<Diagnostic>) {
    let mut cycle = Cycle::default();
    for (block, language) in blocks {
        let steps = steps(block, *language);
        for step in &steps {
            if let Step::Call(target, _) = step {
                *cycle.calls.entry(*target).or_default() += 1;
            }
        }
        cycle.steps.insert(block.key(), (steps, *language));
    }
    let mut pending = BTreeMap::new();
    for main in mains {
        cycle.run(*main, 0, &mut pending);
    }
    let told: FxHashSet<Span> = told.iter().copied().collect();
    found.extend(cycle.messages.into_iter().filter(|message| !told.contains(&message.primary.span)));
}

/// What a block does with outputs, in order.
enum Step {
    /// It assigns a bit; `lasting`: not a constant.
    Set { bit: u64, span: Span, lasting: bool },
    /// It reads these bits, or may write them.
    Touch(Bits),
    /// A call; true if it is certain.
    Call(BlockKey, bool),
    /// It may touch any output.
    Forget,
}

/// Outputs that a block and those that it calls may touch.
#[derive(Clone, Default)]
struct Touched {
    all: bool,
    bits: FxHashSet<u64>,
}

#[derive(Default)]
struct Cycle {
    steps: FxHashMap<BlockKey, (Vec<Step>, Language)>,
    /// Places from which each block is called.
    calls: FxHashMap<BlockKey, u32>,
    touched: FxHashMap<BlockKey, Touched>,
    messages: Vec<Diagnostic>,
}

/// Assignments that nothing has touched so far.
type Pending = BTreeMap<u64, (Span, BlockKey)>;

impl Cycle {
    fn run(&mut self, key: BlockKey, depth: u32, pending: &mut Pending) {
        // A block is followed once; it is not needed afterwards.
        let Some((steps, language)) = self.steps.remove(&key) else { return };
        self.touched.insert(key, Touched { all: true, ..Touched::default() });
        for step in &steps {
            match step {
                Step::Set { bit, span, lasting } => {
                    let before = pending.remove(bit);
                    if let Some((first, by)) = before
                        && !(by == key && language == Language::Networks)
                    {
                        self.messages.push(message(*bit, first, *span, by == key));
                    }
                    if *lasting {
                        pending.insert(*bit, (*span, key));
                    }
                }
                Step::Touch(bits) => forget(pending, *bits),
                Step::Call(target, certain) => {
                    let is_single = *certain && self.calls.get(target) == Some(&1) && depth < DEPTH_MAX;
                    if is_single && self.steps.contains_key(target) {
                        self.run(*target, depth + 1, pending);
                        continue;
                    }
                    let touched = self.touched(*target, depth);
                    if touched.all {
                        pending.clear();
                    }
                    for bit in &touched.bits {
                        pending.remove(bit);
                    }
                }
                Step::Forget => pending.clear(),
            }
        }
    }

    fn touched(&mut self, key: BlockKey, depth: u32) -> Touched {
        if let Some(known) = self.touched.get(&key) {
            return known.clone();
        }
        // Until it is known; a block of the library touches what the call hands to it.
        self.touched.insert(key, Touched { all: true, ..Touched::default() });
        let mut touched = Touched { all: depth >= DEPTH_MAX, ..Touched::default() };
        if let Some((steps, language)) = self.steps.remove(&key) {
            for step in &steps {
                match step {
                    Step::Set { bit, .. } => {
                        touched.bits.insert(*bit);
                    }
                    Step::Touch(bits) if bits.end - bits.first <= OUTPUTS_MAX as u64 => {
                        touched.bits.extend(bits.first..bits.end)
                    }
                    Step::Touch(_) | Step::Forget => touched.all = true,
                    Step::Call(target, _) => {
                        let inner = self.touched(*target, depth + 1);
                        touched.all |= inner.all;
                        touched.bits.extend(inner.bits);
                    }
                }
                if touched.bits.len() > OUTPUTS_MAX {
                    touched = Touched { all: true, ..Touched::default() };
                }
                if touched.all {
                    break;
                }
            }
            self.steps.insert(key, (steps, language));
        }
        self.touched.insert(key, touched.clone());
        touched
    }
}

fn forget(pending: &mut Pending, bits: Bits) {
    let touched: Vec<u64> = pending.range(bits.first..bits.end).map(|(bit, _)| *bit).collect();
    touched.iter().for_each(|bit| {
        pending.remove(bit);
    });
}

fn message(bit: u64, first: Span, second: Span, same_block: bool) -> Diagnostic {
    let text = format!("Q {}.{} is assigned twice in a cycle; the second assignment wins", bit / 8, bit % 8);
    let other =
        if same_block { "this assignment has no effect" } else { "this assignment in another block has no effect" };
    Diagnostic::new(Code::DoubleCoil, second, text)
        .label("assigned again")
        .also(first, other)
        .help("combine both conditions in one place, or assign different outputs")
}

fn steps(block: &CodeBlock, language: Language) -> Vec<Step> {
    let mut list = List { unsure: language == Language::Chart, ..List::default() };
    match &block.body {
        Body::Stl(statements) => list.stl_block(statements),
        Body::Scl(body) => list.tree(&body.statements, true),
        Body::S7200(_) | Body::Runtime => {}
    }
    list.steps
}

/// The steps of one block.
#[derive(Default)]
struct List {
    steps: Vec<Step>,
    /// What follows may be skipped.
    unsure: bool,
    /// Jumps ahead to these labels have begun.
    open: FxHashSet<LabelId>,
    passed: FxHashSet<LabelId>,
}

impl List {
    fn certain(&self) -> bool {
        !self.unsure && self.open.is_empty()
    }

    fn jump(&mut self, label: LabelId) {
        match self.passed.contains(&label) {
            true => self.unsure = true,
            false => {
                self.open.insert(label);
            }
        }
    }

    fn label(&mut self, label: LabelId) {
        self.open.remove(&label);
        self.passed.insert(label);
    }

    fn touch(&mut self, bits: Bits) {
        if bits.region == Region::Q {
            self.steps.push(Step::Touch(bits));
        }
    }

    fn stl_block(&mut self, statements: &[StlStatement]) {
        let mut is_constant = false;
        for statement in statements {
            if let StlStatementKind::Instruction { insn, operand } = &statement.kind {
                is_constant = match insn {
                    StlInsn::SetRlo | StlInsn::ClearRlo => true,
                    StlInsn::Assign | StlInsn::Set | StlInsn::Reset | StlInsn::Nop | StlInsn::Display => is_constant,
                    _ => false,
                };
                if let (StlInsn::Assign, Operand::Memory { place: place @ Place::Q { .. }, .. }) = (insn, operand)
                    && self.certain()
                    && let Some(bits) = Bits::at(place, 1)
                {
                    self.steps.push(Step::Set { bit: bits.first, span: statement.span, lasting: !is_constant });
                    continue;
                }
            }
            self.stl(statement);
        }
    }

    fn stl(&mut self, statement: &StlStatement) {
        match &statement.kind {
            StlStatementKind::Label(label) => self.label(*label),
            StlStatementKind::JumpList { targets, default } => {
                targets.iter().chain([default]).for_each(|label| self.jump(*label));
            }
            StlStatementKind::Instruction { insn, operand } => self.instruction(*insn, operand),
            StlStatementKind::Call(call) => {
                for argument in &call.arguments {
                    match argument.actual.pointer() {
                        Actual::Place(place) => {
                            if let Some(bits) = Bits::at(place, 1) {
                                self.touch(bits.on());
                            } else if may_be_in(place, PlaceArea::Q) {
                                self.steps.push(Step::Forget);
                            }
                        }
                        Actual::PointerTo { place, .. } | Actual::PointerCopy(place) => {
                            if Bits::at(place, 1).is_none_or(|bits| bits.region == Region::Q) {
                                self.steps.push(Step::Forget);
                            }
                        }
                        Actual::PointerBytes(bytes) if bytes.contains(&area::Q) => self.steps.push(Step::Forget),
                        Actual::Const(_) | Actual::Number(_) | Actual::PointerBytes(_) | Actual::Variant(..) => {}
                    }
                }
                self.steps.push(Step::Call(call.target, self.certain()));
            }
            StlStatementKind::Assert(_) => self.steps.push(Step::Forget),
            StlStatementKind::Sleep(_) => {}
        }
    }

    fn instruction(&mut self, insn: StlInsn, operand: &Operand) {
        match operand {
            Operand::Memory { place, width } => match Bits::at(place, width.bits().into()) {
                Some(bits) => self.touch(bits),
                None if may_be_in(place, PlaceArea::Q) => self.steps.push(Step::Forget),
                None => {}
            },
            Operand::Label(label) => self.jump(*label),
            Operand::Block { kind, number: Number::Known(number) } => {
                let certain = self.certain() && insn == StlInsn::CallUnconditional;
                self.steps.push(Step::Call(BlockKey { kind: *kind, number: *number }, certain));
            }
            Operand::Block { .. } => self.steps.push(Step::Forget),
            Operand::Const { value, .. } if value >> 24 == u32::from(area::Q) => self.steps.push(Step::Forget),
            Operand::None
            | Operand::Const { .. }
            | Operand::Cell { .. }
            | Operand::Db { .. }
            | Operand::Status(_)
            | Operand::Special(_)
            | Operand::Register(_)
            | Operand::ParameterPointer { .. } => {}
        }
        self.unsure |= matches!(
            insn,
            StlInsn::BlockEndConditional | StlInsn::BlockEndUnconditional | StlInsn::McrActivate | StlInsn::McrOpen
        );
    }

    /// `always`: the list runs whenever the block does.
    fn tree(&mut self, list: &[Statement], always: bool) {
        for statement in list {
            match &statement.kind {
                StatementKind::Assign { target, value } => {
                    self.visit(|visitor| walk::expr(value, visitor), always);
                    let place = match &target.base {
                        Base::Place(place @ Place::Q { .. }) if target.indices.is_empty() && target.part.is_none() => {
                            Some(place)
                        }
                        _ => None,
                    };
                    match place.and_then(|place| Bits::at(place, 1)) {
                        Some(bits) if always && self.certain() && Bits::of(target) == Some(bits) => {
                            let lasting = !matches!(value.kind, ExprKind::Const(_));
                            self.steps.push(Step::Set { bit: bits.first, span: statement.span, lasting });
                        }
                        _ => self.visit(|visitor| walk::access(target, walk::Role::Value, visitor), always),
                    }
                }
                StatementKind::Stl(stl) => {
                    let unsure = std::mem::replace(&mut self.unsure, true);
                    self.stl(stl);
                    self.unsure = unsure;
                    // Whatever it decides, the rest of the block may depend on it.
                    self.unsure |= !matches!(&stl.kind, StlStatementKind::Instruction { operand, .. } if !matches!(operand, Operand::Label(_)));
                }
                StatementKind::Label(label) => self.label(*label),
                StatementKind::Goto(label) => self.jump(*label),
                StatementKind::Return(_) => self.unsure = true,
                StatementKind::Assert(_) => self.steps.push(Step::Forget),
                kind => {
                    self.visit(|visitor| walk::own_part(kind, visitor), always);
                    kind.bodies().into_iter().for_each(|body| self.tree(body, false));
                }
            }
        }
    }

    fn visit(&mut self, walk: impl FnOnce(&mut dyn walk::Visitor), always: bool) {
        let certain = always && self.certain();
        walk(&mut Uses { list: self, certain });
    }
}

/// The outputs and calls in a part of a statement.
struct Uses<'l> {
    list: &'l mut List,
    certain: bool,
}

impl walk::Visitor for Uses<'_> {
    fn access(&mut self, access: &Access, role: walk::Role) {
        match (&access.base, Bits::of(access)) {
            (_, Some(bits)) if role == walk::Role::Memory => self.list.touch(bits.on()),
            (_, Some(bits)) => self.list.touch(bits),
            (Base::Indexed { area: IndexedArea::Memory(PlaceArea::Q) | IndexedArea::Coded { .. }, .. }, None)
            | (Base::Place(_), None) => self.list.steps.push(Step::Forget),
            (Base::Indexed { .. }, None) => {}
        }
    }

    fn call(&mut self, call: &Call) {
        let certain = self.certain && call.enable.is_none();
        for argument in &call.arguments {
            if let plcc_model::scl::Actual::PointerBytes(bytes) = argument.actual.pointer()
                && bytes.contains(&area::Q)
            {
                self.list.steps.push(Step::Forget);
            }
        }
        self.list.steps.push(Step::Call(call.target, certain));
    }
}
