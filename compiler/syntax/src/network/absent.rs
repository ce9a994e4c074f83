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
        names: &["T_COMP"],
        why: "the relation is chosen at its box, in a form that plcc does not know",
        help: "compare with the elements EQ, NE, GT, LT, GE, LE, which take times and dates",
    },
    Absent {
        names: &["S_COMP"],
        why: "the relation is chosen at its box, in a form that plcc does not know",
        help: "compare with the elements EQ, NE, GT, LT, GE, LE, which take texts",
    },
    Absent {
        names: &["JOIN"],
        why: "plcc does not join the texts of an array",
        help: "join them one by one in a FOR loop: `text := CONCAT(IN1 := text, IN2 := list[i])`",
    },
    Absent {
        names: &["SPLIT"],
        why: "plcc does not cut a text into the elements of an array",
        help: "cut it in a loop: FIND gives the place of the separator, LEFT and MID the parts",
    },
    Absent {
        names: &["GetSymbolName", "GetSymbolPath", "GetSymbolForReference"],
        why: "the names of actual parameters are not in the compiled program",
        help: "add an input of type WString to the block and give it the name in each call; the name of the instance is `GetInstanceName(SIZE := 0)`",
    },
    Absent {
        names: &["RT_INFO"],
        why: "plcc does not count the run times of organization blocks",
        help: "measure a part of the program with `RUNTIME`, whose value is the time between two of its calls",
    },
    Absent {
        names: &["LOG2MOD"],
        why: "modules have no addresses of STEP 7 V5 here",
        help: "`IO2MOD` finds the module of an input or output, `RD_ADDR` its addresses",
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
