//! LAD and FBD, as SIMATIC SD.

use std::fmt::Write as _;

use super::{Case, Refusal, campaign, refusal};

/// A type with the values of its parts, and the operation that moves it as a whole.
struct Kind {
    name: &'static str,
    parts: &'static [(&'static str, &'static str)],
}

const fn kind(name: &'static str, parts: &'static [(&'static str, &'static str)]) -> Kind {
    Kind { name, parts }
}

const TYPES: &[Kind] = &[
    kind("Bool", &[("", "TRUE")]),
    kind("Byte", &[("", "16#A5")]),
    kind("Word", &[("", "16#A55A")]),
    kind("DWord", &[("", "16#A55A_1234")]),
    kind("LWord", &[("", "16#A55A_1234_89AB_CDEF")]),
    kind("SInt", &[("", "-100")]),
    kind("USInt", &[("", "200")]),
    kind("Int", &[("", "-30000")]),
    kind("UInt", &[("", "60000")]),
    kind("DInt", &[("", "-2000000000")]),
    kind("UDInt", &[("", "4000000000")]),
    kind("LInt", &[("", "-9000000000000000000")]),
    kind("ULInt", &[("", "18000000000000000000")]),
    kind("Real", &[("", "-1.25")]),
    kind("LReal", &[("", "1.0E100")]),
    kind("Time", &[("", "T#-1h")]),
    kind("LTime", &[("", "LT#1h1ns")]),
    kind("Date", &[("", "D#2024-2-29")]),
    kind("Time_Of_Day", &[("", "TOD#12:34:56.789")]),
    kind("LTime_Of_Day", &[("", "LTOD#12:34:56.789")]),
    kind("LDT", &[("", "LDT#2024-2-29-12:34:56.789")]),
    kind("Date_And_Time", &[("", "DT#2024-2-29-12:34:56.789")]),
    kind("DTL", &[(".YEAR", "2024"), (".NANOSECOND", "789")]),
    kind("Char", &[("", "'x'")]),
    kind("WChar", &[("", "WCHAR#'y'")]),
    kind("String", &[("", "'a text'")]),
    kind("String[7]", &[("", "'a text'")]),
    kind("WString[7]", &[("", "WSTRING#'a text'")]),
    kind(
        "\"U\"",
        &[
            (".a", "-3"),
            (".b", "2.5"),
            (".c", "TRUE"),
            (".t", "'uvw'"),
            (".l[0]", "16#89AB_CDEF"),
            (".l[1]", "16#0123_4567"),
            (".z", "'e'"),
        ],
    ),
    kind("Array[0..2] of Int", &[("[0]", "7"), ("[1]", "8"), ("[2]", "-7")]),
    kind("Array[1..3] of Byte", &[("[1]", "16#11"), ("[2]", "16#22"), ("[3]", "16#33")]),
    kind("Array[1..3] of Bool", &[("[1]", "TRUE"), ("[3]", "TRUE")]),
    kind("Array[1..2] of String[5]", &[("[1]", "'ab'"), ("[2]", "'abcde'")]),
    kind("Array[1..2] of \"U\"", &[("[2].a", "9"), ("[2].t", "'xyz'"), ("[1].b", "0.125"), ("[2].z", "'q'")]),
    kind("Array[0..1, 1..2] of LReal", &[("[1, 2]", "0.5"), ("[0, 1]", "-1.5"), ("[0, 2]", "2.5"), ("[1, 1]", "3.5")]),
    kind("Struct a : Bool; b : Real; c : Byte; END_STRUCT", &[(".a", "TRUE"), (".b", "0.5"), (".c", "16#77")]),
];

const SECTIONS: [&str; 5] = ["VAR_INPUT", "VAR_OUTPUT", "VAR_IN_OUT", "VAR", "VAR_TEMP"];

const FORMS: &[(&str, &str, &str)] = &[
    ("whole", "T", "#v"),
    ("element", "Array[-1..1] of T", "#v[1]"),
    ("indexed", "Array[-1..1] of T", "#v[#i]"),
    ("member", "Struct pad : Bool; m : T; END_STRUCT", "#v.m"),
];

