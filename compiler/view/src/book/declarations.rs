//! The interface of a block and the components of a data block, as rows of a table.

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
