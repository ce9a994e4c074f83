//! Names of a program for the S7-200: variables of blocks, symbols, blocks, labels and addresses, by the places where they are written.
//!
//! The syntax tree says what each operand is, so there is one list of uses; what an editor asks about a place is a question to that list.

use lsp_types::{CompletionItem, CompletionItemKind, SignatureHelp};
use plcc_diag::{FileId, Span};
use plcc_syntax::ast::Width;
use plcc_syntax::s7200::ast::{
    Area, AssertSide, Block, BlockKind, Constant, Declaration, Direct, Operand, OperandKind, Section, StatementKind,
    SymbolForm,
};
use plcc_syntax::s7200::{Insn, OperandClass, libraries};
use plcc_syntax::symbols::S7200Symbol;

use crate::Checked;
use crate::address::{self, Address};
use crate::complete;
use crate::facts::same;
use crate::values;
use crate::words::{Words, bare};

/// What is written at a place.
#[derive(Clone, Debug)]
pub enum Named<'c> {
    /// A variable of a block.
    Local(Owner<'c>, &'c Declaration),
    Symbol(&'c S7200Symbol),
    Block(Owner<'c>),
    /// The label with this number of a block.
    Label(Owner<'c>, i64),
    Address(Address),
}

/// A block with its file.
#[derive(Clone, Copy, Debug)]
pub struct Owner<'c> {
    file: FileId,
    block: &'c Block,
}

impl PartialEq for Owner<'_> {
    fn eq(&self, other: &Self) -> bool {
        (self.file, self.block.span.start) == (other.file, other.block.span.start)
    }
}

/// A place of the program.
#[derive(Clone, Debug)]
pub struct Use<'c> {
    pub span: Span,
    pub named: Named<'c>,
    pub declares: bool,
    /// It is written as a name, which can be changed.
    is_name: bool,
}

impl Named<'_> {
    fn is(&self, other: &Named) -> bool {
        match (self, other) {
            (Named::Local(_, one), Named::Local(_, other)) => one.name_span == other.name_span,
            (Named::Symbol(one), Named::Symbol(other)) => one.name_span == other.name_span,
            (Named::Block(one), Named::Block(other)) => one == other,
            (Named::Label(one, number), Named::Label(other, same)) => one == other && number == same,
            (Named::Address(one), Named::Address(other)) => one.overlaps(other),
            (Named::Local(..) | Named::Symbol(_) | Named::Block(_) | Named::Label(..) | Named::Address(_), _) => false,
        }
    }

    /// The bits that it means.
    fn address(&self) -> Option<Address> {
        match self {
            Named::Address(address) => Some(address.clone()),
            Named::Symbol(row) => row_address(row),
            Named::Local(..) | Named::Block(_) | Named::Label(..) => None,
        }
    }
}

/// The names of a program.
pub struct Names<'c> {
    checked: &'c Checked,
    blocks: Vec<Owner<'c>>,
}

impl<'c> Names<'c> {
    /// `None`: the file is neither a source for the S7-200 nor a table of a program with one. Tables of other CPUs may have its rows, too.
    pub fn of(checked: &'c Checked, file: FileId) -> Option<Names<'c>> {
        let mut rows = checked.tables.iter().flat_map(|table| &table.s7200);
        let sources = checked.units.iter().filter_map(|(file, unit)| Some((*file, unit.s7200.as_ref()?)));
        let is_source = sources.clone().any(|(own, _)| own == file);
        let is_table = sources.clone().next().is_some() && rows.any(|row| row.name_span.file == file);
        if !is_source && !is_table {
            return None;
        }
        let blocks = sources.flat_map(|(file, source)| source.blocks.iter().map(move |block| Owner { file, block }));
        Some(Names { checked, blocks: blocks.collect() })
    }

    fn rows(&self) -> impl Iterator<Item = &'c S7200Symbol> {
        self.checked.tables.iter().flat_map(|table| &table.s7200)
    }

