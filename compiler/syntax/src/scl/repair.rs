//! Takes slips and habits of other languages in statements as what is meant, and says how SCL writes it.
//!
//! ```text
//! raw tokens ──► raw tokens of SCL, and a message for each repair
//!              words.rs: THENN, ENDIF, UND                 signs.rs: ==, &&, i++, 0x1F, { }          foreign.rs: METHOD, LOOP, N7:0
//!              statements.rs: let x = 5, do … while, (INT)x      cases.rs: 1 := x := 2, SELECT CASE
//!              leave.rs: break, EXIT FOR                   loops.rs: for (i = 0; …)                  declare.rs: POINTER TO, AT %MW10
//!              labels.rs: GOTO 10                  addresses.rs: MW 10                left_out.rs: #a > 5 THEN
//!              sections.rs: VAR_GLOBAL                     values.rs: a IN [1, 2], a, b := 1        choices.rs: if (x) a = 1
//!              around.rs: NAMESPACE                enumerations.rs: TYPE x : INT (a, b)
//!              durations.rs: T#1h 30m              stl.rs: L #a; T #b;                  block_heads.rs: FUNCTION f(a : INT)
//! ```
//!
//! Each rule looks for something that is wrong in SCL wherever it is, so correct sources pass unchanged; most have no repairs at all, and
//! their tokens are not even copied.

mod addresses;
mod around;
mod block_heads;
mod cases;
mod choices;
mod declare;
mod durations;
mod enumerations;
mod foreign;
mod heads;
mod labels;
mod leave;
mod left_out;
mod loops;
mod sections;
mod signs;
mod statements;
mod stl;
mod values;
mod words;

use std::collections::{HashMap, HashSet};

use plcc_diag::{Code, Diagnostic, FileId, Span};

use self::enumerations::Enumerations;
use self::labels::NumberLabels;
use super::keyword::Keyword;
use super::raw::{RawKind, RawText, RawToken};

/// The tokens with all repairs; none if there is nothing to repair. Repairs are reported.
pub fn repair(file: FileId, text: &str, raw: &RawText, diagnostics: &mut Vec<Diagnostic>) -> Option<RawText> {
    let mut repair = Repair::new(file, text, &raw.tokens);
    repair.iec = raw.iec;
    repair.walk();
    let Repair { edits, messages, .. } = repair;
    if edits.is_empty() {
        return None;
    }
    diagnostics.extend(messages);
    let mut tokens = Vec::with_capacity(raw.tokens.len());
    let mut regions = raw.regions.clone();
    let mut at = 0;
    for edit in edits {
        tokens.extend_from_slice(&raw.tokens[at..edit.first]);
        tokens.extend(edit.with);
        at = edit.after;
        for (region, original) in regions.iter_mut().zip(&raw.regions) {
            let original = original.token as usize;
            if original >= edit.first {
                // What is inside of the replaced tokens comes after them.
                region.token = (original.max(at) + tokens.len() - at) as u32;
            }
        }
    }
    tokens.extend_from_slice(&raw.tokens[at..]);
    Some(RawText { tokens, comments: raw.comments.clone(), regions, slips: Vec::new(), iec: raw.iec })
}

/// Tokens that others replace.
struct Edit {
    first: usize,
    after: usize,
    with: Vec<RawToken>,
}

/// A structured statement that is open.
struct Open {
    keyword: Keyword,
    /// It was opened with `{`.
    brace: bool,
}

/// The head of a structured statement, in which the walk is.
struct Head {
    keyword: Keyword,
    /// The word that ends it.
    wanted: Keyword,
    /// FOR: `:=` and TO have been seen.
    assigned: bool,
    to: bool,
    by: bool,
}

/// Where the walk is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Area {
    /// After the first word of a block.
    Head,
    Declarations,
    Statements,
}

/// A walk over the tokens of a text.
struct Repair<'t> {
    file: FileId,
    text: &'t str,
    tokens: &'t [RawToken],
    at: usize,
    /// The last token as repaired.
    last: Option<RawToken>,
    area: Area,
    open: Vec<Open>,
    head: Option<Head>,
    /// Open parentheses and brackets; true for those of a call.
    brackets: Vec<bool>,
    /// Index of the first token of the statement.
    statement: usize,
    /// Names that the text declares, in upper case, with the index of their token in the last declaration.
    declared: HashMap<String, usize>,
    /// Those with hyphens, which were reported.
    with_hyphens: HashSet<String>,
    /// Names of sections that were reported; true: those of a section of the block.
    absent: HashMap<String, bool>,
    enumerations: Enumerations,
    number_labels: NumberLabels<'t>,
    edits: Vec<Edit>,
    messages: Vec<Diagnostic>,
    /// The block is a data block.
    data: bool,
    /// BEGIN of the block has been passed.
    statements_begun: bool,
    /// The `}` of groups of statements.
    group_ends: HashSet<usize>,
    /// `{` for THEN was reported.
    braces_reported: bool,
    /// BEGIN inside of a statement was reported in this block.
    begins_reported: bool,
    /// LOOP without its END_LOOP.
    loops: usize,
    /// `#region` was reported.
    signed_regions: bool,
    /// NAMESPACE without its END_NAMESPACE.
    name_spaces: usize,
    /// The text is of an editor of IEC 61131-3.
    iec: bool,
}

