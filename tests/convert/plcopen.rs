//! PLCopen XML that is written: it does what the sources do.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use plcc_driver::cli::Level;
use plcc_driver::command::convert::whole;
use plcc_driver::inputs::{self, TestInput};
use plcc_driver::pipeline::{self, Parsed, Settings};
use plcc_driver::testing::{self, Form, Outcome, Variant};
use plcc_syntax::ast::{Block, BlockName, Code, CodeBlock, CodeKind, Header};
use plcc_syntax::network::ast::{Body as Networks, Content, Network};
use plcc_syntax::scl::ast::{Body, Dialect, Expr, ExprKind, Name, NameForm, Statement, StatementKind};
use plcc_tests::{plan, projects, root, tests_folder};

use crate::{everything, has_errors, sources};

/// Splits blocks of LAD or FBD with statements between their networks: each network becomes a function, which statements call.
fn split(parsed: &mut Parsed) {
    for (_, unit) in &mut parsed.units {
        let mut functions = Vec::new();
        for block in &mut unit.blocks {
            let Block::Code(code) = block else { continue };
            let Code::Graphic(body) = &code.code else { continue };
            let is_text = |network: &Network| matches!(network.content, Content::Scl(_));
            if !body.networks.iter().any(is_text) || body.networks.iter().all(is_text) {
                continue;
            }
            let mut statements = Vec::new();
            for network in &body.networks {
                let span = network.span;
                if let Content::Scl(list) = &network.content {
                    statements.extend(list.iter().cloned());
                    continue;
                }
                let text = format!("Network_{}", functions.len() + 1);
                let callee = Name { text: text.clone(), form: NameForm::Quoted, span };
                let callee = Box::new(Expr { kind: ExprKind::Name(callee), span });
                let call = Expr { kind: ExprKind::Call { callee, arguments: Vec::new() }, span };
                statements.push(Statement { kind: StatementKind::Expression(call), span });
                let body = Networks { networks: vec![network.clone()] };
                functions.push(Block::Code(CodeBlock {
                    kind: CodeKind::Fc,
                    name: BlockName::Symbol { name: text, span },
                    return_type: None,
                    header: Header::default(),
                    sections: Vec::new(),
                    constants: Vec::new(),
                    code: Code::Graphic(body),
                    span,
                }));
            }
            code.code = Code::Scl(Body { dialect: Dialect::Tia, labels: Vec::new(), statements });
        }
        unit.blocks.splice(0..0, functions);
    }
}

/// The temporary data of an OB in SIMATIC SD as a data block, for its networks become functions.
fn with_global_temps(text: &str) -> String {
    let Some(start) = text.find("ORGANIZATION_BLOCK").filter(|_| text.contains("NETWORK")) else {
        return text.to_string();
    };
    let Some(begin) = text[start..].find("VAR_TEMP").map(|at| start + at) else { return text.to_string() };
    let Some(end) = text[begin..].find("END_VAR").map(|at| begin + at) else { return text.to_string() };
    let declared = &text[begin + "VAR_TEMP".len()..end];
    let mut rest = format!("{}{}", &text[..begin], &text[end + "END_VAR".len()..]);
    for name in declared.lines().filter_map(|line| line.split_once(':')).map(|(names, _)| names) {
        for name in name.split(',').map(str::trim).filter(|name| !name.is_empty()) {
            rest = rest.replace(&format!("#{name}"), &format!("\"Temporary\".{name}"));
        }
    }
    format!("{rest}\nDATA_BLOCK \"Temporary\"\n    VAR\n{declared}    END_VAR\nEND_DATA_BLOCK\n")
}

