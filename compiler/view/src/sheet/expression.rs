//! Conditions that are written as expressions, as sheets: AND is a series, OR parallel branches, XOR one operand in series with the negated
//! other one in each of two branches, a comparison its contact. The negation of `<` is `>=`, but not for floating-point numbers: one that is
//! not a number satisfies neither.

use plcc_syntax::Elementary;
use plcc_syntax::chart::ast::Step;
use plcc_syntax::network::draw;
use plcc_syntax::scl::ast::{BinaryOp, Expr, ExprKind, Literal, UnaryOp};

use super::{Label, Link, Look, Meaning, Net, Part, Pin, Place, Sheet, Source};
use crate::names::{Names, Scope};

/// An XOR with more contacts than this is one contact with its text.
const XOR_MAX: usize = 16;

/// The rung of a condition in a chart with these steps; it ends in a coil with `sign`. `text`: the source, or its overlay.
pub fn condition(value: &Expr, sign: &str, names: &Names, scope: Scope, steps: &[Step], text: &str) -> Sheet {
    let mut maker = Maker { sheet: Sheet::default(), names, scope, steps, text };
    let rail = maker.net();
    maker.sheet.nets[rail].sources.push(Source::Rail);
    let end = maker.net();
    maker.add(value, false, rail, end);
    maker.part(Look::Coil { sign: sign.to_string() }, Meaning::Through, Vec::new(), end, None);
    maker.sheet
}

struct Maker<'a> {
    sheet: Sheet,
    names: &'a Names,
    scope: Scope,
    steps: &'a [Step],
    text: &'a str,
}

impl Maker<'_> {
    fn net(&mut self) -> usize {
        let name = format!("n{}", self.sheet.nets.len());
        self.sheet.nets.push(Net { name, ..Net::default() });
        self.sheet.nets.len() - 1
    }

    /// Adds the contacts of an expression between two nets.
    fn add(&mut self, value: &Expr, negated: bool, from: usize, to: usize) {
        match &value.kind {
            ExprKind::Unary { op: UnaryOp::Not, operand } => self.add(operand, !negated, from, to),
            ExprKind::Binary { op, left, right, .. } => match (op, negated) {
                // NOT (a OR b) is NOT a AND NOT b.
                (BinaryOp::And, false) | (BinaryOp::Or, true) => {
                    let middle = self.net();
                    self.add(left, negated, from, middle);
                    self.add(right, negated, middle, to);
                }
                (BinaryOp::Or, false) | (BinaryOp::And, true) => {
                    self.add(left, negated, from, to);
                    self.add(right, negated, from, to);
                }
                (BinaryOp::Xor, _) if contacts(value) <= XOR_MAX => {
                    for first in [false, true] {
                        let middle = self.net();
                        self.add(left, first, from, middle);
                        self.add(right, first == negated, middle, to);
                    }
                }
                _ => match comparison(*op, negated) {
                    Some(_) if negated && is_order(*op) && (self.is_float(left) || self.is_float(right)) => {
                        self.contact(value, negated, from, to);
                    }
                    Some(sign) => {
                        let pins = vec![self.operand(Place::Above, left), self.operand(Place::Below, right)];
                        let look = Look::Compare { sign: sign.to_string(), ty: " ".to_string() };
                        let meaning = Meaning::Compare { sign: sign.to_string(), inverse: negated };
                        self.part(look, meaning, pins, from, Some(to));
                    }
                    None => self.contact(value, negated, from, to),
                },
            },
            _ => self.contact(value, negated, from, to),
        }
    }

    /// Whether a value is a floating-point number, as far as its names tell.
    fn is_float(&self, value: &Expr) -> bool {
        match &value.kind {
            ExprKind::Literal(literal) => {
                matches!(literal, Literal::Real(_) | Literal::Typed { ty: Elementary::Real | Elementary::Lreal, .. })
            }
            ExprKind::Name(_) | ExprKind::Absolute(_) | ExprKind::Member { .. } => {
                self.names.is_float(&without_indices(value), self.scope)
            }
            ExprKind::Index { base, .. } => self.is_float(base),
            ExprKind::Unary { operand, .. } => self.is_float(operand),
            ExprKind::Binary { left, right, .. } => self.is_float(left) || self.is_float(right),
            ExprKind::Call { callee, arguments } => {
                let name = draw::whole(callee).to_ascii_uppercase();
                let mut given = arguments.iter().filter_map(|argument| argument.value.as_ref());
                match name.split_once("_TO_") {
                    Some((_, to)) => to.ends_with("REAL"),
                    None => given.any(|value| self.is_float(value)),
                }
            }
            ExprKind::MemberAbsolute { .. }
            | ExprKind::Slice { .. }
            | ExprKind::Dereference(_)
            | ExprKind::Reference(_)
            | ExprKind::Error => false,
        }
    }

    fn contact(&mut self, value: &Expr, negated: bool, from: usize, to: usize) {
        let mut pin = self.operand(Place::Above, value);
        // What is at the place of an expression is its first operand.
        if let (ExprKind::Binary { .. }, Link::Operand(label)) = (&value.kind, &mut pin.link) {
            label.place = None;
        }
        let pins = vec![pin];
        let sign = if negated { "/" } else { "" }.to_string();
        self.part(Look::Contact { sign }, Meaning::Contact { negated }, pins, from, Some(to));
    }

    fn operand(&self, place: Place, value: &Expr) -> Pin {
        let mut label = self.names.label(&draw::whole_of(value, self.text), self.scope);
        if label.key.is_empty()
            && let Some(local) = self.of_step(value)
        {
            label.key = self.names.key(&local, self.scope).unwrap_or_default();
        }
        let label = Label { place: Some(value.span.start), ..label };
        Pin { name: String::new(), place, output: false, link: Link::Operand(label), negated: false }
    }

    /// A value of a step as a variable of the block, `#Run.T`: code names the step, or gives its number, as `S002`.
    fn of_step(&self, value: &Expr) -> Option<String> {
        let ExprKind::Member { base, name: value } = &value.kind else { return None };
        let ExprKind::Name(name) = &base.kind else { return None };
        let named = self.steps.iter().find(|step| step.name.text.eq_ignore_ascii_case(&name.text));
        let numbered = || {
            let digits = name.text.strip_prefix(['S', 's'])?;
            let number: u32 = digits.bytes().all(|digit| digit.is_ascii_digit()).then(|| digits.parse().ok())??;
            self.steps.iter().find(|step| step.number == number)
        };
        Some(format!("#{}.{}", named.or_else(numbered)?.name.text, value.text))
    }

    fn part(&mut self, look: Look, meaning: Meaning, mut pins: Vec<Pin>, from: usize, to: Option<usize>) {
        let at = self.sheet.parts.len();
        let flow = |output: bool, net: usize| Pin {
            name: String::new(),
            place: Place::Side,
            output,
            link: Link::Net(net),
            negated: false,
        };
        let flow_in = Some(pins.len());
        pins.push(flow(false, from));
        let flow_out = to.map(|_| pins.len());
        if let Some(to) = to {
            self.sheet.nets[to].sources.push(Source::Pin { part: at, pin: pins.len() });
            pins.push(flow(true, to));
        }
        // Only the operand of a contact has a place of its own: an expression begins where its first operand does.
        let operand = pins.first().and_then(|pin| match (&meaning, &pin.link) {
            (Meaning::Contact { .. }, Link::Operand(label)) => label.place,
            _ => None,
        });
        self.sheet.parts.push(Part { look, meaning, pins, flow_in, flow_out, place: operand, statement: None });
    }
}

