//! The frame of data blocks and types, and declarations.

use super::{Frame, Reader};
use plcc_syntax::scl::keyword::Keyword;
use plcc_syntax::scl::raw::{RawKind, RawToken};

impl Reader<'_, '_> {
    // Data blocks and types.

    /// Head, members, values.
    pub(super) fn data_block(&mut self) {
        self.push();
        self.block_name();
        if self.is_at(RawKind::Colon) {
            self.at += 1;
        }
        let mut begun = false;
        while let Some(token) = self.token() {
            match token.keyword {
                Some(keyword) if keyword.ends_block() => {
                    self.own_attributes();
                    return self.push();
                }
                Some(_) if self.begins_block() => return,
                _ if token.kind == RawKind::LeftBrace => {
                    self.attributes();
                    self.own_attributes();
                }
                _ if begun => self.push(),
                Some(keyword) if keyword.begins_section() => self.section(),
                Some(Keyword::Struct) => self.structure(),
                Some(Keyword::Begin) => {
                    begun = true;
                    self.push();
                }
                _ if matches!(token.kind, RawKind::Word | RawKind::Quoted | RawKind::Local) && self.value_begins() => {
                    self.insert(token, Keyword::Begin);
                    begun = true;
                }
                _ => self.push(),
            }
        }
    }

    /// Whether an assignment follows: `a.b[1] := 5`, or `a = 5`, which is reported with the values.
    fn value_begins(&self) -> bool {
        let mut after_name = false;
        for token in &self.tokens[self.at..] {
            match token.kind {
                // Two words in a row are not a path.
                RawKind::Word | RawKind::Quoted | RawKind::Local if after_name => return false,
                RawKind::Word | RawKind::Quoted | RawKind::Local => after_name = true,
                RawKind::Dot
                | RawKind::LeftBracket
                | RawKind::RightBracket
                | RawKind::Comma
                | RawKind::Number
                | RawKind::Minus => after_name = false,
                RawKind::Assign | RawKind::Equal => return true,
                _ => return false,
            }
        }
        false
    }

    /// The attributes after the name of a data block belong to it.
    fn own_attributes(&mut self) {
        let attributes = self.taken_attributes();
        if let Some(block) = self.blocks.last_mut() {
            block.attributes.extend(attributes);
        }
    }

    /// The types of a TYPE document. SCL needs TYPE and END_TYPE around each.
    pub(super) fn types(&mut self) {
        self.push();
        let mut first = true;
        while let Some(token) = self.token() {
            match token.keyword {
                _ if token.kind == RawKind::LeftBrace => self.attributes(),
                Some(keyword) if keyword.ends_block() => {
                    self.misplaced_attributes();
                    return self.push();
                }
                Some(_) if self.begins_block() => return,
                _ if token.kind == RawKind::Semicolon => self.push(),
                _ => {
                    if !first {
                        self.insert(token, Keyword::EndType);
                        self.insert(token, Keyword::Type);
                        self.blocks.push(Frame { start: token.start, attributes: Vec::new(), networks: Vec::new() });
                    }
                    let attributes = self.taken_attributes();
                    if let Some(block) = self.blocks.last_mut() {
                        block.attributes.extend(attributes);
                    }
                    first = false;
                    self.type_of_document();
                }
            }
        }
    }

    /// `Name : STRUCT … END_STRUCT;`, `Name : Int;`, up to its `;`.
    fn type_of_document(&mut self) {
        if let Some(mut name) = self.token() {
            // `Name : …` alone on its line is not a field of a head.
            name.first_on_line = false;
            self.out.push(name);
            self.at += 1;
        }
        while let Some(token) = self.token() {
            match token.keyword {
                Some(keyword) if keyword.ends_block() => return,
                Some(_) if self.begins_block() => return,
                Some(Keyword::Struct) => self.structure(),
                _ if token.kind == RawKind::LeftBrace => {
                    self.attributes();
                    self.own_attributes();
                }
                _ if token.kind == RawKind::Semicolon => return self.push(),
                _ => self.push(),
            }
        }
    }

    // Declarations.

    /// `VAR … END_VAR`
    pub(super) fn section(&mut self) {
        self.push();
        while let Some(token) = self.token() {
            match token.keyword {
                Some(keyword) if keyword.ends_section() => {
                    self.misplaced_attributes();
                    return self.push();
                }
                Some(keyword) if keyword.ends_block() => return,
                Some(_) if self.begins_block() => return,
                _ if self.network_begins(self.at) => return,
                _ => self.member(token),
            }
        }
    }

    /// `STRUCT … END_STRUCT`
    fn structure(&mut self) {
        let mut depth = 0usize;
        while let Some(token) = self.token() {
            let after_name = self.tokens.get(self.at + 1).is_some_and(|next| next.kind == RawKind::Colon);
            match token.keyword {
                Some(Keyword::Struct) if !after_name => depth += 1,
                Some(Keyword::EndStruct) => {
                    self.misplaced_attributes();
                    self.push();
                    depth = depth.saturating_sub(1);
                    if depth == 0 {
                        return;
                    }
                    continue;
                }
                Some(keyword) if keyword.ends_block() || keyword.ends_section() => return,
                _ => {}
            }
            self.member(token);
        }
    }

    /// A token of a declaration; attributes belong to the name after them, or before them as in SCL: `n { … } : Int`.
    fn member(&mut self, token: RawToken) {
        let is_name = |token: &RawToken| matches!(token.kind, RawKind::Word | RawKind::Quoted | RawKind::Local);
        if token.kind == RawKind::LeftBrace {
            self.attributes();
            if let Some(name) = self.out.last().copied().filter(is_name)
                && self.is_at(RawKind::Colon)
            {
                let attributes = self.taken_attributes();
                self.members.entry(name.start).or_default().extend(attributes);
            }
            return;
        }
        if is_name(&token) {
            let attributes = self.taken_attributes();
            if !attributes.is_empty() {
                self.members.insert(token.start, attributes);
            }
        }
        self.push();
    }
}
