//! Wires by name: their nets, and what feeds and uses them.

use std::collections::HashMap;

use plcc_diag::{Code, Diagnostic, Span};

use super::super::tree::Wire;
use super::Builder;
use plcc_syntax::distance;
use plcc_syntax::network::ast::{Language, NetId, Source};

/// The name of the net that is TRUE.
const RAIL: &str = "powerrail";

/// The nets that have names.
#[derive(Default)]
pub struct Nets {
    by_name: HashMap<String, usize>,
    wires: Vec<Known>,
}

struct Known {
    net: NetId,
    /// What feeds it in the middle of a rung.
    inline: Vec<Source>,
    /// What feeds it at the end of a rung.
    ends: Vec<Source>,
    /// Where it is fed, including a second place.
    fed: Vec<Span>,
    used: Option<Span>,
    /// Rungs that end in it and do nothing else.
    idle: Vec<Span>,
}

/// Where a wire is fed.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Place {
    Inline,
    End,
}

impl Nets {
    /// What feeds a net in the middle of a rung.
    pub fn add_source(&mut self, net: NetId, source: Source) {
        if let Some(known) = self.wires.iter_mut().find(|known| known.net == net) {
            known.inline.push(source);
        }
    }

    /// The flow continues after the wire.
    pub fn note_inline_use(&mut self, net: NetId) {
        if let Some(known) = self.wires.iter_mut().find(|known| known.net == net)
            && known.used.is_none()
        {
            known.used = known.fed.first().copied();
        }
    }
}

/// The wire whose name resembles `name`. Names such as `w1` and `w2` always do.
fn near<'n>(name: &str, names: &'n [String]) -> Option<&'n String> {
    const SHORT: usize = 4;
    let near = distance::nearest(name, names.iter().map(String::as_str)).filter(|_| name.len() > SHORT)?;
    names.iter().find(|known| *known == near)
}

impl Builder<'_, '_> {
    /// The net of a wire that something uses.
    pub(super) fn consumed(&mut self, wire: Wire) -> NetId {
        let index = self.known(wire);
        let known = &mut self.nets.wires[index];
        known.used.get_or_insert(wire.span);
        known.net
    }

    /// The net of a wire that `source` feeds; without one the mistake has been reported.
    pub(super) fn fed(&mut self, wire: Wire, source: Option<Source>, place: Place, effect: bool) -> Option<NetId> {
        if wire.name.eq_ignore_ascii_case(RAIL) {
            self.report(
                Diagnostic::new(Code::ElementPlace, wire.span, "a rung cannot end in the power rail")
                    .label("the power rail is always TRUE")
                    .help("end the rung in its own wire, `wire#w1`, or in a coil"),
            );
            return None;
        }
        let index = self.known(wire);
        let net = self.nets.wires[index].net;
        if let Some(source) = &source {
            self.connect(source, net);
        }
        let known = &mut self.nets.wires[index];
        known.fed.push(wire.span);
        if !effect && place == Place::End {
            known.idle.push(wire.span);
        }
        match place {
            Place::Inline => known.inline.extend(source),
            Place::End => known.ends.extend(source),
        }
        Some(net)
    }

    fn known(&mut self, wire: Wire) -> usize {
        let name = wire.name.to_lowercase();
        if let Some(index) = self.nets.by_name.get(&name) {
            return *index;
        }
        let net = self.graph.add_net(wire.name, wire.span);
        let mut known =
            Known { net, inline: Vec::new(), ends: Vec::new(), fed: Vec::new(), used: None, idle: Vec::new() };
        if name == RAIL {
            known.inline.push(Source::Rail);
            known.fed.push(wire.span);
            known.used = Some(wire.span);
        }
        self.nets.wires.push(known);
        self.nets.by_name.insert(name, self.nets.wires.len() - 1);
        self.nets.wires.len() - 1
    }

