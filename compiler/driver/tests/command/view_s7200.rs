//! `plcc view` of programs for the S7-200.

use std::fs;

use crate::plcc;

/// The texts in the pictures of the first `networks` networks of MAIN, in a program of these sources.
fn texts(sources: &[(&str, &str)], networks: usize) -> Vec<Vec<String>> {
    texts_of("OB_1", sources, networks)
}

/// As [`texts`], of a block.
fn texts_of(block: &str, sources: &[(&str, &str)], networks: usize) -> Vec<Vec<String>> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    for (name, text) in sources {
        fs::write(folder.join(name), text).expect("the folder can be written");
    }
    let output = plcc(folder, &["view", ".", "--partial", "-o", "drawings"]);
    let shown = |number: usize| {
        let picture = fs::read_to_string(folder.join(format!("drawings/{block}_network_{number}.svg")));
        let picture = picture.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
        let texts = picture.split("</text>").filter_map(|text| text.rsplit('>').next().map(str::to_owned));
        texts.filter(|text| !text.trim().is_empty()).collect::<Vec<String>>()
    };
    (1..=networks).map(shown).collect()
}

#[test]
fn a_call_has_the_parameters_of_a_subroutine_in_another_source() {
    let call = |name: &str| format!("NETWORK\nLD SM0.0\nCALL {name}, I0.0, 5, Q1.0\n");
    let calls: String = ["Motor", "SBR3", "Motor:SBR3"].map(call).concat();
    let main = format!("ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\n{calls}END_ORGANIZATION_BLOCK\n");
    let motor = "SUBROUTINE_BLOCK Motor:SBR3\nVAR_INPUT\nGo:BOOL;\nSpeed:INT;\nEND_VAR\nVAR_OUTPUT\nRuns:BOOL;\nEND_VAR\n\
                 BEGIN\nNETWORK\nLD #Go\nAW> #Speed, 0\n= #Runs\nEND_SUBROUTINE_BLOCK\n";
    let sources = [("main.awl", main.as_str()), ("motor.awl", motor)];
    for shown in texts(&sources, 3) {
        for text in ["Motor", "EN", "Go", "Speed", "Runs"] {
            assert!(shown.iter().any(|shown| shown == text), "{text} in {shown:?}");
        }
    }
}

#[test]
fn the_address_of_a_symbol_is_below_it() {
    let main = "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nNETWORK\nLD Begin:I0.0\n= Lamp:Q0.0\nEND_ORGANIZATION_BLOCK\n";
    let shown = texts(&[("main.awl", main)], 1).concat();
    for text in ["Begin", "I0.0", "Lamp", "Q0.0"] {
        assert!(shown.iter().any(|shown| shown == text), "{text} in {shown:?}");
    }
}

/// Micro/WIN exports each block with an empty network at least.
#[test]
fn an_empty_network_needs_no_reason() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let main = "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nNetwork 1 // Network Title\n// Network Comment\nLD SM0.0\n= Q0.0\n\
                Network 2\n// empty\nEND_ORGANIZATION_BLOCK\n";
    fs::write(folder.join("main.awl"), main).expect("the folder can be written");
    let output = plcc(folder, &["view", "main.awl", "--html", "page.html"]);
    let page = fs::read_to_string(folder.join("page.html"));
    let page = page.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    assert!(!page.contains("Not shown as LAD"), "{page}");
}

#[test]
fn local_variables_have_their_addresses() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let motor = "SUBROUTINE_BLOCK Motor:SBR3\nVAR_OUTPUT\nRuns:BOOL;\nEND_VAR\nVAR_INPUT\nGo:BOOL;\nSpeed:INT;\nEND_VAR\n\
                 VAR\nLast:REAL;\nEND_VAR\nBEGIN\nNETWORK\nLD L0.0\n= L3.0\nEND_SUBROUTINE_BLOCK\n";
    fs::write(folder.join("motor.awl"), motor).expect("the folder can be written");
    let output = plcc(folder, &["view", "motor.awl", "--html", "page.html"]);
    let page = fs::read_to_string(folder.join("page.html"));
    let page = page.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    for (name, ty, address) in
        [("Runs", "BOOL", "L3.0"), ("Go", "BOOL", "L0.0"), ("Speed", "INT", "LW1"), ("Last", "REAL", "LD4")]
    {
        let row = format!("\"{name}\",\"{ty}\",\"\",\"\",\"{address}\"");
        assert!(page.contains(&row), "{row} in {page}");
    }
}

#[test]
fn steps_labels_and_returns_have_the_names_of_micro_win() {
    let main = "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nNETWORK\nLSCR S0.1\nNETWORK\nLD I0.0\nSCRT S0.2\nNETWORK\nSCRE\nNETWORK\n\
                LD I0.1\nJMP 3\nNETWORK\nLBL 3\nEND_ORGANIZATION_BLOCK\n";
    let stop = "SUBROUTINE_BLOCK Stop:SBR0\nBEGIN\nNETWORK\nLD I0.0\nCRET\nEND_SUBROUTINE_BLOCK\n";
    let sources = [("main.awl", main), ("stop.awl", stop)];
    let mut shown = texts(&sources, 5);
    shown.extend(texts_of("SBR_0", &sources, 1));
    for texts in &mut shown {
        texts.sort();
    }
    let expected: [&[&str]; 6] = [
        &["S0.1", "SCR"],
        &["I0.0", "S0.2", "SCRT"],
        &["SCRE"],
        &["3", "I0.1", "JMP"],
        &["3", "LBL"],
        &["I0.0", "RET"],
    ];
    assert_eq!(shown, expected);
}

