//! Files of other tools and other languages, recognized by their extension or by the root of their XML.

use std::path::Path;

/// What the name of a file shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Foreign {
    /// A program of another tool, which the user may miss.
    Program(&'static str),
    /// A document, a picture or a file of a version control system: plcc is not expected to read it.
    Document,
    /// Something else that is never a PLC source.
    Other(&'static str),
}

const TIA_PROJECT: &str = "a project of the TIA Portal: export its blocks as sources or XML";
const TIA_ARCHIVE: &str = "an archived project of the TIA Portal: export its blocks as sources or XML";
const TIA_LIBRARY: &str = "a library of the TIA Portal: export its blocks as sources or XML";
const TWINCAT_POU: &str = "a POU of TwinCAT: export it as PLCopen XML";
const TWINCAT_PROJECT: &str = "a project of TwinCAT: export it as PLCopen XML";
const CODESYS: &str = "an export of CODESYS: export it as PLCopen XML";
const CODESYS_2: &str =
    "an export of CoDeSys 2.3 with networks: open the project in CODESYS 3 and export it as PLCopen XML";
const LOGIX: &str = "a project of Logix 5000";
const CONTROL_EXPERT: &str = "a project of Control Expert";

/// Extensions of programs of other tools.
const PROGRAMS: [(&[&str], &str); 14] = [
    (&["s7p"], "a project of STEP 7: export sources from it"),
    (&["s7l"], "a library of STEP 7: export sources from it"),
    (&["mwp"], "a project of STEP 7-Micro/WIN: export its blocks as .awl"),
    (&["smart", "smartv3"], "a project of STEP 7-Micro/WIN SMART: export its blocks as .awl"),
    (&["tcpou"], TWINCAT_POU),
    (&["tcgvl"], "global variables of TwinCAT: export them as PLCopen XML"),
    (&["tcdut"], "a data type of TwinCAT: export it as PLCopen XML"),
    (&["tcio", "tctto", "tsproj", "tspproj", "plcproj", "tmc", "tpy"], TWINCAT_PROJECT),
    (&["project"], "a project of CODESYS: export it as PLCopen XML"),
    (&["export"], CODESYS),
    (&["l5x", "l5k", "acd"], LOGIX),
    (&["xef", "zef", "stu", "sta", "xpg", "xbd"], CONTROL_EXPERT),
    (&["gxw", "gx3"], "a project of GX Works"),
    (&["cxp", "cxt", "smc2"], "a project of CX-One or Sysmac Studio"),
];

/// Extensions of documents, pictures and other files that plcc is not expected to read.
const DOCUMENTS: &[&str] = &[
    "md", "markdown", "rst", "adoc", "tex", "pdf", "doc", "docx", "odt", "rtf", "ppt", "pptx", "odp", "chm", "png",
    "jpg", "jpeg", "gif", "bmp", "ico", "svg", "tif", "tiff", "webp", "eps", "drawio", "vsd", "vsdx", "dia", "psd",
    "dwg", "dxf", "mp3", "mp4", "mov", "avi", "webm", "wav", "ttf", "otf", "woff", "woff2",
];

/// Names of documents, with any extension of a text or none.
const DOCUMENT_NAMES: &[&str] = &[
    "readme",
    "license",
    "licence",
    "copying",
    "copyright",
    "changelog",
    "changes",
    "history",
    "news",
    "authors",
    "contributors",
    "contributing",
    "maintainers",
    "notice",
    "todo",
    "install",
    "security",
    "support",
    "code_of_conduct",
    "code-of-conduct",
    "codeowners",
    "citation",
];

/// Extensions of files in other languages and forms.
const OTHERS: [(&[&str], &str); 14] = [
    (&["c", "h", "cc", "cpp", "cxx", "hh", "hpp", "hxx", "ino"], "a source in C or C++"),
    (&["py", "pyw", "pyi", "ipynb"], "a source in Python"),
    (&["cs", "vb", "vbs", "fs", "java", "kt", "scala"], "a source in another language"),
    (&["js", "mjs", "cjs", "jsx", "ts", "tsx", "vue"], "a source in JavaScript"),
    (
        &["go", "rs", "rb", "php", "pl", "pm", "lua", "swift", "dart", "r", "jl", "hs", "erl", "ex"],
        "a source in another language",
    ),
    (&["pas", "dpr", "vhd", "vhdl", "adb", "ads", "sql", "f90", "asm", "bas"], "a source in another language"),
    (&["sh", "bash", "zsh", "fish", "bat", "cmd", "ps1", "psm1", "mk", "cmake", "gradle"], "a script"),
    (&["html", "htm", "css", "scss", "less"], "a web page"),
    (
        &["json", "json5", "jsonl", "yml", "yaml", "ini", "conf", "properties", "editorconfig", "lock"],
        "settings or data",
    ),
    (&["xls", "ods"], "a workbook: tag tables are read from .xlsx"),
    (&["zip", "7z", "rar", "gz", "bz2", "xz", "tar", "tgz", "arj"], "an archive: unpack it"),
    (&["gsd", "gse", "gsg", "gsdml"], "a description of a device"),
    (&["sln", "csproj", "vcxproj", "suo", "user"], "a file of a development environment"),
    (&["exe", "dll", "so", "o", "a", "lib", "obj", "class", "jar", "pyc", "msi"], "a program of the computer"),
];

/// Names of files whose extension does not show what they are.
const OTHER_NAMES: [(&[&str], &str); 3] = [
    (&["makefile", "gnumakefile", "dockerfile", "jenkinsfile", "vagrantfile", "configure"], "a script"),
    (&["cmakelists.txt", "requirements.txt"], "settings or data"),
    (&["thumbs.db", "desktop.ini"], "a file of the operating system"),
];

/// What the name of a file shows; `None`: its content decides.
pub fn of_name(path: &Path) -> Option<Foreign> {
    let name = path.file_name()?.to_string_lossy().to_ascii_lowercase();
    let found = OTHER_NAMES.iter().find(|(names, _)| names.contains(&name.as_str()));
    if let Some((_, what)) = found {
        return Some(Foreign::Other(what));
    }
    let (stem, suffix) = name.rsplit_once('.').unwrap_or((&name, ""));
    let is_text = matches!(suffix, "" | "txt" | "md" | "rst" | "en" | "de" | "adoc");
    let document = |name: &str| is_text && DOCUMENT_NAMES.contains(&name);
    // `README.de.txt`, `LICENSE-MIT`.
    let first = stem.split(['.', '_', '-']).next().unwrap_or_default();
    let is_variant = matches!(first, "readme" | "license" | "licence" | "copying" | "changelog");
    if DOCUMENTS.contains(&suffix) || document(stem) || is_variant && document(first) {
        return Some(Foreign::Document);
    }
    if let Some((_, what)) = PROGRAMS.iter().find(|(suffixes, _)| suffixes.contains(&suffix)) {
        return Some(Foreign::Program(what));
    }
    // The number is the version: `.ap17`, `.zap15_1`.
    let version = suffix.trim_start_matches(|c: char| c.is_ascii_alphabetic());
    if version.starts_with(|c: char| c.is_ascii_digit()) {
        match suffix.strip_suffix(version) {
            Some("ap") => return Some(Foreign::Program(TIA_PROJECT)),
            Some("zap") => return Some(Foreign::Program(TIA_ARCHIVE)),
            Some("al" | "zal") => return Some(Foreign::Program(TIA_LIBRARY)),
            _ => {}
        }
    }
    OTHERS.iter().find(|(suffixes, _)| suffixes.contains(&suffix)).map(|(_, what)| Foreign::Other(what))
}

/// A project or library of a tool for PLCs of Siemens: what it is, and how its program leaves that tool.
pub fn siemens_project(path: &Path) -> Option<(&'static str, &'static str)> {
    const STEP7: &str = "in the editor of STEP 7 choose File > Generate Source and select the blocks; in the symbol editor choose Table > Export, which writes .sdf";
    const TIA: &str = "in the project tree of the TIA Portal select the blocks and choose \"Generate source from blocks\" for SCL, STL and data; export LAD, FBD and GRAPH as SIMATIC SD or XML, and the tags as .xlsx";
    const MICRO_WIN: &str = "open it in STEP 7-Micro/WIN and choose File > Export, which writes .awl; an .awl holds the program and the data block";
    let Some(Foreign::Program(what)) = of_name(path) else { return None };
    let what = what.split(':').next().unwrap_or(what);
    let how = match what {
        _ if what.ends_with("of the TIA Portal") => TIA,
        _ if what.contains("Micro/WIN") => MICRO_WIN,
        _ if what.ends_with("of STEP 7") => STEP7,
        _ => return None,
    };
    Some((what, how))
}

/// A program of another tool, recognized by the marks that the tool writes into a text: what it is.
pub fn of_marks(text: &str) -> Option<&'static str> {
    // Such an export is structured text, except for its networks.
    let is_drawn =
        text.contains("@END_DECLARATION") && text.lines().any(|line| line.trim_start().starts_with("_NETWORKS"));
    is_drawn.then_some(CODESYS_2)
}

