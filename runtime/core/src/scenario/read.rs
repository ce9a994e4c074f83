//! A scenario's text: keys, values and messages with their lines.

use std::collections::BTreeMap;

use plcc_abi::ProgramImage;
use plcc_abi::image::{AssertType, BlockKind};
use plcc_abi::technology::CountMode;
use plcc_literal::distance::nearest;
use plcc_literal::toml_words;
use serde::Deserialize;
use toml::Spanned;

use super::line::{self, PortsText};
use super::{At, Pulses, PulsesAt, Scenario, Setting, When};
use crate::address;
use crate::analog;
use crate::events::{self, Event};
use crate::options::parse_duration;
use crate::plant::{Plant, PlantText};
use crate::s7200::PulseInput;
use crate::signal::{self, Signal, Source, Value};
use crate::typed::{self, ValueType};
use crate::value;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileText {
    #[serde(default)]
    at: Vec<Spanned<AtText>>,
    plant: Option<PlantText>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AtText {
    cycle: Option<u64>,
    time: Option<Spanned<String>>,
    #[serde(default)]
    set: BTreeMap<String, Spanned<toml::Value>>,
    #[serde(default)]
    plant: BTreeMap<String, Spanned<f64>>,
    event: Option<Spanned<toml::Value>>,
    #[serde(default)]
    receive: PortsText,
    #[serde(default, rename = "expect-sent", alias = "expect_sent")]
    sent: PortsText,
    #[serde(default)]
    pulses: BTreeMap<Spanned<String>, PulsesText>,
    #[serde(default)]
    expect: BTreeMap<String, Spanned<toml::Value>>,
    #[serde(default)]
    print: Vec<Spanned<String>>,
}

/// Pulses at an input or a counter.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PulsesText {
    count: u64,
    /// In hertz.
    frequency: f64,
    #[serde(default)]
    backward: bool,
}

/// Fastest pulses. Source: LAD/FBD reference for S7-1200, CPU limits; one input of a 1217C takes 1 MHz.
const FREQUENCY_MAX: f64 = 1e6;
const NS_PER_S: f64 = 1e9;

/// Reads a scenario. `Err`: message with file and line.
pub(super) fn parse(file: &str, text: &str, image: &ProgramImage) -> Result<Scenario, String> {
    let ends: Vec<usize> = text.match_indices('\n').map(|(at, _)| at).collect();
    let line = |offset: usize| ends.partition_point(|end| *end < offset) as u32 + 1;
    let raw: FileText = toml::from_str(text).map_err(|error| {
        let offset = error.span().map_or(0, |span| span.start);
        let (offset, wrong) = match toml_words::bare_literal(error.message(), text, offset) {
            Some((range, wrong)) => (range.start, wrong),
            None => {
                let own = foreign_key(error.message());
                (offset, own.unwrap_or_else(|| toml_words::plain_at(error.message(), text, offset)))
            }
        };
        format!("{file}:{}: {}; {}", line(offset), wrong.title, wrong.help)
    })?;
    let plant = raw.plant.as_ref().map(|plant| plant.plant(image, &line)).transpose();
    let plant = plant.map_err(|(offset, message)| format!("{file}:{}: {message}", line(offset)))?;
    let reader = Reader { file, line: &line, image, plant: plant.as_ref() };
    let entries = raw.at.into_iter().map(|entry| reader.entry(entry)).collect::<Result<_, _>>()?;
    Ok(Scenario { file: file.to_string(), entries, plant })
}

/// Keys that a scenario does not have, and where what they mean is written.
const FOREIGN_KEYS: [(&[&str], &str); 4] = [
    (
        &["cycle_time", "cycle-time", "cycletime"],
        "write `cycle_time` into plc.toml, or give `--cycle-time` on the command line",
    ),
    (&["cpu", "name", "sources", "symbols", "ob", "retain", "startup"], "write it into plc.toml"),
    (
        &["step", "steps", "entry", "entries", "when"],
        "each moment is a table `[[at]]` with `cycle = …` or `time = \"…\"`",
    ),
    (&["inputs", "outputs", "values"], "values are below `[[at]]`: `set = { \"I 0.0\" = true }`"),
];

/// Keys of `[[at]]`.
const OF_ENTRY: [&str; 9] = ["cycle", "time", "set", "event", "receive", "expect_sent", "pulses", "expect", "print"];

