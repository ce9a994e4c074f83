//! Symbolic names of values: `"Station_DB".D1.Starts`, `Motors.m[2].speed`, `DB41.S005.X`, `Status.%X3`.
//!
//! A name begins with a symbol or a DB, and goes on with members, indices and at last a slice of a bit string. Quotes may be
//! left out, and letters of both cases are the same where no other name has the exact letters.

mod limits;
pub mod path;
mod used;

use plcc_abi::ProgramImage;
use plcc_abi::image::{AssertType, BlockKind, DbEntry};
use plcc_abi::names::{NamedStruct, NamedType, TypeNumber, structure_number};
use plcc_literal::distance::nearest;

use crate::address::{self, Address, Place, Width, digits};
use crate::s7200::Part as S7200Part;
use crate::signal;
use crate::typed::{self, ValueType};
use path::{Part, written};

pub use limits::Limits;
pub use used::used;

/// A value with an address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Named {
    pub address: Address,
    /// Its declared type; `None`: bits without another meaning.
    pub ty: Option<ValueType>,
}

/// A variable on the way to a value: where it begins, and its type.
#[derive(Clone, Copy)]
struct Variable {
    place: Place,
    bit: u8,
    ty: TypeNumber,
}

/// Members and indices of which a structure or array is made, in a list.
const LISTED_MAX: usize = 12;

/// Finds an absolute address or a symbolic name. `Err`: the error as a sentence.
pub fn find(text: &str, image: &ProgramImage) -> Result<Named, String> {
    let text = text.trim();
    if text.is_empty() || text == "\"\"" {
        return Err(format!(
            "the name is empty; write an address (such as {}) or a name of the program",
            examples(image)
        ));
    }
    let bare = text.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')).unwrap_or(text);
    let is_symbol = image.symbols.iter().any(|symbol| symbol.name == text || symbol.name == bare);
    if !is_symbol && let Some(address) = address::parse_for(text, image).or_else(|| signal::analog_channel(text, image))
    {
        return Ok(Named { address, ty: usual_type(address.place) });
    }
    let finder = Finder { image };
    let parts = match is_symbol {
        true => Some(vec![Part::Name(bare.to_string())]),
        false => path::parts(text),
    };
    match parts.as_deref() {
        Some([Part::Name(root), rest @ ..]) => finder.value(text, root, rest).map_err(|wrong| {
            // `I0.9` was meant as an address.
            address::too_large(text).map_or(wrong, |why| format!("`{text}` is not an address: {why}"))
        }),
        _ => Err(format!("`{text}` is neither an address (such as {}) nor a name", examples(image))),
    }
}

/// Addresses of the CPU, for messages.
fn examples(image: &ProgramImage) -> &'static str {
    if image.s7200.is_some() { "Q0.0, VW20, SM0.1" } else { "Q4.0, MW20, DB10.DBD4" }
}

/// All values of a structure, an array or a DB, with their names, at most `most`; a value alone is a list of one. `Err`: as
/// for [`find`].
pub fn values(text: &str, image: &ProgramImage, most: usize) -> Result<Vec<(String, Named)>, String> {
    let wrong = match find(text, image) {
        Ok(named) => return Ok(vec![(text.trim().to_string(), named)]),
        Err(wrong) => wrong,
    };
    let finder = Finder { image };
    let Some(parts) = path::parts(text) else { return Err(wrong) };
    let [Part::Name(root), rest @ ..] = &parts[..] else { return Err(wrong) };
    let Ok(Root::Variable(variable)) = finder.root(text, root) else { return Err(wrong) };
    let Ok(variable) = finder.walk(variable, rest, root) else { return Err(wrong) };
    let mut list = Vec::new();
    finder.list(text.trim(), variable, most, &mut list);
    if list.is_empty() { Err(wrong) } else { Ok(list) }
}

