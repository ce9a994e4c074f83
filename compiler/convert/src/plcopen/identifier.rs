//! Names of IEC 61131-3: letters, digits and single `_`, and none that is a word of the language.

/// Words of the language that no variable can be called.
const WORDS: &[&str] = &[
    "ABSTRACT",
    "ACTION",
    "AND",
    "ARRAY",
    "AT",
    "BOOL",
    "BY",
    "BYTE",
    "CASE",
    "CLASS",
    "CONFIGURATION",
    "CONSTANT",
    "CONTINUE",
    "DATE",
    "DATE_AND_TIME",
    "DINT",
    "DO",
    "DT",
    "DWORD",
    "ELSE",
    "ELSIF",
    "EN",
    "END_CASE",
    "END_FOR",
    "END_IF",
    "END_REPEAT",
    "END_VAR",
    "END_WHILE",
    "ENO",
    "EXIT",
    "FALSE",
    "FOR",
    "FUNCTION",
    "FUNCTION_BLOCK",
    "GOTO",
    "IF",
    "INT",
    "INTERFACE",
    "JMP",
    "LINT",
    "LREAL",
    "LWORD",
    "METHOD",
    "MOD",
    "NOT",
    "OF",
    "ON",
    "OR",
    "POINTER",
    "PROGRAM",
    "READ_ONLY",
    "READ_WRITE",
    "REAL",
    "REPEAT",
    "RESOURCE",
    "RETAIN",
    "RETURN",
    "SINT",
    "STRING",
    "STRUCT",
    "TASK",
    "THEN",
    "TIME",
    "TIME_OF_DAY",
    "TO",
    "TOD",
    "TRUE",
    "TYPE",
    "UDINT",
    "UINT",
    "ULINT",
    "UNTIL",
    "USINT",
    "VAR",
    "VAR_GLOBAL",
    "VAR_INPUT",
    "VAR_OUTPUT",
    "WHILE",
    "WITH",
    "WORD",
    "WSTRING",
    "XOR",
];

/// The nearest name that IEC 61131-3 has: `Tür 1` is `Tuer_1`.
pub fn identifier(name: &str) -> String {
    let mut text = String::new();
    for c in name.chars() {
        let part = match c {
            'ä' => "ae",
            'ö' => "oe",
            'ü' => "ue",
            'Ä' => "Ae",
            'Ö' => "Oe",
            'Ü' => "Ue",
            'ß' => "ss",
            c if c.is_ascii_alphanumeric() => {
                text.push(c);
                continue;
            }
            c if c.is_alphabetic() => {
                text.push_str(&format!("u{:X}", c as u32));
                continue;
            }
            _ => "_",
        };
        if part != "_" || !text.ends_with('_') {
            text.push_str(part);
        }
    }
    if text.ends_with('_') {
        text.pop();
    }
    if !text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') {
        text.insert(0, '_');
    }
    if WORDS.iter().any(|word| word.eq_ignore_ascii_case(&text)) {
        text.push_str("_1");
    }
    text
}

/// Functions and function blocks of the standard, which no block can be called.
const STANDARD: &[&str] = &[
    "ABS", "ACOS", "ADD", "ASIN", "ATAN", "CONCAT", "COS", "CTD", "CTU", "CTUD", "DELETE", "DIV", "EQ", "EXP", "EXPT",
    "FIND", "F_TRIG", "GE", "GT", "INSERT", "LE", "LEFT", "LEN", "LIMIT", "LN", "LOG", "LT", "MAX", "MID", "MIN",
    "MOVE", "MUL", "MUX", "NE", "REPLACE", "RIGHT", "ROL", "ROR", "RS", "R_TRIG", "SEL", "SEMA", "SHL", "SHR", "SIN",
    "SQRT", "SR", "SUB", "TAN", "TOF", "TON", "TP", "TRUNC",
];

pub fn is_standard(name: &str) -> bool {
    STANDARD.iter().any(|known| known.eq_ignore_ascii_case(name))
}

#[cfg(test)]
mod tests {
    use super::identifier;

    #[test]
    fn names_have_letters_digits_and_single_lines() {
        let cases = [
            ("Motor", "Motor"),
            ("Motor 1", "Motor_1"),
            ("a__b_", "a_b"),
            ("Tür-öffner", "Tuer_oeffner"),
            ("1st", "_1st"),
            ("Для", "u414u43Bu44F"),
            ("time", "time_1"),
            ("+", "_"),
        ];
        for (name, wanted) in cases {
            assert_eq!(identifier(name), wanted, "{name}");
        }
    }
}
