//! A block with statements that tests use as the texts of charts.

use plcc_abi::image::BlockKind;
use plcc_diag::{SourceFile, SourceMap};
use plcc_syntax::scl::ast::{Dialect, Statement};
use plcc_syntax::{ParseOptions, ast};

use crate::bind::chart::ChartBinder;
use crate::bind::declarations::Declarations;
use crate::bind::declarations::block::CurrentBlock;
use crate::bind::declarations::shipped::empty;
use crate::bind::scl::{SclBlock, Scope};
use plcc_binding::BindInput;
use plcc_model::BlockKey;

/// Static data of the function block, from byte 0 on.
const DATA: &str =
    "b : BOOL; c : BOOL; i : INT; d : DINT; r : REAL; t : TIME; w : WORD; s5 : S5TIME; a : ARRAY[0..3] OF BOOL;";

/// The program, apart from the block with the rows.
const OTHERS: &str = "FUNCTION FC 5 : INT\nVAR_INPUT\n x : INT;\nEND_VAR\nVAR_OUTPUT\n y : INT;\nEND_VAR\nBEGIN\n\
    #y := #x;\nFC5 := #x;\nEND_FUNCTION\nFUNCTION_BLOCK FB 7\nVAR_INPUT\n x : INT;\nEND_VAR\nVAR_OUTPUT\n y : INT;\n\
    END_VAR\nBEGIN\n#y := #x;\nEND_FUNCTION_BLOCK\nDATA_BLOCK DB 7 FB 7\nBEGIN\nEND_DATA_BLOCK\n";

/// Runs a function on the statements of an SCL function block before they are bound; returns its result and the message codes.
pub fn in_block<T>(
    statements: &str,
    work: impl FnOnce(&mut ChartBinder, &mut SclBlock, &[Statement]) -> T,
) -> (T, Vec<&'static str>) {
    let source =
        format!("{OTHERS}FUNCTION_BLOCK FB 1\nVAR\n{DATA}\nEND_VAR\nBEGIN\n{statements}\nEND_FUNCTION_BLOCK\n");
    let mut sources = SourceMap::default();
    let file = sources.add(SourceFile::new("test.scl", &*source));
    let (unit, diagnostics) = plcc_syntax::scl::parse(file, &source, &ParseOptions::default());
    assert!(diagnostics.is_empty(), "{diagnostics:#?}");
    let units = [(file, unit)];
    let input = BindInput { name: "test".to_string(), units: &units, pragmas: true, ..empty(&sources) };
    let mut program = Declarations::new(&input);
    program.globals.collect();
    program.bind_types();
    program.bind_data();
    let key = BlockKey { kind: BlockKind::Fb, number: 1 };
    let source = program.globals.sources.code[&key].clone();
    let block = source.block();
    let ast::Code::Scl(code) = &block.code else { panic!("the test is SCL") };
    let bound = program.interface(key, block.name.span()).expect("the interface is good");
    let mut current = CurrentBlock::new(key, bound);
    let mut ctx = SclBlock { block: &mut current, scope: Scope::new(&input, &block.header, Dialect::Tia) };
    let result = work(&mut ChartBinder::new(&mut program), &mut ctx, &code.statements);
    (result, program.globals.report.finish().0.iter().map(|message| message.code.name()).collect())
}
