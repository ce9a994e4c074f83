//! Ladder-shaped statements as networks of LAD and FBD.
//!
//! - [`drawing`]: signals as contacts in series and parallel, or as gates.
//! - [`redraw`]: networks of LAD in FBD and back.
//! - `statements`: what statements do, network by network; `logic` and `operand` are their parts.
//!
//! Source: LAD/FBD reference, chapter F.3.

pub mod drawing;
mod logic;
mod operand;
pub mod redraw;
mod statements;

use plcc_diag::Diagnostic;
use plcc_syntax::ast::{self, Block, CodeBlock, SourceUnit};
use plcc_syntax::network::ast::{Body, Content, Language, Network};

use crate::to_stl::types::Types;

/// A source whose blocks of STL, LAD and FBD are in `language`; the others stay as they are. With the reason for each network that cannot be drawn.
pub fn unit(unit: &SourceUnit, types: &Types, language: Language) -> (SourceUnit, Vec<Diagnostic>) {
    let mut made = unit.clone();
    let mut messages = Vec::new();
    for block in &mut made.blocks {
        let Block::Code(code) = block else { continue };
        let made = match &code.code {
            ast::Code::Stl(_) => self::block(code, types, language),
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

/// A block of STL in networks.
pub fn block(block: &CodeBlock, types: &Types, language: Language) -> Result<CodeBlock, Vec<Diagnostic>> {
    let ast::Code::Stl(networks) = &block.code else { return Ok(block.clone()) };
    let mut messages = Vec::new();
    let mut body = Body::default();
    for network in networks {
        match self::network(network, block, types, language) {
            Ok(drawn) => body.networks.push(drawn),
            Err(found) => messages.extend(found),
        }
    }
    if !messages.is_empty() {
        return Err(messages);
    }
    Ok(CodeBlock { code: ast::Code::Graphic(body), ..block.clone() })
}

/// A network of STL as contacts and coils, or as gates; or the statements that have no such form.
///
/// `block`: the block that contains it.
pub fn network(
    network: &ast::Network,
    block: &CodeBlock,
    types: &Types,
    language: Language,
) -> Result<Network, Vec<Diagnostic>> {
    let span = network.statements.first().map_or(block.span, |statement| statement.span);
    let (labels, graph) = statements::graph(network, block, types, language, span)?;
    Ok(Network {
        language,
        title: network.title.clone(),
        comment: network.comment.clone(),
        labels,
        content: Content::Graphic(graph),
        span,
    })
}
