//! What a word can mean by the place where it stands: many words without `#` and quotes are not names of the block around them.

use std::ops::Range;

use plcc_diag::Span;
use plcc_syntax::ast::{
    Block, DataContent, InitialKind, InitialValue, Path, PathPart, PathRoot, TypeKind, TypeRef, Variable,
};
use plcc_syntax::scl::keyword::Keyword;
use plcc_syntax::{Elementary, Language, stl};

use crate::chart;
use crate::facts::same;
use crate::index::{Declared, Entry, Index};
use crate::words::{Words, bare, is_name};

/// What the first word of a path can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A variable, a constant or a part of the block, or something that the whole program knows.
    Any,
    /// Not a variable of the block, although one may have this name.
    Global,
    /// The type or the initial value of a declaration.
    Declaration,
    /// A word of the language: a mnemonic, an element or a pin of a network, the qualifier of an action.
    Word,
}

/// A rung is not longer than so many pieces.
const RUNG_PIECES_MAX: usize = 4000;

/// What is after these words is about the block, not in it.
const HEADER: [&str; 5] = ["AUTHOR", "FAMILY", "NAME", "VERSION", "TITLE"];

/// The role of a piece that begins a path.
pub fn of(index: &Index, entry: Option<Entry>, words: &Words, at: usize) -> Role {
    let Some(entry) = entry else { return Role::Any };
    let (word, range) = (words.word(at), words.range(at));
    if words.is_asserted(at) {
        return Role::Any;
    }
    if in_declaration(entry, &range) {
        return Role::Declaration;
    }
    // `wire#w1` beside a variable w1.
    if is_wire(words, at) {
        return Role::Word;
    }
    if word.starts_with(['#', '"']) || at > 0 && words.word(at - 1) == "#" {
        return Role::Any;
    }
    let next = words.word(at + 1);
    // `P##list`, `wire#w1`.
    if next.starts_with('#') && words.glued(at + 1) {
        return Role::Word;
    }
    // `AUTHOR : motor`, also in a block with a variable of the name `author`.
    let is_header = |at: usize| {
        let is_one = HEADER.iter().any(|own| own.eq_ignore_ascii_case(words.word(at)));
        is_one && words.first_on_line(at) && matches!(words.word(at + 1), ":" | "=")
    };
    if is_header(at) || at >= 2 && is_header(at - 2) {
        return Role::Word;
    }
    if !matches!(entry.block, Block::Code(_)) {
        return if is_target(entry, &range) { Role::Any } else { Role::Global };
    }
    if matches!(words.language(at), Language::Scl | Language::Sd | Language::Graph) && is_keyword(words, at) {
        return Role::Word;
    }
    match words.language(at) {
        Language::Stl => {
            let begins = words.first_on_line(at) || matches!(words.word(at - 1), ";" | ":");
            let set = index.checked.units.iter().find(|(file, _)| *file == entry.file).map(|(_, unit)| unit.mnemonics);
            if begins || stl::is_operand_word(word, set.unwrap_or_default(), next == "[") {
                Role::Word
            } else {
                Role::Any
            }
        }
        Language::Sd if in_rung(words, at) => Role::Word,
        Language::Scl | Language::Sd if next == "(" && is_value(entry, word) => Role::Global,
        Language::Graph if chart::is_qualifier(entry, &range) => Role::Word,
        Language::Scl | Language::Sd | Language::Graph | Language::S7200 => Role::Any,
    }
}

/// Whether a piece in SCL is a word of the language, also beside a variable with this name: `IF`, `1 TO 5`, `NOT a`. Words of declarations
/// are names among statements.
fn is_keyword(words: &Words, at: usize) -> bool {
    let Some(keyword) = Keyword::from_word(words.word(at)) else { return false };
    let next = words.word(at + 1);
    match keyword {
        Keyword::To | Keyword::By | Keyword::Of | Keyword::Do => at > 0 && ends_value(words.word(at - 1)),
        Keyword::Not => {
            is_name(next) || next.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '(' | '%' | '\''))
        }
        Keyword::Ref => next == "(",
        keyword => !matches!(
            keyword,
            Keyword::Array
                | Keyword::At
                | Keyword::Program
                | Keyword::RefTo
                | Keyword::String
                | Keyword::Struct
                | Keyword::Type
                | Keyword::Wstring
        ),
    }
}

