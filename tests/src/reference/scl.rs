//! The reference page of SCL: its text, and the binder's tables of types, conversions and functions.

use std::fmt::Write as _;

use plcc_syntax::Elementary;

use plcc_model::scl::{BinaryOp, Function, TimerKind};
use plcc_program::tables::scl::{FUNCTIONS, Implicit, Kind, NAMING, Naming, Question, Row, Rules, implicit, on_300};

/// The page without its tables.
const TEXT: &str = include_str!("scl.md.in");

/// The page in Markdown: `docs/reference/scl.md`.
pub fn reference() -> String {
    TEXT.replace("{implicit}\n", &implicit_table()).replace("{functions}\n", &function_tables())
}

// Conversions.

const INTEGERS: &[Elementary] = &[
    Elementary::Sint,
    Elementary::Usint,
    Elementary::Int,
    Elementary::Uint,
    Elementary::Dint,
    Elementary::Udint,
    Elementary::Lint,
    Elementary::Ulint,
];
const BIT_STRINGS: &[Elementary] = &[Elementary::Byte, Elementary::Word, Elementary::Dword, Elementary::Lword];

fn implicit_table() -> String {
    let mut table = String::from(
        "| Type | S7-SCL | TIA Portal, S7-300/400 | TIA Portal, S7-1200/1500 |\n| --- | --- | --- | --- |\n",
    );
    for from in Elementary::ALL {
        let cells = [Rules::Classic, Rules::Tia300, Rules::Tia1500]
            .map(|rules| if rules.is_300() && !on_300(from) { String::new() } else { targets(rules, from) });
        let _ = writeln!(table, "| {} | {} |", from.name(), cells.join(" | "));
    }
    table
}

/// The types to which `from` converts implicitly; in italics if it may not be intended.
fn targets(rules: Rules, from: Elementary) -> String {
    let (mut always, mut relaxed) = (Vec::new(), Vec::new());
    let known = |&to: &Elementary| to != from && (on_300(to) || !rules.is_300());
    for to in Elementary::ALL.into_iter().filter(known) {
        match (implicit(rules, true, from, to), implicit(rules, false, from, to)) {
            (Implicit::Yes, _) => always.push(to),
            (_, Implicit::Yes | Implicit::Unusual) => relaxed.push(to),
            (_, Implicit::No) => {}
        }
    }
    let mut words = vec![always.iter().map(|ty| ty.name()).collect::<Vec<_>>().join(" ")];
    if !relaxed.is_empty() {
        words.push(format!("*{}*", listed(&relaxed, &always, from)));
    }
    words.retain(|words| !words.is_empty());
    words.join(" ")
}

/// Names of types; whole groups by one word.
fn listed(types: &[Elementary], before: &[Elementary], own: Elementary) -> String {
    let mut rest = types.to_vec();
    let mut words = Vec::new();
    for (group, word) in [(INTEGERS, "integers"), (BIT_STRINGS, "bit strings")] {
        if group.iter().all(|ty| *ty == own || types.contains(ty) || before.contains(ty)) {
            rest.retain(|ty| !group.contains(ty));
            words.push(word);
        }
    }
    words.extend(rest.iter().map(|ty| ty.name()));
    words.join(" ")
}

// Functions.

const GROUPS: [&str; 6] = ["Numbers", "Choice", "Bits", "Arrays and memory", "Texts", "Dates, timers and counters"];

fn function_tables() -> String {
    let mut tables = String::new();
    for (index, group) in GROUPS.iter().enumerate() {
        let gap = if index == 0 { "" } else { "\n" };
        let _ = write!(tables, "{gap}### {group}\n\n| Function | Gives |\n| --- | --- |\n");
        for row in FUNCTIONS.iter().chain(NAMING) {
            let (of, effect) = described(row);
            if of == index {
                let _ = writeln!(tables, "| `{}` | {effect} |", signature(row));
            }
        }
    }
    tables
}