/// What to say of a key that another file has, or that is not below its heading.
fn foreign_key(message: &str) -> Option<toml_words::Wrong> {
    let (name, known) = message.strip_prefix("unknown field `")?.split_once('`')?;
    if OF_ENTRY.contains(&name) && known.contains("`at`") {
        let help = "write it below a heading `[[at]]`, with `cycle = …` or `time = \"…\"`".to_owned();
        return Some(toml_words::Wrong { title: format!("`{name}` is a key of a moment"), help });
    }
    let (_, help) = FOREIGN_KEYS.iter().find(|(keys, _)| keys.contains(&name))?;
    Some(toml_words::Wrong { title: format!("a scenario has no key `{name}`"), help: (*help).to_owned() })
}

/// A source, its value and the tolerance.
type Wanted = (Source, Value, f64);

struct Reader<'a> {
    file: &'a str,
    line: &'a dyn Fn(usize) -> u32,
    image: &'a ProgramImage,
    plant: Option<&'a Plant>,
}

impl Reader<'_> {
    fn error<T>(&self, offset: usize, message: &str) -> Result<T, String> {
        Err(format!("{}:{}: {message}", self.file, (self.line)(offset)))
    }

    fn entry(&self, entry: Spanned<AtText>) -> Result<At, String> {
        let start = entry.span().start;
        let entry = entry.into_inner();
        let when = match (entry.cycle, &entry.time) {
            (Some(cycle), None) => When::Cycle(cycle),
            (None, Some(time)) => match parse_duration(time.get_ref()) {
                Ok(duration) => When::Time(duration.0),
                Err(message) => return self.error(time.span().start, &message),
            },
            (None, None) => {
                return self
                    .error(start, "an entry says when it acts: add `cycle = 1`, or a time such as `time = \"100ms\"`");
            }
            (Some(_), Some(_)) => return self.error(start, "an entry has either `cycle` or `time`, not both"),
        };
        let mut print = Vec::new();
        for name in &entry.print {
            let found = signal::all(name.get_ref(), self.image, self.plant);
            print.extend(found.or_else(|message| self.error(name.span().start, &message))?);
        }
        let plant = entry.plant.iter().map(|(name, value)| {
            if self.plant.is_none() {
                return self.error(value.span().start, "there is no plant; a scenario defines one in `[plant]`");
            }
            let found = self.plant.and_then(|plant| plant.find_settable(name));
            match found.filter(|_| value.get_ref().is_finite()) {
                Some(index) => Ok((index, *value.get_ref())),
                None => {
                    self.error(value.span().start, &format!("`{name}` is neither a parameter nor a state of the plant"))
                }
            }
        });
        Ok(At {
            when,
            set: self.settings(&entry.set, Self::to_set)?,
            plant: plant.collect::<Result<_, _>>()?,
            event_line: entry.event.as_ref().map_or(0, |event| (self.line)(event.span().start)),
            event: entry.event.map(|event| self.event(&event)).transpose()?,
            receive: line::received(&entry.receive, self.image).or_else(|(at, message)| self.error(at, &message))?,
            sent: line::sent(&entry.sent, self.image, self.line).or_else(|(at, message)| self.error(at, &message))?,
            pulses: entry.pulses.iter().map(|(name, text)| self.pulses(name, text)).collect::<Result<_, _>>()?,
            expect: self.settings(&entry.expect, Self::to_expect)?,
            print,
        })
    }

    fn settings(
        &self,
        table: &BTreeMap<String, Spanned<toml::Value>>,
        setting: fn(&Self, &str, &str) -> Result<Wanted, String>,
    ) -> Result<Vec<Setting>, String> {
        let mut settings = Vec::new();
        let mut flat = Vec::new();
        for (name, value) in table {
            flatten(name, value.get_ref(), value.span().start, &mut flat);
        }
        for (name, value, offset) in flat {
            if value.is_array() {
                let message = format!(
                    "{name}: a list is not a value; name each element of an array, such as `{name}[1]`, and write a range as in `\"50 +- 2\"`"
                );
                return self.error(offset, &message);
            }
            let parsed = scalar_text(value).and_then(|text| setting(self, &name, &text));
            let (source, value, tolerance) = parsed.or_else(|message| match name.trim().is_empty() {
                true => self.error(offset, &message),
                false => self.error(offset, &format!("{name}: {message}")),
            })?;
            let signal = Signal { name, source };
            settings.push(Setting { signal, value, tolerance, line: (self.line)(offset) });
        }
        // In the order of the file.
        settings.sort_by_key(|setting| setting.line);
        Ok(settings)
    }

    /// `"I0.0" = 1`, `"AI0" = "12 mA"`, `"Station_DB.D1.Delay" = "T#5s"`.
    fn to_set(&self, name: &str, text: &str) -> Result<Wanted, String> {
        let source = Source::find(name, self.image, None)?;
        source.check_settable()?;
        if !is_text(&source, text)
            && let Some((middle, _)) = with_tolerance(text).split_once("+-")
        {
            return Err(format!("a tolerance is only for `expect`; write {}", middle.trim()));
        }
        Ok((source, source.parse(text, self.image)?, 0.0))
    }

    /// As to set, or with a tolerance: `"AO0" = "50 +- 2 %"`, `"Level" = "50 +- 0.5"`, `"plant.level" = 3.0`.
    fn to_expect(&self, name: &str, text: &str) -> Result<Wanted, String> {
        let source = Source::find(name, self.image, self.plant)?;
        let is_text = is_text(&source, text);
        let plain = if is_text { text.to_string() } else { with_tolerance(text) };
        let text = plain.as_str();
        if !is_text && ["!=", "<>"].iter().any(|sign| text.trim_start().starts_with(sign)) {
            return Err(format!("`{text}`: a comparison is not possible here; write the value that is expected"));
        }
        let compared = text.trim_start().strip_prefix(['<', '>', '=']).map(|rest| rest.trim_start_matches(['=', '>']));
        if let Some(number) = compared.map(str::trim).filter(|number| !is_text && !number.is_empty()) {
            return Err(format!(
                "`{text}`: a comparison is not possible here; write a value, with a tolerance as in `\"{number} +- 0.1\"`"
            ));
        }
        if let Some(meant) = range(text).filter(|_| !is_text) {
            return Err(format!("`{text}`: a range is written as its middle with a tolerance, as in `\"{meant}\"`"));
        }
        let Some((middle, tolerance)) = text.split_once("+-").filter(|_| !is_text) else {
            return Ok((source, source.parse(text, self.image)?, 0.0));
        };
        let number = |text: &str| text.trim().parse::<f64>().map_err(|_| format!("`{}` is not a number", text.trim()));
        if let Source::Typed(_, ty) = source
            && typed::is_duration(ty.ty)
        {
            // A number alone is in the unit of the type.
            let has_unit = tolerance.contains(|c: char| c.is_ascii_alphabetic());
            let ty = if has_unit { AssertType::Ltime } else { ty.ty };
            let tolerance = typed::parse(tolerance, ValueType::of(ty))?.seconds(ty);
            return Ok((source, source.parse(middle, self.image)?, tolerance.unwrap_or_default().abs()));
        }
        match (source, analog::with_unit(tolerance)) {
            (Source::Bits(address) | Source::Typed(address, _), Some((tolerance, unit))) => {
                let scale = signal::scale(&address, unit, self.image)?;
                Ok((Source::Channel(address, scale), Value::Number(number(middle)?), tolerance.abs()))
            }
            (Source::Bits(address), None) => Err(without_type(name, text.trim(), address.width.bits())),
            (
                Source::Typed(..)
                | Source::Channel(..)
                | Source::Plant(_)
                | Source::PulseDuty(_)
                | Source::PulsePeriod(_)
                | Source::PulseCount(_),
                _,
            ) => match source.parse(middle, self.image)?.number() {
                Some(middle) => Ok((source, Value::Number(middle), number(tolerance)?.abs())),
                None => Err(format!("a value of type {} has no tolerance", source.ty())),
            },
        }
    }

    fn pulses(&self, name: &Spanned<String>, text: &PulsesText) -> Result<Pulses, String> {
        let at = match self.image.s7200 {
            Some(_) => PulsesAt::S7200(self.pulse_input(name)?),
            None => PulsesAt::Counter(self.fast_counter(name, text)?),
        };
        if !(text.frequency > 0.0 && text.frequency <= FREQUENCY_MAX) {
            let message = format!("{} is not a frequency up to 1000000 Hz", text.frequency);
            return self.error(name.span().start, &message);
        }
        if matches!(at, PulsesAt::S7200(PulseInput::Input(_))) && text.backward {
            return self.error(name.span().start, "pulses at one input have no direction");
        }
        let period = ((NS_PER_S / text.frequency) as u64).max(1);
        let (name, line) = (name.get_ref().clone(), (self.line)(name.span().start));
        Ok(Pulses { at, name, line, count: text.count, period, backward: text.backward })
    }

    /// `I0.6`, a symbol of an input, `HSC1`.
    fn pulse_input(&self, name: &Spanned<String>) -> Result<PulseInput, String> {
        let text = name.get_ref();
        let upper = text.trim().to_ascii_uppercase();
        let digits = upper.strip_prefix("HSC").map(|rest| rest.strip_prefix('_').unwrap_or(rest));
        let counter = digits.and_then(|digits| digits.parse().ok()).and_then(PulseInput::counter);
        let input = || match address::resolve(text, self.image).ok()? {
            address::Address { place: address::Place::Input(byte), width: address::Width::Bit(bit) } => {
                PulseInput::input(byte, bit)
            }
            _ => None,
        };
        counter.or_else(input).ok_or(()).or_else(|()| {
            let message = format!("`{text}` takes no pulses; inputs from I0.0 to I1.7 do, and counters HSC0 to HSC5");
            self.error(name.span().start, &message)
        })
    }

    fn fast_counter(&self, name: &Spanned<String>, text: &PulsesText) -> Result<usize, String> {
        let upper = name.get_ref().to_ascii_uppercase();
        let number = upper.strip_prefix("LOCAL~").unwrap_or(&upper).strip_prefix("HSC_");
        let number = number.and_then(|digits| digits.parse::<u8>().ok());
        let counters = &self.image.config.fast_counters;
        let counter = number.and_then(|number| counters.iter().position(|counter| counter.number == number));
        let Some(counter) = counter else {
            let message =
                format!("plc.toml enables no fast counter `{}`; they are HSC_1, HSC_2 and so on", name.get_ref());
            return self.error(name.span().start, &message);
        };
        let mode = counters.get(counter).map(|counter| counter.mode);
        if text.backward && !mode.is_some_and(CountMode::is_external) {
            return self.error(name.span().start, "the inputs of this fast counter have no direction");
        }
        Ok(counter)
    }

    fn event(&self, event: &Spanned<toml::Value>) -> Result<Event, String> {
        if self.image.s7200.is_some() {
            let message =
                "no event starts an OB of an S7-200; its interrupts come from inputs, times, counters and ports";
            return self.error(event.span().start, message);
        }
        parse_event(event.get_ref(), self.image).or_else(|message| self.error(event.span().start, &message))
    }
}

