//! Families among which a program is moved with its data: memory of one means nothing to another.

use plcc_abi::image::Family;

/// As messages name them, from number 1 on.
const NAMES: [&str; 3] = ["S7-300/400", "S7-200", "S7-1200/1500"];

/// The number of a family.
pub(super) fn number(family: Family) -> u8 {
    match family {
        Family::S7300 | Family::S7400 => 1,
        Family::S7200 => 2,
        Family::S71200 | Family::S71500 => 3,
    }
}

/// What a message says of a file with a number that is not that of the family; 0 is any.
pub(super) fn difference(kept: u8, family: Family) -> Option<String> {
    let name = |number: u8| NAMES.get(usize::from(number).wrapping_sub(1)).copied().unwrap_or("other");
    let own = number(family);
    (kept != 0 && kept != own)
        .then(|| format!("is of a program for {} CPUs, and this one is for {} CPUs", name(kept), name(own)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_with_the_same_data_are_one() {
        assert_eq!(difference(number(Family::S7300), Family::S7400), None);
        assert_eq!(difference(number(Family::S71200), Family::S71500), None);
        assert_eq!(difference(0, Family::S7200), None);
        let expected = "is of a program for S7-200 CPUs, and this one is for S7-300/400 CPUs";
        assert_eq!(difference(number(Family::S7200), Family::S7300).as_deref(), Some(expected));
        assert!(difference(127, Family::S71200).is_some_and(|text| text.contains("other")));
    }
}
