//! Mnemonics: the instruction that begins a line, and the mnemonic set of a file.

use std::collections::HashMap;
use std::sync::LazyLock;

use super::raw::{RawKind, RawToken};
use super::{Compare, Insn, address, aliases};
use crate::stl::Mnemonics;

type Table = HashMap<String, Insn>;

static TABLES: LazyLock<[Table; 2]> = LazyLock::new(|| {
    [Mnemonics::En, Mnemonics::De].map(|set| all().map(|insn| (insn.mnemonic(set).into_owned(), insn)).collect())
});

/// All instructions.
pub fn all() -> impl Iterator<Item = Insn> {
    Insn::ROWS.iter().copied().chain(Compare::all().map(Insn::Compare))
}

/// The instruction that `mnemonic` (upper case, with its signs) names in `set`.
pub fn instruction(mnemonic: &str, set: Mnemonics) -> Option<Insn> {
    match set {
        Mnemonics::En => TABLES[0].get(mnemonic).copied(),
        Mnemonics::De => TABLES[1].get(mnemonic).copied(),
    }
}

pub fn other(set: Mnemonics) -> Mnemonics {
    match set {
        Mnemonics::En => Mnemonics::De,
        Mnemonics::De => Mnemonics::En,
    }
}

/// The instruction of either set or of an alias.
pub fn any(mnemonic: &str, set: Mnemonics) -> Option<Insn> {
    instruction(mnemonic, set).or_else(|| instruction(mnemonic, other(set))).or_else(|| {
        let name = aliases::mnemonic(mnemonic)?;
        instruction(&name, set).or_else(|| instruction(&name, other(set)))
    })
}

/// The mnemonic that begins a line: in upper case, with the number of its tokens and its bytes.
pub struct Head {
    pub mnemonic: String,
    pub tokens: usize,
    pub start: usize,
    pub end: usize,
}

/// The longest mnemonic at the beginning of the tokens of a line; for an unknown word, the word with its sign.
pub fn head(text: &str, line: &[RawToken]) -> Option<Head> {
    let first = *line.first()?;
    let word = first.text(text).to_uppercase();
    let next = line.get(1).copied();
    let made = |mnemonic: String, tokens: usize, end: u32| {
        Some(Head { mnemonic, tokens, start: first.start as usize, end: end as usize })
    };
    match first.kind {
        RawKind::Word => {
            if let Some(sign) = next.filter(|next| next.kind == RawKind::Relation) {
                let signed = format!("{word}{}", sign.text(text));
                let adjacent = sign.start == first.end;
                if adjacent || any(&word, Mnemonics::En).is_none() && any(&signed, Mnemonics::En).is_some() {
                    return made(signed, 2, sign.end);
                }
            }
            made(word, 1, first.end)
        }
        RawKind::Relation | RawKind::Plus | RawKind::Minus | RawKind::Star | RawKind::Slash => {
            if let Some(letter) = next.filter(|next| next.kind == RawKind::Word && next.start == first.end) {
                let signed = format!("{word}{}", letter.text(text).to_uppercase());
                if any(&signed, Mnemonics::En).is_some() || word != "=" {
                    return made(signed, 2, letter.end);
                }
            }
            made(word, 1, first.end)
        }
        _ => None,
    }
}

/// The mnemonic set of a file, and where the first mnemonic that only this set has, and the first that only the other one has, are.
pub struct Detected {
    pub set: Mnemonics,
    pub own: Option<(usize, usize)>,
    pub foreign: Option<(usize, usize)>,
}

/// Finds the set of a file: mnemonics that only one set has decide, otherwise the area letters.
pub fn detect(text: &str, lines: &[Vec<RawToken>], wanted: Option<Mnemonics>) -> Detected {
    let mut first: [Option<(usize, usize)>; 2] = [None, None];
    let (mut mnemonics, mut areas) = ([0usize; 2], [0usize; 2]);
    let mut inside_declarations = false;
    for line in lines {
        let Some(word) = line.first().map(|token| token.text(text).to_ascii_uppercase()) else { continue };
        if word.starts_with("VAR") {
            inside_declarations = true;
        } else if word == "END_VAR" || word == "BEGIN" || word == "NETWORK" {
            inside_declarations = false;
        }
        if inside_declarations || line.get(1).is_some_and(|token| token.kind == RawKind::Colon) {
            continue;
        }
        let Some(head) = head(text, line) else { continue };
        let sets = [Mnemonics::En, Mnemonics::De].map(|set| instruction(&head.mnemonic, set).is_some());
        let only = match sets {
            [true, false] => Some(0),
            [false, true] => Some(1),
            [true, true] => None,
            [false, false] => continue,
        };
        if let Some(set) = only {
            mnemonics[set] += 1;
            first[set] = first[set].or(Some((head.start, head.end)));
        }
        for operand in line.iter().skip(head.tokens).filter(|token| token.kind == RawKind::Word) {
            match address::set_of(&operand.text(text).to_ascii_uppercase()) {
                Some(Mnemonics::En) => areas[0] += 1,
                Some(Mnemonics::De) => areas[1] += 1,
                None => {}
            }
        }
    }
    let german = match mnemonics {
        [0, 0] => areas[1] > areas[0],
        [english, german] => german > english,
    };
    let set = wanted.unwrap_or(if german { Mnemonics::De } else { Mnemonics::En });
    let [english, german] = first;
    match set {
        Mnemonics::En => Detected { set, own: english, foreign: german },
        Mnemonics::De => Detected { set, own: german, foreign: english },
    }
}
