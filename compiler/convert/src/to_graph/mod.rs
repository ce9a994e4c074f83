//! Ladder-shaped statements as networks of LAD and FBD.
//!
//! - [`drawing`]: signals as contacts in series and parallel, or as gates.
//! - [`redraw`]: networks of LAD in FBD and back.
//! - `statements`: what statements do, network by network; `logic` and `operand` are their parts, `boxes` what several statements are.
//! - `coils`: what a flow leads to; `values`: what is loaded, compared and transferred.
//! - `local_data`: addresses that become variables; `branches`: those that are lines of pictures.
//!
//! Source: LAD/FBD reference, chapter F.3.

mod boxes;
mod branches;
mod coils;
pub mod drawing;
mod local_data;
mod logic;
mod operand;
pub mod redraw;
mod statements;
mod values;

pub(crate) use operand::constant;

use plcc_diag::{Diagnostic, Span};
use plcc_syntax::ast::{self, Block, CodeBlock, SourceUnit};
use plcc_syntax::front::Comment;
use plcc_syntax::network::ast::{Body, Content, Graph, Language, Network, PinValue, Source};
use plcc_syntax::scl::ast::{Expr, ExprKind, Name};

use crate::frames::bare;
use crate::to_stl::types::Types;
use statements::Purpose;

/// A source whose blocks of STL, LAD and FBD are in `language`; the others stay as they are. With the reason for each network that cannot be drawn.
pub fn unit(unit: &SourceUnit, types: &Types, language: Language) -> (SourceUnit, Vec<Diagnostic>) {
    let mut made = unit.clone();
    let mut messages = Vec::new();
    for block in &mut made.blocks {
        let Block::Code(code) = block else { continue };
        let made = match &code.code {
            ast::Code::Stl(_) => self::block(code, types, language, &mut messages),
            ast::Code::Graphic(_) => redraw::block(code, language),
            ast::Code::Scl(_) | ast::Code::Chart(_) => continue,
        };
        match made {
            Ok(done) => *code = done,
            Err(found) => messages.extend(found),
        }
    }
    (made, messages)
}

/// A block of STL in networks. `notes` get what is not quite the same.
pub fn block(
    block: &CodeBlock,
    types: &Types,
    language: Language,
    notes: &mut Vec<Diagnostic>,
) -> Result<CodeBlock, Vec<Diagnostic>> {
    let named = local_data::named(block)?;
    let block = named.as_ref().unwrap_or(block);
    let ast::Code::Stl(networks) = &block.code else { return Ok(block.clone()) };
    let mut messages = Vec::new();
    let mut body = Body::default();
    let jumps = statements::jumps(networks);
    let mut is_saved = false;
    for network in networks {
        let span = start(network, block);
        match statements::graph(network, (block, &jumps), types, language, (span, Purpose::Conversion { is_saved })) {
            Ok(drawn) => {
                is_saved = drawn.is_saved;
                notes.extend(drawn.notes);
                messages.extend(of_open_instance(&drawn.graph, language));
                body.networks.push(made(network, language, drawn.labels, drawn.graph, span));
            }
            Err(found) => messages.extend(found),
        }
    }
    if !messages.is_empty() {
        return Err(messages);
    }
    Ok(CodeBlock { code: ast::Code::Graphic(body), ..block.clone() })
}

/// The first address in the open instance data block, `DIW 0`, which pictures show and files of networks do not have.
fn of_open_instance(graph: &Graph, language: Language) -> Option<Diagnostic> {
    let is_such =
        |value: &Expr| matches!(value.kind, ExprKind::Absolute(ast::OperandKind::Absolute { area: ast::Area::Di, .. }));
    let pins = graph.elements.iter().flat_map(|element| &element.pins).filter_map(|pin| match &pin.value {
        PinValue::Operand(value) => Some((value, pin.span)),
        PinValue::Net(_) | PinValue::Open => None,
    });
    let sources = graph.nets.iter().flat_map(|net| &net.sources).filter_map(|source| match source {
        Source::Operand { value, .. } => Some((value, value.span)),
        Source::Rail | Source::Pin { .. } | Source::Net(_) => None,
    });
    let (_, span) = pins.chain(sources).find(|(value, _)| is_such(value))?;
    Some(statements::refusal(span, "an address in the open instance data block", language))
}

/// The comments of a source that are not those of its networks, which the tree has.
pub fn other_comments(unit: &SourceUnit, source: &str, comments: Vec<Comment>) -> Vec<Comment> {
    let mut is_other = vec![true; comments.len()];
    for block in &unit.blocks {
        let Block::Code(CodeBlock { code: ast::Code::Stl(networks), span, .. }) = block else { continue };
        let mut from = span.start;
        for network in networks {
            let (Some(first), Some(last)) = (network.statements.first(), network.statements.last()) else { continue };
            let mut own = network.comment.iter().peekable();
            let start = comments.partition_point(|comment| comment.start < from);
            let before = comments[start..].iter().take_while(|comment| comment.start < first.span.start);
            for (at, comment) in before.enumerate() {
                let text = bare(source.get(comment.range()).unwrap_or_default());
                if own.next_if(|line| **line == text).is_some() {
                    is_other[start + at] = false;
                }
            }
            from = last.span.end;
        }
    }
    comments.into_iter().zip(is_other).filter_map(|(comment, is_other)| is_other.then_some(comment)).collect()
}

/// A network of STL for a picture.
pub struct Picture {
    /// As LAD; or the reason why it cannot be drawn.
    pub network: Result<Network, Diagnostic>,
    /// Bits of local data are lines. Else they are coils and contacts, as where another network reads them.
    pub branches: bool,
}

/// The networks of a block of STL for pictures. Types that are not known do not matter.
pub fn pictures(block: &CodeBlock, types: &Types) -> Vec<Picture> {
    let ast::Code::Stl(networks) = &block.code else { return Vec::new() };
    let jumps = statements::jumps(networks);
    let mut pictures = Vec::with_capacity(networks.len());
    for (network, branches) in networks.iter().zip(branches::are_lines(networks)) {
        let span = start(network, block);
        let draw = |branches: bool| {
            let purpose = Purpose::Picture { branches };
            statements::graph(network, (block, &jumps), types, Language::Lad, (span, purpose))
        };
        let drawn = match branches {
            true => draw(true).or_else(|_| draw(false)),
            false => draw(false),
        };
        let network = match drawn {
            Ok(drawn) => Ok(made(network, Language::Lad, drawn.labels, drawn.graph, span)),
            Err(mut messages) => Err(messages.remove(0)),
        };
        pictures.push(Picture { network, branches });
    }
    pictures
}

/// The place of a network.
fn start(network: &ast::Network, block: &CodeBlock) -> Span {
    network.statements.first().map_or(block.span, |statement| statement.span)
}

fn made(network: &ast::Network, language: Language, labels: Vec<Name>, graph: Graph, span: Span) -> Network {
    Network {
        language,
        title: network.title.clone(),
        comment: network.comment.clone(),
        labels,
        content: Content::Graphic(graph),
        span,
    }
}
