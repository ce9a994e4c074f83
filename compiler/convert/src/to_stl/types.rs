//! Types of operands, where a box does not name its own.

use std::collections::{HashMap, HashSet};

use plcc_model::InstructionPin;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{
    Block, BlockName, BlockPrefix, Call, Code, CodeBlock, CodeKind, DataContent, OperandKind, PathPart, PathRoot,
    Section, SectionKind, SourceUnit, StatementKind, TypeKind, TypeRef, Variable, Width,
};
use plcc_syntax::literal::Literal;
use plcc_syntax::network::elements::{Kind, Row, find_sd};
use plcc_syntax::symbols::{SymbolTable, SymbolTarget, parse_address};

use super::operand::slice_type;
use crate::xml::system;

/// The parameters of a call of an instruction that supplies those with the given names; none: STL has no such call.
pub type FindInstruction = fn(&str, &[&str]) -> Option<Vec<InstructionPin>>;

/// The block of the CPU or of a library with a number, whose symbol may say that it is another one.
pub type FindBlock = fn(BlockPrefix, u32, Option<&str>) -> Option<CodeBlock>;

/// What the sources of a program declare.
#[derive(Default)]
pub struct Types<'a> {
    /// Types of symbols and of constants of tag tables, by folded names.
    symbols: HashMap<String, Elementary>,
    data: HashMap<String, &'a [Variable]>,
    types: HashMap<String, &'a [Variable]>,
    /// The blocks of instances, by folded names of their data blocks.
    instances: HashMap<String, BlockName>,
    function_blocks: HashMap<String, &'a BlockName>,
    /// Blocks with code, by folded names.
    blocks: HashMap<String, &'a CodeBlock>,
    /// The blocks of the CPU and of libraries that statements call, by folded names.
    library: HashMap<String, CodeBlock>,
    /// The number of a block for its symbol, and its symbol for the number.
    other_names: HashMap<String, String>,
    /// Components of timers, counters and dates with time, by folded names of their types.
    system: HashMap<String, Vec<Variable>>,
    /// Instructions that STL calls by name.
    instructions: Option<FindInstruction>,
    /// The program is one for an S7-1200 or S7-1500.
    pub(super) is_portal: bool,
}

impl<'a> Types<'a> {
    pub fn new(units: impl Iterator<Item = &'a SourceUnit>, tables: &[SymbolTable]) -> Types<'a> {
        let mut types = Types { system: system::members().chain([system::moment()]).collect(), ..Types::default() };
        let mut other_names = HashMap::new();
        for symbol in tables.iter().flat_map(|table| &table.symbols) {
            if let Some(ty) = elementary(&symbol.ty) {
                types.symbols.insert(symbol.name.to_lowercase(), ty);
            }
            if let SymbolTarget::Block { prefix, number } = symbol.target {
                let (name, number) = (symbol.name.to_lowercase(), format!("{} {number}", prefix.letters()));
                other_names.insert(number.clone(), name.clone());
                other_names.insert(name, number);
            }
        }
        // STL loads a constant as a variable of its type.
        for constant in tables.iter().flat_map(|table| &table.constants) {
            if let Some(ty) = elementary(&constant.ty) {
                types.symbols.entry(constant.name.to_lowercase()).or_insert(ty);
            }
        }
        for block in units.flat_map(|unit| &unit.blocks) {
            if let Block::Code(block) = block {
                types.blocks.insert(key(&block.name), block);
            }
            match block {
                Block::Data(data) => match &data.content {
                    DataContent::Struct(members) => drop(types.data.insert(key(&data.name), members)),
                    DataContent::OfType(TypeRef { kind: TypeKind::Block(of), .. }) => {
                        types.instances.insert(key(&data.name), of.clone());
                    }
                    DataContent::OfType(TypeRef { kind: TypeKind::Named(name), span }) => {
                        let of = BlockName::Symbol { name: name.clone(), span: *span };
                        types.instances.insert(key(&data.name), of);
                    }
                    DataContent::OfType(_) | DataContent::Array(..) | DataContent::Empty => {}
                },
                Block::Type(ty) => {
                    types.types.insert(key(&ty.name), &ty.members);
                }
                Block::Code(block) if block.kind == CodeKind::Fb => {
                    types.function_blocks.insert(key(&block.name), &block.name);
                }
                Block::Code(_) => {}
            }
        }
        types.add_other_names(&other_names);
        Types { other_names, ..types }
    }

    /// With instructions that STL calls by name.
    pub fn with_instructions(self, find: FindInstruction) -> Types<'a> {
        Types { instructions: Some(find), ..self }
    }

