//! Rungs of a network: the elements in their order, and the nets that other nets and operands feed.

use plcc_syntax::network::ast::{Graph, Language, NetId, PinValue, Source};

use super::elements::{flow_pin, is_not, out_pin};
use super::wires::{Wires, crossed};
use super::written;
use crate::writer::Writer;

impl Writer<'_> {
    /// The rungs of a network in LAD or FBD.
    pub(super) fn rungs(&mut self, graph: &Graph, language: Language) {
        let wires = Wires::new(graph);
        let crossed = crossed(graph);
        let mut rung: Option<Rung> = None;
        for (at, element) in graph.elements.iter().enumerate() {
            let flow = flow_pin(element).map(|pin| (&pin.value, pin.negated));
            let joined = match (&rung, flow) {
                (Some(rung), Some((PinValue::Net(net), _))) => {
                    rung.out == Some(*net) && wires.is_first(graph, *net, at.wrapping_sub(1))
                }
                _ => false,
            };
            if !joined {
                if let Some(rung) = rung.take() {
                    self.end(rung, &wires);
                }
                rung = Some(Rung { text: String::from("RUNG"), out: None, fed: true });
            }
            let mut current = rung.take().unwrap_or(Rung { text: String::from("RUNG"), out: None, fed: true });
            let text = self.flow_text((graph, &wires), flow.map(|(value, _)| value), joined, language);
            current.text.push_str(&text);
            let is_negated = flow.is_some_and(|(_, negated)| negated);
            // `{ … } NOT #t.TON( … )`
            let is_inner = is_negated
                && language == Language::Fbd
                && self.source.is_some_and(|source| written::is_negated(source, element.span.start));
            if is_negated && !is_inner {
                current.text.push_str(if language == Language::Lad { " Not()" } else { " NOT" });
            }
            if is_not(element) && language == Language::Fbd {
                current.text.push_str(" NOT");
            } else {
                let text = self.sd_element(graph, &wires, at, language, is_inner);
                current.text.push_str(&format!("  {text}"));
            }
            current.out = out_pin(element).and_then(|(_, pin)| match pin.value {
                PinValue::Net(net) => Some(net),
                PinValue::Operand(_) | PinValue::Open => None,
            });
            current.fed = current.out.is_none();
            self.remarks_of_element(graph, at, (joined, crossed[at]), language);
            rung = Some(current);
        }
        if let Some(rung) = rung.take() {
            self.end(rung, &wires);
        }
        self.fed_nets(graph, &wires);
    }

    /// What comes before an element in its rung: a wire, an operand, or the power rail. `joined`: the element before feeds it.
    fn flow_text(
        &mut self,
        (graph, wires): (&Graph, &Wires),
        flow: Option<&PinValue>,
        joined: bool,
        language: Language,
    ) -> String {
        match flow {
            Some(PinValue::Net(net)) if joined && wires.is_only(graph, *net) => String::new(),
            Some(PinValue::Net(net)) => format!(" wire#{}", wires.name(*net)),
            Some(PinValue::Operand(value)) => {
                let text = self.sd_operand(value);
                let passes_on = |source: &str| written::passes_on(source, value.span.end);
                let is_passed_on = language == Language::Fbd && self.source.is_some_and(passes_on);
                format!(" {text}{}", if is_passed_on { "  A()" } else { "" })
            }
            Some(PinValue::Open) | None if language == Language::Lad => " wire#powerrail".to_string(),
            Some(PinValue::Open) | None => String::new(),
        }
    }

    /// The comments and assertions at an element. `joined`: it is in the rung of the one before; `is_crossed`: a wire passes it.
    fn remarks_of_element(&mut self, graph: &Graph, at: usize, (joined, is_crossed): (bool, bool), language: Language) {
        if let Some(last) = at.checked_sub(1).filter(|_| !joined) {
            let remarks = self.trivia.on_line(graph.elements[last].span.end);
            self.new_remarks(remarks);
        }
        let span = graph.elements[at].span;
        let mut remarks = self.trivia.before(span.start);
        remarks.retain(|remark| !self.is_written(&remark.text));
        // The last line is that of another rung.
        remarks.iter_mut().for_each(|remark| remark.own_line = true);
        let asserts = remarks.iter().any(|remark| remark.text.starts_with("//@"));
        if asserts && at > 0 && !joined && !is_crossed {
            // An assertion stands between networks.
            self.out.dedent();
            self.out.line("END_NETWORK");
            self.out.remarks(&remarks);
            let name = if language == Language::Lad { "LAD" } else { "FBD" };
            self.out.line(format!("{{ S7_Language := \"{name}\" }}"));
            self.out.line("NETWORK");
            self.out.indent();
        } else {
            if asserts {
                let title =
                    "an assertion before this element stands inside its network, where `plcc test` does not read it";
                self.warn(span, title, "move it after the network, or end the logic before it with SET");
            }
            self.out.remarks(&remarks);
        }
    }

    /// Rungs without elements, for nets that operands or other nets feed.
    fn fed_nets(&mut self, graph: &Graph, wires: &Wires) {
        for (at, net) in graph.nets.iter().enumerate() {
            for source in &net.sources {
                let name = wires.name(NetId(at as u32));
                match source {
                    Source::Operand { value, negated } => {
                        let text = self.sd_operand(value);
                        let not = if *negated { " NOT" } else { "" };
                        self.out.line(format!("RUNG {text}{not}  A()  END_RUNG wire#{name}"));
                    }
                    Source::Net(other) => {
                        let text = wires.name(*other).to_string();
                        self.out.line(format!("RUNG wire#{text}  END_RUNG wire#{name}"));
                    }
                    Source::Rail if net.sources.len() > 1 => {
                        self.out.line(format!("RUNG wire#powerrail  END_RUNG wire#{name}"));
                    }
                    Source::Rail | Source::Pin { .. } => {}
                }
            }
        }
    }

    fn end(&mut self, rung: Rung, wires: &Wires) {
        match rung.out.filter(|_| !rung.fed) {
            Some(net) => self.out.line(format!("{}  END_RUNG wire#{}", rung.text, wires.name(net))),
            None => self.out.line(format!("{}  END_RUNG", rung.text)),
        }
    }
}

/// A rung that is not finished.
struct Rung {
    text: String,
    /// The net that its last element feeds.
    out: Option<NetId>,
    /// Nothing is to be connected at its end.
    fed: bool,
}
