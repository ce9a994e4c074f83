//! Partial programs: declarations stand in for names that no source defines, so that the rest compiles and runs.
//!
//! 1. The program is bound as it is. There is one warning for all names that are defined nowhere.
//! 2. [`look`], [`scl`], [`stl`] and [`network`] examine the uses of missing names; [`evidence`] collects what they show. [`write`] makes
//!    declarations from it, and the next pass knows more: the type of a tag may follow from a missing block. This ends when nothing new is found.
//! 3. The program is bound with the stand-ins. Parts that still cannot be bound are left out, the smallest that can be removed ([`leave_out`]),
//!    and reported. Errors that the program also has without stand-ins stay errors.
//!
//! Meaning: docs/decisions/0082 and 0083.

mod declared;
mod evidence;
mod inside;
mod leave_out;
mod look;
mod network;
mod scl;
mod size;
mod stl;
mod types;
mod write;

use plcc_diag::{Code, Diagnostic, FileId, Span};
use plcc_syntax::ast::{self, BlockName, BlockPrefix, CodeKind, SourceUnit};
use plcc_syntax::scl::ast::Dialect;
use rustc_hash::{FxHashMap, FxHashSet};

use plcc_binding::report::MissingKey;
use plcc_binding::stand_ins::{Completed, Missing, Parts, Told, Whole, errors, finish};

use super::declarations::typed::BoundInterface;
use crate::bind::declarations::Declarations;
use crate::bind::declarations::block::CurrentBlock;
use crate::bind::scl::{SclBlock, Scope, marks_locals};
use crate::bind::trees::blocks;
use evidence::{Evidence, Guess};
use look::Look;
use plcc_binding::BindInput;
use plcc_binding::Bound;
use plcc_model::Program;
use write::{StandIns, Writer};

/// Limit of passes over the uses; each but the last finds something new.
const LOOKS_MAX: u32 = 12;

/// Limit of passes that leave out parts; each leaves out everything that the last binding reported.
const ROUNDS_MAX: u32 = 40;

/// Binds a program in which parts may be missing, with stand-ins for them.
pub fn complete(input: &BindInput) -> Completed {
    let first = super::program::bind_all(input);
    let no_main = input.require_main && !has_main(input, &first.program);
    let has_errors = first.diagnostics.iter().any(Diagnostic::is_error);
    if first.missing.is_empty() && !no_main && !has_errors {
        let Bound { program, mut diagnostics, reviewed, .. } = first;
        diagnostics.extend(reviewed);
        return Completed { program, diagnostics, stand_ins: String::new() };
    }
    let file = FileId(input.sources.files().count() as u32);
    let evidence = gather(input, file);
    let mut refused = FxHashSet::default();
    let mut units = input.units.to_vec();
    let mut left = Vec::new();
    // Errors both with and without stand-ins are errors.
    let mut wrong: Option<FxHashSet<(Code, Span)>> = None;
    let own: FxHashSet<(Code, Span)> = errors(&first.diagnostics).collect();
    for round in 0.. {
        let stand_ins = stand_ins(input, &evidence, file, Guess::Anything, &refused, no_main);
        let whole = with(input, &units, &evidence, Guess::Anything, &stand_ins, file);
        let bound = super::program::bind_all(&whole.as_input(input, file));
        let wrong =
            wrong.get_or_insert_with(|| errors(&bound.diagnostics).filter(|error| own.contains(error)).collect());
        let mut places: Vec<Span> =
            errors(&bound.diagnostics).filter(|error| !wrong.contains(error)).map(|(_, span)| span).collect();
        places.extend(
            bound.missing.iter().filter(|uses| !matches!(uses.key, MissingKey::Db(_))).flat_map(|uses| &uses.places),
        );
        places.sort_unstable_by_key(|span| (span.file, span.start, span.end));
        places.dedup();
        let before = (left.len(), refused.len());
        let earlier = units.clone();
        for place in &places {
            if place.file == file {
                if let Some(line) = stand_ins.lines.get(place.start as usize) {
                    refused.insert(line.missing.clone());
                }
            } else if let Some(part) = leave_out::leave_out(&mut units, &earlier, *place) {
                left.push(part);
            }
        }
        if places.is_empty() || before == (left.len(), refused.len()) || round >= ROUNDS_MAX {
            let told = stand_ins
                .lines
                .iter()
                .map(|line| Told {
                    missing: line.missing.clone(),
                    line: format!("{} is missing: {}", line.name, line.what),
                    what: line.what.clone(),
                })
                .collect();
            let added = added_components(&evidence);
            let parts = Parts { told, added, left, no_main, stand_ins: text(&stand_ins) };
            return finish(input, first, bound, wrong, &places, parts);
        }
    }
    unreachable!("the loop returns at the latest after its last round")
}

fn has_main(input: &BindInput, program: &Program) -> bool {
    program.blocks.iter().any(|block| super::program::is_main(input, &program.config, block))
}

fn with(
    input: &BindInput,
    units: &[(FileId, SourceUnit)],
    evidence: &Evidence,
    guess: Guess,
    stand_ins: &StandIns,
    file: FileId,
) -> Whole {
    let mut units = units.to_vec();
    add_components(&mut units, evidence, guess);
    let unit = SourceUnit { blocks: stand_ins.blocks.clone(), ..SourceUnit::default() };
    Whole {
        units: units.into_iter().chain([(file, unit)]).collect(),
        tables: input.tables.iter().cloned().chain([stand_ins.table.clone()]).collect(),
    }
}

