//! SEL, MIN, MAX and LIMIT for an S7-300, whose STL has no instructions with these names, and DEMUX. Source: LAD/FBD reference C.8, C.13.

use plcc_syntax::Elementary;
use plcc_syntax::ast::Operand;
use plcc_syntax::network::ast::{Graph, PinValue};
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::boxes::Check;
use super::logic::Logic;
use super::plan::Plan;
use super::values::width_of;

type Load = Vec<(StlInsn, Option<Operand>)>;

impl Maker<'_> {
    /// A box that chooses one of its inputs; false: STL has no statements for it, or a message says what is wrong.
    pub fn choice_box(&mut self, graph: &Graph, plan: &Plan, at: usize, name: &str) -> bool {
        match name {
            "SEL" => self.select(graph, plan, at),
            "MIN" => self.extreme(graph, plan, at, true),
            "MAX" => self.extreme(graph, plan, at, false),
            "LIMIT" => self.limit(graph, plan, at),
            _ => None,
        }
        .is_some()
    }

    /// SEL: IN1 if G is 1, otherwise IN0.
    fn select(&mut self, graph: &Graph, plan: &Plan, at: usize) -> Option<()> {
        let ty = self.box_type(&graph.elements[at], &["in0", "in1", "out"])?;
        if !(8..=32).contains(&ty.bits()) {
            return None;
        }
        let chosen = self.input(graph, plan, at, "g");
        let (no, yes) = (self.load(graph, at, "in0", ty)?, self.load(graph, at, "in1", ty)?);
        self.boxed(graph, plan, at, Check::Never, |maker| {
            let (otherwise, end) = (maker.new_label(), maker.new_label());
            maker.evaluate(&chosen);
            maker.jump(StlInsn::JumpIfNot, &otherwise);
            maker.push_loads(yes);
            maker.jump(StlInsn::Jump, &end);
            maker.label(&otherwise);
            maker.push_loads(no);
            maker.label(&end);
            maker.store_pin(graph, plan, at, "out", ty);
        });
        Some(())
    }

    /// MIN, MAX of integers.
    fn extreme(&mut self, graph: &Graph, plan: &Plan, at: usize, least: bool) -> Option<()> {
        let element = &graph.elements[at];
        let inputs = element.pins.iter().filter(|pin| !pin.output && pin.value != PinValue::Open && pin.name != "en");
        let names: Vec<String> = inputs.map(|pin| pin.name.clone()).collect();
        let all: Vec<&str> = names.iter().map(String::as_str).chain(["out"]).collect();
        let ty = self.box_type(element, &all)?;
        let [less, greater] = comparisons(ty)?;
        let mut loads = Vec::new();
        for name in &names {
            loads.push(self.load(graph, at, name, ty)?);
        }
        let better = if least { less } else { greater };
        self.boxed(graph, plan, at, Check::Never, |maker| {
            for (number, load) in loads.into_iter().enumerate() {
                maker.push_loads(load);
                if number > 0 {
                    // The one before is in ACCU2.
                    let label = maker.new_label();
                    maker.push(better, None);
                    maker.jump(StlInsn::JumpIfNot, &label);
                    maker.push(StlInsn::SwapAccu, None);
                    maker.label(&label);
                }
            }
            maker.store_pin(graph, plan, at, "out", ty);
        });
        Some(())
    }

    /// LIMIT of integers: with limits the wrong way round the value stays, and ENO is 0.
    fn limit(&mut self, graph: &Graph, plan: &Plan, at: usize) -> Option<()> {
        let ty = self.box_type(&graph.elements[at], &["mn", "in", "mx", "out"])?;
        let [less, greater] = comparisons(ty)?;
        let mut load = |name: &str| self.load(graph, at, name, ty);
        let (low, value, high) = (load("mn")?, load("in")?, load("mx")?);
        let bit = self.saves_eno(graph, plan, at).then(|| self.temporary(Elementary::Bool));
        let check = bit.clone().map_or(Check::Never, Check::Bit);
        self.boxed(graph, plan, at, check, |maker| {
            let end = maker.new_label();
            maker.push_loads(low.clone());
            maker.push_loads(high.clone());
            maker.push(greater, None);
            if let Some(bit) = bit {
                maker.push(StlInsn::Assign, Some(bit));
            }
            maker.push_loads(value);
            maker.jump(StlInsn::JumpIf, &end);
            for (limit, outside) in [(low, less), (high, greater)] {
                maker.push_loads(limit);
                maker.push(outside, None);
                maker.jump(StlInsn::JumpIf, &end);
                maker.push(StlInsn::SwapAccu, None);
            }
            maker.label(&end);
            maker.store_pin(graph, plan, at, "out", ty);
        });
        Some(())
    }

    /// DEMUX: IN to the output with number K, or to ELSE, with ENO 0.
    pub fn demux_box(&mut self, graph: &Graph, plan: &Plan, at: usize) {
        let element = &graph.elements[at];
        let Some(ty) = self.box_type(element, &["in", "out0"]) else { return };
        if !(8..=32).contains(&ty.bits()) {
            return self.refuse(
                element.span,
                format!("DEMUX of {}", ty.name()),
                "write the network with other elements",
            );
        }
        let number = element.pin("k").map(|pin| &pin.value);
        let of_number = number.and_then(|value| self.type_of(value).or_else(|| width_of(value)));
        let of_number = of_number.unwrap_or(Elementary::Dint);
        let Some(load) = self.load(graph, at, "in", ty) else { return };
        let mut ways: Vec<(Logic, String)> = Vec::new();
        let mut otherwise = None;
        for pin in element.pins.iter().filter(|pin| pin.output && pin.name != "eno") {
            match pin.value {
                PinValue::Operand(_) => {}
                PinValue::Net(net) if plan.is_used(net) => {
                    let help = "connect a variable: only one of the outputs has a value";
                    return self.refuse(pin.span, format!("a wire at the output `{}` of DEMUX", pin.name), help);
                }
                PinValue::Net(_) | PinValue::Open => {}
            }
            match pin.name.strip_prefix("out").and_then(|digits| digits.parse().ok()) {
                Some(place) => {
                    let Some(is_it) = self.equals_number(graph, at, "k", of_number, place) else { return };
                    ways.push((is_it, pin.name.clone()));
                }
                None => otherwise = Some(pin.name.clone()),
            }
        }
        let bit = self.saves_eno(graph, plan, at).then(|| self.temporary(Elementary::Bool));
        let check = bit.clone().map_or(Check::Never, Check::Bit);
        self.boxed(graph, plan, at, check, |maker| {
            let end = maker.new_label();
            let note = |maker: &mut Self, failed: bool| {
                if let Some(bit) = &bit {
                    maker.push(if failed { StlInsn::SetRlo } else { StlInsn::ClearRlo }, None);
                    maker.push(StlInsn::Assign, Some(bit.clone()));
                }
            };
            for (is_it, name) in &ways {
                let next = maker.new_label();
                maker.evaluate(is_it);
                maker.jump(StlInsn::JumpIfNot, &next);
                note(maker, false);
                maker.push_loads(load.clone());
                maker.store_pin(graph, plan, at, name, ty);
                maker.jump(StlInsn::Jump, &end);
                maker.label(&next);
            }
            note(maker, true);
            if let Some(name) = &otherwise {
                maker.push_loads(load);
                maker.store_pin(graph, plan, at, name, ty);
            }
            maker.label(&end);
        });
    }

    fn push_loads(&mut self, load: Load) {
        load.into_iter().for_each(|(insn, operand)| self.push(insn, operand));
    }
}

/// Whether ACCU2 is less, and whether it is greater.
fn comparisons(ty: Elementary) -> Option<[StlInsn; 2]> {
    match ty {
        Elementary::Int => Some([StlInsn::CompareLtI, StlInsn::CompareGtI]),
        Elementary::Dint | Elementary::Time => Some([StlInsn::CompareLtD, StlInsn::CompareGtD]),
        _ => None,
    }
}
