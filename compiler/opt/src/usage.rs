//! What the program uses of the CPU, so that the runtime does in each cycle only what is needed.

use plcc_abi::functions::Effect;
use plcc_abi::s7200::Operation;
use plcc_ir::analysis::{ControlFlow, Dominators};
use plcc_ir::entities::Entity;
use plcc_ir::{Address, BinaryOp, Block, FuncId, Function, Inst, InstData, Module, Region, RuntimeFn, Value};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::frames::{is_base_only, pointers_stored};
use crate::note_outputs::{Writes, is_note, is_unknown, text_target, written};
use crate::ranges::base_ranges;
use crate::surroundings::Surroundings;

/// No byte of the outputs is sure to stay as it is.
const ALL: u32 = u32::MAX;

/// See the module comment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Usage {
    /// The output byte from which on no code of the program changes one. Only the bytes before it are copied to the modules after
    /// each cycle; an S7-1500 has 32 KB of them.
    pub outputs: u32,
    /// Code of an S7-200 touches neither interrupts nor high-speed counters, pulse outputs, ports or network. What it writes to special memory
    /// and analog outputs at an address that is not known, the runtime notes when it happens.
    pub logic_only: bool,
    /// The first byte of its local data that a function reads or lets others read; `u32::MAX` if there is none. An organization block
    /// needs the start information only if that is there.
    pub local_data: u32,
}

/// Looks at the code of each function of the module.
pub fn usage(module: &Module) -> Vec<Usage> {
    let surroundings = Surroundings::new(module);
    module.functions.values().map(|function| usage_of(function, &surroundings)).collect()
}

/// Which functions can run when the CPU starts those of `roots`. A call by number may start any.
///
/// Library blocks stay in the module when all their calls have become other code.
pub fn reached(module: &Module, roots: impl IntoIterator<Item = FuncId>) -> Vec<bool> {
    let mut reached = vec![false; module.functions.len()];
    let mut work: Vec<FuncId> = roots.into_iter().collect();
    while let Some(id) = work.pop() {
        if std::mem::replace(&mut reached[id.index()], true) {
            continue;
        }
        let function = &module.functions[id];
        for &inst in function.layout.iter().flat_map(|&block| &function.blocks[block].insts) {
            match &function.insts[inst] {
                InstData::Call { callee, .. } => work.push(*callee),
                InstData::CallRuntime { function: RuntimeFn::CallBlock, .. } => return vec![true; reached.len()],
                _ => {}
            }
        }
    }
    reached
}

/// Looks at the code of a function.
pub fn usage_of(function: &Function, surroundings: &Surroundings) -> Usage {
    let mut usage = Usage { local_data: local_data_read(function, surroundings), ..Usage::NOTHING };
    let has_note = |block: Block| function.blocks[block].insts.iter().any(|&inst| is_note(&function.insts[inst]));
    let is_write = |inst: &Inst| written(function, &function.insts[*inst]).is_some();
    let writes = function.layout.iter().any(|&block| function.blocks[block].insts.iter().any(is_write)).then(|| {
        let cfg = ControlFlow::new(function);
        let writes = Writes::of(function, &cfg);
        let later = writes.noted_later(function, &cfg, &has_note);
        (writes, later)
    });
    let is_noted = |block: Block| {
        let (writes, later) = writes.as_ref()?;
        Some(has_note(block) || later.contains(&block) || !writes.may_be_in(block))
    };
    for &block in &function.layout {
        let insts = || function.blocks[block].insts.iter().map(|&inst| &function.insts[inst]);
        let is_noted = is_noted(block).unwrap_or(true);
        for data in insts() {
            // What is written through a pointer is noted when it happens.
            if !(is_noted && written(function, data).is_some()) {
                usage.add(function, data);
            }
        }
    }
    usage
}

impl Usage {
    /// What a program without code uses.
    pub const NOTHING: Usage = Usage { outputs: 0, logic_only: true, local_data: u32::MAX };

    /// What two parts of a program use.
    pub fn and(self, other: Usage) -> Usage {
        Usage {
            outputs: self.outputs.max(other.outputs),
            logic_only: self.logic_only && other.logic_only,
            local_data: self.local_data.min(other.local_data),
        }
    }

