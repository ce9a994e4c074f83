//! Round trips of the text form, and messages about wrong texts.

use proptest::prelude::*;

use super::*;
use crate::entities::Value;
use crate::print::module_text;

#[test]
fn every_form_of_line_round_trips() {
    let text = include_str!("../../../../tests/ir/every_line.ir");
    let module = parse_module(text).expect("text is well formed");
    let printed = module_text(&module);
    assert_eq!(printed, text);
    assert_eq!(parse_module(&printed), Ok(module));
}

#[test]
fn numbers_in_the_text_are_free() {
    let module = parse_module("func @F {\nb7:\njump b3\nb3:\nv9 = const.i32 1\nv2 = iadd v9, v9\nret\n}\n");
    let printed = module_text(&module.expect("text is well formed"));
    assert_eq!(printed, "func @F {\nb0:\n    jump b1\nb1:\n    v0 = const.i32 1\n    v1 = iadd v0, v0\n    ret\n}\n");
}

#[test]
fn types_come_from_values_further_down() {
    let text = "func @F {\nb0:\njump b2\nb1:\nv1 = bswap v0\nret\nb2:\nv0 = const.i16 1\njump b1\n}\n";
    let module = parse_module(text).expect("text is well formed");
    let function = module.functions.values().next().expect("one function");
    assert_eq!(function.ty(Value::new(0)), Type::I16);
}

#[test]
fn errors_name_their_line() {
    let line_of = |text: &str| {
        let error = parse_module(text).expect_err("text is wrong");
        (error.line, error.message)
    };
    assert_eq!(line_of("func @F {\nb0:\n\n v1 = nop\n}").0, 4);
    assert_eq!(line_of("func @F {\nb0:\n ret v1\n}"), (3, "v1 is defined nowhere".into()));
    assert_eq!(line_of("func @F {\nb0:\n jump b2\n}"), (3, "b2 is defined nowhere".into()));
    assert_eq!(line_of("func @F {\nb0:\n v1 = fneg v1\n}"), (3, "the value is defined by itself".into()));
    assert_eq!(line_of("func @F {\nb0:\n call @G()\n}"), (3, "there is no function @G".into()));
    assert_eq!(line_of("func @F {\n}"), (2, "function @F has no block".into()));
    assert_eq!(line_of("func @F {\nb0:\n ret\n"), (3, "function @F has no end `}`".into()));
    assert_eq!(line_of("func @F {\nb0:\n v1 = const.i32 1\n store.i16 M 0, v1\n}").0, 4);
    assert_eq!(line_of("entry @F").0, 1);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Every text is read or rejected, and every module that is read can be verified and printed.
    #[test]
    fn damaged_texts_do_no_harm(edits in prop::collection::vec((any::<prop::sample::Index>(), 0..4u8, ".{0,3}"), 1..6)) {
        let mut text: Vec<char> = include_str!("../../../../tests/ir/every_line.ir").chars().collect();
        for (at, kind, new) in edits {
            let at = at.index(text.len());
            let other = (at * 7 + 13) % text.len();
            match kind {
                0 => drop(text.remove(at)),
                1 => drop(text.splice(at..at, new.chars())),
                2 => text[at] = text[other],
                _ => drop(text.drain(at.min(other)..at.min(other) + 5.min(text.len() - at.max(other)))),
            }
        }
        let text: String = text.into_iter().collect();
        if let Ok(mut module) = parse_module(&text) {
            let sound = crate::verify::verify(&module).is_ok();
            let again = parse_module(&module_text(&module));
            prop_assert_eq!(again.as_ref(), Ok(&module));
            module.functions.values_mut().for_each(Function::compact);
            prop_assert!(!sound || crate::verify::verify(&module).is_ok());
        }
    }
}
