//! Tests of whole sources.

use plcc_diag::{Diagnostic, FileId};

use crate::ast::SourceUnit;
use crate::{ParseOptions, ast_text};

fn read(text: &str) -> (SourceUnit, Vec<Diagnostic>) {
    let options = ParseOptions { pragmas: true, ..ParseOptions::default() };
    super::parse(FileId(0), text, &options)
}

/// The tree of a source without mistakes.
fn tree(text: &str) -> String {
    let (unit, diagnostics) = read(text);
    assert!(super::is_s7200(text), "not taken for the S7-200: {text:?}");
    assert_eq!(diagnostics, [], "{text:?}");
    ast_text(&unit)
}

/// The statements of a source without mistakes, without their depth.
fn statements(text: &str) -> Vec<String> {
    let options = ParseOptions { pragmas: true, ..ParseOptions::default() };
    let (unit, diagnostics) = super::parse(FileId(0), text, &options);
    assert_eq!(diagnostics, [], "{text:?}");
    ast_text(&unit).lines().skip(3).map(|line| line.trim().to_owned()).collect()
}

/// Code and place of each message.
fn messages(text: &str) -> Vec<String> {
    let options = ParseOptions { pragmas: true, ..ParseOptions::default() };
    let (_, diagnostics) = super::parse(FileId(0), text, &options);
    let place = |d: &Diagnostic| format!("{} {}", d.code.name(), &text[d.primary.span.range()]);
    diagnostics.iter().map(place).collect()
}

#[test]
fn an_export_with_all_blocks() {
    let text = "ORGANIZATION_BLOCK MAIN:OB1\r\nTITLE=Water // plant\r\n// by hand\r\nBEGIN\r\nNetwork 1 // Pump\r\n// starts it\r\nLD     SM0.0\r\n\
                CALL   Scale, AIW0, VD10 // scaled\r\nEND_ORGANIZATION_BLOCK\r\n\
                SUBROUTINE_BLOCK Scale:SBR3\r\nTITLE=\r\nVAR_INPUT\r\nRaw:INT;  // from the module\r\nEND_VAR\r\nVAR_OUTPUT\r\nResult:REAL;\r\nEND_VAR\r\n\
                VAR\r\nTmp:DINT;\r\nEND_VAR\r\nBEGIN\r\nNetwork 1 \r\nLD     SM0.0\r\nITD    #Raw, #Tmp\r\nDTR    Tmp, #Result\r\nEND_SUBROUTINE_BLOCK\r\n\
                INTERRUPT_BLOCK 定时:INT0\r\nBEGIN\r\nNETWORK\r\nLD     SM0.0\r\nINCW   VW2\r\nEND_INTERRUPT_BLOCK\r\n";
    let expected = "source en\n  main \"MAIN\" 1\n    title \"Water // plant\"\n    comment \"by hand\"\n    network 1 \"Pump\"\n      comment \"starts it\"\n      \
                    Load SM0.0\n      Call symbol Scale, AIW0, VD10 // scaled\n  subroutine \"Scale\" 3\n    input Raw : INT // from the module\n    \
                    output Result : REAL\n    temp Tmp : DINT\n    network 1\n      Load SM0.0\n      Itd #Raw, #Tmp\n      Dtr symbol Tmp, #Result\n  \
                    interrupt \"定时\" 0\n    network\n      Load SM0.0\n      IncW VW2\n";
    assert_eq!(tree(text), expected);
}

#[test]
fn names_of_blocks() {
    let head = |label: &str| {
        let text = format!("SUBROUTINE_BLOCK {label}\nBEGIN\nEND_SUBROUTINE_BLOCK\n");
        tree(&text).lines().nth(1).unwrap_or_default().trim().to_owned()
    };
    assert_eq!(head("SBR3"), "subroutine 3");
    assert_eq!(head("读数（1）:SBR4"), "subroutine \"读数（1）\" 4");
    assert_eq!(head("Mixer"), "subroutine \"Mixer\"");
    assert_eq!(head("SBR_0 : SBR0 // first"), "subroutine \"SBR_0\" 0");
}

