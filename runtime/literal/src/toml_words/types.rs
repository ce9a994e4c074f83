//! Values of another type than the key has: a number for a text, a table for a list.

use super::Wrong;

/// Whether the key of a line has a duration: `cycle_time = 100`, `period = 50`.
fn is_of_time(line: &str) -> bool {
    let key = line.split('=').next().unwrap_or_default().trim().trim_matches('"').to_ascii_lowercase();
    let key = key.rsplit('.').next().unwrap_or_default();
    matches!(key, "cycle" | "step" | "poll" | "every")
        || ["time", "period", "offset", "timeout", "delay", "interval", "phase"].iter().any(|word| key.contains(word))
}

/// `found`: `integer `50``, `string "x"`, `map`; `wanted`: `a string`, `a sequence`, `i64`.
pub fn wrong_type(found: &str, wanted: &str, line: &str) -> Wrong {
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
