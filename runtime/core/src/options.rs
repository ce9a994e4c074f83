//! The runtime flags, the same for an executable and for `plcc run`.

use plcc_abi::image::Config;
use plcc_literal::duration;
use std::path::PathBuf;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Args, ValueEnum};

/// The clock that a program uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ClockKind {
    /// The time of the host.
    #[default]
    Real,
    /// Advances by the cycle time at the end of each cycle, so every run is the same.
    Virtual,
}

/// Runtime flags.
#[derive(Args, Clone, Debug, Default)]
pub struct RunOptions {
    /// End after N cycles of OB 1 [default: run until STOP, Ctrl+C or SIGTERM]
    #[arg(long, value_name = "N", value_parser = parse_cycles, allow_negative_numbers = true)]
    pub cycles: Option<u64>,
    /// Clock of the program
    #[arg(long, value_enum, default_value_t)]
    pub clock: ClockKind,
    /// Time from one cycle start to the next; 0: no pause [default: 10ms]
    #[arg(long, value_name = "TIME", value_parser = parse_duration)]
    pub cycle_time: Option<Duration>,
    /// Set a value before the startup OB runs, e.g. I0.0=1 or "AI0=12 mA"; separate several by commas or repeat the flag
    #[arg(long, value_name = "ADDR=VALUE")]
    pub set: Vec<String>,
    /// Print values after the last cycle, e.g. Q4.0,MW20,DB10.DBD4,"AO0 in %"
    #[arg(long, value_name = "ADDR,...")]
    pub print: Vec<String>,
    /// Print the values as JSON
    #[arg(long)]
    pub json: bool,
    /// Play a scenario: a TOML file (see docs/testing.md)
    #[arg(long, value_name = "FILE")]
    pub scenario: Option<PathBuf>,
    /// Record values after each cycle in FILE.vcd, FILE.csv or FILE.html, a page with curves, zoom and cursors
    #[arg(long, value_name = "FILE")]
    pub trace: Option<PathBuf>,
    /// Values to record [default: the values of --print and those that the program uses]
    #[arg(long, value_name = "ADDR,...")]
    pub trace_signals: Vec<String>,
    /// Modify values by a watch table, a TOML file (see docs/debugging.md), and print it after the last cycle
    #[arg(long, value_name = "FILE")]
    pub watch_table: Option<PathBuf>,
    /// Force inputs and outputs by a table, a TOML file (see docs/debugging.md); what is forced later is kept there
    #[arg(long, value_name = "FILE")]
    pub force: Option<PathBuf>,
    /// Shortest time between two records [default: record each cycle]
    #[arg(long, value_name = "TIME", value_parser = parse_duration)]
    pub trace_step: Option<Duration>,
    /// Print the diagnostic buffer at the end, newest entry first
    #[arg(long)]
    pub diag: bool,
    /// Leave out the messages of a normal run: only faults, open services, missing parts and the values of --print are printed
    #[arg(long)]
    pub quiet: bool,
    /// Folder of the program's data logs, recipes and files [default: `data` in plc.toml, else plc-data]
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Keep retentive memory in a file, from one run to the next [default: `file` in `[retain]` of plc.toml, else no file]
    #[arg(long, value_name = "FILE")]
    pub retain: Option<PathBuf>,
    /// How the program starts [default: `startup` in plc.toml, else warm]
    #[arg(long, value_enum, value_name = "KIND")]
    pub restart: Option<Restart>,
    /// Run N independent CPUs with the program on all processors; needs --clock virtual and --cycles
    #[arg(long, value_name = "N")]
    pub instances: Option<u32>,
    /// Values that differ from instance to instance: a CSV file with the names of --set in its first line and a line for each instance
    #[arg(long, value_name = "FILE")]
    pub instance_values: Option<PathBuf>,
    /// Write the alarms that come and go to a CSV file
    #[arg(long, value_name = "FILE")]
    pub alarm_log: Option<PathBuf>,
    /// TCP port of ISO-on-TCP connections [default: 102, which only a privileged process may open]
    #[arg(long, value_name = "PORT", value_parser = parse_port)]
    pub iso_port: Option<u16>,
    /// Longest host time of a cycle under the virtual clock [default: 10s]
    #[arg(long, value_name = "TIME", value_parser = parse_duration)]
    pub hang_limit: Option<Duration>,
    /// Record the run in a file, for --replay: the time of each cycle and what clients change; the clock stands still within a cycle
    #[arg(long, value_name = "FILE", conflicts_with = "replay")]
    pub record: Option<PathBuf>,
    /// Repeat a recorded run, and compare memory after each cycle
    #[arg(long, value_name = "FILE")]
    pub replay: Option<PathBuf>,
    /// Take precedence over all ordinary processes (SCHED_FIFO), with memory locked; needs CAP_SYS_NICE and CAP_IPC_LOCK
    #[arg(long)]
    pub realtime: bool,
    /// S7-200: also stop on errors that leave a real CPU in RUN
    #[arg(long)]
    pub stop_on_error: bool,
    /// Somebody only looks: the run leaves no trace in the files of the program, and may end before a scenario does. Not a flag.
    #[arg(skip)]
    pub looks: bool,
}

