//! Words of STL: finds the instruction, area or register that a word names, and the mnemonic set of a file.

use std::collections::HashMap;
use std::sync::LazyLock;

use crate::ast::{AddressRegister, Area, BlockPrefix, CellKind, SpecialRegister, StatusOperand, Width};
use crate::stl::raw::{RawKind, RawText, RawToken};
use crate::stl::{Mnemonics, StlInsn};

/// A word in upper case without allocating; longer words are not keywords and stay empty.
#[derive(Clone, Copy)]
pub struct Upper {
    bytes: [u8; Upper::CAPACITY],
    length: usize,
}

impl Upper {
    const CAPACITY: usize = 24;

    pub fn new(word: &str) -> Upper {
        let mut bytes = [0; Upper::CAPACITY];
        if word.len() > Upper::CAPACITY || !word.is_ascii() {
            return Upper { bytes, length: 0 };
        }
        bytes[..word.len()].copy_from_slice(word.as_bytes());
        bytes.make_ascii_uppercase();
        Upper { bytes, length: word.len() }
    }

    pub fn as_str(&self) -> &str {
        std::str::from_utf8(&self.bytes[..self.length]).expect("only ASCII is copied")
    }
}

type Table = HashMap<&'static str, StlInsn>;

static TABLES: LazyLock<[Table; 2]> = LazyLock::new(|| {
    [Mnemonics::En, Mnemonics::De].map(|set| StlInsn::ALL.iter().map(|insn| (insn.mnemonic(set), *insn)).collect())
});

/// The instruction that `mnemonic` (upper case, with its signs: `A(`, `+I`) names in `set`.
pub fn instruction(mnemonic: &str, set: Mnemonics) -> Option<StlInsn> {
    TABLES[set as usize].get(mnemonic).copied()
}

pub fn other(set: Mnemonics) -> Mnemonics {
    match set {
        Mnemonics::En => Mnemonics::De,
        Mnemonics::De => Mnemonics::En,
    }
}

/// Area letters of both sets; the last column is their set.
const AREAS: &[(&str, Area, Option<Mnemonics>)] = &[
    ("I", Area::I, Some(Mnemonics::En)),
    ("E", Area::I, Some(Mnemonics::De)),
    ("Q", Area::Q, Some(Mnemonics::En)),
    ("A", Area::Q, Some(Mnemonics::De)),
    ("M", Area::M, None),
    ("L", Area::L, None),
    ("PI", Area::Pi, Some(Mnemonics::En)),
    ("PE", Area::Pi, Some(Mnemonics::De)),
    ("PQ", Area::Pq, Some(Mnemonics::En)),
    ("PA", Area::Pq, Some(Mnemonics::De)),
    ("DB", Area::Db, None),
    ("DI", Area::Di, None),
];

/// Area and width of letters such as `IW`, `DBX`, `PEW`; `set` `None`: of both sets.
pub fn area(letters: &str, set: Option<Mnemonics>) -> Option<(Area, Width)> {
    // Not longer than `PIW`, and only letters: most words end here.
    if letters.is_empty() || letters.len() > 3 {
        return None;
    }
    let found = |name: &str| {
        AREAS
            .iter()
            .find(|(known, _, own)| *known == name && (set.is_none() || own.is_none() || *own == set))
            .map(|(_, area, _)| *area)
    };
    if let Some(area @ (Area::I | Area::Q | Area::M | Area::L)) = found(letters) {
        return Some((area, Width::Bit));
    }
    let (name, width) = letters.split_at(letters.len() - 1);
    let area = found(name)?;
    match width {
        "X" if matches!(area, Area::Db | Area::Di) => Some((area, Width::Bit)),
        "B" => Some((area, Width::Byte)),
        "W" => Some((area, Width::Word)),
        "D" => Some((area, Width::Dword)),
        _ => None,
    }
}

