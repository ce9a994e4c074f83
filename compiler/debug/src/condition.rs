//! Conditions of breakpoints: the expressions of a plant, over names of PLC values, with the operators of PLC languages as well.
//!
//! `MW10 > 5`, `"Motor on" AND #count = 3`, `abs(Level - 2.5) < 0.1`, `DB1.Time >= T#5s`. A BOOL is 0 or 1, a duration is in seconds.
//! AND, OR and NOT combine bits and comparisons. With a number they are an error, since they could be meant for its bits.

use plcc_abi::image::AssertType;
use plcc_runtime::address::Width;
use plcc_runtime::assertion;
use plcc_runtime::plant::Expression;
use plcc_runtime::signal::number_text;
use plcc_runtime::typed::{self, ValueType};
use plcc_runtime::value;

/// An expression that was parsed.
pub struct Condition {
    /// What AND joins, in order: after one that is false no other is looked at. Otherwise the whole.
    parts: Vec<Part>,
    /// Names of values, by their numbers in the expressions.
    names: Vec<String>,
    /// Numbers of the names that are operands of AND, OR or NOT themselves, and so must be bits; after NOT with the sign that compares the
    /// name, if one does.
    combined: Vec<(usize, Option<String>)>,
    pub text: String,
}

/// What a name stands for.
#[derive(Clone, Copy, Debug)]
pub struct Operand {
    pub number: f64,
    /// It is a BOOL, which AND, OR and NOT combine.
    pub is_bit: bool,
}

struct Part {
    expression: Expression,
    /// Numbers of its names.
    names: Vec<usize>,
}

impl Condition {
    /// `Err`: the error as a sentence.
    pub fn parse(text: &str) -> Result<Condition, String> {
        let mut tokens = Vec::new();
        let mut rest = text.trim();
        while let Some(first) = rest.chars().next() {
            let (token, after) = token(rest, first)?;
            tokens.push(token);
            rest = after.trim_start();
        }
        let mut names: Vec<String> = Vec::new();
        let mut combined = Vec::new();
        let mut parts = vec![(String::new(), Vec::new())];
        let (mut depth, mut joins_only_by_and) = (0usize, true);
        for (at, token) in tokens.iter().enumerate() {
            let last = parts.last_mut().expect("there is one from the beginning");
            last.0.push(' ');
            match token {
                Token::Name(name) => {
                    let number = names.iter().position(|own| own == name).unwrap_or_else(|| {
                        names.push((*name).to_string());
                        names.len() - 1
                    });
                    last.0.push_str(&format!("n{number}"));
                    last.1.push(number);
                    match sign_after_not(&tokens, at) {
                        Some(sign) => combined.push((number, Some(sign.to_string()))),
                        None if is_combined(&tokens, at) => combined.push((number, None)),
                        None => {}
                    }
                }
                Token::Text(text) => {
                    if text.parse::<f64>().is_ok_and(|number| !is_bit(number)) && is_combined(&tokens, at) {
                        return Err(format!("{COMBINES}; they do not mask words: name one bit, such as `#word.%X2`"));
                    }
                    match text.as_str() {
                        "(" => depth += 1,
                        ")" => depth = depth.saturating_sub(1),
                        "||" if depth == 0 => joins_only_by_and = false,
                        _ => {}
                    }
                    match text.as_str() {
                        "&&" if depth == 0 => parts.push((String::new(), Vec::new())),
                        text => last.0.push_str(text),
                    }
                }
            }
        }
        if !joins_only_by_and {
            let whole = parts.iter().map(|(plain, _)| plain.as_str()).collect::<Vec<_>>().join(" && ");
            parts = vec![(whole, (0..names.len()).collect())];
        }
        let is_known = |name: &str| number_of(name).is_some_and(|at| at < names.len());
        let parse = |(plain, names): (String, Vec<usize>)| {
            let expression = Expression::parse(&plain, is_known)
                .map_err(|_| format!("`{text}` is not a condition; write MW10 > 5"))?;
            Ok(Part { expression, names })
        };
        let parts = parts.into_iter().map(parse).collect::<Result<_, String>>()?;
        Ok(Condition { parts, names, combined, text: text.to_string() })
    }

