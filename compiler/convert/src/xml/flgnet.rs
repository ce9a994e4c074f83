//! Networks of LAD and FBD: their parts.

use plcc_syntax::ast::{CodeBlock, CodeKind, OperandKind, SectionKind, TypeKind, Variable};
use plcc_syntax::network::ast::{Comparison, Element, Eno, Graph, Network, Storage, Target, TemplateKey};
use plcc_syntax::network::elements::{self, Kind};
use plcc_syntax::network::order::order;
use plcc_syntax::scl::ast::{Expr, ExprKind, NameForm};

use super::access::{self, Whose};
use super::order::Drawing;
use super::{Library, Uids, interface, referred};
use crate::node::Node;
use crate::scl::expression;
use crate::writer::Writer;

/// The namespace of `FlgNet`.
pub(super) const NAMESPACE: &str = "http://www.siemens.com/automation/Openness/SW/NetworkSource/FlgNet/v4";

/// A network as `FlgNet`; `None`: it was refused.
pub fn network(
    graph: &Graph,
    network: &Network,
    block: &CodeBlock,
    library: &Library,
    writer: &mut Writer,
) -> Option<Node> {
    if graph.broken {
        writer.refuse(network.span, "a network that was not understood", "repair the source first");
        return None;
    }
    let mut maker = Maker::new(graph, block, library);
    for (at, element) in graph.elements.iter().enumerate() {
        let node = maker.part(at, element, writer)?;
        maker.parts.push(node);
    }
    maker.wire(network, writer)?;
    // Either the reader finds the elements as they are listed here, or in the order in which they are evaluated.
    let read = maker.drawing.order(network.language);
    if !read.iter().copied().eq(0..graph.elements.len()) && read != order(graph) {
        writer.refuse(
            network.span,
            "the editor would evaluate the elements of this network in another order",
            "divide the network into several",
        );
        return None;
    }
    let mut net = Node::new("FlgNet").with("xmlns", NAMESPACE);
    if !network.labels.is_empty() {
        let label = |name: &str, uids: &mut Uids| {
            let label = Node::new("Label").with("Name", name);
            Node::new("LabelDeclaration").with("UId", uids.next()).child(label)
        };
        let labels = network.labels.iter().map(|name| label(&name.text, &mut maker.uids));
        net.push(Node::new("Labels").children(labels.collect::<Vec<_>>()));
    }
    net.push(Node::new("Parts").children(maker.operands).children(maker.parts));
    net.push(Node::new("Wires").children(maker.wires));
    Some(net)
}

/// What is made of one network.
pub(super) struct Maker<'a> {
    pub(super) graph: &'a Graph,
    pub(super) block: &'a CodeBlock,
    pub(super) library: &'a Library,
    pub(super) uids: Uids,
    pub(super) operands: Vec<Node>,
    pub(super) parts: Vec<Node>,
    pub(super) wires: Vec<Node>,
    /// Numbers of the parts, elements first.
    pub(super) part_uids: Vec<u32>,
    pub(super) drawing: Drawing<'a>,
}

