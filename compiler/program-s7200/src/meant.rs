//! What is meant by an instruction whose operands fit together, but not to it: operands in the other order, operands of another width.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::Width;
use plcc_syntax::s7200::ast::{self, Area, Constant, OperandKind, SymbolForm};
use plcc_syntax::s7200::{Compare, CompareKind, Insn, OperandClass};
use plcc_syntax::stl::Mnemonics;

use super::Binder;
use super::interface::{Locals, Type};
use super::names::fold;
use super::operand::{has_area, has_width, is_target, takes_constants, wanted, width};

impl Binder<'_> {
    /// `S 1, Q0.0`, `MOVW VW0, 5`, `TON 10, T37`: a constant in the place of an address, which is the other operand.
    pub fn other_order(&self, locals: &Locals, insn: Insn, operands: &[ast::Operand]) -> Option<Diagnostic> {
        let (&[first_class, second_class], [first, second]) = (insn.operands(), operands) else { return None };
        let orders = [(first, first_class, second, second_class), (second, second_class, first, first_class)];
        let (constant, class, ..) = orders.into_iter().find(|(constant, class, place, other)| {
            is_target(*class)
                && takes_constants(*other)
                && matches!(self.form_of(locals, constant), Form::Constant | Form::Real)
                && matches!(self.form_of(locals, place), Form::Place(direct) if may_be(*class, direct))
        })?;
        let (title, label) = match class {
            OperandClass::Timer | OperandClass::Counter => {
                ("this operand does not fit the instruction (0090)", format!("expected: {}", wanted(class)))
            }
            _ => ("a constant cannot be written (0090)", "the result of the instruction goes here".to_string()),
        };
        let code = if is_number(class) { Code::OperandKind } else { Code::Protected };
        let name = self.mnemonic(insn);
        let (first, second) = (self.written(first.span), self.written(second.span));
        Some(
            Diagnostic::new(code, constant.span, title)
                .label(label)
                .help(format!("the operands are in the other order: write `{name} {second}, {first}`")),
        )
    }

    /// `MOVW VB0, VB1`, `DTI VW0, VD4`, `DIV VW0, VW2`: operands with the widths of another instruction, of a conversion also:
    /// `MOVW VB0, VW2`. Each operand that misfits an instruction which exists for one width only has a message, too: `TON T37, VB0`.
    pub fn other_instruction(&self, locals: &Locals, insn: Insn, operands: &[ast::Operand]) -> Vec<Diagnostic> {
        if operands.len() != insn.operands().len() {
            return Vec::new();
        }
        let forms: Vec<Form> = operands.iter().map(|operand| self.form_of(locals, operand)).collect();
        let ty = |operand: &ast::Operand| match &operand.kind {
            OperandKind::Symbol { name, .. } => locals.find(name).map(|local| local.ty),
            _ => None,
        };
        // Variables of other types have other conversions.
        let is_other = match insn {
            Insn::MovR | Insn::Round | Insn::Trunc => {
                matches!(operands.first().and_then(ty), Some(Type::Dint | Type::Dword))
            }
            Insn::Dtr => false,
            _ => operands.iter().any(|operand| ty(operand) == Some(Type::Real)),
        };
        let conversion: &[Insn] = if is_other { &[] } else { conversion(insn, &forms) };
        let mut misfits = Vec::new();
        for (at, ((operand, form), class)) in operands.iter().zip(&forms).zip(insn.operands()).enumerate() {
            if let (Form::Place(direct), Some(needed)) = (form, width(*class))
                && (has_area(*class, *direct) || !conversion.is_empty())
                && !has_width(*class, *direct)
            {
                misfits.push((at, operand.span, *direct, *class, needed));
            }
        }
        let Some(&(at, span, direct, class, needed)) = misfits.first() else { return Vec::new() };
        let relatives = relatives(insn);
        let list = match operands {
            [first, .., last] => self.written(first.span.to(last.span)),
            _ => self.written(span),
        };
        let others = relatives.iter().copied().filter(|other| fits(*other, &forms));
        let mut statements: Vec<String> = others.map(|other| format!("`{} {list}`", self.mnemonic(other))).collect();
        match (conversion, operands) {
            ([only], _) => {
                let why = if insn == Insn::MovD { " for the value" } else { ", which converts the value" };
                statements.push(format!("`{} {list}`{why}", self.mnemonic(*only)));
            }
            ([first, second], [source, target]) => {
                let has_room = match (first.operands(), forms.last()) {
                    ([.., result], Some(Form::Place(place))) => may_be(*result, *place),
                    _ => false,
                };
                let (source, target) = (self.written(source.span), self.written(target.span));
                let between = if has_room { target.clone() } else { "AC0".to_string() };
                let (first, second) = (self.mnemonic(*first), self.mnemonic(*second));
                statements.push(format!("`{first} {source}, {between}`, then `{second} {between}, {target}`"));
            }
            _ => {}
        }
        if let (Insn::MovD, [first, _], [_, Form::Place(target)]) = (insn, operands, forms.as_slice())
            && first.span == span
            && direct.area != Area::Ai
            && may_be(OperandClass::DwordOut, *target)
        {
            statements.push(format!("`{} &{list}`, which moves its address", self.mnemonic(insn)));
        }
        if statements.is_empty() {
            // If no instruction that does the same has an operand of this width there, the operand is wrong.
            let is_conversion = matches!(insn, Insn::Bti | Insn::Itb | Insn::Itd | Insn::Dti | Insn::Dtr);
            let takes_it = |other: &Insn| other.operands().get(at).is_some_and(|class| has_width(*class, direct));
            if class == OperandClass::Bit || !is_conversion && relatives.iter().any(takes_it) {
                return Vec::new();
            }
            let alone = |(_, span, direct, class, needed): (usize, Span, ast::Direct, OperandClass, Width)| {
                let same = self.of_width(direct, needed, span);
                self.width_message(class, direct, needed, span).help(format!("write {same}"))
            };
            return misfits.into_iter().map(alone).collect();
        }
        vec![self.width_message(class, direct, needed, span).help(format!("write {}", statements.join(" or ")))]
    }

    /// What an operand is, as far as its form and its symbol show.
    pub fn form_of(&self, locals: &Locals, operand: &ast::Operand) -> Form {
        match &operand.kind {
            OperandKind::Direct(direct) => Form::Place(*direct),
            OperandKind::Constant(constant) => Form::of(constant),
            // In double quotes it may be a text.
            OperandKind::Symbol { form: SymbolForm::Quoted, .. } => Form::Other,
            OperandKind::Symbol { name, form } => {
                let local = locals.find(name);
                let global = self.globals.get(&fold(name)).filter(|_| *form != SymbolForm::Local);
                match (local, global.map(|global| &global.target)) {
                    (Some(local), _) if local.ty != Type::String => Form::Place(local.place),
                    (None, Some(OperandKind::Direct(direct))) => Form::Place(*direct),
                    (None, Some(OperandKind::Constant(constant))) => Form::of(constant),
                    _ => Form::Other,
                }
            }
            OperandKind::Indirect(_) | OperandKind::AddressOf(_) | OperandKind::Block { .. } | OperandKind::Error => {
                Form::Other
            }
        }
    }
}

