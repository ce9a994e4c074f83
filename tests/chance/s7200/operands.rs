//! Random operands of each kind, and how V memory is divided among kinds.

use std::ops::Range;

use super::program::{Area, Block, Operand, Width};
use plcc_tests::random::Random;

pub const NUMBERS: Range<u32> = 0..64;
pub const REALS: Range<u32> = 64..128;
pub const COUNTS: Range<u32> = 128..144;
/// Characters of hexadecimal numbers.
pub const DIGITS: Range<u32> = 150..190;
pub const TABLES: [u32; 4] = [200, 230, 260, 280];
pub const STRINGS: [u32; 6] = [300, 316, 332, 348, 364, 380];
pub const POINTERS: Range<u32> = 400..432;
/// Words of loops.
pub const INDEXES: u32 = 440;
/// Bytes at the end of V memory.
const TAIL: Range<u32> = 10200..10240;

/// Parameters of a block by their place in L memory.
#[derive(Clone, Default)]
pub struct Local {
    parameters: Vec<(Operand, Option<Width>)>,
}

impl Local {
    pub fn of(block: &Block) -> Local {
        let places = block.places();
        let named = |(index, place)| Operand::Named(format!("P{index}"), Box::new(place));
        let widths = block.parameters.iter().map(|parameter| parameter.width);
        Local { parameters: places.into_iter().enumerate().map(named).zip(widths).collect() }
    }

    fn pick(&self, random: &mut Random, width: Option<Width>) -> Option<Operand> {
        let fitting: Vec<&Operand> =
            self.parameters.iter().filter(|(_, own)| *own == width).map(|(operand, _)| operand).collect();
        (!fitting.is_empty()).then(|| fitting[random.below(fitting.len())].clone())
    }
}

/// An operand of a contact: a bad pointer stops the CPU there, so there are few.
pub fn checked(random: &mut Random, kind: char, local: &Local) -> Operand {
    let mut operand = operand(random, kind, local);
    for _ in 0..6 {
        if !matches!(operand, Operand::Pointed(_)) {
            break;
        }
        operand = self::operand(random, kind, local);
    }
    operand
}

/// An operand by the letter of [`generate`](super::generate): small letters are read, capital ones written.
pub fn operand(random: &mut Random, kind: char, local: &Local) -> Operand {
    match kind {
        'x' => bit(random, local, true),
        'X' | 'Y' => match (kind, bit(random, local, false)) {
            ('Y', Operand::Bit(area, byte, bit)) => Operand::Bit(area, byte, bit),
            ('Y', _) => Operand::Bit(Area::V, random.below(64) as u32, random.below(8) as u8),
            // S and R count bits from here: no parameter.
            (_, Operand::Named(_, place)) => *place,
            (_, other) => other,
        },
        'Q' => Operand::Bit(Area::Q, random.below(16) as u32, random.below(8) as u8),
        'I' => Operand::Cell(Area::I, Width::Byte, random.below(16) as u32),
        'O' => Operand::Cell(Area::Q, Width::Byte, random.below(16) as u32),
        'b' => input(random, Width::Byte, local),
        'w' => input(random, Width::Word, local),
        'd' => input(random, Width::Dword, local),
        'B' => output(random, Width::Byte, local),
        'W' => output(random, Width::Word, local),
        'D' => output(random, Width::Dword, local),
        // Actual parameters that are written: no pointers.
        'E' | 'F' | 'G' => {
            let width = match kind {
                'E' => Width::Byte,
                'F' => Width::Word,
                _ => Width::Dword,
            };
            loop {
                let operand = output(random, width, local);
                if !matches!(operand, Operand::Pointed(_)) {
                    return operand;
                }
            }
        }
        'r' => match random.below(10) {
            0..=2 => Operand::Real(edge_real(random)),
            3 => cell(random, Width::Dword, false),
            4 => pointed(random),
            _ => Operand::Cell(Area::V, Width::Dword, REALS.start + 4 * random.below(16) as u32),
        },
        'R' => match random.below(10) {
            0 => output(random, Width::Dword, local),
            _ => Operand::Cell(Area::V, Width::Dword, REALS.start + 4 * random.below(16) as u32),
        },
        '&' => Operand::AddressOf(Box::new(target(random))),
        'P' => match random.below(3) {
            0 => Operand::Accumulator(1 + random.below(3) as u8),
            _ => Operand::Cell(Area::V, Width::Dword, POINTERS.start + 4 * random.below(8) as u32),
        },
        'n' => match random.below(5) {
            0 | 1 => Operand::Cell(Area::V, Width::Byte, COUNTS.start + random.below(16) as u32),
            _ => Operand::Number(random.of(&[1, 1, 2, 3, 4, 5, 7, 8])),
        },
        'N' => match random.below(4) {
            0 => Operand::Cell(Area::V, Width::Byte, COUNTS.start + random.below(16) as u32),
            _ => Operand::Number(random.of(&[1, 2, 7, 8, 9, 16, 63, 64, -1, -2, -8, -13, -64])),
        },
        'c' | 'i' => match random.below(5) {
            0 => Operand::Cell(Area::V, Width::Byte, COUNTS.start + random.below(16) as u32),
            _ => Operand::Number(random.of(&[1, 1, 2, 3, 4])),
        },
        'p' => Operand::Cell(Area::V, Width::Byte, COUNTS.start + random.below(16) as u32),
        '1' | '2' | '4' => buffer(random, kind),
        '!' => buffer(random, '1'),
        '@' => buffer(random, '2'),
        '$' => buffer(random, '4'),
        't' => Operand::Cell(Area::V, Width::Word, random.of(&TABLES)),
        'T' => Operand::Cell(Area::V, Width::Word, random.of(&TABLES) + 2),
        's' => match random.below(8) {
            0 => Operand::Text(random.of(&["a", "an", "12", "-5 x", "zz9"]).to_string()),
            1 => Operand::Cell(Area::V, Width::Byte, random.of(&[10230, 128, 0, 10239])),
            2 => pointed(random),
            _ => Operand::Cell(Area::V, Width::Byte, random.of(&STRINGS)),
        },
        'o' => match random.below(12) {
            0 => Operand::Cell(Area::V, Width::Byte, random.of(&[10236, 100, 10239])),
            1 => pointed(random),
            _ => Operand::Cell(Area::V, Width::Byte, random.of(&STRINGS)),
        },
        'f' => match random.below(4) {
            0 => Operand::Cell(Area::V, Width::Byte, COUNTS.start + random.below(16) as u32),
            _ => Operand::Number(random.of(&[0, 1, 2, 3, 4, 5, 8, 11, 13])),
        },
        'g' => Operand::Number(random.of(&[0, 1, 2, 3, 4, 5, 8, 11, 13])),
        'h' => Operand::Cell(Area::V, Width::Byte, DIGITS.start + random.below(32) as u32),
        'k' => Operand::Cell(Area::V, Width::Byte, random.of(&[REALS.start, DIGITS.start, TAIL.end - 4])),
        _ => unreachable!("no operand has the letter {kind}"),
    }
}