impl<'a> Maker<'a> {
    fn new(graph: &'a Graph, block: &'a CodeBlock, library: &'a Library) -> Maker<'a> {
        let drawing =
            Drawing { parts: Vec::new(), pins: Vec::new(), sinks: Vec::new(), sources: Vec::new(), rail: None };
        let (operands, parts, wires, part_uids) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut uids = Uids::new();
        uids.next();
        Maker { graph, block, library, uids, operands, parts, wires, part_uids, drawing }
    }

    // Parts.

    fn part(&mut self, at: usize, element: &'a Element, writer: &mut Writer) -> Option<Node> {
        debug_assert_eq!(at, self.part_uids.len());
        let uid = self.uids.next();
        self.part_uids.push(uid);
        self.drawing.parts.push(Some(element));
        self.drawing.pins.push(Vec::new());
        if let Some(pin) = element.pins.iter().find(|pin| pin.storage != Storage::None) {
            let help = "write a set or reset coil";
            writer.refuse(pin.span, "SimaticML has no outputs that set or reset their operand", help);
            return None;
        }
        let mut node = match &element.target {
            Target::Element { row, instance } => {
                let names = row.xml.iter().chain(row.open.iter().filter(|_| matches!(row.kind, Kind::Instance(_))));
                let mut names = names.copied().chain([row.name]).chain(row.sd.iter().copied());
                let name = names.find(|name| elements::find_xml(name) == Some(*row));
                let Some(name) = name else {
                    let title = format!("SimaticML has no element `{}`", row.name);
                    writer.refuse(element.span, title, "write the network with other elements");
                    return None;
                };
                let mut node = Node::new("Part").with("Name", name);
                if matches!(row.kind, Kind::Instance(_)) {
                    node = node.with("Version", "1.0");
                }
                node = node.with("UId", uid);
                let is_box = row.is_box();
                self.eno(element, is_box, &mut node);
                if let Some(instance) = instance {
                    node.push(self.instance(instance, writer)?);
                }
                self.settings(element, &mut node, writer);
                node
            }
            Target::Block { callee, instance } => self.call(uid, element, callee, instance.as_ref(), writer)?,
        };
        for pin in element.pins.iter().filter(|pin| pin.negated) {
            let negated = node
                .children
                .iter()
                .any(|child| child.name == "Negated" && child.attributes.iter().any(|(_, name)| *name == pin.name));
            if !negated {
                node.push(Node::new("Negated").with("Name", &pin.name));
            }
        }
        Some(node)
    }

    fn eno(&self, element: &Element, is_box: bool, node: &mut Node) {
        let disabled = match element.eno {
            Eno::Default => None,
            Eno::Generated => Some("false"),
            Eno::Disabled => Some("true"),
        };
        if let Some(disabled) = disabled.filter(|_| is_box) {
            node.attributes.push(("DisabledENO", disabled.to_string()));
        }
    }

    fn settings(&self, element: &Element, node: &mut Node, writer: &mut Writer) {
        if let Some(equation) = &element.equation {
            node.push(Node::of("Equation", expression::text(equation, writer)));
        }
        if let Target::Element { row, .. } = &element.target
            && matches!(row.kind, Kind::Gate(_))
        {
            let count = element.pins.iter().filter(|pin| !pin.output).count();
            node.push(Node::of("TemplateValue", count.to_string()).with("Name", "Card").with("Type", "Cardinality"));
        }
        for template in &element.templates {
            let name = match template.key {
                TemplateKey::Source => "SrcType",
                TemplateKey::Destination => "DestType",
                TemplateKey::Value => "value_type",
                TemplateKey::Time => "time_type",
                TemplateKey::Card => continue,
                // Types that follow from the operands.
                TemplateKey::Other => "type",
            };
            node.push(match template.value.is_empty() {
                true => Node::new("AutomaticTyped").with("Name", name),
                false => Node::of("TemplateValue", template.value.as_str()).with("Name", name).with("Type", "Type"),
            });
        }
        for (at, case) in element.cases.iter().enumerate() {
            let sign = match case {
                Comparison::Equal => "EQ",
                Comparison::NotEqual => "NE",
                Comparison::Less => "LT",
                Comparison::LessEqual => "LE",
                Comparison::Greater => "GT",
                Comparison::GreaterEqual => "GE",
            };
            let case = Node::of("TemplateValue", sign).with("Name", format!("case{at}")).with("Type", "Operation");
            node.push(case);
        }
    }

    fn instance(&mut self, value: &Expr, writer: &mut Writer) -> Option<Node> {
        match access::path(value, "Instance", self.block, &mut self.uids, writer) {
            Some((whose, mut node)) => {
                let scope = if whose == Whose::Global { "GlobalVariable" } else { "LocalVariable" };
                node.attributes.push(("Scope", scope.to_string()));
                node.attributes.push(("UId", self.uids.next().to_string()));
                Some(node)
            }
            None => {
                writer.refuse(value.span, "SimaticML has no form for this instance", "name a variable or a data block");
                None
            }
        }
    }

    fn call(
        &mut self,
        uid: u32,
        element: &Element,
        callee: &Expr,
        instance: Option<&Expr>,
        writer: &mut Writer,
    ) -> Option<Node> {
        // A block of the system library, by its name alone.
        if let ExprKind::Name(name) = &callee.kind
            && name.form == NameForm::Bare
            && !self.library.blocks.contains_key(&name.text.to_lowercase())
            && access::whose(&name.text, name.form, self.block) == Whose::Global
            && !self.library.instances.contains_key(&name.text.to_lowercase())
        {
            let mut node = Node::new("Part").with("Name", &name.text).with("Version", "1.0").with("UId", uid);
            self.eno(element, true, &mut node);
            if let Some(instance) = instance {
                node.push(self.instance(instance, writer)?);
            }
            self.settings(element, &mut node, writer);
            return Some(node);
        }
        // The same on an instance: `#alarm.Program_Alarm( … )`.
        if let ExprKind::Member { base, name } = &callee.kind
            && instance.is_none()
            && self.is_instance_of(base, &name.text)
        {
            let mut node = Node::new("Part").with("Name", &name.text).with("Version", "1.0").with("UId", uid);
            self.eno(element, true, &mut node);
            node.push(self.instance(base, writer)?);
            self.settings(element, &mut node, writer);
            return Some(node);
        }
        let (name, instance) = match self.called(callee, instance) {
            Some(found) => found,
            None => {
                writer.refuse(
                    callee.span,
                    "a call of an instance whose function block is not in the sources",
                    "add the source of the function block",
                );
                return None;
            }
        };
        let name = match &callee.kind {
            ExprKind::Absolute(OperandKind::Block(number)) => {
                referred(number, self.library, writer);
                self.library.standard_name(number).map_or(name, str::to_string)
            }
            _ => name,
        };
        let known = self.library.blocks.get(&name.to_lowercase());
        let is_fb = instance.is_some() || known.is_some_and(|(kind, ..)| *kind == CodeKind::Fb);
        let mut info = Node::new("CallInfo").with("Name", &name).with("BlockType", if is_fb { "FB" } else { "FC" });
        if let Some(instance) = instance {
            info.push(self.instance(instance, writer)?);
        }
        info.children.extend(self.parameters(element, &name, writer));
        let mut node = Node::new("Call").with("UId", uid);
        self.eno(element, true, &mut node);
        Some(node.child(info))
    }

    /// Whether a variable of the block or a data block is declared as an instance of a block of the system with that name.
    fn is_instance_of(&self, value: &Expr, block: &str) -> bool {
        let ExprKind::Name(name) = &value.kind else { return false };
        if self.library.blocks.contains_key(&block.to_lowercase()) {
            return false;
        }
        if access::whose(&name.text, name.form, self.block) == Whose::Global {
            return self.library.instance(&name.text).is_some_and(|of| of.eq_ignore_ascii_case(block));
        }
        let mut variables = self.block.sections.iter().flat_map(|section| &section.variables);
        let variable = variables.find(|variable| variable.name.eq_ignore_ascii_case(&name.text));
        variable.is_some_and(|variable| match &variable.ty.kind {
            TypeKind::Named(of) => of.eq_ignore_ascii_case(block),
            TypeKind::Block(of) => self.library.block_name(of).eq_ignore_ascii_case(block),
            _ => false,
        })
    }

    /// The name of the block that is called, and its instance.
    fn called<'e>(&self, callee: &'e Expr, instance: Option<&'e Expr>) -> Option<(String, Option<&'e Expr>)> {
        if let Some(name) = access::block_name(callee, self.library) {
            let is_local = match &callee.kind {
                ExprKind::Name(name) => access::whose(&name.text, name.form, self.block) != Whose::Global,
                _ => false,
            };
            if !is_local {
                return match self.library.instance(&name).filter(|_| instance.is_none()) {
                    Some(of) => Some((of, Some(callee))),
                    None => Some((name, instance)),
                };
            }
        }
        // A multi-instance, by its declared type.
        let (name, of_array) = match &callee.kind {
            ExprKind::Name(name) => (name, false),
            ExprKind::Index { base, .. } => match &base.kind {
                ExprKind::Name(name) => (name, true),
                _ => return None,
            },
            _ => return None,
        };
        let mut variables = self.block.sections.iter().flat_map(|section| &section.variables);
        let variable = variables.find(|variable| variable.name.eq_ignore_ascii_case(&name.text))?;
        let kind = match &variable.ty.kind {
            TypeKind::Array { element, .. } if of_array => &element.kind,
            kind => kind,
        };
        match kind {
            TypeKind::Block(of) => Some((self.library.block_name(of), Some(callee))),
            TypeKind::Named(of) => Some((of.clone(), Some(callee))),
            _ => None,
        }
    }

