//! The reference page of LAD and FBD: its text, and a table of all elements from the table that also serves to read files.

use std::fmt::Write as _;

use plcc_syntax::network::elements::{
    CHAPTERS, Chapter, CounterCoil, EnoRule, Flag, Gate, Kind, Mcr, PinDirection, PinRow, ReturnValue, Row,
    VariantQuestion,
};

use super::scl;

/// The page without its tables.
const TEXT: &str = include_str!("lad_fbd.md.in");

/// The page in Markdown: `docs/reference/lad-fbd.md`.
pub fn reference() -> String {
    TEXT.replace("{elements}\n", &tables())
}

fn tables() -> String {
    let mut tables = String::new();
    for Chapter { title, source, rows } in CHAPTERS {
        let gap = if tables.is_empty() { "" } else { "\n" };
        let _ = write!(
            tables,
            "{gap}### {title}\n\nSource: LAD/FBD reference, {source}.\n\n\
             | SIMATIC SD | SimaticML | PLCopen | Pins | Does | ENO = 0 |\n| --- | --- | --- | --- | --- | --- |\n"
        );
        for row in *rows {
            let sd = [&[row.name], row.sd].concat();
            let cells = [code(&sd), code(row.xml), code(row.open), pins(row), does(row), eno(row).to_string()];
            let _ = writeln!(tables, "| {} |", cells.join(" | "));
        }
    }
    tables
}

