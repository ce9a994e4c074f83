//! PLC memory: the one allocation that holds all areas, with big-endian access.
//!
//! Generated code reaches it through the raw base pointer, so nothing here ever makes a reference into it. An offset
//! outside the allocation ends in the scratch area: the runtime computes none, but a wrong image must not do harm.

use std::alloc::{Layout, alloc_zeroed, dealloc, handle_alloc_error};
use std::marker::PhantomData;
use std::ptr;
use std::sync::atomic::{AtomicPtr, AtomicU32, Ordering};

use plcc_abi::any::Fields;
use plcc_abi::layout::{self, state};

/// Alignment of the base. Not more than the allocator's own: only then zeroed pages come untouched from the system.
const BASE_ALIGN: usize = plcc_abi::layout::DB_ALIGN as usize;

/// The base of the memory that debuggers show; null if there is none. The symbol is that of
/// [`MEMORY_SYMBOL`](plcc_abi::linked::MEMORY_SYMBOL).
#[unsafe(export_name = "plcc_memory")]
static SHOWN: AtomicPtr<u8> = AtomicPtr::new(ptr::null_mut());

/// The allocation. Untouched pages take no memory.
pub struct Memory {
    base: *mut u8,
    size: u32,
}

impl Memory {
    /// Zeroed memory for DBs up to `db_end` and the pool after them.
    pub fn new(db_end: u32) -> Memory {
        let size = db_end.max(layout::DB_DATA).saturating_add(layout::DB_POOL_BYTES);
        let layout = Self::layout(size);
        // SAFETY: the layout's size is not 0.
        let base = unsafe { alloc_zeroed(layout) };
        if base.is_null() {
            handle_alloc_error(layout);
        }
        Memory { base, size }
    }

    fn layout(size: u32) -> Layout {
        Layout::from_size_align(size as usize, BASE_ALIGN).expect("a u32 size with a small alignment is a valid layout")
    }

    pub fn base(&self) -> *mut u8 {
        self.base
    }

    /// Debuggers show this memory until it is dropped.
    pub(crate) fn show(&self) {
        SHOWN.store(self.base, Ordering::Relaxed);
    }

    /// Size in bytes.
    pub fn size(&self) -> u32 {
        self.size
    }

    fn at(&self, offset: u32, bytes: u32) -> *mut u8 {
        let inside = offset.checked_add(bytes).is_some_and(|end| end <= self.size);
        let offset = if inside { offset } else { layout::SCRATCH };
        // SAFETY: the offset is inside the allocation; the scratch area always is.
        unsafe { self.base.add(offset as usize) }
    }

    /// Reads `N` bytes as they are in memory.
    pub fn bytes<const N: usize>(&self, offset: u32) -> [u8; N] {
        // SAFETY: `at` returns N readable bytes (the scratch area is larger than any N used).
        unsafe { self.at(offset, N as u32).cast::<[u8; N]>().read_unaligned() }
    }

    /// Writes `N` bytes as they are.
    pub fn set_bytes<const N: usize>(&self, offset: u32, bytes: [u8; N]) {
        // SAFETY: `at` returns N writable bytes; no reference into memory exists.
        unsafe { self.at(offset, N as u32).cast::<[u8; N]>().write_unaligned(bytes) }
    }

    /// The byte at `offset` from the memory base.
    pub fn byte(&self, offset: u32) -> u8 {
        self.bytes::<1>(offset)[0]
    }

    pub fn set_byte(&self, offset: u32, value: u8) {
        self.set_bytes(offset, [value]);
    }

    /// The big-endian word at `offset`.
    pub fn word(&self, offset: u32) -> u16 {
        u16::from_be_bytes(self.bytes(offset))
    }

    pub fn set_word(&self, offset: u32, value: u16) {
        self.set_bytes(offset, value.to_be_bytes());
    }

    /// The big-endian double word at `offset`.
    pub fn dword(&self, offset: u32) -> u32 {
        u32::from_be_bytes(self.bytes(offset))
    }

    pub fn set_dword(&self, offset: u32, value: u32) {
        self.set_bytes(offset, value.to_be_bytes());
    }

