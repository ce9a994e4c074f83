//! What a name means where the program stands: a register, a variable of the block, a value of the program.

use plcc_abi::image::AssertType;
use plcc_abi::layout;
use plcc_lower::probe::{Kept, Probe};
use plcc_model::types::{DTL, DataType, Elementary, Member, value_type};
use plcc_model::{BlockConstant, Body, CodeBlock, Parameter, Passing, Program, Width};
use plcc_runtime::address::Place;
use plcc_runtime::cpu::Cpu;
use plcc_runtime::names::path::{Part, parts};
use plcc_runtime::signal::{self, Signal, Source, Value};
use plcc_runtime::typed::ValueType;

use crate::condition::{Condition, Operand, whole};
use crate::data::{BYTES_MAX, Looked, Range};
use crate::indices;
use crate::places::Places;
use crate::registers::{self, Register};
use crate::stack::Frame;

/// A variable in memory.
#[derive(Clone, Debug)]
pub struct Data {
    pub offset: u32,
    pub bit: u8,
    pub ty: DataType,
}

/// What a name means.
#[derive(Clone, Debug)]
pub enum Found {
    Register(Register),
    Data(Data),
    /// A formal that is a number: of a timer, counter or block.
    Number(u64, String),
    Constant(Elementary, Value),
    Value(Source),
    /// All values of a structure or data block.
    Values(Vec<Signal>),
}

/// Where names are looked up.
pub struct Here<'a> {
    pub program: &'a Program,
    pub places: &'a Places,
    pub cpu: &'a Cpu,
    /// The block; none between two cycles.
    pub frame: Option<&'a Frame>,
}

