//! State of one block while it is lowered: the virtual CPU's registers as SSA variables.

use plcc_abi::Type;
use plcc_abi::image::BlockKind;
use plcc_abi::layout::{self, CpuRegister};
use plcc_ir::{Address, Block, FunctionBuilder, Loc, Region, Value, Var};
use plcc_model::{Body, CodeBlock, LabelId, Passing, Place, StlStatement, Width, scl};
use plcc_syntax::stl::StlInsn;
use rustc_hash::FxHashMap;

use crate::Output;
use crate::call::FormalText;
use crate::labels::Labels;
use crate::place::reference::References;
use crate::plan::{self, Plan};
use crate::scl::SclState;
use crate::stop::{SafepointBlocks, StopExit};

/// Entries of the nesting stack. Source: STL reference, nesting expressions.
pub const NESTING_MAX: usize = 7;

/// An open parenthesis: its instruction, and the bits that were pushed.
#[derive(Clone, Copy)]
pub struct Nesting {
    pub insn: StlInsn,
    pub rlo: Var,
    pub or_: Var,
    pub fc: Var,
    pub br: Var,
}

/// The registers of the virtual CPU.
pub struct Registers {
    pub accu: [Var; 4],
    pub ar: [Var; 2],
    /// Numbers in the DB and DI registers.
    pub db: Var,
    pub di: Var,
    pub br: Var,
    pub cc1: Var,
    pub cc0: Var,
    pub ov: Var,
    pub os: Var,
    pub or_: Var,
    pub sta: Var,
    pub rlo: Var,
    pub fc: Var,
    /// `MCRA` is active.
    pub mcr_active: Var,
    /// Stacked bits of the MCR, the newest lowest; all higher bits are 1.
    pub mcr_bits: Var,
    /// Entries on the MCR stack.
    pub mcr_depth: Var,
}

impl Registers {
    fn new(b: &mut FunctionBuilder) -> Registers {
        let mut word = || b.declare_var(Type::I32);
        let (accu, ar) = ([word(), word(), word(), word()], [word(), word()]);
        let (db, di, mcr_bits, mcr_depth) = (word(), word(), word(), word());
        let mut bit = || b.declare_var(Type::I1);
        Registers {
            accu,
            ar,
            db,
            di,
            br: bit(),
            cc1: bit(),
            cc0: bit(),
            ov: bit(),
            os: bit(),
            or_: bit(),
            sta: bit(),
            rlo: bit(),
            fc: bit(),
            mcr_active: bit(),
            mcr_bits,
            mcr_depth,
        }
    }

    /// The variable of a register that calls pass on.
    pub fn var(&self, register: CpuRegister) -> Var {
        match register {
            CpuRegister::Accu1 => self.accu[0],
            CpuRegister::Accu2 => self.accu[1],
            CpuRegister::Accu3 => self.accu[2],
            CpuRegister::Accu4 => self.accu[3],
            CpuRegister::Ar1 => self.ar[0],
            CpuRegister::Ar2 => self.ar[1],
            CpuRegister::Db => self.db,
            CpuRegister::Di => self.di,
            CpuRegister::Br => self.br,
            CpuRegister::Cc1 => self.cc1,
            CpuRegister::Cc0 => self.cc0,
            CpuRegister::Ov => self.ov,
            CpuRegister::Rlo => self.rlo,
        }
    }
}

/// A jump to a label: the block that it goes to, and the blocks of the safepoint on the way.
#[derive(Clone, Copy)]
pub struct JumpEdge {
    label: LabelId,
    pub block: Block,
    safepoint: Option<SafepointBlocks>,
}

