//! Where comments and regions are afterwards.

use super::{done, expect_passed, folder_with, plcc, read, text, write};

#[test]
fn regions_stay() {
    let source = "FUNCTION \"F\" : VOID\nVAR_TEMP\n    n : INT;\nEND_VAR\nBEGIN\n    REGION Start values   // c\n    #n := 1;\n    \
                  IF #n = 1 THEN\n        REGION inside\n        #n := 2;\n        END_REGION inside\n    END_IF;\n    \
                  END_REGION\nEND_FUNCTION\n";
    let folder = folder_with(&[("a.scl", source)]);
    let output = plcc(&folder, &["convert", "a.scl", "--to", "scl"]);
    let words = |text: &str| text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
    let (found, wanted): (Vec<String>, Vec<String>) = (words(&text(&output.stdout)), words(source));
    assert_eq!(found, wanted);
    let xml = text(&plcc(&folder, &["convert", "a.scl", "--to", "xml"]).stdout);
    let lines = |part: &str| xml.lines().filter(|line| line.contains(part)).count();
    assert_eq!((lines(" Text=\"REGION\"/>"), lines(" Text=\"END_REGION\"/>")), (2, 2), "{xml}");
    assert_eq!((lines("\">Start values</Text>"), lines("\">inside</Text>")), (1, 2), "{xml}");
    // STL and PLCopen XML have no regions.
    for (notation, cpu) in [("stl", "s7-300"), ("plcopen", "s7-1200")] {
        let output = plcc(&folder, &["convert", "a.scl", "--to", notation, "--cpu", cpu]);
        let found = format!("{}{}", text(&output.stdout), text(&output.stderr));
        let lines = |part: &str| found.lines().filter(|line| line.contains(part)).count();
        assert_eq!((lines("// REGION"), lines("// END_REGION")), (2, 2), "{found}");
    }
}

/// A region that ends a network stays inside it.
#[test]
fn regions_of_networks_stay() {
    let source = "ORGANIZATION_BLOCK Main\n    { S7_Language := \"SCL\" }\n    NETWORK\n        REGION lamps\n        \
                  %Q0.0 := TRUE;\n        END_REGION\n        // end\n    END_NETWORK\n    // between\n    \
                  { S7_Language := \"SCL\" }\n    NETWORK\n        %Q0.1 := TRUE;\n    END_NETWORK\nEND_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("a.s7dcl", source)]);
    let output = plcc(&folder, &["convert", "a.s7dcl", "--to", "sd"]);
    assert_eq!(text(&output.stdout), source, "{}", text(&output.stderr));
}

/// The comments, regions and pragmas of an export in XML are in what is made of it.
#[test]
fn comments_of_exports_stay() {
    let source = "//@ cpu s7-1200\nFUNCTION \"F\" : VOID\nVAR_TEMP\n    n : Int;\nEND_VAR\nBEGIN\n    // first\n    REGION start\n    \
                  #n := 1; // one\n    IF #n = 1 THEN\n        // inside\n        #n := 2;\n    END_IF;\n    END_REGION\n    // last\n\
                  END_FUNCTION\n\nFUNCTION \"G\" : VOID\nVAR_TEMP\n    n : Int;\nEND_VAR\nBEGIN\n    // other\n    #n := 1;\n\
                  END_FUNCTION\n";
    let folder = folder_with(&[("a.scl", source)]);
    let convert = |from: &str, to: &str| {
        let output = done(&folder, &["convert", from, "--to", to]);
        text(&output.stdout).to_string()
    };
    let first = convert("a.scl", "xml");
    write(&folder, "a.xml", &first);
    assert_eq!(convert("a.xml", "xml"), first);
    let words = |text: &str| {
        let lines = text.lines().filter(|line| !line.trim().is_empty());
        lines.map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect::<Vec<_>>()
    };
    let scl = convert("a.xml", "scl");
    assert_eq!(words(&scl), words(source));
    // What stands at the end of a body is indented as its statements are.
    assert!(scl.contains("\n    REGION start\n"), "{scl}");
    assert!(scl.contains("\n    END_REGION\n    // last\nEND_FUNCTION\n"), "{scl}");
    let stl = "FUNCTION \"F\" : VOID\nBEGIN\nNETWORK\n      SET; // one\n      // two\n      SAVE;\nEND_FUNCTION\n";
    write(&folder, "b.stl", stl);
    let first = convert("b.stl", "xml");
    write(&folder, "b.xml", &first);
    assert_eq!(convert("b.xml", "xml"), first);
}

