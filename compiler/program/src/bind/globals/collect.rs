//! Reads the tables and numbers the blocks of all sources, so that their order does not matter.

mod tables;
mod unnumbered;

use plcc_abi::ob::ObClass;
use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_syntax::article::with_article;
use plcc_syntax::ast::{self, BlockName, BlockPrefix, CodeKind};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::bind::globals::Globals;
use crate::bind::globals::names::{Global, code_kind};
use crate::bind::trees::blocks::{block_class, header_of, is_forward, is_fragment, is_safety};
use crate::bind::trees::numbering::{LOOSE, LOOSE_HELP, block_of_file, frame, is_loose, numbered, source_prefix};
use plcc_binding::fold;
use plcc_model::BlockKey;
use plcc_syntax::symbols::{External, SymbolTarget};
use unnumbered::Unnumbered;

/// A global symbol of the block's kind. A data type may have the name of a block of another kind.
fn own_global<'g>(globals: &'g FxHashMap<String, Global>, prefix: BlockPrefix, name: &str) -> Option<&'g Global> {
    let global = globals.get(&fold(name))?;
    match global.target {
        SymbolTarget::Block { prefix: named, .. } if share_name(prefix, named) => None,
        _ => Some(global),
    }
}

/// Whether blocks of these kinds may share a name, because the context distinguishes them: a data type and a block that is not one.
fn share_name(one: BlockPrefix, other: BlockPrefix) -> bool {
    let is_type = |prefix| matches!(prefix, BlockPrefix::Udt | BlockPrefix::Fb | BlockPrefix::Sfb);
    one != other && (one == BlockPrefix::Udt) != (other == BlockPrefix::Udt) && !(is_type(one) && is_type(other))
}

impl<'a> Globals<'a> {
    /// Reads the symbol tables and assigns a number to every block of the sources.
    pub fn collect(&mut self) {
        self.collect_tables();
        self.collect_constants();
        let blocks = self.without_forwards();
        self.safety_blocks(&blocks);
        let mut used: FxHashSet<(BlockPrefix, u32)> = FxHashSet::default();
        for global in self.names.symbols.values() {
            if let SymbolTarget::Block { prefix, number } = global.target {
                used.insert((prefix, number));
            }
        }
        let unnumbered = self.define_numbered(&blocks, &mut used);
        self.define_unnumbered(&blocks, unnumbered, &mut used);
        for global in self.names.symbols.values() {
            if let SymbolTarget::Block { prefix, number } = global.target
                && number <= 65_535
            {
                self.names.blocks.insert((prefix, number as u16), global.name.clone());
            }
        }
        self.constants_named_as_others();
        self.find_foreign();
        self.move_library(&used);
    }

    /// Defines the blocks that have numbers. Result: the others.
    fn define_numbered(
        &mut self,
        blocks: &[&'a ast::Block],
        used: &mut FxHashSet<(BlockPrefix, u32)>,
    ) -> Vec<Unnumbered<'a>> {
        let mut unnumbered = Vec::new();
        // Blocks whose numbers may change get the free ones.
        for movable in [false, true] {
            for &block in blocks {
                let (prefix, name) = frame(block);
                let (prefix, (numbered, is_movable)) = match self.named_by_file(block) {
                    Some((prefix, number)) => {
                        (prefix, (BlockName::Numbered { prefix, number, span: name.span() }, false))
                    }
                    None => (prefix, self.numbered(block, prefix, name)),
                };
                if is_movable == movable {
                    self.place(block, (prefix, numbered), movable, used, &mut unnumbered);
                }
            }
        }
        unnumbered
    }

