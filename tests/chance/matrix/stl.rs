//! STL: functions, function blocks and multi-instances, with every type that can be declared.
//!
//! The sample is DB10.x, the result DB11.r, both between words that must not change. DB13.a is an actual parameter in a data block.

mod types;

use std::fmt::Write as _;

use super::{Case, Refusal, campaign};
use types::Class::{Bit, Complex, Number};
use types::{Kind, TYPES};

/// The kind of block.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Block {
    Function,
    Instance,
    MultiInstance,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Section {
    Input,
    Output,
    InOut,
    Static,
    Temp,
}

const SECTIONS: [(Section, &str); 5] = [
    (Section::Input, "VAR_INPUT"),
    (Section::Output, "VAR_OUTPUT"),
    (Section::InOut, "VAR_IN_OUT"),
    (Section::Static, "VAR"),
    (Section::Temp, "VAR_TEMP"),
];

/// Type of the variable with `T` for the type, and the way to the value.
const FORMS: &[(&str, &str, &str)] = &[
    ("whole", "T", ""),
    ("element", "ARRAY [-1..1] OF T", "[1]"),
    ("member", "STRUCT pad : BOOL; m : T; END_STRUCT", ".m"),
    ("nested", "ARRAY [0..1] OF STRUCT pad : BYTE; m : ARRAY [0..1] OF T; END_STRUCT", "[1].m[1]"),
];

const USES: &[&str] = &[
    "read",
    "copy",
    "write",
    "by value",
    "by reference",
    "to output",
    "block input",
    "block output",
    "block in-out",
    "own input",
    "own output",
    "own in-out",
    "pointer",
    "any",
    "block pointer",
    "block any",
    "address",
    "loaded address",
    "indirect",
    "compare",
    "asserted",
    "flank",
    "set",
    "text",
    "date",
    "any handed on",
];

/// The memory of the actual parameter.
const PLACES: &[&str] = &["data block", "local data", "memory", "formal of a function", "formal of a block"];

#[derive(Clone, Copy)]
struct Plan {
    block: Block,
    section: (Section, &'static str),
    form: &'static (&'static str, &'static str, &'static str),
    kind: &'static Kind,
    using: &'static str,
    place: &'static str,
}

impl Plan {
    fn exists(&self) -> bool {
        let (section, class) = (self.section.0, self.kind.class);
        let passes = matches!(section, Section::Input | Section::Output | Section::InOut);
        let bit_or_number = class != Complex;
        !(self.block == Block::Function && section == Section::Static)
            && (passes || self.place == "data block")
            // An array of arrays, and an array of unnamed structures with arrays in it, are other types.
            && !(self.form.1.contains("OF T") && self.kind.name.starts_with("ARRAY"))
            && (self.place != "memory" || (bit_or_number && self.form.0 == "whole"))
            && match self.using {
                "own input" | "own output" | "own in-out" => self.block != Block::Function,
                "address" => self.form.0 == "whole",
                "indirect" => {
                    self.form.0 == "whole"
                        && class == Number
                        && (section == Section::Temp
                            || self.block != Block::Function)
                }
                "loaded address" => self.form.0 == "whole" && self.block == Block::Function && bit_or_number && passes,
                "compare" => matches!(self.kind.name, "INT" | "DINT" | "REAL" | "WORD" | "DWORD"),
                "flank" | "set" => class == Bit,
                "text" => self.kind.name.starts_with("STRING"),
                "date" => self.kind.name == "DATE_AND_TIME",
                "any" | "pointer" | "block any" | "block pointer" | "any handed on" => class != Bit || self.using.contains("pointer"),
                _ => true,
            }
            // An input is not written.
            && !(section == Section::Input && matches!(self.using, "write" | "to output" | "by reference" | "block output"
                | "block in-out" | "own output" | "own in-out"))
    }

    fn variable(&self) -> String {
        match self.form.0 {
            "whole" => self.kind.name.to_string(),
            _ => self
                .form
                .1
                .replace("OF T", &format!("OF {}", self.kind.name))
                .replace(": T;", &format!(": {};", self.kind.name)),
        }
    }

