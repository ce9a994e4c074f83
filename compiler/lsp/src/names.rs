//! What a word means where it stands.

use plcc_diag::{FileId, Span};
use plcc_syntax::Language;
use plcc_syntax::ast::{Block, DataContent, TypeKind};
use plcc_syntax::symbols::{Symbol, SymbolTarget};

use crate::address::{self, Address};
use crate::chart;
use crate::constants::{self, Constant};
use crate::facts::{self, BlockFacts, DataFacts, FunctionFacts, ParameterFacts, Value, same};
use crate::index::{Declared, Entry, Index, numbered};
use crate::labels::{self, Label};
use crate::role::{self, Role};
use crate::words::{Words, bare, is_name};

/// What a word means.
pub enum Meaning<'c> {
    /// A variable, a component or a parameter; `path` is how the program gets there, from a local or a block on.
    Variable {
        declared: Declared<'c>,
        path: Vec<String>,
        owner: Option<Entry<'c>>,
    },
    Block(Entry<'c>),
    /// A block of the library.
    Library(&'c BlockFacts),
    /// A function of SCL.
    Function(&'c FunctionFacts),
    Symbol(&'c Symbol),
    Constant(Constant<'c>),
    Label(Label<'c>),
    /// A step or a transition.
    Chart(chart::Part<'c>),
    Address(Address),
    /// A mnemonic or another word of the language.
    Word(String),
}

impl Meaning<'_> {
    /// Where it is declared.
    pub fn definition(&self) -> Option<Span> {
        match self {
            Meaning::Variable { declared, .. } => Some(declared.1.name_span),
            Meaning::Block(entry) => Some(entry.name().span()),
            Meaning::Symbol(symbol) => Some(symbol.span),
            Meaning::Constant(constant) => Some(constant.span()),
            Meaning::Label(label) => Some(label.span),
            Meaning::Chart(part) => Some(part.span()),
            Meaning::Library(_) | Meaning::Function(_) | Meaning::Address(_) | Meaning::Word(_) => None,
        }
    }
}

/// The meaning of a piece of a file.
pub fn meaning<'c>(index: &Index<'c>, words: &Words, file: FileId, at: usize) -> Option<Meaning<'c>> {
    let word = words.word(at);
    let range = words.range(at);
    let entry = index.around(file, range.start);
    let named = bare(word);
    // What is declared has its name, also if it looks like an address.
    let span = Span::new(file, range);
    if let Some(found) = entry.filter(|_| is_name(word)).and_then(|entry| declared(index, entry, span)) {
        return Some(found);
    }
    if let Some(label) = entry.and_then(|entry| labels::at(entry, words, at)) {
        return Some(Meaning::Label(label));
    }
    if let Some(part) = entry.and_then(|entry| chart::at(index, entry, words, at)) {
        return Some(Meaning::Chart(part));
    }
    let (first, names) = words.path(at);
    let role = role::of(index, entry, words, first);
    // `T1.Q` of an instance T1.
    let is_own = role == Role::Any
        && entry.is_some_and(|entry| {
            let may_be = entry.is_data() || matches!(words.language(at), Language::Scl | Language::Sd);
            may_be && variables(index, entry).iter().any(|(_, variable)| same(&variable.name, word))
        });
    if !is_own && let Some(address) = address_at(words, at) {
        return Some(Meaning::Address(address));
    }
    if !is_own && let Some(entry) = numbered_block(index, words, at) {
        return Some(Meaning::Block(entry));
    }
    if !is_name(word) {
        return match words.language(at) {
            Language::Stl => Some(Meaning::Word(mnemonic_at(words, at))),
            Language::S7200 => mnemonic_of_line(words, at).map(Meaning::Word),
            Language::Scl | Language::Sd | Language::Graph => None,
        };
    }
    if matches!(words.word(at + 1), ":=" | "=>") {
        if let Some(entry) = entry
            && let Some(declared) = role::component(index, entry, span)
        {
            return Some(Meaning::Variable { declared, path: vec![named.to_owned()], owner: None });
        }
        if role != Role::Declaration
            && let Some(callee) = callee_around(index, words, file, at)
            && let Some(declared) = callee.variables(index).into_iter().find(|(_, one)| same(&one.name, named))
        {
            return Some(Meaning::Variable { declared, path: vec![named.to_owned()], owner: callee.entry() });
        }
        // A parameter of the library, or a pin of an element.
        if role == Role::Any && role::is_argument(entry, words, at, open_bracket(words, at)) {
            return None;
        }
    }
    let local = word.starts_with('#') || first > 0 && words.word(first) == "#";
    let local = local || words.word(first).starts_with('#');
    let found = match role {
        Role::Any => along(index, entry, &names, local),
        Role::Global => along(index, None, &names, false),
        Role::Declaration => in_declaration(index, entry, &names),
        Role::Word => None,
    };
    if let Some(function) = function(index, words, at, found.as_ref()) {
        return Some(Meaning::Function(function));
    }
    if found.is_some() {
        return found;
    }
    let mnemonic = !word.starts_with(['#', '"']) && names.len() == 1 && !local;
    let of_line = || mnemonic_of_line(words, at).filter(|_| words.language(at) == Language::S7200);
    mnemonic.then(|| Meaning::Word(of_line().unwrap_or_else(|| mnemonic_at(words, at))))
}

/// The function of SCL that a piece calls. What else has its name goes before it only if it can be called, and blocks of the library do not.
fn function<'c>(index: &Index<'c>, words: &Words, at: usize, found: Option<&Meaning>) -> Option<&'c FunctionFacts> {
    let is_taken = match found {
        Some(Meaning::Variable { .. } | Meaning::Block(_)) => true,
        Some(Meaning::Symbol(symbol)) => matches!(symbol.target, SymbolTarget::Block { .. }),
        Some(
            Meaning::Library(_)
            | Meaning::Function(_)
            | Meaning::Constant(_)
            | Meaning::Label(_)
            | Meaning::Chart(_)
            | Meaning::Address(_)
            | Meaning::Word(_),
        )
        | None => false,
    };
    let can_call = match words.language(at) {
        Language::Scl | Language::Graph => true,
        Language::Sd => !role::in_rung(words, at),
        Language::Stl | Language::S7200 => false,
    };
    let word = words.word(at);
    let is_part = at.checked_sub(1).is_some_and(|before| matches!(words.word(before), "." | "#"));
    if is_taken || !can_call || is_part || word.starts_with(['#', '"']) || words.word(at + 1) != "(" {
        return None;
    }
    index.checked.facts.function(word)
}

/// The variables that a block calls by their names alone; the values of a data block are those of its type.
fn variables<'c>(index: &Index<'c>, entry: Entry<'c>) -> Vec<Declared<'c>> {
    if entry.is_data() { index.inside(entry) } else { entry.variables() }
}

/// What a block declares at a place: itself, a variable or a constant.
fn declared<'c>(index: &Index<'c>, entry: Entry<'c>, span: Span) -> Option<Meaning<'c>> {
    if entry.name().span().range() == span.range() {
        return Some(Meaning::Block(entry));
    }
    if let Some(declared) = index.declared_at(entry, span) {
        return Some(Meaning::Variable { declared, path: vec![declared.1.name.clone()], owner: Some(entry) });
    }
    let constant = constants::of(entry).iter().find(|constant| constant.name_span == span);
    constant.map(|constant| Meaning::Constant(Constant::Local(entry, constant)))
}

/// The meaning of a path of names in a type or an initial value: no variable can stand there.
fn in_declaration<'c>(index: &Index<'c>, entry: Option<Entry<'c>>, names: &[&str]) -> Option<Meaning<'c>> {
    let [.., name] = names else { return None };
    let constant = entry.and_then(|entry| constants::named(entry, bare(name)));
    if let Some(constant) = constant.filter(|_| !name.starts_with('"')) {
        return Some(Meaning::Constant(constant));
    }
    // `_.Motor`
    let is_type = matches!(names, [_] | ["_", _]);
    let typed = index.typed(bare(name)).filter(|_| is_type).map(Meaning::Block);
    // A tag stands neither for a type nor for an initial value: beside a tag `Bool`, `Bool` is still the type.
    let is_block = |symbol: &Symbol| matches!(symbol.target, SymbolTarget::Block { .. });
    let is_tag = |found: &Meaning| matches!(found, Meaning::Symbol(symbol) if !is_block(symbol));
    typed.or_else(|| along(index, None, names, false).filter(|found| !is_tag(found)))
}

/// The step or transition of which a component follows the point at a piece.
pub fn part_before<'c>(index: &Index<'c>, words: &Words, file: FileId, point: usize) -> Option<chart::Part<'c>> {
    let owner = point.checked_sub(1)?;
    let (first, names) = words.path(owner);
    let entry = index.around(file, words.range(owner).start);
    let Some(Meaning::Chart(part)) = along(index, entry, &names, words.word(first).starts_with('#')) else {
        return None;
    };
    Some(part)
}