/// A source as a project: `None` if it has errors of its own, or what PLCopen XML cannot say; otherwise what its assertions say.
fn as_project(path: &Path, refused: &mut BTreeMap<String, usize>) -> Option<Result<(), String>> {
    plcc_tests::bind_file(path, &Settings::default()).ok()?;
    let settings = Settings { pragmas: true, ..Settings::default() };
    let folder = tempfile::tempdir().expect("a folder");
    let text = fs::read_to_string(path).ok().filter(|text| text.contains("//@ assert"))?;
    let source = folder.path().join(path.file_name()?);
    fs::write(&source, with_global_temps(&text)).expect("a file");
    let mut parsed = pipeline::parse(inputs::read(&[source]), &settings);
    if has_errors(&parsed.diagnostics) {
        *refused.entry("(cannot be split)".to_string()).or_default() += 1;
        return None;
    }
    let is_main = |block: &Block| matches!(block, Block::Code(block) if block.kind == CodeKind::Ob);
    if !parsed.units.iter().flat_map(|(_, unit)| &unit.blocks).any(is_main) {
        return None;
    }
    split(&mut parsed);
    let (written, messages) = whole::document(&parsed, "Test");
    if let Some(first) = messages.iter().find(|message| message.is_error()) {
        *refused.entry(first.title.clone()).or_default() += 1;
        return None;
    }
    let file = folder.path().join("a.xml");
    fs::write(&file, &written).expect("a file");
    Some(passes(TestInput::File(file)))
}

/// Runs the tests of an input.
fn outcomes(input: TestInput) -> Vec<Outcome> {
    testing::run(&[input], &plan(vec![Variant { form: Form::Jit, optimization: Level::O0.into() }]))
}

/// Whether all assertions hold; otherwise the messages.
fn passes(input: TestInput) -> Result<(), String> {
    let outcomes = outcomes(input);
    let failed = outcomes.iter().find(|one| one.failed > 0 || one.rejected || one.unreadable || one.passed == 0);
    failed.map_or(Ok(()), |one| Err(format!("{}{}", one.messages, one.failures)))
}

#[test]
fn sources_as_projects_pass_their_assertions() {
    let (mut count, mut failed, mut refused) = (0, Vec::new(), BTreeMap::new());
    for path in ["s7dcl", "scl", "xml"].iter().flat_map(|extension| sources(extension)) {
        match as_project(&path, &mut refused) {
            None => {}
            Some(Ok(())) => count += 1,
            Some(Err(text)) => failed.push(format!("{}: {text}", path.display())),
        }
    }
    println!("{count} sources; refused: {refused:#?}");
    assert!(failed.is_empty(), "{} of {}:\n{}", failed.len(), count + failed.len(), failed.join("\n\n"));
    assert!(count > 28, "only {count} sources; {refused:#?}");
}

/// A project with its scenarios, as one document: `None` if PLCopen XML cannot say it; otherwise what its scenarios say.
fn project(folder: &Path, refused: &mut BTreeMap<String, usize>) -> Option<Result<(), String>> {
    let bound = pipeline::front(inputs::read(&[folder.to_path_buf()]), &Settings::default());
    if bound.has_errors() || inputs::project_scenarios(folder).is_empty() {
        return None;
    }
    let parsed = pipeline::parse(inputs::read(&[folder.to_path_buf()]), &Settings::default());
    if parsed.units.iter().any(|(_, unit)| unit.s7200.is_some()) {
        return None;
    }
    let (written, messages) = whole::document(&parsed, "Test");
    if let Some(first) = messages.iter().find(|message| message.is_error()) {
        *refused.entry(first.title.clone()).or_default() += 1;
        return None;
    }
    // Scenarios with names that are others in the file, or with addresses in data blocks.
    let scenarios = everything(&folder.join("tests"));
    let has_addresses = scenarios.iter().any(|path| fs::read_to_string(path).is_ok_and(|text| text.contains("DB1.")));
    if has_addresses
        || messages.iter().any(|message| message.title.contains("in the file") && !message.title.contains("no address"))
    {
        *refused.entry("(scenarios with other names)".to_string()).or_default() += 1;
        return None;
    }
    let new = tempfile::tempdir().expect("a folder");
    fs::write(new.path().join("project.xml"), written).expect("a file");
    let toml = fs::read_to_string(folder.join("plc.toml")).expect("a project");
    let is_own = |line: &&str| !line.starts_with("sources") && !line.starts_with("symbols");
    let mut toml: String = toml.lines().filter(is_own).map(|line| format!("{line}\n")).collect();
    // Without a CPU in the project it is that of the sources.
    if !toml.contains("cpu") {
        toml = format!("cpu = \"{}\"\n{toml}", bound.program.profile.name);
    }
    fs::write(new.path().join("plc.toml"), toml).expect("a file");
    for scenario in scenarios {
        let to = new.path().join(scenario.strip_prefix(folder).expect("below the folder"));
        fs::create_dir_all(to.parent().expect("a folder")).expect("a folder");
        fs::copy(&scenario, to).expect("a file");
    }
    Some(passes(TestInput::Project(new.path().to_path_buf())))
}