    fn block_named(&self, name: &str) -> Option<Owner<'c>> {
        let named = |owner: &&Owner| owner.block.name.as_ref().is_some_and(|(own, _)| same(own, name));
        self.blocks.iter().find(named).copied()
    }

    fn block_numbered(&self, kind: BlockKind, number: u32) -> Option<Owner<'c>> {
        let numbered = |owner: &&Owner| {
            owner.block.kind == kind
                && (kind == BlockKind::Main || owner.block.number.is_some_and(|(own, _)| own == number))
        };
        self.blocks.iter().find(numbered).copied()
    }

    /// The block around a byte of a file.
    pub fn around(&self, file: FileId, byte: usize) -> Option<Owner<'c>> {
        let inside = |owner: &&Owner| {
            owner.file == file && (owner.block.span.start as usize..=owner.block.span.end as usize).contains(&byte)
        };
        self.blocks.iter().find(inside).copied()
    }

    /// All uses in all sources and symbol tables.
    pub fn uses(&self) -> Vec<Use<'c>> {
        let mut uses = Vec::new();
        for row in self.rows() {
            uses.push(Use { span: row.name_span, named: Named::Symbol(row), declares: true, is_name: true });
        }
        for (_, unit) in &self.checked.units {
            let data = unit.s7200.iter().flat_map(|source| &source.data);
            data.flat_map(|line| line.address.iter().chain(&line.values))
                .for_each(|operand| self.operand(None, operand, &mut uses));
        }
        for &owner in &self.blocks {
            let block = owner.block;
            let named = || Named::Block(owner);
            if let Some((_, span)) = &block.name {
                uses.push(Use { span: *span, named: named(), declares: true, is_name: true });
            }
            if let Some((_, span)) = block.number {
                uses.push(Use { span, named: named(), declares: block.name.is_none(), is_name: false });
            }
            for one in &block.declarations {
                let named = Named::Local(owner, one);
                uses.push(Use { span: one.name_span, named, declares: true, is_name: true });
            }
            for statement in block.networks.iter().flat_map(|network| &network.statements) {
                match &statement.kind {
                    StatementKind::Instruction { insn, operands, .. } => {
                        self.instruction(owner, *insn, operands, &mut uses);
                    }
                    StatementKind::Pragma { assert: Some(assert), .. } => {
                        for side in assert.comparisons.iter().flat_map(|one| [&one.left, &one.right]) {
                            match &side.value {
                                AssertSide::Operand(operand) => self.operand(Some(owner), operand, &mut uses),
                                AssertSide::Stack(_) | AssertSide::Eno => {}
                            }
                        }
                    }
                    StatementKind::Pragma { assert: None, .. } | StatementKind::Error => {}
                }
            }
        }
        uses
    }

    fn instruction(&self, owner: Owner<'c>, insn: Insn, operands: &'c [Operand], uses: &mut Vec<Use<'c>>) {
        let classes = insn.operands();
        for (at, operand) in operands.iter().enumerate() {
            match (classes.get(at), &operand.kind) {
                (Some(OperandClass::Label), OperandKind::Constant(Constant::Integer(number))) => uses.push(Use {
                    span: operand.span,
                    named: Named::Label(owner, *number),
                    declares: insn == Insn::Lbl,
                    is_name: false,
                }),
                _ => self.operand(Some(owner), operand, uses),
            }
        }
    }

    fn operand(&self, owner: Option<Owner<'c>>, operand: &'c Operand, uses: &mut Vec<Use<'c>>) {
        let (named, is_name) = match &operand.kind {
            OperandKind::Indirect(inner) | OperandKind::AddressOf(inner) => return self.operand(owner, inner, uses),
            OperandKind::Direct(direct) => (Some(Named::Address(direct_address(direct))), false),
            OperandKind::Symbol { name, form } => (self.symbol(owner, name, *form), true),
            OperandKind::Block { kind, number } => (self.block_numbered(*kind, *number).map(Named::Block), false),
            OperandKind::Constant(_) | OperandKind::Error => (None, false),
        };
        let mut span = operand.span;
        // `Start:I0.0`: the symbol, then its address.
        if let Some(shown) = &operand.shown
            && let Some(colon) = self.checked.sources.text(span).rfind(':')
        {
            let colon = span.start + colon as u32;
            let name = Span { end: colon, ..span };
            let symbol = self.symbol(owner, &shown.name, shown.form);
            uses.extend(symbol.map(|named| Use { span: name, named, declares: false, is_name: true }));
            span.start = colon + 1;
        }
        uses.extend(named.map(|named| Use { span, named, declares: false, is_name }));
    }

    /// As the binder finds names: variables of the block, then blocks and symbols.
    fn symbol(&self, owner: Option<Owner<'c>>, name: &str, form: SymbolForm) -> Option<Named<'c>> {
        let local = owner.and_then(|owner| {
            let found = owner.block.declarations.iter().find(|one| same(&one.name, name))?;
            Some(Named::Local(owner, found))
        });
        let global = || {
            let row = || self.rows().find(|row| same(&row.name, name)).map(Named::Symbol);
            self.block_named(name).map(Named::Block).or_else(row)
        };
        match form {
            SymbolForm::Local => local,
            SymbolForm::Quoted => global(),
            SymbolForm::Bare => local.or_else(global),
        }
    }

    /// What is written at a byte of a file.
    pub fn at(&self, file: FileId, byte: usize) -> Option<Use<'c>> {
        let touches = |span: Span| span.file == file && span.start as usize <= byte && byte <= span.end as usize;
        self.uses().into_iter().find(|one| touches(one.span))
    }

    /// Where a name is declared.
    pub fn definition(&self, named: &Named) -> Option<Span> {
        match named {
            Named::Local(_, one) => Some(one.name_span),
            Named::Symbol(row) => Some(row.name_span),
            Named::Block(owner) => {
                let block = owner.block;
                let name = block.name.as_ref().map(|(_, span)| *span);
                Some(name.or(block.number.map(|(_, span)| span)).unwrap_or(block.span))
            }
            Named::Label(..) => {
                self.uses().into_iter().find(|one| one.declares && one.named.is(named)).map(|one| one.span)
            }
            Named::Address(_) => None,
        }
    }

    /// Every place that means the same; of an address or a symbol of one, every place that has a bit in common.
    pub fn references(&self, wanted: &Named) -> Vec<Span> {
        let address = wanted.address();
        let is_it = |one: &Use| {
            one.named.is(wanted)
                || match (&address, one.named.address()) {
                    (Some(wanted), Some(own)) => own.overlaps(wanted),
                    (_, _) => false,
                }
        };
        let mut found: Vec<Span> = self.uses().iter().filter(|one| is_it(one)).map(|one| one.span).collect();
        found.sort_by_key(|span| (span.file, span.start));
        found.dedup();
        found
    }

    /// The edits that give a name to something else. `Err`: why it cannot have it.
    pub fn rename(&self, wanted: &Named, to: &str) -> Result<Vec<(Span, String)>, String> {
        let to = bare(to.trim());
        if to.is_empty() || to.chars().any(|c| c == '"' || c.is_control()) {
            return Err("a name has neither quotes nor line ends".to_owned());
        }
        let is_word = to.starts_with(|c: char| c.is_alphabetic() || c == '_')
            && to.chars().all(|c| c.is_alphanumeric() || c == '_');
        if !is_word {
            return Err("a name of an S7-200 begins with a letter and has letters, digits and `_`".to_owned());
        }
        let (name, is_taken) = match wanted {
            Named::Local(owner, one) => {
                (one.name.as_str(), owner.block.declarations.iter().any(|other| same(&other.name, to)))
            }
            Named::Symbol(row) => (row.name.as_str(), self.is_global(to)),
            Named::Block(owner) => match &owner.block.name {
                Some((name, _)) => (name.as_str(), self.is_global(to)),
                None => return Err("a block number is not a name".to_owned()),
            },
            Named::Label(..) => return Err("a label is a number, which stands for itself".to_owned()),
            Named::Address(_) => return Err("an address has no name; give it one in a symbol table".to_owned()),
        };
        if is_taken && !same(name, to) {
            return Err(format!("`{to}` is already the name of something else"));
        }
        if address::plain(&to.to_uppercase()).is_some() {
            return Err(format!("`{to}` is an address"));
        }
        let edit = |one: Use| {
            let text = self.checked.sources.text(one.span);
            let start = one.span.start + text.find(|c| !matches!(c, '#' | '"')).unwrap_or(0) as u32;
            let end = one.span.end - u32::from(text.len() > 1 && text.ends_with('"'));
            (Span { start, end, ..one.span }, to.to_owned())
        };
        let mut edits: Vec<_> =
            self.uses().into_iter().filter(|one| one.is_name && one.named.is(wanted)).map(edit).collect();
        if let Named::Symbol(row) = wanted {
            edits.extend(values::edits(self.checked, to, |names| matches!(names, [one] if same(one, &row.name)))?);
        }
        Ok(edits)
    }

    fn is_global(&self, name: &str) -> bool {
        self.block_named(name).is_some() || self.rows().any(|row| same(&row.name, name))
    }

    /// Markdown about what is written at a place.
    pub fn hover(&self, named: &Named) -> String {
        match named {
            Named::Local(owner, one) => {
                let comment = one.comment.as_deref().unwrap_or_default();
                let (section, block) = (section(one.section), block_text(owner.block));
                format!("{}{section} of {block}\n\n{comment}\n", code(&format!("{} : {}", one.name, one.ty)))
            }
            Named::Symbol(row) => {
                format!("{}`{}`\n\n{}\n", code(&format!("\"{}\"", row.name)), row.address, row.comment)
            }
            Named::Block(owner) => {
                let rows = owner.block.declarations.iter().filter(|one| one.section != Section::Temp);
                let rows = rows.map(|one| format!("- `{}` {} {}\n", one.name, section(one.section), one.ty));
                let title = &owner.block.title;
                format!("{}{title}\n\n{}", code(&block_text(owner.block)), rows.collect::<String>())
            }
            Named::Label(owner, number) => {
                format!("{}jump label of {}\n", code(&format!("LBL {number}")), block_text(owner.block))
            }
            Named::Address(wanted) => {
                let bits = if wanted.bits == 1 { "one bit".to_owned() } else { format!("{} bits", wanted.bits) };
                let overlaps = |row: &&S7200Symbol| row_address(row).is_some_and(|own| own.overlaps(wanted));
                let rows = self.rows().filter(overlaps);
                let rows = rows.map(|row| format!("- `\"{}\"` {} {}\n", row.name, row.address, row.comment));
                let head = match wanted.area.as_str() {
                    "T" => "a timer".to_owned(),
                    "C" => "a counter".to_owned(),
                    "AC" => "an accumulator".to_owned(),
                    "HC" => "a high-speed counter".to_owned(),
                    area => format!("{bits} of {area}"),
                };
                format!("{head}\n\n{}", rows.collect::<String>())
            }
        }
    }

    /// The names that can be an operand at a byte.
    pub fn operands(&self, words: &Words, file: FileId, byte: usize) -> Vec<CompletionItem> {
        let next = words.before(byte);
        let first = first_before(words, byte);
        let mnemonic = first.map_or("", |at| words.word(at)).to_ascii_uppercase();
        let owner = self.around(file, byte);
        let is_writing = next.checked_sub(1).is_some_and(|at| words.range(at).end >= byte);
        // The word itself may be the mnemonic that is being written.
        if first.is_none() || is_writing && first == next.checked_sub(1) {
            return Vec::new();
        }
        let mut items = Vec::new();
        if matches!(mnemonic.as_str(), "JMP" | "SPA") {
            let uses = self.uses();
            let labels = uses.iter().filter(|one| one.declares).filter_map(|one| match &one.named {
                Named::Label(own, number) if Some(*own) == owner => Some(*number),
                Named::Local(..) | Named::Symbol(_) | Named::Block(_) | Named::Label(..) | Named::Address(_) => None,
            });
            return labels
                .map(|number| item(&number.to_string(), CompletionItemKind::REFERENCE, "jump label"))
                .collect();
        }
        for one in owner.iter().flat_map(|owner| &owner.block.declarations) {
            items.push(item(&one.name, CompletionItemKind::FIELD, &format!("{} {}", one.ty, section(one.section))));
        }
        items.extend(self.rows().map(|row| item(&row.name, CompletionItemKind::VARIABLE, &row.address)));
        for owner in &self.blocks {
            if let Some((name, _)) = &owner.block.name {
                items.push(item(name, CompletionItemKind::MODULE, owner.block.kind.keyword()));
            }
        }
        items
    }

    /// The parameters of the subroutine that is called in the line of a byte.
    pub fn signature(&self, words: &Words, byte: usize) -> Option<SignatureHelp> {
        let first = first_before(words, byte).filter(|&at| words.word(at).eq_ignore_ascii_case("CALL"))?;
        let name = bare(words.word(first + 1));
        let number = || -> Option<u32> { name.to_ascii_uppercase().strip_prefix("SBR")?.parse().ok() };
        let numbered = || self.block_numbered(BlockKind::Subroutine, number()?);
        let texts: Vec<String> = match self.block_named(name).or_else(numbered) {
            Some(Owner { block, .. }) => {
                let parameters = block.declarations.iter().filter(|one| !matches!(one.section, Section::Temp));
                parameters.map(|one| format!("{} : {} {}", one.name, one.ty, section(one.section))).collect()
            }
            None => {
                let known = libraries::subroutine(name)?;
                let word = |output| section(if output { Section::Output } else { Section::Input });
                known.parameters().map(|(name, output)| format!("{name} {}", word(output))).collect()
            }
        };
        let commas = (first..words.before(byte)).filter(|&at| words.word(at) == ",").count();
        Some(complete::help(format!("{name}, {}", texts.join(", ")), &texts, Some(commas.checked_sub(1)?)))
    }
}

