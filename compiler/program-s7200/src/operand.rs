//! Operands of instructions: whether the class of the instruction table accepts them, and their bound form.

use plcc_abi::s7200::{pointer, system};
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::Width;
use plcc_syntax::s7200::ast::{self, Area, Constant, Direct};
use plcc_syntax::s7200::{self, OperandClass};

use super::Binder;
use super::address;
use super::constant::Target;
use super::interface::Locals;
use super::settle::Settled;
use plcc_model::s7200::{self as model, Operand};

/// Limit of characters of a string constant in an instruction.
const TEXT_MAX: usize = 126;

const MEMORY: &[Area] = &[Area::I, Area::Q, Area::V, Area::M, Area::Sm, Area::S, Area::L];
const BITS: &[Area] = &[Area::I, Area::Q, Area::V, Area::M, Area::Sm, Area::S, Area::L, Area::T, Area::C];

/// The operands that a class accepts.
struct Shape {
    width: Width,
    areas: &'static [Area],
    write: bool,
    /// Accumulators.
    ac: bool,
    indirect: bool,
    /// How constants are interpreted.
    constant: Option<Target>,
}

const WORDS_READ: &[Area] =
    &[Area::I, Area::Q, Area::V, Area::M, Area::Sm, Area::S, Area::L, Area::T, Area::C, Area::Ai];
const WORDS_WRITTEN: &[Area] =
    &[Area::I, Area::Q, Area::V, Area::M, Area::Sm, Area::S, Area::L, Area::T, Area::C, Area::Aq];
const DWORDS_READ: &[Area] = &[Area::I, Area::Q, Area::V, Area::M, Area::Sm, Area::S, Area::L, Area::Hc];

/// The shape of a class that accepts places; `None`: constants, blocks and others.
fn shape(class: OperandClass) -> Option<Shape> {
    use OperandClass as C;
    let shape = |width, areas, write, ac, constant| {
        Some(Shape { width, areas, write, ac, indirect: width != Width::Bit, constant })
    };
    let only = |width, areas, write| Some(Shape { width, areas, write, ac: false, indirect: false, constant: None });
    let integer = |width| Some(Target::Integer(width));
    match class {
        C::Bit => shape(Width::Bit, BITS, false, false, None),
        C::BitWrite => shape(Width::Bit, BITS, true, false, None),
        C::InputBit => only(Width::Bit, &[Area::I], false),
        C::OutputBit => only(Width::Bit, &[Area::Q], true),
        C::SBit => only(Width::Bit, &[Area::S], true),
        C::InputByte => only(Width::Byte, &[Area::I], false),
        C::OutputByte => only(Width::Byte, &[Area::Q], true),
        C::LoopTable => only(Width::Byte, &[Area::V], true),
        C::SignedCount => shape(Width::Byte, MEMORY, false, true, Some(Target::AnyByte)),
        C::ByteIn | C::Count => shape(Width::Byte, MEMORY, false, true, integer(Width::Byte)),
        C::ByteOut => shape(Width::Byte, MEMORY, true, true, None),
        C::WordIn => shape(Width::Word, WORDS_READ, false, true, integer(Width::Word)),
        C::IntIn => shape(Width::Word, WORDS_READ, false, true, Some(Target::Signed(Width::Word))),
        C::WordOut => shape(Width::Word, BITS, true, true, None),
        C::WordOutAnalog => shape(Width::Word, WORDS_WRITTEN, true, true, None),
        C::DwordIn | C::DwordInAddress => shape(Width::Dword, DWORDS_READ, false, true, integer(Width::Dword)),
        C::DintIn => shape(Width::Dword, DWORDS_READ, false, true, Some(Target::Signed(Width::Dword))),
        C::DwordOut | C::RealOut => shape(Width::Dword, MEMORY, true, true, None),
        C::RealIn => shape(Width::Dword, MEMORY, false, true, Some(Target::Real)),
        C::StringIn => shape(Width::Byte, &[Area::V, Area::L], false, false, None),
        C::StringOut => shape(Width::Byte, &[Area::V, Area::L], true, false, None),
        C::Buffer | C::BytesIn => shape(Width::Byte, MEMORY, false, false, None),
        C::BytesOut => shape(Width::Byte, MEMORY, true, false, None),
        C::Table => shape(Width::Word, BITS, false, false, None),
        C::WordsIn => shape(Width::Word, WORDS_READ, false, false, None),
        C::WordsOut => shape(Width::Word, WORDS_WRITTEN, true, false, None),
        C::DwordsIn => shape(Width::Dword, MEMORY, false, false, None),
        C::DwordsOut => shape(Width::Dword, MEMORY, true, false, None),
        C::Timer | C::Counter | C::Number(_) | C::Label | C::Subroutine | C::Interrupt => None,
    }
}

