//! Symbols and addresses of a program: what stands above and below a contact, and by which key a value and the uses of an address are found.

use std::collections::{HashMap, HashSet};

use plcc_abi::image::BlockKind;
use plcc_model::types::{ArrayType, DataType, Elementary, Member};
use plcc_model::{BlockKey, DataBlock, Direction, Program, layout};

use crate::sheet::Label;

/// Where names lead.
#[derive(Default)]
pub struct Names {
    /// Symbols in lower case, with their addresses.
    addresses: HashMap<String, String>,
    /// The symbol of an address.
    symbols: HashMap<String, String>,
    dbs: Vec<Db>,
    /// FBs of which a data block has an instance inside.
    inner: HashSet<BlockKey>,
    /// Names of blocks that have one.
    blocks: HashMap<BlockKey, String>,
    /// Variables of the instances and the local data of FBs.
    locals: HashMap<BlockKey, Vec<Member>>,
    /// Parameters of FCs and FBs by the names of the blocks in quotes, and by numbers such as `fb7`, in lower case.
    parameters: HashMap<String, Vec<Formal>>,
    /// Addresses of symbols that are floating-point numbers.
    floats: HashSet<String>,
}

/// A pin that a box can have.
#[derive(Clone, Debug)]
pub struct Formal {
    pub name: String,
    pub output: bool,
    /// Whether the box shows it if nothing is connected to it.
    pub always: bool,
}

/// A data block.
struct Db {
    number: u16,
    name: String,
    instance_of: Option<BlockKey>,
    members: Vec<Member>,
}

/// The block whose local names are meant.
#[derive(Clone, Copy, Debug, Default)]
pub struct Scope {
    /// The instance DB that its static variables are in, if it has only one.
    pub(crate) instance: Option<usize>,
    pub(crate) block: Option<BlockKey>,
    /// Addresses are written in the German set of mnemonics.
    pub german: bool,
}

impl Names {
    /// The names of a bound program.
    pub fn of(program: &Program) -> Names {
        let mut names = Names::default();
        for symbol in &program.symbols {
            let address = canonical(&symbol.address, false).unwrap_or_else(|| symbol.address.clone());
            names.symbols.entry(address.clone()).or_insert_with(|| symbol.name.clone());
            if symbol.ty.as_ref().is_some_and(is_float) {
                names.floats.insert(address.clone());
            }
            names.addresses.insert(symbol.name.to_lowercase(), address);
        }
        names.dbs = program.dbs.iter().map(db).collect();
        names.dbs.iter().for_each(|db| inner_instances(&db.members, &mut names.inner));
        let named = program.blocks.iter().filter(|block| !block.name.is_empty());
        names.blocks = named.map(|block| (block.key(), block.name.clone())).collect();
        for block in &program.blocks {
            let variables = block.interface.instance.iter().chain(&block.interface.temporaries);
            names.locals.insert(block.key(), variables.cloned().collect());
            if matches!(block.key().kind, BlockKind::Fb | BlockKind::Fc) {
                let formals = block.interface.parameters.iter().map(|parameter| Formal {
                    name: parameter.name.clone(),
                    output: parameter.direction == Direction::Output,
                    always: true,
                });
                let mut formals: Vec<Formal> = formals.collect();
                // The editors draw the result above the other outputs.
                formals.sort_by_key(|formal| block.key().kind != BlockKind::Fc || formal.name != "RET_VAL");
                names.parameters.insert(format!("\"{}\"", block.name.to_lowercase()), formals.clone());
                names.parameters.insert(block.key().to_string().replace(' ', "").to_lowercase(), formals);
            }
        }
        names
    }

    /// The name of the FB whose instance `text` names, as it is written in its box: a data block, a variable or an element of an array.
    pub fn block_of_instance(&self, text: &str, scope: Scope) -> Option<String> {
        let (local, parts) = path(&without_indices(text))?;
        let db = match &parts[..] {
            [name] if !local => self.dbs.iter().find(|db| db.name.eq_ignore_ascii_case(name)),
            _ => None,
        };
        let of_variable = || instance_of(self.type_named(local, &parts, scope)?);
        let block = db.and_then(|db| db.instance_of).or_else(of_variable)?;
        Some(match self.blocks.get(&block) {
            // Instructions of the system have no quotes.
            Some(name) if block.kind == BlockKind::Sfb => name.clone(),
            Some(name) => format!("\"{name}\""),
            None => block.to_string(),
        })
    }