    fn add(&mut self, function: &Function, inst: &InstData) {
        let outputs = match inst {
            InstData::Store { addr, value } => end_of(addr, function.ty(*value).bytes()),
            InstData::StoreBit { addr, .. } => end_of(addr, 1),
            InstData::Clear { addr, len } | InstData::Copy { to: addr, len, .. } => end_of(addr, *len),
            // Whoever has the address may write there.
            InstData::AddressOf { addr } if addr.region == Region::Q => ALL,
            InstData::CallRuntime { function: called, args } => match called {
                RuntimeFn::S7200Operation => {
                    let number = args.get(1).and_then(|&number| function.constant(number));
                    let operation = number.and_then(|number| Operation::of_number(number as u32));
                    self.logic_only &= operation.is_some_and(|operation| !operation.concerns_hardware());
                    ALL
                }
                // The runtime looks where it points to.
                RuntimeFn::S7200Pointer => ALL,
                RuntimeFn::S7200Counter | RuntimeFn::S7200SpecialWritten => {
                    self.logic_only = false;
                    ALL
                }
                // The blocks that they run are code of the program.
                RuntimeFn::Safepoint | RuntimeFn::SyncError | RuntimeFn::LocalError | RuntimeFn::Stop => 0,
                RuntimeFn::CallBlock | RuntimeFn::AssertMemory | RuntimeFn::Sleep => 0,
                RuntimeFn::ProbeEnter
                | RuntimeFn::ProbeLeave
                | RuntimeFn::ProbeStatement
                | RuntimeFn::ProbeRegisters
                | RuntimeFn::ProbeValue => 0,
                // The runtime itself notes which outputs they write.
                RuntimeFn::SystemFunction => 0,
                _ if written(function, inst).is_some() => ALL,
                _ if text_target(*called, args).is_some() => 0,
                // What they get may point to outputs.
                _ if called.effect() == Effect::All => ALL,
                _ => 0,
            },
            _ => 0,
        };
        self.outputs = self.outputs.max(outputs);
    }
}

/// The first byte of the local data of the function that anybody may read.
fn local_data_read(function: &Function, surroundings: &Surroundings) -> u32 {
    let first = direct_reads(function, surroundings);
    // Only the start information matters, which is at the beginning.
    let first = if first == 0 { 0 } else { first.min(indexed_reads(function)) };
    if first == 0 { 0 } else { first.min(reads_of_others(function, surroundings)) }
}

/// The addresses of which an instruction reads what is there, by their places among its addresses.
fn addresses_read(data: &InstData) -> [Option<&Address>; 2] {
    match data {
        // To write a bit is to read the others.
        InstData::Load { addr } | InstData::LoadBit { addr, .. } | InstData::StoreBit { addr, .. } => {
            [Some(addr), None]
        }
        InstData::AddressOf { addr } if addr.base.is_some() => [Some(addr), None],
        InstData::Copy { from, .. } => [None, Some(from)],
        _ => [None, None],
    }
}

/// What the function reads at constant addresses.
fn direct_reads(function: &Function, surroundings: &Surroundings) -> u32 {
    let is_direct = |addr: &&Address| addr.region == Region::L && addr.base.is_none();
    let (mut first, mut pointers) = (NONE, None);
    for &inst in function.layout.iter().flat_map(|&block| &function.blocks[block].insts) {
        first = first.min(match &function.insts[inst] {
            InstData::FrameBase { .. } => 0,
            InstData::Call { callee, args } => {
                let mut by_pointer = |place: u32| {
                    let pointers = pointers.get_or_insert_with(|| pointers_stored(function));
                    // Without a store something else makes the pointer.
                    pointers.get(&place).copied().unwrap_or(0)
                };
                surroundings.caller_reads(*callee).first_of_call(function, args, &mut by_pointer)
            }
            data => {
                let direct = addresses_read(data).into_iter().flatten().filter(is_direct);
                direct.map(|addr| addr.offset).min().unwrap_or(NONE)
            }
        });
    }
    first
}

