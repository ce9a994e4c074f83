//! Directly represented variables, `%QW1`, and where they are in the memory of the CPU.
//!
//! - CODESYS has one memory for all widths; numbers count units of the width: `%MW1` is MW 2, `%MD1` is MD 4, `%ML1` are the eight bytes
//!   from MB 8.
//! - Beremiz and OpenPLC have a separate variable for each address. Bits are at their address; the other widths too, unless they would
//!   share bytes: then the whole width moves up, by the smallest multiple of [`STEP`] bytes that fits.
//! - Addresses with more numbers than the CPU has, `%QX1.0.2`, come after all others, one after the other.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::editor::Editor;
use plcc_syntax::ast::{Area, OperandKind, Width};

/// Widths that would overlap move by multiples of this, so the numbers remain readable.
const STEP: u32 = 100;

/// Bytes of I, Q and M that every CPU of this kind of project has.
const IMAGE_BYTES: u32 = 1024;
pub const MEMORY_BYTES: u32 = 8192;

/// An address as a project writes it.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Location {
    pub area: char,
    pub width: char,
    pub path: Vec<u32>,
}

/// What follows `AT`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Read {
    At(Location),
    /// `%Q*`: the address is given elsewhere.
    Open,
    /// An address other than I, Q and M with numbers.
    Not,
}

/// A place in the memory of the CPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    pub area: Area,
    pub width: Width,
    pub byte: u32,
    pub bit: u8,
}

impl Place {
    pub fn operand(self) -> OperandKind {
        OperandKind::Absolute { area: self.area, width: self.width, byte: self.byte, bit: self.bit }
    }
}

impl Location {
    /// Reads `%QX1.0`, with or without X.
    pub fn read(text: &str) -> Read {
        let Some(text) = text.trim().strip_prefix('%') else { return Read::Not };
        let mut letters = text.chars();
        let area = letters.next().map_or(' ', |c| c.to_ascii_uppercase());
        if !matches!(area, 'I' | 'Q' | 'M') {
            return Read::Not;
        }
        let rest = letters.as_str();
        let (width, numbers) = match rest.chars().next().map(|c| c.to_ascii_uppercase()) {
            Some(c @ ('X' | 'B' | 'W' | 'D' | 'L')) => (c, &rest[1..]),
            _ => ('X', rest),
        };
        if numbers == "*" || numbers.is_empty() {
            return Read::Open;
        }
        match numbers.split('.').map(|number| number.trim().parse().ok()).collect::<Option<Vec<u32>>>() {
            Some(path) => Read::At(Location { area, width, path }),
            None => Read::Not,
        }
    }

    /// The address that `text` resembles: `%IX0.0` for `IX0.0`, `%IXX0.0` and `%EX0.0`.
    pub fn meant(text: &str) -> Option<String> {
        let text = text.trim().trim_start_matches('%').to_ascii_uppercase();
        let (letters, numbers) = text.split_at(text.find(|c: char| c.is_ascii_digit())?);
        let mut letters = letters.chars();
        let area = match letters.next()? {
            'I' | 'E' => 'I',
            'Q' | 'A' => 'Q',
            'M' => 'M',
            _ => return None,
        };
        let width = letters.find(|letter| matches!(letter, 'X' | 'B' | 'W' | 'D' | 'L')).unwrap_or('X');
        let meant = format!("%{area}{width}{numbers}");
        matches!(Location::read(&meant), Read::At(_)).then_some(meant)
    }

    /// The address that the lexer reads as one token.
    pub fn of_operand(operand: &OperandKind) -> Option<Location> {
        let OperandKind::Absolute { area, width, byte, bit } = operand else { return None };
        let area = match area {
            Area::I => 'I',
            Area::Q => 'Q',
            Area::M => 'M',
            _ => return None,
        };
        let (width, path) = match width {
            Width::Bit => ('X', vec![*byte, u32::from(*bit)]),
            Width::Byte => ('B', vec![*byte]),
            Width::Word => ('W', vec![*byte]),
            Width::Dword => ('D', vec![*byte]),
            Width::Lword => ('L', vec![*byte]),
        };
        Some(Location { area, width, path })
    }

