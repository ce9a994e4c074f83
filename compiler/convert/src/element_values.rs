//! Start values of single elements, which XML has, as lists: `(names := ['a', 'b'])`. Only the data types say where an array in a structure
//! begins, and they may be in other sources.

use std::collections::HashMap;

use plcc_syntax::ast::{
    Block, BlockName, Bound, CodeKind, InitialKind, InitialValue, SourceUnit, TypeKind, TypeRef, Variable,
};

/// The components of the data types and function blocks of a program.
pub struct Components {
    /// By folded names.
    members: HashMap<String, Vec<Variable>>,
}

impl Components {
    pub fn new<'a>(units: impl Iterator<Item = &'a SourceUnit>) -> Components {
        let declared = units.flat_map(|unit| &unit.blocks).filter_map(|block| match block {
            Block::Type(block) => Some((&block.name, block.members.clone())),
            Block::Code(block) if block.kind == CodeKind::Fb => {
                let members = block.sections.iter().flat_map(|section| section.variables.clone()).collect();
                Some((&block.name, members))
            }
            Block::Code(_) | Block::Data(_) => None,
        });
        let members = declared.filter_map(|(name, members)| match name {
            BlockName::Symbol { name, .. } => Some((name.to_lowercase(), members)),
            BlockName::Numbered { .. } => None,
        });
        Components { members: members.collect() }
    }

    /// Makes lists of the values of elements in structures, in the declarations of blocks with code and of data types. Values of data blocks
    /// stay: they are assigned one by one.
    pub fn list_elements(&self, unit: &mut SourceUnit) {
        for block in &mut unit.blocks {
            match block {
                Block::Code(block) => {
                    block.sections.iter_mut().for_each(|section| self.variables(&mut section.variables));
                    for constant in &mut block.constants {
                        if let (Some(ty), Some(value)) = (&constant.ty, &mut constant.initial) {
                            self.value(value, ty);
                        }
                    }
                }
                Block::Type(block) => self.variables(&mut block.members),
                Block::Data(_) => {}
            }
        }
    }

    fn variables(&self, variables: &mut [Variable]) {
        for variable in variables {
            if let Some(value) = &mut variable.initial {
                self.value(value, &variable.ty);
            }
            self.structure(&mut variable.ty);
        }
    }

    fn structure(&self, ty: &mut TypeRef) {
        match &mut ty.kind {
            TypeKind::Struct(members) => self.variables(members),
            TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. } => self.structure(element),
            TypeKind::Named(_)
            | TypeKind::String(_)
            | TypeKind::WideString(_)
            | TypeKind::Reference(_)
            | TypeKind::Block(_)
            | TypeKind::Error => {}
        }
    }

    /// Makes lists of the values of elements in a start value, whose own elements may have gaps between them.
    fn value(&self, value: &mut InitialValue, ty: &TypeRef) {
        match (&mut value.kind, &ty.kind) {
            (InitialKind::Elements(elements), TypeKind::Array { element, .. }) => {
                elements.iter_mut().for_each(|(_, value)| self.value(value, element));
            }
            (InitialKind::Fields(fields), _) => {
                let Some(members) = self.members(ty) else { return };
                for (name, value) in fields {
                    let is_own = |member: &&Variable| {
                        name.as_ref().is_some_and(|name| name.text.eq_ignore_ascii_case(&member.name))
                    };
                    if let Some(member) = members.iter().find(is_own) {
                        self.value(value, &member.ty);
                        self.list(value, &member.ty);
                    }
                }
            }
            (InitialKind::List(values) | InitialKind::Repeat { values, .. }, TypeKind::Array { element, .. }) => {
                values.iter_mut().for_each(|value| self.value(value, element));
            }
            _ => {}
        }
    }

    fn list(&self, value: &mut InitialValue, ty: &TypeRef) {
        if let (InitialKind::Elements(elements), TypeKind::Array { bounds, .. }) = (&value.kind, &ty.kind)
            && let Some(list) = without_gaps(elements, bounds)
        {
            value.kind = InitialKind::List(list);
        }
    }

    fn members<'t>(&'t self, ty: &'t TypeRef) -> Option<&'t [Variable]> {
        let name = match &ty.kind {
            TypeKind::Struct(members) => return Some(members),
            TypeKind::Block(BlockName::Symbol { name, .. }) | TypeKind::Named(name) => name,
            TypeKind::Block(BlockName::Numbered { .. })
            | TypeKind::String(_)
            | TypeKind::WideString(_)
            | TypeKind::Array { .. }
            | TypeKind::OpenArray { .. }
            | TypeKind::Reference(_)
            | TypeKind::Error => return None,
        };
        self.members.get(&name.to_lowercase()).map(Vec::as_slice)
    }
}

/// The values of an array from its first element on; `None`: one before the last is not there.
fn without_gaps(elements: &[(Vec<i64>, InitialValue)], bounds: &[(Bound, Bound)]) -> Option<Vec<InitialValue>> {
    let mut limits = Vec::new();
    for bounds in bounds {
        let (Bound::Number(low, _), Bound::Number(high, _)) = bounds else { return None };
        limits.push((*low, *high));
    }
    let mut next: Vec<i64> = limits.iter().map(|(low, _)| *low).collect();
    let mut list = Vec::new();
    for (index, value) in elements {
        if *index != next {
            return None;
        }
        list.push(value.clone());
        // The last index counts first.
        for (at, (low, high)) in next.iter_mut().zip(&limits).rev() {
            *at += 1;
            if *at <= *high {
                break;
            }
            *at = *low;
        }
    }
    Some(list)
}
