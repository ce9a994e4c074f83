//! Projects in PLCopen XML, and what becomes of their ST and IL.

use std::fs;
use std::path::Path;

use super::{done, expect, expect_passed, folder_with, plcc, programs, read, text};

/// A function of a project has its result at a pin with its own name.
#[test]
fn results_of_functions_of_projects_are_ret_val() {
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/plcopen/result-by-name");
    let project = project.display().to_string();
    let folder = folder_with(&[]);
    done(&folder, &["convert", &project, "--to", "stl", "-o", "made/", "--cpu", "s7-1500"]);
    let list = read(&folder, "made/project.stl");
    assert!(list.contains("RET_VAL :="), "{list}");
    done(&folder, &["check", "made", "--cpu", "s7-1500"]);
}

/// `S` of an instruction list assigns TRUE: what is made of a project is not what stands at its places.
#[test]
fn instruction_lists_of_projects_become_xml() {
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/plcopen/instruction-list");
    let project = project.display().to_string();
    let folder = folder_with(&[]);
    done(&folder, &["convert", &project, "--to", "xml", "-o", "made/"]);
    let document = read(&folder, "made/project.xml");
    assert!(document.contains("<ConstantValue>TRUE</ConstantValue>") && !document.contains("Text=\"S\""), "{document}");
    done(&folder, &["check", "made"]);
}

/// A project of another editor names no CPU. What is made of it names none either, and so computes with bit strings as it does.
#[test]
fn projects_without_a_cpu_stay_without_one() {
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/plcopen/bit-strings");
    let project = project.display().to_string();
    for notation in ["sd", "scl", "xml"] {
        let folder = folder_with(&[]);
        done(&folder, &["convert", &project, "--to", notation, "-o", "made/"]);
        let settings = read(&folder, "made/plc.toml");
        assert_eq!(settings, "name = \"bit-strings\"\n", "{notation}");
        done(&folder, &["check", "made"]);
    }
}

/// Without them, clock memory would stand still. The document has the intervals of organization blocks.
#[test]
fn settings_of_a_program_stay_with_its_project() {
    let settings = "name = \"lamp\"\ncpu = \"1214C\"\nsources = [\"main.scl\"]\nsymbols = [\"tags.sdf\"]\nclock_memory = 10\n\n\
                    [ob.35]\nperiod = \"50ms\"\n";
    let source = "ORGANIZATION_BLOCK \"Main\"\nBEGIN\n  \"Lamp\" := \"Lamp\" OR %M10.0;\nEND_ORGANIZATION_BLOCK\n\
                  ORGANIZATION_BLOCK \"Cyclic interrupt\"\n{ S7_BlockNumber := '35' }\nBEGIN\n  \"Count\" := \"Count\" + 1;\n\
                  END_ORGANIZATION_BLOCK\n";
    let tags = "\"Lamp\",\"Q 4.0\",\"BOOL\",\"\"\n\"Count\",\"MW 20\",\"INT\",\"\"\n";
    let folder = folder_with(&[("lamp/plc.toml", settings), ("lamp/main.scl", source), ("lamp/tags.sdf", tags)]);
    done(&folder, &["convert", "lamp", "--to", "plcopen", "-o", "made/"]);
    assert_eq!(read(&folder, "made/plc.toml"), "name = \"lamp\"\ncpu = \"1214C\"\nclock_memory = 10\n\n");
    let output = ["lamp", "made"].map(|project| {
        let run = ["run", project, "--clock", "virtual", "--cycles", "40", "--quiet", "--print", "Q4.0,MW20"];
        text(&done(&folder, &run).stdout)
    });
    assert!(output[0].contains("Q4.0 = 1"), "{output:?}");
    assert_eq!(output[0], output[1]);
}

