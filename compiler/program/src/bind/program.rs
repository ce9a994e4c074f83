//! The whole program: declarations first, then the blocks, each by the binder of its language.

use std::rc::Rc;

use plcc_abi::image::{BlockKind, Config};
use plcc_abi::names::External;
use plcc_abi::ob::ObClass;
use plcc_diag::{Code, Diagnostic, FileId, Severity, Span};
use plcc_syntax::Elementary;
use plcc_syntax::ast::{self, SectionKind};
use plcc_syntax::symbols::SymbolTarget;

use super::chart::ChartBinder;
use super::declarations::Declarations;
use super::declarations::block::CurrentBlock;
use super::declarations::interface::variables;
use super::declarations::path::Base;
use super::declarations::typed::{BoundInterface, Local};
use super::globals::Globals;
use super::globals::form::is_index;
use super::globals::names::{code_kind, kind_prefix};
use super::globals::sources::CodeSource;
use super::network::NetworkBinder;
use super::scl::SclBinder;
use super::stl::StlBinder;
use super::trees::SYSTEM_FILE;
use crate::bind::review::review;
use crate::bind::trees::blocks;
use plcc_binding::constant::Constant;
use plcc_binding::pragma::is_asserted;
use plcc_binding::{BindInput, Bound, fold};
use plcc_model::types::{DataType, Member};
use plcc_model::{BlockConstant, BlockKey, Body, CodeBlock, Interface, Parameter, Program, layout};

/// Binds a program. The program is complete if no message is an error and, with `partial`, nothing is undefined.
pub fn bind(input: &BindInput) -> (Program, Vec<Diagnostic>) {
    let Bound { program, mut diagnostics, reviewed, .. } = bind_all(input);
    diagnostics.extend(reviewed);
    (program, diagnostics)
}

/// Warns of calls in exports that give a parameter another type than the block has: they were made for another version of the block.
fn check_outlines(program: &mut Declarations) {
    let input = program.globals.input;
    for outline in input.units.iter().flat_map(|(_, unit)| &unit.outlines) {
        let ast::BlockName::Symbol { name, .. } = &outline.name else { continue };
        let Some(SymbolTarget::Block { prefix, number }) = program.globals.global(name) else { continue };
        let (Some(kind), Ok(number)) = (code_kind(prefix), u16::try_from(number)) else { continue };
        let key = BlockKey { kind, number };
        if !program.globals.sources.code.contains_key(&key) {
            continue;
        }
        let Some(bound) = program.interface(key, outline.span) else { continue };
        for variable in outline.sections.iter().flat_map(|section| &section.variables) {
            let ast::TypeKind::Named(word) = &variable.ty.kind else { continue };
            let of_name = |formal: &&Parameter| formal.name.eq_ignore_ascii_case(&variable.name);
            let Some(formal) = bound.interface.parameters.iter().find(of_name) else { continue };
            let (DataType::Elementary(own), Some(given)) = (&formal.ty, Elementary::from_word(&word.to_uppercase()))
            else {
                continue;
            };
            if *own == given {
                continue;
            }
            let block = program.globals.shown(key);
            let title = format!("`{}` of {block} is of type {}, not {}", formal.name, own.name(), given.name());
            let mut message = Diagnostic::new(Code::TypeMismatch, variable.ty.span, title)
                .label("the call was made for this type")
                .help("update the call in the TIA Portal and export the block again");
            message.severity = Severity::Warning;
            program.globals.report.push(message);
        }
    }
}

/// As [`bind`], with the names that are defined nowhere.
pub fn bind_all(input: &BindInput) -> Bound {
    let mut program = Declarations::new(input);
    program.globals.collect();
    program.globals.system_memory();
    program.globals.ob_classes();
    program.bind_types();
    program.bind_data();
    program.check_tag_types();
    let mut blocks = bind_user_blocks(&mut program);
    check_outlines(&mut program);
    let mains: Vec<BlockKey> =
        blocks.iter().filter(|block| is_main(input, &program.globals.config, block)).map(CodeBlock::key).collect();
    // What is wrong may be why a statement seems useless.
    let is_clean = !program.globals.report.diagnostics.iter().any(Diagnostic::is_error);
    let mut reviewed = if is_clean { review(&mut program, &blocks, &mains) } else { Vec::new() };
    bind_system_blocks(&mut program, &mut blocks);
    program.check_pointers();
    blocks.sort_by_key(CodeBlock::key);
    let config = std::mem::take(&mut program.globals.config);
    if input.require_main && !blocks.iter().any(|block| is_main(input, &config, block)) {
        no_main_block(&mut program);
    }
    let test = StlBinder::new(&mut program).file_pragmas();
    let mut dbs = std::mem::take(&mut program.data.blocks);
    let mut dbs: Vec<_> = dbs.drain().map(|(_, db)| db.block).collect();
    dbs.sort_by_key(|db| db.number);
    let symbols = program.symbols();
    let notices = std::mem::take(&mut program.globals.notices);
    program.globals.check_overlaps();
    let (mut diagnostics, missing) = program.globals.report.finish();
    if diagnostics.iter().any(Diagnostic::is_error) {
        reviewed.clear();
    }
    for list in [&mut diagnostics, &mut reviewed] {
        list.retain(|message| !is_asserted(message, input.sources));
        // A message inside a system block has no file to show.
        for diagnostic in list {
            if diagnostic.primary.span.file == SYSTEM_FILE {
                diagnostic.primary.span = Span::default();
            }
            diagnostic.secondary.retain(|label| label.span.file != SYSTEM_FILE);
        }
    }
    let bound = Program {
        name: input.name.clone(),
        profile: input.profile.clone(),
        config,
        blocks,
        dbs,
        symbols,
        notices,
        test,
        s7200: None,
        partial: Vec::new(),
    };
    Bound { program: bound, diagnostics, reviewed, missing }
}

