use plcc_diag::{FileId, SourceFile, SourceMap};

use super::*;
use crate::project;

/// The textbook's station.
const TANK: &str = r#"
[station]
cpu = "6ES7 315-2AF03-0AB0"
dp_address = 15
mpi_address = 2

[[station.module]]
slot = 1
order = "6ES7 307-1EA00-0AA0"

[[station.module]]
slot = 4
order = "6ES7 323-1BH00-0AA0"

[[station.module]]
slot = 5
order = "6ES7 331-7KB02-0AB0"
range = "4..20 mA"

[[station.module]]
slot = 6
order = "6ES7 332-5HB01-0AB0"
range = ["4..20 mA", ""]
substitute = 100
"#;

fn read(text: &str) -> (project::Project, Vec<(u32, String)>) {
    let source = SourceFile::new("plc.toml", text);
    let (project, diagnostics) = project::parse(FileId(0), &source);
    (project, diagnostics.into_iter().map(|d| (source.line(d.primary.span.start), d.title)).collect())
}

/// The first message, with its line.
fn message(text: &str) -> (u32, String) {
    read(text).1.into_iter().next().unwrap_or_default()
}

fn station(modules: &str) -> String {
    format!("[station]\ncpu = \"315-2DP\"\n{modules}")
}

fn module(keys: &str) -> String {
    format!("[[station.module]]\n{keys}\n")
}

#[test]
fn the_tank_has_the_addresses_of_the_textbook() {
    let (project, messages) = read(TANK);
    assert_eq!(messages, []);
    assert_eq!(project.cpu.map(|(name, _)| name).as_deref(), Some("315-2DP"));
    assert_eq!(project.config.cpu_order, "6ES7 315-2AF03-0AB0");
    let modules = project.config.modules.unwrap();
    let bytes: Vec<_> =
        modules.iter().map(|m| (m.input_start, m.input_bytes, m.output_start, m.output_bytes)).collect();
    assert_eq!(bytes[1..], [(0, 1, 0, 1), (272, 4, 272, 0), (288, 0, 288, 4)]);
    let output = modules[3].station.as_ref().unwrap();
    assert_eq!((output.analog_outputs[0].range.as_str(), output.analog_outputs[1].range.as_str()), ("4..20 mA", ""));
    assert_eq!((output.analog_outputs[0].bits, output.substitute), (12, 100));
}

#[test]
fn the_list_is_that_of_the_configuration_window() {
    let station = read(TANK).0.station.unwrap();
    let expected = "\
Rack  Slot  Module              Order number         I address  Q address  Comment
0     1     PS 307 5A           6ES7 307-1EA00-0AA0
0     2     CPU 315-2DP         6ES7 315-2AF03-0AB0                        MPI 2, DP 15
0     4     DI8/DO8xDC24V/0.5A  6ES7 323-1BH00-0AA0  0          0
0     5     AI2x12Bit           6ES7 331-7KB02-0AB0  272...275             4..20 mA
0     6     AO2x12Bit           6ES7 332-5HB01-0AB0             288...291  4..20 mA,
";
    assert_eq!(table(&station), expected);
}

#[test]
fn default_addresses_follow_rack_and_slot() {
    for (kind, rack, slot, start) in [
        (Kind::Di, 0, 11, 28),
        (Kind::Do, 1, 4, 32),
        (Kind::DiDo, 2, 11, 92),
        (Kind::Di, 3, 4, 96),
        (Kind::Ai, 0, 4, 256),
        (Kind::Ai, 0, 11, 368),
        (Kind::Ao, 1, 4, 384),
        (Kind::AiAo, 2, 11, 624),
        (Kind::Fm, 3, 11, 752),
    ] {
        assert_eq!(default_start(kind, rack, slot), start, "{kind:?} {rack} {slot}");
    }
}

