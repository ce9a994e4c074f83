//! Frames of blocks, which STL and SCL share: headers, and what the keyword of a block says about its kind.

use plcc_diag::{Code, Diagnostic, Span};

use super::frame_words;
use crate::ast::{Block, BlockName, BlockPrefix, Code as BlockCode, CodeBlock, CodeKind, Header};
use crate::stl::token::{CodeKeyword, HeaderField, HeaderFlag};

/// A part of a header.
pub enum HeaderPart {
    Title(String),
    Text(HeaderField, String),
    Flag(HeaderFlag),
    Attributes(Vec<(String, String)>),
}

/// The header of a block, with its comment lines.
pub fn header(comment: Vec<String>, parts: Vec<HeaderPart>) -> Header {
    let mut header = Header { comment, ..Header::default() };
    for part in parts {
        match part {
            HeaderPart::Title(text) => header.title = Some(text),
            HeaderPart::Text(HeaderField::Author, text) => header.author = Some(text),
            HeaderPart::Text(HeaderField::Family, text) => header.family = Some(text),
            HeaderPart::Text(HeaderField::Name, text) => header.name = Some(text),
            HeaderPart::Text(HeaderField::Version, text) => header.version = Some(text),
            HeaderPart::Flag(HeaderFlag::KnowHowProtect) => header.know_how_protect = true,
            HeaderPart::Flag(HeaderFlag::Standard) => header.standard = true,
            HeaderPart::Flag(HeaderFlag::CodeVersion1) => header.code_version1 = true,
            HeaderPart::Flag(HeaderFlag::Unlinked) => header.unlinked = true,
            HeaderPart::Flag(HeaderFlag::ReadOnly) => header.read_only = true,
            HeaderPart::Flag(HeaderFlag::NonRetain) => header.non_retain = true,
            HeaderPart::Flag(HeaderFlag::Retain) => header.retain = true,
            HeaderPart::Attributes(attributes) => header.attributes.extend(attributes),
        }
    }
    header
}

/// Kind of the block `name`: from its keyword; the letters of the number distinguish SFC and SFB. Wrong letters are reported, too.
pub fn code_kind(keyword: CodeKeyword, name: &BlockName, text: &str) -> (CodeKind, Option<Diagnostic>) {
    let (kind, keyword, letters) = match keyword {
        CodeKeyword::OrganizationBlock => (CodeKind::Ob, "ORGANIZATION_BLOCK", "OB"),
        CodeKeyword::Function => (CodeKind::Fc, "FUNCTION", "FC"),
        CodeKeyword::FunctionBlock => (CodeKind::Fb, "FUNCTION_BLOCK", "FB"),
    };
    let BlockName::Numbered { prefix, number, span } = name else { return (kind, None) };
    match (kind, prefix) {
        (CodeKind::Ob, BlockPrefix::Ob) | (CodeKind::Fc, BlockPrefix::Fc) | (CodeKind::Fb, BlockPrefix::Fb) => {
            (kind, None)
        }
        (CodeKind::Fc, BlockPrefix::Sfc) => (CodeKind::Sfc, None),
        (CodeKind::Fb, BlockPrefix::Sfb) => (CodeKind::Sfb, None),
        _ => (kind, Some(wrong_letters(*span, keyword, letters, *number, text))),
    }
}

/// The message for a block whose number has a prefix that does not fit its keyword.
pub fn wrong_letters(span: Span, keyword: &str, letters: &str, number: u32, text: &str) -> Diagnostic {
    Diagnostic::new(Code::BlockFrame, span, format!("`{keyword}` cannot name `{}`", &text[span.range()]))
        .label(format!("a block with this keyword is numbered as {letters}"))
        .help(format!("write `{keyword} {letters} {number}`, or the keyword that belongs to the block"))
}

/// Statements without a header: OB 1.
pub fn implied_ob(code: BlockCode, span: Span) -> Block {
    Block::Code(CodeBlock {
        kind: CodeKind::Ob,
        name: BlockName::Numbered { prefix: BlockPrefix::Ob, number: 1, span: Span { end: span.start, ..span } },
        return_type: None,
        header: Header::default(),
        sections: Vec::new(),
        constants: Vec::new(),
        code,
        span,
    })
}