#[test]
fn projects_pass_their_scenarios() {
    let (mut count, mut failed, mut refused) = (0, Vec::new(), BTreeMap::new());
    for folder in [tests_folder().join("run"), root().join("samples")].iter().flat_map(|folder| projects(folder)) {
        match project(&folder, &mut refused) {
            None => {}
            Some(Ok(())) => count += 1,
            Some(Err(text)) => failed.push(format!("{}: {text}", folder.display())),
        }
    }
    println!("{count} projects; refused: {refused:#?}");
    assert!(failed.is_empty(), "{} of {}:\n{}", failed.len(), count + failed.len(), failed.join("\n\n"));
    assert!(count > 4, "only {count} projects; {refused:#?}");
}

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

/// A scenario that expects in each cycle what the sum never is.
fn each_cycle(sum: &str, cycles: u32) -> String {
    (1..=cycles).map(|cycle| format!("[[at]]\ncycle = {cycle}\nexpect = {{ '{sum}' = -1 }}\n")).collect()
}

/// The values of the sum in all cycles.
fn sums(input: TestInput) -> Result<Vec<String>, String> {
    let outcomes = outcomes(input);
    match outcomes.iter().find(|one| one.rejected || one.unreadable || one.details.is_empty()) {
        Some(one) => Err(format!("{}{}", one.messages, one.failures)),
        None => Ok(outcomes.iter().flat_map(|one| &one.details).map(|one| one.left.clone()).collect()),
    }
}