    /// Its value with `of` as the values of names. `Err`: the error.
    pub fn value(&self, of: &dyn Fn(&str) -> Result<Operand, String>) -> Result<f64, String> {
        let mut values = vec![0.0; self.names.len()];
        let mut value = 0.0;
        for part in &self.parts {
            for &number in &part.names {
                let name = &self.names[number];
                let operand = of(name)?;
                values[number] = operand.number;
                if let Some((_, sign)) = self.combined.iter().find(|(combined, _)| *combined == number)
                    && !operand.is_bit
                {
                    return Err(match sign {
                        Some(sign) => {
                            format!("NOT changes `{name}` alone; write `NOT ({name} {sign} …)` for the comparison")
                        }
                        None => {
                            let value = number_text(operand.number);
                            format!("{COMBINES}, but `{name}` is {value}; write `{name} <> 0`, or name a bit of it")
                        }
                    });
                }
            }
            value = part
                .expression
                .value(&|name: &str| number_of(name).and_then(|number| values.get(number)).copied().unwrap_or(0.0))?;
            if self.parts.len() > 1 && value == 0.0 {
                return Ok(0.0);
            }
        }
        Ok(if self.parts.len() > 1 { 1.0 } else { value })
    }

    /// A name alone.
    pub fn is_name(&self) -> bool {
        matches!(&self.names[..], [name] if name.trim() == self.text.trim())
    }
}

/// Whether AND, OR or NOT combines this operand as it is, and not what an operator or a function makes of it.
fn is_combined(tokens: &[Token<'_>], at: usize) -> bool {
    let text = |token: Option<&Token<'_>>, edge: &str| match token {
        Some(Token::Text(text)) => text.clone(),
        Some(Token::Name(_)) => String::new(),
        None => edge.to_string(),
    };
    let before = text(at.checked_sub(1).and_then(|at| tokens.get(at)), "(");
    let after = text(tokens.get(at + 1), ")");
    let joins = |text: &str| matches!(text, "&&" | "||");
    let begins = joins(&before) || matches!(&*before, "(" | "," | "!");
    let ends = joins(&after) || matches!(&*after, ")" | ",");
    begins && ends && (joins(&before) || joins(&after) || before == "!")
}

/// The sign that compares a name after NOT, which binds more: `NOT a = b` compares the opposite of a bit, and `NOT MW10 = 7` would
/// compare 0 or 1 with 7.
fn sign_after_not<'t>(tokens: &'t [Token<'_>], at: usize) -> Option<&'t str> {
    let text = |at: usize| match tokens.get(at)? {
        Token::Text(text) => Some(text.as_str()),
        Token::Name(_) => None,
    };
    if at.checked_sub(1).and_then(text) != Some("!") {
        return None;
    }
    match text(at + 1)? {
        "==" => Some("="),
        "!=" => Some("<>"),
        sign @ ("<" | "<=" | ">" | ">=") => Some(sign),
        _ => None,
    }
}

/// What the operators of conditions are for.
const COMBINES: &str = "AND, OR and NOT combine bits and comparisons here";

fn is_bit(number: f64) -> bool {
    number == 0.0 || number == 1.0
}

/// The number of a name in an expression.
fn number_of(name: &str) -> Option<usize> {
    name.strip_prefix('n')?.parse().ok()
}

enum Token<'a> {
    Name(&'a str),
    /// As the expression has it.
    Text(String),
}

/// The token at the beginning of a text, and what follows. `Err`: the error.
fn token(rest: &str, first: char) -> Result<(Token<'_>, &str), String> {
    for (own, other) in [
        (":=", None),
        ("<>", Some("!=")),
        ("==", Some("==")),
        ("!=", Some("!=")),
        ("<=", Some("<=")),
        (">=", Some(">=")),
        ("&&", Some("&&")),
        ("||", Some("||")),
        ("=", Some("==")),
        ("&", Some("&&")),
    ] {
        if let Some(after) = rest.strip_prefix(own) {
            let other = other.ok_or("a condition does not assign; write `=` to compare")?;
            return Ok((Token::Text(other.to_string()), after));
        }
    }
    if first == '\'' {
        return Err("conditions compare numbers, not texts".to_string());
    }
    if first.is_ascii_digit() {
        let end =
            rest.find(|c: char| !(c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | '#'))).unwrap_or(rest.len());
        let (number, after) = rest.split_at(exponent_end(rest, end));
        return Ok((Token::Text(literal(number)?), after));
    }
    if let Some((text, after)) = typed_literal(rest) {
        return Ok((Token::Text(literal(text)?), after));
    }
    if first.is_alphabetic() || matches!(first, '_' | '#' | '"' | '%') {
        let (name, after) = with_type(rest, name(rest)?);
        return Ok((word(name, after)?, after));
    }
    let (own, after) = rest.split_at(first.len_utf8());
    Ok((Token::Text(own.to_string()), after))
}

