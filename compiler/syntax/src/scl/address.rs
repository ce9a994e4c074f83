//! Absolute addresses, with the letters of both mnemonic sets.

use plcc_diag::Span;

use crate::ast::{Area, BlockName, BlockPrefix, CellKind, OperandKind, Width};

/// Letters of areas without the width, longer ones first.
const AREAS: [(&str, Area); 8] = [
    ("PI", Area::Pi),
    ("PE", Area::Pi),
    ("PQ", Area::Pq),
    ("PA", Area::Pq),
    ("I", Area::I),
    ("E", Area::I),
    ("Q", Area::Q),
    ("A", Area::Q),
];

/// Prefixes of block numbers.
const BLOCKS: [(&str, BlockPrefix); 8] = [
    ("OB", BlockPrefix::Ob),
    ("FC", BlockPrefix::Fc),
    ("FB", BlockPrefix::Fb),
    ("SFC", BlockPrefix::Sfc),
    ("SFB", BlockPrefix::Sfb),
    ("DB", BlockPrefix::Db),
    ("DI", BlockPrefix::Di),
    ("UDT", BlockPrefix::Udt),
];

/// The operand that a bare word names, in both spellings: `MW10`, `EB4`, `PIW256`, `T5`, `Z3`; `DB10` and `FB2` are blocks. `area_word`
/// handles `MW` alone.
pub fn absolute(word: &str) -> Option<OperandKind> {
    let (letters, number) = letters_and_number(word)?;
    if let Some(prefix) = block_prefix(letters) {
        return Some(OperandKind::Block(BlockName::Numbered { prefix, number, span: Span::default() }));
    }
    if letters.eq_ignore_ascii_case("T") {
        return Some(OperandKind::Cell { kind: CellKind::Timer, number });
    }
    if letters.eq_ignore_ascii_case("C") || letters.eq_ignore_ascii_case("Z") {
        return Some(OperandKind::Cell { kind: CellKind::Counter, number });
    }
    match area_word(letters)? {
        (_, Width::Bit) => None,
        (area, width) => Some(OperandKind::Absolute { area, width, byte: number, bit: 0 }),
    }
}

/// Area and width that a word without number names, as in `MW[i]`, `M[b, i]`, `PIW[i]`, `EB[i]`.
pub fn area_word(word: &str) -> Option<(Area, Width)> {
    let strip = |letters: &str| {
        word.get(..letters.len()).filter(|head| head.eq_ignore_ascii_case(letters)).map(|_| &word[letters.len()..])
    };
    let (area, rest) =
        AREAS.iter().chain(&[("M", Area::M)]).find_map(|(letters, area)| strip(letters).map(|rest| (*area, rest)))?;
    let width = match rest.as_bytes() {
        [] | [b'X' | b'x'] if !matches!(area, Area::Pi | Area::Pq) => Width::Bit,
        [b'B' | b'b'] => Width::Byte,
        [b'W' | b'w'] => Width::Word,
        [b'D' | b'd'] => Width::Dword,
        _ => return None,
    };
    Some((area, width))
}

/// Width and byte of a word after `DB10.`: `DW4`, `DBW4`, `DB7` (a byte), `DD0`; not a bit, which is one token with its point.
pub fn db_address(word: &str) -> Option<(Width, u32)> {
    let (letters, byte) = letters_and_number(word)?;
    match db_area_word(letters)? {
        Width::Bit => None,
        width => Some((width, byte)),
    }
}

/// Width that a word without number after `DB10.` names, as in `DB10.DW[i]`, `DB10.DX[b, i]`, `DB10.D[b, i]`, `DB10.DB[i]`.
pub fn db_area_word(word: &str) -> Option<Width> {
    const WORDS: [(&str, Width); 9] = [
        ("D", Width::Bit),
        ("DX", Width::Bit),
        ("DBX", Width::Bit),
        ("DB", Width::Byte),
        ("DBB", Width::Byte),
        ("DW", Width::Word),
        ("DBW", Width::Word),
        ("DD", Width::Dword),
        ("DBD", Width::Dword),
    ];
    WORDS.iter().find(|(letters, _)| letters.eq_ignore_ascii_case(word)).map(|(_, width)| *width)
}

/// The prefix of a block number.
pub fn block_prefix(letters: &str) -> Option<BlockPrefix> {
    BLOCKS.iter().find(|(known, _)| known.eq_ignore_ascii_case(letters)).map(|(_, prefix)| *prefix)
}

/// `FC10`
pub fn numbered_block(word: &str) -> Option<(BlockPrefix, u32)> {
    let (letters, number) = letters_and_number(word)?;
    Some((block_prefix(letters)?, number))
}

