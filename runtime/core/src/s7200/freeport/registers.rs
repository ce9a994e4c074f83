//! Special memory of the two ports. Source: S7-200 system manual, Freeport mode; receive message control.

use plcc_abi::s7200::image::CpuRow;

use crate::s7200::special;

const NS_PER_S: u64 = 1_000_000_000;
/// Bit times of a break. Source: S7-200 system manual, Transmit instruction.
const BREAK_BITS: u64 = 16;

/// Where a port has its registers, and which events it raises.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Registers {
    /// SMB30 or SMB130.
    pub control: u32,
    /// SMB86 or SMB186; the other registers of receive messages follow.
    pub receive_status: u32,
    /// Bit of SMB4: transmitter idle.
    pub idle_bit: u8,
    pub character_event: u8,
    pub transmit_event: u8,
    pub message_event: u8,
    /// Non-fatal error of a second XMT or RCV.
    pub busy_error: u16,
}

/// By number of the port.
pub const REGISTERS: [Registers; 2] = [
    Registers {
        control: 30,
        receive_status: 86,
        idle_bit: 5,
        character_event: 8,
        transmit_event: 9,
        message_event: 23,
        busy_error: plcc_abi::s7200::error::PORT_0_BUSY,
    },
    Registers {
        control: 130,
        receive_status: 186,
        idle_bit: 6,
        character_event: 25,
        transmit_event: 26,
        message_event: 24,
        busy_error: plcc_abi::s7200::error::PORT_1_BUSY,
    },
];

impl Registers {
    /// SMB87: control of receive messages. Offset from the memory base, as all that follow.
    pub const fn receive_control(&self) -> u32 {
        special(self.receive_status + 1)
    }

    pub const fn start_character(&self) -> u32 {
        special(self.receive_status + 2)
    }

    pub const fn end_character(&self) -> u32 {
        special(self.receive_status + 3)
    }

    /// Idle line time in ms, a word.
    pub const fn idle_time(&self) -> u32 {
        special(self.receive_status + 4)
    }

    /// Inter-character or message time in ms, a word.
    pub const fn timer(&self) -> u32 {
        special(self.receive_status + 6)
    }

    pub const fn most_characters(&self) -> u32 {
        special(self.receive_status + 8)
    }
}

/// The mode of a port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    PpiSlave,
    Freeport,
    PpiMaster,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    None,
    Even,
    Odd,
}

/// SMB30 or SMB130, `p p d b b b m m`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Control {
    pub mode: Mode,
    pub parity: Parity,
    pub seven_bits: bool,
    pub baud: u32,
}

impl Control {
    pub fn of(byte: u8, cpu: &CpuRow) -> Control {
        // The CPU 212 is the one with the smallest V memory.
        let slowest = cpu.old && cpu.v_bytes <= 1024;
        Control {
            mode: match byte & 3 {
                1 => Mode::Freeport,
                2 => Mode::PpiMaster,
                _ => Mode::PpiSlave,
            },
            parity: match byte >> 6 {
                1 => Parity::Even,
                3 => Parity::Odd,
                _ => Parity::None,
            },
            seven_bits: byte & 0x20 != 0,
            baud: match (byte >> 2) & 7 {
                0 if slowest => 19_200,
                0 => 38_400,
                1 => 19_200,
                2 => 9600,
                3 => 4800,
                4 => 2400,
                5 => 1200,
                6 if cpu.old => 600,
                6 => 115_200,
                _ if cpu.old => 300,
                _ => 57_600,
            },
        }
    }

    pub fn is_freeport(&self) -> bool {
        self.mode == Mode::Freeport
    }

    /// Nanoseconds that a character takes on the line: start bit, data, parity, one stop bit.
    pub fn character_ns(&self) -> u64 {
        let data = if self.seven_bits { 7 } else { 8 };
        self.bits_ns(2 + data + u64::from(self.parity != Parity::None))
    }

    pub fn break_ns(&self) -> u64 {
        self.bits_ns(BREAK_BITS)
    }

    fn bits_ns(&self, bits: u64) -> u64 {
        bits * NS_PER_S / u64::from(self.baud.max(1))
    }

    /// A byte as it goes over the line.
    pub fn on_line(&self, byte: u8) -> u8 {
        if self.seven_bits { byte & 0x7F } else { byte }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn control(byte: u8) -> Control {
        Control::of(byte, &CpuRow::default())
    }

    #[test]
    fn fields_of_the_control_byte() {
        let usual = control(0x09);
        assert_eq!(usual, Control { mode: Mode::Freeport, parity: Parity::None, seven_bits: false, baud: 9600 });
        assert_eq!(usual.character_ns(), 1_041_666, "10 bits at 9600 baud");
        let other = control(0b1110_0101);
        assert_eq!(other, Control { mode: Mode::Freeport, parity: Parity::Odd, seven_bits: true, baud: 19_200 });
        assert_eq!(other.character_ns(), 520_833, "10 bits at 19200 baud");
        assert_eq!((control(0x41).parity, control(0x81).parity), (Parity::Even, Parity::None));
        assert_eq!(control(0x41).character_ns(), 286_458, "11 bits at 38400 baud");
        assert_eq!((control(2).mode, control(3).mode), (Mode::PpiMaster, Mode::PpiSlave));
        assert_eq!(other.on_line(0xC1), 0x41);
    }

    #[test]
    fn baud_rates() {
        let rates = |row: &CpuRow| (0..8).map(|field| Control::of(field << 2 | 1, row).baud).collect::<Vec<_>>();
        assert_eq!(rates(&CpuRow::default()), [38_400, 19_200, 9600, 4800, 2400, 1200, 115_200, 57_600]);
        let cpu_214 = CpuRow { old: true, v_bytes: 2048, ..CpuRow::default() };
        assert_eq!(rates(&cpu_214), [38_400, 19_200, 9600, 4800, 2400, 1200, 600, 300]);
        let cpu_212 = CpuRow { old: true, v_bytes: 512, ..CpuRow::default() };
        assert_eq!(rates(&cpu_212)[0], 19_200);
    }
}
