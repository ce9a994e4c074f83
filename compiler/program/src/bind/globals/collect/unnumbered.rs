//! Numbers for blocks that are written with a name only.

use plcc_abi::ob::{OB_FREE, ObClass};
use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_syntax::ast::{self, BlockPrefix};
use plcc_syntax::scl::ast::Dialect;
use rustc_hash::{FxHashMap, FxHashSet};

use super::own_global;
use crate::bind::globals::Globals;
use crate::bind::globals::ob::unknown_class;
use crate::bind::trees::blocks::{block_class, class_attribute, class_of_inputs, dialect};
use crate::bind::trees::mentions;
use crate::bind::trees::numbering::{LOOSE, LOOSE_HELP, frame, is_loose};

/// A block that is written with a name and without a number.
pub(super) struct Unnumbered<'a> {
    pub(super) block: &'a ast::Block,
    pub(super) prefix: BlockPrefix,
    pub(super) name: String,
    pub(super) span: Span,
    /// OB: what starts it.
    pub(super) class: Option<ObClass>,
}

impl<'a> Globals<'a> {
    /// Defines blocks without numbers: they get free ones.
    pub(super) fn define_unnumbered(
        &mut self,
        blocks: &[&'a ast::Block],
        unnumbered: Vec<Unnumbered<'a>>,
        used: &mut FxHashSet<(BlockPrefix, u32)>,
    ) {
        if !unnumbered.is_empty() {
            used.extend(blocks.iter().flat_map(|block| mentions::numbers(block)));
        }
        let lonely = blocks.iter().filter(|block| frame(block).0 == BlockPrefix::Ob).count() == 1;
        let mut next: FxHashMap<BlockPrefix, u32> = FxHashMap::default();
        for Unnumbered { block, prefix, name, span, class } in unnumbered {
            if prefix == BlockPrefix::Db {
                self.report.unnumbered_dbs.push(name.clone());
            }
            let class = match class {
                None if prefix == BlockPrefix::Ob && (!lonely || used.contains(&(BlockPrefix::Ob, 1))) => {
                    match self.unsaid_class(block, &name, span, used) {
                        Some(class) => Some(class),
                        None => continue,
                    }
                }
                class => class,
            };
            if let Some(global) = own_global(&self.names.symbols, prefix, &name) {
                // Two blocks with one name: the second would replace the first.
                let first = global.span;
                let help = self.choice(first, span, "give one of them another name");
                self.report.push(
                    Diagnostic::new(Code::DuplicateBlock, span, format!("`{name}` is defined twice"))
                        .label("the second definition")
                        .also(first, "the first definition")
                        .help(help),
                );
                continue;
            }
            let Some(number) = free_number(&mut next, used, prefix, class) else { continue };
            let is_main = class == Some(ObClass::ProgramCycle) && name.eq_ignore_ascii_case("Main");
            if is_main && used.contains(&(prefix, 1)) && block_class(block).is_none() {
                self.main_beside_ob_1(blocks, &name, number, span);
            }
            used.insert((prefix, number.into()));
            if let Some(class) = class
                && number >= OB_FREE
                && block_class(block).is_none()
            {
                self.config.ob_classes.push((number, class));
            }
            self.name_block(&name, prefix, number.into(), span);
            self.define(block, prefix, number, span);
        }
    }

    /// Warns of a `Main` that is not OB 1, because there is another one.
    fn main_beside_ob_1(&mut self, blocks: &[&ast::Block], name: &str, number: u16, span: Span) {
        let title = format!("`{name}` is OB {number} here, because the sources have an OB 1 too");
        let message = Diagnostic::new(Code::DuplicateBlock, span, title).label("both blocks run in each cycle");
        let mut names = blocks.iter().map(|block| frame(block)).map(|(prefix, name)| (prefix, name.span()));
        let mut message = match names.find(|(prefix, name)| is_loose(*prefix, *name)) {
            Some((_, statements)) => message.also(statements, LOOSE).help(LOOSE_HELP),
            None => message.help(
                "`Main` is the usual name of OB 1: if they are one block remove one of them, else give this one another name",
            ),
        };
        message.severity = Severity::Warning;
        self.report.push(message);
    }

    /// What starts an OB that does not state its class. In sources of the TIA Portal its inputs show it; if they do not, it is a program cycle
    /// OB. `None`: it is in another source, where its number is unknown, or it states a class that does not exist; both are reported.
    fn unsaid_class(
        &mut self,
        block: &ast::Block,
        name: &str,
        span: Span,
        used: &FxHashSet<(BlockPrefix, u32)>,
    ) -> Option<ObClass> {
        if !self.input.partial
            && let ast::Block::Code(code) = block
            && let Some((None, text)) = class_attribute(&code.header)
        {
            self.report.push(unknown_class(text, span).label("it is not known what starts it"));
            return None;
        }
        let message = Diagnostic::new(
            Code::BlockFrame,
            span,
            format!("the number of the organization block `{name}` is unknown"),
        )
        .help("write `ORGANIZATION_BLOCK OB 35`, or give the name its number in the symbol table");
        let tia = match block {
            ast::Block::Code(code) => dialect(code).map_or(self.sources.tia, |of| of == Dialect::Tia),
            ast::Block::Data(_) | ast::Block::Type(_) => false,
        };
        if !tia && self.input.partial {
            self.report.push(
                Diagnostic::new(Code::LeftOut, span, format!("the organization block `{name}` is left out"))
                    .label("the CPU finds an organization block by its number, which no source states")
                    .help("give the name its number in a symbol table, or write `ORGANIZATION_BLOCK OB 35`"),
            );
            return None;
        }
        if !tia {
            self.report.push(message.label("the CPU finds an organization block by its number"));
            return None;
        }
        // A class without free numbers has one block.
        let has_number = |class: &ObClass| {
            let row = class.row();
            row.free || !used.contains(&(BlockPrefix::Ob, u32::from(row.numbers.0)))
        };
        if let Some(class) = class_of_inputs(block).filter(has_number) {
            return Some(class);
        }
        let mut message = message.label("treated as a program cycle OB, as the TIA Portal does").help(
            "state what starts it: `{ S7_EventClass := 'CyclicInterrupt' }`, or give its number in the symbol table",
        );
        message.severity = Severity::Warning;
        self.report.push(message);
        Some(ObClass::ProgramCycle)
    }
}

/// The next number that no block of the kind has; `None`: there is none. An OB with only a known class gets the usual number of the class.
fn free_number(
    next: &mut FxHashMap<BlockPrefix, u32>,
    used: &FxHashSet<(BlockPrefix, u32)>,
    prefix: BlockPrefix,
    class: Option<ObClass>,
) -> Option<u16> {
    let number = next.entry(prefix).or_insert(1);
    if let Some(class) = class {
        let (first, last) = class.row().numbers;
        // OB 101 and 102 start differently.
        let last = if class == ObClass::Startup { first } else { last };
        let usual = (first..=last).map(u32::from).find(|number| !used.contains(&(prefix, *number)));
        *number = usual.unwrap_or(u32::from(OB_FREE));
    }
    while used.contains(&(prefix, *number)) {
        *number += 1;
    }
    u16::try_from(*number).ok()
}
