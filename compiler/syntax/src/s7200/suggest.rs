//! Messages for words that are not an instruction.

use plcc_diag::{Code, Diagnostic, Span};

use super::{address, aliases, mnemonics};
use crate::ast::Width;
use crate::distance;
use crate::scl::keyword::is_statement_word;
use crate::stl::{self, Mnemonics};

/// Instructions of S7-300/400, and what the S7-200 has for them.
const FROM_S7_300: &[(&str, &str)] = &[
    ("L", "the S7-200 has no ACCU to load: `MOVB`, `MOVW`, `MOVD` or `MOVR` moves a value"),
    ("T", "the S7-200 has no ACCU to transfer: `MOVB`, `MOVW`, `MOVD` or `MOVR` moves a value"),
    ("X", "write it with `LDN`, `A`, `OLD`, or `XORB`, `XORW` for values"),
    ("XN", "write it with `LDN`, `A`, `OLD`, or `XORB`, `XORW` for values"),
    ("FP", "write `EU` after the string of logic"),
    ("FN", "write `ED` after the string of logic"),
    ("SE", "write `TON T37, 50`"),
    ("SD", "write `TON T37, 50`"),
    ("SS", "write `TONR T5, 50`"),
    ("SF", "write `TOF T37, 50`"),
    ("SA", "write `TOF T37, 50`"),
    ("SP", "write `TON`, with the logic of the pulse"),
    ("SV", "write `TON`, with the logic of the pulse"),
    ("CU", "write `CTU C1, 10`"),
    ("CD", "write `CTD C1, 10`"),
    ("ZV", "write `CTU C1, 10`"),
    ("ZR", "write `CTD C1, 10`"),
    ("JU", "write `LD SM0.0` and `JMP` with the number of the label"),
    ("SPA", "write `LD SM0.0` and `JMP` with the number of the label"),
    ("JC", "write `JMP 3`, which is conditional"),
    ("SPB", "write `JMP 3`, which is conditional"),
    ("UC", "write `LD SM0.0` and `CALL name`"),
    ("CC", "write `CALL name`, which is conditional"),
    ("BE", "the end of a block is `END_SUBROUTINE_BLOCK`"),
    ("BEU", "write `CRET` after `LD SM0.0`"),
    ("BEA", "write `CRET` after `LD SM0.0`"),
    ("BEC", "write `CRET`, which is conditional"),
    ("BEB", "write `CRET`, which is conditional"),
    ("OPN", "the S7-200 has one data block and does not open it: write `VW100`"),
    ("AUF", "the S7-200 has one data block and does not open it: write `VW100`"),
    ("SET", "write `S` with the first bit and the number of bits; `LD SM0.0` begins a network that always runs"),
    ("CLR", "write `R` with the first bit and the number of bits; `LDN SM0.0` is always 0"),
    ("JCN", "write `NOT`, then `JMP 3`, which is conditional"),
    ("SPBN", "write `NOT`, then `JMP 3`, which is conditional"),
    ("JZ", "compare with a contact such as `LDW= VW0, 0`, then write `JMP 3`"),
    ("JN", "compare with a contact such as `LDW<> VW0, 0`, then write `JMP 3`"),
    ("JP", "compare with a contact such as `LDW> VW0, 0`, then write `JMP 3`"),
    ("JM", "compare with a contact such as `LDW< VW0, 0`, then write `JMP 3`"),
    ("SPZ", "compare with a contact such as `LDW= VW0, 0`, then write `JMP 3`"),
    ("SPN", "compare with a contact such as `LDW<> VW0, 0`, then write `JMP 3`"),
    ("SPP", "compare with a contact such as `LDW> VW0, 0`, then write `JMP 3`"),
    ("SPM", "compare with a contact such as `LDW< VW0, 0`, then write `JMP 3`"),
    ("LOOP", "write `FOR` and `NEXT`"),
    ("AW", "write `ANDW`; a comparison includes its relation: `AW>= VW0, 5`"),
    ("UW", "write `ANDW`; a comparison includes its relation: `UW>= VW0, 5`"),
    ("OW", "write `ORW`; a comparison includes its relation: `OW>= VW0, 5`"),
    ("XOW", "write `XORW`"),
    ("AD", "write `ANDD`; a comparison includes its relation: `AD>= VD0, 5`"),
    ("UD", "write `ANDD`; a comparison includes its relation: `UD>= VD0, 5`"),
    ("OD", "write `ORD`; a comparison includes its relation: `OD>= VD0, 5`"),
    ("XOD", "write `XORD`"),
    ("MOD", "write `DIV`: the first word of its result is the remainder"),
    ("RND", "write `ROUND`"),
    ("INVI", "write `INVW`"),
    ("NEGI", "write `INVW`, then `INCW`"),
    ("NEGD", "write `INVD`, then `INCD`"),
    ("NEGR", "write `*R -1.0` and the operand"),
    ("ABS", "compare with a contact such as `LDR< VD0, 0.0`, then write `*R -1.0, VD0`"),
    ("LAR1", "a pointer is in a double word or in AC1 to AC3: write `MOVD &VB0, AC1`, then use `*AC1`"),
    ("LAR2", "a pointer is in a double word or in AC1 to AC3: write `MOVD &VB0, AC1`, then use `*AC1`"),
];

