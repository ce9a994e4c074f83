//! The reference page of GRAPH: its text, and tables of the operating parameters and of the bits of MOP.

use std::fmt::Write as _;

use plcc_syntax::ast::SectionKind;

use plcc_program::tables::chart::{Effect, OPERATING_BITS, PARAMETERS, Parameter, Set};

/// The page without its tables.
const TEXT: &str = include_str!("graph.md.in");

/// Bits of MOP that no parameter sets as a request, with their meaning; all others are requests. In order of the bits.
const LASTING: [(&str, &str); 18] = [
    ("AUTO", "automatic mode"),
    ("TAP", "mode *transition and push*"),
    ("TOP", "mode *transition or push*"),
    ("MAN", "manual mode"),
    ("LOCK", "interlocks are evaluated"),
    ("SUP", "supervisions are evaluated"),
    ("ACKREQ", "faults must be acknowledged"),
    ("SSKIP", "skip steps"),
    ("HOLD", "the sequencers are halted"),
    ("TMS_HALT", "the times are halted"),
    ("OPS_ZERO", "operands are 0"),
    ("SACT_DISP", "S_NO shows active steps"),
    ("SEF_DISP", "S_NO shows steps with a fault"),
    ("SALL_DISP", "S_NO shows all steps"),
    ("ACK", "request: as ACK_EF"),
    ("IL_PERM", "no effect"),
    ("T_PERM", "the conditions of all transitions are evaluated; the lower number has priority"),
    ("ILP_MAN", "no effect; its start value is `PermILMan`"),
];

/// The page in Markdown: `docs/reference/graph.md`.
pub fn reference() -> String {
    TEXT.replace("{inputs}\n", &parameters(SectionKind::Input))
        .replace("{outputs}\n", &parameters(SectionKind::Output))
        .replace("{bits}\n", &bits())
}

fn parameters(section: SectionKind) -> String {
    let mut table =
        String::from("| Name | Type | Set | At a rising edge | Meaning |\n| --- | --- | --- | --- | --- |\n");
    if section == SectionKind::Output {
        table = String::from("| Name | Type | Set | Meaning |\n| --- | --- | --- | --- |\n");
    }
    for parameter in PARAMETERS.iter().filter(|one| one.section == section) {
        let edge = if section == SectionKind::Input { format!("{} | ", at_edge(parameter)) } else { String::new() };
        let (name, ty, does) = (parameter.name, parameter.ty, parameter.does);
        let _ = writeln!(table, "| `{name}` | {ty} | {} | {edge}{does} |", set(parameter.set));
    }
    table
}

fn at_edge(parameter: &Parameter) -> String {
    match parameter.effect {
        Effect::Set(bit) => format!("sets `MOP.{bit}`"),
        Effect::Toggle(bit) => format!("inverts `MOP.{bit}`"),
        Effect::Named | Effect::Nothing => String::new(),
    }
}

const fn set(set: Set) -> &'static str {
    match set {
        Set::Minimum => "minimum",
        Set::Standard => "standard",
        Set::Maximum => "maximum",
        Set::Tia => "where declared",
    }
}

fn bits() -> String {
    let mut table = String::from("| Place | Bit | Meaning |\n| --- | --- | --- |\n");
    for (at, bit) in OPERATING_BITS.into_iter().enumerate() {
        let lasting = LASTING.iter().find(|(name, _)| *name == bit).map(|(_, does)| does.to_string());
        let does = lasting.unwrap_or_else(|| format!("request: as the parameter {}", parameter_of(bit)));
        let _ = writeln!(table, "| {}.{} | `{bit}` | {does} |", at / 8, at % 8);
    }
    table
}

/// The parameter that sets a bit.
fn parameter_of(bit: &'static str) -> &'static str {
    PARAMETERS.iter().find(|parameter| parameter.effect == Effect::Set(bit)).map_or("", |parameter| parameter.name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_has_a_meaning() {
        for bit in OPERATING_BITS {
            assert!(LASTING.iter().any(|(name, _)| *name == bit) || !parameter_of(bit).is_empty(), "{bit}");
        }
        assert!(LASTING.iter().all(|(name, _)| OPERATING_BITS.contains(name)));
    }
}