impl<'a> Here<'a> {
    pub fn block(&self) -> Option<&'a CodeBlock> {
        let place = self.places.place(self.frame?.block)?;
        self.program.block(place.block)
    }

    /// What the statement has in registers.
    pub fn kept(&self) -> Kept {
        let place = self.frame.and_then(|frame| frame.place).and_then(|place| self.places.place(place));
        match place.map(|place| &place.probe) {
            Some(Probe::Statement(kept)) => *kept,
            _ => Kept::Nothing,
        }
    }

    /// Finds what a text names. `Err`: the error as a sentence.
    pub fn find(&self, text: &str) -> Result<Found, String> {
        let settled = indices::settled(text.trim(), &|index| self.index(index))?;
        let text = &*settled;
        if let Some(at) = reference_end(text) {
            return self.referred(&text[..at], text[at + 1..].trim_start());
        }
        let (local, only_local) = match text.strip_prefix('#') {
            Some(local) => (local, true),
            None => (text, false),
        };
        if !only_local && let Some(register) = registers::find(self.kept(), text) {
            return Ok(Found::Register(register));
        }
        let of_program = || match Source::find(text, &self.cpu.image, None) {
            Ok(source) => source.check(self.cpu).map(|()| Found::Value(source)),
            Err(wrong) => match signal::all(text, &self.cpu.image, None) {
                Ok(values) => Ok(Found::Values(values)),
                Err(_) => Err(wrong),
            },
        };
        // `"Tank".level` beside a variable `Tank` of the block.
        if text.starts_with('"')
            && let Ok(found) = of_program()
        {
            return Ok(found);
        }
        if let Some(path) = parts(local)
            && let [Part::Name(root), rest @ ..] = &path[..]
            && let Some(found) = self.local(root)
        {
            return match (found, rest) {
                (found, []) => Ok(found),
                (Found::Data(data), rest) => walk(data, rest, root).map(Found::Data),
                (_, _) => Err(format!("`{root}` is a value without members")),
            };
        }
        if let Some(found) = self.with_address(local) {
            return Ok(found);
        }
        if only_local {
            return Err(format!("`#{local}` is not a variable of the block that runs"));
        }
        of_program()
    }

    /// A part of what a reference leads to: `#step^.valve` of `#step` and `.valve`. `Err`: the error as a sentence.
    fn referred(&self, reference: &str, rest: &str) -> Result<Found, String> {
        let no_reference = || format!("`{reference}` is not a reference of the block that runs");
        if reference.matches('^').count() > REFERENCES_MAX {
            return Err(format!("a name has at most {REFERENCES_MAX} references one after the other"));
        }
        let Found::Data(data) = self.find(reference)? else { return Err(no_reference()) };
        let DataType::Struct(structure) = &data.ty else { return Err(no_reference()) };
        let target = structure.refers_to.as_ref().ok_or_else(no_reference)?;
        // The number of a data block, and bit and byte in it.
        let memory = &self.cpu.memory;
        let (number, bit) = (memory.word(data.offset), memory.word(data.offset + 2));
        let byte = memory.dword(data.offset + 4);
        let (start, length) = memory.db(number);
        if number == 0 || byte.saturating_add(plcc_model::layout::bytes(target)) > length {
            return Err(format!("`{reference}` is NULL, or leads to nothing"));
        }
        let data = Data { offset: start + byte, bit: (bit & 7) as u8, ty: target.clone() };
        let path = parts(&format!("r{rest}")).filter(|_| rest.is_empty() || rest.starts_with(['.', '[']));
        match path.as_deref() {
            Some([_, path @ ..]) => walk(data, path, reference).map(Found::Data),
            _ => Err(format!("`{reference}^{rest}` is not a name")),
        }
    }

    /// The value of an index, which may be computed. `Err`: the error as a sentence.
    fn index(&self, text: &str) -> Result<i64, String> {
        let number = Condition::parse(text)?.value(&|name| self.operand(name))?;
        match number.fract() == 0.0 {
            true => Ok(number as i64),
            false => Err(format!("the index `{text}` is {number}; an index is a whole number")),
        }
    }

    /// A variable of the block.
    fn local(&self, name: &str) -> Option<Found> {
        let rules: [fn(&str, &str) -> bool; 2] = [|a, b| a == b, |a, b| a.to_lowercase() == b.to_lowercase()];
        let names: Vec<(String, Found)> = self.locals();
        rules.iter().find_map(|is_it| names.iter().find(|(own, _)| is_it(own, name)).map(|(_, found)| found.clone()))
    }

    /// A variable with an address that the block declares, in PLCopen XML: a tag that has the name of the block before its own.
    fn with_address(&self, text: &str) -> Option<Found> {
        let block = self.block().map(|block| block.name.as_str()).filter(|block| !block.is_empty())?;
        let (name, rest) = text.split_at(text.find(['.', '[']).unwrap_or(text.len()));
        let tag = format!("{block}.{name}");
        let names = || self.cpu.image.symbols.iter().map(|symbol| &symbol.name);
        let own = names().find(|own| **own == tag).or_else(|| names().find(|own| own.eq_ignore_ascii_case(&tag)))?;
        let source = Source::find(&format!("\"{own}\"{rest}"), &self.cpu.image, None).ok()?;
        source.check(self.cpu).is_ok().then_some(Found::Value(source))
    }

    /// All variables and constants of the block.
    fn locals(&self) -> Vec<(String, Found)> {
        [self.temporaries(), self.formals(), self.instance(), self.constants()].concat()
    }

    /// Constants of the block.
    fn constants(&self) -> Vec<(String, Found)> {
        let constants = self.block().into_iter().flat_map(|block| &block.interface.constants);
        let one = |constant: &BlockConstant| {
            let value = Value::of_type(value_type(constant.ty), constant.bits);
            (constant.name.clone(), Found::Constant(constant.ty, value))
        };
        constants.map(one).collect()
    }

    /// TEMP; of an S7-200 its parameters.
    pub fn temporaries(&self) -> Vec<(String, Found)> {
        let (Some(frame), Some(block)) = (self.frame.filter(|frame| frame.local != 0), self.block()) else {
            return Vec::new();
        };
        let member = |member: &Member| {
            let data = Data { offset: frame.local + member.byte, bit: member.bit, ty: member.ty.clone() };
            (member.name.clone(), Found::Data(data))
        };
        match &block.body {
            Body::S7200(body) => body
                .parameters
                .iter()
                .map(|parameter| {
                    let ty = DataType::Elementary(parameter.ty);
                    let data = Data { offset: frame.local + parameter.byte, bit: parameter.bit, ty };
                    (parameter.name.clone(), Found::Data(data))
                })
                .collect(),
            Body::Stl(_) | Body::Scl(_) | Body::Runtime => block.interface.temporaries.iter().map(member).collect(),
        }
    }

    /// Formals of an FC.
    pub fn formals(&self) -> Vec<(String, Found)> {
        let (Some(frame), Some(block)) = (self.frame, self.block()) else { return Vec::new() };
        let one = |&(index, got): &(usize, u64)| {
            let parameter = block.interface.parameters.get(index)?;
            let offset = got as u32;
            let data = |offset: u32, bit: u8| Found::Data(Data { offset, bit, ty: parameter.ty.clone() });
            let found = match parameter.passing {
                Passing::Elementary(Width::Bit) => data(offset >> 3, (offset & 7) as u8),
                Passing::Elementary(_) | Passing::Complex { .. } => data(offset, 0),
                Passing::Number => Found::Number(got, plcc_model::layout::type_name(&parameter.ty)),
                Passing::Pointer | Passing::Any | Passing::Variant | Passing::OpenArray { .. } => return None,
            };
            Some((parameter.name.clone(), found))
        };
        frame.formals.iter().filter_map(one).collect()
    }

    /// Parameters and static data of an FB. An IN_OUT that is a structure, an array or a text is the actual that its POINTER leads to.
    pub fn instance(&self) -> Vec<(String, Found)> {
        let (Some(frame), Some(block)) = (self.frame.filter(|frame| frame.instance != 0), self.block()) else {
            return Vec::new();
        };
        let member = |member: &Member| {
            let own = Data { offset: frame.instance + member.byte, bit: member.bit, ty: member.ty.clone() };
            let is_it = |one: &&Parameter| {
                let is_pointer = matches!(own.ty, DataType::Parameter(_));
                is_pointer && matches!(one.passing, Passing::Complex { .. }) && one.name == member.name
            };
            let actual =
                block.interface.parameters.iter().find(is_it).and_then(|one| self.pointed(own.offset, &one.ty));
            (member.name.clone(), Found::Data(actual.unwrap_or(own)))
        };
        block.interface.instance.iter().map(member).collect()
    }

    /// The value of a type that a POINTER leads to; `None`: into local data, or to nothing.
    fn pointed(&self, offset: u32, ty: &DataType) -> Option<Data> {
        const BYTES: u32 = 6;
        if !self.cpu.memory.contains(offset, BYTES) {
            return None;
        }
        let [high, low, area, first, second, third] = self.cpu.memory.bytes::<6>(offset);
        let byte = u32::from_be_bytes([0, first, second, third]) >> 3;
        let bytes = plcc_model::layout::bytes(ty);
        let place = match area {
            layout::area::I => Place::Input(byte),
            layout::area::Q => Place::Output(byte),
            layout::area::M => Place::BitMemory(byte),
            layout::area::DB => {
                let number = u16::from_be_bytes([high, low]);
                let (_, length) = self.cpu.memory.db(number);
                if number == 0 || byte.saturating_add(bytes) > length {
                    return None;
                }
                Place::Db(number, byte)
            }
            _ => return None,
        };
        let offset = self.cpu.offset_of(place)?;
        self.cpu.memory.contains(offset, bytes).then(|| Data { offset, bit: 0, ty: ty.clone() })
    }

    /// The value, if it is one.
    pub fn value(&self, found: &Found) -> Option<Value> {
        match found {
            Found::Data(data) => {
                let ty = data.value_type()?;
                Some(Value::at(&self.cpu.memory, data.offset, data.bit, ty))
            }
            Found::Value(source) => Some(source.read(self.cpu, None)),
            Found::Constant(_, value) => Some(value.clone()),
            Found::Register(_) | Found::Number(..) | Found::Values(_) => None,
        }
    }

    /// As a number, for conditions, which compare a REAL with a number as it is written. `Err`: the error as a sentence.
    pub fn operand(&self, text: &str) -> Result<Operand, String> {
        let mut is_bit = false;
        let number = match self.find(text)? {
            Found::Register(register) => {
                is_bit = register.is_bit();
                self.frame.map_or(0.0, |frame| register.number(&frame.probed).into())
            }
            Found::Number(number, _) => number as f64,
            found => match self.value(&found) {
                Some(Value::Bits(bits, width)) => {
                    is_bit = matches!(width, plcc_runtime::address::Width::Bit(_));
                    whole(text, bits.into())?
                }
                Some(Value::Whole(number)) => whole(text, number)?,
                value => {
                    value.and_then(|value| value.written_number()).ok_or_else(|| format!("`{text}` is not a number"))?
                }
            },
        };
        Ok(Operand { number, is_bit })
    }

    /// Where a value is that lasts from call to call.
    pub fn looked(&self, found: &Found) -> Option<Looked> {
        let range = match found {
            Found::Data(data) => {
                let is_bit = data.value_type().is_some_and(|ty| plcc_runtime::typed::bits(ty.ty) == Some(1));
                let bytes = plcc_model::layout::bytes(&data.ty).clamp(1, BYTES_MAX);
                Range { offset: data.offset, bytes, bit: is_bit.then_some(data.bit), ty: data.value_type() }
            }
            Found::Value(source) => {
                let address = source.address()?;
                if let Place::Timer(_) | Place::TimerValue(_) | Place::Counter(_) | Place::CounterValue(_) =
                    address.place
                {
                    return Some(Looked::Cell(*address));
                }
                let offset = self.cpu.offset_of(address.place)?;
                let bit = match address.width {
                    plcc_runtime::address::Width::Bit(bit) => Some(bit),
                    _ => None,
                };
                let (ty, bytes) = match source {
                    Source::Typed(_, ty) => (Some(*ty), ty.bytes()),
                    _ => (None, address.width.bytes()),
                };
                Range { offset, bytes, bit, ty }
            }
            Found::Register(_) | Found::Number(..) | Found::Constant(..) | Found::Values(_) => return None,
        };
        let is_local = (layout::L..layout::DB_TABLE).contains(&range.offset);
        (!is_local && self.cpu.memory.contains(range.offset, range.bytes)).then_some(Looked::Memory(range))
    }
}