/// The width of the operands of a class; none for timers, blocks, labels and constants.
pub fn width(class: OperandClass) -> Option<Width> {
    shape(class).map(|shape| shape.width)
}

/// Whether an operand of this class can be in the area of the address.
pub fn has_area(class: OperandClass, direct: Direct) -> bool {
    match (class, direct.area) {
        (OperandClass::Timer, area) => area == Area::T,
        (OperandClass::Counter, area) => area == Area::C,
        (class, Area::Ac) => shape(class).is_some_and(|shape| shape.ac),
        (class, area) => shape(class).is_some_and(|shape| shape.areas.contains(&area)),
    }
}

/// Whether the address may have the width of the class. That of timers, counters and accumulators is the one that an instruction needs.
pub fn has_width(class: OperandClass, direct: Direct) -> bool {
    width(class).is_none_or(|width| direct.width.is_none_or(|own| own == width))
}

/// Whether an instruction writes to an operand of this class, or drives it.
pub fn is_target(class: OperandClass) -> bool {
    matches!(class, OperandClass::Timer | OperandClass::Counter) || shape(class).is_some_and(|shape| shape.write)
}

/// Whether an operand of this class can be a constant beside addresses.
pub fn takes_constants(class: OperandClass) -> bool {
    shape(class).is_some_and(|shape| shape.constant.is_some())
}

/// The operand that a class needs, in words.
pub fn wanted(class: OperandClass) -> &'static str {
    use OperandClass as C;
    match class {
        C::Bit => "a bit: I0.0, Q0.0, V0.0, M0.0, SM0.0, S0.0, L0.0, T37 or C1",
        C::BitWrite => "a bit that can be written: Q0.0, V0.0, M0.0, S0.0, L0.0",
        C::InputBit => "an input bit such as I0.0",
        C::OutputBit => "an output bit such as Q0.0",
        C::SBit => "a bit of the sequence control relays such as S0.1",
        C::ByteIn | C::Count | C::SignedCount => "a byte such as VB10, an accumulator, a pointer or a constant",
        C::ByteOut => "a byte that can be written, such as VB10 or AC0",
        C::WordIn | C::IntIn => "a word such as VW10, a timer, counter, analog input, accumulator, pointer or constant",
        C::WordOut => "a word that can be written, such as VW10 or AC0",
        C::WordOutAnalog => "a word that can be written, such as VW10, AC0 or AQW0",
        C::DwordIn | C::DintIn => "a double word such as VD10, an accumulator, a pointer or a constant",
        C::DwordInAddress => {
            "a double word such as VD10, an accumulator, a pointer, an address such as &VB10 or a constant"
        }
        C::DwordOut => "a double word that can be written, such as VD10 or AC0",
        C::RealIn => "a REAL: a double word such as VD10, an accumulator, a pointer or a constant such as 1.5",
        C::RealOut => "a double word that can be written, such as VD10 or AC0",
        C::StringIn => "a string: VB10, LB10, a pointer or a text in double quotes",
        C::StringOut => "a string: VB10, LB10 or a pointer",
        C::Buffer | C::BytesIn | C::BytesOut => "the first byte of several, such as VB10, or a pointer",
        C::Table => "the first word of a table, such as VW10, or a pointer",
        C::WordsIn | C::WordsOut => "the first word of several, such as VW10, or a pointer",
        C::DwordsIn | C::DwordsOut => "the first double word of several, such as VD10, or a pointer",
        C::Timer => "a timer such as T37",
        C::Counter => "a counter such as C1",
        C::Number(_) => "a constant",
        C::Label => "the number of a label",
        C::LoopTable => "the first byte of a loop table in V memory, such as VB100",
        C::InputByte => "an input byte such as IB0",
        C::OutputByte => "an output byte such as QB0",
        C::Subroutine => "a subroutine",
        C::Interrupt => "an interrupt routine",
    }
}

