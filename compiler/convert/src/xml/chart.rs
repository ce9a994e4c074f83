//! Charts of GRAPH: `Graph`, with steps, transitions, and the lines between them.
//!
//! A tree says only what each transition leaves and enters. Branches are drawn where a step has several transitions and where a
//! transition has several steps, one branch each: arms in the order in which the transitions count, in the tree's order of steps.
//!
//! Source: GRAPH reference, chapter B.

mod actions;
mod lines;

use plcc_diag::Span;
use plcc_syntax::ast::CodeBlock;
use plcc_syntax::chart::ast::{Body, Call, Condition, Dialect, Permanent, PermanentKind, Step, Transition};
use plcc_syntax::network::ast::{Content, Network};

use super::header::set;
use super::{Ids, Library, flgnet, language_name, multilingual_lines, scl, stl, unit};
use crate::node::Node;
use crate::scl::expression;
use crate::writer::Writer;

/// The compile unit of a chart; `None`: it was refused.
pub fn compile_unit(
    chart: &Body,
    block: &CodeBlock,
    library: &Library,
    ids: &mut Ids,
    writer: &mut Writer,
) -> Option<Node> {
    if chart.broken {
        writer.refuse(block.name.span(), "a chart that was not understood", "repair the source first");
        return None;
    }
    let help = match chart.dialect {
        Dialect::Tia => None,
        Dialect::Classic => Some("migrate the project of STEP 7 in the TIA Portal, which makes such a chart of it"),
        Dialect::Sfc => Some("convert it with `--to gr7`"),
    };
    if let Some(help) = help {
        let name = super::name_of(&block.name);
        writer.refuse(
            block.name.span(),
            format!("`{name}` is not a chart of the TIA Portal, whose data are others"),
            help,
        );
        return None;
    }
    let mut maker = Maker { block, library, writer };
    let mut graph =
        Node::new("Graph").with("xmlns", "http://www.siemens.com/automation/Openness/SW/NetworkSource/Graph/v4");
    graph.push(maker.permanents("PreOperations", &chart.before)?);
    for part in lines::sequences(chart, maker.writer)? {
        let steps = part.steps.iter().map(|&at| maker.step(&chart.steps[at])).collect::<Option<Vec<_>>>()?;
        let transitions =
            part.transitions.iter().map(|&at| maker.transition(&chart.transitions[at])).collect::<Option<Vec<_>>>()?;
        graph.push(
            Node::new("Sequence")
                .child(Node::new("Title"))
                .child(Node::new("Comment"))
                .child(Node::new("Steps").children(steps))
                .child(Node::new("Transitions").children(transitions))
                .child(Node::new("Branches").children(part.branches))
                .child(Node::new("Connections").children(part.connections)),
        );
    }
    let extensions = extensions(chart).count();
    graph.push(maker.permanents("PostOperations", &chart.after[..chart.after.len() - extensions])?);
    graph.push(Node::new("AlarmsSettings"));
    Some(unit("GRAPH", Some(graph), None, &[], ids))
}

/// The settings of a chart in the list of attributes of its block.
pub fn settings(chart: &Body, list: &mut Node, writer: &mut Writer) {
    let rows = [
        ("AcknowledgeErrorsRequired", chart.settings.acknowledge),
        ("LockOperatingMode", chart.settings.locked_mode),
        ("PermanentILProcessingInMANMode", chart.settings.manual_interlocks),
        ("SkipSteps", chart.settings.skip_steps),
    ];
    for (name, value) in rows {
        if let Some(value) = value {
            set(list, name, value.to_string());
        }
    }
    let mut names: Vec<String> = extensions(chart).map(|call| expression::text(&call.block, writer)).collect();
    names.reverse();
    if !names.is_empty() {
        set(list, "ExtensionBlocks", names.join(","));
    }
}

/// Calls at the end of a chart, the last one first: the settings name these blocks.
fn extensions(chart: &Body) -> impl Iterator<Item = &Call> {
    chart.after.iter().rev().map_while(|row| match &row.kind {
        PermanentKind::Call(call) if call.instance.is_none() && call.parameters.is_empty() => Some(call),
        _ => None,
    })
}

struct Maker<'a, 'w> {
    block: &'a CodeBlock,
    library: &'a Library,
    writer: &'a mut Writer<'w>,
}

