//! Documents of SIMATIC SD, and networks made of statements.

use super::{done, expect_passed, folder_with, plcc, read, text, write};

/// SCL that shows neither the TIA Portal nor STEP 7 V5 is that of its CPU.
#[test]
fn plain_scl_becomes_a_document_if_its_cpu_is_of_the_portal() {
    let scl = "FUNCTION_BLOCK Sum\nVAR_INPUT\n  a : INT;\nEND_VAR\nVAR\n  n : INT;\nEND_VAR\nBEGIN\n  IF a > n THEN RETURN; END_IF;\nEND_FUNCTION_BLOCK\n";
    let folder = folder_with(&[("a.scl", scl)]);
    let refused = plcc(&folder, &["convert", "a.scl", "--to", "sd"]);
    assert_eq!(refused.status.code(), Some(3), "{}", text(&refused.stdout));
    assert!(text(&refused.stderr).contains("name its CPU with `--cpu`"), "{}", text(&refused.stderr));
    done(&folder, &["convert", "a.scl", "--to", "sd", "--cpu", "s7-1500", "-o", "a.s7dcl"]);
    done(&folder, &["check", "a.s7dcl", "--cpu", "s7-1500"]);
}

/// Elements are spelt as their author did, and pins that nothing is connected to are shown.
#[test]
fn documents_come_back_as_they_were() {
    let source = "FUNCTION_BLOCK Line\n    VAR_INPUT\n        a, b : Bool;            // of both\n    END_VAR\n    \
                  VAR\n        one, \"two 2\", \"IF\" : Int := 5;\n        t : TON_TIME;\n    END_VAR\n    \
                  { S7_Language := \"LAD\" }\n    NETWORK\n        \
                  RUNG wire#powerrail  Contact( #a )  { S7_Templates := \"time_type := Time\" }  #t.TON( pt := T#2s, et => )  \
                  Coil( #b )  END_RUNG\n        \
                  RUNG wire#powerrail  Contact( #b )  S_CU( counter := %C3, pv := C#12, r := #a, cv => %MW12, cv_bcd => )  \
                  I_Coil( #b )  END_RUNG\n    END_NETWORK\nEND_FUNCTION_BLOCK\n";
    let folder = folder_with(&[("a.s7dcl", source)]);
    let output = plcc(&folder, &["convert", "a.s7dcl", "--to", "sd"]);
    assert_eq!(text(&output.stdout), source, "{}", text(&output.stderr));
    let source = "FUNCTION_BLOCK Gates\n    VAR\n        left, right : _.Valve;\n        osc : TON_TIME;\n        e, t : Bool;\n    \
                  END_VAR\n    { S7_Language := \"FBD\" }\n    NETWORK\n        RUNG #e  A()  S_Coil( #t )  END_RUNG\n        \
                  RUNG #t  { S7_Templates := \"time_type := Time\" }  NOT  #osc.TON( pt := T#1s, et => )  Coil( #t )  END_RUNG\n        \
                  RUNG #t  P_Coil( operand := #e, bit := %M0.0 )  END_RUNG\n        \
                  RUNG #t  A()  Inc( %MW2 )  Return( #t )  END_RUNG\n    END_NETWORK\nEND_FUNCTION_BLOCK\n";
    write(&folder, "gates.s7dcl", source);
    let output = plcc(&folder, &["convert", "gates.s7dcl", "--to", "sd"]);
    assert_eq!(text(&output.stdout), source, "{}", text(&output.stderr));
    // Gates have names of their own: a comparison is spelt as in the language that it is drawn in.
    let source = "FUNCTION F : Void\n    VAR_INPUT\n        a, b : Int;\n    END_VAR\n    \
                  { S7_Language := \"LAD\" }\n    NETWORK\n        \
                  RUNG wire#powerrail  { S7_Templates := \"SrcType := Int\" }  GT_Contact( in1 := #a, in2 := #b )  \
                  Coil( %Q0.0 )  END_RUNG\n    END_NETWORK\nEND_FUNCTION\n";
    write(&folder, "b.s7dcl", source);
    let output = plcc(&folder, &["convert", "b.s7dcl", "--to", "fbd"]);
    let found = text(&output.stdout);
    assert!(found.contains(" GT( in1 := #a, in2 := #b )") && found.contains("a, b : Int;"), "{found}");
}

