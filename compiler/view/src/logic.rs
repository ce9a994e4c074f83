//! Where the power flows: the value of each net from the values of operands. A value may be unknown: a trace has only some operands, and
//! what a box does is not computed here.

use std::collections::HashMap;

use plcc_literal::duration::{self, Fraction, Smallest};

use crate::sheet::{Label, Link, Look, Meaning, Part, Pin, Place, Sheet, Source};

/// The logic of a network: for each net the terms of which it is the OR.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Logic {
    pub nets: Vec<Vec<Term>>,
    /// For each term of each net the place of its element in the source, if it has one.
    pub places: Vec<Vec<Option<u32>>>,
    /// Nets whose value is that of a coil, if nothing else is known.
    pub coils: Vec<(usize, String)>,
    /// Contacts: their parts, where their operands are in the source, and whether they are open at 1.
    pub contacts: Vec<(usize, u32, bool)>,
}

/// What feeds a net.
#[derive(Clone, Debug, PartialEq)]
pub enum Term {
    Rail,
    /// An input as it is.
    Same(Input),
    /// All inputs, one of them, an odd number of them.
    All(Vec<Input>),
    Any(Vec<Input>),
    Odd(Vec<Input>),
    /// A comparison of two operands, while the flow is 1.
    Compare {
        flow: Option<usize>,
        sign: String,
        left: String,
        right: String,
        reading: Reading,
        told: Option<Told>,
    },
    Unknown,
}

/// What the digits of a number in a comparison mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    Signed,
    Unsigned,
    Real,
}

impl Reading {
    /// As the script of a page knows it.
    fn word(self) -> &'static str {
        match self {
            Reading::Signed => "signed",
            Reading::Unsigned => "unsigned",
            Reading::Real => "real",
        }
    }
}

/// Where a program that is watched tells the result of a comparison: in an expression, it is the value that begins with the left operand and
/// has the right one in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Told {
    pub left: u32,
    pub right: u32,
    /// It is that of the opposite sign.
    pub inverse: bool,
}

/// An input of a term.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    pub value: Value,
    pub negated: bool,
    /// Of an operand: where it is in the source.
    pub place: Option<u32>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Net(usize),
    /// The key of an operand, or a constant.
    Operand(String),
}

/// The logic of a sheet.
pub fn logic(sheet: &Sheet) -> Logic {
    let mut logic = Logic::default();
    let rail = || match sheet.rail.as_str() {
        "" => Term::Rail,
        key => Term::Same(Input { value: Value::Operand(key.to_string()), negated: false, place: None }),
    };
    for net in &sheet.nets {
        let terms = net.sources.iter().map(|source| match source {
            Source::Rail => rail(),
            Source::Net(net) => Term::Same(Input { value: Value::Net(*net), negated: false, place: None }),
            Source::Operand { label, negated } => {
                Term::Same(Input { value: operand(label), negated: *negated, place: label.place })
            }
            Source::Pin { part, pin } => match sheet.parts.get(*part) {
                Some(of) if of.flow_out == Some(*pin) => term(of),
                _ => Term::Unknown,
            },
        });
        let places = net.sources.iter().map(|source| match source {
            Source::Pin { part, .. } => sheet.parts.get(*part).and_then(|part| part.place),
            Source::Rail | Source::Net(_) | Source::Operand { .. } => None,
        });
        logic.places.push(places.collect());
        logic.nets.push(terms.collect());
    }
    // The rail has a number of its own.
    logic.nets.push(vec![rail()]);
    for (at, part) in sheet.parts.iter().enumerate() {
        if let (Meaning::Contact { negated }, Some(place)) = (&part.meaning, part.place) {
            logic.contacts.push((at, place, *negated));
        }
        let plain = matches!(&part.look, Look::Coil { sign } if sign.is_empty())
            || matches!(&part.look, Look::Box { title, .. } if title == "=");
        let target = part.pins.iter().find(|pin| pin.place == Place::Above);
        if let (true, Some(net), Some(Link::Operand(label))) =
            (plain, part.net(part.flow_in), target.map(|pin| &pin.link))
        {
            logic.coils.push((net, label.key.clone()));
        }
    }
    logic
}

