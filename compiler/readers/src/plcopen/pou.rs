//! A program organization unit: its interface, its actions and its body.

use std::collections::HashSet;
use std::ops::Range;

use plcc_diag::{Code, Diagnostic, Span};
use roxmltree::Node;

use super::editor::Editor;
use super::interface::{child, elements, flip_flop, plain_text};
use super::objects::Kind;
use super::scope::Scope;
use super::types::Ty;
use super::{Body, DEPTH_MAX, Reader, chart, globals, graph, il, objects, order, pragma};
use plcc_syntax::Elementary;
use plcc_syntax::ast::{
    Block, BlockName, Code as BlockCode, CodeBlock, CodeKind, Header, InitialKind, InitialValue, Retain, Section,
    SectionKind, TypeKind,
};
use plcc_syntax::network::ast::{Body as Networks, Content, Graph, Language, Network};
use plcc_syntax::scl::ast::{
    AssignOp, Body as SclBody, Dialect, Expr, ExprKind, Literal, Name, NameForm, Statement, StatementKind,
};
use plcc_syntax::scl::fragment;
use plcc_syntax::scl::raw::Iec;

impl<'a> Reader<'a> {
    pub(super) fn pou(&mut self, pou: Node<'a, 'a>) {
        let span = self.place(pou, "name");
        let Some(name) = pou.attribute("name") else {
            let message = Diagnostic::new(Code::ForeignContent, span, "a POU without a name");
            return self.messages.push(message.help("export the project again"));
        };
        self.unread(pou, &["interface", "actions", "transitions", "body", "documentation", "addData"]);
        let kind = match pou.attribute("pouType") {
            Some("function") => CodeKind::Fc,
            Some("functionBlock" | "program") => CodeKind::Fb,
            _ => {
                let text = format!("`{name}` is neither a function nor a function block nor a program");
                let message = Diagnostic::new(Code::ForeignContent, span, text);
                return self.messages.push(message.help("pouType is function, functionBlock or program"));
            }
        };
        let is_function = kind == CodeKind::Fc;
        let interface = child(pou, "interface");
        let (mut sections, mut constants) = match interface {
            Some(interface) => self.sections(interface, is_function),
            None => Default::default(),
        };
        let return_type = interface
            .and_then(|interface| child(interface, "returnType"))
            .filter(|_| is_function)
            .and_then(|ty| self.type_of(ty, 0));
        let mut body = Body {
            scope: self.scope_of(name, interface),
            is_function,
            words: words(interface),
            hidden: Vec::new(),
            temporary: Vec::new(),
        };
        // Only those that the POU mentions: their names are often words that other POUs use for variables.
        let words = words_of(self.overlay.get(pou.range()).unwrap_or_default());
        for constant in self.constants.clone() {
            let used = words.contains(&constant.name.to_lowercase());
            if used && !body.scope.locals.contains(&constant.name.to_lowercase()) {
                constants.push(constant);
            }
        }
        for (node, value_name, number) in self.enums.clone() {
            let used = words.contains(&value_name.to_lowercase());
            if used && !body.scope.locals.contains(&value_name.to_lowercase()) {
                constants.push(self.enum_constant(node, &value_name, number));
            }
        }
        let is_chart = child(pou, "body").is_some_and(|node| child(node, "SFC").is_some());
        if !is_chart {
            self.actions(pou, &mut body);
        }
        let mut bodies = elements(pou).filter(|node| node.tag_name().name() == "body");
        let mut code = bodies.next().map_or(BlockCode::Graphic(Networks::default()), |node| self.body(node, &mut body));
        for further in bodies {
            let text = format!("`{name}` has several bodies");
            let message = Diagnostic::new(Code::ForeignContent, self.place(further, "WorksheetName"), text);
            self.messages.push(message.label("only the first is compiled").help("put the code into one body"));
        }
        if !body.hidden.is_empty() {
            let variables = std::mem::take(&mut body.hidden);
            sections.push(Section { kind: SectionKind::Static, retain: Retain::Unsaid, variables, span });
        }
        if !body.temporary.is_empty() {
            let variables = std::mem::take(&mut body.temporary);
            sections.push(Section { kind: SectionKind::Temp, retain: Retain::Unsaid, variables, span });
        }
        let outputs_begin_anew = is_function && self.editor != Editor::Other;
        assign_start_values(&mut sections, &mut code, outputs_begin_anew);
        let comment = child(pou, "documentation").map(plain_text).filter(|text| !text.is_empty());
        let header = Header { comment: comment.into_iter().collect(), ..Header::default() };
        let name = BlockName::Symbol { name: name.to_string(), span };
        self.blocks.push(Block::Code(CodeBlock { kind, name, return_type, header, sections, constants, code, span }));
    }