    /// The ANY at `offset`, in words as code writes it: a processor passes on only what was written as a whole.
    pub fn any(&self, offset: u32) -> Fields {
        let at = self.at(offset, 10);
        // SAFETY: `at` returns ten readable bytes.
        let (words, pointer) =
            unsafe { (at.cast::<[[u8; 2]; 3]>().read_unaligned(), at.add(6).cast::<[u8; 4]>().read_unaligned()) };
        let [first, count, db] = words.map(u16::from_be_bytes);
        Fields { head: u32::from(first) << 16 | u32::from(count), db, pointer: u32::from_be_bytes(pointer) }
    }

    /// Bit 0..8 of the byte at `offset`.
    pub fn bit(&self, offset: u32, bit: u8) -> bool {
        self.byte(offset) >> (bit & 7) & 1 != 0
    }

    pub fn set_bit(&self, offset: u32, bit: u8, value: bool) {
        let mask = 1 << (bit & 7);
        let byte = self.byte(offset);
        self.set_byte(offset, if value { byte | mask } else { byte & !mask });
    }

    /// A field of the CPU state that always exists, in host order.
    #[inline(always)]
    pub fn state32<const OFFSET: u32>(&self) -> u32 {
        const { assert!(OFFSET + 4 <= layout::I) }
        // SAFETY: the allocation has all areas below the DBs.
        unsafe { self.base.add(OFFSET as usize).cast::<u32>().read_unaligned() }
    }

    /// Writes `N` bytes of the CPU state, which always exists.
    #[inline(always)]
    pub fn set_state<const OFFSET: u32, const N: usize>(&self, bytes: [u8; N]) {
        const { assert!(OFFSET as usize + N <= layout::I as usize) }
        // SAFETY: the allocation has all areas below the DBs; no reference into memory exists.
        unsafe { self.base.add(OFFSET as usize).cast::<[u8; N]>().write_unaligned(bytes) }
    }

    /// A field of the CPU state or of a cell: host byte order.
    pub fn host32(&self, offset: u32) -> u32 {
        u32::from_ne_bytes(self.bytes(offset))
    }

    pub fn set_host32(&self, offset: u32, value: u32) {
        self.set_bytes(offset, value.to_ne_bytes());
    }

    /// A field of the CPU state, in host order.
    pub fn host64(&self, offset: u32) -> u64 {
        u64::from_ne_bytes(self.bytes(offset))
    }

    pub fn set_host64(&self, offset: u32, value: u64) {
        self.set_bytes(offset, value.to_ne_bytes());
    }

    /// Shows a range to `read`, which must not enter code or write PLC memory. Outside of memory: an empty range.
    pub fn view<R>(&self, offset: u32, bytes: u32, read: impl FnOnce(&[u8]) -> R) -> R {
        let bytes = if self.contains(offset, bytes) { bytes } else { 0 };
        // SAFETY: the range is inside the allocation and initialised; nothing writes it while `read` runs (the watchdog
        // writes only the CPU state, which is never requested).
        read(unsafe { std::slice::from_raw_parts(self.at(offset, bytes), bytes as usize) })
    }

    /// Copies `bytes` bytes inside memory, as if through a buffer. Nothing happens when a side is outside.
    pub fn copy(&self, from: u32, to: u32, bytes: u32) {
        if self.contains(from, bytes) && self.contains(to, bytes) {
            // SAFETY: both ranges are inside the allocation.
            unsafe { move_bytes(self.at(from, bytes), self.at(to, bytes), bytes as usize) }
        }
    }

