//! What can be written at a place, and the parameters of the call around it.

use std::collections::HashSet;
use std::ops::Range;

use lsp_types::{
    CompletionItem, CompletionItemKind, ParameterInformation, ParameterLabel, SignatureHelp, SignatureInformation,
};
use plcc_diag::FileId;
use plcc_syntax::ast::{Block, BlockName, BlockPrefix};
use plcc_syntax::network::elements::{self, PinDirection, PinRow};
use plcc_syntax::scl::keyword::Keyword;
use plcc_syntax::stl::{Mnemonics, OperandClass, StlInsn};
use plcc_syntax::symbols::{Symbol, SymbolTarget};
use plcc_syntax::{Elementary, Language, s7200};

use crate::chart::{self, Component, Part};
use crate::constants::{self, Constant};
use crate::facts::{FunctionFacts, ParameterFacts};
use crate::index::{Declared, Entry, Index};
use crate::labels;
use crate::names::{Meaning, along, callee_around, open_bracket, part_before, values_before};
use crate::network;
use crate::role::in_rung;
use crate::words::{Words, bare, is_name};

/// Words of SCL that the grammar reads as lines of their own.
const REGION: [&str; 2] = ["REGION", "END_REGION"];

/// The items at a byte.
pub fn complete(index: &Index, words: &Words, file: FileId, byte: usize, set: Mnemonics) -> Vec<CompletionItem> {
    let next = words.before(byte);
    // Nothing is proposed in comments and texts.
    let around = next.checked_sub(1).map(|at| (words.word(at), words.range(at).end));
    let is_open = |(word, end): (&str, usize)| match word {
        _ if word.starts_with("//") => byte <= end,
        // A text whose second quote is not written yet.
        _ if word.starts_with('\'') && (word.len() == 1 || !word.ends_with('\'')) => byte <= end,
        _ if word.starts_with("(*") || word.starts_with("/*") || word.starts_with('\'') => byte < end,
        _ => false,
    };
    if around.is_some_and(is_open) {
        return Vec::new();
    }
    // The word that is being written.
    let writing = next.checked_sub(1).filter(|&at| words.range(at).end >= byte && is_name(words.word(at)));
    let first = writing.unwrap_or(next);
    let before = first.checked_sub(1).map_or("", |at| words.word(at));
    let written = writing.map_or("", |at| words.word(at));
    let entry = index.around(file, byte);
    if before == "." {
        if let Some(part) = part_before(index, words, file, first - 1) {
            let row = |one: &Component| CompletionItem {
                documentation: Some(lsp_types::Documentation::String(one.doc.to_owned())),
                ..item(one.name, CompletionItemKind::FIELD, one.ty)
            };
            return part.components().iter().map(row).collect();
        }
        let members = members_before(index, words, file, first - 1);
        if members.is_empty() {
            let values = values_before(index, words, file, first - 1).unwrap_or_default();
            return values.iter().map(|one| item(&one.name, CompletionItemKind::FIELD, &one.ty)).collect();
        }
        return members.into_iter().map(|one| variable(index, one)).collect();
    }
    if before == "#" || written.starts_with('#') || words.word(first) == "#" && words.range(first).end == byte {
        let sign = if before == "#" { first - 1 } else { first };
        let owner = sign.checked_sub(1).map_or("", |owner| words.word(owner));
        if words.language(sign) == Language::Sd && owner.eq_ignore_ascii_case("wire") {
            let wires = network::wires(words, sign).into_iter();
            return wires.map(|name| item(name, CompletionItemKind::REFERENCE, "wire")).collect();
        }
        return locals(index, entry);
    }
    if written.starts_with('"') || text_before(words, byte).ends_with('"') {
        return globals(index);
    }
    // What follows is an address.
    if text_before(words, byte).ends_with('%') {
        return Vec::new();
    }
    let language = words.language(first.min(words.pieces.len().saturating_sub(1)));
    if language != Language::S7200 && is_type(words, first) {
        return types(index, language);
    }
    let mut items = Vec::new();
    let begins = before == ":"
        || match writing {
            Some(at) => words.first_on_line(at),
            None => text_before(words, byte).trim().is_empty(),
        };
    // `CALL FB 1, ` without a list of parameters yet.
    let is_instance = language == Language::Stl && before == "," && !begins && open_bracket(words, first).is_none();
    // `#t.TON( ` has the pins of the element, not the parameters of the block TON as well.
    let is_element = || open_bracket(words, first).is_some_and(|open| network::signature(words, open).is_some());
    if matches!(before, "(" | ",") && !is_instance && !is_element() {
        items.extend(parameters(index, words, file, first));
    }
    match language {
        // A line of a list of parameters has no mnemonic.
        Language::Stl if begins && before != "," && items.is_empty() => {
            items.extend(StlInsn::ALL.iter().map(|insn| CompletionItem {
                label: insn.mnemonic(set).to_owned(),
                kind: Some(CompletionItemKind::OPERATOR),
                detail: Some(insn.doc().trim().to_owned()),
                ..CompletionItem::default()
            }))
        }
        // The first word in a list of parameters is one of them.
        Language::Stl if matches!(before, "(" | ",") && open_bracket(words, first).is_some() => {}
        Language::Stl => match stl_operand(words, first, set) {
            Some(OperandClass::Label) => {
                let labels = entry.into_iter().flat_map(labels::of);
                items.extend(labels.map(|label| item(label.name, CompletionItemKind::REFERENCE, "jump label")));
            }
            Some(OperandClass::Block) => {
                items.extend(marked_locals(index, entry));
                items.extend(marked_globals(index, Wanted::Code));
            }
            Some(OperandClass::DataBlock) => items.extend(marked_globals(index, Wanted::Data)),
            Some(class) if takes_names(class) => {
                items.extend(marked_locals(index, entry));
                items.extend(marked_globals(index, Wanted::Operand));
            }
            Some(_) | None => {}
        },
        Language::S7200 => {
            items.extend(s7200::mnemonics(set).map(|(name, doc)| item(&name, CompletionItemKind::OPERATOR, doc.trim())))
        }
        Language::Scl if before.eq_ignore_ascii_case("GOTO") => {
            let labels = entry.into_iter().flat_map(labels::of);
            items.extend(labels.map(|label| item(label.name, CompletionItemKind::REFERENCE, "jump label")));
        }
        Language::Scl => {
            let keywords = Keyword::ALL.iter().filter(|word| word.is_in_statements()).map(|word| word.word());
            items.extend(keywords.chain(REGION).map(|word| item(word, CompletionItemKind::KEYWORD, "")));
            items.extend(locals(index, entry));
            items.extend(index.checked.facts.functions.iter().map(function));
            items.extend(marked_globals(index, Wanted::Value));
        }
        Language::Sd if in_rung(words, first) && matches!(before, "(" | ",") => {
            let pins = pins(words, first);
            // The operand has no name: `Contact( #on )`.
            if before == "(" && pins.iter().any(|pin| pin.label == "operand") {
                items.extend(marked_locals(index, entry));
                items.extend(marked_globals(index, Wanted::Operand));
            }
            items.extend(pins);
        }
        Language::Sd if in_rung(words, first) && matches!(before, ":=" | "=>" | "NOT") => {
            items.extend(marked_locals(index, entry));
            items.extend(marked_globals(index, Wanted::Operand));
        }
        Language::Sd if in_rung(words, first) => {
            items.extend(elements::elements().map(|row| {
                let names: Vec<&str> = row.pins().map(|pin| pin.name()).collect();
                item(row.name, CompletionItemKind::OPERATOR, &names.join(", "))
            }));
        }
        Language::Graph if chart::is_end(words, first) => items.extend(steps(entry, true)),
        Language::Graph if begins_operand(words, first) => {
            items.extend(locals(index, entry));
            items.extend(steps(entry, false));
            items.extend(marked_globals(index, Wanted::Operand));
        }
        Language::Sd | Language::Graph => {}
    }
    items
}

