//! S5 timers and counters: their boxes, and their coils.

use plcc_syntax::Elementary;
use plcc_syntax::ast::Operand;
use plcc_syntax::network::ast::{Element, Graph};
use plcc_syntax::network::elements::CounterCoil;
use plcc_syntax::scl::ast::Expr;
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::plan::Plan;

impl Maker<'_> {
    /// A box or coil of an S5 timer.
    pub fn timer(&mut self, graph: &Graph, plan: &Plan, at: usize, name: &str, instance: Option<&Expr>) {
        let element = &graph.elements[at];
        let Some(cell) = self.cell(element, "timer", instance) else { return };
        let insn = match name {
            "S_PULSE" => StlInsn::TimerPulse,
            "S_PEXT" => StlInsn::TimerExtendedPulse,
            "S_ODT" => StlInsn::TimerOnDelay,
            "S_ODTS" => StlInsn::TimerRetentiveOnDelay,
            _ => StlInsn::TimerOffDelay,
        };
        if self.is_connected(graph, at, "s") {
            let flow = self.input(graph, plan, at, "s");
            let flow = self.passed(graph, plan, at, flow);
            self.evaluate(&flow);
            if self.is_connected(graph, at, "tv") {
                self.load_pin(graph, at, "tv", Elementary::S5Time);
            }
            self.push(insn, Some(cell.clone()));
        }
        if self.is_cell_box(graph, plan, at) {
            self.cell_end(graph, plan, at, cell, [("bi", StlInsn::Load), ("bcd", StlInsn::LoadBcd)]);
        }
    }

    /// A box of an S5 counter.
    pub fn counter(&mut self, graph: &Graph, plan: &Plan, at: usize, instance: Option<&Expr>) {
        let element = &graph.elements[at];
        let Some(cell) = self.cell(element, "counter", instance) else { return };
        for (name, insn) in [("cu", StlInsn::CountUp), ("cd", StlInsn::CountDown), ("s", StlInsn::Set)] {
            if self.is_connected(graph, at, name) {
                let flow = self.input(graph, plan, at, name);
                self.evaluate(&flow);
                if name == "s" && self.is_connected(graph, at, "pv") {
                    self.load_count(graph, at);
                }
                self.push(insn, Some(cell.clone()));
            }
        }
        self.cell_end(graph, plan, at, cell, [("cv", StlInsn::Load), ("cv_bcd", StlInsn::LoadBcd)]);
    }

    /// `CU`, `CD` or `SC`.
    pub fn counter_coil(&mut self, graph: &Graph, plan: &Plan, at: usize, coil: CounterCoil, instance: Option<&Expr>) {
        let Some(cell) = self.cell(&graph.elements[at], "counter", instance) else { return };
        let flow = self.input(graph, plan, at, "in");
        let flow = self.passed(graph, plan, at, flow);
        self.evaluate(&flow);
        let insn = match coil {
            CounterCoil::Up => StlInsn::CountUp,
            CounterCoil::Down => StlInsn::CountDown,
            CounterCoil::Set => {
                self.load_count(graph, at);
                StlInsn::Set
            }
        };
        self.push(insn, Some(cell));
    }

    /// The reset, the values and the output of a timer or a counter.
    fn cell_end(&mut self, graph: &Graph, plan: &Plan, at: usize, cell: Operand, pins: [(&str, StlInsn); 2]) {
        if self.is_connected(graph, at, "r") {
            let reset = self.input(graph, plan, at, "r");
            self.evaluate(&reset);
            self.push(StlInsn::Reset, Some(cell.clone()));
        } else {
            self.open_pin();
        }
        for (name, insn) in pins {
            if self.is_wanted(graph, plan, at, name) {
                self.push(insn, Some(cell.clone()));
                self.store_pin(graph, plan, at, name, Elementary::Word);
            } else {
                self.open_pin();
            }
        }
        if self.is_wanted(graph, plan, at, "q") {
            self.push(StlInsn::And, Some(cell));
            self.result(graph, plan, at, "q");
        } else {
            self.open_pin();
        }
    }

    /// The timer or counter of an element.
    fn cell(&mut self, element: &Element, pin: &str, instance: Option<&Expr>) -> Option<Operand> {
        match instance {
            Some(instance) => self.operand(instance),
            None => self.pin_operand(element, pin),
        }
    }

    /// Whether a timer is a box: a coil has no pins but its start and its time.
    fn is_cell_box(&self, graph: &Graph, plan: &Plan, at: usize) -> bool {
        let wanted = ["bi", "bcd", "cv", "cv_bcd", "q"].iter().any(|name| self.is_wanted(graph, plan, at, name));
        wanted || self.is_connected(graph, at, "r")
    }

    /// What stands in the place of a pin without connection, so that the statements can be drawn as the box again.
    pub fn open_pin(&mut self) {
        self.push(StlInsn::Nop, Some(super::number(0, self.span)));
    }
}