/// The same of a file.
fn sums_of_file(file: PathBuf, sum: &str, cycles: u32) -> Result<Vec<String>, String> {
    fs::write(file.with_extension("scenario.toml"), each_cycle(sum, cycles)).expect("a file");
    sums(TestInput::File(file))
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
        let (written, messages) = whole::document(&parsed, "Random");
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

/// Simultaneous and alternative paths that begin and end together, jumps, each kind of action.
const CHART: &str = r##"FUNCTION_BLOCK "Line"
(*$_CMPSET
   FBInterface: Minimum
*)
VAR_INPUT
  start : BOOL;
  full_a : BOOL;
  full_b : BOOL;
  ready : BOOL;
  skip : BOOL;
END_VAR
VAR_OUTPUT
  valve_a : BOOL;
  valve_b : BOOL;
  mixer : BOOL;
  lamp : BOOL;
  late : BOOL;
  pulse : BOOL;
  kept : BOOL;
  begun : BOOL;
  count : INT;
  calls : INT;
  idle_time : TIME;
END_VAR
VAR
  pause : TIME := T#300ms;
END_VAR
INITIAL_STEP Idle (*$_NUM 1*):
(*$_COM waits for start*)
#idle_time := Idle.T   (N)
#begun   (S0_S)
END_STEP
STEP "Fill A" (*$_NUM 2*):
#valve_a   (N)
#count := #count + 1   (S1_N)
END_STEP
STEP FillB (*$_NUM 3*):
#valve_b   (N)
END_STEP
STEP WaitA (*$_NUM 4*):
END_STEP
STEP WaitB (*$_NUM 5*):
#begun   (S1_R)
END_STEP
STEP Mix (*$_NUM 6*):
#mixer   (N)
#late := T#100MS   (D)
#kept   (S)
CALL "Calls" (IN := #calls, RET_VAL := #calls)   (N)
END_STEP
STEP Empty (*$_NUM 7*):
#lamp := #pause   (L)
#pulse   (S0_N)
END_STEP
STEP Clean (*$_NUM 8*):
#kept   (R)
#valve_a   (N)
END_STEP
TRANSITION Again (*$_NUM 10*)
  FROM Clean
  TO Idle (*$_JUMP*)
CONDITION := NOT #start
END_TRANSITION
TRANSITION Back (*$_NUM 9*)
  FROM Empty
  TO Idle (*$_JUMP*)
CONDITION := Empty.U >= #pause
END_TRANSITION
TRANSITION Cleaning (*$_NUM 8*)
  FROM Empty
  TO Clean
CONDITION := #skip AND NOT #ready
END_TRANSITION
TRANSITION Mixed (*$_NUM 7*)
  FROM Mix
  TO Empty
CONDITION := S006.T >= T#200MS OR #skip
END_TRANSITION
TRANSITION Skipped (*$_NUM 6*)
  FROM (WaitA, WaitB)
  TO Empty
CONDITION := #skip
END_TRANSITION
TRANSITION Both (*$_NUM 5*)
  FROM (WaitA, WaitB)
  TO Mix
CONDITION := #ready
END_TRANSITION
TRANSITION Full_B (*$_NUM 4*)
  FROM FillB
  TO WaitB
CONDITION := #full_b
END_TRANSITION
TRANSITION Full_A (*$_NUM 3*)
  FROM "Fill A"
  TO WaitA
CONDITION := #full_a AND "Fill A".T >= T#50MS
END_TRANSITION
TRANSITION Stop (*$_NUM 2*)
  FROM Idle
  TO Clean
CONDITION := NOT #start AND #skip
END_TRANSITION
TRANSITION Go (*$_NUM 1*)
  FROM Idle
  TO ("Fill A", FillB)
CONDITION := #start
END_TRANSITION
END_FUNCTION_BLOCK
"##;

/// A program that gives the instance of "Line" `inputs` by chance, and sums up its outputs: `bits`, and `numbers`.
fn around(inputs: &str, bits: &[&str], numbers: &str) -> String {
    let sum = |(at, bit): (usize, &&str)| {
        format!("  IF \"Line_DB\".{bit} THEN \"Sum_DB\".sum := (\"Sum_DB\".sum * 3 + {}) MOD 100003; END_IF;\n", at + 1)
    };
    let lines: Vec<String> = bits.iter().enumerate().map(sum).collect();
    let lines = lines.concat();
    format!(
        r##"//@ test cycles=300
DATA_BLOCK "Line_DB" "Line"
BEGIN
END_DATA_BLOCK

DATA_BLOCK "Sum_DB"
STRUCT
  seed : DINT := 1;
  sum : DINT;
END_STRUCT;
BEGIN
END_DATA_BLOCK

ORGANIZATION_BLOCK "Main"
BEGIN
  "Sum_DB".seed := ("Sum_DB".seed * 75 + 74) MOD 65537;
  "Line_DB"({inputs});
{lines}  "Sum_DB".sum := ("Sum_DB".sum + {numbers}) MOD 100003;
END_ORGANIZATION_BLOCK
"##
    )
}

/// A function that the chart calls.
const CALLS: &str = r##"
FUNCTION "Calls" : INT
VAR_INPUT
  IN : INT;
END_VAR
BEGIN
  #Calls := #IN + 1;
END_FUNCTION
"##;

const NUMBERS: &str = "\
\"Line\",\"FB 1\",\"FB 1\",\"\"\n\
\"Line_DB\",\"DB 1\",\"FB 1\",\"\"\n\
\"Calls\",\"FC 7\",\"FC 7\",\"\"\n\
\"Sum_DB\",\"DB 2\",\"DB 2\",\"\"\n";

/// A project of `source`, the program around it, and the numbers of all blocks.
fn project_of(folder: &Path, (name, source): (&str, &str), main: &str, numbers: &str) -> PathBuf {
    let project = folder.join("project");
    fs::create_dir_all(&project).expect("a folder");
    let toml = format!("cpu = \"s7-300\"\nsources = [\"{name}\", \"main.scl\"]\nsymbols = [\"tags.sdf\"]\n");
    for (name, text) in [("plc.toml", toml.as_str()), (name, source), ("main.scl", main), ("tags.sdf", numbers)] {
        fs::write(project.join(name), text).expect("a file");
    }
    project
}

/// A project of a chart.
fn chart_project(folder: &Path, chart: &str) -> PathBuf {
    let inputs = r#"start := "Sum_DB".seed MOD 2 = 1, full_a := ("Sum_DB".seed / 4) MOD 2 = 1,
    full_b := ("Sum_DB".seed / 16) MOD 2 = 1, ready := ("Sum_DB".seed / 64) MOD 2 = 1,
    skip := ("Sum_DB".seed / 256) MOD 4 = 1"#;
    let bits = ["valve_a", "valve_b", "mixer", "lamp", "late", "pulse", "kept", "begun"];
    let numbers = r#"INT_TO_DINT("Line_DB".count) + INT_TO_DINT("Line_DB".calls) + TIME_TO_DINT("Line_DB".idle_time)"#;
    let main = around(inputs, &bits, numbers) + CALLS;
    project_of(folder, ("chart.gr7", chart), &main, NUMBERS)
}

/// The project as a document, and messages.
fn project_document(project: &Path) -> (String, Vec<plcc_diag::Diagnostic>) {
    let settings = Settings { pragmas: true, ..Settings::default() };
    let parsed = pipeline::parse(inputs::read(&[project.to_path_buf()]), &settings);
    assert!(!has_errors(&parsed.diagnostics), "{:#?}", parsed.diagnostics);
    whole::document(&parsed, "Line")
}

/// A block of STL with a box of several statements, and edges.
const STATEMENTS: &str = r##"FUNCTION_BLOCK "Line"
VAR_INPUT
  start : BOOL;
  stop : BOOL;
  speed : INT;
END_VAR
VAR_OUTPUT
  run : BOOL;
  fast : BOOL;
  once : BOOL;
  out : INT;
END_VAR
VAR
  edge : BOOL;
END_VAR
BEGIN
NETWORK
TITLE = latch
// keeps itself
      A(;
      O     #start;
      O     #run;
      );
      AN    #stop;
      =     #run;
NETWORK
TITLE = limits
      A     #run;
      A(;
      L     #speed;
      L     100;
      >I;
      );
      =     #fast;
      A     #start;
      FP    #edge;
      =     #once;
NETWORK
      A     #stop;
      JNB   _001;
      L     #speed;
      L     7;
      +I;
      T     #out;
      AN    OV;
      SAVE;
      CLR;
_001: A     BR;
      S     #fast;
END_FUNCTION_BLOCK
"##;

/// A project of statements.
fn statements_project(folder: &Path, statements: &str) -> PathBuf {
    let inputs = r#"start := "Sum_DB".seed MOD 2 = 1, stop := ("Sum_DB".seed / 4) MOD 2 = 1,
    speed := DINT_TO_INT("Sum_DB".seed MOD 200)"#;
    let main = around(inputs, &["run", "fast", "once"], r#"INT_TO_DINT("Line_DB".out)"#);
    let numbers = NUMBERS.replace("\"Calls\",\"FC 7\",\"FC 7\",\"\"\n", "");
    project_of(folder, ("line.stl", statements), &main, &numbers)
}

/// Converts a project, whose program then does the same in each of its 300 cycles; the document contains `parts`.
fn converts_to_the_same(folder: &Path, project: &Path, parts: &[&str]) {
    fs::create_dir(project.join("tests")).expect("a folder");
    fs::write(project.join("tests/sum.toml"), each_cycle("\"Sum_DB\".sum", 300)).expect("a file");
    let before = sums(TestInput::Project(project.to_path_buf())).expect("a program");
    assert_eq!(before.len(), 300);
    let (written, messages) = project_document(project);
    assert!(!has_errors(&messages), "{messages:#?}");
    for &part in parts {
        assert!(written.contains(part), "{part} in\n{written}");
    }
    let file = folder.join("a.xml");
    let pragma = plcc_convert::with_pragmas(&written, &["cpu s7-300".to_string()]);
    fs::write(&file, &pragma).expect("a file");
    let after = sums_of_file(file, "\"GlobalVariables\".Sum_DB.sum", 300);
    let after = after.unwrap_or_else(|messages| panic!("{messages}\n{written}"));
    assert_eq!(before, after, "{written}");
}

/// STL becomes LD, which does the same.
#[test]
fn statements_as_projects_do_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let project = statements_project(folder.path(), STATEMENTS);
    converts_to_the_same(folder.path(), &project, &["<xhtml:p>latch\nkeeps itself</xhtml:p>"]);
}

/// What has no LAD is named once, with its statement.
#[test]
fn statements_without_networks_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let statements = STATEMENTS.replace("      T     #out;\n", "      SRW   3;\n      TAK;\n      T     #out;\n");
    let (written, messages) = project_document(&statements_project(folder.path(), &statements));
    let errors: Vec<_> = messages.iter().filter(|one| one.is_error()).collect();
    assert_eq!((errors.len(), written.as_str()), (1, ""), "{messages:#?}");
}

#[test]
fn charts_as_projects_do_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let project = chart_project(folder.path(), CHART);
    let parts = [
        "targetName=\"Idle\"",
        "<selectionConvergence",
        "<simultaneousConvergence",
        "<simultaneousDivergence",
        "<selectionDivergence",
        "qualifier=\"D\" duration=\"T#100MS\"",
        "<xhtml:p>waits for start</xhtml:p>",
    ];
    converts_to_the_same(folder.path(), &project, &parts);
}

