//! Whole programs through parser and binding: layouts, values and what calls pass.
//!
//! The files of `tests/check/` test the texts of messages.

mod declarations;
mod layers;
mod library;
mod partial;

use plcc_abi::image::{AssertKind, BlockKind};
use plcc_diag::{Code, Diagnostic, FileId, Severity, SourceFile, SourceMap};
use plcc_readers::ReadOptions;
use plcc_stdlib::BlockClass;

use crate::bind::bind;
use crate::bind::declarations::shipped::empty;
use plcc_binding::BindInput;
use plcc_model::types::{DataType, StructType};
use plcc_model::{Actual, BlockKey, Body, Call, Instance, Operand, Place, Program, StlStatementKind};
use plcc_readers::symbols;

fn bind_text(source: &str, table: &str, partial: bool) -> (Program, Vec<Diagnostic>) {
    let mut sources = SourceMap::default();
    let file = sources.add(SourceFile::new("test.stl", source));
    let options = ReadOptions { mnemonics: None, pragmas: true, ..ReadOptions::default() };
    let (unit, mut diagnostics) = plcc_readers::parse(file, source, &options);
    let mut tables = Vec::new();
    if !table.is_empty() {
        let table_file = sources.add(SourceFile::new("test.sdf", table));
        let (table, bad) = symbols::parse(table_file, sources.file(table_file));
        diagnostics.extend(bad);
        tables.push(table);
    }
    let (program, bound) = bind(&BindInput {
        name: "test".to_string(),
        units: &[(file, unit)],
        tables: &tables,
        partial,
        pragmas: true,
        ..empty(&sources)
    });
    diagnostics.extend(bound);
    (program, diagnostics)
}

fn good(source: &str) -> Program {
    good_with(source, "")
}

fn good_with(source: &str, table: &str) -> Program {
    let (program, diagnostics) = bind_text(source, table, false);
    assert!(diagnostics.is_empty(), "{diagnostics:#?}");
    program
}

fn codes(source: &str) -> Vec<&'static str> {
    bind_text(source, "", false).1.iter().map(|diagnostic| diagnostic.code.name()).collect()
}

fn statements(program: &Program, kind: BlockKind, number: u16) -> &[plcc_model::StlStatement] {
    match &program.block(BlockKey { kind, number }).expect("the test defines the block").body {
        Body::Stl(statements) => statements,
        Body::Scl(_) | Body::S7200(_) | Body::Runtime => panic!("the block has no statements"),
    }
}

/// Operands of OB 1.
fn operands(program: &Program) -> Vec<Operand> {
    statements(program, BlockKind::Ob, 1)
        .iter()
        .filter_map(|statement| match &statement.kind {
            StlStatementKind::Instruction { operand, .. } => Some(operand.clone()),
            _ => None,
        })
        .collect()
}

fn first_call(program: &Program) -> Call {
    statements(program, BlockKind::Ob, 1)
        .iter()
        .find_map(|statement| match &statement.kind {
            StlStatementKind::Call(call) => Some(call.clone()),
            _ => None,
        })
        .expect("OB 1 of the test calls something")
}

fn constant(value: u32, wide: bool) -> Operand {
    Operand::Const { value, wide }
}

#[test]
fn constants_and_addresses() {
    let program = good("L -1\nL L#-1\nL MW 10\n");
    let operands = operands(&program);
    assert_eq!(operands[0], constant(0xFFFF, false));
    assert_eq!(operands[1], constant(0xFFFF_FFFF, true));
    assert_eq!(operands[2], Operand::Memory { place: Place::M { byte: 10, bit: 0 }, width: plcc_model::Width::Word });
}

const TANK: &str = "DATA_BLOCK DB 5\nSTRUCT\n b : BOOL := TRUE;\n c : BOOL;\n d : BOOL := TRUE;\n ch : CHAR;\n i : INT := -2;\n r : REAL := 1.0;\n s : STRING[3] := 'ab';\n a : ARRAY[1..4] OF INT := 2(7), 5;\n w : DATE;\n dt : DATE_AND_TIME;\nEND_STRUCT;\nBEGIN\n i := 3;\n a[4] := 16#0102;\nEND_DATA_BLOCK\n";

