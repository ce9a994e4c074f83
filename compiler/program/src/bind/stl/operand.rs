//! Operands of instructions: the operand is checked against the operand class of the instruction table.

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{self, AddressRegister, Area, BlockPrefix, CellKind, SpecialRegister, Width};
use plcc_syntax::literal::Literal;
use plcc_syntax::stl::{Mnemonics, OperandClass, StlInsn, value_of_function};
use plcc_syntax::{Class, Elementary};

use crate::bind::declarations::block::CurrentBlock;
use crate::bind::globals::names::code_kind;
use crate::bind::stl::StlBinder;
use crate::bind::stl::settle::{OFFSET_MAX, Settled, holds_pointer};
use plcc_binding::value;
use plcc_model::layout;
use plcc_model::types::DataType;
use plcc_model::{BlockKey, Number, Operand, Place};

/// What an instruction needs, as half a sentence.
fn wanted(class: OperandClass) -> (&'static str, &'static str) {
    match class {
        OperandClass::None => ("cannot have an operand", "remove the operand"),
        OperandClass::Bit | OperandClass::BitOrNone => {
            ("combines one bit", "name one bit, e.g. `M 10.0`, a timer, a counter or a status bit")
        }
        OperandClass::BitWrite => ("writes one bit", "name one bit of I, Q, M, L or a data block, e.g. `Q 4.0`"),
        OperandClass::BitWriteOrCounter => ("sets one bit or a counter", "name a bit, e.g. `Q 4.0`, or a counter"),
        OperandClass::BitWriteOrCell => {
            ("resets one bit, a timer or a counter", "name a bit, e.g. `Q 4.0`, a timer or a counter")
        }
        OperandClass::LoadSource => (
            "loads a byte, word or double word",
            "name a byte, word or double word, e.g. `MW 10`, a constant, a timer or a counter",
        ),
        OperandClass::TransferTarget => {
            ("writes a byte, word or double word", "name a byte, word or double word that can be written, e.g. `MW 10`")
        }
        OperandClass::Timer => ("starts a timer", "name a timer, e.g. `T 5`"),
        OperandClass::Counter => ("counts a counter", "name a counter, e.g. `C 5`"),
        OperandClass::Cell => ("needs a timer or a counter", "name a timer or a counter, e.g. `T 5`"),
        OperandClass::LoadAr1 | OperandClass::LoadAr2 => (
            "loads an address register",
            "write nothing, a double word such as `MD 10`, or a pointer such as `P#M 10.0`",
        ),
        OperandClass::TransferAr1 | OperandClass::TransferAr2 => {
            ("writes an address register to memory", "write nothing or a double word such as `MD 10`")
        }
        OperandClass::PointerOrNone => ("adds to an address register", "write nothing or an offset such as `P#4.0`"),
        OperandClass::Byte => ("needs a number from 0 to 255", "write a number from 0 to 255"),
        OperandClass::AddConstant => ("adds a constant", "write a constant such as `5` or `L#70000`"),
        OperandClass::WordConstOrNone => {
            ("combines ACCU1 with ACCU2 or a constant of 16 bits", "write nothing or a constant such as `W#16#0FFF`")
        }
        OperandClass::DwordConstOrNone => (
            "combines ACCU1 with ACCU2 or a constant of 32 bits",
            "write nothing or a constant such as `DW#16#0000_FFFF`",
        ),
        OperandClass::ShiftCount16 => ("shifts by a number of bits", "write nothing or a number from 0 to 15"),
        OperandClass::ShiftCount32 => ("shifts by a number of bits", "write nothing or a number from 0 to 32"),
        OperandClass::Label => ("jumps to a label", "name a label of this block"),
        OperandClass::Block => ("calls a block", "name an FC, FB, SFC or SFB"),
        OperandClass::DataBlock => ("opens a data block", "name a data block, e.g. `DB 10` or `DI 10`"),
    }
}

