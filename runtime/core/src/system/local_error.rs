//! Synchronous errors of a block that contains GET_ERROR or GET_ERR_ID: the block handles them itself. The first since its start, or
//! since the last of these instructions, is kept in its local data as an ErrorStruct.
//!
//! Source: LAD/FBD reference for S7-1200, GET_ERROR and GET_ERR_ID.

use plcc_abi::codes::{access_area, fault_info, local_error::BYTES, sync};
use plcc_abi::image::BlockKind;
use plcc_abi::layout::{area, state};

use super::Outcome;
use super::parameters::Call;
use crate::cpu::Cpu;
use crate::diagnostics;

/// Class of the identifiers of programming errors and access errors, the high byte.
const PROGRAMMING: u16 = 0x2500;
const ACCESS: u16 = 0x2900;

/// The reaction of a block to its error: REACTION.
const IGNORED: u8 = 0;
const SUBSTITUTED: u8 = 1;
const SKIPPED: u8 = 2;

/// MODE: which of the last fields are valid.
const MODE_NONE: u8 = 0;
const MODE_NUMBER: u8 = 3;
const MODE_AREA_OFFSET: u8 = 4;

/// Copies the first error to ERROR and forgets it. ENO 0: there was none.
pub(super) fn get_error(call: &Call) -> Outcome {
    let (error, id) = take(call);
    call.set_error(0, error);
    Outcome::Flag(id != 0)
}

/// The identifier of the first error, which is forgotten. ENO 0: there was none.
pub(super) fn get_err_id(call: &Call) -> Outcome {
    let (_, id) = take(call);
    call.set_word(0, id);
    Outcome::Flag(id != 0)
}

fn take(call: &Call) -> ([u8; BYTES as usize], u16) {
    let cpu = call.cpu;
    let Some(at) = cpu.error_slot(call.site, call.lbase) else { return ([0; BYTES as usize], 0) };
    let error: [u8; BYTES as usize] = cpu.memory.bytes(at);
    cpu.memory.clear(at, BYTES);
    (error, u16::from_be_bytes([error[0], error[1]]))
}

impl Cpu {
    /// Where the block of `site`, whose frame is at `lbase`, keeps its first error.
    fn error_slot(&self, site: u32, lbase: u32) -> Option<u32> {
        let site = diagnostics::site(&self.image, site)?;
        let wanted = (site.block, site.block_number);
        let slots = &self.image.error_slots;
        let index = slots.binary_search_by_key(&wanted, |slot| (slot.kind, slot.number)).ok()?;
        Some(lbase + slots[index].offset)
    }

    /// Synchronous error in a block that handles its own. Result for generated code.
    pub(crate) fn local_error(&self, site: u32, code: u8, access: u32, info: u32, lbase: u32) -> u32 {
        let Some(at) = self.error_slot(site, lbase) else { return self.sync_error(site, code, access, info) };
        self.memory.set_host32(state::SUBSTITUTE, 0);
        if self.memory.word(at) == 0 {
            self.memory.set_bytes(at, self.error_struct(site, code, access, info));
        }
        self.stop_result()
    }

    fn error_struct(&self, site: u32, code: u8, access: u32, info: u32) -> [u8; BYTES as usize] {
        let mut bytes = [0; BYTES as usize];
        let mut put = |at: usize, value: &[u8]| bytes[at..at + value.len()].copy_from_slice(value);
        let class = if matches!(code, sync::IO_READ | sync::IO_WRITE) { ACCESS } else { PROGRAMMING };
        put(0, &(class | u16::from(code)).to_be_bytes());
        put(3, &[reaction(code)]);
        if let Some(place) = diagnostics::site(&self.image, site) {
            let block_type = match place.block {
                BlockKind::Ob => 1,
                BlockKind::Fc | BlockKind::Sfc => 2,
                BlockKind::Fb | BlockKind::Sfb | BlockKind::Db | BlockKind::Sbr | BlockKind::Int => 3,
            };
            put(4, &[block_type]);
            put(6, &place.block_number.to_be_bytes());
        }
        put(8, &site.to_be_bytes());
        let mode = mode(code);
        put(12, &[mode]);
        if mode == MODE_AREA_OFFSET {
            put(20, &[area_code(access as u8 & 0x0F)]);
            // An index is not an address.
            let address = if access & (fault_info::INDEX | fault_info::INDICES) == 0 { info } else { 0 };
            put(24, &address.wrapping_mul(8).to_be_bytes());
        }
        if mode == MODE_NUMBER {
            put(22, &(info as u16).to_be_bytes());
        }
        bytes
    }
}

const fn reaction(code: u8) -> u8 {
    match code {
        sync::LENGTH_READ | sync::AREA_READ | sync::ALIGN_READ | sync::IO_READ => SUBSTITUTED,
        sync::LENGTH_WRITE | sync::AREA_WRITE | sync::ALIGN_WRITE | sync::IO_WRITE => IGNORED,
        _ => SKIPPED,
    }
}

const fn mode(code: u8) -> u8 {
    match code {
        sync::LENGTH_READ..=sync::AREA_WRITE
        | sync::ALIGN_READ
        | sync::ALIGN_WRITE
        | sync::IO_READ
        | sync::IO_WRITE => MODE_AREA_OFFSET,
        sync::WRITE_PROTECTED_DB..=sync::SFB_MISSING => MODE_NUMBER,
        _ => MODE_NONE,
    }
}

/// The area of an access byte as the code of an area pointer.
const fn area_code(access: u8) -> u8 {
    match access {
        access_area::I => area::I,
        access_area::Q => area::Q,
        access_area::M => area::M,
        access_area::DB => area::DB,
        access_area::DI => area::DI,
        access_area::L => area::L,
        access_area::V => area::V,
        _ => area::P,
    }
}
