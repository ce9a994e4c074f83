//! What the statements of a block see in one call, as the CPU tells it.

use std::collections::HashMap;

use serde::Deserialize;
use serde_json::Value;

use crate::messages::{Activation, StatusNews, Step};

/// A place of the source where the program tells something: its first byte, the byte after it, and what is told.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Place(pub i64, pub i64, pub Tells);

/// What is told at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Tells {
    /// That the block begins.
    Block,
    /// The registers after a statement of STL.
    Registers,
    /// A variable that is read, a value that is computed, a variable that is written.
    Variable,
    Value,
    Written,
    /// The logic stack of an S7-200.
    Stack,
    /// That a statement has run.
    Ran,
}

/// The bit STA of the status word.
pub const STA_BIT: u64 = 2;

/// The values of a bit.
static BITS: [Value; 2] = [Value::Bool(false), Value::Bool(true)];

/// What is known of a call.
#[derive(Clone, Debug, Default)]
pub struct Status {
    places: Vec<Place>,
    /// Numbers of the places that begin at a byte.
    at: HashMap<i64, Vec<usize>>,
    /// What was told, by place; `None`: the call did not come there.
    seen: Vec<Option<Value>>,
    /// The steps of a chart.
    pub steps: Vec<Step>,
    /// Those that have become active since the block is watched, the newest first.
    pub history: Vec<Activation>,
    /// The calls of the block so far.
    pub calls: Vec<String>,
    /// The one that is shown, and its cycle.
    pub call: Option<(usize, u64)>,
}

impl Status {
    pub fn new(places: Vec<Place>) -> Status {
        let mut at: HashMap<i64, Vec<usize>> = HashMap::new();
        for (number, place) in places.iter().enumerate() {
            at.entry(place.0).or_default().push(number);
        }
        Status { seen: vec![None; places.len()], places, at, ..Status::default() }
    }

    /// Another call is asked for: nothing is known of it yet.
    pub fn forget(&mut self) {
        self.seen.fill(None);
        self.steps.clear();
        self.history.clear();
        self.call = None;
    }

    pub fn take(&mut self, news: StatusNews) {
        for (number, value) in news.seen {
            if let Some(seen) = self.seen.get_mut(number) {
                *seen = Some(value).filter(|value| !value.is_null());
            }
        }
        if let Some(steps) = news.steps {
            self.steps = steps;
        }
        if let Some(history) = news.history {
            self.history = history;
        }
        if let Some(calls) = news.calls {
            self.calls = calls;
        }
        self.call = news.call.or(self.call);
    }

    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// What was told at the place with this number.
    pub fn seen(&self, number: usize) -> Option<&Value> {
        self.seen.get(number)?.as_ref()
    }

    /// What was told at a byte of the source: of several places that begin there the shortest one, and of those one that was reached.
    pub fn seen_at(&self, from: u32, kinds: &[Tells]) -> Option<&Value> {
        let order = |&number: &usize| {
            let Place(_, to, tells) = self.places.get(number)?;
            let rank = kinds.iter().position(|kind| kind == tells)?;
            Some(((self.seen(number).is_none(), rank, *to), number))
        };
        let found = self.at.get(&i64::from(from))?.iter().filter_map(order).min()?;
        self.seen(found.1)
    }

    /// The value of the operand at a byte of the source.
    pub fn operand_at(&self, from: u32) -> Option<&Value> {
        self.seen_at(from, &[Tells::Variable, Tells::Written, Tells::Value]).or_else(|| self.bit_at(from))
    }

    /// The bit that the statement at a byte of a list has as operand: STA after it in STL, its value beside the stack of an S7-200.
    fn bit_at(&self, from: u32) -> Option<&Value> {
        let of_registers = || {
            let status_word = self.seen_at(from, &[Tells::Registers])?.get(0)?.as_u64()?;
            Some(status_word >> STA_BIT & 1 == 1)
        };
        let of_stack = || {
            let (operand, others) = self.seen_at(from, &[Tells::Stack])?.get(1)?.as_array()?.split_first()?;
            let name = operand.get(0)?.as_str()?;
            // The symbol or the current value of a word may be 1, too. The box of a timer or counter has its value after the bit.
            let is_bit = name.contains('.') && !name.ends_with(".VALUE") || is_cell(name) && others.is_empty();
            match operand.get(1)?.as_str()? {
                "0" if is_bit => Some(false),
                "1" if is_bit => Some(true),
                _ => None,
            }
        };
        let bit = of_registers().or_else(of_stack)?;
        Some(&BITS[usize::from(bit)])
    }

    /// The result of a comparison in an expression: that of the shortest expression that has both operands in it.
    pub fn compared_at(&self, left: u32, right: u32) -> Option<&Value> {
        let (left, right) = (i64::from(left), i64::from(right));
        let fits = |place: &Place| place.2 == Tells::Value && place.0 <= left && place.1 > right;
        let fitting = self.places.iter().enumerate().filter(|(_, place)| fits(place));
        let order = |&(number, place): &(usize, &Place)| (place.1.saturating_sub(place.0), self.seen(number).is_none());
        self.seen(fitting.min_by_key(order)?.0)
    }
}

/// Whether a name is that of a timer or counter: `T37`.
fn is_cell(name: &str) -> bool {
    name.strip_prefix(['T', 'C']).is_some_and(|number| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()))
}

/// A value as PLC languages write it.
pub fn text(value: &Value) -> String {
    match value {
        Value::Bool(true) => "TRUE".to_string(),
        Value::Bool(false) => "FALSE".to_string(),
        Value::String(text) => text.clone(),
        Value::Null | Value::Number(_) | Value::Array(_) | Value::Object(_) => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// The bit that a statement of an S7-200 has, if these are its operands.
    fn bit(operands: Value) -> Option<bool> {
        let mut status = Status::new(vec![Place(7, 12, Tells::Stack)]);
        status.take(StatusNews { seen: vec![(0, json!([1, operands]))], ..StatusNews::default() });
        status.operand_at(7).and_then(Value::as_bool)
    }

    #[test]
    fn contacts_of_timers_have_a_bit() {
        assert_eq!(bit(json!([["I0.0", "1"]])), Some(true));
        assert_eq!(bit(json!([["T37", "1"]])), Some(true));
        assert_eq!(bit(json!([["C5", "0"]])), Some(false));
        assert_eq!(bit(json!([["T37.VALUE", "1"]])), None);
        assert_eq!(bit(json!([["VW0", "1"]])), None);
        assert_eq!(bit(json!([["T37", "0"], ["T37.VALUE", "0"]])), None);
        assert_eq!(bit(json!([])), None);
    }
}
