//! STRING and WSTRING. Source: SCL reference, strings.

use plcc_abi::RuntimeFn;
use plcc_ir::{Address, IntCc, Region, Type};
use plcc_model::layout;
use plcc_model::scl::{Access, Base, Complex, SclBody};
use plcc_model::types::{DataType, Elementary};
use plcc_model::{Place, Width};

use super::located::Located;
use super::own_texts::OwnText;
use crate::block::BlockLowering;
use crate::call::FormalText;
use crate::fault::Substitute;
use crate::place::Direction;
use crate::pointer::moved;

/// A limit that means the maximum in the text's own header.
pub const OWN_MAXIMUM: u32 = u32::MAX;
/// Constant texts up to this length are stored, longer ones copied.
const STORED_BYTES_MAX: usize = 34;
/// Longest text without a declared length.
pub const TEXT_MAX: u32 = 254;

/// Kind of a text.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Text {
    /// Two bytes of header, characters of one byte.
    Narrow,
    /// Two words of header, characters of one word.
    Wide,
}

impl Text {
    pub fn of(ty: &DataType) -> Option<Text> {
        match ty {
            DataType::String(_) => Some(Text::Narrow),
            DataType::WideString(_) => Some(Text::Wide),
            _ => None,
        }
    }
}

/// A text that is copied.
#[derive(Clone, Copy)]
pub struct TextPlace {
    pub addr: Address,
    /// Its declared maximum, or [`OWN_MAXIMUM`].
    pub maximum: u32,
    /// It is a formal parameter.
    pub formal: Option<FormalText>,
}

/// Bytes of a result of type `ty` in the frame, where a text has room for [`result_maximum`] characters.
pub fn result_bytes(ty: &DataType) -> u32 {
    match Text::of(ty) {
        Some(Text::Narrow) => result_maximum(ty) + 2,
        Some(Text::Wide) => 2 * result_maximum(ty) + 4,
        None => layout::bytes(ty),
    }
}

/// Most characters of a text that is a result: 254, or what is declared if that is more.
fn result_maximum(ty: &DataType) -> u32 {
    match ty {
        DataType::WideString(declared) => TEXT_MAX.max(u32::from(*declared)),
        _ => TEXT_MAX,
    }
}

impl BlockLowering<'_, '_> {
    /// TEMP texts begin empty, with the declared maximum.
    pub fn prepare_texts(&mut self, body: &SclBody) {
        for text in &body.temporary_texts {
            let kind = if text.wide { Text::Wide } else { Text::Narrow };
            self.store_head(Address::direct(Region::L, text.byte), kind, u32::from(text.maximum), 0);
        }
    }

    fn store_head(&mut self, addr: Address, kind: Text, maximum: u32, length: u32) {
        match kind {
            Text::Narrow => {
                let head = self.b.i32_const(maximum << 8 | length);
                self.store_low(addr, Width::Word, head);
            }
            Text::Wide => {
                let head = self.b.i32_const(maximum << 16 | length);
                self.store_low(addr, Width::Dword, head);
            }
        }
    }

    /// Room in the frame for a text that only functions of texts read and write: an empty text, and after it whatever was there.
    pub fn text_room(&mut self) -> Address {
        let addr = self.temporary(TEXT_MAX + 2);
        self.store_head(addr, Text::Narrow, TEXT_MAX, 0);
        self.add_room(addr);
        addr
    }

    /// As [`text_room`](Self::text_room), for the result of a function of the program that reads and writes it so.
    pub fn own_result_room(&mut self) -> Address {
        let addr = self.text_room();
        self.drop_room(addr);
        addr
    }

    /// Room in the frame for a result of type `ty`: 0, and empty texts.
    pub fn result_room(&mut self, ty: &DataType) -> Address {
        let bytes = result_bytes(ty);
        let addr = self.temporary(bytes);
        self.b.clear(addr, bytes);
        match Text::of(ty) {
            Some(kind) => self.store_head(addr, kind, result_maximum(ty), 0),
            None => self.store_heads(addr, ty),
        }
        addr
    }

