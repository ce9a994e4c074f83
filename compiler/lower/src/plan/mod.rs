//! What the blocks of a program must know about each other before any of them is lowered.
//!
//! `facts` are those of one block by itself, `frame` counts bytes in its frame, `texts` finds out which texts functions get.

mod facts;
mod frame;
mod texts;

use plcc_abi::Type;
use plcc_abi::codes;
use plcc_abi::image::{BlockKind, ErrorSlot};
use plcc_abi::layout::{self, CpuRegister};
use plcc_ir::StaticDb;
use plcc_ir::entities::{Entity, FuncId};
use plcc_model::Program;
use plcc_model::{BlockKey, Body, CodeBlock, DataBlock, Passing};
use rustc_hash::FxHashMap;

use self::facts::BlockFacts;
pub use self::facts::changes_ar2;
pub use self::frame::{INDEX_COPY_BYTES, POINTED_COPY_BYTES, local_bytes};
pub use self::texts::GivenText;

/// Facts about the whole program.
pub struct Plan<'a> {
    pub program: &'a Program,
    /// Parameters of block functions that are registers, in order.
    pub registers: Vec<CpuRegister>,
    /// DBs in memory, sorted by number.
    pub dbs: Vec<StaticDb>,
    pub db_end: u32,
    dbs_at_start: FxHashMap<u16, &'a DataBlock>,
    /// Numbers of write-protected DBs.
    pub protected_dbs: Vec<u16>,
    /// A call names its block at run time: every FC and FB needs an entry.
    pub has_dynamic_calls: bool,
    /// Calls must count depth and local data at run time, because neither is bounded at compile time.
    pub checks_depth: bool,
    pub stops_itself: bool,
    /// A block passes a pointer that it received to a block that it calls: area V then reaches beyond the caller.
    pub hands_on_pointers: bool,
    functions: Vec<Option<FuncId>>,
    index: FxHashMap<BlockKey, usize>,
    changes_ar2: Vec<bool>,
    frame_estimates: Vec<u32>,
    /// Blocks that contain GET_ERROR or GET_ERR_ID.
    handles_errors: Vec<bool>,
    /// Elementary parameters of functions whose area pointer their code loads (`L P##x`).
    pointed: Vec<Vec<usize>>,
    /// Parameters that are texts which surely exist.
    given_texts: Vec<Vec<Option<GivenText>>>,
    /// Functions that use the text that is their result only as a whole.
    own_results: Vec<bool>,
}