/// Whether an operand of a condition can stand at a piece.
fn begins_operand(words: &Words, at: usize) -> bool {
    const WORDS: [&str; 4] = ["AND", "NOT", "OR", "XOR"];
    // A bracket after an operand has the qualifier of an action: `Q1.2 (N)`.
    let before = (0..at).rev().map(|at| words.word(at)).find(|word| *word != "(").unwrap_or_default();
    matches!(before, ":=" | "&" | "=" | "<>" | "<" | ">" | "<=" | ">=" | "+" | "-" | "*" | "/")
        || WORDS.iter().any(|word| word.eq_ignore_ascii_case(before))
}

/// The steps of a chart, and its transitions, which have components that conditions read.
fn steps(entry: Option<Entry>, alone: bool) -> impl Iterator<Item = CompletionItem> {
    let parts = entry.into_iter().flat_map(chart::of);
    parts.filter(move |part| !alone || matches!(part, Part::Step(_))).map(|part| {
        let comment = Some(part.comment()).filter(|comment| !comment.is_empty());
        CompletionItem {
            documentation: comment.map(lsp_types::Documentation::String),
            ..item(part.name(), CompletionItemKind::REFERENCE, &part.kind())
        }
    })
}

/// Types that are not elementary ones.
const TYPES: [&str; 4] = ["ARRAY", "DATE_AND_TIME", "STRING", "STRUCT"];

