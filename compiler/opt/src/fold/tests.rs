//! The rules on typical code. Each expectation is checked after dead code is removed.

use plcc_ir::parse::parse_module;
use plcc_ir::print::module_text;

#[track_caller]
fn check(body: &str, expected: &str) {
    let around = |body: &str| {
        let text = format!("func @F -> i32 {{\nb0(v0: i32, v1: i32, v2: i1, v3: i16, v4: f32, v5: i1):\n{body}\n}}\n");
        parse_module(&text).expect("text is well formed")
    };
    let mut module = around(body);
    crate::check("parsing", &module);
    for function in module.functions.values_mut() {
        super::fold(function);
    }
    crate::dead_code::eliminate_dead_code(&mut module);
    crate::check("fold", &module);
    module.functions.values_mut().for_each(plcc_ir::Function::compact);
    assert_eq!(module_text(&module), module_text(&around(expected)));
}

#[test]
fn the_low_word_of_an_accumulator() {
    check(
        "v10 = const.i32 4294901760\nv11 = and v0, v10\nv12 = zext.i32 v3\nv13 = or v11, v12\nv14 = trunc.i16 v13\nstore.i16 \
         M 0, v14\nret v13",
        "v10 = const.i32 4294901760\nv11 = and v0, v10\nv12 = zext.i32 v3\nv13 = or v11, v12\nstore.i16 M 0, v3\nret v13",
    );
    check(
        "v10 = const.i32 16\nv11 = shl v0, v10\nv12 = zext.i32 v3\nv13 = or v11, v12\nv14 = lshr v13, v10\nret v14",
        "v10 = const.i32 16\nv11 = shl v0, v10\nv14 = lshr v11, v10\nret v14",
    );
}

#[test]
fn pointers_to_parts_of_instances() {
    // The area of a pointer does not reach its address.
    check(
        "v10 = const.i32 2214592512\nv11 = iadd v0, v10\nv12 = const.i32 16777215\nv13 = and v11, v12\nret v13",
        "v12 = const.i32 16777215\nv13 = and v0, v12\nret v13",
    );
    check(
        "v10 = const.i32 2214592576\nv11 = iadd v0, v10\nv12 = const.i32 16777215\nv13 = and v11, v12\nret v13",
        "v12 = const.i32 16777215\nv10 = const.i32 64\nv11 = iadd v0, v10\nv13 = and v11, v12\nret v13",
    );
    check(
        "v10 = const.i32 2214592512\nv11 = or v0, v10\nv12 = iadd v11, v1\nv13 = const.i32 16777215\nv14 = and v12, v13\nret v14",
        "v13 = const.i32 16777215\nv12 = iadd v0, v1\nv14 = and v12, v13\nret v14",
    );
    // A pointer that moves back.
    let text = "v10 = const.i32 4294967288\nv11 = iadd v0, v10\nv12 = const.i32 16777215\nv13 = and v11, v12\nret v13";
    check(text, text);
    // Bits above the mask do reach a mask that has holes.
    let text = "v10 = const.i32 3\nv11 = iadd v0, v10\nv12 = const.i32 12\nv13 = and v11, v12\nret v13";
    check(text, text);
    check(
        "v10 = const.i32 65535\nv11 = and v0, v10\nv12 = const.i32 112\nv13 = iadd v11, v12\nv14 = and v13, v10\nv15 = \
         const.i32 3\nv16 = lshr v14, v15\nret v16",
        "v10 = const.i32 65535\nv11 = and v0, v10\nv15 = const.i32 3\nv17 = lshr v11, v15\nv18 = const.i32 14\nv19 = iadd \
         v17, v18\nv20 = const.i32 8191\nv16 = and v19, v20\nret v16",
    );
    // 4 is half a byte: something may be carried.
    let text = "v10 = const.i32 65535\nv11 = and v0, v10\nv12 = const.i32 4\nv13 = iadd v11, v12\nv14 = and v13, v10\nv15 = \
                const.i32 3\nv16 = lshr v14, v15\nret v16";
    check(text, text);
}

#[test]
fn addresses_in_the_own_frame_do_not_wrap() {
    let text = |added: u32| {
        format!(
            "v2 = address L 0\nv3 = const.i32 4294901760\nv4 = and v2, v3\nv5 = const.i32 {added}\nv6 = iadd v2, v5\nv7 = \
             const.i32 65535\nv8 = and v6, v7\nv9 = or v4, v8\nv10 = const.i32 4\nv11 = iadd v9, v10\nv12 = ule v11, \
             v2\nstore.bit M 0.0, v12\nret v9"
        )
    };
    crate::tests::check_body(
        "fold",
        &text(10),
        "v2 = address L 0\nv3 = const.i32 4294901760\nv4 = and v2, v3\nv5 = const.i32 10\nv6 = iadd v2, v5\nv7 = const.i32 \
         65535\nv8 = and v6, v7\nv9 = const.i32 4\nv10 = const.i32 14\nv11 = iadd v2, v10\nv12 = const.i1 0\nstore.bit M 0.0, \
         v12\nret v6",
    );
    // The frame has 16 bytes.
    crate::tests::check_body("fold", &text(16), &text(16));
}

