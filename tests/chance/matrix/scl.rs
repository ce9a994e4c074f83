//! SCL.

use std::fmt::Write as _;

use super::{Case, Refusal, campaign, refusal};

/// A type, and how a variable of it gets the sample value.
struct Kind {
    name: &'static str,
    /// Suffixes of the parts that are set and compared, with their values.
    parts: &'static [(&'static str, &'static str)],
    /// Bytes of a variable, for views; 0 where a view is another question.
    bytes: u32,
}

const fn plain(name: &'static str, parts: &'static [(&'static str, &'static str)], bytes: u32) -> Kind {
    Kind { name, parts, bytes }
}

/// Types of an S7-1500. An S5TIME is not compared there.
const TYPES: &[Kind] = &[
    plain("Bool", &[("", "TRUE")], 0),
    plain("Byte", &[("", "16#A5")], 1),
    plain("Word", &[("", "16#A55A")], 2),
    plain("DWord", &[("", "16#A55A_1234")], 4),
    plain("LWord", &[("", "16#A55A_1234_89AB_CDEF")], 8),
    plain("SInt", &[("", "-100")], 1),
    plain("USInt", &[("", "200")], 1),
    plain("Int", &[("", "-30000")], 2),
    plain("UInt", &[("", "60000")], 2),
    plain("DInt", &[("", "-2000000000")], 4),
    plain("UDInt", &[("", "4000000000")], 4),
    plain("LInt", &[("", "-9000000000000000000")], 8),
    plain("ULInt", &[("", "18000000000000000000")], 8),
    plain("S5Time", &[("", "S5T#2s340ms")], 2),
    plain("Real", &[("", "-1.25")], 4),
    plain("LReal", &[("", "1.0E100")], 8),
    plain("Time", &[("", "T#-1h")], 4),
    plain("LTime", &[("", "LT#1h1ns")], 8),
    plain("Date", &[("", "D#2024-2-29")], 2),
    plain("Time_Of_Day", &[("", "TOD#12:34:56.789")], 4),
    plain("LTime_Of_Day", &[("", "LTOD#12:34:56.789")], 8),
    plain("LDT", &[("", "LDT#2024-2-29-12:34:56.789")], 8),
    plain("Date_And_Time", &[("", "DT#2024-2-29-12:34:56.789")], 8),
    plain("DTL", &[(".YEAR", "2024"), (".NANOSECOND", "789")], 12),
    plain("Char", &[("", "'x'")], 1),
    plain("WChar", &[("", "WCHAR#'y'")], 2),
    plain("String", &[("", "'a text'")], 256),
    plain("String[7]", &[("", "'a text'")], 10),
    plain("WString", &[("", "WSTRING#'a text'")], 0),
    plain("WString[7]", &[("", "WSTRING#'a text'")], 18),
    plain(
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
        26,
    ),
    plain("Array[0..2] of Int", &[("[0]", "7"), ("[1]", "8"), ("[2]", "-7")], 6),
    plain("Array[-1..1] of LReal", &[("[-1]", "7.5"), ("[0]", "0.5"), ("[1]", "-7.5")], 24),
    plain("Array[-1..1] of Real", &[("[-1]", "7.5"), ("[0]", "0.5"), ("[1]", "-7.5")], 12),
    plain("Array[1..3] of Byte", &[("[1]", "16#11"), ("[2]", "16#22"), ("[3]", "16#33")], 4),
    plain("Array[1..3] of Bool", &[("[1]", "TRUE"), ("[3]", "TRUE")], 2),
    plain("Array[1..2] of String[5]", &[("[1]", "'ab'"), ("[2]", "'abcde'")], 16),
    plain("Array[1..2] of \"U\"", &[("[2].a", "9"), ("[2].t", "'xyz'"), ("[1].b", "0.125"), ("[2].z", "'q'")], 52),
    plain(
        "Array[0..1, 1..2] of LInt",
        &[("[1, 2]", "5000000000"), ("[0, 1]", "-1"), ("[0, 2]", "2"), ("[1, 1]", "3")],
        32,
    ),
    plain(
        "Array[0..1, 1..2] of DInt",
        &[("[1, 2]", "500000000"), ("[0, 1]", "-1"), ("[0, 2]", "2"), ("[1, 1]", "3")],
        16,
    ),
    plain("Struct a : Bool; b : Real; c : Byte; END_STRUCT", &[(".a", "TRUE"), (".b", "0.5"), (".c", "16#77")], 8),
    plain("Struct a : Bool; b : LReal; END_STRUCT", &[(".a", "TRUE"), (".b", "0.5")], 10),
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

/// How the value is in the variable: type of the variable with `T` for the type, and the way to the value.
const FORMS: &[(&str, &str, &str)] = &[
    ("whole", "T", "#v"),
    ("element", "Array[-1..1] of T", "#v[1]"),
    ("indexed", "Array[-1..1] of T", "#v[#i]"),
    ("member", "Struct pad : Bool; m : T; END_STRUCT", "#v.m"),
    ("nested", "Array[0..1] of Struct pad : Byte; m : Array[0..1] of T; END_STRUCT", "#v[#i].m[1]"),
    ("open", "Array[*] of T", "#v[#i]"),
    ("open constant", "Array[*] of T", "#v[1]"),
];

/// Uses: the statements, with `@` for the value.
const USES: &[(&str, &str)] = &[
    ("read", "\"D\".r := @;"),
    ("write", "@ := \"D\".x; \"D\".r := @;"),
    ("by value", "\"ByValue\"(p := @);"),
    ("by reference", "\"ByReference\"(p := @); \"D\".r := @;"),
    ("to output", "\"ToOutput\"(p => @); \"D\".r := @;"),
    ("block input", "\"BI\"(p := @);"),
    ("block output", "\"BO\"(p => @); \"D\".r := @;"),
    ("block in-out", "\"BX\"(p := @); \"D\".r := @;"),
    ("result", "@ := \"Result\"(); \"D\".r := @;"),
    ("variant", "\"D\".r := @; \"ByVariant\"(p := @);"),
    (
        "moved to",
        "\"D\".n := BLKMOV(SRCBLK := \"D\".x, DSTBLK => @); IF \"D\".n <> 0 THEN @ := \"D\".x; END_IF; \"D\".r := @;",
    ),
    ("any", "\"D\".r := @; \"ByAny\"(p := @);"),
    ("pointer", "\"D\".r := @; \"ByPointer\"(p := @);"),
    ("block variant", "\"D\".r := @; \"BV\"(p := @);"),
    ("compare", "IF @ = \"D\".x THEN \"D\".r := \"D\".x; END_IF;"),
    ("select", "\"D\".r := SEL(G := TRUE, IN0 := \"D\".e, IN1 := @);"),
    ("limit", "\"D\".r := MAX(IN1 := @, IN2 := @);"),
    ("slice", "\"D\".r := @; @.%X0 := @.%X0; \"D\".r := @;"),
    ("byte slice", "\"D\".r := @; @.%B1 := @.%B1; \"D\".r := @;"),
    ("text", "\"D\".n := LEN(@); \"D\".r := CONCAT(IN1 := @, IN2 := '');"),
    ("replace", "@ := DELETE(IN := @, L := 0, P := 1); \"D\".r := @;"),
    ("move", "\"D\".n := BLKMOV(SRCBLK := @, DSTBLK => \"D\".r); IF \"D\".n <> 0 THEN \"D\".r := @; END_IF;"),
    ("convert", "\"D\".n := DINT_TO_INT(@); \"D\".r := @;"),
    ("loop", "FOR #i := 1 TO 1 DO \"D\".r := @; END_FOR;"),
    ("view", "FOR #k := 0 TO #last DO #tw[#k] := #vw[#k]; END_FOR; \"D\".r := #t;"),
    ("write view", "#t := \"D\".x; @ := \"D\".e; FOR #k := 0 TO #last DO #vw[#k] := #tw[#k]; END_FOR; \"D\".r := @;"),
    ("asserted", "#i := 1;\n//@ assert ASSERTION\n\"D\".r := @;"),
    ("branch", "IF \"D\".n = 0 THEN \"D\".r := @; ELSE @ := \"D\".e; END_IF;"),
];

/// The memory of the actual parameter.
const PLACES: &[(&str, &str)] = &[("data block", "\"D\".a"), ("local data", "#a")];

/// Where a program runs, and how it is written.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Target {
    /// SCL of STEP 7: numbers of blocks, names without `#`.
    Classic,
    /// SCL of the TIA Portal on an S7-300.
    S7300,
    S71200,
    S71200Optimized,
    S71500,
}