/// Whether a piece is where a declaration has its type: after `:` or OF, as in `list : ARRAY[0..3] OF INT`.
fn is_type(words: &Words, at: usize) -> bool {
    // Words that begin and end declarations. Statements have `:` and OF too, after labels and in CASE.
    const ENDS: [&str; 6] = ["BEGIN", "END_CONST", "END_TYPE", "END_VAR", "NETWORK", "RUNG"];
    const BEGINS: [&str; 10] = [
        "CONST",
        "FUNCTION",
        "STRUCT",
        "TYPE",
        "VAR",
        "VAR_IN_OUT",
        "VAR_INPUT",
        "VAR_OUTPUT",
        "VAR_STATIC",
        "VAR_TEMP",
    ];
    let is = |at: usize, list: &[&str]| list.iter().any(|own| own.eq_ignore_ascii_case(words.word(at)));
    if !at.checked_sub(1).is_some_and(|before| is(before, &[":", "OF"])) {
        return false;
    }
    let last = (0..at).rev().find(|&at| is(at, &ENDS) || is(at, &BEGINS));
    last.is_some_and(|at| is(at, &BEGINS))
}

/// Elementary types, and the data types and FBs of the program. Only the S7-1200 and S7-1500 have all; STL has those of the S7-300.
fn types(index: &Index, language: Language) -> Vec<CompletionItem> {
    let is_known = |ty: &&Elementary| language != Language::Stl || ty.is_of_s7300();
    let names = Elementary::ALL.iter().filter(is_known).map(|ty| ty.name());
    let mut items: Vec<CompletionItem> =
        names.chain(TYPES).map(|name| item(name, CompletionItemKind::KEYWORD, "")).collect();
    let blocks = index.blocks.iter().filter(|entry| matches!(entry.keyword(), "TYPE" | "FUNCTION_BLOCK"));
    items.extend(blocks.map(|entry| {
        let name = match entry.name() {
            BlockName::Symbol { name, .. } => format!("\"{name}\""),
            BlockName::Numbered { .. } => entry.text(),
        };
        item(&name, CompletionItemKind::STRUCT, entry.keyword())
    }));
    items
}

/// `pt := ` for each pin of an element that the list does not have yet. The flow comes and goes on wires.
fn pins(words: &Words, at: usize) -> Vec<CompletionItem> {
    let Some(open) = open_bracket(words, at) else { return Vec::new() };
    let element = open.checked_sub(1).and_then(|before| elements::find_sd(words.word(before)));
    let Some((row, _)) = element else { return Vec::new() };
    let given: Vec<&str> =
        (open..at).filter(|&at| matches!(words.word(at + 1), ":=" | "=>")).map(|at| words.word(at)).collect();
    let is_missing = |pin: &PinRow| {
        let is_plain = ![row.flow.0, row.flow.1].contains(&pin.name());
        pin.numbered || is_plain && !given.iter().any(|own| pin.matches(own).is_some())
    };
    let propose = |pin: PinRow| {
        let sign = match pin.direction {
            PinDirection::Input | PinDirection::InOut => ":=",
            PinDirection::Output => "=>",
        };
        CompletionItem {
            insert_text: Some(format!("{} {sign} ", pin.name())),
            ..item(pin.name(), CompletionItemKind::FIELD, network::direction(pin))
        }
    };
    row.pins().filter(is_missing).map(propose).collect()
}

