//! Random networks: as a project they do the same in each cycle.

use std::fs;

use plcc_driver::command::convert::whole;
use plcc_driver::inputs;
use plcc_driver::pipeline::{self, Settings};

use super::same::sums_of_file;

/// Numbers from a seed.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % sides
    }

    fn bit(&mut self) -> String {
        format!("#b{}", self.roll(8))
    }

    fn number(&mut self) -> String {
        match self.roll(4) {
            0 => format!("{}", self.roll(50)),
            _ => format!("#n{}", self.roll(4)),
        }
    }
}

/// A rung of SIMATIC SD, with an edge bit or an instance of this number.
fn rung(dice: &mut Dice, ladder: bool, at: u64) -> String {
    let mut text = String::from("RUNG ");
    text.push_str(match (ladder, dice.roll(2)) {
        (true, _) => "wire#powerrail Contact( #b3 ) ",
        (false, 0) => "#b0 ",
        (false, _) => "#b5 ",
    });
    for _ in 0..=dice.roll(3) {
        let bit = dice.bit();
        text.push_str(&match (dice.roll(7), ladder) {
            (0 | 1, true) => format!("Contact( {bit} ) "),
            (2, true) => format!("I_Contact( {bit} ) "),
            (0, false) => format!("A( in2 := {bit} ) "),
            (1, false) => format!("O( in2 := {bit} ) "),
            (2, false) => format!("X( in2 := {bit} ) "),
            (3, _) => {
                let name = ["GE", "LT", "EQ", "NE"][dice.roll(4) as usize];
                let contact = if ladder { "_Contact" } else { "" };
                match ladder {
                    true => format!(
                        "{{ S7_Templates := \"SrcType := Int\" }} {name}{contact}( in1 := #n{}, in2 := {} ) ",
                        dice.roll(4),
                        dice.number()
                    ),
                    false => format!("A( in2 := {bit} ) "),
                }
            }
            (4, _) => format!("{}_Trig( #e{at} ) ", ["P", "N"][dice.roll(2) as usize]),
            (5, true) => format!("{}_Contact( operand := {bit}, bit := #e{at} ) ", ["P", "N"][dice.roll(2) as usize]),
            (_, true) => "Not() ".to_string(),
            (_, false) => format!("A( in2 := {bit} ) "),
        });
        if matches!(text.trim_end().rsplit(' ').nth(2), Some(word) if word.ends_with("_Trig(")) || text.contains("#e") {
            break;
        }
    }
    let bit = dice.bit();
    text.push_str(&match dice.roll(8) {
        0 => format!("S_Coil( {bit} ) "),
        1 => format!("R_Coil( {bit} ) "),
        2 => format!("SR( operand := {bit}, r1 := {} ) Coil( {} ) ", dice.bit(), dice.bit()),
        3 => format!("{{ S7_Templates := \"time_type := Time\" }} #t{at}.TON( pt := T#3ms, et => ) Coil( {bit} ) "),
        4 => format!("Move( in := {}, out1 => #n{} ) ", dice.number(), dice.roll(4)),
        5 => format!(
            "{{ S7_Templates := \"SrcType := Int\" }} Add( in1 := #n{}, in2 := {}, out => #n{} ) ",
            dice.roll(4),
            dice.number(),
            dice.roll(4)
        ),
        6 => format!(
            "{{ S7_Templates := \"SrcType := Int\" }} Sub( in1 := #n{}, in2 := 3, out => #n{} ) ",
            dice.roll(4),
            dice.roll(4)
        ),
        _ => format!("Coil( {bit} ) "),
    });
    text + "END_RUNG"
}

