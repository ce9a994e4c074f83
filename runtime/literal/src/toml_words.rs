//! What is wrong in a TOML file, in the words of its author rather than those of a reader of TOML.
//!
//! ```text
//! unknown field `nmae`, expected one of `name`, `cpu`   ──►   `nmae` is not a key here; help: write `name`
//! ```

mod headings;
mod literals;

use crate::distance;
pub use literals::bare_literal;

/// A message and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wrong {
    pub title: String,
    pub help: String,
}

/// Most keys in a help; of more, the ones that resemble the wrong one are named.
const KEYS_MAX: usize = 12;

/// Rewrites `message` of the library, which it reports at `offset` of `text`.
pub fn plain_at(message: &str, text: &str, offset: usize) -> Wrong {
    let offset = (0..=offset.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or_default();
    let start = text[..offset].rfind('\n').map_or(0, |at| at + 1);
    let end = text[offset..].find('\n').map_or(text.len(), |at| offset + at);
    if let Some(wrong) = headings::list_of_a_table(message, &text[start..end]) {
        return wrong;
    }
    if let Some(wrong) = headings::open_list(message, &text[..start], &text[start..end]) {
        return wrong;
    }
    if let Some(wrong) = headings::of_a_text(message, text, &text[start..end], end) {
        return wrong;
    }
    if let Some(wrong) = headings::without_name(message, &text[..start], &text[start..end]) {
        return wrong;
    }
    plain(message, text[offset..end].trim_end(), &text[start..end])
}

/// Rewrites `message` of the library. `place`: the text at the place of the error, up to the end of its line. `line`: its whole line.
pub fn plain(message: &str, place: &str, line: &str) -> Wrong {
    let message = message.lines().next().unwrap_or_default();
    let wrong = |title: String, help: String| Wrong { title, help };
    if message.starts_with("unknown field") && line.trim() == "[project]" {
        return wrong(
            "the keys of a project have no heading".to_owned(),
            "remove `[project]`: write its keys at the top of the file".to_owned(),
        );
    }
    if let Some((name, rest)) = quoted_after(message, "unknown field ") {
        return unknown("key here", "keys", name, &all_quoted(rest));
    }
    if let Some((name, rest)) = quoted_after(message, "unknown variant ") {
        let known = all_quoted(rest);
        let Wrong { title, help } = unknown("value here", "values", name, &known);
        return wrong(title, if known.is_empty() { "write another value".to_owned() } else { help });
    }
    if let Some((name, _)) = quoted_after(message, "missing field ") {
        return wrong(format!("the key `{name}` is missing here"), format!("add `{name} = …`"));
    }
    if let Some(rest) = message.strip_prefix("invalid type: ").or_else(|| message.strip_prefix("invalid value: ")) {
        let (found, wanted) = rest.rsplit_once(", expected ").unwrap_or((rest, "another value"));
        return wrong_type(found, wanted, line.trim());
    }
    if let Some((name, _)) = quoted_after(message, "duplicate field ") {
        return wrong(
            format!("the key `{name}` appears twice, under two names"),
            "remove one of them: both mean the same".to_owned(),
        );
    }
    if message.starts_with("duplicate key") {
        let key = place.split(['=', ']']).next().unwrap_or_default().trim();
        return wrong(format!("`{key}` appears twice"), "remove one of them".to_owned());
    }
    if message.starts_with("wanted string or table") {
        return no_word(line.split('#').next().unwrap_or_default());
    }
    syntax(message, place, line.trim())
}

/// `startup = 5`, where one of a few words is expected, which the library does not tell.
fn no_word(line: &str) -> Wrong {
    let (key, value) = line.split_once('=').unwrap_or((line, "this"));
    let (key, value) = (key.trim(), value.trim());
    let help = match key {
        "startup" => "write `startup = \"warm\"`; the others are `\"cold\"` and `\"hot\"`".to_owned(),
        "cycle_time_exceeded" => "write `cycle_time_exceeded = \"run\"`, or `\"stop\"`".to_owned(),
        key => format!("write `{key} = \"…\"`"),
    };
    Wrong { title: format!("a text in quotation marks is expected here, not {value}"), help }
}

/// The word between back quotes after `start`, and the rest.
fn quoted_after<'m>(message: &'m str, start: &str) -> Option<(&'m str, &'m str)> {
    message.strip_prefix(start)?.strip_prefix('`')?.split_once('`')
}

fn all_quoted(text: &str) -> Vec<&str> {
    text.split('`').skip(1).step_by(2).collect()
}