    /// Heads of the texts in a structure or array, with their declared maxima.
    fn store_heads(&mut self, addr: Address, ty: &DataType) {
        match ty {
            DataType::String(maximum) => self.store_head(addr, Text::Narrow, u32::from(*maximum), 0),
            DataType::WideString(maximum) => self.store_head(addr, Text::Wide, u32::from(*maximum), 0),
            DataType::Struct(structure) => {
                for member in &structure.members {
                    self.store_heads(moved(addr, member.byte), &member.ty);
                }
            }
            DataType::Array(array) if !matches!(array.element, DataType::Elementary(_)) => {
                for index in 0..layout::element_count(&array.bounds) {
                    let (distance, _) = layout::element_place(array, index);
                    self.store_heads(moved(addr, distance), &array.element);
                }
            }
            _ => {}
        }
    }

    /// `s := t`
    pub fn assign_text(&mut self, target: &Access, value: &Complex) {
        let kind = Text::of(&target.ty).expect("the binder assigns texts to texts");
        let located = self.locate(target);
        let own = self.formal_text_of(target).and_then(|formal| formal.own);
        let limit = own.map_or(self.text_limit(target), |own| own.declared.into());
        let to = &located;
        if let (Complex::Const(bytes), Text::Narrow) = (value, kind)
            && limit != OWN_MAXIMUM
            && bytes.len() <= STORED_BYTES_MAX
        {
            return self.store_constant_text(to, limit, &bytes[2..2 + usize::from(bytes[1])], own);
        }
        let in_frame = |addr, maximum| TextPlace { addr, maximum, formal: None };
        let (from, mut checks) = match value {
            Complex::Variable(access) => {
                let from = self.locate(access);
                let (from, checks) = self.located_address(&from, Direction::Read);
                (self.text_place(access, from), checks)
            }
            Complex::Call(_) => {
                let only_text = std::mem::replace(&mut self.scl.only_text, true);
                let from = self.complex_value(value);
                self.scl.only_text = only_text;
                (in_frame(from, TEXT_MAX), Vec::new())
            }
            // Short constants are stored, and others copied by the runtime.
            Complex::Const(_) | Complex::Character(_) => (in_frame(self.complex_value(value), OWN_MAXIMUM), Vec::new()),
        };
        let (to, more) = self.located_address(to, Direction::Write);
        checks.extend(more);
        let guard = self.begin_guard(checks, Substitute::None);
        self.copy_text(self.text_place(target, to), from, kind);
        self.end_guard(guard);
    }

    /// Drops what the result of this block, a text, has beyond its declared length: where it is written there is room for more.
    pub fn cut_text_result(&mut self) {
        let block = self.block;
        let Some((parameter, formal)) = super::result(block) else { return };
        let (declared, byte, width) = match formal.ty {
            DataType::String(declared) => (u32::from(declared), 1, Width::Byte),
            DataType::WideString(declared) => (u32::from(declared), 2, Width::Word),
            _ => return,
        };
        if declared >= TEXT_MAX {
            return;
        }
        let own = self.formal_texts.get(&parameter).and_then(|formal| formal.own);
        let place = Place::Parameter { parameter, byte, bit: 0 };
        let length = match own {
            Some(own) => self.own_length(own),
            None => self.read(&place, width),
        };
        let most = self.b.i32_const(declared);
        let is_longer = self.b.icmp(IntCc::Ugt, length, most);
        let kept = self.b.select(is_longer, most, length);
        match own {
            Some(own) => self.set_own_length(own, kept),
            None => self.write(&place, width, kept),
        }
        self.fail_if(is_longer);
    }

    /// The text of an access, which is at `addr`.
    pub fn text_place(&self, access: &Access, addr: Address) -> TextPlace {
        TextPlace { addr, maximum: self.text_limit(access), formal: self.formal_text_of(access) }
    }