impl Target {
    const ALL: [Target; 5] = [Target::Classic, Target::S7300, Target::S71200, Target::S71200Optimized, Target::S71500];

    fn cpu(self) -> &'static str {
        match self {
            Target::Classic | Target::S7300 => "s7-300",
            Target::S71200 | Target::S71200Optimized => "s7-1200",
            Target::S71500 => "s7-1500",
        }
    }

    fn is_300(self) -> bool {
        matches!(self, Target::Classic | Target::S7300)
    }

    /// Types of bits that the CPU does not have.
    fn lacks(self, ty: &str) -> bool {
        let words =
            |list: &[&str]| ty.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| list.contains(&word));
        match self {
            Target::Classic | Target::S7300 => words(&[
                "LWord",
                "SInt",
                "USInt",
                "UInt",
                "UDInt",
                "LInt",
                "ULInt",
                "LReal",
                "LTime",
                "LTime_Of_Day",
                "LDT",
                "DTL",
                "WChar",
                "WString",
            ]),
            Target::S71200 | Target::S71200Optimized => {
                words(&["LWord", "LInt", "ULInt", "LTime", "LTime_Of_Day", "LDT", "Date_And_Time", "S5Time"])
            }
            Target::S71500 => false,
        }
    }
}

/// One case.
#[derive(Clone, Copy)]
struct Plan {
    target: Target,
    function: bool,
    section: Section,
    form: &'static (&'static str, &'static str, &'static str),
    kind: &'static Kind,
    using: &'static (&'static str, &'static str),
    place: &'static (&'static str, &'static str),
}

