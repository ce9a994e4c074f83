//! Decides from its lines whether a text is a PLC source.

use plcc_syntax::s7200;
use plcc_syntax::stl::{Mnemonics, StlInsn};

/// How many lines of a text look like each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Signs {
    /// Headers of blocks and types.
    headers: usize,
    /// Statements that only a PLC source has.
    sure: usize,
    /// Lines that a PLC source may have.
    likely: usize,
    /// Sentences, and lines of other languages.
    alien: usize,
    /// All other lines.
    open: usize,
}

impl Signs {
    /// Counts the kinds of lines in `text`.
    pub fn of(text: &str) -> Signs {
        let mut signs = Signs::default();
        let text = without_comments(text);
        for line in text.lines().map(str::trim).filter(|line| !line.is_empty()) {
            *signs.counter(line) += 1;
        }
        signs
    }

    /// The text contains some PLC code, maybe as an example.
    pub fn has_code(&self) -> bool {
        self.headers > 0 || self.sure > 1
    }

    /// The text is a source as a whole.
    pub fn is_source(&self) -> bool {
        let known = 3 * self.headers + self.sure + self.likely;
        if self.headers > 0 {
            known + self.open >= self.alien
        } else {
            self.sure > 0 && known >= self.alien + self.open / 4
        }
    }

    fn counter(&mut self, line: &str) -> &mut usize {
        if is_header(line) {
            &mut self.headers
        } else if is_statement(line) {
            &mut self.sure
        } else if is_likely(line) {
            &mut self.likely
        } else if is_of_another_language(line) || is_sentence(line) {
            &mut self.alien
        } else {
            &mut self.open
        }
    }
}

/// The text with its comments taken out: `//` to the end of the line, `(* *)` and `/* */`.
fn without_comments(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = ["//", "(*", "/*"].iter().filter_map(|mark| rest.find(mark)).min() {
        let (code, comment) = rest.split_at(at);
        out.push_str(code);
        let (body, end) = match &comment[..2] {
            "//" => (comment, comment.find('\n').unwrap_or(comment.len())),
            mark => {
                let close = if mark == "(*" { "*)" } else { "*/" };
                match comment[2..].find(close) {
                    Some(end) => (comment, end + 4),
                    None => {
                        // It is not a comment: `(*` may occur in a pattern of another language.
                        out.push_str(mark);
                        (comment, 2)
                    }
                }
            }
        };
        rest = &body[end..];
    }
    out.push_str(rest);
    out
}

/// The first word of a line, in capitals, and what follows it.
fn first_word(line: &str) -> (String, &str) {
    let end = line.find(|c: char| c.is_whitespace() || matches!(c, ';' | ',' | ':' | '(' | '"')).unwrap_or(line.len());
    (line[..end].to_ascii_uppercase(), line[end..].trim())
}

/// A name: `FC 1`, `FB1`, `Valve`, `"Tank data"`, and what follows it.
fn name(text: &str) -> Option<&str> {
    if let Some(rest) = text.strip_prefix('"') {
        return rest.split_once('"').map(|(_, rest)| rest.trim());
    }
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    let (word, rest) = (&text[..end], text[end..].trim());
    if !word.starts_with(|c: char| c.is_alphabetic() || c == '_') {
        return None;
    }
    let digits = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
    Some(rest[digits..].trim())
}