#[test]
fn comparisons_combine() {
    check(
        "v10 = slt v0, v1\nv11 = sgt v0, v1\nv12 = or v10, v11\nstore.bit M 0.0, v12\nret v0",
        "v10 = ne v0, v1\nstore.bit M 0.0, v10\nret v0",
    );
    check(
        "v10 = slt v0, v1\nv11 = slt v1, v0\nv12 = or v10, v11\nv13 = const.i1 1\nv14 = xor v12, v13\nstore.bit M 0.0, v14\nret v0",
        "v10 = eq v0, v1\nstore.bit M 0.0, v10\nret v0",
    );
    // Signed and unsigned orders do not mix.
    let text = "v10 = slt v0, v1\nv11 = ugt v0, v1\nv12 = or v10, v11\nstore.bit M 0.0, v12\nret v0";
    check(text, text);
    // The negation of `<` is not a comparison if an operand is NaN.
    let text = "v10 = flt v4, v4x\nv11 = const.i1 1\nv12 = xor v10, v11\nstore.bit M 0.0, v12\nret v0";
    let text = text.replace("v4x", "v20");
    let text = format!("v20 = fneg v4\n{text}");
    check(&text, &text);
}

#[test]
fn bounds_checks_are_decided_by_ranges() {
    check(
        "v10 = zext.i32 v3\nv11 = const.i32 65536\nv12 = ult v10, v11\nbranch v12, b1, b2\nb1:\nret v0\nb2:\nret v1",
        "jump b1\nb1:\nret v0",
    );
    check(
        "v10 = const.i32 255\nv11 = and v0, v10\nv12 = const.i32 4\nv13 = iadd v11, v12\nv14 = const.i32 300\nv15 = ugt v13, \
         v14\nstore.bit M 0.0, v15\nret v0",
        "v10 = const.i1 0\nstore.bit M 0.0, v10\nret v0",
    );
}

#[test]
fn bits_as_words_and_back() {
    check(
        "v10 = zext.i32 v2\nv11 = const.i32 0\nv12 = ne v10, v11\nstore.bit M 0.0, v12\nret v0",
        "store.bit M 0.0, v2\nret v0",
    );
    check(
        "v10 = const.i32 1\nv11 = const.i32 0\nv12 = select v2, v10, v11\nv13 = eq v12, v11\nbranch v13, b1, b2\nb1:\nret \
         v0\nb2:\nret v1",
        "branch v2, b2, b1\nb1:\nret v0\nb2:\nret v1",
    );
    check(
        "v10 = const.i1 1\nv11 = xor v2, v10\nv12 = and v2, v11\nv13 = or v5, v12\nv14 = and v5, v13\nstore.bit M 0.0, \
         v14\nret v0",
        "store.bit M 0.0, v5\nret v0",
    );
}

#[test]
fn arithmetic_on_constants() {
    check(
        "v10 = const.i32 5\nv11 = isub v0, v10\nv12 = const.i32 3\nv13 = iadd v12, v11\nret v13",
        "v10 = const.i32 4294967294\nv11 = iadd v0, v10\nret v11",
    );
    check(
        "v10 = const.i32 0\nv11 = const.i32 7\nv12 = sdiv v11, v10\nret v12",
        "v10 = const.i32 0\nv11 = const.i32 7\nv12 = sdiv v11, v10\nret v12",
    );
}

#[test]
fn a_known_switch_is_a_jump() {
    check("v10 = const.i32 1\nswitch v10 [b1, b2], b1\nb1:\nret v0\nb2:\nret v1", "jump b1\nb1:\nret v1");
}

#[test]
fn arms_that_differ_in_values_only_are_a_choice() {
    check(
        "branch v2, b1(v0, v1), b1(v1, v1)\nb1(v10: i32, v11: i32):\nv12 = iadd v10, v11\nret v12",
        "v10 = select v2, v0, v1\njump b1(v10, v1)\nb1(v11: i32, v12: i32):\nv13 = iadd v11, v12\nret v13",
    );
}

#[test]
fn zero_is_shifted_to_zero() {
    check("v10 = const.i32 0\nv11 = shl v10, v0\nret v11", "v10 = const.i32 0\nret v10");
}

