//! Addresses of elements, and pointers with an area.

use crate::tests::{check_body, check_pass};

#[test]
fn what_is_reached_from_a_small_number_is_in_one_db() {
    let text = |mask: u32, address: &str| {
        format!(
            "db 1 at 0x400000 length 100
            func @F -> i32 {{
            b0(v0: i32):
            v1 = const.i32 {mask}
            v2 = and v0, v1
            v3 = load.i16 {address}
            v4 = zext.i32 v3
            ret v4
            }}"
        )
    };
    check_pass("ranges", &text(63, "any[v2]+4194308"), &text(63, "DB1[v2]+4"));
    check_pass("ranges", &text(127, "any[v2]+4194308"), &text(127, "any[v2]+4194308"));
}

#[test]
fn bits_of_a_loop_that_was_unrolled_twice_are_in_one_byte() {
    // The counter is a multiple of 8: the second bit of the second four, and a multiple of 4 has room for 3.
    let text = "func @F -> i32 {
        b0:
        v0 = const.i32 0
        v1 = const.i32 1
        v2 = const.i32 3
        v3 = const.i32 4
        v4 = const.i32 7
        v5 = const.i32 8
        v6 = const.i32 32
        jump b1(v0)
        b1(v7: i32):
        v8 = iadd v7, v3
        v9 = iadd v8, v1
        v10 = lshr v9, v2
        v11 = and v9, v4
        v12 = load.i8 M[v10]+0
        v13 = zext.i32 v12
        v14 = lshr v13, v11
        store.i32 M 100, v14
        v15 = iadd v7, v5
        v16 = slt v15, v6
        branch v16, b1(v15), b2
        b2:
        ret v0
        }";
    let mut module = plcc_ir::parse::parse_module(text).expect("text is well formed");
    crate::run_pass(&mut module, "ranges").expect("there is such a pass");
    let result = plcc_ir::print::module_text(&module);
    assert!(result.contains("lshr v8") && result.contains("const.i32 5") && !result.contains("and v9"), "{result}");
}

#[test]
fn an_element_of_an_instance_is_at_the_address_of_the_instance() {
    // The instance is at one of the multiples of 32 bytes up to 224, an element has 26 bytes, and the first is at 14.
    check_pass(
        "ranges",
        "func @F {
        b0(v0: i32, v1: i32):
        v2 = const.i32 1792
        v3 = and v0, v2
        v4 = const.i32 3
        v5 = and v1, v4
        v6 = const.i32 208
        v7 = imul v5, v6
        v8 = iadd v3, v7
        v9 = const.i32 112
        v10 = iadd v8, v9
        v11 = const.i32 16777215
        v12 = and v10, v11
        v13 = lshr v12, v4
        store.i32 M[v13]+0, v0
        ret
        }",
        "func @F {
        b0(v0: i32, v1: i32):
        v2 = const.i32 1792
        v3 = and v0, v2
        v4 = const.i32 3
        v5 = and v1, v4
        v6 = const.i32 208
        v7 = imul v5, v6
        v8 = iadd v3, v7
        v9 = const.i32 112
        v10 = iadd v8, v9
        v11 = const.i32 16777215
        v12 = const.i32 3
        v13 = const.i32 3
        v14 = lshr v3, v13
        v15 = const.i32 26
        v16 = imul v5, v15
        v17 = iadd v14, v16
        v18 = const.i32 14
        v19 = iadd v17, v18
        store.i32 M[v17]+14, v0
        ret
        }",
    );
}

#[test]
fn an_address_register_keeps_its_area() {
    let text = |check: &str, and: &str, or: &str| {
        format!(
            "func @F {{
            b0(v0: i16):
            v1 = const.i32 2214592512
            v2 = const.i32 20
            jump b1(v2, v1)
            b1(v3: i32, v4: i32):
            v5 = trunc.i16 v3
            v6 = const.i32 16777215
            v7 = and v4, v6
            v8 = const.i32 3
            v9 = lshr v7, v8
            v10 = const.i32 1
            v11 = iadd v9, v10
            v12 = const.i32 20
            {check}
            branch v13, b2, b3
            b2:
            v14 = const.i32 8
            v15 = iadd v4, v14
            {and}
            {or}
            v19 = const.i16 65535
            v20 = iadd v5, v19
            v21 = zext.i32 v20
            v22 = const.i16 1
            v23 = ne v5, v22
            branch v23, b1(v21, v18), b3
            b3:
            ret
            }}"
        )
    };
    let before = text("v13 = ule v11, v12", "v16 = and v15, v6", "v18 = or v16, v1");
    // The address and the step: what an access with it has in its offset.
    let and = "v25 = const.i32 16777215\nv26 = and v4, v25\nv27 = const.i32 8\nv16 = iadd v26, v27";
    let after = text("v13 = const.i1 1", and, "").replace("v18)", "v15)");
    // So does the counter, which needs no word.
    let after = after.replace("v21 = zext.i32 v20", "v24 = const.i32 4294967295\nv21 = iadd v3, v24");
    check_pass("ranges", &before, &after);
}

