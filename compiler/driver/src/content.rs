//! What a file is. Its content decides. For a file that plcc found in a folder, the name may show that it is not a source.

use std::path::Path;

use plcc_readers::symbols;
use plcc_readers::xml::{self, XmlKind};
use plcc_syntax::s7200;
use plcc_syntax::stl::{Mnemonics, StlInsn};

use foreign::Foreign;
use lines::Signs;

pub mod foreign;
mod lines;

/// What a file contains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// A source in STL of any family, SCL or GRAPH, or an export of blocks in XML.
    Source,
    SymbolTable,
    /// An export that holds both.
    SourceAndTable,
    /// Text that looks like none of these.
    Prose,
    /// A program of another tool: which tool, and what to do.
    Program(&'static str),
    /// Not for plcc; what it is instead.
    Other(&'static str),
    /// A document, a picture or an empty file, which plcc is not expected to read.
    Nothing,
}

/// Words that begin a line of a source but are not mnemonics.
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

const TECHNOLOGY_OBJECT: &str =
    "a technology object: describe an axis in plc.toml, and write other objects as data blocks of their type";

/// Finds out what `text` is.
pub fn of(text: &str) -> Content {
    if is_binary(text) {
        return Content::Other("binary data");
    }
    if let Some(kind) = xml::kind(text) {
        return of_xml(kind, text);
    }
    if let Some(what) = foreign::of_marks(text) {
        return Content::Program(what);
    }
    if symbols::is_symbol_table(text) {
        return Content::SymbolTable;
    }
    let lines = || text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with("//"));
    match lines().next() {
        None => return Content::Source,
        Some(line) if line.starts_with("%PDF") => return Content::Other("a PDF document"),
        Some(line) if line.starts_with("cycle,time_ms,") => return Content::Other("a trace"),
        Some(line) if line.starts_with("solid") && text.contains("facet normal") => {
            return Content::Other("a model in three dimensions");
        }
        Some(line) if line.starts_with("FILEVERSION") => return Content::Other("a hardware configuration of STEP 7"),
        Some(_) => {}
    }
    // What most sources show with their first lines comes first.
    if lines().any(|line| begins_like_stl(line) || is_assignment(line))
        || s7200::is_s7200(text)
        || lines().all(|line| line.split_whitespace().count() <= 4)
    {
        Content::Source
    } else {
        Content::Prose
    }
}

/// Finds out what the file `path` in a folder is. The user did not name it, so it must look clearly like a source.
/// `is_source`: its extension is that of a source.
pub fn in_folder(path: &Path, text: &str, is_source: bool) -> Content {
    if is_output(path, text) {
        return Content::Nothing;
    }
    match foreign::of_name(path) {
        Some(Foreign::Program(what)) => return Content::Program(what),
        Some(Foreign::Other(what)) => return Content::Other(what),
        Some(Foreign::Document) => {
            let has_code = !is_binary(text) && xml::kind(text).is_none() && Signs::of(text).has_code();
            return if has_code { Content::Other("a document with PLC code") } else { Content::Nothing };
        }
        None => {}
    }
    let content = of(text);
    if xml::kind(text).is_some() {
        return content;
    }
    match content {
        Content::Source | Content::Prose if is_source => Content::Source,
        Content::Source | Content::Prose if text.trim().is_empty() => Content::Nothing,
        Content::Source | Content::Prose if is_table_in_no_form(path, text) => Content::SymbolTable,
        // A data block of Micro/WIN may have symbols and values only.
        Content::Source | Content::Prose
            if path.extension().is_some_and(|own| own.eq_ignore_ascii_case("db")) && s7200::is_s7200(text) =>
        {
            Content::Source
        }
        Content::Source | Content::Prose => {
            let signs = Signs::of(text);
            if signs.is_source() {
                Content::Source
            } else if signs.has_code() {
                Content::Other("text with some PLC code")
            } else {
                Content::Prose
            }
        }
        // Any list of texts in quotes has the form of a table.
        Content::SymbolTable
            if text.trim_start().starts_with('"') && !is_table_by_name(path) && !has_addresses(text) =>
        {
            Content::Other("a table without addresses")
        }
        content => content,
    }
}