/// The first piece in the line of a byte, if it begins before that.
fn first_before(words: &Words, byte: usize) -> Option<usize> {
    let line_start = words.text.get(..byte).map_or(0, |text| text.rfind('\n').map_or(0, |at| at + 1));
    (0..words.before(byte)).rev().take_while(|at| words.range(*at).start >= line_start).last()
}

fn item(label: &str, kind: CompletionItemKind, detail: &str) -> CompletionItem {
    CompletionItem {
        label: label.to_owned(),
        kind: Some(kind),
        detail: Some(detail.to_owned()),
        ..CompletionItem::default()
    }
}

fn code(text: &str) -> String {
    format!("```plc\n{text}\n```\n")
}

/// The word of a section.
pub const fn section(section: Section) -> &'static str {
    match section {
        Section::Input => "IN",
        Section::InOut => "IN_OUT",
        Section::Output => "OUT",
        Section::Temp => "TEMP",
    }
}

/// `SUBROUTINE_BLOCK Scale SBR0`
fn block_text(block: &Block) -> String {
    format!("{} {}", block.kind.keyword(), label(block)).trim_end().to_owned()
}

/// `Scale SBR0`; a block without a header has neither name nor number.
pub fn label(block: &Block) -> String {
    let letters = match block.kind {
        BlockKind::Main => "OB",
        BlockKind::Subroutine => "SBR",
        BlockKind::Interrupt => "INT",
    };
    let name = block.name.as_ref().map(|(name, _)| name.clone());
    let number = block.number.map(|(number, _)| format!("{letters}{number}"));
    name.into_iter().chain(number).collect::<Vec<_>>().join(" ")
}