impl Maker<'_, '_> {
    fn permanents(&mut self, list: &'static str, rows: &[Permanent]) -> Option<Node> {
        let mut node = Node::new(list);
        for row in rows {
            let PermanentKind::Network(network) = &row.kind else {
                let title = "the TIA Portal has permanent instructions only as networks";
                self.writer.refuse(row.span, title, "call the block in a network");
                return None;
            };
            let operation =
                Node::new("PermanentOperation").with("ProgrammingLanguage", language_name(network.language));
            node.push(self.texts(operation, network).child(self.network(network)?));
        }
        Some(node)
    }

    /// The title and comment of a network.
    fn texts(&self, node: Node, network: &Network) -> Node {
        let title = network.title.iter().cloned().collect::<Vec<_>>();
        node.child(multilingual_lines("Title", &title)).child(multilingual_lines("Comment", &network.comment))
    }

    fn network(&mut self, network: &Network) -> Option<Node> {
        match &network.content {
            Content::Graphic(graph) => flgnet::network(graph, network, self.block, self.library, self.writer),
            Content::Scl(list) => Some(scl::statements(list, self.block, self.library, network.span.end, self.writer)),
            Content::Stl(list) => Some(stl::statements(list, self.block, self.library, None, self.writer)),
        }
    }

    fn step(&mut self, step: &Step) -> Option<Node> {
        let mut node =
            Node::new("Step").with("Number", step.number).with("Init", step.initial).with("Name", &step.name.text);
        for (name, time) in [("MaximumStepTime", &step.maximum), ("WarningTime", &step.warning)] {
            if let Some(time) = time {
                node = node.with(name, expression::text(time, self.writer));
            }
        }
        let mut rows = Node::new("Actions");
        for action in &step.actions {
            rows.push(self.action(action)?);
        }
        // An empty row ends the table.
        rows.push(Node::new("Action"));
        let node = node
            .child(multilingual_lines("StepName", std::slice::from_ref(&step.name.text)))
            .child(multilingual_lines("Comment", &step.comment))
            .child(rows);
        let lists = [
            ("Supervisions", "Supervision", "SvCoil", &step.supervision),
            ("Interlocks", "Interlock", "IlCoil", &step.interlock),
        ];
        lists.into_iter().try_fold(node, |node, (list, name, coil, condition)| {
            let condition = self.condition(Node::new(name), condition.as_ref(), coil, step.span)?;
            Some(node.child(Node::new(list).child(condition)))
        })
    }

    fn transition(&mut self, transition: &Transition) -> Option<Node> {
        let node = Node::new("Transition")
            .with("IsMissing", transition.missing)
            .with("Name", &transition.name.text)
            .with("Number", transition.number)
            .child(multilingual_lines("TransitionName", std::slice::from_ref(&transition.name.text)))
            .child(multilingual_lines("Comment", &transition.comment));
        if transition.missing {
            return Some(node);
        }
        self.condition(node, transition.condition.as_ref(), "TrCoil", transition.span)
    }

    /// Adds a condition; without one, a coil directly at the power rail.
    fn condition(&mut self, node: Node, condition: Option<&Condition>, coil: &str, span: Span) -> Option<Node> {
        match condition {
            None => Some(node.with("ProgrammingLanguage", "LAD").child(at_the_rail(coil))),
            Some(Condition::Network(network)) => {
                Some(node.with("ProgrammingLanguage", language_name(network.language)).child(self.network(network)?))
            }
            Some(Condition::Expression(_) | Condition::Statements(_)) => {
                let title = "the TIA Portal has conditions only as networks";
                self.writer.refuse(span, title, "write the condition with contacts and comparisons");
                None
            }
        }
    }
}

/// The network of a coil that is always on.
fn at_the_rail(coil: &str) -> Node {
    let wire = Node::new("Wire")
        .with("UId", 22)
        .child(Node::new("Powerrail"))
        .child(Node::new("NameCon").with("UId", 21).with("Name", "in"));
    Node::new("FlgNet")
        .with("xmlns", flgnet::NAMESPACE)
        .child(Node::new("Parts").child(Node::new("Part").with("Name", coil).with("UId", 21)))
        .child(Node::new("Wires").child(wire))
}