/// The letters of an area and width in `set`.
pub fn letters(area: Area, width: Width, set: Mnemonics) -> Option<String> {
    let (name, ..) = AREAS.iter().find(|(_, known, own)| *known == area && own.is_none_or(|own| own == set))?;
    let suffix = match width {
        Width::Bit if matches!(area, Area::Db | Area::Di) => "X",
        Width::Bit => "",
        Width::Byte => "B",
        Width::Word => "W",
        Width::Dword => "D",
        Width::Lword => return None,
    };
    Some(format!("{name}{suffix}"))
}

/// `T`, `C` (German `Z`).
pub fn cell(letters: &str, set: Option<Mnemonics>) -> Option<CellKind> {
    match letters {
        "T" => Some(CellKind::Timer),
        "C" if set != Some(Mnemonics::De) => Some(CellKind::Counter),
        "Z" if set != Some(Mnemonics::En) => Some(CellKind::Counter),
        _ => None,
    }
}

pub fn block_prefix(letters: &str) -> Option<BlockPrefix> {
    Some(match letters {
        "OB" => BlockPrefix::Ob,
        "FC" => BlockPrefix::Fc,
        "FB" => BlockPrefix::Fb,
        "SFC" => BlockPrefix::Sfc,
        "SFB" => BlockPrefix::Sfb,
        "DB" => BlockPrefix::Db,
        "DI" => BlockPrefix::Di,
        "UDT" => BlockPrefix::Udt,
        "VAT" => BlockPrefix::Vat,
        _ => return None,
    })
}

/// `BR` (German `BIE`), `OV`, `OS`, `UO`.
pub fn status(word: &str, set: Option<Mnemonics>) -> Option<StatusOperand> {
    match word {
        "BR" if set != Some(Mnemonics::De) => Some(StatusOperand::Br),
        "BIE" if set != Some(Mnemonics::En) => Some(StatusOperand::Br),
        "OV" => Some(StatusOperand::Ov),
        "OS" => Some(StatusOperand::Os),
        "UO" => Some(StatusOperand::Uo),
        _ => None,
    }
}

pub fn special(word: &str) -> Option<SpecialRegister> {
    match word {
        "STW" => Some(SpecialRegister::Stw),
        "DBLG" => Some(SpecialRegister::DbLength),
        "DBNO" => Some(SpecialRegister::DbNumber),
        "DILG" => Some(SpecialRegister::DiLength),
        "DINO" => Some(SpecialRegister::DiNumber),
        _ => None,
    }
}

pub fn register(word: &str) -> Option<AddressRegister> {
    match word {
        "AR1" => Some(AddressRegister::Ar1),
        "AR2" => Some(AddressRegister::Ar2),
        _ => None,
    }
}

/// Letters and the digits after them: `MW10` is `MW`, `10`. `None` if the word does not have this form.
pub fn letters_and_digits(word: &str) -> (&str, &str) {
    let letters = word.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(word.len());
    let (letters, digits) = word.split_at(letters);
    if digits.bytes().all(|byte| byte.is_ascii_digit()) { (letters, digits) } else { (word, "") }
}

/// The set of a file, and where a token of each set is.
pub struct Detected {
    pub set: Mnemonics,
    /// A word of the file shows the set.
    pub is_shown: bool,
    /// Of the set, and of the other one if the file is mixed.
    pub first: [Option<RawToken>; 2],
}

