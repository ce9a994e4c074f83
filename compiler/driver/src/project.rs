//! `plc.toml`: the parts of a project and the settings of its CPU. docs/plc-toml.md describes every key.
//!
//! `keys` is the file as it is read; `cpu` checks the settings of the CPU and of its services, `blocks` those of organization blocks,
//! `modules` addresses.

mod blocks;
mod cpu;
mod keys;
mod modules;

use std::ops::Range;

use plcc_abi::image::{Config, Family, Profile};
use plcc_diag::{Code, Diagnostic, FileId, SourceFile, Span};
use plcc_literal::duration::{interval, meant_span};
use plcc_literal::toml_words;
use plcc_runtime::options::parse_duration;
use plcc_syntax::stl::Mnemonics;
use toml::Spanned;

use crate::cpu_settings::CpuSetting;
use crate::services;
use crate::station::{self, Station};
use crate::technology;
pub use blocks::{NamedOb, set_named};
use keys::{Keys, MnemonicsKey};

/// Name of the file that makes a folder a project.
pub const FILE_NAME: &str = "plc.toml";

/// A project as its `plc.toml` describes it. Paths are relative to its folder.
#[derive(Clone, Debug, Default)]
pub struct Project {
    /// Name of the program and its executable; the folder's name by default.
    pub name: Option<String>,
    pub cpu: Option<(String, Span)>,
    pub mnemonics: Option<Mnemonics>,
    /// Blocks of safety programs are compiled as standard blocks.
    pub safety_as_standard: bool,
    /// Files and folders; `None`: every source below the project's folder, without `tests`.
    pub sources: Option<Vec<(String, Span)>>,
    pub symbols: Vec<(String, Span)>,
    pub config: Config,
    /// Settings of organization blocks by their names, made after binding.
    pub named_obs: Vec<NamedOb>,
    pub station: Option<Station>,
    /// Parts may be missing.
    pub partial: bool,
    /// Fast counters and pulse generators, checked later against the CPU.
    pub technology: technology::Used,
    /// Source in SCL that declares the axes; empty without any.
    pub axes: String,
    /// Names of the axes, with their headings.
    pub axis_names: Vec<(String, Span)>,
    /// Values that `[services]` names, checked later against the program.
    pub names: services::Names,
    /// Settings that not every CPU has, checked later against the CPU.
    pub of_cpu: Vec<(CpuSetting, Span)>,
    /// Place of the settings of an S7-200, checked later against the CPU.
    pub s7200: Option<Span>,
    /// Place of `startup = "hot"`, checked later against the CPU.
    pub hot: Option<Span>,
    /// Symbol tables in the folder, if `sources` and `symbols` name none.
    pub tables_beside: Vec<String>,
    /// The file could not be read as a whole, so that nothing is known of the project.
    pub unread: bool,
}

/// Reads the text of a `plc.toml`. Reports wrong keys as P0601 and ignores them.
pub fn parse(file: FileId, source: &SourceFile) -> (Project, Vec<Diagnostic>) {
    let mut context = Context { file, of_cpu: Vec::new(), diagnostics: Vec::new() };
    let project = match toml::from_str::<Keys>(&source.text) {
        Ok(keys) => context.project(keys),
        Err(error) => {
            let range = error.span().unwrap_or(0..0);
            if let Some((range, wrong)) = toml_words::bare_literal(error.message(), &source.text, range.start) {
                // A duration has no prefix here, and one unit.
                let literal = &source.text[range.clone()];
                let in_ms = || interval(literal).map(|ns| format!("{}ms", ns.div_ceil(1_000_000)));
                let help = match meant_span(literal).or_else(in_ms) {
                    Some(duration) => format!("write `\"{duration}\"`"),
                    None => wrong.help,
                };
                context.report(range, wrong.title, &help);
                return (Project { unread: true, ..Project::default() }, context.diagnostics);
            }
            let mut wrong = toml_words::plain_at(error.message(), &source.text, range.start);
            if let Some(help) = belongs_below(&wrong.title, &source.text[..range.start.min(source.text.len())]) {
                wrong.help = help;
            }
            context.report(range, wrong.title, &wrong.help);
            Project { unread: true, ..Project::default() }
        }
    };
    (project, context.diagnostics)
}

