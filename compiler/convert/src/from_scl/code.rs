//! Statements, labels and variables.

use plcc_diag::Span;
use plcc_model::layout;
use plcc_model::types::{DataType, Elementary};
use plcc_syntax::ast::{
    self, Bound, CodeBlock, CodeKind, InitialKind, InitialValue, Label, Operand, OperandKind, Path, PathRoot, Section,
    SectionKind, Statement, StatementKind, TypeKind, TypeRef, Variable,
};
use plcc_syntax::literal::Literal;
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::text::TEXT_MAX;

/// A variable that the block declares besides those of its source.
pub struct Temporary {
    pub name: String,
    pub ty: DataType,
    /// It holds a value that is still to be read.
    pub busy: bool,
}

/// Temporaries that are in use.
pub struct Mark(Vec<bool>);

impl Maker<'_> {
    pub fn push(&mut self, insn: StlInsn, operand: Option<Operand>) {
        self.push_kind(StatementKind::Instruction { insn, mnemonic_span: self.span, operand });
    }

    pub fn push_kind(&mut self, kind: StatementKind) {
        let last = self.pending.last().map(|label| label.span.start);
        // A comment after the place of the label belongs to what follows the label.
        let apart = last.is_some_and(|at| self.positions.has_comment(at, self.span.start));
        let alone = self.pending.len() - usize::from(!apart && last.is_some());
        for label in self.pending.drain(..alone) {
            let operand = Some(number(0, label.span));
            let kind = StatementKind::Instruction { insn: StlInsn::Nop, mnemonic_span: label.span, operand };
            self.statements.push(Statement { span: label.span, label: Some(Box::new(label)), kind });
        }
        self.statements.push(Statement { label: self.pending.pop().map(Box::new), kind, span: self.span });
    }

    /// The next statement has this label; `at`: its place in the source.
    pub fn label(&mut self, name: &str, at: u32) {
        let at = if self.is_chart() { self.span.start } else { at };
        let span = Span { start: at, end: at, ..self.span };
        self.pending.push(Label { name: name.to_string(), span });
    }

    /// Labels at the end stand before a statement that does nothing.
    pub fn close_labels(&mut self) {
        if let Some(label) = self.pending.last() {
            self.go_to(label.span);
            self.push(StlInsn::Nop, Some(number(0, self.span)));
        }
    }

    pub fn new_label(&mut self) -> String {
        loop {
            self.made_labels += 1;
            let name = label_name(self.made_labels);
            if !self.other_labels.contains(&name.to_lowercase()) {
                return name;
            }
        }
    }

    pub fn jump(&mut self, insn: StlInsn, label: &str) {
        self.push(insn, Some(Operand { kind: OperandKind::Label(label.to_string()), span: self.span }));
    }

    /// What follows belongs to this place of the source.
    pub fn at(&mut self, at: u32) {
        self.go_to(Span { start: at, end: at, ..self.span });
    }

    // Variables.

    /// A variable for a value of the current statement.
    pub fn temporary(&mut self, ty: Elementary) -> Operand {
        self.variable(&DataType::Elementary(ty), "value")
    }

    /// The same for any type; the name of the variable begins with `like`.
    pub fn variable(&mut self, ty: &DataType, like: &str) -> Operand {
        let free = self.temporaries.iter().position(|one| one.ty == *ty && !one.busy);
        let at = free.unwrap_or_else(|| {
            let name = self.unused_name(like);
            self.temporaries.push(Temporary { name, ty: ty.clone(), busy: true });
            self.temporaries.len() - 1
        });
        self.temporaries[at].busy = true;
        local(&self.temporaries[at].name, self.span)
    }

    /// A variable for the whole block.
    pub fn kept(&mut self, ty: Elementary, like: &str) -> Operand {
        let name = self.unused_name(like);
        let operand = local(&name, self.span);
        self.temporaries.push(Temporary { name, ty: DataType::Elementary(ty), busy: true });
        operand
    }

    pub fn mark(&self) -> Mark {
        Mark(self.temporaries.iter().map(|one| one.busy).collect())
    }

    /// What got busy after the mark is free.
    pub fn release(&mut self, mark: &Mark) {
        let before = mark.0.iter().copied().chain(std::iter::repeat(false));
        let hidden: Vec<String> = self.hidden.values().filter_map(|(operand, _)| name_of(operand)).collect();
        for (one, busy) in self.temporaries.iter_mut().zip(before) {
            one.busy = busy || hidden.contains(&one.name);
        }
    }

    fn unused_name(&self, like: &str) -> String {
        let declared = |name: &str| {
            let mut variables = self.tree.sections.iter().flat_map(|section| &section.variables);
            let mut constants = self.tree.constants.iter();
            variables.any(|variable| variable.name.eq_ignore_ascii_case(name))
                || constants.any(|constant| constant.name.eq_ignore_ascii_case(name))
                || self.temporaries.iter().any(|one| one.name.eq_ignore_ascii_case(name))
        };
        (1..).map(|number| format!("{like}_{number}")).find(|name| !declared(name)).expect("numbers do not end")
    }

    /// Declares the variables of the block; what an FC or OB of SCL has as static data is temporary.
    pub fn declare(&self, block: &mut CodeBlock) {
        let is_whole = matches!(self.tree.code, ast::Code::Scl(_));
        if is_whole && matches!(block.kind, CodeKind::Fc | CodeKind::Ob | CodeKind::Sfc) {
            let own = block.sections.iter_mut().filter(|section| section.kind == SectionKind::Static);
            own.for_each(|section| section.kind = SectionKind::Temp);
        }
        // The statements have their values.
        if is_whole && !block.sections.iter().flat_map(|section| &section.variables).any(names_constants) {
            block.constants.clear();
        }
        if self.temporaries.is_empty() {
            return;
        }
        let at = self.positions.code_start(self.tree);
        let span = Span { start: at, end: at, ..block.span };
        let variables = self
            .temporaries
            .iter()
            .map(|one| Variable::new(&one.name, TypeRef { kind: declared_type(&one.ty), span }, span));
        let variables = variables.collect();
        block.sections.push(Section { kind: SectionKind::Temp, retain: ast::Retain::Unsaid, variables, span });
    }
}