/// A comment after a row is that of the row, and not also one of the next step.
#[test]
fn comments_of_rows_are_written_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let chart = CHART.replace("#valve_b   (N)", "#valve_b   (N)   // opens B");
    let chart = chart.replace("#mixer   (N)", "// turns slowly\n#mixer   (N)");
    let (written, messages) = project_document(&chart_project(folder.path(), &chart));
    assert!(!has_errors(&messages), "{messages:#?}");
    for text in ["opens B", "turns slowly"] {
        assert_eq!(written.matches(text).count(), 1, "{text} in\n{written}");
    }
}

#[test]
fn charts_of_projects_come_back() {
    for name in ["star-delta", "two-doses"] {
        let folder = tests_folder().join("run/plcopen").join(name);
        let (written, messages) = project_document(&folder);
        assert!(!has_errors(&messages), "{name}: {messages:#?}");
        let new = tempfile::tempdir().expect("a folder");
        for from in everything(&folder) {
            let to = new.path().join(from.strip_prefix(&folder).expect("below the folder"));
            fs::create_dir_all(to.parent().expect("a folder")).expect("a folder");
            fs::copy(&from, &to).expect("a copy");
        }
        fs::write(new.path().join("project.xml"), &written).expect("a file");
        let result = passes(TestInput::Project(new.path().to_path_buf()));
        assert!(result.is_ok(), "{name}: {result:?}\n{written}");
    }
}