/// Values next to that of `text` in the same structure, at most `most`.
pub fn neighbours(text: &str, image: &ProgramImage, most: usize) -> Vec<(String, Named)> {
    let Some(parts) = path::parts(text) else { return Vec::new() };
    let finder = Finder { image };
    let [Part::Name(root), rest @ .., Part::Name(last)] = &parts[..] else { return Vec::new() };
    let Ok(Root::Variable(variable)) = finder.root(text, root) else { return Vec::new() };
    let Ok(variable) = finder.walk(variable, rest, root) else { return Vec::new() };
    let Some(NamedType::Struct(structure)) = finder.ty(variable.ty) else { return Vec::new() };
    let others = structure.members.iter().filter(|member| !same(&member.name, last));
    let values = others.filter_map(|member| {
        let variable = Variable { place: variable.place.offset(member.byte), bit: member.bit, ty: member.ty };
        Some((written(&member.name), finder.end(variable)?))
    });
    values.take(most).collect()
}

/// Timers and counters have values of a type, although they are not declared.
fn usual_type(place: Place) -> Option<ValueType> {
    match place {
        Place::TimerValue(_) => Some(ValueType::of(AssertType::S5Time)),
        Place::CounterValue(_) | Place::S7200(S7200Part::TimerValue | S7200Part::CounterValue, _) => {
            Some(ValueType::of(AssertType::Signed(16)))
        }
        Place::Input(_)
        | Place::Output(_)
        | Place::BitMemory(_)
        | Place::PeripheralInput(_)
        | Place::PeripheralOutput(_)
        | Place::Db(..)
        | Place::Timer(_)
        | Place::Counter(_)
        | Place::S7200(..) => None,
    }
}

fn same(a: &str, b: &str) -> bool {
    a == b || a.to_lowercase() == b.to_lowercase()
}

/// An instance of a function block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InstanceName {
    /// Of the data block, or of the component; an element of an array with its index.
    pub name: String,
    /// From the data block on: `Line.Pumps[2]`.
    pub path: String,
}

/// The instance at `byte` of a DB, whose type has the number `kind` ([`structure_number`]); `None`: nothing of this type begins there.
pub fn instance(image: &ProgramImage, db: u16, byte: u32, kind: u32) -> Option<InstanceName> {
    let finder = Finder { image };
    let db = finder.db(db.into())?;
    let name = if db.name.is_empty() { format!("DB{}", db.number) } else { db.name.clone() };
    let root = InstanceName { path: name.clone(), name };
    // The type of a DB may have another name than the block, and is the only one that can be left.
    let whole = (byte == 0).then(|| root.clone());
    db.ty.and_then(|ty| finder.instance(root, ty, byte, kind)).or(whole)
}

/// What the first part of a name means.
enum Root {
    Address(Address, Option<ValueType>),
    Variable(Variable),
}

struct Finder<'a> {
    image: &'a ProgramImage,
}

