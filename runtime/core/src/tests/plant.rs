//! Plants, engineering values and modules of a station.

use plcc_abi::image::{AnalogChannel, Module, StationModule};
use plcc_abi::layout;

use super::helpers::{Block, cpu_with, run, run_observed};
use crate::address;
use crate::cpu::Cpu;
use crate::scenario::{Player, Scenario};

/// A station: AI2 from 272 in slot 5, AO2 from 288 in slot 6 with substitute 100, DO8 at 0 in slot 4 with substitute 5; 4 to 20 mA.
fn station() -> Vec<Module> {
    let channel = AnalogChannel { range: "4..20 mA".to_string(), bits: 12, wire_break: false };
    let module = |name: &str, slot: u8, input: (u32, u32), output: (u32, u32), station: StationModule| Module {
        name: name.to_string(),
        input_start: input.0,
        input_bytes: input.1,
        output_start: output.0,
        output_bytes: output.1,
        station: Some(StationModule { slot, ..station }),
    };
    let inputs = StationModule { analog_inputs: vec![channel.clone(); 2], ..StationModule::default() };
    let outputs = StationModule { analog_outputs: vec![channel; 2], substitute: 100, ..StationModule::default() };
    let bits = StationModule { substitute: 5, ..StationModule::default() };
    vec![
        module("AO2", 6, (0, 0), (288, 4), outputs),
        module("AI2", 5, (272, 4), (0, 0), inputs),
        module("DI8/DO8", 4, (0, 1), (0, 1), bits),
    ]
}

fn with_station(blocks: Vec<(u16, Block)>) -> std::rc::Rc<Cpu> {
    cpu_with(blocks, |image| image.config.modules = Some(station()))
}

fn play(cpu: &Cpu, text: &str, cycles: u64) -> Player {
    let mut player = Player::new(Scenario::parse("s.toml", text, &cpu.image).unwrap(), cpu).unwrap();
    run_observed(cpu, cycles, &mut player);
    player
}

fn failures(player: &Player) -> Vec<(u32, String, String)> {
    player.failures().into_iter().map(|f| (f.line, f.text, f.left)).collect()
}

/// OB 1: PQW 288 := PIW 272.
fn through() -> Vec<(u16, Block)> {
    vec![(1, Box::new(|cpu: &Cpu, _| assert!(!cpu.peripheral_write(288, 2, cpu.peripheral_read(272, 2) as u32))))]
}

#[test]
fn engineering_values() {
    let text = "[[at]]\ncycle = 1\nset = { \"AI0\" = \"12 mA\", \"PIW274\" = \"25 %\" }\n\
        expect = { \"PIW272\" = 13824, \"AO0\" = \"12 mA\", \"PIW274\" = 6912, \"AI1 in mA\" = 8 }\n\
        [[at]]\ncycle = 2\nset = { \"AI0\" = \"1 mA\" }\nexpect = { \"PIW272\" = \"16#8000\", \"AO0 in mA\" = 0.0 }\n\
        [[at]]\ncycle = 3\nset = { \"AI0\" = \"50.1 %\" }\nexpect = { \"AO0\" = \"50 +- 0.2 %\", \"AO0 in %\" = \"40 +- 1\" }\n";
    let player = play(&with_station(through()), text, 3);
    // 50.1 % is 13852, in steps of 8 13848, which is 50.0868 %.
    assert_eq!(failures(&player), [(12, "AO0 in % = 40 +- 1".to_string(), "50.0868".to_string())]);
    assert_eq!(player.expectations_met(), 7);
}

#[test]
fn engineering_values_need_a_channel() {
    let cpu = with_station(Vec::new());
    let message = |line: &str| {
        let scenario = Scenario::parse("s.toml", &format!("[[at]]\ncycle = 1\n{line}\n"), &cpu.image);
        scenario.and_then(|scenario| Player::new(scenario, &cpu).map(|_| ())).unwrap_err()
    };
    assert!(
        message("set = { \"PIW300\" = \"12 mA\" }").starts_with("s.toml:3: PIW300: a unit needs an analog channel")
    );
    assert!(message("set = { \"AI0\" = \"12 V\" }").contains("write a number in mA or in %"));
    assert!(
        message("set = { \"MW0\" = \"2;3\" }").contains("MW0: `;3` would be a unit, which only an analog channel has")
    );
    let missing = message("set = { \"AI2\" = 1 }");
    assert!(missing.contains("`AI2` is neither an address"), "{missing}");
    assert!(missing.contains("; the station has the analog inputs AI0 to AI1"), "{missing}");
    assert!(message("set = { \"I5.0\" = 1 }").starts_with("s.toml:3: I5.0: no module of the station has these"));
    assert!(message("expect = { \"MW0 as REAL\" = 1.0 }").contains("`MW0` has 16 bits, but REAL has 32"));
    assert!(message("expect = { \"plant.level\" = 1.0 }").contains("there is no plant"));
    let longest = message("set = { \"T1.VALUE\" = \"10000s\" }");
    assert!(
        longest.contains("`10000s` does not fit into S5TIME, which goes from S5T#0ms to S5T#2h46m30s"),
        "{longest}"
    );
}