/// The heading below which a key belongs that stands at the top of the file, or has the number of an organization block in its name.
fn belongs_below(title: &str, before: &str) -> Option<String> {
    const BELOW: [(&str, &[&str]); 3] = [
        ("services", &["s7", "opcua", "modbus", "metrics", "mqtt", "web", "access", "protection", "password", "user"]),
        ("ob.35", &["period", "phase", "priority", "class"]),
        ("retain", &["memory", "timers", "counters"]),
    ];
    let (key, rest) = title.strip_prefix('`')?.split_once('`')?;
    if rest != " is not a key here" {
        return None;
    }
    let number = key.get(..2).filter(|letters| letters.eq_ignore_ascii_case("ob")).map(|_| &key[2..]);
    if let Some(number) =
        number.filter(|number| !number.is_empty() && number.bytes().all(|digit| digit.is_ascii_digit()))
    {
        return Some(format!("write `[ob.{number}]`"));
    }
    let is_top = !before.lines().any(|line| line.trim_start().starts_with('['));
    let (heading, _) = BELOW.iter().find(|(_, keys)| keys.contains(&key)).filter(|_| is_top)?;
    Some(match *heading {
        "ob.35" => format!("`{key}` is of one organization block: write it below its heading, as `[ob.35]`"),
        heading => format!("write it below the heading `[{heading}]`"),
    })
}

struct Context {
    file: FileId,
    of_cpu: Vec<(CpuSetting, Span)>,
    diagnostics: Vec<Diagnostic>,
}

/// Whether the CPU has the hot restart of this place. Source: System and standard functions, OB 101.
pub fn check_hot(place: Option<Span>, profile: &Profile) -> Option<Diagnostic> {
    let place = place.filter(|_| profile.family != Family::S7400)?;
    let title = format!("the CPU {} has no hot restart", profile.name);
    Some(Diagnostic::new(Code::Project, place, title).help("write `startup = \"warm\"`, or choose a CPU of the S7-400"))
}

impl Context {
    /// Notes a setting that not every CPU has.
    fn note_of_cpu(&mut self, setting: CpuSetting, range: Range<usize>) {
        self.of_cpu.push((setting, Span::new(self.file, range)));
    }

    fn report(&mut self, range: Range<usize>, title: impl Into<String>, help: &str) {
        self.diagnostics.push(Diagnostic::new(Code::Project, Span::new(self.file, range), title).help(help));
    }

    fn project(&mut self, keys: Keys) -> Project {
        let mut config = Config::default();
        self.cycle_times(&keys, &mut config);
        self.memory_bytes(&keys, &mut config);
        self.data_folder(&keys, &mut config);
        self.startup(&keys, &mut config);
        let hot = keys.startup.as_ref().filter(|_| config.startup == 101);
        let hot = hot.map(|key| Span::new(self.file, key.span()));
        let mut named_obs = Vec::new();
        for (number, ob) in &keys.ob {
            named_obs.extend(self.organization_block(number, ob, &mut config));
        }
        let technology = self.technology(&keys, &mut config);
        let (axes, axis_names) = self.axes(&keys);
        self.services(&keys, &mut config);
        let file = self.file;
        let place = |text: Spanned<String>| (text.get_ref().clone(), Span::new(file, text.span()));
        let cpu = keys.cpu.map(place);
        let station = keys.station.map(|station| {
            let (station, diagnostics) = station::read(&station, cpu.as_ref(), self.file);
            self.diagnostics.extend(diagnostics);
            station
        });
        if !keys.module.is_empty() || station.is_some() {
            let of_station = station.as_ref().map(Station::modules).unwrap_or_default();
            let modules = self.modules(of_station, &keys.module);
            config.hardware_ids = self.hardware_ids(&modules[modules.len() - keys.module.len()..], &keys.module);
            config.modules = Some(modules);
        }
        self.devices(&keys.io, &mut config);
        config.cpu_order = station.as_ref().map(Station::cpu_order).unwrap_or_default();
        Project {
            unread: false,
            tables_beside: Vec::new(),
            name: keys.name.map(Spanned::into_inner),
            cpu: station.as_ref().and_then(Station::profile).or(cpu),
            mnemonics: keys.mnemonics.map(|key| match key {
                MnemonicsKey::En => Mnemonics::En,
                MnemonicsKey::De => Mnemonics::De,
            }),
            safety_as_standard: keys.safety_as_standard,
            sources: keys.sources.map(|sources| sources.into_iter().map(place).collect()),
            symbols: keys.symbols.into_iter().map(place).collect(),
            partial: keys.partial,
            config,
            named_obs,
            station,
            technology,
            axes,
            axis_names,
            names: keys.services.as_ref().map(|keys| services::names(keys, file)).unwrap_or_default(),
            of_cpu: std::mem::take(&mut self.of_cpu),
            s7200: keys.s7200.map(|keys| Span::new(file, keys.span())),
            hot,
        }
    }

