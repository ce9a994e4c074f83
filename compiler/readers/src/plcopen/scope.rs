//! The meaning of names in the bodies of a POU.

use std::cell::RefCell;
use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use plcc_diag::Diagnostic;

use super::address::{Addresses, Location};
use super::editor::Editor;
use super::functions::{self, floats, texts};
use super::globals::{GLOBALS, integer};
use super::types::{self, Ty, Types};
use plcc_syntax::Elementary;
use plcc_syntax::scl::ast::{
    Argument, AssignOp, BinaryOp, CaseValue, Expr, ExprKind, Literal, Name, NameForm, Statement, StatementKind, UnaryOp,
};
use plcc_syntax::scl::{absolute, area_word};

/// Flip-flops of IEC 61131-3: SR is set if both inputs are 1, RS is reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlipFlop {
    SetWins,
    ResetWins,
}

/// What a global name means.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Global {
    /// A tag of that name.
    Tag(String),
    /// A component of the data block of the global variables.
    Component(String),
}

/// The meaning of names in all POUs of a project. Keys are in lower case.
#[derive(Debug)]
pub struct Shared {
    pub editor: Editor,
    pub addresses: Addresses,
    pub globals: HashMap<String, Global>,
    /// Lists of global variables by their names, for `List.name`.
    pub lists: HashMap<String, HashMap<String, Global>>,
    /// Programs with one instance, and its name.
    pub programs: HashMap<String, String>,
    /// Values of enumerations by type and name.
    pub enums: HashMap<String, HashMap<String, i64>>,
    /// Names of the POUs.
    pub pous: HashSet<String>,
    pub types: Rc<Types>,
}

/// The names that a POU knows, in lower case.
#[derive(Clone)]
pub struct Scope {
    pub shared: Rc<Shared>,
    /// Declared in the POU.
    pub locals: HashSet<String>,
    /// Elementary types of variables, in upper case.
    pub types: HashMap<String, String>,
    /// Types of variables.
    pub kinds: HashMap<String, Ty>,
    /// Variables with an address, and the tag of each.
    pub located: HashMap<String, String>,
    /// Global names that mean something else in this POU.
    pub hidden: HashSet<String>,
    /// Instances of SR and RS: the BOOL that keeps their state.
    pub flip_flops: HashMap<String, FlipFlop>,
    /// Actions of the POU, which are called like functions: their statements with resolved names.
    pub actions: HashMap<String, Vec<Statement>>,
    pub messages: Rc<RefCell<Vec<Diagnostic>>>,
}

impl Scope {
    pub fn new(shared: Rc<Shared>) -> Scope {
        Scope {
            shared,
            locals: HashSet::new(),
            types: HashMap::new(),
            kinds: HashMap::new(),
            located: HashMap::new(),
            hidden: HashSet::new(),
            flip_flops: HashMap::new(),
            actions: HashMap::new(),
            messages: Rc::default(),
        }
    }

    pub fn statements(&self, list: &mut [Statement]) {
        for statement in list {
            match self.action(&statement.kind) {
                // Its names are resolved.
                Some(body) => {
                    let branches = vec![(always(statement), body)];
                    statement.kind = StatementKind::If { branches, otherwise: Vec::new() };
                }
                None => self.statement(&mut statement.kind),
            }
        }
    }

    /// The statements of an action that a statement calls.
    fn action(&self, kind: &StatementKind) -> Option<Vec<Statement>> {
        let StatementKind::Expression(Expr { kind: ExprKind::Call { callee, arguments }, .. }) = kind else {
            return None;
        };
        match &callee.kind {
            ExprKind::Name(name) if name.form == NameForm::Bare && arguments.is_empty() => {
                self.actions.get(&name.text.to_lowercase()).cloned()
            }
            _ => None,
        }
    }

    /// A local variable, or one of the POU with an address.
    fn is_local(&self, key: &str) -> bool {
        self.locals.contains(key) || self.located.contains_key(key)
    }