/// Forms of operands.
pub enum Form {
    Place(ast::Direct),
    Constant,
    /// A constant with a point or an exponent.
    Real,
    Other,
}

impl Form {
    fn of(constant: &Constant) -> Form {
        if matches!(constant, Constant::Real(_)) { Form::Real } else { Form::Constant }
    }
}

fn is_number(class: OperandClass) -> bool {
    matches!(class, OperandClass::Timer | OperandClass::Counter)
}

/// Whether the address is in an area and of a width that the class accepts.
fn may_be(class: OperandClass, direct: ast::Direct) -> bool {
    has_area(class, direct) && has_width(class, direct)
}

/// Whether the operands are those of `insn`.
fn fits(insn: Insn, forms: &[Form]) -> bool {
    let classes = insn.operands();
    classes.len() == forms.len()
        && forms.iter().zip(classes).all(|(form, class)| match form {
            Form::Place(direct) => may_be(*class, *direct),
            Form::Constant => takes_constants(*class),
            Form::Real => *class == OperandClass::RealIn,
            Form::Other => false,
        })
}

/// The conversions to write with these operands in place of `insn`, a move or a single conversion.
fn conversion(insn: Insn, forms: &[Form]) -> &'static [Insn] {
    let [Form::Place(source), Form::Place(target)] = forms else { return &[] };
    let width = match source.area {
        Area::T | Area::C => Some(Width::Word),
        _ => source.width,
    };
    let list: &[Insn] = match (insn, width, target.width) {
        (Insn::MovR | Insn::Dtr, Some(Width::Word), Some(Width::Dword)) => &[Insn::Itd, Insn::Dtr],
        (Insn::MovR | Insn::Round, Some(Width::Dword), Some(Width::Word)) => &[Insn::Round, Insn::Dti],
        (Insn::Trunc, Some(Width::Dword), Some(Width::Word)) => &[Insn::Trunc, Insn::Dti],
        (Insn::Itd | Insn::Bti, Some(Width::Byte), Some(Width::Dword)) => &[Insn::Bti, Insn::Itd],
        (Insn::MovB | Insn::MovW | Insn::MovD, Some(width), Some(target)) => match (width, target) {
            (Width::Byte, Width::Word) => &[Insn::Bti],
            (Width::Word, Width::Byte) => &[Insn::Itb],
            (Width::Word, Width::Dword) => &[Insn::Itd],
            (Width::Dword, Width::Word) => &[Insn::Dti],
            _ => &[],
        },
        _ => &[],
    };
    let classes = |at: usize| list.get(at).map_or::<&[OperandClass], _>(&[], |insn| insn.operands());
    match (classes(0), classes(list.len().saturating_sub(1))) {
        ([from, _], [_, to]) if may_be(*from, *source) && may_be(*to, *target) => list,
        _ => &[],
    }
}

/// Instructions that do the same with operands of other widths, and conversions in the other direction.
fn relatives(insn: Insn) -> Vec<Insn> {
    const WIDTHS: [char; 5] = ['B', 'W', 'D', 'I', 'R'];
    match insn {
        Insn::Compare(own) => {
            let kinds = CompareKind::ALL.into_iter().filter(|kind| *kind != own.kind && *kind != CompareKind::Text);
            return kinds.map(|kind| Insn::Compare(Compare { kind, ..own })).collect();
        }
        Insn::Mul => return vec![Insn::MulI, Insn::MulD],
        Insn::Div => return vec![Insn::DivI, Insn::DivD],
        _ => {}
    }
    let name = insn.mnemonic(Mnemonics::En);
    let Some(stem) = name.strip_suffix(WIDTHS).filter(|stem| !stem.is_empty()) else { return Vec::new() };
    let reversed = match name.as_bytes() {
        [b'B' | b'I' | b'D', b'T', b'B' | b'I' | b'D'] => name.chars().rev().collect(),
        _ => String::new(),
    };
    let is_relative = |other: &Insn| {
        let other = other.mnemonic(Mnemonics::En);
        other != name && (other == reversed || other.strip_suffix(WIDTHS) == Some(stem))
    };
    Insn::ROWS.iter().copied().filter(is_relative).collect()
}
