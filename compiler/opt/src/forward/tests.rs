use crate::tests::check_body;

fn check(body: &str, expected: &str) {
    check_body("forward", body, expected);
}

#[test]
fn bits_are_forwarded_past_other_bits_and_regions() {
    check(
        "store.bit M 10.0, v1\nstore.bit M 10.1, v1\nstore.i32 DB5 0, v0\nv2 = load.bit M 10.0\nstore.bit Q 0.0, \
         v2\nret v0",
        "store.bit M 10.0, v1\nstore.bit M 10.1, v1\nstore.i32 DB5 0, v0\nstore.bit Q 0.0, v1\nret v0",
    );
}

#[test]
fn a_bit_makes_its_byte_unknown() {
    let text = "store.i32 M 10, v0\nstore.bit M 12.3, v1\nv2 = load.i32 M 10\nret v2";
    check(text, text);
}

#[test]
fn parts_come_out_of_the_whole() {
    check(
        "store.i32 M 10, v0\nv2 = load.bit M 11.5\nstore.bit Q 0.0, v2\nv3 = load.i16 M 12\nstore.i16 Q 2, v3\nret v0",
        "store.i32 M 10, v0\nv2 = const.i32 21\nv3 = lshr v0, v2\nv4 = trunc.i1 v3\nstore.bit Q 0.0, v4\nv5 = trunc.i16 \
         v0\nstore.i16 Q 2, v5\nret v0",
    );
}

#[test]
fn other_bases_may_be_the_same_place() {
    let text = "store.i32 M 10, v0\nstore.bit M[v0]+0.0, v1\nv2 = load.i32 M 10\nret v2";
    check(text, text);
    let text = "store.i32 DB5 0, v0\nstore.bit anydb[v0]+0.0, v1\nv2 = load.i32 DB5 0\nret v2";
    check(text, text);
    let text = "store.i32 anydb[v0]+0, v0\nstore.bit DB5 0.0, v1\nv2 = load.i32 anydb[v0]+0\nret v2";
    check(text, text);
}

#[test]
fn calls_forget_all_but_a_private_frame() {
    check(
        "store.i32 M 0, v0\nstore.i32 L 0, v0\ncall @G()\nv2 = load.i32 M 0\nv3 = load.i32 L 0\nv4 = iadd v2, v3\nret v4",
        "store.i32 M 0, v0\nstore.i32 L 0, v0\ncall @G()\nv2 = load.i32 M 0\nv4 = iadd v2, v0\nret v4",
    );
    let text = "store.i32 L 0, v0\ncall @H()\nv2 = load.i32 L 0\nret v2";
    check(text, text);
    let text = "store.i32 L 0, v0\nv2 = address L 8\nstore.i32 M 0, v2\ncall @G()\nv3 = load.i32 L 0\nret v3";
    check(text, text);
}

#[test]
fn a_frame_stays_private_when_code_chooses_among_its_address_and_others() {
    let around = |last: &str| {
        format!(
            "store.i32 L 0, v0\nv2 = address L 8\nv3 = const.i32 200704\nv4 = select v1, v2, v3\njump b1(v4)\nb1(v5: \
             i32):\nv6 = load.i32 any[v5]+0\ncall @G()\n{last}"
        )
    };
    check(&around("v7 = load.i32 L 0\nv8 = iadd v6, v7\nret v8"), &around("v8 = iadd v6, v0\nret v8"));
    let text = around("store.i32 M 0, v5\ncall @G()\nv7 = load.i32 L 0\nv8 = iadd v6, v7\nret v8");
    check(&text, &text);
}

#[test]
fn cleared_memory_reads_0() {
    check(
        "clear L 0, 16\nstore.i16 L 4, v1x\nv2 = load.i32 L 8\nret v2".replace("store.i16 L 4, v1x\n", "").as_str(),
        "clear L 0, 16\nv2 = const.i32 0\nret v2",
    );
}

