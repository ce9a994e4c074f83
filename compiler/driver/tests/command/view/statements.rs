//! Pictures of statement lists.

use std::collections::HashMap;
use std::fs;

use crate::plcc;

/// The pictures of the networks of a source, by their names: `FC_1_network_1`.
fn pictures(file: &str, source: &str, flags: &[&str]) -> HashMap<String, String> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    fs::write(folder.join(file), source).expect("the folder can be written");
    let output = plcc(folder, &[&["view", file, "-o", "drawings"][..], flags].concat());
    let files = fs::read_dir(folder.join("drawings"));
    let files = files.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    let named = |file: fs::DirEntry| {
        let name = file.file_name().to_string_lossy().replace(".svg", "");
        (name, fs::read_to_string(file.path()).expect("a picture"))
    };
    files.map(|file| named(file.expect("the folder can be read"))).collect()
}

/// Pictures for an S7-300.
const S7_300: &[&str] = &["--cpu", "315-2DP"];

/// STEP 7 writes `BLD 101` after CU and CD of a box.
#[test]
fn a_counter_with_bld_is_a_box() {
    let source = "FUNCTION FC 1 : VOID\nBEGIN\nNETWORK\nA I 0.0; CU C 5; BLD 101; A I 0.1; CD C 5; BLD 101; A I 0.2; L C#10; S C 5; \
                  A I 0.3; R C 5; L C 5; T MW 40; LC C 5; T MW 42; A C 5; = Q 4.5;\nNETWORK\nA I 0.4; CU C 6; BLD 101; NOP 0; \
                  A I 0.5; L C#3; S C 6; NOP 0; L C 6; T MW 44; NOP 0; A C 6; = Q 4.6;\nEND_FUNCTION\n";
    let pictures = pictures("count.awl", source, S7_300);
    for (number, title, others) in [(1, "S_CUD", ["CD", "CV_BCD"]), (2, "S_CU", ["CV", "CV_BCD"])] {
        let picture = &pictures[&format!("FC_1_network_{number}")];
        for text in [title, "CU", "S", "PV", "R", "CV"].into_iter().chain(others) {
            assert!(picture.contains(&format!(">{text}<")), "{text} in {picture}");
        }
        // The coil is at Q of the box, without a contact of the counter.
        assert_eq!(picture.matches(">C ").count(), 1, "{picture}");
    }
}

/// STEP 7 writes parallel boxes, and logic at the pin of a box, with bits of local data.
#[test]
fn a_local_bit_of_boxes_is_a_line() {
    let boxes = "NETWORK\nA I 0.0;\n= L 20.0;\nA L 20.0;\nJNB _001;\nL 1;\nT MW 30;\n_001: NOP 0;\nA L 20.0;\nJNB _002;\nL 2;\nT MW 32;\n\
                 _002: NOP 0;\nA L 20.0;\nA I 0.1;\n= Q 4.0;\n";
    let pin = "NETWORK\nA I 0.2;\nA I 0.3;\n= L 20.1;\nBLD 103;\nCALL FC 6 (a := L 20.1);\n";
    // Another rung is executed before the last branch.
    let late = "NETWORK\nA I 0.0;\n= L 20.2;\nA I 0.6;\nJNB _003;\nL 3;\nT MW 34;\n_003: NOP 0;\nA L 20.2;\n= Q 4.1;\n";
    let source = format!(
        "FUNCTION FC 5 : VOID\nBEGIN\n{boxes}{pin}{late}END_FUNCTION\nFUNCTION FC 6 : VOID\nVAR_INPUT\n  a : BOOL;\nEND_VAR\n\
         BEGIN\nNETWORK\nA #a;\n= Q 4.2;\nEND_FUNCTION\n"
    );
    let pictures = pictures("boxes.awl", &source, S7_300);
    for (number, counts) in [
        (1, [(">I 0.0<", 1), (">MOVE<", 2), (">L 20.0<", 0)]),
        (2, [(">I 0.3<", 1), (">a<", 1), (">L 20.1<", 0)]),
        (3, [(">I 0.6<", 1), (">MOVE<", 1), (">L 20.2<", 2)]),
    ] {
        let picture = &pictures[&format!("FC_5_network_{number}")];
        for (text, count) in counts {
            assert_eq!(picture.matches(text).count(), count, "{text} in {picture}");
        }
    }
}

/// Pointers, for which networks have no constants, are drawn as they are written.
#[test]
fn a_call_with_pointers_after_a_contact_is_a_box() {
    let source = "FUNCTION FC 1 : VOID\nBEGIN\nNETWORK\nA I 0.0; JNB _001;\nCALL SFC 20 (SRCBLK := P#M 0.0 BYTE 4, RET_VAL := MW 50, \
                  DSTBLK := P#DB10.DBX0.0 BYTE 4);\n_001: NOP 0;\nEND_FUNCTION\nDATA_BLOCK DB 10\nSTRUCT\n  a : DWORD;\nEND_STRUCT\n\
                  BEGIN\nEND_DATA_BLOCK\n";
    let pictures = pictures("move.awl", source, S7_300);
    let picture = &pictures["FC_1_network_1"];
    for text in ["I 0.0", "EN", "P#M 0.0 BYTE 4", "MW 50", "P#DB10.DBX0.0 BYTE 4"] {
        assert!(picture.contains(&format!(">{text}<")), "{text} in {picture}");
    }
}