/// The values in what is before the point at a piece, as binding found them: those in an instance of a library block, too.
pub fn values_before<'c>(index: &Index<'c>, words: &Words, file: FileId, point: usize) -> Option<&'c [Value]> {
    let owner = words.before_indices(point.checked_sub(1)?)?;
    let (first, names) = words.path(owner);
    let entry = index.around(file, words.range(owner).start);
    match along(index, entry, &names, words.word(first).starts_with('#'))? {
        Meaning::Variable { path, owner, .. } => Some(&value_of(index, owner?, &path)?.members),
        Meaning::Block(entry) => Some(&data_facts(index, entry)?.members),
        Meaning::Library(_)
        | Meaning::Function(_)
        | Meaning::Symbol(_)
        | Meaning::Constant(_)
        | Meaning::Label(_)
        | Meaning::Chart(_)
        | Meaning::Address(_)
        | Meaning::Word(_) => None,
    }
}

/// What binding found out about a variable that a path leads to from a block.
fn value_of<'c>(index: &Index<'c>, owner: Entry<'c>, path: &[String]) -> Option<&'c Value> {
    let names: Vec<&str> = path.iter().map(String::as_str).collect();
    let found = match data_facts(index, owner) {
        Some(db) => facts::find(&db.members, &names).or_else(|| facts::find(&db.members, names.get(1..)?)),
        None => facts::find(&index.checked.facts.block(&owner.text())?.instance, &names),
    };
    found.map(|(value, _)| value)
}

