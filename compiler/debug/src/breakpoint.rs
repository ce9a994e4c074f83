//! Breakpoints: where, and under which condition.

use std::cell::Cell;

use plcc_model::BlockKey;
use serde_json::Value;

use crate::condition::{Condition, Operand};

/// Where a breakpoint is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum At {
    Places(Vec<u32>),
    /// The first statement of a block.
    Block(BlockKey),
}

/// A breakpoint or a log point.
pub struct Breakpoint {
    pub id: u64,
    pub at: At,
    pub when: When,
}

/// Under which condition it stops.
pub struct When {
    condition: Option<Condition>,
    hits: Option<Hits>,
    /// How often the condition was met.
    met: Cell<u64>,
    /// Instead of a stop: text with expressions in braces.
    pub log: Option<String>,
}

/// `5`: from the fifth time on only then; `>= 5`, `% 5`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Hits {
    Equal(u64),
    AtLeast(u64),
    MoreThan(u64),
    AtMost(u64),
    Each(u64),
}

impl Hits {
    fn parse(text: &str) -> Result<Hits, String> {
        let wrong = || format!("`{text}` is not a hit count; write 5, >= 5 or % 5");
        let (make, rest): (fn(u64) -> Hits, &str) = match text.trim() {
            text if text.starts_with(">=") => (Hits::AtLeast, &text[2..]),
            text if text.starts_with("<=") => (Hits::AtMost, &text[2..]),
            text if text.starts_with("==") => (Hits::Equal, &text[2..]),
            text if text.starts_with('>') => (Hits::MoreThan, &text[1..]),
            text if text.starts_with('=') => (Hits::Equal, &text[1..]),
            text if text.starts_with('%') => (Hits::Each, &text[1..]),
            text => (Hits::Equal, text),
        };
        let number = rest.trim().parse().map_err(|_| wrong())?;
        match make(number) {
            Hits::Each(0) => Err(wrong()),
            hits => Ok(hits),
        }
    }

    fn holds(self, met: u64) -> bool {
        match self {
            Hits::Equal(number) => met == number,
            Hits::AtLeast(number) => met >= number,
            Hits::MoreThan(number) => met > number,
            Hits::AtMost(number) => met <= number,
            Hits::Each(number) => met.is_multiple_of(number),
        }
    }
}

impl When {
    /// Reads `condition`, `hitCondition` and `logMessage`. `Err`: the error.
    pub fn read(given: &Value) -> Result<When, String> {
        let text = |name: &str| given.get(name).and_then(Value::as_str).map(str::trim).filter(|text| !text.is_empty());
        Ok(When {
            condition: text("condition").map(Condition::parse).transpose()?,
            hits: text("hitCondition").map(Hits::parse).transpose()?,
            met: Cell::new(0),
            log: text("logMessage").map(str::to_string),
        })
    }

    /// Whether it stops now. `Err`: the condition has no value; the user must know.
    pub fn holds(&self, of: &dyn Fn(&str) -> Result<Operand, String>) -> Result<bool, String> {
        if let Some(condition) = &self.condition
            && condition.value(of).map_err(|error| format!("{}: {error}", condition.text))? == 0.0
        {
            return Ok(false);
        }
        self.met.set(self.met.get() + 1);
        Ok(self.hits.is_none_or(|hits| hits.holds(self.met.get())))
    }

    /// The program starts once more.
    pub fn reset(&self) {
        self.met.set(0);
    }
}

/// The text of a log point, with `of` as the values of expressions in braces.
pub fn logged(text: &str, of: &dyn Fn(&str) -> Result<String, String>) -> String {
    let mut logged = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('{') {
        logged.push_str(before);
        let Some((expression, after)) = after.split_once('}') else {
            logged.push('{');
            rest = after;
            break;
        };
        logged.push_str(&of(expression).unwrap_or_else(|error| format!("<{error}>")));
        rest = after;
    }
    logged.push_str(rest);
    logged
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hit_counts() {
        let hits = |text: &str| -> Vec<u64> {
            let hits = Hits::parse(text).unwrap();
            (1..=6).filter(|met| hits.holds(*met)).collect()
        };
        assert_eq!(hits("3"), [3]);
        assert_eq!(hits(">= 5"), [5, 6]);
        assert_eq!(hits("> 5"), [6]);
        assert_eq!(hits("<=2"), [1, 2]);
        assert_eq!(hits("%2"), [2, 4, 6]);
        for wrong in ["", "x", "% 0", "-1", ">=", "é"] {
            assert!(Hits::parse(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn log_points() {
        let of = |name: &str| if name == "MW0" { Ok("7".to_string()) } else { Err(format!("no {name}")) };
        assert_eq!(logged("a {MW0} b", &of), "a 7 b");
        assert_eq!(logged("{x}{MW0", &of), "<no x>{MW0");
    }
}
