//! Charts of SimaticML and PLCopen XML as sources of GRAPH, and as statement lists.

use std::fs;
use std::path::Path;

use plcc_convert::from_scl;
use plcc_convert::trivia::Trivia;
use plcc_diag::FileId;
use plcc_driver::cli::Level;
use plcc_driver::inputs::{self, TestInput};
use plcc_driver::pipeline::{self, Settings};
use plcc_driver::testing::{self, Form, Variant};
use plcc_readers::ReadOptions;
use plcc_syntax::ast::{Block, BlockName, Code};
use plcc_syntax::stl::Mnemonics;
use plcc_tests::{plan, tests_folder};

use crate::{everything, has_errors};

/// Runs a project with its charts of SimaticML or PLCopen XML as sources of GRAPH: how many blocks these are.
fn run_as_graph(path: &Path) -> Result<usize, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut count, mut shown) = (0, String::new());
    for from in everything(path) {
        let to = folder.path().join(from.strip_prefix(path).expect("a file of the project"));
        fs::create_dir_all(to.parent().expect("a folder")).expect("a folder");
        let is_xml = from.extension().is_some_and(|ending| ending == "xml");
        let text = plcc_syntax::decode_as(&fs::read(&from).expect("a file"), None);
        let (unit, _) = plcc_readers::parse(FileId::default(), &text, &ReadOptions::default());
        let is_chart = |block: &Block| matches!(block, Block::Code(code) if matches!(code.code, Code::Chart(_)));
        if !is_xml || !unit.blocks.iter().any(is_chart) {
            match from.extension().is_some_and(|ending| ending == "scl") {
                // A chart of S7-GRAPH has its data without a structure around them.
                true => fs::write(&to, text.replace(".RT_DATA.", ".")).expect("a file"),
                false => drop(fs::copy(&from, &to).expect("a copy")),
            }
            continue;
        }
        let (written, messages) = plcc_convert::gr7::write(&unit, Trivia::none(), unit.overlay.as_deref());
        if has_errors(&messages) {
            return Err(format!("{messages:#?}"));
        }
        count += unit.blocks.iter().filter(|block| is_chart(block)).count();
        fs::write(to.with_extension("gr7"), &written).expect("a file");
        shown.push_str(&written);
        // Numbers of blocks are in symbol tables.
        for block in &unit.blocks {
            if let Block::Code(block) = block
                && let (BlockName::Symbol { name, .. }, Some(number)) = (&block.name, block.header.number)
            {
                let line = format!("\"{name}\",\"FB {number}\",\"FB {number}\",\"\"\n");
                fs::write(to.with_extension("sym.txt"), line).expect("a file");
            }
        }
    }
    tested(folder.path(), &shown).map(|()| count)
}

/// Runs the tests of a project; `shown`: what is new in it.
fn tested(project: &Path, shown: &str) -> Result<(), String> {
    let variant = Variant { form: Form::Jit, optimization: Level::O0.into() };
    let outcomes = testing::run(&[TestInput::Project(project.to_path_buf())], &plan(vec![variant]));
    match outcomes.iter().find(|one| one.failed > 0 || one.rejected || one.unreadable) {
        Some(one) => Err(format!("{}{}\n{shown}", one.messages, one.failures)),
        None if outcomes.iter().all(|one| one.passed == 0) => Err("nothing was tested".to_string()),
        None => Ok(()),
    }
}

/// Runs a project with its charts as statement lists: how many blocks these are.
fn run_as_lists(path: &Path) -> Result<usize, String> {
    let settings = Settings { plain_charts: true, ..Settings::default() };
    let parsed = pipeline::parse(inputs::read(&[path.to_path_buf()]), &settings);
    let is_chart = |block: &Block| matches!(block, Block::Code(code) if matches!(code.code, Code::Chart(_)));
    let charts: Vec<_> = parsed
        .units
        .iter()
        .filter(|(_, unit)| unit.blocks.iter().any(is_chart))
        .map(|(id, unit)| (parsed.sources.file(*id).clone(), unit.clone()))
        .collect();
    let bound = pipeline::bind(parsed, &settings);
    if bound.has_errors() {
        return Err(format!("{:#?}", bound.diagnostics));
    }
    let folder = tempfile::tempdir().expect("a folder");
    let (mut count, mut shown) = (0, String::new());
    for from in everything(path) {
        let to = folder.path().join(from.strip_prefix(path).expect("a file of the project"));
        fs::create_dir_all(to.parent().expect("a folder")).expect("a folder");
        let chart = charts.iter().find(|(source, _)| Path::new(&source.name).file_name() == from.file_name());
        let Some((source, unit)) = chart else {
            fs::copy(&from, &to).expect("a copy");
            continue;
        };
        let text = unit.overlay.as_deref().unwrap_or(&source.text);
        let meaning = (text, Default::default());
        let (made, messages) = from_scl::unit(unit, &bound.program, meaning, plcc_program::with_chart_data);
        let (written, more) = plcc_convert::stl::write(&made, Mnemonics::En, Trivia::none(), None);
        if has_errors(&messages) || has_errors(&more) {
            return Err(format!("{messages:#?}\n{more:#?}"));
        }
        count += unit.blocks.iter().filter(|block| is_chart(block)).count();
        fs::write(to.with_extension("stl"), &written).expect("a file");
        shown.push_str(&written);
    }
    tested(folder.path(), &shown).map(|()| count)
}

#[test]
fn charts_of_projects_as_lists_do_the_same() {
    for project in ["star-delta-1500", "two-doses-1500"] {
        let result = run_as_lists(&tests_folder().join("run/graph").join(project));
        assert_eq!(result, Ok(1), "{project}: {}", result.as_ref().err().map_or("", String::as_str));
    }
}

#[test]
fn charts_of_xml_as_sources_do_the_same() {
    for project in ["star-delta-1500", "two-doses-1500"] {
        let result = run_as_graph(&tests_folder().join("run/graph").join(project));
        assert_eq!(result, Ok(1), "{project}: {}", result.as_ref().err().map_or("", String::as_str));
    }
}
