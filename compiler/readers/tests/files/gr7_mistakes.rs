//! All mistakes of a file are reported in one run, each once, and the text around them is read.

use plcc_diag::FileId;
use plcc_readers::{ReadOptions, parse};
use plcc_syntax::{Language, ast_text};

#[test]
fn every_mistake_is_told() {
    let source = include_str!("mistakes.gr7");
    let options = ReadOptions { language: Some(Language::Graph), ..ReadOptions::default() };
    let (unit, diagnostics) = parse(FileId(0), source, &options);
    let found: String = diagnostics
        .iter()
        .map(|found| {
            let line = source[..found.primary.span.start as usize].matches('\n').count() + 1;
            format!("{line}: {} {}\n", found.code.name(), found.title)
        })
        .collect();
    assert_eq!(found, include_str!("mistakes.txt"), "\n{found}");
    let tree = ast_text(&unit);
    for kept in ["broken", "S %Q4.6", "before %M9.3 (=) := %I1.6", "step 4 \"B\"", "from \"A\", \"B\""] {
        assert!(tree.contains(kept), "{kept} is lost:\n{tree}");
    }
}

#[test]
fn charts_are_known_by_their_content() {
    for language in [None, Some(Language::Stl), Some(Language::Scl)] {
        let options = ReadOptions { language, ..ReadOptions::default() };
        let text = include_str!("../../../../tests/parse/graph/mixed.gr7");
        let (unit, diagnostics) = parse(FileId(0), text, &options);
        assert!(diagnostics.is_empty(), "{diagnostics:?}");
        assert_eq!(unit.blocks.len(), 5);
        assert!(ast_text(&unit).contains("initial_step 1 \"Off\""));
    }
    // Comments and labels of other languages are not charts.
    for text in ["// END_STEP\nA I0.0\n= Q4.0\n", "END_STEP: A I0.0\n= Q4.0\n", "(*\nINITIAL_STEP\n*)\nx := 1;\n"] {
        let (unit, _) = parse(FileId(0), text, &ReadOptions::default());
        assert!(!ast_text(&unit).contains("chart"), "{text}");
        assert_eq!(unit.blocks.len(), 1, "{text}");
    }
}
