//! The body of a function: block headers and instructions, which may name values and blocks that come later.

use plcc_abi::Type;
use rustc_hash::FxHashMap;

use super::cursor::Cursor;
use super::operation::ResultType;
use super::{LineResult, ParseError, Signatures};
use crate::entities::{Block, Entity, Inst, Loc, Value};
use crate::function::{Function, ValueDef};

/// Reads the body of one function.
pub(super) struct FunctionParser<'a> {
    pub(super) signatures: &'a Signatures,
    pub(super) function: Function,
    pub(super) line: u32,
    /// Values and blocks by their number in the text, in the order of their first mention.
    values: FxHashMap<u32, Mentioned>,
    value_count: usize,
    blocks: FxHashMap<u32, Mentioned>,
    block_count: usize,
    /// By first mention: the defined entity.
    defined_values: Vec<Option<Value>>,
    defined_blocks: Vec<Option<Block>>,
    /// Types of results that wait for another value's: (result, other by first mention, line).
    waiting: Vec<(Value, Value, u32)>,
    stores: Vec<(Value, Type, u32)>,
}

#[derive(Clone, Copy)]
struct Mentioned {
    index: usize,
    line: u32,
}

impl<'a> FunctionParser<'a> {
    pub(super) fn new(function: Function, signatures: &'a Signatures) -> Self {
        FunctionParser {
            signatures,
            function,
            line: 0,
            values: FxHashMap::default(),
            value_count: 0,
            blocks: FxHashMap::default(),
            block_count: 0,
            defined_values: Vec::new(),
            defined_blocks: Vec::new(),
            waiting: Vec::new(),
            stores: Vec::new(),
        }
    }

    pub(super) fn parse_line(&mut self, cursor: &mut Cursor) -> LineResult<()> {
        if cursor.starts_entity('b') { self.parse_block_header(cursor) } else { self.parse_inst(cursor) }
    }

    /// `b1(v3: i32) cold:`
    fn parse_block_header(&mut self, cursor: &mut Cursor) -> LineResult<()> {
        let mention = self.block(cursor)?;
        let block = self.function.add_block();
        if self.defined_blocks[mention.index()].replace(block).is_some() {
            return Err("the block is defined twice".into());
        }
        if cursor.take("(") {
            loop {
                let name = self.value(cursor)?;
                cursor.expect(":")?;
                let ty = cursor.ty()?;
                let param = self.function.add_param(block, ty);
                self.define(name, param)?;
                if !cursor.take(",") {
                    break;
                }
            }
            cursor.expect(")")?;
        }
        self.function.blocks[block].cold = cursor.take_word("cold");
        cursor.expect(":")?;
        cursor.end()
    }

    fn define(&mut self, mention: Value, value: Value) -> LineResult<()> {
        match self.defined_values[mention.index()].replace(value) {
            Some(_) => Err("a value is defined twice".into()),
            None => Ok(()),
        }
    }

    /// `v1, v2 = OPERATION !3`
    fn parse_inst(&mut self, cursor: &mut Cursor) -> LineResult<()> {
        let Some(&block) = self.function.layout.last() else {
            return Err("a block header, e.g. `b0:`, is expected before instructions".into());
        };
        let mut names = Vec::new();
        if cursor.starts_entity('v') {
            names.push(self.value(cursor)?);
            while cursor.take(",") {
                names.push(self.value(cursor)?);
            }
            cursor.expect("=")?;
        }
        let operation = self.parse_operation(cursor)?;
        let loc = if cursor.take("!") { Loc(cursor.number()?) } else { Loc(0) };
        cursor.end()?;
        if names.len() != operation.results.len() {
            return Err(format!("the instruction has {} results, not {}", operation.results.len(), names.len()));
        }
        // Types that are not known yet are set at the end.
        let types: Vec<Type> = operation
            .results
            .iter()
            .map(|result| match result {
                ResultType::Known(ty) => *ty,
                ResultType::As(_) => Type::I1,
            })
            .collect();
        let inst: Inst = self.function.make_inst(operation.data, &types, loc);
        self.function.blocks[block].insts.push(inst);
        for (index, (name, ty)) in names.into_iter().zip(operation.results).enumerate() {
            let value = self.function.results[inst][index];
            self.define(name, value)?;
            if let ResultType::As(other) = ty {
                self.waiting.push((value, other, self.line));
            }
        }
        if let Some((value, ty)) = operation.stored {
            self.stores.push((value, ty, self.line));
        }
        Ok(())
    }