/// How a program starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Restart {
    /// OB 100; retentive data is kept.
    Warm,
    /// OB 101, S7-400; all data is kept, and the program goes on.
    Hot,
    /// OB 102, S7-300/400; all data begins with its start values.
    Cold,
    /// Memory reset, then OB 100: all data begins with its start values.
    Reset,
}

impl RunOptions {
    /// Many CPUs run: none of them is the one that clients could reach.
    pub fn is_many(&self) -> bool {
        self.instances.is_some() || self.instance_values.is_some()
    }

    /// Services that plc.toml names are not opened, only those of flags.
    pub fn flags_only(&self) -> bool {
        self.is_many() || self.replay.is_some()
    }

    /// Nothing in the flags ends the run, and nobody has asked for silence.
    pub(crate) fn runs_on(&self) -> bool {
        self.cycles.is_none() && self.replay.is_none() && !self.quiet
    }

    /// Puts what the flags say about errors and restarts into the configuration.
    pub(crate) fn configure(&self, config: &mut Config) {
        config.s7200.stop_on_error |= self.stop_on_error;
        if let Some(path) = &self.retain {
            config.retain.file = Some(path.display().to_string());
        }
        // A warm or a cold restart in between takes nothing from the next hot one.
        config.retain.for_hot |= config.startup == 101;
        if self.looks {
            config.retain.file = None;
        }
        match self.restart {
            None => {}
            Some(Restart::Warm) => config.startup = 100,
            Some(Restart::Hot) => config.startup = 101,
            Some(Restart::Cold) => config.startup = 102,
            Some(Restart::Reset) => (config.startup, config.retain.reset) = (100, true),
        }
    }
}

/// A time span in nanoseconds, the value of a flag.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Duration(pub u64);

/// Default of `--cycle-time`.
pub const CYCLE_TIME_DEFAULT: Duration = Duration(10_000_000);

/// Default of `--hang-limit`.
pub const HANG_LIMIT_DEFAULT: Duration = Duration(10_000_000_000);

/// The flags of services, which an executable has only if it was built with them.
pub const SERVICE_FLAGS: &[&str] = &[
    "--s7",
    "--modbus",
    "--opcua",
    "--metrics",
    "--web",
    "--tables",
    "--tls",
    "--mqtt",
    "--mqtt-ca",
    "--mqtt-certificate",
    "--mqtt-key",
    "--sparkplug",
    "--publish",
    "--access",
    "--allow-load",
];

/// The message for the flag of a service, if that is why the flags cannot be read: the executable has no services.
pub fn without_services(error: &clap::Error) -> Option<String> {
    let flag = match (error.kind(), error.get(ContextKind::InvalidArg)) {
        (ErrorKind::UnknownArgument, Some(ContextValue::String(flag))) => flag.split('=').next()?,
        _ => return None,
    };
    SERVICE_FLAGS.contains(&flag).then(|| {
        format!(
            "`{flag}` needs the services, which this executable does not contain: build it with `plcc build --services`, or with \
             `[services]` in plc.toml"
        )
    })
}

