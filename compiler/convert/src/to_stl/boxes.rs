//! Boxes with EN and ENO: arithmetic, moves, conversions. Source: LAD/FBD reference F.1.

use plcc_syntax::Elementary;
use plcc_syntax::ast::{self, Operand, OperandKind};
use plcc_syntax::literal::Literal;
use plcc_syntax::network::ast::{Element, Eno, Graph, PinValue, TemplateKey};
use plcc_syntax::network::elements::{EnoRule, Kind, Row};
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::logic::Logic;
use super::plan::Plan;
use super::types::elementary;
use super::values::width_type;

/// What a box does between its loads and its transfer.
struct Work {
    /// Inputs in the order of loading, with the type that each is loaded as.
    loads: Vec<(String, Elementary)>,
    insns: Vec<(StlInsn, Option<Operand>)>,
    result: Elementary,
    output: &'static str,
    /// Whether OV says that the result is wrong.
    checked: bool,
}

/// How ENO finds out whether a box went wrong.
pub enum Check {
    Never,
    /// OV says so.
    Overflow,
    /// This bit says so.
    Bit(Operand),
    /// The BR, which the box leaves, is ENO.
    Br,
}

impl Maker<'_> {
    /// A box of the table.
    pub fn arithmetic_box(&mut self, graph: &Graph, plan: &Plan, at: usize, row: &'static Row) {
        let element = &graph.elements[at];
        if row.kind == Kind::Move {
            return self.move_box(graph, plan, at);
        }
        if let Kind::Step { up } = row.kind {
            return self.step_box(graph, plan, at, up);
        }
        if row.kind == Kind::Demux {
            return self.demux_box(graph, plan, at);
        }
        if let Kind::Function(name @ ("SHL" | "SHR" | "ROL" | "ROR")) = row.kind {
            return self.shift_box(graph, plan, at, name);
        }
        let told = self.messages.len();
        let Some(work) = self.work(element, row) else {
            if matches!(row.kind, Kind::Operator(_) | Kind::Negate | Kind::Invert | Kind::Calculate) {
                let refused = self.messages.split_off(told);
                if !self.formula_box(graph, plan, at, row.kind) && self.messages.len() == told {
                    self.messages.extend(refused);
                }
            } else if let Some(called) = self.instruction(element, row) {
                self.messages.truncate(told);
                self.instruction_box(graph, plan, at, row, &called);
            } else if let Kind::Function(name) = row.kind {
                let refused = self.messages.split_off(told);
                if !self.choice_box(graph, plan, at, name) && self.messages.len() == told {
                    self.messages.extend(refused);
                }
            }
            return;
        };
        let mut loads = Vec::new();
        for (name, ty) in &work.loads {
            match self.load(graph, at, name, *ty) {
                Some(load) => loads.extend(load),
                None => return,
            }
        }
        let checked = work.checked && row.eno != Some(EnoRule::Never);
        let check = if checked { Check::Overflow } else { Check::Never };
        self.boxed(graph, plan, at, check, |maker| {
            for (insn, operand) in loads.into_iter().chain(work.insns) {
                maker.push(insn, operand);
            }
            maker.store_pin(graph, plan, at, work.output, work.result);
        });
    }

    /// INC, DEC.
    fn step_box(&mut self, graph: &Graph, plan: &Plan, at: usize, up: bool) {
        let element = &graph.elements[at];
        let set = element.template(TemplateKey::Destination).and_then(|template| elementary(&template.value));
        let Some(ty) = set.or_else(|| self.box_type(element, &["operand"])) else { return };
        let Some(operand) = self.pin_operand(element, "operand") else { return };
        let known = self.types.of(&operand.kind, self.block).or_else(|| width_type(&operand.kind));
        if known.is_some_and(|known| known.bits() != ty.bits()) {
            return self.refuse(
                element.span,
                format!("a step of {} on an operand of another size", ty.name()),
                "use one type",
            );
        }
        if !self.step_of(graph, plan, at, (operand, ty), up) {
            self.refuse(element.span, format!("a step of {}", ty.name()), "count in an integer of up to 32 bits");
        }
    }

    /// What an element does with its inputs, by type.
    fn work(&mut self, element: &Element, row: &Row) -> Option<Work> {
        use Elementary::{Dint, Dword, Int, Real, Word};
        use StlInsn as I;
        let two = |ty: Elementary, insn: I, checked: bool| Work {
            loads: vec![("in1".to_string(), ty), ("in2".to_string(), ty)],
            insns: vec![(insn, None)],
            result: ty,
            output: "out",
            checked,
        };
        let one = |from: Elementary, insns: &[I], to: Elementary, checked: bool| Work {
            loads: vec![("in".to_string(), from)],
            insns: insns.iter().map(|insn| (*insn, None)).collect(),
            result: to,
            output: "out",
            checked,
        };
        let work = match row.kind {
            Kind::Operator(sign) => {
                let inputs = element.pins.iter().filter(|pin| !pin.output && pin.name.starts_with("in")).count();
                let ty = self.box_type(element, &["in1", "in2", "out"])?;
                let found = match (sign, ty) {
                    ("+", Int) => Some(I::AddI),
                    ("-", Int) => Some(I::SubI),
                    ("*", Int) => Some(I::MulI),
                    ("/", Int) => Some(I::DivI),
                    ("+", Dint) => Some(I::AddD),
                    ("-", Dint) => Some(I::SubD),
                    ("*", Dint) => Some(I::MulD),
                    ("/", Dint) => Some(I::DivD),
                    ("MOD", Dint) => Some(I::ModD),
                    ("+", Real) => Some(I::AddR),
                    ("-", Real) => Some(I::SubR),
                    ("*", Real) => Some(I::MulR),
                    ("/", Real) => Some(I::DivR),
                    ("AND", Word) => Some(I::AndW),
                    ("OR", Word) => Some(I::OrW),
                    ("XOR", Word) => Some(I::XorW),
                    ("AND", Dword) => Some(I::AndD),
                    ("OR", Dword) => Some(I::OrD),
                    ("XOR", Dword) => Some(I::XorD),
                    _ => None,
                };
                match found {
                    Some(insn) if inputs == 2 => Some(two(ty, insn, !matches!(sign, "AND" | "OR" | "XOR"))),
                    _ => None,
                }
            }
            Kind::Negate => match self.box_type(element, &["in", "out"])? {
                Int => Some(one(Int, &[I::NegI], Int, true)),
                Dint => Some(one(Dint, &[I::NegD], Dint, true)),
                Real => Some(one(Real, &[I::NegR], Real, false)),
                _ => None,
            },
            Kind::Invert => match self.box_type(element, &["in", "out"])? {
                ty @ (Int | Word) => Some(one(ty, &[I::InvertI], ty, false)),
                ty @ (Dint | Dword) => Some(one(ty, &[I::InvertD], ty, false)),
                _ => None,
            },
            Kind::Convert => {
                let key = |key| element.template(key).map(|template| template.value.to_uppercase());
                let from = key(TemplateKey::Source).unwrap_or_default();
                let to = key(TemplateKey::Destination).unwrap_or_default();
                let same = elementary(&from).filter(|ty| from == to && (8..=32).contains(&ty.bits()));
                match (from.as_str(), to.as_str()) {
                    _ if let Some(ty) = same => Some(one(ty, &[], ty, false)),
                    ("INT", "DINT") => Some(one(Int, &[I::IToD], Dint, false)),
                    ("DINT", "REAL") => Some(one(Dint, &[I::DToR], Real, false)),
                    ("INT", "REAL") => Some(one(Int, &[I::IToD, I::DToR], Real, false)),
                    ("INT", "BCD16") => Some(one(Int, &[I::IToBcd], Word, true)),
                    ("BCD16", "INT") => Some(one(Word, &[I::BcdToI], Int, false)),
                    ("DINT", "BCD32") => Some(one(Dint, &[I::DToBcd], Dword, true)),
                    ("BCD32", "DINT") => Some(one(Dword, &[I::BcdToD], Dint, false)),
                    _ => None,
                }
            }
            // Out of range, RND leaves another number than the box of an S7-1500.
            Kind::Round(_) if self.types.is_portal => None,
            Kind::Round(name) => {
                let from =
                    element.template(TemplateKey::Source).map_or(Real, |one| elementary(&one.value).unwrap_or(Real));
                let to = element.template(TemplateKey::Destination).and_then(|one| elementary(&one.value));
                let insn = match name {
                    "ROUND" => I::Round,
                    "TRUNC" => I::Truncate,
                    "CEIL" => I::RoundUp,
                    _ => I::RoundDown,
                };
                (from == Real && to.unwrap_or(Dint) == Dint).then(|| one(Real, &[insn], Dint, true))
            }
            Kind::Function(name) => {
                let simple = match name {
                    "ABS" => Some((I::AbsR, false)),
                    "SQR" => Some((I::SqrR, true)),
                    "SQRT" => Some((I::SqrtR, true)),
                    "LN" => Some((I::LnR, true)),
                    "EXP" => Some((I::ExpR, true)),
                    "SIN" => Some((I::SinR, true)),
                    "COS" => Some((I::CosR, true)),
                    "TAN" => Some((I::TanR, true)),
                    "ASIN" => Some((I::AsinR, true)),
                    "ACOS" => Some((I::AcosR, true)),
                    "ATAN" => Some((I::AtanR, true)),
                    _ => None,
                };
                match simple {
                    Some((insn, checked)) if self.box_type(element, &["in", "out"])? == Real => {
                        Some(one(Real, &[insn], Real, checked))
                    }
                    Some(_) | None => None,
                }
            }
            _ => None,
        };
        if work.is_none() {
            let ty = element.template(TemplateKey::Source).map_or(String::new(), |one| format!(" of {}", one.value));
            let what = format!("the box `{}`{ty}", row.name);
            self.refuse(
                element.span,
                what,
                "leave the block in its language, or write the network with other elements",
            );
        }
        work
    }

    /// Whether anything needs the ENO of a box: an output, or the BR that it leaves.
    pub fn saves_eno(&self, graph: &Graph, plan: &Plan, at: usize) -> bool {
        let generated = graph.elements[at].eno != Eno::Disabled;
        generated && (self.keeps_br || self.is_wanted(graph, plan, at, "eno"))
    }

    /// Runs the statements of a box under EN, and takes its ENO.
    pub fn boxed(&mut self, graph: &Graph, plan: &Plan, at: usize, check: Check, body: impl FnOnce(&mut Self)) {
        let enable = self.input(graph, plan, at, "en");
        let wanted = self.is_wanted(graph, plan, at, "eno");
        let generated = graph.elements[at].eno != Eno::Disabled;
        let saves = wanted || (self.keeps_br && generated);
        let has_call = matches!(check, Check::Br);
        let leaves_br = generated && has_call;
        let failed = match check {
            _ if !generated => None,
            Check::Never | Check::Br => None,
            Check::Overflow => Some(Operand { kind: OperandKind::Status(ast::StatusOperand::Ov), span: self.span }),
            Check::Bit(bit) => Some(bit),
        };
        let changes_br = failed.is_some() || has_call;
        let eno = |maker: &mut Self| {
            match failed {
                _ if leaves_br => return,
                Some(failed) => maker.push(StlInsn::AndNot, Some(failed)),
                None => maker.push(StlInsn::SetRlo, None),
            }
            maker.push(StlInsn::Save, None);
            maker.push(StlInsn::ClearRlo, None);
            maker.sets_br = true;
        };
        match enable {
            Logic::Constant(true) => {
                body(self);
                if saves {
                    eno(self);
                }
            }
            enable if !saves => {
                let jump = self.under(&enable, body);
                return self.clear_wires(graph, plan, at, jump);
            }
            enable => {
                let label = self.new_label();
                self.evaluate(&enable);
                let jump = self.jump(StlInsn::JumpIfNotBr, &label);
                self.sets_br = true;
                body(self);
                self.clear_wires(graph, plan, at, Some(jump));
                // Otherwise JNB has set BR, which the body leaves.
                if changes_br {
                    eno(self);
                }
                self.label(&label);
            }
        }
        self.take_eno(graph, plan, at, wanted);
    }

    /// A box that does not run leaves 0 at its wires. `jump`: the place of the statement that skips it.
    pub fn clear_wires(&mut self, graph: &Graph, plan: &Plan, at: usize, jump: Option<usize>) {
        let Some(jump) = jump else { return };
        let mut before = Vec::new();
        for pin in graph.elements[at].pins.iter().filter(|pin| pin.output) {
            let PinValue::Net(net) = pin.value else { continue };
            let Some((operand, ty)) = self.typed.get(&net).cloned() else { continue };
            if plan.is_guarded(graph, net, at) {
                continue;
            }
            let zero = match ty {
                Elementary::Real => Literal::Real(0.0),
                ty if ty.bits() == 32 => Literal::Dint(0),
                ty if ty.bits() < 32 => Literal::Int(0),
                _ => {
                    let what = format!("a wire with a value of {} that a box with EN feeds", ty.name());
                    return self.refuse(pin.span, what, "put a variable between");
                }
            };
            let zero = Operand { kind: OperandKind::Literal(zero), span: self.span };
            // Neither of them changes the RLO.
            before.push((StlInsn::Load, zero));
            before.push((StlInsn::Transfer, operand));
        }
        self.insert(jump, before);
    }

    /// ENO is BR.
    pub fn take_eno(&mut self, graph: &Graph, plan: &Plan, at: usize, wanted: bool) {
        if wanted {
            let br = OperandKind::Status(ast::StatusOperand::Br);
            self.push(StlInsn::And, Some(Operand { kind: br, span: self.span }));
            self.result(graph, plan, at, "eno");
        }
    }
}
