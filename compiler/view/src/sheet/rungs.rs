//! From statements to rungs: nets that statements join, as the editors of STEP 7 and Micro/WIN do when their view is switched to LAD.

use super::{Label, Link, Look, Meaning, Net, Part, Pin, Place, Sheet, Source};

/// A result of logic: the parts between two nets. The first is joined with the rail, or with what is before it.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    pub start: usize,
    pub end: usize,
    /// It also leads elsewhere: nothing can be put beside it.
    pub shared: bool,
    /// It has an edge or an inversion of all that is before it: nothing but the rail can come before it.
    pub whole: bool,
}

impl Span {
    /// A span of nothing at a net.
    pub fn at(net: usize) -> Span {
        Span::between(net, net)
    }

    pub fn between(start: usize, end: usize) -> Span {
        Span { start, end, shared: false, whole: false }
    }
}

/// Builds a sheet; nets that are joined become one at the end.
#[derive(Default)]
pub struct Rungs {
    parts: Vec<Part>,
    /// The net that a net was joined with.
    same: Vec<usize>,
    rails: Vec<usize>,
    /// The first byte of the statement whose parts come next.
    pub statement: Option<u32>,
}

impl Rungs {
    pub fn net(&mut self) -> usize {
        self.same.push(self.same.len());
        self.same.len() - 1
    }

    fn root(&self, mut net: usize) -> usize {
        while self.same[net] != net {
            net = self.same[net];
        }
        net
    }

    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.same[a.max(b)] = a.min(b);
    }

    /// The span begins at the rail.
    pub fn rail(&mut self, span: Span) {
        self.rails.push(span.start);
    }

    pub fn part_count(&self) -> usize {
        self.parts.len()
    }

    /// Whether a part other than a coil or a box at its end reads the net of the span.
    pub fn is_used(&self, net: usize) -> bool {
        let net = self.root(net);
        self.parts.iter().any(|part| part.net(part.flow_in).is_some_and(|other| self.root(other) == net))
    }

    /// Adds a part whose flow goes between two nets.
    pub fn part(&mut self, look: Look, meaning: Meaning, mut pins: Vec<Pin>, from: Option<usize>, to: Option<usize>) {
        let named = matches!(look, Look::Box { .. });
        let mut flow = |output: bool, net: Option<usize>| {
            net.map(|net| {
                let name = match (named, output) {
                    (true, false) => "EN",
                    (true, true) => "ENO",
                    (false, _) => "",
                };
                pins.push(Pin {
                    name: name.to_string(),
                    place: Place::Side,
                    output,
                    link: Link::Net(net),
                    negated: false,
                });
                pins.len() - 1
            })
        };
        let (flow_in, flow_out) = (flow(false, from), flow(true, to));
        // The status of the bit of a statement is shown at the operand of its contact or coil.
        let is_contact = matches!(meaning, Meaning::Contact { .. });
        let tells_bit = is_contact || matches!(&look, Look::Coil { sign } if sign.is_empty());
        let operand = pins.iter_mut().find(|pin| pin.place == Place::Above).filter(|_| tells_bit);
        if let Some(Pin { link: Link::Operand(label), .. }) = operand {
            label.place = self.statement;
        }
        let place = self.statement.filter(|_| is_contact);
        self.parts.push(Part { look, meaning, pins, flow_in, flow_out, place, statement: self.statement });
    }

    /// A contact between two nets.
    pub fn contact(&mut self, sign: &str, operands: Vec<Label>, from: usize, to: usize) {
        let meaning = match sign {
            "" => Meaning::Contact { negated: false },
            "/" => Meaning::Contact { negated: true },
            "NOT" => Meaning::Not,
            _ => Meaning::Other,
        };
        self.part(Look::Contact { sign: sign.to_string() }, meaning, around(operands, false), Some(from), Some(to));
    }

    /// A new span of one contact.
    pub fn load(&mut self, sign: &str, operands: Vec<Label>) -> Span {
        let (start, end) = (self.net(), self.net());
        self.contact(sign, operands, start, end);
        Span::between(start, end)
    }

    /// A contact after a span.
    pub fn then(&mut self, span: Span, sign: &str, operands: Vec<Label>) -> Span {
        let end = self.net();
        self.contact(sign, operands, span.end, end);
        Span { end, shared: false, whole: span.whole || matches!(sign, "NOT" | "P" | "N"), ..span }
    }

    pub fn coil(&mut self, sign: &str, operands: Vec<Label>, from: usize) {
        self.part(Look::Coil { sign: sign.to_string() }, Meaning::Through, around(operands, true), Some(from), None);
    }

    /// Sets the last part's name of the flow input.
    pub fn name_input(&mut self, name: &str) {
        if let Some(part) = self.parts.last_mut()
            && let Some(pin) = part.flow_in
        {
            part.pins[pin].name = name.to_string();
        }
    }

    /// The output ENO of the last part, which a statement continues.
    pub fn eno(&mut self) -> Option<usize> {
        let net = self.net();
        let part = self.parts.last_mut()?;
        if part.flow_out.is_some() || !matches!(part.look, Look::Box { .. }) {
            return None;
        }
        part.flow_out = Some(part.pins.len());
        part.pins.push(Pin {
            name: "ENO".to_string(),
            place: Place::Side,
            output: true,
            link: Link::Net(net),
            negated: false,
        });
        Some(net)
    }

    pub fn sheet(self) -> Sheet {
        let mut sheet = Sheet::default();
        let roots: Vec<usize> = (0..self.same.len()).map(|net| self.root(net)).collect();
        sheet.nets = (0..self.same.len()).map(|at| Net { name: format!("n{at}"), ..Net::default() }).collect();
        for net in &self.rails {
            let net = &mut sheet.nets[roots[*net]];
            if net.sources.is_empty() {
                net.sources.push(Source::Rail);
            }
        }
        for (at, mut part) in self.parts.into_iter().enumerate() {
            for (index, pin) in part.pins.iter_mut().enumerate() {
                if let Link::Net(net) = &mut pin.link {
                    *net = roots[*net];
                    if pin.output {
                        sheet.nets[*net].sources.push(Source::Pin { part: at, pin: index });
                    }
                }
            }
            sheet.parts.push(part);
        }
        sheet
    }
}

/// Operands of a contact or a coil: the first above, the others below.
fn around(operands: Vec<Label>, output: bool) -> Vec<Pin> {
    let pin = |(index, label)| Pin {
        name: String::new(),
        place: if index == 0 { Place::Above } else { Place::Below },
        output: output && index == 0,
        link: Link::Operand(label),
        negated: false,
    };
    operands.into_iter().enumerate().map(pin).collect()
}

/// An operand at the side of a box.
pub fn side(name: &str, label: Label, output: bool) -> Pin {
    Pin { name: name.to_string(), place: Place::Side, output, link: Link::Operand(label), negated: false }
}