    /// Whether the name belongs to a function, block or variable of the project rather than to the standard.
    pub fn is_own(&self, name: &str) -> bool {
        let key = name.to_lowercase();
        self.is_local(&key)
            || self.shared.pous.contains(&key)
            || self.shared.globals.contains_key(&key) && !self.hidden.contains(&key)
    }

    fn statement(&self, kind: &mut StatementKind) {
        if let StatementKind::Expression(call) = kind
            && let Some(assignment) = self.flip_flop(call)
        {
            *kind = assignment;
        }
        match kind {
            StatementKind::Expression(value) => self.expr(value),
            StatementKind::Assign { targets, value } => {
                if let [(target, AssignOp::Set)] = targets.as_slice() {
                    self.truncated(target, value);
                }
                let kinds: Vec<Option<Ty>> = targets.iter_mut().map(|(target, _)| self.typed(target)).collect();
                let mut given = self.typed(value);
                if let [(target, AssignOp::Set)] = targets.as_slice()
                    && let Some(call) = texts::assignment(target, value)
                {
                    *kind = StatementKind::Expression(call);
                    return;
                }
                targets.iter_mut().for_each(|(target, _)| texts::as_place(target));
                if let Some(float) = kinds.iter().flatten().find(|kind| kind.is_float()) {
                    floats::of_bits(value, &mut given, float);
                }
                kinds.iter().flatten().for_each(|kind| self.in_range(kind, value));
            }
            StatementKind::If { branches, otherwise } => {
                for (condition, body) in branches {
                    self.expr(condition);
                    self.statements(body);
                }
                self.statements(otherwise);
            }
            StatementKind::Case { selector, arms, otherwise } => {
                self.expr(selector);
                for arm in arms {
                    for CaseValue { low, high } in &mut arm.values {
                        self.expr(low);
                        high.iter_mut().for_each(|high| self.expr(high));
                    }
                    self.statements(&mut arm.body);
                }
                self.statements(otherwise);
            }
            StatementKind::For { variable, start, end, step, body } => {
                [variable, start, end].into_iter().chain(step).for_each(|value| self.expr(value));
                self.statements(body);
            }
            StatementKind::While { condition, body } => {
                self.expr(condition);
                self.statements(body);
            }
            StatementKind::Repeat { body, until } => {
                self.statements(body);
                self.expr(until);
            }
            StatementKind::Return(Some(value)) => self.expr(value),
            StatementKind::Empty
            | StatementKind::Label(_)
            | StatementKind::Exit
            | StatementKind::Continue
            | StatementKind::Return(None)
            | StatementKind::Goto(_)
            | StatementKind::Pragma(_)
            | StatementKind::Error => {}
        }
    }

    /// Resolves the names of an expression.
    pub fn expr(&self, value: &mut Expr) {
        self.typed(value);
    }

    /// As [`Scope::typed`], of what a call assigns.
    fn target(&self, value: &mut Expr) -> Option<Ty> {
        let kind = self.typed(value);
        texts::as_place(value);
        kind
    }

