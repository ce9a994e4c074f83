//! Boxes of blocks of the library that STL of the TIA Portal calls by name: `CALL RD_SYS_T (RET_VAL := #result, OUT := #now)`.
//!
//! In STL a function needs all its parameters. Source: LAD/FBD reference B.9, C.15.

use plcc_model::{Direction, InstructionPin, InstructionType};
use plcc_syntax::Elementary::{self, Bool, Int, Time, Udint, Word};
use plcc_syntax::ast::{BlockName, TypeKind};
use plcc_syntax::network::ast::{Element, PinValue};

use super::Maker;

type Pins = &'static [(&'static str, Direction, InstructionType)];

const RESULT: (&str, Direction, InstructionType) = out("RET_VAL", Int);
/// An input or output of the type DTL.
const MOMENT: InstructionType = InstructionType::Named("dtl");

const BLOCKS: [(&str, Pins); 14] = [
    ("RE_TRIGR", &[]),
    ("STP", &[]),
    ("WAIT", &[given("WT", Int)]),
    ("WR_SYS_T", &[("IN", Direction::Input, MOMENT), RESULT]),
    ("RD_SYS_T", &[RESULT, ("OUT", Direction::Output, MOMENT)]),
    ("RD_LOC_T", &[RESULT, ("OUT", Direction::Output, MOMENT)]),
    ("WR_LOC_T", &[("LOCTIME", Direction::Input, MOMENT), given("DST", Bool), RESULT]),
    ("SET_CINT", &[given("OB_NR", Int), given("CYCLE", Udint), given("PHASE", Udint), RESULT]),
    ("QRY_CINT", &[given("OB_NR", Int), RESULT, out("CYCLE", Udint), out("PHASE", Udint), out("STATUS", Word)]),
    ("SRT_DINT", &[given("OB_NR", Int), given("DTIME", Time), given("SIGN", Word), RESULT]),
    ("CAN_DINT", &[given("OB_NR", Int), RESULT]),
    ("QRY_DINT", &[given("OB_NR", Int), RESULT, out("STATUS", Word)]),
    ("DIS_AIRT", &[RESULT]),
    ("EN_AIRT", &[RESULT]),
];

const fn given(name: &'static str, ty: Elementary) -> (&'static str, Direction, InstructionType) {
    (name, Direction::Input, InstructionType::Fixed(ty))
}

const fn out(name: &'static str, ty: Elementary) -> (&'static str, Direction, InstructionType) {
    (name, Direction::Output, InstructionType::Fixed(ty))
}

/// Whether it is one of these blocks.
pub(crate) fn is_block(name: &str) -> bool {
    BLOCKS.iter().any(|(own, _)| own.eq_ignore_ascii_case(name))
}

/// The parameters of a block whose inputs `given` supplies; none: it is called in another way, or an input is open.
pub fn pins_of_block(name: &str, given: &[&str]) -> Option<Vec<InstructionPin>> {
    let (_, pins) = BLOCKS.iter().find(|(own, _)| *own == name)?;
    let is_given = |pin: &str| given.iter().any(|one| one.eq_ignore_ascii_case(pin));
    let all = pins.iter().all(|(name, direction, _)| *direction == Direction::Output || is_given(name));
    let pin = |&(name, direction, ty): &(&str, Direction, InstructionType)| InstructionPin {
        name: name.to_string(),
        direction,
        ty,
    };
    all.then(|| pins.iter().map(pin).collect())
}

/// The number that a block has as a system function of an S7-300. Source: System and standard functions for S7-300 and S7-400.
pub fn system_function(name: &str) -> Option<u32> {
    Some(match name {
        "SRT_DINT" => 32,
        "CAN_DINT" => 33,
        "QRY_DINT" => 34,
        "DIS_AIRT" => 41,
        "EN_AIRT" => 42,
        "RE_TRIGR" => 43,
        "STP" => 46,
        "WAIT" => 47,
        _ => return None,
    })
}

impl Maker<'_> {
    /// Where a block has a DTL, a variable of that type is connected.
    pub fn has_moments(&self, element: &Element, pins: &[InstructionPin]) -> bool {
        let is_moment = |value: &PinValue| {
            let PinValue::Operand(value) = value else { return false };
            let operand = super::operand::operand_of(value);
            let declared = operand.as_ref().and_then(|operand| self.types.declared(&operand.kind, self.block));
            match declared.map(|declared| &declared.kind) {
                Some(TypeKind::Named(name) | TypeKind::Block(BlockName::Symbol { name, .. })) => {
                    name.eq_ignore_ascii_case("DTL")
                }
                _ => false,
            }
        };
        let of_moments = pins.iter().filter(|pin| pin.ty == MOMENT);
        of_moments.map(|pin| element.pin(&pin.name)).all(|pin| pin.is_some_and(|pin| is_moment(&pin.value)))
    }
}