fn unknown(what: &str, plural: &str, name: &str, known: &[&str]) -> Wrong {
    // A key may be written with `_` and with `-`: the documents have `_`.
    let (other, own) = if name.contains('-') { ('_', "-") } else { ('-', "_") };
    let known: Vec<&str> = known
        .iter()
        .copied()
        .filter(|key| !key.contains(other) || !known.contains(&key.replace(other, own).as_str()))
        .collect();
    let known = known.as_slice();
    let title = format!("`{name}` is not a {what}");
    // `[ob35]` for `[ob.35]`.
    let numbered = known.iter().find(|key| {
        let rest = name.strip_prefix(**key).map(|rest| rest.trim_start_matches(['_', '-', ' ']));
        rest.is_some_and(|rest| !rest.is_empty() && rest.bytes().all(|digit| digit.is_ascii_digit()))
    });
    let meant = MEANT.iter().find(|(word, own)| word.eq_ignore_ascii_case(name) && known.contains(own));
    // `max_cycle_time` for `cycle_time_max`.
    let words = |key: &str| {
        let mut words: Vec<String> = key.split(['_', '-', ' ']).map(str::to_ascii_lowercase).collect();
        words.sort_unstable();
        words
    };
    let own_words = words(name);
    let turned = known.iter().copied().find(|key| words(key) == own_words);
    let near = meant.map(|(_, own)| *own).or(turned).or_else(|| distance::nearest(name, known.iter().copied()));
    let help = match (numbered, near) {
        (Some(key), _) => format!("write `{key}.{}`", name[key.len()..].trim_start_matches(['_', '-', ' '])),
        (None, Some(near)) => format!("write `{near}`"),
        (None, None) if known.is_empty() => "remove it".to_owned(),
        (None, None) if known.len() <= KEYS_MAX => format!("the {plural} are {}", known.join(", ")),
        (None, None) => {
            let begin = |key: &&&str| key.bytes().next().map(|c| c.to_ascii_lowercase()) == first_letter(name);
            let alike: Vec<&str> = known.iter().filter(begin).copied().collect();
            let list = if alike.is_empty() { known } else { &alike };
            format!("remove it, or write one of the {plural} that plcc has, such as {}", list.join(", "))
        }
    };
    Wrong { title, help }
}

/// Other words for values.
const MEANT: [(&str, &str); 7] = [
    ("german", "de"),
    ("deutsch", "de"),
    ("english", "en"),
    ("international", "en"),
    ("OB100", "warm"),
    ("OB101", "hot"),
    ("OB102", "cold"),
];

fn first_letter(name: &str) -> Option<u8> {
    name.bytes().next().map(|letter| letter.to_ascii_lowercase())
}

/// Whether the key of a line has a duration: `cycle_time = 100`, `period = 50`.
fn is_of_time(line: &str) -> bool {
    let key = line.split('=').next().unwrap_or_default().trim().trim_matches('"').to_ascii_lowercase();
    let key = key.rsplit('.').next().unwrap_or_default();
    matches!(key, "cycle" | "step" | "poll")
        || ["time", "period", "offset", "timeout", "delay", "interval", "phase"].iter().any(|word| key.contains(word))
}

