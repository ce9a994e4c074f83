//! Constants as text, in the form that reads back to the same value.

use plcc_literal::duration::s5time_milliseconds;
use plcc_literal::written::{self, DAYS_TO_1990, date, time_of_day};
use plcc_syntax::Elementary;
use plcc_syntax::literal::{ANY_TYPES, Literal};
use plcc_syntax::stl::Mnemonics;

/// A constant of STL.
pub fn stl(value: &Literal, set: Mnemonics) -> String {
    match value {
        Literal::Bool(value) => if *value { "TRUE" } else { "FALSE" }.to_string(),
        Literal::Int(value) => value.to_string(),
        Literal::Dint(value) => format!("L#{value}"),
        Literal::Byte(value) => format!("B#16#{value:02X}"),
        Literal::Word(value) => format!("W#16#{value:04X}"),
        Literal::Dword(value) => format!("DW#16#{value:08X}"),
        Literal::Bits { value, digits } if digits % 4 == 0 => {
            format!("16#{value:0width$X}", width = usize::from(digits / 4))
        }
        Literal::Bits { value, digits } => format!("2#{value:0width$b}", width = usize::from(*digits)),
        Literal::Bytes2([a, b]) => format!("B#({a},{b})"),
        Literal::Bytes4([a, b, c, d]) => format!("B#({a},{b},{c},{d})"),
        Literal::Real(value) => real(f64::from(*value), &format!("{value:?}")),
        Literal::S5Time(word) => s5time(*word).unwrap_or_else(|| format!("W#16#{word:04X}")),
        Literal::Time(ms) => duration("T#", i128::from(*ms) * 1_000_000),
        Literal::Date(days) => format!("D#{}", date(i64::from(*days) + DAYS_TO_1990)),
        Literal::TimeOfDay(ms) => format!("TOD#{}", time_of_day(u64::from(*ms) * 1_000_000)),
        Literal::DateAndTime(bytes) => date_and_time(bytes),
        Literal::Counter(bcd) => format!("C#{bcd:X}"),
        Literal::Text(bytes) => text(bytes),
        Literal::Pointer(bits) => format!("P#{}", address(*bits)),
        Literal::AreaPointer { db, pointer } => format!("P#{}", area_address(*db, *pointer, set)),
        Literal::Any(bytes) => any(bytes, set),
    }
}

/// A typed constant of SCL: its bits, zero-extended.
pub fn typed(ty: Elementary, bits: u64) -> String {
    let signed = |width: u32| (bits << (64 - width)).cast_signed() >> (64 - width);
    match ty {
        Elementary::Bool => if bits == 0 { "FALSE" } else { "TRUE" }.to_string(),
        Elementary::Byte => format!("BYTE#16#{bits:02X}"),
        Elementary::Word => format!("WORD#16#{bits:04X}"),
        Elementary::Dword => format!("DWORD#16#{bits:08X}"),
        Elementary::Lword => format!("LWORD#16#{bits:016X}"),
        Elementary::Char => format!("CHAR#{}", text(&[bits as u8])),
        Elementary::Wchar => format!("WCHAR#{}", wide_text(&[bits as u16])),
        Elementary::Sint | Elementary::Int | Elementary::Dint | Elementary::Lint => {
            format!("{}#{}", ty.name(), signed(ty.bits()))
        }
        Elementary::Usint | Elementary::Uint | Elementary::Udint | Elementary::Ulint => {
            format!("{}#{bits}", ty.name())
        }
        Elementary::Real => {
            let value = f32::from_bits(bits as u32);
            format!("REAL#{}", real(f64::from(value), &format!("{value:?}")))
        }
        Elementary::Lreal => {
            let value = f64::from_bits(bits);
            format!("LREAL#{}", real(value, &format!("{value:?}")))
        }
        Elementary::S5Time => s5time(bits as u16).unwrap_or_else(|| format!("WORD#16#{bits:04X}")),
        Elementary::Time => duration("T#", i128::from(signed(32)) * 1_000_000),
        Elementary::Ltime => duration("LT#", i128::from(bits.cast_signed())),
        Elementary::Date => format!("D#{}", date(bits as i64 + DAYS_TO_1990)),
        Elementary::TimeOfDay => format!("TOD#{}", time_of_day(bits * 1_000_000)),
        Elementary::Ltod => format!("LTOD#{}", time_of_day(bits)),
        Elementary::Ldt => format!("LDT#{}", written::date_and_time(bits.cast_signed())),
    }
}