impl StlBinder<'_, '_> {
    /// Checks and settles the operand of `insn`; `None` after a message.
    pub fn bind_operand(
        &mut self,
        ctx: &mut CurrentBlock,
        insn: StlInsn,
        mnemonic: Span,
        operand: Option<&ast::Operand>,
    ) -> Option<Operand> {
        let class = insn.operand();
        let Some(operand) = operand else {
            return self.without_operand(class, mnemonic);
        };
        if class == OperandClass::None {
            let name = self.program.globals.text(mnemonic);
            self.program.report(
                Diagnostic::new(Code::SurplusOperand, operand.span, format!("`{name}` cannot have an operand"))
                    .label("this operand is not possible")
                    .help("remove the operand, or end the statement before it"),
            );
            return None;
        }
        let constant = self.constant_operand(ctx, operand);
        let operand = constant.as_ref().unwrap_or(operand);
        let settled = self.settle(ctx, operand)?;
        self.check_absolute_access(operand, &settled)?;
        if let (StlInsn::Load | StlInsn::Transfer, Settled::Memory { ty: Some(ty), .. }) = (insn, &settled)
            && (matches!(ty.class(), Class::Signed | Class::Unsigned | Class::Float) || *ty == Elementary::Time)
        {
            self.program.numbers.insert((operand.span.file, operand.span.end), *ty);
        }
        let bound = self.check_class(class, mnemonic, operand.span, settled)?;
        if let (StlInsn::EdgePositive | StlInsn::EdgeNegative, Operand::Memory { place, .. }) = (insn, &bound) {
            self.check_edge_bit(place, operand.span);
        }
        Some(bound)
    }

    /// An edge memory bit keeps its value from one cycle to the next.
    fn check_edge_bit(&mut self, place: &Place, span: Span) {
        let elsewhere = "a bit of M, of a data block or static data of an FB";
        let message = match place.root() {
            Place::L { .. } => {
                let text = "an edge memory bit in local data is lost after the block";
                let message = Diagnostic::new(Code::EdgeBitLocal, span, text).label("temporary data");
                message.help(format!("use {elsewhere}"))
            }
            Place::I { .. } => {
                let (text, scan) = (self.program.globals.text(span), StlInsn::And.mnemonic(self.mnemonics(span)));
                Diagnostic::new(Code::EdgeBit, span, format!("`{text}` cannot remember an edge"))
                    .label("an input, which the process image overwrites")
                    .help(format!("scan the input before the edge, `{scan} {text}`, and use {elsewhere} here"))
            }
            _ => return,
        };
        self.program.report(message);
    }

    fn without_operand(&mut self, class: OperandClass, mnemonic: Span) -> Option<Operand> {
        if class.may_be_missing() {
            return Some(Operand::None);
        }
        let (does, help) = wanted(class);
        let name = self.program.globals.text(mnemonic);
        self.program.report(
            Diagnostic::new(Code::MissingOperand, mnemonic, format!("`{name}` {does} and needs an operand"))
                .label("the operand is missing")
                .help(help),
        );
        None
    }