    /// Actions of a POU that is not an SFC; the POU calls them by name.
    pub(super) fn actions(&mut self, pou: Node<'a, 'a>, body: &mut Body) {
        let actions: Vec<Node> = child(pou, "actions").into_iter().flat_map(elements).collect();
        for _ in 0..=actions.len().min(DEPTH_MAX) {
            let known = body.scope.actions.len();
            for node in &actions {
                let Some(name) = node.attribute("name").map(str::to_lowercase) else { continue };
                let text = child(*node, "body").and_then(|node| child(node, "ST"));
                let Some(text) = text.filter(|_| !body.scope.actions.contains_key(&name)) else { continue };
                let source = self.text_range(elements(text).next().unwrap_or(text));
                // The actions that it calls come first.
                let waits = |other: &&Node| {
                    let other = other.attribute("name").unwrap_or_default();
                    !other.eq_ignore_ascii_case(&name)
                        && !body.scope.actions.contains_key(&other.to_lowercase())
                        && source
                            .clone()
                            .and_then(|range| self.overlay.get(range))
                            .is_some_and(|text| mentions(text, other))
                };
                if actions.iter().any(|other| waits(&other)) {
                    continue;
                }
                let statements = source.map(|range| self.statements(range, body)).unwrap_or_default();
                if let Some(span) = chart::leaving(&statements) {
                    let message =
                        Diagnostic::new(Code::ForeignContent, span, "plcc does not read jumps and returns in actions");
                    self.messages.push(message.label("would leave the whole POU").help("use IF"));
                }
                body.scope.actions.insert(name, statements);
            }
            if body.scope.actions.len() == known {
                break;
            }
        }
        for node in actions {
            let name = node.attribute("name").unwrap_or_default();
            if !body.scope.actions.contains_key(&name.to_lowercase()) {
                let text = format!("plcc does not read the action `{name}`: it is not in ST, or calls itself");
                let message = Diagnostic::new(Code::ForeignContent, self.place(node, "name"), text);
                self.messages.push(message.help("write it in ST, or as a function block"));
            }
        }
    }

    /// The meaning of names in a POU. Variables with an address get their start values.
    pub(super) fn scope_of(&mut self, pou: &str, interface: Option<Node>) -> Scope {
        let shared = self.shared.clone().expect("declarations are read first");
        let mut scope = Scope::new(shared);
        for list in interface.into_iter().flat_map(elements) {
            if list.tag_name().name() == "externalVars" {
                self.external(list);
                continue;
            }
            for variable in elements(list).filter(|node| node.tag_name().name() == "variable") {
                let Some(name) = variable.attribute("name") else { continue };
                let key = name.to_lowercase();
                scope.hidden.insert(key.clone());
                if let Some(ty) = child(variable, "type").and_then(|ty| elements(ty).next()) {
                    scope.types.insert(key.clone(), ty.tag_name().name().to_ascii_uppercase());
                }
                if let Some(kind) = child(variable, "type").and_then(Ty::of) {
                    scope.kinds.insert(key.clone(), kind);
                }
                if self.located_variable(variable) {
                    let tag = globals::tag_name(Some(pou), name);
                    let target = Name { text: tag.clone(), form: NameForm::Quoted, span: self.place(variable, "name") };
                    self.start_value(variable, target);
                    scope.located.insert(key, tag);
                    continue;
                }
                if let Some(kind) = flip_flop(variable) {
                    scope.flip_flops.insert(key.clone(), kind);
                }
                scope.locals.insert(key);
            }
        }
        scope
    }

