//! What a name that is defined nowhere may mean: an address, a number, a time, a tag of the TIA Portal, a system function, a word of another language.

use plcc_literal::duration::{self, Fraction, Smallest};

use crate::similar;

/// Tags that the TIA Portal makes for the system memory and the clock memory, with the addresses that it proposes.
const PORTAL_TAGS: [(&str, &str, &str); 14] = [
    ("System_Byte", "MB 1", "BYTE"),
    ("FirstScan", "M 1.0", "BOOL"),
    ("DiagStatusUpdate", "M 1.1", "BOOL"),
    ("AlwaysTRUE", "M 1.2", "BOOL"),
    ("AlwaysFALSE", "M 1.3", "BOOL"),
    ("Clock_Byte", "MB 0", "BYTE"),
    ("Clock_10Hz", "M 0.0", "BOOL"),
    ("Clock_5Hz", "M 0.1", "BOOL"),
    ("Clock_2.5Hz", "M 0.2", "BOOL"),
    ("Clock_2Hz", "M 0.3", "BOOL"),
    ("Clock_1.25Hz", "M 0.4", "BOOL"),
    ("Clock_1Hz", "M 0.5", "BOOL"),
    ("Clock_0.625Hz", "M 0.6", "BOOL"),
    ("Clock_0.5Hz", "M 0.7", "BOOL"),
];

/// What to add for a tag or a data block that the TIA Portal makes without being asked. `bytes`: of the clock memory and the system memory.
pub(super) fn of_the_portal(name: &str, bytes: [Option<u16>; 2]) -> Option<String> {
    if let Some((tag, address, ty)) = PORTAL_TAGS.iter().find(|(tag, ..)| tag.eq_ignore_ascii_case(name)) {
        let [clock, system] = bytes;
        let (memory, byte) = if tag.starts_with("Clock") { ("clock", clock) } else { ("system", system) };
        let address = match (byte, address.split_once('.')) {
            (Some(byte), Some((_, bit))) => format!("M {byte}.{bit}"),
            (Some(byte), None) => format!("MB {byte}"),
            (None, _) => (*address).to_string(),
        };
        return Some(format!(
            "it belongs to the {memory} memory: add the tag table that has it, or a symbol table `tags.sdf` with the row `\"{tag}\",\"{address}\",\"{ty}\",\"\"`"
        ));
    }
    let begins = |word: &str| name.get(..word.len()).is_some_and(|head| head.eq_ignore_ascii_case(word));
    let ty = ["IEC_TIMER", "IEC_COUNTER"].into_iter().find(|ty| begins(&format!("{ty}_")))?;
    Some(format!("add the source of this data block, or define it: `DATA_BLOCK \"{name}\" {ty} BEGIN END_DATA_BLOCK`"))
}

/// `5s`, `1h30m`, `2.5s`: a time without its type.
pub(super) fn is_duration(name: &str) -> bool {
    let reads = || duration::nanoseconds(name, Smallest::Millisecond, Fraction::Last).is_ok();
    name.starts_with(|c: char| c.is_ascii_digit()) && reads()
}

/// True of `T#5s`, `16#FF`, `0.5` and `TRUE`.
pub(super) fn is_constant(name: &str) -> bool {
    const KINDS: [&str; 16] =
        ["T", "TIME", "S5T", "S5TIME", "LT", "LTIME", "D", "DATE", "TOD", "DT", "L", "C", "W", "2", "8", "16"];
    match name.split_once('#') {
        Some((kind, value)) => {
            KINDS.iter().any(|known| known.eq_ignore_ascii_case(kind))
                && value.starts_with(|c: char| c.is_ascii_alphanumeric() || c == '-')
        }
        None if name.starts_with(|c: char| c.is_ascii_digit() || c == '-') => name.parse::<f64>().is_ok(),
        None => ["TRUE", "FALSE"].iter().any(|word| word.eq_ignore_ascii_case(name)),
    }
}

/// `S5T#10S` for `S5T10S`.
pub(super) fn time_without_sign(name: &str) -> Option<String> {
    ["S5TIME", "S5T", "TIME", "T"].into_iter().find_map(|ty| {
        let (start, time) = name.split_at_checked(ty.len())?;
        let time = time.trim_start_matches('_');
        (start.eq_ignore_ascii_case(ty) && is_duration(time)).then(|| format!("{ty}#{time}"))
    })
}

/// `I0`, which is a byte or a bit without its number. `areas`: the letters of areas with bits.
pub fn bit_without_number(name: &str, areas: &[&str]) -> Option<String> {
    let digits = name.find(|c: char| c.is_ascii_digit())?;
    let (letters, number) = name.split_at(digits);
    let known = areas.iter().any(|known| known.eq_ignore_ascii_case(letters));
    let fits = known && number.len() <= 5 && number.bytes().all(|byte| byte.is_ascii_digit());
    fits.then(|| format!("if you mean the address: a bit is `{name}.0` to `{name}.7`, the byte `{letters}B{number}`"))
}

/// A value of another language, as SCL writes it.
pub(super) fn foreign_value(name: &str) -> Option<&'static str> {
    Some(match name.to_ascii_lowercase().as_str() {
        "on" | "yes" => "`TRUE`",
        "off" | "no" => "`FALSE`",
        "pi" => "`3.1415927`, or declare a constant of that value",
        "none" | "nil" | "nullptr" => "NULL for a reference, FALSE for a BOOL, 0 for a number",
        _ => return None,
    })
}