/// A function block of random rungs, and an OB that calls it many times and sums up what it has.
fn random_program(seed: u64) -> String {
    let mut dice = Dice(seed);
    let ladder = seed.is_multiple_of(2);
    let count = 2 + dice.roll(8);
    let language = if ladder { "LAD" } else { "FBD" };
    let mut text = String::from("{ S7_PreferredLanguage := \"LAD\" }\nFUNCTION_BLOCK Random\nVAR\n");
    for at in 0..8 {
        text.push_str(&format!("b{at} : Bool;\n"));
    }
    for at in 0..4 {
        text.push_str(&format!("n{at} : Int;\n"));
    }
    for at in 0..count {
        text.push_str(&format!("e{at} : Bool;\nt{at} : TON_TIME;\n"));
    }
    text.push_str("END_VAR\n");
    for at in 0..count {
        text.push_str(&format!(
            "{{ S7_Language := \"{language}\" }}\nNETWORK\n{}\nEND_NETWORK\n",
            rung(&mut dice, ladder, at)
        ));
    }
    text.push_str("END_FUNCTION_BLOCK\nDATA_BLOCK Random_DB : Random\nEND_DATA_BLOCK\n");
    text.push_str(
        "DATA_BLOCK Sum\nVAR\nseed : DInt := 1;\nsum : DInt;\nEND_VAR\nEND_DATA_BLOCK\nORGANIZATION_BLOCK Main\n",
    );
    text.push_str("{ S7_Language := \"SCL\" }\nNETWORK\n");
    text.push_str("\"Sum\".seed := (\"Sum\".seed * 75 + 74) MOD 65537;\n");
    for at in [0, 3, 5] {
        text.push_str(&format!("\"Random_DB\".b{at} := (\"Sum\".seed / {}) MOD 2 = 1;\n", 2 + at * 7));
    }
    text.push_str("\"Random_DB\".n1 := DINT_TO_INT(\"Sum\".seed MOD 50);\n\"Random_DB\"();\n");
    for at in 0..8 {
        text.push_str(&format!(
            "IF \"Random_DB\".b{at} THEN \"Sum\".sum := \"Sum\".sum * 3 MOD 100003 + {at}; END_IF;\n"
        ));
    }
    for at in 0..4 {
        text.push_str(&format!("\"Sum\".sum := (\"Sum\".sum + INT_TO_DINT(\"Random_DB\".n{at})) MOD 100003;\n"));
    }
    text + "END_NETWORK\nEND_ORGANIZATION_BLOCK\n"
}

/// `PLCC_RANDOM_PROJECTS=N` sets the number of programs.
#[test]
fn random_networks_as_projects_do_the_same() {
    let count = plcc_tests::random::setting("PLCC_RANDOM_PROJECTS", 60);
    let folder = tempfile::tempdir().expect("a folder");
    let (mut failed, mut compared) = (Vec::new(), 0);
    // One in which a flip-flop of FBD resets itself.
    for seed in (0..count).chain([103]) {
        let text = format!("//@ cpu s7-1200\n//@ test cycles=40\n{}", random_program(seed));
        let source = folder.path().join("a.s7dcl");
        fs::write(&source, &text).expect("a file");
        let settings = Settings { pragmas: true, ..Settings::default() };
        // Some rungs are not allowed.
        let Ok(before) = sums_of_file(source.clone(), "\"Sum\".sum", 40) else { continue };
        assert_eq!(before.len(), 40, "{seed}");
        let parsed = pipeline::parse(inputs::read(&[source]), &settings);
        let (written, messages) = whole::document(&parsed, None, "Random");
        if let Some(first) = messages.iter().find(|message| message.is_error()) {
            failed.push(format!("{seed}: {}\n{text}", first.title));
            continue;
        }
        let project = folder.path().join("a.xml");
        fs::write(&project, &written).expect("a file");
        match sums_of_file(project, "\"GlobalVariables\".Sum.sum", 40) {
            Ok(after) if after == before => compared += 1,
            Ok(after) => failed.push(format!("{seed}: {before:?} is {after:?}\n{text}")),
            Err(messages) => failed.push(format!("{seed}: {messages}\n{text}")),
        }
    }
    assert!(failed.is_empty(), "{} of {count}:\n{}", failed.len(), failed.join("\n\n"));
    assert!(compared * 2 > count, "only {compared}");
}
