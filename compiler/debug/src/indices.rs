//! Indices that are variables: `list[#i]` and `list[#i + 1]` are elements by the value of `#i` where the program stands.

use std::borrow::Cow;

/// The text with numbers for its indices; `value` tells that of an index which is not one. Brackets within an index, and those that are not
/// closed, stay as they are. `Err`: as `value`.
pub fn settled<'t>(text: &'t str, value: &dyn Fn(&str) -> Result<i64, String>) -> Result<Cow<'t, str>, String> {
    if !text.contains('[') {
        return Ok(Cow::Borrowed(text));
    }
    let mut out = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(['"', '[']) {
        let (before, after) = rest.split_at(at + 1);
        out.push_str(before);
        rest = after;
        let closing = if before.ends_with('"') { '"' } else { ']' };
        let Some((inside, _)) = rest.split_once(closing) else { break };
        if closing == '"' || inside.contains(['"', '[']) {
            out.push_str(inside);
        } else {
            let one = |index: &str| match index.trim().parse::<i64>() {
                Ok(_) => Ok(index.to_string()),
                Err(_) => value(index.trim()).map(|number| number.to_string()),
            };
            let indices: Vec<String> = inside.split(',').map(one).collect::<Result<_, _>>()?;
            out.push_str(&indices.join(","));
        }
        out.push(closing);
        rest = &rest[inside.len() + 1..];
    }
    out.push_str(rest);
    Ok(Cow::Owned(out))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_become_numbers() {
        let value = |index: &str| match index {
            "#i" => Ok(2),
            "#i + 1" => Ok(3),
            _ => Err(format!("no {index}")),
        };
        for (text, expected) in [
            ("MW10", "MW10"),
            ("list[1, -2]", "list[1, -2]"),
            ("list[#i]", "list[2]"),
            ("\"a[#i]\".b[#i + 1, 4].c[ #i ]", "\"a[#i]\".b[3, 4].c[2]"),
            ("list[other[#i]]", "list[other[#i]]"),
            ("list[#i", "list[#i"),
            ("\"list[#i]", "\"list[#i]"),
        ] {
            assert_eq!(settled(text, &value).as_deref(), Ok(expected), "{text}");
        }
        assert_eq!(settled("list[#j]", &value), Err("no #j".to_string()));
    }
}
