//! Comparisons of step times in networks of GRAPH: `CMP>T`, `CMP>U`, `CMP>T_MAX`, `CMP>T_WARN`.
//!
//! They become the ordinary comparison `step.T > limit`, of the step that the network belongs to. Source: GRAPH reference A.6.
//!
//! Assumption: how an export spells their names and pins. Any name made of these words is accepted, and any pin with an operand is the
//! limit. To be checked with an export that has each of them.

use plcc_diag::{Code, Diagnostic};
use roxmltree::Node;

use super::operand;
use super::parts::{End, Parts, UId, Wire};
use super::reader::{Reader, Refused};
use crate::xml::{attribute_range, head};

/// What is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Compared {
    /// `"T"` or `"U"`.
    pub time: &'static str,
    /// The limit that is a setting of the step; otherwise an operand is wired to the element.
    pub limit: Option<&'static str>,
}

/// What an element of that name compares; `None` for other elements.
pub fn of(name: &str) -> Option<Compared> {
    let folded: String = name.chars().filter(char::is_ascii_alphanumeric).flat_map(char::to_lowercase).collect();
    let words = ["compare", "comp", "cmp"].iter().find_map(|word| folded.strip_prefix(word))?;
    let (time, limit) = match words.strip_prefix("gt").unwrap_or(words) {
        "t" => ("T", None),
        "u" => ("U", None),
        "tmax" => ("T", Some("T_MAX")),
        "twarn" => ("T", Some("T_WARN")),
        _ => return None,
    };
    Some(Compared { time, limit })
}

/// The pin of the comparison that a file calls `given`, and whether it is an output.
pub fn pin(given: &str, from_operand: bool) -> (String, bool) {
    if ["out", "eno", "q"].iter().any(|output| output.eq_ignore_ascii_case(given)) {
        return ("out".to_string(), true);
    }
    (if from_operand { "in2" } else { "pre" }.to_string(), false)
}

/// Wires the time of the step, and the limit if it belongs to the step, to the last part.
pub fn wire(
    reader: &mut Reader,
    node: Node,
    compared: Compared,
    whose: &str,
    found: &mut Parts,
) -> Result<(), Refused> {
    let Some(step) = reader.own_step.clone() else {
        let title = format!("{whose} compares the time of a step, but belongs to no step");
        let span = reader.name_span(node, "Name");
        let message = Diagnostic::new(Code::UnknownElement, span, title).label("whose time?");
        let help = "use it in an interlock, a supervision, or a transition after one step; elsewhere compare `step.T`";
        reader.diagnostics.push(message.help(help));
        return Err(Refused);
    };
    let step = operand::plain_or_quoted(&step);
    let part = found.parts.len().saturating_sub(1);
    let span = reader.span(head(node));
    for (name, member) in [("in1", Some(compared.time)), ("in2", compared.limit)] {
        let Some(member) = member else { continue };
        let wanted = attribute_range(node, "Name").start;
        let value = reader.expression(node, wanted, &format!("#{step}.{member}"));
        let uid = UId::MAX - found.operands.len() as UId;
        found.operands.insert(uid, value);
        let pin = End::Pin { part, name: name.to_string(), output: false, span };
        found.wires.push(Wire { ends: vec![End::Operand(uid), pin], span });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_made_of_words() {
        assert_eq!(of("CMP>T"), Some(Compared { time: "T", limit: None }));
        assert_eq!(of("CmpGtU"), Some(Compared { time: "U", limit: None }));
        assert_eq!(of("CompT_MAX"), Some(Compared { time: "T", limit: Some("T_MAX") }));
        assert_eq!(of("CMP>T_WARN"), Some(Compared { time: "T", limit: Some("T_WARN") }));
        assert_eq!(of("Gt"), None);
        assert_eq!(of("TON"), None);
    }
}