    /// Reports an operand that does not fit its instruction.
    fn unfit<T>(&mut self, class: OperandClass, mnemonic: Span, span: Span, settled: &Settled) -> Option<T> {
        let (does, help) = wanted(class);
        let (name, text) = (self.program.globals.text(mnemonic), self.program.globals.text(span));
        // A name in quotes is one of the program, also where the library has a function of that name.
        let symbol = text.trim_matches('"');
        if let (Settled::Block { .. }, true) =
            (settled, text.starts_with('"') && self.program.globals.is_only_in_library(symbol))
        {
            self.program.globals.unknown_operand(symbol, span, std::iter::empty());
            return None;
        }
        let help = self.own_help(class, &text, span, settled).unwrap_or_else(|| help.to_string());
        let (code, is) = match settled {
            // The declared type does not fit; the address alone would be fine.
            Settled::Memory { ty: Some(ty), .. } => (Code::WidthMismatch, format!("is of type {}", ty.name())),
            Settled::Complex { ty, .. } => (Code::WidthMismatch, format!("is of type {}", layout::type_name(ty))),
            Settled::Memory { width, .. } => (
                Code::OperandKind,
                match width {
                    Width::Bit => "is one bit".to_string(),
                    Width::Byte => "is a byte".to_string(),
                    Width::Word => "is a word of 16 bits".to_string(),
                    Width::Dword => "is a double word of 32 bits".to_string(),
                    Width::Lword => "is a long word of 64 bits".to_string(),
                },
            ),
            Settled::Cell { kind: CellKind::Timer, .. } => (Code::OperandKind, "is a timer".to_string()),
            Settled::Cell { kind: CellKind::Counter, .. } => (Code::OperandKind, "is a counter".to_string()),
            Settled::Block { prefix, .. } => (Code::OperandKind, format!("is a block ({})", prefix.letters())),
            Settled::Literal(literal) => (Code::OperandKind, format!("is {}", value::literal_kind(literal))),
            Settled::Pointer(_) | Settled::ParameterPointer(_) => (Code::OperandKind, "is a pointer".to_string()),
            Settled::Status(_) => (Code::OperandKind, "is a status bit".to_string()),
            Settled::Special(_) | Settled::Register(_) => (Code::OperandKind, "is a register of the CPU".to_string()),
            Settled::Label => (Code::OperandKind, "is a label".to_string()),
        };
        self.program.report(
            Diagnostic::new(code, span, format!("`{name}` {does}, but `{text}` {is}"))
                .label(is)
                .also(mnemonic, does)
                .help(help),
        );
        None
    }

    /// The mnemonics of the file of a place.
    fn mnemonics(&self, span: Span) -> Mnemonics {
        let unit = self.program.globals.input.units.iter().find(|(file, _)| *file == span.file);
        unit.map(|(_, unit)| unit.mnemonics).unwrap_or_default()
    }

    /// What to write for an operand that another instruction takes, or of which an instruction takes a part.
    fn own_help(&self, class: OperandClass, text: &str, span: Span, settled: &Settled) -> Option<String> {
        let set = self.mnemonics(span);
        let is_value = matches!(class, OperandClass::LoadSource | OperandClass::TransferTarget);
        let writes_bit =
            matches!(class, OperandClass::BitWrite | OperandClass::BitWriteOrCounter | OperandClass::BitWriteOrCell);
        match settled {
            Settled::Block { prefix: BlockPrefix::Fc | BlockPrefix::Sfc, .. } if is_value => {
                Some(value_of_function(class).to_owned())
            }
            Settled::Memory { width: Width::Bit, .. } => match class {
                OperandClass::LoadSource => {
                    Some(format!("write `{} {text}` to read the bit", StlInsn::And.mnemonic(set)))
                }
                OperandClass::TransferTarget => Some(format!("write `= {text}`, which writes the RLO to the bit")),
                _ => None,
            },
            Settled::Memory { ty, width, .. } if class == OperandClass::AddConstant => {
                let letter = match (ty.map(Elementary::class), width) {
                    (Some(Class::Float), _) => 'R',
                    (_, Width::Dword) => 'D',
                    _ => 'I',
                };
                let load = StlInsn::Load.mnemonic(set);
                Some(format!("write `{load} {text}` on the line before, and here `+{letter}`"))
            }
            Settled::Memory { .. } if matches!(class, OperandClass::ShiftCount16 | OperandClass::ShiftCount32) => {
                let load = StlInsn::Load.mnemonic(set);
                Some(format!(
                    "write `{load} {text}` before the value is loaded: without an operand, the count is in ACCU2"
                ))
            }
            Settled::Memory { .. } if writes_bit => {
                Some(format!("name a bit; for the value in ACCU1 write `T {text}`"))
            }
            Settled::Memory { .. } if matches!(class, OperandClass::Bit | OperandClass::BitOrNone) => {
                Some(format!("name a bit; for the value write `L {text}`, and compare it with another one"))
            }
            Settled::Complex { ty: DataType::Array(array), .. } if is_value => {
                let first: Vec<String> = array.bounds.iter().map(|(low, _)| low.to_string()).collect();
                Some(format!("name an element, as in `{text}[{}]`", first.join(", ")))
            }
            Settled::Complex { ty: DataType::String(_), .. } if is_value => {
                Some(format!("name a character, as in `{text}[1]`; blocks such as LEN take the whole text"))
            }
            Settled::Complex { ty: DataType::Struct(structure), .. } if is_value => {
                structure.members.first().map(|first| format!("name a component, as in `{text}.{}`", first.name))
            }
            _ => None,
        }
    }