#[test]
fn a_flat_list() {
    let text = "NETWORK 1\nLD SM0.0\nCALL 0\nNETWORK 2\nMEND\nNETWORK 3 // fill\nSBR 0\nNETWORK 4\nLD SM0.0\nINCB VB0\nNETWORK 5\nRET\nINT 1\nLD SM0.0\nCRETI\nRETI\n";
    let expected = "source en\n  main bare\n    network 1\n      Load SM0.0\n      Call int 0\n    network 2\n      Mend\n  subroutine 0 bare\n    \
                    network 3 \"fill\"\n    network 4\n      Load SM0.0\n      IncB VB0\n    network 5\n      Ret\n  interrupt 1 bare\n    network\n      \
                    Load SM0.0\n      Creti\n      Reti\n";
    assert_eq!(tree(text), expected);
}

#[test]
fn a_file_without_header() {
    let text = "// Mixer\n// of line 2\nNETWORK 1 \nTITLE=Start\n\tLD\tI0.0\n// once\nEU\t// edge\n=Q0.0\nRET\n";
    let expected = "source en\n  main bare\n    comment \"Mixer\"\n    comment \"of line 2\"\n    network 1 \"Start\"\n      Load I0.0\n      \
                    RisingEdge // once | edge\n      Assign Q0.0\n      Ret\n";
    assert_eq!(tree(text), expected);
}

#[test]
fn statements_of_all_forms() {
    let text = "LD     I0.0;\nldw>= vw2, 4\nAW= VW2,3\nLDB<VB9,VB7\nLDS=\"a b\", VB10\nLDS 1\nFND<> VW100, 5, AC1\n=I Q0.0\n=Q0.0\n= Q0.1\n+I 5, VW0\n-D *AC1, VD4\n*R 2.5, VD8\n\
                /I -7, VW2\nTON T37, +50\nHDEF 0 0\nMOVD &VB100, AC1\nMOVW *#ptr, *VD4\nLDR> VD0, -2.5E3\nMOVW 16#7FFF, AQW0\nMOVB 2#0101, SMB34\nMOVB B#16#FF, LB3\n\
                MOVB 'A', VB0\nATCH INT0, 10\nCALL SBR4, L60.0, ON, &VB4\nLDDW= VD0, VD4\nMOV_B 1, VB0\nLD \"Motor\"\nLD DB1.DBX5.0\nJMP 255\nLD S0.3\nLDW=VW0,T37";
    let expected = [
        "Load I0.0",
        "LDW>= VW2, int 4",
        "AW= VW2, int 3",
        "LDB< VB9, VB7",
        "LDS= text \"a b\", VB10",
        "LoadStack int 1",
        "FindNotEqual VW100, int 5, AC1",
        "AssignNow Q0.0",
        "Assign Q0.0",
        "Assign Q0.1",
        "AddI int 5, VW0",
        "SubD *AC1, VD4",
        "MulR real 2.5, VD8",
        "DivI int -7, VW2",
        "Ton T37, int 50",
        "Hdef int 0, int 0",
        "MovD &VB100, AC1",
        "MovW *#ptr, *VD4",
        "LDR> VD0, real -2500.0",
        "MovW 16#7FFF, AQW0",
        "MovB 16#5, SMB34",
        "MovB byte 16#FF, LB3",
        "MovB chars 'A', VB0",
        "Atch block INT0, int 10",
        "Call block SBR4, L60.0, bool true, &VB4",
        "LDD= VD0, VD4",
        "MovB int 1, VB0",
        "Load \"Motor\"",
        "Load V5.0",
        "Jmp int 255",
        "Load S0.3",
        "LDW= VW0, T37",
    ];
    assert_eq!(statements(text), expected);
}

#[test]
fn german_sources() {
    let text = "LD E0.0\nUN A1.2\nULD\nUW>= Z5, 3\nUI E0.1\nUENO\n= A0.0\nMOVW AEW0, AAW2\nTON T37, 5\n";
    let (unit, diagnostics) = read(text);
    assert_eq!(diagnostics, []);
    let expected = "source de\n  main bare\n    network\n      Load I0.0\n      AndNot Q1.2\n      AndLoad\n      AW>= C5, int 3\n      AndNow I0.1\n      \
                    AndEno\n      Assign Q0.0\n      MovW AIW0, AQW2\n      Ton T37, int 5\n";
    assert_eq!(ast_text(&unit), expected);
    assert_eq!(messages("LD E0.0\nU E0.1\nU E0.2\nA I0.3\n= Q0.0\n"), ["P0108 A"]);
    // Area letters of either set.
    assert_eq!(messages("LD E0.0\nA I0.1\n= A0.0\n"), [""; 0]);
}

