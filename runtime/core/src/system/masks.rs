//! Masking synchronous errors: SFC 36 MSK_FLT, SFC 37 DMSK_FLT, SFC 38 READ_ERR.
//!
//! Source: System and standard functions, SFC 36 to 38.
//!
//! Masks hold in the running priority class until its OB ends. All three take a mask of programming errors and one of
//! access errors, and return two results.

use plcc_abi::image::Family;

use super::Outcome;
use super::parameters::Call;
use crate::faults::MASKABLE;

/// Not all of the given bits were as they should be.
const PARTLY: Outcome = Outcome::RetVal(1);

fn given(call: &Call) -> [u32; 2] {
    [call.dword(0) & MASKABLE[0], call.dword(1) & MASKABLE[1]]
}

/// The masks after SFC 36 and 37: bits without an error read 1 on an S7-300, 0 on an S7-400.
fn give_masked(call: &Call) {
    let masked = call.cpu.running.masks.get().masked;
    let filler = |kind: usize| if call.cpu.image.profile.family == Family::S7400 { 0 } else { !MASKABLE[kind] };
    call.set_dword(3, masked[0] | filler(0));
    call.set_dword(4, masked[1] | filler(1));
}

fn outcome(partly: bool) -> Outcome {
    if partly { PARTLY } else { super::OK }
}

/// 0001: one of them was masked already.
pub(super) fn msk_flt(call: &Call) -> Outcome {
    let (given, mut masks) = (given(call), call.cpu.running.masks.get());
    let already = (0..2).any(|kind| masks.masked[kind] & given[kind] != 0);
    for (masked, given) in masks.masked.iter_mut().zip(given) {
        *masked |= given;
    }
    call.cpu.running.masks.set(masks);
    give_masked(call);
    outcome(already)
}

/// 0001: one of them was not masked.
pub(super) fn dmsk_flt(call: &Call) -> Outcome {
    let (given, mut masks) = (given(call), call.cpu.running.masks.get());
    let missing = (0..2).any(|kind| given[kind] & !masks.masked[kind] != 0);
    for (kind, bits) in given.into_iter().enumerate() {
        masks.masked[kind] &= !bits;
        masks.occurred[kind] &= !bits;
    }
    call.cpu.running.masks.set(masks);
    give_masked(call);
    outcome(missing)
}

/// Returns the masked errors that occurred, and forgets them. 0001: one of them is not masked.
pub(super) fn read_err(call: &Call) -> Outcome {
    let (given, mut masks) = (given(call), call.cpu.running.masks.get());
    let missing = (0..2).any(|kind| given[kind] & !masks.masked[kind] != 0);
    for (kind, bits) in given.into_iter().enumerate() {
        call.set_dword(3 + kind, masks.occurred[kind] & bits);
        masks.occurred[kind] &= !bits;
    }
    call.cpu.running.masks.set(masks);
    outcome(missing)
}