    /// With the parameters of blocks of the CPU and of libraries that statements call: `CALL SFC 20`.
    pub fn with_library(mut self, units: impl Iterator<Item = &'a SourceUnit>, find: FindBlock) -> Types<'a> {
        for block in units.flat_map(|unit| &unit.blocks) {
            let Block::Code(block) = block else { continue };
            let Code::Stl(networks) = &block.code else { continue };
            for statement in networks.iter().flat_map(|network| &network.statements) {
                let StatementKind::Call(call) = &statement.kind else { continue };
                let Some(name) = self.called(call, block).map(|name| key(&name)) else { continue };
                if self.blocks.contains_key(&name) || self.library.contains_key(&name) {
                    continue;
                }
                let other = self.other_names.get(&name);
                let (number, symbol) = match parse_address(&name) {
                    Some(target @ SymbolTarget::Block { .. }) => (Some(target), other.map(String::as_str)),
                    _ => (other.and_then(|number| parse_address(number)), Some(name.as_str())),
                };
                if let Some(SymbolTarget::Block { prefix, number }) = number
                    && let Some(found) = find(prefix, number, symbol)
                {
                    self.library.insert(name, found);
                }
            }
        }
        self
    }

    /// For an S7-1200 or S7-1500, or for another CPU.
    pub fn for_portal(self, is_portal: bool) -> Types<'a> {
        Types { is_portal, ..self }
    }

    /// The parameters of a call of an instruction that supplies those with the names `given`; none: STL calls no such instruction, or a
    /// block of the program has its name.
    pub fn instruction(&self, name: &str, given: &[&str]) -> Option<Vec<InstructionPin>> {
        let find = self.instructions.filter(|_| !self.blocks.contains_key(&name.to_lowercase()))?;
        find(name, given)
    }

    /// What the sources declare by a number is known by its symbol too, and the other way round.
    fn add_other_names(&mut self, names: &HashMap<String, String>) {
        for (one, other) in names {
            for (from, to) in [(one, other), (other, one)] {
                copy(&mut self.data, from, to);
                copy(&mut self.types, from, to);
                copy(&mut self.instances, from, to);
                copy(&mut self.function_blocks, from, to);
                copy(&mut self.blocks, from, to);
            }
        }
    }

    /// The block whose instance a data block is.
    pub fn instance_of(&self, name: &BlockName) -> Option<BlockName> {
        let of = self.instances.get(&key(name))?;
        // In the letter case of its declaration.
        Some(self.function_blocks.get(&key(of)).map_or_else(|| of.clone(), |known| (*known).clone()))
    }

