//! SCL, networks and charts as STL.

use std::fs;
use std::path::Path;

use super::{done, expect_passed, folder_with, plcc, programs, read, text, write};

/// The CPU that a source names in a pragma decides what its statements mean, as it does for `plcc test`.
#[test]
fn scl_for_the_cpu_of_its_pragma_becomes_stl_for_it() {
    let source = "//@ cpu s7-1500\nORGANIZATION_BLOCK \"Main\"\n{ S7_Optimized_Access := 'TRUE' }\nVERSION : 0.1\nVAR_TEMP\n  w : Word;\n  \
                  i : Int;\n  d : DInt;\nEND_VAR\nBEGIN\n  #w := 16#FFFF;\n  #i := 1;\n  #d := #w + #i;\n  //@ assert #d == L#65536\n\
                  END_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("a.scl", source)]);
    done(&folder, &["convert", "a.scl", "--to", "stl", "-o", "a.stl"]);
    done(&folder, &["test", "a.stl"]);
    // Without a pragma a source of the TIA Portal is for an S7-1500, as `plcc test` takes it.
    write(&folder, "c.scl", &source.replace("//@ cpu s7-1500\n", ""));
    done(&folder, &["convert", "c.scl", "--to", "stl", "-o", "c.stl"]);
    for name in ["c.scl", "c.stl"] {
        done(&folder, &["test", name]);
    }
    // An S7-1200 has no STL.
    write(&folder, "b.scl", &source.replace("s7-1500", "1214C"));
    let refused = plcc(&folder, &["convert", "b.scl", "--to", "stl"]);
    assert_eq!(refused.status.code(), Some(3), "{}", text(&refused.stdout));
    assert!(text(&refused.stderr).contains("S7-1200"), "{}", text(&refused.stderr));
}

/// Where the program has a block with the name of the instruction that copies texts, a call would mean the block.
#[test]
fn texts_are_not_copied_by_another_block() {
    let source = "//@ cpu s7-1500\nDATA_BLOCK \"S_MOVE\"\nSTRUCT\n  s : STRING[4];\nEND_STRUCT\nBEGIN\nEND_DATA_BLOCK\n\
                  ORGANIZATION_BLOCK \"Main\"\n  \"S_MOVE\".s := 'abc';\nEND_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("a.scl", source)]);
    let refused = plcc(&folder, &["convert", "a.scl", "--to", "stl"]);
    let told = text(&refused.stderr);
    assert!(refused.status.code() != Some(0) && told.contains("rename the block or symbol"), "{told}");
}

/// Statements of SCL of the TIA Portal that names no CPU are for an S7-1500, and say so; those of S7-SCL are for an S7-300.
#[test]
fn scl_of_the_portal_without_a_cpu_becomes_stl_of_an_s7_1500() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "ORGANIZATION_BLOCK \"Main\"\nVERSION : 0.1\nVAR_TEMP\n  s : String[10];\n  n : Int;\nEND_VAR\nBEGIN\n  \
                  #s := 'abc';\n  #n := LEN(#s);\n  //@ assert #n == 3\nEND_ORGANIZATION_BLOCK\n";
    fs::create_dir(folder.join("plant")).expect("the folder can be written");
    fs::write(folder.join("plant/main.scl"), source).expect("the folder can be written");
    for (from, to) in [("plant/main.scl", "a.stl"), ("plant", "made/")] {
        let made = plcc(folder, &["convert", from, "--to", "stl", "-o", to]);
        assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
        let tested = plcc(folder, &["test", to]);
        let found = format!("{}{}", text(&tested.stdout), text(&tested.stderr));
        assert!(found.contains("1 passed, 0 failed"), "{found}");
    }
    for list in ["a.stl", "made/main.stl"] {
        let list = fs::read_to_string(folder.join(list)).expect("it was written");
        assert!(list.starts_with("//@ cpu s7-1500\nORGANIZATION_BLOCK"), "{list}");
    }
    let classic = "ORGANIZATION_BLOCK OB 1\nVAR_TEMP\n  n : INT;\nEND_VAR\nBEGIN\n  n := 1;\nEND_ORGANIZATION_BLOCK\n";
    fs::write(folder.join("b.scl"), classic).expect("the folder can be written");
    let made = plcc(folder, &["convert", "b.scl", "--to", "stl"]);
    assert!(text(&made.stdout).starts_with("ORGANIZATION_BLOCK"), "{}{}", text(&made.stdout), text(&made.stderr));
}

