//! Networks of LAD and FBD as statements.

use std::fs;
use std::path::{Path, PathBuf};

use plcc_convert::to_stl::{self, types::Types};
use plcc_convert::trivia::Trivia;
use plcc_diag::{FileId, SourceFile};
use plcc_driver::cli::Level;
use plcc_driver::inputs::TestInput;
use plcc_driver::testing::{self, Form, Variant};
use plcc_readers::ReadOptions;
use plcc_syntax::ast::{Block, BlockName, Code, CodeKind, SourceUnit};
use plcc_syntax::scl;
use plcc_syntax::stl::Mnemonics;
use plcc_syntax::symbols::SymbolTable;
use plcc_tests::{files, plan, root, tests_folder};

use crate::{everything, has_errors, without};

/// A source whose blocks of LAD and FBD are STL where that is possible; the others stay in their language.
struct AsStl {
    /// What is left of the source.
    rest: String,
    stl: String,
    symbols: String,
    blocks: usize,
    refused: Vec<String>,
}

fn as_stl(text: &str, others: &[SourceUnit], tables: &[SymbolTable], keeps_br: bool) -> AsStl {
    // An S7-1200 has no STL.
    let text = text.replace("//@ cpu s7-1200", "//@ cpu s7-1500");
    let text = text.as_str();
    let (unit, _) = plcc_readers::parse(FileId::default(), text, &ReadOptions::default());
    let types = Types::new(std::iter::once(&unit).chain(others), tables);
    let is_portal = text.contains("//@ cpu s7-1500");
    let types = types.with_instructions(plcc_program::instruction_pins).for_portal(is_portal);
    let mut made = SourceUnit { blocks: Vec::new(), ..unit.clone() };
    let mut spans = Vec::new();
    let mut symbols = String::new();
    let mut refused = Vec::new();
    for block in &unit.blocks {
        let Block::Code(code) = block else { continue };
        let Code::Graphic(body) = &code.code else { continue };
        match to_stl::block(code, body, &types, keeps_br) {
            Ok(done) => {
                if let (BlockName::Symbol { name, .. }, Some(number)) = (&done.name, done.header.number) {
                    let letters = match done.kind {
                        CodeKind::Fb | CodeKind::Sfb => "FB",
                        CodeKind::Fc | CodeKind::Sfc => "FC",
                        CodeKind::Ob => "OB",
                    };
                    symbols.push_str(&format!("\"{name}\",\"{letters} {number}\",\"{letters} {number}\",\"\"\n"));
                }
                spans.push(code.span.range());
                made.blocks.push(Block::Code(done));
            }
            Err(messages) => refused.extend(messages.into_iter().map(|message| message.title)),
        }
    }
    let mut kept = scl::comments(text);
    kept.retain(|comment| spans.iter().any(|span| span.contains(&comment.range().start)));
    let trivia = Trivia::new(text, kept, true);
    let (written, messages) = plcc_convert::stl::write(&made, Mnemonics::En, trivia, None);
    assert!(!has_errors(&messages), "{messages:#?}");
    let cpu = text.lines().find(|line| line.starts_with("//@ cpu")).unwrap_or_default();
    let stl = format!("{cpu}\n{written}");
    AsStl { rest: without(text, &spans), stl, symbols, blocks: made.blocks.len(), refused }
}

