//! Subroutines of the S7-200 with parameters.

use std::fmt::Write as _;

use super::{Case, campaign};

/// A type: its width as letters of addresses have it, the instruction that moves it, the constant.
struct Kind {
    name: &'static str,
    width: &'static str,
    mover: &'static str,
    value: &'static str,
    /// The meaning of the sample's bits.
    bits: &'static str,
    /// Compare contact.
    equal: &'static str,
}

const TYPES: &[Kind] = &[
    Kind { name: "BOOL", width: "", mover: "", value: "1", bits: "1", equal: "" },
    Kind { name: "BYTE", width: "B", mover: "MOVB", value: "165", bits: "16#A5", equal: "LDB=" },
    Kind { name: "WORD", width: "W", mover: "MOVW", value: "16#A55A", bits: "16#A55A", equal: "LDW=" },
    Kind { name: "INT", width: "W", mover: "MOVW", value: "-30000", bits: "16#8AD0", equal: "LDW=" },
    Kind { name: "DWORD", width: "D", mover: "MOVD", value: "16#A55A1234", bits: "16#A55A1234", equal: "LDD=" },
    Kind { name: "DINT", width: "D", mover: "MOVD", value: "-2000000000", bits: "16#88CA6C00", equal: "LDD=" },
    Kind { name: "REAL", width: "D", mover: "MOVR", value: "-1.25", bits: "16#BFA00000", equal: "LDR=" },
    Kind { name: "STRING", width: "B", mover: "SCPY", value: "\"a text\"", bits: "", equal: "LDS=" },
];

const SECTIONS: [&str; 4] = ["VAR_INPUT", "VAR_IN_OUT", "VAR_OUTPUT", "VAR"];

/// Actual parameters: the place of a bit, and the first byte of others.
const PLACES: &[(&str, &str, &str)] = &[
    ("V", "V101.3", "V{w}101"),
    ("M", "M10.3", "M{w}10"),
    ("Q", "Q1.3", "Q{w}2"),
    ("S", "S1.3", "S{w}2"),
    ("SM", "SM60.3", "SM{w}60"),
    ("accumulator", "", "AC1"),
    ("pointer", "", "*AC2"),
    ("pointer in V", "", "*VD300"),
    ("constant", "1", "CONSTANT"),
    ("local", "L10.3", "L{w}10"),
];

/// Uses; `@` is the parameter, `$` the result.
const USES: &[&str] = &[
    "move",
    "by value",
    "by reference",
    "to output",
    "compare",
    "asserted",
    "arithmetic",
    "twice",
    "deep",
    "not called",
];

#[derive(Clone, Copy)]
struct Plan {
    kind: &'static Kind,
    section: &'static str,
    place: &'static (&'static str, &'static str, &'static str),
    using: &'static str,
    /// Another parameter or variable before this one.
    before: &'static str,
}

impl Plan {
    fn is_text(&self) -> bool {
        self.kind.name == "STRING"
    }

    fn actual(&self) -> String {
        match self.kind.name {
            "BOOL" => self.place.1.to_string(),
            _ => self.place.2.replace("{w}", self.kind.width).replace("CONSTANT", self.kind.value),
        }
    }

    #[expect(clippy::nonminimal_bool, reason = "each line is a combination that does not exist")]
    fn exists(&self) -> bool {
        let bit = self.kind.name == "BOOL";
        !(bit && self.place.1.is_empty())
            && !(self.section == "VAR" && self.place.0 != "V")
            && !(bit && matches!(self.using, "compare" | "arithmetic"))
            && !(self.is_text() && self.using == "arithmetic")
            && !(self.place.0 == "constant" && self.section != "VAR_INPUT")
            // A string of `VAR` is a pointer that is never set.
            && !(self.is_text() && self.section == "VAR")
            // A text is 255 bytes long.
            && !(self.is_text() && !matches!(self.place.0, "V" | "pointer" | "pointer in V" | "constant"))
            && !(self.section == "VAR_INPUT" && matches!(self.using, "by reference" | "to output"))
    }

    fn copy(&self, from: &str, to: &str) -> String {
        match self.kind.name {
            "BOOL" => format!("LD     {from}\n=      {to}\n"),
            _ => format!("LD     SM0.0\n{}   {from}, {to}\n", self.kind.mover),
        }
    }

    fn result(&self) -> String {
        match self.kind.name {
            "BOOL" => "V200.5".to_string(),
            _ => format!("V{}200", self.kind.width),
        }
    }

    fn sample(&self) -> String {
        match self.kind.name {
            "BOOL" => "SM0.0".to_string(),
            _ => self.kind.value.to_string(),
        }
    }