/// The type of a temporary as its declaration writes it.
fn declared_type(ty: &DataType) -> TypeKind {
    match ty {
        DataType::String(TEXT_MAX) => TypeKind::String(None),
        DataType::String(length) => TypeKind::String(Some(Bound::Number(i64::from(*length), Span::default()))),
        other => TypeKind::Named(layout::type_name(other)),
    }
}

/// `_001` to `_999`, then `_A00` to `_ZZZ`: a label of STEP 7 V5 has four characters.
fn label_name(number: usize) -> String {
    const DIGITS: &[u8; 36] = b"0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ";
    const FIRST_LETTER: usize = 10 * 36 * 36;
    match number.checked_sub(1000).map(|after| after + FIRST_LETTER) {
        Some(code) if code < 36 * 36 * 36 => {
            let digit = |weight: usize| char::from(DIGITS[code / weight % 36]);
            format!("_{}{}{}", digit(36 * 36), digit(36), digit(1))
        }
        Some(_) | None => format!("_{number:03}"),
    }
}

/// Its type or initial value refers to a constant of the block.
fn names_constants(variable: &Variable) -> bool {
    let is_name = |bound: &Bound| !matches!(bound, Bound::Number(..));
    fn of_type(ty: &TypeRef, is_name: &dyn Fn(&Bound) -> bool) -> bool {
        match &ty.kind {
            TypeKind::String(bound) | TypeKind::WideString(bound) => bound.as_ref().is_some_and(is_name),
            TypeKind::Array { bounds, element } => {
                bounds.iter().any(|(low, high)| is_name(low) || is_name(high)) || of_type(element, is_name)
            }
            TypeKind::OpenArray { element, .. } | TypeKind::Reference(element) => of_type(element, is_name),
            TypeKind::Struct(members) => members.iter().any(names_constants),
            TypeKind::Named(_) | TypeKind::Block(_) | TypeKind::Error => false,
        }
    }
    of_type(&variable.ty, &is_name) || variable.initial.as_ref().is_some_and(|value| !is_literal(value))
}

/// A value without names.
fn is_literal(value: &InitialValue) -> bool {
    match &value.kind {
        InitialKind::Literal(_) | InitialKind::Default | InitialKind::Operand(_) => true,
        InitialKind::List(values) => values.iter().all(is_literal),
        InitialKind::Repeat { count, values } => matches!(count, Bound::Number(..)) && values.iter().all(is_literal),
        InitialKind::Elements(values) => values.iter().all(|(_, value)| is_literal(value)),
        InitialKind::Fields(values) => values.iter().all(|(_, value)| is_literal(value)),
        InitialKind::Expr(value) => matches!(value.kind, plcc_syntax::scl::ast::ExprKind::Literal(_)),
    }
}

/// A variable of the block as an operand.
pub fn local(name: &str, span: Span) -> Operand {
    let path = Path { root: PathRoot::Local { name: name.to_string(), span }, parts: Vec::new(), span };
    Operand { kind: OperandKind::Path(path), span }
}

fn name_of(operand: &Operand) -> Option<String> {
    match &operand.kind {
        OperandKind::Path(Path { root: PathRoot::Local { name, .. }, .. }) => Some(name.clone()),
        _ => None,
    }
}

/// A whole number as an operand.
pub fn number(value: i64, span: Span) -> Operand {
    Operand { kind: OperandKind::Literal(Literal::Int(value)), span }
}
