//! Layout of PLC memory.
//!
//! All areas of a CPU are in one allocation. Generated code reaches each of them as `base + offset`; the offsets
//! below are bytes from that base and hold for every profile, so a profile changes only limits, never addresses.
//! Areas do not begin at the same offset of a memory page: processors take a load for dependent on an earlier store
//! whose address ends in the same 12 bits, and programs use low addresses of every area.
//! PLC areas are big-endian, as on the CPU; the CPU state is in host byte order.

/// CPU state: the fields of [`state`], host byte order.
pub const STATE: u32 = 0;
/// Process image of inputs.
pub const I: u32 = 0x0001_0400;
/// Process image of outputs.
pub const Q: u32 = 0x0002_0800;
/// Bit memory.
pub const M: u32 = 0x0003_0C00;
/// Timer cells, [`TIMER_CELL_BYTES`] each, see [`timer_cell`].
pub const T: u32 = 0x0004_1000;
/// Counter cells, [`COUNTER_CELL_BYTES`] each, see [`counter_cell`].
pub const C: u32 = 0x0005_2000;
/// System area of an S7-200: the parts of [`s7200::system`](crate::s7200::system).
pub const SYSTEM: u32 = 0x0006_2400;
/// Local data: one stack of [`L_CLASS_BYTES`] for each priority class.
pub const L: u32 = 0x0010_0000;
/// DB table: for each number 0..=65535 the offset of its data and its length, two host-order `u32`. Length 0: not loaded.
pub const DB_TABLE: u32 = 0x0030_0000;
/// Bytes that reads of a faulty address see and writes to one end in.
pub const SCRATCH: u32 = 0x0038_0000;
/// Data of the DBs, then the pool for DBs made at run time.
pub const DB_DATA: u32 = 0x0040_0000;

/// Room of each of the areas I, Q, M.
pub const AREA_BYTES: u32 = 0x0001_0000;
/// Largest number of timers and of counters.
pub const TIMERS_MAX: u32 = 2048;
pub const TIMER_CELL_BYTES: u32 = 32;
pub const COUNTER_CELL_BYTES: u32 = 8;
/// From the first timer cell to the end of the last counter cell.
pub const CELLS_BYTES: u32 = C + TIMERS_MAX * COUNTER_CELL_BYTES - T;
/// Priority classes 0..32 have a local data stack each; 29 (OB 90) is 0.
pub const L_CLASSES: u32 = 32;
pub const L_CLASS_BYTES: u32 = 0x0001_0000;
/// Frames on the L stack begin at multiples of this.
pub const FRAME_ALIGN: u32 = 8;
pub const DB_TABLE_ENTRY_BYTES: u32 = 8;
/// DBs begin at multiples of this.
pub const DB_ALIGN: u32 = 16;
/// Size of the pool for DBs made at run time (SFC 22).
pub const DB_POOL_BYTES: u32 = 4 << 20;
/// All of memory is before this offset, so that sums of the base of a DB and an offset do not wrap.
pub const END_MAX: u32 = 1 << 28;
/// The data of all DBs of a program together, in bytes. No CPU has as much work memory.
pub const DB_DATA_BYTES_MAX: u32 = 128 << 20;
const _: () = assert!(DB_DATA + DB_DATA_BYTES_MAX + 0x1_0000 + DB_POOL_BYTES <= END_MAX);

/// Offsets of the CPU state, from the memory base. Fields are `u32` unless said otherwise.
pub mod state {
    /// Not 0: the next safepoint must call [`RuntimeFn::Safepoint`](crate::RuntimeFn::Safepoint).
    pub const ATTENTION: u32 = 0x00;
    /// The value of a read that faulted (SFC 44 sets it); 0 otherwise.
    pub const SUBSTITUTE: u32 = 0x04;
    /// `u64`: the runtime's own pointer to its `Cpu`.
    pub const CPU: u32 = 0x08;
    /// Block nesting depth of the running priority class.
    pub const DEPTH: u32 = 0x10;
    /// Largest allowed depth of the running priority class.
    pub const DEPTH_MAX: u32 = 0x14;
    /// End of the running priority class' L stack, as offset from the memory base.
    pub const L_END: u32 = 0x18;
    /// Site of the call by number that is being made, for errors before its block begins.
    pub const SITE: u32 = 0x1C;
    /// Result of the last call of the runtime that kept all registers.
    pub const KEPT_RESULT: u32 = 0x2C;
    /// Not 0: code has written through a pointer, to outputs perhaps. All of them are copied to the modules after this cycle.
    pub const OUTPUTS_WRITTEN: u32 = 0x30;
    /// `u64`: a clock that counts down, `u64::MAX` minus the nanoseconds of the virtual clock. [`ASK`] under the real clock.
    pub const COUNTDOWN: u32 = 0x20;
    /// Milliseconds of the virtual clock, 31 bits of them. Bit 31 under the real clock: ask the runtime.
    pub const TICKS: u32 = 0x28;
    /// [`COUNTDOWN`] under the real clock: less than the end of any running timer, so that code that looks at one
    /// asks the runtime.
    pub const ASK: u64 = 1;
    /// CPU registers at the border between generated code and the runtime, one `u32` each, in the order of
    /// [`CpuRegister`](super::CpuRegister).
    pub const REGISTERS: u32 = 0x40;
    /// What the probe before a statement shows and may change, one `u32` each: ACCU1-4, AR1, AR2, the status word, the open DB in the low
    /// and DI in the high half; of an S7-200 the logic stack with S0 in bit 0 and ENO in bit 9.
    pub const PROBED: u32 = 0x80;
    /// Further return values of block functions that do not fit machine registers, one `u64` each.
    pub const RETURN_VALUES: u32 = 0x100;
}