fn bit(random: &mut Random, local: &Local, read: bool) -> Operand {
    let number = random.below(8) as u8;
    match random.below(20) {
        0 => Operand::Timer(number_of(random)),
        1 => Operand::Counter(random.below(6) as u8),
        2 if read => Operand::Bit(Area::Sm, 1, number),
        3 if read => random.of(&[(0, 0), (0, 1), (0, 4), (0, 5), (0, 6), (4, 3)]).into_sm(),
        2 | 3 => Operand::Bit(Area::Sm, random.of(&[200, 210, 549]), number),
        4 => local.pick(random, None).unwrap_or(Operand::Bit(Area::L, random.below(64) as u32, number)),
        5 => Operand::Bit(Area::L, random.of(&[0, 8, 63]), number),
        6 => Operand::Bit(Area::S, random.of(&[0, 0, 1, 31]), number),
        7 | 8 => Operand::Bit(Area::Q, random.of(&[0, 1, 15]), number),
        9..=11 if read => Operand::Bit(Area::I, random.of(&[0, 1, 15]), number),
        9 => Operand::Bit(Area::I, random.of(&[0, 1, 15]), number),
        10..=13 => Operand::Bit(Area::M, random.of(&[0, 0, 1, 31]), number),
        14 => Operand::Bit(Area::V, random.of(&[10239, 10230]), number),
        _ => Operand::Bit(Area::V, random.below(64) as u32, number),
    }
}

trait IntoSm {
    fn into_sm(self) -> Operand;
}

impl IntoSm for (u32, u8) {
    fn into_sm(self) -> Operand {
        Operand::Bit(Area::Sm, self.0, self.1)
    }
}

/// Numbers of timers that boxes usually have; none of 1 ms.
fn number_of(random: &mut Random) -> u8 {
    random.of(&[1, 2, 5, 33, 34, 37, 38, 97, 101, 255])
}

fn cell(random: &mut Random, width: Width, written: bool) -> Operand {
    let back = width.bytes();
    let at = |random: &mut Random, area: Area, first: u32| match random.below(4) {
        0 => area.bytes() - back,
        _ => first + random.below((area.bytes() - back + 1 - first).min(24) as usize) as u32,
    };
    let (area, byte) = match random.below(20) {
        0 => (Area::I, at(random, Area::I, 0)),
        1 | 2 => (Area::Q, at(random, Area::Q, 0)),
        3..=5 => (Area::M, at(random, Area::M, 0)),
        6 => (Area::S, at(random, Area::S, 8)),
        7 => (Area::L, at(random, Area::L, 0)),
        8 if !written && width == Width::Byte => (Area::Sm, random.of(&[0, 1, 4])),
        8 if !written && width == Width::Word => (Area::Sm, random.of(&[22, 24, 26])),
        8 => (Area::Sm, at(random, Area::Sm, 200)),
        9 | 10 => (Area::V, TAIL.start + random.below((TAIL.end - TAIL.start - back + 1) as usize) as u32),
        _ => (Area::V, NUMBERS.start + random.below((NUMBERS.end - NUMBERS.start - back + 1) as usize) as u32),
    };
    Operand::Cell(area, width, byte)
}

