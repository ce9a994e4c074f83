//! Text of the intermediate forms that consist of several files.

use std::path::Path;

use plcc_abi::image::Site;
use plcc_codegen::CodegenError;
use plcc_diag::{FileId, SourceMap};
use plcc_readers::ReadOptions;

use crate::inputs::Read;
use crate::pipeline::{self, Compiled, Parsed, Settings};

/// Tokens of each source.
pub fn tokens(read: &Read, settings: &Settings) -> String {
    let texts = read.units.iter().map(|&unit| {
        let file = read.sources.file(unit);
        let language = pipeline::language_of(&file.name);
        let options = ReadOptions { mnemonics: settings.mnemonics, pragmas: settings.pragmas, language, texts: None };
        (file.name.as_str(), plcc_readers::tokens_text(&file.text, &options))
    });
    join(texts)
}

/// Syntax tree of each source.
pub fn ast(parsed: &Parsed) -> String {
    join(
        parsed.units.iter().map(|(file, unit)| (parsed.sources.file(*file).name.as_str(), plcc_syntax::ast_text(unit))),
    )
}

/// A single text unchanged; several texts, each after the name of its file.
fn join<'a>(texts: impl ExactSizeIterator<Item = (&'a str, String)>) -> String {
    if texts.len() == 1 {
        texts.map(|(_, text)| text).collect()
    } else {
        texts.map(|(name, text)| format!("// {name}\n{text}")).collect()
    }
}

/// Assembly of each function, with the places and lines of the source that it comes from.
pub fn asm(compiled: &Compiled, sources: &SourceMap) -> Result<String, CodegenError> {
    plcc_codegen::asm_text(&compiled.module, &compiled.codegen_options(), &|site| place(site, sources))
}

/// `sum.stl:3 OB1 network 1: L 32767`. A line of XML is left out: the network says more.
fn place(site: &Site, sources: &SourceMap) -> String {
    let file = sources.file(FileId(site.file));
    let name =
        Path::new(&file.name).file_name().map_or_else(|| file.name.clone(), |name| name.to_string_lossy().into_owned());
    let line = if site.line == 0 || site.line > file.line_count() { "" } else { file.line_text(site.line).trim() };
    let place = format!("{name}:{} {}{} network {}", site.line, site.block.prefix(), site.block_number, site.network);
    if line.is_empty() || line.starts_with('<') { place } else { format!("{place}: {line}") }
}

/// The IR after each run of `pass`.
pub fn ir_after(mut compiled: Compiled, pass: &str) -> String {
    let mut text = String::new();
    plcc_opt::optimize_with(&mut compiled.module, compiled.optimization.without, &mut |name, module| {
        if name == pass {
            text.push_str(&format!("; after {name}\n{}", plcc_ir::print::module_text(module)));
        }
    });
    text
}
