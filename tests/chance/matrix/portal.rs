//! STL of the TIA Portal on an S7-1500: types of 64 bits, texts with two bytes per character, and blocks of SCL next to those of STL.
//!
//! A block of STL gets the variable from SCL, and hands it to blocks of SCL and STL.

use std::fmt::Write as _;

use super::{Case, campaign};

/// A type with its sample, and true if `L` and `T` take it.
const TYPES: &[(&str, &str, bool)] = &[
    ("Bool", "TRUE", false),
    ("Byte", "16#A5", true),
    ("Word", "16#A55A", true),
    ("DWord", "16#A55A_1234", true),
    ("LWord", "16#A55A_1234_89AB_CDEF", false),
    ("SInt", "-100", true),
    ("USInt", "200", true),
    ("Int", "-30000", true),
    ("UInt", "60000", true),
    ("DInt", "-2000000000", true),
    ("UDInt", "4000000000", true),
    ("LInt", "-9000000000000000000", false),
    ("ULInt", "18000000000000000000", false),
    ("Real", "-1.25", true),
    ("LReal", "1.0E100", false),
    ("S5Time", "S5T#2s340ms", true),
    ("Time", "T#-1h", true),
    ("LTime", "LT#1h1ns", false),
    ("Date", "D#2024-2-29", true),
    ("Time_Of_Day", "TOD#12:34:56.789", true),
    ("LTime_Of_Day", "LTOD#12:34:56.789", false),
    ("LDT", "LDT#2024-2-29-12:34:56.789", false),
    ("Date_And_Time", "DT#2024-2-29-12:34:56.789", false),
    ("Char", "'x'", true),
    ("WChar", "WCHAR#'y'", true),
    ("String", "'a text'", false),
    ("String[7]", "'a text'", false),
    ("WString[7]", "WSTRING#'a text'", false),
];

const SECTIONS: [&str; 5] = ["VAR_INPUT", "VAR_OUTPUT", "VAR_IN_OUT", "VAR", "VAR_TEMP"];

const FORMS: &[(&str, &str, &str)] = &[
    ("whole", "T", "#v"),
    ("element", "Array[-1..1] of T", "#v[1]"),
    ("member", "Struct pad : Bool; m : T; END_STRUCT", "#v.m"),
];

/// Uses, with `@` for the value.
const USES: &[(&str, &str)] = &[
    ("load", "L @; T \"D\".r;"),
    ("logic", "A @; = \"D\".r;"),
    ("by value", "CALL \"ByValue\" (p := @);"),
    ("by reference", "CALL \"ByReference\" (p := @); CALL \"ByValue\" (p := @);"),
    ("to output", "CALL \"ToOutput\" (p := @); CALL \"ByValue\" (p := @);"),
    ("block input", "CALL \"BI_\", \"BI\" (p := @);"),
    ("block output", "CALL \"BO_\", \"BO\" (p := @); CALL \"ByValue\" (p := @);"),
    ("block in-out", "CALL \"BX_\", \"BX\" (p := @); CALL \"ByValue\" (p := @);"),
    ("to STL", "CALL \"S\" (p := @);"),
    ("variant", "CALL \"ByValue\" (p := @); CALL \"ByVariant\" (p := @);"),
    ("moved", "CALL BLKMOV (SRCBLK := @, RET_VAL := #n, DSTBLK := \"D\".r);"),
    ("asserted", "\n//@ assert @ == SAMPLE\nCALL \"ByValue\" (p := @);"),
];

#[derive(Clone, Copy)]
struct Plan {
    function: bool,
    section: &'static str,
    form: &'static (&'static str, &'static str, &'static str),
    kind: &'static (&'static str, &'static str, bool),
    using: &'static (&'static str, &'static str),
    /// Who calls it: SCL, or STL.
    caller: &'static str,
}

impl Plan {
    fn exists(&self) -> bool {
        let is_bit = self.kind.0 == "Bool";
        !(self.function && self.section == "VAR")
            && (self.using.0 != "load" || self.kind.2)
            && (self.using.0 != "logic" || is_bit)
            && !(self.using.0 == "moved" && is_bit)
            // In STL a text of TEMP has no length.
            && !(self.section == "VAR_TEMP" && self.kind.0.contains("String"))
            && !(self.section == "VAR_INPUT" && matches!(self.using.0, "by reference" | "to output" | "block output" | "block in-out"))
    }

