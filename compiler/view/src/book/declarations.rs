//! The interface of a block and the components of a data block, as rows of a table.

use std::collections::HashMap;

use plcc_abi::image::BlockKind;
use plcc_syntax::ast::{self, BlockName, DataContent, TypeKind, Variable};

use super::{Declaration, Maker, Page};
use crate::data;

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
            data::members(db.number, &db.members, 0, 0, &mut rows);
            if let DataContent::Struct(variables) = &block.content {
                let mut declared = Vec::new();
                self.declare(variables, "", 0, &mut declared);
                complete(&mut rows, &declared);
            }
            page.declarations = rows;
        } else if let DataContent::Struct(variables) = &block.content {
            self.declare(variables, "", 0, &mut page.declarations);
        }
        if let DataContent::OfType(ty) = &block.content {
            page.comment.insert(0, format!("Type: {}", self.words(ty.span)));
        }
        for value in &block.values {
            let text = self.words(value.span);
            page.comment.push(text);
        }
        page
    }

    pub(super) fn declare(&self, list: &[Variable], section: &'static str, depth: usize, rows: &mut Vec<Declaration>) {
        for variable in list {
            let members = match &variable.ty.kind {
                TypeKind::Struct(members) if depth < 40 => Some(members),
                _ => None,
            };
            rows.push(Declaration {
                section,
                name: variable.name.clone(),
                ty: if members.is_some() { "STRUCT".to_string() } else { self.words(variable.ty.span) },
                initial: variable.initial.as_ref().map_or(String::new(), |value| self.words(value.span)),
                comment: variable.comment.clone().unwrap_or_default(),
                address: String::new(),
                depth,
            });
            if let Some(members) = members {
                self.declare(members, section, depth + 1, rows);
            }
        }
    }
}

/// Adds what is declared of components to the rows with their addresses: initial values and comments.
fn complete(rows: &mut [Declaration], declared: &[Declaration]) {
    let known: HashMap<Vec<String>, &Declaration> = paths(declared).into_iter().zip(declared).collect();
    for (path, row) in paths(rows).into_iter().zip(rows) {
        if let Some(declared) = known.get(&path) {
            row.initial.clone_from(&declared.initial);
            row.comment.clone_from(&declared.comment);
        }
    }
}

/// The name of each row, after those of the rows that it is a component of.
fn paths(rows: &[Declaration]) -> Vec<Vec<String>> {
    let mut path = Vec::new();
    let one = |row: &Declaration| {
        path.truncate(row.depth);
        path.push(row.name.to_lowercase());
        path.clone()
    };
    rows.iter().map(one).collect()
}
