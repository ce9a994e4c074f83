//! A module to an object file.
//!
//! In addition to the code it exports `plcc_program`, the [`LinkedProgram`] by which the runtime finds the encoded
//! `ProgramImage` and the entry functions.
//!
//! Several programs share an executable if each exports another name; a directory object then exports `plcc_program` and leads
//! to them.

use std::mem::offset_of;

use cranelift_module::{FuncId as SymbolId, Module as _};
use cranelift_object::{ObjectBuilder, ObjectModule};
use object::write::{Object, Relocation, StandardSection, Symbol, SymbolId as ObjectSymbol, SymbolSection};
use object::{RelocationEncoding, RelocationFlags, RelocationKind, SectionKind, SymbolFlags, SymbolKind, SymbolScope};
use plcc_abi::linked::{self, LinkedProgram};
use plcc_ir::Module;
use plcc_ir::entities::Entity;

use crate::compile::{CompiledFunction, Compiler};
use crate::isa::{Placement, Tuning, isa};
use crate::variables::Variables;
use crate::{CodegenError, CodegenOptions, lines};

/// Object file of `module`, to be linked with the runtime. `image` is its encoded `ProgramImage`.
pub fn compile_object(module: &Module, image: &[u8], options: &CodegenOptions) -> Result<Vec<u8>, CodegenError> {
    compile_object_as(linked::SYMBOL, module, image, options)
}

/// Object file that exports `name` in place of `plcc_program`; see the module comment.
pub fn compile_object_as(
    name: &str,
    module: &Module,
    image: &[u8],
    options: &CodegenOptions,
) -> Result<Vec<u8>, CodegenError> {
    let compiler = Compiler::new(module, Placement::Object, options)?;
    let functions = compiler.functions()?;
    object_of(name, &compiler, &functions, image, None)
}

/// Object file of compiled functions.
pub(crate) fn object_of(
    name: &str,
    compiler: &Compiler<'_>,
    functions: &[CompiledFunction],
    image: &[u8],
    variables: Option<&Variables<'_>>,
) -> Result<Vec<u8>, CodegenError> {
    let module = compiler.module;
    let builder =
        ObjectBuilder::new(compiler.isa.clone(), "plcc", cranelift_module::default_libcall_names()).map_err(output)?;
    let mut object = ObjectModule::new(builder);
    compiler.declare(&mut object)?;
    for (id, function) in module.functions.keys().zip(functions) {
        object
            .define_function_bytes(symbol_id(id), function.alignment, &function.bytes, &function.relocs)
            .map_err(output)?;
    }
    for (number, function) in compiler.keeping_functions()? {
        object
            .define_function_bytes(SymbolId::from_u32(number), function.alignment, &function.bytes, &function.relocs)
            .map_err(output)?;
    }
    let mut product = object.finish();
    let entries: Vec<ObjectSymbol> = module.entries.iter().map(|&id| product.function_symbol(symbol_id(id))).collect();
    export_program(&mut product.object, name, image, &entries)?;
    lines::add(module, functions, variables, &mut product)?;
    product.emit().map_err(|error| CodegenError::Output(error.to_string()))
}

/// The object file that makes one executable of the programs which export `names`; see the module comment.
pub fn directory_object(names: &[&str]) -> Result<Vec<u8>, CodegenError> {
    let target = isa(Placement::Object, &CodegenOptions::default(), Tuning::default())?;
    let builder = ObjectBuilder::new(target, "plcc", cranelift_module::default_libcall_names()).map_err(output)?;
    let mut object = ObjectModule::new(builder).finish().object;
    let programs: Vec<ObjectSymbol> =
        names.iter().map(|name| object.add_symbol(data_symbol(name, SymbolSection::Undefined))).collect();
    export_program(&mut object, linked::SYMBOL, &[], &programs)?;
    object.write().map_err(|error| CodegenError::Output(error.to_string()))
}

/// Exports a program with this image, whose table leads to `entries`.
fn export_program(
    object: &mut Object<'static>,
    name: &str,
    image: &[u8],
    entries: &[ObjectSymbol],
) -> Result<(), CodegenError> {
    const DISTANCE_BYTES: u64 = size_of::<i32>() as u64;
    let constants = object.section_id(StandardSection::ReadOnlyData);
    let start = object.section_symbol(constants);
    let image_at = object.append_section_data(constants, image, 8);
    let table_at = object.append_section_data(constants, &vec![0; entries.len() * DISTANCE_BYTES as usize], 8);
    for (offset, &symbol) in (table_at..).step_by(DISTANCE_BYTES as usize).zip(entries) {
        object.add_relocation(constants, distance(offset, symbol, 0)).map_err(unwritten)?;
    }
    let program =
        LinkedProgram { image: 0, entries: 0, image_len: image.len() as u64, entries_len: entries.len() as u64 };
    let section = object.add_section(Vec::new(), linked::SECTION.into(), SectionKind::ReadOnlyData);
    let at = object.append_section_data(section, &program.encode(), align_of::<LinkedProgram>() as u64);
    for (field, target) in
        [(offset_of!(LinkedProgram, image), image_at), (offset_of!(LinkedProgram, entries), table_at)]
    {
        object.add_relocation(section, distance(at + field as u64, start, target as i64)).map_err(unwritten)?;
    }
    let symbol = Symbol {
        value: at,
        size: size_of::<LinkedProgram>() as u64,
        ..data_symbol(name, SymbolSection::Section(section))
    };
    object.add_symbol(symbol);
    Ok(())
}

pub(crate) fn data_symbol(name: &str, section: SymbolSection) -> Symbol {
    Symbol {
        name: name.into(),
        value: 0,
        size: 0,
        kind: SymbolKind::Data,
        scope: SymbolScope::Linkage,
        weak: false,
        section,
        flags: SymbolFlags::None,
    }
}

/// The linker writes the distance from `offset` to `symbol` there, an `i32`.
fn distance(offset: u64, symbol: ObjectSymbol, addend: i64) -> Relocation {
    let flags =
        RelocationFlags::Generic { kind: RelocationKind::Relative, encoding: RelocationEncoding::Generic, size: 32 };
    Relocation { offset, symbol, addend, flags }
}

fn symbol_id(id: plcc_ir::FuncId) -> SymbolId {
    SymbolId::from_u32(id.index() as u32)
}

fn unwritten(error: object::write::Error) -> CodegenError {
    CodegenError::Output(error.to_string())
}

fn output(error: cranelift_module::ModuleError) -> CodegenError {
    CodegenError::Output(error.to_string())
}