/// Micro/WIN writes a rung that leads to an input of a box as the assignment to a bit from L60.0 to L63.7.
#[test]
fn rungs_lead_to_the_inputs_of_a_call() {
    let network = |rungs: &str| format!("NETWORK\nLD SM0.0\n= L60.0\n{rungs}LD L60.0\nCALL Motor, L63.7, 5, Q1.0\n");
    let rungs = ["LD I0.0\nAN I0.1\n= L63.7\n", "LD I0.0\n= L63.7\n= Q0.0\n"].map(network).concat();
    let main = format!("ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\n{rungs}END_ORGANIZATION_BLOCK\n");
    let motor = "SUBROUTINE_BLOCK Motor:SBR3\nVAR_INPUT\nGo:BOOL;\nSpeed:INT;\nEND_VAR\nVAR_OUTPUT\nRuns:BOOL;\nEND_VAR\n\
                 BEGIN\nNETWORK\nLD #Go\nAW> #Speed, 0\n= #Runs\nEND_SUBROUTINE_BLOCK\n";
    let shown = texts(&[("main.awl", main.as_str()), ("motor.awl", motor)], 2);
    let has = |network: usize, text: &str| shown[network].iter().any(|shown| shown == text);
    for text in ["SM0.0", "I0.0", "I0.1", "Motor", "EN", "Go", "5", "Q1.0"] {
        assert!(has(0, text), "{text} in {shown:?}");
    }
    assert!(!has(0, "L60.0") && !has(0, "L63.7"), "{shown:?}");
    // An assignment to a bit that is not at the end of its rung is one of the program.
    assert!(!has(1, "L60.0") && has(1, "L63.7") && has(1, "Q0.0"), "{shown:?}");
}

#[test]
fn calls_of_libraries_have_the_parameters_of_the_library() {
    let calls = "NETWORK\nLD SM0.0\nCALL MBUS_MSG, I0.0, 2, 0, 40001, 4, &VB100, M2.1, MB8\nNETWORK\nLD SM0.1\nCALL MBUS_MSG, 1\n";
    let main = format!("ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\n{calls}END_ORGANIZATION_BLOCK\n");
    let shown = texts(&[("main.awl", main.as_str())], 2);
    for text in ["MBUS_MSG", "First", "Slave", "RW", "Addr", "Count", "DataPtr", "Done", "Error"] {
        assert!(shown[0].iter().any(|shown| shown == text), "{text} in {shown:?}");
    }
    // Another version of the library has other parameters.
    assert!(!shown[1].iter().any(|shown| shown == "First"), "{shown:?}");
}

#[test]
fn en_that_a_subroutine_declares_is_no_further_pin() {
    let main = "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nNETWORK\nLD I0.0\nCALL Motor, 5, Q1.0\nEND_ORGANIZATION_BLOCK\n";
    let motor = "SUBROUTINE_BLOCK Motor:SBR3\nVAR_INPUT\nEN:BOOL;\nSpeed:INT;\nEND_VAR\nVAR_OUTPUT\nRuns:BOOL;\nEND_VAR\n\
                 BEGIN\nNETWORK\nLDW> #Speed, 0\n= #Runs\nEND_SUBROUTINE_BLOCK\n";
    let mut shown = texts(&[("main.awl", main), ("motor.awl", motor)], 1).concat();
    shown.sort();
    assert_eq!(shown, ["5", "EN", "I0.0", "Motor", "Q1.0", "Runs", "Speed"]);
}

/// The bit of a timer is another value than the current value that a comparison reads.
#[test]
fn a_timer_that_is_compared_shows_its_current_value() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let main = "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nNETWORK\nLD Delay\n= Q0.0\nNETWORK\nLDW>= Delay, 20\n= Q0.1\n\
                END_ORGANIZATION_BLOCK\n";
    let trace = "cycle,time_ms,Delay,Delay.VALUE\n1,10,0,30\n";
    for (name, text) in [("main.awl", main), ("symbols.txt", "Delay\tT37\t\n"), ("trace.csv", trace)] {
        fs::write(folder.join(name), text).expect("the folder can be written");
    }
    let arguments = ["view", "main.awl", "symbols.txt", "--state", "trace.csv", "-o", "drawings"];
    let output = plcc(folder, &arguments);
    for (network, value) in [(1, "0"), (2, "30")] {
        let picture = fs::read_to_string(folder.join(format!("drawings/OB_1_network_{network}.svg")));
        let picture = picture.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
        let mut texts = picture.split("</text>").filter_map(|text| text.rsplit('>').next());
        assert!(texts.any(|text| text.trim() == value), "{value} in {picture}");
    }
}

/// The rail of a step has power while its S bit is 1.
#[test]
fn a_step_that_is_not_active_has_no_power() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let step = |bit: &str, output: &str| format!("NETWORK\nLSCR {bit}\nNETWORK\nLD I0.0\n= {output}\nNETWORK\nSCRE\n");
    let steps = [step("S0.1", "Q0.0"), step("S0.2", "Q0.1")].concat();
    let main = format!("ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\n{steps}END_ORGANIZATION_BLOCK\n");
    fs::write(folder.join("main.awl"), main).expect("the folder can be written");
    let trace = "cycle,time_ms,I0.0,S0.1,S0.2,Q0.0,Q0.1\n1,10,1,1,0,1,0\n";
    fs::write(folder.join("trace.csv"), trace).expect("the folder can be written");
    let output = plcc(folder, &["view", "main.awl", "--state", "trace.csv", "-o", "drawings"]);
    for (network, has_power) in [(2, true), (5, false)] {
        let picture = fs::read_to_string(folder.join(format!("drawings/OB_1_network_{network}.svg")));
        let picture = picture.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
        assert_eq!(picture.contains("class=\"w on\""), has_power, "{picture}");
        assert_eq!(picture.contains("class=\"w off\""), !has_power, "{picture}");
    }
}
