//! Whatever an export in XML contains, reading it ends soon, without a panic, and every message and span has a place in the text.

mod mutate;

use plcc_diag::FileId;
use plcc_readers::xml::{self, XmlKind};
use plcc_readers::{ReadOptions, parse, tokens_text};
use plcc_syntax::ast_text;
use proptest::prelude::*;

/// Exports with most forms of the format.
const FILES: [&str; 12] = [
    include_str!("../../../tests/parse/simatic-ml/seal-in.xml"),
    include_str!("../../../tests/parse/simatic-ml/flgnet-v2.xml"),
    include_str!("../../../tests/parse/simatic-ml/flgnet-v3.xml"),
    include_str!("../../../tests/parse/simatic-ml/flgnet-v4.xml"),
    include_str!("../../../tests/parse/simatic-ml/flgnet-v5.xml"),
    include_str!("../../../tests/parse/simatic-ml/scl-block.xml"),
    include_str!("../../../tests/parse/simatic-ml/stl-block.xml"),
    include_str!("../../../tests/parse/simatic-ml/mixed-block.xml"),
    include_str!("../../../tests/parse/simatic-ml/data.xml"),
    include_str!("../../../tests/parse/simatic-ml/graph-forms.xml"),
    include_str!("../../../tests/parse/simatic-ml/star-delta/StarDelta.xml"),
    include_str!("../../../tests/parse/simatic-ml/two-doses/TwoDoses_DB.xml"),
];

/// Words that are replaced by others, so the text stays well-formed.
const WORDS: &[&str] = &[
    "Access",
    "Part",
    "Call",
    "CallInfo",
    "Wire",
    "NameCon",
    "IdentCon",
    "OpenCon",
    "Powerrail",
    "Symbol",
    "Component",
    "Constant",
    "ConstantValue",
    "Name",
    "UId",
    "Contact",
    "Coil",
    "Move",
    "TON",
    "Instance",
    "Negated",
    "TemplateValue",
    "Token",
    "NewLine",
    "Text",
    "StlStatement",
    "StlToken",
    "Parameter",
    "Member",
    "Datatype",
    "Section",
    "Sections",
    "StartValue",
    "Subelement",
    "Path",
    "Array[0..3] of",
    "Array[",
    "String[20]",
    "Struct",
    "LAD",
    "FBD",
    "SCL",
    "STL",
    "FlgNet",
    "O",
    "in1",
    "in",
    "out",
    "operand",
    "21",
    "27",
    "9999999999999999999999",
    "-1",
    "0",
    "",
    " ",
    "&#10;",
    "ä漢",
    "Step",
    "Transition",
    "Branch",
    "StepRef",
    "TransitionRef",
    "BranchRef",
    "EndConnection",
    "In",
    "Out",
    "Number",
    "AltBegin",
    "AltEnd",
    "SimBegin",
    "SimEnd",
    "Jump",
    "1",
    "2",
    "4294967295",
    "Action",
    "Qualifier",
    "Event",
    "S1",
    "CALL \"a\" (",
    "#a := ",
    "S_ALL",
    "&#xA;",
    "TrCoil",
    "SvCoil",
    "CMP>T",
    "GRAPH",
    "Graph",
    "Sequence",
    "FlgNet",
    "PreOperations",
    "T#",
    "Address",
    "Area",
    "BitOffset",
    "4294967295",
    "LocalVariable",
    "GlobalVariable",
    "Label",
    "(*",
    "'",
    "/*",
    "SW.Blocks.FC",
    "SW.Blocks.GlobalDB",
    "SW.Types.PlcStruct",
    "InstanceOfName",
    "1,2,3",
    "-9223372036854775808",
];

/// Reads a text; returns whether it was XML that could be read.
fn check(text: &str) -> bool {
    let options = ReadOptions { pragmas: true, ..ReadOptions::default() };
    let (unit, messages) = parse(FileId(0), text, &options);
    ast_text(&unit);
    tokens_text(text, &options);
    for message in messages {
        let range = message.primary.span.range();
        assert!(text.get(range.clone()).is_some(), "no place in the text: {range:?}, {}", message.title);
        assert!(!message.title.is_empty());
    }
    if let Some(overlay) = &unit.overlay {
        assert_eq!(overlay.len(), text.len());
        for block in &unit.blocks {
            assert!(text.get(block.span().range()).is_some());
        }
    }
    matches!(xml::kind(text), Some(XmlKind::SimaticMl(_)))
}

#[test]
fn the_files_are_exports() {
    for file in FILES {
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

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn cut_files_are_read(file in 0..FILES.len(), place: prop::sample::Index) {
        let (front, back) = mutate::cut(FILES[file], place);
        check(front);
        check(back);
    }

    #[test]
    fn changed_bytes_are_read(
        file in 0..FILES.len(),
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..6usize, 0..WORDS.len()), 1..4),
    ) {
        check(&mutate::mutated(FILES[file], edits, WORDS));
    }

    #[test]
    fn exchanged_words_are_read(
        file in 0..FILES.len(),
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..WORDS.len()), 1..8),
    ) {
        check(&exchanged(FILES[file], edits));
    }
}

/// `text` with words in place of names, values and texts of elements: usually still well-formed.
fn exchanged(text: &str, edits: Vec<(prop::sample::Index, usize)>) -> String {
    let mut text = text.to_owned();
    for (place, word) in edits {
        let starts: Vec<usize> = text.match_indices(['"', '>']).map(|(at, _)| at + 1).collect();
        let start = starts[place.index(starts.len())];
        let length = text[start..].find(['"', '<']).unwrap_or(0);
        if !text[start..start + length].contains('=') {
            text.replace_range(start..start + length, WORDS[word]);
        }
    }
    text
}
