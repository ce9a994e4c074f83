//! What blocks must know about each other before any of them is lowered.

use std::collections::BTreeSet;
use std::hash::{Hash, Hasher};

use plcc_abi::image::BlockKind;
use plcc_abi::layout;
use plcc_abi::s7200::CONSTANTS_DB;
use plcc_abi::s7200::image::EdgeMemory;
use plcc_diag::SourceMap;
use plcc_ir::entities::Entity;
use plcc_ir::{FuncId, StaticDb, Type};
use plcc_model::Program;
use plcc_model::s7200::{self as model, Direction, Insn, Operand, StatementKind, Width};
use plcc_model::{BlockKey, Body, CodeBlock};
use rustc_hash::{FxHashMap, FxHasher};

use crate::plan::place_dbs;

/// Depth of calls that needs no counting: from the main program, from an interrupt routine. Source: S7-200 system manual, subroutines; from
/// interrupt routines one level, more levels run with a warning.
const DEPTH_MAIN: u32 = 8;
const DEPTH_INTERRUPT: u32 = 4;

/// Edge memories are allocated in sequence.
#[derive(Clone, Copy, Default)]
pub struct Edges {
    pub first: u32,
    pub next: u32,
}

impl Edges {
    pub fn take(&mut self) -> u32 {
        let edge = self.next;
        self.next += 1;
        edge
    }
}

/// String constants of the program, each with its length byte.
#[derive(Clone, Default)]
pub struct Texts {
    pub bytes: Vec<u8>,
    places: FxHashMap<Vec<u8>, u32>,
}

impl Texts {
    fn add(&mut self, text: &[u8]) {
        if !self.places.contains_key(text) {
            self.places.insert(text.to_vec(), self.bytes.len() as u32);
            self.bytes.push(text.len().min(usize::from(u8::MAX)) as u8);
            self.bytes.extend(text.iter().take(usize::from(u8::MAX)));
        }
    }

    /// Offset of a text in the DB of constants.
    pub fn offset(&self, text: &[u8]) -> u32 {
        self.places.get(text).copied().unwrap_or(0)
    }
}

/// See the module comment.
pub struct S7200Plan<'p> {
    pub program: &'p Program,
    pub dbs: Vec<StaticDb>,
    pub db_end: u32,
    pub texts: Texts,
    pub timers: BTreeSet<u8>,
    pub rising_edges: Edges,
    pub falling_edges: Edges,
    /// Interrupt routines may be attached: networks begin with a safepoint.
    pub has_interrupts: bool,
    /// Recursion, or deeper than the CPU always allows.
    pub counts_calls: bool,
    pub stops_itself: bool,
}

