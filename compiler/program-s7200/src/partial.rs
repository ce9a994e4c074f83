//! Stand-ins for missing parts of an S7-200 program: subroutines and interrupt routines that do nothing, and separate addresses
//! for symbols, at the end of V memory. Meaning: docs/decisions/0082 and 0083.

use std::collections::BTreeMap;

use plcc_diag::{Code, Diagnostic, FileId, Span};
use plcc_syntax::ast::{SourceUnit, Width};
use plcc_syntax::s7200::ast::{self, Area, BlockKind, OperandKind, StatementKind, SymbolForm};
use plcc_syntax::s7200::{Insn, OperandClass, parse_block};
use rustc_hash::FxHashSet;

use super::names::fold;
use super::operand;
use plcc_binding::report::MissingKey;
use plcc_binding::stand_ins::{self as partial, Completed, LeftOut, Missing, Parts, Told, Whole, errors};
use plcc_binding::{BindInput, Bound};
use plcc_model::profile;
use plcc_syntax::symbols::{S7200Symbol, SymbolTable};

/// Limit of passes that leave out parts.
const ROUNDS_MAX: u32 = 40;

/// The kind of a missing name.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Use {
    Bit,
    Byte,
    Word,
    Dword,
    Timer,
    Counter,
    Block(BlockKind),
}

/// A missing name or block.
struct Thing {
    name: String,
    /// A block by its number.
    number: Option<u32>,
    used: Option<Use>,
}

/// The blocks that rows of symbol tables name.
type Named = BTreeMap<String, (BlockKind, u32)>;

/// Binds a program in which parts may be missing, with stand-ins for them.
pub fn complete(input: &BindInput) -> Completed {
    let first = super::bind_all(input);
    let no_main =
        input.require_main && !first.program.blocks.iter().any(|block| block.kind == plcc_abi::image::BlockKind::Ob);
    if first.missing.is_empty() && !no_main && !first.diagnostics.iter().any(Diagnostic::is_error) {
        let Bound { program, mut diagnostics, reviewed, .. } = first;
        diagnostics.extend(reviewed);
        return Completed { program, diagnostics, stand_ins: String::new() };
    }
    let file = FileId(input.sources.files().count() as u32);
    let missing: FxHashSet<String> = first
        .missing
        .iter()
        .filter_map(|uses| match &uses.key {
            MissingKey::Symbol(name) => Some(name.clone()),
            _ => None,
        })
        .collect();
    let rows = input.tables.iter().flat_map(|table| &table.s7200);
    let named: Named = rows.filter_map(|row| Some((fold(&row.name), parse_block(&row.address)?))).collect();
    let mut units = input.units.to_vec();
    let mut things: BTreeMap<String, Thing> = BTreeMap::new();
    let mut highest = 0;
    for source in units.iter_mut().filter_map(|(_, unit)| unit.s7200.as_mut()) {
        for block in &mut source.blocks {
            look_at(block, &missing, &named, &mut things, &mut highest);
        }
        for line in &source.data {
            // Consecutive values have four bytes at most.
            let start = line.address.as_ref().map_or(highest, |operand| end_of(operand).unwrap_or(0));
            highest = highest.max(start.saturating_add(4 * line.values.len() as u32));
        }
    }
    for row in input.tables.iter().flat_map(|table| &table.s7200) {
        if let Some(direct) = plcc_syntax::s7200::parse_address(&row.address)
            && direct.area == Area::V
        {
            highest = highest.max(direct.number.saturating_add(4));
        }
    }
    let (table, source, lines) = stand_ins(input, &things, file, highest, no_main);
    let own: FxHashSet<(Code, Span)> = errors(&first.diagnostics).collect();
    let mut wrong: Option<FxHashSet<(Code, Span)>> = None;
    let mut left = Vec::new();
    for round in 0.. {
        let unit = SourceUnit { s7200: Some(source.clone()), ..SourceUnit::default() };
        let whole = Whole {
            units: units.iter().cloned().chain([(file, unit)]).collect(),
            tables: input.tables.iter().cloned().chain([table.clone()]).collect(),
        };
        let bound = super::bind_all(&whole.as_input(input, file));
        let wrong =
            wrong.get_or_insert_with(|| errors(&bound.diagnostics).filter(|error| own.contains(error)).collect());
        let mut places: Vec<Span> =
            errors(&bound.diagnostics).filter(|error| !wrong.contains(error)).map(|(_, span)| span).collect();
        places.extend(bound.missing.iter().flat_map(|uses| &uses.places));
        places.sort_unstable_by_key(|span| (span.file, span.start, span.end));
        places.dedup();
        let before = left.len();
        left.extend(places.iter().filter_map(|place| leave_out(&mut units, *place)));
        if places.is_empty() || left.len() == before || round >= ROUNDS_MAX {
            let parts = Parts { told: lines, added: Vec::new(), left, no_main, stand_ins: "\n".to_string() };
            return partial::finish(input, first, bound, wrong, &places, parts);
        }
    }
    unreachable!("the loop returns at the latest after its last round")
}

