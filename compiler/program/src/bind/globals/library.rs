//! Blocks of the standard library: which names and numbers mean them, and how they become part of the program.
//!
//! SFCs and SFBs belong to the CPU. FCs and FBs of libraries have the numbers of STEP 7 V5, and a block of the program always has
//! priority: an FC or FB that no source defines is taken from the library if its symbol is a standard name, or if it has no symbol and
//! its number is a standard one. If the program has its own block with the number of a library block, the latter is only found by its
//! name and has another number in the compiled program.

use std::rc::Rc;

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_stdlib::{BlockClass, Form, Language, SystemBlock};
use plcc_syntax::ast::{self, BlockPrefix};
use plcc_syntax::{ParseOptions, scl, stl};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::bind::globals::Globals;
use crate::bind::globals::names::kind_prefix;
use crate::bind::globals::sources::CodeSource;
use crate::bind::trees::{SYSTEM_FILE, mentions};
use plcc_binding::fold;
use plcc_model::{BlockKey, Parameter};

/// The first number of SFCs that are written for calls in STL; those of the library are below.
const WRITTEN_NUMBERS: u16 = 60_000;

/// A system block that is used.
pub struct SystemUse {
    pub key: BlockKey,
    /// The first use, which messages show instead of its statements.
    pub span: Span,
    pub runtime: bool,
}

/// Which blocks of the library the program uses, and which numbers they have in it.
#[derive(Default)]
pub struct Library {
    pub used: Vec<SystemUse>,
    /// Keys of `used`.
    pub known: FxHashSet<BlockKey>,
    /// Blocks whose numbers the program uses for its own, by their new numbers.
    pub moved: FxHashMap<BlockKey, &'static SystemBlock>,
    /// The instructions of the functions for calls in STL, from [`WRITTEN_NUMBERS`] on.
    written: Vec<&'static str>,
    /// These functions by their sources.
    written_keys: FxHashMap<String, BlockKey>,
    /// Blocks whose numbers or names mean missing blocks of the program: their calls have other parameters.
    pub foreign: FxHashSet<(BlockClass, u16)>,
}

impl Library {
    /// Whether the program means its own block with the name and number of this one: see [`Globals::find_foreign`].
    pub fn is_foreign(&self, block: &SystemBlock) -> bool {
        self.foreign.contains(&(block.class, block.number))
    }

    /// The instruction for whose calls in STL the block is.
    fn instruction(&self, key: BlockKey) -> Option<&'static str> {
        let at = key.number.checked_sub(WRITTEN_NUMBERS).filter(|_| key.kind == BlockKind::Sfc)?;
        self.written.get(usize::from(at)).copied()
    }

    /// Kind and number of a library block in this program.
    pub fn key_of(&self, block: &SystemBlock) -> BlockKey {
        let moved = self.moved.iter().find(|(_, other)| (other.class, other.number) == (block.class, block.number));
        match moved {
            Some((key, _)) => *key,
            None => BlockKey { kind: kind_of(block.class), number: block.number },
        }
    }
}

const fn class_of(kind: BlockKind) -> Option<BlockClass> {
    match kind {
        BlockKind::Fc => Some(BlockClass::Fc),
        BlockKind::Fb => Some(BlockClass::Fb),
        BlockKind::Sfc => Some(BlockClass::Sfc),
        BlockKind::Sfb => Some(BlockClass::Sfb),
        BlockKind::Ob | BlockKind::Db | BlockKind::Sbr | BlockKind::Int => None,
    }
}

const fn kind_of(class: BlockClass) -> BlockKind {
    match class {
        BlockClass::Fc => BlockKind::Fc,
        BlockClass::Fb => BlockKind::Fb,
        BlockClass::Sfc => BlockKind::Sfc,
        BlockClass::Sfb => BlockKind::Sfb,
    }
}