/// Attributes and the texts that they name stay as their author wrote them, in all languages of the texts.
#[test]
fn attributes_and_texts_of_documents_stay() {
    let source = r#"{ S7_BlockTitle := "MLC_9"; S7_Optimized := "TRUE"; S7_Version := "0.1" }
FUNCTION_BLOCK "Lamp"
    // on and off
    VAR_INPUT
        { S7_MLC := "MLC_7" } start : Bool;
        { S7_Visibility := "Hidden"; S7_MLC := "MLC_8" } "stop" : Bool;
    END_VAR
    { S7_NetworkTitle := "MLC_5"; S7_Language := "FBD" }
    NETWORK
        RUNG #start  Coil( %Q0.0 )  END_RUNG
    END_NETWORK
    NETWORK
        RUNG wire#powerrail  Contact( #start )  Coil( %Q0.1 )  END_RUNG
    END_NETWORK
END_FUNCTION_BLOCK

{ S7_BlockNumber := "" }
DATA_BLOCK Lamp_DB : "Lamp"
{ S7_StandardRetain := "TRUE"; S7_Version := "0.2" }
NON_RETAIN
start := TRUE;
END_DATA_BLOCK

{ S7_BlockComment := "MLC_6" }
TYPE
    { S7_Version := "0.3" }
    Point : STRUCT
        x : Int;
    END_STRUCT;
    Line : STRUCT
        first, last : Point;
    END_STRUCT;
END_TYPE
"#;
    let mut texts = String::from("MultiLingualTexts:\n");
    for id in 5..10 {
        texts.push_str(&format!("  - id: MLC_{id}\n    de-DE: Text {id}\n    fr-FR: Texte {id}\n"));
    }
    let folder = folder_with(&[("a.s7dcl", source)]);
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let plain = text(&plcc(&folder, &["convert", "a.s7dcl", "--to", "sd"]).stdout);
    assert_eq!(words(&plain), words(source), "{plain}");
    write(&folder, "a.s7res", &texts);
    for (to, name) in [("sd", "b.s7dcl"), ("lad", "c.s7dcl")] {
        done(&folder, &["convert", "a.s7dcl", "--to", to, "-o", name]);
        assert_eq!(read(&folder, &name.replace("s7dcl", "s7res")), texts);
    }
    assert_eq!(words(&read(&folder, "b.s7dcl")), words(source));
    let ladder = read(&folder, "c.s7dcl");
    for found in ["{ S7_NetworkTitle := \"MLC_5\"; S7_Language := \"LAD\" }", "{ S7_Language := \"LAD\" }\n    NETWORK"]
    {
        assert!(ladder.contains(found), "{found} in\n{ladder}");
    }
}

