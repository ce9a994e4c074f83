//! An element as a rectangle of characters.

use super::operand::operand;
use crate::network::ast::{Element, Graph, Language, NetId, Pin, PinValue, Storage, Target};
use crate::network::elements::{CounterCoil, Gate, Kind, Mcr, Row};

/// An element's characters: lines of one width.
pub struct Shape {
    pub lines: Vec<String>,
    /// The line that the flow enters and leaves.
    pub baseline: usize,
    pub width: usize,
}

impl Shape {
    /// The shape of `element`; `marked`: with `^` below it.
    pub fn of(graph: &Graph, element: &Element, language: Language, marked: bool) -> Shape {
        let mut shape = match &element.target {
            Target::Element { row, .. } => match symbol(row, element, language) {
                Some(symbol) => small(graph, element, row, &symbol),
                None => boxed(graph, element),
            },
            Target::Block { .. } => boxed(graph, element),
        };
        if marked {
            shape.lines.push("^".repeat(shape.width));
        }
        shape
    }
}

/// The name of the pin that the flow enters, and of the one that it leaves.
pub fn flow(element: &Element) -> (&'static str, &'static str) {
    match &element.target {
        Target::Element { row, .. } => row.flow,
        Target::Block { .. } => ("en", "eno"),
    }
}

/// The name of a net where no line leads to it.
pub fn net_name(graph: &Graph, id: NetId) -> String {
    match graph.nets.get(id.0 as usize) {
        Some(net) if !net.name.is_empty() => net.name.chars().take(20).collect(),
        _ => format!("n{}", id.0),
    }
}

/// Whether a timer of the S7-300/400 is a box: a coil has no pins but the timer and its time.
pub fn is_timer_box(element: &Element) -> bool {
    ["r", "bi", "bcd", "q"].iter().any(|name| element.pin(name).is_some())
}

/// The symbol of elements without a box: `|/|`, `(S)`, in FBD `[=]`.
pub fn symbol(row: &Row, element: &Element, language: Language) -> Option<String> {
    let negated = element.pin("operand").is_some_and(|pin| pin.negated);
    let coil = |text: &str| {
        let (open, close) = if language == Language::Fbd { ('[', ']') } else { ('(', ')') };
        Some(format!("{open}{text}{close}"))
    };
    let contact = |text: &str| Some(format!("|{text}|"));
    // The boxes of FBD are `=`, `/=`, `P=` and `N=`.
    let assigned = |in_lad: &str| match (language, in_lad) {
        (Language::Fbd, sign) => coil(&format!("{sign}=")),
        (Language::Lad | Language::Scl | Language::Stl, "") => coil(" "),
        (Language::Lad | Language::Scl | Language::Stl, sign) => coil(sign),
    };
    match row.kind {
        Kind::Contact => contact(if negated { "/" } else { " " }),
        Kind::Not => contact("NOT"),
        Kind::EdgeContact { rising } => contact(if rising { "P" } else { "N" }),
        Kind::Compare(sign) if language == Language::Lad => contact(if sign == "=" { "==" } else { sign }),
        Kind::Variant(_) => contact(row.name),
        Kind::Valid { valid } => contact(if valid { "OK" } else { "NOT_OK" }),
        Kind::Flag(_) => contact(row.name.trim_end_matches("_FlagContact").trim_end_matches("_Flags_Contact")),
        Kind::Coil => assigned(if negated { "/" } else { "" }),
        Kind::SetCoil => coil("S"),
        Kind::ResetCoil => coil("R"),
        Kind::EdgeCoil { rising } => assigned(if rising { "P" } else { "N" }),
        Kind::BitField { set } => coil(if set { "SET_BF" } else { "RESET_BF" }),
        Kind::TimerCoil(name) => coil(name),
        Kind::S5Timer(name) if language == Language::Lad && !is_timer_box(element) => coil(match name {
            "S_PULSE" => "SP",
            "S_PEXT" => "SE",
            "S_ODT" => "SD",
            "S_ODTS" => "SS",
            _ => "SF",
        }),
        Kind::ResetTimer => coil("RT"),
        Kind::PresetTimer => coil("PT"),
        Kind::Jump { negated } => coil(if negated { "JMPN" } else { "JMP" }),
        Kind::Return(_) => coil("RET"),
        Kind::CounterCoil(which) => coil(match which {
            CounterCoil::Up => "CU",
            CounterCoil::Down => "CD",
            CounterCoil::Set => "SC",
        }),
        Kind::OpenDb { .. } => coil("OPN"),
        Kind::Mcr(which) => coil(match which {
            Mcr::Activate => "MCRA",
            Mcr::Open => "MCR<",
            Mcr::Close => "MCR>",
            Mcr::Deactivate => "MCRD",
        }),
        Kind::CallCoil => coil("CALL"),
        Kind::Save => coil("SAVE"),
        Kind::Condition => assigned(""),
        Kind::Gate(_)
        | Kind::EdgeTrigger { .. }
        | Kind::FlipFlop { .. }
        | Kind::Compare(_)
        | Kind::Range { .. }
        | Kind::Instance(_)
        | Kind::Calculate
        | Kind::Formula
        | Kind::Operator(_)
        | Kind::Step { .. }
        | Kind::Function(_)
        | Kind::Procedure(_)
        | Kind::Move
        | Kind::Convert
        | Kind::Round(_)
        | Kind::Negate
        | Kind::Invert
        | Kind::Mux
        | Kind::Demux
        | Kind::JumpList
        | Kind::Switch
        | Kind::S5Timer(_)
        | Kind::S5Counter(_) => None,
    }
}

