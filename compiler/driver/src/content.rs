//! What a file is. Its content tells, never its name.

use plcc_program::symbols;
use plcc_syntax::s7200;
use plcc_syntax::stl::{Mnemonics, StlInsn};
use plcc_syntax::xml::{self, XmlKind};

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// A source in STL of any family, SCL or GRAPH, or an export of blocks in XML.
    Source,
    SymbolTable,
    /// An export that holds both.
    SourceAndTable,
    /// Text that does not look like any of them.
    Prose,
    /// Not for us; what it is instead.
    Other(&'static str),
}

/// Words that begin a line of a source and are no mnemonics.
const FRAME_WORDS: [&str; 22] = [
    "ORGANIZATION_BLOCK",
    "SUBROUTINE_BLOCK",
    "INTERRUPT_BLOCK",
    "FUNCTION",
    "FUNCTION_BLOCK",
    "DATA_BLOCK",
    "TYPE",
    "NETWORK",
    "TITLE",
    "VAR",
    "VAR_INPUT",
    "VAR_OUTPUT",
    "VAR_IN_OUT",
    "VAR_TEMP",
    "STRUCT",
    "BEGIN",
    "CALL",
    "SYSTEM_FUNCTION",
    "SYSTEM_FUNCTION_BLOCK",
    "INITIAL_STEP",
    "END_STEP",
    "END_TRANSITION",
];

/// Tells what `text` is.
pub fn of(text: &str) -> Content {
    if text.chars().take(4096).any(|c| c.is_control() && !matches!(c, '\t' | '\n' | '\r' | '\x0c' | '\x1a')) {
        return Content::Other("binary data");
    }
    if let Some(kind) = xml::kind(text) {
        return of_xml(kind, text);
    }
    if symbols::is_symbol_table(text) {
        return Content::SymbolTable;
    }
    let lines = || text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with("//"));
    match lines().next() {
        None => return Content::Source,
        Some(line) if line.starts_with("%PDF") => return Content::Other("a PDF document"),
        Some(line) if line.starts_with("cycle,time_ms,") => return Content::Other("a trace"),
        Some(_) => {}
    }
    if s7200::is_s7200(text)
        || lines().any(|line| begins_like_stl(line) || is_assignment(line))
        || lines().all(|line| line.split_whitespace().count() <= 4)
    {
        Content::Source
    } else {
        Content::Prose
    }
}

/// What a file in XML is, by its objects.
fn of_xml(kind: XmlKind, text: &str) -> Content {
    match kind {
        XmlKind::SimaticMl(contents) => match (contents.blocks, contents.tags, contents.other.as_deref()) {
            (true, true, _) => Content::SourceAndTable,
            (true, false, _) => Content::Source,
            (false, true, _) => Content::SymbolTable,
            // The parser says best what is missing.
            (false, false, Some(name)) if xml::is_fragment(name) => Content::Source,
            (false, false, Some(name)) if name.starts_with("SW.WatchAndForceTables.") => {
                Content::Other("a watch or force table")
            }
            (false, false, Some(name)) if name.starts_with("SW.TechnologicalObjects.") => {
                Content::Other("a technology object")
            }
            (false, false, Some(_)) => {
                Content::Other("an export of the TIA Portal without blocks, data types and tags")
            }
            (false, false, None) => Content::Other("an empty export of the TIA Portal"),
        },
        XmlKind::PlcOpen => Content::SourceAndTable,
        XmlKind::TagTable => Content::SymbolTable,
        XmlKind::Other(root) if xml::is_fragment(&root) => Content::Source,
        XmlKind::Other(root) if root == "CAEXFile" => Content::Other("a hardware configuration (AML)"),
        XmlKind::Other(_) => Content::Other("XML that is no export of blocks"),
        // The parser says best what is wrong with a block that was cut off.
        XmlKind::Broken if text.contains("<SW.") => Content::Source,
        XmlKind::Broken => Content::Prose,
    }
}

