//! Binding of programs for the S7-200: names, operands, ranges of the CPU, the shape of networks, sequence steps and loops.
//!
//! 1. [`names`] finds the blocks, numbers those that have only a name, and reads the symbol tables.
//! 2. [`interface`] places parameters and variables in local memory.
//! 3. [`body`] binds statements: [`settle`] determines what an operand is, [`operand`] whether the instruction accepts it, [`constant`]
//!    its bits; [`meant`] says what operands that do not fit are meant for; [`call`] binds calls, [`pragma`] assertions. [`stack`] counts
//!    levels of the logic stack, [`structure`] pairs loops, steps and jumps, [`rules`] checks where instructions are allowed and which
//!    constants they accept.
//! 4. [`whole`] checks the whole program: timers, counters, steps, depth of calls. [`data`] fills V memory.
//! 5. [`review`] looks at bound blocks for statements that are useless.
//!
//! Messages name the error number that the CPU's own programming tool shows.
//! Source: S7-200 system manual, instruction set and compile rule violations.

mod address;
mod argument;
mod body;
mod call;
mod constant;
mod data;
mod interface;
mod meant;
mod names;
mod numbers;
mod operand;
mod partial;
pub use partial::complete;
mod pragma;
mod review;
mod rules;
mod settle;
mod stack;
mod structure;
#[cfg(test)]
mod tests;
mod whole;

use plcc_abi::image::BlockKind;
use plcc_abi::names::External;
use plcc_abi::s7200::image::CpuRow;
use plcc_diag::{Code, Diagnostic, FileId, Span};
use plcc_syntax::s7200::ast::OperandKind;
use rustc_hash::FxHashMap;

use plcc_binding::report::Report;
use plcc_binding::{BindInput, Bound};
use plcc_model::profile;
use plcc_model::{Body, CodeBlock, Interface, Program, Symbol, TestSettings};

/// Binds the blocks of Micro/WIN sources. The program is complete if no message is an error and, with `partial`, nothing is undefined.
pub fn bind(input: &BindInput) -> (Program, Vec<Diagnostic>) {
    let Bound { program, mut diagnostics, reviewed, .. } = bind_all(input);
    diagnostics.extend(reviewed);
    (program, diagnostics)
}

fn bind_all(input: &BindInput) -> Bound {
    let mut binder = Binder::new(input);
    binder.refuse_other_families();
    binder.collect();
    binder.bind_interfaces();
    let blocks = (0..binder.blocks.len()).map(|index| binder.bind_block(index)).collect::<Vec<_>>();
    let mut blocks: Vec<CodeBlock> = blocks.into_iter().flatten().collect();
    binder.check_program();
    let dbs = vec![binder.bind_data()];
    blocks.sort_by_key(CodeBlock::key);
    if input.require_main && !blocks.iter().any(|block| block.kind == BlockKind::Ob) {
        binder.no_main_block();
    }
    let mut test = TestSettings::default();
    if input.pragmas {
        for pragma in input.units.iter().flat_map(|(_, unit)| &unit.pragmas) {
            plcc_binding::pragma::file_pragma(&mut binder.report, pragma, &mut test);
        }
    }
    let program = Program {
        name: input.name.clone(),
        profile: input.profile.clone(),
        config: input.config.clone(),
        blocks,
        dbs,
        symbols: binder.symbol_entries(),
        notices: Vec::new(),
        test,
        s7200: Some(binder.row),
        partial: Vec::new(),
    };
    let (mut diagnostics, missing) = binder.report.finish();
    let mut reviewed = Vec::new();
    // What is wrong may be why a statement seems useless.
    if !diagnostics.iter().any(Diagnostic::is_error) {
        reviewed = review::review(&program.blocks);
        for list in [&mut diagnostics, &mut reviewed] {
            list.retain(|message| !plcc_binding::pragma::is_asserted(message, input.sources));
        }
    }
    Bound { program, diagnostics, reviewed, missing }
}

struct Binder<'a> {
    input: &'a BindInput<'a>,
    row: CpuRow,
    report: Report,
    /// In the order of the sources.
    blocks: Vec<names::Block<'a>>,
    /// By folded name.
    by_name: FxHashMap<String, usize>,
    by_number: FxHashMap<(BlockKind, u16), usize>,
    /// Rows of the symbol tables, by folded name.
    globals: FxHashMap<String, names::Global>,
    uses: whole::Uses,
    /// The operands whose addresses the current statement takes.
    addresses: Vec<plcc_model::s7200::Operand>,
}

impl<'a> Binder<'a> {
    fn new(input: &'a BindInput<'a>) -> Binder<'a> {
        Binder {
            input,
            row: profile::s7200::cpu_row(&input.profile),
            report: Report::new(input.partial),
            blocks: Vec::new(),
            by_name: FxHashMap::default(),
            by_number: FxHashMap::default(),
            globals: FxHashMap::default(),
            uses: whole::Uses::default(),
            addresses: Vec::new(),
        }
    }

    /// Blocks of other families cannot be part of the program.
    fn refuse_other_families(&mut self) {
        for (_, unit) in self.input.units.iter().filter(|(_, unit)| unit.s7200.is_none()) {
            if let Some(block) = unit.blocks.first() {
                self.report.push(
                    Diagnostic::new(Code::MixedFamilies, block.span(), "this block is not for the S7-200")
                        .label("the other sources are those of Micro/WIN")
                        .help("compile the programs of the two CPUs separately; they can communicate over the network"),
                );
            }
        }
    }

    fn bind_block(&mut self, index: usize) -> Option<CodeBlock> {
        let block = self.blocks.get(index)?;
        let (kind, number, name, span) = (block.kind, block.number, block.name.clone(), block.span);
        let body = self.bind_body(index)?;
        Some(CodeBlock {
            kind,
            number,
            name,
            span,
            library: false,
            interface: Interface::default(),
            temp_bytes: plcc_abi::s7200::LOCAL_BYTES,
            named_dbs: Vec::new(),
            body: Body::S7200(body),
        })
    }

    fn no_main_block(&mut self) {
        let span = match self.blocks.first() {
            Some(block) => block.span,
            None => Span { file: self.input.units.first().map_or(FileId(0), |(file, _)| *file), start: 0, end: 0 },
        };
        self.report.push(
            Diagnostic::new(Code::NoMainBlock, span, "the program has no main program OB 1 (0083)")
                .label("the CPU executes OB 1 in each scan; this program has none")
                .help("add it; among files without block headers, the one called `main` or `OB1` is the main program"),
        );
    }

    /// Symbols of the tables that have an address, for the flags of the executable.
    fn symbol_entries(&self) -> Vec<Symbol> {
        let mut entries: Vec<Symbol> = self
            .globals
            .values()
            .filter_map(|global| match &global.target {
                OperandKind::Direct(direct) => {
                    let (name, external) = (global.name.clone(), External::default());
                    Some(Symbol { name, address: address::text(*direct), ty: None, external })
                }
                _ => None,
            })
            .collect();
        entries.sort_by(|a, b| a.name.cmp(&b.name));
        entries
    }

    fn push(&mut self, diagnostic: Diagnostic) {
        self.report.push(diagnostic);
    }
}
