//! Repairs that a message itself proposes: `is "speed" meant?`

use plcc_diag::Diagnostic;

/// The text that is meant in place of what a message marks, if it says so. `marked`: what it marks.
pub fn replacement(message: &Diagnostic, marked: &str) -> Option<String> {
    let help = message.help.as_deref()?;
    let forms = [("is `", "` meant"), ("did you mean `", "`"), ("is \"", "\" meant?"), ("is #", " meant?")];
    let meant = forms.iter().find_map(|(before, after)| between(help, before, after))?;
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
