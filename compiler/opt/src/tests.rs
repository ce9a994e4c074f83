//! Helpers for the tests of passes, and random programs before and after optimisation.

use plcc_ir::parse::parse_module;
use plcc_ir::print::module_text;

/// Runs the pass `name` on a module and compares its result with `expected`, both in canonical numbering.
#[track_caller]
pub fn check_pass(name: &str, text: &str, expected: &str) {
    let mut module = parse_module(text).expect("text is well formed");
    crate::check("parsing", &module);
    crate::run_pass(&mut module, name).expect("there is such a pass");
    crate::check(name, &module);
    for function in module.functions.values_mut() {
        function.compact();
    }
    let expected = parse_module(expected).expect("expectation is well formed");
    assert_eq!(module_text(&module), module_text(&expected));
}

/// As [`check_pass`], for bodies of a function `@F` with a frame, an i32 and an i1; `@G` touches nothing, `@H` its caller's frame.
pub fn check_body(name: &str, body: &str, expected: &str) {
    let around = |body: &str| {
        format!(
            "db 5 at 0x400000 length 20\nfunc @F -> i32 frame 16 {{\nb0(v0: i32, v1: i1):\n{body}\n}}\nfunc @G \
             {{\nb0:\nret\n}}\nfunc @H {{\nb0:\nv0 = load.i8 V 0\nret\n}}\n"
        )
    };
    check_pass(name, &around(body), &around(expected));
}

mod random;
