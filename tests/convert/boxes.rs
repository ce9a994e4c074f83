//! Random boxes in STL and the networks that are drawn from them: both leave the same memory.

use std::fs;

use plcc_convert::to_graph;
use plcc_convert::to_stl::types::Types;
use plcc_convert::trivia::Trivia;
use plcc_driver::cli::Level;
use plcc_driver::inputs::TestInput;
use plcc_driver::testing::{self, Form, Variant};
use plcc_syntax::network::ast::Language;
use plcc_syntax::stl::Mnemonics;
use plcc_tests::{plan, random::Random};

use crate::{has_errors, parsed};

/// Blocks that the networks use: an FC whose BR says whether its result is good, one that leaves BR, and one with a REAL.
const AROUND: &str = "
FUNCTION FC 2 : INT
VAR_INPUT a : INT; END_VAR
VAR_OUTPUT b : INT; END_VAR
BEGIN
NETWORK
L #a; L 3; *I; T #b; AN OV; SAVE; CLR;
NETWORK
L #a; T #RET_VAL;
END_FUNCTION
FUNCTION FC 3 : VOID
VAR_INPUT a : INT; END_VAR
VAR_IN_OUT b : INT; END_VAR
BEGIN
NETWORK
L #a; T #b;
END_FUNCTION
FUNCTION_BLOCK FB 4
VAR_INPUT x : REAL; on : BOOL; END_VAR
VAR_OUTPUT y : REAL; both : BOOL; END_VAR
VAR sum : DINT; END_VAR
BEGIN
NETWORK
L #sum; L L#1000; +D; T #sum;
NETWORK
L #x; L 2.000000e+000; *R; T #y;
NETWORK
A #on; A I 0.4; = #both;
END_FUNCTION_BLOCK
DATA_BLOCK DB 4 FB 4
BEGIN
END_DATA_BLOCK
DATA_BLOCK DB 5
STRUCT i : INT; j : INT; d : DINT; r : REAL; w : WORD; END_STRUCT;
BEGIN
END_DATA_BLOCK
";

/// Bytes of memory that are compared.
const BYTES: u32 = 72;

struct Maker {
    random: Random,
    labels: u32,
}

impl Maker {
    fn one(&mut self, of: &[&str]) -> String {
        self.random.of(of).to_string()
    }

    fn flow(&mut self) -> String {
        let bit = |random: &mut Random| format!("I 0.{}", random.below(5));
        let random = &mut self.random;
        match random.below(4) {
            0 => format!("A {};\n", bit(random)),
            1 => format!("A {};\nAN {};\n", bit(random), bit(random)),
            2 => format!("A(;\nO {};\nO {};\n);\nA {};\n", bit(random), bit(random), bit(random)),
            _ => format!("O {};\nON {};\n", bit(random), bit(random)),
        }
    }

    fn value(&mut self, ty: &str) -> String {
        match ty {
            "I" => {
                self.one(&["MW 10", "MW 12", "IW 0", "DB5.DBW 0", "DB5.j", "0", "3", "-5", "32767", "-32768", "W#16#7"])
            }
            "D" => self.one(&["MD 20", "MD 24", "DB5.d", "L#-7", "L#70000", "0", "9", "-9", "DW#16#8000_0000", "T#5S"]),
            "R" => self.one(&["MD 28", "MD 32", "DB5.r", "2.500000e+000", "-1.000000e-003", "0.0", "7"]),
            "B" => self.one(&["MB 36", "MB 37", "IB 0", "B#16#F1", "200", "-1"]),
            _ => self.one(&["MW 10", "MW 38", "IW 0", "DB5.w", "W#16#F00F", "16#FF", "5", "-2", "B#16#88"]),
        }
    }

    fn target(&mut self, ty: &str) -> String {
        match ty {
            "I" => self.one(&["MW 10", "MW 12", "DB5.i", "DB5.DBW 2"]),
            "D" => self.one(&["MD 20", "MD 24", "DB5.d"]),
            "R" => self.one(&["MD 28", "MD 32", "DB5.r"]),
            "B" => self.one(&["MB 36", "MB 37"]),
            _ => self.one(&["MW 38", "DB5.w", "MW 40"]),
        }
    }