/// On an S7-300, BR is ENO of a block in LAD, which calls in SCL leave as it is; inputs of a function in SCL are copies.
#[test]
fn networks_in_scl_call_blocks_on_an_s7_300() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = r#"//@ cpu s7-300
FUNCTION Inner : Void
{ S7_Language := "LAD" }
NETWORK
    RUNG wire#powerrail  Contact( %M0.0 )  Coil( %M0.1 )  END_RUNG
END_NETWORK
END_FUNCTION

FUNCTION Outer : Void
{ S7_Language := "LAD" }
NETWORK
    RUNG wire#powerrail  Contact( %M0.2 )  Coil( %M0.3 )  END_RUNG
END_NETWORK
{ S7_Language := "SCL" }
NETWORK
    "Inner"();
END_NETWORK
END_FUNCTION

ORGANIZATION_BLOCK Main
{ S7_Language := "LAD" }
NETWORK
    RUNG wire#powerrail  "Outer"()  END_RUNG
END_NETWORK
END_ORGANIZATION_BLOCK
"#;
    fs::write(folder.join("a.s7dcl"), source).expect("the folder can be written");
    let made = plcc(folder, &["convert", "a.s7dcl", "--to", "stl", "-o", "a.stl"]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    let list = fs::read_to_string(folder.join("a.stl")).expect("it was written");
    let places = ["=     #br_1;", "CALL  \"Inner\"", "A     #br_1;", "SAVE;\n      CLR;"].map(|line| list.find(line));
    assert!(places.is_sorted() && places[0].is_some(), "{list}");
    let checked = plcc(folder, &["check", "a.stl"]);
    assert_eq!(checked.status.code(), Some(0), "{}", text(&checked.stderr));
    let networks = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/lad-fbd/parameters_of_scl_s7_300.s7dcl");
    let made = plcc(folder, &["convert", &networks.display().to_string(), "--to", "stl", "-o", "b.stl"]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    let tested = plcc(folder, &["test", "b.stl"]);
    let found = format!("{}{}", text(&tested.stdout), text(&tested.stderr));
    assert!(found.contains("3 passed, 0 failed"), "{found}");
}

/// Networks of a project for an S7-1200 are statements for an S7-1500, and its settings name one, too.
#[test]
fn networks_for_a_cpu_without_stl_are_for_another() {
    let source = "//@ cpu s7-1200\nORGANIZATION_BLOCK Main\n{ S7_Language := \"LAD\" }\nNETWORK\n    \
                  RUNG wire#powerrail  Contact( %M0.0 )  Coil( %M0.1 )  END_RUNG\nEND_NETWORK\n//@ assert %M0.1 == 0\n\
                  END_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("plant/main.s7dcl", source), ("plant/plc.toml", "cpu = \"1214C\"\n")]);
    let made = done(&folder, &["convert", "plant", "--to", "stl", "-o", "made/"]);
    assert!(text(&made.stderr).contains("`1214C` has no STL"), "{}", text(&made.stderr));
    let settings = read(&folder, "made/plc.toml");
    assert_eq!(settings, "cpu = \"s7-1500\"\n");
    let list = read(&folder, "made/main.stl");
    assert!(list.contains("//@ cpu s7-1500\n"), "{list}");
    done(&folder, &["test", "made"]);
}

/// Statements alone are those of an S7-300, so a folder of those for an S7-1500 names the CPU.
#[test]
fn folders_of_statements_name_their_cpu() {
    let source = "ORGANIZATION_BLOCK \"Main\"\n{ S7_Optimized_Access := 'TRUE' }\nVERSION : 0.1\nVAR_TEMP\n  w : Word;\n  u : UInt;\nEND_VAR\n\
                  BEGIN\n  #w := 16#8001;\n  #w.%X1 := TRUE;\n  #u := 40000 + 1;\n  //@ assert #w == 16#8003\nEND_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("plant/main.scl", source)]);
    done(&folder, &["convert", "plant", "--to", "stl", "--cpu", "s7-1500", "-o", "made/"]);
    let settings = read(&folder, "made/plc.toml");
    assert_eq!(settings, "cpu = \"s7-1500\"\n");
    done(&folder, &["test", "made"]);
}