/// A block in STL or in the typed tree of SCL while it is lowered.
pub struct BlockLowering<'p, 'o> {
    pub plan: &'p Plan<'p>,
    pub output: &'o mut Output<'p>,
    pub block: &'p CodeBlock,
    pub b: FunctionBuilder,
    pub regs: Registers,
    pub nesting: Vec<Nesting>,
    spare_nesting: Vec<Nesting>,
    /// Values of the formal parameters of an FC, in their order.
    pub parameters: Vec<Vec<Value>>,
    /// Elementary parameters of a function whose area pointers are also passed.
    area_pointers: Vec<(usize, Value)>,
    /// Copies of elementary parameters that pointers of the current call point at.
    pub pointed_copies: Vec<(Place, Width, Address)>,
    /// Offset of the instance from the memory base, if the block is an FB that leaves AR2 and DI alone.
    pub instance: Option<Value>,
    /// The complex IN_OUT of an FB in SCL, LAD or FBD.
    pub references: References,
    /// The formal parameters of a function in these languages that are texts, by their indices.
    pub formal_texts: FxHashMap<usize, FormalText>,
    /// Local data that code can address, in bytes.
    pub local_bytes: u32,
    /// Temporaries of the current statement begin here in the frame; `frame_bytes` is the most that was ever used.
    pub temporaries: u32,
    frame_bytes: u32,
    /// Index of the current statement's site.
    pub site: u32,
    /// Number of the current network, in a block in STL.
    pub network: u16,
    /// Place of the probes of its begin and its ends, if it has probes.
    pub block_place: Option<u32>,
    /// The statement of STL whose bits are counted for coverage.
    pub counted: Option<plcc_diag::Span>,
    /// False: the block has no `MCRA`, so the MCR is never off.
    pub uses_mcr: bool,
    pub stop_exit: StopExit,
    labels: Labels<LabelId>,
    /// Result of an access that may fault, 32 bits or a bit.
    pub result: Var,
    pub result_bit: Var,
    /// Like `result`, with 64 bits.
    pub result_long: Var,
    /// Reference to an actual parameter whose address may be faulty.
    pub reference: Var,
    /// For blocks in SCL.
    pub scl: SclState,
}

impl<'p, 'o> BlockLowering<'p, 'o> {
    /// Begins at the start of the block's function, with registers as the caller passes them.
    pub fn new(plan: &'p Plan<'p>, output: &'o mut Output<'p>, block: &'p CodeBlock) -> BlockLowering<'p, 'o> {
        let mut b = FunctionBuilder::new(
            plan::function_name(block),
            &plan.function_params(block),
            &plan.function_returns(block),
        );
        let regs = Registers::new(&mut b);
        let (result, result_bit) = (b.declare_var(Type::I32), b.declare_var(Type::I1));
        let result_long = b.declare_var(Type::I64);
        let reference = b.declare_var(Type::I32);
        let local_bytes = plan.local_bytes(block);
        let mut lowering = BlockLowering {
            plan,
            output,
            block,
            b,
            regs,
            nesting: Vec::new(),
            spare_nesting: Vec::new(),
            parameters: Vec::new(),
            area_pointers: Vec::new(),
            pointed_copies: Vec::new(),
            instance: None,
            references: References::default(),
            formal_texts: FxHashMap::default(),
            local_bytes,
            temporaries: local_bytes,
            frame_bytes: local_bytes,
            site: 0,
            network: 0,
            block_place: None,
            counted: None,
            uses_mcr: false,
            stop_exit: StopExit::default(),
            labels: Labels::default(),
            result,
            result_bit,
            result_long,
            reference,
            scl: SclState::default(),
        };
        lowering.start();
        lowering
    }

    /// Registers and local data at the first statement.
    fn start(&mut self) {
        let bits =
            [self.regs.br, self.regs.cc1, self.regs.cc0, self.regs.ov, self.regs.os, self.regs.or_, self.regs.fc];
        let zero = self.b.bool_const(false);
        for var in bits.into_iter().chain([self.regs.rlo, self.regs.mcr_active]) {
            self.b.def_var(var, zero);
        }
        let one = self.b.bool_const(true);
        self.b.def_var(self.regs.sta, one);
        let no_word = self.b.i32_const(0);
        for var in
            self.regs.accu.into_iter().chain(self.regs.ar).chain([self.regs.db, self.regs.di, self.regs.mcr_depth])
        {
            self.b.def_var(var, no_word);
        }
        let all_on = self.b.i32_const(u32::MAX);
        self.b.def_var(self.regs.mcr_bits, all_on);
        let mut first_local = 0;
        if self.block.kind == BlockKind::Ob {
            // The runtime has put the start information there.
            first_local = self.block.interface.start_bytes.min(self.local_bytes);
        } else {
            let plan = self.plan;
            for (index, &register) in plan.registers.iter().enumerate() {
                let value = self.b.param(index);
                self.b.def_var(self.regs.var(register), value);
            }
            self.name_parameters(plan.registers.len());
        }
        self.b.clear(Address::direct(Region::L, first_local), self.local_bytes - first_local);
    }

