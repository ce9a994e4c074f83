//! Random functions: what their blocks consist of.

use proptest::prelude::*;

use super::{BITS, FUNCTIONS, WORDS};

/// How an address is made.
#[derive(Clone, Debug)]
pub(super) enum Place {
    Direct(u8, u32),
    /// Base: the low three bits of a word.
    Indexed(u8, usize, u32),
    /// Base: the DB variable, as `anydb` or as `any`.
    Db(u32, bool),
    /// Base: the pointer variable.
    Pointer(u32),
}

#[derive(Clone, Debug)]
pub(super) enum Statement {
    Const(usize, u32),
    Binary(usize, usize, usize, usize),
    Compare(usize, usize, usize, usize),
    CompareFloat(usize, usize, usize, usize),
    CompareConst(usize, usize, usize, u32),
    Bool(usize, usize, usize, usize),
    Not(usize, usize),
    Select(usize, usize, usize, usize),
    /// The low word of the one into the other, which keeps its high word.
    LowWord(usize, usize),
    Sign(usize, usize),
    BitToWord(usize, usize),
    Load(usize, Place, usize),
    Store(Place, usize, usize),
    LoadBit(usize, Place, u8),
    StoreBit(Place, u8, usize),
    Clear(Place, u32),
    Copy(Place, Place, u32),
    /// Sets the DB variable to the base of DB 1 or 2, by a constant or by a bit.
    OpenDb(Option<usize>),
    DbLength(usize, u32),
    Point(u8, u32),
    Call(usize, usize, usize, usize),
    Timer(usize, usize),
    Peripheral(usize),
    Safepoint(usize),
    Sine(usize, usize),
}

#[derive(Clone, Debug)]
pub(super) enum End {
    Jump(usize),
    Branch(usize, usize, usize),
    Switch(usize, Vec<usize>, usize),
    Return,
}

#[derive(Clone, Debug)]
pub(super) struct RandomBlock {
    pub statements: Vec<Statement>,
    pub end: End,
    pub cold: bool,
}

fn place() -> impl Strategy<Value = Place> {
    prop_oneof![
        6 => (0..7u8, 0..8u32).prop_map(|(region, offset)| Place::Direct(region, offset)),
        1 => (0..7u8, 0..WORDS, 0..4u32).prop_map(|(region, word, offset)| Place::Indexed(region, word, offset)),
        3 => (0..8u32, any::<bool>()).prop_map(|(offset, any)| Place::Db(offset, any)),
        2 => (0..4u32).prop_map(Place::Pointer),
    ]
}

fn statement() -> impl Strategy<Value = Statement> {
    let (w, b) = (0..WORDS, 0..BITS);
    let constant = prop_oneof![0..3u32, any::<u32>(), Just(0xFFFF), Just(0xFFFF_0000), Just(0x8000_0000)];
    let values = prop_oneof![
        (w.clone(), constant.clone()).prop_map(|(to, value)| Statement::Const(to, value)),
        (0..10usize, w.clone(), w.clone(), w.clone()).prop_map(|(op, to, a, b)| Statement::Binary(op, to, a, b)),
        (0..10usize, b.clone(), w.clone(), w.clone()).prop_map(|(cc, to, a, b)| Statement::Compare(cc, to, a, b)),
        (0..7usize, b.clone(), w.clone(), w.clone()).prop_map(|(cc, to, a, b)| Statement::CompareFloat(cc, to, a, b)),
        (0..10usize, b.clone(), w.clone(), constant).prop_map(|(cc, to, a, c)| Statement::CompareConst(cc, to, a, c)),
        (0..3usize, b.clone(), b.clone(), b.clone()).prop_map(|(op, to, x, y)| Statement::Bool(op, to, x, y)),
        (b.clone(), b.clone()).prop_map(|(to, from)| Statement::Not(to, from)),
        (w.clone(), b.clone(), w.clone(), w.clone()).prop_map(|(to, cond, x, y)| Statement::Select(to, cond, x, y)),
        (w.clone(), w.clone()).prop_map(|(to, from)| Statement::LowWord(to, from)),
        (w.clone(), w.clone()).prop_map(|(to, from)| Statement::Sign(to, from)),
        (w.clone(), b.clone()).prop_map(|(to, from)| Statement::BitToWord(to, from)),
        (w.clone(), w.clone()).prop_map(|(to, from)| Statement::Sine(to, from)),
    ];
    let memory = prop_oneof![
        4 => (w.clone(), place(), 0..4usize).prop_map(|(to, place, ty)| Statement::Load(to, place, ty)),
        4 => (place(), w.clone(), 0..4usize).prop_map(|(place, from, ty)| Statement::Store(place, from, ty)),
        5 => (b.clone(), place(), 0..2u8).prop_map(|(to, place, bit)| Statement::LoadBit(to, place, bit)),
        5 => (place(), 0..2u8, b.clone()).prop_map(|(place, bit, from)| Statement::StoreBit(place, bit, from)),
        1 => (place(), 0..8u32).prop_map(|(place, len)| Statement::Clear(place, len)),
        1 => (place(), place(), 0..8u32).prop_map(|(to, from, len)| Statement::Copy(to, from, len)),
    ];
    let others = prop_oneof![
        prop::option::of(b.clone()).prop_map(Statement::OpenDb),
        (w.clone(), 1..4u32).prop_map(|(to, number)| Statement::DbLength(to, number)),
        (0..7u8, 0..8u32).prop_map(|(region, offset)| Statement::Point(region, offset)),
        (0..FUNCTIONS, w.clone(), w.clone(), b).prop_map(|(f, to, from, bit)| Statement::Call(f, to, from, bit)),
        (w.clone(), w.clone()).prop_map(|(to, from)| Statement::Timer(to, from)),
        w.clone().prop_map(Statement::Peripheral),
        w.prop_map(Statement::Safepoint),
    ];
    prop_oneof![3 => values, 5 => memory, 2 => others]
}

fn random_block(blocks: usize) -> impl Strategy<Value = RandomBlock> {
    let end = prop_oneof![
        2 => (1..blocks).prop_map(End::Jump),
        4 => (0..BITS, 1..blocks, 1..blocks).prop_map(|(bit, a, b)| End::Branch(bit, a, b)),
        1 => (0..WORDS, prop::collection::vec(1..blocks, 0..3), 1..blocks)
            .prop_map(|(word, targets, default)| End::Switch(word, targets, default)),
        1 => Just(End::Return),
    ];
    (prop::collection::vec(statement(), 0..14), end, prop::bool::weighted(0.15))
        .prop_map(|(statements, end, cold)| RandomBlock { statements, end, cold })
}

pub(super) fn random_function() -> impl Strategy<Value = Vec<RandomBlock>> {
    (2..6usize).prop_flat_map(|blocks| prop::collection::vec(random_block(blocks), blocks))
}