#[test]
fn slots_hold_what_belongs_there() {
    let wrong = |slot: u8, order: &str| message(&station(&module(&format!("slot = {slot}\norder = \"{order}\""))));
    assert_eq!(wrong(3, "6ES7 321-1BL00-0AA0"), (4, "`DI32xDC24V` in rack 0, slot 3 is not allowed there".to_string()));
    assert!(wrong(1, "6ES7 321-1BL00-0AA0").1.contains("is not allowed there"));
    assert!(wrong(4, "6ES7 307-1EA00-0AA0").1.contains("is not allowed there"));
    assert!(wrong(12, "6ES7 321-1BL00-0AA0").1.contains("12 is not a slot from 1 to 11"));
    assert_eq!(wrong(1, "6ES7 307-1EA00-0AA0"), (0, String::new()));
    assert!(wrong(4, "6ES7 999").1.contains("plcc does not know the module"));
}

#[test]
fn errors_name_both_modules() {
    let two = |first: &str, second: &str| message(&station(&(module(first) + &module(second))));
    let (line, text) = two(
        "slot = 4\nkind = \"DI\"\nchannels = 8\nname = \"A\"",
        "slot = 4\nkind = \"DO\"\nchannels = 8\nname = \"B\"",
    );
    assert_eq!((line, text.as_str()), (9, "`A` and `B` are both in rack 0, slot 4"));
    let (line, text) = two(
        "slot = 4\nkind = \"DI\"\nchannels = 32\nname = \"A\"",
        "slot = 5\nkind = \"DI\"\nchannels = 8\ninputs = 3\nname = \"B\"",
    );
    assert_eq!((line, text.as_str()), (9, "`A` in rack 0, slot 4 and `B` in rack 0, slot 5 both have input byte 3"));
}

#[test]
fn racks_need_interface_modules() {
    let input = |rack: u8| module(&format!("rack = {rack}\nslot = 4\nkind = \"DI\"\nchannels = 8"));
    let interface = |rack: u8, kind: &str| module(&format!("rack = {rack}\nslot = 3\nkind = \"{kind}\""));
    assert!(message(&station(&input(1))).1.contains("rack 1 is not connected"));
    assert_eq!(message(&station(&(interface(0, "IM 360") + &interface(2, "IM 361") + &input(2)))).1, "");
    assert_eq!(message(&station(&(interface(0, "IM 365") + &interface(1, "IM 365") + &input(1)))).1, "");
    assert!(
        message(&station(&(interface(0, "IM 365") + &interface(2, "IM 365") + &input(2))))
            .1
            .contains("connects only racks 0 and 1")
    );
    let cp = module("rack = 1\nslot = 5\nkind = \"CP\"");
    assert!(
        message(&station(&(interface(0, "IM 365") + &interface(1, "IM 365") + &cp))).1.contains("no communication bus")
    );
}

#[test]
fn cpus_have_limits() {
    let with = |cpu: &str, keys: &str| message(&format!("[station]\ncpu = \"{cpu}\"\n{}", module(keys))).1;
    assert!(with("313", "slot = 4\nkind = \"DI\"\nchannels = 8\ninputs = 10").contains("fixes the addresses"));
    assert!(with("313", "rack = 1\nslot = 4\nkind = \"DI\"\nchannels = 8").contains("has rack 0 only"));
    assert!(
        with("315-2DP", "slot = 4\nkind = \"AI\"\nchannels = 8\ninputs = 1020").contains("has addresses up to 1023")
    );
    assert!(with("315-2DP", "slot = 4\nkind = \"AI\"\nchannels = 2\ninputs = 271").contains("odd address"));
    assert!(with("315-2DP", "slot = 4\nkind = \"AI\"\nchannels = 2\noutputs = 272").contains("has no outputs"));
    assert!(with("314IFM", "rack = 3\nslot = 11\nkind = \"DI\"\nchannels = 8").contains("stays empty"));
    assert!(with("414-2", "slot = 4\nkind = \"DI\"\nchannels = 8").contains("has no S7-300 racks"));
    let (project, messages) = read("[station]\ncpu = \"314 IFM\"\n");
    assert_eq!(messages, []);
    let modules = project.config.modules.unwrap();
    assert_eq!((modules[0].input_start, modules[0].input_bytes, modules[0].output_bytes), (124, 3, 2));
    assert_eq!((modules[1].input_start, modules[1].input_bytes, modules[1].output_bytes), (128, 8, 2));
    assert!(message("cpu = \"313\"\n[station]\ncpu = \"314\"\n").1.contains("two CPUs"));
    assert!(message(&module("slot = 4\nkind = \"DI\"\nchannels = 8")).1.contains("has no CPU"));
}