    /// Resolves the names of an expression, and returns its type as far as it is known.
    pub fn typed(&self, value: &mut Expr) -> Option<Ty> {
        match &mut value.kind {
            ExprKind::Name(name) if name.form == NameForm::Bare => {
                let kind = self.variable_type(&name.text);
                if let Some(kind) = self.name(name) {
                    value.kind = kind;
                }
                return kind;
            }
            ExprKind::Absolute(operand) => {
                let place = Location::of_operand(operand).and_then(|location| self.shared.addresses.place(&location));
                if let Some(place) = place {
                    *operand = place.operand();
                }
            }
            ExprKind::Member { base, name } => {
                let list = match &base.kind {
                    ExprKind::Name(list) => self.shared.lists.contains_key(&list.text.to_lowercase()),
                    _ => false,
                };
                let known = if list { self.shared.types.global(&name.text.to_lowercase()) } else { None };
                if let Some(kind) = self.qualified(base, name) {
                    value.kind = kind;
                    return known;
                }
                // The output of a flip-flop is its state.
                let is_state = matches!(&base.kind, ExprKind::Name(base) if self.flip_flops.contains_key(&base.text.to_lowercase()))
                    && (name.text.eq_ignore_ascii_case("Q1") || name.text.eq_ignore_ascii_case("Q"));
                let kind = self.typed(base);
                let kind = kind.and_then(|kind| self.shared.types.member(&kind, &name.text.to_lowercase()));
                if is_state {
                    value.kind = base.kind.clone();
                }
                return kind;
            }
            ExprKind::MemberAbsolute { base, .. } | ExprKind::Slice { base, .. } => self.expr(base),
            ExprKind::Index { base, indices } => {
                let kind = self.typed(base);
                indices.iter_mut().for_each(|index| self.expr(index));
                return match kind {
                    Some(Ty::Array(element)) => Some(self.shared.types.resolved(*element)),
                    Some(text @ (Ty::Text | Ty::WideText)) if self.shared.editor == Editor::Codesys => {
                        let [index] = indices.as_slice() else { return None };
                        let is_wide = text == Ty::WideText;
                        value.kind = texts::element((**base).clone(), index.clone(), is_wide, value.span);
                        Some(Ty::Of(if is_wide { Elementary::Word } else { Elementary::Byte }))
                    }
                    _ => None,
                };
            }
            ExprKind::Call { callee, arguments } => {
                let typed = |argument: &mut Argument| {
                    let value = argument.value.as_mut()?;
                    if argument.output { self.target(value) } else { self.typed(value) }
                };
                let mut kinds: Vec<Option<Ty>> = arguments.iter_mut().map(typed).collect();
                self.passed_to_floats(callee, arguments, &mut kinds);
                let result = match &callee.kind {
                    ExprKind::Name(name) => self.shared.types.result(&name.text.to_ascii_uppercase(), &kinds),
                    _ => None,
                };
                let standard = match &callee.kind {
                    ExprKind::Name(name) if name.form == NameForm::Bare && !self.is_own(&name.text) => {
                        Some(name.clone())
                    }
                    _ => None,
                };
                if let Some(name) = standard {
                    for formal in arguments.iter_mut().filter_map(|argument| argument.name.as_mut()) {
                        if let Some(known) = texts::input(&name.text, &formal.text) {
                            formal.text = known.to_string();
                        }
                    }
                    let mut tell = |message: Diagnostic| self.messages.borrow_mut().push(message);
                    if let Some(kind) =
                        functions::rewritten(self.shared.editor, &name, arguments, &kinds, value.span, &mut tell)
                    {
                        value.kind = kind;
                        return result;
                    }
                }
                self.expr(callee);
                return result;
            }
            ExprKind::Dereference(base) | ExprKind::Reference(base) => self.expr(base),
            ExprKind::Unary { operand, .. } => return self.typed(operand),
            ExprKind::Binary { op, op_span, left, right } => {
                let (mut a, mut b) = (self.typed(left), self.typed(right));
                match (a.clone(), b.clone()) {
                    (Some(float), _) if float.is_float() => floats::of_bits(right, &mut b, &float),
                    (_, Some(float)) if float.is_float() => floats::of_bits(left, &mut a, &float),
                    _ => {}
                }
                let (op, op_span) = (*op, *op_span);
                let kind = types::operation(op, a.as_ref(), b.as_ref());
                let mut tell = |message: Diagnostic| self.messages.borrow_mut().push(message);
                let (left, right) = ((&**left, &a), (&**right, &b));
                if let Some(rewritten) = functions::operation(op, op_span, left, right, value.span, &mut tell) {
                    value.kind = rewritten;
                }
                return kind;
            }
            ExprKind::Literal(Literal::Typed { ty: Elementary::Ldt, .. }) => return Some(Ty::DateAndTime),
            ExprKind::Literal(Literal::Typed { ty, .. }) => return Some(Ty::Of(*ty)),
            ExprKind::Literal(Literal::Real(_)) => return Some(Ty::Of(Elementary::Real)),
            ExprKind::Literal(Literal::Text { .. }) => return Some(Ty::Text),
            ExprKind::Literal(_) | ExprKind::Name(_) | ExprKind::Error => {}
        }
        None
    }

