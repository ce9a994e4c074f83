//! A module to an object file.
//!
//! In addition to the code it exports `plcc_image` (the encoded `ProgramImage`), `plcc_image_len` (its length, a `u64`),
//! `plcc_entries` (the addresses of the entry functions) and `plcc_entries_len` (how many, a `u64`).
//!
//! Several programs share an executable if each exports under its own prefix; a directory object then represents
//! the program: `plcc_image_len` is 0, and `plcc_image` holds, for each of `plcc_entries_len` programs, the addresses of its
//! four symbols in the order above.

use cranelift_module::{DataDescription, FuncId as SymbolId, Linkage, Module as _};
use cranelift_object::{ObjectBuilder, ObjectModule};
use plcc_ir::Module;
use plcc_ir::entities::Entity;

use crate::compile::Compiler;
use crate::isa::{Placement, Tuning, isa};
use crate::{CodegenError, CodegenOptions, lines};

/// Object file of `module`, to be linked with the runtime. `image` is its encoded `ProgramImage`.
pub fn compile_object(module: &Module, image: &[u8], options: &CodegenOptions) -> Result<Vec<u8>, CodegenError> {
    compile_object_as(PREFIX, module, image, options)
}

/// The prefix of exported symbols of a single program.
const PREFIX: &str = "plcc";

/// The names after the prefix, in the order of a directory.
const SUFFIXES: [&str; 4] = ["_image", "_image_len", "_entries", "_entries_len"];

/// Object file that exports its symbols with `prefix` in place of `plcc`; see the module comment.
pub fn compile_object_as(
    prefix: &str,
    module: &Module,
    image: &[u8],
    options: &CodegenOptions,
) -> Result<Vec<u8>, CodegenError> {
    let compiler = Compiler::new(module, Placement::Object, options)?;
    let functions = compiler.functions()?;
    let builder =
        ObjectBuilder::new(compiler.isa.clone(), "plcc", cranelift_module::default_libcall_names()).map_err(output)?;
    let mut object = ObjectModule::new(builder);
    compiler.declare(&mut object)?;
    for (id, function) in module.functions.keys().zip(&functions) {
        object
            .define_function_bytes(symbol_id(id), function.alignment, &function.bytes, &function.relocs)
            .map_err(output)?;
    }
    for (number, function) in compiler.keeping_functions()? {
        object
            .define_function_bytes(SymbolId::from_u32(number), function.alignment, &function.bytes, &function.relocs)
            .map_err(output)?;
    }
    let entries = entry_table(module, &mut object);
    export_program(
        &mut object,
        prefix,
        [described(image.to_vec()), length(image.len()), entries, length(module.entries.len())],
    )?;
    let mut product = object.finish();
    lines::add(module, &functions, &mut product)?;
    product.emit().map_err(|error| CodegenError::Output(error.to_string()))
}

/// The object file that makes one executable of the programs which export under `prefixes`; see the module comment.
pub fn directory_object(prefixes: &[&str]) -> Result<Vec<u8>, CodegenError> {
    let target = isa(Placement::Object, &CodegenOptions::default(), Tuning::default())?;
    let builder = ObjectBuilder::new(target, "plcc", cranelift_module::default_libcall_names()).map_err(output)?;
    let mut object = ObjectModule::new(builder);
    let mut directory = described(vec![0; POINTER_BYTES * SUFFIXES.len() * prefixes.len()]);
    let names = prefixes.iter().flat_map(|prefix| SUFFIXES.map(|suffix| format!("{prefix}{suffix}")));
    for (index, name) in names.enumerate() {
        let id = object.declare_data(&name, Linkage::Import, false, false).map_err(output)?;
        let symbol = object.declare_data_in_data(id, &mut directory);
        directory.write_data_addr((POINTER_BYTES * index) as u32, symbol, 0);
    }
    export_program(&mut object, PREFIX, [directory, length(0), described(Vec::new()), length(prefixes.len())])?;
    object.finish().emit().map_err(|error| CodegenError::Output(error.to_string()))
}

/// Exports the parts of a program, in the order of [`SUFFIXES`].
fn export_program(object: &mut ObjectModule, prefix: &str, data: [DataDescription; 4]) -> Result<(), CodegenError> {
    SUFFIXES.iter().zip(data).try_for_each(|(suffix, data)| export(object, &format!("{prefix}{suffix}"), data))
}

fn length(length: usize) -> DataDescription {
    described((length as u64).to_ne_bytes().to_vec())
}

fn symbol_id(id: plcc_ir::FuncId) -> SymbolId {
    SymbolId::from_u32(id.index() as u32)
}

fn described(bytes: Vec<u8>) -> DataDescription {
    let mut data = DataDescription::new();
    // A symbol of no length would share its address with its neighbour.
    data.define(if bytes.is_empty() { vec![0] } else { bytes }.into_boxed_slice());
    data.set_align(8);
    data
}

/// Size of an address on every machine that code is made for.
const POINTER_BYTES: usize = 8;

fn entry_table(module: &Module, object: &mut ObjectModule) -> DataDescription {
    let mut data = described(vec![0; POINTER_BYTES * module.entries.len()]);
    for (index, &entry) in module.entries.iter().enumerate() {
        let function = object.declare_func_in_data(symbol_id(entry), &mut data);
        data.write_function_addr((POINTER_BYTES * index) as u32, function);
    }
    data
}

fn export(object: &mut ObjectModule, name: &str, data: DataDescription) -> Result<(), CodegenError> {
    let id = object.declare_data(name, Linkage::Export, false, false).map_err(output)?;
    object.define_data(id, &data).map_err(output)
}

fn output(error: cranelift_module::ModuleError) -> CodegenError {
    CodegenError::Output(error.to_string())
}
