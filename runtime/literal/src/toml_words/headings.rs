//! Headings of tables, and lists that are not closed before them.

use super::Wrong;

/// Tables with a number or a name in their heading, and an example of it.
const NAMED: [(&str, &str); 7] = [
    ("ob", "35"),
    ("hsc", "1"),
    ("pulse", "1"),
    ("connection", "1"),
    ("axis", "Axis_1"),
    ("io", "NAME"),
    ("hardware_interrupt", "\"NAME\""),
];

/// `[axis]` with the keys of one axis below it. `line`: of the first of them; `before`: the text before it.
pub fn without_name(message: &str, before: &str, line: &str) -> Option<Wrong> {
    let (_, wanted) = message.lines().next()?.strip_prefix("invalid type: ")?.rsplit_once(", expected ")?;
    if !wanted.contains("map") && !wanted.contains("struct") {
        return None;
    }
    let heading = before.lines().rev().map(str::trim).find(|line| line.starts_with('['))?;
    let key = heading.strip_prefix('[')?.strip_suffix(']')?.trim();
    let (_, example) = NAMED.into_iter().find(|(own, _)| *own == key)?;
    // `30 = "50ms"`
    let own = line.split('=').next().map(str::trim);
    let number = own.filter(|own| !own.is_empty() && own.bytes().all(|digit| digit.is_ascii_digit()));
    let help = match number {
        Some(number) => format!("write `[{key}.{number}]`, and its keys below it"),
        None => format!("write `[{key}.{example}]`"),
    };
    Some(Wrong { title: format!("`[{key}]` does not say which one"), help })
}

/// `[[retain]]`, where there is one table.
pub fn list_of_a_table(message: &str, line: &str) -> Option<Wrong> {
    let key = line.trim().strip_prefix("[[")?.split("]]").next()?.trim();
    if !message.starts_with("invalid type: ") {
        return None;
    }
    let example = NAMED.into_iter().find(|(own, _)| *own == key).map(|(_, example)| format!(".{example}"));
    let help = format!("write `[{key}{}]`", example.unwrap_or_default());
    Some(Wrong { title: format!("`{key}` is one table, not a list of them"), help })
}

/// `[plant.equations]` and `[[plant.equations]]`, where the equations are a list of texts. `end`: of the line of the heading.
pub fn of_equations(message: &str, text: &str, line: &str, end: usize) -> Option<Wrong> {
    let heading = line.trim().strip_prefix('[')?.trim_start_matches('[').split(']').next()?.trim();
    if heading != "plant.equations" || !message.starts_with("invalid type: ") {
        return None;
    }
    let below = text[end..].lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'));
    let equation = match below.and_then(|line| line.split_once('=')) {
        Some((name, value)) => format!("{} = {}", name.trim(), value.trim().trim_matches('"')),
        None => "…".to_owned(),
    };
    Some(Wrong {
        title: "`equations` is a list of texts, not a heading".to_owned(),
        help: format!("write `equations = [\"{equation}\"]` below `[plant]`"),
    })
}

/// `[[at]]` in `line`, after `[at]` in the text before it.
pub fn list_after_a_table(message: &str, before: &str, line: &str) -> Option<Wrong> {
    let key = line.trim().strip_prefix("[[")?.split("]]").next()?.trim();
    let single = format!("[{key}]");
    if !message.starts_with("duplicate key") || !before.lines().any(|line| line.trim() == single) {
        return None;
    }
    Some(Wrong {
        title: format!("`{single}` before this line is one table, and `[[{key}]]` a list of them"),
        help: format!("write `[[{key}]]` there, too"),
    })
}

/// True of what can be before `=`.
fn is_key(key: &str) -> bool {
    let key = key.trim();
    !key.is_empty() && key.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"_-.".contains(&byte))
}

/// `set = { "I0.0" = 1` without its `}`: another key, or a heading, follows in `line`. `before`: the text before it.
pub fn open_table(message: &str, before: &str, line: &str) -> Option<Wrong> {
    let told = message.lines().next()?;
    let next = line.split_once('=').is_some_and(|(key, _)| is_key(key)) || line.trim_start().starts_with('[');
    if !next || !["missing comma", "missing key for inline table"].iter().any(|part| told.contains(part)) {
        return None;
    }
    let opens = |line: &&str| {
        line.split_once('=')
            .is_some_and(|(key, value)| is_key(key) && value.matches('{').count() > value.matches('}').count())
    };
    let mut lines = before.lines().rev().map(str::trim).take_while(|line| !line.starts_with('['));
    let open = lines.find(opens)?.split(" #").next()?.trim_end().trim_end_matches(',').trim_end();
    let title = "the table before this line is not closed".to_owned();
    Some(Wrong { title, help: format!("write `{open} }}`") })
}

/// A list without its `]`: another key follows in `line`. `before`: the text before it.
pub fn open_list(message: &str, before: &str, line: &str) -> Option<Wrong> {
    let next = line.split_once('=').is_some_and(|(key, _)| is_key(key)) || line.trim_start().starts_with('[');
    if !next || !message.lines().next()?.contains("missing comma") {
        return None;
    }
    // `[[retain]]` after the list is read as a list in it.
    let is_heading = |line: &str| line.starts_with('[') && line.ends_with(']') && !line.contains(['"', '\'', ',']);
    let mut lines = before.lines().rev().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let last = lines.find(|line| !is_heading(line))?;
    let opens = |line: &str| {
        line.split_once('=')
            .is_some_and(|(key, value)| is_key(key) && value.matches('[').count() > value.matches(']').count())
    };
    let title = "the list before this line is not closed".to_owned();
    if opens(last) {
        return Some(Wrong { title, help: format!("write `{}]`", last.trim_end_matches(',')) });
    }
    let help = format!("write `]` after `{}`", last.trim_end_matches(','));
    lines.any(opens).then_some(Wrong { title, help })
}

/// `[ob.]`
pub fn ends_with_point(line: &str) -> Option<Wrong> {
    let heading = line.strip_prefix('[')?.strip_suffix(".]")?;
    let example = NAMED.into_iter().find(|(own, _)| *own == heading).map_or("NAME", |(_, example)| example);
    let help = format!("write `[{heading}.{example}]`");
    Some(Wrong { title: "the heading does not say which one".to_owned(), help })
}

/// `[]`, `[.ob]`
pub fn without_key(line: &str) -> Option<Wrong> {
    let rest = line.trim().strip_prefix('[')?.trim_start_matches('[').trim_start();
    if !rest.starts_with([']', '.']) {
        return None;
    }
    let key = rest.trim_start_matches('.').split(']').next().unwrap_or_default().trim();
    let help = match key {
        "" => "write the name of a table, as in `[retain]`".to_owned(),
        key => format!("write `[{key}]`"),
    };
    Some(Wrong { title: "the heading does not begin with a name".to_owned(), help })
}

/// `[cpu]` with keys below it, where `cpu = "…"` is a key of its own. `end`: of the line of the heading.
pub fn of_a_text(message: &str, text: &str, line: &str, end: usize) -> Option<Wrong> {
    let key = line.trim().strip_prefix('[')?.strip_suffix(']')?.trim();
    if !message.starts_with("invalid type: map, expected a string") {
        return None;
    }
    let below = text[end..].lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'));
    let value = below.and_then(|line| line.split_once('=')).map_or("\"…\"", |(_, value)| value.trim());
    Some(Wrong {
        title: format!("`{key}` is a key with a text, not a heading"),
        help: format!("write `{key} = {value}` at the top of the file, before the first heading"),
    })
}
