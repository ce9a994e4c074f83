//! The parentheses after an action: event, instruction, the letter C. Source: GRAPH reference A.2, D.6 to D.8.

use super::token::Mark;
use plcc_syntax::chart::ast::{Event, Qualifier};

/// Reads `S1_N`, `NC`, `S1 CU`, `CDC`, `CALLC`. CALL is the N of a call. The longest instruction counts, then a C may follow.
pub fn parse(text: &str) -> Option<Mark> {
    let letters: String = text.chars().filter(|c| !c.is_whitespace() && *c != '_').collect();
    let (event, rest) = match letters.get(..2).and_then(Event::of) {
        Some(event) => (Some(event), &letters[2..]),
        None => (None, letters.as_str()),
    };
    let (qualifier, interlock) = match instruction(rest) {
        Some(qualifier) => (qualifier, false),
        None => (instruction(rest.strip_suffix(['C', 'c'])?)?, true),
    };
    Some(Mark { event, qualifier, interlock })
}

fn instruction(letters: &str) -> Option<Qualifier> {
    if letters.eq_ignore_ascii_case("CALL") { Some(Qualifier::N) } else { Qualifier::of(letters) }
}

/// Whether an instruction needs an event before it.
pub fn needs_event(instruction: &str) -> bool {
    const NEED: [&str; 10] = ["ON", "OFF", "CS", "CU", "CD", "CR", "TL", "TD", "TR", "TF"];
    NEED.iter().any(|own| own.eq_ignore_ascii_case(instruction))
}

/// What to write instead of a qualifier that GRAPH does not have.
pub fn help(text: &str) -> String {
    let words: Vec<&str> = text.split([' ', '_', '\t']).filter(|word| !word.is_empty()).collect();
    if let [instruction, event] = words.as_slice()
        && Event::of(event).is_some()
        && parse(instruction).is_some()
    {
        return format!("write `({event} {instruction})`: the event comes first");
    }
    if let [event] = words.as_slice()
        && Event::of(event).is_some()
    {
        return format!("write the instruction after the event, such as `({}_N)`", event.to_ascii_uppercase());
    }
    if let [instruction, time] = words.as_slice()
        && ["D", "L"].iter().any(|known| known.eq_ignore_ascii_case(instruction))
        && time.starts_with(|c: char| c.is_ascii_digit())
    {
        let (instruction, time) = (instruction.to_ascii_uppercase(), time.to_ascii_uppercase());
        return format!("write the time after the operand, as in `Q4.0 := T#{time} ({instruction})`");
    }
    let help = match text.trim().to_ascii_uppercase().as_str() {
        "" => "write a qualifier such as `(N)`, `(S)`, `(R)`, `(D)` or `(S1_CU)` after the operand",
        "C" => {
            "C marks the interlock and follows an instruction, as in `NC`; counters are written `CS`, `CU`, `CD` and `CR`"
        }
        "P" | "P1" | "P0" => {
            "write `S1_N` for an action that runs once when the step is entered, `S0_N` for one that runs when it is left"
        }
        "SD" | "DS" | "SL" => "set the operand in a separate step after a transition that waits, or use `D` or `L`",
        "SET" => "write `(S)`",
        "RESET" | "RST" | "RES" => "write `(R)`",
        _ => {
            "qualifiers are N, S, R, D, L, CALL, ON, OFF, CS, CU, CD, CR, TL, TD, TR and TF; an event such as `S1_` may come before it, and C after it"
        }
    };
    help.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn qualifiers_with_events_and_interlocks_are_read() {
        let mark = |event, qualifier, interlock| Some(Mark { event, qualifier, interlock });
        for (text, wanted) in [
            ("N", mark(None, Qualifier::N, false)),
            ("nc", mark(None, Qualifier::N, true)),
            ("S1_N", mark(Some(Event::S1), Qualifier::N, false)),
            ("S1 NC", mark(Some(Event::S1), Qualifier::N, true)),
            ("S1CU", mark(Some(Event::S1), Qualifier::Cu, false)),
            ("CD", mark(None, Qualifier::Cd, false)),
            ("CDC", mark(None, Qualifier::Cd, true)),
            ("CSC", mark(None, Qualifier::Cs, true)),
            ("CALL", mark(None, Qualifier::N, false)),
            ("CALLC", mark(None, Qualifier::N, true)),
            ("V1_OFF", mark(Some(Event::V1), Qualifier::Off, false)),
            ("L1_R", mark(Some(Event::L1), Qualifier::R, false)),
            ("LC", mark(None, Qualifier::L, true)),
            ("C", None),
            ("S1", None),
            ("SD", None),
            ("S1_", None),
            ("", None),
            ("ä1", None),
        ] {
            assert_eq!(parse(text), wanted, "{text}");
        }
    }
}