/// STEP 7 writes `SAVE; BEC` for the coil RET.
#[test]
fn a_conditional_end_is_a_coil() {
    let source = "FUNCTION FC 1 : VOID\nBEGIN\nNETWORK\nA I 0.0; AN I 0.1; SAVE; BEC;\nNETWORK\nA I 0.2; = Q 0.0;\nEND_FUNCTION\n";
    let pictures = pictures("end.awl", source, S7_300);
    let picture = &pictures["FC_1_network_1"];
    for text in ["I 0.0", "I 0.1", "RET"] {
        assert!(picture.contains(&format!(">{text}<")), "{text} in {picture}");
    }
}

#[test]
fn marks_and_returns_of_the_s7_200_look_as_in_micro_win() {
    let source = "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nNetwork 1\nLSCR S0.1\nNetwork 2\nLD I0.0\nSCRT S0.2\nNetwork 3\nSCRE\n\
                  Network 4\nLD I0.1\nJMP 5\nNetwork 5\nLBL 5\nNetwork 6\nLD SM0.0\nCALL SBR0\nEND_ORGANIZATION_BLOCK\n\
                  SUBROUTINE_BLOCK Stop_all:SBR0\nBEGIN\nNetwork 1\nLD I0.2\nCRET\nEND_SUBROUTINE_BLOCK\n";
    let pictures = pictures("main.awl", source, &[]);
    for (name, text, is_box) in [
        ("OB_1_network_1", "SCR", true),
        ("OB_1_network_2", "SCRT", false),
        ("OB_1_network_3", "SCRE", false),
        ("OB_1_network_5", "LBL", true),
        ("OB_1_network_6", "Stop_all", true),
        ("SBR_0_network_1", "RET", false),
    ] {
        let picture = &pictures[name];
        assert!(picture.contains(&format!(">{text}<")), "{text} in {picture}");
        assert_eq!(picture.contains("class=\"b\""), is_box, "{text} in {picture}");
    }
}

/// STEP 7 writes branches with bits of local data. Bits that something else reads are drawn as coils.
#[test]
fn a_local_bit_of_a_branch_is_a_line() {
    let branch =
        "NETWORK\nA I 0.0;\nAN I 0.1;\n= L 20.0;\nA L 20.0;\nBLD 102;\n= Q 4.0;\nA L 20.0;\nA I 0.2;\n= Q 4.1;\n";
    let read = "NETWORK\nA I 0.0;\n= L 20.1;\nA L 20.1;\n= Q 4.2;\nA I 0.3;\nA L 20.1;\n= Q 4.3;\n";
    let joined = "NETWORK\nA I 0.0;\n= L 20.2;\nA L 20.2;\nA I 0.4;\nO;\nA L 20.2;\nA I 0.5;\n= Q 4.4;\n";
    // Another rung is executed before the last branch.
    let late = "NETWORK\nA I 0.0;\n= L 20.3;\nA I 0.6;\n= Q 4.5;\nA L 20.3;\nA Q 4.5;\n= Q 4.6;\n";
    let head = "FUNCTION FC 5 : VOID\nVAR_TEMP\n  own : ARRAY [0 .. 21] OF BYTE;\nEND_VAR\nBEGIN\n";
    let source = format!("{head}{branch}{read}{joined}{late}END_FUNCTION\n");
    let pictures = pictures("branch.stl", &source, S7_300);
    for (number, wanted) in [
        (1, [(">I 0.0<", 1), (">I 0.2<", 1), (">L 20.0<", 0)]),
        (2, [(">I 0.0<", 1), (">Q 4.3<", 1), (">L 20.1<", 3)]),
        (3, [(">I 0.0<", 1), (">Q 4.4<", 1), (">L 20.2<", 3)]),
        (4, [(">I 0.0<", 1), (">Q 4.5<", 2), (">L 20.3<", 2)]),
    ] {
        let picture = &pictures[&format!("FC_5_network_{number}")];
        for (text, count) in wanted {
            assert_eq!(picture.matches(text).count(), count, "{text} in {picture}");
        }
    }
}

/// SAVE does not end the string of logic, and NOT does not end the OR of branches: as rungs, such statements would show something else.
#[test]
fn logic_that_goes_on_is_text() {
    let saved = "NETWORK\nA I 0.0;\nSAVE;\nA I 0.1;\n= Q 4.0;\n";
    let inverted = "NETWORK\nA I 0.0;\nO;\nA I 0.1;\nNOT;\nA I 0.2;\n= Q 4.1;\n";
    let whole = "NETWORK\nA I 0.0;\nO;\nA I 0.1;\nNOT;\n= Q 4.2;\nSAVE;\nA I 0.3;\n= Q 4.3;\n";
    let source = format!("FUNCTION FC 5 : VOID\nBEGIN\n{saved}{inverted}{whole}END_FUNCTION\n");
    let pictures = pictures("open.awl", &source, S7_300);
    let mut names: Vec<&String> = pictures.keys().collect();
    names.sort();
    assert_eq!(names, ["FC_5_network_3"]);
}