/// Names of instructions on other controllers, and frequent typing errors.
const SLIPS: &[(&str, &str)] = &[
    ("AND", "write `A` for a bit, `ANDB`, `ANDW` or `ANDD` for values"),
    ("OR", "write `O` for a bit, `ORB`, `ORW` or `ORD` for values"),
    ("XOR", "write `XORB`, `XORW` or `XORD`"),
    ("LDR", "a comparison includes its relation: `LDR>= VD0, 1.5`; a bit is loaded with `LD`"),
    ("MOV", "write `MOVB`, `MOVW`, `MOVD` or `MOVR`"),
    ("MOVE", "write `MOVB`, `MOVW`, `MOVD` or `MOVR`"),
    ("OUT", "write `=`"),
    ("==", "write `=`"),
    ("STP", "write `STOP`"),
    ("EDGE", "write `EU` for a rising edge, `ED` for a falling one"),
    ("P", "write `EU` after the contact for its rising edge"),
    ("N", "write `ED` after the contact for its falling edge"),
    ("XIC", "write `LD` for the first contact of a path, `A` for the next ones"),
    ("XIO", "write `LDN` for the first contact of a path, `AN` for the next ones"),
    ("OTE", "write `=`"),
    ("OTL", "write `S`, with the number of bits: `S Q0.0, 1`"),
    ("OTU", "write `R` with the first bit and the number of bits"),
    ("ANDN", "write `AN`"),
    ("ORN", "write `ON`"),
    ("ST", "write `=` for a bit, `MOVW` for a value"),
    ("TP", "the S7-200 has no pulse timer in STL; write `TON` with the logic of the pulse"),
    ("ADD", "write `+I`, `+D` or `+R`"),
    ("SUB", "write `-I`, `-D` or `-R`"),
    ("ADDI", "write `+I`"),
    ("ADDD", "write `+D`"),
    ("ADDR", "write `+R`"),
    ("SUBI", "write `-I`"),
    ("SUBD", "write `-D`"),
    ("SUBR", "write `-R`"),
    ("MULI", "write `*I`"),
    ("MULD", "write `*D`"),
    ("MULR", "write `*R`"),
    ("DIVI", "write `/I`"),
    ("DIVD", "write `/D`"),
    ("DIVR", "write `/R`"),
    ("INC", "write `INCB`, `INCW` or `INCD`"),
    ("DEC", "write `DECB`, `DECW` or `DECD`"),
    ("FND", "write the relation after it: `FND=`, `FND<>`, `FND<` or `FND>`"),
    ("GET", "only the S7-200 SMART has it; write `NETR`"),
    ("PUT", "only the S7-200 SMART has it; write `NETW`"),
    ("TITEL", "write `TITLE=`"),
    ("LDB", "write the relation after it: `LDB=`, `LDB<>`, `LDB<`, `LDB>`, `LDB<=` or `LDB>=`"),
    ("LDW", "write the relation after it: `LDW=`, `LDW<>`, `LDW<`, `LDW>`, `LDW<=` or `LDW>=`"),
    ("LDD", "write the relation after it: `LDD=`, `LDD<>`, `LDD<`, `LDD>`, `LDD<=` or `LDD>=`"),
    ("LDP", "write `LD` with the operand, then `EU` for its rising edge"),
    ("LDF", "write `LD` with the operand, then `ED` for its falling edge"),
    ("RST", "write `R` with the first bit and the number of bits"),
    ("RES", "write `R` with the first bit and the number of bits"),
    ("RESET", "write `R` with the first bit and the number of bits"),
    ("MOVI", "write `MOVW`"),
    ("MOVDW", "write `MOVD`"),
    ("BMOVB", "write `BMB`"),
    ("BMOVW", "write `BMW`"),
    ("BMOVD", "write `BMD`"),
    ("BLKMOVB", "write `BMB`"),
    ("BLKMOVW", "write `BMW`"),
    ("BLKMOVD", "write `BMD`"),
    ("INCI", "write `INCW`"),
    ("DECI", "write `DECW`"),
    ("ITR", "write `ITD`, then `DTR`"),
    ("WTR", "write `ITD`, then `DTR`"),
    ("RTI", "write `ROUND` or `TRUNC`, then `DTI`"),
    ("RTD", "write `ROUND` or `TRUNC`"),
    ("BTW", "write `BTI`"),
    ("WTB", "write `ITB`"),
    ("WTD", "write `ITD`"),
    ("DTW", "write `DTI`"),
    ("WDT", "write `WDR`"),
    ("WDTR", "write `WDR`"),
    ("BCD", "write `IBCD`, which makes BCD digits, or `BCDI`, which reads them"),
    ("SCALE", "the S7-200 has no instruction for it: calculate with `ITD`, `DTR`, `-R`, `*R` and `/R`"),
    ("JMPC", "write `JMP`, which is conditional"),
    ("JMPCN", "write `NOT`, then `JMP`, which is conditional"),
    ("RETC", "write `CRET`"),
    ("CALC", "write `CALL`, which is conditional"),
    ("SHL", "write `SLB`, `SLW` or `SLD`"),
    ("SHR", "write `SRB`, `SRW` or `SRD`"),
    ("ROL", "write `RLB`, `RLW` or `RLD`"),
    ("ROR", "write `RRB`, `RRW` or `RRD`"),
    ("NEG", "write `INVW`, then `INCW`; for a REAL write `*R -1.0` and the operand"),
    ("CMP", "write a contact that compares, such as `LDW>= VW0, 5`"),
    ("DMOV", "write `MOVD`"),
    ("FMOV", "write `FILL`"),
];