    /// The lexer makes it an operand: a bit with byte and bit, or one number.
    pub fn is_operand(&self) -> bool {
        match self.width {
            'X' => matches!(self.path.as_slice(), [_, bit] if *bit < 8),
            'L' => false,
            _ => self.path.len() == 1,
        }
    }

    pub fn area(&self) -> Area {
        match self.area {
            'I' => Area::I,
            'Q' => Area::Q,
            _ => Area::M,
        }
    }

    pub fn width(&self) -> Width {
        match self.width {
            'X' => Width::Bit,
            'B' => Width::Byte,
            'W' => Width::Word,
            'D' => Width::Dword,
            _ => Width::Lword,
        }
    }

    /// The data type of an address without a declaration.
    pub fn type_name(&self) -> &'static str {
        match self.width {
            'X' => "BOOL",
            'B' => "BYTE",
            'W' => "WORD",
            'D' => "DWORD",
            _ => "LWORD",
        }
    }

    /// Byte and bit from the number alone; none if the number does not give them.
    fn natural(&self, editor: Editor) -> Option<(u32, u8)> {
        let bytes = self.width().bytes();
        match (self.width, self.path.as_slice()) {
            ('X', [byte, bit]) if *bit < 8 => Some((*byte, *bit as u8)),
            ('X', [byte]) if editor.separates_widths() => Some((*byte, 0)),
            ('X', [bit]) => Some((bit / 8, (bit % 8) as u8)),
            ('X', _) => None,
            (_, [number]) => number.checked_mul(bytes).map(|byte| (byte, 0)),
            _ => None,
        }
    }
}

/// Where the addresses of a project are.
#[derive(Clone, Debug, Default)]
pub struct Addresses {
    places: HashMap<Location, Place>,
    /// Widths that are not where their numbers say: area, width, bytes.
    pub moved: Vec<(char, char, u32)>,
    /// Addresses that come after the others.
    pub loose: Vec<(Location, Place)>,
}

impl Addresses {
    /// Gives each address of a project its place.
    pub fn lay_out(editor: Editor, locations: &BTreeSet<Location>) -> Addresses {
        let mut all = Addresses::default();
        for area in ['I', 'Q', 'M'] {
            all.area(editor, area, locations);
        }
        all
    }

    fn area(&mut self, editor: Editor, area: char, locations: &BTreeSet<Location>) {
        let limit = if area == 'M' { MEMORY_BYTES } else { IMAGE_BYTES };
        let mut taken: BTreeSet<u32> = BTreeSet::new();
        let mut loose: Vec<&Location> = Vec::new();
        for width in ['X', 'B', 'W', 'D', 'L'] {
            let mut natural: BTreeMap<&Location, (u32, u8)> = BTreeMap::new();
            for location in locations.iter().filter(|known| known.area == area && known.width == width) {
                match location.natural(editor) {
                    // An address that no CPU has gets another place; these addresses are only names.
                    Some((byte, _)) if editor.separates_widths() && byte >= limit => loose.push(location),
                    Some(place) => {
                        natural.insert(location, place);
                    }
                    None => loose.push(location),
                }
            }
            let Some(first) = natural.keys().next() else { continue };
            let bytes = first.width().bytes();
            let fits = |offset: u32| {
                natural.values().all(|(byte, _)| {
                    let byte = byte + offset;
                    byte + bytes <= limit && (byte..byte + bytes).all(|byte| !taken.contains(&byte))
                })
            };
            let offset = match editor.separates_widths() {
                true => {
                    let steps = (0..limit / STEP).map(|step| step * STEP);
                    let fine = (0..limit / 8).map(|step| step * 8);
                    steps.chain(fine).find(|offset| fits(*offset))
                }
                false => Some(0),
            };
            let Some(offset) = offset else {
                loose.extend(natural.keys());
                continue;
            };
            if offset > 0 {
                self.moved.push((area, width, offset));
            }
            for (location, (byte, bit)) in natural {
                let byte = byte + offset;
                taken.extend(byte..byte + bytes);
                self.insert(location, byte, bit);
            }
        }
        let mut next = taken.last().map_or(0, |last| (last + 1).next_multiple_of(8));
        let mut bits = 0;
        for location in loose {
            let (byte, bit) = if location.width == 'X' {
                if bits % 8 == 0 {
                    (bits, next) = (next * 8, next + 1);
                }
                bits += 1;
                ((bits - 1) / 8, ((bits - 1) % 8) as u8)
            } else {
                bits = 0;
                let bytes = location.width().bytes();
                let byte = next.next_multiple_of(bytes.min(2));
                next = byte + bytes;
                (byte, 0)
            };
            self.insert(location, byte, bit);
            let place = self.places[location];
            self.loose.push((location.clone(), place));
        }
    }

