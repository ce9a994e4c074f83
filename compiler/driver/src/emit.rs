//! Text of the intermediate forms that consist of several files.

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

/// The IR after each run of `pass`.
pub fn ir_after(mut compiled: Compiled, pass: &str) -> String {
    let mut text = String::new();
    plcc_opt::optimize_with(&mut compiled.module, &mut |name, module| {
        if name == pass {
            text.push_str(&format!("; after {name}\n{}", plcc_ir::print::module_text(module)));
        }
    });
    text
}
