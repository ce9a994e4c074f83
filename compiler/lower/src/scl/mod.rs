//! Statements of SCL: the typed tree to SSA IR. Source: SCL reference.
//!
//! - `statement`: control flow and assignments; `expression`, `arithmetic`, `convert`, `function`: values.
//! - `access`: values of variables; `located`: their places; `promote`: those in SSA values;
//!   `own_texts`: texts whose lengths are.
//! - `call`, `argument`: calls of blocks; `text`: STRING and WSTRING; `cell`: timers and counters.

mod access;
mod argument;
mod arithmetic;
mod call;
mod cell;
mod convert;
mod expression;
mod function;
pub mod located;
mod own_texts;
mod promote;
mod statement;
pub mod text;

use plcc_abi::image::BlockKind;
use plcc_ir::{Address, Block, Function, Region, Type, Value, Var};
use plcc_model::layout;
use plcc_model::scl::{Access, SclBody, Statement, StatementKind, walk};
use plcc_model::types::{Class, Elementary};
use plcc_model::{CodeBlock, Direction, LabelId, Passing};
use rustc_hash::FxHashMap;

use crate::Output;
use crate::block::BlockLowering;
use crate::place::{BitNumber, Target};
use crate::plan::Plan;
use crate::probe::Asked;

pub use self::call::result;
pub use self::own_texts::{OwnText, is_own_result};
use self::promote::Slot;
pub use self::text::result_bytes;

/// Data about the block while SCL is lowered.
#[derive(Default)]
pub struct SclState {
    pub promoted: FxHashMap<Slot, Var>,
    /// OK or ENO, and the ENO of the last call; both none in other languages.
    flag: Option<Var>,
    last_eno: Option<Var>,
    /// Operations clear the flag: here, and in the block as a whole.
    sets_flag: bool,
    block_sets_flag: bool,
    calls_set_flag: bool,
    /// See [`SclBody::inputs_in_place`].
    inputs_in_place: bool,
    /// The result of the call that is lowered, if it is a text, is read by a function of texts only.
    pub only_text: bool,
    /// Texts whose lengths are values, by their bytes in the frame.
    own_texts: FxHashMap<u32, OwnText>,
    /// Functions of texts are lowered as calls: their way without one was lowered before.
    pub by_runtime: bool,
    loops: Vec<Loop>,
    /// Number of IF statements around the current one.
    conditions: u32,
    /// Elementary formals whose pointers are passed on, and the copies in the frame that these point at.
    pointed_copies: Vec<(Access, Address)>,
    /// The network that has the last probe of a beginning for a debugger; 0: none.
    pub told_network: u16,
    /// Where parts begin that may be functions of their own.
    parts: Vec<Block>,
    /// The promoted result, written when the block ends.
    result: Option<(usize, Elementary, Var)>,
}

/// A loop around the current statement: where EXIT and CONTINUE go.
#[derive(Clone, Copy)]
struct Loop {
    exit: Block,
    next: Block,
}

/// Lowers a block to a function.
pub fn lower_block<'p>(
    plan: &'p Plan<'p>,
    output: &mut Output<'p>,
    block: &'p CodeBlock,
    body: &'p SclBody,
) -> Function {
    let mut lowering = BlockLowering::new(plan, output, block);
    lowering.uses_mcr = body
        .statements
        .iter()
        .any(|statement| matches!(&statement.kind, StatementKind::Stl(statement) if crate::stl::uses_mcr(statement)));
    lowering.begin_scl(body);
    lowering.probe_enter();
    for (label, jumps) in count_jumps(body) {
        lowering.declare_label(label, jumps);
    }
    lowering.statements(&body.statements);
    let (parts, variables) = (std::mem::take(&mut lowering.scl.parts), lowering.local_bytes);
    let mut function = lowering.finish_scl();
    output.cut(&mut function, &parts, variables);
    function
}

impl BlockLowering<'_, '_> {
    fn begin_scl(&mut self, body: &SclBody) {
        let yes = self.b.bool_const(true);
        let flags = [self.b.declare_var(Type::I1), self.b.declare_var(Type::I1)];
        for flag in flags {
            self.b.def_var(flag, yes);
        }
        self.scl.flag = Some(flags[0]);
        self.scl.last_eno = Some(flags[1]);
        self.scl.sets_flag = body.sets_flag;
        self.scl.block_sets_flag = body.sets_flag;
        self.scl.calls_set_flag = body.calls_set_flag;
        self.scl.inputs_in_place = body.inputs_in_place;
        if matches!(self.block.kind, BlockKind::Fb | BlockKind::Sfb) {
            let (di, ar2) = (self.get(self.regs.di), self.get(self.regs.ar[1]));
            self.instance = Some(self.instance_address(di, ar2));
        }
        self.begin_references();
        self.begin_formal_texts();
        self.prepare_texts(body);
        self.begin_own_texts(body);
        let block = self.block;
        // A debugger reads and changes variables.
        let promoted = match self.output.probes.asked {
            Asked::Statements => Vec::new(),
            Asked::Nothing | Asked::Values | Asked::Coverage => promote::promotable(block, body),
        };
        for (slot, ty) in promoted {
            let var = self.b.declare_var(value_type(ty));
            let start = match slot {
                Slot::Parameter(index) if block.interface.parameters[index].direction == Direction::Input => {
                    let place = plcc_model::Place::Parameter { parameter: index, byte: 0, bit: 0 };
                    let value = self.read(&place, layout::width(ty));
                    self.typed(value, ty)
                }
                Slot::Parameter(index) => {
                    self.scl.result = Some((index, ty, var));
                    self.zero(ty)
                }
                Slot::Local(_) => self.zero(ty),
            };
            self.b.def_var(var, start);
            self.scl.promoted.insert(slot, var);
        }
        self.copy_inputs();
    }

