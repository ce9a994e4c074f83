//! Statements of SCL: `StructuredText`. The text of the statements is cut into tokens, operands and calls.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{CodeBlock, TypeKind};
use plcc_syntax::scl::ast::{NameForm, Statement};
use plcc_syntax::scl::{self, address};

use super::access::{self, Whose};
use super::{Library, Uids, comment_text};
use crate::names;
use crate::node::Node;
use crate::trivia::Remark;
use crate::writer::Writer;

/// How deep indices and calls may be nested; what is deeper is written as tokens.
const DEPTH_MAX: usize = 24;

/// The statements of a block or network that ends at byte `end`.
pub fn statements(list: &[Statement], block: &CodeBlock, library: &Library, end: u32, writer: &mut Writer) -> Node {
    let around = std::mem::take(&mut writer.out);
    writer.statements(list);
    writer.remarks_before(end);
    let text = std::mem::replace(&mut writer.out, around).into_text();
    let pieces: Vec<&str> = with_lines(&text);
    let mut node = structured_text();
    let mut maker = Maker { pieces, at: 0, block, library, uids: Uids::new(), depth: 0 };
    while maker.at < maker.pieces.len() {
        maker.piece(&mut node);
    }
    node
}

/// Comments alone.
pub fn remarks(list: &[Remark]) -> Node {
    let mut uids = Uids::new();
    let mut node = structured_text();
    for remark in list {
        node.push(line_comment(&remark.text, &mut uids));
        node.push(Node::new("NewLine").with("UId", uids.next()));
    }
    node
}

fn structured_text() -> Node {
    Node::new("StructuredText")
        .with("xmlns", "http://www.siemens.com/automation/Openness/SW/NetworkSource/StructuredText/v4")
}

fn line_comment(comment: &str, uids: &mut Uids) -> Node {
    let text = Node::of("Text", comment_text(comment)).with("UId", uids.next());
    Node::new("LineComment").with("UId", uids.next()).child(text)
}

/// Adds the tokens of a row of a chart's actions, without blanks at their ends.
pub fn row(text: &str, block: &CodeBlock, library: &Library, node: &mut Node) {
    let mut maker = Maker { pieces: with_lines(text), at: 0, block, library, uids: Uids::new(), depth: 0 };
    while maker.at < maker.pieces.len() {
        maker.piece(node);
    }
}

/// The pieces of a text: words, signs, constants, comments, lines of regions, blanks and the ends of lines.
fn with_lines(text: &str) -> Vec<&str> {
    let mut ranges = scl::pieces(text);
    ranges.extend(scl::regions(text));
    ranges.sort_by_key(|range| range.start);
    let mut found = Vec::new();
    let mut end = 0;
    for piece in ranges {
        add_blanks(&text[end..piece.start], &mut found);
        found.push(&text[piece.clone()]);
        end = piece.end;
    }
    add_blanks(&text[end..], &mut found);
    found
}

fn add_blanks<'a>(text: &'a str, found: &mut Vec<&'a str>) {
    for line in text.split_inclusive('\n') {
        let (blanks, rest) = line.split_at(line.len() - usize::from(line.ends_with('\n')));
        found.extend([blanks, rest].into_iter().filter(|piece| !piece.is_empty()));
    }
}

/// Words before parentheses that are not functions.
const KEYWORDS: [&str; 22] = [
    "AND", "BY", "CASE", "DIV", "DO", "ELSE", "ELSIF", "EXIT", "FOR", "GOTO", "IF", "MOD", "NOT", "OF", "OR", "REPEAT",
    "RETURN", "THEN", "TO", "UNTIL", "WHILE", "XOR",
];

struct Maker<'a> {
    pieces: Vec<&'a str>,
    at: usize,
    block: &'a CodeBlock,
    library: &'a Library,
    uids: Uids,
    depth: usize,
}