/// Finds the set from what only one set has: mnemonics, or else area letters of operands, which also decide if they are far more.
/// Without either: international.
pub fn detect(text: &str, raw: &RawText, wanted: Option<Mnemonics>) -> Detected {
    let mut counts = [0u32; 2];
    let mut first = [None; 2];
    let mut operand_counts = [0u32; 2];
    let mut addresses = [0u32; 2];
    let tokens = &raw.tokens;
    for (index, token) in tokens.iter().enumerate() {
        if token.kind != RawKind::Word || token.end - token.start > 5 {
            continue;
        }
        let before = index.checked_sub(1).map(|before| tokens[before].kind);
        let next = tokens.get(index + 1);
        let upper = Upper::new(&text[token.range()]);
        let starts_statement = token.first_on_line || matches!(before, Some(RawKind::Semicolon | RawKind::Colon));
        if starts_statement {
            if let Some(set) = set_of_mnemonic(upper.as_str(), next, tokens.get(index + 2)) {
                counts[set as usize] += 1;
                first[set as usize].get_or_insert(*token);
            }
        } else if matches!(before, Some(RawKind::Word | RawKind::Equal | RawKind::Assign | RawKind::Percent))
            && let Some(set) = set_of_operand(upper.as_str(), next)
        {
            operand_counts[set as usize] += 1;
            addresses[set as usize] += u32::from(is_address(next, tokens.get(index + 2)));
        }
    }
    let decided = if counts != [0, 0] { counts } else { operand_counts };
    let found = if decided[1] > decided[0] { Mnemonics::De } else { Mnemonics::En };
    let set = wanted.unwrap_or(if outweighed(found, counts, operand_counts, addresses) { other(found) } else { found });
    Detected { set, is_shown: decided != [0, 0], first: [first[set as usize], first[other(set) as usize]] }
}

/// Whether the addresses say that the file has the other set, and its few mnemonics of `set` are slips.
fn outweighed(set: Mnemonics, mnemonics: [u32; 2], operands: [u32; 2], addresses: [u32; 2]) -> bool {
    let (own, other) = (set as usize, other(set) as usize);
    addresses[other] > 2 * (mnemonics[own] + operands[own])
}

/// Whether the letters before `next` are an address and no name such as `I1`: `I 0.1`, `I0.1`, `IW 10`.
fn is_address(next: Option<&RawToken>, after: Option<&RawToken>) -> bool {
    let number = |token: &RawToken| !token.first_on_line && matches!(token.kind, RawKind::Number | RawKind::Real);
    next.is_some_and(|next| number(next) || next.kind == RawKind::Dot && after.is_some_and(number))
}

/// The set, if only one has the mnemonic, and if the next token can follow a mnemonic.
fn set_of_mnemonic(word: &str, next: Option<&RawToken>, after: Option<&RawToken>) -> Option<Mnemonics> {
    let set = match (instruction(word, Mnemonics::En), instruction(word, Mnemonics::De)) {
        (Some(_), None) => Mnemonics::En,
        (None, Some(_)) => Mnemonics::De,
        _ => return None,
    };
    let Some(next) = next else { return Some(set) };
    let continues = !next.first_on_line;
    let fits = match next.kind {
        RawKind::Colon
        | RawKind::Assign
        | RawKind::Comma
        | RawKind::Dot
        | RawKind::LeftBrace
        | RawKind::RightParen
        | RawKind::Number
        | RawKind::Real => !continues,
        // `A [AR1,P#0.0]` is an instruction, `U[1] := 5` is not.
        RawKind::LeftBracket => !continues || after.is_some_and(|after| after.kind == RawKind::Word),
        RawKind::Equal => !continues,
        _ => true,
    };
    fits.then_some(set)
}

/// The set, if only one has these area letters with a number after them.
fn set_of_operand(word: &str, next: Option<&RawToken>) -> Option<Mnemonics> {
    let (letters, digits) = letters_and_digits(word);
    let numbered = !digits.is_empty()
        || next.is_some_and(|next| {
            !next.first_on_line && matches!(next.kind, RawKind::Number | RawKind::Real | RawKind::LeftBracket)
        });
    if !numbered {
        return None;
    }
    match letters {
        "C" => Some(Mnemonics::En),
        "Z" => Some(Mnemonics::De),
        _ => match (area(letters, Some(Mnemonics::En)), area(letters, Some(Mnemonics::De))) {
            (Some(_), None) => Some(Mnemonics::En),
            (None, Some(_)) => Some(Mnemonics::De),
            _ => None,
        },
    }
}