/// A word: an operator, a constant, a function, a name.
fn word<'a>(name: &'a str, after: &str) -> Result<Token<'a>, String> {
    let text = |text: &str| Ok(Token::Text(text.to_string()));
    match name.to_ascii_uppercase().as_str() {
        "AND" => return text("&&"),
        "OR" => return text("||"),
        "NOT" => return text("!"),
        "MOD" => return text("%"),
        "XOR" => return Err("a condition has AND, OR and NOT, not XOR; write `a <> b` for two bits".to_string()),
        "TRUE" => return text("1"),
        "FALSE" => return text("0"),
        _ => {}
    }
    if after.trim_start().starts_with('(') {
        return text(&name.to_ascii_lowercase());
    }
    Ok(Token::Name(name))
}

/// Types whose literals have `-` and `:` in them.
const DATES: [&str; 10] =
    ["D", "DATE", "TOD", "TIME_OF_DAY", "LTOD", "DT", "DATE_AND_TIME", "LDT", "DTL", "LTIME_OF_DAY"];

/// A literal with its type at the beginning of a text, `T#-5s`, `W#16#FF`, but not `#x`, and what follows.
fn typed_literal(text: &str) -> Option<(&str, &str)> {
    let (ty, value) = text.split_once('#')?;
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    if !ty.starts_with(|c: char| c.is_ascii_alphabetic()) || !ty.chars().all(is_part) {
        return None;
    }
    let has_signs = DATES.iter().any(|date| date.eq_ignore_ascii_case(ty));
    let is_within = |c: char| is_part(c) || matches!(c, '.' | '#') || has_signs && matches!(c, '-' | ':');
    let digits = value.strip_prefix('-').unwrap_or(value);
    let end = digits.find(|c: char| !is_within(c)).unwrap_or(digits.len());
    let is_float = ["REAL", "LREAL"].iter().any(|float| float.eq_ignore_ascii_case(ty));
    let end = if is_float { exponent_end(digits, end) } else { end };
    Some(text.split_at(text.len() - digits.len() + end))
}

/// The end of a number with the exponent of a float, which may have a sign: of `1.5E-3`, whose letters and digits end at `end`.
fn exponent_end(text: &str, end: usize) -> usize {
    let (number, after) = text.split_at(end);
    match after.strip_prefix(['+', '-']) {
        Some(digits) if number.ends_with(['e', 'E']) && !number.contains('#') => {
            end + 1 + digits.find(|c: char| !c.is_ascii_digit()).unwrap_or(digits.len())
        }
        Some(_) | None => end,
    }
}