impl<'a> Finder<'a> {
    fn ty(&self, number: TypeNumber) -> Option<&'a NamedType> {
        self.image.types.get(number as usize)
    }

    fn value(&self, text: &str, root: &str, rest: &[Part]) -> Result<Named, String> {
        let (rest, slice) = match rest {
            [rest @ .., Part::Slice(width, number)] => (rest, Some((*width, *number))),
            rest => (rest, None),
        };
        let named = match (self.root(text, root)?, rest) {
            (Root::Address(address, ty), []) => Named { address, ty },
            (Root::Address(address, _), [Part::Name(value)]) if value.eq_ignore_ascii_case("VALUE") => {
                let address = current_value(address).ok_or_else(|| format!("`{root}` has no `{value}`"))?;
                Named { address, ty: usual_type(address.place) }
            }
            (Root::Address(Address { width, .. }, _), [Part::Name(bit)])
                if !matches!(width, Width::Bit(_)) && digits(bit).is_some() =>
            {
                return Err(bit_of_word(root, bit));
            }
            (Root::Address(address, _), [part, ..]) => {
                let current = current_value(address);
                let help = current.map_or_else(String::new, |_| format!("; its current value is `{root}.VALUE`"));
                return Err(format!("`{root}` is a value without {}{help}", what(part)));
            }
            (Root::Variable(variable), rest) => {
                let found = self.walk(variable, rest, root)?;
                self.end(found).ok_or_else(|| self.no_value(text, found))?
            }
        };
        match slice {
            None => Ok(named),
            Some((width, number)) => sliced(named, width, number)
                .ok_or_else(|| format!("`{text}`: a slice is part of a bit string or an integer, and within it")),
        }
    }

    /// A symbol or DB; one with the exact letters goes first.
    fn root(&self, text: &str, root: &str) -> Result<Root, String> {
        let rules: [fn(&str, &str) -> bool; 2] = [|a, b| a == b, same];
        for is_name in rules {
            if let Some(symbol) = self.image.symbols.iter().find(|symbol| is_name(&symbol.name, root)) {
                if let Some(db) = symbol.address.strip_prefix("DB").and_then(digits).and_then(|number| self.db(number))
                {
                    return self.of_db(db);
                }
                let address = address::parse_for(&symbol.address, self.image)
                    .ok_or_else(|| format!("symbol {text} means {}, which is not a value", symbol.address))?;
                return Ok(match symbol.ty.and_then(|number| Some((number, self.ty(number)?))) {
                    Some((_, NamedType::Value(ty))) => Root::Address(address, Some(ValueType::of(*ty))),
                    Some((ty, _)) => Root::Variable(Variable { place: address.place, bit: 0, ty }),
                    None => Root::Address(address, usual_type(address.place)),
                });
            }
            let mut dbs = self.image.dbs.iter();
            if let Some(db) = dbs.find(|db| !db.name.is_empty() && is_name(&db.name, root)) {
                return self.of_db(db);
            }
        }
        let upper = root.strip_prefix('%').unwrap_or(root).to_ascii_uppercase();
        if let Some(number) = upper.strip_prefix("DB").map(str::trim).and_then(digits) {
            let db = self.db(number).ok_or_else(|| format!("the program has no DB {number}"))?;
            return self.of_db(db);
        }
        if let Some(address) = address::parse_for(root, self.image) {
            return Ok(Root::Address(address, usual_type(address.place)));
        }
        Err(self.unknown(text, root))
    }

    fn db(&self, number: u32) -> Option<&'a DbEntry> {
        self.image.dbs.iter().find(|db| u32::from(db.number) == number)
    }

    fn of_db(&self, db: &DbEntry) -> Result<Root, String> {
        let ty =
            db.ty.ok_or_else(|| format!("DB {} has no declared values; name an address, as DB{0}.DBW0", db.number))?;
        Ok(Root::Variable(Variable { place: Place::Db(db.number, 0), bit: 0, ty }))
    }

    /// Follows members and indices.
    fn walk(&self, mut variable: Variable, parts: &[Part], root: &str) -> Result<Variable, String> {
        let mut so_far = written(root);
        for part in parts {
            let next = match (part, self.ty(variable.ty)) {
                (Part::Name(name), Some(NamedType::Struct(structure))) => {
                    let member = member(structure, name).ok_or_else(|| no_member(&so_far, structure, name))?;
                    so_far = format!("{so_far}.{}", written(&member.name));
                    Variable { place: variable.place.offset(member.byte), bit: member.bit, ty: member.ty }
                }
                (Part::Index(indices), Some(NamedType::Array { dimensions, element })) => {
                    if indices.len() != dimensions.len() {
                        let wanted = match dimensions.len() {
                            1 => "1 index".to_string(),
                            count => format!("{count} indices"),
                        };
                        return Err(format!("`{so_far}` is {}: it needs {wanted}", self.name(variable.ty)));
                    }
                    let mut bits = u64::from(variable.bit);
                    for (&index, dimension) in indices.iter().zip(dimensions) {
                        let (low, high) = (i64::from(dimension.low), i64::from(dimension.high));
                        if !(low..=high).contains(&index) {
                            return Err(format!("index {index} of `{so_far}` is not from {low} to {high}"));
                        }
                        bits += (index - low) as u64 * u64::from(dimension.distance);
                    }
                    let texts: Vec<String> = indices.iter().map(ToString::to_string).collect();
                    so_far = format!("{so_far}[{}]", texts.join(","));
                    Variable { place: variable.place.offset((bits / 8) as u32), bit: (bits % 8) as u8, ty: *element }
                }
                (part, _) => {
                    return Err(format!("`{so_far}` is {} and has no {}", self.name(variable.ty), what(part)));
                }
            };
            variable = next;
        }
        Ok(variable)
    }

    /// The value that a variable is; `None`: it consists of others, or has none.
    fn end(&self, variable: Variable) -> Option<Named> {
        let ty = match self.ty(variable.ty)? {
            NamedType::Value(ty) => ValueType::of(*ty),
            NamedType::Text { wide, length } => {
                let ty = if *wide { AssertType::WideText } else { AssertType::Text };
                ValueType { ty, length: *length }
            }
            NamedType::Struct(structure) if structure.is_dtl => ValueType::of(AssertType::Dtl),
            NamedType::Struct(_) | NamedType::Array { .. } | NamedType::Other { .. } => return None,
        };
        let address = Address { place: variable.place, width: ty.width(variable.bit) };
        Some(Named { address, ty: Some(ty) })
    }

    fn list(&self, name: &str, variable: Variable, most: usize, list: &mut Vec<(String, Named)>) {
        if list.len() >= most {
            return;
        }
        if let Some(named) = self.end(variable) {
            return list.push((name.to_string(), named));
        }
        match self.ty(variable.ty) {
            Some(NamedType::Struct(structure)) => {
                for member in &structure.members {
                    let name = format!("{name}.{}", written(&member.name));
                    let place = variable.place.offset(member.byte);
                    self.list(&name, Variable { place, bit: member.bit, ty: member.ty }, most, list);
                }
            }
            Some(NamedType::Array { dimensions, element }) => {
                let mut indices: Vec<i64> = dimensions.iter().map(|dimension| i64::from(dimension.low)).collect();
                let is_empty = dimensions.iter().any(|dimension| dimension.low > dimension.high);
                while !is_empty && list.len() < most {
                    let bits: u64 = indices
                        .iter()
                        .zip(dimensions)
                        .map(|(index, dimension)| {
                            (index - i64::from(dimension.low)) as u64 * u64::from(dimension.distance)
                        })
                        .sum();
                    let texts: Vec<String> = indices.iter().map(ToString::to_string).collect();
                    let name = format!("{name}[{}]", texts.join(","));
                    let place = variable.place.offset((bits / 8) as u32);
                    self.list(&name, Variable { place, bit: (bits % 8) as u8, ty: *element }, most, list);
                    // The last index runs fastest.
                    let next = (0..indices.len()).rev().find(|&at| indices[at] < i64::from(dimensions[at].high));
                    let Some(next) = next else { break };
                    indices[next] += 1;
                    for at in next + 1..indices.len() {
                        indices[at] = i64::from(dimensions[at].low);
                    }
                }
            }
            Some(NamedType::Value(_) | NamedType::Text { .. } | NamedType::Other { .. }) | None => {}
        }
    }

    /// What has the type `kind` at `byte` of a variable.
    fn instance(&self, from: InstanceName, ty: TypeNumber, byte: u32, kind: u32) -> Option<InstanceName> {
        match self.ty(ty)? {
            NamedType::Struct(structure) => {
                if byte == 0 && structure_number(&structure.name) == kind {
                    return Some(from);
                }
                let before = &structure.members[..structure.members.partition_point(|member| member.byte <= byte)];
                let nearest = before.last()?.byte;
                // Several begin at one byte if instances have no data.
                let here = before.iter().rev().take_while(|member| member.byte == nearest);
                here.filter_map(|member| {
                    let path = format!("{}.{}", from.path, member.name);
                    let inner = InstanceName { name: member.name.clone(), path };
                    self.instance(inner, member.ty, byte - nearest, kind)
                })
                .next()
            }
            NamedType::Array { dimensions, element } => {
                let mut rest = u64::from(byte) * 8;
                let mut texts = Vec::new();
                for dimension in dimensions {
                    let number = rest / u64::from(dimension.distance.max(1));
                    texts.push((i64::from(dimension.low) + number as i64).to_string());
                    rest -= number * u64::from(dimension.distance);
                }
                let index = format!("[{}]", texts.join(","));
                let inner = InstanceName { name: from.name + &index, path: from.path + &index };
                self.instance(inner, *element, (rest / 8) as u32, kind)
            }
            NamedType::Value(_) | NamedType::Text { .. } | NamedType::Other { .. } => None,
        }
    }

    /// A type as a user knows it.
    fn name(&self, number: TypeNumber) -> String {
        match self.ty(number) {
            Some(NamedType::Value(ty)) => format!("of type {}", typed::name(*ty)),
            Some(NamedType::Text { wide: false, length }) => format!("a STRING[{length}]"),
            Some(NamedType::Text { wide: true, length }) => format!("a WSTRING[{length}]"),
            Some(NamedType::Array { dimensions, .. }) => {
                let bounds: Vec<String> =
                    dimensions.iter().map(|dimension| format!("{}..{}", dimension.low, dimension.high)).collect();
                format!("an ARRAY[{}]", bounds.join(","))
            }
            Some(NamedType::Struct(structure)) if structure.name.is_empty() => "a structure".to_string(),
            Some(NamedType::Struct(structure)) => format!("a structure ({})", structure.name),
            Some(NamedType::Other { name }) => format!("a parameter that points to its actual ({name})"),
            None => "without a type".to_string(),
        }
    }

    fn no_value(&self, text: &str, variable: Variable) -> String {
        let mut list = Vec::new();
        self.list(text, variable, 1, &mut list);
        let is = self.name(variable.ty);
        match list.first() {
            Some((name, _)) => format!("`{text}` is {is}; name one of its values, such as {name}"),
            None => format!("`{text}` is {is} and has no value that can be shown"),
        }
    }

    fn unknown(&self, text: &str, root: &str) -> String {
        let is_instance = |db: &&DbEntry| match db.ty.and_then(|ty| self.ty(ty)) {
            Some(NamedType::Struct(structure)) => same(&structure.name, root),
            _ => false,
        };
        let instances: Vec<String> = self.image.dbs.iter().filter(is_instance).map(db_name).collect();
        if !instances.is_empty() {
            return format!("`{root}` is a function block; its values are in its instances: {}", instances.join(", "));
        }
        let called = self.image.inner_blocks.iter().map(|(kind, _, name)| (*kind, name));
        let mut blocks = self.image.blocks.iter().map(|block| (block.kind, &block.name)).chain(called);
        if let Some((kind, _)) = blocks.find(|(_, name)| !name.is_empty() && same(name, root))
            && let Some(kind) = match kind {
                BlockKind::Ob => Some("an organization block"),
                BlockKind::Fc => Some("a function"),
                BlockKind::Fb => Some("a function block without an instance"),
                BlockKind::Sfc | BlockKind::Sfb | BlockKind::Db | BlockKind::Sbr | BlockKind::Int => None,
            }
        {
            return format!("`{root}` is {kind}, and its local data end with the call: name a tag or a value of a DB");
        }
        // `Q0.0:P`
        let direct = text.len().checked_sub(2).filter(|at| text.is_char_boundary(*at)).map(|at| text.split_at(at));
        if let Some((image, direct)) = direct
            && direct.eq_ignore_ascii_case(":P")
            && address::parse_for(image, self.image).is_some()
        {
            return format!("`{text}` has no `:P` here: write `{image}`, the value in the process image");
        }
        let names = self.image.symbols.iter().map(|symbol| symbol.name.as_str());
        let dbs = self.image.dbs.iter().map(|db| db.name.as_str()).filter(|name| !name.is_empty());
        let near = match nearest(root, names.chain(dbs)) {
            Some(near) => format!("; did you mean `{}`?", written(near)),
            None => match self.member_of_db(root) {
                Some(name) => format!("; did you mean `{name}`?"),
                None => {
                    signal::missing_channel(text, self.image).map_or_else(String::new, |known| format!("; {known}"))
                }
            },
        };
        let is_bit = text.rsplit_once('.').is_some_and(|(_, bit)| digits(bit).is_some());
        let is_address = root.starts_with(['I', 'E', 'Q', 'A', 'M', 'i', 'e', 'q', 'a', 'm']);
        // `M10`
        if is_address && near.is_empty() && text == root && digits(&root[1..]).is_some() {
            let (area, byte) = root.split_at(1);
            let forms =
                format!("`{area}B{byte}` for a byte, `{area}W{byte}` for a word, `{area}D{byte}` for a double word");
            return format!("`{text}` is not an address: write `{text}.0` for a bit, {forms}");
        }
        if text == root || is_bit {
            let examples = examples(self.image);
            format!("`{text}` is neither an address (such as {examples}) nor a symbol of the program{near}")
        } else {
            format!("`{text}`: the program has no DB or tag `{root}`{near}")
        }
    }

    /// `Motors.speed` for `speed`.
    fn member_of_db(&self, name: &str) -> Option<String> {
        self.image.dbs.iter().find_map(|db| match self.ty(db.ty?)? {
            NamedType::Struct(structure) => {
                member(structure, name).map(|member| format!("{}.{}", db_name(db), written(&member.name)))
            }
            _ => None,
        })
    }
}

