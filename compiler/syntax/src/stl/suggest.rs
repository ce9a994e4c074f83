//! Hints for words that are not an instruction.

use crate::distance;
use crate::front::extent;
use crate::stl::mnemonics::{self, letters_and_digits, other};
use crate::stl::{Mnemonics, OperandClass, StlInsn};

/// Words that users write for an instruction of STL: mnemonics of other controllers and frequent typing errors. Helps have the
/// international mnemonics.
const KNOWN_SLIPS: &[(&str, &str)] = &[
    ("LD", "`A` begins a string of logic; `LD` belongs to S7-200"),
    ("LDN", "`AN` begins a string of logic; `LDN` belongs to S7-200"),
    ("IN", "write `A`, or `AN` for the negated operand"),
    ("AND", "write `A`"),
    ("OR", "write `O`"),
    ("XOR", "write `X`"),
    ("ST", "write `T` for a value, `=` for a bit"),
    ("OUT", "write `=`"),
    ("MOV", "write `L` and `T`"),
    ("MOVE", "write `L` and `T`"),
    ("JMP", "write `JU`"),
    ("JMPC", "write `JC`"),
    ("JMPCN", "write `JCN`"),
    ("GOTO", "write `JU`"),
    ("CAL", "write `CALL`"),
    ("RET", "write `BEU`"),
    ("RETC", "write `BEC`"),
    ("RETURN", "write `BEU`"),
    ("END", "write `BE`, or `BEU` inside a block"),
    ("TON", "write `SD`, or `CALL` the function block"),
    ("TOF", "write `SF`, or `CALL` the function block"),
    ("TP", "write `SP`, or `CALL` the function block"),
    ("CTU", "write `CU`, or `CALL` the function block"),
    ("CTD", "write `CD`, or `CALL` the function block"),
    ("LOAD", "write `L`"),
    ("STORE", "write `T`"),
    ("TRANSFER", "write `T`"),
    ("ADD", "write `+I`, `+D` or `+R`"),
    ("SUB", "write `-I`, `-D` or `-R`"),
    ("MUL", "write `*I`, `*D` or `*R`"),
    ("DIV", "write `/I`, `/D` or `/R`"),
    ("MCR", "write `MCR(` where a zone begins, `)MCR` where it ends"),
    ("TITEL", "write `TITLE =`"),
    ("CMP", "write `==I`, `<>I`, `>I`, `<I`, `>=I` or `<=I`, with D for DINT and R for REAL"),
    ("COMP", "write `==I`, `<>I`, `>I`, `<I`, `>=I` or `<=I`, with D for DINT and R for REAL"),
    ("NOP", "write `NOP 0`"),
    ("XIC", "write `A`"),
    ("XIO", "write `AN`"),
    ("OTE", "write `=`"),
    ("OTL", "write `S`"),
    ("OTU", "write `R`"),
    ("ONS", "write `FP` with an edge memory bit"),
    ("POS", "write `FP` with an edge memory bit"),
    ("R_TRIG", "write `FP` with an edge memory bit"),
    ("F_TRIG", "write `FN` with an edge memory bit"),
    ("NA", "write `AN`"),
    ("NO", "write `ON`"),
    ("XO", "write `X`"),
    ("NET", "write `NETWORK`"),
    ("END_NETWORK", "remove it: a network ends where the next one begins, or with its block"),
    ("RTO", "write `SS`, or `CALL` the function block"),
    ("JSR", "write `CALL`"),
    ("LBL", "a label ends with `:` and stands before a statement"),
    ("EQU", "write `==I`, `==D` or `==R`"),
    ("NEQ", "write `<>I`, `<>D` or `<>R`"),
    ("GRT", "write `>I`, `>D` or `>R`"),
    ("LES", "write `<I`, `<D` or `<R`"),
    ("GEQ", "write `>=I`, `>=D` or `>=R`"),
    ("LEQ", "write `<=I`, `<=D` or `<=R`"),
    ("EQ", "write `==I`, `==D` or `==R`"),
    ("NE", "write `<>I`, `<>D` or `<>R`"),
    ("GT", "write `>I`, `>D` or `>R`"),
    ("LT", "write `<I`, `<D` or `<R`"),
    ("GE", "write `>=I`, `>=D` or `>=R`"),
    ("LE", "write `<=I`, `<=D` or `<=R`"),
    ("ANDN", "write `AN`"),
    ("ORN", "write `ON`"),
    ("STN", "write `NOT` and `=`"),
    ("JE", "write `JC`, which jumps if the comparison before it is true"),
    ("JNE", "write `JCN`, which jumps if the comparison before it is false"),
    ("JNZ", "write `JN`"),
    ("SR", "write `S` and `R`, each with its conditions before it"),
    ("RS", "write `R` and `S`, each with its conditions before it"),
    ("RES", "write `R`"),
    ("RST", "write `R`"),
    ("RESET", "write `R`"),
    ("CLEAR", "write `CLR`"),
    ("SHL", "write `SLW` for a word, `SLD` for a double word"),
    ("SHR", "write `SRW` or `SRD`; with the sign `SSI` or `SSD`"),
    ("ROL", "write `RLD`"),
    ("ROR", "write `RRD`"),
    ("NEG", "write `NEGI`, `NEGD` or `NEGR`"),
    ("ITR", "write `ITD` and `DTR`"),
    ("INT_TO_REAL", "write `ITD` and `DTR`"),
    ("DINT_TO_REAL", "write `DTR`"),
    ("RTI", "write `RND`, which makes a DINT"),
    ("RTD", "write `RND`"),
    ("ROUND", "write `RND`"),
    ("SWAP", "write `CAW` for a word, `CAD` for a double word"),
    ("CALC", "write `CC`, or jump around `CALL`"),
    ("UND", "write `A`"),
    ("ODER", "write `O`"),
    ("XODER", "write `X`"),
    ("NICHT", "write `AN` or `ON` for a bit; `NOT` alone negates the RLO"),
    ("LADE", "write `L`"),
    ("LADEN", "write `L`"),
    ("SETZE", "write `S`"),
    ("SETZEN", "write `S`"),
    ("ZUW", "write `=`"),
    ("SPRINGE", "write `JU`"),
    ("SPRUNG", "write `JU`"),
    ("ASSIGN", "write `=`"),
    ("JUMP", "write `JU`"),
    ("JNC", "write `JCN`"),
    ("JEQ", "write `JC`, which jumps if the comparison before it is true"),
    ("LDP", "write `A` with the operand, then `FP` with an edge memory bit"),
    ("LDF", "write `A` with the operand, then `FN` with an edge memory bit"),
    ("EU", "write `FP` with an edge memory bit"),
    ("ED", "write `FN` with an edge memory bit"),
    ("ADDI", "write `+I`"),
    ("SUBI", "write `-I`"),
    ("MULI", "write `*I`"),
    ("DIVI", "write `/I`"),
    ("DTI", "a DINT from -32768 to 32767 has its INT in the low word already: remove this, and test the range before"),
];

