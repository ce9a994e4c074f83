//! Operands of STL.

use plcc_diag::Span;
use plcc_syntax::ast::{
    Area, BlockName, BlockPrefix, Operand, OperandKind, Path, PathRoot, Statement, StatementKind, Width,
};
use plcc_syntax::symbols::SymbolTarget;

use super::names::Component;
use super::{Editor, To};
use crate::names;
use crate::operand::{address, area_letters, cell_letter};

impl Editor<'_> {
    pub(super) fn stl_statement(&mut self, statement: &Statement) {
        match &statement.kind {
            StatementKind::Instruction { operand, .. } => operand.iter().for_each(|operand| self.stl_operand(operand)),
            StatementKind::Call(call) => {
                self.stl_operand(&call.target);
                call.instance.iter().for_each(|instance| self.stl_operand(instance));
                call.parameters
                    .iter()
                    .filter_map(|one| one.actual.as_ref())
                    .for_each(|actual| self.stl_operand(actual));
            }
            // Assertions say what their author means.
            StatementKind::Empty | StatementKind::Pragma(_) | StatementKind::Error => {}
        }
    }

    fn stl_operand(&mut self, operand: &Operand) {
        let span = operand.span;
        match &operand.kind {
            OperandKind::Absolute { area, width, byte, bit } => {
                let named = matches!(area, Area::I | Area::Q | Area::M | Area::Pi | Area::Pq);
                if self.to == To::Symbolic && named {
                    let target = SymbolTarget::Memory { area: *area, width: *width, byte: *byte, bit: *bit };
                    self.named(target, span);
                }
            }
            OperandKind::Cell { kind, number } => {
                if self.to == To::Symbolic {
                    self.named(SymbolTarget::Cell { kind: *kind, number: *number }, span);
                }
            }
            OperandKind::DbAbsolute { db, width, byte, bit } => self.db_address(db, (*width, *byte, *bit), span),
            OperandKind::MemoryIndirect { pointer, .. }
            | OperandKind::CellIndirect { pointer, .. }
            | OperandKind::BlockIndirect { pointer, .. } => self.stl_operand(pointer),
            OperandKind::Block(name) => self.block_name(name),
            OperandKind::Path(path) => self.stl_path(path, span),
            OperandKind::Peripheral(path) | OperandKind::AddressOf(path) => {
                if self.to == To::Absolute
                    && !self.is_local(&path.root)
                    && let PathRoot::Quoted { name, .. } | PathRoot::Bare { name, .. } = &path.root
                {
                    self.stays(
                        span,
                        name,
                        "an operand with `:P` or `P#` before it has no other form",
                        "write its address yourself",
                    );
                }
            }
            OperandKind::RegisterIndirect { .. }
            | OperandKind::Literal(_)
            | OperandKind::Status(_)
            | OperandKind::Special(_)
            | OperandKind::Register(_)
            | OperandKind::Label(_)
            | OperandKind::Error => {}
        }
    }

    /// An address that may have a symbol.
    fn named(&mut self, target: SymbolTarget, span: Span) {
        let Some(found) = self.the_symbol(target, span) else { return };
        let natural = match target {
            SymbolTarget::Memory { width, .. } => Self::is_natural(found.ty, width),
            SymbolTarget::Cell { .. } | SymbolTarget::Block { .. } => true,
        };
        if !natural && self.names.is_pointer(span) {
            return self.not_natural(span, &found.name);
        }
        self.edit(span, names::symbol(&found.name));
    }

    /// `DB10.DBW 4`, which may be a component.
    fn db_address(&mut self, db: &BlockName, (width, byte, bit): (Width, u32, u8), span: Span) {
        let Some(number) = self.names.db_number(db) else { return self.db_without_number(db) };
        match self.to {
            To::Absolute => {
                if matches!(db, BlockName::Symbol { .. }) {
                    self.edit(
                        span,
                        self.stl_component(&Component {
                            db: number,
                            width,
                            byte,
                            bit,
                            ty: plcc_syntax::Elementary::Bool,
                        }),
                    );
                }
            }
            To::Symbolic => {
                let Some((path, ty)) = self.names.path(number, width, byte, bit) else {
                    // The name of the block alone would also be one.
                    return;
                };
                if !Self::is_natural(Some(ty), width) && self.names.is_pointer(span) {
                    return self.not_natural(span, &path);
                }
                let target = SymbolTarget::Block { prefix: BlockPrefix::Db, number: u32::from(number) };
                let root = match self.the_symbol(target, span) {
                    Some(found) => names::symbol(&found.name),
                    None => format!("DB{number}"),
                };
                self.edit(span, format!("{root}.{path}"));
            }
        }
    }

    fn stl_path(&mut self, path: &Path, span: Span) {
        if self.is_local(&path.root) {
            return;
        }
        let (root, root_span) = match &path.root {
            PathRoot::Quoted { name, span } | PathRoot::Bare { name, span } => {
                (BlockName::Symbol { name: name.clone(), span: *span }, *span)
            }
            PathRoot::Block(name) => (name.clone(), name.span()),
            PathRoot::Local { .. } => return,
        };
        if !path.parts.is_empty() {
            return self.stl_component_path(&root, root_span, path, span);
        }
        let (To::Absolute, BlockName::Symbol { name, .. }) = (self.to, &root) else { return };
        let Some(found) = self.symbol(name, span) else { return };
        let text = match found.target {
            SymbolTarget::Memory { area, width, byte, bit } => {
                if !Self::is_natural(found.ty, width) && self.names.is_pointer(span) {
                    return self.not_natural(span, &found.name);
                }
                format!("{} {}", area_letters(area, width, self.set), address(width, byte, bit))
            }
            SymbolTarget::Cell { kind, number } => format!("{} {number}", cell_letter(kind, self.set)),
            SymbolTarget::Block { prefix, number } => self.numbered(prefix, number),
        };
        self.edit(span, text);
    }

    /// `"Data".b[2]`: an address, or the name of the block alone.
    fn stl_component_path(&mut self, root: &BlockName, root_span: Span, path: &Path, span: Span) {
        if self.to == To::Symbolic {
            if matches!(root, BlockName::Numbered { .. })
                && let Some(text) = self.block_text(root)
            {
                self.edit(root_span, text);
            }
            return;
        }
        let Some(number) = self.names.db_number(root) else { return self.db_without_number(root) };
        match self.names.component(number, &path.parts) {
            Some(component)
                if Self::is_natural(Some(component.ty), component.width) || !self.names.is_pointer(span) =>
            {
                self.edit(span, self.stl_component(&component));
            }
            Some(_) | None => {
                if matches!(root, BlockName::Symbol { .. }) {
                    self.edit(root_span, format!("DB{number}"));
                }
            }
        }
    }

    /// `DB10.DBW 4`
    fn stl_component(&self, component: &Component) -> String {
        let letters = area_letters(Area::Db, component.width, self.set);
        format!("DB{}.{letters} {}", component.db, address(component.width, component.byte, component.bit))
    }

    fn db_without_number(&mut self, name: &BlockName) {
        if let (To::Absolute, BlockName::Symbol { name, span }) = (self.to, name) {
            self.symbol(name, *span);
        }
    }
}