/// Uses: rungs after the start of one. `@` means the value, `|` for the start of another rung.
const USES: &[(&str, &str)] = &[
    ("move", "Move( in := @, out1 => \"D\".r )"),
    ("moved to", "Move( in := \"D\".x, out1 => @ ) Move( in := @, out1 => \"D\".r )"),
    ("by value", "\"ByValue\"( p := @ )"),
    ("by reference", "\"ByReference\"( p := @ ) Move( in := @, out1 => \"D\".r )"),
    ("to output", "\"ToOutput\"( p => @ ) Move( in := @, out1 => \"D\".r )"),
    ("result", "\"Result\"( Ret_Val => @ ) Move( in := @, out1 => \"D\".r )"),
    ("block input", "\"BI\"( p := @ )"),
    ("block output", "\"BO\"( p => @ ) Move( in := @, out1 => \"D\".r )"),
    ("block in-out", "\"BX\"( p := @ ) Move( in := @, out1 => \"D\".r )"),
    ("own input", "#mi( p := @ )"),
    ("own output", "#mo( p => @ ) Move( in := @, out1 => \"D\".r )"),
    ("own in-out", "#mx( p := @ ) Move( in := @, out1 => \"D\".r )"),
    ("variant", "\"ByVariant\"( p := @ ) Move( in := @, out1 => \"D\".r )"),
    (
        "compare",
        "{ S7_Templates := \"SrcType := T\" } EQ_Contact( in1 := @, in2 := \"D\".x ) Move( in := \"D\".x, out1 => \"D\".r )",
    ),
    ("select", "{ S7_Templates := \"value_type := T\" } SEL( g := TRUE, in0 := \"D\".e, in1 := @, out => \"D\".r )"),
    ("text", "S_Move( in := @, out => \"D\".r )"),
    ("wire", "Move( in := @, out1 => wire#w1 ) Move( in := wire#w1, out1 => \"D\".r )"),
    ("contact", "Contact( @ ) Coil( \"D\".r )"),
    ("set", "Contact( @ ) S_Coil( \"D\".r )"),
    ("coil", "Contact( \"D\".x ) Coil( @ ) Coil( \"D\".r )"),
    ("edge", "P_Contact( operand := @, bit := \"D\".e ) Coil( \"D\".r )"),
    ("edge bit", "R_Coil( @ ) P_Contact( operand := \"D\".x, bit := @ ) Coil( \"D\".r )"),
    ("flip-flop", "Contact( @ ) S_SR( operand := \"D\".r, r1 := FALSE )"),
    (
        "enabled",
        "Contact( \"D\".ok ) Move( in := \"D\".e, out1 => @ ) END_RUNG RUNG wire#powerrail Move( in := @, out1 => \"D\".r )",
    ),
];

#[derive(Clone, Copy)]
struct Plan {
    cpu: &'static str,
    language: &'static str,
    function: bool,
    section: &'static str,
    form: &'static (&'static str, &'static str, &'static str),
    kind: &'static Kind,
    using: &'static (&'static str, &'static str),
}

impl Plan {
    #[expect(clippy::nonminimal_bool, reason = "each line is a combination that does not exist")]
    fn exists(&self) -> bool {
        let lacks = ["LWord", "LInt", "ULInt", "LTime", "LTime_Of_Day", "LDT", "Date_And_Time"];
        let ty = self.kind.name;
        let is_bit = matches!(self.using.0, "contact" | "set" | "coil" | "edge" | "edge bit" | "flip-flop");
        let in_list = self.language == "FBD" && self.using.1.contains("Contact");
        !(self.function && self.section == "VAR")
            && !(self.form.1.contains(" of T") && ty.starts_with("Array"))
            && !(self.cpu == "s7-1200" && lacks.contains(&ty))
            && !(self.using.0.starts_with("own") && self.function)
            && !(self.using.0 == "result" && (ty.starts_with("Array") || ty.starts_with("Struct")))
            && (ty == "Bool" || !is_bit)
            && (self.using.0 != "text" || ty.contains("String[") && !ty.starts_with("Array") || ty == "String")
            // Only the first and the last are FBD, too.
            && !in_list
            && !(self.section == "VAR_INPUT"
                && (self.using.1.contains("=> @") || matches!(self.using.0, "by reference" | "block in-out" | "own in-out" | "coil" | "edge bit")))
    }