#[test]
fn a_private_frame_is_known_behind_a_safepoint() {
    let around = |after: &str| {
        format!(
            "store.i32 L 0, v0\nstore.i32 M 0, v0\nbranch v1, b1, b2\nb1 cold:\nv2 = rt \
             @safepoint(v0)\njump b2\nb2:\n{after}"
        )
    };
    check(
        &around("v3 = load.i32 L 0\nv4 = load.i32 M 0\nv5 = iadd v3, v4\nret v5"),
        &around("v4 = load.i32 M 0\nv5 = iadd v0, v4\nret v5"),
    );
}

#[test]
fn memory_is_known_behind_a_look_at_the_clock() {
    let around = |after: &str| {
        format!(
            "store.i32 M 0, v0\nstore.i32 cells 0, v0\nbranch v1, b1, b2\nb1 cold:\nrt @timer_settle(v0)\njump b2\nb2:\n{after}"
        )
    };
    check(
        &around("v3 = load.i32 M 0\nv4 = load.i32 cells 0\nv5 = iadd v3, v4\nret v5"),
        &around("v4 = load.i32 cells 0\nv5 = iadd v0, v4\nret v5"),
    );
}

#[test]
fn joins_keep_what_both_sides_know() {
    check(
        "store.i32 M 0, v0\nbranch v1, b1, b2\nb1:\nstore.i32 M 4, v0\njump b2\nb2:\nv2 = load.i32 M 0\nv3 = load.i32 M \
         4\nv4 = iadd v2, v3\nret v4",
        "store.i32 M 0, v0\nbranch v1, b1, b2\nb1:\nstore.i32 M 4, v0\njump b2\nb2:\nv3 = load.i32 M 4\nv4 = iadd v0, \
         v3\nret v4",
    );
}

#[test]
fn the_rest_of_a_word_is_still_known() {
    check(
        "store.i32 M 0, v0\nstore.bit M 1.0, v1\nv2 = load.bit M 1.1\nstore.bit Q 0.0, v2\nv3 = load.i16 M 2\nstore.i16 Q 2, \
         v3\nv4 = load.i16 M 0\nstore.i16 Q 4, v4\nret v0",
        "store.i32 M 0, v0\nstore.bit M 1.0, v1\nv2 = const.i32 17\nv3 = lshr v0, v2\nv4 = trunc.i1 v3\nstore.bit Q 0.0, v4\n\
         v5 = trunc.i16 v0\nstore.i16 Q 2, v5\nv6 = load.i16 M 0\nstore.i16 Q 4, v6\nret v0",
    );
}

#[test]
fn what_several_stores_wrote_is_put_together() {
    check(
        "v2 = trunc.i8 v0\nstore.i32 M 0, v0\nstore.i8 M 2, v2\nv3 = load.i16 M 1\nstore.i16 Q 0, v3\nv4 = load.i32 M 0\nret v4",
        "v2 = trunc.i8 v0\nstore.i32 M 0, v0\nstore.i8 M 2, v2\nv3 = const.i32 16\nv4 = lshr v0, v3\nv5 = trunc.i16 v4\nv6 = \
         const.i16 8\nv7 = shl v5, v6\nv8 = zext.i16 v2\nv9 = or v7, v8\nstore.i16 Q 0, v9\nv10 = const.i32 16\nv11 = lshr v0, \
         v10\nv12 = const.i32 16\nv13 = shl v11, v12\nv14 = zext.i32 v2\nv15 = const.i32 8\nv16 = shl v14, v15\nv17 = or v13, \
         v16\nv18 = const.i32 255\nv19 = and v0, v18\nv20 = or v17, v19\nret v20",
    );
    check(
        "v2 = trunc.i8 v0\nclear M 0, 4\nstore.i8 M 3, v2\nv3 = load.i32 M 0\nret v3",
        "v2 = trunc.i8 v0\nclear M 0, 4\nstore.i8 M 3, v2\nv3 = zext.i32 v2\nret v3",
    );
    // Loads do not wait for loads, and a hole may hold anything.
    let text = "v2 = load.i8 M 0\nv3 = load.i8 M 1\nstore.i8 Q 0, v2\nstore.i8 Q 1, v3\nv4 = load.i16 M 0\nstore.i16 L 0, v4\nret v0";
    check(text, text);
    let text = "v2 = trunc.i8 v0\nstore.i8 M 0, v2\nstore.i8 M 2, v2\nv3 = load.i32 M 0\nret v3";
    check(text, text);
}

