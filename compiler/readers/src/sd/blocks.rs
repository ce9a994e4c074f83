//! The syntax tree of a document: its blocks with their declarations, as SCL reads them, and their networks.

use plcc_diag::{Diagnostic, FileId};

use super::frame::{Document, Frame};
use super::network::{self, Source};
use super::texts;
use crate::ReadOptions;
use plcc_syntax::ast::{Block, Code as BlockCode, DataContent, Header, SourceUnit, TypeKind, Variable};
use plcc_syntax::network::ast::{Body, Content, Language, Network};
use plcc_syntax::scl::ast::{Statement, StatementKind};
use plcc_syntax::scl::fragment;

/// Builds the tree.
pub fn build(
    file: FileId,
    text: &str,
    document: Document,
    options: &ReadOptions,
    diagnostics: &mut Vec<Diagnostic>,
) -> SourceUnit {
    let Document { tokens, declarations, blocks: frames, comments, members } = document;
    let (mut blocks, pragmas, messages) = fragment::blocks(file, text, &declarations, options.pragmas);
    diagnostics.extend(messages);
    let mut texts = texts::Lookup::new(options.texts);
    for block in &mut blocks {
        let start = block.span().start;
        let Some(frame) = frames.iter().find(|frame| frame.start == start) else { continue };
        complete_header(block, frame, &mut texts, diagnostics);
        each_variable(block, &mut |variable| {
            let Some(attributes) = members.get(&variable.name_span.start) else { return };
            for attribute in attributes {
                if attribute.is("S7_MLC") {
                    variable.comment = texts.find(attribute, diagnostics);
                } else {
                    variable.attributes.push((attribute.key.clone(), attribute.value.clone()));
                }
            }
        });
        if let Block::Code(block) = block {
            let statements = match std::mem::replace(&mut block.code, BlockCode::Graphic(Body::default())) {
                BlockCode::Scl(body) => body.statements,
                BlockCode::Stl(_) | BlockCode::Graphic(_) | BlockCode::Chart(_) => Vec::new(),
            };
            let source = Source { file, text, tokens: &tokens, comments: &comments, pragmas: options.pragmas };
            let mut networks: Vec<Network> = frame
                .networks
                .iter()
                .map(|network| network::read(&source, frame, network, &mut texts, diagnostics))
                .collect();
            insert_pragmas(&mut networks, statements);
            block.code = BlockCode::Graphic(Body { networks });
        }
    }
    SourceUnit { mnemonics: options.mnemonics.unwrap_or_default(), blocks, pragmas, ..SourceUnit::default() }
}

/// Attributes, title and comment of a block.
fn complete_header(block: &mut Block, frame: &Frame, texts: &mut texts::Lookup, diagnostics: &mut Vec<Diagnostic>) {
    let header: &mut Header = match block {
        Block::Code(block) => &mut block.header,
        Block::Data(block) => &mut block.header,
        Block::Type(block) => &mut block.header,
    };
    for attribute in &frame.attributes {
        let value = || Some(attribute.value.clone()).filter(|value| !value.is_empty());
        match () {
            () if attribute.is("S7_BlockTitle") => header.title = texts.find(attribute, diagnostics),
            () if attribute.is("S7_BlockComment") => {
                header.comment.extend(texts.find(attribute, diagnostics).iter().flat_map(|text| lines(text)));
            }
            () if attribute.is("S7_Author") => header.author = value(),
            () if attribute.is("S7_Family") => header.family = value(),
            () if attribute.is("S7_HeaderName") => header.name = value(),
            () if attribute.is("S7_Version") => header.version = value(),
            // Without a number, the project chooses one.
            () if attribute.is("S7_BlockNumber") && matches!(attribute.value.as_str(), "" | "0") => {}
            () => {
                header.attributes.push((attribute.key.clone(), attribute.value.clone()));
            }
        }
    }
}

/// The lines of a text.
pub fn lines(text: &str) -> Vec<String> {
    text.lines().map(|line| line.trim_end().to_owned()).collect()
}

/// Calls `visit` for each variable that a block declares, including members of structures.
fn each_variable(block: &mut Block, visit: &mut impl FnMut(&mut Variable)) {
    match block {
        Block::Code(block) => {
            for section in &mut block.sections {
                section.variables.iter_mut().for_each(|variable| with_members(variable, visit));
            }
        }
        Block::Data(block) => {
            if let DataContent::Struct(members) = &mut block.content {
                members.iter_mut().for_each(|variable| with_members(variable, visit));
            }
        }
        Block::Type(block) => block.members.iter_mut().for_each(|variable| with_members(variable, visit)),
    }
}

fn with_members(variable: &mut Variable, visit: &mut impl FnMut(&mut Variable)) {
    visit(variable);
    let mut kind = &mut variable.ty.kind;
    while let TypeKind::Array { element, .. } = kind {
        kind = &mut element.kind;
    }
    if let TypeKind::Struct(members) = kind {
        members.iter_mut().for_each(|member| with_members(member, visit));
    }
}

/// Assertions between networks are separate networks.
fn insert_pragmas(networks: &mut Vec<Network>, statements: Vec<Statement>) {
    for statement in statements {
        if !matches!(statement.kind, StatementKind::Pragma(_)) {
            continue;
        }
        let at = networks.partition_point(|network| network.span.start < statement.span.start);
        if let Some(before) = at.checked_sub(1).and_then(|before| networks.get_mut(before))
            && let Content::Scl(statements) = &mut before.content
            && statements.first().is_some_and(|first| first.span.start == before.span.start)
        {
            statements.push(statement);
            continue;
        }
        let span = statement.span;
        let network = Network {
            language: Language::Scl,
            title: None,
            comment: Vec::new(),
            labels: Vec::new(),
            content: Content::Scl(vec![statement]),
            span,
        };
        networks.insert(at, network);
    }
}