fn data_facts<'c>(index: &Index<'c>, entry: Entry<'c>) -> Option<&'c DataFacts> {
    let (key, facts) = (entry.text(), &index.checked.facts);
    if entry.is_data() { facts.db(&key.replace(' ', "")).or_else(|| facts.db(&key)) } else { None }
}

/// The block of the library with a key, `SFB 4`.
fn library<'c>(index: &Index<'c>, key: &str) -> Option<Callee<'c>> {
    index.checked.facts.blocks.iter().find(|block| block.key == key).map(Callee::Library)
}

/// The meaning of a path of names that begins in a block.
pub fn along<'c>(index: &Index<'c>, entry: Option<Entry<'c>>, names: &[&str], local: bool) -> Option<Meaning<'c>> {
    let (root, rest) = names.split_first()?;
    let own = entry.and_then(|entry| {
        let found = variables(index, entry).into_iter().find(|(_, variable)| same(&variable.name, bare(root)))?;
        Some((found, entry))
    });
    let own = own.filter(|_| local || !root.starts_with('"'));
    let is_global =
        || root.starts_with('"') && (index.block(bare(root)).is_some() || index.symbol(bare(root)).is_some());
    if own.is_none()
        && rest.is_empty()
        && let Some(constant) = entry.and_then(|entry| constants::named(entry, bare(root)))
        && (local || !is_global())
    {
        return Some(Meaning::Constant(constant));
    }
    if own.is_none()
        && rest.is_empty()
        && let Some(part) = entry.and_then(|entry| chart::named(entry, bare(root)))
        && (local || !is_global())
    {
        return Some(Meaning::Chart(part));
    }
    let path = || names.iter().map(|name| bare(name).to_owned()).collect();
    let (mut members, mut around, owner) = match own {
        Some((declared, entry)) if rest.is_empty() => {
            return Some(Meaning::Variable { declared, path: path(), owner: Some(entry) });
        }
        Some((declared, entry)) => (index.members(&declared.1.ty), index.block_of(&declared.1.ty), Some(entry)),
        // `#Sum := 1` in the function Sum: its result, which may have components.
        None if local => {
            let is_own = |entry: &Entry| entry.keyword() == "FUNCTION" && same(&entry.text(), bare(root));
            let entry = entry.filter(is_own)?;
            let Block::Code(block) = entry.block else { return None };
            match &block.return_type {
                _ if rest.is_empty() => return Some(Meaning::Block(entry)),
                Some(ty) => (index.members(ty), index.block_of(ty), Some(entry)),
                None => return None,
            }
        }
        None => match (index.block(bare(root)), index.symbol(bare(root))) {
            (Some(entry), _) if rest.is_empty() => return Some(Meaning::Block(entry)),
            (None, Some(symbol)) if rest.is_empty() => return Some(Meaning::Symbol(symbol)),
            (None, None) if rest.is_empty() => {
                let constant = index.constant(bare(root)).map(|constant| Meaning::Constant(Constant::Global(constant)));
                return constant.or_else(|| index.checked.facts.block(bare(root)).map(Meaning::Library));
            }
            (Some(entry), _) => (index.inside(entry), Some(index.instance_of(entry)), Some(entry)),
            (None, _) => return None,
        },
    };
    for (at, name) in rest.iter().enumerate() {
        let is_last = at + 1 == rest.len();
        let Some(declared) = members.into_iter().find(|(_, variable)| same(&variable.name, bare(name))) else {
            let part = around.filter(|_| is_last).and_then(|entry| chart::in_instance(entry, bare(name)));
            return part.map(Meaning::Chart);
        };
        if is_last {
            return Some(Meaning::Variable { declared, path: path(), owner });
        }
        members = index.members(&declared.1.ty);
        around = index.block_of(&declared.1.ty);
    }
    None
}