/// What the function reads at computed addresses.
fn indexed_reads(function: &Function) -> u32 {
    let is_indexed = |addr: &Address| addr.region == Region::L && addr.base.is_some();
    let mut insts = function.layout.iter().flat_map(|&block| &function.blocks[block].insts);
    let mut indexed = |inst: &Inst| addresses_read(&function.insts[*inst]).into_iter().flatten().any(is_indexed);
    if !insts.any(&mut indexed) {
        return NONE;
    }
    let cfg = ControlFlow::new(function);
    let ranges = base_ranges(function, &cfg, &Dominators::new(function, &cfg));
    let mut first = NONE;
    for &inst in function.layout.iter().flat_map(|&block| &function.blocks[block].insts) {
        for (index, addr) in addresses_read(&function.insts[inst]).into_iter().enumerate() {
            let Some(addr) = addr.filter(|addr| is_indexed(addr)) else { continue };
            // Whoever has an address may look before it.
            let is_address = matches!(function.insts[inst], InstData::AddressOf { .. });
            let range = ranges.get(&inst).and_then(|ranges| ranges[index]).filter(|_| !is_address);
            // Beyond the frame an access would wrap around.
            first = first.min(match range {
                Some((least, most)) if most < FRAME_MAX => addr.offset + least as u32,
                _ => 0,
            });
        }
    }
    first
}

/// What others read to which the function gives addresses of its local data.
fn reads_of_others(function: &Function, surroundings: &Surroundings) -> u32 {
    let insts = || function.layout.iter().flat_map(|&block| &function.blocks[block].insts);
    // Addresses, with the bytes that they are of.
    let mut given: FxHashMap<Value, u32> = FxHashMap::default();
    for &inst in insts() {
        if let InstData::AddressOf { addr: Address { region: Region::L, base: None, offset } } = &function.insts[inst] {
            given.insert(function.result(inst), *offset);
        }
    }
    // Blocks pass addresses on to their parameters.
    for _ in 0..ROUNDS_MAX {
        if given.is_empty() {
            return NONE;
        }
        let mut passed: FxHashMap<Value, u32> = FxHashMap::default();
        for &inst in insts() {
            function.insts[inst].for_each_target(|target| {
                for (&arg, &param) in target.args.iter().zip(&function.blocks[target.block].params) {
                    if let Some(&offset) = given.get(&function.resolve(arg))
                        && given.get(&param).is_none_or(|&known| known > offset)
                    {
                        let known = passed.entry(param).or_insert(offset);
                        *known = offset.min(*known);
                    }
                }
            });
        }
        if passed.is_empty() {
            return reads_of_given(function, surroundings, &given);
        }
        given.extend(passed);
    }
    0
}

/// As [`reads_of_others`], of the addresses that are `given`.
fn reads_of_given(function: &Function, surroundings: &Surroundings, given: &FxHashMap<Value, u32>) -> u32 {
    let (mut first, mut sums) = (NONE, FxHashSet::default());
    for &inst in function.layout.iter().flat_map(|&block| &function.blocks[block].insts) {
        let data = &function.insts[inst];
        let mut index = 0;
        data.for_each_use(|value| {
            if let Some(&offset) = given.get(&function.resolve(value)) {
                let is_upward = match data {
                    InstData::CallRuntime { function, args } => reads_upward(*function, args),
                    InstData::Call { callee, .. } => surroundings.caller_reads(*callee).is_upward(index),
                    // The parameters that get it are among the given addresses.
                    InstData::Jump { .. } | InstData::Branch { .. } | InstData::Switch { .. } => true,
                    InstData::IntCompare { .. } => true,
                    // Whether it is one of an output.
                    InstData::Binary { op: BinaryOp::Iadd, args }
                        if args.iter().any(|&arg| function.constant(arg).is_some()) =>
                    {
                        sums.insert(function.result(inst));
                        true
                    }
                    data => is_base_only(function, data, value),
                };
                first = first.min(if is_upward { offset } else { 0 });
            }
            index += 1;
        });
    }
    if sums.is_empty() || are_only_compared(function, &sums) { first } else { 0 }
}

/// True if nothing but comparisons use values.
fn are_only_compared(function: &Function, values: &FxHashSet<Value>) -> bool {
    let mut insts = function.layout.iter().flat_map(|&block| &function.blocks[block].insts);
    insts.all(|&inst| {
        let data = &function.insts[inst];
        let mut is_used = false;
        data.for_each_use(|used| is_used |= values.contains(&function.resolve(used)));
        !is_used || matches!(data, InstData::IntCompare { .. })
    })
}