impl Globals<'_> {
    /// Gives library blocks other numbers if the program uses theirs for its own blocks. `used`: numbers that are taken.
    pub fn move_library(&mut self, used: &FxHashSet<(BlockPrefix, u32)>) {
        let mut free = u32::from(u16::MAX);
        for block in plcc_stdlib::blocks() {
            let kind = kind_of(block.class);
            let prefix = kind_prefix(kind);
            let taken = self.names.defined.contains_key(&(prefix, block.number))
                || self
                    .names
                    .blocks
                    .get(&(prefix, block.number))
                    .is_some_and(|name| fold(plcc_stdlib::standard_name(name)) != fold(block.name));
            if matches!(block.class, BlockClass::Sfc | BlockClass::Sfb) || !taken {
                continue;
            }
            while used.contains(&(prefix, free)) && free > 0 {
                free -= 1;
            }
            self.library.moved.insert(BlockKey { kind, number: free as u16 }, block);
            free = free.saturating_sub(1);
        }
    }

    /// With `partial`: finds library blocks that the program does not mean, because it calls them with other parameters.
    pub fn find_foreign(&mut self) {
        if !self.input.partial {
            return;
        }
        let mut calls = Vec::new();
        for block in self.input.units.iter().flat_map(|(_, unit)| &unit.blocks) {
            if let ast::Block::Code(code) = block {
                mentions::calls_of_blocks(&code.code, &mut calls);
            }
        }
        let mut known: FxHashMap<(BlockClass, u16), Vec<(String, bool)>> = FxHashMap::default();
        for call in calls {
            let block = match call.target {
                mentions::Called::Number(prefix, number) => {
                    let class = match prefix {
                        BlockPrefix::Fc => BlockClass::Fc,
                        BlockPrefix::Fb => BlockClass::Fb,
                        _ => continue,
                    };
                    let Ok(number) = u16::try_from(number) else { continue };
                    self.library_block(BlockKey { kind: kind_of(class), number })
                }
                mentions::Called::Name(name) => match self.global(&name) {
                    Some(plcc_syntax::symbols::SymbolTarget::Block { prefix, number }) => {
                        crate::bind::globals::names::code_kind(prefix)
                            .zip(u16::try_from(number).ok())
                            .and_then(|(kind, number)| self.library_block(BlockKey { kind, number }))
                    }
                    _ => None,
                },
            };
            let Some(block) = block.filter(|block| {
                matches!(block.class, BlockClass::Fc | BlockClass::Fb) && block.form != Form::NotShipped
            }) else {
                continue;
            };
            let formals = known.entry((block.class, block.number)).or_insert_with(|| parameters(block));
            let fits = |name: &String| {
                let folded = fold(name);
                formals.iter().any(|(known, _)| *known == folded) || matches!(folded.as_str(), "en" | "eno" | "ret_val")
            };
            // A function needs all its inputs.
            let given = |formal: &str| call.formals.iter().any(|name| fold(name) == formal);
            let lacks = block.class == BlockClass::Fc
                && !call.by_place
                && formals.iter().any(|(formal, input)| *input && !given(formal));
            if lacks || !call.formals.iter().all(fits) {
                self.library.foreign.insert((block.class, block.number));
            }
        }
    }

    /// True of a parameter that a timer has only because all timers share a layout: no call supplies it.
    pub fn is_shared_input(&self, key: BlockKey, name: &str) -> bool {
        self.library_block(key).is_some_and(|block| plcc_stdlib::is_shared_input(block, name))
    }

    /// The library block for `key`, if the program itself does not define it.
    pub fn library_block(&self, key: BlockKey) -> Option<&'static SystemBlock> {
        let class = class_of(key.kind)?;
        if self.library.foreign.contains(&(class, key.number)) {
            return None;
        }
        if matches!(self.sources.code.get(&key), Some(CodeSource::User(_) | CodeSource::Expanded(_))) {
            return None;
        }
        if let Some(block) = self.library.moved.get(&key) {
            return Some(block);
        }
        let name = self.names.block_name(kind_prefix(key.kind), key.number);
        match class {
            BlockClass::Fc | BlockClass::Fb if !name.is_empty() => plcc_stdlib::blocks().iter().find(|block| {
                block.class == class && block.name.eq_ignore_ascii_case(plcc_stdlib::standard_name(&name))
            }),
            _ => plcc_stdlib::find(class, key.number),
        }
    }

    /// True if a block can only come from the library; it may be missing there. Stubs stand in for some.
    pub fn in_library(&self, key: BlockKey) -> bool {
        let is_own = matches!(self.sources.code.get(&key), Some(CodeSource::User(_) | CodeSource::Expanded(_)));
        !is_own && matches!(key.kind, BlockKind::Sfc | BlockKind::Sfb) || self.library_block(key).is_some()
    }

    /// A block called by prefix and number. Instructions of the TIA Portal have no number.
    pub fn numbered_block(&mut self, prefix: BlockPrefix, number: u16, span: Span) -> Option<(BlockPrefix, u16)> {
        let system = matches!(prefix, BlockPrefix::Sfc | BlockPrefix::Sfb);
        if system && number >= plcc_stdlib::TIA_NUMBERS && span.file != SYSTEM_FILE {
            self.report.missing_block(prefix, number, span);
            return None;
        }
        // A library block means those of the library.
        let class = match prefix {
            BlockPrefix::Fc if span.file == SYSTEM_FILE => BlockClass::Fc,
            BlockPrefix::Fb if span.file == SYSTEM_FILE => BlockClass::Fb,
            _ => return Some((prefix, number)),
        };
        let number = plcc_stdlib::find(class, number).map_or(number, |block| self.library.key_of(block).number);
        Some((prefix, number))
    }

    /// A block as its author knows it: by its symbol, and a block of the CPU or of a library by its number, too, if it has one.
    pub fn shown(&self, key: BlockKey) -> String {
        if let Some(instruction) = self.library.instruction(key) {
            return format!("`{instruction}`");
        }
        let library = self.library_block(key).map(|block| block.name.to_string());
        let own = self.names.block_name(kind_prefix(key.kind), key.number);
        let system = matches!(key.kind, BlockKind::Sfc | BlockKind::Sfb);
        match library {
            Some(name) if system && key.number >= plcc_stdlib::TIA_NUMBERS => format!("`{name}`"),
            // Its number is that of a block of the program, so it has another, which nobody wrote.
            Some(name) if self.library.moved.contains_key(&key) => format!("`{name}`"),
            Some(name) => format!("`{name}` ({key})"),
            None if own.is_empty() => key.to_string(),
            None => format!("`{own}`"),
        }
    }

    /// The help, plus a note that a block came from the library if the program may mean its own.
    pub fn with_library_note(&self, key: BlockKey, help: String) -> String {
        let by_number = matches!(key.kind, BlockKind::Fc | BlockKind::Fb) && !self.library.moved.contains_key(&key);
        match self.library_block(key).filter(|_| by_number) {
            Some(block) => {
                format!("{help}; no source defines {key}, so it is `{}` of the standard library", block.name)
            }
            None => help,
        }
    }

    /// Whether a call of `key` cannot mean the library block: part of a program (`partial`) calls its own block with the same name or
    /// number, but other parameters, or any program calls a block by its number and gives it not one parameter of the library block. The
    /// block is then noted as missing. `names`: the parameters of the call.
    pub fn is_own_of_program<'n>(
        &mut self,
        key: BlockKey,
        parameters: &[Parameter],
        names: impl IntoIterator<Item = &'n str>,
        span: Span,
    ) -> bool {
        let system = matches!(key.kind, BlockKind::Sfc | BlockKind::Sfb);
        let Some(block) = self.library_block(key).filter(|_| span.file != SYSTEM_FILE) else { return false };
        let known = |name: &str| {
            let folded = fold(name);
            matches!(folded.as_str(), "en" | "eno")
                || parameters.iter().any(|parameter| fold(&parameter.name) == folded)
        };
        let (mut any_known, mut all_known) = (false, true);
        for name in names {
            let known = known(name);
            any_known |= known;
            all_known &= known;
        }
        let text = self.text(span);
        let name = text.trim_matches('"').to_string();
        let by_number = !system && fold(&name) != fold(block.name);
        if all_known || !self.input.partial && (any_known || !by_number) {
            return false;
        }
        match fold(&name) == fold(block.name) {
            true => self.report.missing_own(&name, span),
            false if system => return false,
            false => self.report.missing_block(kind_prefix(key.kind), key.number, span),
        }
        true
    }

    /// A function in SCL for calls of an instruction in STL. Calls with the same source share it; `None` after a message.
    pub fn write_function(&mut self, instruction: &'static str, source: String, span: Span) -> Option<BlockKey> {
        if let Some(key) = self.library.written_keys.get(&source) {
            return Some(*key);
        }
        let Some(number) = written_number(self.library.written.len()) else {
            let title = "the program calls instructions in STL for too many combinations of types";
            if !self.report.diagnostics.iter().any(|known| known.title == title) {
                self.report.push(
                    Diagnostic::new(Code::NotShipped, span, title)
                        .label(format!("the first one after {}", self.library.written.len()))
                        .help("write functions in SCL that call the instructions, and call these functions"),
                );
            }
            return None;
        };
        let key = BlockKey { kind: BlockKind::Sfc, number };
        let code = parsed(Language::Scl, &source);
        self.library.known.insert(key);
        self.sources.code.insert(key, CodeSource::System(Rc::new(code)));
        self.library.used.push(SystemUse { key, span, runtime: false });
        self.library.written.push(instruction);
        self.library.written_keys.insert(source, key);
        Some(key)
    }

    /// Whether a block is a function for calls of an instruction in STL.
    pub fn is_instruction(&self, key: BlockKey) -> bool {
        self.library.instruction(key).is_some()
    }

    /// Notes the use of a library block; false if it does not exist, which is reported.
    pub fn use_system(&mut self, key: BlockKey, span: Span) -> bool {
        if self.library.known.contains(&key) {
            return true;
        }
        let prefix = kind_prefix(key.kind);
        let Some(block) = self.library_block(key) else {
            self.report.missing_block(prefix, key.number, span);
            return false;
        };
        if block.form == Form::NotShipped {
            self.report.not_shipped(prefix, key.number, block.name, span);
            // Instances have their layout, so the rest of the program can be checked.
            if block.class != BlockClass::Sfb || self.input.partial {
                return false;
            }
        }
        let code = parsed(block.language, block.source);
        // Blocks that a library block uses also have a position in the program.
        let span = match self.library.used.last() {
            Some(last) if span.file == SYSTEM_FILE => last.span,
            _ => span,
        };
        self.library.known.insert(key);
        self.sources.code.insert(key, CodeSource::System(Rc::new(code)));
        self.library.used.push(SystemUse { key, span, runtime: block.form == Form::Runtime });
        true
    }
}