/// Registers of the CPU by a name that operands of STL do not have.
pub(super) fn register_of_stl(name: &str) -> Option<&'static str> {
    Some(match name.to_ascii_uppercase().as_str() {
        "BIE" => "the binary result is `BR` in international mnemonics",
        "BR" => "the binary result is `BIE` in German mnemonics",
        "ACCU1" | "ACCU2" | "AKKU1" | "AKKU2" => {
            "STL has no names for the accumulators: `L` loads ACCU1 and moves its old value to ACCU2, `T` stores ACCU1"
        }
        "RLO" => "STL has no name for the RLO: `=` writes it to a bit, and a jump such as `JC` tests it",
        "VKE" => "STL has no name for the RLO: `=` writes it to a bit, and a jump such as `SPB` tests it",
        _ => return None,
    })
}

/// The system function with this name, in any letter case; parts of library blocks are none.
pub(super) fn system_function(name: &str) -> Option<&'static str> {
    let is = |block: &&plcc_stdlib::SystemBlock| {
        block.class == plcc_stdlib::BlockClass::Sfc && !block.is_part() && block.name.eq_ignore_ascii_case(name.trim())
    };
    plcc_stdlib::blocks().iter().find(is).map(|block| block.name)
}

/// Names of data types in other languages, and what STEP 7 calls them.
const FOREIGN: [(&str, &str); 26] = [
    ("INTEGER", "INT"),
    ("INT8", "SINT"),
    ("INT16", "INT"),
    ("INT32", "DINT"),
    ("INT64", "LINT"),
    ("UINT8", "USINT"),
    ("UINT16", "UINT"),
    ("UINT32", "UDINT"),
    ("UINT64", "ULINT"),
    ("SHORT", "INT"),
    ("LONG", "DINT"),
    ("LONGINT", "DINT"),
    ("BOOLEAN", "BOOL"),
    ("BIT", "BOOL"),
    ("FLOAT", "REAL"),
    ("FLOAT32", "REAL"),
    ("FLOAT64", "LREAL"),
    ("DOUBLE", "LREAL"),
    ("SINGLE", "REAL"),
    ("CHARACTER", "CHAR"),
    ("TEXT", "STRING"),
    ("DATETIME", "DATE_AND_TIME"),
    ("DATE_TIME", "DATE_AND_TIME"),
    ("DOUBLEWORD", "DWORD"),
    ("DOUBLE_WORD", "DWORD"),
    ("UNSIGNED", "UINT"),
];

/// The data type of STEP 7 for the name of one in other languages.
pub(super) fn foreign_type(name: &str) -> Option<&'static str> {
    FOREIGN.iter().find(|(foreign, _)| foreign.eq_ignore_ascii_case(name)).map(|(_, ty)| *ty)
}

/// The data type of STEP 7 that a word of another language or a misspelt word means.
pub fn known_type(name: &str) -> Option<&'static str> {
    foreign_type(name)
        .or_else(|| similar_type(name))
        .or_else(|| foreign_type(similar(name, FOREIGN.iter().map(|row| row.0))?))
}

/// The data type whose name resembles `name`.
fn similar_type(name: &str) -> Option<&'static str> {
    const OTHERS: [&str; 10] =
        ["STRING", "WSTRING", "DATE_AND_TIME", "DTL", "TIMER", "COUNTER", "POINTER", "VARIANT", "ARRAY", "VOID"];
    let types = plcc_model::types::Elementary::ALL.into_iter().map(|ty| ty.name());
    similar(name, types.chain(OTHERS)).filter(|_| name.len() > 2)
}

/// Names that are hexadecimal numbers of other languages: `FFh`.
pub fn hexadecimal(name: &str) -> Option<String> {
    let digits = name.trim().strip_suffix(['h', 'H'])?;
    let number = (2..=16).contains(&digits.len()) && digits.bytes().all(|digit| digit.is_ascii_hexdigit());
    number.then(|| format!("16#{}", digits.to_ascii_uppercase()))
}

/// Names that are misspelt addresses: `MO.0`, `Q01`, `Q0_1`, `MW1O`.
pub(super) fn misread_address(name: &str) -> Option<String> {
    let upper = name.trim().to_ascii_uppercase();
    let letters: String = upper.chars().take_while(|letter| "IQEAM".contains(*letter)).take(1).collect();
    let rest = upper.get(letters.len()..)?;
    if letters.is_empty() || rest.is_empty() || rest.len() > 6 {
        return None;
    }
    let digits: String = rest.chars().map(|letter| if letter == 'O' { '0' } else { letter }).collect();
    // A byte, word or double word with the letter O.
    if let Some(number) = digits.strip_prefix(['B', 'W', 'D']).filter(|_| digits != rest)
        && !number.is_empty()
        && number.bytes().all(|digit| digit.is_ascii_digit())
    {
        return Some(format!("{letters}{digits}"));
    }
    let point = match digits.split_once(['.', '_']) {
        Some((byte, bit)) => (byte.to_string(), bit.to_string()),
        None => {
            let split = digits.len() - 1;
            (digits.get(..split)?.to_string(), digits.get(split..)?.to_string())
        }
    };
    let number = |text: &str| !text.is_empty() && text.bytes().all(|digit| digit.is_ascii_digit());
    (number(&point.0) && number(&point.1) && point.1.len() == 1 && point.1.as_str() < "8")
        .then(|| format!("{letters}{}.{}", point.0, point.1))
}