/// A contact or coil: its first operand above, the others below.
fn small(graph: &Graph, element: &Element, row: &Row, symbol: &str) -> Shape {
    let is_flow = |pin: &Pin| row.flow.0 == pin.name || row.flow.1 == pin.name && matches!(pin.value, PinValue::Net(_));
    let mut labels = element.pins.iter().filter(|pin| !is_flow(pin)).map(|pin| value(graph, pin));
    let above = match labels.next() {
        Some(label) => label,
        // A required operand is missing.
        None if row.pins().any(|pin| !pin.optional && pin.name() != row.flow.0 && pin.name() != row.flow.1) => {
            "<??.?>".to_string()
        }
        None => String::new(),
    };
    let below: Vec<String> = labels.collect();
    let width = below.iter().chain([&above]).map(|text| count(text)).max().unwrap_or(0).max(count(symbol));
    let mut lines = vec![centered(&above, width, ' '), centered(symbol, width, '-')];
    let goes_on = element.pins.iter().any(|pin| pin.output && matches!(pin.value, PinValue::Net(_)));
    if !goes_on {
        lines[1] = format!("{:width$}", lines[1].trim_end_matches('-'));
    }
    lines.extend(below.iter().map(|text| centered(text, width, ' ')));
    Shape { lines, baseline: 1, width }
}