/// Fields of the cell of an S5 timer, host byte order. All 0: at rest, its time 0.
pub mod timer_cell {
    /// `u64`: the [`COUNTDOWN`](super::state::COUNTDOWN) at which the time is over; 0 while the timer does not run.
    pub const END: u32 = 0;
    /// `u64`: the countdown at which the value in [`INFO`] is one less; 0 while the timer does not run.
    pub const STEP: u32 = 8;
    /// `u32`: bits 0-15 the remaining time in units of the base, bits 16-17 the base, bit 24 the status, bit 25 the status when the
    /// time is over.
    pub const INFO: u32 = 16;
    /// `u8`, 0 or 1: RLO of the last start instruction.
    pub const START_EDGE: u32 = 20;
    /// `u8`, 0 or 1: RLO of the last FR.
    pub const ENABLE_EDGE: u32 = 21;

    pub const BASE_SHIFT: u32 = 16;
    pub const STATUS: u32 = 1 << 24;
    pub const STATUS_AFTER: u32 = 1 << 25;
}

/// Fields of the cell of a counter, host byte order.
pub mod counter_cell {
    /// `u16`: 0..=999.
    pub const COUNT: u32 = 0;
    /// `u8`, 0 or 1 each: RLO of the last CU, CD, S and FR.
    pub const UP_EDGE: u32 = 2;
    pub const DOWN_EDGE: u32 = 3;
    pub const SET_EDGE: u32 = 4;
    pub const ENABLE_EDGE: u32 = 5;
}

/// The CPU registers that a block call passes and returns, in the order of their slots in
/// [`state::REGISTERS`]. /FC, OR, STA, OS have fixed values at block borders and are not among them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub enum CpuRegister {
    Accu1,
    Accu2,
    Accu3,
    Accu4,
    Ar1,
    Ar2,
    /// Number in the DB register, 0: none open.
    Db,
    /// Number in the DI register, 0: none open.
    Di,
    Br,
    Cc1,
    Cc0,
    Ov,
    Rlo,
}

impl CpuRegister {
    pub const ALL: [CpuRegister; 13] = [
        CpuRegister::Accu1,
        CpuRegister::Accu2,
        CpuRegister::Accu3,
        CpuRegister::Accu4,
        CpuRegister::Ar1,
        CpuRegister::Ar2,
        CpuRegister::Db,
        CpuRegister::Di,
        CpuRegister::Br,
        CpuRegister::Cc1,
        CpuRegister::Cc0,
        CpuRegister::Ov,
        CpuRegister::Rlo,
    ];

    /// Offset of the register's slot from the memory base.
    pub const fn slot(self) -> u32 {
        state::REGISTERS + 4 * self as u32
    }

    /// True for the status bits, which are one bit wide.
    pub const fn is_bit(self) -> bool {
        self as u8 >= CpuRegister::Br as u8
    }
}

/// Offset of the DB table entry of DB `number`.
pub const fn db_table_entry(number: u16) -> u32 {
    DB_TABLE + DB_TABLE_ENTRY_BYTES * number as u32
}

/// Offset of the L stack of priority class `class`, 0..[`L_CLASSES`].
pub const fn l_stack(class: u32) -> u32 {
    L + L_CLASS_BYTES * class
}

/// `size` bytes of a frame rounded up to [`FRAME_ALIGN`].
pub const fn frame_bytes(size: u32) -> u32 {
    (size + FRAME_ALIGN - 1) & !(FRAME_ALIGN - 1)
}

/// Area codes of pointers (bits 24-31). Source: STL reference, area pointer.
pub mod area {
    pub const P: u8 = 0x80;
    pub const I: u8 = 0x81;
    pub const Q: u8 = 0x82;
    pub const M: u8 = 0x83;
    pub const DB: u8 = 0x84;
    pub const DI: u8 = 0x85;
    pub const L: u8 = 0x86;
    pub const V: u8 = 0x87;
}
