//! PLCopen XML that is written: it does what the sources do.
//!
//! - Here: all sources and projects of the tests with their assertions and scenarios, what is refused, and titles of networks.
//! - `random`: random networks; `charts`: GRAPH as SFC; `statements`: STL as LD; `same`: how they are compared in each cycle.

mod charts;
mod random;
mod same;
mod statements;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use plcc_driver::cli::Level;
use plcc_driver::command::convert::whole;
use plcc_driver::inputs::{self, TestInput};
use plcc_driver::pipeline::{self, Parsed, Settings};
use plcc_driver::testing::{self, Form, Outcome, Variant};
use plcc_syntax::ast::{Block, BlockName, Code, CodeBlock, CodeKind, Header};
use plcc_syntax::network::ast::{Body as Networks, Content, Network};
use plcc_syntax::scl::ast::{Body, Dialect, Expr, ExprKind, Name, NameForm, Statement, StatementKind};
use plcc_tests::{plan, projects, root, tests_folder};

use crate::{everything, has_errors, sources};

/// Splits blocks of LAD or FBD with statements between their networks: each network becomes a function, which statements call.
fn split(parsed: &mut Parsed) {
    for (_, unit) in &mut parsed.units {
        let mut functions = Vec::new();
        for block in &mut unit.blocks {
            let Block::Code(code) = block else { continue };
            let Code::Graphic(body) = &code.code else { continue };
            let is_text = |network: &Network| matches!(network.content, Content::Scl(_));
            if !body.networks.iter().any(is_text) || body.networks.iter().all(is_text) {
                continue;
            }
            let mut statements = Vec::new();
            for network in &body.networks {
                let span = network.span;
                if let Content::Scl(list) = &network.content {
                    statements.extend(list.iter().cloned());
                    continue;
                }
                let text = format!("Network_{}", functions.len() + 1);
                let callee = Name { text: text.clone(), form: NameForm::Quoted, span };
                let callee = Box::new(Expr { kind: ExprKind::Name(callee), span });
                let call = Expr { kind: ExprKind::Call { callee, arguments: Vec::new() }, span };
                statements.push(Statement { kind: StatementKind::Expression(call), span });
                let body = Networks { networks: vec![network.clone()] };
                functions.push(Block::Code(CodeBlock {
                    kind: CodeKind::Fc,
                    name: BlockName::Symbol { name: text, span },
                    return_type: None,
                    header: Header::default(),
                    sections: Vec::new(),
                    constants: Vec::new(),
                    code: Code::Graphic(body),
                    span,
                }));
            }
            code.code = Code::Scl(Body { dialect: Dialect::Tia, labels: Vec::new(), statements });
        }
        unit.blocks.splice(0..0, functions);
    }
}

/// The temporary data of an OB in SIMATIC SD as a data block, for its networks become functions.
fn with_global_temps(text: &str) -> String {
    let Some(start) = text.find("ORGANIZATION_BLOCK").filter(|_| text.contains("NETWORK")) else {
        return text.to_string();
    };
    let Some(begin) = text[start..].find("VAR_TEMP").map(|at| start + at) else { return text.to_string() };
    let Some(end) = text[begin..].find("END_VAR").map(|at| begin + at) else { return text.to_string() };
    let declared = &text[begin + "VAR_TEMP".len()..end];
    let last = text[end..].find("END_ORGANIZATION_BLOCK").map_or(text.len(), |at| end + at);
    let mut block = format!("{}{}", &text[start..begin], &text[end + "END_VAR".len()..last]);
    for name in declared.lines().filter_map(|line| line.split_once(':')).map(|(names, _)| names) {
        for name in name.split(',').map(str::trim).filter(|name| !name.is_empty()) {
            block = block.replace(&format!("#{name}"), &format!("\"Temporary\".{name}"));
        }
    }
    let (before, after) = (&text[..start], &text[last..]);
    format!("{before}{block}{after}\nDATA_BLOCK \"Temporary\"\n    VAR\n{declared}    END_VAR\nEND_DATA_BLOCK\n")
}

/// A source as a project: `None` if it has errors of its own, or what PLCopen XML cannot say; otherwise what its assertions say.
fn as_project(path: &Path, refused: &mut BTreeMap<String, usize>) -> Option<Result<(), String>> {
    plcc_tests::bind_file(path, &Settings::default()).ok()?;
    let settings = Settings { pragmas: true, ..Settings::default() };
    let folder = tempfile::tempdir().expect("a folder");
    let text = fs::read_to_string(path).ok().filter(|text| text.contains("//@ assert"))?;
    let source = folder.path().join(path.file_name()?);
    fs::write(&source, with_global_temps(&text)).expect("a file");
    let mut parsed = pipeline::parse(inputs::read(&[source]), &settings);
    if has_errors(&parsed.diagnostics) {
        *refused.entry("(cannot be split)".to_string()).or_default() += 1;
        return None;
    }
    let is_main = |block: &Block| matches!(block, Block::Code(block) if block.kind == CodeKind::Ob);
    if !parsed.units.iter().flat_map(|(_, unit)| &unit.blocks).any(is_main) {
        return None;
    }
    split(&mut parsed);
    let (written, messages) = whole::document(&parsed, None, "Test");
    if let Some(first) = messages.iter().find(|message| message.is_error()) {
        *refused.entry(first.title.clone()).or_default() += 1;
        return None;
    }
    let file = folder.path().join("a.xml");
    fs::write(&file, &written).expect("a file");
    Some(passes(TestInput::File(file)))
}