/// Operands and calls that PLCopen XML does not have are told once.
#[test]
fn what_is_refused_is_told_once() {
    let cases = [
        ("#n := \"D\".%DBW0;", "PLCopen XML has no addresses in data blocks"),
        ("\"Main\"();", "a call of a block without an instance"),
    ];
    for (statement, wanted) in cases {
        let source = format!(
            "DATA_BLOCK \"D\"\nSTRUCT\n  a : Int;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n\
             ORGANIZATION_BLOCK \"Main\"\nVAR_TEMP\n  n : Int;\nEND_VAR\nBEGIN\n  {statement}\nEND_ORGANIZATION_BLOCK\n"
        );
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("a.scl");
        fs::write(&file, source).expect("a file");
        let parsed = pipeline::parse(inputs::read(&[file]), &Settings::default());
        let (_, messages) = whole::document(&parsed, "Test");
        let titles: Vec<&str> = messages.iter().filter(|one| one.is_error()).map(|one| one.title.as_str()).collect();
        assert_eq!(titles, [wanted], "{statement}");
    }
}

/// Parts of the chart that are other ones, and what is told of them.
#[test]
fn what_sfc_does_not_have_is_refused() {
    let step = "STEP Mix (*$_NUM 6*):\n";
    let cases = [
        (
            step,
            "STEP Mix (*$_NUM 6*):\nSUPERVISION\nCONDITION := #skip\nEND_SUPERVISION\n",
            "SFC has no supervision, such as that of step `Mix`",
        ),
        (
            step,
            "STEP Mix (*$_NUM 6*):\nINTERLOCK\nCONDITION := #skip\nEND_INTERLOCK\n#valve_b   (NC)\n",
            "SFC has no interlocks, such as that of step `Mix`",
        ),
        ("#mixer   (N)", "#mixer   (V1_S)", "SFC has no actions at the event V1"),
        ("#mixer   (N)", "S_ALL   (S1_OFF)", "SFC has no actions that activate or deactivate steps"),
        ("#mixer   (N)", "C5   (S1_CU)", "PLCopen XML has no timers and counters of the CPU"),
        (
            "#mixer   (N)",
            "MW2 := MW4 + 1   (N)",
            "GRAPH computes here with the bits of an operand as a number, and ST does not",
        ),
        ("#late := T#100MS", "#late := MD20", "the time of an action is in an operand that is not of type TIME"),
        ("S006.T >=", "S006.LA AND S006.T >=", "SFC has no `LA` of a step, only X and T"),
        ("CONDITION := #ready\n", "CONDITION := #ready AND NOT Go.TT\n", "SFC has no `TT` of a transition"),
        (
            "INITIAL_STEP",
            "PERM_CONDITION_AT_BEGIN\nM9.0 (=) := #skip\nEND_PERM_CONDITION\nINITIAL_STEP",
            "SFC has no permanent instructions",
        ),
    ];
    for (old, new, wanted) in cases {
        assert!(CHART.contains(old), "{old}");
        let folder = tempfile::tempdir().expect("a folder");
        let project = chart_project(folder.path(), &CHART.replacen(old, new, 1));
        let (_, messages) = project_document(&project);
        let titles: Vec<&str> = messages.iter().filter(|one| one.is_error()).map(|one| one.title.as_str()).collect();
        assert_eq!(titles, [wanted], "{new}");
    }
}