    /// The same memory, for accesses that are known to be inside.
    #[inline(always)]
    pub fn bytes_at(&self) -> Bytes<'_> {
        Bytes { base: self.base, memory: PhantomData }
    }

    /// Copies `data` into memory at `offset`. Nothing happens when it does not fit.
    pub fn load(&self, offset: u32, data: &[u8]) {
        let bytes = u32::try_from(data.len()).unwrap_or(u32::MAX);
        if self.contains(offset, bytes) {
            // SAFETY: the target range is inside the allocation, `data` is not (no reference into memory exists).
            unsafe { std::ptr::copy_nonoverlapping(data.as_ptr(), self.at(offset, bytes), data.len()) }
        }
    }

    /// Fills `bytes` bytes with 0.
    pub fn clear(&self, offset: u32, bytes: u32) {
        if self.contains(offset, bytes) {
            // SAFETY: the range is inside the allocation.
            unsafe { std::ptr::write_bytes(self.at(offset, bytes), 0, bytes as usize) }
        }
    }

    /// True if `bytes` bytes at `offset` are inside memory.
    #[inline(always)]
    pub fn contains(&self, offset: u32, bytes: u32) -> bool {
        offset.checked_add(bytes).is_some_and(|end| end <= self.size)
    }

    /// The flag that makes the next safepoint call the runtime. The watchdog thread stores to it as well; generated code
    /// reads it with a plain load.
    pub fn attention(&self) -> &AtomicU32 {
        // SAFETY: aligned, inside the allocation, lives as long as `self`; the runtime accesses it atomically only.
        unsafe { AtomicU32::from_ptr(self.base.add(state::ATTENTION as usize).cast()) }
    }

    /// The next safepoint calls the runtime.
    pub fn raise_attention(&self) {
        self.attention().store(1, Ordering::Relaxed);
    }

    /// Entry of the DB table: offset and length in bytes; length 0: not loaded.
    pub fn db(&self, number: u16) -> (u32, u32) {
        let entry = layout::db_table_entry(number);
        (self.host32(entry), self.host32(entry + 4))
    }

    /// Enters DB `number` in the table; length 0: not loaded.
    pub fn set_db(&self, number: u16, address: u32, length: u32) {
        let entry = layout::db_table_entry(number);
        self.set_host32(entry, address);
        self.set_host32(entry + 4, length);
    }
}

/// Memory without checks: every access says why it is inside.
#[derive(Clone, Copy)]
pub struct Bytes<'a> {
    base: *mut u8,
    memory: PhantomData<&'a Memory>,
}

impl Bytes<'_> {
    /// What [`Bytes::copy_short`] copies at most.
    pub const SHORT_MAX: u32 = 64;

    /// The little-endian word at `offset`.
    ///
    /// # Safety
    /// The two bytes are inside memory, see [`Memory::contains`].
    #[inline(always)]
    pub unsafe fn word(self, offset: u32) -> u16 {
        // SAFETY: the caller's promise.
        u16::from_le_bytes(unsafe { self.base.add(offset as usize).cast::<[u8; 2]>().read_unaligned() })
    }

    /// Writes the byte at `offset`.
    ///
    /// # Safety
    /// It is inside memory, see [`Memory::contains`].
    #[inline(always)]
    pub unsafe fn set_byte(self, offset: u32, value: u8) {
        // SAFETY: the caller's promise.
        unsafe { *self.base.add(offset as usize) = value }
    }

    /// Writes the little-endian word at `offset`.
    ///
    /// # Safety
    /// The two bytes are inside memory, see [`Memory::contains`].
    #[inline(always)]
    pub unsafe fn set_word(self, offset: u32, value: u16) {
        // SAFETY: the caller's promise.
        unsafe { self.base.add(offset as usize).cast::<[u8; 2]>().write_unaligned(value.to_le_bytes()) }
    }

    /// As [`Memory::copy`], without a call.
    ///
    /// # Safety
    /// Both ranges are inside memory, see [`Memory::contains`]. There are at most [`Bytes::SHORT_MAX`] bytes.
    #[inline(always)]
    pub unsafe fn copy_short(self, from: u32, to: u32, bytes: u32) {
        // SAFETY: the caller's promise.
        unsafe { move_short(self.base.add(from as usize), self.base.add(to as usize), bytes as usize) }
    }

    /// As [`Memory::copy`].
    ///
    /// # Safety
    /// Both ranges are inside memory, see [`Memory::contains`].
    #[inline(always)]
    pub unsafe fn copy(self, from: u32, to: u32, bytes: u32) {
        // SAFETY: the caller's promise.
        unsafe { move_bytes(self.base.add(from as usize), self.base.add(to as usize), bytes as usize) }
    }

    /// As [`Memory::load`].
    ///
    /// # Safety
    /// The range is inside memory, see [`Memory::contains`].
    #[inline(always)]
    pub unsafe fn load(self, offset: u32, data: &[u8]) {
        // SAFETY: the caller's promise.
        unsafe { move_bytes(data.as_ptr(), self.base.add(offset as usize), data.len()) }
    }

    /// As [`Memory::view`].
    ///
    /// # Safety
    /// The range is inside memory, see [`Memory::contains`].
    #[inline(always)]
    pub unsafe fn view<R>(self, offset: u32, bytes: u32, read: impl FnOnce(&[u8]) -> R) -> R {
        // SAFETY: as for `view`, with the caller's promise.
        read(unsafe { std::slice::from_raw_parts(self.base.add(offset as usize), bytes as usize) })
    }
}

