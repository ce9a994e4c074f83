//! Sections, constants and variables.

use std::ops::Range;

use plcc_diag::Span;
use plcc_syntax::ast::{CodeBlock, Constant, Retain, Section, SectionKind, TypeKind, TypeRef, Variable};

use super::{attribute, bare, places_of_declarations};
use crate::names;
use crate::scl::expression;
use crate::sd::attributes::in_braces;
use crate::writer::{Notation, Writer};

impl Writer<'_> {
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

/// Whether the lines with `//` are those of a comment.
fn has_lines(text: &str, comment: &str) -> bool {
    text.lines().map(bare).eq(comment.lines().map(|line| line.trim().to_string()))
}
