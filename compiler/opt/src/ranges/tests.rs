//! - `addresses`: addresses of elements, and pointers with an area; `counters`: counters of loops; `polls`: loops that look for interrupts.
//! - Here: what a test and a sum say of their operands.

mod addresses;
mod counters;
mod polls;

use crate::tests::check_pass;

#[test]
fn what_was_tested_is_known_where_only_the_test_leads() {
    check_pass(
        "ranges",
        "func @F -> i1 {
        b0(v0: i32):
        v1 = const.i32 9
        v2 = ule v0, v1
        branch v2, b1, b2
        b1:
        v3 = const.i32 0
        v4 = sge v0, v3
        ret v4
        b2:
        v5 = ule v0, v1
        ret v5
        }",
        "func @F -> i1 {
        b0(v0: i32):
        v1 = const.i32 9
        v2 = ule v0, v1
        branch v2, b1, b2
        b1:
        v3 = const.i32 0
        v4 = const.i1 1
        ret v4
        b2:
        v5 = ule v0, v1
        ret v5
        }",
    );
}

#[test]
fn a_sum_says_what_its_operand_is_even_if_it_wraps() {
    let text = |last: &str| {
        format!(
            "func @F -> i1 {{
            b0(v0: i32):
            v1 = const.i32 4160749568
            v2 = iadd v0, v1
            v3 = const.i32 100
            v4 = ule v2, v3
            branch v4, b1, b2
            b1:
            {last}
            ret v6
            b2:
            ret v4
            }}"
        )
    };
    check_pass(
        "ranges",
        &text("v5 = const.i32 134217728\nv6 = sge v0, v5"),
        &text("v5 = const.i32 134217728\nv6 = const.i1 1"),
    );
    check_pass(
        "ranges",
        &text("v5 = const.i32 134217829\nv6 = slt v0, v5"),
        &text("v5 = const.i32 134217829\nv6 = const.i1 1"),
    );
    let text = text("v5 = const.i32 134217828\nv6 = slt v0, v5");
    check_pass("ranges", &text, &text);
}

#[test]
fn sums_with_multiples_are_shifted_in_parts() {
    check_pass(
        "ranges",
        "func @F -> i32 {
        b0(v0: i32):
        v1 = const.i32 8128
        v2 = and v0, v1
        v3 = const.i32 50
        v4 = iadd v2, v3
        v5 = const.i32 3
        v6 = lshr v4, v5
        v7 = const.i32 7
        v8 = and v4, v7
        v9 = iadd v6, v8
        ret v9
        }",
        "func @F -> i32 {
        b0(v0: i32):
        v1 = const.i32 8128
        v2 = and v0, v1
        v3 = const.i32 50
        v4 = iadd v2, v3
        v5 = const.i32 3
        v10 = const.i32 3
        v11 = lshr v2, v10
        v12 = const.i32 6
        v6 = iadd v11, v12
        v7 = const.i32 7
        v8 = const.i32 2
        v9 = iadd v6, v8
        ret v9
        }",
    );
}