/// A comment in several languages is that of the first one, of a declaration as well as between statements.
#[test]
fn comments_in_several_languages_stay() {
    const DOCUMENT: &str = r#"<?xml version="1.0" encoding="utf-8"?>
<Document>
  <Engineering version="V17" />
  <SW.Blocks.FC ID="0">
    <AttributeList>
      <Interface><Sections xmlns="http://www.siemens.com/automation/Openness/SW/Interface/v5">
  <Section Name="Temp">
    <Member Name="list" Datatype="Array[0..1] of Int">
      <Subelement Path="1">
        <Comment>
          <MultiLanguageText Lang="de-DE">zweites Element</MultiLanguageText>
        </Comment>
      </Subelement>
    </Member>
    <Member Name="n" Datatype="Int">
      <Comment>
        <MultiLanguageText Lang="de-DE">Zahl</MultiLanguageText>
        <MultiLanguageText Lang="en-US">number</MultiLanguageText>
      </Comment>
    </Member>
  </Section>
</Sections></Interface>
      <Name>F</Name>
      <ProgrammingLanguage>SCL</ProgrammingLanguage>
    </AttributeList>
    <ObjectList>
      <SW.Blocks.CompileUnit ID="1" CompositionName="CompileUnits">
        <AttributeList>
          <NetworkSource><StructuredText xmlns="http://www.siemens.com/automation/Openness/SW/NetworkSource/StructuredText/v3">
  <Comment UId="21">
    <MultiLanguageText Lang="de-DE" UId="22">Anfang</MultiLanguageText>
    <MultiLanguageText Lang="en-US" UId="23">begin</MultiLanguageText>
  </Comment>
  <NewLine UId="24" />
  <Access Scope="LocalVariable" UId="25"><Symbol UId="26"><Component Name="n" UId="27" /></Symbol></Access>
  <Token Text=":=" UId="28" />
  <Access Scope="LiteralConstant" UId="29"><Constant UId="30"><ConstantValue UId="31">5</ConstantValue></Constant></Access>
  <Token Text=";" UId="32" />
</StructuredText></NetworkSource>
          <ProgrammingLanguage>SCL</ProgrammingLanguage>
        </AttributeList>
      </SW.Blocks.CompileUnit>
    </ObjectList>
  </SW.Blocks.FC>
</Document>
"#;
    let folder = folder_with(&[("a.xml", DOCUMENT)]);
    let made = plcc(&folder, &["convert", "a.xml", "--to", "scl"]);
    let found = text(&made.stdout);
    let said = text(&made.stderr);
    let title = "texts in other languages are not in the new file, such as this one in `en-US`";
    assert!(said.contains(title) && said.contains("2 texts have several languages"), "{said}");
    assert!(said.contains("the comment of an element of an array is not in the new file"), "{said}");
    let wanted = "FUNCTION \"F\" : VOID\nVAR_TEMP\n    list : Array[0..1] of Int;\n    n : Int;                    // Zahl\nEND_VAR\nBEGIN\n    // Anfang\n    \
                  #n := 5;\nEND_FUNCTION\n";
    assert_eq!(found, wanted);
}

/// Sections have another order in XML, and comments stay with their declarations.
#[test]
fn comments_of_sections_stay_with_them() {
    let source = "FUNCTION_BLOCK \"Order\"\nVERSION : 0.1\nVAR\n    // about a\n    a : Int; // of a\n    // the last\nEND_VAR\n\
                  VAR_TEMP\n    t : Int; // of t\nEND_VAR\nVAR_INPUT\n    i : Int; // of i\nEND_VAR\n\
                  VAR CONSTANT\n    K : Int := 5; // of K\nEND_VAR\nVAR_IN_OUT\n    io : Int; // of io\nEND_VAR\nBEGIN\n    \
                  // first\n    #a := #i;\nEND_FUNCTION_BLOCK\n";
    let folder = folder_with(&[("a.scl", source)]);
    done(&folder, &["convert", "a.scl", "--to", "xml", "-o", "a.xml"]);
    let back = text(&plcc(&folder, &["convert", "a.xml", "--to", "scl"]).stdout);
    for found in [
        "VAR_INPUT\n    i : Int;                    // of i\nEND_VAR\n",
        "VAR_IN_OUT\n    io : Int;                   // of io\nEND_VAR\n",
        "VAR\n    // about a\n    // of a\n    // the last\n    a : Int;\nEND_VAR\n",
        "VAR_TEMP\n    t : Int;                    // of t\nEND_VAR\n",
        "VAR CONSTANT\n    K : Int := 5;               // of K\nEND_VAR\nBEGIN\n    // first\n    #a := #i;\n",
    ] {
        assert!(back.contains(found), "{found} in\n{back}");
    }
}