const TANK: &str = "[plant]\nstep = \"20ms\"\nequations = [\n  \"level = level + if(pump, 1, -drain) * dt\",\n]\n\
    [plant.parameters]\ndrain = 0.5\n[plant.state]\nlevel = 10.0\n[plant.read]\npump = \"Q0.0\"\n\
    [plant.write]\n\"AI0 in %\" = \"level\"\n\"I0.1\" = \"level > 10.05\"\n";

#[test]
fn a_plant_closes_the_loop() {
    // OB 1: the pump runs from cycle 3 on.
    let ob1: Block = Box::new(|cpu: &Cpu, _| {
        let count = cpu.memory.byte(layout::M) + 1;
        cpu.memory.set_byte(layout::M, count);
        cpu.memory.set_byte(layout::Q, u8::from(count >= 3));
    });
    let cpu = with_station(vec![(1, ob1)]);
    // Steps at 20 ms (cycle 3, pump 0), 40 ms (cycle 5, pump 1), 60, 80 and 100 ms.
    let text = format!(
        "{TANK}[[at]]\ncycle = 0\nexpect = {{ \"plant.level\" = 10.0 }}\n[[at]]\ncycle = 3\nexpect = {{ \"plant.level\" = 9.99 }}\n\
         [[at]]\ncycle = 5\nexpect = {{ \"plant.level\" = 10.0, \"I0.1\" = 0 }}\nplant = {{ level = 10.0 }}\n\
         [[at]]\ncycle = 11\nexpect = {{ \"plant.level\" = \"10.06 +- 0.0001\", \"I0.1\" = 1, \"AI0\" = \"10.06 %\" }}\n"
    );
    let player = play(&cpu, &text, 11);
    assert_eq!(failures(&player), []);
    assert_eq!(player.expectations_met(), 7);
}

#[test]
fn parameters_of_a_plant_are_disturbances() {
    let cpu = with_station(Vec::new());
    let text = format!(
        "{TANK}[[at]]\ncycle = 1\nplant = {{ drain = 2.0 }}\n[[at]]\ncycle = 3\nexpect = {{ \"plant.level\" = 9.96 }}\n"
    );
    assert_eq!(failures(&play(&cpu, &text, 3)), []);
}

#[test]
fn a_plant_without_a_value_stands_still() {
    let cpu = with_station(Vec::new());
    let text = "[plant]\nequations = [\"x = 1 / (t - 0.02)\"]\n[[at]]\ncycle = 9\n";
    let player = play(&cpu, text, 9);
    let expected =
        (2, "a value of the plant for x".to_string(), "the result of the expression is inf at 0.02 s".to_string());
    assert_eq!(failures(&player), [expected]);
    let slow = play(&with_station(Vec::new()), "[plant]\nstep = \"1ms\"\n[[at]]\ncycle = 2\n", 2);
    assert_eq!(failures(&slow), []);
}