/// What plcc itself and its programs write next to the sources: executables, traces, coverage, container images, retentive memory, recordings,
/// units of a co-simulation, certificates and keys.
fn is_output(path: &Path, text: &str) -> bool {
    const STARTS: [&str; 8] =
        ["\u{7f}ELF", "cycle,time_ms,", "$timescale", "TN:\nSF:", "oci-layout\0", "PLCRET", "PLCCREC", "-----BEGIN "];
    let is_named = |suffix: &str| path.extension().is_some_and(|own| own.eq_ignore_ascii_case(suffix));
    STARTS.iter().any(|start| text.starts_with(start))
        || is_named("fmu") && text.starts_with("PK\u{3}\u{4}")
        || is_named("der") && is_binary(text)
}

/// A table whose form is wrong: its reader says how.
pub fn is_table_in_no_form(path: &Path, text: &str) -> bool {
    is_table_by_name(path) && symbols::has_rows(text)
}

/// Named as STEP 7 names the tables that it exports.
fn is_table_by_name(path: &Path) -> bool {
    let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
    extension.is_some_and(|extension| ["sdf", "asc", "dif", "seq"].iter().any(|known| extension == *known))
}

fn has_addresses(text: &str) -> bool {
    let separators = [',', ';', '\t'];
    let fields = |line: &str| line.split(separators).map(|field| field.trim().trim_matches('"').to_string()).nth(1);
    text.lines().filter_map(fields).any(|field| {
        plcc_syntax::symbols::parse_address(&field).is_some()
            || s7200::parse_address(&field).is_some()
            || s7200::parse_block(&field).is_some()
    })
}

fn is_binary(text: &str) -> bool {
    text.chars().take(4096).any(|c| c.is_control() && !matches!(c, '\t' | '\n' | '\r' | '\x0c' | '\x1a'))
}

