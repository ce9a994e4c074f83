//! Whether a loop looks for interrupts.

use crate::tests::check_pass;

/// A loop of so many passes that ends each of them in this way.
fn watched_loop(last: u16, end_of_pass: &str) -> String {
    format!(
        "func @F -> i16 {{
        b0:
        v0 = const.i16 0
        jump b1(v0)
        b1(v1: i16):
        v2 = const.i16 {last}
        v3 = sle v1, v2
        branch v3, b2, b4
        b2:
        v4 = const.i16 1
        v5 = iadd v1, v4
        v6 = load.i32 state 0
        v7 = const.i32 0
        v8 = ne v6, v7
        {end_of_pass}
        b3 cold:
        v9 = rt @safepoint(v7)
        v10 = ne v9, v7
        branch v10, b5, b1(v5)
        b4:
        ret v1
        b5 cold:
        ret v0
        }}"
    )
}

#[test]
fn a_loop_that_ends_soon_does_not_look_for_interrupts() {
    let unwatched = "func @F -> i16 {
        b0:
        v0 = const.i16 0
        jump b1(v0)
        b1(v1: i16):
        v2 = const.i16 99
        v3 = sle v1, v2
        branch v3, b2, b3
        b2:
        v4 = const.i16 1
        v5 = iadd v1, v4
        v6 = load.i32 state 0
        v7 = const.i32 0
        v8 = ne v6, v7
        jump b1(v5)
        b3:
        ret v1
        }";
    check_pass("ranges", &watched_loop(99, "branch v8, b3, b1(v5)"), unwatched);
}

#[test]
fn a_long_loop_looks_for_interrupts() {
    let long = watched_loop(30_000, "branch v8, b3, b1(v5)");
    check_pass("ranges", &long, &long);
}

#[test]
fn a_loop_around_one_that_may_not_end_looks_for_interrupts() {
    let text = "func @F {
        b0(v0: i1):
        v1 = const.i32 0
        v2 = const.i16 0
        v3 = const.i16 1
        v4 = const.i16 9
        jump b1(v2)
        b1(v5: i16):
        v6 = sle v5, v4
        branch v6, b7, b6
        b7:
        store.i16 M 2, v5
        jump b2
        b2:
        v7 = load.i32 state 0
        v8 = ne v7, v1
        branch v8, b3, b4
        b3 cold:
        v9 = rt @safepoint(v1)
        jump b4
        b4:
        v10 = load.bit M 0.0
        branch v10, b2, b5
        b5:
        v11 = iadd v5, v3
        jump b1(v11)
        b6:
        ret
        }";
    check_pass("ranges", text, text);
}