    fn number<T: TryFrom<i64>>(
        &mut self,
        key: &Spanned<i64>,
        range: std::ops::RangeInclusive<i64>,
        what: &str,
    ) -> Option<T> {
        let help = format!("write a number from {} to {}", range.start(), range.end());
        number_within(key, range, what).map_err(|title| self.report(key.span(), title, &help)).ok()
    }

    /// A duration in milliseconds.
    fn duration(&mut self, key: &Spanned<String>, range: std::ops::RangeInclusive<u32>) -> Option<u32> {
        let ms = duration_ms(key.get_ref()).filter(|ms| range.contains(ms));
        if ms.is_none() {
            let title = format!("`{}` is not a time from {} to {} ms", key.get_ref(), range.start(), range.end());
            let meant = meant_span(key.get_ref());
            let help = match meant.filter(|meant| duration_ms(meant).is_some_and(|ms| range.contains(&ms))) {
                Some(meant) => format!("write `{meant}`"),
                None if duration_ms(key.get_ref()).is_some_and(|ms| ms > *range.end()) => {
                    format!("the longest time is `{}s`", range.end() / 1000)
                }
                None => "write a number with a unit, as in `200ms` or `2s`".to_string(),
            };
            self.report(key.span(), title, &help);
        }
        ms
    }
}

/// `200ms`, `1.5s`, `1m`, in milliseconds; none: not a time, or not whole milliseconds.
pub(crate) fn duration_ms(text: &str) -> Option<u32> {
    duration_of(text, 1_000_000).and_then(|ms| u32::try_from(ms).ok())
}

/// A duration in units of `unit` nanoseconds; none: not a time, or not a whole number of units.
pub(crate) fn duration_of(text: &str, unit_ns: u64) -> Option<u64> {
    // A number alone is not a time, not even 0.
    let ns = parse_duration(text).ok().filter(|_| !text.trim().ends_with(|c: char| c.is_ascii_digit()))?.0;
    ns.is_multiple_of(unit_ns).then_some(ns / unit_ns)
}

/// The number of a key. `Err`: what is wrong with it, for a message.
pub(crate) fn number_within<T: TryFrom<i64>>(
    key: &Spanned<i64>,
    range: std::ops::RangeInclusive<i64>,
    what: &str,
) -> Result<T, String> {
    let wrong = || format!("{} is not {what} from {} to {}", key.get_ref(), range.start(), range.end());
    if !range.contains(key.get_ref()) {
        return Err(wrong());
    }
    T::try_from(*key.get_ref()).map_err(|_| wrong())
}

#[cfg(test)]
mod tests {
    use plcc_abi::ob::ObClass;

    use super::*;

    fn read(text: &str) -> (Project, Vec<(u32, String)>) {
        let source = SourceFile::new(FILE_NAME, text);
        let (project, diagnostics) = parse(FileId(0), &source);
        (project, diagnostics.into_iter().map(|d| (source.line(d.primary.span.start), d.title)).collect())
    }

