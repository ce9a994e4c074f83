//! Reads the text form of a module; see [`print`](crate::print) for its shape.
//!
//! Values and blocks may have any number in the text; they are numbered again in the order of their definitions, so
//! that the result is canonical. The parser checks what it needs to build the module (names, result types); whether
//! the module is valid is for the [verifier](crate::verify).

mod cursor;

use std::fmt;

use plcc_abi::image::{BlockKind, Site};
use plcc_abi::{RuntimeFn, Type};
use rustc_hash::FxHashMap;

use crate::entities::{Block, Entity, FuncId, Inst, Loc, Value};
use crate::function::{Function, ValueDef};
use crate::instructions::{Address, BinaryOp, BlockCall, ConvertOp, FloatCc, InstData, IntCc, Region, UnaryOp};
use crate::module::{Module, StaticDb};
use cursor::Cursor;

/// An error in a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParseError {
    /// 1-based.
    pub line: u32,
    pub message: String,
}

impl fmt::Display for ParseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.message)
    }
}

impl std::error::Error for ParseError {}

/// An error in a line; the caller adds the line number.
type LineResult<T> = Result<T, String>;

/// Reads a module. Errors: the first line that cannot be read.
pub fn parse_module(text: &str) -> Result<Module, ParseError> {
    let mut module = Module::default();
    let mut signatures = Signatures::default();
    // Function headers first: calls name functions that come later.
    for (number, line) in lines(text) {
        if line.starts_with("func ") {
            let function = located(number, parse_header(&mut Cursor::new(line)))?;
            let id = FuncId::new(signatures.returns.len());
            signatures.returns.push(function.returns);
            if signatures.ids.insert(function.name.clone(), id).is_some() {
                return Err(ParseError {
                    line: number,
                    message: format!("function @{} is defined twice", function.name),
                });
            }
        }
    }
    let mut open: Option<FunctionParser> = None;
    let mut last = 1;
    for (number, line) in lines(text) {
        last = number;
        let cursor = &mut Cursor::new(line);
        open = match open {
            None if line.starts_with("func ") => {
                Some(FunctionParser::new(located(number, parse_header(cursor))?, &signatures))
            }
            None => {
                located(number, parse_item(cursor, &mut module, &signatures))?;
                None
            }
            Some(parser) if line == "}" => {
                module.functions.push(parser.finish(number)?);
                None
            }
            Some(mut parser) => {
                parser.line = number;
                located(number, parser.parse_line(cursor))?;
                Some(parser)
            }
        };
    }
    match open {
        Some(parser) => {
            Err(ParseError { line: last, message: format!("function @{} has no end `}}`", parser.function.name) })
        }
        None => Ok(module),
    }
}

/// Numbered lines without comments and surrounding space; empty ones are left out.
fn lines(text: &str) -> impl Iterator<Item = (u32, &str)> {
    (1u32..).zip(text.lines()).filter_map(|(number, line)| {
        let line = without_comment(line).trim();
        (!line.is_empty()).then_some((number, line))
    })
}

fn without_comment(line: &str) -> &str {
    let mut quoted = false;
    let mut escaped = false;
    for (index, byte) in line.bytes().enumerate() {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if quoted => escaped = true,
            b'"' => quoted = !quoted,
            b';' if !quoted => return &line[..index],
            _ => {}
        }
    }
    line
}

fn located<T>(line: u32, result: LineResult<T>) -> Result<T, ParseError> {
    result.map_err(|message| ParseError { line, message })
}

/// Functions of the module by name.
#[derive(Default)]
struct Signatures {
    ids: FxHashMap<String, FuncId>,
    returns: Vec<Vec<Type>>,
}

impl Signatures {
    fn find(&self, name: &str) -> LineResult<FuncId> {
        self.ids.get(name).copied().ok_or_else(|| format!("there is no function @{name}"))
    }
}

