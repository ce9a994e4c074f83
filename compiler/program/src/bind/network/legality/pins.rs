//! Pins: those that must be connected are connected, and only once.

use plcc_diag::Code;
use plcc_syntax::network::ast::{Element, Language, Pin, PinValue};
use plcc_syntax::network::elements::{Gate, Kind, PinDirection, Row};

use super::{Check, row, title};

pub fn check(check: &mut Check) {
    let graph = check.graph;
    for (at, element) in graph.elements.iter().enumerate() {
        twice(check, at, element);
        if let Some(row) = row(element) {
            required(check, at, element, row);
            second(check, at, element, row);
            gate(check, at, element, row);
        }
    }
}

fn is_open(pin: Option<&Pin>) -> bool {
    pin.is_none_or(|pin| pin.value == PinValue::Open)
}

/// An input that is connected twice. Outputs may go to several destinations.
fn twice(check: &mut Check, at: usize, element: &Element) {
    for (place, pin) in element.pins.iter().enumerate() {
        let same = |other: &&Pin| !other.output && other.name.eq_ignore_ascii_case(&pin.name);
        if !pin.output && element.pins[..place].iter().any(|other| same(&other)) {
            let text = format!("the pin `{}` of {} is connected twice", pin.name, title(element));
            let help = "connect the pin once; join signals with a gate or with parallel contacts";
            check.report(Code::DuplicateParameter, pin.span, Some(at), text, "connected again here", help);
        }
    }
}

/// Pins that the element needs.
fn required(check: &mut Check, at: usize, element: &Element, row: &'static Row) {
    for pin in row.pins().filter(|pin| !pin.optional && pin.name() != row.flow.1) {
        let given = element.pin(pin.name());
        if !is_open(given) {
            continue;
        }
        let span = given.map_or(element.span, |pin| pin.span);
        let name = pin.name();
        if name == row.flow.0 {
            no_flow(check, at, element, name);
        } else if matches!(name, "operand" | "label" | "timer" | "bit") {
            let what = match name {
                "label" => "label to jump to",
                "bit" => "edge memory bit",
                "timer" => "timer",
                _ => "operand",
            };
            let help = match name {
                "label" => "give the jump a label, and give its target network the same label",
                "bit" => "enter a BOOL in bit memory or in static data that nothing else uses",
                _ => "put the name of a variable where the editor shows <??.?>",
            };
            let text = format!("{} has no {what}", title(element));
            check.report(Code::MissingOperand, span, Some(at), text, &format!("the {what} is missing"), help);
        } else {
            let text = format!("{} has no {} `{name}`", title(element), side(pin.direction));
            let help = "connect the pin with a variable, a constant or another element";
            check.report(Code::MissingParameter, span, Some(at), text, &format!("`{name}` is not connected"), help);
        }
    }
}

/// Sums and similar operations need at least two values.
fn second(check: &mut Check, at: usize, element: &Element, row: &'static Row) {
    let several = matches!(row.kind, Kind::Operator(_) | Kind::Function("MIN" | "MAX"));
    let numbered = row.pins().any(|pin| pin.numbered && pin.name() == "in1");
    let given = element.pin("in2");
    if several && numbered && is_open(given) && !is_open(element.pin("in1")) {
        let span = given.map_or(element.span, |pin| pin.span);
        let text = format!("{} has no input `in2`", title(element));
        let help = "connect the pin with a variable, a constant or another element";
        check.report(Code::MissingParameter, span, Some(at), text, "`in2` is not connected", help);
    }
}

fn side(direction: PinDirection) -> &'static str {
    match direction {
        PinDirection::Input => "input",
        PinDirection::Output => "output",
        PinDirection::InOut => "in/out",
    }
}

/// The flow enters an element through this pin, and it is not connected.
fn no_flow(check: &mut Check, at: usize, element: &Element, pin: &str) {
    match check.network.language {
        Language::Fbd => {
            let text = format!("input `{pin}` of {} is not connected", title(element));
            let help = "connect the input with a variable, a constant or another element";
            check.report(Code::GateInputs, element.span, Some(at), text, "no signal comes in here", help);
        }
        Language::Lad | Language::Scl | Language::Stl => {
            let text = format!("{} is not connected with the power rail", title(element));
            let help = "draw the rung from the left power rail";
            check.report(Code::NoSource, element.span, Some(at), text, "no power can get here", help);
        }
    }
}

/// A gate joins at least two signals; FBD passes on a signal with an AND of one.
fn gate(check: &mut Check, at: usize, element: &Element, row: &'static Row) {
    let Kind::Gate(gate) = row.kind else { return };
    let inputs = element.pins.iter().filter(|pin| !pin.output);
    let connected = inputs.clone().filter(|pin| pin.value != PinValue::Open).count();
    let passes = gate == Gate::And && connected == 1 && inputs.count() == 1;
    // If in1 is missing, there is already a message.
    if connected < 2 && !passes && !is_open(element.pin(row.flow.0)) {
        let sign = match gate {
            Gate::And => "AND",
            Gate::Or => "OR",
            Gate::Xor => "XOR",
        };
        let text = format!("an {sign} gate with one connected input");
        let help = "connect a second input, or remove the gate";
        check.report(Code::GateInputs, element.span, Some(at), text, "at least two inputs must be connected", help);
    }
}
