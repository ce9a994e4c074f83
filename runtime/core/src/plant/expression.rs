//! An expression of the plant: text over named values.
//!
//! Operators and the functions `abs`, `min`, `max`, `sin` and so on are those of the crate `fasteval`; `if`, `clamp`, `sqrt`,
//! `exp` and `ln` are defined here.

use fasteval::{Error, Evaler, ExpressionI, Parser, Slab};
use plcc_literal::count::counted;
use plcc_literal::distance::nearest;

/// Functions in addition to those of the crate: name and number of arguments.
const FUNCTIONS: [(&str, usize); 5] = [("if", 3), ("clamp", 3), ("sqrt", 1), ("exp", 1), ("ln", 1)];

/// Words that are functions of the crate.
const BUILT_IN: [&str; 22] = [
    "int", "ceil", "floor", "abs", "sign", "log", "round", "min", "max", "e", "pi", "sin", "cos", "tan", "asin",
    "acos", "atan", "sinh", "cosh", "tanh", "and", "or",
];

/// Operators and constants of PLC languages, and how they are written here.
const OTHER_WORDS: [(&str, &str); 6] =
    [("AND", "&&"), ("OR", "||"), ("NOT", "!"), ("MOD", "%"), ("TRUE", "1"), ("FALSE", "0")];

/// Functions of PLC languages, and what they are here.
const OTHER_FUNCTIONS: [(&str, &str); 3] =
    [("limit", "clamp(value, low, high)"), ("sel", "if(condition, yes, no)"), ("trunc", "int(value)")];

/// True for a name that a value may have.
pub(super) fn is_name(name: &str) -> bool {
    let mut letters = name.chars();
    letters.next().is_some_and(|first| first.is_ascii_alphabetic() || first == '_')
        && letters.all(|letter| letter.is_ascii_alphanumeric() || letter == '_')
        && !is_function(name)
}

fn is_function(name: &str) -> bool {
    BUILT_IN.contains(&name) || FUNCTIONS.iter().any(|(function, _)| *function == name)
}

/// Before the names of values: the crate reads `inflow` as infinity and `low`, `printer` as `print`.
const MARK: &str = "v_";

/// The expression with a mark before each name of a value.
fn marked(text: &str) -> String {
    let mut marked = String::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '.';
        let end = rest.find(|c| !is_part(c)).unwrap_or(rest.len()).max(first.len_utf8());
        let (word, after) = rest.split_at(end);
        if (first.is_ascii_alphabetic() || first == '_') && !is_function(word) {
            marked.push_str(MARK);
        }
        marked.push_str(word);
        rest = after;
    }
    marked
}

/// What is written as in a PLC language, as a sentence.
fn other_language(text: &str, is_known: impl Fn(&str) -> bool) -> Option<String> {
    let mut words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
    let other = words.find_map(|word| {
        let (_, own) = OTHER_WORDS.iter().find(|(other, _)| other.eq_ignore_ascii_case(word))?;
        (!is_function(word) && !is_known(word)).then_some((word, *own))
    });
    if let Some((word, own)) = other {
        return Some(format!("`{text}`: `{word}` is written `{own}` here"));
    }
    if text.contains("<>") {
        return Some(format!("`{text}`: `<>` is written `!=` here"));
    }
    let compares = text.replace("==", "").replace("<=", "").replace(">=", "").replace("!=", "").contains('=');
    compares.then(|| format!("`{text}`: a comparison is written `==` here"))
}

/// An expression that was parsed.
pub struct Expression {
    slab: Slab,
    root: ExpressionI,
}

impl std::fmt::Debug for Expression {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Expression").finish_non_exhaustive()
    }
}