    /// VAR_EXTERNAL names global variables.
    pub(super) fn external(&mut self, list: Node) {
        for variable in elements(list).filter(|node| node.tag_name().name() == "variable") {
            let Some(name) = variable.attribute("name") else { continue };
            let known = self.globals.contains_key(&name.to_lowercase())
                || self.constants.iter().any(|constant| constant.name.eq_ignore_ascii_case(name))
                || self.program_instances.contains_key(&name.to_lowercase());
            if !known {
                let text = format!("the project has no global variable `{name}`");
                let message = Diagnostic::new(Code::UnknownSymbol, self.place(variable, "name"), text);
                let help = "declare it in the configuration or the resource, and export again";
                self.messages.push(message.label("declared as external").help(help));
            }
        }
    }

    pub(super) fn body(&mut self, node: Node<'a, 'a>, body: &mut Body) -> BlockCode {
        let Some(content) = body_content(node) else { return BlockCode::Graphic(Networks::default()) };
        let span = self.place(content, "name");
        let language = match content.tag_name().name() {
            "ST" => return self.structured_text(content, body),
            "IL" => {
                let statements = il::read(self, body, content);
                return BlockCode::Scl(SclBody { dialect: Dialect::Tia, labels: Vec::new(), statements });
            }
            "LD" => Language::Lad,
            "FBD" | "CFC" => Language::Fbd,
            "SFC" if body.is_function => {
                let text = "a function has no memory for the steps of an SFC";
                let message = Diagnostic::new(Code::ForeignContent, span, text);
                let help = "make the POU a function block or a program";
                self.messages.push(message.label("this POU is compiled as if it were empty").help(help));
                return BlockCode::Graphic(Networks::default());
            }
            "SFC" => return BlockCode::Chart(chart::read(self, body, node.parent().unwrap_or(node), content)),
            other => {
                let text = format!("plcc does not read POUs in {other}");
                let message = Diagnostic::new(Code::ForeignContent, span, text);
                let help = "write the POU in LD, FBD, ST, IL or SFC; plcc reads the other blocks of the file";
                self.messages.push(message.label("this POU is compiled as if it were empty").help(help));
                return BlockCode::Graphic(Networks::default());
            }
        };
        BlockCode::Graphic(Networks { networks: self.networks(content, language, body) })
    }

    /// The networks of an LD or FBD body.
    pub(super) fn networks(&mut self, content: Node<'a, 'a>, language: Language, body: &mut Body) -> Vec<Network> {
        let span = self.place(content, "name");
        let objects = self.objects(content);
        let mut networks = Vec::new();
        let mut tops = Vec::new();
        for group in order::groups(&objects) {
            let labels = group.labels.iter().map(|at| &objects[*at]);
            let labels: Vec<Name> =
                labels.map(|label| Name { text: label.name.clone(), form: NameForm::Bare, span: label.span }).collect();
            let graph = match group.objects.is_empty() {
                true => Graph::default(),
                false => graph::build(self, body, &objects, &group.objects),
            };
            let first = group.objects.iter().chain(&group.labels).map(|at| objects[*at].span).next().unwrap_or(span);
            tops.push(group.objects.iter().chain(&group.labels).map(|at| objects[*at].position.0).min().unwrap_or(0));
            networks.push(Network {
                language,
                title: None,
                comment: Vec::new(),
                labels,
                content: Content::Graphic(graph),
                span: first,
            });
        }
        self.unknown_connectors(&objects);
        comments(content, &tops, &mut networks);
        networks
    }