#[test]
fn scl_as_stl_does_the_same() {
    let folder = folder_with(&[]);
    for name in ["average.scl", "calls.stl"] {
        fs::copy(programs().join(name), folder.path().join(name)).expect("the folder can be written");
    }
    done(&folder, &["test", "average.scl", "calls.stl"]);
    done(&folder, &["convert", "average.scl", "--to", "stl", "-o", "average.stl"]);
    let written = read(&folder, "average.stl");
    assert!(written.contains("NETWORK") && !written.contains("END_FOR"), "{written}");
    done(&folder, &["test", "average.stl", "calls.stl"]);
    // The test can fail.
    let wrong = written.replace("+D", "-D");
    assert_ne!(wrong, written);
    write(&folder, "average.stl", &wrong);
    assert_eq!(plcc(&folder, &["test", "average.stl", "calls.stl"]).status.code(), Some(1));
}

/// Networks in SCL stay among those of LAD; one with nothing but an assertion needs no statements.
#[test]
fn networks_in_scl_become_statements_among_the_others() {
    let source = r#"//@ cpu s7-1500
FUNCTION Mixed : Int
    VAR_INPUT
        up : Bool;
        count : Int;
    END_VAR
    VAR_TEMP
        sum : Int;
        i : Int;
        even : Bool;
    END_VAR
{ S7_Language := "LAD" }
NETWORK
    RUNG wire#powerrail  Move( in := 60, out1 => #sum )  END_RUNG
    RUNG wire#powerrail  Contact( #up )  Add{ SrcType := Int }( in1 := #sum, in2 := 1, out => #sum )  END_RUNG
END_NETWORK
{ S7_Language := "SCL" }
NETWORK
    // Twice for each.
    FOR #i := 1 TO #count DO
        IF #up THEN
            #sum := #sum + 2;
        ELSE
            #sum := #sum - 2;
        END_IF;
    END_FOR;
    #even := #sum MOD 2 = 0;
END_NETWORK
{ S7_Language := "LAD" }
NETWORK
    RUNG wire#powerrail  Contact( #even )  Sub{ SrcType := Int }( in1 := #sum, in2 := 100, out => #sum )  END_RUNG
END_NETWORK
{ S7_Language := "SCL" }
NETWORK
    #Mixed := #sum;
END_NETWORK
END_FUNCTION

ORGANIZATION_BLOCK Main
    VAR_TEMP
        n : Int;
    END_VAR
{ S7_Language := "LAD" }
NETWORK
    RUNG wire#powerrail  "Mixed"( up := TRUE, count := 3, ret_val => #n )  END_RUNG
END_NETWORK
{ S7_Language := "SCL" }
NETWORK
    //@ assert #n == 67
END_NETWORK
{ S7_Language := "SCL" }
NETWORK
    #n := "Mixed"(up := FALSE, count := 2) + 1;
    //@ assert #n == -43
END_NETWORK
END_ORGANIZATION_BLOCK
"#;
    let folder = folder_with(&[("mixed.s7dcl", source)]);
    let convert = || plcc(&folder, &["convert", "mixed.s7dcl", "--to", "stl", "-o", "mixed.stl"]);
    let made = convert();
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    for name in ["mixed.s7dcl", "mixed.stl"] {
        let tested = plcc(&folder, &["test", name]);
        let shown = text(&tested.stdout);
        assert!(tested.status.success() && shown.contains("2 passed"), "{name}: {shown}{}", text(&tested.stderr));
    }
    // What the other networks depend on is refused.
    for (line, says) in [("IF #up THEN RETURN; END_IF;", "a jump out of"), ("ENO := #up;", "ENO in")] {
        let source = source.replace("#Mixed := #sum;", &format!("#Mixed := #sum;\n    {line}"));
        write(&folder, "mixed.s7dcl", &source);
        let refused = convert();
        let shown = text(&refused.stderr);
        assert_eq!(refused.status.code(), Some(3), "{shown}");
        assert!(shown.contains(says) && shown.matches("error[").count() == 1, "{shown}");
    }
}

