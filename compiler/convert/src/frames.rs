//! Frames of blocks, their headers and declarations, which STL and SCL share.

mod values;

use std::ops::Range;

use plcc_diag::Span;
use plcc_syntax::ast::{
    Block, BlockName, BlockPrefix, Bound, Code, CodeBlock, CodeKind, Constant, DataBlock, DataContent, Header, Retain,
    Section, SectionKind, TypeBlock, TypeKind, TypeRef, ValueAssignment, Variable,
};

use crate::scl::expression;
use crate::sd::attributes::in_braces;
use crate::writer::{Notation, Writer};
use crate::xml::cased;
use crate::{names, operand};

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

    /// The sections and the constants of a block in their order: in S7-SCL a constant is declared before it is a bound.
    pub(crate) fn declarations(&mut self, block: &CodeBlock) {
        let first = block.constants.first().map(|constant| constant.name_span.start);
        let first = first.filter(|at| places_of_declarations(block).contains(at));
        let is_before = |section: &&Section| first.is_none_or(|first| section.span.start < first);
        let (before, after) = block.sections.split_at(block.sections.iter().take_while(is_before).count());
        before.iter().for_each(|section| self.section(section));
        self.constants(&block.constants, &places_of_declarations(block));
        after.iter().for_each(|section| self.section(section));
    }

    pub(crate) fn section(&mut self, section: &Section) {
        let keyword = match section.kind {
            SectionKind::Input => "VAR_INPUT",
            SectionKind::Output => "VAR_OUTPUT",
            SectionKind::InOut => "VAR_IN_OUT",
            SectionKind::Static => "VAR",
            SectionKind::Temp => "VAR_TEMP",
        };
        let retain = match section.retain {
            Retain::Unsaid => "",
            Retain::Retain => " RETAIN",
            Retain::NonRetain => " NON_RETAIN",
            Retain::DbSpecific => " DB_SPECIFIC",
        };
        self.remarks_before(section.span.start);
        self.out.line(format!("{keyword}{retain}"));
        self.variables(&section.variables);
        self.out.indent();
        self.remarks_before(section.span.end);
        self.out.dedent();
        self.out.line("END_VAR");
    }

    /// `declared`: where the declarations of the block are.
    fn constants(&mut self, constants: &[Constant], declared: &Range<u32>) {
        let Some(first) = constants.first() else { return };
        // Those of STL in the TIA Portal have start values; expressions are of SCL.
        if self.notation == Notation::Stl
            && let Some(scl) = constants.iter().find(|constant| constant.initial.is_none())
        {
            return self.refuse(
                scl.name_span,
                format!("STL of STEP 7 has no constants of a block: `{}`", scl.name),
                "write its value where it is used, or define it in the symbol table",
            );
        }
        self.out.line(if first.ty.is_some() { "VAR CONSTANT" } else { "CONST" });
        self.out.indent();
        for constant in constants {
            let is_own = declared.contains(&constant.name_span.start);
            if is_own {
                self.remarks_before(constant.name_span.start);
            }
            let written = self.attributes_before(constant.name_span.start);
            let attributes = if written.is_empty() { String::new() } else { in_braces(&written) + " " };
            let name = attributes + &self.declared(&constant.name, constant.name_span);
            let value = match (&constant.value, &constant.initial, &constant.ty) {
                (Some(value), ..) => expression::text(value, self),
                (None, Some(value), Some(ty)) => self.initial_of(value, ty),
                (None, Some(value), None) => self.initial(value),
                (None, None, _) => String::new(),
            };
            let sign = if value.is_empty() { "" } else { " := " };
            let ty = constant.ty.as_ref().map_or(String::new(), |ty| format!(" : {}", self.type_text(ty)));
            match constant.ty.as_ref().and_then(structure) {
                None => self.out.line(format!("{name}{ty}{sign}{value};")),
                Some(members) => {
                    self.out.line(format!("{name}{ty}"));
                    self.variables(members);
                    self.out.line(format!("END_STRUCT{sign}{value};"));
                }
            }
            let end = constant.value.as_ref().map_or(constant.name_span.end, |value| value.span.end);
            if is_own {
                self.remarks_on_line(end);
            }
        }
        self.out.dedent();
        self.out.line(if first.ty.is_some() { "END_VAR" } else { "END_CONST" });
    }

    pub(crate) fn variables(&mut self, variables: &[Variable]) {
        self.out.indent();
        let source = self.source.filter(|_| matches!(self.notation, Notation::Stl | Notation::Scl | Notation::Sd));
        for list in variables.chunk_by(|one, next| source.is_some_and(|source| is_list(source, one, next))) {
            self.variable(list);
        }
        self.out.dedent();
    }

    /// A variable, or several with one type: `a, b : INT;`.
    fn variable(&mut self, list: &[Variable]) {
        let [variable, others @ ..] = list else { return };
        self.remarks_before(variable.name_span.start);
        let written = self.attributes_before(variable.name_span.start);
        let own = variable.comment.as_ref().filter(|_| !written.iter().any(|attribute| attribute.is("S7_MLC")));
        // After the declaration there is room for one line.
        let is_long = self.notation != Notation::Gr7 && own.is_some_and(|comment| comment.contains('\n'));
        if let Some(comment) = own.filter(|_| is_long) {
            comment.lines().for_each(|line| self.out.line(format!("// {}", line.trim()).trim_end()));
        }
        let mut head = self.declared(&variable.name, variable.name_span);
        if !written.is_empty() {
            head = format!("{} {head}", in_braces(&written));
        } else if !variable.attributes.is_empty() && self.notation == Notation::Sd {
            let list = variable.attributes.iter().map(|(key, value)| format!("{key} := \"{value}\""));
            head = format!("{{ {} }} {head}", list.collect::<Vec<_>>().join("; "));
        } else if !variable.attributes.is_empty() {
            let list: Vec<String> = variable.attributes.iter().map(|(key, value)| attribute(key, value)).collect();
            head.push_str(&format!(" {{ {} }}", list.join("; ")));
        }
        for other in others {
            head.push_str(&format!(", {}", self.declared(&other.name, other.name_span)));
        }
        if let Some((at, _)) = &variable.at {
            head.push_str(&format!(" AT {}", names::declared(at)));
        }
        let initial = variable.initial.as_ref();
        let initial = initial.map_or(String::new(), |value| format!(" := {}", self.initial_of(value, &variable.ty)));
        match structure(&variable.ty) {
            None => {
                let ty = self.type_text(&variable.ty);
                self.out.line(format!("{head} : {ty}{initial};"));
            }
            Some(members) => {
                let ty = self.type_text(&variable.ty);
                self.out.line(format!("{head} : {ty}"));
                self.variables(members);
                self.out.indent();
                self.remarks_before(variable.ty.span.end);
                self.out.dedent();
                self.out.line(format!("END_STRUCT{initial};"));
            }
        }
        let end = variable.initial.as_ref().map_or(variable.ty.span.end, |value| value.span.end);
        if let Some(comment) = own.filter(|_| !is_long) {
            self.out.trail(&match self.notation {
                Notation::Gr7 => format!("(* {} *)", comment.replace("*)", "* )")),
                Notation::Stl | Notation::Scl | Notation::Sd | Notation::St => format!("// {comment}"),
            });
        }
        let mut remarks = self.trivia.on_line(end.max(variable.name_span.end));
        remarks.retain(|remark| own.is_none_or(|own| bare(&remark.text) != *own && !has_lines(&remark.text, own)));
        self.out.remarks(&remarks);
    }

    /// A name that is declared, in quotes if it must have them; a word of the language, one with letters of other languages, and any name
    /// of a document, if it has them in the source: `"IF"`.
    pub(crate) fn declared(&self, name: &str, span: Span) -> String {
        let is_word = names::is_word(name);
        let may_have = is_word || !name.is_ascii() || self.braces.is_some();
        let has_quotes = is_word && self.quotes_words || may_have && self.is_quoted(name, span);
        if has_quotes { names::symbol(name) } else { names::declared(name) }
    }

    /// Whether a name is in quotes in the source, also after `#`.
    pub(crate) fn is_quoted(&self, name: &str, span: Span) -> bool {
        let text = self.source.and_then(|source| source.get(span.range()));
        let text = text.map(|text| text.strip_prefix('#').unwrap_or(text));
        text.and_then(|text| text.strip_prefix('"')?.strip_suffix('"')) == Some(name)
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

    // Types and values.

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

    /// A type; of a structure only `STRUCT`, with the dimensions of an array of structures.
    pub(crate) fn type_text(&mut self, ty: &TypeRef) -> String {
        match &ty.kind {
            TypeKind::Named(name) => self.named_type(ty, name),
            TypeKind::String(None) => self.type_word(ty, "String"),
            TypeKind::String(Some(length)) => format!("{}[{}]", self.type_word(ty, "String"), self.bound(length)),
            TypeKind::WideString(None) => self.type_word(ty, "WString"),
            TypeKind::WideString(Some(length)) => format!("{}[{}]", self.type_word(ty, "WString"), self.bound(length)),
            TypeKind::Array { bounds, element } => {
                let list: Vec<String> =
                    bounds.iter().map(|(low, high)| format!("{}..{}", self.bound(low), self.bound(high))).collect();
                self.array_text(ty, &list.join(", "), element)
            }
            TypeKind::OpenArray { dimensions, element } => {
                self.needs_scl(ty.span, "an array without bounds");
                let stars = vec!["*"; usize::from(*dimensions)].join(", ");
                self.array_text(ty, &stars, element)
            }
            TypeKind::Reference(target) => {
                self.needs_scl(ty.span, "a reference");
                format!("REF_TO {}", self.type_text(target))
            }
            TypeKind::Struct(_) => match self.written_word(ty, "STRUCT") {
                Some(own) => own.to_string(),
                None => "STRUCT".to_string(),
            },
            TypeKind::Block(name) => {
                let text = self.source.and_then(|source| source.get(ty.span.range())).map(str::trim);
                let own = text.filter(|text| match (text.strip_prefix("_."), name) {
                    // `_.Valve`
                    (Some(own), BlockName::Symbol { name, .. }) => own.trim_matches('"') == name,
                    // `Unit.Namespace.Valve`
                    (None, BlockName::Symbol { name, .. }) => self.braces.is_some() && *text == name,
                    (_, BlockName::Numbered { .. }) => false,
                });
                let own = own.filter(|_| self.notation == Notation::Sd);
                own.map_or_else(|| self.block_name(name), str::to_string)
            }
            TypeKind::Error => {
                self.refuse(ty.span, "a type that was not understood", "repair the source first");
                String::new()
            }
        }
    }

    fn array_text(&mut self, ty: &TypeRef, bounds: &str, element: &TypeRef) -> String {
        let array = self.type_word(ty, "Array");
        let of = if array.starts_with("AR") { "OF" } else { "of" };
        format!("{array}[{bounds}] {of} {}", self.type_text(element))
    }

    /// The name of a type: as the author wrote it, otherwise in the letters of the TIA Portal where it is for that.
    fn named_type(&self, ty: &TypeRef, name: &str) -> String {
        let keeps = matches!(self.notation, Notation::Sd | Notation::Scl);
        let text = self.source.filter(|_| keeps).and_then(|source| source.get(ty.span.range())).map(str::trim);
        let own = text.filter(|text| text.eq_ignore_ascii_case(name)).map(str::to_string);
        own.unwrap_or_else(|| if self.is_of_portal() { cased(name) } else { name.to_string() })
    }

    /// A word with which a type begins, likewise.
    fn type_word(&self, ty: &TypeRef, word: &str) -> String {
        match self.written_word(ty, word) {
            Some(own) => own.to_string(),
            None if self.is_of_portal() => word.to_string(),
            None => word.to_ascii_uppercase(),
        }
    }

    /// The word with which a type begins in a source in SCL.
    fn written_word(&self, ty: &TypeRef, word: &str) -> Option<&str> {
        let own = self.scl_from(ty.span.start)?.get(..word.len())?;
        own.eq_ignore_ascii_case(word).then_some(own)
    }

    /// The source from a byte on, if it is a text in SCL.
    fn scl_from(&self, at: u32) -> Option<&str> {
        let source = self.source.filter(|_| self.notation == Notation::Scl && !self.quotes_words)?;
        source.get(at as usize..)
    }

    /// The type of a function without a value, whose name ends at a byte.
    fn void(&self, at: u32) -> &str {
        let rest = self.scl_from(at).and_then(|rest| rest.trim_start().strip_prefix(':')).map(str::trim_start);
        let own = rest.and_then(|rest| rest.get(..4)).filter(|own| own.eq_ignore_ascii_case("VOID"));
        own.unwrap_or("VOID")
    }

    /// Whether types have the letters of the TIA Portal.
    fn is_of_portal(&self) -> bool {
        self.notation == Notation::Sd || self.notation == Notation::Scl && self.quotes_words
    }

    pub(crate) fn bound(&mut self, bound: &Bound) -> String {
        match bound {
            Bound::Number(number, _) => number.to_string(),
            Bound::Name(name, _) if self.notation == Notation::Stl => names::declared(name),
            Bound::Name(name, _) => names::bare(name),
            Bound::Expr(value) => {
                self.needs_scl(value.span, "an expression as a bound");
                expression::text(value, self)
            }
            Bound::Path(path) => operand::path_text(path, self),
        }
    }

    fn needs_scl(&mut self, span: Span, what: &str) {
        if self.notation == Notation::Stl {
            self.refuse(
                span,
                format!("STL has no word for {what}"),
                "declare it in another way, or leave the block in its language",
            );
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

/// Whether two variables are `a, b` of one declaration `a, b : INT` in a source.
fn is_list(source: &str, one: &Variable, next: &Variable) -> bool {
    let gap = source.get(one.name_span.end as usize..next.name_span.start as usize);
    let is_plain = |variable: &Variable| variable.attributes.is_empty() && variable.at.is_none();
    one.ty.span == next.ty.span
        && gap.is_some_and(|gap| gap.trim() == ",")
        && is_plain(one)
        && is_plain(next)
        && one.comment == next.comment
}

/// Members of a structure, also of an array of structures.
fn structure(ty: &TypeRef) -> Option<&[Variable]> {
    match &ty.kind {
        TypeKind::Struct(members) => Some(members),
        TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. } => structure(element),
        TypeKind::Named(_)
        | TypeKind::String(_)
        | TypeKind::WideString(_)
        | TypeKind::Reference(_)
        | TypeKind::Block(_)
        | TypeKind::Error => None,
    }
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

/// Whether the lines with `//` are those of a comment.
fn has_lines(text: &str, comment: &str) -> bool {
    text.lines().map(bare).eq(comment.lines().map(|line| line.trim().to_string()))
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
