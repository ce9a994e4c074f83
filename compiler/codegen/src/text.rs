//! CLIF and assembly as text, for `--emit clif` and `--emit asm`.

use std::fmt::Write as _;

use cranelift_module::ModuleRelocTarget;
use iced_x86::{Formatter as _, GasFormatter};
use plcc_abi::RuntimeFn;
use plcc_abi::image::Site;
use plcc_ir::Module;
use plcc_ir::entities::Entity;

use crate::compile::{Compiler, symbol};
use crate::isa::Placement;
use crate::machine::{self, Part};
use crate::{CodegenError, CodegenOptions, keeping};

/// CLIF of every function, before Cranelift's own passes.
pub fn clif_text(module: &Module, options: &CodegenOptions) -> Result<String, CodegenError> {
    let compiler = Compiler::new(module, Placement::Object, options)?;
    let mut text = String::new();
    for id in module.functions.keys() {
        let clif = compiler.clif(id)?.display().to_string();
        // Functions are numbered there; here they have names.
        let (_, rest) = clif.split_once('(').unwrap_or(("", &clif));
        let rest = named(rest, "u0:", "", &|number| name_of(&compiler, number).map(|name| format!("%{name}")));
        let name = symbol(&module.functions[id].name);
        writeln!(text, "function %{name}({rest}").expect("a string takes all");
    }
    Ok(text)
}

/// Column at which source lines begin.
const SOURCE_COLUMN: usize = 60;

/// Assembly of every function as it is in an object file, in the notation of the GNU assembler. Next to the first instruction of each
/// piece stands what `source` says of its place; numbers before instructions are offsets in the function.
pub fn asm_text(
    module: &Module,
    options: &CodegenOptions,
    source: &dyn Fn(&Site) -> String,
) -> Result<String, CodegenError> {
    let compiler = Compiler::new(module, Placement::Object, options)?;
    let mut formatter = GasFormatter::new();
    formatter.options_mut().set_branch_leading_zeros(false);
    formatter.options_mut().set_uppercase_hex(false);
    formatter.options_mut().set_rip_relative_addresses(true);
    let mut text = String::new();
    for (id, function) in module.functions.keys().zip(&compiler.functions()?) {
        let name = symbol(&module.functions[id].name);
        let parts = machine::parts(function);
        let count = parts.iter().filter(|part| matches!(part, Part::Instruction { .. })).count();
        let bytes = function.bytes.len();
        writeln!(text, "{name}: # {bytes} bytes, {count} instructions").expect("a string takes all");
        let (mut site, mut last) = (0, String::new());
        for part in &parts {
            let line = match part {
                Part::Instruction { instruction, target, .. } => {
                    let mut line = format!("{:6x}: ", instruction.ip());
                    formatter.format(instruction, &mut line);
                    match target {
                        Some(ModuleRelocTarget::User { index, .. }) => {
                            let name = name_of(&compiler, *index as usize);
                            line.extend(name.iter().flat_map(|name| [" # ", name]));
                        }
                        Some(other) => write!(line, " # {other}").expect("a string takes all"),
                        None if instruction.is_ip_rel_memory_operand() => {
                            write!(line, " # {:x}", instruction.ip_rel_memory_address()).expect("a string takes all");
                        }
                        None => {}
                    }
                    line
                }
                Part::Data { at, length } => format!("{at:6x}: .skip {length} # data"),
            };
            let before = site;
            if let Part::Instruction { place, .. } = part {
                site = place.map_or(0, |place| place.site);
            }
            let place = (site as usize).checked_sub(1).filter(|_| site != before);
            let place = place.and_then(|site| module.sites.get(site)).map(source);
            // Statements of one line are one piece.
            match place.filter(|place| *place != last) {
                Some(place) => {
                    writeln!(text, "{line:SOURCE_COLUMN$} | {place}").expect("a string takes all");
                    last = place;
                }
                None => writeln!(text, "{line}").expect("a string takes all"),
            }
        }
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