/// `func @NAME -> TYPE, TYPE frame N inlined N {`
fn parse_header(cursor: &mut Cursor) -> LineResult<Function> {
    cursor.word_is("func")?;
    let mut function = Function::new(cursor.function_name()?);
    if cursor.take("->") {
        function.returns.push(cursor.ty()?);
        while cursor.take(",") {
            function.returns.push(cursor.ty()?);
        }
    }
    if cursor.take_word("frame") {
        function.frame_bytes = cursor.number()?;
    }
    if cursor.take_word("inlined") {
        function.inlined_bytes = cursor.number()?;
    }
    cursor.expect("{")?;
    cursor.end()?;
    Ok(function)
}

/// A line outside a function.
fn parse_item(cursor: &mut Cursor, module: &mut Module, signatures: &Signatures) -> LineResult<()> {
    match cursor.word()? {
        "file" => module.files.push(cursor.string()?),
        "site" => {
            let number: usize = cursor.number()?;
            if number != module.sites.len() + 1 {
                return Err(format!("site {} is expected here", module.sites.len() + 1));
            }
            cursor.expect(":")?;
            module.sites.push(parse_site(cursor)?);
        }
        "db" => {
            let number = cursor.number()?;
            cursor.word_is("at")?;
            let address = cursor.number()?;
            cursor.word_is("length")?;
            let length = cursor.number()?;
            let read_only = cursor.take_word("read_only");
            module.dbs.push(StaticDb { number, address, length, read_only });
        }
        "entry" => module.entries.push(signatures.find(cursor.function_name()?)?),
        word => return Err(format!("`file`, `site`, `db`, `entry` or `func` is expected, not `{word}`")),
    }
    cursor.end()
}

fn parse_site(cursor: &mut Cursor) -> LineResult<Site> {
    cursor.word_is("file")?;
    let file = cursor.number()?;
    cursor.word_is("line")?;
    let line = cursor.number()?;
    let name = cursor.word()?;
    let digits = name.find(|c: char| c.is_ascii_digit()).unwrap_or(name.len());
    let kinds =
        [BlockKind::Ob, BlockKind::Fc, BlockKind::Fb, BlockKind::Sfc, BlockKind::Sfb, BlockKind::Db].into_iter();
    let block = kinds.into_iter().find(|kind| kind.prefix() == &name[..digits]);
    let (Some(block), Ok(block_number)) = (block, name[digits..].parse()) else {
        return Err(format!("`{name}` is not a block, e.g. `FC12`"));
    };
    cursor.word_is("network")?;
    Ok(Site { file, line, block, block_number, network: cursor.number()? })
}

/// Type of a result: known at once, or that of a value that may be defined further down.
#[derive(Clone, Copy)]
enum ResultType {
    Known(Type),
    As(Value),
}

/// An instruction as read; values still have the numbers of their first mention.
struct Operation {
    data: InstData,
    results: Vec<ResultType>,
    /// Type of the stored value in the text.
    stored: Option<(Value, Type)>,
}