/// The text of the line up to a byte.
fn text_before<'t>(words: &Words<'t>, byte: usize) -> &'t str {
    let text = words.text.get(..byte).unwrap_or_default();
    text.rsplit('\n').next().unwrap_or_default()
}

fn item(label: &str, kind: CompletionItemKind, detail: &str) -> CompletionItem {
    let detail = Some(detail.to_owned()).filter(|detail| !detail.is_empty());
    CompletionItem { label: label.to_owned(), kind: Some(kind), detail, ..CompletionItem::default() }
}

fn variable(index: &Index, (direction, variable): Declared) -> CompletionItem {
    let detail = format!("{} {direction}", index.type_text(&variable.ty));
    CompletionItem {
        documentation: variable.comment.clone().map(lsp_types::Documentation::String),
        ..item(&variable.name, CompletionItemKind::FIELD, detail.trim())
    }
}

fn function(function: &FunctionFacts) -> CompletionItem {
    let parameters: Vec<String> = function.parameters.iter().map(ParameterFacts::text).collect();
    let description = Some(&function.description).filter(|text| !text.is_empty());
    CompletionItem {
        documentation: description.cloned().map(lsp_types::Documentation::String),
        ..item(&function.name, CompletionItemKind::FUNCTION, &format!("({})", parameters.join(", ")))
    }
}

/// Variables and constants of a block.
fn locals(index: &Index, entry: Option<Entry>) -> Vec<CompletionItem> {
    let Some(entry) = entry else { return Vec::new() };
    let mut items: Vec<CompletionItem> = entry.variables().into_iter().map(|one| variable(index, one)).collect();
    items.extend(constants::of(entry).iter().map(|one| constant(index, Constant::Local(entry, one))));
    items
}

fn constant(index: &Index, constant: Constant) -> CompletionItem {
    item(constant.name(), CompletionItemKind::CONSTANT, &constant.value(index))
}

/// Blocks with names, symbols and constants.
fn globals(index: &Index) -> Vec<CompletionItem> {
    let named = index.blocks.iter().filter(|entry| matches!(entry.name(), BlockName::Symbol { .. }));
    let block = |entry: &Entry| item(&entry.text(), CompletionItemKind::MODULE, entry.keyword());
    let mut items: Vec<CompletionItem> = named.map(block).collect();
    items.extend(index.checked.tables.iter().flat_map(|table| &table.symbols).map(symbol));
    let constants = index.checked.tables.iter().flat_map(|table| &table.constants);
    items.extend(constants.map(|one| constant(index, Constant::Global(one))));
    items
}

fn symbol(symbol: &Symbol) -> CompletionItem {
    let detail = format!("{} {} {}", crate::hover::target_text(symbol.target), symbol.ty, symbol.comment);
    item(&symbol.name, CompletionItemKind::VARIABLE, detail.trim())
}

/// The kind of global name that a place takes.
#[derive(Clone, Copy, PartialEq)]
enum Wanted {
    /// What is called.
    Code,
    /// A data block.
    Data,
    /// What STL and networks read and write.
    Operand,
    /// The same in SCL, where functions have values.
    Value,
}

impl Wanted {
    fn is_block(self, entry: &Entry) -> bool {
        match self {
            Wanted::Code => matches!(entry.keyword(), "FUNCTION" | "FUNCTION_BLOCK"),
            Wanted::Data | Wanted::Operand => entry.is_data(),
            Wanted::Value => entry.is_data() || entry.keyword() == "FUNCTION",
        }
    }

    fn is_symbol(self, symbol: &Symbol) -> bool {
        use BlockPrefix::{Db, Di, Fb, Fc, Sfb, Sfc};
        match symbol.target {
            SymbolTarget::Block { prefix, .. } => match self {
                Wanted::Code => matches!(prefix, Fc | Fb | Sfc | Sfb),
                Wanted::Data | Wanted::Operand => matches!(prefix, Db | Di),
                Wanted::Value => matches!(prefix, Db | Di | Fc | Sfc),
            },
            SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. } => matches!(self, Wanted::Operand | Wanted::Value),
        }
    }
}

