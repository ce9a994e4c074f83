//! What an operand is: places, numbers and constants, before the check that the instruction accepts them.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{
    self, AddressRegister, Area, BlockName, BlockPrefix, CellKind, OperandKind, Path, PathRoot, SpecialRegister,
    StatusOperand, Width,
};
use plcc_syntax::literal::Literal;

use crate::bind::declarations::block::CurrentBlock;
use crate::bind::declarations::path::{Base, Resolved, Variable};
use crate::bind::declarations::typed::is_complex;
use crate::bind::stl::StlBinder;
use plcc_model::layout;
use plcc_model::types::{DataType, Elementary, ParameterType};
use plcc_model::{ElementIndex, Number, Place};

/// Largest offset of a register-indirect address, P#4095.7, in bits.
pub const OFFSET_MAX: u32 = 4095 * 8 + 7;

/// An operand of known kind.
#[derive(Clone, Debug)]
pub enum Settled<'o> {
    /// An elementary variable or an address; `ty` if a declaration or a symbol table states it.
    Memory {
        place: Place,
        width: Width,
        ty: Option<Elementary>,
    },
    /// A variable that is larger than an accumulator, or a POINTER or ANY parameter.
    Complex {
        place: Place,
        ty: DataType,
    },
    Cell {
        kind: CellKind,
        number: Number,
    },
    Block {
        prefix: BlockPrefix,
        number: Number,
    },
    Literal(&'o Literal),
    /// `P##name` with a known address.
    Pointer(u32),
    /// `P##p` of a parameter of an FC.
    ParameterPointer(usize),
    Status(StatusOperand),
    Special(SpecialRegister),
    Register(AddressRegister),
    Label,
}

