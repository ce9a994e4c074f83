//! The layout of blocks by their keywords: what a word opens is indented, and what closes it stands below it.

use plcc_syntax::Language;

use crate::keywords::{BLOCKS, CHART, Inside, MODIFIERS, SECTIONS, closes, is_end_of_block, is_region};
use crate::lines::{Kind, Line};
use crate::piece::{Begins, Part, Piece};
use crate::spacing::{self, Open, Place};
use crate::stl;

/// Where the text is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Zone {
    /// Between blocks, or in a head.
    Head,
    Declarations,
    Code,
}

struct Layout<'p, 't> {
    language: Language,
    pieces: &'p [Piece<'t>],
    zone: Zone,
    stack: Vec<Inside>,
    open: Open,
    /// A statement or a declaration has begun and not ended.
    continued: bool,
    /// The block contains values or types only.
    is_data: bool,
    lines: Vec<Line>,
}

/// The lines of a part.
pub fn lay_out(part: &Part) -> Vec<Line> {
    let mut layout = Layout {
        language: part.language,
        pieces: &part.pieces,
        zone: if begins_with_code(part) { Zone::Code } else { Zone::Head },
        stack: Vec::new(),
        open: Open::default(),
        continued: false,
        is_data: false,
        lines: Vec::new(),
    };
    let mut start = 0;
    while start < layout.pieces.len() {
        start = layout.line(start);
    }
    let mut lines = layout.lines;
    comments_belong_below(&mut lines, part.language);
    lines
}

/// A source of statements without a block.
fn begins_with_code(part: &Part) -> bool {
    let first = part.pieces.iter().find(|piece| !piece.is_comment());
    first.is_some_and(|first| {
        !first.is_any(&BLOCKS) && !first.text.starts_with('{') && first.text != ";" || first.is("NETWORK")
    })
}

