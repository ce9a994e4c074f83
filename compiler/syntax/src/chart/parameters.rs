//! Operating parameters of a GRAPH function block, and their bits in the instance.
//! Source: GRAPH reference E.1, E.2, F.2.

use crate::ast::SectionKind;
use crate::chart::ast::{Dialect, Interface};

/// An operating parameter.
#[derive(Debug)]
pub struct Parameter {
    pub name: &'static str,
    pub ty: &'static str,
    pub section: SectionKind,
    /// The smallest set of parameters that has it.
    pub set: Set,
    pub effect: Effect,
    /// Its meaning, for the reference page.
    pub does: &'static str,
}

/// Sets of parameters, each including the ones before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Set {
    Minimum,
    Standard,
    Maximum,
    /// Only where it is declared.
    Tia,
}

/// The effect of a rising edge of an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Sets a bit of MOP, which requests or selects something.
    Set(&'static str),
    /// Inverts a bit of MOP.
    Toggle(&'static str),
    /// The engine reads or writes it by name.
    Named,
    /// No effect on control.
    Nothing,
}

use Effect::{Named, Nothing, Set as Sets, Toggle};
use SectionKind::{Input, Output};

const fn row(
    name: &'static str,
    ty: &'static str,
    section: SectionKind,
    set: self::Set,
    effect: Effect,
    does: &'static str,
) -> Parameter {
    Parameter { name, ty, section, set, effect, does }
}

/// All operating parameters, in the order of the parameters of a block.
#[rustfmt::skip]
pub const PARAMETERS: &[Parameter] = &[
    row("OFF_SQ", "BOOL", Input, Set::Standard, Sets("OFF"), "leaves all steps"),
    row("INIT_SQ", "BOOL", Input, Set::Minimum, Sets("INIT"), "leaves all steps and enters the initial steps"),
    row("ACK_EF", "BOOL", Input, Set::Standard, Sets("ACK_EF"), "acknowledges all supervision faults; a satisfied transition fires although the fault is still there"),
    row("REG_EF", "BOOL", Input, Set::Maximum, Sets("REG_EF"), "registration: event R1 in all active steps"),
    row("ACK_S", "BOOL", Input, Set::Maximum, Sets("ACK_S"), "acknowledges the fault of the step in S_NO"),
    row("REG_S", "BOOL", Input, Set::Maximum, Sets("REG_S"), "event R1 in the step in S_NO, if it is active"),
    row("HALT_SQ", "BOOL", Input, Set::Maximum, Toggle("HOLD"), "no transition fires, no request is granted; actions and monitoring go on"),
    row("HALT_TM", "BOOL", Input, Set::Maximum, Toggle("TMS_HALT"), "T, U, D and L stop"),
    row("ZERO_OP", "BOOL", Input, Set::Maximum, Toggle("OPS_ZERO"), "operands of N, D and L are 0, calls are not executed"),
    row("EN_IL", "BOOL", Input, Set::Maximum, Toggle("LOCK"), "interlocks are evaluated; if off, all are satisfied"),
    row("EN_SV", "BOOL", Input, Set::Maximum, Toggle("SUP"), "supervisions are evaluated; if off, there are no faults"),
    row("EN_ACKREQ", "BOOL", Input, Set::Maximum, Toggle("ACKREQ"), "faults must be acknowledged"),
    row("EN_SSKIP", "BOOL", Input, Set::Maximum, Toggle("SSKIP"), "skip steps"),
    row("DISP_SACT", "BOOL", Input, Set::Maximum, Sets("SACT_DISP"), "S_NO shows active steps"),
    row("DISP_SEF", "BOOL", Input, Set::Maximum, Sets("SEF_DISP"), "S_NO shows steps with a fault"),
    row("DISP_SALL", "BOOL", Input, Set::Maximum, Sets("SALL_DISP"), "S_NO shows all steps"),
    row("S_PREV", "BOOL", Input, Set::Standard, Sets("S_PREV"), "S_NO: the next lower number"),
    row("S_NEXT", "BOOL", Input, Set::Standard, Sets("S_NEXT"), "S_NO: the next higher number"),
    row("SW_AUTO", "BOOL", Input, Set::Standard, Sets("AUTO"), "automatic mode"),
    row("SW_TAP", "BOOL", Input, Set::Standard, Sets("TAP"), "mode *transition and push*"),
    row("SW_TOP", "BOOL", Input, Set::Standard, Sets("TOP"), "mode *transition or push*"),
    row("SW_MAN", "BOOL", Input, Set::Standard, Sets("MAN"), "manual mode"),
    row("S_SEL", "INT", Input, Set::Standard, Named, "number of the step that S_NO is to show: applied in manual mode when it changes"),
    row("S_SELOK", "BOOL", Input, Set::Maximum, Sets("S_SELOK"), "applies S_SEL in any mode"),
    row("S_ON", "BOOL", Input, Set::Standard, Sets("S_ON"), "manual mode: activates the step in S_NO"),
    row("S_OFF", "BOOL", Input, Set::Standard, Sets("S_OFF"), "manual mode: deactivates the step in S_NO"),
    row("T_PREV", "BOOL", Input, Set::Maximum, Sets("T_PREV"), "T_NO: the next lower number"),
    row("T_NEXT", "BOOL", Input, Set::Maximum, Sets("T_NEXT"), "T_NO: the next higher number"),
    row("T_PUSH", "BOOL", Input, Set::Standard, Sets("T_PUSH"), "push of the modes TAP and TOP"),
    row("EN_LMODE", "BOOL", Input, Set::Tia, Nothing, "no effect"),
    row("RESET_CRIT", "BOOL", Input, Set::Tia, Nothing, "no effect"),
    row("S_NO", "INT", Output, Set::Standard, Named, "number of the step that is shown; 0: none"),
    row("S_MORE", "BOOL", Output, Set::Standard, Named, "S_NO has more than one step to show"),
    row("S_ACTIVE", "BOOL", Output, Set::Standard, Named, "X of the step in S_NO"),
    row("S_TIME", "TIME", Output, Set::Maximum, Named, "T of the step in S_NO"),
    row("S_TIMEOK", "TIME", Output, Set::Maximum, Named, "U of the step in S_NO"),
    row("S_CRITLOC", "DWORD", Output, Set::Maximum, Nothing, "always 0"),
    row("S_CRITLOCERR", "DWORD", Output, Set::Maximum, Nothing, "always 0"),
    row("S_CRITSUP", "DWORD", Output, Set::Maximum, Nothing, "always 0"),
    row("S_STATE", "WORD", Output, Set::Maximum, Named, "bytes 0 and 1 of the step in S_NO"),
    row("T_NO", "INT", Output, Set::Maximum, Named, "number of a valid transition; 0: none"),
    row("T_MORE", "BOOL", Output, Set::Maximum, Named, "more than one transition is valid"),
    row("T_CRIT", "DWORD", Output, Set::Maximum, Nothing, "always 0"),
    row("T_CRITOLD", "DWORD", Output, Set::Maximum, Nothing, "always 0"),
    row("T_CRITFLT", "DWORD", Output, Set::Maximum, Nothing, "always 0"),
    row("ERROR", "BOOL", Output, Set::Maximum, Named, "the interlock of an active step is not satisfied"),
    row("FAULT", "BOOL", Output, Set::Maximum, Named, "a supervision fault is pending"),
    row("ERR_FLT", "BOOL", Output, Set::Standard, Named, "ERROR or FAULT"),
    row("SQ_ISOFF", "BOOL", Output, Set::Maximum, Named, "no step is active"),
    row("SQ_HALTED", "BOOL", Output, Set::Maximum, Named, "state of HALT_SQ"),
    row("TM_HALTED", "BOOL", Output, Set::Maximum, Named, "state of HALT_TM"),
    row("OP_ZEROED", "BOOL", Output, Set::Maximum, Named, "state of ZERO_OP"),
    row("IL_ENABLED", "BOOL", Output, Set::Maximum, Named, "state of EN_IL"),
    row("SV_ENABLED", "BOOL", Output, Set::Maximum, Named, "state of EN_SV"),
    row("ACKREQ_ENABLED", "BOOL", Output, Set::Maximum, Named, "state of EN_ACKREQ"),
    row("SSKIP_ENABLED", "BOOL", Output, Set::Maximum, Named, "state of EN_SSKIP"),
    row("SACT_DISP", "BOOL", Output, Set::Maximum, Named, "S_NO shows active steps"),
    row("SEF_DISP", "BOOL", Output, Set::Maximum, Named, "S_NO shows steps with a fault"),
    row("SALL_DISP", "BOOL", Output, Set::Maximum, Named, "S_NO shows all steps"),
    row("AUTO_ON", "BOOL", Output, Set::Standard, Named, "automatic mode"),
    row("TAP_ON", "BOOL", Output, Set::Standard, Named, "mode TAP"),
    row("TOP_ON", "BOOL", Output, Set::Standard, Named, "mode TOP"),
    row("MAN_ON", "BOOL", Output, Set::Standard, Named, "manual mode"),
    row("LMODE_ENABLED", "BOOL", Output, Set::Tia, Nothing, "always 0"),
];

/// Bits of MOP, four bytes of them. Those after the start values are requests, levels or modes as `engine.scl` treats them.
pub const OPERATING_BITS: [&str; 32] = [
    "AUTO",
    "TAP",
    "TOP",
    "MAN",
    "ACK_S",
    "REG_S",
    "ACK_EF",
    "REG_EF", //
    "LOCK",
    "SUP",
    "ACKREQ",
    "SSKIP",
    "OFF",
    "INIT",
    "HOLD",
    "TMS_HALT", //
    "OPS_ZERO",
    "SACT_DISP",
    "SEF_DISP",
    "SALL_DISP",
    "S_PREV",
    "S_NEXT",
    "S_SELOK",
    "S_ON", //
    "S_OFF",
    "T_PREV",
    "T_NEXT",
    "T_PUSH",
    "ACK",
    "IL_PERM",
    "T_PERM",
    "ILP_MAN",
];

/// Parameters that a block of a set has without declaring them.
pub fn implied(interface: Interface) -> impl Iterator<Item = &'static Parameter> {
    let largest = match interface {
        Interface::Minimum => Some(Set::Minimum),
        Interface::Standard => Some(Set::Standard),
        Interface::Maximum => Some(Set::Maximum),
        Interface::UserDefined => None,
    };
    PARAMETERS.iter().filter(move |parameter| largest.is_some_and(|largest| parameter.set <= largest))
}