    /// Copies `from` to `to`; both are names.
    fn copy(&self, from: &str, to: &str) -> String {
        match self.kind.class {
            Bit => format!("A {from}; = {to};\n"),
            Number => format!("L {from}; T {to};\n"),
            Complex => format!("CALL SFC 20 (SRCBLK := {from}, RET_VAL := #n, DSTBLK := {to});\n"),
        }
    }

    fn result(&self) -> String {
        self.pointed("DB11.r", 11)
    }

    fn sample(&self) -> String {
        self.pointed("DB10.x", 10)
    }

    /// A variable after a word in a data block, for SFC 20 as bytes.
    fn pointed(&self, name: &str, db: u32) -> String {
        match self.kind.class {
            Complex => format!("P#DB{db}.DBX 2.0 BYTE {}", self.kind.bytes),
            Bit | Number => name.to_string(),
        }
    }

    /// Statements of the use for `value`.
    fn body(&self, value: &str) -> String {
        let to_result = self.copy(value, &self.result());
        match self.using {
            "read" => self
                .kind
                .leaves
                .iter()
                .map(|(leaf, class, _)| match class {
                    Bit => format!("A {value}{leaf}; = DB11.r{leaf};\n"),
                    Number => format!("L {value}{leaf}; T DB11.r{leaf};\n"),
                    Complex => {
                        format!("CALL SFC 20 (SRCBLK := {value}{leaf}, RET_VAL := #n, DSTBLK := DB11.r{leaf});\n")
                    }
                })
                .collect(),
            "copy" => to_result,
            "write" => format!("{}{}{to_result}", self.copy("DB12.e", value), self.copy(&self.sample(), value)),
            "by value" => format!("CALL FC 11 (p := {value});\n"),
            "by reference" => format!("CALL FC 12 (p := {value});\n{to_result}"),
            "to output" => format!("CALL FC 13 (p := {value});\n{to_result}"),
            "block input" => format!("CALL FB 21, DB 21 (p := {value});\n"),
            "block output" => format!("CALL FB 22, DB 22 (p := {value});\n{to_result}"),
            "block in-out" => format!("CALL FB 23, DB 23 (p := {value});\n{to_result}"),
            "own input" => format!("CALL #m21 (p := {value});\n"),
            "own output" => format!("CALL #m22 (p := {value});\n{to_result}"),
            "own in-out" => format!("CALL #m23 (p := {value});\n{to_result}"),
            "pointer" => format!("CALL FC 14 (p := {value});\n"),
            "any" => format!("CALL FC 15 (p := {value});\n"),
            "any handed on" => format!("CALL FC 16 (p := {value});\n"),
            "block pointer" => format!("CALL FB 24, DB 24 (p := {value});\n"),
            "block any" => format!("CALL FB 25, DB 25 (p := {value});\n"),
            "address" => self.address(),
            "loaded address" => match self.kind.class {
                Bit => "L P##v; LAR1; A [AR1,P#0.0]; = DB11.r;\n".to_string(),
                _ => format!("OPN DB 13; L P##v; LAR1; L {} [AR1,P#0.0]; T DB11.r;\n", self.width()),
            },
            "indirect" => {
                let area = if self.section.0 == Section::Temp { "L" } else { "DI" };
                let base = if area == "DI" { "TAR2; +D;" } else { "" };
                format!("L P##v; {base} T MD 20; L {area}{} [MD 20]; T DB11.r;\n", self.width())
            }
            "compare" => {
                let letter = match self.kind.name {
                    "INT" | "WORD" => "I",
                    "REAL" => "R",
                    _ => "D",
                };
                format!("L {value}; L DB10.x; =={letter}; JCN no; L DB10.x; T DB11.r;\nno: NOP 0;\n")
            }
            "asserted" => {
                let lines: String = self
                    .kind
                    .leaves
                    .iter()
                    .map(|(leaf, _, literal)| format!("//@ assert {value}{leaf} == {literal}\n"))
                    .collect();
                format!("\n{lines}{to_result}")
            }
            "flank" => format!("A {value}; FP M 30.0; = DB11.r;\n"),
            "set" => format!(
                "CLR; O {value}; S DB11.r; AN {value}; R DB11.r; X {value}; X M 30.0; JCN no; S DB11.r;\nno: NOP 0;\n"
            ),
            "text" => format!(
                "CALL FC 21 (S := {value}, RET_VAL := #n);\n//@ assert #n == {}\n{to_result}",
                self.kind.leaves[0].2.len() - 2
            ),
            "date" => format!("CALL FC 6 (IN := {value}, RET_VAL := #d);\n//@ assert #d == D#2024-2-29\n{to_result}"),
            other => unreachable!("{other}"),
        }
    }

