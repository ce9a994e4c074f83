//! DWARF line tables of an object file.

use cranelift_object::ObjectProduct;
use plcc_ir::Module;

use crate::CodegenError;
use crate::compile::CompiledFunction;

pub fn add(
    _module: &Module,
    _functions: &[CompiledFunction],
    _product: &mut ObjectProduct,
) -> Result<(), CodegenError> {
    Ok(())
}
