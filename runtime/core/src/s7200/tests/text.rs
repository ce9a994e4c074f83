//! Numbers to text and back.

use plcc_abi::s7200::Operation;

use super::{DONE, FAILED, V, V_BYTES, cpu, gives, load_v, put_string, run, special_bit, string, v_bytes};
use crate::cpu::Cpu;

const COMMA: u32 = 8;

/// Text at V0 with `.` for blanks.
fn dotted(cpu: &Cpu, count: u32) -> String {
    String::from_utf8(v_bytes(cpu, 0, count)).unwrap().replace(' ', ".")
}

/// A number converted to text of fixed length; `None`: it failed and wrote blanks.
fn converted(operation: Operation, bits: u32, format: u32, count: u32) -> Option<String> {
    let cpu = cpu();
    load_v(&cpu, 0, &[b'#'; 20]);
    let result = run(&cpu, operation, &[bits, V, format]);
    assert_eq!(cpu.memory.byte(V + count), b'#');
    let text = dotted(&cpu, count);
    if result == FAILED {
        assert_eq!(text, ".".repeat(count as usize));
        return None;
    }
    assert_eq!(result, DONE);
    Some(text)
}

#[test]
fn int_to_ascii() {
    let text = |number: i16, format| converted(Operation::IntToAscii, u32::from(number as u16), format, 8);
    for (number, format, expected) in [
        // The examples of the manual.
        (12, COMMA | 3, "...0,012"),
        (-123, COMMA | 3, "..-0,123"),
        (1234, COMMA | 3, "...1,234"),
        (-12345, COMMA | 3, ".-12,345"),
        (0, 0, ".......0"),
        (-1, 0, "......-1"),
        (0, 5, ".0.00000"),
        (-1, 5, "-0.00001"),
        (-32768, 5, "-0.32768"),
        (-32768, 0, "..-32768"),
        (32767, 1, "..3276.7"),
    ] {
        assert_eq!(text(number, format).as_deref(), Some(expected), "{number} {format}");
    }
    for format in [6, 7, 14, 0x10, 0x80, 0xF3] {
        assert_eq!(text(1, format), None, "{format}");
    }
}

#[test]
fn dint_to_ascii() {
    let text = |number: i32, format| converted(Operation::DintToAscii, number as u32, format, 12);
    for (number, format, expected) in [
        // The examples of the manual.
        (-12, COMMA | 4, ".....-0,0012"),
        (1_234_567, COMMA | 4, "....123,4567"),
        (0, 0, "...........0"),
        (i32::MIN, 5, "-21474.83648"),
        (i32::MIN, 0, ".-2147483648"),
        (i32::MAX, 2, ".21474836.47"),
    ] {
        assert_eq!(text(number, format).as_deref(), Some(expected), "{number} {format}");
    }
    assert_eq!(text(1, 6), None);
    assert_eq!(text(1, 0x20), None);
}

#[test]
fn real_to_ascii() {
    let text = |number: f32, length: u32, format: u32| {
        converted(Operation::RealToAscii, number.to_bits(), length << 4 | format, length)
    };
    for (number, length, format, expected) in [
        // The examples of the manual.
        (1234.5, 6, COMMA | 1, "1234,5"),
        (-0.0004, 6, COMMA | 1, "...0,0"),
        (-3.67526, 6, COMMA | 1, "..-3,7"),
        (1.95, 6, COMMA | 1, "...2,0"),
        // Halves go away from zero.
        (0.5, 3, 0, "..1"),
        (-2.5, 3, 0, ".-3"),
        (0.25, 5, 1, "..0.3"),
        (0.125, 6, 2, "..0.13"),
        (-0.04, 5, 1, "..0.0"),
        (0.0, 3, 0, "..0"),
        (-0.0, 4, 1, ".0.0"),
        (99.96, 8, 1, "...100.0"),
        // 0.15 is 0.1500000059604645, 0.35 is 0.3499999940395355.
        (0.15, 5, 1, "..0.2"),
        (0.35, 5, 1, "..0.3"),
        (1e-45, 9, 5, "..0.00000"),
        (0.00001, 8, 5, ".0.00001"),
        // Seven digits: 123456.78125, 16777216, 9999999.
        (123_456.78, 10, 2, ".123456.80"),
        (16_777_216.0, 8, 0, "16777220"),
        (9_999_999.0, 8, 0, ".9999999"),
        (-9_999_999.0, 15, 5, "-9999999.00000"),
        (1e14, 15, 0, "100000000000000"),
    ] {
        let expected = format!("{expected:.>width$}", width = length as usize);
        assert_eq!(text(number, length, format).as_deref(), Some(expected.as_str()), "{number} {length} {format}");
    }
    for (number, length, format) in [
        (1.0, 0, 0),
        (1.0, 2, 0),
        (1.0, 3, 1),
        (1.0, 7, 5),
        (1.0, 15, 6),
        (1.0, 15, 7),
        (1000.0, 3, 0),
        (-100.0, 3, 0),
        (12_345.0, 6, 1),
        (1e15, 15, 0),
        (f32::MAX, 15, 0),
        (f32::NAN, 8, 0),
        (f32::INFINITY, 8, 0),
        (f32::NEG_INFINITY, 8, 0),
    ] {
        assert_eq!(text(number, length, format), None, "{number} {length} {format}");
    }
}

