//! The flow: it comes from the rail, goes from left to right, and ends in an element that acts.

use plcc_diag::Code;
use plcc_syntax::network::ast::{Element, Language, Net, NetId, PinValue, Source};
use plcc_syntax::network::draw::operand;
use plcc_syntax::network::elements::Kind;

use super::{Check, only_logic, row, title};

pub fn check(check: &mut Check) {
    loops(check);
    let graph = check.graph;
    for (at, net) in graph.nets.iter().enumerate() {
        sources(check, at, net);
        joined_data(check, net);
    }
    let mut told = vec![false; graph.nets.len()];
    for (at, element) in graph.elements.iter().enumerate() {
        dead_end(check, at, element, &mut told);
        place(check, at, element);
    }
    operands_for_nothing(check);
    last(check);
}

fn called(net: &Net) -> String {
    if net.name.is_empty() { "a branch".to_string() } else { format!("the branch `{}`", net.name) }
}

/// Nets that nothing feeds, and branches without an element.
fn sources(check: &mut Check, at: usize, net: &Net) {
    let feeds = &check.feeds[at];
    let first = feeds.elements.first().copied();
    if net.sources.is_empty() {
        let Some(element) = first.and_then(|at| check.graph.elements.get(at)) else { return };
        let text = format!("nothing feeds {}, which gives {} its signal", called(net), title(element));
        let help = "begin the rung at the power rail, or end another branch where this one begins";
        return check.report(Code::NoSource, element.span, first, text, "no signal can get here", help);
    }
    if check.network.language != Language::Lad {
        return;
    }
    let bare = net.sources.iter().find(|source| match source {
        Source::Net(_) => true,
        Source::Rail => net.sources.len() > 1,
        Source::Pin { .. } | Source::Operand { .. } => false,
    });
    if bare.is_some() {
        let text = format!("a branch without an element bridges the elements before {}", called(net));
        let help = "put a contact into the branch or remove it: it makes the elements parallel to it useless";
        check.report(Code::ShortCircuit, net.span, first, text, "short circuit", help);
    }
}

/// Values of boxes that are joined like signals.
fn joined_data(check: &mut Check, net: &Net) {
    if net.sources.len() < 2 {
        return;
    }
    let data = net.sources.iter().find_map(|source| match source {
        Source::Pin { element, pin } => {
            let from = check.graph.elements.get(*element)?;
            let pin = from.pins.get(*pin)?;
            gives_value(from, &pin.name).then_some((*element, from, pin))
        }
        Source::Rail | Source::Operand { .. } | Source::Net(_) => None,
    });
    if let Some((at_element, from, pin)) = data {
        let text = format!("output `{}` of {} is joined with another output", pin.name, title(from));
        let help = "give each value its own variable; only signals of type BOOL can be joined, which means their OR";
        check.report(Code::ElementType, pin.span, Some(at_element), text, "a value, not a signal", help);
    }
}

/// The output is a number or another value, never a signal.
fn gives_value(element: &Element, pin: &str) -> bool {
    let Some(row) = row(element) else { return false };
    if pin.eq_ignore_ascii_case(row.flow.1) || pin.eq_ignore_ascii_case("eno") {
        return false;
    }
    match row.kind {
        Kind::Calculate
        | Kind::Formula
        | Kind::Operator(_)
        | Kind::Convert
        | Kind::Round(_)
        | Kind::Negate
        | Kind::Invert
        | Kind::S5Timer(_)
        | Kind::S5Counter(_) => true,
        Kind::Instance(_) => pin.eq_ignore_ascii_case("et") || pin.eq_ignore_ascii_case("cv"),
        _ => false,
    }
}

