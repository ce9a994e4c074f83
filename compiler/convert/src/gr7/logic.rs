//! Networks of conditions and of permanent instructions as expressions.
//!
//! ```text
//! ──┤a├──┬──┤/b├──┬──( )     a AND (NOT b OR x > 5)
//!        └──┤x>5├─┘
//! ```

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::chart::ast::Coil;
use plcc_syntax::network::ast::{Content, Element, Graph, NetId, Network, Pin, PinValue, Source, Storage, Target};
use plcc_syntax::network::elements::{Gate, Kind};
use plcc_syntax::scl::ast::{BinaryOp, Expr, ExprKind, Literal, UnaryOp};

use crate::scl::expression;
use crate::writer::{Notation, Writer};

/// What a network cannot be, and where.
type Refused = (Span, String);

/// Nets that lead to each other beyond this depth are refused, as are larger expressions than [`SIZE_MAX`].
const DEPTH_MAX: usize = 200;

/// A wire that several elements read is written for each of them.
const SIZE_MAX: usize = 4000;

/// The value of the element that ends a condition; what cannot be said is reported.
pub fn condition(network: &Network, whose: &str, writer: &mut Writer) -> Option<Expr> {
    let found = graph_of(network).and_then(|graph| {
        // Whatever else the network does would be lost.
        let is_read = |element: &&Element| match kind(element) {
            Some(Kind::Condition | Kind::Contact | Kind::Not | Kind::Compare(_) | Kind::Gate(_)) => true,
            Some(_) | None => false,
        };
        if let Some(other) = graph.elements.iter().find(|element| !is_read(element)) {
            return Err((other.span, format!("{} in {whose}", named(other))));
        }
        let end = graph.elements.iter().find(|element| kind(element) == Some(Kind::Condition));
        match end {
            Some(end) => Reader::new(graph).flow(end, "in"),
            None => Err((network.span, format!("{whose} without its coil"))),
        }
    });
    found.map_err(|refused| report(refused, writer)).ok()
}

/// The coils of a network with the values that they get.
pub fn coils(network: &Network, writer: &mut Writer) -> Vec<(Expr, Coil, Expr)> {
    let found = graph_of(network).and_then(|graph| all_coils(graph, writer));
    found.map_err(|refused| report(refused, writer)).unwrap_or_default()
}

fn report((span, what): Refused, writer: &mut Writer) {
    let help = "write the network with contacts, comparisons and coils, or call a block with it";
    let title = match writer.notation {
        Notation::St => format!("plcc writes conditions of SFC as expressions, which have no form for {what}"),
        Notation::Gr7 | Notation::Scl | Notation::Stl | Notation::Sd => {
            format!("GRAPH sources have no form for {what}")
        }
    };
    writer.refuse(span, title, help);
}

fn graph_of(network: &Network) -> Result<&Graph, Refused> {
    match &network.content {
        Content::Graphic(graph) if !graph.broken => Ok(graph),
        Content::Graphic(_) => Err((network.span, "a network that was not understood".to_string())),
        Content::Scl(_) | Content::Stl(_) => Err((network.span, "a network of statements".to_string())),
    }
}

fn kind(element: &Element) -> Option<Kind> {
    match &element.target {
        Target::Element { row, .. } => Some(row.kind),
        Target::Block { .. } => None,
    }
}

fn all_coils(graph: &Graph, writer: &mut Writer) -> Result<Vec<(Expr, Coil, Expr)>, Refused> {
    let mut found: Vec<(Expr, Coil, Expr)> = Vec::new();
    let mut written: Vec<String> = Vec::new();
    let mut reader = Reader::new(graph);
    for element in &graph.elements {
        let coil = match kind(element) {
            Some(Kind::Coil) => Coil::Assign,
            Some(Kind::SetCoil) => Coil::Set,
            Some(Kind::ResetCoil) => Coil::Reset,
            // Others are read where a coil needs them.
            _ if element.pins.iter().any(|pin| pin.output && matches!(pin.value, PinValue::Net(_))) => continue,
            _ => return Err((element.span, named(element))),
        };
        let Some(Pin { value: PinValue::Operand(operand), negated, .. }) = element.pin("operand") else {
            return Err((element.span, "a coil without an operand".to_string()));
        };
        let value = reader.flow(element, "in")?;
        let value = if *negated { not(value) } else { value };
        let text = expression::text(&value, writer);
        // The flow of a network is found before its coils write.
        if let Some(name) = written.iter().find(|name| text.contains(name.as_str())) {
            return Err((element.span, format!("a network that writes `{name}` before it is read")));
        }
        written.push(expression::text(operand, writer));
        found.push((operand.clone(), coil, value));
    }
    Ok(found)
}

fn named(element: &Element) -> String {
    match &element.target {
        Target::Element { row, .. } => format!("the element `{}`", row.name),
        Target::Block { .. } => "a call".to_string(),
    }
}

fn not(value: Expr) -> Expr {
    let span = value.span;
    match value.kind {
        ExprKind::Unary { op: UnaryOp::Not, operand } => *operand,
        kind => {
            let operand = Box::new(Expr { kind, span });
            Expr { kind: ExprKind::Unary { op: UnaryOp::Not, operand }, span }
        }
    }
}