/// What those words mean that have no operand: they combine accumulators.
const OF_ACCUMULATORS: &[(&str, &str)] = &[
    ("AND", "write `AW` for words, `AD` for double words"),
    ("UND", "write `AW` for words, `AD` for double words"),
    ("OR", "write `OW` for words, `OD` for double words"),
    ("ODER", "write `OW` for words, `OD` for double words"),
    ("XOR", "write `XOW` for words, `XOD` for double words"),
    ("XODER", "write `XOW` for words, `XOD` for double words"),
];

/// The label that is meant by a text with signs or blanks in it.
pub fn label(text: &str) -> String {
    text.replace(|c: char| !extent::is_word(c), "_")
}

/// The constant of STL with up to 8 hexadecimal digits; none: these are others, or more.
pub fn hexadecimal(digits: &str) -> Option<String> {
    let prefix = match digits.len() {
        1 | 2 => "B#16#",
        3 | 4 => "W#16#",
        5..=8 => "DW#16#",
        _ => return None,
    };
    digits.bytes().all(|digit| digit.is_ascii_hexdigit()).then(|| format!("{prefix}{digits}"))
}

/// Words that users write for the area of an address, with its letter in the international and the German mnemonics.
const AREA_WORDS: &[(&str, &str, &str)] = &[
    ("TIMER", "T", "T"),
    ("COUNTER", "C", "Z"),
    ("ZAEHLER", "C", "Z"),
    ("INPUT", "I", "E"),
    ("PI", "I", "E"),
    ("EINGANG", "I", "E"),
    ("OUTPUT", "Q", "A"),
    ("PQ", "Q", "A"),
    ("AUSGANG", "Q", "A"),
    ("MEMORY", "M", "M"),
    ("MEM", "M", "M"),
    ("MARKER", "M", "M"),
    ("MERKER", "M", "M"),
    ("FLAG", "M", "M"),
];