/// Contacts and gates whose result is unused.
fn dead_end(check: &mut Check, at: usize, element: &Element, told: &mut [bool]) {
    if !only_logic(element) {
        return;
    }
    let mut net = None;
    for pin in element.pins.iter().filter(|pin| pin.output) {
        match pin.value {
            PinValue::Operand(_) => return,
            PinValue::Net(id) if check.feeds.get(id.0 as usize).is_some_and(|feeds| !feeds.nothing()) => return,
            PinValue::Net(id) => net = Some(id),
            PinValue::Open => {}
        }
    }
    if let Some(id) = net
        && let Some(told) = told.get_mut(id.0 as usize)
        && std::mem::replace(told, true)
    {
        return;
    }
    let name = title(element);
    let branch = net.and_then(|id| check.graph.nets.get(id.0 as usize)).filter(|net| !net.name.is_empty());
    match (check.network.language, branch) {
        (Language::Fbd, _) => {
            let help = "connect the output with a coil, a box or a variable";
            let text = format!("the output of {name} is not connected");
            check.report(Code::GateInputs, element.span, Some(at), text, "the result is not used", help);
        }
        (Language::Lad | Language::Scl | Language::Stl, Some(net)) => {
            let text = format!("{} goes nowhere", called(net));
            let help = "end the branch at a coil or a box, or where another branch continues";
            check.report(Code::OpenBranch, element.span, Some(at), text, "the branch is not closed after this", help);
        }
        (Language::Lad | Language::Scl | Language::Stl, None) => {
            let text = format!("the rung ends in {name} and has no output");
            let help = match unjoined(check) {
                Some(name) => format!(
                    "end the rung in a wire if it is a branch, such as `END_RUNG wire#{name}`; otherwise put a coil or a box at its end"
                ),
                None => "put a coil or a box at the end of the rung".to_string(),
            };
            check.report(
                Code::ElementPlace,
                element.span,
                Some(at),
                text,
                "cannot be the last element of a rung",
                &help,
            );
        }
    }
}

/// The name of the only wire with one source and one use, where a branch may be meant to join. Only SIMATIC SD names its nets.
fn unjoined<'g>(check: &Check<'g>) -> Option<&'g str> {
    let graph = check.graph;
    let mut found = graph.nets.iter().enumerate().filter(|(at, net)| {
        !net.name.is_empty()
            && matches!(net.sources.as_slice(), [Source::Pin { .. }])
            && check.feeds.get(*at).is_some_and(|feeds| feeds.elements.len() == 1 && !feeds.net)
    });
    let (_, net) = found.next().filter(|_| found.next().is_none())?;
    Some(&net.name)
}

/// Rungs of FBD with an operand that feeds a net that is not read.
fn operands_for_nothing(check: &mut Check) {
    let graph = check.graph;
    for (at, net) in graph.nets.iter().enumerate() {
        let value = net.sources.iter().find_map(|source| match source {
            Source::Operand { value, .. } => Some(value),
            Source::Rail | Source::Pin { .. } | Source::Net(_) => None,
        });
        if let Some(value) = value.filter(|_| check.feeds[at].nothing()) {
            let text = format!("the branch that begins with `{}` goes nowhere", operand(value));
            let help = "connect it with a coil, a gate or a box, or remove it";
            check.report(Code::OpenBranch, value.span, None, text, "nothing uses this value", help);
        }
    }
}

/// NOT at the rail; elements after an element without an output.
fn place(check: &mut Check, at: usize, element: &Element) {
    let graph = check.graph;
    let Some(row) = row(element) else { return };
    let from = element.pin(row.flow.0).and_then(|pin| match pin.value {
        PinValue::Net(id) => graph.nets.get(id.0 as usize),
        PinValue::Operand(_) | PinValue::Open => None,
    });
    let Some(net) = from else { return };
    let at_rail = !net.sources.is_empty() && net.sources.iter().all(|source| *source == Source::Rail);
    if row.kind == Kind::Not && check.network.language == Language::Lad && at_rail {
        let help = "put a contact before NOT, or remove the rung: it never has power";
        let text = "NOT is the first element of the rung".to_string();
        return check.report(Code::ElementPlace, element.span, Some(at), text, "inverts the power rail", help);
    }
    let before = net.sources.iter().find_map(|source| match source {
        Source::Pin { element, pin } => {
            let before = graph.elements.get(*element)?;
            before.pins.get(*pin).is_none_or(|pin| !pin.output).then_some(before)
        }
        Source::Rail | Source::Operand { .. } | Source::Net(_) => None,
    });
    if let Some(before) = before {
        let text = format!("{} comes after {}, which has no output", title(element), title(before));
        let help = "put it into a separate branch, or before the other one";
        check.report(Code::ElementPlace, element.span, Some(at), text, "no power can get here", help);
    }
}

