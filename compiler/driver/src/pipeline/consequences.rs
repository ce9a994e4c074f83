//! Messages that only follow from others: the user sees the cause alone.

use plcc_diag::{Code, Diagnostic, FileId, SourceMap, Span};
use rustc_hash::FxHashSet;

use crate::inputs::NOT_THERE;

/// How many missing names are looked for in files that could not be read.
const LOOKED_FOR_MAX: usize = 500;

/// Removes messages about elements of networks that could not be bound if an error says why, as one in a declaration does.
pub(super) fn forget_not_connected(diagnostics: &mut Vec<Diagnostic>) {
    let follows = |message: &Diagnostic| {
        message.code == Code::MissingOperand && message.title.ends_with(plcc_program::NOT_CONNECTED)
    };
    if diagnostics.iter().any(|message| message.is_error() && !follows(message)) {
        diagnostics.retain(|message| !follows(message));
    }
}

/// Removes messages about the spelling of the end of another kind of block, such as `END_FB` after FUNCTION: that it cannot end the block
/// is reported with the end that is meant.
pub(super) fn forget_other_ends(diagnostics: &mut Vec<Diagnostic>) {
    let is_end = |message: &&Diagnostic| message.code == Code::BlockFrame && message.title.contains("` cannot end ");
    let ends: FxHashSet<Span> = diagnostics.iter().filter(is_end).map(|message| message.primary.span).collect();
    diagnostics.retain(|message| message.code != Code::MisspeltKeyword || !ends.contains(&message.primary.span));
}

/// Removes messages about names that a file may define which does not exist under the name that the user gave it.
pub(super) fn forget_absent(diagnostics: &mut Vec<Diagnostic>) {
    let is_absent = |message: &Diagnostic| {
        message.code == Code::Unreadable || message.code == Code::Project && message.title.ends_with(NOT_THERE)
    };
    if !diagnostics.iter().any(is_absent) {
        return;
    }
    diagnostics.retain(|message| {
        let is_missing = matches!(message.code, Code::UnknownSymbol | Code::UnknownBlock | Code::UnknownType);
        // A second place is the row of a table, which was read.
        let may_be_there = is_missing && message.secondary.is_empty();
        !may_be_there && !matches!(message.code, Code::DbMissing | Code::NoMainBlock)
    });
}

/// Removes messages about names that a file defines which could not be read: the message for that file says why they are missing.
pub(super) fn forget_lost(diagnostics: &mut Vec<Diagnostic>, sources: &SourceMap) {
    let is_lost =
        |message: &&Diagnostic| message.is_error() && matches!(message.code, Code::ForeignContent | Code::NotASource);
    let lost: FxHashSet<FileId> = diagnostics.iter().filter(is_lost).map(|message| message.primary.span.file).collect();
    if lost.is_empty() {
        return;
    }
    let is_missing = |code| matches!(code, Code::UnknownSymbol | Code::UnknownBlock | Code::UnknownType);
    let mut left = LOOKED_FOR_MAX;
    diagnostics.retain(|message| {
        if !is_missing(message.code) || left == 0 {
            return true;
        }
        left -= 1;
        let span = message.primary.span;
        let name = sources.file(span.file).text.get(span.range()).unwrap_or_default().trim_matches(['#', '"']);
        let defines = |file: &FileId| {
            let text = &sources.file(*file).text;
            // Nothing is known of a workbook that could not be opened.
            *file != span.file && (text.is_empty() || text.contains(name))
        };
        name.is_empty() || !lost.iter().any(defines)
    });
}

/// Removes warnings about what a file lacks where a statement of it could not be read: that may be what is missing.
pub(super) fn forget_doubtful(diagnostics: &mut Vec<Diagnostic>) {
    let is_unread = |message: &&Diagnostic| {
        let codes = [
            Code::Syntax,
            Code::UnknownInstruction,
            Code::MissingOperand,
            Code::OperandKind,
            Code::ForeignForm,
            Code::UnexpectedCharacter,
            Code::BadLiteral,
            Code::LiteralRange,
        ];
        message.is_error() && codes.contains(&message.code)
    };
    let unread: FxHashSet<FileId> =
        diagnostics.iter().filter(is_unread).map(|message| message.primary.span.file).collect();
    let is_doubtful = |code| {
        matches!(
            code,
            Code::UnusedLabel
                | Code::TimerWithoutTime
                | Code::OtherDataBlock
                | Code::UnreachableCode
                | Code::MixedNumbers
        )
    };
    // An element or a pin that is not known may write what seems to be never written.
    let is_unknown = |message: &&Diagnostic| {
        message.is_error() && matches!(message.code, Code::UnknownElement | Code::UnknownParameter)
    };
    let unknown: FxHashSet<FileId> =
        diagnostics.iter().filter(is_unknown).map(|message| message.primary.span.file).collect();
    diagnostics.retain(|message| {
        let file = message.primary.span.file;
        message.code != Code::NeverWritten || !unknown.contains(&file) && !unread.contains(&file)
    });
    // What could not be read may be OB 1, or hide it, as a comment that is not closed does.
    let hides = |message: &Diagnostic| matches!(message.code, Code::UnterminatedText | Code::BlockFrame);
    let is_hidden = !unread.is_empty() || diagnostics.iter().any(hides);
    diagnostics.retain(|message| !(is_hidden && message.code == Code::NoMainBlock));
    diagnostics.retain(|message| !is_doubtful(message.code) || !unread.contains(&message.primary.span.file));
}