/// As lines, branches would not show where the contact in the other network gets its value.
#[test]
fn a_local_bit_that_another_network_reads_is_a_coil() {
    let branch = "NETWORK\nA I 0.0;\nAN I 0.1;\n= L 20.0;\nA L 20.0;\nA I 0.2;\n= Q 4.0;\n";
    let reads = "NETWORK\nA L 20.0;\nA I 0.4;\n= Q 4.1;\n";
    let writes = "NETWORK\nA I 0.5;\n= L 20.1;\nA L 20.1;\nA I 0.6;\n= Q 4.2;\n";
    let own = "NETWORK\nA I 0.7;\n= L 20.1;\nA L 20.1;\nA I 1.0;\n= Q 4.3;\n";
    let boxes = "NETWORK\nA I 1.1;\n= L 20.2;\nA L 20.2;\nJNB _001;\nL 1;\nT MW 30;\n_001: NOP 0;\nA L 20.2;\nA I 1.2;\n= Q 4.4;\n";
    let byte = "NETWORK\nL LB 20;\nT MB 32;\n";
    let block = |networks: &str| format!("FUNCTION FC 5 : VOID\nBEGIN\n{networks}END_FUNCTION\n");
    let shared = pictures("shared.awl", &block(&[branch, reads, writes, own, boxes].concat()), S7_300);
    let with_byte = pictures("byte.awl", &block(&[boxes, byte].concat()), S7_300);
    for (pictures, number, text, count) in [
        (&shared, 1, ">L 20.0<", 2),
        (&shared, 2, ">L 20.0<", 1),
        (&shared, 3, ">L 20.1<", 0),
        (&shared, 4, ">L 20.1<", 0),
        (&shared, 5, ">L 20.2<", 0),
        (&with_byte, 1, ">L 20.2<", 3),
    ] {
        let picture = &pictures[&format!("FC_5_network_{number}")];
        assert_eq!(picture.matches(text).count(), count, "{text} in {picture}");
    }
}

/// A trace has a TIME as a duration, and the picture compares it as the slider of the document does.
#[test]
fn the_state_of_a_comparison_of_durations_is_drawn() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "DATA_BLOCK DB 1\nSTRUCT\n  t : TIME;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\nFUNCTION FC 1 : VOID\nBEGIN\n\
                  NETWORK\nL DB1.t; L T#1S; >D; = Q 0.0;\nNETWORK\nL DB1.t; L T#2S; >D; = Q 0.1;\nEND_FUNCTION\n";
    fs::write(folder.join("time.awl"), source).expect("the folder can be written");
    fs::write(folder.join("trace.csv"), "cycle,time_ms,DB1.t\n1,10,T#1s500ms\n").expect("the folder can be written");
    let output = plcc(folder, &["view", "time.awl", "--cpu", "315-2DP", "--state", "trace.csv", "-o", "drawings"]);
    for (network, flow) in [(1, false), (2, true)] {
        let picture = fs::read_to_string(folder.join(format!("drawings/FC_1_network_{network}.svg")));
        let picture = picture.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
        assert_eq!(picture.contains("class=\"w off\""), flow, "{picture}");
        assert!(!picture.contains("class=\"w un\""), "{picture}");
    }
}

/// `L C 5` loads the count, another value than the bit that `A C 5` scans. What `L T 5` loads has no time base, so a trace does not tell it.
#[test]
fn a_counter_that_is_compared_shows_its_count() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION FC 1 : VOID\nBEGIN\nNETWORK\nL C 5; L 2; >=I; = Q 0.0;\nNETWORK\nA C 5; = Q 0.1;\n\
                  NETWORK\nL T 5; L 2; <I; = Q 0.2;\nEND_FUNCTION\n";
    fs::write(folder.join("count.awl"), source).expect("the folder can be written");
    let trace = "cycle,time_ms,C5,C5.VALUE,T5,T5.VALUE\n1,10,1,7,1,S5T#1s\n";
    fs::write(folder.join("trace.csv"), trace).expect("the folder can be written");
    let output = plcc(folder, &["view", "count.awl", "--cpu", "315-2DP", "--state", "trace.csv", "-o", "drawings"]);
    let picture = |network: usize| {
        let picture = fs::read_to_string(folder.join(format!("drawings/FC_1_network_{network}.svg")));
        picture.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)))
    };
    for (network, value) in [(1, "7"), (2, "1")] {
        let picture = picture(network);
        let mut texts = picture.split("</text>").filter_map(|text| text.rsplit('>').next());
        assert!(texts.any(|text| text.trim() == value), "{value} in {picture}");
        assert!(!picture.contains("class=\"w off\""), "{picture}");
    }
    let unknown = picture(3);
    assert!(unknown.contains("class=\"w un\"") && !unknown.contains("class=\"w off\""), "{unknown}");
}
