use crate::tests::check_pass;

/// A loop in a program of OB 1, and OB 35 with these instructions.
fn program(before: &str, inside: &str, end: &str, after: &str, others: &str) -> String {
    format!(
        "db 5 at 0x400000 length 200
        entry @OB1
        entry @OB35
        func @F {{
        b0(v0: i32, v1: i1):
        {before}
        {inside}
        {end}
        {after}
        }}
        func @OB1 {{
        b0:
        ret
        }}
        func @OB35 {{
        b0:
        v0 = const.i32 7
        {others}
        ret
        }}"
    )
}

fn check(text: [&str; 4], expected: [&str; 4], others: &str) {
    let of = |[before, inside, end, after]: [&str; 4]| program(before, inside, end, after, others);
    check_pass("loop-memory", &of(text), &of(expected));
}

#[test]
fn a_sum_in_a_db_is_a_value_in_its_loop() {
    check(
        [
            "jump b1",
            "b1:\nv2 = load.i32 DB5 8\nv3 = iadd v2, v0\nstore.i32 DB5 8, v3\nstore.bit M 0.0, v1",
            "branch v1, b1, b2",
            "b2:\nret",
        ],
        [
            "jump b3\nb3:\nv4 = load.i32 DB5 8\nv5 = load.bit M 0.0\njump b1(v4)",
            "b1(v2: i32):\nv3 = iadd v2, v0",
            "branch v1, b1(v3), b4",
            "b4:\nstore.i32 DB5 8, v3\nstore.bit M 0.0, v1\njump b2\nb2:\nret",
        ],
        "",
    );
}

#[test]
fn a_safepoint_sees_the_place_and_what_it_may_change_is_loaded_again() {
    let text = [
        "jump b1",
        "b1:\nv2 = load.i32 DB5 8\nv3 = iadd v2, v0\nstore.i32 DB5 8, v3",
        "branch v1, b2, b3\nb2 cold:\nv4 = rt @safepoint(v0)\njump b3\nb3:\nv5 = ne v3, v0\nbranch v5, b1, b4",
        "b4:\nret",
    ];
    // OB 35 writes other data.
    check(
        text,
        [
            "jump b5\nb5:\nv6 = load.i32 DB5 8\njump b1(v6)",
            "b1(v2: i32):\nv3 = iadd v2, v0",
            "branch v1, b2, b3\nb2 cold:\nstore.i32 DB5 8, v3\nv4 = rt @safepoint(v0)\njump b3\nb3:\nv5 = ne v3, v0\nbranch v5, \
             b1(v3), b6",
            "b6:\nstore.i32 DB5 8, v3\njump b4\nb4:\nret",
        ],
        "store.i32 M 0, v0",
    );
    check(
        text,
        [
            "jump b5\nb5:\nv6 = load.i32 DB5 8\njump b1(v6)",
            "b1(v2: i32):\nv3 = iadd v2, v0",
            "branch v1, b2, b3(v3)\nb2 cold:\nstore.i32 DB5 8, v3\nv4 = rt @safepoint(v0)\nv7 = load.i32 DB5 8\njump \
             b3(v7)\nb3(v8: i32):\nv5 = ne v3, v0\nbranch v5, b1(v8), b6",
            "b6:\nstore.i32 DB5 8, v8\njump b4\nb4:\nret",
        ],
        "store.i32 DB5 0, v0",
    );
}

#[test]
fn what_an_index_may_reach_stays_in_memory() {
    let around = |index: &str, first: &str, body: &str, back: &str, last: &str| {
        program(&format!("{index}\njump {first}"), body, &format!("store.i16 anydb[v3]+4194304, v4\n{back}"), last, "")
    };
    // The index ends at 126, so that the array ends where the sum begins.
    let index = "v2 = const.i32 126\nv3 = and v0, v2\nv4 = trunc.i16 v0";
    let text = around(
        index,
        "b1",
        "b1:\nv5 = load.i32 DB5 128\nv6 = iadd v5, v0\nstore.i32 DB5 128, v6",
        "branch v1, b1, b2",
        "b2:\nret",
    );
    let expected = around(
        index,
        "b3\nb3:\nv9 = load.i32 DB5 128\njump b1(v9)",
        "b1(v5: i32):\nv6 = iadd v5, v0",
        "branch v1, b1(v6), b4",
        "b4:\nstore.i32 DB5 128, v6\njump b2\nb2:\nret",
    );
    check_pass("loop-memory", &text, &expected);
    let text = text.replace("DB5 128", "DB5 127");
    check_pass("loop-memory", &text, &text);
}

#[test]
fn a_part_of_a_place_is_part_of_its_value() {
    let text = program(
        "jump b1",
        "b1:\nv2 = load.i16 M 0\nstore.i16 M 2, v2\nv3 = load.i8 M 1\nstore.i8 M 3, v3",
        "branch v1, b1, b2",
        "b2:\nret",
        "",
    );
    let expected = program(
        "jump b3\nb3:\nv9 = load.i16 M 2\nv2 = load.i16 M 0\nv3 = load.i8 M 1\njump b1",
        "b1:\nv5 = const.i16 65280\nv6 = and v2, v5\nv7 = zext.i16 v3\nv8 = or v6, v7",
        "branch v1, b1, b4",
        "b4:\nstore.i16 M 2, v8\njump b2\nb2:\nret",
        "",
    );
    check_pass("loop-memory", &text, &expected);
}

#[test]
fn places_of_which_none_is_part_of_the_other_stay_in_memory() {
    let text = program(
        "jump b1",
        "b1:\nv2 = load.i16 M 0\nstore.i16 M 2, v2\nv3 = load.i16 M 6\nstore.i16 M 3, v3",
        "branch v1, b1, b2",
        "b2:\nret",
        "",
    );
    let expected = program(
        "jump b3\nb3:\nv2 = load.i16 M 0\nv3 = load.i16 M 6\njump b1",
        "b1:\nstore.i16 M 2, v2\nstore.i16 M 3, v3",
        "branch v1, b1, b2",
        "b2:\nret",
        "",
    );
    check_pass("loop-memory", &text, &expected);
}

#[test]
fn a_place_in_an_arm_of_a_switch_stays_in_memory() {
    let text = [
        "jump b1",
        "b1:\nswitch v0 [b2, b3], b4\nb2:\nstore.i32 DB5 8, v0\njump b4\nb3:\nstore.i32 DB5 12, v0\njump b4\nb4:",
        "branch v1, b1, b5",
        "b5:\nret",
    ];
    check(text, text, "");
}
