//! Documents that must agree with the code: generated references, pages of diagnostics, decisions, links, and a pair of test files for each diagnostic
//! code.

use std::fs;
use std::path::{Path, PathBuf};

use plcc_convert::to_graph;
use plcc_convert::to_stl::types::Types;
use plcc_diag::{Code, SourceFile, SourceMap};
use plcc_driver::cli::Level;
use plcc_driver::inputs::{self, TestInput};
use plcc_driver::pipeline::{self, Settings};
use plcc_driver::testing::{self, Form, Variant};
use plcc_syntax::ast::{Block, SectionKind, TypeKind, TypeRef};
use plcc_syntax::network::ast::Language;
use plcc_syntax::{Elementary, ParseOptions};
use plcc_tests::{expect_file, files, plan, reference, root, shown, tests_folder};

#[test]
fn the_instruction_reference_is_current() {
    expect_file(&root().join("docs/reference/stl.md"), &reference::stl()).unwrap();
}

#[test]
fn the_reference_of_the_s7_200_is_current() {
    expect_file(&root().join("docs/reference/s7-200.md"), &reference::s7200()).unwrap();
}

#[test]
fn the_reference_of_scl_is_current() {
    expect_file(&root().join("docs/reference/scl.md"), &reference::scl()).unwrap();
}

#[test]
fn the_reference_of_lad_and_fbd_is_current() {
    expect_file(&root().join("docs/reference/lad-fbd.md"), &reference::lad_fbd()).unwrap();
}

#[test]
fn the_reference_of_graph_is_current() {
    expect_file(&root().join("docs/reference/graph.md"), &reference::graph()).unwrap();
}

#[test]
fn the_reference_of_the_standard_library_is_current() {
    expect_file(&root().join("docs/reference/stdlib.md"), &reference::standard_library()).unwrap();
}

#[test]
fn the_reference_of_diagnostics_is_current() {
    expect_file(&root().join("docs/reference/diagnostics.md"), &reference::diagnostics()).unwrap();
}

/// Codes that no source file alone can show; the examples on their pages are the tests.
const WITHOUT_CHECK_FILE: &[(Code, &str)] = &[
    (Code::SymbolTable, "needs a symbol table"),
    (Code::Project, "needs a plc.toml"),
    (Code::UnknownCpu, "needs a plc.toml or `--cpu`"),
    (Code::Unreadable, "needs a file that cannot be read"),
    (Code::Station, "needs a plc.toml"),
    (Code::NoModule, "needs a plc.toml"),
    (Code::ModuleAccess, "needs a plc.toml"),
    (Code::MemoryByName, "needs a tag table"),
    (Code::MemoryTag, "needs a tag table"),
    (Code::ExtensionBlock, "needs an export in XML"),
    (Code::NotRead, "needs a folder"),
    (Code::ForeignContent, "needs an export in XML"),
    (Code::MissingCondition, "needs an export in XML"),
    (Code::BranchNeighbour, "needs an export in XML"),
    (Code::BranchArms, "needs an export in XML"),
    (Code::ChartInstance, "needs an export in XML"),
    (Code::MixedFamilies, "needs two files"),
    (Code::NotConverted, "comes when a source is converted"),
    (Code::AssertionNotReached, "comes when a test has run"),
];

#[test]
fn every_code_has_a_failing_and_a_passing_file() {
    let check_files =
        ["stl", "awl", "scl", "s7dcl", "gr7"].map(|suffix| files(&tests_folder().join("check"), suffix)).concat();
    let names: Vec<String> =
        check_files.iter().map(|path| path.file_stem().unwrap().to_string_lossy().into()).collect();
    let has_pair = |code: Code| {
        names.iter().any(|name| {
            name.starts_with(&format!("{}-", code.name()))
                && !name.ends_with("-ok")
                && names.contains(&format!("{name}-ok"))
        })
    };
    for &code in Code::ALL {
        let reason = WITHOUT_CHECK_FILE.iter().find(|(other, _)| *other == code).map(|(_, reason)| reason);
        match reason {
            None => {
                assert!(
                    has_pair(code),
                    "tests/check has no {0}-NAME.stl, .awl, .scl, .s7dcl or .gr7 with its {0}-NAME-ok",
                    code.name()
                )
            }
            Some(reason) => assert!(!has_pair(code), "{} has a pair of files, although it {reason}", code.name()),
        }
    }
}