/// Runs the tests of an input.
fn outcomes(input: TestInput) -> Vec<Outcome> {
    testing::run(&[input], &plan(vec![Variant { form: Form::Jit, optimization: Level::O0.into() }]))
}

/// Whether all assertions hold; otherwise the messages.
fn passes(input: TestInput) -> Result<(), String> {
    let outcomes = outcomes(input);
    let failed = outcomes.iter().find(|one| one.failed > 0 || one.rejected || one.unreadable || one.passed == 0);
    failed.map_or(Ok(()), |one| Err(format!("{}{}", one.messages, one.failures)))
}

#[test]
fn sources_as_projects_pass_their_assertions() {
    let (mut count, mut failed, mut refused) = (0, Vec::new(), BTreeMap::new());
    for path in ["s7dcl", "scl", "xml"].iter().flat_map(|extension| sources(extension)) {
        match as_project(&path, &mut refused) {
            None => {}
            Some(Ok(())) => count += 1,
            Some(Err(text)) => failed.push(format!("{}: {text}", path.display())),
        }
    }
    println!("{count} sources; refused: {refused:#?}");
    assert!(failed.is_empty(), "{} of {}:\n{}", failed.len(), count + failed.len(), failed.join("\n\n"));
    assert!(count > 28, "only {count} sources; {refused:#?}");
}

/// A project with its scenarios, as one document: `None` if PLCopen XML cannot say it; otherwise what its scenarios say.
fn project(folder: &Path, refused: &mut BTreeMap<String, usize>) -> Option<Result<(), String>> {
    let bound = pipeline::front(inputs::read(&[folder.to_path_buf()]), &Settings::default());
    if bound.has_errors() || inputs::project_scenarios(folder).is_empty() {
        return None;
    }
    let parsed = pipeline::parse(inputs::read(&[folder.to_path_buf()]), &Settings::default());
    if parsed.units.iter().any(|(_, unit)| unit.s7200.is_some()) {
        return None;
    }
    // In CODESYS and MATIEC, PT counts in each call, and F_TRIG has an edge in the first one. What plcc writes keeps the rules of the TIA Portal.
    let exported = fs::read_to_string(folder.join("project.xml")).unwrap_or_default();
    let has_own_rules =
        ["TON", "TOF", "TP", "F_TRIG"].iter().any(|name| exported.contains(&format!("<derived name=\"{name}\"/>")));
    if exported.contains("xmlns:xhtml=") && has_own_rules {
        *refused.entry("(timers and edges of other editors)".to_string()).or_default() += 1;
        return None;
    }
    let (written, messages) = whole::document(&parsed, Some(&bound.program), "Test");
    if let Some(first) = messages.iter().find(|message| message.is_error()) {
        *refused.entry(first.title.clone()).or_default() += 1;
        return None;
    }
    // Scenarios with names that are others in the file, or with addresses in data blocks.
    let scenarios = everything(&folder.join("tests"));
    let has_addresses = scenarios.iter().any(|path| fs::read_to_string(path).is_ok_and(|text| text.contains("DB1.")));
    if has_addresses
        || messages.iter().any(|message| message.title.contains("in the file") && !message.title.contains("no address"))
    {
        *refused.entry("(scenarios with other names)".to_string()).or_default() += 1;
        return None;
    }
    let new = tempfile::tempdir().expect("a folder");
    fs::write(new.path().join("project.xml"), written).expect("a file");
    let toml = fs::read_to_string(folder.join("plc.toml")).expect("a project");
    let is_own = |line: &&str| !line.starts_with("sources") && !line.starts_with("symbols");
    let mut toml: String = toml.lines().filter(is_own).map(|line| format!("{line}\n")).collect();
    // Without a CPU in the project it is that of the sources.
    if !toml.contains("cpu") {
        toml = format!("cpu = \"{}\"\n{toml}", bound.program.profile.name);
    }
    fs::write(new.path().join("plc.toml"), toml).expect("a file");
    for scenario in scenarios {
        let to = new.path().join(scenario.strip_prefix(folder).expect("below the folder"));
        fs::create_dir_all(to.parent().expect("a folder")).expect("a folder");
        fs::copy(&scenario, to).expect("a file");
    }
    Some(passes(TestInput::Project(new.path().to_path_buf())))
}

