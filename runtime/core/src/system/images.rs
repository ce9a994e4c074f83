//! SFC 26 UPDAT_PI, SFC 27 UPDAT_PO, SFC 126 SYNC_PI, SFC 127 SYNC_PO: the process image out of turn.
//!
//! Source: System and standard functions, SFC 26, 27. There are no partial images, so PART is 0: the whole image.

use super::parameters::Call;
use super::{OK, Outcome, error};

const FLADDR: usize = 2;

/// PART, LADDR -> RET_VAL, FLADDR: a partial image in step with the bus. There is none: 8090.
pub(super) fn synchronous(call: &Call) -> Outcome {
    call.set_word(3, 0);
    error(0x8090)
}

/// PART -> RET_VAL, FLADDR. 8090 unknown partial image.
pub(super) fn update_inputs(call: &Call) -> Outcome {
    call.set_word(FLADDR, 0);
    if call.byte(0) != 0 {
        return error(0x8090);
    }
    call.cpu.read_inputs();
    OK
}

/// PART -> RET_VAL, FLADDR. 8090 unknown partial image.
pub(super) fn update_outputs(call: &Call) -> Outcome {
    call.set_word(FLADDR, 0);
    if call.byte(0) != 0 {
        return error(0x8090);
    }
    call.cpu.write_outputs();
    OK
}