#[test]
fn current_values() {
    let program = good(TANK);
    let data = &program.db(5).expect("defined").data;
    // b and d; ch starts with a blank; i := 3 after BEGIN.
    assert_eq!(data[..4], [0b101, b' ', 0, 3]);
    assert_eq!(data[4..8], [0x3F, 0x80, 0, 0]);
    // STRING[3]: header, two characters, one free, one to make it even.
    assert_eq!(data[8..14], [3, 2, b'a', b'b', 0, 0]);
    assert_eq!(data[14..22], [0, 7, 0, 7, 0, 5, 1, 2]);
    assert_eq!(data[22..24], [0, 0]);
    assert_eq!(data[24..32], [0x90, 1, 1, 0, 0, 0, 0, 2]);
    assert_eq!(data.len(), 32);
}

/// Source: published instance layout of FB 58.
#[test]
fn instance_of_fb_58() {
    let source = "FUNCTION_BLOCK FB 58\nVAR_INPUT\n PV_IN : REAL; PV_PER : INT; DISV : REAL; INT_HPOS : BOOL; INT_HNEG : BOOL; SELECT : INT;\nEND_VAR\nVAR_OUTPUT\n PV : REAL; LMN : REAL; LMN_PER : INT; QPULSE : BOOL; QLMN_HLM : BOOL; QLMN_LLM : BOOL; QC_ACT : BOOL := TRUE;\nEND_VAR\nVAR_IN_OUT\n CYCLE : REAL := 0.1; CYCLE_P : REAL; SP_INT : REAL; MAN : REAL; COM_RST : BOOL; MAN_ON : BOOL := TRUE;\nEND_VAR\nVAR\n DEADB_W, I_ITLVAL, LMN_HLM, LMN_LLM, PV_FAC, PV_OFFS, LMN_FAC, LMN_OFFS, PER_TM, P_B_TM, TUN_DLMN : REAL;\n PER_MODE : INT; PVPER_ON, I_ITL_ON, PULSE_ON, TUN_KEEP : BOOL; ER, LMN_P, LMN_I, LMN_D : REAL; PHASE, STATUS_H, STATUS_D : INT; QTUN_RUN : BOOL;\n PI_CON : STRUCT GAIN : REAL; TI : REAL; END_STRUCT;\n PID_CON : STRUCT GAIN : REAL; TI : REAL; TD : REAL; END_STRUCT;\n PAR_SAVE : STRUCT PFAC_SP : REAL; GAIN : REAL; TI : REAL; TD : REAL; D_F : REAL; CON_ZONE : REAL; CONZ_ON : BOOL; END_STRUCT;\n PFAC_SP : REAL; GAIN : REAL; TI : REAL; TD : REAL; D_F : REAL; CON_ZONE : REAL; CONZ_ON, TUN_ON, TUN_ST, UNDO_PAR, SAVE_PAR, LOAD_PID, PID_ON : BOOL;\n GAIN_P : REAL;\nEND_VAR\nBEGIN\n NOP 0;\nEND_FUNCTION_BLOCK\n";
    let program = good(source);
    let interface = &program.block(BlockKey { kind: BlockKind::Fb, number: 58 }).expect("defined").interface;
    let place = |name: &str| {
        let member = interface.instance.iter().find(|member| member.name == name).expect(name);
        (member.byte, member.bit)
    };
    for (name, byte, bit) in [
        ("PV_PER", 4, 0),
        ("DISV", 6, 0),
        ("INT_HNEG", 10, 1),
        ("SELECT", 12, 0),
        ("PV", 14, 0),
        ("QC_ACT", 24, 3),
        ("CYCLE", 26, 0),
        ("MAN_ON", 42, 1),
        ("DEADB_W", 44, 0),
        ("PER_MODE", 88, 0),
        ("TUN_KEEP", 90, 3),
        ("ER", 92, 0),
        ("QTUN_RUN", 114, 0),
        ("PI_CON", 116, 0),
        ("PID_CON", 124, 0),
        ("PAR_SAVE", 136, 0),
        ("PFAC_SP", 162, 0),
        ("PID_ON", 186, 6),
        ("GAIN_P", 188, 0),
    ] {
        assert_eq!(place(name), (byte, bit), "{name}");
    }
}