impl Expression {
    /// Parses `text`; each name in it must be one that `is_known`. `Err`: the error as a sentence.
    pub fn parse(text: &str, is_known: impl Fn(&str) -> bool) -> Result<Expression, String> {
        if !text.is_ascii() || text.contains(['"', '[', ']']) {
            return Err(format!("`{text}` is not an expression: write numbers, names, operators and functions"));
        }
        if let Some(message) = other_language(text, &is_known) {
            return Err(message);
        }
        let mut slab = Slab::new();
        let root = Parser::new().parse(&marked(text), &mut slab.ps).map_err(|error| wrong(text, &error))?;
        let names = root.from(&slab.ps).var_names(&slab);
        let values = names.iter().filter_map(|name| name.strip_prefix(MARK));
        if let Some(name) = values.into_iter().find(|name| !is_known(name)) {
            if text.replace(' ', "").contains(&format!("{name}(")) {
                return Err(unknown_function(name));
            }
            return Err(format!(
                "`{name}` is not known here; use values that are read, earlier equations, states or parameters"
            ));
        }
        let expression = Expression { slab, root };
        // Calls with another number of arguments show when they are evaluated.
        match expression.evaluate(&|_| 1.0) {
            Ok(_) => Ok(expression),
            Err(error) => Err(wrong(text, &error)),
        }
    }

    /// The value, with `of` as the values of names. `Err`: the error as a sentence.
    pub fn value(&self, of: &dyn Fn(&str) -> f64) -> Result<f64, String> {
        self.evaluate(of).map_err(|error| wrong("the expression", &error))
    }

    /// The value, with `of` as the values of names.
    pub(super) fn evaluate(&self, of: &dyn Fn(&str) -> f64) -> Result<f64, Error> {
        let mut names = |name: &str, arguments: Vec<f64>| match (name, arguments.as_slice()) {
            ("if", &[condition, yes, no]) => Some(if condition != 0.0 { yes } else { no }),
            // Not f64::clamp, which panics if the limits are crossed.
            ("clamp", &[value, low, high]) => Some(value.min(high).max(low)),
            ("sqrt", &[value]) => Some(value.sqrt()),
            ("exp", &[value]) => Some(value.exp()),
            ("ln", &[value]) => Some(value.ln()),
            (_, []) => name.strip_prefix(MARK).map(of),
            _ => None,
        };
        self.root.from(&self.slab.ps).eval(&self.slab, &mut names)
    }
}

/// A call of something that is neither a function nor a value.
fn unknown_function(name: &str) -> String {
    if let Some((_, own)) = OTHER_FUNCTIONS.iter().find(|(other, _)| other.eq_ignore_ascii_case(name)) {
        return format!("`{name}` is written `{own}` here");
    }
    let is_called = |word: &&str| !["e", "pi", "and", "or"].contains(word);
    let functions = || FUNCTIONS.into_iter().map(|(function, _)| function).chain(BUILT_IN).filter(is_called);
    match nearest(name, functions()) {
        Some(meant) => format!("`{name}` is not a known function; did you mean `{meant}`?"),
        None => {
            let list: Vec<&str> = functions().collect();
            format!("`{name}` is not a known function; the functions are {}", list.join(", "))
        }
    }
}

/// The crate's error in words.
fn wrong(text: &str, error: &Error) -> String {
    match error {
        Error::UnparsedTokensRemaining(rest) if let Some(meant) = with_point(text, rest) => {
            format!("`{text}`: a number has a point; write `{meant}`")
        }
        Error::UnparsedTokensRemaining(rest) => {
            format!("`{text}`: `{}` is not understood", rest.replace(MARK, "").trim())
        }
        Error::EOF | Error::EofWhileParsing(_) if text.matches('(').count() > text.matches(')').count() => {
            format!("`{text}` ends too early: a `)` is missing")
        }
        Error::EOF | Error::EofWhileParsing(_) => format!("`{text}` ends too early"),
        Error::TooLong | Error::TooDeep | Error::SlabOverflow => format!("`{text}` is too large"),
        Error::Undefined(name) => match FUNCTIONS.iter().find(|(function, _)| function == name) {
            Some((name, count)) => format!("`{text}`: {name} takes {}", counted(*count, "argument")),
            None => format!("`{text}`: `{}` is not a known function", name.trim_start_matches(MARK)),
        },
        _ => format!("`{text}` is not an expression: write numbers, names, operators and functions"),
    }
}

