//! SCL.

use std::fmt::Write as _;

use crate::{Case, Refusal, campaign};

/// A type, and how a variable of it gets the sample value.
struct Kind {
    name: &'static str,
    /// Suffixes of the parts that are set and compared, with their values.
    parts: &'static [(&'static str, &'static str)],
}

const fn plain(name: &'static str, parts: &'static [(&'static str, &'static str)]) -> Kind {
    Kind { name, parts }
}

/// Types of an S7-1500. An S5TIME is not compared there.
const TYPES: &[Kind] = &[
    plain("Bool", &[("", "TRUE")]),
    plain("Byte", &[("", "16#A5")]),
    plain("Word", &[("", "16#A55A")]),
    plain("DWord", &[("", "16#A55A_1234")]),
    plain("LWord", &[("", "16#A55A_1234_89AB_CDEF")]),
    plain("SInt", &[("", "-100")]),
    plain("USInt", &[("", "200")]),
    plain("Int", &[("", "-30000")]),
    plain("UInt", &[("", "60000")]),
    plain("DInt", &[("", "-2000000000")]),
    plain("UDInt", &[("", "4000000000")]),
    plain("LInt", &[("", "-9000000000000000000")]),
    plain("ULInt", &[("", "18000000000000000000")]),
    plain("Real", &[("", "-1.25")]),
    plain("LReal", &[("", "1.0E100")]),
    plain("Time", &[("", "T#-1h")]),
    plain("LTime", &[("", "LT#1h1ns")]),
    plain("Date", &[("", "D#2024-2-29")]),
    plain("Time_Of_Day", &[("", "TOD#12:34:56.789")]),
    plain("LTime_Of_Day", &[("", "LTOD#12:34:56.789")]),
    plain("LDT", &[("", "LDT#2024-2-29-12:34:56.789")]),
    plain("Date_And_Time", &[("", "DT#2024-2-29-12:34:56.789")]),
    plain("DTL", &[(".YEAR", "2024"), (".NANOSECOND", "789")]),
    plain("Char", &[("", "'x'")]),
    plain("WChar", &[("", "WCHAR#'y'")]),
    plain("String", &[("", "'a text'")]),
    plain("String[7]", &[("", "'a text'")]),
    plain("WString", &[("", "WSTRING#'a text'")]),
    plain("WString[7]", &[("", "WSTRING#'a text'")]),
    plain(
        "\"U\"",
        &[(".a", "-3"), (".b", "2.5"), (".c", "TRUE"), (".t", "'uvw'"), (".l[1]", "16#0123_4567_89AB_CDEF")],
    ),
    plain("Array[0..2] of Int", &[("[0]", "7"), ("[2]", "-7")]),
    plain("Array[-1..1] of LReal", &[("[-1]", "7.5"), ("[1]", "-7.5")]),
    plain("Array[1..3] of Bool", &[("[1]", "TRUE"), ("[3]", "TRUE")]),
    plain("Array[1..2] of String[5]", &[("[1]", "'ab'"), ("[2]", "'abcde'")]),
    plain("Array[1..2] of \"U\"", &[("[2].a", "9"), ("[2].t", "'xyz'"), ("[1].b", "0.125")]),
    plain("Array[0..1, 1..2] of LInt", &[("[1, 2]", "5000000000"), ("[0, 1]", "-1")]),
    plain("Struct a : Bool; b : LReal; END_STRUCT", &[(".a", "TRUE"), (".b", "0.5")]),
];

/// Sections of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Section {
    Input,
    Output,
    InOut,
    Static,
    Temp,
}

impl Section {
    const ALL: [Section; 5] = [Section::Input, Section::Output, Section::InOut, Section::Static, Section::Temp];

    fn keyword(self) -> &'static str {
        match self {
            Section::Input => "VAR_INPUT",
            Section::Output => "VAR_OUTPUT",
            Section::InOut => "VAR_IN_OUT",
            Section::Static => "VAR",
            Section::Temp => "VAR_TEMP",
        }
    }
}

/// How the value lies in the variable: type of the variable with `T` for the type, and the way to the value.
const FORMS: &[(&str, &str, &str)] = &[
    ("whole", "T", "#v"),
    ("element", "Array[-1..1] of T", "#v[1]"),
    ("indexed", "Array[-1..1] of T", "#v[#i]"),
    ("member", "Struct pad : Bool; m : T; END_STRUCT", "#v.m"),
    ("nested", "Array[0..1] of Struct pad : Byte; m : Array[0..1] of T; END_STRUCT", "#v[#i].m[1]"),
    ("open", "Array[*] of T", "#v[#i]"),
    ("open constant", "Array[*] of T", "#v[1]"),
];

