//! Turns a function into a dense list of operations for the interpreter.

use plcc_abi::{RuntimeFn, Type, layout};

use crate::entities::{Block, Entity, EntityVec, Inst, Value};
use crate::function::Function;
use crate::instructions::{Address, BinaryOp, BlockCall, ConvertOp, FloatCc, InstData, IntCc, Region, UnaryOp};
use crate::module::Module;

/// A register of the running function.
pub type Register = u32;

/// A part of [`Code::lists`].
#[derive(Clone, Copy)]
pub struct List {
    start: u32,
    len: u32,
}

/// A function ready to run.
pub struct Code {
    pub ops: Vec<Op>,
    lists: Vec<Register>,
    edges: Vec<Edge>,
    pub params: Vec<Register>,
    /// How many there are.
    pub registers: usize,
    pub frame_bytes: u32,
}

impl Code {
    pub fn list(&self, list: List) -> &[Register] {
        &self.lists[list.start as usize..(list.start + list.len) as usize]
    }

    /// Returns the parameters of the target their values; returns where it begins.
    pub fn follow(&self, edge: u32, registers: &mut [u64]) -> usize {
        let edge = &self.edges[edge as usize];
        for pair in self.list(edge.moves).chunks_exact(2) {
            registers[pair[0] as usize] = registers[pair[1] as usize];
        }
        edge.target as usize
    }
}

/// A jump: moves as pairs of (to, from), done one after the other, and the index of the first operation.
struct Edge {
    target: u32,
    moves: List,
}

/// The base of an address.
#[derive(Clone, Copy)]
pub enum Base {
    Memory,
    Frame,
    CallerFrame,
}

/// A place in memory: `base` + `offset` + register.
#[derive(Clone, Copy)]
pub struct Place {
    pub base: Base,
    pub register: Option<Register>,
    pub offset: u32,
    /// CPU state; everything else is big-endian.
    pub host_order: bool,
}

/// An operation: an instruction with registers for values.
pub enum Op {
    Const {
        dst: Register,
        bits: u64,
    },
    Unary {
        op: UnaryOp,
        ty: Type,
        dst: Register,
        arg: Register,
    },
    Binary {
        op: BinaryOp,
        ty: Type,
        dst: Register,
        args: [Register; 2],
    },
    IntCompare {
        cc: IntCc,
        ty: Type,
        dst: Register,
        args: [Register; 2],
    },
    FloatCompare {
        cc: FloatCc,
        ty: Type,
        dst: Register,
        args: [Register; 2],
    },
    Convert {
        op: ConvertOp,
        from: Type,
        to: Type,
        dst: Register,
        arg: Register,
    },
    Select {
        dst: Register,
        cond: Register,
        if_true: Register,
        if_false: Register,
    },
    Load {
        dst: Register,
        ty: Type,
        place: Place,
    },
    Store {
        ty: Type,
        place: Place,
        value: Register,
    },
    LoadBit {
        dst: Register,
        place: Place,
        bit: u8,
    },
    StoreBit {
        place: Place,
        bit: u8,
        value: Register,
    },
    AddressOf {
        dst: Register,
        place: Place,
    },
    Clear {
        place: Place,
        len: u32,
    },
    Copy {
        to: Place,
        from: Place,
        len: u32,
    },
    /// Reads the `u32` at byte `field` of the entry of a DB in the DB table.
    DbEntry {
        dst: Register,
        number: Register,
        field: u32,
    },
    FrameBase {
        dst: Register,
        offset: u32,
    },
    Call {
        callee: u32,
        args: List,
        results: List,
    },
    CallRuntime {
        function: RuntimeFn,
        args: List,
        dst: Option<(Register, Type)>,
    },
    Jump {
        edge: u32,
    },
    Branch {
        cond: Register,
        then_to: u32,
        else_to: u32,
    },
    /// Edge `first + value`, at most `first + count`, which is the default.
    Switch {
        value: Register,
        first: u32,
        count: u32,
    },
    Return {
        values: List,
    },
}