/// How many contacts an expression is drawn with.
fn contacts(value: &Expr) -> usize {
    match &value.kind {
        ExprKind::Unary { op: UnaryOp::Not, operand } => contacts(operand),
        ExprKind::Binary { op: BinaryOp::And | BinaryOp::Or, left, right, .. } => {
            contacts(left).saturating_add(contacts(right))
        }
        ExprKind::Binary { op: BinaryOp::Xor, left, right, .. } => {
            contacts(left).saturating_add(contacts(right)).saturating_mul(2)
        }
        _ => 1,
    }
}

/// The text of a variable, that of an element of an array as if it were the array.
fn without_indices(value: &Expr) -> String {
    match &value.kind {
        ExprKind::Member { base, name } => format!("{}.\"{}\"", without_indices(base), name.text),
        ExprKind::Index { base, .. } => without_indices(base),
        _ => draw::whole(value),
    }
}

const fn is_order(op: BinaryOp) -> bool {
    matches!(op, BinaryOp::Less | BinaryOp::LessEqual | BinaryOp::Greater | BinaryOp::GreaterEqual)
}

/// The sign of a comparison, or that of its negation.
fn comparison(op: BinaryOp, negated: bool) -> Option<&'static str> {
    let (sign, other) = match op {
        BinaryOp::Equal => ("==", "<>"),
        BinaryOp::NotEqual => ("<>", "=="),
        BinaryOp::Less => ("<", ">="),
        BinaryOp::LessEqual => ("<=", ">"),
        BinaryOp::Greater => (">", "<="),
        BinaryOp::GreaterEqual => (">=", "<"),
        _ => return None,
    };
    Some(if negated { other } else { sign })
}