/// Adds the components that the program uses and the data blocks do not declare, after the declared ones: addresses stay.
fn add_components(units: &mut [(FileId, SourceUnit)], evidence: &Evidence, guess: Guess) {
    if evidence.added.is_empty() {
        return;
    }
    for block in units.iter_mut().flat_map(|(_, unit)| &mut unit.blocks) {
        let ast::Block::Data(data) = block else { continue };
        let span = data.name.span();
        if let (Some(shape), ast::DataContent::Struct(variables)) =
            (evidence.added.get(&(span.file, span.start)), &mut data.content)
        {
            let shape = shape.declared(guess);
            if !shape.members.is_empty() {
                variables.extend(types::members(&shape, span));
            }
        }
    }
}

fn stand_ins(
    input: &BindInput,
    evidence: &Evidence,
    file: FileId,
    guess: Guess,
    refused: &FxHashSet<Missing>,
    no_main: bool,
) -> StandIns {
    let profile = &input.profile;
    let limit = |cells: u32| cells.min(plcc_abi::layout::TIMERS_MAX);
    let used_cells = &evidence.cells;
    let cells = [limit(profile.timers), limit(profile.counters)];
    let outlines = outlines(input);
    let mut stand_ins = Writer { evidence, file, guess, refused, cells, used_cells, outlines: &outlines }.write();
    if no_main {
        let at = stand_ins.lines.len() as u32;
        let span = Span { file, start: at, end: at };
        stand_ins.blocks.push(ast::Block::Code(ast::CodeBlock {
            kind: CodeKind::Ob,
            name: BlockName::Numbered { prefix: BlockPrefix::Ob, number: 1, span },
            return_type: None,
            header: ast::Header::default(),
            sections: Vec::new(),
            constants: Vec::new(),
            code: ast::Code::Scl(plcc_syntax::scl::ast::Body { dialect: Dialect::Either, ..Default::default() }),
            span,
        }));
    }
    stand_ins
}

/// Interfaces as calls describe them, by folded names; the first call of a block counts.
fn outlines<'a>(input: &BindInput<'a>) -> FxHashMap<String, &'a ast::CodeBlock> {
    let mut found = FxHashMap::default();
    for outline in input.units.iter().flat_map(|(_, unit)| &unit.outlines) {
        if let BlockName::Symbol { name, .. } = &outline.name {
            found.entry(plcc_binding::fold(name)).or_insert(outline);
        }
    }
    found
}

/// Repeats until nothing new is found.
fn gather(input: &BindInput, file: FileId) -> Evidence {
    let mut evidence = Evidence::default();
    let none = FxHashSet::default();
    for guess in Guess::ALL {
        for _ in 0..LOOKS_MAX {
            let before = evidence.weight();
            let stand_ins = stand_ins(input, &evidence, file, guess, &none, false);
            let whole = with(input, input.units, &evidence, guess, &stand_ins, file);
            let input = whole.as_input(input, file);
            let mut program = Declarations::new(&input);
            program.globals.collect();
            program.globals.ob_classes();
            program.bind_types();
            program.bind_data();
            look_at(&mut program, &mut evidence, file);
            if evidence.weight() == before {
                break;
            }
        }
    }
    evidence
}

fn look_at(program: &mut Declarations, evidence: &mut Evidence, file: FileId) {
    let input = program.globals.input;
    let outlines = outlines(input);
    let mut look = Look { program, found: evidence, outlines: &outlines };
    for (unit_file, unit) in input.units {
        if *unit_file == file {
            continue;
        }
        for outline in &unit.outlines {
            if let BlockName::Symbol { name, .. } = &outline.name
                && look.found.things.contains_key(&Missing::name(name))
            {
                look.declarations(&ast::Block::Code(outline.clone()));
            }
        }
        for block in &unit.blocks {
            look.declarations(block);
            if let ast::Block::Code(code) = block {
                look.block(code);
            }
        }
    }
    look.rows_of_tables();
}

impl Look<'_, '_> {
    fn block(&mut self, code: &ast::CodeBlock) {
        let span = code.name.span();
        let key = self
            .program
            .globals
            .sources
            .code
            .iter()
            .find(|(_, source)| source.block().name.span() == span)
            .map(|(key, _)| *key);
        // A second definition of a block does not count.
        let Some(key) = key else { return };
        let bound = self
            .quietly(|program| program.interface(key, span))
            .unwrap_or_else(|| std::rc::Rc::new(BoundInterface::default()));
        let dialect = blocks::dialect(code).unwrap_or_default();
        let mut block = CurrentBlock::new(key, bound);
        block.fragment = blocks::is_fragment(code);
        let mut ctx =
            SclBlock { block: &mut block, scope: Scope::new(self.program.globals.input, &code.header, dialect) };
        ctx.scope.marks_locals = marks_locals(&code.code);
        ctx.scope.address_numbers =
            matches!(&code.code, ast::Code::Chart(body) if body.dialect == plcc_syntax::chart::ast::Dialect::Classic);
        self.code(&mut ctx, &code.code);
    }
}

/// The stand-ins, one line for each.
fn text(stand_ins: &StandIns) -> String {
    // Positions count characters: one for each line, so that they are inside the text.
    let mut text: String = stand_ins.lines.iter().map(|_| '\n').collect();
    text.push('\n');
    text
}

/// Reports which components data blocks got.
fn added_components(evidence: &Evidence) -> Vec<(Span, String)> {
    let line = |shape: &evidence::Shape| {
        let names: Vec<String> = shape.members.iter().map(|(_, member)| format!("`{}`", member.name)).collect();
        (shape.place.unwrap_or_default(), format!("{} lacks {}: added at its end", shape.name, names.join(", ")))
    };
    evidence.added.values().map(line).collect()
}