#[test]
fn the_constant_of_an_index_is_in_the_offset() {
    let text = |body: &str, base: &str| {
        format!(
            "db 5 at 0x400000 length 40
            func @F -> i16 {{
            b0(v0: i16):
            v1 = const.i16 15
            v2 = and v0, v1
            v3 = const.i32 1
            {body}
            v8 = load.i16 DB5[{base}
            ret v8
            }}"
        )
    };
    let wraps =
        |constant: i32| format!("v4 = const.i16 {constant}\nv5 = iadd v2, v4\nv6 = sext.i32 v5\nv7 = shl v6, v3");
    // Up: the offset grows.
    let up = "v4 = const.i16 3\nv5 = iadd v2, v4\nv9 = sext.i32 v2\nv10 = const.i32 3\nv6 = iadd v9, v10\nv13 = const.i32 1\nv11 = shl v9, v13\nv12 = const.i32 6\nv7 = iadd v11, v12";
    check_pass("ranges", &text(&wraps(3), "v7]+0"), &text(up, "v11]+6"));
    // The sum may wrap.
    let before = text(&wraps(32760), "v7]+0");
    check_pass("ranges", &before, &before);
}

/// The pointer stays within its area, so that what is added to it is added to the address.
#[test]
fn what_is_added_to_a_pointer_comes_after_its_mask() {
    let text = |added: u32| {
        format!(
            "; passes: ranges
            func @F -> i32 {{
            b0(v0: i32):
            v1 = const.i32 63
            v2 = const.i32 16777215
            v3 = const.i32 2214592512
            v4 = const.i32 {added}
            v5 = and v0, v1
            v6 = or v5, v3
            v7 = iadd v6, v4
            v8 = and v7, v2
            ret v8
            }}"
        )
    };
    let result = |added: u32| crate::run_listed_passes(&text(added)).expect("text is well formed");
    assert!(result(8).contains("v9 = and v6, v8\n    v10 = const.i32 8\n    v11 = iadd v9, v10"), "{}", result(8));
    // It may leave its area, at the end or at the begin.
    for added in [0x00FF_FFC1, u32::MAX] {
        assert!(result(added).contains("v8 = and v7, v2"), "{}", result(added));
    }
}

#[test]
fn the_multiple_of_an_index_is_one_of_bytes() {
    check_pass(
        "ranges",
        "func @F {
        b0(v0: i32):
        v1 = const.i32 15
        v2 = and v0, v1
        v3 = const.i32 224
        v4 = imul v2, v3
        v5 = const.i32 3
        v6 = lshr v4, v5
        store.i32 M[v6]+0, v0
        v7 = imul v0, v3
        v8 = lshr v7, v5
        store.i32 M[v8]+0, v0
        ret
        }",
        "func @F {
        b0(v0: i32):
        v1 = const.i32 15
        v2 = and v0, v1
        v3 = const.i32 224
        v4 = imul v2, v3
        v5 = const.i32 3
        v6 = const.i32 28
        v7 = imul v2, v6
        store.i32 M[v7]+0, v0
        v8 = imul v0, v3
        v9 = lshr v8, v5
        store.i32 M[v9]+0, v0
        ret
        }",
    );
}

#[test]
fn a_pointer_with_an_area_stays_in_it() {
    // It begins at P#DBX 2.0, and nothing says how often it moves on: it may wrap, and come to the beginning of the area.
    let text = "func @F -> i32 {
        b0(v0: i1):
        v1 = const.i32 2214592528
        v2 = const.i32 16
        v3 = const.i32 16777215
        v4 = const.i32 4278190080
        v5 = const.i32 24
        v6 = const.i32 132
        jump b1(v1)
        b1(v7: i32):
        v8 = lshr v7, v5
        v9 = eq v8, v6
        branch v9, b2, b3
        b2:
        v10 = iadd v7, v2
        v11 = and v10, v3
        v12 = and v7, v4
        v13 = or v12, v11
        branch v0, b1(v13), b3
        b3:
        ret v2
        }";
    let mut module = plcc_ir::parse::parse_module(text).expect("text is well formed");
    crate::run_pass(&mut module, "ranges").expect("there is such a pass");
    let result = plcc_ir::print::module_text(&module);
    assert!(!result.contains("eq v"), "{result}");
}

#[test]
fn an_address_without_an_area_has_none_later() {
    // The high byte of a pointer of 24 bits stays 0.
    let text = "func @F -> i32 {
        b0(v0: i1):
        v1 = const.i32 16
        v2 = const.i32 16777215
        v3 = const.i32 4278190080
        jump b1(v1)
        b1(v4: i32):
        v5 = iadd v4, v1
        v6 = and v5, v2
        v7 = and v4, v3
        v8 = or v7, v6
        branch v0, b1(v8), b2
        b2:
        ret v7
        }";
    let mut module = plcc_ir::parse::parse_module(text).expect("text is well formed");
    crate::run_pass(&mut module, "ranges").expect("there is such a pass");
    let result = plcc_ir::print::module_text(&module);
    assert!(!result.contains("and v4, v3"), "{result}");
}

#[test]
fn an_element_is_where_its_index_says() {
    check_body(
        "ranges",
        "v2 = address DB5[v0]+4
        v3 = const.i32 9
        v4 = ule v0, v3
        branch v4, b1, b2
        b1:
        v5 = const.i32 4194318
        v6 = ult v2, v5
        v7 = zext.i32 v6
        ret v7
        b2:
        ret v2",
        "v2 = address DB5[v0]+4
        v3 = const.i32 9
        v4 = ule v0, v3
        branch v4, b1, b2
        b1:
        v5 = const.i32 4194318
        v6 = const.i1 1
        v7 = const.i32 1
        ret v7
        b2:
        ret v2",
    );
}
