//! The shape of networks, steps, loops and jumps; where instructions are allowed.

use plcc_syntax::s7200::Insn;
use plcc_syntax::s7200::ast::{Area, BlockKind, Operand as Written};

use super::build::*;

const LD: fn() -> Vec<Written> = || vec![i00()];

fn s(number: u8) -> Written {
    bit(Area::S, 0, number)
}

#[test]
fn networks_push_what_they_need() {
    let (i, q) = (LD(), vec![q00()]);
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::And, &i), (Insn::Assign, &q)]), [""; 0]);
    assert_eq!(codes(&[(Insn::And, &i), (Insn::Assign, &q)]), ["P0801"]);
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::AndLoad, &[]), (Insn::Assign, &q)]), ["P0801"]);
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::Read, &[])]), ["P0801"]);
    let counter = [c(1), int(10)];
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::Load, &i), (Insn::Ctu, &counter)]), [""; 0]);
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::Ctu, &counter)]), ["P0801"]);
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::Load, &i), (Insn::Ctud, &counter)]), ["P0801"]);
    // LPS, LRD and LPP, each with a coil.
    let branch: &[(Insn, &[Written])] = &[
        (Insn::Load, &i),
        (Insn::Push, &[]),
        (Insn::And, &i),
        (Insn::Assign, &q),
        (Insn::Read, &[]),
        (Insn::Assign, &q),
        (Insn::Pop, &[]),
        (Insn::Assign, &q),
    ];
    assert_eq!(codes(branch), [""; 0]);
}

#[test]
fn many_rungs_of_a_network_are_no_deep_stack() {
    let (i, q) = (LD(), vec![q00()]);
    let rungs: Vec<(Insn, &[Written])> =
        (0..20).flat_map(|_| [(Insn::Load, i.as_slice()), (Insn::Assign, q.as_slice())]).collect();
    assert_eq!(codes(&rungs), [""; 0]);
    // Ten levels that are all joined: the first of them is lost.
    let mut deep: Vec<(Insn, &[Written])> = vec![(Insn::Load, i.as_slice()); 10];
    deep.extend(vec![(Insn::AndLoad, [].as_slice()); 9]);
    deep.push((Insn::Assign, &q));
    assert_eq!(codes(&deep), ["P0802"]);
    let mut nine: Vec<(Insn, &[Written])> = vec![(Insn::Load, i.as_slice()); 9];
    nine.extend(vec![(Insn::AndLoad, [].as_slice()); 8]);
    nine.push((Insn::Assign, &q));
    assert_eq!(codes(&nine), [""; 0]);
}

#[test]
fn a_coil_without_a_contact() {
    let (i, q) = (LD(), vec![q00()]);
    assert_eq!(codes(&[(Insn::Assign, &q), (Insn::Assign, &q)]), ["P0803"]);
    // A subroutine begins with a 1 on top, until it pushes something.
    let routine = |networks| block(BlockKind::Subroutine, "Sub", Some(0), networks);
    let call: &[Written] = &[name("sub")];
    let main_network = network(&[(Insn::Load, &i), (Insn::Call, call)]);
    let first = routine(vec![network(&[(Insn::Assign, &q)])]);
    assert_eq!(codes_on(vec![main(vec![main_network.clone()]), first], "226"), [""; 0]);
    let second = routine(vec![network(&[(Insn::Load, &i)]), network(&[(Insn::Assign, &q)])]);
    assert_eq!(codes_on(vec![main(vec![main_network]), second], "226"), ["P0803"]);
}

#[test]
fn loops() {
    let i = LD();
    let range = [vw(0), int(1), int(10)];
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::For, &range), (Insn::Next, &[])]), [""; 0]);
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::For, &range)]), ["P0804"]);
    assert_eq!(codes(&[(Insn::Next, &[])]), ["P0804"]);
    let nested = |depth: usize| {
        let mut statements: Vec<(Insn, &[Written])> = vec![(Insn::Load, &i)];
        statements.extend(vec![(Insn::For, range.as_slice()); depth]);
        statements.extend(vec![(Insn::Next, [].as_slice()); depth]);
        codes(&statements)
    };
    assert_eq!(nested(8), [""; 0]);
    assert_eq!(nested(9), ["P0805"]);
}

