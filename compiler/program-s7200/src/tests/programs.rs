//! Blocks, their names and parameters, calls, data.

use plcc_abi::image::BlockKind as Kind;
use plcc_abi::s7200::pointer;
use plcc_syntax::ast::Width;
use plcc_syntax::s7200::Insn;
use plcc_syntax::s7200::ast::*;

use super::build::*;
use plcc_model::BlockKey;
use plcc_model::s7200::{Area as Bound, Direction, Operand as BoundOperand, StatementKind as BoundStatement};

fn key(kind: Kind, number: u16) -> BlockKey {
    BlockKey { kind, number }
}

/// Parameters and addresses of the example of the manual: IN1 L0.0, IN2 LB1, IN3 L2.0, IN4 LD3, INOUT1 LW7, OUT1 LD9.
fn demo() -> Block {
    let sub = block(BlockKind::Subroutine, "Demo", None, vec![network(&[(Insn::Load, &[local("IN3")])])]);
    declared(
        sub,
        &[
            (Section::Output, "OUT1", "DWORD"),
            (Section::Input, "IN1", "BOOL"),
            (Section::Input, "IN2", "BYTE"),
            (Section::Input, "IN3", "BOOL"),
            (Section::Input, "IN4", "DWORD"),
            (Section::InOut, "INOUT1", "WORD"),
        ],
    )
}

#[test]
fn places_of_parameters() {
    let program = good(vec![main(Vec::new()), demo()]);
    let body = body(&program, Kind::Sbr, 0);
    let places: Vec<_> =
        body.parameters.iter().map(|p| (p.name.as_str(), p.direction, p.width, p.byte, p.bit)).collect();
    assert_eq!(
        places,
        [
            ("IN1", Direction::In, Width::Bit, 0, 0),
            ("IN2", Direction::In, Width::Byte, 1, 0),
            ("IN3", Direction::In, Width::Bit, 2, 0),
            ("IN4", Direction::In, Width::Dword, 3, 0),
            ("INOUT1", Direction::InOut, Width::Word, 7, 0),
            ("OUT1", Direction::Out, Width::Dword, 9, 0),
        ]
    );
    let BoundStatement::Instruction { operands, .. } = &body.statements[0].kind else { panic!() };
    assert_eq!(operands[0], BoundOperand::Memory { area: Bound::L, byte: 2, bit: 0, width: Width::Bit });
}

#[test]
fn nine_bools_take_two_bytes() {
    let names: Vec<String> = (0..9).map(|number| format!("b{number}")).collect();
    let declarations: Vec<_> = names.iter().map(|name| (Section::Input, name.as_str(), "BOOL")).collect();
    let sub = declared(block(BlockKind::Subroutine, "S", None, Vec::new()), &declarations);
    let program = good(vec![main(Vec::new()), sub]);
    let last = body(&program, Kind::Sbr, 0).parameters[8].clone();
    assert_eq!((last.byte, last.bit), (1, 0));
}

#[test]
fn calls_hand_over_parameters() {
    let arguments = [
        name("demo"),
        bit(Area::I, 0, 4),
        vb(20),
        constant(Constant::Bool(true)),
        address_of(vb(60)),
        star(ac(2)),
        vd(300),
    ];
    let program = good(vec![main(vec![network(&[(Insn::Load, &[i00()]), (Insn::Call, &arguments)])]), demo()]);
    let expected = [
        BoundOperand::Memory { area: Bound::I, byte: 0, bit: 4, width: Width::Bit },
        BoundOperand::Memory { area: Bound::V, byte: 20, bit: 0, width: Width::Byte },
        BoundOperand::Const(1),
        BoundOperand::Const(u32::from(pointer::V) << 24 | 60),
        BoundOperand::Indirect {
            pointer: Box::new(BoundOperand::Accumulator { number: 2, width: Width::Dword }),
            width: Width::Word,
        },
        BoundOperand::Memory { area: Bound::V, byte: 300, bit: 0, width: Width::Dword },
    ];
    assert_eq!(operands(&program, 1), expected);
    let call = |arguments: &[Operand]| {
        codes_on(vec![main(vec![network(&[(Insn::Load, &[i00()]), (Insn::Call, arguments)])]), demo()], "226")
    };
    assert_eq!(call(&arguments[..6]), ["P0312"]);
    let mut more = arguments.to_vec();
    more.push(vb(0));
    assert_eq!(call(&more), ["P0311"]);
    let mut constant_out = arguments.to_vec();
    constant_out[6] = int(1);
    assert_eq!(call(&constant_out), ["P0411"]);
    assert_eq!(call(&[name("demi")]), ["P0302"]);
}