/// Data of a block with standard access are retentive in sources unless they say NON_RETAIN, in documents only if those say so.
#[test]
fn data_stay_retentive_or_not() {
    let block = |name: &str, flag: &str| {
        format!(
            "DATA_BLOCK \"{name}\"\n{{ S7_Optimized_Access := 'FALSE' }}\nVERSION : 0.1\n{flag}STRUCT\n    n : Int;\nEND_STRUCT;\nBEGIN\n\
             END_DATA_BLOCK\n"
        )
    };
    let source = format!("{}\n{}", block("Kept", ""), block("Lost", "NON_RETAIN\n"));
    let folder = folder_with(&[("a.scl", &source)]);
    let convert = |from: &str, to: &str| {
        let output = done(&folder, &["convert", from, "--to", to]);
        text(&output.stdout)
    };
    let document = convert("a.scl", "sd");
    assert!(
        document.contains("S7_StandardRetain := \"TRUE\"; S7_Version := \"0.1\" }\nDATA_BLOCK Kept\n"),
        "{document}"
    );
    assert!(document.contains("DATA_BLOCK Lost\nNON_RETAIN\n"), "{document}");
    let said = text(&plcc(&folder, &["convert", "a.scl", "--to", "xml", "--cpu", "s7-1500"]).stderr);
    assert!(said.contains("the word `NON_RETAIN` of `Lost` is not in the file") && !said.contains("`Kept`"), "{said}");
    let plain = "{ S7_Optimized := \"FALSE\" }\nDATA_BLOCK Lost\nVAR\n    n : Int;\nEND_VAR\nEND_DATA_BLOCK\n";
    write(&folder, "b.s7dcl", plain);
    assert!(convert("b.s7dcl", "scl").contains("{ S7_Optimized_Access := 'FALSE' }\nNON_RETAIN\nSTRUCT\n"));
    // The same by way of XML, whose members say it.
    write(&folder, "b.xml", &convert("b.s7dcl", "xml"));
    assert!(convert("b.xml", "scl").contains("{ S7_Optimized_Access := 'FALSE' }\nNON_RETAIN\nSTRUCT\n"));
    let back = convert("b.xml", "sd");
    assert!(
        back.contains("{ S7_Optimized := \"FALSE\"; S7_StandardRetain := \"FALSE\" }\nDATA_BLOCK Lost\n"),
        "{back}"
    );
    let kept = plain.replace("\"FALSE\" }", "\"FALSE\"; S7_StandardRetain := \"TRUE\" }");
    write(&folder, "c.s7dcl", &kept);
    let output = plcc(&folder, &["convert", "c.s7dcl", "--to", "xml", "-o", "c.xml"]);
    assert_eq!((output.status.code(), text(&output.stderr).as_str()), (Some(0), ""));
    let source = convert("c.xml", "scl");
    assert!(source.contains("{ S7_Optimized_Access := 'FALSE' }\nVAR RETAIN\n"), "{source}");
    // An instance has no members in XML.
    let instance = "{ S7_Optimized := \"FALSE\" }\nDATA_BLOCK One : TON_TIME\nEND_DATA_BLOCK\n";
    write(&folder, "d.s7dcl", instance);
    let said = text(&plcc(&folder, &["convert", "d.s7dcl", "--to", "xml"]).stderr);
    assert!(said.contains("the file does not say that the data of `One` are not retentive"), "{said}");
}

/// Another notation has one language of the texts.
#[test]
fn languages_that_stay_behind_are_named() {
    let source = "{ S7_BlockComment := \"MLC_1\" }\nDATA_BLOCK Store\nVAR\n    n : Int;\nEND_VAR\nEND_DATA_BLOCK\n";
    let texts = "MultiLingualTexts:\n  - id: MLC_1\n    de-DE: Lager\n    en-US: store\n";
    let folder = folder_with(&[("a.s7dcl", source), ("a.s7res", texts)]);
    let made = plcc(&folder, &["convert", "a.s7dcl", "--to", "scl"]);
    assert!(text(&made.stdout).contains("// store\n"), "{}", text(&made.stdout));
    let said = text(&made.stderr);
    assert!(said.contains("texts in other languages are not in the new file, such as those in `de-DE`"), "{said}");
    let made = plcc(&folder, &["convert", "a.s7dcl", "--to", "sd", "-o", "b.s7dcl"]);
    assert_eq!((made.status.code(), text(&made.stderr).as_str()), (Some(0), ""));
}

/// The names in the header of a block come back from XML.
#[test]
fn headers_of_documents_stay() {
    let source = "{ S7_Author := \"Ann\"; S7_Family := \"Press\"; S7_HeaderName := \"P01\"; S7_Version := \"0.2\" }\n\
                  DATA_BLOCK Store\nVAR\n    n : Int;\nEND_VAR\nEND_DATA_BLOCK\n";
    let folder = folder_with(&[("a.s7dcl", source)]);
    let made = plcc(&folder, &["convert", "a.s7dcl", "--to", "xml", "-o", "a.xml"]);
    assert_eq!((made.status.code(), text(&made.stderr).as_str()), (Some(0), ""));
    let document = read(&folder, "a.xml");
    assert!(document.contains("<HeaderName>P01</HeaderName>"), "{document}");
    assert_eq!(text(&plcc(&folder, &["convert", "a.xml", "--to", "sd"]).stdout), source);
}