impl StlBinder<'_, '_> {
    /// Determines what an operand is; `None` after a message, or if it is not known.
    pub fn settle<'o>(&mut self, ctx: &mut CurrentBlock, operand: &'o ast::Operand) -> Option<Settled<'o>> {
        let span = operand.span;
        match &operand.kind {
            OperandKind::Absolute { area, width, byte, bit } => {
                self.program.check_address(ctx, *area, *width, *byte, span)?;
                let place = Base::of_area(*area).at(*byte, *bit);
                Some(Settled::Memory { place, width: *width, ty: None })
            }
            OperandKind::Cell { kind, number } => {
                let number = Number::Known(self.program.globals.check_cell(*kind, *number, span)?);
                Some(Settled::Cell { kind: *kind, number })
            }
            OperandKind::DbAbsolute { db, width, byte, bit } => self.db_absolute(ctx, db, *width, *byte, *bit, span),
            OperandKind::MemoryIndirect { area, width, pointer } => {
                let place = self.pointer_place(ctx, pointer, Width::Dword)?;
                let place = Place::Indirect { area: *area, pointer: Box::new(place) };
                Some(Settled::Memory { place, width: *width, ty: None })
            }
            OperandKind::CellIndirect { kind, pointer } => {
                let place = self.pointer_place(ctx, pointer, Width::Word)?;
                Some(Settled::Cell { kind: *kind, number: Number::Word(Box::new(place)) })
            }
            OperandKind::BlockIndirect { prefix, pointer } => {
                let place = self.pointer_place(ctx, pointer, Width::Word)?;
                Some(Settled::Block { prefix: *prefix, number: Number::Word(Box::new(place)) })
            }
            OperandKind::RegisterIndirect { area, width, register, offset } => {
                if *offset > OFFSET_MAX {
                    self.program.report(
                        Diagnostic::new(Code::AddressRange, span, "this offset is too large")
                            .label("P#0.0 to P#4095.7"),
                    );
                    return None;
                }
                let place = Place::Register { area: *area, register: *register, offset: *offset };
                Some(Settled::Memory { place, width: *width, ty: None })
            }
            OperandKind::Block(name) => {
                let (prefix, number) = self.program.globals.block_number(name)?;
                Some(Settled::Block { prefix, number: Number::Known(number) })
            }
            OperandKind::Path(path) => self.settle_path(ctx, path),
            OperandKind::Peripheral(path) => self.peripheral(ctx, path, span),
            OperandKind::AddressOf(path) => self.address_of(ctx, path, span),
            OperandKind::Literal(literal) => Some(Settled::Literal(literal)),
            OperandKind::Status(status) => Some(Settled::Status(*status)),
            OperandKind::Special(special) => Some(Settled::Special(*special)),
            OperandKind::Register(register) => Some(Settled::Register(*register)),
            OperandKind::Label(_) => Some(Settled::Label),
            OperandKind::Error => None,
        }
    }

    fn db_absolute(
        &mut self,
        ctx: &mut CurrentBlock,
        db: &BlockName,
        width: Width,
        byte: u32,
        bit: u8,
        span: Span,
    ) -> Option<Settled<'static>> {
        let (prefix, number) = self.program.globals.block_number(db)?;
        if prefix != BlockPrefix::Db {
            self.program.report(
                Diagnostic::new(Code::OperandKind, db.span(), "this is not a data block")
                    .label("a data block is expected before the point"),
            );
            return None;
        }
        self.program.check_address(ctx, Area::Db, width, byte, span)?;
        self.program.use_db(number, span);
        self.program.check_db_end(number, byte + width.bytes(), span);
        Some(Settled::Memory { place: Place::Db { number, byte, bit }, width, ty: None })
    }

    /// Reports an address in a data block with optimised access, which only an assertion may have.
    pub fn check_absolute_access(&mut self, operand: &ast::Operand, settled: &Settled) -> Option<()> {
        match (&operand.kind, settled) {
            (OperandKind::DbAbsolute { .. }, Settled::Memory { place: Place::Db { number, .. }, .. }) => {
                self.program.globals.check_absolute_access(*number, operand.span)
            }
            _ => Some(()),
        }
    }

    /// The word or double word in the brackets of an indirect address.
    fn pointer_place(&mut self, ctx: &mut CurrentBlock, pointer: &ast::Operand, width: Width) -> Option<Place> {
        let settled = self.settle(ctx, pointer)?;
        match settled {
            Settled::Memory { place, width: found, .. } if found == width && holds_pointer(&place) => Some(place),
            _ => {
                let text = self.program.globals.text(pointer.span);
                let (what, example) = match width {
                    Width::Dword => ("a double word", "`[MD 10]`"),
                    Width::Bit | Width::Byte | Width::Word | Width::Lword => ("a word", "`[MW 10]`"),
                };
                self.program.report(
                    Diagnostic::new(Code::OperandKind, pointer.span, format!("`{text}` cannot hold this address"))
                        .label(format!("{what} of M, L, DB or DI is expected here"))
                        .help(format!("write for example {example}, or name a variable of this width")),
                );
                None
            }
        }
    }

    /// `"sym":P`: the input or output itself, past the process image.
    fn peripheral(&mut self, ctx: &mut CurrentBlock, path: &Path, span: Span) -> Option<Settled<'static>> {
        let (resolved, indices) = self.program.resolve(ctx, path)?;
        if !indices.is_empty() {
            return self.no_variable_index(span, "`:P` needs an address that is known");
        }
        let settled = match resolved {
            Resolved::Variable(variable) => match variable.base {
                Base::I => Some(Variable { base: Base::Pi, ..variable }),
                Base::Q => Some(Variable { base: Base::Pq, ..variable }),
                // What stands in for a missing input or output is in no process image.
                _ => self.is_stand_in(&path.root).then_some(variable),
            },
            Resolved::Cell { .. } | Resolved::Block { .. } => None,
        };
        match settled {
            Some(variable) => self.settle_variable(ctx, variable, Vec::new()),
            None => {
                let text = self.program.globals.text(span);
                self.program.report(
                    Diagnostic::new(Code::OperandKind, span, format!("`{text}` is neither an input nor an output"))
                        .label("`:P` reads an input or writes an output past the process image")
                        .help("remove `:P`"),
                );
                None
            }
        }
    }

    fn is_stand_in(&mut self, root: &PathRoot) -> bool {
        match root {
            PathRoot::Quoted { name, span } | PathRoot::Bare { name, span } => {
                self.program.stand_in(name, *span).is_some()
            }
            PathRoot::Local { .. } | PathRoot::Block(_) => false,
        }
    }

    pub fn no_variable_index<T>(&mut self, span: Span, label: &str) -> Option<T> {
        let text = self.program.globals.text(span);
        self.program.report(
            Diagnostic::new(Code::OperandKind, span, format!("`{text}` cannot have a variable as index"))
                .label(label)
                .help("write a number in the brackets"),
        );
        None
    }

    pub fn settle_path(&mut self, ctx: &mut CurrentBlock, path: &Path) -> Option<Settled<'static>> {
        let (resolved, indices) = self.program.resolve(ctx, path)?;
        match resolved {
            Resolved::Cell { kind, number } => {
                let number = Number::Known(self.program.globals.check_cell(kind, number, path.span)?);
                Some(Settled::Cell { kind, number })
            }
            Resolved::Block { prefix, number } => Some(Settled::Block { prefix, number: Number::Known(number) }),
            Resolved::Variable(variable) => self.settle_variable(ctx, variable, indices),
        }
    }

    fn settle_variable(
        &mut self,
        ctx: &mut CurrentBlock,
        variable: Variable,
        indices: Vec<ElementIndex>,
    ) -> Option<Settled<'static>> {
        let place = variable.place().with_indices(indices);
        let number = |place: Place| match place {
            Place::Parameter { parameter, .. } => Number::Parameter(parameter),
            place => Number::Word(Box::new(place)),
        };
        Some(match variable.ty {
            DataType::Elementary(ty) => {
                if variable.base == Base::L {
                    ctx.local_bytes = ctx.local_bytes.max(variable.byte + ty.bits().div_ceil(8));
                }
                Settled::Memory { place, width: layout::width(ty), ty: (!variable.untyped).then_some(ty) }
            }
            DataType::Parameter(ParameterType::Timer) => Settled::Cell { kind: CellKind::Timer, number: number(place) },
            DataType::Parameter(ParameterType::Counter) => {
                Settled::Cell { kind: CellKind::Counter, number: number(place) }
            }
            DataType::Parameter(ParameterType::BlockFb) => {
                Settled::Block { prefix: BlockPrefix::Fb, number: number(place) }
            }
            DataType::Parameter(ParameterType::BlockFc) => {
                Settled::Block { prefix: BlockPrefix::Fc, number: number(place) }
            }
            DataType::Parameter(ParameterType::BlockDb | ParameterType::BlockSdb) => {
                Settled::Block { prefix: BlockPrefix::Db, number: number(place) }
            }
            ty @ DataType::Parameter(ParameterType::Pointer | ParameterType::Any | ParameterType::Variant) => {
                Settled::Complex { place, ty }
            }
            ty if is_complex(&ty) => Settled::Complex { place, ty },
            // Its type is unknown and reported.
            _ => return None,
        })
    }

    /// `P##name`: the address of a variable of this block.
    ///
    /// TEMP: a pointer into L. FB: the offset in the instance as a pointer into DI, without AR2. FC: for complex, POINTER and ANY
    /// parameters the place of the POINTER or ANY, for elementary ones the area pointer of the actual. Source: STL reference, access to
    /// formal parameters.
    fn address_of(&mut self, ctx: &mut CurrentBlock, path: &Path, span: Span) -> Option<Settled<'static>> {
        let (resolved, indices) = self.program.resolve(ctx, path)?;
        if !indices.is_empty() {
            return self.no_variable_index(span, "`P##` is the address of a whole variable");
        }
        let Resolved::Variable(variable) = resolved else {
            self.program.report(
                Diagnostic::new(Code::OperandKind, span, "`P##` needs a variable of this block")
                    .label("this is not a variable of this block"),
            );
            return None;
        };
        let pointer = |area: u8, byte: u32, bit: u8| u32::from(area) << 24 | byte << 3 | u32::from(bit);
        match variable.base {
            Base::L => Some(Settled::Pointer(pointer(plcc_abi::layout::area::L, variable.byte, variable.bit))),
            Base::Instance => Some(Settled::Pointer(pointer(plcc_abi::layout::area::DI, variable.byte, variable.bit))),
            Base::ThroughPointer(at) if path.parts.is_empty() => {
                Some(Settled::Pointer(pointer(plcc_abi::layout::area::DI, at, 0)))
            }
            Base::Parameter(parameter)
                if path.parts.is_empty()
                    && (is_complex(&variable.ty)
                        || matches!(variable.ty, DataType::Elementary(_))
                        || matches!(
                            variable.ty,
                            DataType::Parameter(ParameterType::Pointer | ParameterType::Any | ParameterType::Variant)
                        )) =>
            {
                Some(Settled::ParameterPointer(parameter))
            }
            // Its type is not defined, which is already reported.
            Base::Parameter(_) if variable.ty == DataType::Void => None,
            Base::Parameter(_) | Base::ThroughPointer(_) => {
                let text = self.program.globals.text(span);
                let name = layout::type_name(&variable.ty);
                self.program.report(
                    Diagnostic::new(Code::OperandKind, span, format!("`{text}` has no address in this block"))
                        .label(format!("a parameter of type {name}, which is in the caller's memory"))
                        .help(
                            "`P##` works for parameters of all types except TIMER, COUNTER and BLOCK_x, without a component",
                        ),
                );
                None
            }
            base => {
                let place = base.at(variable.byte, variable.bit);
                let text = self.program.globals.text(span);
                let help = match place {
                    Place::I { byte, bit } => format!("write `P#I {byte}.{bit}`"),
                    Place::Q { byte, bit } => format!("write `P#Q {byte}.{bit}`"),
                    Place::M { byte, bit } => format!("write `P#M {byte}.{bit}`"),
                    _ => "write a pointer constant such as `P#DBX 4.0`".to_string(),
                };
                self.program.report(
                    Diagnostic::new(Code::OperandKind, span, format!("`{text}` is not a variable of this block"))
                        .label("`P##` needs a parameter, static or temporary data")
                        .help(help),
                );
                None
            }
        }
    }
}

/// Pointers and numbers in memory are in M, L or a data block.
pub fn holds_pointer(place: &Place) -> bool {
    match place {
        Place::M { .. }
        | Place::L { .. }
        | Place::OpenDb { .. }
        | Place::OpenDi { .. }
        | Place::Db { .. }
        | Place::Instance { .. }
        | Place::Parameter { .. }
        | Place::ThroughPointer { .. } => true,
        Place::Element { base, .. } => holds_pointer(base),
        Place::I { .. }
        | Place::Q { .. }
        | Place::Pi { .. }
        | Place::Pq { .. }
        | Place::Indirect { .. }
        | Place::Register { .. } => false,
    }
}