/// STL of an S7-1500 has constants of blocks. For others the message is about the constant and not about the type of the box.
#[test]
fn constants_of_blocks_stay_or_are_refused_by_their_names() {
    let source = "FUNCTION_BLOCK Own\n    VAR_INPUT\n        a : Int;\n    END_VAR\n    VAR_OUTPUT\n        r : Int;\n    END_VAR\n    \
                  VAR CONSTANT\n        limit : Int := 20;\n    END_VAR\n    { S7_Language := \"LAD\" }\n    NETWORK\n        \
                  RUNG wire#powerrail  Add{ SrcType := Int }( in1 := #a, in2 := #limit, out => #r )  END_RUNG\n    \
                  END_NETWORK\nEND_FUNCTION_BLOCK\n";
    let folder = folder_with(&[("a.s7dcl", source)]);
    let scl = "FUNCTION_BLOCK \"Own\"\nVAR_OUTPUT\n  r : Int;\nEND_VAR\nVAR CONSTANT\n  last : Int := 3;\nEND_VAR\nVAR\n  \
               row : Array[0..last] of Int;\nEND_VAR\n  #r := #row[2] + #last;\nEND_FUNCTION_BLOCK\n";
    write(&folder, "b.scl", scl);
    for name in ["a.s7dcl", "b.scl"] {
        let to_xml = ["convert", name, "--to", "xml", "--cpu", "s7-1500", "-o", "a.xml"];
        assert_eq!(plcc(&folder, &to_xml).status.code(), Some(0), "{name}");
        for from in [name, "a.xml"] {
            done(&folder, &["convert", from, "--to", "stl", "--cpu", "s7-1500", "-o", "a.stl"]);
            let list = read(&folder, "a.stl");
            assert!(list.contains("VAR CONSTANT"), "{list}");
            done(&folder, &["check", "a.stl", "--cpu", "s7-1500"]);
        }
    }
    let made = plcc(&folder, &["convert", "a.s7dcl", "--to", "stl", "--cpu", "315-2DP"]);
    let said = text(&made.stderr);
    assert_eq!(made.status.code(), Some(3), "{said}");
    assert!(said.contains("STL of STEP 7 has no constants of a block: `limit`"), "{said}");
    assert!(!said.contains("whose type is not in the sources"), "{said}");
}

/// STL has instances only as variables of their own.
#[test]
fn instances_that_stl_does_not_have_are_refused_where_they_are_declared() {
    let motor = "FUNCTION_BLOCK \"Motor\"\nVAR_INPUT\n  go : Bool;\nEND_VAR\nVAR_OUTPUT\n  on : Bool;\nEND_VAR\n  #on := #go;\n\
                 END_FUNCTION_BLOCK\n";
    let declared = "FUNCTION_BLOCK \"Line\"\nVAR_IN_OUT\n  first : \"Motor\";\n  delay : TON_TIME;\n  now : DTL;\nEND_VAR\nVAR\n  \
                    all : Array[1..2] of \"Motor\";\n  pair : Struct\n    left : \"Motor\";\n  END_STRUCT;\n  \
                    delays : Array[1..2] of TON_TIME;\n  last : \"Motor\";\n  i : Int;\nEND_VAR\n";
    let scl = format!("{motor}{declared}  #all[#i](go := TRUE);\n  #first.go := #delay.Q;\nEND_FUNCTION_BLOCK\n");
    let networks = format!(
        "{declared}{{ S7_Language := \"LAD\" }}\nNETWORK\n  RUNG wire#powerrail Contact( #first.on ) Coil( #last.go ) END_RUNG\n\
         END_NETWORK\nEND_FUNCTION_BLOCK\n"
    );
    let folder = folder_with(&[("line.scl", &scl), ("motor.scl", motor), ("line.s7dcl", &networks)]);
    // Of a timer that networks only read, STL of an S7-1500 takes the values.
    for (sources, parameters) in [(&["line.scl"][..], 2), (&["line.s7dcl", "motor.scl"], 1)] {
        let arguments = [&["convert"][..], sources, &["--to", "stl", "--cpu", "s7-1500", "-o", "made/"]].concat();
        let made = plcc(&folder, &arguments);
        let said = text(&made.stderr);
        assert_eq!(made.status.code(), Some(3), "{said}");
        for (what, count) in [
            ("an instance as an in-out parameter", parameters),
            ("an array of instances", 1),
            ("an instance in a structure", 1),
        ] {
            assert_eq!(said.matches(&format!("STL has no form for {what}\n")).count(), count, "{what}: {said}");
        }
        assert!(said.contains(&format!("plcc: {} errors", parameters + 2)), "{said}");
    }
}

