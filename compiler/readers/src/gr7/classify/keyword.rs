//! Words that begin and end the parts of a chart. A variable may have the name of one of them.

use crate::gr7::lexer::{RawKind, RawToken};
use plcc_syntax::front::frame_words::slip_of;

/// A word that begins or ends a part of a chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keyword {
    FunctionBlock,
    EndFunctionBlock,
    Var,
    EndVar,
    PermanentBegin,
    PermanentEnd,
    EndPermanent,
    Sequence,
    EndSequence,
    InitialStep,
    Step,
    EndStep,
    Interlock,
    EndInterlock,
    Supervision,
    EndSupervision,
    Transition,
    EndTransition,
    Condition,
}

const WORDS: [(&str, Keyword); 23] = [
    ("FUNCTION_BLOCK", Keyword::FunctionBlock),
    ("END_FUNCTION_BLOCK", Keyword::EndFunctionBlock),
    ("VAR", Keyword::Var),
    ("VAR_INPUT", Keyword::Var),
    ("VAR_OUTPUT", Keyword::Var),
    ("VAR_IN_OUT", Keyword::Var),
    ("VAR_TEMP", Keyword::Var),
    ("END_VAR", Keyword::EndVar),
    ("PERM_CONDITION_AT_BEGIN", Keyword::PermanentBegin),
    ("PERM_CONDITION_AT_END", Keyword::PermanentEnd),
    ("END_PERM_CONDITION", Keyword::EndPermanent),
    ("SEQUENCE", Keyword::Sequence),
    ("END_SEQUENCE", Keyword::EndSequence),
    ("INITIAL_STEP", Keyword::InitialStep),
    ("STEP", Keyword::Step),
    ("END_STEP", Keyword::EndStep),
    ("INTERLOCK", Keyword::Interlock),
    ("END_INTERLOCK", Keyword::EndInterlock),
    ("SUPERVISION", Keyword::Supervision),
    ("END_SUPERVISION", Keyword::EndSupervision),
    ("TRANSITION", Keyword::Transition),
    ("END_TRANSITION", Keyword::EndTransition),
    ("CONDITION", Keyword::Condition),
];

impl Keyword {
    pub fn of(word: &str) -> Option<Keyword> {
        WORDS.iter().find(|(known, _)| known.eq_ignore_ascii_case(word)).map(|(_, keyword)| *keyword)
    }

    pub fn word(self) -> &'static str {
        WORDS.iter().find(|(_, keyword)| *keyword == self).map_or("", |(word, _)| word)
    }

    /// Whether it ends a part of a chart.
    pub const fn is_end(self) -> bool {
        matches!(
            self,
            Keyword::EndPermanent
                | Keyword::EndSequence
                | Keyword::EndStep
                | Keyword::EndInterlock
                | Keyword::EndSupervision
                | Keyword::EndTransition
        )
    }

    /// Whether a step, transition or list of permanent instructions ends here, perhaps because the next one begins.
    pub const fn ends_part(self) -> bool {
        !matches!(self, Keyword::Condition | Keyword::Interlock | Keyword::Supervision)
    }
}

/// Makes one word of `INITIAL STEP` and `END STEP` at the beginning of a line: a misspelt keyword.
pub fn join_words(text: &str, raw: &mut Vec<RawToken>) {
    let mut joined: Vec<RawToken> = Vec::with_capacity(raw.len());
    for token in raw.drain(..) {
        let first = joined.last_mut().filter(|first| {
            let beside = first.first_on_line && !token.first_on_line && token.kind == RawKind::Word;
            beside && are_one(&text[first.range()], &text[token.range()])
        });
        match first {
            Some(first) => first.end = token.end,
            None => joined.push(token),
        }
    }
    *raw = joined;
}

/// Whether two words are a keyword without its `_`.
fn are_one(first: &str, second: &str) -> bool {
    let initial = first.eq_ignore_ascii_case("INITIAL") && second.eq_ignore_ascii_case("STEP");
    initial || first.eq_ignore_ascii_case("END") && Keyword::of(&format!("END_{second}")).is_some()
}

