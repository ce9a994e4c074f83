//! Addresses and numbers of cells within the limits of the CPU, and the text of the sources for messages about them.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{Area, CellKind, Width};
use rustc_hash::FxHashSet;

use crate::bind::globals::Globals;
use crate::bind::trees::SYSTEM_FILE;

/// What is only reported once.
#[derive(Default)]
pub struct Told {
    /// Addresses beyond the CPU's limits.
    pub addresses: FxHashSet<(Area, u32)>,
    pub cells: FxHashSet<(CellKind, u32)>,
    /// Tags of the system memory that nothing sets, folded.
    pub system_tags: FxHashSet<String>,
    /// Constants of blocks whose type or value was reported, folded.
    pub constants: FxHashSet<String>,
}

impl Globals<'_> {
    /// Text of the source at `span`, on one line.
    pub fn text(&self, span: Span) -> String {
        if span.file == SYSTEM_FILE {
            return String::new();
        }
        let overlay =
            self.input.units.iter().find(|(file, _)| *file == span.file).and_then(|(_, unit)| unit.overlay.as_ref());
        let file = self.input.sources.files().nth(span.file.0 as usize).map(|(_, file)| &file.text);
        let text = overlay.or(file).and_then(|text| text.get(span.range())).unwrap_or("");
        let mut words = text.split_whitespace();
        let mut line = words.next().unwrap_or("").to_string();
        for word in words {
            line.push(' ');
            line.push_str(word);
        }
        line
    }

    /// Checks an address against its area and the CPU; `None` if it cannot exist, which is reported.
    pub fn check_area(&mut self, area: Area, width: Width, byte: u32, span: Span) -> Option<()> {
        use plcc_abi::layout::{AREA_BYTES, L_CLASS_BYTES};
        let profile = &self.input.profile;
        let end = u64::from(byte) + u64::from(width.bytes());
        let (name, limit, space) = match area {
            Area::I => ("inputs", profile.inputs, AREA_BYTES),
            Area::Q => ("outputs", profile.outputs, AREA_BYTES),
            Area::M => ("bit memory", profile.bit_memory, AREA_BYTES),
            Area::L => ("local data", profile.local_data, L_CLASS_BYTES),
            Area::Pi => ("peripheral inputs", AREA_BYTES, AREA_BYTES),
            Area::Pq => ("peripheral outputs", AREA_BYTES, AREA_BYTES),
            Area::Db | Area::Di => ("a data block", AREA_BYTES, AREA_BYTES),
        };
        self.check_limit(end, limit, space, (name, "bytes"), (area, byte), span)
    }

    fn check_limit(
        &mut self,
        end: u64,
        limit: u32,
        space: u32,
        (name, unit): (&str, &str),
        told: (Area, u32),
        span: Span,
    ) -> Option<()> {
        if end <= u64::from(limit.min(space)) {
            return Some(());
        }
        let profile = &self.input.profile;
        let hard = end > u64::from(space) || profile.limits_checked;
        if !hard && !self.told.addresses.insert(told) {
            return Some(());
        }
        let limit = limit.min(space);
        let code = if hard { Code::AddressRange } else { Code::CpuLimit };
        let message = Diagnostic::new(code, span, format!("this address is beyond the end of {name}")).label(format!(
            "the profile {} has {limit} {unit} of {name}: 0 to {}",
            profile.name,
            limit.saturating_sub(1)
        ));
        let message = if end <= u64::from(space) { message.help("name a larger CPU with --cpu") } else { message };
        self.report.push(message);
        if hard { None } else { Some(()) }
    }

    /// Checks the number of a timer or counter; `None` if it cannot exist, which is reported.
    pub fn check_cell(&mut self, kind: CellKind, number: u32, span: Span) -> Option<u16> {
        use plcc_abi::layout::TIMERS_MAX;
        let profile = &self.input.profile;
        let (name, limit) = match kind {
            CellKind::Timer => ("timers", profile.timers),
            CellKind::Counter => ("counters", profile.counters),
        };
        if number < limit.min(TIMERS_MAX) {
            return Some(number as u16);
        }
        let hard = number >= TIMERS_MAX || profile.limits_checked;
        if hard || self.told.cells.insert((kind, number)) {
            let code = if hard { Code::AddressRange } else { Code::CpuLimit };
            let (title, label) = match limit {
                0 => (format!("the CPU has no {name}"), format!("the profile {} has IEC {name} only", profile.name)),
                _ => (
                    format!("the CPU has fewer {name}"),
                    format!("the profile {} has {limit} {name}: 0 to {}", profile.name, limit - 1),
                ),
            };
            let message = Diagnostic::new(code, span, title).label(label);
            let message = if number < TIMERS_MAX { message.help("name a larger CPU with --cpu") } else { message };
            self.report.push(message);
        }
        if hard { None } else { Some(number as u16) }
    }
}