pub fn width_name(width: Width) -> &'static str {
    match width {
        Width::Bit => "a bit",
        Width::Byte => "a byte",
        Width::Word => "a word",
        Width::Dword | Width::Lword => "a double word",
    }
}

/// A bound place in memory; `None`: it is not in memory.
pub fn memory(direct: Direct, width: Width) -> Option<Operand> {
    let area = match direct.area {
        Area::I => model::Area::I,
        Area::Q => model::Area::Q,
        Area::V => model::Area::V,
        Area::M => model::Area::M,
        Area::Sm => model::Area::Sm,
        Area::S => model::Area::S,
        Area::L => model::Area::L,
        Area::T | Area::C | Area::Hc | Area::Ac | Area::Ai | Area::Aq => return None,
    };
    Some(Operand::Memory { area, byte: direct.number, bit: direct.bit, width })
}

/// Any bound address.
pub fn place(direct: Direct, width: Width) -> Operand {
    let number = direct.number.min(255) as u8;
    match direct.area {
        Area::T => Operand::Timer { number, width },
        Area::C => Operand::Counter { number, width },
        Area::Hc => Operand::HighSpeedCounter(number),
        Area::Ac => Operand::Accumulator { number, width },
        Area::Ai => Operand::AnalogInput { byte: direct.number },
        Area::Aq => Operand::AnalogOutput { byte: direct.number },
        _ => memory(direct, width).unwrap_or(Operand::Const(0)),
    }
}