/// The message for a negative value, which the parser takes for another flag: `--cycle-time -10ms`.
pub fn negative_value(error: &clap::Error, command: &clap::Command, args: &[&str]) -> Option<String> {
    if error.kind() != ErrorKind::UnknownArgument {
        return None;
    }
    let own: Vec<&str> = args.iter().copied().take_while(|arg| *arg != "--").collect();
    own.windows(2).find_map(|pair| {
        let [flag, value] = *pair else { return None };
        let has_value = command.get_arguments().any(|own| {
            own.get_long().is_some_and(|long| flag.strip_prefix("--") == Some(long)) && own.get_action().takes_values()
        });
        let is_number = value.strip_prefix('-').is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()));
        (has_value && is_number).then(|| format!("{flag} takes no negative value such as `{value}`"))
    })
}

/// Parses a number of cycles. `Err`: the error.
fn parse_cycles(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| "write a whole number of cycles, as in --cycles 100".to_string())
}

/// Parses `10ms`, `1.5s`, `500us`, `2m`, `0`. `Err`: the error.
pub fn parse_duration(text: &str) -> Result<Duration, String> {
    let wrong = || match duration::meant_span(text) {
        Some(meant) => format!("`{text}` is not a time; write {meant}"),
        None => format!("`{text}` is not a time; write a number with the unit us, ms, s, m or h, as in 1.5s"),
    };
    duration::span(text).map(Duration).ok_or_else(wrong)
}

/// Parses the number of a TCP port. `Err`: the error.
fn parse_port(text: &str) -> Result<u16, String> {
    text.parse().map_err(|_| format!("`{text}` is not a port: ports are 1 to 65535"))
}

/// Splits lists at commas, but not inside quotes, parentheses or brackets.
pub fn split_list(texts: &[String]) -> Vec<String> {
    let mut items = Vec::new();
    for text in texts {
        let mut item = String::new();
        let (mut quote, mut depth) = (None, 0u32);
        for c in text.chars() {
            match (c, quote) {
                (',', None) if depth == 0 => items.push(std::mem::take(&mut item)),
                (_, Some(open)) => {
                    quote = if c == open { None } else { quote };
                    item.push(c);
                }
                (_, None) => {
                    match c {
                        '"' | '\'' => quote = Some(c),
                        '(' | '[' => depth += 1,
                        ')' | ']' => depth = depth.saturating_sub(1),
                        _ => {}
                    }
                    item.push(c);
                }
            }
        }
        items.push(item);
    }
    items.retain(|item| !item.trim().is_empty());
    items.iter().map(|item| item.trim().to_string()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_of_services_say_how_to_get_them() {
        let message = |arguments: &[&str]| {
            let command = RunOptions::augment_args(clap::Command::new("program"));
            without_services(&command.try_get_matches_from([&["program"], arguments].concat()).err()?)
        };
        assert!(message(&["--s7", "102"]).is_some_and(|message| message.starts_with("`--s7` needs the services")));
        assert!(message(&["--web=8080"]).is_some_and(|message| message.contains("--services")));
        assert_eq!([message(&["--cylces", "5"]), message(&["--retain"])], [None, None]);
    }

    #[test]
    fn a_run_without_an_end_is_known() {
        let plain = RunOptions::default();
        assert!(plain.runs_on());
        assert!(!RunOptions { cycles: Some(5), ..plain.clone() }.runs_on());
        assert!(!RunOptions { quiet: true, ..plain.clone() }.runs_on());
        assert!(!RunOptions { replay: Some("a.rec".into()), ..plain }.runs_on());
    }

    #[test]
    fn lists() {
        let list = |text: &str| split_list(&[text.to_string()]);
        assert_eq!(list("Q4.0, MW20,\"a,b\""), ["Q4.0", "MW20", "\"a,b\""]);
        assert_eq!(list("MW0=B#(1,8),MD2='a,b'"), ["MW0=B#(1,8)", "MD2='a,b'"]);
        assert_eq!(list("a[1,2].x,\"b\".c"), ["a[1,2].x", "\"b\".c"]);
        assert_eq!(list(""), Vec::<String>::new());
    }
}