    /// The parameters of an FC or FB as its box names it: `"Motor"`, `FB 7`.
    pub fn parameters(&self, block: &str) -> Option<&[Formal]> {
        let own = if block.starts_with('"') { block.to_lowercase() } else { block.replace(' ', "").to_lowercase() };
        self.parameters.get(&own).map(Vec::as_slice)
    }

    /// The symbols and their addresses, in order of the addresses.
    pub fn symbols(&self) -> Vec<(&str, &str)> {
        let mut list: Vec<(&str, &str)> =
            self.symbols.iter().map(|(address, name)| (address.as_str(), name.as_str())).collect();
        list.sort_unstable();
        list
    }

    /// The scope of a block.
    pub fn scope(&self, block: BlockKey, german: bool) -> Scope {
        let mut instances = self.dbs.iter().enumerate().filter(|(_, db)| db.instance_of == Some(block));
        let instance = match (instances.next(), instances.next()) {
            (Some((at, _)), None) if !self.inner.contains(&block) => Some(at),
            _ => None,
        };
        Scope { instance, block: Some(block), german }
    }

    /// An operand as it is drawn: `"Start"` with I0.0 below, `#Level`, `I0.0` with the symbol that it has.
    pub fn label(&self, text: &str, scope: Scope) -> Label {
        let text = text.trim();
        let bare = text.strip_prefix('%').unwrap_or(text);
        if let Some(address) = canonical(bare, scope.german) {
            // `DB10.%DBX2.0` of the TIA Portal.
            let bare = bare.replace(".%", ".");
            // What a tree says of an address has international letters.
            let bare = if text.starts_with('%') { written(&bare, scope.german) } else { bare };
            return match self.symbols.get(&address) {
                Some(symbol) => {
                    Label { text: format!("\"{symbol}\""), address: bare, key: address, value: None, place: None }
                }
                None => Label { text: bare, address: String::new(), key: address, value: None, place: None },
            };
        }
        let key = self.key(text, scope).unwrap_or_default();
        let is_tag = !key.is_empty() && self.symbols.contains_key(&key) && !key.starts_with("DB");
        let address = if is_tag { written(&key, scope.german) } else { String::new() };
        Label { text: text.to_string(), address, key, value: None, place: None }
    }

    /// The address of what `text` names; a local variable without a known address is its own key.
    pub fn key(&self, text: &str, scope: Scope) -> Option<String> {
        let text = text.trim();
        if let Some(address) = canonical(text.strip_prefix('%').unwrap_or(text), scope.german) {
            return Some(address);
        }
        let (local, parts) = path(text)?;
        let (root, rest) = parts.split_first()?;
        if !local {
            if let Some(address) = self.addresses.get(&root.to_lowercase()) {
                let is_db = address.strip_prefix("DB").is_some_and(|rest| rest.bytes().all(|b| b.is_ascii_digit()));
                if !is_db {
                    return rest.is_empty().then(|| address.clone());
                }
            }
            if let Some(db) = self.db_named(root) {
                return match rest.is_empty() {
                    true => Some(format!("DB{}", db.number)),
                    false => address_in(db, rest),
                };
            }
        }
        if let Some(db) = scope.instance.and_then(|at| self.dbs.get(at))
            && let Some(address) = address_in(db, &parts)
        {
            return Some(address);
        }
        let name = parts.join(".").replace(".[", "[");
        local.then(|| format!("#{name}"))
    }

    fn db_named(&self, root: &str) -> Option<&Db> {
        self.dbs.iter().find(|db| {
            db.name.eq_ignore_ascii_case(root)
                || root.eq_ignore_ascii_case(&format!("DB{}", db.number))
                || self.addresses.get(&root.to_lowercase()).is_some_and(|a| *a == format!("DB{}", db.number))
        })
    }