/// `Station_DB.Starts = 1` is a table in a table for TOML: the names of both, with a point between.
fn flatten<'a>(name: &str, value: &'a toml::Value, offset: usize, flat: &mut Vec<(String, &'a toml::Value, usize)>) {
    match value {
        toml::Value::Table(inner) if !inner.is_empty() => {
            inner.iter().for_each(|(key, value)| flatten(&format!("{name}.{key}"), value, offset, flat));
        }
        value => flat.push((name.to_string(), value, offset)),
    }
}

/// What to write for the range `5..9`: `7 +- 2`; another example if its middle is not a whole number.
fn range(text: &str) -> Option<String> {
    let (low, high) = text.split_once("..")?;
    let (low, high) = (low.trim().parse::<f64>().ok()?, high.trim_start_matches('.').trim().parse::<f64>().ok()?);
    let (middle, half) = ((low + high) / 2.0, (high - low).abs() / 2.0);
    let is_plain = middle.fract() == 0.0 || low.fract() != 0.0 || high.fract() != 0.0;
    // The half of 20.7 - 19.5 is 0.6, not 0.5999999999999996.
    let number = |value: f64| format!("{value:.6}").trim_end_matches('0').trim_end_matches('.').to_string();
    Some(if is_plain { format!("{} +- {}", number(middle), number(half)) } else { "50 +- 0.5".to_string() })
}