/// `found`: `integer `50``, `string "x"`, `map`; `wanted`: `a string`, `a sequence`, `i64`.
fn wrong_type(found: &str, wanted: &str, line: &str) -> Wrong {
    let (kind, value) = found.split_once(' ').unwrap_or((found, ""));
    let value = value.trim_matches('`');
    let text = value.trim_matches('"');
    let is = match kind {
        "integer" | "floating" => format!("the number {}", value.trim_start_matches("point `").trim_matches('`')),
        "string" => format!("the text {value}"),
        "boolean" => value.to_owned(),
        "sequence" => "a list".to_owned(),
        "map" => "a table".to_owned(),
        _ => found.to_owned(),
    };
    let number = || text.trim().trim_start_matches(|c: char| c.is_ascii_alphabetic()).trim();
    let (expected, help) = match wanted {
        "a string" | "string" => match kind {
            "integer" | "floating" => {
                let number = is.trim_start_matches("the number ");
                if is_of_time(line) {
                    // A fraction is of a second: a time is a whole number of milliseconds.
                    let unit = if number.parse::<f64>().is_ok_and(|time| time.fract() != 0.0) { "s" } else { "ms" };
                    ("a time with its unit", format!("write `\"{number}{unit}\"`"))
                } else if let Some((key, usual)) =
                    port_of(line).filter(|_| !number.parse::<u16>().is_ok_and(|port| port > 0))
                {
                    ("a port in quotation marks", format!("ports are 1 to 65535: write `{key} = \"{usual}\"`"))
                } else {
                    ("a text in quotation marks", format!("write `\"{number}\"`"))
                }
            }
            "boolean" => (expected_for_switch(line), switch_help(line, value == "true")),
            // A date is a table for the library.
            "map" if let Some(date) = date_of(line) => {
                return Wrong {
                    title: "a text in quotation marks is expected here, not a date".to_owned(),
                    help: format!("write `\"{date}\"`"),
                };
            }
            _ => ("a text in quotation marks", "write `\"…\"`".to_owned()),
        },
        "a sequence" | "a list" if kind == "map" => {
            let name = line.trim_start_matches('[').split(']').next().unwrap_or_default();
            let heading = line.starts_with('[') && !name.is_empty();
            let written =
                if heading { format!("write `[[{name}]]`") } else { "write `[` and `]` around it".to_owned() };
            ("a list of tables", written)
        }
        "a sequence" | "a list" => ("a list", format!("write `[{value}]`")),
        "a boolean" => {
            let yes = ["yes", "on", "1", "true"].iter().any(|word| word.eq_ignore_ascii_case(text));
            let no = ["no", "off", "0", "false"].iter().any(|word| word.eq_ignore_ascii_case(text));
            let help = match (yes, no) {
                (true, _) => "write `true`, without quotation marks",
                (_, true) => "write `false`, without quotation marks",
                _ => "write `true` or `false`, without quotation marks",
            };
            ("true or false", help.to_owned())
        }
        wanted if is_number(wanted) => {
            let expected = match wanted.as_bytes()[0] {
                b'u' => "a whole number, 0 or more,",
                b'i' => "a whole number",
                _ => "a number",
            };
            let help = match number().parse::<f64>() {
                Ok(_) if kind == "string" => format!("write `{}`", number()),
                _ if kind == "integer" || kind == "floating" => {
                    number_in_range(is.trim_start_matches("the number "), wanted)
                }
                _ => "write digits, without quotation marks".to_owned(),
            };
            (expected, help)
        }
        wanted if wanted.contains("map") || wanted.contains("struct") => {
            let key = line.split('=').next().unwrap_or_default().trim();
            if matches!(key, "inputs" | "outputs") {
                return Wrong {
                    title: format!("the addresses are expected here, not {is}"),
                    help: address_range(key, kind, text),
                };
            }
            let plain =
                !key.is_empty() && key.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"_-.".contains(&byte));
            let heading = if plain { format!("`[{key}]`") } else { "`[…]`".to_owned() };
            let is_setting = matches!(key, "set" | "expect" | "plant");
            let text = if kind == "sequence" { line.split('"').nth(1).unwrap_or_default() } else { text };
            let help = match text.split_once('=').filter(|_| plain && (kind == "string" || is_setting)) {
                // `set = "I0.0 = 1"`, `set = ["I0.0 = 1"]`
                Some((name, value)) => {
                    format!("write `{key} = {{ \"{}\" = {} }}`", name.trim_end_matches([':', ' ']).trim(), value.trim())
                }
                None if is_setting => {
                    let is_name = matches!(kind, "string" | "sequence") && !text.is_empty();
                    let name = if is_name { text } else { "I0.0" };
                    format!("write the value to each name, as in `{key} = {{ \"{name}\" = 1 }}`")
                }
                None => format!("write its keys below {heading}, or between `{{` and `}}`"),
            };
            ("a table", help)
        }
        wanted if let Some(count) = wanted.strip_prefix("an array of length ") => {
            let key = line.split('=').next().unwrap_or_default().trim();
            let first = if value.is_empty() { "…" } else { value };
            return Wrong {
                title: format!("a list of {count} values is expected here, not {is}"),
                help: format!("write `{key} = [{first}, …]`"),
            };
        }
        wanted => (wanted, "write a value of that kind".to_owned()),
    };
    Wrong { title: format!("{expected} is expected here, not {is}"), help }
}

/// The value of a line that is a date, `start = 2026-01-31T06:00:00`, as texts have it.
fn date_of(line: &str) -> Option<String> {
    let value = line.split_once('=')?.1.split('#').next()?.trim();
    let is_date = value.starts_with(|c: char| c.is_ascii_digit()) && value.contains(['-', ':']);
    is_date.then(|| value.replace(' ', "T"))
}

/// The number of a port that each service of `[services]` usually has.
const PORTS: [(&str, u16); 5] = [("s7", 102), ("modbus", 502), ("opcua", 4840), ("metrics", 9100), ("web", 8080)];

fn port_of(line: &str) -> Option<(&'static str, u16)> {
    let key = line.split('=').next().unwrap_or_default().trim();
    PORTS.into_iter().find(|(service, _)| *service == key)
}

/// What belongs where `true` or `false` is.
fn expected_for_switch(line: &str) -> &'static str {
    if port_of(line).is_some() { "a port in quotation marks" } else { "a text in quotation marks" }
}