/// A gate, box or call with its pins.
fn boxed(graph: &Graph, element: &Element) -> Shape {
    let (title, instance) = match &element.target {
        Target::Element { row, instance } => {
            let sign = match row.kind {
                Kind::Gate(Gate::And) => "&",
                Kind::Gate(Gate::Or) => ">=1",
                Kind::Gate(Gate::Xor) => "XOR",
                _ => row.name,
            };
            (sign.to_string(), instance.as_ref().map(operand))
        }
        Target::Block { callee, instance } => (operand(callee), instance.as_ref().map(operand)),
    };
    let (flow_in, flow_out) = flow(element);
    let sides = |output: bool, flow: &str| -> Vec<&Pin> {
        let mut pins: Vec<&Pin> = element.pins.iter().filter(|pin| pin.output == output).collect();
        // The flow is on the first line.
        pins.sort_by_key(|pin| !pin.name.eq_ignore_ascii_case(flow));
        pins.truncate(PINS_MAX);
        pins
    };
    let (left, right) = (sides(false, flow_in), sides(true, flow_out));
    let is_line = |pin: &Pin, flow: &str| pin.name.eq_ignore_ascii_case(flow) && matches!(pin.value, PinValue::Net(_));
    let left_label = |pin: &Pin| if is_line(pin, flow_in) { String::new() } else { value(graph, pin) };
    let right_label = |pin: &Pin| if is_line(pin, flow_out) { String::new() } else { value(graph, pin) };
    let gutter = |labels: Vec<String>| labels.iter().map(|label| count(label)).max().unwrap_or(0);
    let (left_width, right_width) =
        (gutter(left.iter().map(|p| left_label(p)).collect()), gutter(right.iter().map(|p| right_label(p)).collect()));
    let names = |pins: &[&Pin]| pins.iter().map(|pin| count(&pin.name)).max().unwrap_or(0);
    let inner = (names(&left) + names(&right) + 1).max(count(&title)).max(3);

    // If the flow has no output line, it leaves on a first line that has no pin.
    let right: Vec<Option<&Pin>> = match right.first() {
        Some(first) if !first.name.eq_ignore_ascii_case(flow_out) => {
            std::iter::once(None).chain(right.into_iter().map(Some)).collect()
        }
        _ => right.into_iter().map(Some).collect(),
    };
    let left: Vec<Option<&Pin>> = match left.first() {
        Some(first) if !first.name.eq_ignore_ascii_case(flow_in) => {
            std::iter::once(None).chain(left.into_iter().map(Some)).collect()
        }
        _ => left.into_iter().map(Some).collect(),
    };
    let mut lines = Vec::new();
    let pad = |text: &str| format!("{}{}{}", " ".repeat(left_width + 2), text, " ".repeat(right_width + 2));
    lines.push(pad(&centered(&instance.unwrap_or_default(), inner + 2, ' ')));
    lines.push(pad(&format!("+{}+", centered(&title, inner, '-'))));
    for at in 0..left.len().max(right.len()).max(1) {
        let (input, output) = (left.get(at).copied().flatten(), right.get(at).copied().flatten());
        let (mut line, name) = match input {
            Some(pin) => {
                let fill = if is_line(pin, flow_in) { "-" } else { " " };
                let label = left_label(pin);
                let end = if pin.negated { "-o" } else { "--" };
                (format!("{}{label}{end}", fill.repeat(left_width - count(&label))), pin.name.as_str())
            }
            None => (" ".repeat(left_width + 2), ""),
        };
        let out_name = output.map_or("", |pin| pin.name.as_str());
        let blanks = inner - count(name) - count(out_name);
        line.push_str(&format!("|{name}{}{out_name}|", " ".repeat(blanks)));
        match output {
            Some(pin) => {
                let fill = if is_line(pin, flow_out) { "-" } else { " " };
                let label = right_label(pin);
                line.push_str(if pin.negated { "o-" } else { "--" });
                line.push_str(&label);
                line.push_str(&fill.repeat(right_width - count(&label)));
            }
            None => line.push_str(&" ".repeat(right_width + 2)),
        }
        lines.push(line);
    }
    lines.push(pad(&format!("+{}+", "-".repeat(inner))));
    let width = left_width + right_width + inner + 6;
    Shape { lines, baseline: 2, width }
}

/// Pins of a side that are drawn.
const PINS_MAX: usize = 24;

/// What is connected to a pin.
fn value(graph: &Graph, pin: &Pin) -> String {
    let text = match &pin.value {
        PinValue::Net(id) => net_name(graph, *id),
        PinValue::Operand(value) => operand(value),
        PinValue::Open if pin.output => String::new(),
        PinValue::Open => "<??.?>".to_string(),
    };
    match pin.storage {
        Storage::None => text,
        Storage::Set => format!("{text} S"),
        Storage::Reset => format!("{text} R"),
    }
}

fn count(text: &str) -> usize {
    text.chars().count()
}

fn centered(text: &str, width: usize, fill: char) -> String {
    let free = width.saturating_sub(count(text));
    let (left, right) = (free / 2, free - free / 2);
    let side = |n: usize| fill.to_string().repeat(n);
    format!("{}{text}{}", side(left), side(right))
}
