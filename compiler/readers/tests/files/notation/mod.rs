//! Networks with one element per line, for tests of this crate and of the binder.

use plcc_diag::{FileId, Span};
use plcc_syntax::network::ast::{
    Content, Element, Eno, Graph, Language, Net, NetId, Network, Pin, PinValue, Source, Storage, Target,
};
use plcc_syntax::network::elements::{PinDirection, find_sd};
use plcc_syntax::scl::ast::Expr;
use plcc_syntax::scl::fragment;

/// A network from a short notation: `w1 < Contact #a > w2`, `w1 < #t.TON pt=#x q1=>w3 > w2`; the rail is the net `rail`.
pub fn network(language: Language, lines: &[&str]) -> Network {
    let mut graph = Graph::default();
    for line in lines {
        element(&mut graph, line);
    }
    let content = Content::Graphic(graph);
    Network { language, title: None, comment: Vec::new(), labels: Vec::new(), content, span: Span::default() }
}

fn net(graph: &mut Graph, name: &str) -> NetId {
    if let Some(at) = graph.nets.iter().position(|net| net.name == name) {
        return NetId(at as u32);
    }
    let sources = match name {
        "rail" => vec![Source::Rail],
        _ if name.starts_with(['#', '"']) => vec![Source::Operand { value: expr(name), negated: false }],
        _ => Vec::new(),
    };
    graph.nets.push(Net { name: name.to_string(), sources, span: Span::default() });
    NetId(graph.nets.len() as u32 - 1)
}

fn expr(text: &str) -> Expr {
    fragment::expression(FileId(0), text, 0..text.len()).0
}

fn element(graph: &mut Graph, line: &str) {
    let words: Vec<&str> = line.split_whitespace().collect();
    let (from, words) = match words.as_slice() {
        [from, "<", rest @ ..] => (Some(*from), rest),
        rest => (None, rest),
    };
    let (words, to) = match words {
        [rest @ .., ">", to] => (rest, Some(*to)),
        rest => (rest, None),
    };
    let Some((&name, pins)) = words.split_first() else {
        let (from, to) = (net(graph, from.unwrap_or("rail")), net(graph, to.unwrap_or("rail")));
        return graph.nets[to.0 as usize].sources.push(Source::Net(from));
    };
    let (instance, name) = match name.rsplit_once('.') {
        Some((instance, name)) => (Some(expr(instance)), name),
        None => (None, name),
    };
    let (row, negated) = find_sd(name).expect("an element");
    let mut element = Element {
        target: Target::Element { row, instance },
        templates: Vec::new(),
        eno: Eno::Default,
        pins: Vec::new(),
        equation: None,
        cases: Vec::new(),
        span: Span::default(),
    };
    let mut add = |name: &str, value: PinValue, negated: bool, output: bool| {
        let pin = Pin { name: name.to_string(), value, negated, output, storage: Storage::None, span: Span::default() };
        element.pins.push(pin);
    };
    if let Some(from) = from {
        add(row.flow.0, PinValue::Net(net(graph, from)), false, false);
    }
    for pin in pins {
        let (name, text) = pin.split_once('=').unwrap_or(("operand", pin));
        let (invert, text) = text.strip_prefix('!').map_or((false, text), |text| (true, text));
        let value = match text {
            "" => PinValue::Open,
            _ if text.starts_with('w') => PinValue::Net(net(graph, text)),
            _ => PinValue::Operand(expr(text)),
        };
        let output = row.pin(name).is_some_and(|(pin, _)| pin.direction == PinDirection::Output);
        add(name, value, invert || name == "operand" && negated, output);
    }
    if let Some(to) = to {
        add(row.flow.1, PinValue::Net(net(graph, to)), false, true);
    }
    for (pin, value) in element.pins.iter().enumerate() {
        if let PinValue::Net(id) = value.value
            && value.output
        {
            graph.nets[id.0 as usize].sources.push(Source::Pin { element: graph.elements.len(), pin });
        }
    }
    graph.elements.push(element);
}
