//! The bound form of operands.

use plcc_abi::s7200::pointer;
use plcc_syntax::ast::Width;
use plcc_syntax::s7200::Insn;
use plcc_syntax::s7200::ast::{Area, Constant, Operand as Written};

use super::build::*;
use plcc_model::s7200::{Area as Bound, Operand};

fn sm00() -> (Insn, Vec<Written>) {
    (Insn::Load, vec![bit(Area::Sm, 0, 0)])
}

fn second(insn: Insn, operands_written: &[Written]) -> Vec<Operand> {
    let (load, bit) = sm00();
    let program = good(vec![main(vec![network(&[(load, &bit), (insn, operands_written)])])]);
    operands(&program, 1).to_vec()
}

fn messages(insn: Insn, operands_written: &[Written], cpu: &str) -> Vec<&'static str> {
    let (load, bit) = sm00();
    codes_on(vec![main(vec![network(&[(load, &bit), (insn, operands_written)])])], cpu)
}

#[test]
fn the_instruction_decides_the_width() {
    assert_eq!(
        second(Insn::MovW, &[t(37), ac(1)]),
        [Operand::Timer { number: 37, width: Width::Word }, Operand::Accumulator { number: 1, width: Width::Word }]
    );
    assert_eq!(second(Insn::And, &[t(37)]), [Operand::Timer { number: 37, width: Width::Bit }]);
    assert_eq!(
        second(Insn::MovB, &[int(255), ac(0)]),
        [Operand::Const(255), Operand::Accumulator { number: 0, width: Width::Byte }]
    );
    assert_eq!(
        second(Insn::MovD, &[direct(Area::Hc, None, 0, 0), vd(4)]),
        [Operand::HighSpeedCounter(0), Operand::Memory { area: Bound::V, byte: 4, bit: 0, width: Width::Dword }]
    );
    assert_eq!(
        second(Insn::MovW, &[direct(Area::Ai, Some(Width::Word), 4, 0), direct(Area::Aq, None, 2, 0)]),
        [Operand::AnalogInput { byte: 4 }, Operand::AnalogOutput { byte: 2 }]
    );
}

#[test]
fn constants_have_the_bits_of_their_width() {
    assert_eq!(second(Insn::MovW, &[int(-5), vw(0)])[0], Operand::Const(0xFFFB));
    assert_eq!(second(Insn::MovW, &[int(65535), vw(0)])[0], Operand::Const(0xFFFF));
    assert_eq!(second(Insn::MovD, &[int(-1), vd(0)])[0], Operand::Const(0xFFFF_FFFF));
    assert_eq!(second(Insn::MovR, &[constant(Constant::Real(1.5)), vd(0)])[0], Operand::Const(0x3FC0_0000));
    let text = constant(Constant::Characters(b"ABCD".to_vec()));
    assert_eq!(second(Insn::MovD, &[text, vd(0)])[0], Operand::Const(0x4142_4344));
    // 10 as a REAL, with a warning.
    assert_eq!(messages(Insn::MulR, &[int(10), vd(0)], "226"), ["P0211"]);
    assert_eq!(messages(Insn::MovB, &[int(-1), vb(0)], "226"), ["P0211"]);
    assert_eq!(messages(Insn::MovB, &[int(256), vb(0)], "226"), ["P0104"]);
    assert_eq!(messages(Insn::MovW, &[int(-32769), vw(0)], "226"), ["P0104"]);
    assert_eq!(messages(Insn::MovW, &[constant(Constant::Real(1.0)), vw(0)], "226"), ["P0203"]);
}

#[test]
fn pointers() {
    let v = |tag: u8, offset: u32| Operand::Const(u32::from(tag) << 24 | offset);
    assert_eq!(second(Insn::MovD, &[address_of(vb(100)), ac(1)])[0], v(pointer::V, 100));
    // Words of timers are two bytes apart.
    assert_eq!(second(Insn::MovD, &[address_of(t(5)), ac(1)])[0], v(pointer::T, 10));
    assert_eq!(second(Insn::MovD, &[address_of(c(8)), ac(1)])[0], v(pointer::C, 16));
    let place = Operand::Memory { area: Bound::V, byte: 200, bit: 0, width: Width::Dword };
    assert_eq!(
        second(Insn::MovW, &[star(vd(200)), vw(0)])[0],
        Operand::Indirect { pointer: Box::new(place), width: Width::Word }
    );
    for wrong in [star(ac(0)), star(vw(0)), star(direct(Area::M, Some(Width::Dword), 0, 0))] {
        assert_eq!(messages(Insn::MovW, &[wrong, vw(0)], "226"), ["P0203"]);
    }
    for wrong in [bit(Area::V, 0, 0), direct(Area::L, Some(Width::Byte), 0, 0), ac(1)] {
        assert_eq!(messages(Insn::MovD, &[address_of(wrong), vd(0)], "226"), ["P0203"]);
    }
    assert_eq!(messages(Insn::MovW, &[address_of(vb(0)), vw(0)], "226"), ["P0203"]);
}