impl<'t> Layout<'_, 't> {
    fn piece(&self, at: usize) -> &Piece<'t> {
        &self.pieces[at]
    }

    fn is_stl_code(&self) -> bool {
        self.language == Language::Stl && self.zone == Zone::Code && !self.is_data
    }

    /// Lays out the line that begins at a piece; returns the piece after it.
    fn line(&mut self, start: usize) -> usize {
        let apart = self.piece(start).line_ends > 1;
        self.enter(start);
        let depth = self.depth_of(start);
        let was_continued = self.continued;
        let in_statements = self.is_stl_code();
        let is_statement = in_statements && !self.is_frame(start);
        let zone = self.zone;
        let mut place = self.place(start);
        let mut code = String::new();
        let mut comment = "";
        let mut at = start;
        loop {
            let piece = &self.pieces[at];
            if at > start {
                if piece.is_line_comment() && !code.is_empty() {
                    comment = piece.text;
                    at += 1;
                    break;
                }
                if self.stack.contains(&Inside::Rung) {
                    place = Place::Rung;
                }
                code.push_str(spacing::between(self.language, place, self.open, &self.pieces[at - 1], piece));
            }
            code.push_str(piece.text);
            if !self.is_stl_code() {
                // Only a sign asks what is before it.
                let is_sign = matches!(piece.text, "+" | "-");
                let before = self.pieces[..at].iter().rev().find(|before| !is_sign || !before.is_comment());
                self.open.pass(before, piece);
            }
            self.pass(start, at);
            at += 1;
            if at == self.pieces.len() || self.pieces[at].line_ends > 0 {
                break;
            }
            let next = &self.pieces[at];
            if !next.is_comment() && (self.breaks_before(at) || self.closes_after_comments(start, at)) {
                break;
            }
        }
        let only_comment = self.piece(start).is_comment() && at == start + 1;
        let line = if is_statement {
            self.statement_line(start, at, comment, only_comment)
        } else {
            let kind = match zone {
                _ if only_comment => Kind::Comment,
                Zone::Head => Kind::Frame,
                Zone::Declarations => Kind::Declaration,
                Zone::Code => Kind::Statement,
            };
            let depth = if in_statements { 0 } else { depth + usize::from(was_continued) };
            Line { indent: depth * self.step(), code, comment: comment.to_owned(), apart, kind }
        };
        self.lines.push(Line { apart, ..line });
        at
    }

    /// A line of STL after BEGIN.
    fn statement_line(&self, start: usize, end: usize, comment: &str, only_comment: bool) -> Line {
        let first = self.piece(start);
        if only_comment {
            let margin = first.at_margin || first.text.starts_with("//@");
            let indent = if margin { 0 } else { 6 };
            return Line { indent, code: first.text.to_owned(), kind: Kind::Comment, ..Line::default() };
        }
        let end = end - usize::from(!comment.is_empty());
        let mut line = stl::line(&self.pieces[start..end], self.name_width(start));
        line.comment = comment.to_owned();
        line
    }

    /// Columns of the longest name among the parameters that stand below one another around a piece.
    fn name_width(&self, at: usize) -> usize {
        if self.piece(at).begins != Begins::Parameter {
            return 0;
        }
        let ends = |piece: &&Piece| matches!(piece.begins, Begins::Mnemonic | Begins::Label);
        let first = self.pieces[..at].iter().rposition(|piece| ends(&piece)).unwrap_or(0);
        let after = self.pieces[at..].iter().position(|piece| ends(&piece));
        let call = &self.pieces[first..after.map_or(self.pieces.len(), |after| at + after)];
        let names = call.iter().filter(|piece| piece.begins == Begins::Parameter && piece.line_ends > 0);
        names.map(|piece| piece.text.chars().count()).max().unwrap_or(0)
    }

    /// A line of the frame inside code of STL.
    fn is_frame(&self, at: usize) -> bool {
        let piece = self.piece(at);
        let is_title =
            piece.text.len() >= 5 && piece.text.is_char_boundary(5) && piece.text[..5].eq_ignore_ascii_case("TITLE");
        piece.begins == Begins::Nothing
            && (is_title
                || piece.is_any(&["BEGIN", "NETWORK", "NETZWERK"])
                || piece.is_any(&BLOCKS)
                || is_end_of_block(piece))
    }

    fn step(&self) -> usize {
        if self.language == Language::Sd { 4 } else { 2 }
    }

    fn place(&self, start: usize) -> Place {
        if self.stack.contains(&Inside::Rung) || self.piece(start).is("RUNG") && self.language == Language::Sd {
            return Place::Rung;
        }
        match self.zone {
            Zone::Head => Place::Frame,
            Zone::Code if self.language == Language::Graph => Place::Frame,
            Zone::Code if self.piece(start).is_any(&["NETWORK"]) => Place::Frame,
            Zone::Declarations => Place::Declaration,
            Zone::Code => Place::Code,
        }
    }

    /// Whether a word counts as a keyword here.
    fn counts(&self, at: usize) -> bool {
        let piece = self.piece(at);
        let member = at > 0 && matches!(self.piece(at - 1).text, "." | "#") && !piece.spaced && piece.line_ends == 0;
        let named = self.pieces.get(at + 1).is_some_and(|next| {
            matches!(next.text, "." | "=>" | "+=")
                || next.text == ":=" && !piece.is("CONDITION")
                || matches!(next.text, ":" | ",") && self.zone == Zone::Declarations
        });
        !member && !named && !self.open.any()
    }

    /// The zone that a line is in, by its first piece.
    fn enter(&mut self, start: usize) {
        let pieces = self.pieces;
        let piece = &pieces[start];
        if self.open.any() || self.is_stl_code() && piece.begins != Begins::Nothing {
            return;
        }
        let declared = self.zone == Zone::Declarations && self.stack.last().is_some_and(|_| !self.counts(start));
        if declared || self.continued {
            return;
        }
        if piece.is_any(&BLOCKS) && self.stack.is_empty() {
            self.zone = Zone::Head;
            self.is_data = piece.is_any(&["DATA_BLOCK", "TYPE"]);
        } else if piece.is_any(&SECTIONS) || piece.is("STRUCT") && self.zone == Zone::Head {
            self.zone = Zone::Declarations;
        } else if piece.is_any(&["BEGIN", "NETWORK", "NETZWERK"])
            || self.language == Language::Graph && piece.is_any(&CHART)
        {
            self.zone = Zone::Code;
        } else if self.zone == Zone::Declarations
            && self.stack.iter().all(|inside| *inside == Inside::Block)
            && !piece.is_comment()
        {
            // Classic blocks begin their statements without BEGIN.
            let data = is_end_of_block(piece) || piece.text.starts_with('{');
            if !data && !piece.is_any(&SECTIONS) && !piece.is("STRUCT") && piece.text != ";" {
                self.zone = Zone::Code;
                if self.stack.is_empty() {
                    self.stack.push(Inside::Block);
                }
            }
        }
    }

    /// Depth of the line that begins at a piece; closes what its first word closes.
    fn depth_of(&mut self, start: usize) -> usize {
        let piece = self.pieces[start].clone();
        if piece.is_comment() || self.is_stl_code() && piece.begins != Begins::Nothing {
            return self.stack.len();
        }
        if self.open.any() {
            let closes =
                matches!(piece.text, ")" | "]" | "}") && self.open.parens + self.open.brackets + self.open.braces == 1;
            let more = usize::from(!self.continued && !closes);
            return self.stack.len() + more;
        }
        if !self.counts(start) {
            self.label(start);
            return self.stack.len();
        }
        if is_end_of_block(&piece) {
            self.stack.clear();
            self.continued = false;
            return 0;
        }
        if piece.is("BEGIN") {
            return 0;
        }
        if piece.is_any(&["ELSE", "ELSIF"]) {
            self.continued = false;
            self.close(&[Inside::Branch, Inside::If]);
            return self.stack.len();
        }
        if piece.is("UNTIL") {
            self.continued = false;
            return self.stack.len().saturating_sub(1);
        }
        if let Some(closed) = closes(&piece) {
            self.continued = false;
            let found = self.stack.iter().rposition(|inside| *inside == closed);
            if let Some(found) = found {
                self.stack.truncate(found);
            }
            return self.stack.len();
        }
        self.label(start);
        self.stack.len()
    }

    /// Closes the innermost, if it is one of these.
    fn close(&mut self, kinds: &[Inside]) {
        if self.stack.last().is_some_and(|inside| kinds.contains(inside)) {
            self.stack.pop();
        }
    }

    /// A label of CASE ends the branch before it.
    fn label(&mut self, start: usize) {
        if self.is_case_label(start) {
            self.close(&[Inside::Branch]);
        }
    }

    /// Whether values of CASE and a colon begin at a piece.
    fn is_case_label(&self, start: usize) -> bool {
        if self.continued || !matches!(self.stack.last(), Some(Inside::Case | Inside::Branch)) {
            return false;
        }
        for piece in &self.pieces[start..] {
            match piece.text {
                ":" => return true,
                ":=" | ";" | "(" | "[" => return false,
                _ if piece.is_any(&["IF", "FOR", "WHILE", "CASE", "REPEAT", "END_CASE", "ELSE"]) => return false,
                _ => {}
            }
        }
        false
    }

    /// What a piece opens, closes or ends, after it is written.
    fn pass(&mut self, start: usize, at: usize) {
        let piece = self.pieces[at].clone();
        if piece.is_comment() || self.is_stl_code() && piece.begins != Begins::Nothing {
            return;
        }
        if self.is_stl_code() && !(at == start && self.is_frame(start)) {
            return;
        }
        if piece.text == ";" && !self.open.any() {
            self.continued = false;
            return;
        }
        if self.open.any() || matches!(piece.text, "}") {
            return;
        }
        if self.zone == Zone::Head {
            if at == start && self.language == Language::Sd && piece.is_any(&BLOCKS) {
                self.stack.push(Inside::Block);
            }
            return;
        }
        if piece.text == ":" && self.is_case_label_end(start, at) {
            self.stack.push(Inside::Branch);
            self.continued = false;
            return;
        }
        if piece.text == ":" && at == start + 1 && self.language == Language::Scl && self.zone == Zone::Code {
            // A jump label, or `ELSE:`.
            self.continued = false;
            return;
        }
        if !self.counts(at) {
            self.continued |= self.language != Language::Graph || self.zone == Zone::Declarations;
            return;
        }
        let first = at == start;
        let opened = self.opens(&piece, first);
        if let Some(opened) = opened {
            if opened == Inside::Struct && self.zone != Zone::Declarations {
                return;
            }
            self.stack.push(opened);
            self.continued = false;
            return;
        }
        if !first && let Some(closed) = closes(&piece) {
            if let Some(found) = self.stack.iter().rposition(|inside| *inside == closed) {
                self.stack.truncate(found);
            }
            self.continued = false;
            return;
        }
        let ends = piece.is_any(&["BEGIN", "NETWORK", "NETZWERK"])
            || self.language == Language::Stl && self.zone == Zone::Code && !self.is_data
            || piece.is_any(&MODIFIERS) && self.pieces[start].is_any(&SECTIONS)
            || closes(&piece).is_some()
            || is_end_of_block(&piece)
            || first && is_region(&piece)
            || self.stack.last() == Some(&Inside::Rung)
            || self.pieces[start].is_any(&["RUNG", "END_RUNG"]) && self.language == Language::Sd
            || self.language == Language::Graph && self.zone == Zone::Code;
        if piece.is("BEGIN") && self.stack.is_empty() {
            self.stack.push(Inside::Block);
        }
        self.continued = !ends;
    }

    fn is_case_label_end(&self, start: usize, at: usize) -> bool {
        self.zone == Zone::Code
            && self.language != Language::Graph
            && self.stack.last() == Some(&Inside::Case)
            && self.pieces[start..at].iter().all(|piece| !matches!(piece.text, ":=" | ";" | "(" | ":"))
    }

    /// What a keyword opens.
    fn opens(&self, piece: &Piece, first: bool) -> Option<Inside> {
        let chart = self.language == Language::Graph && first && self.zone == Zone::Code;
        if self.zone == Zone::Declarations {
            return match () {
                () if first && piece.is_any(&SECTIONS) => Some(Inside::Section),
                () if piece.is("STRUCT") => Some(Inside::Struct),
                () => None,
            };
        }
        if chart {
            return piece.is_any(&CHART).then_some(Inside::Chart);
        }
        match () {
            () if piece.is("THEN") => Some(Inside::If),
            () if piece.is_any(&["DO", "REPEAT"]) => Some(Inside::Loop),
            () if piece.is("OF") => Some(Inside::Case),
            () if first && piece.is("NETWORK") && self.language == Language::Sd => Some(Inside::Network),
            () if first && piece.is("RUNG") && self.language == Language::Sd => Some(Inside::Rung),
            () if first && is_region(piece) => Some(Inside::Region),
            () if first && piece.is("ELSE") => {
                Some(if self.stack.last() == Some(&Inside::Case) { Inside::Branch } else { Inside::If })
            }
            () => None,
        }
    }

    /// Whether a piece is the last one of the keywords of a section, if the piece `next` follows.
    fn opens_section(&self, at: usize, next: &Piece) -> bool {
        let piece = self.piece(at);
        let section = piece.is_any(&SECTIONS)
            || piece.is_any(&MODIFIERS) && at > 0 && self.piece(at - 1).is_any(&[&SECTIONS[..], &MODIFIERS].concat());
        section && !next.is_any(&MODIFIERS)
    }

    /// The piece before a piece, in its line without comments.
    fn before(&self, at: usize) -> usize {
        let mut before = at - 1;
        while before > 0 && self.piece(before).is_comment() && self.piece(before).line_ends == 0 {
            before -= 1;
        }
        before
    }

    /// Whether the piece begins a line, though it does not in the source.
    fn breaks_before(&self, at: usize) -> bool {
        let (before, piece) = (self.piece(at - 1), self.piece(at));
        if self.language == Language::Graph {
            return false;
        }
        if self.is_stl_code() {
            return stl::begins_statement(self.pieces, at)
                || piece.begins == Begins::Nothing
                    && (is_end_of_block(piece) || piece.is("NETWORK") && before.text == ";" || before.is("BEGIN"));
        }
        if self.open.any() || matches!(piece.text, ";" | ":") {
            return false;
        }
        if self.zone == Zone::Head {
            return piece.is_any(&SECTIONS) || piece.is_any(&["BEGIN", "STRUCT"]) && before.text != ":";
        }
        if self.stack.last() == Some(&Inside::Rung) {
            return false;
        }
        let last = self.before(at);
        let before = self.piece(last);
        before.text == ";"
            || self.counts(last)
                && before.is_any(&["THEN", "DO", "OF", "ELSE", "REPEAT", "BEGIN", "END_VAR"])
                && self.zone == Zone::Code
            || self.zone == Zone::Declarations
                && self.counts(last)
                && (before.is_any(&["STRUCT", "END_VAR"]) || self.opens_section(last, piece))
            || is_end_of_block(piece)
    }
}

impl Layout<'_, '_> {
    /// Whether a word that closes something has only comments before it in its line, which then get a line of their own.
    fn closes_after_comments(&self, start: usize, at: usize) -> bool {
        let piece = self.piece(at);
        (piece.is_any(&["ELSE", "ELSIF", "UNTIL"]) || closes(piece).is_some())
            && self.zone == Zone::Code
            && !matches!(self.language, Language::Graph | Language::Stl)
            && self.stack.last() != Some(&Inside::Rung)
            && !self.continued
            && self.counts(at)
            && self.pieces[start..at].iter().all(Piece::is_comment)
    }
}

/// A comment alone belongs to the line below it, unless that closes something.
fn comments_belong_below(lines: &mut [Line], language: Language) {
    if language == Language::Stl {
        return;
    }
    for at in (0..lines.len().saturating_sub(1)).rev() {
        let below = &lines[at + 1];
        let closes = below.code.get(..4).is_some_and(|word| word.eq_ignore_ascii_case("END_"));
        let keeps = closes || below.apart || below.code.get(..5).is_some_and(|word| word.eq_ignore_ascii_case("UNTIL"));
        if lines[at].kind == Kind::Comment && !keeps {
            lines[at].indent = below.indent;
        }
    }
}