    fn name_parameters(&mut self, mut next: usize) {
        if !plan::takes_references(self.block) {
            return;
        }
        for parameter in &self.block.interface.parameters {
            let count = plan::parameter_types(parameter.passing).len();
            self.parameters.push((next..next + count).map(|index| self.b.param(index)).collect());
            next += count;
        }
        for &parameter in self.plan.pointed(self.block.key()) {
            self.area_pointers.push((parameter, self.b.param(next)));
            next += 1;
        }
    }

    /// The area pointer of the actual of elementary parameter `index` of this function, whose code uses it.
    pub fn area_pointer(&self, index: usize) -> Value {
        let found = self.area_pointers.iter().find(|(parameter, _)| *parameter == index);
        found.expect("the plan lists each parameter whose pointer is loaded").1
    }

    /// Passing of formal parameter `index` of this block.
    pub fn passing(&self, index: usize) -> Passing {
        self.block.interface.parameters[index].passing
    }

    // Registers.

    pub fn get(&mut self, var: Var) -> Value {
        self.b.use_var(var)
    }

    pub fn set(&mut self, var: Var, value: Value) {
        self.b.def_var(var, value);
    }

    pub fn set_bit(&mut self, var: Var, value: bool) {
        let value = self.b.bool_const(value);
        self.b.def_var(var, value);
    }

    pub fn accu1(&mut self) -> Value {
        self.get(self.regs.accu[0])
    }

    pub fn accu2(&mut self) -> Value {
        self.get(self.regs.accu[1])
    }

    pub fn set_accu1(&mut self, value: Value) {
        self.set(self.regs.accu[0], value);
    }

    pub fn rlo(&mut self) -> Value {
        self.get(self.regs.rlo)
    }

    /// Low word of a 32-bit value, as i16.
    pub fn low_word(&mut self, value: Value) -> Value {
        self.b.trunc(Type::I16, value)
    }

    /// Puts an i16 into ACCU1-L; ACCU1-H is kept.
    pub fn set_accu1_low(&mut self, word: Value) {
        let accu1 = self.accu1();
        let high = self.b.binary_imm(plcc_ir::BinaryOp::And, accu1, 0xFFFF_0000);
        let low = self.b.zext(Type::I32, word);
        let value = self.b.or(high, low);
        self.set_accu1(value);
    }

    /// The next statement's OR, STA, RLO, /FC are those after an instruction that ends a logic string: OR 0, /FC 0.
    pub fn end_logic_string(&mut self) {
        self.set_bit(self.regs.or_, false);
        self.set_bit(self.regs.fc, false);
    }

    /// Status word after a block call or at a block's end: OS, OR and /FC 0, STA 1.
    pub fn after_block(&mut self) {
        self.set_bit(self.regs.os, false);
        self.set_bit(self.regs.sta, true);
        self.end_logic_string();
    }

    /// True (an i1) unless the MCR is switched off here.
    pub fn mcr_on(&mut self) -> Value {
        if !self.uses_mcr {
            return self.b.bool_const(true);
        }
        let active = self.get(self.regs.mcr_active);
        let inactive = self.b.not(active);
        let bits = self.get(self.regs.mcr_bits);
        let all = self.b.icmp_imm(plcc_ir::IntCc::Eq, bits, -1);
        self.b.or(inactive, all)
    }

    // Nesting stack.

    /// Variables for one more open parenthesis.
    pub fn new_nesting(&mut self, insn: StlInsn) -> Nesting {
        let spare = self.spare_nesting.pop();
        let vars = spare.unwrap_or_else(|| {
            let mut bit = || self.b.declare_var(Type::I1);
            Nesting { insn, rlo: bit(), or_: bit(), fc: bit(), br: bit() }
        });
        Nesting { insn, ..vars }
    }

    pub fn pop_nesting(&mut self) -> Option<Nesting> {
        let nesting = self.nesting.pop()?;
        self.spare_nesting.push(nesting);
        Some(nesting)
    }

    // Positions in the source.

    /// Instructions built from now on belong to `statement`.
    pub fn set_statement(&mut self, statement: &StlStatement) {
        self.set_place(statement.span, statement.network);
    }

    /// Instructions built from now on belong to the code at `span`; temporaries are free again.
    pub fn set_place(&mut self, span: plcc_diag::Span, network: u16) {
        // Code in a block of the standard library belongs to the position that uses the block.
        let span = if span.file == self.block.span.file { span } else { self.block.span };
        self.site = self.output.site(self.block, span, network);
        self.b.set_loc(Loc(self.site + 1));
        self.temporaries = self.local_bytes;
    }

