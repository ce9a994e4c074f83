use crate::tests::check_pass;

fn check(text: &str, expected: &str) {
    check_pass("inline", text, expected);
}

#[test]
fn a_call_becomes_the_code_of_the_callee() {
    check(
        "entry @F
        func @F {
        b0:
        v0 = load.i32 M 0
        v1, v2 = call @G(v0)
        v3 = iadd v1, v2
        store.i32 M 4, v3
        ret
        }
        func @G -> i32, i32 {
        b0(v0: i32):
        v1 = const.i32 5
        v2 = imul v0, v1
        ret v2, v0
        }",
        "entry @F
        func @F {
        b0:
        v0 = load.i32 M 0
        v1 = const.i32 5
        v2 = imul v0, v1
        v3 = iadd v2, v0
        store.i32 M 4, v3
        ret
        }",
    );
}

#[test]
fn the_frame_lies_where_that_of_a_callee_begins() {
    check(
        "func @F frame 16 {
        b0:
        call @G()
        ret
        }
        func @G frame 8 {
        b0:
        clear L 0, 8
        v0 = load.i32 V 4
        store.i32 L 4, v0
        ret
        }",
        "func @F frame 16 inlined 8 {
        b0:
        clear L 16, 8
        v0 = load.i32 L 4
        store.i32 L 20, v0
        ret
        }",
    );
}

#[test]
fn several_returns_meet_behind_the_call() {
    check(
        "func @F -> i32 {
        b0(v0: i32):
        v1 = call @G(v0)
        ret v1
        }
        func @G -> i32 {
        b0(v0: i32):
        v1 = const.i32 0
        v2 = eq v0, v1
        branch v2, b1, b2
        b1:
        ret v0
        b2:
        v3 = isub v1, v0
        ret v3
        }",
        "func @F -> i32 {
        b0(v0: i32):
        v1 = const.i32 0
        v2 = eq v0, v1
        branch v2, b1, b2
        b1:
        jump b3(v0)
        b2:
        v3 = isub v1, v0
        jump b3(v3)
        b3(v4: i32):
        ret v4
        }",
    );
}

/// A call of `@G`, and its safepoint.
const SAFEPOINT: &str = "v0 = call @G()
        v1 = load.i32 state 0
        v2 = const.i32 0
        v3 = ne v1, v2
        branch v3, b1, b2
        b1 cold:
        v4 = const.i32 7
        v5 = rt @safepoint(v4)
        v6 = ne v5, v2
        branch v6, b3, b2
        b2:
        ret v0
        b3 cold:
        ret v2
        }";

#[test]
fn a_quiet_callee_needs_no_safepoint() {
    check(
        &format!("func @F -> i32 {{\nb0:\n{SAFEPOINT}\nfunc @G -> i32 {{\nb0:\nv0 = load.i32 M 0\nret v0\n}}"),
        "func @F -> i32 {
        b0:
        v0 = load.i32 M 0
        v1 = load.i32 state 0
        v2 = const.i32 0
        v3 = ne v1, v2
        jump b2
        b2:
        ret v0
        }",
    );
}

#[test]
fn stop_in_the_callee_leaves_the_caller() {
    check(
        &format!(
            "func @F -> i32 {{
            b0:
            {SAFEPOINT}
            func @G -> i32 {{
            b0:
            v0 = load.i32 M 0
            v1 = rt @safepoint(v0)
            v2 = const.i32 0
            v3 = ne v1, v2
            branch v3, b1, b2
            b1 cold:
            ret v2
            b2:
            ret v0
            }}"
        ),
        "func @F -> i32 {
        b0:
        v0 = load.i32 M 0
        v1 = rt @safepoint(v0)
        v2 = const.i32 0
        v3 = ne v1, v2
        branch v3, b5, b1
        b1:
        jump b2
        b2:
        v4 = load.i32 state 0
        v5 = const.i32 0
        v6 = ne v4, v5
        branch v6, b3, b4
        b3 cold:
        v7 = const.i32 7
        v8 = rt @safepoint(v7)
        v9 = ne v8, v5
        branch v9, b5, b4
        b4:
        ret v0
        b5 cold:
        v10 = const.i32 0
        ret v10
        }",
    );
}

#[test]
fn recursion_and_what_hands_out_local_data_stay() {
    let text = "func @F frame 8 {
        b0:
        call @G()
        call @H()
        ret
        }
        func @G {
        b0:
        call @G()
        ret
        }
        func @H frame 8 {
        b0:
        v0 = address L 0
        store.i32 M 0, v0
        ret
        }";
    check(text, text);
}

#[test]
fn what_callees_inlined_goes_on_with_them() {
    check(
        "entry @F
        func @F {
        b0:
        call @G()
        ret
        }
        func @G frame 8 {
        b0:
        call @H()
        ret
        }
        func @H frame 8 {
        b0:
        store.i32 L 0, v0
        ret
        }"
        .replace("store.i32 L 0, v0", "v0 = load.i32 L 0\nstore.i32 M 0, v0")
        .as_str(),
        "entry @F
        func @F inlined 16 {
        b0:
        v0 = load.i32 L 8
        store.i32 M 0, v0
        ret
        }",
    );
}

