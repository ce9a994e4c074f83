//! Blanks between the pieces of a line of declarations, of SCL and of networks.

use plcc_syntax::Language;

use crate::piece::Piece;

/// Where pieces are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The head of a block, a chart: blanks stay where they are.
    Frame,
    Declaration,
    Code,
    /// A rung of LAD or FBD.
    Rung,
}

/// What is known about the line so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Open {
    /// Round brackets.
    pub parens: usize,
    pub brackets: usize,
    pub braces: usize,
    /// The piece before is a sign of one operand.
    pub sign: bool,
}

impl Open {
    /// After one more piece. `before`: the one before it.
    pub fn pass(&mut self, before: Option<&Piece>, piece: &Piece) {
        self.sign = matches!(piece.text, "+" | "-") && !before.is_some_and(ends_operand);
        match piece.text {
            "(" => self.parens += 1,
            ")" => self.parens = self.parens.saturating_sub(1),
            "[" => self.brackets += 1,
            "]" => self.brackets = self.brackets.saturating_sub(1),
            "{" => self.braces += 1,
            "}" => self.braces = self.braces.saturating_sub(1),
            _ => {}
        }
    }

    pub fn any(&self) -> bool {
        self.parens + self.brackets + self.braces > 0
    }
}

/// Words after which an operand begins.
const OPERATORS: [&str; 27] = [
    "AND",
    "OR",
    "XOR",
    "NOT",
    "MOD",
    "DIV",
    "IF",
    "ELSIF",
    "THEN",
    "ELSE",
    "OF",
    "TO",
    "BY",
    "DO",
    "WHILE",
    "UNTIL",
    "CASE",
    "RETURN",
    "FOR",
    "REPEAT",
    "EXIT",
    "CONTINUE",
    "GOTO",
    "AT",
    "BEGIN",
    "CONDITION",
    "RETAIN",
];

/// Operators of two operands that are words.
const BINARY: [&str; 5] = ["AND", "OR", "XOR", "MOD", "DIV"];

/// Words of statements after a value.
const AFTER_VALUE: [&str; 6] = ["THEN", "OF", "DO", "TO", "BY", "END_REPEAT"];

/// Words with a blank before a bracket; after other words it may be that of a call.
const BEFORE_VALUE: [&str; 8] = ["IF", "ELSIF", "WHILE", "UNTIL", "CASE", "NOT", "TO", "BY"];

/// Whether a piece ends an operand, so that a sign after it has two operands.
fn ends_operand(piece: &Piece) -> bool {
    match piece.text {
        ")" | "]" | "^" => true,
        _ => piece.text.starts_with(is_word) && !piece.is_any(&OPERATORS),
    }
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '#' | '"' | '\'' | '%')
}

/// The blanks between `before` and `piece`.
pub fn between(language: Language, place: Place, open: Open, before: &Piece, piece: &Piece) -> &'static str {
    let same = if piece.spaced { " " } else { "" };
    if place == Place::Frame || open.braces > 0 || piece.is_comment() || before.is_comment() {
        return match piece.text {
            "," if open.braces == 0 && language != Language::Graph => "",
            _ => same,
        };
    }
    let stl = language == Language::Stl;
    match (before.text, piece.text) {
        (_, ";") if stl && place == Place::Declaration => return " ",
        (":=" | "=>", "," | ")") => return same,
        (_, ";" | ",") => return "",
        (",", _) => return " ",
        ("*", "]") | ("[", "*") => return "",
        (_, ":=" | "=>" | "+=" | "-=" | "*=" | "/=" | "?=") | (":=" | "=>" | "+=" | "-=" | "*=" | "/=" | "?=", _) => {
            return " ";
        }
        (_, "..") | ("..", _) => return if stl { " " } else { "" },
        _ => {}
    }
    if language == Language::Sd && (place == Place::Rung || open.parens > 0) && place != Place::Code {
        return if place == Place::Rung && !open.any() && piece.spaced && is_element(before, piece) {
            "  "
        } else {
            same
        };
    }
    match (before.text, piece.text) {
        _ if open.sign => "",
        ("(" | "[", _) | (_, ")" | "]") => "",
        (".", _) | (_, ".") => same,
        ("]", _) if piece.is("OF") => " ",
        _ if place == Place::Code
            && (before.is_any(&BINARY) || piece.is_any(&BINARY) || piece.is_any(&AFTER_VALUE)) =>
        {
            " "
        }
        _ if place == Place::Code && before.is_any(&OPERATORS) && piece.text.starts_with(is_word) => " ",
        (_, "(") if place == Place::Code && before.is_any(&BEFORE_VALUE) => " ",
        (_, "[") if stl && before.is("ARRAY") => " ",
        (_, "[") => {
            if before.is_any(&["ARRAY"]) || before.text.ends_with(is_word) && !before.is_any(&OPERATORS) {
                ""
            } else {
                same
            }
        }
        (_, ":") => {
            if place == Place::Declaration {
                " "
            } else {
                ""
            }
        }
        (":", _) => " ",
        (_, "=" | "<>" | "<" | ">" | "<=" | ">=" | "*" | "/" | "**" | "&")
        | ("=" | "<>" | "<" | ">" | "<=" | ">=" | "*" | "/" | "**" | "&", _) => " ",
        ("+" | "-", _) => " ",
        (_, "+" | "-") if ends_operand(before) => " ",
        _ => same,
    }
}

/// Whether `piece` is an element of a rung, or a wire after one: two blanks are before it.
fn is_element(before: &Piece, piece: &Piece) -> bool {
    let after_keyword = before.is_any(&["RUNG", "END_RUNG"]);
    !after_keyword && before.text != "," && !piece.text.starts_with('.')
}
