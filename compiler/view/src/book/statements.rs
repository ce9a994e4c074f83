//! Networks of statements: drawn as LAD where they are rungs or boxes, else as text.

use std::collections::HashMap;

use plcc_convert::to_graph::Picture;
use plcc_diag::Span;
use plcc_model::Direction;
use plcc_syntax::ast;
use plcc_syntax::network::ast::{Content, Network, Target};
use plcc_syntax::network::draw;
use plcc_syntax::scl::ast::Expr;

use super::{Body, Maker, Section};
use crate::names::Scope;
use crate::sheet::Sheet;
use crate::{ladder, listing, sheet};

impl Maker<'_> {
    /// `picture`: the network as LAD, with boxes of several statements.
    pub(super) fn stl(&self, number: usize, network: &ast::Network, picture: Picture, scope: Scope) -> Section {
        let label = |operand: &ast::Operand| self.names.label(&self.words(operand.span), scope);
        let is_output = |block: &str, formal: &str| match self.names.block_of_instance(block, scope) {
            Some(of) => self.is_output(&of, formal),
            None => self.is_output(block, formal),
        };
        let rungs = sheet::stl::sheet(&network.statements, &label, &is_output, picture.branches).map(|mut rungs| {
            rungs.name_instances(self.names, scope);
            rungs.complete_calls(self.names);
            rungs
        });
        let drawn = match picture.network {
            Ok(picture) => {
                let is_better = rungs.is_err() || sheet::network::has_cells(&picture);
                let has_bits = rungs.as_ref().is_ok_and(sheet::stl::has_local_bits);
                match is_better || has_bits {
                    true => self
                        .boxes(&network.statements, picture, scope)
                        .filter(|boxes| is_better || !sheet::stl::has_local_bits(boxes))
                        .ok_or(String::new())
                        .or(rungs),
                    false => rungs,
                }
            }
            Err(_) => rungs,
        };
        // A network that is shown as text has its labels before their statements.
        let label = network.statements.first().and_then(|first| first.label.as_ref()).filter(|_| drawn.is_ok());
        let spans = network.statements.iter().map(|statement| statement.span);
        Section {
            number,
            title: network.title.clone().unwrap_or_default(),
            comment: network.comment.clone(),
            labels: label.map(|label| label.name.clone()).into_iter().collect(),
            ..self.rungs(drawn, spans)
        }
    }

    /// The sheet of a network that is made of statements, if it has elements.
    fn boxes(&self, statements: &[ast::Statement], picture: Network, scope: Scope) -> Option<Sheet> {
        let Content::Graphic(mut graph) = picture.content else { return None };
        let spans: HashMap<u32, Span> = statements
            .iter()
            .flat_map(sheet::stl::operands)
            .map(|operand| (operand.span.start, operand.span))
            .collect();
        let words = |value: &Expr| spans.get(&value.span.start).map_or(draw::whole(value), |span| self.words(*span));
        for element in &mut graph.elements {
            if let Target::Block { callee, .. } = &element.target {
                let block = words(callee);
                let block = self.names.block_of_instance(&block, scope).unwrap_or(block);
                for pin in &mut element.pins {
                    pin.output |= pin.name != "en" && self.is_output(&block, &pin.name);
                }
            }
        }
        let label = |value: &Expr| self.names.label(&words(value), scope);
        let is_empty = graph.elements.is_empty();
        (!is_empty).then(|| sheet::network::sheet_of_statements(&graph, self.names, scope, &label))
    }

    /// The ladder of a network in STL, or its text and why it is not a ladder.
    pub(super) fn rungs(&self, drawn: Result<Sheet, String>, spans: impl Iterator<Item = Span>) -> Section {
        match drawn {
            Ok(mut sheet) => {
                if let Some(values) = self.options.values {
                    sheet.show(&|key| values.get(key).cloned());
                }
                let scene = ladder::draw(&mut sheet, self.options.width);
                let code = self.options.is_live.then(|| self.listing(spans, listing::Kind::Stl));
                Section { content: Body::Drawing { scene, sheet }, code, ..Section::default() }
            }
            Err(reason) => {
                let text = self.listing(spans, listing::Kind::Stl);
                let reason = if reason.is_empty() { reason } else { format!("Not shown as LAD: {reason}.") };
                Section { reason, content: Body::Text(text), ..Section::default() }
            }
        }
    }

    /// Whether the parameter of a block is an output.
    fn is_output(&self, block: &str, formal: &str) -> bool {
        let name = block.trim_matches('"');
        let same = |known: &&plcc_model::CodeBlock| {
            known.name.eq_ignore_ascii_case(name)
                || known.key().to_string().replace(' ', "").eq_ignore_ascii_case(&name.replace(' ', ""))
        };
        let found = self.program.and_then(|program| program.blocks.iter().find(same));
        found.is_some_and(|block| {
            let mut parameters = block.interface.parameters.iter();
            parameters.any(|known| known.direction == Direction::Output && known.name.eq_ignore_ascii_case(formal))
        })
    }
}