/// A name with its members and indices, at the beginning of a text. `Err`: the error.
fn name(text: &str) -> Result<(&str, &str), String> {
    let mut end = 0;
    let mut letters = text.char_indices();
    while let Some((at, c)) = letters.next() {
        let closing = match c {
            '"' => '"',
            '[' => ']',
            // `r^.x`, and `r^ = 5`, but not the power `a^2`.
            '^' if at > 0 && !is_operand(text[at + 1..].trim_start()) => {
                end = at + 1;
                continue;
            }
            c if c.is_alphanumeric() || matches!(c, '_' | '.' | '#' | '%') => {
                end = at + c.len_utf8();
                continue;
            }
            _ => break,
        };
        let (at, _) = letters.find(|(_, c)| *c == closing).ok_or_else(|| format!("`{text}` has no `{closing}`"))?;
        end = at + 1;
    }
    Ok(text.split_at(end))
}

/// A name at the beginning of a text, and what follows, with the type as which it is read: `MD20 as REAL`.
fn with_type<'a>(text: &'a str, (name, after): (&'a str, &'a str)) -> (&'a str, &'a str) {
    let Some((word, rest)) = after.trim_start().split_once(' ') else { return (name, after) };
    let rest = rest.trim_start();
    let end = rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(rest.len());
    let (ty, after_type) = rest.split_at(end);
    match word.eq_ignore_ascii_case("as") && typed::from_word(ty).is_ok() {
        true => text.split_at(text.len() - after_type.len()),
        false => (name, after),
    }
}

/// Whether an operand begins with this text.
fn is_operand(text: &str) -> bool {
    text.starts_with(|c: char| c.is_alphanumeric() || matches!(c, '_' | '#' | '"' | '%' | '(' | '-' | '!'))
}

/// A whole number as expressions compute with it. `Err`: it would be rounded, and compared as another one.
pub fn whole(text: &str, number: i128) -> Result<f64, String> {
    let computed = number as f64;
    match computed as i128 == number {
        true => Ok(computed),
        false => Err(format!("`{text}` has more digits than a condition compares exactly")),
    }
}