    /// What is between EN and ENO, and whether OV says that it is wrong.
    fn body(&mut self) -> (String, bool) {
        match self.random.below(7) {
            0 => {
                let ty = self.one(&["I", "D", "R"]);
                let op =
                    if ty == "D" { self.one(&["+", "-", "*", "/", "MOD"]) } else { self.one(&["+", "-", "*", "/"]) };
                let insn = if op == "MOD" { op } else { format!("{op}{ty}") };
                (format!("L {};\nL {};\n{insn};\nT {};\n", self.value(&ty), self.value(&ty), self.target(&ty)), true)
            }
            1 => {
                let insn = self.one(&["AW", "OW", "XOW"]);
                (format!("L {};\nL {};\n{insn};\nT {};\n", self.value("W"), self.value("W"), self.target("W")), false)
            }
            2 => {
                let (insn, from, to, checked) = match self.random.below(12) {
                    0 => ("NEGI", "I", "I", true),
                    1 => ("NEGD", "D", "D", true),
                    2 => ("NEGR", "R", "R", false),
                    3 => ("INVI", "W", "W", false),
                    4 => ("ABS", "R", "R", false),
                    5 => ("SQRT", "R", "R", true),
                    6 => ("ITD", "I", "D", false),
                    7 => ("DTR", "D", "R", false),
                    8 => ("ITB", "I", "W", true),
                    9 => ("RND", "R", "D", true),
                    10 => ("TRUNC", "R", "D", true),
                    _ => ("ITD;\nDTR", "I", "R", false),
                };
                (format!("L {};\n{insn};\nT {};\n", self.value(from), self.target(to)), checked)
            }
            3 => {
                let (insn, ty) = match self.random.below(4) {
                    0 => ("SLW", "W"),
                    1 => ("SRW", "W"),
                    2 => ("SSI", "I"),
                    _ => ("SSD", "D"),
                };
                let places = self.random.below(16);
                (format!("L {};\n{insn} {places};\nT {};\n", self.value(ty), self.target(ty)), false)
            }
            _ => {
                let from = self.one(&["I", "D", "R", "B", "W"]);
                let to = if self.random.below(3) == 0 { self.one(&["I", "D", "R", "B", "W"]) } else { from.clone() };
                let second =
                    if self.random.below(3) == 0 { format!("T {};\n", self.target(&to)) } else { String::new() };
                (format!("L {};\nT {};\n{second}", self.value(&from), self.target(&to)), false)
            }
        }
    }

    fn enabled(&mut self) -> String {
        let flow = self.flow();
        self.labels += 1;
        let label = format!("b{}", self.labels);
        let bit = self.random.below(8);
        let (body, checked) = self.body();
        let tail = if checked { "AN OV;\nSAVE;\nCLR;\n" } else { "SET;\nSAVE;\nCLR;\n" };
        match self.random.below(7) {
            0 => body,
            1 => format!("{flow}JCN {label};\n{body}{label}: NOP 0;\n"),
            2 if !checked => format!("{flow}JNB {label};\n{body}{label}: A BR;\n= Q 0.{bit};\n"),
            2 | 3 => format!("{flow}JNB {label};\n{body}{tail}{label}: A BR;\nA I 0.1;\n= Q 0.{bit};\n"),
            4 => {
                let (second, checked) = self.body();
                let second_tail = if checked { "AN OV;\nSAVE;\nCLR;\n" } else { "SET;\nSAVE;\nCLR;\n" };
                format!(
                    "{flow}JNB {label};\n{body}{tail}{label}: A BR;\nJNB {label}a;\n{second}{second_tail}{label}a: A BR;\n\
                     = Q 0.{bit};\n"
                )
            }
            5 => format!("{body}{tail}A BR;\n= Q 0.{bit};\n"),
            _ => format!("{flow}JNB {label};\n{body}{tail}{label}: NOP 0;\nA BR;\n= Q 0.{bit};\n"),
        }
    }