/// Whether a value may end with a piece.
fn ends_value(word: &str) -> bool {
    let is_value = Keyword::from_word(word).is_none_or(|word| matches!(word, Keyword::True | Keyword::False));
    is_value && word.ends_with(|c: char| c.is_alphanumeric() || matches!(c, '_' | '"' | '\'' | ')' | ']' | '^'))
}

/// Whether a word before `:=` or `=>` is the name of a parameter in a call.
pub fn is_argument(entry: Option<Entry>, words: &Words, at: usize, bracket: Option<usize>) -> bool {
    let is_marked = words.word(at).starts_with(['#', '"']) || at > 0 && matches!(words.word(at - 1), "#" | ".");
    let is_bare = !is_marked;
    let is_code = entry.is_some_and(|entry| matches!(entry.block, Block::Code(_)));
    let in_list = bracket.is_some() || words.language(at) == Language::Stl;
    matches!(words.word(at + 1), ":=" | "=>") && is_bare && is_code && in_list
}

/// The component that a piece names in the initial value of a structure: `x` in `pair : Pair := (x := 5)`.
pub fn component<'c>(index: &Index<'c>, entry: Entry<'c>, span: Span) -> Option<Declared<'c>> {
    let declared = entry.variables();
    let found = declared.iter().find_map(|(_, variable)| of_variable(index, variable, span));
    found.or_else(|| match entry.block {
        Block::Data(block) => {
            let whole = match &block.content {
                DataContent::Array(ty, Some(value)) => of_value(index, ty, value, span),
                DataContent::Array(_, None) | DataContent::Struct(_) | DataContent::OfType(_) | DataContent::Empty => {
                    None
                }
            };
            whole.or_else(|| {
                let mut assigned = block.values.iter().filter(|one| contains(one.value.span, &span.range()));
                assigned.find_map(|one| of_value(index, type_of(index, entry, &one.target)?, &one.value, span))
            })
        }
        Block::Code(block) => block.constants.iter().find_map(|constant| {
            let (ty, value) = (constant.ty.as_ref()?, constant.initial.as_ref()?);
            of_value(index, ty, value, span)
        }),
        Block::Type(_) => None,
    })
}

/// The type of the value that a data block gives another start value.
fn type_of<'c>(index: &Index<'c>, entry: Entry<'c>, path: &Path) -> Option<&'c TypeRef> {
    let root = match &path.root {
        PathRoot::Local { name, .. } | PathRoot::Quoted { name, .. } | PathRoot::Bare { name, .. } => name,
        PathRoot::Block(_) => return None,
    };
    let find = |members: Vec<Declared<'c>>, name: &str| {
        members.into_iter().find(|(_, one)| same(&one.name, name)).map(|(_, one)| &one.ty)
    };
    let mut ty = find(index.inside(entry), root)?;
    for part in &path.parts {
        if let PathPart::Member { name, .. } = part {
            ty = find(index.members(ty), name)?;
        }
    }
    Some(ty)
}

fn of_variable<'c>(index: &Index<'c>, variable: &'c Variable, span: Span) -> Option<Declared<'c>> {
    let own = variable.initial.as_ref().and_then(|value| of_value(index, &variable.ty, value, span));
    own.or_else(|| {
        let mut ty = &variable.ty;
        while let TypeKind::Array { element, .. } = &ty.kind {
            ty = element.as_ref();
        }
        match &ty.kind {
            TypeKind::Struct(members) if contains(ty.span, &span.range()) => {
                members.iter().find_map(|member| of_variable(index, member, span))
            }
            _ => None,
        }
    })
}

