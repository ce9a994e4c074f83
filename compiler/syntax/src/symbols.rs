//! The contents of symbol tables: names for addresses, blocks and constants.

pub use plcc_abi::names::External;
use plcc_diag::Span;

use crate::ast::{Area, BlockName, BlockPrefix, CellKind, Width};
use crate::scl::ast::Expr;

/// The rows of one table.
#[derive(Clone, Debug, Default)]
pub struct SymbolTable {
    pub symbols: Vec<Symbol>,
    /// User constants of tag tables.
    pub constants: Vec<GlobalConstant>,
    /// Rows as a program for the S7-200 reads them. A row such as `I0.0` is in both lists.
    pub s7200: Vec<S7200Symbol>,
    /// Rows with a name and something else than an address.
    pub unreadable: Vec<UnreadableRow>,
}

/// The reason of a row whose quotes are not in pairs.
pub const QUOTE_MISSING: &str = "a quote is missing";
/// The reason of a row of a tag table whose address was not entered. It is a mistake only if the program uses the tag.
pub const NO_ADDRESS: &str = "its address is empty";

/// A row whose address is not understood.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnreadableRow {
    pub name: String,
    /// What is wrong with the address, as a sentence without its point.
    pub reason: String,
    /// The address that its author probably means.
    pub meant: Option<String>,
    /// The row.
    pub span: Span,
}

impl UnreadableRow {
    /// A tag whose address was not entered.
    pub fn without_address(name: String, span: Span) -> UnreadableRow {
        UnreadableRow { name, reason: NO_ADDRESS.to_string(), meant: None, span }
    }
}

/// A constant that every block can use by its name.
#[derive(Clone, Debug, PartialEq)]
pub struct GlobalConstant {
    pub name: String,
    /// As written.
    pub ty: String,
    pub value: Expr,
    pub span: Span,
}

/// A row: a name for an address.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// As written, without outer blanks.
    pub name: String,
    pub target: SymbolTarget,
    /// The data type column; empty if there is none.
    pub ty: String,
    pub comment: String,
    /// What clients may do with the tag.
    pub external: External,
    /// The row.
    pub span: Span,
}

/// What a symbol means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SymbolTarget {
    Memory { area: Area, width: Width, byte: u32, bit: u8 },
    Cell { kind: CellKind, number: u32 },
    Block { prefix: BlockPrefix, number: u32 },
}

/// A row of a table for the S7-200.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct S7200Symbol {
    /// As written, without outer blanks and quotes.
    pub name: String,
    /// As written: `VW100`, `E0.0`, `SBR3`, `16#FF`.
    pub address: String,
    pub name_span: Span,
    pub address_span: Span,
    pub comment: String,
}

/// Whether a block has a name of its own, `"Cyclic interrupt"`, rather than a number, `OB 30` or `"OB30"`.
pub fn has_own_name(name: &BlockName) -> bool {
    matches!(name, BlockName::Symbol { name, .. } if parse_address(name).is_none())
}

/// Reads an address: letters, optional blanks, a number, and for bits a point and the bit.
pub fn parse_address(text: &str) -> Option<SymbolTarget> {
    let text = text.trim();
    let text = text.strip_prefix('%').unwrap_or(text);
    let split = text.find(|letter: char| !letter.is_ascii_alphabetic())?;
    let (letters, number) = text.split_at(split);
    let letters = letters.to_ascii_uppercase();
    let number: String = number.chars().filter(|letter| !letter.is_whitespace()).collect();
    let (whole, bit) = match number.split_once('.') {
        Some((whole, bit)) => (whole, Some(bit)),
        None => (number.as_str(), None),
    };
    let digits = |text: &str| {
        (!text.is_empty() && text.len() <= 7 && text.bytes().all(|digit| digit.is_ascii_digit()))
            .then(|| text.parse::<u32>().ok())
            .flatten()
    };
    let number = digits(whole)?;
    if let Some(&(_, area, width)) = MEMORY.iter().find(|row| row.0 == letters) {
        let bit = match (width, bit) {
            (Width::Bit, Some(bit)) => digits(bit).filter(|&bit| bit < 8)? as u8,
            (Width::Bit, None) | (_, Some(_)) => return None,
            (_, None) => 0,
        };
        return Some(SymbolTarget::Memory { area, width, byte: number, bit });
    }
    if bit.is_some() {
        return None;
    }
    match letters.as_str() {
        "T" => Some(SymbolTarget::Cell { kind: CellKind::Timer, number }),
        "C" | "Z" => Some(SymbolTarget::Cell { kind: CellKind::Counter, number }),
        _ => {
            let prefix = BLOCKS.iter().find(|row| row.0 == letters)?.1;
            u16::try_from(number).ok()?;
            Some(SymbolTarget::Block { prefix, number })
        }
    }
}

