//! The registers before a statement: what a client sees and changes.

use plcc_abi::layout::state;
use plcc_lower::probe::Kept;
use plcc_runtime::cpu::Cpu;

use crate::stack::Probed;

/// A register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Register {
    pub name: &'static str,
    /// Index in [`Probed`].
    slot: usize,
    form: Form,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    /// Bit of the slot.
    Bit(u32),
    Hex,
    /// An address register.
    Pointer,
    /// A number in the low or the high half.
    Low,
    High,
    /// The status word as a whole.
    Status,
}

const fn register(name: &'static str, slot: usize, form: Form) -> Register {
    Register { name, slot, form }
}

/// Of an S7-300/400. Source: STL reference, status word.
const STL: [Register; 18] = [
    register("RLO", 6, Form::Bit(1)),
    register("ACCU1", 0, Form::Hex),
    register("ACCU2", 1, Form::Hex),
    register("ACCU3", 2, Form::Hex),
    register("ACCU4", 3, Form::Hex),
    register("AR1", 4, Form::Pointer),
    register("AR2", 5, Form::Pointer),
    register("STW", 6, Form::Status),
    register("BR", 6, Form::Bit(8)),
    register("CC1", 6, Form::Bit(7)),
    register("CC0", 6, Form::Bit(6)),
    register("OV", 6, Form::Bit(5)),
    register("OS", 6, Form::Bit(4)),
    register("OR", 6, Form::Bit(3)),
    register("STA", 6, Form::Bit(2)),
    register("/FC", 6, Form::Bit(0)),
    register("DB", 7, Form::Low),
    register("DI", 7, Form::High),
];

/// Of an S7-200: the logic stack and ENO.
const STACK: [Register; 10] = [
    register("S0", 0, Form::Bit(0)),
    register("S1", 0, Form::Bit(1)),
    register("S2", 0, Form::Bit(2)),
    register("S3", 0, Form::Bit(3)),
    register("S4", 0, Form::Bit(4)),
    register("S5", 0, Form::Bit(5)),
    register("S6", 0, Form::Bit(6)),
    register("S7", 0, Form::Bit(7)),
    register("S8", 0, Form::Bit(8)),
    register("ENO", 0, Form::Bit(9)),
];

/// The registers that a statement has.
pub fn of(kept: Kept) -> &'static [Register] {
    match kept {
        Kept::Nothing => &[],
        Kept::Registers => &STL,
        Kept::Stack => &STACK,
    }
}

/// The register with a name.
pub fn find(kept: Kept, name: &str) -> Option<Register> {
    of(kept).iter().find(|register| register.name.eq_ignore_ascii_case(name.trim())).copied()
}

/// The registers as the CPU has them before a statement.
pub fn read(cpu: &Cpu) -> Probed {
    std::array::from_fn(|slot| cpu.memory.host32(state::PROBED + 4 * slot as u32))
}

impl Register {
    pub fn ty(self) -> &'static str {
        match self.form {
            Form::Bit(_) => "BOOL",
            Form::Hex | Form::Pointer => "DWORD",
            Form::Low | Form::High | Form::Status => "WORD",
        }
    }

    pub fn is_bit(self) -> bool {
        matches!(self.form, Form::Bit(_))
    }

    /// As a number.
    pub fn number(self, probed: &Probed) -> u32 {
        let whole = probed[self.slot];
        match self.form {
            Form::Bit(bit) => whole >> bit & 1,
            Form::Hex | Form::Pointer | Form::Status => whole,
            Form::Low => whole & 0xFFFF,
            Form::High => whole >> 16,
        }
    }

    pub fn text(self, probed: &Probed) -> String {
        let number = self.number(probed);
        match self.form {
            Form::Bit(_) | Form::Low | Form::High => number.to_string(),
            Form::Hex => format!("16#{number:08X}"),
            Form::Pointer => pointer(number),
            Form::Status => format!("2#{:01b}_{:04b}_{:04b}", number >> 8 & 1, number >> 4 & 15, number & 15),
        }
    }

    /// Changes it, in the CPU and in what is shown. `Err`: the error.
    pub fn write(self, cpu: &Cpu, probed: &mut Probed, text: &str) -> Result<(), String> {
        let wrong = || format!("`{}` is not a value for {}", text.trim(), self.name);
        let number = plcc_runtime::typed::parse(
            text,
            plcc_runtime::typed::ValueType::of(match self.form {
                Form::Bit(_) => plcc_abi::image::AssertType::Bool,
                Form::Hex | Form::Pointer | Form::Low | Form::High | Form::Status => {
                    plcc_abi::image::AssertType::Bits(32)
                }
            }),
        );
        let number = match number {
            Ok(plcc_runtime::assertion::Value::Bits(bits)) => bits as u32,
            // An accumulator takes what a double word does, such as -1, 1.5 and P#M10.0; an address register a pointer as it is shown.
            Ok(_) | Err(_) => match plcc_runtime::value::parse(text, plcc_runtime::address::Width::Dword) {
                Ok(bits) if self.form == Form::Hex => bits as u32,
                Ok(bits) if self.form == Form::Pointer && text.trim().starts_with(['P', 'p']) => bits as u32,
                Ok(_) | Err(_) => return Err(wrong()),
            },
        };
        let whole = match self.form {
            Form::Bit(bit) => probed[self.slot] & !(1 << bit) | number << bit,
            Form::Hex | Form::Pointer if self.name != "AR2" => number,
            Form::Status if number < 1 << 9 => number,
            Form::Status => return Err(wrong()),
            // The address of the instance, which code has already used.
            Form::Hex | Form::Pointer | Form::Low | Form::High => {
                return Err(format!("{} is shown, not changed", self.name));
            }
        };
        probed[self.slot] = whole;
        cpu.memory.set_host32(state::PROBED + 4 * self.slot as u32, whole);
        Ok(())
    }
}

/// `P#10.0`, `P#M10.0`.
fn pointer(register: u32) -> String {
    use plcc_abi::layout::area;
    let code = (register >> 24) as u8;
    let letter = match code {
        0 => "",
        area::P => "P",
        area::I => "I",
        area::Q => "Q",
        area::M => "M",
        area::DB => "DBX",
        area::DI => "DIX",
        area::L => "L",
        area::V => "V",
        _ => return format!("16#{register:08X}"),
    };
    format!("P#{letter}{}.{}", (register & 0x7_FFFF) >> 3, register & 7)
}
