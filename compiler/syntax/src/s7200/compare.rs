//! The compare contacts of the S7-200: one for each contact, type of operand and relation.

use super::instructions::OperandClass;
use crate::stl::Mnemonics;

/// A compare contact: `LDW>=`, `AB=`, `OR<`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Compare {
    pub contact: Contact,
    pub kind: CompareKind,
    pub relation: Relation,
}

/// What happens to the result of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Contact {
    /// It is pushed.
    Load,
    And,
    Or,
}

/// How operands are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CompareKind {
    /// Unsigned, 8 bits.
    Byte,
    /// Signed, 16 bits.
    Word,
    /// Signed, 32 bits.
    Dword,
    Real,
    /// Strings, for equality only.
    Text,
}

impl CompareKind {
    pub const ALL: [CompareKind; 5] =
        [CompareKind::Byte, CompareKind::Word, CompareKind::Dword, CompareKind::Real, CompareKind::Text];

    /// Its letter in the mnemonic.
    pub const fn letter(self) -> char {
        match self {
            CompareKind::Byte => 'B',
            CompareKind::Word => 'W',
            CompareKind::Dword => 'D',
            CompareKind::Real => 'R',
            CompareKind::Text => 'S',
        }
    }

    pub(super) const fn operands(self) -> &'static [OperandClass] {
        use OperandClass::*;
        match self {
            CompareKind::Byte => &[ByteIn, ByteIn],
            CompareKind::Word => &[IntIn, IntIn],
            CompareKind::Dword => &[DintIn, DintIn],
            CompareKind::Real => &[RealIn, RealIn],
            CompareKind::Text => &[StringIn, StringIn],
        }
    }
}

/// A relation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Relation {
    Eq,
    Ne,
    Ge,
    Le,
    Gt,
    Lt,
}

impl Relation {
    pub const ALL: [Relation; 6] = [Relation::Eq, Relation::Ne, Relation::Ge, Relation::Le, Relation::Gt, Relation::Lt];

    pub const fn sign(self) -> &'static str {
        match self {
            Relation::Eq => "=",
            Relation::Ne => "<>",
            Relation::Ge => ">=",
            Relation::Le => "<=",
            Relation::Gt => ">",
            Relation::Lt => "<",
        }
    }
}

impl Compare {
    /// All that exist.
    pub fn all() -> impl Iterator<Item = Compare> {
        [Contact::Load, Contact::And, Contact::Or].into_iter().flat_map(|contact| {
            CompareKind::ALL.into_iter().flat_map(move |kind| {
                let equality = kind == CompareKind::Text;
                Relation::ALL
                    .into_iter()
                    .filter(move |relation| !equality || matches!(relation, Relation::Eq | Relation::Ne))
                    .map(move |relation| Compare { contact, kind, relation })
            })
        })
    }

    /// As written, in capital letters.
    pub fn mnemonic(self, set: Mnemonics) -> String {
        let contact = match (self.contact, set) {
            (Contact::Load, _) => "LD",
            (Contact::And, Mnemonics::En) => "A",
            (Contact::And, Mnemonics::De) => "U",
            (Contact::Or, _) => "O",
        };
        format!("{contact}{}{}", self.kind.letter(), self.relation.sign())
    }
}