/// The address that a piece is part of.
fn address_at(words: &Words, at: usize) -> Option<Address> {
    (at.saturating_sub(4)..=at).find_map(|first| address::at(words, first).filter(|found| first + found.pieces > at))
}

/// `FC 1` in two pieces, or `FC1`.
fn numbered_block<'c>(index: &Index<'c>, words: &Words, at: usize) -> Option<Entry<'c>> {
    let word = words.word(at);
    if word.starts_with(['"', '#']) || at > 0 && words.word(at - 1) == "#" && words.glued(at) {
        return None;
    }
    let joined = |first: usize| {
        let letters = words.word(first);
        let is_prefix =
            ["OB", "FC", "FB", "SFC", "SFB", "DB", "DI", "UDT"].iter().any(|own| own.eq_ignore_ascii_case(letters));
        is_prefix.then(|| format!("{letters}{}", words.word(first + 1)))
    };
    let text = joined(at).or_else(|| joined(at.checked_sub(1)?)).unwrap_or_else(|| word.to_owned());
    numbered(&text).and_then(|_| index.block(&text))
}

/// The mnemonic at the beginning of a line of an S7-200, if the piece is part of it: `LDW>=`, `+I`, `=`.
fn mnemonic_of_line(words: &Words, at: usize) -> Option<String> {
    const PIECES_MAX: usize = 3;
    let sign = |word: &str| matches!(word, "+" | "-" | "*" | "/" | "=" | "<>" | ">" | "<" | ">=" | "<=");
    let first = (0..=at).rev().take(PIECES_MAX).find(|at| words.first_on_line(*at))?;
    let mut text = words.word(first).to_ascii_uppercase();
    let mut next = first + 1;
    while next < first + PIECES_MAX && words.glued(next) {
        let word = words.word(next).to_ascii_uppercase();
        let is_after_sign = sign(&text) && matches!(word.as_str(), "I" | "D" | "R");
        if !(sign(&word) || is_after_sign) {
            break;
        }
        text.push_str(&word);
        next += 1;
    }
    (at < next).then_some(text)
}