/// What XML with a root of this name is.
pub fn of_root(root: &str) -> Option<Foreign> {
    Some(match root {
        "TcPlcObject" => Foreign::Program("an object of TwinCAT: export it as PLCopen XML"),
        "TcSmProject" => Foreign::Program(TWINCAT_PROJECT),
        "ExportFile" => Foreign::Program(CODESYS),
        "RSLogix5000Content" => Foreign::Program(LOGIX),
        "FEFExchangeFile" | "FBExchangeFile" | "STExchangeFile" | "LDExchangeFile" | "DDTExchangeFile" => {
            Foreign::Program(CONTROL_EXPERT)
        }
        "FBType" | "AdapterType" => Foreign::Program("a function block of IEC 61499"),
        "CAEXFile" => Foreign::Other("a hardware configuration (AML)"),
        "ISO15745Profile" => Foreign::Other("a description of a device"),
        "html" => Foreign::Other("a web page"),
        "svg" => Foreign::Document,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn projects_of_siemens_tell_how_to_export() {
        for (name, words) in [
            ("a.s7p", "Generate Source"),
            ("a.zap15_1", "Generate source from blocks"),
            ("a.AP17", "xlsx"),
            ("a.mwp", ".awl"),
        ] {
            assert!(siemens_project(Path::new(name)).is_some_and(|(_, how)| how.contains(words)), "{name}");
        }
        assert_eq!(siemens_project(Path::new("a.stl")), None);
        assert_eq!(siemens_project(Path::new("a.L5X")), None);
    }

    #[test]
    fn marks_tell_of_networks() {
        let drawn = "PROGRAM Main\nVAR\nEND_VAR\n(* @END_DECLARATION := '0' *)\n_LD_BODY\n_NETWORKS : 1\n_NETWORK\n";
        assert_eq!(of_marks(drawn), Some(CODESYS_2));
        assert_eq!(of_marks("FUNCTION F : INT\n(* @END_DECLARATION := '0' *)\nF := 1;\nEND_FUNCTION\n"), None);
    }

    #[test]
    fn names_tell_of_other_tools() {
        let of = |name: &str| of_name(Path::new(name));
        for name in ["x.s7p", "x.AP17", "x.zap15_1", "x.al16", "x.mwp", "a/b.TcPOU", "x.L5X", "x.export", "x.project"] {
            assert!(matches!(of(name), Some(Foreign::Program(_))), "{name}");
        }
        for name in ["README", "README.md", "Readme_de.txt", "LICENSE", "a.pdf", "a.PNG", "notes.md"] {
            assert_eq!(of(name), Some(Foreign::Document), "{name}");
        }
        for name in ["x.c", "x.py", "x.json", "x.yml", "x.html", "Makefile", "x.zip", "requirements.txt"] {
            assert!(matches!(of(name), Some(Foreign::Other(_))), "{name}");
        }
        for name in
            ["x.txt", "x.awl", "x.src", "main", "x.st", "x.db", "x.csv", "news_valve.scl", "history.stl", "x.ap"]
        {
            assert_eq!(of(name), None, "{name}");
        }
    }
}