fn code(names: &[&str]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

/// `in, operand, out =>, [eno =>]`; brackets: can be left open; `bit :=>` is read and written.
fn pins(row: &Row) -> String {
    let pins: Vec<String> = row.pins().map(|one| pin(row, one)).collect();
    format!("`{}`", pins.join(", "))
}

fn pin(row: &Row, pin: PinRow) -> String {
    let mut text = pin.spellings().collect::<Vec<_>>().join("/");
    if pin.numbered {
        text.push_str(", …");
    }
    match pin.direction {
        PinDirection::Input => {}
        PinDirection::Output => text.push_str(" =>"),
        PinDirection::InOut => text.push_str(" :=>"),
    }
    let is_flow = |name: &str| !name.is_empty() && pin.spellings().any(|known| known == name);
    if is_flow(row.flow.0) || is_flow(row.flow.1) {
        text.insert(0, '*');
    }
    if pin.optional { format!("[{text}]") } else { text }
}

/// A text for a rising edge, or for a falling one.
fn edge(rising: bool, up: &str, down: &str) -> String {
    if rising { up.to_string() } else { down.to_string() }
}

/// The effect of the element.
fn does(row: &Row) -> String {
    let text: &str = match row.kind {
        Kind::Contact => "flow AND the operand; `I_Contact`: AND NOT the operand",
        Kind::Not => "inverts the flow",
        Kind::Gate(Gate::And) => "AND of all inputs; without further inputs, the unchanged flow",
        Kind::Gate(Gate::Or) => "OR of all inputs",
        Kind::Gate(Gate::Xor) => "TRUE if an odd number of inputs is",
        Kind::EdgeContact { rising } => {
            return edge(
                rising,
                "flow AND rising edge of the operand; `bit` then holds the operand, even without flow",
                "flow AND falling edge of the operand; `bit` then holds the operand, even without flow",
            );
        }
        Kind::EdgeTrigger { rising } => {
            return edge(
                rising,
                "rising edge of the flow; `bit` then holds the flow",
                "falling edge of the flow; `bit` then holds the flow",
            );
        }
        Kind::EdgeCoil { rising } => {
            return edge(
                rising,
                "the operand is TRUE for the cycle of a rising edge of the flow; `bit` then holds the flow",
                "the operand is TRUE for the cycle of a falling edge of the flow; `bit` then holds the flow",
            );
        }
        Kind::Coil => "writes the flow to the operand; `I_Coil`: the inverted flow. The flow continues after it",
        Kind::SetCoil => "with flow: writes TRUE",
        Kind::ResetCoil => "with flow: writes FALSE; resets a timer or counter of the S7-300/400",
        Kind::BitField { set: true } => {
            "with flow: writes TRUE to `n` bits beginning with the operand, at most to the end of an array"
        }
        Kind::BitField { set: false } => {
            "with flow: writes FALSE to `n` bits beginning with the operand, at most to the end of an array"
        }
        Kind::FlipFlop { set_wins: false } => "flip-flop; resetting wins",
        Kind::FlipFlop { set_wins: true } => "flip-flop; setting wins",
        Kind::Compare(op) => return format!("flow AND `in1 {op} in2`"),
        Kind::Range { inside: true } => "flow AND `min <= in <= max`",
        Kind::Range { inside: false } => "flow AND (`in < min` or `in > max`)",
        Kind::Variant(VariantQuestion::IsNull { null: true }) => "flow AND the VARIANT points to nothing",
        Kind::Variant(VariantQuestion::IsNull { null: false }) => "flow AND the VARIANT points to something",
        Kind::Variant(VariantQuestion::IsArray) => "flow AND the VARIANT points to an array",
        Kind::Variant(VariantQuestion::SameType { elements: false, same: true }) => {
            "flow AND both are of the same data type"
        }
        Kind::Variant(VariantQuestion::SameType { elements: false, same: false }) => {
            "flow AND they are not of the same data type"
        }
        Kind::Variant(VariantQuestion::SameType { elements: true, same: true }) => {
            "flow AND the first is an array whose elements have the data type of the second"
        }
        Kind::Variant(VariantQuestion::SameType { elements: true, same: false }) => {
            "flow AND the first is not an array whose elements have the data type of the second"
        }
        Kind::Valid { valid: true } => "flow AND the operand is a valid floating-point number",
        Kind::Valid { valid: false } => "flow AND the operand is not a valid floating-point number",
        Kind::Instance(name) => return format!("calls [{name}](stdlib.md) with its instance"),
        Kind::TimerCoil(name) => {
            return format!("[{name}](stdlib.md) with the flow as IN; Q and ET are read from its data");
        }
        Kind::ResetTimer => "with flow: ends an IEC timer: Q FALSE, ET 0",
        Kind::PresetTimer => "with flow: sets another duration for an IEC timer",
        Kind::Formula => "a standard function of PLCopen XML that SCL writes differently, such as MULTIME",
        Kind::Calculate => "the formula over the inputs, each of which is read once",
        Kind::Operator("MOD") => "remainder of the division, with the sign of `in1`",
        Kind::Operator(op) => return format!("`in1 {op} in2`; more inputs from left to right"),
        Kind::Step { up: true } => "adds 1 to the operand",
        Kind::Step { up: false } => "subtracts 1 from the operand",
        Kind::Function(name) => return function(name),
        Kind::Procedure(name) => return function(name),
        Kind::Move => "copies to each output; a narrower one gets the low bytes, a wider one gets zeros or the sign",
        Kind::Convert => "converts from the source type to the destination type, as [SCL](scl.md) does",
        Kind::Round("ROUND") => "nearest integer, halves to the even one",
        Kind::Round("TRUNC") => "integer toward 0",
        Kind::Round("CEIL") => "integer above",
        Kind::Round(_) => "integer below",
        Kind::Negate => "the number with the other sign",
        Kind::Invert => "all bits inverted",
        Kind::Mux => "input with number `k`; if there is none, `else`; without `else` nothing is written",
        Kind::Demux => "writes `in` to the output with number `k`; if there is none, to `else`",
        Kind::Jump { negated: false } => "with flow: jumps to the label",
        Kind::Jump { negated: true } => "without flow: jumps to the label",
        Kind::JumpList => "jumps to the label with number `k`; if there is none, continues with the next network",
        Kind::Switch => "jumps to the label of the first comparison of `k` that is true, otherwise to that of `else`",
        Kind::Return(ReturnValue::Operand) => "with flow: ends the block; its ENO is the operand, TRUE without one",
        Kind::Return(ReturnValue::True) => "with flow: ends the block with ENO TRUE",
        Kind::Return(ReturnValue::False) => "with flow: ends the block with ENO FALSE",
        Kind::S5Timer(name) => return function(name),
        Kind::S5Counter(name) => return function(name),
        Kind::CounterCoil(CounterCoil::Up) => "counts up at a rising edge of the flow",
        Kind::CounterCoil(CounterCoil::Down) => "counts down at a rising edge of the flow",
        Kind::CounterCoil(CounterCoil::Set) => "sets the counter at a rising edge of the flow",
        Kind::OpenDb { di: false } => "with flow: opens a data block; its number goes to the DB register",
        Kind::OpenDb { di: true } => "with flow: opens a data block; its number goes to the DI register",
        Kind::Mcr(Mcr::Activate) => "activates the Master Control Relay",
        Kind::Mcr(Mcr::Open) => "opens an MCR zone, which is on with flow in a zone that is on",
        Kind::Mcr(Mcr::Close) => "closes the innermost MCR zone",
        Kind::Mcr(Mcr::Deactivate) => "deactivates the Master Control Relay",
        Kind::CallCoil => "with flow: calls an FC or SFC without parameters",
        Kind::Condition => "the flow is the condition of a transition, an interlock or a supervision of GRAPH",
        Kind::Save => "writes the flow to BR, which is ENO of the block",
        Kind::Flag(flag) => return format!("flow AND {}", status(flag)),
    };
    text.to_string()
}

/// A function of SCL, or a block of the library.
fn function(name: &str) -> String {
    match scl::effect(name) {
        Some(text) => text.to_string(),
        None => format!("calls [{name}](stdlib.md)"),
    }
}

const fn status(flag: Flag) -> &'static str {
    match flag {
        Flag::Ov => "OV: the last box had an error",
        Flag::Os => "OS: a box of the block has had an error",
        Flag::Uo => "the last result was not a number",
        Flag::Br => "BR, ENO of the block so far",
        Flag::Equal => "the last result was 0",
        Flag::NotEqual => "the last result was above or below 0",
        Flag::Greater => "the last result was above 0",
        Flag::Less => "the last result was below 0",
        Flag::GreaterEqual => "the last result was 0 or above",
        Flag::LessEqual => "the last result was 0 or below",
    }
}

/// Errors that ENO reports, EN = 1. Empty: the element has no ENO.
fn eno(row: &Row) -> &'static str {
    if row.pin("eno").is_none() {
        return "";
    }
    if let Some(rule) = row.eno {
        return match rule {
            EnoRule::Never => "never",
            EnoRule::Overflow => "the result does not fit",
            EnoRule::Division => "division by 0; the result does not fit, or is not a number",
            EnoRule::Infinite => "the result is not a number, or infinite",
        };
    }
    match row.kind {
        Kind::Calculate | Kind::Formula => "a step of the formula has an error",
        Kind::Move | Kind::Invert => "never",
        Kind::Operator(_) | Kind::Step { .. } | Kind::Negate => "the result does not fit, or is not a number",
        Kind::Convert | Kind::Round(_) => "the value does not fit the destination type, or is not a number",
        Kind::Mux | Kind::Demux => "no pin has the number `k`",
        Kind::Function(name) | Kind::Procedure(name) | Kind::Instance(name) if scl::effect(name).is_none() => {
            "set by the block"
        }
        Kind::Function(_) | Kind::Procedure(_) => "the errors of that function; the result does not fit",
        _ => "never",
    }
}