    fn source(&self) -> String {
        let (ty, sample) = (self.kind.0, self.kind.1);
        let variable = match self.form.0 {
            "whole" => ty.to_string(),
            _ => self.form.1.replace(" of T", &format!(" of {ty}")).replace(": T;", &format!(": {ty};")),
        };
        let value = self.form.2;
        let given = matches!(self.section, "VAR_INPUT" | "VAR_IN_OUT");
        let mut out = format!(
            "DATA_BLOCK \"D\"\n{{ S7_Optimized_Access := 'FALSE' }}\nSTRUCT\npad : Bool;\nx : {ty};\nr : {ty};\ne : {ty};\na : {variable};\nn : Int;\nok : Bool;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n"
        );
        let function = |name: &str, section: &str, ty: &str, body: &str| {
            format!("FUNCTION \"{name}\" : Void\n{section}\np : {ty};\nEND_VAR\nBEGIN\n{body}\nEND_FUNCTION\n")
        };
        let block = |name: &str, section: &str, body: &str| {
            format!(
                "FUNCTION_BLOCK \"{name}_\"\n{section}\np : {ty};\nEND_VAR\nBEGIN\n{body}\nEND_FUNCTION_BLOCK\nDATA_BLOCK \"{name}\" \"{name}_\"\nBEGIN\nEND_DATA_BLOCK\n"
            )
        };
        out.push_str(&function("ByValue", "VAR_INPUT", ty, "\"D\".r := #p;"));
        out.push_str(&function("ByReference", "VAR_IN_OUT", ty, "\"D\".r := #p; #p := \"D\".e; #p := \"D\".r;"));
        out.push_str(&function("ToOutput", "VAR_OUTPUT", ty, "#p := \"D\".x;"));
        out.push_str(&function("ByVariant", "VAR_INPUT", "Variant", ";"));
        out.push_str(&block("BI", "VAR_INPUT", "\"D\".r := #p;"));
        out.push_str(&block("BO", "VAR_OUTPUT", "#p := \"D\".x;"));
        out.push_str(&block("BX", "VAR_IN_OUT", "\"D\".r := #p; #p := \"D\".e; #p := \"D\".r;"));
        if self.caller == "SCL" {
            let call = match self.section {
                "VAR_INPUT" | "VAR_IN_OUT" => "(v := \"D\".a);",
                "VAR_OUTPUT" => "(v => \"D\".a);",
                _ => "();",
            };
            let callee = if self.function { "\"F\"" } else { "\"I\"" };
            out.push_str(&format!("FUNCTION \"Caller\" : Void\nBEGIN\n{callee}{call}\nEND_FUNCTION\n"));
        }
        let path = value.replace("#v", "\"D\".a");
        let first = if given { format!("{path} := \"D\".x;\n") } else { String::new() };
        _ = write!(
            out,
            "FUNCTION \"Begin\" : Void\nBEGIN\n\"D\".x := {sample};\n{first}END_FUNCTION\n\
             FUNCTION \"End\" : Void\nBEGIN\n;\n//@ assert \"D\".r == {sample}\n{}END_FUNCTION\n",
            match self.section {
                "VAR_OUTPUT" | "VAR_IN_OUT" => format!("//@ assert {path} == {sample}\n"),
                _ => String::new(),
            }
        );
        out
    }

    fn statements(&self) -> String {
        let (ty, sample) = (self.kind.0, self.kind.1);
        let variable = match self.form.0 {
            "whole" => ty.to_string(),
            _ => self.form.1.replace(" of T", &format!(" of {ty}")).replace(": T;", &format!(": {ty};")),
        };
        let value = self.form.2;
        let given = matches!(self.section, "VAR_INPUT" | "VAR_IN_OUT");
        let fill = if given { String::new() } else { format!("CALL \"ToOutput\" (p := {value});\n") };
        let body =
            self.using.1.replace("//@", "//&").replace('@', value).replace("//&", "//@").replace("SAMPLE", sample);
        let mut out = format!(
            "FUNCTION \"S\" : Void\nVAR_INPUT p : {ty}; END_VAR\nBEGIN\nCALL \"ByValue\" (p := #p);\nEND_FUNCTION\n"
        );
        let declared =
            format!("{}\nv : {variable};\nEND_VAR\nVAR_TEMP\nn : Int;\nEND_VAR\nBEGIN\n{fill}{body}\n", self.section);
        match self.function {
            true => _ = writeln!(out, "FUNCTION \"F\" : Void\n{declared}END_FUNCTION"),
            false => {
                _ = writeln!(
                    out,
                    "FUNCTION_BLOCK \"F\"\n{declared}END_FUNCTION_BLOCK\nDATA_BLOCK \"I\" \"F\"\nBEGIN\nEND_DATA_BLOCK"
                );
            }
        }
        let parameters = match self.section {
            "VAR_INPUT" | "VAR_IN_OUT" | "VAR_OUTPUT" => " (v := \"D\".a)",
            _ => "",
        };
        let call = match (self.caller, self.function) {
            ("SCL", _) => "CALL \"Caller\";".to_string(),
            (_, true) => format!("CALL \"F\"{parameters};"),
            (_, false) => format!("CALL \"F\", \"I\"{parameters};"),
        };
        _ = writeln!(
            out,
            "ORGANIZATION_BLOCK \"Main\"\nBEGIN\nCALL \"Begin\";\n{call}\nCALL \"End\";\nEND_ORGANIZATION_BLOCK"
        );
        out
    }
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for function in [true, false] {
        for section in SECTIONS {
            for form in FORMS {
                for kind in TYPES {
                    for using in USES {
                        for caller in ["SCL", "STL"] {
                            let plan = Plan { function, section, form, kind, using, caller };
                            if plan.exists() {
                                cases.push(Case {
                                    kind: format!("{} {section} {}", if function { "FC" } else { "FB" }, form.0),
                                    ty: kind.0,
                                    using: using.0,
                                    variant: format!("called from {caller}"),
                                    ending: "scl",
                                    cpu: "s7-1500",
                                    source: Box::new(move || {
                                        format!("{}{}{}", plan.source(), super::NEXT_FILE, plan.statements())
                                    }),
                                });
                            }
                        }
                    }
                }
            }
        }
    }
    cases
}

#[test]
fn stl_of_the_portal_brings_values_through() {
    // Nothing of this is refused.
    campaign(cases(), 29, &[]);
}