    /// The blocks of the sources; a block without a body that has one elsewhere is dropped.
    fn without_forwards(&mut self) -> Vec<&'a ast::Block> {
        let blocks: Vec<&'a ast::Block> = self.input.units.iter().flat_map(|(_, unit)| &unit.blocks).collect();
        let key = |block: &ast::Block| {
            let (prefix, name) = frame(block);
            match name {
                BlockName::Numbered { number, .. } => (prefix, Some(*number), String::new()),
                BlockName::Symbol { name, .. } => (prefix, None, fold(name)),
            }
        };
        let mut bodies: FxHashMap<_, Span> = FxHashMap::default();
        for block in blocks.iter().filter(|block| !is_forward(block)) {
            bodies.entry(key(block)).or_insert(frame(block).1.span());
        }
        let mut kept = Vec::with_capacity(blocks.len());
        for block in blocks {
            match bodies.get(&key(block)).filter(|_| is_forward(block)) {
                Some(body) => {
                    let span = frame(block).1.span();
                    let name = self.text(span);
                    let mut message = Diagnostic::new(Code::DuplicateBlock, span, format!("{name} has no body here"))
                        .label("this one is dropped")
                        .also(*body, "the definition that is used")
                        .help("remove the empty one");
                    message.severity = Severity::Warning;
                    self.report.push(message);
                }
                None => kept.push(block),
            }
        }
        kept
    }

    /// Blocks of a safety program: refused, or compiled as standard blocks if requested.
    fn safety_blocks(&mut self, blocks: &[&ast::Block]) {
        let names = blocks.iter().filter(|block| is_safety(header_of(block))).map(|block| frame(block).1);
        let spans: Vec<Span> = names.map(BlockName::span).collect();
        let Some(&first) = spans.first() else { return };
        let name = self.text(first);
        let name = name.trim_matches('"');
        let count = spans.len();
        let what = match count {
            1 => format!("`{name}` is a block of a safety program"),
            _ => format!("{count} blocks belong to a safety program, the first is `{name}`"),
        };
        if !self.input.safety_as_standard {
            self.report.push(
                Diagnostic::new(Code::SafetyBlock, first, what)
                    .label("plcc has none of the measures that make a block fail-safe")
                    .help("to test its logic as a standard block, compile with `--safety-as-standard`, or set `safety_as_standard = true` in plc.toml"),
            );
            return;
        }
        let mut message = Diagnostic::new(Code::SafetyBlock, first, what)
            .label("compiled as a standard block: nothing about it is fail-safe");
        message.severity = Severity::Warning;
        self.report.push(message);
        let list: Vec<String> = spans.iter().map(|span| self.text(*span).trim_matches('"').to_string()).collect();
        self.notices.push(format!("not fail-safe: compiled as standard blocks: {}", list.join(", ")));
    }

    /// Defines a block by its number, or notes that it has none.
    fn place(
        &mut self,
        block: &'a ast::Block,
        (prefix, numbered): (BlockPrefix, BlockName),
        movable: bool,
        used: &mut FxHashSet<(BlockPrefix, u32)>,
        unnumbered: &mut Vec<Unnumbered<'a>>,
    ) {
        let (_, name) = frame(block);
        let stands_in = self.input.stand_ins == Some(name.span().file);
        if matches!(prefix, BlockPrefix::Sfc | BlockPrefix::Sfb) && !stands_in {
            self.report.push(
                Diagnostic::new(Code::BlockFrame, name.span(), "system blocks belong to the CPU")
                    .label("a program cannot define this block")
                    .help("make it an FC or FB"),
            );
            return;
        }
        let class = block_class(block);
        match numbered {
            BlockName::Numbered { number, span, .. } => {
                let limit = match prefix {
                    BlockPrefix::Ob if self.sources.tia => u32::from(plcc_abi::ob::OB_NUMBER_MAX),
                    BlockPrefix::Ob => 255,
                    _ => 65_535,
                };
                let symbol = match name {
                    BlockName::Symbol { name, .. } => Some(name),
                    BlockName::Numbered { .. } => None,
                };
                // A number that the parser could not read was reported there.
                let is_unread = number == u32::MAX;
                if number > limit || (prefix == BlockPrefix::Db && number == 0) {
                    if !is_unread {
                        self.report.push(
                            Diagnostic::new(
                                Code::AddressRange,
                                span,
                                format!("{} {number} is not a block number", prefix.letters()),
                            )
                            .label(format!("numbers go up to {limit}"))
                            .help("use another number; DB 0 is reserved"),
                        );
                    }
                    // The uses of its name are not mistakes.
                    if let Some(name) = symbol {
                        let class = class.filter(|_| prefix == BlockPrefix::Ob);
                        unnumbered.push(Unnumbered { block, prefix, name: name.clone(), span, class });
                    }
                    return;
                }
                if movable
                    && used.contains(&(prefix, number))
                    && let Some(name) = symbol
                {
                    let class =
                        class.or_else(|| ObClass::of_number(number as u16)).filter(|_| prefix == BlockPrefix::Ob);
                    unnumbered.push(Unnumbered { block, prefix, name: name.clone(), span, class });
                    return;
                }
                used.insert((prefix, number));
                self.define(block, prefix, number as u16, span);
                if let Some(name) = symbol {
                    self.name_block(name, prefix, number, span);
                }
            }
            BlockName::Symbol { name, span } => match own_global(&self.names.symbols, prefix, &name) {
                None => unnumbered.push(Unnumbered { block, prefix, name, span, class }),
                Some(&Global { target: SymbolTarget::Block { prefix: named, number }, .. })
                    if named == prefix && number <= 65_535 =>
                {
                    if prefix == BlockPrefix::Udt {
                        self.names.types.insert(fold(&name), number as u16);
                    }
                    self.define(block, prefix, number as u16, span);
                }
                Some(global) => {
                    let row = global.span;
                    let wanted = with_article(prefix.letters());
                    let is = match global.target {
                        SymbolTarget::Block { prefix, .. } => with_article(prefix.letters()),
                        SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. } => "a tag".to_string(),
                    };
                    let of_block = self.input.units.iter().any(|(file, _)| *file == row.file);
                    let (title, help) = match of_block {
                        true => (
                            format!("two blocks have the name `{name}`"),
                            "give the two blocks different names".to_string(),
                        ),
                        false => (
                            format!("`{name}` is not {wanted} in the symbol table"),
                            "correct the row of the table, or give the block another name".to_string(),
                        ),
                    };
                    self.report.push(
                        Diagnostic::new(Code::DuplicateName, span, title)
                            .label(format!("{wanted} with this name"))
                            .also(row, format!("{is} with this name"))
                            .help(help),
                    );
                }
            },
        }
    }

    /// Notes the name of a block. If a data type has the same name, it means the type where types are expected, and the block elsewhere.
    fn name_block(&mut self, name: &str, prefix: BlockPrefix, number: u32, span: Span) {
        let target = SymbolTarget::Block { prefix, number };
        let external = External::default();
        let global = Global { name: name.trim().to_string(), target, ty: None, structure: None, external, span };
        if prefix == BlockPrefix::Udt {
            self.names.types.entry(fold(name)).or_insert(number as u16);
            self.names.blocks.insert((prefix, number as u16), name.trim().to_string());
            self.names.symbols.entry(fold(name)).or_insert(global);
        } else if own_global(&self.names.symbols, prefix, name).is_none() {
            self.names.symbols.insert(fold(name), global);
        }
    }

    /// The number that a block states, unless a symbol table gives its name one; also whether it may change.
    fn numbered(&self, block: &ast::Block, prefix: BlockPrefix, name: &BlockName) -> (BlockName, bool) {
        match name {
            BlockName::Symbol { name: text, .. } if own_global(&self.names.symbols, prefix, text).is_none() => {
                numbered(block, prefix, name)
            }
            BlockName::Symbol { .. } | BlockName::Numbered { .. } => (name.clone(), false),
        }
    }

    /// Kind and number of statements without a header, if the name of their file states them.
    fn named_by_file(&self, block: &ast::Block) -> Option<(BlockPrefix, u32)> {
        let ast::Block::Code(code) = block else { return None };
        if !is_fragment(code) {
            return None;
        }
        let (_, source) = self.input.sources.files().nth(code.span.file.0 as usize)?;
        let stem = std::path::Path::new(&source.name).file_stem()?.to_string_lossy();
        block_of_file(&stem)
    }

    /// The advice about two definitions: plcc does not guess which version of a block counts.
    fn choice(&self, first: Span, second: Span, same_file: &str) -> String {
        let name =
            |span: Span| self.input.sources.files().nth(span.file.0 as usize).map(|(_, file)| file.name.as_str());
        match (name(first), name(second)) {
            (Some(first), Some(second)) if first != second => format!(
                "choose one: specify only the files of one CPU and one version, or name them as `sources` in plc.toml. The files are \
                 `{first}` and `{second}`"
            ),
            _ => same_file.to_string(),
        }
    }

    fn define(&mut self, block: &'a ast::Block, prefix: BlockPrefix, number: u16, span: Span) {
        if let Some(first) = self.names.defined.insert((prefix, number), span) {
            self.names.defined.insert((prefix, number), first);
            let title = format!("{} {number} is defined twice", prefix.letters());
            let (is_first, is_second) = (is_loose(prefix, first), is_loose(prefix, span));
            let help = if is_first || is_second { LOOSE_HELP } else { "give one of them another number" };
            let help = self.choice(first, span, help);
            self.report.push(
                Diagnostic::new(Code::DuplicateBlock, span, title)
                    .label(if is_second { LOOSE } else { "the second definition" })
                    .also(first, if is_first { LOOSE } else { "the first definition" })
                    .help(help),
            );
            return;
        }
        match block {
            ast::Block::Code(code) => {
                if let Some(kind) = code_kind(prefix) {
                    let source = match &code.code {
                        ast::Code::Stl(_) if prefix != source_prefix(code.kind) => {
                            let mut code = code.clone();
                            code.kind = if prefix == BlockPrefix::Fb { CodeKind::Fb } else { CodeKind::Fc };
                            crate::bind::globals::sources::CodeSource::Expanded(std::rc::Rc::new(code))
                        }
                        ast::Code::Chart(chart) => crate::bind::globals::sources::CodeSource::Expanded(
                            std::rc::Rc::new(crate::bind::trees::chart_data::expanded(code, chart)),
                        ),
                        ast::Code::Stl(_) | ast::Code::Scl(_) | ast::Code::Graphic(_) => {
                            crate::bind::globals::sources::CodeSource::User(code)
                        }
                    };
                    self.sources.code.insert(BlockKey { kind, number }, source);
                }
            }
            ast::Block::Data(data) => {
                self.sources.data.insert(number, data);
            }
            ast::Block::Type(ty) => {
                self.sources.types.insert(number, ty);
            }
        }
    }
}
