//! System constants of an S7-1200/1500: hardware identifiers, events of hardware interrupts, numbers of organization blocks.
//!
//! Source: LAD/FBD reference for S7-1200, data types HW_*, EVENT_* and OB_*.

use plcc_abi::technology::{EVENT_ID, HSC_ID, PULSE_ID};
use plcc_syntax::ast::BlockPrefix;

use super::Binder;
use super::constant::Constant;
use super::names::fold;
use crate::profile;
use crate::symbols::SymbolTarget;
use crate::types::Elementary;

impl Binder<'_> {
    /// The system constant `name`: `Local~HSC_1`, `Local~Pulse_1`, an event of plc.toml, `OB_Main`.
    pub fn system_constant(&self, name: &str) -> Option<Constant> {
        if !self.input.profile.family.is_portal() {
            return None;
        }
        let name = fold(name);
        let word = |bits: u16| Some(Constant::Typed { ty: Elementary::Word, bits: u64::from(bits) });
        let board = profile::on_board(&self.input.profile);
        let numbered = |prefix: &str, count: u8| {
            let number: u8 = name.strip_prefix(prefix)?.parse().ok()?;
            (1..=count).contains(&number).then_some(u16::from(number))
        };
        if let Some(number) = board.and_then(|board| numbered("local~hsc_", board.fast_counters)) {
            return word(HSC_ID + number);
        }
        if let Some(number) = board.and_then(|board| numbered("local~pulse_", board.pulse_generators)) {
            return word(PULSE_ID + number);
        }
        if let Some(index) = self.input.config.hardware_events.iter().position(|event| fold(&event.name) == name) {
            let bits = u64::from(EVENT_ID) + index as u64 + 1;
            return Some(Constant::Typed { ty: Elementary::Dword, bits });
        }
        match self.globals.get(name.strip_prefix("ob_")?)?.target {
            SymbolTarget::Block { prefix: BlockPrefix::Ob, number } => {
                Some(Constant::Typed { ty: Elementary::Int, bits: u64::from(number) })
            }
            SymbolTarget::Block { .. } | SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. } => None,
        }
    }
}
