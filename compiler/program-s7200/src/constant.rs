//! Constants: their bits as an operand.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::Width;
use plcc_syntax::s7200::ast::Constant;

use super::Binder;

/// How a place that accepts constants interprets them.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// An integer of this width.
    Integer(Width),
    /// An integer of this width with a sign; digits with a base are its bits.
    Signed(Width),
    /// Bits of this width: a REAL has the bits that it has in memory.
    Bits(Width),
    /// A byte with or without a sign.
    AnyByte,
    Real,
    Bool,
}

/// Value of an integer constant.
pub fn whole(constant: &Constant) -> Option<i64> {
    match constant {
        Constant::Integer(value) => Some(*value),
        Constant::Bits { value, .. } => Some(i64::from(*value)),
        Constant::Characters(bytes) if bytes.len() <= 4 => {
            Some(bytes.iter().fold(0, |value, byte| value << 8 | i64::from(*byte)))
        }
        Constant::Bool(_) | Constant::Real(_) | Constant::Text(_) | Constant::Characters(_) => None,
    }
}

impl Binder<'_> {
    /// The bits of a constant; `None` if it is not possible there, which is reported.
    pub fn constant(&mut self, constant: &Constant, target: Target, span: Span) -> Option<u32> {
        match (target, constant) {
            (Target::Bool, Constant::Bool(value)) => Some(u32::from(*value)),
            (Target::Bool, _) => match whole(constant) {
                Some(value @ (0 | 1)) => Some(value as u32),
                _ => self.wrong_constant("a BOOL is TRUE, FALSE, 1 or 0", "", span),
            },
            (Target::Real, Constant::Real(value)) => Some(value.to_bits()),
            (Target::Real, Constant::Integer(value)) => {
                self.push(
                    Diagnostic::new(Code::Tolerated, span, format!("`{value}` is read as the REAL {value}.0"))
                        .label("a REAL has a point or an exponent")
                        .help(format!("write `{value}.0`")),
                );
                Some((*value as f32).to_bits())
            }
            (Target::Real, Constant::Bits { value, .. }) => Some(*value),
            (Target::Real, _) => self.wrong_constant("a REAL is expected here", "write it as `1.5`", span),
            (Target::Bits(Width::Dword), Constant::Real(value)) => Some(value.to_bits()),
            (Target::AnyByte, Constant::Integer(value @ -128..=-1)) => Some(*value as u32 & 0xFF),
            (Target::AnyByte, _) => self.constant(constant, Target::Integer(Width::Byte), span),
            (Target::Integer(_) | Target::Signed(_) | Target::Bits(_), Constant::Real(value)) => {
                let help = match value.fract() == 0.0 {
                    true => format!("write `{value:.0}`, or use an instruction for REALs"),
                    false => "REALs are moved with MOVR and converted with ROUND".to_string(),
                };
                self.wrong_constant("a REAL is not possible here", &help, span)
            }
            (Target::Integer(_) | Target::Signed(_) | Target::Bits(_), Constant::Bool(_)) => {
                self.wrong_constant("a BOOL is not possible here", "write a number", span)
            }
            (Target::Integer(_) | Target::Signed(_) | Target::Bits(_), Constant::Text(_)) => {
                self.wrong_constant("a string is not possible here", "write characters in single quotes: 'AB'", span)
            }
            (Target::Integer(width) | Target::Signed(width) | Target::Bits(width), Constant::Characters(bytes))
                if (width.bytes() as usize + 1..=4).contains(&bytes.len()) =>
            {
                self.too_many_characters(bytes, width, span)
            }
            (Target::Signed(width), Constant::Integer(value)) => self.signed(*value, width, span),
            (Target::Integer(width) | Target::Signed(width) | Target::Bits(width), _) => match whole(constant) {
                Some(value) => self.integer(value, width, matches!(target, Target::Bits(_)), span),
                None => self.wrong_constant("too many characters", "four of them fill a double word", span),
            },
        }
    }

    /// `'AB'` for a byte.
    fn too_many_characters(&mut self, bytes: &[u8], width: Width, span: Span) -> Option<u32> {
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let name = if width.bytes() == 1 { "a byte" } else { "a word" };
        let larger = if bytes.len() == 2 { "words" } else { "double words" };
        let (all, first) = (text(bytes), text(&bytes[..width.bytes() as usize]));
        self.push(
            Diagnostic::new(Code::LiteralRange, span, format!("`'{all}'` does not fit into {name} (0090)"))
                .label(format!("{} characters", bytes.len()))
                .help(format!("write `'{first}'`, or use an instruction for {larger}")),
        );
        None
    }

    /// A decimal number where the instruction has a sign. 40000 would be the INT -25536.
    fn signed(&mut self, value: i64, width: Width, span: Span) -> Option<u32> {
        let (low, high, name) = match width {
            Width::Dword | Width::Lword => (i64::from(i32::MIN), i64::from(i32::MAX), "a DINT"),
            Width::Bit | Width::Byte | Width::Word => (i64::from(i16::MIN), i64::from(i16::MAX), "an INT"),
        };
        if (low..=high).contains(&value) {
            return Some(value as u32 & mask(width));
        }
        self.push(
            Diagnostic::new(Code::LiteralRange, span, format!("`{value}` does not fit into {name} (0090)"))
                .label(format!("{name} goes from {low} to {high}"))
                .help("write a number in this range, or use an instruction for larger numbers"),
        );
        None
    }

    /// A number as the source has it; that of a symbol in decimal.
    fn number_text(&self, value: i64, span: Span) -> String {
        let written = self.written(span);
        if written.starts_with(|c: char| c.is_ascii_digit()) { written } else { value.to_string() }
    }

    /// An integer in `width` bits: signed or unsigned. `data`: in a data block.
    fn integer(&mut self, value: i64, width: Width, data: bool, span: Span) -> Option<u32> {
        let (low, high, name) = match width {
            Width::Bit => (0, 1, "a bit"),
            Width::Byte => (-128, 0xFF, "a byte"),
            Width::Word => (-32768, 0xFFFF, "a word"),
            Width::Dword | Width::Lword => (i64::from(i32::MIN), i64::from(u32::MAX), "a double word"),
        };
        if value < low || value > high {
            let low = if width == Width::Byte { 0 } else { low };
            let text = self.number_text(value, span);
            let larger = match width {
                Width::Byte if (-32768..=0xFFFF).contains(&value) => Some(("words", "VW0")),
                Width::Byte | Width::Word => Some(("double words", "VD0")),
                Width::Bit | Width::Dword | Width::Lword => None,
            };
            let help = match larger {
                Some((_, such)) if data => {
                    format!("write a value from {low} to {high}, or begin the line with an address such as {such}")
                }
                Some((what, such)) => format!(
                    "write a value from {low} to {high}, or use an instruction for {what}, with operands such as {such}"
                ),
                None => format!("write a value from {low} to {high}"),
            };
            self.push(
                Diagnostic::new(Code::LiteralRange, span, format!("`{text}` does not fit into {name} (0090)"))
                    .label(format!("{name} can be {low} to {high}"))
                    .help(help),
            );
            return None;
        }
        let bits = value as u32 & mask(width);
        if width == Width::Byte && value < 0 {
            self.push(
                Diagnostic::new(Code::Tolerated, span, format!("`{value}` is read as the byte {bits}"))
                    .label("a byte has no sign")
                    .help(format!("write {bits} or 16#{bits:02X}")),
            );
        }
        Some(bits)
    }

    /// A constant from 0 to `max`, such as a mode.
    pub fn number(&mut self, constant: &Constant, max: u32, span: Span) -> Option<u32> {
        match whole(constant) {
            Some(value) if value >= 0 && value <= i64::from(max) => Some(value as u32),
            Some(value) => {
                self.push(
                    Diagnostic::new(Code::LiteralRange, span, format!("`{value}` is outside the range (0090)"))
                        .label(format!("0 to {max} are possible here"))
                        .help(format!("write a number from 0 to {max}")),
                );
                None
            }
            None => self.wrong_constant("an integer is expected here", "", span),
        }
    }

    fn wrong_constant(&mut self, title: &str, help: &str, span: Span) -> Option<u32> {
        let message = Diagnostic::new(Code::OperandKind, span, format!("{title} (0090)")).label("this constant");
        self.push(if help.is_empty() { message } else { message.help(help) });
        None
    }
}

/// All bits of a width.
pub fn mask(width: Width) -> u32 {
    match width {
        Width::Bit => 1,
        Width::Byte => 0xFF,
        Width::Word => 0xFFFF,
        Width::Dword | Width::Lword => u32::MAX,
    }
}
