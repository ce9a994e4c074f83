//! Places in memory by the names that sources give them.

use plcc_abi::image::Family;
use plcc_diag::Span;
use plcc_model::scl::{Access, Base, Part};
use plcc_model::types::{DataType, Elementary, Member};
use plcc_model::{self as model, Direction, Number, Passing, Place, PlaceArea, layout};
use plcc_syntax::ast::{
    BlockName, BlockPrefix, Bound, CellKind, Operand, OperandKind, Path, PathPart, PathRoot, Width,
};

use super::Maker;
use super::code::local;

/// An operand, and whether it is declared with just the type of the access.
pub struct Named {
    pub operand: Operand,
    pub exact: bool,
}

impl Maker<'_> {
    /// Reads and writes of it need no address register.
    pub fn is_direct(&self, access: &Access) -> bool {
        let is_place = access.indices.is_empty() && matches!(access.base, Base::Place(_));
        is_place && self.has_direct_part(access) && !self.is_view(access) && self.block_in(access).is_none()
    }

    /// Parts of variables are operands: `#w.%X3`.
    pub fn has_parts(&self) -> bool {
        self.program.profile.family == Family::S71500
    }

    /// The part of the access, if there is one, has a name or an address of its own.
    fn has_direct_part(&self, access: &Access) -> bool {
        let Some(part) = access.part else { return true };
        let has_address = matches!(&access.base, Base::Place(place) if has_address(place));
        self.has_parts() || has_address || is_whole(&access.ty, part)
    }

    /// A value in the instance where no name has its width: a view of other variables, bits as a whole byte.
    fn is_view(&self, access: &Access) -> bool {
        let Base::Place(Place::Instance { byte, bit }) = &access.base else { return false };
        access.elementary().is_some() && path_in(&self.block.interface.instance, (*byte, *bit), &access.ty).is_none()
    }

    /// The operand of a direct access; none after a message.
    pub fn operand(&mut self, access: &Access) -> Option<Operand> {
        self.named(access).map(|named| named.operand)
    }

    pub fn named(&mut self, access: &Access) -> Option<Named> {
        let span = access.span;
        let Base::Place(place) = &access.base else { return self.unnamed(span) };
        let Some(part) = access.part else { return self.place(place, &access.ty, span) };
        // STL has no name for all of a variable as its part.
        if is_whole(&access.ty, part) {
            return self.place(place, &access.ty, span).map(|named| Named { exact: false, ..named });
        }
        if self.has_parts()
            && let Named { operand: Operand { kind: OperandKind::Path(mut path), span }, .. } =
                self.place(place, &access.ty, span)?
        {
            let letter = match part.width {
                Width::Bit => 'X',
                Width::Byte => 'B',
                Width::Word => 'W',
                Width::Dword | Width::Lword => 'D',
            };
            path.parts.push(PathPart::Member { name: format!("%{letter}{}", part.index), span });
            return Some(Named { operand: Operand { kind: OperandKind::Path(path), span }, exact: true });
        }
        let found = access.elementary().zip(place_of_part(place, distance_of_part(&access.ty, part)));
        let Some((ty, place)) = found else {
            self.refuse(span, "a part of a variable", "copy it with AND and a shift");
            return None;
        };
        self.place(&place, &DataType::Elementary(ty), span)
    }

    fn unnamed(&mut self, span: Span) -> Option<Named> {
        self.refuse(span, "this address", "name a variable");
        None
    }

    pub fn place(&mut self, place: &Place, ty: &DataType, span: Span) -> Option<Named> {
        let width = match ty {
            DataType::Elementary(ty) => layout::width(*ty),
            _ => Width::Byte,
        };
        let absolute = |area, byte, bit| OperandKind::Absolute { area, width, byte, bit };
        let exact = |kind| Some(Named { operand: Operand { kind, span: self.span }, exact: true });
        let interface = &self.block.interface;
        match place {
            Place::I { byte, bit } => self.global(absolute(PlaceArea::I, *byte, *bit), ty, span),
            Place::Q { byte, bit } => self.global(absolute(PlaceArea::Q, *byte, *bit), ty, span),
            Place::M { byte, bit } => self.global(absolute(PlaceArea::M, *byte, *bit), ty, span),
            Place::Pi { byte, bit } if width != Width::Bit => exact(absolute(PlaceArea::Pi, *byte, *bit)),
            Place::Pq { byte, bit } if width != Width::Bit => exact(absolute(PlaceArea::Pq, *byte, *bit)),
            Place::L { byte, bit } => match (ty, self.is_hidden(*byte)) {
                (DataType::Elementary(ty), true) => self.hidden(*byte * 8 + u32::from(*bit), *ty, span),
                _ => self.in_members(&interface.temporaries, (*byte, *bit), ty, span),
            },
            Place::Instance { byte, bit } => self.in_members(&interface.instance, (*byte, *bit), ty, span),
            Place::Parameter { parameter, byte, bit } => {
                let formal = &interface.parameters[*parameter];
                if formal.passing == Passing::Number {
                    return self.unnamed(span);
                }
                if let Some(own) = self.own_copy(*parameter) {
                    return Some(Named { operand: own, exact: true });
                }
                let root = PathRoot::Local { name: formal.name.clone(), span: self.span };
                self.in_type(root, &formal.ty, (*byte, *bit), ty, span)
            }
            Place::ThroughPointer { pointer, byte, bit } => {
                let formal = interface.parameters.iter().find(|one| {
                    one.byte == *pointer
                        && one.direction == Direction::InOut
                        && matches!(one.passing, Passing::Complex { .. })
                });
                match formal {
                    Some(formal) => {
                        let root = PathRoot::Local { name: formal.name.clone(), span: self.span };
                        self.in_type(root, &formal.ty, (*byte, *bit), ty, span)
                    }
                    None => self.unnamed(span),
                }
            }
            Place::Db { number, .. } if !self.is_named(*number, span) => self.unnamed(span),
            Place::Db { number, byte, bit } => {
                let db = self.program.db(*number);
                let root = self.db_root(*number, span);
                let found = db.and_then(|db| path_in(&db.members, (*byte, *bit), ty));
                match found {
                    Some((name, mut parts, exact)) => {
                        let member = PathPart::Member { name, span: self.span };
                        parts.insert(0, member);
                        let path = Path { root, parts, span: self.span };
                        Some(Named { operand: Operand { kind: OperandKind::Path(path), span: self.span }, exact })
                    }
                    None if matches!(ty, DataType::Elementary(_)) => {
                        let db = match root {
                            PathRoot::Block(name) => name,
                            PathRoot::Local { name, span }
                            | PathRoot::Quoted { name, span }
                            | PathRoot::Bare { name, span } => BlockName::Symbol { name, span },
                        };
                        exact(OperandKind::DbAbsolute { db, width, byte: *byte, bit: *bit })
                    }
                    None => self.unnamed(span),
                }
            }
            Place::Pi { .. }
            | Place::Pq { .. }
            | Place::OpenDb { .. }
            | Place::OpenDi { .. }
            | Place::Indirect { .. }
            | Place::Register { .. }
            | Place::Element { .. } => self.unnamed(span),
        }
    }

    /// A parameter of the function under its own name.
    pub fn parameter(&self, index: usize) -> Operand {
        local(&self.block.interface.parameters[index].name, self.span)
    }

    /// The variable that stands for an input or the result of the function.
    fn own_copy(&self, parameter: usize) -> Option<Operand> {
        let is_result = self.block.interface.parameters[parameter].name == "RET_VAL";
        self.copies.get(&parameter).or(self.result.as_ref().filter(|_| is_result)).cloned()
    }

    /// No source declares the variable at this byte of the frame.
    pub fn is_hidden(&self, byte: u32) -> bool {
        let declared = self.block.interface.temporaries.iter().map(|one| one.byte + layout::bytes(&one.ty)).max();
        declared.is_none_or(|end| byte >= end)
    }

    /// A variable that no source declares.
    fn hidden(&mut self, bit: u32, ty: Elementary, span: Span) -> Option<Named> {
        if let Some((operand, known)) = self.hidden.get(&bit) {
            if known.bits() != ty.bits() {
                return self.unnamed(span);
            }
            return Some(Named { operand: operand.clone(), exact: *known == ty });
        }
        let operand = self.kept(ty, "value");
        self.hidden.insert(bit, (operand.clone(), ty));
        Some(Named { operand, exact: true })
    }

    /// An address, or its symbol if the source names that.
    fn global(&mut self, kind: OperandKind, ty: &DataType, span: Span) -> Option<Named> {
        let OperandKind::Absolute { area, width, byte, bit } = kind else { return self.unnamed(span) };
        let written = self.positions.text(span).to_lowercase();
        let letters = plcc_syntax::stl::letters(area, width, plcc_syntax::stl::Mnemonics::En).unwrap_or_default();
        let address = match width {
            Width::Bit => format!("{letters}{byte}.{bit}"),
            Width::Byte | Width::Word | Width::Dword | Width::Lword => format!("{letters}{byte}"),
        };
        let symbols = self.symbols.get(&address).into_iter().flatten();
        let named = symbols.filter(|symbol| written.contains(&symbol.name.to_lowercase()));
        let span_here = self.span;
        let quoted = |name: &str| Path {
            root: PathRoot::Quoted { name: name.to_string(), span: span_here },
            parts: Vec::new(),
            span: span_here,
        };
        match named.max_by_key(|symbol| symbol.name.len()) {
            Some(symbol) => {
                let exact = symbol.ty.as_ref().is_none_or(|known| known == ty);
                let kind = OperandKind::Path(quoted(&symbol.name));
                Some(Named { operand: Operand { kind, span: self.span }, exact })
            }
            None if matches!(ty, DataType::Elementary(_)) => {
                let kind = OperandKind::Absolute { area, width, byte, bit };
                Some(Named { operand: Operand { kind, span: self.span }, exact: true })
            }
            None => self.unnamed(span),
        }
    }

    fn in_members(&mut self, members: &[Member], at: (u32, u8), ty: &DataType, span: Span) -> Option<Named> {
        let Some((name, parts, exact)) = path_in(members, at, ty) else { return self.unnamed(span) };
        let root = PathRoot::Local { name, span: self.span };
        let path = Path { root, parts, span: self.span };
        Some(Named { operand: Operand { kind: OperandKind::Path(path), span: self.span }, exact })
    }

    fn in_type(&mut self, root: PathRoot, whole: &DataType, at: (u32, u8), ty: &DataType, span: Span) -> Option<Named> {
        for exact in [true, false] {
            let mut parts = Vec::new();
            if descend(whole, at, &Wanted { ty, exact }, &mut parts) {
                let path = Path { root, parts, span: self.span };
                return Some(Named { operand: Operand { kind: OperandKind::Path(path), span: self.span }, exact });
            }
        }
        self.unnamed(span)
    }

    /// A data block as the source names it.
    pub fn db_root(&self, number: u16, span: Span) -> PathRoot {
        match self.db_name(number, span) {
            BlockName::Symbol { name, span } => PathRoot::Quoted { name, span },
            name @ BlockName::Numbered { .. } => PathRoot::Block(name),
        }
    }

    /// The source can name the data block; those without name and number are made by plcc.
    pub fn is_named(&self, number: u16, span: Span) -> bool {
        let has_name = self.program.db(number).is_some_and(|db| !db.name.is_empty());
        has_name || self.positions.text(span).contains(&number.to_string())
    }

    /// By its number if the source does so, or if it has no name.
    pub fn db_name(&self, number: u16, span: Span) -> BlockName {
        let written = self.positions.text(span).to_ascii_uppercase().replace(' ', "");
        let name = self.program.db(number).map(|db| db.name.clone()).filter(|name| !name.is_empty());
        let numbered = written.contains(&format!("DB{number}"));
        match name.filter(|name| !numbered || written.contains(&name.to_ascii_uppercase())) {
            Some(name) => BlockName::Symbol { name, span: self.span },
            None => BlockName::Numbered { prefix: BlockPrefix::Db, number: u32::from(number), span: self.span },
        }
    }

    /// A timer or counter.
    pub fn cell(&mut self, kind: CellKind, number: &Number, span: Span) -> Option<Operand> {
        match number {
            Number::Known(number) => {
                let kind = OperandKind::Cell { kind, number: u32::from(*number) };
                Some(Operand { kind, span: self.span })
            }
            Number::Parameter(parameter) => Some(self.parameter(*parameter)),
            Number::Word(place) => {
                let word = DataType::Elementary(Elementary::Word);
                match &**place {
                    Place::Instance { byte, .. } => self.cell_in_instance(*byte, span),
                    place => {
                        let pointer = Box::new(self.place(place, &word, span)?.operand);
                        Some(Operand { kind: OperandKind::CellIndirect { kind, pointer }, span: self.span })
                    }
                }
            }
        }
    }

    /// A timer, counter or block that is a parameter of a function block.
    fn cell_in_instance(&mut self, byte: u32, span: Span) -> Option<Operand> {
        let formal = self.block.interface.parameters.iter().find(|one| one.byte == byte);
        match formal.filter(|one| one.passing == Passing::Number) {
            Some(formal) => Some(local(&formal.name, self.span)),
            None => self.unnamed(span).map(|named| named.operand),
        }
    }
}