/// The address that `text` means with a slip in it: `E0.0` for `E0,0`, `Q 0.0` for `Q 0.O`, `Q0.0` for `%QX0.0`.
pub fn meant_address(text: &str) -> Option<String> {
    let text = text.trim().trim_start_matches('%');
    let letters = text.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(text.len());
    let (letters, number) = text.split_at(letters);
    let number = number.replace(',', ".").replace(['O', 'o'], "0");
    let without_x = letters.strip_suffix(['X', 'x']).unwrap_or(letters);
    let meant = format!("{without_x}{number}");
    (parse_address(text).is_none() && parse_address(&meant).is_some()).then_some(meant)
}

/// Why `text`, which [`parse_address`] does not understand, is not an address.
pub fn address_fault(text: &str) -> String {
    let text = text.trim();
    let bare = text.strip_prefix('%').unwrap_or(text);
    let (letters, number) =
        bare.split_at(bare.find(|letter: char| !letter.is_ascii_alphabetic()).unwrap_or(bare.len()));
    let number: String = number.chars().filter(|letter| !letter.is_whitespace()).collect();
    let upper = letters.to_ascii_uppercase();
    let (whole, bit) = number.split_once('.').map_or((number.as_str(), None), |(whole, bit)| (whole, Some(bit)));
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|digit| digit.is_ascii_digit());
    if is_number(whole) && bit.is_none_or(is_number) {
        match (MEMORY.iter().find(|row| row.0 == upper), bit) {
            (Some((_, _, Width::Bit)), None) => {
                return format!("`{text}` is a bit without its number: `{letters} {whole}.0` to `{letters} {whole}.7`");
            }
            (Some((_, _, Width::Bit)), Some(bit)) if parse_address(&format!("{letters}{whole}.0")).is_some() => {
                return format!("a byte has the bits 0 to 7, not {bit}");
            }
            (Some((_, _, width)), Some(_)) if *width != Width::Bit => {
                return format!(
                    "`{letters}` is an access of {} bits, so it has no bit number: `{letters} {whole}`",
                    width.bits()
                );
            }
            (None, Some(_)) if matches!(upper.as_str(), "T" | "C" | "Z") => {
                return format!("timers and counters have a number alone: `{letters} {whole}`");
            }
            (None, _) if upper.starts_with("DB") && upper.len() == 3 => {
                return "a symbol table has no addresses in data blocks: their components have names".to_owned();
            }
            _ => {}
        }
    }
    match () {
        () if upper.is_empty() => format!("`{text}` is not an address: its letters are missing"),
        () if number.is_empty() => format!("`{text}` is not an address: its number is missing"),
        () if MEMORY.iter().all(|row| row.0 != upper)
            && BLOCKS.iter().all(|row| row.0 != upper)
            && upper != "T"
            && upper != "C" =>
        {
            format!("there are no addresses with `{letters}`")
        }
        () => format!("`{text}` is not an address"),
    }
}

/// Area letters of both mnemonic sets.
const MEMORY: &[(&str, Area, Width)] = &[
    ("I", Area::I, Width::Bit),
    ("IB", Area::I, Width::Byte),
    ("IW", Area::I, Width::Word),
    ("ID", Area::I, Width::Dword),
    ("E", Area::I, Width::Bit),
    ("EB", Area::I, Width::Byte),
    ("EW", Area::I, Width::Word),
    ("ED", Area::I, Width::Dword),
    ("Q", Area::Q, Width::Bit),
    ("QB", Area::Q, Width::Byte),
    ("QW", Area::Q, Width::Word),
    ("QD", Area::Q, Width::Dword),
    ("A", Area::Q, Width::Bit),
    ("AB", Area::Q, Width::Byte),
    ("AW", Area::Q, Width::Word),
    ("AD", Area::Q, Width::Dword),
    ("M", Area::M, Width::Bit),
    ("MB", Area::M, Width::Byte),
    ("MW", Area::M, Width::Word),
    ("MD", Area::M, Width::Dword),
    ("PIB", Area::Pi, Width::Byte),
    ("PIW", Area::Pi, Width::Word),
    ("PID", Area::Pi, Width::Dword),
    ("PEB", Area::Pi, Width::Byte),
    ("PEW", Area::Pi, Width::Word),
    ("PED", Area::Pi, Width::Dword),
    ("PQB", Area::Pq, Width::Byte),
    ("PQW", Area::Pq, Width::Word),
    ("PQD", Area::Pq, Width::Dword),
    ("PAB", Area::Pq, Width::Byte),
    ("PAW", Area::Pq, Width::Word),
    ("PAD", Area::Pq, Width::Dword),
];

const BLOCKS: &[(&str, BlockPrefix)] = &[
    ("OB", BlockPrefix::Ob),
    ("FB", BlockPrefix::Fb),
    ("FC", BlockPrefix::Fc),
    ("DB", BlockPrefix::Db),
    ("SFB", BlockPrefix::Sfb),
    ("SFC", BlockPrefix::Sfc),
    ("UDT", BlockPrefix::Udt),
    ("VAT", BlockPrefix::Vat),
];
