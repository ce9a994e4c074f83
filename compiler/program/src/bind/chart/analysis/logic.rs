//! Conditions as formulas over the operands they read: which are always the same, and which follow from others.
//!
//! Operands, comparisons and everything else that is not an AND, OR, XOR or NOT is an atom, identified by its text. A formula of few atoms is
//! decided by its truth table; of a larger one, only what its shape shows is known.

use plcc_syntax::Elementary;
use plcc_syntax::chart::ast::Condition;
use plcc_syntax::network::ast::{Content, Element, Graph, Pin, PinValue, Source, Target};
use plcc_syntax::network::elements::{Gate, Kind};
use plcc_syntax::scl::ast::{BinaryOp, Expr, ExprKind, Literal, StatementKind, UnaryOp};
use plcc_syntax::scl::text::expr;
use rustc_hash::{FxHashMap, FxHashSet};

/// Atoms of a truth table.
const ATOMS_MAX: usize = 10;

/// Limit of parts in a formula that is decided with a truth table.
const PARTS_MAX: usize = 1000;

/// Largest number of elements in a network that is analyzed.
const ELEMENTS_MAX: usize = 256;

/// Words of a truth table.
const WORDS: usize = (1 << ATOMS_MAX) / 64;

/// The atoms of a chart.
#[derive(Default)]
pub struct Atoms {
    known: FxHashMap<String, usize>,
    count: usize,
}

impl Atoms {
    fn of(&mut self, text: String) -> usize {
        if let Some(&atom) = self.known.get(&text) {
            return atom;
        }
        let atom = self.unknown();
        self.known.insert(text, atom);
        atom
    }

    /// An atom whose value may differ each time: a call, an edge.
    fn unknown(&mut self) -> usize {
        self.count += 1;
        self.count - 1
    }
}

/// A part of a formula; the parts it consists of come before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Constant(bool),
    Atom(usize),
    Not(usize),
    And(usize, usize),
    Or(usize, usize),
    Xor(usize, usize),
}

/// A condition. The last part is its value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Formula {
    parts: Vec<Part>,
    /// It is only TRUE or FALSE as written, or a wire.
    pub plain: bool,
}

impl Formula {
    /// The formula of a condition.
    pub fn of(condition: &Condition, atoms: &mut Atoms) -> Formula {
        let mut build = Build { atoms, parts: Vec::new() };
        let root = match condition {
            Condition::Expression(value) => build.expression(value),
            Condition::Network(network) => match &network.content {
                Content::Graphic(graph) if !graph.broken && graph.elements.len() <= ELEMENTS_MAX => {
                    build.network(graph)
                }
                Content::Graphic(_) | Content::Scl(_) | Content::Stl(_) => build.unknown(),
            },
            Condition::Statements(list) => match list.as_slice() {
                [only] => match &only.kind {
                    StatementKind::Expression(value) => build.expression(value),
                    _ => build.unknown(),
                },
                _ => build.unknown(),
            },
        };
        // Parts after the value are not used.
        let mut parts = build.parts;
        parts.truncate(root + 1);
        let plain = match condition {
            Condition::Expression(value) => truth(value).is_some(),
            Condition::Network(network) => {
                matches!(&network.content, Content::Graphic(graph) if graph.elements.len() < 2)
            }
            Condition::Statements(list) => list.is_empty(),
        };
        Formula { parts, plain }
    }

    /// TRUE, as for a missing condition.
    pub fn satisfied() -> Formula {
        Formula { parts: vec![Part::Constant(true)], plain: true }
    }

    /// The value, if it is always the same.
    pub fn constant(&self) -> Option<bool> {
        if let Some(Part::Constant(value)) = self.parts.last() {
            return Some(*value);
        }
        if let Some(table) = self.atoms_with(None).and_then(|atoms| self.table(&atoms)) {
            let ones = table.iter().all(|&word| word == u64::MAX);
            let zeros = table.iter().all(|&word| word == 0);
            return (ones || zeros).then_some(ones);
        }
        let contradicts = |literals: &FxHashSet<(usize, bool)>| {
            literals.iter().any(|&(atom, negated)| literals.contains(&(atom, !negated)))
        };
        if contradicts(&self.literals(true).0) {
            return Some(false);
        }
        contradicts(&self.literals(false).0).then_some(true)
    }

