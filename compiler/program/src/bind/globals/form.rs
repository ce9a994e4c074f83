//! Instructions of the TIA Portal each of whose pins has the type of its own actual parameter, as functions for STL: `CALL T_ADD`,
//! `CALL S_CONV`, `CALL MOVE_BLK`.
//!
//! As in [`super::instruction`], a call becomes a function in SCL with one statement, which is bound as a block of the library, and its
//! ENO becomes BR. A pin that goes on from an element of an array is two parameters of the function: the array, and the index.
//! Source: S7-1500 information system, basic and extended instructions of STL; SCL reference, functions.

use std::fmt::Write;

use plcc_model::Direction;
use plcc_syntax::Elementary;

/// Where the type of a pin comes from. The word is that of a type that a call names: `src` for `src_type`; pins with the same word
/// have the same type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PinType {
    Fixed(Elementary),
    /// From the actual parameter.
    Actual(&'static str),
    /// From the actual parameter, this one for a number without a type and an address of its width: how many, or where.
    Number(Elementary),
    /// From the array whose element is the actual parameter: the instruction goes on from there. The word is that of the elements.
    Elements(&'static str),
}

impl PinType {
    /// The word of the type that a call names for the pin.
    pub fn word(self) -> Option<&'static str> {
        match self {
            PinType::Fixed(_) => None,
            PinType::Actual(word) | PinType::Elements(word) => Some(word),
            PinType::Number(_) => Some("count"),
        }
    }
}

/// A parameter of an instruction.
#[derive(Debug)]
pub struct Pin {
    pub name: &'static str,
    pub direction: Direction,
    pub ty: PinType,
}

/// How SCL computes an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Computation {
    /// `OUT := T_ADD(IN1 := …)`.
    Value,
    /// `S_CONV(IN := …, OUT => …)`.
    Output,
    /// `OUT := INT_TO_REAL(IN := …)`.
    Conversion,
    /// `OUT := CEIL_DINT(IN := …)`.
    Suffixed,
    /// `OUT := IN1 >= IN2`, with the relation that the call names.
    Comparison,
    /// A call of the library block with this name, to which STL cannot pass the bounds of an array.
    Block,
}

/// An instruction, every pin of which a call supplies.
#[derive(Debug)]
pub struct Form {
    pub name: &'static str,
    pub computation: Computation,
    pub pins: &'static [Pin],
}

/// A pin in a call.
#[derive(Debug)]
pub struct PinOfCall {
    pub pin: &'static Pin,
    /// That of the pin, or [`Direction::Input`] for a constant, to which nothing is written back.
    pub direction: Direction,
    /// As a declaration writes it.
    pub ty: String,
    /// The type of the index of the element, if `ty` is the array that holds it.
    pub index: Option<String>,
}

/// What the name of a parameter with the index of a pin ends with.
const INDEX: &str = "_INDEX";

/// The name of the parameter with the index of a pin.
pub fn index_name(pin: &Pin) -> String {
    format!("{}{INDEX}", pin.name)
}

/// Whether a parameter of a function for an instruction is the index of a pin, which the call does not name.
pub fn is_index(parameter: &str) -> bool {
    parameter.ends_with(INDEX)
}

const fn input(name: &'static str, ty: PinType) -> Pin {
    Pin { name, direction: Direction::Input, ty }
}

const fn output(name: &'static str, ty: PinType) -> Pin {
    Pin { name, direction: Direction::Output, ty }
}

const fn in_out(name: &'static str, ty: PinType) -> Pin {
    Pin { name, direction: Direction::InOut, ty }
}

const VALUE: PinType = PinType::Actual("value");
const SOURCE: PinType = PinType::Actual("src");
const RESULT: PinType = PinType::Actual("dest");
const TEXT: PinType = PinType::Actual("string");
const TIME: PinType = PinType::Actual("time");
/// What T_ADD and T_SUB add to a time, which may be one of another type.
const DURATION: PinType = PinType::Actual("duration");

const VALUES: PinType = PinType::Elements("value");
const SOURCES: PinType = PinType::Elements("src");
const RESULTS: PinType = PinType::Elements("dest");

const ARRAY: PinType = PinType::Actual("array");
const DATE: PinType = PinType::Actual("date");
const COUNT: PinType = PinType::Number(Elementary::Udint);
const START: PinType = PinType::Number(Elementary::Dint);
const PLACE: PinType = PinType::Number(Elementary::Int);

const BOOL: PinType = PinType::Fixed(Elementary::Bool);
const USINT: PinType = PinType::Fixed(Elementary::Usint);
const UINT: PinType = PinType::Fixed(Elementary::Uint);
const WORD: PinType = PinType::Fixed(Elementary::Word);