#[test]
fn the_runtime_has_the_system_functions_that_the_library_declares() {
    let mut declared: Vec<(u16, &str, Vec<u32>)> = plcc_stdlib::blocks()
        .iter()
        .filter(|block| block.class == plcc_stdlib::BlockClass::Sfc && block.form == plcc_stdlib::Form::Runtime)
        .map(|block| (block.number, block.name, parameters_of(block)))
        .collect();
    // The sources of the library have them by subject, the runtime by number.
    declared.sort_unstable();
    for (declared, row) in declared.iter().zip(plcc_runtime::system::table()) {
        assert_eq!(*declared, row, "a declaration and a row of the runtime");
    }
    assert_eq!(declared.len(), plcc_runtime::system::table().count());
}

/// Bytes of the parameters that the source of one function declares, as in `plcc_runtime::system::table`.
fn parameters_of(block: &plcc_stdlib::SystemBlock) -> Vec<u32> {
    let source = block.source;
    let mut sources = SourceMap::default();
    let file = sources.add(SourceFile::new("sfc.stl", source));
    let options = ParseOptions::default();
    let (unit, messages) = match block.language {
        plcc_stdlib::Language::Stl => plcc_syntax::stl::parse(file, source, &options),
        plcc_stdlib::Language::Scl => plcc_syntax::scl::parse(file, source, &options),
    };
    assert!(messages.is_empty(), "{messages:?}");
    let [Block::Code(block)] = unit.blocks.as_slice() else { panic!("one block: {source}") };
    let types = |kind: SectionKind| {
        let sections = block.sections.iter().filter(move |section| section.kind == kind);
        sections.flat_map(|section| &section.variables).map(|variable| &variable.ty)
    };
    let result = block.return_type.iter().filter(|ty| !is_void(ty));
    let all =
        types(SectionKind::Input).chain(result).chain(types(SectionKind::Output)).chain(types(SectionKind::InOut));
    let mut bytes: Vec<u32> = Vec::new();
    let mut after_bool = false;
    for ty in all {
        let size = if after_bool && is_bool(ty) { 0 } else { bytes_of(ty) };
        after_bool = is_bool(ty);
        bytes.push(size);
    }
    bytes
}

fn is_void(ty: &TypeRef) -> bool {
    matches!(&ty.kind, TypeKind::Named(name) if name.eq_ignore_ascii_case("VOID"))
}

fn is_bool(ty: &TypeRef) -> bool {
    matches!(&ty.kind, TypeKind::Named(name) if name.eq_ignore_ascii_case("BOOL"))
}

/// Bytes of a type among the parameters of a system function.
fn bytes_of(ty: &TypeRef) -> u32 {
    match &ty.kind {
        TypeKind::Named(name) => match name.to_ascii_uppercase().as_str() {
            "DATE_AND_TIME" | "DT" => 8,
            "ANY" => 10,
            "DTL" => 12,
            "POINTER" => 6,
            "VARIANT" | "VARIANT_DATA" => 18,
            "REFERENCE" => 8,
            "ERRORSTRUCT" => 28,
            // Numbers of hardware and of events.
            "OB_ATT" | "OB_CYCLIC" | "HW_HSC" | "HW_PWM" | "RTM" | "DB_ANY" => 2,
            "HW_ANY" | "HW_IO" | "HW_IOSYSTEM" | "HW_DEVICE" => 2,
            "EVENT_ATT" => 4,
            name => {
                let elementary = Elementary::from_word(name).unwrap_or_else(|| panic!("the type {name}"));
                elementary.bits().div_ceil(8)
            }
        },
        // Structures of the start information.
        TypeKind::Struct(members) => members.iter().map(|member| bytes_of(&member.ty)).sum(),
        // Texts are handed over by their pointers.
        TypeKind::String(_) | TypeKind::WideString(_) => 6,
        other => panic!("no parameter of a system function has the type {other:?}"),
    }
}