fn operand(label: &Label) -> Value {
    Value::Operand(if label.key.is_empty() { label.text.clone() } else { label.key.clone() })
}

fn input(pin: &Pin) -> Option<Input> {
    let (value, place) = match &pin.link {
        Link::Net(net) => (Value::Net(*net), None),
        Link::Operand(label) => (operand(label), label.place),
        Link::Open => return None,
    };
    Some(Input { value, negated: pin.negated, place })
}

fn term(part: &Part) -> Term {
    let inputs = || part.pins.iter().filter(|pin| !pin.output).filter_map(input);
    let flow = part.flow_in.and_then(|pin| input(&part.pins[pin]));
    match &part.meaning {
        Meaning::Contact { negated } => {
            let operands = part.pins.iter().filter(|pin| pin.place == Place::Above).filter_map(input);
            let operands = operands.map(|input| Input { negated: *negated, ..input });
            Term::All(flow.into_iter().chain(operands).collect())
        }
        Meaning::Not => flow.map_or(Term::Unknown, |flow| Term::Same(Input { negated: !flow.negated, ..flow })),
        Meaning::And => Term::All(inputs().collect()),
        Meaning::Or => Term::Any(inputs().collect()),
        Meaning::Xor => Term::Odd(inputs().collect()),
        Meaning::Through => flow.map_or(Term::Unknown, Term::Same),
        Meaning::Compare { sign, inverse } => {
            let mut operands = part.pins.iter().enumerate().filter(|(at, _)| Some(*at) != part.flow_in).filter_map(
                |(_, pin)| match (&pin.link, pin.output) {
                    (Link::Operand(label), false) => match operand(label) {
                        Value::Operand(key) => Some((key, label.place)),
                        Value::Net(_) => None,
                    },
                    _ => None,
                },
            );
            match (operands.next(), operands.next()) {
                (Some((left, at)), Some((right, other))) => {
                    let (left, right) = (as_compared(&part.look, left), as_compared(&part.look, right));
                    let reading = reading(&part.look, [&left, &right]);
                    let told = at.zip(other).map(|(left, right)| Told { left, right, inverse: *inverse });
                    Term::Compare { flow: part.net(part.flow_in), sign: sign.clone(), left, right, reading, told }
                }
                _ => Term::Unknown,
            }
        }
        Meaning::Other => Term::Unknown,
    }
}

/// The type of a comparison; empty if it is not known.
fn type_of(look: &Look) -> &str {
    match look {
        Look::Compare { ty, .. } => ty.trim(),
        Look::Box { detail, .. } => detail.trim(),
        _ => "",
    }
}

/// An operand of a comparison: constants of double words have all of their digits, since 16#FFFF alone would be the INT -1, and those in base 2
/// or 8 are in base 16, as values are.
fn as_compared(look: &Look, text: String) -> String {
    let is_double = ["D", "DI", "DINT", "DWORD"].iter().any(|ty| ty.eq_ignore_ascii_case(type_of(look)));
    let bits = [("16#", 16), ("8#", 8), ("2#", 2)].into_iter().find_map(|(prefix, base)| {
        let digits = text.strip_prefix(prefix)?.replace('_', "");
        u64::from_str_radix(&digits, base).ok()
    });
    match bits {
        Some(bits) if is_double => format!("16#{bits:08X}"),
        Some(bits) if !text.starts_with("16#") => format!("16#{bits:04X}"),
        _ => text,
    }
}

/// How a comparison reads numbers: by its type, or without one by a constant.
fn reading(look: &Look, operands: [&String; 2]) -> Reading {
    const UNSIGNED: [&str; 8] = ["USINT", "UINT", "UDINT", "ULINT", "BYTE", "WORD", "DWORD", "LWORD"];
    let is_one_of = |types: &[&str], ty: &str| types.iter().any(|one| one.eq_ignore_ascii_case(ty));
    let has_point = |text: &&String| text.contains('.') && text.replace('_', "").parse::<f64>().is_ok();
    match type_of(look) {
        "" if operands.iter().any(has_point) => Reading::Real,
        ty if is_one_of(&["R", "REAL", "LREAL"], ty) => Reading::Real,
        ty if is_one_of(&UNSIGNED, ty) => Reading::Unsigned,
        _ => Reading::Signed,
    }
}