/// The keyword that a word is meant as: `ENDSTEP`, `TRANSITON`. Only where no operand can be: alone on its line, or before
/// a name with its number or a colon.
pub fn misspelt(text: &str, raw: &[RawToken], index: usize) -> Option<Keyword> {
    let token = raw.get(index).filter(|token| token.kind == RawKind::Word && token.first_on_line)?;
    let word = &text[token.range()];
    if word.len() < 3 || Keyword::of(word).is_some() {
        return None;
    }
    let next = raw.get(index + 1);
    // `VAR_IN`, alone on its line: which section it is, the parser of declarations says.
    let section = word.get(..4).is_some_and(|head| head.eq_ignore_ascii_case("VAR_"));
    if section && next.is_some_and(|next| next.first_on_line) {
        return Some(Keyword::Var);
    }
    if let Some(keyword) = section_of_condition(text, raw, index) {
        return Some(keyword);
    }
    let candidates: &[&str] = match next {
        None => ENDS,
        Some(next) if next.first_on_line => ENDS,
        Some(next) if next.kind == RawKind::Word => {
            let heads = raw
                .get(index + 2)
                .is_some_and(|third| !third.first_on_line && matches!(third.kind, RawKind::Pragma | RawKind::Colon));
            if !heads {
                return None;
            }
            &["INITIAL_STEP", "STEP", "TRANSITION"]
        }
        Some(_) => return None,
    };
    let ends = candidates.len() == ENDS.len();
    if ends && !word.starts_with(['E', 'e']) {
        return None;
    }
    let meant = german(word)
        .filter(|keyword| candidates.contains(keyword))
        .or_else(|| slip_of(word, candidates.iter().copied()))
        .or_else(|| shortened(word, candidates))?;
    Keyword::of(meant)
}

/// The keyword that a German word stands for: a source has English ones, whatever the language of the editor.
pub fn german(word: &str) -> Option<&'static str> {
    const WORDS: [(&str, &str); 8] = [
        ("SCHRITT", "STEP"),
        ("INITIALSCHRITT", "INITIAL_STEP"),
        ("INIT_SCHRITT", "INITIAL_STEP"),
        ("END_SCHRITT", "END_STEP"),
        ("ENDE_SCHRITT", "END_STEP"),
        ("ENDE_TRANSITION", "END_TRANSITION"),
        ("VON", "FROM"),
        ("NACH", "TO"),
    ];
    WORDS.iter().find(|(german, _)| german.eq_ignore_ascii_case(word)).map(|(_, keyword)| *keyword)
}

/// `SUPERVISON`, `INTERLOCK_CONDITION`, alone before a line with `CONDITION :=`.
fn section_of_condition(text: &str, raw: &[RawToken], index: usize) -> Option<Keyword> {
    let (token, next, sign) = (raw.get(index)?, raw.get(index + 1)?, raw.get(index + 2)?);
    let condition = next.first_on_line && Keyword::of(&text[next.range()]) == Some(Keyword::Condition);
    if !condition || !matches!(sign.kind, RawKind::Assign | RawKind::Equal) {
        return None;
    }
    let word = &text[token.range()];
    let begins = |full: &&str| word.get(..full.len()).is_some_and(|head| head.eq_ignore_ascii_case(full));
    Keyword::of(slip_of(word, SECTIONS).or_else(|| SECTIONS.into_iter().find(begins))?)
}

/// Parts of a step with a condition.
const SECTIONS: [&str; 2] = ["INTERLOCK", "SUPERVISION"];

/// `END_TRANS`: the only one of `words` that begins so.
fn shortened<'w>(word: &str, words: &[&'w str]) -> Option<&'w str> {
    let begins = |full: &&&str| full.get(..word.len()).is_some_and(|head| head.eq_ignore_ascii_case(word));
    let mut found = words.iter().filter(begins);
    let only = found.next()?;
    (word.len() > "END_".len() && found.next().is_none()).then_some(*only)
}

/// Words that are alone on their line.
const ENDS: &[&str] = &[
    "END_STEP",
    "END_TRANSITION",
    "END_INTERLOCK",
    "END_SUPERVISION",
    "END_PERM_CONDITION",
    "END_SEQUENCE",
    "END_FUNCTION_BLOCK",
];

/// The keyword at `index`: a keyword that begins a part is the first on its line or follows an end, and is not used as an operand.
pub fn at(text: &str, raw: &[RawToken], index: usize) -> Option<Keyword> {
    let token = raw.get(index).filter(|token| token.kind == RawKind::Word)?;
    let Some(keyword) = Keyword::of(&text[token.range()]) else { return misspelt(text, raw, index) };
    let before = index.checked_sub(1).map(|before| raw[before]);
    if before.is_some_and(|before| before.kind == RawKind::Dot) {
        return None;
    }
    let next = raw.get(index + 1).map(|next| next.kind);
    if next == Some(RawKind::Assign) {
        return (keyword == Keyword::Condition).then_some(keyword);
    }
    if matches!(next, Some(RawKind::Dot | RawKind::Comma | RawKind::LeftBracket)) {
        return None;
    }
    if keyword.is_end() || matches!(keyword, Keyword::EndFunctionBlock | Keyword::EndVar) {
        return Some(keyword);
    }
    let after_end = || {
        let Some(before) = before else { return true };
        matches!(before.kind, RawKind::Colon | RawKind::Semicolon | RawKind::Pragma | RawKind::RightParen)
            || before.kind == RawKind::Word
                && Keyword::of(&text[before.range()])
                    .is_some_and(|word| word.is_end() || matches!(word, Keyword::Interlock | Keyword::Supervision))
    };
    let begins = token.first_on_line || after_end();
    // `Step (N)` is an action.
    (begins && next != Some(RawKind::LeftParen)).then_some(keyword)
}