pub(crate) fn db_name(db: &DbEntry) -> String {
    if db.name.is_empty() { format!("DB{}", db.number) } else { written(&db.name) }
}

fn member<'a>(structure: &'a NamedStruct, name: &str) -> Option<&'a plcc_abi::names::NamedMember> {
    let members = &structure.members;
    members.iter().find(|member| member.name == name).or_else(|| members.iter().find(|member| same(&member.name, name)))
}

fn no_member(so_far: &str, structure: &NamedStruct, name: &str) -> String {
    let is = if structure.name.is_empty() { String::new() } else { format!(" ({})", structure.name) };
    let names = || structure.members.iter().map(|member| member.name.as_str());
    let help = match nearest(name, names()) {
        Some(near) => format!("did you mean `{}`?", written(near)),
        None => {
            let mut list: Vec<String> = names().take(LISTED_MAX).map(written).collect();
            if structure.members.len() > LISTED_MAX {
                list.push("...".to_string());
            }
            format!("it has {}", list.join(", "))
        }
    };
    format!("`{so_far}`{is} has no member `{name}`; {help}")
}

/// The message for `MW20.5`.
fn bit_of_word(root: &str, bit: &str) -> String {
    let of_word = format!("`{root}.%X{bit}` for bit {bit} of the value");
    let plain = root.trim_start_matches('%');
    let byte = plain.get(2..).filter(|byte| digits(byte).is_some() && digits(bit).is_some_and(|bit| bit < 8));
    let help = match byte {
        Some(byte) => format!("write `{}{byte}.{bit}` for bit {bit} of byte {byte}, {of_word}", &plain[..1]),
        None => format!("write {of_word}"),
    };
    format!("`{root}.{bit}` has the number of a bit, but `{root}` names no bit; {help}")
}