/// `LIMIT[_TYPE](MN/MIN, IN, MX/MAX)`; brackets: may be left out.
fn signature(row: &Row) -> String {
    let pins: Vec<String> = row.pins.split_whitespace().map(pin).collect();
    format!("{}{}({})", row.name, if row.suffix { "[_TYPE]" } else { "" }, pins.join(", "))
}

fn pin(word: &str) -> String {
    let optional = word.starts_with('?');
    let word = word.trim_start_matches('?');
    let output = word.starts_with('>');
    let word = word.trim_start_matches('>').replace('|', "/");
    let mut text = match word.strip_suffix('+') {
        Some(first) => format!("{first}, …"),
        None => word,
    };
    if output {
        text.push_str(" =>");
    }
    if optional { format!("[{text}]") } else { text }
}

/// The value of the function with this name.
pub fn effect(name: &str) -> Option<&'static str> {
    FUNCTIONS.iter().find(|row| row.name.eq_ignore_ascii_case(name)).map(|row| described(row).1)
}

/// Group and effect of a function.
fn described(row: &Row) -> (usize, &'static str) {
    match row.kind {
        Kind::Float(function) => (0, float(function)),
        Kind::Absolute => (0, "absolute value, in the type of IN"),
        Kind::Round => match row.name {
            "ROUND" => {
                (0, "nearest integer, halves to the even one; a DINT, in the TIA Portal of the type of its target")
            }
            "TRUNC" => (0, "integer toward 0; its type as for ROUND"),
            "CEIL" => (0, "integer above; its type as for ROUND"),
            _ => (0, "integer below; its type as for ROUND"),
        },
        Kind::NormX => (0, "(VALUE - MIN) / (MAX - MIN), a float; MAX not above MIN is an error"),
        Kind::ScaleX => (0, "VALUE * (MAX - MIN) + MIN, in the type of the limits; MAX not above MIN is an error"),
        Kind::IsValid => (0, "TRUE of a float that is neither infinite nor NaN"),
        Kind::Extreme(BinaryOp::Min) => (1, "least"),
        Kind::Extreme(_) => (1, "greatest"),
        Kind::Limit => (1, "IN within MN and MX; MN above MX is an error; the result is IN"),
        Kind::Select => (1, "IN0 if G is FALSE, else IN1"),
        Kind::Mux => (
            1,
            "the one of IN0, IN1, … with number K; if there is none, INELSE and an error; without INELSE a variable to which TIA assigns the result keeps its value, otherwise the result is 0",
        ),
        Kind::Demux => {
            (1, "writes IN to the one of OUT0, OUT1, … with number K; if there is none, to OUTELSE, with an error")
        }
        Kind::Shift(BinaryOp::ShiftLeft) => (2, "shifted left by N"),
        Kind::Shift(BinaryOp::ShiftRight) => {
            (2, "shifted right by N; a signed number keeps its sign on S7-1200/1500, elsewhere zeros enter")
        }
        Kind::Shift(BinaryOp::RotateLeft) => (2, "rotated left by N"),
        Kind::Shift(_) => (2, "rotated right by N"),
        Kind::Swap => (2, "bytes in reverse order"),
        Kind::Encode => (2, "number of the lowest bit that is 1, an INT; none is an error"),
        Kind::Decode => (2, "bit number IN alone is 1; a bit string of the type of its target, else a DWORD"),
        Kind::BitSum => (2, "how many bits are 1, an INT"),
        Kind::Scatter => (2, "writes the bits of IN to an array or structure of BOOL"),
        Kind::Gather => (2, "writes an array or structure of BOOL to a bit string"),
        Kind::ScatterBlock { to_bits: true } => (
            2,
            "as SCATTER, for COUNT_IN elements beginning with array element IN; elements that do not fit are an error",
        ),
        Kind::ScatterBlock { to_bits: false } => (
            2,
            "as GATHER, to COUNT_OUT elements beginning with array element OUT; elements that do not fit are an error",
        ),
        Kind::Bound { upper: false } => (3, "lower bound of dimension DIM, a DINT"),
        Kind::Bound { upper: true } => (3, "upper bound of dimension DIM, a DINT"),
        Kind::CountOfElements => {
            (3, "number of elements of an array, a UDINT; for a VARIANT, of the array it points at")
        }
        Kind::Type(Question::Type) => (
            3,
            "the type of a variable, or of the data a VARIANT points at, to be compared with `=`, `<>` and CASE: `TypeOf(v) = Int`",
        ),
        Kind::Type(Question::ElementType) => (3, "the type of the elements of an array"),
        Kind::Type(Question::IsArray) => (3, "TRUE of an array, or of a VARIANT that points at one"),
        Kind::Naming(Naming::Block) => (
            4,
            "name of the block, a WSTRING: SIZE characters, with a negative SIZE the last; 0: all. A cut name has `…` in place of one of them",
        ),
        Kind::Naming(Naming::Instance) => (
            4,
            "name of the instance of the function block: of its data block, or of the component of another instance",
        ),
        Kind::Naming(Naming::Path) => (4, "the same with all that is around it: `Line_DB.Pumps[2]`"),
        Kind::MoveBlock => (
            3,
            "copies COUNT elements, beginning with array element IN, to OUT, as if through a buffer; too many are an error",
        ),
        Kind::FillBlock => (3, "writes IN to COUNT elements, beginning with array element OUT; too many are an error"),
        Kind::Peek { bit: true } => (3, "bit at an address"),
        Kind::Peek { bit: false } => (3, "byte at an address, or TYPE; AREA is 16#81 I, 82 Q, 83 M, 84 DB, 1 PI"),
        Kind::Poke { bit: true } => (3, "writes a bit"),
        Kind::Poke { bit: false } => (3, "writes VALUE with the width of its type; AREA 2 is PQ"),
        Kind::PokeBlock => (3, "copies COUNT bytes"),
        Kind::MoveText => (4, "copies a text"),
        Kind::Concat => (4, "texts one after the other"),
        Kind::TextNumber(_) => (4, "between texts and numbers, by the types of IN and OUT"),
        Kind::ResetTimer => (5, "ends an IEC timer: Q FALSE, ET 0"),
        Kind::PresetTimer => (5, "sets another duration for an IEC timer"),
        Kind::Operator(plcc_syntax::scl::ast::BinaryOp::Add) => (5, "`IN1 + IN2`"),
        Kind::Operator(_) => (5, "`IN1 - IN2`"),
        Kind::Identity => (5, "IN, converted to the required type"),
        Kind::Timer(kind) => (5, timer(kind)),
        Kind::Counter => match row.name {
            "S_CU" => (5, "S5 counter, up; value in BCD, CV binary"),
            "S_CD" => (5, "S5 counter, down"),
            _ => (5, "S5 counter, up and down"),
        },
    }
}

const fn float(function: Function) -> &'static str {
    match function {
        Function::Sqr => "square",
        Function::Sqrt => "square root",
        Function::Exp => "e to the power of IN",
        Function::Expd => "10 to the power of IN",
        Function::Ln => "natural logarithm",
        Function::Log => "logarithm to base 10",
        Function::Sin => "sine of radians",
        Function::Cos => "cosine of radians",
        Function::Tan => "tangent of radians",
        Function::Asin => "arc sine, in radians",
        Function::Acos => "arc cosine, in radians",
        Function::Atan => "arc tangent, in radians",
        _ => "the part after the point",
    }
}

const fn timer(kind: TimerKind) -> &'static str {
    match kind {
        TimerKind::Pulse => "S5 timer, pulse; remaining time as S5TIME, BI binary",
        TimerKind::ExtendedPulse => "S5 timer, extended pulse",
        TimerKind::OnDelay => "S5 timer, on delay",
        TimerKind::RetentiveOnDelay => "S5 timer, retentive on delay",
        TimerKind::OffDelay => "S5 timer, off delay",
    }
}
