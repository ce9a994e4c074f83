//! A message for each rule of the verifier.

use crate::parse::parse_module;

/// Verifies a function `@F` with `body`; returns the first message, empty if there is none.
fn message(body: &str) -> String {
    let text = format!(
        "db 10 at 0x400000 length 20\nfunc @F -> i32 frame 16 {{\nb0(v0: i32, v1: i1):\n{body}\n}}\nfunc @G \
         {{\nb0:\nret\n}}\n"
    );
    let module = parse_module(&text).expect("text is well formed");
    match super::verify(&module) {
        Ok(()) => String::new(),
        Err(errors) => errors[0].message.clone(),
    }
}

#[test]
fn a_good_function_passes() {
    assert_eq!(
        message("branch v1, b1, b2\nb1:\nv2 = iadd v0, v0\njump b3(v2)\nb2:\njump b3(v0)\nb3(v3: i32):\nret v3"),
        ""
    );
}

#[test]
fn broken_rules_are_found() {
    for (body, expected) in [
        ("ret", "the returned values are (i32), not ()"),
        ("v2 = iadd v0, v1\nret v0", "v1 is i1, not i32"),
        ("v2 = iadd v1, v1\nret v0", "`iadd` does not take i1"),
        ("v2 = slt v1, v1\nret v0", "`slt` does not take i1"),
        ("v2 = const.i8 256\nret v0", "the constant does not fit its type"),
        ("v2 = zext.i32 v0\nret v0", "`zext` does not go from i32 to i32"),
        ("v2 = fsqrt v0\nret v0", "`fsqrt` does not take i32"),
        ("v2 = load.i1 M 0\nret v0", "an i1 is loaded as a bit"),
        ("v2 = load.bit M 0.8\nret v0", "a byte has the bits 0 to 7"),
        ("v2 = load.i32 M 65533\nret v0", "the access ends at byte 65537, M has 65536"),
        ("v2 = load.i32 L 14\nret v0", "the access ends at byte 18, L has 16"),
        ("v2 = load.i32 DB10 17\nret v0", "the access ends at byte 21, DB10 has 20"),
        ("v2 = load.i32 DB11[v0]+0\nret v0", "the module has no DB11"),
        ("v2 = load.i32 any 4\nret v0", "an access anywhere needs a base"),
        ("v2 = load.i32 M[v1]+4\nret v0", "v1 is i1, not i32"),
        ("call @G(v0)\nret v0", "the arguments are (), not (i32)"),
        ("v2 = rt @s7200_counter(v1)\nret v0", "the arguments are (i32), not (i1)"),
        ("branch v0, b1, b1\nb1:\nret v0", "v0 is i32, not i1"),
        ("jump b1\nb1(v2: i32):\nret v2", "the values for b1 are (i32), not ()"),
        ("jump b0(v0, v1)", "a jump goes to the entry block"),
        ("ret v0\nret v0", "a terminator ends a block"),
        ("v2 = iadd v0, v0", "the block ends without a terminator"),
        ("jump b1\nb1:", "the block is empty"),
        ("ret v0 !1", "site 1 does not exist"),
        ("v2 = iadd v3, v0\nv3 = iadd v0, v0\nret v0", "the definition of v3 does not dominate this use"),
        (
            "branch v1, b1, b2\nb1:\nv2 = iadd v0, v0\njump b2\nb2:\nret v2",
            "the definition of v2 does not dominate this use",
        ),
    ] {
        assert_eq!(message(body), expected, "{body}");
    }
}

#[test]
fn module_rules() {
    for (text, expected) in [
        ("entry @F\nfunc @F {\nb0(v0: i32):\nret\n}", "@F: an entry takes and returns nothing"),
        ("func @F frame 4 {\nb0:\nret\n}", "@F: a frame of 4 bytes is not aligned or too large"),
        ("db 2 at 0x400000 length 2\ndb 1 at 0x400010 length 2", "DB1 comes after DB2"),
        ("db 2 at 0 length 2", "DB2 lies outside the data of DBs"),
    ] {
        let errors = super::verify(&parse_module(text).expect("text is well formed")).expect_err("a rule is broken");
        assert_eq!(errors[0].to_string(), expected);
    }
}
