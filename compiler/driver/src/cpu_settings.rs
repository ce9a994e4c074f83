//! Settings of plc.toml that not every CPU has: organization blocks, their priorities, what becomes of a cycle that is too long, how much is
//! retentive, protection, axes.

use plcc_abi::image::{BlockKind, Family, Profile};
use plcc_abi::ob::{OB_FREE, ObClass};
use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_model::Program;

/// A setting that was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CpuSetting {
    /// `[ob.N]`
    Ob(u16),
    /// `ob` of a hardware interrupt.
    EventOb(u16),
    /// `priority` of OB N, and its class if plc.toml or the number says which.
    Priority(u16, Option<ObClass>),
    /// `cycle_time_exceeded`
    Exceeded,
    /// `startup = "cold"`
    Cold,
    /// `protection = "complete"`
    Complete,
    /// `[axis.NAME]`
    Axes,
    /// `hardware_id` of a module.
    HardwareId,
    /// Byte of the clock memory or the system memory.
    MemoryByte(u16),
    /// A number below `[retain]`.
    Retentive(Retained, u32),
}

/// What `[retain]` gives a number of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Retained {
    BitMemory,
    Timers,
    Counters,
}

/// Reports settings that the CPU does not have.
pub fn check(settings: &[(CpuSetting, Span)], profile: &Profile) -> Vec<Diagnostic> {
    let report = |(setting, span): &(CpuSetting, Span)| {
        let (title, help) = wrong(*setting, profile)?;
        let mut message = Diagnostic::new(Code::Project, *span, title).help(help);
        // Firmware versions differ.
        if matches!(setting, CpuSetting::MemoryByte(_)) && !profile.limits_checked {
            message.severity = Severity::Warning;
        }
        Some(message)
    };
    settings.iter().filter_map(report).collect()
}

/// Warns of settings of organization blocks that the program does not have.
pub fn without_block(settings: &[(CpuSetting, Span)], program: &Program) -> Vec<Diagnostic> {
    let obs = || program.blocks.iter().filter(|block| block.kind == BlockKind::Ob).map(|block| block.number);
    let report = |(setting, span): &(CpuSetting, Span)| {
        let (ob, is_event) = match *setting {
            CpuSetting::Ob(ob) => (ob, false),
            // Its own heading says it.
            CpuSetting::EventOb(ob) if settings.iter().any(|(other, _)| *other == CpuSetting::Ob(ob)) => return None,
            CpuSetting::EventOb(ob) => (ob, true),
            CpuSetting::Priority(..)
            | CpuSetting::Exceeded
            | CpuSetting::Cold
            | CpuSetting::Complete
            | CpuSetting::Axes
            | CpuSetting::HardwareId
            | CpuSetting::MemoryByte(_)
            | CpuSetting::Retentive(..) => return None,
        };
        if obs().any(|number| number == ob) {
            return None;
        }
        let alike = |other: &u16| ObClass::of_number(*other).is_some_and(|class| ObClass::of_number(ob) == Some(class));
        let set = |other: &u16| settings.iter().any(|(setting, _)| *setting == CpuSetting::Ob(*other));
        let other = obs().find(|other| alike(other) && (is_event || !set(other)));
        let (label, help) = match (is_event, other) {
            (false, Some(other)) => {
                ("these settings have no effect", format!("is `[ob.{other}]` meant? The program has OB {other}"))
            }
            (false, None) => (
                "these settings have no effect",
                format!("add OB {ob} to the program, or remove this heading and its keys"),
            ),
            (true, Some(other)) => {
                ("this event starts no block", format!("is `ob = {other}` meant? The program has OB {other}"))
            }
            (true, None) => (
                "this event starts no block",
                format!("add OB {ob} to the program, or remove this key: ATTACH gives the event an OB at run time"),
            ),
        };
        let message = Diagnostic::new(Code::Project, *span, format!("the program has no OB {ob}"));
        let mut message = message.label(label).help(help);
        message.severity = Severity::Warning;
        Some(message)
    };
    settings.iter().filter_map(report).collect()
}

