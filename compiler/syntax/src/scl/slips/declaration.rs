//! Slips in declarations: bounds of arrays, lengths of texts, the order of type and value.

use plcc_diag::Diagnostic;

use super::{Slip, is_digits};
use crate::distance::nearest;
use crate::scl::token::Tok;

impl Slip<'_, '_> {
    /// What is meant by a declaration.
    pub(super) fn in_declaration(self) -> Option<Diagnostic> {
        let Slip { state, index, before, at, .. } = self;
        match (&before.1, &at.1) {
            (Tok::Literal(_), Tok::RightBracket) => {
                let open = state.text.get(..at.0)?.rfind('[')?;
                let bounds = state.text.get(open + 1..at.0)?;
                if bounds.trim().parse::<u32>().is_ok() {
                    return self.told(
                        open + 1,
                        at.0,
                        "an array has a lower and an upper bound".to_owned(),
                        "one bound",
                        format!("write `1..{}`, or another range", bounds.trim()),
                    );
                }
                let (low, high) =
                    bounds.get(1..)?.split_once('-').map(|(low, high)| (bounds[..1].to_owned() + low, high))?;
                let is_number = |text: &str| text.trim().trim_start_matches('-').parse::<u32>().is_ok();
                let (low, high) = (low.trim(), high.trim());
                if !is_number(low) || !is_number(high) {
                    return None;
                }
                self.told(
                    open + 1,
                    at.0,
                    "the bounds of an array are separated by two dots".to_owned(),
                    "a subtraction",
                    format!("write `{low}..{high}`"),
                )
            }
            (Tok::RightBracket, _) => self.told(
                at.0,
                at.2,
                "`OF` is missing before the type".to_owned(),
                "the type of the elements",
                format!("write `OF {}`", self.text(at)),
            ),
            (Tok::Array, Tok::LeftParen) => {
                let rest = state.text.get(at.2..).unwrap_or_default();
                let bounds = rest.split(')').next().unwrap_or_default().trim();
                self.told(
                    at.0,
                    at.2,
                    "the bounds of an array are written in brackets".to_owned(),
                    "a form of other languages",
                    format!("write `{}[{bounds}]`", self.text(before)),
                )
            }
            (_, Tok::LeftParen) if self.text(before).eq_ignore_ascii_case("STRING") => {
                let rest = state.text.get(at.2..).unwrap_or_default();
                let length = rest.split(')').next().unwrap_or_default().trim();
                self.told(
                    at.0,
                    at.2,
                    "the length of a STRING is written in brackets".to_owned(),
                    "a form of other languages",
                    format!("write `{}[{length}]`", self.text(before)),
                )
            }
            (Tok::Literal(_), Tok::Literal(_)) => self.in_number(),
            // `ARRAY[0,9] OF INT`
            (Tok::Literal(_), Tok::Comma)
                if index
                    .checked_sub(2)
                    .and_then(|open| state.tokens.get(open))
                    .is_some_and(|(_, token, _)| *token == Tok::LeftBracket) =>
            {
                let high = state.text.get(at.2..)?.split(']').next().unwrap_or_default().trim();
                let low = self.text(before);
                if !is_digits(high) {
                    return None;
                }
                self.told(
                    at.0,
                    at.2,
                    "the bounds of an array are separated by two dots".to_owned(),
                    "separates dimensions",
                    format!("write `{low}..{high}`"),
                )
            }
            // `speed := 5 : INT;`
            (Tok::Name(name), Tok::Assign) => {
                let rest = state.text.get(at.2..)?.split([';', '\n', '\r']).next().unwrap_or_default();
                let (value, ty) = rest.split_once(':').filter(|(_, ty)| !ty.starts_with('='))?;
                self.told(
                    at.0,
                    at.2,
                    "the type of a variable comes before its value".to_owned(),
                    "a value without a type",
                    format!("write `{name} : {} := {};`", ty.trim(), value.trim()),
                )
            }
            (Tok::Name(name), Tok::LeftBracket) => {
                let Some(near) = nearest(name, ["STRING", "WSTRING", "ARRAY"].into_iter()) else {
                    let rest = state.text.get(at.2..)?;
                    let bounds = rest.split(']').next().unwrap_or_default().trim();
                    let bounds = match bounds.parse::<u32>() {
                        Ok(_) => format!("1..{bounds}"),
                        Err(_) => bounds.to_owned(),
                    };
                    return self.told(
                        at.0,
                        at.2,
                        format!("the bounds of an array are after `ARRAY`, not after `{name}`"),
                        "a form of other languages",
                        format!("write `ARRAY[{bounds}] OF {name}`"),
                    );
                };
                self.told(
                    before.0,
                    before.2,
                    format!("the data type `{name}` is not defined"),
                    "no type with a length or bounds",
                    format!("is `{near}` meant?"),
                )
            }
            _ => None,
        }
    }
}
