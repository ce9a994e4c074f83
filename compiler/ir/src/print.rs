//! The text form of a module.
//!
//! ```text
//! file "FC12.stl"
//! site 1: file 0 line 3 FC12 network 1
//! db 10 at 0x400000 length 20
//! entry @OB1
//!
//! func @FC12 -> i32, i1 frame 16 {
//! b0(v0: i32):
//!     v1 = load.bit I 0.0 !1
//!     v2 = load.i32 any[v0]+8
//!     store.bit Q 4.0, v1
//!     branch v1, b1(v2), b2
//! b1(v3: i32):
//!     v4, v5 = call @FC13(v3, v1)
//!     v6 = rt @s7200_counter(v4)
//!     switch v6 [b2, b3], b2
//! b2 cold:
//!     ...
//! }
//! ```
//!
//! Lines without a site (`!1`) have none. A `;` begins a comment. Numbers are those of the canonical form (see
//! [`Function::renumber`]), whatever the stored ones are. [`parse_module`](crate::parse::parse_module) reads it back.

use std::fmt::{self, Write};

use plcc_abi::Type;

use crate::entities::{Block, EntityVec, Inst, Value};
use crate::function::Function;
use crate::instructions::{Address, BlockCall, InstData, Region};
use crate::module::Module;

/// The text form of a module; see the module comment.
pub fn module_text(module: &Module) -> String {
    let mut out = String::new();
    write_module(module, &mut out).expect("a String takes all text");
    out
}

/// The text form of one function of `module`.
#[cfg(test)]
pub(crate) fn function_text(module: &Module, function: &Function) -> String {
    let mut out = String::new();
    write_function(module, function, &mut out).expect("a String takes all text");
    out
}

fn write_module(module: &Module, out: &mut String) -> fmt::Result {
    for file in &module.files {
        writeln!(out, "file {}", quoted(file))?;
    }
    for (index, site) in (1u32..).zip(&module.sites) {
        let (block, number) = (site.block.prefix(), site.block_number);
        writeln!(out, "site {index}: file {} line {} {block}{number} network {}", site.file, site.line, site.network)?;
    }
    for db in &module.dbs {
        let read_only = if db.read_only { " read_only" } else { "" };
        writeln!(out, "db {} at {:#x} length {}{read_only}", db.number, db.address, db.length)?;
    }
    for &entry in &module.entries {
        match module.functions.get(entry) {
            Some(function) => writeln!(out, "entry @{}", function.name)?,
            None => writeln!(out, "entry @?{entry}")?,
        }
    }
    for function in module.functions.values() {
        if !out.is_empty() {
            out.push('\n');
        }
        write_function(module, function, out)?;
    }
    Ok(())
}

fn write_function(module: &Module, function: &Function, out: &mut String) -> fmt::Result {
    let text = FunctionText::new(module, function);
    write!(out, "func @{}", function.name)?;
    for (index, ty) in function.returns.iter().enumerate() {
        write!(out, "{}{}", if index == 0 { " -> " } else { ", " }, ty.name())?;
    }
    if function.frame_bytes != 0 {
        write!(out, " frame {}", function.frame_bytes)?;
    }
    if function.inlined_bytes != 0 {
        write!(out, " inlined {}", function.inlined_bytes)?;
    }
    if function.apart {
        out.push_str(" apart");
    }
    if function.by_pointers {
        out.push_str(" by_pointers");
    }
    out.push_str(" {\n");
    for &block in &function.layout {
        text.write_block(block, out)?;
    }
    out.push_str("}\n");
    Ok(())
}

/// A file name between quotes, with `"`, `\` and control characters escaped.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => write!(out, "\\u{{{:x}}}", c as u32).expect("a String takes all text"),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// A function with the numbers that are printed.
struct FunctionText<'a> {
    module: &'a Module,
    function: &'a Function,
    values: EntityVec<Value, u32>,
    blocks: EntityVec<Block, u32>,
}

/// Number of an entity without a definition.
const UNKNOWN: u32 = u32::MAX;

impl<'a> FunctionText<'a> {
    fn new(module: &'a Module, function: &'a Function) -> Self {
        let mut values = EntityVec::filled(UNKNOWN, function.values.len());
        let mut blocks = EntityVec::filled(UNKNOWN, function.blocks.len());
        let mut next = 0;
        for (number, &block) in (0u32..).zip(&function.layout) {
            blocks[block] = number;
            let data = &function.blocks[block];
            let results = data.insts.iter().flat_map(|&inst| &function.results[inst]);
            for &value in data.params.iter().chain(results) {
                values[value] = next;
                next += 1;
            }
        }
        FunctionText { module, function, values, blocks }
    }

    fn write_block(&self, block: Block, out: &mut String) -> fmt::Result {
        let data = &self.function.blocks[block];
        out.push_str(&self.block(block));
        for (index, &param) in data.params.iter().enumerate() {
            let separator = if index == 0 { "(" } else { ", " };
            write!(out, "{separator}{}: {}", self.value(param), self.function.ty(param).name())?;
        }
        if !data.params.is_empty() {
            out.push(')');
        }
        out.push_str(if data.cold { " cold:\n" } else { ":\n" });
        for &inst in &data.insts {
            self.write_inst(inst, out)?;
        }
        Ok(())
    }