/// A jump ends its network: the order of anything after it would depend on the way that the editor draws.
fn last(check: &mut Check) {
    let graph = check.graph;
    let leaves =
        |element: &Element| row(element).is_some_and(|row| matches!(row.kind, Kind::Jump { .. } | Kind::Return(_)));
    let Some(at) = graph.elements.iter().position(leaves) else { return };
    let element = &graph.elements[at];
    let Some(after) = graph.elements[at + 1..].iter().find(|other| !only_logic(other)) else { return };
    let text = format!("{} is not the last element of its network: {} comes after it", title(element), title(after));
    let help = "move everything after it to a separate network";
    check.report(Code::ElementPlace, element.span, Some(at), text, "leaves the network here", help);
}

/// Signals that depend on themselves.
fn loops(check: &mut Check) {
    for group in circles(check) {
        let count = check.graph.elements.len();
        let Some(at) = group.iter().copied().filter(|node| *node < count).max() else {
            let Some(net) = group.first().and_then(|node| check.graph.nets.get(node - count)) else { continue };
            let text = format!("{} has no element and goes back to itself", called(net));
            let help = "begin the branch at the power rail or after an element";
            check.report(Code::ReverseFlow, net.span, None, text, "a loop of branches", help);
            continue;
        };
        let element = &check.graph.elements[at];
        let (text, help) = match check.network.language {
            Language::Fbd => (
                format!("the output of {} goes back to its own inputs", title(element)),
                "write the signal to a variable and read the variable: it has the value of the last cycle",
            ),
            Language::Lad | Language::Scl | Language::Stl => (
                format!("power would flow from right to left through {}", title(element)),
                "end the branch to the right of where it begins",
            ),
        };
        check.report(Code::ReverseFlow, element.span, Some(at), text, "the signal comes back to here", help);
    }
}

/// Groups of elements and nets that depend on each other in a circle. Nodes: elements, then nets.
fn circles(check: &Check) -> Vec<Vec<usize>> {
    let graph = check.graph;
    let count = graph.elements.len();
    let net = |id: NetId| count + id.0 as usize;
    let mut next: Vec<Vec<usize>> = vec![Vec::new(); count + graph.nets.len()];
    for (at, element) in graph.elements.iter().enumerate() {
        for pin in element.pins.iter().filter(|pin| !pin.output) {
            if let PinValue::Net(id) = pin.value
                && let Some(list) = next.get_mut(net(id))
            {
                list.push(at);
            }
        }
    }
    for (at, known) in graph.nets.iter().enumerate() {
        for source in &known.sources {
            let from = match source {
                Source::Pin { element, .. } => *element,
                Source::Net(id) => net(*id),
                Source::Rail | Source::Operand { .. } => continue,
            };
            if let Some(list) = next.get_mut(from) {
                list.push(count + at);
            }
        }
    }
    let circle = |group: &Vec<usize>| group.len() > 1 || group.iter().any(|node| next[*node].contains(node));
    strongly_connected(&next).into_iter().filter(circle).collect()
}

/// Tarjan's algorithm with an explicit stack: networks may be long.
fn strongly_connected(next: &[Vec<usize>]) -> Vec<Vec<usize>> {
    const UNSEEN: usize = usize::MAX;
    let mut groups = Vec::new();
    let (mut index, mut low) = (vec![UNSEEN; next.len()], vec![0; next.len()]);
    let mut on_stack = vec![false; next.len()];
    let mut stack = Vec::new();
    let mut counter = 0;
    for root in 0..next.len() {
        if index[root] != UNSEEN {
            continue;
        }
        // A node, and how many of its successors have been visited.
        let mut work: Vec<(usize, usize)> = vec![(root, 0)];
        while let Some((node, done)) = work.pop() {
            if done == 0 {
                index[node] = counter;
                low[node] = counter;
                counter += 1;
                stack.push(node);
                on_stack[node] = true;
            } else {
                low[node] = low[node].min(low[next[node][done - 1]]);
            }
            let mut at = done;
            let mut deeper = None;
            while let Some(&to) = next[node].get(at) {
                at += 1;
                if index[to] == UNSEEN {
                    deeper = Some(to);
                    break;
                }
                if on_stack[to] {
                    low[node] = low[node].min(index[to]);
                }
            }
            if let Some(to) = deeper {
                work.push((node, at));
                work.push((to, 0));
                continue;
            }
            if low[node] == index[node] {
                let from = stack.iter().rposition(|other| *other == node).unwrap_or(0);
                let group = stack.split_off(from);
                group.iter().for_each(|member| on_stack[*member] = false);
                groups.push(group);
            }
        }
    }
    groups
}
