//! Boxes that compute in several steps: operators with more than two inputs or with types of 8 and 16 bits, CALCULATE; INC and DEC.
//!
//! A step leaves its result in ACCU1. Integers of 8 bits and UINT are computed as DINT and cut to their type after each step, which
//! shows whether they fit. What went wrong in any step is kept in a bit for ENO. Source: LAD/FBD reference C.8.

use plcc_syntax::Elementary;
use plcc_syntax::ast::{Operand, OperandKind, StatusOperand};
use plcc_syntax::literal::Literal;
use plcc_syntax::network::ast::{Element, Graph, PinValue, TemplateKey};
use plcc_syntax::network::elements::Kind;
use plcc_syntax::scl::ast::{BinaryOp, Expr, ExprKind, UnaryOp};
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::boxes::Check;
use super::compare::wide;
use super::plan::Plan;
use super::types::elementary;

type Statements = Vec<(StlInsn, Option<Operand>)>;

/// A value that is computed.
enum Term {
    Load(Statements),
    Unary { of: Box<Term>, step: Step },
    Binary { left: Box<Term>, right: Box<Term>, step: Step },
}

/// One operation.
struct Step {
    insn: StlInsn,
    /// OV says that the result is wrong.
    checked: bool,
    /// Both values are INT, and become DINT first.
    widens: bool,
    /// The result is a DINT that must be cut to this type.
    cut: Option<Elementary>,
}

/// The bit that says whether a step went wrong.
struct Watch {
    bit: Operand,
    /// A step has set it.
    is_set: bool,
}

impl Term {
    /// Steps that may go wrong.
    fn checks(&self) -> usize {
        let own = |step: &Step| usize::from(step.checked || step.cut.is_some());
        match self {
            Term::Load(_) => 0,
            Term::Unary { of, step } => of.checks() + own(step),
            Term::Binary { left, right, step } => left.checks() + right.checks() + own(step),
        }
    }

    /// OV has the outcome of the last step, and no other went wrong.
    fn shows_in_ov(&self) -> bool {
        let last = match self {
            Term::Load(_) => None,
            Term::Unary { step, .. } | Term::Binary { step, .. } => Some(step),
        };
        self.checks() == 1 && last.is_some_and(|step| step.checked && step.cut.is_none())
    }
}