    fn called(&mut self) -> String {
        let (flow, bit) = (self.flow(), self.random.below(8));
        self.labels += 1;
        let label = format!("b{}", self.labels);
        let call = match self.random.below(3) {
            0 => {
                let a = self.one(&["MW 10", "IW 0", "DB5.j", "-5", "12000"]);
                format!("CALL FC 2 (a := {a}, b := {}, RET_VAL := MW 42);\n", self.target("I"))
            }
            1 => format!("CALL FC 3 (a := {}, b := {});\n", self.target("I"), self.target("I")),
            _ => {
                let x = self.one(&["MD 28", "DB5.r", "-2.500000e+000", "0.0"]);
                format!("CALL FB 4, DB 4 (x := {x}, on := I 0.2, y := {}, both := M 44.1);\n", self.target("R"))
            }
        };
        match self.random.below(3) {
            0 => call,
            1 => format!("{flow}JNB {label};\n{call}{label}: A BR;\n= Q 0.{bit};\n"),
            _ => format!("{flow}JNB {label};\n{call}{label}: NOP 0;\n"),
        }
    }

    fn cell(&mut self) -> String {
        let (start, reset, bit) = (self.flow(), self.flow(), self.random.below(8));
        self.labels += 1;
        let number = self.labels;
        let part =
            |maker: &mut Maker, text: String| if maker.random.below(3) == 0 { "NOP 0;\n".to_string() } else { text };
        let end = |cell: &str| format!("A {cell} {number};\n= Q 0.{bit};\n");
        match self.random.below(4) {
            0 => {
                let insn = self.one(&["SP", "SE", "SD", "SS", "SF"]);
                let time = self.one(&["S5T#1S", "MW 46", "S5T#20MS"]);
                let reset = part(self, format!("{reset}R T {number};\n"));
                let binary = part(self, format!("L T {number};\nT MW 48;\n"));
                let bcd = part(self, format!("LC T {number};\nT MW 50;\n"));
                let end = part(self, end("T"));
                format!("{start}L {time};\n{insn} T {number};\n{reset}{binary}{bcd}{end}")
            }
            1 => {
                let down = self.flow();
                let set = self.flow();
                let down = part(self, format!("{down}CD C {number};\n"));
                let set = part(self, format!("{set}L C#12;\nS C {number};\n"));
                let reset = part(self, format!("{reset}R C {number};\n"));
                let binary = part(self, format!("L C {number};\nT MW 52;\n"));
                let bcd = part(self, format!("LC C {number};\nT MW 54;\n"));
                let end = part(self, end("C"));
                format!("{start}CU C {number};\n{down}{set}{reset}{binary}{bcd}{end}")
            }
            2 => format!("{start}S M 56.{bit};\n{reset}R M 56.{bit};\nA M 56.{bit};\n= Q 0.{bit};\n"),
            _ => format!("{start}R M 57.{bit};\n{reset}S M 57.{bit};\nNOP 0;\n"),
        }
    }

    fn compared(&mut self) -> String {
        let ty = self.one(&["I", "D", "R"]);
        let sign = self.one(&["==", "<>", "<", ">", "<=", ">="]);
        let bit = self.random.below(8);
        let (left, right) = (self.value(&ty), self.value(&ty));
        format!("A(;\nL {left};\nL {right};\n{sign}{ty};\n);\nA I 0.{};\n= Q 0.{bit};\n", bit % 5)
    }

    fn network(&mut self) -> String {
        match self.random.below(10) {
            0..5 => self.enabled(),
            5 | 6 => self.cell(),
            7 | 8 => self.called(),
            _ => self.compared(),
        }
    }
}

fn source(networks: &[String]) -> String {
    let networks: Vec<String> = networks.iter().map(|network| format!("NETWORK\n{network}")).collect();
    format!("{AROUND}FUNCTION FC 1 : VOID\nBEGIN\n{}END_FUNCTION\n", networks.concat())
}