/// The power rail has no falling edge, and NOT cannot be the first element of a rung.
#[test]
fn falling_edges_of_the_power_rail_come_back_from_projects() {
    let source = "ORGANIZATION_BLOCK Main\n    { S7_Language := \"LAD\" }\n    NETWORK\n        RUNG wire#powerrail  N_Trig( %M2.0 )  \
                  S_Coil( %Q4.0 )  END_RUNG\n        RUNG wire#powerrail  N_Coil( operand => %Q4.1, bit := %M2.1 )  END_RUNG\n        \
                  RUNG wire#powerrail  P_Trig( %M2.2 )  S_Coil( %Q4.2 )  END_RUNG\n    END_NETWORK\nEND_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("edges.s7dcl", source)]);
    done(&folder, &["convert", "edges.s7dcl", "--to", "plcopen", "-o", "edges.xml"]);
    for file in ["edges.s7dcl", "edges.xml"] {
        let run = ["run", file, "--clock", "virtual", "--cycles", "3", "--quiet", "--print", "QB4,MB2"];
        assert_eq!(text(&done(&folder, &run).stdout), "QB4 = 16#04\nMB2 = 16#07\n", "{file}");
    }
}

/// Optimized access implies an S7-1500 in XML, and nothing in SCL: both follow the same rules if nothing names a CPU.
#[test]
fn optimized_access_names_no_other_cpu() {
    const SCL: &str = r#"FUNCTION_BLOCK "Sum"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
VAR
  b : Byte;
  i : Int;
END_VAR
BEGIN
  #i := #i + #b;
END_FUNCTION_BLOCK
"#;
    let folder = folder_with(&[("sources/a.scl", SCL)]);
    for notation in ["xml", "sd"] {
        done(&folder, &["convert", "sources", "--to", notation, "-o", &format!("{notation}/")]);
        assert!(!folder.path().join(notation).join("plc.toml").exists(), "{notation}");
        done(&folder, &["check", notation]);
    }
}

