//! What the code of one block does that matters to others.

use plcc_abi::codes;
use plcc_abi::image::BlockKind;
use plcc_abi::layout;
use plcc_model::Program;
use plcc_model::scl;
use plcc_model::scl::walk::{self, Visitor};
use plcc_model::{
    Actual, AddressRegister, BlockKey, Body, CodeBlock, Number, Operand, Passing, Place, StlStatement, StlStatementKind,
};
use plcc_syntax::stl::StlInsn;
use rustc_hash::FxHashMap;

use super::frame::{ALIGNMENT, local_bytes, scl_temporary_bytes, temporary_bytes};
use super::takes_references;

/// SFC that stops the CPU.
const SFC_STP: u16 = 46;

/// The properties of a block that matter to others.
pub(super) struct BlockFacts {
    /// Blocks that it calls, without repeats.
    pub calls: Vec<BlockKey>,
    /// Those of them that may change AR2 for their caller: all calls except those of FBs with an instance.
    pub passes_ar2_to: Vec<BlockKey>,
    pub changes_ar2: bool,
    pub dynamic_calls: bool,
    pub stops: bool,
    pub hands_on_pointers: bool,
    /// Parameters whose pointer it loads (`P##x`).
    pub pointers: Vec<usize>,
    /// Upper bound of its frame.
    pub frame_estimate: u32,
}

impl BlockFacts {
    pub fn handles_errors(&self) -> bool {
        let numbers = [codes::local_error::GET_ERROR, codes::local_error::GET_ERR_ID];
        self.calls.iter().any(|key| key.kind == BlockKind::Sfc && numbers.contains(&key.number))
    }

    /// See [`Plan::pointed`].
    pub fn pointed_of(&self, block: &CodeBlock) -> Vec<usize> {
        let is_elementary =
            |&index: &usize| matches!(block.interface.parameters[index].passing, Passing::Elementary(_));
        let mut pointed: Vec<usize> = match takes_references(block) {
            true => self.pointers.iter().copied().filter(is_elementary).collect(),
            false => Vec::new(),
        };
        pointed.sort_unstable();
        pointed.dedup();
        pointed
    }

    pub fn new(block: &CodeBlock, program: &Program, index: &FxHashMap<BlockKey, usize>) -> BlockFacts {
        let mut facts = BlockFacts {
            calls: Vec::new(),
            passes_ar2_to: Vec::new(),
            changes_ar2: false,
            dynamic_calls: false,
            stops: false,
            hands_on_pointers: false,
            pointers: Vec::new(),
            frame_estimate: block.temp_bytes,
        };
        if let Body::Stl(statements) = &block.body {
            facts.frame_estimate = local_bytes(block);
            let mut temporaries = 0;
            for statement in statements {
                facts.scan(statement);
                if let StlStatementKind::Call(call) = &statement.kind
                    && let Some(&callee) = index.get(&call.target)
                {
                    temporaries = temporaries.max(temporary_bytes(&program.blocks[callee], call));
                }
            }
            facts.frame_estimate = layout::frame_bytes(facts.frame_estimate + temporaries);
        }
        if let Body::Scl(body) = &block.body {
            facts.scan_scl(block, body, program, index);
        }
        facts.calls.sort_unstable();
        facts.calls.dedup();
        facts
    }

    fn scan_scl(
        &mut self,
        block: &CodeBlock,
        body: &scl::SclBody,
        program: &Program,
        index: &FxHashMap<BlockKey, usize>,
    ) {
        let mut scan = SclScan { facts: self, program, index, statement: 0, most: 0 };
        walk::statements(&body.statements, &mut scan);
        let temporaries = scan.most;
        // Inputs that are not in SSA values are copied to the frame.
        let inputs: u32 = match takes_references(block) {
            true => block.interface.parameters.iter().map(|_| 8 + 1).sum(),
            false => 0,
        };
        self.frame_estimate = layout::frame_bytes(local_bytes(block) + inputs + temporaries);
    }