    /// Room for `bytes` in the frame until the end of the statement, at an even offset.
    pub fn temporary(&mut self, bytes: u32) -> Address {
        let offset = self.temporaries.next_multiple_of(2);
        self.temporaries = offset + bytes;
        self.frame_bytes = self.frame_bytes.max(self.temporaries);
        let addr = Address::direct(Region::L, offset);
        // A statement before may have had room for a text there.
        self.drop_room(addr);
        addr
    }

    /// Extends the local data that belongs to the block for its whole run to `bytes`; before temporaries are used.
    pub fn grow_locals(&mut self, bytes: u32) {
        self.local_bytes = bytes;
        self.temporaries = bytes;
        self.frame_bytes = self.frame_bytes.max(bytes);
    }

    // Control flow.

    /// Creates the block of a label that `jumps` statements jump to.
    pub fn declare_label(&mut self, label: LabelId, jumps: u32) {
        self.labels.declare(&mut self.b, label, jumps);
    }

    /// Code built from now on is at `label`.
    pub fn place_label(&mut self, label: LabelId) {
        self.labels.place(&mut self.b, label);
    }

    /// Whether a jump to `label` goes backward.
    pub fn is_backward(&self, label: LabelId) -> bool {
        self.labels.get(label).is_some_and(|label| label.placed)
    }

    /// Where a jump to `label` goes; a backward jump passes a safepoint on its way, which [`BlockLowering::jump_done`] builds.
    pub fn label_target(&mut self, label: LabelId) -> JumpEdge {
        if !self.is_backward(label) {
            return JumpEdge { label, block: self.label_block(label), safepoint: None };
        }
        let block = self.b.create_block();
        JumpEdge { label, block, safepoint: Some(SafepointBlocks::new(&mut self.b)) }
    }

    fn label_block(&self, label: LabelId) -> Block {
        self.labels.get(label).expect("labels are declared before statements are lowered").block
    }

    /// The jump over `edge` has been built; seals the label's block after the last one. There is no current block after it.
    pub fn jump_done(&mut self, edge: JumpEdge) {
        if let Some(safepoint) = edge.safepoint {
            let target = self.label_block(edge.label);
            self.b.seal_block(edge.block);
            self.b.switch_to(edge.block);
            self.stop_exit.safepoint_in(&mut self.b, safepoint, self.site);
            self.b.jump(target, &[]);
        }
        self.jump_skipped(edge.label);
    }

    /// A jump to `label` is unreachable, or has been built.
    pub fn jump_skipped(&mut self, label: LabelId) {
        self.labels.jump_done(&mut self.b, label);
    }

    /// Returns to the caller with the current registers.
    pub fn return_registers(&mut self) {
        self.probe_leave();
        let values: Vec<Value> = match self.block.kind {
            BlockKind::Ob => Vec::new(),
            _ => {
                let plan = self.plan;
                plan.returned_registers().map(|register| self.b.use_var(self.regs.var(register))).collect()
            }
        };
        self.b.ret(&values);
    }

    /// Ends the function.
    pub fn finish(mut self) -> plcc_ir::Function {
        if self.b.is_reachable() {
            self.return_registers();
        }
        self.stop_exit.finish(&mut self.b, &self.plan.function_returns(self.block));
        self.b.set_frame_bytes(layout::frame_bytes(self.frame_bytes));
        let by_pointers =
            !has_pointers_in_instance(self.block) && (self.block.library || is_by_pointers(&self.block.body));
        plcc_ir::Function { by_pointers, ..self.b.finish() }
    }
}

/// True of a function block that gets pointers: they are in its instance, where nobody looks for pointers to local data of its caller.
fn has_pointers_in_instance(block: &CodeBlock) -> bool {
    let is_pointer = |passing: Passing| !matches!(passing, Passing::Elementary(_) | Passing::Number);
    block.kind == BlockKind::Fb && block.interface.parameters.iter().any(|parameter| is_pointer(parameter.passing))
}

/// True of a block without statements in STL, which reach local data of the caller by any address.
fn is_by_pointers(body: &Body) -> bool {
    let Body::Scl(body) = body else { return false };
    let is_stl = |statement: &scl::Statement| matches!(statement.kind, scl::StatementKind::Stl(_)).then_some(());
    scl::walk::find(&body.statements, &is_stl).is_none()
}