/// More references than this do not follow each other in a name.
const REFERENCES_MAX: usize = 8;

/// Where the last `^` of a name is, outside of quotes.
fn reference_end(text: &str) -> Option<usize> {
    let (mut end, mut is_quoted) = (None, false);
    for (at, c) in text.char_indices() {
        match c {
            '"' => is_quoted = !is_quoted,
            '^' if !is_quoted => end = Some(at),
            _ => {}
        }
    }
    end
}

/// Follows members and indices. `Err`: the error as a sentence.
fn walk(mut data: Data, path: &[Part], root: &str) -> Result<Data, String> {
    for part in path {
        let no = |what: &str| format!("`{root}` has no {what} there");
        let next = match (part, &data.ty) {
            (Part::Name(name), DataType::Struct(structure)) => {
                let found = structure.members.iter().find(|member| member.name.to_lowercase() == name.to_lowercase());
                let member = found.ok_or_else(|| no(&format!("`{name}`")))?;
                Data { offset: data.offset + member.byte, bit: member.bit, ty: member.ty.clone() }
            }
            (Part::Index(indices), DataType::Array(array)) if indices.len() == array.bounds.len() => {
                let mut number = 0u64;
                for (&index, &(low, high)) in indices.iter().zip(&array.bounds) {
                    if !(i64::from(low)..=i64::from(high)).contains(&index) {
                        return Err(format!("the index {index} of `{root}` is not from {low} to {high}"));
                    }
                    number = number * (i64::from(high) - i64::from(low) + 1) as u64 + (index - i64::from(low)) as u64;
                }
                data.element(number).ok_or_else(|| no("such element"))?
            }
            (Part::Name(name), _) => return Err(no(&format!("`{name}`"))),
            (Part::Index(_), _) => return Err(no("such index")),
            (Part::Slice(width, slice), _) => {
                let why = || format!("`{root}`: a slice is part of a bit string or an integer, and within it");
                data.slice(*width, *slice).ok_or_else(why)?
            }
        };
        data = next;
    }
    Ok(data)
}