impl<'p> S7200Plan<'p> {
    pub fn new(program: &'p Program) -> S7200Plan<'p> {
        let (mut dbs, mut db_end) = place_dbs(program);
        let mut plan = S7200Plan {
            program,
            dbs: Vec::new(),
            db_end,
            texts: Texts::default(),
            timers: BTreeSet::new(),
            rising_edges: Edges::default(),
            falling_edges: Edges::default(),
            has_interrupts: program.config.s7200.stop_on_error,
            counts_calls: false,
            stops_itself: false,
        };
        let mut rising = 0;
        for block in &program.blocks {
            let Body::S7200(body) = &block.body else { continue };
            for statement in &body.statements {
                rising += plan.look_at(&statement.kind);
            }
        }
        plan.falling_edges = Edges { first: rising, next: rising };
        if !plan.texts.bytes.is_empty() {
            let length = plan.texts.bytes.len() as u32;
            dbs.push(StaticDb { number: CONSTANTS_DB, address: db_end, length, read_only: true });
            db_end += length.next_multiple_of(layout::DB_ALIGN);
        }
        plan.dbs = dbs;
        plan.db_end = db_end;
        plan.counts_calls = plan.needs_counting();
        plan
    }

    /// Notes what a statement uses; returns the number of its edge memories for rising edges.
    fn look_at(&mut self, kind: &StatementKind) -> u32 {
        let (operands, rising) = match kind {
            StatementKind::Instruction { insn, operands } => {
                match (insn, operands.first()) {
                    (Insn::Ton | Insn::Tonr | Insn::Tof, Some(Operand::Timer { number, .. })) => {
                        self.timers.insert(*number);
                    }
                    (Insn::Atch, _) => self.has_interrupts = true,
                    (Insn::Stop, _) => self.stops_itself = true,
                    _ => {}
                }
                (operands, rising_edges(*insn))
            }
            StatementKind::Call { arguments, .. } => (arguments, 0),
            StatementKind::Assert(_) | StatementKind::Sleep(_) => return 0,
        };
        for operand in operands {
            if let Operand::Text(text) = operand {
                self.texts.add(text);
            }
        }
        rising
    }

    /// The function of block `index` of the program.
    pub fn function(&self, index: usize) -> Option<FuncId> {
        let of = |block: &&CodeBlock| matches!(block.body, Body::S7200(_));
        let block = self.program.blocks.get(index)?;
        of(&block).then(|| FuncId::new(self.program.blocks.iter().take(index).filter(of).count()))
    }

    /// Function and code of subroutine `number`.
    pub fn subroutine(&self, number: u16) -> Option<(FuncId, &'p model::S7200Body)> {
        let key = BlockKey { kind: BlockKind::Sbr, number };
        let index = self.program.blocks.binary_search_by_key(&key, CodeBlock::key).ok()?;
        match &self.program.blocks[index].body {
            Body::S7200(body) => Some((self.function(index)?, body)),
            _ => None,
        }
    }

    fn needs_counting(&self) -> bool {
        let mut depths = FxHashMap::default();
        self.program.blocks.iter().any(|block| {
            let limit = match block.kind {
                BlockKind::Ob => DEPTH_MAIN,
                BlockKind::Int => DEPTH_INTERRUPT,
                _ => return false,
            };
            match &block.body {
                Body::S7200(body) => self.depth(body, &mut depths).is_none_or(|depth| depth > limit),
                _ => false,
            }
        })
    }

    /// Levels of calls below a block; `None`: not bounded.
    fn depth(&self, body: &model::S7200Body, depths: &mut FxHashMap<u16, Option<u32>>) -> Option<u32> {
        let mut deepest = 0;
        for statement in &body.statements {
            let StatementKind::Call { number, .. } = statement.kind else { continue };
            let below = match depths.get(&number) {
                Some(known) => *known,
                None => {
                    // A block in progress has no known depth: a recursion ends here.
                    depths.insert(number, None);
                    let below = self.subroutine(number).map_or(Some(0), |(_, body)| self.depth(body, depths));
                    depths.insert(number, below);
                    below
                }
            };
            deepest = deepest.max(below? + 1);
        }
        Some(deepest)
    }
}

/// Memories for rising edges that an instruction needs.
fn rising_edges(insn: Insn) -> u32 {
    match insn {
        Insn::RisingEdge | Insn::Ctu | Insn::Ctd => 1,
        Insn::Ctud => 2,
        _ => 0,
    }
}

/// The edge memories in the order in which they are allocated: rising and falling ones each in the order of the statements.
pub fn edge_memories(program: &Program, sources: &SourceMap) -> Vec<EdgeMemory> {
    let mut all = Vec::new();
    for block in &program.blocks {
        let Body::S7200(body) = &block.body else { continue };
        for statements in body.statements.chunk_by(|one, next| one.network == next.network) {
            let mut hasher = FxHasher::default();
            for statement in statements {
                sources.text(statement.span).split_whitespace().for_each(|word| word.hash(&mut hasher));
                let StatementKind::Instruction { insn, .. } = &statement.kind else { continue };
                let memory = |is_falling| EdgeMemory {
                    kind: block.kind,
                    block: block.number,
                    network: statement.network,
                    statements: hasher.finish(),
                    is_falling,
                };
                all.extend((0..rising_edges(*insn)).map(|_| memory(false)));
                all.extend((*insn == Insn::FallingEdge).then(|| memory(true)));
            }
        }
    }
    all
}

/// IR type of a value of this width.
pub fn ir_type(width: Width) -> Type {
    match width {
        Width::Bit => Type::I1,
        Width::Byte => Type::I8,
        Width::Word => Type::I16,
        Width::Dword | Width::Lword => Type::I32,
    }
}

/// Parameters of a block's function: the values to copy in.
pub fn parameters(body: &model::S7200Body) -> Vec<Type> {
    let copied_in = body.parameters.iter().filter(|parameter| parameter.direction != Direction::Out);
    copied_in.map(|parameter| ir_type(parameter.width)).collect()
}

/// The return values of a block's function: the values to copy back.
pub fn returns(body: &model::S7200Body) -> Vec<Type> {
    let copied_back = body.parameters.iter().filter(|parameter| parameter.direction != Direction::In);
    copied_back.map(|parameter| ir_type(parameter.width)).collect()
}