impl<'t> Repair<'t> {
    fn new(file: FileId, text: &'t str, tokens: &'t [RawToken]) -> Repair<'t> {
        Repair {
            file,
            text,
            tokens,
            at: 0,
            last: None,
            area: Area::Statements,
            open: Vec::new(),
            head: None,
            brackets: Vec::new(),
            statement: 0,
            declared: HashMap::new(),
            with_hyphens: HashSet::new(),
            absent: HashMap::new(),
            enumerations: Enumerations::default(),
            number_labels: NumberLabels::default(),
            edits: Vec::new(),
            messages: Vec::new(),
            data: false,
            statements_begun: false,
            group_ends: HashSet::new(),
            braces_reported: false,
            begins_reported: false,
            loops: 0,
            signed_regions: false,
            name_spaces: 0,
            iec: false,
        }
    }

    fn walk(&mut self) {
        while let Some(token) = self.token(self.at) {
            let before = self.at;
            match self.area {
                Area::Head => {
                    let repaired = self.foreign_part(token)
                        || self.global_section(token)
                        || self.heritage(token)
                        || self.foreign_head(token);
                    if !repaired {
                        self.pass(token);
                    }
                }
                Area::Declarations => self.declaration_token(token),
                // Only what is wrong whatever is declared: the declarations are elsewhere.
                Area::Statements if self.iec => {
                    let inside = !self.open.is_empty();
                    if !(inside && (self.repair_word(token) || self.repair_head(token))) {
                        self.pass(token);
                    }
                }
                Area::Statements => {
                    self.note_late_section(token);
                    if !(self.line_of_others(token)
                        || self.commented_divisor(token)
                        || self.absent_use(token)
                        || self.enumerated_value(token)
                        || self.head_alone(token)
                        || self.number_label(token)
                        || self.foreign(token)
                        || self.hyphenated_use(token)
                        || self.repair_word(token)
                        || self.repair_head(token)
                        || self.repair_sign(token)
                        || self.statement_without_keyword(token))
                    {
                        self.pass(token);
                    }
                }
            }
            debug_assert!(self.at > before, "the walk goes on");
            self.at = self.at.max(before + 1);
        }
    }

    /// Repairs a form of another language.
    fn foreign(&mut self, token: RawToken) -> bool {
        matches!(token.kind, RawKind::Word | RawKind::Absolute)
            && (self.foreign_part(token)
                || self.around_blocks(token)
                || self.global_section(token)
                || self.foreign_prefix(token)
                || self.late_condition(token)
                || self.value_after_of(token)
                || self.pascal(token)
                || self.endless(token)
                || self.leaving(token)
                || self.short_circuit(token)
                || self.parted_address(token)
                || self.foreign_statement(token)
                || self.foreign_value(token)
                || self.early_end_if(token)
                || self.bare_argument(token)
                || self.cast(token)
                || self.file_address(token)
                || self.bit_of_word(token))
    }

    /// Goes past a token that stays as it is.
    fn pass(&mut self, token: RawToken) {
        self.at += 1;
        self.note(token);
    }

    /// Follows the structure of the statements.
    fn note(&mut self, token: RawToken) {
        match token.kind {
            RawKind::LeftParen => {
                let call = self.last.is_some_and(|last| {
                    matches!(last.kind, RawKind::Word | RawKind::Quoted | RawKind::Local | RawKind::RightBracket)
                        && !last.keyword.is_some_and(Keyword::ends_expression)
                        && !last.keyword.is_some_and(Keyword::is_operator)
                });
                self.brackets.push(call);
            }
            RawKind::LeftBracket => self.brackets.push(true),
            RawKind::RightParen | RawKind::RightBracket => {
                self.brackets.pop();
            }
            RawKind::Semicolon => {
                self.head = None;
                self.begin_statement();
            }
            RawKind::Colon if self.brackets.is_empty() && self.head.is_none() => self.begin_statement(),
            RawKind::Assign => {
                if let Some(head) = &mut self.head {
                    head.assigned = true;
                }
            }
            _ => {}
        }
        if let Some(keyword) = token.keyword {
            self.note_keyword(keyword);
        }
        self.last = Some(token);
    }

    fn note_keyword(&mut self, keyword: Keyword) {
        let formal = matches!(self.kind(self.at), Some(RawKind::Assign | RawKind::Arrow));
        if formal && !self.brackets.is_empty() {
            return;
        }
        match keyword {
            Keyword::If | Keyword::Case | Keyword::For | Keyword::While => {
                self.open.push(Open { keyword, brace: false });
                let wanted = match keyword {
                    Keyword::If => Keyword::Then,
                    Keyword::Case => Keyword::Of,
                    _ => Keyword::Do,
                };
                self.begin_head(keyword, wanted);
            }
            Keyword::Repeat => {
                self.open.push(Open { keyword, brace: false });
                self.begin_statement();
            }
            Keyword::Elsif | Keyword::ElseIf => self.begin_head(keyword, Keyword::Then),
            Keyword::Until => self.begin_head(keyword, Keyword::EndRepeat),
            Keyword::To => {
                if let Some(head) = &mut self.head {
                    head.to = true;
                }
            }
            Keyword::By => {
                if let Some(head) = &mut self.head {
                    head.by = true;
                }
            }
            Keyword::Then | Keyword::Do | Keyword::Of | Keyword::Else | Keyword::Begin => {
                if keyword == Keyword::Begin {
                    self.area = Area::Statements;
                    self.statements_begun = true;
                }
                self.head = None;
                self.begin_statement();
            }
            Keyword::EndIf | Keyword::EndCase | Keyword::EndFor | Keyword::EndWhile | Keyword::EndRepeat => {
                let opener = opener(keyword);
                if let Some(index) = self.open.iter().rposition(|open| Some(open.keyword) == opener) {
                    self.open.truncate(index);
                }
                self.head = None;
                self.begin_statement();
            }
            _ if keyword.begins_section() || keyword == Keyword::Struct => {
                self.begin_statement();
                self.area = Area::Declarations;
            }
            _ if keyword.ends_block() || self.begins_block(keyword) => {
                self.area = if keyword.ends_block() { Area::Statements } else { Area::Head };
                self.data = keyword == Keyword::DataBlock;
                self.open.clear();
                self.begins_reported = false;
                self.statements_begun = false;
                self.absent.retain(|_, of_block| !*of_block);
                self.number_labels.begin_block();
                self.head = None;
                self.begin_statement();
            }
            _ => {}
        }
    }

    /// Whether the keyword, which has just been passed, begins a block: its name follows.
    fn begins_block(&self, keyword: Keyword) -> bool {
        keyword.begins_block() && matches!(self.kind(self.at), Some(RawKind::Word | RawKind::Quoted))
    }

    fn begin_head(&mut self, keyword: Keyword, wanted: Keyword) {
        self.brackets.clear();
        self.head = Some(Head { keyword, wanted, assigned: false, to: false, by: false });
    }

    fn begin_statement(&mut self) {
        self.brackets.clear();
        self.statement = self.at;
    }

    // Tokens.

    fn token(&self, at: usize) -> Option<RawToken> {
        self.tokens.get(at).copied()
    }

    fn kind(&self, at: usize) -> Option<RawKind> {
        self.tokens.get(at).map(|token| token.kind)
    }

    fn keyword(&self, at: usize) -> Option<Keyword> {
        self.tokens.get(at).and_then(|token| token.keyword)
    }

    fn slice(&self, token: RawToken) -> &'t str {
        token.text(self.text)
    }

    /// The text from token `first` to token `last`.
    fn words(&self, first: usize, last: usize) -> &'t str {
        match (self.tokens.get(first), self.tokens.get(last)) {
            (Some(first), Some(last)) => {
                self.text.get(first.start as usize..last.end as usize).unwrap_or_default().trim()
            }
            _ => "",
        }
    }

    fn adjacent(&self, at: usize) -> bool {
        match (self.tokens.get(at), self.tokens.get(at + 1)) {
            (Some(token), Some(next)) => token.end == next.start,
            _ => false,
        }
    }

    /// The next token on the same line.
    fn beside(&self, at: usize) -> Option<RawToken> {
        self.token(at).filter(|token| !token.first_on_line)
    }

    /// Whether the walk is at the first token of a statement.
    fn starts(&self, token: RawToken) -> bool {
        self.brackets.is_empty() && self.head.is_none() && (self.at == self.statement || token.first_on_line)
    }

    fn is_declared(&self, word: &str) -> bool {
        self.declared.contains_key(&word.to_uppercase())
    }

    // Repairs.

    /// The token at `first` and those up to `after`, exclusive, are one token: `kind`, or the keyword.
    fn replace(&mut self, first: usize, after: usize, kind: RawKind, keyword: Option<Keyword>) {
        while self.edits.last().is_some_and(|edit| edit.first >= first) {
            self.edits.pop();
        }
        // What an edit before has taken stays with it.
        let first = self.edits.last().map_or(first, |edit| first.max(edit.after));
        let (start, end) = (self.tokens[first], self.tokens[after - 1]);
        let token = RawToken { kind, end: end.end, keyword, ..start };
        self.edits.push(Edit { first, after, with: vec![token] });
        self.at = after;
        self.note(token);
    }

    /// The tokens mean nothing.
    fn drop_tokens(&mut self, first: usize, after: usize) {
        self.edits.push(Edit { first, after, with: Vec::new() });
        self.at = after;
    }

    /// The statement up to `after`, exclusive, has been reported, and takes part in nothing.
    fn give_up(&mut self, after: usize) {
        let first = self.statement.min(self.at);
        self.brackets.clear();
        self.replace(first, after.max(first + 1), RawKind::Reported, None);
    }

    /// Index of the `;` or word that ends the statement in which `at` is.
    fn end_of_statement(&self, at: usize) -> usize {
        let ends =
            |token: &RawToken| token.kind == RawKind::Semicolon || token.keyword.is_some_and(Keyword::ends_expression);
        self.tokens[at..].iter().position(ends).map_or(self.tokens.len(), |found| at + found)
    }

    fn span(&self, first: usize, after: usize) -> Span {
        let (start, end) = (self.tokens[first], self.tokens[after - 1]);
        Span { file: self.file, start: start.start, end: end.end }
    }

    fn report(&mut self, first: usize, after: usize, title: String, label: &str, help: String) {
        let message = Diagnostic::new(Code::ForeignForm, self.span(first, after), title).label(label).help(help);
        self.messages.push(message);
    }

    fn misspelt(&mut self, first: usize, after: usize, keyword: Keyword) {
        let text = self.words(first, after - 1);
        // Their results are those of the operators negated.
        let negated = [("NAND", "AND"), ("NOR", "OR"), ("XNOR", "XOR"), ("EXNOR", "XOR")];
        if let Some((_, operator)) = negated.into_iter().find(|(word, _)| word.eq_ignore_ascii_case(text)) {
            let title = format!("SCL has no operator `{text}`");
            let help = format!("write `NOT (a {operator} b)` for `a {text} b`");
            return self.report(first, after, title, "a form of other languages", help);
        }
        let message = crate::front::frame_words::misspelt(self.span(first, after), text, keyword.word());
        // Without a negative step the loop would never run.
        self.messages.push(match text.eq_ignore_ascii_case("DOWNTO") {
            true => message.help("write `TO`, and `BY -1` before `DO`"),
            false => message,
        });
    }
}