/// Constants stay before the variables that need them, with their comments.
#[test]
fn constants_stay_in_their_place() {
    let source = "FUNCTION \"F\" : VOID\n// about F\nCONST\n    // how many\n    MAX := 10;                  // at most\nEND_CONST\n\
                  VAR_TEMP\n    a : ARRAY[1..MAX] OF INT;   // values\nEND_VAR\nBEGIN\n    a[1] := MAX;\nEND_FUNCTION\n";
    let folder = folder_with(&[("a.scl", source)]);
    assert_eq!(text(&plcc(&folder, &["convert", "a.scl", "--to", "scl"]).stdout), source);
}

/// Comments of a block and of a structure are not those of the variable after them.
#[test]
fn comments_of_structures_stay_with_them() {
    let source = "TYPE \"T\"\nVERSION : 0.1\n//about T\n   STRUCT\n      a : Int;   // of a\n      // above the limits\n      \
                  limits : Struct   // of the limits\n         low : Int;\n         high : Int;   // of high\n      \
                  END_STRUCT;\n   END_STRUCT;\nEND_TYPE\n";
    let folder = folder_with(&[("a.scl", source)]);
    for to in ["xml", "plcopen"] {
        done(&folder, &["convert", "a.scl", "--to", to, "--cpu", "1511-1", "-o", "a.xml"]);
        let document = read(&folder, "a.xml");
        let member = if to == "xml" { "<Member Name=\"" } else { "<variable name=\"" };
        let of = |name: &str| {
            let at = document.find(&format!("{member}{name}\"")).unwrap_or_else(|| panic!("{name} in\n{document}"));
            let rest = &document[at + member.len()..];
            &rest[..rest.find(member).unwrap_or(rest.len())]
        };
        assert!(!of("low").contains("limits") && of("high").contains("of high"), "{document}");
        for comment in ["about T", "of a", "above the limits", "of the limits", "of high"] {
            assert_eq!(document.matches(comment).count(), 1, "{comment} in\n{document}");
        }
        assert!(!of("a").contains("about T"), "{document}");
    }
}

/// Comments of statements in an export are in the project as those of a source are.
#[test]
fn comments_of_exports_reach_projects() {
    let source = "//@ cpu s7-1200\nFUNCTION_BLOCK \"F\"\nVERSION : 0.1\nVAR\n    n : Int;   // of n\nEND_VAR\nBEGIN\n    // first\n    \
                  REGION start\n    #n := 1; // one\n    //@ assert #n == 1\n    IF #n = 1 THEN\n        // inside\n        #n := 2;\n    \
                  END_IF;\n    END_REGION\n    // last\nEND_FUNCTION_BLOCK\nORGANIZATION_BLOCK \"Main\"\nBEGIN\n    // call it\n    \
                  \"F_DB\"();\nEND_ORGANIZATION_BLOCK\nDATA_BLOCK \"F_DB\" \"F\"\nBEGIN\nEND_DATA_BLOCK\n";
    let folder = folder_with(&[("c.scl", source)]);
    let convert = |from: &str, to: &str| {
        let output = done(&folder, &["convert", from, "--to", to, "--cpu", "1214C"]);
        text(&output.stdout)
    };
    let project = convert("c.scl", "plcopen");
    for comment in ["// first", "// REGION start", "// one", "// inside", "// last", "// call it", ">of n<"] {
        assert_eq!(project.matches(comment).count(), 1, "{comment} in\n{project}");
    }
    write(&folder, "c.xml", &convert("c.scl", "xml"));
    assert_eq!(convert("c.xml", "plcopen"), project);
    // From there they come back into the block, although its data block is written first.
    write(&folder, "p.xml", &project);
    let scl = convert("p.xml", "scl");
    let body = scl.split("FUNCTION_BLOCK \"F\"").nth(1).and_then(|rest| rest.split("END_FUNCTION_BLOCK").next());
    for comment in ["// first", "// REGION start", "// one", "// inside", "// last"] {
        assert!(body.is_some_and(|body| body.contains(comment)), "{comment} in\n{scl}");
        assert_eq!(scl.matches(comment).count(), 1, "{comment} in\n{scl}");
    }
    // Also by way of an export.
    write(&folder, "q.xml", &convert("p.xml", "xml"));
    let scl = convert("q.xml", "scl");
    for comment in ["// first", "// REGION start", "// one", "// inside", "// last"] {
        assert_eq!(scl.matches(comment).count(), 1, "{comment} in\n{scl}");
    }
}

