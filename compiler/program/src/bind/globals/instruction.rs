//! Instructions of the TIA Portal that SCL computes in place, as functions for STL: `CALL NORM_X`, `CALL LIMIT`.
//!
//! An instruction with the types of a call is a function in SCL with one statement, which is bound as a block of the library. Its ENO
//! becomes BR.
//! Source: S7-1500 information system, basic instructions of STL; SCL reference, functions.

use std::fmt::Write;

use plcc_binding::fold;
use plcc_binding::report::MissingKey;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::{Direction, InstructionPin, InstructionType};
use plcc_syntax::{Class, Elementary};

use crate::bind::globals::Globals;

/// The type of a pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PinType {
    /// `value_type`, `src_type`.
    Value,
    /// `dest_type`; the type of the values if an instruction has one type.
    Result,
    Bool,
    /// The integer that a call passes.
    Index,
}

/// An instruction with the output OUT.
#[derive(Debug)]
pub struct Instruction {
    pub name: &'static str,
    /// Inputs that each call supplies.
    pins: &'static [(&'static str, PinType)],
    /// The number of the last one: a call may add inputs with the numbers after it.
    last: Option<u16>,
    /// The names of an input that a call may leave out, and how a declaration writes them; the first one is that of SCL.
    optional: &'static [(&'static str, &'static str)],
    /// The result has a type of its own.
    pub converts: bool,
}

/// Inputs of an instruction go up to this number. Source: S7-1500 information system, MIN, MUX.
const LAST_INPUT: u16 = 32;

const INSTRUCTIONS: &[Instruction] = &[
    Instruction {
        name: "NORM_X",
        pins: &[("MIN", PinType::Value), ("VALUE", PinType::Value), ("MAX", PinType::Value)],
        last: None,
        optional: &[],
        converts: true,
    },
    Instruction {
        name: "SCALE_X",
        pins: &[("MIN", PinType::Result), ("VALUE", PinType::Value), ("MAX", PinType::Result)],
        last: None,
        optional: &[],
        converts: true,
    },
    Instruction {
        name: "LIMIT",
        pins: &[("MN", PinType::Value), ("IN", PinType::Value), ("MX", PinType::Value)],
        last: None,
        optional: &[],
        converts: false,
    },
    Instruction {
        name: "SEL",
        pins: &[("G", PinType::Bool), ("IN0", PinType::Value), ("IN1", PinType::Value)],
        last: None,
        optional: &[],
        converts: false,
    },
    Instruction {
        name: "MUX",
        pins: &[("K", PinType::Index), ("IN0", PinType::Value), ("IN1", PinType::Value)],
        last: Some(1),
        optional: &[("INELSE", "INELSE"), ("ELSE", "\"ELSE\"")],
        converts: false,
    },
    Instruction {
        name: "MIN",
        pins: &[("IN1", PinType::Value), ("IN2", PinType::Value)],
        last: Some(2),
        optional: &[],
        converts: false,
    },
    Instruction {
        name: "MAX",
        pins: &[("IN1", PinType::Value), ("IN2", PinType::Value)],
        last: Some(2),
        optional: &[],
        converts: false,
    },
];

const NETWORKS: &str = "LAD and FBD";
const SCL: &str = "SCL";
const BOTH: &str = "SCL, LAD and FBD";

/// Instructions that plcc only has in other languages, and in which.
#[rustfmt::skip]
const ELSEWHERE: &[(&str, &str)] = &[
    ("CountOfElements", BOTH), ("DEMUX", BOTH), ("EXPT", BOTH), ("IS_ARRAY", BOTH), ("LOWER_BOUND", BOTH), ("UPPER_BOUND", BOTH),
    ("EQ_ElemType", NETWORKS), ("EQ_Type", NETWORKS), ("IS_NULL", NETWORKS), ("NE_ElemType", NETWORKS), ("NE_Type", NETWORKS),
    ("NOT_NULL", NETWORKS), ("GetBlockName", SCL), ("GetInstanceName", SCL), ("GetInstancePath", SCL), ("PEEK", SCL),
    ("PEEK_BOOL", SCL), ("POKE", SCL), ("POKE_BLK", SCL), ("POKE_BOOL", SCL), ("PRESET_TIMER", SCL), ("RESET_TIMER", SCL),
    ("TypeOf", SCL), ("TypeOfElements", SCL),
];