    /// The parameters of a call: those of the declaration, otherwise those that are connected.
    fn parameters(&self, element: &Element, name: &str, writer: &mut Writer) -> Vec<Node> {
        let parameter = |name: &str, section: &str| Node::new("Parameter").with("Name", name).with("Section", section);
        let mut found: Vec<Node> = Vec::new();
        if let Some((_, sections, returns)) = self.library.blocks.get(&name.to_lowercase()) {
            let named = |variable: &Variable, section: &str, writer: &mut Writer| {
                parameter(&variable.name, section)
                    .with("Type", interface::type_text(&variable.ty, self.library, writer))
            };
            for (kind, word) in
                [(SectionKind::Input, "Input"), (SectionKind::Output, "Output"), (SectionKind::InOut, "InOut")]
            {
                let own = sections.iter().filter(|section| section.kind == kind);
                for variable in own.flat_map(|section| &section.variables) {
                    found.push(named(variable, word, writer));
                }
            }
            if let Some(ty) = returns {
                found.push(parameter("Ret_Val", "Return").with("Type", interface::type_text(ty, self.library, writer)));
            }
        }
        // Pins that the declaration does not have, in the order of the element.
        for pin in element.pins.iter().filter(|pin| !matches!(pin.name.as_str(), "en" | "eno")) {
            let is_known = found.iter().any(|node| {
                node.attributes.iter().any(|(key, own)| *key == "Name" && own.eq_ignore_ascii_case(&pin.name))
            });
            if !is_known {
                found.push(parameter(&pin.name, if pin.output { "Output" } else { "Input" }));
            }
        }
        found
    }
}
