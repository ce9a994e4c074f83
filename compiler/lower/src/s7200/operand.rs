//! Operands as memory accesses.

use plcc_abi::RuntimeFn;
use plcc_abi::s7200::{ANALOG_ADDRESS, V_DB, error, fatal, system};
use plcc_ir::{Address, Region, Type, Value};
use plcc_model::s7200::{Area, Operand, Width};

use super::block::S7200Lowering;
use super::plan::ir_type;
use super::pointer::Pointed;

/// Special memory bytes that do something when they are written: SMB30, SMB31, SMB130.
const SPECIAL_WITH_EFFECT: [u32; 3] = [30, 31, 130];

/// An operand whose pointer, if it has one, has been followed.
#[derive(Clone, Copy)]
pub enum Place<'a> {
    Direct(&'a Operand),
    /// Where a pointer leads.
    At(Pointed),
}

/// The use of a place.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Use {
    Read,
    Write,
}

impl S7200Lowering<'_, '_> {
    /// Follows the pointer of an operand that is accessed with `bytes` bytes.
    pub fn place<'a>(&mut self, operand: &'a Operand, bytes: u32, purpose: Use) -> Place<'a> {
        match operand {
            Operand::Indirect { pointer, .. } => {
                let pointer = self.load(Place::Direct(pointer), Width::Dword);
                Place::At(self.follow(pointer, bytes, purpose))
            }
            _ => Place::Direct(operand),
        }
    }

    /// Value of an operand that is read, of the type of `width`.
    pub fn read(&mut self, operand: &Operand, width: Width) -> Value {
        match operand {
            Operand::Indirect { pointer, .. } => {
                let pointer = self.load(Place::Direct(pointer), Width::Dword);
                self.load_through(pointer, width.bytes(), ir_type(width))
            }
            _ => self.load(Place::Direct(operand), width),
        }
    }

    /// An operand that is written later, or changed in place.
    pub fn target<'a>(&mut self, operand: &'a Operand, width: Width) -> Place<'a> {
        self.place(operand, width.bytes(), Use::Write)
    }

    /// Value at a place, of the type of `width`.
    pub fn load(&mut self, place: Place, width: Width) -> Value {
        let ty = ir_type(width);
        let operand = match place {
            Place::At(pointed) => return self.load_pointed(pointed, ty),
            Place::Direct(operand) => operand,
        };
        match operand {
            Operand::Const(value) => self.b.iconst(ty, i64::from(*value)),
            // For a STRING parameter: a pointer to the constant.
            Operand::Text(text) => {
                let offset = self.plan.texts.offset(text);
                self.b.i32_const(u32::from(plcc_abi::s7200::pointer::CONSTANT) << 24 | offset)
            }
            // SM0.0 is always 1.
            Operand::Memory { area: Area::Sm, byte: 0, bit: 0, width: Width::Bit } => self.b.bool_const(true),
            Operand::Memory { bit, width: Width::Bit, .. } => {
                let at = self.address(operand, Width::Bit);
                self.b.load_bit(at, *bit)
            }
            Operand::Timer { number, .. } => {
                self.sync_timer(*number);
                self.load_cell(operand, width)
            }
            Operand::Counter { .. } => self.load_cell(operand, width),
            Operand::HighSpeedCounter(number) => {
                let number = self.b.i32_const(u32::from(*number));
                self.b.call_runtime(RuntimeFn::S7200Counter, &[number]).expect("it returns a value")
            }
            Operand::AnalogInput { byte } => self.read_analog(*byte),
            _ => {
                let at = self.address(operand, width);
                self.b.load(ty, at)
            }
        }
    }

    fn load_cell(&mut self, operand: &Operand, width: Width) -> Value {
        let at = self.address(operand, width);
        match width {
            Width::Bit => self.b.load_bit(at, 0),
            _ => self.b.load(ir_type(width), at),
        }
    }

    /// Writes a value of the type of `width`.
    pub fn store(&mut self, place: Place, width: Width, value: Value) {
        let operand = match place {
            Place::At(pointed) => return self.store_pointed(pointed, value),
            Place::Direct(operand) => operand,
        };
        if let Operand::Timer { number, .. } = operand {
            self.sync_timer(*number);
        }
        let at = self.address(operand, width);
        match operand {
            Operand::Memory { bit, width: Width::Bit, .. } => self.b.store_bit(at, *bit, value),
            Operand::Timer { .. } | Operand::Counter { .. } if width == Width::Bit => self.b.store_bit(at, 0, value),
            _ => self.b.store(at, value),
        }
        match operand {
            Operand::Memory { area: Area::Sm, byte, .. } => self.special_written(*byte, width.bytes()),
            Operand::AnalogOutput { byte } => self.write_analog(*byte, value),
            _ => {}
        }
    }

    /// The program has written `bytes` bytes of special memory beginning with `byte`.
    pub fn special_written(&mut self, byte: u32, bytes: u32) {
        for special in SPECIAL_WITH_EFFECT.into_iter().filter(|special| (byte..byte + bytes).contains(special)) {
            let byte = self.b.i32_const(special);
            self.b.call_runtime(RuntimeFn::S7200SpecialWritten, &[byte]);
        }
    }

    fn read_analog(&mut self, byte: u32) -> Value {
        let (address, bytes) = (self.b.i32_const(ANALOG_ADDRESS + byte), self.b.i32_const(2));
        let value = self.b.call_runtime(RuntimeFn::PeripheralRead, &[address, bytes]).expect("it returns a value");
        self.b.trunc(Type::I16, value)
    }

    fn write_analog(&mut self, byte: u32, value: Value) {
        let (address, bytes) = (self.b.i32_const(ANALOG_ADDRESS + byte), self.b.i32_const(2));
        let value = self.b.zext(Type::I32, value);
        self.b.call_runtime(RuntimeFn::PeripheralWrite, &[address, bytes, value]);
    }

    /// Updates a timer of 1 ms.
    pub fn sync_timer(&mut self, number: u8) {
        if plcc_abi::s7200::timer_resolution(number) == plcc_abi::s7200::Resolution::Ms1 {
            let number = self.b.i32_const(u32::from(number));
            self.b.call_runtime(RuntimeFn::S7200TimerSync, &[number]);
        }
    }

    /// The address of a direct operand, accessed with `width`: the low part of an accumulator, the byte of a bit.
    fn address(&mut self, operand: &Operand, width: Width) -> Address {
        match operand {
            Operand::Memory { area, byte, .. } => area_address(*area, *byte),
            Operand::Timer { number, .. } => cell_address(system::TIMER_VALUES, system::TIMER_BITS, *number, width),
            Operand::Counter { number, .. } => {
                cell_address(system::COUNTER_VALUES, system::COUNTER_BITS, *number, width)
            }
            Operand::Accumulator { number, .. } => {
                let end = system::ACCUMULATORS + 4 * (u32::from(*number) + 1);
                Address::direct(Region::System, end - width.bytes().min(4))
            }
            Operand::AnalogInput { byte } => Address::direct(Region::System, system::AI + byte),
            Operand::AnalogOutput { byte } => Address::direct(Region::System, system::AQ + byte),
            Operand::Text(text) => {
                Address::direct(Region::Db(plcc_abi::s7200::CONSTANTS_DB), self.plan.texts.offset(text))
            }
            Operand::Const(_) | Operand::HighSpeedCounter(_) | Operand::Indirect { .. } => {
                unreachable!("the binder passes no operand of this kind where an address is needed")
            }
        }
    }

    /// Offset of an operand from the memory base, for operations of the runtime, an i32.
    pub fn address_value(&mut self, operand: &Operand, width: Width, purpose: Use) -> Value {
        match self.place(operand, width.bytes(), purpose) {
            Place::At(pointed) => pointed.base,
            Place::Direct(operand) => {
                let at = self.address(operand, width);
                self.b.address_of(at)
            }
        }
    }

    /// The pointer error of an instruction that follows one: 0006, in a compare contact fatal.
    pub fn pointer_error_unless(&mut self, ok: Value) {
        self.error_unless(ok, error::INDIRECT_ADDRESS, fatal::COMPARE_ADDRESS);
    }
}

/// The address of a byte of an area.
pub fn area_address(area: Area, byte: u32) -> Address {
    match area {
        Area::I => Address::direct(Region::I, byte),
        Area::Q => Address::direct(Region::Q, byte),
        Area::M => Address::direct(Region::M, byte),
        Area::V => Address::direct(Region::Db(V_DB), byte),
        Area::L => Address::direct(Region::L, byte),
        Area::Sm => Address::direct(Region::System, system::SM + byte),
        Area::S => Address::direct(Region::System, system::S + byte),
    }
}

fn cell_address(values: u32, bits: u32, number: u8, width: Width) -> Address {
    let number = u32::from(number);
    Address::direct(Region::System, if width == Width::Bit { bits + number } else { values + 2 * number })
}
