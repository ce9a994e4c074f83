//! Texts in temporary data: networks find them empty, statements find what was there before. So the block begins with their heads.

use plcc_syntax::ast::{AddressRegister, Bound, Operand, OperandKind, Path, PathRoot, SectionKind, TypeKind, Width};
use plcc_syntax::literal::Literal;
use plcc_syntax::stl::StlInsn;

use super::Maker;

/// Characters of a text whose declaration names no length.
const USUAL: i64 = 254;

impl Maker<'_> {
    /// The statements that write the heads, before those of the first network.
    pub fn begin_texts(&mut self) {
        let block = self.block;
        let temporary = block.sections.iter().filter(|section| section.kind == SectionKind::Temp);
        for variable in temporary.flat_map(|section| &section.variables).filter(|variable| variable.at.is_none()) {
            let (bound, is_wide) = match &variable.ty.kind {
                TypeKind::String(bound) => (bound, false),
                TypeKind::WideString(bound) => (bound, true),
                _ if self.types.has_texts(&variable.ty) => {
                    let help = "declare the texts one by one, or outside of the temporary data";
                    self.refuse(variable.name_span, "texts in a temporary array or structure", help);
                    continue;
                }
                _ => continue,
            };
            let maximum = match bound {
                None => Some(USUAL),
                Some(Bound::Number(maximum, _)) => Some(*maximum),
                Some(Bound::Name(..) | Bound::Expr(_) | Bound::Path(_)) => None,
            };
            let Some(maximum) = maximum.and_then(|maximum| u16::try_from(maximum).ok()) else {
                let help = "declare its length as a number";
                self.refuse(variable.name_span, "a temporary text whose length is a constant", help);
                continue;
            };
            self.span = variable.name_span;
            let root = PathRoot::Local { name: variable.name.clone(), span: self.span };
            let address = OperandKind::AddressOf(Path { root, parts: Vec::new(), span: self.span });
            self.push_head(StlInsn::Load, address);
            self.push(StlInsn::LoadAr1, None);
            // The maximum, then the length.
            if is_wide {
                self.push_head(StlInsn::Load, OperandKind::Literal(Literal::Dword(u32::from(maximum) << 16)));
                self.push_head(StlInsn::Transfer, in_ar1(Width::Dword));
            } else {
                self.push_head(StlInsn::Load, OperandKind::Literal(Literal::Word(maximum << 8)));
                self.push_head(StlInsn::Transfer, in_ar1(Width::Word));
            }
        }
    }

    fn push_head(&mut self, insn: StlInsn, kind: OperandKind) {
        self.push(insn, Some(Operand { kind, span: self.span }));
    }
}

/// What AR1 points at.
fn in_ar1(width: Width) -> OperandKind {
    OperandKind::RegisterIndirect { area: None, width, register: AddressRegister::Ar1, offset: 0 }
}