/// Variables and constants of a block with their sign: `#level`.
fn marked_locals(index: &Index, entry: Option<Entry>) -> Vec<CompletionItem> {
    locals(index, entry).into_iter().map(|one| marked(one, "#", "")).collect()
}

/// Blocks, symbols and constants in their quotes: `"Motor"`.
fn marked_globals(index: &Index, wanted: Wanted) -> Vec<CompletionItem> {
    let block = |entry: &Entry| {
        let one = item(&entry.text(), CompletionItemKind::MODULE, entry.keyword());
        match entry.name() {
            BlockName::Symbol { .. } => marked(one, "\"", "\""),
            BlockName::Numbered { .. } => CompletionItem { insert_text: Some(one.label.replace(' ', "")), ..one },
        }
    };
    let tables = &index.checked.tables;
    let symbols = tables.iter().flat_map(|table| &table.symbols).filter(|symbol| wanted.is_symbol(symbol)).map(symbol);
    let constants = tables.iter().flat_map(|table| &table.constants).map(|one| constant(index, Constant::Global(one)));
    let takes_constants = matches!(wanted, Wanted::Operand | Wanted::Value);
    let named = symbols.chain(constants.filter(|_| takes_constants)).map(|one| marked(one, "\"", "\""));
    let mut items: Vec<CompletionItem> =
        index.blocks.iter().filter(|entry| wanted.is_block(entry)).map(block).chain(named).collect();
    // A block of a source has a row in the symbol table, too.
    let mut seen = HashSet::new();
    items.retain(|one| seen.insert(one.label.clone()));
    items
}

/// An item that is found by its name, and written with signs around it.
fn marked(one: CompletionItem, before: &str, after: &str) -> CompletionItem {
    CompletionItem { label: format!("{before}{}{after}", one.label), filter_text: Some(one.label), ..one }
}

/// What the statement of STL around a piece takes there; `None`: nothing that is known.
fn stl_operand(words: &Words, at: usize, set: Mnemonics) -> Option<OperandClass> {
    let before = at.checked_sub(1)?;
    if matches!(words.word(before), ":=" | "=>") {
        return Some(OperandClass::LoadSource);
    }
    let begins = |at: &usize| words.first_on_line(*at) || words.word(at.wrapping_sub(1)) == ";";
    let mut first = (0..=before).rev().find(begins)?;
    if words.word(first + 1) == ":" {
        first += 2;
    }
    let mnemonic = words.word(first);
    if mnemonic.eq_ignore_ascii_case("CALL") {
        // The instance follows a comma.
        return Some(if words.word(before) == "," { OperandClass::DataBlock } else { OperandClass::Block });
    }
    let is_it = |insn: &&StlInsn| insn.mnemonic(set).eq_ignore_ascii_case(mnemonic);
    StlInsn::ALL.iter().find(is_it).filter(|_| first == before).map(|insn| insn.operand())
}

/// Whether an operand can be a variable or a tag.
const fn takes_names(class: OperandClass) -> bool {
    match class {
        OperandClass::Bit
        | OperandClass::BitOrNone
        | OperandClass::BitWrite
        | OperandClass::BitWriteOrCounter
        | OperandClass::BitWriteOrCell
        | OperandClass::LoadSource
        | OperandClass::TransferTarget
        | OperandClass::Timer
        | OperandClass::Counter
        | OperandClass::Cell
        | OperandClass::LoadAr1
        | OperandClass::LoadAr2
        | OperandClass::TransferAr1
        | OperandClass::TransferAr2
        | OperandClass::DataBlock
        | OperandClass::Block => true,
        OperandClass::None
        | OperandClass::PointerOrNone
        | OperandClass::Byte
        | OperandClass::AddConstant
        | OperandClass::WordConstOrNone
        | OperandClass::DwordConstOrNone
        | OperandClass::ShiftCount16
        | OperandClass::ShiftCount32
        | OperandClass::Label => false,
    }
}

