//! Elements of the TIA Portal that plcc knows by name but does not support.
//!
//! Source: LAD/FBD reference, chapter B: elements marked as absent from the S7-1200, or without a meaning on a host.

/// An element that is absent.
struct Absent {
    /// As SIMATIC SD and SimaticML spell it.
    names: &'static [&'static str],
    why: &'static str,
    help: &'static str,
}

const ABSENT: &[Absent] = &[
    Absent {
        names: &["TypeOf", "TypeOfElements", "TypeOfDB"],
        why: "it is not an element but a function of SCL",
        help: "compare with EQ_Type or EQ_ElemType, or write the network in SCL",
    },
    Absent {
        names: &["CTRL_PTO"],
        why: "here a pulse generator sets the width of pulses, not the frequency of a pulse train",
        help: "use CTRL_PWM, which sets the width of the pulses",
    },
    Absent {
        names: &["T_COMP"],
        why: "T_COMP belongs to S7-1500 and compares in a mode given as a number",
        help: "compare with the elements EQ, NE, GT, LT, GE, LE, which take times and dates",
    },
    Absent {
        names: &["ENDIS_PW", "INIT_RD"],
        why: "passwords and retentive data of the CPU are not part of the program here",
        help: "remove the element",
    },
];

/// Why an element of that name is absent, and what to do.
pub fn reason(name: &str) -> Option<(&'static str, &'static str)> {
    let absent = ABSENT.iter().find(|absent| absent.names.iter().any(|known| known.eq_ignore_ascii_case(name)))?;
    Some((absent.why, absent.help))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::elements::{find_sd, find_xml};

    #[test]
    fn absent_elements_are_in_no_other_table() {
        for name in ABSENT.iter().flat_map(|absent| absent.names) {
            assert!(find_sd(name).is_none() && find_xml(name).is_none(), "{name}");
        }
        assert!(reason("typeof").is_some());
        assert!(reason("Add").is_none());
    }
}