#[test]
fn data_blocks() {
    let text = "DATA_BLOCK DB1\nTITLE=Recipe\nBEGIN\nVB0    10, 16#1F, 'A' // bytes\nVW10   -5, 300\nVD20 1.5, 70000\nV40 200, 300, 1.0\n       7\nVB60 'plain'\nVB80 \"text\"\nSpeed 5\n\"Speed\" 6\nEND_DATA_BLOCK\n";
    let expected = "source en\n  data\n    VB0 := int 10, 16#1F, chars 'A'\n    VW10 := int -5, int 300\n    VD20 := real 1.5, int 70000\n    \
                    V40 := int 200, int 300, real 1.0\n    next := int 7\n    VB60 := chars 'plain'\n    VB80 := text \"text\"\n    symbol Speed := int 5\n    \
                    \"Speed\" := int 6\n";
    assert_eq!(tree(text), expected);
    assert_eq!(tree("// recipe\nVW0 1, 2\n 3\n"), "source en\n  data\n    VW0 := int 1, int 2\n    next := int 3\n");
    assert_eq!(messages("DATA_BLOCK DB1\nVW0\nVW2 ,\nVW4 5\n"), ["P0206 DATA_BLOCK", "P0201 VW0", "P0201 ,"]);
}

#[test]
fn assertions() {
    let text = "//@ cpu 224\nLD I0.0\n//@ assert S0 == 1\n//@ assert TW37 >= 5\n//@ assert S0.0 == 0\n//@ assert ENO <> 0\n//@ assert AC0 == -5\n//@ sleep 100 ms\n//@   ^^^ P0101\n";
    assert_eq!(
        tree(text),
        "source en\n  pragma \"cpu 224\"\n  main bare\n    network\n      Load I0.0\n      assert stack 0 == int 1\n      assert TW37 >= int 5\n      \
         assert S0.0 == int 0\n      assert eno <> int 0\n      assert AC0 == int -5\n      pragma \"sleep 100 ms\"\n"
    );
    assert_eq!(messages("LD I0.0\n//@ assert VW0 5\n"), ["P0701 5"]);
    assert_eq!(messages("ORGANIZATION_BLOCK OB1\nBEGIN\nEND_ORGANIZATION_BLOCK\n//@ sleep 5\n"), ["P0701 //@ sleep 5"]);
}

#[test]
fn all_mistakes_in_one_run() {
    let text = "LD I0.8\nMOWB 1, VB0\nL 5\nMOVW VW0,, VW2\nLD %I0.0\nm1: LD I0.0\nMOVW 'abc, VW0\nMOVD 99999999999, VD0\nTON T37, T#5s\nA( I0.0\n5 LD\nTON T37 5 +\n= Q0.0\nLDI0.0\nADD_I 1, VW0\n";
    let expected = [
        "P0405 I0.8",
        "P0202 MOWB",
        "P0202 L",
        "P0201 ,",
        "P0207 %I0.0",
        "P0207 m1",
        "P0102 '",
        "P0104 99999999999",
        "P0103 T#5s",
        "P0101 (",
        "P0201 5",
        "P0201 +",
        "P0202 LDI0.0",
        "P0202 ADD_I",
    ];
    assert_eq!(messages(text), expected);
    let (unit, _) = super::parse(FileId(0), text, &ParseOptions::default());
    assert!(ast_text(&unit).contains("Assign Q0.0"));
}

#[test]
fn frames_that_do_not_fit() {
    for (text, expected) in [
        ("SUBROUTINE_BLOCK a:INT0\nBEGIN\nEND_SUBROUTINE_BLOCK\n", "P0206 INT0"),
        ("SUBROUTINE_BLOCK\nBEGIN\nEND_SUBROUTINE_BLOCK\n", "P0206 SUBROUTINE_BLOCK"),
        ("ORGANIZATION_BLOCK a:OB2\nBEGIN\nEND_ORGANIZATION_BLOCK\n", "P0206 OB2"),
        ("SUBROUTINE_BLOCK a:SBR0\nBEGIN\nLD I0.0\n", "P0206 SUBROUTINE_BLOCK a:SBR0"),
        ("SUBROUTINE_BLOCK a:SBR0\nBEGIN\nEND_INTERRUPT_BLOCK\n", "P0206 END_INTERRUPT_BLOCK"),
        ("LD I0.0\nEND_SUBROUTINE_BLOCK\n", "P0206 END_SUBROUTINE_BLOCK"),
        ("SUBROUTINE_BLOCK a:SBR0\nVAR_INPUT\nx:INT;\nBEGIN\nEND_SUBROUTINE_BLOCK\n", "P0209 VAR_INPUT"),
        ("SUBROUTINE_BLOCK a:SBR0\nVAR_INPUT\nx INT;\nEND_VAR\nBEGIN\nEND_SUBROUTINE_BLOCK\n", "P0209 INT"),
        ("INTERRUPT_BLOCK a:INT0\nVAR_INPUT\nx:INT;\nEND_VAR\nBEGIN\nEND_INTERRUPT_BLOCK\n", "P0410 VAR_INPUT"),
        ("VAR_GLOBAL\nx AT %I0.0:BOOL;\nEND_VAR\nLD I0.0\n", "P0207 VAR_GLOBAL"),
        ("ORGANIZATION_BLOCK OB1\nBEGIN\nEND_ORGANIZATION_BLOCK\nLD I0.0\nA I0.1\n", "P0206 LD I0.0"),
        ("NETWORK 1\nLD I0.0\nNETWORK 1\nLD I0.1\n", "P0211 NETWORK 1"),
        ("LD I 0.0\n", "P0211 I 0.0"),
    ] {
        assert_eq!(messages(text), [expected], "{text:?}");
    }
}