const OF_VALUE: &[Pin] = &[input("IN", VALUE), output("OUT", VALUE)];
const FROM_SOURCE: &[Pin] = &[input("IN", SOURCE), output("OUT", RESULT)];
// Arrays are passed as IN_OUT: the function changes some of their elements, or reads some without a copy of all.
const MOVES: &[Pin] = &[in_out("IN", VALUES), input("COUNT", COUNT), in_out("OUT", VALUES)];
const FILLS: &[Pin] = &[input("IN", VALUE), input("COUNT", COUNT), in_out("OUT", VALUES)];

#[rustfmt::skip]
const FORMS: &[Form] = &[
    Form { name: "ABS", computation: Computation::Value, pins: OF_VALUE },
    Form { name: "SQR", computation: Computation::Value, pins: OF_VALUE },
    Form { name: "SQRT", computation: Computation::Value, pins: OF_VALUE },
    Form { name: "LN", computation: Computation::Value, pins: OF_VALUE },
    Form { name: "EXP", computation: Computation::Value, pins: OF_VALUE },
    Form { name: "SIN", computation: Computation::Value, pins: OF_VALUE },
    Form { name: "COS", computation: Computation::Value, pins: OF_VALUE },
    Form { name: "TAN", computation: Computation::Value, pins: OF_VALUE },
    Form { name: "ASIN", computation: Computation::Value, pins: OF_VALUE },
    Form { name: "ACOS", computation: Computation::Value, pins: OF_VALUE },
    Form { name: "ATAN", computation: Computation::Value, pins: OF_VALUE },
    Form { name: "FRAC", computation: Computation::Value, pins: OF_VALUE },
    Form { name: "SWAP", computation: Computation::Value, pins: OF_VALUE },
    Form { name: "CONVERT", computation: Computation::Conversion, pins: FROM_SOURCE },
    Form { name: "ROUND", computation: Computation::Suffixed, pins: FROM_SOURCE },
    Form { name: "CEIL", computation: Computation::Suffixed, pins: FROM_SOURCE },
    Form { name: "FLOOR", computation: Computation::Suffixed, pins: FROM_SOURCE },
    Form { name: "TRUNC", computation: Computation::Suffixed, pins: FROM_SOURCE },
    Form {
        name: "T_ADD", computation: Computation::Value,
        pins: &[input("IN1", TIME), input("IN2", DURATION), output("OUT", TIME)],
    },
    Form {
        name: "T_SUB", computation: Computation::Value,
        pins: &[input("IN1", TIME), input("IN2", DURATION), output("OUT", TIME)],
    },
    Form {
        name: "T_DIFF", computation: Computation::Value,
        pins: &[input("IN1", TIME), input("IN2", TIME), output("OUT", RESULT)],
    },
    Form { name: "T_CONV", computation: Computation::Value, pins: FROM_SOURCE },
    Form {
        name: "T_COMBINE", computation: Computation::Value,
        pins: &[input("IN1", DATE), input("IN2", TIME), output("OUT", RESULT)],
    },
    Form {
        name: "T_COMP", computation: Computation::Comparison,
        pins: &[input("IN1", TIME), input("IN2", TIME), output("OUT", BOOL)],
    },
    Form {
        name: "S_COMP", computation: Computation::Comparison,
        pins: &[input("IN1", TEXT), input("IN2", TEXT), output("OUT", BOOL)],
    },
    Form { name: "S_MOVE", computation: Computation::Output, pins: &[input("IN", TEXT), output("OUT", TEXT)] },
    Form { name: "S_CONV", computation: Computation::Output, pins: FROM_SOURCE },
    Form {
        name: "STRG_VAL", computation: Computation::Output,
        // P is then where the number ends.
        pins: &[input("IN", SOURCE), input("FORMAT", WORD), in_out("P", UINT), output("OUT", RESULT)],
    },
    Form {
        name: "VAL_STRG", computation: Computation::Output,
        // The text keeps what stands before and after the number.
        pins: &[
            input("IN", SOURCE), input("SIZE", USINT), input("PREC", USINT), input("FORMAT", WORD), in_out("P", UINT),
            in_out("OUT", RESULT),
        ],
    },
    Form { name: "LEN", computation: Computation::Value, pins: &[input("IN", TEXT), output("OUT", PLACE)] },
    Form { name: "MAX_LEN", computation: Computation::Value, pins: &[input("IN", TEXT), output("OUT", PLACE)] },
    Form { name: "CONCAT", computation: Computation::Value, pins: &[input("IN1", TEXT), input("IN2", TEXT), output("OUT", TEXT)] },
    Form { name: "LEFT", computation: Computation::Value, pins: &[input("IN", TEXT), input("L", PLACE), output("OUT", TEXT)] },
    Form { name: "RIGHT", computation: Computation::Value, pins: &[input("IN", TEXT), input("L", PLACE), output("OUT", TEXT)] },
    Form {
        name: "MID", computation: Computation::Value,
        pins: &[input("IN", TEXT), input("L", PLACE), input("P", PLACE), output("OUT", TEXT)],
    },
    Form {
        name: "DELETE", computation: Computation::Value,
        pins: &[input("IN", TEXT), input("L", PLACE), input("P", PLACE), output("OUT", TEXT)],
    },
    Form {
        name: "INSERT", computation: Computation::Value,
        pins: &[input("IN1", TEXT), input("IN2", TEXT), input("P", PLACE), output("OUT", TEXT)],
    },
    Form {
        name: "REPLACE", computation: Computation::Value,
        pins: &[input("IN1", TEXT), input("IN2", TEXT), input("L", PLACE), input("P", PLACE), output("OUT", TEXT)],
    },
    Form { name: "FIND", computation: Computation::Value, pins: &[input("IN1", TEXT), input("IN2", TEXT), output("OUT", PLACE)] },
    Form {
        name: "Strg_TO_Chars", computation: Computation::Block,
        pins: &[input("Strg", TEXT), input("pChars", START), output("Cnt", UINT), in_out("Chars", ARRAY)],
    },
    Form {
        name: "Chars_TO_Strg", computation: Computation::Block,
        pins: &[in_out("Chars", ARRAY), input("pChars", START), input("Cnt", UINT), output("Strg", TEXT)],
    },
    Form { name: "DECO", computation: Computation::Suffixed, pins: FROM_SOURCE },
    Form { name: "ENCO", computation: Computation::Value, pins: &[input("IN", SOURCE), output("OUT", PLACE)] },
    Form { name: "BITSUM", computation: Computation::Value, pins: &[input("IN", SOURCE), output("OUT", PLACE)] },
    Form { name: "MOVE_BLK", computation: Computation::Output, pins: MOVES },
    Form { name: "UMOVE_BLK", computation: Computation::Output, pins: MOVES },
    Form { name: "FILL_BLK", computation: Computation::Output, pins: FILLS },
    Form { name: "UFILL_BLK", computation: Computation::Output, pins: FILLS },
    Form { name: "SCATTER", computation: Computation::Output, pins: &[input("IN", SOURCE), in_out("OUT", RESULT)] },
    Form { name: "GATHER", computation: Computation::Output, pins: &[in_out("IN", SOURCE), output("OUT", RESULT)] },
    Form {
        name: "SCATTER_BLK", computation: Computation::Output,
        pins: &[in_out("IN", SOURCES), input("COUNT_IN", COUNT), in_out("OUT", RESULTS)],
    },
    Form {
        name: "GATHER_BLK", computation: Computation::Output,
        pins: &[in_out("IN", SOURCES), input("COUNT_OUT", COUNT), in_out("OUT", RESULTS)],
    },
];