    /// Whether `text` names a floating-point number, or an array of them.
    pub fn is_float(&self, text: &str, scope: Scope) -> bool {
        let text = text.trim();
        if let Some(address) = canonical(text.strip_prefix('%').unwrap_or(text), scope.german) {
            return self.floats.contains(&address);
        }
        let Some((local, parts)) = path(text) else { return false };
        let Some((root, rest)) = parts.split_first() else { return false };
        if !local {
            if self.addresses.get(&root.to_lowercase()).is_some_and(|address| self.floats.contains(address)) {
                return rest.is_empty();
            }
            if let Some(db) = self.db_named(root) {
                return type_of(&db.members, rest).is_some_and(is_float);
            }
        }
        self.type_named(true, &parts, scope).is_some_and(is_float)
    }

    /// The type of a variable of the block, if the path is local, or of a component of a data block. Indices of arrays are left out.
    fn type_named(&self, local: bool, parts: &[String], scope: Scope) -> Option<&DataType> {
        if local {
            return type_of(self.locals.get(&scope.block?)?, parts);
        }
        let (root, rest) = parts.split_first()?;
        type_of(&self.db_named(root)?.members, rest)
    }
}

/// The block of which values of a type are instances; of an array those in it.
fn instance_of(ty: &DataType) -> Option<BlockKey> {
    match ty {
        DataType::Struct(structure) => structure.instance_of.map(|(is_system, number)| {
            let kind = if is_system { BlockKind::Sfb } else { BlockKind::Fb };
            BlockKey { kind, number }
        }),
        DataType::Array(array) => instance_of(&array.element),
        DataType::OpenArray(_)
        | DataType::Elementary(_)
        | DataType::DateAndTime
        | DataType::String(_)
        | DataType::WideString(_)
        | DataType::Parameter(_)
        | DataType::Void => None,
    }
}

/// Adds the blocks of which members are instances, at any depth.
fn inner_instances(members: &[Member], found: &mut HashSet<BlockKey>) {
    for member in members {
        let mut ty = &member.ty;
        while let DataType::Array(array) = ty {
            ty = &array.element;
        }
        if let DataType::Struct(structure) = ty {
            found.extend(instance_of(ty));
            inner_instances(&structure.members, found);
        }
    }
}

/// Whether values of a type are floating-point numbers; of an array those in it.
fn is_float(ty: &DataType) -> bool {
    match ty {
        DataType::Elementary(ty) => matches!(ty, Elementary::Real | Elementary::Lreal),
        DataType::Array(array) => is_float(&array.element),
        DataType::OpenArray(array) => is_float(&array.element),
        DataType::Struct(_)
        | DataType::DateAndTime
        | DataType::String(_)
        | DataType::WideString(_)
        | DataType::Parameter(_)
        | DataType::Void => false,
    }
}

/// The type of the member at the end of a path. Indices of arrays are left out.
fn type_of<'m>(members: &'m [Member], path: &[String]) -> Option<&'m DataType> {
    let (first, rest) = path.split_first()?;
    let mut ty = &members.iter().find(|member| member.name.eq_ignore_ascii_case(first))?.ty;
    if rest.is_empty() {
        return Some(ty);
    }
    while let DataType::Array(array) = ty {
        ty = &array.element;
    }
    match ty {
        DataType::Struct(structure) => type_of(&structure.members, rest),
        DataType::Array(_)
        | DataType::OpenArray(_)
        | DataType::Elementary(_)
        | DataType::DateAndTime
        | DataType::String(_)
        | DataType::WideString(_)
        | DataType::Parameter(_)
        | DataType::Void => None,
    }
}

fn db(db: &DataBlock) -> Db {
    Db { number: db.number, name: db.name.clone(), instance_of: db.instance_of, members: db.members.clone() }
}

/// The address of a member: `DB10.DBX2.1`.
fn address_in(db: &Db, path: &[String]) -> Option<String> {
    let (first, rest) = path.split_first()?;
    let member = db.members.iter().find(|member| member.name.eq_ignore_ascii_case(first))?;
    walk(db.number, &member.ty, member.byte, member.bit, rest)
}