/// Notes the missing names and blocks that a block uses. Calls of missing subroutines lose their arguments: nothing uses them.
fn look_at(
    block: &mut ast::Block,
    missing: &FxHashSet<String>,
    named: &Named,
    things: &mut BTreeMap<String, Thing>,
    highest: &mut u32,
) {
    let locals: FxHashSet<String> = block.declarations.iter().map(|declaration| fold(&declaration.name)).collect();
    for statement in block.networks.iter_mut().flat_map(|network| &mut network.statements) {
        let StatementKind::Instruction { insn, operands, .. } = &mut statement.kind else { continue };
        if *insn == Insn::Call
            && let Some(target) = operands.first()
            && key_of(target, named).is_some_and(|(key, _)| missing.contains(&key))
        {
            operands.truncate(1);
        }
        let classes = insn.operands();
        for (at, operand) in operands.iter().enumerate() {
            let class = match (*insn, at) {
                (Insn::Call, 1..) => None,
                _ => classes.get(at).copied(),
            };
            note(operand, class, &locals, missing, named, things);
            if let Some(end) = end_of(operand) {
                *highest = (*highest).max(end);
            }
        }
    }
}

/// The end of what an operand names in V memory.
fn end_of(operand: &ast::Operand) -> Option<u32> {
    match &operand.kind {
        OperandKind::Direct(direct) if direct.area == Area::V => {
            Some(direct.number.saturating_add(direct.width.map_or(4, Width::bytes)))
        }
        OperandKind::AddressOf(inner) => end_of(inner),
        _ => None,
    }
}

/// The key by which an operand can be missing: of its name, or of the block that it means.
fn key_of(operand: &ast::Operand, named: &Named) -> Option<(String, Option<(BlockKind, u32)>)> {
    let (kind, number) = match &operand.kind {
        OperandKind::Symbol { name, form } if *form != SymbolForm::Local => match named.get(&fold(name)) {
            Some(block) => *block,
            None => return Some((fold(name), None)),
        },
        OperandKind::Block { kind, number } => (*kind, *number),
        _ => return None,
    };
    let letters = match kind {
        BlockKind::Main => "ob",
        BlockKind::Subroutine => "sbr",
        BlockKind::Interrupt => "int",
    };
    Some((format!("{letters}{number}"), Some((kind, number))))
}

fn note(
    operand: &ast::Operand,
    class: Option<OperandClass>,
    locals: &FxHashSet<String>,
    missing: &FxHashSet<String>,
    named: &Named,
    things: &mut BTreeMap<String, Thing>,
) {
    let used = class.and_then(|class| match class {
        OperandClass::Subroutine => Some(Use::Block(BlockKind::Subroutine)),
        OperandClass::Interrupt => Some(Use::Block(BlockKind::Interrupt)),
        OperandClass::Timer => Some(Use::Timer),
        OperandClass::Counter => Some(Use::Counter),
        class => operand::width(class).map(|width| match width {
            Width::Bit => Use::Bit,
            Width::Byte => Use::Byte,
            Width::Word => Use::Word,
            Width::Dword | Width::Lword => Use::Dword,
        }),
    });
    match &operand.kind {
        OperandKind::Indirect(pointer) => {
            return note(pointer, Some(OperandClass::DwordIn), locals, missing, named, things);
        }
        OperandKind::AddressOf(inner) => {
            return note(inner, Some(OperandClass::ByteIn), locals, missing, named, things);
        }
        _ => {}
    }
    let Some((key, block)) = key_of(operand, named) else { return };
    let is_local = matches!(&operand.kind, OperandKind::Symbol { name, .. } if locals.contains(&fold(name)));
    if !missing.contains(&key) || is_local {
        return;
    }
    let name = match (&operand.kind, block) {
        (OperandKind::Symbol { name, .. }, None) => name.clone(),
        _ => key.to_uppercase(),
    };
    let thing = things.entry(key).or_insert(Thing { name, number: block.map(|(_, number)| number), used: None });
    thing.used = match (thing.used, used) {
        // A timer's bit and its value are also used by its name.
        (Some(known @ (Use::Timer | Use::Counter | Use::Block(_))), _) => Some(known),
        (_, Some(better @ (Use::Timer | Use::Counter | Use::Block(_)))) => Some(better),
        (known, used) => known.or(used),
    };
    if let Some((kind, _)) = block {
        thing.used = Some(Use::Block(kind));
    }
}

