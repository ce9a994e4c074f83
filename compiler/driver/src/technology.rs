//! `[hsc.N]`, `[pulse.N]` and `[hardware_interrupt."name"]` of plc.toml: fast counters, pulse generators and hardware interrupts of an
//! S7-1200.

use std::collections::BTreeMap;
use std::ops::Range;

use plcc_abi::image::{Config, Profile};
use plcc_abi::technology::{CountMode, EventSource, FastCounter, HardwareEvent, PulseGenerator};
use plcc_diag::{Code, Diagnostic, FileId, Span};
use plcc_literal::article::with_article;
use plcc_model::profile;
use serde::Deserialize;
use toml::Spanned;

use crate::keys::one_of;
use crate::project::duration_of;

/// Maximum number of events for ATTACH. Source: LAD/FBD reference for S7-1200, organization blocks.
const EVENTS_MAX: usize = 50;
/// Input bytes of the process image.
const INPUT_BYTES: u32 = 1024;
const PERIODS_MS: [u16; 3] = [10, 100, 1000];
const CYCLE_US_MAX: u64 = 16_777_215;
/// Units of the pulse width, and the width that is the whole cycle.
const WIDTHS: [(&str, u16); 4] = [("percent", 100), ("permille", 1000), ("ten thousandth", 10_000), ("analog", 27_648)];

/// `[hsc.N]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HscKeys {
    mode: Option<Spanned<String>>,
    direction: Option<Spanned<String>>,
    #[serde(default)]
    initial: i32,
    #[serde(default)]
    reference: i32,
    reset: Option<Spanned<String>>,
    period: Option<Spanned<String>>,
}

/// `[pulse.N]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PulseKeys {
    cycle: Option<Spanned<String>>,
    unit: Option<Spanned<String>>,
    width: Option<Spanned<u16>>,
}

/// `[hardware_interrupt."name"]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InterruptKeys {
    input: Option<Spanned<String>>,
    edge: Option<Spanned<String>>,
    hsc: Option<Spanned<u8>>,
    on: Option<Spanned<String>>,
    ob: Option<Spanned<u16>>,
}

/// Numbers of fast counters and pulse generators with their places, to be checked against the CPU.
#[derive(Clone, Debug, Default)]
pub struct Used {
    counters: Vec<(u8, Span)>,
    pulses: Vec<(u8, Span)>,
    events: Vec<Span>,
}

/// Reads the three tables into the configuration.
pub fn read(
    hsc: &BTreeMap<Spanned<String>, HscKeys>,
    pulse: &BTreeMap<Spanned<String>, PulseKeys>,
    interrupts: &BTreeMap<Spanned<String>, InterruptKeys>,
    file: FileId,
    config: &mut Config,
) -> (Used, Vec<Diagnostic>) {
    let mut reader = Reader { file, used: Used::default(), diagnostics: Vec::new() };
    for (number, keys) in hsc {
        let Some(n) = reader.number(number, 6, "hsc") else { continue };
        reader.used.counters.push((n, reader.span(number)));
        config.fast_counters.extend(reader.counter(n, keys));
    }
    for (number, keys) in pulse {
        let Some(n) = reader.number(number, 4, "pulse") else { continue };
        reader.used.pulses.push((n, reader.span(number)));
        config.pulse_generators.extend(reader.pulse(n, keys));
    }
    // In the order of the file, which determines the constants of the events.
    let mut interrupts: Vec<_> = interrupts.iter().collect();
    interrupts.sort_by_key(|(name, _)| name.span().start);
    for (name, keys) in interrupts {
        reader.used.events.push(reader.span(name));
        let Some(source) = reader.source(name, keys, config) else { continue };
        let ob = keys.ob.as_ref().map_or(0, |ob| *ob.get_ref());
        config.hardware_events.push(HardwareEvent { name: name.get_ref().clone(), source, ob });
        if config.hardware_events.len() == EVENTS_MAX + 1 {
            reader.report(name, format!("more than {EVENTS_MAX} hardware interrupts"), "leave some out".to_string());
        }
    }
    (reader.used, reader.diagnostics)
}

/// The organization blocks that events start, and where plc.toml says so.
pub fn started(interrupts: &BTreeMap<Spanned<String>, InterruptKeys>) -> impl Iterator<Item = (u16, Range<usize>)> {
    interrupts.values().filter_map(|keys| keys.ob.as_ref()).map(|ob| (*ob.get_ref(), ob.span()))
}