    fn write_inst(&self, inst: Inst, out: &mut String) -> fmt::Result {
        out.push_str("    ");
        let results = &self.function.results[inst];
        if !results.is_empty() {
            write!(out, "{} = ", self.values(results))?;
        }
        self.write_operation(&self.function.insts[inst], results.first().copied(), out)?;
        let loc = self.function.locs[inst];
        if loc.0 != 0 {
            write!(out, " !{}", loc.0)?;
        }
        if let (InstData::Const { bits }, Some(&result)) = (&self.function.insts[inst], results.first()) {
            // For the reader: the bits alone say little.
            match self.function.ty(result) {
                Type::F32 => write!(out, " ; {:?}", f32::from_bits(*bits as u32))?,
                Type::F64 => write!(out, " ; {:?}", f64::from_bits(*bits))?,
                Type::I1 | Type::I8 | Type::I16 | Type::I32 | Type::I64 => {}
            }
        }
        out.push('\n');
        Ok(())
    }

    fn write_operation(&self, data: &InstData, result: Option<Value>, out: &mut String) -> fmt::Result {
        let ty = result.map_or("?", |value| self.function.ty(value).name());
        match data {
            InstData::Const { bits } => match result.map(|value| self.function.ty(value)) {
                Some(Type::F32 | Type::F64) => write!(out, "const.{ty} {bits:#x}"),
                _ => write!(out, "const.{ty} {bits}"),
            },
            InstData::Unary { op, arg } => write!(out, "{} {}", op.name(), self.value(*arg)),
            InstData::Binary { op, args } => write!(out, "{} {}", op.name(), self.values(args)),
            InstData::IntCompare { cc, args } => write!(out, "{} {}", cc.name(), self.values(args)),
            InstData::FloatCompare { cc, args } => write!(out, "{} {}", cc.name(), self.values(args)),
            InstData::Convert { op, arg } => write!(out, "{}.{ty} {}", op.name(), self.value(*arg)),
            InstData::Select { cond, if_true, if_false } => {
                write!(out, "select {}", self.values(&[*cond, *if_true, *if_false]))
            }
            InstData::Load { addr } => write!(out, "load.{ty} {}", self.address(addr)),
            InstData::Store { addr, value } => {
                let ty = self.function.ty(*value).name();
                write!(out, "store.{ty} {}, {}", self.address(addr), self.value(*value))
            }
            InstData::LoadBit { addr, bit } => write!(out, "load.bit {}.{bit}", self.address(addr)),
            InstData::StoreBit { addr, bit, value } => {
                write!(out, "store.bit {}.{bit}, {}", self.address(addr), self.value(*value))
            }
            InstData::AddressOf { addr } => write!(out, "address {}", self.address(addr)),
            InstData::Clear { addr, len } => write!(out, "clear {}, {len}", self.address(addr)),
            InstData::Copy { to, from, len } => {
                write!(out, "copy {}, {}, {len}", self.address(to), self.address(from))
            }
            InstData::DbBase { number } => write!(out, "db_base {}", self.value(*number)),
            InstData::DbLength { number } => write!(out, "db_length {}", self.value(*number)),
            InstData::Call { callee, args } => match self.module.functions.get(*callee) {
                Some(function) => write!(out, "call @{}({})", function.name, self.values(args)),
                None => write!(out, "call @?{callee}({})", self.values(args)),
            },
            InstData::CallRuntime { function, args } => {
                write!(out, "rt @{}({})", function.name(), self.values(args))
            }
            InstData::FrameBase { callee: false } => write!(out, "frame_base"),
            InstData::FrameBase { callee: true } => write!(out, "callee_frame_base"),
            InstData::Jump { target } => write!(out, "jump {}", self.target(target)),
            InstData::Branch { cond, then_to, else_to } => {
                write!(out, "branch {}, {}, {}", self.value(*cond), self.target(then_to), self.target(else_to))
            }
            InstData::Switch { value, targets, default } => {
                let list: Vec<String> = targets.iter().map(|target| self.target(target)).collect();
                write!(out, "switch {} [{}], {}", self.value(*value), list.join(", "), self.target(default))
            }
            InstData::Return { values } if values.is_empty() => write!(out, "ret"),
            InstData::Return { values } => write!(out, "ret {}", self.values(values)),
        }
    }

    fn value(&self, value: Value) -> String {
        match self.values.get(self.function.resolve(value)) {
            Some(&UNKNOWN) | None => format!("?{value}"),
            Some(number) => format!("v{number}"),
        }
    }

    fn values(&self, values: &[Value]) -> String {
        values.iter().map(|&value| self.value(value)).collect::<Vec<_>>().join(", ")
    }

    fn block(&self, block: Block) -> String {
        match self.blocks.get(block) {
            Some(&UNKNOWN) | None => format!("?{block}"),
            Some(number) => format!("b{number}"),
        }
    }

    fn target(&self, call: &BlockCall) -> String {
        let block = self.block(call.block);
        if call.args.is_empty() { block } else { format!("{block}({})", self.values(&call.args)) }
    }

    fn address(&self, addr: &Address) -> String {
        let region = region_name(addr.region);
        match addr.base {
            None => format!("{region} {}", addr.offset),
            Some(base) => format!("{region}[{}]+{}", self.value(base), addr.offset),
        }
    }
}

/// Name of a region in the text form: `M`, `DB10`, `any`.
pub fn region_name(region: Region) -> String {
    match region {
        Region::State => "state".into(),
        Region::I => "I".into(),
        Region::Q => "Q".into(),
        Region::M => "M".into(),
        Region::System => "system".into(),
        Region::Cells => "cells".into(),
        Region::L => "L".into(),
        Region::V => "V".into(),
        Region::Db(number) => format!("DB{number}"),
        Region::AnyDb => "anydb".into(),
        Region::Any => "any".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn file_names_are_escaped() {
        assert_eq!(quoted("a\"b\\c\n"), "\"a\\\"b\\\\c\\u{a}\"");
    }
}
