//! Runs functions in memory against a plain buffer.

use plcc_abi::layout;
use plcc_codegen::{CodegenOptions, JitProgram};
use plcc_ir::{FuncId, Function, FunctionBuilder, Module, RuntimeFn, StaticDb};

/// PLC memory with room for a few DBs.
pub const MEMORY_BYTES: usize = layout::DB_DATA as usize + 0x1_0000;
pub const LBASE: u32 = layout::L + 0x100;
pub const VBASE: u32 = layout::L + 0x40;
/// A DB that tests may use.
pub const DB: StaticDb = StaticDb { number: 10, address: layout::DB_DATA + 0x20, length: 256, read_only: false };

/// Options of the levels under test.
pub const LEVELS: [CodegenOptions; 3] = [
    CodegenOptions { optimize: true, native: false, verify: true },
    CodegenOptions { optimize: false, native: false, verify: true },
    CodegenOptions { optimize: true, native: true, verify: true },
];

/// Builds a module of `functions` whose entries are all that take and return nothing.
pub fn module(functions: Vec<Function>) -> Module {
    let mut module = Module { dbs: vec![DB], ..Module::default() };
    for function in functions {
        let is_entry = function.params().next().is_none() && function.returns.is_empty();
        let id = module.functions.push(function);
        if is_entry {
            module.entries.push(id);
        }
    }
    module
}

/// A module of one entry that `build` fills; it ends with a return.
pub fn entry(build: impl FnOnce(&mut FunctionBuilder)) -> Module {
    let mut b = FunctionBuilder::new("OB1", &[], &[]);
    b.set_frame_bytes(64);
    build(&mut b);
    if b.is_reachable() {
        b.ret(&[]);
    }
    module(vec![b.finish()])
}

/// Memory in which every byte differs from its neighbours.
pub fn patterned_memory() -> Vec<u8> {
    let mut memory = vec![0; MEMORY_BYTES];
    for area in [layout::I, layout::Q, layout::M, layout::L, layout::DB_DATA] {
        for at in 0..0x800 {
            memory[area as usize + at] = (at * 37 + area as usize / 251) as u8;
        }
    }
    let table = layout::db_table_entry(DB.number) as usize;
    memory[table..table + 4].copy_from_slice(&DB.address.to_ne_bytes());
    memory[table + 4..table + 8].copy_from_slice(&DB.length.to_ne_bytes());
    memory
}

/// Runs entry `index` on `memory`.
pub fn run_on(module: &Module, index: u32, options: &CodegenOptions, memory: &mut [u8]) {
    let program = JitProgram::compile(module, &runtime, options).expect("the module compiles");
    assert!(memory.len() >= MEMORY_BYTES);
    // SAFETY: the memory covers every area that the tests touch.
    unsafe { program.entry(index)(memory.as_mut_ptr(), LBASE, VBASE) };
}

/// Runs entry 0 on patterned memory at all levels, which must agree; returns the memory after it.
pub fn run(module: &Module) -> Vec<u8> {
    let results = LEVELS.map(|options| {
        let mut memory = patterned_memory();
        run_on(module, 0, &options, &mut memory);
        memory
    });
    assert!(results[0] == results[1], "optimised code differs");
    assert!(results[0] == results[2], "native code differs");
    let [result, ..] = results;
    result
}

/// Runtime functions for tests: the integer ones record their arguments in the CPU state.
fn runtime(function: RuntimeFn) -> *const u8 {
    extern "C" fn safepoint(mem: *mut u8, _site: u32) -> u32 {
        // SAFETY: generated code passes its memory base.
        unsafe { mem.add(layout::state::SUBSTITUTE as usize).cast::<u32>().write(77) };
        5
    }
    extern "C" fn sync_error(mem: *mut u8, site: u32, code: u32, access: u32, info: u32) -> u32 {
        // SAFETY: as above.
        unsafe { mem.add(layout::state::SUBSTITUTE as usize).cast::<u32>().write(info) };
        site * 1000 + code * 100 + access
    }
    extern "C" fn sin(x: f32) -> f32 {
        x + 0.5
    }
    extern "C" fn peripheral_read(_mem: *mut u8, address: u32, bytes: u32) -> u64 {
        u64::from(address) | u64::from(bytes) << 32
    }
    extern "C" fn unexpected() {
        std::process::abort();
    }
    match function {
        RuntimeFn::Safepoint => safepoint as *const u8,
        RuntimeFn::SyncError => sync_error as *const u8,
        RuntimeFn::Sin => sin as *const u8,
        RuntimeFn::PeripheralRead => peripheral_read as *const u8,
        _ => unexpected as *const u8,
    }
}

pub fn read_state(memory: &[u8], offset: u32, bytes: usize) -> u64 {
    let mut value = [0; 8];
    value[..bytes].copy_from_slice(&memory[offset as usize..offset as usize + bytes]);
    u64::from_le_bytes(value)
}

/// Identifier of the `index`-th function given to [`module`].
pub fn func(index: usize) -> FuncId {
    plcc_ir::entities::Entity::new(index)
}