/// A block of networks in SCL is one in SCL, and has the titles of its networks as comments.
#[test]
fn networks_in_scl_become_scl() {
    let folder = folder_with(&[]);
    let convert = |from: &str, to: &str| {
        let output = done(&folder, &["convert", from, "--to", to]);
        text(&output.stdout)
    };
    let source = "FUNCTION \"Half\" : Int\n{ S7_Optimized_Access := 'TRUE' }\nVERSION : 0.1\nVAR_INPUT\n    \
                  k : Int;                    // of k\nEND_VAR\nBEGIN\n    // half of it\n    IF #k > 0 THEN\n        \
                  #Half := #k / 2;        // half\n    END_IF;\n    // end\nEND_FUNCTION\n\n\
                  ORGANIZATION_BLOCK \"Main\"\nBEGIN\n    %MW0 := \"Half\"(k := 4);\n    //@ assert %MW0 == 2\n\
                  END_ORGANIZATION_BLOCK\n";
    write(&folder, "a.scl", source);
    write(&folder, "a.s7dcl", &convert("a.scl", "sd"));
    assert_eq!(convert("a.s7dcl", "scl"), source);

    let document = "{ S7_PreferredLanguage := \"LAD\" }\nFUNCTION Both : Void\n    \
                    { S7_NetworkTitle := \"MLC_1\"; S7_Language := \"SCL\" }\n    NETWORK\n        // begin\n        \
                    %MW0 := 1;\n    END_NETWORK\n    // between\n    { S7_Language := \"SCL\" }\n    NETWORK\n        \
                    %MW2 := 2;\n    END_NETWORK\nEND_FUNCTION\n";
    write(&folder, "b.s7dcl", document);
    write(&folder, "b.s7res", "MultiLingualTexts:\n  - id: MLC_1\n    en-US: First\n");
    let wanted = "FUNCTION \"Both\" : Void\nBEGIN\n    // First\n    // begin\n    %MW0 := 1;\n    // between\n    \
                  %MW2 := 2;\nEND_FUNCTION\n";
    assert_eq!(convert("b.s7dcl", "scl"), wanted);
    // In XML it has networks of its own, which a block in SCL has not.
    let document = convert("b.s7dcl", "xml");
    assert!(document.contains("<Name>Both</Name>\n      <ProgrammingLanguage>LAD</ProgrammingLanguage>"), "{document}");
}

/// Types of the program need no quotes in SIMATIC SD, and keep their letters where they need them.
#[test]
fn types_of_the_program_are_in_quotes() {
    let source = "TYPE\n    Door : STRUCT\n        open : Bool;\n    END_STRUCT;\nEND_TYPE\n\
                  FUNCTION_BLOCK Gate\n    VAR\n        d : Door;\n        list : Array[0..1] of Door;\n    END_VAR\n    \
                  { S7_Language := \"LAD\" }\n    NETWORK\n        \
                  RUNG wire#powerrail  Contact( #d.open )  Coil( #list[1].open )  END_RUNG\n    END_NETWORK\nEND_FUNCTION_BLOCK\n\
                  DATA_BLOCK Gate_DB : Gate\nEND_DATA_BLOCK\n\
                  ORGANIZATION_BLOCK Main\n    { S7_Language := \"LAD\" }\n    NETWORK\n        \
                  RUNG wire#powerrail  \"Gate_DB\"()  END_RUNG\n    END_NETWORK\nEND_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("a.s7dcl", source)]);
    let convert = |from: &str, to: &str| {
        let output = done(&folder, &["convert", from, "--to", to]);
        text(&output.stdout)
    };
    let list = convert("a.s7dcl", "stl");
    for found in
        ["    d : \"Door\";\n", "    list : ARRAY[0..1] OF \"Door\";\n", "DATA_BLOCK \"Gate_DB\"\n\"Gate\"\nBEGIN\n"]
    {
        assert!(list.contains(found), "{found} in\n{list}");
    }
    let document = convert("a.s7dcl", "xml");
    for found in [
        "<Member Name=\"d\" Datatype=\"&quot;Door&quot;\"/>",
        "<Member Name=\"list\" Datatype=\"Array[0..1] of &quot;Door&quot;\"/>",
        "<InstanceOfName>Gate</InstanceOfName>",
        "<CallInfo Name=\"Gate\" BlockType=\"FB\">",
    ] {
        assert!(document.contains(found), "{found} in\n{document}");
    }
    assert!(!document.contains("OfSystemLibElement"), "{document}");
    let data = "TYPE\n    Door : STRUCT\n        open : Bool;\n    END_STRUCT;\nEND_TYPE\n\
                DATA_BLOCK Store\nVAR\n    d : Door;\nEND_VAR\nEND_DATA_BLOCK\n";
    write(&folder, "b.s7dcl", data);
    assert!(convert("b.s7dcl", "scl").contains("    d : \"Door\";\n"));
    // A timer in a data block is called as one in a variable is.
    let timer = "DATA_BLOCK \"Wait\" TON_TIME\nBEGIN\nEND_DATA_BLOCK\nFUNCTION \"F\" : VOID\nBEGIN\n    \
                 \"Wait\"(IN := TRUE, PT := T#1s);\nEND_FUNCTION\n";
    write(&folder, "c.scl", timer);
    let document = convert("c.scl", "xml");
    assert!(document.contains("<CallInfo Name=\"TON_TIME\" BlockType=\"FB\""), "{document}");
}