/// Reports settings that the CPU does not have.
pub fn check(used: &Used, profile: &Profile) -> Vec<Diagnostic> {
    let board = profile::on_board(profile);
    let (counters, pulses) = board.map_or((0, 0), |board| (board.fast_counters, board.pulse_generators));
    let mut diagnostics = Vec::new();
    for (list, count, what) in [(&used.counters, counters, "fast counter"), (&used.pulses, pulses, "pulse generator")] {
        for (number, span) in list.iter().filter(|(number, _)| *number > count) {
            let title = format!("the CPU {} has no {what} {number}", profile.name);
            let help = match count {
                0 => format!("{what}s belong to CPUs of the S7-1200"),
                _ => format!("it has {what}s 1 to {count}"),
            };
            diagnostics.push(Diagnostic::new(Code::Project, *span, title).help(help));
        }
    }
    if !profile.family.is_portal()
        && let Some(span) = used.events.first()
    {
        let title = format!("the CPU {} has no named hardware interrupts", profile.name);
        let help = "its modules raise OB 40 to OB 47; a scenario provides the events";
        diagnostics.push(Diagnostic::new(Code::Project, *span, title).help(help));
    }
    diagnostics
}

struct Reader {
    file: FileId,
    used: Used,
    diagnostics: Vec<Diagnostic>,
}

impl Reader {
    fn span<T>(&self, key: &Spanned<T>) -> Span {
        Span::new(self.file, key.span())
    }

    fn report<T>(&mut self, key: &Spanned<T>, title: String, help: String) {
        self.diagnostics.push(Diagnostic::new(Code::Project, self.span(key), title).help(help));
    }

    fn number(&mut self, key: &Spanned<String>, most: u8, table: &str) -> Option<u8> {
        let number = key.get_ref().parse().ok().filter(|number| (1..=most).contains(number));
        if number.is_none() {
            let title = format!("`{}` is not a number from 1 to {most}", key.get_ref());
            self.report(key, title, format!("write `[{table}.1]`"));
        }
        number
    }

    /// The meaning of a word; otherwise a message with all words.
    fn word<T: Copy>(&mut self, key: &Spanned<String>, words: &[(&str, T)], what: &str) -> Option<T> {
        let found = words.iter().find(|(word, _)| word == key.get_ref()).map(|(_, value)| *value);
        if found.is_none() {
            let all: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
            let title = format!("`{}` is not {}", key.get_ref(), with_article(what));
            self.report(key, title, one_of(key.get_ref(), &all));
        }
        found
    }

    fn counter(&mut self, number: u8, keys: &HscKeys) -> Option<FastCounter> {
        let mode = match &keys.mode {
            Some(mode) => self.word(mode, CountMode::WORDS, "mode of a fast counter")?,
            None => CountMode::Single,
        };
        let down = match &keys.direction {
            Some(key) if mode != CountMode::Single => {
                self.report(key, "the inputs give the direction in this mode".to_string(), "leave it out".to_string());
                return None;
            }
            Some(key) => self.word(key, &[("up", false), ("down", true)], "direction")?,
            None => false,
        };
        let reset = match &keys.reset {
            Some(key) => Some(self.input(key)?),
            None => None,
        };
        let period_ms = match &keys.period {
            None => 1000,
            Some(key) => {
                let ms = duration_us(key.get_ref())
                    .and_then(|us| PERIODS_MS.into_iter().find(|ms| u64::from(*ms) * 1000 == us));
                let Some(ms) = ms.filter(|_| mode.is_measuring()) else {
                    let title = format!("`{}` is not a measuring period", key.get_ref());
                    let help = "modes \"frequency\" and \"period\" have \"10ms\", \"100ms\" or \"1s\"";
                    self.report(key, title, help.to_string());
                    return None;
                };
                ms
            }
        };
        let (initial, reference) = (keys.initial, keys.reference);
        Some(FastCounter { number, mode, down, initial, reference, reset, period_ms })
    }

