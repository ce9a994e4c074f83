//! Playing a scenario.

use plcc_abi::layout;

use super::helpers::{Block, cpu, run_observed};
use crate::scenario::{Player, Scenario};

const TEXT: &str = r#"
[[at]]
cycle = 0
set = { "M10.0" = 1 }
[[at]]
cycle = 2
set = { "I0.0" = 1, "PIW256" = "16#1234" }
event = "OB40"
expect = { "Q0.0" = 1, "MW2" = "16#0028", "MB10" = 2 }
[[at]]
time = "25ms"
set = { "I0.0" = false }
expect = { "Q0.0" = 0 }
[[at]]
cycle = 9
expect = { "Q0.0" = 0 }
"#;

#[test]
fn settings_events_and_expectations() {
    let ob1: Block = Box::new(|cpu, _| cpu.memory.set_byte(layout::Q, cpu.memory.byte(layout::I)));
    let ob40: Block = Box::new(|cpu, _| {
        assert_eq!(cpu.memory.byte(layout::I), 1, "the inputs of the cycle are there");
        assert_eq!(cpu.peripheral_read(256, 2), 0x1234);
        cpu.memory.set_word(layout::M + 2, 40);
    });
    let cpu = cpu(vec![(1, ob1), (40, ob40)]);
    let mut player = Player::new(Scenario::parse("s.toml", TEXT, &cpu.image).unwrap(), &cpu).unwrap();
    run_observed(&cpu, 5, &mut player);
    assert_eq!(player.expectations_met(), 3);
    let failures: Vec<_> = player.failures().into_iter().map(|f| (f.line, f.text, f.left)).collect();
    assert_eq!(
        failures,
        [
            (9, "MB10 = 16#02".to_string(), "16#01".to_string()),
            (16, "Q0.0 = 0".to_string(), "(not reached)".to_string()),
        ]
    );
}

#[test]
fn an_event_without_its_ob_is_told_with_its_line() {
    let play = |event: &str, blocks: Vec<(u16, Block)>| {
        let cpu = cpu(blocks);
        let text = format!("[[at]]\ncycle = 2\n{event}\n");
        let mut player = Player::new(Scenario::parse("s.toml", &text, &cpu.image).unwrap(), &cpu).unwrap();
        run_observed(&cpu, 5, &mut player);
        player.stopper()
    };
    assert_eq!(play("event = \"OB41\"", Vec::new()), "; s.toml:3 starts OB 41");
    assert_eq!(play("\nevent = { ob = \"OB82\" }", Vec::new()), "; s.toml:4 starts OB 82");
    let ob41: Block = Box::new(|_, _| {});
    assert_eq!(play("event = \"OB41\"", vec![(41, ob41)]), "");
}

#[test]
fn fields_of_start_information_are_named() {
    let cpu = cpu(Vec::new());
    let told = |field: &str| {
        let text = format!("[[at]]\ncycle = 1\nevent = {{ ob = \"OB40\", {field} = 3 }}\n");
        Scenario::parse("s.toml", &text, &cpu.image).err().unwrap()
    };
    let near = told("MDL_ADR");
    assert!(
        near.ends_with("the start information of OB 40 has no field `MDL_ADR`; did you mean `MDL_ADDR`?"),
        "{near}"
    );
    let all = told("foo");
    assert!(all.contains("has no field `foo`; it has ") && all.contains("MDL_ADDR, "), "{all}");
}

#[test]
fn addresses_outside_are_told_before_the_run() {
    let cpu = cpu(Vec::new());
    let scenario = Scenario::parse("s.toml", "[[at]]\ncycle = 1\nset = { \"MB9000\" = 1 }\n", &cpu.image).unwrap();
    let message = Player::new(scenario, &cpu).err().unwrap();
    assert_eq!(message, "s.toml:3: MB9000: byte 9000 is outside of the bit memory, which has 8192 bytes");
}

#[test]
fn a_tolerance_of_bits_needs_a_type() {
    let cpu = cpu(Vec::new());
    let told = |line: &str| {
        let scenario = Scenario::parse("s.toml", &format!("[[at]]\ncycle = 1\nexpect = {{ {line} }}\n"), &cpu.image);
        scenario.and_then(|scenario| Player::new(scenario, &cpu).map(|_| ())).unwrap_err()
    };
    for (line, message) in [
        ("\"MD20\" = \"0.45 +- 0.1\"", "MD20: a tolerance needs a type: write `\"MD20 as REAL\" = \"0.45 +- 0.1\"`"),
        ("\"MD20\" = \"50 +- 1\"", "MD20: a tolerance needs a type: write `\"MD20 as DINT\" = \"50 +- 1\"`"),
        (
            "\"MW20\" = \"50 +- 1\"",
            "MW20: a tolerance needs a type: write `\"MW20 as INT\" = \"50 +- 1\"`, or `\"50 +- 1 %\"` for an analog channel",
        ),
        ("\"Q0.0\" = \"1 +- 1\"", "Q0.0: a bit has no tolerance: write `true` or `false`"),
    ] {
        assert_eq!(told(line), format!("s.toml:3: {message}"));
    }
}

#[test]
fn sleep_in_one_block_and_wait_in_another() {
    let ob1: Block = Box::new(|cpu, _| {
        cpu.pass_time(1_000_000_000, false);
    });
    let ob35: Block = Box::new(|cpu, _| {
        cpu.pass_time(1_000_000, true);
    });
    let cpu = cpu(vec![(1, ob1), (35, ob35)]);
    let mut player = Player::new(Scenario::default(), &cpu).unwrap();
    run_observed(&cpu, 1, &mut player);
    assert!(!cpu.is_stopped());
    // The tenth OB 35 is due when the sleep ends and takes a millisecond; then the cycle time passes.
    assert_eq!(cpu.clock.now(), 1_011_000_000);
}