/// What can follow the point at a piece.
fn members_before<'c>(index: &Index<'c>, words: &Words, file: FileId, point: usize) -> Vec<Declared<'c>> {
    let Some(owner) = point.checked_sub(1).and_then(|end| words.before_indices(end)) else { return Vec::new() };
    let (first, names) = words.path(owner);
    let entry = index.around(file, words.range(owner).start);
    let local = words.word(first).starts_with('#');
    match along(index, entry, &names, local) {
        Some(Meaning::Variable { declared, .. }) => index.members(&declared.1.ty),
        Some(Meaning::Block(entry)) => match entry.block {
            // `#Sum.` in the function Sum.
            Block::Code(block) if local => block.return_type.as_ref().map_or(Vec::new(), |ty| index.members(ty)),
            Block::Code(_) | Block::Data(_) | Block::Type(_) => index.inside(entry),
        },
        _ => Vec::new(),
    }
}

/// `name := ` for each parameter that the call does not have yet.
fn parameters(index: &Index, words: &Words, file: FileId, at: usize) -> Vec<CompletionItem> {
    let Some(callee) = callee_around(index, words, file, at) else { return Vec::new() };
    let open = open_bracket(words, at).unwrap_or(at);
    let given: Vec<&str> =
        (open..at).filter(|&at| matches!(words.word(at + 1), ":=" | "=>")).map(|at| bare(words.word(at))).collect();
    let language = words.language(open.min(words.pieces.len().saturating_sub(1)));
    let row = |one: &ParameterFacts| {
        let name = one.name_after(&given)?;
        let sign = if one.direction == "OUT" && language != Language::Stl { "=>" } else { ":=" };
        Some(CompletionItem {
            insert_text: Some(format!("{name} {sign} ")),
            sort_text: Some(format!(" {name}")),
            ..item(&name, CompletionItemKind::FIELD, format!("{} {}", one.ty, one.direction).trim_start())
        })
    };
    callee.arguments(index, language).iter().filter_map(row).collect()
}

/// The parameters of the call around a byte.
pub fn signature(index: &Index, words: &Words, file: FileId, byte: usize) -> Option<SignatureHelp> {
    let at = words.before(byte);
    let open = open_bracket(words, at)?;
    let (callee, rows) = match network::signature(words, open) {
        Some(element) => element,
        None => {
            let callee = callee_around(index, words, file, open + 1)?;
            (callee.name(), callee.arguments(index, words.language(open)))
        }
    };
    let texts: Vec<String> = rows.iter().map(ParameterFacts::text).collect();
    let own = directly_in(words, open..at);
    let named = own.iter().rev().find(|&&at| matches!(words.word(at + 1), ":=" | "=>")).map(|&at| bare(words.word(at)));
    let after_comma = at.checked_sub(1).is_some_and(|before| words.word(before) == ",");
    let active = match named {
        Some(name) if !after_comma => rows.iter().position(|row| row.is_called(name)),
        _ => {
            let commas = own.iter().filter(|&&at| words.word(at) == ",").count();
            // Each further value is one more of the numbered ones.
            Some(rows.iter().position(|row| row.is_numbered).map_or(commas, |numbered| commas.min(numbered)))
        }
    };
    Some(help(format!("{callee}({})", texts.join(", ")), &texts, active))
}

/// The pieces of a range that begins with a bracket, without those in brackets in it: in `MAX(LIMIT(1, 2, 3), 4`, one comma.
fn directly_in(words: &Words, range: Range<usize>) -> Vec<usize> {
    let mut depth = 0usize;
    let is_own = |at: &usize| {
        match words.word(*at) {
            "(" | "[" => depth += 1,
            ")" | "]" => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth == 1
    };
    range.filter(is_own).collect()
}

/// The parameters of a call, with the number of the one at the cursor.
pub fn help(label: String, parameters: &[String], active: Option<usize>) -> SignatureHelp {
    let information =
        |label: &String| ParameterInformation { label: ParameterLabel::Simple(label.clone()), documentation: None };
    SignatureHelp {
        signatures: vec![SignatureInformation {
            label,
            documentation: None,
            parameters: Some(parameters.iter().map(information).collect()),
            active_parameter: None,
        }],
        active_signature: Some(0),
        active_parameter: active.map(|active| active as u32),
    }
}
