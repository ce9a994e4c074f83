//! The position of each element.

use std::collections::{HashMap, HashSet, VecDeque};

use super::canvas::Canvas;
use super::operand::operand;
use super::shape::{Shape, flow, net_name};
use crate::network::ast::{Element, Graph, NetId, PinValue, Source};

/// Columns between a net and the element after it, the net's own column included.
const LEAD: usize = 4;

/// The elements to draw: the marked one and those nearest to it along the nets, at most `most`, in the order of the graph.
pub fn choose(graph: &Graph, mark: Option<usize>, most: usize) -> Vec<usize> {
    let mut touching: HashMap<NetId, Vec<usize>> = HashMap::new();
    for (at, element) in graph.elements.iter().enumerate() {
        for pin in &element.pins {
            if let PinValue::Net(id) = pin.value {
                touching.entry(id).or_default().push(at);
            }
        }
    }
    let mark = mark.filter(|at| *at < graph.elements.len());
    let mut chosen: HashSet<usize> = HashSet::new();
    let mut queue: VecDeque<usize> = mark.into_iter().collect();
    // Without a mark, or when all neighbours are chosen: from the first element on.
    let mut rest = 0..graph.elements.len();
    while chosen.len() < most {
        let Some(at) = queue.pop_front().or_else(|| if mark.is_none() { rest.next() } else { None }) else { break };
        if !chosen.insert(at) || mark.is_none() {
            continue;
        }
        for pin in &graph.elements[at].pins {
            if let PinValue::Net(id) = pin.value {
                queue.extend(touching[&id].iter().filter(|other| !chosen.contains(other)).take(most));
            }
        }
    }
    let mut chosen: Vec<usize> = chosen.into_iter().collect();
    chosen.sort_unstable();
    chosen
}

/// A line of the drawing: elements that follow each other.
#[derive(Default)]
struct Line {
    start: Option<NetId>,
    /// Indices into the shapes.
    shapes: Vec<usize>,
    end: Option<NetId>,
}

/// What a net looks like in the drawing.
#[derive(Default, Clone)]
struct NetPlan {
    column: Option<usize>,
    /// Indices of chosen elements that the net's flow enters.
    flows: Vec<usize>,
    /// The net feeds a pin that no line leads to, or an element outside the drawing.
    named: bool,
    /// The power rail feeds it, and nothing else.
    rail: bool,
    /// Where lines meet it.
    rows: Vec<usize>,
}

/// The positions of all parts.
pub struct Plan {
    lines: Vec<Line>,
    nets: HashMap<NetId, NetPlan>,
    /// Column of each shape.
    columns: Vec<usize>,
}

/// The net that the flow of an element comes from.
fn flow_in(element: &Element) -> Option<NetId> {
    let name = flow(element).0;
    element.pins.iter().find_map(|pin| match pin.value {
        PinValue::Net(id) if !pin.output && pin.name.eq_ignore_ascii_case(name) => Some(id),
        _ => None,
    })
}

/// The net that the flow of an element goes to.
fn flow_out(element: &Element) -> Option<NetId> {
    let name = flow(element).1;
    element.pins.iter().find_map(|pin| match pin.value {
        PinValue::Net(id) if pin.output && pin.name.eq_ignore_ascii_case(name) => Some(id),
        _ => None,
    })
}

impl Plan {
    /// The plan of the elements `chosen`, each with its shape.
    pub fn of(graph: &Graph, chosen: &[usize], shapes: &[Shape]) -> Plan {
        let mut nets: HashMap<NetId, NetPlan> = HashMap::new();
        for (at, element) in graph.elements.iter().enumerate() {
            let shape = chosen.binary_search(&at).ok();
            for pin in element.pins.iter().filter(|pin| !pin.output) {
                let PinValue::Net(id) = pin.value else { continue };
                let is_flow = pin.name.eq_ignore_ascii_case(flow(element).0);
                match shape {
                    Some(shape) if is_flow => nets.entry(id).or_default().flows.push(shape),
                    _ => nets.entry(id).or_default().named = true,
                }
            }
        }
        let used: HashSet<NetId> = chosen
            .iter()
            .flat_map(|at| &graph.elements[*at].pins)
            .filter_map(|pin| match pin.value {
                PinValue::Net(id) => Some(id),
                PinValue::Operand(_) | PinValue::Open => None,
            })
            .collect();
        nets.retain(|id, _| used.contains(id));
        for id in used {
            let sources = graph.nets.get(id.0 as usize).map_or(&[][..], |net| &net.sources);
            let net = nets.entry(id).or_default();
            net.rail = !sources.is_empty() && sources.iter().all(|source| matches!(source, Source::Rail));
        }
        let mut plan = Plan { lines: Vec::new(), nets, columns: vec![0; shapes.len()] };
        let widths: Vec<usize> = shapes.iter().map(|shape| shape.width).collect();
        let mut columns = Columns { graph, chosen, widths: &widths, known: HashMap::new() };
        for (shape, at) in chosen.iter().enumerate() {
            plan.columns[shape] = columns.element(*at);
        }
        let ids: Vec<NetId> = plan.nets.keys().copied().collect();
        for id in ids {
            let column = columns.net(id);
            if let Some(net) = plan.nets.get_mut(&id) {
                net.column = Some(column);
            }
        }
        plan.lines = lines(graph, chosen, &plan.nets, &plan.columns);
        plan
    }