/// SIMATIC SD has blocks in SCL as networks. Those that become STL leave the BR alone, and errors cannot set it there.
#[test]
fn calls_in_scl_have_the_eno_of_networks() {
    let source = |settings: &str| {
        format!(
            "{settings}FUNCTION Divide : Int\n    VAR_INPUT\n        a : Int;\n    END_VAR\n    {{ S7_Language := \"SCL\" }}\n    NETWORK\n        \
             #Divide := 10 / #a;\n    END_NETWORK\nEND_FUNCTION\nORGANIZATION_BLOCK Main\n    VAR_TEMP\n        n : Int;\n        \
             fine : Bool;\n    END_VAR\n    {{ S7_Language := \"SCL\" }}\n    NETWORK\n        #n := \"Divide\"(a := 5, ENO => #fine);\n        \
             //@ assert #fine == TRUE\n        #n := \"Divide\"(a := 0, ENO => #fine);\n        //@ assert #fine == TRUE\n    \
             END_NETWORK\nEND_ORGANIZATION_BLOCK\n"
        )
    };
    let folder = folder_with(&[("a.s7dcl", &source(""))]);
    write(&folder, "b.s7dcl", &source("{ S7_SetENOAutomatically := \"TRUE\" }\n"));
    done(&folder, &["convert", "a.s7dcl", "--to", "stl", "--cpu", "s7-1500", "-o", "a.stl"]);
    expect_passed(&folder, &["a.stl", "--cpu", "s7-1500"], 2);
    let made = plcc(&folder, &["convert", "b.s7dcl", "--to", "stl", "--cpu", "s7-1500", "-o", "b.stl"]);
    let said = text(&made.stderr);
    assert_eq!(made.status.code(), Some(3), "{said}");
    assert!(said.contains("STL has no form for OK and ENO that follow the errors of operations"), "{said}");
}

/// Tag tables say the types of their constants, too.
#[test]
fn constants_of_tag_tables_have_types() {
    let table = r#"<?xml version="1.0" encoding="utf-8"?>
<Document><Engineering version="V18" /><SW.Tags.PlcTagTable ID="0"><AttributeList><Name>Tags</Name></AttributeList><ObjectList>
<SW.Tags.PlcUserConstant ID="1" CompositionName="UserConstants"><AttributeList>
<DataTypeName>Int</DataTypeName><Name>HIGH</Name><Value>-5</Value>
</AttributeList></SW.Tags.PlcUserConstant></ObjectList></SW.Tags.PlcTagTable></Document>
"#;
    let source = "ORGANIZATION_BLOCK Main\n    VAR_TEMP\n        i : Int;\n    END_VAR\n    { S7_Language := \"LAD\" }\n    \
                  NETWORK\n        RUNG wire#powerrail  Add{ SrcType := Int }( in1 := \"HIGH\", in2 := 7, out => #i )  END_RUNG\n    \
                  END_NETWORK\nEND_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("Tags.xml", table), ("a.s7dcl", source)]);
    done(&folder, &["convert", "a.s7dcl", "Tags.xml", "--to", "stl", "--cpu", "s7-1500", "-o", "made/"]);
    let list = read(&folder, "made/a.stl");
    assert!(list.contains("L     \"HIGH\";\n      L     7;\n      +I;\n      T     #i;"), "{list}");
}