impl Data {
    /// The type of its value; `None`: it consists of others, or has none.
    pub fn value_type(&self) -> Option<ValueType> {
        match &self.ty {
            DataType::Elementary(ty) => Some(ValueType::of(value_type(*ty))),
            DataType::DateAndTime => Some(ValueType::of(AssertType::DateAndTime)),
            DataType::String(length) => Some(ValueType { ty: AssertType::Text, length: u16::from(*length) }),
            DataType::WideString(length) => Some(ValueType { ty: AssertType::WideText, length: *length }),
            DataType::Struct(structure) if structure.name == DTL && structure.instance_of.is_none() => {
                Some(ValueType::of(AssertType::Dtl))
            }
            DataType::Struct(_)
            | DataType::Array(_)
            | DataType::Parameter(_)
            | DataType::OpenArray(_)
            | DataType::Void => None,
        }
    }

    /// Slice `number` of `width` bits, 0 at the right; `None`: it has none.
    fn slice(&self, width: u32, number: u32) -> Option<Data> {
        let ValueType { ty: AssertType::Bits(bits) | AssertType::Signed(bits) | AssertType::Unsigned(bits), .. } =
            self.value_type()?
        else {
            return None;
        };
        let (bits, first) = (u32::from(bits), number.checked_mul(width)?);
        let end = first.checked_add(width)?;
        if end > bits || width == bits {
            return None;
        }
        let (byte, bit, ty) = match width {
            1 => (bits / 8 - 1 - first / 8, (first % 8) as u8, Elementary::Bool),
            8 => ((bits - end) / 8, 0, Elementary::Byte),
            16 => ((bits - end) / 8, 0, Elementary::Word),
            _ => ((bits - end) / 8, 0, Elementary::Dword),
        };
        Some(Data { offset: self.offset.checked_add(byte)?, bit, ty: DataType::Elementary(ty) })
    }

    /// An element of an array by its number, 0 for the first.
    pub fn element(&self, number: u64) -> Option<Data> {
        let DataType::Array(array) = &self.ty else { return None };
        let (byte, bit) = plcc_model::layout::element_place(array, number);
        Some(Data { offset: self.offset.checked_add(byte)?, bit, ty: array.element.clone() })
    }
}