impl<'a> Plan<'a> {
    pub fn new(program: &'a Program) -> Plan<'a> {
        let (dbs, db_end) = place_dbs(program);
        let mut next = 0;
        let functions = program
            .blocks
            .iter()
            .map(|block| {
                (!matches!(block.body, Body::Runtime)).then(|| {
                    next += 1;
                    FuncId::new(next - 1)
                })
            })
            .collect();
        let index: FxHashMap<BlockKey, usize> =
            program.blocks.iter().enumerate().map(|(index, block)| (block.key(), index)).collect();
        let facts: Vec<BlockFacts> =
            program.blocks.iter().map(|block| BlockFacts::new(block, program, &index)).collect();
        let mut plan = Plan {
            program,
            registers: CpuRegister::ALL
                .into_iter()
                .filter(|register| {
                    program.profile.accumulators == 4 || !matches!(register, CpuRegister::Accu3 | CpuRegister::Accu4)
                })
                .collect(),
            dbs,
            db_end,
            dbs_at_start: program.dbs.iter().filter(|db| !db.unlinked).map(|db| (db.number, db)).collect(),
            protected_dbs: program.dbs.iter().filter(|db| db.read_only).map(|db| db.number).collect(),
            has_dynamic_calls: facts.iter().any(|facts| facts.dynamic_calls),
            checks_depth: false,
            stops_itself: facts.iter().any(|facts| facts.stops),
            hands_on_pointers: facts.iter().any(|facts| facts.hands_on_pointers),
            functions,
            index,
            changes_ar2: Vec::new(),
            frame_estimates: facts
                .iter()
                .map(|facts| facts.frame_estimate + if facts.handles_errors() { ERROR_SLOT_BYTES } else { 0 })
                .collect(),
            handles_errors: facts.iter().map(BlockFacts::handles_errors).collect(),
            pointed: program.blocks.iter().zip(&facts).map(|(block, facts)| facts.pointed_of(block)).collect(),
            given_texts: Vec::new(),
            own_results: Vec::new(),
        };
        plan.given_texts = texts::given_texts(program, &plan.index, &plan.dbs, plan.has_dynamic_calls);
        plan.changes_ar2 = plan.find_ar2_changes(&facts);
        plan.checks_depth = plan.has_dynamic_calls || plan.too_deep(&facts);
        plan.own_results = program.blocks.iter().map(|block| has_own_result(&plan, block)).collect();
        plan
    }

    /// The function of the block at `index` of the program; none for system functions of the runtime.
    pub fn function(&self, index: usize) -> Option<FuncId> {
        self.functions[index]
    }

    pub fn block_index(&self, key: BlockKey) -> Option<usize> {
        self.index.get(&key).copied()
    }

    pub fn block(&self, key: BlockKey) -> Option<(&'a CodeBlock, Option<FuncId>)> {
        let index = self.block_index(key)?;
        Some((&self.program.blocks[index], self.functions[index]))
    }

    /// True if the block's code changes AR2, itself or by blocks that it calls: its caller cannot rely on AR2.
    pub fn changes_ar2(&self, key: BlockKey) -> bool {
        self.block_index(key).is_some_and(|index| self.changes_ar2[index])
    }

    /// True if the block handles its synchronous errors itself.
    pub fn handles_errors(&self, key: BlockKey) -> bool {
        self.block_index(key).is_some_and(|index| self.handles_errors[index])
    }

    /// Elementary parameters of a function whose area pointers its code loads, in order: its callers also pass the pointers.
    pub fn pointed(&self, key: BlockKey) -> &[usize] {
        self.block_index(key).map_or(&[], |index| &self.pointed[index])
    }

    /// What all callers give a function for a parameter that is a text, if all these exist.
    pub fn given_text(&self, key: BlockKey, parameter: usize) -> Option<GivenText> {
        *self.given_texts.get(self.block_index(key)?)?.get(parameter)?
    }

    /// True of a function whose result is a text that only functions of texts and assignments reach in it, and that has room in the frame of
    /// each caller.
    pub fn has_own_result(&self, key: BlockKey) -> bool {
        self.block_index(key).is_some_and(|index| self.own_results[index])
    }

    /// Like [`local_bytes`], with the room for the first error of a block that handles its errors.
    pub fn local_bytes(&self, block: &CodeBlock) -> u32 {
        local_bytes(block) + if self.handles_errors(block.key()) { codes::local_error::BYTES } else { 0 }
    }

    /// Where blocks that handle their errors store the first one: after their local data.
    pub fn error_slots(&self) -> Vec<ErrorSlot> {
        let blocks = self.program.blocks.iter().filter(|block| self.handles_errors(block.key()));
        blocks.map(|block| ErrorSlot { kind: block.kind, number: block.number, offset: local_bytes(block) }).collect()
    }

    /// Upper bound of the block's frame, in bytes.
    pub fn frame_estimate(&self, key: BlockKey) -> u32 {
        self.block_index(key).map_or(0, |index| self.frame_estimates[index])
    }

    /// The DB's address, if it is in memory before the first cycle.
    pub fn static_db(&self, number: u16) -> Option<&StaticDb> {
        self.dbs.binary_search_by_key(&number, |db| db.number).ok().map(|index| &self.dbs[index])
    }

    /// The DB as it is when the program is loaded, if it is in memory then.
    pub fn db_at_start(&self, number: u16) -> Option<&'a DataBlock> {
        self.dbs_at_start.get(&number).copied()
    }

    /// Types of the parameters of a block's function: the registers, what [`parameter_types`] lists, then an area pointer for each
    /// parameter of [`pointed`](Plan::pointed).
    pub fn function_params(&self, block: &CodeBlock) -> Vec<Type> {
        if block.kind == BlockKind::Ob {
            return Vec::new();
        }
        let mut types: Vec<Type> = self.registers.iter().map(|&register| register_type(register)).collect();
        if takes_references(block) {
            for parameter in &block.interface.parameters {
                types.extend_from_slice(parameter_types(parameter.passing));
            }
            types.extend(self.pointed(block.key()).iter().map(|_| Type::I32));
        }
        types
    }