/// The relations that a call of a comparison names, and the operators of SCL.
const RELATIONS: [(&str, &str); 6] = [("EQ", "="), ("NE", "<>"), ("GT", ">"), ("GE", ">="), ("LT", "<"), ("LE", "<=")];

/// The operator of SCL for a relation, in any letter case.
pub fn relation(word: &str) -> Option<&'static str> {
    RELATIONS.iter().find(|(name, _)| name.eq_ignore_ascii_case(word.trim())).map(|(_, operator)| *operator)
}

impl Form {
    /// The instruction with this name, in any letter case.
    pub fn find(name: &str) -> Option<&'static Form> {
        FORMS.iter().find(|form| form.name.eq_ignore_ascii_case(name.trim()))
    }

    /// The function for a call: `operator` is that of a comparison.
    pub fn function(&self, pins: &[PinOfCall], operator: &str) -> String {
        let mut declarations = String::new();
        for (section, direction) in
            [("VAR_INPUT", Direction::Input), ("VAR_OUTPUT", Direction::Output), ("VAR_IN_OUT", Direction::InOut)]
        {
            let _ = writeln!(declarations, "{section}");
            for PinOfCall { pin, ty, .. } in pins.iter().filter(|one| one.direction == direction) {
                let _ = writeln!(declarations, "  {} : {ty} ;", pin.name);
            }
            let indices = pins.iter().filter_map(|one| Some((index_name(one.pin), one.index.as_ref()?)));
            for (name, ty) in indices.filter(|_| direction == Direction::Input) {
                let _ = writeln!(declarations, "  {name} : {ty} ;");
            }
            declarations.push_str("END_VAR\n");
        }
        let value = |one: &PinOfCall| match one.index {
            Some(_) => format!("#{}[#{}]", one.pin.name, index_name(one.pin)),
            None => format!("#{}", one.pin.name),
        };
        let mut inputs = String::new();
        let mut target = String::new();
        for one in pins {
            match one.pin.name {
                "OUT" => target = value(one),
                name => {
                    let _ = write!(inputs, "{name} := {}, ", value(one));
                }
            }
        }
        let mut all = String::new();
        for Pin { name, direction, .. } in self.pins {
            let sign = if *direction == Direction::Output { "=>" } else { ":=" };
            let _ = write!(all, "{name} {sign} #{name}, ");
        }
        let word = |name: &str| pins.iter().find(|one| one.pin.name == name).map_or("", |one| conversion_word(&one.ty));
        let name = self.name;
        let statement = match self.computation {
            Computation::Value => format!("#OUT := {name}({inputs}ENO => #good);"),
            Computation::Output => format!("{name}({inputs}OUT => {target}, ENO => #good);"),
            Computation::Conversion => {
                format!("#OUT := {}_TO_{}({inputs}ENO => #good);", word("IN"), word("OUT"))
            }
            Computation::Suffixed => format!("#OUT := {name}_{}({inputs}ENO => #good);", word("OUT")),
            Computation::Comparison => format!("#OUT := #IN1 {operator} #IN2;\n  #good := TRUE;"),
            Computation::Block => format!("{name}({all}ENO => #good);"),
        };
        format!(
            "FUNCTION SFC 60000 : VOID\nNAME : {name}\n{declarations}VAR_TEMP\n  good : BOOL ;\nEND_VAR\n\
             BEGIN\n  {statement}\n  ENO := #good;\nEND_FUNCTION\n"
        )
    }
}