/// Uses: the statements, with `@` for the value, and whether every type has the use.
const USES: &[(&str, &str, bool)] = &[
    ("read", "\"D\".r := @;", true),
    ("write", "@ := \"D\".x; \"D\".r := @;", true),
    ("by value", "\"ByValue\"(p := @);", true),
    ("by reference", "\"ByReference\"(p := @); \"D\".r := @;", true),
    ("to output", "\"ToOutput\"(p => @); \"D\".r := @;", true),
    ("block input", "\"BI\"(p := @);", true),
    ("block output", "\"BO\"(p => @); \"D\".r := @;", true),
    ("block in-out", "\"BX\"(p := @); \"D\".r := @;", true),
    ("result", "@ := \"Result\"(); \"D\".r := @;", false),
    ("variant", "\"D\".r := @; \"ByVariant\"(p := @);", false),
    (
        "moved to",
        "\"D\".n := BLKMOV(SRCBLK := \"D\".x, DSTBLK => @); IF \"D\".n <> 0 THEN @ := \"D\".x; END_IF; \"D\".r := @;",
        false,
    ),
    ("any", "\"D\".r := @; \"ByAny\"(p := @);", false),
    ("pointer", "\"D\".r := @; \"ByPointer\"(p := @);", false),
    ("block variant", "\"D\".r := @; \"BV\"(p := @);", false),
    ("compare", "IF @ = \"D\".x THEN \"D\".r := \"D\".x; END_IF;", false),
    ("select", "\"D\".r := SEL(G := TRUE, IN0 := \"D\".e, IN1 := @);", false),
    ("limit", "\"D\".r := MAX(IN1 := @, IN2 := @);", false),
    ("slice", "\"D\".r := @; @.%X0 := @.%X0; \"D\".r := @;", false),
    ("byte slice", "\"D\".r := @; @.%B1 := @.%B1; \"D\".r := @;", false),
    ("text", "\"D\".n := LEN(@); \"D\".r := CONCAT(IN1 := @, IN2 := '');", false),
    ("replace", "@ := DELETE(IN := @, L := 0, P := 1); \"D\".r := @;", false),
    ("move", "\"D\".n := BLKMOV(SRCBLK := @, DSTBLK => \"D\".r); IF \"D\".n <> 0 THEN \"D\".r := @; END_IF;", false),
    ("convert", "\"D\".n := DINT_TO_INT(@); \"D\".r := @;", false),
    ("loop", "FOR #i := 1 TO 1 DO \"D\".r := @; END_FOR;", true),
    ("branch", "IF \"D\".n = 0 THEN \"D\".r := @; ELSE @ := \"D\".e; END_IF;", true),
];

/// Where the actual parameter lies.
const PLACES: &[(&str, &str)] = &[("data block", "\"D\".a"), ("local data", "#a")];

/// One case.
#[derive(Clone, Copy)]
struct Plan {
    function: bool,
    section: Section,
    form: &'static (&'static str, &'static str, &'static str),
    kind: &'static Kind,
    using: &'static (&'static str, &'static str, bool),
    place: &'static (&'static str, &'static str),
}

impl Plan {
    /// True for combinations that the languages have.
    fn exists(&self) -> bool {
        let is_open = self.form.1.contains("[*]");
        let has_actual = matches!(self.section, Section::Input | Section::Output | Section::InOut);
        !(self.function && self.section == Section::Static)
            && (!is_open || self.section == Section::InOut)
            && (has_actual || self.place.0 == "data block")
            // An array of arrays has another form in SCL.
            && !(self.form.1.contains(" of T") && self.kind.name.starts_with("Array"))
    }

    /// `target` gets the sample.
    fn set(&self, target: &str) -> String {
        self.kind.parts.iter().map(|(part, value)| format!("{target}{part} := {value};\n")).collect()
    }

    /// True if `place` holds the sample.
    fn holds(&self, place: &str) -> String {
        let parts: Vec<String> =
            self.kind.parts.iter().map(|(part, value)| format!("{place}{part} = {value}")).collect();
        parts.join(" AND ")
    }