/// `x + 1.5` for `x + 1,5`, which is read up to the comma; `rest`: from there on.
fn with_point(text: &str, rest: &str) -> Option<String> {
    if !rest.trim_start().starts_with(',') {
        return None;
    }
    let is_digit = |at: usize| text.as_bytes().get(at).is_some_and(u8::is_ascii_digit);
    // The commas before it separate arguments.
    let (at, _) = text.rmatch_indices(',').nth(rest.matches(',').count() - 1)?;
    if at == 0 || !is_digit(at - 1) || !is_digit(at + 1) {
        return None;
    }
    Some(format!("{}.{}", &text[..at], &text[at + 1..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> Result<f64, String> {
        let expression = Expression::parse(text, |name| ["level", "pump", "inflow", "printer", "nan"].contains(&name))?;
        expression.evaluate(&|name| if name == "level" { 9.0 } else { 1.0 }).map_err(|error| format!("{error:?}"))
    }

    #[test]
    fn values() {
        for (text, expected) in [
            ("2 + 3 * level", 29.0),
            ("if(pump, sqrt(level), 0)", 3.0),
            ("if(level > 10 && pump, 1, 2)", 2.0),
            ("clamp(level, 0, 5)", 5.0),
            ("min(level, 4, 7) - max(1, 2)", 2.0),
            ("(level - 1) / 2 * 3", 12.0),
            ("10 - 4 + 3", 9.0),
            ("inflow + printer * nan - e()", 2.0 - std::f64::consts::E),
            ("1e1 + 2.5e-1", 10.25),
            ("exp(ln(1)) + pi()", 1.0 + std::f64::consts::PI),
        ] {
            assert_eq!(value(text), Ok(expected), "{text}");
        }
    }

    #[test]
    fn what_is_wrong_is_told() {
        for (text, part) in [
            ("2 +", "ends too early"),
            ("", "ends too early"),
            ("level level", "`level` is not understood"),
            ("level + 1,5 * level", "a number has a point; write `level + 1.5 * level`"),
            ("max(1,2) + 1,5", "a number has a point; write `max(1,2) + 1.5`"),
            ("lvel", "`lvel` is not known here"),
            ("sqr(level)", "`sqr` is not a known function; did you mean `sqrt`?"),
            ("scale(level)", "`scale` is not a known function; the functions are if, clamp, sqrt"),
            ("LIMIT(0, level, 1)", "`LIMIT` is written `clamp(value, low, high)` here"),
            ("if(level > 1 AND pump, 1, 0)", "`AND` is written `&&` here"),
            ("not pump", "`not` is written `!` here"),
            ("level <> 1", "`<>` is written `!=` here"),
            ("if(level = 1, 2, 3)", "a comparison is written `==` here"),
            ("(level + 1", "ends too early: a `)` is missing"),
            ("sqrt(1, 2)", "sqrt takes 1 argument"),
            ("if(1)", "if takes 3 arguments"),
            ("clamp", "clamp takes 3 arguments"),
            ("level(3)", "`level` is not a known function"),
            ("print(\"x\")", "not an expression"),
            ("höhe", "not an expression"),
            (&"(".repeat(5000), "too large"),
            (&"(".repeat(100), "too large"),
        ] {
            let message = value(text).unwrap_err();
            assert!(message.contains(part), "{text}: {message}");
        }
    }

    #[test]
    fn names() {
        assert!(is_name("level_1") && is_name("_x"));
        for name in ["1x", "", "a b", "if", "min", "sqrt", "größe"] {
            assert!(!is_name(name), "{name}");
        }
    }
}
