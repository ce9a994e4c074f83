//! `plcc build`.

use std::fs;
use std::path::{Path, PathBuf};

use crate::cache::Cache;
use crate::cli::{BuildArgs, Emit};
use crate::command::exit;
use crate::inputs::{self, Read};
use crate::link::{Form, Runtime};
use crate::package::{fmu, oci};
use crate::pipeline::{self, Bound, Compiled, Settings};
use crate::report;
use crate::{drawings, emit, link, memory, statistics};

/// Compiles and links, or writes an intermediate form.
pub fn build(args: &BuildArgs) -> u8 {
    let inputs = match inputs::or_here(&args.inputs) {
        Ok(inputs) => inputs,
        Err(code) => return code,
    };
    let read = inputs::read_as(&inputs, args.compile.code_page);
    let name = read.name.clone();
    match build_read(args, read, &name) {
        Ok(()) => exit::OK,
        Err(code) => code,
    }
}

fn build_read(args: &BuildArgs, read: Read, name: &str) -> Result<(), u8> {
    if let Some(pass) = args.print_after.as_deref().filter(|pass| !plcc_opt::passes().contains(pass)) {
        report::say(&format!("unknown pass `{pass}`; the passes are {}", plcc_opt::passes().join(", ")));
        return Err(exit::USAGE);
    }
    if args.fmi.is_some() && args.emit != Some(Emit::Fmu) {
        report::say("--fmi is for a unit of a co-simulation: add --emit fmu");
        return Err(exit::USAGE);
    }
    let unreadable = read.is_unreadable();
    let settings = Settings { require_main: true, ..Settings::new(&args.compile) };
    if args.emit == Some(Emit::Tokens) && !unreadable {
        return write_text(args.output.as_deref(), &emit::tokens(&read, &settings));
    }
    let parsed = pipeline::parse(read, &settings);
    if args.emit == Some(Emit::Ast) && !unreadable {
        let text = emit::ast(&parsed);
        let mut diagnostics = parsed.diagnostics;
        report::messages(&mut diagnostics, &parsed.sources);
        write_text(args.output.as_deref(), &text)?;
        return if diagnostics.iter().any(|d| d.is_error()) { Err(exit::COMPILE) } else { Ok(()) };
    }
    // Only what is linked has a page.
    let links = matches!(args.emit, None | Some(Emit::Oci)) && !args.stats;
    let bound = drawings::bind(parsed, &settings, |project| links && (args.services || args.monitor || project.linked));
    let bound = accepted(bound, unreadable, &settings)?;
    if let Some(pass) = &args.print_after {
        return write_text(
            args.output.as_deref(),
            &emit::ir_after(pipeline::lower(&bound, args.optimization.optimization()), pass),
        );
    }
    match args.emit {
        None if !args.stats => return link_executable(bound, args, name),
        Some(Emit::Oci) => return write_image(bound, args, name),
        _ => {}
    }
    let compiled = pipeline::back(&bound, args.optimization.optimization());
    let options = compiled.codegen_options();
    if args.stats {
        let statistics = statistics::statistics(&compiled).map_err(|error| internal(&error))?;
        return write_text(args.output.as_deref(), &if args.json { statistics.json() } else { statistics.table() });
    }
    match args.emit {
        Some(Emit::Obj) => {
            let output = args.output.clone().unwrap_or_else(|| PathBuf::from(format!("{name}.o")));
            write_bytes(&output, &object(&compiled)?)?;
            written(&output, args)
        }
        Some(Emit::Fmu) => write_unit(&compiled, args, name),
        Some(Emit::Ir) => write_text(args.output.as_deref(), &plcc_ir::print::module_text(&compiled.module)),
        Some(Emit::Clif) => {
            let text = plcc_codegen::clif_text(&compiled.module, &options).map_err(|error| internal(&error))?;
            write_text(args.output.as_deref(), &text)
        }
        Some(Emit::Asm) => {
            let text = emit::asm(&compiled, &bound.sources).map_err(|error| internal(&error))?;
            write_text(args.output.as_deref(), &text)
        }
        None | Some(Emit::Tokens | Emit::Ast | Emit::Oci) => unreachable!("written before"),
    }
}

/// Reports the messages of a program; an error ends the command, and so does a warning that the settings refuse.
pub fn accepted(mut bound: Bound, unreadable: bool, settings: &Settings) -> Result<Bound, u8> {
    report::messages(&mut bound.diagnostics, &bound.sources);
    if bound.has_errors() {
        report::say(&report::summary(&bound.diagnostics));
        return Err(if unreadable { exit::USAGE } else { exit::COMPILE });
    }
    if bound.is_denied(settings) {
        report::say(&format!("{}, refused by --deny", report::summary(&bound.diagnostics)));
        return Err(exit::FAILED);
    }
    Ok(bound)
}

/// The object file of a program.
pub fn object(compiled: &Compiled) -> Result<Vec<u8>, u8> {
    plcc_codegen::compile_object(&compiled.module, &compiled.image_bytes(), &compiled.codegen_options())
        .map_err(|error| internal(&error))
}

/// What fails after binding is a fault of plcc, not of the program.
pub fn internal(error: &dyn std::error::Error) -> u8 {
    report::say(&format!("internal fault, please report it: {error}"));
    exit::COMPILE
}

