//! Jumps to one of several labels. Source: LAD/FBD reference C.12.

use plcc_syntax::network::ast::{Comparison, Graph, PinValue};
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::plan::Plan;

impl Maker<'_> {
    /// JMP_LIST: to the label with number K; other numbers go on.
    pub fn jump_list(&mut self, graph: &Graph, plan: &Plan, at: usize) {
        let element = &graph.elements[at];
        let flow = self.input(graph, plan, at, "en");
        let Some(ty) = self.type_or_width(element, &["k"]) else { return };
        let mut jumps = Vec::new();
        for pin in element.pins.iter().filter(|pin| pin.value != PinValue::Open) {
            let Some(number) = pin.name.strip_prefix("dest").and_then(|digits| digits.parse().ok()) else { continue };
            let Some(label) = self.jump_label(element, &pin.name) else { return };
            let Some(is_it) = self.equals_number(graph, at, "k", ty, number) else { return };
            jumps.push((is_it, label));
        }
        self.under(&flow, |maker| {
            for (is_it, label) in &jumps {
                maker.evaluate(is_it);
                maker.jump(StlInsn::JumpIf, label);
            }
        });
    }

    /// SWITCH: to the label of the first comparison that is true.
    pub fn switch(&mut self, graph: &Graph, plan: &Plan, at: usize) {
        let element = &graph.elements[at];
        let flow = self.input(graph, plan, at, "en");
        let names: Vec<String> = (0..element.cases.len()).map(|number| format!("case{number}")).collect();
        let inputs: Vec<&str> = std::iter::once("k").chain(names.iter().map(String::as_str)).collect();
        let Some(ty) = self.type_or_width(element, &inputs) else { return };
        let mut jumps = Vec::new();
        for (number, (comparison, case)) in element.cases.iter().zip(&names).enumerate() {
            let target = format!("dest{number}");
            if !self.is_connected(graph, at, &target) {
                continue;
            }
            let Some(label) = self.jump_label(element, &target) else { return };
            let Some(is_it) = self.compared(graph, at, ["k", case.as_str()], sign(*comparison), ty) else { return };
            jumps.push((is_it, label));
        }
        let otherwise = match self.is_connected(graph, at, "else") {
            true => match self.jump_label(element, "else") {
                Some(label) => Some(label),
                None => return,
            },
            false => None,
        };
        self.under(&flow, |maker| {
            for (is_it, label) in &jumps {
                maker.evaluate(is_it);
                maker.jump(StlInsn::JumpIf, label);
            }
            if let Some(label) = &otherwise {
                maker.jump(StlInsn::Jump, label);
            }
        });
    }
}

const fn sign(comparison: Comparison) -> &'static str {
    match comparison {
        Comparison::Equal => "=",
        Comparison::NotEqual => "<>",
        Comparison::Less => "<",
        Comparison::LessEqual => "<=",
        Comparison::Greater => ">",
        Comparison::GreaterEqual => ">=",
    }
}