fn input(random: &mut Random, width: Width, local: &Local) -> Operand {
    match random.below(20) {
        0..=5 => Operand::Number(match width {
            Width::Byte => random.of(&[0, 1, 2, 10, 127, 128, 254, 255]),
            Width::Word => edge_word(random),
            Width::Dword => edge_dword(random),
        }),
        6 | 7 => local.pick(random, Some(width)).unwrap_or_else(|| cell(random, width, false)),
        8 if width == Width::Word => Operand::Timer(number_of(random)),
        9 if width == Width::Word => Operand::Counter(random.below(6) as u8),
        10 | 11 => Operand::Accumulator(random.below(4) as u8),
        12 => pointed(random),
        _ => cell(random, width, false),
    }
}

fn output(random: &mut Random, width: Width, local: &Local) -> Operand {
    match random.below(20) {
        0 | 1 => local.pick(random, Some(width)).unwrap_or_else(|| cell(random, width, true)),
        2 if width == Width::Word => Operand::Timer(number_of(random)),
        3 if width == Width::Word => Operand::Counter(random.below(6) as u8),
        4 | 5 => Operand::Accumulator(random.below(4) as u8),
        6 | 7 => pointed(random),
        _ => cell(random, width, true),
    }
}

fn pointed(random: &mut Random) -> Operand {
    let pointer = match random.below(8) {
        0 => Operand::Accumulator(1 + random.below(3) as u8),
        1 => Operand::Cell(Area::L, Width::Dword, 56),
        _ => Operand::Cell(Area::V, Width::Dword, POINTERS.start + 4 * random.below(8) as u32),
    };
    Operand::Pointed(Box::new(pointer))
}

/// Valid targets of a pointer.
pub fn target(random: &mut Random) -> Operand {
    let width = random.of(&[Width::Byte, Width::Byte, Width::Word, Width::Dword]);
    match random.below(16) {
        0 => Operand::Timer(number_of(random)),
        1 => Operand::Counter(random.of(&[0, 3, 254, 255])),
        2 => Operand::Cell(Area::V, Width::Byte, random.of(&STRINGS)),
        3 => Operand::Cell(Area::V, Width::Byte, random.of(&[10237, 10238, 10239])),
        _ => loop {
            // L memory is not pointed at.
            let operand = cell(random, width, true);
            if !matches!(operand, Operand::Cell(Area::L, ..)) {
                return operand;
            }
        },
    }
}

fn buffer(random: &mut Random, size: char) -> Operand {
    let width = match size {
        '1' => Width::Byte,
        '2' => Width::Word,
        _ => Width::Dword,
    };
    match random.below(16) {
        0 if size == '2' => Operand::Timer(random.of(&[33, 37, 250, 255])),
        1 if size == '2' => Operand::Counter(random.of(&[0, 2, 250, 255])),
        2 | 3 => pointed(random),
        // Reads also avoid special memory that the CPU writes.
        4..=7 => cell(random, width, true),
        _ => Operand::Cell(Area::V, width, random.below(100) as u32),
    }
}

pub fn edge_word(random: &mut Random) -> i64 {
    match random.below(3) {
        0 => random.below(0x1_0000) as i64 - 0x8000,
        1 => random.below(20) as i64 - 10,
        _ => random.of(&[0, 1, -1, 2, 10, 255, 256, 9999, 10_000, 32767, -32768, -32767, 0x1234, 181, 182]),
    }
}

pub fn edge_dword(random: &mut Random) -> i64 {
    match random.below(4) {
        0 => i64::from(random.bits() as i32),
        1 => edge_word(random),
        2 => edge_word(random) & 0xFFFF | edge_word(random) << 16 & 0x7FFF_0000,
        _ => random.of(&[0, 1, -1, 0x7FFF_FFFF, -0x8000_0000, 32768, -32769, 65535, 65536, 46340, 46341, 1_000_000]),
    }
}

pub fn edge_real(random: &mut Random) -> f32 {
    match random.below(3) {
        0 => (random.bits() as i32) as f32 / 65536.0,
        1 => random.of(&[0.0, 1.0, -1.0, 0.5, 1.5, 2.5, -2.5, -0.5, 100.0, 0.1, -0.001]),
        _ => random.of(&[
            f32::MAX,
            f32::MIN,
            1.0E-30,
            2_147_483_648.0,
            -2_147_483_648.0,
            2_147_483_520.0,
            32767.5,
            -1.0E20,
            1.0E20,
            88.0,
            std::f32::consts::PI,
            -0.0,
        ]),
    }
}