/// Runs a test, a source or a project, with STL in the place of its networks: how many blocks were STL.
fn run_as_stl(path: &Path) -> Result<usize, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let is_project = path.is_dir();
    let all = match is_project {
        true => everything(path),
        false => vec![path.to_path_buf()],
    };
    let text_of = |path: &Path| plcc_syntax::decode_as(&fs::read(path).expect("a test file"), None);
    let read = |path: &PathBuf| {
        let language = plcc_driver::pipeline::language_of(&path.to_string_lossy());
        plcc_readers::parse(FileId::default(), &text_of(path), &ReadOptions { language, ..Default::default() }).0
    };
    let is_source = |path: &&PathBuf| path.extension().is_some_and(|extension| extension == "s7dcl");
    let declares = |path: &&PathBuf| {
        path.extension().is_some_and(|ending| ["s7dcl", "scl", "db", "xml"].iter().any(|one| ending == *one))
    };
    let units: Vec<SourceUnit> = all.iter().filter(declares).map(read).collect();
    let mut tables = Vec::new();
    for table in
        all.iter().filter(|path| path.extension().is_some_and(|extension| extension == "txt" || extension == "xml"))
    {
        let source = SourceFile::new(table.display().to_string(), text_of(table));
        tables.push(plcc_readers::symbols::parse(FileId::default(), &source).0);
    }
    let texts: Vec<String> = all
        .iter()
        .filter(|path| path.extension().is_none_or(|extension| extension != "xlsx"))
        .map(|path| text_of(path))
        .collect();
    let names_300 = texts
        .iter()
        .any(|text| ["cpu 31", "cpu s7-300", "cpu = \"31", "cpu = \"s7-300"].iter().any(|cpu| text.contains(cpu)));
    let names_cpu = texts.iter().any(|text| text.contains("//@ cpu ") || text.contains("cpu = "));
    let implied: Vec<_> = units.iter().map(|unit| (FileId::default(), unit.clone())).collect();
    let keeps_br = names_300 || (!names_cpu && plcc_program::implied_profile(&implied).limits_checked);
    if texts.iter().any(|text| text.starts_with("cpu = ") && text.contains("[hardware_interrupt")) {
        // Only an S7-1200 names them.
        return Ok(0);
    }
    let (mut blocks, mut written, mut program) = (0, String::new(), Vec::new());
    for path_of in &all {
        let name = path_of.strip_prefix(path).ok().filter(|name| is_project && !name.as_os_str().is_empty());
        let name = name.map_or_else(|| PathBuf::from(path_of.file_name().expect("a file")), Path::to_path_buf);
        let to = folder.path().join(&name);
        fs::create_dir_all(to.parent().expect("a folder")).expect("a folder");
        if !is_source(&path_of) {
            fs::copy(path_of, &to).expect("a copy");
            if path_of.ends_with("plc.toml") {
                // An S7-1200 has no STL.
                let lines = text_of(path_of);
                let lines = lines
                    .lines()
                    .filter(|line| !line.starts_with("sources = ["))
                    .map(|line| if line.starts_with("cpu = \"12") { "cpu = \"s7-1500\"" } else { line });
                fs::write(&to, lines.collect::<Vec<_>>().join("\n")).expect("a file");
            }
            continue;
        }
        let made = as_stl(&text_of(path_of), &units, &tables, keeps_br);
        if std::env::var_os("PLCC_SHOW").is_some() {
            println!("{}: {}; {:?}", path_of.display(), made.blocks, made.refused);
        }
        blocks += made.blocks;
        let mut put = |extension: &str, text: &str| {
            let path = to.with_extension(extension);
            fs::write(&path, text).expect("a file");
            program.push(path);
        };
        put("s7dcl", &made.rest);
        if made.blocks > 0 {
            put("stl", &made.stl);
            written.push_str(&made.stl);
        }
        if !made.symbols.is_empty() {
            put("sym.txt", &made.symbols);
        }
    }
    if blocks == 0 {
        return Ok(0);
    }
    let variant = Variant { form: Form::Jit, optimization: Level::O0.into() };
    let input = match is_project {
        true => TestInput::Project(folder.path().to_path_buf()),
        false => TestInput::Program(program),
    };
    let outcomes = testing::run(&[input], &plan(vec![variant]));
    let failed = outcomes.iter().find(|one| one.failed > 0 || one.rejected || one.unreadable);
    match failed {
        Some(one) => Err(format!("{}{}\n{written}", one.messages, one.failures)),
        None if outcomes.iter().all(|one| one.passed == 0) => Ok(0),
        None => Ok(blocks),
    }
}

