//! The reference page of the S7-200: its instructions, then events, CPUs, special memory and errors.

use std::fmt::Write as _;

use plcc_abi::image::Profile;
use plcc_abi::s7200::event::{self, Group};
use plcc_abi::s7200::image::CpuRow;
use plcc_abi::s7200::{ACCUMULATORS, HIGH_SPEED_COUNTERS, error, fatal};

use plcc_model::profile::s7200::all;

/// Special memory. Source: S7-200 system manual, special memory bits.
const SPECIAL_MEMORY: &[(&str, &str)] = &[
    ("SM0.0", "always 1"),
    ("SM0.1", "1 in the first scan"),
    ("SM0.2", "1 for one scan if retentive data is lost"),
    ("SM0.3", "1 for one scan when RUN is entered after power-up"),
    ("SM0.4", "clock: 30 s off, 30 s on"),
    ("SM0.5", "clock: 0.5 s off, 0.5 s on"),
    ("SM0.6", "changes with each scan, 0 in the first one"),
    ("SM0.7", "mode switch: 0 TERM, 1 RUN"),
    ("SM1.0 to SM1.7", "results of instructions: column SM1 above"),
    ("SMB2", "character received in Freeport mode"),
    ("SM3.0", "parity error of that character"),
    ("SM4.0, SM4.1, SM4.2", "queue overflow: communication, I/O, timed interrupts"),
    ("SM4.3", "a non-fatal error occurred in this scan"),
    ("SM4.4", "interrupts are enabled"),
    ("SM4.5, SM4.6", "transmitter of port 0, of port 1 is idle"),
    ("SMB6", "bits 7 to 4: identification of the CPU"),
    ("SMB8 to SMB21", "identification and error byte of modules 0 to 6; 16#80: absent"),
    ("SMW22, SMW24, SMW26", "scan time in ms: last, shortest, longest"),
    ("SMB28, SMB29", "analog potentiometers"),
    ("SMB30, SMB130", "control of port 0, of port 1: parity, bits, baud rate, PPI or Freeport"),
    ("SM31.7, SMB31, SMW32", "saves the V memory at SMW32 to permanent memory"),
    ("SMB34, SMB35", "period of timed interrupts 0 and 1 in ms"),
    ("SMB36 to SMB65, SMB131 to SMB165", "high-speed counters: status, control, new current and preset value"),
    (
        "SMB66 to SMB85, SMB166 to SMB185",
        "pulse outputs: status, control, cycle time, pulse width, pulse count, profile",
    ),
    ("SMB86 to SMB94, SMB186 to SMB194", "RCV on port 0, on port 1: status, control, characters, times"),
];

/// Numbers of errors that Micro/WIN and the compiler find. Source: S7-200 system manual, compile rule violations.
const COMPILE_ERRORS: &[(u16, &str)] = &[
    (0x0081, "stack underflow: the network does not begin with a load, or has pushed too few levels"),
    (0x0082, "illegal instruction, or one that the CPU does not have"),
    (0x0083, "no main program, or an instruction that is not allowed in it"),
    (0x0085, "NEXT without FOR"),
    (0x0086, "FOR without NEXT"),
    (0x0087, "label, subroutine or interrupt routine is missing"),
    (0x0088, "not allowed in a subroutine"),
    (0x0089, "not allowed in an interrupt routine"),
    (0x008B, "jump into or out of a sequence step"),
    (0x008C, "label or sequence step is defined twice"),
    (0x008D, "illegal number of a label"),
    (0x0090, "illegal parameter"),
    (0x0091, "address outside of the memory of the CPU"),
    (0x0092, "illegal count"),
    (0x0093, "FOR loops are nested more than 8 deep"),
    (0x0095, "SCRE, SCRT or CSCRE without LSCR"),
    (0x0096, "SCRE is missing, or an instruction that is not allowed in a sequence step"),
];

/// The page in Markdown: `docs/reference/s7-200.md`.
pub fn reference() -> String {
    let mut page = super::s7200_instructions::reference();
    write_cpus(&mut page);
    write_events(&mut page);
    write_special_memory(&mut page);
    write_errors(&mut page);
    page
}

/// The resource of a CPU, as a cell.
type Cell = fn(&Profile, &CpuRow) -> String;

/// Bytes of an area as a range, or a dash.
fn bytes(letters: &str, size: u32) -> String {
    size.checked_sub(1).map_or("-".to_owned(), |last| format!("{letters}0-{last}"))
}

/// Numbers 0 to `count` - 1, or a dash.
fn numbers(count: u32) -> String {
    bytes("", count)
}

const CPU_ROWS: &[(&str, Cell)] = &[
    ("inputs, outputs", |profile, _| bytes("", profile.inputs).replacen('-', ".0-", 1) + ".7"),
    ("analog words, AIW and AQW", |_, row| bytes("", row.analog_bytes.saturating_sub(1))),
    ("V", |_, row| bytes("VB", row.v_bytes)),
    ("M", |profile, _| bytes("MB", profile.bit_memory)),
    ("SM", |_, row| bytes("SMB", row.sm_bytes)),
    ("S", |_, row| bytes("SB", row.s_bytes)),
    ("L", |profile, _| bytes("LB", profile.local_data)),
    ("T", |profile, _| numbers(profile.timers)),
    ("C", |profile, _| numbers(profile.counters)),
    ("AC", |_, _| numbers(ACCUMULATORS)),
    ("HC", |_, row| {
        let has = (0..HIGH_SPEED_COUNTERS).filter(|number| row.high_speed_counters >> number & 1 != 0);
        has.map(|number| number.to_string()).collect::<Vec<_>>().join(" ")
    }),
    ("pulse outputs", |_, row| row.pulse_outputs.to_string()),
    ("PID loops", |_, row| row.pid_loops.to_string()),
    ("subroutines", |_, row| row.subroutines.to_string()),
    ("interrupt routines", |_, row| row.interrupts.to_string()),
    ("labels", |_, row| row.labels.to_string()),
    ("queues: communication, I/O, timed", |_, row| row.queues.map(|depth| depth.to_string()).join(", ")),
    ("ports", |_, row| row.ports.to_string()),
    ("inputs, outputs on board", |_, row| format!("{}, {}", row.inputs, row.outputs)),
    ("watchdog, ms", |_, row| row.watchdog_ms.to_string()),
    ("SMB6, bits 7 to 4", |_, row| format!("{:04b}", row.id)),
];