#[test]
fn steps() {
    let i = LD();
    let (s1, s2) = (vec![s(1)], vec![s(2)]);
    assert_eq!(codes(&[(Insn::Lscr, &s1), (Insn::Load, &i), (Insn::Scrt, &s2), (Insn::Scre, &[])]), [""; 0]);
    assert_eq!(codes(&[(Insn::Lscr, &s1), (Insn::Load, &i)]), ["P0806"]);
    assert_eq!(codes(&[(Insn::Scre, &[])]), ["P0806"]);
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::Scrt, &s1)]), ["P0806"]);
    assert_eq!(codes(&[(Insn::Lscr, &s1), (Insn::Lscr, &s2), (Insn::Scre, &[])]), ["P0806"]);
    assert_eq!(codes(&[(Insn::Lscr, &s1), (Insn::Scre, &[]), (Insn::Lscr, &s1), (Insn::Scre, &[])]), ["P0807"]);
    let range = [vw(0), int(1), int(10)];
    let across: &[(Insn, &[Written])] =
        &[(Insn::Load, &i), (Insn::For, &range), (Insn::Lscr, &s1), (Insn::Next, &[]), (Insn::Scre, &[])];
    assert_eq!(codes(across), ["P0804"]);
    let out: &[(Insn, &[Written])] = &[(Insn::Lscr, &s1), (Insn::Load, &i), (Insn::For, &range), (Insn::Scre, &[])];
    assert_eq!(codes(out), ["P0804"]);
    assert_eq!(codes(&[(Insn::Lscr, &s1), (Insn::Load, &i), (Insn::End, &[]), (Insn::Scre, &[])]), ["P0809"]);
}

#[test]
fn jumps() {
    let i = LD();
    let label = [int(5)];
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::Jmp, &label), (Insn::Lbl, &label)]), [""; 0]);
    assert_eq!(codes(&[(Insn::Lbl, &label), (Insn::Load, &i), (Insn::Jmp, &label)]), [""; 0]);
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::Jmp, &label)]), ["P0308"]);
    assert_eq!(codes(&[(Insn::Lbl, &label), (Insn::Lbl, &label)]), ["P0309"]);
    assert_eq!(codes(&[(Insn::Lbl, &[int(256)])]), ["P0814"]);
    let s1 = [s(1)];
    let across: &[(Insn, &[Written])] =
        &[(Insn::Load, &i), (Insn::Jmp, &label), (Insn::Lscr, &s1), (Insn::Lbl, &label), (Insn::Scre, &[])];
    assert_eq!(codes(across), ["P0808"]);
}

#[test]
fn places_of_instructions() {
    let i = LD();
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::Cret, &[])]), ["P0809"]);
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::End, &[]), (Insn::Mend, &[])]), [""; 0]);
    let sub = |insn| {
        let network = network(&[(Insn::Load, &i), (insn, &[])]);
        codes_on(vec![main(Vec::new()), block(BlockKind::Subroutine, "A", Some(0), vec![network])], "226")
    };
    assert_eq!(sub(Insn::Cret), [""; 0]);
    assert_eq!(sub(Insn::Ret), [""; 0]);
    assert_eq!(sub(Insn::Eni), [""; 0]);
    assert_eq!(sub(Insn::End), ["P0809"]);
    assert_eq!(sub(Insn::Creti), ["P0809"]);
    let interrupt = |insn, cpu| {
        let network = network(&[(Insn::Load, &i), (insn, &[])]);
        codes_on(vec![main(Vec::new()), block(BlockKind::Interrupt, "A", Some(0), vec![network])], cpu)
    };
    assert_eq!(interrupt(Insn::Creti, "226"), [""; 0]);
    assert_eq!(interrupt(Insn::Stop, "226"), [""; 0]);
    for wrong in [Insn::Eni, Insn::Disi, Insn::End, Insn::Cret] {
        assert_eq!(interrupt(wrong, "226"), ["P0809"], "{wrong:?}");
    }
}

#[test]
fn timers_and_counters() {
    let i = LD();
    let ton = [t(37), int(10)];
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::Ton, &ton)]), [""; 0]);
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::Tonr, &ton)]), ["P0810"]);
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::Tof, &[t(5), int(10)])]), ["P0810"]);
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::Tonr, &[t(95), int(10)])]), [""; 0]);
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::Ton, &[t(96), int(10)])]), [""; 0]);
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::Ton, &ton), (Insn::Tof, &ton)]), ["P0811"]);
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::Ton, &ton), (Insn::Ton, &ton)]), ["P0812"]);
    let c1 = [c(1), int(3)];
    assert_eq!(codes(&[(Insn::Load, &i), (Insn::Load, &i), (Insn::Ctu, &c1), (Insn::Ctd, &c1)]), ["P0811"]);
    let tof = network(&[(Insn::Load, &i), (Insn::Tof, &ton)]);
    assert_eq!(codes_on(vec![main(vec![tof])], "214"), ["P0505"]);
}