    /// Whether `other` is TRUE whenever `self` is, as far as that can be found out.
    pub fn implies(&self, other: &Formula) -> bool {
        if other.constant() == Some(true) || self == other {
            return true;
        }
        if let Some(atoms) = self.atoms_with(Some(other))
            && let (Some(own), Some(others)) = (self.table(&atoms), other.table(&atoms))
        {
            return own.iter().zip(&others).all(|(own, other)| own & !other == 0);
        }
        let (own, _) = self.literals(true);
        let (others, all) = other.literals(true);
        all && others.is_subset(&own)
    }

    /// Its atoms, and those of another formula; none if there are too many for a table.
    fn atoms_with(&self, other: Option<&Formula>) -> Option<Vec<usize>> {
        if self.parts.len() + other.map_or(0, |other| other.parts.len()) > PARTS_MAX {
            return None;
        }
        let mut atoms = Vec::new();
        for part in self.parts.iter().chain(other.iter().flat_map(|other| &other.parts)) {
            if let Part::Atom(atom) = part
                && !atoms.contains(atom)
            {
                if atoms.len() == ATOMS_MAX {
                    return None;
                }
                atoms.push(*atom);
            }
        }
        Some(atoms)
    }

    /// Its value for all values of the atoms, one bit for each.
    fn table(&self, atoms: &[usize]) -> Option<[u64; WORDS]> {
        let mut tables: Vec<[u64; WORDS]> = Vec::with_capacity(self.parts.len());
        for part in &self.parts {
            let zip = |a: usize, b: usize, with: fn(u64, u64) -> u64| {
                std::array::from_fn(|word| with(tables[a][word], tables[b][word]))
            };
            let table = match *part {
                Part::Constant(value) => [if value { u64::MAX } else { 0 }; WORDS],
                Part::Atom(atom) => column(atoms.iter().position(|&other| other == atom)?),
                Part::Not(a) => tables[a].map(|word| !word),
                Part::And(a, b) => zip(a, b, |a, b| a & b),
                Part::Or(a, b) => zip(a, b, |a, b| a | b),
                Part::Xor(a, b) => zip(a, b, |a, b| a ^ b),
            };
            tables.push(table);
        }
        tables.pop()
    }

    /// Atoms and negated atoms that its outermost AND or OR joins, and whether it joins only those.
    fn literals(&self, and: bool) -> (FxHashSet<(usize, bool)>, bool) {
        let mut literals = FxHashSet::default();
        let mut all = true;
        let mut open = vec![self.parts.len() - 1];
        while let Some(at) = open.pop() {
            match self.parts[at] {
                Part::Atom(atom) => {
                    literals.insert((atom, false));
                }
                Part::Not(inner) if matches!(self.parts[inner], Part::Atom(_)) => {
                    if let Part::Atom(atom) = self.parts[inner] {
                        literals.insert((atom, true));
                    }
                }
                Part::And(a, b) if and => open.extend([a, b]),
                Part::Or(a, b) if !and => open.extend([a, b]),
                Part::Constant(_) | Part::Not(_) | Part::And(..) | Part::Or(..) | Part::Xor(..) => all = false,
            }
        }
        (literals, all)
    }
}

