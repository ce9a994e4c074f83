//! Messages about names that mean no value, with what may be meant.

use plcc_abi::image::{BlockKind, DbEntry};
use plcc_abi::names::{NamedStruct, NamedType, TypeNumber};
use plcc_literal::distance::nearest;

use super::path::{Part, written};
use super::{Finder, Variable, db_name, examples, member, same};
use crate::address::{self, digits};
use crate::{signal, typed};

/// Members of which a structure is made, in a list.
const LISTED_MAX: usize = 12;

impl Finder<'_> {
    /// A type as a user knows it.
    pub(super) fn name(&self, number: TypeNumber) -> String {
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

    /// The message for a variable that is not a value by itself.
    pub(super) fn no_value(&self, text: &str, variable: Variable) -> String {
        let mut list = Vec::new();
        self.list(text, variable, 1, &mut list);
        let is = self.name(variable.ty);
        match list.first() {
            Some((name, _)) => format!("`{text}` is {is}; name one of its values, such as {name}"),
            None => format!("`{text}` is {is} and has no value that can be shown"),
        }
    }

    /// The message for a name whose first part, `root`, is neither an address nor a name of the program.
    pub(super) fn unknown(&self, text: &str, root: &str) -> String {
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

    /// The message for `MW20.5`. A symbol names no byte, whatever letters it is made of.
    pub(super) fn bit_of_word(&self, root: &str, bit: &str) -> String {
        let of_word = format!("`{root}.%X{bit}` for bit {bit} of the value");
        let is_symbol = self.image.symbols.iter().any(|symbol| same(&symbol.name, root));
        let plain = root.trim_start_matches('%');
        let byte = plain.get(2..).filter(|byte| digits(byte).is_some() && digits(bit).is_some_and(|bit| bit < 8));
        let help = match plain.get(..1).zip(byte).filter(|_| !is_symbol) {
            Some((area, byte)) => format!("write `{area}{byte}.{bit}` for bit {bit} of byte {byte}, {of_word}"),
            None => format!("write {of_word}"),
        };
        format!("`{root}.{bit}` has the number of a bit, but `{root}` names no bit; {help}")
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

/// The message for a member that a structure does not have, at the name `so_far`.
pub(super) fn no_member(so_far: &str, structure: &NamedStruct, name: &str) -> String {
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

/// What a part of a name asks for.
pub(super) fn what(part: &Part) -> String {
    match part {
        Part::Name(name) => format!("member `{name}`"),
        Part::Index(_) => "elements".to_string(),
        Part::Slice(..) => "slices here: they come last".to_string(),
    }
}