/// The header of a block or type, or its end.
fn is_header(line: &str) -> bool {
    let (word, rest) = first_word(line);
    // Attributes come before a name: `FUNCTION_BLOCK PUBLIC Valve`, `{ ... }`.
    let follows = |rest: &str| rest.is_empty() || rest.starts_with([':', '{', '=']);
    match word.as_str() {
        "ORGANIZATION_BLOCK"
        | "FUNCTION_BLOCK"
        | "DATA_BLOCK"
        | "SUBROUTINE_BLOCK"
        | "INTERRUPT_BLOCK"
        | "SYSTEM_FUNCTION"
        | "SYSTEM_FUNCTION_BLOCK" => {
            let rest = rest.trim_end_matches(';').trim_end();
            rest.is_empty() || name(rest).is_some_and(follows) || rest.split_whitespace().count() <= 4
        }
        "FUNCTION" => {
            name(rest).is_some_and(|rest| rest.starts_with(':')) || rest.starts_with('"') && name(rest).is_some()
        }
        "END_ORGANIZATION_BLOCK"
        | "END_FUNCTION_BLOCK"
        | "END_DATA_BLOCK"
        | "END_FUNCTION"
        | "END_SUBROUTINE_BLOCK"
        | "END_INTERRUPT_BLOCK"
        | "END_SYSTEM_FUNCTION"
        | "END_SYSTEM_FUNCTION_BLOCK"
        | "END_TYPE"
        | "END_PROGRAM"
        | "END_NETWORK"
        | "END_STEP"
        | "END_TRANSITION" => rest.is_empty() || rest == ";",
        _ => false,
    }
}

/// A statement in STL of any family or in SCL, or a declaration, with a form that is rare elsewhere.
fn is_statement(line: &str) -> bool {
    let line = after_label(line);
    let (word, rest) = first_word(line);
    let rest = rest.trim_end_matches(';').trim_end();
    let words = [
        "END_VAR",
        "END_STRUCT",
        "END_IF",
        "END_CASE",
        "END_FOR",
        "END_WHILE",
        "END_REPEAT",
        "END_REGION",
        "INITIAL_STEP",
    ];
    if words.contains(&word.as_str()) {
        return true;
    }
    // A line of a data block of the S7-200.
    if word.starts_with('V') && s7200::parse_address(&word).is_some() {
        return rest.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '\'' | '"' | '+' | '-'));
    }
    is_assignment(line)
        || word == "CALL" && is_call(rest)
        || is_mnemonic(&word) && rest.split([' ', '\t', ',']).count() <= 6 && is_operands(rest)
}

/// Removes the label of a jump.
fn after_label(line: &str) -> &str {
    match line.split_once(':') {
        Some((label, rest))
            if !rest.starts_with('=')
                && !label.is_empty()
                && label.chars().all(|c| c.is_alphanumeric() || c == '_') =>
        {
            rest.trim_start()
        }
        _ => line,
    }
}

/// `name := value;`
fn is_assignment(line: &str) -> bool {
    let Some((target, _)) = line.split_once(":=") else { return false };
    let target = target.trim();
    line.trim_end().ends_with(';') && (target.contains(['"', '#', '%']) || target.split_whitespace().count() <= 2)
}

/// What is called: a block by number or name.
fn is_call(rest: &str) -> bool {
    rest.starts_with(['"', '#'])
        || ["FC", "FB", "SFC", "SFB", "SBR"].iter().any(|kind| {
            let upper = rest.to_ascii_uppercase();
            upper.strip_prefix(kind).is_some_and(|rest| rest.trim_start().starts_with(|c: char| c.is_ascii_digit()))
        })
}

/// All look like operands, and at least one is more than a number.
fn is_operands(text: &str) -> bool {
    text.split(',').all(|operand| is_operand(operand.trim()) || is_number(operand.trim()))
        && text.split(',').any(|operand| is_operand(operand.trim()))
}

fn is_number(text: &str) -> bool {
    text.trim_start_matches(['+', '-']).starts_with(|c: char| c.is_ascii_digit()) && !text.contains(' ')
}

/// Areas and kinds of addresses, before their numbers.
const AREAS: &[&str] = &[
    "I", "IB", "IW", "ID", "Q", "QB", "QW", "QD", "E", "EB", "EW", "ED", "A", "AB", "AW", "AD", "M", "MB", "MW", "MD",
    "L", "LB", "LW", "LD", "DBX", "DBB", "DBW", "DBD", "DIX", "DIB", "DIW", "DID", "PIB", "PIW", "PID", "PQB", "PQW",
    "PQD", "PEB", "PEW", "PED", "PAB", "PAW", "PAD", "T", "C", "Z", "DB", "DI", "FC", "FB", "SFC", "SFB", "V", "VB",
    "VW", "VD", "SM", "SMB", "SMW", "SMD", "AIW", "AQW", "AEW", "AAW", "AC", "HC", "S", "SB", "SW", "SD", "W", "B",
    "DW", "LC",
];