/// Rows and blocks that stand in, with a line for each.
fn stand_ins(
    input: &BindInput,
    things: &BTreeMap<String, Thing>,
    file: FileId,
    highest: u32,
    no_main: bool,
) -> (SymbolTable, ast::Source, Vec<Told>) {
    let (mut table, mut source, mut lines) = (SymbolTable::default(), ast::Source::default(), Vec::new());
    let span = Span { file, start: 0, end: 0 };
    let mut v = profile::s7200::cpu_row(&input.profile).v_bytes;
    let (mut timer, mut counter) = (256, 256);
    let block = |kind, name: Option<&str>, number: Option<u32>| ast::Block {
        kind,
        name: name.map(|name| (name.to_string(), span)),
        number: number.map(|number| (number, span)),
        is_bare: false,
        title: String::new(),
        comment: Vec::new(),
        declarations: Vec::new(),
        networks: Vec::new(),
        span,
    };
    for (key, thing) in things {
        let mut place = |bytes: u32| {
            let at = v.checked_sub(bytes)? / bytes.clamp(1, 2) * bytes.clamp(1, 2);
            (at >= highest).then(|| {
                v = at;
                at
            })
        };
        let address = match thing.used {
            Some(Use::Block(kind)) => {
                let name = thing.number.is_none().then_some(thing.name.as_str());
                source.blocks.push(block(kind, name, thing.number));
                let what = "a stub that does nothing".to_string();
                let line = format!("{} is missing: {what}", thing.name);
                lines.push(Told { missing: Missing::Name(key.clone()), line, what });
                continue;
            }
            Some(Use::Timer) => {
                timer -= 1;
                Some(format!("T{timer}"))
            }
            Some(Use::Counter) => {
                counter -= 1;
                Some(format!("C{counter}"))
            }
            Some(Use::Bit) => place(1).map(|at| format!("V{at}.0")),
            Some(Use::Byte) => place(1).map(|at| format!("VB{at}")),
            Some(Use::Word) => place(2).map(|at| format!("VW{at}")),
            Some(Use::Dword) => place(4).map(|at| format!("VD{at}")),
            None => None,
        };
        let Some(address) = address else { continue };
        let what = format!("{address}, which nothing else uses");
        let line = format!("`{}` is missing: {what}", thing.name);
        lines.push(Told { missing: Missing::Name(key.clone()), line, what });
        table.s7200.push(S7200Symbol {
            name: thing.name.clone(),
            address,
            name_span: span,
            address_span: span,
            comment: String::new(),
        });
    }
    if no_main {
        source.blocks.push(block(BlockKind::Main, None, None));
    }
    (table, source, lines)
}

/// Leaves out the network that holds `at`.
fn leave_out(units: &mut [(FileId, SourceUnit)], at: Span) -> Option<LeftOut> {
    let (_, unit) = units.iter_mut().find(|(file, _)| *file == at.file)?;
    let source = unit.s7200.as_mut()?;
    let holds = |outer: Span| outer.start <= at.start && at.end <= outer.end;
    let networks = source.blocks.iter_mut().flat_map(|block| &mut block.networks);
    for network in networks {
        if network.statements.iter().any(|statement| holds(statement.span)) {
            network.statements.clear();
            return Some(LeftOut { span: at, what: "this network" });
        }
    }
    let before = source.data.len();
    source.data.retain(|line| !holds(line.span));
    (source.data.len() < before).then_some(LeftOut { span: at, what: "this line of the data block" })
}
