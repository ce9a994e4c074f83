//! The document of a project that is complete, with its global variables and what is reported of the whole.

use std::collections::HashMap;

use plcc_diag::{Diagnostic, Severity, Span};
use plcc_syntax::stl::Mnemonics;
use plcc_syntax::symbols::SymbolTarget;

use super::identifier::identifier;
use super::program::Global;
use super::tasks::Task;
use super::{Project, globals};
use crate::node::{self, Node};
use crate::trivia::Trivia;
use crate::writer::{Notation, Writer};

impl Project<'_, '_, '_> {
    /// The text of the file, and all messages about the program. `more`: those of [`names_that_change`](Self::names_that_change).
    pub(super) fn document(mut self, more: Vec<Diagnostic>) -> (String, Vec<Diagnostic>) {
        let mut writer = Writer::new(Notation::St, Mnemonics::En, Trivia::none(), None);
        let globals = self.globals(&mut writer);
        self.messages.append(&mut writer.messages);
        self.messages.extend(more);
        let structures = std::mem::take(&mut self.declarer.structures);
        let structures = structures
            .into_iter()
            .map(|(name, node)| Node::new("dataType").with("name", name).child(Node::new("baseType").child(node)));
        let types = Node::new("dataTypes").children(self.types).children(structures);
        self.tasks.sort_by_key(|task| (task.period_ms.is_some(), task.number));
        let resource = Node::new("resource").with("name", "CPU").children(self.tasks.iter().map(Task::node));
        let configuration = Node::new("configuration").with("name", "PLC").child(resource).children(globals);
        // The format wants a time; the same program gives the same file.
        const TIME: &str = "1970-01-01T00:00:00";
        let scale = |language: &'static str| Node::new(language).child(Node::new("scaling").with("x", 1).with("y", 1));
        let file = Node::new("fileHeader")
            .with("companyName", "")
            .with("productName", "plcc")
            .with("productVersion", env!("CARGO_PKG_VERSION"))
            .with("creationDateTime", TIME);
        let content = Node::new("contentHeader")
            .with("name", self.settings.name)
            .child(Node::new("coordinateInfo").child(scale("fbd")).child(scale("ld")).child(scale("sfc")));
        let root = Node::new("project")
            .with("xmlns", "http://www.plcopen.org/xml/tc6_0201")
            .with("xmlns:xhtml", "http://www.w3.org/1999/xhtml")
            .child(file)
            .child(content)
            .child(Node::new("types").child(types).child(Node::new("pous").children(self.pous)))
            .child(Node::new("instances").child(Node::new("configurations").child(configuration)));
        (node::document(&root), self.messages)
    }

    /// Lists of global variables.
    fn globals(&mut self, writer: &mut Writer) -> Vec<Node> {
        let mut lists: HashMap<&str, Node> = HashMap::new();
        let mut add = |list: &'static str, node: Node| {
            let new = || match list {
                "" => Node::new("globalVars"),
                attribute => Node::new("globalVars").with(attribute, "true"),
            };
            lists.entry(list).or_insert_with(new).push(node);
        };
        for table in self.program.tables {
            for symbol in &table.symbols {
                let key = symbol.name.to_lowercase();
                let is_block = matches!(symbol.target, SymbolTarget::Block { .. });
                if is_block
                    || !matches!(self.program.global(&key), Some(Global::Tag(known)) if std::ptr::eq(known, symbol))
                {
                    continue;
                }
                let is_used = self.used.contains(&key);
                if let Some(node) = globals::tag(self.program, &key, symbol, is_used, writer) {
                    add("", node);
                }
            }
            for constant in &table.constants {
                let key = constant.name.to_lowercase();
                let node = globals::constant(self.program, &key, &constant.ty, &constant.value, constant.span, writer);
                if let Some(node) = node {
                    add("constant", node);
                }
            }
        }
        for (_, retained, node) in std::mem::take(&mut self.data) {
            add(if retained { "retain" } else { "" }, node);
        }
        ["", "retain", "constant"].iter().filter_map(|list| lists.remove(list)).collect()
    }

    /// Names that are others in the file, and attributes that it does not have.
    pub(super) fn names_that_change(&self) -> Vec<Diagnostic> {
        let mut writer = Writer::new(Notation::St, Mnemonics::En, Trivia::none(), None);
        let mut changed: Vec<(String, String, Span)> = Vec::new();
        for (key, global) in &self.program.globals {
            let span = match global {
                Global::Code(block) => block.name.span(),
                Global::Data(block) => block.name.span(),
                Global::Type(block) => block.name.span(),
                Global::Tag(symbol) => symbol.span,
                Global::Constant(constant) => constant.span,
                Global::Variable(variable) => variable.name_span,
            };
            changed.push((self.program.own_name(key), self.program.name(key), span));
        }
        for block in self.program.code_blocks() {
            for variable in block.sections.iter().flat_map(|section| &section.variables) {
                changed.push((variable.name.clone(), identifier(&variable.name), variable.name_span));
            }
        }
        changed.retain(|(own, name, _)| own != name);
        changed.sort_by_key(|(_, _, span)| (span.file.0, span.start));
        changed.dedup_by(|a, b| (&a.0, &a.1) == (&b.0, &b.1));
        if let Some((own, name, span)) = changed.first() {
            let list: Vec<String> = changed.iter().map(|(own, name, _)| format!("`{own}` is `{name}`")).collect();
            let title = match list.len() {
                1 => format!("`{own}` is `{name}` in the file"),
                count => format!("{count} names are different in the file: {}", list.join(", ")),
            };
            let help =
                "IEC 61131-3 has names of letters, digits and single `_`, and a local variable hides a global one";
            let mut message = Diagnostic::new(plcc_diag::Code::NotConverted, *span, title);
            message.severity = Severity::Warning;
            writer.messages.push(message.label("gets another name").help(help));
        }
        let mut lost: Vec<&str> = self.declarer.attributes.iter().map(|(key, _)| key.as_str()).collect();
        if self.described.is_some() {
            lost.extend(["VERSION", "AUTHOR", "FAMILY"]);
        }
        let first = self.declarer.attributes.first().map(|(_, span)| *span).or(self.described);
        if let Some(span) = first {
            let title = format!("PLCopen XML does not have {}", lost.join(", "));
            writer.warn(span, title, "set what the program needs in the editor again");
        }
        writer.messages
    }
}