/// Copies `bytes` bytes, as if through a buffer. Most copies are of short texts.
///
/// # Safety
/// Both ranges can be read and written.
#[inline(always)]
unsafe fn move_bytes(from: *const u8, to: *mut u8, bytes: usize) {
    // SAFETY: the caller's promise; `copy` allows overlap.
    unsafe {
        if bytes <= Bytes::SHORT_MAX as usize {
            move_short(from, to, bytes);
        } else {
            std::ptr::copy(from, to, bytes);
        }
    }
}

/// Copies up to [`Bytes::SHORT_MAX`] bytes as two words, which may overlap, and are read before anything is written.
///
/// # Safety
/// Both ranges can be read and written, and are not longer.
#[inline(always)]
unsafe fn move_short(from: *const u8, to: *mut u8, bytes: usize) {
    /// Moves the first and the last `T` of the range.
    #[inline(always)]
    unsafe fn ends<T: Copy>(from: *const u8, to: *mut u8, bytes: usize) {
        let last = bytes - size_of::<T>();
        // SAFETY: the caller's promise, and a range that is not shorter than a `T`.
        unsafe {
            let first_part = from.cast::<T>().read_unaligned();
            let last_part = from.add(last).cast::<T>().read_unaligned();
            to.cast::<T>().write_unaligned(first_part);
            to.add(last).cast::<T>().write_unaligned(last_part);
        }
    }
    // SAFETY: the caller's promise.
    unsafe {
        if bytes > 16 {
            if bytes > 32 {
                ends::<[u128; 2]>(from, to, bytes);
            } else {
                ends::<u128>(from, to, bytes);
            }
        } else if bytes >= 4 {
            if bytes >= 8 {
                ends::<u64>(from, to, bytes);
            } else {
                ends::<u32>(from, to, bytes);
            }
        } else if bytes > 0 {
            let (middle, last) = (bytes / 2, bytes - 1);
            let (one, two, three) = (*from, *from.add(middle), *from.add(last));
            *to = one;
            *to.add(middle) = two;
            *to.add(last) = three;
        }
    }
}

impl Drop for Memory {
    fn drop(&mut self) {
        // Another one may be shown meanwhile.
        let _ = SHOWN.compare_exchange(self.base, ptr::null_mut(), Ordering::Relaxed, Ordering::Relaxed);
        // SAFETY: allocated in `new` with the same layout.
        unsafe { dealloc(self.base, Self::layout(self.size)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_are_as_if_through_a_buffer() {
        let memory = Memory::new(layout::DB_DATA);
        for bytes in 0..=70u32 {
            for (from, to) in [(100, 180), (100, 103), (103, 100), (100, 120), (100, 100)] {
                let start: Vec<u8> = (0..=255).collect();
                memory.load(layout::M, &start);
                memory.copy(layout::M + from, layout::M + to, bytes);
                let mut expected = start.clone();
                expected.copy_within(from as usize..(from + bytes) as usize, to as usize);
                memory.view(layout::M, 256, |found| assert_eq!(found, expected, "{bytes} bytes from {from} to {to}"));
            }
        }
    }
}
