//! Repairs that a message itself proposes: `is "speed" meant?`, `read as <>`.

use plcc_diag::Diagnostic;

use crate::words::bare;

/// The text that is meant in place of what a message marks, if it says so. `marked`: what it marks.
pub fn replacement(message: &Diagnostic, marked: &str) -> Option<String> {
    let own = read_as(message, marked).map(str::to_owned);
    if let Some(text) = own.or_else(|| completed(message, marked)) {
        return Some(text);
    }
    let help = message.help.as_deref()?;
    // A message about a part of what it marks, or about another place, names something else.
    if !message.title.contains(bare(marked)) {
        return None;
    }
    let forms = [("is `", "` meant"), ("did you mean `", "`"), ("is \"", "\" meant?"), ("is #", " meant?")];
    let meant = forms.iter().find_map(|(before, after)| between(help, before, after))?;
    // Of `key := "value"` the value is marked.
    let meant = match meant.split_once(" := ") {
        Some((_, value)) if !marked.contains(":=") => value.trim_matches('"'),
        _ => meant,
    };
    let quoted = marked.starts_with('"') && !meant.starts_with(['"', '#']);
    let local = marked.starts_with('#') && !meant.starts_with('#');
    Some(match (quoted, local) {
        (true, _) => format!("\"{meant}\""),
        (_, true) => format!("#{meant}"),
        (false, false) => meant.to_owned(),
    })
}

/// What a message reads in place of what it marks: `THEN` for `THN`, `<>` for `!=`. Where the help changes more than that, nothing.
fn read_as<'m>(message: &'m Diagnostic, marked: &str) -> Option<&'m str> {
    let meant = message.primary.text.strip_prefix("read as `")?.strip_suffix('`')?;
    let help = message.help.as_deref()?;
    let written = between(help, "write `", "`")?;
    let is_letter = |c: char| c.is_alphanumeric() || c == '_';
    let is_sign = !marked.contains(|c: char| is_letter(c) || c.is_whitespace() || matches!(c, '"' | '\'' | '#'));
    let is_word = marked.chars().all(|c| is_letter(c) || matches!(c, ' ' | '$'));
    let is_all = written.trim_end_matches(';') == meant && help.ends_with(&format!("write `{written}`"));
    let fits = if is_sign { written.contains(meant) } else { is_word && is_all };
    (fits && !marked.is_empty() && !meant.contains('…')).then_some(meant)
}

/// What a message marks with the sign that is missing after it.
fn completed(message: &Diagnostic, marked: &str) -> Option<String> {
    let (sign, after) = message.title.strip_prefix('`')?.split_once("` is missing after `")?;
    let is_it = matches!(sign, ";" | ":" | ",") && after.strip_suffix('`') == Some(marked);
    is_it.then(|| format!("{marked}{sign}"))
}

/// A text in place of another one between `before` and `after`; a word in place of a sign stands apart: `a AND b` of `a&&b`.
pub fn apart(text: &str, marked: &str, before: &str, after: &str) -> String {
    let is_word = |text: &str| text.contains(char::is_alphanumeric);
    if is_word(marked) || !is_word(text) {
        return text.to_owned();
    }
    let touches = |c: Option<char>, bracket: char| c.is_some_and(|c| !c.is_whitespace() && c != bracket);
    let left = if touches(before.chars().next_back(), '(') { " " } else { "" };
    let right = if touches(after.chars().next(), ')') { " " } else { "" };
    format!("{left}{text}{right}")
}

/// The text between two others, without backquotes.
fn between<'t>(text: &'t str, before: &str, after: &str) -> Option<&'t str> {
    let start = text.find(before)? + before.len();
    let end = text[start..].find(after)? + start;
    Some(&text[start..end]).filter(|found| !found.contains(['`', '\n']) && !found.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use plcc_diag::{Code, Span};

    fn written(title: &str, help: &str, marked: &str) -> Option<String> {
        let message = Diagnostic::new(Code::AttributeValue, Span::default(), title);
        replacement(&message.help(help), marked)
    }

    #[test]
    fn what_is_meant_is_written() {
        let found = written("the symbol `Motr` is not defined", "is `Motor` meant?", "\"Motr\"");
        assert_eq!(found.as_deref(), Some("\"Motor\""));
        let found = written("the symbol `start` is not defined", "is `#start` meant?", "\"start\"");
        assert_eq!(found.as_deref(), Some("#start"));
    }

    #[test]
    fn what_is_read_is_written() {
        let read = |title: &str, meant: &str, help: &str, marked: &str| {
            let message = Diagnostic::new(Code::ForeignForm, Span::default(), title);
            replacement(&message.label(format!("read as `{meant}`")).help(help), marked)
        };
        let found = read("the keyword is `THEN`, not `THN`", "THEN", "write `THEN`", "THN");
        assert_eq!(found.as_deref(), Some("THEN"));
        assert_eq!(read("not equal is `<>`", "<>", "write `#a <> 3`", "!=").as_deref(), Some("<>"));
        assert_eq!(read("`END_FOR` cannot end IF", "END_IF", "write `END_IF;`", "END_FOR").as_deref(), Some("END_IF"));
        // All of the parameter is marked, or the condition changes as well.
        assert_eq!(read("`q` of `F` is an output", "=>", "write `q => #x`", "q := #x"), None);
        assert_eq!(read("REPEAT ends with UNTIL", "UNTIL", "write `UNTIL NOT (#a)`", "WHILE"), None);
        let down = "write `TO`, and `BY -1` before `DO`";
        assert_eq!(read("the keyword is `TO`, not `DOWNTO`", "TO", down, "DOWNTO"), None);
    }

    #[test]
    fn what_is_missing_is_added() {
        let title = "`;` is missing after `#level`";
        assert_eq!(written(title, "end each statement with `;`", "#level").as_deref(), Some("#level;"));
        assert_eq!(written(title, "end each statement with `;`", "#other"), None);
    }

    #[test]
    fn a_word_for_a_sign_stands_apart() {
        assert_eq!(apart("AND", "&&", "#a", "#b"), " AND ");
        assert_eq!(apart("NOT", "!", "IF (", "#a)"), "NOT ");
        assert_eq!(apart("<>", "!=", "#a", "#b"), "<>");
        assert_eq!(apart("THEN", "THN", "5 ", "\n"), "THEN");
    }

    #[test]
    fn of_an_attribute_the_value_is_written() {
        let found = written("`S7_Language` cannot be `LDA`", "is `S7_Language := \"LAD\"` meant?", "LDA");
        assert_eq!(found.as_deref(), Some("LAD"));
    }

    #[test]
    fn what_a_message_does_not_name_stays() {
        let title = "`TimOfDay` is not a class of organization blocks";
        assert_eq!(written(title, "is `TimeOfDay` meant?", "\"Main\""), None);
        assert_eq!(written("`SrcTyp` is not known", "is `SrcType` meant?", "SrcTyp := Int"), None);
    }
}