/// The message for `word` (upper case; `text` as written), which begins a statement and is not a mnemonic. `alone`: no operand
/// follows it without a comma.
pub fn unknown(span: Span, word: &str, text: &str, alone: bool, set: Mnemonics) -> Diagnostic {
    if let Some((_, help)) = FROM_S7_300.iter().find(|(known, _)| *known == word) {
        return from_s7_300(span, text).help(*help);
    }
    if is_statement_word(word) {
        return Diagnostic::new(Code::ForeignLanguage, span, format!("`{text}` begins a statement of SCL"))
            .label("the S7-200 has STL only")
            .help("write contacts and coils, as `LD I0.0` and `= Q0.0`; `JMP 1` and `LBL 1` replace IF");
    }
    if let Some(Ok(place)) = address::parse(word) {
        let statement = match place.width {
            Some(Width::Bit) => format!("write `= {text}` after the contacts that give its value"),
            Some(Width::Byte) => format!("`MOVB VB0, {text}` moves a value"),
            Some(Width::Word) => format!("`MOVW VW0, {text}` moves a value"),
            Some(Width::Dword | Width::Lword) => format!("`MOVD VD0, {text}` moves a value"),
            None => "`LD I0.0`, `MOVW VW0, VW2`".to_owned(),
        };
        return Diagnostic::new(Code::Syntax, span, format!("`{text}` cannot begin a statement"))
            .label("an address")
            .help(format!("a statement begins with an instruction: {statement}"));
    }
    let diagnostic = Diagnostic::new(Code::UnknownInstruction, span, format!("the S7-200 has no instruction `{text}`"));
    if let Some(statement) = aliases::statement_of_box(word) {
        return diagnostic
            .label("the name of a box")
            .help(format!("write the statement `{statement}`; its operands have another order"));
    }
    if let Some((_, help)) = SLIPS.iter().find(|(slip, _)| *slip == word) {
        return diagnostic.label("not a mnemonic").help(*help);
    }
    if let Some(written) = word_comparison(word) {
        return diagnostic.label("not a mnemonic").help(format!("write `{written}`, which compares words"));
    }
    if word.strip_prefix(['B', 'W', 'D', 'R']).is_some_and(is_relation) {
        let help = format!("write `LD{word}` for the first contact of a path, `A{word}` for the next ones");
        return diagnostic.label("not a mnemonic").help(help);
    }
    if let Some(at) = glued(word).filter(|_| alone) {
        let (mnemonic, operand) = text.split_at_checked(at).unwrap_or((text, ""));
        return diagnostic
            .label("mnemonic and operand in one word")
            .help(format!("write a blank between them: `{mnemonic} {operand}`"));
    }
    if stl::is_mnemonic(word) {
        return from_s7_300(span, text).help("see the instruction set of the S7-200");
    }
    match nearest(word, set) {
        Some(mnemonic) => diagnostic.label("not a mnemonic").help(format!("did you mean `{mnemonic}`?")),
        None => diagnostic
            .label("not a mnemonic")
            .help("a statement is a mnemonic and its operands: `LD I0.0`, `MOVW VW0, VW2`"),
    }
}