fn write_cpus(page: &mut String) {
    page.push_str(
        "\n## CPUs\n\nSource: S7-200 system manual, memory ranges and features. If no CPU is named, the profile `s7-200` is a 226.\n\n",
    );
    let cpus: Vec<(Profile, CpuRow)> = all().collect();
    write_head(page, "", &cpus);
    for (name, cell) in CPU_ROWS {
        let cells: Vec<String> = cpus.iter().map(|(profile, row)| cell(profile, row)).collect();
        let _ = writeln!(page, "| {name} | {} |", cells.join(" | "));
    }
}

/// Heading of a table with a column for each CPU after the columns `first`.
fn write_head(page: &mut String, first: &str, cpus: &[(Profile, CpuRow)]) {
    let names: Vec<&str> = cpus.iter().map(|(profile, _)| profile.name.as_str()).collect();
    let columns = first.matches('|').count() + 1 + cpus.len();
    let _ = writeln!(page, "| {first} | {} |\n|{}", names.join(" | "), " --- |".repeat(columns));
}

fn write_events(page: &mut String) {
    page.push_str(
        "\n## Events\n\nSource: S7-200 system manual, priorities of interrupt events. Communication has priority over I/O, and I/O over timed events; in a group, events run in the order in which they\n\
         came, simultaneous ones by their priority, 0 first.\n\n",
    );
    let cpus: Vec<(Profile, CpuRow)> = all().collect();
    write_head(page, "event | source | group | priority", &cpus);
    for (number, event) in event::TABLE.iter().enumerate() {
        let group = match event.group {
            Group::Communication => "communication",
            Group::InputOutput => "I/O",
            Group::Timed => "timed",
        };
        let has: Vec<&str> = cpus.iter().map(|(_, row)| if row.events >> number & 1 != 0 { "x" } else { "" }).collect();
        let _ = writeln!(page, "| {number} | {} | {group} | {} | {} |", event.source, event.priority, has.join(" | "));
    }
}

fn write_special_memory(page: &mut String) {
    page.push_str(
        "\n## Special memory\n\nSource: S7-200 system manual, special memory bits. SMB0 to SMB29 are read-only; addresses that are not listed read 0.\n\n\
         | address | meaning |\n| --- | --- |\n",
    );
    for (address, meaning) in SPECIAL_MEMORY {
        let _ = writeln!(page, "| {address} | {meaning} |");
    }
}

fn write_errors(page: &mut String) {
    page.push_str("\n## Errors\n\nSource: S7-200 system manual, error codes.\n\nFatal: the CPU goes to STOP, its outputs get their values for STOP.\n");
    write_codes(page, fatal::TEXTS);
    page.push_str(
        "\nNon-fatal: the instruction does nothing, ENO is 0 and SM4.3 is 1; with `stop_on_error` of plc.toml the CPU goes to STOP.\n",
    );
    write_codes(page, error::TEXTS);
    page.push_str("\nErrors in the program; messages also name these codes.\n");
    write_codes(page, COMPILE_ERRORS);
}

fn write_codes(page: &mut String, codes: &[(u16, &str)]) {
    page.push_str("\n| code | meaning |\n| --- | --- |\n");
    for (code, text) in codes {
        let _ = writeln!(page, "| {code:04X} | {text} |");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_the_manual() {
        let page = reference();
        let line = |start: &str| page.lines().find(|line| line.starts_with(start)).unwrap_or_default().to_owned();
        let named = "| 212 | 214 | 215 | 216 | 221 | 222 | 224 | 224XP | 226 |";
        assert_eq!(line("|  | 212"), format!("|  {named}"));
        assert!(line("| V |").starts_with("| V | VB0-511 | VB0-2047 |"), "{}", line("| V |"));
        assert!(line("| inputs, outputs |").starts_with("| inputs, outputs | 0.0-7.7 |"));
        assert!(line("| analog words").ends_with("| 0-30 | 0-30 | 0-62 | 0-62 | 0-62 |"), "{}", line("| analog words"));
        assert!(line("| L |").starts_with("| L | - | - | - | - | LB0-63 |"));
        assert!(line("| HC |").ends_with("| 0 3 4 5 | 0 3 4 5 | 0 1 2 3 4 5 | 0 1 2 3 4 5 | 0 1 2 3 4 5 |"));
        // 212 has the events 0, 1, 8 to 10 and 12.
        assert!(line("| 12 |").contains("| I/O | 10 | x | x |"), "{}", line("| 12 |"));
        assert!(line("| 13 |").contains("| I/O | 13 |  | x |"), "{}", line("| 13 |"));
        assert!(line("| 24 |").ends_with("| communication | 1 |  |  |  | x |  |  |  | x | x |"), "{}", line("| 24 |"));
        assert_eq!(line("| 0091 | operand"), "| 0091 | operand out of range |");
    }
}