    fn check_class(&mut self, class: OperandClass, mnemonic: Span, span: Span, settled: Settled) -> Option<Operand> {
        use OperandClass as Class;
        match (class, settled) {
            (Class::Bit | Class::BitOrNone, Settled::Memory { place: Place::Pq { .. }, width: Width::Bit, .. }) => {
                let text = self.program.globals.text(span);
                self.program.report(
                    Diagnostic::new(Code::OperandKind, span, format!("`{text}` cannot be read"))
                        .label("this is a peripheral output")
                        .help("read the process image, without `:P`"),
                );
                None
            }
            (
                Class::BitWrite | Class::BitWriteOrCounter | Class::BitWriteOrCell,
                Settled::Memory { place: Place::Pi { .. }, width: Width::Bit, .. },
            ) => {
                let text = self.program.globals.text(span);
                self.program.report(
                    Diagnostic::new(Code::Protected, span, format!("`{text}` cannot be written"))
                        .label("this is a peripheral input")
                        .help("only outputs can be written"),
                );
                None
            }
            (
                Class::Bit | Class::BitOrNone | Class::BitWrite | Class::BitWriteOrCounter | Class::BitWriteOrCell,
                Settled::Memory { place, width: Width::Bit, .. },
            ) => Some(Operand::Memory { place, width: Width::Bit }),
            (Class::Bit | Class::BitOrNone, Settled::Status(status)) => Some(Operand::Status(status)),
            (
                Class::Bit | Class::BitOrNone | Class::BitWriteOrCell | Class::Cell | Class::LoadSource,
                Settled::Cell { kind, number },
            ) => Some(Operand::Cell { kind, number }),
            (Class::BitWriteOrCounter | Class::Counter, Settled::Cell { kind: CellKind::Counter, number }) => {
                Some(Operand::Cell { kind: CellKind::Counter, number })
            }
            (Class::Timer, Settled::Cell { kind: CellKind::Timer, number }) => {
                Some(Operand::Cell { kind: CellKind::Timer, number })
            }
            (Class::LoadSource, Settled::Memory { place, width, .. })
                if !matches!(width, Width::Bit | Width::Lword) =>
            {
                if is_peripheral(&place, Area::Pq) {
                    let text = self.program.globals.text(span);
                    self.program.report(
                        Diagnostic::new(Code::OperandKind, span, format!("`{text}` cannot be read"))
                            .label("this is a peripheral output")
                            .help("read the process image, e.g. `QW 4`"),
                    );
                    return None;
                }
                Some(Operand::Memory { place, width })
            }
            (Class::LoadSource, Settled::Special(special)) => Some(Operand::Special(special)),
            (Class::LoadSource | Class::LoadAr1 | Class::LoadAr2, Settled::Pointer(value)) => {
                Some(Operand::Const { value, wide: true })
            }
            (Class::LoadSource | Class::LoadAr1 | Class::LoadAr2, Settled::ParameterPointer(parameter)) => {
                Some(Operand::ParameterPointer { parameter })
            }
            (Class::LoadSource, Settled::Literal(literal)) => self.loaded(literal, span),
            (Class::TransferTarget, Settled::Memory { place, width, .. })
                if !matches!(width, Width::Bit | Width::Lword) =>
            {
                if is_peripheral(&place, Area::Pi) {
                    let text = self.program.globals.text(span);
                    self.program.report(
                        Diagnostic::new(Code::Protected, span, format!("`{text}` cannot be written"))
                            .label("this is a peripheral input")
                            .help("write a peripheral output: `PQW`"),
                    );
                    return None;
                }
                Some(Operand::Memory { place, width })
            }
            (Class::TransferTarget, Settled::Special(SpecialRegister::Stw)) => {
                Some(Operand::Special(SpecialRegister::Stw))
            }
            (
                Class::TransferTarget | Class::BitWrite,
                Settled::Literal(_) | Settled::Pointer(_) | Settled::ParameterPointer(_),
            ) => {
                let text = self.program.globals.text(span);
                self.program.report(
                    Diagnostic::new(Code::Protected, span, format!("`{text}` cannot be written"))
                        .label("a constant")
                        .help("name an address or a variable"),
                );
                None
            }
            (
                Class::LoadAr1 | Class::LoadAr2 | Class::TransferAr1 | Class::TransferAr2,
                Settled::Memory { place, width: Width::Dword, .. },
            ) if holds_pointer(&place) => Some(Operand::Memory { place, width: Width::Dword }),
            (
                Class::LoadAr1 | Class::LoadAr2,
                Settled::Literal(&(Literal::Pointer(value) | Literal::AreaPointer { db: 0, pointer: value })),
            ) => Some(Operand::Const { value, wide: true }),
            (Class::LoadAr1 | Class::TransferAr1, Settled::Register(AddressRegister::Ar2)) => {
                Some(Operand::Register(AddressRegister::Ar2))
            }
            (Class::PointerOrNone, Settled::Literal(&Literal::Pointer(value))) => {
                if value > OFFSET_MAX {
                    self.program.report(
                        Diagnostic::new(Code::AddressRange, span, "this offset is too large")
                            .label("P#0.0 to P#4095.7"),
                    );
                    return None;
                }
                Some(Operand::Const { value, wide: true })
            }
            (Class::Byte, Settled::Literal(literal)) => match byte_constant(literal) {
                Some(value) if value <= 255 => Some(Operand::Const { value, wide: false }),
                Some(_) => {
                    self.program.report(
                        Diagnostic::new(Code::LiteralRange, span, "this number is too large")
                            .label("0 to 255 are possible"),
                    );
                    None
                }
                None => self.unfit(class, mnemonic, span, &Settled::Literal(literal)),
            },
            (
                Class::AddConstant,
                Settled::Literal(
                    literal @ (Literal::Int(_)
                    | Literal::Dint(_)
                    | Literal::Byte(_)
                    | Literal::Word(_)
                    | Literal::Dword(_)
                    | Literal::Bits { .. }),
                ),
            ) => self.loaded(literal, span),
            (Class::WordConstOrNone, Settled::Literal(literal)) => match (value::loaded(literal), literal) {
                (Ok((value, false)), _) | (Ok((value @ ..=0xFFFF, true)), Literal::Bits { .. }) => {
                    Some(Operand::Const { value, wide: false })
                }
                (Ok((_, true)) | Err(_), _) => self.unfit(class, mnemonic, span, &Settled::Literal(literal)),
            },
            (Class::DwordConstOrNone, Settled::Literal(literal)) => match (value::loaded(literal), literal) {
                (Ok((value, true)), _) | (Ok((value, false)), Literal::Bits { .. } | Literal::Text(_)) => {
                    Some(Operand::Const { value, wide: true })
                }
                (Ok((_, false)) | Err(_), _) => self.unfit(class, mnemonic, span, &Settled::Literal(literal)),
            },
            (Class::ShiftCount16 | Class::ShiftCount32, Settled::Literal(literal)) => {
                let most = if class == Class::ShiftCount16 { 15 } else { 32 };
                match byte_constant(literal) {
                    Some(value) if value <= most => Some(Operand::Const { value, wide: false }),
                    Some(_) => {
                        let name = self.program.globals.text(mnemonic);
                        self.program.report(
                            Diagnostic::new(Code::ShiftCount, span, format!("`{name}` cannot shift by that many bits"))
                                .label(format!("0 to {most} are possible"))
                                .help("for a larger count, use ACCU2-LL and no operand"),
                        );
                        None
                    }
                    None => self.unfit(class, mnemonic, span, &Settled::Literal(literal)),
                }
            }
            (Class::Block, Settled::Block { prefix, number }) => match code_kind(prefix) {
                Some(kind) if kind != BlockKind::Ob => self.called(kind, number, mnemonic, span),
                Some(_) | None => self.unfit(class, mnemonic, span, &Settled::Block { prefix, number }),
            },
            (Class::DataBlock, Settled::Block { prefix: prefix @ (BlockPrefix::Db | BlockPrefix::Di), number }) => {
                if let Number::Known(number) = number {
                    self.program.use_db(number, span);
                }
                Some(Operand::Db { di: prefix == BlockPrefix::Di, number })
            }
            (class, settled) => self.unfit(class, mnemonic, span, &settled),
        }
    }