fn walk(number: u16, ty: &DataType, byte: u32, bit: u8, path: &[String]) -> Option<String> {
    let Some((first, rest)) = path.split_first() else {
        let DataType::Elementary(elementary) = ty else { return Some(format!("DB{number}.DBB{byte}")) };
        return Some(match elementary.bits() {
            1 => format!("DB{number}.DBX{byte}.{bit}"),
            8 => format!("DB{number}.DBB{byte}"),
            16 => format!("DB{number}.DBW{byte}"),
            32 => format!("DB{number}.DBD{byte}"),
            _ => format!("DB{number}.DBL{byte}"),
        });
    };
    match ty {
        DataType::Struct(structure) => {
            let member = structure.members.iter().find(|member| member.name.eq_ignore_ascii_case(first))?;
            walk(number, &member.ty, byte.checked_add(member.byte)?, member.bit, rest)
        }
        DataType::Array(array) => {
            let (offset, bit) = element(array, first)?;
            walk(number, &array.element, byte.checked_add(offset)?, bit, rest)
        }
        DataType::Elementary(_)
        | DataType::DateAndTime
        | DataType::String(_)
        | DataType::WideString(_)
        | DataType::Parameter(_)
        | DataType::OpenArray(_)
        | DataType::Void => None,
    }
}

/// Byte and bit of the element with these indices: `[2,1]`.
fn element(array: &ArrayType, indices: &str) -> Option<(u32, u8)> {
    let indices: Vec<&str> = indices.strip_prefix('[')?.strip_suffix(']')?.split(',').collect();
    if indices.len() != array.bounds.len() {
        return None;
    }
    let mut number = 0u64;
    for (index, &(low, high)) in indices.into_iter().zip(&array.bounds) {
        let (low, high) = (i64::from(low), i64::from(high));
        let index = index.parse::<i64>().ok().filter(|index| (low..=high).contains(index))?;
        number = number.checked_mul((high - low + 1) as u64)?.checked_add((index - low) as u64)?;
    }
    Some(layout::element_place(array, number))
}

/// A path without the indices of its arrays: `#lamps` of `#lamps[#at + 1]`.
fn without_indices(text: &str) -> String {
    let (mut depth, mut is_quoted) = (0_usize, false);
    let is_outside = |c: &char| {
        match c {
            '"' => is_quoted = !is_quoted,
            '[' if !is_quoted => depth += 1,
            ']' if !is_quoted => {
                depth = depth.saturating_sub(1);
                return false;
            }
            _ => {}
        }
        depth == 0
    };
    text.chars().filter(is_outside).collect()
}

/// The parts of `#a.b`, `"Db x".c`, and whether it is a local name. None if it is not a plain name: indices,
/// constants.
fn path(text: &str) -> Option<(bool, Vec<String>)> {
    let local = text.starts_with('#');
    let mut rest = text.strip_prefix('#').unwrap_or(text);
    let mut parts = Vec::new();
    loop {
        let (part, after) = match rest.strip_prefix('"') {
            Some(quoted) => quoted.split_once('"')?,
            None => rest.split_at(rest.find(['.', '[']).unwrap_or(rest.len())),
        };
        let plain = |c: char| c.is_alphanumeric() || c == '_' || c == ' ' || c == '-';
        if part.is_empty() || !rest.starts_with('"') && !part.chars().all(plain) {
            return None;
        }
        parts.push(part.to_string());
        let mut after = after;
        while let Some(list) = after.strip_prefix('[') {
            let (list, rest) = list.split_once(']')?;
            let index = |index: &str| index.trim().parse::<i64>().map(|index| index.to_string()).ok();
            let indices: Vec<String> = list.split(',').map(index).collect::<Option<_>>()?;
            parts.push(format!("[{}]", indices.join(",")));
            after = rest;
        }
        if after.is_empty() {
            break;
        }
        rest = after.strip_prefix('.')?;
    }
    let is_number = parts[0].starts_with(|c: char| c.is_ascii_digit());
    (!is_number).then_some((local, parts))
}

/// Areas with an address of a byte, and with that of a bit only if the width says so.
const AREAS: &[&str] = &["PI", "PQ", "SM", "AI", "AQ", "I", "Q", "M", "V", "L", "S"];
/// Areas that the German set calls by other letters.
const GERMAN: &[(&str, &str)] =
    &[("PE", "PI"), ("PA", "PQ"), ("AE", "AI"), ("AA", "AQ"), ("E", "I"), ("A", "Q"), ("Z", "C")];

/// An address in the letters of a set.
fn written(address: &str, german: bool) -> String {
    let found = GERMAN.iter().filter(|_| german).find_map(|(de, en)| Some((de, address.strip_prefix(en)?)));
    found.map_or(address.to_string(), |(de, rest)| format!("{de}{rest}"))
}

