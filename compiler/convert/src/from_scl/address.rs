//! Accesses through AR1: arrays with indices that are known at run time, `MW[i]`, `DB10.DW[i]`.

use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_model::scl::{Access, Base, Expr, ExprKind, Index, IndexBounds, IndexedArea};
use plcc_model::types::{DataType, Elementary, ParameterType};
use plcc_model::{Direction, Parameter, Passing, Place, PlaceArea, layout};
use plcc_syntax::ast::{AddressRegister, BlockPrefix, Operand, OperandKind, Path, PathRoot, Width};
use plcc_syntax::literal::Literal;
use plcc_syntax::stl::StlInsn;

use super::Maker;

/// Strips the area of a pointer.
pub const ADDRESS_MASK: u32 = 0x00FF_FFFF;

/// The most texts in temporary data whose heads are written one by one.
const TEXTS_MAX: usize = 32;

/// What is to be done before AR1 is used.
#[derive(Clone)]
pub struct Through {
    /// None: AR1 contains it.
    area: Option<PlaceArea>,
    /// The data block to open.
    pub open: Option<Operand>,
}

/// An address that is computed.
pub enum Target {
    Direct(Operand),
    /// In AR1.
    Register(Through),
    /// In a variable, from where AR1 gets it.
    Stored(Through, Operand),
}