/// What is wrong with the setting, and what to do. One about an OB that the CPU does not have says all of that OB.
fn wrong(setting: CpuSetting, profile: &Profile) -> Option<(String, &'static str)> {
    let (cpu, family) = (&profile.name, profile.family);
    // OB 65 is of technology CPUs, OB 73 of an S7-400H.
    let is_number = |ob: u16| ObClass::of_number(ob).is_some() || matches!(ob, 65 | 73);
    let exists = |ob: u16| match ob >= OB_FREE {
        true => family.is_portal(),
        false => is_number(ob) && family != Family::S7200,
    };
    match setting {
        CpuSetting::Ob(ob) if exists(ob) => None,
        // There is no such block, and a warning says so.
        CpuSetting::EventOb(_) => None,
        CpuSetting::Ob(_) if family == Family::S7200 => Some((
            format!("the CPU {cpu} has no organization blocks"),
            "remove this heading and its keys: ATCH of the program connects interrupt routines with events",
        )),
        CpuSetting::Ob(ob) => Some((
            format!("the CPU {cpu} has no OB {ob}"),
            match ob >= OB_FREE {
                true => "OBs from 123 on belong to CPUs of the S7-1200 and S7-1500; OB 30 to OB 38 are cyclic",
                false => {
                    "OB 10 to OB 17 start at a time of day, OB 30 to OB 38 are cyclic, OB 40 to OB 47 are of hardware"
                }
            },
        )),
        CpuSetting::Priority(ob, _) if !exists(ob) => None,
        CpuSetting::Priority(..) if family == Family::S7300 => Some((
            format!("the priorities of the CPU {cpu} are fixed"),
            "remove `priority`: CPUs of the S7-400, S7-1200 and S7-1500 have it",
        )),
        CpuSetting::Priority(ob, Some(ObClass::ProgramCycle | ObClass::Startup)) if family.is_portal() => Some((
            format!("the priority of OB {ob} is fixed"),
            "remove `priority`: blocks of the cycle and of the startup have the lowest one",
        )),
        CpuSetting::Priority(..) => None,
        CpuSetting::Exceeded if family.is_portal() => None,
        CpuSetting::Exceeded => Some((
            format!("the CPU {cpu} has no setting `cycle_time_exceeded`"),
            match family {
                Family::S7200 => "remove it: `watchdog` below `[s7200]` is the longest time of a scan",
                _ => "remove it: a cycle that is too long calls OB 80, and without this block the CPU stops",
            },
        )),
        CpuSetting::Cold if !family.has_cold_restart() => Some((
            format!("the CPU {cpu} has no cold restart"),
            "write `startup = \"warm\"`; `--restart reset` gives retentive data their start values once",
        )),
        CpuSetting::Cold => None,
        // Source: CPU manuals, protection levels: three of an S7-300/400, four of an S7-1200/1500.
        CpuSetting::Complete if family.is_portal() => None,
        CpuSetting::Complete => Some((
            format!("the CPU {cpu} has no complete protection"),
            "write `protection = \"read-write\"`, its highest level; `access` says what clients may do",
        )),
        CpuSetting::Axes if family.is_portal() => None,
        CpuSetting::Axes => Some((
            format!("the CPU {cpu} has no axes"),
            "remove this heading and its keys: technology objects belong to CPUs of the S7-1200 and S7-1500",
        )),
        CpuSetting::HardwareId if family.is_portal() => None,
        CpuSetting::HardwareId => Some((
            format!("the modules of the CPU {cpu} have no hardware identifiers"),
            "remove this key: the program names a module by its first address",
        )),
        CpuSetting::MemoryByte(byte) => {
            let bytes = profile.bit_memory;
            (u32::from(byte) >= bytes && family != Family::S7200).then(|| {
                let title = format!("the CPU {cpu} has no MB {byte}: its bit memory has {bytes} bytes");
                (title, "write the number of a byte that it has, counted from 0")
            })
        }
        // The keys have no effect there.
        CpuSetting::Retentive(..) if family == Family::S7200 => None,
        CpuSetting::Retentive(retained, count) => {
            let (has, what) = match retained {
                Retained::BitMemory => (profile.bit_memory, "bytes of bit memory"),
                Retained::Timers => (profile.timers, "S5 timers"),
                Retained::Counters => (profile.counters, "S5 counters"),
            };
            let wrong = match has {
                0 => (format!("the CPU {cpu} has no {what}"), "remove this key"),
                has => (format!("the CPU {cpu} has {has} {what}"), "write a number that is not larger"),
            };
            (count > has && profile.limits_checked).then_some(wrong)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plcc_diag::FileId;
    use plcc_model::profile;

    #[test]
    fn each_cpu_has_its_settings() {
        let wrong = |cpu: &str, setting: CpuSetting| {
            let profile = profile::lookup(cpu).expect("the CPU is known");
            !check(&[(setting, Span::new(FileId(0), 0..0))], &profile).is_empty()
        };
        let priority = |ob| CpuSetting::Priority(ob, ObClass::of_number(ob));
        let cases = [
            (CpuSetting::Ob(35), [false, false, false, true]),
            (CpuSetting::Ob(77), [true, true, true, true]),
            (CpuSetting::Ob(123), [true, true, false, true]),
            (priority(1), [true, false, true, false]),
            (priority(35), [true, false, false, false]),
            (priority(123), [false, false, false, false]),
            (CpuSetting::Exceeded, [true, true, false, true]),
            (CpuSetting::Cold, [false, false, true, true]),
            (CpuSetting::Complete, [true, true, false, true]),
            (CpuSetting::Axes, [true, true, false, true]),
            (CpuSetting::HardwareId, [true, true, false, true]),
            (CpuSetting::Retentive(Retained::Timers, 4000), [true, true, true, false]),
            (CpuSetting::Retentive(Retained::Counters, 8), [false, false, true, false]),
            (CpuSetting::Retentive(Retained::BitMemory, 16), [false, false, false, false]),
            (CpuSetting::MemoryByte(255), [false, false, false, false]),
        ];
        for (setting, expected) in cases {
            let found = ["s7-300", "s7-400", "s7-1200", "s7-200"].map(|cpu| wrong(cpu, setting));
            assert_eq!(found, expected, "{setting:?}");
        }
        assert!(wrong("1214C", CpuSetting::MemoryByte(8192)) && !wrong("1214C", CpuSetting::MemoryByte(8191)));
    }
}
