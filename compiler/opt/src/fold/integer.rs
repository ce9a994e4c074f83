//! Rules for operations with two operands, and for taking words out of wider values.

use plcc_abi::layout::L_CLASS_BYTES;
use plcc_ir::{Address, BinaryOp, ConvertOp, InstData, Region, Type, Value, eval};

use super::{Change, Folder, constant};
use crate::known_bits::{known_zero, shift_count};

/// Instructions through which a bit is followed to where it comes from.
const BITS_MAX: usize = 32;
const BEYOND_A_BYTE: u64 = !0xFF;

impl Folder<'_> {
    pub(super) fn binary(&mut self, op: BinaryOp, [a, b]: [Value; 2]) -> Option<Change> {
        let ty = self.ty(a);
        let (ca, cb) = (self.constant(a), self.constant(b));
        if let (Some(ca), Some(cb)) = (ca, cb) {
            return eval::binary(op, ty, ca, cb).and_then(constant);
        }
        if !ty.is_int() {
            return None;
        }
        // Constants are on the right.
        if ca.is_some() && is_commutative(op) {
            return Some(Change::Data(InstData::Binary { op, args: [b, a] }));
        }
        if let Some(cb) = cb
            && let Some(change) = self.binary_with_constant(op, ty, a, b, cb)
        {
            return Some(change);
        }
        match op {
            BinaryOp::Shl | BinaryOp::Lshr | BinaryOp::Ashr | BinaryOp::Rotl | BinaryOp::Rotr if ca == Some(0) => {
                constant(0)
            }
            BinaryOp::Iadd => self.constant_last(a, b).or_else(|| self.constant_last(b, a)),
            BinaryOp::And | BinaryOp::Or if a == b => Some(Change::Value(a)),
            BinaryOp::Xor | BinaryOp::Isub if a == b => constant(0),
            BinaryOp::Isub => self.distance(a, b),
            BinaryOp::And | BinaryOp::Or => self
                .complements(op, ty, a, b)
                .or_else(|| self.absorbed(op, a, b))
                .or_else(|| if ty == Type::I1 { self.combined_compares(op, a, b) } else { self.disjoint(op, a, b) })
                .or_else(|| self.between(op, a, b))
                .or_else(|| self.never_both(op, a, b))
                .or_else(|| self.wrapped_place(op, a, b)),
            BinaryOp::Xor => match (self.negated(a), self.negated(b)) {
                (Some(x), Some(y)) => Some(Change::Data(InstData::Binary { op, args: [x, y] })),
                _ if ty == Type::I1 => self.combined_compares(op, a, b),
                _ => None,
            },
            _ => None,
        }
    }

    /// The distance of two places in local data.
    fn distance(&self, a: Value, b: Value) -> Option<Change> {
        let place = |value| match self.function.defining(value)? {
            InstData::AddressOf { addr } if matches!(addr.region, Region::L | Region::V) => Some(*addr),
            _ => None,
        };
        let (a, b) = (place(a)?, place(b)?);
        if (a.region, a.base) != (b.region, b.base) {
            return None;
        }
        constant(u64::from(a.offset.wrapping_sub(b.offset)))
    }

    /// The region and the offset of a place in local data.
    pub(super) fn local_place(&self, value: Value) -> Option<(Region, u64)> {
        let (value, by) = self.with_constant(BinaryOp::Iadd, value).unwrap_or((value, 0));
        match *self.function.defining(value)? {
            InstData::AddressOf { addr: Address { region: region @ (Region::L | Region::V), base: None, offset } } => {
                let offset = u64::from(offset) + by;
                (offset <= u64::from(L_CLASS_BYTES)).then_some((region, offset))
            }
            _ => None,
        }
    }

    /// `(p & stack) | (q & inside)` of two places in the own frame, where `inside` has the bits of an address in an L stack and `stack` the
    /// others, is q: no frame lies across the end of a stack.
    fn wrapped_place(&self, op: BinaryOp, a: Value, b: Value) -> Option<Change> {
        const INSIDE: u64 = L_CLASS_BYTES as u64 - 1;
        const STACK: u64 = !INSIDE & u32::MAX as u64;
        let (one, kept) = self.with_constant(BinaryOp::And, a)?;
        let (other, more) = self.with_constant(BinaryOp::And, b)?;
        let (stack, place) = match (op, kept, more) {
            (BinaryOp::Or, STACK, INSIDE) => (one, other),
            (BinaryOp::Or, INSIDE, STACK) => (other, one),
            _ => return None,
        };
        let bytes = u64::from(self.function.local_bytes());
        let is_own = |value| matches!(self.local_place(value), Some((Region::L, offset)) if offset < bytes);
        (is_own(stack) && is_own(place)).then_some(Change::Value(place))
    }

    fn binary_with_constant(&mut self, op: BinaryOp, ty: Type, a: Value, b: Value, cb: u64) -> Option<Change> {
        let all = eval::mask(ty, u64::MAX);
        let zeros = known_zero(self.function, a);
        match op {
            BinaryOp::And => {
                if !zeros & !cb & all == 0 {
                    return Some(Change::Value(a));
                }
                if !zeros & cb == 0 {
                    return constant(0);
                }
            }
            BinaryOp::Or => {
                if cb == 0 {
                    return Some(Change::Value(a));
                }
                if cb == all {
                    return constant(all);
                }
            }
            BinaryOp::Xor => {
                if cb == 0 {
                    return Some(Change::Value(a));
                }
                if cb == 1
                    && ty == Type::I1
                    && let Some(change) = self.inverted_compare(a)
                {
                    return Some(change);
                }
            }
            BinaryOp::Iadd if cb == 0 => return Some(Change::Value(a)),
            BinaryOp::Isub => {
                if cb == 0 {
                    return Some(Change::Value(a));
                }
                let minus = self.emit_const(ty, cb.wrapping_neg());
                return Some(Change::Data(InstData::Binary { op: BinaryOp::Iadd, args: [a, minus] }));
            }
            BinaryOp::Imul => match cb {
                0 => return constant(0),
                1 => return Some(Change::Value(a)),
                _ if cb.is_power_of_two() => {
                    let count = self.emit_const(ty, u64::from(cb.trailing_zeros()));
                    return Some(Change::Data(InstData::Binary { op: BinaryOp::Shl, args: [a, count] }));
                }
                _ => {}
            },
            BinaryOp::Sdiv | BinaryOp::Udiv if cb == 1 => return Some(Change::Value(a)),
            BinaryOp::Shl | BinaryOp::Lshr | BinaryOp::Ashr | BinaryOp::Rotl | BinaryOp::Rotr => {
                if shift_count(self.function, ty, b) == Some(0) {
                    return Some(Change::Value(a));
                }
                return self
                    .shift_of_shift(op, ty, a, b)
                    .or_else(|| self.shift_of_parts(op, ty, a, b))
                    .or_else(|| if op == BinaryOp::Lshr { self.shift_of_masked_sum(ty, a, b) } else { None });
            }
            BinaryOp::Iadd
            | BinaryOp::Sdiv
            | BinaryOp::Srem
            | BinaryOp::Udiv
            | BinaryOp::Urem
            | BinaryOp::Fadd
            | BinaryOp::Fsub
            | BinaryOp::Fmul
            | BinaryOp::Fdiv => {}
        }
        let change = self.reassociated(op, ty, a, cb);
        if change.is_some() || op != BinaryOp::And {
            return change;
        }
        self.and_of_parts(a, b, cb).or_else(|| self.and_of_pointer(ty, a, b, cb))
    }

    /// `(x op c1) op c2` is `x op (c1 op c2)`.
    fn reassociated(&mut self, op: BinaryOp, ty: Type, a: Value, cb: u64) -> Option<Change> {
        if !matches!(op, BinaryOp::Iadd | BinaryOp::And | BinaryOp::Or | BinaryOp::Xor) {
            return None;
        }
        let Some(&InstData::Binary { op: inner, args: [x, c] }) = self.function.defining(a) else { return None };
        let bits = eval::binary(op, ty, self.constant(c)?, cb)?;
        if inner != op {
            return None;
        }
        let both = self.emit_const(ty, bits);
        Some(Change::Data(InstData::Binary { op, args: [x, both] }))
    }

    /// `(x + c) + y` is `(x + y) + c`: as part of an address a constant costs nothing.
    fn constant_last(&mut self, a: Value, b: Value) -> Option<Change> {
        let (x, _) = self.with_constant(BinaryOp::Iadd, a)?;
        let Some(&InstData::Binary { args: [_, addend], .. }) = self.function.defining(a) else { return None };
        let sum = self.emit(InstData::Binary { op: BinaryOp::Iadd, args: [x, b] }, self.ty(a));
        Some(Change::Data(InstData::Binary { op: BinaryOp::Iadd, args: [sum, addend] }))
    }

    /// `and x, (not x)` is 0, `or x, (not x)` has all bits.
    fn complements(&self, op: BinaryOp, ty: Type, a: Value, b: Value) -> Option<Change> {
        if self.negated(a) != Some(b) && self.negated(b) != Some(a) {
            return None;
        }
        constant(if op == BinaryOp::And { 0 } else { eval::mask(ty, u64::MAX) })
    }

    /// `and x, (or x, y)` and `or x, (and x, y)` are x; the same with the inner operation repeated.
    fn absorbed(&self, op: BinaryOp, a: Value, b: Value) -> Option<Change> {
        for (x, other) in [(a, b), (b, a)] {
            if let Some(&InstData::Binary { op: inner, args }) = self.function.defining(other)
                && args.contains(&x)
            {
                match (op, inner) {
                    (BinaryOp::And, BinaryOp::Or) | (BinaryOp::Or, BinaryOp::And) => return Some(Change::Value(x)),
                    (BinaryOp::And, BinaryOp::And) | (BinaryOp::Or, BinaryOp::Or) => return Some(Change::Value(other)),
                    _ => {}
                }
            }
        }
        None
    }

    /// An `or` or `and` one of whose operands is 0 in all bits where it could matter.
    fn disjoint(&self, op: BinaryOp, a: Value, b: Value) -> Option<Change> {
        let possible = |value| !known_zero(self.function, value);
        match op {
            BinaryOp::And if possible(a) & possible(b) == 0 => constant(0),
            BinaryOp::Or if possible(a) == 0 => Some(Change::Value(b)),
            BinaryOp::Or if possible(b) == 0 => Some(Change::Value(a)),
            _ => None,
        }
    }

    /// The operand of `or a, b` or `xor a, b`, or of an `iadd` without carries into `wanted`, that alone has bits in `wanted`.
    fn part_with(&self, value: Value, wanted: u64) -> Option<Value> {
        match self.function.defining(value) {
            Some(&InstData::Binary { op: op @ (BinaryOp::Or | BinaryOp::Xor | BinaryOp::Iadd), args: [a, b] }) => {
                let any = |value| !known_zero(self.function, value);
                // Into the low bits nothing is carried from higher ones.
                if op == BinaryOp::Iadd && any(a) & any(b) != 0 && !is_low_mask(wanted) {
                    return None;
                }
                let possible = |value| !known_zero(self.function, value) & wanted;
                if possible(a) == 0 {
                    Some(b)
                } else if possible(b) == 0 {
                    Some(a)
                } else {
                    None
                }
            }
            Some(&InstData::Binary { op: BinaryOp::And, args: [a, b] }) => {
                let mask = self.constant(b)?;
                (mask & wanted == wanted).then_some(a)
            }
            _ => None,
        }
    }

    fn and_of_parts(&self, a: Value, b: Value, mask: u64) -> Option<Change> {
        let part = self.part_with(a, mask)?;
        Some(Change::Data(InstData::Binary { op: BinaryOp::And, args: [part, b] }))
    }

    /// `((x | c) + y) & mask`, where `mask` has the low bits and c only others, is `(x + y) & mask`; of `(x + c) & mask` only the low
    /// bits of c matter. The area of a pointer does not reach its address, which then is a sum of small numbers.
    fn and_of_pointer(&mut self, ty: Type, a: Value, b: Value, mask: u64) -> Option<Change> {
        let &InstData::Binary { op: BinaryOp::Iadd, args: [x, y] } = self.function.defining(a)? else { return None };
        if !is_low_mask(mask) {
            return None;
        }
        let args = match (self.without_area(x, mask), self.without_area(y, mask)) {
            (None, None) => [x, self.address_in(ty, y, mask)?],
            (of_x, of_y) => [of_x.unwrap_or(x), of_y.unwrap_or(y)],
        };
        let sum = self.emit(InstData::Binary { op: BinaryOp::Iadd, args }, ty);
        Some(Change::Data(InstData::Binary { op: BinaryOp::And, args: [sum, b] }))
    }

    /// The operand of `or x, c`, if c has no bits of `mask`.
    fn without_area(&self, value: Value, mask: u64) -> Option<Value> {
        let (x, area) = self.with_constant(BinaryOp::Or, value)?;
        (area & mask == 0).then_some(x)
    }

    /// The low bits of a constant that has others, too. A negative one stays: in a sum it is a small number.
    fn address_in(&mut self, ty: Type, value: Value, mask: u64) -> Option<Value> {
        let bits = self.constant(value)?;
        let low = bits & mask;
        (low != bits && low <= mask >> 1).then(|| self.emit_const(ty, low))
    }

    /// A shift whose other part is shifted out.
    fn shift_of_parts(&self, op: BinaryOp, ty: Type, a: Value, b: Value) -> Option<Change> {
        let count = shift_count(self.function, ty, b)?;
        let all = eval::mask(ty, u64::MAX);
        let wanted = match op {
            BinaryOp::Shl => all >> count,
            BinaryOp::Lshr => all >> count << count,
            _ => return None,
        };
        let part = self.part_with(a, wanted)?;
        Some(Change::Data(InstData::Binary { op, args: [part, b] }))
    }

    /// `((x + c) & mask) >> n`, where `mask` has the low bits, and c ends in n zeros: `(((x & mask) >> n) + (c >> n)) & (mask >> n)`.
    /// Pointers count bits: that to a part of an instance then is the one to the instance plus a number of bytes.
    fn shift_of_masked_sum(&mut self, ty: Type, a: Value, b: Value) -> Option<Change> {
        let count = shift_count(self.function, ty, b)?;
        let (sum, mask) = self.with_constant(BinaryOp::And, a)?;
        let (x, addend) = self.with_constant(BinaryOp::Iadd, sum)?;
        if !is_low_mask(mask) || addend & eval::mask(ty, (1 << count) - 1) != 0 {
            return None;
        }
        let x = if !known_zero(self.function, x) & !mask == 0 {
            x
        } else {
            let mask = self.emit_const(ty, mask);
            self.emit(InstData::Binary { op: BinaryOp::And, args: [x, mask] }, ty)
        };
        let shifted = self.emit(InstData::Binary { op: BinaryOp::Lshr, args: [x, b] }, ty);
        let addend = self.emit_const(ty, addend >> count);
        let sum = self.emit(InstData::Binary { op: BinaryOp::Iadd, args: [shifted, addend] }, ty);
        let mask = self.emit_const(ty, mask >> count);
        Some(Change::Data(InstData::Binary { op: BinaryOp::And, args: [sum, mask] }))
    }

    /// The operands of `value` if it is `op` with a constant.
    fn with_constant(&self, op: BinaryOp, value: Value) -> Option<(Value, u64)> {
        match self.function.defining(value) {
            Some(&InstData::Binary { op: found, args: [x, c] }) if found == op => Some((x, self.constant(c)?)),
            _ => None,
        }
    }

    /// Two shifts in the same direction are one; back and forth they are none if nothing is lost.
    fn shift_of_shift(&mut self, op: BinaryOp, ty: Type, a: Value, b: Value) -> Option<Change> {
        let Some(&InstData::Binary { op: inner, args: [x, c] }) = self.function.defining(a) else { return None };
        let (outer_count, inner_count) = (shift_count(self.function, ty, b)?, shift_count(self.function, ty, c)?);
        if (inner, op, inner_count) == (BinaryOp::Shl, BinaryOp::Lshr, outer_count) {
            let lost = eval::mask(ty, u64::MAX) & !(eval::mask(ty, u64::MAX) >> inner_count);
            return (lost & !known_zero(self.function, x) == 0).then_some(Change::Value(x));
        }
        if inner != op || !matches!(op, BinaryOp::Shl | BinaryOp::Lshr) {
            return None;
        }
        let count = outer_count + inner_count;
        if count >= ty.bits() {
            return constant(0);
        }
        let count = self.emit_const(ty, u64::from(count));
        Some(Change::Data(InstData::Binary { op, args: [x, count] }))
    }

    /// A word that is shifted in a wider type and taken out of it again is shifted as it is.
    pub(super) fn trunc_of_shift(&mut self, to: Type, arg: Value) -> Option<Change> {
        let Some(&InstData::Binary { op, args: [wide, count] }) = self.function.defining(arg) else { return None };
        let Some(&InstData::Convert { op: extended, arg: word }) = self.function.defining(wide) else { return None };
        let fills = match extended {
            ConvertOp::Zext => matches!(op, BinaryOp::Shl | BinaryOp::Lshr),
            ConvertOp::Sext => matches!(op, BinaryOp::Shl | BinaryOp::Ashr),
            _ => false,
        };
        let count = shift_count(self.function, self.ty(arg), count)?;
        if !fills || self.ty(word).bits() > to.bits() || to == Type::I1 || count >= to.bits() {
            return None;
        }
        let word =
            if self.ty(word) == to { word } else { self.emit(InstData::Convert { op: extended, arg: word }, to) };
        let count = self.emit_const(to, u64::from(count));
        Some(Change::Data(InstData::Binary { op, args: [word, count] }))
    }

    /// The low half of a sum of a word, extended and perhaps shifted, and a constant: it is added in the narrower type.
    pub(super) fn trunc_of_sum(&mut self, to: Type, arg: Value) -> Option<Change> {
        let (wide, constant) = self.with_constant(BinaryOp::Iadd, arg)?;
        let extended = match *self.function.defining(wide)? {
            InstData::Binary { op: BinaryOp::Shl, args: [x, count] } if self.constant(count).is_some() => x,
            _ => wide,
        };
        let &InstData::Convert { op: ConvertOp::Zext | ConvertOp::Sext, arg: word } =
            self.function.defining(extended)?
        else {
            return None;
        };
        if self.ty(word).bits() > to.bits() || to == Type::I1 {
            return None;
        }
        let low = match self.convert(ConvertOp::Trunc, to, wide) {
            Some(Change::Value(low)) => low,
            Some(Change::Data(data)) => self.emit(data, to),
            None => self.emit(InstData::Convert { op: ConvertOp::Trunc, arg: wide }, to),
        };
        let constant = self.emit_const(to, constant);
        Some(Change::Data(InstData::Binary { op: BinaryOp::Iadd, args: [low, constant] }))
    }

    /// A bit of a byte put together from bits and others: it is the one that was put there, or one of what was there before. In words, bits
    /// would live on beside them.
    pub(super) fn trunc_of_bits(&mut self, arg: Value) -> Option<Change> {
        let is_inside = |&(_, bit): &(Value, u64)| bit < u64::from(self.ty(arg).bits());
        let shifted = self.with_constant(BinaryOp::Lshr, arg).filter(is_inside);
        let (mut value, mut bit) = shifted.unwrap_or((arg, 0));
        if known_zero(self.function, value) & BEYOND_A_BYTE != BEYOND_A_BYTE {
            return None;
        }
        let mut is_put_together = false;
        for _ in 0..BITS_MAX {
            let Some(data) = self.function.defining(value) else { break };
            match *data {
                InstData::Convert { op: ConvertOp::Zext, arg } if self.ty(arg) == Type::I1 => {
                    return if bit == 0 { Some(Change::Value(arg)) } else { constant(0) };
                }
                InstData::Convert { op: ConvertOp::Zext, arg } if bit < u64::from(self.ty(arg).bits()) => value = arg,
                InstData::Convert { op: ConvertOp::Trunc, arg } => value = arg,
                InstData::Binary { op: op @ (BinaryOp::And | BinaryOp::Or | BinaryOp::Xor), args: [a, b] } => {
                    let is_zero = |value| known_zero(self.function, value) >> bit & 1 != 0;
                    let mask = self.constant(b).map(|bits| bits >> bit & 1);
                    value = match (op, mask) {
                        (BinaryOp::And, Some(0)) => return constant(0),
                        (BinaryOp::Or, Some(1)) => return constant(1),
                        (BinaryOp::And, Some(1)) | (BinaryOp::Or | BinaryOp::Xor, Some(0)) => a,
                        (BinaryOp::Or | BinaryOp::Xor, None) if is_zero(b) => a,
                        (BinaryOp::Or | BinaryOp::Xor, None) if is_zero(a) => b,
                        _ => break,
                    };
                    is_put_together = true;
                }
                InstData::Binary { op: op @ (BinaryOp::Shl | BinaryOp::Lshr), args: [x, count] } => {
                    let Some(count) = shift_count(self.function, self.ty(value), count) else { break };
                    let from = match op {
                        BinaryOp::Shl => bit.checked_sub(u64::from(count)),
                        _ => Some(bit + u64::from(count)).filter(|&from| from < u64::from(self.ty(value).bits())),
                    };
                    let Some(from) = from else { return constant(0) };
                    (value, bit) = (x, from);
                }
                _ => break,
            }
        }
        if !is_put_together {
            return None;
        }
        let ty = self.ty(value);
        let arg = if bit == 0 {
            value
        } else {
            let count = self.emit_const(ty, bit);
            self.emit(InstData::Binary { op: BinaryOp::Lshr, args: [value, count] }, ty)
        };
        Some(Change::Data(InstData::Convert { op: ConvertOp::Trunc, arg }))
    }

    /// The low word of something put together from words.
    pub(super) fn trunc_of_parts(&mut self, to: Type, arg: Value) -> Option<Change> {
        let wanted = eval::mask(to, u64::MAX);
        let part = self.part_with(arg, wanted)?;
        Some(Change::Data(InstData::Convert { op: ConvertOp::Trunc, arg: part }))
    }
}

/// True if exactly some low bits are set.
fn is_low_mask(bits: u64) -> bool {
    bits & bits.wrapping_add(1) == 0
}

/// True if the operands may change places.
pub(crate) fn is_commutative(op: BinaryOp) -> bool {
    match op {
        BinaryOp::Iadd | BinaryOp::Imul | BinaryOp::And | BinaryOp::Or | BinaryOp::Xor => true,
        // Not the floats: of two NaN the first one's bits come out.
        BinaryOp::Isub
        | BinaryOp::Sdiv
        | BinaryOp::Srem
        | BinaryOp::Udiv
        | BinaryOp::Urem
        | BinaryOp::Shl
        | BinaryOp::Lshr
        | BinaryOp::Ashr
        | BinaryOp::Rotl
        | BinaryOp::Rotr
        | BinaryOp::Fadd
        | BinaryOp::Fsub
        | BinaryOp::Fmul
        | BinaryOp::Fdiv => false,
    }
}