/// The values of one atom in a truth table: bit `n` is bit `atom` of the number `n`.
fn column(atom: usize) -> [u64; WORDS] {
    const LOW: [u64; 6] = [
        0xAAAA_AAAA_AAAA_AAAA,
        0xCCCC_CCCC_CCCC_CCCC,
        0xF0F0_F0F0_F0F0_F0F0,
        0xFF00_FF00_FF00_FF00,
        0xFFFF_0000_FFFF_0000,
        0xFFFF_FFFF_0000_0000,
    ];
    std::array::from_fn(|word| match LOW.get(atom) {
        Some(&low) => low,
        None if word >> (atom - LOW.len()) & 1 == 1 => u64::MAX,
        None => 0,
    })
}

/// A formula under construction.
struct Build<'a> {
    atoms: &'a mut Atoms,
    parts: Vec<Part>,
}

impl Build<'_> {
    fn push(&mut self, part: Part) -> usize {
        self.parts.push(part);
        self.parts.len() - 1
    }

    fn unknown(&mut self) -> usize {
        let atom = self.atoms.unknown();
        self.push(Part::Atom(atom))
    }

    fn constant(&self, part: usize) -> Option<bool> {
        match self.parts[part] {
            Part::Constant(value) => Some(value),
            Part::Atom(_) | Part::Not(_) | Part::And(..) | Part::Or(..) | Part::Xor(..) => None,
        }
    }

    fn not(&mut self, a: usize) -> usize {
        match self.constant(a) {
            Some(value) => self.push(Part::Constant(!value)),
            None => self.push(Part::Not(a)),
        }
    }

    /// AND and OR: one constant decides, the other does not matter.
    fn and_or(&mut self, a: usize, b: usize, and: bool) -> usize {
        match (self.constant(a), self.constant(b)) {
            (Some(value), _) if value == and => b,
            (_, Some(value)) if value == and => a,
            (Some(_), _) | (_, Some(_)) => self.push(Part::Constant(!and)),
            (None, None) if and => self.push(Part::And(a, b)),
            (None, None) => self.push(Part::Or(a, b)),
        }
    }

    fn xor(&mut self, a: usize, b: usize) -> usize {
        match (self.constant(a), self.constant(b)) {
            (Some(a), Some(b)) => self.push(Part::Constant(a != b)),
            (Some(false), None) => b,
            (None, Some(false)) => a,
            (Some(true), None) => self.not(b),
            (None, Some(true)) => self.not(a),
            (None, None) => self.push(Part::Xor(a, b)),
        }
    }

    fn expression(&mut self, value: &Expr) -> usize {
        enum Task<'e> {
            Value(&'e Expr),
            Not,
            Binary(BinaryOp),
        }
        let mut tasks = vec![Task::Value(value)];
        let mut values: Vec<usize> = Vec::new();
        while let Some(task) = tasks.pop() {
            let result = match task {
                Task::Value(value) => match &value.kind {
                    ExprKind::Unary { op: UnaryOp::Not, operand } => {
                        tasks.extend([Task::Not, Task::Value(operand)]);
                        continue;
                    }
                    ExprKind::Binary {
                        op: op @ (BinaryOp::And | BinaryOp::Or | BinaryOp::Xor), left, right, ..
                    } => {
                        tasks.extend([Task::Binary(*op), Task::Value(right), Task::Value(left)]);
                        continue;
                    }
                    _ => self.atom(value),
                },
                Task::Not => {
                    let a = values.pop().expect("the operand was pushed before");
                    self.not(a)
                }
                Task::Binary(op) => {
                    let b = values.pop().expect("the right side was pushed before");
                    let a = values.pop().expect("the left side was pushed before");
                    match op {
                        BinaryOp::And => self.and_or(a, b, true),
                        BinaryOp::Or => self.and_or(a, b, false),
                        _ => self.xor(a, b),
                    }
                }
            };
            values.push(result);
        }
        values.pop().expect("an expression has a value")
    }

    fn atom(&mut self, value: &Expr) -> usize {
        if let Some(value) = truth(value) {
            return self.push(Part::Constant(value));
        }
        if changes(value) {
            return self.unknown();
        }
        let atom = self.atoms.of(expr(value).to_lowercase());
        self.push(Part::Atom(atom))
    }

    /// The value of the element for the condition; TRUE if there is none, as in an empty network.
    fn network(&mut self, graph: &Graph) -> usize {
        let mut outputs: Vec<Option<usize>> = vec![None; graph.elements.len()];
        // An element may come before one that it needs: each round computes those whose inputs are known.
        loop {
            let mut settled = false;
            for (at, element) in graph.elements.iter().enumerate() {
                if outputs[at].is_none()
                    && let Some(value) = self.element(graph, element, &outputs)
                {
                    outputs[at] = Some(value);
                    settled = true;
                }
            }
            if !settled {
                break;
            }
        }
        let conditions =
            graph.elements.iter().enumerate().filter(|(_, element)| kind(element) == Some(Kind::Condition));
        match conditions.map(|(at, _)| outputs[at]).next() {
            None => self.push(Part::Constant(true)),
            Some(Some(value)) => value,
            Some(None) => self.unknown(),
        }
    }

    /// The value of an element; none as long as an input is not known.
    fn element(&mut self, graph: &Graph, element: &Element, outputs: &[Option<usize>]) -> Option<usize> {
        if !is_logic(element) {
            return None;
        }
        let mut inputs: Vec<usize> = Vec::new();
        let flow = |pin: &&Pin| !pin.output && pin.name != "operand";
        for pin in element.pins.iter().filter(flow) {
            inputs.push(self.pin(graph, pin, outputs)?);
        }
        let first = |build: &mut Self| inputs.first().copied().unwrap_or_else(|| build.push(Part::Constant(true)));
        Some(match kind(element) {
            Some(Kind::Condition) => first(self),
            Some(Kind::Not) => {
                let a = first(self);
                self.not(a)
            }
            Some(Kind::Contact) => {
                let a = first(self);
                let b = self.pin(graph, element.pin("operand")?, outputs)?;
                self.and_or(a, b, true)
            }
            Some(Kind::Gate(gate)) if !inputs.is_empty() => {
                let rest = inputs[1..].iter();
                rest.fold(inputs[0], |a, &b| match gate {
                    Gate::And => self.and_or(a, b, true),
                    Gate::Or => self.and_or(a, b, false),
                    Gate::Xor => self.xor(a, b),
                })
            }
            _ => self.unknown(),
        })
    }

    fn pin(&mut self, graph: &Graph, pin: &Pin, outputs: &[Option<usize>]) -> Option<usize> {
        let value = match &pin.value {
            PinValue::Operand(value) => self.expression(value),
            PinValue::Net(id) => self.net(graph, id.0 as usize, outputs)?,
            PinValue::Open => self.push(Part::Constant(true)),
        };
        Some(if pin.negated { self.not(value) } else { value })
    }

    /// The OR of the outputs that feed a net, and of the nets that feed it.
    fn net(&mut self, graph: &Graph, net: usize, outputs: &[Option<usize>]) -> Option<usize> {
        let mut result = self.push(Part::Constant(false));
        let mut seen = vec![net];
        let mut next = 0;
        while next < seen.len() {
            for source in &graph.nets.get(seen[next])?.sources {
                let value = match source {
                    Source::Rail => self.push(Part::Constant(true)),
                    Source::Pin { element, .. } if is_logic(graph.elements.get(*element)?) => outputs[*element]?,
                    // A box has several outputs, and may have another value each time.
                    Source::Pin { .. } => self.unknown(),
                    Source::Operand { value, negated } => {
                        let value = self.expression(value);
                        if *negated { self.not(value) } else { value }
                    }
                    Source::Net(id) => {
                        if !seen.contains(&(id.0 as usize)) {
                            seen.push(id.0 as usize);
                        }
                        continue;
                    }
                };
                result = self.and_or(result, value, false);
            }
            next += 1;
        }
        Some(result)
    }
}