#[test]
fn what_gets_constant_addresses_costs_less() {
    // Eighty bits are copied: much code where their addresses are values, a load and a store each where they are constants.
    let bits: String = (0..80)
        .map(|number| {
            let value = |at: usize| format!("v{}", 10 + 20 * number + at);
            let v: Vec<String> = (0..16).map(value).collect();
            format!(
                "{} = lshr v0, v2\n{} = and v0, v3\n{} = load.i8 any[{}]+{number}\n{} = zext.i32 {}\n{} = lshr {}, {}\n\
                 {} = trunc.i1 {}\nstore.bit M {number}.0, {}\n",
                v[0], v[1], v[2], v[0], v[3], v[2], v[4], v[3], v[1], v[5], v[4], v[5]
            )
        })
        .collect();
    let calls = |argument: &str| {
        let text = format!(
            "entry @F
            func @F {{
            b0:
            v0 = load.i32 M 100
            v1 = const.i32 1597472
            call @G({argument})
            call @G({argument})
            ret
            }}
            func @G {{
            b0(v0: i32):
            v2 = const.i32 3
            v3 = const.i32 7
            {bits}ret
            }}"
        );
        let mut module = plcc_ir::parse::parse_module(&text).expect("text is well formed");
        crate::run_pass(&mut module, "inline").expect("there is such a pass");
        plcc_ir::print::module_text(&module).matches("call @G").count()
    };
    assert_eq!((calls("v0"), calls("v1")), (2, 0));
}

#[test]
fn a_block_move_with_a_computed_pointer_goes_into_the_only_caller() {
    let calls = |calls: &str, fields: &str| {
        let text = format!(
            "db 1 at 0x400000 length 100
            db 2 at 0x400070 length 40
            entry @F
            func @F frame 24 {{
            b0:
            {calls}ret
            }}
            func @G frame 24 {{
            b0:
            v0 = load.i32 M 0
            v1 = const.i32 0x10020014
            v2 = const.i16 1
            v3 = const.i16 2
            v4 = const.i32 0x84000050
            v5 = const.i32 20
            v6 = const.i32 0
            store.i16 L 4, v2
            store.i32 L 6, v0
            clear L 10, 2
            store.i32 L 12, v1
            store.i16 L 16, v3
            store.i32 L 18, v4
            {fields}v7 = address L 0
            v8 = frame_base
            v9 = rt @system_function(v6, v5, v7, v8)
            ret
            }}"
        );
        let mut module = plcc_ir::parse::parse_module(&text).expect("text is well formed");
        crate::run_pass(&mut module, "inline").expect("there is such a pass");
        plcc_ir::print::module_text(&module).matches("call @G").count()
    };
    let known = "store.i32 L 0, v1\n";
    assert_eq!(calls("call @G()\n", known), 0);
    assert_eq!(calls("call @G()\ncall @G()\n", known), 2);
    // Type and length of the source are not known.
    assert_eq!(calls("call @G()\n", "store.i32 L 0, v0\n"), 1);
}

#[test]
fn what_tests_pointers_into_the_frame_of_a_caller_that_knows_them_costs_less() {
    // Sixty words of the caller are copied, each after a test of how far its frame is away.
    let words: String = (0..60)
        .map(|number| {
            let v: Vec<String> = (0..7).map(|at| format!("v{}", 10 + 10 * number + at)).collect();
            format!(
                "{} = address L 0\n{} = address V 0\n{} = isub {}, {}\n{} = uge {}, v1\n{} = iadd {}, v1\n{} = select {}, {}, {}\n\
                 {} = load.i16 any[{}]+0\nstore.i16 M {number}, {}\n",
                v[0], v[1], v[2], v[0], v[1], v[3], v[2], v[4], v[1], v[5], v[3], v[4], v[1], v[6], v[5], v[6]
            )
        })
        .collect();
    let calls = |pointer: u32| {
        let text = format!(
            "entry @F
            func @F frame 32 {{
            b0:
            v0 = const.i32 {pointer}
            store.i32 L 0, v0
            call @G()
            call @G()
            ret
            }}
            func @G frame 8 {{
            b0:
            v1 = const.i32 20
            {words}ret
            }}"
        );
        let mut module = plcc_ir::parse::parse_module(&text).expect("text is well formed");
        crate::run_pass(&mut module, "inline").expect("there is such a pass");
        plcc_ir::print::module_text(&module).matches("call @G").count()
    };
    assert_eq!((calls(5), calls(0x8700_0000)), (2, 0));
}

#[test]
fn a_part_of_a_function_stays_apart() {
    let text = "entry @F
        func @F {
        b0:
        call @F.1()
        ret
        }
        func @F.1 apart {
        b0:
        v0 = load.i32 M 0
        store.i32 M 4, v0
        ret
        }";
    check(text, text);
}

#[test]
fn a_function_that_gives_texts_to_the_runtime_is_inlined_where_its_caller_does_so() {
    let calls = |caller: &str| {
        let text = format!(
            "entry @F
            func @F frame 16 {{
            b0:
            v0 = const.i32 4
            v1 = const.i64 0
            v2 = address L 0
            {caller}
            call @G()
            ret
            }}
            func @G frame 16 {{
            b0:
            v0 = const.i32 4
            v1 = const.i64 0
            v2 = address L 0
            v3 = rt @text_find(v1, v2, v2, v0)
            ret
            }}"
        );
        let mut module = plcc_ir::parse::parse_module(&text).expect("text is well formed");
        crate::run_pass(&mut module, "inline").expect("there is such a pass");
        plcc_ir::print::module_text(&module).matches("call @G").count()
    };
    assert_eq!((calls(""), calls("v3 = rt @text_find(v1, v2, v2, v0)")), (1, 0));
}