/// `I 0.0`, `DB1.DBX0.0`, `#level`, `"Start"`, `S5T#2S`, `P#0.0`, `[AR1,P#0.0]`, `&VB0`.
fn is_operand(text: &str) -> bool {
    if let Some(rest) = text.strip_prefix('#') {
        return rest.starts_with(|c: char| c.is_alphabetic() || matches!(c, '_' | '"'));
    }
    if text.starts_with('"') {
        return text.matches('"').count() == 2;
    }
    let text = text.trim_start_matches(['&', '*', '%']).to_ascii_uppercase();
    let end = text.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(text.len());
    let (area, rest) = text.split_at(end);
    if area.is_empty() {
        return text.contains('#') && !text.contains(' ');
    }
    let rest = rest.trim_start();
    if rest.starts_with('[') {
        return AREAS.contains(&area);
    }
    if rest.contains('#') && ["T", "P", "L", "C", "S", "D", "TIME", "DATE", "TOD", "W", "B"].contains(&area) {
        return true;
    }
    AREAS.contains(&area)
        && rest.starts_with(|c: char| c.is_ascii_digit())
        && rest.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '.' | ' ' | '#' | '_'))
}

/// A line that occurs in sources, but also in other texts.
fn is_likely(line: &str) -> bool {
    let line = after_label(line);
    let (word, rest) = first_word(line);
    let alone = rest.is_empty() || rest == ";";
    match word.as_str() {
        "VAR" | "VAR_INPUT" | "VAR_OUTPUT" | "VAR_IN_OUT" | "VAR_TEMP" | "VAR_GLOBAL" | "STRUCT" | "BEGIN" => {
            rest.split_whitespace().count() <= 1
        }
        "NETWORK" => alone || rest.starts_with(|c: char| c.is_ascii_digit()),
        "TITLE" => rest.starts_with(['=', ':']),
        "VERSION" | "AUTHOR" | "FAMILY" | "NAME" => rest.starts_with(':'),
        "IF" | "ELSIF" => rest.to_ascii_uppercase().ends_with("THEN"),
        "TYPE" | "PROGRAM" => name(rest).is_some_and(|rest| rest.is_empty() || rest == ":"),
        _ => {
            alone && is_mnemonic(&word)
                || is_mnemonic(&word) && rest.split_whitespace().count() <= 3 && line == line.to_uppercase()
                || line.ends_with(';') && line.contains(':')
                || line.ends_with(',') && line.contains(":=")
        }
    }
}

/// Marks that never occur in a line of a source.
fn is_of_another_language(line: &str) -> bool {
    let begins = [
        "#include", "#define", "#!", "# ", "## ", "import ", "from ", "def ", "class ", "return ", "<", "```", "* ",
        "- ", "---", "===", "$",
    ];
    let inside = ["&&", "||", "!=", "->", "::", "();", "==="];
    begins.iter().any(|mark| line.starts_with(mark))
        || inside.iter().any(|mark| line.contains(mark))
        || line == "}"
        || line.ends_with('{')
        || !line.starts_with("==") && line.contains("==")
}

/// A sentence: several words without any code between them.
fn is_sentence(line: &str) -> bool {
    let words = || line.split_whitespace();
    let plain = |word: &&str| {
        word.trim_matches(['.', ',', ';', ':', '!', '?', '\'', '(', ')', '*', '_', '`', '"'])
            .chars()
            .all(|c| c.is_alphabetic() || matches!(c, '-' | '\''))
    };
    let count = words().count();
    count >= 4
        && words().filter(plain).count() * 4 >= count * 3
        && !line.contains([';', '#', '=', '['])
        && !line.starts_with('"')
}

fn is_mnemonic(word: &str) -> bool {
    let is = |set| move |insn: &&StlInsn| insn.mnemonic(set).eq_ignore_ascii_case(word);
    StlInsn::ALL.iter().any(|insn| is(Mnemonics::En)(&insn) || is(Mnemonics::De)(&insn)) || s7200::is_mnemonic(word)
}
