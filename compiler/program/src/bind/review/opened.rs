//! Accesses to the open data block where another one is open than the OPN before says: `L DB5.DBW 0` opens DB 5, a call of an FB leaves its
//! instance data block open, and what STEP 7 makes of a call of an FC may open the data block of an actual parameter. And accesses beyond
//! the end of the data block that an OPN has opened. A warning is given only where no label is between.

use plcc_abi::image::Family;
use plcc_diag::{Code, Diagnostic, SourceMap, Span};
use plcc_model::{Actual, Call, Instance, Number, Operand, Passing, Place, PlaceArea, StlStatement, StlStatementKind};
use plcc_syntax::stl::StlInsn;

use super::numbers::written;
use crate::bind::declarations::Declarations;

/// A data block in the DB register, and the statement that opens it.
#[derive(Clone, Copy)]
struct Opened {
    number: u16,
    by: Opener,
    span: Span,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Opener {
    /// `OPN`
    Statement,
    /// `L DB5.DBW 0`
    Access,
    /// A call of an FB, with this instance.
    Instance,
    /// A call of an FC with an actual parameter in a data block.
    Actual,
}

/// Reports accesses to the open data block after something else than an OPN has opened another one, and those beyond its end.
/// `sources`: as they were read.
pub fn review(
    program: &mut Declarations,
    statements: &[StlStatement],
    sources: &SourceMap,
    found: &mut Vec<Diagnostic>,
) {
    if !matches!(program.globals.input.profile.family, Family::S7300 | Family::S7400) {
        return;
    }
    // What the last OPN opens, and what is open instead.
    let (mut meant, mut open): (Option<Opened>, Option<Opened>) = (None, None);
    for statement in statements {
        let span = statement.span;
        let accesses = uses_open(statement);
        if let (Some(at), Some(before), Some(now)) = (accesses, meant, open) {
            found.push(message(at, before, now, sources));
            meant = None;
        } else if let Some(end) = end_in_open(statement)
            && let Some(opened) = open.or(meant)
            && matches!(opened.by, Opener::Statement | Opener::Access)
        {
            program.check_db_end(opened.number, end, span);
        }
        let opened = match &statement.kind {
            StlStatementKind::Assert(_) | StlStatementKind::Sleep(_) => continue,
            StlStatementKind::Label(_) | StlStatementKind::JumpList { .. } => None,
            StlStatementKind::Instruction { insn, operand } => match (insn, operand) {
                (StlInsn::OpenDb, Operand::Db { di: true, .. }) => continue,
                (StlInsn::OpenDb, Operand::Db { number: Number::Known(number), .. }) => {
                    Some((*number, Opener::Statement))
                }
                (StlInsn::OpenDb | StlInsn::SwapDb, _) => None,
                (_, Operand::Memory { place: Place::Db { number, .. }, .. }) => Some((*number, Opener::Access)),
                // The pointer of the parameter opens a data block that is not known.
                (_, Operand::Memory { place: Place::ThroughPointer { .. }, .. }) => None,
                _ => continue,
            },
            StlStatementKind::Call(call) => match &call.instance {
                Some(Instance::Db(number)) => Some((*number, Opener::Instance)),
                Some(Instance::Multi { .. } | Instance::Inner { .. }) => None,
                None => match block_of_actual(program, call, span) {
                    Some(number) => Some((number, Opener::Actual)),
                    None => continue,
                },
            },
        };
        let opened = opened.map(|(number, by)| Opened { number, by, span });
        match opened {
            Some(Opened { by: Opener::Statement, .. }) => (meant, open) = (opened, None),
            Some(now) => open = meant.filter(|before| before.number != now.number).map(|_| now),
            None => (meant, open) = (None, None),
        }
    }
}

/// Where a statement accesses the open data block.
fn uses_open(statement: &StlStatement) -> Option<Span> {
    match &statement.kind {
        StlStatementKind::Instruction { operand: Operand::Memory { place, .. }, .. } => {
            is_open(place).then_some(statement.span)
        }
        StlStatementKind::Call(call) => {
            let mut arguments = call.arguments.iter();
            let uses = arguments.find(|argument| matches!(&argument.actual, Actual::Place(place) if is_open(place)));
            uses.map(|argument| argument.span)
        }
        _ => None,
    }
}

/// The byte after an access to the open data block at an address that is known.
fn end_in_open(statement: &StlStatement) -> Option<u32> {
    match &statement.kind {
        StlStatementKind::Instruction {
            operand: Operand::Memory { place: Place::OpenDb { byte, .. }, width }, ..
        } => byte.checked_add(width.bytes()),
        _ => None,
    }
}

/// A place in the open data block.
fn is_open(place: &Place) -> bool {
    match place {
        Place::OpenDb { .. } | Place::Register { area: Some(PlaceArea::Db), .. } => true,
        Place::Indirect { area, pointer } => *area == PlaceArea::Db || is_open(pointer),
        _ => false,
    }
}

/// The data block of an elementary actual parameter of an FC.
fn block_of_actual(program: &mut Declarations, call: &Call, span: Span) -> Option<u16> {
    let bound = program.interface(call.target, span)?;
    call.arguments.iter().find_map(|argument| {
        let parameter = bound.interface.parameters.get(argument.parameter)?;
        match (&argument.actual, parameter.passing) {
            (Actual::Place(Place::Db { number, .. }), Passing::Elementary(_)) => Some(*number),
            _ => None,
        }
    })
}

/// `at`: the access. `before`: what the program opened. `now`: what is open instead.
fn message(at: Span, before: Opened, now: Opened, sources: &SourceMap) -> Diagnostic {
    let (access, number) = (written(at, sources), now.number);
    let (is_in, why) = match now.by {
        Opener::Statement | Opener::Access => ("is in", format!("opens DB {number}, too")),
        Opener::Instance => ("is in", "leaves its instance data block open".to_string()),
        Opener::Actual => ("may be in", format!("the code that STEP 7 makes of this call may open DB {number}")),
    };
    let title = format!("`{access}` {is_in} DB {number}, not in DB {}", before.number);
    Diagnostic::new(Code::OtherDataBlock, at, title)
        .label("the data block in the DB register")
        .also(before.span, format!("opens DB {}", before.number))
        .also(now.span, why)
        .help(format!("write `{}` before it again", written(before.span, sources)))
}