/// What follows the last statement is still in the block, also where that has no header.
#[test]
fn comments_at_the_end_stay() {
    let folder = folder_with(&[]);
    let plain = "      SET\n      =     M 0.0\n//@ assert M 0.0 == 1\n// the end\n";
    let framed = "ORGANIZATION_BLOCK OB 1\nBEGIN\nNETWORK\n      SET\n      =     M 0.0\n//@ assert M 0.0 == 1\n\
                  END_ORGANIZATION_BLOCK\n// the end\n";
    for (name, source) in [("plain", plain), ("framed", framed)] {
        write(&folder, &format!("{name}.stl"), source);
        for (to, extension) in [("xml", "xml"), ("lad", "s7dcl"), ("fbd", "s7dcl"), ("stl", "stl")] {
            let made = format!("{name}-{to}.{extension}");
            done(&folder, &["convert", &format!("{name}.stl"), "--to", to, "-o", &made]);
            let written = read(&folder, &made);
            assert!(written.contains("the end"), "{written}");
            expect_passed(&folder, &[&made, "--cpu", "315-2DP"], 1);
        }
    }
}

/// The comment of a network is in the texts of the networks, and not once more before it.
#[test]
fn comments_of_networks_are_written_once() {
    let source = "FUNCTION FC 1 : VOID\nBEGIN\nNETWORK\nTITLE = lamps\n// both\n      A     I 0.0;\n      // inside\n      =     Q 0.0;\n\
                  NETWORK\n// both\n      A     I 0.1;\n      =     Q 0.1;\nEND_FUNCTION\n";
    let folder = folder_with(&[("a.stl", source)]);
    done(&folder, &["convert", "a.stl", "--to", "lad", "-o", "a.s7dcl"]);
    let (networks, texts) = (read(&folder, "a.s7dcl"), read(&folder, "a.s7res"));
    let count = |text: &str, part: &str| text.matches(part).count();
    assert_eq!((count(&networks, "both"), count(&networks, "// inside")), (0, 1), "{networks}");
    assert_eq!((count(&networks, "S7_NetworkComment"), count(&texts, "both")), (2, 2), "{networks}\n{texts}");
}

/// The comment of a block is in the texts of a document and not once more in the document; in STL it is before BEGIN only.
#[test]
fn comments_of_blocks_are_written_once() {
    let source = "FUNCTION FC 1 : VOID\n// of the function\nBEGIN\n// in it\nNETWORK\n      A     I 0.0; // start\n      =     Q 0.0;\n      \
                  A     I 0.1; // next\n      =     Q 0.1;\nEND_FUNCTION\nDATA_BLOCK DB 1\n// of the data\nSTRUCT\n// of x\n x : INT;\n\
                  END_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n";
    let folder = folder_with(&[("a.stl", source)]);
    let list = text(&plcc(&folder, &["convert", "a.stl", "--to", "stl"]).stdout);
    assert!(list.starts_with("FUNCTION FC 1 : VOID\n// of the function\nBEGIN\n// in it\nNETWORK\n"), "{list}");
    done(&folder, &["convert", "a.stl", "--to", "lad", "-o", "a.s7dcl"]);
    let (networks, texts) = (read(&folder, "a.s7dcl"), read(&folder, "a.s7res"));
    for (comment, beside) in [("of the function", 1), ("of the data", 1), ("in it", 0), ("of x", 0)] {
        let found = (texts.matches(comment).count(), networks.matches(comment).count());
        assert_eq!(found, (beside, 1 - beside), "{comment} in\n{networks}\n{texts}");
    }
    // A comment of a contact is above its own rung.
    let lines: Vec<&str> = networks.lines().map(str::trim).collect();
    for (comment, contact) in [("// start", "Contact( %I0.0 )"), ("// next", "Contact( %I0.1 )")] {
        let at = lines.iter().position(|line| *line == comment);
        let next = at.and_then(|at| lines.get(at + 1));
        assert!(next.is_some_and(|line| line.contains(contact)), "{comment} in\n{networks}");
    }
}

/// A statement after END_REGION on its line is a statement, and its comment is not the comment of the region.
#[test]
fn statements_after_regions_are_written_once() {
    let source = "//@ cpu s7-1200\nFUNCTION \"F\" : Void\nBEGIN\n    REGION Last // first\n    END_REGION \"Add\"(); // a call\n    \
                  REGION More\n    END_REGION More // last\nEND_FUNCTION\n";
    let folder = folder_with(&[("a.scl", source)]);
    let list = text(&plcc(&folder, &["convert", "a.scl", "--to", "scl"]).stdout);
    assert_eq!(list.matches("\"Add\"();").count(), 1, "{list}");
    for found in ["REGION Last // first\n", "// a call\n", "END_REGION More // last\n"] {
        assert!(list.contains(found), "{found} in\n{list}");
    }
}