fn link_executable(bound: Bound, args: &BuildArgs, name: &str) -> Result<(), u8> {
    let output = checked_output(args, name, "the executable")?;
    let runtime = runtime(&bound, args);
    let objects = cached_objects(bound, args, &output)?;
    let form = if args.is_static { Form::Static(runtime) } else { Form::Executable(runtime) };
    link::link_form(form, &objects, &output, args.linker.as_deref()).map_err(|error| unlinked(&error))?;
    written(&output, args)
}

/// With services if the project or a flag asks for them.
fn runtime(bound: &Bound, args: &BuildArgs) -> Runtime {
    match args.services || args.monitor || bound.program.config.services.linked {
        true => Runtime::Services,
        false => Runtime::Plain,
    }
}

/// Where to write, which is neither a folder nor a source. Without `-o`, `plcc build tank` writes into the folder `tank`.
fn checked_output(args: &BuildArgs, name: &str, what: &str) -> Result<PathBuf, u8> {
    let output = args.output.clone().unwrap_or_else(|| {
        let folder = Path::new(name);
        if folder.is_dir() { folder.join(name) } else { folder.to_path_buf() }
    });
    if output.is_dir() {
        report::say(&format!("`{}` is a folder; name {what} with -o", output.display()));
        return Err(exit::USAGE);
    }
    if args.inputs.iter().any(|input| is_same_file(input, &output)) {
        report::say(&format!("`{}` is a source; name {what} with -o", output.display()));
        return Err(exit::USAGE);
    }
    Ok(output)
}

/// The object files, with the help of the code that the last build kept: one, or three if the program can be watched while it runs.
fn cached_objects(bound: Bound, args: &BuildArgs, output: &Path) -> Result<Vec<Vec<u8>>, u8> {
    let mut lowered = pipeline::lower_begun(&bound, args.optimization.optimization());
    let is_monitored = !args.no_monitor && runtime(&bound, args) == Runtime::Services;
    let probed = is_monitored.then(|| pipeline::lower_beside(&bound, &mut lowered));
    // A large program takes much memory; what is no longer needed makes room.
    drop(bound);
    memory::give_back(memory::size(&lowered.module));
    let cache = |output: &Path| if args.no_cache { None } else { Cache::of(output) };
    let own = cache(output);
    let objects = match probed {
        None => pipeline::object(lowered, own.as_ref()).map(|object| vec![object]),
        Some(probed) => {
            let other = cache(&output.with_added_extension("probes"));
            pipeline::objects(lowered, probed, [own.as_ref(), other.as_ref()]).map(Vec::from)
        }
    };
    objects.map_err(|error| internal(&error))
}

fn unlinked(error: &link::LinkError) -> u8 {
    report::say(&error.to_string());
    exit::USAGE
}

/// A unit of a co-simulation.
fn write_unit(compiled: &Compiled, args: &BuildArgs, name: &str) -> Result<(), u8> {
    let output = checked_output(args, &format!("{name}.fmu"), "the unit")?;
    let library = link::link_bytes(Form::Unit, &[object(compiled)?], args.linker.as_deref());
    let library = library.map_err(|error| unlinked(&error))?;
    let version = args.fmi.unwrap_or(fmu::Version::V2);
    let (bytes, left_out) = fmu::pack(&compiled.image, &library, version).map_err(|error| internal(&error))?;
    if left_out > 0 {
        let left_out = plcc_literal::count::counted(left_out, "value");
        report::say(&format!("the unit does not show {left_out} of data blocks: there are too many"));
    }
    write_bytes(&output, &bytes)?;
    written(&output, args)
}

/// A container image.
fn write_image(bound: Bound, args: &BuildArgs, name: &str) -> Result<(), u8> {
    let output = checked_output(args, &format!("{name}.tar"), "the image")?;
    let form = Form::Static(runtime(&bound, args));
    let objects = cached_objects(bound, args, &output)?;
    let executable = link::link_bytes(form, &objects, args.linker.as_deref());
    let bytes = executable
        .map_err(|error| unlinked(&error))
        .and_then(|executable| oci::pack(name, &executable).map_err(|error| cannot_write(&output, &error)))?;
    write_bytes(&output, &bytes)?;
    written(&output, args)
}

/// Tells what was written, and how large it is.
fn written(output: &Path, args: &BuildArgs) -> Result<(), u8> {
    let size = fs::metadata(output).ok().filter(fs::Metadata::is_file).map(|metadata| metadata.len());
    match size.filter(|_| !args.quiet) {
        Some(bytes) => report::print(&format!("wrote {} ({})\n", output.display(), size_text(bytes))),
        None => Ok(()),
    }
}

/// `1.2 MB`
fn size_text(bytes: u64) -> String {
    match bytes {
        0..1_000 => format!("{bytes} bytes"),
        1_000..1_000_000 => format!("{:.1} kB", bytes as f64 / 1e3),
        _ => format!("{:.1} MB", bytes as f64 / 1e6),
    }
}

fn is_same_file(a: &Path, b: &Path) -> bool {
    matches!((fs::canonicalize(a), fs::canonicalize(b)), (Ok(a), Ok(b)) if a == b)
}

/// Writes to `output`, or to standard output.
fn write_text(output: Option<&Path>, text: &str) -> Result<(), u8> {
    match output {
        Some(path) => fs::write(path, text).map_err(|error| cannot_write(path, &error)),
        None => report::print(text),
    }
}

fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), u8> {
    link::replace(path, bytes, 0o666).map_err(|error| unlinked(&error))
}

fn cannot_write(path: &Path, error: &std::io::Error) -> u8 {
    report::say(&format!("cannot write `{}`: {error}", path.display()));
    exit::USAGE
}
