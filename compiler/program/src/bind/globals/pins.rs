//! The parameters with which STL calls an instruction of the TIA Portal by its name, for those who write such calls.

use plcc_model::{InstructionPin, InstructionType};

use super::form::{Form, PinType};
use super::instruction::Instruction;

/// The parameters of a call of the instruction `name` that supplies those with the names `given`; none: STL has no such call.
pub fn instruction_pins(name: &str, given: &[&str]) -> Option<Vec<InstructionPin>> {
    let Some(form) = Form::find(name) else { return Instruction::find(name)?.pins_of_call(given) };
    let is_pin = |given: &&str| form.pins.iter().any(|pin| pin.name.eq_ignore_ascii_case(given));
    let pins = form.pins.iter().map(|pin| InstructionPin {
        name: pin.name.to_owned(),
        direction: pin.direction,
        ty: match pin.ty {
            PinType::Fixed(ty) => InstructionType::Fixed(ty),
            PinType::Actual(word) | PinType::Elements(word) => InstructionType::Named(word),
            PinType::Number(ty) => InstructionType::Number(ty),
        },
    });
    given.iter().all(is_pin).then(|| pins.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use plcc_model::Direction;
    use plcc_syntax::Elementary;

    fn names(name: &str, given: &[&str]) -> Option<Vec<String>> {
        Some(instruction_pins(name, given)?.into_iter().map(|pin| pin.name).collect())
    }

    #[test]
    fn a_call_has_the_pins_of_the_instruction_and_those_that_it_adds() {
        let names_of = |list: &[&str]| Some(list.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>());
        assert_eq!(names("limit", &["mn", "in", "mx", "out"]), names_of(&["MN", "IN", "MX", "OUT"]));
        assert_eq!(names("MIN", &["in1", "in2", "in3"]), names_of(&["IN1", "IN2", "IN3", "OUT"]));
        assert_eq!(names("CONCAT", &["in1", "in2", "in3"]), None);
        assert_eq!(names("SHR", &["in", "n"]), None);
        let out = instruction_pins("SCALE_X", &["min", "value", "max"]).and_then(|mut pins| pins.pop());
        let expected =
            InstructionPin { name: "OUT".to_owned(), direction: Direction::Output, ty: InstructionType::Named("dest") };
        assert_eq!(out, Some(expected));
        let count = instruction_pins("MOVE_BLK", &[]).map(|pins| pins[1].ty);
        assert_eq!(count, Some(InstructionType::Number(Elementary::Udint)));
    }
}