/// A mnemonic with its signs: `A(`, `+I`, `==I`.
fn mnemonic_at(words: &Words, at: usize) -> String {
    let sign = |word: &str| matches!(word, "+" | "-" | "*" | "/" | "==" | "<>" | ">" | "<" | ">=" | "<=");
    let mut text = words.word(at).to_ascii_uppercase();
    if words.glued(at) && sign(words.word(at - 1)) {
        text.insert_str(0, words.word(at - 1));
    }
    let next = words.word(at + 1);
    if words.glued(at + 1) && (next == "(" || sign(&text) && matches!(next, "I" | "D" | "R")) {
        text.push_str(next);
    }
    text
}

/// What is called.
pub enum Callee<'c> {
    Source(Entry<'c>),
    Library(&'c BlockFacts),
    Function(&'c FunctionFacts),
}

impl<'c> Callee<'c> {
    pub fn entry(&self) -> Option<Entry<'c>> {
        match self {
            Callee::Source(entry) => Some(*entry),
            Callee::Library(_) | Callee::Function(_) => None,
        }
    }

    /// The declared parameters.
    pub fn variables(&self, index: &Index<'c>) -> Vec<Declared<'c>> {
        let all = self.entry().map_or(Vec::new(), |entry| index.inside(entry));
        all.into_iter().filter(|(direction, _)| matches!(*direction, "IN" | "OUT" | "IN_OUT")).collect()
    }

    /// The parameters, in order.
    pub fn parameters(&self, index: &Index<'c>) -> Vec<ParameterFacts> {
        match self {
            Callee::Source(_) => {
                let declared = |(direction, variable): Declared<'c>| ParameterFacts {
                    name: variable.name.clone(),
                    direction,
                    ty: index.type_text(&variable.ty),
                    ..ParameterFacts::default()
                };
                self.variables(index).into_iter().map(declared).collect()
            }
            Callee::Library(facts) => facts.parameters.clone(),
            Callee::Function(facts) => facts.parameters.clone(),
        }
    }

    /// What a call can name, in order: in STL and networks the value of a function, too.
    pub fn arguments(&self, index: &Index<'c>, language: Language) -> Vec<ParameterFacts> {
        let mut all = self.parameters(index);
        let result = self.entry().and_then(|entry| entry.return_type());
        if let (Some(ty), Language::Stl | Language::Sd) = (result, language) {
            let (name, ty) = ("RET_VAL".to_owned(), index.type_text(ty));
            all.push(ParameterFacts { name, direction: "OUT", ty, ..ParameterFacts::default() });
        }
        all
    }

    pub fn name(&self) -> String {
        match self {
            Callee::Source(entry) => entry.text(),
            Callee::Library(facts) if facts.name.is_empty() => facts.key.clone(),
            Callee::Library(facts) => facts.name.clone(),
            Callee::Function(facts) => facts.name.clone(),
        }
    }
}

/// The bracket around a piece that is not closed before it.
pub fn open_bracket(words: &Words, at: usize) -> Option<usize> {
    let mut depth = 0usize;
    for before in (0..at.min(words.pieces.len())).rev() {
        match words.word(before) {
            ")" => depth += 1,
            "(" if depth == 0 => return Some(before),
            "(" => depth -= 1,
            ";" => return None,
            word if word.get(..4).is_some_and(|start| start.eq_ignore_ascii_case("END_")) => return None,
            _ => {}
        }
    }
    None
}

/// The block that is called by the parameters around a piece.
pub fn callee_around<'c>(index: &Index<'c>, words: &Words, file: FileId, at: usize) -> Option<Callee<'c>> {
    if words.language(at.min(words.pieces.len().saturating_sub(1))) == Language::Stl {
        // `CALL target, instance (`; the list may have no brackets.
        let call = (0..at.min(words.pieces.len()))
            .rev()
            .take(600)
            .find(|&before| words.word(before).eq_ignore_ascii_case("CALL"))?;
        let target = if words.word(call + 1) == "#" { call + 2 } else { call + 1 };
        return callee_at(index, words, file, target);
    }
    let open = open_bracket(words, at)?;
    callee_at(index, words, file, words.before_indices(open.checked_sub(1)?)?)
}

