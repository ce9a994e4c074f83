//! The interface of a block and the components of a data block, as rows of a table.

use std::collections::HashMap;

use plcc_abi::image::BlockKind;
use plcc_diag::Span;
use plcc_syntax::ast::{
    self, BlockName, Bound, CodeKind, DataContent, Path, PathPart, PathRoot, SectionKind, SourceUnit, TypeKind,
    TypeRef, Variable,
};

use super::{Declaration, Maker, Page};
use crate::data;

/// What a source declares by a name: a data type, or a function block.
pub(super) struct Declared<'a> {
    /// What the places of the variables are in.
    text: &'a str,
    unit: &'a SourceUnit,
    /// The variables that a variable of this type has, section by section.
    variables: Vec<&'a [Variable]>,
}

/// The data types and function blocks of the sources.
pub(super) fn declared<'a>(units: &[(&'a str, &'a SourceUnit)]) -> HashMap<String, Declared<'a>> {
    let mut found = HashMap::new();
    for &(text, unit) in units {
        let text = unit.overlay.as_deref().unwrap_or(text);
        for block in &unit.blocks {
            let (name, variables) = match block {
                ast::Block::Code(block) if block.kind == CodeKind::Fb => {
                    let lasting = block.sections.iter().filter(|section| section.kind != SectionKind::Temp);
                    (&block.name, lasting.map(|section| section.variables.as_slice()).collect())
                }
                ast::Block::Type(block) => (&block.name, vec![block.members.as_slice()]),
                ast::Block::Code(_) | ast::Block::Data(_) => continue,
            };
            found.entry(key(name)).or_insert(Declared { text, unit, variables });
        }
    }
    found
}

/// A name in small letters; numbered blocks are apart from them.
fn key(name: &BlockName) -> String {
    match name {
        BlockName::Symbol { name, .. } => name.to_lowercase(),
        BlockName::Numbered { prefix, number, .. } => format!("{} {number}", prefix.letters()),
    }
}