/// True of the block that the CPU calls in each cycle.
pub fn is_main(input: &BindInput, config: &Config, block: &CodeBlock) -> bool {
    match block.kind {
        BlockKind::Ob if input.profile.family.is_portal() => {
            config.class_of(block.number) == Some(ObClass::ProgramCycle)
        }
        kind => kind == BlockKind::Ob && block.number == 1,
    }
}

fn bind_user_blocks(program: &mut Declarations) -> Vec<CodeBlock> {
    let mut keys: Vec<BlockKey> = program
        .globals
        .sources
        .code
        .iter()
        .filter(|(_, source)| !matches!(source, CodeSource::System(_)))
        .map(|(key, _)| *key)
        .collect();
    keys.sort_unstable();
    for &key in &keys {
        let span = program.globals.sources.code[&key].block().name.span();
        program.interface(key, span);
    }
    keys.into_iter().filter_map(|key| bind_block(program, key, None, false)).collect()
}

/// System blocks that are used, and those that they use.
pub fn bind_system_blocks(program: &mut Declarations, blocks: &mut Vec<CodeBlock>) {
    let mut next = 0;
    while let Some(used) = program.globals.library.used.get(next) {
        let (key, span, runtime) = (used.key, used.span, used.runtime);
        next += 1;
        let told = program.globals.report.diagnostics.len();
        blocks.extend(bind_block(program, key, Some(span), runtime));
        if program.globals.is_instruction(key) {
            refuse_types(program, key, told, span);
        }
    }
}

/// What is wrong in the function that computes a call of an instruction, after the first `told` messages, is one message about the call:
/// the instruction does not take values of these types.
fn refuse_types(program: &mut Declarations, key: BlockKey, told: usize, span: Span) {
    let messages = program.globals.report.diagnostics.split_off(told);
    let (inside, others): (Vec<_>, Vec<_>) =
        messages.into_iter().partition(|message| message.primary.span.file == SYSTEM_FILE);
    program.globals.report.diagnostics.extend(others);
    if inside.is_empty() {
        return;
    }
    let Some(bound) = program.interface(key, span) else { return };
    let parameters = bound.interface.parameters.iter().filter(|parameter| !is_index(&parameter.name));
    let types: Vec<String> =
        parameters.map(|parameter| format!("{} is {}", parameter.name, layout::type_name(&parameter.ty))).collect();
    let title = format!("{} does not take these types", program.globals.shown(key));
    program.report(Diagnostic::new(Code::TypeMismatch, span, title).label(types.join(", ")));
}

fn bind_block(program: &mut Declarations, key: BlockKey, fixed_span: Option<Span>, runtime: bool) -> Option<CodeBlock> {
    let source = program.globals.sources.code.get(&key)?.clone();
    let block = source.block();
    let span = block.name.span();
    let bound = program.interface(key, fixed_span.unwrap_or(span))?;
    let mut current = CurrentBlock::new(key, Rc::clone(&bound));
    current.fragment = fixed_span.is_none() && blocks::is_fragment(block);
    current.fixed_span = fixed_span;
    // What a section declares that the block cannot have is reported there, and not again at its uses.
    if matches!(key.kind, BlockKind::Ob | BlockKind::Fc | BlockKind::Sfc) {
        let refused = variables(block, SectionKind::Static).map(|variable| fold(&variable.name));
        current.unknown_locals.extend(refused);
    }
    let body = if runtime { Body::Runtime } else { bind_code(program, &mut current, block) };
    let name = match program.globals.names.block_name(kind_prefix(key.kind), key.number) {
        name if name.is_empty() => match &block.header.name {
            Some(name) if fixed_span.is_some() => name.trim().to_string(),
            _ => String::new(),
        },
        name => name,
    };
    let temporaries = if fixed_span.is_some() { Vec::new() } else { temporaries(&bound) };
    let constants = if fixed_span.is_some() { Vec::new() } else { constants(block, &bound) };
    Some(CodeBlock {
        kind: key.kind,
        number: key.number,
        name,
        span: fixed_span.unwrap_or(span),
        library: fixed_span.is_some(),
        interface: Interface { temporaries, constants, ..bound.interface.clone() },
        temp_bytes: bound.temp_bytes.max(current.local_bytes.next_multiple_of(2)),
        named_dbs: current.named_dbs,
        body,
    })
}

