//! Exports of the TIA Portal in XML.

use plcc_readers::xml::{self, XmlKind};
use proptest::prelude::*;

use super::input::{Notation, exchanged};
use super::reading::{of, read_with};

const NOTATION: Notation = Notation {
    sources: &[
        include_str!("../../../../../tests/parse/simatic-ml/seal-in.xml"),
        include_str!("../../../../../tests/parse/simatic-ml/flgnet-v2.xml"),
        include_str!("../../../../../tests/parse/simatic-ml/flgnet-v3.xml"),
        include_str!("../../../../../tests/parse/simatic-ml/flgnet-v4.xml"),
        include_str!("../../../../../tests/parse/simatic-ml/flgnet-v5.xml"),
        include_str!("../../../../../tests/parse/simatic-ml/scl-block.xml"),
        include_str!("../../../../../tests/parse/simatic-ml/stl-block.xml"),
        include_str!("../../../../../tests/parse/simatic-ml/mixed-block.xml"),
        include_str!("../../../../../tests/parse/simatic-ml/data.xml"),
        include_str!("../../../../../tests/parse/simatic-ml/graph-forms.xml"),
        include_str!("../../../../../tests/parse/simatic-ml/star-delta/StarDelta.xml"),
        include_str!("../../../../../tests/parse/simatic-ml/two-doses/TwoDoses_DB.xml"),
    ],
    pieces: WORDS,
    frames: &[],
};

/// Words that are replaced by others, so the text stays well-formed.
#[rustfmt::skip]
const WORDS: &[&str] = &[
    "Access", "Part", "Call", "CallInfo", "Wire", "NameCon", "IdentCon", "OpenCon", "Powerrail", "Symbol", "Component",
    "Constant", "ConstantValue", "Name", "UId", "Contact", "Coil", "Move", "TON", "Instance", "Negated", "TemplateValue",
    "Token", "NewLine", "Text", "StlStatement", "StlToken", "Parameter", "Member", "Datatype", "Section", "Sections",
    "StartValue", "Subelement", "Path", "Array[0..3] of", "Array[", "String[20]", "Struct", "LAD", "FBD", "SCL", "STL",
    "FlgNet", "O", "in1", "in", "out", "operand", "21", "27", "9999999999999999999999", "-1", "0", "", " ", "&#10;", "ä漢",
    "Step", "Transition", "Branch", "StepRef", "TransitionRef", "BranchRef", "EndConnection", "In", "Out", "Number", "AltBegin",
    "AltEnd", "SimBegin", "SimEnd", "Jump", "1", "2", "4294967295", "Action", "Qualifier", "Event", "S1", "CALL \"a\" (",
    "#a := ", "S_ALL", "&#xA;", "TrCoil", "SvCoil", "CMP>T", "GRAPH", "Graph", "Sequence", "FlgNet", "PreOperations", "T#",
    "Address", "Area", "BitOffset", "4294967295", "LocalVariable", "GlobalVariable", "Label", "(*", "'", "/*", "SW.Blocks.FC",
    "SW.Blocks.GlobalDB", "SW.Types.PlcStruct", "InstanceOfName", "1,2,3", "-9223372036854775808",
];

/// Reads a text; returns whether it is an export.
fn check(text: &str) -> bool {
    read_with(text, &of(None));
    matches!(xml::kind(text), Some(XmlKind::SimaticMl(_)))
}

#[test]
fn any_text_is_read() {
    NOTATION.test(|text| _ = check(text));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn exchanged_words_are_read(text in exchanged(NOTATION.sources, WORDS)) {
        check(&text);
    }
}

#[test]
fn the_files_are_exports() {
    for file in NOTATION.sources {
        assert!(check(file));
    }
}

#[test]
fn deep_nesting_is_refused() {
    let net = |inner: &str| {
        format!(
            "<Document><Engineering/><SW.Blocks.FC><AttributeList><Name>a</Name><ProgrammingLanguage>LAD</ProgrammingLanguage></AttributeList><ObjectList><SW.Blocks.CompileUnit><AttributeList><NetworkSource><FlgNet><Parts>{inner}</Parts></FlgNet></NetworkSource></AttributeList></SW.Blocks.CompileUnit></ObjectList></SW.Blocks.FC></Document>"
        )
    };
    let open = "<Access UId=\"1\" Scope=\"LocalVariable\"><Symbol><Component Name=\"a\">".repeat(5000);
    let close = "</Component></Symbol></Access>".repeat(5000);
    assert!(check(&net(&(open + &close))));
    let members = "<Member Name=\"a\" Datatype=\"Struct\">".repeat(5000) + &"</Member>".repeat(5000);
    assert!(check(&format!(
        "<Document><SW.Blocks.GlobalDB><AttributeList><Name>a</Name><Interface><Sections><Section Name=\"Static\">{members}</Section></Sections></Interface></AttributeList></SW.Blocks.GlobalDB></Document>"
    )));
}
