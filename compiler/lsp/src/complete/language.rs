//! What each language has for a place: mnemonics, keywords, elements and names in its form.

use std::collections::HashSet;

use lsp_types::{CompletionItem, CompletionItemKind};
use plcc_syntax::ast::{BlockName, BlockPrefix};
use plcc_syntax::network::elements::{self, PinDirection, PinRow};
use plcc_syntax::scl::keyword::Keyword;
use plcc_syntax::stl::{Mnemonics, OperandClass, StlInsn};
use plcc_syntax::symbols::{Symbol, SymbolTarget};
use plcc_syntax::{Language, s7200};

use super::{constant, function, item, locals, symbol};
use crate::chart::{self, Part};
use crate::constants::Constant;
use crate::index::{Entry, Index};
use crate::labels;
use crate::names::open_bracket;
use crate::network;
use crate::role::in_rung;
use crate::words::Words;

/// Words of SCL that the grammar reads as lines of their own.
const REGION: [&str; 2] = ["REGION", "END_REGION"];

/// A place where something can be written that is not told by the sign before it.
pub(super) struct Place<'w> {
    pub(super) words: &'w Words<'w>,
    /// The word that is written, or the one after the place.
    pub(super) first: usize,
    /// The word before.
    pub(super) before: &'w str,
    /// The block around it.
    pub(super) entry: Option<Entry<'w>>,
    pub(super) set: Mnemonics,
    /// A statement of STL can begin there.
    pub(super) is_statement: bool,
}

/// What a language has for a place.
pub(super) fn of_language(index: &Index, language: Language, place: Place) -> Vec<CompletionItem> {
    let Place { words, first, before, entry, set, is_statement } = place;
    let mut items = Vec::new();
    match language {
        Language::Stl if is_statement => items.extend(StlInsn::ALL.iter().map(|insn| CompletionItem {
            label: insn.mnemonic(set).to_owned(),
            kind: Some(CompletionItemKind::OPERATOR),
            detail: Some(insn.doc().trim().to_owned()),
            ..CompletionItem::default()
        })),
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
