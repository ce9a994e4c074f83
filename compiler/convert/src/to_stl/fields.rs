//! SET_BF and RESET_BF: fields of bits, one instruction for each. Source: LAD/FBD reference B.1, C.4.

use plcc_syntax::ast::{Bound, Operand, OperandKind, Path, PathPart, TypeKind};
use plcc_syntax::literal::Literal;
use plcc_syntax::network::ast::{Graph, PinValue};
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::logic::Logic;
use super::plan::Plan;

/// The longest field that becomes statements.
const FIELD_MAX: i64 = 256;

/// The first and the last index of a dimension.
type Bounds = (i64, i64);

impl Maker<'_> {
    pub fn bit_field(&mut self, graph: &Graph, plan: &Plan, at: usize, set: bool) {
        let element = &graph.elements[at];
        let Some(first) = self.pin_operand(element, "operand") else { return };
        let count = match element.pin("n").map(|pin| &pin.value) {
            Some(PinValue::Operand(value)) => crate::operand::constant(value),
            Some(PinValue::Net(_) | PinValue::Open) | None => None,
        };
        let count = match count {
            Some(Literal::Int(count)) => count,
            Some(Literal::Dint(count)) => i64::from(count),
            Some(Literal::Bits { value, .. }) => i64::from(value),
            _ => return self.refuse(element.span, "a field of bits whose length is not a number", "write the number"),
        };
        let Some(bits) = self.bits_from(&first, count) else { return };
        let flow = self.input(graph, plan, at, "in");
        let flow = self.passed(graph, plan, at, flow);
        if bits.is_empty() || matches!(flow, Logic::Constant(false)) {
            return;
        }
        self.evaluate(&flow);
        for bit in bits {
            self.push(if set { StlInsn::Set } else { StlInsn::Reset }, Some(bit));
        }
    }

    /// The bits of a field, which ends with its array; none after a message.
    fn bits_from(&mut self, first: &Operand, count: i64) -> Option<Vec<Operand>> {
        let left = match &first.kind {
            OperandKind::Path(path) => self.elements_from(path),
            OperandKind::Absolute { .. } | OperandKind::DbAbsolute { .. } => Some(i64::MAX),
            _ => None,
        };
        let count = match left {
            Some(left) => count.clamp(0, left),
            None if count == 1 => 1,
            None => {
                let help = "begin it at an address, or at an element of an ARRAY OF BOOL that is in the sources";
                self.refuse(first.span, "a field of bits from this variable on", help);
                return None;
            }
        };
        if count > FIELD_MAX {
            let help = format!(
                "STL sets one bit at a time: fill bytes with FILL_BLK, or use fields of up to {FIELD_MAX} bits"
            );
            self.refuse(first.span, format!("a field of {count} bits"), &help);
            return None;
        }
        Some((0..count).map(|distance| self.bit_after(first, distance)).collect())
    }

    /// How many elements an array has from the one on that a path names by numbers; none for other paths.
    fn elements_from(&self, path: &Path) -> Option<i64> {
        let (bounds, indices) = self.array_and_indices(path)?;
        let length = |(low, high): &Bounds| high.checked_sub(*low)?.checked_add(1);
        let total = bounds.iter().try_fold(1_i64, |before, one| before.checked_mul(length(one)?))?;
        Some(total - position(&bounds, &indices))
    }

    /// The bounds of the array of which a path names an element, and the indices of that.
    fn array_and_indices(&self, path: &Path) -> Option<(Vec<Bounds>, Vec<i64>)> {
        let number = |bound: &Bound| match bound {
            Bound::Number(number, _) => Some(*number),
            Bound::Name(..) | Bound::Expr(_) | Bound::Path(_) => None,
        };
        let (PathPart::Index { values, .. }, before) = path.parts.split_last()? else { return None };
        let array = Path { root: path.root.clone(), parts: before.to_vec(), span: path.span };
        let declared = self.types.declared(&OperandKind::Path(array), self.block)?;
        let TypeKind::Array { bounds, .. } = &declared.kind else { return None };
        let bounds =
            bounds.iter().map(|(low, high)| Some((number(low)?, number(high)?))).collect::<Option<Vec<_>>>()?;
        let indices = values.iter().map(number).collect::<Option<Vec<_>>>()?;
        let is_inside = |((low, high), index): (&Bounds, &i64)| (*low..=*high).contains(index);
        (bounds.len() == indices.len() && bounds.iter().zip(&indices).all(is_inside)).then_some((bounds, indices))
    }

    /// The bit that is so many bits further.
    fn bit_after(&self, first: &Operand, distance: i64) -> Operand {
        let mut bit = first.clone();
        match &mut bit.kind {
            OperandKind::Absolute { byte, bit, .. } | OperandKind::DbAbsolute { byte, bit, .. } => {
                let moved = u32::from(*bit) + distance as u32;
                *byte += moved / 8;
                *bit = (moved % 8) as u8;
            }
            OperandKind::Path(path) => {
                if let Some((bounds, indices)) = self.array_and_indices(path)
                    && let Some(PathPart::Index { values, .. }) = path.parts.last_mut()
                {
                    let mut rest = position(&bounds, &indices) + distance;
                    for (value, (low, high)) in values.iter_mut().zip(&bounds).rev() {
                        let length = high - low + 1;
                        *value = Bound::Number(low + rest % length, first.span);
                        rest /= length;
                    }
                }
            }
            _ => {}
        }
        bit
    }
}

/// The number of an element, 0 for the first; the last index counts fastest.
fn position(bounds: &[(i64, i64)], indices: &[i64]) -> i64 {
    bounds.iter().zip(indices).fold(0, |before, ((low, high), index)| before * (high - low + 1) + index - low)
}