#[test]
fn strings_are_handed_over_as_pointers() {
    let sub = block(BlockKind::Subroutine, "Show", None, vec![network(&[(Insn::Slen, &[local("text"), vb(0)])])]);
    let sub = declared(sub, &[(Section::Input, "text", "STRING")]);
    let call = |argument: Operand| {
        let statements: &[(Insn, &[Operand])] = &[(Insn::Load, &[i00()]), (Insn::Call, &[name("Show"), argument])];
        let program = good(vec![main(vec![network(statements)]), sub.clone()]);
        operands(&program, 1)[0].clone()
    };
    assert_eq!(call(vb(100)), BoundOperand::Const(u32::from(pointer::V) << 24 | 100));
    assert_eq!(call(address_of(vb(7))), BoundOperand::Const(u32::from(pointer::V) << 24 | 7));
    assert_eq!(call(star(vd(8))), BoundOperand::Memory { area: Bound::V, byte: 8, bit: 0, width: Width::Dword });
    assert_eq!(call(constant(Constant::Text(b"12 kg".to_vec()))), BoundOperand::Text(b"12 kg".to_vec()));
    // In the subroutine, the string is the data that the pointer points at.
    let program = good(vec![main(Vec::new()), sub.clone()]);
    let BoundStatement::Instruction { operands, .. } = &body(&program, Kind::Sbr, 0).statements[0].kind else {
        panic!()
    };
    let pointer = BoundOperand::Memory { area: Bound::L, byte: 0, bit: 0, width: Width::Dword };
    assert_eq!(operands[0], BoundOperand::Indirect { pointer: Box::new(pointer), width: Width::Byte });
}

#[test]
fn numbers_of_blocks() {
    let blocks = vec![
        main(Vec::new()),
        block(BlockKind::Subroutine, "A", None, Vec::new()),
        block(BlockKind::Subroutine, "B", Some(0), Vec::new()),
        block(BlockKind::Interrupt, "C", None, Vec::new()),
        block(BlockKind::Subroutine, "D", None, Vec::new()),
    ];
    let program = good(blocks.clone());
    let numbers: Vec<_> = program.blocks.iter().map(|block| (block.key(), block.name.as_str())).collect();
    assert_eq!(
        numbers,
        [
            (key(Kind::Ob, 1), "MAIN"),
            (key(Kind::Sbr, 0), "B"),
            (key(Kind::Sbr, 1), "A"),
            (key(Kind::Sbr, 2), "D"),
            (key(Kind::Int, 0), "C"),
        ]
    );
    let mut twice = blocks;
    twice.push(block(BlockKind::Subroutine, "E", Some(0), Vec::new()));
    assert_eq!(codes_on(twice, "226"), ["P0304"]);
    assert_eq!(codes_on(vec![block(BlockKind::Subroutine, "A", Some(64), Vec::new())], "224"), ["P0814", "P0314"]);
}

fn bare(networks: Vec<Network>) -> Source {
    let mut main = block(BlockKind::Main, "", None, networks);
    main.is_bare = true;
    Source { blocks: vec![main], data: Vec::new() }
}

fn keys(files: Vec<(&str, Source)>) -> Vec<(BlockKey, String)> {
    let (program, diagnostics) = bind_files(files, "226");
    let diagnostics = without_review(diagnostics);
    assert!(diagnostics.is_empty(), "{diagnostics:#?}");
    program.blocks.iter().map(|block| (block.key(), block.name.clone())).collect()
}

#[test]
fn files_without_headers_are_named_after_their_blocks() {
    let call = || vec![network(&[(Insn::Load, &[i00()]), (Insn::Call, &[name("mixer")])])];
    let sub = || bare(vec![network(&[(Insn::Load, &[i00()])])]);
    assert_eq!(keys(vec![("anything.awl", sub())]), [(key(Kind::Ob, 1), String::new())]);
    for main in ["MAIN.awl", "plant/OB1.awl", "主程序.awl", "cell.awl"] {
        let found = keys(vec![(main, bare(call())), ("plant/Mixer.awl", sub())]);
        assert_eq!(found, [(key(Kind::Ob, 1), String::new()), (key(Kind::Sbr, 0), "Mixer".to_string())], "{main}");
    }
    // An interrupt routine is identified by the ATCH that names it, or by its default name.
    let attach = vec![network(&[(Insn::Load, &[i00()]), (Insn::Atch, &[name("Tick"), int(10)])])];
    let found = keys(vec![("main.awl", bare(attach)), ("Tick.awl", sub()), ("INT_4.awl", sub()), ("SBR_2.awl", sub())]);
    let expected = [(Kind::Ob, 1, ""), (Kind::Sbr, 2, "SBR_2"), (Kind::Int, 0, "Tick"), (Kind::Int, 4, "INT_4")];
    assert_eq!(found, expected.map(|(kind, number, name)| (key(kind, number), name.to_string())));
    // It is unknown which of them is the main program.
    let (_, diagnostics) = bind_files(vec![("a.awl", sub()), ("b.awl", sub())], "226");
    let codes: Vec<&str> = without_review(diagnostics).iter().map(|diagnostic| diagnostic.code.name()).collect();
    assert_eq!(codes, ["P0314"]);
}

