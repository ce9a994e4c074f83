//! The type of references, `REF_TO`.

use std::rc::Rc;

use plcc_diag::Span;
use plcc_model::layout;
use plcc_model::types::{DataType, StructType};
use plcc_syntax::Elementary;
use plcc_syntax::ast::TypeRef;

use crate::bind::declarations::Declarations;
use crate::bind::declarations::typed::{StructBuilder, Typed, Use, elementary_typed};

impl Declarations<'_> {
    /// `REF_TO target`.
    pub fn reference_type(&mut self, target: &TypeRef, span: Span) -> Option<Typed> {
        let target = self.resolve_type(target, Use::Component)?.ty;
        let mut builder = StructBuilder::default();
        for (name, ty) in [("DB", Elementary::Word), ("BIT", Elementary::Int), ("BYTE", Elementary::Dint)] {
            builder.add(name.to_string(), &elementary_typed(ty));
        }
        let typed = self.finish_structure(builder, String::new(), None, span)?;
        Some(Typed { ty: reference_to(&typed.ty, &target), image: typed.image })
    }
}

/// The structure of a reference, as one to `target`.
pub fn reference_to(structure: &StructType, target: &DataType) -> DataType {
    let name = format!("REF_TO {}", layout::type_name(target));
    DataType::Struct(Rc::new(StructType { name, refers_to: Some(target.clone()), ..structure.clone() }))
}