    /// Gives the nets their sources, and reports wires without a source or without a use.
    pub(super) fn finish_nets(&mut self) {
        let wires = std::mem::take(&mut self.nets.wires);
        let names: Vec<String> = wires
            .iter()
            .filter(|known| !known.fed.is_empty())
            .map(|known| self.graph.net(known.net).name.clone())
            .chain([RAIL.to_owned()])
            .collect();
        let only_unused = self.renamed_wire(&wires);
        let unjoined = self.unjoined_wire(&wires);
        for known in wires {
            let name = self.graph.net(known.net).name.clone();
            if let Some((unfed, unused, idle, meant)) = &only_unused
                && [*unfed, *unused].contains(&known.net)
            {
                if let Some(used) = known.used {
                    self.report(
                        Diagnostic::new(Code::NoSource, used, format!("nothing feeds `wire#{name}`"))
                            .label("used here")
                            .also(*idle, format!("`wire#{meant}` ends here, and nothing uses it"))
                            .help(format!("is `wire#{meant}` meant?")),
                    );
                }
                self.keep_sources(known);
                continue;
            }
            if let (Some(used), []) = (known.used, known.fed.as_slice()) {
                self.report(
                    Diagnostic::new(Code::NoSource, used, format!("nothing feeds `wire#{name}`"))
                        .label("used here")
                        .help(match (near(&name, &names), self.language) {
                            (Some(near), _) => format!("is `wire#{near}` meant?"),
                            (None, Language::Lad) => {
                                "end a rung in this wire, or let the rung begin at `wire#powerrail`".to_owned()
                            }
                            (None, _) => "end a rung in this wire, or write the operand at the pin".to_owned(),
                        }),
                );
            }
            if known.used.is_none() {
                for idle in &known.idle {
                    self.report(
                        Diagnostic::new(Code::OpenBranch, *idle, format!("nothing uses `wire#{name}`"))
                            .label("the rung is connected to nothing")
                            .help(match &unjoined {
                                Some(other) => format!("is `wire#{other}` meant? Otherwise end the rung with a coil"),
                                None => "connect the wire to an element, or end the rung with a coil".to_owned(),
                            }),
                    );
                }
            }
            if let (Language::Fbd, [first, second, ..]) = (self.language, known.fed.as_slice())
                && !name.eq_ignore_ascii_case(RAIL)
            {
                self.report(
                    Diagnostic::new(Code::Tolerated, *second, format!("two rungs feed `wire#{name}`"))
                        .label("read as OR")
                        .also(*first, "fed here first")
                        .help("FBD joins branches with `O( in2 := … )`"),
                );
            }
            self.keep_sources(known);
        }
    }

    fn keep_sources(&mut self, known: Known) {
        let sources = &mut self.graph.nets[known.net.0 as usize].sources;
        sources.extend(known.inline);
        sources.extend(known.ends);
    }

    /// The name of the only wire in the middle of a rung that no other rung ends in or begins at: a branch may be meant to join there.
    fn unjoined_wire(&self, wires: &[Known]) -> Option<String> {
        let is_alone = |known: &&Known| {
            known.inline.len() == 1
                && known.ends.is_empty()
                && known.used.is_some()
                && known.used == known.fed.first().copied()
                && known.inline[0] != Source::Rail
        };
        let mut found = wires.iter().filter(is_alone);
        let known = found.next().filter(|_| found.next().is_none())?;
        Some(self.graph.net(known.net).name.clone())
    }

    /// The only wire without a source, the only one without a use, where that ends, and its name: most likely they are one wire.
    fn renamed_wire(&self, wires: &[Known]) -> Option<(NetId, NetId, Span, String)> {
        let only = |is: fn(&Known) -> bool| {
            let mut found = wires.iter().filter(|known| is(known));
            found.next().filter(|_| found.next().is_none())
        };
        let unfed = only(|known| known.used.is_some() && known.fed.is_empty())?;
        let unused = only(|known| known.used.is_none() && !known.idle.is_empty())?;
        let name = self.graph.net(unused.net).name.clone();
        Some((unfed.net, unused.net, *unused.idle.first()?, name))
    }
}