/// The number decides when an organization block with a name of its own runs.
#[test]
fn numbers_of_documents_stay() {
    let source = "{ S7_BlockNumber := \"35\"; S7_Version := \"0.1\" }\nORGANIZATION_BLOCK Control\n    \
                  { S7_Language := \"LAD\" }\n    NETWORK\n        RUNG wire#powerrail  Contact( %I0.0 )  Coil( %Q0.0 )  END_RUNG\n    \
                  END_NETWORK\nEND_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("a.s7dcl", source)]);
    done(&folder, &["convert", "a.s7dcl", "--to", "stl", "--cpu", "315-2DP", "-o", "b.stl"]);
    let list = read(&folder, "b.stl");
    assert!(list.contains("{ S7_BlockNumber := '35' }\n"), "{list}");
    let main = "ORGANIZATION_BLOCK OB 1\nBEGIN\nNETWORK\n      SET;\nEND_ORGANIZATION_BLOCK\n";
    write(&folder, "main.stl", main);
    let found = plcc(&folder, &["xref", "b.stl", "main.stl", "--cpu", "315-2DP"]);
    let found = format!("{}{}", text(&found.stdout), text(&found.stderr));
    assert!(found.contains("OB35 (Control)"), "{found}");
}

/// Names of parameters with blanks are in quotes.
#[test]
fn parameters_of_blocks_have_any_names() {
    let source = "FUNCTION F : Void\n    { S7_Language := \"LAD\" }\n    NETWORK\n        \
                  RUNG wire#powerrail  \"Other FC\"( \"a b\" := 1, \"c/d\" => %MW2, e := %MW4 )  END_RUNG\n    END_NETWORK\nEND_FUNCTION\n";
    let folder = folder_with(&[("a.s7dcl", source)]);
    assert_eq!(text(&plcc(&folder, &["convert", "a.s7dcl", "--to", "sd"]).stdout), source);
    // Words of the language are names in quotes, as their author wrote them.
    let source = "FUNCTION \"F\" : VOID\nVAR_INPUT\n    \"END\" : INT;\n    \"Größe\" : INT;\n    Länge : INT;\nEND_VAR\nBEGIN\n    \
                  \"DB 1\".\"a b\"[#\"END\"].\"if\" := #\"Größe\" + #Länge;\nEND_FUNCTION\n";
    write(&folder, "a.scl", source);
    assert_eq!(text(&plcc(&folder, &["convert", "a.scl", "--to", "scl"]).stdout), source);
    let source = "DATA_BLOCK \"D\"\nSTRUCT\n    \"IF\" : INT;\n    x : STRUCT\n        \"FOR\" : INT;\n    END_STRUCT;\nEND_STRUCT;\n\
                  BEGIN\n    \"IF\" := 5;\n    x.\"FOR\" := 6;\nEND_DATA_BLOCK\n";
    write(&folder, "d.scl", source);
    assert_eq!(text(&plcc(&folder, &["convert", "d.scl", "--to", "scl"]).stdout), source);
    // XML has no quotes.
    plcc(&folder, &["convert", "d.scl", "--to", "xml", "--cpu", "s7-1500", "-o", "d.xml"]);
    let found = text(&plcc(&folder, &["convert", "d.xml", "--to", "scl"]).stdout);
    assert!(found.contains("\n    \"IF\" : Int") && found.contains("\n        \"FOR\" : Int"), "{found}");
}