/// The set of a file without `FBInterface`: that of a new block in STEP 7; files of other tools declare their parameters.
pub const fn default_interface(dialect: Dialect) -> Interface {
    match dialect {
        Dialect::Classic => Interface::Standard,
        Dialect::Tia | Dialect::Sfc => Interface::UserDefined,
    }
}

/// The operating parameter with this name, in either letter case.
pub fn find(name: &str) -> Option<&'static Parameter> {
    PARAMETERS.iter().find(|parameter| parameter.name.eq_ignore_ascii_case(name))
}

/// SCL that turns rising edges of the inputs into bits of MOP. One test tells that no input has changed. `declared`: whether the block
/// has the parameter.
pub fn edges(declared: impl Fn(&str) -> bool) -> String {
    let mut changes = Vec::new();
    let mut text = String::new();
    for parameter in PARAMETERS.iter().filter(|parameter| declared(parameter.name)) {
        let name = parameter.name;
        let (bit, action) = match parameter.effect {
            Effect::Set(bit) => (bit, format!("#MOP.{bit} := TRUE; #OLD.{bit} := FALSE;")),
            Effect::Toggle(bit) => (bit, format!("#MOP.{bit} := NOT #MOP.{bit};")),
            Effect::Named | Effect::Nothing => continue,
        };
        changes.push(format!("(#{name} XOR #MOPEDGE.{bit})"));
        text.push_str(&format!("IF #{name} AND NOT #MOPEDGE.{bit} THEN {action} END_IF; #MOPEDGE.{bit} := #{name};\n"));
    }
    match changes.is_empty() {
        true => text,
        false => format!("IF {} THEN\n{text}END_IF;\n", changes.join(" OR ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_has_its_bit() {
        for parameter in PARAMETERS {
            if let Effect::Set(bit) | Effect::Toggle(bit) = parameter.effect {
                assert!(OPERATING_BITS.contains(&bit), "{}: {bit}", parameter.name);
            }
        }
    }

    #[test]
    fn the_minimum_set_is_one_input() {
        let names: Vec<&str> = implied(Interface::Minimum).map(|parameter| parameter.name).collect();
        assert_eq!(names, ["INIT_SQ"]);
        assert_eq!(implied(Interface::Standard).count(), 21);
    }
}
