//! Blocks of the library: each binds, and says what it does and where that is from.

use plcc_diag::{SourceFile, SourceMap, Span};
use plcc_stdlib::Form;

use super::bind_text;
use crate::bind::declarations::Declarations;
use crate::bind::declarations::shipped::empty;
use crate::bind::program::bind_system_blocks;

/// Each block of the library, in any language, binds without a message, and so do the blocks that it uses.
#[test]
fn every_block_binds() {
    for block in plcc_stdlib::blocks().iter().filter(|block| block.form != Form::NotShipped) {
        let mut sources = SourceMap::default();
        let file = sources.add(SourceFile::new("", ""));
        let input = empty(&sources);
        let mut program = Declarations::new(&input);
        let key = program.globals.library.key_of(block);
        assert!(program.interface(key, Span { file, start: 0, end: 0 }).is_some(), "{}", block.name);
        let mut bound = Vec::new();
        bind_system_blocks(&mut program, &mut bound);
        let (messages, _) = program.globals.report.finish();
        assert!(messages.is_empty(), "{}: {messages:#?}", block.name);
        assert!(bound.iter().any(|other| other.key() == key), "{}", block.name);
    }
}

#[test]
fn every_block_is_described() {
    for block in plcc_stdlib::blocks().iter().filter(|block| block.form != Form::NotShipped) {
        assert!(!block.comment.is_empty(), "{} has no comment above it", block.name);
        assert!(!block.origin.is_empty(), "the file of {} does not name a source", block.name);
    }
}

/// Its number alone does not say that a block with another symbol is one of the library.
#[test]
fn a_renamed_block_is_told_its_name_in_the_library() {
    let source = "ORGANIZATION_BLOCK OB 1\nBEGIN\n  CALL \"Scaling\" (IN := MW 10);\nEND_ORGANIZATION_BLOCK\n";
    let (_, messages) = bind_text(source, "\"Scaling\",\"FC  105\",\"FC  105\",\"\"\n", false);
    let help = "add the source that defines it; if it is `SCALE` of the library, name it `SCALE` in the symbol table";
    assert_eq!(messages.iter().map(|message| message.help.as_deref()).collect::<Vec<_>>(), [Some(help)]);
}