    fn parts(&self, place: &str, sign: &str) -> Vec<String> {
        self.kind.parts.iter().map(|(part, value)| format!("{place}{part} {sign} {value}")).collect()
    }

    fn source(&self) -> String {
        let ty = self.kind.name;
        let variable = match self.form.0 {
            "whole" => ty.to_string(),
            _ => self.form.1.replace(" of T", &format!(" of {ty}")).replace(": T;", &format!(": {ty};")),
        };
        let value = self.form.2;
        let declared = |name: &str, ty: &str| format!("        {name} : {ty};\n");
        let mut out = String::from(
            "TYPE\n    U : STRUCT\n        a : Int;\n        b : Real;\n        c : Bool;\n        t : String[6];\n        l : Array[0..1] of DWord;\n        z : Char;\n    END_STRUCT;\nEND_TYPE\n",
        );
        let given = matches!(self.section, "VAR_INPUT" | "VAR_IN_OUT");
        _ = writeln!(out, "{{ S7_Optimized := \"FALSE\" }}\nDATA_BLOCK D\n    VAR");
        for name in ["x", "r", "e"] {
            out.push_str(&declared(name, ty));
        }
        _ = writeln!(out, "{}        ok : Bool;\n    END_VAR", declared("a", &variable));
        for part in self.parts("x", ":=") {
            _ = writeln!(out, "    {part};");
        }
        if given {
            for part in self.parts(&value.replace("#v", "a").replace("#i", "1"), ":=") {
                _ = writeln!(out, "    {part};");
            }
        }
        out.push_str("END_DATA_BLOCK\n");
        let network = |rungs: &str| {
            format!(
                "    {{ S7_Language := \"{}\" }}\n    NETWORK\n        RUNG wire#powerrail {rungs} END_RUNG\n    END_NETWORK\n",
                self.language
            )
        };
        let move_to = |from: &str, to: &str| format!("Move( in := {from}, out1 => {to} )");
        let back =
            network(&format!("{} {} {}", move_to("#p", "\"D\".r"), move_to("\"D\".e", "#p"), move_to("\"D\".r", "#p")));
        let (there, here) = (network(&move_to("\"D\".x", "#p")), network(&move_to("#p", "\"D\".r")));
        let callee = |name: &str, section: &str, ty: &str, body: &str| match name.starts_with('B') && name.len() == 2 {
            true => format!(
                "FUNCTION_BLOCK {name}_\n    {section}\n        p : {ty};\n    END_VAR\n{body}END_FUNCTION_BLOCK\nDATA_BLOCK {name} : {name}_\nEND_DATA_BLOCK\n"
            ),
            false => {
                format!("FUNCTION {name} : Void\n    {section}\n        p : {ty};\n    END_VAR\n{body}END_FUNCTION\n")
            }
        };
        let mut own = String::new();
        match self.using.0 {
            "by value" => out.push_str(&callee("ByValue", "VAR_INPUT", ty, &here)),
            "by reference" => out.push_str(&callee("ByReference", "VAR_IN_OUT", ty, &back)),
            "to output" => out.push_str(&callee("ToOutput", "VAR_OUTPUT", ty, &there)),
            "variant" => out.push_str(&callee("ByVariant", "VAR_INPUT", "Variant", "")),
            "result" => {
                _ = writeln!(out, "FUNCTION Result : {ty}\n{}END_FUNCTION", network(&move_to("\"D\".x", "#Result")))
            }
            "block input" => out.push_str(&callee("BI", "VAR_INPUT", ty, &here)),
            "block output" => out.push_str(&callee("BO", "VAR_OUTPUT", ty, &there)),
            "block in-out" => out.push_str(&callee("BX", "VAR_IN_OUT", ty, &back)),
            "own input" => {
                out.push_str(&callee("BI", "VAR_INPUT", ty, &here));
                own = "    VAR\n        mi : BI_;\n    END_VAR\n".to_string();
            }
            "own output" => {
                out.push_str(&callee("BO", "VAR_OUTPUT", ty, &there));
                own = "    VAR\n        mo : BO_;\n    END_VAR\n".to_string();
            }
            "own in-out" => {
                out.push_str(&callee("BX", "VAR_IN_OUT", ty, &back));
                own = "    VAR\n        mx : BX_;\n    END_VAR\n".to_string();
            }
            _ => {}
        }
        let (open, close) = match self.function {
            true => ("FUNCTION F : Void", "END_FUNCTION"),
            false => ("FUNCTION_BLOCK F", "END_FUNCTION_BLOCK"),
        };
        let fill = if given { String::new() } else { move_to("\"D\".x", value) };
        let before = network(&format!("Move( in := 1, out1 => #i ) {fill}"));
        let body = network(
            &self
                .using
                .1
                .replace("SrcType := T\"", &format!("SrcType := {ty}\""))
                .replace("value_type := T\"", &format!("value_type := {ty}\""))
                .replace('@', value),
        );
        _ = writeln!(
            out,
            "{open}\n    {}\n        v : {variable};\n    END_VAR\n{own}    VAR_TEMP\n        i : Int;\n    END_VAR\n{before}{body}{close}",
            self.section
        );
        if !self.function {
            out.push_str("DATA_BLOCK I : F\nEND_DATA_BLOCK\n");
        }
        let callee = if self.function { "\"F\"" } else { "\"I\"" };
        let call = match self.section {
            "VAR_INPUT" | "VAR_IN_OUT" => format!("{callee}( v := \"D\".a )"),
            "VAR_OUTPUT" => format!("{callee}( v => \"D\".a )"),
            _ => format!("{callee}( )"),
        };
        _ = write!(out, "ORGANIZATION_BLOCK Main\n{}", network(&call));
        for part in self.parts("\"D\".r", "==") {
            _ = writeln!(out, "    //@ assert {part}");
        }
        if matches!(self.section, "VAR_OUTPUT" | "VAR_IN_OUT") && self.using.0 != "enabled" {
            for part in self.parts(&value.replace("#v", "\"D\".a").replace("#i", "1"), "==") {
                _ = writeln!(out, "    //@ assert {part}");
            }
        }
        out.push_str("END_ORGANIZATION_BLOCK\n");
        out
    }
}

