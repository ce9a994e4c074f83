//! Which names and addresses a program has.

use plcc_abi::image::{AssertType, DbEntry, SymbolEntry};
use plcc_abi::names::External;
use plcc_runtime::address::{self, Address, Place, Width};
use plcc_runtime::names;
use plcc_runtime::typed::ValueType;

use super::Space;
use super::node::Folder;
use super::thing::{Form, Thing, Ty, quoted};

impl Space {
    /// The node of a data block; `None`: clients may reach nothing of it.
    pub(super) fn block(&self, db: &DbEntry) -> Option<Thing> {
        let ty = db.ty?;
        if let Form::Struct(structure) = self.form(ty)
            && !structure.members.is_empty()
            && structure.members.iter().all(|member| member.external == External::Hidden)
        {
            return None;
        }
        let absolute = format!("DB{}", db.number);
        let symbol =
            || self.image.symbols.iter().find(|symbol| symbol.address == absolute).map(|symbol| symbol.name.clone());
        let name = Some(db.name.clone()).filter(|name| !name.is_empty()).or_else(symbol).unwrap_or(absolute);
        Some(Thing {
            id: quoted(&name),
            name,
            parent: Folder::DataBlocks.name().to_string(),
            place: Place::Db(db.number, 0),
            bit: 0,
            ty: Ty::Declared(ty),
            read_only: db.read_only,
        })
    }

    /// What clients may do with an address: no more than with any tag there.
    pub(super) fn limit(&self, address: Address) -> External {
        self.limits.of_tags(&address, address.width.bits().into())
    }

    /// The tag of a symbol, unless it names a block.
    fn named_tag(&self, symbol: &SymbolEntry) -> Option<(Folder, Thing)> {
        let address = address::parse_for(&symbol.address, &self.image)?;
        let named = names::find(&symbol.name, &self.image).ok().and_then(|named| named.ty);
        let ty = match (symbol.ty, named) {
            (Some(ty), _) if !matches!(self.form(ty), Form::Value(_) | Form::Other) => Ty::Declared(ty),
            (_, named) => Ty::Plain(named.unwrap_or(plain(address.width))),
        };
        let (folder, thing) = self.tag(quoted(&symbol.name), &symbol.name, address, ty);
        Some((folder, Thing { read_only: symbol.external != External::Write, ..thing }))
    }

    /// An address as a tag; `None`: clients may not access it.
    pub(super) fn address_tag(&self, text: &str, address: Address, external: External) -> Option<(Folder, Thing)> {
        if external == External::Hidden {
            return None;
        }
        let (folder, thing) = self.tag(format!("%{text}"), text, address, Ty::Plain(plain(address.width)));
        Some((folder, Thing { read_only: external != External::Write, ..thing }))
    }

    pub(super) fn find_tags(&self) -> Vec<(Folder, Thing)> {
        let named = self.image.symbols.iter().filter(|symbol| symbol.external != External::Hidden);
        let mut tags: Vec<(Folder, Thing)> = named.filter_map(|symbol| self.named_tag(symbol)).collect();
        for (name, named) in names::used(&self.image) {
            let is_address = address::parse_for(&name, &self.image) == Some(named.address);
            // A timer or counter of an S7-300/400 is its value. Data blocks have a folder of their own, but V memory of an S7-200 has not.
            let is_elsewhere = match self.image.s7200 {
                Some(_) => false,
                None => matches!(named.address.place, Place::Db(..) | Place::TimerValue(_) | Place::CounterValue(_)),
            };
            if is_address && !is_elsewhere {
                tags.extend(self.address_tag(&name, named.address, self.limit(named.address)));
            }
        }
        tags
    }

    pub(super) fn tag(&self, id: String, name: &str, address: Address, ty: Ty) -> (Folder, Thing) {
        // Clients want to know how long a timer runs; that it runs, they see by that.
        let (place, ty) = match address.place {
            Place::Timer(number) | Place::TimerValue(number) => {
                (Place::TimerValue(number), Ty::Plain(ValueType::of(AssertType::S5Time)))
            }
            Place::Counter(number) | Place::CounterValue(number) => {
                (Place::CounterValue(number), Ty::Plain(ValueType::of(AssertType::Signed(16))))
            }
            place => (place, ty),
        };
        let bit = if let Width::Bit(bit) = address.width { bit } else { 0 };
        let folder = Folder::of(place);
        let parent = folder.name().to_string();
        (folder, Thing { id, name: name.to_string(), parent, place, bit, ty, read_only: false })
    }
}

/// Bits of a width.
fn plain(width: Width) -> ValueType {
    ValueType::of(match width {
        Width::Bit(_) => AssertType::Bool,
        width => AssertType::Bits(width.bits() as u8),
    })
}