#[test]
fn function_parameters_and_constants() {
    let program = good(
        "FUNCTION FC 1 : INT\nVAR_INPUT\n a : INT; t : TIMER; p : ANY; s : BOOL;\nEND_VAR\nVAR_OUTPUT\n o : REAL;\nEND_VAR\nBEGIN\n L #a; T #RET_VAL;\n A #t; L P##p; LAR1;\nEND_FUNCTION\nORGANIZATION_BLOCK OB 1\nBEGIN\n CALL FC 1 ( s := TRUE, o := MD 20, a := -2, t := T 5, p := P#M 10.0 BYTE 4, RET_VAL := MW 2 );\nEND_ORGANIZATION_BLOCK\n",
    );
    let call = first_call(&program);
    let actuals: Vec<&Actual> = call.arguments.iter().map(|argument| &argument.actual).collect();
    assert_eq!(call.arguments.iter().map(|argument| argument.parameter).collect::<Vec<_>>(), [0, 1, 2, 3, 4, 5]);
    assert_eq!(*actuals[0], Actual::Const(vec![0xFF, 0xFE]));
    assert_eq!(*actuals[1], Actual::Number(plcc_model::Number::Known(5)));
    assert_eq!(*actuals[2], Actual::PointerBytes(vec![0x10, 2, 0, 4, 0, 0, 0x83, 0, 0, 0x50]));
    assert_eq!(*actuals[3], Actual::Const(vec![1]));
    assert_eq!(*actuals[4], Actual::Place(Place::M { byte: 20, bit: 0 }));
    assert_eq!(*actuals[5], Actual::Place(Place::M { byte: 2, bit: 0 }), "RET_VAL is the last output");
}

#[test]
fn result_of_system_functions_is_their_first_output() {
    let program =
        good("L 0\nCALL SFC 20 ( SRCBLK := P#M 0.0 BYTE 10, DSTBLK := P#M 20.0 BYTE 10, RET_VAL := MW 40 )\n");
    let block = program.block(BlockKey { kind: BlockKind::Sfc, number: 20 }).expect("used");
    let places: Vec<(&str, u32)> =
        block.interface.parameters.iter().map(|parameter| (parameter.name.as_str(), parameter.byte)).collect();
    assert_eq!(places, [("SRCBLK", 0), ("RET_VAL", 10), ("DSTBLK", 12)]);
    assert_eq!(block.interface.bytes, 22);
    assert!(matches!(block.body, Body::Runtime));
}

#[test]
fn every_system_block_binds() {
    for block in plcc_stdlib::blocks() {
        let options = plcc_syntax::ParseOptions::default();
        let (unit, diagnostics) = match block.language {
            plcc_stdlib::Language::Stl => plcc_syntax::stl::parse(FileId(0), block.source, &options),
            plcc_stdlib::Language::Scl => plcc_syntax::scl::parse(FileId(0), block.source, &options),
        };
        assert!(diagnostics.is_empty(), "{}: {diagnostics:#?}", block.name);
        assert_eq!(unit.blocks.len(), 1, "{}", block.name);
        // Instructions of the TIA Portal have no number for STL to call them.
        if block.form == plcc_stdlib::Form::NotShipped || block.is_tia() {
            continue;
        }
        let (kind, instance) = match block.class {
            BlockClass::Fc => ("FC", ""),
            BlockClass::Fb => ("FB", ", DB 1"),
            BlockClass::Sfc => ("SFC", ""),
            BlockClass::Sfb => ("SFB", ", DB 1"),
        };
        let target = match block.is_tia() {
            // Instructions of the TIA Portal have a name only; one that is also a block of the CPU means that in STL.
            true if plcc_stdlib::find_name(block.name).is_some() => continue,
            true => format!("\"{}\"", block.name),
            false => format!("{kind} {}", block.number),
        };
        let (_, diagnostics) = bind_text(&format!("CALL {target} {instance}\n"), "", false);
        // A call that omits the parameters of a function, or a pointer of a block, is the only error.
        let is_missing = |code| matches!(code, Code::MissingParameter | Code::MissingPointer);
        assert!(diagnostics.iter().all(|diagnostic| is_missing(diagnostic.code)), "{}: {diagnostics:#?}", block.name);
    }
}