/// Whether the value is a text, in which each sign is itself.
fn is_text(source: &Source, text: &str) -> bool {
    text.contains('\'') || matches!(source, Source::Typed(_, ty) if typed::bits(ty.ty).is_none())
}

/// The text with `+-` for `±` and `+/-`.
fn with_tolerance(text: &str) -> String {
    text.replace('±', "+-").replace("+/-", "+-")
}

/// What to write for a tolerance of an address without a type, with so many bits.
fn without_type(name: &str, text: &str, bits: u32) -> String {
    let ty = match (bits, text.contains('.')) {
        (1, _) => return "a bit has no tolerance: write `true` or `false`".to_string(),
        (8, _) => "SINT",
        (16, false) => "INT",
        (16, true) => return format!("a tolerance needs a type or a unit: write `\"{text} %\"` for an analog channel"),
        (32, false) => "DINT",
        (32, true) => "REAL",
        _ => "LREAL",
    };
    let quote = if name.contains('"') { '\'' } else { '"' };
    let channel = if bits == 16 { format!(", or `\"{text} %\"` for an analog channel") } else { String::new() };
    format!("a tolerance needs a type: write `{quote}{name} as {ty}{quote} = \"{text}\"`{channel}")
}

/// A TOML value as the text that `value::parse` takes.
fn scalar_text(value: &toml::Value) -> Result<String, String> {
    match value {
        toml::Value::Integer(number) => Ok(number.to_string()),
        toml::Value::Boolean(bit) => Ok(u8::from(*bit).to_string()),
        toml::Value::String(text) => Ok(text.clone()),
        toml::Value::Float(number) => Ok(format!("{number:?}")),
        toml::Value::Datetime(_) | toml::Value::Array(_) | toml::Value::Table(_) => {
            Err("a value is a number, true, false, or a text such as \"16#00FF\"".to_string())
        }
    }
}