    #[test]
    fn reads_every_key() {
        let (project, messages) = read(
            r#"
name = "tank"
cpu = "315-2DP"
mnemonics = "de"
sources = ["main.stl", "blocks"]
symbols = ["symbols.sdf"]
startup = "cold"
cycle_time_max = "200ms"
clock_memory = 100
system_memory_byte = 1
cycle_time_exceeded = "run"

[ob.123]
class = "cyclic"
period = "20ms"

[ob.35]
period = "50ms"
phase = "5ms"
priority = 12

[ob.10]
start = "2026-01-31T06:00:00"
every = "day"

[[module]]
name = "DI8/DO8"
inputs = { start = 0, bytes = 1 }
outputs = { start = 0, bytes = 1 }
"#,
        );
        assert_eq!(messages, []);
        assert_eq!(project.name.as_deref(), Some("tank"));
        assert_eq!(project.mnemonics, Some(Mnemonics::De));
        assert_eq!(project.sources.map(|sources| sources.len()), Some(2));
        let config = project.config;
        assert_eq!((config.cycle_time_max_ms, config.clock_memory_byte, config.startup), (200, Some(100), 102));
        assert_eq!((config.system_memory_byte, config.overrun_stops), (Some(1), Some(false)));
        assert_eq!(config.ob_classes, [(123, ObClass::Cyclic)]);
        assert_eq!((config.cyclic_period_ms, config.cyclic_phase_ms), (vec![(123, 20), (35, 50)], vec![(35, 5)]));
        assert_eq!(config.priorities, [(35, 12)]);
        assert_eq!((config.time_of_day[0].ob, config.time_of_day[0].period), (10, 0x1001));
        assert_eq!(config.modules.map(|modules| modules[0].output_bytes), Some(1));
    }

    #[test]
    fn tells_the_line_of_what_is_wrong() {
        let line = |text: &str| read(text).1.first().map(|(line, _)| *line);
        assert_eq!(line("name = \"a\"\ncylce_time_max = \"1s\"\n"), Some(2));
        assert_eq!(line("\ncycle_time_max = \"7s\"\n"), Some(2));
        assert_eq!(line("[ob.35]\n\nperiod = \"fast\"\n"), Some(3));
        assert_eq!(line("[ob.1]\nperiod = \"1s\"\n"), Some(2));
        assert_eq!(line("[ob.0]\npriority = 3\n"), Some(1));
        assert_eq!(line("[ob.main]\npriority = 3\n"), None);
        assert_eq!(line("[ob.10]\nstart = \"soon\"\n"), Some(2));
        assert_eq!(line("[ob.35]\nevery = \"day\"\n"), Some(2));
        assert_eq!(line("[ob.35]\nclass = \"cyclic\"\n"), Some(2));
        assert_eq!(line("[ob.123]\nclass = \"time error\"\n"), Some(2));
        assert_eq!(line("[ob.123]\nclass = \"startup\"\nperiod = \"1s\"\n"), Some(3));
        assert_eq!(line("[ob.123]\nperiod = \"1s\"\n"), None);
        assert_eq!(line("clock_memory_byte = 1\nsystem_memory_byte = 1\n"), Some(2));
        assert_eq!(line("name = \n"), Some(1));
        let two = "[[module]]\nname = \"a\"\ninputs = { start = 0, bytes = 4 }\n";
        assert_eq!(line(&format!("{two}{}", two.replace("= 0", "= 3"))), Some(5));
        assert_eq!(line(&format!("{two}{}", two.replace("= 0", "= 4"))), None);
    }

    #[test]
    fn reads_axes() {
        let (project, messages) = read(
            "[axis.\"Fan axis\"]\ntype = \"TO_SpeedAxis\"\nmax_velocity = 5\n[axis.Axis_1]\nacceleration = 1e3\nmin_position = -10.5",
        );
        assert_eq!(messages, []);
        let place = |text: &str| project.axes.find(text).unwrap_or_else(|| panic!("{text} in {}", project.axes));
        assert!(place("DATA_BLOCK \"Fan axis\"") < place("S.SpeedAxis := TRUE"));
        assert!(place("DynamicDefaults.Velocity := 5.0") < place("DATA_BLOCK \"Axis_1\""));
        assert!(place("DynamicDefaults.Acceleration := 1000.0") < place("PositionLimits_SW.MinPosition := -10.5"));
        assert!(place("\"Fan axis\"();") < place("\"Axis_1\"();"));
        let (_, messages) = read(
            "[axis.a]\ntype = \"TO_Cam\"\ndeceleration = 0\nvelocity = 300\nmin_position = 5\nmax_position = 5\n[axis.b]\ntype = \"TO_SpeedAxis\"\nhome_mark = 1\njerk = nan",
        );
        let lines: Vec<u32> = messages.iter().map(|(line, _)| *line).collect();
        assert_eq!(lines, [2, 6, 4, 3, 9, 10], "{messages:?}");
    }
}