#[test]
fn what_is_wrong_in_a_plant_has_its_line() {
    let cpu = with_station(Vec::new());
    for (text, expected) in [
        ("[plant]\nstep = \"0\"\n", "s.toml:2: the step of a plant must be at least 1ms"),
        ("[plant]\nequations = [\n  \"x = y\",\n]\n", "s.toml:3: `y` is not known here"),
        ("[plant]\nequations = [\"x\"]\n", "s.toml:2: `x`: write `name = expression`"),
        ("[plant]\nequations = [\"x := 1\"]\n", "s.toml:2: `x := 1`: an equation has one `=`; write `x = 1`"),
        ("[plant]\nequations = [\"x == 1\"]\n", "s.toml:2: `x == 1`: an equation has one `=`; write `x = 1`"),
        (
            "[plant]\nequations = [\"x = 1; y = 2\"]\n",
            "s.toml:2: `x = 1; y = 2`: each equation is a text; write \"x = 1\", \"y = 2\"",
        ),
        ("[plant]\nequations = [\"x = 1\", \"x = 2\"]\n", "s.toml:2: `x` already has a value"),
        ("[plant]\nequations = [\"x = (1\"]\n", "s.toml:2: `(1` ends too early"),
        ("[plant.state]\nmin = 1\n", "s.toml:2: `min` cannot be the name"),
        ("[plant.state]\na = 1\n[plant.parameters]\na = 1\n", "s.toml:2: the plant has two values `a`"),
        ("[plant.read]\na = \"I0.0\"\n", "s.toml:2: `I0.0` is not an output"),
        ("[plant.read]\n\"Q0.0\" = \"a\"\n", "s.toml:2: the name of the value is on the left; write `a = \"Q0.0\"`"),
        (
            "[plant.state]\na = 1\n[plant.write]\na = \"I0.0\"\n",
            "s.toml:4: the input is on the left; write `\"I0.0\" = \"a\"`",
        ),
        (
            "[plant.state]\nlevel = 1\n[[at]]\ncycle = 1\nexpect = { \"plant.levl\" = 1 }\n",
            "s.toml:5: plant.levl: the plant has no value `levl`; did you mean `level`?",
        ),
        (
            "[plant.equations]\nb = \"1 + 2\"\n",
            "s.toml:1: `equations` is a list of texts, not a heading; write `equations = [\"b = 1 + 2\"]` below `[plant]`",
        ),
        ("[[plant.equations]]\nb = \"1 + 2\"\n", "s.toml:1: `equations` is a list of texts, not a heading"),
        ("[plant.write]\n\"Q0.0\" = \"1\"\n", "s.toml:2: `Q0.0` is not an input"),
        ("[plant.write]\n\"AI0 in V\" = \"1\"\n", "s.toml:2: the channel has the range 4..20 mA"),
        ("[plant]\nspeed = 1\n", "s.toml:2: `speed` is not a key here"),
        ("[plant.state]\na = \"x\"\n", "s.toml:2: "),
        (
            "[plant.state]\na = 1\n[[at]]\ncycle = 1\nplant = { b = 1 }\n",
            "s.toml:5: `b` is neither a parameter nor a state",
        ),
        ("[[at]]\ncycle = 1\nplant = { b = 1 }\n", "s.toml:3: there is no plant; a scenario defines one in `[plant]`"),
    ] {
        let message = Scenario::parse("s.toml", text, &cpu.image).unwrap_err();
        assert!(message.starts_with(expected), "{text}: {message}");
    }
}

#[test]
fn outputs_in_stop() {
    let ob1: Block = Box::new(|cpu: &Cpu, _| {
        cpu.peripheral_write(288, 4, 0x1234_5678);
        cpu.peripheral_write(0, 1, 0xFF);
        if cpu.memory.byte(layout::M) == 1 {
            cpu.stop_by(plcc_abi::codes::stop::SFC_46, 0, 0);
        }
        cpu.memory.set_byte(layout::M, 1);
    });
    let cpu = with_station(vec![(1, ob1)]);
    let read = |text: &str| cpu.read(&address::parse(text).unwrap());
    run(&cpu, 1);
    assert_eq!((read("PQD288"), read("PQB0")), (0x1234_5678, 0xFF));
    run(&cpu, 1);
    assert_eq!((read("PQD288"), read("PQB0")), (0x0064_0064, 5));
}

/// Where the tests put parameters.
const AT: u32 = layout::SCRATCH;

/// Calls a system function with these bytes of parameters; returns the bytes after it.
fn call(cpu: &Cpu, number: u32, parameters: &[u8]) -> [u8; 32] {
    let mut bytes = [0; 32];
    bytes[..parameters.len()].copy_from_slice(parameters);
    cpu.memory.set_bytes(AT, bytes);
    cpu.system_function(0, number, AT, layout::SCRATCH);
    cpu.memory.bytes(AT)
}

