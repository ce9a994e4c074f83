//! Blocks with code, as the program organization units of a project.

use std::collections::{BTreeSet, HashMap};

use plcc_syntax::ast::{Code, CodeBlock, CodeKind, Retain, Section, SectionKind};
use plcc_syntax::network::ast::{Content, Language};
use plcc_syntax::scl::ast::{Dialect, Statement};
use plcc_syntax::stl::Mnemonics;

use super::body::Body;
use super::declare::unique;
use super::identifier::identifier;
use super::program::{Global, is_function};
use super::{Project, body, chart, comment_of, documentation, globals, network, system, tasks};
use crate::frames::bare;
use crate::node::Node;
use crate::trivia::Trivia;
use crate::writer::{Notation, Writer};

impl<'a> Project<'_, 'a, '_> {
    /// A block with code, with its task if it is an organization block.
    pub(super) fn code(&mut self, block: &'a CodeBlock, writer: &mut Writer) {
        let program = self.program;
        let key = program.key(&block.name);
        let before = writer.lines_before(block.span.start);
        self.header(&block.header, block.name.span(), writer);
        if block.kind == CodeKind::Ob {
            self.tasks.extend(tasks::of_block(program, block, self.settings, writer));
            if tasks::instances(program, block).is_some() {
                return;
            }
        }
        let is_task = program.tasks.values().any(|fb| *fb == key);
        let kind = match block.kind {
            CodeKind::Ob => "program",
            CodeKind::Fb | CodeKind::Sfb if is_task => "program",
            CodeKind::Fb | CodeKind::Sfb => "functionBlock",
            CodeKind::Fc | CodeKind::Sfc => "function",
        };
        let name = program.name(&key);
        let mut interface = Node::new("interface");
        if let Some(ty) = &block.return_type {
            let ty = self.declarer.type_node(ty, "result", &name, writer);
            interface.push(Node::new("returnType").child(ty));
        }
        let variables = block.sections.iter().flat_map(|section| &section.variables);
        let constants = block.constants.iter().map(|one| (one.name.as_str(), one.name_span));
        let steps = chart::of_block(block).into_iter().flat_map(|chart| &chart.steps);
        let steps = steps.map(|step| (step.name.text.as_str(), step.name.span));
        unique(variables.map(|one| (one.name.as_str(), one.name_span)).chain(constants).chain(steps), writer);
        let operating = chart::operating(block);
        if !operating.is_empty() {
            let title = format!("the operating parameters of `{name}` are not in the file: {}", operating.join(", "));
            let help = "SFC has no operating modes; draw what the program needs of them as steps and transitions";
            writer.warn(block.name.span(), title, help);
        }
        for section in &block.sections {
            interface.children.extend(self.section(section, block, &name, writer));
        }
        interface.children.extend(self.constants(block, &name, writer));
        let local_names: Vec<String> = interface
            .children
            .iter()
            .flat_map(|list| &list.children)
            .filter_map(|one| one.attributes.first())
            .map(|(_, name)| name.to_lowercase())
            .collect();
        let mut steps = chart::of_block(block).into_iter().flat_map(|chart| &chart.steps);
        let is_step = steps.any(|step| identifier(&step.name.text).eq_ignore_ascii_case(&name));
        if is_step || local_names.contains(&name.to_lowercase()) {
            self.learned.hidden.insert(key.clone());
        }
        let mut body = Body::new(program, block, writer, &mut self.learned);
        let code = body_of(&mut body);
        let (used, retyped) = (std::mem::take(&mut body.used), std::mem::take(&mut body.retyped));
        for list in &mut interface.children {
            list.children.retain_mut(|variable| retype(variable, &retyped));
        }
        interface.children.retain(|list| !list.children.is_empty());
        interface.children.extend(self.externals(&used, writer));
        self.used.extend(used);
        let mut node = Node::new("pou").with("name", name).with("pouType", kind).child(interface);
        node.push(Node::new("body").children(code));
        // Those after the last part of a chart.
        let comments = before.into_iter().chain(writer.lines_before(block.span.end)).collect();
        node.children.extend(comment_of(comments, &block.header));
        self.pous.push(node);
    }

    fn section(&mut self, section: &'a Section, block: &CodeBlock, name: &str, writer: &mut Writer) -> Option<Node> {
        let list = match section.kind {
            // A program has no start information; code that reads it is refused.
            SectionKind::Input if block.kind == CodeKind::Ob => return None,
            SectionKind::Input => "inputVars",
            SectionKind::Output => "outputVars",
            SectionKind::InOut => "inOutVars",
            SectionKind::Static => "localVars",
            SectionKind::Temp if is_function(block) => "localVars",
            SectionKind::Temp => "tempVars",
        };
        let mut node = Node::new(list);
        match section.retain {
            Retain::Retain => node.attributes.push(("retain", "true".to_string())),
            Retain::NonRetain => node.attributes.push(("nonretain", "true".to_string())),
            Retain::Unsaid => {}
            Retain::DbSpecific => {
                let title =
                    "each instance chooses whether these variables are retentive, which PLCopen XML does not have";
                writer.refuse(section.span, title, "declare them as retentive or not");
            }
        }
        for variable in &section.variables {
            if block.kind == CodeKind::Ob && body::is_start_name(&variable.name)
                || chart::is_operating(block, &variable.name)
            {
                continue;
            }
            let declared = self.declarer.variable(variable, name, writer);
            node.push(declared);
        }
        (!node.children.is_empty()).then_some(node)
    }

