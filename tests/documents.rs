//! Documents that must agree with the code: generated references, pages of diagnostics, links, one test file an instruction.

use std::fs;
use std::path::{Path, PathBuf};

use plcc_diag::Code;
use plcc_driver::cli::Level;
use plcc_driver::inputs::{self, TestInput};
use plcc_driver::pipeline::{self, Settings};
use plcc_driver::testing::{self, Form, Variant};
use plcc_syntax::stl::StlInsn;
use plcc_tests::{expect_file, files, plan, root, shown, tests_folder};

#[test]
fn the_instruction_reference_is_current() {
    expect_file(&root().join("docs/reference/stl.md"), &plcc_syntax::stl::reference()).unwrap();
}

#[test]
fn the_reference_of_diagnostics_is_current() {
    expect_file(&root().join("docs/reference/diagnostics.md"), &plcc_diag::reference::diagnostics()).unwrap();
}

#[test]
fn every_instruction_has_its_test_file() {
    let folder = tests_folder().join("run/stl/insn");
    let missing: Vec<String> = StlInsn::ALL
        .iter()
        .map(|insn| format!("{}.stl", snake_case(insn.row())))
        .filter(|name| !folder.join(name).is_file())
        .collect();
    assert!(missing.is_empty(), "not in {}: {}", shown(&folder), missing.join(", "));
}

/// `AddI` to `add_i`.
fn snake_case(row: &str) -> String {
    let mut name = String::new();
    for (index, letter) in row.char_indices() {
        if index > 0 && letter.is_uppercase() {
            name.push('_');
        }
        name.extend(letter.to_lowercase());
    }
    name
}

#[test]
fn links_in_documents_lead_somewhere() {
    let mut documents = files(&root().join("docs"), "md");
    documents.extend(
        ["README.md", "CONTRIBUTING.md"].map(|name| root().join(name)).into_iter().filter(|path| path.is_file()),
    );
    let mut broken = Vec::new();
    for document in &documents {
        let text = fs::read_to_string(document).unwrap();
        for target in link_targets(&text) {
            let path = target.split('#').next().unwrap_or_default();
            let folder = document.parent().unwrap();
            if !path.is_empty() && !path.contains("://") && !folder.join(path).exists() {
                broken.push(format!("{}: {target}", shown(document)));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
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
    if code == Code::AssertionNotReached {
        return codes_of_test(&paths[0]);
    }
    let settings = Settings { pragmas: true, require_main: code == Code::NoMainBlock, ..Settings::default() };
    pipeline::front(inputs::read(&paths), &settings).diagnostics.iter().map(|d| d.code).collect()
}

/// Codes in the messages of a test that ran.
fn codes_of_test(path: &Path) -> Vec<Code> {
    let plan = plan(vec![Variant { form: Form::Jit, level: Level::O2 }]);
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