#[test]
fn the_family_of_a_source_is_found() {
    for text in [
        "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nA I0.0\nEND_ORGANIZATION_BLOCK\n",
        "SUBROUTINE_BLOCK a\nBEGIN\nEND_SUBROUTINE_BLOCK\n",
        "Network 1\nLD I0.0\n= Q0.0\n",
        "A I0.0\n= V5.0\n",
        "DATA_BLOCK DB1\nVB0 5\nEND_DATA_BLOCK\n",
        // A data block whose addresses are symbols.
        "// page\nSetpoint 50\nLimit -1.5, 16#FF // of it\n 7\n",
        "LD E0.0\nU E0.1\n= A0.0\n",
        // With a slip.
        "LD I0.0\nINC VW0\n",
        "LD I0.0 (* start *)\n= Q0.0\n",
        "LD I0.0\nVW0 := 5\n",
        // A title may begin like a statement.
        "NETWORK 1\nTITLE: A pump\nLD I0.0\n= Q0.0\n",
        "TITLE=Pump (left)\nNETWORK 1\nLD I0.0\n= Q0.0\n",
    ] {
        assert!(super::is_s7200(text), "{text:?}");
    }
    for text in [
        "",
        "A I 0.0\n= Q 4.0\n",
        "      U     E 0.0;\n      SPB   m1;\nm1:   NOP 0;\n",
        "FUNCTION FC 1 : VOID\nBEGIN\nNETWORK\n LD I 0.0;\n LDN I 0.1;\nEND_FUNCTION\n",
        "ORGANIZATION_BLOCK OB 1\nBEGIN\nL MW 2\nT MW 4\nEND_ORGANIZATION_BLOCK\n",
        "DATA_BLOCK DB 1\nSTRUCT\n a : INT;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n",
        "FOR i := 0 TO 5 DO\n x := 1;\nEND_FOR;\n",
        "L 5\nT MW 2\nSD T 1\nR T 1\n",
        "x := 5;\nEND_IF;\n",
        "Setpoint 50\n",
        "Setpoint 50\nLimit is 1.5\n",
        "A I0.0\nJMP m1\nm1: NOP 0\n",
    ] {
        assert!(!super::is_s7200(text), "{text:?}");
    }
}

#[test]
fn each_row_is_read_in_both_sets() {
    use super::{Insn, mnemonics};
    use crate::stl::Mnemonics;
    for insn in mnemonics::all().collect::<Vec<Insn>>() {
        for set in [Mnemonics::En, Mnemonics::De] {
            let mnemonic = insn.mnemonic(set);
            let line = super::raw::lines(&mnemonic);
            let head = mnemonics::head(&mnemonic, &line[0]).expect("a mnemonic begins a line");
            assert_eq!(head.mnemonic, *mnemonic);
            assert_eq!(mnemonics::any(&mnemonic, set), Some(insn), "{mnemonic}");
        }
    }
}

#[test]
fn lines_are_read_one_by_one() {
    let are_empty = |text: &str| -> Vec<bool> { super::raw::each_line(text).map(|line| line.is_empty()).collect() };
    assert_eq!(are_empty(""), [true]);
    assert_eq!(are_empty("LD I0.0"), [false]);
    assert_eq!(are_empty("\nLD I0.0\n\n= Q0.0 // end\n"), [true, false, true, false, true]);
}
