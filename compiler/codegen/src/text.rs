//! CLIF and assembly as text, for `--emit clif` and `--emit asm`.

use std::fmt::Write as _;

use plcc_abi::RuntimeFn;
use plcc_ir::Module;
use plcc_ir::entities::Entity;

use crate::compile::{Compiler, symbol};
use crate::isa::Placement;
use crate::{CodegenError, CodegenOptions, keeping};

/// CLIF of every function, before Cranelift's own passes.
pub fn clif_text(module: &Module, options: &CodegenOptions) -> Result<String, CodegenError> {
    let compiler = Compiler::new(module, Placement::Object, options)?;
    let name_of = |number| name_of(&compiler, number);
    let mut text = String::new();
    for id in module.functions.keys() {
        let clif = compiler.clif(id)?.display().to_string();
        // Functions are numbered there; here they have names.
        let (_, rest) = clif.split_once('(').unwrap_or(("", &clif));
        let rest = named(rest, "u0:", "", &|number| name_of(number).map(|name| format!("%{name}")));
        let name = symbol(&module.functions[id].name);
        writeln!(text, "function %{name}({rest}").expect("a string takes all");
    }
    Ok(text)
}

/// Assembly of every function as it is in an object file.
pub fn asm_text(module: &Module, options: &CodegenOptions) -> Result<String, CodegenError> {
    let compiler = Compiler::new(module, Placement::Object, options)?;
    let name_of = |number| name_of(&compiler, number);
    let functions = compiler.functions(true)?;
    let mut text = String::new();
    for (id, function) in module.functions.keys().zip(&functions) {
        let name = symbol(&module.functions[id].name);
        let code = function.text.as_deref().unwrap_or("");
        let code = named(code, "User(userextname", ")", &|index| name_of(*function.callees.get(index)? as usize));
        writeln!(text, "{name}: ; {} bytes\n{}", function.bytes.len(), code.trim_end()).expect("a string takes all");
        text.push('\n');
    }
    Ok(text)
}

/// `text` with names for the numbers between `prefix` and `suffix`.
fn named(text: &str, prefix: &str, suffix: &str, name: &dyn Fn(usize) -> Option<String>) -> String {
    let mut parts = text.split(prefix);
    let mut named = parts.next().unwrap_or("").to_string();
    for part in parts {
        let digits = part.len() - part.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let (number, rest) = part.split_at(digits);
        match (number.parse().ok().and_then(name), rest.strip_prefix(suffix)) {
            (Some(name), Some(rest)) => write!(named, "{name}{rest}").expect("a string takes all"),
            _ => write!(named, "{prefix}{part}").expect("a string takes all"),
        }
    }
    named
}

/// Linker symbol of the function that lowering numbers so.
fn name_of(compiler: &Compiler<'_>, number: usize) -> Option<String> {
    let module = compiler.module;
    let functions = module.functions.len();
    if number < functions {
        return Some(symbol(&module.functions[plcc_ir::FuncId::new(number)].name));
    }
    let runtime = RuntimeFn::ALL.len();
    match RuntimeFn::ALL.get(number - functions) {
        Some(function) => Some(function.symbol().to_string()),
        None => compiler.keeping.get(number - functions - runtime).map(|&function| keeping::symbol(function)),
    }
}