#[test]
fn numbers_become_strings() {
    let cpu = cpu();
    assert_eq!(run(&cpu, Operation::IntToString, &[12, V, COMMA | 3]), DONE);
    assert_eq!(string(&cpu, 0), "   0,012");
    assert_eq!(run(&cpu, Operation::DintToString, &[-12i32 as u32, V, COMMA | 4]), DONE);
    assert_eq!(string(&cpu, 0), "     -0,0012");
    assert_eq!(run(&cpu, Operation::RealToString, &[1234.5f32.to_bits(), V, 6 << 4 | 1]), DONE);
    assert_eq!(string(&cpu, 0), "1234.5");
    assert_eq!(run(&cpu, Operation::RealToString, &[1234.5f32.to_bits(), V, 5 << 4 | 1]), FAILED);
    assert_eq!(string(&cpu, 0), "     ");
    assert_eq!(run(&cpu, Operation::IntToString, &[1, V, 7]), FAILED);
    assert_eq!(string(&cpu, 0), "        ");
}

#[test]
fn text_stays_in_its_area() {
    let cpu = cpu();
    assert_eq!(run(&cpu, Operation::IntToAscii, &[1, V + V_BYTES - 8, 0]), DONE);
    assert_eq!(cpu.memory.byte(V + V_BYTES - 1), b'1');
    assert_eq!(run(&cpu, Operation::IntToAscii, &[2, V + V_BYTES - 7, 0]), FAILED);
    assert_eq!(run(&cpu, Operation::IntToString, &[2, V + V_BYTES - 8, 0]), FAILED);
    assert_eq!(run(&cpu, Operation::IntToAscii, &[2, V + V_BYTES - 7, 7]), FAILED);
    assert_eq!(cpu.memory.byte(V + V_BYTES - 1), b'1');
    assert_eq!(run(&cpu, Operation::RealToAscii, &[0, V + V_BYTES - 3, 3 << 4]), DONE);
    assert_eq!(run(&cpu, Operation::RealToString, &[0, V + V_BYTES - 3, 3 << 4]), FAILED);
}

#[test]
fn ascii_to_hex() {
    let cpu = cpu();
    // The example of the manual: ATH VB30, VB40, 3 with "3EA": 16#3E and 16#Ax.
    load_v(&cpu, 30, b"3EA");
    load_v(&cpu, 40, &[0, 0x77, 0x77]);
    assert_eq!(run(&cpu, Operation::AsciiToHex, &[V + 30, V + 40, 3]), DONE);
    assert_eq!(v_bytes(&cpu, 40, 3), [0x3E, 0xA7, 0x77]);
    assert!(!special_bit(&cpu, 1, 7));
    for bad in [b"1a", b"1/", b"1:", b"1@", b"1G"] {
        load_v(&cpu, 30, bad);
        load_v(&cpu, 40, &[0x55]);
        assert_eq!(run(&cpu, Operation::AsciiToHex, &[V + 30, V + 40, 2]), FAILED);
        assert_eq!(v_bytes(&cpu, 40, 1), [0x15]);
        assert!(special_bit(&cpu, 1, 7));
    }
    assert_eq!(run(&cpu, Operation::AsciiToHex, &[V + 30, V + 40, 0]), DONE);
    assert!(!special_bit(&cpu, 1, 7));
    // In place, and with sides that overlap the other way.
    load_v(&cpu, 30, b"89ABCDEF");
    assert_eq!(run(&cpu, Operation::AsciiToHex, &[V + 30, V + 31, 8]), DONE);
    assert_eq!(v_bytes(&cpu, 31, 4), [0x89, 0xAB, 0xCD, 0xEF]);
    assert_eq!(run(&cpu, Operation::AsciiToHex, &[V + V_BYTES - 3, V, 3]), FAILED);
    assert_eq!(run(&cpu, Operation::AsciiToHex, &[V + V_BYTES - 3, V, 4]), FAILED);
    assert_eq!(run(&cpu, Operation::AsciiToHex, &[V, V + V_BYTES - 1, 3]), FAILED);
}