/// The line begins with a mnemonic, with a label and a mnemonic, or with a word of a block frame.
fn begins_like_stl(line: &str) -> bool {
    let line = match line.split_once(':') {
        Some((label, rest)) if !rest.starts_with('=') && label.chars().all(|c| c.is_alphanumeric() || c == '_') => rest,
        _ => line,
    };
    let word = line.trim_start().split([' ', '\t', ';', ',']).next().unwrap_or_default();
    let words = line.split_whitespace().count();
    FRAME_WORDS.iter().any(|frame| frame.eq_ignore_ascii_case(word))
        // Prose can begin with `A` or `O`, so that a statement must be short too.
        || words <= 4 && is_mnemonic(word)
}

/// `name := value;`
fn is_assignment(line: &str) -> bool {
    let code = line.split("//").next().unwrap_or_default().trim_end();
    code.ends_with(';') && code.contains(":=")
}

fn is_mnemonic(word: &str) -> bool {
    let is = |set| move |insn: &&StlInsn| insn.mnemonic(set).eq_ignore_ascii_case(word);
    StlInsn::ALL.iter().any(|insn| is(Mnemonics::En)(&insn) || is(Mnemonics::De)(&insn)) || s7200::is_mnemonic(word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tells_sources_from_other_files() {
        for text in [
            "",
            "// nothing yet\n",
            "A I 0.0\n= Q 4.0",
            "      U     E 0.0;\n",
            "m1:   NOP 0\n",
            "FUNCTION FC 1 : VOID\nBEGIN\nEND_FUNCTION\n",
            "\n\nDATA_BLOCK \"Tank data\"\n",
            "LD I0.0\n",
            "Network 1 // a title of several words\nLDW>=  VW2, 4\nTON    T37, +50 // a comment of several words\n",
            "LD\tI0.0\nA\tI0.1\n=\tQ0.0\n",
            "VB0    10, 16#1F, 'A', 5, 6, 7 // a data block\nVW10   -5, 300, 301, 302, 303\n",
            "(*$_COM A chart that was cut out of its block, with a long comment*)\nINITIAL_STEP Off (*$_NUM 1*):\nEND_STEP\n",
            "IF #level > 5.0 AND #filling AND NOT #fault THEN\n  #valve := FALSE; // closed\nEND_IF;\n",
        ] {
            assert_eq!(of(text), Content::Source, "{text:?}");
        }
        assert_eq!(of("%PDF-1.4\n1 0 obj\n"), Content::Other("a PDF document"));
        assert_eq!(of("<?xml version=\"1.0\"?>\n<Document/>"), Content::Other("XML that is no export of blocks"));
        assert_eq!(of("<Document><SW.Blocks.FC ID=\"0\"/></Document>"), Content::Source);
        assert_eq!(of("<Document><SW.Tags.PlcTagTable ID=\"0\"/></Document>"), Content::SymbolTable);
        assert_eq!(of("<Tagtable name='t'><Tag addr='%I0.0'>a</Tag></Tagtable>"), Content::SymbolTable);
        assert_eq!(of("<FlgNet/>"), Content::Source);
        assert_eq!(of("<SW.Blocks.CompileUnit ID='1'/>"), Content::Source);
        assert_eq!(of("<CAEXFile/>"), Content::Other("a hardware configuration (AML)"));
        assert_eq!(of("<project><types/></project>"), Content::SourceAndTable);
        assert_eq!(of("cycle,time_ms,I0.0\n0,0,0\n"), Content::Other("a trace"));
        assert_eq!(of("Motor\tQ0.0\tthe pump\nLevel\tVW100\t\n"), Content::SymbolTable);
        assert_eq!(of("A\0B"), Content::Other("binary data"));
        assert_eq!(of("If the tank is full then the valve is closed by hand.\n"), Content::Prose);
        assert_eq!(of("# Tank\n\nA program that fills a tank when the level is low.\n"), Content::Prose);
    }
}