/// The address that a bit number above 7 means, `M2.0` for `M1.8`; otherwise none.
pub fn with_carried_bit(text: &str) -> Option<String> {
    let (before, bit) = text.rsplit_once('.')?;
    let bit: u32 = bit.trim().parse().ok().filter(|bit| (8..=999).contains(bit))?;
    let digits = before.bytes().rev().take_while(u8::is_ascii_digit).count();
    let (letters, byte) = before.split_at(before.len() - digits);
    let byte: u32 = byte.parse().ok().filter(|byte| *byte < 65_000)?;
    Some(format!("{letters}{}.{}", byte + bit / 8, bit % 8))
}

/// An address of more than a bit that has the number of a bit: `%MW10.3`.
pub struct Numbered<'t> {
    /// `%MW10`
    pub whole: &'t str,
    pub width: Width,
    pub byte: u32,
    pub number: u32,
    /// The bit of the first byte: `%M10.3`.
    pub bit: String,
}

/// The parts of an address of more than a bit that has the number of a bit; otherwise none.
pub fn numbered(text: &str) -> Option<Numbered<'_>> {
    let (whole, number) = text.rsplit_once('.')?;
    let number = number.parse().ok()?;
    let start = whole.rfind(['.', '%']).map_or(0, |sign| sign + 1);
    let (block, word) = whole.split_at(start);
    let (letters, byte) = letters_and_number(word)?;
    let (width, of_bit) = match area_word(letters) {
        Some((Area::Pi | Area::Pq, _)) => return None,
        Some((_, width)) => (width, &letters[..letters.len() - 1]),
        None if block.ends_with('.') => (db_area_word(letters)?, "DBX"),
        None => return None,
    };
    (width != Width::Bit).then(|| Numbered {
        whole,
        width,
        byte,
        number,
        bit: format!("{block}{of_bit}{byte}.{number}"),
    })
}

/// The operand of an address token: `I0.0`, `%MW10`, `%DB1.DBX1.0`, `%IW4:P`, `DX0.7` after a point.
pub fn token(text: &str, span: Span) -> Option<OperandKind> {
    let text = text.strip_prefix('%').unwrap_or(text);
    let (text, peripheral) = match text.strip_suffix(['P', 'p']).and_then(|text| text.strip_suffix(':')) {
        Some(text) => (text, true),
        None => (text, false),
    };
    let mut parts = text.split('.');
    let (first, second, third) = (parts.next()?, parts.next(), parts.next());
    let operand = match (second, third) {
        (None, _) => match db_address(first) {
            Some((width, byte)) if numbered_block(first).is_none() => {
                OperandKind::Absolute { area: Area::Db, width, byte, bit: 0 }
            }
            _ => absolute(first)?,
        },
        (Some(bit), None) if bit.bytes().all(|byte| byte.is_ascii_digit()) => {
            let (letters, byte) = letters_and_number(first)?;
            let area = match area_word(letters) {
                Some((area, Width::Bit)) => area,
                Some(_) => return None,
                None if db_area_word(letters) == Some(Width::Bit) => Area::Db,
                None => return None,
            };
            OperandKind::Absolute { area, width: Width::Bit, byte, bit: bit_number(bit)? }
        }
        (Some(address), bit) => {
            let (BlockPrefix::Db, number) = numbered_block(first)? else { return None };
            let db = BlockName::Numbered { prefix: BlockPrefix::Db, number, span };
            let (letters, byte) = letters_and_number(address)?;
            match (db_area_word(letters)?, bit) {
                (Width::Bit, Some(bit)) => {
                    OperandKind::DbAbsolute { db, width: Width::Bit, byte, bit: bit_number(bit)? }
                }
                (Width::Bit, None) | (_, Some(_)) => return None,
                (width, None) => OperandKind::DbAbsolute { db, width, byte, bit: 0 },
            }
        }
    };
    if !peripheral {
        return Some(operand);
    }
    match operand {
        OperandKind::Absolute { area: Area::I, width, byte, bit } => {
            Some(OperandKind::Absolute { area: Area::Pi, width, byte, bit })
        }
        OperandKind::Absolute { area: Area::Q, width, byte, bit } => {
            Some(OperandKind::Absolute { area: Area::Pq, width, byte, bit })
        }
        _ => None,
    }
}

/// `%X3`
pub fn slice(text: &str) -> Option<(Width, u32)> {
    let width = match text.as_bytes().get(1)? {
        b'X' | b'x' => Width::Bit,
        b'B' | b'b' => Width::Byte,
        b'W' | b'w' => Width::Word,
        _ => Width::Dword,
    };
    Some((width, text.get(2..)?.parse().ok()?))
}

fn bit_number(digits: &str) -> Option<u8> {
    digits.parse().ok().filter(|bit| *bit < 8)
}

/// `MW10` as `MW` and 10.
fn letters_and_number(word: &str) -> Option<(&str, u32)> {
    let letters = word.trim_end_matches(|c: char| c.is_ascii_digit());
    let digits = &word[letters.len()..];
    // A number that is too large for every area is still an address.
    (!digits.is_empty() && !letters.is_empty()).then(|| (letters, digits.parse().unwrap_or(u32::MAX)))
}