impl Maker<'_> {
    /// An operator, NEG, INV or CALCULATE; false: STL cannot compute it.
    pub fn formula_box(&mut self, graph: &Graph, plan: &Plan, at: usize, kind: Kind) -> bool {
        let element = &graph.elements[at];
        let Some(ty) = self.type_of_formula(element) else { return false };
        let term = match (kind, &element.equation) {
            (Kind::Operator(sign), _) => self.chain(graph, at, sign, ty),
            (Kind::Negate, _) => self.input_term(graph, at, "in", ty).and_then(|of| self.applied("NEG", of, ty)),
            (Kind::Invert, _) => self.input_term(graph, at, "in", ty).and_then(|of| self.applied("INV", of, ty)),
            (_, Some(equation)) => self.term_of(graph, at, equation, ty),
            (_, None) => None,
        };
        let Some(term) = term else { return false };
        self.computed(graph, plan, at, &term, ty, |maker| maker.store_pin(graph, plan, at, "out", ty));
        true
    }

    /// INC, DEC of an operand with a type; false: STL does not compute with it.
    pub fn step_of(
        &mut self,
        graph: &Graph,
        plan: &Plan,
        at: usize,
        (operand, ty): (Operand, Elementary),
        up: bool,
    ) -> bool {
        let Some(step) = self.step(if up { "+" } else { "-" }, ty).filter(|_| ty != Elementary::Real) else {
            return false;
        };
        let one = match ty {
            Elementary::Dint => Literal::Dint(1),
            _ => Literal::Int(1),
        };
        let one = Operand { kind: OperandKind::Literal(one), span: self.span };
        let [left, right] = [operand.clone(), one]
            .map(|operand| Box::new(Term::Load(self.loaded(vec![(StlInsn::Load, Some(operand))], ty))));
        let term = Term::Binary { left, right, step };
        self.computed(graph, plan, at, &term, ty, |maker| maker.push(StlInsn::Transfer, Some(operand)));
        true
    }

    /// A box that leaves the value of a term, which `store` takes.
    fn computed(
        &mut self,
        graph: &Graph,
        plan: &Plan,
        at: usize,
        term: &Term,
        ty: Elementary,
        store: impl FnOnce(&mut Self),
    ) {
        let watches = self.saves_eno(graph, plan, at) && term.checks() > 0;
        let mut watch =
            (watches && !term.shows_in_ov()).then(|| Watch { bit: self.temporary(Elementary::Bool), is_set: false });
        let check = match &watch {
            Some(watch) => Check::Bit(watch.bit.clone()),
            None if term.checks() > 0 => Check::Overflow,
            None => Check::Never,
        };
        self.boxed(graph, plan, at, check, |maker| {
            maker.term(term, ty, &mut watch);
            store(maker);
        });
    }

    /// The type that a box computes in: its setting, or that of its variables.
    fn type_of_formula(&self, element: &Element) -> Option<Elementary> {
        let keys = [TemplateKey::Source, TemplateKey::Value, TemplateKey::Destination];
        let set = keys.iter().find_map(|key| elementary(&element.template(*key)?.value));
        if set.is_some() {
            return set;
        }
        // With several types, the binder decides.
        let types = element.pins.iter().filter(|pin| pin.name != "en" && pin.name != "eno");
        let mut types = types.filter_map(|pin| self.type_of(&pin.value));
        let first = types.next()?;
        types.all(|ty| ty == first).then_some(first)
    }

    /// An operator between all inputs, from the first to the last.
    fn chain(&mut self, graph: &Graph, at: usize, sign: &str, ty: Elementary) -> Option<Term> {
        let element = &graph.elements[at];
        let inputs = element.pins.iter().filter(|pin| !pin.output && pin.value != PinValue::Open);
        let numbers = inputs.filter_map(|pin| pin.name.strip_prefix("in")?.parse().ok());
        let mut numbers: Vec<u32> = numbers.collect();
        numbers.sort_unstable();
        let mut inputs = numbers.into_iter().map(|number| format!("in{number}"));
        let mut term = self.input_term(graph, at, &inputs.next()?, ty)?;
        for name in inputs {
            let step = self.step(sign, ty)?;
            let right = Box::new(self.input_term(graph, at, &name, ty)?);
            term = Term::Binary { left: Box::new(term), right, step };
        }
        Some(term)
    }

    fn term_of(&mut self, graph: &Graph, at: usize, node: &Expr, ty: Elementary) -> Option<Term> {
        if crate::operand::constant(node).is_some() {
            let operand = self.value_of(node, ty)?;
            return Some(Term::Load(self.loaded(vec![(StlInsn::Load, Some(operand))], ty)));
        }
        match &node.kind {
            ExprKind::Name(name) => {
                let pin = graph.elements[at].pin(&name.text).filter(|pin| !pin.output && pin.name.starts_with("in"))?;
                self.input_term(graph, at, &pin.name, ty)
            }
            ExprKind::Unary { op: UnaryOp::Plus, operand } => self.term_of(graph, at, operand, ty),
            ExprKind::Unary { op: UnaryOp::Minus, operand } => self.function(graph, at, "NEG", operand, ty),
            ExprKind::Unary { op: UnaryOp::Not, operand } => self.function(graph, at, "INV", operand, ty),
            ExprKind::Binary { op, left, right, .. } => {
                let sign = match op {
                    BinaryOp::Add => "+",
                    BinaryOp::Subtract => "-",
                    BinaryOp::Multiply => "*",
                    BinaryOp::Divide => "/",
                    BinaryOp::Modulo => "MOD",
                    BinaryOp::And => "AND",
                    BinaryOp::Or => "OR",
                    BinaryOp::Xor => "XOR",
                    BinaryOp::Power
                    | BinaryOp::DivideInteger
                    | BinaryOp::Less
                    | BinaryOp::Greater
                    | BinaryOp::LessEqual
                    | BinaryOp::GreaterEqual
                    | BinaryOp::Equal
                    | BinaryOp::NotEqual => return None,
                };
                let left = Box::new(self.term_of(graph, at, left, ty)?);
                let right = Box::new(self.term_of(graph, at, right, ty)?);
                Some(Term::Binary { left, right, step: self.step(sign, ty)? })
            }
            ExprKind::Call { callee, arguments } => {
                let ExprKind::Name(name) = &callee.kind else { return None };
                let [argument] = &arguments[..] else { return None };
                self.function(graph, at, &name.text.to_uppercase(), argument.value.as_ref()?, ty)
            }
            _ => None,
        }
    }

    /// An input as a term; none after a message.
    fn input_term(&mut self, graph: &Graph, at: usize, name: &str, ty: Elementary) -> Option<Term> {
        let load = self.load(graph, at, name, ty)?;
        Some(Term::Load(self.loaded(load, ty)))
    }

    /// A load with what makes a DINT of an integer of another type.
    fn loaded(&self, mut load: Statements, ty: Elementary) -> Statements {
        if let (Elementary::Usint | Elementary::Uint, Some((_, Some(operand)))) = (ty, load.first_mut())
            && let OperandKind::Literal(literal) = &mut operand.kind
        {
            *literal = wide(literal, ty);
        }
        if ty == Elementary::Sint {
            load.extend(self.cut(ty));
        }
        load
    }

    /// A function of one value.
    fn function(&mut self, graph: &Graph, at: usize, name: &str, of: &Expr, ty: Elementary) -> Option<Term> {
        let of = self.term_of(graph, at, of, ty)?;
        self.applied(name, of, ty)
    }

    fn applied(&self, name: &str, of: Term, ty: Elementary) -> Option<Term> {
        use Elementary::{Byte, Dint, Dword, Int, Real, Sint, Time, Udint, Uint, Usint, Word};
        use StlInsn as I;
        if (name, ty) == ("NEG", Sint) {
            let zero = Operand { kind: OperandKind::Literal(Literal::Dint(0)), span: self.span };
            let left = Box::new(Term::Load(vec![(I::Load, Some(zero))]));
            return Some(Term::Binary { left, right: Box::new(of), step: self.step("-", ty)? });
        }
        let (insn, checked) = match (name, ty) {
            ("NEG", Int) => (I::NegI, true),
            ("NEG", Dint | Time) => (I::NegD, true),
            ("NEG", Real) => (I::NegR, false),
            ("INV" | "NOT", Word | Int | Uint) => (I::InvertI, false),
            ("INV" | "NOT", Byte | Usint) => (I::XorW, false),
            ("INV" | "NOT", Dword | Dint | Sint | Udint) => (I::InvertD, false),
            ("SWAP", Word) => (I::SwapBytesWord, false),
            ("SWAP", Dword) => (I::SwapBytesDword, false),
            ("ABS", Real) => (I::AbsR, false),
            ("SQR", Real) => (I::SqrR, true),
            ("SQRT", Real) => (I::SqrtR, true),
            ("LN", Real) => (I::LnR, true),
            ("EXP", Real) => (I::ExpR, true),
            ("SIN", Real) => (I::SinR, true),
            ("COS", Real) => (I::CosR, true),
            ("TAN", Real) => (I::TanR, true),
            ("ASIN", Real) => (I::AsinR, true),
            ("ACOS", Real) => (I::AcosR, true),
            ("ATAN", Real) => (I::AtanR, true),
            _ => return None,
        };
        let step = Step { insn, checked, widens: false, cut: None };
        Some(Term::Unary { of: Box::new(of), step })
    }

    /// An operation of two values.
    fn step(&self, sign: &str, ty: Elementary) -> Option<Step> {
        use Elementary::{Byte, Dint, Dword, Int, Real, Sint, Uint, Usint, Word};
        use StlInsn as I;
        let cut = matches!(ty, Sint | Usint | Uint).then_some(ty);
        let (insn, checked) = match (sign, ty) {
            ("+", Int) => (I::AddI, true),
            ("-", Int) => (I::SubI, true),
            ("*", Int) => (I::MulI, true),
            ("/", Int) => (I::DivI, true),
            // -32768 MOD -1 is 0, while /I says that the quotient does not fit.
            ("MOD", Int) => (I::ModD, true),
            ("+", Dint) => (I::AddD, true),
            ("-", Dint) => (I::SubD, true),
            ("*", Dint) => (I::MulD, true),
            ("/", Dint) => (I::DivD, true),
            ("MOD", Dint) => (I::ModD, true),
            ("+", Real) => (I::AddR, true),
            ("-", Real) => (I::SubR, true),
            ("*", Real) => (I::MulR, true),
            ("/", Real) => (I::DivR, true),
            // The product of two UINT may have 32 bits: a DINT overflows without a change of the bits that stay.
            ("+", Sint | Usint | Uint) => (I::AddD, false),
            ("-", Sint | Usint | Uint) => (I::SubD, false),
            ("*", Sint | Usint | Uint) => (I::MulD, false),
            ("/", Sint | Usint | Uint) => (I::DivD, true),
            ("MOD", Sint | Usint | Uint) => (I::ModD, true),
            ("AND", Byte | Word) => (I::AndW, false),
            ("OR", Byte | Word) => (I::OrW, false),
            ("XOR", Byte | Word) => (I::XorW, false),
            ("AND", Dword) => (I::AndD, false),
            ("OR", Dword) => (I::OrD, false),
            ("XOR", Dword) => (I::XorD, false),
            _ => return None,
        };
        Some(Step { insn, checked, widens: (sign, ty) == ("MOD", Int), cut })
    }

    /// Statements that cut a DINT to the values of a type.
    fn cut(&self, ty: Elementary) -> Statements {
        let operand = |literal: Literal| Some(Operand { kind: OperandKind::Literal(literal), span: self.span });
        match ty {
            Elementary::Usint => vec![(StlInsn::AndD, operand(Literal::Dword(0xFF)))],
            Elementary::Uint => vec![(StlInsn::AndD, operand(Literal::Dword(0xFFFF)))],
            _ => vec![
                (StlInsn::ShiftLeftW, operand(Literal::Int(8))),
                (StlInsn::ShiftSignedI, operand(Literal::Int(8))),
                (StlInsn::IToD, None),
            ],
        }
    }

    fn push_all(&mut self, statements: &[(StlInsn, Option<Operand>)]) {
        statements.iter().for_each(|(insn, operand)| self.push(*insn, operand.clone()));
    }

    /// Leaves a value in ACCU1.
    fn term(&mut self, term: &Term, ty: Elementary, watch: &mut Option<Watch>) {
        match term {
            Term::Load(load) => self.push_all(load),
            Term::Unary { of, step } => {
                self.term(of, ty, watch);
                // A byte has no inversion of its own.
                let bits = (step.insn == StlInsn::XorW).then_some(Literal::Word(0xFF));
                let bits = bits.map(|bits| Operand { kind: OperandKind::Literal(bits), span: self.span });
                self.push(step.insn, bits);
                self.finish_step(step, watch);
            }
            Term::Binary { left, right, step } => {
                let widen = |maker: &mut Self| {
                    if step.widens {
                        maker.push(StlInsn::IToD, None);
                    }
                };
                self.term(left, ty, watch);
                widen(self);
                match &**right {
                    Term::Load(load) => {
                        self.push_all(load);
                        widen(self);
                    }
                    right => {
                        let is_wide = step.widens || step.cut.is_some();
                        let stored = self.temporary(if is_wide { Elementary::Dint } else { ty });
                        self.push(StlInsn::Transfer, Some(stored.clone()));
                        self.term(right, ty, watch);
                        widen(self);
                        self.push(StlInsn::Load, Some(stored));
                        self.push(StlInsn::SwapAccu, None);
                    }
                }
                self.push(step.insn, None);
                self.finish_step(step, watch);
            }
        }
    }

    /// What follows the instruction of a step.
    fn finish_step(&mut self, step: &Step, watch: &mut Option<Watch>) {
        if step.checked
            && let Some(watch) = watch
        {
            let ov = Operand { kind: OperandKind::Status(StatusOperand::Ov), span: self.span };
            self.push(if watch.is_set { StlInsn::Or } else { StlInsn::And }, Some(ov));
            self.note(watch);
        }
        let Some(ty) = step.cut else { return };
        let cut = self.cut(ty);
        let Some(watch) = watch else { return self.push_all(&cut) };
        let whole = self.temporary(Elementary::Dint);
        self.push(StlInsn::Transfer, Some(whole.clone()));
        self.push_all(&cut);
        self.push(StlInsn::Load, Some(whole));
        self.push(StlInsn::CompareNeD, None);
        self.note(watch);
        self.push(StlInsn::SwapAccu, None);
    }

    /// The RLO says whether a step went wrong.
    fn note(&mut self, watch: &mut Watch) {
        if watch.is_set {
            self.push(StlInsn::Or, Some(watch.bit.clone()));
        }
        self.push(StlInsn::Assign, Some(watch.bit.clone()));
        watch.is_set = true;
    }
}