/// The block that a name calls: itself, or that of the instance.
fn callee_at<'c>(index: &Index<'c>, words: &Words, file: FileId, at: usize) -> Option<Callee<'c>> {
    if let Some(entry) = numbered_block(index, words, at) {
        return Some(called(index, entry));
    }
    let two = format!("{} {}", words.word(at).to_ascii_uppercase(), words.word(at + 1));
    if let Some(facts) = index.checked.facts.blocks.iter().find(|block| block.key == two) {
        return Some(Callee::Library(facts));
    }
    let (first, names) = words.path(at);
    let local = words.word(first).starts_with('#');
    // `#t.TON( … )` of a timer whose type is that of several blocks. In a network it is an element, whose pins have names of their own.
    let instruction = || match &names[..] {
        [_, .., last] if words.language(at) == Language::Scl => index.checked.facts.block(last).map(Meaning::Library),
        [..] => None,
    };
    // `LIMIT(` beside a variable `limit`.
    let entry = index.around(file, words.range(at).start);
    let entry = entry.filter(|_| role::of(index, entry, words, first) != Role::Global);
    let found = along(index, entry, &names, local);
    if let Some(function) = function(index, words, at, found.as_ref()) {
        return Some(Callee::Function(function));
    }
    match found.or_else(instruction)? {
        Meaning::Block(entry) => Some(called(index, entry)),
        Meaning::Library(facts) => Some(Callee::Library(facts)),
        Meaning::Symbol(symbol) => match symbol.target {
            SymbolTarget::Block { prefix, number } => library(index, &format!("{} {number}", prefix.letters())),
            SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. } => None,
        },
        Meaning::Variable { declared, path, owner } => {
            if let Some(entry) = index.block_of(&declared.1.ty) {
                return Some(called(index, entry));
            }
            // The type has another name than the block: `TON_TIME`.
            let value = owner.and_then(|owner| value_of(index, owner, &path));
            if let Some(block) = value.and_then(|value| library(index, &value.instance_of)) {
                return Some(block);
            }
            let mut ty = &declared.1.ty;
            while let TypeKind::Array { element, .. } = &ty.kind {
                ty = element.as_ref();
            }
            let ty = index.type_text(ty);
            index.checked.facts.block(bare(ty.trim_end_matches(';').trim())).map(Callee::Library)
        }
        Meaning::Function(_)
        | Meaning::Constant(_)
        | Meaning::Label(_)
        | Meaning::Chart(_)
        | Meaning::Address(_)
        | Meaning::Word(_) => None,
    }
}

/// The block of an instance; otherwise the block itself.
fn called<'c>(index: &Index<'c>, entry: Entry<'c>) -> Callee<'c> {
    if let Block::Data(block) = entry.block
        && let DataContent::OfType(ty) = &block.content
    {
        if let Some(of) = index.block_of(ty) {
            return Callee::Source(of);
        }
        let ty = index.type_text(ty);
        if let Some(facts) = index.checked.facts.block(bare(&ty)) {
            return Callee::Library(facts);
        }
        if let Some(block) = data_facts(index, entry).and_then(|db| library(index, &db.instance_of)) {
            return block;
        }
    }
    Callee::Source(entry)
}