impl Plan {
    /// True for combinations that the languages have.
    #[expect(clippy::nonminimal_bool, reason = "each line is a combination that does not exist")]
    fn exists(&self) -> bool {
        let is_open = self.form.1.contains("[*]");
        let has_actual = matches!(self.section, Section::Input | Section::Output | Section::InOut);
        let no_views = self.form.0 != "whole" || self.target == Target::S71200Optimized || self.kind.bytes == 0;
        !(self.function && self.section == Section::Static)
            && !self.target.lacks(self.kind.name)
            && !(self.target.is_300() && (is_open || self.using.0.ends_with("variant")))
            && !(self.using.0.ends_with("view") && no_views)
            && !(self.section == Section::Input && self.using.0 == "write view")
            // Assertions do not look at elements of ARRAY[*].
            && !(is_open && self.using.0 == "asserted")
            // A function has no unnamed type; an S7-1200 has neither POINTER nor ANY.
            && !(self.using.0 == "result" && (self.kind.name.starts_with("Array") || self.kind.name.starts_with("Struct")))
            && !(self.target.cpu() == "s7-1200" && matches!(self.using.0, "any" | "pointer"))
            && (!is_open || self.section == Section::InOut)
            && (has_actual || self.place.0 == "data block")
            // An array of arrays has another form in SCL.
            && !(self.form.1.contains(" of T") && self.kind.name.starts_with("Array"))
    }

    /// `target` gets the sample.
    fn set(&self, target: &str) -> String {
        self.kind.parts.iter().map(|(part, value)| format!("{target}{part} := {value};\n")).collect()
    }