    /// Converts bit strings that a call passes to floats; `kinds`: the types of the arguments.
    fn passed_to_floats(&self, callee: &Expr, arguments: &mut [Argument], kinds: &mut [Option<Ty>]) {
        let ExprKind::Name(called) = &callee.kind else { return };
        let function = called.text.to_lowercase();
        let is_function = !self.is_local(&function) && self.shared.pous.contains(&function);
        let block = if is_function { Some(Ty::Named(function.clone())) } else { self.variable_type(&called.text) };
        let standard = if self.is_own(&called.text) { None } else { floats::inputs(&called.text, kinds) };
        for (at, (argument, kind)) in arguments.iter_mut().zip(kinds).enumerate() {
            let formal = match &argument.name {
                Some(_) if argument.output => None,
                Some(name) => Some(name.text.to_lowercase()),
                None if is_function => self.shared.types.input(&function, at),
                None => None,
            };
            let of_block =
                block.as_ref().zip(formal).and_then(|(block, formal)| self.shared.types.member(block, &formal));
            let of_function = standard.as_ref().filter(|(first, _)| at >= *first).map(|(_, ty)| ty.clone());
            if let (Some(float), Some(value)) = (of_block.or(of_function), &mut argument.value) {
                floats::of_bits(value, kind, &float);
            }
        }
    }

    /// The type of a variable of the POU, or of a global one.
    fn variable_type(&self, name: &str) -> Option<Ty> {
        let key = name.to_lowercase();
        if let Some(kind) = self.kinds.get(&key) {
            return Some(self.shared.types.resolved(kind.clone()));
        }
        if self.hidden.contains(&key) { None } else { self.shared.types.global(&key) }
    }

    /// Reports a constant that a variable of a subrange type cannot have.
    fn in_range(&self, kind: &Ty, value: &Expr) {
        if let Some(message) = types::out_of_range(kind, value) {
            self.messages.borrow_mut().push(message);
        }
    }

    /// The call of a flip-flop as the assignment of its state: `s := S1 OR s AND NOT R` or `s := (S OR s) AND NOT R1`.
    fn flip_flop(&self, call: &Expr) -> Option<StatementKind> {
        let ExprKind::Call { callee, arguments } = &call.kind else { return None };
        let ExprKind::Name(name) = &callee.kind else { return None };
        let kind = *self.flip_flops.get(&name.text.to_lowercase())?;
        let span = call.span;
        let expr = |kind: ExprKind| Expr { kind, span };
        let (mut set, mut reset, mut targets) = (None, None, Vec::new());
        for (at, argument) in arguments.iter().enumerate() {
            let formal = argument.name.as_ref().map(|name| functions::flip_flop_pin(&name.text).to_ascii_uppercase());
            let value = argument.value.clone();
            match (formal.as_deref(), argument.output, at) {
                (Some("S" | "S1"), false, _) | (None, false, 0) => set = value,
                (Some("R" | "R1"), false, _) | (None, false, 1) => reset = value,
                (Some("Q" | "Q1"), true, _) => targets.extend(value.map(|target| (target, AssignOp::Set))),
                _ => return None,
            }
        }
        let combine = |op, left, right| {
            expr(ExprKind::Binary { op, op_span: span, left: Box::new(left), right: Box::new(right) })
        };
        let set_or = |value: Expr, set: Option<Expr>| match set {
            Some(set) => combine(BinaryOp::Or, set, value),
            None => value,
        };
        let unless_reset = |value: Expr| match reset {
            Some(reset) => {
                let not = expr(ExprKind::Unary { op: UnaryOp::Not, operand: Box::new(reset) });
                combine(BinaryOp::And, value, not)
            }
            None => value,
        };
        let state = (**callee).clone();
        let value = match kind {
            FlipFlop::SetWins => set_or(unless_reset(state.clone()), set),
            FlipFlop::ResetWins => unless_reset(set_or(state.clone(), set)),
        };
        targets.push((state, AssignOp::Set));
        Some(StatementKind::Assign { targets, value })
    }