    fn source(&self) -> String {
        let ty = self.kind.name;
        let result = self.result();
        let to_result = self.copy("#v", &result);
        let given = matches!(self.section, "VAR_INPUT" | "VAR_IN_OUT");
        let fill = if given { String::new() } else { self.copy(&self.sample(), "#v") };
        let assertion = |place: &str| match self.is_text() {
            true => String::new(),
            false => format!("//@ assert {place} == {}\n", self.kind.bits),
        };
        let body = match self.using {
            "move" => to_result.clone(),
            "by value" => "LD     SM0.0\nCALL   ByValue, #v\n".to_string(),
            "by reference" => format!("LD     SM0.0\nCALL   ByReference, #v\n{to_result}"),
            "to output" => format!("LD     SM0.0\nCALL   ToOutput, #v\n{to_result}"),
            "compare" => format!(
                "{} #v, {}\n{}",
                self.kind.equal,
                self.kind.value,
                self.copy(&self.sample(), &result).replace("LD     SM0.0\n", "")
            ),
            "asserted" => format!("{to_result}{}", assertion("#v")),
            "arithmetic" => match self.kind.width {
                "B" => format!("LD     SM0.0\nORB    #v, {result}\n"),
                "W" => format!("LD     SM0.0\nORW    #v, {result}\n"),
                _ => format!("LD     SM0.0\nORD    #v, {result}\n"),
            },
            "twice" => "LD     SM0.0\nCALL   ByValue, #v\nCALL   ByValue, #v\n".to_string(),
            "deep" => "LD     SM0.0\nCALL   Outer, #v\n".to_string(),
            "not called" => format!("LDN    SM0.0\nCALL   ByValue, #v\n{to_result}"),
            other => unreachable!("{other}"),
        };
        let (mut inputs, mut before_actual) = (String::new(), String::new());
        let (mut own, mut own_before) = (format!("{}\nv:{ty};\nEND_VAR\n", self.section), String::new());
        match self.before {
            "" => {}
            other => {
                if self.section == "VAR_INPUT" {
                    own = format!("VAR_INPUT\npad:{other};\nv:{ty};\nEND_VAR\n");
                } else {
                    own_before = format!("VAR_INPUT\npad:{other};\nEND_VAR\n");
                }
                before_actual = if other == "BOOL" { "SM0.0, ".to_string() } else { "7, ".to_string() };
            }
        }
        inputs.push_str(&own_before);
        let mut out = String::from(
            "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nNETWORK 1\nLD     SM0.0\nMOVD   &VB400, AC2\nMOVD   &VB700, VD300\n",
        );
        let actual = self.actual();
        if given && self.place.0 != "constant" {
            out.push_str(&self.copy(&self.sample(), &actual));
        }
        let call = match self.section {
            "VAR" => format!(
                "CALL   F{}\n",
                if before_actual.is_empty() {
                    String::new()
                } else {
                    format!(", {}", before_actual.trim_end_matches(", "))
                }
            ),
            _ => format!("CALL   F, {before_actual}{actual}\n"),
        };
        _ = write!(out, "LD     SM0.0\n{call}");
        if self.is_text() {
            _ = writeln!(out, "LDS=   VB200, \"a text\"\n=      V2.0\n//@ assert V2.0 == 1");
        } else {
            out.push_str(&assertion(&result));
        }
        if matches!(self.section, "VAR_OUTPUT" | "VAR_IN_OUT") {
            // Assertions do not follow pointers.
            let at = match self.place.0 {
                "pointer" => format!("V{}400", self.kind.width),
                "pointer in V" => format!("V{}700", self.kind.width),
                _ => actual,
            };
            out.push_str(&assertion(&at));
        }
        out.push_str("END_ORGANIZATION_BLOCK\n");
        _ = writeln!(out, "SUBROUTINE_BLOCK F:SBR0\n{inputs}{own}BEGIN\nNETWORK 1\n{fill}{body}END_SUBROUTINE_BLOCK");
        let callee = |name: &str, number: u32, section: &str, body: &str| {
            format!(
                "SUBROUTINE_BLOCK {name}:SBR{number}\n{section}\np:{ty};\nEND_VAR\nBEGIN\nNETWORK 1\n{body}END_SUBROUTINE_BLOCK\n"
            )
        };
        out.push_str(&callee("ByValue", 1, "VAR_INPUT", &self.copy("#p", &result)));
        if self.using == "by reference" {
            out.push_str(&callee(
                "ByReference",
                2,
                "VAR_IN_OUT",
                &format!("{}{}", self.copy("#p", &result), self.copy(&result, "#p")),
            ));
        }
        if self.using == "to output" {
            out.push_str(&callee("ToOutput", 3, "VAR_OUTPUT", &self.copy(&self.sample(), "#p")));
        }
        if self.using == "deep" {
            out.push_str(&callee("Outer", 4, "VAR_INPUT", "LD     SM0.0\nCALL   ByValue, #p\n"));
        }
        out
    }
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for section in SECTIONS {
        for place in PLACES {
            for kind in TYPES {
                for using in USES {
                    for before in ["", "BOOL", "BYTE", "DINT"] {
                        let plan = Plan { kind, section, place, using, before };
                        if plan.exists() {
                            cases.push(Case {
                                kind: format!("{section} {}", place.0),
                                ty: kind.name,
                                using,
                                variant: format!("after {before}"),
                                ending: "awl",
                                cpu: "s7-200",
                                source: Box::new(move || plan.source()),
                            });
                        }
                    }
                }
            }
        }
    }
    cases
}

#[test]
fn subroutines_bring_values_through() {
    // Nothing of this is refused.
    campaign(cases(), 7, &[]);
}
