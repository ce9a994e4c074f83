//! What is not TOML: values without quotation marks, habits of other languages, parts that are not closed.

use super::{Wrong, headings};

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
    if plain.contains(['{', '['])
        && let Some(meant) = with_commas(plain)
    {
        return wrong("parts are separated by `,`, not by `;`", format!("write `{meant}`"));
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

/// `{ "I0.0" = 1; "I0.1" = 0; }` with its `;` as `,`; none: there is no `;` outside of texts.
fn with_commas(line: &str) -> Option<String> {
    let mut in_text = false;
    let meant: String = line
        .chars()
        .map(|letter| {
            in_text ^= letter == '"';
            if letter == ';' && !in_text { ',' } else { letter }
        })
        .collect();
    if meant == line {
        return None;
    }
    let mut parts = meant;
    for (ends, end) in [(", }", " }"), (",}", "}"), (", ]", "]"), (",]", "]")] {
        parts = parts.replace(ends, end);
    }
    Some(parts)
}

/// An error in the form of the file.
pub fn syntax(message: &str, place: &str, line: &str) -> Wrong {
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
    if message.contains("leading zero") {
        let value = line.split_once('=').map_or(place, |(_, value)| value).split('#').next().unwrap_or_default().trim();
        let title = "a number has no zeros before it";
        // Manuals count coils from 00001 on, which has the address 0.
        let is_reference = key == "coils" && matches!(value.len(), 5 | 6);
        return match value.parse::<u64>() {
            Ok(number @ 1..) if is_reference => {
                let address = number - 1;
                wrong(title, format!("write `coils = {address}`, the address of coil {value}: addresses begin at 0"))
            }
            Ok(number) => wrong(title, format!("write `{key} = {number}`")),
            Err(_) => wrong(title, "write the number without them".to_owned()),
        };
    }
    if place == "," {
        let line = line.trim_end_matches(',').trim_end();
        return wrong("a line has no `,` at its end", format!("write `{line}`"));
    }
    // `set = [ "I0.0" = 1 ]`
    if message.contains("unexpected `=` in array")
        && let Some((key, pairs)) = line.split_once('=')
        && let Some(pairs) = pairs.trim().strip_prefix('[').and_then(|pairs| pairs.strip_suffix(']'))
    {
        let help = format!("write `{} = {{ {} }}`", key.trim(), pairs.trim());
        return wrong("names with their values are written in braces", help);
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
            // `cpu: 1214C # of the press`
            let value = value.trim();
            let is_text = value.starts_with(['"', '\'', '[', '{']);
            let value = if is_text { value } else { value.split(" #").next().unwrap_or_default().trim() };
            let is_value = is_text || matches!(value, "true" | "false") || value.parse::<f64>().is_ok();
            let quote = if is_value { "" } else { "\"" };
            return wrong(
                "a key and its value are joined by `=`",
                format!("write `{} = {quote}{value}{quote}`", key.trim()),
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