    /// A connector that appears twice joins two signals under one name.
    pub(super) fn unknown_connectors(&mut self, objects: &[objects::Object]) {
        let mut known: HashSet<&str> = HashSet::new();
        for object in objects.iter().filter(|object| object.kind == Kind::Connector) {
            if !known.insert(&object.name) {
                let text = format!("two connectors are called `{}`", object.name);
                let message = Diagnostic::new(Code::DuplicateName, object.span, text);
                self.messages.push(message.help("give each connector its own name"));
            }
        }
    }

    pub(super) fn structured_text(&mut self, node: Node, body: &mut Body) -> BlockCode {
        let range = self.text_range(elements(node).next().unwrap_or(node));
        let statements = range.map(|range| self.statements(range, body)).unwrap_or_default();
        BlockCode::Scl(SclBody { dialect: Dialect::Tia, labels: Vec::new(), statements })
    }

    /// How the ST of this editor is read.
    pub(super) fn iec(&self) -> Iec {
        Iec { nested_comments: self.editor.nests_comments() }
    }

    /// The statements in a part of the file.
    pub(super) fn statements(&mut self, range: Range<usize>, body: &Body) -> Vec<Statement> {
        pragma::clear(self.file, self.editor, &mut self.overlay, range.clone(), &mut self.messages);
        let (mut statements, messages) = fragment::iec_statements(self.file, &self.overlay, range, self.iec());
        self.messages.extend(messages);
        body.scope.statements(&mut statements);
        self.messages.append(&mut body.scope.messages.borrow_mut());
        statements
    }

    /// The expression in a part of the file; the scope of a POU resolves the names.
    pub(super) fn expression(&mut self, range: Range<usize>, scope: Option<&Scope>) -> Expr {
        pragma::clear(self.file, self.editor, &mut self.overlay, range.clone(), &mut self.messages);
        let (mut value, messages) = fragment::iec_expression(self.file, &self.overlay, range, self.iec());
        self.messages.extend(messages);
        if let Some(scope) = scope {
            scope.expr(&mut value);
            self.messages.append(&mut scope.messages.borrow_mut());
        }
        value
    }

    /// As `expression`, with its type as far as it is known.
    pub(super) fn typed_expression(&mut self, range: Range<usize>, scope: &Scope) -> (Expr, Option<Ty>) {
        let mut value = self.expression(range, None);
        let kind = scope.typed(&mut value);
        self.messages.append(&mut scope.messages.borrow_mut());
        (value, kind)
    }
}

/// Variables that live for one call have their start values in each call, so statements at the beginning assign them. Values of arrays and
/// structures stay at the declaration, where they are reported. `outputs_begin_anew`: the same applies to outputs of functions in ST and IL; one
/// without a start value begins at 0.
fn assign_start_values(sections: &mut [Section], code: &mut BlockCode, outputs_begin_anew: bool) {
    if matches!(code, BlockCode::Stl(_) | BlockCode::Chart(_)) {
        return;
    }
    let outputs_too = outputs_begin_anew && matches!(code, BlockCode::Scl(_));
    let mut statements = Vec::new();
    for section in sections {
        let is_output = outputs_too && section.kind == SectionKind::Output;
        if !is_output && section.kind != SectionKind::Temp {
            continue;
        }
        for variable in &mut section.variables {
            let span = variable.name_span;
            let single = variable.initial.take_if(|initial| matches!(initial.kind, InitialKind::Expr(_)));
            let value = match single {
                Some(InitialValue { kind: InitialKind::Expr(value), .. }) => Some(*value),
                _ if is_output && variable.initial.is_none() => zero(&variable.ty.kind, span),
                _ => None,
            };
            let Some(value) = value else { continue };
            let name = Name { text: variable.name.clone(), form: NameForm::Local, span };
            let target = Expr { kind: ExprKind::Name(name), span };
            let kind = StatementKind::Assign { targets: vec![(target, AssignOp::Set)], value };
            statements.push(Statement { kind, span });
        }
    }
    let Some(span) = statements.first().map(|first| first.span) else { return };
    match code {
        BlockCode::Scl(body) => drop(body.statements.splice(0..0, statements)),
        BlockCode::Graphic(body) => {
            let (title, comment, labels, content) = (None, Vec::new(), Vec::new(), Content::Scl(statements));
            body.networks.insert(0, Network { language: Language::Scl, title, comment, labels, content, span });
        }
        BlockCode::Stl(_) | BlockCode::Chart(_) => {}
    }
}