fn of_value<'c>(index: &Index<'c>, ty: &'c TypeRef, value: &InitialValue, span: Span) -> Option<Declared<'c>> {
    if !contains(value.span, &span.range()) {
        return None;
    }
    match &value.kind {
        InitialKind::Fields(fields) => {
            let members = index.members(ty);
            fields.iter().enumerate().find_map(|(at, (name, inner))| {
                let member = match name {
                    Some(name) => members.iter().find(|(_, one)| same(&one.name, &name.text)),
                    None => members.get(at),
                };
                let (direction, member) = *member?;
                if name.as_ref().is_some_and(|name| name.span == span) {
                    return Some((direction, member));
                }
                of_value(index, &member.ty, inner, span)
            })
        }
        InitialKind::List(values) | InitialKind::Repeat { values, .. } => {
            values.iter().find_map(|inner| of_value(index, ty, inner, span))
        }
        InitialKind::Elements(values) => values.iter().find_map(|(_, inner)| of_value(index, ty, inner, span)),
        InitialKind::Literal(_) | InitialKind::Expr(_) | InitialKind::Operand(_) | InitialKind::Default => None,
    }
}

fn contains(span: Span, range: &Range<usize>) -> bool {
    span.start as usize <= range.start && range.end <= span.end as usize
}

/// Whether a piece is in the type or the initial value of a declaration.
fn in_declaration(entry: Entry, range: &Range<usize>) -> bool {
    let of_type = |ty: &TypeRef| contains(ty.span, range);
    let of_variable = |variable: &Variable| {
        of_type(&variable.ty) || variable.initial.as_ref().is_some_and(|value| contains(value.span, range))
    };
    entry.variables().iter().any(|(_, variable)| of_variable(variable))
        || match entry.block {
            Block::Code(block) => {
                block.return_type.as_ref().is_some_and(of_type)
                    || block.constants.iter().any(|constant| constant.ty.as_ref().is_some_and(of_type))
            }
            Block::Data(block) => match &block.content {
                DataContent::OfType(ty) | DataContent::Array(ty, _) => of_type(ty),
                DataContent::Struct(_) | DataContent::Empty => false,
            },
            Block::Type(block) => block.alias.as_ref().is_some_and(of_type),
        }
}

/// Whether a piece is in the name before `:=` of a value of a data block.
fn is_target(entry: Entry, range: &Range<usize>) -> bool {
    let Block::Data(block) = entry.block else { return false };
    block.values.iter().any(|one| contains(one.span, range) && range.end <= one.value.span.start as usize)
}

/// Whether a piece is the name of a wire: `#w1` of `wire#w1`.
pub fn is_wire(words: &Words, at: usize) -> bool {
    let is_first = |at: usize| words.word(at).eq_ignore_ascii_case("wire");
    words.language(at) == Language::Sd && words.word(at).starts_with('#') && words.glued(at) && is_first(at - 1)
}

/// Whether a piece is between RUNG and END_RUNG.
pub fn in_rung(words: &Words, at: usize) -> bool {
    let mut before = (0..at).rev().take(RUNG_PIECES_MAX).map(|at| words.word(at));
    let last = before.find(|word| ["RUNG", "END_RUNG", "NETWORK"].iter().any(|own| own.eq_ignore_ascii_case(word)));
    last.is_some_and(|word| word.eq_ignore_ascii_case("RUNG"))
}

/// Whether a word is a variable of a block that cannot be called: `min` beside the function MIN.
fn is_value(entry: Entry, word: &str) -> bool {
    let name = bare(word);
    let variables = entry.variables();
    let found = variables.iter().find(|(_, variable)| same(&variable.name, name));
    found.is_some_and(|(_, variable)| match &variable.ty.kind {
        TypeKind::Named(ty) => ty == "TOD" || Elementary::ALL.iter().any(|own| own.name() == ty.as_str()),
        TypeKind::String(_) | TypeKind::WideString(_) | TypeKind::Struct(_) => true,
        TypeKind::Array { .. }
        | TypeKind::OpenArray { .. }
        | TypeKind::Reference(_)
        | TypeKind::Block(_)
        | TypeKind::Error => false,
    })
}
