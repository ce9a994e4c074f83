//! Frames of blocks, their headers and declarations, which STL and SCL share.
//!
//! - `declarations`: sections, constants and variables.
//! - `types`: their types; `values`: their start values.

mod declarations;
mod types;
mod values;

use std::ops::Range;

use plcc_syntax::ast::{
    Block, BlockName, BlockPrefix, Code, CodeBlock, CodeKind, DataBlock, DataContent, Header, TypeBlock,
    ValueAssignment, Variable,
};

use crate::operand;
use crate::writer::{Notation, Writer};

impl Writer<'_> {
    /// The frame of a block with code; `body` writes its statements.
    pub(crate) fn code_frame(&mut self, block: &CodeBlock, body: impl FnOnce(&mut Self)) {
        let (keyword, end) = match block.kind {
            CodeKind::Ob => ("ORGANIZATION_BLOCK", "END_ORGANIZATION_BLOCK"),
            CodeKind::Fc | CodeKind::Sfc => ("FUNCTION", "END_FUNCTION"),
            CodeKind::Fb | CodeKind::Sfb => ("FUNCTION_BLOCK", "END_FUNCTION_BLOCK"),
        };
        let name = self.block_name(&block.name);
        let returns = match (&block.return_type, block.kind) {
            (Some(ty), _) => format!(" : {}", self.type_text(ty)),
            (None, CodeKind::Fc | CodeKind::Sfc) => format!(" : {}", self.void(block.name.span().end)),
            (None, CodeKind::Ob | CodeKind::Fb | CodeKind::Sfb) => String::new(),
        };
        self.remarks_before(block.span.start);
        self.out.line(format!("{keyword} {name}{returns}"));
        let begin = self.trivia.word("BEGIN", block.name.span().end, code_start(block));
        let sections = block.sections.iter().map(|section| section.span.start);
        let declared = places_of_declarations(block);
        let constants = block.constants.first().filter(|first| declared.contains(&first.name_span.start));
        let constants = constants.and_then(|first| {
            let word = |word| self.trivia.word(word, block.name.span().end, first.name_span.start);
            word("CONST").or_else(|| word("VAR"))
        });
        let start = sections.chain(constants).min().or(begin);
        self.header(&block.header, &block.name, block.kind == CodeKind::Ob, start);
        self.declarations(block);
        if let Code::Scl(body) = &block.code {
            self.labels(&body.labels);
        }
        self.out.line("BEGIN");
        body(self);
        self.remarks_before(block.span.end);
        self.out.line(end);
    }

    pub(crate) fn data_block(&mut self, block: &DataBlock) {
        let (content, values) = self.declared_content(&block.content);
        let name = self.block_name(&block.name);
        self.remarks_before(block.span.start);
        self.out.line(format!("DATA_BLOCK {name}"));
        let start = match &content {
            DataContent::Struct(members) => members.first().map(|member| member.name_span.start),
            DataContent::OfType(ty) | DataContent::Array(ty, _) => Some(ty.span.start),
            DataContent::Empty => None,
        };
        let header = with_retention(&block.header, self.notation);
        self.header(&header, &block.name, is_standard(&block.header), start);
        match &content {
            DataContent::Struct(members) if block.retained.is_empty() => {
                self.out.line("STRUCT");
                self.variables(members);
                self.out.line("END_STRUCT;");
            }
            DataContent::Struct(members) => self.retained(members, &block.retained),
            DataContent::OfType(ty) => {
                let ty = self.type_text(ty);
                self.out.line(ty);
            }
            DataContent::Array(ty, initial) => {
                self.needs_scl(ty.span, "a data block that is an array");
                let initial =
                    initial.as_ref().map_or(String::new(), |value| format!(" := {}", self.initial_of(value, ty)));
                let ty = self.type_text(ty);
                self.out.line(format!("{ty}{initial}"));
            }
            DataContent::Empty => {}
        }
        self.out.line("BEGIN");
        self.out.indent();
        self.assignments(&values);
        for value in &block.values {
            self.value(value);
        }
        self.remarks_before(block.span.end);
        self.out.dedent();
        self.out.line("END_DATA_BLOCK");
    }

    /// Sections with and without RETAIN, in the order of the members.
    pub(crate) fn retained(&mut self, members: &[Variable], retained: &[String]) {
        let is = |member: &Variable| retained.iter().any(|name| name.eq_ignore_ascii_case(&member.name));
        for run in members.chunk_by(|a, b| is(a) == is(b)) {
            self.out.line(if run.first().is_some_and(is) { "VAR RETAIN" } else { "VAR" });
            self.variables(run);
            self.out.line("END_VAR");
        }
    }

    pub(crate) fn type_block(&mut self, block: &TypeBlock) {
        let name = self.block_name(&block.name);
        self.remarks_before(block.span.start);
        if let Some(alias) = &block.alias {
            self.needs_scl(alias.span, "a data type that is not a STRUCT");
            let ty = self.type_text(alias);
            self.out.line(format!("TYPE {name} : {ty};"));
        } else {
            self.out.line(format!("TYPE {name}"));
            let start = block.members.first().map(|member| member.name_span.start);
            self.header(&block.header, &block.name, false, start);
            self.out.line("STRUCT");
            self.variables(&block.members);
            self.out.line("END_STRUCT;");
        }
        self.remarks_before(block.span.end);
        self.out.line("END_TYPE");
    }

    /// The lines after the name of a block; `needs_number`: it is found by its number; `start`: where the first declaration is.
    fn header(&mut self, header: &Header, name: &BlockName, needs_number: bool, start: Option<u32>) {
        if let Some(title) = &header.title {
            let quote = if self.notation == Notation::Scl && !title.contains('\'') { "'" } else { "" };
            self.out.line(format!("TITLE = {quote}{title}{quote}"));
        }
        let attributes = header.attributes.iter().filter_map(|(key, value)| match key.as_str() {
            // SIMATIC SD has them as attributes, sources as text.
            "S7_Version" if self.notation == Notation::Stl => None,
            "S7_PreferredLanguage" if matches!(self.notation, Notation::Stl | Notation::Scl) => None,
            "S7_Optimized" => Some(attribute("S7_Optimized_Access", value)),
            "SecondaryType" => Some(attribute("S7_EventClass", value)),
            key => Some(attribute(key, value)),
        });
        let mut list: Vec<String> = attributes.collect();
        // A name has its number as in SIMATIC SD; one that the project chose says nothing to what goes by names.
        let is_known = header.attributes.iter().any(|(key, _)| key.eq_ignore_ascii_case("S7_BlockNumber"));
        let is_own = needs_number || !header.auto_number || self.notation == Notation::Stl;
        if let (Some(number), BlockName::Symbol { .. }) = (header.number.filter(|_| is_own && !is_known), name) {
            list.insert(0, attribute("S7_BlockNumber", &number.to_string()));
        }
        if !list.is_empty() {
            self.out.line(format!("{{ {} }}", list.join("; ")));
        }
        let texts = [
            ("AUTHOR", &header.author),
            ("FAMILY", &header.family),
            ("NAME", &header.name),
            ("VERSION", &header.version),
        ];
        for (key, value) in texts {
            if let Some(value) = value {
                let quote = if self.quotes_header() && key != "VERSION" { "'" } else { "" };
                self.out.line(format!("{key} : {quote}{value}{quote}"));
            }
        }
        self.flags(header);
        let remarks = start.map_or_else(Vec::new, |start| self.trivia.before(start));
        let known: Vec<String> = remarks.iter().map(|remark| bare(&remark.text)).collect();
        for line in header.comment.iter().filter(|line| !known.contains(line)) {
            self.out.line(format!("// {line}"));
            self.written.push(line.clone());
        }
        self.out.remarks(&remarks);
    }

    /// Words of a header that say something about the block.
    pub(crate) fn flags(&mut self, header: &Header) {
        let flags = [
            ("KNOW_HOW_PROTECT", header.know_how_protect),
            ("STANDARD", header.standard),
            ("CODE_VERSION1", header.code_version1),
            ("UNLINKED", header.unlinked),
            ("READ_ONLY", header.read_only),
            ("NON_RETAIN", header.non_retain),
            ("RETAIN", header.retain),
        ];
        flags.iter().filter(|(_, set)| *set).for_each(|(word, _)| self.out.line(word));
    }

    /// Classic SCL quotes nothing, but the names of AUTHOR and FAMILY may contain blanks only in quotes.
    fn quotes_header(&self) -> bool {
        self.notation == Notation::Scl
    }

    pub(crate) fn value(&mut self, value: &ValueAssignment) {
        self.remarks_before(value.span.start);
        let target = operand::value_path(&value.target, self);
        let mut list = vec![(target, value.value.clone())];
        if self.has_parts(&value.value) {
            list = self.parts(list);
        }
        self.assignments(&list);
        self.remarks_on_line(value.span.end);
    }

    /// `FC 7`, `"Tank"`.
    pub(crate) fn block_name(&self, name: &BlockName) -> String {
        match name {
            BlockName::Numbered { prefix, number, .. } => {
                let blank = if self.notation == Notation::Stl { " " } else { "" };
                format!("{}{blank}{number}", prefix.letters())
            }
            BlockName::Symbol { name, .. } => format!("\"{name}\""),
        }
    }

    // Comments.

    pub(crate) fn remarks_before(&mut self, at: u32) {
        let mut remarks = self.trivia.before(at);
        remarks.retain(|remark| !self.is_written(&remark.text));
        self.out.remarks(&remarks);
    }

    pub(crate) fn remarks_on_line(&mut self, at: u32) {
        let remarks = self.trivia.on_line(at);
        self.out.remarks(&remarks);
    }

    /// Whether a comment was written with what it describes; each only once.
    pub(crate) fn is_written(&mut self, text: &str) -> bool {
        let text = bare(text);
        match self.written.iter().position(|known| *known == text) {
            Some(at) => {
                self.written.remove(at);
                true
            }
            None => false,
        }
    }
}

