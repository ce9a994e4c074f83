//! Object files and texts.

use plcc_abi::Type;
use plcc_abi::image::{BlockKind, Site};
use plcc_codegen::{CodegenError, CodegenOptions, JitProgram, asm_text, clif_text, compile_object};
use plcc_ir::{Address, FunctionBuilder, Loc, Module, Region, RuntimeFn};

use crate::harness::{entry, func, module};

#[test]
fn an_object_exports_what_the_runtime_needs() {
    let module = entry(|b| {
        let site = b.i32_const(0);
        b.call_runtime(RuntimeFn::Safepoint, &[site]);
    });
    let object = compile_object(&module, b"image", &CodegenOptions::default()).expect("it compiles");
    assert_eq!(&object[..4], b"\x7fELF");
    for name in ["plcc_program", "plcc_OB1", "plcc_keep_safepoint"] {
        let named = [b"\0", name.as_bytes(), b"\0"].concat();
        assert!(object.windows(named.len()).any(|window| window == named), "{name}");
    }
    let again = compile_object(&module, b"image", &CodegenOptions::default()).expect("it compiles");
    assert!(object == again, "the same module gives the same bytes");
}

#[test]
fn an_object_has_a_line_table_if_the_module_knows_lines() {
    let mut module = entry(|b| {
        b.set_loc(Loc(2));
        let value = b.load(Type::I8, Address::direct(Region::M, 0));
        b.store(Address::direct(Region::M, 1), value);
    });
    let has_lines = |module: &Module| {
        let object = compile_object(module, b"image", &CodegenOptions::default()).expect("it compiles");
        object.windows(12).any(|window| window == b".debug_line\0")
    };
    assert!(!has_lines(&module));
    module.files = vec![String::new(), "main.stl".to_string()];
    for line in [1, 70_000] {
        module.sites.push(Site { file: 1, line, block: BlockKind::Ob, block_number: 1, network: 1 });
    }
    assert!(has_lines(&module));
}

#[test]
fn texts_name_functions() {
    let mut callee = FunctionBuilder::new("FC12", &[Type::I32], &[Type::I32]);
    let param = callee.param(0);
    callee.ret(&[param]);
    let mut caller = FunctionBuilder::new("OB1", &[], &[]);
    let zero = caller.load(Type::I32, Address::direct(Region::M, 0));
    caller.call(func(0), vec![zero], &[Type::I32]);
    let site = caller.i32_const(0);
    caller.call_runtime(RuntimeFn::Safepoint, &[site]);
    caller.ret(&[]);
    let module = module(vec![callee.finish(), caller.finish()]);
    let clif = clif_text(&module, &CodegenOptions::default()).expect("it compiles");
    for part in ["function %plcc_FC12(i64, i32) -> i32", "%plcc_FC12", "%plcc_keep_safepoint"] {
        assert!(clif.contains(part), "{part} in\n{clif}");
    }
    let asm = asm_text(&module, &CodegenOptions::default()).expect("it compiles");
    for part in ["plcc_FC12:", "plcc_OB1:", "plcc_keep_safepoint"] {
        assert!(asm.contains(part), "{part} in\n{asm}");
    }
}

#[test]
fn broken_modules_are_errors() {
    let mut b = FunctionBuilder::new("FC1", &[Type::I32], &[]);
    b.ret(&[]);
    let mut with_params = module(vec![b.finish()]);
    with_params.entries.push(func(0));
    let missing_db = entry(|b| {
        b.load(Type::I8, Address::direct(Region::Db(99), 0));
    });
    for module in [with_params, missing_db] {
        let result = JitProgram::compile(&module, &|_| std::ptr::null(), &CodegenOptions::default());
        assert!(matches!(result, Err(CodegenError::Module { .. })));
    }
}