/// The part is all of a variable of the type.
fn is_whole(ty: &DataType, part: Part) -> bool {
    matches!(ty, DataType::Elementary(ty) if layout::width(*ty) == part.width)
}

/// From the beginning of a variable to its part, in bits: the lowest byte is the last one.
pub fn distance_of_part(ty: &DataType, part: Part) -> u32 {
    let bytes = layout::bytes(ty);
    let index = u32::from(part.index);
    let own = match part.width {
        Width::Bit => return bytes.saturating_sub(1 + index / 8) * 8 + index % 8,
        Width::Byte => 1,
        Width::Word => 2,
        Width::Dword => 4,
        Width::Lword => 8,
    };
    bytes.saturating_sub((index + 1) * own) * 8
}

/// A bit of it can be named: `M 1.3`.
fn has_address(place: &Place) -> bool {
    matches!(place, Place::I { .. } | Place::Q { .. } | Place::M { .. } | Place::Db { .. })
}

/// The place so many bits after the beginning of a variable.
fn place_of_part(place: &Place, distance: u32) -> Option<Place> {
    let mut own = Some(place.clone()).filter(has_address)?;
    let (byte, bit) = own.position_mut()?;
    *byte += distance / 8;
    *bit = (distance % 8) as u8;
    Some(own)
}