/// Reads the body of one function.
struct FunctionParser<'a> {
    signatures: &'a Signatures,
    function: Function,
    line: u32,
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
    fn new(function: Function, signatures: &'a Signatures) -> Self {
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

    fn parse_line(&mut self, cursor: &mut Cursor) -> LineResult<()> {
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

    fn parse_operation(&mut self, cursor: &mut Cursor) -> LineResult<Operation> {
        let opcode = cursor.word()?;
        let (name, suffix) = match opcode.split_once('.') {
            Some((name, suffix)) => (name, Some(suffix)),
            None => (opcode, None),
        };
        let plain = |data, results: &[ResultType]| Ok(Operation { data, results: results.to_vec(), stored: None });
        if let Some(suffix) = suffix {
            if suffix == "bit" {
                let (addr, bit) = match name {
                    "load" | "store" => self.bit_address(cursor)?,
                    _ => return Err(format!("`{opcode}` is not an instruction")),
                };
                if name == "load" {
                    return plain(InstData::LoadBit { addr, bit }, &[ResultType::Known(Type::I1)]);
                }
                cursor.expect(",")?;
                let value = self.value(cursor)?;
                return plain(InstData::StoreBit { addr, bit, value }, &[]);
            }
            let ty = type_named(suffix)?;
            if let Some(op) = ConvertOp::from_name(name) {
                let arg = self.value(cursor)?;
                return plain(InstData::Convert { op, arg }, &[ResultType::Known(ty)]);
            }
            return match name {
                "const" => {
                    let bits = cursor.number()?;
                    plain(InstData::Const { bits }, &[ResultType::Known(ty)])
                }
                "load" => {
                    let addr = self.address(cursor)?;
                    plain(InstData::Load { addr }, &[ResultType::Known(ty)])
                }
                "store" => {
                    let addr = self.address(cursor)?;
                    cursor.expect(",")?;
                    let value = self.value(cursor)?;
                    let stored = Some((value, ty));
                    Ok(Operation { data: InstData::Store { addr, value }, results: Vec::new(), stored })
                }
                _ => Err(format!("`{opcode}` is not an instruction")),
            };
        }
        if let Some(op) = UnaryOp::from_name(name) {
            let arg = self.value(cursor)?;
            return plain(InstData::Unary { op, arg }, &[ResultType::As(arg)]);
        }
        if let Some(op) = BinaryOp::from_name(name) {
            let args = self.pair(cursor)?;
            return plain(InstData::Binary { op, args }, &[ResultType::As(args[0])]);
        }
        if let Some(cc) = IntCc::from_name(name) {
            let args = self.pair(cursor)?;
            return plain(InstData::IntCompare { cc, args }, &[ResultType::Known(Type::I1)]);
        }
        if let Some(cc) = FloatCc::from_name(name) {
            let args = self.pair(cursor)?;
            return plain(InstData::FloatCompare { cc, args }, &[ResultType::Known(Type::I1)]);
        }
        let i32_result = [ResultType::Known(Type::I32)];
        match name {
            "select" => {
                let cond = self.value(cursor)?;
                cursor.expect(",")?;
                let [if_true, if_false] = self.pair(cursor)?;
                plain(InstData::Select { cond, if_true, if_false }, &[ResultType::As(if_true)])
            }
            "address" => {
                let addr = self.address(cursor)?;
                plain(InstData::AddressOf { addr }, &i32_result)
            }
            "clear" => {
                let addr = self.address(cursor)?;
                cursor.expect(",")?;
                plain(InstData::Clear { addr, len: cursor.number()? }, &[])
            }
            "copy" => {
                let to = self.address(cursor)?;
                cursor.expect(",")?;
                let from = self.address(cursor)?;
                cursor.expect(",")?;
                plain(InstData::Copy { to, from, len: cursor.number()? }, &[])
            }
            "db_base" => {
                let number = self.value(cursor)?;
                plain(InstData::DbBase { number }, &i32_result)
            }
            "db_length" => {
                let number = self.value(cursor)?;
                plain(InstData::DbLength { number }, &i32_result)
            }
            "call" => {
                let callee = self.signatures.find(cursor.function_name()?)?;
                let args = self.arguments(cursor)?;
                let returns = &self.signatures.returns[callee.index()];
                let results: Vec<ResultType> = returns.iter().map(|&ty| ResultType::Known(ty)).collect();
                plain(InstData::Call { callee, args }, &results)
            }
            "rt" => {
                let name = cursor.function_name()?;
                let function = RuntimeFn::ALL.iter().copied().find(|function| function.name() == name);
                let function = function.ok_or_else(|| format!("there is no runtime function @{name}"))?;
                let args = self.arguments(cursor)?;
                let results: Vec<ResultType> = function.result().map(ResultType::Known).into_iter().collect();
                plain(InstData::CallRuntime { function, args }, &results)
            }
            "frame_base" => plain(InstData::FrameBase { callee: false }, &i32_result),
            "callee_frame_base" => plain(InstData::FrameBase { callee: true }, &i32_result),
            "jump" => {
                let target = self.target(cursor)?;
                plain(InstData::Jump { target }, &[])
            }
            "branch" => {
                let cond = self.value(cursor)?;
                cursor.expect(",")?;
                let then_to = self.target(cursor)?;
                cursor.expect(",")?;
                let else_to = self.target(cursor)?;
                plain(InstData::Branch { cond, then_to, else_to }, &[])
            }
            "switch" => {
                let value = self.value(cursor)?;
                cursor.expect("[")?;
                let mut targets = Vec::new();
                if !cursor.take("]") {
                    targets.push(self.target(cursor)?);
                    while cursor.take(",") {
                        targets.push(self.target(cursor)?);
                    }
                    cursor.expect("]")?;
                }
                cursor.expect(",")?;
                let default = self.target(cursor)?;
                plain(InstData::Switch { value, targets, default }, &[])
            }
            "ret" => {
                let mut values = Vec::new();
                if cursor.starts_entity('v') {
                    values.push(self.value(cursor)?);
                    while cursor.take(",") {
                        values.push(self.value(cursor)?);
                    }
                }
                plain(InstData::Return { values }, &[])
            }
            _ => Err(format!("`{opcode}` is not an instruction")),
        }
    }

    /// A value by its number in the text; the result counts first mentions.
    fn value(&mut self, cursor: &mut Cursor) -> LineResult<Value> {
        let number = cursor.entity('v')?;
        let fresh = Mentioned { index: self.value_count, line: self.line };
        let mention = *self.values.entry(number).or_insert(fresh);
        if mention.index == self.value_count {
            self.value_count += 1;
            self.defined_values.push(None);
        }
        Ok(Value::new(mention.index))
    }

    fn block(&mut self, cursor: &mut Cursor) -> LineResult<Block> {
        let number = cursor.entity('b')?;
        let fresh = Mentioned { index: self.block_count, line: self.line };
        let mention = *self.blocks.entry(number).or_insert(fresh);
        if mention.index == self.block_count {
            self.block_count += 1;
            self.defined_blocks.push(None);
        }
        Ok(Block::new(mention.index))
    }

    fn pair(&mut self, cursor: &mut Cursor) -> LineResult<[Value; 2]> {
        let first = self.value(cursor)?;
        cursor.expect(",")?;
        Ok([first, self.value(cursor)?])
    }

    /// `(v1, v2)`
    fn arguments(&mut self, cursor: &mut Cursor) -> LineResult<Vec<Value>> {
        let mut args = Vec::new();
        cursor.expect("(")?;
        if cursor.take(")") {
            return Ok(args);
        }
        args.push(self.value(cursor)?);
        while cursor.take(",") {
            args.push(self.value(cursor)?);
        }
        cursor.expect(")")?;
        Ok(args)
    }

    /// `b1(v2)`
    fn target(&mut self, cursor: &mut Cursor) -> LineResult<BlockCall> {
        let block = self.block(cursor)?;
        let args = if cursor.peek("(") { self.arguments(cursor)? } else { Vec::new() };
        Ok(BlockCall { block, args })
    }

    /// `M 20` or `M[v4]+8`
    fn address(&mut self, cursor: &mut Cursor) -> LineResult<Address> {
        let name = cursor.word()?;
        let region = region_named(name).ok_or_else(|| format!("`{name}` is not a memory region"))?;
        let base = if cursor.take("[") {
            let base = self.value(cursor)?;
            cursor.expect("]")?;
            cursor.expect("+")?;
            Some(base)
        } else {
            None
        };
        Ok(Address { region, base, offset: cursor.number()? })
    }

    /// `Q 4.0`
    fn bit_address(&mut self, cursor: &mut Cursor) -> LineResult<(Address, u8)> {
        let addr = self.address(cursor)?;
        cursor.expect(".")?;
        Ok((addr, cursor.number()?))
    }

    /// Resolves forward references, and the types that depend on them.
    fn finish(mut self, line: u32) -> Result<Function, ParseError> {
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

fn type_named(name: &str) -> LineResult<Type> {
    const TYPES: [Type; 7] = [Type::I1, Type::I8, Type::I16, Type::I32, Type::I64, Type::F32, Type::F64];
    TYPES.into_iter().find(|ty| ty.name() == name).ok_or_else(|| format!("`{name}` is not a type"))
}

fn region_named(name: &str) -> Option<Region> {
    Some(match name {
        "state" => Region::State,
        "I" => Region::I,
        "Q" => Region::Q,
        "M" => Region::M,
        "system" => Region::System,
        "cells" => Region::Cells,
        "L" => Region::L,
        "V" => Region::V,
        "anydb" => Region::AnyDb,
        "any" => Region::Any,
        _ => Region::Db(name.strip_prefix("DB")?.parse().ok()?),
    })
}

#[cfg(test)]
mod tests;
