//! The types of DBs and symbols as the runtime knows them: by these it finds and prints a value that a user names.

use std::rc::Rc;

use plcc_abi::image::{AssertType, SymbolEntry};
use plcc_abi::names::{Dimension, NamedMember, NamedStruct, NamedType, TypeNumber};
use plcc_model::layout;
use plcc_model::types::{DTL, DataType, Member, StructType, value_type};
use plcc_model::{DataBlock, Program};
use rustc_hash::FxHashMap;

/// Types of the program, each once.
#[derive(Default)]
pub struct Types {
    types: Vec<NamedType>,
    numbers: FxHashMap<NamedType, TypeNumber>,
    /// Structures that were entered, by their addresses in this process.
    structures: FxHashMap<*const StructType, TypeNumber>,
}

impl Types {
    /// All types, each after those that it contains.
    pub fn finish(self) -> Vec<NamedType> {
        self.types
    }

    /// The type of a DB with all its components.
    pub fn of_db(&mut self, db: &DataBlock, program: &Program) -> TypeNumber {
        let name = db.instance_of.map(|key| match program.block(key) {
            Some(block) if !block.name.is_empty() => block.name.clone(),
            Some(_) | None => key.to_string(),
        });
        let members = self.members(&db.members);
        self.enter(NamedType::Struct(NamedStruct {
            name: name.unwrap_or_default(),
            data_type: db.data_type.clone(),
            members,
            is_dtl: false,
        }))
    }

    /// Symbols with the numbers of their types.
    pub fn symbols(&mut self, program: &Program) -> Vec<SymbolEntry> {
        let entry = |symbol: &plcc_model::Symbol| SymbolEntry {
            name: symbol.name.clone(),
            address: symbol.address.clone(),
            ty: symbol.ty.as_ref().map(|ty| self.number(ty)),
            external: symbol.external,
        };
        program.symbols.iter().map(entry).collect()
    }

    fn enter(&mut self, ty: NamedType) -> TypeNumber {
        let next = self.types.len() as TypeNumber;
        let number = *self.numbers.entry(ty.clone()).or_insert(next);
        if number == next {
            self.types.push(ty);
        }
        number
    }

    fn members(&mut self, members: &[Member]) -> Vec<NamedMember> {
        let member = |member: &Member| NamedMember {
            name: member.name.clone(),
            ty: self.number(&member.ty),
            byte: member.byte,
            bit: member.bit,
            external: member.external,
        };
        members.iter().map(member).collect()
    }

    fn number(&mut self, ty: &DataType) -> TypeNumber {
        let named = match ty {
            DataType::Elementary(ty) => NamedType::Value(value_type(*ty)),
            DataType::DateAndTime => NamedType::Value(AssertType::DateAndTime),
            DataType::String(length) => NamedType::Text { wide: false, length: u16::from(*length) },
            DataType::WideString(length) => NamedType::Text { wide: true, length: *length },
            DataType::Array(array) => {
                let dimension = |(number, &(low, high)): (usize, &(i32, i32))| Dimension {
                    low,
                    high,
                    distance: layout::distance(array, number),
                };
                let dimensions = array.bounds.iter().enumerate().map(dimension).collect();
                NamedType::Array { dimensions, element: self.number(&array.element) }
            }
            DataType::Struct(structure) => return self.structure(structure),
            DataType::Parameter(_) | DataType::OpenArray(_) | DataType::Void => {
                NamedType::Other { name: layout::type_name(ty) }
            }
        };
        self.enter(named)
    }

    fn structure(&mut self, structure: &Rc<StructType>) -> TypeNumber {
        let place = Rc::as_ptr(structure);
        if let Some(&number) = self.structures.get(&place) {
            return number;
        }
        let members = self.members(&structure.members);
        let is_dtl = structure.name == DTL && structure.instance_of.is_none();
        let named = NamedStruct { name: structure.name.clone(), data_type: String::new(), members, is_dtl };
        let number = self.enter(NamedType::Struct(named));
        self.structures.insert(place, number);
        number
    }
}
