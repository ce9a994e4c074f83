//! What the counter of a loop says: of itself, and of what counts along with it.

use crate::tests::check_pass;

#[test]
fn the_index_of_a_loop_needs_no_check() {
    check_pass(
        "ranges",
        "func @F -> i32 {
        b0:
        v0 = const.i16 0
        jump b1(v0)
        b1(v1: i16):
        v2 = const.i16 99
        v3 = sle v1, v2
        branch v3, b2, b4
        b2:
        v4 = sext.i32 v1
        v5 = const.i32 99
        v6 = ule v4, v5
        v7 = const.i32 4
        v8 = shl v4, v7
        v9 = const.i32 3
        v10 = ashr v8, v9
        store.i16 M[v10]+0, v1
        branch v6, b3, b4
        b3:
        v11 = const.i16 1
        v12 = iadd v1, v11
        jump b1(v12)
        b4:
        v13 = const.i32 1
        ret v13
        }",
        "func @F -> i32 {
        b0:
        v0 = const.i16 0
        jump b1(v0)
        b1(v1: i16):
        v2 = const.i16 99
        v3 = sle v1, v2
        branch v3, b2, b4
        b2:
        v4 = sext.i32 v1
        v5 = const.i32 99
        v6 = const.i1 1
        v7 = const.i32 4
        v8 = shl v4, v7
        v9 = const.i32 3
        v10 = const.i32 1
        v11 = shl v4, v10
        store.i16 M[v11]+0, v1
        branch v6, b3, b4
        b3:
        v12 = const.i16 1
        v13 = iadd v1, v12
        jump b1(v13)
        b4:
        v14 = const.i32 1
        ret v14
        }",
    );
}

#[test]
fn a_counter_that_may_wrap_says_nothing() {
    let text = "func @F -> i32 {
        b0(v9: i16):
        jump b1(v9)
        b1(v1: i16):
        v2 = const.i16 1
        v6 = sext.i32 v1
        store.i32 M 0, v6
        v7 = sge v1, v2
        store.bit M 4.1, v7
        v3 = iadd v1, v2
        v4 = const.i16 0
        v5 = ne v3, v4
        branch v5, b1(v3), b2
        b2:
        ret v6
        }";
    check_pass("ranges", text, text);
}

#[test]
fn an_int_that_counts_along_with_a_dint_may_wrap() {
    let text = "func @F -> i1 {
        b0:
        v0 = const.i32 0
        v1 = const.i32 49999
        v2 = const.i32 1
        v3 = const.i16 1
        jump b1(v0, v0)
        b1(v4: i32, v5: i32):
        v6 = sle v4, v1
        branch v6, b2, b3
        b2:
        v7 = iadd v4, v2
        v8 = trunc.i16 v5
        v9 = iadd v8, v3
        v10 = sext.i32 v9
        jump b1(v7, v10)
        b3:
        v11 = slt v5, v0
        ret v11
        }";
    check_pass("ranges", text, text);
}

#[test]
fn the_end_of_a_loop_whose_step_has_a_known_sign() {
    let text = "func @F {
        b0(v0: i32):
        v1 = const.i32 7
        v2 = and v0, v1
        v3 = const.i32 1
        v4 = iadd v2, v3
        v5 = const.i32 255
        v6 = const.i32 0
        jump b1(v4)
        b1(v7: i32):
        v8 = sle v7, v5
        v9 = sge v7, v5
        v10 = sge v4, v6
        v11 = select v10, v8, v9
        branch v11, b2, b3
        b2:
        v12 = ule v7, v5
        store.bit M 0.0, v12
        v13 = iadd v7, v4
        jump b1(v13)
        b3:
        ret
        }";
    let mut module = plcc_ir::parse::parse_module(text).expect("text is well formed");
    for pass in ["ranges", "fold"] {
        crate::run_pass(&mut module, pass).expect("there is such a pass");
    }
    let text = plcc_ir::print::module_text(&module);
    assert!(!text.contains("ule"), "{text}");
}

#[test]
fn a_pointer_gets_as_far_as_the_counter_lets_it() {
    check_pass(
        "ranges",
        "func @F -> i32 {
        b0:
        v0 = const.i32 40
        v1 = const.i32 0
        jump b1(v0, v1)
        b1(v2: i32, v3: i32):
        v4 = const.i32 7
        v5 = and v3, v4
        v6 = const.i32 16777215
        v7 = and v3, v6
        v8 = const.i32 2496
        v9 = ule v7, v8
        branch v9, b2, b3
        b2:
        v10 = const.i32 64
        v11 = iadd v3, v10
        v12 = const.i32 1
        v13 = isub v2, v12
        v14 = ne v13, v1
        branch v14, b1(v13, v11), b3
        b3:
        ret v5
        }",
        "func @F -> i32 {
        b0:
        v0 = const.i32 40
        v1 = const.i32 0
        jump b1(v0, v1)
        b1(v2: i32, v3: i32):
        v4 = const.i32 7
        v5 = const.i32 0
        v6 = const.i32 16777215
        v7 = const.i32 2496
        v8 = const.i1 1
        branch v8, b2, b3
        b2:
        v9 = const.i32 64
        v10 = iadd v3, v9
        v11 = const.i32 1
        v12 = isub v2, v11
        v13 = ne v12, v1
        branch v13, b1(v12, v10), b3
        b3:
        ret v5
        }",
    );
}

#[test]
fn a_pointer_to_the_element_that_a_counter_names_gets_as_far_as_that() {
    let text = |is_inside: &str, between: &str| {
        format!(
            "func @F -> i32 {{
            b0(v0: i16):
            v1 = const.i16 1
            v2 = slt v0, v1
            v3 = const.i16 15
            v4 = sgt v0, v3
            v5 = or v2, v4
            v6 = sext.i32 v0
            v7 = const.i32 4
            v8 = shl v6, v7
            branch v5, b3, b1(v8, v0)
            b1(v9: i32, v10: i16):
            v11 = const.i32 256
            v12 = {is_inside}
            v13 = const.i16 65535
            v14 = iadd v10, v13
            v15 = const.i32 {between}
            v16 = iadd v9, v15
            v17 = const.i16 0
            v18 = sgt v14, v17
            branch v12, b2, b3
            b2:
            branch v18, b1(v16, v14), b3
            b3:
            v19 = const.i32 1
            ret v19
            }}"
        )
    };
    check_pass("ranges", &text("ult v9, v11", "4294967280"), &text("const.i1 1", "4294967280"));
    // Steps that do not go with the beginning: the pointer gets to -7 * 16.
    check_pass("ranges", &text("ult v9, v11", "4294967272"), &text("ult v9, v11", "4294967272"));
}
