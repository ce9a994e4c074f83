//! CPUs of the S7-200 and their resources.
//!
//! Source: S7-200 system manual, memory ranges and features; for the 21x generation, the first edition of its manual.

use plcc_abi::image::{Family, Profile};
use plcc_abi::s7200::LOCAL_BYTES;
use plcc_abi::s7200::image::CpuRow;

/// One CPU.
pub(super) struct Cpu {
    pub(super) name: &'static str,
    /// Bytes of inputs; the same number of outputs.
    image: u32,
    bit_memory: u32,
    /// Timers; the same number of counters.
    timers: u32,
    row: CpuRow,
}

/// Events `ranges`, one bit each.
const fn events(ranges: &[(u32, u32)]) -> u64 {
    let mut bits = 0;
    let mut index = 0;
    while index < ranges.len() {
        let (first, last) = ranges[index];
        let mut event = first;
        while event <= last {
            bits |= 1 << event;
            event += 1;
        }
        index += 1;
    }
    bits
}

/// The largest CPU, which is used if none is named.
const ROW_226: CpuRow = CpuRow {
    old: false,
    v_bytes: 10240,
    sm_bytes: 550,
    s_bytes: 32,
    analog_bytes: 64,
    high_speed_counters: 0b11_1111,
    ports: 2,
    pulse_outputs: 2,
    pid_loops: 8,
    subroutines: 128,
    interrupts: 128,
    labels: 256,
    events: events(&[(0, 33)]),
    queues: [8, 16, 8],
    watchdog_ms: 500,
    id: 0b1001,
    inputs: 24,
    outputs: 16,
};

const ROW_224: CpuRow = CpuRow {
    v_bytes: 8192,
    ports: 1,
    subroutines: 64,
    events: events(&[(0, 23), (27, 33)]),
    queues: [4, 16, 8],
    id: 0b0010,
    inputs: 14,
    outputs: 10,
    ..ROW_226
};

const ROW_222: CpuRow = CpuRow {
    v_bytes: 2048,
    sm_bytes: 300,
    analog_bytes: 32,
    high_speed_counters: 0b11_1001,
    events: events(&[(0, 12), (19, 23), (27, 33)]),
    id: 0b0000,
    inputs: 8,
    outputs: 6,
    ..ROW_224
};

const ROW_216: CpuRow = CpuRow {
    old: true,
    v_bytes: 5120,
    sm_bytes: 195,
    high_speed_counters: 0b111,
    subroutines: 64,
    events: events(&[(0, 26)]),
    watchdog_ms: 300,
    ..ROW_226
};

const ROW_214: CpuRow = CpuRow {
    v_bytes: 2048,
    sm_bytes: 86,
    s_bytes: 16,
    analog_bytes: 32,
    ports: 1,
    pid_loops: 0,
    events: events(&[(0, 20)]),
    queues: [4, 16, 4],
    id: 0b0010,
    inputs: 14,
    outputs: 10,
    ..ROW_216
};

#[rustfmt::skip]
const CPUS: &[Cpu] = &[
    Cpu { name: "212", image: 8, bit_memory: 16, timers: 64, row: CpuRow {
        v_bytes: 512, sm_bytes: 46, s_bytes: 8, high_speed_counters: 1, pulse_outputs: 0, subroutines: 16, interrupts: 32, labels: 64,
        events: events(&[(0, 1), (8, 10), (12, 12)]), queues: [4, 4, 2], id: 0b0000, inputs: 8, outputs: 6, ..ROW_214 } },
    Cpu { name: "214", image: 8, bit_memory: 32, timers: 128, row: ROW_214 },
    Cpu { name: "215", image: 8, bit_memory: 32, timers: 256, row: CpuRow {
        ports: 1, events: events(&[(0, 23)]), queues: [4, 16, 8], id: 0b1000, inputs: 14, outputs: 10, ..ROW_216 } },
    Cpu { name: "216", image: 8, bit_memory: 32, timers: 256, row: ROW_216 },
    Cpu { name: "221", image: 16, bit_memory: 32, timers: 256, row: CpuRow {
        sm_bytes: 180, id: 0b0110, inputs: 6, outputs: 4, ..ROW_222 } },
    Cpu { name: "222", image: 16, bit_memory: 32, timers: 256, row: ROW_222 },
    Cpu { name: "224", image: 16, bit_memory: 32, timers: 256, row: ROW_224 },
    Cpu { name: "224XP", image: 16, bit_memory: 32, timers: 256, row: CpuRow {
        v_bytes: 10240, ports: 2, events: events(&[(0, 33)]), queues: [8, 16, 8], ..ROW_224 } },
    Cpu { name: "226", image: 16, bit_memory: 32, timers: 256, row: ROW_226 },
];