/// A number as the expression has it. `Err`: the error.
fn literal(text: &str) -> Result<String, String> {
    let number = text.replace('_', "");
    if !text.contains('#') {
        if let Ok(number) = number.parse::<i128>() {
            whole(text, number)?;
        }
        return match number.parse::<f64>() {
            Ok(_) => Ok(number),
            Err(_) => Err(format!("`{text}` is not a number")),
        };
    }
    // Durations last: they take any number as milliseconds.
    let types = [
        AssertType::Unsigned(64),
        AssertType::Signed(64),
        AssertType::Lreal,
        AssertType::Bits(64),
        AssertType::Time,
        AssertType::Ltime,
        AssertType::S5Time,
    ];
    for ty in types {
        if let Ok(value) = typed::parse(text, ValueType::of(ty)) {
            let number = match (value.seconds(ty), value) {
                (Some(seconds), _) => seconds,
                (None, assertion::Value::Bits(bits)) if ty == AssertType::Lreal => f64::from_bits(bits),
                (None, assertion::Value::Bits(bits)) if ty == AssertType::Signed(64) => {
                    whole(text, bits.cast_signed().into())?
                }
                (None, assertion::Value::Bits(bits)) => whole(text, bits.into())?,
                (None, _) => continue,
            };
            return Ok(if number < 0.0 { format!("({number})") } else { format!("{number}") });
        }
    }
    // A pointer, as address registers are shown.
    match value::parse(text, Width::Dword) {
        Ok(bits) if text.starts_with(['P', 'p']) => Ok(bits.to_string()),
        Ok(_) | Err(_) => Err(format!("`{text}` is not a value that can be compared here")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> Result<f64, String> {
        let number = |number| Ok(Operand { number, is_bit: false });
        Condition::parse(text)?.value(&|name| match name {
            "MW10" => number(7.0),
            "MW12" => number(1.0),
            "MD20 as REAL" => number(2.5),
            "\"Motor on\"" | "#x.y[1, 2]" => Ok(Operand { number: 1.0, is_bit: true }),
            "DB1.t" | "#r^.x" | "r^" => number(5.0),
            _ => Err(format!("no {name}")),
        })
    }

    #[test]
    fn values() {
        for (text, expected) in [
            ("MW10 > 5", 1.0),
            ("MW10=7 AND \"Motor on\"", 1.0),
            ("NOT \"Motor on\" OR MW10 <> 7", 0.0),
            ("#x.y[1, 2] + MW10 * 2", 15.0),
            ("MW10 mod 4 = 3", 1.0),
            ("#r^.x + MW10^2", 54.0),
            ("r^ >= 5 AND r^=5", 1.0),
            ("DB1.t >= T#5s && DB1.t < T#5s1ms", 1.0),
            ("DB1.t > T#-5s AND DB1.t-T#-5s = 10", 1.0),
            ("MW10 - INT#-1 = 8", 1.0),
            ("MW10 > REAL#1.5E-3 AND MW10-LREAL#-7.0e+0 = 14", 1.0),
            ("MW10 = 16#E-7", 1.0),
            ("MW10 = P#0.7 AND MW10 < P#M0.0", 1.0),
            ("MW10 = 16#7 & MW10 = W#16#7", 1.0),
            ("abs(0 - MW10) == 7.0e0", 1.0),
            ("max(MW10, 1e+2)", 100.0),
            ("TRUE", 1.0),
            ("\"Motor on\" AND TRUE OR MW10 + 1 = 0", 1.0),
            ("MD20 as REAL > 2 AND MW10=7", 1.0),
            ("NOT (MW10 = 7 AND \"Motor on\")", 0.0),
            ("NOT (MW10 = 6)", 1.0),
            ("(NOT \"Motor on\") = FALSE", 1.0),
            ("NOT \"Motor on\" = FALSE AND MW10 = 7", 1.0),
            ("NOT \"Motor on\" = #x.y[1, 2]", 0.0),
            ("NOT \"Motor on\" <> #x.y[1, 2] OR NOT \"Motor on\" < TRUE", 1.0),
            ("9007199254740992 = 16#20000000000000", 1.0),
        ] {
            assert_eq!(value(text), Ok(expected), "{text}");
        }
    }

    #[test]
    fn what_is_wrong_is_told() {
        for (text, part) in [
            ("MW10 :=", "does not assign"),
            ("MW10 >", "not a condition"),
            ("MW10 = 'abc'", "not texts"),
            ("", "not a condition"),
            ("\"Motor", "has no `\"`"),
            ("Nowhere > 1", "no Nowhere"),
            ("T#x", "not a value"),
            ("MW10 = P#0.8", "`P#0.8` is not a value"),
            ("DB1.d = D#2026-02-28", "`D#2026-02-28` is not a value"),
            ("(DB1.d>TOD#12:30:00.5)", "`TOD#12:30:00.5` is not a value"),
            ("1x", "not a number"),
            ("MW10 as X > 1", "not a condition"),
            ("MW10 = 9007199254740993", "more digits than"),
            ("MW10 = 16#FFFFFFFFFFFFFFFF", "more digits than"),
            ("MW10 AND 16#4", "do not mask words"),
            ("(MW10 AND 16#4) <> 0", "do not mask words"),
            ("MW10 AND MW10 = 7", "bits and comparisons here, but `MW10` is 7"),
            ("NOT MW10", "write `MW10 <> 0`"),
            ("MW12 AND MW10 = 7", "but `MW12` is 1"),
            ("NOT MW12 = 1", "write `NOT (MW12 = …)`"),
            ("NOT MW10 = 7", "write `NOT (MW10 = …)`"),
            ("TRUE AND !MW10 <> 7", "write `NOT (MW10 <> …)`"),
            ("MW10 > 5 & MW10", "`MW10` is 7"),
            ("\"Motor on\" XOR MW10 = 7", "write `a <> b`"),
            (&"(".repeat(3000), "not a condition"),
            ("é§", "not a condition"),
        ] {
            let message = value(text).unwrap_err();
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}