/// Where a block declares what it has. Constants of a project in PLCopen XML are elsewhere in the file.
pub(crate) fn places_of_declarations(block: &CodeBlock) -> Range<u32> {
    block.span.start..code_start(block)
}

/// Where the code of a block begins, or its end.
fn code_start(block: &CodeBlock) -> u32 {
    let first = match &block.code {
        Code::Scl(body) => body.statements.first().map(|statement| statement.span.start),
        Code::Stl(networks) => networks.iter().flat_map(|network| &network.statements).next().map(|one| one.span.start),
        Code::Graphic(body) => body.networks.first().map(|network| network.span.start),
        Code::Chart(_) => None,
    };
    first.unwrap_or(block.span.end)
}

/// The header of a data block with standard access, which says in another notation whether its data are retentive: sources say it if they
/// are not, SIMATIC SD if they are.
pub(crate) fn with_retention(header: &Header, notation: Notation) -> Header {
    let says = |key: &str| header.attributes.iter().find(|(own, _)| own.eq_ignore_ascii_case(key));
    let is_standard = |key: &str| says(key).is_some_and(|(_, value)| value.trim().eq_ignore_ascii_case("FALSE"));
    let mut made = header.clone();
    if header.retain || header.non_retain {
        return made;
    }
    if let Some((_, retain)) = says("S7_StandardRetain") {
        // The attribute is one of SIMATIC SD.
        if notation == Notation::Scl && (is_standard("S7_Optimized_Access") || is_standard("S7_Optimized")) {
            made.non_retain = !retain.trim().eq_ignore_ascii_case("TRUE");
            made.attributes.retain(|(key, _)| !key.eq_ignore_ascii_case("S7_StandardRetain"));
        }
        return made;
    }
    let mut standard_retain = |value: &str| made.attributes.push(("S7_StandardRetain".to_string(), value.to_string()));
    match notation {
        Notation::Sd if is_standard("S7_Optimized_Access") => standard_retain("TRUE"),
        Notation::Scl if is_standard("S7_Optimized") => made.non_retain = true,
        // NON_RETAIN would count on an S7-300, too.
        Notation::Stl if is_standard("S7_Optimized") => standard_retain("FALSE"),
        Notation::Sd | Notation::Scl | Notation::Stl | Notation::Gr7 | Notation::St => {}
    }
    made
}

/// Whether a data block has standard access, so that addresses reach its data by its number.
pub(crate) fn is_standard(header: &Header) -> bool {
    let says = |(key, value): &(String, String)| {
        (key.eq_ignore_ascii_case("S7_Optimized_Access") || key.eq_ignore_ascii_case("S7_Optimized"))
            && value.trim().eq_ignore_ascii_case("FALSE")
    };
    header.attributes.iter().any(says)
}

fn attribute(key: &str, value: &str) -> String {
    format!("{key} := '{value}'")
}

/// A comment without `//` or its brackets.
pub(crate) fn bare(text: &str) -> String {
    let inner = text.strip_prefix("//").or_else(|| text.strip_prefix("(*")?.strip_suffix("*)"));
    inner.unwrap_or(text).trim().to_string()
}

/// Whether a block is the OB 1 that statements without a header form.
pub(crate) fn is_implied(block: &Block) -> bool {
    match block {
        Block::Code(block) => matches!(
            &block.name,
            BlockName::Numbered { prefix: BlockPrefix::Ob, number: 1, span } if span.start == span.end
        ),
        Block::Data(_) | Block::Type(_) => false,
    }
}