/// The TEMP variables of a block, views of them included, in the order of their addresses.
fn temporaries(bound: &BoundInterface) -> Vec<Member> {
    let locals = bound.locals.values().filter(|local| matches!(local.base, Base::L));
    let member = |local: &Local| Member {
        name: local.name.clone(),
        ty: local.ty.clone(),
        byte: local.byte,
        bit: local.bit,
        external: External::default(),
    };
    let mut members: Vec<Member> = locals.map(member).collect();
    members.sort_by(|a, b| (a.byte, a.bit, &a.name).cmp(&(b.byte, b.bit, &b.name)));
    members
}

/// The constants of a block that have one value; those without a type have the one that fits.
fn constants(block: &ast::CodeBlock, bound: &BoundInterface) -> Vec<BlockConstant> {
    let constants = block.constants.iter().filter_map(|constant| {
        let (ty, bits) = match bound.constants.get(&fold(&constant.name))? {
            Constant::Typed { ty, bits } => (*ty, *bits),
            Constant::Integer { value, .. } => {
                (Elementary::Dint, u64::from(i32::try_from(*value).ok()?.cast_unsigned()))
            }
            Constant::Real(value) => (Elementary::Real, u64::from((*value as f32).to_bits())),
            Constant::Text { .. } | Constant::WideText(_) | Constant::DateAndTime(_) | Constant::Dtl(_) => return None,
        };
        Some(BlockConstant { name: constant.name.clone(), ty, bits })
    });
    constants.collect()
}

/// Each language binds its own blocks.
fn bind_code(program: &mut Declarations, current: &mut CurrentBlock, block: &ast::CodeBlock) -> Body {
    match &block.code {
        ast::Code::Stl(_) => Body::Stl(StlBinder::new(program).bind_block(current, block)),
        ast::Code::Scl(body) => Body::Scl(SclBinder::new(program).bind_block(current, block, body)),
        ast::Code::Graphic(body) => Body::Scl(NetworkBinder::new(program).bind_block(current, block, body)),
        ast::Code::Chart(body) => Body::Scl(ChartBinder::new(program).bind_block(current, block, body)),
    }
}

/// Whether a block is a PROGRAM of another language, which the parser has reported.
fn has_program(globals: &Globals) -> bool {
    const WORD: &[u8] = b"PROGRAM";
    globals.input.units.iter().flat_map(|(_, unit)| &unit.blocks).any(|block| {
        let ast::Block::Code(code) = block else { return false };
        let span = code.name.span();
        let source = globals.input.sources.files().nth(span.file.0 as usize);
        let before = source.and_then(|(_, source)| source.text.get(..span.start as usize));
        let word = before.map(|text| text.trim_end().as_bytes()).and_then(|text| text.rchunks(WORD.len()).next());
        word.is_some_and(|word| word.eq_ignore_ascii_case(WORD))
    })
}

fn no_main_block(program: &mut Declarations) {
    // A text without any block is not a source, which the parser has reported.
    let is_code = |line: &str| !line.trim().is_empty() && !line.trim_start().starts_with("//");
    let unread = program.globals.input.units.iter().any(|(file, unit)| {
        let source = program.globals.input.sources.files().nth(file.0 as usize);
        unit.blocks.is_empty() && source.is_some_and(|(_, source)| source.text.lines().any(is_code))
    });
    if unread || has_program(&program.globals) {
        return;
    }
    let first = program.globals.input.units.iter().flat_map(|(_, unit)| &unit.blocks).next();
    let span = match first {
        Some(ast::Block::Code(code)) => code.name.span(),
        Some(ast::Block::Data(data)) => data.name.span(),
        Some(ast::Block::Type(ty)) => ty.name.span(),
        None => {
            Span { file: program.globals.input.units.first().map_or(FileId(0), |(file, _)| *file), start: 0, end: 0 }
        }
    };
    program.report(
        Diagnostic::new(Code::NoMainBlock, span, "the program has no OB 1")
            .label("the CPU calls OB 1 in each cycle; this program has none")
            .help("add an ORGANIZATION_BLOCK OB 1 that calls the other blocks"),
    );
}
