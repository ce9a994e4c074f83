//! A program of an S7-200 as a list of statements a block, and its text as Micro/WIN exports it.

use std::fmt::{self, Display, Formatter, Write as _};

/// Areas that have bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Area {
    I,
    Q,
    V,
    M,
    Sm,
    S,
    L,
}

impl Area {
    /// Bytes that a CPU 226 has of it. Source: S7-200 system manual, memory ranges.
    pub fn bytes(self) -> u32 {
        match self {
            Area::I | Area::Q => 16,
            Area::V => 10240,
            Area::M | Area::S => 32,
            Area::Sm => 550,
            Area::L => 64,
        }
    }
}

impl Display for Area {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Area::I => "I",
            Area::Q => "Q",
            Area::V => "V",
            Area::M => "M",
            Area::Sm => "SM",
            Area::S => "S",
            Area::L => "L",
        })
    }
}

/// How much an instruction reads or writes at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    Byte,
    Word,
    Dword,
}

impl Width {
    pub fn bytes(self) -> u32 {
        match self {
            Width::Byte => 1,
            Width::Word => 2,
            Width::Dword => 4,
        }
    }

    fn letter(self) -> char {
        match self {
            Width::Byte => 'B',
            Width::Word => 'W',
            Width::Dword => 'D',
        }
    }
}

/// The operands of an instruction.
#[derive(Clone, Debug, PartialEq)]
pub enum Operand {
    Bit(Area, u32, u8),
    Cell(Area, Width, u32),
    /// The bit or the current value, as the instruction needs.
    Timer(u8),
    Counter(u8),
    Accumulator(u8),
    /// `*VD400`, `*AC1`.
    Pointed(Box<Operand>),
    /// `&VB100`.
    AddressOf(Box<Operand>),
    /// A constant; of a REAL its bits.
    Number(i64),
    Real(f32),
    Text(String),
    /// Subroutine by number.
    Block(usize),
    /// A parameter by its name, and its operand.
    Named(String, Box<Operand>),
}

impl Display for Operand {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Operand::Bit(area, byte, bit) => write!(f, "{area}{byte}.{bit}"),
            Operand::Cell(area, width, byte) => write!(f, "{area}{}{byte}", width.letter()),
            Operand::Timer(number) => write!(f, "T{number}"),
            Operand::Counter(number) => write!(f, "C{number}"),
            Operand::Accumulator(number) => write!(f, "AC{number}"),
            Operand::Pointed(pointer) => write!(f, "*{pointer}"),
            Operand::AddressOf(place) => write!(f, "&{place}"),
            Operand::Number(value) => write!(f, "{value}"),
            Operand::Real(value) => write!(f, "{value:.8E}"),
            Operand::Text(text) => write!(f, "\"{text}\""),
            Operand::Block(number) => write!(f, "SBR_{number}"),
            Operand::Named(name, _) => write!(f, "#{name}"),
        }
    }
}

/// One line. [`NETWORK`] begins a network.
#[derive(Clone, Debug, PartialEq)]
pub struct Statement {
    pub op: &'static str,
    pub operands: Vec<Operand>,
}

/// The mnemonic of a statement that only begins a network.
pub const NETWORK: &str = "Network";

/// How a parameter goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    In,
    InOut,
    Out,
}

/// A parameter of a subroutine.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    pub direction: Direction,
    /// `None`: BOOL.
    pub width: Option<Width>,
    /// `INT`, `REAL`.
    pub type_name: &'static str,
}

/// Main program or subroutine.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Block {
    /// IN first, then IN_OUT, then OUT.
    pub parameters: Vec<Parameter>,
    pub code: Vec<Statement>,
}

impl Block {
    /// Where parameters are in L memory. Source: S7-200 system manual, calling a subroutine with parameters.
    pub fn places(&self) -> Vec<Operand> {
        let (mut byte, mut bit) = (0, 0);
        let mut places = Vec::new();
        for parameter in &self.parameters {
            match parameter.width {
                None => {
                    if bit == 8 {
                        (byte, bit) = (byte + 1, 0);
                    }
                    places.push(Operand::Bit(Area::L, byte, bit));
                    bit += 1;
                }
                Some(width) => {
                    if bit > 0 {
                        (byte, bit) = (byte + 1, 0);
                    }
                    places.push(Operand::Cell(Area::L, width, byte));
                    byte += width.bytes();
                }
            }
        }
        places
    }
}

/// Block 0 is the main program, block n + 1 subroutine n.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Program {
    pub blocks: Vec<Block>,
    /// Start values of V memory.
    pub data: Vec<Data>,
}

/// A line of the data block: address, values as text, and the bytes that this means.
#[derive(Clone, Debug, PartialEq)]
pub struct Data {
    pub byte: u32,
    pub text: String,
    pub bytes: Vec<u8>,
}

impl Display for Program {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for (number, block) in self.blocks.iter().enumerate() {
            let kind = match number.checked_sub(1) {
                None => "ORGANIZATION_BLOCK",
                Some(_) => "SUBROUTINE_BLOCK",
            };
            match number.checked_sub(1) {
                None => writeln!(f, "{kind} MAIN:OB1")?,
                Some(number) => writeln!(f, "{kind} SBR_{number}:SBR{number}")?,
            }
            writeln!(f, "TITLE=")?;
            declarations(block, f)?;
            writeln!(f, "BEGIN")?;
            let mut network = 0;
            for statement in &block.code {
                if statement.op == NETWORK {
                    network += 1;
                    writeln!(f, "Network {network}")?;
                    continue;
                }
                let mut line = format!("{:<7}", statement.op);
                for (index, operand) in statement.operands.iter().enumerate() {
                    line.push_str(if index > 0 { ", " } else { "" });
                    write!(line, "{operand}")?;
                }
                writeln!(f, "{}", line.trim_end())?;
            }
            writeln!(f, "END_{kind}")?;
        }
        writeln!(f, "DATA_BLOCK DB1")?;
        for line in &self.data {
            writeln!(f, "{}", line.text)?;
        }
        writeln!(f, "END_DATA_BLOCK")
    }
}

fn declarations(block: &Block, f: &mut Formatter<'_>) -> fmt::Result {
    let sections = [(Direction::In, "VAR_INPUT"), (Direction::InOut, "VAR_IN_OUT"), (Direction::Out, "VAR_OUTPUT")];
    for (direction, keyword) in sections {
        let own: Vec<(usize, &Parameter)> =
            block.parameters.iter().enumerate().filter(|(_, parameter)| parameter.direction == direction).collect();
        if own.is_empty() {
            continue;
        }
        writeln!(f, "{keyword}")?;
        for (index, parameter) in own {
            writeln!(f, "P{index}:{};", parameter.type_name)?;
        }
        writeln!(f, "END_VAR")?;
    }
    Ok(())
}