/// What to write for `s7 = true`, `file = true`: the word itself as a text would be an address or a file of that name.
fn switch_help(line: &str, on: bool) -> String {
    let key = line.split('=').next().unwrap_or_default().trim();
    match port_of(line) {
        Some((key, port)) if on => {
            format!(
                "write `{key} = \"{port}\"` for clients on this computer, `{key} = \"0.0.0.0:{port}\"` for those of the network"
            )
        }
        Some((key, _)) => format!("remove `{key}`: without it, the service is not open"),
        None if key.is_empty() || on => format!("write `{key} = \"…\"`"),
        None => format!("remove `{key}`, or write `{key} = \"…\"`"),
    }
}

/// How the addresses of a module are written: for `inputs = 4` and `inputs = "4..7"`.
fn address_range(key: &str, kind: &str, text: &str) -> String {
    let ends = text.split_once("..").or_else(|| text.split_once('-'));
    let number = |text: &str| text.trim().parse::<u32>().ok();
    let range = ends.and_then(|(low, high)| Some((number(low)?, number(high)?))).filter(|(low, high)| low <= high);
    match (range, number(text)) {
        (Some((low, high)), _) => {
            format!("write `{key} = {{ start = {low}, bytes = {} }}`", u64::from(high - low) + 1)
        }
        (None, Some(start)) if kind == "integer" => {
            format!("write `{key} = {{ start = {start}, bytes = … }}`: the first byte and the number of bytes")
        }
        _ => format!("write `{key} = {{ start = …, bytes = … }}`: the first byte and the number of bytes"),
    }
}

/// What to write for a number that the key cannot have; `wanted`: `u8`, `i64`, `f64`.
fn number_in_range(number: &str, wanted: &str) -> String {
    let value = number.parse::<f64>().unwrap_or_default();
    let unsigned = wanted.starts_with('u');
    match wanted[1..].parse::<u32>() {
        _ if wanted.starts_with('f') => "write a number".to_owned(),
        _ if unsigned && value < 0.0 => "write 0 or a larger number".to_owned(),
        _ if value.fract() != 0.0 => format!("write `{}` or `{}`", value.floor(), value.ceil()),
        _ if number.contains('.') => format!("write `{value}`"),
        Ok(bits @ 1..=32) if unsigned => format!("write a number from 0 to {}", (1u64 << bits) - 1),
        Ok(bits @ 1..=32) => format!("write a number from -{0} to {1}", 1u64 << (bits - 1), (1u64 << (bits - 1)) - 1),
        _ => "write another number".to_owned(),
    }
}

fn is_number(wanted: &str) -> bool {
    let mut letters = wanted.chars();
    matches!(letters.next(), Some('i' | 'u' | 'f')) && letters.as_str().parse::<u8>().is_ok()
}

/// How many colons of a line are looked at.
const COLONS_MAX: usize = 50;

/// What other languages write: `key := value`, `key = value;`, `{ "key": value }`; and a text in single quotes that is not closed.
fn habit(line: &str) -> Option<Wrong> {
    let wrong = |title: &str, help: String| Some(Wrong { title: title.to_owned(), help });
    let plain = line.split(" #").next().unwrap_or_default().trim();
    let in_text = |at: usize| plain[..at].matches('"').count() % 2 == 1;
    if plain.find(":=").is_some_and(|at| !in_text(at)) {
        return wrong("a key and its value are joined by `=`", format!("write `{}`", plain.replace(":=", "=")));
    }
    if let Some(at) = plain.find("==").filter(|at| !in_text(*at)) {
        let meant = format!("{}={}", &plain[..at], &plain[at + 2..]);
        return wrong("a key and its value are joined by `=`", format!("write `{meant}`"));
    }
    // `{ "I0.0" : 1 }`
    let colon = plain
        .match_indices(':')
        .take(COLONS_MAX)
        .map(|(at, _)| at)
        .find(|at| plain[..*at].trim_end().ends_with('"') && !in_text(*at));
    if let Some(at) = colon.filter(|_| !plain.starts_with('{')) {
        let (key, value) = (plain[..at].trim_end(), plain[at + 1..].trim_start());
        return wrong("a key and its value are joined by `=`", format!("write `{key} = {value}`"));
    }
    if plain.ends_with(';') && plain.starts_with(|c: char| c == '[' || c.is_alphanumeric()) {
        return wrong("a line has no `;` at its end", format!("write `{}`", plain.trim_end_matches(';').trim_end()));
    }
    if plain.starts_with('{') && plain.contains("\":") {
        return wrong("the file is not JSON", "write each key on a line of its own, `key = value`".to_owned());
    }
    let value = plain.split_once('=').map_or("", |(_, value)| value.trim());
    if value.starts_with('\'') && value.matches('\'').count() == 1 {
        return wrong("the text is not closed on its line", format!("write `{plain}'`"));
    }
    None
}