    /// Statements that check that `place` holds the sample.
    fn check(&self, place: &str) -> String {
        let equal = |sign: &str| -> String {
            let parts: Vec<String> =
                self.kind.parts.iter().map(|(part, value)| format!("{place}{part} {sign} {value}")).collect();
            parts.join(" AND ")
        };
        match self.kind.name {
            // Only timers look at one.
            "S5Time" => format!("\"D\".ok := TRUE;\n//@ assert {}\n", equal("==")),
            _ => format!("\"D\".ok := {};\n//@ assert \"D\".ok == 1\n", equal("=")),
        }
    }

    fn source(&self) -> String {
        let ty = self.kind.name;
        let variable = if self.form.0 == "whole" { ty.to_string() } else { variable_type(self.form.1, ty) };
        let value = self.form.2;
        let mut out = String::from(
            "TYPE \"U\"\nSTRUCT\na : Int;\nb : Real;\nc : Bool;\nt : String[6];\nl : Array[0..1] of DWord;\nz : Char;\nEND_STRUCT\nEND_TYPE\n",
        );
        let closed = variable.replace("[*]", "[-1..2]");
        _ = writeln!(
            out,
            "DATA_BLOCK \"D\"\n{{ S7_Optimized_Access := 'ACCESS' }}\nSTRUCT\npad : Bool;\nx : {ty};\nr : {ty};\ne : {ty};\na : {closed};\nn : Int;\nok : Bool;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK"
        );
        let function = |out: &mut String, name: &str, section: &str, ty: &str, body: &str| {
            _ = writeln!(out, "FUNCTION \"{name}\" : Void\n{section}\np : {ty};\nEND_VAR\nBEGIN\n{body}\nEND_FUNCTION");
        };
        function(&mut out, "ByValue", "VAR_INPUT", ty, "\"D\".r := #p;");
        function(&mut out, "ByReference", "VAR_IN_OUT", ty, "\"D\".r := #p; #p := \"D\".e; #p := \"D\".r;");
        function(&mut out, "ToOutput", "VAR_OUTPUT", ty, "#p := \"D\".x;");
        if !self.target.is_300() {
            function(&mut out, "ByVariant", "VAR_INPUT", "Variant", ";");
        }
        if self.target.cpu() != "s7-1200" {
            function(&mut out, "ByAny", "VAR_INPUT", "Any", ";");
            function(&mut out, "ByPointer", "VAR_INPUT", "Pointer", ";");
        }
        if !ty.starts_with("Array") && !ty.starts_with("Struct") {
            _ = writeln!(out, "FUNCTION \"Result\" : {ty}\nBEGIN\n#Result := \"D\".x;\nEND_FUNCTION");
        }
        let block = |out: &mut String, name: &str, section: &str, ty: &str, body: &str| {
            _ = writeln!(
                out,
                "FUNCTION_BLOCK \"{name}_\"\n{section}\np : {ty};\nEND_VAR\nBEGIN\n{body}\nEND_FUNCTION_BLOCK\nDATA_BLOCK \"{name}\" \"{name}_\"\nBEGIN\nEND_DATA_BLOCK"
            );
        };
        block(&mut out, "BI", "VAR_INPUT", ty, "\"D\".r := #p;");
        block(&mut out, "BO", "VAR_OUTPUT", ty, "#p := \"D\".x;");
        block(&mut out, "BX", "VAR_IN_OUT", ty, "\"D\".r := #p; #p := \"D\".e; #p := \"D\".r;");
        if !self.target.is_300() {
            block(&mut out, "BV", "VAR_INPUT", "Variant", ";");
        }

        let (open, close) = if self.function {
            ("FUNCTION \"F\" : Void", "END_FUNCTION")
        } else {
            ("FUNCTION_BLOCK \"F\"", "END_FUNCTION_BLOCK")
        };
        let begins = matches!(self.section, Section::Input | Section::InOut);
        let fill = if begins { String::new() } else { format!("{value} := \"D\".x;\n") };
        let assertion: Vec<String> =
            self.kind.parts.iter().map(|(part, literal)| format!("{value}{part} == {literal}")).collect();
        let body = self.using.1.replace("//@", "//&").replace('@', value).replace("//&", "//@");
        let body = body
            .replace("ASSERTION", &assertion.join(" AND ").replace("#i", "1"))
            .replace("#last", &(self.kind.bytes.max(1) - 1).to_string());
        let is_view = self.using.0.ends_with("view");
        let bytes = format!("Array[0..{}] of Byte", self.kind.bytes.max(1) - 1);
        let (view, copy) = match is_view {
            true => (format!("vw AT v : {bytes};\n"), format!("t : {ty};\ntw AT t : {bytes};\nk : Int;\n")),
            false => Default::default(),
        };
        _ = writeln!(
            out,
            "{open}\nATTRIBUTE{}\nv : {variable};\n{view}END_VAR\nVAR_TEMP\ni : Int;\n{copy}END_VAR\nBEGIN\n#i := 1;\n{fill}{body}\n{close}",
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
            "ORGANIZATION_BLOCK \"Main\"\nVAR_TEMP\na : {closed};\nEND_VAR\nBEGIN\n{}{call}\n{}",
            self.set("\"D\".x"),
            self.check("\"D\".r"),
        );
        if matches!(self.section, Section::Output | Section::InOut) {
            out.push_str(&self.check(&given));
        }
        out.push_str("END_ORGANIZATION_BLOCK\n");
        self.written(out)
    }
}