impl Maker<'_> {
    pub(super) fn data(&self, block: &ast::DataBlock) -> Page {
        let mut page = self.page(BlockKind::Db, &block.name, &block.header);
        let same = |db: &&plcc_model::DataBlock| match &block.name {
            BlockName::Numbered { number, .. } => u32::from(db.number) == *number,
            BlockName::Symbol { name, .. } => db.name.eq_ignore_ascii_case(name),
        };
        if let Some(db) = self.program.and_then(|program| program.dbs.iter().find(same)) {
            page.id = format!("DB {}", db.number);
            page.name = db.name.clone();
            let mut rows = Vec::new();
            data::members(Some(db.number), &db.members, 0, 0, &mut rows);
            let mut declared = Vec::new();
            match &block.content {
                DataContent::Struct(variables) => self.components(variables, 0, &mut declared),
                DataContent::OfType(ty) => self.components_of_type(ty, 0, &mut declared),
                DataContent::Array(..) | DataContent::Empty => {}
            }
            describe(&mut rows, &declared);
            page.declarations = rows;
        } else if let DataContent::Struct(variables) = &block.content {
            self.declare(variables, "", 0, &mut page.declarations);
        }
        if let DataContent::OfType(ty) = &block.content {
            page.comment.insert(0, format!("Type: {}", self.type_words(ty)));
        }
        let rows = paths(&page.declarations);
        for value in &block.values {
            match path_of(&value.target).and_then(|path| rows.get(&path)) {
                Some(row) => page.declarations[*row].initial = self.words(value.value.span),
                None => page.comment.push(self.words(value.span)),
            }
        }
        page
    }

    pub(super) fn declare(&self, list: &[Variable], section: &'static str, depth: usize, rows: &mut Vec<Declaration>) {
        for variable in list {
            rows.push(self.row(variable, section, depth));
            if let Some((members, _)) = structure(&variable.ty).filter(|_| depth < 40) {
                self.declare(members, section, depth + 1, rows);
            }
        }
    }

    fn row(&self, variable: &Variable, section: &'static str, depth: usize) -> Declaration {
        Declaration {
            section,
            name: variable.name.clone(),
            ty: self.type_words(&variable.ty),
            initial: variable.initial.as_ref().map_or(String::new(), |value| self.words(value.span)),
            comment: variable.comment.clone().unwrap_or_default(),
            address: String::new(),
            depth,
        }
    }

    /// The rows of components of a data block, also of those that are of a data type or function block of the sources.
    fn components(&self, list: &[Variable], depth: usize, rows: &mut Vec<Declaration>) {
        for variable in list {
            if depth > 40 || rows.len() > data::ROWS_MAX {
                return;
            }
            rows.push(self.row(variable, "", depth));
            match structure(&variable.ty) {
                Some((members, _)) => self.components(members, depth + 1, rows),
                // The value of the whole has precedence over the values in its type.
                None if variable.initial.is_none() => self.components_of_type(&variable.ty, depth + 1, rows),
                None => {}
            }
        }
    }

    fn components_of_type(&self, ty: &TypeRef, depth: usize, rows: &mut Vec<Declaration>) {
        let name = match &ty.kind {
            TypeKind::Block(name) => key(name),
            TypeKind::Named(name) => name.to_lowercase(),
            TypeKind::String(_)
            | TypeKind::WideString(_)
            | TypeKind::Array { .. }
            | TypeKind::OpenArray { .. }
            | TypeKind::Reference(_)
            | TypeKind::Struct(_)
            | TypeKind::Error => return,
        };
        if let Some(found) = self.declared.get(&name) {
            let maker = Maker { text: found.text, unit: found.unit, ..*self };
            found.variables.iter().for_each(|list| maker.components(list, depth, rows));
        }
    }

    /// A data type as its author wrote it; the components of a structure have rows of their own.
    pub(super) fn type_words(&self, ty: &TypeRef) -> String {
        let written = match structure(ty) {
            Some((_, span)) if span.start > ty.span.start => {
                format!("{} STRUCT", self.words(Span { end: span.start, ..ty.span }))
            }
            Some(_) if matches!(ty.kind, TypeKind::Struct(_)) => "STRUCT".to_string(),
            Some(_) | None => self.words(ty.span),
        };
        // A project in PLCopen XML has types as elements.
        if written.starts_with('<') { self.type_of_element(ty) } else { written }
    }

    fn type_of_element(&self, ty: &TypeRef) -> String {
        let bound = |bound: &Bound| match bound {
            Bound::Number(number, _) => number.to_string(),
            Bound::Name(name, _) => name.clone(),
            Bound::Expr(value) => self.words(value.span),
            Bound::Path(path) => self.words(path.span),
        };
        let text = |name: &str, length: &Option<Bound>| match length {
            Some(length) => format!("{name}[{}]", bound(length)),
            None => name.to_string(),
        };
        match &ty.kind {
            TypeKind::Named(name) => name.clone(),
            TypeKind::Block(BlockName::Symbol { name, .. }) => format!("\"{name}\""),
            TypeKind::Block(BlockName::Numbered { prefix, number, .. }) => format!("{} {number}", prefix.letters()),
            TypeKind::String(length) => text("STRING", length),
            TypeKind::WideString(length) => text("WSTRING", length),
            TypeKind::Array { bounds, element } => {
                let bounds: Vec<String> =
                    bounds.iter().map(|(low, high)| format!("{}..{}", bound(low), bound(high))).collect();
                format!("ARRAY[{}] OF {}", bounds.join(", "), self.type_of_element(element))
            }
            TypeKind::OpenArray { dimensions, element } => {
                let bounds = vec!["*"; usize::from(*dimensions)].join(", ");
                format!("ARRAY[{bounds}] OF {}", self.type_of_element(element))
            }
            TypeKind::Reference(of) => format!("REF_TO {}", self.type_of_element(of)),
            TypeKind::Struct(_) => "STRUCT".to_string(),
            TypeKind::Error => String::new(),
        }
    }
}

/// The components of a structure, or of the elements of an array of structures, and where its declaration is.
fn structure(ty: &TypeRef) -> Option<(&[Variable], Span)> {
    match &ty.kind {
        TypeKind::Struct(members) => Some((members, ty.span)),
        TypeKind::Array { element, .. } => structure(element),
        TypeKind::Named(_)
        | TypeKind::String(_)
        | TypeKind::WideString(_)
        | TypeKind::OpenArray { .. }
        | TypeKind::Reference(_)
        | TypeKind::Block(_)
        | TypeKind::Error => None,
    }
}

/// Gives the rows of a data block the initial values and comments of its declarations.
fn describe(rows: &mut [Declaration], declared: &[Declaration]) {
    let known = paths(declared);
    for (path, at) in paths(rows) {
        if let Some(from) = known.get(&path).map(|from| &declared[*from]) {
            rows[at].initial.clone_from(&from.initial);
            rows[at].comment.clone_from(&from.comment);
        }
    }
}

/// The rows by the names of their components in small letters.
fn paths(rows: &[Declaration]) -> HashMap<Vec<String>, usize> {
    let mut path: Vec<String> = Vec::new();
    let mut found = HashMap::new();
    for (at, row) in rows.iter().enumerate() {
        path.truncate(row.depth);
        path.push(row.name.to_lowercase());
        found.entry(path.clone()).or_insert(at);
    }
    found
}

/// The names of a component in small letters; `None`: it is in an element of an array.
fn path_of(target: &Path) -> Option<Vec<String>> {
    let (PathRoot::Local { name, .. } | PathRoot::Quoted { name, .. } | PathRoot::Bare { name, .. }) = &target.root
    else {
        return None;
    };
    let names = target.parts.iter().map(|part| match part {
        PathPart::Member { name, .. } => Some(name.to_lowercase()),
        PathPart::Index { .. } => None,
    });
    std::iter::once(Some(name.to_lowercase())).chain(names).collect()
}