impl Binder<'_> {
    /// Binds an operand of an instruction; `None`: reported.
    pub fn operand(&mut self, locals: &Locals, class: OperandClass, operand: &ast::Operand) -> Option<Operand> {
        let span = operand.span;
        let text = class == OperandClass::StringIn;
        let settled = self.settle(locals, operand, text)?;
        let Some(shape) = shape(class) else { return self.number_operand(class, settled, span) };
        match settled {
            Settled::Direct(direct) => self.direct(class, &shape, direct, span),
            // The instruction uses the string; `MOVD` uses its pointer.
            Settled::StringVariable(place) => match class {
                OperandClass::StringIn | OperandClass::StringOut => {
                    let pointer = memory(place, Width::Dword)?;
                    Some(Operand::Indirect { pointer: Box::new(pointer), width: Width::Byte })
                }
                _ => self.direct(class, &shape, place, span),
            },
            Settled::Indirect(pointer) if shape.indirect => {
                Some(Operand::Indirect { pointer: Box::new(pointer), width: shape.width })
            }
            Settled::Indirect(_) => {
                let help = "bits, and operands that the instruction fixes, cannot be reached through a pointer";
                self.misfit(class, help, span)
            }
            Settled::Constant(Constant::Text(bytes)) if text => self.text(bytes, span),
            Settled::Constant(Constant::Characters(_)) if text => {
                let written = self.written(span);
                let help = format!("a string is written in double quotes: `\"{}\"`", written.trim_matches('\''));
                self.misfit(class, &help, span)
            }
            Settled::Constant(constant) => match shape.constant {
                Some(Target::Integer(Width::Byte)) if class == OperandClass::Count => {
                    self.count_constant(&constant, span).map(Operand::Const)
                }
                Some(target) => self.constant(&constant, target, span).map(Operand::Const),
                None if class == OperandClass::SBit => {
                    let number = super::constant::whole(&constant).filter(|number| (0..256).contains(number));
                    let bit = number.map_or("S0.1".to_string(), |number| format!("S{}.{}", number / 8, number % 8));
                    self.misfit(class, &format!("write `{bit}`"), span)
                }
                None if shape.write => {
                    self.push(
                        Diagnostic::new(Code::Protected, span, "a constant cannot be written (0090)")
                            .label("the result of the instruction goes here")
                            .help(format!("name {}", wanted(class))),
                    );
                    None
                }
                None => self.misfit(class, "a constant is not possible here", span),
            },
            Settled::Pointer(value) if class == OperandClass::DwordInAddress => Some(Operand::Const(value)),
            Settled::Pointer(_) => {
                let help = "an address of an operand is only possible for MOVD and for parameters: `MOVD &VB100, AC1`";
                self.misfit(class, help, span)
            }
            Settled::Block(_) => self.misfit(class, "the name of a block is not possible here", span),
        }
    }

    /// A direct address at an operand that accepts places.
    fn direct(&mut self, class: OperandClass, shape: &Shape, direct: Direct, span: Span) -> Option<Operand> {
        let width = shape.width;
        if direct.area == Area::Ac {
            return match direct.width {
                _ if !shape.ac => self.misfit(class, "an accumulator is not possible here", span),
                None => {
                    self.check_range(direct, width, 1, span)?;
                    Some(place(direct, width))
                }
                Some(own) if own == width => {
                    self.check_range(direct, width, 1, span)?;
                    Some(place(direct, width))
                }
                Some(_) => self.other_width(class, direct, width, span),
            };
        }
        if !shape.areas.contains(&direct.area) {
            let written = matches!(direct.area, Area::Hc | Area::Ai) && shape.write;
            if written {
                return self.protected(direct, "only the CPU writes it", span);
            }
            let help = match direct.area {
                _ if class == OperandClass::InputBit => {
                    "only inputs have immediate contacts: use the contact without `I` for this bit"
                }
                _ if class == OperandClass::OutputBit => {
                    "only outputs are written immediately: use the instruction without `I` for this bit"
                }
                _ if class == OperandClass::SBit => "sequence steps are bits of S: write one such as S0.1",
                _ if class == OperandClass::LoopTable => "a loop table is in V memory: write an address such as VB100",
                Area::Aq => "only MOVW and other moves write analog outputs; store the value in V memory to read it",
                Area::Ai => "an analog value is a word: use the instruction for words",
                Area::T | Area::C if width != Width::Bit => {
                    "the value of a timer or counter is a word: use the instruction for words"
                }
                Area::Hc => "the value of a high-speed counter is a double word: use the instruction for double words",
                _ => "operands of this area are not possible here",
            };
            return self.misfit(class, help, span);
        }
        let natural = match direct.area {
            // The bit or the current value, as the instruction needs it.
            Area::T | Area::C => direct.width.unwrap_or(width),
            Area::Ai | Area::Aq => Width::Word,
            Area::Hc => Width::Dword,
            _ => direct.width.unwrap_or(width),
        };
        if natural != width {
            return self.other_width(class, direct, width, span);
        }
        self.check_range(direct, width, 1, span)?;
        if shape.write && direct.area == Area::Sm && direct.number < system::SM_READ_ONLY_BYTES {
            return self.protected(direct, "SMB0 to SMB29 can only be read", span);
        }
        Some(place(direct, width))
    }

    fn protected(&mut self, direct: Direct, label: &str, span: Span) -> Option<Operand> {
        let title = format!("{} cannot be written (0090)", address::text(direct));
        self.push(Diagnostic::new(Code::Protected, span, title).label(label).help("write to another address"));
        None
    }

    fn other_width(&mut self, class: OperandClass, direct: Direct, width: Width, span: Span) -> Option<Operand> {
        let own = direct.width.map_or("of another width", width_name);
        let same = self.of_width(direct, width, span);
        let message = self.width_message(class, direct, width, span);
        self.push(message.help(format!("use the instruction for {own}, or {same}")));
        None
    }

    /// The address has another width than the class.
    pub fn width_message(&self, class: OperandClass, direct: Direct, width: Width, span: Span) -> Diagnostic {
        let own = direct.width.map_or("of another width", width_name);
        let shown = self.shown(direct, span);
        let title = format!("{shown} is {own}, the instruction needs {} (0090)", width_name(width));
        Diagnostic::new(Code::OperandKind, span, title).label(format!("expected: {}", wanted(class)))
    }

    /// The operand at `span`, which is `direct`, for a message.
    pub fn shown(&self, direct: Direct, span: Span) -> String {
        match self.is_symbol(span) {
            true => format!("`{}` ({})", self.written(span), address::text(direct)),
            false => address::text(direct),
        }
    }

    /// What has this width in place of the operand at `span`, which is `direct`.
    pub fn of_width(&self, direct: Direct, width: Width, span: Span) -> String {
        match self.is_symbol(span) {
            true => format!("a name of {}", width_name(width)),
            false => format!("an operand such as {}", address::text(Direct { width: Some(width), bit: 0, ..direct })),
        }
    }

    /// Whether the operand at `span` is a name.
    fn is_symbol(&self, span: Span) -> bool {
        let written = self.written(span);
        written.starts_with(|c: char| c.is_alphabetic() || matches!(c, '#' | '"' | '_'))
            && s7200::parse_address(&written.replace([' ', '\t'], "")).is_none()
    }

    fn misfit(&mut self, class: OperandClass, help: &str, span: Span) -> Option<Operand> {
        self.push(
            Diagnostic::new(Code::OperandKind, span, "this operand does not fit the instruction (0090)")
                .label(format!("expected: {}", wanted(class)))
                .help(help),
        );
        None
    }

    /// A string constant.
    pub fn text(&mut self, bytes: Vec<u8>, span: Span) -> Option<Operand> {
        if bytes.len() > TEXT_MAX {
            let title = format!("a string of {} characters is too long (0090)", bytes.len());
            self.push(
                Diagnostic::new(Code::LiteralRange, span, title)
                    .label(format!("an instruction has room for {TEXT_MAX}"))
                    .help("put it into the data block, and name its address"),
            );
            return None;
        }
        Some(Operand::Text(bytes))
    }

    /// A number of elements. The instruction may have a lower limit.
    fn count_constant(&mut self, constant: &Constant, span: Span) -> Option<u32> {
        let Some(count) = super::constant::whole(constant).filter(|count| !(0..=255).contains(count)) else {
            return self.constant(constant, Target::Integer(Width::Byte), span);
        };
        self.push(
            Diagnostic::new(Code::LiteralRange, span, format!("`{count}` is not a number of elements (0090)"))
                .label("a count is a byte without a sign")
                .help("write a count from 1 to 255"),
        );
        None
    }

    /// Timers, counters, labels and other constants that identify something.
    fn number_operand(&mut self, class: OperandClass, settled: Settled, span: Span) -> Option<Operand> {
        use OperandClass as C;
        match (class, settled) {
            (C::Timer, Settled::Direct(direct)) if direct.area == Area::T && direct.width.is_none() => {
                self.check_range(direct, Width::Word, 1, span)?;
                Some(place(direct, Width::Word))
            }
            (C::Counter, Settled::Direct(direct)) if direct.area == Area::C && direct.width.is_none() => {
                self.check_range(direct, Width::Word, 1, span)?;
                Some(place(direct, Width::Word))
            }
            (C::Number(max), Settled::Constant(constant)) => {
                self.number(&constant, u32::from(max), span).map(Operand::Const)
            }
            // `HSC HC0`, `PLS Q0.0`
            (C::Number(max), Settled::Direct(direct)) if matches!(direct.area, Area::Hc | Area::Q) => {
                let number = if direct.area == Area::Hc { direct.number } else { u32::from(direct.bit) };
                match number <= u32::from(max) {
                    true => self.misfit(class, &format!("write `{number}`, the number alone"), span),
                    false => self.misfit(class, &format!("write a number from 0 to {max}"), span),
                }
            }
            (C::Label, Settled::Constant(constant)) => {
                let labels = u32::from(self.row.labels);
                match super::constant::whole(&constant) {
                    Some(number) if number >= 0 && number < i64::from(labels) => Some(Operand::Const(number as u32)),
                    _ => {
                        let cpu = &self.input.profile.name;
                        let message = Diagnostic::new(Code::NumberRange, span, "no label has this number (008D)")
                            .label(format!("the CPU {cpu} has the labels 0 to {}", labels.saturating_sub(1)))
                            .help("use a smaller number");
                        self.push(message);
                        None
                    }
                }
            }
            (C::Interrupt, settled) => self.interrupt(settled, span),
            (C::Timer | C::Counter, Settled::Constant(constant)) => {
                let letter = if class == C::Timer { "T" } else { "C" };
                match super::constant::whole(&constant).filter(|number| (0..256).contains(number)) {
                    Some(number) => self.misfit(class, &format!("write `{letter}{number}`"), span),
                    None => self.misfit(class, &format!("write {}", wanted(class)), span),
                }
            }
            _ => self.misfit(class, &format!("write {}", wanted(class)), span),
        }
    }

    /// The pointer that a string parameter gets from a string in V memory.
    pub fn string_pointer(&mut self, direct: Direct, span: Span) -> Option<Operand> {
        if direct.area != Area::V || direct.width != Some(Width::Byte) {
            let help = "a string parameter needs a string in V memory (`VB100`), its address, a pointer or a text";
            return self.misfit(OperandClass::StringIn, help, span);
        }
        self.check_range(direct, Width::Byte, 1, span)?;
        self.addresses.push(place(direct, Width::Byte));
        Some(Operand::Const(u32::from(pointer::V) << 24 | direct.number & 0x00FF_FFFF))
    }
}
