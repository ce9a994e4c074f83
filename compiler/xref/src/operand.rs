//! What a program uses: a place in memory, a timer, a counter, a block.

use std::fmt;

use plcc_abi::image::BlockKind;
use plcc_model::BlockKey;

/// A memory area, in the order of the lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Area {
    I,
    Q,
    M,
    Pi,
    Pq,
    V,
    Sm,
    S,
    Ai,
    Aq,
    /// Of the DB with this number.
    Db(u16),
}

impl Area {
    /// Those of a symbol's address, longer names first.
    const NAMED: [(&'static str, Area); 10] = [
        ("PI", Area::Pi),
        ("PQ", Area::Pq),
        ("SM", Area::Sm),
        ("AI", Area::Ai),
        ("AQ", Area::Aq),
        ("I", Area::I),
        ("Q", Area::Q),
        ("M", Area::M),
        ("V", Area::V),
        ("S", Area::S),
    ];

    fn letters(self) -> String {
        match self {
            Area::Db(number) => format!("DB{number}.DB"),
            area => Area::NAMED.iter().find(|(_, other)| *other == area).map_or("", |(name, _)| name).to_string(),
        }
    }
}

/// An operand without its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Operand {
    /// `bits` bits from bit `start` of the area on.
    Memory {
        area: Area,
        start: u32,
        bits: u32,
    },
    Timer(u16),
    Counter(u16),
    HighSpeedCounter(u16),
    Block(BlockKey),
}

impl Operand {
    /// The data block with a number.
    pub const fn db(number: u16) -> Operand {
        Operand::Block(BlockKey { kind: BlockKind::Db, number })
    }

    /// Reads the address of a symbol: `Q4.0`, `MW10`, `DB5`, `T3`; `None` if it names something else.
    pub fn parse(address: &str) -> Option<Operand> {
        if let Some(number) = address.strip_prefix("DB").and_then(|number| number.parse().ok()) {
            return Some(Operand::db(number));
        }
        let named = Area::NAMED.iter().find_map(|(name, area)| Some((*area, address.strip_prefix(name)?)));
        let Some((area, rest)) = named else {
            let number = |prefix: &str| address.strip_prefix(prefix).and_then(|number| number.parse().ok());
            return (number("T").map(Operand::Timer))
                .or_else(|| number("HC").map(Operand::HighSpeedCounter))
                .or_else(|| number("C").map(Operand::Counter));
        };
        if let Some((byte, bit)) = rest.split_once('.') {
            let (byte, bit): (u16, u32) = (byte.parse().ok()?, bit.parse().ok()?);
            return (bit < 8).then_some(Operand::Memory { area, start: u32::from(byte) * 8 + bit, bits: 1 });
        }
        let bits = match rest.get(..1)? {
            "B" => 8,
            "W" => 16,
            "D" => 32,
            "L" => 64,
            _ => return None,
        };
        let byte: u16 = rest.get(1..)?.parse().ok()?;
        Some(Operand::Memory { area, start: u32::from(byte) * 8, bits })
    }

    /// The same place with another size.
    pub fn with_bits(self, size: u32) -> Operand {
        match self {
            Operand::Memory { area, start, .. } => Operand::Memory { area, start, bits: size },
            other => other,
        }
    }
}

impl fmt::Display for Operand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (area, start, bits) = match *self {
            Operand::Timer(number) => return write!(f, "T{number}"),
            Operand::Counter(number) => return write!(f, "C{number}"),
            Operand::HighSpeedCounter(number) => return write!(f, "HC{number}"),
            Operand::Block(key) => return write!(f, "{}{}", key.kind.prefix(), key.number),
            Operand::Memory { area, start, bits } => (area, start, bits),
        };
        let (letters, byte, bit) = (area.letters(), start / 8, start % 8);
        let x = if matches!(area, Area::Db(_)) { "X" } else { "" };
        match bits {
            1 => write!(f, "{letters}{x}{byte}.{bit}"),
            8 if bit == 0 => write!(f, "{letters}B{byte}"),
            16 if bit == 0 => write!(f, "{letters}W{byte}"),
            32 if bit == 0 => write!(f, "{letters}D{byte}"),
            _ if bit == 0 && bits % 8 == 0 => write!(f, "P#{letters}{x}{byte}.0 BYTE {}", bits / 8),
            _ => write!(f, "P#{letters}{x}{byte}.{bit} BOOL {bits}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_read_as_they_are_written() {
        for address in ["I0.0", "QB4", "MW10", "MD65534", "PIW256", "V10.7", "SMB28", "AIW4", "T5", "C31", "HC0"] {
            assert_eq!(Operand::parse(address).map(|operand| operand.to_string()), Some(address.to_string()));
        }
        assert_eq!(Operand::parse("ML8").map(|operand| operand.to_string()), Some("P#M8.0 BYTE 8".to_string()));
        assert_eq!(Operand::parse("DB10"), Some(Operand::db(10)));
        for wrong in ["", "M", "MX1", "M0.8", "Q99999.0", "FC1", "MB", "MB-1"] {
            assert_eq!(Operand::parse(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn an_operand_of_no_usual_size_is_a_pointer() {
        let of = |bits| Operand::Memory { area: Area::Db(7), start: 32, bits };
        assert_eq!(of(1).to_string(), "DB7.DBX4.0");
        assert_eq!(of(32).to_string(), "DB7.DBD4");
        assert_eq!(of(160).to_string(), "P#DB7.DBX4.0 BYTE 20");
        assert_eq!(of(5).to_string(), "P#DB7.DBX4.0 BOOL 5");
    }
}