#[test]
fn kinds_ranges_and_channels_are_checked() {
    let wrong = |keys: &str| message(&station(&module(keys))).1;
    assert!(wrong("slot = 4").contains("needs `order`"));
    assert!(wrong("slot = 4\nkind = \"XY\"").contains("not a kind of module"));
    assert!(wrong("slot = 4\nkind = \"DI\"").contains("needs its number of channels"));
    assert!(wrong("slot = 4\nkind = \"AI/AO\"\nchannels = 4").contains("channels in each direction"));
    assert!(wrong("slot = 4\nkind = \"AI\"\nchannels = 2\nrange = \"4-20\"").contains("`4-20` is not a range"));
    assert!(
        wrong("slot = 4\nkind = \"AI\"\nchannels = 2\nrange = [\"+-10 V\"]").contains("1 ranges for a module with 2")
    );
    assert!(wrong("slot = 4\nkind = \"AI\"\nchannels = 2\nspeed = 1").contains("`speed` is not a key here"));
}

/// Messages about a program with the tank's station: code, line and title.
fn uses(text: &str) -> Vec<(&'static str, u32, String)> {
    uses_in("main.stl", text)
}

fn uses_in(name: &str, text: &str) -> Vec<(&'static str, u32, String)> {
    let mut read = crate::inputs::Read::default();
    let source = SourceFile::new("plc.toml", TANK);
    let file = read.sources.add(source.clone());
    read.project = Some(project::parse(file, &source).0);
    let unit = read.sources.add(SourceFile::new(name, text));
    read.units.push(unit);
    let bound = crate::pipeline::front(read, &crate::pipeline::Settings::default());
    let line = |sources: &SourceMap, span: Span| sources.file(span.file).line(span.start);
    bound.diagnostics.iter().map(|d| (d.code.name(), line(&bound.sources, d.primary.span), d.title.clone())).collect()
}

#[test]
fn uses_without_module_are_told_once_for_each_range() {
    assert_eq!(uses("      A     I 0.7\n      =     Q 0.0\n      L     PIW 274\n      T     PQW 290\n"), []);
    let messages =
        uses("      L     IW 0\n      A     I 2.0\n      A     I 2.1\n      =     Q 8.0\n      L     PIW 500\n");
    let expected = [
        ("P0605", 1, "no module of the station has IB 1 to IB 2"),
        ("P0605", 4, "no module of the station has QB 8"),
        ("P0605", 5, "no module of the station has PIB 500 to PIB 501"),
    ];
    assert_eq!(messages, expected.map(|(code, line, text)| (code, line, text.to_string())));
}

#[test]
fn the_first_use_in_scl_is_the_first_one_in_the_source() {
    let text = "FUNCTION FC1 : VOID
BEGIN
IF I0.0 THEN
    Q0.0 := I60.0;
ELSIF I60.0 THEN
    Q0.0 := FALSE;
END_IF;
END_FUNCTION
";
    let expected = [("P0605", 4, "no module of the station has IB 60")];
    let messages = uses_in("main.scl", text);
    assert_eq!(messages.iter().map(|(code, line, title)| (*code, *line, title.as_str())).collect::<Vec<_>>(), expected);
}

#[test]
fn wrong_direction_and_width_are_errors() {
    let messages = uses("      L     1\n      T     PQW 272\n      L     PIW 290\n      L     PID 274\n");
    let expected = [
        ("P0606", 2, "PQW 272 writes the module `AI2x12Bit`, which has only inputs there"),
        ("P0606", 3, "PIW 290 reads the module `AO2x12Bit`, which has only outputs there"),
        ("P0606", 4, "PID 274 is wider than the module `AI2x12Bit`, which ends before byte 276"),
    ];
    assert_eq!(messages, expected.map(|(code, line, text)| (code, line, text.to_string())));
}