/// Analog inputs and outputs as the S7-200 has them, with their letters in the international and the German mnemonics.
const ANALOG_WORDS: &[(&str, &str, &str)] =
    &[("AIW", "PIW", "PEW"), ("AEW", "PIW", "PEW"), ("AQW", "PQW", "PAW"), ("AAW", "PQW", "PAW")];

/// What is meant by the name of an area and a number: `T 5` for `TIMER 5`, `I 0.1` for `INPUT 0.1`, `PIW 256` for `AIW 256`.
pub fn address(word: &str, number: &str, set: Mnemonics) -> Option<String> {
    if let Some((_, english, german)) = ANALOG_WORDS.iter().find(|(known, ..)| known.eq_ignore_ascii_case(word)) {
        let letters = if set == Mnemonics::De { german } else { english };
        return number.bytes().all(|digit| digit.is_ascii_digit()).then(|| format!("{letters} {number}"));
    }
    let (_, english, german) = AREA_WORDS.iter().find(|(known, ..)| known.eq_ignore_ascii_case(word))?;
    let is_cell = matches!(*english, "T" | "C");
    let is_number = |digits: &str| !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
    let fits = match number.split_once('.') {
        Some((byte, bit)) => !is_cell && is_number(byte) && matches!(bit.as_bytes(), [b'0'..=b'7']),
        None => is_cell && is_number(number),
    };
    let letter = if set == Mnemonics::De { german } else { english };
    fits.then(|| format!("{letter} {number}"))
}

/// Whether a hint for exactly this word is known (upper case).
pub fn is_known(word: &str) -> bool {
    KNOWN_SLIPS.iter().any(|(slip, _)| *slip == word)
}

/// What to write instead of `word` (upper case; `text` as written). `follows`: the rest of the statement.
pub fn instruction(word: &str, text: &str, follows: &str, set: Mnemonics) -> String {
    let of_accumulators = OF_ACCUMULATORS.iter().filter(|_| follows.is_empty());
    if let Some((_, help)) = of_accumulators.chain(KNOWN_SLIPS).find(|(slip, _)| *slip == word) {
        return in_set(help, set);
    }
    if let Some(insn) = instruction_of(word, other(set)) {
        return format!("write `{}`, as the rest of the file does", insn.mnemonic(set));
    }
    let (letters, digits) = letters_and_digits(word);
    if !digits.is_empty() && follows.is_empty() {
        let split = (1..letters.len()).rev().find(|at| instruction_of(&letters[..*at], set).is_some());
        if let Some(at) = split {
            return format!("write a blank between mnemonic and operand: `{} {}`", &text[..at], &text[at..]);
        }
    }
    if word.len() > 4 && distance::between(word, "NETWORK") <= 2 {
        return "did you mean `NETWORK`?".to_owned();
    }
    match nearest(word, follows, set).as_slice() {
        [insn] => format!("did you mean `{}`?", insn.mnemonic(set)),
        [one, .., other] => format!("write `{}`, `{}` or another instruction", one.mnemonic(set), other.mnemonic(set)),
        [] => "a statement is a mnemonic and its operand, e.g. `L MW 10`; a label ends with `:`".to_owned(),
    }
}