/// `"tag":P` is an input or output itself, not a tag with this name.
#[test]
fn direct_access_stays_direct() {
    let scl = "FUNCTION \"F\" : VOID\nVAR_TEMP\n    x : BOOL;\nEND_VAR\nBEGIN\n    #x := \"Tag\":P;\n    \
               #x := \"Motor\".run:P;\n    \"Out\":P := #x;\nEND_FUNCTION\n";
    let ladder = "FUNCTION F : Void\n    { S7_Language := \"LAD\" }\n    NETWORK\n        \
                  RUNG wire#powerrail  Contact( \"Tag\":P )  Coil( \"Motor\".run:P )  END_RUNG\n    END_NETWORK\nEND_FUNCTION\n";
    let folder = folder_with(&[("a.scl", scl), ("b.s7dcl", ladder)]);
    let convert = |name: &str, to: &str| {
        let output = done(&folder, &["convert", name, "--to", to]);
        text(&output.stdout)
    };
    assert_eq!(convert("a.scl", "scl"), scl);
    assert_eq!(convert("b.s7dcl", "sd"), ladder);
    for (name, back) in [("a.scl", "scl"), ("b.s7dcl", "sd")] {
        let document = convert(name, "xml");
        for component in ["Tag", "run"] {
            let wanted = format!("<Component Name=\"{component}\" SimpleAccessModifier=\"Periphery\"/>");
            assert!(document.contains(&wanted), "{wanted} in\n{document}");
        }
        write(&folder, "c.xml", &document);
        let again = convert("c.xml", back);
        assert!(again.contains("\"Tag\":P") && again.contains("\"Motor\".run:P"), "{again}");
    }
    let list = convert("b.s7dcl", "stl");
    assert!(list.contains("A     \"Tag\":P;") && list.contains("=     \"Motor\".run:P;"), "{list}");
}

/// In LAD and FBD assertions stand between networks: a network of STL with assertions among its statements is divided.
#[test]
fn assertions_divide_networks() {
    let source = "//@ cpu 315-2DP\nORGANIZATION_BLOCK OB 1\nBEGIN\nNETWORK\nTITLE =two values\n      L     W#16#1234\n      T     MW 10\n\
                  //@ assert MB 10 == B#16#12\n//@ assert MB 11 == B#16#34\n      AN    M 20.0\n      =     M 20.1\n      =     M 20.2\n\
                  //@ assert MB 20 == B#16#06\n// the end\n      SET\n      S     M 30.0\nEND_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("a.stl", source)]);
    for to in ["lad", "fbd"] {
        let name = format!("{to}.s7dcl");
        done(&folder, &["convert", "a.stl", "--to", to, "-o", &name]);
        let tested = plcc(&folder, &["test", &name]);
        let written = read(&folder, &name);
        let said = format!("{}{}", text(&tested.stdout), text(&tested.stderr));
        assert!(said.contains("3 passed, 0 failed"), "{said}{written}");
        assert_eq!(written.matches("S7_NetworkTitle").count(), 1, "{written}");
    }
    // The signal goes on after the assertion.
    write(&folder, "b.stl", &source.replace("      SET\n", ""));
    let made = plcc(&folder, &["convert", "b.stl", "--to", "lad", "-o", "b.s7dcl"]);
    assert!(text(&made.stderr).contains("stands inside its network"), "{}", text(&made.stderr));
    // Networks have no registers.
    write(&folder, "c.stl", &source.replace("MB 20 == B#16#06", "STW.RLO == 1"));
    let made = done(&folder, &["convert", "c.stl", "--to", "fbd", "-o", "c.s7dcl"]);
    assert!(text(&made.stderr).contains("this assertion checks a register"), "{}", text(&made.stderr));
    // Between networks no data block is open.
    write(&folder, "d.stl", &source.replace("MB 20 == B#16#06", "DBB 0 == 0"));
    let made = done(&folder, &["convert", "d.stl", "--to", "lad", "-o", "d.s7dcl"]);
    assert!(text(&made.stderr).contains("this assertion checks the data block that is open"), "{}", text(&made.stderr));
}

/// The forms in which a counter has its value, and a flip-flop its operand.
#[test]
fn counters_and_flip_flops_have_their_usual_form() {
    let source = "      A     M 1.0\n      L     C#10\n      S     C 1\n      A     M 1.1\n      S     M 2.0\n      \
                  A     M 1.2\n      R     M 2.0\n      A     M 2.0\n      =     M 2.1\n";
    let folder = folder_with(&[("a.stl", source)]);
    done(&folder, &["convert", "a.stl", "--to", "lad", "-o", "a.s7dcl"]);
    let drawn = read(&folder, "a.s7dcl");
    for found in ["SC_Coil( counter := %C1, pv := C#10 )", "S_SR( operand := %M2.0, r1 := "] {
        assert!(drawn.contains(found), "{found} in\n{drawn}");
    }
    let list = text(&plcc(&folder, &["convert", "a.s7dcl", "--to", "stl"]).stdout);
    assert!(list.contains("      L     C#10;\n      S     C 1;\n"), "{list}");
}