/// The start value of an elementary type.
fn zero(ty: &TypeKind, span: Span) -> Option<Expr> {
    let TypeKind::Named(name) = ty else { return None };
    let ty = Elementary::from_word(name)?;
    Some(Expr { kind: ExprKind::Literal(Literal::Typed { ty, bits: 0 }), span })
}

/// Gives comments to the networks below them: the first line is the title. `tops`: where the networks begin.
fn comments(content: Node, tops: &[i64], networks: &mut [Network]) {
    let mut found: Vec<((i64, i64), Vec<String>)> = elements(content)
        .filter(|node| node.tag_name().name() == "comment")
        .map(|node| (objects::position(node), lines_of(node)))
        .collect();
    found.sort_by_key(|(position, _)| *position);
    for ((y, _), lines) in found {
        let below = tops.iter().enumerate().filter(|(_, top)| **top >= y).min_by_key(|(_, top)| **top);
        let Some((at, _)) = below else { continue };
        let network = &mut networks[at];
        let mut lines = lines.into_iter();
        if network.title.is_none() && network.comment.is_empty() {
            network.title = lines.next().filter(|line| !line.is_empty());
        }
        network.comment.extend(lines);
    }
}

/// The lines of a comment, without blank ones at its end.
fn lines_of(node: Node) -> Vec<String> {
    let texts = node.descendants().filter(|node| node.is_text()).filter_map(|node| node.text());
    let text = texts.map(|text| if text.trim().is_empty() { "" } else { text }).collect::<Vec<_>>().concat();
    text.trim_end().lines().map(|line| line.trim().to_string()).collect()
}

/// The language element of a body. CODESYS puts its function charts into additional data.
pub(super) fn body_content<'a, 'i>(body: Node<'a, 'i>) -> Option<Node<'a, 'i>> {
    let mut languages = elements(body).filter(|node| !matches!(node.tag_name().name(), "documentation" | "addData"));
    let plain = languages.next();
    let added = body.descendants().find(|node| node.tag_name().name() == "CFC");
    match plain {
        Some(plain) if plain.has_children() => Some(plain),
        _ => added.or(plain),
    }
}

/// Variables of an interface that hold bits of a word.
pub(super) fn words(interface: Option<Node>) -> HashSet<String> {
    let is_word = |variable: &Node| {
        let ty = child(*variable, "type").and_then(|ty| elements(ty).next());
        ty.is_some_and(|ty| matches!(ty.tag_name().name(), "BYTE" | "WORD" | "DWORD" | "LWORD"))
    };
    interface
        .into_iter()
        .flat_map(elements)
        .flat_map(elements)
        .filter(is_word)
        .filter_map(|variable| variable.attribute("name"))
        .map(str::to_lowercase)
        .collect()
}

/// The words of a text, in lower case.
pub(super) fn words_of(text: &str) -> HashSet<String> {
    let words = text.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty());
    words.map(str::to_lowercase).collect()
}

/// Whether the text has the name as a separate word.
pub(super) fn mentions(text: &str, name: &str) -> bool {
    let mut words = text.split(|c: char| !c.is_alphanumeric() && c != '_');
    words.any(|word| word.eq_ignore_ascii_case(name))
}
