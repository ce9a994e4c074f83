//! Symbols of a source as addresses, and addresses as symbols.
//!
//! The result is a list of edits of the text: everything but the operands stays as its author wrote it. [`names`] has the symbol tables
//! and the layout of data blocks; [`stl`], [`expression`] (SCL, and operands of networks and charts) and [`s7200`] find the operands.
//!
//! An operand stays where the other form would mean something else: an address has the type of its width alone, so a name of another type
//! stays where types count, in SCL, networks and ANY pointers. The caller compiles both texts and compares.

mod blocks;
mod expression;
pub mod names;
mod s7200;
mod stl;

use std::collections::HashSet;

use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_syntax::Elementary;
use plcc_syntax::ast::{Block, Code as BlockCode, SourceUnit, Width};
use plcc_syntax::stl::Mnemonics;

use names::{Found, Names};

/// What operands become.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum To {
    Absolute,
    Symbolic,
}

/// A part of a source with its new text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edit {
    pub span: Span,
    pub text: String,
}

/// The edits of a source, in the order of the text, and warnings about operands that stay.
pub fn edits(unit: &SourceUnit, names: &Names, to: To) -> (Vec<Edit>, Vec<Diagnostic>) {
    let mut editor = Editor {
        names,
        to,
        set: unit.mnemonics,
        locals: HashSet::new(),
        is_tia: false,
        edits: Vec::new(),
        messages: Vec::new(),
        told: HashSet::new(),
    };
    for block in &unit.blocks {
        editor.block(block);
    }
    if let Some(source) = &unit.s7200 {
        editor.s7200(source);
    }
    let mut edits = editor.edits;
    edits.sort_by_key(|edit| (edit.span.start, edit.span.end));
    // A name that a tree has twice, as `a` and `b` of `a, b : "Tank"`, is in the text once.
    edits.dedup();
    (edits, editor.messages)
}

/// A text with its edits, which are in order and do not overlap.
pub fn apply(text: &str, edits: &[Edit]) -> String {
    let mut out = String::with_capacity(text.len());
    let mut at = 0;
    for edit in edits {
        let range = edit.span.range();
        if range.start < at {
            continue;
        }
        out.push_str(text.get(at..range.start).unwrap_or_default());
        out.push_str(&edit.text);
        at = range.end;
    }
    out.push_str(text.get(at..).unwrap_or_default());
    out
}

/// Collects the edits of one source.
struct Editor<'e> {
    names: &'e Names<'e>,
    to: To,
    set: Mnemonics,
    /// Variables of the block, in small letters: a bare name of one of them is not a symbol.
    locals: HashSet<String>,
    /// The notation of the TIA Portal: `%I0.0`, blocks by name only.
    is_tia: bool,
    edits: Vec<Edit>,
    messages: Vec<Diagnostic>,
    /// Names that a warning was about.
    told: HashSet<String>,
}

impl Editor<'_> {
    fn block(&mut self, block: &Block) {
        self.locals.clear();
        self.is_tia = false;
        self.frame(block);
        let Block::Code(block) = block else { return };
        let variables = block.sections.iter().flat_map(|section| &section.variables).map(|variable| &variable.name);
        let constants = block.constants.iter().map(|constant| &constant.name);
        self.locals = variables.chain(constants).map(|name| name.to_lowercase()).collect();
        match &block.code {
            BlockCode::Stl(networks) => {
                networks.iter().flat_map(|network| &network.statements).for_each(|one| self.stl_statement(one));
            }
            BlockCode::Scl(body) => {
                self.is_tia = body.dialect == plcc_syntax::scl::ast::Dialect::Tia;
                self.scl_statements(&body.statements);
            }
            BlockCode::Graphic(body) => {
                self.is_tia = true;
                body.networks.iter().for_each(|network| self.network(network));
            }
            BlockCode::Chart(body) => self.chart(body),
        }
    }

    fn edit(&mut self, span: Span, text: String) {
        if span.start < span.end {
            self.edits.push(Edit { span, text });
        }
    }

    /// An operand that stays; one warning for each name.
    fn stays(&mut self, span: Span, name: &str, why: &str, help: &str) {
        if self.told.insert(name.to_lowercase()) {
            let mut message = Diagnostic::new(Code::NotConverted, span, format!("`{name}` stays as it is: {why}"));
            message.severity = Severity::Warning;
            self.messages.push(message.label("also at its other places").help(help));
        }
    }

    /// A symbol in the tables; `None` after a warning if it is the name of a block that has no number there.
    fn symbol(&mut self, name: &str, span: Span) -> Option<Found> {
        let found = self.names.target(name);
        if found.is_none() && self.names.is_own_block(name) {
            self.stays(
                span,
                name,
                "no symbol table gives it a number",
                "add it to a symbol table, such as `\"Name\",FC 1`",
            );
        }
        found
    }

    /// Whether an address of that width has the type of what it names, where types count.
    fn is_natural(ty: Option<Elementary>, width: Width) -> bool {
        match ty {
            None => false,
            Some(ty) => matches!(
                (ty, width),
                (Elementary::Bool, Width::Bit)
                    | (Elementary::Byte, Width::Byte)
                    | (Elementary::Word, Width::Word)
                    | (Elementary::Dword, Width::Dword)
            ),
        }
    }

    fn not_natural(&mut self, span: Span, name: &str) {
        let why = "its address would have another type, that of its width alone";
        self.stays(
            span,
            name,
            why,
            "only names of BOOL, BYTE, WORD, DWORD, timers and counters can change where types count",
        );
    }
}