#[test]
fn slots_and_addresses() {
    let cpu = with_station(Vec::new());
    // SUBNETID, RACK, SLOT, SUBSLOT, SUBADDR; RET_VAL, IOID, LADDR.
    let gadr = |slot: u8, offset: u8| call(&cpu, 5, &[0, 0, 0, 0, 0, slot, 0, 0, 0, offset]);
    assert_eq!(gadr(5, 2)[10..16], [0, 0, 0x54, 0, 1, 18], "PI 274");
    assert_eq!(gadr(6, 0)[10..16], [0, 0, 0x55, 0, 1, 32], "PQ 288");
    assert_eq!(gadr(7, 0)[10..12], [0x80, 0x99]);
    assert_eq!(gadr(12, 0)[10..12], [0x80, 0x96]);
    assert_eq!(gadr(5, 4)[10..12], [0x80, 0x9A]);
    // IOID, LADDR; RET_VAL, AREA, RACK, SLOT, SUBADDR.
    assert_eq!(call(&cpu, 49, &[0x54, 0, 1, 18])[4..14], [0, 0, 1, 0, 0, 0, 0, 5, 0, 2]);
    assert_eq!(call(&cpu, 49, &[0x55, 0, 1, 18])[4..6], [0x80, 0x90]);
    // MASTER, STATION, SLOT, SUBSLOT; RET_VAL, LADDR.
    assert_eq!(call(&cpu, 70, &[0, 0, 0, 0, 0, 6, 0, 0])[8..12], [0, 0, 0x81, 0x20]);
    // LADDR; RET_VAL, AREA, MASTER, STATION, SLOT, SUBSLOT, OFFSET.
    assert_eq!(call(&cpu, 71, &[0x81, 0x22])[2..16], [0, 0, 0, 1, 0, 0, 0, 0, 0, 6, 0, 0, 0, 2]);
    assert_eq!(call(&cpu, 71, &[0x01, 0x20])[2..4], [0x80, 0x90]);
}

#[test]
fn all_addresses_of_a_module() {
    let cpu = with_station(Vec::new());
    // IOID, LADDR; RET_VAL, PEADDR (ANY), PECOUNT, PAADDR (ANY), PACOUNT.
    let mut parameters = vec![0x54, 0, 1, 16, 0, 0];
    parameters.extend([0x10, 4, 0, 4, 0, 0, 0x83, 0, 0, 0]);
    parameters.extend([0; 2]);
    parameters.extend([0x10, 4, 0, 1, 0, 0, 0x83, 0, 1, 0]);
    let result = call(&cpu, 50, &parameters);
    assert_eq!((&result[4..6], &result[16..18], &result[28..30]), (&[0, 0][..], &[0, 4][..], &[0, 0][..]));
    assert_eq!(cpu.memory.bytes::<8>(layout::M), [1, 16, 1, 17, 1, 18, 1, 19]);
}

#[test]
fn the_system_status_list() {
    let cpu = with_station(Vec::new());
    // REQ, SZL_ID, INDEX; RET_VAL, BUSY, SZL_HEADER, DR (ANY) at M 0.
    let read = |id: u16, index: u8, bytes: u8| {
        let mut parameters = vec![1, 0, (id >> 8) as u8, id as u8, 0, index, 0, 0, 0, 0, 0, 0, 0, 0];
        parameters.extend([0x10, 2, 0, bytes, 0, 0, 0x83, 0, 0, 0]);
        let result = call(&cpu, 51, &parameters);
        (u16::from_be_bytes([result[6], result[7]]), [result[10], result[11], result[12], result[13]])
    };
    assert_eq!(read(0x0111, 1, 28), (0, [0, 28, 0, 1]));
    assert_eq!(&cpu.memory.bytes::<10>(layout::M), b"\0\x01s7-300  ");
    assert_eq!(read(0x0111, 9, 28), (0x8083, [0; 4]));
    assert_eq!(read(0x0F99, 0, 28), (0x8082, [0; 4]));
    assert_eq!(read(0x0091, 0, 48), (0, [0, 16, 0, 3]));
    assert_eq!(read(0x0091, 0, 40), (0x8081, [0, 16, 0, 2]), "as many records as fit");
    assert_eq!(cpu.memory.bytes::<6>(layout::M), [0, 0, 6, 0, 1, 32], "rack 0, slot 6, address 288");
    assert_eq!(read(0x0114, 3, 8), (0, [0, 8, 0, 1]));
    assert_eq!(
        cpu.memory.bytes::<8>(layout::M),
        [0, 3, 0, 1, 0x20, 0, 0, 16],
        "8192 bytes of bit memory, 16 of them retentive"
    );
}