/// The bits of a direct address. Timers, counters and accumulators are one thing each.
fn direct_address(direct: &Direct) -> Address {
    let number = u64::from(direct.number);
    let (bit, bits) = match (direct.area, direct.width) {
        (Area::T | Area::C | Area::Hc | Area::Ac, _) | (_, None) => (number, 1),
        (_, Some(Width::Bit)) => (8 * number + u64::from(direct.bit), 1),
        (_, Some(Width::Byte)) => (8 * number, 8),
        (_, Some(Width::Word)) => (8 * number, 16),
        (_, Some(Width::Dword)) => (8 * number, 32),
        (_, Some(Width::Lword)) => (8 * number, 64),
    };
    Address { area: direct.area.letters().to_owned(), bit, bits, pieces: 1 }
}

/// The bits of a row of a symbol table; `None`: it names a block or a constant.
fn row_address(row: &S7200Symbol) -> Option<Address> {
    let text: String = row.address.chars().filter(|c| !c.is_whitespace()).collect::<String>().to_ascii_uppercase();
    let analog = [("AIW", "AI"), ("AEW", "AI"), ("AQW", "AQ"), ("AAW", "AQ")];
    for (letters, area) in analog {
        if let Some(number) = text.strip_prefix(letters) {
            return Some(Address { area: area.to_owned(), bit: 8 * number.parse::<u64>().ok()?, bits: 16, pieces: 1 });
        }
    }
    address::plain(&text)
}