/// `//@ cpu` names the CPU for conversions that bind the program, too: an S7-300 has no data for any timer.
#[test]
fn pragmas_name_the_cpu_of_a_project() {
    const SCL: &str = r#"//@ cpu s7-1500
DATA_BLOCK "Pause" IEC_TIMER
BEGIN
END_DATA_BLOCK
ORGANIZATION_BLOCK "Main"
VERSION : 0.1
BEGIN
  "Pause".TP(IN := TRUE, PT := T#1h);
END_ORGANIZATION_BLOCK
"#;
    let folder = folder_with(&[("a.scl", SCL)]);
    for arguments in [["--to", "plcopen", "-o", "a.xml"].as_slice(), &["--absolute", "-o", "b.scl"]] {
        done(&folder, &[&["convert", "a.scl"][..], arguments].concat());
    }
}

/// Comments in the ST of charts stay when these become GRAPH.
#[test]
fn comments_of_charts_of_projects_stay() {
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/plcopen/two-doses/project.xml");
    let source = fs::read_to_string(project).expect("a test file");
    let changed = source.replace("ValveB := DoseB.X;", "(* open it *)\nValveB := DoseB.X; // while dosing\n");
    assert_ne!(changed, source);
    let folder = folder_with(&[("a.xml", &changed)]);
    done(&folder, &["convert", "a.xml", "--to", "gr7", "-o", "made/"]);
    let chart = read(&folder, "made/a.gr7");
    assert!(chart.contains("(* open it *)") && chart.contains("// while dosing"), "{chart}");
    done(&folder, &["check", "made"]);
}

/// A quote in a text, which XML writes as `&apos;`.
#[test]
fn texts_with_quotes_come_back_from_projects() {
    let source = "FUNCTION \"F\" : Void\nVAR_TEMP\n  t : String[20];\nEND_VAR\nBEGIN\n  \
                  #t := CONCAT(IN1 := 'It$'s ', IN2 := 'on');\nEND_FUNCTION\n";
    let folder = folder_with(&[("a.scl", source)]);
    done(&folder, &["convert", "a.scl", "--to", "plcopen", "--cpu", "1511-1", "-o", "a.xml"]);
    let back = text(&plcc(&folder, &["convert", "a.xml", "--to", "scl"]).stdout);
    assert!(back.contains("CONCAT(IN1 := 'It$'s ', IN2 := 'on')"), "{back}");
}

/// A STRING holds 254 characters, and fewer in the editors that read the project.
#[test]
fn texts_without_a_length_get_theirs_in_projects() {
    let source = "FUNCTION_BLOCK \"F\"\nVAR\n  t : String;\nEND_VAR\nBEGIN\n  #t := 'on';\nEND_FUNCTION_BLOCK\n";
    let folder = folder_with(&[("a.scl", source)]);
    let made = done(&folder, &["convert", "a.scl", "--to", "plcopen", "--cpu", "1511-1"]);
    assert!(text(&made.stdout).contains("<string length=\"254\"/>"), "{}", text(&made.stdout));
}

/// LAD, SCL, data blocks and tags as one project, with what the format does not have.
#[test]
fn a_program_becomes_one_project_of_plcopen() {
    expect(&["convert", "filler", "--to", "plcopen"], "filler.plcopen");
}

#[test]
fn what_plcopen_does_not_have_is_refused_with_its_line() {
    let output = plcc(programs(), &["convert", "startup.scl", "--to", "plcopen"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(output.stdout.is_empty(), "nothing is written");
    let path = programs().join("startup.plcopen");
    let found = text(&output.stderr);
    if std::env::var_os("UPDATE_EXPECT").is_some_and(|value| value != "0") {
        fs::write(&path, &found).expect("the tree can be written");
    }
    assert_eq!(found, fs::read_to_string(&path).unwrap_or_default(), "UPDATE_EXPECT=1 renews it; read the diff");
}

/// Blocks in ST with their comments, and beside them the variables that have addresses; other languages are left out.
#[test]
fn st_of_plcopen_becomes_scl() {
    let folder = folder_with(&[]);
    let output = folder.path().join("bottles.scl");
    let written = done(programs(), &["convert", "bottles.xml", "--to", "scl", "-o", &output.to_string_lossy()]);
    let read = |path: &Path| fs::read_to_string(path).expect("plcc has written it");
    let found = format!("{}{}{}", text(&written.stderr), read(&output), read(&output.with_extension("sdf")));
    let path = programs().join("bottles.scl.expected");
    if std::env::var_os("UPDATE_EXPECT").is_some_and(|value| value != "0") {
        fs::write(&path, &found).expect("the tree can be written");
    }
    assert_eq!(found, fs::read_to_string(&path).unwrap_or_default(), "UPDATE_EXPECT=1 renews it; read the diff");
    let printed = plcc(programs(), &["convert", "bottles.xml", "--to", "scl"]);
    assert_eq!(printed.status.code(), Some(2));
    assert!(text(&printed.stderr).contains("(`.sdf`): name the output with `-o`"), "{}", text(&printed.stderr));
}

/// A constant that a project declares after the bodies has none of their comments.
#[test]
fn comments_of_projects_stay_out_of_constants() {
    const PROJECT: &str = r#"<?xml version="1.0" encoding="utf-8"?>
<project xmlns="http://www.plcopen.org/xml/tc6_0201" xmlns:xhtml="http://www.w3.org/1999/xhtml">
  <fileHeader companyName="a" productName="b" productVersion="1" creationDateTime="2024-01-01T00:00:00"/>
  <contentHeader name="c"/>
  <types><dataTypes/><pous>
    <pou name="Count" pouType="functionBlock">
      <interface><localVars><variable name="n"><type><INT/></type></variable></localVars></interface>
      <body><ST><xhtml:p><![CDATA[(* begin *)
n := n + STEP_OF_N; // one more
]]></xhtml:p></ST></body>
    </pou>
  </pous></types>
  <instances><configurations><configuration name="c"><resource name="r"><globalVars constant="true"><variable name="STEP_OF_N"><type><INT/></type><initialValue><simpleValue value="2"/></initialValue></variable></globalVars></resource></configuration></configurations></instances>
</project>
"#;
    let folder = folder_with(&[("a.xml", PROJECT)]);
    for (to, code) in [("scl", "BEGIN"), ("xml", "<StructuredText")] {
        let made = plcc(&folder, &["convert", "a.xml", "--to", to, "--cpu", "s7-1500"]);
        let found = text(&made.stdout);
        let (declared, code) = found.split_once(code).unwrap_or_else(|| panic!("{found}{}", text(&made.stderr)));
        assert!(declared.contains("STEP_OF_N") && !declared.contains("one more"), "{found}");
        assert!(code.contains("begin") && code.contains("one more"), "{found}");
    }
}

/// Comments in ST stay when it becomes STL.
#[test]
fn comments_of_projects_reach_statements() {
    const PROJECT: &str = r#"<?xml version="1.0" encoding="utf-8"?>
<project xmlns="http://www.plcopen.org/xml/tc6_0201" xmlns:xhtml="http://www.w3.org/1999/xhtml">
  <fileHeader companyName="a" productName="b" productVersion="1" creationDateTime="2024-01-01T00:00:00"/>
  <contentHeader name="c"/>
  <types><dataTypes/><pous>
    <pou name="Count" pouType="functionBlock">
      <interface><localVars><variable name="n"><type><INT/></type></variable></localVars></interface>
      <body><ST><xhtml:p><![CDATA[(* begin *)
n := n + 1; // one more
]]></xhtml:p></ST></body>
    </pou>
  </pous></types>
  <instances><configurations/></instances>
</project>
"#;
    let folder = folder_with(&[("a.xml", PROJECT)]);
    let made = plcc(&folder, &["convert", "a.xml", "--to", "stl", "--cpu", "s7-1500"]);
    let list = text(&made.stdout);
    assert!(list.contains("// begin\n") && list.contains("// one more\n"), "{list}{}", text(&made.stderr));
}

/// Assertions in ST hold for the statements that are made of it.
#[test]
fn assertions_of_projects_reach_statements() {
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/plcopen/flip-flops/project.xml");
    let project = project.display().to_string();
    let folder = folder_with(&[]);
    done(&folder, &["convert", &project, "--to", "stl", "--cpu", "s7-1500", "-o", "a.stl"]);
    let count = fs::read_to_string(project).expect("a test file").matches("//@ assert").count();
    let list = read(&folder, "a.stl");
    assert_eq!(list.matches("//@ assert").count(), count, "{list}");
    done(&folder, &["test", "a.stl", "--cpu", "s7-1500"]);
}

/// The organization block that calls a program has its place in the file, and is not the program.
#[test]
fn programs_of_projects_do_not_call_themselves() {
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/plcopen/flip-flops/project.xml");
    let folder = folder_with(&[]);
    let made = plcc(&folder, &["convert", &project.to_string_lossy(), "--to", "stl", "-o", "a.stl"]);
    let said = text(&made.stderr);
    let Ok(list) = fs::read_to_string(folder.path().join("a.stl")) else { panic!("{said}") };
    assert_eq!(list.matches("CALL  \"Main\", \"Main_DB\"").count(), 1, "{list}");
}

/// An output of a call at two variables: a call in STL would have the parameter twice.
#[test]
fn outputs_of_calls_with_several_connections_are_refused() {
    const PROJECT: &str = r#"<?xml version="1.0" encoding="utf-8"?>
<project xmlns="http://www.plcopen.org/xml/tc6_0201">
  <types><dataTypes/><pous>
    <pou name="Main" pouType="program">
      <interface><localVars>
        <variable name="edge"><type><derived name="R_TRIG"/></type></variable>
        <variable name="go"><type><BOOL/></type></variable>
        <variable name="one"><type><BOOL/></type></variable>
        <variable name="two"><type><BOOL/></type></variable>
      </localVars></interface>
      <body><FBD>
        <inVariable localId="1"><connectionPointOut/><expression>go</expression></inVariable>
        <block localId="2" typeName="R_TRIG" instanceName="edge" executionOrderId="1">
          <inputVariables><variable formalParameter="CLK"><connectionPointIn><connection refLocalId="1"/></connectionPointIn></variable></inputVariables>
          <inOutVariables/>
          <outputVariables><variable formalParameter="Q"><connectionPointOut/></variable></outputVariables>
        </block>
        <outVariable localId="3" executionOrderId="2"><connectionPointIn><connection refLocalId="2" formalParameter="Q"/></connectionPointIn><expression>one</expression></outVariable>
        <outVariable localId="4" executionOrderId="3"><connectionPointIn><connection refLocalId="2" formalParameter="Q"/></connectionPointIn><expression>two</expression></outVariable>
      </FBD></body>
    </pou>
  </pous></types>
  <instances><configurations/></instances>
</project>
"#;
    let folder = folder_with(&[("a.xml", PROJECT)]);
    let made = plcc(&folder, &["convert", "a.xml", "--to", "stl", "--cpu", "s7-1500"]);
    let said = text(&made.stderr);
    assert_eq!(made.status.code(), Some(3), "{said}");
    assert!(said.contains("the output `q` of a call with several connections"), "{said}");
}

/// An output at a variable and at a wire: a document of SIMATIC SD would have the pin twice.
#[test]
fn outputs_with_several_connections_are_refused() {
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/plcopen/wires/project.xml");
    let folder = folder_with(&[]);
    let made = plcc(&folder, &["convert", &project.to_string_lossy(), "--to", "sd", "-o", "a.s7dcl"]);
    let said = text(&made.stderr);
    assert_eq!(made.status.code(), Some(3), "{said}");
    assert!(said.contains("the output `out` with several connections, of which a document has one"), "{said}");
}

/// The flow of a gate goes on, and its output is at a variable too.
#[test]
fn a_flow_and_a_variable_at_one_output_are_written() {
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/plcopen/languages/project.xml");
    let folder = folder_with(&[]);
    done(&folder, &["convert", &project.to_string_lossy(), "--to", "sd", "-o", "a.s7dcl"]);
    let document = read(&folder, "a.s7dcl");
    assert!(document.contains("A( in2 := NOT #off, out => #held )  Coil( #loop_1 )"), "{document}");
}

/// A warning says that what is written needs what is left out.
#[test]
fn blocks_that_others_use_are_named() {
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/plcopen/first-steps/project.xml");
    let folder = folder_with(&[]);
    let made = plcc(&folder, &["convert", &project.to_string_lossy(), "--to", "scl", "-o", "a.scl"]);
    let said = text(&made.stderr);
    assert_eq!(made.status.code(), Some(0), "{said}");
    assert!(said.contains("\"CounterLD\" is not in SCL, and others use it"), "{said}");
}

/// What their assertions say of projects in ST and IL holds for the sources in SCL.
#[test]
fn st_of_plcopen_does_the_same_as_scl() {
    for (name, assertions) in [("words", 25), ("instruction-list", 11)] {
        let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/plcopen").join(name);
        let settings = fs::read_to_string(project.join("plc.toml")).expect("it is there");
        let settings = settings.replace("project.xml", "project.scl");
        let folder = folder_with(&[("plc.toml", &settings)]);
        let (from, to) = (project.join("project.xml"), folder.path().join("project.scl"));
        let arguments =
            ["convert", &from.to_string_lossy(), "--to", "scl", "-o", &to.to_string_lossy()].map(String::from);
        done(&folder, &arguments.each_ref().map(String::as_str));
        expect_passed(&folder, &["."], assertions);
    }
}

/// A variable of 64 bits, which a symbol table does not have, is one message.
#[test]
fn a_variable_that_is_left_out_is_told_once() {
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/plcopen/addresses-apart/project.xml");
    let project = project.display().to_string();
    let folder = folder_with(&[]);
    let made = done(&folder, &["convert", &project, "--to", "scl", "-o", "made.scl"]);
    assert_eq!(text(&made.stderr).matches("no address of 64 bits").count(), 1, "{}", text(&made.stderr));
}

/// A project of ST and LD with a task: the task calls its instance in SCL.
#[test]
fn projects_of_networks_and_st_become_documents() {
    let project = r#"<?xml version="1.0" encoding="utf-8"?>
<project xmlns="http://www.plcopen.org/xml/tc6_0201">
  <fileHeader companyName="x" productName="x" productVersion="1" creationDateTime="2020-01-01T00:00:00"/>
  <contentHeader name="p"><coordinateInfo><fbd><scaling x="1" y="1"/></fbd><ld><scaling x="1" y="1"/></ld><sfc><scaling x="1" y="1"/></sfc></coordinateInfo></contentHeader>
  <types><dataTypes/><pous>
    <pou name="Lamp" pouType="functionBlock">
      <interface>
        <inputVars><variable name="a"><type><BOOL/></type></variable></inputVars>
        <outputVars><variable name="q"><type><BOOL/></type></variable></outputVars>
      </interface>
      <body><LD>
        <leftPowerRail localId="1"><position x="0" y="0"/><connectionPointOut formalParameter=""/></leftPowerRail>
        <contact localId="2"><position x="10" y="0"/><connectionPointIn><connection refLocalId="1"/></connectionPointIn><connectionPointOut/><variable>a</variable></contact>
        <coil localId="3"><position x="20" y="0"/><connectionPointIn><connection refLocalId="2"/></connectionPointIn><connectionPointOut/><variable>q</variable></coil>
      </LD></body>
    </pou>
    <pou name="Main" pouType="program">
      <interface><localVars><variable name="l"><type><derived name="Lamp"/></type></variable></localVars></interface>
      <body><ST><xhtml xmlns="http://www.w3.org/1999/xhtml">l(a := TRUE); // shine
</xhtml></ST></body>
    </pou>
  </pous></types>
  <instances><configurations><configuration name="c"><resource name="r"><task name="t" priority="1" interval="T#10ms"><pouInstance name="m" typeName="Main"/></task></resource></configuration></configurations></instances>
</project>
"#;
    let folder = folder_with(&[("p.xml", project)]);
    done(&folder, &["convert", "p.xml", "--to", "sd", "-o", "p.s7dcl"]);
    let document = read(&folder, "p.s7dcl");
    assert!(document.contains("Contact( #a )") && document.contains("// shine"), "{document}");
    done(&folder, &["check", "p.s7dcl", "--cpu", "s7-1500"]);
}

/// Functions of the project are called in quotes; what networks of the TIA Portal do not have is refused.
#[test]
fn networks_of_projects_become_documents_that_are_read() {
    let folder = folder_with(&[]);
    let convert = |name: &str| {
        let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/plcopen").join(name);
        let project = project.join("project.xml").display().to_string();
        plcc(&folder, &["convert", &project, "--to", "sd", "-o", "made.s7dcl"])
    };
    for (name, says) in [
        ("functions", "the TIA Portal has no element in LAD and FBD for this function"),
        ("bit-strings-drawn", "an input that converts its operand"),
    ] {
        let made = convert(name);
        assert_eq!(made.status.code(), Some(3), "{name}");
        assert!(text(&made.stderr).contains(says), "{name}: {}", text(&made.stderr));
        assert!(!folder.path().join("made.s7dcl").exists(), "{name}");
    }
    let made = convert("result-by-name");
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    expect_passed(&folder, &["made.s7dcl", "--cpu", "s7-1500"], 1);
}
