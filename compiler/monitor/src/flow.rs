//! The power flow of a drawn network: the program tells it after contacts and gates; what it does not tell follows from the operands at
//! their places, as in the page.

use std::collections::HashMap;

use serde::Deserialize;
use serde_json::Value;

use crate::status::{Status, Tells};

/// The logic of a network: for each net the terms of which it is the OR. See `logic.rs` of the crate view.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct Logic {
    pub nets: Vec<Vec<Term>>,
    /// For each term of each net the place of its element in the source, if it has one.
    pub places: Vec<Vec<Option<u32>>>,
    /// Contacts: number of the part, place of the operand, and whether they are open at 1.
    pub contacts: Vec<(usize, u32, bool)>,
}

/// What feeds a net.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(from = "Vec<Value>")]
pub enum Term {
    Rail,
    /// All inputs, one of them, an odd number of them.
    All(Vec<Input>),
    Any(Vec<Input>),
    Odd(Vec<Input>),
    /// The result of a comparison, or its opposite, while there is flow: where its operands are in the source.
    Compare {
        flow: Option<usize>,
        left: u32,
        right: u32,
        inverse: bool,
    },
    Unknown,
}

/// An input of a term.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    from: Origin,
    negated: bool,
}

#[derive(Clone, Debug, PartialEq)]
enum Origin {
    Net(usize),
    Constant(bool),
    /// The operand at this place of the source.
    Place(u32),
    Unknown,
}

impl From<Vec<Value>> for Term {
    fn from(parts: Vec<Value>) -> Term {
        let inputs = || parts.iter().skip(1).map(Input::of).collect();
        match parts.first().and_then(Value::as_str) {
            Some("r") => Term::Rail,
            Some("&") => Term::All(inputs()),
            Some("|") => Term::Any(inputs()),
            Some("^") => Term::Odd(inputs()),
            Some("?") => Term::compare(&parts).unwrap_or(Term::Unknown),
            _ => Term::Unknown,
        }
    }
}

impl Term {
    fn compare(parts: &[Value]) -> Option<Term> {
        let told = parts.get(6)?;
        let place = |at: usize| told.get(at)?.as_u64()?.try_into().ok();
        Some(Term::Compare {
            flow: parts.get(1).and_then(net),
            left: place(0)?,
            right: place(1)?,
            inverse: told.get(2)?.as_bool()?,
        })
    }

    fn value(&self, nets: &HashMap<usize, bool>, status: &Status) -> Option<bool> {
        let list =
            |inputs: &[Input]| -> Vec<Option<bool>> { inputs.iter().map(|input| input.value(nets, status)).collect() };
        match self {
            Term::Rail => Some(true),
            Term::All(inputs) => all(&list(inputs)),
            Term::Any(inputs) => any(&list(inputs)),
            Term::Odd(inputs) => {
                let values: Option<Vec<bool>> = list(inputs).into_iter().collect();
                values.map(|values| values.iter().filter(|value| **value).count() % 2 == 1)
            }
            Term::Compare { flow, left, right, inverse } => {
                let flow = flow.map_or(Some(true), |net| nets.get(&net).copied());
                let result = status.compared_at(*left, *right).and_then(Value::as_bool);
                all(&[flow, result.map(|result| result != *inverse)])
            }
            Term::Unknown => None,
        }
    }
}

impl Input {
    fn of(value: &Value) -> Input {
        let operand = |key: &str| match key.to_ascii_uppercase().as_str() {
            "TRUE" => Origin::Constant(true),
            "FALSE" => Origin::Constant(false),
            _ => {
                let place = value.get(2).and_then(Value::as_u64).and_then(|place| place.try_into().ok());
                place.map_or(Origin::Unknown, Origin::Place)
            }
        };
        let first = value.get(0);
        let from = match first.and_then(Value::as_str) {
            Some(key) => operand(key),
            None => first.and_then(net).map_or(Origin::Unknown, Origin::Net),
        };
        Input { from, negated: value.get(1).and_then(Value::as_bool).unwrap_or(false) }
    }

    fn value(&self, nets: &HashMap<usize, bool>, status: &Status) -> Option<bool> {
        let value = match &self.from {
            Origin::Net(net) => nets.get(net).copied(),
            Origin::Constant(value) => Some(*value),
            Origin::Place(place) => status.operand_at(*place).and_then(Value::as_bool),
            Origin::Unknown => None,
        };
        value.map(|value| value != self.negated)
    }
}

fn net(value: &Value) -> Option<usize> {
    value.as_u64()?.try_into().ok()
}

/// The values of the nets that can be known.
pub fn flow(logic: &Logic, status: &Status) -> HashMap<usize, bool> {
    let mut known: HashMap<usize, bool> = HashMap::new();
    let mut open: Vec<usize> = (0..logic.nets.len()).filter(|net| !logic.nets[*net].is_empty()).collect();
    loop {
        let before = open.len();
        open.retain(|&net| {
            let places = logic.places.get(net);
            let term = |(at, term): (usize, &Term)| {
                let place = places.and_then(|places| places.get(at).copied().flatten());
                let told = place.and_then(|place| status.seen_at(place, &[Tells::Written])).and_then(Value::as_bool);
                told.or_else(|| term.value(&known, status))
            };
            let terms: Vec<Option<bool>> = logic.nets[net].iter().enumerate().map(term).collect();
            match any(&terms) {
                Some(value) => {
                    known.insert(net, value);
                    false
                }
                None => true,
            }
        });
        // Nets feed each other in any order; each round settles at least one more.
        if open.len() == before {
            return known;
        }
    }
}

fn any(values: &[Option<bool>]) -> Option<bool> {
    if values.contains(&Some(true)) {
        Some(true)
    } else if values.contains(&None) {
        None
    } else {
        Some(false)
    }
}

fn all(values: &[Option<bool>]) -> Option<bool> {
    if values.contains(&Some(false)) {
        Some(false)
    } else if values.contains(&None) {
        None
    } else {
        Some(true)
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{from_value, json};

    use super::*;
    use crate::messages::StatusNews;

    #[test]
    fn what_is_not_told_follows_from_operands() {
        let logic = json!({"nets": [
            [["r"]],
            [["|", ["I0.0", false, 1], ["I0.1", false, 5]]],
            [["^", ["I0.0", false, 1], ["TRUE", false]]],
            [["?", 0, ">=", "MW0", "7", false, [10, 20, true]]],
            [["&", [1, false], [3, true]]],
            [["u"]],
            [["?", 5, "<", "MW0", "7", false, [10, 20, false]]],
            [],
            [["&", [9, false]]],
            [["&", [8, false]], ["&", ["I0.2", true]]],
        ]});
        let logic: Logic = from_value(logic).expect("it is what the page gets");
        let places = json!([[1, 3, "variable"], [5, 7, "variable"], [8, 30, "value"], [10, 25, "value"]]);
        let mut status = Status::new(from_value(places).expect("they are places"));
        let seen = vec![(0, json!(false)), (1, json!(true)), (2, json!(false)), (3, json!(true))];
        status.take(StatusNews { seen, ..StatusNews::default() });
        let expected = [(0, true), (1, true), (2, true), (3, false), (4, true)];
        assert_eq!(flow(&logic, &status), HashMap::from(expected));
    }
}