    fn width(&self) -> &'static str {
        match self.kind.bytes {
            1 => "B",
            2 => "W",
            _ => "D",
        }
    }

    /// Reads the variable byte by byte through `P##v`.
    fn address(&self) -> String {
        let mut out = String::new();
        let in_function = self.block == Block::Function && self.section.0 != Section::Temp;
        let through_pointer = self.kind.class == Complex && (in_function || self.section.0 == Section::InOut);
        if through_pointer {
            // Six bytes: number of the data block, area pointer. In an instance they are after AR2.
            let base = if in_function { "" } else { "TAR2; +AR1; " };
            _ = writeln!(out, "LAR1 P##v; {base}L W [AR1,P#0.0]; T #n; L D [AR1,P#2.0]; LAR1;");
        } else if in_function {
            // The area pointer of the actual.
            _ = writeln!(out, "L P##v; LAR1;");
        } else {
            let base = if self.section.0 == Section::Temp { "" } else { "TAR2; +AR1; " };
            _ = writeln!(out, "LAR1 P##v; {base}");
        }
        if through_pointer {
            out.push_str("OPN DB [#n];\n");
        } else if in_function {
            out.push_str("OPN DB 13;\n");
        }
        if self.kind.class == Bit {
            out.push_str("A [AR1,P#0.0]; = M 100.0;\nA M 100.0; = DB11.r;\n");
            return out;
        }
        for byte in 0..self.kind.bytes {
            _ = writeln!(out, "L B [AR1,P#{byte}.0]; T MB {};", 100 + byte % 100);
            if byte % 100 == 99 || byte + 1 == self.kind.bytes {
                let (from, count) = (byte / 100 * 100, byte % 100 + 1);
                _ = writeln!(
                    out,
                    "TAR1 MD 20;\nCALL SFC 20 (SRCBLK := P#M 100.0 BYTE {count}, RET_VAL := #k, DSTBLK := P#DB11.DBX {}.0 BYTE {count});\nLAR1 MD 20;",
                    2 + from
                );
                if through_pointer {
                    out.push_str("OPN DB [#n];\n");
                } else if in_function {
                    out.push_str("OPN DB 13;\n");
                }
            }
        }
        out
    }

    /// Blocks that the use calls.
    fn callees(&self, out: &mut String) {
        let ty = self.kind.name;
        let back = |name: &str| self.copy(name, &self.result());
        let there_and_back =
            |name: &str| format!("{}{}{}", back(name), self.copy("DB12.e", name), self.copy(&self.result(), name));
        let from_sample = |name: &str| self.copy(&self.sample(), name);
        let function = |out: &mut String, number: u32, section: &str, ty: &str, body: &str| {
            _ = writeln!(
                out,
                "FUNCTION FC {number} : VOID\n{section}\np : {ty};\nEND_VAR\nVAR_TEMP n : INT; w : WORD; y : ANY; END_VAR\nBEGIN\n{body}END_FUNCTION"
            );
        };
        let block = |out: &mut String, number: u32, section: &str, ty: &str, body: &str| {
            _ = writeln!(
                out,
                "FUNCTION_BLOCK FB {number}\n{section}\np : {ty};\nEND_VAR\nVAR_TEMP n : INT; w : WORD; y : ANY; END_VAR\nBEGIN\n{body}END_FUNCTION_BLOCK\nDATA_BLOCK DB {number}\nFB {number}\nBEGIN\nEND_DATA_BLOCK"
            );
        };
        let bytes = self.kind.bytes;
        let by_pointer = match self.kind.class {
            Bit => {
                "T #w; L D [AR1,P#2.0]; LAR1; OPN DB [#w]; A [AR1,P#0.0]; = M 100.0; A M 100.0; = DB11.r;\n".to_string()
            }
            _ => format!(
                "T #w; L D [AR1,P#2.0]; LAR2 P##y; T D [AR2,P#6.0]; L #w; T W [AR2,P#4.0]; L W#16#1002; T W [AR2,P#0.0]; L {bytes}; T W [AR2,P#2.0];\nCALL SFC 20 (SRCBLK := #y, RET_VAL := #n, DSTBLK := P#DB11.DBX 2.0 BYTE {bytes});\n"
            ),
        };
        let by_any = format!("CALL SFC 20 (SRCBLK := #p, RET_VAL := #n, DSTBLK := P#DB11.DBX 2.0 BYTE {bytes});\n");
        match self.using {
            "by value" => function(out, 11, "VAR_INPUT", ty, &back("#p")),
            "by reference" => function(out, 12, "VAR_IN_OUT", ty, &there_and_back("#p")),
            "to output" => function(out, 13, "VAR_OUTPUT", ty, &from_sample("#p")),
            "pointer" => {
                function(out, 14, "VAR_INPUT", "POINTER", &format!("LAR1 P##p; L W [AR1,P#0.0]; {by_pointer}"))
            }
            "any" => function(out, 15, "VAR_INPUT", "ANY", &by_any),
            "any handed on" => {
                function(out, 15, "VAR_INPUT", "ANY", &by_any);
                function(out, 16, "VAR_INPUT", "ANY", "CALL FB 25, DB 25 (p := #p);\n");
                block(out, 25, "VAR_INPUT", "ANY", "CALL FC 15 (p := #p);\n");
            }
            "block input" | "own input" => block(out, 21, "VAR_INPUT", ty, &back("#p")),
            "block output" | "own output" => block(out, 22, "VAR_OUTPUT", ty, &from_sample("#p")),
            "block in-out" | "own in-out" => block(out, 23, "VAR_IN_OUT", ty, &there_and_back("#p")),
            "block pointer" => block(
                out,
                24,
                "VAR_INPUT",
                "POINTER",
                &format!("TAR2 MD 40; LAR1 P##p; TAR2; +AR1; L W [AR1,P#0.0]; {by_pointer}LAR2 MD 40;\n"),
            ),
            "block any" => block(out, 25, "VAR_INPUT", "ANY", &by_any),
            _ => {}
        }
    }

    fn source(&self) -> String {
        let (ty, variable) = (self.kind.name, self.variable());
        let mut out = String::new();
        if ty.contains("UDT 1") {
            out.push_str("TYPE UDT 1\nSTRUCT\na : INT; b : REAL; c : BOOL; d : BYTE; t : STRING [6]; l : ARRAY [0..1] OF DWORD; e : CHAR;\nEND_STRUCT;\nEND_TYPE\n");
        }
        let values = |name: &str| -> String {
            self.kind.leaves.iter().map(|(leaf, _, literal)| format!("{name}{leaf} := {literal};\n")).collect()
        };
        let path = format!("a{}", self.form.2);
        let given = matches!(self.section.0, Section::Input | Section::InOut);
        _ = write!(
            out,
            "DATA_BLOCK DB 10\nSTRUCT g : WORD; x : {ty}; h : WORD; END_STRUCT;\nBEGIN\n{}END_DATA_BLOCK\n\
             DATA_BLOCK DB 11\nSTRUCT g : WORD := W#16#AAAA; r : {ty}; h : WORD := W#16#5555; END_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n\
             DATA_BLOCK DB 12\nSTRUCT g : WORD; e : {ty}; h : WORD; END_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n\
             DATA_BLOCK DB 13\nSTRUCT g : WORD := W#16#AAAA; a : {variable}; h : WORD := W#16#5555; END_STRUCT;\nBEGIN\n{}END_DATA_BLOCK\n",
            values("x"),
            if given { values(&path) } else { String::new() },
        );
        self.callees(&mut out);
        let value = format!("#v{}", self.form.2);
        let fill = if given { String::new() } else { self.copy(&self.sample(), &value) };
        let body = self.body(&value);
        let own: String = match (self.using, self.section.0) {
            ("own input", _) => "VAR m21 : FB 21; END_VAR\n",
            ("own output", _) => "VAR m22 : FB 22; END_VAR\n",
            ("own in-out", _) => "VAR m23 : FB 23; END_VAR\n",
            _ => "",
        }
        .to_string();
        let declared =
            format!("{} v : {variable}; END_VAR\n{own}VAR_TEMP n : INT; k : INT; d : DATE; END_VAR\n", self.section.1);
        match self.block {
            Block::Function => _ = writeln!(out, "FUNCTION FC 1 : VOID\n{declared}BEGIN\n{fill}{body}END_FUNCTION"),
            Block::Instance | Block::MultiInstance => {
                _ = writeln!(out, "FUNCTION_BLOCK FB 1\n{declared}BEGIN\n{fill}{body}END_FUNCTION_BLOCK");
            }
        }
        let actual = match self.place {
            "local data" => "#a".to_string(),
            "memory" => match self.kind.class {
                Bit => "M 60.3".to_string(),
                _ => format!("M{} 61", self.width()),
            },
            _ => "DB13.a".to_string(),
        };
        let passes = matches!(self.section.0, Section::Input | Section::Output | Section::InOut);
        // Who calls the block, with which actual.
        let call = |number: &str, actual: &str| match passes {
            true => format!("CALL {number} (v := {actual});\n"),
            false => format!("CALL {number};\n"),
        };
        match self.block {
            Block::Function => {}
            Block::Instance => out.push_str("DATA_BLOCK DB 1\nFB 1\nBEGIN\nEND_DATA_BLOCK\n"),
            Block::MultiInstance => {
                // After other data; the call uses a separate formal parameter where one is needed.
                let section = if self.place == "formal of a block" {
                    format!("{} w : {variable}; END_VAR\n", self.section.1)
                } else {
                    String::new()
                };
                let given = if self.place == "formal of a block" { "#w" } else { &actual };
                let local = if self.place == "local data" {
                    format!("VAR_TEMP a : {variable}; n : INT; END_VAR\n")
                } else {
                    String::new()
                };
                _ = writeln!(
                    out,
                    "FUNCTION_BLOCK FB 2\n{section}VAR pad : ARRAY [0..4] OF INT; h : FB 1; END_VAR\n{local}BEGIN\n{}{}{}END_FUNCTION_BLOCK\nDATA_BLOCK DB 2\nFB 2\nBEGIN\nEND_DATA_BLOCK",
                    if self.place == "local data" { self.before(&actual) } else { String::new() },
                    call("#h", given),
                    if self.place == "local data" { self.after(&actual) } else { String::new() },
                );
            }
        }
        let target = match self.block {
            Block::Function => "FC 1",
            Block::Instance => "FB 1, DB 1",
            Block::MultiInstance => "FB 2, DB 2",
        };
        let mut main = String::new();
        let outer = match (self.place, self.block) {
            ("formal of a function", _) => {
                let inner = if self.block == Block::MultiInstance { "FB 1, DB 1" } else { target };
                if self.block == Block::MultiInstance {
                    out.push_str("DATA_BLOCK DB 1\nFB 1\nBEGIN\nEND_DATA_BLOCK\n");
                }
                _ = writeln!(
                    out,
                    "FUNCTION FC 3 : VOID\n{} w : {variable}; END_VAR\nBEGIN\n{}END_FUNCTION",
                    self.section.1,
                    call(inner, "#w")
                );
                "CALL FC 3 (w := DB13.a);\n".to_string()
            }
            ("formal of a block", Block::MultiInstance) => "CALL FB 2, DB 2 (w := DB13.a);\n".to_string(),
            ("formal of a block", _) => {
                _ = writeln!(
                    out,
                    "FUNCTION_BLOCK FB 3\n{} w : {variable}; END_VAR\nBEGIN\n{}END_FUNCTION_BLOCK\nDATA_BLOCK DB 3\nFB 3\nBEGIN\nEND_DATA_BLOCK",
                    self.section.1,
                    call(target, "#w")
                );
                "CALL FB 3, DB 3 (w := DB13.a);\n".to_string()
            }
            ("local data", Block::MultiInstance) => "CALL FB 2, DB 2;\n".to_string(),
            (_, Block::MultiInstance) => "CALL FB 2, DB 2;\n".to_string(),
            _ => call(target, &actual),
        };
        let inside = self.place == "local data" && self.block == Block::MultiInstance;
        if !inside {
            main.push_str(&self.before(&actual));
        }
        main.push_str(&outer);
        if !inside {
            main.push_str(&self.after(&actual));
        }
        // All bytes of the result, and the words around it.
        for byte in 0..self.kind.bytes {
            if byte % 2 == 0 && byte + 1 < self.kind.bytes {
                _ = writeln!(main, "//@ assert DB11.DBW {0} == DB10.DBW {0}", 2 + byte);
            } else if byte % 2 == 0 {
                _ = writeln!(main, "//@ assert DB11.DBB {0} == DB10.DBB {0}", 2 + byte);
            }
        }
        for (leaf, _, literal) in self.kind.leaves {
            _ = writeln!(main, "//@ assert DB11.r{leaf} == {literal}");
        }
        main.push_str("//@ assert DB11.g == W#16#AAAA AND DB11.h == W#16#5555\n//@ assert DB13.g == W#16#AAAA AND DB13.h == W#16#5555\n");
        _ = writeln!(
            out,
            "ORGANIZATION_BLOCK OB 1\nVAR_TEMP info : ARRAY [1..20] OF BYTE; n : INT; b : BOOL; a : {variable}; c : BOOL; END_VAR\nBEGIN\n{main}END_ORGANIZATION_BLOCK"
        );
        out
    }

    /// The actual gets the sample, where it does not have it from its data block.
    fn before(&self, actual: &str) -> String {
        let given = matches!(self.section.0, Section::Input | Section::InOut);
        match self.place {
            "local data" | "memory" if given => self.copy(&self.sample(), &format!("{actual}{}", self.form.2)),
            _ => String::new(),
        }
    }

    /// The actual has the sample.
    fn after(&self, actual: &str) -> String {
        if !matches!(self.section.0, Section::Output | Section::InOut) {
            return String::new();
        }
        let mut out = String::from("\n");
        for (leaf, _, literal) in self.kind.leaves {
            let kind = match self.place {
                "memory" if self.kind.class == Number => format!(" as {}", self.kind.name),
                _ => String::new(),
            };
            _ = writeln!(out, "//@ assert {actual}{}{leaf}{kind} == {literal}", self.form.2);
        }
        out
    }
}

fn cases(cpu: &'static str) -> Vec<Case> {
    let mut cases = Vec::new();
    for block in [Block::Function, Block::Instance, Block::MultiInstance] {
        for section in SECTIONS {
            for form in FORMS {
                for kind in TYPES {
                    for using in USES {
                        for place in PLACES {
                            let plan = Plan { block, section, form, kind, using, place };
                            if plan.exists() {
                                cases.push(Case {
                                    kind: format!("{block:?} {:?} {}", section.0, form.0),
                                    ty: kind.name,
                                    using,
                                    variant: format!("{cpu}, {place}"),
                                    ending: "stl",
                                    cpu,
                                    source: Box::new(move || plan.source()),
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

/// Cases that STEP 7 also refuses.
const REFUSALS: &[Refusal] = &[];

#[test]
fn stl_brings_values_through() {
    let cases = ["s7-300", "s7-400"].into_iter().flat_map(cases).collect();
    campaign(cases, 97, REFUSALS);
}