/// The event that starts an OB; it is written `OB40`, or with the name of the block.
fn event_of(name: &str, image: &ProgramImage) -> Result<Event, String> {
    let text = name.trim().trim_matches('"');
    let upper = text.to_ascii_uppercase();
    let number = upper.strip_prefix("OB").and_then(|digits| digits.trim().parse::<u16>().ok());
    let obs = || image.blocks.iter().filter(|block| block.kind == BlockKind::Ob && !block.name.is_empty());
    let named = || obs().find(|block| block.name.to_lowercase() == text.to_lowercase()).map(|block| block.number);
    let event = |ob: u16| events::usual(ob, image.config.class_of(ob));
    number.or_else(named).and_then(event).ok_or_else(|| {
        let names = obs().filter(|block| event(block.number).is_some()).map(|block| block.name.as_str());
        let help = match nearest(text, names) {
            Some(near) => format!("did you mean `{near}`?"),
            None => "those are OB 10-17, 20-23, 30-38, 40-47, 55-57, 80-88 and interrupts from OB 123 on".to_string(),
        };
        format!("`{name}` is not an OB that an event starts; {help}")
    })
}

/// `"OB40"`, or a table with `ob` and fields of its start information.
fn parse_event(event: &toml::Value, image: &ProgramImage) -> Result<Event, String> {
    match event {
        toml::Value::String(name) => event_of(name, image),
        toml::Value::Table(table) => {
            let ob = table.get("ob").or_else(|| table.get("OB"));
            if let Some(toml::Value::Integer(number)) = ob {
                return Err(format!("the name of an OB is a text; write `ob = \"OB{number}\"`"));
            }
            let name = ob.and_then(toml::Value::as_str).ok_or("an event needs `ob = \"OB40\"`")?;
            let mut event = event_of(name, image)?;
            for (key, given) in table.iter().filter(|(key, _)| !key.eq_ignore_ascii_case("ob")) {
                let class = image.config.class_of(event.ob);
                let field = events::find_field(event.ob, class, key).ok_or_else(|| {
                    let names: Vec<&str> = events::field_names(event.ob, class).collect();
                    let help = match nearest(&key.to_ascii_uppercase(), names.iter().copied()) {
                        Some(near) => format!("did you mean `{near}`?"),
                        None => format!("it has {}", names.join(", ")),
                    };
                    format!("the start information of OB {} has no field `{key}`; {help}", event.ob)
                })?;
                let width = match field.bytes {
                    1 => address::Width::Byte,
                    2 => address::Width::Word,
                    _ => address::Width::Dword,
                };
                let bits = value::parse(&scalar_text(given)?, width).map_err(|message| format!("{key}: {message}"))?;
                let bytes = (bits as u32).to_be_bytes();
                event.info.0[field.offset..field.offset + field.bytes].copy_from_slice(&bytes[4 - field.bytes..]);
            }
            Ok(event)
        }
        toml::Value::Integer(number) => Err(format!("the name of an OB is a text; write `event = \"OB{number}\"`")),
        toml::Value::Float(_) | toml::Value::Boolean(_) | toml::Value::Datetime(_) | toml::Value::Array(_) => {
            Err("an event is a text such as \"OB40\", or a table with `ob`".to_string())
        }
    }
}