    /// Draws everything.
    pub fn paint(mut self, graph: &Graph, shapes: &[Shape]) -> Canvas {
        let mut canvas = Canvas::default();
        let mut top = 0;
        for line in std::mem::take(&mut self.lines) {
            let members = || line.shapes.iter().map(|at| &shapes[*at]);
            let above = members().map(|shape| shape.baseline).max().unwrap_or(1);
            let below = members().map(|shape| shape.lines.len() - shape.baseline).max().unwrap_or(1);
            self.paint_line(graph, &line, shapes, top + above, &mut canvas);
            top += above + below;
        }
        self.paint_nets(graph, &mut canvas);
        canvas
    }

    fn column(&self, id: NetId) -> usize {
        self.nets.get(&id).and_then(|net| net.column).unwrap_or(0)
    }

    fn meet(&mut self, id: NetId, row: usize) {
        if let Some(net) = self.nets.get_mut(&id) {
            net.rows.push(row);
        }
    }

    fn paint_line(&mut self, graph: &Graph, line: &Line, shapes: &[Shape], row: usize, canvas: &mut Canvas) {
        let mut from = line.start;
        for (place, shape) in line.shapes.iter().enumerate() {
            let column = self.columns[*shape];
            if let Some(id) = from {
                self.meet(id, row);
                (self.column(id) + 1..column).for_each(|x| canvas.fill(x, row, '-'));
                if place == 0 {
                    self.paint_lead(graph, id, row, canvas);
                }
            }
            for (at, text) in shapes[*shape].lines.iter().enumerate() {
                canvas.write(column, row + at - shapes[*shape].baseline, text);
            }
            let next = if place + 1 == line.shapes.len() { line.end } else { None };
            let next = next.or_else(|| line.shapes.get(place + 1).and_then(|_| self.between(line, place)));
            if let Some(id) = next.filter(|id| self.column(*id) > column) {
                (column + shapes[*shape].width..self.column(id)).for_each(|x| canvas.fill(x, row, '-'));
            }
            from = next;
        }
        if let (true, Some(start), Some(end)) = (line.shapes.is_empty(), line.start, line.end) {
            self.meet(start, row);
            let (low, high) = (self.column(start).min(self.column(end)), self.column(start).max(self.column(end)));
            (low + 1..high).for_each(|x| canvas.fill(x, row, '-'));
        }
        if let Some(end) = line.end {
            let after = line.shapes.last().map_or(0, |last| self.columns[*last] + shapes[*last].width);
            if self.column(end) < after {
                // It leads back to the left.
                return canvas.write(after, row, &format!("---> {}", net_name(graph, end)));
            }
            self.meet(end, row);
            if self.nets.get(&end).is_some_and(|net| net.named) {
                canvas.write(self.column(end) + 1, row, &format!(" {}", net_name(graph, end)));
            }
        }
    }

    /// The net between the shapes `place` and `place + 1` of a line: the one that the second begins with.
    fn between(&self, line: &Line, place: usize) -> Option<NetId> {
        let next = line.shapes.get(place + 1)?;
        self.nets.iter().find(|(_, net)| net.flows.contains(next)).map(|(id, _)| *id)
    }

    /// The text before the first element of a line whose net no other line reaches.
    fn paint_lead(&self, graph: &Graph, id: NetId, row: usize, canvas: &mut Canvas) {
        let Some(net) = graph.nets.get(id.0 as usize) else { return };
        let column = self.column(id);
        if self.nets.get(&id).is_some_and(|net| net.rail) {
            return;
        }
        let text = match net.sources.as_slice() {
            [] => "<??.?>".to_string(),
            [Source::Operand { value, negated }] => format!("{}{}", if *negated { "NOT " } else { "" }, operand(value)),
            _ => return,
        };
        canvas.write(column.saturating_sub(text.chars().count()), row, &text);
    }