fn truth(value: bool, span: Span) -> Expr {
    let span = Span { end: span.start, ..span };
    Expr { kind: ExprKind::Literal(Literal::Typed { ty: Elementary::Bool, bits: u64::from(value) }), span }
}

fn is_true(value: &Expr) -> bool {
    matches!(value.kind, ExprKind::Literal(Literal::Typed { ty: Elementary::Bool, bits: 1 }))
}

fn binary(op: BinaryOp, left: Expr, right: Expr) -> Expr {
    let span = left.span;
    Expr { kind: ExprKind::Binary { op, left: Box::new(left), right: Box::new(right), op_span: span }, span }
}

fn and(left: Expr, right: Expr) -> Expr {
    if is_true(&left) {
        right
    } else if is_true(&right) {
        left
    } else {
        binary(BinaryOp::And, left, right)
    }
}

struct Reader<'a> {
    graph: &'a Graph,
    depth: usize,
    size: usize,
}

impl<'a> Reader<'a> {
    fn new(graph: &'a Graph) -> Reader<'a> {
        Reader { graph, depth: 0, size: 0 }
    }

    /// What enters an element by a pin; TRUE if nothing is connected.
    fn flow(&mut self, element: &Element, name: &str) -> Result<Expr, Refused> {
        match element.pins.iter().find(|pin| !pin.output && pin.name.eq_ignore_ascii_case(name)) {
            Some(pin) => self.pin(pin),
            None => Ok(truth(true, element.span)),
        }
    }

    fn pin(&mut self, pin: &Pin) -> Result<Expr, Refused> {
        let value = match &pin.value {
            PinValue::Net(net) => self.net(*net, pin.span)?,
            PinValue::Operand(value) => value.clone(),
            PinValue::Open => truth(true, pin.span),
        };
        Ok(if pin.negated { not(value) } else { value })
    }

    fn net(&mut self, net: NetId, span: Span) -> Result<Expr, Refused> {
        self.depth += 1;
        self.size += 1;
        if self.depth > DEPTH_MAX || self.size > SIZE_MAX {
            return Err((span, "a network of this size".to_string()));
        }
        let mut value: Option<Expr> = None;
        let graph = self.graph;
        for source in &graph.net(net).sources {
            let one = match source {
                Source::Rail => truth(true, span),
                Source::Operand { value, negated: false } => value.clone(),
                Source::Operand { value, negated: true } => not(value.clone()),
                Source::Net(other) => self.net(*other, span)?,
                Source::Pin { element, pin } => {
                    let element = &graph.elements[*element];
                    let value = self.element(element)?;
                    if element.pins[*pin].negated { not(value) } else { value }
                }
            };
            value = Some(match value {
                None => one,
                Some(before) if is_true(&before) => before,
                Some(_) if is_true(&one) => one,
                Some(before) => binary(BinaryOp::Or, before, one),
            });
        }
        self.depth -= 1;
        Ok(value.unwrap_or_else(|| truth(false, span)))
    }

    /// The flow after an element that changes nothing.
    fn element(&mut self, element: &Element) -> Result<Expr, Refused> {
        let refused = || (element.span, named(element));
        if element.pins.iter().any(|pin| pin.storage != Storage::None) {
            return Err(refused());
        }
        match kind(element) {
            Some(Kind::Contact) => {
                let before = self.flow(element, "in")?;
                let Some(operand) = element.pin("operand") else { return Err(refused()) };
                let operand = self.pin(operand)?;
                Ok(and(before, operand))
            }
            Some(Kind::Not) => Ok(not(self.flow(element, "in")?)),
            // The flow goes on after a coil.
            Some(Kind::Coil | Kind::SetCoil | Kind::ResetCoil) => self.flow(element, "in"),
            Some(Kind::Compare(sign)) => {
                let before = self.flow(element, "pre")?;
                let op = match sign {
                    "=" => BinaryOp::Equal,
                    "<>" => BinaryOp::NotEqual,
                    "<" => BinaryOp::Less,
                    ">" => BinaryOp::Greater,
                    "<=" => BinaryOp::LessEqual,
                    ">=" => BinaryOp::GreaterEqual,
                    _ => return Err(refused()),
                };
                let [Some(left), Some(right)] = ["in1", "in2"].map(|name| element.pin(name)) else {
                    return Err(refused());
                };
                let (PinValue::Operand(left), PinValue::Operand(right)) = (&left.value, &right.value) else {
                    return Err(refused());
                };
                Ok(and(before, binary(op, left.clone(), right.clone())))
            }
            Some(Kind::Gate(gate)) => {
                let op = match gate {
                    Gate::And => BinaryOp::And,
                    Gate::Or => BinaryOp::Or,
                    Gate::Xor => BinaryOp::Xor,
                };
                let mut value: Option<Expr> = None;
                for pin in element.pins.iter().filter(|pin| !pin.output) {
                    if pin.value == PinValue::Open {
                        return Err((pin.span, format!("an open input of `{}`", pin.name)));
                    }
                    let one = self.pin(pin)?;
                    value = Some(match value {
                        Some(before) => binary(op, before, one),
                        None => one,
                    });
                }
                value.ok_or_else(refused)
            }
            _ => Err(refused()),
        }
    }
}