    /// Stores constant characters and their number; the variable keeps its maximum.
    fn store_constant_text(&mut self, to: &Located, limit: u32, characters: &[u8], own: Option<OwnText>) {
        let kept = characters.len().min(limit as usize);
        let (to, checks) = self.located_address(to, Direction::Write);
        let guard = self.begin_guard(checks, Substitute::None);
        let own = own.or_else(|| self.own_text(to, u8::try_from(limit).ok()?));
        self.store_characters(moved(to, 2), &characters[..kept], own);
        let length = self.b.i32_const(kept as u32);
        match own {
            Some(own) => self.set_own_length(own, length),
            None => self.store_low(Address { offset: to.offset + 1, ..to }, Width::Byte, length),
        }
        let cut = self.b.bool_const(kept < characters.len());
        self.fail_if(cut);
        self.end_guard(guard);
    }

    /// Copies characters of a text; those that do not fit are dropped, which clears the bit.
    pub fn copy_text(&mut self, to: TextPlace, from: TextPlace, kind: Text) {
        let end = match kind {
            Text::Narrow => self.copy_text_shortly(to, from),
            Text::Wide => None,
        };
        let (to_address, from_address) = (self.b.address_of(to.addr), self.b.address_of(from.addr));
        let limit = self.b.i32_const(to.maximum);
        let wide = self.b.i32_const(u32::from(kind == Text::Wide));
        let arguments = [to_address, from_address, limit, wide];
        let [own_to, own_from] = [to, from].map(|text| self.own_text_at(&text).filter(|_| kind == Text::Narrow));
        if let Some(own) = own_from {
            self.store_own_length(from.addr, own);
        }
        let cut = self.b.call_runtime(RuntimeFn::CopyText, &arguments).expect("copy_text has a result");
        if let Some(own) = own_to {
            self.load_own_length(to.addr, own);
        }
        let cut = self.b.icmp_imm(IntCc::Ne, cut, 0);
        self.fail_if(cut);
        if let Some(end) = end {
            self.b.jump(end, &[]);
            self.b.seal_block(end);
            self.b.switch_to(end);
        }
    }

    /// A constant, a result or a character: its address in the frame.
    pub fn complex_value(&mut self, value: &Complex) -> Address {
        match value {
            Complex::Variable(_) => unreachable!("variables are located where they are read"),
            Complex::Const(bytes) => {
                let addr = self.temporary(bytes.len() as u32);
                self.store_bytes(addr, bytes);
                addr
            }
            Complex::Call(_) => self.complex_result(value),
            Complex::Character(expr) => {
                let character = self.value(expr);
                let addr = self.temporary(8);
                if expr.ty == Elementary::Wchar {
                    self.store_head(addr, Text::Wide, 1, 1);
                    self.b.store(Address { offset: addr.offset + 4, ..addr }, character);
                } else {
                    self.store_head(addr, Text::Narrow, 1, 1);
                    let wide = self.b.zext(Type::I32, character);
                    self.store_low(Address { offset: addr.offset + 2, ..addr }, Width::Byte, wide);
                }
                addr
            }
        }
    }

    /// The address of the complex result of a call.
    pub fn complex_result(&mut self, value: &Complex) -> Address {
        let Complex::Call(call) = value else { unreachable!("only used for calls") };
        self.scl_call(call).place.expect("the binder only accepts complex values of functions that have one")
    }

    /// Maximum length of a text. For a formal parameter it is that of its actual.
    pub fn text_limit(&self, target: &Access) -> u32 {
        let parameters = &self.block.interface.parameters;
        let parameter = match &target.base {
            Base::Place(Place::Parameter { parameter, .. }) => parameters.get(*parameter),
            Base::Place(Place::ThroughPointer { pointer, .. }) => parameters.iter().find(|own| own.byte == *pointer),
            Base::Place(_) | Base::Indexed { .. } => None,
        };
        match (&target.ty, parameter.map(|parameter| &parameter.ty)) {
            (_, Some(DataType::String(_) | DataType::WideString(_))) => OWN_MAXIMUM,
            (DataType::String(maximum), _) => u32::from(*maximum),
            (DataType::WideString(maximum), _) => u32::from(*maximum),
            _ => OWN_MAXIMUM,
        }
    }
}