/// A number at a LREAL stays a LREAL; with more digits than a constant of a statement has, it is refused.
#[test]
fn long_numbers_in_networks() {
    let source = "//@ cpu s7-1500\nFUNCTION \"Take\" : VOID\nVAR_INPUT\n  share : LREAL; ratio : REAL;\nEND_VAR\nBEGIN\n\
                  END_FUNCTION\nORGANIZATION_BLOCK OB 1\nBEGIN\nNETWORK\n\
                  \x20     CALL  \"Take\" (share := 0.1, ratio := 0.1);\nEND_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("a.stl", source)]);
    let made = plcc(&folder, &["convert", "a.stl", "--to", "lad"]);
    let written = text(&made.stdout);
    assert!(written.contains("share := LREAL#0.1, ratio := REAL#0.1"), "{written}{}", text(&made.stderr));
    write(&folder, "b.stl", &source.replace("0.1,", "0.123456789,"));
    let made = plcc(&folder, &["convert", "b.stl", "--to", "lad"]);
    assert_eq!(made.status.code(), Some(3), "{}", text(&made.stdout));
    assert!(text(&made.stderr).contains("more than six digits at a LREAL"), "{}", text(&made.stderr));
}

/// A document of SIMATIC SD comes back as the same text up to white space, with types in the letters of its author.
#[test]
fn types_keep_the_letters_of_their_author() {
    let source = r#"TYPE
    Point : STRUCT
        x : Array[0..15] of Bool;
        name : String[8];
    END_STRUCT;
END_TYPE

FUNCTION_BLOCK Lamp
    VAR_INPUT
        start : Bool;
        place : Point;
        wait : TON_TIME;
        names : Array[0..3] of String[8];
    END_VAR
    { S7_Language := "LAD" }
    NETWORK
        RUNG wire#powerrail  Contact( #start )  Coil( %Q0.0 )  END_RUNG
    END_NETWORK
END_FUNCTION_BLOCK

DATA_BLOCK Lamp_DB : Lamp
END_DATA_BLOCK

FUNCTION Nothing : Void
    { S7_Language := "FBD" }
    NETWORK
        RUNG %I0.0  Coil( %Q0.1 )  END_RUNG
    END_NETWORK
END_FUNCTION
"#;
    let folder = folder_with(&[("a.s7dcl", source)]);
    let made = done(&folder, &["convert", "a.s7dcl", "--to", "sd"]);
    let written = text(&made.stdout);
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert_eq!(words(&written), words(source), "{written}");
    // Names of types in other sources have the letters of the TIA Portal.
    let stl = "FUNCTION FC 1 : VOID\nVAR_TEMP\n  n : DINT; t : ARRAY [0..3] OF WORD;\nEND_VAR\nBEGIN\nNETWORK\n      SET\n      =     M 0.0\n\
               END_FUNCTION\n";
    write(&folder, "b.stl", stl);
    let written = text(&plcc(&folder, &["convert", "b.stl", "--to", "lad"]).stdout);
    assert!(written.contains("n : DInt;") && written.contains("t : Array[0..3] of Word;"), "{written}");
}

/// What to do first with a block that is not in networks depends on its language.
#[test]
fn blocks_without_networks_say_what_comes_first() {
    let folder = folder_with(&[("a.scl", "FUNCTION \"F\" : VOID\nBEGIN\n  RETURN;\nEND_FUNCTION\n")]);
    let output = plcc(&folder, &["convert", "a.scl", "--to", "lad"]);
    assert_eq!(output.status.code(), Some(3));
    let said = text(&output.stderr);
    assert!(said.contains("convert it with `--to stl`, and the result with `--to lad`"), "{said}");
}