#[test]
fn bits_are_read_with_their_word_or_byte() {
    check_body(
        "words",
        "v2 = load.bit M 4.1\nv3 = load.bit M 5.0\nv4 = load.bit M 8.2\nv5 = and v2, v3\nv6 = and v5, v4\nstore.bit M 4.0, v5\nstore.bit \
         M 8.3, v6\nv7 = load.bit M 8.4\nstore.bit Q 0.0, v7\nret v0",
        "v2 = load.i32 M 4\nv3 = const.i32 25\nv4 = lshr v2, v3\nv5 = trunc.i1 v4\nv6 = const.i32 16\nv7 = lshr v2, v6\nv8 = \
         trunc.i1 v7\nv9 = load.i8 M 8\nv10 = const.i8 2\nv11 = lshr v9, v10\nv12 = trunc.i1 v11\nv13 = and v5, v8\nv14 = and \
         v13, v12\nstore.bit M 4.0, v13\nstore.bit M 8.3, v14\nv15 = const.i8 4\nv16 = lshr v9, v15\nv17 = trunc.i1 v16\nstore.bit Q 0.0, v17\nret v0",
    );
}

#[test]
fn a_copy_takes_along_what_is_known() {
    check(
        "store.i32 M 0, v0\nstore.bit M 4.1, v1\ncopy M 12, M 0, 8\nv2 = load.i32 M 12\nv3 = load.i16 M 14\nv4 = load.bit M 16.1\nv5 = load.i8 \
         M 17\nstore.i32 Q 0, v2\nstore.i16 Q 4, v3\nstore.bit Q 6.0, v4\nret v0",
        "store.i32 M 0, v0\nstore.bit M 4.1, v1\ncopy M 12, M 0, 8\nv2 = trunc.i16 v0\nv3 = load.i8 M 17\nstore.i32 Q 0, v0\nstore.i16 Q 4, \
         v2\nstore.bit Q 6.0, v1\nret v0",
    );
    // The source as it was before, though the copy overwrites a part of it.
    check(
        "store.i32 M 4, v0\nclear M 8, 4\ncopy M 6, M 4, 8\nv2 = load.i32 M 6\nv3 = load.i32 M 10\nv4 = load.i16 M 4\nstore.i32 Q 0, \
         v2\nstore.i32 Q 4, v3\nstore.i16 Q 8, v4\nret v0",
        "store.i32 M 4, v0\nclear M 8, 4\ncopy M 6, M 4, 8\nv2 = const.i32 0\nv3 = const.i32 16\nv4 = lshr v0, v3\nv5 = trunc.i16 v4\n\
         store.i32 Q 0, v0\nstore.i32 Q 4, v2\nstore.i16 Q 8, v5\nret v0",
    );
    // A part of a value whose beginning is not copied.
    check(
        "store.i32 M 8, v0\ncopy Q 0, M 10, 4\nv2 = load.i16 Q 0\nstore.i16 L 0, v2\ncopy Q 8, M 10, 4\nv3 = load.i16 Q 8\nstore.i16 L 2, v3\nret v0",
        "store.i32 M 8, v0\ncopy Q 0, M 10, 4\nv2 = load.i16 Q 0\nstore.i16 L 0, v2\ncopy Q 8, M 10, 4\nv3 = trunc.i16 v0\nstore.i16 L 2, v3\nret v0",
    );
}