/// The statement that the word ends.
fn opener(end: Keyword) -> Option<Keyword> {
    Some(match end {
        Keyword::EndIf => Keyword::If,
        Keyword::EndCase => Keyword::Case,
        Keyword::EndFor => Keyword::For,
        Keyword::EndWhile => Keyword::While,
        Keyword::EndRepeat => Keyword::Repeat,
        _ => return None,
    })
}

/// The word that ends a statement.
fn closer(opener: Keyword) -> Keyword {
    match opener {
        Keyword::Case => Keyword::EndCase,
        Keyword::For => Keyword::EndFor,
        Keyword::While => Keyword::EndWhile,
        Keyword::Repeat => Keyword::EndRepeat,
        _ => Keyword::EndIf,
    }
}

/// Whether an operand ends with the token.
fn ends_operand(token: RawToken) -> bool {
    match token.kind {
        RawKind::Word => {
            !token.keyword.is_some_and(|word| word.is_operator() || word.ends_expression() || is_link(word))
        }
        kind => {
            is_whole_operand(kind)
                || matches!(kind, RawKind::RightParen | RawKind::RightBracket | RawKind::Reported | RawKind::Slice)
        }
    }
}

/// Whether an operand begins with the token.
fn begins_operand(token: RawToken) -> bool {
    match token.kind {
        RawKind::Word => token.keyword.is_none_or(|word| {
            word == Keyword::Not || !(word.is_operator() || word.ends_expression() || is_link(word))
        }),
        kind => is_whole_operand(kind),
    }
}

/// Whether the token is an operand that no word names.
fn is_whole_operand(kind: RawKind) -> bool {
    matches!(
        kind,
        RawKind::Quoted
            | RawKind::Local
            | RawKind::Number
            | RawKind::Real
            | RawKind::Literal
            | RawKind::Text
            | RawKind::Absolute
    )
}

/// A word between the parts of a head.
fn is_link(word: Keyword) -> bool {
    matches!(word, Keyword::To | Keyword::By | Keyword::Do | Keyword::Of | Keyword::Then)
}