impl Plan {
    /// The program as the target has it.
    fn written(&self, source: String) -> String {
        let optimized = self.target == Target::S71200Optimized;
        let attribute = match self.target {
            Target::Classic => "",
            _ if optimized => "{ S7_Optimized_Access := 'TRUE' }\n",
            _ => "{ S7_Optimized_Access := 'FALSE' }\n",
        };
        let source = source.replace("ATTRIBUTE", attribute);
        let source = source.replace("'ACCESS'", if optimized { "'TRUE'" } else { "'FALSE'" });
        if self.target != Target::Classic {
            return source;
        }
        const NAMES: &[(&str, &str)] = &[
            ("{ S7_Optimized_Access := 'FALSE' }\n", ""),
            ("\"#Result\" :=", "FC14 :="),
            ("#Result :=", "FC14 :="),
            ("DATA_BLOCK \"D\"", "DATA_BLOCK DB10"),
            ("\"D\"", "DB10"),
            ("TYPE \"U\"", "TYPE UDT1"),
            ("\"U\"", "UDT1"),
            ("\"ByValue\"", "FC11"),
            ("\"ByReference\"", "FC12"),
            ("\"ToOutput\"", "FC13"),
            ("\"Result\"", "FC14"),
            ("\"ByAny\"", "FC15"),
            ("\"ByPointer\"", "FC16"),
            ("\"BI_\"", "FB21"),
            ("\"BO_\"", "FB22"),
            ("\"BX_\"", "FB23"),
            ("DATA_BLOCK \"BI\"", "DATA_BLOCK DB21"),
            ("DATA_BLOCK \"BO\"", "DATA_BLOCK DB22"),
            ("DATA_BLOCK \"BX\"", "DATA_BLOCK DB23"),
            ("\"BI\"", "FB21.DB21"),
            ("\"BO\"", "FB22.DB22"),
            ("\"BX\"", "FB23.DB23"),
            ("DATA_BLOCK \"I\"", "DATA_BLOCK DB1"),
            ("\"I\"", "FB1.DB1"),
            ("FUNCTION \"F\"", "FUNCTION FC1"),
            ("FUNCTION_BLOCK \"F\"", "FUNCTION_BLOCK FB1"),
            ("DB1 \"F\"", "DB1 FB1"),
            ("\"F\"", "FC1"),
            ("\"Main\"", "OB1"),
            (" => ", " := "),
            ("#", "#"),
        ];
        let mut source = source;
        for (name, number) in NAMES {
            source = source.replace(name, number);
        }
        // Names without their sign; literals keep theirs.
        let mut out = String::new();
        let mut before = ' ';
        for c in source.chars() {
            if c != '#' || before.is_alphanumeric() {
                out.push(c);
            }
            before = c;
        }
        out
    }
}