    /// Elementary inputs of an FC are its own: those not in SSA values get an address in the frame.
    fn copy_inputs(&mut self) {
        let block = self.block;
        if self.parameters.is_empty() || self.scl.inputs_in_place {
            return;
        }
        for (index, parameter) in block.interface.parameters.iter().enumerate() {
            let Passing::Elementary(width) = parameter.passing else { continue };
            if parameter.direction != Direction::Input || self.scl.promoted.contains_key(&Slot::Parameter(index)) {
                continue;
            }
            let place = plcc_model::Place::Parameter { parameter: index, byte: 0, bit: 0 };
            let value = self.read(&place, width);
            let copy = self.own_local(width.bytes());
            self.write_target(Target::at(copy, BitNumber::Known(0)), width, value);
            let address = self.b.address_of(copy);
            let reference = match width {
                plcc_model::Width::Bit => self.b.binary_imm(plcc_ir::BinaryOp::Shl, address, 3),
                _ => address,
            };
            self.parameters[index][0] = reference;
        }
    }

    /// Room in the frame for the whole run of the block.
    fn own_local(&mut self, bytes: u32) -> Address {
        let offset = self.local_bytes.next_multiple_of(2);
        self.grow_locals(offset + bytes);
        Address::direct(Region::L, offset)
    }

    /// The value that a variable of `ty` has before it is written.
    pub fn zero(&mut self, ty: Elementary) -> Value {
        // All bits 0 also means 0.0.
        self.b.iconst(value_type(ty), 0)
    }

    fn flag(&self) -> Var {
        self.scl.flag.expect("blocks in SCL have the bit")
    }

    fn last_eno(&self) -> Var {
        self.scl.last_eno.expect("blocks in SCL have the bit")
    }

    /// Clears OK/ENO if `failed`, an i1, if operations do so.
    pub fn fail_if(&mut self, failed: Value) {
        if !self.scl.sets_flag {
            return;
        }
        let flag = self.flag();
        let before = self.b.use_var(flag);
        let good = self.b.not(failed);
        let after = self.b.and(before, good);
        self.b.def_var(flag, after);
    }

    /// Whether anything uses the effect of [`BlockLowering::fail_if`].
    pub fn wants_flag(&self) -> bool {
        self.scl.sets_flag
    }

    /// Leaves the block: OK/ENO is the caller's BR.
    fn leave_block(&mut self) {
        if let Some((index, ty, var)) = self.scl.result {
            let value = self.b.use_var(var);
            let value = self.untyped(value, ty);
            let place = plcc_model::Place::Parameter { parameter: index, byte: 0, bit: 0 };
            self.write(&place, layout::width(ty), value);
        }
        self.cut_text_result();
        self.leave_own_result();
        let flag = self.b.use_var(self.flag());
        self.set(self.regs.br, flag);
        self.return_registers();
    }

    fn finish_scl(mut self) -> Function {
        if self.b.is_reachable() {
            self.leave_block();
        }
        self.finish()
    }

    /// What follows may be a function of its own, unless probes look at it.
    fn begin_part(&mut self) {
        if self.output.probes.asked == Asked::Nothing {
            let part = self.b.create_block();
            self.b.jump(part, &[]);
            self.b.seal_block(part);
            self.b.switch_to(part);
            self.scl.parts.push(part);
        }
    }

    /// Code that is built after a jump belongs to a block that is never reached.
    fn reachable(&mut self) {
        if !self.b.is_reachable() {
            let nowhere = self.b.create_block();
            self.b.seal_block(nowhere);
            self.b.switch_to(nowhere);
        }
    }
}

/// The IR type of values of `ty`.
pub fn value_type(ty: Elementary) -> Type {
    match (ty.class(), ty.bits()) {
        (Class::Float, 32) => Type::F32,
        (Class::Float, _) => Type::F64,
        (_, 1) => Type::I1,
        (_, 8) => Type::I8,
        (_, 16) => Type::I16,
        (_, 32) => Type::I32,
        (_, _) => Type::I64,
    }
}

/// Jumps to each label that has any, in order of the first jumps.
fn count_jumps(body: &SclBody) -> Vec<(LabelId, u32)> {
    #[derive(Default)]
    struct Jumps {
        order: Vec<LabelId>,
        counts: FxHashMap<LabelId, u32>,
    }
    impl walk::Visitor for Jumps {
        fn statement(&mut self, statement: &Statement) {
            let jumps = match &statement.kind {
                StatementKind::Goto(label) => vec![*label],
                StatementKind::Stl(statement) => crate::stl::jumps_of(statement),
                _ => return,
            };
            for label in jumps {
                let order = &mut self.order;
                *self.counts.entry(label).or_insert_with(|| {
                    order.push(label);
                    0
                }) += 1;
            }
        }
    }
    let mut jumps = Jumps::default();
    walk::statements(&body.statements, &mut jumps);
    jumps.order.into_iter().map(|label| (label, jumps.counts[&label])).collect()
}