#[test]
fn calls_by_number() {
    let routine = block(BlockKind::Interrupt, "Tick", Some(3), Vec::new());
    let sub = block(BlockKind::Subroutine, "Sub", Some(2), Vec::new());
    let block_2 = operand(OperandKind::Block { kind: BlockKind::Subroutine, number: 2 });
    let statements: &[(Insn, &[Operand])] =
        &[(Insn::Load, &[i00()]), (Insn::Call, &[int(2)]), (Insn::Call, &[block_2]), (Insn::Atch, &[int(3), int(10)])];
    let program = good(vec![main(vec![network(statements)]), sub.clone(), routine]);
    let statements = &body(&program, Kind::Ob, 1).statements;
    assert!(matches!(statements[1].kind, BoundStatement::Call { number: 2, .. }));
    assert!(matches!(statements[2].kind, BoundStatement::Call { number: 2, .. }));
    assert_eq!(operands(&program, 3), [BoundOperand::Const(3), BoundOperand::Const(10)]);
    let wrong: &[(Insn, &[Operand])] = &[(Insn::Load, &[i00()]), (Insn::Atch, &[name("Sub"), int(10)])];
    assert_eq!(codes_on(vec![main(vec![network(wrong)]), sub], "226"), ["P0203"]);
}

#[test]
fn depth_of_calls() {
    let calls = |callee: &str| vec![network(&[(Insn::Load, &[i00()]), (Insn::Call, &[name(callee)])])];
    let sub = |own: &str, callee: &str| block(BlockKind::Subroutine, own, None, calls(callee));
    let recursive = vec![main(calls("A")), sub("A", "B"), sub("B", "A")];
    assert_eq!(codes_on(recursive, "226"), ["P0815"]);
    let chain = |levels: usize| {
        let mut blocks = vec![main(calls("S1"))];
        blocks.extend((1..levels).map(|level| sub(&format!("S{level}"), &format!("S{}", level + 1))));
        blocks.push(block(BlockKind::Subroutine, &format!("S{levels}"), None, Vec::new()));
        codes_on(blocks, "226")
    };
    assert_eq!(chain(8), [""; 0]);
    assert_eq!(chain(9), ["P0815"]);
    let interrupt = block(BlockKind::Interrupt, "I", None, calls("A"));
    let leaf = block(BlockKind::Subroutine, "B", None, Vec::new());
    assert_eq!(codes_on(vec![main(Vec::new()), interrupt, sub("A", "B"), leaf], "226"), ["P0815"]);
}

fn line(address: Option<Operand>, values: Vec<Operand>) -> DataLine {
    DataLine { address, values, span: operand(OperandKind::Error).span }
}

fn data(lines: Vec<DataLine>) -> (Vec<u8>, Vec<&'static str>) {
    let source = Source { blocks: vec![main(Vec::new())], data: lines };
    let (program, diagnostics) = bind_files(vec![("data.awl", source)], "226");
    let codes = diagnostics.iter().map(|diagnostic| diagnostic.code.name()).collect();
    assert_eq!((program.dbs.len(), program.dbs[0].number), (1, 1));
    (program.dbs[0].data.clone(), codes)
}

#[test]
fn data_blocks() {
    let (bytes, codes) = data(vec![
        line(Some(vb(0)), vec![int(10), constant(Constant::Characters(b"AB".to_vec()))]),
        line(Some(vw(10)), vec![int(-5), int(300)]),
        line(Some(vd(20)), vec![constant(Constant::Real(1.5)), int(70000)]),
        line(Some(direct(Area::V, None, 40, 0)), vec![int(200), int(300), constant(Constant::Real(1.0))]),
        line(None, vec![int(7)]),
        line(Some(vb(80)), vec![constant(Constant::Text(b"hi".to_vec()))]),
    ]);
    assert_eq!(codes, [""; 0]);
    assert_eq!(bytes.len(), 10240);
    assert_eq!(bytes[0..3], [10, b'A', b'B']);
    assert_eq!(bytes[10..14], [0xFF, 0xFB, 0x01, 0x2C]);
    assert_eq!(bytes[20..28], [0x3F, 0xC0, 0, 0, 0x00, 0x01, 0x11, 0x70]);
    assert_eq!(bytes[40..48], [200, 0x01, 0x2C, 0x3F, 0x80, 0, 0, 7]);
    assert_eq!(bytes[80..83], [2, b'h', b'i']);
}

#[test]
fn wrong_data() {
    assert_eq!(data(vec![line(None, vec![int(7)])]).1, ["P0204"]);
    assert_eq!(data(vec![line(Some(vb(0)), vec![int(256)])]).1, ["P0104"]);
    assert_eq!(data(vec![line(Some(vw(10238)), vec![int(1), int(2)])]).1, ["P0405"]);
    let (bytes, codes) = data(vec![line(Some(vw(0)), vec![int(1)]), line(Some(vb(1)), vec![int(9)])]);
    assert_eq!((codes, &bytes[0..2]), (vec!["P0816"], [0, 9].as_slice()));
    assert_eq!(data(vec![line(Some(direct(Area::M, Some(Width::Byte), 0, 0)), vec![int(1)])]).1, ["P0203"]);
}
