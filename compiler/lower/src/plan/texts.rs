//! What all callers of a function give it for its parameters that are texts.

use plcc_abi::image::BlockKind;
use plcc_ir::StaticDb;
use plcc_model::scl::walk::{self, Visitor};
use plcc_model::scl::{self, Access, Base, Complex};
use plcc_model::types::DataType;
use plcc_model::{
    Actual, Argument, BlockKey, Body, Call, CodeBlock, Number, Operand, Parameter, Passing, Place, Program,
    StlStatement, StlStatementKind,
};
use rustc_hash::FxHashMap;

use super::takes_references;
use crate::scl::text::TEXT_MAX;

/// A text that exists, in a DB of the program or in local data, whatever call it is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GivenText {
    /// The declared maximum that they all have; 0 if it is not known.
    pub declared: u8,
    /// They are rooms for the result, which have no other name.
    pub is_room: bool,
}

/// What has been seen of a parameter.
#[derive(Clone, Copy)]
enum Seen {
    Nothing,
    Text(GivenText),
    /// One that may not exist.
    Anything,
}

impl Seen {
    fn add(&mut self, given: Option<GivenText>) {
        *self = match (*self, given) {
            (Seen::Anything, _) | (_, None) => Seen::Anything,
            (Seen::Nothing, Some(given)) => Seen::Text(given),
            (Seen::Text(one), Some(two)) => Seen::Text(GivenText {
                declared: if one.declared == two.declared { one.declared } else { 0 },
                is_room: one.is_room && two.is_room,
            }),
        };
    }
}

/// For each block of the program, what its parameters get; nothing if a call names its block at run time.
pub(super) fn given_texts(
    program: &Program,
    index: &FxHashMap<BlockKey, usize>,
    dbs: &[StaticDb],
    has_dynamic_calls: bool,
) -> Vec<Vec<Option<GivenText>>> {
    let is_text = |parameter: &Parameter| {
        matches!((parameter.passing, &parameter.ty), (Passing::Complex { .. }, DataType::String(_)))
    };
    let seen = program.blocks.iter().map(|block| {
        let takes_texts = takes_references(block) && !has_dynamic_calls;
        let begin = |parameter| if takes_texts && is_text(parameter) { Seen::Nothing } else { Seen::Anything };
        block.interface.parameters.iter().map(begin).collect()
    });
    let mut calls = Calls { program, index, dbs, seen: seen.collect() };
    for block in &program.blocks {
        match &block.body {
            Body::Stl(statements) => statements.iter().for_each(|statement| calls.stl(statement)),
            Body::Scl(body) => walk::statements(&body.statements, &mut calls),
            _ => {}
        }
    }
    let text = |seen: Seen| match seen {
        Seen::Text(given) => Some(given),
        Seen::Nothing | Seen::Anything => None,
    };
    calls.seen.into_iter().map(|block| block.into_iter().map(text).collect()).collect()
}

struct Calls<'a> {
    program: &'a Program,
    index: &'a FxHashMap<BlockKey, usize>,
    dbs: &'a [StaticDb],
    seen: Vec<Vec<Seen>>,
}

impl<'a> Calls<'a> {
    fn callee(&self, key: BlockKey) -> Option<(usize, &'a CodeBlock)> {
        let index = *self.index.get(&key)?;
        Some((index, &self.program.blocks[index]))
    }

    fn stl(&mut self, statement: &StlStatement) {
        match &statement.kind {
            StlStatementKind::Instruction {
                operand: Operand::Block { kind, number: Number::Known(number) }, ..
            } => {
                self.unknown(*kind, *number);
            }
            StlStatementKind::Call(call) => self.stl_call(call),
            _ => {}
        }
    }

    /// A call without parameters.
    fn unknown(&mut self, kind: BlockKind, number: u16) {
        if let Some((callee, _)) = self.callee(BlockKey { kind, number }) {
            self.seen[callee].iter_mut().for_each(|seen| seen.add(None));
        }
    }

    fn stl_call(&mut self, call: &Call) {
        let Some((index, callee)) = self.callee(call.target) else { return };
        for parameter in 0..callee.interface.parameters.len() {
            let argument: Option<&Argument> = call.arguments.iter().find(|argument| argument.parameter == parameter);
            let given = match argument.map(|argument| &argument.actual) {
                Some(Actual::Place(place)) => {
                    self.exists(place, 0).then_some(GivenText { declared: 0, is_room: false })
                }
                Some(Actual::Const(bytes)) => constant(bytes),
                _ => None,
            };
            self.seen[index][parameter].add(given);
        }
    }

    /// Whether a text with this maximum is at `place`.
    fn exists(&self, place: &Place, maximum: u32) -> bool {
        match place {
            Place::L { bit: 0, .. } => true,
            Place::Db { number, byte, bit: 0 } => {
                let db = self.dbs.binary_search_by_key(number, |db| db.number).ok().map(|at| &self.dbs[at]);
                db.is_some_and(|db| byte + 2 + maximum <= db.length)
            }
            _ => false,
        }
    }

    fn variable(&self, access: &Access) -> Option<GivenText> {
        let (Base::Place(place), DataType::String(maximum)) = (&access.base, &access.ty) else { return None };
        let is_there = access.indices.is_empty() && self.exists(place, u32::from(*maximum));
        is_there.then_some(GivenText { declared: *maximum, is_room: false })
    }
}

impl Visitor for Calls<'_> {
    fn statement(&mut self, statement: &scl::Statement) {
        if let scl::StatementKind::Stl(statement) = &statement.kind {
            self.stl(statement);
        }
    }

    fn call(&mut self, call: &scl::Call) {
        let Some((index, callee)) = self.callee(call.target) else { return };
        let result = crate::scl::result(callee).map(|(index, _)| index);
        let in_frame = |declared: u32, is_room| Some(GivenText { declared: declared as u8, is_room });
        for parameter in 0..callee.interface.parameters.len() {
            let argument = call.arguments.iter().find(|argument| argument.parameter == parameter);
            let given = match argument.map(|argument| &argument.actual) {
                // Rooms in the frame of the caller.
                None => in_frame(TEXT_MAX, result == Some(parameter)),
                Some(scl::Actual::Complex(Complex::Call(_))) => in_frame(TEXT_MAX, false),
                Some(scl::Actual::Complex(Complex::Character(_))) => in_frame(1, false),
                Some(scl::Actual::Complex(Complex::Const(bytes))) => constant(bytes),
                Some(scl::Actual::Complex(Complex::Variable(access)) | scl::Actual::Reference(access)) => {
                    self.variable(access)
                }
                Some(_) => None,
            };
            self.seen[index][parameter].add(given);
        }
    }
}

/// A constant with its head, which is in the frame of the caller.
fn constant(bytes: &[u8]) -> Option<GivenText> {
    let &[maximum, _] = bytes.first_chunk()?;
    Some(GivenText { declared: maximum, is_room: false })
}