    /// The block that a statement calls: its name, or the type of the instance.
    fn called(&self, call: &Call, block: &CodeBlock) -> Option<BlockName> {
        match &call.target.kind {
            OperandKind::Block(name) => Some(name.clone()),
            OperandKind::Path(path) => {
                let name = match (&path.root, &path.parts[..]) {
                    (PathRoot::Local { name, .. }, []) => name,
                    (PathRoot::Quoted { name, span }, []) => {
                        return Some(BlockName::Symbol { name: name.clone(), span: *span });
                    }
                    _ => return None,
                };
                let mut variables = block.sections.iter().flat_map(|section| &section.variables);
                let variable = variables.find(|variable| variable.name.eq_ignore_ascii_case(name))?;
                match &variable.ty.kind {
                    TypeKind::Block(name) => Some(name.clone()),
                    TypeKind::Named(name) => Some(BlockName::Symbol { name: name.clone(), span: variable.ty.span }),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    /// Where a called block of the sources or of the library declares a parameter.
    pub fn section(&self, call: &Call, parameter: &str, block: &CodeBlock) -> Option<SectionKind> {
        let name = key(&self.called(call, block)?);
        let called = self.blocks.get(&name).copied().or_else(|| self.library.get(&name))?;
        if called.return_type.is_some() && parameter.eq_ignore_ascii_case("RET_VAL") {
            return Some(SectionKind::Output);
        }
        let has =
            |section: &&Section| section.variables.iter().any(|variable| variable.name.eq_ignore_ascii_case(parameter));
        called.sections.iter().find(has).map(|section| section.kind)
    }

    /// The type of a parameter of the block that is called, if it is elementary.
    pub fn formal(&self, call: &Call, parameter: &str, block: &CodeBlock) -> Option<Elementary> {
        let name = key(&self.called(call, block)?);
        let called = self.blocks.get(&name)?;
        if let Some(ty) = called.return_type.as_ref().filter(|_| parameter.eq_ignore_ascii_case("RET_VAL")) {
            return self.part(ty, &[]);
        }
        let mut variables = called.sections.iter().flat_map(|section| &section.variables);
        let formal = variables.find(|variable| variable.name.eq_ignore_ascii_case(parameter))?;
        self.part(&formal.ty, &[])
    }

    /// The outputs of the function that is called, if it is in the sources, with the types of those that are elementary.
    pub fn outputs_of_function(&self, call: &Call, block: &CodeBlock) -> Vec<(String, Option<Elementary>)> {
        let called = self.called(call, block).and_then(|name| self.blocks.get(&key(&name)));
        let Some(called) = called.filter(|called| called.kind == CodeKind::Fc) else { return Vec::new() };
        let sections = called.sections.iter().filter(|section| section.kind == SectionKind::Output);
        let outputs = sections.flat_map(|section| &section.variables).map(|one| (one.name.clone(), &one.ty));
        // A variable cannot be VOID.
        let is_value = |ty: &&TypeRef| !matches!(&ty.kind, TypeKind::Named(name) if name.eq_ignore_ascii_case("VOID"));
        let result = called.return_type.as_ref().filter(is_value).map(|ty| ("RET_VAL".to_string(), ty));
        outputs.chain(result).map(|(name, ty)| (name, self.part(ty, &[]))).collect()
    }

    /// The element for a call of a function block that editors have as one, such as TON.
    pub fn row_of(&self, call: &Call, block: &CodeBlock) -> Option<&'static Row> {
        let BlockName::Symbol { name, .. } = self.called(call, block)? else { return None };
        if self.blocks.contains_key(&name.to_lowercase()) {
            return None;
        }
        // The data of a timer have a type of their own: TON_TIME.
        let upper = name.to_ascii_uppercase();
        let element = upper.strip_suffix("_TIME").unwrap_or(&name);
        find_sd(element).map(|(row, _)| row).filter(|row| matches!(row.kind, Kind::Instance(_)))
    }

    /// Whether a name is that of a block with code of the program.
    pub fn is_block(&self, name: &str) -> bool {
        self.blocks.contains_key(&name.to_lowercase())
    }

    /// Whether a name is that of a data type of the program.
    pub fn is_type(&self, name: &BlockName) -> bool {
        self.types.contains_key(&key(name))
    }

    /// Whether a name is that of a data block.
    pub fn is_data(&self, name: &BlockName) -> bool {
        self.data.contains_key(&key(name))
    }

    /// Whether variables of a type contain texts.
    pub fn has_texts(&self, ty: &TypeRef) -> bool {
        let (mut rest, mut seen) = (vec![ty], HashSet::new());
        while let Some(ty) = rest.pop() {
            let name = match &ty.kind {
                TypeKind::String(_) | TypeKind::WideString(_) => return true,
                TypeKind::Array { element, .. } => {
                    rest.push(element);
                    continue;
                }
                TypeKind::Struct(members) => {
                    rest.extend(members.iter().map(|member| &member.ty));
                    continue;
                }
                TypeKind::Named(name) => name.to_lowercase(),
                TypeKind::Block(name) => key(name),
                TypeKind::OpenArray { .. } | TypeKind::Reference(_) | TypeKind::Error => continue,
            };
            // A type may contain itself by mistake.
            if let Some(members) = self.types.get(&name)
                && seen.insert(name)
            {
                rest.extend(members.iter().map(|member| &member.ty));
            }
        }
        false
    }

    /// Whether variables of a type are instances of a function block of the program.
    pub fn is_function_block(&self, ty: &TypeRef) -> bool {
        match &ty.kind {
            TypeKind::Named(name) => self.function_blocks.contains_key(&name.to_lowercase()),
            TypeKind::Block(name) => self.function_blocks.contains_key(&key(name)),
            _ => false,
        }
    }

    /// The type of an operand; for an absolute address the width alone says nothing, so there is none.
    pub fn of(&self, kind: &OperandKind, block: &CodeBlock) -> Option<Elementary> {
        match kind {
            OperandKind::Literal(literal) => of_literal(literal),
            OperandKind::Absolute { width: Width::Bit, .. } => Some(Elementary::Bool),
            OperandKind::Path(path) => {
                if let Some(PathPart::Member { name, .. }) = path.parts.last()
                    && let Some(ty) = slice_type(name)
                {
                    return Some(ty);
                }
                let (members, rest): (Vec<&Variable>, &[PathPart]) = match &path.root {
                    PathRoot::Quoted { name, .. } | PathRoot::Bare { name, .. } if path.parts.is_empty() => {
                        let known = self.symbols.get(&name.to_lowercase()).copied();
                        return known.or_else(|| self.local(block, name, &[]));
                    }
                    PathRoot::Local { name, .. } | PathRoot::Bare { name, .. } => {
                        return self.local(block, name, &path.parts);
                    }
                    PathRoot::Quoted { name, .. } => (self.data_of(&name.to_lowercase())?, &path.parts),
                    PathRoot::Block(name) => (self.data_of(&key(name))?, &path.parts),
                };
                self.member(&members, rest)
            }
            _ => None,
        }
    }

    fn local(&self, block: &CodeBlock, name: &str, parts: &[PathPart]) -> Option<Elementary> {
        let variables: Vec<&Variable> = block.sections.iter().flat_map(|section| &section.variables).collect();
        let is_own = matches!(&block.name, BlockName::Symbol { name: own, .. } if own.eq_ignore_ascii_case(name));
        if let Some(ty) = &block.return_type
            && (is_own || name.eq_ignore_ascii_case("RET_VAL"))
        {
            return self.part(ty, parts);
        }
        let variable = variables.iter().find(|variable| variable.name.eq_ignore_ascii_case(name));
        let constant = || block.constants.iter().find(|constant| constant.name.eq_ignore_ascii_case(name))?.ty.as_ref();
        self.part(variable.map(|variable| &variable.ty).or_else(constant)?, parts)
    }

    /// How a variable is declared, or a component.
    pub fn declared(&self, kind: &OperandKind, block: &'a CodeBlock) -> Option<&TypeRef> {
        let OperandKind::Path(path) = kind else { return None };
        let of_block = |name: &str| {
            let mut variables = block.sections.iter().flat_map(|section| &section.variables);
            let variable = variables.find(|variable| variable.name.eq_ignore_ascii_case(name))?;
            self.declared_part(&variable.ty, &path.parts)
        };
        match &path.root {
            PathRoot::Local { name, .. } | PathRoot::Bare { name, .. } => of_block(name),
            PathRoot::Quoted { name, .. } => self.declared_member(&self.data_of(&name.to_lowercase())?, &path.parts),
            PathRoot::Block(name) => self.declared_member(&self.data_of(&key(name))?, &path.parts),
        }
    }

    fn declared_member<'t>(&'t self, members: &[&'t Variable], parts: &[PathPart]) -> Option<&'t TypeRef> {
        let (PathPart::Member { name, .. }, rest) = parts.split_first()? else { return None };
        let variable = members.iter().find(|variable| variable.name.eq_ignore_ascii_case(name))?;
        self.declared_part(&variable.ty, rest)
    }

    fn declared_part<'t>(&'t self, ty: &'t TypeRef, parts: &[PathPart]) -> Option<&'t TypeRef> {
        match (&ty.kind, parts.split_first()) {
            (_, None) => Some(ty),
            (TypeKind::Array { element, .. }, Some((PathPart::Index { .. }, rest))) => {
                self.declared_part(element, rest)
            }
            (TypeKind::Struct(members), Some(_)) => self.declared_member(&members.iter().collect::<Vec<_>>(), parts),
            (TypeKind::Block(name), Some(_)) => self.declared_member(&self.components(name)?, parts),
            (TypeKind::Named(name), Some(_)) => {
                let name = BlockName::Symbol { name: name.clone(), span: ty.span };
                self.declared_member(&self.components(&name)?, parts)
            }
            _ => None,
        }
    }

    /// The components of a data block.
    fn data_of(&self, key: &str) -> Option<Vec<&Variable>> {
        match self.data.get(key) {
            Some(members) => Some(members.iter().collect()),
            None => self.components(self.instances.get(key)?),
        }
    }

    /// The components of a type, or of the instances of a function block.
    fn components(&self, name: &BlockName) -> Option<Vec<&Variable>> {
        if let Some(members) = self.types.get(&key(name)) {
            return Some(members.iter().collect());
        }
        let Some(block) = self.blocks.get(&key(name)).filter(|block| block.kind == CodeKind::Fb) else {
            return Some(self.system.get(&key(name))?.iter().collect());
        };
        let lasting = block.sections.iter().filter(|section| section.kind != SectionKind::Temp);
        Some(lasting.flat_map(|section| &section.variables).collect())
    }

    fn member(&self, members: &[&Variable], parts: &[PathPart]) -> Option<Elementary> {
        let (PathPart::Member { name, .. }, rest) = parts.split_first()? else { return None };
        let variable = members.iter().find(|variable| variable.name.eq_ignore_ascii_case(name))?;
        self.part(&variable.ty, rest)
    }

    fn part(&self, ty: &TypeRef, parts: &[PathPart]) -> Option<Elementary> {
        match (&ty.kind, parts.split_first()) {
            (TypeKind::Named(name), None) => elementary(name),
            (TypeKind::Array { element, .. }, Some((PathPart::Index { .. }, rest))) => self.part(element, rest),
            (TypeKind::Struct(members), Some(_)) => self.member(&members.iter().collect::<Vec<_>>(), parts),
            (TypeKind::Block(name), Some(_)) => self.member(&self.components(name)?, parts),
            (TypeKind::Named(name), Some(_)) => {
                let name = BlockName::Symbol { name: name.clone(), span: ty.span };
                self.member(&self.components(&name)?, parts)
            }
            _ => None,
        }
    }
}

fn copy<T: Clone>(known: &mut HashMap<String, T>, from: &str, to: &str) {
    if let Some(value) = known.get(from).cloned() {
        known.entry(to.to_string()).or_insert(value);
    }
}

fn key(name: &BlockName) -> String {
    match name {
        BlockName::Numbered { prefix, number, .. } => format!("{} {number}", prefix.letters()),
        BlockName::Symbol { name, .. } => name.to_lowercase(),
    }
}

/// The elementary type of that name.
pub fn elementary(name: &str) -> Option<Elementary> {
    let name = name.trim().to_uppercase();
    let name = match name.as_str() {
        "TOD" => "TIME_OF_DAY",
        name => name,
    };
    Elementary::ALL.into_iter().find(|ty| ty.name() == name)
}

fn of_literal(literal: &Literal) -> Option<Elementary> {
    Some(match literal {
        Literal::Bool(_) => Elementary::Bool,
        Literal::Dint(_) => Elementary::Dint,
        Literal::Byte(_) => Elementary::Byte,
        Literal::Word(_) | Literal::Counter(_) => Elementary::Word,
        Literal::Dword(_) => Elementary::Dword,
        Literal::Real(_) => Elementary::Real,
        Literal::S5Time(_) => Elementary::S5Time,
        Literal::Time(_) => Elementary::Time,
        Literal::Date(_) => Elementary::Date,
        Literal::TimeOfDay(_) => Elementary::TimeOfDay,
        // The other operand decides.
        Literal::Int(_)
        | Literal::Bits { .. }
        | Literal::Bytes2(_)
        | Literal::Bytes4(_)
        | Literal::DateAndTime(_)
        | Literal::Text(_)
        | Literal::Pointer(_)
        | Literal::AreaPointer { .. }
        | Literal::Any(_) => return None,
    })
}