/// What every assertion shows after two calls for each value of the inputs.
fn memory(file: &str, text: &str) -> Result<Vec<String>, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let (block, main) = (folder.path().join(file), folder.path().join("main.stl"));
    fs::write(&block, text).expect("a file");
    let mut calls =
        String::from("L 12345;\nT MW 10;\nL L#-98765;\nT MD 20;\nL 1.500000e+000;\nT MD 28;\nL S5T#3S;\nT MW 46;\n");
    for inputs in 0..32 {
        calls.push_str(&format!("L {inputs};\nT IB 0;\nUC FC 1;\nUC FC 1;\n"));
        for at in (8..BYTES).step_by(4) {
            calls.push_str(&format!("//@ assert MD {at} == DW#16#5A5A_A5A5\n"));
        }
        calls.push_str("//@ assert QB 0 == 16#1F4\n//@ assert DB5.DBD 0 == DW#16#5A5A_A5A5\n");
        calls.push_str("//@ assert DB5.DBD 4 == DW#16#5A5A_A5A5\n//@ assert DB5.DBD 8 == DW#16#5A5A_A5A5\n");
    }
    let text = format!("//@ cpu 315-2DP\nORGANIZATION_BLOCK OB 1\nBEGIN\nNETWORK\n{calls}\nEND_ORGANIZATION_BLOCK\n");
    fs::write(&main, text).expect("a file");
    let variant = Variant { form: Form::Jit, optimization: Level::O0.into() };
    let outcomes = testing::run(&[TestInput::Program(vec![main, block])], &plan(vec![variant]));
    let lines = outcomes.iter().flat_map(|one| one.failures.lines());
    let shown: Vec<String> = lines
        .filter(|line| line.contains("FAILED") || line.trim_start().starts_with("left"))
        .map(str::to_string)
        .collect();
    match shown.is_empty() {
        true => Err(outcomes.iter().map(|one| format!("{}{}", one.messages, one.failures)).collect()),
        // Without the folder, which is another one each time.
        false => Ok(shown.iter().map(|line| line.rsplit("main.stl").next().unwrap_or(line).to_string()).collect()),
    }
}

/// Source: LAD/FBD reference F.1, F.3.
#[test]
fn random_boxes_keep_their_results() {
    let count = plcc_tests::random::setting("PLCC_RANDOM_BOXES", 6);
    let (mut drawn, mut refused) = (0, 0);
    for seed in 0..count {
        let mut maker = Maker { random: Random::new(seed), labels: 0 };
        for language in [Language::Lad, Language::Fbd] {
            let mut networks: Vec<String> = Vec::new();
            while networks.len() < 40 {
                let network = maker.network();
                let (unit, messages) = parsed(&source(std::slice::from_ref(&network)), Some(Mnemonics::En));
                assert!(!has_errors(&messages), "{messages:#?}\n{network}");
                let types = Types::new(std::iter::once(&unit), &[]);
                match has_errors(&to_graph::unit(&unit, &types, language).1) {
                    true => {
                        refused += 1;
                        assert!(refused < 1000 * (drawn + 40), "{network}");
                    }
                    false => networks.push(network),
                }
            }
            let check = |networks: &[String]| -> Result<(), String> {
                let text = source(networks);
                let (unit, _) = parsed(&text, Some(Mnemonics::En));
                let types = Types::new(std::iter::once(&unit), &[]);
                let (made, messages) = to_graph::unit(&unit, &types, language);
                let document = plcc_convert::sd::write(&made, Trivia::none(), None);
                if has_errors(&messages) || has_errors(&document.messages) {
                    return Err(format!("{messages:#?}{:#?}", document.messages));
                }
                let statements = memory("a.stl", &text).unwrap_or_else(|error| panic!("{error}\n{text}"));
                let networks =
                    memory("a.s7dcl", &document.text).map_err(|error| format!("{error}\n{}", document.text))?;
                match statements.iter().zip(&networks).find(|(one, other)| one != other) {
                    None if statements.len() == networks.len() => Ok(()),
                    first => Err(format!("{first:?}\n{}", document.text)),
                }
            };
            drawn += networks.len();
            if let Err(error) = check(&networks) {
                // The first network that is not the same by itself.
                let alone = networks
                    .iter()
                    .find_map(|one| check(std::slice::from_ref(one)).err().map(|error| format!("{one}\n{error}")));
                panic!("seed {seed}, {language:?}: {}", alone.unwrap_or(error));
            }
        }
    }
    println!("{drawn} networks drawn, {refused} refused");
    assert!(drawn > refused, "{drawn} networks drawn, {refused} refused");
}
