//! Helpers for the tests of passes, and random programs before and after optimisation.

use plcc_ir::Function;
use plcc_ir::parse::parse_module;
use plcc_ir::print::module_text;

use crate::{Change, Pass, Run, Without};

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

#[test]
fn a_pass_runs_again_after_changes_that_concern_it() {
    fn nothing(_: &mut Function) -> Change {
        Change::Nothing
    }
    fn shared(_: &mut Function) -> Change {
        Change::Shared
    }
    fn unused(_: &mut Function) -> Change {
        Change::Unused
    }
    fn code(_: &mut Function) -> Change {
        Change::Code
    }
    let runs = |name: &'static str, other: fn(&mut Function) -> Change| {
        let (pass, other) = (crate::telling(name, nothing), crate::telling("other", other));
        let mut function = one_function("func @F {\nb0:\njump b1\nb1:\njump b1\n}");
        let mut count = 0;
        crate::run_each_on(&[pass, other, pass], &mut function, Without::NOTHING, |run, function| {
            count += 1;
            match run {
                Run::Telling(run) => run(function),
                _ => Change::Nothing,
            }
        });
        count - 1
    };
    let all = |name| [nothing, shared, unused, code].map(|other| runs(name, other));
    assert_eq!(all("forward"), [1, 1, 1, 2]);
    assert_eq!(all("fold"), [1, 2, 1, 2]);
    assert_eq!(all("loop-memory"), [1, 1, 2, 2]);
    assert_eq!(all("dead-stores"), [1, 2, 2, 2]);
}

#[test]
fn passes_for_loops_leave_code_without_loops() {
    let text = "db 5 at 0x400000 length 20
        func @F -> i32 frame 16 {
        b0(v0: i32, v1: i1):
        v2 = db_base v0
        v3 = load.i32 anydb[v2]+4
        branch v1, b1, b2
        b1:
        store.i32 M 0, v3
        v4 = db_length v0
        jump b2
        b2:
        v5 = load.i32 M 0
        branch v1, b3, b4
        b3 cold:
        store.i32 M 4, v5
        jump b4
        b4:
        ret v5
        }";
    let for_loops: Vec<Pass> = crate::pipeline().copied().filter(Pass::is_for_loops).collect();
    for name in ["hoist-lookups", "loop-memory", "loop-ranges", "part-cold-loops", "turn-loops", "unroll"] {
        assert!(for_loops.iter().any(|pass| pass.name == name), "{name}");
        check_pass(name, text, text);
    }
    let mut function = one_function(text);
    let never = |_: Run, _: &mut Function| panic!("it is for loops");
    assert!(!crate::run_each_on(&for_loops, &mut function, Without::NOTHING, never));
}

fn one_function(text: &str) -> Function {
    let module = parse_module(text).expect("text is well formed");
    module.functions.values().next().expect("one function").clone()
}

mod random;