    /// Columns of nets: where lines meet, and the rail.
    fn paint_nets(&self, graph: &Graph, canvas: &mut Canvas) {
        let rails = || self.nets.values().filter(|net| net.rail);
        let rail_rows: Vec<usize> = rails().flat_map(|net| net.rows.iter().copied()).collect();
        if let (Some(first), Some(last)) = (rail_rows.iter().min(), rail_rows.iter().max()) {
            (first.saturating_sub(1)..=*last).for_each(|y| canvas.fill(0, y, '|'));
        }
        let mut ids: Vec<&NetId> = self.nets.keys().collect();
        ids.sort_unstable();
        for id in ids {
            let net = &self.nets[id];
            let column = self.column(*id);
            let (Some(first), Some(last)) = (net.rows.iter().min(), net.rows.iter().max()) else { continue };
            if net.rail {
                continue;
            }
            let single = first == last;
            for y in *first..=*last {
                if net.rows.contains(&y) {
                    let sign = if single && !net.named { '-' } else { '+' };
                    canvas.fill(column, y, sign);
                } else {
                    canvas.fill(column, y, '|');
                }
            }
            if net.named && canvas.get(column + 1, *first) == '-' {
                canvas.write(column + 1, first.saturating_sub(1), &net_name(graph, *id));
            }
        }
    }
}

/// Lines: an element continues the line of the one that feeds it first, if no other element did.
fn lines(graph: &Graph, chosen: &[usize], nets: &HashMap<NetId, NetPlan>, columns: &[usize]) -> Vec<Line> {
    let mut lines = Vec::new();
    let mut placed = vec![false; chosen.len()];
    let first_source = |id: NetId, element: usize| {
        let sources = graph.nets.get(id.0 as usize).map_or(&[][..], |net| &net.sources);
        let mut pins = sources.iter().filter_map(|source| match source {
            Source::Pin { element, .. } if chosen.binary_search(element).is_ok() => Some(*element),
            _ => None,
        });
        pins.next() == Some(element)
    };
    for (shape, at) in chosen.iter().enumerate() {
        if placed[shape] {
            continue;
        }
        let mut line = Line { start: flow_in(&graph.elements[*at]), ..Line::default() };
        let mut here = shape;
        loop {
            placed[here] = true;
            line.shapes.push(here);
            line.end = flow_out(&graph.elements[chosen[here]]);
            let Some(id) = line.end else { break };
            let follows = |next: &usize| !placed[*next] && columns[*next] > columns[here];
            let next = nets.get(&id).and_then(|net| net.flows.iter().copied().find(follows));
            match next {
                Some(next) if first_source(id, chosen[here]) => here = next,
                _ => break,
            }
        }
        lines.push(line);
    }
    let mut short: Vec<(NetId, NetId)> = Vec::new();
    for id in nets.keys() {
        for source in graph.nets.get(id.0 as usize).map_or(&[][..], |net| &net.sources) {
            match source {
                Source::Net(from) if nets.contains_key(from) => short.push((*from, *id)),
                _ => {}
            }
        }
    }
    short.sort_unstable();
    short.truncate(4);
    lines.extend(short.into_iter().map(|(from, to)| Line { start: Some(from), shapes: Vec::new(), end: Some(to) }));
    lines
}

/// Columns of nets and elements: each one is to the right of everything that feeds it.
struct Columns<'a> {
    graph: &'a Graph,
    chosen: &'a [usize],
    widths: &'a [usize],
    /// None: being computed; a loop does not count.
    known: HashMap<NetId, Option<usize>>,
}

impl Columns<'_> {
    fn element(&mut self, at: usize) -> usize {
        match flow_in(&self.graph.elements[at]) {
            Some(id) => self.net(id) + LEAD,
            None => LEAD,
        }
    }

    /// Recursion goes from net to element to net, and no deeper than the number of elements in the drawing.
    fn net(&mut self, id: NetId) -> usize {
        if let Some(known) = self.known.get(&id) {
            return known.unwrap_or(0);
        }
        self.known.insert(id, None);
        let sources = self.graph.nets.get(id.0 as usize).map_or(&[][..], |net| &net.sources);
        let mut column = 0;
        for source in sources {
            column = column.max(match source {
                Source::Rail => 0,
                Source::Operand { value, negated } => operand(value).chars().count() + if *negated { 5 } else { 1 },
                Source::Pin { element, .. } => match self.chosen.binary_search(element) {
                    Ok(shape) => self.element(*element) + self.widths[shape] + LEAD - 1,
                    Err(_) => 0,
                },
                Source::Net(from) if self.known.len() < 2 * self.chosen.len() => self.net(*from) + LEAD,
                Source::Net(_) => 0,
            });
        }
        if sources.is_empty() {
            column = 6;
        }
        self.known.insert(id, Some(column));
        column
    }
}