impl Maker<'_> {
    /// Computes the address of an access before its value; `keeps_ar1`: what follows leaves AR1 alone.
    pub fn target(&mut self, access: &Access, keeps_ar1: bool) -> Option<Target> {
        if self.is_direct(access) {
            return self.operand(access).map(Target::Direct);
        }
        let through = self.address(access)?;
        if keeps_ar1 {
            self.push(StlInsn::LoadAr1, None);
            return Some(Target::Register(through));
        }
        let stored = self.temporary(Elementary::Dword);
        self.push(StlInsn::Transfer, Some(stored.clone()));
        Some(Target::Stored(through, stored))
    }

    /// The operand of a target, after what it needs; accumulators and RLO stay.
    pub fn reach(&mut self, target: &Target, ty: Elementary) -> Operand {
        self.reach_at(target, ty, 0)
    }

    /// The same, so many bytes after an address.
    pub fn reach_at(&mut self, target: &Target, ty: Elementary, bytes: u32) -> Operand {
        match target {
            Target::Direct(operand) => operand.clone(),
            Target::Register(through) => self.through(through, ty, bytes),
            Target::Stored(through, stored) => {
                self.push(StlInsn::LoadAr1, Some(stored.clone()));
                self.through(through, ty, bytes)
            }
        }
    }

    fn through(&mut self, through: &Through, ty: Elementary, bytes: u32) -> Operand {
        if let Some(open) = &through.open {
            self.push(StlInsn::OpenDb, Some(open.clone()));
        }
        let (register, width) = (AddressRegister::Ar1, layout::width(ty));
        let kind = OperandKind::RegisterIndirect { area: through.area, width, register, offset: bytes * 8 };
        Operand { kind, span: self.span }
    }

    /// Leaves the pointer to an access in ACCU1.
    pub fn address(&mut self, access: &Access) -> Option<Through> {
        match &access.base {
            Base::Place(place) => self.element(access, place),
            Base::Indexed { .. } if access.part.is_some() => {
                self.refuse(access.span, "a part of a variable", "copy it with AND and a shift");
                None
            }
            Base::Indexed { area, byte, bit } => self.indexed(area, byte, bit.as_deref(), access.span),
        }
    }

    /// `area[byte]`, `area[byte, bit]`.
    fn indexed(&mut self, area: &IndexedArea, byte: &Expr, bit: Option<&Expr>, span: Span) -> Option<Through> {
        let through = match area {
            IndexedArea::Memory(area) => Through { area: Some(*area), open: None },
            IndexedArea::Db(number) => {
                let kind = OperandKind::Block(self.db_name(*number, span));
                Through { area: Some(PlaceArea::Db), open: Some(Operand { kind, span: self.span }) }
            }
            IndexedArea::DynamicDb(number) if self.block_parameter(number).is_some() => {
                let open = self.block_parameter(number);
                Through { area: Some(PlaceArea::Db), open }
            }
            IndexedArea::DynamicDb(number) => {
                let stored = self.temporary(Elementary::Word);
                self.number(number);
                self.push(StlInsn::Transfer, Some(stored.clone()));
                Through { area: Some(PlaceArea::Db), open: Some(self.db_in(stored)) }
            }
            IndexedArea::Coded { .. } => {
                self.refuse(span, "an area that is known at run time", "name the area");
                return None;
            }
        };
        match bit {
            None => {
                self.number(byte);
                self.shift_left(3);
            }
            Some(bit) => {
                self.warn_of_indices(span);
                let wide = bit.ty.bits() == 32;
                self.number(bit);
                if !wide {
                    self.push(StlInsn::IToD, None);
                }
                let stored = self.temporary(Elementary::Dint);
                self.push(StlInsn::Transfer, Some(stored.clone()));
                self.number(byte);
                self.shift_left(3);
                self.push(StlInsn::Load, Some(stored));
                self.push(StlInsn::AddD, None);
            }
        }
        Some(through)
    }

    /// A parameter of type BLOCK_DB.
    fn block_parameter(&self, number: &Expr) -> Option<Operand> {
        let ExprKind::Load(access) = &number.kind else { return None };
        self.block_in(access)
    }

    /// The parameter of type BLOCK_DB whose number is accessed.
    pub fn block_in(&self, access: &Access) -> Option<Operand> {
        let parameters = &self.block.interface.parameters;
        let formal = match access.base {
            Base::Place(Place::Parameter { parameter, .. }) => parameters.get(parameter),
            Base::Place(Place::Instance { byte, .. }) => parameters.iter().find(|formal| formal.byte == byte),
            _ => None,
        };
        let is_block = |formal: &&Parameter| formal.ty == DataType::Parameter(ParameterType::BlockDb);
        let formal = formal.filter(is_block).filter(|_| access.indices.is_empty());
        formal.map(|formal| super::code::local(&formal.name, self.span))
    }

    fn db_in(&self, stored: Operand) -> Operand {
        let kind = OperandKind::BlockIndirect { prefix: BlockPrefix::Db, pointer: Box::new(stored) };
        Operand { kind, span: self.span }
    }

    /// An element of an array, or a component of one, or a view of other variables, or a part of one of these.
    fn element(&mut self, access: &Access, place: &Place) -> Option<Through> {
        let has_indices = !access.indices.is_empty();
        // Numbers of characters have been looked at.
        let is_unchecked = has_indices && self.known_index.is_none();
        if is_unchecked && !matches!(place, Place::Instance { .. }) {
            self.warn_of_indices(access.span);
        }
        let interface = &self.block.interface;
        let in_variable = access.part.map_or(0, |part| super::place::distance_of_part(&access.ty, part));
        let bits = |byte: u32, bit: u8| i64::from(byte) * 8 + i64::from(bit) + i64::from(in_variable);
        let lowest = self.distances(&access.indices, access.span)?;
        if !has_indices && let Some(copy) = self.copy_of(place) {
            self.push(StlInsn::Load, Some(Operand { kind: OperandKind::AddressOf(copy), span: self.span }));
            self.add_constant(i64::from(in_variable));
            return Some(Through { area: None, open: None });
        }
        if !has_indices && !matches!(place, Place::L { .. } | Place::Instance { .. }) {
            // What the distance from the beginning of the data is added to.
            self.push(StlInsn::Load, Some(self.dint(0)));
        }
        match place {
            Place::I { byte, bit } => self.memory(PlaceArea::I, bits(*byte, *bit) - lowest),
            Place::Q { byte, bit } => self.memory(PlaceArea::Q, bits(*byte, *bit) - lowest),
            Place::M { byte, bit } => self.memory(PlaceArea::M, bits(*byte, *bit) - lowest),
            Place::Pi { byte, bit } => self.memory(PlaceArea::Pi, bits(*byte, *bit) - lowest),
            Place::Pq { byte, bit } => self.memory(PlaceArea::Pq, bits(*byte, *bit) - lowest),
            Place::Db { number, .. } if !self.is_named(*number, access.span) => self.no_address(access.span),
            Place::Db { number, byte, bit } => {
                self.add_pointer(bits(*byte, *bit) - lowest);
                let kind = OperandKind::Block(self.db_name(*number, access.span));
                Some(Through { area: Some(PlaceArea::Db), open: Some(Operand { kind, span: self.span }) })
            }
            Place::L { byte, .. } if self.is_hidden(*byte) => self.no_address(access.span),
            Place::L { byte, bit } => {
                let found = interface.temporaries.iter().rfind(|one| one.byte <= *byte);
                let root = found.map(|one| (one.name.clone(), place_bits(one.byte, one.bit)));
                let Some((name, start)) = root else { return self.no_address(access.span) };
                self.load_address_of(&name);
                if has_indices {
                    self.push(StlInsn::AddD, None);
                }
                self.add_constant(bits(*byte, *bit) - start - lowest);
                Some(Through { area: None, open: None })
            }
            Place::Instance { byte, bit } => {
                let found = interface.instance.iter().rfind(|one| one.byte <= *byte);
                let root = found.map(|one| (one.name.clone(), place_bits(one.byte, one.bit)));
                let Some((name, start)) = root else { return self.no_address(access.span) };
                if is_unchecked && !self.is_chart_data(&name) {
                    self.warn_of_indices(access.span);
                }
                self.load_address_of(&name);
                if has_indices {
                    self.push(StlInsn::AddD, None);
                }
                self.add_constant(bits(*byte, *bit) - start - lowest);
                self.add_ar2();
                Some(Through { area: None, open: None })
            }
            Place::Parameter { parameter, byte, bit } => {
                let formal = &interface.parameters[*parameter];
                if !matches!(formal.passing, Passing::Complex { .. }) {
                    return self.no_address(access.span);
                }
                let name = formal.name.clone();
                let stored = self.keep_distance(bits(*byte, *bit) - lowest);
                self.load_address_of(&name);
                Some(self.through_pointer(&stored))
            }
            Place::ThroughPointer { pointer, byte, bit } => {
                let formal =
                    interface.parameters.iter().find(|one| one.byte == *pointer && one.direction == Direction::InOut);
                let Some(name) = formal.map(|one| one.name.clone()) else { return self.no_address(access.span) };
                let stored = self.keep_distance(bits(*byte, *bit) - lowest);
                self.load_address_of(&name);
                self.add_ar2();
                Some(self.through_pointer(&stored))
            }
            Place::OpenDb { .. }
            | Place::OpenDi { .. }
            | Place::Indirect { .. }
            | Place::Register { .. }
            | Place::Element { .. } => self.no_address(access.span),
        }
    }

    fn no_address(&mut self, span: Span) -> Option<Through> {
        self.refuse(span, "the address of this variable", "copy it to a variable of the block");
        None
    }

    fn memory(&mut self, area: PlaceArea, bits: i64) -> Option<Through> {
        self.add_pointer(bits);
        Some(Through { area: Some(area), open: None })
    }

    /// The copy of an input of the function.
    fn copy_of(&self, place: &Place) -> Option<Path> {
        let Place::Parameter { parameter, .. } = place else { return None };
        match self.copies.get(parameter).map(|copy| &copy.kind) {
            Some(OperandKind::Path(path)) => Some(path.clone()),
            _ => None,
        }
    }

    /// ACCU1 and the distance to the beginning of the data, as a variable.
    fn keep_distance(&mut self, bits: i64) -> Operand {
        self.add_constant(bits);
        let stored = self.temporary(Elementary::Dint);
        self.push(StlInsn::Transfer, Some(stored.clone()));
        stored
    }

    /// From the address of a POINTER in ACCU1 to what it points at, `distance` further.
    fn through_pointer(&mut self, distance: &Operand) -> Through {
        let in_ar1 =
            |width, offset| OperandKind::RegisterIndirect { area: None, width, register: AddressRegister::Ar1, offset };
        let here = self.span;
        let db = self.temporary(Elementary::Word);
        self.push(StlInsn::LoadAr1, None);
        self.push(StlInsn::Load, Some(Operand { kind: in_ar1(Width::Word, 0), span: here }));
        self.push(StlInsn::Transfer, Some(db.clone()));
        self.push(StlInsn::Load, Some(Operand { kind: in_ar1(Width::Dword, 16), span: here }));
        self.push(StlInsn::Load, Some(distance.clone()));
        self.push(StlInsn::AddD, None);
        Through { area: None, open: Some(self.db_in(db)) }
    }

    /// The sum of the indices, each times the distance of its elements, in bits; returns what the lowest indices make of it.
    fn distances(&mut self, indices: &[Index], span: Span) -> Option<i64> {
        let mut lowest = 0;
        let mut sum: Option<Operand> = None;
        for (at, index) in indices.iter().enumerate() {
            let known = self.known_index.take();
            let low = match index.bounds {
                IndexBounds::Known(low, _) => low,
                IndexBounds::Open { .. } => {
                    self.refuse(span, "an element of ARRAY[*]", "declare the bounds of the array");
                    return None;
                }
                IndexBounds::Characters { .. } if known.is_some() => 1,
                IndexBounds::Characters { .. } => {
                    self.refuse(span, "a character that a text may not have", "leave the block in SCL");
                    return None;
                }
            };
            lowest += i64::from(low) * i64::from(index.stride);
            match known {
                Some(known) => self.push(StlInsn::Load, Some(known)),
                None => self.number(&index.value),
            }
            self.times(index.stride);
            if let Some(sum) = &sum {
                self.push(StlInsn::Load, Some(sum.clone()));
                self.push(StlInsn::AddD, None);
            }
            if at + 1 < indices.len() {
                let stored = sum.take().unwrap_or_else(|| self.temporary(Elementary::Dint));
                self.push(StlInsn::Transfer, Some(stored.clone()));
                sum = Some(stored);
            }
        }
        Some(lowest)
    }

    /// ACCU1 as a DINT, times a constant.
    fn times(&mut self, factor: u32) {
        if factor.is_power_of_two() {
            return self.shift_left(factor.trailing_zeros());
        }
        self.push(StlInsn::Load, Some(self.dint(i64::from(factor))));
        self.push(StlInsn::MulD, None);
    }

    fn shift_left(&mut self, count: u32) {
        if count > 0 {
            self.push(StlInsn::ShiftLeftD, Some(super::code::number(i64::from(count), self.span)));
        }
    }

    fn dint(&self, value: i64) -> Operand {
        let value = value.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32;
        Operand { kind: OperandKind::Literal(Literal::Dint(value)), span: self.span }
    }

    fn add_constant(&mut self, bits: i64) {
        if bits != 0 {
            self.push(StlInsn::AddConst, Some(self.dint(bits)));
        }
    }

    /// Adds the address of a component, `P#4.0`, where it is not before the area.
    fn add_pointer(&mut self, bits: i64) {
        match u32::try_from(bits) {
            Ok(0) | Err(_) => self.add_constant(bits),
            Ok(bits) => {
                let kind = OperandKind::Literal(Literal::Pointer(bits));
                self.push(StlInsn::Load, Some(Operand { kind, span: self.span }));
                self.push(StlInsn::AddD, None);
            }
        }
    }

    /// `L P##name`.
    fn load_address_of(&mut self, name: &str) {
        let root = PathRoot::Local { name: name.to_string(), span: self.span };
        let path = Path { root, parts: Vec::new(), span: self.span };
        self.push(StlInsn::Load, Some(Operand { kind: OperandKind::AddressOf(path), span: self.span }));
    }

    /// The heads of texts in temporary data: in SCL they are empty when a block begins, in STL they are what was there before.
    pub fn begin_texts(&mut self) {
        let body = self.body;
        if body.temporary_texts.len() > TEXTS_MAX {
            let what = format!("{} texts in temporary data", body.temporary_texts.len());
            return self.refuse(self.tree.name.span(), what, "declare them outside of the temporary data");
        }
        for text in &body.temporary_texts {
            let found = self.block.interface.temporaries.iter().rfind(|one| one.byte <= text.byte);
            let Some((name, start)) = found.map(|one| (one.name.clone(), one.byte)) else { continue };
            self.load_address_of(&name);
            self.add_constant(i64::from(text.byte - start) * 8);
            self.push(StlInsn::LoadAr1, None);
            // The maximum, then the length.
            let (head, width) = match text.wide {
                true => (Literal::Dword(u32::from(text.maximum) << 16), Width::Dword),
                false => (Literal::Word(text.maximum << 8), Width::Word),
            };
            let there = OperandKind::RegisterIndirect { area: None, width, register: AddressRegister::Ar1, offset: 0 };
            for (insn, kind) in [(StlInsn::Load, OperandKind::Literal(head)), (StlInsn::Transfer, there)] {
                self.push(insn, Some(Operand { kind, span: self.span }));
            }
        }
    }

    /// The instance begins where AR2 points.
    fn add_ar2(&mut self) {
        self.push(StlInsn::TransferAr2, None);
        let mask = OperandKind::Literal(Literal::Dword(ADDRESS_MASK));
        self.push(StlInsn::AndD, Some(Operand { kind: mask, span: self.span }));
        self.push(StlInsn::AddD, None);
    }

    /// STEP 7 does not look whether an index is within its bounds, and neither do the statements.
    fn warn_of_indices(&mut self, span: Span) {
        if !std::mem::replace(&mut self.warned_of_indices, true) {
            let mut message = Diagnostic::new(Code::NotConverted, span, "the STL does not check indices");
            message.severity = Severity::Warning;
            self.messages.push(
                message
                    .label("outside of its bounds, it reaches the data beside the array")
                    .help("in SCL, such an index is a programming error (OB 121)"),
            );
        }
    }

    /// A variable with the value of ACCU1, or of the RLO.
    pub fn keep(&mut self, ty: Elementary) -> Operand {
        let stored = self.temporary(ty);
        let insn = if ty == Elementary::Bool { StlInsn::Assign } else { StlInsn::Transfer };
        self.push(insn, Some(stored.clone()));
        stored
    }

    /// Whether an expression leaves AR1 alone.
    pub fn keeps_ar1(&self, value: &Expr) -> bool {
        match &value.kind {
            _ if super::instruction::is_called(value) => false,
            ExprKind::Const(_) | ExprKind::Flag | ExprKind::LastEno | ExprKind::Cell { .. } => true,
            ExprKind::Load(access) => self.is_direct(access),
            ExprKind::Unary { operand, .. } | ExprKind::Convert { operand, .. } => self.keeps_ar1(operand),
            ExprKind::Binary { left, right, .. } | ExprKind::Compare { left, right, .. } => {
                self.keeps_ar1(left) && self.keeps_ar1(right)
            }
            ExprKind::Function { arguments, .. } => arguments.iter().all(|one| self.keeps_ar1(one)),
            ExprKind::Call(_) | ExprKind::Timer(_) | ExprKind::Counter(_) | ExprKind::Bound { .. } => false,
        }
    }
}

/// A place in bits.
fn place_bits(byte: u32, bit: u8) -> i64 {
    i64::from(byte) * 8 + i64::from(bit)
}