/// Finds out what an XML file is, from its objects.
fn of_xml(kind: XmlKind, text: &str) -> Content {
    match kind {
        XmlKind::SimaticMl(contents) => match (contents.blocks, contents.tags, contents.other.as_deref()) {
            (true, true, _) => Content::SourceAndTable,
            (true, false, _) => Content::Source,
            (false, true, _) => Content::SymbolTable,
            // The parser reports best what is missing.
            (false, false, Some(name)) if xml::is_fragment(name) || xml::nearest_object(name).is_some() => {
                Content::Source
            }
            (false, false, Some(name)) if name.starts_with("SW.WatchAndForceTables.") => {
                Content::Other("a watch or force table")
            }
            (false, false, Some(name)) if name.starts_with("SW.TechnologicalObjects.") => {
                Content::Other(TECHNOLOGY_OBJECT)
            }
            (false, false, Some(_)) => {
                Content::Other("an export of the TIA Portal without blocks, data types and tags")
            }
            (false, false, None) => Content::Other("an empty export of the TIA Portal"),
        },
        XmlKind::PlcOpen => Content::SourceAndTable,
        XmlKind::TagTable => Content::SymbolTable,
        XmlKind::Other(root) if xml::is_fragment(&root) => Content::Source,
        XmlKind::Other(root) => match foreign::of_root(&root) {
            Some(Foreign::Program(what)) => Content::Program(what),
            Some(Foreign::Other(what)) => Content::Other(what),
            Some(Foreign::Document) | None => Content::Other("XML that is not an export of blocks"),
        },
        // The parser reports best what is wrong with an incomplete block.
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
        // Prose can begin with `A` or `O`, so a statement must also be short.
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
        assert_eq!(of("<?xml version=\"1.0\"?>\n<Document/>"), Content::Other("XML that is not an export of blocks"));
        assert_eq!(of("<Document><SW.Blocks.FC ID=\"0\"/></Document>"), Content::Source);
        assert_eq!(of("<Document><SW.Tags.PlcTagTable ID=\"0\"/></Document>"), Content::SymbolTable);
        assert_eq!(of("<Document><SW.ControllerTagTable ID=\"0\"/></Document>"), Content::SymbolTable);
        let object = "<Document><SW.TechnologicalObjects.TechnologicalInstanceDB ID=\"0\"/></Document>";
        assert_eq!(of(object), Content::Other(TECHNOLOGY_OBJECT));
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

    /// Files in folders, which the user did not name.
    #[test]
    fn files_of_folders_must_look_like_sources() {
        let of = |name: &str, text: &str| in_folder(Path::new(name), text, false);
        for (name, output) in [
            ("blink", "\u{7f}ELF\u{2}\u{1}\0"),
            ("blink.csv", "cycle,time_ms,I0.0\n0,0,0\n"),
            ("blink.vcd", "$timescale 1 us $end\n"),
            ("lcov.info", "TN:\nSF:./main.scl\nFN:68,OB1 Main\n"),
            ("blink.tar", "oci-layout\0\0\0"),
            ("blink.fmu", "PK\u{3}\u{4}\u{14}\0"),
            ("blink.retain", "PLCRET2\n\u{10}\0\0"),
            ("plant.rec", "PLCCREC\u{2}\u{18}\0"),
            ("key.pem", "-----BEGIN PRIVATE KEY-----\nMIIEvgIBADANBgkq\n-----END PRIVATE KEY-----\n"),
            ("own.der", "0\u{201A}\u{3},0\u{201A}\u{2}"),
        ] {
            assert_eq!(of(name, output), Content::Nothing, "{name}");
        }
        assert_eq!(of("other.tar", "ustar\0"), Content::Other("an archive: unpack it"));
        for (name, text) in [
            ("main", "A I 0.0\n= Q 4.0\n"),
            ("main.txt", "      U     E 0.0;\n      S     M 3.1;\n"),
            ("fc.src", "FUNCTION FC 1 : VOID\nTITLE =The tank is filled when the level is low\nBEGIN\nEND_FUNCTION\n"),
            ("db.db", "DATA_BLOCK \"Tank data\"\nSTRUCT\n  a : INT;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n"),
            (
                "tank.st",
                "FUNCTION_BLOCK Tank\nVAR_INPUT\n  level : REAL;\nEND_VAR\nlevel := 1.0;\nEND_FUNCTION_BLOCK\n",
            ),
            ("s7200.txt", "Network 1 // a title of several words\nLDW>=  VW2, 4\nTON    T37, +50 // some words\n"),
        ] {
            assert_eq!(of(name, text), Content::Source, "{name}");
        }
        for (name, text) in [
            ("README.md", "A tank\n"),
            ("README", "Set\n"),
            ("LICENSE", "MIT\n"),
            ("empty.txt", "\n"),
            ("__init__", ""),
        ] {
            assert_eq!(of(name, text), Content::Nothing, "{name}");
        }
        assert_eq!(of("guide.md", "# Use\n```\nA I 0.0\n= Q 4.0\n```\n"), Content::Other("a document with PLC code"));
        for (name, text) in [
            ("about.txt", "Water tank\n"),
            ("about.txt", "S7-1200\n"),
            ("list", "Set\nA pump\nL valve\n"),
            ("main", "int main(void) {\n  x = 1;\n  return 0;\n}\n"),
            ("data.csv", "\"name\",\"age\",\"town\"\n\"a\",\"3\",\"b\"\n"),
            ("data.csv", "a,b,c\n1,2,3\n"),
            ("x.c", "int a;\n"),
            ("x.py", "x = 1\n"),
            ("x.json", "{}\n"),
            ("x.yml", "a: 1\n"),
            ("x.TcPOU", "<TcPlcObject/>"),
            ("pom.xml", "<project><modelVersion>4</modelVersion></project>"),
            ("x.xml", "<TcPlcObject/>"),
        ] {
            assert!(
                matches!(of(name, text), Content::Prose | Content::Other(_) | Content::Program(_)),
                "{name}: {:?}",
                of(name, text)
            );
        }
        assert!(matches!(of("t.csv", "\"Start\",\"I 0.0\",\"BOOL\",\"\"\n"), Content::SymbolTable));
        let quoted = "\"Symbol\"\t\"Adresse\"\t\"Kommentar\"\n\"Start\"\t\"E0.0\"\t\"\"\n\"Level\"\t\"VW100\"\t\"\"\n";
        assert!(matches!(of("t.txt", quoted), Content::SymbolTable));
    }
}