    fn scan(&mut self, statement: &StlStatement) {
        match &statement.kind {
            StlStatementKind::Instruction { insn, operand } => {
                self.changes_ar2 |= changes_ar2(*insn, operand);
                if let Operand::ParameterPointer { parameter } = operand {
                    self.pointers.push(*parameter);
                }
                if let Operand::Block { kind, number } = operand {
                    match number {
                        Number::Known(number) => {
                            let key = BlockKey { kind: *kind, number: *number };
                            self.stops |= key == BlockKey { kind: BlockKind::Sfc, number: SFC_STP };
                            self.calls.push(key);
                            self.passes_ar2_to.push(key);
                        }
                        Number::Word(_) | Number::Parameter(_) => self.dynamic_calls = true,
                    }
                }
            }
            StlStatementKind::Call(call) => {
                self.stops |= call.target == BlockKey { kind: BlockKind::Sfc, number: SFC_STP };
                self.calls.push(call.target);
                self.hands_on_pointers |= call.arguments.iter().any(|argument| hands_on_pointer(&argument.actual));
                if call.instance.is_none() {
                    self.passes_ar2_to.push(call.target);
                }
            }
            StlStatementKind::Label(_)
            | StlStatementKind::JumpList { .. }
            | StlStatementKind::Assert(_)
            | StlStatementKind::Sleep(_) => {}
        }
    }
}

/// Facts of a block in SCL.
struct SclScan<'f, 'a> {
    facts: &'f mut BlockFacts,
    program: &'a Program,
    index: &'a FxHashMap<BlockKey, usize>,
    /// Upper bound of the temporaries of the current statement, and the maximum over all statements.
    statement: u32,
    most: u32,
}

impl Visitor for SclScan<'_, '_> {
    fn statement(&mut self, statement: &scl::Statement) {
        let scl::StatementKind::Stl(statement) = &statement.kind else { return };
        self.facts.scan(statement);
        if let StlStatementKind::Call(call) = &statement.kind
            && let Some(&callee) = self.index.get(&call.target)
        {
            self.statement += temporary_bytes(&self.program.blocks[callee], call);
        }
    }

    fn call(&mut self, call: &scl::Call) {
        self.facts.stops |= call.target == BlockKey { kind: BlockKind::Sfc, number: SFC_STP };
        self.facts.calls.push(call.target);
        if call.instance.is_none() {
            self.facts.passes_ar2_to.push(call.target);
        }
        for argument in &call.arguments {
            let access = match argument.actual.pointer() {
                scl::Actual::PointerCopy(_) => {
                    self.facts.hands_on_pointers = true;
                    continue;
                }
                scl::Actual::Reference(access)
                | scl::Actual::PointerTo { access, .. }
                | scl::Actual::Complex(scl::Complex::Variable(access))
                | scl::Actual::PointerToComplex { value: scl::Complex::Variable(access), .. } => access,
                _ => continue,
            };
            self.facts.hands_on_pointers |=
                matches!(access.base, scl::Base::Place(Place::Parameter { .. } | Place::ThroughPointer { .. }));
        }
        if let Some(&callee) = self.index.get(&call.target) {
            self.statement += scl_temporary_bytes(&self.program.blocks[callee], call);
        }
    }

    fn complex(&mut self, complex: &scl::Complex) {
        self.statement += match complex {
            scl::Complex::Const(bytes) => bytes.len() as u32 + ALIGNMENT,
            scl::Complex::Character(_) => 8 + ALIGNMENT,
            scl::Complex::Variable(_) | scl::Complex::Call(_) => 0,
        };
    }

    fn own_part_done(&mut self) {
        self.most = self.most.max(self.statement);
        self.statement = 0;
    }
}

/// True if the actual parameter may be a pointer that the calling block itself received.
fn hands_on_pointer(actual: &Actual) -> bool {
    match actual.pointer() {
        Actual::PointerCopy(_) => true,
        Actual::Place(place) | Actual::PointerTo { place, .. } => {
            matches!(place.root(), Place::Parameter { .. } | Place::ThroughPointer { .. })
        }
        Actual::Const(_) | Actual::Number(_) | Actual::PointerBytes(_) | Actual::Variant(..) => false,
    }
}

/// True if the instruction writes AR2.
pub fn changes_ar2(insn: StlInsn, operand: &Operand) -> bool {
    match insn {
        StlInsn::LoadAr2 | StlInsn::AddAr2 | StlInsn::SwapAr => true,
        StlInsn::TransferAr1 => *operand == Operand::Register(AddressRegister::Ar2),
        _ => false,
    }
}