    /// The registers that a block's function returns. After a call, DB and DI are those of the caller again.
    pub fn returned_registers(&self) -> impl Iterator<Item = CpuRegister> + '_ {
        self.registers.iter().copied().filter(|register| !matches!(register, CpuRegister::Db | CpuRegister::Di))
    }

    /// Types of the values that a block's function returns.
    pub fn function_returns(&self, block: &CodeBlock) -> Vec<Type> {
        match block.kind {
            BlockKind::Ob => Vec::new(),
            _ => self.returned_registers().map(register_type).collect(),
        }
    }

    /// Every block that changes AR2, or that calls one that does and passes on AR2.
    fn find_ar2_changes(&self, facts: &[BlockFacts]) -> Vec<bool> {
        let mut changes: Vec<bool> = facts.iter().map(|facts| facts.changes_ar2 || facts.dynamic_calls).collect();
        loop {
            let mut changed = false;
            for (index, facts) in facts.iter().enumerate() {
                if !changes[index]
                    && facts.passes_ar2_to.iter().any(|key| self.block_index(*key).is_some_and(|i| changes[i]))
                {
                    changes[index] = true;
                    changed = true;
                }
            }
            if !changed {
                return changes;
            }
        }
    }

    /// True if a chain of calls may exceed the block depth or the local data of a priority class.
    fn too_deep(&self, facts: &[BlockFacts]) -> bool {
        let profile = &self.program.profile;
        let mut heights: Vec<Option<Height>> = vec![None; facts.len()];
        for root in 0..facts.len() {
            match self.height(root, facts, &mut heights) {
                None => return true,
                Some(height) => {
                    let block = &self.program.blocks[root];
                    let depth_max = profile.depth_max(self.program.config.class_of(block.number));
                    if block.kind == BlockKind::Ob && (height.depth > depth_max || height.bytes > profile.local_data) {
                        return true;
                    }
                }
            }
        }
        false
    }

    /// Height of the call tree below block `root`; `None` if it is not bounded. Walks without recursion: the tree of a program
    /// may have any depth.
    fn height(&self, root: usize, facts: &[BlockFacts], heights: &mut [Option<Height>]) -> Option<Height> {
        let mut on_path = vec![false; facts.len()];
        let mut stack = vec![(root, 0)];
        on_path[root] = true;
        while let Some((index, next)) = stack.pop() {
            let callee = facts[index].calls.get(next).and_then(|key| self.block_index(*key));
            if next < facts[index].calls.len() {
                stack.push((index, next + 1));
                if let Some(callee) = callee
                    && heights[callee].is_none()
                {
                    if on_path[callee] {
                        return None;
                    }
                    on_path[callee] = true;
                    stack.push((callee, 0));
                }
                continue;
            }
            on_path[index] = false;
            let mut height = Height { depth: 0, bytes: 0 };
            for key in &facts[index].calls {
                if let Some(below) = self.block_index(*key).and_then(|callee| heights[callee]) {
                    height.depth = height.depth.max(below.depth);
                    height.bytes = height.bytes.max(below.bytes);
                }
            }
            heights[index] = Some(Height {
                depth: height.depth + 1,
                bytes: height.bytes.saturating_add(facts[index].frame_estimate),
            });
        }
        heights[root]
    }
}

/// See [`Plan::has_own_result`].
fn has_own_result(plan: &Plan, block: &CodeBlock) -> bool {
    let (Body::Scl(body), Some((index, parameter))) = (&block.body, crate::scl::result(block)) else { return false };
    let is_text = matches!(parameter.ty, plcc_model::types::DataType::String(_));
    let is_room = || plan.given_text(block.key(), index).is_some_and(|given| given.is_room);
    is_text && is_room() && crate::scl::is_own_result(plan, body, index)
}

/// Size of a call tree: blocks on the longest path, limit of the local data in bytes.
#[derive(Clone, Copy)]
struct Height {
    depth: u32,
    bytes: u32,
}

/// Gives every DB its address.
pub(crate) fn place_dbs(program: &Program) -> (Vec<StaticDb>, u32) {
    let mut address = layout::DB_DATA;
    let mut dbs = Vec::new();
    for db in program.dbs.iter().filter(|db| !db.unlinked) {
        let length = db.data.len() as u32;
        dbs.push(StaticDb { number: db.number, address, length, read_only: db.read_only });
        address += length.next_multiple_of(layout::DB_ALIGN);
    }
    (dbs, address)
}

/// The IR type of a register at block borders.
pub fn register_type(register: CpuRegister) -> Type {
    if register.is_bit() { Type::I1 } else { Type::I32 }
}

/// True for functions of the program: their formals are references to the actuals. System functions of the runtime get copies.
pub fn takes_references(block: &CodeBlock) -> bool {
    matches!(block.kind, BlockKind::Fc | BlockKind::Sfc) && !matches!(block.body, Body::Runtime)
}

/// The values that an FC gets for a parameter.
///
/// - elementary: a reference: offset of the actual from the memory base; for a BOOL, eight times that plus the bit
/// - complex: the position of its POINTER in the caller's frame, and the offset of the variable from the memory base
/// - TIMER, COUNTER, BLOCK_x: the number
/// - POINTER, ANY: its position in the caller's frame
/// - ARRAY[*]: as complex, then low and high bound of each dimension (at most 6)
pub fn parameter_types(passing: Passing) -> &'static [Type] {
    match passing {
        Passing::Elementary(_) | Passing::Number | Passing::Pointer | Passing::Any | Passing::Variant => &[Type::I32],
        Passing::Complex { .. } => &[Type::I32, Type::I32],
        Passing::OpenArray { dimensions } => &[Type::I32; 2 + 2 * 6][..2 + 2 * usize::from(dimensions)],
    }
}

/// Limit of the room for the first error in a frame.
const ERROR_SLOT_BYTES: u32 = layout::frame_bytes(codes::local_error::BYTES);

/// The function's name: `FC12`.
pub fn function_name(block: &CodeBlock) -> String {
    format!("{}{}", block.kind.prefix(), block.number)
}
