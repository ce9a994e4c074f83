//! Object files and texts.

use plcc_abi::Type;
use plcc_abi::image::{BlockKind, Site};
use plcc_codegen::{
    CodegenError, CodegenOptions, JitProgram, LOOP_PASSES, asm_text, clif_text, compile_object, statistics,
};
use plcc_ir::{Address, BinaryOp, FunctionBuilder, Loc, Module, Region, RuntimeFn};

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
    let asm = asm_text(&module, &CodegenOptions::default(), &|_| String::new()).expect("it compiles");
    for part in ["plcc_FC12:", "plcc_OB1:", "plcc_keep_safepoint"] {
        assert!(asm.contains(part), "{part} in\n{asm}");
    }
}

#[test]
fn a_byte_is_extended_where_it_is_loaded() {
    let mut b = FunctionBuilder::new("OB1", &[], &[]);
    let byte = b.load(Type::I8, Address::direct(Region::M, 0));
    b.store(Address::direct(Region::M, 1), byte);
    let word = b.zext(Type::I32, byte);
    b.store(Address::direct(Region::M, 4), word);
    b.ret(&[]);
    let clif = clif_text(&module(vec![b.finish()]), &CodegenOptions::default()).expect("it compiles");
    assert!(clif.contains("uload8") && !clif.contains("uextend.i32"), "{clif}");
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

/// A loop, a jump table and a cold side.
fn with_statements() -> Module {
    let mut b = FunctionBuilder::new("OB1", &[], &[]);
    let again = b.create_block();
    let cold = b.create_cold_block();
    let arms: Vec<_> = (0..6).map(|_| b.create_block()).collect();
    let end = b.create_block();
    b.set_loc(Loc(1));
    b.jump(again, &[]);
    b.switch_to(again);
    b.set_loc(Loc(2));
    let value = b.load(Type::I32, Address::direct(Region::M, 0));
    let value = b.binary_imm(BinaryOp::Iadd, value, 1);
    b.store(Address::direct(Region::M, 0), value);
    let bit = b.load_bit(Address::direct(Region::M, 8), 0);
    let choice = b.create_block();
    b.branch(bit, cold, choice);
    b.switch_to(cold);
    let site = b.i32_const(0);
    b.call_runtime(RuntimeFn::Safepoint, &[site]);
    b.jump(again, &[]);
    b.switch_to(choice);
    b.set_loc(Loc(3));
    b.switch(value, &arms, end);
    for (number, &arm) in arms.iter().enumerate() {
        b.switch_to(arm);
        let value = b.i32_const(77 * number as u32);
        b.store(Address::direct(Region::M, 16 + 4 * number as u32), value);
        let to = if number == 0 { again } else { end };
        b.jump(to, &[]);
    }
    b.switch_to(end);
    b.set_loc(Loc(4));
    b.ret(&[]);
    [again, cold, choice, end].into_iter().chain(arms).for_each(|block| b.seal_block(block));
    let site = |line, network| Site { file: 0, line, block: BlockKind::Ob, block_number: 1, network };
    let sites = vec![site(2, 1), site(3, 1), site(7, 2), site(9, 2)];
    Module { sites, files: vec!["a.stl".to_string()], ..module(vec![b.finish()]) }
}

#[test]
fn assembly_names_the_source_of_each_piece() {
    let source = |site: &Site| format!("line {}", site.line);
    let text = asm_text(&with_statements(), &CodegenOptions::default(), &source).expect("it compiles");
    for part in ["| line 3\n", "| line 7\n", "# data\n", " # plcc_keep_safepoint"] {
        assert!(text.contains(part), "{part} in\n{text}");
    }
    assert!(!text.contains("(bad)"), "tables are not read as instructions:\n{text}");
}

#[test]
fn statistics_count_every_byte_once() {
    let module = with_statements();
    let options = CodegenOptions::default();
    let (rows, others) = statistics(&module, &options).expect("it compiles");
    let networks: Vec<u16> = rows.iter().map(|(key, _)| key.network).collect();
    assert_eq!(networks, [1, 2]);
    let mut total = others;
    rows.iter().for_each(|(_, cost)| total.add(*cost));
    let text = asm_text(&module, &options, &|_| String::new()).expect("it compiles");
    let head = format!("plcc_OB1: # {} bytes, {} instructions\n", total.bytes, total.instructions);
    assert!(text.starts_with(&head), "{head} for\n{text}");
    let [(_, looping), (_, last)] = rows.as_slice() else { panic!("there are two networks") };
    assert!(looping.cold > 0 && looping.cold < looping.instructions, "{looping:?}");
    assert!(looping.nanoseconds > 0.0 && last.nanoseconds > 0.0);
    // What is in the loop counts as often as the loop is thought to run.
    let hot = (looping.instructions - looping.cold) as f64;
    assert!(looping.nanoseconds / hot > 0.1 * LOOP_PASSES / 2.0, "{looping:?}");
}