/// The assertions of the tests for LAD and FBD hold for the statements that are made of them.
#[test]
fn networks_as_statements_do_the_same() {
    let mut count = 0;
    let mut failed = Vec::new();
    let tests = tests_folder().join("run/lad-fbd");
    let projects: Vec<PathBuf> =
        plcc_tests::projects(&tests).into_iter().chain(plcc_tests::projects(&root().join("samples"))).collect();
    let alone =
        files(&tests, "s7dcl").into_iter().filter(|path| !projects.iter().any(|project| path.starts_with(project)));
    for path in alone.collect::<Vec<_>>().iter().chain(&projects) {
        match run_as_stl(path) {
            Ok(blocks) => count += blocks,
            Err(text) => failed.push(format!("{}: {text}", path.display())),
        }
    }
    assert!(failed.is_empty(), "{} files:\n{}", failed.len(), failed.join("\n\n"));
    assert!(count > 30, "only {count} blocks");
}

/// Files of which every block becomes STL that has no network in SCL, whose meaning only a bound program tells.
#[test]
fn whole_files_are_converted() {
    const FILES: [&str; 32] = [
        "addresses_take_the_type",
        "bit_fields",
        "boxes/boxes_315_2dp",
        "boxes/called_by_name",
        "boxes/choices_s7_300",
        "boxes/clock_and_interrupts",
        "boxes/computed_in_steps",
        "boxes/demux_by_number",
        "boxes/large_unsigned_constants",
        "boxes/moves_of_all_types",
        "boxes/moves_of_bits",
        "boxes/moves_out_of_range",
        "boxes/rotations_and_inversions",
        "boxes/rounding_out_of_range",
        "boxes/shifts_and_steps",
        "boxes/small_inputs_of_wide_boxes",
        "boxes/system_functions_s7_300",
        "boxes/temporary_texts",
        "comparisons_by_type",
        "counters",
        "gates_dialects",
        "indices_and_parts",
        "instances_inside_data",
        "jumps",
        "other_forms",
        "ranges",
        "shift_of_the_sign_s7_300",
        "timer_vectors",
        "untyped_and_system_operands",
        "wait_and_stop",
        "wires_of_boxes_that_are_off",
        "wires_with_numbers_of_calls",
    ];
    for name in FILES {
        let text = fs::read_to_string(tests_folder().join(format!("run/lad-fbd/{name}.s7dcl"))).expect("a test file");
        let keeps_br = ["//@ cpu s7-300", "//@ cpu 315"].iter().any(|cpu| text.contains(cpu));
        let made = as_stl(&text, &[], &[], keeps_br);
        let is_known = |title: &String| title.contains("a network in SCL");
        assert!(made.blocks > 0 && made.refused.iter().all(is_known), "{name}: {:?}", made.refused);
    }
}

/// The output of a gate at a variable, while the flow goes on.
#[test]
fn gates_write_variables() {
    let text = "//@ cpu s7-1500\nFUNCTION F : Void\n    VAR_INPUT\n        p, q : Bool;\n    END_VAR\n    VAR_OUTPUT\n        \
                x, y : Bool;\n    END_VAR\n{ S7_Language := \"FBD\" }\nNETWORK\n    \
                RUNG #p  A( in2 := NOT #q, out => #y )  Coil( #x )  END_RUNG\nEND_NETWORK\nEND_FUNCTION\n";
    let made = as_stl(text, &[], &[], false);
    assert_eq!(made.refused, Vec::<String>::new());
    let at = |line: &str| made.stl.find(line).unwrap_or_else(|| panic!("no `{line}` in\n{}", made.stl));
    let places = ["A     #p;", "AN    #q;", "=     #y;", "=     #x;"].map(at);
    assert!(places.is_sorted(), "{}", made.stl);
}

/// The value of a function, by its name without a sign.
#[test]
fn values_of_functions_are_ret_val() {
    let text = "//@ cpu s7-1500\nFUNCTION Passes : Bool\n    VAR_INPUT\n        a : Bool;\n    END_VAR\n{ S7_Language := \"LAD\" }\nNETWORK\n    \
                RUNG wire#powerrail  Contact( #a )  Coil( Passes )  END_RUNG\nEND_NETWORK\nEND_FUNCTION\n";
    let made = as_stl(text, &[], &[], false);
    assert!(made.stl.contains("=     #RET_VAL;"), "{}", made.stl);
}
