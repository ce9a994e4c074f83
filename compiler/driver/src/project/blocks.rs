//! The settings of organization blocks: periods and phases, priorities, times of day.

use std::ops::Range;

use plcc_abi::image::{BlockKind, Config, TimeOfDay};
use plcc_abi::ob::{OB_CLASSES, OB_FREE, OB_NUMBER_MAX, ObClass};
use plcc_binding::similar;
use plcc_diag::{Code, Diagnostic, FileId, Severity, Span};
use plcc_model::Program;
use toml::Spanned;

use super::Context;
use super::keys::ObKeys;
use crate::cpu_settings::{self, CpuSetting};
use crate::keys::one_of;

/// `[ob."PID_Loop"]`: the settings of an organization block whose number is known when names are.
#[derive(Clone, Debug)]
pub struct NamedOb {
    file: FileId,
    name: Spanned<String>,
    keys: ObKeys,
}

/// Gives the organization blocks of a program the settings that plc.toml has for their names. `settings`: those of numbers. `is_whole`: a name
/// that no block has is a mistake.
pub fn set_named(
    named: &[NamedOb],
    settings: &[(CpuSetting, Span)],
    is_whole: bool,
    program: &mut Program,
) -> Vec<Diagnostic> {
    let mut messages = Vec::new();
    for NamedOb { file, name, keys } in named {
        let text = name.get_ref().as_str();
        let obs = || program.blocks.iter().filter(|block| block.kind == BlockKind::Ob);
        let Some(ob) = obs().find(|block| block.name.eq_ignore_ascii_case(text)).map(|block| block.number) else {
            if is_whole {
                let names = obs().map(|block| block.name.as_str()).filter(|name| !name.is_empty());
                let help = match similar(text, names) {
                    Some(near) => format!("is `[ob.\"{near}\"]` meant?"),
                    None => "write the name of an organization block, or its number, as in `[ob.35]`".to_string(),
                };
                let title = format!("the program has no organization block `{text}`");
                let mut message = Diagnostic::new(Code::Project, Span::new(*file, name.span()), title)
                    .label("these settings have no effect")
                    .help(help);
                message.severity = Severity::Warning;
                messages.push(message);
            }
            continue;
        };
        let mut context = Context { file: *file, of_cpu: Vec::new(), diagnostics: Vec::new() };
        if settings.iter().any(|(other, _)| *other == CpuSetting::Ob(ob)) {
            let title = format!("`{text}` is OB {ob}, which has settings below `[ob.{ob}]` too");
            context.report(name.span(), title, "write them below one heading");
        }
        if let Some(class) = &keys.class {
            let help = "remove `class`, and give the block the attribute `S7_EventClass`, such as 'CyclicInterrupt'";
            context.report(class.span(), format!("the block `{text}` itself says its class"), help);
        }
        let class = program.config.class_of(ob);
        context.block_settings(ob, name.span(), class, keys, &mut program.config);
        messages.extend(context.diagnostics);
        messages.extend(cpu_settings::check(&context.of_cpu, &program.profile));
    }
    messages
}

/// Codes of SFC 28 for the words of `every`. Source: SFC reference, SET_TINT.
const TIME_OF_DAY_PERIODS: [(&str, u16); 8] = [
    ("once", 0x0000),
    ("minute", 0x0201),
    ("hour", 0x0401),
    ("day", 0x1001),
    ("week", 0x1201),
    ("month", 0x1401),
    ("month end", 0x2001),
    ("year", 0x1801),
];

impl Context {
    /// Reads the settings of one organization block; those of one with a name are returned.
    pub(super) fn organization_block(
        &mut self,
        number: &Spanned<String>,
        keys: &ObKeys,
        config: &mut Config,
    ) -> Option<NamedOb> {
        let Ok(ob @ 1..=OB_NUMBER_MAX) = number.get_ref().parse::<u16>() else {
            let text = number.get_ref().as_str();
            let is_prefix = |letters: &&str| letters.eq_ignore_ascii_case("ob");
            let rest = text.get(..2).filter(is_prefix).map_or(text, |_| &text[2..]);
            if rest.contains(char::is_alphabetic) {
                return Some(NamedOb { file: self.file, name: number.clone(), keys: keys.clone() });
            }
            let title = format!("`{text}` is not a number of an organization block");
            // `[ob.OB35]`
            let digits = text.trim_start_matches(|c: char| !c.is_ascii_digit()).trim_end();
            let meant = digits.parse::<u16>().ok().filter(|ob| (1..=OB_NUMBER_MAX).contains(ob));
            let help = match meant {
                Some(ob) => format!("write `[ob.{ob}]`"),
                None => "write the number of the block, as in `[ob.35]`".to_string(),
            };
            self.report(number.span(), title, &help);
            return None;
        };
        let own = keys.class.as_ref().and_then(|class| self.class(ob, class));
        config.ob_classes.extend(own.map(|class| (ob, class)));
        self.block_settings(ob, number.span(), own.or(ObClass::of_number(ob)), keys, config);
        None
    }

