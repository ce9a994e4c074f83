//! A module to an object file.
//!
//! Beside the code it exports `plcc_image` (the encoded `ProgramImage`), `plcc_image_len` (its length, a `u64`),
//! `plcc_entries` (the addresses of the entry functions) and `plcc_entries_len` (how many, a `u64`).

use cranelift_module::{DataDescription, FuncId as SymbolId, Linkage, Module as _};
use cranelift_object::{ObjectBuilder, ObjectModule};
use plcc_ir::Module;
use plcc_ir::entities::Entity;

use crate::compile::Compiler;
use crate::isa::Placement;
use crate::{CodegenError, CodegenOptions, lines};

/// Object file of `module`, to be linked with the runtime. `image` is its encoded `ProgramImage`.
pub fn compile_object(module: &Module, image: &[u8], options: &CodegenOptions) -> Result<Vec<u8>, CodegenError> {
    let compiler = Compiler::new(module, Placement::Object, options)?;
    let functions = compiler.functions(false)?;
    let builder =
        ObjectBuilder::new(compiler.isa.clone(), "plcc", cranelift_module::default_libcall_names()).map_err(output)?;
    let mut object = ObjectModule::new(builder);
    compiler.declare(&mut object)?;
    for (id, function) in module.functions.keys().zip(&functions) {
        object
            .define_function_bytes(symbol_id(id), function.alignment, &function.bytes, &function.relocs)
            .map_err(output)?;
    }
    export(&mut object, "plcc_image", described(image.to_vec()))?;
    export(&mut object, "plcc_image_len", described((image.len() as u64).to_ne_bytes().to_vec()))?;
    let entries = entry_table(module, &mut object);
    export(&mut object, "plcc_entries", entries)?;
    export(&mut object, "plcc_entries_len", described((module.entries.len() as u64).to_ne_bytes().to_vec()))?;
    let mut product = object.finish();
    lines::add(module, &functions, &mut product)?;
    product.emit().map_err(|error| CodegenError::Output(error.to_string()))
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

fn entry_table(module: &Module, object: &mut ObjectModule) -> DataDescription {
    const POINTER_BYTES: usize = 8;
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