/// Its value depends only on its inputs.
fn is_logic(element: &Element) -> bool {
    matches!(kind(element), Some(Kind::Condition | Kind::Not | Kind::Contact | Kind::Gate(_)))
}

fn kind(element: &Element) -> Option<Kind> {
    match &element.target {
        Target::Element { row, .. } => Some(row.kind),
        Target::Block { .. } => None,
    }
}

/// TRUE and FALSE.
fn truth(value: &Expr) -> Option<bool> {
    match &value.kind {
        ExprKind::Literal(Literal::Typed { ty: Elementary::Bool, bits }) => Some(*bits != 0),
        ExprKind::Name(name) if name.text.eq_ignore_ascii_case("TRUE") => Some(true),
        ExprKind::Name(name) if name.text.eq_ignore_ascii_case("FALSE") => Some(false),
        _ => None,
    }
}

/// It may have another value each time it is computed.
fn changes(value: &Expr) -> bool {
    let mut open = vec![value];
    while let Some(value) = open.pop() {
        match &value.kind {
            ExprKind::Call { .. } | ExprKind::Error => return true,
            ExprKind::Member { base, .. } | ExprKind::MemberAbsolute { base, .. } | ExprKind::Slice { base, .. } => {
                open.push(base);
            }
            ExprKind::Index { base, indices } => {
                open.push(base);
                open.extend(indices);
            }
            ExprKind::Dereference(inner) | ExprKind::Reference(inner) | ExprKind::Unary { operand: inner, .. } => {
                open.push(inner);
            }
            ExprKind::Binary { left, right, .. } => open.extend([&**left, &**right]),
            ExprKind::Literal(_) | ExprKind::Name(_) | ExprKind::Absolute(_) => {}
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use plcc_diag::FileId;
    use plcc_syntax::scl::fragment;

    use super::*;

    fn formulas(texts: &[&str]) -> Vec<Formula> {
        let mut atoms = Atoms::default();
        let condition = |text: &&str| Condition::Expression(fragment::expression(FileId(0), text, 0..text.len()).0);
        texts.iter().map(|text| Formula::of(&condition(text), &mut atoms)).collect()
    }

    fn constant(text: &str) -> Option<bool> {
        formulas(&[text])[0].constant()
    }

    fn implies(a: &str, b: &str) -> bool {
        let both = formulas(&[a, b]);
        both[0].implies(&both[1])
    }

    /// An AND of more operands than a truth table can have.
    fn many(end: &str) -> String {
        let names: Vec<String> = (0..40).map(|n| format!("#a{n}")).collect();
        format!("{} AND {end}", names.join(" AND "))
    }

    #[test]
    fn constants() {
        assert_eq!(constant("#a AND NOT #A"), Some(false));
        assert_eq!(constant("#a OR (#b XOR #b) OR NOT #a"), Some(true));
        assert_eq!(constant("#a AND (#b OR FALSE)"), None);
        assert_eq!(constant("#n > 5 OR TRUE"), Some(true));
        assert_eq!(constant("#n > 5 AND NOT (#n > 5)"), Some(false));
        assert_eq!(constant("F(#a) AND NOT F(#a)"), None, "a call may have another value");
        assert_eq!(constant(&many("NOT #a3")), Some(false));
        assert_eq!(constant(&many("#b")), None);
    }

    #[test]
    fn implications() {
        assert!(implies("#a AND #b", "#a"));
        assert!(!implies("#a", "#a AND #b"));
        assert!(implies("#a AND NOT #b", "#a XOR #b"));
        assert!(implies("#a", "TRUE"));
        assert!(!implies("%I0.0", "%I0.1"));
        assert!(implies(&many("#b"), "#a7"));
        assert!(implies(&many("#b"), &many("#b")));
        assert!(!implies(&many("#b"), &many("#c")));
    }

    #[test]
    fn what_stands_there_as_it_is() {
        let [written, folded] = formulas(&["TRUE", "#a OR TRUE"]).try_into().unwrap();
        assert!(written.plain && !folded.plain);
    }
}