/// A number with a decimal point; `shortest` is the shortest text that reads back to it.
pub fn real(value: f64, shortest: &str) -> String {
    if !value.is_finite() {
        // No constant has this value; what reads it says so.
        return shortest.to_string();
    }
    match shortest.split_once('e') {
        Some((mantissa, exponent)) if !mantissa.contains('.') => format!("{mantissa}.0e{exponent}"),
        _ => shortest.to_string(),
    }
}

/// `S5T#1H30M`, if the word is a BCD number with the time base that STEP 7 chooses for the duration.
pub fn s5time(word: u16) -> Option<String> {
    let ms = s5time_milliseconds(word).filter(|_| word >> 14 == 0)?;
    let bases = [(10, 0u16), (100, 1), (1_000, 2), (10_000, 3)];
    let chosen = bases.iter().find(|(base, _)| ms / base <= 999)?;
    (chosen.1 == word >> 12 & 3).then(|| duration("S5T#", i128::from(ms) * 1_000_000))
}

/// `T#1D2H3M4S5MS`, of nanoseconds.
fn duration(prefix: &str, ns: i128) -> String {
    format!("{prefix}{}", written::duration(ns))
}

/// Eight BCD bytes; years from 90 are of the last century, the last digit is the day of the week.
pub fn date_and_time(bytes: &[u8; 8]) -> String {
    let two = |byte: u8| u32::from(byte >> 4) * 10 + u32::from(byte & 0xF);
    let year = two(bytes[0]);
    let year = if year >= 90 { 1900 + year } else { 2000 + year };
    let ms = two(bytes[6]) * 10 + u32::from(bytes[7] >> 4);
    let [month, day, hour, minute, second] = [1, 2, 3, 4, 5].map(|at| two(bytes[at]));
    format!("DT#{year}-{month:02}-{day:02}-{hour:02}:{minute:02}:{second:02}.{ms:03}")
}

/// `DTL#…`, of the twelve bytes of the structure.
pub fn dtl(bytes: &[u8; 12]) -> String {
    let year = u16::from_be_bytes([bytes[0], bytes[1]]);
    let ns = u32::from_be_bytes([bytes[8], bytes[9], bytes[10], bytes[11]]);
    format!("DTL#{year}-{:02}-{:02}-{:02}:{:02}:{:02}.{ns:09}", bytes[2], bytes[3], bytes[5], bytes[6], bytes[7])
}

/// `'text'`, of Windows-1252, with `$` before what cannot be written.
pub fn text(bytes: &[u8]) -> String {
    let mut out = String::from("'");
    for byte in bytes {
        match byte {
            b'$' => out.push_str("$$"),
            b'\'' => out.push_str("$'"),
            0x20..=0x7E => out.push(char::from(*byte)),
            // What Windows-1252 has as Latin-1.
            0xA0..=0xFF => out.push(char::from(*byte)),
            _ => out.push_str(&format!("${byte:02X}")),
        }
    }
    out.push('\'');
    out
}

/// `'text'` of UTF-16.
pub fn wide_text(units: &[u16]) -> String {
    let mut out = String::from("'");
    for unit in units {
        match char::from_u32(u32::from(*unit)) {
            Some('$') => out.push_str("$$"),
            Some('\'') => out.push_str("$'"),
            Some(c) if !c.is_control() => out.push(c),
            _ => out.push_str(&format!("${unit:04X}")),
        }
    }
    out.push('\'');
    out
}