/// Whether a key is that of a timer or counter: `T37`, `C5`. Its current value has the key `T37.VALUE`.
pub fn is_cell(key: &str) -> bool {
    key.strip_prefix(['T', 'C']).is_some_and(|number| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()))
}

/// An address in one form: `I0.0`, `MW10`, `DB5.DBX2.0`, `T5`. None: another text.
pub fn canonical(text: &str, german: bool) -> Option<String> {
    let text: String = text.chars().filter(|c| !c.is_whitespace()).collect::<String>().to_ascii_uppercase();
    let digits = |text: &str| !text.is_empty() && text.len() <= 7 && text.bytes().all(|b| b.is_ascii_digit());
    let bit_address = |text: &str| {
        text.split_once('.').is_some_and(|(byte, bit)| digits(byte) && bit.len() == 1 && digits(bit) && bit < "8")
    };
    if let Some(rest) = text.strip_prefix("DB") {
        if digits(rest) {
            return Some(text.clone());
        }
        let (number, part) = rest.split_once('.')?;
        let part = part.strip_prefix('%').unwrap_or(part);
        let rest = part.strip_prefix("DB").or_else(|| part.strip_prefix('D')).filter(|_| digits(number))?;
        let (width, place) = rest.split_at_checked(1)?;
        let good =
            if width == "X" { bit_address(place) } else { matches!(width, "B" | "W" | "D" | "L") && digits(place) };
        return good.then(|| format!("DB{number}.DB{width}{place}"));
    }
    let text = match german {
        true => {
            let found = GERMAN.iter().find_map(|(de, en)| Some((en, text.strip_prefix(de)?)));
            found.map_or(text.clone(), |(en, rest)| format!("{en}{rest}"))
        }
        false => text,
    };
    if let Some(rest) = text.strip_prefix("HC").or_else(|| text.strip_prefix(['T', 'C'])) {
        return digits(rest).then_some(text);
    }
    let area = AREAS.iter().find(|area| text.starts_with(**area))?;
    let rest = &text[area.len()..];
    let good = match rest.as_bytes().first() {
        Some(b'X') => return bit_address(&rest[1..]).then(|| format!("{area}{}", &rest[1..])),
        Some(b'B' | b'W' | b'D' | b'L') => digits(&rest[1..]),
        _ => bit_address(rest),
    };
    good.then_some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_has_one_form() {
        let cases = [
            ("I 0.0", false, Some("I0.0")),
            ("E 0.7", true, Some("I0.7")),
            ("A4.0", true, Some("Q4.0")),
            ("PEW 272", true, Some("PIW272")),
            ("mw10", false, Some("MW10")),
            ("DB5.DBX 2.0", false, Some("DB5.DBX2.0")),
            ("DB5.DX2.0", false, Some("DB5.DBX2.0")),
            ("Z 5", true, Some("C5")),
            ("M1.8", false, None),
            ("Motor", false, None),
            ("DB", false, None),
            ("T", false, None),
            ("DBÄ.ä", false, None),
        ];
        for (text, german, expected) in cases {
            assert_eq!(canonical(text, german).as_deref(), expected, "{text}");
        }
    }

    #[test]
    fn an_address_is_written_in_its_set() {
        for (address, expected) in
            [("I0.0", "E0.0"), ("PIW272", "PEW272"), ("QB4", "AB4"), ("M1.0", "M1.0"), ("C5", "Z5")]
        {
            assert_eq!(written(address, true), expected);
            assert_eq!(written(address, false), address);
        }
    }

    #[test]
    fn names_are_split_at_points() {
        assert_eq!(path("#a.b"), Some((true, vec!["a".into(), "b".into()])));
        assert_eq!(path("\"My DB\".x"), Some((false, vec!["My DB".into(), "x".into()])));
        assert_eq!(path("a[ 3,-1 ].b"), Some((false, vec!["a".into(), "[3,-1]".into(), "b".into()])));
        assert_eq!(path("a[#i].b"), None);
        assert_eq!(path("a[3"), None);
        assert_eq!(path("T#5s"), None);
        assert_eq!(path("16"), None);
    }
}
