//! Repairs that a message itself proposes: `is "speed" meant?`

use plcc_diag::Diagnostic;

use crate::words::bare;

/// The text that is meant in place of what a message marks, if it says so. `marked`: what it marks.
pub fn replacement(message: &Diagnostic, marked: &str) -> Option<String> {
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
    let quoted = marked.starts_with('"') && !meant.starts_with('"');
    let local = marked.starts_with('#') && !meant.starts_with('#');
    Some(match (quoted, local) {
        (true, _) => format!("\"{meant}\""),
        (_, true) => format!("#{meant}"),
        (false, false) => meant.to_owned(),
    })
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