/// Titles and comments of networks, by the names of their blocks.
fn titles(parsed: &Parsed) -> Vec<(String, Option<String>, Vec<String>)> {
    let blocks = parsed.units.iter().flat_map(|(_, unit)| &unit.blocks);
    let networks = blocks.filter_map(|block| match block {
        Block::Code(CodeBlock { name: BlockName::Symbol { name, .. }, code: Code::Graphic(body), .. }) => {
            Some(body.networks.iter().map(|one| (name.clone(), one.title.clone(), one.comment.clone())))
        }
        _ => None,
    });
    networks.flatten().collect()
}

#[test]
fn titles_and_comments_of_networks_are_kept() {
    let source = r#"<project><types><dataTypes/><pous><pou name="P" pouType="program"><interface><localVars>
        <variable name="a"><type><BOOL/></type></variable><variable name="b"><type><BOOL/></type></variable>
        </localVars></interface><body><LD>NETWORKS</LD></body></pou></pous></types></project>"#;
    let network = |y: i32, id: i32, comment: &str| {
        format!(
            r#"<comment localId="{c}" width="9" height="9"><position x="0" y="{y}"/><content><p>{comment}</p></content></comment>
            <leftPowerRail localId="{id}"><position x="0" y="{below}"/></leftPowerRail>
            <contact localId="{contact}"><position x="9" y="{below}"/><connectionPointIn><connection refLocalId="{id}"/>
            </connectionPointIn><variable>a</variable></contact>
            <coil localId="{coil}"><position x="19" y="{below}"/><connectionPointIn><connection refLocalId="{contact}"/>
            </connectionPointIn><variable>b</variable></coil>"#,
            c = id + 50,
            below = y + 10,
            contact = id + 1,
            coil = id + 2
        )
    };
    let networks = network(0, 1, "Seal-in\nof the motor\n\nthe end") + &network(50, 5, "\nonly a comment");
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.xml");
    fs::write(&file, source.replace("NETWORKS", &networks)).expect("a file");
    let parsed = pipeline::parse(inputs::read(std::slice::from_ref(&file)), &Settings::default());
    let wanted = [("P", Some("Seal-in"), vec!["of the motor", "", "the end"]), ("P", None, vec!["only a comment"])];
    let wanted: Vec<(String, Option<String>, Vec<String>)> = wanted
        .into_iter()
        .map(|(name, title, lines)| {
            (name.to_string(), title.map(str::to_string), lines.into_iter().map(str::to_string).collect())
        })
        .collect();
    assert_eq!(titles(&parsed), wanted);
    let (written, messages) = whole::document(&parsed, "Test");
    assert!(!has_errors(&messages), "{messages:#?}");
    fs::write(&file, written).expect("a file");
    let again = pipeline::parse(inputs::read(&[file]), &Settings::default());
    assert_eq!(titles(&again), wanted);
}
