//! Helpers for the tests of passes, and random programs before and after optimisation.

use plcc_ir::parse::parse_module;
use plcc_ir::print::module_text;

/// Runs the pass `name` on a module and compares what it makes with `expected`, both in canonical numbering.
#[track_caller]
pub fn check_pass(name: &str, text: &str, expected: &str) {
    let mut module = parse_module(text).expect("text is well formed");
    crate::check("parsing", &module);
    assert!(crate::run_pass(&mut module, name), "there is a pass {name}");
    crate::check(name, &module);
    for function in module.functions.values_mut() {
        function.compact();
    }
    let expected = parse_module(expected).expect("expectation is well formed");
    assert_eq!(module_text(&module), module_text(&expected));
}

mod random;