    /// Reads the settings of OB `ob`, whose heading is at `place`.
    fn block_settings(
        &mut self,
        ob: u16,
        place: Range<usize>,
        class: Option<ObClass>,
        keys: &ObKeys,
        config: &mut Config,
    ) {
        self.note_of_cpu(CpuSetting::Ob(ob), place);
        // Without a class here, that of the block counts.
        let may_be = |wanted: ObClass| match class {
            Some(class) => class == wanted,
            None => ob >= OB_FREE,
        };
        let (cyclic, time_of_day) = (may_be(ObClass::Cyclic), may_be(ObClass::TimeOfDay));
        for (key, is_phase) in [(&keys.period, false), (&keys.phase, true)] {
            let Some(time) = key else { continue };
            if !cyclic {
                let help =
                    "OB 30 to OB 38 have a period and a phase, and so do OBs from 123 on with `class = \"cyclic\"`";
                self.report(time.span(), format!("OB {ob} is not cyclic"), help);
            } else if let Some(ms) = self.duration(time, if is_phase { 0..=60_000 } else { 1..=60_000 }) {
                let list = if is_phase { &mut config.cyclic_phase_ms } else { &mut config.cyclic_period_ms };
                // Blocks with names have a usual period.
                list.retain(|(number, _)| *number != ob);
                list.push((ob, ms));
            }
        }
        if let Some(priority) = &keys.priority {
            self.note_of_cpu(CpuSetting::Priority(ob, class), priority.span());
            config.priorities.extend(self.number(priority, 2..=24, "a priority").map(|priority| (ob, priority)));
        }
        match (&keys.start, &keys.every) {
            (None, None) => {}
            (Some(start), every) if time_of_day => {
                let period = self.time_of_day_period(every.as_ref());
                if !is_date_and_time(start.get_ref()) {
                    let title = format!("`{}` is not a date and time", start.get_ref());
                    let help = match meant_date(start.get_ref()) {
                        Some(meant) => format!("write `{meant}`"),
                        None => "write year, month, day and time, as in `2026-01-31T06:00:00`".to_string(),
                    };
                    return self.report(start.span(), title, &help);
                }
                config.time_of_day.push(TimeOfDay { ob, start: start.get_ref().clone(), period });
            }
            (Some(key), _) | (None, Some(key)) if !time_of_day => {
                self.report(
                    key.span(),
                    format!("OB {ob} is not a time-of-day interrupt"),
                    "OB 10 to OB 17 start at a time of day",
                );
            }
            (_, Some(key)) => {
                self.report(key.span(), "`every` without `start`", "write `start = \"2026-01-31T06:00:00\"`")
            }
            (Some(_), None) => {}
        }
    }

    /// The class of an OB from 123 on.
    fn class(&mut self, ob: u16, word: &Spanned<String>) -> Option<ObClass> {
        let free: Vec<_> = OB_CLASSES.iter().filter(|row| row.free).collect();
        let row = free.iter().find(|row| row.word == word.get_ref().as_str());
        if ob < OB_FREE || row.is_none() {
            let words: Vec<&str> = free.iter().map(|row| row.word).collect();
            let title = if ob < OB_FREE {
                format!("the number of OB {ob} determines its class")
            } else {
                format!("`{}` is not a class of OB {ob}", word.get_ref())
            };
            let help = format!("the classes of OB {OB_FREE} and above are {}", words.join(", "));
            self.report(word.span(), title, &help);
            return None;
        }
        row.map(|row| row.class)
    }

    fn time_of_day_period(&mut self, every: Option<&Spanned<String>>) -> u16 {
        let Some(every) = every else { return 0 };
        match TIME_OF_DAY_PERIODS.iter().find(|(word, _)| word == every.get_ref()) {
            Some((_, code)) => *code,
            None => {
                let words = TIME_OF_DAY_PERIODS.map(|(word, _)| word);
                let title = format!("`{}` is not a period of a time-of-day interrupt", every.get_ref());
                self.report(every.span(), title, &one_of(every.get_ref(), &words));
                0
            }
        }
    }
}

/// `2026-01-31T06:00:00` for `31.01.2026 06:00` and `2026-01-31 06:00`; nothing for `01/02/2026`, which may be of January or February, and
/// for `6:00 PM`.
fn meant_date(text: &str) -> Option<String> {
    if text.contains('/') || text.contains(|c: char| c.is_alphabetic() && !matches!(c, 'T' | 't' | 'Z' | 'z')) {
        return None;
    }
    let numbers = text.split(|c: char| !c.is_ascii_digit()).filter(|part| !part.is_empty());
    let numbers: Vec<u32> = numbers.map(|part| part.parse().ok()).collect::<Option<_>>()?;
    let (year, month, day, time) = match numbers.as_slice() {
        [day, month, year @ 1000..=u32::MAX, time @ ..] | [year @ 1000..=u32::MAX, month, day, time @ ..] => {
            (year, month, day, time)
        }
        _ => return None,
    };
    let part = |index: usize| time.get(index).copied().unwrap_or_default();
    let meant = format!("{year}-{month:02}-{day:02}T{:02}:{:02}:{:02}", part(0), part(1), part(2));
    (time.len() <= 3 && is_date_and_time(&meant)).then_some(meant)
}

fn is_date_and_time(text: &str) -> bool {
    match text.parse::<toml::value::Datetime>() {
        Ok(toml::value::Datetime { date: Some(date), time: Some(_), offset: None }) => {
            (1990..=2089).contains(&date.year)
        }
        Ok(_) | Err(_) => false,
    }
}