/// Source: system functions reference, instance layouts of SFB 0 to 5.
#[test]
fn instances_of_system_function_blocks() {
    for (number, bytes, places) in [
        (0, 10, &[("CU", 0, 0), ("R", 0, 1), ("PV", 2, 0), ("Q", 4, 0), ("CV", 6, 0), ("CUO", 8, 0)][..]),
        (2, 10, &[("LOAD", 0, 3), ("QU", 4, 0), ("QD", 4, 1), ("CV", 6, 0), ("CUO", 8, 0), ("CDO", 8, 1)][..]),
        (
            4,
            22,
            &[
                ("IN", 0, 0),
                ("PT", 2, 0),
                ("Q", 6, 0),
                ("ET", 8, 0),
                ("STATE", 12, 0),
                ("STIME", 14, 0),
                ("ATIME", 18, 0),
            ][..],
        ),
    ] {
        let program = good(&format!("CALL SFB {number} , DB 40\n"));
        let db = program.db(40).expect("made for the call");
        assert_eq!(db.data.len(), bytes);
        assert_eq!(db.instance_of, Some(BlockKey { kind: BlockKind::Sfb, number }));
        for (name, byte, bit) in places {
            let member = db.members.iter().find(|member| member.name == *name).expect(name);
            assert_eq!((member.byte, member.bit), (*byte, *bit), "{name}");
        }
    }
}

#[test]
fn used_system_blocks_join_with_what_they_use() {
    let program = good("CALL \"TON\" , DB 1\n");
    let keys: Vec<String> = program.blocks.iter().map(|block| block.key().to_string()).collect();
    assert_eq!(keys, ["OB 1", "SFC 64", "SFB 4"]);
}

const NESTED: &str = "FUNCTION_BLOCK FB 2\nVAR_INPUT x : INT; END_VAR\nVAR_IN_OUT st : STRUCT a : INT; b : INT; END_STRUCT; END_VAR\nBEGIN\n L #st.b; T #x; L P##st; L P##x;\nEND_FUNCTION_BLOCK\nFUNCTION_BLOCK FB 1\nVAR\n n : INT; mi : FB 2; t : TON; s : STRUCT a : INT; b : INT; END_STRUCT;\nEND_VAR\nVAR_TEMP tmp : ANY; q : INT; END_VAR\nBEGIN\n CALL #mi ( x := 5, st := #s );\n CALL #t ( IN := TRUE, PT := T#5S );\n L P##tmp;\n L P##n;\nEND_FUNCTION_BLOCK\nORGANIZATION_BLOCK OB 1\nBEGIN\n CALL FB 1 , DB 1;\nEND_ORGANIZATION_BLOCK\n";

#[test]
fn instances_inside_instances() {
    let program = good(NESTED);
    let body = statements(&program, BlockKind::Fb, 1);
    let StlStatementKind::Call(call) = &body[0].kind else { panic!("a call is first") };
    assert_eq!(call.instance, Some(Instance::Multi { byte: 2 }));
    // x at 0, the POINTER of st at 2: 8 bytes of instance.
    let StlStatementKind::Call(timer) = &body[1].kind else { panic!("a call is second") };
    assert_eq!(timer.instance, Some(Instance::Multi { byte: 10 }));
    assert_eq!(call.arguments[1].actual, Actual::Place(Place::Instance { byte: 32, bit: 0 }));
    let inner = statements(&program, BlockKind::Fb, 2);
    let operand = |at: usize| match &inner[at].kind {
        StlStatementKind::Instruction { operand, .. } => operand.clone(),
        other => panic!("{other:?}"),
    };
    assert_eq!(
        operand(0),
        Operand::Memory {
            place: Place::ThroughPointer { pointer: 2, byte: 2, bit: 0 },
            width: plcc_model::Width::Word
        }
    );
    assert_eq!(operand(2), constant(0x8500_0010, true));
    assert_eq!(operand(3), constant(0x8500_0000, true));
}

