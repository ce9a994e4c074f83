//! Direct addresses: their text, their range on the CPU, and their pointers.

use plcc_abi::image::Profile;
use plcc_abi::s7200::image::CpuRow;
use plcc_abi::s7200::{ACCUMULATORS, HIGH_SPEED_COUNTERS, pointer};
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::Width;
use plcc_syntax::s7200::ast::{Area, Direct};

use super::Binder;
use plcc_model::profile;

/// An address as written.
pub fn text(direct: Direct) -> String {
    let Direct { area, width, number, bit } = direct;
    let letters = area.letters();
    match (area, width) {
        (Area::T | Area::C | Area::Hc, _) => format!("{letters}{number}"),
        (_, None) => format!("{letters}{number}"),
        (_, Some(Width::Bit)) => format!("{letters}{number}.{bit}"),
        (_, Some(width)) => format!("{letters}{}{number}", letter(width)),
    }
}

/// Letter of a width in an address.
pub fn letter(width: Width) -> &'static str {
    match width {
        Width::Bit => "",
        Width::Byte => "B",
        Width::Word => "W",
        Width::Dword | Width::Lword => "D",
    }
}

/// Size of an area on a CPU: in bytes, or the number of timers, counters and so on.
pub fn size(area: Area, profile: &Profile, row: &CpuRow) -> u32 {
    match area {
        Area::I => profile.inputs,
        Area::Q => profile.outputs,
        Area::V => row.v_bytes,
        Area::M => profile.bit_memory,
        Area::Sm => row.sm_bytes,
        Area::S => row.s_bytes,
        Area::L => profile.local_data,
        Area::T => profile.timers,
        Area::C => profile.counters,
        Area::Hc => HIGH_SPEED_COUNTERS,
        Area::Ac => ACCUMULATORS,
        Area::Ai | Area::Aq => row.analog_bytes,
    }
}

/// Whether the CPU has the address up to `count` elements after its first one.
fn exists(direct: Direct, width: Width, count: u32, profile: &Profile, row: &CpuRow) -> bool {
    let size = u64::from(size(direct.area, profile, row));
    let (number, count) = (u64::from(direct.number), u64::from(count));
    match direct.area {
        Area::Hc => number < size && row.high_speed_counters >> direct.number.min(7) & 1 != 0,
        Area::T | Area::C | Area::Ac => number + count <= size,
        _ if width == Width::Bit => number * 8 + u64::from(direct.bit) + count <= size * 8,
        _ => number + count * u64::from(width.bytes()) <= size,
    }
}

/// The pointer to an operand; `None`: a pointer to the area is not possible.
pub fn pointer_to(direct: Direct) -> Option<u32> {
    let (tag, offset) = match direct.area {
        Area::I => (pointer::I, direct.number),
        Area::Q => (pointer::Q, direct.number),
        Area::M => (pointer::M, direct.number),
        Area::Sm => (pointer::SM, direct.number),
        Area::Ai => (pointer::AI, direct.number),
        Area::Aq => (pointer::AQ, direct.number),
        Area::V => (pointer::V, direct.number),
        Area::S => (pointer::S, direct.number),
        Area::T => (pointer::T, direct.number.wrapping_mul(2)),
        Area::C => (pointer::C, direct.number.wrapping_mul(2)),
        Area::L | Area::Hc | Area::Ac => return None,
    };
    if direct.width == Some(Width::Bit) {
        return None;
    }
    Some(u32::from(tag) << 24 | offset & 0x00FF_FFFF)
}

impl Binder<'_> {
    /// Checks that the CPU has `count` elements beginning with an address; `None` if not, which is reported.
    pub fn check_range(&mut self, direct: Direct, width: Width, count: u32, span: Span) -> Option<()> {
        if direct.bit > 7 {
            let title = format!("`{}` has no bit {} (0091)", text(direct), direct.bit);
            self.push(Diagnostic::new(Code::AddressRange, span, title).label("the bits of a byte are 0 to 7"));
            return None;
        }
        if matches!(direct.area, Area::Ai | Area::Aq) && !direct.number.is_multiple_of(2) {
            let letters = direct.area.letters();
            self.push(
                Diagnostic::new(Code::AddressRange, span, format!("{letters}W{} does not exist (0091)", direct.number))
                    .label("analog channels have even addresses")
                    .help(format!("write {letters}W{} or the next even one", direct.number & !1)),
            );
            return None;
        }
        let profile = &self.input.profile;
        if exists(direct, width, count, profile, &self.row) {
            return Some(());
        }
        let name = match count {
            1 => text(direct),
            _ => format!("{count} elements from {}", text(direct)),
        };
        let size = size(direct.area, profile, &self.row);
        let letters = direct.area.letters();
        let label = match (size, direct.area) {
            (0, _) => format!("the CPU {} has no {letters}", profile.name),
            (_, Area::Hc) => {
                let has = (0..HIGH_SPEED_COUNTERS).filter(|number| self.row.high_speed_counters >> number & 1 != 0);
                let has: Vec<String> = has.map(|number| format!("HC{number}")).collect();
                format!("the CPU {} has {}", profile.name, has.join(", "))
            }
            (_, Area::T | Area::C | Area::Ac) => {
                format!("the CPU {} has {letters}0 to {letters}{}", profile.name, size - 1)
            }
            (_, Area::Ai | Area::Aq) => {
                format!("the CPU {} has {letters}W0 to {letters}W{}", profile.name, size.saturating_sub(2))
            }
            _ => format!("the CPU {} has {letters}B0 to {letters}B{}", profile.name, size - 1),
        };
        let others: Vec<String> = profile::s7200::all()
            .filter(|(profile, row)| exists(direct, width, count, profile, row))
            .map(|(profile, _)| profile.name)
            .collect();
        let help = match others.as_slice() {
            [] => "no CPU of the S7-200 has it".to_string(),
            _ => format!("CPUs that have it: {}", others.join(", ")),
        };
        let title = match count {
            1 => format!("{name} is outside the memory of the CPU (0091)"),
            _ => format!("{name} extend beyond the memory of the CPU (0091)"),
        };
        self.push(Diagnostic::new(Code::AddressRange, span, title).label(label).help(help));
        None
    }
}
