//! Characters of texts with variable indices, `s[i]`: one that the text does not have reads 0 and is not written.
//!
//! Source: SCL reference, access to characters of texts.

use plcc_model::Place;
use plcc_model::scl::{Access, Base, Expr, Index, IndexBounds};
use plcc_model::types::{DataType, Elementary};
use plcc_syntax::ast::Operand;
use plcc_syntax::stl::StlInsn;

use super::Maker;

/// The number of a character, and the text in which it is.
struct Character {
    number: Operand,
    /// As many as the declaration of the text has.
    length: u64,
    /// The head of the text, if it may say fewer.
    head: Option<Access>,
}

/// The only index of the access is the number of a character.
pub fn is_character(access: &Access) -> bool {
    access.part.is_none() && matches!(access.indices[..], [Index { bounds: IndexBounds::Characters { .. }, .. }])
}

impl Maker<'_> {
    /// Loads a character.
    pub fn load_character(&mut self, access: &Access, ty: Elementary) {
        let Some(character) = self.character(access) else { return };
        let result = self.temporary(ty);
        self.push(StlInsn::Load, Some(super::code::number(0, self.span)));
        self.push(StlInsn::Transfer, Some(result.clone()));
        let end = self.new_label();
        self.jump_if_outside(&character, &end);
        self.known_index = Some(character.number);
        if let Some(target) = self.target(access, true) {
            let operand = self.reach(&target, ty);
            self.load_and_store(ty, operand, result.clone());
        }
        self.label(&end, self.span.start);
        self.push(StlInsn::Load, Some(result));
    }

    /// Stores a value as a character.
    pub fn store_character(&mut self, access: &Access, value: &Expr) {
        let Some(character) = self.character(access) else { return };
        self.number(value);
        let stored = self.keep(value.ty);
        let end = self.new_label();
        self.jump_if_outside(&character, &end);
        self.known_index = Some(character.number);
        if let Some(target) = self.target(access, true) {
            self.push(StlInsn::Load, Some(stored));
            let operand = self.reach(&target, value.ty);
            self.push(StlInsn::Transfer, Some(operand));
        }
        self.label(&end, self.span.start);
        self.close_labels();
    }

    fn character(&mut self, access: &Access) -> Option<Character> {
        let [Index { value, bounds: IndexBounds::Characters { length, in_head }, stride }] = &access.indices[..] else {
            return None;
        };
        let head = match *in_head {
            true => Some(head_of(access, *stride)?),
            false => None,
        };
        self.number(value);
        let number = self.keep(Elementary::Dint);
        Some(Character { number, length: u64::try_from(*length).ok()?, head })
    }

    fn jump_if_outside(&mut self, character: &Character, outside: &str) {
        let limits = [(1, StlInsn::CompareLtD), (character.length, StlInsn::CompareGtD)];
        for (limit, beyond) in limits {
            let limit = self.constant(Elementary::Dint, limit);
            self.push(StlInsn::Load, Some(character.number.clone()));
            self.push(StlInsn::Load, Some(limit));
            self.push(beyond, None);
            self.jump(StlInsn::JumpIf, outside);
        }
        if let Some(head) = &character.head
            && let Some(ty) = head.elementary()
            && let Some(target) = self.stored_address(head)
        {
            let maximum = self.reach(&target, ty);
            self.push(StlInsn::Load, Some(maximum));
            self.push(StlInsn::Load, Some(character.number.clone()));
            self.push(StlInsn::CompareLtD, None);
            self.jump(StlInsn::JumpIf, outside);
        }
    }
}

/// The maximum of a text, which is two numbers of the size of a character before the first one.
fn head_of(access: &Access, stride: u32) -> Option<Access> {
    let Base::Place(place) = &access.base else { return None };
    let mut place: Place = place.clone();
    let (byte, _) = place.position_mut()?;
    *byte = byte.checked_sub(stride / 4)?;
    let ty = if stride == 8 { Elementary::Byte } else { Elementary::Word };
    Some(Access {
        base: Base::Place(place),
        indices: Vec::new(),
        ty: DataType::Elementary(ty),
        part: None,
        span: access.span,
    })
}
