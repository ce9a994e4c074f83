//! Clock memory and system memory without configuration, found by the names that the TIA Portal gives to their tags.
//!
//! An export has no properties of the CPU; its tag table has these tags once the bytes are enabled. The byte is the one that
//! contains them, each at its own bit. Keys of plc.toml have priority.
//! Source: LAD/FBD reference for S7-1200, memory areas and scan; STL reference, clock memory. Names: the tool's default tag table, the same in every language.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{Area, Width};

use crate::bind::globals::Globals;
use plcc_binding::fold;
use plcc_syntax::symbols::{Symbol, SymbolTarget};

/// One of the two bytes.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Memory {
    Clock,
    System,
}

/// Tags: the name without blanks, the byte it belongs to, its bit; the byte itself has none.
#[rustfmt::skip]
const TAGS: &[(&str, Memory, Option<u8>)] = &[
    ("clock_byte", Memory::Clock, None),
    ("clock_10hz", Memory::Clock, Some(0)), ("clock_5hz", Memory::Clock, Some(1)), ("clock_2.5hz", Memory::Clock, Some(2)),
    ("clock_2hz", Memory::Clock, Some(3)), ("clock_1.25hz", Memory::Clock, Some(4)), ("clock_1hz", Memory::Clock, Some(5)),
    ("clock_0.625hz", Memory::Clock, Some(6)), ("clock_0.5hz", Memory::Clock, Some(7)),
    ("system_byte", Memory::System, None),
    ("firstscan", Memory::System, Some(0)), ("diagstatusupdate", Memory::System, Some(1)),
    ("alwaystrue", Memory::System, Some(2)), ("alwaysfalse", Memory::System, Some(3)),
];

/// What a name means: one of the tags, also with the number that the tool appends if the name is taken (`AlwaysTRUE(1)`, `FirstScan_1`).
fn meaning(name: &str) -> Option<(Memory, Option<u8>)> {
    let folded = fold(name).replace(',', ".");
    let of = |name: &str| TAGS.iter().find(|(known, ..)| *known == name).map(|(_, memory, bit)| (*memory, *bit));
    let stem =
        folded.trim_end_matches(')').trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches(['_', '(', ' ']);
    of(&folded).or_else(|| of(stem))
}

/// The memory byte of a tag, if it is at the bit that it should have.
fn byte_of(target: SymbolTarget, bit: Option<u8>) -> Option<u16> {
    match (target, bit) {
        (SymbolTarget::Memory { area: Area::M, width: Width::Byte, byte, .. }, None) => u16::try_from(byte).ok(),
        (SymbolTarget::Memory { area: Area::M, width: Width::Bit, byte, bit }, Some(wanted)) if bit == wanted => {
            u16::try_from(byte).ok()
        }
        _ => None,
    }
}

impl Globals<'_> {
    /// Settles the bytes that the configuration leaves open, and reports it.
    pub fn system_memory(&mut self) {
        for memory in [Memory::Clock, Memory::System] {
            let configured = match memory {
                Memory::Clock => self.config.clock_memory_byte,
                Memory::System => self.config.system_memory_byte,
            };
            // S7-300/400 have no system memory.
            if configured.is_some() || memory == Memory::System && !self.sources.tia {
                continue;
            }
            let symbols = self.input.tables.iter().flat_map(|table| &table.symbols);
            let mut bytes: Vec<(u16, &Symbol)> = Vec::new();
            for symbol in symbols {
                if let Some((of, bit)) = meaning(&symbol.name)
                    && of == memory
                    && let Some(byte) = byte_of(symbol.target, bit)
                {
                    bytes.push((byte, symbol));
                }
            }
            let Some(&(byte, first)) = bytes.first() else { continue };
            let other = [self.config.clock_memory_byte, self.config.system_memory_byte];
            if bytes.iter().any(|(other, _)| *other != byte) || other.contains(&Some(byte)) {
                continue;
            }
            let (what, key) = match memory {
                Memory::Clock => ("clock memory", "clock_memory"),
                Memory::System => ("system memory", "system_memory_byte"),
            };
            let message = Diagnostic::new(
                Code::MemoryByName,
                first.span,
                format!("MB {byte} is used as the {what}, because of the tag `{}`", first.name.trim()),
            )
            .label("the TIA Portal creates this tag for it")
            .help(format!("`{key} = {byte}` in plc.toml means the same; another number there has priority"));
            self.report.push(message);
            match memory {
                Memory::Clock => self.config.clock_memory_byte = Some(byte),
                Memory::System => self.config.system_memory_byte = Some(byte),
            }
        }
    }

    /// Reports the use of a tag that the system should set, going by its name, but does not, going by its address.
    pub fn check_system_tag(&mut self, name: &str, target: SymbolTarget, span: Span) {
        let Some((memory, bit)) = meaning(name) else { return };
        let (configured, what, key) = match memory {
            Memory::Clock => (self.config.clock_memory_byte, "clock memory", "clock_memory"),
            Memory::System => (self.config.system_memory_byte, "system memory", "system_memory_byte"),
        };
        let own = byte_of(target, bit);
        // Blocks may have these names, and a CPU without system memory may use them for its own.
        let is_memory = matches!(target, SymbolTarget::Memory { .. });
        if !is_memory
            || configured.is_some() && own == configured
            || memory == Memory::System && !self.sources.tia
            || !self.told.system_tags.insert(fold(name))
        {
            return;
        }
        let label = match (configured, own) {
            (Some(byte), _) => format!("the {what} is MB {byte}"),
            (None, Some(_)) => format!("the tags of the {what} are in several bytes"),
            (None, None) => format!("not an address for a tag of the {what}"),
        };
        let help = match own {
            Some(byte) => format!("write `{key} = {byte}` in plc.toml, if the CPU has its {what} there"),
            None => "the program must set it itself; otherwise correct its address in the tag table".to_string(),
        };
        let title = format!("the CPU does not set `{}`, which is a tag of the {what}", name.trim());
        self.report.push(Diagnostic::new(Code::MemoryTag, span, title).label(label).help(help));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_the_tool_are_known() {
        assert!(meaning("Clock_0.625Hz").is_some_and(|found| found == (Memory::Clock, Some(6))));
        assert!(meaning("clock_2,5hz").is_some_and(|found| found.1 == Some(2)));
        assert!(meaning("AlwaysTRUE_1").is_some_and(|found| found == (Memory::System, Some(2))));
        assert!(meaning("FirstScan(2)").is_some_and(|found| found.1 == Some(0)));
        assert!(meaning("Clock_3Hz").is_none() && meaning("Always").is_none());
    }
}