    fn constants(&mut self, block: &'a CodeBlock, name: &str, writer: &mut Writer) -> Option<Node> {
        let mut node = Node::new("localVars").with("constant", "true");
        for constant in &block.constants {
            let (Some(ty), Some(value)) = (&constant.ty, &constant.value) else {
                let title = format!("PLCopen XML has no form for the constant `{}`", constant.name);
                writer.refuse(constant.name_span, title, "declare it in VAR CONSTANT with its type and one value");
                continue;
            };
            let ty = self.declarer.type_node(ty, &constant.name, name, writer);
            let mut body = Body::new(self.program, block, writer, &mut self.learned);
            let text = body.text(value);
            let mut variable = Node::new("variable").with("name", identifier(&constant.name));
            variable.push(Node::new("type").child(ty));
            variable.push(Node::new("initialValue").child(Node::new("simpleValue").with("value", text)));
            let remarks = writer.trivia.on_line(value.span.end);
            let comment: Vec<String> = remarks.iter().map(|remark| bare(&remark.text)).collect();
            if !comment.is_empty() {
                variable.push(documentation(&comment.join("\n")));
            }
            node.push(variable);
        }
        (!node.children.is_empty()).then_some(node)
    }

    /// VAR_EXTERNAL of the global variables that a POU uses.
    fn externals(&mut self, used: &BTreeSet<String>, writer: &mut Writer) -> Vec<Node> {
        let (mut variables, mut constants) =
            (Node::new("externalVars"), Node::new("externalVars").with("constant", "true"));
        for key in used {
            let name = self.program.name(key);
            let mut plain = Node::new("variable").with("name", name);
            let ty = match self.program.global(key) {
                Some(Global::Tag(symbol)) => body::tag_type(symbol).and_then(system::type_element).map(Node::new),
                Some(Global::Constant(constant)) => {
                    let ty = crate::to_stl::types::elementary(&constant.ty).and_then(system::type_element);
                    if let Some(ty) = ty {
                        plain.push(Node::new("type").child(Node::new(ty)));
                        constants.push(plain);
                    }
                    continue;
                }
                Some(Global::Data(block)) => {
                    // Its type is that of its declaration, where messages about it are.
                    let mut quiet = Writer::new(Notation::St, Mnemonics::En, Trivia::none(), None);
                    let known = self.data.iter().find(|(other, ..)| other == key).cloned();
                    let node = match known {
                        Some((_, _, node)) => node,
                        None => globals::data(&mut self.declarer, key, block, &mut quiet),
                    };
                    node.children
                        .into_iter()
                        .find(|child| child.name == "type")
                        .and_then(|ty| ty.children.into_iter().next())
                }
                Some(Global::Variable(variable)) => {
                    Some(self.declarer.type_node(&variable.ty, &variable.name, "", writer))
                }
                Some(Global::Code(_) | Global::Type(_)) | None => None,
            };
            if let Some(ty) = ty {
                plain.push(Node::new("type").child(ty));
                variables.push(plain);
            }
        }
        [variables, constants].into_iter().filter(|list| !list.children.is_empty()).collect()
    }
}

/// Gives an edge bit the block that takes its name; false: the file does not need it.
fn retype(variable: &mut Node, retyped: &HashMap<String, Option<&'static str>>) -> bool {
    let name = variable.attributes.first().map(|(_, name)| name.to_lowercase()).unwrap_or_default();
    match retyped.get(&name) {
        None => true,
        Some(None) => false,
        Some(Some(block)) => {
            let ty = Node::new("type").child(Node::new("derived").with("name", block));
            variable.children.retain(|child| child.name != "type");
            variable.children.insert(0, ty);
            true
        }
    }
}

/// The code of a block in its language.
fn body_of(body: &mut Body) -> Option<Node> {
    let block = body.block;
    let span = block.name.span();
    match &block.code {
        Code::Scl(scl) if scl.dialect == Dialect::Classic => {
            let title =
                format!("`{}` is SCL of STEP 7 V5, which has other rules than ST", body.program.shown(&body.key));
            body.refuse(span, title, "write it as SCL of the TIA Portal first: names with `#` and quotes");
            None
        }
        Code::Scl(scl) => Some(structured_text(body, &[&scl.statements], block.span.end)),
        Code::Graphic(networks) => {
            let is_text = |content: &Content| matches!(content, Content::Scl(_));
            let networks = &networks.networks;
            if !networks.is_empty() && networks.iter().all(|network| is_text(&network.content)) {
                let lists: Vec<&[Statement]> = networks
                    .iter()
                    .filter_map(|network| match &network.content {
                        Content::Scl(list) => Some(list.as_slice()),
                        Content::Graphic(_) | Content::Stl(_) => None,
                    })
                    .collect();
                return Some(structured_text(body, &lists, block.span.end));
            }
            let is_ladder = networks.iter().any(|network| network.language == Language::Lad) || networks.is_empty();
            Some(network::write(body, networks, if is_ladder { Language::Lad } else { Language::Fbd }))
        }
        Code::Stl(_) => {
            let title =
                format!("plcc writes no STL as PLCopen XML, such as that of `{}`", body.program.shown(&body.key));
            body.refuse(span, title, "write it as networks first, with `--to lad`, or as SCL");
            None
        }
        Code::Chart(chart) => chart::write(body, chart),
    }
}

fn structured_text(body: &mut Body, lists: &[&[Statement]], end: u32) -> Node {
    body.writer.out = crate::out::Out::default();
    for list in lists {
        let statements = body.statements(list);
        body.writer.statements(&statements);
    }
    body.writer.remarks_before(end);
    let text = std::mem::take(&mut body.writer.out).into_text();
    Node::new("ST").child(Node::of("xhtml:p", text))
}