#[test]
fn ranges_of_the_cpu() {
    assert_eq!(messages(Insn::MovB, &[int(1), vb(8191)], "224"), [""; 0]);
    assert_eq!(messages(Insn::MovB, &[int(1), vb(8192)], "224"), ["P0405"]);
    assert_eq!(messages(Insn::MovW, &[int(1), vw(8191)], "224"), ["P0405"]);
    assert_eq!(messages(Insn::And, &[t(128)], "214"), ["P0405"]);
    assert_eq!(messages(Insn::And, &[bit(Area::V, 0, 8)], "226"), ["P0405"]);
    assert_eq!(messages(Insn::MovW, &[direct(Area::Ai, None, 1, 0), vw(0)], "226"), ["P0405"]);
    assert_eq!(messages(Insn::MovD, &[direct(Area::Hc, None, 1, 0), vd(0)], "222"), ["P0405"]);
    assert_eq!(messages(Insn::And, &[bit(Area::L, 0, 0)], "214"), ["P0405"]);
    assert_eq!(messages(Insn::Assign, &[bit(Area::L, 63, 7)], "226"), [""; 0]);
    let (_, diagnostics) = bind(vec![main(vec![network(&[(Insn::Load, &[bit(Area::V, 9000, 0)])])])], "224");
    assert_eq!(diagnostics[0].help.as_deref(), Some("CPUs that have it: 224XP, 226"));
}

#[test]
fn what_cannot_be_written() {
    assert_eq!(messages(Insn::MovW, &[int(1), int(2)], "226"), ["P0411"]);
    assert_eq!(messages(Insn::MovW, &[int(1), direct(Area::Ai, None, 0, 0)], "226"), ["P0411"]);
    assert_eq!(messages(Insn::MovD, &[int(1), direct(Area::Hc, None, 0, 0)], "226"), ["P0411"]);
    assert_eq!(messages(Insn::Assign, &[bit(Area::Sm, 29, 7)], "226"), ["P0411"]);
    assert_eq!(messages(Insn::Assign, &[bit(Area::Sm, 30, 0)], "226"), [""; 0]);
    assert_eq!(messages(Insn::Assign, &[i00()], "226"), [""; 0]);
    // Analog outputs cannot be read, and only moves write them.
    assert_eq!(messages(Insn::MovW, &[direct(Area::Aq, None, 0, 0), vw(0)], "226"), ["P0203"]);
    assert_eq!(messages(Insn::AddI, &[int(1), direct(Area::Aq, None, 0, 0)], "226"), ["P0203"]);
}

#[test]
fn counts_and_numbers() {
    assert_eq!(messages(Insn::Set, &[bit(Area::Q, 15, 0), int(8)], "226"), [""; 0]);
    assert_eq!(messages(Insn::Set, &[bit(Area::Q, 15, 0), int(9)], "226"), ["P0405"]);
    assert_eq!(messages(Insn::Reset, &[t(255), int(1)], "226"), [""; 0]);
    assert_eq!(messages(Insn::Reset, &[t(255), int(2)], "226"), ["P0405"]);
    assert_eq!(messages(Insn::Reset, &[q00(), int(0)], "226"), ["P0813"]);
    assert_eq!(messages(Insn::SetNow, &[q00(), int(129)], "226"), ["P0813"]);
    assert_eq!(messages(Insn::Bmb, &[vb(0), vb(10230), int(10)], "226"), [""; 0]);
    assert_eq!(messages(Insn::Bmb, &[vb(0), vb(10230), int(11)], "226"), ["P0405"]);
    assert_eq!(messages(Insn::ShiftRegister, &[i00(), bit(Area::V, 0, 0), int(-64)], "226"), [""; 0]);
    assert_eq!(messages(Insn::ShiftRegister, &[i00(), bit(Area::V, 0, 0), int(65)], "226"), ["P0813"]);
    assert_eq!(messages(Insn::Hdef, &[int(1), int(11)], "226"), [""; 0]);
    assert_eq!(messages(Insn::Hdef, &[int(0), int(2)], "226"), ["P0814"]);
    assert_eq!(messages(Insn::Hdef, &[int(0), int(1)], "214"), ["P0814"]);
    assert_eq!(messages(Insn::Hsc, &[int(1)], "222"), ["P0814"]);
    assert_eq!(messages(Insn::Dtch, &[int(24)], "224"), ["P0814"]);
    assert_eq!(messages(Insn::Xmt, &[vb(0), int(1)], "224"), ["P0814"]);
    assert_eq!(messages(Insn::Todr, &[vb(10232)], "226"), [""; 0]);
    assert_eq!(messages(Insn::Todr, &[vb(10233)], "226"), ["P0405"]);
}

#[test]
fn counts_of_operands() {
    assert_eq!(messages(Insn::MovW, &[vw(0)], "226"), ["P0204"]);
    assert_eq!(messages(Insn::Not, &[vw(0)], "226"), ["P0205"]);
    assert_eq!(second(Insn::Nop, &[]), [Operand::Const(0)]);
}
