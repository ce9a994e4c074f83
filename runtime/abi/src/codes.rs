//! Error numbers of S7 CPUs that generated code and the runtime share.

/// Synchronous errors: the `SW_FLT` byte of OB 121 (and OB 122 for 16#42, 16#43). Source: STL reference, OB 121.
pub mod sync {
    pub const BCD: u8 = 0x21;
    pub const LENGTH_READ: u8 = 0x22;
    pub const LENGTH_WRITE: u8 = 0x23;
    pub const AREA_READ: u8 = 0x24;
    pub const AREA_WRITE: u8 = 0x25;
    pub const TIMER_NUMBER: u8 = 0x26;
    pub const COUNTER_NUMBER: u8 = 0x27;
    pub const ALIGN_READ: u8 = 0x28;
    pub const ALIGN_WRITE: u8 = 0x29;
    pub const WRITE_PROTECTED_DB: u8 = 0x30;
    pub const WRITE_PROTECTED_DI: u8 = 0x31;
    pub const DB_NUMBER: u8 = 0x32;
    pub const DI_NUMBER: u8 = 0x33;
    pub const FC_NUMBER: u8 = 0x34;
    pub const FB_NUMBER: u8 = 0x35;
    pub const DB_MISSING: u8 = 0x3A;
    pub const FC_MISSING: u8 = 0x3C;
    pub const SFC_MISSING: u8 = 0x3D;
    pub const FB_MISSING: u8 = 0x3E;
    pub const SFB_MISSING: u8 = 0x3F;
    /// Raises OB 122.
    pub const IO_READ: u8 = 0x42;
    /// Raises OB 122.
    pub const IO_WRITE: u8 = 0x43;
}

/// Instructions with which a block handles its own synchronous errors, and their results.
/// Source: LAD/FBD reference for S7-1200, GET_ERROR and GET_ERR_ID.
pub mod local_error {
    /// Number of the system function GET_ERROR.
    pub const GET_ERROR: u16 = 1400;
    /// Number of the system function GET_ERR_ID.
    pub const GET_ERR_ID: u16 = 1401;
    /// Size of an ErrorStruct.
    pub const BYTES: u32 = 28;
}

/// Width of a faulty access, bits 7-4 of the access byte of OB 121.
pub mod access {
    pub const BIT: u8 = 0x00;
    pub const BYTE: u8 = 0x10;
    pub const WORD: u8 = 0x20;
    pub const DWORD: u8 = 0x30;
}

/// Memory area of a faulty access, bits 3-0 of the access byte of OB 121.
pub mod access_area {
    pub const P: u8 = 0;
    pub const I: u8 = 1;
    pub const Q: u8 = 2;
    pub const M: u8 = 3;
    pub const DB: u8 = 4;
    pub const DI: u8 = 5;
    pub const L: u8 = 6;
    pub const V: u8 = 7;
}

/// What the information of a length error is: bits 8 and 9, above the access byte.
pub mod fault_info {
    /// The byte address.
    pub const ADDRESS: u32 = 0;
    /// The index that is outside of its array, an i32.
    pub const INDEX: u32 = 0x100;
    /// Nothing: one of several indices is outside of its array.
    pub const INDICES: u32 = 0x200;
}

/// Events that stop the CPU without an error OB. Source: event list of the CPUs, class 4.
pub mod stop {
    pub const NESTING_STACK: u16 = 0x4571;
    pub const MCR_STACK: u16 = 0x4572;
    pub const SYNC_DEPTH: u16 = 0x4573;
    pub const BLOCK_DEPTH: u16 = 0x4575;
    pub const LOCAL_DATA: u16 = 0x4576;
    pub const SFC_46: u16 = 0x457F;
}