fn cases(cpu: &'static str, language: &'static str) -> Vec<Case> {
    let mut cases = Vec::new();
    for function in [true, false] {
        for section in SECTIONS {
            for form in FORMS {
                for kind in TYPES {
                    for using in USES {
                        let plan = Plan { cpu, language, function, section, form, kind, using };
                        if plan.exists() {
                            cases.push(Case {
                                kind: format!("{language} {} {section} {}", if function { "FC" } else { "FB" }, form.0),
                                ty: kind.name,
                                using: using.0,
                                variant: cpu.to_string(),
                                ending: "s7dcl",
                                cpu,
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

const STRUCTURED: [&str; 3] = ["Array*", "Struct*", "\"U\""];
const REFUSALS: &[Refusal] = &[
    refusal(&["*"], &STRUCTURED, &["select"], "P0401"),
    // A template names a single type.
    refusal(&["*"], &["Struct*", "Array[0..1, 1..2]*"], &["select", "compare"], "P0538"),
    // A wire carries single values.
    refusal(&["*"], &STRUCTURED, &["wire"], "P0204"),
    refusal(&["*"], &["String*", "WString*", "DTL", "Date_And_Time"], &["wire"], "P0204"),
];

#[test]
fn networks_bring_values_through() {
    let cases = ["s7-1200", "s7-1500"]
        .into_iter()
        .flat_map(|cpu| ["LAD", "FBD"].map(|language| cases(cpu, language)))
        .flatten();
    campaign(cases.collect(), 61, REFUSALS);
}