/// A type in the name of a conversion.
fn conversion_word(ty: &str) -> &str {
    match ty {
        "TIME_OF_DAY" => "TOD",
        "DATE_AND_TIME" => "DT",
        _ => ty.trim_matches('"'),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn function(name: &str, types: &[&str], operator: &str) -> String {
        let form = Form::find(name).expect("it is in the table");
        let index = |ty: &str| ty.starts_with("ARRAY").then(|| "DINT".to_owned());
        let pins = form.pins.iter().zip(types);
        let pins =
            pins.map(|(pin, ty)| PinOfCall { pin, direction: pin.direction, ty: (*ty).to_owned(), index: index(ty) });
        form.function(&pins.collect::<Vec<_>>(), operator)
    }

    #[test]
    fn pins_are_declared_with_their_types() {
        let text = function("val_strg", &["REAL", "USINT", "USINT", "WORD", "UINT", "STRING"], "");
        assert!(text.contains("VAR_INPUT\n  IN : REAL ;\n  SIZE : USINT ;\n"));
        assert!(text.contains("VAR_IN_OUT\n  P : UINT ;\n  OUT : STRING ;\nEND_VAR\n"));
        assert!(text.contains("FORMAT := #FORMAT, P := #P, OUT => #OUT, ENO => #good);\n"));
    }

    #[test]
    fn elements_are_an_array_and_an_index() {
        let text = function("MOVE_BLK", &["ARRAY[0..9] OF INT", "UDINT", "ARRAY[1..5] OF INT"], "");
        assert!(text.contains("VAR_INPUT\n  COUNT : UDINT ;\n  IN_INDEX : DINT ;\n  OUT_INDEX : DINT ;\nEND_VAR\n"));
        assert!(text.contains("VAR_IN_OUT\n  IN : ARRAY[0..9] OF INT ;\n  OUT : ARRAY[1..5] OF INT ;\nEND_VAR\n"));
        assert!(text.contains("  MOVE_BLK(IN := #IN[#IN_INDEX], COUNT := #COUNT, OUT => #OUT[#OUT_INDEX], ENO => "));
    }

    #[test]
    fn each_computation_is_one_statement() {
        let text = function("T_SUB", &["DATE_AND_TIME", "TIME", "DATE_AND_TIME"], "");
        assert!(text.contains("  #OUT := T_SUB(IN1 := #IN1, IN2 := #IN2, ENO => #good);\n"));
        assert!(function("CONVERT", &["TIME_OF_DAY", "UDINT"], "").contains("#OUT := TOD_TO_UDINT(IN := #IN, "));
        assert!(function("CEIL", &["REAL", "DINT"], "").contains("#OUT := CEIL_DINT(IN := #IN, "));
        let text = function("Strg_TO_Chars", &["STRING", "DINT", "UINT", "ARRAY[0..9] OF CHAR"], "");
        assert!(text.contains("(Strg := #Strg, pChars := #pChars, Cnt => #Cnt, Chars := #Chars, ENO => #good);\n"));
        let operator = relation("ge").expect("it is a relation");
        assert!(function("S_COMP", &["STRING", "STRING", "BOOL"], operator).contains("#OUT := #IN1 >= #IN2;\n"));
    }
}