/// The types for which an instruction is called.
#[derive(Clone, Copy, Debug)]
pub struct Types {
    pub value: Elementary,
    pub result: Elementary,
    pub index: Elementary,
}

impl Instruction {
    /// The instruction with this name, in any letter case.
    pub fn find(name: &str) -> Option<&'static Instruction> {
        INSTRUCTIONS.iter().find(|instruction| instruction.name.eq_ignore_ascii_case(name.trim()))
    }

    /// The type of a pin, OUT included; none: no call of the instruction has a pin of this name.
    pub fn pin(&self, name: &str) -> Option<PinType> {
        let is = |known: &str| known.eq_ignore_ascii_case(name.trim());
        if is("OUT") {
            return Some(if self.converts { PinType::Result } else { PinType::Value });
        }
        match self.pins.iter().find(|(known, _)| is(known)) {
            Some((_, ty)) => Some(*ty),
            None => {
                let optional = self.optional.iter().any(|(known, _)| is(known));
                (optional || self.number(name).is_some()).then_some(PinType::Value)
            }
        }
    }

    /// The parameters of a call that supplies those with the names `given`, OUT among them or not; none: there is no such call.
    pub fn pins_of_call(&self, given: &[&str]) -> Option<Vec<InstructionPin>> {
        let mut names: Vec<&str> = self.pins.iter().map(|(name, _)| *name).collect();
        let own = names.clone();
        let is_own =
            |name: &str| name.eq_ignore_ascii_case("OUT") || own.iter().any(|own| own.eq_ignore_ascii_case(name));
        names.extend(given.iter().copied().filter(|name| !is_own(name)));
        names.push("OUT");
        let value = if self.converts { "src" } else { "value" };
        let pin = |name: &str| {
            let ty = match self.pin(name)? {
                PinType::Value => InstructionType::Named(value),
                PinType::Result => InstructionType::Named("dest"),
                PinType::Bool => InstructionType::Fixed(Elementary::Bool),
                PinType::Index => InstructionType::Number(Elementary::Int),
            };
            let direction = if name == "OUT" { Direction::Output } else { Direction::Input };
            Some(InstructionPin { name: name.to_ascii_uppercase(), direction, ty })
        };
        names.into_iter().map(pin).collect()
    }

    /// The number of an input that a call adds.
    fn number(&self, name: &str) -> Option<u16> {
        let upper = name.trim().to_ascii_uppercase();
        let digits = upper.strip_prefix("IN")?;
        let number: u16 = digits.parse().ok()?;
        (number > self.last? && number <= LAST_INPUT && number.to_string() == digits).then_some(number)
    }

    /// What the types of a call must be, if they are not.
    pub fn wrong_types(&self, types: Types) -> Option<&'static str> {
        let is_number = |ty: Elementary| matches!(ty.class(), Class::Signed | Class::Unsigned | Class::Float);
        let is_float = |ty: Elementary| ty.class() == Class::Float;
        let (fits, expected) = match self.name {
            "NORM_X" => (is_number(types.value) && is_float(types.result), "a REAL or LREAL from a number"),
            "SCALE_X" => (is_float(types.value) && is_number(types.result), "a number from a REAL or LREAL"),
            _ => return None,
        };
        (!fits).then_some(expected)
    }

    /// The function for a call with these types; `given`: the names of its parameters.
    pub fn function<'n>(&self, types: Types, given: impl Iterator<Item = &'n str> + Clone) -> String {
        let mut inputs: Vec<(String, PinType)> = self.pins.iter().map(|(name, ty)| ((*name).to_owned(), *ty)).collect();
        if let Some(last) = self.last {
            let end = given.clone().filter_map(|name| self.number(name)).max().unwrap_or(last);
            inputs.extend((last + 1..=end).map(|number| (format!("IN{number}"), PinType::Value)));
        }
        // What the instruction calls them in SCL, and their declarations.
        let mut inputs: Vec<(String, String, PinType)> =
            inputs.into_iter().map(|(name, ty)| (name.clone(), name, ty)).collect();
        let is_given = |name: &str| given.clone().any(|given| given.trim().eq_ignore_ascii_case(name));
        if let Some((_, declared)) = self.optional.iter().find(|(name, _)| is_given(name)) {
            inputs.push((self.optional[0].0.to_owned(), (*declared).to_owned(), PinType::Value));
        }
        let mut declarations = String::new();
        let mut arguments = String::new();
        for (name, declared, ty) in &inputs {
            let ty = match ty {
                PinType::Value => types.value,
                PinType::Result => types.result,
                PinType::Bool => Elementary::Bool,
                PinType::Index => types.index,
            };
            let _ = writeln!(declarations, "  {declared} : {} ;", ty.name());
            let _ = write!(arguments, "{name} := #{declared}, ");
        }
        let (name, result) = (self.name, types.result.name());
        format!(
            "FUNCTION SFC 60000 : VOID\nNAME : {name}\n\
             VAR_INPUT\n{declarations}END_VAR\nVAR_OUTPUT\n  OUT : {result} ;\nEND_VAR\n\
             VAR_TEMP\n  good : BOOL ;\nEND_VAR\n\
             BEGIN\n  #OUT := {name}({arguments}ENO => #good);\n  ENO := #good;\nEND_FUNCTION\n"
        )
    }
}