#[test]
fn symbols_of_tables() {
    let table = "\"Lamp\",\"Q 4.0\",\"BOOL\",\"\"\n\"Level\",\"MW 10\",\"INT\",\"\"\n\"Scaled\",\"FC 7\",\"FC 7\",\"\"\n\"Timer\",\"T 3\",\"TIMER\",\"\"\n";
    let program = good_with(
        "FUNCTION \"Scaled\" : VOID\nVAR_INPUT v : INT; END_VAR\nBEGIN\n L #v;\nEND_FUNCTION\nORGANIZATION_BLOCK OB 1\nBEGIN\n A \"Lamp\"; L \"Level\"; A \"Timer\"; CALL \"scaled\" ( v := \"LEVEL\" );\nEND_ORGANIZATION_BLOCK\n",
        table,
    );
    assert_eq!(first_call(&program).target, BlockKey { kind: BlockKind::Fc, number: 7 });
    assert_eq!(program.symbols.len(), 3);
}

#[test]
fn undefined_names_are_one_list() {
    let (_, diagnostics) = bind_text("A \"x\"\nA \"y\"\nA \"X\"\nCALL FC 200\n", "", false);
    let codes: Vec<&str> = diagnostics.iter().map(|diagnostic| diagnostic.code.name()).collect();
    assert_eq!(codes, ["P0301", "P0301", "P0302"]);
    let (_, diagnostics) = bind_text("A \"x\"\nCALL FC 200 ( a := 1 )\nCALL SFC 78\n", "", true);
    assert!(diagnostics.iter().all(|diagnostic| diagnostic.severity == Severity::Warning), "{diagnostics:#?}");
    assert_eq!(diagnostics.len(), 3);
}