/// An error in the form of the file.
fn syntax(message: &str, place: &str, line: &str) -> Wrong {
    let wrong = |title: &str, help: String| Wrong { title: title.to_owned(), help };
    let key = line.split(['=', ':']).next().unwrap_or_default().trim();
    let comment = ["//", "--", "/*", ";"].into_iter().find_map(|sign| line.trim_start().strip_prefix(sign));
    if let Some(text) = comment {
        return wrong("a comment begins with `#`", format!("write `# {}`", text.trim_end_matches("*/").trim()));
    }
    if message.contains("escape") {
        let line = line.trim().replace("\\\\", "/").replace('\\', "/");
        return wrong("`\\` begins a special character in a text", format!("write `{line}`: `/` is between folders"));
    }
    if let Some(told) = habit(line) {
        return told;
    }
    if place == "," {
        let line = line.trim_end_matches(',').trim_end();
        return wrong("a line has no `,` at its end", format!("write `{line}`"));
    }
    // `expect = { "MW10" > 5 }`
    if message.contains("missing assignment") && place.starts_with(['<', '>']) {
        return wrong(
            "a key has a value, not a comparison",
            "write `key = value`; a value may have a tolerance, as in `\"5 +- 1\"`".to_owned(),
        );
    }
    // `cpu = 315-2DP` begins as a date does.
    let unquoted = message.contains("invalid date") || message.contains("invalid time");
    if unquoted
        || message.contains("must be quoted")
        || message.contains("literal string")
        || message.contains("unquoted")
    {
        let value = line.split_once('=').map_or(place, |(_, value)| value).split('#').next().unwrap_or_default().trim();
        // Those that word processors write.
        let value = value.trim_matches(['“', '”', '„', '‘', '’', '«', '»']);
        if let Some(told) = headings::ends_with_point(line).or_else(|| headings::without_key(line)) {
            return told;
        }
        if key.is_empty() && line.starts_with('=') {
            return wrong("the key is missing before `=`", format!("write `key {line}`"));
        }
        if let Some(inner) = value.strip_prefix('(').and_then(|value| value.strip_suffix(')')) {
            let quoted = |part: &str| format!("\"{}\"", part.trim());
            let list = match inner.contains(['"', '\'']) || inner.trim().is_empty() {
                true => inner.to_owned(),
                false => inner.split(',').map(quoted).collect::<Vec<_>>().join(", "),
            };
            return wrong("a list is written in brackets", format!("write `{key} = [{list}]`"));
        }
        if !value.is_empty() && !value.starts_with(['"', '\'', '[', '{']) {
            if matches!(key, "sources" | "symbols" | "print" | "values" | "equations") {
                return wrong("a text is written in quotation marks", format!("write `{key} = [\"{value}\"]`"));
            }
            return wrong("a text is written in quotation marks", format!("write `{key} = \"{value}\"`"));
        }
        let word = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '#' | '-' | '%');
        let value = &place[..place.find(|c| !word(c)).unwrap_or(place.len())];
        let lower = value.to_ascii_lowercase();
        let truth = [("on", "true"), ("yes", "true"), ("off", "false"), ("no", "false")];
        if let Some((_, meant)) = truth.into_iter().find(|(own, _)| *own == lower) {
            return wrong(&format!("`{value}` is not a value"), format!("write `{meant}`"));
        }
        let written = if value.is_empty() { "…" } else { value };
        return wrong("a text is written in quotation marks", format!("write `\"{written}\"`"));
    }
    if message.contains("key with no value") {
        if let Some((key, "")) = line.split_once(':') {
            let key = key.trim();
            return wrong(
                "a key and its value are joined by `=`",
                format!("write `{key} = …`, or the heading `[{key}]` before several keys"),
            );
        }
        if let Some((key, value)) = line.split_once(':') {
            return wrong(
                "a key and its value are joined by `=`",
                format!("write `{} = {}`", key.trim(), value.trim()),
            );
        }
        // `cpu "s7-300"`
        let parts = line.split_once(char::is_whitespace).map(|(key, value)| (key, value.trim()));
        let is_key = |key: &str| key.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"_-.".contains(&byte));
        if let Some((key, value)) = parts.filter(|(key, value)| is_key(key) && value.starts_with(['"', '\'', '[', '{']))
        {
            return wrong("`=` is missing between the key and its value", format!("write `{key} = {value}`"));
        }
        return wrong("this key has no value", format!("write `{key} = …`"));
    }
    if message.contains("basic string") || message.contains("literal string") {
        return wrong("the text is not closed on its line", "close it with `\"`".to_owned());
    }
    if message.contains("missing comma") || message.contains("extra assignment") {
        return wrong("a comma is missing before this", "separate the parts by `,`".to_owned());
    }
    if message.contains("unclosed array") {
        return wrong("the list is not closed", "close it with `]`".to_owned());
    }
    if message.contains("unclosed inline table") {
        return wrong("the table is not closed", "close it with `}`".to_owned());
    }
    if message.contains("unclosed table") {
        return wrong("the heading is not closed", format!("write `{}]`", line.trim_end_matches(']')));
    }
    if message.contains("missing value") || message.contains("missing assignment value") {
        return wrong("the value is missing", format!("write `{key} = …`"));
    }
    let words = ["true", "false"].map(|word| line.to_ascii_lowercase().contains(word).then_some(word));
    if message.contains("invalid boolean")
        && let Some(word) = words.into_iter().flatten().next()
    {
        return wrong("true and false are written in small letters here", format!("write `{word}`"));
    }
    let told = message.split(", expected").next().unwrap_or(message);
    wrong(&format!("this is not TOML: {told}"), "write `key = value`, with texts in quotation marks".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(message: &str, line: &str) -> (String, String) {
        let Wrong { title, help } = plain(message, line, line);
        (title, help)
    }

    fn same(message: &str, line: &str, title: &str, help: &str) {
        assert_eq!(of(message, line), (title.to_owned(), help.to_owned()));
    }

    #[test]
    fn names_the_nearest_key() {
        let known = "expected one of `name`, `cpu`, `ob`";
        same(&format!("unknown field `nmae`, {known}"), "", "`nmae` is not a key here", "write `name`");
        same(&format!("unknown field `ob35`, {known}"), "", "`ob35` is not a key here", "write `ob.35`");
        same(&format!("unknown field `speed`, {known}"), "", "`speed` is not a key here", "the keys are name, cpu, ob");
        same(
            "unknown variant `warmm`, expected one of `warm`, `hot`",
            "",
            "`warmm` is not a value here",
            "write `warm`",
        );
        let (title, help) =
            ("the keys of a project have no heading", "remove `[project]`: write its keys at the top of the file");
        assert_eq!(of(&format!("unknown field `project`, {known}"), "[project]"), (title.to_owned(), help.to_owned()));
        same("missing field `slot`", "", "the key `slot` is missing here", "add `slot = …`");
        let twice = "expected one of `every`, `bit-memory`, `bit_memory`";
        same(&format!("unknown field `bitmemory`, {twice}"), "", "`bitmemory` is not a key here", "write `bit_memory`");
        same(&format!("unknown field `bit-memry`, {twice}"), "", "`bit-memry` is not a key here", "write `bit-memory`");
    }

    #[test]
    fn headings_of_texts_become_keys() {
        let text = "name = \"a\"\n[cpu]\n# which\ntype = \"315-2 DP\"\n";
        let wrong = plain_at("invalid type: map, expected a string", text, 11);
        assert_eq!(wrong.title, "`cpu` is a key with a text, not a heading");
        assert_eq!(wrong.help, "write `cpu = \"315-2 DP\"` at the top of the file, before the first heading");
    }

    #[test]
    fn one_table_is_no_list() {
        let told = |text: &str| plain_at("invalid type: map, expected a string", text, 0);
        let Wrong { title, help } = told("[[retain]]\nfile = \"a\"\n");
        assert_eq!((title.as_str(), help.as_str()), ("`retain` is one table, not a list of them", "write `[retain]`"));
        assert_eq!(told("[[ob.35]]\nperiod = \"5ms\"\n").help, "write `[ob.35]`");
        assert_eq!(told("[[ob]]\nnumber = 35\n").help, "write `[ob.35]`");
    }

    #[test]
    fn lists_that_are_not_closed_are_told() {
        let comma = "missing comma between array elements, expected `,`";
        let told = |text: &str, at: usize| plain_at(comma, text, at);
        let Wrong { title, help } = told("sources = [\"a.stl\"\nname = \"b\"\n", 20);
        assert_eq!(title, "the list before this line is not closed");
        assert_eq!(help, "write `sources = [\"a.stl\"]`");
        assert_eq!(told("sources = [\n\"a.stl\",\n[retain]\n", 22).help, "write `]` after `\"a.stl\"`");
        assert_eq!(told("sources = [\"a.stl\",\n[[retain]]\nfile = \"a\"\n", 32).help, "write `sources = [\"a.stl\"]`");
        assert_eq!(told("sources = [\"a.stl\" \"b.stl\"]\n", 19).title, "a comma is missing before this");
    }

    #[test]
    fn keys_with_their_words_in_another_order_are_found() {
        let known = "expected one of `cycle_time`, `cycle_time_max`, `clock_memory`";
        let title = "`max_cycle_time` is not a key here";
        same(&format!("unknown field `max_cycle_time`, {known}"), "", title, "write `cycle_time_max`");
    }

    #[test]
    fn tells_types_in_plain_words() {
        let string = "invalid type: integer `50`, expected a string";
        same(string, "", "a text in quotation marks is expected here, not the number 50", "write `\"50\"`");
        same(string, "cycle_time = 50", "a time with its unit is expected here, not the number 50", "write `\"50ms\"`");
        let fraction = "invalid type: floating point `0.01`, expected a string";
        let second = "a time with its unit is expected here, not the number 0.01";
        same(fraction, "cycle_time = 0.01", second, "write `\"0.01s\"`");
        let list = "invalid type: sequence, expected a map";
        let each = "write the value to each name, as in `set = { \"I0.0\" = 1 }`";
        same(list, "set = [\"I0.0\"]", "a table is expected here, not a list", each);
        let date = "invalid type: map, expected a string";
        let title = "a text in quotation marks is expected here, not a date";
        same(date, "start = 2026-01-31 06:00:00", title, "write `\"2026-01-31T06:00:00\"`");
        let array = "invalid type: integer `1000`, expected an array of length 2";
        let two = "a list of 2 values is expected here, not the number 1000";
        same(array, "raw = 1000", two, "write `raw = [1000, …]`");
        let table = "invalid type: map, expected an array of length 2";
        same(table, "raw = { low = 1 }", "a list of 2 values is expected here, not a table", "write `raw = […, …]`");
        let pair = "write `expect = { \"Q0.0\" = 1 }`";
        same(list, "expect = [\"Q0.0 = 1\"]", "a table is expected here, not a list", pair);
        let list = "invalid type: map, expected a sequence";
        same(list, "[at]", "a list of tables is expected here, not a table", "write `[[at]]`");
        let table = "invalid type: boolean `true`, expected struct Retain";
        let below = "write its keys below `[retain]`, or between `{` and `}`";
        same(table, "retain = true", "a table is expected here, not true", below);
        let list = "invalid type: string \"main.stl\", expected a sequence";
        same(list, "", "a list is expected here, not the text \"main.stl\"", "write `[\"main.stl\"]`");
        let byte = "invalid type: string \"MB 100\", expected i64";
        same(byte, "", "a whole number is expected here, not the text \"MB 100\"", "write `100`");
        let module = "invalid type: integer `8`, expected struct AddressKeys";
        let bytes = "write `inputs = { start = 8, bytes = … }`: the first byte and the number of bytes";
        same(module, "inputs = 8", "the addresses are expected here, not the number 8", bytes);
        let module = "invalid type: string \"4..7\", expected struct AddressKeys";
        let bytes = "write `outputs = { start = 4, bytes = 4 }`";
        same(module, "outputs = \"4..7\"", "the addresses are expected here, not the text \"4..7\"", bytes);
        let words = "write `startup = \"warm\"`; the others are `\"cold\"` and `\"hot\"`";
        same("wanted string or table", "startup = 5 # s", "a text in quotation marks is expected here, not 5", words);
        let switch = "invalid type: boolean `true`, expected a string";
        let port = "write `s7 = \"102\"` for clients on this computer, `s7 = \"0.0.0.0:102\"` for those of the network";
        same(switch, "s7 = true", "a port in quotation marks is expected here, not true", port);
        same(switch, "file = true", "a text in quotation marks is expected here, not true", "write `file = \"…\"`");
        let yes = "invalid type: string \"yes\", expected a boolean";
        same(yes, "", "true or false is expected here, not the text \"yes\"", "write `true`, without quotation marks");
    }

    #[test]
    fn tells_which_numbers_are_possible() {
        let number = |message: &str| of(message, "").1;
        assert_eq!(number("invalid value: integer `-1`, expected u64"), "write 0 or a larger number");
        assert_eq!(number("invalid value: integer `300`, expected u8"), "write a number from 0 to 255");
        assert_eq!(number("invalid type: floating point `1.5`, expected u64"), "write `1` or `2`");
        let table = "invalid type: string \"I0.0 = 1\", expected a map";
        assert_eq!(of(table, "set = \"I0.0 = 1\"").1, "write `set = { \"I0.0\" = 1 }`");
    }

    #[test]
    fn knows_habits_of_other_languages() {
        let joined = "a key and its value are joined by `=`";
        let missing = "missing assignment between key-value pairs, expected `=`";
        same(missing, "set = { \"I0.1\" := 1 }", joined, "write `set = { \"I0.1\" = 1 }`");
        same("key with no value, expected `=`", "cpu := \"1214C\"", joined, "write `cpu = \"1214C\"`");
        same("unexpected key or value", "cycle = 5;", "a line has no `;` at its end", "write `cycle = 5`");
        same("invalid literal string", "name = 'p", "the text is not closed on its line", "write `name = 'p'`");
        let heading = "write `at = …`, or the heading `[at]` before several keys";
        same("key with no value, expected `=`", "at:", joined, heading);
    }

    #[test]
    fn headings_say_which_one() {
        let text = "[axis]\nmax_velocity = 5\n";
        let wrong = plain_at("invalid type: integer `5`, expected struct AxisKeys", text, 22);
        assert_eq!(
            (wrong.title.as_str(), wrong.help.as_str()),
            ("`[axis]` does not say which one", "write `[axis.Axis_1]`")
        );
    }

    #[test]
    fn numbers_below_a_heading_and_ports_are_told() {
        let text = "[ob]\n30 = \"50ms\"\n";
        let wrong = plain_at("invalid type: string \"50ms\", expected struct ObKeys", text, 10);
        assert_eq!(wrong.help, "write `[ob.30]`, and its keys below it");
        let port = "invalid type: integer `99999`, expected a string";
        let title = "a port in quotation marks is expected here, not the number 99999";
        same(port, "web = 99999", title, "ports are 1 to 65535: write `web = \"8080\"`");
    }

    #[test]
    fn proposes_what_is_meant() {
        let languages = "unknown variant `german`, expected `en` or `de`";
        same(languages, "", "`german` is not a value here", "write `de`");
        let missing = "`=` is missing between the key and its value";
        same("key with no value, expected `=`", "cpu \"s7-300\"", missing, "write `cpu = \"s7-300\"`");
        let joined = "a key and its value are joined by `=`";
        same("extra `=`, expected nothing", "cpu == \"s7-300\"", joined, "write `cpu = \"s7-300\"`");
        let pairs = "missing assignment between key-value pairs, expected `=`";
        same(pairs, "set = { \"I0.0\" : 1 }", joined, "write `set = { \"I0.0\" = 1 }`");
        let Wrong { title, help } = plain("unexpected key or value", ",", "cpu = \"s7-300\",");
        assert_eq!((title.as_str(), help.as_str()), ("a line has no `,` at its end", "write `cpu = \"s7-300\"`"));
        let quotes = "string values must be quoted, expected literal string";
        same(quotes, "sources = main.stl", "a text is written in quotation marks", "write `sources = [\"main.stl\"]`");
        let number = "invalid type: floating point `100.0`, expected i64";
        same(number, "", "a whole number is expected here, not the number 100.0", "write `100`");
        let twice = "the key `clock_memory` appears twice, under two names";
        same("duplicate field `clock_memory`", "", twice, "remove one of them: both mean the same");
    }

    #[test]
    fn tells_the_form_in_plain_words() {
        let quotes = "string values must be quoted, expected literal string";
        same(quotes, "name = x # a", "a text is written in quotation marks", "write `name = \"x\"`");
        same(
            "key with no value, expected `=`",
            "name: \"x\"",
            "a key and its value are joined by `=`",
            "write `name = \"x\"`",
        );
        same(quotes, "cpu = “315-2DP”", "a text is written in quotation marks", "write `cpu = \"315-2DP\"`");
        let round = "a list is written in brackets";
        same(quotes, "sources = (\"a.stl\")", round, "write `sources = [\"a.stl\"]`");
        same(quotes, "sources = (a.stl, b.stl)", round, "write `sources = [\"a.stl\", \"b.stl\"]`");
        let name = "the heading does not begin with a name";
        same(quotes, "[.ob]", name, "write `[ob]`");
        same(quotes, "[[]]", name, "write the name of a table, as in `[retain]`");
        same(quotes, "= 5", "the key is missing before `=`", "write `key = 5`");
        same(quotes, "[ob.]", "the heading does not say which one", "write `[ob.35]`");
        same("invalid date", "cpu = 315-2DP", "a text is written in quotation marks", "write `cpu = \"315-2DP\"`");
        same("key with no value, expected `=`", "// my plant", "a comment begins with `#`", "write `# my plant`");
        let path = "write `sources = [\"src/main.scl\"]`: `/` is between folders";
        let escape = "missing escaped value, expected `b`, `f`";
        same(escape, r#"sources = ["src\main.scl"]"#, "`\\` begins a special character in a text", path);
    }
}