#[test]
fn projects_pass_their_scenarios() {
    let (mut count, mut failed, mut refused) = (0, Vec::new(), BTreeMap::new());
    for folder in [tests_folder().join("run"), root().join("samples")].iter().flat_map(|folder| projects(folder)) {
        match project(&folder, &mut refused) {
            None => {}
            Some(Ok(())) => count += 1,
            Some(Err(text)) => failed.push(format!("{}: {text}", folder.display())),
        }
    }
    println!("{count} projects; refused: {refused:#?}");
    assert!(failed.is_empty(), "{} of {}:\n{}", failed.len(), count + failed.len(), failed.join("\n\n"));
    assert!(count > 4, "only {count} projects; {refused:#?}");
}

/// The project as a document, and messages.
fn project_document(project: &Path) -> (String, Vec<plcc_diag::Diagnostic>) {
    let settings = Settings { pragmas: true, ..Settings::default() };
    let parsed = pipeline::parse(inputs::read(&[project.to_path_buf()]), &settings);
    assert!(!has_errors(&parsed.diagnostics), "{:#?}", parsed.diagnostics);
    let program = pipeline::front(inputs::read(&[project.to_path_buf()]), &settings).program;
    whole::document(&parsed, Some(&program), "Line")
}

/// Operands and calls that PLCopen XML does not have are told once.
#[test]
fn what_is_refused_is_told_once() {
    let cases = [
        ("#n := \"D\".%DBW0;", "PLCopen XML has no addresses in data blocks"),
        ("\"Main\"();", "a call of a block without an instance"),
    ];
    for (statement, wanted) in cases {
        let source = format!(
            "DATA_BLOCK \"D\"\nSTRUCT\n  a : Int;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n\
             ORGANIZATION_BLOCK \"Main\"\nVAR_TEMP\n  n : Int;\nEND_VAR\nBEGIN\n  {statement}\nEND_ORGANIZATION_BLOCK\n"
        );
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("a.scl");
        fs::write(&file, source).expect("a file");
        let parsed = pipeline::parse(inputs::read(&[file]), &Settings::default());
        let (_, messages) = whole::document(&parsed, None, "Test");
        let titles: Vec<&str> = messages.iter().filter(|one| one.is_error()).map(|one| one.title.as_str()).collect();
        assert_eq!(titles, [wanted], "{statement}");
    }
}

/// Titles and comments of networks, by the names of their blocks.
fn titles(parsed: &Parsed) -> Vec<(String, Option<String>, Vec<String>)> {
    let blocks = parsed.units.iter().flat_map(|(_, unit)| &unit.blocks);
    let networks = blocks.filter_map(|block| match block {
        Block::Code(CodeBlock { name: BlockName::Symbol { name, .. }, code: Code::Graphic(body), .. }) => {
            Some(body.networks.iter().map(|one| (name.clone(), one.title.clone(), one.comment.clone())))
        }
        _ => None,
    });
    networks.flatten().collect()
}

#[test]
fn titles_and_comments_of_networks_are_kept() {
    let source = r#"<project><types><dataTypes/><pous><pou name="P" pouType="program"><interface><localVars>
        <variable name="a"><type><BOOL/></type></variable><variable name="b"><type><BOOL/></type></variable>
        </localVars></interface><body><LD>NETWORKS</LD></body></pou></pous></types></project>"#;
    let network = |y: i32, id: i32, comment: &str| {
        format!(
            r#"<comment localId="{c}" width="9" height="9"><position x="0" y="{y}"/><content><p>{comment}</p></content></comment>
            <leftPowerRail localId="{id}"><position x="0" y="{below}"/></leftPowerRail>
            <contact localId="{contact}"><position x="9" y="{below}"/><connectionPointIn><connection refLocalId="{id}"/>
            </connectionPointIn><variable>a</variable></contact>
            <coil localId="{coil}"><position x="19" y="{below}"/><connectionPointIn><connection refLocalId="{contact}"/>
            </connectionPointIn><variable>b</variable></coil>"#,
            c = id + 50,
            below = y + 10,
            contact = id + 1,
            coil = id + 2
        )
    };
    let networks = network(0, 1, "Seal-in\nof the motor\n\nthe end") + &network(50, 5, "\nonly a comment");
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.xml");
    fs::write(&file, source.replace("NETWORKS", &networks)).expect("a file");
    let parsed = pipeline::parse(inputs::read(std::slice::from_ref(&file)), &Settings::default());
    let wanted = [("P", Some("Seal-in"), vec!["of the motor", "", "the end"]), ("P", None, vec!["only a comment"])];
    let wanted: Vec<(String, Option<String>, Vec<String>)> = wanted
        .into_iter()
        .map(|(name, title, lines)| {
            (name.to_string(), title.map(str::to_string), lines.into_iter().map(str::to_string).collect())
        })
        .collect();
    assert_eq!(titles(&parsed), wanted);
    let (written, messages) = whole::document(&parsed, None, "Test");
    assert!(!has_errors(&messages), "{messages:#?}");
    fs::write(&file, written).expect("a file");
    let again = pipeline::parse(inputs::read(&[file]), &Settings::default());
    assert_eq!(titles(&again), wanted);
}