/// Short forms and variants that mean a row of the table.
pub(super) const ALIASES: &[(&str, &str)] = &[("224XPSI", "224XP"), ("226XM", "226")];

/// How the order numbers of a CPU begin after `6ES7`.
pub(super) fn orders(name: &str) -> &'static [&'static str] {
    match name {
        "212" => &["212-1AA", "212-1BA", "212-1CA", "212-1FA"],
        "214" => &["214-1AC", "214-1BC", "214-1CC", "214-1DC"],
        "215" => &["215-2AD", "215-2BD"],
        "216" => &["216-2AD00", "216-2BD00"],
        "221" => &["211-0AA", "211-0BA"],
        "222" => &["212-1AB", "212-1BB"],
        "224" => &["214-1AD", "214-1BD"],
        "224XP" => &["214-2AD", "214-2BD", "214-2AS"],
        "226" => &["216-2AD", "216-2BD", "216-2AF", "216-2BF"],
        _ => &[],
    }
}

/// The table.
pub(super) fn cpus() -> &'static [Cpu] {
    CPUS
}

/// The profile of a CPU. Its limits are those of the manual: exceeding them is an error.
pub(super) fn profile(cpu: &Cpu) -> Profile {
    Profile {
        name: cpu.name.to_string(),
        family: Family::S7200,
        accumulators: 2,
        inputs: cpu.image,
        outputs: cpu.image,
        bit_memory: cpu.bit_memory,
        timers: cpu.timers,
        counters: cpu.timers,
        local_data: if cpu.row.old { 0 } else { LOCAL_BYTES },
        db_bytes_max: cpu.row.v_bytes,
        block_depth: 8,
        error_depth: 0,
        limits_checked: true,
    }
}

/// The resources of the CPU of a profile; the generic profile has those of a 226.
pub fn cpu_row(profile: &Profile) -> CpuRow {
    CPUS.iter().find(|cpu| cpu.name == profile.name).map_or(ROW_226, |cpu| cpu.row)
}

/// All CPUs with their profiles, the smallest of each generation first.
pub fn all() -> impl Iterator<Item = (Profile, CpuRow)> {
    CPUS.iter().map(|cpu| (profile(cpu), cpu.row))
}

/// Names of the generic profile and of all CPUs.
pub fn names() -> Vec<&'static str> {
    std::iter::once("s7-200").chain(CPUS.iter().map(|cpu| cpu.name)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::lookup;

    #[test]
    fn names_of_the_s7_200() {
        for (name, found) in [("CPU 224 XP", "224XP"), ("cpu224xpsi", "224XP"), ("CPU 226XM", "226"), ("214", "214")] {
            assert_eq!(lookup(name).map(|profile| profile.name).as_deref(), Some(found), "{name}");
        }
        assert_eq!(lookup("S7-200").map(|profile| cpu_row(&profile)), Some(ROW_226));
    }

    #[test]
    fn ranges_of_the_manual() {
        let row = |name: &str| lookup(name).map(|profile| (profile.clone(), cpu_row(&profile))).unwrap();
        let (profile, cpu) = row("212");
        assert_eq!((profile.inputs, profile.bit_memory, profile.timers, profile.local_data), (8, 16, 64, 0));
        assert_eq!((cpu.v_bytes, cpu.sm_bytes, cpu.s_bytes, cpu.analog_bytes), (512, 46, 8, 32));
        assert_eq!((cpu.events, cpu.queues, cpu.labels, cpu.old), (0b1_0111_0000_0011, [4, 4, 2], 64, true));
        let (_, cpu) = row("222");
        assert_eq!((cpu.v_bytes, cpu.sm_bytes, cpu.high_speed_counters, cpu.ports), (2048, 300, 0b11_1001, 1));
        assert_eq!((cpu.events >> 13 & 1, cpu.events >> 19 & 1, cpu.events >> 24 & 7, cpu.events >> 33), (0, 1, 0, 1));
        let (_, cpu) = row("224XP");
        assert_eq!((cpu.v_bytes, cpu.subroutines, cpu.ports, cpu.queues, cpu.id), (10240, 64, 2, [8, 16, 8], 2));
        let (_, cpu) = row("216");
        assert_eq!((cpu.watchdog_ms, cpu.id, cpu.pid_loops, cpu.ports, cpu.inputs), (300, 9, 8, 2, 24));
    }
}
