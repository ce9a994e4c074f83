//! Operands of STL of the S7-200.

use std::collections::HashSet;

use plcc_diag::Span;
use plcc_syntax::s7200::ast::{Direct, Operand, OperandKind, Source, StatementKind, SymbolForm};
use plcc_syntax::s7200::{OperandClass, address};

use super::{Editor, To};
use crate::awl;

impl Editor<'_> {
    pub(super) fn s7200(&mut self, source: &Source) {
        for block in &source.blocks {
            let locals: HashSet<String> = block.declarations.iter().map(|one| fold(&one.name)).collect();
            for statement in block.networks.iter().flat_map(|network| &network.statements) {
                let StatementKind::Instruction { insn, operands, .. } = &statement.kind else { continue };
                let classes = insn.operands();
                for (at, operand) in operands.iter().enumerate() {
                    let text = classes.get(at).is_some_and(|class| matches!(class, OperandClass::StringIn));
                    self.s7200_operand(operand, &locals, text);
                }
            }
        }
        for line in &source.data {
            line.address.iter().for_each(|operand| self.s7200_operand(operand, &HashSet::new(), false));
        }
    }

    fn s7200_operand(&mut self, operand: &Operand, locals: &HashSet<String>, may_be_text: bool) {
        let is_local = |name: &str, form: SymbolForm| match form {
            SymbolForm::Local => true,
            SymbolForm::Bare => locals.contains(&fold(name)),
            SymbolForm::Quoted => false,
        };
        match (&operand.kind, self.to) {
            (OperandKind::Indirect(inner) | OperandKind::AddressOf(inner), _) => {
                self.s7200_operand(inner, locals, false);
            }
            (OperandKind::Symbol { name, form }, To::Absolute) => {
                if !is_local(name, *form)
                    && let Some(direct) = self.address_of(name)
                {
                    self.edit(operand.span, awl::address(&direct, self.set));
                }
            }
            // `Start:I0.0`
            (OperandKind::Direct(direct), To::Absolute)
                if operand.shown.as_ref().is_some_and(|shown| !is_local(&shown.name, shown.form)) =>
            {
                self.edit(operand.span, awl::address(direct, self.set));
            }
            (OperandKind::Direct(direct), To::Symbolic) => self.s7200_symbol(direct, operand.span, locals, may_be_text),
            (
                OperandKind::Direct(_)
                | OperandKind::Symbol { .. }
                | OperandKind::Constant(_)
                | OperandKind::Block { .. }
                | OperandKind::Error,
                _,
            ) => {}
        }
    }

    /// The address of a symbol; none of constants and blocks.
    fn address_of(&self, name: &str) -> Option<Direct> {
        let wanted = fold(name);
        let row = self.names.s7200.iter().find(|row| fold(&row.name) == wanted)?;
        address::parse(&row.address.trim().to_uppercase())?.ok()
    }

    fn s7200_symbol(&mut self, direct: &Direct, span: Span, locals: &HashSet<String>, may_be_text: bool) {
        let text = address::text(direct);
        let is_same = |address: &str| {
            let parsed = address::parse(&address.trim().to_uppercase());
            matches!(parsed, Some(Ok(own)) if address::text(&own) == text)
        };
        let mut found: Vec<&str> = Vec::new();
        for row in self.names.s7200.iter().filter(|row| is_same(&row.address)) {
            if !found.iter().any(|other| fold(other) == fold(&row.name)) {
                found.push(&row.name);
            }
        }
        match found.as_slice() {
            [] => {}
            [name] => {
                let is_bare = crate::names::declared(name) == *name
                    && !locals.contains(&fold(name))
                    && address::parse(&name.to_uppercase()).is_none();
                match is_bare {
                    true => self.edit(span, (*name).to_string()),
                    // In quotes, a name is a text where a text can be.
                    false if may_be_text => {}
                    false => self.edit(span, format!("\"{name}\"")),
                }
            }
            several => {
                let why = format!("it has {} symbols: {}", several.len(), several.join(", "));
                self.stays(span, &text, &why, "leave one of them in the symbol tables");
            }
        }
    }
}

/// Names are equal in either letter case, with `_` for blanks.
fn fold(name: &str) -> String {
    name.trim().to_lowercase().replace(' ', "_")
}