    fn source(&self) -> String {
        let ty = self.kind.name;
        let variable = if self.form.0 == "whole" { ty.to_string() } else { variable_type(self.form.1, ty) };
        let value = self.form.2;
        let mut out = String::from(
            "TYPE \"U\"\nSTRUCT\na : Int;\nb : LReal;\nc : Bool;\nt : String[6];\nl : Array[0..1] of LWord;\nEND_STRUCT\nEND_TYPE\n",
        );
        let closed = variable.replace("[*]", "[-1..2]");
        _ = write!(
            out,
            "DATA_BLOCK \"D\"\n{{ S7_Optimized_Access := 'FALSE' }}\nSTRUCT\npad : Bool;\nx : {ty};\nr : {ty};\ne : {ty};\na : {closed};\nn : Int;\nok : Bool;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n"
        );
        let function = |out: &mut String, name: &str, section: &str, ty: &str, body: &str| {
            _ = write!(out, "FUNCTION \"{name}\" : Void\n{section}\np : {ty};\nEND_VAR\nBEGIN\n{body}\nEND_FUNCTION\n");
        };
        function(&mut out, "ByValue", "VAR_INPUT", ty, "\"D\".r := #p;");
        function(&mut out, "ByReference", "VAR_IN_OUT", ty, "\"D\".r := #p; #p := \"D\".e; #p := \"D\".r;");
        function(&mut out, "ToOutput", "VAR_OUTPUT", ty, "#p := \"D\".x;");
        function(&mut out, "ByVariant", "VAR_INPUT", "Variant", ";");
        function(&mut out, "ByAny", "VAR_INPUT", "Any", ";");
        function(&mut out, "ByPointer", "VAR_INPUT", "Pointer", ";");
        if !ty.starts_with("Array") && !ty.starts_with("Struct") {
            _ = write!(out, "FUNCTION \"Result\" : {ty}\nBEGIN\n#Result := \"D\".x;\nEND_FUNCTION\n");
        }
        let block = |out: &mut String, name: &str, section: &str, ty: &str, body: &str| {
            _ = write!(
                out,
                "FUNCTION_BLOCK \"{name}_\"\n{section}\np : {ty};\nEND_VAR\nBEGIN\n{body}\nEND_FUNCTION_BLOCK\nDATA_BLOCK \"{name}\" \"{name}_\"\nBEGIN\nEND_DATA_BLOCK\n"
            );
        };
        block(&mut out, "BI", "VAR_INPUT", ty, "\"D\".r := #p;");
        block(&mut out, "BO", "VAR_OUTPUT", ty, "#p := \"D\".x;");
        block(&mut out, "BX", "VAR_IN_OUT", ty, "\"D\".r := #p; #p := \"D\".e; #p := \"D\".r;");
        block(&mut out, "BV", "VAR_INPUT", "Variant", ";");

        let (open, close) = if self.function {
            ("FUNCTION \"F\" : Void", "END_FUNCTION")
        } else {
            ("FUNCTION_BLOCK \"F\"", "END_FUNCTION_BLOCK")
        };
        let begins = matches!(self.section, Section::Input | Section::InOut);
        let fill = if begins { String::new() } else { format!("{value} := \"D\".x;\n") };
        let body = self.using.1.replace('@', value);
        _ = write!(
            out,
            "{open}\n{}\nv : {variable};\nEND_VAR\nVAR_TEMP\ni : Int;\nEND_VAR\nBEGIN\n#i := 1;\n{fill}{body}\n{close}\n",
            self.section.keyword()
        );
        if !self.function {
            out.push_str("DATA_BLOCK \"I\" \"F\"\nBEGIN\nEND_DATA_BLOCK\n");
        }
        let callee = if self.function { "\"F\"" } else { "\"I\"" };
        let actual = self.place.1;
        let given = value.replacen("#v", actual, 1).replace("#i", "1");
        let call = match self.section {
            Section::Input | Section::InOut => format!("{given} := \"D\".x;\n{callee}(v := {actual});"),
            Section::Output => format!("{callee}(v => {actual});"),
            Section::Static | Section::Temp => format!("{callee}();"),
        };
        _ = write!(
            out,
            "ORGANIZATION_BLOCK \"Main\"\nVAR_TEMP\na : {closed};\nEND_VAR\nBEGIN\n{}{call}\n\"D\".ok := {};\n//@ assert \"D\".ok == 1\n",
            self.set("\"D\".x"),
            self.holds("\"D\".r"),
        );
        if matches!(self.section, Section::Output | Section::InOut) {
            _ = write!(out, "\"D\".ok := {};\n//@ assert \"D\".ok == 1\n", self.holds(&given));
        }
        out.push_str("END_ORGANIZATION_BLOCK\n");
        out
    }
}

/// `form` with the type in place of its `T`.
fn variable_type(form: &str, ty: &str) -> String {
    form.replace(" of T", &format!(" of {ty}")).replace(": T;", &format!(": {ty};"))
}

fn plans() -> Vec<Plan> {
    let mut plans = Vec::new();
    for function in [true, false] {
        for section in Section::ALL {
            for form in FORMS {
                for kind in TYPES {
                    for using in USES {
                        for place in PLACES {
                            let plan = Plan { function, section, form, kind, using, place };
                            if plan.exists() {
                                plans.push(plan);
                            }
                        }
                    }
                }
            }
        }
    }
    plans
}


fn cases() -> Vec<Case> {
    plans()
        .into_iter()
        .map(|plan| Case {
            kind: format!("{} {:?} {}", if plan.function { "FC" } else { "FB" }, plan.section, plan.form.0),
            ty: plan.kind.name,
            using: plan.using.0,
            variant: plan.place.0.to_string(),
            ending: "scl",
            cpu: "s7-1500",
            source: Box::new(move || plan.source()),
        })
        .collect()
}

const REFUSALS: &[Refusal] = &[];

#[test]
fn scl_brings_values_through() {
    campaign(cases(), 37, REFUSALS);
}