/// `form` with the type in place of its `T`.
fn variable_type(form: &str, ty: &str) -> String {
    form.replace(" of T", &format!(" of {ty}")).replace(": T;", &format!(": {ty};"))
}

fn plans(target: Target) -> Vec<Plan> {
    let mut plans = Vec::new();
    for function in [true, false] {
        for section in Section::ALL {
            for form in FORMS {
                for kind in TYPES {
                    for using in USES {
                        for place in PLACES {
                            let plan = Plan { target, function, section, form, kind, using, place };
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

fn cases(target: Target) -> Vec<Case> {
    plans(target)
        .into_iter()
        .map(|plan| Case {
            kind: format!("{target:?} {} {:?} {}", if plan.function { "FC" } else { "FB" }, plan.section, plan.form.0),
            ty: plan.kind.name,
            using: plan.using.0,
            variant: plan.place.0.to_string(),
            ending: "scl",
            cpu: target.cpu(),
            source: Box::new(move || plan.source()),
        })
        .collect()
}

const STRUCTURED: [&str; 3] = ["Array*", "Struct*", "\"U\""];
const REFUSALS: &[Refusal] = &[
    // Functions of texts.
    refusal(&["*"], &STRUCTURED, &["text", "replace"], "P0401"),
    refusal(
        &["*"],
        &[
            "Bool",
            "Byte",
            "Word",
            "DWord",
            "LWord",
            "SInt",
            "USInt",
            "Int",
            "UInt",
            "DInt",
            "UDInt",
            "LInt",
            "ULInt",
            "Real",
            "LReal",
            "S5Time",
            "Time",
            "LTime",
            "Date*",
            "Time_Of_Day",
            "LTime_Of_Day",
            "LDT",
            "DTL",
            "Char",
            "WChar",
        ],
        &["text", "replace"],
        "P0401",
    ),
    // SEL and MAX take single values; MAX has no order among dates of BCD digits.
    refusal(&["*"], &STRUCTURED, &["select", "limit", "convert"], "P0401"),
    refusal(&["*"], &["Date_And_Time"], &["limit"], "P0401"),
    // Slices are parts of bit strings and integers.
    refusal(&["*"], &STRUCTURED, &["slice", "byte slice"], "P0203"),
    refusal(
        &["*"],
        &[
            "Bool",
            "Real",
            "LReal",
            "S5Time",
            "Time",
            "LTime",
            "Date*",
            "Time_Of_Day",
            "LTime_Of_Day",
            "LDT",
            "DTL",
            "Char",
            "WChar",
            "String*",
            "WString*",
        ],
        &["slice", "byte slice"],
        "P0203",
    ),
    refusal(&["*"], &["Byte", "SInt", "USInt"], &["byte slice"], "P0403"),
    // No order among timers' values, none of structures in SCL of STEP 7.
    refusal(&["*"], &["S5Time"], &["compare"], "P0401"),
    refusal(&["Classic *"], &STRUCTURED, &["compare"], "P0401"),
    // Types without a conversion to DINT.
    refusal(&["*"], &["Bool", "S5Time", "Date*", "String*", "WString*", "DTL", "LTime*", "LDT"], &["convert"], "P0401"),
    refusal(&["Classic *", "S7300 *"], &["Time_Of_Day", "Char", "Real"], &["convert"], "P0401"),
];

#[test]
fn scl_brings_values_through() {
    campaign(Target::ALL.into_iter().flat_map(cases).collect(), 251, REFUSALS);
}