impl Logic {
    /// The values of nets that can be known; `value` finds the value of an operand as text.
    pub fn values(&self, value: &dyn Fn(&str) -> Option<String>) -> HashMap<usize, bool> {
        let mut known: HashMap<usize, bool> = HashMap::new();
        let bit = |key: &str| match key.to_ascii_uppercase().as_str() {
            // SM0.0 of an S7-200 is always 1.
            "TRUE" | "SM0.0" => Some(true),
            "FALSE" => Some(false),
            _ => match value(key)?.as_str() {
                "1" | "TRUE" => Some(true),
                "0" | "FALSE" => Some(false),
                _ => None,
            },
        };
        // Nets feed each other in any order; each round settles at least one more.
        for _ in 0..=self.nets.len() {
            let before = known.len();
            for (net, terms) in self.nets.iter().enumerate() {
                if known.contains_key(&net) {
                    continue;
                }
                let input = |input: &Input| {
                    let value = match &input.value {
                        Value::Net(net) => known.get(net).copied(),
                        Value::Operand(key) => bit(key),
                    };
                    value.map(|value| value != input.negated)
                };
                let values: Vec<Option<bool>> = terms.iter().map(|term| term.value(&input, &known, value)).collect();
                if let Some(value) = any(&values).filter(|_| !terms.is_empty()) {
                    known.insert(net, value);
                }
            }
            if known.len() == before {
                let coil = self.coils.iter().find(|(net, key)| !known.contains_key(net) && bit(key).is_some());
                match coil {
                    Some((net, key)) => known.insert(*net, bit(key) == Some(true)),
                    None => break,
                };
            }
        }
        known
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

impl Term {
    fn value(
        &self,
        input: &dyn Fn(&Input) -> Option<bool>,
        nets: &HashMap<usize, bool>,
        operand: &dyn Fn(&str) -> Option<String>,
    ) -> Option<bool> {
        let list = |inputs: &[Input]| inputs.iter().map(input).collect::<Vec<_>>();
        match self {
            Term::Rail => Some(true),
            Term::Same(one) => input(one),
            Term::All(inputs) => all(&list(inputs)),
            Term::Any(inputs) => any(&list(inputs)),
            Term::Odd(inputs) => {
                let values = list(inputs);
                let sum = values.iter().flatten().filter(|value| **value).count();
                (!values.contains(&None)).then_some(sum % 2 == 1)
            }
            Term::Compare { flow, sign, left, right, reading, .. } => {
                let flow = match flow {
                    Some(net) => nets.get(net).copied(),
                    None => Some(true),
                };
                let text = |key: &str| operand(key).unwrap_or_else(|| key.to_string());
                let (left, right) = (text(left), text(right));
                let numbers = match (duration_type(&left), duration_type(&right)) {
                    (None, None) => (number(&left, *reading), number(&right, *reading)),
                    // What STL loads of a timer is a number without its time base.
                    (None, _) | (_, None) => (None, None),
                    (Some(one), Some(other)) => (nanoseconds(&left, one), nanoseconds(&right, other)),
                };
                let result = match numbers {
                    (Some(left), Some(right)) => Some(match sign.as_str() {
                        "=" | "==" => left == right,
                        "<>" => left != right,
                        "<" => left < right,
                        "<=" => left <= right,
                        ">" => left > right,
                        ">=" => left >= right,
                        _ => return None,
                    }),
                    _ => None,
                };
                all(&[flow, result])
            }
            Term::Unknown => None,
        }
    }

    /// As the script of a page reads it.
    fn json(&self, places: bool) -> serde_json::Value {
        use serde_json::json;
        let input = |input: &Input| match (&input.value, input.place.filter(|_| places)) {
            (Value::Net(net), _) => json!([net, input.negated]),
            (Value::Operand(key), None) => json!([key, input.negated]),
            (Value::Operand(key), Some(place)) => json!([key, input.negated, place]),
        };
        let list = |inputs: &[Input]| inputs.iter().map(input).collect::<Vec<_>>();
        match self {
            Term::Rail => json!(["r"]),
            Term::Same(one) => json!(["&", input(one)]),
            Term::All(inputs) => serde_json::Value::Array(std::iter::once(json!("&")).chain(list(inputs)).collect()),
            Term::Any(inputs) => serde_json::Value::Array(std::iter::once(json!("|")).chain(list(inputs)).collect()),
            Term::Odd(inputs) => serde_json::Value::Array(std::iter::once(json!("^")).chain(list(inputs)).collect()),
            Term::Compare { flow, sign, left, right, reading, told } => match told.filter(|_| places) {
                None => json!(["?", flow, sign, left, right, reading.word()]),
                Some(Told { left: from, right: inside, inverse }) => {
                    json!(["?", flow, sign, left, right, reading.word(), [from, inside, inverse]])
                }
            },
            Term::Unknown => json!(["u"]),
        }
    }
}

/// The type of a duration: `LT` of `LT#-1us`.
fn duration_type(text: &str) -> Option<&str> {
    let (ty, _) = text.split_once('#')?;
    let is_one_of = ["T", "TIME", "LT", "LTIME", "S5T", "S5TIME"].iter().any(|own| own.eq_ignore_ascii_case(ty));
    is_one_of.then_some(ty)
}

/// A duration of a trace or a constant. The CPU compares words of S5TIME as they are, with their time bases, which their texts do not have.
fn nanoseconds(text: &str, ty: &str) -> Option<f64> {
    if ty.starts_with(['S', 's']) {
        return None;
    }
    let value = text.get(ty.len() + 1..)?;
    Some(duration::nanoseconds(value, Smallest::Nanosecond, Fraction::Anywhere).ok()? as f64)
}

/// A number of a trace or a constant: `-5`, `1_000`, `16#00FF`, `2#101`, `1.5`, `INT#7`; `T#5s` is none. Words in base 16 are
/// INT, and double words DINT, or REAL if the comparison is one of REAL.
fn number(text: &str, reading: Reading) -> Option<f64> {
    let text = text.replace('_', "");
    let prefixes = [("16#", 16), ("8#", 8), ("2#", 2)];
    let based = prefixes.into_iter().find_map(|(prefix, base)| Some((text.strip_prefix(prefix)?, base)));
    if let Some((digits, base)) = based {
        let bits = i64::from_str_radix(digits, base).ok()?;
        return match (reading, base, digits.len()) {
            (Reading::Real, 16, 8) => Some(f64::from(f32::from_bits(bits as u32))),
            (Reading::Real, ..) => None,
            (Reading::Signed, 16, 4) => Some(f64::from(bits as i16)),
            (Reading::Signed, 16, 8) => Some(f64::from(bits as i32)),
            (Reading::Signed | Reading::Unsigned, ..) => Some(bits as f64),
        };
    }
    text.parse().ok().or_else(|| text.split_once('#')?.1.parse().ok())
}

impl Logic {
    /// As the script of a page reads it.
    pub fn json(&self, places: bool) -> serde_json::Value {
        let nets: Vec<Vec<serde_json::Value>> =
            self.nets.iter().map(|terms| terms.iter().map(|term| term.json(places)).collect()).collect();
        let mut logic = serde_json::json!({ "nets": nets, "coils": self.coils });
        if places {
            logic["places"] = serde_json::json!(self.places);
            logic["contacts"] = serde_json::json!(self.contacts);
        }
        logic
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comparison_says_where_its_result_is_told() {
        let term = Term::Compare {
            flow: None,
            sign: "<".to_string(),
            left: "MW10".to_string(),
            right: "7".to_string(),
            reading: Reading::Signed,
            told: Some(Told { left: 10, right: 20, inverse: true }),
        };
        assert_eq!(term.json(true), serde_json::json!(["?", null, "<", "MW10", "7", "signed", [10, 20, true]]));
        assert_eq!(term.json(false), serde_json::json!(["?", null, "<", "MW10", "7", "signed"]));
    }

    #[test]
    fn durations_are_compared_with_durations() {
        let result = |left: &str, right: &str| {
            let term = Term::Compare {
                flow: None,
                sign: "<".to_string(),
                left: left.to_string(),
                right: right.to_string(),
                reading: Reading::Signed,
                told: None,
            };
            term.value(&|_| None, &HashMap::new(), &|key| (key == "#t").then(|| "T#80ms".to_string()))
        };
        for (left, right, expected) in [
            ("#t", "T#0.1s", Some(true)),
            ("T#50MS", "#t", Some(true)),
            ("TIME#1m_30s", "#t", Some(false)),
            ("LT#-1us", "#t", Some(true)),
            ("#t", "LTIME#80ms1ns", Some(true)),
            ("#t", "100", None),
            ("16#0050", "T#1s", None),
            ("#t", "T#x", None),
            ("S5T#1s", "S5T#2s", None),
        ] {
            assert_eq!(result(left, right), expected, "{left} < {right}");
        }
    }

    /// A word with its first bit is below zero as a value, and so must be what it is compared with.
    #[test]
    fn a_constant_in_base_2_is_compared_as_one_in_base_16() {
        let look = |ty: &str| Look::Compare { sign: "==".to_string(), ty: ty.to_string() };
        for (ty, text, expected) in [
            ("I", "2#1000_0000_0000_0001", "16#8001"),
            ("Word", "8#177777", "16#FFFF"),
            ("B", "2#101", "16#0005"),
            ("D", "2#1000_0000_0000_0001", "16#00008001"),
        ] {
            assert_eq!(as_compared(&look(ty), text.to_string()), expected, "{text}");
        }
    }

    #[test]
    fn a_short_constant_of_a_double_word_has_zeros_in_front() {
        let look = |ty: &str| Look::Compare { sign: "==".to_string(), ty: ty.to_string() };
        for (ty, text, expected) in [
            ("D", "16#FFFF", "16#0000FFFF"),
            ("DInt", "16#F_FFFF", "16#000FFFFF"),
            ("D", "16#FFFF_FFFF", "16#FFFFFFFF"),
            ("I", "16#FFFF", "16#FFFF"),
            ("D", "VD100", "VD100"),
        ] {
            assert_eq!(as_compared(&look(ty), text.to_string()), expected, "{text}");
        }
    }

    #[test]
    fn types_without_a_sign_are_read_without_it() {
        let look = |ty: &str| Look::Compare { sign: "==".to_string(), ty: ty.to_string() };
        let (half, one) = ("0.5".to_string(), "1".to_string());
        for (ty, right, expected) in [
            ("UInt", &one, Reading::Unsigned),
            ("Word", &one, Reading::Unsigned),
            ("DInt", &one, Reading::Signed),
            ("I", &one, Reading::Signed),
            ("R", &one, Reading::Real),
            ("", &half, Reading::Real),
            ("", &one, Reading::Signed),
        ] {
            assert_eq!(reading(&look(ty), [&one, right]), expected, "{ty}");
        }
    }

    #[test]
    fn bits_are_numbers_of_the_type_that_is_compared() {
        for (text, reading, expected) in [
            ("16#3F000000", Reading::Real, Some(0.5)),
            ("16#FFFFFFFF", Reading::Signed, Some(-1.0)),
            ("16#FFFB", Reading::Signed, Some(-5.0)),
            ("16#FF_FB", Reading::Signed, Some(-5.0)),
            ("16#FFFB", Reading::Unsigned, Some(65531.0)),
            ("16#FFFFFFFF", Reading::Unsigned, Some(4294967295.0)),
            ("16#FFFB", Reading::Real, None),
            ("16#FFFF_FFFB", Reading::Signed, Some(-5.0)),
            ("2#1000_0001", Reading::Signed, Some(129.0)),
            ("-1_000", Reading::Signed, Some(-1000.0)),
            ("1.500000e+000", Reading::Real, Some(1.5)),
            ("T#5s", Reading::Signed, None),
        ] {
            assert_eq!(number(text, reading), expected, "{text}");
        }
    }
}