    /// A value by its number in the text; the result counts first mentions.
    pub(super) fn value(&mut self, cursor: &mut Cursor) -> LineResult<Value> {
        let number = cursor.entity('v')?;
        let fresh = Mentioned { index: self.value_count, line: self.line };
        let mention = *self.values.entry(number).or_insert(fresh);
        if mention.index == self.value_count {
            self.value_count += 1;
            self.defined_values.push(None);
        }
        Ok(Value::new(mention.index))
    }

    pub(super) fn block(&mut self, cursor: &mut Cursor) -> LineResult<Block> {
        let number = cursor.entity('b')?;
        let fresh = Mentioned { index: self.block_count, line: self.line };
        let mention = *self.blocks.entry(number).or_insert(fresh);
        if mention.index == self.block_count {
            self.block_count += 1;
            self.defined_blocks.push(None);
        }
        Ok(Block::new(mention.index))
    }

    /// Resolves forward references, and the types that depend on them.
    pub(super) fn finish(mut self, line: u32) -> Result<Function, ParseError> {
        if self.function.layout.is_empty() {
            return Err(ParseError { line, message: format!("function @{} has no block", self.function.name) });
        }
        let undefined = |prefix: char, names: &FxHashMap<u32, Mentioned>, defined: &dyn Fn(usize) -> bool| {
            let missing = names.iter().filter(|(_, mention)| !defined(mention.index));
            missing.min_by_key(|(_, mention)| mention.index).map_or(Ok(()), |(number, mention)| {
                Err(ParseError { line: mention.line, message: format!("{prefix}{number} is defined nowhere") })
            })
        };
        undefined('v', &self.values, &|index| self.defined_values[index].is_some())?;
        undefined('b', &self.blocks, &|index| self.defined_blocks[index].is_some())?;
        let value = |mention: Value| self.defined_values[mention.index()].expect("all values are defined");
        let block = |mention: Block| self.defined_blocks[mention.index()].expect("all blocks are defined");
        for data in self.function.insts.values_mut() {
            data.map_uses(value);
            data.for_each_target_mut(|call| call.block = block(call.block));
        }
        let mut waiting: Vec<_> =
            self.waiting.iter().map(|&(result, other, line)| (result, value(other), line)).collect();
        settle_types(&mut self.function, &mut waiting)?;
        for (stored, ty, line) in self.stores {
            let actual = self.function.ty(value(stored));
            if actual != ty {
                let message = format!("the stored value is of type {}, not {}", actual.name(), ty.name());
                return Err(ParseError { line, message });
            }
        }
        Ok(self.function)
    }
}

/// Returns each waiting result the type of the other value. Values are usually defined before they are used, so that one
/// round does it.
fn settle_types(function: &mut Function, waiting: &mut Vec<(Value, Value, u32)>) -> Result<(), ParseError> {
    let mut unknown = vec![false; function.values.len()];
    for &(result, _, _) in waiting.iter() {
        unknown[result.index()] = true;
    }
    while let Some(&(_, _, line)) = waiting.first() {
        let before = waiting.len();
        waiting.retain(|&(result, other, _)| {
            let wait = unknown[other.index()];
            if !wait {
                function.values[result].ty = function.values[other].ty;
                unknown[result.index()] = false;
                debug_assert!(matches!(function.values[result].def, ValueDef::Result(..)));
            }
            wait
        });
        if waiting.len() == before {
            return Err(ParseError { line, message: "the value is defined by itself".into() });
        }
    }
    Ok(())
}