pub fn prepare(module: &Module, function: &Function) -> Code {
    let mut registers = EntityVec::filled(0, function.values.len());
    let mut count = 0;
    for &block in &function.layout {
        let data = &function.blocks[block];
        let results = data.insts.iter().flat_map(|&inst| &function.results[inst]);
        for &value in data.params.iter().chain(results) {
            registers[value] = count;
            count += 1;
        }
    }
    let mut preparer = Preparer {
        module,
        function,
        registers,
        temporaries: count,
        registers_used: count,
        starts: function.blocks.keys().map(|_| 0).collect(),
        code: Code {
            ops: Vec::with_capacity(function.insts.len()),
            lists: Vec::new(),
            edges: Vec::new(),
            params: Vec::new(),
            registers: 0,
            frame_bytes: function.frame_bytes,
        },
    };
    preparer.run();
    preparer.code
}

struct Preparer<'a> {
    module: &'a Module,
    function: &'a Function,
    registers: EntityVec<Value, Register>,
    /// First register that belongs to no value: for moves that must happen at once.
    temporaries: Register,
    registers_used: Register,
    /// First operation of each block.
    starts: Vec<u32>,
    code: Code,
}

impl Preparer<'_> {
    fn run(&mut self) {
        let function = self.function;
        if let Some(&entry) = function.layout.first() {
            self.code.params = function.blocks[entry].params.iter().map(|&param| self.register(param)).collect();
        }
        for &block in &function.layout {
            self.starts[block.index()] = self.code.ops.len() as u32;
            for &inst in &function.blocks[block].insts {
                let op = self.operation(inst);
                self.code.ops.push(op);
            }
        }
        for edge in &mut self.code.edges {
            edge.target = self.starts[edge.target as usize];
        }
        self.code.registers = self.registers_used as usize;
    }

    fn register(&self, value: Value) -> Register {
        self.registers[self.function.resolve(value)]
    }

    fn list(&mut self, values: &[Value]) -> List {
        let start = self.code.lists.len() as u32;
        for &value in values {
            let register = self.register(value);
            self.code.lists.push(register);
        }
        List { start, len: values.len() as u32 }
    }

    fn place(&self, addr: &Address) -> Place {
        let (base, start) = match addr.region {
            Region::State => (Base::Memory, layout::STATE),
            Region::I => (Base::Memory, layout::I),
            Region::Q => (Base::Memory, layout::Q),
            Region::M => (Base::Memory, layout::M),
            Region::System => (Base::Memory, layout::SYSTEM),
            Region::Cells => (Base::Memory, layout::T),
            Region::L => (Base::Frame, 0),
            Region::V => (Base::CallerFrame, 0),
            Region::Db(number) => {
                (Base::Memory, self.module.db(number).expect("the verifier has seen that the DB exists").address)
            }
            Region::AnyDb | Region::Any => (Base::Memory, 0),
        };
        Place {
            base,
            register: addr.base.map(|base| self.register(base)),
            offset: start.wrapping_add(addr.offset),
            host_order: addr.region.is_host_order(),
        }
    }

    /// Makes the edge for a jump; its target is a block until all blocks have their place.
    fn edge(&mut self, call: &BlockCall) -> u32 {
        let params = &self.function.blocks[call.block].params;
        let moves: Vec<(Register, Register)> = params
            .iter()
            .zip(&call.args)
            .map(|(&param, &arg)| (self.register(param), self.register(arg)))
            .filter(|(to, from)| to != from)
            .collect();
        // All parameters change at once: if one is the source of a later move, all go by way of temporaries.
        let clash =
            moves.iter().enumerate().any(|(index, (to, _))| moves[index + 1..].iter().any(|(_, from)| from == to));
        let start = self.code.lists.len() as u32;
        if clash {
            let temporaries = self.temporaries..;
            for ((_, from), temporary) in moves.iter().zip(temporaries.clone()) {
                self.code.lists.extend([temporary, *from]);
            }
            for ((to, _), temporary) in moves.iter().zip(temporaries) {
                self.code.lists.extend([*to, temporary]);
            }
            self.registers_used = self.registers_used.max(self.temporaries + moves.len() as u32);
        } else {
            self.code.lists.extend(moves.iter().flat_map(|&(to, from)| [to, from]));
        }
        let moves = List { start, len: self.code.lists.len() as u32 - start };
        let block: Block = call.block;
        self.code.edges.push(Edge { target: block.index() as u32, moves });
        self.code.edges.len() as u32 - 1
    }

    fn operation(&mut self, inst: Inst) -> Op {
        let function = self.function;
        let results = &function.results[inst];
        let ty = |value: Value| function.ty(value);
        let result = results.first().copied();
        let dst = result.map_or(0, |result| self.register(result));
        let result_type = result.map_or(Type::I1, ty);
        let pair = |args: &[Value; 2]| args.map(|arg| self.register(arg));
        match &function.insts[inst] {
            InstData::Const { bits } => Op::Const { dst, bits: *bits },
            InstData::Unary { op, arg } => Op::Unary { op: *op, ty: result_type, dst, arg: self.register(*arg) },
            InstData::Binary { op, args } => Op::Binary { op: *op, ty: result_type, dst, args: pair(args) },
            InstData::IntCompare { cc, args } => Op::IntCompare { cc: *cc, ty: ty(args[0]), dst, args: pair(args) },
            InstData::FloatCompare { cc, args } => Op::FloatCompare { cc: *cc, ty: ty(args[0]), dst, args: pair(args) },
            InstData::Convert { op, arg } => {
                Op::Convert { op: *op, from: ty(*arg), to: result_type, dst, arg: self.register(*arg) }
            }
            InstData::Select { cond, if_true, if_false } => Op::Select {
                dst,
                cond: self.register(*cond),
                if_true: self.register(*if_true),
                if_false: self.register(*if_false),
            },
            InstData::Load { addr } => Op::Load { dst, ty: result_type, place: self.place(addr) },
            InstData::Store { addr, value } => {
                Op::Store { ty: ty(*value), place: self.place(addr), value: self.register(*value) }
            }
            InstData::LoadBit { addr, bit } => Op::LoadBit { dst, place: self.place(addr), bit: *bit },
            InstData::StoreBit { addr, bit, value } => {
                Op::StoreBit { place: self.place(addr), bit: *bit, value: self.register(*value) }
            }
            InstData::AddressOf { addr } => Op::AddressOf { dst, place: self.place(addr) },
            InstData::Clear { addr, len } => Op::Clear { place: self.place(addr), len: *len },
            InstData::Copy { to, from, len } => Op::Copy { to: self.place(to), from: self.place(from), len: *len },
            InstData::DbBase { number } => Op::DbEntry { dst, number: self.register(*number), field: 0 },
            InstData::DbLength { number } => Op::DbEntry { dst, number: self.register(*number), field: 4 },
            InstData::FrameBase { callee } => {
                Op::FrameBase { dst, offset: if *callee { function.frame_bytes } else { 0 } }
            }
            InstData::Call { callee, args } => {
                let (args, results) = (self.list(args), self.list(results));
                Op::Call { callee: callee.index() as u32, args, results }
            }
            InstData::CallRuntime { function, args } => {
                Op::CallRuntime { function: *function, args: self.list(args), dst: result.map(|_| (dst, result_type)) }
            }
            InstData::Jump { target } => Op::Jump { edge: self.edge(target) },
            InstData::Branch { cond, then_to, else_to } => {
                Op::Branch { cond: self.register(*cond), then_to: self.edge(then_to), else_to: self.edge(else_to) }
            }
            InstData::Switch { value, targets, default } => {
                let first = self.code.edges.len() as u32;
                for target in targets.iter().chain([default]) {
                    self.edge(target);
                }
                Op::Switch { value: self.register(*value), first, count: targets.len() as u32 }
            }
            InstData::Return { values } => Op::Return { values: self.list(values) },
        }
    }
}