fn what(part: &Part) -> String {
    match part {
        Part::Name(name) => format!("member `{name}`"),
        Part::Index(_) => "elements".to_string(),
        Part::Slice(..) => "slices here: they come last".to_string(),
    }
}

/// `VALUE` of a timer or counter.
fn current_value(address: Address) -> Option<Address> {
    let place = match address.place {
        Place::Timer(number) => Place::TimerValue(number),
        Place::Counter(number) => Place::CounterValue(number),
        Place::S7200(part, number) => Place::S7200(part.current_value()?, number),
        Place::Input(_)
        | Place::Output(_)
        | Place::BitMemory(_)
        | Place::PeripheralInput(_)
        | Place::PeripheralOutput(_)
        | Place::Db(..)
        | Place::TimerValue(_)
        | Place::CounterValue(_) => return None,
    };
    Some(Address { place, width: Width::Word })
}

/// Slice `number` of `width` bits of a value.
fn sliced(named: Named, width: u32, number: u32) -> Option<Named> {
    let is_whole = match named.ty {
        None => true,
        Some(ty) => matches!(ty.ty, AssertType::Bits(_) | AssertType::Signed(_) | AssertType::Unsigned(_)),
    };
    let bits = named.address.width.bits();
    let has_bytes = match named.address.place {
        Place::Timer(_) | Place::Counter(_) | Place::TimerValue(_) | Place::CounterValue(_) | Place::S7200(..) => false,
        Place::Input(_)
        | Place::Output(_)
        | Place::BitMemory(_)
        | Place::PeripheralInput(_)
        | Place::PeripheralOutput(_)
        | Place::Db(..) => true,
    };
    let end = number.checked_add(1)?.checked_mul(width)?;
    if !is_whole || !has_bytes || matches!(named.address.width, Width::Bit(_)) || end > bits || width == bits {
        return None;
    }
    let first = number * width;
    let (byte, ty) = match width {
        1 => (bits / 8 - 1 - first / 8, AssertType::Bool),
        _ => ((bits - end) / 8, AssertType::Bits(width as u8)),
    };
    let ty = ValueType::of(ty);
    let address = Address { place: named.address.place.offset(byte), width: ty.width((first % 8) as u8) };
    Some(Named { address, ty: Some(ty) })
}