impl Globals<'_> {
    /// Reports a call in STL of an instruction that plcc does not have, or only in other languages; false: it is something else.
    pub fn missing_in_stl(&mut self, name: &str, span: Span) -> bool {
        if self.global(name).is_some() {
            return false;
        }
        let Some((_, languages)) = ELSEWHERE.iter().find(|(known, _)| known.eq_ignore_ascii_case(name.trim())) else {
            return self.missing_in_catalogue(name, span);
        };
        self.report.missing(MissingKey::Symbol(fold(name)), span, || {
            Diagnostic::new(Code::NotShipped, span, format!("plcc cannot call the instruction `{name}` from STL"))
                .label(format!("plcc has it in {languages}"))
                .help("write a function in SCL that computes it, and call that function")
        });
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pins_of_instructions() {
        let mux = Instruction::find("mux").expect("it is in the table");
        assert_eq!(mux.pin("k"), Some(PinType::Index));
        assert_eq!(mux.pin("IN4"), Some(PinType::Value));
        assert_eq!(mux.pin("inelse"), Some(PinType::Value));
        assert_eq!(mux.pin("IN04"), None);
        assert_eq!(mux.pin("IN33"), None);
        let norm = Instruction::find("NORM_X").expect("it is in the table");
        assert_eq!(norm.pin("OUT"), Some(PinType::Result));
        assert_eq!(norm.pin(""), None);
        assert!(Instruction::find("BLKMOV").is_none());
    }

    #[test]
    fn functions_have_the_inputs_of_their_calls() {
        let types = Types { value: Elementary::Int, result: Elementary::Int, index: Elementary::Usint };
        let mux = Instruction::find("MUX").expect("it is in the table");
        let function = mux.function(types, ["K", "IN0", "IN1", "IN3", "INELSE"].into_iter());
        assert!(function.contains("IN1 := #IN1, IN2 := #IN2, IN3 := #IN3, INELSE := #INELSE,"));
        assert!(function.contains("  K : USINT ;\n  IN0 : INT ;\n"));
        let function = mux.function(types, ["K", "IN0", "IN1", "else"].into_iter());
        assert!(function.contains("IN1 := #IN1, INELSE := #\"ELSE\","));
        assert!(function.contains("  \"ELSE\" : INT ;\n"));
    }
}