    fn pulse(&mut self, number: u8, keys: &PulseKeys) -> Option<PulseGenerator> {
        let cycle_us = match &keys.cycle {
            None => 1000,
            Some(key) => {
                let us = duration_us(key.get_ref()).filter(|us| (1..=CYCLE_US_MAX).contains(us));
                let Some(us) = us else {
                    let title = format!("`{}` is not a cycle of a pulse generator", key.get_ref());
                    self.report(key, title, "write `\"10ms\"` or `\"500us\"`, up to 16.7 s".to_string());
                    return None;
                };
                us as u32
            }
        };
        let full = match &keys.unit {
            Some(unit) => self.word(unit, &WIDTHS, "unit of a pulse width")?,
            None => 100,
        };
        let initial = match &keys.width {
            Some(width) if *width.get_ref() > full => {
                let title = format!("{} is longer than the cycle", width.get_ref());
                self.report(width, title, format!("{full} is the whole cycle"));
                return None;
            }
            Some(width) => *width.get_ref(),
            None => full / 2,
        };
        Some(PulseGenerator { number, cycle_us, full, initial })
    }

    fn source(&mut self, name: &Spanned<String>, keys: &InterruptKeys, config: &Config) -> Option<EventSource> {
        match (&keys.input, &keys.hsc) {
            (Some(input), None) => {
                let falling = match &keys.edge {
                    Some(edge) => self.word(edge, &[("rising", false), ("falling", true)], "edge")?,
                    None => false,
                };
                let (byte, bit) = self.input(input)?;
                Some(EventSource::Edge { byte, bit, falling })
            }
            (None, Some(hsc)) => {
                let number = *hsc.get_ref();
                let Some(counter) = config.fast_counters.iter().find(|counter| counter.number == number) else {
                    self.report(hsc, format!("fast counter {number} is not enabled"), format!("add `[hsc.{number}]`"));
                    return None;
                };
                let words = [
                    ("reference", EventSource::Reference(number)),
                    ("direction", EventSource::Direction(number)),
                    ("reset", EventSource::Reset(number)),
                ];
                let Some(on) = &keys.on else {
                    let help = "add `on = \"reference\"`, \"direction\" or \"reset\"".to_string();
                    self.report(name, "the event of the fast counter is missing".to_string(), help);
                    return None;
                };
                let source = self.word(on, &words, "event of a fast counter")?;
                let possible = match source {
                    EventSource::Direction(_) => counter.mode.is_external(),
                    EventSource::Reset(_) => counter.reset.is_some(),
                    EventSource::Reference(_) => !counter.mode.is_measuring(),
                    EventSource::Edge { .. } => true,
                };
                if !possible {
                    let title = format!("fast counter {number} does not have this event");
                    self.report(on, title, "its mode does not allow it, or `reset` is missing".to_string());
                    return None;
                }
                Some(source)
            }
            (Some(_), Some(_)) | (None, None) => {
                let title = format!("`{}` has no source, or two", name.get_ref());
                self.report(name, title, "write either `input = \"I0.0\"` or `hsc = 1`".to_string());
                None
            }
        }
    }

    /// `I0.3`
    fn input(&mut self, key: &Spanned<String>) -> Option<(u32, u8)> {
        let text = key.get_ref().trim().trim_start_matches('%').to_ascii_uppercase();
        let parts = text.strip_prefix(['I', 'E']).and_then(|rest| rest.trim().split_once('.'));
        let found = parts.and_then(|(byte, bit)| Some((byte.parse::<u32>().ok()?, bit.parse::<u8>().ok()?)));
        let found = found.filter(|&(byte, bit)| byte < INPUT_BYTES && bit < 8);
        if found.is_none() {
            let title = format!("`{}` is not a bit of an input", key.get_ref());
            // `Q0.3`, `I0.8`: the same byte and bit if an input has them.
            let numbers: Vec<u32> =
                text.split(|c: char| !c.is_ascii_digit()).filter_map(|part| part.parse().ok()).collect();
            let help = match numbers.as_slice() {
                &[byte, bit @ 0..=7] if byte < INPUT_BYTES => format!("write `\"I{byte}.{bit}\"`"),
                &[byte] | &[byte, _] if byte < INPUT_BYTES => {
                    format!("write the byte and the bit, `\"I{byte}.0\"` to `\"I{byte}.7\"`")
                }
                _ => "write the byte and the bit of an input, such as `\"I0.0\"`".to_string(),
            };
            self.report(key, title, help);
        }
        found
    }
}

/// `500us`, `0.8ms`, `2s`.
fn duration_us(text: &str) -> Option<u64> {
    duration_of(text, 1000)
}
