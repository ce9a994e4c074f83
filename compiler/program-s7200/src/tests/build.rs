//! Syntax trees.

use plcc_abi::image::Config;
use plcc_diag::{Diagnostic, FileId, SourceFile, SourceMap, Span};
use plcc_syntax::ast::{SourceUnit, Width};
use plcc_syntax::s7200::Insn;
use plcc_syntax::s7200::ast::*;

use plcc_binding::BindInput;
use plcc_model::profile;
use plcc_model::s7200::{S7200Body, StatementKind as Bound};
use plcc_model::{BlockKey, Program};

/// Each statement has its own position, so that messages can be distinguished.
fn span(at: usize) -> Span {
    Span::new(FileId(0), at..at + 1)
}

pub fn operand(kind: OperandKind) -> Operand {
    Operand { kind, shown: None, span: span(0) }
}

pub fn direct(area: Area, width: Option<Width>, number: u32, bit: u8) -> Operand {
    operand(OperandKind::Direct(Direct { area, width, number, bit }))
}

pub fn bit(area: Area, number: u32, bit: u8) -> Operand {
    direct(area, Some(Width::Bit), number, bit)
}

pub fn vb(number: u32) -> Operand {
    direct(Area::V, Some(Width::Byte), number, 0)
}

pub fn vw(number: u32) -> Operand {
    direct(Area::V, Some(Width::Word), number, 0)
}

pub fn vd(number: u32) -> Operand {
    direct(Area::V, Some(Width::Dword), number, 0)
}

pub fn ac(number: u32) -> Operand {
    direct(Area::Ac, None, number, 0)
}

pub fn t(number: u32) -> Operand {
    direct(Area::T, None, number, 0)
}

pub fn c(number: u32) -> Operand {
    direct(Area::C, None, number, 0)
}

pub fn int(value: i64) -> Operand {
    operand(OperandKind::Constant(Constant::Integer(value)))
}

pub fn constant(constant: Constant) -> Operand {
    operand(OperandKind::Constant(constant))
}

pub fn name(name: &str) -> Operand {
    operand(OperandKind::Symbol { name: name.to_string(), form: SymbolForm::Bare })
}

pub fn local(name: &str) -> Operand {
    operand(OperandKind::Symbol { name: name.to_string(), form: SymbolForm::Local })
}

pub fn star(pointer: Operand) -> Operand {
    operand(OperandKind::Indirect(Box::new(pointer)))
}

pub fn address_of(place: Operand) -> Operand {
    operand(OperandKind::AddressOf(Box::new(place)))
}

pub fn i00() -> Operand {
    bit(Area::I, 0, 0)
}

pub fn q00() -> Operand {
    bit(Area::Q, 0, 0)
}

/// A network.
pub fn network(statements: &[(Insn, &[Operand])]) -> Network {
    let statement = |(at, (insn, operands)): (usize, &(Insn, &[Operand]))| Statement {
        kind: StatementKind::Instruction { insn: *insn, mnemonic_span: span(at), operands: operands.to_vec() },
        span: span(at),
        comment: None,
    };
    Network {
        number: Some(1),
        title: String::new(),
        comment: Vec::new(),
        statements: statements.iter().enumerate().map(statement).collect(),
        span: span(0),
    }
}

pub fn block(kind: BlockKind, name: &str, number: Option<u32>, networks: Vec<Network>) -> Block {
    Block {
        kind,
        name: (!name.is_empty()).then(|| (name.to_string(), span(0))),
        number: number.map(|number| (number, span(0))),
        is_bare: false,
        title: String::new(),
        comment: Vec::new(),
        declarations: Vec::new(),
        networks,
        span: span(0),
    }
}

pub fn main(networks: Vec<Network>) -> Block {
    block(BlockKind::Main, "MAIN", Some(1), networks)
}

pub fn declared(mut block: Block, declarations: &[(Section, &str, &str)]) -> Block {
    block.declarations = declarations
        .iter()
        .map(|(section, name, ty)| Declaration {
            section: *section,
            name: name.to_string(),
            name_span: span(0),
            ty: ty.to_string(),
            ty_span: span(0),
            initial: None,
            comment: None,
        })
        .collect();
    block
}

/// Binds files of blocks and data for a CPU.
pub fn bind_files(files: Vec<(&str, Source)>, cpu: &str) -> (Program, Vec<Diagnostic>) {
    let mut sources = SourceMap::default();
    let mut units = Vec::new();
    for (name, source) in files {
        let file = sources.add(SourceFile::new(name, " ".repeat(100)));
        units.push((file, SourceUnit { s7200: Some(source), ..SourceUnit::default() }));
    }
    crate::bind(&BindInput {
        name: "test".to_string(),
        sources: &sources,
        units: &units,
        tables: &[],
        profile: profile::lookup(cpu).unwrap(),
        config: Config::default(),
        partial: false,
        stand_ins: None,
        pragmas: true,
        require_main: true,
        safety_as_standard: false,
        plain_charts: false,
    })
}

pub fn bind(blocks: Vec<Block>, cpu: &str) -> (Program, Vec<Diagnostic>) {
    let (program, diagnostics) = bind_files(vec![("test.awl", Source { blocks, data: Vec::new() })], cpu);
    (program, without_review(diagnostics))
}

/// Without what the review warns of: it has tests of its own, and programs of a few statements leave much without an effect.
pub fn without_review(mut diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
    const REVIEW: [&str; 3] = ["P0511", "P0536", "P0818"];
    diagnostics.retain(|diagnostic| !REVIEW.contains(&diagnostic.code.name()));
    diagnostics
}

/// A program without messages.
pub fn good(blocks: Vec<Block>) -> Program {
    let (program, diagnostics) = bind(blocks, "226");
    assert!(diagnostics.is_empty(), "{diagnostics:#?}");
    program
}

/// Codes of the messages about a program.
pub fn codes_on(blocks: Vec<Block>, cpu: &str) -> Vec<&'static str> {
    bind(blocks, cpu).1.iter().map(|diagnostic| diagnostic.code.name()).collect()
}

/// Codes of the messages about a main program of one network.
pub fn codes(statements: &[(Insn, &[Operand])]) -> Vec<&'static str> {
    codes_on(vec![main(vec![network(statements)])], "226")
}

pub fn body(program: &Program, kind: plcc_abi::image::BlockKind, number: u16) -> &S7200Body {
    match &program.block(BlockKey { kind, number }).expect("the test defines the block").body {
        plcc_model::Body::S7200(body) => body,
        _ => panic!("no block of an S7-200"),
    }
}

/// Operands of statement `index` of the main program.
pub fn operands(program: &Program, index: usize) -> &[plcc_model::s7200::Operand] {
    match &body(program, plcc_abi::image::BlockKind::Ob, 1).statements[index].kind {
        Bound::Instruction { operands, .. } => operands,
        Bound::Call { arguments, .. } => arguments,
        _ => panic!("no instruction"),
    }
}