    /// A constant as `L` and `+` accept it.
    pub fn loaded(&mut self, literal: &Literal, span: Span) -> Option<Operand> {
        match value::loaded(literal) {
            Ok((value, wide)) => Some(Operand::Const { value, wide }),
            Err(why) => {
                let (code, title, help) = match literal {
                    Literal::Int(_) => (
                        Code::LiteralRange,
                        "this number is not an INT",
                        "write `L#` before it for a double integer, or `W#16#` for a bit pattern",
                    ),
                    _ => {
                        (Code::OperandKind, "this constant cannot be loaded", "`L` accepts constants of up to 32 bits")
                    }
                };
                self.program.report(Diagnostic::new(code, span, title).label(why).help(help));
                None
            }
        }
    }

    /// A block called by UC or CC, which pass no parameters.
    fn called(&mut self, kind: BlockKind, number: Number, mnemonic: Span, span: Span) -> Option<Operand> {
        if let Number::Known(known) = number {
            let bound = self.program.interface(BlockKey { kind, number: known }, span)?;
            if matches!(kind, BlockKind::Fc | BlockKind::Sfc) && !bound.interface.parameters.is_empty() {
                let name = self.program.globals.text(mnemonic);
                let parameters: Vec<&str> =
                    bound.interface.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
                self.program.report(
                    Diagnostic::new(Code::MissingParameter, span, format!("`{name}` cannot pass parameters"))
                        .label(format!("this block has the parameters {}", parameters.join(", ")))
                        .help("use CALL"),
                );
                return None;
            }
        }
        Some(Operand::Block { kind, number })
    }
}

/// A number that an instruction needs as a constant.
fn byte_constant(literal: &Literal) -> Option<u32> {
    match literal {
        Literal::Int(value) => u32::try_from(*value).ok().or(Some(u32::MAX)),
        Literal::Byte(value) => Some(u32::from(*value)),
        Literal::Bits { value, .. } => Some(*value),
        _ => None,
    }
}

/// Whether `place` is in the peripheral area `area`, PI or PQ.
fn is_peripheral(place: &Place, area: Area) -> bool {
    match place {
        Place::Pi { .. } => area == Area::Pi,
        Place::Pq { .. } => area == Area::Pq,
        Place::Indirect { area: found, .. } | Place::Register { area: Some(found), .. } => *found == area,
        Place::Element { base, .. } => is_peripheral(base, area),
        Place::I { .. }
        | Place::Q { .. }
        | Place::M { .. }
        | Place::L { .. }
        | Place::OpenDb { .. }
        | Place::OpenDi { .. }
        | Place::Db { .. }
        | Place::Instance { .. }
        | Place::Parameter { .. }
        | Place::ThroughPointer { .. }
        | Place::Register { area: None, .. } => false,
    }
}