/// A help with the mnemonics of `set` between its backquotes.
pub fn in_set(help: &str, set: Mnemonics) -> String {
    let part = |(index, part): (usize, &str)| match instruction_of(part, Mnemonics::En).filter(|_| index % 2 == 1) {
        Some(insn) => insn.mnemonic(set).to_owned(),
        None => part.to_owned(),
    };
    help.split('`').enumerate().map(part).collect::<Vec<_>>().join("`")
}

fn instruction_of(word: &str, set: Mnemonics) -> Option<StlInsn> {
    mnemonics::instruction(word, set)
}

/// The instructions whose mnemonic differs by one letter, of words with three letters or more; those with the same letters come
/// alone. A word of three letters has the same first one. The operand must be possible: another instruction does something else.
fn nearest(word: &str, follows: &str, set: Mnemonics) -> Vec<StlInsn> {
    if word.len() < 3 {
        return Vec::new();
    }
    let letters = |word: &str| {
        let mut letters = word.as_bytes().to_vec();
        letters.sort_unstable();
        letters
    };
    let near = |insn: &StlInsn| {
        let mnemonic = insn.mnemonic(set);
        one_edit(word.as_bytes(), mnemonic.as_bytes())
            && (word.len() > 3 || word.as_bytes().first() == mnemonic.as_bytes().first())
            && is_possible(insn.operand(), follows)
    };
    let near: Vec<StlInsn> = StlInsn::ALL.iter().copied().filter(near).collect();
    let swapped: Vec<StlInsn> =
        near.iter().copied().filter(|insn| letters(insn.mnemonic(set)) == letters(word)).collect();
    if swapped.is_empty() { near } else { swapped }
}

/// Whether `follows` can be an operand of this class.
fn is_possible(class: OperandClass, follows: &str) -> bool {
    let number = follows.starts_with(|first: char| first.is_ascii_digit() || first == '-');
    match class {
        _ if follows.is_empty() => class.may_be_missing(),
        OperandClass::None => false,
        OperandClass::Byte | OperandClass::ShiftCount16 | OperandClass::ShiftCount32 => number,
        OperandClass::LoadSource | OperandClass::AddConstant => true,
        OperandClass::Label => !number && follows.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_'),
        _ => !number,
    }
}

/// Whether inserting, removing, changing or swapping one letter turns `a` into `b`.
fn one_edit(a: &[u8], b: &[u8]) -> bool {
    let same = a.iter().zip(b).take_while(|(x, y)| x == y).count();
    let (rest_a, rest_b) = (&a[same..], &b[same..]);
    match (rest_a, rest_b) {
        ([_, tail_a @ ..], [_, tail_b @ ..]) if tail_a == tail_b => true,
        ([_, tail_a @ ..], _) if tail_a == rest_b => true,
        (_, [_, tail_b @ ..]) if rest_a == tail_b => true,
        ([a1, a2, tail_a @ ..], [b1, b2, tail_b @ ..]) => a1 == b2 && a2 == b1 && tail_a == tail_b,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hints() {
        let help = |word, follows, set| instruction(word, word, follows, set);
        assert_eq!(help("UND", "E 0.1", Mnemonics::De), "write `U`");
        assert_eq!(help("UND", "I 0.1", Mnemonics::En), "write `A`");
        assert_eq!(help("JMP", "m1", Mnemonics::De), "write `SPA`");
        assert_eq!(help("AND", "", Mnemonics::En), "write `AW` for words, `AD` for double words");
        assert_eq!(help("UND", "", Mnemonics::De), "write `UW` for words, `UD` for double words");
        assert!(help("JZN", "m1", Mnemonics::En).contains("another instruction"));
        assert_eq!(help("TRUC", "", Mnemonics::En), "did you mean `TRUNC`?");
        assert!(help("INT", "", Mnemonics::En).starts_with("a statement is"));
        assert!(help("OPN1", "DB 1", Mnemonics::En).contains("OPN"));
        assert!(help("TAW1", "", Mnemonics::De).contains("`T AW1`"));
    }
}