    fn insert(&mut self, location: &Location, byte: u32, bit: u8) {
        let place = Place { area: location.area(), width: location.width(), byte, bit };
        self.places.insert(location.clone(), place);
    }

    pub fn place(&self, location: &Location) -> Option<Place> {
        self.places.get(location).copied()
    }
}

/// All addresses in a text, with their positions.
pub fn mentioned(text: &str) -> impl Iterator<Item = (&str, usize)> {
    text.match_indices('%').filter_map(move |(at, _)| {
        let rest = &text[at + 1..];
        let letters = rest.bytes().take_while(u8::is_ascii_alphabetic).count();
        let numbers = rest[letters..].bytes().take_while(|byte| byte.is_ascii_digit() || *byte == b'.').count();
        let written = text[at..at + 1 + letters + numbers].trim_end_matches('.');
        (numbers > 0 && matches!(letters, 1 | 2)).then_some((written, at))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(editor: Editor, texts: &[&str]) -> Vec<String> {
        let read = |text: &&str| match Location::read(text) {
            Read::At(location) => location,
            other => panic!("{text}: {other:?}"),
        };
        let locations: Vec<Location> = texts.iter().map(read).collect();
        let laid = Addresses::lay_out(editor, &locations.iter().cloned().collect());
        let text = |location: &Location| {
            let place = laid.place(location).expect("a place");
            match place.width {
                Width::Bit => format!("{}.{}", place.byte, place.bit),
                width => format!("{}+{}", place.byte, width.bytes()),
            }
        };
        locations.iter().map(text).collect()
    }

    #[test]
    fn one_memory_counts_units_of_the_width() {
        let texts = ["%MW1", "%MD1", "%MB1", "%MX1.5", "%IX9", "%ML3"];
        assert_eq!(places(Editor::Codesys, &texts), ["2+2", "4+4", "1+1", "1.5", "1.1", "24+8"]);
    }

    #[test]
    fn widths_with_memory_of_their_own_never_overlap() {
        let texts = ["%MW0", "%MD0", "%ML0", "%MX0.0", "%MW1"];
        assert_eq!(places(Editor::Matiec, &texts), ["100+2", "200+4", "300+8", "0.0", "102+2"]);
        // Addresses that do not overlap do not move.
        assert_eq!(places(Editor::Matiec, &["%QX0.0", "%QW5"]), ["0.0", "10+2"]);
        assert_eq!(places(Editor::Matiec, &["%IX3"]), ["3.0"]);
    }

    #[test]
    fn longer_addresses_lie_after_the_others() {
        let texts = ["%QX0.0", "%QX1.0.2", "%QX1.0.3", "%QW2.1"];
        assert_eq!(places(Editor::Codesys, &texts), ["0.0", "8.0", "8.1", "10+2"]);
    }

    #[test]
    fn addresses_are_found_in_text() {
        let found: Vec<&str> = mentioned("a := %MW1; b := %QX1.0.2. %x 5% %M").map(|(text, _)| text).collect();
        assert_eq!(found, ["%MW1", "%QX1.0.2"]);
        assert_eq!(Location::read("%Q*"), Read::Open);
        assert_eq!(Location::read("%KW0"), Read::Not);
    }
}
