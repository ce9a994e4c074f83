//! Which operands are forced.

/// The areas whose addresses are marked, the longer names first.
const AREAS: [&str; 9] = ["PI", "PQ", "SM", "AI", "AQ", "I", "Q", "M", "V"];

/// The addresses that are forced.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Forcing {
    ranges: Vec<Range>,
    /// It is at the modules: what is read and written directly is forced too.
    modules: bool,
}

/// Bits of an area.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Range {
    area: &'static str,
    from: u64,
    to: u64,
}

impl Forcing {
    pub fn new<'a>(addresses: impl Iterator<Item = &'a str>, modules: bool) -> Forcing {
        Forcing { ranges: addresses.filter_map(range).collect(), modules }
    }

    /// Whether an operand with this address has forced bits.
    pub fn has(&self, address: &str) -> bool {
        let Some(operand) = range(address) else { return false };
        let area = match operand.area {
            "PI" if self.modules => "I",
            "PQ" if self.modules => "Q",
            area => area,
        };
        self.ranges.iter().any(|forced| forced.area == area && forced.from < operand.to && operand.from < forced.to)
    }
}

/// The bits of an address: `I0.0`, `QW4`, `PIW256`.
fn range(address: &str) -> Option<Range> {
    let (area, rest) = AREAS.iter().find_map(|area| Some((*area, address.strip_prefix(*area)?)))?;
    let (bits, rest) = match rest.chars().next()? {
        'B' => (8, &rest[1..]),
        'W' => (16, &rest[1..]),
        'D' => (32, &rest[1..]),
        'L' => (64, &rest[1..]),
        _ => (1, rest),
    };
    let (byte, bit) = match rest.split_once('.') {
        Some((byte, bit)) => (byte, bit.parse::<u32>().ok()?),
        None => (rest, 0),
    };
    let from = u64::from(byte.parse::<u32>().ok()?) * 8 + u64::from(bit);
    Some(Range { area, from, to: from + bits })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn operands_with_forced_bits_are_forced() {
        let forcing = Forcing::new(["I0.3", "QW4", "PIW256", "nothing"].into_iter(), false);
        for (address, expected) in [
            ("I0.3", true),
            ("I0.4", false),
            ("IB0", true),
            ("ID0", true),
            ("QB5", true),
            ("QB6", false),
            ("Q4.7", true),
            ("PIB257", true),
            ("PI0.3", false),
            ("IW256", false),
            ("M0.3", false),
            ("#I0.3", false),
            ("", false),
            ("I", false),
            ("IW", false),
        ] {
            assert_eq!(forcing.has(address), expected, "{address}");
        }
        assert!(Forcing::new(["IW256"].into_iter(), true).has("PIW256"));
    }
}