/// Leaves out statements without a header that do not parse, next to an OB 1 with its header: the head of a block was damaged,
/// and what its statements mean elsewhere would be reported, too. The messages are in the order of the text.
pub fn drop_damaged_statements(blocks: &mut Vec<Block>, diagnostics: &[Diagnostic]) {
    let ob1 = |block: &Block| match block {
        Block::Code(CodeBlock { name: BlockName::Numbered { prefix: BlockPrefix::Ob, number: 1, span }, .. }) => {
            Some(*span)
        }
        Block::Code(_) | Block::Data(_) | Block::Type(_) => None,
    };
    let is_bare = |block: &Block| ob1(block).is_some_and(|name| name.start == name.end);
    if !blocks.iter().any(|block| ob1(block).is_some() && !is_bare(block)) {
        return;
    }
    blocks.retain(|block| {
        let span = block.span();
        let first = diagnostics.partition_point(|told| told.primary.span.start < span.start);
        let mut inside = diagnostics[first..].iter().take_while(|told| told.primary.span.start <= span.end);
        !(is_bare(block) && inside.any(Diagnostic::is_error))
    });
}

/// The message for `word`, which ends a block that no keyword began.
pub fn never_began(span: Span, word: &str) -> Diagnostic {
    Diagnostic::new(Code::BlockFrame, span, format!("`{word}` ends a block that never began"))
        .label("no block is open here")
        .help("remove it, or write the header of its block before the statements")
}

/// The message for `name`, such as `FB 10`, where a block begins without its `keyword`.
pub fn no_keyword_before_name(span: Span, keyword: &str, name: &str) -> Diagnostic {
    Diagnostic::new(Code::BlockFrame, span, format!("`{keyword}` is missing before `{name}`"))
        .label("a block begins here")
        .help(format!("write `{keyword} {name}`"))
}

/// The message for a list of attributes before a block. `head`: the source from the keyword of the block on.
pub fn attributes_before_block(span: Span, head: &str) -> Diagnostic {
    let line = head.lines().next().unwrap_or(head).trim_end();
    Diagnostic::new(Code::Tolerated, span, "the attributes of a block come after its name")
        .label("skipped: no block has begun here")
        .help(format!("write them in the line after `{line}`"))
}

/// The message for the first declaration, at `span`, of a section without its first word. `word`: how it is read.
pub fn no_section(span: Span, word: &str) -> Diagnostic {
    Diagnostic::new(Code::BlockFrame, span, format!("`{word}` is missing before the declarations"))
        .label("the first declaration")
        .help(format!("write `{word}` on a line before it, or the section that is meant, such as `VAR_INPUT`"))
}

/// The message for `word`, such as `END_VAR`, where no section is open.
pub fn ends_no_section(span: Span, word: &str) -> Diagnostic {
    Diagnostic::new(Code::BlockFrame, span, format!("`{word}` ends no section"))
        .label("no section is open here")
        .help("remove it, or write the section that it ends")
}

/// The words that begin a line of a header.
const HEADER_WORDS: [&str; 5] = ["TITLE", "VERSION", "AUTHOR", "FAMILY", "NAME"];

/// The message for a line of a header that begins with `word` (as written) and a sign, if it stands for a word of headers.
pub fn misspelt_in_header(span: Span, word: &str) -> Option<Diagnostic> {
    let keyword = frame_words::slip_of(word, HEADER_WORDS).filter(|keyword| !keyword.eq_ignore_ascii_case(word))?;
    Some(frame_words::misspelt(span, word, keyword))
}

/// `VERSION 0.1`. `word` with the text that follows it.
pub fn no_colon_in_header(span: Span, word: &str, text: &str) -> Diagnostic {
    Diagnostic::new(Code::BlockFrame, span, format!("`:` is missing after `{word}`"))
        .label("a part of the header")
        .help(format!("write `{word} : {text}`"))
}

/// `FUNCTION FC 1 :` at the end of a line.
pub fn no_type_after_colon(colon: Span) -> Diagnostic {
    Diagnostic::new(Code::BlockFrame, colon, "no type follows the `:` of the function")
        .label("the type of the result is missing")
        .help("write `: VOID` for a function without a value, or the type of its value")
}

/// `FUNCTION FC 1 INT`. `ty`: the type.
pub fn no_colon_before_type(span: Span, ty: &str) -> Diagnostic {
    Diagnostic::new(Code::BlockFrame, span, format!("`:` is missing before the type `{ty}`"))
        .label("the type of the result")
        .help(format!("write `: {ty}`"))
}

/// The message for `text` where the header of a data block or data type, `what`, goes on.
pub fn not_in_header(span: Span, what: &str, text: &str, help: &str) -> Diagnostic {
    Diagnostic::new(Code::BlockFrame, span, format!("a {what} cannot contain `{text}`"))
        .label("neither a part of the header nor a declaration")
        .help(help)
}