/// Rounds in which addresses are followed to parameters of blocks.
const ROUNDS_MAX: usize = 8;
/// No byte is read.
const NONE: u32 = u32::MAX;
/// No frame has as many bytes.
const FRAME_MAX: u64 = 1 << 24;

/// True of functions of texts: they read nothing before an address that they get.
pub fn reads_upward(called: RuntimeFn, args: &[Value]) -> bool {
    let only_reads = matches!(
        called,
        RuntimeFn::TextCompare
            | RuntimeFn::TextFind
            | RuntimeFn::TextLength
            | RuntimeFn::TextToDint
            | RuntimeFn::TextToReal
            | RuntimeFn::TextScanReal
            | RuntimeFn::TextScan
    );
    only_reads || text_target(called, args).is_some()
}

/// The first output byte after those that a write to `addr` touches.
fn end_of(addr: &Address, bytes: u32) -> u32 {
    match (addr.region, addr.base) {
        (Region::Q, None) => addr.offset.saturating_add(bytes),
        _ if is_unknown(addr) => ALL,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use plcc_abi::layout;

    use super::*;

    fn of(code: &str) -> Usage {
        let text = format!("func @F {{\nb0:\n v0 = const.i32 1\n{code} ret\n}}\n");
        usage(&plcc_ir::parse::parse_module(&text).expect("text is well formed"))[0]
    }

    #[test]
    fn local_data_are_read_by_loads_and_whoever_has_their_address() {
        let reads = |code: &str| {
            let text = format!(
                "entry @F\nfunc @F frame 24 {{\nb0:\n v0 = const.i32 1\n{code} ret\n}}\nfunc @G {{\nb0:\nret\n}}\nfunc @H {{\nb0:\n v0 = \
                 load.i8 V 0\n ret\n}}\nfunc @P by_pointers {{\nb0:\n v0 = load.i32 V 20\n v1 = address V 0\n v2 = iadd v1, v0\n v3 = load.i8 any[v2]+0\n store.i8 M 0, v3\n \
                 ret\n}}\n"
            );
            usage(&plcc_ir::parse::parse_module(&text).expect("text is well formed"))[0].local_data
        };
        assert_eq!([reads(""), reads(" store.i32 L 20, v0\n"), reads(" call @G()\n")], [u32::MAX; 3]);
        assert_eq!([reads(" v1 = load.i8 L 6\n"), reads(" v1 = load.i8 L[v0]+6\n")], [6, 7]);
        // An index of which nothing is known, one that is at least 0, and an address with one.
        let index = |code: &str| reads(&format!(" v1 = load.i32 M 0\n v2 = and v1, v0\n{code}"));
        assert_eq!([index(" v3 = load.i8 L[v1]+20\n"), index(" v3 = load.i8 L[v2]+20\n")], [0, 20]);
        assert_eq!(index(" v3 = address L[v2]+20\n store.i32 M 0, v3\n"), 0);
        assert_eq!([reads(" copy M 0, L 20, 2\n"), reads(" v1 = address L 20\n store.i32 M 0, v1\n")], [20, 0]);
        assert_eq!(reads(" call @H()\n"), 0);
        // By a pointer that is stored for it: to DB 1, to byte 10 of the caller's frame, and one that nobody knows.
        let pointed = |pointer: &str| reads(&format!(" {pointer}\n store.i32 L 20, v1\n call @P()\n"));
        let constants = [0x8400_0000u32, 0x8700_0050].map(|pointer| pointed(&format!("v1 = const.i32 {pointer}")));
        assert_eq!((constants, pointed("v1 = load.i32 M 0")), ([20, 10], 0));
        let text = |address: &str| {
            reads(&format!(
                " v1 = const.i64 0\n v2 = address L 20\n v3 = {address}\n v4 = rt @text_find(v1, v2, v3, v0)\n"
            ))
        };
        assert_eq!([text("address L 22"), text("address L 18"), text("iadd v2, v0")], [20, 18, 0]);
    }

    #[test]
    fn outputs_end_after_the_last_byte_written() {
        assert_eq!(of("").outputs, 0);
        assert_eq!(of(" store.i32 M 9, v0\n store.i32 Q 4, v0\n").outputs, 8);
        assert_eq!(of(" store.i32 Q[v0]+4, v0\n").outputs, ALL);
        assert_eq!(of(" v1 = address Q 0\n").outputs, ALL);
    }

    #[test]
    fn what_is_noted_when_it_happens_is_not_copied_in_each_cycle() {
        let note = format!(" store.i32 state {}, v0\n", layout::state::OUTPUTS_WRITTEN);
        assert_eq!(of(&format!(" store.i32 any[v0]+0, v0\n{note} store.i32 Q 4, v0\n")).outputs, 8);
        assert_eq!(of(&format!(" copy Q[v0]+0, M 0, 9\n{note}")).outputs, 0);
        assert_eq!(of(&format!(" copy Q 0, M 0, 9\n{note}")).outputs, 9);
        let elsewhere = format!(" v1 = load.i32 M 0\n store.i32 any[v1]+0, v0\n jump b1\nb1:\n{note}");
        assert_eq!(of(&elsewhere).outputs, ALL);
        let later =
            format!(" v1 = load.i32 M 0\n store.i32 any[v1]+8, v0\n jump b1\nb1:\n store.i32 any[v1]+0, v0\n{note}");
        assert_eq!(of(&later).outputs, 0);
        // The address 1 is not one of an output.
        assert_eq!(of(" store.i32 any[v0]+0, v0\n").outputs, 0);
    }

    #[test]
    fn a_scan_looks_at_hardware_if_an_instruction_concerns_it() {
        let operation = |operation: Operation| {
            let number = operation as u8;
            of(&format!(" v1 = const.i32 {number}\n v2 = rt @s7200_operation(v0, v1, v0, v0, v0, v0)\n")).logic_only
        };
        assert!(operation(Operation::StringLength) && operation(Operation::ShiftRegister));
        assert!(operation(Operation::RestartWatchdog));
        assert!(!operation(Operation::AttachInterrupt) && !operation(Operation::ControlPulses));
        assert!(!operation(Operation::StopMode));
        assert!(of(" v1 = rt @s7200_pointer(v0, v0, v0)\n").logic_only);
        assert!(!of(" v1 = rt @s7200_operation(v0, v0, v0, v0, v0, v0)\n v2 = rt @s7200_counter(v0)\n").logic_only);
    }

    #[test]
    fn system_functions_note_outputs_themselves() {
        assert_eq!(of(" v1 = rt @system_function(v0, v0, v0, v0)\n").outputs, 0);
        assert_eq!(of(" v1 = address M 4\n v2 = rt @copy_text(v1, v1, v0, v0)\n").outputs, 0);
        assert_eq!(of(" v1 = load.i32 M 4\n v2 = rt @copy_text(v1, v1, v0, v0)\n").outputs, ALL);
    }

    #[test]
    fn a_text_may_be_written_to_outputs() {
        let concat =
            |to: &str| of(&format!(" v1 = const.i64 0\n {to}\n v3 = rt @text_concat(v1, v0, v0, v2)\n")).outputs;
        assert_eq!(concat("v2 = address M 4"), 0);
        assert_eq!(concat(&format!("v2 = const.i32 {}", layout::M)), 0);
        assert_eq!(concat(&format!("v2 = const.i32 {}", layout::Q + 8)), ALL);
        assert_eq!(concat("v2 = load.i32 M 0"), ALL);
    }

    #[test]
    fn what_only_unreached_functions_do_can_be_left_out() {
        let module = |call: &str| {
            let text = format!(
                "func @A {{\nb0:\n v0 = const.i32 1\n{call} ret\n}}\nfunc @B {{\nb0:\n call @C()\n ret\n}}\nfunc @C {{\nb0:\n ret\n}}\n"
            );
            plcc_ir::parse::parse_module(&text).expect("text is well formed")
        };
        let of = |call: &str| reached(&module(call), [FuncId::new(0)]);
        assert_eq!(of(""), [true, false, false]);
        assert_eq!(of(" call @B()\n"), [true, true, true]);
        assert_eq!(of(" v1 = rt @call_block(v0, v0, v0, v0, v0)\n"), [true, true, true]);
    }
}
