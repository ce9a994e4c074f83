//! Projects in PLCopen XML as SCL: which blocks are written, and a table for the variables that have addresses.

use std::fmt::Write;

use plcc_convert::trivia::Trivia;
use plcc_diag::{Code, Diagnostic, FileId, Severity};
use plcc_syntax::ast::{self, Area, Block, BlockName, SourceUnit, Width};
use plcc_syntax::symbols::{Symbol, SymbolTable, SymbolTarget};

/// True of a text that is such a project.
pub fn is_project(text: &str) -> bool {
    matches!(plcc_readers::xml::kind(text), Some(plcc_readers::xml::XmlKind::PlcOpen))
}

/// The comments of its bodies in ST.
pub fn trivia<'a>(text: &str, overlay: &'a str) -> Trivia<'a> {
    Trivia::new(overlay, plcc_readers::plcopen::comments(text, overlay), false)
}

/// The project without blocks in other languages, and a warning for each of these.
pub fn in_scl(unit: &SourceUnit) -> (SourceUnit, Vec<Diagnostic>) {
    let mut made = unit.clone();
    let mut messages = Vec::new();
    made.blocks.retain(|block| {
        let Block::Code(code) = block else { return true };
        let (language, help) = match code.code {
            ast::Code::Scl(_) => return true,
            ast::Code::Graphic(_) => ("LAD or FBD", "`--to sd` writes projects of networks only"),
            ast::Code::Chart(_) => ("SFC", "build it as it is: plcc reads PLCopen XML"),
            ast::Code::Stl(_) => ("IL", "build it as it is: plcc reads PLCopen XML"),
        };
        let name = name(&code.name);
        let mut message = Diagnostic::new(Code::NotConverted, code.name.span(), format!("{name} is in {language}"));
        message.severity = Severity::Warning;
        messages.push(message.label("is left out: only ST is written as SCL").help(help));
        false
    });
    (made, messages)
}

fn name(name: &BlockName) -> String {
    match name {
        BlockName::Symbol { name, .. } => format!("\"{name}\""),
        BlockName::Numbered { prefix, number, .. } => format!("{}{number}", prefix.letters()),
    }
}

/// Names and addresses of its variables, as a symbol table in the format `.sdf`, and a warning for each that has no form there. `None`: no
/// variable has an address.
pub fn symbols(file: FileId, tables: &[SymbolTable]) -> (Option<String>, Vec<Diagnostic>) {
    let (mut text, mut messages) = (String::new(), Vec::new());
    for symbol in tables.iter().flat_map(|table| &table.symbols).filter(|symbol| symbol.span.file == file) {
        match address(symbol) {
            Some(address) => {
                let _ = writeln!(text, "\"{}\",\"{address}\",\"{}\",\"{}\"", symbol.name, symbol.ty, symbol.comment);
            }
            None => {
                let title = format!("a symbol table has no address of 64 bits for `{}`", symbol.name);
                let mut message = Diagnostic::new(Code::NotConverted, symbol.span, title);
                message.severity = Severity::Warning;
                messages.push(message.label("is left out").help("declare it in a data block"));
            }
        }
    }
    (Some(text).filter(|text| !text.is_empty()), messages)
}

/// `None`: an address of 64 bits.
fn address(symbol: &Symbol) -> Option<String> {
    let SymbolTarget::Memory { area, width, byte, bit } = symbol.target else { return None };
    let area = match area {
        Area::I => "I",
        Area::Q => "Q",
        _ => "M",
    };
    Some(match width {
        Width::Bit => format!("{area} {byte}.{bit}"),
        Width::Byte => format!("{area}B {byte}"),
        Width::Word => format!("{area}W {byte}"),
        Width::Dword => format!("{area}D {byte}"),
        Width::Lword => return None,
    })
}
