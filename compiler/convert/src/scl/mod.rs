//! Sources in SCL, from trees of blocks whose statements, or networks, are SCL.

pub mod expression;
mod statement;

use std::collections::HashSet;

use plcc_diag::Diagnostic;
use plcc_syntax::ast::{Block, Code, CodeBlock, SourceUnit};
use plcc_syntax::network::ast::{Content, Network};
use plcc_syntax::scl::ast::Body;
use plcc_syntax::stl::Mnemonics;

use crate::trivia::Trivia;
use crate::writer::{Notation, Writer};

const LEFT_OUT: &str = "only SCL and ST are written; `--to sd` writes networks, too";
const NEEDED: &str = "the new source does not compile without it: program it in ST; `--to sd` writes LD and FBD, too";

/// What becomes of blocks in other languages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Others {
    /// Each is an error.
    Refused,
    /// They are left out, each with a warning: a project with several languages in one file has no other way to SCL.
    LeftOut,
}

/// Writes a source in SCL. `source`: the text that spans mean, if its constants are those of SCL.
pub fn write(unit: &SourceUnit, trivia: Trivia, source: Option<&str>, others: Others) -> (String, Vec<Diagnostic>) {
    let mut writer = Writer::new(Notation::Scl, Mnemonics::En, trivia, source);
    let is_project = others == Others::LeftOut;
    writer.quotes_words = unit.overlay.is_some() && !is_project;
    let mut starts = HashSet::new();
    let mut left_out = Vec::new();
    for block in &unit.blocks {
        writer.out.gap();
        if is_project {
            // A block that calls a program may have its place, and then no comments of its own.
            let start = block.span().start;
            let is_made = matches!(block, Block::Code(_)) && !starts.insert(start);
            writer.trivia.seek(if is_made { u32::MAX } else { start });
        }
        match block {
            Block::Code(code) => match &code.code {
                Code::Scl(body) => writer.scl_block(code, body),
                Code::Graphic(body) if is_scl(&body.networks) => writer.scl_networks(code, &body.networks),
                Code::Stl(_) | Code::Graphic(_) | Code::Chart(_) if is_project => left_out.push(&code.name),
                Code::Stl(_) | Code::Graphic(_) | Code::Chart(_) => {
                    let title = format!("{} is not in SCL", writer.block_name(&code.name));
                    writer.refuse(code.name.span(), title, "leave it in its language");
                }
            },
            Block::Data(data) => writer.data_block(data),
            Block::Type(ty) => writer.type_block(ty),
        }
    }
    if !is_project {
        writer.remarks_before(u32::MAX);
    }
    let text = std::mem::take(&mut writer.out).into_text();
    for block in left_out {
        let name = writer.block_name(block);
        // Names of blocks are in quotes wherever they are used.
        let (use_of_it, help) = if text.contains(&name) { (", and others use it", NEEDED) } else { ("", LEFT_OUT) };
        writer.warn(block.span(), format!("{name} is not in SCL{use_of_it}"), help);
    }
    (text, writer.messages)
}

/// Whether all networks of a block are in SCL.
fn is_scl(networks: &[Network]) -> bool {
    !networks.is_empty() && networks.iter().all(|network| matches!(network.content, Content::Scl(_)))
}

impl Writer<'_> {
    /// A block of networks in SCL; what they say about themselves becomes comments.
    fn scl_networks(&mut self, block: &CodeBlock, networks: &[Network]) {
        self.code_frame(block, |writer| {
            writer.out.indent();
            for network in networks {
                writer.remarks_before(network.span.start);
                let texts = network.title.iter().chain(&network.comment).flat_map(|text| text.lines());
                texts.for_each(|line| writer.out.line(format!("// {line}")));
                if let Content::Scl(statements) = &network.content {
                    writer.statements(statements);
                }
            }
            writer.remarks_before(block.span.end);
            writer.out.dedent();
        });
    }

    pub(crate) fn scl_block(&mut self, block: &CodeBlock, body: &Body) {
        self.code_frame(block, |writer| {
            writer.out.indent();
            writer.statements(&body.statements);
            writer.remarks_before(block.span.end);
            writer.out.dedent();
        });
    }
}
