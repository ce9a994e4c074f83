//! PLCopen XML that is written: it does what the sources do.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use plcc_driver::cli::Level;
use plcc_driver::command::convert::whole;
use plcc_driver::inputs::{self, TestInput};
use plcc_driver::pipeline::{self, Parsed, Settings};
use plcc_driver::testing::{self, Form, Variant};
use plcc_syntax::ast::{Block, BlockName, Code, CodeBlock, CodeKind, Header};
use plcc_syntax::network::ast::{Body as Networks, Content, Network};
use plcc_syntax::scl::ast::{Body, Dialect, Expr, ExprKind, Name, NameForm, Statement, StatementKind};
use plcc_tests::plan;

use crate::{has_errors, sources};

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
    let mut rest = format!("{}{}", &text[..begin], &text[end + "END_VAR".len()..]);
    for name in declared.lines().filter_map(|line| line.split_once(':')).map(|(names, _)| names) {
        for name in name.split(',').map(str::trim).filter(|name| !name.is_empty()) {
            rest = rest.replace(&format!("#{name}"), &format!("\"Temporary\".{name}"));
        }
    }
    format!("{rest}\nDATA_BLOCK \"Temporary\"\n    VAR\n{declared}    END_VAR\nEND_DATA_BLOCK\n")
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
    let (written, messages) = whole::document(&parsed, "Test");
    if let Some(first) = messages.iter().find(|message| message.is_error()) {
        *refused.entry(first.title.clone()).or_default() += 1;
        return None;
    }
    let file = folder.path().join("a.xml");
    fs::write(&file, &written).expect("a file");
    let variant = Variant { form: Form::Jit, optimization: Level::O0.into() };
    let outcomes = testing::run(&[TestInput::File(file)], &plan(vec![variant]));
    let failed = outcomes.iter().find(|one| one.failed > 0 || one.rejected || one.unreadable || one.passed == 0);
    Some(match failed {
        Some(one) => Err(format!("{}{}", one.messages, one.failures)),
        None => Ok(()),
    })
}

/// Every fourth source; all of them with `PLCC_ALL_SOURCES=1`.
#[test]
fn sources_as_projects_pass_their_assertions() {
    let (mut count, mut failed, mut refused) = (0, Vec::new(), BTreeMap::new());
    let step = if std::env::var_os("PLCC_ALL_SOURCES").is_some() { 1 } else { 4 };
    for path in ["s7dcl", "scl", "xml"].iter().flat_map(|extension| sources(extension)).step_by(step) {
        match as_project(&path, &mut refused) {
            None => {}
            Some(Ok(())) => count += 1,
            Some(Err(text)) => failed.push(format!("{}: {text}", path.display())),
        }
    }
    println!("{count} sources; refused: {refused:#?}");
    assert!(failed.is_empty(), "{} of {}:\n{}", failed.len(), count + failed.len(), failed.join("\n\n"));
    assert!(count > 20, "only {count} sources; {refused:#?}");
}
