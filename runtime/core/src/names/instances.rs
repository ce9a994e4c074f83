//! Names of the instances of function blocks, by their places in data blocks.

use plcc_abi::ProgramImage;
use plcc_abi::names::{NamedType, TypeNumber, structure_number};

use super::Finder;

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

impl Finder<'_> {
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
}
