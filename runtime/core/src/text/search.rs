//! FIND, and comparisons of texts. Source: STL reference, IEC function library; S7-1200 reference, strings.

use plcc_abi::text::Rules;

use super::Text;
use crate::memory::Bytes;

/// Position of the first `part` in `text` from 1, 0 if there is none; and whether all is well: both texts are valid, and with the rules of the
/// TIA Portal the part is neither empty nor longer than the text.
#[inline(always)]
pub fn find(memory: Bytes, text: Option<Text>, part: Option<Text>, rules: Rules) -> (u32, bool) {
    let (Some(text), Some(part)) = (text, part) else { return (0, false) };
    if part.length() == 0 || part.length() > text.length() {
        return (0, rules == Rules::V5);
    }
    let found = text.view(memory, |text| {
        part.view(memory, |part| match *part {
            [character] => first_of(text, character),
            _ => position(text, part),
        })
    });
    (found.map_or(0, |index| index as u32 + 1), true)
}

/// The first `part` in `text`; `None` if there is none or it is empty.
#[inline(never)]
fn position(text: &[u8], part: &[u8]) -> Option<usize> {
    let (&first, rest) = part.split_first()?;
    let starts = text.get(..=text.len().checked_sub(part.len())?)?;
    let mut from = 0;
    loop {
        let at = from + first_of(&starts[from..], first)?;
        if rest.is_empty() || &text[at + 1..at + part.len()] == rest {
            return Some(at);
        }
        from = at + 1;
    }
}

/// The first `character` in `text`, eight characters at a time.
#[inline(always)]
fn first_of(text: &[u8], character: u8) -> Option<usize> {
    const ONES: u64 = 0x0101_0101_0101_0101;
    let pattern = ONES * u64::from(character);
    let place_in = |eight: [u8; 8]| {
        let differences = u64::from_le_bytes(eight) ^ pattern;
        // The lowest bit that is set belongs to the first byte that is 0.
        let zeros = differences.wrapping_sub(ONES) & !differences & (ONES << 7);
        (zeros != 0).then(|| zeros.trailing_zeros() as usize / 8)
    };
    let Some(last) = text.last_chunk::<8>() else {
        return text.iter().position(|&found| found == character);
    };
    let (eights, rest) = text.as_chunks::<8>();
    for (index, eight) in eights.iter().enumerate() {
        if let Some(place) = place_in(*eight) {
            return Some(8 * index + place);
        }
    }
    // The last eight begin with some that have been looked at.
    if rest.is_empty() { None } else { place_in(*last).map(|place| text.len() - 8 + place) }
}

/// True if the relation holds: bit 0 of `relation`: `one` is less, bit 1: they are equal, bit 2: it is greater, by the codes of the
/// characters. `None`: a text is not valid.
#[inline(always)]
pub fn relation(memory: Bytes, one: Option<Text>, two: Option<Text>, relation: u32) -> Option<bool> {
    let (one, two) = (one?, two?);
    let order = one.view(memory, |one| two.view(memory, |two| one.cmp(two)));
    Some(relation >> (order as i8 + 1) & 1 != 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn characters_are_found_at_every_place() {
        let text: Vec<u8> = (0..40u8).map(|at| at ^ 0x80).collect();
        for (at, &character) in text.iter().enumerate() {
            assert_eq!(first_of(&text, character), Some(at));
            assert_eq!(first_of(&text[..at], character), None);
            assert_eq!(position(&text, &text[at..]), Some(at));
        }
        assert_eq!(position(b"aaab", b"ab"), Some(2));
        assert_eq!(position(b"ab", b"abc"), None);
    }
}