/// The number of the function that is written after `count` others; none: there are too many.
fn written_number(count: usize) -> Option<u16> {
    WRITTEN_NUMBERS.checked_add(u16::try_from(count).ok()?)
}

/// Folded names of the parameters of a block of the library, and which of them are read.
fn parameters(block: &SystemBlock) -> Vec<(String, bool)> {
    if block.form == Form::NotShipped {
        return Vec::new();
    }
    let code = parsed(block.language, block.source);
    let is_parameter = |section: &&ast::Section| {
        matches!(section.kind, ast::SectionKind::Input | ast::SectionKind::Output | ast::SectionKind::InOut)
    };
    let named = |section: &ast::Section| -> Vec<(String, bool)> {
        let input = section.kind != ast::SectionKind::Output;
        section.variables.iter().map(|variable| (fold(&variable.name), input)).collect()
    };
    code.sections.iter().filter(is_parameter).flat_map(named).collect()
}

/// The syntax tree of a block of the library.
pub fn parsed(language: Language, source: &str) -> ast::CodeBlock {
    let options = ParseOptions { mnemonics: Some(stl::Mnemonics::En), ..ParseOptions::default() };
    let (unit, _) = match language {
        Language::Stl => stl::parse(SYSTEM_FILE, source, &options),
        Language::Scl => scl::parse(SYSTEM_FILE, source, &options),
    };
    let code = unit.blocks.into_iter().find_map(|block| match block {
        ast::Block::Code(code) => Some(code),
        ast::Block::Data(_) | ast::Block::Type(_) => None,
    });
    code.expect("each source of the standard library has one block, as its tests check")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_written_functions_end() {
        assert_eq!(written_number(0), Some(WRITTEN_NUMBERS));
        assert_eq!(written_number(usize::from(u16::MAX - WRITTEN_NUMBERS)), Some(u16::MAX));
        assert_eq!(written_number(usize::from(u16::MAX - WRITTEN_NUMBERS) + 1), None);
        assert_eq!(written_number(usize::MAX), None);
    }
}
