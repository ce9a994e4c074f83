//! Syntax errors in terms that users know, and what else the actions of the grammar share.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, Span};

use super::ast::{Declaration, Operand, Section};
use super::line::{Line, LineKind};
use super::token::{Spanned, Tok};
use super::{Insn, meant};
use crate::front::{ParseState, Place};
use crate::stl::Mnemonics;

/// State of a parse of STL of the S7-200, with the mnemonic set of the file.
pub type State<'a> = ParseState<'a, Tok<'a>, Mnemonics>;

/// Where a syntax error was recovered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recovery {
    Frame,
    Declaration,
    Data,
    Statement(Insn),
}

impl Place<Tok<'_>, Mnemonics> for Recovery {
    fn message(self, state: &State, found: usize) -> Diagnostic {
        let (code, what, help) = match self {
            Recovery::Frame => (
                Code::BlockFrame,
                "line",
                "a block begins with `SUBROUTINE_BLOCK name:SBR3`, its statements with `BEGIN` and `NETWORK 1`"
                    .to_owned(),
            ),
            Recovery::Declaration => (
                Code::DeclarationSyntax,
                "declaration",
                "a declaration is `name:TYPE;`, and the section ends with `END_VAR`".to_owned(),
            ),
            Recovery::Data => {
                (Code::Syntax, "line of a data block", "a line is an address and its values: `VW10 -5, 300`".to_owned())
            }
            Recovery::Statement(insn) => (Code::Syntax, "statement", form(insn, state.rules)),
        };
        let index = state.index_of(found);
        let (earlier, later) = state.tokens.split_at(index);
        let wide = |token: &&Spanned| token.0 < token.2;
        let range = |(start, _, end): &Spanned| *start..*end;
        let before = earlier.iter().rev().find(wide);
        // A line's end is a token without width at the end of the one before.
        let here = later.iter().take_while(|token| token.1 != Tok::End).find(wide);
        let follows = before.filter(|(_, token, end)| {
            let between = here.and_then(|(start, ..)| state.text.get(*end..*start)).unwrap_or_default();
            *token != Tok::End && !between.contains(['\n', '\r'])
        });
        if let (Recovery::Statement(insn), Some((start, _, end))) = (self, here)
            && let Some(told) = slip(state, insn, *start..*end, before)
        {
            return told;
        }
        if let (Recovery::Statement(insn), None, Some((start, Tok::Comma, end))) = (self, here, before) {
            let commas = earlier.iter().rev().take_while(|token| !matches!(token.1, Tok::Insn(_)));
            let commas = commas.filter(|token| token.1 == Tok::Comma).count();
            if commas >= insn.operands().len() {
                return Diagnostic::new(Code::Syntax, state.span(*start..*end), "no operand follows the last `,`")
                    .label("surplus")
                    .help("remove it");
            }
        }
        state.misplaced(code, what, here.map(range), follows.map(range), before.map_or(found..found, range)).help(help)
    }
}

/// `LDW=> VW0, 5`, `LD I0.0 = Q0.0`, `LD I0.0 ; text`: a form with only one meaning. `range`: the token that does not fit.
fn slip(state: &State, insn: Insn, range: Range<usize>, before: Option<&Spanned>) -> Option<Diagnostic> {
    let text = state.text.get(range.clone())?;
    let line = state.text[range.end..].find(['\n', '\r']).map_or(state.text.len(), |length| range.end + length);
    let rest = state.text[range.end..line].trim();
    let mnemonic = insn.mnemonic(state.rules);
    let told = |range: Range<usize>, title: &str, help: String| {
        Some(Diagnostic::new(Code::ForeignForm, state.span(range), title).label("a form of other languages").help(help))
    };
    if let (Insn::Load | Insn::And | Insn::Or, Some((start, Tok::Direct(_), _))) = (insn, before)
        && let Some(written) = meant::comparison(&mnemonic, without_comment(&state.text[*start..line]))
    {
        return told(range, "a comparison is a part of the mnemonic", format!("write `{written}`"));
    }
    if let (">" | "<", Some(stem)) = (text, mnemonic.strip_suffix('=')) {
        let title = if text == ">" { "greater or equal is `>=`" } else { "less or equal is `<=`" };
        return told(range, title, format!("write `{stem}{text}=`"));
    }
    if text == "=" && !rest.is_empty() {
        return told(
            range,
            "an assignment is a statement of its own",
            format!("write `= {rest}` on a line of its own"),
        );
    }
    let (start, token, _) = before?;
    if *token == Tok::Semicolon {
        let comment = state.text[range.start..line].trim();
        return told(*start..line, "a comment begins with `//`", format!("write `// {comment}`"));
    }
    None
}

fn without_comment(line: &str) -> &str {
    line.split_once("//").map_or(line, |(code, _)| code)
}

/// How many operands a statement has, as help.
pub fn form(insn: Insn, set: Mnemonics) -> String {
    let mnemonic = insn.mnemonic(set);
    match insn.operands().len() {
        _ if insn == Insn::Call => {
            format!("`{mnemonic}` has the subroutine, then its parameters, separated by `,`")
        }
        0 => format!("`{mnemonic}` has no operands"),
        1 => format!("`{mnemonic}` has one operand"),
        count => format!("`{mnemonic}` has {count} operands, separated by `,`"),
    }
}

impl ParseState<'_, Tok<'_>, Mnemonics> {
    pub fn slice(&self, range: Range<usize>) -> (String, Span) {
        (self.text.get(range.clone()).unwrap_or_default().to_owned(), self.span(range))
    }

    pub fn line(&self, kind: LineKind, comment: Option<&str>, range: Range<usize>) -> Line {
        Line { kind, comment: comment.map(str::to_owned), span: self.span(range) }
    }

    /// The number of a block; too large ones are reported.
    pub fn number(&mut self, number: i64, range: Range<usize>) -> Option<(u32, Span)> {
        let span = self.span(range);
        match u32::try_from(number) {
            Ok(number) if number <= 0xFFFF => Some((number, span)),
            _ => {
                self.report(
                    Diagnostic::new(Code::AddressRange, span, format!("no block has the number {number}"))
                        .label("too large")
                        .help("subroutines are SBR0 to SBR127, interrupt routines INT0 to INT127"),
                );
                None
            }
        }
    }

    pub fn declaration(
        &self,
        (name, name_range): (&str, Range<usize>),
        (ty, ty_range): (&str, Range<usize>),
        initial: Option<Operand>,
    ) -> Declaration {
        Declaration {
            // The line is in a section, which `blocks` knows.
            section: Section::Temp,
            name: name.to_owned(),
            name_span: self.span(name_range),
            ty: ty.to_ascii_uppercase(),
            ty_span: self.span(ty_range),
            initial,
            comment: None,
        }
    }
}