#[test]
fn decisions_are_numbered_and_name_tests_that_exist() {
    let mut last = 0;
    for path in &files(&root().join("docs/decisions"), "md") {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let text = fs::read_to_string(path).unwrap();
        let number: u32 = name.get(..4).and_then(|digits| digits.parse().ok()).unwrap_or(0);
        assert!(number == last + 1 && name[4..].starts_with('-'), "{name}: after {last} comes {}", last + 1);
        assert!(text.starts_with(&format!("# {number}. ")), "{name}: the heading has another number");
        last = number;
        let tests = text.split_once("**Tests.**").unwrap_or_else(|| panic!("{name} names no tests")).1;
        let patterns: Vec<&str> = tests.split('`').skip(1).step_by(2).collect();
        assert!(!patterns.is_empty(), "{name} names no tests");
        for pattern in patterns {
            assert!(names_a_file(pattern), "{name}: there is no {pattern}");
        }
    }
}

/// True if a file has the path `pattern`, seen from the workspace; one `*` in its name stands for anything.
fn names_a_file(pattern: &str) -> bool {
    let path = root().join(pattern);
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    let Some((begin, end)) = name.split_once('*') else { return path.is_file() };
    let entries = fs::read_dir(path.parent().unwrap()).into_iter().flatten().flatten();
    entries
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .any(|file| file.len() >= begin.len() + end.len() && file.starts_with(begin) && file.ends_with(end))
}

/// What comments and tests name after `Source:` is in the table of docs/SOURCES.md.
#[test]
fn sources_are_in_the_table() {
    let page = fs::read_to_string(root().join("docs/SOURCES.md")).unwrap();
    let rows = page.lines().filter(|line| line.starts_with("| ")).skip(2);
    let cells = rows.filter_map(|row| row.split('|').nth(1));
    let names: Vec<String> = cells.flat_map(|cell| cell.trim().split(", ")).map(str::to_lowercase).collect();
    let mut unknown = Vec::new();
    for path in
        ["compiler", "runtime", "samples", "stdlib", "tests"].iter().flat_map(|folder| all_files(&root().join(folder)))
    {
        let Ok(text) = fs::read_to_string(&path) else { continue };
        for (at, line) in text.lines().enumerate() {
            let Some((_, source)) = line.split_once("Source: ") else { continue };
            let source = source.to_lowercase();
            // Code that looks for such lines goes on with a quote.
            let is_name = source.starts_with(char::is_alphanumeric);
            if is_name && !names.iter().any(|name| source.starts_with(name.as_str())) {
                unknown.push(format!("{}:{}: {source}", shown(&path), at + 1));
            }
        }
    }
    assert!(unknown.is_empty(), "no name of docs/SOURCES.md begins these:\n{}", unknown.join("\n"));
}

/// All files below `folder`, also those of projects.
fn all_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    entries.flat_map(|path| if path.is_dir() { all_files(&path) } else { vec![path] }).collect()
}

