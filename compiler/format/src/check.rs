//! What must not change: every character that is not a blank, the tokens, and the syntax tree.

use plcc_diag::{Diagnostic, FileId};
use plcc_readers::ReadOptions;
use plcc_syntax::{Language, ast_text};

use crate::piece::blank;

/// What differs between a text and its layout, besides blanks.
pub fn difference(before: &str, after: &str, hint: Option<Language>) -> Option<String> {
    if !before.chars().filter(|c| !blank(*c)).eq(after.chars().filter(|c| !blank(*c))) {
        return Some("characters were lost".to_owned());
    }
    let both = [false, true];
    let forms = if before.contains("//@") { &both[..] } else { &both[..1] };
    for &pragmas in forms {
        let options = ReadOptions { language: hint, pragmas, ..ReadOptions::default() };
        let read = |text: &str| plcc_readers::parse(FileId::default(), text, &options);
        let ((old, messages), (new, others)) = (read(before), read(after));
        let errors = |messages: &[Diagnostic]| messages.iter().filter(|message| message.is_error()).count();
        if errors(&messages) != errors(&others) {
            return Some("the result has other errors".to_owned());
        }
        if let Some(lines) = first_difference(ast_text(&old).lines(), ast_text(&new).lines()) {
            return Some(format!("the syntax tree is not the same: {lines}"));
        }
    }
    let (old, new) = (tokens(before, hint), tokens(after, hint));
    let tokens = first_difference(old.iter().map(String::as_str), new.iter().map(String::as_str));
    tokens.map(|tokens| format!("the tokens are not the same: {tokens}"))
}

/// The first items that differ.
fn first_difference<'t>(
    mut before: impl Iterator<Item = &'t str>,
    mut after: impl Iterator<Item = &'t str>,
) -> Option<String> {
    loop {
        match (before.next(), after.next()) {
            (None, None) => return None,
            (old, new) if old == new => {}
            (old, new) => {
                return Some(format!("`{}`, then `{}`", old.unwrap_or("the end"), new.unwrap_or("the end")));
            }
        }
    }
}

/// The tokens of a text without their lines.
fn tokens(text: &str, hint: Option<Language>) -> Vec<String> {
    let options = ReadOptions { language: hint, ..ReadOptions::default() };
    let tokens = plcc_readers::tokens_text(text, &options);
    tokens.lines().map(|line| without_places(line.split_once(": ").map_or(line, |(_, token)| token))).collect()
}

/// The text of a token without the bytes of its parts.
fn without_places(token: &str) -> String {
    let mut parts = token.split("Span {");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        out.push_str(part.split_once('}').map_or("", |(_, rest)| rest));
    }
    out
}