#[test]
fn any_of_variables() {
    let program = good(
        "DATA_BLOCK DB 3\nSTRUCT\n n : INT; a : ARRAY[1..5] OF REAL; s : STRUCT x : INT; y : DINT; END_STRUCT; t : STRING[20];\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\nFUNCTION FC 1 : VOID\nVAR_INPUT p : ANY; q : ANY; r : ANY; z : POINTER; END_VAR\nBEGIN\nNOP 0;\nEND_FUNCTION\nORGANIZATION_BLOCK OB 1\nBEGIN\n CALL FC 1 ( p := DB3.a, q := DB3.s, r := DB3.t, z := DB3.n );\nEND_ORGANIZATION_BLOCK\n",
    );
    let bytes: Vec<Vec<u8>> = first_call(&program)
        .arguments
        .iter()
        .map(|argument| match &argument.actual {
            Actual::PointerBytes(bytes) => bytes.clone(),
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(bytes[0], [0x10, 8, 0, 5, 0, 3, 0x84, 0, 0, 0x10]);
    assert_eq!(bytes[1], [0x10, 2, 0, 6, 0, 3, 0x84, 0, 0, 0xB0]);
    assert_eq!(bytes[2], [0x10, 2, 0, 22, 0, 3, 0x84, 0, 0, 0xE0]);
    assert_eq!(bytes[3], [0, 3, 0x84, 0, 0, 0]);
}

#[test]
fn user_types_in_any_order() {
    let program = good(
        "DATA_BLOCK DB 1\nUDT 2\nBEGIN\n in.x := 5;\nEND_DATA_BLOCK\nTYPE UDT 2\nSTRUCT\n b : BOOL; in : UDT 1;\nEND_STRUCT;\nEND_TYPE\nTYPE UDT 1\nSTRUCT\n x : INT := 3; y : INT := 4;\nEND_STRUCT;\nEND_TYPE\n",
    );
    assert_eq!(program.db(1).expect("defined").data, [0, 0, 0, 5, 0, 4]);
    let DataType::Struct(inner) = &program.db(1).expect("defined").members[1].ty else { panic!("a structure") };
    assert_eq!(StructType { members: Vec::new(), ..(**inner).clone() }.name, "UDT 1");
}

#[test]
fn jump_lists_fold() {
    let program = good("L MB 0\nJL lst\nJU a\nJU b\nlst: NOP 0\na: NOP 0\nb: NOP 0\n");
    let lists: Vec<usize> = statements(&program, BlockKind::Ob, 1)
        .iter()
        .filter_map(|statement| match &statement.kind {
            StlStatementKind::JumpList { targets, .. } => Some(targets.len()),
            _ => None,
        })
        .collect();
    assert_eq!(lists, [2]);
}

#[test]
fn assertions() {
    let program =
        good("L 1.5\n//@ assert ACCU1 > 1.0\n//@ assert ACCU1 == 1.5\n//@ assert 0 == 1\n//@ sleep 100\nNOP 0\n");
    let kinds: Vec<(AssertKind, bool)> = statements(&program, BlockKind::Ob, 1)
        .iter()
        .filter_map(|statement| match &statement.kind {
            StlStatementKind::Assert(assert) => Some((assert.comparisons[0].kind, assert.trap)),
            _ => None,
        })
        .collect();
    assert_eq!(kinds, [(AssertKind::Float, false), (AssertKind::Float, false), (AssertKind::Bits, true)]);
}

/// Assertions that test nothing, or guess, are refused.
#[test]
fn assertions_that_cannot_be_meant() {
    let data = "DATA_BLOCK DB 1\nSTRUCT\n i : INT;\n d : DINT;\n r : REAL;\n s : STRING[5];\n a : ARRAY[1..9] OF INT;\n b : BOOL;\n\
                END_STRUCT\nBEGIN\nEND_DATA_BLOCK\n";
    let code = |assertion: &str| {
        let source =
            format!("{data}ORGANIZATION_BLOCK OB 1\nBEGIN\nNOP 0;\n//@ assert {assertion}\nEND_ORGANIZATION_BLOCK\n");
        codes(&source).join(" ")
    };
    for good in
        ["DB1.i == -5", "DB1.i < DB1.d", "DB1.i < 2.5", "DB1.r == 5", "MW 10 == 40000", "DB1.s == 'a'", "DB1.b == 1"]
    {
        assert_eq!(code(good), "", "{good}");
    }
    for bad in [
        // No value, or every value, satisfies them.
        "DB1.i == 70000",
        "DB1.i <> 40000",
        "DB1.b == 2",
        "MB 10 == 256",
        "M 0.0 == 5",
        // Without a type there is no sign.
        "MW 10 > -5",
        "ACCU1 < -1",
        "ACCU1 < DB1.i",
        // Other kinds of values.
        "DB1.s == 5",
        "DB1.r == 'x'",
        "DB1.d == DB1.s",
        "DB1.a == 5",
        "MW 10 == 1.5",
        "MW 10 as DINT == 5",
        "MW 10 as NUMBER == 5",
        "DB1.s as INT == 5",
        "MW 10 == 1 XOR MW 12 == 2",
        "MW 10",
        "(MW 10 == 1",
    ] {
        assert_eq!(code(bad), "P0701", "{bad}");
    }
}

#[test]
fn temporary_data_of_an_ob_holds_its_start_information() {
    let program = good("= L 30.1\n");
    assert_eq!(program.blocks[0].temp_bytes, 32);
    assert_eq!(good("NOP 0\n").blocks[0].temp_bytes, 20);
}

#[test]
fn blocks_without_number_take_the_lowest_free_one() {
    let program = good(
        "FUNCTION \"a\" : VOID\nBEGIN\nNOP 0;\nEND_FUNCTION\nFUNCTION FC 1 : VOID\nBEGIN\nNOP 0;\nEND_FUNCTION\nFUNCTION \"b\" : VOID\nBEGIN\nNOP 0;\nEND_FUNCTION\n",
    );
    let names: Vec<(u16, &str)> = program.blocks.iter().map(|block| (block.number, block.name.as_str())).collect();
    assert_eq!(names, [(1, ""), (2, "a"), (3, "b")]);
}

#[test]
fn library_blocks_are_known_by_name_only() {
    assert_eq!(codes("CALL \"FIFO\"\n"), ["P0303"]);
    assert_eq!(codes("CALL FC 85\n"), ["P0302"]);
}

#[test]
fn numbers_that_statements_name_stay_free() {
    let program = good(
        "DATA_BLOCK \"Shared\"\nSTRUCT x : INT; END_STRUCT;\nBEGIN\nEND_DATA_BLOCK\nFUNCTION_BLOCK FB 1\nVAR x : INT; END_VAR\nBEGIN\nNOP 0;\nEND_FUNCTION_BLOCK\nORGANIZATION_BLOCK OB 1\nBEGIN\nCALL FB 1 , DB 1;\nL \"Shared\".x;\nEND_ORGANIZATION_BLOCK\n",
    );
    let dbs: Vec<(u16, &str)> = program.dbs.iter().map(|db| (db.number, db.name.as_str())).collect();
    assert_eq!(dbs, [(1, ""), (2, "Shared")]);
}

#[test]
fn characters_of_a_string() {
    let program = good(&format!("{TANK}ORGANIZATION_BLOCK OB 1\nBEGIN\nL DB5.s[3];\nEND_ORGANIZATION_BLOCK\n"));
    let place = Place::Db { number: 5, byte: 12, bit: 0 };
    assert_eq!(operands(&program), [Operand::Memory { place, width: plcc_model::Width::Byte }]);
    assert_eq!(
        codes(&format!("{TANK}ORGANIZATION_BLOCK OB 1\nBEGIN\nL DB5.s[4];\nEND_ORGANIZATION_BLOCK\n")),
        ["P0403"]
    );
}

#[test]
fn a_name_that_is_defined_nowhere_is_told_of_once() {
    let source = "FUNCTION_BLOCK FB 1\nVAR x : \"Valve\"; END_VAR\nBEGIN\nCALL \"Valve\" , \"Db\" ( a := \"s\" );\nL \"Db\".y;\nL DB9.y; OPN DB 9;\nEND_FUNCTION_BLOCK\n";
    let (_, diagnostics) = bind_text(source, "", true);
    let codes: Vec<&str> = diagnostics.iter().map(|diagnostic| diagnostic.code.name()).collect();
    assert_eq!(codes, ["P0315", "P0301", "P0301", "P0302"]);
    assert!(diagnostics.iter().all(|diagnostic| diagnostic.severity == Severity::Warning));
}

#[test]
fn functions_of_libraries_join_where_the_program_has_none() {
    // By number the block may be the user's own, so the message shows where it comes from.
    let (_, diagnostics) = bind_text("CALL FC 21 ( x := 1 )\n", "", false);
    assert_eq!(diagnostics[0].title, "FC 21 is not defined");
    let (_, diagnostics) = bind_text("CALL FC 21 ( RET_VAL := MW 0, x := 1 )\n", "", false);
    assert!(diagnostics[0].help.iter().any(|help| help.contains("`LEN` of the standard library")), "{diagnostics:#?}");
    // A block of the program with that number has priority, and the name still means the library.
    let own = "FUNCTION FC 21 : VOID\nBEGIN\nEND_FUNCTION\nDATA_BLOCK DB 1 STRUCT s : STRING[5]; END_STRUCT; BEGIN END_DATA_BLOCK\nORGANIZATION_BLOCK OB 1\nBEGIN\n CALL FC 21;\n CALL \"LEN\" ( S := DB1.s, RET_VAL := MW 0 );\nEND_ORGANIZATION_BLOCK\n";
    let program = good(own);
    let functions: Vec<(u16, &str)> = program
        .blocks
        .iter()
        .filter(|block| block.kind == BlockKind::Fc)
        .map(|block| (block.number, block.name.as_str()))
        .collect();
    assert_eq!(functions, [(21, ""), (65_535, "LEN")]);
}