/// What is looked for.
struct Wanted<'a> {
    ty: &'a DataType,
    /// Just that type; otherwise one of its width.
    exact: bool,
}

/// The component at an address: its first name, the steps from there, and whether it has just that type.
fn path_in(members: &[Member], at: (u32, u8), ty: &DataType) -> Option<(String, Vec<PathPart>, bool)> {
    [true, false].into_iter().find_map(|exact| {
        let mut parts = Vec::new();
        let name = member_at(members, at, &Wanted { ty, exact }, &mut parts)?;
        Some((name, parts, exact))
    })
}

fn member_at(members: &[Member], (byte, bit): (u32, u8), wanted: &Wanted, parts: &mut Vec<PathPart>) -> Option<String> {
    let found = members.iter().find(|member| {
        let begins = member.byte == byte && member.bit == bit;
        let size = layout::bytes(&member.ty).max(1);
        let inside = (member.byte..member.byte + size).contains(&byte) && member.bit == 0;
        (begins || inside) && byte >= member.byte && {
            parts.clear();
            let relative = (byte - member.byte, if begins { 0 } else { bit });
            descend(&member.ty, relative, wanted, parts)
        }
    });
    found.map(|member| member.name.clone())
}

/// Appends the steps from a variable of type `ty` to what is wanted at a place in it.
fn descend(ty: &DataType, at: (u32, u8), wanted: &Wanted, parts: &mut Vec<PathPart>) -> bool {
    let fits = match (ty, wanted.ty) {
        (DataType::Elementary(own), DataType::Elementary(wanted_ty)) if !wanted.exact => own.bits() == wanted_ty.bits(),
        (own, wanted_ty) => layout::same_type(own, wanted_ty),
    };
    if at == (0, 0) && fits {
        return true;
    }
    let span = Span::default();
    match ty {
        DataType::Struct(structure) => {
            let mut inner = Vec::new();
            let Some(name) = member_at(&structure.members, at, wanted, &mut inner) else { return false };
            parts.push(PathPart::Member { name, span });
            parts.append(&mut inner);
            true
        }
        DataType::Array(array) => {
            let Some((number, rest)) = element_at(array, at) else { return false };
            let mut inner = Vec::new();
            if !descend(&array.element, rest, wanted, &mut inner) {
                return false;
            }
            parts.push(PathPart::Index { values: indices_of(array, number), span });
            parts.append(&mut inner);
            true
        }
        DataType::Elementary(_)
        | DataType::DateAndTime
        | DataType::String(_)
        | DataType::WideString(_)
        | DataType::Parameter(_)
        | DataType::OpenArray(_)
        | DataType::Void => false,
    }
}

/// The element that contains a place, and the place in it.
fn element_at(array: &model::types::ArrayType, (byte, bit): (u32, u8)) -> Option<(u64, (u32, u8))> {
    let count = layout::element_count(&array.bounds);
    if array.element == DataType::Elementary(Elementary::Bool) {
        let number = (0..count).find(|number| layout::element_place(array, *number) == (byte, bit))?;
        return Some((number, (0, 0)));
    }
    let stride = layout::stride(&array.element).max(1);
    let number = u64::from(byte / stride);
    (number < count).then_some((number, (byte % stride, bit)))
}

/// The indices of element `number`, 0-based, the last dimension fastest.
fn indices_of(array: &model::types::ArrayType, number: u64) -> Vec<Bound> {
    let mut rest = number as i64;
    let mut indices: Vec<Bound> = array
        .bounds
        .iter()
        .rev()
        .map(|&(low, high)| {
            let length = i64::from(high) - i64::from(low) + 1;
            let index = i64::from(low) + rest % length;
            rest /= length;
            Bound::Number(index, Span::default())
        })
        .collect();
    indices.reverse();
    indices
}