#[test]
fn links_in_documents_lead_somewhere() {
    let folders = ["docs", "samples", "stdlib", "tests"].map(|folder| files(&root().join(folder), "md"));
    let mut documents = folders.concat();
    documents.extend(["README.md", "CONTRIBUTING.md"].map(|name| root().join(name)));
    let mut broken = Vec::new();
    for document in &documents {
        let text = fs::read_to_string(document).unwrap();
        for target in link_targets(&text).into_iter().filter(|target| !target.contains("://")) {
            let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
            let file = if path.is_empty() { document.clone() } else { document.parent().unwrap().join(path) };
            let has_anchor = || anchors(&fs::read_to_string(&file).unwrap()).iter().any(|own| own == anchor);
            if !file.exists() || !anchor.is_empty() && !has_anchor() {
                broken.push(format!("{}: {target}", shown(document)));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

/// The anchors of the headings of a document: small letters, with `-` for each blank and without punctuation.
fn anchors(text: &str) -> Vec<String> {
    let mut in_code = false;
    let mut anchors = Vec::new();
    for line in text.lines() {
        in_code ^= line.starts_with("```");
        let heading = line.trim_start_matches('#');
        if !in_code && line.starts_with('#') && heading.starts_with(' ') {
            let letters = heading.trim().to_lowercase();
            let kept = letters.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
            anchors.push(kept.map(|c| if c == ' ' { '-' } else { c }).collect());
        }
    }
    anchors
}

/// Targets of `[text](target)` outside of code.
fn link_targets(text: &str) -> Vec<&str> {
    let mut in_code = false;
    let mut targets = Vec::new();
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            in_code = !in_code;
        }
        if in_code {
            continue;
        }
        for (at, _) in line.match_indices("](") {
            // An odd number of marks before it: the link stands in a code span.
            if line[..at].matches('`').count() % 2 == 0 {
                targets.extend(line[at + 2..].split(')').next());
            }
        }
    }
    targets
}

/// Every page's failing example gives its code, and the repaired one does not.
#[test]
fn pages_of_diagnostics_show_what_they_say() {
    let wrong: Vec<String> = Code::ALL
        .iter()
        .flat_map(|&code| {
            let (failing, repaired) = code.page().split_once("\n## Repaired\n").expect("a page has a repaired example");
            let failing = failing.split_once("\n## Failing\n").expect("a page has a failing example").1;
            let [failing, repaired] = [failing, repaired].map(|example| {
                let example = example.to_string();
                plcc_driver::on_large_stack(move || codes_of(code, &example)).expect("the compiler does not panic")
            });
            let mut wrong = Vec::new();
            if !failing.contains(&code) {
                wrong.push(format!("{}: the failing example gives {}", code.name(), names(&failing)));
            }
            if repaired.contains(&code) || repaired.iter().any(|other| other.severity() == plcc_diag::Severity::Error) {
                wrong.push(format!("{}: the repaired example gives {}", code.name(), names(&repaired)));
            }
            wrong
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn names(codes: &[Code]) -> String {
    if codes.is_empty() { "nothing".to_string() } else { codes.iter().map(|c| c.name()).collect::<Vec<_>>().join(", ") }
}

/// The codes that an example gives. Its fences are files, named by their language; a `sh` fence names the files to check.
fn codes_of(code: Code, example: &str) -> Vec<Code> {
    let folder = tempfile::tempdir().unwrap();
    let mut paths: Vec<PathBuf> = Vec::new();
    let mut named: Option<Vec<PathBuf>> = None;
    for (language, text) in fences(example) {
        let name = match language {
            "toml" => "plc.toml",
            "sdf" => "symbols.sdf",
            "scl" => "main.scl",
            "s7dcl" => "main.s7dcl",
            "gr7" => "main.gr7",
            "awl" => "main.awl",
            "s7res" => {
                // It lies beside the source and is not a source itself.
                fs::write(folder.path().join("main.s7res"), text).unwrap();
                continue;
            }
            "xml" => "main.xml",
            "txt" => "main.txt",
            "sh" => {
                let words = text.split_whitespace().skip(2);
                named = Some(words.map(|word| folder.path().join(word)).collect());
                continue;
            }
            _ => "main.stl",
        };
        fs::write(folder.path().join(name), text).unwrap();
        paths.push(folder.path().join(name));
    }
    if paths.iter().any(|path| path.ends_with("plc.toml")) {
        paths = vec![folder.path().to_path_buf()];
    }
    let paths = named.unwrap_or(paths);
    match code {
        Code::AssertionNotReached => return codes_of_test(&paths[0]),
        Code::NotConverted => return codes_of_conversion(&paths),
        _ => {}
    }
    let settings = Settings { pragmas: true, require_main: code == Code::NoMainBlock, ..Settings::default() };
    pipeline::front(inputs::read(&paths), &settings).diagnostics.iter().map(|d| d.code).collect()
}

/// Codes in the messages about a conversion to LAD.
fn codes_of_conversion(paths: &[PathBuf]) -> Vec<Code> {
    let parsed = pipeline::parse(inputs::read(paths), &Settings::default());
    let types = Types::new(parsed.units.iter().map(|(_, unit)| unit), &parsed.tables);
    let messages = parsed.units.iter().flat_map(|(_, unit)| to_graph::unit(unit, &types, Language::Lad).1);
    messages.map(|d| d.code).collect()
}

/// Codes in the messages of a test that ran.
fn codes_of_test(path: &Path) -> Vec<Code> {
    let plan = plan(vec![Variant { form: Form::Jit, optimization: Level::O2.into() }]);
    let outcomes = testing::run(&[TestInput::File(path.to_path_buf())], &plan);
    Code::ALL.iter().copied().filter(|code| outcomes[0].messages.contains(&format!("[{}]", code.name()))).collect()
}

/// Language and text of each fenced block.
fn fences(text: &str) -> Vec<(&str, String)> {
    let mut fences = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if let Some(language) = line.strip_prefix("```") {
            let body: Vec<&str> = lines.by_ref().take_while(|line| !line.starts_with("```")).collect();
            fences.push((language, body.join("\n") + "\n"));
        }
    }
    fences
}

/// The crates of docs/ARCHITECTURE.md, in its order: each uses only those above it, and none is left out.
#[test]
fn crates_use_only_what_the_architecture_lists_above_them() {
    let text = fs::read_to_string(root().join("docs/ARCHITECTURE.md")).unwrap();
    let mut above: Vec<String> = Vec::new();
    let listed = text.lines().filter_map(|line| line.strip_prefix("**")?.split_once("**: ")).map(|(name, _)| name);
    for folder in listed.filter(|folder| root().join(folder).join("Cargo.toml").is_file()) {
        let manifest = fs::read_to_string(root().join(folder).join("Cargo.toml")).unwrap();
        let (_, dependencies) = manifest.split_once("[dependencies]").unwrap_or_default();
        let dependencies = dependencies.split("\n[").next().unwrap_or_default();
        for used in dependencies.lines().filter_map(|line| line.strip_suffix(".workspace = true")) {
            let known = !used.starts_with("plcc-") || above.iter().any(|name| name == used);
            assert!(known, "{folder} uses {used}, which docs/ARCHITECTURE.md does not list above it");
        }
        above.extend(
            manifest.lines().find_map(|line| line.strip_prefix("name = \"")?.strip_suffix('"')).map(String::from),
        );
    }
    assert_eq!(above.len(), members().len(), "{above:?}");
}

/// The folders of all packages.
fn members() -> Vec<String> {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let members = manifest.split("members = [").nth(1).and_then(|rest| rest.split(']').next()).unwrap();
    members.split('"').skip(1).step_by(2).map(str::to_string).collect()
}

/// A library that says `test = false` has no unit tests, or plcc-inside builds them: nobody would run them otherwise.
#[test]
fn no_unit_tests_are_left_out() {
    let inside = fs::read_to_string(root().join("tests/inside/Cargo.toml")).unwrap();
    let mut built = 0;
    for folder in members() {
        let manifest = fs::read_to_string(root().join(&folder).join("Cargo.toml")).unwrap();
        let library = manifest.split("\n[lib]").nth(1).unwrap_or_default();
        let library = library.split("\n[").next().unwrap_or_default();
        let is_skipped = library.lines().any(|line| line == "test = false");
        let has_test = |path: &PathBuf| fs::read_to_string(path).is_ok_and(|text| text.contains("#[test]"));
        let has_tests = all_files(&root().join(&folder).join("src")).iter().any(has_test);
        let is_inside = inside.contains(&format!("path = \"../../{folder}/src/lib.rs\""));
        built += usize::from(is_inside);
        assert!(
            !is_skipped || !has_tests || is_inside,
            "the unit tests of {folder} are not in tests/inside/Cargo.toml"
        );
        assert!(!is_inside || is_skipped, "{folder} builds its unit tests, and so does tests/inside");
    }
    assert!(built > 15, "only {built} libraries");
}

#[test]
fn the_architecture_is_short() {
    let text = fs::read_to_string(root().join("docs/ARCHITECTURE.md")).unwrap();
    assert!(text.lines().count() <= 250, "{} lines", text.lines().count());
    for line in text.lines() {
        assert!(line.chars().count() <= 110, "longer than 110 columns: {line}");
    }
}

/// Files that docs/ARCHITECTURE.md, docs/changing.md and CONTRIBUTING.md name by a path from the root exist.
#[test]
fn files_that_contributors_are_sent_to_exist() {
    for document in ["docs/ARCHITECTURE.md", "docs/changing.md", "CONTRIBUTING.md"] {
        let text = fs::read_to_string(root().join(document)).unwrap();
        let words = text.split('`').skip(1).step_by(2);
        let paths = words.filter(|word| {
            let begins = ["compiler/", "runtime/", "stdlib/", "tests/", "docs/", "samples/"];
            begins.iter().any(|begin| word.starts_with(begin)) && !word.contains(['*', ' ', '<'])
        });
        for path in paths.filter(|path| !path.contains("ROW") && !path.contains("NNNN")) {
            assert!(root().join(path).exists(), "{document} names {path}");
        }
    }
}