/// A data type that contains itself several times has no end.
#[test]
fn types_that_contain_themselves_are_looked_into_once() {
    let members: String = (0..8).map(|number| format!("  m{number} : \"T\";\n")).collect();
    let source = format!(
        "TYPE \"T\"\nSTRUCT\n{members}END_STRUCT\nEND_TYPE\n\
         FUNCTION \"F\" : VOID\n{{ S7_Language := \"LAD\" }}\nVAR_TEMP\n  t : \"T\";\n  x : BOOL;\nEND_VAR\nNETWORK\n\
         RUNG wire#powerrail\n  Contact( #x )\n  Coil( #x )\nEND_RUNG\nEND_NETWORK\nEND_FUNCTION\n"
    );
    let folder = folder_with(&[("a.s7dcl", &source)]);
    done(&folder, &["convert", "a.s7dcl", "--to", "stl", "-o", "a.stl"]);
}

/// The formal is an INT, its variable a WORD.
#[test]
fn calls_in_charts_get_the_values_of_their_in_out_variables() {
    let chart = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/graph/calls.gr7");
    let folder = folder_with(&[]);
    done(&folder, &["convert", &chart.display().to_string(), "--to", "stl", "-o", "a.stl"]);
    expect_passed(&folder, &["a.stl"], 26);
}

/// Only an S7-300 or S7-400 has SAVE, whose BR is ENO of the block.
#[test]
fn networks_with_save_need_no_name_of_their_cpu() {
    let networks = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/lad-fbd/registers_without_cpu.s7dcl");
    let folder = folder_with(&[]);
    done(&folder, &["convert", &networks.display().to_string(), "--to", "stl", "-o", "a.stl"]);
    expect_passed(&folder, &["a.stl"], 3);
}

/// The formals are INT, DINT and REAL, the variables addresses without a type.
#[test]
fn outputs_that_a_function_does_not_write_stay() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/scl/language/fc_output_not_written.scl");
    let folder = folder_with(&[]);
    done(&folder, &["convert", &source.display().to_string(), "--to", "stl", "-o", "a.stl"]);
    expect_passed(&folder, &["a.stl"], 2);
}

/// Nothing follows BEU, not even what sets ENO of the block.
#[test]
fn statements_of_networks_are_all_reached() {
    let networks = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/lad-fbd/eno_of_a_block.s7dcl");
    let folder = folder_with(&[]);
    done(&folder, &["convert", &networks.display().to_string(), "--to", "stl", "-o", "a.stl"]);
    let tested = plcc(&folder, &["test", "a.stl", "--deny", "warnings"]);
    let found = format!("{}{}", text(&tested.stdout), text(&tested.stderr));
    assert!(found.contains("4 passed, 0 failed") && !found.contains("warning"), "{found}");
}

/// Statements that only an S7-1500 has, or are for one since the named CPU has none, have settings that name it.
#[test]
fn statements_that_need_another_cpu_have_settings_that_name_it() {
    let source = |element: &str| {
        format!(
            "ORGANIZATION_BLOCK Main\n    VAR_TEMP\n        u : UInt;\n    END_VAR\n{{ S7_Language := \"LAD\" }}\nNETWORK\n    \
             RUNG wire#powerrail  {element}  END_RUNG\nEND_NETWORK\nEND_ORGANIZATION_BLOCK\n"
        )
    };
    let sel = source("Sel{ value_type := UInt }( g := TRUE, in0 := 1, in1 := 2, out => #u )");
    let contact = source("Contact( %M0.0 )  Coil( %M0.1 )");
    for (text_of_main, cpu) in [(sel, None), (contact, Some("s7-1200"))] {
        let folder = folder_with(&[("plant/main.s7dcl", &text_of_main)]);
        let mut flags = vec!["convert", "plant", "--to", "stl", "-o", "made/"];
        if let Some(cpu) = cpu {
            flags.extend(["--cpu", cpu]);
        }
        done(&folder, &flags);
        let settings = read(&folder, "made/plc.toml");
        assert_eq!(settings, "cpu = \"s7-1500\"\n");
        done(&folder, &["check", "made"]);
    }
}