impl<'a> Maker<'a> {
    fn peek(&self, ahead: usize) -> &'a str {
        self.pieces.get(self.at + ahead).copied().unwrap_or_default()
    }

    fn numbered(&mut self, name: &'static str) -> Node {
        Node::new(name).with("UId", self.uids.next())
    }

    /// Takes the next piece, with what belongs to it.
    fn piece(&mut self, list: &mut Node) {
        let piece = self.peek(0);
        if piece == "\n" {
            self.at += 1;
            return list.push(self.numbered("NewLine"));
        }
        if piece.trim().is_empty() {
            self.at += 1;
            let blanks = piece.chars().count();
            let blank = self.numbered("Blank");
            return list.push(if blanks > 1 { blank.with("Num", blanks) } else { blank });
        }
        if piece.starts_with("//") || piece.starts_with("(*") || piece.starts_with("/*") || piece.starts_with("(/*") {
            self.at += 1;
            return list.push(line_comment(piece, &mut self.uids));
        }
        if let Some((word, name)) = region(piece) {
            self.at += 1;
            list.push(self.numbered("Token").with("Text", word));
            if !name.is_empty() {
                list.push(self.numbered("Blank"));
                list.push(Node::of("Text", name).with("UId", self.uids.next()));
            }
            return;
        }
        let is_call = self.peek(1) == "(" && self.depth < DEPTH_MAX;
        let is_keyword = KEYWORDS.iter().any(|word| word.eq_ignore_ascii_case(piece));
        if is_call && !is_keyword && is_word(piece) && !self.is_instance(piece) {
            let node = Node::new("Instruction").with("Name", piece);
            self.at += 1;
            return self.call(node, list);
        }
        if is_call && is_quoted(piece) {
            self.at += 1;
            return self.block_call(piece, list);
        }
        if is_constant(piece) {
            self.at += 1;
            let constant = Node::new("Constant").child(Node::of("ConstantValue", piece));
            return list.push(self.numbered("Access").with("Scope", "LiteralConstant").child(constant));
        }
        if let Some(rest) = piece.strip_prefix('%')
            && self.peek(1) != "."
        {
            let found = address::token(rest, Span::default()).and_then(|kind| access::address(&kind));
            if let Some(place) = found.filter(|_| !rest.contains(':')) {
                self.at += 1;
                return list.push(self.numbered("Access").with("Scope", "Address").child(place));
            }
        }
        let is_variable =
            piece.starts_with('#') || is_quoted(piece) || is_word(piece) && !is_keyword && self.is_variable(piece);
        if is_variable && self.depth < DEPTH_MAX {
            return self.variable(list);
        }
        self.at += 1;
        list.push(self.numbered("Token").with("Text", piece));
    }

    /// A word that the block declares.
    fn is_variable(&self, word: &str) -> bool {
        access::whose(word, NameForm::Bare, self.block) != Whose::Global
    }

    /// A variable that can be called; others have the names of functions.
    fn is_instance(&self, word: &str) -> bool {
        let mut variables = self.block.sections.iter().flat_map(|section| &section.variables);
        let variable = variables.find(|variable| variable.name.eq_ignore_ascii_case(word));
        match variable.map(|variable| &variable.ty.kind) {
            Some(TypeKind::Block(_)) => true,
            Some(TypeKind::Named(name)) => !Elementary::ALL.iter().any(|ty| ty.name().eq_ignore_ascii_case(name)),
            _ => false,
        }
    }

    /// `#a.b[1].c`, `"db".x`; an instance is called.
    fn variable(&mut self, list: &mut Node) {
        // Of `"tag":P` the letter stays.
        let first = self.peek(0).replace('"', "");
        let (name, form) = match (first.strip_prefix('#'), is_quoted(self.peek(0))) {
            (Some(name), _) => (name, NameForm::Local),
            (None, true) => (first.as_str(), NameForm::Quoted),
            (None, false) => (first.as_str(), NameForm::Bare),
        };
        let whose = access::whose(name, form, self.block);
        if whose == Whose::LocalConstant {
            self.at += 1;
            let constant = Node::new("Constant").with("Name", name);
            return list.push(self.numbered("Access").with("Scope", "LocalConstant").child(constant));
        }
        let start = self.at;
        let mut symbol = Node::new("Symbol").child(access::named(name));
        self.at += 1;
        loop {
            match (self.peek(0), self.peek(1)) {
                (".", next) if is_name(names::without_periphery(next).unwrap_or(next)) => {
                    symbol.push(access::named(&next.replace('"', "")));
                    self.at += 2;
                }
                (".", next) if next.starts_with('%') && slice(&next[1..]).is_some() => {
                    let Some(last) = symbol.children.last_mut() else { break };
                    access::push_slice(last, slice(&next[1..]).unwrap_or_default());
                    self.at += 2;
                }
                ("[", _) => {
                    let indices = self.indices();
                    let Some(last) = symbol.children.last_mut() else { break };
                    match last.attributes.iter_mut().find(|(key, _)| *key == "AccessModifier") {
                        Some((_, modifier)) if modifier == "Reference" => *modifier = "ReferenceToArray".to_string(),
                        // Elements of elements.
                        Some(_) => {}
                        None => last.attributes.push(("AccessModifier", "Array".to_string())),
                    }
                    last.children.extend(indices);
                }
                ("^", _) if symbol.children.last().is_none_or(|last| last.attributes.len() <= 1) => {
                    let Some(last) = symbol.children.last_mut() else { break };
                    last.attributes.push(("AccessModifier", "Reference".to_string()));
                    self.at += 1;
                }
                _ => break,
            }
        }
        let scope = if whose == Whose::Global { "GlobalVariable" } else { "LocalVariable" };
        if self.peek(0) == "(" {
            // An instance, perhaps with the name of its block after a point.
            let of = self.block_of(name, whose, symbol.children.len() == 1);
            let mut instance = symbol;
            instance.name = "Instance";
            if instance.children.len() > 1
                && let Some(last) = instance.children.last()
                && let Some((_, method)) = last.attributes.first()
                && self.pieces[start + 1..self.at].len() == 2
                && last.attributes.len() == 1
            {
                let node = Node::new("Instruction").with("Name", method.clone());
                instance.children.pop();
                return self.call(node.child(self.scoped(instance, scope)), list);
            }
            let node = Node::new("CallInfo").with("Name", of).with("BlockType", "FB");
            return self.call(node.child(self.scoped(instance, scope)), list);
        }
        list.push(self.numbered("Access").with("Scope", scope).child(symbol));
    }

    fn scoped(&self, mut node: Node, scope: &str) -> Node {
        node.attributes.push(("Scope", scope.to_string()));
        node
    }

    /// The block of an instance, if the sources say it.
    fn block_of(&self, name: &str, whose: Whose, alone: bool) -> String {
        if whose == Whose::Global {
            return self.library.instance(name).unwrap_or_default();
        }
        let mut variables = self.block.sections.iter().flat_map(|section| &section.variables);
        let variable = variables.find(|variable| alone && variable.name.eq_ignore_ascii_case(name));
        match variable.map(|variable| &variable.ty.kind) {
            Some(TypeKind::Block(name)) => self.library.block_name(name),
            Some(TypeKind::Named(name)) => name.clone(),
            _ => String::new(),
        }
    }

    /// `[1, #i + 1]` as the elements of a component.
    fn indices(&mut self) -> Vec<Node> {
        let mut node = Node::new("Component");
        let mut depth = 0;
        self.depth += 1;
        while self.at < self.pieces.len() {
            match self.peek(0) {
                "[" => {
                    depth += 1;
                    self.at += 1;
                    node.push(self.numbered("Token").with("Text", "["));
                }
                "]" => {
                    depth -= 1;
                    self.at += 1;
                    node.push(self.numbered("Token").with("Text", "]"));
                    if depth == 0 {
                        break;
                    }
                }
                _ => self.piece(&mut node),
            }
        }
        self.depth -= 1;
        node.children
    }

    /// `"Block"(…)`: a function, or an instance data block.
    fn block_call(&mut self, piece: &str, list: &mut Node) {
        let name = piece.trim_matches('"');
        match self.library.instance(name) {
            Some(of) => {
                let instance = Node::new("Instance").child(Node::new("Component").with("Name", name));
                let node = Node::new("CallInfo").with("Name", of).with("BlockType", "FB");
                self.call(node.child(self.scoped(instance, "GlobalVariable")), list);
            }
            None => self.call(Node::new("CallInfo").with("Name", name).with("BlockType", "FC"), list),
        }
    }

    /// The parentheses of a call, with its parameters.
    fn call(&mut self, mut info: Node, list: &mut Node) {
        self.depth += 1;
        info.attributes.push(("UId", self.uids.next().to_string()));
        let mut depth = 0;
        // What follows the name of a parameter is in it.
        let mut parameter: Option<Node> = None;
        while self.at < self.pieces.len() {
            let piece = self.peek(0);
            match piece {
                "(" => depth += 1,
                ")" => depth -= 1,
                _ => {}
            }
            let ends = depth == 0 || depth == 1 && piece == ",";
            if ends || piece == "(" && depth == 1 {
                info.children.extend(parameter.take());
                self.at += 1;
                info.push(self.numbered("Token").with("Text", piece));
                if depth == 0 {
                    break;
                }
                continue;
            }
            let sign = if self.peek(1) == " " { self.peek(2) } else { self.peek(1) };
            if depth == 1 && parameter.is_none() && is_name(piece) && matches!(sign, ":=" | "=>") {
                self.at += 1;
                parameter = Some(self.numbered("Parameter").with("Name", piece.trim_matches('"')));
                continue;
            }
            // An argument without a name.
            if depth >= 1 && parameter.is_none() && !piece.trim().is_empty() && piece != "," {
                parameter = Some(self.numbered("NamelessParameter"));
            }
            let target = parameter.as_mut().unwrap_or(&mut info);
            if matches!(piece, "(" | ")") {
                let uid = self.uids.next();
                target.push(Node::new("Token").with("Text", piece).with("UId", uid));
                self.at += 1;
            } else {
                let mut inner = std::mem::take(target);
                self.piece(&mut inner);
                match parameter.as_mut() {
                    Some(parameter) => *parameter = inner,
                    None => info = inner,
                }
            }
        }
        info.children.extend(parameter);
        self.depth -= 1;
        list.push(self.numbered("Access").with("Scope", "Call").child(info));
    }
}

