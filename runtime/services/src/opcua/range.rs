//! Index ranges: parts of arrays that a client reads, writes or watches. Source: OPC 10000-4, section 7.27.

use super::code::Variant;
use super::status::{self, Status};

/// First and last index in each dimension, counted from 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Range(Vec<(u32, u32)>);

impl Range {
    /// `2`, `0:3`, `1,0:2`. `None`: the text is empty, so it means all of a value.
    pub fn parse(text: &str) -> Result<Option<Range>, Status> {
        if text.is_empty() {
            return Ok(None);
        }
        let number = |text: &str| text.bytes().all(|digit| digit.is_ascii_digit()).then(|| text.parse().ok()).flatten();
        let one = |part: &str| match part.split_once(':') {
            // The second index is the larger one.
            Some((first, last)) => Some((number(first)?, number(last)?)).filter(|(first, last)| first < last),
            None => number(part).map(|index| (index, index)),
        };
        let all: Option<Vec<_>> = text.split(',').map(one).collect();
        all.map(|all| Some(Range(all))).ok_or(status::INDEX_RANGE_INVALID)
    }

    /// The elements of an array of these lengths, in order, and the lengths of what they make up. With `exactly` all of them must be there, else
    /// those count that are.
    pub fn elements(&self, lengths: &[u32], exactly: bool) -> Result<(Vec<usize>, Vec<u32>), Status> {
        if self.0.len() != lengths.len() {
            return Err(status::INDEX_RANGE_INVALID);
        }
        let mut found = vec![0];
        let mut own = Vec::new();
        for ((first, last), length) in self.0.iter().zip(lengths) {
            if *first >= *length || exactly && *last >= *length {
                return Err(status::INDEX_RANGE_NO_DATA);
            }
            let last = (*last).min(length - 1);
            own.push(last - first + 1);
            let row = |start: &usize| {
                let start = *start * *length as usize;
                (*first as usize..=last as usize).map(move |index| start + index)
            };
            found = found.iter().flat_map(row).collect();
        }
        Ok((found, own))
    }

    /// The part of a value.
    pub fn of(&self, value: Variant) -> Result<Variant, Status> {
        let Variant::Many { ty, values, dimensions } = value else { return Err(status::INDEX_RANGE_INVALID) };
        let all = [values.len() as u32];
        let lengths = if dimensions.len() > 1 { &dimensions } else { &all[..] };
        let (elements, lengths) = self.elements(lengths, false)?;
        let values = elements.iter().filter_map(|index| values.get(*index).cloned()).collect();
        Ok(Variant::Many { ty, values, dimensions: lengths })
    }
}

#[cfg(test)]
mod tests {
    use super::super::code::Scalar;
    use super::*;

    #[test]
    fn texts_of_ranges() {
        assert_eq!(Range::parse(""), Ok(None));
        assert_eq!(Range::parse("2"), Ok(Some(Range(vec![(2, 2)]))));
        assert_eq!(Range::parse("1:4,0"), Ok(Some(Range(vec![(1, 4), (0, 0)]))));
        for text in [":", "1:", ":1", "2:2", "3:1", "-1", "a", "1,", "1:2:3", "4294967296", "+1"] {
            assert_eq!(Range::parse(text), Err(status::INDEX_RANGE_INVALID), "{text}");
        }
    }

    #[test]
    fn parts_of_arrays() {
        let table = Variant::Many { ty: 6, values: (0..6).map(Scalar::Int32).collect(), dimensions: vec![2, 3] };
        let part = |text: &str| Range::parse(text).unwrap().unwrap().of(table.clone());
        let found = |values: &[i32], dimensions: &[u32]| {
            let values = values.iter().copied().map(Scalar::Int32).collect();
            Ok(Variant::Many { ty: 6, values, dimensions: dimensions.to_vec() })
        };
        assert_eq!(part("1,0:1"), found(&[3, 4], &[1, 2]));
        assert_eq!(part("0:1,2"), found(&[2, 5], &[2, 1]));
        assert_eq!(part("0,1:9"), found(&[1, 2], &[1, 2]), "what is there");
        assert_eq!(part("2,0"), Err(status::INDEX_RANGE_NO_DATA));
        assert_eq!(part("0"), Err(status::INDEX_RANGE_INVALID));
        let range = Range::parse("1:4294967295").unwrap().unwrap();
        assert_eq!(range.elements(&[3], false), Ok((vec![1, 2], vec![2])));
        assert_eq!(range.elements(&[3], true), Err(status::INDEX_RANGE_NO_DATA));
        assert_eq!(range.elements(&[0], false), Err(status::INDEX_RANGE_NO_DATA));
    }
}