fn from_s7_300(span: Span, text: &str) -> Diagnostic {
    Diagnostic::new(Code::UnknownInstruction, span, format!("`{text}` is an instruction of S7-300/400"))
        .label("the S7-200 does not have it")
}

/// `LDI=` for `LDW=`: a comparison of words as other controllers name it.
fn word_comparison(word: &str) -> Option<String> {
    let (letters, sign) = word.split_at(word.find(['=', '<', '>'])?);
    let load = letters.strip_suffix('I').filter(|load| matches!(*load, "LD" | "A" | "O"))?;
    is_relation(sign).then(|| format!("{load}W{sign}"))
}

fn is_relation(sign: &str) -> bool {
    matches!(sign, "=" | "<>" | ">" | "<" | ">=" | "<=")
}

/// Where the mnemonic ends in `LDI0.0`.
fn glued(word: &str) -> Option<usize> {
    (1..word.len()).rev().find(|at| {
        word.split_at_checked(*at).is_some_and(|(mnemonic, operand)| {
            mnemonics::any(mnemonic, Mnemonics::En).is_some() && address::parse(operand).is_some_and(|it| it.is_ok())
        })
    })
}

/// The mnemonic that differs least, of words with three letters or more; one with another first letter does something else.
fn nearest(word: &str, set: Mnemonics) -> Option<String> {
    let length = word.chars().count();
    if !(3..=12).contains(&length) {
        return None;
    }
    let limit = if length < 5 { 1 } else { 2 };
    mnemonics::all()
        .map(|insn| insn.mnemonic(set).into_owned())
        .filter(|mnemonic| length > 4 || mnemonic.chars().next() == word.chars().next())
        .map(|mnemonic| (distance::between(word, &mnemonic), mnemonic))
        .filter(|(distance, _)| *distance <= limit)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, mnemonic)| mnemonic)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn help(word: &str) -> String {
        unknown(Span::default(), word, word, true, Mnemonics::En).help.unwrap_or_default()
    }

    #[test]
    fn hints() {
        assert!(help("MOWB").contains("`MOVB`"));
        assert!(help("LDI0.0").contains("`LD I0.0`"));
        assert!(help("L").contains("MOVW"));
        assert!(help("ADD_I").contains("`+I IN, OUT`"));
        assert!(help("LDW==").contains("`LDW="));
        assert!(help("QWERTZ").contains("a statement is"));
        assert!(help("LDP").contains("`EU`"));
        assert!(help("RST").contains("`R` with"));
        assert!(unknown(Span::default(), "TAK", "TAK", true, Mnemonics::En).title.contains("S7-300"));
    }
}