/// The word of a line that opens or closes a region, and the name after it. `REGION` alone is a token like others.
fn region(piece: &str) -> Option<(&'static str, &str)> {
    let after = |word: &'static str| {
        let (head, rest) = piece.split_at_checked(word.len())?;
        let is_whole = !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_');
        (head.eq_ignore_ascii_case(word) && is_whole).then(|| (word, rest.trim().trim_matches(';').trim_end()))
    };
    after("END_REGION").or_else(|| after("REGION").filter(|(_, name)| !name.is_empty()))
}

fn is_quoted(piece: &str) -> bool {
    piece.len() > 1 && piece.starts_with('"')
}

fn is_word(piece: &str) -> bool {
    piece.starts_with(|c: char| c.is_alphabetic() || c == '_') && piece.chars().all(|c| c.is_alphanumeric() || c == '_')
}

/// A name as it follows a point, or stands before `:=`.
fn is_name(piece: &str) -> bool {
    is_word(piece) || is_quoted(piece)
}

/// `T#5s`, `16#FF`, `'text'`, `1.5`, `TRUE`.
fn is_constant(piece: &str) -> bool {
    let is_bool = ["TRUE", "FALSE"].iter().any(|word| word.eq_ignore_ascii_case(piece));
    is_bool
        || piece.starts_with('\'')
        || piece.starts_with(|c: char| c.is_ascii_digit())
        || !piece.starts_with(['#', '"']) && piece.contains('#')
}

/// `X3` of `.%X3`, as the attribute of a component.
fn slice(text: &str) -> Option<String> {
    let (letter, digits) = text.split_at_checked(1)?;
    let is_number = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
    (is_number && "XBWDLxbwdl".contains(letter)).then(|| text.to_lowercase())
}