#[test]
fn hex_to_ascii() {
    let cpu = cpu();
    load_v(&cpu, 30, &[0x3E, 0xA7, 0x09]);
    assert_eq!(run(&cpu, Operation::HexToAscii, &[V + 30, V + 40, 3]), DONE);
    assert_eq!(v_bytes(&cpu, 40, 4), [b'3', b'E', b'A', 0]);
    assert_eq!(run(&cpu, Operation::HexToAscii, &[V + 30, V + 30, 6]), DONE);
    assert_eq!(v_bytes(&cpu, 30, 7), *b"3EA709\0");
    assert_eq!(run(&cpu, Operation::HexToAscii, &[V, V + 1000, 0]), DONE);
    assert_eq!(run(&cpu, Operation::HexToAscii, &[V, V + V_BYTES - 254, 255]), FAILED);
    assert_eq!(run(&cpu, Operation::HexToAscii, &[V + V_BYTES - 1, V, 3]), FAILED);
    assert_eq!(run(&cpu, Operation::HexToAscii, &[V + V_BYTES - 1, V, 2]), DONE);
}

/// The value of the text from position 1 on.
fn read(operation: Operation, text: &str) -> u64 {
    let cpu = cpu();
    put_string(&cpu, 0, text);
    let result = run(&cpu, operation, &[V, 1]);
    assert_eq!(special_bit(&cpu, 1, 1), result == FAILED, "{text}");
    result
}

#[test]
fn strings_become_integers() {
    for (text, number) in [
        ("123", 123),
        ("-00456", -456),
        ("123.45", 123),
        ("+2345", 2345),
        ("000000123ABCD", 123),
        ("  12", 12),
        ("12.7", 12),
        ("A123", 0),
        ("", 0),
        ("   ", 0),
        ("++1", 0),
        ("+-1", 0),
        ("+ 12", 0),
        ("-", 0),
        ("32767", 32767),
        ("-32768", -32768),
    ] {
        assert_eq!(read(Operation::StringToInt, text), gives(u32::from(number as i16 as u16)), "{text}");
        assert_eq!(read(Operation::StringToDint, text), gives(number as u32), "{text}");
    }
    assert_eq!(read(Operation::StringToInt, "32768"), FAILED);
    assert_eq!(read(Operation::StringToInt, "-32769"), FAILED);
    assert_eq!(read(Operation::StringToDint, "2147483647"), gives(0x7FFF_FFFF));
    assert_eq!(read(Operation::StringToDint, "-2147483648"), gives(0x8000_0000));
    assert_eq!(read(Operation::StringToDint, "2147483648"), FAILED);
    assert_eq!(read(Operation::StringToDint, &"9".repeat(254)), FAILED);
    assert_eq!(read(Operation::StringToDint, &format!("-{}", "9".repeat(253))), FAILED);
}

#[test]
fn strings_become_reals() {
    for (text, number) in [
        ("123", 123.0),
        ("-00456", -456.0),
        ("123.45", 123.45),
        ("123,45", 123.45),
        ("+2345", 2345.0),
        ("00.000000123", 0.000_000_123),
        ("1.345E8", 1.345),
        ("  -1.5x", -1.5),
        ("5.", 5.0),
        (".5", 0.5),
        ("1.2.3", 1.2),
        ("A123", 0.0),
        ("", 0.0),
        (".", 0.0),
        ("++123", 0.0),
        ("+ 12", 0.0),
        ("16777217", 16_777_216.0),
    ] {
        assert_eq!(read(Operation::StringToReal, text), gives(f32::to_bits(number)), "{text}");
    }
    assert_eq!(read(Operation::StringToReal, &format!("1{}", "0".repeat(38))), gives(1e38f32.to_bits()));
    assert_eq!(read(Operation::StringToReal, &format!("1{}", "0".repeat(39))), FAILED);
    assert_eq!(read(Operation::StringToReal, &"0".repeat(254)), gives(0));
    let long = format!("1.{}", "1".repeat(252));
    assert_eq!(read(Operation::StringToReal, &long), gives(((10.0 / 9.0) as f32).to_bits()));
}

#[test]
fn numbers_are_read_from_a_position_on() {
    let cpu = cpu();
    // As an example of the manual: the number begins after words.
    put_string(&cpu, 0, "Temp  98.6C");
    assert_eq!(run(&cpu, Operation::StringToInt, &[V, 7]), gives(98));
    assert_eq!(run(&cpu, Operation::StringToReal, &[V, 7]), gives(98.6f32.to_bits()));
    assert_eq!(run(&cpu, Operation::StringToReal, &[V, 5]), gives(98.6f32.to_bits()));
    assert_eq!(run(&cpu, Operation::StringToDint, &[V, 11]), gives(0));
    for index in [0, 12, 255] {
        for operation in [Operation::StringToInt, Operation::StringToDint, Operation::StringToReal] {
            assert_eq!(run(&cpu, operation, &[V, index]), FAILED);
        }
    }
    // Not a string: too long for its area, or for a string.
    load_v(&cpu, V_BYTES - 2, &[2, b'1']);
    assert_eq!(run(&cpu, Operation::StringToInt, &[V + V_BYTES - 2, 1]), FAILED);
    load_v(&cpu, 0, &[255, b'1']);
    assert_eq!(run(&cpu, Operation::StringToInt, &[V, 1]), FAILED);
}