/// `10.3`, of an area-internal pointer.
fn address(bits: u32) -> String {
    format!("{}.{}", (bits & 0x7_FFFF) >> 3, bits & 7)
}

/// `M 10.0`, `DB5.DBX 0.0`.
pub fn area_address(db: u16, pointer: u32, set: Mnemonics) -> String {
    let (en, de) = match pointer >> 24 {
        0x80 => ("P", "P"),
        0x81 => ("I", "E"),
        0x82 => ("Q", "A"),
        0x83 => ("M", "M"),
        0x84 => ("DBX", "DBX"),
        0x85 => ("DIX", "DIX"),
        0x86 => ("L", "L"),
        0x87 => ("V", "V"),
        0x7B => ("C", "Z"),
        0x7C => ("T", "T"),
        _ => ("", ""),
    };
    let area = if set == Mnemonics::De { de } else { en };
    let db = if db == 0 { String::new() } else { format!("DB{db}.") };
    format!("{db}{area} {}", address(pointer))
}

/// `P#DB11.DBX 20.0 INT 10`, of the ten bytes of an ANY.
pub fn any(bytes: &[u8; 10], set: Mnemonics) -> String {
    let ty = ANY_TYPES.iter().find(|(_, code)| *code == bytes[1]).map_or("VOID", |(name, _)| name);
    let [count, db] = [2, 4].map(|at| u16::from_be_bytes([bytes[at], bytes[at + 1]]));
    let pointer = u32::from_be_bytes([bytes[6], bytes[7], bytes[8], bytes[9]]);
    // Timers and counters have a number in place of a pointer.
    let pointer = match bytes[1] {
        0x1C if pointer >> 16 == 0 => 0x7B << 24 | pointer << 3,
        0x1D if pointer >> 16 == 0 => 0x7C << 24 | pointer << 3,
        _ => pointer,
    };
    format!("P#{} {ty} {count}", area_address(db, pointer, set))
}

#[cfg(test)]
mod tests {
    use super::*;
    use plcc_syntax::literal;

    /// Each constant reads back to the value that was written.
    #[test]
    fn constants_read_back() {
        let texts = "TRUE -5 L#-100000 B#16#0F W#16#00FF DW#16#00FF 16#0012 2#101 B#(1,8) B#(1,14,100,120) 1.5 1.0e38 \
            -2.5e-10 S5T#2S S5T#1H30M S5T#10MS S5T#2H46M30S S5T#0MS T#1D2H3M4S5MS T#-5MS T#0MS D#2000-2-29 D#1990-1-1 \
            D#2168-12-31 TOD#5:45:00.5 TOD#0:0:0 C#20 'a$$b$'c' '$0D' P#10.3";
        for text in texts.split_whitespace() {
            let value = literal::parse(text).expect(text);
            for set in [Mnemonics::En, Mnemonics::De] {
                let written = stl(&value, set);
                assert_eq!(literal::parse(&written).as_ref(), Ok(&value), "{text} as {written}");
            }
        }
        let pointers =
            ["P#M 10.0", "P#I 1.7", "P#DB5.DBX 20.0", "P#DB11.DBX 20.0 INT 10", "P#T 3.0 TIMER 2", "P#C 9.0 COUNTER 1"];
        for text in pointers.into_iter().chain(["DT#1999-12-8-1:2:3.456"]) {
            let value = literal::parse(text).expect(text);
            for set in [Mnemonics::En, Mnemonics::De] {
                let written = stl(&value, set);
                assert_eq!(literal::parse(&written).as_ref(), Ok(&value), "{text} as {written}");
            }
        }
    }

    #[test]
    fn a_time_of_another_base_is_a_word() {
        assert_eq!(s5time(0x0200).as_deref(), Some("S5T#2S"));
        // 2 s in the base of seconds: `S5T#2S` is the word 16#0200.
        assert_eq!(s5time(0x2002), None);
        assert_eq!(stl(&Literal::S5Time(0x2002), Mnemonics::En), "W#16#2002");
    }
}