#[test]
fn sums_of_extended_words_are_narrow() {
    // The pointer `i * 16 - 16`, which went through 64 bits.
    check(
        "v10 = zext.i64 v3\nv11 = const.i64 4\nv12 = shl v10, v11\nv13 = const.i64 18446744073709551600\nv14 = iadd v12, v13\n\
         v15 = trunc.i32 v14\nret v15",
        "v10 = zext.i32 v3\nv11 = const.i32 4\nv12 = shl v10, v11\nv13 = const.i32 4294967280\nv14 = iadd v12, v13\nret v14",
    );
}

#[test]
fn of_two_equal_values_it_does_not_matter_which_one_is_chosen() {
    for choice in ["v10 = eq v0, v1\nv11 = select v10, v0, v1", "v10 = ne v0, v1\nv11 = select v10, v1, v0"] {
        check(&format!("{choice}\nret v11"), "ret v1");
    }
    check("v10 = eq v0, v1\nv11 = select v10, v1, v0\nret v11", "ret v0");
    let text = "v10 = const.i32 7\nv11 = eq v0, v1\nv12 = select v11, v0, v10\nret v12";
    check(text, text);
}

#[test]
fn a_counter_under_a_condition_is_a_sum() {
    check(
        "v10 = const.i16 1\nv11 = iadd v3, v10\nv12 = select v2, v11, v3\nstore.i16 M 0, v12\nv13 = const.i32 4294967295\nv14 = iadd v0, \
         v13\nv15 = select v2, v0, v14\nret v15",
        "v10 = zext.i16 v2\nv11 = iadd v3, v10\nstore.i16 M 0, v11\nv12 = const.i1 1\nv13 = xor v2, v12\nv14 = zext.i32 v13\nv15 = isub v0, \
         v14\nret v15",
    );
    // Steps of another size need a selection anyway.
    let text = "v10 = const.i16 2\nv11 = iadd v3, v10\nv12 = select v2, v11, v3\nstore.i16 M 0, v12\nret v0";
    check(text, text);
}

#[test]
fn a_number_that_is_0_or_1_is_a_bit() {
    let text = "v10 = const.i32 1\nv11 = and v0, v10\nv12 = eq v11, v10\nv13 = zext.i16 v12\nv14 = iadd v3, v13\nstore.i16 M 0, v14\nret v0";
    check(text, "v10 = trunc.i1 v0\nv11 = zext.i16 v10\nv12 = iadd v3, v11\nstore.i16 M 0, v12\nret v0");
}

#[test]
fn limits_in_both_orders() {
    // From 0.0 to 100.0, or from 100.0 to 0.0.
    let text = "v10 = const.f32 0x0 ; 0.0\nv11 = const.f32 0x42c80000 ; 100.0\nv12 = fge v4, v10\nv13 = fle v4, v11\nv14 = and v12, v13\n";
    let other =
        "v15 = fle v4, v10\nv16 = fle v11, v4\nv17 = and v15, v16\nv18 = or v14, v17\nv19 = zext.i32 v18\nret v19";
    check(&format!("{text}{other}"), &format!("{text}v19 = zext.i32 v14\nret v19"));
    // 0.0 is not above -0.0.
    let text = "v10 = const.f32 0x0 ; 0.0\nv11 = const.f32 0x80000000 ; -0.0\nv12 = fge v4, v10\nv13 = fle v4, v11\nv14 = and v12, v13\nv15 = \
         zext.i32 v14\nret v15";
    check(text, text);
}

#[test]
fn a_number_between_two_constants_takes_one_comparison() {
    // From '0' to '9'.
    check(
        "v10 = const.i16 48\nv11 = uge v3, v10\nv12 = const.i16 57\nv13 = ule v3, v12\nv14 = and v11, v13\nv15 = zext.i32 v14\nret v15",
        "v10 = const.i16 65488\nv11 = iadd v3, v10\nv12 = const.i16 9\nv13 = ule v11, v12\nv14 = zext.i32 v13\nret v14",
    );
    check(
        "v10 = const.i16 65533\nv11 = sgt v3, v10\nv12 = const.i16 5\nv13 = slt v3, v12\nv14 = and v13, v11\nv15 = zext.i32 v14\nret v15",
        "v10 = const.i16 2\nv11 = iadd v3, v10\nv12 = const.i16 6\nv13 = ule v11, v12\nv14 = zext.i32 v13\nret v14",
    );
    // None is at least 9 and at most 3, and signs differ.
    for compares in ["v11 = uge v3, v10\nv13 = ule v3, v12", "v11 = sge v3, v12\nv13 = ule v3, v10"] {
        let text = format!(
            "v10 = const.i16 9\nv12 = const.i16 3\n{compares}\nv14 = and v11, v13\nv15 = zext.i32 v14\nret v15"
        );
        check(&text, &text);
    }
}