    /// `i := TRUNC(r)`: with a type that the target has.
    fn truncated(&self, target: &Expr, value: &mut Expr) {
        let ExprKind::Name(variable) = &target.kind else { return };
        let Some(ty) = self.types.get(&variable.text.to_lowercase()) else { return };
        let ExprKind::Call { callee, .. } = &mut value.kind else { return };
        if let ExprKind::Name(name) = &mut callee.kind
            && name.text.eq_ignore_ascii_case("TRUNC")
            && !self.is_own(&name.text)
            && functions::INTEGERS.contains(&ty.as_str())
        {
            name.text = format!("TRUNC_{ty}");
        }
    }

    /// `Color.Red`, `List.variable`, `Program.variable`.
    fn qualified(&self, base: &mut Expr, member: &Name) -> Option<ExprKind> {
        let ExprKind::Name(name) = &mut base.kind else { return None };
        let key = name.text.to_lowercase();
        if name.form != NameForm::Bare || self.is_local(&key) || self.shared.globals.contains_key(&key) {
            return None;
        }
        let wanted = member.text.to_lowercase();
        if let Some(number) = self.shared.enums.get(&key).and_then(|values| values.get(&wanted)) {
            return Some(integer(*number, member.span).kind);
        }
        if let Some(list) = self.shared.lists.get(&key) {
            return match list.get(&wanted) {
                Some(global) => Some(global_kind(global, member)),
                // A constant of the list, of which the POU has a copy.
                None => Some(ExprKind::Name(Name { form: NameForm::Bare, ..member.clone() })),
            };
        }
        if let Some(instance) = self.shared.programs.get(&key) {
            (name.text, name.form) = (instance.clone(), NameForm::Quoted);
        }
        None
    }

    fn name(&self, name: &Name) -> Option<ExprKind> {
        let key = name.text.to_lowercase();
        if let Some(tag) = self.located.get(&key) {
            return Some(ExprKind::Name(Name { text: tag.clone(), form: NameForm::Quoted, span: name.span }));
        }
        if self.locals.contains(&key) {
            return Some(ExprKind::Name(Name { form: NameForm::Local, ..name.clone() }));
        }
        if !self.hidden.contains(&key) {
            if let Some(global) = self.shared.globals.get(&key) {
                return Some(global_kind(global, name));
            }
            if let Some(instance) = self.shared.programs.get(&key) {
                let name = Name { text: instance.clone(), form: NameForm::Quoted, span: name.span };
                return Some(ExprKind::Name(name));
            }
        }
        // `MW4`, `T5` and `DB1` are not addresses here: addresses have `%`.
        (absolute(&name.text).is_some() || area_word(&name.text).is_some())
            .then(|| ExprKind::Name(Name { form: NameForm::Quoted, ..name.clone() }))
    }
}

fn global_kind(global: &Global, name: &Name) -> ExprKind {
    let quoted = |text: &str| ExprKind::Name(Name { text: text.to_string(), form: NameForm::Quoted, span: name.span });
    match global {
        Global::Tag(tag) => quoted(tag),
        Global::Component(component) => {
            let base = Box::new(Expr { kind: quoted(GLOBALS), span: name.span });
            ExprKind::Member { base, name: Name { text: component.clone(), ..name.clone() } }
        }
    }
}

/// TRUE, at the position of a statement.
fn always(statement: &Statement) -> Expr {
    let literal = plcc_syntax::scl::ast::Literal::Typed { ty: plcc_syntax::Elementary::Bool, bits: 1 };
    Expr { kind: ExprKind::Literal(literal), span: statement.span }
}