/// A block in SCL is a network in SCL with its comments.
#[test]
fn scl_becomes_a_network() {
    let source = "//@ cpu s7-1500\nFUNCTION_BLOCK \"Count\"\n{ S7_Optimized_Access := 'TRUE' }\nVERSION : 0.1\nVAR_INPUT\n    step : Int;\nEND_VAR\n\
                  VAR\n    sum : Int;   // so far\nEND_VAR\nBEGIN\n    // one more\n    IF #step > 0 THEN\n        #sum := #sum + #step;   // add\n    \
                  END_IF;\n    // the end\nEND_FUNCTION_BLOCK\nDATA_BLOCK \"Count_DB\"\n{ S7_Optimized_Access := 'TRUE' }\nVERSION : 0.1\n\
                  \"Count\"\nBEGIN\nEND_DATA_BLOCK\nORGANIZATION_BLOCK \"Main\"\n{ S7_Optimized_Access := 'TRUE' }\nVERSION : 0.1\nBEGIN\n    \
                  \"Count_DB\"(step := 3);\n    \"Count_DB\"(step := 4);\n    //@ assert \"Count_DB\".sum == 7\nEND_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("a.scl", source)]);
    let convert = |from: &str, to: &str, name: &str| {
        done(&folder, &["convert", from, "--to", to, "-o", name]);
    };
    convert("a.scl", "xml", "a.xml");
    for (from, name) in [("a.scl", "b.s7dcl"), ("a.xml", "c.s7dcl")] {
        convert(from, "sd", name);
        let written = read(&folder, name);
        for comment in ["// one more", "// add", "// the end", "so far"] {
            assert_eq!(written.matches(comment).count(), 1, "{comment} in\n{written}");
        }
        expect_passed(&folder, &[name, "--cpu", "s7-1500"], 1);
    }
}

/// A declaration before the definition, as generators write it in SCL, is not a second block of a document.
#[test]
fn declarations_before_definitions_are_left_out() {
    let source = "//@ cpu s7-1500\nFUNCTION \"Double\" : Int\nVAR_INPUT\n    v : Int;\nEND_VAR\nBEGIN\nEND_FUNCTION\n\
                  FUNCTION \"Double\" : Int\nVAR_INPUT\n    v : Int;\nEND_VAR\nBEGIN\n    #Double := 2 * #v;\nEND_FUNCTION\n";
    let folder = folder_with(&[("a.scl", source)]);
    done(&folder, &["convert", "a.scl", "--to", "sd", "-o", "a.s7dcl"]);
    let document = read(&folder, "a.s7dcl");
    assert_eq!(document.matches("END_FUNCTION").count(), 1, "{document}");
    done(&folder, &["check", "a.s7dcl", "--cpu", "s7-1500"]);
}

/// A sign in a network in SCL keeps its place after an operator.
#[test]
fn signs_in_networks_stay() {
    let source = "FUNCTION F : Void\n    VAR_TEMP\n        i : Int;\n    END_VAR\n    { S7_Language := \"SCL\" }\n    NETWORK\n        \
                  #i := #i - -5 + (-7);\n        #i := -#i * -2;\n    END_NETWORK\nEND_FUNCTION\n";
    let folder = folder_with(&[("a.s7dcl", source)]);
    assert_eq!(text(&plcc(&folder, &["convert", "a.s7dcl", "--to", "sd"]).stdout), source);
}

/// Attributes after a name, as SCL has them, belong to it too.
#[test]
fn attributes_after_names_stay() {
    let source =
        "DATA_BLOCK D\nVAR\n    n { ExternalWritable := \"FALSE\" } : Int;\n    m : Int;\nEND_VAR\nEND_DATA_BLOCK\n";
    let folder = folder_with(&[("a.s7dcl", source)]);
    let made = text(&plcc(&folder, &["convert", "a.s7dcl", "--to", "sd"]).stdout);
    assert!(made.contains("    { ExternalWritable := \"FALSE\" } n : Int;\n    m : Int;\n"), "{made}");
}

/// A document has no place for the start values of a data block that is an array.
#[test]
fn start_values_of_array_data_blocks_are_told() {
    let source = "DATA_BLOCK \"List\"\n{ S7_Optimized_Access := 'TRUE' }\nVERSION : 0.1\nArray[0..3] of Int := [7, 8, 9, 10]\nBEGIN\nEND_DATA_BLOCK\n";
    let folder = folder_with(&[("a.scl", source)]);
    let made = done(&folder, &["convert", "a.scl", "--to", "sd"]);
    assert!(text(&made.stderr).contains("no start values of a data block that is an array"), "{}", text(&made.stderr));
}
